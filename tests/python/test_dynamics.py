"""What the integrators must keep: energy, momentum, temperature, and the equilibrium itself."""

import numpy as np
import openmm
import pytest
from openmm import unit
from openmmhelfrich.analysis import mean_with_error, theory
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import KBT, Vesicle

TEMPERATURE = 300
FRICTION = 0.01
KJ = unit.kilojoule_per_mole


@pytest.fixture(scope="module")
def vesicle():
    """The paper's triangles on a sphere of half its radius, where everything is faster."""
    return Vesicle(Mesh.random_sphere(252, 500, seed=7))


@pytest.fixture(scope="module")
def thermal(vesicle):
    """A State in equilibrium at 300 K."""
    simulation = vesicle.simulation(
        seeded(openmm.LangevinMiddleIntegrator(TEMPERATURE, 0.1, 0.1)), "Reference"
    )
    simulation.minimizeEnergy()
    simulation.context.setVelocitiesToTemperature(TEMPERATURE, 5)
    simulation.step(20_000)
    return simulation.context.getState(getPositions=True, getVelocities=True)


def seeded(integrator):
    integrator.setRandomNumberSeed(11)
    return integrator


def start(vesicle, thermal, integrator):
    context = vesicle.simulation(integrator, "Reference").context
    context.setPositions(thermal.getPositions(asNumpy=True))
    context.setVelocities(thermal.getVelocities(asNumpy=True))
    return context


def run(context, steps, interval):
    """Kinetic and potential energy every `interval` steps, kJ/mol."""
    energies = []
    for _ in range(steps // interval):
        context.getIntegrator().step(interval)
        state = context.getState(getEnergy=True)
        energies.append(
            [
                state.getKineticEnergy().value_in_unit(KJ),
                state.getPotentialEnergy().value_in_unit(KJ),
            ]
        )
    return np.array(energies).T


def momenta(context, mass):
    state = context.getState(getPositions=True, getVelocities=True)
    r = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    v = state.getVelocities(asNumpy=True).value_in_unit(unit.nanometer / unit.picosecond)
    return mass * v.sum(axis=0), mass * np.cross(r, v).sum(axis=0)


def test_verlet_conserves_energy_and_momenta_over_20_ns(vesicle, thermal):
    context = start(vesicle, thermal, openmm.VerletIntegrator(0.1))
    before = momenta(context, vesicle.mass)
    kinetic, potential = run(context, steps=200_000, interval=100)
    total = kinetic + potential
    # Two measures of the drift over the whole run: by a straight line, and by the means of the
    # first and the last tenth. One alone could hide a bend or a jump.
    time = np.linspace(0, 1, len(total))
    drift = np.polyfit(time, total, 1)[0]
    tenth = len(total) // 10
    step = total[-tenth:].mean() - total[:tenth].mean()
    assert abs(drift) < 1e-3 * kinetic.mean()
    assert abs(step) < 1e-3 * kinetic.mean()
    # The vesicle is still warm, within what the canonical draw of its total energy allows.
    assert kinetic.mean() == pytest.approx(1.5 * 252 * KBT, rel=0.12)

    after = momenta(context, vesicle.mass)
    size = np.sqrt(252 * vesicle.mass * 3 * KBT)
    assert np.linalg.norm(after[0] - before[0]) < 1e-8 * size
    assert np.linalg.norm(after[1] - before[1]) < 1e-8 * size * vesicle.radius


def test_smaller_steps_conserve_energy_better(vesicle, thermal):
    """The energy error of Verlet falls as Δt², which it does for exact forces only."""
    spread = []
    for step in (0.2, 0.1):
        context = start(vesicle, thermal, openmm.VerletIntegrator(step))
        kinetic, potential = run(context, steps=int(1000 / step), interval=int(1 / step))
        spread.append((kinetic + potential).std())
    assert 2.5 < spread[0] / spread[1] < 6


@pytest.fixture(scope="module")
def langevin(vesicle, thermal):
    integrator = seeded(openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, 0.2))
    return run(start(vesicle, thermal, integrator), steps=100_000, interval=100)


def test_langevin_middle_holds_300_kelvin(vesicle, langevin):
    temperature = 2 * langevin[0] / (3 * 252 * theory.BOLTZMANN)
    mean, error, *_ = mean_with_error(temperature)
    assert error < 0.004 * TEMPERATURE, "the run is too short to say"
    assert mean == pytest.approx(TEMPERATURE, rel=0.01)


def test_brownian_runs_at_the_papers_friction(vesicle, thermal, langevin):
    """It must find the same equilibrium, and its centre must diffuse with kBT / (M γ)."""
    step = 0.02
    context = start(
        vesicle, thermal, seeded(openmm.BrownianIntegrator(TEMPERATURE, FRICTION, step))
    )
    potential, centre = [], []
    for _ in range(1000):
        context.getIntegrator().step(100)
        state = context.getState(getEnergy=True, getPositions=True)
        potential.append(state.getPotentialEnergy().value_in_unit(KJ))
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        centre.append(positions.mean(axis=0))
    mean, error, *_ = mean_with_error(np.array(potential))
    expected, expected_error, *_ = mean_with_error(langevin[1])
    # A fiftieth for the error of the finite step, which overdamped dynamics makes in first order.
    assert abs(mean - expected) < 4 * np.hypot(error, expected_error) + 0.02 * expected
    moves = np.diff(centre, axis=0)
    measured = np.mean(moves**2) / (2 * 100 * step)
    diffusion = KBT / (252 * vesicle.mass * FRICTION)
    assert measured == pytest.approx(diffusion, rel=4 * np.sqrt(2 / moves.size))
