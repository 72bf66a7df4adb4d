"""Areas, volumes, edges, borders and components, as functions of arrays.

`vertices` is float64 of shape (num_vertices, 3), nm; `corners` are those of triangles, shape
(num_triangles, 3, 3), nm; `triangles` is int64 of shape (num_triangles, 3), counter-clockwise seen
from outside. Nothing here validates: `Mesh` has done so.
Equation numbers are those of doi:10.1103/PhysRevE.108.015301.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from .._types import Array
from ..errors import MeshError

__all__ = [
    "border_loops",
    "check_closed",
    "component_count",
    "dihedral_angles",
    "edge_graph",
    "edges_of",
    "reduced_volume",
    "surface_area",
    "volume_enclosed",
]


def surface_area(corners: Array) -> float:
    """Total area A = Σ_t |AB × AC| / 2 (B2), nm²."""
    a, b, c = (corners[:, corner] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def volume_enclosed(vertices: Array, triangles: Array) -> float:
    """Enclosed volume V = Σ_t A · (B × C) / 6 (B3, B4), nm³, positive if oriented outward."""
    # The sum over a closed surface does not depend on the origin, but its rounding errors grow
    # with the distance to it; the centroid keeps them small for meshes that lie far out.
    centred = vertices - vertices.mean(axis=0)
    a, b, c = (centred[triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def reduced_volume(area: float, volume: float) -> float:
    """Volume over that of the sphere of equal area, v = 6 √π V / A^{3/2}; 1 for a sphere."""
    return float(6 * np.sqrt(np.pi) * volume / area**1.5)


def edges_of(triangles: Array) -> Array:
    """Each edge once, shape (num_edges, 2), lower index first, in lexicographic order."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides.sort(axis=1)
    return np.unique(sides, axis=0)


def dihedral_angles(corners: Array, triangles: Array) -> Array:
    """φ of each edge in the order of `edges_of`; 0 at borders, which have none."""
    halves = np.stack([triangles, triangles[:, [1, 2, 0]]], axis=-1).reshape(-1, 2)
    order = np.lexsort((halves.max(axis=1), halves.min(axis=1)))
    keys = np.sort(halves[order], axis=1)
    first = np.flatnonzero(np.r_[True, (keys[1:] != keys[:-1]).any(axis=1)])
    inner = np.diff(np.r_[first, len(keys)]) == 2
    left, right = order[first[inner]], order[first[inner] + 1]
    sides = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(sides[:, 0], -sides[:, 2])
    along = sides.reshape(-1, 3)[left]
    along /= np.linalg.norm(along, axis=1)[:, None]
    one, other = normals[left // 3], normals[right // 3]
    sine = np.einsum("ij,ij->i", np.cross(one, other), along)
    angles = np.zeros(len(first))
    angles[inner] = np.arctan2(sine, np.einsum("ij,ij->i", one, other))
    return angles


def border_loops(triangles: Array) -> list[Array]:
    """The borders as loops of vertices, in the direction of their triangles.

    Each begins with its lowest vertex, and loops are in the order of those.
    """
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = triangles.max() + 1
    alone = ~np.isin(start * count + end, end * count + start)
    following = dict(zip(start[alone].tolist(), end[alone].tolist(), strict=True))
    loops = []
    for first in sorted(following):
        loop = []
        while first in following:
            loop.append(first)
            first = following.pop(first)
        if loop:
            loops.append(np.array(loop))
    return loops


def check_closed(loops: list[Array], subject: str) -> None:
    """Refuse a surface with borders where there must be none; `subject` begins the message."""
    if loops:
        first = loops[0].tolist()
        names = ", ".join(map(str, first[:6])) + (" …" if len(first) > 6 else "")
        raise MeshError(
            f"{subject} needs a closed surface, but this one has a border of {len(first)} edges "
            f"through vertices {names}; close the hole"
        )


def component_count(num_vertices: int, edges: Array) -> int:
    """The number of connected components."""
    graph = edge_graph(num_vertices, edges)
    return int(connected_components(graph, directed=False, return_labels=False))


def edge_graph(num_vertices: int, edges: Array) -> csr_array:
    """Which vertices are connected, as scipy.sparse.csgraph has it, each edge in one direction."""
    ones = np.ones(len(edges), dtype=np.int8)
    return csr_array((ones, (edges[:, 0], edges[:, 1])), shape=(num_vertices, num_vertices))
