"""Pressure and tension of membranes: what their energy does when everything is stretched."""

from __future__ import annotations

import ctypes
import operator
from collections.abc import Iterable
from typing import Any

import numpy as np

from ._present import context_of, surfaces_of
from ._types import Array

__all__ = ["virial"]


def _bits_of(groups: int | Iterable[int]) -> int:
    """Groups as bits of an integer, which may be negative."""
    try:
        if isinstance(groups, Iterable):
            groups = {operator.index(group) for group in groups}
            bits = sum(1 << group for group in groups) if groups <= set(range(32)) else None
        else:
            bits = operator.index(groups)
    except TypeError:
        bits = None
    if bits is None or not -(1 << 31) <= bits < 1 << 32:
        raise TypeError(
            "virial: groups needs force groups from 0 to 31, or their bits in an integer, got "
            f"{groups!r}"
        )
    return bits


def virial(context: Any, groups: int | Iterable[int] = -1) -> Array:
    """The derivative of the membranes' energy with respect to a homogeneous strain.

    With positions r → r + ε r, and the vectors of the periodic box likewise, it is W = ∂E/∂ε:
    exact, in triclinic boxes too, and symmetric. Where no surface spans the box it is −Σ F ⊗ r.
    A sheet in the xy plane that spans a box of sides a and b has the tension (W_xx + W_yy) / (2
    a b), and a tube along z pulls at the box with W_zz / c; to the pressure tensor W adds −W /
    V. Contacts are among it, with the particles that they act on; what motion adds, and other
    forces, are not.

    Parameters
    ----------
    context : openmm.Context or openmm.app.Simulation
        One with positions. All membrane forces in it count, of all surfaces.
    groups : int or iterable of int
        The force groups that count, as `Context.getState` takes them: bits of an integer, or the
        groups themselves. All of them by default.

    Returns
    -------
    ndarray of float
        Shape (3, 3), kJ/mol; zeros where there is no membrane force.

    Raises
    ------
    TypeError
        No Context, or other groups.
    openmm.OpenMMException
        Where an evaluation of the energy would raise it.

    Notes
    -----
    It costs as much as some evaluations of the energy on one thread, on the processor.
    """
    context = context_of("virial", context)
    # OpenMM's C++ has the 32 groups in an int, the last of which is its sign.
    bits = ctypes.c_int32(_bits_of(groups)).value
    surfaces = surfaces_of(context)
    if not surfaces:
        return np.zeros((3, 3))
    return np.frombuffer(surfaces[0]._getVirial(context, bits)).reshape(3, 3).copy()
