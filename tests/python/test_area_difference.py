"""AreaDifferenceForce: exact and limiting values of M, scaling, conventions, digits, one-liners."""

from __future__ import annotations

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from meshes import membrane
from openmm import unit
from openmmhelfrich import AreaDifferenceForce, Mesh, analysis, area_difference_parameters
from platforms import REFERENCE, Target
from running import Running
from test_gpu import NATIVE, SINGLE, compare, large_mesh


def measured(mesh: Mesh, target: float = 0.0) -> float:
    """M, from the energy ½ (M − M0)² of a surface above its target."""
    return target + np.sqrt(2 * mesh.energy(AreaDifferenceForce(mesh, 1.0, target)))


# --- the integral of mean curvature --------------------------------------------------------------


def test_a_box_is_exact():
    """4 (a + b + c) edges of φ = π/2, and diagonals of none: M = π (a + b + c)."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    mesh = Mesh(corners * [3.0, 4.0, 7.0], triangles)
    assert measured(mesh) == pytest.approx(14 * np.pi, rel=1e-13)
    assert analysis.total_mean_curvature(mesh, mesh) == pytest.approx(14 * np.pi, rel=1e-13)
    # Seen from inside it is concave.
    hollow = mesh.triangles[:, [0, 2, 1]]
    run = Running([AreaDifferenceForce(hollow, 1.0, 0.0)], 8, REFERENCE)
    assert run.energy(mesh.vertices) == pytest.approx(98 * np.pi**2, rel=1e-13)
    assert analysis.total_mean_curvature(mesh, hollow) == pytest.approx(-14 * np.pi, rel=1e-13)


@pytest.mark.parametrize(
    ("make", "expected", "error"),
    [
        # Of a torus (1/b + cos θ / (R + b cos θ)) / 2 dA = (R/2 + b cos θ) dθ dφ.
        (lambda n: Mesh.icosphere(n, 10.0), 40 * np.pi, 0.103),
        (lambda n: Mesh.tube(3 * n, 6 * n, 10.0, 60.0, periodic=True), 60 * np.pi, 0.102),
        (lambda n: Mesh.torus(3 * n, 10.0, 4.0), 20 * np.pi**2, 0.06),
    ],
    ids=["sphere", "tube", "torus"],
)
def test_smooth_surfaces_are_limits(make, expected: float, error: float):
    """With triangles of half the size the error is a quarter."""
    for n in (4, 8, 16):
        mesh = make(n)
        found = measured(mesh)
        assert found == pytest.approx(analysis.total_mean_curvature(mesh, mesh), rel=1e-12)
        assert abs(found / expected - 1) < error / n**2
        target = 0.9 * expected
        energy = mesh.energy(AreaDifferenceForce(mesh, 0.4, target))
        assert energy == pytest.approx(0.2 * (found - target) ** 2, rel=1e-9)


def test_reduced_difference_of_a_sphere_is_one():
    mesh = Mesh.icosphere(16, 37.0)
    assert analysis.area_difference(mesh, mesh) == pytest.approx(1, abs=3e-4)
    frames = np.stack([mesh.vertices, 2 * mesh.vertices])
    np.testing.assert_allclose(
        analysis.area_difference(frames, mesh), analysis.area_difference(mesh, mesh), rtol=1e-13
    )


@pytest.mark.parametrize("where", [*meshes.NAMES, "holed", "cap", "torn torus"])
def test_it_is_of_first_degree(where: str):
    """r → λ r gives λ M, with borders too, so that Σ F·r = −m (M − M0) M."""
    m = membrane(where)
    target = 500.0
    run = Running([AreaDifferenceForce(m.triangles, 0.3, target)], m.num_particles, REFERENCE)
    energy, forces = run.evaluate(m.positions)
    total = analysis.total_mean_curvature(
        m.positions[m.members], np.searchsorted(m.members, m.triangles)
    )
    assert energy == pytest.approx(0.15 * (total - target) ** 2, rel=1e-10)
    product = np.sum(forces * m.positions)
    assert product == pytest.approx(-0.3 * (total - target) * total, rel=1e-9)


def test_a_sheet_of_no_curvature_has_a_force_of_none():
    """A flat disk has M = 0; but E has a slope, to bulge, where M0 is not 0."""
    disk = Mesh.disk(4, 50.0)
    assert disk.energy(AreaDifferenceForce(disk, 2.0, 30.0)) == pytest.approx(900.0)
    forces = Running([AreaDifferenceForce(disk, 2.0, 30.0)], disk.num_vertices, REFERENCE)
    _, forces = forces.evaluate(disk.vertices)
    assert np.abs(forces[:, :2]).max() < 1e-9
    rim = np.unique([vertex for loop in disk.border_loops for vertex in loop])
    inner = np.setdiff1d(np.arange(disk.num_vertices), rim)
    # By Schläfli's formula only what is at borders bends.
    far = [v for v in inner if np.hypot(*disk.vertices[v][:2]) < 30]
    assert np.abs(forces[far]).max() < 1e-9 * np.abs(forces).max()


# --- conventions ---------------------------------------------------------------------------------


def test_parameters_are_those_of_miao_and_seifert():
    """α κ π (ΔA − ΔA0)² / (2 A D²) of a sphere's two monolayers, whose areas are 4π (r ± D/2)²."""
    r, distance, kappa, alpha, area, delta_a0 = 90.0, 4.0, 50.0, 1.4, 1.1e5, 1.25
    unit_radius = np.sqrt(area / (4 * np.pi))
    difference = 4 * np.pi * ((r + distance / 2) ** 2 - (r - distance / 2) ** 2)
    relaxed = 8 * np.pi * distance * unit_radius * delta_a0
    expected = alpha * kappa * np.pi * (difference - relaxed) ** 2 / (2 * area * distance**2)
    modulus, target = area_difference_parameters(kappa, alpha, area, delta_a0)
    assert 0.5 * modulus * (4 * np.pi * r - target) ** 2 == pytest.approx(expected, rel=1e-12)
    # With the area 4πr² it is 8πκ · πα (Δa − Δa0)².
    modulus, target = area_difference_parameters(kappa, alpha, 4 * np.pi * r**2, delta_a0)
    reduced = 8 * np.pi * kappa * np.pi * alpha * (1 - delta_a0) ** 2
    assert 0.5 * modulus * (4 * np.pi * r - target) ** 2 == pytest.approx(reduced, rel=1e-12)


def test_parameters_take_quantities_and_name_mistakes():
    plain = area_difference_parameters(50, 1.4, 1e5, 1.1)
    kappa = 50e3 * unit.joule / unit.mole
    assert area_difference_parameters(kappa, 1.4, 0.1 * unit.micrometer**2, 1.1) == pytest.approx(
        plain
    )
    for arguments, error, message in (
        ((-1, 1, 1, 1), ValueError, "rigidity needs 0 or more, got -1"),
        ((1, np.nan, 1, 1), ValueError, "alpha needs a finite number"),
        ((1, 1, 0, 1), ValueError, "area needs more than 0"),
        ((1, 1, 1 * unit.nanometer, 1), TypeError, "area needs the unit"),
        ((1, 1, 1, "x"), TypeError, "delta_a0 needs a number"),
    ):
        with pytest.raises(error, match=f"^area_difference_parameters: {message}"):
            area_difference_parameters(*arguments)


# --- vesicles ------------------------------------------------------------------------------------


def test_vesicle():
    mesh = Mesh.random_sphere(252, 100.0, seed=1)
    vesicle = helfrich.Vesicle(
        mesh,
        rigidity=60,
        pressure=1e-4,
        surface_tension=0.02,
        osmotic={"solutes": 1e5, "concentration": 0.03},
        area_difference={"alpha": 1.4, "delta_a0": 1.1},
    )
    context = vesicle.simulation(mm.VerletIntegrator(0.001), "Reference").context
    energies = vesicle.energies(context)
    modulus, target = area_difference_parameters(60, 1.4, mesh.area, 1.1)
    total = analysis.total_mean_curvature(mesh, mesh)
    x = 0.03 * mesh.volume / 1e5
    assert list(energies)[4:] == ["pressure", "surface_tension", "osmotic", "area_difference"]
    assert energies["pressure"] == pytest.approx(-1e-4 * mesh.volume)
    assert energies["surface_tension"] == pytest.approx(0.02 * mesh.area)
    assert energies["osmotic"] == pytest.approx(1e5 * 2.4943387854 * (x - 1 - np.log(x)))
    assert energies["area_difference"] == pytest.approx(0.5 * modulus * (total - target) ** 2)
    plain = helfrich.Vesicle(mesh, area_difference={"modulus": modulus, "target": target})
    context = plain.simulation(mm.VerletIntegrator(0.001), "Reference").context
    assert plain.energies(context)["area_difference"] == energies["area_difference"]


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"area_difference": {"alpha": 1}}, ValueError, "alpha and delta_a0, or modulus and"),
        ({"area_difference": 1.1}, TypeError, "area_difference needs a mapping"),
        ({"area_difference": {"modulus": -1, "target": 1}}, ValueError, "area_difference modulus"),
        ({"osmotic": {"solutes": 1}}, ValueError, "solutes and concentration, or solutes and"),
        ({"osmotic": {"solutes": 0, "concentration": 1}}, ValueError, "osmotic solutes needs more"),
        (
            {"rigidity": np.ones(42), "area_difference": {"alpha": 1, "delta_a0": 1}},
            ValueError,
            "one rigidity for alpha; give modulus and target",
        ),
    ],
)
def test_mistakes_of_a_vesicle(arguments, error, message):
    with pytest.raises(error, match=f"^Vesicle: .*{message}"):
        helfrich.Vesicle(Mesh.icosphere(2, 50.0), **arguments)


def test_a_pressure_needs_a_volume():
    disk = Mesh.disk(4, 50.0)
    for arguments in ({"pressure": 1.0}, {"osmotic": {"solutes": 1, "concentration": 1}}):
        with pytest.raises(ValueError, match="encloses no volume on which a pressure could act"):
            helfrich.Vesicle(disk, volume_modulus=0, **arguments)
    helfrich.Vesicle(disk, volume_modulus=0, surface_tension=0.1)


# --- single precision ----------------------------------------------------------------------------


@pytest.mark.parametrize("target", [SINGLE, *NATIVE[:2]], ids=str)
def test_digits_of_a_large_mesh(target: Target):
    """30 720 edges, each with the digits of a float; a sum of floats would lose some of them."""
    mesh = large_mesh()
    total = analysis.total_mean_curvature(mesh, mesh)

    def force():
        return AreaDifferenceForce(mesh, 1.0, 0.99 * total)

    found = Running([force()], mesh.num_vertices, target).evaluate(mesh.vertices)
    reference = Running([force()], mesh.num_vertices, REFERENCE)
    expected = reference.evaluate(target.rounded(mesh.vertices))
    compare(found, expected, 2e-5)
    error = np.sqrt(2 * found[0]) - np.sqrt(2 * expected[0])
    assert abs(error) < 2e-8 * total
