"""Flips come between two half kicks, whatever integrator drives them."""

import numpy as np
import openmm as mm
import pytest
from flowing import TEMPERATURE, flowing, forces_of, measure, start, system_of
from openmm import unit
from platforms import HELFRICH, NATIVE, ON_OPENCL, REFERENCE

STEP = 0.2  # ps


def kicked(context):
    """Velocities, nm/ps, as the integrator keeps them."""
    state = context.getState(getVelocities=True)
    return state.getVelocities(asNumpy=True).value_in_unit(unit.nanometer / unit.picosecond)


def forces_with(triangles, positions):
    """Of all membrane forces of a Context with these triangles."""
    context = REFERENCE.context(system_of(*forces_of(start(), triangles)))
    context.setPositions(positions)
    return measure(context)[1]


LEAPFROGS = {
    "Verlet": lambda: mm.VerletIntegrator(STEP),
    "LangevinMiddle": lambda: mm.LangevinMiddleIntegrator(TEMPERATURE, 0.0, STEP),
    "Langevin": lambda: mm.LangevinIntegrator(TEMPERATURE, 0.0, STEP),
    "NoseHoover": lambda: mm.NoseHooverIntegrator(STEP),
    "QTB": lambda: mm.QTBIntegrator(TEMPERATURE, 1e-26, STEP),
    "DPD": lambda: mm.DPDIntegrator(TEMPERATURE, 0.0, 1.0, STEP),
}


@pytest.mark.parametrize("name", LEAPFROGS)
@pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
def test_a_leapfrog_gives_half_a_kick_of_either(name, target):
    context, mover = flowing(target, LEAPFROGS[name](), frequency=1)
    context.setVelocitiesToTemperature(TEMPERATURE, 5)
    before = kicked(context)
    positions = context.getState(getPositions=True).getPositions(asNumpy=True)
    triangles = mover.getTrianglesInContext(context)
    context.getIntegrator().step(1)
    assert mover.getStatistics(context)["accepted"] > 5
    old = forces_with(triangles, positions)
    new = forces_with(mover.getTrianglesInContext(context), positions)
    mass = context.getSystem().getParticleMass(0).value_in_unit(unit.dalton)
    found = kicked(context) - before
    expected = 0.5 * STEP / mass * (old + new)
    # A whole kick of the forces after the flips would be something else.
    scale = np.abs(expected).max()
    assert np.abs(STEP / mass * new - expected).max() > 0.05 * scale
    tolerance = 1e-5 if target.platform == "OpenCL" else 1e-9
    assert np.abs(found - expected).max() < tolerance * scale
