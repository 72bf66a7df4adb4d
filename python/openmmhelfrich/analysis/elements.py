"""Edges and triangles of a surface: which there are, and their sizes."""

import numpy as np

from ._arrays import over_frames


def triangle_areas(vertices, triangles):
    """Area of every triangle.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own.

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

    def work(frames, faces, first):
        a, b, c = (frames[:, faces[:, corner]] for corner in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 2

    return over_frames(work, vertices, triangles, lambda n, t: 15 * t)


def triangle_heights(vertices, triangles):
    """The three heights of every triangle, 2 a_t / l.

    Parameters
    ----------
    vertices, triangles
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

    def work(frames, faces, first):
        sides = [frames[:, faces[:, (k + 1) % 3]] - frames[:, faces[:, k]] for k in range(3)]
        doubled = np.linalg.norm(np.cross(sides[0], sides[1]), axis=-1)
        return np.stack([doubled / np.linalg.norm(side, axis=-1) for side in sides], axis=-1)

    return over_frames(work, vertices, triangles, lambda n, t: 20 * t)


def edge_lengths(vertices, triangles):
    """Length of every edge, in the order of `Mesh.edges`.

    Parameters
    ----------
    vertices, triangles
        As for `triangle_areas`; the surface must be closed and oriented.

    Returns
    -------
    ndarray
        Shape (num_edges,) or (num_frames, num_edges), nm.

    Raises
    ------
    TypeError, ValueError
        As for `triangle_areas`; an edge that does not have two triangles of the same orientation.
    """

    def work(frames, faces, first):
        start, end, _, _ = edges_of(faces)
        order = np.lexsort((end, start))
        return np.linalg.norm(frames[:, end[order]] - frames[:, start[order]], axis=-1)

    return over_frames(work, vertices, triangles, lambda n, t: 12 * t)


def edges_of(faces):
    """Edges of a closed surface, each once.

    Returns
    -------
    start, end : ndarray of int
        The two vertices of each edge, in the order in which its left triangle names them.
    left, right : ndarray of int
        The triangle that has the edge start → end, and the one that has it end → start.
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
    missing = np.flatnonzero(keys[place] != backward)
    if len(missing):
        edge = missing[0]
        raise ValueError(
            f"triangles: the edge {start[edge]} – {end[edge]} has one triangle only, so the "
            "surface is not closed"
        )
    twin = order[place]
    once = start < end
    return start[once], end[once], owner[once], owner[twin[once]]
