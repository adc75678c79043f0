"""Parameters that make a twin's torque match a recording, with tests and intervals."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from . import _engine
from ._arrays import Bools, Floats
from ._errors import InputError
from ._listen import Listener, Progress
from ._signals import Signals, taken
from ._table import Table
from .recording import Recording
from .twin import Twin

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Identification", "JointFit", "Parameter", "Prediction", "identify", "predict"]

StrPath: TypeAlias = str | os.PathLike[str]


@dataclass(frozen=True)
class Parameter:
    """An estimate with its robust 99 % interval.

    Attributes
    ----------
    name, unit : str
    value, low, high : float
        In `unit`.
    p : float
        Of the hypothesis that it is absent.
    at_bound : bool
    identifiable : bool
        False where the data do not determine it; then `why_not` says what is missing.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    p: float
    at_bound: bool
    identifiable: bool
    why_not: str | None = None

    @staticmethod
    def _of(raw: Mapping[str, Any]) -> Parameter:
        same: dict[str, Any] = {key: raw[key] for key in ("name", "unit", "at_bound", "identifiable", "why_not")}
        same.update({key: _number(raw[key]) for key in ("value", "low", "high", "p")})
        return Parameter(**same)

    def __repr__(self) -> str:
        told = f"{self.value:.4g} [{self.low:.4g}, {self.high:.4g}] {self.unit}"
        return f"<{self.name}: {told if self.identifiable else 'not told'}>"


@dataclass(frozen=True)
class JointFit:
    """One joint.

    Attributes
    ----------
    joint : int
        From 1 at the base.
    parameters : tuple of Parameter
        Also attributes by their names: ``fit["joint 2"].coulomb.value``.
    rms_nm : float
        Torque that is left, N.m.
    r2 : float
    check_rms_nm, check_r2 : float or None
        On the check recording.
    """

    joint: int
    parameters: tuple[Parameter, ...]
    rms_nm: float
    r2: float
    check_rms_nm: float | None = None
    check_r2: float | None = None

    @staticmethod
    def _of(raw: Mapping[str, Any]) -> JointFit:
        fit, check = raw["fit"], raw["check"]
        return JointFit(
            joint=raw["joint"],
            parameters=tuple(Parameter._of(p) for p in raw["parameters"]),
            rms_nm=_number(fit["mse_nm2"]) ** 0.5,
            r2=_number(fit["r2"]),
            check_rms_nm=None if check is None else _number(check["mse_nm2"]) ** 0.5,
            check_r2=None if check is None else _number(check["r2"]),
        )

    def __getattr__(self, name: str) -> Parameter:
        for parameter in self.__dict__.get("parameters", ()):
            if parameter.name == name:
                return parameter  # type: ignore[no-any-return]
        raise AttributeError(f"joint has no parameter {name}")

    def __repr__(self) -> str:
        return f"<joint {self.joint}: {', '.join(map(repr, self.parameters))}; {self.rms_nm:.3g} N.m left>"


@dataclass(frozen=True, eq=False)
class Prediction:
    """Torque along a recording, on its uniform grid.

    Attributes
    ----------
    t : ndarray, shape (T,)
        s
    torque, measured : ndarray, shape (T, n)
        By the twin, and as recorded, N.m.
    slides : ndarray of bool, shape (T, n)
        Where a joint slides, away from gaps and ends: there torque tells.
    """

    t: Floats
    torque: Floats
    measured: Floats
    slides: Bools

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        import numpy as np

        return np.array(self.torque, dtype=dtype, copy=copy)

    def rms_nm(self) -> list[float]:
        """Per joint: what is left where it slides, N.m."""
        pairs = zip((self.measured - self.torque).T, self.slides.T)
        return [float((left[on] ** 2).mean() ** 0.5) if on.any() else float("nan") for left, on in pairs]


def _number(raw: float | None) -> float:
    return float("nan") if raw is None else float(raw)


class _Stored:
    """What a pickle keeps of an identification."""

    def __init__(self, json: str, twin: bytes | None, page: bytes) -> None:
        self._json, self._twin, self._page = json, twin, page

    def json(self) -> str:
        return self._json

    def fitted(self) -> _engine.Twin | None:
        return None if self._twin is None else _engine.Twin.from_bytes(self._twin)

    def html(self) -> str:
        return zlib.decompress(self._page).decode()


class Identification:
    """What `identify` found.

    ``fit["joint 2"].coulomb.value`` is in the parameter's SI unit; ``fit.table`` has all.
    """

    def __init__(self, done: _engine.Identified | _Stored) -> None:
        self._done = done

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        twin = self._done.fitted()
        page = zlib.compress(self._done.html().encode(), 1)
        return _restored, (self._done.json(), None if twin is None else twin.to_bytes(), page)

    @cached_property
    def _document(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self._done.json())
        return document

    @cached_property
    def _result(self) -> dict[str, Any]:
        methods: list[dict[str, Any]] = self._document["methods"]
        return next((m for m in methods if m["method"] == "nlse"), methods[0])

    @property
    def method(self) -> str:
        """Whose values these are: least squares' where it ran."""
        return str(self._result["method"])

    @cached_property
    def joints(self) -> tuple[JointFit, ...]:
        """Base to wrist."""
        return tuple(JointFit._of(raw) for raw in self._result["joints"])

    @cached_property
    def arm(self) -> tuple[Parameter, ...]:
        """Parameters of the whole arm."""
        return tuple(Parameter._of(raw) for raw in self._result["arm"])

    def by(self, method: str) -> tuple[JointFit, ...]:
        """The joints by another method that ran: "pso", "nlse" or "mcmc"."""
        for raw in self._document["methods"]:
            if raw["method"] == method:
                return tuple(JointFit._of(joint) for joint in raw["joints"])
        ran = ", ".join(m["method"] for m in self._document["methods"])
        raise InputError(f"no results by {method}; there are those by {ran}")

    def __getitem__(self, joint: str) -> JointFit:
        """By name: ``"joint 2"`` counts from 1 at the base."""
        for found in self.joints:
            if joint == f"joint {found.joint}":
                return found
        raise KeyError(f"{joint}: there are joint 1 to joint {len(self.joints)}")

    def __iter__(self) -> Iterator[JointFit]:
        return iter(self.joints)

    def __len__(self) -> int:
        return len(self.joints)

    @property
    def verdict(self) -> list[str]:
        """What was found, in sentences."""
        return list(self._document["verdict"])

    @property
    def dropped(self) -> list[dict[str, Any]]:
        """Terms taken out by ``reduce=True``."""
        return list(self._document["dropped"] or [])

    @property
    def table(self) -> Table:
        """A row per parameter and joint."""
        columns = ("joint", "parameter", "unit", "value", "low", "high", "p", "told")
        rows = [
            (joint, p.name, p.unit, p.value, p.low, p.high, p.p, "yes" if p.identifiable else "no")
            for joint, parameters in [
                *((str(j.joint), j.parameters) for j in self.joints),
                ("arm", self.arm),
            ]
            for p in parameters
        ]
        return Table.of(columns, rows)

    @cached_property
    def twin(self) -> Twin:
        """The twin with the values found."""
        found = self._done.fitted()
        if found is None:
            raise InputError("nothing was fitted: name a method")
        return Twin(found)

    def predict(self, recording: Recording, *, signals: Signals | None = None) -> Prediction:
        """Torque of the twin with the values found, along another recording."""
        return predict(self.twin, recording, signals=signals)

    def __repr__(self) -> str:
        lines = "\n".join(f"  {line}" for line in self.verdict)
        return f"<Identification of {self._document['recording']['source']} by {self.method}>\n{lines}"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()

    def to_pandas(self) -> pd.DataFrame:
        """`table` with all digits."""
        return self.table.to_pandas()

    def to_dict(self) -> dict[str, Any]:
        """The document that ``armtwin identify --json`` writes."""
        document: dict[str, Any] = json.loads(self._done.json())
        return document

    def report(self, path: StrPath) -> None:
        """Write a report with pictures, one HTML file for any browser."""
        _engine.write_text(Path(path), self._done.html())

    def save(self, path: StrPath) -> None:
        """Write what the name ends in: .json (everything), .html (`report`), .toml (`twin`)."""
        ending = Path(path).suffix.lower()
        if ending == ".json":
            _engine.write_text(Path(path), json.dumps(self.to_dict(), indent=2) + "\n")
        elif ending == ".html":
            self.report(path)
        elif ending == ".toml":
            self.twin.save(path)
        else:
            raise InputError(f"{os.fspath(path)}: end the name in .json, .html or .toml")


def _restored(document: str, twin: bytes | None, page: bytes) -> Identification:
    return Identification(_Stored(document, twin, page))


def identify(
    twin: Twin,
    recording: Recording,
    *,
    check: Recording | None = None,
    terms: Sequence[str] = (),
    include: Sequence[str] = (),
    methods: Sequence[str] = ("pso", "nlse"),
    reduce: bool = False,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    seed: int = 1,
    direct_cost: bool = False,
    total_mass: float | None = None,
    loaded: Recording | None = None,
    payload: float | None = None,
    payload_centre: tuple[float, float, float] | None = None,
    signals: Signals | None = None,
    every_row: bool = False,
    force: bool = False,
    progress: Progress = None,
) -> Identification:
    """Fit what a twin leaves open to a recording; as ``armtwin identify``, with its defaults.

    Parameters
    ----------
    twin : Twin
    recording : Recording
        To fit.
    check : Recording, optional
        Another one, which the fit is held against.
    terms : sequence of str
        What to fit, effects by name ("paper" is the law of the paper's Eq. 1), in place of what the twin lists
        without values.
    include : sequence of str
        What to fit besides; "inertia" are the inertial parameters of all links. (``--with``)
    methods : sequence of {"pso", "nlse", "mcmc"}
    reduce : bool
        Drop terms whose existence the robust test does not show.
    bounds : mapping of str to (low, high), optional
        Search bounds of parameters, all joints.
    seed : int
        Of the swarm and of the Markov chains.
    direct_cost : bool
        Evaluate the swarm's cost at every sample: the same number, a thousand times slower.
    total_mass : float, optional
        With "inertia": mass of all moving links, kg.
    loaded : Recording, optional
        With a known load at the flange, `payload` in kg: tells the drives' torque constants.
    payload_centre : (x, y, z), optional
        Centre of that load in the flange's frame, m.
    signals : Signals, optional
    every_row : bool
        Keep all rows of recordings faster than 125 Hz or longer than 300 000 rows.
    force : bool
        Go on with a recording that contradicts its column names or the arm.
    progress : callable or bool, optional
        ``progress(doing, done, of)``, or True for a bar.

    Returns
    -------
    Identification

    Raises
    ------
    InputError
        Unknown names, arrays that do not fit, two recordings with the same samples, nothing that slides.
    DoubtfulRecording
        A recording that contradicts itself or the arm.
    """
    if (loaded is None) != (payload is None):
        raise InputError("loaded and payload go together: a recording, and the mass of the load in it, kg")
    options = {
        "terms": list(terms),
        "with": list(include),
        "methods": list(methods),
        "direct_cost": direct_cost,
        "reduce": reduce,
        "bounds": {name: [float(low), float(high)] for name, (low, high) in (bounds or {}).items()},
        "seed": seed,
        "total_mass": total_mass,
        "payload": payload,
        "payload_centre": payload_centre,
        "taken": taken(signals, every_row, force),
    }
    done = _engine.identify(
        twin._engine,
        recording._for(twin),
        None if check is None else check._for(twin),
        None if loaded is None else loaded._for(twin),
        json.dumps(options),
        Listener(progress),
    )
    return Identification(done)


def predict(twin: Twin, recording: Recording, *, signals: Signals | None = None) -> Prediction:
    """Torque of a twin along a recording."""
    raw = json.dumps(taken(signals, False, False)["signals"])
    t, torque, measured, slides = _engine.predict(twin._engine, recording._for(twin), raw)
    return Prediction(t, torque.T, measured.T, slides.T)
