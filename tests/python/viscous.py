"""Small Systems with a SurfaceViscosityThermostat, for its tests."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
from flowing import TEMPERATURE, forces_of, start, system_of
from openmm import unit
from platforms import REFERENCE, Target

KT = unit.MOLAR_GAS_CONSTANT_R.value_in_unit(unit.kilojoule_per_mole / unit.kelvin) * TEMPERATURE
Thermostat = helfrich.SurfaceViscosityThermostat


def thermostat_of(triangles, friction: float = 20.0, *, seed: int = 7, **arguments) -> Thermostat:
    """A thermostat of the usual temperature."""
    thermostat = Thermostat(triangles, friction, **({"temperature": TEMPERATURE} | arguments))
    thermostat.setRandomNumberSeed(seed)
    return thermostat


def viscous(
    *further: mm.Force,
    target: Target = REFERENCE,
    integrator: mm.Integrator | None = None,
    masses=50.0,
    forces: list[helfrich.MembraneForce] | None = None,
    **arguments,
) -> tuple[mm.Context, Thermostat]:
    """A Context of the vesicle of `flowing`, with its forces or others, and a thermostat."""
    thermostat = thermostat_of(start(), **arguments)
    forces = forces_of(start()) if forces is None else forces
    for force in forces:
        force.setBackend(target.backend)
    system = system_of(*forces, thermostat, *further)
    for particle, mass in enumerate(np.broadcast_to(masses, start().num_vertices).tolist()):
        system.setParticleMass(particle, mass)
    context = target.context(system, integrator or mm.VerletIntegrator(0.2))
    context.setPositions(start().vertices)
    return context, thermostat


def motion(context: mm.Context) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities as the integrator has them, nm and nm/ps."""
    state = context.getState(positions=True, velocities=True)
    return (
        state.getPositions(asNumpy=True).value_in_unit_system(unit.md_unit_system),
        state.getVelocities(asNumpy=True).value_in_unit_system(unit.md_unit_system),
    )


def velocity_verlet(step: float) -> mm.CustomIntegrator:
    """Half a kick at each end of a step."""
    integrator = mm.CustomIntegrator(step)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    integrator.addComputePerDof("x", "x+dt*v")
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    return integrator


def mean_and_error(samples: np.ndarray, blocks: int = 20) -> tuple[float, float]:
    """The mean of a time series, and its standard error by means of blocks."""
    means = samples[: len(samples) // blocks * blocks].reshape(blocks, -1).mean(axis=1)
    return means.mean(), means.std(ddof=1) / blocks**0.5
