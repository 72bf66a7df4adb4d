"""The numbers that a vesicle is made with, with or without units; errors name them."""

from __future__ import annotations

import math

import numpy as np
from openmm import unit

from .errors import MeshError

__all__ = ["checked_field", "checked_number", "encloses"]


def encloses(mesh, needed):
    """Whether a mesh encloses a volume; a MeshError says why not, if it is needed."""
    try:
        return mesh.volume is not None
    except MeshError as reason:
        if not needed:
            return False
        said = str(reason).removeprefix("Mesh.volume")
        raise MeshError(f"Vesicle: mesh{said}; volume_modulus=0 leaves the volume out") from None


def checked_field(name, value, dimension, mesh, negative=False):
    """One number, or an array of one for each vertex of the mesh."""
    bare = value.value_in_unit(value.unit) if unit.is_quantity(value) else value
    try:
        single = np.ndim(bare) == 0
    except ValueError:
        raise TypeError(f"Vesicle: {name} needs numbers, got lists of unequal length") from None
    if single:
        return checked_number(name, value, dimension, negative=negative)
    if unit.is_quantity(value):
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


def _plain(value, dimension):
    return value.value_in_unit(dimension) if unit.is_quantity(value) else float(value)


def checked_number(name, value, dimension, zero=True, negative=False, caller="Vesicle"):
    """A checked number in OpenMM's units, for the parameter `name`."""
    if unit.is_quantity(value) and not value.unit.is_compatible(dimension):
        raise TypeError(f"{caller}: {name} needs the unit {dimension}, got {value}")
    if isinstance(value, (bool, np.bool_, str)):
        raise TypeError(f"{caller}: {name} needs a number, got {value!r}")
    try:
        number = _plain(value, dimension)
    except (TypeError, ValueError):
        raise TypeError(f"{caller}: {name} needs a number, got {value!r}") from None
    if not math.isfinite(number):
        raise ValueError(f"{caller}: {name} needs a finite number, got {number}")
    if not negative and (number < 0 or (number == 0 and not zero)):
        need = "0 or more" if zero else "more than 0"
        raise ValueError(f"{caller}: {name} needs {need}, got {number}")
    return number
