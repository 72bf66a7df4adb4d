"""Triangular lattices on planes, tubes, disks and tori, and on a triply periodic minimal surface.

Functions return vertices, triangles and, of what can be periodic, the box or None; `Mesh` documents
their arguments, and validates what they return.
"""

from __future__ import annotations

import numpy as np

from .._types import Array
from ..errors import MeshError
from .inputs import integer, positive

__all__ = ["disk", "schwarz_p", "sheet", "torus", "tube"]

# Newton's method on a level surface converges quadratically, from any point of the patch.
_NEWTON_STEPS = 12


def sheet(nx, ny, spacing: float, periodic: bool):
    """Rows along x of equilateral triangles in the plane z = 0, odd rows shifted by half."""
    where = "Mesh.sheet"
    least = 3 if periodic else 2
    nx, ny = integer(nx, where, "nx", least), integer(ny, where, "ny", least)
    positive(spacing, where, "spacing")
    row, column = _rows(nx, ny)
    x = spacing * (column + 0.5 * (row % 2))
    y = spacing * np.sqrt(0.75) * row
    vertices = np.stack([x, y, np.zeros(nx * ny)], axis=1)
    box = None
    if periodic:
        width, depth = nx * spacing, ny * spacing * np.sqrt(0.75)
        # After an odd number of rows the lattice is shifted, and so is the box.
        lean = 0.5 * spacing * (ny % 2)
        box = np.array([[width, 0, 0], [lean, depth, 0], [0, 0, max(width, depth)]])
    return vertices, _strips(nx, ny, periodic, periodic), box


def tube(n_around, n_along, radius: float, length: float, periodic: bool):
    """Rings about the z axis, from z = 0, odd ones turned by half a step."""
    where = "Mesh.tube"
    n_around = integer(n_around, where, "n_around", 3)
    n_along = integer(n_along, where, "n_along", 3 if periodic else 2)
    if periodic and n_along % 2:
        raise MeshError(
            f"{where}: n_along must be even for a periodic tube, because every second ring is "
            f"turned by half a step, got {n_along}"
        )
    positive(radius, where, "radius")
    positive(length, where, "length")
    row, column = _rows(n_around, n_along)
    angle = 2 * np.pi / n_around * (column + 0.5 * (row % 2))
    z = length * row / (n_along if periodic else n_along - 1)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
    box = np.diag([4 * radius, 4 * radius, length]) if periodic else None
    return vertices, _strips(n_around, n_along, True, periodic), box


def torus(n, R: float, r: float):
    """Rings of n vertices round the tube, an even number of them about the z axis."""
    where = "Mesh.torus"
    n = integer(n, where, "n", 3)
    positive(r, where, "r")
    if r >= R:
        raise MeshError(f"{where}: R must be larger than r, {r} nm, got {R}")
    rings = 2 * max(2, round(n * R / (np.sqrt(3) * r)))
    row, column = _rows(n, rings)
    around = -2 * np.pi / n * (column + 0.5 * (row % 2))
    about = 2 * np.pi / rings * row
    distance = R + r * np.cos(around)
    vertices = np.stack(
        [distance * np.cos(about), distance * np.sin(about), r * np.sin(around)], axis=1
    )
    return vertices, _strips(n, rings, True, True)


def disk(n, radius: float):
    """Rings about the origin in the plane z = 0, the k-th of n of 6 k vertices at radius k / n."""
    where = "Mesh.disk"
    n = integer(n, where, "n", 1)
    positive(radius, where, "radius")
    ring, sextant, step, triangles = _hexagon(n)
    angle = np.pi / 3 * (sextant + step / np.maximum(ring, 1))
    distance = radius * ring / n
    flat = [distance * np.cos(angle), distance * np.sin(angle), np.zeros(len(ring))]
    return np.stack(flat, axis=1), triangles


def schwarz_p(n, size: float):
    """Eight hexagonal patches on cos x + cos y + cos z = 0, which mirrors turn into one another."""
    where = "Mesh.schwarz_p"
    n = integer(n, where, "n", 1)
    positive(size, where, "size")
    ring, sextant, step, patch = _hexagon(n)
    # In the octant 0 … 2 n of the cube, the plane x + y + z = 3 n meets the cube in a hexagon.
    corners = np.array([(0, 1, 2), (0, 2, 1), (1, 2, 0), (2, 1, 0), (2, 0, 1), (1, 0, 2)]) - 1
    here, there = corners[sextant], corners[(sextant + 1) % 6]
    whole = n + (ring - step)[:, np.newaxis] * here + step[:, np.newaxis] * there
    x = np.pi * whole / (2 * n)
    for _ in range(_NEWTON_STEPS):
        # On a face of the octant the gradient lies in it, so that patches meet there.
        slope = -np.sin(x)
        x = x - (np.cos(x).sum(axis=1) / (slope**2).sum(axis=1))[:, np.newaxis] * slope
    x *= size / (2 * np.pi)
    numbers, vertices, triangles = {}, [], []
    for signs in np.ndindex(2, 2, 2):
        mirror = 1 - 2 * np.array(signs)
        # Whole numbers tell which vertices of patches are the same, without comparing coordinates.
        names = list(map(tuple, (whole * mirror % (4 * n)).tolist()))
        for name, place in zip(names, x * mirror, strict=True):
            if numbers.setdefault(name, len(vertices)) == len(vertices):
                vertices.append(place)
        faces = np.array([numbers[name] for name in names])[patch]
        triangles.append(faces if mirror.prod() > 0 else faces[:, ::-1])
    return np.array(vertices), np.concatenate(triangles), size * np.eye(3)


def _rows(nx: int, ny: int) -> tuple[Array, Array]:
    """Row and column of each vertex, row by row."""
    return np.divmod(np.arange(nx * ny), nx)


def _strips(nx: int, ny: int, close_x: bool, close_y: bool) -> Array:
    """Triangles between rows that are shifted to and fro, counter-clockwise seen from z."""
    row, column = _rows(nx if close_x else nx - 1, ny if close_y else ny - 1)

    def vertex(i, j):
        return (row + j) % ny * nx + (column + i) % nx

    a, b, c, d = vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1)
    # Above an even row the next one is shifted to the right: the short diagonal leads to the left.
    even = (row % 2 == 0)[:, np.newaxis]
    lower = np.where(even, np.stack([a, b, d], axis=1), np.stack([a, b, c], axis=1))
    upper = np.where(even, np.stack([b, c, d], axis=1), np.stack([a, c, d], axis=1))
    return np.stack([lower, upper], axis=1).reshape(-1, 3)


def _hexagon(n: int):
    """A hexagon of n rings about a vertex.

    Returns
    -------
    ring, sextant, step : ndarray of int
        Where each of the 3 n (n + 1) + 1 vertices is: `step` steps after corner `sextant` of its
        ring, each side of which has as many steps as the ring's number.
    triangles : ndarray of int
        Shape (6 n², 3), counter-clockwise.
    """
    ring, sextant, step, triangles = [[0]], [[0]], [[0]], []

    def vertex(ring, sextant, step):
        start = 1 + 3 * ring * (ring - 1)
        return start + (sextant * ring + step) % (6 * ring) if ring else 0 * step

    for k in range(1, n + 1):
        place = np.arange(6 * k)
        ring.append(np.full(6 * k, k))
        sextant.append(place // k)
        step.append(place % k)
        t = np.arange(k)
        for s in range(6):
            outer, after = vertex(k, s, t), vertex(k, s, t + 1)
            inner = vertex(k - 1, s, t)
            triangles.append(np.stack([inner, outer, after], axis=1))
            triangles.append(np.stack([inner[:-1], after[:-1], inner[1:]], axis=1))
    return *map(np.concatenate, (ring, sextant, step)), np.concatenate(triangles)
