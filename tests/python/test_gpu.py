"""Devices against the processor, on every row of the table of cases.

Devices are GPUs through wgpu, and OpenMM's GPU platforms, which evaluate membranes themselves.

By default each row runs on two membranes; HELFRICH_SLOW_TESTS=1 takes them all.
"""

from __future__ import annotations

import copy
import gc
import os
import resource
from functools import cache

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT, Case
from meshes import Membrane, membrane
from platforms import NATIVE, ON_DEVICE, ON_GPU, ON_OPENCL, REFERENCE, Target, counting, require_gpu
from running import Running, running

SLOW = os.environ.get("HELFRICH_SLOW_TESTS") == "1"
SINGLE, DOUBLE = ON_GPU
# Borders and contacts are for the processor.
CLOSED = [case for case in PRESENT if case.surface != "open" and not case.is_contact]


def in_batches(cases: list[Case]) -> list[list[Case]]:
    """As many as OpenMM has force groups together."""
    return [cases[first : first + 32] for first in range(0, len(cases), 32)]


BATCHES = in_batches(CLOSED)

every_case = pytest.mark.parametrize("case", CLOSED, ids=str)
on_device = pytest.mark.parametrize("target", ON_DEVICE, ids=str)


@cache
def all_together(batch: int, where: str, target: Target) -> Running:
    """Many rows in one Context, each in its own force group."""
    m = membrane(where)
    return Running([case.make(m) for case in BATCHES[batch]], m.num_particles, target)


def compare(found, expected, tolerance: float) -> None:
    """Energies to a share of themselves, forces of the largest.

    Where OpenMM's GPU platforms add them up, forces are whole numbers of 2⁻³² kJ/mol/nm.
    """
    assert found[0] == pytest.approx(expected[0], rel=tolerance)
    allowed = max(tolerance * np.abs(expected[1]).max(), 2.0**-32)
    assert np.abs(found[1] - expected[1]).max() <= allowed


def only_on(target: Target, body):
    """The result of something that nothing but a device has computed."""
    with counting() as made:
        result = body()
    assert made.keys() == {target.counter}
    return result


# --- accuracy ------------------------------------------------------------------------------------


@every_case
@pytest.mark.parametrize("where", meshes.NAMES if SLOW else ["concave", "many neighbours"])
@on_device
def test_every_row_is_that_of_the_processor(case: Case, where: str, target: Target):
    m = membrane(where)
    batch, group = divmod(CLOSED.index(case), 32)
    run = all_together(batch, where, target)
    found = only_on(target, lambda: run.evaluate(m.positions, group))
    reference = running(case.name, where, REFERENCE).evaluate(target.rounded(m.positions))
    # Where a vector |c| is nearly zero, its direction has lost digits in single precision.
    is_blunt = "unsigned" in case.name and not target.name.endswith("double")
    compare(found, reference, 1e-4 if is_blunt else target.tolerance)
    assert not found[1][m.foreign].any()


OPEN = [case for case in PRESENT if case.surface != "closed" and not case.is_contact]


@pytest.mark.parametrize("where", ["holed", "disk"])
@pytest.mark.parametrize("target", NATIVE, ids=str)
def test_rows_on_surfaces_with_borders(where: str, target: Target):
    """GPU platforms compute borders themselves, others leave them to the processor."""
    m = membrane(where)
    for first in range(0, len(OPEN), 32):
        cases = OPEN[first : first + 32]
        run = Running([case.make(m) for case in cases], m.num_particles, target)
        for group, case in enumerate(cases):
            found = only_on(target, lambda run=run, k=group: run.evaluate(m.positions, k))
            reference = running(case.name, where, REFERENCE).evaluate(target.rounded(m.positions))
            is_blunt = "unsigned" in case.name and not target.name.endswith("double")
            compare(found, reference, 1e-4 if is_blunt else target.tolerance)


@pytest.mark.parametrize("radius", [10.0, 100.0, 1000.0, 10_000.0])
@pytest.mark.parametrize("distance", [0.0, 1e6])
@on_device
def test_size_and_place_do_not_matter(radius: float, distance: float, target: Target):
    base = membrane("concave")
    shift = distance * np.array([0.8, -0.6, 1.0])
    positions = radius / 160 * base.positions + shift
    # Differences of coordinates near 1e6 nm have lost the digits that they have lost.
    m = Membrane("moved", positions, base.triangles)
    for batch in in_batches(CLOSED if SLOW else CLOSED[::3]):
        found, reference = (
            Running([case.make(m) for case in batch], m.num_particles, platform)
            for platform in (target, REFERENCE)
        )
        for group in range(len(batch)):
            expected = reference.evaluate(target.rounded(positions), group)
            assert np.abs(expected[1]).max() > 0
            compare(found.evaluate(positions, group), expected, target.tolerance)


@pytest.mark.parametrize("strain", [1e-4, -1e-4])
@pytest.mark.parametrize("where", meshes.NAMES)
@on_device
def test_small_strains_of_area_and_volume(where: str, strain: float, target: Target):
    """Single precision alone would leave three digits of a strain of 1e-4, and of its force."""
    m = membrane(where)
    mesh = helfrich.Mesh(m.positions[m.members], np.searchsorted(m.members, m.triangles))
    terms = (
        (helfrich.SurfaceAreaForce, (1e3, mesh.area / (1 + strain))),
        (helfrich.EnclosedVolumeForce, (1e3, mesh.volume / (1 + strain))),
        (helfrich.OsmoticPressureForce, (400 * mesh.volume / (1 + strain), 400.0, 2.5)),
    )
    found, expected = (
        Running([cls(m.triangles, *values) for cls, values in terms], m.num_particles, platform)
        for platform in (target, REFERENCE)
    )
    # What cancels to 1e-4 of itself has lost four digits in double precision, too, and the
    # square of it twice as many of what was left.
    tolerance = 1e-9 if target.name.endswith("double") else 1e-4
    for group in range(len(terms)):
        reference = expected.evaluate(target.rounded(m.positions), group)
        compare(found.evaluate(m.positions, group), reference, tolerance)


def large_mesh() -> helfrich.Mesh:
    """A thermally rough sphere: N = 10 242, edges of 39 nm, jittered by 2 nm."""
    mesh = helfrich.Mesh.icosphere(32, 1000.0)
    noise = np.random.default_rng(3).normal(scale=2.0, size=mesh.vertices.shape)
    return helfrich.Mesh(mesh.vertices + noise, mesh.triangles)


@pytest.mark.parametrize("scheme", ["Julicher", "GompperKrollBarycentric"])
@pytest.mark.parametrize("target", [SINGLE, *NATIVE[:2]], ids=str)
def test_a_large_mesh_in_single_precision(scheme: str, target: Target):
    """Edges are short beside the mesh, and area and volume are sums of many."""
    mesh = large_mesh()

    def forces():
        return [
            helfrich.BendingForce(mesh, 50, scheme=scheme),
            helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area * (1 - 1e-4)),
            helfrich.EnclosedVolumeForce(mesh, 0.04, mesh.volume * (1 + 1e-4)),
            helfrich.TriangleHeightForce(mesh, 30, 10),
        ]

    found = Running(forces(), mesh.num_vertices, target)
    expected = Running(forces(), mesh.num_vertices, REFERENCE)
    for group in range(4):
        reference = expected.evaluate(target.rounded(mesh.vertices), group)
        # Here the tolerance is far below what is asked of small meshes: nothing grows with N.
        compare(found.evaluate(mesh.vertices, group), reference, 2e-5)


@on_device
def test_the_same_positions_give_the_same_bits(target: Target):
    mesh = large_mesh()
    forces = [
        helfrich.BendingForce(mesh, 50, 0.001, scheme="GompperKroll"),
        helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area),
    ]
    run = Running(forces, mesh.num_vertices, target)
    energy, first = run.evaluate(mesh.vertices)
    run.evaluate(1.01 * mesh.vertices)
    again, second = run.evaluate(mesh.vertices)
    assert again == energy
    np.testing.assert_array_equal(second, first)
    platform = REFERENCE if target in ON_GPU else target
    other = Running([copy.copy(force) for force in forces], mesh.num_vertices, platform)
    np.testing.assert_array_equal(other.evaluate(mesh.vertices)[1], first)


# --- options -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "platform", [Target("CPU", "CPU", 1e-9, {"Threads": "2"}, "gpu:double"), ON_OPENCL[2]], ids=str
)
def test_every_platform_can_use_it(platform: Target):
    require_gpu(double=True)
    target = Target(platform.name, platform.platform, 1e-9, platform.properties, "gpu:double")
    m = membrane("jittered")
    run = Running([case.make(m) for case in PRESENT[:8]], m.num_particles, target)
    found = only_on(target, lambda: run.evaluate(m.positions))
    expected = Running([case.make(m) for case in PRESENT[:8]], m.num_particles, REFERENCE)
    compare(found, expected.evaluate(m.positions), 1e-9)


@on_device
def test_context_parameters_and_derivatives(target: Target):
    m = membrane("stretched")
    results = []
    for where in (target, REFERENCE):
        bending = helfrich.BendingForce(m.triangles, 50, 0.01, scheme="Espriu")
        area = helfrich.SurfaceAreaForce(m.triangles, 1.3, 1e5)
        heights = helfrich.TriangleHeightForce(m.triangles, 25, 10)
        names = {}
        for force, parameters in (
            (bending, ("rigidity", "spontaneousCurvature")),
            (area, ("modulus", "target")),
            (heights, ("minHeight", "epsilon")),
        ):
            for parameter in parameters:
                names[parameter] = f"a {parameter}"
                force.setContextParameter(parameter, names[parameter])
                force.addEnergyParameterDerivative(names[parameter])
        run = Running([bending, area, heights], m.num_particles, where)
        run.context.setParameter("a target", 1.1e5)
        run.context.setParameter("a spontaneousCurvature", -0.02)
        found = run.evaluate(target.rounded(m.positions))
        state = run.context.getState(parameterDerivatives=True)
        results.append((*found, dict(state.getEnergyParameterDerivatives())))
    compare(results[0], results[1], target.tolerance)
    assert len(results[1][2]) == 6
    assert results[0][2] == pytest.approx(results[1][2], rel=target.tolerance)


@on_device
def test_values_that_change_are_followed(target: Target):
    """By update, for scalars, variants and values of elements, with all forces on one membrane."""
    m = membrane("two parts")
    rng = np.random.default_rng(5)

    def forces():
        return [
            helfrich.BendingForce(m.triangles, 50),
            helfrich.TriangleAreaForce(m.triangles, 1.0, rng.uniform(1000, 2000)),
        ]

    bending, area = forces()
    run = Running([bending, area], m.num_particles, target)
    run.evaluate(m.positions)
    for _ in range(3):
        bending.setVertexRigidity(rng.uniform(20, 80, len(m.members)))
        bending.setScheme(int(rng.integers(5)))
        area.setTriangleTargets(rng.uniform(1000, 2000, len(m.triangles)))
        for force in (bending, area):
            force.updateParametersInContext(run.context)
        expected = [copy.copy(bending), copy.copy(area)]
        for force in expected:
            force.setBackend("cpu")
        reference = Running(expected, m.num_particles, REFERENCE)
        expected = reference.evaluate(target.rounded(m.positions))
        compare(run.evaluate(m.positions), expected, target.tolerance)


@pytest.mark.parametrize("target", [SINGLE, NATIVE[0]], ids=str)
def test_several_meshes_of_one_context(target: Target):
    first, second = membrane("jittered"), membrane("octahedron")
    offset = first.num_particles
    positions = np.concatenate([first.positions, second.positions + 500])

    def forces():
        return [
            helfrich.BendingForce(first.triangles, 50),
            helfrich.DihedralForce(second.triangles, 40, offset=offset),
            helfrich.EnclosedVolumeForce(second.triangles, 0.04, 1e5, offset=offset),
        ]

    found = Running(forces(), len(positions), target)
    expected = Running(forces(), len(positions), REFERENCE)
    for group in (0, 1, 2, -1):
        reference = expected.evaluate(target.rounded(positions), group)
        compare(found.evaluate(positions, group), reference, 1e-4)


@pytest.mark.parametrize("target", [SINGLE, *NATIVE[:2]], ids=str)
def test_parts_far_from_each_other_lose_nothing(target: Target):
    """One list of triangles with two closed parts, 1e6 nm apart."""
    sphere = helfrich.Mesh.icosphere(3, 100.0).deformed(2, 1, 0.2)
    vertices = np.concatenate([sphere.vertices, 0.5 * sphere.vertices + 1e6])
    triangles = np.concatenate([sphere.triangles, sphere.triangles + sphere.num_vertices])
    for make in (
        lambda: helfrich.BendingForce(triangles, 50),
        lambda: helfrich.EnclosedVolumeForce(triangles, 0.04, 5e6),
    ):
        found = Running([make()], len(vertices), target).evaluate(vertices)
        reference = Running([make()], len(vertices), REFERENCE)
        expected = reference.evaluate(target.rounded(vertices))
        compare(found, expected, 1e-4)


@on_device
def test_errors_name_the_same_culprits(target: Target):
    m = membrane("jittered")
    run = Running([helfrich.BendingForce(m.triangles, 50)], m.num_particles, target)
    lost = m.positions.copy()
    lost[m.members[3]] = np.nan
    flat = m.positions.copy()
    flat[m.triangles[5]] = [[1, 1, 1], [2, 2, 2], [4, 4, 4]]
    for positions, message in ((lost, f"particle {m.members[3]} is at"), (flat, "triangle 5")):
        with pytest.raises(mm.OpenMMException, match=message):
            run.evaluate(positions)
    only_on(target, lambda: run.evaluate(m.positions))


def test_what_single_precision_cannot_do_is_left_to_the_processor():
    """A triangle of which the height is 1e-7 of its base has no normal in single precision."""
    require_gpu()
    m = membrane("jittered")
    thin = m.positions.copy()
    a, b, c = m.triangles[7]
    thin[c] = 0.6 * thin[a] + 0.4 * thin[b] + 1e-7 * (thin[c] - thin[a])
    found = Running([helfrich.SurfaceAreaForce(m.triangles, 1.0, 1e5)], m.num_particles, SINGLE)
    expected = Running([helfrich.SurfaceAreaForce(m.triangles, 1, 1e5)], m.num_particles, REFERENCE)
    compare(found.evaluate(thin), expected.evaluate(thin), 1e-12)


# --- dynamics and memory -------------------------------------------------------------------------


@pytest.mark.long
def test_verlet_keeps_its_energy_in_single_precision():
    """The paper's vesicle, small, for 200 ps; the drift is a share of the kinetic energy."""
    require_gpu()
    mesh = helfrich.Mesh.random_sphere(252, radius=500.0, seed=1)
    system = helfrich.Vesicle(mesh).system()
    for force in system.getForces():
        for cls in helfrich.MembraneForce.__subclasses__():
            if cls.isinstance(force):
                cls.cast(force).setBackend("gpu:single")
    integrator = mm.VerletIntegrator(0.1)
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName("Reference"))
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    energies, kinetic = [], []
    for _ in range(10):
        only_on(SINGLE, lambda: integrator.step(200))
        state = context.getState(energy=True)
        kinetic.append(state.getKineticEnergy()._value)
        energies.append(state.getPotentialEnergy()._value + kinetic[-1])
    assert np.ptp(energies) < 0.01 * np.mean(kinetic)


def _resident() -> float:
    """Memory of this process, MB."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


@pytest.mark.long
def test_a_thousand_contexts_leave_no_memory_behind():
    require_gpu()
    mesh = helfrich.Mesh.icosphere(3, 100.0)

    def make_and_destroy(count: int) -> None:
        for _ in range(count):
            force = helfrich.BendingForce(mesh, 50)
            Running([force], mesh.num_vertices, SINGLE).evaluate(mesh.vertices)
        gc.collect()

    make_and_destroy(100)
    before = _resident()
    make_and_destroy(1000)
    # A buffer that stays would be 50 kB of each Context, all of them 50 MB.
    assert _resident() - before < 10
