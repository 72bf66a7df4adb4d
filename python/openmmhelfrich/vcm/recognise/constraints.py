"""Global area and volume: as sums over pairs of triangles, or as functions of a sum.

½ k (Q − Q0)²/Q0 with Q = Σ q_t is a quadratic form of the q_t. Whichever way its parts are spread
over bonds, they must add up to

    s Σ q_t² + 2 s Σ_{t<u} q_t q_u + l Σ q_t + constant,   s = k / (2 Q0),   l = −k

VCM's constant is not ½ k Q0 exactly, because its (N − 1)/N passes through six decimals; what is
over is kept as a constant energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import openmm as mm

from ..._types import Array
from ..expressions import Expression, ExpressionError
from .fit import resolve, solve, spread
from .fixed import Fixed, formulas, remaining
from .local import checked, constant_offset, known_numbers
from .source import Bonds, Unreadable, global_parameters, list_bonds, read_bonds
from .surface import Component, NotClosed, Surfaces, distinct, parity
from .term import Refused, Term
from .triangles import (
    PairReading,
    TriangleReading,
    read_cones,
    read_triangles,
)

__all__ = ["CollectiveReading", "collective_terms", "pair_term", "read_collective"]

_ERROR = 1e-9
_CLASSES = {"area": "SurfaceAreaForce", "volume": "EnclosedVolumeForce"}
# A quadratic form over more triangles than this has no room; nor has its list of bonds.
_MAX_TRIANGLES = 12_000


def _quadratic_term(
    sources: list[int],
    kind: str,
    components: list[Component],
    form: tuple[Array, Array, Array],
    trials: list[dict[str, float]],
    known: list[float],
) -> Term:
    """The term of s Q² + l Q + constant, each of shape (num_trials,)."""
    square, linear, constant = form
    if np.any(square <= 0) or np.any(linear >= 0):
        raise Refused(f"it is a quadratic function of the {kind}, but has no target above zero")
    scalars = {
        "modulus": resolve("modulus", -linear[:, None], trials, known),
        "target": resolve("target", (-linear / (2 * square))[:, None], trials, known),
    }
    checked(scalars)
    scale = linear**2 / (4 * square)
    offset = constant_offset(constant - scale, scale, scalars["target"])
    return Term(sources, _CLASSES[kind], components, scalars, offset=offset)


# --- pairs -------------------------------------------------------------------------------------


def pair_term(
    pairs: tuple[int, PairReading],
    singles: list[tuple[int, TriangleReading]],
    surfaces: Surfaces,
    trials: list[dict[str, float]],
) -> Term:
    """A global term from a force over pairs of triangles and, if needed, one over triangles.

    Parameters
    ----------
    pairs : (int, PairReading)
        With the index of the force.
    singles : list of (int, TriangleReading)
        Forces of the same kind that may hold the rest.
    surfaces, trials
        As everywhere.

    Raises
    ------
    NotClosed, Refused
        With the reason.
    """
    reason: Exception | None = None
    candidates = [[], *([single] for single in singles)]
    if len(singles) > 1:
        candidates.append(singles)
    for chosen in candidates:
        try:
            return _pair_term(pairs, chosen, surfaces, trials)
        except Refused as refused:
            # What the pairs lack alone is the more telling message.
            reason = reason or refused
    raise reason


def _pair_term(pairs, singles, surfaces: Surfaces, trials) -> Term:
    index, reading = pairs
    listed = np.concatenate(
        [reading.first, reading.second, *(single.bonds.particles for _, single in singles)]
    )
    components = surfaces.components(listed)
    triples = [triple for component in components for triple in sorted(component.triangles)]
    if len(triples) > _MAX_TRIANGLES:
        raise Refused(f"{len(triples)} triangles are too many for a sum over pairs")
    number = {triple: n for n, triple in enumerate(triples)}
    own = np.array([component.triangles[t] for component in components for t in
                    sorted(component.triangles)])  # fmt: skip
    volume = reading.kind == "volume"

    def look_up(rows: Array) -> tuple[Array, Array]:
        different, which = distinct(rows)
        found = [parity(*row) for row in different.tolist()]
        numbers = np.array([number[triple] for triple, _ in found])
        # Volumes change sign with the listing; all are taken in the surface's own orientation.
        signs = np.array([sign for _, sign in found]) * own[numbers]
        return numbers[which], signs[which] if volume else np.ones(len(rows), dtype=int)

    first, sign1 = look_up(reading.first)
    second, sign2 = look_up(reading.second)
    looked_up = [(single, *look_up(single.bonds.particles)) for _, single in singles]

    n, forms, flips = len(triples), [], None
    for trial in range(len(trials)):
        squares, linear, constant = np.zeros(n), np.zeros(n), 0.0
        c = reading.coefficients[trial][reading.bonds.row_of]
        same = first == second
        mixed = c[:, 2] * sign1 * sign2
        squares += np.bincount(first, c[:, 0] + np.where(same, mixed, 0), n)
        squares += np.bincount(second, c[:, 1], n)
        linear += np.bincount(first, c[:, 3] * sign1, n)
        linear += np.bincount(second, c[:, 4] * sign2, n)
        constant += c[:, 5].sum()
        flat = np.minimum(first, second) * n + np.maximum(first, second)
        products = np.bincount(flat[~same], mixed[~same], n * n).reshape(n, n)
        for single, numbers, signs in looked_up:
            c = single.coefficients[trial][single.bonds.row_of]
            squares += np.bincount(numbers, c[:, 0], n)
            linear += np.bincount(numbers, c[:, 1] * signs, n)
            constant += c[:, 2].sum()
        # Each component's volume counts as positive: that is the side where outside is.
        part = np.repeat(np.arange(len(components)), [len(k.triangles) for k in components])
        flips = np.ones(len(components), dtype=int)
        if volume:
            means = np.bincount(part, linear) / np.bincount(part)
            flips = np.where(means > 0, -1, 1)
            products *= flips[part][:, None] * flips[part][None, :]
            linear *= flips[part]
        square = squares.mean()
        upper = products[np.triu_indices(n, 1)]
        if (
            np.any(np.abs(squares - square) > _ERROR * abs(square))
            or np.any(np.abs(upper - 2 * square) > _ERROR * abs(square))
            or np.any(np.abs(linear - linear.mean()) > _ERROR * np.abs(linear).max())
        ):
            raise Refused(
                f"its pairs of triangles do not add up to the square of the total {reading.kind}"
            )
        forms.append((square, linear.mean(), constant))
    form = tuple(np.array(forms).T)
    known = [x for _, r in [pairs, *singles] for x in known_numbers(r.bonds, trials)]
    term = _quadratic_term(
        [index, *(i for i, _ in singles)], reading.kind, components, form, trials, known
    )
    _decide(components, flips, volume)
    return term


def _decide(components: list[Component], signs, volume: bool) -> None:
    if volume:
        for component, sign in zip(components, signs, strict=True):
            if not component.decide(int(sign)):
                raise Refused("another force takes the other side of its surface for the outside")


# --- functions of a sum ------------------------------------------------------------------------


@dataclass
class CollectiveReading:
    """E = Σ_i (s_i Q_i² + l_i Q_i) + constant of the collective variables of one force.

    globals: the global parameters that it depends on, with their defaults. Of each variable: its
    kind, components and the signs of their volumes; form has shape (num_trials, num_variables, 2),
    constant (num_trials,).
    """

    force: mm.Force
    expression: Expression
    globals: dict[str, float]
    inner: list[Bonds]
    kinds: list[str]
    components: list[list[Component]]
    signs: list[Array]
    form: Array
    constant: Array

    def forces(self, positions: Array) -> tuple[float, Array, float, Array]:
        """As `Bonds.forces`."""
        parts = [bonds.forces(positions) for bonds in self.inner]
        names = [self.force.getCollectiveVariableName(i) for i in range(len(parts))]
        variables = {name: part[0] for name, part in zip(names, parts, strict=True)}
        variables |= self.globals
        energy, slopes = self.expression.gradient(variables)
        forces, magnitudes = np.zeros_like(positions), np.zeros_like(positions)
        magnitude = abs(float(energy))
        for name, part, linear in zip(names, parts, self.form[0, :, 1], strict=True):
            forces += float(slopes[name]) * part[1]
            # The slope itself is a difference of two numbers of the size of the modulus.
            magnitudes += abs(linear) * part[3]
            magnitude += abs(linear) * part[2]
        return float(energy), forces, magnitude, magnitudes


def read_collective(
    force: mm.Force,
    surfaces: Surfaces,
    trials: list[dict[str, float]],
    fixed: dict[str, Fixed],
) -> CollectiveReading:
    """Read a CustomCVForce as a quadratic function of areas and volumes.

    Parameters
    ----------
    force, surfaces, trials
        As everywhere.
    fixed : dict
        What its global parameters are that do not vary by themselves, and those of its variables.

    Raises
    ------
    Unreadable, NotClosed, Refused
        With the reason.
    """
    num = force.getNumCollectiveVariables()
    if force.getNumTabulatedFunctions():
        raise Unreadable("its expression has tabulated functions")
    names = [force.getCollectiveVariableName(i) for i in range(num)]
    outer = {name: f for name, f in fixed.items() if name not in names}
    try:
        expression = Expression(force.getEnergyFunction(), given=formulas(outer))
    except ExpressionError as reason:
        raise Unreadable(f"its expression is not understood: {reason}") from None
    globals_ = remaining(global_parameters(force), outer)
    unknown = expression.variables - set(names) - set(globals_)
    if unknown or num == 0:
        raise Unreadable("its expression has unknown variables")
    inner, kinds, components, signs, factors = [], [], [], [], []
    for i, name in enumerate(names):
        bonds = read_bonds(list_bonds(force.getCollectiveVariable(i)), fixed)
        kind, parts, sign, factor = _sum(name, bonds, surfaces)
        inner.append(bonds)
        kinds.append(kind)
        components.append(parts)
        signs.append(sign)
        factors.append(factor)

    rng = np.random.default_rng(8)
    places = 120 * num
    x = np.stack([spread(places, rng, -2, 11) for _ in names], axis=1)
    x *= rng.choice([-1, 1], x.shape)
    columns = np.concatenate([x**2, x, np.ones((places, 1))], axis=1)
    form = np.empty((len(trials), num, 2))
    constant = np.empty(len(trials))
    for t, trial in enumerate(trials):
        variables = {**trial, **dict(zip(names, x.T, strict=True))}
        energy = np.broadcast_to(expression.evaluate(variables), (places,))
        found = solve(columns, energy)
        if found is None:
            raise Unreadable("it is not a quadratic function of each of its collective variables")
        form[t, :, 0] = found[:num] * np.square(factors)
        form[t, :, 1] = found[num : 2 * num] * factors
        constant[t] = found[-1]
    if expression.untested_branches(globals_):
        raise Unreadable("its expression has branches that were never taken")
    return CollectiveReading(
        force, expression, globals_, inner, kinds, components, signs, form, constant
    )


def _sum(name: str, bonds: Bonds, surfaces: Surfaces) -> tuple[str, list[Component], Array, float]:
    """What a collective variable adds up: its kind, surfaces, the sign of each, and a factor."""
    if bonds.globals:
        raise Unreadable(f"its collective variable {name} has global parameters")
    triangle = read_triangles(bonds, [{}])
    if triangle is not None:
        c = triangle.coefficients[0][bonds.row_of]
        if c[:, 0].any() or c[:, 2].any():
            raise Unreadable(f"its collective variable {name} is not a sum of areas or volumes")
        kind, rows, factor = triangle.kind, bonds.particles, c[:, 1]
        faces = [(parity(*row), f) for row, f in zip(rows.tolist(), factor.tolist(), strict=True)]
    else:
        cones = read_cones(bonds, [{}])
        if cones is None:
            raise Unreadable(f"its collective variable {name} is not a sum of areas or volumes")
        kind, faces = "volume", []
        for row, f in zip(
            bonds.particles.tolist(), cones.coefficients[0][bonds.row_of, 0].tolist(), strict=True
        ):
            a, b, c, apex = row
            # A cone is the sum of what its four faces enclose with the origin; inner ones cancel.
            for face in ((a, b, c), (b, a, apex), (c, b, apex), (a, c, apex)):
                faces.append((parity(*face), f))
    if bonds.expression.untested_branches():
        raise Unreadable(f"its collective variable {name} has branches that were never taken")
    totals: dict[tuple[int, int, int], float] = {}
    for (triple, sign), f in faces:
        totals[triple] = totals.get(triple, 0.0) + f * (sign if kind == "volume" else 1)
    largest = max(abs(f) for f in totals.values())
    totals = {triple: f for triple, f in totals.items() if abs(f) > _ERROR * largest}
    components = surfaces.components(np.array(list(totals)))
    own = {t: s for component in components for t, s in component.triangles.items()}
    if kind == "area":
        own = dict.fromkeys(own, 1)
    values = np.array([totals[t] * own[t] for c in components for t in c.triangles])
    if np.any(np.abs(np.abs(values) - largest) > _ERROR * largest):
        raise Unreadable(f"its collective variable {name} does not weigh all triangles alike")
    signs = np.array(
        [np.sign(totals[t] * own[t]) for c in components for t in list(c.triangles)[:1]]
    )
    expected = np.repeat(signs, [len(c.triangles) for c in components])
    if np.any(np.sign(values) != expected) or (kind == "area" and np.ptp(signs) > 0):
        raise Unreadable(f"its collective variable {name} has triangles of both orientations")
    if kind == "area":
        return kind, components, np.ones(len(signs)), float(signs[0] * largest)
    return kind, components, signs, float(largest)


def collective_terms(
    index: int, reading: CollectiveReading, trials: list[dict[str, float]]
) -> list[Term]:
    """A global term for each collective variable.

    Raises
    ------
    Refused
        With the reason.
    """
    terms: list[Term] = []
    known = [*reading.expression.literals, *(abs(x) for x in trials[0].values())]
    rest = reading.constant.copy()
    for i, kind in enumerate(reading.kinds):
        square, linear = reading.form[:, i].T.copy()
        signs = reading.signs[i]
        if kind == "volume" and np.all(linear > 0):
            # The sum runs over the inside-out surface, and its target is negative.
            signs, linear = -signs, -linear
        expected = linear**2 / (4 * np.where(square == 0, np.nan, square))
        last = i == len(reading.kinds) - 1
        constant = rest if last else expected
        rest = rest - expected
        components = reading.components[i]
        form = (square, linear, constant)
        terms.append(_quadratic_term([index], kind, components, form, trials, known))
        _decide(components, signs, kind == "volume")
    return terms


# The errors that callers handle.
ERRORS = (NotClosed, Refused, Unreadable)
