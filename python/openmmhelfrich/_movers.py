"""What the Monte Carlo movers share of their arguments; see ``_arguments.py``."""

from __future__ import annotations

import operator

import numpy as np

__all__ = ["constant", "whole_number"]


def whole_number(mover: str, name: str, value) -> int:
    """A whole number that fits a C int."""
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{mover}: {name} must be a whole number, got {value!r}")
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{mover}: {name} must be a whole number, got {value!r}") from None
    limits = np.iinfo(np.intc)
    if not limits.min <= number <= limits.max:
        raise ValueError(f"{mover}: {name} = {number} is beyond what OpenMM can count")
    return number


def constant(mover: type, name: str, known: tuple[str, ...], value) -> int:
    """The number of a constant of a class, given by its number or name."""
    if not isinstance(value, str):
        return whole_number(mover.__name__, name, value)
    if value not in known:
        raise ValueError(
            f"{mover.__name__}: there is no {name} {value!r}; known are: {', '.join(known)}"
        )
    return getattr(mover, value)
