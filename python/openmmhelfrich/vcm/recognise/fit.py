"""Least squares over random places, and values as functions of global parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..._types import Array
from .source import Bonds

__all__ = ["TOLERANCE", "Scalar", "fit_rows", "resolve", "solve", "spread", "triangle_places"]

#: How well an expression must agree with ours, relative to the sum of its parts.
TOLERANCE = 1e-10
# What adds less than this may be rounding.
_SUSPICIOUS = 1e-5
# Energies that nothing can be divided by, kJ/mol, and that no membrane has.
_SMALLEST = 1e-200
# Within this a fitted value is a number that stands in the expression.
_SAME = 1e-11
_SAME_IN_TRIALS = 1e-9


class _Features(Protocol):
    def __call__(self, points: Array) -> Array: ...


def spread(num: int, rng: np.random.Generator, low: float = -2, high: float = 5) -> Array:
    """Lengths over many orders of magnitude, nm, so that no term hides behind another.

    They are in random order, because the fit sees only half of them.
    """
    return rng.permutation(10 ** np.linspace(low, high, num))


def triangle_places(num: int, num_points: int, seed: int) -> Array:
    """Random places of a few points, of all sizes, away from the origin.

    Returns
    -------
    ndarray, shape (num, num_points, 3)
        nm.
    """
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(num, num_points, 3)) + rng.normal(size=(num, 1, 3))
    return points * spread(num, rng)[:, None, None]


def solve(features: Array, energy: Array) -> Array | None:
    """The coefficients that make a sum of features equal to the energy, everywhere.

    Parameters
    ----------
    features : ndarray, shape (num_places, num_features)
        Columns of very different size are fine, and so are rows.
    energy : ndarray, shape (num_places,)
        The first half is fitted, the second half must follow.

    Returns
    -------
    ndarray, shape (num_features,), or None
        Exactly zero where a feature does not matter. None if the energy is another one.
    """
    result = np.zeros(features.shape[1])
    if not np.isfinite(energy).all():
        return None
    if not energy.any():
        return result
    if np.abs(energy[energy != 0]).min() < _SMALLEST:
        return None
    active = list(range(features.shape[1]))
    found, weight, error = _squares(features, energy, active)
    if found is None or error > TOLERANCE:
        return None
    # Columns that look alike share their rounding; what is not needed is not there.
    for column in [active[i] for i in np.argsort(weight)[:-1] if weight[i] < _SUSPICIOUS]:
        fewer = [k for k in active if k != column]
        without, _, its_error = _squares(features, energy, fewer)
        if without is not None and its_error <= TOLERANCE:
            active, found, error = fewer, without, its_error
    result[active] = found
    return result


def _squares(features: Array, energy: Array, active: list[int]):
    """The coefficients of some columns, how much each matters, and the largest relative error."""
    half = len(energy) // 2
    chosen = features[:, active]
    size = np.abs(energy)
    size = np.maximum(size, size[size > 0].min())
    # What overflows, or is nothing by nothing, is no fit.
    with np.errstate(over="ignore", invalid="ignore"):
        # Several times, because only the result tells how much cancels at each place.
        for _ in range(3):
            scaled = chosen / size[:, None]
            columns = np.abs(scaled[:half]).max(axis=0)
            if not (np.isfinite(columns).all() and (columns > 0).all()):
                return None, None, np.inf
            z = np.linalg.lstsq(scaled[:half] / columns, (energy / size)[:half], rcond=None)[0]
            found = z / columns
            size = np.maximum(np.abs(chosen * found).sum(axis=1), np.abs(energy))
            if not (np.isfinite(found).all() and np.isfinite(size).all()):
                return None, None, np.inf
        error = np.abs(chosen @ found - energy) / size
    return found, np.abs(z), float(error.max())


def fit_rows(
    bonds: Bonds, points: Array, features: Array, trials: list[dict[str, float]]
) -> Array | None:
    """The coefficients of every row of per-bond values, in every trial.

    Returns
    -------
    ndarray, shape (num_trials, num_rows, num_features), or None
        None if one of them is another energy, or zero.
    """
    result = np.empty((len(trials), len(bonds.rows), features.shape[1]))
    # Only the branches that this fit tests count as tested.
    bonds.expression.forget_branches()
    # Row by row, so that a foreign energy is refused after the first.
    for row in range(len(bonds.rows)):
        for number, trial in enumerate(trials):
            found = solve(features, bonds.energies(points, row, trial))
            if found is None:
                return None
            result[number, row] = found
    return result if result.any() else None


@dataclass(frozen=True)
class Scalar:
    """A parameter of one of our forces: a number, or a parameter of the Context, or values."""

    value: float
    context: str = ""
    #: One for each vertex or triangle, None if all are alike.
    values: Array | None = None


def resolve(
    name: str,
    found: Array,
    trials: list[dict[str, float]],
    known: list[float],
    elements: bool = False,
) -> Scalar | str:
    """What a fitted value is: the same number in all trials, or one of the global parameters.

    Parameters
    ----------
    name : str
        What it is, for the reason.
    found : ndarray, shape (num_trials, num_elements)
        The values.
    trials : list of dict
        The values of the global parameters.
    known : list of float
        Numbers that stand in the expressions; a value that is one of them up to rounding is it.
    elements : bool
        Whether each element may have its own value.

    Returns
    -------
    Scalar, or str
        The reason why it can be neither.
    """
    even = np.ptp(found, axis=1) <= _SAME_IN_TRIALS * np.abs(found).max(axis=1)
    if even.all():
        means = found.mean(axis=1)
        if len(trials) > 1 and np.ptp(means) > _SAME_IN_TRIALS * np.abs(means).max():
            for parameter, value in trials[0].items():
                values = np.array([trial[parameter] for trial in trials])
                if np.all(np.abs(values - means) <= _SAME_IN_TRIALS * np.abs(values)):
                    return Scalar(value, parameter)
            return f"its {name} depends on global parameters but is not one of them"
        return Scalar(_tidy(float(means[0]), known))
    if not elements:
        return f"its {name} is not the same everywhere"
    if np.any(np.ptp(found, axis=0) > _SAME_IN_TRIALS * np.abs(found).max(axis=0)):
        return f"its {name} depends on global parameters but is not one of them"
    values = np.array([_tidy(float(value), known) for value in found[0]])
    return Scalar(float(values.mean()), values=values)


def _tidy(value: float, known: list[float]) -> float:
    """The number that was meant, of those written down and those with few digits."""
    for number in known:
        if abs(abs(value) - abs(number)) <= _SAME * abs(value):
            return float(np.copysign(number, value))
    short = float(f"{value:.9g}")
    return short if abs(short - value) <= 1e-13 * abs(value) else value
