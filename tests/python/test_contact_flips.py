"""Bond flips on surfaces that touch, and forces that follow the flips of several vesicles."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import forces_of, langevin, mover_of, start
from platforms import HELFRICH, ON_OPENCL, REFERENCE

DISTANCE, EPSILON = 5.0, 4.0


def pressed(count: int = 2) -> tuple[list[helfrich.Mesh], np.ndarray, list[np.ndarray]]:
    """Vesicles side by side that touch, the first with a bead beside it."""
    one = start()
    step = np.ptp(one.vertices[:, 0]) + 0.9 * DISTANCE
    positions = [one.vertices + np.array([k * step, 3 * k, 5 * k]) for k in range(count)]
    offsets = one.num_vertices * np.arange(count)
    triangles = [one.triangles + offset for offset in offsets]
    bead = [[one.vertices[:, 0].min() - 18, 0, 0]]
    return [one] * count, np.vstack([*positions, bead]), triangles


def several(target=REFERENCE, count: int = 2, **arguments):
    """A Context of vesicles that flow and keep apart."""
    vesicles, positions, triangles = pressed(count)
    system = mm.System()
    for _ in positions:
        system.addParticle(50.0)
    movers = []
    wall = helfrich.SurfaceRepulsionForce(np.vstack(triangles), DISTANCE, EPSILON)
    bead = helfrich.ParticleSurfaceForce(
        np.vstack(triangles), [len(positions) - 1], 8.0, 2.0, 0.01, 12.0, "LennardJones"
    )
    # One before the membranes' own forces and one after them.
    system.addForce(wall)
    for vesicle, corners in zip(vesicles, triangles, strict=True):
        for force in forces_of(vesicle, corners):
            system.addForce(force)
        movers.append(helfrich.MonteCarloBondFlip(corners, 300.0, **arguments))
        movers[-1].setRandomNumberSeed(len(movers))
        system.addForce(movers[-1])
    system.addForce(bead)
    context = target.context(system, langevin())
    context.setPositions(positions)
    return context, wall, bead, movers


def energy(context):
    return context.getState(energy=True).getPotentialEnergy()._value


@pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2]], ids=str)
def test_forces_of_several_vesicles_follow_all_flips(target):
    context, wall, bead, movers = several(target, frequency=2, attemptsPerEdge=0.5)
    context.setVelocitiesToTemperature(300, 1)
    context.getIntegrator().step(40)
    assert all(mover.getStatistics(context)["accepted"] > 20 for mover in movers)
    present = np.vstack([mover.getTrianglesInContext(context) for mover in movers])
    for force in (wall, bead):
        assert (force.getTrianglesInContext(context) == present).all()
    # A Context that begins with these triangles has the same energy.
    fresh = mm.System()
    for _ in range(context.getSystem().getNumParticles()):
        fresh.addParticle(1.0)
    fresh.addForce(helfrich.SurfaceRepulsionForce(present, DISTANCE, EPSILON))
    particles = bead.getParticles()
    arguments = (8.0, 2.0, 0.01, 12.0, "LennardJones")
    fresh.addForce(helfrich.ParticleSurfaceForce(present, particles, *arguments))
    other = REFERENCE.context(fresh)
    state = context.getState(positions=True)
    other.setPositions(state.getPositions())
    for force in (wall, bead):
        force.setEpsilon(0)
    bead.setAdhesion(0)
    before = energy(context)
    for force in (wall, bead):
        force.updateParametersInContext(context)
    assert before - energy(context) == pytest.approx(energy(other), rel=1e-6)
    assert abs(energy(other)) > 1e-3


def test_a_demon_pays_for_contacts():
    """The energy of all terms and of the demons is kept by flips at rest."""
    vesicles, positions, triangles = pressed()
    system = mm.System()
    for _ in positions:
        system.addParticle(0.0)
    movers = []
    system.addForce(helfrich.SurfaceRepulsionForce(np.vstack(triangles), DISTANCE, EPSILON))
    bead = [len(positions) - 1]
    system.addForce(
        helfrich.ParticleSurfaceForce(np.vstack(triangles), bead, 8.0, 2.0, 0.05, 12.0, "NineThree")
    )
    for vesicle, corners in zip(vesicles, triangles, strict=True):
        for force in forces_of(vesicle, corners):
            system.addForce(force)
        mover = helfrich.MonteCarloBondFlip(corners, 300.0, frequency=1, attemptsPerEdge=2.0)
        mover.setEnsemble(mover.Microcanonical)
        mover.setRandomNumberSeed(5)
        movers.append(mover)
        system.addForce(mover)
    context = REFERENCE.context(system, mm.VerletIntegrator(0.001))
    context.setPositions(positions)

    def total():
        demons = sum(mover.getStatistics(context)["demonEnergy"] for mover in movers)
        return energy(context) + demons

    expected = total()
    for _ in range(30):
        context.getIntegrator().step(1)
        assert total() == pytest.approx(expected, rel=1e-9)
    assert all(mover.getStatistics(context)["accepted"] > 50 for mover in movers)


def test_flips_see_particles_that_only_new_triangles_reach():
    """A folded sheet of two triangles, and a bead where the other diagonal would be."""
    corners = [[0, 0, 0], [0, 10, 0], [10, 5, 0], [0, 5, 10]]
    mesh = helfrich.Mesh(corners, [[0, 1, 2], [1, 0, 3]])
    for bead, passes in ([5.02, 5, 5], False), ([5.5, 5, 5], True):
        system = mm.System()
        for _ in range(5):
            system.addParticle(0.0)
        system.addForce(helfrich.ParticleSurfaceForce(mesh, [4], 0.2, 3.0))
        mover = helfrich.MonteCarloBondFlip(mesh, 300.0, frequency=1, attemptsPerEdge=20.0)
        mover.setRandomNumberSeed(5)
        system.addForce(mover)
        context = REFERENCE.context(system, mm.VerletIntegrator(0.001))
        context.setPositions([*corners, bead])
        assert energy(context) == 0
        context.getIntegrator().step(4)
        assert energy(context) == 0
        assert (mover.getStatistics(context)["accepted"] > 10) == passes


@pytest.mark.parametrize("seed", range(12))
def test_a_demon_pays_for_beads_of_a_crumpled_vesicle(seed):
    """Many flips in a row make edges longer than any that there was."""
    generator = np.random.default_rng(seed)
    mesh = helfrich.Mesh.random_sphere(42 if seed % 2 else 92, 10.0, seed=seed)
    vertices = mesh.vertices + generator.normal(0, 2.0, mesh.vertices.shape)
    beads = generator.uniform(-14, 14, (400, 3))
    system = mm.System()
    for _ in range(len(vertices) + len(beads)):
        system.addParticle(0.0)
    particles = np.arange(len(beads)) + len(vertices)
    system.addForce(helfrich.ParticleSurfaceForce(mesh, particles, 0.3, 0.01))
    system.addForce(helfrich.BendingForce(mesh, 1e-9))
    mover = helfrich.MonteCarloBondFlip(mesh, 300, frequency=1, attemptsPerEdge=8, maxDegree=30)
    mover.setEnsemble(mover.Microcanonical)
    mover.setRandomNumberSeed(seed + 1)
    system.addForce(mover)
    context = REFERENCE.context(system, mm.VerletIntegrator(0.001))
    context.setPositions(np.vstack([vertices, beads]))
    expected = energy(context)
    for _ in range(3):
        context.getIntegrator().step(1)
        total = energy(context) + mover.getStatistics(context)["demonEnergy"]
        assert total == pytest.approx(expected, rel=1e-9)
    assert mover.getStatistics(context)["accepted"] > 10


def test_what_does_not_follow_is_refused():
    vesicles, positions, triangles = pressed()
    system = mm.System()
    for _ in positions:
        system.addParticle(50.0)
    system.addForce(mover_of(vesicles[0]))
    system.addForce(helfrich.SurfaceAreaForce(np.vstack(triangles), 1.0, 1.0))
    with pytest.raises(mm.OpenMMException, match="belongs to two different triangulations"):
        REFERENCE.context(system)
    system.removeForce(1)
    # Not one after another: the second's triangles are among the first's.
    mixed = np.vstack([triangles[0][1:], triangles[1], triangles[0][:1]])
    system.addForce(helfrich.SurfaceRepulsionForce(mixed, DISTANCE, EPSILON))
    with pytest.raises(mm.OpenMMException, match="one after another"):
        REFERENCE.context(system)


def test_triangles_are_set_where_they_belong_and_come_with_checkpoints():
    context, wall, _, _ = several(HELFRICH, frequency=2, attemptsPerEdge=0.5)
    with pytest.raises(mm.OpenMMException, match="SurfaceRepulsionForce: these triangles follow"):
        wall.setTrianglesInContext(context, wall.getTrianglesInContext(context))
    context.getIntegrator().step(10)
    checkpoint = context.createCheckpoint()
    seen = []
    for again in range(2):
        if again:
            context.loadCheckpoint(checkpoint)
        context.getIntegrator().step(10)
        state = context.getState(positions=True, energy=True)
        triangles = wall.getTrianglesInContext(context)
        seen.append((state.getPotentialEnergy()._value, triangles.tobytes()))
        positions = state.getPositions(asNumpy=True)._value.tobytes()
        seen[-1] += (positions,)
    assert seen[0] == seen[1]
    context.reinitialize(preserveState=True)
    assert (wall.getTrianglesInContext(context).tobytes()) == seen[0][1]
    assert energy(context) == pytest.approx(seen[0][0], rel=1e-9)


def test_one_surface_flips_with_its_contacts():
    """All forces on the same triangles, pressed flat: the energy and the demon's are kept."""
    mesh = start()
    vertices = mesh.vertices * [1, 1, 0.12]
    system = mm.System()
    for _ in vertices:
        system.addParticle(0.0)
    system.addForce(helfrich.BendingForce(mesh, 20.0))
    system.addForce(helfrich.SurfaceRepulsionForce(mesh, 2 * DISTANCE, EPSILON))
    mover = mover_of(mesh, frequency=1, attemptsPerEdge=2.0, maxEdgeLength=60.0)
    mover.setEnsemble(mover.Microcanonical)
    system.addForce(mover)
    context = REFERENCE.context(system, mm.VerletIntegrator(0.001))
    context.setPositions(vertices)
    expected = energy(context)
    for _ in range(50):
        context.getIntegrator().step(1)
        now = energy(context) + mover.getStatistics(context)["demonEnergy"]
        assert now == pytest.approx(expected, rel=1e-9)
    assert mover.getStatistics(context)["accepted"] > 50


def test_flips_that_are_refused_leave_contacts_as_they_are():
    mesh = helfrich.Mesh.icosphere(5, 20)
    squashed = mesh.vertices * [1, 1, 0.07]
    noise = np.random.default_rng(5).normal(scale=0.2, size=squashed.shape)
    mesh = helfrich.Mesh(squashed + noise * [1, 1, 0.1], mesh.triangles)

    def forces(triangles):
        yield helfrich.SurfaceRepulsionForce(triangles, 2.0, 2.5)
        # Nothing flips against it.
        yield helfrich.BendingForce(triangles, 1e3)

    flips = helfrich.MonteCarloBondFlip(mesh, 1.0, 1, 1.0)
    flips.setRandomNumberSeed(3)

    def energies(context):
        state = context.getState(getEnergy=True, getForces=True)
        return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value

    def context_of(*all_forces):
        system = mm.System()
        for _ in range(mesh.num_vertices):
            # So heavy that they stay.
            system.addParticle(1e30)
        for force in all_forces:
            system.addForce(force)
        platform = mm.Platform.getPlatformByName("Helfrich")
        context = mm.Context(system, mm.VerletIntegrator(1e-6), platform)
        context.setPositions(mesh.vertices)
        return context

    context = context_of(*forces(mesh.triangles), flips)
    refused_rounds = 0
    for _ in range(40):
        before = flips.getStatistics(context)["accepted"]
        context.getIntegrator().step(1)
        refused_rounds += flips.getStatistics(context)["accepted"] == before
        fresh = context_of(*forces(flips.getTrianglesInContext(context)))
        (energy, forces_now), (expected, forces_then) = energies(context), energies(fresh)
        assert energy == pytest.approx(expected, rel=1e-12)
        largest = np.abs(forces_then).max()
        np.testing.assert_allclose(forces_now, forces_then, atol=1e-12 * largest)
    assert refused_rounds > 5


def test_lists_that_followed_flips_have_the_same_bits_as_new_ones():
    """Flips renew the lists where triangles have changed; a new Context makes all of them."""
    mesh = start()
    vertices = mesh.vertices * [1, 1, 0.12]
    positions = np.array(vertices)

    def context_of(triangles, *movers):
        system = mm.System()
        for _ in vertices:
            system.addParticle(0.0)
        wall = helfrich.SurfaceRepulsionForce(triangles, 2 * DISTANCE, EPSILON)
        wall.setForceGroup(1)
        for force in (wall, helfrich.BendingForce(triangles, 20.0), *movers):
            system.addForce(force)
        context = REFERENCE.context(system, mm.VerletIntegrator(0.001))
        context.setPositions(positions)
        return context

    def bits(context):
        state = context.getState(energy=True, forces=True, groups={1})
        return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value.tobytes()

    mover = mover_of(mesh, frequency=1, attemptsPerEdge=0.1, maxEdgeLength=60.0)
    context = context_of(mesh.triangles, mover)
    rng = np.random.default_rng(2)
    seen = set()
    for _ in range(20):
        positions += rng.normal(scale=0.1, size=positions.shape)
        context.setPositions(positions)
        context.getIntegrator().step(1)
        seen.add(bits(context))
        assert bits(context) == bits(context_of(mover.getTrianglesInContext(context)))
    assert len(seen) == 20 and mover.getStatistics(context)["accepted"] > 10
