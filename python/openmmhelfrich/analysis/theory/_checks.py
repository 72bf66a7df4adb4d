"""Checks of arguments that the theory shares."""

import numpy as np


def check_modes(l):
    """Refuse l = 0 and 1, which change size and place and have no restoring force."""
    lowest = np.min(l)
    if not lowest >= 2:
        raise ValueError(f"l: need 2 or more, got {lowest}")


def check_positive(name, value):
    """Refuse what is not a positive number, or an array of them."""
    if not np.all(np.asarray(value) > 0):
        raise ValueError(f"{name}: need a positive number, got {value}")


def check_not_negative(name, value):
    """Refuse negative numbers and NaN."""
    if not np.all(np.asarray(value) >= 0):
        raise ValueError(f"{name}: need 0 or more, got {value}")


def plain(value):
    """A float for a scalar, the array for an array."""
    return float(value) if np.ndim(value) == 0 else value
