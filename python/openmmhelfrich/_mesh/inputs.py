"""Arguments of `Mesh` and its methods, turned into plain numbers and arrays or refused."""

from __future__ import annotations

import operator

import numpy as np

from .._numbers import FARTHEST, length_array
from .._types import Array
from ..errors import MeshError

__all__ = [
    "box_array",
    "integer",
    "not_negative",
    "numbers",
    "positive",
    "triangle_array",
    "vertex_array",
]

# A box leans over by half of its length and a rounding error.
_ROUNDED = 1 + 1e-6


def vertex_array(vertices) -> Array:
    """Vertices as a new float64 array of shape (num_vertices, 3), nm, not yet validated."""
    points = length_array(vertices, "Mesh", "vertices")
    if points.size == 0:
        return points.reshape(0, 3)
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshError(
            f"Mesh: vertices must have shape (num_vertices, 3), got {points.shape}; give one row "
            "of x, y, z per vertex"
        )
    return points


def triangle_array(triangles) -> Array:
    """Triangles as a new int64 array of shape (num_triangles, 3), not yet validated."""
    try:
        given = np.asarray(triangles)
    except ValueError:
        raise MeshError("Mesh: triangles must be rows of three vertex indices each") from None
    if given.size == 0:
        return np.empty((0, 3), dtype=np.int64)
    if given.dtype.kind not in "iu":
        raise MeshError(
            f"Mesh: triangles must be integers, got dtype {given.dtype}; give vertex indices, such "
            "as array.astype(int)"
        )
    if given.ndim != 2 or given.shape[1] != 3:
        raise MeshError(
            f"Mesh: triangles must have shape (num_triangles, 3), got {given.shape}; give one row "
            "of three vertex indices per triangle"
        )
    if given.dtype.kind == "u" and given.max() > np.iinfo(np.int64).max:
        raise MeshError(f"Mesh: triangles name vertex {given.max()}, which cannot exist")
    return np.array(given, dtype=np.int64, order="C")


def box_array(box, where: str) -> Array:
    """Box vectors as a read-only float64 array of shape (3, 3), nm, in OpenMM's reduced form."""
    rows = length_array(box, where, "box")
    if rows.shape == (3, 3) and (abs(rows) >= FARTHEST).any():
        raise MeshError(f"{where}: box must be below {FARTHEST:g} nm, got {rows.tolist()} nm")
    if rows.shape != (3, 3) or not np.isfinite(rows).all():
        raise MeshError(f"{where}: box must be three vectors a, b, c, shape (3, 3), got {box!r}")
    (ax, *ay), (bx, by, bz), (cx, cy, cz) = rows
    upright = not (any(ay) or bz) and min(ax, by, cz) > 0
    if not upright or 2 * max(abs(bx), abs(cx)) > ax * _ROUNDED or 2 * abs(cy) > by * _ROUNDED:
        raise MeshError(
            f"{where}: box must have the vectors (ax, 0, 0), (bx, by, 0), (cx, cy, cz) with ax, by "
            f"and cz above 0, |bx| and |cx| at most ax / 2 and |cy| at most by / 2, got "
            f"{rows.tolist()} nm; openmm.app.internal.unitcell.reducePeriodicBoxVectors makes it so"
        )
    rows.flags.writeable = False
    return rows.view()


def numbers(value, where: str, name: str) -> Array:
    """A plain float64 array of numbers without units."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise MeshError(f"{where}: {name} must be numbers without a unit, got {value!r}") from None


def integer(value, where: str, name: str, least: int) -> int:
    """A Python integer of at least `least`, from any integer type."""
    try:
        number = operator.index(value)
    except TypeError:
        raise MeshError(f"{where}: {name} must be an integer, got {value!r}") from None
    if number < least:
        raise MeshError(f"{where}: {name} must be {least} or more, got {number}")
    return number


def not_negative(value, where: str, name: str) -> float:
    """A finite number of 0 or more, without a unit."""
    number = numbers(value, where, name)
    if number.shape != () or not (np.isfinite(number) and number >= 0):
        raise MeshError(f"{where}: {name} must be one finite number, 0 or more, got {value!r}")
    return float(number)


def positive(value: float, where: str, name: str) -> None:
    """Refuse a finite length that is not above 0."""
    if not value > 0:
        raise MeshError(f"{where}: {name} must be above 0 nm, got {value}")
