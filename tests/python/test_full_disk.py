"""Full disks and other refusals of the system: one line that names the file, and no harm."""

import errno
import os
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import openmm
import pytest
from openmmhelfrich import MembraneReporter, Mesh, Vesicle, analysis
from openmmhelfrich.simulation.runner import Run, RunError
from openmmhelfrich.sweep.cache import Cache
from openmmhelfrich.wireframe import write_lammps_data
from run_files import config, contents, invoke, results
from vcm_files import Folder

END = 100
COMMAND = [sys.executable, "-m", "openmmhelfrich"]


@pytest.fixture
def folder(tmp_path, lumpy):
    return Folder(tmp_path, lumpy)


@pytest.fixture
def small_disk(tmp_path):
    """A function that mounts a file system of so many bytes."""
    mounted = []

    def mount(size):
        at = tmp_path / "disk"
        at.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", at]
        try:
            done = subprocess.run(command, capture_output=True, text=True)
        except FileNotFoundError:
            pytest.skip("there is no mount")
        if done.returncode:
            pytest.skip(f"cannot mount a small disk: {done.stderr.strip()}")
        mounted.append(at)
        return at

    yield mount
    for at in mounted:
        subprocess.run(["umount", at], check=True)


def command(*words, limit=None, stdout=subprocess.PIPE):
    """The command line as a process whose files may have `limit` bytes: its status and errors."""

    def restrict():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = subprocess.run(
        [*COMMAND, *map(str, words)],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        timeout=120,
        preexec_fn=None if limit is None else restrict,
    )
    return done.returncode, done.stderr


def only_error(status, errors):
    """The one line of an error."""
    assert status == 1, errors
    assert errors.count("Error") == 1, errors
    assert "Traceback" not in errors
    assert "Exception ignored" not in errors
    return errors.splitlines()[-1]


def run_words(path, out, *more):
    return ("run", path, "--platform", "Reference", "--out", out, "--steps", END, *more)


@pytest.fixture(scope="module")
def whole(tmp_path_factory, lumpy):
    """The files of a run that has room for them."""
    folder = Folder(tmp_path_factory.mktemp("whole"), lumpy)
    return folder, finish(config(folder), folder.path / "out")


def finish(path, out):
    job = Run(path, out, platform="Reference", resume=True)
    assert job.advance(END)
    job.close()
    return results(out)


class TestRun:
    # Of the largest file in percent: in the first frame, in a later one.
    @pytest.mark.parametrize("part", [10, 40, 75, 99])
    def test_a_limit_on_the_size_of_files(self, folder, whole, part):
        path, out = config(folder), folder.path / "out"
        limit = part * max(map(len, whole[1].values())) // 100
        line = only_error(*command(*run_words(path, out), limit=limit))
        assert f"Error: {out}/" in line
        assert "File too large; raise the limit on the size of a file ('ulimit -f')" in line
        assert "with --resume" in line or "start again" in line
        assert finish(path, out) == whole[1]

    def test_a_limit_that_only_the_xtc_meets(self, folder):
        """OpenMM's writer says nothing, and a run would end well with frames missing."""
        path = config(folder, TextOutputs="N", BinOutputs="N")
        ends = {name: folder.path / name for name in ("unlimited", "limited")}
        expected = finish(path, ends["unlimited"])
        limit = max(len(expected["cell.xtc"]), len(expected["checkpoint.bin"]) + 100)
        out = ends["limited"]
        # Until the trajectory, of which every frame takes a tenth, is longer than that.
        line = only_error(*command(*run_words(path, out)[:-1], 1000, limit=limit))
        assert line.startswith(f"Error: {out}/cell.xtc: File too large; raise the limit")
        unlimited = ends["unlimited"]
        for where in (unlimited, out):
            job = Run(path, where, platform="Reference", resume=True)
            assert job.advance(1000)
            job.close()
        assert results(out) == results(unlimited)

    @pytest.mark.parametrize("size", ["16k", "32k", "48k"])
    def test_a_full_disk(self, folder, whole, small_disk, size):
        path, disk = config(folder), small_disk(size)
        out = disk / "out"
        line = only_error(*command(*run_words(path, out)))
        assert "No space left on device; free some space there" in line
        subprocess.run(["mount", "-o", "remount,size=10m", disk], check=True)
        assert finish(path, out) == whole[1]

    def test_a_disk_that_becomes_read_only(self, folder, whole, small_disk):
        path, disk = config(folder), small_disk("10m")
        out = disk / "out"
        job = Run(path, out, platform="Reference")
        assert job.advance(40)
        job.close()
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        line = only_error(*command(*run_words(path, out, "--resume")))
        assert "Read-only file system; make the file system writable" in line
        subprocess.run(["mount", "-o", "remount,rw", disk], check=True)
        assert finish(path, out) == whole[1]

    @pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EIO])
    @pytest.mark.parametrize("name", ["cell.xtc", "checkpoint.bin.new", "checkpoint-previous.bin"])
    def test_while_a_checkpoint_is_written(self, folder, whole, monkeypatch, number, name):
        """Each file that takes part refuses once: an output, the new checkpoint, the old one."""
        path, out = config(folder), folder.path / "out"
        job = Run(path, out, platform="Reference")
        job.advance(40)

        def refusing(original, name_of):
            def refuse(*arguments):
                if os.path.basename(name_of(arguments[-1])) == name:
                    raise OSError(number, os.strerror(number))
                return original(*arguments)

            return refuse

        with monkeypatch.context() as patch:
            patch.setattr(
                os,
                "fsync",
                refusing(os.fsync, lambda handle: os.readlink(f"/proc/self/fd/{handle}")),
            )
            patch.setattr(os, "replace", refusing(os.replace, os.fspath))
            with pytest.raises(RunError) as error:
                job.advance(60)
        job.close()
        assert str(error.value).startswith(f"{out}/")
        assert f": {os.strerror(number)}; " in str(error.value)
        assert str(error.value).endswith("then go on from step 40 with --resume")
        assert not list(out.glob("*.new"))
        assert finish(path, out) == whole[1]

    def test_a_folder_that_vanishes(self, folder, whole):
        path, out, away = config(folder), folder.path / "out", folder.path / "away"
        job = Run(path, out, platform="Reference")
        job.advance(40)
        out.rename(away)
        with pytest.raises(RunError, match=rf"{out}: the folder of the run has vanished"):
            job.advance(60)
        job.close()
        assert not out.exists()
        assert finish(path, away) == whole[1]

    def test_a_file_that_vanishes(self, folder):
        """It is not begun anew, without what it had."""
        path, out = config(folder), folder.path / "out"
        job = Run(path, out, platform="Reference")
        (out / "cell.xyz").unlink()
        with pytest.raises(RunError, match=r"cell.xyz: No such file or directory"):
            job.advance(40)
        job.close()
        assert not (out / "cell.xyz").exists()
        with pytest.raises(RunError, match="bytes at the checkpoint and has 0 now"):
            Run(path, out, resume=True)

    def test_a_place_where_no_folder_can_be(self, folder):
        path = config(folder)
        line = only_error(*command(*run_words(path, folder.path / "mesh.ply" / "out")))
        assert "mesh.ply/out: Not a directory; see whether its folder is there" in line
        line = only_error(*command(*run_words(path, "/proc/out")))
        assert "/proc/out: No such file or directory; see whether" in line

    def test_a_checkpoint_that_is_a_folder(self, folder):
        path, out = config(folder), folder.path / "out"
        Run(path, out, platform="Reference").close()
        (out / "checkpoint.bin").unlink()
        (out / "checkpoint.bin").mkdir()
        line = only_error(*command(*run_words(path, out, "--resume")))
        assert "checkpoint.bin cannot be read (Is a directory); checkpoint-previous.bin is" in line


EXTENSIONS = ["ply", "obj", "stl", "off", "vtk", "vtu", "msh"]


class TestMesh:
    @pytest.mark.parametrize(
        "extension",
        # One that the package writes itself, one that meshio does.
        [
            pytest.param(one, marks=[] if one in ("ply", "vtu") else [pytest.mark.long])
            for one in EXTENSIONS
        ],
    )
    def test_what_was_there_stays(self, tmp_path, extension):
        """A file that does not fit is not left in part, and does not cost the old one."""
        path = tmp_path / f"ball.{extension}"
        Mesh.icosphere(1, 10).write(path)
        before = contents(tmp_path)
        limit = path.stat().st_size + 100
        words = ("mesh", "icosphere", 12, path, "--force")
        line = only_error(*command(*words, limit=limit))
        assert line.startswith(f"Error: {path}: File too large; raise the limit")
        assert contents(tmp_path) == before
        words = ("mesh", "icosphere", 12, tmp_path / f"new.{extension}")
        only_error(*command(*words, limit=limit))
        assert contents(tmp_path) == before

    @pytest.mark.parametrize("extension", EXTENSIONS)
    def test_full(self, tmp_path, extension):
        path = tmp_path / f"full.{extension}"
        path.symlink_to("/dev/full")
        result = invoke("mesh", "icosphere", 3, path, "--force")
        line = only_error(result.exit_code, result.output)
        assert line == f"Error: {path}: No space left on device; free some space there"

    @pytest.mark.parametrize("extension", EXTENSIONS)
    def test_no_folder(self, tmp_path, extension):
        path = tmp_path / "none" / f"ball.{extension}"
        with pytest.raises(FileNotFoundError) as error:
            Mesh.icosphere(1, 10).write(path)
        assert error.value.filename == str(path)
        assert error.value.errno == errno.ENOENT

    def test_links_and_permissions_stay(self, tmp_path):
        path, link = tmp_path / "ball.ply", tmp_path / "link.ply"
        link.symlink_to(path)
        Mesh.icosphere(1, 10).write(path)
        path.chmod(0o640)
        Mesh.icosphere(2, 10).write(link)
        assert link.is_symlink()
        assert Mesh.read(path) == Mesh.icosphere(2, 10)
        assert path.stat().st_mode & 0o777 == 0o640
        assert len(contents(tmp_path)) == 2

    def test_permissions_of_a_new_file(self, tmp_path):
        (tmp_path / "plain").touch()
        Mesh.icosphere(1, 10).write(tmp_path / "ball.ply")
        modes = {entry.stat().st_mode for entry in tmp_path.iterdir()}
        assert len(modes) == 1


class TestOtherCommands:
    @pytest.fixture
    def modes(self, tmp_path):
        path = tmp_path / "modes.csv"
        names = [f"u_{l}_{m}" for l in range(4) for m in range(-l, l + 1)]
        random = np.random.default_rng(1)
        rows = [[n, float(n), *random.normal(size=16).tolist()] for n in range(64)]
        text = [["step", "time (ps)", *names], *rows]
        path.write_text("".join(",".join(map(str, row)) + "\n" for row in text))
        return path

    @pytest.mark.parametrize("option, name", [
        ("--csv", "table.csv"), ("--plot", "s.png"), ("--plot", "s.pdf"), ("--plot", "s.svg"),
    ])  # fmt: skip
    def test_spectrum(self, tmp_path, modes, option, name):
        path = tmp_path / name
        assert invoke("spectrum", modes, option, path).exit_code == 0
        assert path.stat().st_size > 100
        path.unlink()
        path.symlink_to("/dev/full")
        result = invoke("spectrum", modes, option, path)
        line = only_error(result.exit_code, result.output)
        assert line == f"Error: {path}: No space left on device; free some space there"

    def test_convert(self, tmp_path):
        system = openmm.System()
        mesh = Mesh.icosphere(1, 10)
        for _ in range(mesh.num_vertices):
            system.addParticle(1)
        volume = openmm.CustomCompoundBondForce(
            3, "x1*(y2*z3-z2*y3)+y1*(z2*x3-x2*z3)+z1*(x2*y3-y2*x3)"
        )
        for corners in mesh.triangles.tolist():
            volume.addBond(corners)
        total = openmm.CustomCVForce("0.5*k*(v/6-v0)^2/v0; k=2; v0=4000")
        total.addCollectiveVariable("v", volume)
        system.addForce(total)
        path, out = tmp_path / "system.xml", tmp_path / "out.xml"
        path.write_text(openmm.XmlSerializer.serialize(system))
        result = invoke("convert", path, "-o", out)
        assert result.exit_code == 0, result.output
        out.unlink()
        out.symlink_to("/dev/full")
        result = invoke("convert", path, "-o", out)
        line = only_error(result.exit_code, result.output)
        assert line == f"Error: {out}: No space left on device; free some space there"

    @pytest.mark.parametrize("name", ["info", "run", "compare"])
    def test_standard_output(self, folder, name):
        path = config(folder, TextOutputs="N", BinOutputs="N")
        more = {"info": ["--no-measure"], "compare": ["--seconds", "0"]}
        more["run"] = ["--platform", "Reference", "--out", folder.path / "out", "--steps", 20]
        with Path("/dev/full").open("w") as full:
            line = only_error(*command(name, path, *more[name], stdout=full))
        assert line == "Error: standard output: No space left on device; free some space there"


class TestFromPython:
    @pytest.fixture
    def simulation(self):
        mesh = Mesh.icosphere(2, 100)
        integrator = openmm.VerletIntegrator(0.01)
        made = Vesicle(mesh).simulation(integrator, "Reference")
        return mesh, made

    def test_a_reporter_goes_on_when_there_is_room(self, tmp_path, simulation, small_disk):
        mesh, made = simulation
        disk = small_disk("16k")
        path = disk / "table.csv"
        made.reporters.append(MembraneReporter(path, 1, mesh))
        with pytest.raises(OSError, match="No space left on device; free some space") as error:
            made.step(1000)
        assert error.value.errno == errno.ENOSPC
        assert error.value.filename == str(path)
        rows = len(analysis.read_table(path)["step"])
        assert path.read_bytes().endswith(b"\n")
        assert rows == made.currentStep - 1
        subprocess.run(["mount", "-o", "remount,size=10m", disk], check=True)
        made.step(5)
        steps = analysis.read_table(path)["step"].astype(int)
        # The row that found no room is missing, and no other is harmed.
        assert steps.tolist() == [*range(1, rows + 1), *range(rows + 2, rows + 7)]

    @pytest.mark.parametrize("suffix", ["csv", "h5"])
    def test_a_reporter_without_a_folder(self, tmp_path, simulation, suffix):
        mesh, made = simulation
        path = tmp_path / "none" / f"table.{suffix}"
        made.reporters.append(MembraneReporter(path, 1, mesh))
        with pytest.raises(FileNotFoundError, match="see whether its folder is there") as error:
            made.step(1)
        assert error.value.filename == str(path)

    def test_lammps(self, tmp_path, simulation):
        mesh, made = simulation
        path = tmp_path / "full.data"
        path.symlink_to("/dev/full")
        with pytest.raises(OSError, match="free some space") as error:
            write_lammps_data(path, made.topology, made.system, mesh.vertices)
        assert error.value.filename == str(path)

    def test_a_sweep(self, tmp_path):
        (tmp_path / "results").write_text("a file where the folder would be")
        with pytest.raises(OSError, match="see whether its folder") as error:
            Cache(tmp_path / "results").save("name", "key", {}, {"x": 1})
        assert str(tmp_path / "results") in error.value.filename


_WRITE_FRAMES = """
import os, sys
import numpy as np
from openmmhelfrich import Mesh, analysis

name, path = sys.argv[1:]
mesh = Mesh.random_sphere(1002, 400, seed=5)
free = os.statvfs(path).f_bavail
try:
    getattr(analysis, name)(path, np.stack([mesh.vertices] * 50), mesh)
except OSError as reason:
    print(reason)
print(os.statvfs(path).f_bavail - free)
"""


@pytest.mark.parametrize("kind", ["gsd", "extended_xyz"])
def test_frames_of_a_surface_on_a_full_disk(small_disk, kind):
    """The old file stays, and the space of the new one is free again.

    In a process of its own, since gsd leaves a file open that it could not finish.
    """
    if kind == "gsd":
        pytest.importorskip("gsd.hoomd", reason="gsd is not installed")
    path = small_disk("64k") / f"a.{kind[-3:]}"
    path.write_bytes(b"mine")
    words = [sys.executable, "-c", _WRITE_FRAMES, f"write_{kind}", path]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    said = f"[Errno 28] No space left on device; free some space there: '{path}'"
    assert done.stdout.splitlines() == [said, "0"], done.stderr
    assert path.read_bytes() == b"mine"
    assert os.listdir(path.parent) == [path.name]
