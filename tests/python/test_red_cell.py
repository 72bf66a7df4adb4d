"""Red cells: their shapes, their models, and that they stretch as measured."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich import analysis
from openmmhelfrich._mesh.discs import evans_fung, spheroid
from openmmhelfrich.red_cell import RED_CELL_MODELS, RedCellModel

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples"))
import red_cell_stretching as stretching

MODELS = list(RED_CELL_MODELS)


def shear_force(cell: helfrich.RedCell) -> mm.Force:
    cell.system()
    return cell.placement.forces["shear"]


class TestShapes:
    def test_the_mean_red_cell(self):
        """Areas and volumes as Evans and Fung's, 135 µm² and 94 µm³."""
        profile = evans_fung(7820.0)
        assert profile.area == pytest.approx(135e6, rel=0.01)
        assert profile.volume == pytest.approx(94e9, rel=0.005)
        cell = helfrich.RedCell("amoudruz", 1002)
        assert cell.mesh.area == pytest.approx(profile.area, rel=0.006)
        assert cell.mesh.volume == pytest.approx(profile.volume, rel=0.01)
        radii = np.hypot(*cell.mesh.vertices.T[:2])
        assert radii.max() == pytest.approx(3910, rel=0.01)
        middle = np.abs(cell.mesh.vertices[radii < 500, 2])
        rim = np.abs(cell.mesh.vertices[:, 2]).max()
        assert middle.max() < 0.45 * rim

    @pytest.mark.parametrize("reduced", [1.0, 0.95, 0.65, 0.3])
    def test_spheroids(self, reduced):
        shape = spheroid(100.0, reduced)
        assert shape.area == pytest.approx(100.0, rel=1e-9)
        assert 6 * np.sqrt(np.pi) * shape.volume / shape.area**1.5 == pytest.approx(reduced)

    def test_a_sphere_is_its_own_image(self):
        ball = helfrich.Mesh.icosphere(8, 2.0)
        image = spheroid(16 * np.pi, 1.0).of_sphere(ball.vertices)
        np.testing.assert_allclose(image, ball.vertices, atol=1e-6)

    @pytest.mark.parametrize("shape", [evans_fung(7820.0), spheroid(1e8, 0.6)])
    def test_maps_keep_areas(self, shape):
        ball = helfrich.Mesh.random_sphere(4002, 1.0, seed=2)
        mesh = helfrich.Mesh(shape.of_sphere(ball.vertices), ball.triangles)
        before, after = analysis.triangle_areas(ball, ball), analysis.triangle_areas(mesh, mesh)
        shares = (after / after.sum()) / (before / before.sum())
        assert np.abs(shares - 1).max() < 0.03


class TestModels:
    @pytest.mark.parametrize("model", MODELS)
    def test_all_can_be_simulated(self, model):
        cell = helfrich.RedCell(model, 252)
        integrator = mm.LangevinMiddleIntegrator(300, 0.01, 0.2)
        simulation = cell.simulation(integrator)
        simulation.minimizeEnergy(maxIterations=200)
        simulation.context.setVelocitiesToTemperature(300, 1)
        simulation.step(200)
        energies = cell.energies(simulation.context)
        assert {"area", "volume", "shear"} <= set(energies)
        assert np.isfinite(list(energies.values())).all()
        now = cell.placement.mesh(simulation.context)
        assert now.area == pytest.approx(cell.mesh.area, rel=0.01)
        assert now.volume == pytest.approx(cell.mesh.volume, rel=0.01)

    @pytest.mark.parametrize("law", ["springs", "harmonic", "Skalak", "Lim", "Amoudruz"])
    def test_at_rest_in_its_reference(self, law):
        cell = helfrich.RedCell("lim", 252, shear_law=law, reference=None)
        assert cell.mesh.energy(shear_force(cell)) == pytest.approx(0.0, abs=1e-9)
        ball = helfrich.RedCell("lim", 252, shear_law=law, reference=1)
        assert ball.reference.reduced_volume == pytest.approx(0.99, abs=0.02)
        assert ball.reference.area == pytest.approx(ball.mesh.area)
        assert ball.mesh.energy(shear_force(ball)) > 1.0

    @pytest.mark.parametrize("law", ["springs", "harmonic", "Skalak", "Lim", "Amoudruz"])
    def test_shear_modulus_of_small_strains(self, law):
        """Of a flat patch: a pure shear by ε costs 2 μ ε² by area, springs to their disorder."""
        from openmmhelfrich.red_cell import _SHEAR

        flat = helfrich.Mesh.disk(12, 10.0)
        model = RedCellModel(
            shear_law=law, shear_modulus=3.0, local_area_modulus=5.0, rigidity=1.0,
            area_modulus=1.0, volume_modulus=1.0,
        )  # fmt: skip
        force = _SHEAR[law](flat, model, flat, {"offset": 0})
        strain = 1e-4
        sheared = helfrich.Mesh(flat.vertices * (1 + strain, 1 - strain, 1), flat.triangles)
        # The patch is hexagonal, so a net of springs is isotropic; its border belongs to one side.
        expected = 2 * 3.0 * strain**2 * flat.area
        tolerance = 0.1 if law in ("springs", "harmonic") else 1e-3
        assert sheared.energy(force) == pytest.approx(expected, rel=tolerance)

    def test_changes_and_quantities(self):
        cell = helfrich.RedCell(
            "fedosov", 252, shear_modulus=0.01 * unit.kilojoule_per_mole / unit.nanometer**2,
            diameter=8 * unit.micrometer,
        )  # fmt: skip
        assert cell.model.shear_modulus == 0.01
        assert np.ptp(cell.mesh.vertices[:, 0]) == pytest.approx(8000, rel=0.02)
        own = RedCellModel(
            shear_law="Skalak", shear_modulus=1e-3, local_area_modulus=2e-3, rigidity=100.0,
            area_modulus=0.1, volume_modulus=1e-4,
        )  # fmt: skip
        assert helfrich.RedCell(own, 252).model == own

    @pytest.mark.parametrize(
        ("arguments", "changes", "error", "message"),
        [
            (("nobody",), {}, ValueError, "no model 'nobody'; known are: fedosov"),
            ((3,), {}, TypeError, "model needs a name or a RedCellModel, got int"),
            (("lim",), {"colour": 1}, TypeError, "a model has no 'colour'"),
            (("lim",), {"shear_law": "rubber"}, ValueError, "no shear_law 'rubber'"),
            (("lim",), {"bending": "rubber"}, ValueError, "no bending 'rubber'"),
            (("lim",), {"rigidity": -1}, ValueError, "rigidity needs 0 or more"),
            (("lim",), {"rigidity": 1 * unit.kelvin}, TypeError, "rigidity needs the unit"),
            (("lim",), {"reference": 1.2}, ValueError, "reduced volume from 0.01 to 1"),
            (
                ("lim",),
                {"shear_law": "Skalak", "local_area_modulus": 0.0},
                ValueError,
                "Skalak's law has a local_area_modulus of at least shear_modulus",
            ),
        ],
    )
    def test_mistakes_are_named(self, arguments, changes, error, message):
        with pytest.raises(error, match=message):
            helfrich.RedCell(*arguments, 252, **changes)


@pytest.mark.parametrize("num_vertices", [252, 502])
def test_stretches_as_measured(num_vertices):
    """Between optical tweezers: Mills et al. 2004, area and volume within 1 %."""
    measured = stretching.MILLS[[0, 1, 5, 8, 12]]
    cell = helfrich.RedCell("amoudruz", num_vertices)
    found = stretching.stretch(cell, measured[:, 0])
    assert stretching.within(found, measured).all(), found
    np.testing.assert_allclose(found[:, 2:], 1.0, atol=0.01)
