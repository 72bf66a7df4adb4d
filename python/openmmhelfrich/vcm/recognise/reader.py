"""All forces of a System read and put together, under what is known of their global parameters."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import openmm as mm

from ..._types import Array
from .bending import bending_terms
from .constraints import (
    ERRORS,
    CollectiveReading,
    collective_terms,
    pair_term,
    read_collective,
)
from .edges import EdgeReading, read_edges
from .fixed import Fixed
from .local import dihedral_term, repulsion_term, triangle_area_term
from .rings import RingReading, read_rings
from .source import BondList, Unreadable, list_bonds, read_bonds, trials_of
from .surface import Surfaces, distinct
from .term import Refused, Term
from .triangles import (
    PairReading,
    RepulsionReading,
    TriangleReading,
    read_pairs,
    read_repulsion,
    read_triangles,
)

__all__ = ["Outcome", "Plans", "Reader"]

# Readings of more, which are sums over pairs, are not kept for a second time.
_MANY_BONDS = 100_000

#: By the index of a force: those of its global parameters that do not vary by themselves.
Plans = Mapping[int, Mapping[str, Fixed]]


@dataclass
class Outcome:
    """What forces mean.

    readings: by index; found: sets of terms that take the place of the same forces; left: reasons
    by index; unknown: the indices whose expression is none of those that we know.
    """

    readings: dict[int, object] = field(default_factory=dict)
    found: list[list[Term]] = field(default_factory=list)
    left: dict[int, str] = field(default_factory=dict)
    unknown: set[int] = field(default_factory=set)


class Reader:
    """The forces of one System, of which no bond is read twice, nor an expression in one way."""

    def __init__(self, system: mm.System, positions: Array | None) -> None:
        self.forces: list[mm.Force] = list(system.getForces())
        self._positions = positions
        self._trials = trials_of(system)
        self._lists: dict[int, BondList] = {}
        self._known: dict[tuple[Any, ...], object] = {}

    def recognise(
        self, indices: Iterable[int], plans: Plans, all_or_nothing: bool = False
    ) -> Outcome:
        """Read some of the forces and put them together.

        Parameters
        ----------
        indices : iterable of int
            Which.
        plans : Plans
            What is fixed.
        all_or_nothing : bool
            Give up once a force cannot be read; then nothing is found.
        """
        outcome, surfaces = Outcome(), Surfaces(self._positions)
        for index in indices:
            try:
                outcome.readings[index] = self._reading(index, plans.get(index, {}), surfaces)
            except ERRORS as reason:
                outcome.left[index] = str(reason)
                if isinstance(reason, Unreadable):
                    outcome.unknown.add(index)
                if all_or_nothing:
                    return outcome
        self._put_together(outcome, surfaces)
        return outcome

    def _reading(self, index: int, fixed: Mapping[str, Fixed], surfaces: Surfaces):
        force = self.forces[index]
        if isinstance(force, mm.CustomCVForce):
            # It knows its surfaces, which are new each time.
            return read_collective(force, surfaces, self._trials, dict(fixed))
        key = (index, frozenset(fixed.values()))
        result = self._known.get(key)
        if result is None:
            try:
                result = self._read(index, fixed)
            except ERRORS as reason:
                result = reason
            if isinstance(result, Exception) or len(result.bonds.particles) <= _MANY_BONDS:
                self._known[key] = result
        if isinstance(result, Exception):
            # Without its traceback, which would keep the bonds in memory.
            raise result.with_traceback(None)
        return result

    def _read(self, index: int, fixed: Mapping[str, Fixed]):
        if index not in self._lists:
            self._lists[index] = list_bonds(self.forces[index])
        bonds = read_bonds(self._lists[index], dict(fixed))
        for reader in (read_rings, read_triangles, read_repulsion, read_pairs, read_edges):
            reading = reader(bonds, self._trials)
            if isinstance(reading, str):
                raise Refused(reading)
            if reading is not None:
                untested = bonds.expression.untested_branches(bonds.globals)
                if untested:
                    raise Unreadable(
                        f"its expression has branches ({', '.join(sorted(set(untested)))}) of "
                        "which only one side was ever met, so it may be another energy elsewhere"
                    )
                return reading
        raise Unreadable(
            f"its energy of {bonds.num_points} particles is none of those that we know"
        )

    def _group(self, index: int) -> int:
        return self.forces[index].getForceGroup()

    def _put_together(self, outcome: Outcome, surfaces: Surfaces) -> None:
        found, used, trials = outcome.found, set(), self._trials

        def of(kind: type) -> list[tuple[int, object]]:
            return [(i, r) for i, r in outcome.readings.items() if isinstance(r, kind)]

        def attempt(index: int, make) -> None:
            try:
                terms = make()
            except ERRORS as reason:
                outcome.left[index] = str(reason)
                return
            terms = terms if isinstance(terms, list) else [terms]
            used.update(i for term in terms for i in term.sources)
            found.append(terms)

        # Volumes first, because they say which side is outside.
        for index, reading in sorted(of(CollectiveReading), key=lambda p: p[0]):
            attempt(index, lambda i=index, r=reading: collective_terms(i, r, trials))
        for index, reading in sorted(of(PairReading), key=lambda p: p[1].kind != "volume"):
            singles = [
                (i, single)
                for i, single in of(TriangleReading)
                if i not in used
                and single.kind == reading.kind
                and self._group(i) == self._group(index)
                and _same_triangles(single, reading)
            ]
            attempt(
                index, lambda i=index, r=reading, s=singles: pair_term((i, r), s, surfaces, trials)
            )
        for kind, make in (
            (TriangleReading, triangle_area_term),
            (RepulsionReading, repulsion_term),
            (EdgeReading, dihedral_term),
        ):
            for index, reading in of(kind):
                if index not in used:
                    attempt(index, lambda i=index, r=reading, m=make: m(i, r, surfaces, trials))
        by_group: dict[int, list[Any]] = defaultdict(list)
        for index, reading in of(RingReading):
            by_group[self._group(index)].append((index, reading))
        for readings in by_group.values():
            terms, reasons = bending_terms(readings, surfaces, trials)
            found += [[term] for term in terms]
            outcome.left |= reasons


def _same_triangles(single: TriangleReading, pairs: PairReading) -> bool:
    listed, both = (
        {tuple(sorted(row)) for row in distinct(rows)[0].tolist()}
        for rows in (single.bonds.particles, np.concatenate([pairs.first, pairs.second]))
    )
    return listed == both
