"""Vertex quantities, shapes, landscapes and lifetimes, against other code and by hand."""

import numpy as np
import openmm
import pytest
from numpy_energies import Geometry
from openmm import unit
from openmmhelfrich import analysis
from openmmhelfrich.analysis.curvature import SCHEMES
from openmmhelfrich.errors import MeshError
from openmmhelfrich.forces import (
    BendingForce,
    EnclosedVolumeForce,
    SurfaceAreaForce,
    TriangleHeightForce,
)
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import Vesicle
from scipy.spatial.transform import Rotation


@pytest.fixture(scope="module")
def rough():
    """An asymmetric mesh with dents."""
    mesh = Mesh.random_sphere(162, 100, seed=4).deformed(3, 1, 0.2)
    noise = np.random.default_rng(1).normal(scale=2, size=mesh.vertices.shape)
    return Mesh(mesh.vertices + noise, mesh.triangles)


class TestVertexQuantities:
    def test_are_those_of_another_implementation(self, rough):
        ours, other = analysis.vertex_quantities(rough, rough), Geometry(*parts(rough))
        for found, expected in (
            (ours.barycentric_area, other.barycentric_areas),
            (ours.voronoi_area, other.voronoi_areas),
            (ours.normal, other.vertex_normals),
            (ours.julicher, other.integrated_curvatures),
            (ours.cotangent, other.curvature_vectors),
            (ours.umbrella, other.neighbour_sums / 3**0.5),
        ):
            np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-11)

    @pytest.mark.parametrize("scheme", SCHEMES)
    def test_give_the_energies_of_the_force(self, rough, scheme):
        """The linear term of C0 has Σ H a, and the squared one, of scalars, Σ H² a."""
        number = getattr(BendingForce, scheme)
        bent, flat = (rough.energy(BendingForce(rough, 2.0, c0, number)) for c0 in (0.01, 0))
        q = analysis.vertex_quantities(rough, rough)
        h = q.mean_curvature(scheme)
        area = q.voronoi_area if "Voronoi" in scheme or scheme == "GompperKroll" else None
        area = q.barycentric_area if area is None else area
        assert bent - flat == pytest.approx(np.sum(-2 * 0.01 * h * area + 1e-4 * area))
        if "Julicher" in scheme:
            assert flat == pytest.approx(np.sum(h**2 * area))
        np.testing.assert_array_equal(analysis.mean_curvature(rough, rough, number), h)

    @pytest.mark.parametrize("scheme", SCHEMES)
    def test_of_a_sphere(self, scheme):
        mesh = Mesh.icosphere(8, 1000)
        h = analysis.mean_curvature(mesh, mesh, scheme)
        # Espriu's vector is that of equilateral triangles, which those of an icosphere are not.
        assert np.mean(h) == pytest.approx(2e-3, rel=0.1 if scheme == "Espriu" else 0.02)

    def test_frames_and_schemes(self, rough):
        frames = np.stack([rough.vertices, 2 * rough.vertices])
        q = analysis.vertex_quantities(frames, rough)
        assert q.normal.shape == (2, 162, 3)
        np.testing.assert_allclose(q.cotangent[1], 2 * q.cotangent[0], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(q.voronoi_area[1], 4 * q.voronoi_area[0])
        for wrong in ("Jülicher", 5, -1, 1.5, True):
            with pytest.raises(ValueError, match="scheme: need one of"):
                analysis.mean_curvature(rough, rough, wrong)

    def test_elements(self, rough):
        x, t = parts(rough)
        np.testing.assert_allclose(analysis.triangle_areas(x, t), Geometry(x, t).areas)
        np.testing.assert_allclose(
            np.sort(analysis.triangle_heights(x, t), axis=None), np.sort(Geometry(x, t).heights)
        )
        lengths = analysis.edge_lengths(np.stack([x, 3 * x]), t)
        expected = np.linalg.norm(np.diff(x[rough.edges], axis=1)[:, 0], axis=1)
        np.testing.assert_allclose(lengths, [expected, 3 * expected])


def parts(mesh):
    return mesh.vertices, mesh.triangles


class TestShape:
    def test_of_a_mesh(self, rough):
        s = analysis.shape(rough.translated((1e3, 0, 500)), rough)
        assert s.area == pytest.approx(rough.area)
        assert s.volume == pytest.approx(rough.volume)
        assert s.reduced_volume == pytest.approx(rough.reduced_volume)
        centred = rough.vertices - rough.vertices.mean(axis=0)
        assert s.radius_of_gyration == pytest.approx(np.sqrt((centred**2).sum(axis=1).mean()))
        assert analysis.area_excess(rough, rough) == pytest.approx(
            rough.area / (4 * np.pi) * (3 * rough.volume / (4 * np.pi)) ** (-2 / 3) - 1
        )

    def test_inside_out_has_no_excess(self, rough):
        reverse = rough.triangles[:, ::-1]
        with pytest.raises(ValueError, match="area_excess: the mesh is inside out"):
            analysis.area_excess(rough, reverse)
        frames = np.stack([rough.vertices, rough.vertices * [1, 1, -1]])
        with pytest.raises(ValueError, match="area_excess: frame 1 is inside out"):
            analysis.area_excess(frames, rough)

    def test_of_rods_and_disks(self):
        sphere = Mesh.icosphere(6, 100)
        rotation = Rotation.random(random_state=1)
        sizes = {"sphere": (1, 1, 1), "disk": (1, 1, 1e-3), "rod": (1e-3, 1e-3, 1)}
        found = {
            name: analysis.shape(sphere.scaled(size).rotated(rotation), sphere)
            for name, size in sizes.items()
        }
        # λ = R²/3 along an axis of the sphere.
        third = 1e4 / 3
        expected = {"sphere": (0, 0, 0), "disk": (third / 2, third, 1 / 4), "rod": (third, 0, 1)}
        for name, (asphericity, acylindricity, anisotropy) in expected.items():
            s = found[name]
            assert s.asphericity == pytest.approx(asphericity, abs=0.02)
            assert s.acylindricity == pytest.approx(acylindricity, abs=0.02)
            assert s.anisotropy == pytest.approx(anisotropy, abs=1e-5)

    def test_gyration_tensor_turns_along(self, rough):
        tensor = analysis.gyration_tensor(rough)
        turn = Rotation.random(random_state=2).as_matrix()
        np.testing.assert_allclose(
            analysis.gyration_tensor(rough.rotated(turn)), turn @ tensor @ turn.T, atol=1e-8
        )
        np.testing.assert_allclose(tensor, np.cov(rough.vertices.T, bias=True))


class TestLandscape:
    def test_is_the_energy_of_the_moved_mesh(self, rough):
        forces = {
            "bending": BendingForce(rough, 50, 0.01, BendingForce.GompperKroll),
            "heights": TriangleHeightForce(rough, 10, 10),
            "area": SurfaceAreaForce(rough, 1.3, rough.area),
            "volume": EnclosedVolumeForce(rough, 0.04, rough.volume),
        }
        for make in (analysis.sphere_grid, analysis.plane_grid):
            grid = make(rough, 7, size=3, half_width=8)
            found = analysis.landscape(rough, forces, 7, grid)
            for i, j in np.ndindex(3, 3):
                vertices = rough.vertices.copy()
                vertices[7] = grid.points[i, j]
                moved = Mesh(vertices, rough.triangles)
                for name, force in forces.items():
                    assert found[name][i, j] == pytest.approx(moved.energy(force), rel=1e-10)
            single = analysis.landscape(rough, forces["heights"], 7, grid.points[1])
            np.testing.assert_array_equal(single, found["heights"][1])

    def test_of_a_sheet_in_its_box(self):
        sheet = Mesh.sheet(8, 8, 6.0, periodic=True)
        force = BendingForce(sheet, 50)
        points = sheet.vertices[9] + [[0, 0, 0], [0, 0, 0.5], [0.2, -0.1, 1.0]]
        found = analysis.landscape(sheet, force, 9, points)
        for energy, point in zip(found, points, strict=True):
            vertices = sheet.vertices.copy()
            vertices[9] = point
            moved = Mesh(vertices, sheet.triangles, box=sheet.box)
            assert energy == pytest.approx(moved.energy(force), rel=1e-10, abs=1e-10)
        assert found[2] > 1
        with pytest.raises(MeshError, match=r"^landscape: the mesh has a periodic box"):
            analysis.landscape(sheet, BendingForce(sheet.triangles, 50), 9, points)

    def test_grids(self, rough):
        centre, vertex = rough.vertices.mean(axis=0), rough.vertices[7]
        outward = (vertex - centre) / np.linalg.norm(vertex - centre)
        sphere = analysis.sphere_grid(rough, 7, 20, 41)
        plane = analysis.plane_grid(rough, 7, 20, 41)
        for grid in (sphere, plane):
            assert grid.points.shape == (41, 41, 3)
            np.testing.assert_allclose(grid.points[20, 20], vertex)
            np.testing.assert_allclose(grid.u, np.linspace(-20, 20, 41))
        radii = np.linalg.norm(sphere.points - centre, axis=-1)
        np.testing.assert_allclose(radii, radii[20, 20])
        # Along the axes of the map arc lengths are kept.
        angle = np.arccos(np.clip((sphere.points[20] - centre) @ outward / radii[20], -1, 1))
        np.testing.assert_allclose(angle * radii[20, 20], abs(sphere.u), atol=1e-4)
        np.testing.assert_allclose((plane.points - vertex)[:, 20] @ outward, plane.v, atol=1e-9)
        np.testing.assert_allclose((plane.points - vertex)[20] @ outward, 0, atol=1e-9)
        # Both start towards the first neighbour.
        neighbour = rough.edges[(rough.edges == 7).any(axis=1)][0].sum() - 7
        step = rough.vertices[neighbour] - vertex
        along = plane.points[20, 40] - vertex
        assert abs(np.cross(outward, along) @ step) < 1e-8
        assert along @ step > 0

    def test_has_nan_where_triangles_have_no_area(self, rough):
        triangle = rough.triangles[(rough.triangles == 7).any(axis=1)][0]
        b, c = rough.vertices[triangle[triangle != 7]]
        points = [rough.vertices[7], (b + c) / 2, b]
        energies = analysis.landscape(rough, BendingForce(rough, 50), 7, points)
        assert np.isnan(energies).tolist() == [False, False, True] or np.isnan(
            energies
        ).tolist() == [False, True, True]

    @pytest.mark.parametrize(
        ("call", "culprit"),
        [
            (lambda m, f: analysis.landscape(m, f, 162, [[0, 0, 0]]), "vertex needs .* 0 to 161"),
            (lambda m, f: analysis.landscape(m, f, 0, [[0, 0]]), "^landscape: points need shape"),
            (lambda m, f: analysis.landscape(m, f, 0, [[0, 0, np.nan]]), "not finite"),
            (
                lambda m, f: analysis.landscape(m, {}, 0, [[0, 0, 0]]),
                "^landscape: forces need 1 to 32",
            ),
            (lambda m, f: analysis.sphere_grid(m, 0, -1), "half_width"),
            (lambda m, f: analysis.sphere_grid(m, 0, np.inf), "half_width"),
            (lambda m, f: analysis.plane_grid(m, 0, size=1), "plane_grid: size"),
            (lambda m, f: analysis.plane_grid(m, 0, size=np.nan), "plane_grid: size .*nan"),
            (lambda m, f: analysis.sphere_grid(m, 1.5), r"sphere_grid: vertex .*1\.5"),
            (lambda m, f: analysis.sphere_grid(m, -1), "sphere_grid: vertex .*-1"),
            (lambda m, f: analysis.plane_grid(m, np.nan), "plane_grid: vertex .*nan"),
            (lambda m, f: analysis.landscape(m, f, 0.5, [[0, 0, 0]]), r"landscape: vertex .*0\.5"),
        ],
    )
    def test_bad_input_is_named(self, rough, call, culprit):
        with pytest.raises(ValueError, match=culprit):
            call(rough, BendingForce(rough, 50))

    def test_errors_of_the_force_are_not_swallowed(self, rough):
        force = BendingForce(Mesh.icosphere(5, 100), 50)
        with pytest.raises(openmm.OpenMMException, match="refers to index 162"):
            analysis.landscape(rough, force, 0, rough.vertices[:1])


class TestLifetime:
    def simulation(self, step_size):
        vesicle = Vesicle(Mesh.random_sphere(162, 400, seed=1))
        simulation = vesicle.simulation(openmm.VerletIntegrator(step_size), "Reference")
        simulation.minimizeEnergy(tolerance=0.1)
        simulation.context.setVelocitiesToTemperature(300, 1)
        return simulation

    def test_of_a_sound_run(self):
        simulation = self.simulation(0.05)
        found = analysis.time_to_failure(simulation, 20.02 * unit.picosecond)
        assert found == (pytest.approx(20.05), 401, False, "")
        assert simulation.currentStep == 401

    def test_of_runs_with_too_long_steps(self):
        times = []
        for step_size in (20, 60):
            found = analysis.time_to_failure(self.simulation(step_size), 1e5, interval=1000)
            assert found.failed
            assert found.reason
            assert found.time == found.steps * step_size
            times.append(found.time)
        assert max(times) < 1e5

    def test_errors_are_dated_to_the_step(self):
        """Whether the run is looked at every step or every 1000, an error has its own time."""
        often, seldom = (
            analysis.time_to_failure(self.simulation(60), 1e5, interval, 1e300)
            for interval in (1, 1000)
        )
        assert often.failed
        assert abs(often.steps - seldom.steps) <= 1

    def test_of_heat_and_checks(self):
        hot = self.simulation(0.05)

        def heat(positions):
            hot.context.setVelocitiesToTemperature(30_000, 2)

        found = analysis.time_to_failure(hot, 100, interval=10, check=heat)
        assert found.failed
        assert found.steps == 10
        assert "kinetic energy" in found.reason
        start = self.simulation(0.05)
        before = start.context.getState(getPositions=True).getPositions(asNumpy=True)._value
        checked = analysis.time_to_failure(
            start, 100, 7, check=lambda x: (x != before).any() and "it has moved"
        )
        assert checked == (pytest.approx(0.35), 7, True, "it has moved")
        with pytest.raises(ValueError, match="before its first step: it has moved"):
            analysis.time_to_failure(start, 100, 7, check=lambda x: "it has moved")

    def test_bad_input_is_named(self):
        simulation = self.simulation(0.05)
        for arguments, culprit in (
            ((0,), "max_time"),
            ((np.inf,), "max_time"),
            ((1, 0), "interval"),
            ((1, np.nan), "interval"),
            ((1, 1, 0.5), "max_heating"),
            ((1, 1, np.nan), "max_heating"),
        ):
            with pytest.raises(ValueError, match=f"time_to_failure: {culprit}"):
                analysis.time_to_failure(simulation, *arguments)

    @pytest.mark.parametrize(
        ("integrator", "culprit"),
        [
            (openmm.VariableVerletIntegrator(1e-3), "those of VariableVerletIntegrator vary"),
            (openmm.VariableLangevinIntegrator(300, 1, 1e-3), "VariableLangevinIntegrator vary"),
            (openmm.VerletIntegrator(0), r"step size of VerletIntegrator is 0\.0 ps"),
        ],
    )
    def test_needs_time_steps_of_one_length(self, integrator, culprit):
        simulation = Vesicle(Mesh.icosphere(2, 400)).simulation(integrator, "Reference")
        with pytest.raises(ValueError, match=culprit):
            analysis.time_to_failure(simulation, 1)
