"""Bending energies: what the energy of a vertex and its ring of neighbours is made of.

The quantities are those of Farnudi, Ejtehadi and Everaers, doi:10.1103/PhysRevE.108.015301, with J,
S and n·S of (B7–B11), the barycentric and the Voronoi area, and Espriu's sum of neighbours::

    E_i = κ [ c²/a / 2 − C0 c + C0² a / 2 ]

so every energy is a sum of the columns of `FEATURES`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..._types import Array
from .fit import fit_rows, spread
from .source import Bonds

__all__ = ["FEATURES", "SCHEMES", "RingReading", "read_rings", "ring_features"]

FEATURES = (
    "J²/aB", "J²/aV", "S²/aV", "S²/aB", "E²/aB", "J", "nS", "|S|", "nE", "|E|", "aB", "aV",
    "J±²/aB", "J±²/aV",
)  # fmt: skip
#: scheme: (square, linear, linear unsigned, area), as columns of FEATURES.
SCHEMES = {
    "Julicher": (0, 5, None, 10),
    "JulicherVoronoi": (1, 5, None, 11),
    "GompperKroll": (2, 6, 7, 11),
    "GompperKrollBarycentric": (3, 6, 7, 10),
    "Espriu": (4, 8, 9, 10),
}
#: Columns that change sign with the orientation of the ring.
ODD = np.isin(np.arange(len(FEATURES)), (5, 6, 8))
#: Columns that look like a bending energy and are not one: angles without their sign.
UNSIGNED_ANGLES = (12, 13)
_NUM_PLACES = 400


@dataclass
class RingReading:
    """What the energies of one force's bonds are made of.

    rings: shape (num_bonds, 1 + degree), the vertex and its neighbours in cyclic order;
    coefficients: shape (num_trials, num_rows, num_features).
    """

    bonds: Bonds
    rings: Array
    coefficients: Array


def ring_features(points: Array) -> Array:
    """The columns of FEATURES.

    Parameters
    ----------
    points : ndarray, shape (num_places, 1 + degree, 3)
        The vertex and its ring, counter-clockwise seen from outside, nm.

    Returns
    -------
    ndarray, shape (num_places, num_features)
    """
    spokes = points[:, 1:] - points[:, :1]
    following = np.roll(spokes, -1, axis=1)
    normals = np.cross(spokes, following)
    double_areas = np.linalg.norm(normals, axis=2)
    lengths = np.linalg.norm(spokes, axis=2)
    before, before_normals = np.roll(spokes, 1, axis=1), np.roll(normals, 1, axis=1)

    # Around spoke j: the triangle before it, then the one after it. Convex edges are positive.
    sine = np.einsum("mja,mja->mj", np.cross(normals, before_normals), spokes) / lengths
    cosine = np.einsum("mja,mja->mj", before_normals, normals)
    angles = np.arctan2(sine, cosine)
    curvature = 0.5 * np.sum(lengths * angles, axis=1)
    unsigned = 0.5 * np.sum(lengths * np.abs(angles), axis=1)

    def cotangent(apex, other):
        # At the ring's vertex `apex`, between the directions to the centre and to `other`.
        u, v = -apex, other - apex
        return np.einsum("mja,mja->mj", u, v) / np.linalg.norm(np.cross(u, v), axis=2)

    weights = cotangent(before, spokes) + cotangent(following, spokes)
    barycentric = double_areas.sum(axis=1) / 6
    voronoi = np.sum(weights * lengths**2, axis=1) / 8
    vector = -0.5 * np.sum(weights[:, :, None] * spokes, axis=1)
    neighbours = -np.sum(spokes, axis=1) / np.sqrt(3)

    corner = np.arctan2(double_areas, np.einsum("mja,mja->mj", spokes, following))
    normal = np.sum((corner / double_areas)[:, :, None] * normals, axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    s2, e2 = np.sum(vector**2, axis=1), np.sum(neighbours**2, axis=1)
    columns = [
        curvature**2 / barycentric,
        curvature**2 / voronoi,
        s2 / voronoi,
        s2 / barycentric,
        e2 / barycentric,
        curvature,
        np.sum(normal * vector, axis=1),
        np.sqrt(s2),
        np.sum(normal * neighbours, axis=1),
        np.sqrt(e2),
        barycentric,
        voronoi,
        unsigned**2 / barycentric,
        unsigned**2 / voronoi,
    ]
    return np.stack(columns, axis=1)


def ring_places(degree: int, seed: int = 5) -> Array:
    """Vertices with rings: bulges, dents and saddles of all sizes, with convex and concave edges.

    Returns
    -------
    ndarray, shape (num_places, 1 + degree, 3)
        nm.
    """
    rng = np.random.default_rng(seed)
    num = _NUM_PLACES
    turn = 2 * np.pi * (np.arange(degree) + rng.uniform(-0.25, 0.25, (4 * num, degree))) / degree
    radius = rng.uniform(0.7, 1.4, (4 * num, degree))
    rough = 0.35 * min(1.0, 6 / degree)
    height = rough * rng.normal(size=(4 * num, degree)) + 0.4 * rng.normal(size=(4 * num, 1))
    ring = np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=2)
    points = np.concatenate([np.zeros((4 * num, 1, 3)), ring], axis=1)
    # Near the zeros of the areas and curvatures, rounding takes over in some ways of writing them.
    columns = np.abs(ring_features(points))
    good = columns[:, 11] > 0.2 * columns[:, 10]
    good &= (columns[:, 5:10] > 0.2 * np.sqrt(columns[:, 10:11])).all(axis=1)
    points = points[good][:num]
    rotations = np.linalg.qr(rng.normal(size=(len(points), 3, 3)))[0]
    rotations *= np.sign(np.linalg.det(rotations))[:, None, None]
    points = np.einsum("mab,mjb->mja", rotations, points) + rng.normal(size=(len(points), 1, 3))
    return points * spread(len(points), rng, -2, 4)[:, None, None]


def read_rings(bonds: Bonds, trials: list[dict[str, float]]) -> RingReading | str | None:
    """Read a force as energies of vertices.

    The vertex is the first or the last particle of a bond, the others are its neighbours in cyclic
    order.

    Returns
    -------
    RingReading, str or None
        None if it is something else, the reason if it is nearly one of our energies.
    """
    degree = bonds.num_points - 1
    if degree < 3:
        return None
    points = ring_places(degree)
    features = ring_features(points)
    natural = np.arange(degree + 1)
    for order in (natural, np.roll(natural, 1)):
        # order[i] is the place in the bond of what is i-th here.
        given = np.empty_like(points)
        given[:, order] = points
        for used in (slice(0, 12), slice(0, 14)):
            found = fit_rows(bonds, given, features[:, used], trials)
            if found is None:
                continue
            if found.shape[2] == 14:
                return (
                    "its edges' angles have no sign: concave edges count as convex ones, which "
                    "none of our bending energies does"
                )
            return RingReading(
                bonds, bonds.particles[:, order], np.pad(found, ((0, 0), (0, 0), (0, 2)))
            )
    return None
