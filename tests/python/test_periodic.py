"""Membranes in a periodic box, which they span or cross: every force, every platform.

Forces are held against Custom forces with periodic boundary conditions and finite differences,
energies against numpy with nearest images, the virial against strains of positions and box.
"""

from __future__ import annotations

import copy
import pickle
from functools import cache

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import oracle
import pytest
import string_forces
from cases import PRESENT, Case
from openmm import unit
from periodic_meshes import BOXES, Positions, in_box, periodic, wrapped
from platforms import (
    CPU,
    HELFRICH,
    NATIVE,
    ON_DEVICE,
    ON_GPU,
    ON_OPENCL,
    REFERENCE,
    Target,
    counting,
)
from running import plain

SHAPES = tuple(BOXES)


def make(case: Case, where: str, shape: str) -> mm.Force:
    force = case.make(periodic(where, shape))
    force.setUsesPeriodicBoundaryConditions(True)
    return force


class Running:
    """Forces in a Context that takes the box of the positions."""

    def __init__(self, forces: list[mm.Force], num_particles: int, target: Target) -> None:
        system = mm.System()
        for _ in range(num_particles):
            system.addParticle(50.0)
        for group, force in enumerate(forces):
            force.setForceGroup(group % 32)
            if target.backend:
                force.setBackend(target.backend)
            system.addForce(force)
        system.setDefaultPeriodicBoxVectors(*BOXES["triclinic"])
        self.context = target.context(system)

    def evaluate(self, positions: Positions) -> tuple[float, np.ndarray]:
        self.context.setPeriodicBoxVectors(*positions.box)
        self.context.setPositions(np.asarray(positions))
        state = self.context.getState(getEnergy=True, getForces=True)
        return plain(state.getPotentialEnergy()), plain(state.getForces(asNumpy=True))

    def virial(self, positions: Positions) -> np.ndarray:
        self.context.setPeriodicBoxVectors(*positions.box)
        self.context.setPositions(np.asarray(positions))
        return helfrich.virial(self.context)


def where(case: Case) -> str:
    """A surface that encloses something, has borders, or does not cross itself, as they need it."""
    if case.is_contact:
        return "facing"
    return {"closed": "vesicle", "open": "torn"}.get(case.surface, "spanning")


@cache
def running(case: Case, where: str, shape: str, target: Target = REFERENCE) -> Running:
    m = periodic(where, shape)
    return Running([make(case, where, shape)], m.num_particles, target)


every_case = pytest.mark.parametrize("case", PRESENT, ids=str)
every_shape = pytest.mark.parametrize("shape", SHAPES)


@every_case
@every_shape
def test_energy_is_that_of_numpy(case: Case, shape: str):
    m = periodic(where(case), shape)
    energy, forces = running(case, m.name, shape).evaluate(m.positions)
    assert energy == pytest.approx(case.expected_energy(m), rel=1e-11)
    largest = np.abs(forces).max()
    assert largest > 0.01
    assert np.abs(forces.sum(axis=0)).max() < 1e-10 * largest
    assert not forces[case.strangers(m)].any()


@every_case
@every_shape
def test_forces_are_the_gradient(case: Case, shape: str):
    m = periodic(where(case), shape)
    run = running(case, m.name, shape)
    _, forces = run.evaluate(m.positions)
    direction = np.random.default_rng(5).normal(size=m.positions.shape)
    direction[case.strangers(m)] = 0
    # Mean edges are about 50 nm long.
    step = 50 * case.step

    def slope(h: float) -> float:
        ahead, behind = (run.evaluate(m.positions + s * direction)[0] for s in (h, -h))
        return (ahead - behind) / (2 * h)

    measured = (4 * slope(step) - slope(2 * step)) / 3
    expected = -np.sum(forces * direction)
    assert abs(measured - expected) < 1e-6 * np.abs(forces * direction).sum()


@every_case
@every_shape
def test_the_virial_is_the_slope_along_a_strain(case: Case, shape: str):
    m = periodic(where(case), shape)
    run = running(case, m.name, shape)
    found = run.virial(m.positions)
    largest = np.abs(found).max()
    np.testing.assert_allclose(found, found.T, atol=1e-9 * largest)
    rng = np.random.default_rng(7)
    # OpenMM's form of a box leaves six strains.
    strain = np.triu(rng.uniform(-1, 1, (3, 3)))

    def energy(h: float) -> float:
        map_ = np.eye(3) + h * strain
        return run.evaluate(in_box(np.asarray(m.positions) @ map_.T, m.positions.box @ map_.T))[0]

    def slope(h: float) -> float:
        return (energy(h) - energy(-h)) / (2 * h)

    step = case.step
    measured = (4 * slope(step) - slope(2 * step)) / 3
    assert abs(measured - np.sum(found * strain)) < 1e-6 * largest


@every_case
@pytest.mark.parametrize("target", [REFERENCE, HELFRICH], ids=str)
def test_wrapping_changes_no_bit(case: Case, target: Target):
    m = periodic(where(case), "triclinic")
    run = running(case, m.name, "triclinic", target)
    energy, forces = run.evaluate(m.positions)
    for seed in range(3):
        again, same = run.evaluate(wrapped(m.positions, seed))
        assert (again, same.tobytes()) == (energy, forces.tobytes())


@pytest.mark.parametrize("target", NATIVE[1:], ids=str)
def test_wrapping_changes_no_bit_on_a_gpu_platform(target: Target):
    m = periodic("spanning", "triclinic")
    cases = [case for case in PRESENT if where(case) == "spanning"][::3]
    run = Running([make(case, "spanning", "triclinic") for case in cases], m.num_particles, target)
    energy, forces = run.evaluate(m.positions)
    for seed in range(3):
        again, same = run.evaluate(wrapped(m.positions, seed))
        assert (again, same.tobytes()) == (energy, forces.tobytes())


@pytest.mark.parametrize("target", NATIVE, ids=str)
def test_gpu_platforms_follow_the_box(target: Target):
    """Boxes that change while the Context lives, up to one that is too narrow for an edge."""
    m = periodic("spanning", "triclinic")

    def force() -> mm.Force:
        force = helfrich.BendingForce(m.triangles, 50.0)
        force.setUsesPeriodicBoundaryConditions(True)
        return force

    found = Running([force()], m.num_particles, target)
    expected = Running([force()], m.num_particles, REFERENCE)
    for scale in (1.0, 1.1, 1.7, 0.9):
        box = scale * m.positions.box
        positions = in_box(target.rounded(scale * np.asarray(m.positions)), box)
        energy, forces = expected.evaluate(positions)
        other, pushes = found.evaluate(positions)
        assert other == pytest.approx(energy, rel=10 * target.tolerance)
        assert np.abs(pushes - forces).max() <= 10 * target.tolerance * np.abs(forces).max()
    narrow = m.positions.box * np.array([[1.0], [1.0], [1e-3]])
    for run in (expected, found):
        with pytest.raises(mm.OpenMMException, match="half of"):
            run.evaluate(in_box(np.asarray(m.positions), narrow))


# --- other implementations -----------------------------------------------------------------------


def strings(case: Case, m) -> oracle.Result:
    """By OpenMM's Custom forces with periodic boundary conditions."""
    if case.force != "BendingForce":
        return case.expected(m, "geometric")
    forces = string_forces.bending(m.triangles, 50.0, 0.02, case.variant[1], "geometric")
    return oracle.evaluate(forces, m.positions)


# OpenMM takes minutes to compile those of the other bending schemes; numpy has them all.
WITH_STRINGS = [
    case
    for case in PRESENT
    if case.strings is not None
    and (case.force != "BendingForce" or case.name == "bending, Julicher bulging out")
]


@pytest.mark.parametrize("case", WITH_STRINGS, ids=str)
@every_shape
def test_agrees_with_string_forces(case: Case, shape: str):
    m = periodic("simple" if where(case) == "spanning" else where(case), shape)
    energy, forces = running(case, m.name, shape).evaluate(m.positions)
    other = strings(case, m)
    assert energy == pytest.approx(other.energy, rel=1e-9)
    assert np.abs(forces - other.forces).max() <= 1e-9 * np.abs(other.forces).max()


@every_shape
def test_a_tiling_has_the_same_forces(shape: str):
    """Twice the box in two directions, four times the sheet: the same surface."""
    m = periodic("spanning", shape)
    case = next(case for case in PRESENT if case.name == "bending, GompperKroll")
    _, forces = running(case, "spanning", shape).evaluate(m.positions)
    images = [(i, j) for i in range(2) for j in range(2)]
    vertices = np.searchsorted(m.members, m.triangles)
    n = len(m.members)
    here = np.asarray(m.positions)[m.members]
    fractions = here @ np.linalg.inv(m.positions.box)
    triangles = []
    for i, j in images:
        # Each corner is the copy of its vertex that is nearest to the first corner's copy.
        first = fractions[vertices[:, :1]]
        steps = np.round(first - fractions[vertices])[..., :2].astype(int)
        cell = (steps + np.array([i, j])) % 2
        triangles.append(vertices + n * (2 * cell[..., 0] + cell[..., 1]))
    positions = np.concatenate([here + np.array([i, j]) @ m.positions.box[:2] for i, j in images])
    force = helfrich.BendingForce(np.concatenate(triangles), 50.0, scheme="GompperKroll")
    force.setUsesPeriodicBoundaryConditions(True)
    run = Running([force], 4 * n, REFERENCE)
    large = m.positions.box * np.array([[2], [2], [1]])
    _, tiled = run.evaluate(in_box(positions, large))
    for copy_ in np.split(tiled, 4):
        np.testing.assert_allclose(copy_, forces[m.members], atol=1e-9 * np.abs(forces).max())


# What OpenCL adds is how positions come to the processor; surfaces differ on the GPU.
PLACES = [
    *((name, target) for target in [CPU, HELFRICH, *ON_DEVICE] for name in ("torn", "vesicle")),
    *(("spanning", target) for target in NATIVE),
    *(("facing", target) for target in [CPU, HELFRICH, ON_OPENCL[1]]),
    ("spanning", ON_OPENCL[1]),
]


@pytest.mark.parametrize(("name", "target"), PLACES, ids=str)
def test_platforms_and_backends_agree(name: str, target: Target):
    m = periodic(name, "triclinic")
    if name == "facing":
        cases = [case for case in PRESENT if where(case) == name]
    else:
        cases = [case for case in PRESENT if where(case) in ("spanning", name)][::3]
    expected = Running(
        [make(case, name, "triclinic") for case in cases], m.num_particles, REFERENCE
    )
    found = Running([make(case, name, "triclinic") for case in cases], m.num_particles, target)
    rounded = in_box(target.rounded(np.asarray(m.positions)), m.positions.box)
    energy, forces = expected.evaluate(rounded)
    with counting() as made:
        other, pushes = found.evaluate(m.positions)
    if target in ON_GPU:
        # What spans the box is computed on the processor whichever backend is chosen.
        assert made.keys() == {"gpu" if name == "vesicle" else "cpu"}
    if target in NATIVE:
        assert "native" in made
    assert other == pytest.approx(energy, rel=10 * target.tolerance)
    assert np.abs(pushes - forces).max() <= 10 * target.tolerance * np.abs(forces).max()


# --- refusals ------------------------------------------------------------------------------------


def system_of(*forces: mm.Force, particles: int) -> mm.System:
    system = mm.System()
    for _ in range(particles):
        system.addParticle(1)
    for force in forces:
        system.addForce(force)
    system.setDefaultPeriodicBoxVectors(*BOXES["triclinic"])
    return system


def context_of(*forces: mm.Force, particles: int) -> mm.Context:
    return REFERENCE.context(system_of(*forces, particles=particles))


def test_forces_on_the_same_triangles_must_agree():
    m = periodic("vesicle", "triclinic")
    one, other = helfrich.BendingForce(m.triangles, 50.0), helfrich.DihedralForce(m.triangles, 1.0)
    one.setName("stiff")
    one.setUsesPeriodicBoundaryConditions(True)
    with pytest.raises(mm.OpenMMException) as caught:
        context_of(one, other, particles=m.num_particles)
    message = str(caught.value)
    assert message.startswith("DihedralForce: ")
    assert '"stiff" uses periodic' in message and '"DihedralForce" does not' in message


def test_a_change_needs_a_new_context():
    m = periodic("vesicle", "triclinic")
    force = helfrich.BendingForce(m.triangles, 50.0)
    system = system_of(force, particles=m.num_particles)
    force = helfrich.BendingForce.cast(system.getForce(0))
    context = REFERENCE.context(system)
    force.setUsesPeriodicBoundaryConditions(True)
    with pytest.raises(mm.OpenMMException, match="reinitialize"):
        force.updateParametersInContext(context)
    context.reinitialize()
    force.updateParametersInContext(context)


def test_volume_of_what_spans_the_box_is_refused():
    m = periodic("spanning", "triclinic")
    force = helfrich.EnclosedVolumeForce(m.triangles, 1.0, 1e6)
    force.setUsesPeriodicBoundaryConditions(True)
    context = context_of(force, particles=m.num_particles)
    context.setPositions(np.asarray(m.positions))
    with pytest.raises(mm.OpenMMException, match=r"EnclosedVolumeForce: .* spans the periodic box"):
        context.getState(getEnergy=True)


def test_long_edges_are_refused_by_name():
    m = periodic("spanning", "triclinic")
    run = running(PRESENT[0], "spanning", "triclinic")
    moved = in_box(m.positions, m.positions.box)
    particle = int(m.members[3])
    moved[particle] += [0, 0, 180.0]
    with pytest.raises(mm.OpenMMException, match="joined by an edge of") as caught:
        run.evaluate(moved)
    assert f"{particle}" in str(caught.value) and "384.0" in str(caught.value)
    assert "three vertices, better four" in str(caught.value)
    run.evaluate(m.positions)


# --- OpenMM's ways -------------------------------------------------------------------------------

COPIES = {
    "XML": lambda force: mm.XmlSerializer.deserialize(mm.XmlSerializer.serialize(force)),
    "copy": copy.copy,
    "pickle": lambda force: pickle.loads(pickle.dumps(force)),
}


@pytest.mark.parametrize("way", COPIES)
@pytest.mark.parametrize("is_periodic", [True, False])
def test_copies_keep_it(way: str, is_periodic: bool):
    force = helfrich.DihedralForce(periodic("vesicle", "triclinic").triangles, 1.0)
    assert not force.usesPeriodicBoundaryConditions()
    force.setUsesPeriodicBoundaryConditions(is_periodic)
    assert COPIES[way](force).usesPeriodicBoundaryConditions() is is_periodic
    # What earlier releases know looks as they wrote it.
    xml = mm.XmlSerializer.serialize(force)
    assert ("usesPeriodic" in xml) is is_periodic
    assert f'version="{2 if is_periodic else 1}"' in xml.split("<Parameters")[0].split("\n", 1)[1]


def test_the_system_knows():
    force = helfrich.DihedralForce(periodic("vesicle", "triclinic").triangles, 1.0)
    system = system_of(force, particles=periodic("vesicle", "triclinic").num_particles)
    assert not system.usesPeriodicBoundaryConditions()
    helfrich.DihedralForce.cast(system.getForce(0)).setUsesPeriodicBoundaryConditions(True)
    assert system.usesPeriodicBoundaryConditions()


@pytest.mark.parametrize("flips", [False, True])
def test_a_run_goes_on_with_the_same_bits(flips: bool):
    m = periodic("spanning", "triclinic")
    system = mm.System()
    for _ in range(m.num_particles):
        system.addParticle(50.0)
    for force in (
        helfrich.BendingForce(m.triangles, 40.0),
        helfrich.TriangleHeightForce(m.triangles, 15.0, 5.0),
        helfrich.SurfaceAreaForce(m.triangles, 2e-3, 6e5),
    ):
        force.setUsesPeriodicBoundaryConditions(True)
        system.addForce(force)
    if flips:
        mover = helfrich.MonteCarloBondFlip(m.triangles, 300 * unit.kelvin, frequency=5)
        mover.setRandomNumberSeed(3)
        system.addForce(mover)
    system.setDefaultPeriodicBoxVectors(*m.positions.box)

    def start() -> mm.Context:
        integrator = mm.LangevinMiddleIntegrator(300, 0.05, 0.02)
        integrator.setRandomNumberSeed(7)
        return HELFRICH.context(system, integrator)

    def bits(context: mm.Context) -> bytes:
        state = context.getState(getPositions=True, getForces=True)
        return (
            plain(state.getPositions(asNumpy=True)).tobytes()
            + plain(state.getForces(asNumpy=True)).tobytes()
        )

    context = start()
    context.setPositions(np.asarray(m.positions))
    context.setVelocitiesToTemperature(300, 1)
    context.getIntegrator().step(40)
    saved = context.createCheckpoint()
    context.getIntegrator().step(40)
    expected = bits(context)
    other = start()
    other.loadCheckpoint(saved)
    other.getIntegrator().step(40)
    assert bits(other) == expected
    if flips:
        (force,) = (f for f in system.getForces() if helfrich.MonteCarloBondFlip.isinstance(f))
        made = helfrich.MonteCarloBondFlip.cast(force).getStatistics(context)["accepted"]
        assert made > 0


def test_the_virial_counts_groups_and_surfaces():
    m = periodic("spanning", "triclinic")
    bending, area = (
        helfrich.BendingForce(m.triangles, 50.0),
        helfrich.SurfaceAreaForce(m.triangles, 1e-3, 5e5),
    )
    for group, force in enumerate((bending, area)):
        force.setForceGroup(31 * group)
        force.setUsesPeriodicBoundaryConditions(True)
    context = context_of(bending, area, particles=m.num_particles)
    context.setPositions(np.asarray(m.positions))
    one, other = helfrich.virial(context, {0}), helfrich.virial(context, 1 << 31)
    both = helfrich.virial(context)
    np.testing.assert_allclose(one + other, both, rtol=1e-12, atol=1e-9 * np.abs(both).max())
    assert np.abs(one).max() > 0 and np.abs(other).max() > 0
    np.testing.assert_array_equal(helfrich.virial(context, groups=(0, 31)), both)
    assert not helfrich.virial(context_of(particles=3)).any()


def test_flips_leave_edges_alone_that_would_be_as_long_as_the_box_allows():
    mesh = helfrich.Mesh.sheet(4, 4, 10.0, periodic=True)
    flips = helfrich.MonteCarloBondFlip(mesh, 300.0, 1, 1.0)
    flips.setRandomNumberSeed(1)
    system = system_of(helfrich.BendingForce(mesh, 1.0), flips, particles=mesh.num_vertices)
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    integrator = mm.VerletIntegrator(1e-6)
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName("Reference"))
    context.setPositions(mesh.vertices)
    # The other diagonals are exactly half as long as the box is wide.
    integrator.step(3)
    statistics = flips.getStatistics(context)
    assert statistics["accepted"] == 0
    assert statistics["refused"]["length"] > 0


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_small_fluid_sheet_lasts(seed):
    """Vertices have room to stretch the edges that flips make."""
    mesh = helfrich.Mesh.sheet(6, 6, 100.0, periodic=True)
    kT = 2.494
    flips = helfrich.MonteCarloBondFlip(mesh, 300.0, 10, 1.0)
    flips.setRandomNumberSeed(seed)
    system = system_of(
        helfrich.BendingForce(mesh, 20 * kT),
        helfrich.SurfaceAreaForce(mesh, 1.3, 1.02 * mesh.area),
        helfrich.TriangleHeightForce(mesh, mesh.min_height(0.33), 4 * kT),
        flips,
        particles=mesh.num_vertices,
    )
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    for particle in range(mesh.num_vertices):
        system.setParticleMass(particle, 50)
    integrator = mm.LangevinMiddleIntegrator(300, 0.002, 0.5)
    integrator.setRandomNumberSeed(seed)
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName("Helfrich"))
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, seed)
    integrator.step(10_000)
    statistics = flips.getStatistics(context)
    assert statistics["accepted"] > 1000
    assert statistics["refused"]["length"] > 100


def test_the_longest_edge_that_flips_make_can_be_chosen():
    """The other diagonals of this sheet have two thirds of half of the width."""
    mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
    half = np.min(np.diag(mesh.box)[:2]) / 2
    diagonal = np.sqrt(3) * 10
    made = {}
    for longest in (0.0, diagonal * 1.001, diagonal * 0.999):
        flips = helfrich.MonteCarloBondFlip(mesh, 300.0, 1, 1.0, maxEdgeLength=longest)
        flips.setRandomNumberSeed(1)
        # Diagonals of diagonals would leave triangles flat.
        heights = helfrich.TriangleHeightForce(mesh, 4.2, 1000.0)
        system = system_of(heights, flips, particles=mesh.num_vertices)
        system.setDefaultPeriodicBoxVectors(*mesh.box)
        integrator = mm.VerletIntegrator(1e-6)
        context = mm.Context(system, integrator, mm.Platform.getPlatformByName("Reference"))
        context.setPositions(mesh.vertices)
        integrator.step(1)
        made[longest] = flips.getStatistics(context)["accepted"]
        now = helfrich.Mesh.from_context(context, flips)
        assert helfrich.analysis.edge_lengths(now, now).max() < 0.8 * half
    first, second, third = made.values()
    assert first >= second > 0 == third
