"""Vertices that nearly coincide, or belong to nothing: mended if asked for, else hinted at."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .._numbers import FARTHEST
from .._types import Array
from ..errors import MeshError

__all__ = ["doubled", "drop", "hints", "merge"]

# Vertices of no common edge that are nearer than this part of the median edge are worth a hint.
_NEAR = 1e-2
# Neighbours per vertex beyond which a distance is no tolerance; pairs would fill the memory.
_MANY = 100


def merge(points: Array, triangles: Array, distance: float) -> tuple[Array, Array]:
    """The mesh with vertices at most `distance` apart joined, chains of them too.

    The first one of each group in the file stays where it is, and numbers close up.

    Raises
    ------
    MeshError
        If two corners of a triangle would be joined.
    """
    if not _sound(points, triangles):
        return points, triangles
    pairs = _pairs(points, distance)
    if pairs is None:
        raise MeshError(
            f"merge={distance:g} joins more than {_MANY} vertices with each; take "
            "a smaller distance"
        )
    if distance == 0:
        # The square of a difference can be too small for a number.
        pairs = pairs[(points[pairs[:, 0]] == points[pairs[:, 1]]).all(axis=1)]
    links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    _, group = connected_components(links, directed=False)
    _, first = np.unique(group, return_index=True)
    target = first[group]
    corners = target[triangles]
    for one, two in ((0, 1), (1, 2), (2, 0)):
        lost = np.flatnonzero(
            (corners[:, one] == corners[:, two]) & (triangles[:, one] != triangles[:, two])
        )
        if len(lost):
            a, b = triangles[lost[0], [one, two]].tolist()
            gap = np.linalg.norm(points[a] - points[b])
            raise MeshError(
                f"merge={distance:g} joins two corners of triangle {lost[0]}, vertices {a} and "
                f"{b}, {gap:.3g} nm apart; take a smaller distance"
            )
    return drop(points, corners, np.flatnonzero(target != np.arange(len(points))))


def drop(points: Array, corners: Array, dropped: Array | None = None) -> tuple[Array, Array]:
    """The mesh without some vertices, which no triangle uses; without all of these by default."""
    if not _in_range(points, corners):
        # An index out of range is left to the validation of the mesh, which names it.
        return points, corners
    if dropped is None:
        dropped = _unused(points, corners)
    if len(dropped) == 0:
        return points, corners
    kept = np.setdiff1d(np.arange(len(points)), dropped)
    number = np.full(len(points), -1)
    number[kept] = np.arange(len(kept))
    return points[kept], number[corners]


def hints(points: Array, triangles: Array) -> str:
    """What reading a refused mesh in another way could mend; empty if nothing of that kind."""
    if not _sound(points, triangles) or len(triangles) == 0:
        return ""
    found = ""
    if len(_unused(points, triangles)):
        found += (
            "; drop_unused=True (--drop-unused) leaves out the vertices that belong to no triangle"
        )
    return found + doubled(points, triangles)


def doubled(points: Array, triangles: Array) -> str:
    """A hint at vertices that nearly coincide, without an edge between them; empty if none do."""
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    lengths = np.linalg.norm(points[sides[:, 0]] - points[sides[:, 1]], axis=1)
    pairs = _pairs(points, _NEAR * float(np.median(lengths)))
    if pairs is None:
        return ""
    numbers = np.sort(sides, axis=1) @ [len(points), 1]
    pairs = pairs[~np.isin(np.sort(pairs, axis=1) @ [len(points), 1], numbers)]
    if len(pairs) == 0:
        return ""
    gaps = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    a, b = sorted(pairs[np.argmax(gaps)].tolist())
    enough = f"{2 * gaps.max():.1g}"
    return (
        f"; {len(pairs)} pair(s) of vertices nearly coincide, such as {a} and {b}, "
        f"{gaps.max():.3g} nm apart: merge={enough} (--merge {enough}) joins them"
    )


def _pairs(points: Array, distance: float) -> Array | None:
    """Pairs of vertices at most so far apart, shape (num_pairs, 2); None if they are too many."""
    tree = cKDTree(points)
    if tree.count_neighbors(tree, distance) > (_MANY + 1) * len(points):
        return None
    return tree.query_pairs(distance, output_type="ndarray")


def _unused(points: Array, triangles: Array) -> Array:
    return np.setdiff1d(np.arange(len(points)), triangles)


def _in_range(points: Array, triangles: Array) -> bool:
    return bool(((triangles >= 0) & (triangles < len(points))).all())


def _sound(points: Array, triangles: Array) -> bool:
    """Whether distances and indices mean something; if not, the validation says why."""
    return len(points) > 0 and bool((abs(points) < FARTHEST).all()) and _in_range(points, triangles)
