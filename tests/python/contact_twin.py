"""Contacts by brute force, written without a look at the crate: every pair, no lists, no grid.

Where positions know their periodic box (`periodic_meshes.Positions`), their differences are nearest
images: of triangles and edges that of their middles.
"""

from __future__ import annotations

import numpy as np


def _seen(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The corners of triangles as points see them: shape (num_points, num_triangles, 3, 3)."""
    first = corners[:, 0]
    sides = np.stack([corners[:, k] - first for k in range(3)], axis=1)
    middle = sides.mean(axis=1)
    away = (first + middle)[None] - points[:, None]
    return away[:, :, None] + (sides - middle[:, None])


def _on_segments(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The points of segments nearest to the origin; shape (..., 3) each."""
    side = end - start
    along = -np.einsum("...x,...x->...", start, side) / (side**2).sum(axis=-1)
    return start + np.clip(along, 0, 1)[..., None] * side


def nearest(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """From points to the nearest points of triangles: shape (num_points, num_triangles, 3).

    points: shape (num_points, 3); corners: shape (num_triangles, 3, 3).
    """
    seen = _seen(points, corners)
    a, b, c = (seen[0, :, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    foot = np.einsum("ptx,tx->pt", seen[:, :, 0], normal)[..., None] * normal
    inside = np.ones(foot.shape[:2], dtype=bool)
    candidates = []
    for k in range(3):
        start, end = seen[:, :, k], seen[:, :, (k + 1) % 3]
        turn = np.cross(end - start, foot - start)
        inside &= np.einsum("ptx,tx->pt", turn, normal) >= 0
        candidates.append(_on_segments(start, end))
    best = np.argmin([np.linalg.norm(candidate, axis=2) for candidate in candidates], axis=0)
    rim = np.take_along_axis(np.stack(candidates), best[None, ..., None], axis=0)[0]
    return np.where(inside[..., None], foot, rim)


def core(gap: np.ndarray, distance: float, epsilon: float) -> np.ndarray:
    close = np.minimum(gap, distance)
    return epsilon * ((distance / close) ** 6 - 1) ** 2


def _edges(triangles: np.ndarray) -> np.ndarray:
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _between_segments(a, b, c, d) -> np.ndarray:
    """The distances of segments ab and cd: shape (num_pairs, 3) each."""
    normal = np.cross(b - a, d - c)
    # Where the edges are parallel, their ends are nearest.
    long = np.maximum(np.einsum("px,px->p", normal, normal), 1e-30)
    s = np.einsum("px,px->p", np.cross(c - a, d - c), normal) / long
    t = np.einsum("px,px->p", np.cross(c - a, b - a), normal) / long
    plane = np.abs(np.einsum("px,px->p", c - a, normal)) / np.sqrt(long)
    plane[(s <= 0) | (s >= 1) | (t <= 0) | (t >= 1)] = np.inf

    def to(point, start, end):
        return np.linalg.norm(_on_segments(start - point, end - point), axis=1)

    return np.min([plane, to(a, c, d), to(b, c, d), to(c, a, b), to(d, a, b)], axis=0)


def surface_pairs(positions, triangles, reach, part=None) -> tuple[np.ndarray, np.ndarray]:
    """The distances of pairs of a surface up to a reach, nm, and their weights m.

    part: labels of particles, if only pairs of different ones count.
    """
    vertices = np.unique(triangles)
    gaps = np.linalg.norm(nearest(positions[vertices], positions[triangles]), axis=2)
    counts = (triangles[None] != vertices[:, None, None]).all(axis=2)
    edges = _edges(triangles)
    one, other = np.triu_indices(len(edges), 1)
    apart = (edges[one][:, :, None] != edges[other][:, None]).all(axis=(1, 2))
    if part is not None:
        counts &= part[vertices][:, None] != part[triangles[:, 0]]
        apart &= part[edges[one, 0]] != part[edges[other, 0]]
    gaps = gaps[counts & (gaps < reach)]
    start = positions[edges[:, 0]]
    half = (positions[edges[:, 1]] - start) / 2
    middle, length = start + half, np.linalg.norm(half, axis=1)
    one, other = one[apart], other[apart]
    away = middle[other] - middle[one]
    close = np.linalg.norm(away, axis=1) < reach + length[one] + length[other]
    away, u, v = away[close], half[one[close]], half[other[close]]
    lengths = length[one[close]] * length[other[close]]
    angle = np.arccos(np.clip(np.einsum("px,px->p", u, v) / lengths, -1, 1))
    q = np.minimum(np.sin(angle) ** 2 / 0.01, 1)
    between = _between_segments(-u, u, away - v, away + v)
    near = between < reach
    weights = np.concatenate([np.ones(len(gaps)), (q * (2 - q))[near]])
    return np.concatenate([gaps, between[near]]), weights


def surface_repulsion(positions, triangles, distance, epsilon, part=None) -> float:
    """The energy, kJ/mol; `part` are labels of particles, if only different ones count."""
    gaps, weights = surface_pairs(positions, triangles, distance, part)
    return float((weights * core(gaps, distance, epsilon)).sum())


def _phi(x: np.ndarray, attraction: str) -> np.ndarray:
    x = np.clip(x, 1, 3)
    tail = 2 / x**6 - 1 / x**12 if attraction == "LennardJones" else (3 / x**3 - 1 / x**9) / 2
    y = np.clip(x - 2, 0, 1)
    return tail * (1 - 10 * y**3 + 15 * y**4 - 6 * y**5)


def particle_gaps(positions, triangles, particles) -> np.ndarray:
    """The distances of particles and triangles, nm: shape (num_particles, num_triangles)."""
    return np.linalg.norm(nearest(positions[particles], positions[triangles]), axis=2)


def particle_surface(
    positions, triangles, particles, distance, epsilon, adhesion=0.0, radius=0.0, attraction="WCA"
) -> float:
    """The energy, kJ/mol."""
    radius = np.broadcast_to(radius, len(particles))[:, None]
    gap = particle_gaps(positions, triangles, particles) - radius
    energy = core(gap, distance, epsilon).sum()
    if attraction != "WCA":
        seen = _seen(positions[particles], positions[triangles])
        sides = seen[0, :, 1:] - seen[0, :, :1]
        area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        for k in range(3):
            weights = np.full(3, 1 / 6)
            weights[k] = 2 / 3
            away = np.linalg.norm(np.einsum("k,ptkx->ptx", weights, seen), axis=2) - radius
            energy -= adhesion * (area / 6 * _phi(away / distance, attraction)).sum()
    return float(energy)
