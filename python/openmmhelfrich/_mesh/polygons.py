"""Faces of more than three corners, split into triangles.

A quadrilateral is cut along the shorter one of its two diagonals. A polygon of more corners loses
an ear (a corner with its two neighbours) again and again: the one that is cut off along the
shortest diagonal. A diagonal counts only if it lies inside of the polygon, seen along the normal of
its area vector Σ r_i × r_{i+1} / 2, and if it leaves no sliver; so concave polygons, corners on a
straight side, and polygons that are not quite flat are split properly. Of equal diagonals the one
at the earliest corner of the file is taken. No vertex is added, and the triangles of a face follow
one another where the face was.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .._types import Array

__all__ = ["split"]

# Least area of a triangle, as a part of its polygon's: less is a sliver, made of rounding.
_SLIVER = 1e-6
# Diagonals whose squares differ by less, relatively, are equal: rounding must not decide.
_EQUAL = 1e-9
_CROSSED = (
    "cannot be split into triangles: seen along its normal it crosses itself or has no area; split "
    "it by hand"
)


def split(points: Array, faces: Sequence[Any], fail: Callable[[int, str], Exception]) -> Array:
    """The triangles of polygons.

    Parameters
    ----------
    points : ndarray
        Shape (num_vertices, 3), finite.
    faces : sequence of sequence of int
        The corners of each face, three or more, in range.
    fail : callable
        Makes the exception for a face: its number, and what is wrong with it.

    Returns
    -------
    ndarray
        Shape (num_triangles, 3), int64, in the sense of rotation of the faces.
    """
    sizes = np.array([len(face) for face in faces], dtype=np.int64)
    if (sizes == 3).all():
        return np.array(faces, dtype=np.int64).reshape(-1, 3)
    # Below 1, so that squares do not overflow; by a power of 2, which changes no digit that counts.
    points = np.ldexp(points, -np.frexp(np.abs(points).max(initial=0.0))[1])
    starts = np.cumsum(sizes - 2) - (sizes - 2)
    triangles = np.empty((int((sizes - 2).sum()), 3), dtype=np.int64)
    kept = np.flatnonzero(sizes == 3)
    if len(kept):
        triangles[starts[kept]] = [faces[face] for face in kept]
    quads = np.flatnonzero(sizes == 4)
    if len(quads):
        corners = np.array([faces[face] for face in quads], dtype=np.int64)
        halves, crossed = _quadrilaterals(points, corners)
        if crossed.any():
            face = int(quads[crossed][0])
            raise fail(face, _fault(faces[face]))
        for half in range(2):
            triangles[starts[quads] + half] = halves[:, half]
    for face in np.flatnonzero(sizes > 4).tolist():
        corners = np.array(faces[face], dtype=np.int64)
        found = _ears(points[corners]) if len(set(corners.tolist())) == len(corners) else None
        if found is None:
            raise fail(face, _fault(faces[face]))
        triangles[starts[face] : starts[face] + len(found)] = corners[found]
    return triangles


def _fault(face) -> str:
    """Why a face cannot be split."""
    corners = [int(corner) for corner in face]
    for corner in corners:
        if corners.count(corner) > 1:
            return f"has vertex {corner} twice (counted from 0); its corners must differ"
    return _CROSSED


def _quadrilaterals(points: Array, corners: Array) -> tuple[Array, Array]:
    """The two halves of each quadrilateral, shape (…, 2, 3), and which ones have none."""
    a, b, c, d = (points[corners[:, k]] for k in range(4))
    normal = np.cross(c - a, d - b)
    least = _SLIVER * np.einsum("ij,ij->i", normal, normal)

    def inside(*halves):
        areas = [
            np.einsum("ij,ij->i", np.cross(q - p, r - p), normal) > least for p, q, r in halves
        ]
        return areas[0] & areas[1]

    along_ac = inside((a, b, c), (a, c, d))
    along_bd = inside((a, b, d), (b, c, d))
    ac, bd = (np.einsum("ij,ij->i", side, side) for side in (c - a, d - b))
    other = along_bd & (~along_ac | (bd < (1 - _EQUAL) * ac))
    halves = corners[:, [[0, 1, 2], [0, 2, 3]]]
    halves[other] = corners[other][:, [[0, 1, 3], [1, 2, 3]]]
    repeated = (np.diff(np.sort(corners, axis=1), axis=1) == 0).any(axis=1)
    return halves, ~(along_ac | along_bd) | repeated


def _ears(points: Array) -> Array | None:
    """The triangles of one polygon, by places of its corners; None if it cannot be split."""
    flat, double_area = _seen_along_normal(points)
    least = _SLIVER * double_area
    left, triangles = np.arange(len(points)), []
    while len(left) > 3:
        before, after = np.roll(left, 1), np.roll(left, -1)
        a, b, c = flat[before], flat[left], flat[after]
        diagonals = points[after] - points[before]
        squares = np.einsum("ij,ij->i", diagonals, diagonals)
        # Row k has the corner k; column q says whether the corner q lies in its triangle or on it.
        others = flat[left][np.newaxis]
        covered = np.ones((len(left), len(left)), dtype=bool)
        for p, q in ((a, b), (b, c), (c, a)):
            covered &= _cross((q - p)[:, np.newaxis], others - p[:, np.newaxis]) >= -least
        own = np.arange(len(left))
        for shift in (-1, 0, 1):
            covered[own, (own + shift) % len(left)] = False
        ears = np.flatnonzero((_cross(b - a, c - a) > least) & ~covered.any(axis=1))
        if len(ears) == 0:
            return None
        short = squares[ears] <= (1 + _EQUAL) * squares[ears].min()
        ear = ears[short][0]
        triangles.append((before[ear], left[ear], after[ear]))
        left = np.delete(left, ear)
    a, b, c = flat[left]
    if not _cross(b - a, c - a) > least:
        return None
    return np.array([*triangles, tuple(left)])


def _seen_along_normal(points: Array) -> tuple[Array, float]:
    """Coordinates in the plane of a polygon, counter-clockwise, and twice its area there."""
    sides = points - points[0]
    normal = np.cross(sides, np.roll(sides, -1, axis=0)).sum(axis=0)
    double_area = float(np.linalg.norm(normal))
    if double_area == 0:
        return np.zeros((len(points), 2)), 0.0
    normal /= double_area
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return sides @ np.stack([first, np.cross(normal, first)], axis=1), double_area


def _cross(p: Array, q: Array) -> Array:
    """Twice the signed area between vectors in the plane."""
    return p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
