"""What can go wrong, with the program's words."""

from __future__ import annotations

__all__ = ["DoubtfulRecording", "EngineFault", "Error", "InputError", "WorkError"]


class Error(Exception):
    """Anything that armtwin raises on purpose."""


class InputError(Error, ValueError):
    """A file, value, shape or name that cannot be used; the message says which, and what to do."""


class DoubtfulRecording(InputError):
    """A recording that contradicts its column names or the arm (a wrong unit, sign or order).

    ``force=True`` goes on with it as it is.
    """


class WorkError(Error, RuntimeError):
    """Work that was possible to begin and came to nothing, as a simulated arm that runs away."""


class EngineFault(Error, RuntimeError):
    """A fault of the engine itself: please report it."""


for _class in (Error, InputError, DoubtfulRecording, WorkError, EngineFault):
    _class.__module__ = "armtwin"
