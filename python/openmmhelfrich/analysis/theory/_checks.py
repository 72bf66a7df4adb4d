"""Checks of arguments that the theory shares."""

import numpy as np


def check_modes(l):
    """Refuse l = 0 and 1, which change size and place and have no restoring force."""
    lowest = np.min(l)
    if not lowest >= 2:
        raise ValueError(f"l: need 2 or more, got {lowest}")


def positive(name, value):
    """Positive numbers as an array of floats; ValueError for others and for NaN."""
    array = np.asarray(value, dtype=float)
    return _only(array, array > 0, f"{name}: need a positive number")


def not_negative(name, value):
    """Numbers of 0 or more as an array of floats; ValueError for others and for NaN."""
    array = np.asarray(value, dtype=float)
    return _only(array, array >= 0, f"{name}: need 0 or more")


def _only(array, good, need):
    if not good.all():
        raise ValueError(f"{need}, got {array[~good][0]:g}")
    return array


def plain(value):
    """A float for a scalar, the array for an array."""
    return float(value) if np.ndim(value) == 0 else value
