"""What results of jobs have in common: the document, its table, and files made of them."""

from __future__ import annotations

import json
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from . import _engine
from ._errors import InputError
from ._table import Table

if TYPE_CHECKING:
    import pandas as pd

StrPath: TypeAlias = str | os.PathLike[str]


class Done(Protocol):
    """The engine's result, or what a pickle kept of it."""

    def json(self) -> str: ...
    def html(self) -> str: ...


class Result(ABC):
    """A job's result."""

    _done: Done

    @cached_property
    def _document(self) -> dict[str, Any]:
        return self.to_dict()

    def to_dict(self) -> dict[str, Any]:
        """The document that the program's ``--json`` writes."""
        document: dict[str, Any] = json.loads(self._done.json())
        return document

    @property
    @abstractmethod
    def table(self) -> Table:
        """The values found."""

    def to_pandas(self) -> pd.DataFrame:
        """`table` with all digits."""
        return self.table.to_pandas()

    def report(self, path: StrPath) -> None:
        """Write a report with pictures, one HTML file for any browser."""
        _engine.write_text(Path(path), self._done.html())

    def _save(self, path: StrPath, others: Mapping[str, Callable[[StrPath], None]]) -> None:
        """Writes what the name ends in: the document, the report, or one of `others`."""

        def document(path: StrPath) -> None:
            _engine.write_text(Path(path), json.dumps(self.to_dict(), indent=2) + "\n")

        writers = {".json": document, ".html": self.report, **others}
        write = writers.get(Path(path).suffix.lower())
        if write is None:
            *first, last = writers
            raise InputError(f"{os.fspath(path)}: end the name in {', '.join(first)} or {last}")
        write(path)
