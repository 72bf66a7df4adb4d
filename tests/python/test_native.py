"""Membranes that OpenMM's GPU platforms evaluate themselves: OpenCL, on PoCL for example.

`test_gpu.py` has the rows of the table of cases; here is what only these platforms have. With the
environment variable HELFRICH_NATIVE_PLATFORM, such as CUDA, both run on that platform.
"""

from __future__ import annotations

import copy
import os
import subprocess
import sys
import textwrap

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from meshes import membrane
from openmm import unit
from platforms import NATIVE, REFERENCE, UNASKED, Target, native_is_on_processor
from running import Running, plain

SINGLE, MIXED, DOUBLE = NATIVE


def evaluations() -> dict[str, int]:
    return helfrich.backend.evaluations()


def vesicle(num_vertices: int = 252) -> tuple[helfrich.Mesh, list[mm.Force]]:
    """A vesicle with one force for each kind of element."""
    mesh = helfrich.Mesh.random_sphere(num_vertices, radius=100.0, seed=1)
    heights = float(np.sqrt(mesh.area / len(mesh.triangles)))
    return mesh, [
        helfrich.BendingForce(mesh, 50),
        helfrich.SurfaceAreaForce(mesh, 10, mesh.area),
        helfrich.EnclosedVolumeForce(mesh, 1, 0.9 * mesh.volume),
        helfrich.TriangleHeightForce(mesh, 0.4 * heights, 10),
    ]


def context_of(target: Target, system: mm.System, forces, integrator: mm.Integrator) -> mm.Context:
    for force in forces:
        if target.backend:
            force.setBackend(target.backend)
        system.addForce(force)
    return target.context(system, integrator)


def system_of(count: int, mass: float = 50.0) -> mm.System:
    system = mm.System()
    for _ in range(count):
        system.addParticle(mass)
    return system


# --- dynamics ------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", [MIXED, DOUBLE], ids=str)
def test_verlet_keeps_its_energy(target: Target):
    mesh, forces = vesicle()
    integrator = mm.VerletIntegrator(0.02)
    context = context_of(target, system_of(mesh.num_vertices), forces, integrator)
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(500)
    energies, kinetic = [], []
    for _ in range(10):
        integrator.step(200)
        state = context.getState(energy=True)
        kinetic.append(plain(state.getKineticEnergy()))
        energies.append(plain(state.getPotentialEnergy()) + kinetic[-1])
    assert np.ptp(energies) < 1e-3 * np.mean(kinetic)


def paper(target: Target, integrator: mm.Integrator) -> mm.Context:
    """The paper's vesicle, N = 1002, in equilibrium."""
    mesh = helfrich.Mesh.random_sphere(1002, radius=1000, seed=1)
    vesicle = helfrich.Vesicle(mesh)
    warm = vesicle.simulation(mm.LangevinMiddleIntegrator(300, 0.01, 0.1), "Helfrich")
    warm.integrator.setRandomNumberSeed(1)
    warm.context.reinitialize()
    warm.context.setPositions(mesh.vertices)
    warm.context.setVelocitiesToTemperature(300, 1)
    warm.step(10_000)
    state = warm.context.getState(positions=True, velocities=True)
    system = vesicle.system()
    for force in helfrich.platforms.membranes_of(system):
        force.setBackend(target.backend)
    context = target.context(system, integrator)
    context.setPositions(state.getPositions(asNumpy=True))
    context.setVelocities(state.getVelocities(asNumpy=True))
    return context


def test_verlet_keeps_the_energy_of_the_papers_vesicle():
    """To a part of 1e5 of the kinetic energy in mixed precision; 20 000 steps keep 1e-6."""
    integrator = mm.VerletIntegrator(0.1)
    context = paper(MIXED, integrator)
    energies, kinetic = [], []
    for _ in range(10):
        integrator.step(200)
        state = context.getState(energy=True)
        kinetic.append(plain(state.getKineticEnergy()))
        energies.append(plain(state.getPotentialEnergy()) + kinetic[-1])
    assert np.ptp(energies) < 1e-5 * np.mean(kinetic)


@pytest.mark.parametrize("target", [SINGLE, MIXED], ids=str)
def test_langevin_keeps_the_papers_vesicle_in_its_bath(target: Target):
    integrator = mm.LangevinMiddleIntegrator(300, 1, 0.1)
    integrator.setRandomNumberSeed(1)
    context = paper(target, integrator)
    start = context.getState(positions=True).getPositions(asNumpy=True)
    temperatures = []
    for _ in range(40):
        integrator.step(50)
        kinetic = plain(context.getState(energy=True).getKineticEnergy())
        temperatures.append(kinetic / (1.5 * 1002 * helfrich.analysis.theory.BOLTZMANN))
    # One value has a standard deviation of 7.7 K.
    assert np.mean(temperatures) == pytest.approx(300, abs=5)
    mesh = helfrich.Mesh.random_sphere(1002, radius=1000, seed=1)
    for found in (start, context.getState(positions=True).getPositions(asNumpy=True)):
        now = helfrich.Mesh(plain(found), mesh.triangles)
        assert now.area == pytest.approx(1.006 * mesh.area, rel=2e-3)
        assert now.volume == pytest.approx(mesh.volume, rel=2e-3)


def test_the_device_follows_flips():
    """After rounds of flips its forces are those of the Context's present triangles."""
    mesh, forces = vesicle()
    flips = helfrich.MonteCarloBondFlip(mesh, 300, frequency=5)
    integrator = mm.LangevinMiddleIntegrator(300, 1, 0.01)
    integrator.setRandomNumberSeed(1)
    system = system_of(mesh.num_vertices)
    system.addForce(flips)
    context = context_of(DOUBLE, system, forces, integrator)
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    before = evaluations()["native"]
    integrator.step(100)
    assert evaluations()["native"] >= before + 100
    triangles = forces[0].getTrianglesInContext(context)
    assert (triangles != mesh.triangles).any()
    state = context.getState(energy=True, forces=True, positions=True)
    positions = plain(state.getPositions(asNumpy=True))
    heights = float(np.sqrt(mesh.area / len(mesh.triangles)))
    others = [
        helfrich.BendingForce(triangles, 50),
        helfrich.SurfaceAreaForce(triangles, 10, mesh.area),
        helfrich.EnclosedVolumeForce(triangles, 1, 0.9 * mesh.volume),
        helfrich.TriangleHeightForce(triangles, 0.4 * heights, 10),
    ]
    expected = Running(others, mesh.num_vertices, Target("", "Reference", 1e-9, {}, "cpu"))
    energy, reference = expected.evaluate(positions)
    assert plain(state.getPotentialEnergy()) == pytest.approx(energy, rel=1e-9)
    found = plain(state.getForces(asNumpy=True))
    assert np.abs(found - reference).max() < 1e-8 * np.abs(reference).max()


@pytest.mark.parametrize("target", [MIXED, DOUBLE], ids=str)
def test_in_a_bath_that_openmm_sorts_and_wraps(target: Target):
    """OpenMM exchanges particles of a bath in memory, and wraps a vesicle on a face of the box."""
    mesh, forces = vesicle()
    rng = np.random.default_rng(2)
    bath = rng.uniform(0, 600, (1000, 3))
    vertices = mesh.vertices + np.array([600, 300, 0])
    bath = bath[np.linalg.norm((bath - [600, 300, 0] + 300) % 600 - 300, axis=1) > 130]
    # The vesicle's particles are in the middle.
    half = len(bath) // 2
    positions = np.concatenate([bath[:half], vertices, bath[half:]])
    system = system_of(len(positions))
    system.setDefaultPeriodicBoxVectors(*(600 * np.eye(3)))
    nonbonded = mm.CustomNonbondedForce("10*step(20-r)*(1-r/20)^2")
    for _ in positions:
        nonbonded.addParticle()
    nonbonded.setNonbondedMethod(nonbonded.CutoffPeriodic)
    nonbonded.setCutoffDistance(25)
    nonbonded.setForceGroup(1)
    system.addForce(nonbonded)
    moved = [
        type(force)(*arguments, offset=half)
        for force, arguments in zip(
            forces,
            [(mesh, 50), (mesh, 10, mesh.area), (mesh, 1, 0.9 * mesh.volume), (mesh, 5, 10)],
            strict=True,
        )
    ]
    integrator = mm.LangevinMiddleIntegrator(300, 1, 0.05)
    integrator.setRandomNumberSeed(1)
    context = context_of(target, system, moved, integrator)
    context.setPositions(positions)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(600)
    state = context.getState(positions=True, forces=True, energy=True, groups={0})
    reference = Running(
        [copy.copy(force) for force in moved],
        len(positions),
        Target("", "Reference", 1e-9, {}, "cpu"),
    )
    expected = reference.evaluate(plain(state.getPositions(asNumpy=True)))
    found = plain(state.getForces(asNumpy=True))
    assert plain(state.getPotentialEnergy()) == pytest.approx(expected[0], rel=target.tolerance)
    largest = np.abs(expected[1]).max()
    assert largest > 1
    assert np.abs(found - expected[1]).max() < target.tolerance * largest


# --- beside the processor ------------------------------------------------------------------------


def test_contacts_are_computed_beside_it():
    """The processor adds them to the same Context, by force groups and all together."""
    mesh = helfrich.Mesh.disk(8, 100.0)
    rng = np.random.default_rng(3)
    positions = mesh.vertices + rng.normal(scale=1.0, size=mesh.vertices.shape)

    def forces():
        return [
            helfrich.BendingForce(mesh, 50),
            helfrich.EdgeTensionForce(mesh, 3.0),
            helfrich.TriangleAreaForce(mesh, 1.0, mesh.area / len(mesh.triangles)),
            helfrich.SurfaceRepulsionForce(mesh, 8.0, 5.0),
        ]

    found = Running(forces(), mesh.num_vertices, DOUBLE)
    expected = Running(forces(), mesh.num_vertices, REFERENCE)
    before = evaluations()
    for group in (-1, 0, 1, 2, 3):
        energy, of_group = found.evaluate(positions, group)
        reference = expected.evaluate(positions, group)
        assert energy == pytest.approx(reference[0], rel=1e-9, abs=1e-12)
        assert np.abs(of_group - reference[1]).max() <= 1e-9 * max(np.abs(reference[1]).max(), 1)
    assert evaluations()["native"] == before["native"] + 4


def test_a_volume_in_a_periodic_box_is_left_to_the_processor():
    """It needs the surface in one piece; `test_periodic.py` has the other forces."""
    mesh, forces = vesicle()
    for force in forces:
        force.setUsesPeriodicBoundaryConditions(True)
    system = system_of(mesh.num_vertices)
    system.setDefaultPeriodicBoxVectors(*(500 * np.eye(3)))
    context = context_of(DOUBLE, system, forces, mm.VerletIntegrator(0.01))
    # On a corner of the box, wrapped into it vertex by vertex.
    context.setPositions(mesh.vertices % 500)
    before = evaluations()
    state = context.getState(energy=True, forces=True)
    grown = {name for name, count in evaluations().items() if count > before[name]}
    assert grown == {"native", "cpu"}
    expected = Running(vesicle()[1], mesh.num_vertices, REFERENCE).evaluate(mesh.vertices)
    assert plain(state.getPotentialEnergy()) == pytest.approx(expected[0], rel=1e-9)
    found = plain(state.getForces(asNumpy=True))
    assert np.abs(found - expected[1]).max() < 1e-9 * np.abs(expected[1]).max()


# --- choice --------------------------------------------------------------------------------------


def test_it_is_refused_on_other_platforms():
    m = membrane("octahedron")
    force = helfrich.BendingForce(m.triangles, 50)
    force.setBackend("native")
    with pytest.raises(
        mm.OpenMMException,
        match=r"BendingForce: .*native.*the platform Reference is none of OpenCL",
    ):
        Running([force], m.num_particles, REFERENCE)


def test_the_minimizers_context_beside_it_is_not_refused():
    """Where forces are too large for its numbers, OpenMM's minimizer has one on the processor."""
    mesh, forces = vesicle()
    system = system_of(mesh.num_vertices)
    context = context_of(SINGLE, system, forces, mm.VerletIntegrator(0.01))
    other = REFERENCE.context(system)
    energies = []
    for one in (context, other):
        one.setPositions(mesh.vertices)
        energies.append(plain(one.getState(energy=True).getPotentialEnergy()))
    assert energies[0] == pytest.approx(energies[1], rel=1e-5)
    del context, one, other
    with pytest.raises(mm.OpenMMException, match="Reference is none of OpenCL"):
        REFERENCE.context(system)


def test_a_driver_on_the_processor_is_taken_only_where_it_is_asked_for():
    """A real GPU is taken unasked."""
    m = membrane("octahedron")
    before = evaluations()
    run = Running([helfrich.BendingForce(m.triangles, 50)], m.num_particles, UNASKED)
    run.evaluate(m.positions)
    after = evaluations()
    expected = "cpu" if native_is_on_processor() else "native"
    assert {name for name in after if after[name] > before[name]} == {expected}


@pytest.mark.parametrize("place", [0, 3])
def test_one_force_asks_for_all_on_its_triangles(place: int):
    """Whichever of them it is: they are computed together."""
    mesh, forces = vesicle()
    forces[place].setBackend("native")
    system = system_of(mesh.num_vertices)
    for force in forces:
        system.addForce(force)
    context = DOUBLE.context(system)
    context.setPositions(mesh.vertices)
    before = evaluations()
    context.getState(energy=True)
    after = evaluations()
    assert {name: after[name] - before[name] for name in after} == {"cpu": 0, "gpu": 0, "native": 1}


def test_derivatives_need_it():
    UNASKED.context(system_of(1))
    if not native_is_on_processor():
        pytest.skip("a GPU is taken unasked")
    m = membrane("octahedron")
    force = helfrich.BendingForce(m.triangles, 50)
    force.setContextParameter("rigidity", "kappa")
    force.addEnergyParameterDerivative("kappa")
    with pytest.raises(mm.OpenMMException, match=r'energy parameter derivatives need .*"native"'):
        Running([force], m.num_particles, UNASKED)


def test_an_explosion_is_found_without_energies():
    """Steps that nobody asks anything of are looked at now and then."""
    mesh, forces = vesicle()
    integrator = mm.VerletIntegrator(1e3)
    context = context_of(SINGLE, system_of(mesh.num_vertices, 1e-3), forces, integrator)
    context.setPositions(mesh.vertices + np.random.default_rng(1).normal(size=mesh.vertices.shape))
    with pytest.raises(mm.OpenMMException, match=r"particle|position|triangle"):
        integrator.step(1100)


def test_a_triangle_without_area_is_found_without_energies():
    """Its vertices are held, so that no force of theirs spoils any position."""
    mesh, (_, area, _, _) = vesicle()
    system = system_of(mesh.num_vertices)
    for vertex in mesh.triangles[5].tolist():
        system.setParticleMass(vertex, 0)
    integrator = mm.VerletIntegrator(1e-5)
    context = context_of(DOUBLE, system, [area], integrator)
    context.setPositions(mesh.vertices)
    context.getState(energy=True)
    flat = mesh.vertices.copy()
    flat[mesh.triangles[5]] = flat[mesh.triangles[5, 0]] + [[1, 1, 1], [2, 2, 2], [4, 4, 4]]
    context.setPositions(flat)
    with pytest.raises(mm.OpenMMException, match=r"triangle 5 .* has no area"):
        integrator.step(1001)


@pytest.mark.parametrize("target", [SINGLE, DOUBLE], ids=str)
def test_an_energy_that_overflows(target: Target):
    """The processor names it if it overflows there, too; otherwise it is infinite."""
    mesh, (_, area, _, _) = vesicle()
    area.setContextParameter("target", "a target")
    run = Running([area], mesh.num_vertices, target)
    energy, _ = run.evaluate(mesh.vertices)
    run.context.setParameter("a target", 1e-300)
    with pytest.raises(mm.OpenMMException, match="the energy of SurfaceAreaForce is not finite"):
        run.evaluate(mesh.vertices)
    run.context.setParameter("a target", 1e-30)
    huge, _ = run.evaluate(mesh.vertices)
    in_double = 0.5 * 10 * mesh.area**2 / 1e-30
    assert huge == (np.inf if target is SINGLE else pytest.approx(in_double))
    run.context.setParameter("a target", mesh.area)
    assert run.evaluate(mesh.vertices)[0] == energy


OVERFLOW = """
import openmm as mm
import openmmhelfrich as helfrich

mesh = helfrich.Mesh.icosphere(2, 100.0)
force = helfrich.SurfaceAreaForce(mesh, 10, 1e-30)
force.setBackend("native")
system = mm.System()
for _ in mesh.vertices:
    system.addParticle(50)
system.addForce(force)
platform = mm.Platform.getPlatformByName("OpenCL")
context = mm.Context(system, mm.VerletIntegrator(0.01), platform)
context.setPositions(mesh.vertices)
for _ in range(2):
    print(context.getState(energy=True).getPotentialEnergy()._value)
"""


def test_that_an_energy_overflows_is_said_once():
    SINGLE.context(system_of(1))
    result = subprocess.run(
        [sys.executable, "-c", OVERFLOW], capture_output=True, text=True, timeout=300, check=True
    )
    assert result.stdout.splitlines()[-2:] == ["inf", "inf"]
    assert result.stderr.count("an energy of the membrane is beyond 3e38 kJ/mol") == 1


@pytest.mark.parametrize("target", [REFERENCE, *NATIVE], ids=str)
def test_a_surface_inside_out_is_refused_whenever_its_volume_is_asked_for(target: Target):
    """After other terms have been evaluated, and after the triangles have been turned."""
    mesh, _ = vesicle(92)
    turned = mesh.triangles[:, ::-1].copy()

    def forces(triangles):
        return [
            helfrich.BendingForce(triangles, 50),
            helfrich.EnclosedVolumeForce(triangles, 1, mesh.volume),
        ]

    run = Running(forces(turned), mesh.num_vertices, target)
    run.evaluate(mesh.vertices, 0)
    with pytest.raises(mm.OpenMMException, match=r"EnclosedVolumeForce: .*clockwise"):
        run.evaluate(mesh.vertices, 1)
    others = forces(mesh)
    run = Running(others, mesh.num_vertices, target)
    run.evaluate(mesh.vertices)
    others[1].setTrianglesInContext(run.context, turned)
    with pytest.raises(mm.OpenMMException, match=r"EnclosedVolumeForce: .*clockwise"):
        run.evaluate(mesh.vertices)


# --- transfers -----------------------------------------------------------------------------------

COUNTER = r"""
#include <dlfcn.h>
#include <stddef.h>
static long reads, writes;
long count_reads(void) { return reads; }
long count_writes(void) { return writes; }
static void* real(const char* library, const char* name) {
    return dlsym(dlopen(library, RTLD_LAZY), name);
}

#define TRANSFER(NAME, COUNT) \
int NAME(void* q, void* b, unsigned w, size_t o, size_t s, void* p, unsigned n, void* l, void* e) \
{ \
    COUNT++; \
    return ((int (*)(void*, void*, unsigned, size_t, size_t, void*, unsigned, void*, void*)) \
        real("libOpenCL.so.1", #NAME))(q, b, w, o, s, p, n, l, e); \
}
TRANSFER(clEnqueueReadBuffer, reads)
TRANSFER(clEnqueueWriteBuffer, writes)
void* clEnqueueMapBuffer(void* q, void* b, unsigned w, unsigned long f, size_t o, size_t s,
        unsigned n, void* l, void* e, int* r) {
    reads++;
    return ((void* (*)(void*, void*, unsigned, unsigned long, size_t, size_t, unsigned, void*,
        void*, int*)) real("libOpenCL.so.1", "clEnqueueMapBuffer"))(q, b, w, f, o, s, n, l, e, r);
}

#define COPY(NAME, COUNT) \
int NAME(void* to, void* from, size_t size, void* stream) \
{ \
    COUNT++; \
    return ((int (*)(void*, void*, size_t, void*)) real("libcuda.so.1", #NAME))( \
        to, from, size, stream); \
}
// Those without a stream ignore what is in the place of one.
COPY(cuMemcpyDtoH_v2, reads)
COPY(cuMemcpyDtoHAsync_v2, reads)
COPY(cuMemcpyHtoD_v2, writes)
COPY(cuMemcpyHtoDAsync_v2, writes)
"""

STEPS = """
import ctypes, sys
import openmm as mm
import openmmhelfrich as helfrich

count = ctypes.CDLL(sys.argv[1])
mesh = helfrich.Mesh.icosphere(4, 100.0)
system = mm.System()
for _ in mesh.vertices:
    system.addParticle(50)
if sys.argv[3] != "none":
    for force in (
        helfrich.BendingForce(mesh, 50),
        helfrich.SurfaceAreaForce(mesh, 10, mesh.area),
        helfrich.EnclosedVolumeForce(mesh, 1, 0.9 * mesh.volume),
        helfrich.TriangleHeightForce(mesh, 5, 10),
    ):
        force.setBackend(sys.argv[3])
        if sys.argv[4:] == ["derivatives"]:
            name = f"{type(force).__name__} 0"
            force.setContextParameter(force.getParameterName(0), name)
            force.addEnergyParameterDerivative(name)
        system.addForce(force)
integrator = mm.LangevinMiddleIntegrator(300, 1, 0.01)
platform = mm.Platform.getPlatformByName(sys.argv[2])
context = mm.Context(system, integrator, platform, {"Precision": "mixed"})
context.setPositions(mesh.vertices)
integrator.step(10)
context.getState(energy=True)
integrator.step(1)
before = count.count_reads(), count.count_writes()
integrator.step(300)
print("transfers", count.count_reads() - before[0], count.count_writes() - before[1])
"""


def test_a_step_transfers_nothing(tmp_path):
    """Counted where OpenCL or CUDA is called: as many reads and writes as without any force.

    Derivatives, which OpenMM has in every step once they are asked for, change nothing.
    """
    DOUBLE.context(system_of(1))
    if DOUBLE.platform not in ("OpenCL", "CUDA"):
        pytest.skip(f"transfers of {DOUBLE.platform} are not counted")
    source, library = tmp_path / "count.c", tmp_path / "count.so"
    source.write_text(COUNTER, encoding="ascii")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)

    def transfers(*wanted: str) -> list[int]:
        result = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(STEPS), library, DOUBLE.platform, *wanted],
            env={**os.environ, "LD_PRELOAD": str(library)},
            capture_output=True,
            text=True,
            timeout=300,
            check=True,
        )
        line = next(line for line in result.stdout.splitlines() if line.startswith("transfers"))
        return [int(word) for word in line.split()[1:]]

    assert transfers("native") == transfers("none")
    assert transfers("native", "derivatives") == transfers("none")
    assert sum(transfers("cpu")) >= 600


def test_units_of_length_do_not_show():
    """A membrane at two sizes in a ratio of two has the same bits, but for the power of two."""
    mesh, _ = vesicle()
    found = []
    for scale in (1.0, 1024.0):
        force = helfrich.BendingForce(mesh, 50)
        run = Running([force], mesh.num_vertices, SINGLE)
        found.append(run.evaluate(scale * SINGLE.rounded(mesh.vertices)))
    assert found[0][0] == found[1][0]
    assert unit.is_quantity(run.context.getState(energy=True).getPotentialEnergy())
