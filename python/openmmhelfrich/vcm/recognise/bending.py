"""Bending forces from the energies of vertices, which come in one force for each degree."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ..._types import Array
from .fit import Scalar, resolve
from .rings import ODD, SCHEMES, RingReading
from .surface import Component, NotClosed, Surfaces, parity
from .term import Refused, Term

__all__ = ["bending_terms"]

_ERROR = 1e-9


def bending_terms(
    readings: list[tuple[int, RingReading]], surfaces: Surfaces, trials: list[dict[str, float]]
) -> tuple[list[Term], dict[int, str]]:
    """Put the readings of one force group together.

    Parameters
    ----------
    readings : list of (int, RingReading)
        With the index of each force in its System.
    surfaces : Surfaces
        Where triangles are looked up.
    trials : list of dict
        The values of the global parameters.

    Returns
    -------
    list of Term, dict
        The forces, and the reasons for the indices of those that are left alone.
    """
    terms, reasons = [], {}
    for cluster in _clusters(readings):
        try:
            terms.append(_term(cluster, surfaces, trials))
        except (NotClosed, Refused) as reason:
            reasons |= {index: str(reason) for index, _ in cluster}
    return terms, reasons


def _clusters(readings: list[tuple[int, RingReading]]) -> list[list[tuple[int, RingReading]]]:
    """Readings that have particles in common, directly or through others."""
    clusters: list[tuple[set[int], list[tuple[int, RingReading]]]] = []
    for index, reading in readings:
        particles, members = set(reading.rings.ravel().tolist()), [(index, reading)]
        apart = []
        for others, its in clusters:
            if others & particles:
                particles |= others
                members = its + members
            else:
                apart.append((others, its))
        clusters = [*apart, (particles, members)]
    return [sorted(members, key=lambda pair: pair[0]) for _, members in clusters]


def _term(
    cluster: list[tuple[int, RingReading]], surfaces: Surfaces, trials: list[dict[str, float]]
) -> Term:
    triangles = []
    for _, reading in cluster:
        centre, ring = reading.rings[:, :1], reading.rings[:, 1:]
        following = np.roll(ring, -1, axis=1)
        fan = np.stack([np.broadcast_to(centre, ring.shape), ring, following], axis=2)
        triangles.append(fan.reshape(-1, 3))
    components = surfaces.components(np.concatenate(triangles))
    home = {v: component for component in components for v in component.vertices}
    degree: dict[int, int] = defaultdict(int)
    for component in components:
        for triple in component.triangles:
            for v in triple:
                degree[v] += 1

    vertices = sorted(home)
    row_of = {v: row for row, v in enumerate(vertices)}
    totals = np.zeros((len(trials), len(vertices), len(ODD)))
    covered = np.zeros(len(vertices), dtype=bool)
    for pass_ in ("vote", "add"):
        if pass_ == "add":
            # The sign of C0 is taken against this side, which must not change any more.
            for component in components:
                component.decide(component.sign)
        for _, reading in cluster:
            coefficients = reading.coefficients[:, reading.bonds.row_of]
            odd = coefficients[..., ODD].any(axis=(0, 2))
            for bond, (v, *ring) in enumerate(reading.rings.tolist()):
                if len(ring) != degree[v]:
                    raise Refused(
                        f"the ring of particle {v} has {len(ring)} neighbours, but {degree[v]} "
                        "triangles meet there"
                    )
                sign = _orientation(home[v], v, ring)
                if pass_ == "vote":
                    # Where angles have a sign, the author had to list the rings with care.
                    home[v].vote(sign, 1000.0 if odd[bond] else 1.0)
                    continue
                flips = np.where(ODD, sign * home[v].sign, 1)
                totals[:, row_of[v]] += coefficients[:, bond] * flips
                covered[row_of[v]] = True
    if not covered.all():
        missing = vertices[int(np.flatnonzero(~covered)[0])]
        raise Refused(f"particle {missing} is in rings but has no energy of its own")

    known = [x for _, reading in cluster for x in reading.bonds.expression.literals]
    known += [x for _, reading in cluster for x in np.abs(reading.bonds.rows).ravel().tolist()]
    known += [abs(x) for x in trials[0].values()]
    scheme, unsigned, rigidity, curvature = _scheme(totals)
    scalars = {
        "rigidity": resolve("rigidity", rigidity, trials, known, elements=True),
        "spontaneousCurvature": Scalar(0.0)
        if not curvature.any()
        else resolve("spontaneous curvature", curvature, trials, known, elements=True),
    }
    for scalar in scalars.values():
        if isinstance(scalar, str):
            raise Refused(scalar)
    return Term(
        [index for index, _ in cluster],
        "BendingForce",
        components,
        scalars,
        form=scheme,
        unsigned=unsigned,
    )


def _orientation(component: Component, vertex: int, ring: list[int]) -> int:
    """+1 if the ring runs as the component's triangles do.

    Raises
    ------
    Refused
        If it is not the ring of the surface.
    """
    signs = set()
    for b, c in zip(ring, ring[1:] + ring[:1], strict=True):
        triple, sign = parity(vertex, b, c)
        signs.add(sign * component.triangles[triple])
    if len(signs) != 1:
        raise Refused(f"the ring of particle {vertex} crosses itself")
    return signs.pop()


def _scheme(totals: Array) -> tuple[str, bool, Array, Array]:
    """The scheme of which the vertices' energies are made, κ and C0 of each.

    Parameters
    ----------
    totals : ndarray, shape (num_trials, num_vertices, num_features)
        The coefficients.
    """
    used = set(np.flatnonzero(totals.any(axis=(0, 1))).tolist())
    for scheme, (square, signed, unsigned, area) in SCHEMES.items():
        if square not in used:
            continue
        for linear in (signed, unsigned):
            if linear is None or not used <= {square, linear, area}:
                continue
            rigidity = 2 * totals[..., square]
            if np.any(rigidity <= 0):
                raise Refused("its rigidity is not positive everywhere")
            curvature = -totals[..., linear] / rigidity
            constant = 0.5 * rigidity * curvature**2
            error = np.abs(totals[..., area] - constant)
            if np.any(error > _ERROR * (constant.max() + np.abs(totals[..., area]))):
                raise Refused(
                    "its terms of first and second order in the spontaneous curvature do not "
                    "belong together"
                )
            return scheme, linear == unsigned and bool(curvature.any()), rigidity, curvature
    raise Refused("its energies of vertices are no bending energy of ours, or several at once")
