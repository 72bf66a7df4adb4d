"""Custom forces replaced by ours, where they mean the same."""

from __future__ import annotations

import copy
from collections import defaultdict
from collections.abc import Iterable

import numpy as np
import openmm as mm
from openmm import unit

from .._types import Array, Values
from .recognise.conditions import Condition, Search, plan_of
from .recognise.constraints import CollectiveReading
from .recognise.fixed import Fixed
from .recognise.reader import Outcome, Plans, Reader
from .recognise.source import all_parameters, derivatives, is_pi
from .recognise.term import Refused, Term, common_name
from .report import Left, Replaced, Report

__all__ = ["Left", "Replaced", "Report", "accelerate"]


def accelerate(
    system: mm.System,
    positions: Values | None = None,
    tolerance: float = 1e-9,
    freeze: Iterable[str] = (),
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
    freeze : iterable of str
        Global parameters that may become numbers, their defaults in the System. The report names
        those that would help. A force that needs a frozen parameter to follow another one, such as
        a cutoff hc = 2^¼ s of a repulsion whose s is a parameter too, gets one that does: freeze
        both to make both numbers.

    Returns
    -------
    openmm.System
        A new one.
    Report
        What was replaced, what was left alone and why. It can be printed.

    Raises
    ------
    TypeError
        No System.
    ValueError
        Positions of another shape; a parameter to freeze that no force has, or of which forces have
        different defaults.

    Notes
    -----
    Without positions and without a volume force, nothing says which side of a surface is outside;
    the order of the neighbours in signed bending energies decides then, and if it does not, the
    choice is arbitrary and changes no energy.

    A frozen parameter is a parameter of the new System only where forces that were not replaced
    have it; it does nothing to the others then. A cutoff hc that has become 2^¼ s follows s when
    that is changed in a Context, which the parameter hc of the given System did not by itself.

    Examples
    --------
    >>> faster, report = accelerate(system, positions)
    >>> print(report)
    >>> faster, report = accelerate(system, positions, freeze=["hc"])
    """
    if not isinstance(system, mm.System):
        raise TypeError(
            f"accelerate: system needs an openmm.System, got {type(system).__name__}; that of a "
            "Simulation is simulation.system"
        )
    if positions is not None:
        if unit.is_quantity(positions):
            positions = positions.value_in_unit(unit.nanometer)
        positions = np.array(positions, dtype=float)
        if positions.shape != (system.getNumParticles(), 3):
            raise ValueError(
                f"accelerate: the System has {system.getNumParticles()} particles, but positions "
                f"have the shape {positions.shape}"
            )
    return _Accelerator(system, positions, tolerance, _frozen(system, freeze)).result()


def _frozen(system: mm.System, freeze: Iterable[str]) -> dict[str, float]:
    """The parameters to freeze, with their values.

    Raises
    ------
    ValueError
        If there is none of that name, or if its forces disagree about its value.
    """
    values: dict[str, set[float]] = defaultdict(set)
    for force in system.getForces():
        for name, value in all_parameters(force).items():
            values[name].add(value)
    names = list(dict.fromkeys([freeze] if isinstance(freeze, str) else freeze))
    for name in names:
        if name not in values:
            known = ", ".join(values) or "none"
            raise ValueError(
                f"accelerate: freeze: no force of the System has a global parameter {name!r}; "
                f"there are: {known}"
            )
        if len(values[name]) > 1:
            raise ValueError(
                f"accelerate: freeze: forces of the System have different defaults of {name}: "
                f"{', '.join(f'{value:.9g}' for value in sorted(values[name]))}"
            )
    return {name: min(values[name]) for name in names}


class _Accelerator:
    """One System on its way."""

    def __init__(
        self,
        system: mm.System,
        positions: Array | None,
        tolerance: float,
        frozen: dict[str, float],
    ):
        self._system = system
        self._positions = positions
        self._tolerance = tolerance
        self._frozen = frozen
        self._reader = Reader(system, positions)
        self._forces = self._reader.forces

    def result(self) -> tuple[mm.System, Report]:
        numbers = {name: Fixed(name, value) for name, value in self._frozen.items()}
        plans = {i: plan_of(force, numbers) for i, force in enumerate(self._forces)}
        self._attempt(plans)
        # Where numbers are not enough, parameters may be meant to follow others.
        conditions = self._conditions()
        wanted = [c for c in conditions if c.fixed.keys() <= self._frozen.keys()]
        if wanted:
            for condition in wanted:
                for index in condition.sources:
                    plans[index] = plan_of(self._forces[index], condition.fixed)
            self._attempt(plans)
            conditions = self._conditions()
        self._explain(conditions)
        return self._system_with_ours(), self._report

    def _attempt(self, plans: Plans) -> None:
        """Replace what can be under these plans, from the beginning."""
        self._plans = plans
        self._report = Report()
        #: The index of the first replaced force: what takes its place.
        self._new: dict[int, list[mm.Force]] = defaultdict(list)
        self._outcome = self._reader.recognise(range(len(self._forces)), plans)
        self._left = dict(self._outcome.left)
        #: Of the new System, for forces that would have to keep them.
        self._kept: set[str] = set()
        #: What differs from ours at the given positions, whichever parameters are frozen.
        self._different: set[int] = set()
        self._accept(self._outcome)

    def _conditions(self) -> list[Condition]:
        """Under which more forces could be replaced."""
        search = Search(self._reader, list(self._frozen), self._check_lost, self._check_derivatives)
        return list(search.conditions(i for i in sorted(self._left) if i not in self._different))

    def _explain(self, conditions: list[Condition]) -> None:
        """Say why forces are left, and what freezing has changed."""
        reasons, freeze = dict(self._left), {}
        for condition in conditions:
            if condition.fixed.keys() <= self._frozen.keys() and not condition.obstacle:
                continue
            for index in condition.sources:
                known = index not in self._outcome.unknown
                reasons[index] = f"{self._left[index]}; {condition}" if known else str(condition)
                if not condition.obstacle:
                    freeze[index] = tuple(condition.fixed)
        self._report.left = [
            Left(index, self._forces[index].getName(), reasons[index], freeze.get(index, ()))
            for index in sorted(reasons)
        ]
        for name in self._frozen:
            self._report.notes.append(self._note_on(name))

    def _note_on(self, name: str) -> str:
        having = [
            f"{i} ({self._forces[i].getName()})"
            for i in sorted(self._left)
            if name in all_parameters(self._forces[i])
        ]
        used = any(fixed.name == name for r in self._report.replaced for fixed in r.fixed)
        if not used:
            return f"{name} is frozen in no force: none that was replaced has it"
        if having:
            return (
                f"{name} is still a parameter of the Context, for the forces left alone that have "
                f"it, {', '.join(having)}; what was replaced no longer depends on it"
            )
        return f"{name} is no longer a parameter of the Context"

    def _accept(self, outcome: Outcome) -> None:
        """Build what keeps all parameters of the Context and passes the comparison."""
        rejected: dict[int, str] = {}
        accepted: set[str] = set()
        # Leaving a force alone can keep a parameter that another one would lose, but not the
        # other way round, so one pass with everything accepted is the strict one.
        self._kept = {name for terms in outcome.found for term in terms for name in term.contexts}
        for terms in outcome.found:
            sources = sorted({i for term in terms for i in term.sources})
            forces = [self._forces[i] for i in sources]
            try:
                self._check_lost(sources, terms, self._plans)
                self._check_derivatives(sources, terms, self._plans)
                wanted = {name for force in forces for name in derivatives(force)}
                name = common_name(forces)
                ours = [
                    force
                    for term in terms
                    for force in term.build(name, forces[0].getForceGroup(), wanted)
                ]
                self._compare(sources, ours)
            except Refused as reason:
                rejected |= dict.fromkeys(sources, str(reason))
                continue
            self._new[sources[0]] += ours
            accepted |= {name for term in terms for name in term.contexts}
            self._note_pi(sources, terms)
            for term in terms:
                fixed = {f for i in term.sources for f in self._plans[i].values()}
                self._report.replaced.append(
                    Replaced(
                        tuple(term.sources),
                        tuple(self._forces[i].getName() for i in term.sources),
                        term.force_class,
                        sum(len(component.triangles) for component in term.components),
                        term.describe(),
                        tuple(sorted(fixed, key=lambda f: f.name)),
                    )
                )
        self._left |= rejected
        self._kept = accepted

    def _lost(self, sources: list[int], terms: list[Term], plans: Plans) -> dict[str, float]:
        """The parameters that the Context would lose, which nobody has fixed, with their values."""
        kept = self._kept | {name for term in terms for name in term.contexts}
        kept |= {n for i in self._left if i not in sources for n in all_parameters(self._forces[i])}
        return {
            name: value
            for index in sources
            for name, value in all_parameters(self._forces[index]).items()
            if name not in kept and name not in plans[index]
        }

    def _check_lost(self, sources: list[int], terms: list[Term], plans: Plans) -> None:
        for name, value in self._lost(sources, terms, plans).items():
            if not is_pi(value):
                raise Refused(
                    f"the Context would lose the parameter {name}, which is none of our scalars"
                )

    def _note_pi(self, sources: list[int], terms: list[Term]) -> None:
        for name in self._lost(sources, terms, self._plans):
            note = f"the Context parameter {name} was π, and is gone"
            if note not in self._report.notes:
                self._report.notes.append(note)

    def _check_derivatives(self, sources: list[int], terms: list[Term], plans: Plans) -> None:
        own = {name for term in terms for name in term.contexts}
        for index in sources:
            wanted = set(derivatives(self._forces[index]))
            if lost := wanted - own:
                raise Refused(f"the derivative by {min(lost)} would be lost")
            for source in sources:
                for fixed in plans[source].values():
                    if fixed.base in wanted:
                        raise Refused(
                            f"the derivative by {fixed.base} would be another one, because "
                            f"{fixed.name} would follow it"
                        )

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
            self._different.update(sources)
            raise Refused(f"our force cannot be evaluated at the positions: {reason}") from None
        md = unit.md_unit_system
        energy = state.getPotentialEnergy().value_in_unit_system(md)
        forces = state.getForces(asNumpy=True).value_in_unit_system(md)
        parts = [_evaluate(self._outcome.readings[i], self._positions) for i in sources]
        theirs, their_forces, scale, force_scale = (sum(p[k] for p in parts) for k in range(4))
        energy_error = abs(energy - theirs)
        force_error = np.abs(forces - their_forces).max()
        if not (
            energy_error <= self._tolerance * max(scale, abs(theirs))
            and force_error <= self._tolerance * np.max(force_scale)
        ):
            self._different.update(sources)
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


def _evaluate(reading, positions: Array) -> tuple[float, Array, float, Array]:
    return (reading if isinstance(reading, CollectiveReading) else reading.bonds).forces(positions)
