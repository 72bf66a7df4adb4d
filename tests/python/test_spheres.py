"""Bending energies of shapes whose energies are known."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import openmmhelfrich as helfrich
import pytest
from scipy.integrate import quad

PROJECT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def convergence():
    """The example that measures the orders."""
    path = PROJECT / "examples" / "convergence.py"
    spec = importlib.util.spec_from_file_location("convergence", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


SECOND_ORDER = ("Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi")


@pytest.mark.parametrize("curvature", [0.0, 0.5, -0.7])
@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_second_order_on_spheres(convergence, scheme: str, curvature: float):
    errors = convergence.sphere_errors(scheme, curvature)
    orders = convergence.orders(errors)
    print(f"{scheme}, C0 R = {curvature}: errors {errors}, orders {orders}")
    assert abs(errors[-1]) < 5e-4
    assert orders[-1] == pytest.approx(2, abs=0.15)


def test_espriu_is_of_equilateral_triangles_only(convergence):
    """Documented, so that nobody is surprised: on the icosphere the error grows."""
    errors = convergence.sphere_errors("Espriu", 0.0)
    assert 0 < errors[0] < 0.05
    assert errors[-1] > 0.5
    # An icosahedron's triangles are equilateral, and Espriu's scheme is GKB there.
    mesh = helfrich.Mesh.icosphere(1, 10.0)
    energies = [
        mesh.energy(helfrich.BendingForce(mesh, 1.0, 0.03, scheme=scheme))
        for scheme in (
            helfrich.BendingForce.Espriu,
            helfrich.BendingForce.GompperKrollBarycentric,
        )
    ]
    assert energies[0] == pytest.approx(energies[1], rel=1e-13)


def mean_curvature_integral(a: float, c: float) -> float:
    """The integral of C1 + C2 over a spheroid with half axes a, a, c.

    With r = a sin(t), z = c cos(t) and s = |d(r, z)/dt|, the curvatures are a c / s^3 along the
    meridian and c / (a s) around it; the area element is 2 pi a sin(t) s dt.
    """

    def integrand(t: float) -> float:
        s = np.hypot(a * np.cos(t), c * np.sin(t))
        return (a * c / s**3 + c / (a * s)) * 2 * np.pi * a * np.sin(t) * s

    return quad(integrand, 0, np.pi)[0]


@pytest.mark.parametrize("scheme", SECOND_ORDER)
def test_sign_of_the_spontaneous_curvature_on_a_prolate(scheme: str):
    """A long prolate is nearly a cylinder, whose mean curvature is that of its waist.

    E(C0) - E(0) = kappa (C0^2 A / 2 - C0 int H dA), so a positive C0 lowers the energy.
    """
    waist, length = 10.0, 60.0
    mesh = helfrich.Mesh.icosphere(20, waist).scaled((1, 1, length / waist))
    number = getattr(helfrich.BendingForce, scheme)

    def energy(spontaneous: float) -> float:
        return mesh.energy(helfrich.BendingForce(mesh, 1.0, spontaneous, scheme=number))

    integral = mean_curvature_integral(waist, length)
    assert integral > 0
    for spontaneous in (0.05, -0.05):
        expected = 0.5 * spontaneous**2 * mesh.area - spontaneous * integral
        # Voronoi areas of stretched triangles are the least exact.
        assert energy(spontaneous) - energy(0) == pytest.approx(expected, rel=0.02)
    assert energy(0.05) < energy(0) < energy(-0.05)
    # At the curvature of the waist a cylinder would have no energy at all; the caps have some.
    assert energy(1 / waist) < 0.35 * energy(0)


def test_inside_out_the_sign_turns():
    """Triangles that run the other way see a dent where there was a bulge."""
    mesh = helfrich.Mesh.icosphere(4, 10.0)
    inward = mesh.triangles[:, ::-1]
    for scheme in SECOND_ORDER:
        number = getattr(helfrich.BendingForce, scheme)
        outward_energy = mesh.energy(helfrich.BendingForce(mesh, 1.0, 0.1, scheme=number))
        inward_energy = mesh.energy(helfrich.BendingForce(inward, 1.0, -0.1, scheme=number))
        assert inward_energy == pytest.approx(outward_energy, rel=1e-12)
