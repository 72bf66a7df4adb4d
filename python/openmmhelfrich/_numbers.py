"""Checks of numbers that functions take, with or without units.

Errors name the function or class, the argument and the value. What builds and moves things accepts
a plain number in OpenMM's units (nm, ps, amu, kJ/mol) or an ``openmm.unit.Quantity``; formulae
(`positive`, `not_negative`), which hold in any units, accept plain numbers only. OpenMM itself
is imported only when a Quantity has to be converted, and then it is loaded already, because the
user's Quantity came from it. What force classes take is in ``_values``, and what a Mesh takes in
``_mesh/inputs``.
"""

from __future__ import annotations

import math
import numbers

import numpy as np

from ._types import Array
from .errors import MeshError

__all__ = [
    "FARTHEST",
    "checked_field",
    "checked_number",
    "finite_array",
    "length",
    "length_array",
    "not_negative",
    "positive",
    "positive_number",
    "values_in",
    "whole_number",
]


FARTHEST = 1e100
"""Lengths, nm, whose cubes may overflow, so that no mesh has them."""


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


def values_in(dimension, values, where: str, name: str) -> Array:
    """Numbers, or a Quantity of them, as an array of floats in a unit.

    Raises
    ------
    TypeError
        Something else than numbers, or a Quantity of another dimension.
    """
    if _is_quantity(values):
        if not values.unit.is_compatible(dimension):
            raise TypeError(f"{where}: {name} needs the unit {dimension}, got {values.unit}")
        values = values.value_in_unit(dimension)
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(
            f"{where}: {name} needs numbers, or a Quantity of them, got {values!r}"
        ) from None


def positive(name, value):
    """Positive plain numbers as an array of floats; ValueError for others and for NaN."""
    array = _plain(name, value)
    return _only(array, array > 0, f"{name}: need a positive number")


def not_negative(name, value):
    """Plain numbers of 0 or more as an array of floats; ValueError for others and for NaN."""
    array = _plain(name, value)
    return _only(array, array >= 0, f"{name}: need 0 or more")


def _plain(name, value):
    """Numbers without a unit as an array of floats; TypeError for what is none."""
    if _is_quantity(value):
        raise TypeError(
            f"{name}: need plain numbers, got the unit {value.unit}; divide by a unit of this "
            "dimension that the description names"
        )
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: need numbers, got {value!r}") from None


def _only(array, good, need):
    if not good.all():
        raise ValueError(f"{need}, got {array[~good][0]:g}")
    return array


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


def length_array(value, where: str, name: str) -> np.ndarray:
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


def checked_field(name, value, dimension, mesh, negative=False):
    """One number, or an array of one for each vertex of the mesh."""
    if isinstance(value, (list, tuple)) and any(_is_quantity(one) for one in value):
        value = [checked_number(name, one, dimension, negative=negative) for one in value]
    bare = value.value_in_unit(value.unit) if _is_quantity(value) else value
    try:
        single = np.ndim(bare) == 0
    except ValueError:
        raise TypeError(f"Vesicle: {name} needs numbers, got lists of unequal length") from None
    if single:
        return checked_number(name, value, dimension, negative=negative)
    if _is_quantity(value):
        # The message of a wrong dimension is that of a single number.
        checked_number(name, 1.0 * value.unit, dimension, negative=True)
        value = value.value_in_unit(dimension)
    values = np.array(value)
    if values.dtype.kind not in "iuf":
        raise TypeError(f"Vesicle: {name} needs numbers, got dtype {values.dtype}")
    if values.shape != (mesh.num_vertices,):
        raise ValueError(
            f"Vesicle: {name} must be one number or one for each of the {mesh.num_vertices} "
            f"vertices, got the shape {values.shape}"
        )
    for number in values.tolist():
        checked_number(name, number, dimension, negative=negative)
    values = values.astype(np.float64)
    values.setflags(write=False)
    return values


def checked_number(name, value, dimension, zero=True, negative=False, caller="Vesicle"):
    """A checked number in OpenMM's units, for the parameter `name`."""
    if _is_quantity(value) and not value.unit.is_compatible(dimension):
        raise TypeError(f"{caller}: {name} needs the unit {dimension}, got {value}")
    if isinstance(value, (bool, np.bool_, str)):
        raise TypeError(f"{caller}: {name} needs a number, got {value!r}")
    try:
        number = float(value.value_in_unit(dimension) if _is_quantity(value) else value)
    except (TypeError, ValueError):
        raise TypeError(f"{caller}: {name} needs a number, got {value!r}") from None
    if not math.isfinite(number):
        raise ValueError(f"{caller}: {name} needs a finite number, got {number}")
    if not negative and (number < 0 or (number == 0 and not zero)):
        need = "0 or more" if zero else "more than 0"
        raise ValueError(f"{caller}: {name} needs {need}, got {number}")
    return number
