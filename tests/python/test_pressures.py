"""Pressure, tension and osmotic pressure: balances that are exact for polyhedra, and bad input."""

from __future__ import annotations

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import oracle
import pytest
from meshes import membrane
from openmm import unit
from openmmhelfrich.vcm import strings
from platforms import ON_OPENCL, ON_PROCESSOR, REFERENCE, Target
from running import Running

SIGMA = 1.7
CLOSED = [name for name in meshes.NAMES if name not in meshes.OPEN_NAMES]


def _mesh(where: str) -> helfrich.Mesh:
    m = membrane(where)
    return helfrich.Mesh(m.positions[m.members], np.searchsorted(m.members, m.triangles))


def _forces(mesh: helfrich.Mesh, *forces: mm.Force, target: Target = REFERENCE) -> np.ndarray:
    return Running(list(forces), mesh.num_vertices, target).evaluate(mesh.vertices)[1]


@pytest.mark.parametrize("where", CLOSED)
def test_pressure_balances_tension_under_scaling(where: str):
    """p dV = σ dA for r → λ r at p = 2 σ A / 3 V, which is 2 σ / r on a sphere."""
    mesh = _mesh(where)
    balance = 2 * SIGMA * mesh.area / (3 * mesh.volume)
    pressure = helfrich.PressureForce(mesh, balance)
    forces = _forces(mesh, helfrich.SurfaceTensionForce(mesh, SIGMA), pressure)
    alone = _forces(mesh, helfrich.SurfaceTensionForce(mesh, SIGMA))
    assert np.sum(alone * mesh.vertices) == pytest.approx(-2 * SIGMA * mesh.area, rel=1e-10)
    assert abs(np.sum(forces * mesh.vertices)) <= 1e-10 * SIGMA * mesh.area


@pytest.mark.parametrize("n", [1, 2, 4, 8, 16])
def test_laplace(n: int):
    """The balance of polyhedra goes to 2 σ / r, and each vertex of a regular one is at rest."""
    mesh = helfrich.Mesh.icosphere(n, 10.0)
    balance = 2 * SIGMA * mesh.area / (3 * mesh.volume)
    assert balance == pytest.approx(2 * SIGMA / 10.0, rel=0.3 / n**2)
    if n == 1:
        pressure = helfrich.PressureForce(mesh, balance)
        forces = _forces(mesh, helfrich.SurfaceTensionForce(mesh, SIGMA), pressure)
        alone = _forces(mesh, helfrich.SurfaceTensionForce(mesh, SIGMA))
        assert np.abs(forces).max() <= 1e-12 * np.abs(alone).max()


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_OPENCL], ids=str)
def test_osmotic_pressure_is_that_of_van_t_hoff(target: Target):
    mesh = _mesh("jittered")
    kT, concentration = 2.5, 0.02
    for ratio in (0.2, 0.95, 1.3, 40.0):
        solutes = ratio * concentration * mesh.volume
        osmotic = helfrich.OsmoticPressureForce(mesh, solutes, concentration, kT)
        pressure = helfrich.PressureForce(mesh, kT * (solutes / mesh.volume - concentration))
        found = _forces(mesh, osmotic, target=target)
        expected = _forces(mesh, pressure)
        assert np.abs(found - expected).max() <= target.tolerance * np.abs(expected).max()


def test_osmotic_equilibrium():
    mesh = _mesh("jittered")
    force = helfrich.OsmoticPressureForce(mesh, 0.02 * mesh.volume, 0.02, 2.5)
    energy, forces = Running([force], mesh.num_vertices, REFERENCE).evaluate(mesh.vertices)
    assert 0 <= energy < 1e-20
    swollen = helfrich.PressureForce(mesh, 0.05)
    assert np.abs(forces).max() <= 1e-12 * np.abs(_forces(mesh, swollen)).max()


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_OPENCL], ids=str)
def test_what_has_turned_inside_out_has_no_osmotic_pressure(target: Target):
    mesh = _mesh("jittered")
    force = helfrich.OsmoticPressureForce(mesh, 0.02 * mesh.volume, 0.02, 2.5)
    run = Running([force], mesh.num_vertices, target)
    energy, _ = run.evaluate(mesh.vertices)
    with pytest.raises(mm.OpenMMException, match=r"the energy of OsmoticPressureForce is"):
        run.evaluate(mesh.vertices * [1, 1, -1])
    assert run.evaluate(mesh.vertices)[0] == energy


def test_without_energies_too():
    """A leapfrog asks for forces only."""
    mesh = _mesh("jittered")
    force = helfrich.OsmoticPressureForce(mesh, 0.02 * mesh.volume, 0.02, 2.5)
    run = Running([force], mesh.num_vertices, REFERENCE)
    run.evaluate(mesh.vertices)
    run.context.setPositions(mesh.vertices * [1, 1, -1])
    with pytest.raises(mm.OpenMMException, match=r"the energy of OsmoticPressureForce is"):
        run.context.getState(forces=True)


def test_quantities():
    mesh = helfrich.Mesh.icosphere(2, 50.0)
    bar = unit.bar * unit.AVOGADRO_CONSTANT_NA
    pressure = helfrich.PressureForce(mesh, 16.605390671738466 * bar)
    assert pressure.getPressure() == pytest.approx(1, rel=1e-9)
    tension = helfrich.SurfaceTensionForce(
        mesh, 1.66053906717 * unit.AVOGADRO_CONSTANT_NA * unit.millijoule / unit.meter**2
    )
    assert tension.getTension() == pytest.approx(1, rel=1e-9)
    osmotic = helfrich.OsmoticPressureForce(
        mesh, 1e5, 0.2 / unit.nanometer**3, unit.MOLAR_GAS_CONSTANT_R * 300 * unit.kelvin
    )
    assert osmotic.getThermalEnergy() == pytest.approx(2.4943387854, rel=1e-9)
    assert osmotic.getConcentration() == 0.2
    with pytest.raises(TypeError, match="concentration must be in units of"):
        helfrich.OsmoticPressureForce(mesh, 1e5, 0.2 * unit.molar, 2.5)


@pytest.mark.parametrize(
    "make",
    [
        lambda mesh: helfrich.PressureForce(mesh, 0.05),
        lambda mesh: helfrich.SurfaceTensionForce(mesh, 1.3),
        lambda mesh: helfrich.OsmoticPressureForce(mesh, 0.01 * mesh.volume, 0.02, 2.5),
        lambda mesh: helfrich.AreaDifferenceForce(mesh, 0.3, 500.0),
    ],
    ids=["pressure", "tension", "osmotic pressure", "area difference"],
)
def test_as_custom_forces(make):
    """`vcm.strings` writes them with OpenMM's own functions, about the origin."""
    mesh = _mesh("concave")
    energy, forces = Running([make(mesh)], mesh.num_vertices, REFERENCE).evaluate(mesh.vertices)
    found = oracle.evaluate(strings.custom_forces(make(mesh)), mesh.vertices)
    assert found.energy == pytest.approx(energy, rel=1e-9)
    assert np.abs(found.forces - forces).max() <= 1e-8 * np.abs(forces).max()


@pytest.mark.parametrize(
    "make",
    [
        lambda mesh: helfrich.PressureForce(mesh, 1.0),
        lambda mesh: helfrich.OsmoticPressureForce(mesh, 1.0, 1.0, 1.0),
    ],
    ids=["PressureForce", "OsmoticPressureForce"],
)
def test_they_need_an_outside(make):
    disk = helfrich.Mesh.disk(4, 50.0)
    with pytest.raises(mm.OpenMMException, match="needs a closed surface"):
        Running([make(disk)], disk.num_vertices, REFERENCE)
    mesh = _mesh("jittered")
    clockwise = mesh.triangles[:, [0, 2, 1]]
    with pytest.raises(mm.OpenMMException, match="clockwise"):
        Running([make(clockwise)], mesh.num_vertices, REFERENCE).evaluate(mesh.vertices)
