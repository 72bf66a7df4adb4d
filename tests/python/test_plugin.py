"""The plugin as a package: what is installed, what is refused, and what `make` says is missing."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import openmm
import openmmhelfrich
import pytest
from openmmhelfrich import _core, _plugin
from openmmhelfrich._openmm_interface import interface_of

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = Path(openmmhelfrich.__file__).parent


class TestVersion:
    def test_the_version_that_was_built_for_is_accepted(self):
        _plugin.check_openmm("8.6.1", "8.6.1")

    @pytest.mark.parametrize("found", ["8.5.0", "8.6", "8.6.2", "8.6.1.dev", "9.0.0"])
    def test_any_other_is_refused(self, found):
        with pytest.raises(ImportError) as refusal:
            _plugin.check_openmm("8.6.1", found)
        text = str(refusal.value)
        assert text.startswith("openmmhelfrich was built for OpenMM 8.6.1")
        assert f"this is OpenMM {found}" in text and "pip install openmm==8.6.1" in text

    @pytest.mark.parametrize("found", ["8.6", "8.6.2"])
    def test_a_patch_release_with_the_same_interface_is_accepted(self, found):
        _plugin.check_openmm("8.6.1", found, same_interface=True)

    @pytest.mark.parametrize("found", ["8.5.1", "8.7.0", "9.6.1"])
    def test_another_release_is_not_even_then(self, found):
        with pytest.raises(ImportError, match=r"was built for OpenMM 8\.6\.1"):
            _plugin.check_openmm("8.6.1", found, same_interface=True)

    def test_the_interface_is_that_of_the_build(self):
        assert _plugin.has_same_interface()

    def test_what_belongs_to_an_interface(self, tmp_path):
        (tmp_path / "openmm").mkdir()
        header = tmp_path / "openmm" / "System.h"
        header.write_text("class System { /* all */\n  int count; // of what\n};\n")
        first = interface_of(tmp_path)
        header.write_text("/** Another word. */\nclass System {\n    int count;\n};\n")
        assert interface_of(tmp_path) == first
        header.write_text("class System { long count; };\n")
        assert interface_of(tmp_path) != first
        header.unlink()
        assert interface_of(tmp_path) is None

    def test_the_library_is_told_which_release_is_accepted(self):
        """Of an OpenMM that gives another version to Python than to the library."""
        script = (
            "import openmm\n"
            "true = openmm.Platform.getOpenMMVersion()\n"
            "other = '.'.join(true.split('.')[:2]) + '.99'\n"
            "openmm.Platform.getOpenMMVersion = staticmethod(lambda: other)\n"
            "import openmmhelfrich\n"
        )
        result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        assert "cannot be used with OpenMM" in result.stderr

    def test_import_beside_another_openmm_fails_before_the_plugin_is_loaded(self):
        script = (
            "import openmm\n"
            "openmm.Platform.getOpenMMVersion = staticmethod(lambda: '8.5.0')\n"
            "openmm.Platform.loadPluginLibrary = None\n"
            "import openmmhelfrich\n"
        )
        result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        assert result.returncode != 0
        last = result.stderr.strip().splitlines()[-1]
        built = openmm.Platform.getOpenMMVersion()
        assert last.startswith(f"ImportError: openmmhelfrich was built for OpenMM {built}")

    def test_a_missing_library_is_named(self, tmp_path):
        shutil.copytree(PACKAGE, tmp_path / "openmmhelfrich", ignore=shutil.ignore_patterns("lib"))
        result = subprocess.run(
            [sys.executable, "-c", "import openmmhelfrich"],
            env=dict(os.environ, PYTHONPATH=str(tmp_path)),
            capture_output=True,
            text=True,
        )
        last = result.stderr.strip().splitlines()[-1]
        assert last.startswith("ImportError: openmmhelfrich: ")
        assert str(tmp_path) in last and "make build" in last


class TestPackage:
    def test_the_library_folder_is_a_plugin_folder(self):
        """OpenMM tries to load every file of a plugin folder, so there must be nothing else."""
        assert list(_core.LIBRARY_PATH.parent.iterdir()) == [_core.LIBRARY_PATH]

    def test_headers_and_types_are_there(self):
        assert (PACKAGE / "py.typed").exists()
        headers = {path.name for path in (PACKAGE / "include" / "openmm-helfrich").iterdir()}
        classes = {name for name in openmmhelfrich.__all__ if name.endswith("Force")}
        assert headers >= {f"{name}.h" for name in classes}
        assert (PACKAGE / "include" / "OpenMMHelfrich.h").exists()


RUSTC = 'echo "rustc 1.95.0 (59807616e 2026-04-14)"'
PYTHON = f'case "$2" in *version*) echo 3.11;; *Python.h*) echo {__file__};; esac'
TOOLS = {"cargo": "", "rustc": RUSTC, "c++": "", "cc": "", "python3": PYTHON}


class TestMissingTools:
    """`make` names what is missing. The tools here are stand-ins that answer just its questions."""

    def make(self, folder, target, **replaced):
        for name, script in {**TOOLS, **replaced}.items():
            if script is not None:
                (folder / name).write_text(f"#!/bin/sh\n{script}\n")
                (folder / name).chmod(0o755)
        # A make that runs these tests must not hand its own settings on.
        ours = ("CXX", "PYTHON", "MAKEFLAGS", "MAKELEVEL", "MFLAGS")
        environment = {key: value for key, value in os.environ.items() if key not in ours}
        return subprocess.run(
            [shutil.which("make"), "-C", str(ROOT), target, f"PATH={folder}"],
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
        )

    def test_nothing_is_missing(self, tmp_path):
        result = self.make(tmp_path, "check-tools")
        assert result.returncode == 0, result.stderr

    @pytest.mark.parametrize(
        "tool, script, message",
        [
            ("cargo", None, "Rust is missing (cargo is not in PATH); install Rust 1.89"),
            ("rustc", None, "Rust is missing (rustc is not in PATH); install Rust 1.89"),
            ("rustc", "echo rustc 1.88.1", "Rust 1.88.1 is too old; install Rust 1.89"),
            ("rustc", "echo no toolchain; exit 1", "rustc does not run: no toolchain"),
            ("c++", None, "the C++ compiler c++ is missing; install one"),
            ("c++", "exit 1", "c++ does not compile C++17"),
            ("cc", None, "cc is missing"),
            ("python3", None, "python3 is missing; install Python 3.10 or later"),
            ("python3", "exit 1", "python3 does not run"),
            ("python3", "echo 3.9", "python3 is Python 3.9, too old; install Python 3.10"),
            (
                "python3",
                'case "$2" in *version*) echo 3.10;; *) exit 1;; esac',
                "python3 cannot make virtual environments",
            ),
            (
                "python3",
                'case "$2" in *version*) echo 3.10;; *Python.h*) echo /nowhere/Python.h;; esac',
                "python3 has no headers (/nowhere/Python.h)",
            ),
        ],
    )
    def test_one_line_names_it(self, tmp_path, tool, script, message):
        result = self.make(tmp_path, "build", **{tool: script})
        assert result.returncode != 0
        lines = result.stderr.strip().splitlines()
        assert lines[0].startswith(f"openmm-helfrich: {message}"), result.stderr
        # The other line is make's own.
        assert len(lines) == 2 and lines[1].startswith("make"), result.stderr
