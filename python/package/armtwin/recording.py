"""Recordings: named SI columns on one time column."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from . import _engine
from ._arrays import ArrayLike, Floats, matrix, vector
from ._errors import InputError
from ._table import Table
from .twin import Twin

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Recording", "read"]

StrPath: TypeAlias = str | os.PathLike[str]

#: Keyword of `Recording` -> the name in files.
SIGNALS = {
    "q": "actual_q",
    "qd": "actual_qd",
    "qdd": "actual_qdd",
    "current": "actual_current",
    "torque": "joint_torque",
    "target_q": "target_q",
    "target_qd": "target_qd",
    "target_qdd": "target_qdd",
    "temperature": "joint_temperatures",
}


class Recording:
    """What an arm did: positions, and motor currents or joint torques.

    Parameters
    ----------
    t : array_like, shape (T,)
        Time, s, rising.
    q : array_like, shape (T, n)
        Positions, rad, base to wrist.
    qd, qdd : array_like, shape (T, n), optional
        Velocities, rad/s, and accelerations, rad/s2.
    current : array_like, shape (T, n), optional
        Motor currents, A.
    torque : array_like, shape (T, n), optional
        Joint torques, N.m; counts where both are given.
    target_q, target_qd, target_qdd : array_like, shape (T, n), optional
        What was commanded.
    temperature : array_like, shape (T, n), optional
        Of the joints, deg C.
    names : sequence of str, optional
        Joint of each column by its name in the twin's URDF: then columns may come in any order.
    columns : mapping of str to array_like, optional
        Whatever else there is, (T,) each, by its name in files.
    source : str
        What messages call it.

    Notes
    -----
    Arrays of any real dtype and strides will do; numbers are copied once. Few rows with NaN are left out, and
    `notes` says so; many are an `InputError`.
    """

    def __init__(
        self,
        t: ArrayLike,
        q: ArrayLike,
        *,
        qd: ArrayLike | None = None,
        qdd: ArrayLike | None = None,
        current: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        target_q: ArrayLike | None = None,
        target_qd: ArrayLike | None = None,
        target_qdd: ArrayLike | None = None,
        temperature: ArrayLike | None = None,
        names: Sequence[str] | None = None,
        columns: Mapping[str, ArrayLike] | None = None,
        source: str = "recording",
    ) -> None:
        given = {
            "q": q,
            "qd": qd,
            "qdd": qdd,
            "current": current,
            "torque": torque,
            "target_q": target_q,
            "target_qd": target_qd,
            "target_qdd": target_qdd,
            "temperature": temperature,
        }
        time = vector("t", t)
        signals = [(key, matrix(key, value)) for key, value in given.items() if value is not None]
        for key, array in signals:
            if array.shape != (len(time), signals[0][1].shape[1]):
                raise InputError(
                    f"{source}: {key} has the shape {array.shape}, t has {len(time)} samples and q has "
                    f"{signals[0][1].shape[1]} joints: give ({len(time)}, {signals[0][1].shape[1]})"
                )
        if names is not None and len(names) != signals[0][1].shape[1]:
            raise InputError(f"{source}: {len(names)} names for {signals[0][1].shape[1]} joints")
        self._names = None if names is None else list(names)
        self._engine = _engine.Recording.from_arrays(
            time,
            [(SIGNALS[key], array) for key, array in signals],
            [(name, vector(name, values)) for name, values in (columns or {}).items()],
            source,
        )

    @classmethod
    def _of(cls, engine: _engine.Recording, names: Sequence[str] | None = None) -> Recording:
        recording = cls.__new__(cls)
        recording._engine = engine
        recording._names = None if names is None else list(names)
        return recording

    @classmethod
    def from_pandas(
        cls,
        frame: pd.DataFrame,
        *,
        time: str | None = None,
        names: Sequence[str] | None = None,
        source: str = "data frame",
        **signals: Sequence[str],
    ) -> Recording:
        """From a data frame; every signal is named by its columns, base to wrist.

        Parameters
        ----------
        frame : DataFrame
        time : str, optional
            Column of time, s; the index (seconds, or dates) where it is left out.
        names : sequence of str, optional
            As of `Recording`.
        **signals : sequence of str
            ``q=["j1", "j2", ...]``, ``current=[...]``, ...: keywords of `Recording`.
        """
        unknown = [key for key in signals if key not in SIGNALS]
        if unknown or "q" not in signals:
            raise InputError(
                f"signals: {', '.join(unknown) or 'q is missing'}; choose from {', '.join(SIGNALS)}, q among them"
            )
        missing = [c for columns in signals.values() for c in columns if c not in frame.columns]
        if missing:
            raise InputError(f"{source}: no column {missing[0]}; there are {', '.join(map(str, frame.columns))}")
        import pandas as pd

        index = frame.index if time is None else pd.Index(frame[time])
        if isinstance(index, pd.DatetimeIndex):
            index = (index - index[0]).total_seconds()
        arrays: dict[str, Any] = {key: frame[list(columns)].to_numpy() for key, columns in signals.items()}
        return cls(index.to_numpy(), names=names, source=source, **arrays)

    def __repr__(self) -> str:
        return (
            f"<Recording {self.source}: {self.joints} joints, {len(self)} samples, "
            f"{self.seconds:.3f} s at {self.rate_hz:.4g} Hz>"
        )

    def _repr_html_(self) -> str:
        return Table.of(
            ("recording", "joints", "samples", "s", "Hz", "signals"),
            [(self.source, self.joints, len(self), self.seconds, self.rate_hz, ", ".join(self.signals))],
        )._repr_html_()

    def __len__(self) -> int:
        return len(self._engine)

    def __getitem__(self, name: str) -> Floats:
        """A signal, (T, n), by keyword (``"current"``) or name in files (``"actual_current"``), or one column."""
        stem = SIGNALS.get(name, name)
        found = self._engine.joints(stem)
        if found is not None:
            signal: Floats = found.T
            return signal
        column = self._engine.column(name)
        if column is None:
            raise KeyError(f"{name}: there are {', '.join(self.signals)}")
        return column

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (SIGNALS.get(name, name) in self.signals or name in self._engine.columns())

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        columns = {name: self._engine.column(name) for name in self._engine.columns()}
        return _restored, (self.t, columns, self._names, self.source)

    @property
    def t(self) -> Floats:
        """(T,): s."""
        return self._engine.time()

    @property
    def q(self) -> Floats:
        """(T, n): rad."""
        return self["q"]

    @property
    def seconds(self) -> float:
        """From the first to the last sample, s."""
        t = self.t
        return float(t[-1] - t[0])

    @property
    def rate_hz(self) -> float:
        """Mean sample rate, Hz."""
        return (len(self) - 1) / self.seconds

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self._engine.joint_count()

    @property
    def names(self) -> list[str] | None:
        """Names of the joints, where they were given."""
        return None if self._names is None else list(self._names)

    @property
    def signals(self) -> list[str]:
        """Names of the signals, as files have them."""
        return self._engine.stems()

    @property
    def source(self) -> str:
        """Where it came from."""
        return self._engine.source

    @property
    def notes(self) -> list[str]:
        """What was dropped or mended while it was read."""
        return self._engine.notes

    def between(self, start: float | None = None, end: float | None = None) -> Recording:
        """The stretch between two times, s from the first sample."""
        return Recording._of(self._engine.between(start, end), self._names)

    def to_pandas(self) -> pd.DataFrame:
        """Columns by their names in files, time as the index."""
        import pandas as pd

        columns = {name: self._engine.column(name) for name in self._engine.columns()}
        frame: pd.DataFrame = pd.DataFrame(columns, index=pd.Index(self.t, name="timestamp"))
        return frame

    def to_dict(self) -> dict[str, Any]:
        """Where it came from, and every column as a list."""
        data = {name: self[name].tolist() for name in self._engine.columns()}
        return {"source": self.source, "notes": self.notes, "timestamp": self.t.tolist(), **data}

    def save(self, path: StrPath) -> None:
        """Write it in the format that the name ends in: .csv, .csv.gz, .parquet, .mcap, .db3."""
        self._engine.write(Path(path))

    def _for(self, twin: Twin) -> _engine.Recording:
        """With columns in the order of the twin's joints."""
        if self._names is None or self._names == twin.joints:
            return self._engine
        if sorted(self._names) != sorted(twin.joints):
            raise InputError(
                f"{self.source}: its joints are {', '.join(self._names)}, those of {twin.source} are "
                f"{', '.join(twin.joints)}: give the names of the twin's, or none where columns are in their order"
            )
        return self._engine.reordered([self._names.index(name) for name in twin.joints])


def _restored(t: Floats, columns: dict[str, Floats], names: list[str] | None, source: str) -> Recording:
    return Recording._of(_engine.Recording.from_arrays(t, [], list(columns.items()), source), names)


def read(path: StrPath, *, columns: StrPath | None = None) -> Recording:
    """Read a recording in any format that the program reads: RTDE and other CSV, Parquet, ROS 2 bags, folders.

    Parameters
    ----------
    path : path-like
    columns : path-like, optional
        A column map (TOML) where columns have no RTDE names.
    """
    return Recording._of(_engine.Recording.read(Path(path), None if columns is None else Path(columns)))
