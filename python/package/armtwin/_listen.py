"""Who follows long work: a callback, a bar, or nobody."""

from __future__ import annotations

import logging
import sys
import warnings
from collections.abc import Callable
from typing import TypeAlias

_log = logging.getLogger("armtwin")

Progress: TypeAlias = Callable[[str, int, int], object] | bool | None
"""``progress(doing, done, of)``, ``of`` being 0 where nobody knows; True draws a bar."""


class Listener:
    """What the engine calls from the calling thread while it works."""

    def __init__(self, progress: Progress) -> None:
        self._tell: Callable[[str, int, int], object] | None
        if callable(progress):
            self._tell = progress
        else:
            self._tell = _bar if progress else None

    def progress(self, doing: str, done: int, of: int) -> None:
        if self._tell is not None:
            self._tell(doing, done, of)

    def note(self, text: str) -> None:
        _log.info(text)

    def warn(self, text: str) -> None:
        warnings.warn(text, stacklevel=4)


def _bar(doing: str, done: int, of: int) -> None:
    """One line that is written over; for terminals and notebooks."""
    width = 30
    filled = width * done // of if of else 0
    bar = "█" * filled + "·" * (width - filled) if of else "…"
    end = "\n" if of and done >= of else ""
    print(f"\r{doing:42.42} {bar}", end=end, file=sys.stderr, flush=True)
