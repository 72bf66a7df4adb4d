"""Where a triangulated surface passes through itself."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from .._mesh.periodic import corner_positions, wrapped
from .._types import Array, Values
from ._arrays import box_of, dot, frames_of, triangles_of

# Ends of an edge that are nearer to the plane of a triangle than this part of the edge lie in it.
_FLAT = 1e-12
# Edges that are looked up at a time, which bounds the memory.
_CHUNK = 1 << 16


def crossings(vertices: Any, triangles: Any = None, *, box: Values | None = None) -> Array:
    """Pairs of triangles that pass through each other.

    Two triangles in general position meet where an edge of one of them meets the other, so every
    edge is tested against every triangle nearby that has no vertex in common with it: on which
    sides of the triangle's plane its ends are, and whether it meets the plane inside. Neighbours
    that share one vertex are found too, if they cross elsewhere. Triangles that touch count as
    crossing. Those that lie in one plane, or share an edge, do not: a fold is a matter of dihedral
    angles.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context or Simulation
        Shape (num_vertices, 3), one frame, nm.
    triangles : array_like of int or Mesh, optional
        Shape (num_triangles, 3). Default: those of the mesh that `vertices` is.
    box : array_like or Quantity, optional
        Periodic box, shape (3, 3), nm: triangles are found that cross images of each other, and
        may be wrapped, with edges shorter than half the width of the box. Default: that of the
        mesh, if there is one.

    Returns
    -------
    ndarray of int
        Each pair once, lower index first, in lexicographic order, shape (num_pairs, 2); empty if
        the surface passes through itself nowhere.

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, several frames, an index out of range, or a coordinate that is not finite.

    Notes
    -----
    0.1 s for 5000 triangles. An edge whose vertices are also a triangle's is taken for a neighbour
    of it, whatever the image; that matters in boxes only a few triangles wide.

    Examples
    --------
    >>> from openmmhelfrich import Mesh
    >>> mesh = Mesh.icosphere(3, radius=10)
    >>> len(crossings(mesh))
    0
    >>> vertices = mesh.vertices.copy()
    >>> vertices[0] *= -1.5
    >>> len(crossings(vertices, mesh)) > 0
    True
    """
    source = vertices
    if triangles is None:
        triangles = getattr(source, "triangles", None)
        if triangles is None:
            raise ValueError("crossings: triangles are needed, unless vertices is a Mesh")
    box = box_of(box, source, triangles)
    frames, _ = frames_of(source)
    if len(frames) != 1:
        raise ValueError(f"crossings: vertices of one frame are taken, got {len(frames)}")
    if box is not None and box.ndim == 3:
        raise ValueError(f"crossings: the box of one frame is taken, got boxes of {len(box)}")
    faces = triangles_of(triangles, frames.shape[1])
    corners = corner_positions(frames[0], faces, box)
    sides, owners = _sides(faces)
    # Ends of a side as its first triangle has them.
    place = owners[:, :1], sides
    ends, names = corners[place], faces[place]
    found = [np.empty((0, 2), dtype=int)]
    for edge, triangle, shift in _near(ends, corners, box):
        apart = (names[edge][:, :, np.newaxis] != faces[triangle][:, np.newaxis]).all(axis=(1, 2))
        edge, triangle, shift = edge[apart], triangle[apart], shift[apart]
        met = _meets(ends[edge] + shift[:, np.newaxis], corners[triangle])
        for side in range(2):
            pairs = np.stack([owners[edge[met], side], triangle[met]], axis=1)
            found.append(np.sort(pairs[pairs[:, 0] >= 0], axis=1))
    return np.unique(np.concatenate(found), axis=0)


def _sides(faces):
    """Each edge once: its places in its first triangle, and its two triangles, −1 for none."""
    corner = np.tile([[0, 1], [1, 2], [2, 0]], (len(faces), 1))
    owner = np.repeat(np.arange(len(faces)), 3)
    ends = np.sort(faces[owner[:, np.newaxis], corner], axis=1)
    _, first, number = np.unique(ends, axis=0, return_index=True, return_inverse=True)
    owners = np.full((len(first), 2), -1)
    owners[:, 0] = owner[first]
    others = np.setdiff1d(np.arange(len(owner)), first)
    owners[number.reshape(-1)[others], 1] = owner[others]
    return corner[first], owners


def _near(ends, corners, box):
    """Pairs of an edge and a triangle whose spheres meet, with the shift of the edge, in chunks.

    Both are sorted into classes of size, so that a few large ones do not make all others search
    far.
    """
    middle, reach = _spheres(ends)
    centre, radius = _spheres(corners)
    home = wrapped(centre, box)
    edge = np.arange(len(ends))
    shift = wrapped(middle, box) - middle
    if box is not None:
        margin = reach.max() + radius.max()
        edge, shift = _with_images(middle, shift, home, box, margin)
    moved = middle[edge] + shift
    # Where both are seen from one place, what takes the triangle there takes the edge back.
    back = centre - home
    for triangles in _classes(radius):
        tree = cKDTree(home[triangles])
        for some in _classes(reach[edge]):
            distance = radius[triangles].max() + reach[edge[some]].max()
            for first in range(0, len(some), _CHUNK):
                part = some[first : first + _CHUNK]
                near = cKDTree(moved[part]).sparse_distance_matrix(
                    tree, distance, output_type="ndarray"
                )
                row, triangle = part[near["i"]], triangles[near["j"]]
                close = near["v"] <= reach[edge[row]] + radius[triangle]
                row, triangle = row[close], triangle[close]
                yield edge[row], triangle, shift[row] + back[triangle]


def _with_images(middle, shift, home, box, margin):
    """Edges and their shifts, with those images of them that lie in reach of the triangles."""
    low, high = home.min(axis=0) - margin, home.max(axis=0) + margin
    edges, shifts = [], []
    # A box leans over by at most half of its length, so two steps along a reach all around.
    for image in np.ndindex(5, 3, 3):
        moved = shift + (np.array(image) - (2, 1, 1)) @ box
        inside = ((middle + moved >= low) & (middle + moved <= high)).all(axis=1)
        edges.append(np.flatnonzero(inside))
        shifts.append(moved[inside])
    return np.concatenate(edges), np.concatenate(shifts)


def _spheres(points):
    """Middles of edges or triangles, and the radius that their points lie within."""
    middle = points.mean(axis=1)
    return middle, np.linalg.norm(points - middle[:, np.newaxis], axis=2).max(axis=1)


def _classes(sizes):
    """Indices of sizes that are within a factor of two, class by class."""
    octave = np.frexp(sizes)[1]
    return [np.flatnonzero(octave == each) for each in np.unique(octave)]


def _meets(ends, corners):
    """Whether each edge meets its triangle, shape (num_pairs,)."""
    start, end = ends[:, 0], ends[:, 1]
    a, b, c = (corners[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    height, rest = dot(normal, start - a), dot(normal, end - a)
    least = _FLAT * np.linalg.norm(normal, axis=1) * np.linalg.norm(end - start, axis=1)
    through = (height * rest <= 0) & (np.maximum(abs(height), abs(rest)) > least)
    share = height / np.where(through, height - rest, 1.0)
    point = start + share[:, np.newaxis] * (end - start)
    for p, q in ((a, b), (b, c), (c, a)):
        through &= dot(np.cross(q - p, point - p), normal) >= 0
    return through
