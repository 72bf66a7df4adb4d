"""Forces on single triangles and edges: heights, areas of triangles, dihedrals."""

from __future__ import annotations

import numpy as np

from ..._types import Array
from .edges import EdgeReading
from .fit import Scalar, resolve
from .source import Bonds
from .surface import Surfaces, parity
from .term import Offset, Refused, Term
from .triangles import RepulsionReading, TriangleReading

__all__ = ["checked", "constant_offset", "dihedral_term", "repulsion_term", "triangle_area_term"]

# Constants that are rounding of the energies they come from.
_ROUNDING = 1e-10


def known_numbers(bonds: Bonds, trials: list[dict[str, float]]) -> list[float]:
    """The numbers that a force's author wrote down."""
    values = np.abs(bonds.rows).ravel().tolist()
    return [*bonds.expression.literals, *values, *(abs(x) for x in trials[0].values())]


def checked(scalars: dict[str, Scalar | str]) -> dict[str, Scalar]:
    """The scalars.

    Raises
    ------
    Refused
        If one is a reason instead.
    """
    for scalar in scalars.values():
        if isinstance(scalar, str):
            raise Refused(scalar)
    return scalars


def constant_offset(found: Array, scale: Array, target: Scalar | None = None) -> Offset | None:
    """What is constant in an energy.

    Parameters
    ----------
    found : ndarray, shape (num_trials,)
        The constant, kJ/mol.
    scale : ndarray, shape (num_trials,)
        Of the energies it is a difference of, kJ/mol; what is much smaller is rounding.
    target : Scalar, optional
        A parameter that the constant may be proportional to.

    Raises
    ------
    Refused
        If it depends on global parameters in another way.
    """
    if np.all(np.abs(found) <= _ROUNDING * scale):
        return None
    if np.ptp(found) <= _ROUNDING * scale.max():
        return Offset(float(found[0]))
    if target is not None and target.context:
        return Offset(0.0, target.context, float(found[0] / target.value))
    raise Refused("the constant in its energy depends on global parameters")


def _each_once(rows: Array, what: str) -> None:
    seen: set[tuple[int, ...]] = set()
    for row in rows.tolist():
        key = tuple(sorted(row))
        if key in seen:
            raise Refused(f"it has the {what} of particles {key} twice")
        seen.add(key)


def _vote(components, listed: Array) -> None:
    home = {triple: c for c in components for triple in c.triangles}
    for row in listed.tolist():
        triple, sign = parity(*row)
        home[triple].vote(sign * home[triple].triangles[triple], 1e-3)


def repulsion_term(
    index: int, reading: RepulsionReading, surfaces: Surfaces, trials: list[dict[str, float]]
) -> Term:
    """Repulsion at small heights or small areas."""
    bonds = reading.bonds
    components = surfaces.components(bonds.particles)
    num = sum(len(component.triangles) for component in components)
    per_bond = len(reading.corners)
    if reading.kind == "height":
        tips = bonds.particles[:, list(reading.corners)]
        pairs = {
            (parity(*row)[0], tip)
            for row, its in zip(bonds.particles.tolist(), tips.tolist(), strict=True)
            for tip in its
        }
        if len(pairs) != 3 * num or per_bond * len(bonds.particles) != 3 * num:
            raise Refused(f"it has not each of the {3 * num} heights of its triangles once")
        name, cls = "minHeight", "TriangleHeightForce"
    else:
        _each_once(bonds.particles, "triangle")
        name, cls = "minArea", "TriangleAreaRepulsionForce"
    _vote(components, bonds.particles)
    known = known_numbers(bonds, trials)
    scalars = {
        name: resolve("cutoff", reading.minimum[:, bonds.row_of], trials, known),
        "epsilon": resolve("strength", reading.epsilon[:, bonds.row_of], trials, known),
    }
    return Term([index], cls, components, checked(scalars))


def triangle_area_term(
    index: int, reading: TriangleReading, surfaces: Surfaces, trials: list[dict[str, float]]
) -> Term:
    """A target for the area of each triangle."""
    bonds = reading.bonds
    if reading.kind != "area":
        raise Refused("it is a function of the volumes under single triangles, not of their sum")
    second, first, constant = np.moveaxis(reading.coefficients[:, bonds.row_of], -1, 0)
    if np.any(second <= 0) or np.any(first >= 0):
        raise Refused("it is a function of single triangles' areas, but has no target area")
    components = surfaces.components(bonds.particles)
    _each_once(bonds.particles, "triangle")
    _vote(components, bonds.particles)
    order = np.lexsort(np.sort(bonds.particles, axis=1).T[::-1])
    # Triangles are in ascending order within each component, as Component.outward has them.
    home = {triple: n for n, c in enumerate(components) for triple in c.triangles}
    key = [home[parity(*bonds.particles[bond].tolist())[0]] for bond in order]
    order = order[np.argsort(key, kind="stable")]
    target = -first / (2 * second)
    known = known_numbers(bonds, trials)
    scalars = {
        "modulus": resolve("modulus", -first[:, order], trials, known),
        "target": resolve("target", target[:, order], trials, known, elements=True),
    }
    scale = second * target**2
    if np.any(np.abs(constant - scale) > _ROUNDING * scale):
        # Ours with a constant would be equal, but this is what is left of a sum over pairs.
        raise Refused("it is a part of a function of the total area, of which the rest is missing")
    return Term([index], "TriangleAreaForce", components, checked(scalars))


def dihedral_term(
    index: int, reading: EdgeReading, surfaces: Surfaces, trials: list[dict[str, float]]
) -> Term:
    """A function of the angle at each edge."""
    bonds, edges = reading.bonds, reading.edges
    triangles = np.concatenate([edges[:, :3], edges[:, [1, 3, 2]]])
    components = surfaces.components(triangles)
    _each_once(edges[:, 1:3], "edge")
    num = sum(len(component.triangles) for component in components) * 3 // 2
    if len(edges) != num:
        raise Refused(f"it has {len(edges)} of the {num} edges of its triangles")
    _vote(components, triangles)
    stiffness = reading.stiffness[:, bonds.row_of]
    scalars = {"stiffness": resolve("stiffness", stiffness, trials, known_numbers(bonds, trials))}
    if np.any(stiffness <= 0):
        raise Refused("its stiffness is not positive")
    offset = constant_offset(
        reading.constant[:, bonds.row_of].sum(axis=1),
        stiffness.sum(axis=1),
        scalars["stiffness"] if isinstance(scalars["stiffness"], Scalar) else None,
    )
    return Term(
        [index], "DihedralForce", components, checked(scalars), form=reading.form, offset=offset
    )
