"""Files of runs in the programs that they are for: GSD, extended XYZ, XTC with PSF, STL."""

import numpy as np
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich import analysis
from openmmhelfrich.viewer import sources
from run_files import fluid_and_solid, invoke
from vtkhdf_files import read

pytest.importorskip("mdtraj", reason="MDTraj is not installed")

FRAMES = 11
TOML = fluid_and_solid(duration=16, interval=1.6, frames="ply", platform="Helfrich")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A fluid vesicle and one that keeps its neighbours."""
    folder = tmp_path_factory.mktemp("files")
    (folder / "run.toml").write_text(TOML.replace("[output]", '[output]\ntext = ["psf"]'))
    result = invoke("run", folder / "run.toml", "--out", folder / "out")
    assert result.exit_code == 0, result.output
    return folder / "out"


@pytest.fixture(scope="module")
def meshes(run):
    """Both surfaces of each frame as one, of the PLY files: double precision."""
    found = []
    for number in range(FRAMES):
        one, two = (
            helfrich.Mesh.read(run / f"frames/run_{label}_{number:06d}.ply")
            for label in ("fluid", "solid")
        )
        triangles = np.vstack([one.triangles, two.triangles + one.num_vertices])
        found.append(helfrich.Mesh(np.vstack([one.vertices, two.vertices]), triangles))
    assert not np.array_equal(found[0].triangles, found[-1].triangles)
    return found


def arrays(meshes):
    """Vertices and triangles of all frames."""
    return np.array([m.vertices for m in meshes]), np.array([m.triangles for m in meshes])


def pairs(bonds):
    """Bonds whatever their order."""
    return {tuple(sorted(pair)) for pair in np.asarray(bonds).tolist()}


def periodic_meshes():
    """A sheet that spans its box and a ball that crosses its faces; the box changes."""
    random = np.random.default_rng(4)
    sheet = helfrich.Mesh.sheet(8, 7, 10.0, periodic=True)
    ball = helfrich.Mesh.icosphere(2, 15.0).translated((70, 55, 75))
    triangles = np.vstack([sheet.triangles, ball.triangles + sheet.num_vertices])
    found = []
    for factor in (1, 1.02, 0.97):
        vertices = np.vstack([sheet.vertices, ball.vertices]) * factor
        vertices += random.normal(0, 0.5, vertices.shape)
        vertices[3] += 2 * factor * sheet.box[1]
        found.append(helfrich.Mesh(vertices, triangles, factor * sheet.box))
    return found


class TestGSD:
    @pytest.fixture(autouse=True)
    def needed(self):
        pytest.importorskip("gsd.hoomd", reason="gsd is not installed")

    def test_its_own_package_finds_what_was_written(self, meshes, tmp_path):
        import gsd.hoomd

        masses = np.linspace(1, 7, 224)
        domains = np.arange(FRAMES * 224).reshape(FRAMES, 224) % 3
        path = tmp_path / "a.gsd"
        times, steps = 0.25 * np.arange(FRAMES), 7 * np.arange(FRAMES)
        vertices, triangles = arrays(meshes)
        count = analysis.write_gsd(
            path, vertices, triangles, times, steps, types=domains, masses=masses
        )
        assert count == FRAMES
        with gsd.hoomd.open(str(path)) as file:
            assert len(file) == FRAMES
            for number, (frame, mesh) in enumerate(zip(file, meshes, strict=True)):
                frame.validate()
                assert frame.configuration.step == 7 * number
                assert frame.log["time"].tolist() == [0.25 * number]
                np.testing.assert_allclose(frame.particles.position, mesh.vertices, rtol=1e-6)
                assert not frame.particles.image.any()
                half = np.array(frame.configuration.box[:3]) / 2
                assert (np.abs(frame.particles.position) < half).all()
                assert frame.particles.types == ["V0", "V1", "V2"]
                assert np.array_equal(frame.particles.typeid, domains[number])
                assert frame.particles.mass == pytest.approx(masses)
                assert frame.bonds.types == ["edge"]
                assert len(frame.bonds.group) == len(mesh.edges)
                assert pairs(frame.bonds.group) == pairs(mesh.edges)
                assert np.array_equal(frame.log["triangles"], mesh.triangles)
                curvature = analysis.mean_curvature(mesh, mesh)
                found = frame.log["particles/mean_curvature"]
                np.testing.assert_allclose(found, curvature, rtol=1e-5, atol=1e-8)
                assert frame.log["particles/area"].sum() == pytest.approx(mesh.area, rel=1e-6)
                assert np.array_equal(frame.log["particles/neighbours"], mesh.degrees)

    def test_it_comes_back(self, meshes, tmp_path):
        """Frames out of one another's order of triangles, among them that of the first again."""
        order = [0, 5, 0, 10]
        vertices, triangles = arrays([meshes[number] for number in order])
        analysis.write_gsd(tmp_path / "a.gsd", vertices, triangles)
        found = analysis.read_gsd(tmp_path / "a.gsd")
        assert [frame.step for frame in found] == [0, 1, 2, 3]
        for frame, number in zip(found, order, strict=True):
            assert frame.box is None
            np.testing.assert_allclose(frame.vertices, meshes[number].vertices, rtol=1e-6)
            assert np.array_equal(frame.triangles, meshes[number].triangles)
            assert pairs(frame.bonds) == pairs(meshes[number].edges)
            # The number of the vesicle.
            assert frame.types.tolist() == [0] * 132 + [1] * 92
            assert frame.masses.tolist() == [1] * 224

    def test_a_periodic_box(self, tmp_path):
        import gsd.hoomd

        made = periodic_meshes()
        vertices, triangles = arrays(made)
        boxes = np.array([mesh.box for mesh in made])
        path = tmp_path / "a.gsd"
        analysis.write_gsd(path, vertices, triangles, box=boxes)
        for frame, mesh in zip(analysis.read_gsd(path), made, strict=True):
            np.testing.assert_allclose(frame.box, mesh.box, rtol=1e-6, atol=1e-6)
            np.testing.assert_allclose(frame.vertices, mesh.vertices, rtol=0, atol=3e-5)
        with gsd.hoomd.open(str(path)) as file:
            for frame, mesh in zip(file, made, strict=True):
                assert frame.particles.image.any()
                inside = np.linalg.solve(mesh.box.T, frame.particles.position.T)
                assert np.abs(inside).max() <= 0.5 + 1e-6
                np.testing.assert_allclose(
                    frame.log["particles/mean_curvature"],
                    analysis.mean_curvature(mesh, mesh),
                    rtol=1e-5,
                    atol=1e-7,
                )

    def test_a_file_of_another_program_has_no_triangles(self, tmp_path):
        import gsd.hoomd

        frame = gsd.hoomd.Frame()
        frame.particles.N = 2
        frame.particles.position = [[0, 0, 0], [1, 2, 3]]
        frame.particles.image = [[0, 0, 0], [1, 0, -1]]
        frame.bonds.N, frame.bonds.group = 1, [[0, 1]]
        frame.configuration.box = [10, 11, 12, 0.5, 0, 0]
        with gsd.hoomd.open(str(tmp_path / "a.gsd"), "w") as file:
            file.append(frame)
        (found,) = analysis.read_gsd(tmp_path / "a.gsd")
        assert found.triangles is None and found.time is None
        assert found.bonds.tolist() == [[0, 1]]
        assert found.vertices.tolist() == [[0, 0, 0], [11, 2, -9]]
        assert found.box.tolist() == [[10, 0, 0], [5.5, 11, 0], [0, 0, 12]]
        trajectory = analysis.Trajectory(tmp_path / "a.gsd")
        assert trajectory.triangles() is None and not trajectory.timed
        assert trajectory.boxes().tolist() == [found.box.tolist()]
        with pytest.raises(ValueError, match=r"a.gsd has no times; HOOMD writes steps only"):
            trajectory.times()
        with gsd.hoomd.open(str(tmp_path / "a.gsd"), "r+") as file:
            frame.particles.N = 3
            frame.particles.position = frame.particles.image = np.zeros((3, 3))
            file.append(frame)
        with pytest.raises(ValueError, match=r"a.gsd has frames of 2 and of 3 particles"):
            trajectory.read()

    @pytest.mark.parametrize("options", [["--format", "gsd"], ["OUTPUT"]])
    def test_the_command_line(self, run, meshes, tmp_path, options):
        path = tmp_path / "a.gsd" if options == ["OUTPUT"] else run / "run.gsd"
        words = [path] if options == ["OUTPUT"] else options
        result = invoke("frames", run, *words, "--skip", 1, "--stride", 3)
        assert result.exit_code == 0, result.output
        assert result.output.endswith(f"{path.name}: 4 frames of 224 vertices\n")
        found = analysis.read_gsd(path)
        assert [frame.step for frame in found] == [4, 16, 28, 40]
        for frame, mesh in zip(found, meshes[1::3], strict=True):
            np.testing.assert_allclose(frame.vertices, mesh.vertices, rtol=0, atol=1e-3)
            assert np.array_equal(frame.triangles, mesh.triangles)

    def test_a_trajectory_has_its_triangles(self, meshes, tmp_path):
        path = tmp_path / "a.gsd"
        vertices, triangles = arrays(meshes)
        times, steps = 0.25 * np.arange(FRAMES), 7 * np.arange(FRAMES)
        analysis.write_gsd(path, vertices, triangles, times, steps)
        part = analysis.Trajectory(path, range(132), start=1, stop=9, stride=3)
        np.testing.assert_allclose(part.read(), vertices[1:9:3, :132], rtol=1e-6)
        assert part.times().tolist() == [0.25, 1, 1.75]
        assert part.steps().tolist() == [7, 28, 49]
        assert part.boxes() is None
        assert np.array_equal(part.triangles(), triangles[1:9:3, :260])
        whole = analysis.Trajectory(path)
        found = analysis.shape(whole, whole.triangles()).area
        np.testing.assert_allclose(found, analysis.shape(vertices, triangles).area, rtol=1e-6)
        with pytest.raises(ValueError, match="bonds flipped in"):
            analysis.shape(path, triangles[0])

    def test_it_becomes_other_files(self, run, meshes, tmp_path):
        """VTKHDF, the spectrum and the page of a GSD file are those of the run."""
        h5py = pytest.importorskip("h5py", reason="h5py is not installed")
        path = tmp_path / "a.gsd"
        for words in (
            ("frames", run, path),
            ("frames", path),
            ("frames", run, tmp_path / "b.vtkhdf"),
        ):
            result = invoke(*words)
            assert result.exit_code == 0, result.output
        with h5py.File(tmp_path / "a.vtkhdf") as one, h5py.File(tmp_path / "b.vtkhdf") as two:
            for name in ("VTKHDF/Polygons/Connectivity", "VTKHDF/Steps/Values"):
                assert np.array_equal(one[name], two[name])
            assert np.array_equal(one["openmm-helfrich/step"], two["openmm-helfrich/step"])
            np.testing.assert_allclose(one["VTKHDF/Points"], two["VTKHDF/Points"], rtol=1e-6)
        words = ("--membrane", 0, "--lmax", 4)
        spectra = [invoke("spectrum", source, *words) for source in (path, run / "run.xtc")]
        assert spectra[0].exit_code == 0, spectra[0].output
        rows = [
            np.array([line.split()[:2] for line in found.output.splitlines()[2:]], dtype=float)
            for found in spectra
        ]
        np.testing.assert_allclose(*rows, rtol=1e-4)
        scene = sources.scene_of(path)
        assert [frame.step for frame in scene.frames] == [4 * number for number in range(FRAMES)]

    def test_a_surface_that_spans_its_box_becomes_vtkhdf(self, tmp_path):
        pytest.importorskip("h5py", reason="h5py is not installed")
        made = periodic_meshes()
        vertices, triangles = arrays(made)
        boxes = np.array([mesh.box for mesh in made])
        analysis.write_gsd(tmp_path / "a.gsd", vertices, triangles, box=boxes)
        analysis.write_vtkhdf(tmp_path / "a.vtkhdf", tmp_path / "a.gsd")
        for step, mesh in zip(read(tmp_path / "a.vtkhdf"), made, strict=True):
            points, corners = mesh.unfolded()
            assert np.array_equal(step.triangles, corners)
            np.testing.assert_allclose(step.points, points, rtol=0, atol=1e-4)

    def test_masses_and_times_may_have_units(self, meshes, tmp_path):
        path = tmp_path / "a.gsd"
        times = unit.Quantity(0.5 * np.arange(FRAMES), unit.nanosecond)
        masses = unit.Quantity(np.linspace(1, 2, 224), unit.kilogram / unit.mole)
        analysis.write_gsd(path, *arrays(meshes), times, masses=masses)
        read_back = analysis.read_gsd(path)
        assert [frame.time for frame in read_back] == [500.0 * n for n in range(FRAMES)]
        assert read_back[3].masses == pytest.approx(1000 * np.linspace(1, 2, 224), rel=1e-6)

    def test_mistakes_leave_what_was_there(self, meshes, tmp_path):
        path = tmp_path / "a.gsd"
        path.write_bytes(b"mine")
        vertices, triangles = arrays(meshes)
        for given, culprit in (
            ({"masses": np.ones(3)}, "masses: there are 3, but 224 vertices"),
            ({"masses": -1.0}, "masses: need one number"),
            ({"types": np.zeros(3, int)}, "types: there are 3, but 224 vertices"),
            ({"types": np.zeros((2, 224), int)}, "types: there are those of 2 frames, but more"),
            ({"types": np.zeros(224)}, "types: need whole numbers from 0"),
            ({"times": np.zeros(FRAMES)}, "write_gsd: the times of the frames do not ascend"),
            ({"times": np.full(FRAMES, np.nan)}, "write_gsd: the times of the frames do not as"),
            ({"steps": np.arange(FRAMES) - 1}, "write_gsd: steps needs a whole number .*got -1"),
            ({"steps": np.arange(FRAMES) + 0.5}, r"write_gsd: steps needs .*got 0\.5"),
            ({"times": np.arange(FRAMES) * unit.nanometer}, "write_gsd: times needs the unit pico"),
            ({"times": ["noon"] * FRAMES}, "write_gsd: times needs numbers"),
            ({"masses": 1 * unit.nanometer}, "write_gsd: masses needs the unit dalton"),
            ({"masses": "heavy"}, "write_gsd: masses needs numbers, .*got 'heavy'"),
        ):
            with pytest.raises((TypeError, ValueError), match=culprit):
                analysis.write_gsd(path, vertices, triangles, **given)
            assert path.read_bytes() == b"mine"
            assert [found.name for found in tmp_path.iterdir()] == ["a.gsd"]
        with pytest.raises(
            ValueError, match=rf"write_gsd: {tmp_path}/a.h5: the suffix must be .gsd"
        ):
            analysis.write_gsd(tmp_path / "a.h5", vertices, triangles)
        with pytest.raises(ValueError, match=rf"{path} is no GSD file of particles, or is damaged"):
            analysis.read_gsd(path)
        with pytest.raises(FileNotFoundError, match=rf"there is no file {tmp_path}/b.gsd"):
            analysis.read_gsd(tmp_path / "b.gsd")
        with pytest.raises(FileNotFoundError, match="see whether its folder is there") as error:
            analysis.write_gsd(tmp_path / "none" / "a.gsd", vertices, triangles)
        assert error.value.filename == str(tmp_path / "none" / "a.gsd")

    def test_ovito(self, meshes, tmp_path):
        """One after another, and back, with the bonds and values of each."""
        ovito = pytest.importorskip("ovito.io", reason="OVITO is not installed")
        analysis.write_gsd(tmp_path / "a.gsd", *arrays(meshes))
        pipeline = ovito.import_file(str(tmp_path / "a.gsd"))
        assert pipeline.source.num_frames == FRAMES
        for number in (0, 7, 3, 10):
            particles, mesh = pipeline.compute(number).particles, meshes[number]
            np.testing.assert_allclose(particles.positions, mesh.vertices, rtol=1e-6)
            assert pairs(particles.bonds.topology) == pairs(mesh.edges)
            curvature = analysis.mean_curvature(mesh, mesh)
            np.testing.assert_allclose(particles["mean_curvature"], curvature, rtol=1e-5)
            assert np.array_equal(particles["neighbours"], mesh.degrees)


class TestExtendedXYZ:
    def test_ase(self, meshes, tmp_path):
        ase = pytest.importorskip("ase.io", reason="ASE is not installed")
        path = tmp_path / "a.xyz"
        times, steps = 0.25 * np.arange(FRAMES), 7 * np.arange(FRAMES)
        domains = np.arange(224) % 3
        given = (path, *arrays(meshes), times, steps)
        assert analysis.write_extended_xyz(*given, types=domains) == FRAMES
        found = ase.read(path, ":", format="extxyz")
        assert len(found) == FRAMES
        for number, (atoms, mesh) in enumerate(zip(found, meshes, strict=True)):
            assert (atoms.info["time"], atoms.info["step"]) == (0.25 * number, 7 * number)
            assert atoms.info["unit"] == "nm"
            assert not atoms.pbc.any()
            np.testing.assert_allclose(atoms.positions, mesh.vertices, rtol=1e-8)
            curvature = analysis.mean_curvature(mesh, mesh)
            np.testing.assert_allclose(atoms.arrays["mean_curvature"], curvature, rtol=1e-8)
            assert atoms.arrays["area"].sum() == pytest.approx(mesh.area, rel=1e-8)
            assert np.array_equal(atoms.arrays["neighbours"], mesh.degrees)
            assert atoms.arrays["component"].tolist() == [0] * 132 + [1] * 92
            assert np.array_equal(atoms.arrays["kind"], domains)

    def test_a_periodic_box_in_ase(self, tmp_path):
        ase = pytest.importorskip("ase.io", reason="ASE is not installed")
        made = periodic_meshes()
        boxes = np.array([mesh.box for mesh in made])
        analysis.write_extended_xyz(tmp_path / "a.extxyz", *arrays(made), box=boxes)
        for atoms, mesh in zip(ase.read(tmp_path / "a.extxyz", ":"), made, strict=True):
            assert atoms.pbc.all()
            np.testing.assert_allclose(atoms.cell[:], mesh.box, rtol=1e-8)
            np.testing.assert_allclose(atoms.positions, mesh.vertices, rtol=1e-8)
            curvature = analysis.mean_curvature(mesh, mesh)
            np.testing.assert_allclose(atoms.arrays["mean_curvature"], curvature, rtol=1e-7)

    def test_ovito_after_the_command_line(self, run, meshes, tmp_path):
        ovito = pytest.importorskip("ovito.io", reason="OVITO is not installed")
        path = tmp_path / "a.xyz"
        result = invoke("frames", run, path)
        assert result.exit_code == 0, result.output
        pipeline = ovito.import_file(str(path))
        assert pipeline.source.num_frames == FRAMES
        trajectory = analysis.Trajectory(run / "run.xtc")
        curvature = analysis.mean_curvature(trajectory, trajectory.triangles())
        for number in (0, 10, 4):
            data, mesh = pipeline.compute(number), meshes[number]
            particles = data.particles
            np.testing.assert_allclose(particles.positions, mesh.vertices, rtol=0, atol=1e-3)
            assert data.attributes["time"] == pytest.approx(1.6 * number, rel=1e-6)
            assert data.attributes["step"] == 4 * number
            np.testing.assert_allclose(particles["mean_curvature"], curvature[number], rtol=1e-8)
            assert np.array_equal(particles["neighbours"], mesh.degrees)
            assert np.array(particles["kind"]).tolist() == [0] * 132 + [1] * 92

    def test_mistakes_are_one_line(self, run, meshes, tmp_path):
        for words, culprit in (
            ((run, tmp_path / "a.vtkhdf", "--format", "xyz"), "the suffix must be .xyz or .extxyz"),
            ((run, tmp_path / "none" / "a.xyz"), "see whether its folder is there"),
        ):
            result = invoke("frames", *words)
            assert result.exit_code != 0
            assert culprit in result.output
            assert "Traceback" not in result.output
        (tmp_path / "a.xyz").write_bytes(b"mine")
        vertices, triangles = arrays(meshes)
        with pytest.raises(ValueError, match="there are those of 10 frames"):
            analysis.write_extended_xyz(tmp_path / "a.xyz", vertices, triangles[1:])
        assert (tmp_path / "a.xyz").read_bytes() == b"mine"
        assert [path.name for path in tmp_path.iterdir()] == ["a.xyz"]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_mdanalysis_reads_xtc_with_psf(run, meshes):
    """Positions of every frame; bonds are those of the start, as PSF has one topology."""
    mda = pytest.importorskip("MDAnalysis", reason="MDAnalysis is not installed")
    universe = mda.Universe(str(run / "run.psf"), str(run / "run.xtc"))
    assert len(universe.trajectory) == FRAMES
    assert pairs(universe.bonds.indices) == pairs(meshes[0].edges)
    for moment, mesh in zip(universe.trajectory, meshes, strict=True):
        # MDAnalysis has Å.
        np.testing.assert_allclose(moment.positions / 10, mesh.vertices, rtol=0, atol=1e-3)
        assert moment.time == pytest.approx(1.6 * moment.frame, rel=1e-6)
    assert pairs(meshes[0].edges) != pairs(meshes[-1].edges)
    solid = universe.atoms[132:].bonds.indices
    assert pairs(b for b in solid if min(b) >= 132) == pairs(
        edge for edge in meshes[-1].edges if min(edge) >= 132
    )


def test_mdtraj_reads_xtc_with_psf(run, meshes):
    import mdtraj

    found = mdtraj.load(str(run / "run.xtc"), top=str(run / "run.psf"))
    np.testing.assert_allclose(found.xyz, arrays(meshes)[0], rtol=0, atol=1e-3)
    bonds = [(bond.atom1.index, bond.atom2.index) for bond in found.topology.bonds]
    assert pairs(bonds) == pairs(meshes[0].edges)


class TestSequences:
    """A file for each frame, with its own triangles."""

    @pytest.fixture
    def folder(self, meshes, tmp_path):
        from openmmhelfrich.simulation.frames import MeshFrames

        writer = MeshFrames(tmp_path, "run", "stl", ["m"])
        for number, mesh in enumerate(meshes):
            writer.write(number, 0, 0.0, [(mesh.vertices, mesh.triangles)])
        return tmp_path

    @pytest.mark.parametrize("kind", ["ply", "obj", "stl", "vtk"])
    def test_the_command_line(self, run, meshes, tmp_path, kind):
        """Surfaces of an XTC file, in place of those of a longer run."""
        for words in ((), ("--skip", 2, "--stride", 4, "--force")):
            result = invoke("frames", run, tmp_path / "a", "--format", kind, *words)
            assert result.exit_code == 0, result.output
        assert result.output.endswith("a: 3 frames of 224 vertices\n")
        names = [f"run_surface_{number:06d}.{kind}" for number in range(3)]
        assert sorted(path.name for path in (tmp_path / "a").iterdir()) == names
        for name, mesh in zip(names, meshes[2::4], strict=True):
            found = helfrich.Mesh.read(tmp_path / "a" / name)
            corners = found.vertices[found.triangles]
            np.testing.assert_allclose(corners, mesh.vertices[mesh.triangles], rtol=0, atol=1e-3)
        result = invoke("frames", run, tmp_path / "a" / names[0], "--format", kind, "--force")
        assert result.exit_code == 1
        assert "is no folder; give the name of a folder" in result.output
        result = invoke("frames", run, tmp_path / "a", "--format", "gsd", "--force")
        assert "a is no file; give the name of a file" in result.output

    def test_trimesh(self, folder, meshes):
        import trimesh

        for number, mesh in enumerate(meshes):
            found = trimesh.load_mesh(folder / f"run_m_{number:06d}.stl")
            np.testing.assert_allclose(found.triangles, mesh.vertices[mesh.triangles], rtol=1e-6)

    def test_ovito(self, folder, meshes):
        ovito = pytest.importorskip("ovito.io", reason="OVITO is not installed")
        pipeline = ovito.import_file(str(folder / "run_m_0*.stl"))
        assert pipeline.source.num_frames == FRAMES
        for number in (0, 10, 4):
            data, mesh = pipeline.compute(number), meshes[number]
            (surface,) = (o for o in data.objects if type(o).__name__ == "TriangleMesh")
            corners = surface.get_vertices()[surface.get_faces()]
            np.testing.assert_allclose(corners, mesh.vertices[mesh.triangles], rtol=1e-5)
