"""Checkpoints of runs: missing, damaged, foreign, and kills while one is being written."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import openmm
import pytest
from openmmhelfrich import Mesh
from openmmhelfrich._blocks import Block, pack, unpack
from openmmhelfrich.simulation import runner
from openmmhelfrich.simulation.runner import Run, RunError
from run_files import config, contents, invoke, results
from vcm_files import Folder

LAST, PREVIOUS = "checkpoint.bin", "checkpoint-previous.bin"
# Reports are every 20 steps.
END = 100


@pytest.fixture
def folder(tmp_path, lumpy):
    return Folder(tmp_path, lumpy)


def run(path, out, last_step, **options):
    job = Run(path, out, platform="Reference", **options)
    try:
        assert job.advance(last_step)
    finally:
        job.close()


@pytest.fixture
def path(folder):
    return config(folder)


@pytest.fixture
def out(folder, path):
    """A run of 60 steps whose last checkpoint but one is of step 40."""
    out = folder.path / "out"
    run(path, out, 40)
    run(path, out, 60, resume=True)
    return out


@pytest.fixture(scope="module")
def whole(tmp_path_factory, lumpy):
    """The files of a run that nothing happens to."""
    folder = Folder(tmp_path_factory.mktemp("whole"), lumpy)
    run(config(folder), folder.path / "out", END)
    return results(folder.path / "out")


def refused(path, out, *options, exit_code=1):
    """What the command says when it refuses, with nothing changed."""
    before = contents(out)
    result = invoke("run", path, "--out", out, "--steps", END, *options)
    assert result.exit_code == exit_code, result.output
    assert contents(out) == before
    lines = result.output.splitlines()
    assert len([line for line in lines if line.startswith("Error: ")]) == 1
    assert "Traceback" not in result.output
    return lines[-1]


class TestMissing:
    def test_is_refused_and_the_one_before_offered(self, path, out, whole):
        (out / LAST).unlink()
        text = refused(path, out, "--resume")
        assert f"{out / LAST} is not there; {PREVIOUS} is whole: go on from step 40 with" in text
        assert text.endswith("--resume-previous")
        result = invoke("run", path, "--out", out, "--steps", END, "--resume-previous")
        assert result.exit_code == 0, result.output
        assert "resumed at step 40" in result.output
        assert results(out) == whole

    def test_is_refused_where_there_are_outputs(self, path, out):
        (out / LAST).unlink()
        (out / PREVIOUS).unlink()
        text = refused(path, out, "--resume", "--steps", 4)
        assert f"{out} is not empty, and has no {LAST} to go on from" in text
        assert "is not empty" in refused(path, out)
        assert "is not empty" in refused(path, out, "--resume-previous")

    def test_is_refused_with_another_mesh_too(self, folder, path, out):
        (out / LAST).unlink()
        (out / PREVIOUS).unlink()
        Mesh.read(folder.path / "mesh.ply").scaled(1.1).write(folder.path / "mesh.ply")
        assert "would be overwritten" in refused(path, out, "--resume")

    def test_somebody_elses_folder(self, path, folder):
        other = folder.path / "other"
        other.mkdir()
        (other / "notes.txt").write_text("mine")
        assert "is not empty" in refused(path, other, "--resume")

    def test_an_empty_folder_starts(self, path, folder, whole):
        other = folder.path / "other"
        other.mkdir()
        run(path, other, END, resume=True)
        assert results(other) == whole

    def test_the_one_before_is_missing(self, path, out):
        (out / PREVIOUS).unlink()
        text = refused(path, out, "--resume-previous")
        assert f"{PREVIOUS} is not there; {LAST} is whole: go on from step 60 with --resume" in text


class TestDamaged:
    def test_a_changed_byte(self, path, out):
        """Any byte: a sample of a hundred, ends of the parts among them."""
        data = (out / LAST).read_bytes()
        random = np.random.default_rng(3)
        for offset in {0, 8, 12, 20, 51, 52, len(data) - 1, *random.integers(0, len(data), 100)}:
            damaged = bytearray(data)
            damaged[offset] ^= 1 << int(random.integers(8))
            (out / LAST).write_bytes(damaged)
            with pytest.raises(RunError, match=rf"{LAST} is damaged.*--resume-previous"):
                Run(path, out, resume=True)

    @pytest.mark.parametrize("length", [0, 3, 30, 52, 1000, -1])
    def test_a_cut_file(self, path, out, length):
        data = (out / LAST).read_bytes()
        (out / LAST).write_bytes(data[:length])
        assert f"{out / LAST} is damaged" in refused(path, out, "--resume")

    def test_goes_on_from_the_one_before(self, path, out, whole):
        data = bytearray((out / LAST).read_bytes())
        data[1500] ^= 4
        (out / LAST).write_bytes(data)
        text = refused(path, out, "--resume")
        assert f"{LAST} is damaged: its contents do not have the checksum that it says" in text
        assert f"{PREVIOUS} is whole: go on from step 40 with --resume-previous" in text
        assert invoke("run", path, "--out", out, "--steps", 40, "--resume-previous").exit_code == 0
        # The run is whole again, and goes on without more ado.
        run(path, out, END, resume=True)
        assert results(out) == whole

    def test_both(self, path, out):
        for name in (LAST, PREVIOUS):
            (out / name).write_bytes((out / name).read_bytes()[:-1])
        text = refused(path, out, "--resume")
        assert f"{PREVIOUS} cannot be used either; give another folder with --out" in text

    def test_no_checkpoint_at_all(self, path, out):
        (out / LAST).write_bytes(b"\0\1\2")
        assert "no file of openmm-helfrich" in refused(path, out, "--resume")

    def test_without_a_checksum(self, path, out):
        """As the first versions wrote them."""
        header = {"format": "openmm-helfrich checkpoint 1", "step": 60, "platform": "Reference"}
        (out / LAST).write_bytes(json.dumps(header).encode() + b"\n" + bytes(100))
        assert "was written before checkpoints had checksums" in refused(path, out, "--resume")


class TestForeign:
    """Checkpoints that are whole, but not of this run."""

    @pytest.fixture
    def swap(self, folder, out, lumpy):
        """A function that runs another configuration, and puts its checkpoint in our folder."""

        def swap(integrator="LM", mesh=None, **replaced):
            other = folder.path / "other"
            other.mkdir()
            made = Folder(other, mesh or lumpy)
            run(config(made, integrator, **replaced), other / "out", 60)
            (out / LAST).write_bytes((other / "out" / LAST).read_bytes())

        return swap

    def test_another_number_of_particles(self, path, out, swap):
        swap(mesh=Mesh.icosphere(3, 3.0))
        assert "a run of another system or integrator" in refused(path, out, "--resume")

    def test_another_system_of_as_many(self, path, out, swap):
        swap(MeanCurvatureCoeff="21")
        assert "a run of another system or integrator" in refused(path, out, "--resume")

    def test_another_integrator(self, path, out, swap):
        swap(integrator="V")
        assert "a run of another system or integrator" in refused(path, out, "--resume")

    def test_other_outputs(self, path, out, swap):
        swap(TextOutputs="XYZ")
        assert "the run wrote the files" in refused(path, out, "--resume")

    def test_another_seed(self, path, out, whole, swap):
        """System and integrator are the same; outputs tell the runs apart."""
        run(path, out, 80, resume=True)
        own = (out / LAST).read_bytes()
        swap(Seed=6)
        text = refused(path, out, "--resume")
        assert f"{out}/cell." in text and "is not the file that the checkpoint was saved" in text
        assert text.endswith("go on from step 60 with --resume-previous")
        (out / PREVIOUS).unlink()
        assert "begin anew in another folder with --out" in refused(path, out, "--resume")
        (out / LAST).write_bytes(own)
        run(path, out, END, resume=True)
        assert results(out) == whole

    def test_an_output_that_was_cut(self, path, out, whole):
        size = (out / "cell.csv").stat().st_size
        os.truncate(out / "cell.csv", size - 5)
        text = refused(path, out, "--resume")
        assert f"{out / 'cell.csv'} had {size} bytes at the checkpoint and has {size - 5}" in text
        assert text.endswith("go on from step 40 with --resume-previous")
        run(path, out, END, resume_previous=True)
        assert results(out) == whole

    def test_an_output_that_was_cut_short(self, path, out):
        os.truncate(out / "cell.csv", 10)
        text = refused(path, out, "--resume")
        assert text.endswith("bring the file back, or begin anew in another folder with --out")

    def test_without_digests(self, path, out, whole):
        """Earlier versions saved none."""
        blocks = unpack((out / LAST).read_bytes(), "run", {"run": 1, "openmm": 1})
        outputs = blocks["run"].value["outputs"]
        assert set(outputs.pop("ends")) == set(outputs["sizes"])
        self.repack(out, run={"outputs": outputs})
        run(path, out, END, resume=True)
        assert results(out) == whole

    def repack(self, out, **changed):
        """The checkpoint with other values, and a checksum that is right."""
        blocks = unpack((out / LAST).read_bytes(), "run", {"run": 1, "openmm": 1})
        header = {**blocks["run"].value, **changed.pop("run", {})}
        made = {**blocks, "run": Block(header), **changed}
        (out / LAST).write_bytes(pack("run", made))

    def test_a_state_of_other_particles(self, path, out, lumpy):
        """Right by all that this package knows, and refused by OpenMM."""
        system = openmm.System()
        system.addParticle(1)
        platform = openmm.Platform.getPlatformByName("Reference")
        context = openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
        context.setPositions([[0, 0, 0]])
        self.repack(out, openmm=Block(context.createCheckpoint()))
        text = refused(path, out, "--resume")
        assert f"OpenMM cannot go on from {out}" in text
        assert "wrong number of particles" in text

    def test_of_a_newer_version(self, path, out):
        self.repack(out, triangles=Block(np.zeros((2, 3), np.int32)))
        text = refused(path, out, "--resume")
        assert "has 'triangles' in version 1, of a newer openmm-helfrich" in text
        assert "--resume-previous" not in text

    def test_a_platform_that_is_not_here(self, path, out):
        self.repack(out, run={"platform": "Abacus"})
        text = refused(path, out, "--resume")
        assert "OpenMM cannot start on the platform Abacus of the checkpoint" in text
        assert "docs/troubleshooting.md" in text

    def test_the_platform_is_that_of_the_checkpoint(self, folder):
        path, out = config(folder), folder.path / "cpu"
        job = Run(path, out, platform="CPU")
        job.advance(20)
        job.close()
        text = refused(path, out, "--resume", "--platform", "Reference")
        assert "the run is on the platform CPU, whose checkpoints Reference cannot read" in text
        job = Run(path, out, resume=True)
        assert job.platform == "CPU"
        job.close()


# What is called, for which file, whether to die after it rather than before, whether the file
# is cut in the middle first, as if that were all that had been written.
POINTS = {
    "half of the new file is written": ("fsync", LAST + ".new", 0, 1),
    "the new file is written": ("fsync", LAST + ".new", 1, 0),
    "the old file has two names": ("link", PREVIOUS + ".new", 1, 0),
    "the one before is the old file": ("replace", PREVIOUS, 1, 0),
    "just before the new file takes its place": ("replace", LAST, 0, 0),
    "the new file has taken its place": ("replace", LAST, 1, 0),
}


class TestKilledWhileSaving:
    """SIGKILL at each point of writing a checkpoint: the run goes on as if nothing had happened.

    The process kills itself, where os.fsync, os.link or os.replace is called for a file of the
    checkpoint for the n-th time.
    """

    SCRIPT = """
import os, signal, sys

function, name, count, after, cut = sys.argv[1:6]
calls, original = 0, getattr(os, function)

def named(argument):
    if isinstance(argument, int):
        argument = os.readlink(f"/proc/self/fd/{argument}")
    return os.path.basename(argument) == name

def hooked(*arguments):
    global calls
    calls += named(arguments[-1])
    dying = calls == int(count)
    if dying and cut != "0":
        os.truncate(arguments[0], os.fstat(arguments[0]).st_size // 2)
    if dying and after == "0":
        os.kill(os.getpid(), signal.SIGKILL)
    result = original(*arguments)
    if dying:
        os.kill(os.getpid(), signal.SIGKILL)
    return result

setattr(os, function, hooked)
from openmmhelfrich.cli import main
main(sys.argv[6:])
"""

    # The first is that without outputs, which has nothing to keep; the second is of step 0.
    @pytest.mark.parametrize("count", [1, 2, 4])
    @pytest.mark.parametrize("point", POINTS)
    def test_goes_on(self, path, folder, whole, point, count):
        function, name, after, cut = POINTS[point]
        out = folder.path / "out"
        command = ["run", path, "--platform", "Reference", "--out", out, "--steps", END]
        killed = subprocess.run(
            [sys.executable, "-c", self.SCRIPT, function, name, str(count), str(after), str(cut)]
            + [str(word) for word in [*command, "--checkpoint", "0"]],
            capture_output=True,
            timeout=120,
        )
        assert killed.returncode == -signal.SIGKILL, killed.stderr
        run(path, out, END, resume=True)
        assert results(out) == whole
        assert not list(out.glob("*.new"))

    def test_a_start_that_was_killed_is_no_run(self, path, folder, whole):
        """Before the first checkpoint has its name there is nothing, and a plain run may begin."""
        out = folder.path / "out"
        out.mkdir()
        (out / ".lock").touch()
        (out / (LAST + ".new")).write_bytes(b"half")
        run(path, out, END)
        assert results(out) == whole


def test_a_folder_without_links(path, folder, whole, monkeypatch):
    """FAT and some file systems of networks have none; the one before is then a copy."""

    def refuse(*arguments, **options):
        raise PermissionError(1, "Operation not permitted")

    out = folder.path / "out"
    monkeypatch.setattr(os, "link", refuse)
    run(path, out, 40)
    run(path, out, END, resume=True)
    assert results(out) == whole
    (out / LAST).write_bytes(b"")
    run(path, out, END, resume_previous=True)
    assert results(out) == whole


def test_a_run_that_ended_keeps_both(path, out):
    before = contents(out)
    run(path, out, 60, resume=True)
    assert contents(out) == before


def test_a_state_that_is_not_finite_leaves_an_empty_folder(path, folder, monkeypatch):
    def broken(*arguments):
        raise FloatingPointError("the energy is nan at step 0")

    out = folder.path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(runner, "take_frame", broken)
        with pytest.raises(RunError, match="broke down"):
            Run(path, out, platform="Reference")
    run(path, out, 20)
