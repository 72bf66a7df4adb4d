"""Reporters and `analysis` on surfaces with borders and in boxes: right numbers, or none."""

from __future__ import annotations

import csv

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import app
from openmmhelfrich import analysis

BOX = np.array([[100.0, 0, 0], [20, 110, 0], [-30, 15, 120]])


def sphere() -> helfrich.Mesh:
    """A rough one, whole."""
    mesh = helfrich.Mesh.icosphere(4, 20)
    noise = np.random.default_rng(1).normal(scale=0.3, size=mesh.vertices.shape)
    return helfrich.Mesh(mesh.vertices + noise, mesh.triangles)


def wrapped() -> helfrich.Mesh:
    """The same in a box, its vertices anywhere."""
    mesh = sphere()
    images = np.random.default_rng(2).integers(-2, 3, mesh.vertices.shape)
    return helfrich.Mesh(mesh.vertices + images @ BOX, mesh.triangles, BOX)


def holed() -> helfrich.Mesh:
    mesh = sphere()
    return helfrich.Mesh(mesh.vertices, mesh.triangles[6:])


def sheet() -> helfrich.Mesh:
    return helfrich.Mesh.sheet(8, 9, 10.0, periodic=True)


def report(mesh: helfrich.Mesh, reporter) -> None:
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    if mesh.box is not None:
        system.setDefaultPeriodicBoxVectors(*mesh.box)
    system.addForce(helfrich.BendingForce(mesh, 1e-9))
    platform = mm.Platform.getPlatformByName("Reference")
    simulation = app.Simulation(app.Topology(), system, mm.VerletIntegrator(1e-6), platform)
    simulation.context.setPositions(mesh.vertices)
    simulation.reporters.append(reporter)
    simulation.step(1)


def reported(mesh: helfrich.Mesh, path) -> dict[str, float]:
    report(mesh, helfrich.MembraneReporter(path, 1, mesh))
    with open(path) as file:
        (row,) = csv.DictReader(file)
    return {name.split(" ")[0]: float(value) for name, value in row.items()}


def test_the_shape_of_what_crosses_faces_is_that_of_the_whole(tmp_path):
    whole, row = analysis.shape(sphere(), sphere()), reported(wrapped(), tmp_path / "a.csv")
    found = analysis.shape(wrapped(), wrapped())
    bare = analysis.shape(wrapped().vertices, wrapped().triangles, box=BOX)
    for name in ("area", "volume", "reduced_volume", "radius_of_gyration", "asphericity"):
        expected = pytest.approx(getattr(whole, name), rel=1e-9)
        assert getattr(found, name) == getattr(bare, name) == expected
        assert row[name] == expected


@pytest.mark.parametrize(
    "mesh, lost",
    [
        (holed(), {"volume", "reduced_volume"}),
        (sheet(), {*analysis.Shape._fields} - {"area"}),
    ],
    ids=["holed", "sheet"],
)
def test_what_has_no_meaning_is_nan(mesh, lost, tmp_path):
    row, found = reported(mesh, tmp_path / "a.csv"), analysis.shape(mesh, mesh)
    assert row["area"] == pytest.approx(mesh.area)
    for name, value in found._asdict().items():
        assert np.isnan(value) == np.isnan(row[name]) == (name in lost)
    with pytest.raises(ValueError, match=r"area_excess: .* border or spans"):
        analysis.area_excess(mesh, mesh)


def test_modes_need_a_closed_surface_in_one_piece(tmp_path):
    with pytest.raises(ValueError, match="the surface has a border"):
        analysis.mode_amplitudes(holed(), holed(), 2)
    with pytest.raises(ValueError, match="ModeReporter: the surface spans the periodic box"):
        report(sheet(), helfrich.ModeReporter(tmp_path / "a.csv", 1, sheet(), 2))
    report(wrapped(), helfrich.ModeReporter(tmp_path / "b.csv", 1, wrapped(), 3))
    expected = analysis.mode_amplitudes(sphere(), sphere(), 3)
    _, _, found = analysis.read_modes(tmp_path / "b.csv")
    np.testing.assert_allclose(found[0], expected, atol=1e-9)
    found = analysis.mode_amplitudes(wrapped(), wrapped(), 3)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_vtkhdf_has_whole_surfaces_and_counts_neighbours_at_borders(tmp_path):
    h5py = pytest.importorskip("h5py")

    def read(mesh: helfrich.Mesh, name: str) -> np.ndarray:
        path = tmp_path / "a.vtkhdf"
        report(mesh, helfrich.VTKHDFReporter(path, 1, mesh))
        with h5py.File(path) as file:
            return file["VTKHDF"][name][:]

    assert read(wrapped(), "CellData/area").sum() == pytest.approx(sphere().area, rel=1e-6)
    np.testing.assert_array_equal(read(holed(), "PointData/neighbours"), holed().degrees)
    np.testing.assert_allclose(read(sheet(), "Points"), sheet().unfolded()[0], rtol=0, atol=1e-9)


def test_the_box_of_a_context_is_the_present_one():
    mesh = sheet()
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    system.addForce(helfrich.BendingForce(mesh, 1.0))
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
    context.setPeriodicBoxVectors(*(1.1 * mesh.box))
    context.setPositions(1.1 * mesh.vertices)
    areas = analysis.triangle_areas(context, mesh)
    assert areas.sum() == pytest.approx(1.21 * mesh.area, rel=1e-12)


class TestVirialReporter:
    def test_columns_are_what_they_say(self, tmp_path):
        mesh = wrapped()
        path = tmp_path / "virial.csv"
        system = mm.System()
        for index in range(mesh.num_vertices):
            system.addParticle(20.0 + index)
        system.setDefaultPeriodicBoxVectors(*mesh.box)
        system.addForce(helfrich.BendingForce(mesh, 50))
        system.addForce(helfrich.SurfaceAreaForce(mesh, 5, 0.9 * mesh.area))
        platform = mm.Platform.getPlatformByName("Reference")
        simulation = app.Simulation(app.Topology(), system, mm.VerletIntegrator(1e-9), platform)
        simulation.context.setPositions(mesh.vertices)
        simulation.context.setVelocitiesToTemperature(300, 1)
        simulation.reporters.append(helfrich.VirialReporter(path, 1, mesh))
        simulation.step(1)
        table = analysis.read_table(path)
        stored = helfrich.virial(simulation.context)
        velocities = simulation.context.getState(velocities=True).getVelocities(asNumpy=True)._value
        motion = sum(
            (20.0 + index) * np.outer(velocity, velocity)
            for index, velocity in enumerate(velocities)
        )
        for name, matrix in (("virial", stored), ("motion", motion)):
            for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
                found = table[f"{name}_{'xyz'[i]}{'xyz'[j]}"][0]
                assert found == pytest.approx(matrix[i, j], abs=1e-9 * abs(matrix).max())
        inner = np.diag(stored - motion)
        assert table["tension"][0] == pytest.approx(inner[:2].sum() / 2 / (100.0 * 110.0))
        assert table["pull"][0] == pytest.approx(inner[2] / 120.0)
        vectors = [table[name][0] for name in ("ax", "bx", "by", "cx", "cy", "cz")]
        assert vectors == [100.0, 20.0, 110.0, -30.0, 15.0, 120.0]

    @pytest.mark.long
    def test_the_mean_tension_is_the_one_that_is_imposed(self, tmp_path):
        mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
        system = mm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(50.0)
        system.setDefaultPeriodicBoxVectors(*mesh.box)
        system.addForce(helfrich.BendingForce(mesh, 50))
        system.addForce(helfrich.SurfaceAreaForce(mesh, 20, mesh.area))
        one = mesh.area / mesh.num_triangles
        system.addForce(helfrich.TriangleAreaForce(mesh, 2, one))
        system.addForce(helfrich.TriangleHeightForce(mesh, 7.0, 10.0))
        mover = helfrich.MonteCarloMembraneTension(300, 0.5, 10)
        mover.setRandomNumberSeed(1)
        system.addForce(mover)
        integrator = mm.LangevinMiddleIntegrator(300, 0.5, 0.1)
        integrator.setRandomNumberSeed(1)
        platform = mm.Platform.getPlatformByName("Helfrich")
        simulation = app.Simulation(app.Topology(), system, integrator, platform)
        simulation.context.setPositions(mesh.vertices)
        simulation.context.setVelocitiesToTemperature(300, 1)
        simulation.step(20000)
        path = tmp_path / "virial.csv"
        simulation.reporters.append(helfrich.VirialReporter(path, 20, mesh))
        simulation.step(100000)
        tension = analysis.mean_with_error(analysis.read_table(path)["tension"])
        # What the momenta give is 0.029.
        assert tension.error < 0.005
        assert abs(tension.mean - 0.5) < 4 * tension.error

    def test_a_membrane_in_no_box_is_refused(self, tmp_path):
        with pytest.raises(ValueError, match=r"VirialReporter: .* no periodic box"):
            report(sphere(), helfrich.VirialReporter(tmp_path / "v.csv", 1, sphere()))
