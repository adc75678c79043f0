"""A rigid body fitted to real recordings: armtwin, aurt, plain least squares and the nominal table.

    python3 -m venv peers && peers/bin/pip install aurt==0.0.4
    peers/bin/python benches/peers/rigid_body.py RECORDINGS -o docs/rigid_body.md

RECORDINGS holds shamilmamedov-dynamic_calibration (a UR10e) and kkufieta-ur5_modeling_force_estimate
(a UR5). Every method reads the same samples, resampled to 500 Hz, and is judged on the same rows: those
that `armtwin identify` keeps. Runs on one core. ARMTWIN is the program (target/release/armtwin).
"""
import argparse
import csv
import inspect
import json
import logging
import os
import pickle
import platform
import shutil
import signal as signals
import subprocess
import sys
import textwrap
import time
import tomllib
import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path

os.environ.setdefault('OMP_NUM_THREADS', '1')
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')

import numpy as np
from scipy import signal
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

ROOT = Path(os.environ.get('ARMTWIN_ROOT', Path(__file__).resolve().parents[2]))
RATE, MOTION_HZ, TORQUE_HZ, ORDER = 500.0, 20.0, 8.0, 4
STANDSTILL, GUARD_S, MARGIN_S = 0.02, 0.1, 0.5
EVERY = int(RATE / (2.5 * TORQUE_HZ))
JOINTS = 6
GRAVITY = 9.81

# Denavit-Hartenberg rows d, a, alpha, as in the manufacturer's table; aurt reads them shifted by one
# joint, so this is also what its own examples (ur5e_dh.csv) look like.
ALPHA = ['pi/2', '0', '0', 'pi/2', '-pi/2', '0']
ARMS = {
    'ur10e': {
        'title': 'UR10e',
        'folder': 'shamilmamedov-dynamic_calibration',
        'fit': 'identification_data/ur-20_02_12-40sec_12harm',
        'checks': ['validation_data/ur-20_01_17-ptp_10_points',
                   'identification_data/ur-20_02_10-30sec_12harm',
                   'identification_data/ur-20_02_19_14harm50sec'],
        'columns': 'ur10e_shamilmamedov.toml',
        'remark': '',
        'd': [.1807, 0, 0, .17415, .11985, .11655],
        'a': [0, -.6127, -.57155, 0, 0, 0],
    },
    'ur5': {
        'title': 'UR5 (CB series)',
        'folder': 'kkufieta-ur5_modeling_force_estimate',
        'fit': 'Movement_No6_Acc_slow_Verify_Model',
        'checks': ['Movement_No7_Acc_slow_Verify_Model_short',
                   'Movement_No5_Acc_slow_no_disturbance'],
        'columns': None,
        'remark': 'No7 repeats a part of the same path, No5 is another path. ',
        'd': [.089159, 0, 0, .109915, .09465, .0823],
        'a': [0, -.425, -.39225, 0, 0, 0],
    },
}

# Terms of a joint beside the rigid body; what armtwin is asked for, and the columns here.
LEVELS = {
    'plain': ('dry and viscous friction, rotor inertia', 'inertia,rotor_inertia',
              ['dry', 'viscous', 'rotor']),
    'full': ('also an offset and load-dependent friction', 'inertia,rotor_inertia,offset,load_friction',
             ['dry', 'viscous', 'rotor', 'offset', 'load']),
    'curved': ('also quadratic and cubic viscous friction',
               'inertia,rotor_inertia,offset,load_friction,viscous_quadratic,viscous_cubic',
               ['dry', 'viscous', 'rotor', 'offset', 'load', 'quadratic', 'cubic']),
}
# aurt's own: load model and powers of its viscous friction; and which of them stands in which group. The
# last is that of its README and tests.
FRICTIONS = {'none, powers 1': ('none', [1]),
             'none, powers 1 2 4': ('none', [2, 1, 4]),
             'square, powers 1': ('square', [1]),
             'square, powers 1 2 4': ('square', [2, 1, 4])}
BESIDE = {'plain': 'none, powers 1', 'full': 'square, powers 1', 'curved': 'square, powers 1 2 4'}
README = BESIDE['curved']
# What it reads as currents. It fits one set of links to the currents of all joints, as if all had the same
# N.m per A; fed with torques instead it need not.
FED = {'torques': 'torques', 'smoothed': 'torques, positions low-passed at 20 Hz', 'currents': 'currents'}


# --- recordings ---------------------------------------------------------------------------------------

def low_passed(x, cutoff, axis=-1):
    sos = signal.butter(ORDER, cutoff, fs=RATE, output='sos')
    return signal.sosfiltfilt(sos, x, axis=axis)


def eroded(mask, reach):
    """False also within `reach` samples of a false one."""
    off = np.convolve(~mask, np.ones(2 * reach + 1), 'same') > .5
    return mask & ~off


class Run:
    """One recording at 500 Hz, and the rows it is judged on."""

    def __init__(self, program, arm, name, work, ampere):
        self.name = name.split('/')[-1]
        self.path = recording(arm, name)
        columns = ['--columns', ROOT / 'scenarios/columns' / arm['columns']] if arm['columns'] else []
        plain = work / f'{self.name}.csv'
        call([program, 'convert', self.path, '-o', plain, *columns])
        with open(plain, newline='') as file:
            rows = list(csv.DictReader(file))
        t = np.array([float(r['timestamp']) for r in rows])

        def of(signal_name):
            return np.array([[float(r[f'{signal_name}_{j}']) for r in rows] for j in range(JOINTS)])

        n = int((t[-1] - t[0]) * RATE + 1e-3) + 1
        n -= (n - 12) % 10  # aurt 0.0.4 predicts only where its two ways of counting samples agree
        self.t = np.arange(n) / RATE
        grid = t[0] + self.t
        self.recorded_hz = (len(t) - 1) / (t[-1] - t[0])
        self.q, self.qd_recorded, self.current = (
            CubicSpline(t, of(s), axis=1)(grid) for s in ('actual_q', 'actual_qd', 'actual_current'))
        q = low_passed(self.q, MOTION_HZ)
        self.csv = write(work / f'{self.name}_500.csv', self, self.q, self.current)
        torque = self.current * ampere[:, None]
        of = {'currents': (self.q, self.current), 'torques': (self.q, torque), 'smoothed': (q, torque)}
        self.for_aurt = {how: write(work / f'{self.name}_{how}.csv', self, *both, AURT_ALSO)
                         for how, both in of.items()}
        self.motion = q, differences(q, FIRST, 1), differences(q, SECOND, 2)
        self.torque = low_passed(torque, TORQUE_HZ)
        usable = np.zeros(n, bool)
        margin = round(MARGIN_S * RATE)
        usable[margin:n - margin] = True
        kept = np.zeros(n, bool)
        kept[::EVERY] = True
        guard = round(GUARD_S * RATE)
        self.rows = [np.flatnonzero(eroded(np.abs(v) > STANDSTILL, guard) & usable & kept)
                     for v in self.motion[1]]

    def rms(self, torque):
        """Of what is left of the low-passed torque, per joint; `torque` is low-passed here."""
        left = self.torque - low_passed(torque, TORQUE_HZ)
        return np.array([np.sqrt(np.mean(left[j, rows] ** 2)) for j, rows in enumerate(self.rows)])


def recording(arm, name):
    for path in (arm['data'] / name, arm['data'] / f'{name}.csv.gz'):
        if path.exists():
            return path
    sys.exit(f'{arm["data"] / name}: no such recording')


# Fields that aurt's reader insists on; it uses none of them.
AURT_ALSO = ['target_q', 'target_qd', 'target_qdd', 'target_current', 'target_moment']


def write(path, run, q, current, also=()):
    """RTDE names, separated by blanks; `also` are zeros."""
    names = ['actual_q', 'actual_qd', 'actual_current', *also]
    heads = ['timestamp', *(f'{s}_{j}' for s in names for j in range(JOINTS))]
    rest = np.zeros((len(also) * JOINTS, len(run.t)))
    table = np.vstack([run.t, q, run.qd_recorded, current, rest]).T
    np.savetxt(path, table, fmt='%.9g', header=' '.join(heads), comments='')
    return path


FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])


def differences(x, stencil, order):
    """Central, of eighth order; the ends, which the margin leaves out, copy their neighbours."""
    inner = signal.correlate(x, stencil[None], 'valid') * RATE ** order
    return np.pad(inner, ((0, 0), (4, 4)), 'edge')


# --- rigid body ---------------------------------------------------------------------------------------

class Arm:
    """Joints, and per link mass, first moments and inertia about the joint's origin, from a URDF."""

    def __init__(self, path):
        root = ET.parse(path).getroot()
        links = {x.get('name'): x for x in root.findall('link')}
        joints = [j for j in root.findall('joint') if j.get('type') in ('revolute', 'continuous')]
        self.offsets, self.turns, self.parameters = [], [], []
        for joint in joints[:JOINTS]:
            assert numbers(joint.find('axis').get('xyz')) == [0, 0, 1], 'axes are z'
            origin = joint.find('origin')
            self.offsets.append(np.array(numbers(origin.get('xyz'))))
            self.turns.append(Rotation.from_euler('xyz', numbers(origin.get('rpy'))).as_matrix())
            inertial = links[joint.find('child').get('link')].find('inertial')
            m = float(inertial.find('mass').get('value'))
            place = inertial.find('origin')
            c = np.array(numbers(place.get('xyz')))
            axes = Rotation.from_euler('xyz', numbers(place.get('rpy', '0 0 0'))).as_matrix()
            i = {k: float(v) for k, v in inertial.find('inertia').attrib.items()}
            about = np.array([[i['ixx'], i['ixy'], i['ixz']], [i['ixy'], i['iyy'], i['iyz']],
                              [i['ixz'], i['iyz'], i['izz']]])
            about = axes @ about @ axes.T
            assert possible(m, about), f'{path}: impossible link'
            whole = about + m * (c @ c * np.eye(3) - np.outer(c, c))
            self.parameters += [m, *(m * c), whole[0, 0], whole[0, 1], whole[0, 2], whole[1, 1],
                                whole[1, 2], whole[2, 2]]
        self.parameters = np.array(self.parameters)

    def regressor(self, q, qd, qdd, up=(0, 0, GRAVITY)):
        """Torque of every joint (first axis) per unit of every parameter (last) at every sample."""
        joints, n = q.shape
        z = np.array([0., 0., 1.])
        w, dw, a = np.zeros((n, 3)), np.zeros((n, 3)), np.tile(np.array(up, float), (n, 1))
        y = np.zeros((joints, n, 10 * joints))
        frames = []
        for i in range(joints):
            p = self.offsets[i]
            c, s, o = np.cos(q[i]), np.sin(q[i]), np.zeros(n)
            spin = np.stack([c, -s, o, s, c, o, o, o, o + 1], 1).reshape(n, 3, 3)
            r = self.turns[i] @ spin  # of this frame in the one before
            frames.append((r, p))
            a = a + np.cross(dw, p) + np.cross(w, np.cross(w, p))
            back = lambda v: np.einsum('nji,nj->ni', r, v)
            w, dw, a = back(w), back(dw), back(a)
            dw = dw + np.cross(w, qd[i][:, None] * z) + qdd[i][:, None] * z
            w = w + qd[i][:, None] * z
            sw, sdw, sa = skew(w), skew(dw), skew(a)
            force, moment = np.zeros((n, 3, 10)), np.zeros((n, 3, 10))
            force[:, :, 0] = a
            force[:, :, 1:4] = sdw + sw @ sw
            moment[:, :, 1:4] = -sa
            moment[:, :, 4:] = of_inertia(dw) + sw @ of_inertia(w)
            own = slice(10 * i, 10 * i + 10)
            for j in range(i, -1, -1):
                y[j, :, own] = moment[:, 2]
                r, p = frames[j]
                force, moment = r @ force, r @ moment
                moment = moment + skew(p[None]) @ force
        return y


def possible(m, about):
    d = np.linalg.eigvalsh(about)
    return m > 0 and d[0] > 0 and d[0] + d[1] >= d[2] * (1 - 1e-9)


def numbers(text):
    return [float(x) for x in text.split()]


def skew(v):
    o = np.zeros(len(v))
    return np.stack([o, -v[:, 2], v[:, 1], v[:, 2], o, -v[:, 0], -v[:, 1], v[:, 0], o],
                    1).reshape(-1, 3, 3)


def of_inertia(w):
    """L(w) with I w = L(w) (Ixx Ixy Ixz Iyy Iyz Izz)."""
    x, y, z, o = w[:, 0], w[:, 1], w[:, 2], np.zeros(len(w))
    return np.stack([x, y, z, o, o, o, o, x, o, y, z, o, o, o, x, o, y, z], 1).reshape(-1, 3, 6)


def terms(run, names, j, load):
    """Columns of a joint's own terms, not low-passed. Linear but for `load`, the rigid torque."""
    _, qd, qdd = run.motion
    v, sign = qd[j], np.sign(qd[j])
    of = {'dry': sign, 'viscous': v, 'rotor': qdd[j], 'offset': np.ones_like(v),
          'quadratic': v * np.abs(v), 'cubic': v ** 3, 'load': sign * np.abs(load)}
    return np.stack([of[name] for name in names])


def at_nominal(table, fit, others, names):
    """The nominal links; every joint's own terms fitted to the rest, dissipative ones not negative."""
    loads = {run: run.regressor @ table.parameters for run in (fit, *others)}
    values = []
    for j in range(JOINTS):
        rows = fit.rows[j]
        columns = low_passed(terms(fit, names, j, loads[fit][j]), TORQUE_HZ)[:, rows]
        rest = fit.torque[j, rows] - low_passed(loads[fit][j], TORQUE_HZ)[rows]
        values.append(np.linalg.lstsq(columns.T, rest, rcond=None)[0])
    return {run: run.rms(np.stack([load[j] + values[j] @ terms(run, names, j, load[j])
                                   for j in range(JOINTS)])) for run, load in loads.items()}


def least_squares(table, fit, others, names, weighted):
    """All base parameters and the joints' own terms at once, without asking for possible links.

    The shortest solution of the standard parameters: that of the base parameters, whichever they are.
    `weighted`: again and again with each joint's rows in units of what is left of them. The load of
    load-dependent friction is the nominal table's."""
    def columns(run, j):
        load = run.regressor[j] @ table.parameters
        own = np.zeros((JOINTS * len(names), run.q.shape[1]))
        own[j * len(names):(j + 1) * len(names)] = terms(run, names, j, load)
        return np.vstack([run.regressor[j].T, own])

    blocks = [low_passed(columns(fit, j), TORQUE_HZ)[:, fit.rows[j]].T for j in range(JOINTS)]
    asked = [fit.torque[j, fit.rows[j]] for j in range(JOINTS)]
    weights, before = np.ones(JOINTS), np.inf
    for _ in range(50 if weighted else 1):
        x = np.vstack([w * b for w, b in zip(weights, blocks)])
        y = np.concatenate([w * b for w, b in zip(weights, asked)])
        norms = np.linalg.norm(x, axis=0)
        scale = np.where(norms > 1e-9 * norms.max(), norms, np.inf)  # the rest is round-off
        values, _, rank, _ = np.linalg.lstsq(x / scale, y, rcond=1e-9)
        values = values / scale
        left = np.array([np.sqrt(np.mean((b @ values - a) ** 2)) for b, a in zip(blocks, asked)])
        if np.abs(left / before - 1).max() < 1e-6:
            break
        weights, before = 1 / left, left
    result = {run: run.rms(np.stack([values @ columns(run, j) for j in range(JOINTS)]))
              for run in (fit, *others)}
    return result, rank - JOINTS * len(names)


# --- armtwin ------------------------------------------------------------------------------------------

def call(command, **more):
    start = time.perf_counter()
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True, **more)
    if done.returncode:
        sys.exit(f'{" ".join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-4000:]}')
    return time.perf_counter() - start


def armtwin(program, key, level, fit, others, work):
    """Its own figures, and the same from its URDF and twin, computed here."""
    asked = LEVELS[level][1]
    out, urdf, twin = (work / f'{key}_{level}.{ext}' for ext in ('json', 'urdf', 'toml'))
    own = {}
    for run in others:
        call([program, 'identify', fit.csv, '--check', run.csv, '--twin', ROOT / f'scenarios/twins/{key}.toml',
              '--method', 'nlse', '--with', asked, '--save-urdf', urdf, '--save-twin', twin, '--json', out])
        found = json.loads(out.read_text())
        for one, row in zip((fit, run), found['inertia']['torque']):
            own[one] = {name: np.array(row[f'{name}_nm']) for name in ('given', 'least_squares', 'links')}
    arm, saved = Arm(urdf), tomllib.loads(twin.read_text())
    values, rotor = saved['twin']['values'], saved['drive']['rotor_inertia']
    of = {'coulomb': 'dry', 'viscous': 'viscous', 'load_friction': 'load', 'current_offset': 'offset',
          'viscous_quadratic': 'quadratic', 'viscous_cubic': 'cubic'}
    again = {}
    for run in (fit, *others):
        torque = run.regressor @ arm.parameters
        for j in range(JOINTS):
            load = torque[j].copy()
            torque[j] += rotor[j] * terms(run, ['rotor'], j, load)[0]
            for name, by_joint in values.items():
                torque[j] += by_joint[j] * terms(run, [of[name]], j, load)[0]
        again[run] = run.rms(torque)
    return own, again, found


def armtwin_recorded(program, key, arm, fit, check, work):
    """armtwin's figures of the recordings as they are, group 2."""
    columns = ['--columns', ROOT / 'scenarios/columns' / arm['columns']] if arm['columns'] else []
    out = work / 'recorded.json'
    call([program, 'identify', fit.path, '--check', check.path, *columns, '--twin',
          ROOT / f'scenarios/twins/{key}.toml', '--method', 'nlse', '--with', LEVELS['full'][1], '--json', out])
    rows = json.loads(out.read_text())['inertia']['torque']
    return [(run, np.array(row['links_nm'])) for run, row in zip((fit, check), rows)]


def armtwin_seconds(program, key, arm, fit):
    """Processor seconds from starting the program to its end, on the recording as it is; best of five."""
    columns = ['--columns', ROOT / 'scenarios/columns' / arm['columns']] if arm['columns'] else []
    twin = ROOT / f'scenarios/twins/{key}.toml'
    command = [program, 'identify', fit.path, *columns, '--twin', twin, '--method', 'nlse', '--with',
               LEVELS['full'][1]]
    best = np.inf
    for _ in range(5):
        before = os.times()
        call(command, env={**os.environ, 'RAYON_NUM_THREADS': '1'})
        after = os.times()
        best = min(best, after.children_user + after.children_system
                   - before.children_user - before.children_system)
    return best


# --- aurt ---------------------------------------------------------------------------------------------

class Aurt:
    """aurt's command line compiles the rigid body, its classes calibrate. Two things are not its own in
    any case: the CSV is read at once instead of number by number, and predictions are not downsampled.
    Where compiling takes longer than `limit_s`, its symbolic regressor gives way to `Entries`."""

    def __init__(self, key, arm, keep, limit_s):
        self.arm, self.dir = arm, keep / f'aurt_{key}'
        self.dir.mkdir(parents=True, exist_ok=True)
        dh = '\n'.join(f'{d},{a},{alpha}' for d, a, alpha in zip(arm['d'], arm['a'], ALPHA))
        (self.dir / 'dh.csv').write_text(f'd,a,alpha\n{dh}\n')
        # All these arms have zeros and angles in the same places, so the symbols are the same: where one
        # took too long, the next is not tried.
        own, too_long = self.dir / 'compile.json', keep / 'too_long.json'
        if not (own.exists() or too_long.exists()):
            done = self.compile(limit_s)
            (own if done['finished'] else too_long).write_text(json.dumps(done))
        self.compiled = json.loads((own if own.exists() else too_long).read_text())
        self.seconds = {}

    def compile(self, limit_s):
        """Wall and processor seconds, and whether it came to an end."""
        before, start = os.times(), time.perf_counter()
        command = [Path(sys.executable).with_name('aurt'), 'compile-rbd', '--mdh', 'dh.csv',
                   '--out', 'rbd.pickle', '--cache', 'cache']
        child = subprocess.Popen(command, cwd=self.dir, start_new_session=True)
        try:
            finished = child.wait(limit_s) == 0
        except subprocess.TimeoutExpired:
            finished = False
            os.killpg(child.pid, signals.SIGTERM)
            child.wait()
        after = os.times()
        processor = after.children_user + after.children_system - before.children_user - before.children_system
        return {'finished': finished, 'wall_s': time.perf_counter() - start, 'processor_s': processor}

    def rigid_body(self, log, cache):
        if self.compiled['finished']:
            with open(self.dir / 'rbd.pickle', 'rb') as file:
                return pickle.load(file)
        return by_entries(log, self.dir / 'dh.csv', cache)

    def predictions(self, friction, how, fit, others):
        """What it is fed as currents, at 500 Hz. A cache of its own for each friction: 0.0.4 does not tell them
        apart in its cache."""
        import aurt.robot_calibration as rc
        import aurt.robot_data as rd
        from aurt.caching import PersistentPickleCache
        from aurt.robot_dynamics import RobotDynamics
        load, powers = FRICTIONS[friction]
        plain, here, say = rd.RobotData._load_raw_csv_data, os.getcwd(), logging.getLogger('aurt')
        say.setLevel(logging.ERROR)
        tag = f'cache_{load}_{"".join(map(str, powers))}'
        shutil.rmtree(self.dir / tag, ignore_errors=True)
        (self.dir / tag).mkdir()
        os.chdir(self.dir)
        try:
            cache = PersistentPickleCache(tag)
            start = time.process_time()
            dynamics = RobotDynamics(self.rigid_body(say, cache), say, cache,
                                     viscous_friction_powers=powers, friction_torque_model=load)
            compiled = time.process_time()
            rd.RobotData._load_raw_csv_data = at_once
            path = lambda run: str(run.for_aurt[how])
            calibration = rc.RobotCalibration(say, dynamics, path(fit), np.array([0, 0, -GRAVITY]))
            calibration.calibrate()
            self.seconds[friction] = compiled - start, time.process_time() - compiled
            found = {}
            for run in (fit, *others):
                data = rd.RobotData(say, path(run), delimiter=' ', interpolate_missing_samples=True)
                # RobotCalibration.predict without its downsampling.
                states = calibration._trajectory_filtering_and_central_difference(
                    np.array([data.data[f'actual_q_{j}'] for j in range(1, JOINTS + 1)]),
                    data.dt_nominal, calibration.f_dyn)
                stacked = np.empty((3 * JOINTS, states[0].shape[1]))
                for k in range(3):
                    stacked[k::3] = states[k]
                current = [calibration._parallel_filter(dynamics.observation_matrix_joint(j, stacked),
                                                        data.dt_nominal, calibration.f_dyn)
                           @ calibration.parameters for j in range(JOINTS)]
                found[run] = np.pad(np.array(current), ((0, 0), (1, 1)), 'edge')
        finally:
            os.chdir(here)
            rd.RobotData._load_raw_csv_data = plain
        return found, sum(dynamics.number_of_parameters())

    def reading_seconds(self, run):
        """Processor seconds of its own reader, on one recording."""
        from aurt.robot_data import RobotData
        start = time.process_time()
        RobotData(logging.getLogger('aurt'), str(run.for_aurt['torques']), delimiter=' ',
                  interpolate_missing_samples=True)
        return time.process_time() - start


# Order of a link's parameters in aurt, as places in `Arm`'s.
AS_AURT = [4, 5, 6, 7, 8, 9, 1, 2, 3, 0]


class Entries:
    """A regressor as numbers, in place of a symbolic one: what aurt asks of it and no more."""

    def __init__(self, columns, arguments, evaluate):
        self.shape, self.evaluate = (JOINTS, columns), evaluate
        names = [inspect.Parameter(f'x{i}', inspect.Parameter.POSITIONAL_ONLY) for i in range(arguments)]
        self.__signature__ = inspect.Signature(names)

    def __call__(self, *states):
        return self.evaluate(np.array(states))


def by_entries(log, dh, cache):
    """aurt's RigidBodyDynamics without its symbolic regressor. Which parameters are base parameters is
    found by aurt's code, with random states, from the same entries (`same_entries`)."""
    import aurt.linear_system
    import aurt.robot_dynamics
    import sympy
    from aurt.data_processing import convert_file_to_mdh
    from aurt.rigid_body_dynamics import RigidBodyDynamics

    class Sympy:
        def __getattr__(self, name):
            return getattr(sympy, name)

        @staticmethod
        def lambdify(states, what, *more):
            return what if isinstance(what, Entries) else sympy.lambdify(states, what, *more)

    class Quick(RigidBodyDynamics):
        def _all(self, states, gravity):
            q, qd, qdd = states[0::3], states[1::3], states[2::3]
            y = mdh_arm(self.mdh).regressor(q, qd, qdd, -np.asarray(gravity, float))
            return y.reshape(*y.shape[:2], self.n_joints, 10)[..., AS_AURT]

        def _regressor(self):
            count = sum(map(len, self.states()))

            def at(x):
                gravity = x[18:] if self._g_num is None else self._g_num
                return self._all(x[:18, None], gravity)[:, 0].reshape(JOINTS, -1)
            return Entries(10 * JOINTS, count, at)

        def observation_matrix_joint_parameters_for_joint(self, j, par_j, states_num):
            kept = getattr(self, '_kept', None)
            if kept is None or kept[0] is not states_num:
                self._kept = kept = states_num, self._all(states_num, self._g_num)
            return kept[1][j, :, par_j][:, self.is_base_parameter[par_j]]

    def whole(self):
        own = self.joint_dynamics
        count = [len(p) for p in own._parameters_full()]
        friction = sympy.lambdify([x for pair in own.states() for x in pair], own._regressor(), 'numpy')
        body = self.rigid_body_dynamics._regressor()

        def at(x):
            states, gravity = x[:4 * JOINTS].reshape(JOINTS, 4), x[4 * JOINTS:]
            rigid = body.evaluate(np.concatenate([states[:, :3].ravel(), gravity]))
            of_joints = np.asarray(friction(*states[:, [1, 3]].ravel()), float)
            parts = [np.hstack([rigid[:, 10 * j:10 * j + 10],
                                of_joints[:, sum(count[:j]):sum(count[:j + 1])]]) for j in range(JOINTS)]
            return np.hstack(parts)
        return Entries(10 * JOINTS + sum(count), sum(map(len, self.states())), at)

    aurt.linear_system.sp = Sympy()
    aurt.robot_dynamics.RobotDynamics._regressor = whole
    return Quick(log, convert_file_to_mdh(str(dh)), cache, multi_processing=False)


def mdh_arm(mdh):
    """Frames as in aurt: Craig's, with the DH rows shifted by one joint."""
    arm = Arm.__new__(Arm)
    arm.offsets, arm.turns = [], []
    for i in range(mdh.n_joints):
        alpha, d = mdh.alpha[i], mdh.d[i + 1]
        arm.offsets.append(np.array([mdh.a[i], -np.sin(alpha) * d, np.cos(alpha) * d]))
        arm.turns.append(Rotation.from_euler('x', alpha).as_matrix())
    return arm


def same_entries(arm, work, joints=3):
    """Largest difference between aurt's own regressor of the arm's first joints, as its code derives it,
    and the numbers used in its place; relative to the largest entry."""
    from aurt.caching import PersistentPickleCache
    from aurt.data_processing import convert_file_to_mdh
    from aurt.rigid_body_dynamics import RigidBodyDynamics
    import sympy
    rows = list(zip(arm['d'], arm['a'], ALPHA))[:joints]
    (work / 'first.csv').write_text('d,a,alpha\n' + '\n'.join(f'{d},{a},{x}' for d, a, x in rows) + '\n')
    shutil.rmtree(work / 'cache_first', ignore_errors=True)
    (work / 'cache_first').mkdir()
    mdh = convert_file_to_mdh(str(work / 'first.csv'))
    log = logging.getLogger('aurt')
    log.setLevel(logging.ERROR)
    own = RigidBodyDynamics(log, mdh, PersistentPickleCache(str(work / 'cache_first')),
                            multi_processing=False)
    evaluate = sympy.lambdify([x for s in own.states() for x in s], own._regressor(), 'numpy')
    random, worst = np.random.default_rng(1), 0
    for _ in range(20):
        states = random.uniform(-3, 3, 3 * joints)
        theirs = np.array(evaluate(*states, 0, 0, -GRAVITY), float)
        q, qd, qdd = (states[k::3, None] for k in range(3))
        ours = mdh_arm(mdh).regressor(q, qd, qdd)[:, 0].reshape(joints, joints, 10)[..., AS_AURT]
        worst = max(worst, np.abs(ours.reshape(joints, -1) - theirs).max() / np.abs(theirs).max())
    return worst


def at_once(self, file_path, delimiter):
    import pandas
    table = pandas.read_csv(file_path, sep=delimiter)
    self.n_joints = len([c for c in table.columns if 'actual_q_' in c])
    self.time = table['timestamp'].to_numpy(copy=True)
    self.data = {}
    for field in self.fields:
        if '#' not in field:
            self.data[field] = table[field].to_numpy(copy=True)
        else:
            for j in range(1, self.n_joints + 1):
                name = field.replace('#', str(j - 1))
                self.data[field.replace('#', str(j))] = table[name].to_numpy(copy=True)


# --- the page -----------------------------------------------------------------------------------------

def study(program, key, arm, work, keep, limit_s):
    twin = tomllib.loads((ROOT / f'scenarios/twins/{key}.toml').read_text())
    ampere = np.array(twin['drive']['torque_constant']) * twin['drive']['gear_ratio']
    fit, *others = (Run(program, arm, name, work, ampere) for name in (arm['fit'], *arm['checks']))
    nominal = work / f'{key}_nominal.urdf'
    call([program, 'urdf', '--robot', key, '-o', nominal])
    table = Arm(nominal)
    runs = (fit, *others)
    for run in runs:
        run.regressor = table.regressor(*run.motion)
    result = {'arm': arm, 'fit': fit, 'others': others, 'ampere': ampere, 'levels': {}, 'aurt': {}}
    for level, (_, _, names) in LEVELS.items():
        own, again, found = armtwin(program, key, level, fit, others, work)
        free, rank = least_squares(table, fit, others, names, False)
        weighted, _ = least_squares(table, fit, others, names, True)
        result['levels'][level] = {
            'nominal': at_nominal(table, fit, others, names), 'ols': free, 'wls': weighted, 'rank': rank,
            'own': own, 'links': again, 'spread': found['inertia']['spread'],
            'condition': found['inertia']['condition']}
        say(f'{key} {level}: done')
    result['seconds'] = armtwin_seconds(program, key, arm, fit)
    result['recorded'] = np.concatenate(
        [np.abs(rms / result['levels']['full']['links'][run] - 1)
         for other in others for run, rms in armtwin_recorded(program, key, arm, fit, other, work)])
    result['entries'] = same_entries(arm, work)
    peer = Aurt(key, arm, keep, limit_s)
    result['counts'] = {}
    for friction in FRICTIONS:
        for how in FED:
            found, result['counts'][friction] = peer.predictions(friction, how, fit, others)
            unit = ampere[:, None] if how == 'currents' else 1
            result['aurt'][friction, how] = {run: run.rms(x * unit) for run, x in found.items()}
            say(f'{key} aurt {friction}, {how}: done')
    result['read'] = peer.reading_seconds(fit)
    result['compiled'], result['aurt_seconds'] = peer.compiled, peer.seconds
    return result


def say(text):
    print(text, file=sys.stderr, flush=True)


HEAD = ('| method | ' + ' | '.join(f'joint {j + 1}' for j in range(JOINTS)) + ' |\n|---|' + '---:|' * JOINTS)


def line(name, values, bold=None):
    cells = [f'{v:.3f}' if v < 100 else f'{v:.0f}' for v in values]
    if bold is not None:
        cells = [f'**{c}**' if b else c for c, b in zip(cells, bold)]
    return f'| {name} | ' + ' | '.join(cells) + ' |'


BEST = 'aurt, best of 12 settings on each joint'


def methods(result, level, run):
    """Names and figures of one level, in the page's order, and armtwin's."""
    of = result['levels'][level]
    rows = {'nominal table': of['nominal'][run], 'ordinary least squares': of['ols'][run],
            'weighted least squares': of['wls'][run],
            f'aurt, {BESIDE[level]}': result['aurt'][BESIDE[level], 'torques'][run],
            BEST: np.min([each[run] for each in result['aurt'].values()], axis=0)}
    return rows, of['links'][run]


def verdict(results, level):
    """Where another method leaves less on a check recording, or the same: rows of arm, recording, method,
    joint, share that armtwin leaves more."""
    missed = []
    for result in results:
        for run in result['others']:
            rows, ours = methods(result, level, run)
            for name, theirs in rows.items():
                name = 'aurt, same group' if name.startswith('aurt') and name != BEST else name
                missed += [(result['arm']['title'], run.name, name, j, ours[j] / theirs[j] - 1)
                           for j in np.flatnonzero(ours >= theirs)]
    return missed


def page(results, program):
    out = ['# A rigid body fitted to real recordings, beside other methods', '']
    missed = {level: verdict(results, level) for level in LEVELS}
    total = sum(len(result['others']) * JOINTS for result in results)
    everywhere = [GROUPS[level] for level in LEVELS if not missed[level]]
    state = (f'met with the terms of group {" and ".join(map(str, everywhere))}' if everywhere
             else 'not met on every joint, with none of the groups of terms')
    names = ['nominal table', 'ordinary least squares', 'weighted least squares', 'aurt, same group', BEST]
    out += ['Goal: on every joint of the check recordings less torque left than each other method, and '
            f'possible links. All links are possible. For torque the goal is **{state}**. Joints of check '
            f'recordings, of {total}, where armtwin leaves less:', '',
            '| than | group 1 | group 2 | group 3 |', '|---|---:|---:|---:|']
    for name in names:
        cells = [str(total - sum(m[2] == name for m in missed[level])) for level in LEVELS]
        out.append(f'| {name} | ' + ' | '.join(cells) + ' |')
    out += ['', '"Where it is not met" lists the others.']
    recorded = np.concatenate([r['recorded'] for r in results])
    how = HOW.format(version=subprocess.run([program, '--version'], capture_output=True,
                                             text=True).stdout.strip(),
                      aurt=version('aurt'), numpy=np.__version__, scipy=version('scipy'),
                      sympy=version('sympy'), sklearn=version('scikit-learn'),
                      python=platform.python_version(), aurt_compile=stand_in(results),
                      differ=differ(results), best=BEST,
                      median=100 * np.median(recorded), most=100 * np.max(recorded))
    out += wrapped(how)
    for result in results:
        fit = result['fit']
        out += ['', f'## {result["arm"]["title"]}', '',
                f'Fit: `{fit.name}` ({fit.t[-1]:.0f} s, {fit.recorded_hz:.0f} Hz as recorded; joints move in '
                f'{" ".join(f"{100 * len(r) * EVERY / len(fit.t):.0f}" for r in fit.rows)} % of its rows). '
                f'{result["arm"]["remark"]}'
                f'N.m per A: {" ".join(f"{a:.2f}" for a in result["ampere"])}. '
                f'{result["levels"]["full"]["rank"]} base parameters beside the rotors; aurt fits '
                f'{result["counts"][BESIDE["plain"]]} values in group 1, '
                f'{result["counts"][README]} in group 3. Condition number of the base '
                f'parameters\' columns: {result["levels"]["full"]["condition"]:.2g}. '
                f'Spread of the links about the table that the fit calls for: '
                + ', '.join(f'{100 * of["spread"]:.0f} % (group {GROUPS[level]})'
                            for level, of in result['levels'].items()) + '.']
        for run in (fit, *result['others']):
            kind = 'fit' if run is fit else 'check'
            out += ['', f'### {run.name} ({kind})', '', HEAD]
            for level in LEVELS:
                rows, ours = methods(result, level, run)
                for name, theirs in rows.items():
                    if name != BEST:
                        out.append(line(f'{GROUPS[level]} {name}', theirs))
                out.append(line(f'{GROUPS[level]} armtwin, possible links', ours,
                                ours < np.min([v for k, v in rows.items() if k != BEST], axis=0)))
            out.append(line(BEST, rows[BEST]))
    out += ['', '## Where it is not met', '',
            'Joints of check recordings where armtwin leaves as much as another method or more, and by how '
            'much more.', '', '| group | arm | check | method | joints |', '|---:|---|---|---|---|']
    for level, rows in missed.items():
        for place in dict.fromkeys(row[:3] for row in rows):
            joints = ', '.join(f'{j + 1} ({100 * more:.1f} %)' for *where, j, more in rows
                               if tuple(where) == place)
            out.append(f'| {GROUPS[level]} | {" | ".join(place)} | {joints} |')
    out += ['', '## All settings of aurt', '',
            'Load model and powers of the viscous friction, and what aurt reads as currents.', '',
            HEAD.replace('| method |', '| recording | friction | read |').replace('|---|', '|---|---|---|', 1)]
    for result in results:
        for run in (result['fit'], *result['others']):
            for (friction, how), rms in result['aurt'].items():
                out.append(line(f'{run.name} | {friction} | {FED[how]}', rms[run]))
    out += ['', '## Time', '',
            'Seconds of one processor core, of the fit recording.', '',
            '| arm | armtwin: whole program, from the file as recorded | aurt: reading the CSV at 500 Hz | '
            'aurt: calibrate, group 1 | aurt: calibrate, group 3 |', '|---|---:|---:|---:|---:|']
    for result in results:
        seconds = result['aurt_seconds']
        out.append(f'| {result["arm"]["title"]} | {result["seconds"]:.2f} | {result["read"]:.1f} | '
                   f'{seconds[BESIDE["plain"]][1]:.1f} | {seconds[README][1]:.1f} |')
    out += ['', compile_text(results)]
    return '\n'.join(out) + '\n'


GROUPS = {'plain': 1, 'full': 2, 'curved': 3}


def wrapped(text):
    """Paragraphs and list items filled to the width of a page."""
    for item in text.strip().replace('\n- ', '\n\n- ').split('\n\n'):
        item = item.strip()
        if not item.startswith('- '):
            yield ''
        yield textwrap.fill(' '.join(item.split()), 110, break_long_words=False, break_on_hyphens=False,
                            subsequent_indent='  ' if item.startswith('- ') else '')
        if item.endswith(':'):
            yield ''


def compile_text(results):
    done = [r['compiled'] for r in results]
    if all(d['finished'] for d in done):
        return ('aurt compiles the rigid body once per arm: '
                + ', '.join(f'{d["processor_s"]:.0f} s ({r["arm"]["title"]})' for d, r in zip(done, results))
                + '.')
    d = next(d for d in done if not d['finished'])
    return (f'`aurt compile-rbd` (once per arm, before any data) was stopped after {d["wall_s"] / 60:.0f} '
            f'minutes on one core shared with other work '
            'without having finished.')


def stand_in(results):
    text = compile_text(results)
    if all(r['compiled']['finished'] for r in results):
        return text
    return (f'{text} In its place the entries of its regressor are computed as numbers (on the first three '
            f'joints they agree with aurt\'s own symbols to {max(r["entries"] for r in results):.0e} of the '
            'largest); choice of base parameters, friction, calibration and prediction are aurt\'s code.')


def differ(results):
    """Largest relative difference between armtwin's own figures and the ones computed here."""
    worst = {'links': 0, 'given': 0}
    for result in results:
        of = result['levels']['plain']
        for run, own in of['own'].items():
            worst['given'] = max(worst['given'], np.abs(own['given'] / of['nominal'][run] - 1).max())
        for of in result['levels'].values():
            for run, own in of['own'].items():
                worst['links'] = max(worst['links'], np.abs(own['links'] / of['links'][run] - 1).max())
    return (f'{100 * worst["links"]:.2g} % for its links and {100 * worst["given"]:.2g} % for the nominal table '
            'with the terms of group 1')


HOW = """
Made by `python benches/peers/rigid_body.py RECORDINGS -o docs/rigid_body.md` with {version}, aurt {aurt},
numpy {numpy}, scipy {scipy}, sympy {sympy}, scikit-learn {sklearn}, Python {python}; one core.

How it is compared:

- All figures are root mean squares in N.m of measured torque (motor current times the twin's N.m per A)
  less predicted torque, both through the same zero-phase low-pass (8 Hz, order 4), at 20 Hz, over the rows
  where the joint moves faster than 0.02 rad/s, 0.1 s away from standstill and 0.5 s away from the ends:
  the rows that `armtwin identify` keeps.
- Every method reads the same samples: the recordings resampled to 500 Hz by cubic splines. aurt needs
  that: it low-passes positions at 50 Hz, which 94 Hz do not allow, and at 125 Hz, by its code, the arrays in
  its `predict` differ in length.
- nominal table: the manufacturer's masses; the other terms fitted joint by joint.
- ordinary least squares: all base parameters and terms at once, every row in N.m, no limits.
- weighted least squares: the same, each joint's rows in units of what is left of them, repeated until it
  stays; no limits.
- aurt: its own base parameters, filters (50 and 20 Hz), rows and weighted least squares; gravity 0 0 -9.81.
  It fits all rows from the first motion to the last, standstill of single joints or of the arm between them
  included; that costs it torque on the moving rows judged here, most on the UR5, which often stands. It has neither rotor inertia nor offset. It fits one set of links to the
  currents of all joints as if all had the same N.m per A; the twins here say otherwise, so the tables have it
  read torques (current times N.m per A) as currents, which serves it better in most cases; both are under
  "All settings of aurt". Its load model `absolute` is refused by its own assertion, so `none` and `square`
  are used; `square` with powers 2 1 4, here in group 3, is what its README and tests use. Predictions are
  taken at every sample instead of every tenth.
- {aurt_compile}
- armtwin, possible links: torque of the URDF and twin that `armtwin identify --with inertia,... --save-urdf
  --save-twin` writes, computed by this script. Every link's mass is positive and its inertia is positive
  definite and fulfils the triangle inequality (checked). armtwin's own figures differ by at most
  {differ}. On the recordings as they are, not resampled, where other rows are kept, armtwin's own figures of
  group 2 differ from those here by {median:.1f} % in the median and {most:.0f} % at most.
- Groups of terms beside the rigid body: 1 dry and viscous friction, and rotor inertia; 2 also an offset
  and friction in proportion to the load; 3 as 2, with quadratic and cubic viscous friction. In aurt's rows
  what it has for that. Bold: less than every other row of its group.
- {best}: for each joint of each recording the lowest of all its settings, chosen on that recording itself.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument('recordings', type=Path)
    parser.add_argument('-o', '--out', type=Path, required=True)
    parser.add_argument('--keep', type=Path, default=ROOT / 'target/peers',
                        help='folder for intermediate files and what aurt compiled [target/peers]')
    parser.add_argument('--limit', type=float, default=20, metavar='MIN',
                        help='minutes that aurt may compile [20]')
    given = parser.parse_args()
    if hasattr(os, 'sched_setaffinity'):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    program = os.environ.get('ARMTWIN', ROOT / 'target/release/armtwin')
    keep = given.keep.resolve()
    (keep / 'runs').mkdir(parents=True, exist_ok=True)
    results = []
    for key, arm in ARMS.items():
        arm['data'] = given.recordings / arm['folder']
        results.append(study(program, key, arm, keep / 'runs', keep, 60 * given.limit))
    given.out.write_text(page(results, program))


if __name__ == '__main__':
    main()
