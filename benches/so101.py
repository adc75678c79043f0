"""A real SO-101, six position servos: what diagnose finds from pairs of its motions, and whether it has play.

    python3 benches/so101.py RECORDINGS --work WORK -o docs/so101.md
    (with --kept it takes the answers that WORK holds; with --only pairs, play, clock or commands it makes that section anew and
    leaves the others of the page as they are)

RECORDINGS is sage-so101. ARMTWIN is the program (target/release/armtwin).
"""
import argparse
import csv
import gzip
import json
import math
import os
import random
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ARMTWIN = os.environ.get('ARMTWIN', str(ROOT / 'target/release/armtwin'))
TWIN = """robot = "{robot}"
tip = "moving_jaw_so101_v1_link"
flange = "gripper_frame_link"
[drive]
rotor_inertia = 0.028
[servo]
gain = 17.8
damping = 0.55
max_torque = 3.35
[twin]
effects = ["coulomb", "viscous"]
"""
PAIRS = [('multisine', 'chirp_sweep'), ('chirp_sweep', 'multisine'), ('random_waypoints', 'multisine'),
         ('multisine', 'random_waypoints'), ('prbs_excitation', 'chirp_sweep'), ('chirp_sweep', 'inertia_coupling'),
         ('friction_gravity', 'random_waypoints'), ('inertia_coupling', 'friction_gravity'),
         ('slow_precision', 'multisine'), ('pick_place', 'chirp_sweep')]
# Answers of these were looked at while the method was made, ...
LOOKED_AT = [*PAIRS, ('multisine', 'inertia_coupling'), ('inertia_coupling', 'multisine'), ('step_response', 'chirp_sweep'),
             ('static_holding', 'multisine'), ('backlash_detection', 'chirp_sweep'), ('multisine', 'step_response'),
             ('hold_under_gravity', 'multisine'), ('chirp_sweep', 'pick_place'), ('friction_gravity', 'chirp_sweep'),
             ('multisine', 'friction_gravity'), ('pick_place', 'friction_gravity'), ('multisine', 'static_holding'),
             ('slow_precision', 'inertia_coupling'), ('step_response', 'static_holding'),
             ('pick_place', 'static_holding'), ('random_waypoints', 'friction_gravity'),
             ('slow_precision', 'prbs_excitation'), ('random_waypoints', 'step_response'),
             ('pick_place', 'step_response'), ('inertia_coupling', 'backlash_detection'),
             ('friction_gravity', 'hold_under_gravity'), ('random_waypoints', 'prbs_excitation'),
             ('inertia_coupling', 'pick_place'), ('backlash_detection', 'slow_precision'),
             ('chirp_sweep', 'hold_under_gravity'), ('hold_under_gravity', 'slow_precision'),
             ('prbs_excitation', 'static_holding'), ('hold_under_gravity', 'random_waypoints'),
             ('friction_gravity', 'step_response'), ('pick_place', 'prbs_excitation'),
             ('backlash_detection', 'step_response'), ('pick_place', 'random_waypoints'),
             ('backlash_detection', 'pick_place'), ('backlash_detection', 'hold_under_gravity'),
             ('friction_gravity', 'slow_precision'), ('chirp_sweep', 'random_waypoints'),
             ('inertia_coupling', 'step_response'), ('friction_gravity', 'static_holding'),
             ('hold_under_gravity', 'static_holding'), ('hold_under_gravity', 'inertia_coupling'),
             ('backlash_detection', 'random_waypoints'), ('pick_place', 'slow_precision'),
             ('hold_under_gravity', 'step_response'), ('inertia_coupling', 'static_holding'),
             ('random_waypoints', 'slow_precision'), ('prbs_excitation', 'step_response'),
             ('random_waypoints', 'static_holding'), ('backlash_detection', 'multisine'),
             ('hold_under_gravity', 'pick_place'), ('chirp_sweep', 'slow_precision')]
# ... of these, drawn at random (random.seed(2322)) from the 12 pairs of which none had been, either way round, none was.
FRESH = [('slow_precision', 'static_holding'), ('backlash_detection', 'prbs_excitation'),
         ('inertia_coupling', 'prbs_excitation'), ('inertia_coupling', 'random_waypoints'),
         ('multisine', 'prbs_excitation'), ('hold_under_gravity', 'prbs_excitation'),
         ('backlash_detection', 'friction_gravity'), ('multisine', 'pick_place')]
# Of the pairs, those that should name the same leading cause.
AGREE = 0.9
# What the makers' MuJoCo model has between motor and link, rad to either side: 0.5 degrees.
MAKERS_PLAY = 0.00873
# Motions in which play is looked for (one was recorded for that), and the one that decides.
PLAY, JUDGE = ['backlash_detection', 'chirp_sweep', 'multisine'], 'inertia_coupling'
WITHOUT = 'coulomb,viscous,servo_gain,payload'
# Copies of a recording with other times, of which the mean counts.
COPIES = 5
# Commands of all motions are held against those of this one.
BESIDE = 'inertia_coupling'
TEETH = {'backlash_gap': 2 * MAKERS_PLAY, 'backlash_stiffness': 500, 'backlash_damping': 0.5}


class Arm:
    """Recordings, the twin, and answers that are there already."""

    def __init__(self, arguments):
        self.folder, self.work = arguments.recordings, arguments.work
        self.kept, self.only_kept = arguments.kept or arguments.only_kept, arguments.only_kept
        self.twin = self.work / 'so101.toml'
        self.work.mkdir(parents=True, exist_ok=True)
        self.slack = self.work / 'so101_slack.toml'
        plain = TWIN.format(robot=self.folder / 'so101_new_calib.urdf')
        self.twin.write_text(plain)
        values = '\n'.join(f'{name} = {[value] * 6}' for name, value in TEETH.items())
        self.slack.write_text(f'{plain}[twin.values]\n{values}\n'.replace('"viscous"]', '"viscous", "backlash"]'))

    def answer(self, name, command, *arguments, twin=None):
        """The JSON that a command writes. What `identify` fits is kept in `name`.toml."""
        out, fitted = self.work / f'{name}.json', self.work / f'{name}.toml'
        save = ['--save-twin', fitted] if command == 'identify' else ['--out', self.work / name]
        if not (self.kept and out.exists()):
            ran = subprocess.run([ARMTWIN, command, *map(str, arguments), '--from', '5', '--to', '35',
                                  '--twin', twin or self.twin, '--json', out, *save], capture_output=True, text=True)
            if ran.returncode:
                raise RuntimeError(f'{command} {name}: {ran.stderr}')
        return json.loads(out.read_text())


def table(head, rows):
    lines = ['| ' + ' | '.join(head) + ' |', '|---' + '|---:' * (len(head) - 1) + '|']
    return '\n'.join(lines + ['| ' + ' | '.join(map(str, row)) + ' |' for row in rows])


def mrad(rad):
    return f'{1e3 * rad:.1f}'


def names(cause):
    return ' or '.join(' '.join([c['effect'], *map(str, c['joints'])]) for c in [cause, *cause['equivalent']])


def leading(answers):
    """The effects that lead the answers, or are equal to what leads, and in how many they do."""
    counts = {}
    for found in answers:
        for effect in {e['effect'] for c in found['causes'][:1] for e in [c, *c['equivalent']]}:
            counts[effect] = counts.get(effect, 0) + 1
    return counts


def pairs(arm):
    is_asked = lambda pair: not arm.only_kept or (arm.work / f'{"_".join(pair)}.json').exists()
    looked_at, fresh = [list(filter(is_asked, some)) for some in (LOOKED_AT, FRESH)]
    answers = {(fit, check): arm.answer(f'{fit}_{check}', 'diagnose', '--fit', arm.folder / fit,
                                        '--check', arm.folder / check) for fit, check in looked_at + fresh}
    causes = [c for found in answers.values() for c in found['causes']]
    masses = [v['value'] for c in causes for v in c['parameters'] if v['name'] == 'payload_mass']
    counts = leading(answers.values())
    name, count = max(counts.items(), key=lambda item: item[1], default=('nothing', 0))
    known, unknown = [leading(answers[pair] for pair in some).get(name, 0) for some in (looked_at, fresh)]
    met = 'met' if count >= AGREE * len(answers) else '**not met**'
    rows, joints = [], []
    for (fit, check), found in answers.items():
        position = found['position']
        said = '; '.join(f'{names(c)} ({100 * c["probability"]:.0f} %)' for c in found['causes'])
        sizes = [mrad(at[k]) for at in (position['cross_validated'], position) for k in ('before_rad', 'after_rad')]
        rows.append([fit, check, *sizes, said or 'none', f'{found["seconds"]:.0f}'])
        joints.append([f'{fit}, {check}', *(f'{mrad(j["before_rad"])}, {mrad(j["after_rad"])}'
                                            for j in position['joints'])])
    rounding = [mrad(j['rounding_rad']) for j in position['joints']]
    steps = [found['position'].get('step_s') for found in answers.values()]
    told = ' or '.join(sorted({f'{1e3 * step:.3g} ms' for step in steps if step}))
    silent = steps.count(None)
    older = f'{silent} answers are of an earlier state, whose steps may be others than the present ones. ' if silent else ''
    return '\n'.join([
        f'The same leading cause, or its equal, should be named in {100 * AGREE:.0f} % of the pairs: {met}, {name} in '
        f'{count} of {len(answers)}: in {known} of the first {len(looked_at)}, of the {len(LOOKED_AT)} whose answers were '
        f'looked at while the method was made, and in {unknown} of the other {len(fresh)}, whose were not. A payload that '
        f'leads or is a cause weighs {min(masses):.3f} to {max(masses):.3f} kg (median {statistics.median(masses):.3f}, '
        f'{len(masses)} pairs). Values are fitted to both recordings. '
        f'{f"Steps of the simulation: {told}. " if told else ""}{older}Seconds are of the clock, beside whatever else ran.', '',
        table(['searched', 'decided on', 'unseen, mean size before, mrad', 'after', 'rms before', 'after', 'causes', 's'], rows), '',
        'Joint by joint, root mean square before and after, mrad; what rounding to the encoder\'s 1.53 mrad alone leaves:',
        '', table(['', '1', '2', '3', '4', '5', '6'], joints + [['rounding', *rounding]])])


def times(folder, file):
    """Head and rows of a file of SAGE, and the times of the rows, us."""
    head, *rows = csv.reader(gzip.open(folder / file, 'rt'))
    return head, rows, [float(row[head.index('timestamp')]) for row in rows]


def scatter(folder):
    """Standard deviation of the time from row to row, and the largest distance of a row from an even clock, us."""
    _, _, t = times(folder, 'state_motor.csv.gz')
    step = (t[-1] - t[0]) / (len(t) - 1)
    return statistics.stdev(b - a for a, b in zip(t, t[1:])), max(abs(x - t[0] - step * k) for k, x in enumerate(t))


def shaken(folder, to, sigma, seed):
    """A copy of a recording whose positions were read at times `sigma` us off those that stand there."""
    if to.exists():
        return to
    to.mkdir(parents=True)
    noise = random.Random(seed)
    head, rows, t = times(folder, 'state_motor.csv.gz')
    off = [noise.gauss(0, sigma) for _ in t]
    for file in ['state_motor.csv.gz', 'control.csv.gz']:
        head, rows, _ = times(folder, file)
        place = head.index('timestamp')
        with gzip.open(to / file, 'wt', newline='') as out:
            csv.writer(out).writerows([head] + [[*row[:place], x + d, *row[place + 1:]]
                                                for row, x, d in zip(rows, t, off)])
    return to


def clock(arm):
    """How the mended twin's position error changes with the clock of the recording that decides."""
    rows = []
    for fit, check in PAIRS:
        sigma, drift = scatter(arm.folder / check)
        copies = [shaken(arm.folder / check, arm.work / 'shaken' / f'{check}_{part}_{seed}', by, seed)
                  for part, by in [('step', sigma), ('clock', drift)] for seed in range(COPIES)]
        checks = [x for folder in [arm.folder / check, *copies] for x in ('--check', folder)]
        method = arm.answer(f'{fit}_{check}_clock', 'identify', arm.folder / fit, *checks, '--terms', 'coulomb',
                            twin=arm.work / f'{fit}_{check}' / 'twin.toml')['methods'][0]
        rms = [(statistics.mean(j['rms_rad'] ** 2 for j in gaps['joints'])) ** .5 for gaps in method['check']['before']]
        changes = [1e6 * (statistics.mean(rms[1 + k * COPIES:1 + (k + 1) * COPIES]) - rms[0]) for k in range(2)]
        rounding = statistics.mean(j['rounding_rad'] ** 2 for j in method['check']['before'][0]['joints'])
        rows.append([f'{fit}, {check}', mrad(rms[0]), f'{1e3 * (rms[0] - (rms[0] ** 2 - rounding) ** .5):.3f}',
                     f'{sigma:.0f}', f'{changes[0]:+.1f}', f'{drift:.0f}', f'{changes[1]:+.1f}'])
    return '\n'.join([
        'Of the error after, how much is rounding: what would be less if the encoder had no steps. And how much the clock: '
        'the error of the same twin along the recording with every time moved at random (mean of '
        f'{COPIES} copies), by as much as its steps scatter, and by as much as its rows are at most from an even clock. '
        'What is no scatter, positions read a little before or after the command was sent, comes below.', '',
        table(['pair', 'after, mrad', 'of it rounding', 'steps scatter by, us', 'error changes by, urad',
               'from an even clock, us', 'error changes by, urad'], rows)])


def commands(arm):
    """Do loggers note commands of all motions alike?"""
    motions = sorted(f.name for f in arm.folder.iterdir() if f.is_dir() and f.name != BESIDE)
    checks = [x for motion in motions for x in ('--check', arm.folder / motion)]
    method = arm.answer('commands', 'identify', arm.folder / BESIDE, *checks, '--terms', 'coulomb,viscous')['methods'][0]
    nothing = {'late_s': 0, 'standard_error_s': 0}
    told = {BESIDE: nothing, **{m: o or nothing for m, o in zip(motions, method['check']['time_offset'])}}
    closed = []
    for pair in LOOKED_AT + FRESH:
        known = arm.work / f'{"_".join(pair)}.json'
        own = known.exists() and json.loads(known.read_text())['position']['time_offset']
        if own:
            fit, check = (told[motion] for motion in pair)
            off = own['late_s'] - (check['late_s'] - fit['late_s'])
            closed.append((off, math.hypot(*(o['standard_error_s'] for o in (own, fit, check)))))
    rms = lambda values: 1e3 * math.sqrt(statistics.mean(x * x for x in values)) if values else math.nan
    off, expected = [rms([x[k] for x in closed]) for k in (0, 1)]
    rows = [[motion, f'{1e3 * o["late_s"]:+.1f}', f'{1e3 * o["standard_error_s"]:.1f}']
            for motion, o in sorted(told.items(), key=lambda item: item[1]['late_s']) if motion != BESIDE]
    return '\n'.join([
        f'How much later than in {BESIDE} commands are sent beside positions, with its standard error, ms (rows are 20 ms apart). '
        'It is told by all joints together, and is no delay of the servos, which is the same along every motion. '
        f'{len(closed)} of the pairs above tell the difference of their two motions by themselves: it is off by '
        f'{off:.1f} ms (rms), where {expected:.1f} ms are expected of the errors of all three.', '',
        table(['motion', 'later, ms', 'standard error, ms'], rows)])


def size(gaps):
    """Mean position error over the joints of one recording."""
    return statistics.mean(j['mean_abs_rad'] for j in gaps[0]['joints'])


def play(arm):
    rows = []
    for motion in PLAY:
        near = arm.work / f'{motion}_play_the.toml'
        for name, twin, more in [('none', arm.twin, ''), ('the makers\'', arm.slack, ''), ('fitted', near, ',backlash')]:
            method = arm.answer(f'{motion}_play_{name[:3]}', 'identify', arm.folder / motion, '--check',
                                arm.folder / JUDGE, '--terms', WITHOUT + more, twin=twin)['methods'][0]
            gaps = {p['joint']: p for p in (p for j in method['joints'] for p in j['parameters'])
                    if p['name'] == 'backlash_gap'}
            told = [f'{mrad(gaps[j]["value"])}' + ('' if gaps[j]['identifiable'] else ' (not told)')
                    for j in sorted(gaps)] or ['-'] * 6
            rows.append([motion, name, mrad(size(method['fit']['after'])), mrad(size(method['check']['after'])), *told])
    return '\n'.join([
        f'The makers\' MuJoCo model has {mrad(2 * MAKERS_PLAY)} mrad of play at every joint, both directions together. '
        'Encoders are at the servos, whose rotors hardly feel a gap. Friction, gains and a load are fitted without play, '
        'with the makers\', and with play fitted from there; mean position error on the motion that was fitted and on '
        f'{JUDGE}, mrad, then the gap joint by joint. In the pairs above play was searched as well, and is no cause.', '',
        table(['motion', 'play', 'fitted', JUDGE, '1', '2', '3', '4', '5', '6'], rows)])


SECTIONS = {'pairs': ('## Causes in pairs of motions', pairs), 'play': ('## Is there play?', play),
            'clock': ('## Rounding and clock', clock),
            'commands': ('## Are commands noted alike?', commands)}


def section(page, head):
    """What stands under a head of a page; empty where there is no such head."""
    text = page.read_text() if page and page.exists() else ''
    return text.partition(f'{head}\n')[2].split('\n## ', 1)[0].strip()


def main():
    parse = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parse.add_argument('recordings', type=Path)
    parse.add_argument('--work', type=Path, required=True)
    parse.add_argument('--kept', action='store_true', help='take the answers that are there')
    parse.add_argument('--only-kept', action='store_true', help='of the pairs, those whose answers are there')
    parse.add_argument('--only', nargs='+', choices=SECTIONS, default=list(SECTIONS), help='sections that are made anew')
    parse.add_argument('-o', '--out', type=Path)
    arguments = parse.parse_args()
    began, arm = time.time(), Arm(arguments)
    text = ['# A real SO-101', '', 'Made by `python3 benches/so101.py RECORDINGS --work WORK -o docs/so101.md`.', '',
            "Six STS3215 (isaac-sim2real/sage, 50 Hz). The twin is the makers' URDF and MuJoCo values, Coulomb and viscous "
            'friction open, loads at their gripper frame; 30 s of two motions are fitted in halves, and what is not fitted decides. The twin is then led along the second one '
            'from the first sample to the last. Before: friction fitted, nothing added. In random_waypoints joints 2 to 4 are '
            'stopped together twice (6 to 7 s, 21 to 22 s), by something that the given twin does not have; causes are decided by '
            'the size of errors, the root mean square there is that of the stops. The velocities that are recorded of the jaw are '
            '2.3 times the rate of its recorded angles (`armtwin inspect` says so): its angles are in another unit, which the twin '
            'does not know, so that causes at joint 6 are partly of that.']
    for name, (head, make) in SECTIONS.items():
        own = make(arm) if name in arguments.only else section(arguments.out, head)
        text += ['', head, '', own] if own else []
    print(f'{time.time() - began:.0f} s', file=sys.stderr)
    page = '\n'.join(text) + '\n'
    arguments.out.write_text(page) if arguments.out else print(page)


if __name__ == '__main__':
    main()
