"""Meshes in a periodic box: nearest images, what keeps the box, what is refused, files."""

import copy
import pickle

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich import analysis
from openmmhelfrich.mesh import Mesh, MeshError

TRICLINIC = np.array([[9.0, 0, 0], [3.5, 8.0, 0], [-3.0, 3.0, 10.0]])


def jittered(mesh, seed=3, share=0.05):
    jump = share * np.random.default_rng(seed).normal(size=mesh.vertices.shape)
    return Mesh(mesh.vertices + jump, mesh.triangles, mesh.box)


def scattered(mesh, seed=1):
    """The mesh with each vertex in another image of the box."""
    images = np.random.default_rng(seed).integers(-3, 4, mesh.vertices.shape)
    return Mesh(mesh.vertices + images @ mesh.box, mesh.triangles, mesh.box)


def ball():
    """A lumpy sphere in a triclinic box."""
    sphere = jittered(Mesh.icosphere(4, 3.0))
    return Mesh(sphere.vertices, sphere.triangles, TRICLINIC)


MESHES = {
    "ball": ball,
    "sheet": lambda: jittered(Mesh.sheet(7, 5, 1.0, periodic=True)),
    "tube": lambda: jittered(Mesh.tube(9, 8, 2.0, 9.0, periodic=True)),
    "P": lambda: jittered(Mesh.schwarz_p(3, 20.0)),
}


@pytest.mark.parametrize("make", MESHES.values(), ids=MESHES.keys())
class TestImages:
    def test_geometry_is_that_of_nearest_images(self, make):
        mesh, other = make(), scattered(make())
        assert np.array_equal(mesh.triangles, other.triangles)
        assert other.area == pytest.approx(mesh.area, rel=1e-12)
        for measure in (
            analysis.triangle_areas,
            analysis.triangle_heights,
            analysis.edge_lengths,
            analysis.mean_curvature,
        ):
            np.testing.assert_allclose(measure(other, other), measure(mesh, mesh), rtol=1e-7)
            np.testing.assert_allclose(
                measure(other.vertices, other.triangles, box=other.box),
                measure(mesh, mesh),
                rtol=1e-7,
            )
        assert len(analysis.crossings(other)) == 0

    def test_unfolded_is_whole(self, make):
        mesh = scattered(make())
        vertices, triangles = mesh.unfolded()
        assert len(np.unique(triangles)) == len(vertices)
        sides = vertices[triangles] - np.roll(vertices[triangles], 1, axis=1)
        longest = analysis.edge_lengths(mesh, mesh).max()
        assert np.linalg.norm(sides, axis=-1).max() == pytest.approx(longest, rel=1e-12)
        areas = analysis.triangle_areas(vertices, triangles)
        np.testing.assert_allclose(areas, analysis.triangle_areas(mesh, mesh), rtol=1e-9)

    def test_core_and_numpy_agree(self, make):
        mesh = scattered(make())
        found = analysis.vertex_quantities(mesh, mesh)
        bending = 7 / 2 * (found.julicher**2 / found.barycentric_area).sum()
        assert mesh.energy(helfrich.BendingForce(mesh, 7.0)) == pytest.approx(bending, rel=1e-10)

    def test_box_is_kept(self, make):
        mesh = make()
        again = Mesh(mesh.vertices, mesh.triangles, mesh.box * unit.nanometer)
        for same in (again, pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
            assert same == mesh
            assert np.array_equal(same.box, mesh.box)
        moved = mesh.translated((1, 2, 3))
        assert np.array_equal(moved.box, mesh.box)
        assert moved.area == pytest.approx(mesh.area, rel=1e-12)
        assert "box=[[" in repr(mesh)
        with pytest.raises(ValueError, match="read-only"):
            mesh.box[0, 0] = 1

    def test_scaling(self, make):
        mesh = scattered(make())
        assert mesh.scaled(2.0).area == pytest.approx(4 * mesh.area, rel=1e-12)
        stretched = mesh.scaled((1.1, 0.95, 1.02))
        (a, _, _), (bx, by, _), (cx, cy, cz) = mesh.box
        expected = [[1.1 * a, 0, 0], [1.1 * bx, 0.95 * by, 0], [1.1 * cx, 0.95 * cy, 1.02 * cz]]
        np.testing.assert_allclose(stretched.box, expected, rtol=1e-15)
        mirrored = mesh.scaled((1, -1, 1))
        assert mirrored.area == pytest.approx(mesh.area, rel=1e-12)
        assert (np.diag(mirrored.box) > 0).all()

    def test_ply_has_the_box(self, make, tmp_path):
        mesh = make()
        for binary in (False, True):
            mesh.write(tmp_path / "mesh.ply", binary=binary)
            assert Mesh.read(tmp_path / "mesh.ply") == mesh
        for extension in ("obj", "stl", "off", "vtk", "vtu", "msh"):
            with pytest.raises(MeshError, match=r"has no room for the periodic box.*unfolded"):
                mesh.write(tmp_path / f"mesh.{extension}")

    def test_topology_has_the_box(self, make):
        mesh = make()
        box = mesh.topology().getPeriodicBoxVectors().value_in_unit(unit.nanometer)
        np.testing.assert_allclose(np.array(box), mesh.box)


def test_volume_of_what_does_not_span():
    whole, parts = ball(), scattered(ball())
    assert parts.volume == pytest.approx(Mesh(whole.vertices, whole.triangles).volume, rel=1e-12)
    assert parts.reduced_volume == pytest.approx(whole.reduced_volume, rel=1e-12)
    turned = Mesh(parts.vertices, parts.triangles[:, ::-1], parts.box)
    assert turned.volume == pytest.approx(parts.volume)
    for name in ("sheet", "tube", "P"):
        with pytest.raises(MeshError, match="with vertex 0 spans its periodic box"):
            _ = MESHES[name]().volume


def test_a_vesicle_across_the_faces_of_its_box():
    whole, parts = ball(), scattered(ball())
    simulation = helfrich.Vesicle(parts, softness=0.1).simulation(openmm.VerletIntegrator(0.001))
    alone = helfrich.Vesicle(Mesh(whole.vertices, whole.triangles), softness=0.1)
    expected = alone.simulation(openmm.VerletIntegrator(0.001))
    energies = [
        each.context.getState(energy=True).getPotentialEnergy()._value
        for each in (simulation, expected)
    ]
    assert energies[0] == pytest.approx(energies[1], rel=1e-9)


def test_a_spanning_part_keeps_the_orientation_of_its_first_triangle():
    mesh = Mesh.sheet(5, 5, 1.0, periodic=True)
    turned = np.array(mesh.triangles)[:, ::-1]
    mixed = np.where((np.arange(50) % 3 == 1)[:, np.newaxis], turned[:, ::-1], turned)
    corners = Mesh(mesh.vertices, mixed, mesh.box).corner_positions
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] < 0).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: m.rotated(np.eye(3)), "Mesh.rotated: the mesh has a periodic box"),
        (lambda m: m.deformed(2, 0, 0.1), "Mesh.deformed: the mesh has a periodic box"),
        (lambda m: m.oblate(0.5), "Mesh.oblate: the mesh has a periodic box"),
        (lambda m: Mesh(m.vertices, m.triangles, np.eye(2)), r"Mesh: box must be three vectors"),
        (lambda m: Mesh(m.vertices, m.triangles, TRICLINIC.T), r"Mesh: box must have the vectors"),
        (lambda m: Mesh(m.vertices, m.triangles, [[4, 0, 0], [3, 4, 0], [0, 0, 4]]), "at most ax"),
        (
            lambda m: Mesh(m.vertices, m.triangles, np.eye(3)),
            r"joined by an edge .* shorter than 0.50",
        ),
    ],
)
def test_refusals(call, message):
    with pytest.raises(MeshError, match=message):
        call(MESHES["sheet"]())


def test_a_context_gives_the_box_back():
    mesh = MESHES["sheet"]()
    system = openmm.System()
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    for _ in range(mesh.num_vertices):
        system.addParticle(1.0)
    bending = helfrich.BendingForce(mesh, 5.0)
    flips = helfrich.MonteCarloBondFlip(mesh, 300)
    system.addForce(bending)
    system.addForce(flips)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001))
    context.setPositions(mesh.vertices)
    for force in (bending, flips):
        assert Mesh.from_context(context, force) == mesh
    bending = helfrich.BendingForce(Mesh.icosphere(2, 1.0), 5.0)
    assert not bending.usesPeriodicBoundaryConditions()


class TestForcesWithoutTheBox:
    @pytest.mark.parametrize("make", [MESHES["ball"], MESHES["sheet"]])
    @pytest.mark.parametrize("plain", [False, True], ids=["force", "of a System"])
    def test_their_energy_is_refused(self, make, plain):
        mesh = make()
        force = helfrich.BendingForce(mesh.triangles, 7.0)
        if plain:
            system = openmm.System()
            system.addForce(force)
            force = system.getForce(0)
        told = r"Mesh\.energy: .*BendingForce\(mesh, …\).*setUsesPeriodicBoundaryConditions"
        with pytest.raises(MeshError, match=told):
            mesh.energy(force)

    def test_others_may_leave_it(self):
        mesh = MESHES["sheet"]()
        force = helfrich.BendingForce(mesh.triangles, 7.0)
        force.setUsesPeriodicBoundaryConditions(True)
        assert mesh.energy(force) == mesh.energy(helfrich.BendingForce(mesh, 7.0))
        outside = openmm.CustomExternalForce("1")
        outside.addParticle(0)
        assert mesh.energy(outside) == 1


def test_positions_that_are_too_far_away_are_named():
    mesh = Mesh.sheet(6, 6, 10.0, periodic=True)
    vertices = mesh.vertices.copy()
    vertices[7, 1] += 3e10 * mesh.box[1, 1]
    told = r"particle 7 is at \(.*e?\d+.*\) nm, .* more than a billion periodic boxes away"
    with pytest.raises(MeshError, match=told):
        Mesh(vertices, mesh.triangles, mesh.box)
    system = openmm.System()
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    for _ in range(mesh.num_vertices):
        system.addParticle(1)
    system.addForce(helfrich.BendingForce(mesh, 1.0))
    platform = openmm.Platform.getPlatformByName("Reference")
    context = openmm.Context(system, openmm.VerletIntegrator(1e-3), platform)
    context.setPositions(vertices)
    with pytest.raises(openmm.OpenMMException, match=f"BendingForce: {told}"):
        context.getState(energy=True)
    # A million boxes are fine.
    context.setPositions(mesh.vertices + 1e6 * mesh.box[1])
    context.getState(energy=True)


def test_what_needs_a_centre_refuses_what_has_none():
    sheet, whole = MESHES["sheet"](), ball()
    frames = np.stack([whole.vertices] * 2)
    for measure in (
        lambda v, t: analysis.solid_angles(v, t),
        lambda v, t: analysis.mode_amplitudes(v, t, lmax=2),
        lambda v, t: analysis.gyration_tensor(v),
        lambda v, t: analysis.density_modes(v, 2),
    ):
        with pytest.raises(ValueError, match="spans its periodic box, and so has no centre"):
            measure(sheet, sheet)
        assert np.isfinite(measure(whole, whole)).all()
    for measure in (analysis.solid_angles, lambda v, t: analysis.mode_amplitudes(v, t, lmax=2)):
        with pytest.raises(ValueError, match=r"pass mesh\.triangles"):
            measure(frames, whole)
        assert np.isfinite(measure(frames, whole.triangles)).all()
