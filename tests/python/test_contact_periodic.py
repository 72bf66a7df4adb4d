"""Contacts across the faces of a periodic box: against a tiling, and what is nowhere.

The table of cases holds them against brute force, wraps them and has their virial.
"""

from __future__ import annotations

import itertools

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import beads
from platforms import HELFRICH, REFERENCE
from test_contact import DISTANCE, EPSILON, particle_force

# Positions and boxes are on a grid of dyadic fractions, nm, so that wrapping is exact.
BOXES = {
    "triclinic": np.array([[40, 0, 0], [11.25, 44, 0], [-14.5, 17, 48]]),
    "straight": np.diag([40.0, 44, 48]),
}
SIDES = (12, 13)
every_box = pytest.mark.parametrize("box", BOXES.values(), ids=BOXES)


def dyadic(x: np.ndarray) -> np.ndarray:
    return np.round(x * 2.0**16) / 2.0**16


def heights(level: float, seed: int) -> np.ndarray:
    """Fractional coordinates of a rough sheet, shape SIDES + (3,)."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(*(np.arange(n) / n for n in SIDES), indexing="ij")
    w = level + 0.012 * np.sin(2 * np.pi * u) + 0.01 * rng.uniform(-1, 1, SIDES)
    u, v = (x + 0.02 * rng.uniform(-1, 1, SIDES) for x in (u, v))
    return np.stack([u, v, w], axis=2)


def quads(n: int, m: int, number) -> np.ndarray:
    """The triangles of a grid of n × m quadrilaterals."""
    found = []
    for i, j in itertools.product(range(n), range(m)):
        p, q, r, s = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
        found += [(p, q, r), (p, r, s)]
    return np.array(found)


def facing(box: np.ndarray):
    """Two sheets that span the box and face each other across it, with beads between.

    Returns positions, triangles and beads.
    """
    n, m = SIDES
    sheets = [heights(0.04, 1), heights(0.96, 2)]
    points = [dyadic(sheet.reshape(-1, 3) @ box) for sheet in sheets]
    triangles = [quads(n, m, lambda i, j, k=k: k * n * m + m * (i % n) + j % m) for k in range(2)]
    middle = (sheets[0] + sheets[1] + [0, 0, 1]).reshape(-1, 3)[::7] / 2
    particles = dyadic(middle @ box)
    positions = np.vstack([*points, particles])
    return positions, np.vstack(triangles), np.arange(2 * n * m, len(positions))


def forces_on(triangles, particles) -> list[mm.Force]:
    wall = helfrich.SurfaceRepulsionForce(triangles, DISTANCE, EPSILON)
    bead = helfrich.ParticleSurfaceForce(
        triangles, particles, 2.0, EPSILON, 0.3, 0.5, "LennardJones"
    )
    return [wall, bead]


def start(forces, count, box=None, target=REFERENCE) -> mm.Context:
    system = mm.System()
    for _ in range(count):
        system.addParticle(50.0)
    for force in forces:
        force.setUsesPeriodicBoundaryConditions(box is not None)
        system.addForce(force)
    if box is not None:
        system.setDefaultPeriodicBoxVectors(*box)
    return target.context(system)


def evaluate(context, positions):
    context.setPositions(positions)
    state = context.getState(energy=True, forces=True)
    return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value


@every_box
@pytest.mark.parametrize("kind", [0, 1], ids=["surface", "particles"])
def test_a_tiling_without_a_box_has_the_same_forces(box, kind):
    positions, triangles, particles = facing(box)
    context = start([forces_on(triangles, particles)[kind]], len(positions), box)
    _, expected = evaluate(context, positions)
    n, m = SIDES
    many, tiles = [], []
    centre = []
    for k in range(2):
        sheet = positions[k * n * m : (k + 1) * n * m].reshape(n, m, 3)
        # The upper sheet comes from the box below.
        shift = -k * box[2]
        first = sum(map(len, many))
        i, j = np.meshgrid(np.arange(3 * n + 1), np.arange(3 * m + 1), indexing="ij")
        turns = (i // n - 1)[..., None] * box[0] + (j // m - 1)[..., None] * box[1]
        many.append((sheet[i % n, j % m] + turns + shift).reshape(-1, 3))
        tiles.append(quads(3 * n, 3 * m, lambda i, j, f=first: f + (3 * m + 1) * i + j))
        inner = [first + (3 * m + 1) * i + j for i in range(n, 2 * n) for j in range(m, 2 * m)]
        centre.append(inner)
    first = sum(map(len, many))
    images = [[i, j, k] for i in (0, -1, 1) for j in (0, -1, 1) for k in (-1, 0, -2)]
    copies = [positions[particles] + np.array(image) @ box for image in images]
    everything = np.vstack([*many, *copies])
    other = start(
        [forces_on(np.vstack(tiles), np.arange(first, len(everything)))[kind]], len(everything)
    )
    _, forces = evaluate(other, everything)
    scale = np.abs(expected).max()
    assert scale > 1
    found = forces[np.concatenate(centre)]
    np.testing.assert_allclose(found, expected[: 2 * n * m], atol=1e-9 * scale)
    if kind == 1:
        assert np.abs(forces[first:]).max() > 1


@pytest.mark.parametrize("kind", [0, 1], ids=["surface", "particles"])
def test_the_virial_without_a_box(kind):
    membrane = meshes.membrane("crumpled")
    positions, (particles, _) = membrane.positions, beads(membrane)
    force = [
        helfrich.SurfaceRepulsionForce(membrane.triangles, DISTANCE, EPSILON),
        particle_force(membrane, particles),
    ][kind]
    context = start([force], len(positions))
    energy, forces = evaluate(context, positions)
    assert energy != 0
    found = helfrich.virial(context)
    expected = -forces.T @ positions
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(forces).max() * 200)


def test_wholes_and_parts_agree_about_the_box():
    """A repulsion of several vesicles and their own forces."""
    one = helfrich.Mesh.icosphere(2, 20)
    other = one.triangles + one.num_vertices
    both = helfrich.SurfaceRepulsionForce(np.vstack([one.triangles, other]), DISTANCE, EPSILON)
    both.setName("both")
    system = mm.System()
    for _ in range(2 * one.num_vertices):
        system.addParticle(50.0)
    bending = helfrich.BendingForce(other, 50.0)
    bending.setName("one")
    bending.setUsesPeriodicBoundaryConditions(True)
    system.addForce(both)
    system.addForce(bending)
    mover = helfrich.MonteCarloBondFlip(other, 300.0)
    system.addForce(mover)
    system.setDefaultPeriodicBoxVectors(*np.diag([200.0] * 3))
    with pytest.raises(mm.OpenMMException, match=r'"one" uses periodic .* "both" does not'):
        REFERENCE.context(system)


@pytest.mark.parametrize("away", [1.2e9, 3e9, 1e18, 1e300, np.nan, np.inf])
@pytest.mark.parametrize("own", [False, True], ids=["one radius", "radii"])
def test_particles_that_are_nowhere_are_named(own, away):
    """The first of them, on any number of threads; so many that threads share them."""
    box = BOXES["triclinic"]
    positions, triangles, _ = facing(box)
    middle = dyadic(np.random.default_rng(8).uniform([0, 0, 0.09], [1, 1, 0.91], (5000, 3)) @ box)
    particles = np.arange(len(positions), len(positions) + len(middle))
    everything = np.vstack([positions, middle])
    force = helfrich.ParticleSurfaceForce(triangles, particles, 2.0, EPSILON)
    if own:
        force.setParticleRadius(np.linspace(0.1, 0.5, len(particles)).tolist())
    context = start([force], len(everything), box, HELFRICH)
    before = evaluate(context, everything)
    assert before[0] > 0
    lost = everything.copy()
    for particle in particles[[4000, 1234]]:
        lost[particle, particle % 3] = away * box[particle % 3, particle % 3]
    told = "not finite" if not np.isfinite(away) else "more than a billion periodic boxes away"
    for _ in range(3):
        with pytest.raises(
            mm.OpenMMException, match=rf"^ParticleSurfaceForce: particle {particles[1234]} .*{told}"
        ):
            evaluate(context, lost)
    again = evaluate(context, everything)
    assert again[0] == before[0] and again[1].tobytes() == before[1].tobytes()


@pytest.mark.parametrize("kind", [0, 1], ids=["surface", "particles"])
def test_vertices_that_are_nowhere_are_named(kind):
    box = BOXES["triclinic"]
    positions, triangles, particles = facing(box)
    context = start([forces_on(triangles, particles)[kind]], len(positions), box)
    evaluate(context, positions)
    for away, told in ((1.2e9, "a billion"), (1e300, "a billion"), (np.nan, "not finite")):
        lost = positions.copy()
        lost[17] += away * box[1]
        with pytest.raises(mm.OpenMMException, match=rf"Force: particle 17 is at .*{told}"):
            evaluate(context, lost)
