"""Nearest images in a periodic box, as the core finds them (``src/mesh/cell.rs``).

A box is an array of three rows a, b, c, nm, in OpenMM's reduced form: (ax, 0, 0), (bx, by, 0) and
(cx, cy, cz), none of which leans over by more than half of another's length. Functions of corners
take a box of None for positions that are what they are.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.csgraph import breadth_first_order, connected_components

from .._types import Array
from .geometry import edge_graph

__all__ = ["corner_positions", "cut", "cut_images", "half_width", "nearest", "unfolded", "wrapped"]


def half_width(box: Array) -> float:
    """Half of the least distance between opposite faces, nm: what is shorter has one image."""
    a, b, c = box
    faces = [np.linalg.norm(np.cross(*pair)) for pair in ((b, c), (c, a), (a, b))]
    return float(abs(np.linalg.det(box)) / max(faces) / 2)


def nearest(separations: Array, box: Array | None) -> Array:
    """Separations, shape (…, 3), as their shortest images; of long ones, as some short image."""
    return _reduced(separations, box, np.rint)


def wrapped(positions: Array, box: Array | None) -> Array:
    """Positions, shape (…, 3), in the brick of sides ax, by and cz that begins at the origin."""
    return _reduced(positions, box, np.floor)


def corner_positions(vertices: Array, triangles: Array, box: Array | None) -> Array:
    """Corners of triangles, those beside the first as its nearest images.

    Parameters
    ----------
    vertices : ndarray
        Shape (…, num_vertices, 3), nm.
    triangles : ndarray of int
        Shape (num_triangles, 3).
    box : ndarray or None

    Returns
    -------
    ndarray
        Shape (…, num_triangles, 3 corners, 3), nm.
    """
    corners = vertices[..., triangles, :]
    if box is None:
        return corners
    first = corners[..., :1, :]
    return first + nearest(corners - first, box)


def unfolded(vertices: Array, edges: Array, box: Array) -> tuple[Array, Array, Array]:
    """Vertices moved by box vectors so that edges of a tree are nearest images.

    Parameters
    ----------
    vertices : ndarray
        Shape (num_vertices, 3), nm.
    edges : ndarray of int
        Shape (num_edges, 2).
    box : ndarray

    Returns
    -------
    vertices : ndarray
        Shape (num_vertices, 3), nm. The first vertex of each part is where it was.
    part : ndarray of int
        The connected part of each vertex, shape (num_vertices,).
    spanning : ndarray of bool
        Along which of a, b and c each part comes back to itself, shape (num_parts, 3).
    """
    count = len(vertices)
    graph = edge_graph(count, edges)
    num_parts, part = connected_components(graph, directed=False)
    result = vertices.copy()
    depth = np.zeros(count, dtype=np.intp)
    parent = np.full(count, -1)
    for root in np.unique(part, return_index=True)[1]:
        order, before = breadth_first_order(graph, root, directed=False)
        parent[order[1:]] = before[order[1:]]
        for vertex in order[1:]:
            depth[vertex] = depth[before[vertex]] + 1
    for level in range(1, depth.max() + 1):
        here = np.flatnonzero(depth == level)
        base = result[parent[here]]
        result[here] = base + nearest(vertices[here] - base, box)
    along = result[edges[:, 1]] - result[edges[:, 0]]
    spanning = np.zeros((num_parts, 3), dtype=bool)
    np.logical_or.at(spanning, part[edges[:, 0]], _steps(along - nearest(along, box), box) != 0)
    return result, part, spanning


def cut(vertices: Array, triangles: Array, edges: Array, box: Array):
    """The positions and triangles of `cut_images`."""
    return cut_images(vertices, triangles, edges, box)[:2]


def cut_images(
    vertices: Array, triangles: Array, edges: Array, box: Array
) -> tuple[Array, Array, Array]:
    """Whole triangles, and vertices once for each of their images that triangles need.

    Where a part spans the box, its triangles are those with their middles inside of the box.

    Returns
    -------
    vertices : ndarray
        Shape (num_images, 3), nm, in the order of the vertices.
    triangles : ndarray of int
        Shape (num_triangles, 3), in the order of the triangles.
    owners : ndarray of int
        The vertex of each image, shape (num_images,).
    """
    places, part, spanning = unfolded(vertices, edges, box)
    corners = corner_positions(places, triangles, box)
    middles = np.linalg.solve(box.T, corners.mean(axis=1).T).T
    home = np.where(spanning[part[triangles[:, 0]]], np.floor(middles), 0) @ box
    corners -= home[:, np.newaxis]
    steps = _steps(corners - places[triangles], box)
    names = np.column_stack([triangles.reshape(-1), steps.reshape(-1, 3)])
    images, number = np.unique(names, axis=0, return_inverse=True)
    owners = images[:, 0]
    return places[owners] + images[:, 1:] @ box, number.reshape(-1, 3), owners


def _steps(shifts: Array, box: Array) -> Array:
    """Sums of box vectors, shape (…, 3), as how many of each."""
    flat = np.linalg.solve(box.T, shifts.reshape(-1, 3).T).T
    return np.rint(flat).astype(int).reshape(shifts.shape)


def _reduced(vectors: Array, box: Array | None, count) -> Array:
    if box is None:
        return vectors
    rest = np.array(vectors, dtype=float)
    for axis in (2, 1, 0):
        rest -= count(rest[..., axis] / box[axis, axis])[..., np.newaxis] * box[axis]
    return rest
