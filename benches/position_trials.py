"""Blind trials of arms that record command and position only: cases for `armtwin trial draw --from`.

    python benches/position_trials.py CASES --cases 40 --seed 1
    armtwin trial draw --from CASES --out trial
    armtwin trial answer trial --out answers
    armtwin trial score trial answers -o score.md

Each case is the desk arm of scenarios/desk_arm.toml in rapier with its own friction and motions, and at most
one hidden effect at a drawn strength: root mean square of what the effect moves the joint it shows most at,
over the noise of the recorded position (rounding to 4096 steps a turn, and sensor noise). Two simulations
without noise, with and without the effect, measure it. Python's standard library is enough; ARMTWIN is the
program (target/release/armtwin).
"""
import argparse
import csv
import gzip
import json
import os
import random
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ARMTWIN = os.environ.get('ARMTWIN', str(ROOT / 'target/release/armtwin'))
JOINTS = 6
STEP, NOISE = 0.00153398, 2e-4
SIGMA = (STEP ** 2 / 12 + NOISE ** 2) ** .5
STRENGTHS = [1, 3, 10]

# Effect: unit values of its parameters, the first of which is scaled, largest scale, joints it may be at.
EFFECTS = {
    'servo_gain': ({'servo_gain_error': -0.1}, 7, range(6)),
    'servo_delay': ({'servo_delay': 0.01}, 15, None),
    'servo_dead_band': ({'servo_dead_band': 0.004}, 30, range(6)),
    'servo_offset': ({'servo_offset': 0.004}, 50, range(6)),
    'load_friction': ({'load_friction': 0.1}, 9, [1, 2, 3]),
    'stribeck': ({'stribeck_excess': 0.05, 'stribeck_velocity': 0.15, 'stribeck_exponent': 1.0}, 20, range(6)),
    'payload': ({'payload_mass': 0.03, 'payload_moment_x': 0.001, 'payload_moment_y': 0.0,
                 'payload_moment_z': 0.0}, 12, None),
    'rotor_inertia': ({'rotor_inertia': 0.01}, 10, range(6)),
    'encoder_offset': ({'encoder_offset': 0.01}, 15, [1, 2, 3]),
    'cable_spring': ({'cable_stiffness': 0.05, 'cable_rest_angle': 0.3, 'cable_hysteresis': 0.0,
                      'cable_slip_angle': 0.1}, 20, [0, 4]),
}


def scenario(case, effects, noise):
    arm = f'robot = "{ROOT}/scenarios/robots/desk_arm.urdf"\nseed = {case["seed"]}\nrate_hz = 50\nstep_s = 0.001\n'
    arm += '[drive]\nrotor_inertia = 0.028\n[servo]\nmodel = "sts3215"\nvolts = 7.4\ngain_register = 32\n'
    arm += '[controller]\nrate_hz = 500\n'
    arm += f'[motion]\nkind = "mixed"\nseed = {case["seed"] + 1}\nduration_s = {case["seconds"]}\n'
    arm += 'range_rad = 0.7\nspeed_rad_s = 2.0\nacceleration_rad_s2 = 8.0\n'
    arm += f'[check]\nseed = {case["seed"] + 2}\n'
    arm += f'[noise]\nposition_rad = {NOISE if noise else 0}\n'
    arm += f'[quantisation]\nposition_rad = {STEP if noise else 0}\n'
    for name, values in effects.items():
        arm += f'[effects.{name}]\n' + ''.join(f'{k} = {v}\n' for k, v in values.items())
    return arm


def simulate(text, out):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / 'scenario.toml'
        file.write_text(text)
        done = subprocess.run([ARMTWIN, 'simulate', str(file), '--out', str(out)], capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)


def positions(file):
    with open(file) as text:
        rows = list(csv.DictReader(text))
    return [[float(r[f'actual_q_{j}']) for r in rows] for j in range(JOINTS)]


def apart(a, b):
    return [(sum((x - y) ** 2 for x, y in zip(p, q)) / len(p)) ** .5 / SIGMA for p, q in zip(a, b)]


def moved(case, base, hidden, scratch):
    """Strength per joint and recording of a hidden effect."""
    simulate(scenario(case, {**base, **hidden}, False), scratch / 'with')
    simulate(scenario(case, base, False), scratch / 'without')
    return {which: apart(positions(scratch / 'with' / file), positions(scratch / 'without' / file))
            for which, file in (('identification', 'fit.csv'), ('validation', 'check.csv'))}


def sized(unit, size, joints):
    first = next(iter(unit))
    together = first == 'payload_mass'
    values = {k: (v * size if k == first or together else v) for k, v in unit.items()}
    return {**values, **({'joints': joints} if joints else {})}


def draw(number, arguments, folder):
    rng = random.Random(arguments.seed * 10_000 + number)
    case = {'seed': rng.randrange(1 << 30), 'seconds': arguments.seconds}
    base = {'coulomb': {'coulomb': [round(rng.uniform(.03, .09), 4) for _ in range(JOINTS)]},
            'viscous': {'viscous': [round(rng.uniform(.03, .1), 4) for _ in range(JOINTS)]}}
    names = list(EFFECTS)
    name = None if number % 4 == 3 else names[(number - number // 4) % len(names)]
    hidden, strength, gap, joints = {}, None, None, []
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        if name:
            unit, most, at = EFFECTS[name]
            joints = [rng.choice(list(at)) + 1] if at else []
            strength = STRENGTHS[(number // len(names)) % len(STRENGTHS)]
            size = 1.0
            for _ in range(3):
                hidden = {name: sized(unit, size, joints)}
                gap = moved(case, base, hidden, scratch)
                reached = max(gap['identification'])
                if 0.8 < reached / strength < 1.25:
                    break
                size = min(size * (strength / max(reached, 1e-6)), most)
        made = scratch / 'made'
        simulate(scenario(case, {**base, **hidden}, True), made)
        folder.mkdir(parents=True)
        for ours, theirs in (('fit.csv', 'identification.csv.gz'), ('check.csv', 'validation.csv.gz')):
            with gzip.open(folder / theirs, 'wb') as packed:
                packed.write((made / ours).read_bytes())
    still = [0.0] * JOINTS
    parameters = {k: v for k, v in hidden.get(name, {}).items() if k != 'joints'} if name else {}
    label = {'effect': name or 'none', 'joints': joints or ([0] if name else []), 'parameters': parameters,
             'outside_catalogue': False, 'case': folder.name, 'drawn': strength,
             'gap_over_noise': gap or {'identification': still, 'validation': still}}
    (folder / 'truth.json').write_text(json.dumps(label, indent=1))


def main():
    parse = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parse.add_argument('out', type=Path)
    parse.add_argument('--cases', type=int, default=40)
    parse.add_argument('--seed', type=int, default=1)
    parse.add_argument('--seconds', type=float, default=30.0)
    arguments = parse.parse_args()
    arguments.out.mkdir(parents=True)
    twin = (ROOT / 'scenarios/twins/desk_arm.toml').read_text()
    twin = twin.replace('../robots', str(ROOT / 'scenarios/robots'))
    (arguments.out / 'twin.toml').write_text(twin)
    for number in range(arguments.cases):
        draw(number, arguments, arguments.out / f'case-{number:03}')
        print(number + 1, 'of', arguments.cases, flush=True)


if __name__ == '__main__':
    main()
