"""Sums over modes (A7–A12) against the areas, volumes and energies of fine meshes; affine maps."""

from __future__ import annotations

import numpy as np
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich.analysis import area_excess, theory
from undulating import RADIUS, Undulating, half_second_derivative, limit

KAPPA = 50.0
KJ = unit.kilojoule_per_mole
SCHEMES = ("Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi")


def of_u(sphere: Undulating, amplitude: float, swelling: float = 0.0) -> np.ndarray:
    """Amplitudes with a share of the field of the sphere, and u_00."""
    result = amplitude * sphere.amplitudes
    result[0] = swelling
    return result


@pytest.mark.parametrize("l", [2, 3, 4, 5, 6])
def test_area_and_volume_are_sums_over_modes(l: int):
    """The coefficients of u² on spheres of triangles go to 1 + l (l+1) / 2 and 1."""
    sphere = Undulating(l, 1)

    def expected(of_modes) -> float:
        return half_second_derivative(lambda u: of_modes(of_u(sphere, u), RADIUS))

    area = limit(lambda n: half_second_derivative(lambda u: Undulating(l, n).bulged(u).area))
    assert area == pytest.approx((1 + l * (l + 1) / 2) * RADIUS**2, rel=3e-5)
    assert expected(theory.mode_area) == pytest.approx((1 + l * (l + 1) / 2) * RADIUS**2, rel=1e-6)
    volume = limit(lambda n: half_second_derivative(lambda u: Undulating(l, n).bulged(u).volume))
    assert volume == pytest.approx(RADIUS**3, rel=3e-5)
    assert expected(theory.mode_volume) == pytest.approx(RADIUS**3, rel=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("l", [2, 4, 6])
def test_bending_energy_is_a_sum_over_modes(l: int, scheme: str):
    """κ/2 (l−1) l (l+1) (l+2) u², with each model of bending."""

    def coefficient(subdivision: int) -> float:
        sphere = Undulating(l, subdivision)
        force = helfrich.BendingForce(
            sphere.mesh, KAPPA, 0.0, getattr(helfrich.BendingForce, scheme)
        )
        return half_second_derivative(lambda u: sphere.bulged(u).energy(force))

    expected = KAPPA / 2 * (l - 1) * l * (l + 1) * (l + 2)
    assert limit(coefficient) == pytest.approx(expected, rel=1e-4)
    u = Undulating(l, 1).amplitudes
    assert theory.mode_energy(u, KAPPA) - 8 * np.pi * KAPPA == pytest.approx(expected)


def test_modes_of_all_l_add_up():
    """Modes of different l have no terms together, and u_00 swells all of it."""
    swelling, size = 0.02, 1e-2
    spheres = [Undulating(l, 48) for l in (2, 3, 5)]
    field = sum(sphere.field for sphere in spheres)
    amplitudes = np.zeros(36)
    for sphere in spheres:
        amplitudes[: len(sphere.amplitudes)] += size * sphere.amplitudes
    amplitudes[0] = swelling
    scale = 1 + swelling / np.sqrt(4 * np.pi) + size * field[:, np.newaxis]
    mesh = helfrich.Mesh(spheres[0].mesh.vertices * scale, spheres[0].mesh.triangles)
    # Triangles cut off 5e-4 of either, and of the second order about 1e-5 of it is left.
    flat = spheres[0].mesh
    area = mesh.area / flat.area * 4 * np.pi * RADIUS**2
    volume = mesh.volume / flat.volume * 4 * np.pi / 3 * RADIUS**3
    second = 4 * np.pi * RADIUS**2 * size**2
    assert area == pytest.approx(theory.mode_area(amplitudes, RADIUS), abs=0.1 * second)
    assert volume == pytest.approx(
        theory.mode_volume(amplitudes, RADIUS), abs=0.1 * second * RADIUS
    )
    both = theory.mode_area(np.stack([amplitudes, 0 * amplitudes]), [RADIUS, 1.0])
    assert both == pytest.approx([theory.mode_area(amplitudes, RADIUS), 4 * np.pi])


@pytest.mark.parametrize("l", [2, 3, 6])
def test_area_that_a_given_volume_has_too_much(l: int):
    """½ (l+2)(l−1) u² at the volume of the sphere; what fluctuations hide follows from it."""

    def excess(subdivision: int) -> float:
        sphere = Undulating(l, subdivision)
        triangles = sphere.mesh.triangles
        return half_second_derivative(lambda u: area_excess(sphere.bulged(u).vertices, triangles))

    assert limit(excess) == pytest.approx((l + 2) * (l - 1) / (8 * np.pi), rel=3e-5)


@pytest.mark.parametrize(
    ("call", "culprit"),
    [
        (lambda: theory.mode_area(np.zeros(5), 1), r"amplitudes: need shape .*\(5,\)"),
        (lambda: theory.mode_volume(1.0, 1), "amplitudes: need shape"),
        (lambda: theory.mode_area(np.zeros(4), 0), "radius: need a positive number, got 0"),
        (lambda: theory.mode_volume(np.zeros(4), -2), "radius: need a positive number, got -2"),
    ],
)
def test_bad_input_is_named(call, culprit):
    with pytest.raises(ValueError, match=culprit):
        call()


@pytest.mark.parametrize(
    ("call", "culprit"),
    [
        (lambda: theory.mode_area(np.zeros(4), 9 * unit.nanometer), "radius: .*unit nanometer"),
        (lambda: theory.mode_energy(np.zeros(4), 50 * KJ), "rigidity: .*unit kilojoule/mole"),
        (lambda: theory.fluid_spectrum(2, 20 * KJ), "kappa_over_kT: need plain numbers, got the"),
        (lambda: theory.elastic_spectrum(2, 20, 1 * KJ, 1), "young_over_kT: need plain numbers"),
        (lambda: theory.fluid_spectrum(2, "stiff"), "kappa_over_kT: need numbers, got 'stiff'"),
    ],
)
def test_formulae_take_plain_numbers_and_say_so(call, culprit):
    with pytest.raises(TypeError, match=culprit):
        call()


def test_affine_maps_of_the_plane_that_keep_areas_keep_the_energies_of_areas():
    """The paper's Fig. 3: what a sheared plane of triangles feels is the heights alone."""
    plane = helfrich.Mesh.disk(6, 50.0)
    random = np.random.default_rng(1)
    vertices = plane.vertices.copy()
    vertices[:, :2] += random.normal(size=(len(vertices), 2))
    mesh = helfrich.Mesh(vertices, plane.triangles)
    sheared = helfrich.Mesh(
        vertices @ np.array([[1.3, 0, 0], [0.4, 1 / 1.3, 0], [0, 0, 1]]), plane.triangles
    )
    target = mesh.area / len(mesh.triangles)
    areas = [
        helfrich.TriangleAreaForce(mesh, 1.0, target),
        helfrich.SurfaceAreaForce(mesh, 1.0, 0.9 * mesh.area),
        helfrich.TriangleAreaRepulsionForce(mesh, target, 1.0),
        helfrich.PlaquetteAreaForce(mesh, 1.0, mesh.area),
    ]
    for force in areas:
        assert mesh.energy(force) > 0
        assert sheared.energy(force) == pytest.approx(mesh.energy(force), rel=1e-9)
    heights = helfrich.TriangleHeightForce(mesh, 0.8 * mesh.min_height(1.0), 1.0)
    assert sheared.energy(heights) > 1.5 * mesh.energy(heights) > 0
