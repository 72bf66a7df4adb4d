"""The same vesicle in C, C++ and Rust as in Python, built as a user would build it."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

import openmm
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich import _values

PROJECT = Path(__file__).resolve().parents[2]
OPENMM = Path(openmm.__file__).resolve().parent.parent / "OpenMM.libs"


@pytest.fixture(scope="module")
def mesh():
    """A vesicle that is not at rest, so that 1000 steps change its energy."""
    return helfrich.Mesh.icosphere(5, 1000.0).deformed(2, 0, 0.2)


@pytest.fixture(scope="module")
def mesh_file(mesh, tmp_path_factory):
    path = tmp_path_factory.mktemp("languages") / "mesh.off"
    mesh.write(path)
    return path


@pytest.fixture(scope="module")
def expected(mesh):
    """Step, potential and kinetic energy from Python."""
    system = openmm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50)
    system.addForce(helfrich.BendingForce(mesh, 50))
    system.addForce(helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area))
    system.addForce(helfrich.EnclosedVolumeForce(mesh, 0.04, mesh.volume))
    system.addForce(helfrich.TriangleHeightForce(mesh, 20, 9.977))
    integrator = openmm.VerletIntegrator(0.2)
    platform = openmm.Platform.getPlatformByName("Reference")
    context = openmm.Context(system, integrator, platform)
    context.setPositions(mesh.vertices)
    rows = []
    for step in (0, 500, 1000):
        state = context.getState(energy=True)
        energies = state.getPotentialEnergy()._value, state.getKineticEnergy()._value
        rows.append((step, *energies))
        integrator.step(500)
    return rows


def run(command, **options) -> str:
    result = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, timeout=600, **options
    )
    assert result.returncode == 0, f"{command}\n{result.stdout}\n{result.stderr}"
    return result.stdout


def check(output: str, expected) -> None:
    platform, *lines = output.splitlines()
    assert platform == "# platform Helfrich"
    rows = [tuple(float(word) for word in line.split()) for line in lines]
    assert len(rows) == 3
    assert abs(rows[2][1] - rows[0][1]) > 0.1, "the vesicle has not moved"
    for row, wanted in zip(rows, expected, strict=True):
        assert row == pytest.approx(wanted, rel=1e-6)
        assert row[1] == pytest.approx(wanted[1], rel=1e-9)


def compile_and_run(compiler, source, options, folder, mesh_file) -> str:
    program = folder / "vesicle"
    library = Path(helfrich.library_path())
    folders = [library.parent, OPENMM / "lib"]
    command = [*compiler, "-O1", "-Wall", "-Wno-unused-result", PROJECT / "examples" / source]
    command += ["-o", program, "-I", helfrich.include_path(), "-isystem", OPENMM / "include"]
    command += [flag for path in folders for flag in ("-L", path, f"-Wl,-rpath,{path}")]
    run([*command, "-lOpenMMHelfrich", "-lOpenMM", *options])
    return run([program, mesh_file])


def test_c(tmp_path, mesh_file, expected):
    compiler = os.environ.get("CC", "cc").split()
    check(compile_and_run(compiler, "vesicle.c", ["-lm"], tmp_path, mesh_file), expected)


def test_cpp(tmp_path, mesh_file, expected):
    compiler = [*os.environ.get("CXX", "c++").split(), "-std=c++17"]
    check(compile_and_run(compiler, "vesicle.cpp", [], tmp_path, mesh_file), expected)


def test_cpp_with_cmake(tmp_path, mesh_file, expected):
    cmake = shutil.which("cmake", path=str(Path(sys.executable).parent) + ":" + os.environ["PATH"])
    assert cmake is not None, "cmake is among the packages that 'make build' installs"
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.15)\n"
        "project(vesicle CXX)\n"
        f"find_package(OpenMMHelfrich {helfrich.__version__} REQUIRED)\n"
        f"add_executable(vesicle {PROJECT / 'examples' / 'vesicle.cpp'})\n"
        "target_link_libraries(vesicle OpenMMHelfrich::OpenMMHelfrich)\n"
    )
    build = tmp_path / "build"
    where = [f"-DOpenMMHelfrich_DIR={helfrich.cmake_path()}", f"-DOPENMM_DIR={OPENMM}"]
    run([cmake, "-S", tmp_path, "-B", build, *where])
    run([cmake, "--build", build])
    check(run([build / "vesicle", mesh_file]), expected)


def test_rust(mesh_file, expected):
    command = ["cargo", "run", "--quiet", "--release", "--locked", "--example", "vesicle", "--"]
    # As in the Makefile, whose tests of Rust have compiled everything.
    environment = dict(os.environ, PYTHON=sys.executable, OPENMM_DIR=str(OPENMM))
    check(run([*command, mesh_file], cwd=PROJECT, env=environment), expected)


def test_c_reports_what_is_wrong(tmp_path):
    """A scalar out of its domain gives null and a message, not the end of the program."""
    source = tmp_path / "bad.c"
    source.write_text(
        "#include <OpenMMHelfrichCWrapper.h>\n#include <stdio.h>\n"
        "int main(void) {\n"
        "    int triangles[3] = {0, 1, 2};\n"
        "    char text[300];\n"
        "    if (Helfrich_BendingForce_create(triangles, 1, -5.0, 0.0, 0) != NULL) return 2;\n"
        "    Helfrich_lastError(text, sizeof text);\n"
        "    puts(text);\n"
        "    OpenMM_Force* force = Helfrich_BendingForce_create(triangles, 1, 5.0, 0.0, 2);\n"
        '    if (Helfrich_MembraneForce_setParameterValue(force, "stiffness", 1) != 1) return 3;\n'
        "    Helfrich_lastError(text, sizeof text);\n"
        "    puts(text);\n"
        "    Helfrich_BendingForce_setRigidity(force, 7.0);\n"
        '    printf("%g\\n", Helfrich_BendingForce_getRigidity(force));\n'
        "    Helfrich_MembraneForce_destroy(force);\n"
        "    return 0;\n}\n"
    )
    compiler = os.environ.get("CC", "cc").split()
    lines = compile_and_run(compiler, source, [], tmp_path, tmp_path).splitlines()
    assert lines[0] == "BendingForce: rigidity must be a finite number, zero or above, got -5"
    assert lines[1].startswith('BendingForce: there is no parameter called "stiffness"')
    assert lines[2] == "7"


def test_c_reads_what_it_has_set_and_goes_on_elsewhere(tmp_path):
    """Forms, switches, values of elements, integrators, and connectivity of another Context."""
    compiler, source = os.environ.get("CC", "cc").split(), PROJECT / "tests/cpp/octahedron.c"
    lines = compile_and_run(compiler, source, [], tmp_path, tmp_path).splitlines()
    # Masses are those of the triangles' areas, 2 amu/nm², a third of four of them.
    assert lines[:3] == ["231 2 1 0 6 6 1", "300 7 1", "0 1 1 1"]
    assert lines[3:] == [
        "1 getImplInContext: This Force is not present in the Context",
        "1 SurfaceAreaForce: target must be a finite number above zero, got 0",
        "1 MembraneForce: the force is null; the function that should have made it had the reason "
        "in Helfrich_lastError()",
        "1 openmm-helfrich: the context is null",
        "1 BendingForce: the array for 6 values is null",
        "1 BendingForce: the number of values is negative, -3",
        "1 BendingForce: a name is null",
        "1 VariableMassVerletIntegrator: the integrator is null; the function that should have "
        "made it had the reason in Helfrich_lastError()",
    ]


def test_every_force_class_has_its_c_functions():
    """A force that is added to the C++ list must come to C programs, too."""
    header = (Path(helfrich.include_path()) / "OpenMMHelfrichCForces.h").read_text()
    library = ctypes.CDLL(helfrich.library_path())
    for force in helfrich.MembraneForce.__subclasses__():
        names = [f"Helfrich_{force.__name__}_create"]
        for scalar in _values.scalars_of(force.__name__):
            capitalised = scalar.name[0].upper() + scalar.name[1:]
            names += [f"Helfrich_{force.__name__}_{verb}{capitalised}" for verb in ("get", "set")]
        for name in names:
            assert f"{name}(" in header
            assert hasattr(library, name)
