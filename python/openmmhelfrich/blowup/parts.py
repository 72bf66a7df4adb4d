"""What each force of a Context contributes at a moment."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import openmm
from openmm import unit

from .._placement import NUM_GROUPS
from .._present import has_energy, surfaces_of
from .._types import Array

__all__ = ["Parts"]

_ENERGY = unit.kilojoule_per_mole
_FORCE = _ENERGY / unit.nanometer


class Parts:
    """What each force of a Context gives, in a Context of its own with a group for each.

    Parameters
    ----------
    context : openmm.Context
        Whose present positions, box, parameters and triangles `take` looks at, each time that it is
        called. It is left alone.

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
            # Forces beyond are in the last group together.
            force.setForceGroup(min(group, NUM_GROUPS - 1))
        names = [forces[index].getName() for index in places]
        often = Counter(names)
        labels = [
            f"{name} (force {place})" if often[name] > 1 else name
            for name, place in zip(names, places, strict=True)
        ]
        if len(labels) > NUM_GROUPS:
            labels = [*labels[: NUM_GROUPS - 1], "other forces"]
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

    def take(self) -> tuple[Array, Array]:
        """Energies, kJ/mol, shape (num_labels,), and forces, kJ/mol/nm, (num_labels, N, 3), now."""
        self._follow()
        states = [
            self._alone.getState(getEnergy=True, getForces=True, groups={group})
            for group in range(len(self.labels))
        ]
        return (
            np.array([state.getPotentialEnergy().value_in_unit(_ENERGY) for state in states]),
            np.array([state.getForces(asNumpy=True).value_in_unit(_FORCE) for state in states]),
        )


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
