"""Which platform a simulation gets where none is named: by OpenMM, and at every door of ours."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import app
from openmmhelfrich import platforms
from platforms import CPU, HELFRICH, ON_OPENCL, REFERENCE, counting

PROJECT = Path(__file__).resolve().parents[2]
MESH = helfrich.Mesh.icosphere(3, 100.0).deformed(2, 1, 0.1)
N = MESH.num_vertices
VERLET = mm.VerletIntegrator(0.001)


@pytest.fixture(autouse=True)
def no_default(monkeypatch):
    """The machine's own wish is not what is tested."""
    monkeypatch.delenv("OPENMM_DEFAULT_PLATFORM", raising=False)


def vesicle_with(*forces, particles: int = 0) -> mm.System:
    system = helfrich.Vesicle(MESH).system()
    for _ in range(particles):
        system.addParticle(1)
    for force in forces:
        system.addForce(force)
    return system


def chosen(system, integrator=None, *platform) -> str:
    """The name of the platform that a Context is on."""
    context = mm.Context(system, integrator or mm.VerletIntegrator(0.001), *platform)
    return context.getPlatform().getName()


def named(name: str) -> mm.Platform:
    return mm.Platform.getPlatformByName(name)


def nonbonded(particles: int = N) -> mm.NonbondedForce:
    force = mm.NonbondedForce()
    for _ in range(particles):
        force.addParticle(0, 1, 0)
    return force


def custom_nonbonded(particles: int = N) -> mm.CustomNonbondedForce:
    force = mm.CustomNonbondedForce("1/r")
    for _ in range(particles):
        force.addParticle()
    return force


def born(particles: int = N) -> mm.GBSAOBCForce:
    force = mm.GBSAOBCForce()
    for _ in range(particles):
        force.addParticle(0, 1, 1)
    return force


def bonds(number: int) -> mm.HarmonicBondForce:
    force = mm.HarmonicBondForce()
    for i in range(number):
        force.addBond(i % N, (i + 1) % N, 1, 1e-9)
    return force


def walls() -> mm.CustomExternalForce:
    force = mm.CustomExternalForce("z^2")
    for i in range(N):
        force.addParticle(i)
    return force


def elsewhere(particles: int = 10) -> str:
    """What OpenMM chooses for a System that has nothing of ours."""
    system = mm.System()
    for _ in range(particles):
        system.addParticle(1)
    system.addForce(nonbonded(particles))
    return chosen(system)


CHEAP = {
    "membrane alone": list,
    "springs": lambda: [bonds(3 * N)],
    "walls": lambda: [walls()],
    "thermostat and centre of mass": lambda: [mm.AndersenThermostat(300, 1), mm.CMMotionRemover()],
}
COSTLY = {
    "NonbondedForce": nonbonded,
    "CustomNonbondedForce": custom_nonbonded,
    "GBSAOBCForce": born,
    "terms of other forces refer to": lambda: bonds(10 * N + 1),
}


class TestOpenMMsChoice:
    """`openmm.Context(system, integrator)`."""

    @pytest.mark.parametrize("forces", CHEAP.values(), ids=CHEAP)
    def test_membranes_get_helfrich(self, forces):
        assert chosen(vesicle_with(*forces())) == "Helfrich"

    def test_so_do_simulations(self):
        system = vesicle_with()
        simulation = app.Simulation(MESH.topology(), system, mm.BrownianIntegrator(300, 1, 0.01))
        assert simulation.context.getPlatform().getName() == "Helfrich"

    def test_of_any_force(self):
        for force in (helfrich.BendingForce(MESH, 50), helfrich.TriangleHeightForce(MESH, 5, 1)):
            system = mm.System()
            for _ in range(N):
                system.addParticle(1)
            # From XML it is a plain Force.
            system.addForce(mm.XmlSerializer.clone(force))
            assert chosen(system) == "Helfrich"

    @pytest.mark.parametrize("reason", COSTLY)
    def test_mixed_systems_go_where_they_went(self, reason):
        assert chosen(vesicle_with(COSTLY[reason]())) == elsewhere()
        # Nor does what was refused leave anything behind.
        assert chosen(vesicle_with()) == "Helfrich"
        assert elsewhere() != "Helfrich"

    def test_integrators(self):
        for integrator in (
            mm.CustomIntegrator(0.001),
            mm.MTSIntegrator(0.001, [(0, 1)]),
            mm.LangevinIntegrator(300, 1, 0.001),
            mm.NoseHooverIntegrator(300, 1, 0.001),
        ):
            assert chosen(vesicle_with(), integrator) == "Helfrich"
        assert chosen(vesicle_with(), mm.DPDIntegrator(300, 1, 1, 0.001)) == elsewhere()

    @pytest.mark.parametrize("target", [REFERENCE, CPU, HELFRICH], ids=str)
    @pytest.mark.parametrize("reason", [None, *COSTLY])
    def test_a_platform_that_is_named(self, target, reason):
        system = vesicle_with(*([] if reason is None else [COSTLY[reason]()]))
        assert chosen(system, None, named(target.platform)) == target.platform
        # As often as one likes: the first might have left a note.
        assert chosen(system, None, named(target.platform)) == target.platform

    def test_the_second_entry_named(self):
        count = mm.Platform.getNumPlatforms()
        last = [
            mm.Platform.getPlatform(i)
            for i in range(count)
            if mm.Platform.getPlatform(i).getName() == "Helfrich"
        ][-1]
        assert chosen(vesicle_with(nonbonded()), None, last) == "Helfrich"

    def test_reinitialize_stays(self):
        context = mm.Context(vesicle_with(), mm.VerletIntegrator(0.001))
        context.getSystem().addForce(nonbonded())
        context.reinitialize()
        assert context.getPlatform().getName() == "Helfrich"
        context = mm.Context(vesicle_with(), mm.VerletIntegrator(0.001), named("CPU"))
        context.reinitialize()
        assert context.getPlatform().getName() == "CPU"

    def test_membranes_inside_collective_variables(self):
        """Their Context is one that OpenMM makes on the outer one's platform."""
        variables = mm.CustomCVForce("0.5*bend^2")
        variables.addCollectiveVariable("bend", helfrich.BendingForce(MESH, 50))
        context = mm.Context(vesicle_with(variables), mm.VerletIntegrator(0.001))
        context.setPositions(MESH.vertices)
        assert context.getPlatform().getName() == "Helfrich"
        (bend,) = variables.getCollectiveVariableValues(context)
        assert bend == pytest.approx(MESH.energy(helfrich.BendingForce(MESH, 50)), rel=1e-12)
        costly = mm.CustomCVForce("pairs")
        costly.addCollectiveVariable("pairs", custom_nonbonded())
        assert chosen(vesicle_with(costly)) == elsewhere()

    def test_minimiser(self):
        context = mm.Context(vesicle_with(), mm.VerletIntegrator(0.001))
        context.setPositions(MESH.vertices)
        mm.LocalEnergyMinimizer.minimize(context, maxIterations=5)
        assert context.getPlatform().getName() == "Helfrich"

    def test_speeds_as_users_see_them(self):
        def speeds():
            count = mm.Platform.getNumPlatforms()
            return [mm.Platform.getPlatform(i).getSpeed() for i in range(count)]

        before = speeds()
        assert min(before) == named("Helfrich").getSpeed() < named("Reference").getSpeed()
        # Wherever the Context has ended, and if there is none in the end.
        chosen(vesicle_with())
        assert speeds() == before
        chosen(vesicle_with(nonbonded()))
        assert speeds() == before
        chosen(vesicle_with(), None, named("Reference"))
        assert speeds() == before

    def test_find_platform(self):
        kernels = ["CalcForcesAndEnergyKernel", "CalcCustomCPPForce", "IntegrateVerletStep"]
        chosen(vesicle_with())
        assert mm.Platform.findPlatform(kernels).getName() == elsewhere()

    def test_after_a_context_that_failed(self):
        """What was noted of it must not make the next one refuse a platform that is named."""
        broken = vesicle_with()
        broken.addForce(helfrich.BendingForce(MESH, 50, offset=N))
        with pytest.raises(mm.OpenMMException):
            chosen(broken)
        for i in range(mm.Platform.getNumPlatforms()):
            mm.Platform.getPlatform(i).getSpeed()
        assert chosen(vesicle_with(nonbonded()), None, named("Helfrich")) == "Helfrich"
        assert elsewhere() != "Helfrich"

    def test_threads_do_not_see_each_other(self):
        found: dict[int, set[str]] = {0: set(), 1: set()}

        def make(kind: int) -> None:
            for _ in range(10):
                system = vesicle_with(*([custom_nonbonded()] if kind else []))
                integrator = mm.VerletIntegrator(0.001)
                # On a platform that is named, so that none compiles kernels for seconds.
                found[kind].add(chosen(system, integrator, *([named("CPU")] if kind else [])))

        workers = [threading.Thread(target=make, args=(kind,)) for kind in (0, 1, 0, 1)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        assert found == {0: {"Helfrich"}, 1: {"CPU"}}


class TestChoose:
    @pytest.mark.parametrize("forces", CHEAP.values(), ids=CHEAP)
    def test_membranes(self, forces):
        assert platforms.choose(vesicle_with(*forces()), VERLET).name == "Helfrich"

    @pytest.mark.parametrize("reason", COSTLY)
    @pytest.mark.parametrize("gpu", [None, "CUDA"])
    def test_other_costs(self, reason, gpu, monkeypatch):
        monkeypatch.setattr(platforms, "_gpu_platform", lambda: gpu)
        small = vesicle_with(COSTLY[reason]())
        choice = platforms.choose(small, VERLET)
        assert choice.name == "CPU"
        assert reason in choice.reason
        assert platforms.choose(small, VERLET, double=True).name == "Helfrich"
        for _ in range(platforms.LEAST_FOR_GPU):
            small.addParticle(1)
        assert platforms.choose(small, VERLET).name == (gpu or "CPU")

    def test_nothing_but_springs(self):
        system = mm.System()
        for _ in range(N):
            system.addParticle(1)
        system.addForce(bonds(3 * N))
        assert platforms.choose(system, VERLET).name == "Helfrich"

    def test_constraints_count(self):
        system = vesicle_with(particles=11 * N)
        for i in range(10 * N + 1):
            system.addConstraint(N + i, N + i + 1, 1)
        assert "terms of other forces" in platforms.choose(system, VERLET).reason

    def test_the_environment(self, monkeypatch):
        monkeypatch.setenv("OPENMM_DEFAULT_PLATFORM", "Reference")
        choice = platforms.choose(vesicle_with(), VERLET)
        assert choice.name == "Reference"
        assert "OPENMM_DEFAULT_PLATFORM" in choice.reason
        monkeypatch.setenv("OPENMM_DEFAULT_PLATFORM", "Abacus")
        with pytest.raises(ValueError, match="no platform 'Abacus'; this OpenMM has Reference"):
            platforms.choose(vesicle_with(), VERLET)

    def test_opencl_on_a_processor_is_no_gpu(self):
        """PoCL's device is a processor; a machine with a real one is told by its kind."""
        if any(a.kind in ("discrete", "integrated") for a in helfrich.adapters()):
            pytest.skip("this machine has a GPU")
        assert platforms._count_opencl_gpus() == 0

    def test_names(self):
        assert platforms.find("helfrich") == "Helfrich"
        assert platforms.names().count("Helfrich") == 1


def system_on(mesh: helfrich.Mesh, *forces: mm.Force) -> tuple[mm.System, np.ndarray]:
    """A System of membrane forces, and where its particles are."""
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(1)
    for force in forces:
        if mesh.box is not None:
            force.setUsesPeriodicBoundaryConditions(True)
        system.addForce(force)
    if mesh.box is not None:
        system.setDefaultPeriodicBoxVectors(*mesh.box)
    return system, mesh.vertices


DISK = helfrich.Mesh.disk(4, 10.0)
SHEET = helfrich.Mesh.sheet(8, 8, 10.0, periodic=True)
SURFACES = {
    "closed": lambda: (vesicle_with(), MESH.vertices),
    "open": lambda: system_on(
        DISK, helfrich.BendingForce(DISK, 50), helfrich.EdgeTensionForce(DISK, 1)
    ),
    "periodic": lambda: system_on(SHEET, helfrich.BendingForce(SHEET, 50)),
    # By vertex it is one of all triangles.
    "domains": lambda: system_on(
        DISK,
        helfrich.GaussianCurvatureForce(DISK, np.linspace(-9, -1, DISK.num_vertices)),
        helfrich.SkalakForce(DISK, 1, 1, DISK),
    ),
}


@pytest.mark.usefixtures("backend_as_it_was")
class TestEvaluators:
    """What is said of a platform is what comes to pass there."""

    @pytest.mark.parametrize("backend", ["auto", "cpu", "native"])
    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2]], ids=str)
    @pytest.mark.parametrize("surface", SURFACES)
    def test_foretell(self, surface, target, backend):
        helfrich.set_backend(backend)
        system, positions = SURFACES[surface]()
        found = platforms.evaluators(system, target.platform)
        classes = [type(force).__name__ for force in platforms.membranes_of(system)]
        assert sorted(name for names in found.values() for name in names) == sorted(classes)
        foretold = {choice.name for choice in found}
        if foretold == {"none"}:
            with pytest.raises(mm.OpenMMException, match=f"{target.platform} is none of"):
                target.context(system)
            return
        with counting() as made:
            context = target.context(system)
            context.setPositions(positions)
            context.getState(energy=True)
        assert made.keys() == foretold

    def test_forces_with_a_backend_of_their_own(self):
        system = vesicle_with()
        for force in platforms.membranes_of(system):
            force.setBackend("native")
        found = platforms.evaluators(system, "OpenCL")
        assert [name for name, _ in found] == ["native"]
        assert platforms.choose(system, VERLET).name in platforms.ON_DEVICES

    def test_a_gpu_is_taken_unasked(self, monkeypatch):
        monkeypatch.setattr(platforms, "_count_opencl_gpus", lambda: 1)
        helfrich.set_backend("auto")
        for name in platforms.ON_DEVICES:
            [(who, reason)] = platforms.evaluators(vesicle_with(), name)
            assert (who, reason) == ("native", f"{name} has a GPU")

    def test_openmm_chooses_a_platform_for_the_backend(self):
        """Under `native` it does not take Helfrich for membranes, which would be an error."""
        ON_OPENCL[0].context(vesicle_with())
        helfrich.set_backend("native")
        assert chosen(vesicle_with()) in platforms.ON_DEVICES
        helfrich.set_backend("auto")
        system = vesicle_with()
        assert chosen(system) == "Helfrich"
        platforms.membranes_of(system)[2].setBackend("native")
        assert chosen(system) in platforms.ON_DEVICES

    def test_no_membranes(self):
        helfrich.set_backend("native")
        assert platforms.evaluators(mm.System(), "OpenCL") == {}
        system = mm.System()
        system.addParticle(1)
        assert platforms.choose(system, VERLET).name == "Helfrich"


# Runs in a process of its own, with or without our import; prints the platform of each System. The
# protein is that of OpenMM's own test of an installation.
OTHERS = """
import json, sys
import openmm as mm
from openmm import app, unit
if sys.argv[1] == "ours":
    import openmmhelfrich
amber = app.ForceField("amber99sb.xml", "tip3p.xml")
data = app.__path__[0] + "/data/"
protein = app.PDBFile(data + "test.pdb")
water = app.Modeller(app.Topology(), [])
water.addSolvent(amber, boxSize=mm.Vec3(2.2, 2.2, 2.2) * unit.nanometer)
solvent = dict(nonbondedMethod=app.PME, constraints=app.HBonds)
implicit = app.ForceField("amber99sb.xml", "amber99_obc.xml")
bare = app.Modeller(protein.topology, protein.positions)
bare.delete([r for r in bare.topology.residues() if r.name in ("HOH", "Cl")])
systems = {
    "water": amber.createSystem(water.topology, nonbondedCutoff=1.0, **solvent),
    "protein": amber.createSystem(protein.topology, nonbondedCutoff=1.0, **solvent),
    "implicit": implicit.createSystem(bare.topology),
}
springs = mm.System()
for _ in range(100):
    springs.addParticle(1)
springs.addForce(mm.HarmonicBondForce())
systems["springs"] = springs
for system in systems.values():
    system.addForce(mm.CMMotionRemover())
print(json.dumps({
    name: mm.Context(system, mm.LangevinMiddleIntegrator(300, 1, 0.002)).getPlatform().getName()
    for name, system in systems.items()
}))
"""

MEMBRANE = """
import openmm as mm, openmmhelfrich as helfrich
mesh = helfrich.Mesh.icosphere(3, 100.0)
print(mm.Context(helfrich.Vesicle(mesh).system(), mm.VerletIntegrator(0.1)).getPlatform().getName())
print(helfrich.Vesicle(mesh).simulation(mm.VerletIntegrator(0.1)).context.getPlatform().getName())
"""

# OpenCL's loader finds no driver then, as on a machine without any.
NO_OPENCL = {"OCL_ICD_VENDORS": "/nonexistent", "OCL_ICD_FILENAMES": ""}


def in_a_process(code: str, *arguments: str, **environment: str) -> str:
    variables = {k: v for k, v in os.environ.items() if k != "OPENMM_DEFAULT_PLATFORM"}
    result = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**variables, **environment},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.parametrize("environment", [{}, NO_OPENCL], ids=["as it is", "without OpenCL"])
class TestMachines:
    def test_water_and_proteins_stay_where_they_were(self, environment):
        # OpenMM's warnings about PoCL come first.
        before, now = (
            json.loads(in_a_process(OTHERS, side, **environment).splitlines()[-1])
            for side in ("theirs", "ours")
        )
        assert now == before
        assert set(before) == {"water", "protein", "implicit", "springs"}
        assert "Helfrich" not in before.values()

    def test_membranes(self, environment):
        assert in_a_process(MEMBRANE, **environment).split() == ["Helfrich", "Helfrich"]


@pytest.mark.parametrize("name", ["Reference", "CPU", "Helfrich"])
def test_the_environment_goes_first(name):
    found = in_a_process(MEMBRANE, OPENMM_DEFAULT_PLATFORM=name)
    assert found.split()[-2:] == [name, name]


def test_the_example_of_the_readme():
    """As a user copies it, without a platform."""
    text = (PROJECT / "README.md").read_text(encoding="utf-8")
    code = text.split("```python\n")[1].split("```")[0].replace("step(1000)", "step(10)")
    assert "context.getPlatform().getName()" in code
    assert in_a_process(code).split()[-1] == "Helfrich"


def test_a_context_that_fails_leaves_nothing_for_the_next():
    """A water-like System goes where it goes without the failure."""

    def plain():
        system = mm.System()
        force = mm.NonbondedForce()
        for _ in range(8):
            system.addParticle(1)
            force.addParticle(0, 0.3, 0.1)
        system.addForce(force)
        return mm.Context(system, mm.VerletIntegrator(0.001)).getPlatform().getName()

    expected = plain()
    assert expected != "Helfrich"
    mesh = helfrich.Mesh.icosphere(2, 100)
    broken = mm.System()
    bonds = mm.HarmonicBondForce()
    bonds.addBond(0, 10**6, 1, 1)
    broken.addForce(bonds)
    helfrich.Vesicle(mesh).add_to(broken)
    for arguments in ((), (mm.Platform.getPlatformByName("CPU"), {"Threads": "none"})):
        with pytest.raises(mm.OpenMMException):
            mm.Context(broken, mm.VerletIntegrator(0.001), *arguments)
        assert [plain(), plain()] == [expected] * 2
        context = mm.Context(helfrich.Vesicle(mesh).system(), mm.VerletIntegrator(0.001))
        assert context.getPlatform().getName() == "Helfrich"
