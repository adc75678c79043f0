"""A real KUKA KR300, of which the twin knows neither the load nor the gas cylinder that carries the arm: what diagnose says.

    git clone https://github.com/JonasWeigand/Robot_Identification
    python3 benches/kr300.py Robot_Identification --work WORK -o docs/kr300.md

Links, the cylinder and three recordings of 10 s are theirs; numpy and scipy read them. ARMTWIN is the program
(target/release/armtwin).
"""
import argparse
import ast
import itertools
import json
import math
import operator
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import scipy.io

ROOT = Path(__file__).resolve().parents[1]
ARMTWIN = os.environ.get('ARMTWIN', str(ROOT / 'target/release/armtwin'))
SOURCE = 'https://github.com/JonasWeigand/Robot_Identification'
# Their angles are those of the drives: the second joint stands upright at zero, the third is bent by a right angle.
ZERO = np.array([0.0, -math.pi / 2, math.pi / 2, 0.0, 0.0, 0.0])
# N.m at the joints, about: peak torque of the motors times the gears.
EFFORT = [20000, 20000, 20000, 6000, 6000, 6000]
GRAVITY = 9.81
PAUSE_S = 5.0
MOTIONS = 'ABC'
COLUMNS = """time = 1
[channels]
actual_q = { first = 2, count = 6 }
actual_qd = { first = 8, count = 6 }
joint_torque = { first = 14, count = 6 }
"""


OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}


def arithmetic(text, names):
    """The value of a formula of theirs: a file from elsewhere is read, never run."""
    def value(node):
        match node:
            case ast.Constant(value=number) if isinstance(number, (int, float)):
                return number
            case ast.Name(id=name):
                return names[name]
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return -value(inner)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                return OPERATORS[type(op)](value(left), value(right))
        raise KeyError(text)
    return float(value(ast.parse(text.strip().replace('^', '**'), mode='eval').body))


def numbers(text):
    return [float(x) for x in re.findall(r'-?\d+\.?\d*(?:e-?\d+)?', text)]


def links(text):
    """DH values, mass, centre, inertia, rotor and gear of each link of their model."""
    text = re.sub(r'%.*', '', text)
    names = dict(re.findall(r'(\w+) = (-?[\d.]+);', text))
    found = []
    for block in re.findall(r'L\(\d\) = Link\((.*?)\);', text, re.S):
        def value(key):
            raw = re.search(rf"'{key}',\s*([^,\n]+(?:/\d+)?)", block).group(1)
            return arithmetic(raw, {'pi': math.pi, **{k: float(v) for k, v in names.items()}})
        inertia = re.search(r"'I', \[(.*?)\]", block)
        offset = re.search(r"'offset', (-?\d+)\*", block)
        centre = re.search(r"'r', \[(.*?)\]\*", block).group(1)
        link = {key: value(key) for key in ('d', 'a', 'alpha', 'Jm', 'G')}
        link['offset'] = math.radians(float(offset.group(1))) if offset else 0.0
        if inertia:
            link['m'], link['r'], link['I'] = value('m'), numbers(centre), numbers(inertia.group(1))
        else:
            # Their last link carries the load: here it is the flange alone, the size of one.
            link['m'], link['r'] = float(names['m_axis6']), [0.0, 0.0, float(names['r_axis6'])]
            link['I'] = [0.1e6, 0.1e6, 0.1e6, 0, 0, 0]
        found.append(link)
    load = float(names['r_payload']) * 1e-3
    return found, load


def turn(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    m = np.eye(4)
    i, j = {'x': (1, 2), 'z': (0, 1)}[axis]
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


def shift(x, y, z):
    m = np.eye(4)
    m[:3, 3] = x, y, z
    return m


def frames(all_links):
    """From each joint's turning frame to the end of its link, at the zero of the drives."""
    return [turn('z', link['offset'] + zero) @ shift(link['a'], 0, link['d']) @ turn('x', link['alpha'])
            for link, zero in zip(all_links, ZERO)]


def urdf(all_links):
    def pose(m):
        r = m[:3, :3]
        rpy = (math.atan2(r[2, 1], r[2, 2]), math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0])),
               math.atan2(r[1, 0], r[0, 0]))
        return f'<origin xyz="{m[0, 3]} {m[1, 3]} {m[2, 3]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>'
    out, at, parent = ['<robot name="kr300"><link name="base"/>'], turn('x', math.pi), 'base'
    for i, (link, end) in enumerate(zip(all_links, frames(all_links)), 1):
        xx, yy, zz, xy, yz, xz = np.array(link['I']) * 1e-6
        com = (end @ np.append(np.array(link['r']) * 1e-3, 1))[:3]
        inertia = end[:3, :3] @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ end[:3, :3].T
        of = ' '.join(f'i{"xyz"[a]}{"xyz"[b]}="{inertia[a, b]}"' for a in range(3) for b in range(a, 3))
        out.append(f'<link name="link{i}"><inertial><origin xyz="{com[0]} {com[1]} {com[2]}"/><mass value="{link["m"]}"/>'
                   f'<inertia {of}/></inertial></link>')
        out.append(f'<joint name="joint{i}" type="revolute"><parent link="{parent}"/><child link="link{i}"/>{pose(at)}'
                   f'<axis xyz="0 0 1"/><limit effort="{EFFORT[i - 1]}" velocity="3" lower="-3.1" upper="3.1"/></joint>')
        at, parent = end, f'link{i}'
    out.append(f'<link name="flange"/><joint name="bolts" type="fixed"><parent link="link6"/><child link="flange"/>{pose(at)}'
               '</joint></robot>')
    return '\n'.join(out)


def weight_at_zero(all_links, load=None):
    """N.m that the drives hold at their zero; `load`: mass and centre at the flange."""
    at, axes, bodies = turn('x', math.pi), [], []
    for link, end in zip(all_links, frames(all_links)):
        axes.append((at[:3, 2], at[:3, 3]))
        at = at @ end
        bodies.append((link['m'], (at @ np.append(np.array(link['r']) * 1e-3, 1))[:3]))
    if load:
        bodies.append((load[0], (at @ np.append(load[1], 1))[:3]))
    hold = np.array([0.0, 0.0, GRAVITY])
    carried = [bodies[j:] for j in range(6)]
    return np.array([sum(m * axis @ np.cross(c - origin, hold) for m, c in all_bodies)
                     for (axis, origin), all_bodies in zip(axes, carried)])


def cylinder(text, angle):
    """N.m of their model of the gas cylinder at joint 2, at angles of its drive."""
    text = re.sub(r'%.*', '', text)
    names = {'pi': math.pi}
    for name, raw in re.findall(r'^(\w+) = ([^;]+);', text, re.M):
        try:
            names[name] = arithmetic(raw, names)
        except KeyError:
            break
    far, near = names['D'], names['k']
    delta = angle + ZERO[1] + math.radians(95)
    length = np.sqrt(far ** 2 + near ** 2 - 2 * far * near * np.cos(delta))
    moved = length - (far - near)
    area = math.pi * (names['Diameter_Piston'] ** 2 - names['Diameter_Rod'] ** 2) / 4
    gas = names['Z_176bar'] * names['realGasFactor_nitrogen'] * names['temperature'] * names['mass_nitrogen']
    return np.sin(delta) * far * near / length * gas / (names['v_max'] - moved * area) * area


def recordings(source, work, gears):
    """One table for each motion and each two of them; their angles at joint 2; what their feed-forward holds at zero."""
    tables, held = {}, None
    for motion in MOTIONS:
        path = source / f'data/recorded_trajectories/2020-10-21 10s FF {motion} 08ms/data.mat'
        all_data = scipy.io.loadmat(path, squeeze_me=True, struct_as_record=False)
        rec, held = all_data['rec'], all_data['tau_g_init']
        q, qd = [np.radians(x.T) for x in (rec.act_pos_mot_deg, rec.act_vel_mot_deg_per_s)]
        tables[motion] = np.c_[rec.time_cont, q, qd, rec.act_torque_abs_nm.T * gears]
    for one, other in itertools.combinations(MOTIONS, 2):
        later = tables[other].copy()
        later[:, 0] += tables[one][-1, 0] + PAUSE_S
        tables[one + other] = np.r_[tables[one], later]
    for name, table in tables.items():
        np.savetxt(work / f'{name}.csv', table, delimiter=',', fmt='%.9g')
    return {name: table[:, 2] for name, table in tables.items()}, held


def diagnosed(work, fit, check):
    out = work / f'{fit}-{check}'
    subprocess.run([ARMTWIN, 'diagnose', '--fit', work / f'{fit}.csv', '--check', work / f'{check}.csv', '--columns',
                    work / 'columns.toml', '--twin', work / 'kr300.toml', '--no-simulation', '--out', out, '--overwrite'],
                   check=True, capture_output=True)
    return json.loads((out / 'diagnosis.json').read_text())


def row(name, found, all_links, slope):
    def cause(effect, joints):
        return next((c for c in found['causes'] if c['effect'] == effect and c['joints'] == joints), None)

    def told(cause, name):
        value = next(p for p in cause['parameters'] if p['name'] == name)
        return '{value:.0f} ({low:.0f} to {high:.0f})'.format(**value)
    load, spring = cause('payload', []), cause('cable_spring', [2])
    moment = '-'
    if load:
        values = {p['name']: p['value'] for p in load['parameters']}
        at = [values[f'payload_centre_{x}'] for x in 'xyz']
        own = weight_at_zero(all_links)[4]
        moment = f'{abs(weight_at_zero(all_links, (values["payload_mass"], at))[4] - own) / GRAVITY:.1f}'
    others = [f'{c["effect"]}{" at " + ", ".join(map(str, c["joints"])) if c["joints"] else ""}' for c in found['causes']
              if c not in (load, spring)]
    torque = found['shrink']['torque']
    cells = [name, told(load, 'payload_mass') if load else 'not named', moment,
             told(spring, 'cable_stiffness') if spring else 'not named', f'{slope:.0f}',
             f'{torque["before_nm"]:.0f} to {torque["after_nm"]:.0f}', f'{100 * torque["reducible"]:.1f} %',
             ', '.join(others) or '-', f'{found["seconds"]:.0f}']
    return '| ' + ' | '.join(cells) + ' |'


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument('source', type=Path)
    arguments.add_argument('--work', type=Path, required=True)
    arguments.add_argument('-o', '--out', type=Path, required=True)
    given = arguments.parse_args()
    given.work.mkdir(parents=True, exist_ok=True)
    all_links, centre = links((given.source / 'robot_model/model_KUKA_Quantec_Ultra_KR300.m').read_text(errors='replace'))
    gears = np.array([link['G'] for link in all_links])
    gas = (given.source / 'ident_functions/hydraulic_weight_counterbalance.m').read_text(errors='replace')
    angles, held = recordings(given.source, given.work, gears)
    rotors = [round(link['Jm'] * link['G'] ** 2, 1) for link in all_links]
    (given.work / 'kr300.urdf').write_text(urdf(all_links))
    (given.work / 'columns.toml').write_text(COLUMNS)
    (given.work / 'kr300.toml').write_text(
        f'robot = "kr300.urdf"\n[drive]\ngear_ratio = 1\ntorque_constant = 1\nrotor_inertia = {rotors}\n'
        '[twin]\neffects = ["coulomb", "viscous"]\n')
    # Their controller holds the load at zero with what is left of joint 5.
    own = weight_at_zero(all_links)
    per_kg = weight_at_zero(all_links, (1.0, [0, 0, centre]))[4] - own[4]
    load = (held[4] - own[4]) / per_kg
    with_load = weight_at_zero(all_links, (load, [0, 0, centre]))
    singles = [(a, b) for a in MOTIONS for b in MOTIONS if a != b]
    doubles = [(a + b, next(c for c in MOTIONS if c not in a + b)) for a, b in itertools.combinations(MOTIONS, 2)]
    rows = []
    for fit, check in doubles + singles:
        slope = np.polyfit(angles[fit], cylinder(gas, angles[fit]), 1)[0]
        rows.append((len(fit), row(f'{fit}, {check}', diagnosed(given.work, fit, check), all_links, slope)))
        print(rows[-1][1], flush=True)
    version = subprocess.run([ARMTWIN, '--version'], check=True, capture_output=True, text=True).stdout.strip()
    head = ('| fit, check | load, kg (90 %) | its moment about joint 5, kg.m | spring at joint 2, N.m/rad (90 %) | '
            'their model of the cylinder, N.m/rad | gap, N.m | explained above the noise | other causes | s |\n'
            '|---|---|---|---|---|---|---|---|---|\n')
    two, one = ['\n'.join(r for n, r in rows if n == k) for k in (2, 1)]
    moment = abs(with_load[4] - own[4]) / GRAVITY
    given.out.write_text(f"""# A real KUKA KR300

Made by `python3 benches/kr300.py Robot_Identification --work WORK -o docs/kr300.md`, {version}.

An industrial arm with links of 920 kg. Recordings, masses and the model of its gas cylinder are public
(Weigand et al., [{SOURCE.split('/')[-1]}]({SOURCE}), MIT): three motions of 10 s each, 250 Hz, torque at the motors. The
twin has their links, flange and rotors, and leaves friction open; **it knows neither the load nor the cylinder that
carries the arm at joint 2**. Two motions one after the other are the fit, the third one is the check:

{head}{two}

* **Their load**: the feed-forward of their controller holds {held[4]:.0f} N.m at joint 5 where all drives are at zero. Links and flange
  hold {own[4]:.0f} of it; a load at their centre ({1000 * centre:.0f} mm beyond the flange) would be {load:.0f} kg, and has a moment of
  {moment:.1f} kg.m about joint 5. With it the weight at joint 3 is {with_load[2]:.0f} N.m by this URDF, {held[2]:.0f} N.m by theirs.
* **Their cylinder**: the slope of their model over the angles of the fit recording; it is no straight line.
* A gas cylinder is called `cable_spring`: in the range of a motion both are springs.

One motion of 10 s, a reversal or two of each joint, against another one:

{head}{one}

**Not blind in one point**: when this arm was first asked, a spring could give a third of the rated torque within a radian,
and this cylinder lay at that bound; it may give all of it now. Nothing else in the search was changed for it.
""")


if __name__ == '__main__':
    main()
