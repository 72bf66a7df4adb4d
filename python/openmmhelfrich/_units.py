"""Plain numbers from numbers or OpenMM Quantities.

Everything in this package accepts a plain number in OpenMM's units (nm, ps, amu, kJ/mol) or an
``openmm.unit.Quantity``. OpenMM itself is imported only when a Quantity has to be converted, and
then it is loaded already, because the user's Quantity came from it.
"""

from __future__ import annotations

import numpy as np

from ._types import Array
from .errors import MeshError

__all__ = ["length", "length_array"]


def _is_quantity(value) -> bool:
    return hasattr(value, "value_in_unit") and hasattr(value, "unit")


def _strip_length(value, where: str, name: str):
    """`value` in nm if it is a Quantity, unchanged if it is not."""
    if not _is_quantity(value):
        return value
    from openmm import unit

    try:
        return value.value_in_unit(unit.nanometer)
    except TypeError:
        raise MeshError(
            f"{where}: {name} must be a length, got a Quantity in {value.unit}; "
            "give plain numbers in nm or a Quantity of length"
        ) from None


def length(value, where: str, name: str) -> float:
    """A finite length in nm.

    Parameters
    ----------
    value : float or Quantity
        A length, in nm if it carries no unit.
    where, name : str
        The function and its argument, for the message of an error.

    Returns
    -------
    float
        The length in nm.

    Raises
    ------
    MeshError
        If the value is not one finite number, or a Quantity of another dimension.
    """
    plain = _strip_length(value, where, name)
    try:
        number = float(plain)
    except (TypeError, ValueError):
        raise MeshError(f"{where}: {name} must be one number in nm, got {plain!r}") from None
    if not np.isfinite(number):
        raise MeshError(f"{where}: {name} must be finite, got {number}")
    return number


def length_array(value, where: str, name: str) -> Array:
    """A new float64 array of lengths in nm, of whatever shape `value` has.

    Parameters
    ----------
    value : array_like or Quantity
        Lengths in nm, a Quantity of an array, or a sequence of Quantities.
    where, name : str
        The function and its argument, for the message of an error.

    Returns
    -------
    ndarray
        A contiguous copy, float64, nm. Its entries may be NaN or infinite.

    Raises
    ------
    MeshError
        If the values are ragged or not real numbers, or Quantities of another dimension.
    """
    plain = _strip_length(value, where, name)
    if isinstance(plain, (list, tuple)) and any(_is_quantity(row) for row in plain):
        plain = [_strip_length(row, where, name) for row in plain]
    try:
        array = np.array(plain)
    except ValueError:
        raise MeshError(f"{where}: {name} must be a rectangular array of numbers") from None
    if array.size and array.dtype.kind not in "iuf":
        raise MeshError(f"{where}: {name} must be real numbers, got dtype {array.dtype}")
    return np.array(array, dtype=np.float64, order="C")
