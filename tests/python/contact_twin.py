"""Contacts by brute force, written without a look at the crate: every pair, no lists, no grid."""

from __future__ import annotations

import numpy as np


def _segments(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The points of segments nearest to points, shape (num_points, num_segments, 3)."""
    side = end - start
    along = np.einsum("psx,sx->ps", points[:, None] - start, side) / (side**2).sum(axis=1)
    return start + np.clip(along, 0, 1)[..., None] * side


def nearest(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The points of triangles nearest to points.

    points: shape (num_points, 3); corners: shape (num_triangles, 3, 3). Returns shape
    (num_points, num_triangles, 3).
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = np.einsum("ptx,tx->pt", points[:, None] - corners[:, 0], normal)
    foot = points[:, None] - height[..., None] * normal
    inside = np.ones(height.shape, dtype=bool)
    candidates = []
    for k in range(3):
        start, end = corners[:, k], corners[:, (k + 1) % 3]
        turn = np.cross(end - start, foot - start)
        inside &= np.einsum("ptx,tx->pt", turn, normal) >= 0
        candidates.append(_segments(points, start, end))
    far = [np.linalg.norm(points[:, None] - candidate, axis=2) for candidate in candidates]
    best = np.take_along_axis(
        np.stack(candidates), np.argmin(far, axis=0)[None, ..., None], axis=0
    )[0]
    return np.where(inside[..., None], foot, best)


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
        side = end - start
        along = np.einsum("px,px->p", point - start, side) / (side**2).sum(axis=1)
        foot = start + np.clip(along, 0, 1)[:, None] * side
        return np.linalg.norm(point - foot, axis=1)

    return np.min([plane, to(a, c, d), to(b, c, d), to(c, a, b), to(d, a, b)], axis=0)


def surface_repulsion(positions, triangles, distance, epsilon, part=None) -> float:
    """The energy, kJ/mol; `part` are labels of particles, if only different ones count."""
    vertices = np.unique(triangles)
    gap = np.linalg.norm(
        positions[vertices][:, None] - nearest(positions[vertices], positions[triangles]), axis=2
    )
    counts = (triangles[None] != vertices[:, None, None]).all(axis=2)
    edges = _edges(triangles)
    one, other = np.triu_indices(len(edges), 1)
    apart = (edges[one][:, :, None] != edges[other][:, None]).all(axis=(1, 2))
    if part is not None:
        counts &= part[vertices][:, None] != part[triangles[:, 0]]
        apart &= part[edges[one, 0]] != part[edges[other, 0]]
    energy = core(gap[counts], distance, epsilon).sum()
    one, other = edges[one[apart]], edges[other[apart]]
    a, b, c, d = (positions[ends] for ends in (*one.T, *other.T))
    middles = np.linalg.norm(a + b - c - d, axis=1) / 2
    lengths = np.linalg.norm(b - a, axis=1) + np.linalg.norm(d - c, axis=1)
    close = middles < distance + lengths / 2
    a, b, c, d = (x[close] for x in (a, b, c, d))
    angle = np.arccos(
        np.clip(
            np.einsum("px,px->p", b - a, d - c)
            / np.linalg.norm(b - a, axis=1)
            / np.linalg.norm(d - c, axis=1),
            -1,
            1,
        )
    )
    q = np.minimum(np.sin(angle) ** 2 / 0.01, 1)
    return float(
        energy + (q * (2 - q) * core(_between_segments(a, b, c, d), distance, epsilon)).sum()
    )


def _phi(x: np.ndarray, attraction: str) -> np.ndarray:
    x = np.clip(x, 1, 3)
    tail = 2 / x**6 - 1 / x**12 if attraction == "LennardJones" else (3 / x**3 - 1 / x**9) / 2
    y = np.clip(x - 2, 0, 1)
    return tail * (1 - 10 * y**3 + 15 * y**4 - 6 * y**5)


def particle_surface(
    positions, triangles, particles, distance, epsilon, adhesion=0.0, radius=0.0, attraction="WCA"
) -> float:
    """The energy, kJ/mol."""
    corners = positions[triangles]
    points = positions[particles]
    radius = np.broadcast_to(radius, len(particles))[:, None]
    gap = np.linalg.norm(points[:, None] - nearest(points, corners), axis=2) - radius
    energy = core(gap, distance, epsilon).sum()
    if attraction != "WCA":
        area = np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        for k in range(3):
            weights = np.full(3, 1 / 6)
            weights[k] = 2 / 3
            inner = np.einsum("k,tkx->tx", weights, corners)
            away = np.linalg.norm(points[:, None] - inner, axis=2) - radius
            energy -= adhesion * (area / 6 * _phi(away / distance, attraction)).sum()
    return float(energy)


def crossings(positions: np.ndarray, triangles: np.ndarray) -> list[tuple[int, int, int]]:
    """Edges that pass through triangles with which they share no corner: (end, end, triangle)."""
    edges = _edges(triangles)
    found = []
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    low = np.minimum(np.minimum(a, b), c)
    high = np.maximum(np.maximum(a, b), c)
    normal = np.cross(b - a, c - a)
    for p, q in edges:
        start, end = positions[p], positions[q]
        near = ((np.minimum(start, end) <= high) & (np.maximum(start, end) >= low)).all(axis=1)
        near &= ~np.isin(triangles, (p, q)).any(axis=1)
        t = np.flatnonzero(near)
        before = np.einsum("tx,tx->t", start - a[t], normal[t])
        after = np.einsum("tx,tx->t", end - a[t], normal[t])
        t, before, after = (x[before * after < 0] for x in (t, before, after))
        at = start + (before / (before - after))[:, None] * (end - start)
        for one, other in ((a, b), (b, c), (c, a)):
            keep = np.einsum("tx,tx->t", np.cross(other[t] - one[t], at - one[t]), normal[t]) > 0
            t, at = t[keep], at[keep]
        found += [(int(p), int(q), int(triangle)) for triangle in t]
    return found
