"""Twelve parameters of a six-axis arm from 60 s of command and position: armtwin beside MuJoCo's identification.

    python3 -m venv peers && peers/bin/pip install 'mujoco[sysid]'
    peers/bin/python benches/peers/sysid.py --work WORK -o docs/sysid.md

A desk arm of six position servos is simulated in rapier with dry and viscous friction at every joint, and recorded at
50 Hz with an encoder's steps. armtwin and mujoco.sysid then find the twelve values from the same file, from the same
begin and within the same bounds, one after the other on this machine. ARMTWIN is the program (target/release/armtwin).
"""
import argparse
import json
import os
import re
import resource
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import mujoco
import numpy as np
from mujoco import sysid

ROOT = Path(__file__).resolve().parents[2]
ARMTWIN = os.environ.get('ARMTWIN', str(ROOT / 'target/release/armtwin'))
# Steps as armtwin takes them here: six from row to row, a tenth of sqrt(I/K).
SECONDS, JOINTS, STRETCH_S, STEP_S = 60, 6, 5.0, 0.02 / 6
# What is sought, N.m and N.m.s/rad, joint by joint; where both begin, and the bounds of both.
TRUE = {'coulomb': [.08, .07, .06, .05, .04, .03], 'viscous': [.09, .08, .07, .06, .05, .04]}
BEGIN, BOUNDS = {'coulomb': .02, 'viscous': .02}, {'coulomb': (0, 1.5), 'viscous': (0, 1.5)}
SIMULATED_S = .3  # a simulation begins where its command does, and the arm sags from there


def run(*arguments):
    done = subprocess.run([ARMTWIN, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f'{arguments}: {done.stderr}')


def recorded(work):
    """The recording, the twin that begins, and that twin as a MuJoCo model."""
    scenario = (ROOT / 'scenarios/desk_arm.toml').read_text()
    scenario = scenario[:scenario.index('[effects.coulomb]')]
    scenario = re.sub(r'duration_s = \d+', f'duration_s = {SECONDS}', scenario)
    scenario = scenario.replace('robots/desk_arm.urdf', str(ROOT / 'scenarios/robots/desk_arm.urdf'))
    effects = ''.join(f'[effects.{name}]\n{name} = {values}\n' for name, values in TRUE.items())
    (work / 'scenario.toml').write_text(scenario + effects)
    run('simulate', work / 'scenario.toml', '--out', work / 'made')
    twin = (ROOT / 'scenarios/twins/desk_arm.toml').read_text()
    twin = twin.replace('../robots/desk_arm.urdf', str(ROOT / 'scenarios/robots/desk_arm.urdf'))
    values = ''.join(f'{name} = {[value] * JOINTS}\n' for name, value in BEGIN.items())
    (work / 'twin.toml').write_text(f'{twin}\n[twin.values]\n{values}')
    run('export', '--twin', work / 'twin.toml', '--format', 'mjcf', '-o', work / 'arm.xml')
    return work / 'made/fit.csv', work / 'twin.toml', work / 'arm.xml'


def spent():
    """Wall clock, and time of all cores in this process and those it started, s."""
    own, others = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return np.array([time.perf_counter(), own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime])


def ours(recording, twin, work):
    began = spent()
    run('identify', recording, '--twin', twin, '--from', SIMULATED_S, '--terms', 'coulomb,viscous', '--json',
        work / 'ours.json')
    seconds = spent() - began
    method = json.loads((work / 'ours.json').read_text())['methods'][0]
    found = {(p['name'], p['joint']): p['value'] for j in method['joints'] for p in j['parameters']}
    return seconds, {name: [found[name, j + 1] for j in range(JOINTS)] for name in TRUE}


def sequences(spec, recording):
    """Stretches of 5 s that begin in measured states, as armtwin has them; velocities by central differences."""
    rows = np.genfromtxt(recording, delimiter=',', names=True)
    rows = rows[rows[rows.dtype.names[0]] >= SIMULATED_S]
    t = rows[rows.dtype.names[0]]
    column = lambda stem: np.stack([rows[f'{stem}_{j}'] for j in range(JOINTS)], 1)
    q, command = column('actual_q'), column('target_q')
    qd = np.gradient(q, t, axis=0)
    model = spec.compile()
    parts = []
    most = int(STRETCH_S / np.median(np.diff(t)))
    for k in range(0, len(t) - most, most):
        part, clock = slice(k, k + most), t[k:k + most] - t[k]
        control = sysid.TimeSeries.from_control_names(clock, command[part], model)
        # Positions as the state has them: a sensor shows that of the step before.
        names = [(model.joint(j).name, sysid.SignalType.MjStateQPos) for j in range(JOINTS)]
        shown = sysid.TimeSeries.from_names(clock, q[part], model, names)
        parts.append((f'part {k}', sysid.create_initial_state(model, q[k], qd[k]), control, shown))
    return sysid.ModelSequences('arm', spec, *map(list, zip(*parts)), allow_missing_sensors=True)


def theirs(recording, xml, optimizer):
    spec = mujoco.MjSpec.from_file(str(xml))
    spec.option.timestep = STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    names = [joint.name for joint in spec.joints]
    attribute = {'coulomb': 'frictionloss', 'viscous': 'damping'}

    def parameter(effect, joint):
        def put(spec, own):
            old = getattr(spec.joint(joint), attribute[effect])
            setattr(spec.joint(joint), attribute[effect], [own.value[0], 0, 0] if np.ndim(old) else own.value[0])
        low, high = BOUNDS[effect]
        return sysid.Parameter(f'{effect} {joint}', BEGIN[effect], low, high, modifier=put)

    parameters = sysid.ParameterDict()
    for effect in TRUE:
        for joint in names:
            parameters.add(parameter(effect, joint))
    began = spent()
    residual = sysid.build_residual_fn(models_sequences=[sequences(spec, recording)])
    found, _ = sysid.optimize(parameters, residual, optimizer=optimizer, verbose=False)
    seconds = spent() - began
    x = found.as_vector()
    return seconds, {name: list(x[i * JOINTS:(i + 1) * JOINTS]) for i, name in enumerate(TRUE)}


def table(head, rows):
    lines = ['| ' + ' | '.join(head) + ' |', '|---' + '|---:' * (len(head) - 1) + '|']
    return '\n'.join(lines + ['| ' + ' | '.join(map(str, row)) + ' |' for row in rows])


def off(values):
    return [f'{1e3 * np.mean(np.abs(np.array(values[name]) - TRUE[name])):.1f}' for name in TRUE]


def main():
    parse = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parse.add_argument('--work', type=Path, required=True)
    parse.add_argument('-o', '--out', type=Path)
    arguments = parse.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    busy = os.getloadavg()[0]
    recording, twin, xml = recorded(arguments.work)
    found = {'armtwin identify, whole program': ours(recording, twin, arguments.work)}
    for optimizer in ['mujoco', 'scipy_parallel_fd']:
        found[f'mujoco.sysid, optimizer {optimizer}'] = theirs(recording, xml, optimizer)
    rows = [[name, *(f'{s:.1f}' for s in seconds), *off(values)] for name, (seconds, values) in found.items()]
    text = '\n'.join([
        '# Speed beside MuJoCo\'s identification', '',
        'Made by `python benches/peers/sysid.py --work WORK -o docs/sysid.md`.', '',
        f'A desk arm of six servos, {SECONDS} s of command and position at 50 Hz out of rapier, encoder of 4096 steps a turn. '
        f'Dry and viscous friction of every joint are fitted, twelve values, from {BEGIN["coulomb"]:g} N.m and '
        f'{BEGIN["viscous"]:g} N.m.s/rad, over stretches of {STRETCH_S:g} s that begin in measured states, steps of {1e3 * STEP_S:.3g} ms. '
        f'One run, one after the other, {os.cpu_count()} cores of which {busy:.1f} were busy with other work, mujoco {version("mujoco")}. armtwin also works out '
        'intervals and whether the recording tells each value. The package `mujoco-sysid` is another thing: columns of '
        'inertial parameters for recorded torque, no fit to positions.', '',
        table(['fit', 's', 'of all cores, s', 'dry friction off by, mN.m', 'viscous, mN.m.s/rad'], rows)]) + '\n'
    arguments.out.write_text(text) if arguments.out else print(text)


if __name__ == '__main__':
    sys.exit(main())
