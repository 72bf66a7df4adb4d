"""A small vesicle whose bonds flip, for the tests of MonteCarloBondFlip."""

from __future__ import annotations

import inspect
from functools import cache

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
from openmm import app, unit
from platforms import REFERENCE, Target

#: Of the thermostats and the flips, K.
TEMPERATURE = 300.0


@cache
def start() -> helfrich.Mesh:
    """An uneven sphere, neither round nor regular."""
    mesh = helfrich.Mesh.random_sphere(92, 100.0, seed=3)
    random = np.random.default_rng(5)
    return helfrich.Mesh(mesh.vertices + random.normal(0, 1.5, mesh.vertices.shape), mesh.triangles)


def forces_of(mesh: helfrich.Mesh, triangles=None) -> list[mm.Force]:
    """Terms of all kinds: of totals, vertices, triangles and edges, with values for elements, a
    reference and domains.
    """
    corners = mesh.triangles if triangles is None else triangles
    rigidity = np.linspace(30.0, 60.0, mesh.num_vertices)
    return [
        helfrich.BendingForce(corners, rigidity, 0.002),
        helfrich.SurfaceAreaForce(corners, 0.5, mesh.area),
        helfrich.EnclosedVolumeForce(corners, 0.01, 0.95 * mesh.volume),
        helfrich.TriangleHeightForce(corners, 4.0, 5.0),
        helfrich.DihedralForce(corners, 3.0),
        helfrich.SkalakForce(corners, 0.01, 0.02, 1.02 * mesh.vertices),
        helfrich.LineTensionForce(corners, 0.2, np.arange(mesh.num_vertices) % 3),
    ]


def mover_of(mesh: helfrich.Mesh, seed: int = 7, **arguments) -> helfrich.MonteCarloBondFlip:
    values = {"temperature": TEMPERATURE, "frequency": 2, "attemptsPerEdge": 0.3} | arguments
    mover = helfrich.MonteCarloBondFlip(mesh, **values)
    mover.setRandomNumberSeed(seed)
    return mover


def system_of(*forces: mm.Force, mass: float = 50.0) -> mm.System:
    system = mm.System()
    for _ in range(start().num_vertices):
        system.addParticle(mass)
    for force in forces:
        system.addForce(force)
    return system


def langevin(step: float = 0.2) -> mm.LangevinMiddleIntegrator:
    integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 0.01, step)
    integrator.setRandomNumberSeed(11)
    return integrator


def flowing(
    target: Target = REFERENCE, integrator: mm.Integrator | None = None, **arguments
) -> tuple[mm.Context, helfrich.MonteCarloBondFlip]:
    """A Context in which bonds flip, and what flips them."""
    mover = mover_of(start(), **arguments)
    forces = forces_of(start())
    for force in forces:
        force.setBackend(target.backend)
    context = target.context(system_of(*forces, mover), integrator or langevin())
    context.setPositions(start().vertices)
    return context, mover


def bits(context: mm.Context) -> tuple[bytes, bytes, bytes]:
    """Positions, velocities and connectivity to the last bit."""
    state = context.getState(getPositions=True, getVelocities=True)
    force = helfrich.BendingForce.cast(context.getSystem().getForce(0))
    return (
        state.getPositions(asNumpy=True)._value.tobytes(),
        state.getVelocities(asNumpy=True)._value.tobytes(),
        force.getTrianglesInContext(context).tobytes(),
    )


def measure(context: mm.Context, groups=-1) -> tuple[float, np.ndarray]:
    state = context.getState(getEnergy=True, getForces=True, groups=groups)
    forces = state.getForces(asNumpy=True).value_in_unit_system(unit.md_unit_system)
    return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole), forces


def simulation_of(mesh: helfrich.Mesh, offset: int = 0, flips: float = 0.1):
    """A fluid vesicle behind so many other particles, each of another mass, and its Simulation."""
    system = mm.System()
    for number in range(offset):
        system.addParticle(10 + number)
    placement = helfrich.Vesicle(mesh, flips=flips).add_to(system)
    integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 0.01, 0.4)
    integrator.setRandomNumberSeed(7)
    platform = mm.Platform.getPlatformByName("Helfrich")
    made = app.Simulation(app.Topology(), system, integrator, platform)
    others = np.random.default_rng(1).normal(size=(offset, 3))
    made.context.setPositions(np.concatenate([others, mesh.vertices]))
    made.context.setVelocitiesToTemperature(TEMPERATURE, 3)
    return placement, made


def arguments_of(cls):
    """The arguments of a class with their defaults, without types."""
    signature = inspect.signature(cls)
    plain = [p.replace(annotation=p.empty) for p in signature.parameters.values()]
    return str(signature.replace(parameters=plain, return_annotation=signature.empty))
