"""Ground truth: an arm moved in the simulation with effects that its twin does not know."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from . import _engine
from ._errors import InputError
from ._listen import Listener, Progress
from .motions import Motion, mixed
from .recording import Recording
from .twin import Twin

__all__ = ["Simulation", "effects", "simulate"]

StrPath: TypeAlias = str | os.PathLike[str]
Values: TypeAlias = Mapping[str, float | Sequence[float]]


@dataclass(frozen=True, eq=False)
class Simulation:
    """Two recordings of the same arm in different motions.

    Attributes
    ----------
    fit, check : Recording
    truth : dict
        Every effect and value that is hidden, noise, settings (``truth.json`` of the program).
    """

    fit: Recording
    check: Recording
    truth: dict[str, Any]

    def __repr__(self) -> str:
        hidden = ", ".join(e["effect"] for e in self.truth["effects"]) or "nothing"
        return f"<Simulation of a {self.truth['robot']} with {hidden}: {self.fit!r}, {self.check!r}>"

    def to_dict(self) -> dict[str, Any]:
        """`truth`."""
        return self.truth

    def save(self, folder: StrPath, *, format: str = "csv") -> None:
        """Write fit, check and truth.json into a folder; formats as of `Recording.save`."""
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        self.fit.save(place / f"fit.{format}")
        self.check.save(place / f"check.{format}")
        _engine.write_text(place / "truth.json", json.dumps(self.truth, indent=2) + "\n")


def _plain(value: float | Sequence[float]) -> Any:
    return np.asarray(value, dtype=np.float64).tolist()


def simulate(
    twin: Twin | StrPath,
    motion: Motion | None = None,
    *,
    effects: Mapping[str, Values] | None = None,
    check: Motion | None = None,
    seed: int = 1,
    rate_hz: float = 125.0,
    snr_db: float | None = None,
    position_noise: float = 0.0,
    velocity_noise: float = 0.0,
    progress: Progress = None,
) -> Simulation:
    """Move an arm in the simulation; as ``armtwin simulate``.

    Parameters
    ----------
    twin : Twin or path-like
        Whose arm is moved, with all that the twin knows; or a scenario file, which says everything.
    motion : Motion, optional
        In the fit recording; `armtwin.motions.mixed`.
    effects : mapping of str to mapping, optional
        Hidden effects, parameters by name with or without the effect's: ``{"payload": dict(mass=2.0)}``, one number for
        all joints or one per joint; ``joints=[3]`` limits it to some (from 1).
    check : Motion, optional
        In the check recording; the same with the next seed.
    seed : int
        Of the sensors' noise.
    rate_hz : float
        Of the recordings.
    snr_db : float, optional
        Noise of the currents, as a signal-to-noise ratio; none.
    position_noise, velocity_noise : float
        Standard deviations, rad and rad/s.
    progress : callable or bool, optional
        As of `identify`.

    Returns
    -------
    Simulation
    """
    if not isinstance(twin, Twin):
        if motion is not None or effects is not None:
            raise InputError("a scenario file says motion and effects itself: give a twin to choose them here")
        fit, other, truth = _engine.simulate(None, "{}", "{}", Path(twin), Listener(progress))
        return Simulation(Recording._of(fit), Recording._of(other), json.loads(truth))
    noise: dict[str, float] = {"position_rad": position_noise, "velocity_rad_s": velocity_noise}
    if snr_db is not None:
        noise["snr_db"] = snr_db
    scenario: dict[str, Any] = {
        "seed": seed,
        "rate_hz": rate_hz,
        "motion": (motion or mixed())._settings(),
        "check": {} if check is None else check._settings(),
        "noise": noise,
    }
    hidden = {
        name: {key: _plain(value) for key, value in values.items()} for name, values in (effects or {}).items()
    }
    fit, other, truth = _engine.simulate(
        twin._engine, json.dumps(scenario), json.dumps(hidden), None, Listener(progress)
    )
    return Simulation(Recording._of(fit), Recording._of(other), json.loads(truth))


def effects() -> dict[str, dict[str, Any]]:
    """The catalogue: law, cause, remedy, source and parameters of every effect, by name."""
    return {effect["name"]: effect for effect in json.loads(_engine.effects())}
