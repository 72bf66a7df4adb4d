"""The logger of the package: levels, the environment variable, options of all commands."""

import logging
import subprocess
import sys

import pytest
from click.testing import CliRunner
from openmmhelfrich import logs
from openmmhelfrich.cli import main
from openmmhelfrich.sweep import sweep

CONFIG = """
simulation = { name = "own", duration = 2, seed = 7 }
integrator.time_step = 0.1
output.interval = 1
[[vesicle]]
mesh = { icosphere = 2, radius = 30 }
"""
BEGINS = "Info: out: begins at step 0 on the platform Helfrich, seed 7"
FRAME = "Debug: out: a frame at step 10"


@pytest.fixture
def config(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(logs.VARIABLE, raising=False)
    path = tmp_path / "own.toml"
    path.write_text(CONFIG, encoding="utf-8")
    return path


def invoke(*words):
    result = CliRunner().invoke(main, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result


@pytest.mark.parametrize(
    ("before", "behind", "info", "debug", "progress"),
    [
        ([], [], False, False, True),
        (["-v"], [], True, False, True),
        ([], ["-v"], True, False, True),
        (["-vv"], [], True, True, True),
        ([], ["-v", "-v"], True, True, True),
        (["--log-level", "INFO"], [], True, False, True),
        (["--log-level", "debug"], [], True, True, True),
        (["-q"], [], False, False, False),
        (["-v"], ["-q"], False, False, False),
        (["-q"], ["-v"], True, False, True),
        ([], ["--log-level", "critical"], False, False, False),
    ],
)
def test_options_of_run(config, before, behind, info, debug, progress):
    result = invoke(*before, "run", config, "--out", "out", *behind)
    assert (BEGINS in result.stderr.splitlines()) == info
    assert (FRAME in result.stderr.splitlines()) == debug
    assert ("step 10/20" in result.stdout) == progress
    # Results are there in any case, and nothing else is among them.
    assert "Energies at step 20" in result.stdout
    assert not any(line.startswith(("Info", "Debug")) for line in result.stdout.splitlines())


def test_the_environment_variable(config, monkeypatch):
    monkeypatch.setenv(logs.VARIABLE, "info")
    assert BEGINS in invoke("run", config, "--out", "out").stderr
    assert BEGINS not in invoke("-q", "run", config, "--out", "two").stderr
    monkeypatch.setenv(logs.VARIABLE, "loud")
    said = invoke("run", config, "--out", "three").stderr
    assert "Warning: HELFRICH_LOG: there is no level 'loud'; there are debug, info" in said


def test_a_wrong_level_is_refused(config):
    result = CliRunner().invoke(main, ["--log-level", "loud", "run", str(config)])
    assert result.exit_code == 2
    assert "'loud'" in result.stderr


def test_every_command_has_the_options():
    context = main.make_context("openmm-helfrich", ["doctor"])
    for name in main.list_commands(context):
        command = main.get_command(context, name)
        for one in (command, *getattr(command, "commands", {}).values()):
            names = [parameter.name for parameter in one.params]
            assert names.count("log_level") == names.count("quiet") == names.count("verbose") == 1
    assert "--log-level" in invoke("--help").output


def test_nothing_of_a_command_stays(config):
    package = logs.logger()
    before = package.level, package.propagate
    invoke("-vv", "run", config, "--out", "out")
    assert (package.level, package.propagate) == before


def test_warnings_of_a_configuration_are_among_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mesh.ply").write_bytes(b"")
    from openmmhelfrich import Mesh

    Mesh.icosphere(2, 30).write("mesh.ply")
    text = "-GeneralParameters\n# a comment that\nan editor has broken here\nStepSizeInFs 20\n"
    (tmp_path / "own.txt").write_text(
        text + "-Membrane 0\nMeshFile mesh.ply\nMeanCurvatureModel Julicher1996\n"
        "MeanCurvatureCoeff 50\n"
    )
    assert "Warning: own.txt:3: skipped" in invoke("info", "own.txt", "--no-measure").stderr
    assert invoke("-q", "info", "own.txt", "--no-measure").stderr == ""


def double(number):
    return {"twice": 2 * number}


def test_a_program_that_logs_gets_the_records(tmp_path, caplog):
    with caplog.at_level(logging.DEBUG, logs.logger().name):
        sweep(double, [{"number": 1}, {"number": 2}], workers=0, cache=tmp_path, progress=False)
    records = [(record.name, record.levelname) for record in caplog.records]
    assert records == [("openmmhelfrich.sweep", level) for level in ("INFO", "DEBUG", "DEBUG")]
    assert "double: 0 of 2 points are stored" in caplog.text


PROGRAM = """
{before}
from openmmhelfrich import logs
logs.logger("run").info("all is well")
logs.logger("run").warning("mind the step")
"""


@pytest.mark.parametrize(
    ("before", "level", "said"),
    [
        ("", None, ["Warning: mind the step"]),
        ("", "info", ["Info: all is well", "Warning: mind the step"]),
        ("", "error", []),
        # Once, and as the program shows all records.
        (
            "import logging as l; l.basicConfig(level=l.INFO, format='%(name)s %(message)s')",
            None,
            ["openmmhelfrich.run all is well", "openmmhelfrich.run mind the step"],
        ),
    ],
)
def test_programs_without_and_with_logging(before, level, said, monkeypatch):
    monkeypatch.delenv(logs.VARIABLE, raising=False)
    if level is not None:
        monkeypatch.setenv(logs.VARIABLE, level)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(before=before)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.splitlines() == said


@pytest.mark.parametrize("level", ["loud", "", None, logging.DEBUG])
def test_set_level_refuses_what_is_none(level):
    with pytest.raises(ValueError, match=f"no level {level!r}; there are debug, info"):
        logs.set_level(level)


def test_a_wrong_variable_is_told_once(tmp_path, monkeypatch):
    monkeypatch.setenv(logs.VARIABLE, "loud")
    words = ["openmmhelfrich", "mesh", "icosphere", "2", str(tmp_path / "a.ply")]
    done = subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("there is no level 'loud'") == 1
