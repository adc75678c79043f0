#!/usr/bin/env python3
"""Cost of a step of the same arm in MuJoCo (pip install mujoco): beside `cargo bench simulation`.

    armtwin urdf --robot ur5 -o ur5.urdf && python3 benches/mujoco_step.py ur5.urdf

Friction (without the Stribeck curve), rotor inertia, torque, step and motion are those of
benches/simulation.rs. The loop over steps runs inside MuJoCo (C), on one core; in motion Python puts
the arm back every 200 steps.
"""

import sys
import time

import mujoco

ROTORS = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
COULOMB = [6.0, 7.0, 5.0, 1.5, 1.2, 1.0]
VISCOUS = [8.0, 10.0, 7.0, 1.5, 1.2, 1.0]
MOTION = [0.0, -1.0, 1.0, 0.5, -0.5, 0.3], [1.0, -0.8, 1.0, 1.5, -1.5, 2.0]
REPEATS, STEPS = 50, 200


def fastest(model, data, moving):
    """Seconds a step, the best of 20 rounds."""
    best = float("inf")
    for _ in range(20):
        start = time.process_time()
        for _ in range(REPEATS):
            if moving:
                data.qpos[:], data.qvel[:] = MOTION
            mujoco.mj_step(model, data, STEPS)
        best = min(best, (time.process_time() - start) / (REPEATS * STEPS))
    return best


def main():
    model = mujoco.MjModel.from_xml_path(sys.argv[1])
    model.opt.timestep = 5e-4
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.dof_armature[:] = ROTORS
    model.dof_damping[:] = VISCOUS
    for dry in (0, 1):
        model.dof_frictionloss[:] = [dry * level for level in COULOMB]
        data = mujoco.MjData(model)
        mujoco.mj_setConst(model, data)
        data.qfrc_applied[:] = 3.0
        for moving in (False, True):
            best = fastest(model, data, moving)
            what = f"{'with' if dry else 'without'} dry friction, {'in motion' if moving else 'coming to rest'}"
            print(f"MuJoCo {mujoco.__version__}, {what}: {1e6 * best:.2f} us/step, {1e-6 / best:.3f} million/s")


if __name__ == "__main__":
    main()
