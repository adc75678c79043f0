"""Motions that tell what an arm is like, within its limits.

Every function returns a `Motion`, which `armtwin.simulate` moves an arm along. The same settings and
seed give the same motion to the last bit.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from . import _engine
from ._arrays import Floats
from .twin import Twin

__all__ = ["Motion", "Sampled", "fourier", "mixed", "plateaus", "point_to_point", "random_sines"]


@dataclass(frozen=True)
class Sampled:
    """A motion at equal steps.

    Attributes
    ----------
    t : ndarray, shape (T,)
        s
    q, qd, qdd : ndarray, shape (T, n)
        rad, rad/s, rad/s2
    """

    t: Floats
    q: Floats
    qd: Floats
    qdd: Floats


@dataclass(frozen=True)
class Motion:
    """A motion of all joints that begins and ends at rest.

    Attributes
    ----------
    kind : str
        Its shape, by the name that scenario files use.
    seconds, rest : float
        Length, and rests at both ends, s.
    seed : int
    range, speed, acceleration : float
        The most that a joint does, rad, rad/s and rad/s2; joint limits cut it.
    home : sequence of float, optional
        Middle of the motion, rad; a pose above the table for UR arms, the middle of the limits for others.
    """

    kind: str
    seconds: float = 60.0
    seed: int = 1
    rest: float = 1.0
    range: float = 1.0
    speed: float = 1.5
    acceleration: float = 5.0
    home: Sequence[float] | None = None

    def _settings(self) -> dict[str, Any]:
        settings: dict[str, Any] = {
            "kind": self.kind,
            "seed": self.seed,
            "duration_s": self.seconds,
            "rest_s": self.rest,
            "range_rad": self.range,
            "speed_rad_s": self.speed,
            "acceleration_rad_s2": self.acceleration,
        }
        if self.home is not None:
            settings["home_rad"] = [float(q) for q in self.home]
        return settings

    def sampled(self, twin: Twin, dt: float = 0.008) -> Sampled:
        """The motion of this arm, every `dt` seconds."""
        t, q, qd, qdd = _engine.trajectory(twin._engine, json.dumps(self._settings()), dt)
        return Sampled(t, q.T, qd.T, qdd.T)


def mixed(seconds: float = 60.0, seed: int = 1, **more: Any) -> Motion:
    """Plateaus, sines and moves after each other: the usual one for identification."""
    return Motion("mixed", seconds, seed, **more)


def random_sines(seconds: float = 60.0, seed: int = 1, **more: Any) -> Motion:
    """Sines of random frequency."""
    return Motion("random_frequency", seconds, seed, **more)


def fourier(seconds: float = 60.0, seed: int = 1, **more: Any) -> Motion:
    """A finite Fourier series."""
    return Motion("fourier", seconds, seed, **more)


def plateaus(seconds: float = 60.0, seed: int = 1, **more: Any) -> Motion:
    """Constant speeds from 0.005 to 1 rad/s in both directions."""
    return Motion("plateaus", seconds, seed, **more)


def point_to_point(seconds: float = 60.0, seed: int = 1, **more: Any) -> Motion:
    """Random poses with rests."""
    return Motion("point_to_point", seconds, seed, **more)
