"""Surfaces and particles that do not pass: against brute force in numpy, on all platforms."""

from __future__ import annotations

import copy
import pickle

import contact_twin as twin
import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import platforms
import pytest
from running import plain

DISTANCE, EPSILON = 5.0, 2.5
ON_ALL = platforms.ON_PROCESSOR + platforms.ON_OPENCL


def crumpled(seed: int = 4) -> meshes.Membrane:
    """A disk so thin that its sides touch, and a small sphere beside it that touches, too."""
    rng = np.random.default_rng(seed)
    vertices, triangles = meshes.icosphere(4)
    thickness = 2.0 + 60 * (vertices[:, :2] ** 2).sum(axis=1)
    vertices = vertices * np.stack([np.full(162, 50), np.full(162, 60), thickness], axis=1)
    disk = meshes.rough((vertices, triangles), rng, 0.08)
    small = meshes.rough(meshes.icosphere(1), rng, 0.08)
    small = meshes.moved(small, scale=(12, 12, 12), shift=(10, 5, 23))
    return meshes.embedded("crumpled", meshes.disjoint(disk, small), seed)


@pytest.fixture(scope="module")
def membrane() -> meshes.Membrane:
    return crumpled()


def beads(m: meshes.Membrane) -> tuple[np.ndarray, np.ndarray]:
    """Particles beside vertices, some near the surface, and all positions with them."""
    rng = np.random.default_rng(1)
    centre = m.positions[m.members].mean(axis=0)
    tried = m.positions[rng.choice(m.members, 300)] + rng.uniform(-9, 9, (300, 3))
    nearest = twin.nearest(tried, m.positions[m.triangles])
    gaps = np.linalg.norm(tried[:, None] - nearest, axis=2).min(axis=1)
    added = tried[(gaps > 4) & (gaps < 9)][:30]
    far = centre + rng.uniform(-200, 200, (20, 3))
    positions = np.vstack([m.positions, added, far])
    return positions, np.arange(m.num_particles, len(positions))[rng.permutation(50)]


def particle_force(m, particles, **changed):
    rng = np.random.default_rng(2)
    arguments = {
        "distance": 5.0,
        "epsilon": EPSILON,
        "adhesion": 0.3,
        "radius": rng.uniform(0, 1.5, len(particles)),
        "attraction": "NineThree",
    }
    return helfrich.ParticleSurfaceForce(m.triangles, particles, **{**arguments, **changed})


def evaluate(target, force, positions, groups=-1):
    system = mm.System()
    for _ in positions:
        system.addParticle(1.0)
    system.addForce(force)
    context = target.context(system)
    context.setPositions(positions)
    state = context.getState(energy=True, forces=True, groups=groups)
    unit = mm.unit.kilojoule_per_mole
    forces = state.getForces(asNumpy=True).value_in_unit(unit / mm.unit.nanometer)
    return state.getPotentialEnergy().value_in_unit(unit), forces


@pytest.mark.parametrize("target", ON_ALL, ids=str)
@pytest.mark.parametrize("between", [False, True])
def test_the_repulsion_is_that_of_all_pairs(target, membrane, between):
    force = helfrich.SurfaceRepulsionForce(membrane.triangles, DISTANCE, EPSILON)
    force.setOnlyBetweenParts(between)
    energy, forces = evaluate(target, force, membrane.positions)
    part = parts(membrane) if between else None
    arguments = (membrane.triangles, DISTANCE, EPSILON, part)
    expected = twin.surface_repulsion(membrane.positions, *arguments)
    assert expected > 1
    assert energy == pytest.approx(expected, rel=target.tolerance)
    scale = np.abs(forces).max()
    assert np.abs(forces.sum(axis=0)).max() < 100 * target.tolerance * scale
    torque = np.cross(membrane.positions, forces).sum(axis=0)
    assert np.abs(torque).max() < 1e5 * target.tolerance * scale
    for particle in np.argsort(-np.abs(forces).max(axis=1))[:3]:
        for axis in range(3):
            step = np.zeros_like(membrane.positions)
            step[particle, axis] = h = 1e-4
            there, back = (
                twin.surface_repulsion(membrane.positions + s * step, *arguments) for s in (1, -1)
            )
            error = forces[particle, axis] - (back - there) / (2 * h)
            assert abs(error) < max(1e-6, target.tolerance) * scale


def parts(m: meshes.Membrane) -> np.ndarray:
    """For each particle the lowest vertex that it is connected with."""
    labels = np.arange(m.num_particles)
    while True:
        lowest = labels[m.triangles].min(axis=1)
        updated = labels.copy()
        np.minimum.at(updated, m.triangles, lowest[:, None])
        if (updated == labels).all():
            return labels
        labels = updated


@pytest.mark.parametrize("target", ON_ALL, ids=str)
@pytest.mark.parametrize("attraction", ["WCA", "LennardJones", "NineThree"])
def test_particles_feel_all_triangles(target, membrane, attraction):
    positions, particles = beads(membrane)
    force = particle_force(membrane, particles, attraction=attraction)
    radius = np.array(force.getParticleRadius())
    energy, forces = evaluate(target, force, positions)
    arguments = (membrane.triangles, particles, 5.0, EPSILON, 0.3, radius, attraction)
    expected = twin.particle_surface(positions, *arguments)
    core = twin.particle_surface(positions, *arguments[:4], 0.0, radius)
    assert core > 1 and (expected < core) == (attraction != "WCA")
    assert energy == pytest.approx(expected, rel=target.tolerance, abs=target.tolerance * core)
    scale = np.abs(forces).max()
    assert np.abs(forces.sum(axis=0)).max() < 100 * target.tolerance * scale
    for particle in [*np.argsort(-np.abs(forces).max(axis=1))[:3], particles[0], particles[7]]:
        for axis in range(3):
            step = np.zeros_like(positions)
            step[particle, axis] = h = 1e-4
            there, back = (twin.particle_surface(positions + s * step, *arguments) for s in (1, -1))
            error = forces[particle, axis] - (back - there) / (2 * h)
            assert abs(error) < max(1e-6, target.tolerance) * scale


def test_neither_threads_nor_the_age_of_lists_show(membrane):
    """A walk that comes back, on one thread and two, and a new Context, have the same bits."""
    positions, particles = beads(membrane)
    rng = np.random.default_rng(3)
    walk = [positions + s * rng.normal(size=positions.shape) for s in (0, 0.01, 1.5, 0.3, 0)]
    seen = []
    for threads in ("1", "2"):
        system = mm.System()
        for _ in positions:
            system.addParticle(1.0)
        system.addForce(helfrich.SurfaceRepulsionForce(membrane.triangles, DISTANCE, EPSILON))
        system.addForce(particle_force(membrane, particles))
        platform = mm.Platform.getPlatformByName("Helfrich")
        context = mm.Context(system, mm.VerletIntegrator(0.001), platform, {"Threads": threads})
        for there in [*walk, *walk]:
            context.setPositions(there)
            state = context.getState(energy=True, forces=True)
            forces = state.getForces(asNumpy=True)
            seen.append((state.getPotentialEnergy()._value, forces._value.tobytes()))
    assert seen[0] != seen[1]
    for start in range(5):
        assert len(set(seen[start::5])) == 1
    assert seen[0] == seen[4]


@pytest.mark.parametrize("target", platforms.ON_PROCESSOR, ids=str)
def test_context_parameters_and_their_derivatives(target, membrane):
    positions, particles = beads(membrane)
    surface = helfrich.SurfaceRepulsionForce(membrane.triangles, DISTANCE, EPSILON)
    bead = particle_force(membrane, particles, radius=1.5)
    system = mm.System()
    for _ in positions:
        system.addParticle(1.0)
    names = []
    for force, scalars in (
        (surface, ("distance", "epsilon")),
        (bead, ("distance", "epsilon", "adhesion", "radius")),
    ):
        for scalar in scalars:
            names.append(f"{type(force).__name__} {scalar}")
            force.setContextParameter(scalar, names[-1])
            force.addEnergyParameterDerivative(names[-1])
        system.addForce(force)
    context = target.context(system)
    context.setPositions(positions)
    derivatives = context.getState(parameterDerivatives=True).getEnergyParameterDerivatives()

    def energy(name, value):
        context.setParameter(name, value)
        return context.getState(energy=True).getPotentialEnergy()._value

    for name in names:
        value = context.getParameter(name)
        h = 1e-5 * value
        expected = (energy(name, value + h) - energy(name, value - h)) / (2 * h)
        context.setParameter(name, value)
        assert derivatives[name] == pytest.approx(expected, rel=1e-6)


def test_groups_are_apart(membrane):
    """Energies of force groups add up, also where lists serve two distances."""
    total = 0
    system = mm.System()
    for _ in range(membrane.num_particles):
        system.addParticle(1.0)
    for group, distance in enumerate((DISTANCE, 0.9 * DISTANCE)):
        force = helfrich.SurfaceRepulsionForce(membrane.triangles, distance, EPSILON)
        force.setForceGroup(group)
        system.addForce(force)
        total += twin.surface_repulsion(membrane.positions, membrane.triangles, distance, EPSILON)
    bending = helfrich.BendingForce(membrane.triangles, 50)
    bending.setForceGroup(2)
    system.addForce(bending)
    context = platforms.REFERENCE.context(system)
    context.setPositions(membrane.positions)

    def energy(groups):
        return context.getState(energy=True, groups=groups).getPotentialEnergy()._value

    apart = [energy({group}) for group in (0, 1, 2, 1)]
    assert apart[0] + apart[1] == pytest.approx(total, rel=1e-9)
    assert apart[1] == apart[3] and 0 < apart[1] < apart[0]
    assert energy({0, 1, 2}) == pytest.approx(sum(apart[:3]), rel=1e-12)


def test_forces_survive_xml_copies_and_pickles(membrane):
    positions, particles = beads(membrane)
    bead = particle_force(membrane, particles)
    surface = helfrich.SurfaceRepulsionForce(membrane.triangles, DISTANCE, EPSILON)
    surface.setOnlyBetweenParts(True)
    for force in (bead, surface):
        expected = evaluate(platforms.REFERENCE, copy.copy(force), positions)
        xml = mm.XmlSerializer.serialize(force)
        again = type(force).cast(mm.XmlSerializer.deserialize(xml))
        assert mm.XmlSerializer.serialize(again) == xml
        for other in (again, pickle.loads(pickle.dumps(force))):
            energy, forces = evaluate(platforms.REFERENCE, copy.copy(other), positions)
            assert energy == expected[0] and (forces == expected[1]).all()
    assert bead.getParticles().tolist() == particles.tolist()
    broken = mm.XmlSerializer.serialize(bead).replace('index="', 'index="x')
    with pytest.raises(mm.OpenMMException, match=r"ParticleSurfaceForce.*not an integer"):
        mm.XmlSerializer.deserialize(broken)


@pytest.mark.parametrize(
    ("particles", "message"),
    [
        ([1000], "particle 1000 .* indices run from 0 to"),
        ([-1], "particle -1"),
        ([0, 0], "particle 0 .* twice"),
        ("vertex", "particle [0-9]+ .* SurfaceRepulsionForce"),
    ],
)
def test_particles_that_cannot_be_are_refused(membrane, particles, message):
    given = [int(membrane.members[3])] if particles == "vertex" else particles
    force = helfrich.ParticleSurfaceForce(membrane.triangles, given, 1.0, 1.0)
    with pytest.raises(mm.OpenMMException, match=f"ParticleSurfaceForce: {message}"):
        evaluate(platforms.REFERENCE, force, membrane.positions)


def test_bad_values_are_refused(membrane):
    t = membrane.triangles
    for arguments, culprit in (((0.0, 1.0), "distance"), ((1.0, -1.0), "epsilon")):
        with pytest.raises(mm.OpenMMException, match=f"SurfaceRepulsionForce: {culprit}"):
            helfrich.SurfaceRepulsionForce(t, *arguments)
        with pytest.raises(mm.OpenMMException, match=f"ParticleSurfaceForce: {culprit}"):
            helfrich.ParticleSurfaceForce(t, [0], *arguments)
    with pytest.raises(mm.OpenMMException, match="radius"):
        helfrich.ParticleSurfaceForce(t, [0], 1, 1, radius=-1)
    with pytest.raises(ValueError, match="there is no attraction 'Morse'"):
        helfrich.ParticleSurfaceForce(t, [0], 1, 1, attraction="Morse")
    with pytest.raises(TypeError, match="particles must be integers"):
        helfrich.ParticleSurfaceForce(t, [0.5], 1, 1)
    three = helfrich.ParticleSurfaceForce(t, membrane.foreign[:3], 1, 1, radius=[1, 2])
    with pytest.raises(mm.OpenMMException, match="radius has 2 values, but there are 3 particles"):
        evaluate(platforms.REFERENCE, three, membrane.positions)


@pytest.mark.parametrize("radius", [0, 0.1])
@pytest.mark.parametrize("weights", [(1, 1, 1), (1, 0, 0), (0, 1, 1), (3, 2, 1)])
def test_what_touches_is_an_error(membrane, radius, weights):
    positions = membrane.positions.copy()
    bead = membrane.foreign[0]
    corners = membrane.triangles[5]
    # Rounding leaves a little distance.
    positions[bead] = np.average(positions[corners], axis=0, weights=weights)
    force = helfrich.ParticleSurfaceForce(membrane.triangles, [bead], 1.0, 1.0, radius=radius)
    again = copy.copy(force)
    told = rf"ParticleSurfaceForce: particle {bead} touches triangle \d+ \("
    if weights == (3, 2, 1) and radius == 0:
        told = rf"particle {bead} touches triangle 5 \({', '.join(map(str, corners))}\)"
    with pytest.raises(mm.OpenMMException, match=told):
        evaluate(platforms.REFERENCE, force, positions)
    positions[bead, 1] = np.nan
    with pytest.raises(Exception, match=f"particle {bead} .*not finite|NaN"):
        evaluate(platforms.REFERENCE, again, positions)


@pytest.mark.parametrize("periodic", [False, True], ids=["open", "periodic"])
@pytest.mark.parametrize("attraction", ["WCA", "LennardJones"])
def test_contacts_are_part_of_the_virial(membrane, attraction, periodic):
    positions, particles = beads(membrane)
    system = mm.System()
    for _ in positions:
        system.addParticle(50)
    surface = helfrich.SurfaceRepulsionForce(membrane.triangles, DISTANCE, EPSILON)
    bodies = particle_force(membrane, particles, attraction=attraction)
    box = np.diag([1000.0, 1100.0, 1200.0])
    box[1, 0] = 100
    for one in (surface, bodies):
        one.setUsesPeriodicBoundaryConditions(periodic)
        system.addForce(one)
    context = platforms.HELFRICH.context(system)

    def strained(strain: np.ndarray) -> mm.Context:
        map_ = np.eye(3) + strain
        context.setPeriodicBoxVectors(*(box @ map_.T))
        context.setPositions(positions @ map_.T)
        return context

    def energy(strain: np.ndarray) -> float:
        return plain(strained(strain).getState(getEnergy=True).getPotentialEnergy())

    found = helfrich.virial(strained(np.zeros((3, 3))))
    largest = np.abs(found).max()
    assert largest > 1
    np.testing.assert_allclose(found, found.T, atol=1e-9 * largest)
    # OpenMM's form of a box leaves six strains.
    strain = 1e-5 * np.triu(np.random.default_rng(3).uniform(-1, 1, (3, 3)))
    slopes = [(energy(h * strain) - energy(-h * strain)) / (2 * h) for h in (1, 2)]
    measured = (4 * slopes[0] - slopes[1]) / 3
    assert abs(measured - np.sum(found * strain)) < 1e-6 * largest * np.abs(strain).max()
