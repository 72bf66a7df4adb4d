"""What is special about contacts: lists, particles and what touches.

The table of cases holds their energies and forces against brute force, on all platforms.
"""

from __future__ import annotations

import copy
import os
import re
import sys

import contact_twin as twin
import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import platforms
import pytest
from cases import beads

DISTANCE, EPSILON = 5.0, 2.5


@pytest.fixture(scope="module")
def membrane() -> meshes.Membrane:
    return meshes.membrane("crumpled")


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


def evaluate(force, positions):
    system = mm.System()
    for _ in positions:
        system.addParticle(1.0)
    system.addForce(force)
    context = platforms.REFERENCE.context(system)
    context.setPositions(positions)
    state = context.getState(energy=True, forces=True)
    unit = mm.unit.kilojoule_per_mole
    forces = state.getForces(asNumpy=True).value_in_unit(unit / mm.unit.nanometer)
    return state.getPotentialEnergy().value_in_unit(unit), forces


def num_threads() -> int:
    return len(os.listdir("/proc/self/task"))


def test_neither_threads_nor_the_age_of_lists_show(membrane):
    """A walk that comes back, on some threads, and a new Context, have the same bits.

    There are so many pairs that threads are made for them, which are counted to be sure of it.
    """
    copies, size = 12, membrane.num_particles
    shifts = 400.0 * np.arange(copies)[:, None, None] * [1, 0, 0]
    positions = (membrane.positions + shifts).reshape(-1, 3)
    triangles = np.vstack([membrane.triangles + size * k for k in range(copies)])
    many = meshes.Membrane("many", positions, triangles)
    particles = np.concatenate([beads(membrane)[0] + size * k for k in range(copies)])
    rng = np.random.default_rng(3)
    radii = rng.uniform(0, 0.3, len(particles))
    walk = [positions + s * rng.normal(size=positions.shape) for s in (0, 0.01, 0.8, 0.3, 0)]
    seen = []
    for threads in (1, 2, 3):
        system = mm.System()
        for _ in positions:
            system.addParticle(1.0)
        system.addForce(helfrich.SurfaceRepulsionForce(triangles, DISTANCE, EPSILON))
        system.addForce(particle_force(many, particles, radius=radii))
        target = platforms.Target("", "Helfrich", 0, {"Threads": str(threads)})
        context = target.context(system)
        before = num_threads()
        for there in [*walk, *walk, *walk]:
            context.setPositions(there)
            state = context.getState(energy=True, forces=True)
            forces = state.getForces(asNumpy=True)
            seen.append((state.getPotentialEnergy()._value, forces._value.tobytes()))
        if sys.platform == "linux":
            assert num_threads() - before == threads - 1
    assert seen[0] != seen[1]
    for start in range(5):
        assert len(set(seen[start::5])) == 1
    assert seen[0] == seen[4]


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


def test_particles_are_read_from_xml_or_refused(membrane):
    particles, _ = beads(membrane)
    xml = mm.XmlSerializer.serialize(particle_force(membrane, particles))
    again = helfrich.ParticleSurfaceForce.cast(mm.XmlSerializer.deserialize(xml))
    assert again.getParticles().tolist() == particles.tolist()
    with pytest.raises(mm.OpenMMException, match=r"ParticleSurfaceForce.*not an integer"):
        mm.XmlSerializer.deserialize(xml.replace('index="', 'index="x'))


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
        evaluate(force, membrane.positions)


def test_bad_values_are_refused(membrane):
    t = membrane.triangles
    with pytest.raises(ValueError, match="there is no attraction 'Morse'"):
        helfrich.ParticleSurfaceForce(t, [0], 1, 1, attraction="Morse")
    with pytest.raises(TypeError, match="particles must be integers"):
        helfrich.ParticleSurfaceForce(t, [0.5], 1, 1)
    three = helfrich.ParticleSurfaceForce(t, membrane.foreign[:3], 1, 1, radius=[1, 2])
    with pytest.raises(mm.OpenMMException, match="radius has 2 values, but there are 3 particles"):
        evaluate(three, membrane.positions)


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
        evaluate(force, positions)
    positions[bead, 1] = np.nan
    with pytest.raises(Exception, match=f"particle {bead} .*not finite|NaN"):
        evaluate(again, positions)


@pytest.mark.parametrize("attraction", ["WCA", "LennardJones", "NineThree"])
def test_a_triangle_without_area_is_an_edge_to_particles(membrane, attraction):
    """It needs no normal: energy and forces are what they tend to as it collapses.

    But for the pull of adhesion on the area, which has no direction then.
    """
    particles, _ = beads(membrane)
    # A triangle that a particle is near.
    near = twin.particle_gaps(membrane.positions, membrane.triangles, particles)
    a, b, _ = membrane.triangles[near.min(axis=0).argmin()]
    found = []
    for left in (0.0, 1e-9):
        positions = membrane.positions.copy()
        positions[a] = positions[b] + left * (positions[a] - positions[b])
        found.append(
            evaluate(particle_force(membrane, particles, attraction=attraction), positions)
        )
    (energy, forces), (expected, others) = found
    assert np.abs(forces[[a, b]]).max() > 0.01
    assert energy == pytest.approx(expected, rel=1e-6)
    if attraction != "WCA":
        corners = membrane.triangles[np.isin(membrane.triangles, [a, b]).sum(axis=1) == 2]
        forces[corners] = others[corners] = 0
    np.testing.assert_allclose(forces, others, atol=1e-6 * np.abs(others).max())


# A triangle, and others that meet it: in a corner, and in the middle of edges.
FIRST = [[-1, 0, 0], [1, 0, 0], [0, 0, -3]]
MEETING = {
    "corner": (
        [[0, 0, -3], [1, 3, -5], [-1, 3, -5]],
        r"particle (2|3) lies on the triangle \((.*)\)",
    ),
    "edges": ([[0, -1, 0], [0, 1, 0], [0, 0, 3]], r"the edges \(0, 1\) and \(3, 4\) meet"),
}


@pytest.mark.parametrize("how", MEETING)
@pytest.mark.parametrize("between", [False, True])
def test_surfaces_that_meet_are_named(how, between):
    """Where vertices and triangles or edges meet the energy is infinite."""
    second, told = MEETING[how]
    triangles = [[0, 1, 2], [3, 4, 5]]

    def force():
        repulsion = helfrich.SurfaceRepulsionForce(triangles, 0.5, EPSILON)
        repulsion.setOnlyBetweenParts(between)
        return repulsion

    positions = np.array([*FIRST, *second], dtype=float)
    with pytest.raises(mm.OpenMMException, match=f"^SurfaceRepulsionForce: {told}") as error:
        evaluate(force(), positions)
    if how == "corner":
        particle, corners = re.search(told, str(error.value)).groups()
        assert set(map(int, corners.split(", "))) == ({3, 4, 5} if particle == "2" else {0, 1, 2})
    positions[3:, 2] += 0.4 if how == "edges" else -0.4
    energy, _ = evaluate(force(), positions)
    assert energy == pytest.approx(
        twin.surface_repulsion(positions, np.array(triangles), 0.5, EPSILON)
    )
    assert energy > 0


@pytest.mark.parametrize("away", [1e8, 1e12, 1e40, 1e160])
def test_a_vertex_that_has_flown_away_is_named(away):
    mesh = helfrich.Mesh.icosphere(3, 100.0)
    positions = np.concatenate([np.zeros((5, 3)), mesh.vertices])
    positions[12] *= away
    force = helfrich.SurfaceRepulsionForce(mesh.triangles + 5, DISTANCE, EPSILON)
    with pytest.raises(mm.OpenMMException, match=r"particle 12 is at .* nothing can be found near"):
        evaluate(force, positions)


def test_surfaces_may_be_far_from_each_other():
    """Two pairs of spheres that touch, a centimetre apart."""
    mesh = helfrich.Mesh.icosphere(3, 100.0)
    height = 2 * mesh.vertices[:, 0].max() + 0.7 * DISTANCE
    pair = np.concatenate([mesh.vertices, mesh.vertices * [-1, 1, 1] + [height, 0, 0]])
    sides = [mesh.triangles, mesh.triangles[:, ::-1] + mesh.num_vertices]
    near = np.concatenate(sides)
    far = np.concatenate([near, near + len(pair)])
    one, other = (
        evaluate(helfrich.SurfaceRepulsionForce(triangles, DISTANCE, EPSILON), positions)
        for triangles, positions in ((near, pair), (far, np.concatenate([pair, pair + 1e7])))
    )
    assert one[0] > EPSILON
    # Positions a centimetre away have eight digits behind the point.
    assert other[0] == pytest.approx(2 * one[0], rel=1e-6)
