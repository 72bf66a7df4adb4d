"""Every row of the table of cases on surfaces with borders and with handles.

`test_forces.py` has the closed ones and says what each comparison is for. Here all rows share a
Context, each in its own force group, so that many surfaces cost little.
"""

from __future__ import annotations

from functools import cache

import meshes
import numpy as np
import numpy_energies
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT, Case
from meshes import Membrane, membrane
from openmmhelfrich.mesh import Mesh, MeshError
from platforms import NATIVE, ON_DEVICE, ON_GPU, ON_OPENCL, ON_PROCESSOR, REFERENCE, Target
from running import Running
from string_forces import BENDING_SCHEMES
from test_forces import rotation

PLACES = (*meshes.HANDLE_NAMES, *meshes.OPEN_NAMES)
every_place = pytest.mark.parametrize("where", PLACES)


def rows(where: str) -> list[Case]:
    return [case for case in PRESENT if case.acts_on(where)]


class Rows:
    """All rows that act on a membrane; OpenMM has 32 force groups."""

    def __init__(self, where: str, target: Target) -> None:
        m, cases = membrane(where), rows(where)
        self.batches = [
            Running([case.make(m) for case in cases[first : first + 32]], m.num_particles, target)
            for first in range(0, len(cases), 32)
        ]
        self.names = [case.name for case in cases]

    def evaluate(self, case: Case, positions) -> tuple[float, np.ndarray]:
        batch, group = divmod(self.names.index(case.name), 32)
        return self.batches[batch].evaluate(positions, group)

    def slope(self, case: Case, positions, direction, step: float) -> float:
        def difference(h: float) -> float:
            ends = [self.evaluate(case, positions + s * direction)[0] for s in (h, -h)]
            return (ends[0] - ends[1]) / (2 * h)

        return (4 * difference(step) - difference(2 * step)) / 3


shared = cache(Rows)


@every_place
@pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
def test_every_row(where: str, target: Target):
    """Energies by numpy, forces by differences, no net force or torque, rigid motions."""
    m, run = membrane(where), shared(where, target)
    rng = np.random.default_rng(51)
    turn = rotation(52)
    turned = m.positions @ turn.T + [250.0, -400.0, 130.0]
    for case in rows(where):
        energy, forces = run.evaluate(case, m.positions)
        largest = np.abs(forces).max()
        assert largest > 0.05, case
        assert energy == pytest.approx(case.expected_energy(m), rel=1e-11), case
        direction = np.zeros_like(forces)
        moving = case.acted_on(m)
        direction[moving] = rng.uniform(-1, 1, (len(moving), 3))
        measured = run.slope(case, m.positions, direction, case.step * m.mean_edge)
        assert abs(measured + np.sum(forces * direction)) <= 1e-6 * largest, case
        assert np.abs(forces.sum(axis=0)).max() <= 1e-10 * np.abs(forces).sum(), case
        torques = np.cross(m.positions - m.positions[m.members].mean(axis=0), forces)
        assert np.abs(torques.sum(axis=0)).max() <= 1e-10 * np.abs(torques).sum(), case
        moved_energy, moved_forces = run.evaluate(case, turned)
        assert moved_energy == pytest.approx(energy, rel=1e-10), case
        assert np.abs(moved_forces - forces @ turn.T).max() <= 1e-9 * largest, case
        assert not forces[case.strangers(m)].any(), case


@pytest.mark.parametrize(
    ("where", "target"),
    [("mixed", target) for target in ON_OPENCL]
    + [
        # The mixed precision of native kernels is that of their single, but for positions.
        pytest.param(where, target, marks=[pytest.mark.long] if target is NATIVE[1] else [])
        for target in ON_DEVICE
        for where in PLACES
    ],
    ids=str,
)
def test_other_devices(where: str, target: Target):
    m = membrane(where)
    run, reference = Rows(where, target), shared(where, REFERENCE)
    for case in rows(where):
        energy, forces = run.evaluate(case, m.positions)
        expected, expected_forces = reference.evaluate(case, target.rounded(m.positions))
        assert energy == pytest.approx(expected, rel=max(target.tolerance, 1e-9)), case
        error = np.abs(forces - expected_forces).max()
        assert error <= target.tolerance * np.abs(expected_forces).max(), case


@pytest.mark.parametrize("where", ["holed", "cap"])
def test_forces_are_the_gradient_by_coordinate(where: str):
    m, run = membrane(where), shared(where, REFERENCE)
    for case in rows(where):
        _, forces = run.evaluate(case, m.positions)
        direction, measured = np.zeros_like(forces), np.zeros_like(forces)
        for particle in case.acted_on(m):
            for axis in range(3):
                direction[particle, axis] = 1
                step = case.step * m.mean_edge
                measured[particle, axis] = -run.slope(case, m.positions, direction, step)
                direction[particle, axis] = 0
        assert np.abs(measured - forces).max() <= 1e-6 * np.abs(forces).max(), case


# --- what is special about borders ---------------------------------------------------------------


def gaussian(m: Membrane, modulus: float) -> tuple[float, np.ndarray]:
    force = helfrich.GaussianCurvatureForce(m.triangles, modulus)
    return Running([force], m.num_particles, REFERENCE).evaluate(m.positions)


@pytest.mark.parametrize("where", [*meshes.NAMES, *PLACES])
def test_the_theorem_of_gauss_and_bonnet(where: str):
    m = membrane(where)
    mesh = Mesh(m.positions[m.members], np.searchsorted(m.members, m.triangles))
    g = numpy_energies.Geometry(mesh.vertices, mesh.triangles)
    turning = np.sum((np.pi - g.angle_sums)[~g.inner])
    inner, forces = gaussian(m, 1.0)
    total = 2 * np.pi * mesh.euler_characteristic
    assert inner == pytest.approx(np.sum((2 * np.pi - g.angle_sums)[g.inner]), abs=1e-12)
    assert inner + turning == pytest.approx(total, abs=1e-12)
    if where not in meshes.OPEN_NAMES:
        assert inner == total
        assert not forces.any()


def test_nothing_bends_a_flat_disk():
    """Borders are free: their vertices' vectors do not sum to zero, and nobody asks."""
    m = membrane("disk")
    flat = m.positions * [1, 1, 0]
    # Espriu's scheme knows equilateral triangles only, and these are none.
    for scheme in ("Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi"):
        force = helfrich.BendingForce(m.triangles, 50.0, scheme=scheme)
        energy, forces = Running([force], m.num_particles, REFERENCE).evaluate(flat)
        assert abs(energy) < 1e-20
        assert np.abs(forces).max() < 1e-10


@pytest.mark.parametrize("where", meshes.OPEN_NAMES)
def test_there_is_no_curvature_at_borders(where: str):
    m = membrane(where)
    mesh = Mesh(m.positions[m.members], np.searchsorted(m.members, m.triangles))
    border = np.isin(np.arange(mesh.num_vertices), np.concatenate(mesh.border_loops))
    for scheme in BENDING_SCHEMES:
        curvature = helfrich.analysis.mean_curvature(mesh, mesh.triangles, scheme)
        np.testing.assert_array_equal(np.isnan(curvature), border)


def test_line_tension_pulls_a_flat_disk_together():
    """A regular polygon of n corners of radius r is 2 n r sin(π/n) long, and pulled inwards."""
    n, r = 9, 20.0
    turns = 2 * np.pi * np.arange(n) / n
    positions = np.concatenate(
        [[[0, 0, 0]], r * np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)]
    )
    triangles = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    force = helfrich.EdgeTensionForce(triangles, 2.5)
    energy, forces = Running([force], n + 1, REFERENCE).evaluate(positions)
    assert energy == pytest.approx(2.5 * 2 * n * r * np.sin(np.pi / n), rel=1e-14)
    inward = -2 * 2.5 * np.sin(np.pi / n) / r * positions[1:]
    np.testing.assert_allclose(forces[1:], inward, atol=1e-12)
    assert not forces[0].any()


@pytest.mark.parametrize("cls", ["EdgeTensionForce", "GaussianCurvatureForce"])
def test_derivatives_with_respect_to_the_scalar(cls: str):
    m = membrane("mixed")
    force = getattr(helfrich, cls)(m.triangles, -1.7)
    (name,) = ({"EdgeTensionForce": "tension", "GaussianCurvatureForce": "modulus"}[cls],)
    force.setContextParameter(name, "scalar")
    force.addEnergyParameterDerivative("scalar")
    run = Running([force], m.num_particles, REFERENCE)
    run.context.setParameter("scalar", 2.0)
    energy, _ = run.evaluate(m.positions)
    state = run.context.getState(parameterDerivatives=True)
    assert state.getEnergyParameterDerivatives()["scalar"] == pytest.approx(energy / 2, rel=1e-14)


# --- flips ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("platform", ["Reference", "Helfrich"])
def test_flips_keep_the_borders(platform: str):
    m = membrane("mixed")
    system = mm.System()
    for _ in range(m.num_particles):
        system.addParticle(50.0)
    chosen = [
        case
        for case in rows("mixed")
        if case.name in ("bending, Julicher", "plaquette areas", "edge tension")
        or case.force == "GaussianCurvatureForce"
    ]
    for case in chosen:
        system.addForce(case.make(m))
    mover = helfrich.MonteCarloBondFlip(m.triangles, 3e4, 1, 1.0)
    system.addForce(mover)
    context = Target(platform, platform, 1e-9).context(system, mm.VerletIntegrator(1e-4))
    context.setPositions(m.positions)
    context.getIntegrator().step(20)
    counts = mover.getStatistics(context)
    assert counts["accepted"] > 20 and counts["refused"]["border"] > 0
    now = np.array(mover.getTrianglesInContext(context))
    assert edges_of_borders(now) == edges_of_borders(m.triangles)
    assert Mesh.from_context(context, mover).euler_characteristic == 2
    # What the Context computes is what a new one does on the same triangles.
    state = context.getState(energy=True, positions=True)
    fresh = Membrane("flipped", state.getPositions(asNumpy=True)._value, now)
    expected = sum(case.energy(fresh, case.arguments(m)) for case in chosen)
    assert state.getPotentialEnergy()._value == pytest.approx(expected, rel=1e-10)


def edges_of_borders(triangles) -> set[tuple[int, int]]:
    sides = {(int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3)}
    return {side for side in sides if side[::-1] not in sides}


# --- what needs a closed surface -----------------------------------------------------------------


@pytest.mark.parametrize("target", [*ON_PROCESSOR, ON_OPENCL[0], ON_GPU[0], NATIVE[0]], ids=str)
def test_no_volume_within_borders(target: Target):
    m = membrane("mixed")
    force = helfrich.EnclosedVolumeForce(m.triangles, 1.0, 1e5)
    words = (
        r"^EnclosedVolumeForce: needs a closed surface.* border of 5 edges through particles \d+"
    )
    with pytest.raises(mm.OpenMMException, match=words):
        Running([helfrich.BendingForce(m.triangles, 50.0), force], m.num_particles, target)


def test_no_vesicle_with_a_border():
    m = membrane("tube")
    mesh = Mesh(m.positions[m.members], np.searchsorted(m.members, m.triangles))
    with pytest.raises(MeshError, match=r"^Vesicle: mesh needs a closed surface.* of 6 edges"):
        helfrich.Vesicle(mesh)
