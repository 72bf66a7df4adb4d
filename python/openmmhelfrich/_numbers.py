"""Checks of numbers that functions take; errors name the function, the argument and the value."""

from __future__ import annotations

import numbers

import numpy as np

from ._types import Array

__all__ = ["finite_array", "positive_number", "whole_number"]


def whole_number(value, where: str, name: str, least: int, most: int | None = None) -> int:
    """A whole number of at least `least`, and at most `most`, as an int.

    Floats that are whole will do, for they come out of divisions and of NumPy's ranges.

    Parameters
    ----------
    value
        What the user gave.
    where, name : str
        The function or class, and its argument.
    least, most : int
        The range; without `most` it is open.

    Raises
    ------
    ValueError
        Another value: a fraction, NaN, infinity, a bool, or no number at all.
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    whole = isinstance(value, numbers.Real) and not isinstance(value, bool) and value % 1 == 0
    if not whole or value < least or (most is not None and value > most):
        wanted = f"of {least} or more" if most is None else f"from {least} to {most}"
        raise ValueError(f"{where}: {name} needs a whole number {wanted}, got {value!r}")
    return int(value)


def positive_number(value, where: str, name: str) -> float:
    """A finite number above 0.

    Raises
    ------
    ValueError
        Another value.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if not 0 < number < np.inf:
        raise ValueError(f"{where}: {name} needs a positive, finite number, got {value!r}")
    return number


def finite_array(values, where: str, name: str) -> Array:
    """Numbers as an array of floats, none of which is NaN or infinite.

    Raises
    ------
    ValueError
        A value is not finite; the message has its index.
    """
    array = np.asarray(values, dtype=float)
    finite = np.isfinite(array)
    if not finite.all():
        place = tuple(np.argwhere(~finite)[0].tolist())
        index = f"[{', '.join(map(str, place))}]" if place else ""
        raise ValueError(f"{where}: {name}{index} is {array[place]}; leave out what is not finite")
    return array
