"""A twin from a MuJoCo model, read by the `mujoco` package."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from . import _engine
from ._arrays import Floats
from ._errors import InputError
from .twin import PerJoint, StrPath, _drive, _numbers


def read(path: StrPath, *, gains: PerJoint | None, tip: str | None, friction: str) -> _engine.Twin:
    """The arm of the model: the chain of hinges that ends in `tip`."""
    if friction not in ("given", "open"):
        raise InputError(f'friction {friction}: "given" or "open"')
    try:
        import mujoco
    except ImportError as missing:
        raise InputError("mujoco is not installed: pip install mujoco") from missing
    name = os.fspath(path)
    try:
        model = mujoco.MjModel.from_xml_path(name)
    except ValueError as wrong:
        raise InputError(f"{name}: {wrong}") from wrong
    chain = _chain(mujoco, model, tip, name)
    hinges = [int(model.body_jntadr[body]) for body in chain if model.body_jntnum[body]]
    dofs = [int(model.jnt_dofadr[joint]) for joint in hinges]
    values = {}
    if friction == "given":
        values = {"coulomb": model.dof_frictionloss[dofs], "viscous": model.dof_damping[dofs]}
    lines = ['robot = "arm.urdf"', *_drive(name, gains, model.dof_armature[dofs].tolist())]
    lines += ["[twin]", 'effects = ["coulomb", "viscous"]', "[twin.values]"]
    lines += [f"{key} = {_numbers(value.tolist())}" for key, value in values.items()]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.urdf").write_text(_urdf(model, chain))
        twin = _engine.Twin.parse("\n".join(lines), Path(folder) / "twin.toml", gains is None)
    x, y, z = (float(g) for g in model.opt.gravity)
    return twin.renamed(name, (x, y, z))


def _chain(mujoco: Any, model: Any, tip: str | None, name: str) -> list[int]:
    """Bodies from the world's child to the tip, the world left out."""

    def above(body: int) -> list[int]:
        chain = []
        while body != 0:
            chain.append(body)
            body = int(model.body_parentid[body])
        return chain[::-1]

    def count(body: int) -> int:
        return sum(int(model.body_jntnum[b]) for b in above(body))

    if tip is not None:
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, tip)
        if body < 0:
            raise InputError(f"{name}: no body {tip}")
    elif model.nbody < 2:
        raise InputError(f"{name}: no hinge")
    else:
        body = max(range(1, model.nbody), key=lambda b: (count(b), -b))
    chain = above(body)
    for b in chain:
        joints = range(int(model.body_jntadr[b]), int(model.body_jntadr[b]) + int(model.body_jntnum[b]))
        if len(joints) > 1 or any(model.jnt_type[j] != mujoco.mjtJoint.mjJNT_HINGE for j in joints):
            raise InputError(f"{name}: body {model.body(b).name}: one hinge per body is read, nothing else")
    if not count(body):
        raise InputError(f"{name}: no hinge")
    return chain


def _turned(quaternion: Floats) -> Floats:
    """Rotation matrix of (w, x, y, z)."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _angles(turn: Floats) -> Floats:
    """Roll, pitch and yaw of Rz Ry Rx."""
    pitch = np.arctan2(-turn[2, 0], np.hypot(turn[0, 0], turn[1, 0]))
    if np.hypot(turn[0, 0], turn[1, 0]) < 1e-9:
        return np.array([np.arctan2(-turn[1, 2], turn[1, 1]), pitch, 0.0])
    return np.array([np.arctan2(turn[2, 1], turn[2, 2]), pitch, np.arctan2(turn[1, 0], turn[0, 0])])


def _three(values: Any) -> str:
    return " ".join(repr(float(v)) for v in values)


def _urdf(model: Any, chain: list[int]) -> str:
    """Bodies at the model's reference pose (qpos0): what MuJoCo calls a joint's anchor is the frame's origin here."""
    lines = ['<robot name="arm">', '<link name="world"/>']
    parent = "world"
    moved = np.zeros(3)
    for body in chain:
        name = model.body(body).name or f"body_{body}"
        turn = _turned(model.body_quat[body])
        at = np.asarray(model.body_pos[body], dtype=np.float64) - moved
        joint = int(model.body_jntadr[body]) if model.body_jntnum[body] else -1
        anchor = np.asarray(model.jnt_pos[joint], dtype=np.float64) if joint >= 0 else np.zeros(3)
        at = at + turn @ anchor
        lines += _link(model, body, name, anchor)
        kind, more = "fixed", list[str]()
        label = f"to_{name}"
        if joint >= 0:
            label = model.joint(joint).name or label
            kind, more = _hinge(model, joint)
        lines.append(f"<joint name={quoteattr(label)} type={quoteattr(kind)}>")
        lines.append(f"<parent link={quoteattr(parent)}/><child link={quoteattr(name)}/>")
        lines.append(f'<origin xyz="{_three(at)}" rpy="{_three(_angles(turn))}"/>')
        lines += [*more, "</joint>"]
        parent, moved = name, anchor
    return "\n".join([*lines, "</robot>"])


def _hinge(model: Any, joint: int) -> tuple[str, list[str]]:
    reference = float(model.qpos0[model.jnt_qposadr[joint]])
    if reference != 0.0:
        raise InputError(f"joint {model.joint(joint).name}: a reference angle (ref) other than 0 is not read")
    axis = f'<axis xyz="{_three(model.jnt_axis[joint])}"/>'
    if not model.jnt_limited[joint]:
        return "continuous", [axis]
    low, high = (float(v) for v in model.jnt_range[joint])
    return "revolute", [axis, f'<limit lower="{low!r}" upper="{high!r}" velocity="10" effort="1000"/>']


def _link(model: Any, body: int, name: str, anchor: Floats) -> list[str]:
    mass = float(model.body_mass[body])
    if mass == 0.0:
        return [f"<link name={quoteattr(name)}/>"]
    turn = _turned(model.body_iquat[body])
    inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
    centre = np.asarray(model.body_ipos[body], dtype=np.float64) - anchor
    six = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    entries = " ".join(f'{key}="{float(inertia[at])!r}"' for key, at in six.items())
    return [
        f"<link name={quoteattr(name)}><inertial>",
        f'<origin xyz="{_three(centre)}"/><mass value="{mass!r}"/><inertia {entries}/>',
        "</inertial></link>",
    ]
