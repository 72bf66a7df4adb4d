"""Triangulated spheres: regular icospheres and irregular, nearly even random ones."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from ..errors import MeshError
from .inputs import integer

__all__ = ["icosphere", "random_sphere"]

# Lloyd's step is overshot by this factor. Below 2 the iteration is stable, and near 2 it smooths
# density differences over long distances several times as fast as the plain step.
_OVERSHOOT = 1.8
# After so many steps the triangle areas scatter by 5 to 6 %, as those of the paper's meshes do.
_STEPS = 100
# Beyond these the relaxation goes on only while a degree is out of range; then it starts afresh.
_MOST_STEPS = 1000
_ATTEMPTS = 20


def icosphere(n, radius: float) -> tuple[np.ndarray, np.ndarray]:
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
    _check_radius(radius, where)
    golden = (1 + np.sqrt(5)) / 2
    corners = np.array([(0.0, s, t * golden) for s in (1, -1) for t in (1, -1)])
    corners = np.concatenate([np.roll(corners, shift, axis=1) for shift in range(3)])
    faces = _outward(corners, ConvexHull(corners).simplices)
    index: dict[tuple, int] = {}
    points = []
    triangles = []

    def vertex(face: np.ndarray, weights: tuple[int, int, int]) -> int:
        # Two faces name a point of their common side by the same corners and weights, so that
        # neighbours share it without a comparison of coordinates.
        key = tuple(sorted((int(c), w) for c, w in zip(face, weights, strict=True) if w > 0))
        if key not in index:
            index[key] = len(points)
            points.append(sum(w * corners[c] for c, w in key))
        return index[key]

    for face in faces:
        for i in range(n):
            for j in range(n - i):
                k = n - 1 - i - j
                rows = [((i + 1, j, k), (i, j + 1, k), (i, j, k + 1))]
                if k > 0:
                    # The triangle across the side of the first one, turned by half a turn.
                    rows.append(((i, j + 1, k), (i + 1, j, k), (i + 1, j + 1, k - 1)))
                triangles += [[vertex(face, weights) for weights in row] for row in rows]
    return radius * _project(np.array(points)), np.array(triangles, dtype=np.int64)


def random_sphere(num_vertices, radius: float, seed) -> tuple[np.ndarray, np.ndarray]:
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
    _check_radius(radius, where)
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


def _jittered_lattice(count: int, random: np.random.Generator) -> np.ndarray:
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


def _lloyd_step(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
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


def _outward(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Triangles of a star-shaped surface round the origin, counter-clockwise from outside."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    turned = triangles.astype(np.int64)
    turned[inward] = turned[inward][:, ::-1]
    return turned


def _project(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _check_radius(radius: float, where: str) -> None:
    if not radius > 0:
        raise MeshError(f"{where}: radius must be above 0 nm, got {radius}")
