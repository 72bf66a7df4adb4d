"""VTKHDF files: what VTK finds in them, runs and reporters that were killed, and conversion."""

import errno
import os
import signal
import subprocess
import sys

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from flowing import simulation_of
from kills import Killed, killed_at
from openmm import app
from openmmhelfrich import VTKHDFReporter, analysis
from openmmhelfrich._journal import JournaledFile
from openmmhelfrich.analysis.surface_series import SurfaceFrame, SurfaceSeries
from openmmhelfrich.simulation.runner import Run, RunError
from run_files import fluid_and_solid, invoke, killed_after
from vtkhdf_files import check_layout, read

h5py = pytest.importorskip("h5py")

MESH = helfrich.Mesh.random_sphere(132, 400, seed=5)
TOML = fluid_and_solid(duration=16, interval=1.6, frames="vtkhdf", platform="Reference")
#: The last step of such a run.
END = 40


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "run.toml"
    path.write_text(TOML)
    return path


def frames_of(count, mesh=MESH):
    """Frames whose positions always, and triangles sometimes, are other ones than before."""
    random = np.random.default_rng(2)
    triangles, found = mesh.triangles, []
    for number in range(count):
        if number % 3 == 2:
            triangles = random.permutation(triangles)
        vertices = mesh.vertices + random.normal(0, 3, mesh.vertices.shape)
        found.append(SurfaceFrame(7 * number, 0.25 * number, vertices, triangles))
    return found


def same(path, frames):
    """Compare what VTK reads with frames: positions and times exactly, values to their digits."""
    check_layout(path)
    steps = read(path)
    assert len(steps) == len(frames)
    for step, frame in zip(steps, frames, strict=True):
        assert step.time == frame.time
        assert np.array_equal(step.points, frame.vertices)
        assert np.array_equal(step.triangles, frame.triangles)
        curvature = analysis.mean_curvature(frame.vertices, frame.triangles)
        assert step.point_data["mean_curvature"] == pytest.approx(curvature, rel=1e-6)
        degrees = helfrich.Mesh(frame.vertices, frame.triangles).degrees
        assert np.array_equal(step.point_data["neighbours"], degrees)
        areas = analysis.triangle_areas(frame.vertices, frame.triangles)
        assert step.cell_data["area"] == pytest.approx(areas, rel=1e-6)
        assert step.point_data["area"].sum() == pytest.approx(areas.sum(), rel=1e-6)
    assert SurfaceSeries(path).steps().tolist() == [frame.step for frame in frames]


class TestSeries:
    def test_every_frame_has_its_own_triangles(self, tmp_path):
        frames = frames_of(7)
        series = SurfaceSeries(tmp_path / "a.vtkhdf")
        series.add(frames[:1])
        series.add(frames[1:5])
        series.add(frames[5:])
        same(series.path, frames)
        # Triangles of three of the seven frames are new.
        with h5py.File(series.path, "r") as file:
            assert len(file["VTKHDF/Polygons/Connectivity"]) == 3 * 3 * MESH.num_triangles

    @pytest.mark.parametrize("kept", [0, 1, 2, 3, 6, 7])
    def test_frames_are_cut_off_and_added_again(self, tmp_path, kept):
        frames = frames_of(7)
        series = SurfaceSeries(tmp_path / "a.vtkhdf")
        series.add(frames)
        series.cut(kept)
        if kept:
            same(series.path, frames[:kept])
        series.add(frames[kept:])
        same(series.path, frames)
        with pytest.raises(ValueError, match="has 7 frames, not 8"):
            series.cut(8)

    def test_components_are_told_apart(self, tmp_path, pair):
        series = SurfaceSeries(tmp_path / "a.vtkhdf")
        series.add([SurfaceFrame(0, 0.0, pair.vertices, pair.triangles)])
        (step,) = read(series.path)
        assert step.point_data["component"].tolist() == [0] * 42 + [1] * 42
        assert step.cell_data["component"].tolist() == [0] * 80 + [1] * 80

    def test_other_numbers_are_refused(self, tmp_path):
        series = SurfaceSeries(tmp_path / "a.vtkhdf")
        series.add(frames_of(2))
        other = helfrich.Mesh.random_sphere(92, 400)
        with pytest.raises(ValueError, match="132 vertices and 260 triangles, not 92 and 180"):
            series.add(frames_of(1, other))
        same(series.path, frames_of(2))

    def test_a_foreign_file_is_refused(self, tmp_path):
        path = tmp_path / "a.vtkhdf"
        path.write_bytes(b"no HDF5")
        with pytest.raises(ValueError, match="is no VTKHDF file of this package"):
            SurfaceSeries(path).steps()


class TestJournal:
    """A kill at every moment of an addition: the file has the frames before, or the new ones."""

    @pytest.mark.parametrize("new", [True, False])
    def test_kills_while_the_file_is_changed(self, tmp_path, monkeypatch, new):
        frames = frames_of(4)
        path = tmp_path / "a.vtkhdf"
        before = 0 if new else 2
        moment = 0
        while True:
            series = SurfaceSeries(path)
            series.remove()
            series.add(frames[:before])
            with killed_at(monkeypatch, moment):
                try:
                    series.add(frames[before:])
                except Killed:
                    # The journal was whole, so that nothing is lost.
                    assert path.with_name("a.vtkhdf.journal").exists()
                else:
                    break
            assert len(SurfaceSeries(path).steps()) == 4
            same(path, frames)
            moment += 7
        assert moment > 7

    def test_a_journal_that_was_not_finished_changes_nothing(self, tmp_path, monkeypatch):
        frames = frames_of(3)
        series = SurfaceSeries(tmp_path / "a.vtkhdf")
        series.add(frames[:2])

        def replace(path, data):
            path.with_name(path.name + ".new").write_bytes(data[:1000])
            raise Killed

        with monkeypatch.context() as patch:
            patch.setattr("openmmhelfrich._journal.replace", replace)
            with pytest.raises(Killed):
                series.add(frames[2:])
        same(series.path, frames[:2])
        series.add(frames[2:])
        same(series.path, frames)

    def test_a_damaged_journal_is_refused(self, tmp_path):
        series = SurfaceSeries(tmp_path / "a.vtkhdf")
        series.add(frames_of(1))
        (tmp_path / "a.vtkhdf.journal").write_bytes(bytes(200))
        with pytest.raises(ValueError, match=r"a\.vtkhdf\.journal"):
            series.steps()

    def test_bytes_are_those_of_an_ordinary_file(self, tmp_path):
        """Random writes, reads and truncations, against a file in memory."""
        random = np.random.default_rng(3)
        path, expected = tmp_path / "a", bytearray()
        for attempt in range(60):
            with JournaledFile(path).change(fresh=attempt == 0) as file:
                for _ in range(random.integers(1, 6)):
                    start, length = random.integers(0, 20000, 2).tolist()
                    data = random.bytes(length)
                    file.seek(start)
                    file.write(data)
                    expected.extend(bytes(max(0, start + length - len(expected))))
                    expected[start : start + length] = data
                file.seek(start // 2)
                buffer = bytearray(9000)
                count = file.readinto(buffer)
                assert buffer[:count] == expected[start // 2 : start // 2 + 9000]
                if attempt % 5 == 4:
                    del expected[start:]
                    file.truncate(start)
            assert path.read_bytes() == bytes(expected)
        assert not path.with_name("a.journal").exists()


class TestRun:
    def expected(self, out):
        """The frames as the other files of a run have them."""
        meshes = []
        for number in range(11):
            parts = [
                helfrich.Mesh.read(out / f"frames/run_{label}_{number:06d}.ply")
                for label in ("fluid", "solid")
            ]
            vertices = np.concatenate([mesh.vertices for mesh in parts])
            triangles = np.concatenate([parts[0].triangles, parts[1].triangles + 132])
            meshes.append(SurfaceFrame(4 * number, 1.6 * number, vertices, triangles))
        return meshes

    @pytest.fixture
    def meshes(self, config, tmp_path):
        invoke("run", config, "--out", tmp_path / "ply", "--frames", "ply")
        return self.expected(tmp_path / "ply")

    def check(self, path, meshes):
        check_layout(path)
        steps = read(path)
        assert len(steps) == len(meshes)
        for step, mesh in zip(steps, meshes, strict=True):
            assert step.time == pytest.approx(mesh.time, rel=1e-12)
            assert np.array_equal(step.points, mesh.vertices)
            assert np.array_equal(step.triangles, mesh.triangles)
        assert SurfaceSeries(path).steps().tolist() == [mesh.step for mesh in meshes]
        first, last = steps[0].triangles, steps[-1].triangles
        assert (first[:260] != last[:260]).any() and np.array_equal(first[260:], last[260:])

    def test_one_file_has_all_membranes_and_frames(self, config, tmp_path, meshes):
        result = invoke("run", config, "--out", tmp_path / "out")
        assert result.exit_code == 0, result.output
        assert not (tmp_path / "out/frames").exists()
        self.check(tmp_path / "out/run.vtkhdf", meshes)

    def test_a_resumed_run_loses_and_doubles_nothing(self, config, tmp_path, meshes):
        out = tmp_path / "out"
        for number, end in enumerate((6, 17, 28, END)):
            job = Run(config, out, resume=number > 0)
            assert job.advance(end)
            job.close()
        self.check(out / "run.vtkhdf", meshes)

    @pytest.mark.parametrize("option", ["--resume", "--resume-previous"])
    def test_frames_after_the_checkpoint_are_written_again(self, config, tmp_path, meshes, option):
        """As after kill -9: checkpoints of steps 10 and 17, and frames of all steps."""
        out = tmp_path / "out"
        killed_after(config, out, END)
        result = invoke("run", config, "--out", out, option)
        assert result.exit_code == 0, result.output
        self.check(out / "run.vtkhdf", meshes)

    def test_kill(self, config, tmp_path, meshes):
        """A process that kills itself in the middle of a frame, with the journal written."""
        out = tmp_path / "out"
        code = (
            "import os, signal, sys\n"
            "from openmmhelfrich import _journal\n"
            "from openmmhelfrich.cli import main\n"
            "calls, write = [], _journal._write_all\n"
            "def fatal(file, data):\n"
            "    calls.append(1)\n"
            "    if len(calls) > 200:\n"
            "        file.write(data[:100])\n"
            "        os.kill(os.getpid(), signal.SIGKILL)\n"
            "    write(file, data)\n"
            "_journal._write_all = fatal\n"
            "main(sys.argv[1:])\n"
        )
        words = [sys.executable, "-c", code, "run", config, "--out", out, "--checkpoint", "0"]
        killed = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=120)
        assert killed.returncode == -signal.SIGKILL, killed.stderr
        assert (out / "run.vtkhdf.journal").exists()
        result = invoke("run", config, "--out", out, "--resume")
        assert result.exit_code == 0, result.output
        assert "resumed at step 0" not in result.output
        self.check(out / "run.vtkhdf", meshes)

    @pytest.mark.parametrize("name", ["run.vtkhdf.journal.new", "run.vtkhdf"])
    def test_a_full_disk(self, config, tmp_path, meshes, monkeypatch, name):
        """While the journal is written, and while the file is changed from it."""
        out = tmp_path / "out"
        job = Run(config, out)
        assert job.advance(10)
        fsync = os.fsync

        def refuse(handle):
            if os.path.basename(os.readlink(f"/proc/self/fd/{handle}")) == name:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            fsync(handle)

        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", refuse)
            with pytest.raises(RunError) as error:
                job.advance(END)
        job.close()
        assert str(error.value).startswith(f"{out}/run.vtkhdf")
        assert "No space left on device; free some space there, then go on" in str(error.value)
        result = invoke("run", config, "--out", out, "--resume")
        assert result.exit_code == 0, result.output
        self.check(out / "run.vtkhdf", meshes)

    def test_a_file_that_was_taken_away_is_missed(self, config, tmp_path):
        out = tmp_path / "out"
        job = Run(config, out)
        assert job.advance(10)
        (out / "run.vtkhdf").rename(tmp_path / "elsewhere")
        with pytest.raises(RunError, match=r"run\.vtkhdf"):
            job.advance(END)
        job.close()
        with pytest.raises(RunError, match=r"cannot resume: .*has 0 frames, not 3"):
            Run(config, out, resume=True)

    def test_a_file_that_was_cut_is_refused(self, config, tmp_path, meshes):
        """By the checkpoint before, too."""
        out = tmp_path / "out"
        for number, end in enumerate((10, 17)):
            job = Run(config, out, resume=number > 0)
            assert job.advance(end)
            job.close()
        whole = (out / "run.vtkhdf").read_bytes()
        (out / "run.vtkhdf").write_bytes(whole[: len(whole) // 2])
        result = invoke("run", config, "--out", out, "--resume")
        assert result.exit_code == 1
        line = result.output.splitlines()[-1]
        assert f"cannot resume: {out / 'run.vtkhdf'} is no VTKHDF file of this package, or" in line
        assert line.endswith("bring the file back, or begin anew in another folder with --out")
        (out / "run.vtkhdf").write_bytes(whole)
        assert invoke("run", config, "--out", out, "--resume").exit_code == 0
        self.check(out / "run.vtkhdf", meshes)

    def test_without_h5py_the_run_does_not_begin(self, config, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "h5py", None)
        with pytest.raises(RunError, match=r"--frames vtkhdf: .*pip install openmm-helfrich\[hdf5"):
            Run(config, tmp_path / "out")


class TestReporter:
    @pytest.mark.parametrize("offset", [0, 4])
    def test_frames_have_the_triangles_of_their_moment(self, tmp_path, offset):
        placement, simulation = simulation_of(MESH, offset)
        path = tmp_path / "a.vtkhdf"
        simulation.reporters.append(VTKHDFReporter(path, 20, MESH, offset=offset))
        expected = []
        for number in range(1, 5):
            simulation.step(20)
            mesh = placement.mesh(simulation.context)
            time = simulation.context.getState().getTime()._value
            expected.append(SurfaceFrame(20 * number, time, mesh.vertices, mesh.triangles))
        same(path, expected)
        assert (expected[0].triangles != expected[-1].triangles).any()

    def test_a_file_that_was_taken_away_is_missed(self, tmp_path):
        path = tmp_path / "a.vtkhdf"
        _, simulation = simulation_of(MESH)
        simulation.reporters.append(VTKHDFReporter(path, 10, MESH))
        simulation.step(20)
        path.rename(tmp_path / "elsewhere")
        with pytest.raises(FileNotFoundError, match="see whether its folder is there") as error:
            simulation.step(10)
        assert error.value.filename == str(path)
        assert not path.exists()

    def test_a_file_that_was_cut_is_refused(self, tmp_path):
        path = tmp_path / "a.vtkhdf"
        _, simulation = simulation_of(MESH)
        simulation.reporters.append(VTKHDFReporter(path, 10, MESH))
        simulation.step(20)
        path.write_bytes(path.read_bytes()[:5000])
        simulation.reporters[:] = [VTKHDFReporter(path, 10, MESH, append=True)]
        with pytest.raises(ValueError, match=rf"{path} is no VTKHDF file.*; do not append"):
            simulation.step(1)

    def test_it_goes_on_from_the_step_of_the_simulation(self, tmp_path):
        path = tmp_path / "a.vtkhdf"
        _, simulation = simulation_of(MESH)
        simulation.reporters.append(VTKHDFReporter(path, 10, MESH))
        simulation.step(30)
        simulation.saveCheckpoint(str(tmp_path / "state"))
        simulation.step(30)
        whole = read(path)
        _, again = simulation_of(MESH)
        again.loadCheckpoint(str(tmp_path / "state"))
        again.reporters.append(VTKHDFReporter(path, 10, MESH, append=True))
        again.step(1)
        assert SurfaceSeries(path).steps().tolist() == [10, 20, 30]
        again.step(29)
        for one, two in zip(whole, read(path), strict=True):
            assert one.time == two.time
            assert np.array_equal(one.points, two.points)
            assert np.array_equal(one.triangles, two.triangles)
        _, other = simulation_of(MESH)
        other.reporters.append(VTKHDFReporter(path, 10, MESH))
        other.step(10)
        assert SurfaceSeries(path).steps().tolist() == [10]

    def test_mistakes_are_named(self, tmp_path):
        with pytest.raises(ValueError, match=r"VTKHDFReporter: a.h5: the suffix must be .vtkhdf"):
            VTKHDFReporter("a.h5", 10, MESH)
        path = tmp_path / "a.vtkhdf"
        _, simulation = simulation_of(MESH)
        other = helfrich.Mesh.random_sphere(92, 400)
        SurfaceSeries(path).add(frames_of(1, other))
        simulation.reporters.append(VTKHDFReporter(path, 10, MESH, append=True))
        with pytest.raises(ValueError, match="not 132 and 260; give another file"):
            simulation.step(10)


class TestPeriodicBoxes:
    """Surfaces in a box that changes: what spans it is cut at its faces."""

    def frames(self):
        random = np.random.default_rng(4)
        sheet = helfrich.Mesh.sheet(8, 7, 10.0, periodic=True)
        ball = helfrich.Mesh.icosphere(2, 15.0).translated((0, 0, 25))
        triangles = np.vstack([sheet.triangles, ball.triangles + sheet.num_vertices])
        found = []
        for factor in (1, 1.02, 1.02, 0.97):
            vertices = np.vstack([sheet.vertices, ball.vertices]) * factor
            vertices += random.normal(0, 0.5, vertices.shape) + 20 * random.normal(size=3)
            vertices[3] += 2 * factor * sheet.box[1]
            found.append(helfrich.Mesh(vertices, triangles, factor * sheet.box))
        return found

    def check(self, path, meshes):
        check_layout(path)
        steps = read(path)
        assert len({len(step.points) for step in steps}) > 1
        assert len(steps) == len(meshes)
        for step, mesh in zip(steps, meshes, strict=True):
            points, triangles = mesh.unfolded()
            np.testing.assert_allclose(step.points, points, rtol=0, atol=1e-9)
            assert np.array_equal(step.triangles, triangles)
            areas = analysis.triangle_areas(mesh, mesh)
            assert step.cell_data["area"] == pytest.approx(areas, rel=1e-6)
            assert analysis.triangle_areas(points, triangles) == pytest.approx(areas)
            # The vertices of a triangle's corners are those that their values belong to.
            curvature = analysis.mean_curvature(mesh, mesh)[mesh.triangles]
            here = step.point_data["mean_curvature"][step.triangles]
            assert here == pytest.approx(curvature, rel=1e-5, abs=1e-7)
            assert step.point_data["neighbours"][step.triangles].ravel() == pytest.approx(
                mesh.degrees[mesh.triangles].ravel()
            )
            assert step.cell_data["component"].tolist() == [0] * 112 + [1] * 80

    def test_frames_are_cut_at_the_box(self, tmp_path):
        meshes = self.frames()
        path = tmp_path / "a.vtkhdf"
        vertices, boxes = (np.stack([getattr(m, n) for m in meshes]) for n in ("vertices", "box"))
        assert analysis.write_vtkhdf(path, vertices, meshes[0].triangles, box=boxes) == 4
        self.check(path, meshes)
        series = SurfaceSeries(path)
        for kept in (3, 2, 1):
            series.cut(kept)
            check_layout(path)
        series.add(
            SurfaceFrame(k, k, m.vertices, m.triangles, m.box)
            for k, m in enumerate(meshes)
            if k > 0
        )
        self.check(path, meshes)

    def test_a_mesh_has_its_own_box(self, tmp_path):
        mesh = self.frames()[0]
        analysis.write_vtkhdf(tmp_path / "a.vtkhdf", mesh, mesh)
        (step,) = read(tmp_path / "a.vtkhdf")
        assert np.array_equal(step.triangles, mesh.unfolded()[1])

    def test_a_trajectory_has_boxes_of_its_frames(self, tmp_path):
        pytest.importorskip("mdtraj")
        meshes = self.frames()
        start = meshes[0]
        path = tmp_path / "a.xtc"
        file = app.XTCFile(str(path), start.topology(), 0.001)
        for mesh in meshes:
            box = [openmm.Vec3(*vector) for vector in mesh.box]
            file.writeModel(mesh.vertices, periodicBoxVectors=box)
        boxes = analysis.Trajectory(path).boxes()
        np.testing.assert_allclose(boxes, [mesh.box for mesh in meshes], rtol=1e-6)
        assert len(analysis.Trajectory(path, start=1, stride=2).boxes()) == 2
        with (tmp_path / "a.dcd").open("wb") as stream:
            dcd = app.DCDFile(stream, start.topology(), 0.001)
            for mesh in meshes:
                box = [openmm.Vec3(*vector) for vector in mesh.box]
                dcd.writeModel(mesh.vertices * openmm.unit.nanometer, periodicBoxVectors=box)
        in_dcd = analysis.Trajectory(tmp_path / "a.dcd").boxes()
        np.testing.assert_allclose(in_dcd, boxes, rtol=1e-5, atol=1e-4)
        expected = [analysis.shape(mesh, mesh).area for mesh in meshes]
        for found in (
            analysis.shape(path, start).area,
            analysis.shape(path, start.triangles, box=boxes).area,
            analysis.triangle_areas(analysis.Trajectory(path), start).sum(axis=1),
        ):
            np.testing.assert_allclose(found, expected, rtol=1e-3)
        with pytest.raises(ValueError, match="those of 2 frames"):
            analysis.triangle_areas(analysis.Trajectory(path), start.triangles, box=boxes[:2])
        analysis.write_vtkhdf(tmp_path / "a.vtkhdf", path, start)
        assert [len(step.points) for step in read(tmp_path / "a.vtkhdf")] == [
            len(mesh.unfolded()[0]) for mesh in meshes
        ]
