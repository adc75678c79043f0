"""One position servo: armtwin beside bam.

    git clone https://github.com/Rhoban/bam && python3 -m venv peers && peers/bin/pip install optuna cmaes numpy
    peers/bin/python benches/peers/servos.py RECORDINGS --bam bam --work WORK -o docs/servos.md
    (with --no-fits it takes the fits that WORK holds; with --told it makes the section about load and gain alone)

RECORDINGS holds rhoban-bam_xl330. bam's models M1 to M6 are fitted by bam's own fit.py (CMA-ES
by optuna, --trials of them) on the logs of FIT and judged by its own simulator on all others; its fits are kept
in WORK, where those that are there are not made again. ARMTWIN is the program (target/release/armtwin).
"""
import argparse
import gzip
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
ARMTWIN = os.environ.get('ARMTWIN', str(ROOT / 'target/release/armtwin'))
FIT_KP, FIT_MOTIONS = (100, 400), ('sin_sin', 'lift_and_drop', 'sin_time_square')
MODELS = ['m1', 'm2', 'm3', 'm4', 'm5', 'm6']
USUAL = 'servo_gain,servo_damping,servo_delay,encoder_offset,rotor_inertia,coulomb,viscous'
TERMS = {'dry and viscous': USUAL, 'and load friction': USUAL + ',load_friction',
         'and friction with the motor\'s torque': USUAL + ',servo_friction',
         'and both': USUAL + ',load_friction,servo_friction'}


def armtwin(*arguments):
    done = subprocess.run([ARMTWIN, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f'{arguments}: {done.stderr}')
    return done.stdout


def logs(folder):
    """(file, kp, motion) of every log, in the order they were recorded."""
    found = []
    for file in sorted(folder.glob('*.json.gz')):
        log = json.loads(gzip.open(file).read())
        found.append((file, log['kp'], log['trajectory']))
    return found


def is_fitted(log):
    return log[1] in FIT_KP and log[2] in FIT_MOTIONS


def bam(all_logs, arguments):
    """Mean absolute position error of bam's models on the logs that were not fitted, rad, log by log."""
    work = arguments.work
    environment = dict(os.environ, PYTHONPATH=f'{arguments.bam}:{work / "stub"}', OMP_NUM_THREADS='1')
    (work / 'stub').mkdir(parents=True, exist_ok=True)
    (work / 'stub/wandb.py').write_text('')
    for part in ('fit', 'unseen'):
        raw = work / f'raw_{part}'
        raw.mkdir(exist_ok=True)
        (work / part).mkdir(exist_ok=True)
        for log in all_logs:
            if is_fitted(log) == (part == 'fit'):
                (raw / log[0].name.removesuffix('.gz')).write_bytes(gzip.open(log[0]).read())
        subprocess.run([sys.executable, '-m', 'bam.process', '--raw', raw, '--logdir', work / part],
                       env=environment, check=True, capture_output=True)
    (work / 'params').mkdir(exist_ok=True)
    for model in MODELS:
        file, log = work / f'params/{model}.json', work / f'params/{model}.log'
        if not file.exists() and not arguments.no_fits:
            with open(log, 'w') as out:
                subprocess.run([sys.executable, '-m', 'bam.fit', '--logdir', work / 'fit', '--actuator', 'xl330',
                                '--model', model, '--trials', str(arguments.trials), '--output', file],
                               env=environment, check=True, stdout=out, stderr=out)
    sys.path[:0] = [str(arguments.bam), str(work / 'stub')]
    from bam import simulate
    from bam.logs import Logs
    from bam.model import load_model
    unseen = Logs(str(work / 'unseen')).logs
    found = {}
    for model in MODELS:
        if not (work / f'params/{model}.json').exists():
            continue
        loaded = load_model(str(work / f'params/{model}.json'))
        errors = []
        for log in sorted(unseen, key=lambda log: log['filename']):
            predicted, _, _ = simulate.Simulator(loaded).rollout_log(log, simulate_control=True)
            measured = np.array([entry['position'] for entry in log['entries']])
            errors.append(float(np.mean(np.abs(np.array(predicted) - measured))))
        found[f'bam {model.upper()}'] = errors
    return found


def ours(all_logs, work):
    """The same of armtwin with several groups of terms, and the fit of the last one."""
    twin = ROOT / 'scenarios/twins/xl330_pendulum.toml'
    fit = [log[0] for log in all_logs if is_fitted(log)]
    checks = [x for log in all_logs if not is_fitted(log) for x in ('--check', log[0])]
    found, seconds, fits = {}, {}, {}
    for name, terms in TERMS.items():
        out = work / 'ours.json'
        armtwin('identify', *fit, *checks, '--twin', twin, '--every-row', '--terms', terms, '--json', out)
        method = json.loads(out.read_text())['methods'][0]
        found[f'armtwin, {name}'] = [g['joints'][0]['mean_abs_rad'] for g in method['check']['after']]
        seconds[name] = method['joints'][0]['seconds']
        fits[name] = method['joints'][0]['parameters']
    return found, seconds, fits


def table(head, rows):
    lines = ['| ' + ' | '.join(head) + ' |', '|---' + '|---:' * (len(head) - 1) + '|']
    return '\n'.join(lines + ['| ' + ' | '.join(map(str, row)) + ' |' for row in rows])


def mrad(rad):
    return f'{1e3 * rad:.1f}'


def one_servo(arguments):
    all_logs = logs(arguments.recordings / 'rhoban-bam_xl330')
    unseen = [log for log in all_logs if not is_fitted(log)]
    peers = bam(all_logs, arguments)
    own, seconds, fits = ours(all_logs, arguments.work)
    everything = {**peers, **own}
    motions = sorted({log[2] for log in unseen})
    rows = []
    for name, errors in everything.items():
        of = [np.mean([e for e, log in zip(errors, unseen) if log[2] == motion]) for motion in motions]
        rows.append([name, mrad(np.mean(errors)), *map(mrad, of)])
    best = min(np.mean(e) for e in peers.values()) if peers else float('nan')
    least = min(own, key=lambda name: np.mean(own[name]))
    below = 'met' if np.mean(own[least]) < best else '**not met**'
    missing = [m.upper() for m in MODELS if f'bam {m.upper()}' not in peers]
    text = [f'Goal: less position error than the best of bam\'s models on logs that were not fitted. {below}: '
            f'{mrad(np.mean(own[least]))} mrad ({least}) beside {mrad(best)} mrad.',
            '', table(['mean absolute error, mrad', 'all', *motions], rows), '']
    if missing:
        text += [f'bam\'s {", ".join(missing)} were not fitted here in time.', '']
    last = list(fits)[-1]
    text += [f'armtwin took {", ".join(f"{s:.0f}" for s in seconds.values())} s for these groups. '
             f'Values, {last}:', '',
             table(['parameter', 'value', '99 % interval', 'unit', 'told'],
                   [[p['name'], f'{p["value"]:.4f}', f'{p["low"] or 0:.4f} to {p["high"] or 0:.4f}', p['unit'],
                     'yes' if p['identifiable'] else 'no'] for p in fits[last]])]
    return '\n'.join(text)


MASS, ARM, GRAVITY = .49, .1, 9.81
# How near gravity should come back.
NEAR = .05
# Gain register of a log, and the one that the twin is told.
REGISTERS = [(200, 400), (800, 400), (200, 100), (200, 200), (800, 800)]
FRICTION = ('friction', 'coulomb', 'viscous', 'stribeck', 'lugre', 'maxwell', 'presliding')


def unloaded(work):
    """The twin with a rod that weighs nothing."""
    urdf = (ROOT / 'scenarios/robots/xl330_pendulum.urdf').read_text()
    end = (f'<link name="end"/><joint name="rod" type="fixed"><parent link="arm"/><child link="end"/>'
           f'<origin xyz="0 0 -{ARM}"/></joint></robot>')
    urdf = urdf.replace('1e-6', '1e-9').replace(f'value="{MASS}"', 'value="1e-6"').replace('</robot>', end)
    (work / 'unloaded.urdf').write_text(urdf)
    twin = (ROOT / 'scenarios/twins/xl330_pendulum.toml').read_text()
    (work / 'unloaded.toml').write_text(twin.replace('"../robots/xl330_pendulum.urdf"', '"unloaded.urdf"'))
    return work / 'unloaded.toml'


def gravity(all_logs, work):
    """The load's torque at the horizontal, N.m, where the twin has no load, and what of the motor is taken as known."""
    true, rows = MASS * ARM * GRAVITY, []
    # Which way gravity pulls is the load's to say.
    usual = [t for t in TERMS['and both'].split(',') if t != 'encoder_offset'] + ['payload']
    known = [('gain as published', ['servo_gain']), ('rotor as bam found it', ['rotor_inertia']), ('neither', [])]
    for name, kept in known:
        for which, chosen in [('the six', [x for x in all_logs if is_fitted(x)]), ('all sixteen', all_logs)]:
            terms = ','.join(t for t in usual if t not in kept)
            armtwin('identify', *(log[0] for log in chosen), '--twin', unloaded(work), '--every-row', '--terms', terms,
                    '--json', work / 'gravity.json')
            load = {p['name']: p for p in json.loads((work / 'gravity.json').read_text())['methods'][0]['arm']}
            mass, x, z = (load[f'payload_{part}'] for part in ('mass', 'moment_x', 'moment_z'))
            found = GRAVITY * np.hypot(ARM * mass['value'] - z['value'], x['value'])
            met = 'met' if abs(found / true - 1) <= NEAR else '**not met**'
            # What the logs do not tell has no interval.
            within = 'not told' if mass['low'] is None else f'{mass["low"]:.2f} to {mass["high"]:.2f}'
            rows.append([name, which, f'{found:.3f}', f'{100 * (found / true - 1):+.0f} %', met,
                         f'{mass["value"]:.2f} ({within})'])
    return table(['known', 'logs', 'gravity, N.m', 'off by', f'within {100 * NEAR:.0f} %', 'mass (99 %), kg'], rows)


def another_gain(all_logs, work):
    """What diagnose names where a log says another gain register than the servo had."""
    armtwin('identify', *(log[0] for log in all_logs if is_fitted(log)), '--twin',
            ROOT / 'scenarios/twins/xl330_pendulum.toml', '--every-row', '--terms', TERMS['and both'], '--save-twin',
            work / 'fitted.toml', '--overwrite')
    by = {(kp, motion): file for file, kp, motion in all_logs}
    rows, friction, wrong = [], 0, 0
    for kp, said in REGISTERS:
        files = {}
        for motion in ['sin_sin', 'sin_time_square']:
            files[motion] = work / f'{motion}_{kp}_{said}.json'
            files[motion].write_text(json.dumps({**json.loads(gzip.open(by[kp, motion]).read()), 'kp': said}))
        for fit, check in [tuple(files), tuple(files)[::-1]]:
            armtwin('diagnose', '--fit', files[fit], '--check', files[check], '--twin', work / 'fitted.toml', '--every-row',
                    '--json', work / 'gain.json')
            found = json.loads((work / 'gain.json').read_text())
            names = [c['effect'] for c in found['causes']]
            if kp != said:
                wrong += 1
                friction += any(part in name for name in names for part in FRICTION)
            rows.append([kp, said, fit, mrad(found['position']['before_rad']), mrad(found['position']['after_rad']),
                         ', '.join(names) or 'none'])
    met = 'met' if friction == 0 else '**not met**'
    return '\n'.join([
        f'Another gain register than the logs say must not be called friction: {met}, a friction is among the causes in '
        f'{friction} of {wrong}.', '', table(['register', 'said', 'searched', 'before, mrad', 'after', 'causes'], rows)])


TOLD = '## Is a load told, and another gain?'


def told(arguments):
    """The section that needs no fit of bam."""
    all_logs = logs(arguments.recordings / 'rhoban-bam_xl330')
    return '\n'.join([
        TOLD, '', f'The known {MASS * ARM * GRAVITY:.2f} N.m of gravity, taken out of the twin (its rod weighs nothing), should '
        f'come back within {100 * NEAR:.0f} %. Torque, gain and inertia of one servo could all be larger by the same factor: '
        'something of the motor has to be known, its gain, or its rotor beside the free fall in two logs.', '',
        gravity(all_logs, arguments.work), '',
        'Then the twin fitted to the six logs (load in place), and two logs of one register that say another one; the last '
        'rows say the right one.', '', another_gain(all_logs, arguments.work)])


NOT_MEASURED = """## Not measured, and not met

* One log, up_and_down at register 800, in which the servo stalls at full duty, was known to be missed by every model
  with friction of the load alone before `servo_friction` was written; it is one of the ten that are not fitted."""


def put(section, page):
    """Puts a section in place of that of the same head."""
    if not page:
        return print(section)
    text = page.read_text()
    before, _, rest = text.partition(section.splitlines()[0])
    after = rest[rest.index('\n## ') + 1:] if '\n## ' in rest else ''
    if not rest:
        before, _, after = text.partition('## Not measured')
        after = '## Not measured' + after
    page.write_text(f'{before}{section}\n\n{after}')


def main():
    parse = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parse.add_argument('recordings', type=Path)
    parse.add_argument('--bam', type=Path)
    parse.add_argument('--work', type=Path, required=True)
    parse.add_argument('--trials', type=int, default=3000)
    parse.add_argument('--no-fits', action='store_true', help='take the fits of bam that are there')
    parse.add_argument('--told', action='store_true', help='make the section about load and gain alone')
    parse.add_argument('-o', '--out', type=Path)
    arguments = parse.parse_args()
    began = time.time()
    arguments.work.mkdir(parents=True, exist_ok=True)
    if arguments.told:
        put(told(arguments), arguments.out)
        return
    if not arguments.bam:
        parse.error('--bam is needed for all but --told')
    page = ['# One servo beside bam', '',
            'Made by `python benches/peers/servos.py RECORDINGS --bam BAM --work WORK -o docs/servos.md`.', '',
            'A Dynamixel XL330 that moves .49 kg at .10 m, 16 logs of 6 s (four gain registers, four motions). '
            f'Fitted are kp {" and ".join(map(str, FIT_KP))} with the motions {", ".join(FIT_MOTIONS)}, six logs; '
            'all figures are of the ten others, each simulated from its first sample to its last. bam\'s models '
            f'by bam\'s own fit (CMA-ES, {arguments.trials} trials each, its loss) and simulator at 5 ms.', '',
            one_servo(arguments), '', told(arguments), '', NOT_MEASURED]
    text = '\n'.join(page) + '\n'
    print(f'{time.time() - began:.0f} s', file=sys.stderr)
    arguments.out.write_text(text) if arguments.out else print(text)


if __name__ == '__main__':
    main()
