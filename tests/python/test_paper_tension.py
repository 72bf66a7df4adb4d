"""Stiffness of modes under tension and pressure, (A16) and (A18), against forces on fine meshes."""

from __future__ import annotations

import numpy as np
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich.analysis import theory
from platforms import HELFRICH
from running import Running
from undulating import RADIUS, Undulating, limit

KAPPA = 50.0
L = [2, 3, 4, 5, 6]


def hessian(forces, start: np.ndarray, directions: list[np.ndarray], step: float) -> np.ndarray:
    """Second derivatives of an energy along displacements of all vertices, from its forces."""
    run = Running(forces, len(start), HELFRICH)
    rows = []
    for direction in directions:
        ahead, behind = (
            run.evaluate(start + sign * step * RADIUS * direction)[1] for sign in (1, -1)
        )
        change = -(ahead - behind) / (2 * step)
        rows.append([RADIUS * np.sum(change * other) for other in directions])
    return np.array(rows)


@pytest.mark.parametrize("l", L)
@pytest.mark.parametrize("reduced", [-4.0, 0.0, 3.0, 30.0])
def test_a_tension_and_its_pressure_stiffen_modes(l: int, reduced: float):
    """(A16): κ (l+2)(l−1) [l (l+1) + α], α = σ r0² / κ; the pressure 2σ/r0 holds the sphere."""
    tension = reduced * KAPPA / RADIUS**2

    def stiffness(subdivision: int) -> float:
        sphere = Undulating(l, subdivision)
        mesh = sphere.mesh
        # The pressure under which these triangles have this size, which goes to 2σ/r0.
        pressure = 2 * tension * mesh.area / (3 * mesh.volume)
        forces = [
            helfrich.BendingForce(mesh, KAPPA),
            helfrich.SurfaceTensionForce(mesh, tension),
            helfrich.PressureForce(mesh, pressure),
        ]
        bulge = sphere.field[:, np.newaxis] * sphere.directions
        return hessian(forces, mesh.vertices, [bulge], 1e-4)[0, 0]

    found = limit(stiffness)
    assert found == pytest.approx(KAPPA * (l + 2) * (l - 1) * (l * (l + 1) + reduced), rel=2e-4)
    # By equipartition: kBT over the stiffness.
    kT = 2.5
    spectrum = theory.tense_spectrum(l, KAPPA / kT, tension / kT, RADIUS)
    assert spectrum == pytest.approx(kT / found, rel=2e-4)


def test_a_sphere_buckles_where_the_theory_says():
    """At α = −6 the stiffness of l = 2 changes its sign."""
    for reduced, sign in ((-5.9, 1), (-6.1, -1)):
        sphere = Undulating(2, 32)
        mesh = sphere.mesh
        tension = reduced * KAPPA / RADIUS**2
        forces = [
            helfrich.BendingForce(mesh, KAPPA),
            helfrich.SurfaceTensionForce(mesh, tension),
            helfrich.PressureForce(mesh, 2 * tension * mesh.area / (3 * mesh.volume)),
        ]
        bulge = sphere.field[:, np.newaxis] * sphere.directions
        assert sign * hessian(forces, mesh.vertices, [bulge], 1e-4)[0, 0] > 0
    with pytest.raises(ValueError, match="where a sphere buckles"):
        theory.tense_spectrum(2, KAPPA, -6.1 * KAPPA / RADIUS**2, RADIUS)


@pytest.mark.parametrize("l", L)
@pytest.mark.parametrize("stretch", [0.97, 1.0, 1.1])
def test_a_pressure_stiffens_the_modes_of_an_elastic_shell(l: int, stretch: float):
    """(A18) with Δp: of a shell inflated to r0 from r0/√stretch, vertices free to flow sideways.

    The neo-Hookean energy has, per area at r0, the tension σ = K (α − 1), and for small further
    strains the moduli K α and μ / α, α being the stretch of areas. (A18) is for K α = 2 μ / α.
    """
    shear = 20 * KAPPA / RADIUS**2  # at r0
    young = 8 / 3 * shear
    area_modulus = 2 * shear / stretch
    tension = area_modulus * (stretch - 1)

    def stiffness(subdivision: int) -> float:
        sphere = Undulating(l, subdivision)
        mesh = sphere.mesh
        reference = mesh.vertices / np.sqrt(stretch)
        forces = [
            helfrich.BendingForce(mesh, KAPPA),
            helfrich.NeoHookeanForce(mesh, shear * stretch, area_modulus, reference),
            helfrich.PressureForce(mesh, 2 * tension * mesh.area / (3 * mesh.volume)),
        ]
        bulge = sphere.field[:, np.newaxis] * sphere.directions
        both = hessian(forces, mesh.vertices, [bulge, sphere.gradient()], 1e-4)
        # What flows sideways is in its minimum.
        return both[0, 0] - both[0, 1] * both[1, 0] / both[1, 1]

    kT = 2.5
    pressure = 2 * tension / RADIUS
    expected = theory.elastic_spectrum(l, KAPPA / kT, young / kT, RADIUS, pressure / kT)
    assert kT / limit(stiffness) == pytest.approx(expected, rel=5e-4)


def test_a_shell_that_a_pressure_buckles_is_refused():
    l = np.arange(2, 30)
    young = 1e4 / RADIUS**2
    classical = -4 * np.sqrt(young * 20.0) / RADIUS**2
    assert (theory.elastic_spectrum(l, 20.0, young, RADIUS, 0.95 * classical) > 0).all()
    with pytest.raises(ValueError, match=r"pressure_over_kT: .* buckles under -0\.00"):
        theory.elastic_spectrum(l, 20.0, young, RADIUS, 1.3 * classical)
