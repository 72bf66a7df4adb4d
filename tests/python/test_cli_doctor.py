"""The command `doctor`: what it finds, also where the package cannot load its library."""

import json
import os
import subprocess
import sys

import openmm
import pytest
from click.testing import CliRunner
from openmmhelfrich import _plugin
from openmmhelfrich.cli import doctor, main


def checks_of(status=0):
    result = CliRunner().invoke(main, ["doctor", "--json"])
    assert result.exit_code == status, result.output
    found = json.loads(result.stdout)
    assert found["ok"] == (status == 0)
    return {check.pop("name"): check for check in found["checks"]}


def test_all_is_well():
    checks = checks_of()
    assert {check["status"] for check in checks.values()} <= {"ok", "missing"}
    assert checks["openmm-helfrich"]["found"].startswith(f"{_plugin.version()}, accepts OpenMM")
    assert "42 vertices" in checks["platform Helfrich"]["found"]
    assert "Helfrich" in checks["OpenMM's platforms"]["found"]
    assert all(check["advice"] for check in checks.values() if check["status"] == "missing")


def test_text_says_the_same():
    result = CliRunner().invoke(main, ["doctor"])
    assert result.exit_code == 0
    for name, check in checks_of().items():
        assert f"{check['status']:<8s} {name}: " in result.output
        assert check["advice"] in result.output
    assert result.output.endswith("All that is needed is there.\n")


def test_what_is_missing_is_not_wrong(monkeypatch):
    imported = doctor.importlib.import_module

    def load(name, package=None):
        if name == "h5py":
            raise ModuleNotFoundError("No module named 'h5py'", name="h5py")
        return imported(name, package)

    monkeypatch.setattr(doctor.importlib, "import_module", load)
    check = checks_of()["h5py"]
    assert check["status"] == "missing"
    assert check["advice"] == "pip install 'openmm-helfrich[hdf5]'"


def test_what_does_not_load_is_wrong(monkeypatch):
    imported = doctor.importlib.import_module

    def load(name, package=None):
        if name == "lz4":
            raise ImportError("libfoo.so: no such file")
        return imported(name, package)

    monkeypatch.setattr(doctor.importlib, "import_module", load)
    check = checks_of(1)["lz4"]
    assert check["status"] == "wrong"
    assert "libfoo.so" in check["found"]
    assert "--force-reinstall lz4" in check["advice"]


def test_failures_of_openmms_plugins(monkeypatch):
    failures = ["Error loading library libOpenMMCUDA.so: libcuda.so.1:\n no such file"]
    monkeypatch.setattr(openmm.Platform, "getPluginLoadFailures", lambda: failures)
    check = checks_of()["plugin of OpenMM"]
    assert check["status"] == "missing"
    assert "libcuda.so.1: no such file" in check["found"]


def test_cache_folder(monkeypatch, tmp_path):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert checks_of()["cache folder"]["found"] == str(tmp_path / "openmm-helfrich")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    check = checks_of()["cache folder"]
    assert check["status"] == "missing"
    assert "Not a directory" in check["found"]


def test_variables(monkeypatch):
    monkeypatch.setenv("OPENMM_CPU_THREADS", "1")
    monkeypatch.setenv("HELFRICH_BAKEND", "cpu")
    checks = checks_of()
    assert checks["OPENMM_CPU_THREADS"]["found"].startswith("'1', how many threads")
    assert "does not use" in checks["HELFRICH_BAKEND"]["found"]
    monkeypatch.setenv("OPENMM_DEFAULT_PLATFORM", "Abacus")
    assert "'Abacus'" in checks_of(1)["OpenMM's platforms"]["found"]


def test_energy_that_is_no_number_is_wrong(monkeypatch):
    monkeypatch.setattr(doctor.math, "isfinite", lambda value: False)
    assert checks_of(1)["platform Helfrich"]["status"] == "wrong"


@pytest.mark.parametrize("program", ["openmm-helfrich", "another-program"])
def test_a_package_that_cannot_be_imported(program):
    """The doctor comes all the same, and only where it is called."""
    code = (
        f"import sys, openmm; sys.argv = [{program!r}, 'doctor', '--json']\n"
        "openmm.Platform.getOpenMMVersion = staticmethod(lambda: '7.7')\n"
        "import openmmhelfrich"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env=os.environ
    )
    assert done.returncode == 1
    if program == "another-program":
        assert "ImportError: openmmhelfrich was built for OpenMM" in done.stderr
        assert done.stdout == ""
        return
    checks = {check["name"]: check for check in json.loads(done.stdout)["checks"]}
    assert checks["openmm-helfrich"]["status"] == "wrong"
    assert "but this is OpenMM 7.7" in checks["openmm-helfrich"]["advice"]
    assert "platform Helfrich" not in checks
    assert checks["numpy"]["status"] == "ok"
