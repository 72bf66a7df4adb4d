"""Custom forces replaced by ours, where they mean the same."""

from __future__ import annotations

import copy
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
import openmm as mm
from openmm import unit

from .recognise.bending import bending_terms
from .recognise.constraints import (
    ERRORS,
    CollectiveReading,
    collective_terms,
    pair_term,
    read_collective,
)
from .recognise.edges import EdgeReading, read_edges
from .recognise.local import dihedral_term, repulsion_term, triangle_area_term
from .recognise.rings import RingReading, read_rings
from .recognise.source import (
    Bonds,
    Unreadable,
    global_parameters,
    is_pi,
    read_bonds,
    trials_of,
)
from .recognise.surface import Surfaces, distinct
from .recognise.term import Refused, Term, common_name
from .recognise.triangles import (
    PairReading,
    RepulsionReading,
    TriangleReading,
    read_pairs,
    read_repulsion,
    read_triangles,
)

__all__ = ["Left", "Replaced", "Report", "accelerate"]


@dataclass(frozen=True)
class Replaced:
    """Custom forces that one of ours took the place of.

    indices, names: of the forces in the given System; force_class: the class of ours;
    num_triangles: of its surface; description: its parameters, in words.
    """

    indices: tuple[int, ...]
    names: tuple[str, ...]
    force_class: str
    num_triangles: int
    description: str


@dataclass(frozen=True)
class Left:
    """A force that stays, and why."""

    index: int
    name: str
    reason: str


@dataclass
class Report:
    """What `accelerate` replaced and what it left alone.

    Attributes
    ----------
    replaced : list of Replaced
    left : list of Left
    notes : list of str
        What else has changed.
    """

    replaced: list[Replaced] = field(default_factory=list)
    left: list[Left] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        lines = [f"replaced {sum(len(r.indices) for r in self.replaced)} forces"]
        for r in self.replaced:
            names = ", ".join(sorted(set(r.names)))
            which = ", ".join(map(str, r.indices))
            lines.append(f"  {which} ({names}) -> {r.force_class}, {r.num_triangles} triangles")
            lines.append(f"      {r.description}")
        lines.append(f"left {len(self.left)} forces alone")
        lines += [f"  {r.index} ({r.name}): {r.reason}" for r in self.left]
        return "\n".join([*lines, *self.notes])


def accelerate(
    system: mm.System, positions=None, tolerance: float = 1e-9
) -> tuple[mm.System, Report]:
    """Replace the Custom forces of membranes by the forces of this package.

    Looks for bending energies (one force for each number of neighbours, five discretisations),
    global area and volume (as sums over pairs of triangles, or as a CustomCVForce of a sum),
    repulsions at small triangle heights and areas, areas of single triangles, and dihedral
    energies. What a force is follows from the values of its expression at random places, not from
    its text; it is replaced only if ours has the same values there, to 1e-10, and if the triangles
    form closed surfaces. Energies and forces of the two Systems are equal up to rounding. Names and
    force groups are kept, and a global parameter that is one of our scalars becomes a parameter of
    the Context.

    Parameters
    ----------
    system : openmm.System
        Is not changed.
    positions : array_like or Quantity, optional
        Positions of all particles, shape (num_particles, 3), nm. With them the energies and forces
        of all that is replaced are compared once more, and triangles are oriented by the side that
        is outside.
    tolerance : float
        Of that comparison: the largest difference, relative to the sum of the absolute values of
        what the Custom forces add up.

    Returns
    -------
    openmm.System
        A new one.
    Report
        What was replaced, what was left alone and why. It can be printed.

    Notes
    -----
    Without positions and without a volume force, nothing says which side of a surface is outside;
    the order of the neighbours in signed bending energies decides then, and if it does not, the
    choice is arbitrary and changes no energy.

    Examples
    --------
    >>> faster, report = accelerate(system, positions)
    >>> print(report)
    """
    if positions is not None:
        if unit.is_quantity(positions):
            positions = positions.value_in_unit(unit.nanometer)
        positions = np.array(positions, dtype=float)
        if positions.shape != (system.getNumParticles(), 3):
            raise ValueError(
                f"accelerate: the System has {system.getNumParticles()} particles, but positions "
                f"have the shape {positions.shape}"
            )
    return _Accelerator(system, positions, tolerance).result()


class _Accelerator:
    """One System on its way."""

    def __init__(self, system: mm.System, positions: np.ndarray | None, tolerance: float):
        self._system = system
        self._positions = positions
        self._tolerance = tolerance
        self._forces = list(system.getForces())
        self._trials = trials_of(system)
        self._surfaces = Surfaces(positions)
        self._readings: dict[int, object] = {}
        self._left: dict[int, str] = {}
        #: The index of the first replaced force: what takes its place.
        self._new: dict[int, list[mm.Force]] = defaultdict(list)
        self._report = Report()

    def result(self) -> tuple[mm.System, Report]:
        for index, force in enumerate(self._forces):
            try:
                self._readings[index] = self._read(force)
            except ERRORS as reason:
                self._left[index] = str(reason)
        self._accept(self._terms())
        for index in self._left:
            force = self._forces[index]
            self._report.left.append(Left(index, force.getName(), self._left[index]))
        self._report.left.sort(key=lambda left: left.index)
        return self._system_with_ours(), self._report

    def _read(self, force: mm.Force):
        if isinstance(force, mm.CustomCVForce):
            return read_collective(force, self._surfaces, self._trials)
        bonds = read_bonds(force)
        readers = (read_rings, read_triangles, read_repulsion, read_pairs, read_edges)
        for reader in readers:
            reading = reader(bonds, self._trials)
            if isinstance(reading, str):
                raise Refused(reading)
            if reading is not None:
                untested = bonds.expression.untested_branches()
                if untested:
                    raise Unreadable(
                        f"its expression has branches ({', '.join(sorted(set(untested)))}) of "
                        "which only one side was ever met, so it may be another energy elsewhere"
                    )
                return reading
        raise Unreadable(
            f"its energy of {bonds.num_points} particles is none of those that we know"
        )

    def _of(self, kind: type) -> list[tuple[int, object]]:
        return [(i, r) for i, r in self._readings.items() if isinstance(r, kind)]

    def _group(self, index: int) -> int:
        return self._forces[index].getForceGroup()

    def _terms(self) -> list[list[Term]]:
        """Sets of terms that take the place of the same forces."""
        found: list[list[Term]] = []
        used: set[int] = set()

        def attempt(index: int, make) -> None:
            try:
                terms = make()
            except ERRORS as reason:
                self._left[index] = str(reason)
                return
            terms = terms if isinstance(terms, list) else [terms]
            used.update(i for term in terms for i in term.sources)
            found.append(terms)

        surfaces, trials = self._surfaces, self._trials
        # Volumes first, because they say which side is outside.
        for index, reading in sorted(self._of(CollectiveReading), key=lambda p: p[0]):
            attempt(index, lambda i=index, r=reading: collective_terms(i, r, trials))
        for index, reading in sorted(self._of(PairReading), key=lambda p: p[1].kind != "volume"):
            singles = [
                (i, single)
                for i, single in self._of(TriangleReading)
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
            for index, reading in self._of(kind):
                if index not in used:
                    attempt(index, lambda i=index, r=reading, m=make: m(i, r, surfaces, trials))
        by_group: dict[int, list] = defaultdict(list)
        for index, reading in self._of(RingReading):
            by_group[self._group(index)].append((index, reading))
        for readings in by_group.values():
            terms, reasons = bending_terms(readings, surfaces, trials)
            found += [[term] for term in terms]
            self._left |= reasons
        return found

    def _accept(self, found: list[list[Term]]) -> None:
        """Build what keeps all parameters of the Context and passes the comparison."""
        rejected: dict[int, str] = {}
        # Leaving a force alone can keep a parameter that another one would lose, but not the
        # other way round, so one pass with everything accepted is the strict one.
        kept = {name for index in self._left for name in global_parameters(self._forces[index])} | {
            name for terms in found for term in terms for name in term.contexts
        }
        for terms in found:
            sources = sorted({i for term in terms for i in term.sources})
            forces = [self._forces[i] for i in sources]
            try:
                self._check_parameters(sources, terms, kept)
                derivatives = {name for force in forces for name in _derivatives(force)}
                name = common_name(forces)
                ours = [
                    force
                    for term in terms
                    for force in term.build(name, forces[0].getForceGroup(), derivatives)
                ]
                self._compare(sources, ours)
            except Refused as reason:
                rejected |= dict.fromkeys(sources, str(reason))
                continue
            self._new[sources[0]] += ours
            for term in terms:
                self._report.replaced.append(
                    Replaced(
                        tuple(term.sources),
                        tuple(self._forces[i].getName() for i in term.sources),
                        term.force_class,
                        sum(len(component.triangles) for component in term.components),
                        term.describe(),
                    )
                )
        self._left |= rejected

    def _check_parameters(self, sources: list[int], terms: list[Term], kept: set[str]) -> None:
        own = {name for term in terms for name in term.contexts}
        for index in sources:
            force = self._forces[index]
            for name, value in global_parameters(force).items():
                if name in own or name in kept:
                    continue
                if not is_pi(value):
                    raise Refused(
                        f"the Context would lose the parameter {name}, which is none of our scalars"
                    )
                note = f"the Context parameter {name} was π, and is gone"
                if note not in self._report.notes:
                    self._report.notes.append(note)
            lost = set(_derivatives(force)) - own
            if lost:
                raise Refused(f"the derivative by {min(lost)} would be lost")

    def _compare(self, sources: list[int], ours: list[mm.Force]) -> None:
        """Energies and forces at the given positions."""
        if self._positions is None:
            return
        system = mm.System()
        for _ in range(self._system.getNumParticles()):
            system.addParticle(1.0)
        for force in ours:
            system.addForce(copy.deepcopy(force))
        platform = mm.Platform.getPlatformByName("Reference")
        try:
            context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
            context.setPositions(self._positions)
            state = context.getState(energy=True, forces=True)
        except mm.OpenMMException as reason:
            raise Refused(f"our force cannot be evaluated at the positions: {reason}") from None
        md = unit.md_unit_system
        energy = state.getPotentialEnergy().value_in_unit_system(md)
        forces = state.getForces(asNumpy=True).value_in_unit_system(md)
        parts = [_evaluate(self._readings[i], self._positions) for i in sources]
        theirs, their_forces, scale, force_scale = (sum(p[k] for p in parts) for k in range(4))
        energy_error = abs(energy - theirs)
        force_error = np.abs(forces - their_forces).max()
        if not (
            energy_error <= self._tolerance * max(scale, abs(theirs))
            and force_error <= self._tolerance * np.max(force_scale)
        ):
            raise Refused(
                f"ours differs at the positions: by {energy_error:.3g} kJ/mol in the energy of "
                f"{theirs:.6g}, by up to {force_error:.3g} kJ/mol/nm in forces of up to "
                f"{np.abs(their_forces).max():.6g}"
            )

    def _system_with_ours(self) -> mm.System:
        """A copy without the replaced forces."""
        new = _without_forces(self._system)
        for index, force in enumerate(self._forces):
            if index in self._left:
                new.addForce(copy.deepcopy(force))
            for ours in self._new.get(index, ()):
                new.addForce(ours)
        return new


def _without_forces(old: mm.System) -> mm.System:
    """Particles, constraints, virtual sites and box.

    Sums over pairs are millions of bonds, so the whole is copied only where Python cannot copy the
    parts.
    """
    if any(old.isVirtualSite(particle) for particle in range(old.getNumParticles())):
        new = copy.deepcopy(old)
        for index in reversed(range(new.getNumForces())):
            new.removeForce(index)
        return new
    new = mm.System()
    for particle in range(old.getNumParticles()):
        new.addParticle(old.getParticleMass(particle))
    for constraint in range(old.getNumConstraints()):
        new.addConstraint(*old.getConstraintParameters(constraint))
    new.setDefaultPeriodicBoxVectors(*old.getDefaultPeriodicBoxVectors())
    return new


def _same_triangles(single: TriangleReading, pairs: PairReading) -> bool:
    listed, both = (
        {tuple(sorted(row)) for row in distinct(rows)[0].tolist()}
        for rows in (single.bonds.particles, np.concatenate([pairs.first, pairs.second]))
    )
    return listed == both


def _derivatives(force: mm.Force) -> list[str]:
    if not hasattr(force, "getNumEnergyParameterDerivatives"):
        return []
    return [
        force.getEnergyParameterDerivativeName(i)
        for i in range(force.getNumEnergyParameterDerivatives())
    ]


def _evaluate(reading, positions: np.ndarray) -> tuple[float, np.ndarray, float, np.ndarray]:
    bonds = reading if isinstance(reading, CollectiveReading) else reading.bonds
    assert isinstance(bonds, (Bonds, CollectiveReading))
    return bonds.forces(positions)
