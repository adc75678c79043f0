"""Arrays as the engine takes them: float64, two axes."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ._errors import InputError

Floats: TypeAlias = npt.NDArray[np.float64]
Bools: TypeAlias = npt.NDArray[np.bool_]
ArrayLike: TypeAlias = npt.ArrayLike


def _numbers(name: str, given: ArrayLike) -> npt.NDArray[Any]:
    array = np.asarray(given)
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} has the dtype {array.dtype}: real numbers are needed")
    return array


def matrix(name: str, given: ArrayLike) -> Floats:
    """(T, n); without a copy where it is float64 already, whatever its strides."""
    array = _numbers(name, given)
    if array.ndim != 2:
        raise InputError(
            f"{name} has the shape {array.shape}: (T, n) is needed, one row per sample and one column per joint"
        )
    return array.astype(np.float64, copy=False)


def vector(name: str, given: ArrayLike) -> Floats:
    """(T,)"""
    array = _numbers(name, given)
    if array.ndim != 1:
        raise InputError(f"{name} has the shape {array.shape}: (T,) is needed")
    return array.astype(np.float64, copy=False)


def motion(**given: ArrayLike) -> tuple[bool, list[Floats]]:
    """One instant (n,) or many (T, n) of several quantities; whether it is one, and all as (T, n)."""
    arrays = {name: _numbers(name, value) for name, value in given.items()}
    single = all(array.ndim == 1 for array in arrays.values())
    shaped = (array[None, :] if single else array for array in arrays.values())
    return single, [matrix(name, array) for name, array in zip(arrays, shaped)]


def unwrapped(single: bool, found: Floats) -> Floats:
    """The only one of many, where one was asked for."""
    if not single:
        return found
    one: Floats = found[0]
    return one
