"""Where a twin differs from its arm, why, and how far mending it helps."""

from __future__ import annotations

import html
import json
import os
import tempfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from . import _engine
from ._arrays import Floats
from ._errors import InputError
from ._listen import Listener, Progress
from ._signals import Signals, taken
from ._table import Table
from .recording import Recording
from .twin import Twin

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Cause", "Diagnosis", "Gap", "JointGap", "Shrink", "Trace", "Unexplained", "Value", "diagnose"]

StrPath: TypeAlias = str | os.PathLike[str]


@dataclass(frozen=True)
class Value:
    """A parameter of a cause with its 90 % interval, in `unit`; `joint` counts from 1, None is the whole arm."""

    name: str
    joint: int | None
    unit: str
    value: float
    low: float
    high: float
    at_bound: bool


@dataclass(frozen=True)
class Shrink:
    """Torque gap of the check recording before and after, N.m rms.

    `fraction` of the mean square is taken off, with its 90 % interval `low` to `high`.
    """

    before_nm: float
    after_nm: float
    fraction: float
    low: float
    high: float


@dataclass(frozen=True)
class Cause:
    """An effect that the twin lacks.

    Attributes
    ----------
    effect : str
    joints : tuple of int
        From 1 at the base; empty: the whole arm.
    probability : float
    parameters : tuple of Value
    shrink : Shrink
        When added to the other causes.
    equivalent : tuple of str
        What would look the same in these data.
    cause, remedy : str
    """

    effect: str
    joints: tuple[int, ...]
    probability: float
    parameters: tuple[Value, ...]
    shrink: Shrink
    equivalent: tuple[str, ...]
    cause: str
    remedy: str

    @property
    def place(self) -> str:
        """In words."""
        if not self.joints:
            return "the whole arm"
        return f"joint{'s' if len(self.joints) > 1 else ''} {', '.join(map(str, self.joints))}"

    def __repr__(self) -> str:
        values = ", ".join(f"{v.name} {v.value:.3g} {v.unit}" for v in self.parameters)
        return f"<{self.effect} at {self.place}: {values}; {100 * self.probability:.0f} % sure>"


@dataclass(frozen=True)
class JointGap:
    """Recorded torque less the twin's while one joint slides, N.m rms, with the noise floor and its share."""

    joint: int
    rms_nm: float
    low_nm: float
    high_nm: float
    noise_floor_nm: float
    share: float


@dataclass(frozen=True)
class Gap:
    """Where the twin differs."""

    joints: tuple[JointGap, ...]

    @property
    def table(self) -> Table:
        """A row per joint."""
        rows = [(j.joint, j.rms_nm, j.low_nm, j.high_nm, j.noise_floor_nm, j.share) for j in self.joints]
        return Table.of(("joint", "rms_nm", "low_nm", "high_nm", "noise_floor_nm", "share"), rows)


@dataclass(frozen=True)
class Unexplained:
    """What the causes leave of the check recording: N.m rms, share of the mean square before."""

    rms_nm: float
    fraction: float
    above_noise: bool


@dataclass(frozen=True, eq=False)
class Trace:
    """A joint of the check recording, sample by sample.

    Attributes
    ----------
    joint : int
        From 1.
    t, torque, before, after : ndarray, shape (T,)
        s; recorded torque, and what the twin leaves of it without and with the causes, N.m.
    """

    joint: int
    t: Floats
    torque: Floats
    before: Floats
    after: Floats


def _cause(raw: Mapping[str, Any]) -> Cause:
    s = raw["shrink"]
    shrink = Shrink(s["check_before_nm"], s["check_after_nm"], s["fraction"], s["low"], s["high"])
    keys = ("name", "joint", "unit", "value", "low", "high", "at_bound")
    values = tuple(Value(**{key: v.get(key) for key in keys}) for v in raw["parameters"])
    same = tuple(e["effect"] for e in raw["equivalent"])
    place, sure = tuple(raw["joints"]), raw["probability"]
    return Cause(raw["effect"], place, sure, values, shrink, same, raw["cause"], raw["remedy"])


class _Stored:
    """What a pickle keeps of a diagnosis."""

    def __init__(self, state: dict[str, Any]) -> None:
        self._state = state
        self.sentence: str = state["sentence"]

    def json(self) -> str:
        return str(self._state["json"])

    @property
    def twin(self) -> _engine.Twin:
        return _engine.Twin.from_bytes(self._state["twin"])

    @property
    def mended(self) -> _engine.Twin:
        return _engine.Twin.from_bytes(self._state["mended"])

    def traces(self) -> list[tuple[int, list[Floats]]]:
        traces: list[tuple[int, list[Floats]]] = self._state["traces"]
        return traces

    def html(self) -> str:
        return zlib.decompress(self._state["html"]).decode()

    def rerun(self, path: Path) -> None:
        path.write_bytes(zlib.decompress(self._state["rrd"]))


class Diagnosis:
    """What `diagnose` found; `sentence` has it in one."""

    def __init__(self, done: _engine.Diagnosed | _Stored) -> None:
        self._done = done

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "twin.rrd"
            self._done.rerun(scene)
            rrd = zlib.compress(scene.read_bytes(), 1)
        state = {
            "sentence": self._done.sentence,
            "json": self._done.json(),
            "twin": self._done.twin.to_bytes(),
            "mended": self._done.mended.to_bytes(),
            "traces": self._done.traces(),
            "html": zlib.compress(self._done.html().encode(), 1),
            "rrd": rrd,
        }
        return _restored, (state,)

    @cached_property
    def _document(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self._done.json())
        return document

    @property
    def sentence(self) -> str:
        """Which effects are missing, how sure that is, how far the gap shrinks with them, what stays."""
        return self._done.sentence

    @property
    def verdict(self) -> str:
        """"no_gap", "explained", "partly_explained" or "unexplained"."""
        return str(self._document["verdict"])

    @cached_property
    def causes(self) -> tuple[Cause, ...]:
        """Effects that the twin lacks, what takes most off the gap first."""
        return tuple(_cause(raw) for raw in self._document["causes"])

    @cached_property
    def gap(self) -> Gap:
        """Where the twin differs, joint by joint."""
        keys = ("joint", "rms_nm", "low_nm", "high_nm", "noise_floor_nm", "share")
        joints = self._document["gap"]["joints"]
        return Gap(tuple(JointGap(**{key: joint[key] for key in keys}) for joint in joints))

    @cached_property
    def shrink(self) -> Shrink:
        """How far the torque gap shrinks on the check recording."""
        raw = self._document["shrink"]["torque"]
        return Shrink(**{key: raw[key] for key in ("before_nm", "after_nm", "fraction", "low", "high")})

    @cached_property
    def unexplained(self) -> Unexplained:
        """What no cause explains."""
        raw = self._document["unexplained"]
        return Unexplained(raw["rms_nm"], raw["fraction"], raw["above_noise"])

    @property
    def ranking(self) -> Table:
        """Every candidate with its probability, "none" and "unknown" among them."""
        rows = [
            (r["effect"], ", ".join(map(str, r["joints"])) or "arm", r["probability"])
            for r in self._document["ranking"]
        ]
        return Table.of(("effect", "joints", "probability"), rows)

    @property
    def next_experiment(self) -> str:
        """What would tell more."""
        return str(self._document["next_experiment"])

    @property
    def notes(self) -> list[str]:
        """What was noticed on the way."""
        return list(self._document["notes"])

    @cached_property
    def mended(self) -> Twin:
        """The twin with the causes and the fitted values in it."""
        return Twin(self._done.mended)

    @cached_property
    def twin(self) -> Twin:
        """The twin as given."""
        return Twin(self._done.twin)

    @cached_property
    def traces(self) -> tuple[Trace, ...]:
        """The check recording, joint by joint, sample by sample."""
        return tuple(Trace(joint, *arrays) for joint, arrays in self._done.traces())

    @property
    def table(self) -> Table:
        """A row per parameter of each cause."""
        columns = ("effect", "joints", "probability", "parameter", "unit", "value", "low", "high")
        rows = [
            (c.effect, c.place, c.probability, v.name, v.unit, v.value, v.low, v.high)
            for c in self.causes
            for v in c.parameters
        ]
        return Table.of(columns, rows)

    def __repr__(self) -> str:
        return f"<Diagnosis: {self.sentence}>"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(self.sentence)}</p>{self.gap.table._repr_html_()}{self.table._repr_html_()}"

    def to_pandas(self) -> pd.DataFrame:
        """`table` with all digits."""
        return self.table.to_pandas()

    def to_dict(self) -> dict[str, Any]:
        """The document that ``armtwin diagnose --json`` writes."""
        document: dict[str, Any] = json.loads(self._done.json())
        return document

    def report(self, path: StrPath) -> None:
        """Write a report with pictures, one HTML file for any browser."""
        _engine.write_text(Path(path), self._done.html())

    def rerun(self, path: StrPath) -> None:
        """Write a scene for the viewer: the recorded arm beside both twins."""
        self._done.rerun(Path(path))

    def show(self) -> None:
        """Open the scene in the viewer (``pip install armtwin[viewer]``)."""
        try:
            import rerun
        except ImportError as missing:
            raise InputError("the viewer is not installed: pip install 'armtwin[viewer]'") from missing
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "twin.rrd"
            self.rerun(scene)
            rerun.init("armtwin", spawn=True)
            rerun.log_file_from_path(scene)

    def save(self, path: StrPath) -> None:
        """Write what the name ends in: .json (everything), .html (`report`), .rrd (`rerun`), .toml (`mended`)."""
        ending = Path(path).suffix.lower()
        if ending == ".json":
            _engine.write_text(Path(path), json.dumps(self.to_dict(), indent=2) + "\n")
        elif ending == ".html":
            self.report(path)
        elif ending == ".rrd":
            self.rerun(path)
        elif ending == ".toml":
            self.mended.save(path)
        else:
            raise InputError(f"{os.fspath(path)}: end the name in .json, .html, .rrd or .toml")


def _restored(state: dict[str, Any]) -> Diagnosis:
    return Diagnosis(_Stored(state))


def diagnose(
    twin: Twin,
    recording: Recording,
    *,
    check: Recording | None = None,
    without: Sequence[str] = (),
    seed: int = 1,
    mass_error: float = 0.05,
    centre_error: float = 0.005,
    simulation: bool = True,
    signals: Signals | None = None,
    every_row: bool = False,
    force: bool = False,
    progress: Progress = None,
) -> Diagnosis:
    """Say where a twin differs from its arm and which effects it lacks; as ``armtwin diagnose``, with its defaults.

    Parameters
    ----------
    twin : Twin
        What it lists without values (its friction) is fitted along and is no gap.
    recording : Recording
        To search causes on.
    check : Recording, optional
        Another one, which decides; the second half of the first.
    without : sequence of str
        Effects to take out of the catalogue.
    seed : int
        For the discrepancy's features and for bootstraps.
    mass_error : float
        How well the twin's link masses are known, relative; 0 takes them for exact.
    centre_error : float
        How well their centres are known, m.
    simulation : bool
        Move both twins again in the simulation.
    signals, every_row, force, progress
        As of `identify`.

    Returns
    -------
    Diagnosis

    Raises
    ------
    InputError, DoubtfulRecording
        As `identify`.
    """
    options = {
        "without": list(without),
        "seed": seed,
        "mass_error": mass_error,
        "centre_error_m": centre_error,
        "simulate": simulation,
        "taken": taken(signals, every_row, force),
    }
    done = _engine.diagnose(
        twin._engine,
        recording._for(twin),
        None if check is None else check._for(twin),
        json.dumps(options),
        Listener(progress),
    )
    return Diagnosis(done)
