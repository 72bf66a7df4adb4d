"""Areas, normals and curvatures of the vertices of a triangulated surface."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .._mesh.periodic import corner_positions, nearest
from .._types import Array, Values
from ._arrays import box_of, dot, gather_sum, in_boxes, over_frames
from .elements import edges_of

SCHEMES = (
    "Julicher",
    "GompperKroll",
    "GompperKrollBarycentric",
    "JulicherVoronoi",
    "Espriu",
)
"""Names of the schemes of `BendingForce`, each at the place that its constant names."""


class VertexQuantities(NamedTuple):
    """What `vertex_quantities` returns, shape (num_vertices, …) each; frames are an axis before.

    Curvatures are not defined at a border: `julicher`, `cotangent` and `umbrella` are NaN there.
    """

    barycentric_area: Array
    """a_B = Σ_t a_t / 3 (B12), nm²."""
    voronoi_area: Array
    """a_V = Σ_j l_ij² (cot θ1 + cot θ2) / 8 (B8), nm²; 0 or negative where triangles are obtuse."""
    normal: Array
    """n = Σ_t θ_t n_t / |…| (B9), a unit vector outward, shape (…, 3)."""
    julicher: Array
    """J = Σ_j l_ij φ_ij / 2 (B11), nm; positive where the surface is convex."""
    cotangent: Array
    """S = Σ_j (cot θ1 + cot θ2)(r_i − r_j) / 2 (B7), nm, shape (…, 3)."""
    umbrella: Array
    """Σ_j (r_i − r_j) / √3, Espriu's vector, nm, shape (…, 3); S if triangles are equilateral."""

    def mean_curvature(self, scheme: str | int = "Julicher") -> Any:
        """Mean curvature H at every vertex by a scheme, see `mean_curvature`, 1/nm."""
        name = _scheme(scheme)
        area = self.voronoi_area if name in _VORONOI else self.barycentric_area
        if name in ("Julicher", "JulicherVoronoi"):
            return self.julicher / area
        vector = self.umbrella if name == "Espriu" else self.cotangent
        return dot(self.normal, vector) / area


_VORONOI = ("GompperKroll", "JulicherVoronoi")


def mean_curvature(
    vertices: Any, triangles: Any, scheme: str | int = "Julicher", *, box: Values | None = None
) -> Array:
    """Mean curvature H of every vertex, by one of the schemes of `BendingForce`.

    ========================= ======================== =====
    scheme                    H
    ========================= ======================== =====
    "Julicher"                J / a_B                  (B13)
    "GompperKroll"            n · S / a_V              (B10)
    "GompperKrollBarycentric" n · S / a_B              (B15)
    "JulicherVoronoi"         J / a_V                  (B16)
    "Espriu"                  n · Σ(r_i − r_j) / √3a_B
    ========================= ======================== =====

    H is the *sum* of the two principal curvatures, 2/R on a sphere of radius R, and positive where
    the surface bulges outward. `VertexQuantities` has the symbols. The energies of the schemes with
    vectors have S², which is (n · S)² but for the part of S along the surface. Source:
    doi:10.1103/PhysRevE.108.015301.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own;
        counter-clockwise seen from outside.
    scheme : str or int
        A name of the table, or a constant of `BendingForce`.
    box : array_like or Quantity, optional
        Periodic box, shape (3, 3), or (num_frames, 3, 3) if each frame has its own, nm: triangles
        have corners that are nearest images. Default: that of a `Mesh` among the other arguments,
        if it has one; with a trajectory then the boxes in its file, if there are any.

    Returns
    -------
    ndarray
        H, shape (num_vertices,) or (num_frames, num_vertices), 1/nm. Voronoi areas can be 0, where
        H is infinite; H is NaN at vertices of a border.

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, an index out of range, a coordinate that is not finite, a vertex without a
        triangle, an edge that has more than two triangles or two of other orientation, or another
        scheme.
    """
    _scheme(scheme)
    return vertex_quantities(vertices, triangles, box=box).mean_curvature(scheme)


def vertex_quantities(vertices: Any, triangles: Any, *, box: Any = None) -> VertexQuantities:
    """Areas, normals and integrated curvatures of all vertices.

    Parameters
    ----------
    vertices, triangles, box
        As for `mean_curvature`.

    Returns
    -------
    VertexQuantities
        The fields document the formulae.

    Raises
    ------
    TypeError, ValueError
        As for `mean_curvature`.
    """
    box = box_of(box, vertices, triangles)

    def work(frames, faces, box):
        num_vertices = frames.shape[1]
        unused = np.setdiff1d(np.arange(num_vertices), faces)
        if len(unused):
            raise ValueError(f"triangles: vertex {unused[0]} belongs to no triangle")
        return _quantities(frames, faces, num_vertices, box)

    return VertexQuantities(
        *over_frames(in_boxes(work, box), vertices, triangles, lambda n, t: 60 * t)
    )


def total_mean_curvature(vertices: Any, triangles: Any, *, box: Any = None) -> Array | float:
    """Integral M = ∫ (C1 + C2)/2 dA over the surface, which is Σ l φ / 2 over its edges.

    It is 4πr on a sphere, and what an `AreaDifferenceForce` keeps near its target: the monolayers
    of a membrane, D apart, differ in area by ΔA = 2 D M. Border edges have no angle φ.

    Parameters
    ----------
    vertices, triangles, box
        As for `mean_curvature`.

    Returns
    -------
    float or ndarray
        M of each frame, nm.

    Raises
    ------
    TypeError, ValueError
        As for `mean_curvature`.
    """
    return _totals(vertices, triangles, box)[0]


def area_difference(vertices: Any, triangles: Any, *, box: Any = None) -> Array | float:
    """Reduced difference of the areas of two monolayers, Δa = ΔA / 8πD R_A = M / 4πR_A.

    R_A is the radius of the sphere of the same area, 4πR_A² = A, so that Δa is 1 on a sphere; D is
    the distance of the monolayers, and drops out. `total_mean_curvature` is M.

    Parameters
    ----------
    vertices, triangles, box
        As for `mean_curvature`.

    Returns
    -------
    float or ndarray
        Δa of each frame, without unit.

    Raises
    ------
    TypeError, ValueError
        As for `mean_curvature`.
    """
    total, area = _totals(vertices, triangles, box)
    return total / np.sqrt(4 * np.pi * area)


def _totals(vertices, triangles, box):
    """M and A of each frame."""
    box = box_of(box, vertices, triangles)

    def work(frames, faces, box):
        _, doubled, edges = _edges(frames, faces, box)
        return np.sum(edges.lengths * edges.angles, axis=1) / 2, np.sum(doubled, axis=1) / 2

    return over_frames(in_boxes(work, box), vertices, triangles, lambda n, t: 60 * t)


class _Edges(NamedTuple):
    start: Array
    end: Array
    right: Array
    vectors: Array
    lengths: Array
    angles: Array


def _edges(frames, faces, box):
    """Normals of the triangles, twice their areas, and the edges; φ is 0 at borders."""
    start, end, left, right = edges_of(faces)
    corners = corner_positions(frames, faces, box)
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    doubled = np.linalg.norm(normals, axis=-1)
    vectors = nearest(frames[:, end] - frames[:, start], box)
    lengths = np.linalg.norm(vectors, axis=-1)
    # l · sin φ and l · cos φ of unnormalised normals: atan2 needs neither a division nor a clamp.
    angles = np.arctan2(
        dot(vectors, np.cross(normals[:, left], normals[:, right])),
        lengths * dot(normals[:, left], normals[:, right]),
    )
    angles[:, right < 0] = 0
    return normals, doubled, _Edges(start, end, right, vectors, lengths, angles)


def _quantities(frames, faces, num_vertices, box):
    corners = corner_positions(frames, faces, box)
    normals, doubled, (start, end, right, edges, lengths, angles) = _edges(frames, faces, box)
    area = _vertex_sum(np.repeat(doubled / 6, 3, axis=1), faces.ravel(), num_vertices)
    both = np.concatenate([start, end])
    julicher = _vertex_sum(np.tile(lengths * angles / 2, 2), both, num_vertices)
    umbrella = _vertex_sum(np.concatenate([-edges, edges], axis=1), both, num_vertices)

    # Per corner of a triangle: its angle, and the share of the opposite side in S and in a_V.
    voronoi, cotangent, normal = 0, 0, 0
    for corner in range(3):
        here, b, c = (faces[:, (corner + k) % 3] for k in range(3))
        p, q, r = (corners[:, :, (corner + k) % 3] for k in range(3))
        u, v = q - p, r - p
        cosine = dot(u, v)
        side = q - r
        with np.errstate(divide="ignore", invalid="ignore"):
            cot = cosine / doubled
            weighted = (np.arctan2(doubled, cosine) / doubled)[..., np.newaxis] * normals
        ends = np.concatenate([b, c])
        voronoi += _vertex_sum(np.tile(dot(side, side) * cot / 8, 2), ends, num_vertices)
        pull = cot[..., np.newaxis] * side / 2
        cotangent += _vertex_sum(np.concatenate([pull, -pull], axis=1), ends, num_vertices)
        normal += _vertex_sum(weighted, here, num_vertices)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    border = both[np.tile(right < 0, 2)]
    for curvature in (julicher, cotangent, umbrella):
        curvature[:, border] = np.nan
    return area, voronoi, normal, julicher, cotangent, umbrella / np.sqrt(3)


def _vertex_sum(values, owners, num_vertices):
    """`gather_sum` of scalars, or of vectors component by component."""
    if values.ndim == 2:
        return gather_sum(values, owners, num_vertices)
    return np.stack(
        [gather_sum(values[..., axis], owners, num_vertices) for axis in range(3)], axis=-1
    )


def _scheme(scheme):
    """The name of a scheme given by name or constant."""
    if isinstance(scheme, str) and scheme in SCHEMES:
        return scheme
    if not isinstance(scheme, (str, bool)) and scheme in range(len(SCHEMES)):
        return SCHEMES[scheme]
    raise ValueError(f"scheme: need one of {SCHEMES} or a constant of BendingForce, got {scheme!r}")
