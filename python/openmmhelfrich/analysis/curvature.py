"""Mean curvature of the vertices of a triangulated surface."""

import numpy as np

from ._arrays import dot, frames_of, gather_sum, triangles_of


def mean_curvature(vertices, triangles):
    """Mean curvature at every vertex after Jülicher, H_i = J_i / a_i.

    J_i = Σ_j l_ij φ_ij / 2 (B11) and a_i = Σ_t a_t / 3 (B12), summed over the edges and the
    triangles at vertex i: l_ij is the length of an edge and φ_ij the angle between the normals of
    its two triangles, positive at a convex edge. H is the *sum* of the two principal curvatures,
    2/R on a sphere of radius R. Source: doi:10.1103/PhysRevE.108.015301.

    Parameters
    ----------
    vertices : array_like or Quantity
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int
        Shape (num_triangles, 3), counter-clockwise seen from outside, a closed surface.

    Returns
    -------
    ndarray
        H, shape (num_vertices,) or (num_frames, num_vertices), 1/nm.

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, an index out of range, a coordinate that is not finite, a vertex without a
        triangle, or an edge that does not have two triangles of the same orientation.
    """
    frames, single = frames_of(vertices)
    num_vertices = frames.shape[1]
    faces = triangles_of(triangles, num_vertices)
    unused = np.setdiff1d(np.arange(num_vertices), faces)
    if len(unused):
        raise ValueError(f"triangles: vertex {unused[0]} belongs to no triangle")
    start, end, left, right = _edges(faces)

    corners = frames[:, faces]
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    areas = np.linalg.norm(normals, axis=-1) / 2
    edges = frames[:, end] - frames[:, start]
    lengths = np.linalg.norm(edges, axis=-1)
    # l · sin φ and l · cos φ of unnormalised normals: atan2 needs neither a division nor a clamp.
    angles = np.arctan2(
        dot(edges, np.cross(normals[:, left], normals[:, right])),
        lengths * dot(normals[:, left], normals[:, right]),
    )
    curvature = lengths * angles / 2
    integrated = gather_sum(
        np.concatenate([curvature, curvature], axis=1),
        np.concatenate([start, end]),
        num_vertices,
    )
    area = gather_sum(np.repeat(areas / 3, 3, axis=1), faces.ravel(), num_vertices)
    result = integrated / area
    return result[0] if single else result


def _edges(faces):
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
