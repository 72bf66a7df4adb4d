"""Dihedral energies: functions of the angle between two neighbouring triangles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..._types import Array
from .fit import fit_rows, spread
from .source import Bonds

__all__ = ["FORMS", "EdgeReading", "read_edges"]

#: As DihedralForce has them; u is 1 − cos φ, f is φ.
FORMS = {
    "Quartic": lambda u, f: u**2,
    "Cosine": lambda u, f: u,
    "Exp": lambda u, f: 0.5 * np.expm1(2 * u),
    "SmoothExp": lambda u, f: 0.04 * np.expm1(10 * u),
    "SmoothExp46": lambda u, f: 0.5 * (np.expm1(2 * u) - f**2),
}
_NUM_PLACES = 400


@dataclass
class EdgeReading:
    """E = K f(φ) + constant of each edge.

    edges: shape (num_bonds, 4), wing, edge, edge, wing; stiffness, constant: shape
    (num_trials, num_rows).
    """

    bonds: Bonds
    form: str
    edges: Array
    stiffness: Array
    constant: Array


def _angles(points: Array) -> Array:
    """φ of the edge between the second and the third point, either sign."""
    u, v, w = (points[:, i + 1] - points[:, i] for i in range(3))
    first, second = np.cross(u, v), np.cross(v, w)
    sine = np.linalg.norm(v, axis=1) * np.sum(u * second, axis=1)
    # Flat is where the wings lie on opposite sides, which torsions call π.
    return np.arctan2(-sine, -np.sum(first * second, axis=1))


def _places(seed: int = 6) -> Array:
    """Pairs of triangles at all angles but the smallest, where the energies are rounding.

    Returns
    -------
    ndarray, shape (num_places, 4, 3)
        Wing, edge, edge, wing, nm.
    """
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.15, 3.1, _NUM_PLACES) * rng.choice([-1, 1], _NUM_PLACES)
    length = rng.uniform(0.7, 1.4, (3, _NUM_PLACES))
    along = rng.uniform(0.2, 0.8, (2, _NUM_PLACES)) * length[0]
    points = np.zeros((_NUM_PLACES, 4, 3))
    points[:, 2, 0] = length[0]
    points[:, 0, :2] = np.stack([along[0], length[1]], axis=1)
    points[:, 3, 0] = along[1]
    points[:, 3, 1:] = (-length[2] * [np.cos(angle), np.sin(angle)]).T
    rotations = np.linalg.qr(rng.normal(size=(_NUM_PLACES, 3, 3)))[0]
    points = np.einsum("mab,mjb->mja", rotations, points) + rng.normal(size=(_NUM_PLACES, 1, 3))
    return points * spread(_NUM_PLACES, rng, -2, 4)[:, None, None]


def read_edges(bonds: Bonds, trials: list[dict[str, float]]) -> EdgeReading | None:
    """Read a force as one of the functions of the dihedral angle that we have."""
    if bonds.num_points != 4:
        return None
    places = _places()
    for edge in ((1, 2), *(pair for pair in combinations(range(4), 2) if pair != (1, 2))):
        wings = [i for i in range(4) if i not in edge]
        order = [wings[0], *edge, wings[1]]
        points = np.empty_like(places)
        points[:, order] = places
        angle = _angles(places)
        u = 2 * np.sin(0.5 * angle) ** 2
        columns = [form(u, angle) for form in FORMS.values()]
        columns.append(np.ones_like(u))
        found = fit_rows(bonds, points, np.stack(columns, axis=1), trials)
        if found is None:
            continue
        used = np.flatnonzero(found[..., :-1].any(axis=(0, 1)))
        if len(used) != 1:
            return None
        return EdgeReading(
            bonds,
            list(FORMS)[used[0]],
            bonds.particles[:, order],
            found[..., used[0]],
            found[..., -1],
        )
    return None
