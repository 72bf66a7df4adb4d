"""The command `completion`, and what shells get of it."""

import os
import shutil
import subprocess
import sys

import pytest
from click.testing import CliRunner
from openmmhelfrich.cli import main

SHELLS = ("bash", "zsh", "fish")


def script_of(shell):
    result = CliRunner().invoke(main, ["completion", shell])
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.parametrize("shell", SHELLS)
def test_scripts_say_how_they_are_installed(shell):
    first, _, script = script_of(shell).partition("\n")
    assert first.startswith("# To install it ")
    assert f"openmm-helfrich completion {shell}" in first
    assert f"_OPENMM_HELFRICH_COMPLETE={shell}_complete" in script


@pytest.mark.parametrize("shell", SHELLS)
def test_shells_read_their_scripts(shell):
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell}")
    subprocess.run([shell, "-n"], input=script_of(shell), text=True, check=True)


@pytest.mark.parametrize(
    ("words", "expected"),
    [("openmm-helfrich do", "plain,doctor"), ("openmm-helfrich info --js", "plain,--json")],
)
def test_bash_is_told_what_there_is(words, expected):
    """What the script asks for at a press of the key."""
    environment = os.environ | {
        "_OPENMM_HELFRICH_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split()) - 1),
    }
    code = "from openmmhelfrich.cli import main; main(prog_name='openmm-helfrich')"
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == [expected]


def test_other_shells_are_refused():
    result = CliRunner().invoke(main, ["completion", "csh"])
    assert result.exit_code == 2
    assert "'csh' is not one of 'bash', 'zsh', 'fish'" in result.output
