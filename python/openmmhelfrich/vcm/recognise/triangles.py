"""Energies of single triangles and of pairs of triangles: areas, volumes, heights."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..._types import Array
from .fit import TOLERANCE, fit_rows, solve, triangle_places
from .source import Bonds

__all__ = [
    "ConeReading",
    "PairReading",
    "RepulsionReading",
    "TriangleReading",
    "read_cones",
    "read_pairs",
    "read_repulsion",
    "read_triangles",
]

_NUM_PLACES = 160
# Of a cutoff, relative: codes print it with six decimals, which is a jump of less than 1e-11 ε.
_CUTOFF_ERROR = 1e-6


@dataclass
class TriangleReading:
    """E = c0 q² + c1 q + c2 of each triangle, q its area or its volume about the origin.

    coefficients: shape (num_trials, num_rows, 3).
    """

    bonds: Bonds
    kind: str
    coefficients: Array


@dataclass
class PairReading:
    """E = c0 q1² + c1 q2² + c2 q1 q2 + c3 q1 + c4 q2 + c5 of pairs of triangles.

    first, second: shape (num_bonds, 3); coefficients: shape (num_trials, num_rows, 6).
    """

    bonds: Bonds
    kind: str
    first: Array
    second: Array
    coefficients: Array


@dataclass
class ConeReading:
    """E = c0 v of triangles with an apex, v the volume of the cone.

    coefficients: shape (num_trials, num_rows, 1).
    """

    bonds: Bonds
    coefficients: Array


@dataclass
class RepulsionReading:
    """E = Σ ε [(m/q)⁸ − (m/q)⁴ + ¼] for q < 2^¼ m, q the area or some of the heights.

    corners: which corners' heights; minimum, epsilon: shape (num_trials, num_rows).
    """

    bonds: Bonds
    kind: str
    corners: tuple[int, ...]
    minimum: Array
    epsilon: Array


def areas(points: Array) -> Array:
    """Of triangles of shape (…, 3, 3), nm²."""
    a, b, c = np.moveaxis(points, -2, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=-1)


def volumes(points: Array) -> Array:
    """Between triangles of shape (…, 3, 3) and the origin, nm³."""
    a, b, c = np.moveaxis(points, -2, 0)
    return np.sum(a * np.cross(b, c), axis=-1) / 6


def heights(points: Array) -> Array:
    """Above each corner's opposite side, of triangles of shape (…, 3, 3), nm."""
    opposite = np.roll(points, -1, axis=-2) - np.roll(points, 1, axis=-2)
    return 2 * areas(points)[..., None] / np.linalg.norm(opposite, axis=-1)


_KINDS = {"area": areas, "volume": volumes}


def read_triangles(bonds: Bonds, trials: list[dict[str, float]]) -> TriangleReading | None:
    """Read a force as quadratic functions of the areas or volumes of triangles."""
    if bonds.num_points != 3:
        return None
    points = triangle_places(_NUM_PLACES, 3, seed=1)
    for kind, measure in _KINDS.items():
        q = measure(points)
        found = fit_rows(bonds, points, np.stack([q**2, q, np.ones_like(q)], axis=1), trials)
        if found is not None and found[..., :2].any():
            return TriangleReading(bonds, kind, found)
    return None


def read_pairs(bonds: Bonds, trials: list[dict[str, float]]) -> PairReading | None:
    """Read a force as quadratic functions of the areas or volumes of two triangles."""
    if bonds.num_points != 6:
        return None
    points = triangle_places(_NUM_PLACES, 6, seed=2)
    # Particle 0 is in the first triangle, with any two of the others.
    for others in combinations(range(1, 6), 2):
        first = [0, *others]
        second = [i for i in range(6) if i not in first]
        for kind, measure in _KINDS.items():
            a, b = measure(points[:, first]), measure(points[:, second])
            columns = [a**2, b**2, a * b, a, b, np.ones_like(a)]
            found = fit_rows(bonds, points, np.stack(columns, axis=1), trials)
            if found is not None and found[..., 2].any():
                return PairReading(
                    bonds, kind, bonds.particles[:, first], bonds.particles[:, second], found
                )
    return None


def read_cones(bonds: Bonds, trials: list[dict[str, float]]) -> ConeReading | None:
    """Read a force as volumes of the cones from triangles to an apex, the last particle."""
    if bonds.num_points != 4:
        return None
    points = triangle_places(_NUM_PLACES, 4, seed=3)
    volume = volumes(points[:, :3] - points[:, 3:])
    found = fit_rows(bonds, points, volume[:, None], trials)
    return None if found is None else ConeReading(bonds, found)


def read_repulsion(bonds: Bonds, trials: list[dict[str, float]]) -> RepulsionReading | None:
    """Read a force as a repulsion at small heights or areas of triangles."""
    if bonds.num_points != 3:
        return None
    reading = None
    bonds.expression.forget_branches()
    minimum = np.empty((len(trials), len(bonds.rows)))
    epsilon = np.empty_like(minimum)
    for row in range(len(bonds.rows)):
        for number, trial in enumerate(trials):
            found = _repulsion(bonds, row, trial)
            if found is None or (reading is not None and found[:2] != reading):
                return None
            reading = found[:2]
            minimum[number, row], epsilon[number, row] = found[2:]
    return RepulsionReading(bonds, *reading, minimum, epsilon)


def _repulsion(bonds: Bonds, row: int, trial: dict[str, float]):
    """(kind, corners, m, ε) of one row in one trial."""
    size = _cutoff(bonds, row, trial)
    if size is None:
        return None
    # Inside of the cutoff, where the energy is a sum of two powers and a constant.
    rng = np.random.default_rng(4)
    upright = np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]])
    rough = upright + 0.12 * rng.normal(size=(4 * _NUM_PLACES, 3, 3))
    inside = rough * rng.uniform(0.3, 0.9, (len(rough), 1, 1)) * size
    for kind in ("height", "area"):
        measure = (lambda p: heights(p)) if kind == "height" else (lambda p: areas(p)[:, None])
        at_cutoff = measure(size * upright[None])[0, 0]
        places = inside[measure(inside).max(axis=1) < 0.99 * at_cutoff][:_NUM_PLACES]
        if len(places) < 40:
            continue
        ratio = at_cutoff / measure(places)
        columns = np.concatenate([ratio**8, ratio**4, np.ones((len(places), 1))], axis=1)
        found = _by_corner(columns, bonds.energies(places, row, trial))
        if found is None:
            continue
        corners, eighth, fourth = found
        minimum = at_cutoff * (-eighth / fourth) ** 0.25
        epsilon = fourth**2 / eighth
        # Places that are drawn can miss a gap as narrow as this.
        if abs(at_cutoff - 2**0.25 * minimum) > _CUTOFF_ERROR * at_cutoff:
            continue
        # The whole energy, on both sides of the cutoff and close to it.
        wide = rough * 10 ** rng.uniform(-0.5, 0.5, (len(rough), 1, 1)) * size
        near = upright * size * (1 + rng.uniform(-1e-3, 1e-3, (100, 1, 1)))
        far = upright * size * 10 ** rng.uniform(0, 4, (50, 1, 1))
        places = np.concatenate([wide, near, far])
        parts = (minimum / measure(places)[:, corners]) ** 4
        ours = epsilon * np.sum(np.maximum(parts - 0.5, 0) ** 2, axis=1)
        theirs = bonds.energies(places, row, trial)
        # The eighth power times ε is what cancels at the cutoff.
        scale = epsilon * (1 + np.sum(parts**2, axis=1))
        if np.all(np.abs(theirs - ours) <= TOLERANCE * scale):
            return kind, tuple(corners), minimum, epsilon
    return None


def _by_corner(columns: Array, energy: Array) -> tuple[list[int], float, float] | None:
    """The corners that count, and their common coefficients of the eighth and fourth power."""
    found = solve(columns, energy)
    if found is None:
        return None
    num = (len(found) - 1) // 2
    eighth, fourth = found[:num], found[num:-1]
    corners = np.flatnonzero(eighth).tolist()
    if not corners or set(corners) != set(np.flatnonzero(fourth).tolist()):
        return None
    a, b = eighth[corners], fourth[corners]
    if np.ptp(a) > 1e-9 * a.max() or np.ptp(b) > 1e-9 * np.abs(b).max():
        return None
    if a[0] <= 0 or b[0] >= 0:
        return None
    return corners, float(a.mean()), float(b.mean())


def _cutoff(bonds: Bonds, row: int, trial: dict[str, float]) -> float | None:
    """The side of the equilateral triangle from which on the energy is zero, nm."""
    upright = np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]])

    def zero(sides: Array) -> Array:
        return bonds.energies(upright * sides[:, None, None], row, trial) == 0

    sides = 10.0 ** np.arange(-4, 7, 0.25)
    above = zero(sides)
    last = int(np.flatnonzero(~above)[-1]) if not above.all() else -1
    if last < 0 or last == len(sides) - 1:
        return None
    low, high = sides[last], sides[last + 1]
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if zero(np.array([middle]))[0] else (middle, high)
    return high
