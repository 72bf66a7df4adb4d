"""A Context that has seen what no simulation survives goes on as a new one does."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT, Case
from meshes import Membrane, membrane
from openmmhelfrich._snapshots import Snapshot
from platforms import HELFRICH, NATIVE, ON_GPU, ON_PROCESSOR, REFERENCE, Target, sparing
from running import Running

# Contacts act where things touch.
PLACES = [
    pytest.param(case, where, id=f"{case}-{where}")
    for case in PRESENT
    for where in ([meshes.TOUCHING_NAMES[0]] if case.is_contact else [case.place("jittered")])
]


def broken(good: np.ndarray, members: np.ndarray) -> Iterator[np.ndarray]:
    """Positions of a simulation that breaks down: some fly away, or all, or are no numbers."""
    one = members[len(members) // 2]
    for far in (1e4, 1e10, 1e16, 1e22, 1e40, 1e80, 1e160, 1e300, np.inf, np.nan):
        flown = good.copy()
        flown[one] *= far
        yield flown
    for scale in (1e10, 1e16, 1e22, 1e40, 1e80, 1e160, 1e300, np.nan):
        yield good * scale
    flat = good.copy()
    flat[:, 2] = 0
    yield flat
    yield np.zeros_like(good)


def check(running: Running, m: Membrane) -> None:
    energy, forces = running.evaluate(m.positions)
    assert np.isfinite(energy)
    for bad in broken(m.positions, m.members):
        # A second evaluation looks whether the first one has left something that it takes for good.
        for _ in range(2):
            with suppress(mm.OpenMMException):
                running.evaluate(bad)
        again = running.evaluate(m.positions)
        assert again[0] == energy
        assert np.array_equal(again[1], forces)


@pytest.mark.parametrize(("case", "where"), PLACES)
def test_each(case: Case, where: str):
    m = membrane(where)
    check(Running([case.make(m)], m.num_particles, HELFRICH), m)


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_GPU, *sparing(NATIVE)], ids=str)
def test_the_paper_forces_together(target: Target):
    m = membrane("jittered")
    forces = [
        helfrich.BendingForce(m.triangles, 50.0),
        helfrich.SurfaceAreaForce(m.triangles, 1.3, 2.0),
        helfrich.EnclosedVolumeForce(m.triangles, 1e-3, 1.0),
        helfrich.TriangleHeightForce(m.triangles, 0.3, 10.0),
    ]
    check(Running(forces, m.num_particles, target), m)


INTEGRATORS = {
    "Verlet": lambda: mm.VerletIntegrator(0.2),
    "LangevinMiddle": lambda: mm.LangevinMiddleIntegrator(300, 0.01, 0.2),
    "Brownian": lambda: mm.BrownianIntegrator(300, 1.0, 0.2),
    "variable mass, Verlet": lambda: helfrich.VariableMassVerletIntegrator(0.2),
    "variable mass, Langevin": lambda: helfrich.VariableMassLangevinIntegrator(300, 0.01, 0.2),
}


@pytest.mark.parametrize("target", [HELFRICH, REFERENCE], ids=str)
@pytest.mark.parametrize("name", INTEGRATORS)
def test_steps_are_repeated(name: str, target: Target):
    """With all movers, contacts and the thermostat: the run goes on as if nothing had been."""
    mesh = helfrich.Mesh.icosphere(3, 100.0)
    integrator = INTEGRATORS[name]()
    # Masses that vary leave no movers.
    movers = []
    if not name.startswith("variable"):
        movers += [
            helfrich.MonteCarloBondFlip(mesh, 300, 2, 0.2),
            helfrich.MonteCarloDomainSwap(mesh, 300, 2, 0.5),
        ]
    if name in ("Verlet", "LangevinMiddle"):
        movers.append(helfrich.SurfaceViscosityThermostat(mesh, 5.0, temperature=300))
    for stochastic in (integrator, *movers):
        if hasattr(stochastic, "setRandomNumberSeed"):
            stochastic.setRandomNumberSeed(3)
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    bending = helfrich.BendingForce(mesh, np.linspace(20.0, 60.0, mesh.num_vertices))
    for force in (
        bending,
        helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area),
        helfrich.EnclosedVolumeForce(mesh, 1e-3, mesh.volume),
        helfrich.TriangleHeightForce(mesh, 3.0, 10.0),
        helfrich.SurfaceRepulsionForce(mesh, 20.0, 2.5),
        *movers,
    ):
        system.addForce(force)
    context = target.context(system, integrator)
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(20)
    start = Snapshot.take(context)

    def onwards():
        start.restore(context)
        integrator.step(20)
        state = context.getState(getPositions=True, getVelocities=True)
        return (
            state.getPositions(asNumpy=True)._value,
            state.getVelocities(asNumpy=True)._value,
            bending.getTrianglesInContext(context),
            bending.getPermutationInContext(context),
        )

    first = onwards()
    assert np.array_equal(first[2], mesh.triangles) == (not movers)
    for bad in broken(first[0], np.arange(mesh.num_vertices)):
        with suppress(mm.OpenMMException):
            context.setPositions(bad)
            integrator.step(3)
        assert all(map(np.array_equal, onwards(), first))
