"""What each force of a Context contributes at a moment."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import openmm
from openmm import unit

from .._present import has_energy, surfaces_of
from .._types import Array

__all__ = ["Parts"]

_ENERGY = unit.kilojoule_per_mole
_FORCE = _ENERGY / unit.nanometer
# Force groups that OpenMM has; forces beyond are in the last one together.
_GROUPS = 32


class Parts:
    """Energies and forces of each force, in a Context of its own with a group for each.

    Parameters
    ----------
    context : openmm.Context
        Whose present positions, box, parameters and triangles are looked at, by `energies` and
        `forces`, each time they are called. It is left alone.

    Raises
    ------
    openmm.OpenMMException
        If its forces cannot be copied.
    """

    def __init__(self, context: openmm.Context):
        self._context = context
        system = openmm.XmlSerializer.clone(context.getSystem())
        forces = context.getSystem().getForces()
        for index in reversed(range(len(forces))):
            if not has_energy(forces[index]):
                system.removeForce(index)
        places = [index for index, force in enumerate(forces) if has_energy(force)]
        for group, force in enumerate(system.getForces()):
            force.setForceGroup(min(group, _GROUPS - 1))
        names = [forces[index].getName() for index in places]
        often = Counter(names)
        labels = [
            f"{name} (force {place})" if often[name] > 1 else name
            for name, place in zip(names, places, strict=True)
        ]
        if len(labels) > _GROUPS:
            labels = [*labels[: _GROUPS - 1], "other forces"]
        self.labels = labels
        self._alone = openmm.Context(system, openmm.VerletIntegrator(0.001), context.getPlatform())
        self._surfaces = _independent(surfaces_of(context), surfaces_of(self._alone))

    def _follow(self) -> None:
        state = self._context.getState(getPositions=True, getParameters=True)
        self._alone.setPeriodicBoxVectors(*state.getPeriodicBoxVectors())
        self._alone.setPositions(state.getPositions(asNumpy=True))
        known = self._alone.getParameters()
        for name, value in state.getParameters().items():
            if name in known:
                self._alone.setParameter(name, value)
        for theirs, ours in self._surfaces:
            ours.setTrianglesInContext(self._alone, theirs.getTrianglesInContext(self._context))
            values = theirs.getPermutationInContext(self._context)
            ours.setPermutationInContext(self._alone, values)

    def _states(self, **wanted: bool) -> list[openmm.State]:
        self._follow()
        groups = range(len(self.labels))
        return [self._alone.getState(groups={group}, **wanted) for group in groups]

    def energies(self) -> Array:
        """The energy of each at this moment, kJ/mol, in the order of `labels`."""
        states = self._states(getEnergy=True)
        return np.array([state.getPotentialEnergy().value_in_unit(_ENERGY) for state in states])

    def forces(self, particle: int) -> Array:
        """The length of the force of each on a particle at this moment, kJ/mol/nm."""
        states = self._states(getForces=True)
        found = [state.getForces(asNumpy=True).value_in_unit(_FORCE) for state in states]
        return np.array([np.linalg.norm(forces[particle]) for forces in found])


def _independent(theirs: list[Any], ours: list[Any]) -> list[tuple[Any, Any]]:
    """Pairs of forces on the surfaces that follow no others: triangles of several do."""
    found: list[tuple[Any, Any]] = []
    seen: set[int] = set()
    # Movers have surfaces, too, and no copies.
    copies = {force._triangleBuffer(): force for force in ours}
    for force in sorted(theirs, key=lambda force: len(force._triangleBuffer())):
        corners = force._triangleBuffer()
        particles = set(np.frombuffer(corners, dtype=np.intc).tolist())
        if corners in copies and not particles & seen:
            found.append((force, copies[corners]))
            seen |= particles
    return found
