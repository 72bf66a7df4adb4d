"""The platform at every door of ours where none is named, and what is said of it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import openmm as mm
import pytest
from click.testing import CliRunner
from openmmhelfrich import Mesh, Vesicle, _benchmark, config, platforms, set_backend, vcm
from openmmhelfrich.cli import main
from openmmhelfrich.simulation.runner import Run
from openmmhelfrich.vcm.comparison import compare
from platforms import counting
from vcm_files import Folder

ROOT = Path(__file__).resolve().parents[2]
ONE = """simulation.duration = 0.4
integrator.time_step = 0.02

[[vesicle]]
mesh = { icosphere = 2, radius = 30 }
"""
TWO = f"""{ONE}
[[vesicle]]
mesh = {{ icosphere = 2, radius = 30, translate = [78, 0, 0] }}

[repulsion]
strength = 5
distance = 20
"""
BENDING = "MeanCurvatureModel Julicher1996\nMeanCurvatureCoeff 50"


@pytest.fixture(autouse=True)
def no_default(monkeypatch):
    monkeypatch.delenv("OPENMM_DEFAULT_PLATFORM", raising=False)


@pytest.fixture
def toml(tmp_path):
    def write(text: str) -> Path:
        path = tmp_path / "own.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def invoke(*arguments) -> str:
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output
    return result.output


def name_of(context: mm.Context) -> str:
    return context.getPlatform().getName()


@pytest.fixture
def names(monkeypatch) -> list[str]:
    """The platforms of all Contexts that Python makes, in turn."""
    found = []
    original = mm.Context.__init__

    def note(self, *arguments):
        original(self, *arguments)
        found.append(name_of(self))

    monkeypatch.setattr(mm.Context, "__init__", note)
    return found


def test_vesicle():
    vesicle = Vesicle(Mesh.icosphere(2, 30.0))
    assert name_of(vesicle.simulation(mm.VerletIntegrator(0.1)).context) == "Helfrich"
    assert name_of(vesicle.simulation(mm.VerletIntegrator(0.1), "CPU").context) == "CPU"


def test_environment(monkeypatch, toml, tmp_path):
    monkeypatch.setenv("OPENMM_DEFAULT_PLATFORM", "CPU")
    vesicle = Vesicle(Mesh.icosphere(2, 30.0))
    assert name_of(vesicle.simulation(mm.VerletIntegrator(0.1)).context) == "CPU"
    assert "platform CPU," in invoke("run", toml(ONE), "--out", tmp_path / "out", "--steps", 2)


def test_mesh_fluctuating(names):
    Mesh.icosphere(3, 30.0).fluctuating(softness=0.1, duration=0.01)
    assert names == ["Helfrich"]


@pytest.mark.parametrize(("text", "name"), [(ONE, "Helfrich"), (TWO, "Helfrich")])
class TestToml:
    def test_simulation(self, toml, text, name):
        assert name_of(config.read(toml(text)).simulation().context) == name

    def test_run(self, toml, tmp_path, text, name):
        assert f"platform {name}," in invoke(
            "run", toml(text), "--out", tmp_path / "out", "--steps", 2
        )
        asked = ("--platform", "reference", "--out", tmp_path / "other", "--steps", 2)
        assert "platform Reference," in invoke("run", toml(text), *asked)

    def test_info(self, toml, text, name):
        output = invoke("info", toml(text))
        assert re.search(rf"^Platform: {name}, for \w+", output, flags=re.M)
        assert re.search(rf"^Expected run time: .* on {name} ", output, flags=re.M)
        output = invoke("info", toml(text), "--no-measure", "--platform", "OpenCL")
        assert "Platform: OpenCL, for --platform names it" in output
        named = text.replace("simulation.", 'simulation.platform = "CPU"\nsimulation.', 1)
        assert "Platform: CPU, for the file names it" in invoke("info", toml(named), "--no-measure")


class TestVcm:
    @pytest.mark.parametrize(
        ("membrane", "table", "name"),
        [
            (BENDING, None, "Helfrich"),
            (f"{BENDING}\nNodeRadius 0.3", "M WCA", "CPU"),
            ("SpringModel H\nSpringCoeff 3", None, "Helfrich"),
        ],
    )
    def test_run(self, tmp_path, lumpy, membrane, table, name):
        folder = Folder(tmp_path, lumpy)
        text = folder.text(membrane, "ProjectName lump\nIntegrator LM\nStepSizeInFs 1")
        if table is not None:
            text += f"\n-InteractionTable\n{table}\n"
        path = folder.write(text)
        cfg = vcm.read(path)
        assert name_of(cfg.simulation().context) == name
        job = Run(path, tmp_path / "out")
        job.close()
        assert job.platform == name
        assert f"platform {name}," in invoke("run", path, "--out", tmp_path / "cli", "--steps", 1)

    def test_compare(self, tmp_path, lumpy, names):
        folder = Folder(tmp_path, lumpy)
        path = folder.write(folder.text(BENDING, "ProjectName lump\nIntegrator V"))
        assert compare(vcm.read(path), seconds=0).platform == "Helfrich"
        assert names == ["Helfrich", "Helfrich"]
        assert "against ours, Helfrich" in invoke("compare", path, "--seconds", 0)
        asked = invoke("compare", path, "--seconds", 0, "--platform", "reference")
        assert "against ours, Reference" in asked


def test_machine():
    output = invoke("info")
    assert f"OpenMM's platforms: {', '.join(platforms.names())}" in output
    assert "  membranes: Helfrich, for " in output
    assert re.search(r"^  with pairs of particles: \w+, for CustomNonbonded", output, flags=re.M)
    for name in platforms.ON_DEVICES:
        if name in platforms.names():
            assert re.search(rf"^  {name}: .*, for .*{name}", output, flags=re.M)


@pytest.mark.usefixtures("backend_as_it_was")
@pytest.mark.parametrize("backend", ["auto", "native"])
def test_info_says_what_computes_membranes(backend, tmp_path):
    """And a run does what it says."""
    path = tmp_path / "two.toml"
    path.write_text(TWO, encoding="utf-8")
    set_backend(backend)
    output = invoke("info", path, "--no-measure", "--platform", "OpenCL")
    surface = "SurfaceAreaForce, EnclosedVolumeForce, BendingForce, TriangleHeightForce"
    who = {"auto": "the processor, for the device of OpenCL", "native": "the platform itself, for"}
    if backend == "native" or not platforms._count_opencl_gpus():
        assert f"{surface}: computed by {who[backend]}" in output
    assert "SurfaceRepulsionForce: computed by the processor, for contacts" in output
    platform = platforms.choose(config.read(path).system(), config.read(path).integrator()).name
    assert f"Platform: {platform}, for " in invoke("info", path, "--no-measure")
    with counting() as made:
        invoke("run", path, "--out", tmp_path / "out", "--steps", 3)
    assert ("native" in made) == (platform in platforms.ON_DEVICES)


def test_bench():
    found, failed = _benchmark.targets()
    assert [target.platform for target in found].count("Helfrich") == 2
    assert {target.platform for target in found} | set(failed) == set(platforms.names())
    assert "Helfrich, 1 thread" in invoke(
        "bench", "--platform", "helfrich", "--size", 42, "--seconds", 0.01, "--repeats", 1
    )


@pytest.mark.parametrize("command", ["run", "info", "compare"])
def test_help_is_true(command):
    output = " ".join(invoke(command, "--help").split())
    option = output.partition("--platform NAME")[2].partition(" --")[0]
    assert "Helfrich" in option
    assert "Reference (the default" not in option
    result = CliRunner().invoke(main, [command, "x", "--platform", "abacus"])
    assert "no platform 'abacus'; this OpenMM has Reference" in result.output
    assert "Helfrich" in result.output


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("vesicle.py", "on OpenMM's platform Helfrich"),
        ("integrators.py", "platform Helfrich"),
        ("two_vesicles.py", "Platform Helfrich"),
    ],
)
def test_examples(script, said, tmp_path):
    quick = ["--steps", "40"] if script == "two_vesicles.py" else ["--quick"]
    out = [] if script == "integrators.py" else ["--out", str(tmp_path)]
    result = subprocess.run(
        [sys.executable, str(ROOT / "examples" / script), *quick, *out],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert result.returncode == 0, result.stderr
    assert said in result.stdout


def test_nothing_names_a_slower_one():
    """The examples and the paper's scripts leave the choice to the one rule.

    Those that only evaluate, without a step, are as fast on Reference.
    """
    found = {
        path.name
        for path in (ROOT / "examples").rglob("*.py")
        if re.search(r'"(Reference|CPU|OpenCL)"', path.read_text(encoding="utf-8"))
    }
    assert found == {"spheres.py"}


def _evaluate(cfg, force: mm.Force) -> tuple[float, np.ndarray]:
    """Energy, kJ/mol, and forces, kJ/mol/nm, of one force at the start."""
    system = mm.System()
    for _ in range(cfg.num_particles):
        system.addParticle(1)
    system.addForce(force)
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.1), platform)
    context.setPositions(cfg.positions)
    state = context.getState(energy=True, forces=True)
    return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value


@pytest.mark.parametrize(
    ("table", "pairs", "groups"),
    [
        ("A 0\nB WCA 0\nC WCA WCA 0", {(0, 1), (0, 2), (1, 2)}, 0),
        ("A WCA\nB WCA 0\nC WCA WCA 0", {(0, 0), (0, 1), (0, 2), (1, 2)}, 0),
        ("A WCA\nB WCA WCA\nC WCA WCA WCA", None, 0),
        # B and C do not see each other, and lie in one place.
        ("A 0\nB WCA 0\nC WCA 0 0", {(0, 1), (0, 2)}, 2),
    ],
)
def test_interactions_of_vcm(tmp_path, lumpy, table, pairs, groups):
    """Without interaction groups where that can be, and with the same energies."""
    apart = "Scale 1.02" if pairs is None or (1, 2) in pairs else "Scale 1.01"
    cfg = Folder(tmp_path, lumpy).read(
        "NodeRadius 0.4",
        more=f"-Membrane B x 0\nNodeRadius 0.3\nScale 1.01\n"
        f"-Membrane C x 0\nNodeRadius 0.3\n{apart}",
        table=table,
    )
    system = cfg.system()
    (force,) = system.getForces()
    assert force.getNumInteractionGroups() == groups
    owner = np.repeat(np.arange(3), lumpy.num_vertices)
    radii = np.repeat([0.4, 0.3, 0.3], lumpy.num_vertices)
    expected = 0.0
    for i in range(len(owner)):
        for j in range(i):
            if pairs is not None and (owner[j], owner[i]) not in pairs:
                continue
            ratio = (radii[i] + radii[j]) / np.linalg.norm(cfg.positions[i] - cfg.positions[j])
            if ratio > 2 ** (-1 / 6):
                expected += 4 * cfg.kT * (ratio**12 - ratio**6 + 0.25)
    energy, forces = _evaluate(cfg, mm.XmlSerializer.clone(force))
    assert expected > 1
    assert energy == pytest.approx(expected, rel=1e-10)
    assert np.isfinite(forces).all()
