"""Twins: what is known about an arm before a recording is seen."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from . import _engine
from ._arrays import ArrayLike, Floats, motion, unwrapped
from ._errors import InputError

__all__ = ["Robot", "Twin"]

PerJoint: TypeAlias = float | Sequence[float]
StrPath: TypeAlias = str | os.PathLike[str]


class Robot:
    """The rigid arm of a twin: M(q) qdd + C(q, qd) qd + g(q) = tau.

    Every method takes one instant, ``(n,)``, or many, ``(T, n)``, of any real dtype and any strides.
    """

    def __init__(self, engine: _engine.Twin) -> None:
        self._engine = engine

    def __repr__(self) -> str:
        return f"<Robot: {self.dof} joints, {self.mass:.3f} kg>"

    @property
    def dof(self) -> int:
        """Number of joints."""
        return self._engine.dof

    @property
    def joints(self) -> list[str]:
        """Names of the joints, base to wrist."""
        return self._engine.joints

    @property
    def mass(self) -> float:
        """Mass of all moving bodies, kg."""
        return self._engine.mass

    def mass_matrix(self, q: ArrayLike) -> Floats:
        """Joint-space inertia.

        Parameters
        ----------
        q : array_like, shape (n,) or (T, n)
            Positions, rad.

        Returns
        -------
        ndarray, shape (n, n) or (T, n, n)
            kg.m2; symmetric.
        """
        single, [q_] = motion(q=q)
        found = self._engine.mass_matrix(q_)
        return unwrapped(single, found)

    def inverse_dynamics(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike) -> Floats:
        """Torque that moves the bodies.

        Parameters
        ----------
        q, qd, qdd : array_like, shape (n,) or (T, n)
            rad, rad/s, rad/s2.

        Returns
        -------
        ndarray, shape (n,) or (T, n)
            N.m
        """
        single, arrays = motion(q=q, qd=qd, qdd=qdd)
        found = self._engine.inverse_dynamics(*arrays).T
        return unwrapped(single, found)

    def gravity(self, q: ArrayLike) -> Floats:
        """Torque that holds the bodies still, N.m; shapes as in `inverse_dynamics`."""
        rest = np.zeros_like(np.asarray(q, dtype=np.float64))
        return self.inverse_dynamics(q, rest, rest)

    def regressor(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike) -> Floats:
        """Y with tau = Y pi, pi being `inertial_parameters`.

        Parameters
        ----------
        q, qd, qdd : array_like, shape (n,) or (T, n)
            rad, rad/s, rad/s2.

        Returns
        -------
        ndarray, shape (n, 10 n) or (T, n, 10 n)
            Ten columns per body: N.m per kg, kg.m and kg.m2.
        """
        single, arrays = motion(q=q, qd=qd, qdd=qdd)
        found = self._engine.regressor(*arrays)
        return unwrapped(single, found)

    @property
    def inertial_parameters(self) -> Floats:
        """(10 n,): per body m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about its joint's frame."""
        return np.array(self._engine.inertial_parameters())


class Twin:
    """An arm, its drive, and the effects its owner already models.

    Make one by `load`, `builtin`, `from_urdf` or `from_mjcf`.
    """

    def __init__(self, engine: _engine.Twin) -> None:
        self._engine = engine

    @classmethod
    def load(cls, path: StrPath) -> Twin:
        """From a ``TWIN.toml``; a URDF's path counts from its folder."""
        return cls(_engine.Twin.load(Path(path)))

    @classmethod
    def builtin(cls, name: str = "ur5") -> Twin:
        """A built-in arm with Coulomb and viscous friction to be fitted."""
        if name not in cls.builtins():
            raise InputError(f"no built-in arm {name}; there are {', '.join(cls.builtins())}")
        return cls(_engine.Twin.builtin(name))

    @staticmethod
    def builtins() -> list[str]:
        """Names of the built-in arms."""
        return _engine.Twin.builtins()

    @classmethod
    def from_urdf(
        cls,
        path: StrPath,
        *,
        gains: PerJoint | None = None,
        rotor_inertia: PerJoint | None = None,
        base: str | None = None,
        tip: str | None = None,
        effects: Sequence[str] = ("coulomb", "viscous"),
        values: Mapping[str, PerJoint] | None = None,
    ) -> Twin:
        """From a URDF, or a built-in arm's name.

        Parameters
        ----------
        path : path-like or str
            The file, or a name of `builtins`.
        gains : float or sequence of float, optional
            Joint torque per ampere, N.m/A. Left out, recordings must hold torque; of the UR5 they are known.
        rotor_inertia : float or sequence of float, optional
            As seen at the joint, kg.m2.
        base, tip : str, optional
            Links between which the arm is.
        effects : sequence of str
            What is modelled (`armtwin.effects`); without ``values`` it is fitted.
        values : mapping of str to float or sequence, optional
            Known parameters by name.
        """
        name = os.fspath(path)
        lines = [f"robot = {json.dumps(name)}"]
        lines += [f"{key} = {json.dumps(link)}" for key, link in (("base", base), ("tip", tip)) if link]
        lines += _drive(name, gains, rotor_inertia)
        lines += ["[twin]", f"effects = {json.dumps(list(effects))}", "[twin.values]"]
        lines += [f"{key} = {_numbers(value)}" for key, value in (values or {}).items()]
        undriven = gains is None and name != "ur5"
        return cls(_engine.Twin.parse("\n".join(lines), Path("twin"), undriven))

    @classmethod
    def from_mjcf(
        cls,
        path: StrPath,
        *,
        gains: PerJoint | None = None,
        tip: str | None = None,
        friction: str = "given",
    ) -> Twin:
        """From a MuJoCo model: bodies, armature, frictionloss and damping as the `mujoco` package reads them.

        Parameters
        ----------
        path : path-like
            An MJCF or URDF file that MuJoCo loads.
        gains : float or sequence of float, optional
            Joint torque per ampere, N.m/A; left out, recordings must hold torque.
        tip : str, optional
            The body at the end of the arm; the one after most hinges.
        friction : {"given", "open"}
            Whether the model's friction counts as known, or is fitted.
        """
        from ._mjcf import read

        return cls(read(path, gains=gains, tip=tip, friction=friction))

    def __repr__(self) -> str:
        given = ", ".join(f"{name}{'' if self._is_open(name) else ' (known)'}" for name in self.effects)
        return f"<Twin of {self.source}: {self.robot.dof} joints; {given or 'no effects'}>"

    def _is_open(self, effect: str) -> bool:
        return not any(name.startswith(effect) for name in self.values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Twin) and self._engine.to_bytes() == other._engine.to_bytes()

    def __hash__(self) -> int:
        return hash(self._engine.to_bytes())

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return _restored, (self._engine.to_bytes(),)

    @property
    def robot(self) -> Robot:
        """The rigid arm."""
        return Robot(self._engine)

    @property
    def source(self) -> str:
        """The built-in name, or the file of the arm."""
        return self._engine.source

    @property
    def joints(self) -> list[str]:
        """Names of the joints, base to wrist."""
        return self._engine.joints

    @property
    def effects(self) -> list[str]:
        """What the twin models."""
        return self._engine.effects

    @property
    def values(self) -> dict[str, Floats]:
        """Known parameters by name: one value per joint, or one in all."""
        return {name: np.array(values) for name, values in self._engine.values.items()}

    @property
    def rotor_inertia(self) -> Floats:
        """(n,): of the drive, as seen at the joint, kg.m2."""
        return np.array(self._engine.rotor_inertia)

    @property
    def gains(self) -> Floats:
        """(n,): joint torque per ampere, N.m/A."""
        return np.array(self._engine.torque_per_ampere)

    @property
    def notes(self) -> list[str]:
        """What was assumed where the arm's file does not say."""
        return self._engine.notes

    def torque(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike, dt: float = 0.008) -> Floats:
        """What the drive must supply, by all that the twin knows.

        Parameters
        ----------
        q, qd, qdd : array_like, shape (n,) or (T, n)
            rad, rad/s, rad/s2; no copy is kept.
        dt : float
            Time between rows, s; for effects with memory.

        Returns
        -------
        ndarray, shape (n,) or (T, n)
            N.m
        """
        single, (q_, qd_, qdd_) = motion(q=q, qd=qd, qdd=qdd)
        found = self._engine.torque(q_, qd_, qdd_, dt).T
        return unwrapped(single, found)

    def to_toml(self) -> str:
        """Text of a ``TWIN.toml``."""
        return self._engine.to_toml()

    def save(self, path: StrPath) -> None:
        """Write a ``TWIN.toml``, which `load` and the program read; an arm that is in no file yet is written
        beside it as URDF."""
        self._engine.save(Path(path))

    def export(self, path: StrPath) -> list[str]:
        """Write the twin for a simulator, ``.xml`` (MuJoCo) or ``.urdf``.

        Returns
        -------
        list of str
            What the twin knows and the format cannot hold.
        """
        ending = Path(path).suffix.lower()
        if ending not in (".xml", ".urdf"):
            raise InputError(f"{os.fspath(path)}: end the name in .xml (MuJoCo) or .urdf")
        text, left = self._engine.export(ending == ".xml")
        _engine.write_text(Path(path), text)
        return left


def _restored(state: bytes) -> Twin:
    return Twin(_engine.Twin.from_bytes(state))


def _numbers(value: PerJoint) -> str:
    """As TOML; integers too are read as floats there."""
    array = np.asarray(value, dtype=np.float64)
    return json.dumps(array.tolist())


def _drive(name: str, gains: PerJoint | None, rotor_inertia: PerJoint | None) -> list[str]:
    lines = ["[drive]"]
    if gains is not None:
        lines += ["gear_ratio = 1.0", f"torque_constant = {_numbers(gains)}"]
    elif name != "ur5":
        lines += ["gear_ratio = 1.0", "torque_constant = 1.0"]
    if rotor_inertia is not None:
        lines.append(f"rotor_inertia = {_numbers(rotor_inertia)}")
    return lines
