"""The commands `run` and `info`: their files read back, and runs that are killed and go on."""

import contextlib
import csv
import os
import re
import signal
import subprocess
import sys
import time
from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest
from openmm.app.internal.xtc_utils import read_xtc
from openmmhelfrich import Mesh, vcm
from openmmhelfrich.analysis import mean_curvature
from openmmhelfrich.simulation.outputs import Frame, Outputs, report_steps
from openmmhelfrich.simulation.runner import Run, RunError
from openmmhelfrich.vcm.parsers import Interval
from run_files import config, contents, invoke, results
from vcm_files import Folder, context, energies

FRAMES = 11
CHECKPOINTS = ("checkpoint.bin", "checkpoint-previous.bin")


@pytest.fixture
def folder(tmp_path, lumpy):
    return Folder(tmp_path, lumpy)


@pytest.fixture(scope="module")
def finished(tmp_path_factory, lumpy):
    """A run of two membranes with everything that can be written."""
    folder = Folder(tmp_path_factory.mktemp("run"), lumpy)
    second = "-Membrane B like 0\nCoordinateTranslateVector 20 0 0\nMeanCurvatureCoeff 0"
    path = config(folder, more=second)
    out = folder.path / "out"
    result = invoke("run", path, "--platform", "reference", "--out", out, "--ply")
    assert result.exit_code == 0, result.output
    return vcm.read(path), out, result.output


@pytest.fixture(scope="module")
def frames(finished):
    """Positions, velocities and forces of every frame, computed without the runner."""
    cfg, _, _ = finished
    simulation = cfg.simulation("Reference")
    found = []
    for number in range(FRAMES):
        if number:
            simulation.step(20)
        found.append(
            simulation.context.getState(
                getPositions=True, getVelocities=True, getForces=True, getEnergy=True
            )
        )
    return found


def positions_of(state):
    return state.getPositions(asNumpy=True)._value


class TestFiles:
    def lines(self, finished, suffix):
        cfg, out, _ = finished
        rows = (out / f"cell{suffix}").read_text().splitlines()
        size = cfg.num_particles + 2
        assert len(rows) == FRAMES * size
        return [rows[i : i + size] for i in range(0, len(rows), size)]

    def test_xyz(self, finished, frames):
        for number, (rows, state) in enumerate(
            zip(self.lines(finished, ".xyz"), frames, strict=True)
        ):
            assert rows[0] == "84"
            word, t, potential_word, potential, energy_word, energy = rows[1].split()
            assert word == "timePs"
            assert potential_word == "potential_energy_inKJpermol"
            assert energy_word == "energy_inKJpermol"
            assert float(t) == pytest.approx(0.4 * number, abs=1e-9)
            expected = state.getPotentialEnergy()._value
            assert float(potential) == pytest.approx(expected, rel=1e-12)
            expected += state.getKineticEnergy()._value
            assert float(energy) == pytest.approx(expected, rel=1e-12)
            assert [row.split()[0] for row in rows[2:]] == ["M0"] * 42 + ["M1"] * 42
            values = np.array([row.split()[1:] for row in rows[2:]], dtype=float)
            assert np.allclose(values, positions_of(state), rtol=1e-8)

    def test_velocities_and_forces(self, finished, frames):
        for suffix, get in ((".vel", "getVelocities"), (".force", "getForces")):
            for rows, state in zip(self.lines(finished, suffix), frames, strict=True):
                values = np.array([row.split()[1:] for row in rows[2:]], dtype=float)
                expected = getattr(state, get)(asNumpy=True)._value
                assert np.allclose(values, expected, rtol=1e-7, atol=1e-9)

    def test_curvature(self, finished, frames, lumpy):
        for rows, state in zip(self.lines(finished, ".curve"), frames, strict=True):
            values = np.array([float(row.split()[1]) for row in rows[2:]])
            for part in (slice(0, 42), slice(42, 84)):
                expected = mean_curvature(positions_of(state)[part], lumpy.triangles)
                assert np.allclose(values[part], expected, rtol=1e-8)

    def test_binary(self, finished, frames):
        _, out, _ = finished
        expected = np.array([positions_of(state) for state in frames])
        found = np.fromfile(out / "cell.bin_xyz_single", "<f4").reshape(FRAMES, 84, 3)
        assert np.array_equal(found, expected.astype("<f4"))
        expected = np.array([state.getVelocities(asNumpy=True)._value for state in frames])
        found = np.fromfile(out / "cell.bin_vel_single", "<f4").reshape(FRAMES, 84, 3)
        assert np.array_equal(found, expected.astype("<f4"))
        found = np.fromfile(out / "cell.bin_tpk_single", "<f4").reshape(FRAMES, 3)
        expected = [
            (0.4 * n, state.getPotentialEnergy()._value, state.getKineticEnergy()._value)
            for n, state in enumerate(frames)
        ]
        assert np.allclose(found, expected, rtol=1e-6)

    def test_double_precision(self, folder):
        path = config(folder, Precision="", TextOutputs="N", BinOutputs="XYZ")
        text = path.read_text().replace("Seed 5", "Seed 5\nPrecision double")
        path.write_text(text)
        out = folder.path / "out"
        arguments = ("--platform", "Reference", "--out", out, "--steps", 0, "--no-xtc")
        assert invoke("run", path, *arguments).exit_code == 0
        found = np.fromfile(out / "cell.bin_xyz_double", "<f8").reshape(42, 3)
        assert np.array_equal(found, vcm.read(path).positions)
        assert set(contents(out)) == {".lock", "cell.bin_xyz_double", "cell.csv", *CHECKPOINTS}

    def test_xtc(self, finished, frames):
        _, out, _ = finished
        coordinates, _, times, steps = read_xtc(os.fsencode(out / "cell.xtc"))
        assert list(steps) == [20 * n for n in range(FRAMES)]
        assert np.allclose(times, [0.4 * n for n in range(FRAMES)])
        for found, state in zip(np.moveaxis(coordinates, -1, 0), frames, strict=True):
            assert np.abs(found - positions_of(state)).max() < 6e-4

    def test_xtc_after_more_steps_than_it_can_count(self, finished, frames, tmp_path):
        cfg, _, _ = finished
        state, step = frames[0], 2**31 + 7
        frame = Frame(
            step, 1e9, 0, 0, positions_of(state), positions_of(state), None, {}, 10 * np.eye(3), ()
        )
        path = tmp_path / "late.xtc"
        path.write_bytes(Outputs._xtc(SimpleNamespace(_cfg=cfg), frame))
        coordinates, _, times, steps = read_xtc(os.fsencode(path))
        assert list(steps) == [7]
        assert list(times) == [1e9]
        assert np.abs(coordinates[..., 0] - positions_of(state)).max() < 6e-4

    def test_ply(self, finished, frames, lumpy):
        cfg, out, _ = finished
        assert len(list((out / "frames").iterdir())) == 2 * FRAMES
        for membrane in cfg.membranes:
            for number, state in enumerate(frames):
                mesh = Mesh.read(out / "frames" / f"cell_{membrane.label}_{number:06d}.ply")
                part = slice(membrane.offset, membrane.particles.stop)
                assert mesh == Mesh(positions_of(state)[part], lumpy.triangles)

    def test_csv(self, finished, frames, lumpy):
        cfg, out, _ = finished
        rows = list(csv.DictReader((out / "cell.csv").open(encoding="utf-8")))
        assert [int(row["step"]) for row in rows] == [20 * n for n in range(FRAMES)]
        for row, state in zip(rows, frames, strict=True):
            terms = energies(cfg, positions_of(state))
            for name, energy in terms.items():
                assert float(row[f"{name} (kJ/mol)"]) == pytest.approx(energy, rel=1e-9, abs=1e-9)
            assert float(row["potential (kJ/mol)"]) == pytest.approx(sum(terms.values()), rel=1e-9)
            second = Mesh(positions_of(state)[42:], lumpy.triangles)
            assert float(row["area B (nm^2)"]) == pytest.approx(second.area, rel=1e-11)
            assert float(row["volume B (nm^3)"]) == pytest.approx(second.volume, rel=1e-11)

    def test_psf(self, finished, lumpy):
        _, out, _ = finished
        lines = (out / "cell.psf").read_text().splitlines()
        assert any(line.split() == ["84", "!NATOM"] for line in lines)
        at = next(i for i, line in enumerate(lines) if "!NBOND" in line)
        numbers = []
        for line in islice(lines, at + 1, None):
            if not line.strip():
                break
            numbers += [int(word) for word in line.split()]
        bonds = np.array(numbers).reshape(-1, 2) - 1
        assert bonds.tolist() == [*lumpy.edges.tolist(), *(lumpy.edges + 42).tolist()]

    def test_pdb(self, finished, frames):
        _, out, _ = finished
        lines = (out / "cell.pdb").read_text().splitlines()
        assert sum(line.startswith("MODEL") for line in lines) == FRAMES
        assert sum(line == "ENDMDL" for line in lines) == FRAMES
        atoms = [line for line in lines if line.startswith("ATOM")]
        columns = [[line[30 + 8 * i : 38 + 8 * i] for i in range(3)] for line in atoms]
        found = np.array(columns, dtype=float).reshape(FRAMES, 84, 3)
        expected = np.array([positions_of(state) for state in frames])
        assert np.abs(found - expected).max() < 6e-4

    def test_printed(self, finished):
        _, out, text = finished
        assert "cell: 2 membrane(s), 84 vertices, platform Reference, seed 5" in text
        assert f"outputs in {out}" in text
        assert len(re.findall(r"^step \d+/200 +area 0 .* kinetic ", text, flags=re.M)) == 10
        assert "Energies at step 200, 4 ps, in kJ/mol:" in text

    def test_no_energies(self, folder):
        path = config(folder)
        path.write_text(path.read_text().replace("Seed 5", "Seed 5\nReportEnergy false"))
        out = folder.path / "out"
        invoke("run", path, "--platform", "Reference", "--out", out, "--steps", 20)
        header = (out / "cell.csv").read_text().splitlines()[0]
        assert "potential" in header
        assert "bending" not in header


class TestReports:
    def test_fixed(self):
        assert list(islice(report_steps(Interval(fs=1000), 0.2, 99), 3)) == [5, 10, 15]

    def test_factor(self):
        found = list(islice(report_steps(Interval(factor=1.5), 0.2, 99), 7))
        assert found == [1, 2, 3, 5, 8, 11, 17]

    def test_number(self):
        assert list(report_steps(Interval(reports=4), 0.2, 1000)) == [1, 10, 100, 1000]

    def test_in_a_run(self, folder):
        out = folder.path / "out"
        path = config(folder, ReportIntervalInFs="EXP 2")
        invoke("run", path, "--platform", "Reference", "--out", out, "--steps", 20)
        rows = list(csv.DictReader((out / "cell.csv").open(encoding="utf-8")))
        assert [int(row["step"]) for row in rows] == [0, 1, 2, 4, 8, 16]


class TestResume:
    def run(self, path, out, last_step, resume=False, **options):
        job = Run(path, out, platform="Reference", resume=resume, ply=True, **options)
        done = job.advance(last_step)
        job.close()
        assert done
        return job

    @pytest.mark.parametrize("integrator", ["V", "B", "L", "LM"])
    @pytest.mark.parametrize("at", [0, 40, 93])
    def test_in_two_parts_as_in_one(self, folder, integrator, at):
        """At the start, at a report, between two: the same bytes in every file."""
        path = config(folder, integrator, FrictionIninvertPs="5")
        one, two = folder.path / "one", folder.path / "two"
        self.run(path, one, 200)
        self.run(path, two, at)
        self.run(path, two, 200, resume=True)
        assert results(one) == results(two)
        assert len(results(one)) == 12 + 2 + FRAMES

    def test_what_came_after_the_checkpoint_is_undone(self, folder):
        path = config(folder)
        one, two = folder.path / "one", folder.path / "two"
        self.run(path, one, 200)
        job = Run(path, two, platform="Reference", ply=True, checkpoint_seconds=1e9)
        saved = (two / "checkpoint.bin").read_bytes()
        job.advance(150)
        job.close()
        # As if it had been killed before its last checkpoint, in the middle of a line.
        (two / "checkpoint.bin").write_bytes(saved)
        with (two / "cell.xyz").open("a") as file:
            file.write("M0 0.1 0.2")
        self.run(path, two, 200, resume=True)
        assert results(one) == results(two)

    def test_longer_than_it_was_meant_to_be(self, folder):
        path = config(folder)
        one, two = folder.path / "one", folder.path / "two"
        self.run(path, one, 260)
        self.run(path, two, 200)
        config(folder, SimulationTimeInPs="5.2")
        result = invoke("run", path, "--out", two, "--resume")
        assert result.exit_code == 0, result.output
        assert results(one) == results(two)

    def test_drawn_seed_is_kept(self, folder):
        path = config(folder, Seed="0")
        first = self.run(path, folder.path / "out", 20)
        second = self.run(path, folder.path / "out", 40, resume=True)
        assert second.cfg.seed == first.cfg.seed

    def test_already_finished(self, folder):
        out = folder.path / "out"
        self.run(config(folder), out, 40)
        before = contents(out)
        result = invoke("run", folder.path / "config.txt", "--out", out, "--steps", 40, "--resume")
        assert result.exit_code == 0
        assert "resumed at step 40" in result.output
        assert contents(out) == before

    def test_frames_leave_the_files_of_the_run_alone(self, folder):
        """Those made afterwards have other names, and even --force overwrites none of the run's."""
        path, out = config(folder, TextOutputs="XYZ"), folder.path / "out"
        self.run(path, out, 20)
        text = (out / "cell.xyz").read_bytes()
        result = invoke("frames", out, "--format", "xyz")
        assert result.exit_code == 0, result.output
        assert (out / "cell.extxyz").is_file()
        result = invoke("frames", out, out / "cell.xyz", "--force")
        assert result.exit_code == 1
        assert "is what the run there goes on with; give another name" in result.output
        result = invoke("frames", out, out / "frames", "--format", "ply", "--force")
        assert "is what the run there goes on with; give another name" in result.output
        assert (out / "cell.xyz").read_bytes() == text
        self.run(path, out, 40, resume=True)

    def test_nothing_to_resume_starts(self, folder):
        out = folder.path / "out"
        arguments = ("--platform", "Reference", "--out", out, "--steps", 20, "--resume")
        assert invoke("run", config(folder), *arguments).exit_code == 0
        assert "cell.xyz" in contents(out)


class TestRefusals:
    @pytest.fixture
    def out(self, folder):
        out = folder.path / "out"
        config(folder)
        Run(folder.path / "config.txt", out, platform="Reference").close()
        return out

    def refused(self, folder, out, *more):
        before = contents(out)
        result = invoke("run", folder.path / "config.txt", "--out", out, *more)
        assert result.exit_code == 1
        assert contents(out) == before
        return result.output

    def test_a_folder_with_a_run(self, folder, out):
        text = self.refused(folder, out, "--platform", "Reference")
        assert "is not empty; go on with the run in it with --resume" in text

    def test_a_folder_with_something_else(self, folder):
        (folder.path / "notes.txt").write_text("mine")
        config(folder)
        assert "is not empty" in self.refused(folder, folder.path)

    def test_another_system(self, folder, out):
        config(folder, MeanCurvatureCoeff="21")
        assert "has changed since" in self.refused(folder, out, "--resume")

    def test_another_integrator(self, folder, out):
        config(folder, integrator="V")
        assert "has changed since" in self.refused(folder, out, "--resume")

    def test_other_outputs(self, folder, out):
        config(folder, TextOutputs="XYZ")
        assert "cannot resume: the run wrote the files" in self.refused(folder, out, "--resume")

    def test_another_seed(self, folder, out):
        text = self.refused(folder, out, "--resume", "--seed", 6)
        assert "the run has the seed 5; leave out --seed" in text

    def test_another_seed_in_the_file(self, folder, out):
        config(folder, Seed="6")
        text = self.refused(folder, out, "--resume")
        assert "config.txt: seed is 6, and was 5 when the run began; change it back" in text

    @pytest.mark.parametrize(
        ("option", "before"),
        [
            (["--frames", "gsd"], "frames = none, not gsd; leave out --frames"),
            (["--no-xtc"], "xtc = True, not False; leave out --no-xtc"),
            (["--flips", 0.1], "flips = 0.0, not 0.1; leave out --flips"),
            (["--vcm-compatible"], "vcm_compatible = False, not True; leave out --vcm-compatible"),
        ],
        ids=["frames", "xtc", "flips", "compatible"],
    )
    def test_other_options(self, folder, out, option, before):
        text = self.refused(folder, out, "--resume", *option)
        assert f"the run was begun with {before}: a run goes on as it began" in text

    def test_a_file_that_says_now_what_the_run_has(self, folder):
        """A drawn seed, and a platform and frames that were options, written down afterwards."""
        path, out = folder.path / "own.toml", folder.path / "out"
        text = "simulation.duration = 1\nintegrator.time_step = 0.02\noutput.interval = 0.2\n"
        vesicle = "[[vesicle]]\nmesh = { icosphere = 2, radius = 30 }\n"
        path.write_text(text + vesicle)
        begun = Run(path, out, platform="Reference", frames="obj")
        begun.advance(20)
        begun.close()
        text += f'simulation.seed = {begun.cfg.seed}\nsimulation.platform = "Reference"\n'
        path.write_text(text + 'output.frames = "obj"\n' + vesicle)
        again = Run(path, out, resume=True)
        assert again.advance(40)
        again.close()
        path.write_text(text + 'output.frames = "stl"\n' + vesicle)
        with pytest.raises(RunError, match="frames is stl, and was none when the run began"):
            Run(path, out, resume=True)

    def test_options_without_which_the_file_cannot_be_read(self, folder):
        path, out = config(folder), folder.path / "out"
        path.write_text(path.read_text().replace("Seed 5", "Seed 5\nNoSuchKey 3"))
        arguments = ("--platform", "Reference", "--out", out, "--steps")
        result = invoke("run", path, *arguments, 20, "--ignore-unknown")
        assert result.exit_code == 0, result.output
        result = invoke("run", path, "--out", out, "--resume", "--steps", 40)
        assert result.exit_code == 0, result.output

    def test_the_same_options_again(self, folder, out):
        options = ("--resume", "--frames", "none", "--xtc", "--flips", 0, "--seed", 5)
        result = invoke(
            "run", folder.path / "config.txt", "--out", out, "--steps", 20, *options,
            "--platform", "Reference",
        )  # fmt: skip
        assert result.exit_code == 0, result.output

    def test_another_platform(self, folder, out):
        text = self.refused(folder, out, "--resume", "--platform", "CPU")
        assert "the run is on the platform Reference" in text

    def test_a_file_that_was_cut(self, folder, out):
        with (out / "cell.csv").open("r+b") as file:
            file.truncate(10)
        assert "bytes at the checkpoint and has 10 now" in self.refused(folder, out, "--resume")

    def test_a_run_that_goes_on(self, folder):
        path, out = config(folder), folder.path / "out"
        job = Run(path, out, platform="Reference")
        match = rf"another process is running in {out}; wait until it has ended, or give another"
        with pytest.raises(RunError, match=match):
            Run(path, out, resume=True)
        job.close()
        Run(path, out, resume=True).close()

    def test_bad_configuration(self, folder):
        config(folder, NodeMass="heavy")
        result = invoke("run", folder.path / "config.txt")
        assert result.exit_code == 1
        assert "config.txt:14: key NodeMass: expected a number, got 'heavy'" in result.output
        assert "Traceback" not in result.output

    def test_unknown_platform(self, folder):
        result = invoke("run", config(folder), "--platform", "Abacus")
        assert result.exit_code == 2
        assert "no platform 'Abacus'; this OpenMM has" in result.output

    def test_breakdown_keeps_the_last_checkpoint(self, folder):
        path = config(folder, StepSizeInFs="2e6", ReportIntervalInFs="2e6", integrator="V")
        out = folder.path / "out"
        result = invoke("run", path, "--platform", "Reference", "--out", out, "--steps", 1000)
        assert result.exit_code == 1
        assert "the simulation broke down" in result.output
        assert "Time step: 2000 ps is TOO LONG" in result.output
        again = Run(path, out, resume=True)
        assert np.isfinite(again.frame.potential)
        again.close()


class TestKill:
    """The command as a process, stopped from outside."""

    # More than it makes before it is stopped, on any machine.
    ENDLESS = 10**9

    # Reports so rare that a signal comes between two of them, of 2 fs.
    INTERVAL = 700

    @pytest.fixture
    def start(self):
        """A function that starts the command; no process outlives the test."""
        with contextlib.ExitStack() as stack:

            def start(path, out, steps, *more):
                arguments = ["run", path, "--platform", "Reference", "--out", out, "--steps", steps]
                process = subprocess.Popen(
                    [sys.executable, "-m", "openmmhelfrich", *map(str, [*arguments, *more])],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    text=True,
                )
                stack.enter_context(process)
                stack.callback(process.kill)
                return process

            yield start

    def wait_for_frames(self, process, out, count):
        """Until the run has written more frames than that."""
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline:
            if self.frames(out) > count:
                return
            assert process.poll() is None, process.communicate()[0]
            time.sleep(0.005)
        raise AssertionError("no frames were written")

    @staticmethod
    def frames(out):
        """The number of frames so far."""
        try:
            return (out / "cell.csv").read_text().count("\n") - 1
        except FileNotFoundError:
            return 0

    @pytest.fixture
    def path(self, folder):
        return config(folder, StepSizeInFs="2", ReportIntervalInFs=str(2 * self.INTERVAL))

    @staticmethod
    def finish(start, path, out, steps):
        process = start(path, out, steps, "--resume")
        output, _ = process.communicate(timeout=120)
        assert process.returncode == 0, output
        return output

    def unbroken(self, path, folder, steps):
        """The files of a run of so many steps that nobody stops."""
        out = folder.path / "unbroken"
        job = Run(path, out, platform="Reference")
        assert job.advance(steps)
        job.close()
        return results(out)

    def test_sigkill(self, start, path, folder):
        out = folder.path / "out"
        process = start(path, out, self.ENDLESS, "--checkpoint", 0)
        self.wait_for_frames(process, out, 3)
        process.kill()
        process.communicate()
        steps = (self.frames(out) + 3) * self.INTERVAL
        output = self.finish(start, path, out, steps)
        assert 0 < int(re.search(r"resumed at step (\d+)", output)[1]) < steps
        assert results(out) == self.unbroken(path, folder, steps)

    @pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
    def test_interrupt(self, start, path, folder, number):
        out = folder.path / "out"
        process = start(path, out, self.ENDLESS)
        self.wait_for_frames(process, out, 1)
        process.send_signal(number)
        output, _ = process.communicate(timeout=120)
        assert process.returncode == 128 + number
        stopped = int(re.search(r"Interrupted at step (\d+)\. Go on with --resume", output)[1])
        steps = stopped + 3 * self.INTERVAL
        # Nothing that was done is done again, although no checkpoint was due.
        assert f"resumed at step {stopped}" in self.finish(start, path, out, steps)
        assert results(out) == self.unbroken(path, folder, steps)

    def test_a_program_that_calls_it_has_its_signals_back(self, path, folder):
        numbers = (signal.SIGINT, signal.SIGTERM)
        before = [signal.getsignal(number) for number in numbers]
        # The second time the folder is not empty.
        for code in (0, 1):
            result = invoke("run", path, "--out", folder.path / "out", "--steps", 2)
            assert result.exit_code == code
            assert [signal.getsignal(number) for number in numbers] == before


class TestInfo:
    def test_paper(self, shared):
        result = invoke("info", shared / "vcm" / "SM_AVh_GKB_V.txt", "--platform", "Reference")
        assert result.exit_code == 0, result.output
        text = result.output
        assert "Verlet, 50000 steps of 0.2 ps: 10000 ps at 300 K" in text
        assert "area 12528245 nm², volume 4.1658149e+09 nm³, reduced volume 0.9991" in text
        assert "orientation mended: 1000 triangles" in text
        numbers = {
            "Ξ": float(re.search(r"Ξ = ([\d.]+) \(d = 20 nm\)", text)[1]),
            "τ_h": float(re.search(r"τ_h = ([\d.]+) ps", text)[1]),
            "τ_2": float(re.search(r"τ_2 = ([\d.]+) ps", text)[1]),
            "√Ξ τ": float(re.search(r"√Ξ τ = ([\d.]+) ps\)", text)[1]),
        }
        # The paper's numbers, to the digits that it gives.
        assert numbers["Ξ"] == pytest.approx(0.037, abs=5e-4)
        assert numbers["τ_h"] == pytest.approx(45, abs=0.5)
        assert numbers["τ_2"] == pytest.approx(11460, rel=5e-3)
        assert numbers["√Ξ τ"] == pytest.approx(10.8, abs=0.11)
        assert "time step 0.2 ps is within the bound 0.1 √Ξ τ = 1.07 ps" in text
        assert re.search(r"bending +1254\.7615", text)
        assert re.search(r"Expected run time: [\d.]+ (s|min|h) on Reference", text)

    def test_composite(self, shared):
        result = invoke("info", shared / "vcm" / "SM_RBC_C0.006.txt", "--no-measure")
        assert re.findall("^Warning: .*: skipped 'eWCA", result.output, flags=re.M)
        assert "sticky: 92 bonds to other membranes" in result.output
        assert "Expected run time" not in result.output

    def test_time_step_that_is_too_long(self, folder):
        result = invoke("info", config(folder, StepSizeInFs="50000"), "--no-measure")
        assert "time step 50 ps is ABOVE the bound" in result.output

    def test_help_lists_the_commands(self):
        result = invoke("--help")
        assert result.exit_code == 0
        for name in ("run", "info"):
            assert re.search(rf"^  {name} +\S", result.output, flags=re.M)
            assert invoke(name, "--help").exit_code == 0


def test_energies_are_those_of_the_context(folder):
    """The per-term energies that are reported add up to the energy of the System."""
    cfg = vcm.read(config(folder))
    made = context(cfg, cfg.positions * 1.1)
    total = made.getState(getEnergy=True).getPotentialEnergy()._value
    assert sum(cfg.energies(made).values()) == pytest.approx(total, rel=1e-12)
