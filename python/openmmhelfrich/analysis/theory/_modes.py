"""What formulae of modes have in common."""

import numpy as np


def check_modes(l):
    """Refuse l = 0 and 1, which change size and place and have no restoring force."""
    lowest = np.min(l)
    if not lowest >= 2:
        raise ValueError(f"l: need 2 or more, got {lowest}")


def plain(value):
    """A float for a scalar, the array for an array."""
    return float(value) if np.ndim(value) == 0 else value
