"""The library is an OpenMM plugin: a C++ program without Python loads it and reads its forces."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich import _core

SOURCE = Path(__file__).resolve().parents[1] / "cpp" / "plugin.cpp"
OPENMM = Path(mm.__file__).parent.parent / "OpenMM.libs"
OWN_PLUGINS = OPENMM / "lib" / "plugins"


@pytest.fixture(scope="module")
def program(tmp_path_factory) -> Path:
    """The compiled program."""
    path = tmp_path_factory.mktemp("cpp") / "plugin"
    compiler = os.environ.get("CXX", "c++").split()
    options = ["-std=c++17", "-Wall", "-Wextra", "-isystem", str(OPENMM / "include")]
    link = ["-L", str(OPENMM / "lib"), "-lOpenMM"]
    subprocess.run([*compiler, *options, str(SOURCE), "-o", str(path), *link], check=True)
    return path


class Output:
    """What the program prints, sorted by the first word of each line."""

    def __init__(self, text: str):
        self.loaded = []
        self.failures = []
        self.energies = {}
        self.errors = {}
        for line in text.splitlines():
            word, value = line.split(" ", 1)
            if word == "loaded":
                self.loaded.append(Path(value))
            elif word == "failure":
                self.failures.append(value)
            elif word == "energy":
                platform, group, energy = value.split()
                self.energies.setdefault(platform, {})[int(group)] = float(energy)
            elif word == "error":
                platform, message = value.split(" ", 1)
                self.errors[platform] = message


def run(
    program: Path, directory: str, files: tuple[Path, Path], lib=OPENMM / "lib", **variables
) -> Output:
    """Run the program in an environment that has nothing of Python's."""
    environment = {"PATH": os.environ["PATH"], "LD_LIBRARY_PATH": str(lib), **variables}
    result = subprocess.run(
        [str(program), directory, *map(str, files)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert result.returncode == 0, result.stderr
    return Output(result.stdout)


def system_of(triangles: np.ndarray, num_particles: int) -> mm.System:
    """A System with one force of each class, each in a group of its own."""
    system = mm.System()
    for _ in range(num_particles):
        system.addParticle(50)
    forces = [
        helfrich.SurfaceAreaForce(triangles, 1.3, 100),
        helfrich.EnclosedVolumeForce(triangles, 4, 90),
        helfrich.BendingForce(triangles, 50, 0.1),
        helfrich.TriangleHeightForce(triangles, 1.5, 10),
    ]
    for group, force in enumerate(forces):
        force.setForceGroup(group)
        system.addForce(force)
    return system


@pytest.fixture(scope="module")
def membrane(lumpy, tmp_path_factory):
    """A System, its positions, and the files that hold both for the program."""
    folder = tmp_path_factory.mktemp("system")
    system = system_of(lumpy.triangles, lumpy.num_vertices)
    (folder / "system.xml").write_text(mm.XmlSerializer.serialize(system))
    np.savetxt(folder / "positions.txt", lumpy.vertices, fmt="%.17g")
    return system, lumpy.vertices, (folder / "system.xml", folder / "positions.txt")


def energies_in_python(system: mm.System, positions: np.ndarray) -> dict[int, float]:
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.1), platform)
    context.setPositions(positions)
    groups = [force.getForceGroup() for force in system.getForces()]
    return {
        group: context.getState(getEnergy=True, groups={group}).getPotentialEnergy()._value
        for group in groups
    }


def assert_finds_and_computes(output: Output, library: Path, membrane, platforms):
    """The library was loaded from its place, nothing failed, and all energies are Python's."""
    assert library in output.loaded
    # Platforms for which a machine has no driver may fail; nothing of ours may.
    assert not [text for text in output.failures if "OpenCL" not in text and "CUDA" not in text]
    system, positions, _ = membrane
    expected = energies_in_python(system, positions)
    assert len(expected) == 4 and all(energy > 1e-3 for energy in expected.values())
    assert output.errors == {}
    assert set(output.energies) == platforms
    for energies in output.energies.values():
        assert energies == pytest.approx(expected, rel=1e-12, abs=0)


def test_from_its_own_folder(program, membrane):
    """The folder of the package holds nothing but the plugin, so no failure at all is allowed."""
    output = run(program, str(_core.LIBRARY_PATH.parent), membrane[2])
    assert output.loaded == [_core.LIBRARY_PATH] and output.failures == []
    assert_finds_and_computes(output, _core.LIBRARY_PATH, membrane, {"Reference", "Helfrich"})


def test_from_the_environment(program, membrane):
    """OPENMM_PLUGIN_DIR takes several folders: here OpenMM's own and the plugin's."""
    folders = f"{OWN_PLUGINS}{os.pathsep}{_core.LIBRARY_PATH.parent}"
    output = run(program, "default", membrane[2], OPENMM_PLUGIN_DIR=folders)
    assert_finds_and_computes(
        output, _core.LIBRARY_PATH, membrane, {"Reference", "CPU", "Helfrich"}
    )


def test_from_the_plugin_folder(program, membrane, tmp_path):
    """A copy among OpenMM's own plugins, in a stand-in of an OpenMM installation."""
    lib = tmp_path / "lib"
    plugins = lib / "plugins"
    plugins.mkdir(parents=True)
    for original in OPENMM.glob("lib/*.so*"):
        (lib / original.name).symlink_to(original)
    for original in OWN_PLUGINS.glob("*.so*"):
        (plugins / original.name).symlink_to(original)
    library = Path(shutil.copy(_core.LIBRARY_PATH, plugins))
    output = run(program, str(plugins), membrane[2], lib=lib)
    assert_finds_and_computes(output, library, membrane, {"Reference", "CPU", "Helfrich"})


def test_a_bad_mesh_is_an_exception_with_the_class_name(program, lumpy, tmp_path):
    system = system_of([*lumpy.triangles[1:], lumpy.triangles[0, ::-1]], lumpy.num_vertices)
    files = (tmp_path / "system.xml", tmp_path / "positions.txt")
    files[0].write_text(mm.XmlSerializer.serialize(system))
    np.savetxt(files[1], lumpy.vertices)
    output = run(program, str(_core.LIBRARY_PATH.parent), files)
    assert output.energies == {}
    assert output.errors["Reference"].startswith("SurfaceAreaForce: triangles ")
    assert "in the same direction" in output.errors["Reference"]


def test_without_the_plugin_the_forces_are_unknown(program, membrane, tmp_path):
    """What a user sees who forgets the plugin: OpenMM's message, which names the class."""
    environment = {"LD_LIBRARY_PATH": str(OPENMM / "lib")}
    result = subprocess.run(
        [str(program), str(tmp_path), *map(str, membrane[2])],
        env=environment,
        capture_output=True,
        text=True,
    )
    assert result.returncode == 1
    assert "HelfrichSurfaceAreaForce" in result.stderr
