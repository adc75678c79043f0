"""Labelled cases from MuJoCo, for blind trials: `python cases.py OUT`; `ARMTWIN` names the binary.

A second simulator beside the one that `armtwin trial draw` uses, for
`armtwin trial draw --from OUT --names OUT/names.toml --mass-error 0 --out DIR`. Nothing but the URDF is
shared: MuJoCo's implicit integrator at half a millisecond, dry friction as a constraint, computed torque
with PD and a friction feed-forward that is off, every effect written here from its law. Per case two
recordings at 125 Hz with RTDE columns (`identification.csv.gz`, `validation.csv.gz`) and `truth.json`;
`twin.toml` is the nominal twin of all.

The elastic and the lost-motion joint are two hinges in series, motor and deflection; what is recorded
is the motor's angle. A tree of cases is repeatable: case K of seed S is the same in any run.
"""

import argparse
import gzip
import json
import multiprocessing
import os
import subprocess
import sys

import mujoco
import numpy as np

STEP = 0.5e-3
SAMPLE = 16  # steps
COLD = 24.0  # degrees Celsius, where a recording begins
HOME = np.array([-0.13, -1.5, 1.15, -1.28, -1.42, 0.24])
GEAR = 101.0
TORQUE_CONSTANT = np.array([0.135, 0.136, 0.135, 0.095, 0.086, 0.089])
PER_AMPERE = GEAR * TORQUE_CONSTANT
ROTOR = np.array([1.1, 1.1, 1.1, 0.14, 0.14, 0.14])
TWIN = """robot = "ur5"
[drive]
gear_ratio = 101
torque_constant = [0.135, 0.136, 0.135, 0.095, 0.086, 0.089]
rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
[twin]
effects = ["coulomb", "viscous"]
"""
BIG = np.array([1.0, 1.0, 1.0, 0.25, 0.2, 0.2])  # how the joints' torques scale


def either(rng, value):
    return value * rng.choice([-1.0, 1.0])


def draw(effect, joint, rng):
    """Parameters of an effect at a joint (from 0), in SI units."""
    u, big = rng.uniform, BIG[joint] if joint is not None else 1.0
    match effect:
        case "stribeck":
            return {"extra": u(1.5, 5) * big, "speed": u(0.02, 0.12)}
        case "viscous_quadratic":
            return {"value": either(rng, u(1, 5)) * big}
        case "viscous_cubic":
            return {"value": either(rng, u(1, 6)) * big}
        case "coulomb_asymmetry":
            return {"coulomb": either(rng, u(0.3, 1.5)) * big, "viscous": either(rng, u(0, 2)) * big}
        case "load_friction":
            return {"per_nm": u(0.04, 0.15)}
        case "temperature_friction":
            return {"coulomb": either(rng, u(0.03, 0.15)) * big, "viscous": -u(0.05, 0.3) * big}
        case "presliding":
            return {"width": u(2e-3, 15e-3)}
        case "backlash":
            return {"gap": u(0.5e-3, 4e-3)}
        case "flexibility":
            return {"stiffness": u(800, 4000)}
        case "torque_ripple":
            return {"amplitude": u(0.5, 3) * big, "cycles": int(rng.choice([2, 4, 9, 36, 72, 202])), "phase": u(0, 6.28)}
        case "rotor_inertia":
            return {"change": u(0.15, 0.6) * ROTOR[joint] * rng.choice([-1.0, 1.0])}
        case "payload":
            return {"mass": u(0.2, 3), "com": [u(-0.03, 0.03), u(-0.03, 0.03), u(0.02, 0.12)]}
        case "link_mass":
            return {"change": either(rng, u(0.08, 0.3))}
        case "torque_constant":
            return {"change": either(rng, u(0.03, 0.15))}
        case "current_offset":
            return {"torque": either(rng, u(0.2, 1.5)) * big}
        case "joint_offset":
            return {"radians": either(rng, u(0.01, 0.05))}
        case "base_tilt":
            return {"x": u(-0.06, 0.06), "y": u(-0.06, 0.06)}
        case "time_delay":
            return {"seconds": u(0.004, 0.05)}
        case "velocity_lag":
            return {"seconds": u(0.004, 0.04)}
        case "contact":
            return {"force": list(rng.normal(0, 12, 3)), "start": u(8, 30), "duration": u(3, 12)}
        case "cable_spring":
            return {"stiffness": u(1, 8) * big, "rest": HOME[joint] + u(-0.6, 0.6)}
        case "joint_coupling":
            return {"per_speed": either(rng, u(1, 4)) * big}
        case "slosh":
            return {"mass": u(0.4, 1.2), "length": u(0.08, 0.25), "damping": 0.004, "start": u(-0.5, 0.5)}
        case "sticky_angle":
            return {"extra": u(1, 4) * big, "angle": HOME[joint] + u(-0.3, 0.3), "width": u(0.05, 0.2)}
        case "wandering_friction":
            return {"share": u(0.15, 0.4), "period": u(3, 9)}
    return {}


# effect: joints it may sit at (None: the whole arm), and whether the catalogue lacks it
ANY, CARRYING, ARM = range(6), (1, 2, 3), (None,)
EFFECTS = {
    "none": ARM, "stribeck": ANY, "viscous_quadratic": ANY, "viscous_cubic": ANY, "coulomb_asymmetry": ANY,
    "load_friction": CARRYING, "temperature_friction": ANY, "presliding": ANY, "backlash": (0, 1, 2),
    "flexibility": (0, 1, 2), "torque_ripple": ANY, "rotor_inertia": ANY, "payload": ARM,
    "link_mass": CARRYING, "torque_constant": CARRYING, "current_offset": ANY, "joint_offset": CARRYING,
    "base_tilt": ARM, "time_delay": ARM, "velocity_lag": ARM, "contact": ARM, "cable_spring": ANY,
    "joint_coupling": range(1, 6), "slosh": ARM, "sticky_angle": ANY, "wandering_friction": ANY,
}
FOREIGN = {"slosh", "sticky_angle", "wandering_friction"}


def linear(coefficient):
    """A spring's or damper's coefficient, its quadratic and cubic terms zero."""
    return [coefficient, 0.0, 0.0]


def arm(effect, joint, values, friction, viscous):
    """The MuJoCo model of the arm with what of the effect is mechanism, and its motors' velocity addresses."""
    urdf = subprocess.run([os.environ.get("ARMTWIN", "armtwin"), "urdf"], capture_output=True, text=True, check=True)
    spec = mujoco.MjSpec.from_string(urdf.stdout)
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.option.gravity = np.array([0, 0, -9.80665])
    motors = list(spec.joints)
    for j, motor in enumerate(motors):
        motor.armature, motor.frictionloss, motor.limited = ROTOR[j], friction[j], False
        motor.damping = linear(viscous[j])
        # The default lets dry friction creep: at 0.03 rad/s it would not be at its limit yet.
        motor.solref_friction, motor.solimp_friction = [1e-3, 1.0], [0.99, 0.999, 1e-3, 0.5, 2.0]
    bodies = [motor.parent for motor in motors]
    if effect == "rotor_inertia":
        motors[joint].armature += values["change"]
    if effect == "link_mass":
        scale = 1 + values["change"]
        bodies[joint].mass *= scale
        bodies[joint].inertia = np.array(bodies[joint].inertia) * scale
    if effect == "payload":
        load = bodies[5].add_body(name="load", pos=values["com"])
        side = 0.08
        load.mass, load.ipos, load.inertia = values["mass"], np.zeros(3), np.full(3, values["mass"] * side**2 / 6)
        load.explicitinertial = True
    if effect == "slosh":
        load = bodies[5].add_body(name="load")
        damping = linear(values["damping"])
        load.add_joint(name="swing", axis=[1, 0, 0], damping=damping)
        load.mass, load.ipos, load.inertia = values["mass"], np.array([0, 0, values["length"]]), np.full(3, 1e-4)
        load.explicitinertial = True
    if effect == "base_tilt":
        g = 9.80665 * np.array([np.sin(values["y"]), -np.sin(values["x"]), 0])
        g[2] = -np.sqrt(9.80665**2 - g @ g)
        spec.option.gravity = g
    if effect in ("flexibility", "backlash"):
        second = bodies[joint].add_joint(name="deflection", axis=motors[joint].axis, pos=motors[joint].pos)
        if effect == "flexibility":
            second.stiffness = linear(values["stiffness"])
            second.damping = linear(2e-3 * values["stiffness"])
        else:
            second.range, second.limited = np.array([-0.5, 0.5]) * values["gap"], True
            second.solref_limit, second.damping = [0.004, 1.0], linear(0.5)
    names = [motor.name for motor in motors]
    model = spec.compile()
    q = np.array([model.joint(n).qposadr[0] for n in names])
    v = np.array([model.joint(n).dofadr[0] for n in names])
    return model, q, v


def command(duration, rng):
    """Target angle, speed and acceleration: harmonics of the duration, rising after 1.2 s at rest."""
    t = np.arange(0, duration, STEP)
    rise = np.clip((t - 1.2) / 2, 0, 1)
    window = rise**3 * (10 - 15 * rise + 6 * rise**2)
    reach = np.array([0.55, 0.4, 0.4, 0.4, 0.5, 0.6])
    q = np.zeros((len(t), 6))
    for j in range(6):
        k = rng.choice(np.arange(2, 23), 8, replace=False)
        a, phase = rng.normal(size=8) / k**0.7, rng.uniform(0, 2 * np.pi, 8)
        wave = np.sin(2 * np.pi * np.outer(t, k) / duration + phase) @ a
        wave -= wave[0]
        q[:, j] = wave * reach[j] / np.abs(wave).max()
    q = HOME + window[:, None] * q
    qd = np.gradient(q, STEP, axis=0)
    return q, qd, np.gradient(qd, STEP, axis=0)


class Disturbance:
    """What an effect does to a moving arm beside its mechanism: torque on its joints and dry friction, by its law."""

    def __init__(self, effect, joint, values, friction):
        self.effect, self.joint, self.values, self.friction = effect, joint, values, friction
        self.deflection = 0.0

    def at(self, t, q, v, load, warm):
        """Torque added to the arm, N.m, and dry friction, N.m, per joint. `load` is the joints' rigid torque
        at rest and in motion, N.m, `warm` their kelvins above the start."""
        extra, loss = np.zeros(6), self.friction.copy()
        j, values = self.joint, self.values
        match self.effect:
            case "stribeck":
                loss[j] += values["extra"] * np.exp(-((v[j] / values["speed"]) ** 2))
            case "viscous_quadratic":
                extra[j] = -values["value"] * v[j] * abs(v[j])
            case "viscous_cubic":
                extra[j] = -values["value"] * v[j] ** 3
            case "coulomb_asymmetry":
                loss[j] += np.sign(v[j]) * values["coulomb"] / 2
                extra[j] = -values["viscous"] * max(v[j], 0)
            case "load_friction":
                loss[j] += values["per_nm"] * abs(load[j])
            case "temperature_friction":
                loss[j] = max(0.0, loss[j] + values["coulomb"] * warm[j])
                extra[j] = -values["viscous"] * warm[j] * v[j]
            case "presliding":  # Dahl's
                self.deflection += STEP * v[j] * (1 - np.sign(v[j]) * self.deflection) / values["width"]
                loss[j], extra[j] = 0, -loss[j] * self.deflection
            case "torque_ripple":
                extra[j] = -values["amplitude"] * np.sin(values["cycles"] * q[j] + values["phase"])
            case "cable_spring":
                extra[j] = -values["stiffness"] * (q[j] - values["rest"])
            case "joint_coupling":
                extra[j] = -values["per_speed"] * v[j - 1]
            case "sticky_angle":
                loss[j] += values["extra"] * np.exp(-(((q[j] - values["angle"]) / values["width"]) ** 2))
            case "wandering_friction":
                phase = 2 * np.pi * t / values["period"] + values["wander"] + np.sin(0.37 * t)
                loss[j] *= 1 + values["share"] * np.sin(phase)
        return extra, loss

    def force(self, t):
        """At the flange, N."""
        if self.effect != "contact":
            return np.zeros(3)
        touching = 0 <= t - self.values["start"] < self.values["duration"]
        return np.array(self.values["force"]) * touching


def recorded(effect, joint, values, tau):
    """Motor torque as the drive's current tells it, N.m."""
    tau = tau.copy()
    if effect == "current_offset":
        tau[joint] += values["torque"]
    if effect == "torque_constant":
        tau[joint] /= 1 + values["change"]
    return tau


def run(effect, joint, values, base, duration, rng):
    """One motion of the arm: what is recorded before noise, at 125 Hz, and its gap to the best nominal twin."""
    friction, viscous = np.array(base["coulomb"]), np.array(base["viscous"])
    model, qa, va = arm(effect, joint, values, friction, viscous)
    data = mujoco.MjData(model)
    nominal, nq, nv = arm("none", None, {}, friction * 0, viscous * 0)
    rigid = mujoco.MjData(nominal)
    target, speed, acceleration = command(duration, rng)
    off = rng.uniform(0.8, 1.2, 6)
    offset = np.zeros(6)
    if effect == "joint_offset":
        offset[joint] = values["radians"]
    data.qpos[qa] = target[0] - offset
    if effect == "slosh":
        data.qpos[-1] = values["start"]
    heat, pace = rng.uniform(5, 20, 6), rng.uniform(15, 30, 6)
    disturbance = Disturbance(effect, joint, values | {"wander": rng.uniform(0, 6.28)}, friction)
    flange = model.body(model.jnt_bodyid[model.dof_jntid[va[5]]]).id
    rows, lagged = [], np.zeros(6)
    mass = np.zeros((nominal.nv, nominal.nv))
    for i in range(len(target)):
        t = i * STEP
        q, v = data.qpos[qa] + offset, data.qvel[va].copy()
        rigid.qpos[nq], rigid.qvel[nv] = q, v
        mujoco.mj_forward(nominal, rigid)
        mujoco.mj_fullM(nominal, rigid, mass)
        pull = acceleration[i] + 40 * (speed[i] - v) + 500 * (target[i] - q)
        tau = mass @ pull + rigid.qfrc_bias + off * (friction * np.tanh(speed[i] / 0.03) + viscous * speed[i])
        warm = heat * (1 - np.exp(-t / pace))
        extra, model.dof_frictionloss[va] = disturbance.at(t, q, v, rigid.qfrc_bias, warm)
        data.xfrc_applied[flange, :3] = disturbance.force(t)
        data.qfrc_applied[va] = tau + extra
        if i % SAMPLE == 0:
            mujoco.mj_forward(model, data)
            seen = lagged.copy() if effect == "velocity_lag" else v
            current = recorded(effect, joint, values, tau)
            rows.append((t, target[i], speed[i], acceleration[i], q, v, seen, current, COLD + warm, data.qacc[va].copy()))
        if effect == "velocity_lag":
            lagged += STEP * (v - lagged) / values["seconds"]
        mujoco.mj_step(model, data)
        if not np.all(np.isfinite(data.qpos)) or np.abs(data.qvel).max() > 30:
            raise RuntimeError("ran away")
    t, tq, tv, ta, q, v, seen, tau, temperature, a = (np.array(x) for x in zip(*rows))
    if effect == "time_delay":
        tau = np.stack([np.interp(t - values["seconds"], t, tau[:, j]) for j in range(6)], 1)
    return dict(t=t, tq=tq, tv=tv, ta=ta, q=q, v=seen, tau=tau, temperature=temperature), gap(nominal, nq, nv, q, v, a, tau)


def gap(nominal, nq, nv, q, v, a, tau):
    """RMS per joint of what the nominal twin with its best friction leaves, sliding, N.m."""
    data, left = mujoco.MjData(nominal), np.zeros_like(tau)
    for i in range(len(q)):
        data.qpos[nq], data.qvel[nv], data.qacc[nv] = q[i], v[i], a[i]
        mujoco.mj_inverse(nominal, data)
        left[i] = tau[i] - data.qfrc_inverse[nv]
    out = []
    for j in range(6):
        sliding = np.abs(v[:, j]) > 0.03
        x = np.stack([np.sign(v[sliding, j]), v[sliding, j]], 1)
        y = left[sliding, j]
        out.append(float(np.sqrt(np.mean((y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) ** 2))))
    return out


def write(path, r, snr, rng):
    """The recording with noise and steps; returns the noise's RMS per joint in N.m."""
    current = r["tau"] / PER_AMPERE
    noise = np.sqrt(np.mean(current**2, 0)) * 10 ** (-snr / 20)
    current = np.round((current + rng.normal(size=current.shape) * noise) / 2e-3) * 2e-3
    q = np.round((r["q"] + rng.normal(size=r["q"].shape) * 2e-5) / 2e-5) * 2e-5
    v = r["v"] + rng.normal(size=r["v"].shape) * 1.5e-3
    table = [r["t"][:, None], r["tq"], r["tv"], r["ta"], q, v, current, np.round(r["temperature"], 1)]
    names = ["target_q", "target_qd", "target_qdd", "actual_q", "actual_qd", "actual_current", "joint_temperatures"]
    header = ",".join(["timestamp"] + [f"{n}_{j}" for n in names for j in range(6)])
    with gzip.open(path, "wt") as f:
        np.savetxt(f, np.hstack(table), fmt="%.6g", delimiter=",", header=header, comments="")
    return noise * PER_AMPERE


def case(job):
    out, duration, seed, number = job
    folder = os.path.join(out, f"case-{number:03}")
    rng = np.random.default_rng([seed, number])
    names = list(EFFECTS)
    effect = names[number % len(names)]
    for _ in range(20):
        joint = rng.choice(np.array(EFFECTS[effect], dtype=object))
        values = draw(effect, joint, rng)
        base = {"coulomb": list(rng.uniform([3, 3, 3, 1, 0.6, 0.6], [9, 9, 9, 2.5, 2, 2])),
                "viscous": list(rng.uniform([4, 4, 4, 1, 0.6, 0.6], [14, 14, 14, 3, 2, 2]))}
        snr = rng.uniform(24, 34)
        try:
            (fit, gap_fit), (check, gap_check) = (run(effect, joint, values, base, duration, rng) for _ in range(2))
        except RuntimeError:
            continue
        noise = np.sqrt(np.mean(fit["tau"] ** 2, 0)) * 10 ** (-snr / 20)
        strength = max(np.array(gap_fit) / noise)
        if effect in ("none", "velocity_lag") or strength >= 0.8:
            break
    os.makedirs(folder, exist_ok=True)
    write(os.path.join(folder, "identification.csv.gz"), fit, snr, rng)
    write(os.path.join(folder, "validation.csv.gz"), check, snr, rng)
    joints = [] if effect == "none" else [0 if joint is None else int(joint) + 1]
    truth = {"effect": effect, "joints": joints, "parameters": values, "outside_catalogue": effect in FOREIGN,
             "gap_over_noise": {"identification": list(np.array(gap_fit) / noise), "validation": list(np.array(gap_check) / noise)},
             "case": f"case-{number:03}", "snr_db": snr, "baseline": {k: base[k] for k in ("coulomb", "viscous")}}
    with open(os.path.join(folder, "truth.json"), "w") as f:
        json.dump(truth, f, indent=1)
    return truth


NAMES = """[effects]
contact = "external_contact"
link_mass = "link_inertia"
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", help="folder for the cases")
    parser.add_argument("--cases", type=int, default=26, help="how many; every 26 hold each effect once [%(default)s]")
    parser.add_argument("--only", type=int, nargs="+", help="the numbers of the cases, from 0")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--duration", type=float, default=48.0, help="of a recording, s [%(default)s]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases at a time [%(default)s]")
    return parser.parse_args()


def main():
    given = arguments()
    os.makedirs(given.out, exist_ok=True)
    for name, text in (("twin.toml", TWIN), ("names.toml", NAMES)):
        with open(os.path.join(given.out, name), "w") as f:
            f.write(text)
    jobs = [(given.out, given.duration, given.seed, k) for k in given.only or range(given.cases)]
    with multiprocessing.Pool(given.jobs) as pool:
        for t in pool.imap_unordered(case, jobs):
            print(t["case"], t["effect"], t["joints"], f"{max(t['gap_over_noise']['identification']):.2f}", flush=True)


if __name__ == "__main__":
    main()
