"""Time steps of membranes that OpenMM's GPU platforms evaluate themselves."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from native_vesicle import context_of, forces_of, system_of, vesicle
from platforms import NATIVE, REFERENCE, Target, counting
from running import Running, plain

SINGLE, MIXED, DOUBLE = NATIVE


def spread_of_energy(context: mm.Context) -> float:
    """Between the least and the most in 2000 steps, as a share of the kinetic energy."""
    energies, kinetic = [], []
    for _ in range(10):
        context.getIntegrator().step(200)
        state = context.getState(energy=True)
        kinetic.append(plain(state.getKineticEnergy()))
        energies.append(plain(state.getPotentialEnergy()) + kinetic[-1])
    return np.ptp(energies) / np.mean(kinetic)


@pytest.mark.parametrize("target", [MIXED, DOUBLE], ids=str)
def test_verlet_keeps_its_energy(target: Target):
    mesh, forces = vesicle()
    integrator = mm.VerletIntegrator(0.02)
    context = context_of(target, system_of(mesh.num_vertices), forces, integrator)
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(500)
    assert spread_of_energy(context) < 1e-3


def paper(target: Target, integrator: mm.Integrator) -> mm.Context:
    """The paper's vesicle, N = 1002, in equilibrium."""
    mesh = helfrich.Mesh.random_sphere(1002, radius=1000, seed=1)
    model = helfrich.Vesicle(mesh)
    warm = model.simulation(mm.LangevinMiddleIntegrator(300, 0.01, 0.1), "Helfrich")
    warm.integrator.setRandomNumberSeed(1)
    warm.context.reinitialize()
    warm.context.setPositions(mesh.vertices)
    warm.context.setVelocitiesToTemperature(300, 1)
    warm.step(10_000)
    state = warm.context.getState(positions=True, velocities=True)
    system = model.system()
    for force in helfrich.platforms.membranes_of(system):
        force.setBackend(target.backend)
    context = target.context(system, integrator)
    context.setPositions(state.getPositions(asNumpy=True))
    context.setVelocities(state.getVelocities(asNumpy=True))
    return context


def test_verlet_keeps_the_energy_of_the_papers_vesicle():
    """To a part of 1e5 of the kinetic energy in mixed precision; 20 000 steps keep 1e-6."""
    context = paper(MIXED, mm.VerletIntegrator(0.1))
    assert spread_of_energy(context) < 1e-5


@pytest.mark.parametrize("target", [SINGLE, MIXED], ids=str)
def test_langevin_keeps_the_papers_vesicle_in_its_bath(target: Target):
    integrator = mm.LangevinMiddleIntegrator(300, 1, 0.1)
    integrator.setRandomNumberSeed(1)
    context = paper(target, integrator)
    start = context.getState(positions=True).getPositions(asNumpy=True)
    temperatures = []
    for _ in range(40):
        integrator.step(50)
        kinetic = plain(context.getState(energy=True).getKineticEnergy())
        temperatures.append(kinetic / (1.5 * 1002 * helfrich.analysis.theory.BOLTZMANN))
    # One value has a standard deviation of 7.7 K.
    assert np.mean(temperatures) == pytest.approx(300, abs=5)
    mesh = helfrich.Mesh.random_sphere(1002, radius=1000, seed=1)
    for found in (start, context.getState(positions=True).getPositions(asNumpy=True)):
        now = helfrich.Mesh(plain(found), mesh.triangles)
        assert now.area == pytest.approx(1.006 * mesh.area, rel=2e-3)
        assert now.volume == pytest.approx(mesh.volume, rel=2e-3)


def test_the_device_follows_flips():
    """After rounds of flips its forces are those of the Context's present triangles."""
    mesh, forces = vesicle()
    flips = helfrich.MonteCarloBondFlip(mesh, 300, frequency=5)
    integrator = mm.LangevinMiddleIntegrator(300, 1, 0.01)
    integrator.setRandomNumberSeed(1)
    system = system_of(mesh.num_vertices)
    system.addForce(flips)
    context = context_of(DOUBLE, system, forces, integrator)
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    with counting() as made:
        integrator.step(100)
    assert made["native"] >= 100
    triangles = forces[0].getTrianglesInContext(context)
    assert (triangles != mesh.triangles).any()
    state = context.getState(energy=True, forces=True, positions=True)
    positions = plain(state.getPositions(asNumpy=True))
    expected = Running(forces_of(mesh, triangles), mesh.num_vertices, REFERENCE)
    energy, reference = expected.evaluate(positions)
    assert plain(state.getPotentialEnergy()) == pytest.approx(energy, rel=1e-9)
    found = plain(state.getForces(asNumpy=True))
    assert np.abs(found - reference).max() < 1e-8 * np.abs(reference).max()


@pytest.mark.parametrize("target", [MIXED, DOUBLE], ids=str)
def test_in_a_bath_that_openmm_sorts_and_wraps(target: Target):
    """OpenMM exchanges particles of a bath in memory, and wraps a vesicle on a face of the box."""
    mesh, _ = vesicle()
    rng = np.random.default_rng(2)
    bath = rng.uniform(0, 600, (1000, 3))
    vertices = mesh.vertices + np.array([600, 300, 0])
    bath = bath[np.linalg.norm((bath - [600, 300, 0] + 300) % 600 - 300, axis=1) > 130]
    # The vesicle's particles are in the middle.
    half = len(bath) // 2
    positions = np.concatenate([bath[:half], vertices, bath[half:]])
    system = system_of(len(positions))
    system.setDefaultPeriodicBoxVectors(*(600 * np.eye(3)))
    nonbonded = mm.CustomNonbondedForce("10*step(20-r)*(1-r/20)^2")
    for _ in positions:
        nonbonded.addParticle()
    nonbonded.setNonbondedMethod(nonbonded.CutoffPeriodic)
    nonbonded.setCutoffDistance(25)
    nonbonded.setForceGroup(1)
    system.addForce(nonbonded)
    integrator = mm.LangevinMiddleIntegrator(300, 1, 0.05)
    integrator.setRandomNumberSeed(1)
    context = context_of(target, system, forces_of(mesh, offset=half), integrator)
    context.setPositions(positions)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(600)
    state = context.getState(positions=True, forces=True, energy=True, groups={0})
    reference = Running(forces_of(mesh, offset=half), len(positions), REFERENCE)
    expected = reference.evaluate(plain(state.getPositions(asNumpy=True)))
    found = plain(state.getForces(asNumpy=True))
    assert plain(state.getPotentialEnergy()) == pytest.approx(expected[0], rel=target.tolerance)
    largest = np.abs(expected[1]).max()
    assert largest > 1
    assert np.abs(found - expected[1]).max() < target.tolerance * largest
