"""Triangulated spheres: regular icospheres and irregular, nearly even random ones."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from .._types import Array
from ..errors import MeshError
from .inputs import integer, positive

__all__ = ["icosphere", "random_sphere"]

# Lloyd's step is overshot by this factor. Below 2 the iteration is stable, and near 2 it smooths
# density differences over long distances several times as fast as the plain step.
_OVERSHOOT = 1.8
# After so many steps the triangle areas scatter by 5 to 6 %, as those of the paper's meshes do.
_STEPS = 100
# Beyond these the relaxation goes on only while a degree is out of range; then it starts afresh.
_MOST_STEPS = 1000
_ATTEMPTS = 20


def icosphere(n, radius: float) -> tuple[Array, Array]:
    """Class-I subdivision of the icosahedron, projected on a sphere about the origin.

    Every face is cut into n² triangles by n equal parts of its sides. The 12 corners of the
    icosahedron keep degree 5, all other vertices have degree 6.

    Parameters
    ----------
    n : int
        Parts per side, 1 or more; 1 is the icosahedron itself.
    radius : float
        Radius, nm, above 0.

    Returns
    -------
    vertices : ndarray
        Shape (10 n² + 2, 3), nm.
    triangles : ndarray
        Shape (20 n², 3).

    Raises
    ------
    MeshError
        If n is not an integer of 1 or more, or the radius is not positive.
    """
    where = "Mesh.icosphere"
    n = integer(n, where, "n", 1)
    positive(radius, where, "radius")
    golden = (1 + np.sqrt(5)) / 2
    corners = np.array([(0.0, s, t * golden) for s in (1, -1) for t in (1, -1)])
    corners = np.concatenate([np.roll(corners, shift, axis=1) for shift in range(3)])
    faces = _outward(corners, ConvexHull(corners).simplices)
    sides = {(int(a), int(b)): number for number, (a, b) in enumerate(_sides(faces))}
    shares = _shares(n)
    stencil = _subdivision(n)
    num_points = 10 * n * n + 2
    points = np.empty((num_points, 3))
    triangles = np.empty((len(faces), n * n, 3), dtype=np.int64)
    for number, face in enumerate(faces):
        names = _names(face, number, sides, shares)
        triangles[number] = names[stencil]
        # In ascending order of corners, so that two faces find the same bits for a shared point.
        order = np.argsort(face)
        points[names] = sum(
            shares[:, corner, np.newaxis] * corners[face[corner]] for corner in order
        )
    # Vertices are numbered as the triangles first name them, which keeps neighbours close.
    flat = triangles.ravel()
    first = np.empty(num_points, dtype=np.int64)
    first[flat[::-1]] = np.arange(len(flat))[::-1]
    order = np.argsort(first)
    rank = np.empty(num_points, dtype=np.int64)
    rank[order] = np.arange(num_points)
    return radius * _project(points[order]), rank[flat].reshape(-1, 3)


def _sides(faces: Array) -> Array:
    """The sides of the icosahedron, lower corner first, shape (30, 2)."""
    return np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2), axis=0)


def _shares(n: int) -> Array:
    """What each corner of a face contributes to each of its points, in parts of n.

    Shape ((n + 1)(n + 2) / 2, 3): every i, j, k ≥ 0 with i + j + k = n, ascending by i, then j.
    """
    i, j = np.nonzero(np.arange(n + 1)[:, np.newaxis] + np.arange(n + 1) <= n)
    return np.stack([i, j, n - i - j], axis=1)


def _subdivision(n: int) -> Array:
    """The triangles of a subdivided face as indices into `_shares`, shape (n², 3)."""
    i, j, k = _shares(n - 1).T

    def place(i, j):
        # Before row i come the rows 0 … i − 1, of n + 1, n, … points.
        return i * (n + 1) - i * (i - 1) // 2 + j

    upright = np.stack([place(i + 1, j), place(i, j + 1), place(i, j)], axis=1)
    # The triangle across the side of the first one, turned by half a turn.
    turned = np.stack([place(i, j + 1), place(i + 1, j), place(i + 1, j + 1)], axis=1)
    exists = np.stack([np.ones(len(k), dtype=bool), k > 0], axis=1)
    return np.stack([upright, turned], axis=1)[exists]


def _names(face: Array, number: int, sides: dict[str, Any], shares: Array) -> Array:
    """A number for every point of a face, under which neighbouring faces know it too.

    First come the 12 corners of the icosahedron, then the inner points of its 30 sides, then those
    of its 20 faces. So points are shared without a comparison of coordinates.
    """
    n = int(shares[0].sum())
    names = np.empty(len(shares), dtype=np.int64)
    inner = (shares > 0).all(axis=1)
    count = int(inner.sum())
    names[inner] = 12 + 30 * (n - 1) + number * count + np.arange(count)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        low, high = (a, b) if face[a] < face[b] else (b, a)
        on_side = (shares[:, low] > 0) & (shares[:, high] > 0) & ~inner
        start = 12 + (n - 1) * sides[int(face[low]), int(face[high])]
        names[on_side] = start + shares[on_side, low] - 1
    for corner in range(3):
        names[shares[:, corner] == n] = face[corner]
    return names


def random_sphere(num_vertices, radius: float, seed) -> tuple[Array, Array]:
    """An irregular, nearly even triangulation of a sphere about the origin.

    Vertices of the Fibonacci lattice are displaced at random by about a third of their spacing and
    relaxed with Lloyd's algorithm (each vertex moves toward the centroid of its spherical Voronoi
    cell, doi:10.1109/TIT.1982.1056489), at least a hundred steps and until every degree is 5, 6 or
    7. Triangles are those of the convex hull, which on a sphere is the Delaunay triangulation.
    By Euler's formula, vertices of degree 5 then outnumber those of degree 7 by 12. Areas scatter
    by 5 to 6 % and edge lengths by 7 to 8 %. Consecutive vertices are neighbours on a spiral round
    the z axis, which keeps memory access local.

    Parameters
    ----------
    num_vertices : int
        12, or 14 and more. Some 0.5 s for 1002 vertices, 8 s for 10 002.
    radius : float
        Radius, nm, above 0.
    seed : int
        Equal seeds give equal meshes, 0 or more.

    Returns
    -------
    vertices : ndarray
        Shape (num_vertices, 3), nm, each at the distance `radius` from the origin.
    triangles : ndarray
        Shape (2 num_vertices − 4, 3).

    Raises
    ------
    MeshError
        If no triangulation of the sphere has so many vertices, all of degree 5 to 7, or an argument
        is out of range.
    """
    where = "Mesh.random_sphere"
    num_vertices = integer(num_vertices, where, "num_vertices", 12)
    if num_vertices == 13:
        raise MeshError(
            f"{where}: no triangulation of the sphere has 13 vertices, all of degree 5 to 7; "
            "take 12, or 14 and more"
        )
    positive(radius, where, "radius")
    random = np.random.default_rng(integer(seed, where, "seed", 0))
    for _ in range(_ATTEMPTS):
        points = _jittered_lattice(num_vertices, random)
        for step in range(_MOST_STEPS):
            triangles = _outward(points, ConvexHull(points).simplices)
            degrees = np.bincount(triangles.ravel(), minlength=num_vertices)
            if step >= _STEPS and degrees.min() >= 5 and degrees.max() <= 7:
                return radius * points, triangles
            points = _lloyd_step(points, triangles)
    raise MeshError(
        f"{where}: found no mesh of {num_vertices} vertices with degrees 5 to 7 in {_ATTEMPTS} "
        "attempts; take another seed"
    )


def _jittered_lattice(count: int, random: np.random.Generator) -> Array:
    """Unit vectors, even over long distances and irregular over short ones.

    Independent random points would need many more steps of relaxation, since their density varies
    over long distances, and Lloyd's algorithm evens it out by diffusion.
    """
    rank = np.arange(count) + 0.5
    z = 1 - 2 * rank / count
    azimuth = np.pi * (3 - np.sqrt(5)) * rank
    rho = np.sqrt(1 - z**2)
    lattice = np.stack([rho * np.cos(azimuth), rho * np.sin(azimuth), z], axis=1)
    spacing = np.sqrt(4 * np.pi / count)
    return _project(lattice + 0.35 * spacing * random.normal(size=lattice.shape))


def _lloyd_step(points: Array, triangles: Array) -> Array:
    """Unit vectors moved beyond the centroids of their Voronoi cells on the sphere.

    The cell of a vertex P is cut into thin triangles (P, middle of an edge, circumcentre), whose
    areas are taken as plane ones and count with their sign, since the circumcentre of an obtuse
    triangle lies outside of it.
    """
    corners = [points[triangles[:, corner]] for corner in range(3)]
    centre = _project(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
    moments = np.zeros_like(points)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        middle = _project(corners[start] + corners[end])
        for corner, sign in ((start, 1), (end, -1)):
            point = corners[corner]
            area = sign * np.einsum("ij,ij->i", np.cross(middle - point, centre - point), point)
            moment = area[:, np.newaxis] * (point + middle + centre)
            for axis in range(3):
                moments[:, axis] += np.bincount(
                    triangles[:, corner], moment[:, axis], minlength=len(points)
                )
    return _project(points + _OVERSHOOT * (_project(moments) - points))


def _outward(points: Array, triangles: Array) -> Array:
    """Triangles of a star-shaped surface round the origin, counter-clockwise from outside."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    turned = triangles.astype(np.int64)
    turned[inward] = turned[inward][:, ::-1]
    return turned


def _project(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
