"""Runs of the command line in a folder, for the tests of its files and its checkpoints."""

from __future__ import annotations

import re

from click.testing import CliRunner
from openmmhelfrich.cli import main
from openmmhelfrich.simulation.runner import Run

GENERAL = """ProjectName cell
SimulationTimeInPs 4
StepSizeInFs 20
ReportIntervalInFs 400
Integrator {integrator}
FrictionIninvertPs 0.1
setVelocitiesToTemperature true
Seed 5
TextOutputs PSF XYZ PDB VEL FORCE CURVE
BinOutputs XYZ VEL TPK"""
MEMBRANE = """NodeMass 50
MeanCurvatureModel Julicher1996
MeanCurvatureCoeff 20
SurfaceConstraint GWCAH 0.3
SurfaceConstraintCoeff 40
VolumeConstraint G
VolumeConstraintCoeff 40"""

#: A membrane that flows, and beside it one that keeps its neighbours.
FLUID_AND_SOLID = """
[simulation]
duration = {duration}
seed = 3{platform}
[integrator]
time_step = 0.4
[output]
interval = {interval}
frames = "{frames}"
[[vesicle]]
name = "fluid"
flips = {flips}
[vesicle.mesh]
random = 132
radius = 400
[[vesicle]]
name = "solid"
[vesicle.mesh]
random = 92
radius = 300
translate = [2000, 0, 0]
"""


def fluid_and_solid(duration, interval, frames, flips=0.05, platform=None):
    """The TOML of these two."""
    platform = f'\nplatform = "{platform}"' if platform else ""
    return FLUID_AND_SOLID.format(
        duration=duration, interval=interval, frames=frames, flips=flips, platform=platform
    )


def config(folder, integrator="LM", more="", **replaced):
    """A configuration in a `Folder`, with other words after some keys."""
    text = folder.text(MEMBRANE, GENERAL.format(integrator=integrator), more=more)
    for key, words in replaced.items():
        text = re.sub(rf"^{key} .*$", f"{key} {words}", text, flags=re.M)
    return folder.write(text)


def invoke(*arguments):
    """The command line with these words."""
    return CliRunner().invoke(main, [str(word) for word in arguments])


def contents(folder):
    """Every file below a folder, by name."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def results(folder):
    """What must not depend on whether and when a run was stopped: not when it was saved before."""
    found = contents(folder)
    return {
        name: data
        for name, data in found.items()
        if name != "checkpoint-previous.bin" and not name.endswith(".new")
    }


def killed_after(config, out, end: int) -> None:
    """A run as after kill -9: checkpoints of steps 10 and 17, and frames of all up to `end`."""
    for number, step in enumerate((10, 17)):
        job = Run(config, out, resume=number > 0)
        assert job.advance(step)
        job.close()
    job = Run(config, out, resume=True, checkpoint_seconds=1e9)
    job.save = lambda: None
    assert job.advance(end)
    job.close()
