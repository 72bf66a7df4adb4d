"""``openmm-helfrich compare`` and ``convert``: what they print, write and return."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmmhelfrich import vcm
from openmmhelfrich.cli import main
from openmmhelfrich.vcm import comparison, strings
from vcm_files import Folder

# The model that OpenMM differentiates fastest.
MEMBRANE = (
    "MeanCurvatureModel Julicher1996\nMeanCurvatureCoeff 50\n"
    "SurfaceConstraint GWCAH 0.5\nSurfaceConstraintCoeff 1.3\n"
    "VolumeConstraint G\nVolumeConstraintCoeff 0.04\n"
    "DihedralBendingModel smoothTheta4\nDihedralBendingCoeff 7\n"
    "SpringModel H\nSpringCoeff 3"
)
TERMS = ("area", "volume", "bending", "heights", "dihedrals", "springs")


@pytest.fixture
def config(tmp_path, lumpy):
    folder = Folder(tmp_path, lumpy)
    return folder.write(folder.text(MEMBRANE, "ProjectName lump\nIntegrator V"))


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def rows(output: str) -> dict[str, list[str]]:
    """The lines of the table by term."""
    lines = [line.split() for line in output.splitlines()]
    return {line[0]: line[1:] for line in lines if line and line[0] in TERMS}


@pytest.mark.parametrize("style", strings.STYLES)
def test_compare_agrees(config, style):
    result = run("compare", config, "--style", style, "--seconds", 0.05)
    assert result.exit_code == 0, result.output
    found = rows(result.output)
    assert set(found) == set(TERMS)
    for name, (theirs, ours, energy_error, force_error, *remark) in found.items():
        assert float(theirs) == pytest.approx(float(ours), rel=1e-9)
        assert float(ours) != 0
        assert float(energy_error) <= 1e-9
        assert float(force_error) <= 1e-9
        assert (remark == ["the", "same", "force", "in", "both"]) == (name == "springs")
    # The repulsion is out of reach at the start.
    assert found["heights"][4:] == ["at", "0.5", "of", "the", "size"]
    assert "times as fast" in result.output
    assert "All terms agree to 1e-09." in result.output


@pytest.mark.parametrize("name", ["bending", "volume", "heights"])
def test_compare_disagrees(config, name, monkeypatch):
    """One term of the Custom forces is 1 + 1e-7 times what it should be."""

    def wrong(system, style):
        result = strings.custom_system(system, style)
        for force in result.getForces():
            if force.getName() == name:
                text = force.getEnergyFunction()
                energy, *definitions = text.split(";")
                force.setEnergyFunction(";".join([f"1.0000001*({energy})", *definitions]))
        return result

    monkeypatch.setattr(comparison, "custom_system", wrong)
    result = run("compare", config, "--seconds", 0)
    assert result.exit_code == 1
    assert f"Error: {name}: above the tolerance of 1e-09" in result.output
    assert "All terms agree" not in result.output
    assert "per step" not in result.output
    assert float(rows(result.output)[name][2]) == pytest.approx(1e-7, rel=1e-2)
    assert run("compare", config, "--seconds", 0, "--tolerance", 1e-6).exit_code == 0


def test_compare_refuses(config, tmp_path):
    result = run("compare", config, "--platform", "Fast")
    assert result.exit_code == 2
    assert "no platform 'Fast'; this OpenMM has Reference" in result.output
    config.write_text(config.read_text().replace("SpringModel", "SprungModel"))
    result = run("compare", config)
    assert result.exit_code == 1
    assert "SprungModel" in result.output
    assert run("compare", tmp_path / "none.txt").exit_code == 1


def test_a_term_that_is_zero_says_so(config):
    config.write_text(config.read_text().replace("GWCAH 0.5", "GWCAH 0.001"))
    result = run("compare", config, "--seconds", 0)
    assert result.exit_code == 0
    assert rows(result.output)["heights"][4:] == ["zero", "in", "both"]


# --- convert -----------------------------------------------------------------------------------


@pytest.fixture
def custom(config, tmp_path):
    """The System of strings, its file, and a file of positions."""
    cfg = vcm.read(config)
    system = strings.custom_system(cfg.system())
    path = tmp_path / "system.xml"
    path.write_text(mm.XmlSerializer.serialize(system))
    context = mm.Context(
        system, mm.VerletIntegrator(0.001), mm.Platform.getPlatformByName("Reference")
    )
    rng = np.random.default_rng(1)
    context.setPositions(cfg.positions + rng.normal(scale=0.03, size=cfg.positions.shape))
    state = tmp_path / "state.xml"
    state.write_text(mm.XmlSerializer.serialize(context.getState(positions=True)))
    return context, path, state


def energy(system: mm.System, positions) -> float:
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
    context.setPositions(positions)
    return context.getState(energy=True).getPotentialEnergy()._value


def test_convert(custom, tmp_path):
    context, path, state = custom
    result = run("convert", path, "--positions", state, "-o", tmp_path / "new.xml")
    assert result.exit_code == 0, result.output
    assert "springs" in result.output
    assert "BendingForce, 80 triangles" in result.output
    faster = mm.XmlSerializer.deserialize((tmp_path / "new.xml").read_text())
    assert sorted(force.getName() for force in faster.getForces()) == sorted(
        ["CMMotionRemover", *TERMS] if faster.getNumForces() == 7 else TERMS
    )
    assert sum(helfrich.BendingForce.isinstance(force) for force in faster.getForces()) == 1
    then = context.getState(energy=True, positions=True)
    expected = then.getPotentialEnergy()._value
    assert energy(faster, then.getPositions()) == pytest.approx(expected, rel=1e-9)
    # Without a name of its own the file lies beside the first one.
    assert run("convert", path).exit_code == 0
    assert (tmp_path / "system-helfrich.xml").is_file()


def test_convert_takes_pdb(custom, config, tmp_path):
    """Its coordinates are rounded to 0.001 Å, which changes no verdict."""
    cfg = vcm.read(config)
    with open(tmp_path / "start.pdb", "w") as file:
        mm.app.PDBFile.writeFile(cfg.topology(), cfg.positions * 10 * mm.unit.angstrom, file)
    result = run("convert", custom[1], "--positions", tmp_path / "start.pdb")
    assert result.exit_code == 0, result.output


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<nonsense", "is not a System in XML"),
        (
            mm.XmlSerializer.serialize(mm.HarmonicBondForce()),
            "holds a HarmonicBondForce, not a System",
        ),
        (mm.XmlSerializer.serialize(mm.System()), "nothing to replace, so no file was written"),
    ],
)
def test_convert_refuses(text, message, tmp_path):
    path = tmp_path / "system.xml"
    path.write_text(text)
    result = run("convert", path, "-o", tmp_path / "new.xml")
    assert result.exit_code == 1
    assert message in result.output
    assert not (tmp_path / "new.xml").exists()


def test_convert_refuses_positions(custom, tmp_path):
    _, path, state = custom
    other = tmp_path / "other.xml"
    system = mm.System()
    system.addParticle(1.0)
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
    context.setPositions([[0, 0, 0]])
    other.write_text(mm.XmlSerializer.serialize(context.getState(energy=True)))
    result = run("convert", path, "--positions", other)
    assert "a State without positions" in result.output
    other.write_text(mm.XmlSerializer.serialize(context.getState(positions=True)))
    result = run("convert", path, "--positions", other)
    assert result.exit_code == 1
    assert "has 42 particles, but positions have the shape (1, 3)" in result.output
    result = run("convert", path, "--positions", state, "--tolerance", 0)
    assert "ours differs at the positions" in result.output
    assert "BendingForce" not in result.output
