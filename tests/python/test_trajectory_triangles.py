"""Trajectories whose bonds flipped: the triangles beside them, spectra, and their conversion."""

import numpy as np
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich import analysis
from openmmhelfrich.analysis.surface_series import SurfaceSeries
from run_files import fluid_and_solid, invoke
from vtkhdf_files import check_layout, read

pytest.importorskip("mdtraj")

TOML = fluid_and_solid(duration=32, interval=1.6, frames="ply", platform="Helfrich")
FRAMES = 21


def simulate(folder, text):
    path = folder / "run.toml"
    path.write_text(text)
    result = invoke("run", path, "--out", folder / "out")
    assert result.exit_code == 0, result.output
    return folder / "out"


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """A fluid vesicle and one that keeps its neighbours, in one run."""
    return simulate(tmp_path_factory.mktemp("both"), TOML)


@pytest.fixture(scope="module")
def fluid(tmp_path_factory):
    """A fluid vesicle alone."""
    return simulate(tmp_path_factory.mktemp("fluid"), TOML[: TOML.rindex("[[vesicle]]")])


@pytest.fixture(scope="module")
def solid(tmp_path_factory):
    """A run without flips, and without a file of triangles."""
    text = TOML[: TOML.rindex("[[vesicle]]")].replace("flips = 0.05\n", "")
    return simulate(tmp_path_factory.mktemp("solid"), text)


def meshes(out, label):
    """Each frame as its PLY file has it."""
    found = [helfrich.Mesh.read(out / f"frames/run_{label}_{n:06d}.ply") for n in range(FRAMES)]
    return np.array([m.vertices for m in found]), np.array([m.triangles for m in found])


def alone(out, folder):
    """The positions of a run without the files beside them."""
    path = folder / "alone.xtc"
    path.write_bytes((out / "run.xtc").read_bytes())
    return path


def table(result):
    """The means of a spectrum."""
    assert result.exit_code == 0, result.output
    return [float(line.split()[1]) for line in result.output.splitlines()[2:]]


class TestTrajectory:
    def test_names_need_not_be_ascii(self, fluid, tmp_path):
        folder = tmp_path / "zellen ü 細胞"
        folder.mkdir()
        for suffix in (".xtc", ".triangles"):
            (folder / f"läuft{suffix}").write_bytes((fluid / f"run{suffix}").read_bytes())
        found, known = (
            analysis.Trajectory(path) for path in (folder / "läuft.xtc", fluid / "run.xtc")
        )
        assert np.array_equal(found.read(), known.read())
        assert np.array_equal(found.steps(), known.steps())
        assert np.array_equal(found.triangles(), known.triangles())

    def test_has_the_triangles_of_its_frames(self, fluid):
        _, expected = meshes(fluid, "fluid")
        found = analysis.Trajectory(fluid / "run.xtc").triangles()
        assert np.array_equal(found, expected)
        part = analysis.Trajectory(fluid / "run.xtc", start=3, stop=17, stride=4)
        assert np.array_equal(part.triangles(), expected[3:17:4])
        assert part.times() == pytest.approx(1.6 * np.arange(3, 17, 4), rel=1e-6)
        assert part.steps().tolist() == list(range(12, 68, 16))
        assert analysis.Trajectory(fluid / "run.xtc").triangles(260).shape == (FRAMES, 260, 3)

    def test_of_some_particles_they_are_numbered_anew(self, both):
        for label, particles in (("fluid", range(132)), ("solid", range(132, 224))):
            vertices, expected = meshes(both, label)
            trajectory = analysis.Trajectory(both / "run.xtc", particles)
            assert np.array_equal(trajectory.triangles(), expected)
            assert trajectory.read() == pytest.approx(vertices, abs=1e-3)
        with pytest.raises(ValueError, match="only some corners of triangle"):
            analysis.Trajectory(both / "run.xtc", range(100)).triangles()

    def test_without_a_file_there_are_none(self, solid):
        assert analysis.Trajectory(solid / "run.xtc").triangles() is None

    # In frames: cut off within one, a whole one, one too many.
    @pytest.mark.parametrize("length", [FRAMES - 0.5, FRAMES - 1, FRAMES + 1])
    def test_a_file_that_does_not_match_is_refused(self, fluid, tmp_path, length):
        (tmp_path / "run.xtc").write_bytes((fluid / "run.xtc").read_bytes())
        data = 2 * (fluid / "run.triangles").read_bytes()
        (tmp_path / "run.triangles").write_bytes(data[: round(length * 260) * 12])
        trajectory = analysis.Trajectory(tmp_path / "run.xtc")
        for count in (None, 260):
            with pytest.raises(ValueError, match=r"does not match the 21 frames .*--resume"):
                trajectory.triangles(count)

    def test_triangles_of_the_start_are_refused(self, fluid, both):
        """They would give numbers that look right."""
        start = helfrich.Mesh.read(fluid / "frames/run_fluid_000000.ply")
        trajectory = analysis.Trajectory(fluid / "run.xtc")
        for source in (trajectory, fluid / "run.xtc"):
            with pytest.raises(ValueError, match=r"bonds flipped in .*each frame has triangles"):
                analysis.shape(source, start)
        areas = analysis.shape(trajectory, trajectory.triangles()).area
        assert areas == pytest.approx(analysis.shape(*meshes(fluid, "fluid")).area, rel=1e-5)
        wrong = analysis.shape(trajectory.read(), start).area
        assert np.abs(wrong / areas - 1).max() > 1e-4
        # Of the vesicle that keeps its neighbours they are right.
        part = analysis.Trajectory(both / "run.xtc", range(132, 224))
        kept = helfrich.Mesh.read(both / "frames/run_solid_000000.ply")
        expected = analysis.shape(*meshes(both, "solid")).area
        assert analysis.shape(part, kept).area == pytest.approx(expected, rel=1e-5)


class TestSpectrum:
    @pytest.mark.parametrize("quadrature", ["fit", "surface"])
    def test_follows_the_triangles(self, fluid, quadrature):
        words = ("spectrum", fluid / "run.xtc", "--lmax", 4, "--quadrature", quadrature)
        found = table(invoke(*words, "--skip", 5, "--stride", 2))
        vertices, triangles = (array[5::2] for array in meshes(fluid, "fluid"))
        amplitudes = analysis.mode_amplitudes(vertices, triangles, 4, quadrature)
        assert found == pytest.approx(analysis.spectrum(amplitudes).mean[2:], rel=1e-4)
        # Those of the start give other numbers, so that the test can fail.
        wrong = analysis.mode_amplitudes(vertices, triangles[0], 4, quadrature)
        assert analysis.spectrum(wrong).mean[2:] != pytest.approx(found, rel=1e-3)
        # A mesh is not needed, and does not take their place.
        mesh = fluid / "frames/run_fluid_000000.ply"
        assert table(invoke(*words, "--skip", 5, "--stride", 2, "--mesh", mesh)) == found

    def test_of_one_membrane_of_several(self, both):
        for number, label in enumerate(("fluid", "solid")):
            found = table(invoke("spectrum", both / "run.xtc", "--lmax", 3, "--membrane", number))
            amplitudes = analysis.mode_amplitudes(*meshes(both, label), 3)
            assert found == pytest.approx(analysis.spectrum(amplitudes).mean[2:], rel=1e-4)

    def test_of_one_membrane_by_its_mesh(self, both, tmp_path):
        """Without the file of triangles, and with particles of a second membrane."""
        (tmp_path / "run.xtc").write_bytes((both / "run.xtc").read_bytes())
        parts = [
            helfrich.Mesh.read(both / f"frames/run_{n}_000000.ply") for n in ("fluid", "solid")
        ]
        joined = helfrich.Mesh(
            np.concatenate([mesh.vertices for mesh in parts]),
            np.concatenate([parts[0].triangles, parts[1].triangles + 132]),
        )
        joined.write(tmp_path / "both.ply")
        words = ("spectrum", tmp_path / "run.xtc", "--mesh", tmp_path / "both.ply", "--lmax", 3)
        amplitudes = analysis.mode_amplitudes(*meshes(both, "solid"), 3)
        expected = analysis.spectrum(amplitudes).mean[2:]
        assert table(invoke(*words, "--membrane", 1)) == pytest.approx(expected, rel=1e-4)

    def test_mistakes_are_one_line(self, fluid, both, solid, tmp_path):
        (tmp_path / "run.xtc").write_bytes((fluid / "run.xtc").read_bytes())
        (tmp_path / "run.triangles").write_bytes(bytes(120))
        other = tmp_path / "other.ply"
        helfrich.Mesh.random_sphere(92, 300).write(other)
        for words, culprit in (
            ((both / "run.xtc",), "has 2 membranes; choose one with --membrane 0 … 1"),
            ((both / "run.xtc", "--membrane", 2), "has 2, which are counted from 0"),
            ((alone(solid, tmp_path),), "there is neither alone.ply nor alone.triangles beside"),
            ((fluid / "run.xtc", "--mesh", other), "has 132 particles, and"),
            ((tmp_path / "run.xtc",), "does not match the 21 frames"),
            ((tmp_path / "modes.csv", "--membrane", 0), "--membrane is for trajectories"),
        ):
            result = invoke("spectrum", *words)
            assert result.exit_code != 0
            assert culprit in result.output
            assert "Traceback" not in result.output


class TestFrames:
    """The command, and `write_vtkhdf`."""

    @pytest.fixture(autouse=True)
    def needed(self):
        pytest.importorskip("h5py")

    def check(self, path, vertices, triangles, numbers):
        check_layout(path)
        steps = read(path)
        assert [step.time for step in steps] == pytest.approx(1.6 * np.array(numbers), rel=1e-6)
        for step, number in zip(steps, numbers, strict=True):
            assert step.points == pytest.approx(vertices[number], abs=1e-3)
            assert np.array_equal(step.triangles, triangles[number])
        assert SurfaceSeries(path).steps().tolist() == [4 * number for number in numbers]

    def test_a_finished_run(self, fluid, tmp_path):
        result = invoke("frames", fluid, tmp_path / "a.vtkhdf")
        assert result.exit_code == 0, result.output
        assert result.output.endswith("a.vtkhdf: 21 frames of 132 vertices\n")
        self.check(tmp_path / "a.vtkhdf", *meshes(fluid, "fluid"), range(FRAMES))
        assert [path.name for path in tmp_path.iterdir()] == ["a.vtkhdf"]

    def test_two_membranes_or_one_of_them(self, both, tmp_path):
        source, path = both / "run.xtc", tmp_path / "a.vtkhdf"
        assert invoke("frames", source, path, "--skip", 2, "--stride", 3).exit_code == 0
        (one, first), (two, second) = meshes(both, "fluid"), meshes(both, "solid")
        vertices = np.concatenate([one, two], axis=1)
        triangles = np.concatenate([first, second + 132], axis=1)
        self.check(path, vertices, triangles, range(2, FRAMES, 3))
        assert invoke("frames", source, path, "--membrane", 1, "--force").exit_code == 0
        self.check(path, two, second, range(FRAMES))

    @pytest.mark.parametrize("given", [True, False])
    def test_a_run_without_flips_by_its_mesh(self, solid, tmp_path, given):
        words = ["--mesh", solid / "frames/run_fluid_000000.ply"] if given else []
        result = invoke("frames", solid, tmp_path / "a.vtkhdf", *words)
        assert result.exit_code == 0, result.output
        self.check(tmp_path / "a.vtkhdf", *meshes(solid, "fluid"), range(FRAMES))

    def test_a_mesh_beside_it_of_other_particles_is_none(self, solid, tmp_path):
        helfrich.Mesh.icosphere(2, 100.0).write(tmp_path / "alone.ply")
        result = invoke("frames", alone(solid, tmp_path))
        assert result.exit_code != 0
        assert "a trajectory needs --mesh" in result.output

    @pytest.mark.parametrize("command", ["frames", "spectrum", "view"])
    def test_triangles_of_the_start_are_not_those_of_a_fluid(self, fluid, tmp_path, command):
        path = alone(fluid, tmp_path)
        path.with_suffix(".ply").write_bytes((fluid / "run.ply").read_bytes())
        result = invoke(command, path)
        assert result.exit_code != 0
        assert "alone.triangles, which has the triangles of each frame, is gone" in result.output
        # Whoever gives a mesh knows what it is of.
        words = ["--mesh", path.with_suffix(".ply")]
        if command == "frames":
            assert invoke("frames", path, *words).exit_code == 0

    @pytest.mark.parametrize("flips", [0, 0.05])
    @pytest.mark.parametrize("kind", ["vtkhdf", "gsd", "ply"])
    def test_a_surface_that_spans_its_box_stays_whole(self, tmp_path, kind, flips):
        text = (
            "simulation.duration = 4\n"
            'output = { interval = 1, frames = "KIND" }\n'
            "[[vesicle]]\n"
            "mesh = { sheet = [8, 8], spacing = 100, periodic = true }\n"
            "volume_modulus = 0\nsoftness = 0.33\n"
        )
        out = simulate(
            tmp_path, text.replace("KIND", kind) + (f"flips = {flips}\n" if flips else "")
        )
        result = invoke("frames", out, tmp_path / f"again.{kind}", "--format", kind)
        assert result.exit_code == 0, result.output
        if kind == "ply":
            one = helfrich.Mesh.read(out / "frames/run_0_000004.ply")
            two = helfrich.Mesh.read(tmp_path / "again.ply/run_surface_000004.ply")
            assert two.box == pytest.approx(one.box, rel=1e-6)
            assert two.area == pytest.approx(one.area, rel=1e-5)
        elif kind == "gsd":
            pytest.importorskip("gsd")
            one, two = (analysis.read_gsd(p)[-1] for p in (out / "run.gsd", tmp_path / "again.gsd"))
            assert two.box == pytest.approx(one.box, rel=1e-6)
            assert two.vertices == pytest.approx(one.vertices, abs=1e-2)
        else:
            one, two = (read(p)[-1] for p in (out / "run.vtkhdf", tmp_path / "again.vtkhdf"))
            assert two.points == pytest.approx(one.points, abs=1e-2)
            assert np.array_equal(two.triangles, one.triangles)

    def test_arrays(self, fluid, tmp_path):
        """More frames than are added at a time, without times and steps."""
        vertices, triangles = (np.tile(array, (4, 1, 1)) for array in meshes(fluid, "fluid"))
        path = tmp_path / "a.vtkhdf"
        assert analysis.write_vtkhdf(path, vertices, triangles) == 84
        steps = read(path)
        assert [step.time for step in steps] == list(range(84))
        for step, points, corners in zip(steps, vertices, triangles, strict=True):
            assert np.array_equal(step.points, points) and np.array_equal(step.triangles, corners)

    def test_mistakes_are_one_line(self, fluid, solid, tmp_path):
        path = tmp_path / "a.vtkhdf"
        path.write_bytes(b"mine")
        for words, culprit in (
            ((fluid, path), "is there already; overwrite it with --force"),
            ((solid / "frames", "b.vtkhdf"), "has no XTC or GSD files, not one"),
            (
                (alone(solid, tmp_path), tmp_path / "b.vtkhdf"),
                "there is neither alone.ply nor alone.triangles beside it",
            ),
            ((fluid, tmp_path / "b.h5"), "does not end with .vtkhdf, .gsd"),
            ((fluid, tmp_path / "b.ply"), "there is a file for each frame; give --format ply"),
        ):
            result = invoke("frames", *words)
            assert result.exit_code != 0
            assert culprit in result.output
            assert "Traceback" not in result.output
        assert path.read_bytes() == b"mine"

    def test_mistakes_leave_what_was_there(self, fluid, solid, tmp_path):
        path = tmp_path / "a.vtkhdf"
        path.write_bytes(b"mine")
        vertices, triangles = meshes(fluid, "fluid")
        times = np.arange(FRAMES)
        for arguments, culprit in (
            ((vertices,), "need triangles"),
            ((solid / "run.xtc",), "need triangles"),
            ((vertices, triangles[1:]), "there are those of 20 frames"),
            ((vertices, triangles, times[1:]), "there are 20 times, but more frames"),
            ((vertices, triangles, np.arange(30)), "there are 30 times, but 21 frames"),
            ((vertices, triangles, times, times[1:]), "there are 20 steps, but more frames"),
            ((vertices, triangles, times[::-1]), "do not ascend"),
            ((vertices, triangles[:, :, ::2]), "need shape"),
        ):
            with pytest.raises(ValueError, match=culprit):
                analysis.write_vtkhdf(path, *arguments)
            assert path.read_bytes() == b"mine"
            assert [found.name for found in tmp_path.iterdir()] == ["a.vtkhdf"]
