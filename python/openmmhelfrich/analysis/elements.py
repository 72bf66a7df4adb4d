"""Edges and triangles of a surface: which there are, and their sizes."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._mesh.periodic import corner_positions, nearest
from .._types import Array, Values
from ._arrays import box_of, in_boxes, over_frames


def triangle_areas(vertices: Any, triangles: Any, *, box: Values | None = None) -> Array:
    """Area of every triangle.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own.
    box : array_like or Quantity, optional
        Periodic box, shape (3, 3), or (num_frames, 3, 3) if each frame has its own, nm: triangles
        have corners that are nearest images. Default: that of a `Mesh` among the other arguments,
        if it has one; with a trajectory then the boxes in its file, if there are any.

    Returns
    -------
    ndarray
        Shape (num_triangles,) or (num_frames, num_triangles), nm².

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, an index out of range, or a coordinate that is not finite.
    """
    box = box_of(box, vertices, triangles)

    def work(frames, faces, box):
        a, b, c = np.moveaxis(corner_positions(frames, faces, box), 2, 0)
        return np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 2

    return over_frames(in_boxes(work, box), vertices, triangles, lambda n, t: 15 * t)


def triangle_heights(vertices: Any, triangles: Any, *, box: Any = None) -> Array:
    """The three heights of every triangle, 2 a_t / l.

    Parameters
    ----------
    vertices, triangles, box
        As for `triangle_areas`.

    Returns
    -------
    ndarray
        Height over the side from corner 0 to 1, 1 to 2 and 2 to 0, shape (num_triangles, 3) or
        (num_frames, num_triangles, 3), nm.

    Raises
    ------
    TypeError, ValueError
        As for `triangle_areas`.
    """
    box = box_of(box, vertices, triangles)

    def work(frames, faces, box):
        corners = corner_positions(frames, faces, box)
        sides = [corners[:, :, (k + 1) % 3] - corners[:, :, k] for k in range(3)]
        doubled = np.linalg.norm(np.cross(sides[0], sides[1]), axis=-1)
        return np.stack([doubled / np.linalg.norm(side, axis=-1) for side in sides], axis=-1)

    return over_frames(in_boxes(work, box), vertices, triangles, lambda n, t: 20 * t)


def edge_lengths(vertices: Any, triangles: Any, *, box: Any = None) -> Array:
    """Length of every edge, in the order of `Mesh.edges`.

    Parameters
    ----------
    vertices, triangles, box
        As for `triangle_areas`; the surface must be oriented.

    Returns
    -------
    ndarray
        Shape (num_edges,) or (num_frames, num_edges), nm.

    Raises
    ------
    TypeError, ValueError
        As for `triangle_areas`; an edge that has more than two triangles, or two that are not of
        the same orientation.
    """
    box = box_of(box, vertices, triangles)

    def work(frames, faces, box):
        start, end, _, _ = edges_of(faces)
        low, high = np.minimum(start, end), np.maximum(start, end)
        order = np.lexsort((high, low))
        along = nearest(frames[:, high[order]] - frames[:, low[order]], box)
        return np.linalg.norm(along, axis=-1)

    return over_frames(in_boxes(work, box), vertices, triangles, lambda n, t: 12 * t)


def edges_of(faces: Any) -> Any:
    """Edges of an oriented surface, each once.

    Returns
    -------
    start, end : ndarray of int
        The two vertices of each edge, in the order in which its left triangle names them.
    left, right : ndarray of int
        The triangle that has the edge start → end, and the one that has it end → start, −1 at a
        border.
    """
    start = faces.ravel()
    end = np.roll(faces, -1, axis=1).ravel()
    owner = np.repeat(np.arange(len(faces)), 3)
    num_vertices = faces.max() + 1
    forward = start * num_vertices + end
    backward = end * num_vertices + start
    order = np.argsort(forward, kind="stable")
    keys = forward[order]
    repeated = np.flatnonzero(keys[1:] == keys[:-1])
    if len(repeated):
        edge = order[repeated[0]]
        raise ValueError(
            f"triangles: two triangles run along the edge {start[edge]} → {end[edge]} in the same "
            "direction, so the surface is not oriented or not a manifold"
        )
    place = np.minimum(np.searchsorted(keys, backward), len(keys) - 1)
    twin = np.where(keys[place] == backward, order[place], -1)
    once = (start < end) | (twin < 0)
    right = np.where(twin < 0, -1, owner[twin])
    return start[once], end[once], owner[once], right[once]
