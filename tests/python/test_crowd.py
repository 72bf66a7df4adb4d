"""Many membranes in one Context of platform Helfrich, which its threads evaluate side by side."""

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit

MESHES = [helfrich.Mesh.random_sphere(n, 100.0, seed=n) for n in (92, 162, 52)]
X = np.array([1.0, 0, 0])
KJ = unit.kilojoule_per_mole
FORCE = KJ / unit.nanometer


def forces_on(mesh, first, number):
    """Forces of one vesicle, whose particles follow `first`; each vesicle has others."""
    corners = mesh.triangles + first
    forces = [
        helfrich.BendingForce(corners, 50.0 + number),
        helfrich.SurfaceAreaForce(corners, 2.0, 1.1 * mesh.area),
        helfrich.TriangleHeightForce(corners, mesh.min_height(0.3), 5.0),
    ]
    if number % 2:
        forces.append(helfrich.PressureForce(corners, 1e-3))
    for group, force in enumerate(forces):
        force.setForceGroup(group % 2)
    return forces


def crowd_of(count, between=False):
    """A System of vesicles in a row, and positions; `between` puts bonds between their forces."""
    system, positions = mm.System(), []
    for number in range(count):
        mesh, first = MESHES[number % len(MESHES)], system.getNumParticles()
        for _ in range(mesh.num_vertices):
            system.addParticle(50.0)
        for force in forces_on(mesh, first, number):
            system.addForce(force)
        if between:
            bonds = mm.HarmonicBondForce()
            bonds.addBond(first, first + 1, 1.0, 3.0)
            system.addForce(bonds)
        positions.append(mesh.vertices + 250.0 * number * X)
    return system, np.concatenate(positions)


def context_of(system, positions, threads=2, seed=None):
    if seed is None:
        integrator = mm.VerletIntegrator(0.1)
    else:
        integrator = mm.LangevinMiddleIntegrator(300, 0.01, 0.1)
        integrator.setRandomNumberSeed(seed)
    platform = mm.Platform.getPlatformByName("Helfrich")
    context = mm.Context(system, integrator, platform, {"Threads": str(threads)})
    context.setPositions(positions)
    return context


def found(context, groups=-1):
    state = context.getState(energy=True, forces=True, groups=groups)
    return (
        state.getPotentialEnergy().value_in_unit(KJ),
        state.getForces(asNumpy=True).value_in_unit(FORCE),
    )


@pytest.mark.parametrize("groups", [-1, {0}, {1}])
def test_each_counts_once(groups):
    """Against Contexts of single vesicles."""
    energy, forces = found(context_of(*crowd_of(7)), groups)
    alone, first = 0.0, 0
    for number in range(7):
        mesh = MESHES[number % len(MESHES)]
        system = mm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(50.0)
        for force in forces_on(mesh, 0, number):
            system.addForce(force)
        one, theirs = found(context_of(system, mesh.vertices + 250.0 * number * X), groups)
        alone += one
        np.testing.assert_array_equal(forces[first : first + mesh.num_vertices], theirs)
        first += mesh.num_vertices
    assert energy == pytest.approx(alone, rel=1e-13)


@pytest.mark.parametrize("count", [2, 3, 9])
@pytest.mark.parametrize("between", [False, True])
def test_bits_do_not_depend_on_threads(count, between):
    system, positions = crowd_of(count, between)
    ends = []
    for threads in (1, 2, 3, 5):
        context = context_of(system, positions, threads, seed=4)
        context.setVelocitiesToTemperature(300, 5)
        # Longer than the trials that find out what is faster.
        context.getIntegrator().step(60)
        state = context.getState(positions=True, velocities=True)
        ends.append(
            np.concatenate([state.getPositions(asNumpy=True), state.getVelocities(asNumpy=True)])
        )
    for end in ends[1:]:
        np.testing.assert_array_equal(end, ends[0])


def test_steps_that_share_the_threads():
    """As many particles as it takes for the integrator to use them, too."""
    mesh = helfrich.Mesh.icosphere(15, 100.0)
    system, positions, ends = mm.System(), [], []
    for number in range(2):
        for _ in range(mesh.num_vertices):
            system.addParticle(50.0)
        system.addForce(helfrich.BendingForce(mesh.triangles + number * mesh.num_vertices, 50))
        positions.append(mesh.vertices + 300.0 * number * X)
    assert system.getNumParticles() > 4000
    for threads in (1, 2):
        context = context_of(system, np.concatenate(positions), threads, seed=1)
        context.setVelocitiesToTemperature(300, 2)
        context.getIntegrator().step(40)
        ends.append(context.getState(positions=True).getPositions(asNumpy=True)._value)
    np.testing.assert_array_equal(*ends)


def test_flips_of_each():
    """Forces that are remembered after flips are added once, and to their own particles."""
    system, positions = crowd_of(4)
    first = 0
    for number in range(4):
        mesh = MESHES[number % len(MESHES)]
        flips = helfrich.MonteCarloBondFlip(mesh.triangles + first, 300, 1, 0.5)
        flips.setRandomNumberSeed(number + 1)
        system.addForce(flips)
        first += mesh.num_vertices
    ends = []
    for threads in (1, 3):
        context = context_of(system, positions, threads, seed=4)
        context.setVelocitiesToTemperature(300, 5)
        context.getIntegrator().step(50)
        ends.append(found(context))
        movers = [
            force for force in system.getForces() if helfrich.MonteCarloBondFlip.isinstance(force)
        ]
        assert len(movers) == 4
        for mover in map(helfrich.MonteCarloBondFlip.cast, movers):
            assert mover.getStatistics(context)["accepted"] > 0
    assert ends[0][0] == ends[1][0]
    np.testing.assert_array_equal(ends[0][1], ends[1][1])


def test_parameters_and_their_derivatives():
    system, positions = crowd_of(5)
    for number in range(5):
        mesh = MESHES[number % len(MESHES)]
        first = sum(MESHES[k % 3].num_vertices for k in range(number))
        force = helfrich.SurfaceTensionForce(mesh.triangles + first, 0.5)
        force.setContextParameter("tension", "tension")
        force.addEnergyParameterDerivative("tension")
        system.addForce(force)
    context = context_of(system, positions)
    state = context.getState(energy=True, parameterDerivatives=True)
    areas = sum(MESHES[k % 3].area for k in range(5))
    assert state.getEnergyParameterDerivatives()["tension"] == pytest.approx(areas, rel=1e-12)
    before = state.getPotentialEnergy().value_in_unit(KJ)
    context.setParameter("tension", 0.75)
    assert found(context)[0] - before == pytest.approx(0.25 * areas, rel=1e-9)


@pytest.mark.parametrize("threads", [1, 2])
def test_the_first_that_fails_says_why(threads):
    system, positions = crowd_of(6)
    wrong = positions.copy()
    first = MESHES[0].num_vertices + MESHES[1].num_vertices
    wrong[first + 3] = np.nan
    context = context_of(system, wrong, threads)
    for _ in range(20):
        with pytest.raises(mm.OpenMMException, match=rf"BendingForce: .*particle {first + 3}\b"):
            found(context)
    # It goes on once they are right.
    context.setPositions(positions)
    energy, forces = found(context)
    other = found(context_of(system, positions, threads))
    assert energy == other[0]
    np.testing.assert_array_equal(forces, other[1])


def test_what_contacts_join_is_evaluated_too():
    """A SurfaceRepulsionForce on all triangles, and one vesicle with particles of its own."""
    system, positions = crowd_of(3)
    alone = found(context_of(system, positions))
    corners = []
    first = 0
    for number in range(3):
        corners.append(MESHES[number].triangles + first)
        first += MESHES[number].num_vertices
    repulsion = helfrich.SurfaceRepulsionForce(np.concatenate(corners), 5.0, 2.0)
    repulsion.setForceGroup(7)
    system.addForce(repulsion)
    context = context_of(system, positions)
    together, only = found(context), found(context, {7})
    assert together[0] == pytest.approx(alone[0] + only[0], rel=1e-12)
    np.testing.assert_allclose(together[1], alone[1] + only[1], rtol=0, atol=1e-9)


def test_two_triangulations_of_the_same_particles():
    mesh = MESHES[0]
    corners = [mesh.triangles, np.roll(mesh.triangles, 1, axis=0)]
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    for each in corners:
        system.addForce(helfrich.BendingForce(each, 50))
    energy, forces = found(context_of(system, mesh.vertices))
    assert energy == pytest.approx(2 * mesh.energy(helfrich.BendingForce(mesh, 50)), rel=1e-12)
    system.removeForce(0)
    _, once = found(context_of(system, mesh.vertices))
    np.testing.assert_allclose(forces, 2 * once, rtol=1e-12, atol=1e-9)
