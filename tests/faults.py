"""Runs that are killed at random moments and go on, beside runs that nothing happens to.

    python tests/faults.py [--kills 300] [--seed 1] [KIND …]

Each kind of run is done once in peace. Then it is done over and over, each time in a new folder:
begun, killed with SIGKILL at a random moment, resumed, killed again, until it has come to its end.
All its files must have the same bytes as those of the run in peace (VTKHDF files of reporters the
same contents). Kinds:

- toml: a file of ours, with flips, viscosity, frames in VTKHDF, a trajectory and CSV
- vcm: a configuration of VCM with all of its outputs
- sweep: points of `openmmhelfrich.sweep`
- reporters: a Simulation with reporters of ours that append, from checkpoints of its own

Ends with 1 if any run differs, and names its files; the folder stays.
"""

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path

import h5py
import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm.app import Simulation, Topology
from openmmhelfrich.sweep import sweep
from openmmhelfrich.vcm.runner import Run

sys.path.append(str(Path(__file__).resolve().parent / "python"))
from run_files import GENERAL, MEMBRANE, fluid_and_solid, results

STEPS, INTERVAL = 4000, 50


def toml(folder):
    """A membrane that flows beside one that does not."""
    text = fluid_and_solid(320, 16, "vtkhdf", platform="Helfrich")
    text = text.replace("flips = 0.05", "flips = 0.05\nviscosity = 1e-3")
    _run(folder, "config.toml", text)


def vcm(folder):
    """A configuration in VCM's language."""
    helfrich.Mesh.icosphere(2, 300.0).write(folder / "mesh.ply")
    general = GENERAL.format(integrator="LM").replace("TimeInPs 4", "TimeInPs 60")
    _run(
        folder,
        "config.txt",
        f"-GeneralParameters\n{general}\n-Membrane 0\nMeshFile mesh.ply\n{MEMBRANE}\n",
    )


def _run(folder, name, text):
    path, out = folder / name, folder / "out"
    if not path.exists():
        new = path.with_suffix(".new")
        new.write_text(text, encoding="utf-8")
        new.rename(path)
    job = Run(path, out, resume=True, checkpoint_seconds=0.05)
    try:
        assert job.advance(job.cfg.num_steps)
    finally:
        job.close()


def sweep_(folder):
    """Points of a sweep, one after another."""
    points = [{"x": x} for x in range(40)]
    # Stored results have the time that they took.
    cache = folder.with_name(f"{folder.name}-cache")
    found = sweep(_slow_square, points, cache=cache, workers=0)
    np.savetxt(folder / "squares.txt", [[row["square"], *row["array"]] for row in found])


def _slow_square(x):
    time.sleep(0.02)
    return {"square": x**2, "array": np.arange(100.0) * x}


def reporters(folder):
    """A Simulation, its checkpoints, and files that grow."""
    mesh = helfrich.Mesh.random_sphere(92, 300.0, seed=1)
    vesicle = helfrich.Vesicle(mesh, flips={"attemptsPerEdge": 0.02, "randomNumberSeed": 3})
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, 0.4)
    integrator.setRandomNumberSeed(2)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    simulation = Simulation(Topology(), vesicle.system(), integrator, platform)
    simulation.context.setPositions(mesh.vertices)
    simulation.context.setVelocitiesToTemperature(300, 1)
    saved = folder / "saved.chk"
    begun = saved.exists()
    if begun:
        simulation.loadCheckpoint(str(saved))
    files = (
        helfrich.ModeReporter(folder / "modes.csv", INTERVAL, mesh, 3, append=begun),
        helfrich.VTKHDFReporter(folder / "frames.vtkhdf", INTERVAL, mesh, append=begun),
    )
    simulation.reporters.extend(files)
    if not begun:
        _save(simulation, saved)
    while simulation.currentStep < STEPS:
        simulation.step(4 * INTERVAL)
        _save(simulation, saved)


def _save(simulation, path):
    new = path.with_suffix(".new")
    with new.open("wb") as file:
        file.write(simulation.context.createCheckpoint())
    new.rename(path)


KINDS = {"toml": toml, "vcm": vcm, "sweep": sweep_, "reporters": reporters}


def attempt(work, folder, seconds=None):
    """Work in a process of its own, killed after a while; returns whether it came to its end."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            with (folder.parent / f"{folder.name}.log").open("a", encoding="utf-8") as log:
                os.dup2(log.fileno(), 1)
                os.dup2(log.fileno(), 2)
                try:
                    work(folder)
                    status = 0
                except BaseException:
                    traceback.print_exc()
        finally:
            os._exit(status)
    if seconds is not None:
        time.sleep(seconds)
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return False
    if status:
        log = (folder.parent / f"{folder.name}.log").read_text(encoding="utf-8")
        raise RuntimeError(f"a run could not go on, in {folder}:\n{log[-3000:]}")
    return True


def everything(folder):
    """All files; of HDF5 what is in them, since a row that was cut off may leave a gap."""
    found = results(folder)
    for name in found:
        if name.endswith(".vtkhdf") and folder.name.startswith("reporters"):
            found[name] = {}

            def visit(path, item, into=found[name]):
                into[path] = item[()].tobytes() if isinstance(item, h5py.Dataset) else ""

            with h5py.File(folder / name) as file:
                file.visititems(visit)
    return found


def differences(one, other):
    """Names of files that differ."""
    left, right = everything(one), everything(other)
    differ = {name for name in left.keys() | right.keys() if left.get(name) != right.get(name)}
    # When the last checkpoint but one was saved depends on when the run was stopped.
    return sorted(name for name in differ if not name.endswith("checkpoint-previous.bin"))


def torture(kind, kills, place, chance):
    """Kill runs of a kind so many times; returns how many runs there were, and what differs."""
    work = KINDS[kind]
    quiet = place / f"{kind}-quiet"
    quiet.mkdir()
    begin = time.monotonic()
    attempt(work, quiet)
    length = time.monotonic() - begin
    done = runs = 0
    wrong = []
    while done < kills:
        runs += 1
        folder = place / f"{kind}-{runs}"
        folder.mkdir()
        while not attempt(work, folder, chance.uniform(0, length)):
            done += 1
            if done % 100 == 0:
                print(f"  {kind}: {done} kills, {runs} runs", flush=True)
            # The last run comes to its end in peace.
            if done >= kills:
                attempt(work, folder)
                break
        found = differences(quiet, folder)
        wrong += [f"{folder}: {name}" for name in found]
        if not found:
            shutil.rmtree(folder)
    return runs, wrong


def main():
    """Kill, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"of {', '.join(KINDS)}")
    parser.add_argument("--kills", type=int, default=300, help="of each kind")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if unknown := set(options.kinds) - set(KINDS):
        parser.error(f"there is no kind {min(unknown)}; known are {', '.join(KINDS)}")
    place = Path(tempfile.mkdtemp(prefix="faults-"))
    rows, wrong = [], []
    for kind in options.kinds or KINDS:
        runs, found = torture(kind, options.kills, place, random.Random(f"{kind}{options.seed}"))
        rows.append((kind, options.kills, runs, len(found)))
        wrong += found
    print(f"{'kind':10}  {'kills':>6}  {'runs':>5}  {'files that differ':>17}")
    for kind, kills, runs, count in rows:
        print(f"{kind:10}  {kills:6}  {runs:5}  {count:17}")
    if wrong:
        print("\n".join(wrong))
        sys.exit(1)


if __name__ == "__main__":
    main()
