"""Three of OpenMM's integrators on one vesicle, and what each of them keeps.

    Verlet           the total energy, the momentum and the angular momentum
    LangevinMiddle   the temperature
    Brownian         the distribution of shapes: the same mean energies as LangevinMiddle; and its
                     centre diffuses with D = kBT / (M γ)

The vesicle is a piece of the paper's (doi:10.1103/PhysRevE.108.015301): the same triangles, moduli
and temperature, but 252 vertices and half the radius, so that all takes well under a minute.
"""

import argparse
import sys
import time

import numpy as np
import openmm
from openmm import unit
from openmmhelfrich.analysis import mean_with_error, theory
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import Vesicle
from tqdm import tqdm

TEMPERATURE = 300.0  # K
FRICTION = 0.01  # 1/ps, the paper's
KBT = theory.BOLTZMANN * TEMPERATURE

# Without inertia every time step jumps by √(2 kBT Δt / mγ) along every axis, whatever the forces
# say, so Brownian dynamics needs a shorter one.
TIME_STEPS = {"Verlet": 0.1, "LangevinMiddle": 0.2, "Brownian": 0.02}  # ps


def main(arguments=None):
    options = parse(arguments)
    try:
        run(options)
    except (openmm.OpenMMException, RuntimeError, ValueError) as error:
        sys.exit(f"integrators: {error}")


def parse(arguments):
    parser = argparse.ArgumentParser(
        description="Run Verlet, LangevinMiddle and Brownian dynamics on one vesicle and print "
        "what each conserves."
    )
    parser.add_argument("--vertices", type=int, default=252, help="default: %(default)d")
    parser.add_argument("--radius", type=float, default=500.0, help="nm (default: %(default)g)")
    parser.add_argument("--seed", type=int, default=1, help="of mesh and noise (default: 1)")
    parser.add_argument(
        "--steps", type=int, default=200_000, help="per integrator (default: %(default)d)"
    )
    parser.add_argument(
        "--platform", help="default: the fastest one for membranes, which is Helfrich"
    )
    parser.add_argument("--quick", action="store_true", help="a few seconds, to see that it works")
    options = parser.parse_args(arguments)
    if options.quick:
        options.steps = min(options.steps, 10_000)
    if options.steps < 100:
        parser.error(f"--steps: need 100 or more for a statistic, got {options.steps}")
    return options


def run(options):
    mesh = Mesh.random_sphere(options.vertices, options.radius, options.seed)
    vesicle = Vesicle(mesh)
    print(f"Vesicle of {mesh.num_vertices} vertices, radius {vesicle.radius:.0f} nm, "
          f"{options.steps} steps each", end="")  # fmt: skip
    positions, velocities = equilibrate(vesicle, options)
    for name, make in (
        ("Verlet", openmm.VerletIntegrator),
        ("LangevinMiddle", lambda dt: langevin(openmm.LangevinMiddleIntegrator, dt, options)),
        ("Brownian", lambda dt: langevin(openmm.BrownianIntegrator, dt, options)),
    ):
        step = TIME_STEPS[name]
        simulation = vesicle.simulation(make(step), options.platform)
        simulation.context.setPositions(positions)
        simulation.context.setVelocities(velocities)
        series, speed = sample(simulation, options.steps, name)
        print(f"{name}: {options.steps * step:g} ps in steps of {step} ps, {speed:.0f} steps/s")
        REPORTS[name](series, vesicle, options.steps * step)
        print()


def langevin(kind, step, options):
    integrator = kind(TEMPERATURE, FRICTION, step)
    integrator.setRandomNumberSeed(options.seed)
    return integrator


def equilibrate(vesicle, options):
    """Positions and velocities of the vesicle at 300 K, the start of all three runs."""
    # The strong friction takes the heat away that the relaxing mesh sets free.
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, 0.1, 0.1)
    integrator.setRandomNumberSeed(options.seed)
    simulation = vesicle.simulation(integrator, options.platform)
    print(f", platform {simulation.context.getPlatform().getName()}\n")
    # OpenMM's own tolerance is above all forces of a membrane.
    simulation.minimizeEnergy(tolerance=0.01)
    simulation.context.setVelocitiesToTemperature(TEMPERATURE, options.seed)
    simulation.step(min(20_000, options.steps))
    state = simulation.context.getState(getPositions=True, getVelocities=True)
    return state.getPositions(asNumpy=True), state.getVelocities(asNumpy=True)


class Series:
    """What is recorded at equal intervals: arrays over the samples."""

    def __init__(self, states, mass):
        energy = unit.kilojoule_per_mole
        self.time = np.array([s.getTime().value_in_unit(unit.picosecond) for s in states])
        self.kinetic = np.array([s.getKineticEnergy().value_in_unit(energy) for s in states])
        self.potential = np.array([s.getPotentialEnergy().value_in_unit(energy) for s in states])
        positions, momenta = [], []
        for state in states:
            r = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
            v = state.getVelocities(asNumpy=True).value_in_unit(unit.nanometer / unit.picosecond)
            positions.append(r.mean(axis=0))
            momenta.append([(mass * v).sum(axis=0), mass * np.cross(r, v).sum(axis=0)])
        self.centre = np.array(positions)
        self.momentum, self.angular_momentum = np.array(momenta).transpose(1, 0, 2)


def sample(simulation, steps, name):
    """Run and record about 1000 states; returns the Series and the steps per second."""
    interval = max(1, steps // 1000)
    states = []
    seconds = 0.0
    for _ in tqdm(range(steps // interval), desc=name, leave=False):
        start = time.perf_counter()
        simulation.step(interval)
        seconds += time.perf_counter() - start
        states.append(
            simulation.context.getState(getEnergy=True, getPositions=True, getVelocities=True)
        )
    mass = simulation.system.getParticleMass(0).value_in_unit(unit.dalton)
    series = Series(states, mass)
    if not np.isfinite(series.potential).all():
        raise RuntimeError(f"{name}: the energy is no longer finite; try a shorter time step")
    return series, len(states) * interval / seconds


def drift(time, values):
    """Change of a value over the whole run by a straight line through it."""
    return np.polyfit(time, values, 1)[0] * (time[-1] - time[0])


def report_verlet(series, vesicle, duration):
    total = series.kinetic + series.potential
    kinetic = series.kinetic.mean()
    change = drift(series.time, total)
    scale = np.sqrt(vesicle.mesh.num_vertices * vesicle.mass * 3 * KBT)
    print(f"  total energy       {total.mean():.4f} kJ/mol")
    print(f"  its drift          {change:+.4f} kJ/mol, {abs(change) / kinetic:.1e} of the "
          f"kinetic energy {kinetic:.1f}")  # fmt: skip
    print(f"  its fluctuation    {total.std():.4f} kJ/mol; the kinetic energy's alone is "
          f"{series.kinetic.std():.1f}")  # fmt: skip
    for label, values, unit_scale in (
        ("momentum", series.momentum, scale),
        ("angular momentum", series.angular_momentum, scale * vesicle.radius),
    ):
        change = np.linalg.norm(values - values[0], axis=1).max() / unit_scale
        print(f"  {label:18s} constant within {change:.0e} of its thermal size")


def report_langevin(series, vesicle, duration):
    temperature = 2 * series.kinetic / (3 * vesicle.mesh.num_vertices * theory.BOLTZMANN)
    mean, error, *_ = mean_with_error(temperature)
    print(f"  temperature        {mean:.2f} ± {error:.2f} K, set to {TEMPERATURE:.0f} K")
    mean, error, *_ = mean_with_error(series.potential)
    print(f"  potential energy   {mean:.1f} ± {error:.1f} kJ/mol")


def report_brownian(series, vesicle, duration):
    mean, error, *_ = mean_with_error(series.potential)
    print(f"  potential energy   {mean:.1f} ± {error:.1f} kJ/mol, to compare with LangevinMiddle")
    steps = np.diff(series.centre, axis=0)
    measured = np.mean(steps**2) / (2 * np.diff(series.time).mean())
    expected = KBT / (vesicle.mesh.num_vertices * vesicle.mass * FRICTION)
    error = np.sqrt(2 / steps.size)
    print(f"  diffusion          D = {measured:.4f} ± {measured * error:.4f} nm²/ps of the centre, "
          f"kBT/(Mγ) = {expected:.4f}")  # fmt: skip


REPORTS = {
    "Verlet": report_verlet,
    "LangevinMiddle": report_langevin,
    "Brownian": report_brownian,
}


if __name__ == "__main__":
    main()
