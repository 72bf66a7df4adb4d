"""Choosing what computes the forces, and what happens when the GPU that was chosen fails.

Faults are injected where the library meets wgpu, in processes of their own: a lost device is lost
to all Contexts of a process.
"""

from __future__ import annotations

import copy
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import openmm as mm
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmm import XmlSerializer
from openmmhelfrich.cli import main
from platforms import counting, require_gpu

# A vesicle of 162 vertices at 300 K; `fault` injects one, `counts` says what has computed so far.
PRELUDE = """
import sys
import openmm as mm
import openmmhelfrich as helfrich
from openmmhelfrich import _core

def fault(kind, after=0):
    assert _core.library().Helfrich_injectGpuFault(kind.encode(), after) == 0

mesh = helfrich.Mesh.icosphere(4, 500.0)
counts = helfrich.backend.evaluations

def simulation():
    system = helfrich.Vesicle(mesh).system()
    integrator = mm.VerletIntegrator(0.1)
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName("Reference"))
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    return context, integrator

def energy(context):
    state = context.getState(energy=True)
    return (state.getPotentialEnergy() + state.getKineticEnergy())._value
"""


def run(script: str, **environment: str) -> subprocess.CompletedProcess:
    """A Python process with what is above; it must end well."""
    result = subprocess.run(
        [sys.executable, "-c", PRELUDE + textwrap.dedent(script)],
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, **environment},
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result


def takeovers(result: subprocess.CompletedProcess) -> list[str]:
    """The lines that say that the processor takes over."""
    return [line for line in result.stderr.splitlines() if line.startswith("openmm-helfrich: ")]


@pytest.fixture
def gpu():
    require_gpu()


@pytest.fixture
def mesh() -> helfrich.Mesh:
    return helfrich.Mesh.icosphere(2, 100.0)


def context_of(*forces: mm.Force) -> mm.Context:
    system = mm.System()
    for _ in range(100):
        system.addParticle(50)
    for force in forces:
        system.addForce(force)
    platform = mm.Platform.getPlatformByName("Reference")
    return mm.Context(system, mm.VerletIntegrator(0.1), platform)


# --- names ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["GPU", "gpu:half", "cpu:double", "cuda", "gpu@x", ":single"])
def test_unknown_backends_are_refused(mesh, name: str):
    with pytest.raises(ValueError, match=r"set_backend: .*got '"):
        helfrich.set_backend(name)
    force = helfrich.BendingForce(mesh, 50)
    with pytest.raises(mm.OpenMMException, match=f'BendingForce: there is no backend "{name}"'):
        force.setBackend(name)
    assert force.getBackend() == ""


@pytest.mark.parametrize(
    "arguments",
    [
        {"backend": "cpu", "precision": "single"},
        {"backend": "cpu", "adapter": 0},
        {"backend": "gpu", "precision": "half"},
        {"backend": "gpu", "adapter": "NVIDIA"},
        {"backend": "gpu", "adapter": True},
    ],
)
def test_arguments_that_make_no_sense_are_refused(arguments):
    with pytest.raises(ValueError, match="set_backend: "):
        helfrich.set_backend(**arguments)


def test_a_missing_adapter_is_an_error():
    with pytest.raises(mm.OpenMMException, match="set_backend: there is no GPU to compute on"):
        helfrich.set_backend("gpu", adapter=99)


@pytest.mark.usefixtures("gpu", "backend_as_it_was")
def test_the_choice_can_be_read(mesh):
    helfrich.set_backend("gpu", precision="single", adapter=0)
    assert helfrich.get_backend() == "gpu:single@0"
    helfrich.set_backend("cpu")
    assert helfrich.get_backend() == "cpu"


def test_the_choice_of_a_force_is_part_of_it(mesh):
    force = helfrich.BendingForce(mesh, 50)
    assert "backend" not in XmlSerializer.serialize(force)
    force.setBackend("gpu:double@1")
    for other in (copy.copy(force), copy.deepcopy(force)):
        assert other.getBackend() == "gpu:double@1"
    text = XmlSerializer.serialize(force)
    assert (
        helfrich.BendingForce.cast(XmlSerializer.deserialize(text)).getBackend() == "gpu:double@1"
    )
    with pytest.raises(mm.OpenMMException, match='there is no backend "tpu"'):
        XmlSerializer.deserialize(text.replace("gpu:double@1", "tpu"))
    force.setBackend("")
    assert force.getBackend() == ""


# --- who computes --------------------------------------------------------------------------------


def evaluated(context: mm.Context, mesh: helfrich.Mesh) -> str:
    """What has computed an evaluation."""
    positions = [*mesh.vertices.tolist(), *[[0.0, 0.0, 0.0]] * (100 - mesh.num_vertices)]
    with counting() as made:
        context.setPositions(positions)
        context.getState(forces=True)
    (who,) = made
    return who


@pytest.mark.usefixtures("gpu", "backend_as_it_was")
def test_the_process_and_the_force_can_choose(mesh):
    force = helfrich.BendingForce(mesh, 50)
    small = copy.copy(force)
    assert evaluated(context_of(copy.copy(force)), mesh) == "cpu"
    helfrich.set_backend("gpu")
    before = context_of(copy.copy(force))
    assert evaluated(before, mesh) == "gpu"
    small.setBackend("cpu")
    assert evaluated(context_of(small), mesh) == "cpu"
    helfrich.set_backend("auto")
    assert evaluated(before, mesh) == "gpu", "Contexts keep what they were made with"
    force.setBackend("gpu:single")
    assert evaluated(context_of(force), mesh) == "gpu"


@pytest.mark.usefixtures("gpu")
def test_forces_that_are_computed_together_must_agree(mesh):
    bending = helfrich.BendingForce(mesh, 50)
    area = helfrich.SurfaceAreaForce(mesh, 1, mesh.area)
    volume = helfrich.EnclosedVolumeForce(mesh, 1, mesh.volume)
    bending.setBackend("gpu:single")
    area.setBackend("cpu")
    message = 'SurfaceAreaForce: has the backend "cpu", but another force .* has "gpu:single"'
    with pytest.raises(mm.OpenMMException, match=message):
        context_of(copy.copy(bending), area)
    assert evaluated(context_of(volume, bending), mesh) == "gpu", "the others follow"


@pytest.mark.usefixtures("gpu")
def test_auto_does_not_take_what_computes_on_the_processor():
    """N = 20 252, above the size from which a GPU is looked for."""
    if any(adapter.kind != "software" for adapter in helfrich.adapters()):
        pytest.skip("this machine has a GPU, for which auto may decide either way")
    mesh = helfrich.Mesh.icosphere(45, 1000.0)
    force = helfrich.SurfaceAreaForce(mesh, 1, mesh.area)
    force.setBackend("auto")
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50)
    system.addForce(force)
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.1), platform)
    assert evaluated(context, mesh) == "cpu"


@pytest.mark.usefixtures("gpu")
def test_the_environment_chooses_for_scripts():
    script = """
    print(helfrich.get_backend())
    context, integrator = simulation()
    integrator.step(1)
    print(counts()["cpu"], counts()["gpu"] > 0)
    """
    assert run(script, HELFRICH_BACKEND="gpu:single").stdout.split() == ["gpu:single", "0", "True"]


def test_a_wrong_environment_is_named():
    script = """
    try:
        simulation()
    except mm.OpenMMException as error:
        print(error)
    """
    output = run(script, HELFRICH_BACKEND="fast").stdout
    assert 'the environment variable HELFRICH_BACKEND is "fast"' in output


# --- faults --------------------------------------------------------------------------------------


@pytest.mark.usefixtures("gpu")
def test_a_lost_device_is_an_error_of_the_backend_gpu():
    script = """
    helfrich.set_backend("gpu")
    context, integrator = simulation()
    fault("lost", 50)
    try:
        integrator.step(100)
    except mm.OpenMMException as error:
        print(error)
    try:
        integrator.step(1)
    except mm.OpenMMException as error:
        print(error)
    assert counts()["cpu"] == 0
    # A new Context opens the device again.
    context, integrator = simulation()
    integrator.step(10)
    print("fine")
    """
    result = run(script)
    first, second, last = result.stdout.splitlines()
    for line in (first, second):
        assert "Force: the GPU " in line and "was lost" in line
    assert last == "fine"
    assert not takeovers(result)


@pytest.mark.usefixtures("gpu")
def test_the_processor_takes_over_a_trajectory():
    """In double precision both compute the same, so that the trajectory shows no seam."""
    script = """
    import numpy as np

    def trajectory():
        context, integrator = simulation()
        integrator.step(200)
        first = counts()
        positions = context.getState(positions=True).getPositions(asNumpy=True)._value
        return context, positions, energy(context)

    helfrich.set_backend("cpu")
    _, expected, total = trajectory()
    before = counts()
    helfrich.set_backend("auto", precision="double")
    fault("prefer", 1)
    fault("lost", 100)
    context, found, other = trajectory()
    after = counts()
    assert after["gpu"] - before["gpu"] >= 99, after
    assert after["cpu"] - before["cpu"] >= 100, after
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
    assert abs(other / total - 1) < 1e-9
    # Once is enough: another Context, another fault, no other line.
    context, integrator = simulation()
    fault("lost", 10)
    integrator.step(50)
    """
    helfrich_adapter = helfrich.adapters()[0]
    if not helfrich_adapter.double:
        pytest.skip(f"{helfrich_adapter.name} has no double precision")
    lines = takeovers(run(script))
    assert len(lines) == 1
    assert "the processor takes over" in lines[0] and "was lost" in lines[0]


@pytest.mark.usefixtures("gpu")
@pytest.mark.parametrize("kind", ["memory", "adapter"])
def test_a_gpu_that_cannot_start(kind: str):
    script = f"""
    fault("prefer", 1)
    fault("{kind}")
    context, integrator = simulation()
    integrator.step(10)
    assert counts()["cpu"] > 10 and counts()["gpu"] == 0
    fault("none")
    helfrich.set_backend("gpu")
    fault("{kind}")
    try:
        simulation()
    except mm.OpenMMException as error:
        print(error)
    assert counts()["gpu"] == 0
    fault("none")
    context, integrator = simulation()
    integrator.step(10)
    assert counts()["gpu"] > 10
    """
    result = run(script)
    expected = {"memory": "has not enough memory for a mesh of 162 vertices", "adapter": "no GPU"}
    assert expected[kind] in result.stdout
    # That a machine has no GPU is nothing to report under "auto".
    assert len(takeovers(result)) == (1 if kind == "memory" else 0)


# --- the command line ----------------------------------------------------------------------------


def test_info_describes_the_machine():
    result = CliRunner().invoke(main, ["info"])
    assert result.exit_code == 0, result.output
    assert f"OpenMM {mm.Platform.getOpenMMVersion()}" in result.output
    for adapter in helfrich.adapters():
        assert f"GPU {adapter.index}: {adapter.name}, {adapter.kind}" in result.output
        assert adapter.driver in result.output
    assert "below 20000 vertices the processor" in result.output


def test_the_size_in_the_documents_is_that_of_the_core():
    source = Path(__file__).resolve().parents[2] / "src" / "evaluator" / "chosen.rs"
    assert "LEAST_VERTICES_FOR_GPU: usize = 20_000;" in source.read_text()
    assert "20 000 vertices" in helfrich.set_backend.__doc__
