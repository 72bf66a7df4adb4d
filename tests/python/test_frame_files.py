"""GSD and extended XYZ files that grow during runs and simulations."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import openmmhelfrich as helfrich
import pytest
from flowing import simulation_of
from openmmhelfrich import ExtendedXYZReporter, GSDReporter, analysis
from openmmhelfrich.analysis.frame_files import ExtendedXYZSeries, GSDSeries
from openmmhelfrich.analysis.surface_series import SurfaceFrame
from openmmhelfrich.simulation.runner import Run
from run_files import fluid_and_solid, invoke, killed_after

pytest.importorskip("gsd")

MESH = helfrich.Mesh.random_sphere(132, 400, seed=5)
SERIES = {".gsd": GSDSeries, ".extxyz": ExtendedXYZSeries}
WRITERS = {".gsd": analysis.write_gsd, ".extxyz": analysis.write_extended_xyz}
REPORTERS = {".gsd": GSDReporter, ".extxyz": ExtendedXYZReporter}
ALL = pytest.mark.parametrize("suffix", SERIES)


def frames_of(count, mesh=MESH):
    """Frames whose positions always, triangles often, and steps never are those of before."""
    random = np.random.default_rng(2)
    triangles, found = mesh.triangles, []
    for number in range(count):
        if number % 3 == 2:
            triangles = random.permutation(triangles)
        if number == 4:
            triangles = mesh.triangles
        # The cell without a box has to grow twice.
        vertices = 3.0 ** (number // 3) * mesh.vertices + random.normal(0, 3, mesh.vertices.shape)
        found.append(SurfaceFrame(7 * number, 0.25 * number, vertices, triangles))
    return found


def written_at_once(path, frames):
    columns = (np.array([getattr(f, name) for f in frames]) for name in SurfaceFrame._fields[:4])
    steps, times, vertices, triangles = columns
    WRITERS[path.suffix](path, vertices, triangles, times, steps)


def contents(path):
    """All that a reader finds."""
    if path.suffix != ".gsd":
        return path.read_text()
    return [[np.asarray(x, dtype=float).tolist() for x in frame[:-1] if x is not None]
            for frame in analysis.read_gsd(path)]  # fmt: skip


def fail_to_write(patch, suffix):
    """Let the disk be full."""

    def full(*arguments):
        raise OSError(28, "No space left on device")

    if suffix == ".gsd":
        import gsd.hoomd

        patch.setattr(gsd.hoomd.HOOMDTrajectory, "append", full)
    else:
        patch.setattr("os.fsync", full)


def killed(*arguments):
    """Leaves what a kill leaves: nothing here tidies up after this error."""
    raise KeyboardInterrupt


class TestSeries:
    @ALL
    @pytest.mark.parametrize("again", [False, True])
    def test_frame_by_frame_is_all_at_once(self, tmp_path, suffix, again):
        path, frames = tmp_path / f"a{suffix}", frames_of(8)
        series = SERIES[suffix](path)
        for number, frame in enumerate(frames):
            if again and number == 5:
                series = SERIES[suffix](path)
            series.add([frame])
            assert series.check(number + 1) == number + 1
        assert series.steps().tolist() == [frame.step for frame in frames]
        written_at_once(tmp_path / f"b{suffix}", frames)
        assert contents(path) == contents(tmp_path / f"b{suffix}")
        assert sorted(each.name for each in tmp_path.iterdir()) == [f"a{suffix}", f"b{suffix}"]

    @ALL
    @pytest.mark.parametrize("kept", [1, 3, 6, 8])
    def test_cut_and_written_again_is_the_same(self, tmp_path, suffix, kept):
        path, frames = tmp_path / f"a{suffix}", frames_of(8)
        series = SERIES[suffix](path)
        series.add(frames)
        whole = contents(path)
        series.cut(kept)
        assert series.steps().tolist() == [frame.step for frame in frames[:kept]]
        series.add(frames[kept:])
        assert contents(path) == whole

    @ALL
    def test_too_few_frames_are_told_and_none_is_no_file(self, tmp_path, suffix):
        series = SERIES[suffix](tmp_path / f"a{suffix}")
        assert series.steps().size == 0
        series.add(frames_of(2))
        with pytest.raises(ValueError, match=r"has 2 frames, not 3"):
            series.cut(3)
        series.cut(0)
        assert not series.path.exists()
        with pytest.raises(FileNotFoundError, match="see whether its folder is there"):
            series.require()

    def test_half_a_frame_of_text_counts_for_nothing(self, tmp_path):
        frames = frames_of(3)
        path = tmp_path / "a.extxyz"
        ExtendedXYZSeries(path).add(frames)
        whole = path.read_bytes()
        ends = [index for index, byte in enumerate(whole) if byte == ord("\n")]
        two = ends[2 * (MESH.num_vertices + 2) - 1] + 1
        for length in (two + 2, two + 40, two + 5000, len(whole) - 1):
            path.write_bytes(whole[:length])
            series = ExtendedXYZSeries(path)
            assert series.steps().tolist() == [0, 7]
            series.add(frames[2:])
            assert path.read_bytes() == whole

            path.write_bytes(whole[:length])
            ExtendedXYZSeries(path).cut(2)
            assert path.read_bytes() == whole[:two]
            path.write_bytes(whole[: ends[5]])
            ExtendedXYZSeries(path).cut(0)
            assert not path.exists()

    @pytest.mark.parametrize("kept", [0, 3, 200])
    def test_a_kill_as_a_gsd_file_begins_leaves_none_or_an_empty_one(
        self, tmp_path, kept, monkeypatch
    ):
        path, frames = tmp_path / "a.gsd", frames_of(3)
        series = GSDSeries(path)
        with monkeypatch.context() as patch:
            patch.setattr("os.replace", killed)
            with pytest.raises(KeyboardInterrupt):
                series.add(frames)
        assert not path.exists()
        fresh = path.with_name("a.gsd.new")
        fresh.write_bytes(fresh.read_bytes()[:kept])
        with monkeypatch.context() as patch:
            fail_to_write(patch, ".gsd")
            with pytest.raises(OSError, match="free some space"):
                series.add(frames)
        assert GSDSeries(path).steps().size == 0
        GSDSeries(path).add(frames)
        written_at_once(tmp_path / "b.gsd", frames)
        assert contents(path) == contents(tmp_path / "b.gsd")

    @ALL
    def test_others_may_read_what_is_written(self, tmp_path, suffix):
        path = tmp_path / f"a{suffix}"
        SERIES[suffix](path).add(frames_of(3))
        written_at_once(tmp_path / f"b{suffix}", frames_of(3))
        tmp_path.joinpath("plain").touch()
        modes = {file.stat().st_mode for file in tmp_path.iterdir()}
        assert len(modes) == 1
        SERIES[suffix](path).cut(2)
        assert {path.stat().st_mode} == modes

    @ALL
    def test_a_kill_leaves_whole_frames(self, tmp_path, suffix):
        path = tmp_path / f"a{suffix}"
        code = (
            "import sys\n"
            "sys.path.insert(0, sys.argv[2])\n"
            "from test_frame_files import MESH, SERIES, SurfaceFrame\n"
            "series = SERIES[sys.argv[3]](sys.argv[1])\n"
            "for number in range(len(series.steps()), 100000):\n"
            "    corners = MESH.triangles[:: 1 - 2 * (number % 2)]\n"
            "    series.add([SurfaceFrame(number, 0.5 * number, MESH.vertices, corners)])\n"
        )
        words = [sys.executable, "-c", code, path, Path(__file__).parent, suffix]
        known = 0
        for wait in (0.11, 0.23, 0.05):
            writer = subprocess.Popen([str(word) for word in words])
            while not path.exists() or SERIES[suffix](path).check(0) <= known:
                assert writer.poll() is None
                time.sleep(0.02)
            time.sleep(wait)
            writer.kill()
            writer.wait()
            steps = SERIES[suffix](path).steps()
            assert steps.tolist() == list(range(len(steps)))
            assert len(steps) > known
            known = len(steps)
        SERIES[suffix](path).cut(known)
        expected = [
            SurfaceFrame(n, 0.5 * n, MESH.vertices, MESH.triangles[:: 1 - 2 * (n % 2)])
            for n in range(known)
        ]
        written_at_once(tmp_path / f"b{suffix}", expected)
        assert contents(path) == contents(tmp_path / f"b{suffix}")

    @ALL
    @pytest.mark.parametrize("written", [0, 2])
    def test_what_failed_is_written_the_next_time(self, tmp_path, suffix, written, monkeypatch):
        path, frames = tmp_path / f"a{suffix}", frames_of(5)
        series = SERIES[suffix](path)
        for frame in frames[:written]:
            series.add([frame])
        with monkeypatch.context() as patch:
            fail_to_write(patch, suffix)
            with pytest.raises(OSError, match="free some space"):
                series.add([frames[written]])
        for frame in frames[written:]:
            series.add([frame])
        written_at_once(tmp_path / f"b{suffix}", frames)
        assert contents(path) == contents(tmp_path / f"b{suffix}")

    @ALL
    def test_other_files_are_refused(self, tmp_path, suffix):
        path = tmp_path / f"a{suffix}"
        path.write_bytes(b"1\nno frame of ours\nX 0 0 0\n" * 40)
        with pytest.raises(ValueError, match=rf"a{suffix} is no .* file of .*, or is damaged"):
            SERIES[suffix](path).steps()

    @ALL
    @pytest.mark.parametrize("again", [False, True])
    def test_another_surface_is_refused(self, tmp_path, suffix, again):
        path = tmp_path / f"a{suffix}"
        series = SERIES[suffix](path)
        series.add(frames_of(1))
        if again:
            series = SERIES[suffix](path)
        before = path.read_bytes()
        with pytest.raises(ValueError, match="have 132 vertices, not 92; give another file"):
            series.add(frames_of(1, helfrich.Mesh.random_sphere(92, 400)))
        assert path.read_bytes() == before

    @pytest.mark.parametrize(
        "text",
        [
            b"my notes",
            b"my notes\nof today",
            b"12\nof today",
            b"0\nstep=3\n",
            b"-5\nstep=3\n",
            b"900\nstep=3\nX 0 0 0\n",
            b'900\nProperties=species:S:1:pos:R:3 step=3 pbc="F F F"\nX 0 0 0\n',
        ],
    )
    def test_text_of_something_else_is_left_as_it_is(self, tmp_path, text):
        path = tmp_path / "a.xyz"
        path.write_bytes(text)
        with pytest.raises(ValueError, match=r"a\.xyz is no extended XYZ file of this package"):
            ExtendedXYZSeries(path).add(frames_of(1))
        assert path.read_bytes() == text

    def test_gsd_that_is_written_while_it_is_read(self, tmp_path, monkeypatch):
        # What gsd sees of it is a file whose index is newer than its size.
        import gsd.hoomd

        path = tmp_path / "a.gsd"
        written_at_once(path, frames_of(3))
        whole, open_file = path.read_bytes(), gsd.hoomd.open
        states = []

        def meanwhile(**words):
            path.write_bytes(states.pop(0) if states else whole)
            return open_file(**words)

        monkeypatch.setattr(gsd.hoomd, "open", meanwhile)
        for read in (GSDSeries(path).steps, lambda: analysis.read_gsd(path)):
            states[:] = [whole[:-1000]] * 2
            assert len(read()) == 3
            states[:] = [whole[:-1000]] * 100
            with pytest.raises(ValueError, match=r"damaged \(Corrupt GSD file"):
                read()

    def test_gsd_of_another_program_is_left_as_it_is(self, tmp_path):
        import gsd.hoomd

        path = tmp_path / "a.gsd"
        with gsd.hoomd.open(path, "w") as file:
            for step in (0, 5, 10):
                frame = gsd.hoomd.Frame()
                frame.configuration.step = step
                frame.particles.N = MESH.num_vertices
                frame.particles.position = MESH.vertices
                file.append(frame)
        before = path.read_bytes()
        for act in (lambda s: s.cut(1), lambda s: s.add(frames_of(1)), lambda s: s.steps()):
            with pytest.raises(ValueError, match="a GSD file of another program, which is left"):
                act(GSDSeries(path))
        assert path.read_bytes() == before
        assert len(analysis.read_gsd(path)) == 3


@ALL
class TestRuns:
    @pytest.fixture
    def config(self, tmp_path, suffix):
        path = tmp_path / "run.toml"
        kind = suffix[1:]
        path.write_text(fluid_and_solid(16, 1.6, kind, platform="Reference"))
        return path

    def test_it_has_the_frames_of_the_trajectory(self, config, tmp_path, suffix):
        result = invoke("run", config, "--out", tmp_path / "out")
        assert result.exit_code == 0, result.output
        path = tmp_path / f"out/run{suffix}"
        if suffix == ".gsd":
            trajectory = analysis.Trajectory(tmp_path / "out/run.xtc")
            read = analysis.read_gsd(path)
            assert len(read) == 11
            system = Run(config, tmp_path / "other").cfg.system()
            masses = [system.getParticleMass(i)._value for i in range(system.getNumParticles())]
            for frame, vertices, triangles in zip(
                read, trajectory, trajectory.triangles(), strict=True
            ):
                assert frame.vertices == pytest.approx(vertices, abs=0.01)
                assert np.array_equal(frame.triangles, triangles)
                assert frame.masses == pytest.approx(masses, rel=1e-6)
        else:
            steps = ExtendedXYZSeries(path).steps()
            assert steps.tolist() == list(range(0, 41, 4))

    def test_a_resumed_run_loses_and_doubles_nothing(self, config, tmp_path, suffix):
        job = Run(config, tmp_path / "whole")
        assert job.advance(40)
        job.close()
        out = tmp_path / "out"
        killed_after(config, out, 40)
        result = invoke("run", config, "--out", out, "--resume")
        assert result.exit_code == 0, result.output
        one, two = tmp_path / f"whole/run{suffix}", out / f"run{suffix}"
        assert contents(one) == contents(two)


@ALL
class TestReporters:
    @pytest.mark.parametrize("offset", [0, 4])
    def test_frames_have_the_triangles_of_their_moment(self, tmp_path, suffix, offset):
        placement, simulation = simulation_of(MESH, offset)
        path = tmp_path / f"a{suffix}"
        simulation.reporters.append(REPORTERS[suffix](path, 20, MESH, offset=offset))
        frames = []
        for number in range(1, 4):
            simulation.step(20)
            mesh = placement.mesh(simulation.context)
            time = simulation.context.getState().getTime()._value
            frames.append(SurfaceFrame(20 * number, time, mesh.vertices, mesh.triangles))
        assert (frames[0].triangles != frames[-1].triangles).any()
        written_at_once(tmp_path / f"b{suffix}", frames)
        if suffix == ".gsd":
            assert {mass for f in analysis.read_gsd(path) for mass in f.masses} == {50.0}
        assert contents(path) == contents(tmp_path / f"b{suffix}")

    def test_it_goes_on_from_the_step_of_the_simulation(self, tmp_path, suffix):
        path = tmp_path / f"a{suffix}"
        _, simulation = simulation_of(MESH)
        simulation.reporters.append(REPORTERS[suffix](path, 10, MESH))
        simulation.step(20)
        simulation.saveCheckpoint(str(tmp_path / "state"))
        simulation.step(20)
        whole = contents(path)
        _, again = simulation_of(MESH)
        again.loadCheckpoint(str(tmp_path / "state"))
        again.reporters.append(REPORTERS[suffix](path, 10, MESH, append=True))
        again.step(1)
        assert SERIES[suffix](path).steps().tolist() == [10, 20]
        again.step(19)
        assert contents(path) == whole

    def test_what_is_lost_at_step_0_is_told(self, tmp_path, suffix):
        path = tmp_path / f"a{suffix}"
        for number in range(2):
            _, simulation = simulation_of(MESH)
            simulation.reporters.append(REPORTERS[suffix](path, 10, MESH, append=True))
            if number:
                with pytest.warns(UserWarning, match=r"at step 0, .*: 2 reports of later steps"):
                    simulation.step(1)
            else:
                simulation.step(20)
        assert not path.exists()

    def test_another_suffix_is_refused(self, suffix):
        with pytest.raises(ValueError, match=r"Reporter: a\.h5: the suffix must be \."):
            REPORTERS[suffix]("a.h5", 10, MESH)
