"""Rows of the table of cases in Contexts."""

from __future__ import annotations

from functools import cache

import numpy as np
import openmm as mm
from cases import PRESENT
from meshes import membrane
from openmm import unit
from platforms import Target

BY_NAME = {case.name: case for case in PRESENT}


def plain(quantity) -> np.ndarray | float:
    return quantity.value_in_unit_system(unit.md_unit_system)


class Running:
    """Forces in a Context: energy and forces at any positions, by force group."""

    def __init__(self, forces: list[mm.Force], num_particles: int, target: Target) -> None:
        system = mm.System()
        for _ in range(num_particles):
            system.addParticle(50.0)
        for group, force in enumerate(forces):
            force.setForceGroup(group)
            if target.backend:
                force.setBackend(target.backend)
            system.addForce(force)
        self.context = target.context(system)

    def evaluate(self, positions, group: int = -1) -> tuple[float, np.ndarray]:
        self.context.setPositions(positions)
        groups = -1 if group < 0 else {group}
        state = self.context.getState(getEnergy=True, getForces=True, groups=groups)
        return plain(state.getPotentialEnergy()), plain(state.getForces(asNumpy=True))

    def energy(self, positions) -> float:
        self.context.setPositions(positions)
        return plain(self.context.getState(getEnergy=True).getPotentialEnergy())


@cache
def running(name: str, where: str, target: Target) -> Running:
    m = membrane(where)
    return Running([BY_NAME[name].make(m)], m.num_particles, target)
