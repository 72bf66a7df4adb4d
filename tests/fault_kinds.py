"""The runs that `faults.py` disturbs: how they begin and go on, and what must not depend on faults.

- toml: a file of ours, with flips, viscosity, frames in VTKHDF, a trajectory and CSV
- vcm: a configuration of VCM with all of its outputs
- sweep: points of `openmmhelfrich.sweep`
- reporters: a Simulation with reporters of ours that append, from checkpoints of its own

Each works in a process of its own, from inputs that are there to a folder of outputs.
"""

import contextlib
import io
import os
import shutil
import signal
import sys
import time
import traceback
from pathlib import Path

import h5py
import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm.app import Simulation, Topology
from openmmhelfrich._writing import replace
from openmmhelfrich.cli import main
from openmmhelfrich.sweep import SweepError, sweep

sys.path.append(str(Path(__file__).resolve().parent / "python"))
from run_files import GENERAL, MEMBRANE, fluid_and_solid, results

STEPS, INTERVAL, POINTS = 4000, 50, 40
# A process that does not end by itself.
TOO_LONG = 300


def prepare(inputs):
    """Write what the runs read."""
    text = fluid_and_solid(320, 16, "vtkhdf", platform="Helfrich")
    text = text.replace("flips = 0.05", "flips = 0.05\nviscosity = 1e-3")
    (inputs / "run.toml").write_text(text, encoding="utf-8")
    helfrich.Mesh.icosphere(2, 300.0).write(inputs / "mesh.ply")
    general = GENERAL.format(integrator="LM").replace("TimeInPs 4", "TimeInPs 60")
    (inputs / "run.txt").write_text(
        f"-GeneralParameters\n{general}\n-Membrane 0\nMeshFile mesh.ply\n{MEMBRANE}\n",
        encoding="utf-8",
    )


def toml(inputs, out, *options):
    """A membrane that flows beside one that does not."""
    _command(inputs / "run.toml", out, *options)


def vcm(inputs, out, *options):
    """A configuration in VCM's language."""
    _command(inputs / "run.txt", out, *options)


def _command(config, out, *options):
    # A copied name, because click may end the process.
    words = ["run", config, "--out", out, "--checkpoint", 0.05, *(options or ("--resume",))]
    main(args=[str(word) for word in words], prog_name="openmm-helfrich")


def sweep_(inputs, out, scheduler=None, workers=0):
    """Points of a sweep, one after another unless there are workers."""
    out.mkdir(exist_ok=True)
    points = [{"x": x, "log": str(inputs / out.parent.name)} for x in range(POINTS)]
    cache = out / "cache"
    found = sweep(slow_square, points, cache=cache, scheduler=scheduler, workers=workers)
    text = "".join(f"{row['square']} {row['array'].sum()}\n" for row in found)
    replace(out / "squares.txt", text.encode())


def slow_square(x, log):
    """A result, and a line in a file that says who computed it."""
    time.sleep(0.02)
    with contextlib.suppress(OSError), Path(log).open("a", encoding="utf-8") as file:
        file.write(f"{x} {os.getpid()}\n")
    return {"square": x**2, "array": np.arange(100.0) * x}


def reporters(inputs, out):
    """A Simulation, its checkpoints, and files that grow."""
    out.mkdir(exist_ok=True)
    mesh = helfrich.Mesh.random_sphere(92, 300.0, seed=1)
    vesicle = helfrich.Vesicle(mesh, flips={"attemptsPerEdge": 0.02, "randomNumberSeed": 3})
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, 0.4)
    integrator.setRandomNumberSeed(2)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    simulation = Simulation(Topology(), vesicle.system(), integrator, platform)
    simulation.context.setPositions(mesh.vertices)
    simulation.context.setVelocitiesToTemperature(300, 1)
    saved = out / "saved.chk"
    begun = saved.exists()
    if begun:
        simulation.loadCheckpoint(str(saved))
    files = (
        helfrich.ModeReporter(out / "modes.csv", INTERVAL, mesh, 3, append=begun),
        helfrich.VTKHDFReporter(out / "frames.vtkhdf", INTERVAL, mesh, append=begun),
        helfrich.MembraneReporter(out / "shape.h5", INTERVAL, mesh, append=begun),
    )
    simulation.reporters.extend(files)
    if not begun:
        replace(saved, simulation.context.createCheckpoint())
    while simulation.currentStep < STEPS:
        simulation.step(4 * INTERVAL)
        replace(saved, simulation.context.createCheckpoint())


KINDS = {"toml": toml, "vcm": vcm, "sweep": sweep_, "reporters": reporters}


class Process:
    """A run at work, beside this process.

    Parameters
    ----------
    work : callable
    log : Path
        What it says goes there.
    """

    def __init__(self, work, log):
        sys.stdout.flush()
        self._log = log
        # A signal may come before there is anything to say.
        log.write_text("", encoding="utf-8")
        self.pid = os.fork()
        if self.pid == 0:
            status = 1
            # A second Ctrl-C may come at any place.
            try:
                status = _work(work, log)
            finally:
                os._exit(status)
        self._status = None

    def kill(self, number=signal.SIGKILL):
        """Send a signal, if it has not ended."""
        if not self.ended():
            os.kill(self.pid, number)

    def ended(self):
        """Whether it has."""
        if self._status is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            self._status = os.waitstatus_to_exitcode(status) if pid else None
        return self._status is not None

    def wait(self):
        """Its status at the end, negative for a signal, and all that it said."""
        limit = time.monotonic() + TOO_LONG
        while not self.ended():
            if time.monotonic() > limit:
                self.kill()
                raise RuntimeError(f"a run did not end within {TOO_LONG} s; see {self._log}")
            time.sleep(0.005)
        return self._status, self._log.read_text(encoding="utf-8")


def _work(work, log):
    """Work, in a process of its own; returns its status."""
    with log.open("w", encoding="utf-8") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    # Not what pytest has put in their places.
    for number, name in ((1, "stdout"), (2, "stderr")):
        raw = io.FileIO(number, "w", closefd=False)
        setattr(sys, name, io.TextIOWrapper(raw, encoding="utf-8", write_through=True))
    try:
        work()
        status = 0
    except SystemExit as reason:
        status = reason.code or 0
    except KeyboardInterrupt:
        status = 128 + signal.SIGINT
    except (OSError, ValueError, SweepError) as reason:
        # Of programs in Python; the command line has caught them.
        print(f"{type(reason).__name__}: {reason}", file=sys.stderr)
        status = 1
    except BaseException:
        traceback.print_exc()
        status = 1
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    return status


def everything(out):
    """All files; of HDF5 of reporters what is in them, since a row that was cut off may leave a
    gap, and of stored results all but the time that they took.
    """
    found = results(out)
    for name in found:
        if name.endswith(".npz"):
            found[name] = _stored(out / name)
        if name in ("frames.vtkhdf", "shape.h5"):
            found[name] = {}

            def visit(path, item, into=found[name]):
                into[path] = item[()].tobytes() if isinstance(item, h5py.Dataset) else ""

            with h5py.File(out / name) as file:
                file.visititems(visit)
    # Their names say where the log was.
    stored = sorted(repr(found.pop(name)) for name in list(found) if name.endswith(".npz"))
    return found | {"stored": stored}


def _stored(path):
    with np.load(path) as file:
        text = str(file["json"])
        return text[text.index('"result"') :].split('"seconds"')[0], file["array"].tobytes()


def differences(one, other):
    """Names of files that differ."""
    left, right = everything(one), everything(other)
    return sorted(name for name in left.keys() | right.keys() if left.get(name) != right.get(name))


def remove(folder):
    """Remove a folder, or what is there of it."""
    shutil.rmtree(folder, ignore_errors=True)
