"""Small Systems whose box changes, for the tests of MonteCarloMembraneTension."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
from openmm import unit
from platforms import HELFRICH, Target

#: Of the thermostats and the moves, K.
TEMPERATURE = 300.0
KT = unit.MOLAR_GAS_CONSTANT_R.value_in_unit(unit.kilojoule_per_mole / unit.kelvin) * TEMPERATURE
#: A triclinic box, and how many particles are in it.
BOX = np.array([[5.0, 0, 0], [1.5, 4.0, 0], [-2.0, 1.0, 6.0]])
COUNT = 6


def mover_of(*, seed: int = 7, adaptive: int = 500, rigid: bool = True, **arguments):
    values = {"temperature": TEMPERATURE, "frequency": 1} | arguments
    mover = helfrich.MonteCarloMembraneTension(**values)
    mover.setRandomNumberSeed(seed)
    mover.setAdaptiveMoves(adaptive)
    mover.setScaleMoleculesAsRigid(rigid)
    return mover


def system_of(*forces: mm.Force, count: int = COUNT, box=BOX, mass: float = 10.0) -> mm.System:
    system = mm.System()
    for _ in range(count):
        system.addParticle(mass)
    system.setDefaultPeriodicBoxVectors(*box)
    for force in forces:
        system.addForce(force)
    return system


def of_box(expression: str = "0") -> mm.Force:
    """An energy of the box alone."""
    return mm.CustomVolumeForce(expression)


def tense(
    *forces: mm.Force,
    target: Target = HELFRICH,
    integrator: mm.Integrator | None = None,
    positions=None,
    box=BOX,
) -> mm.Context:
    """A Context of free particles, or of those that are given."""
    if positions is None:
        positions = np.random.default_rng(1).uniform(-3, 9, (COUNT, 3))
    system = system_of(*forces, count=len(positions), box=box)
    context = target.context(system, integrator or mm.VerletIntegrator(0.001))
    context.setPositions(positions)
    return context


def box_of(context: mm.Context) -> np.ndarray:
    return context.getState().getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)


def positions_of(context: mm.Context) -> np.ndarray:
    state = context.getState(getPositions=True)
    return state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def boxes(context: mm.Context, samples: int, every: int, discard: int = 2000) -> np.ndarray:
    """The diagonals of the box at times that are far from each other, shape (samples, 3)."""
    integrator = context.getIntegrator()
    integrator.step(discard)
    found = np.empty((samples, 3))
    for sample in found:
        integrator.step(every)
        sample[:] = np.diag(box_of(context))
    return found
