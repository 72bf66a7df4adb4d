"""The platform Helfrich: OpenMM's schemes with the bits of Reference, the rest through it."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from running import plain

SIZE = 101  # not a multiple of what is computed at once
MANY = 20_011  # enough for threads to share the steps
TEMPERATURE = 300.0
KT = plain(unit.MOLAR_GAS_CONSTANT_R) * TEMPERATURE
MASSES = {
    "equal": np.full(SIZE, 50.0),
    "different": np.linspace(1, 90, SIZE),
    "some massless": np.where(np.arange(SIZE) % 7 == 3, 0, np.linspace(1, 90, SIZE)),
    "all massless": np.zeros(SIZE),
}
DETERMINISTIC = {
    "Verlet": lambda: mm.VerletIntegrator(0.003),
    "LangevinMiddle at 0 K": lambda: mm.LangevinMiddleIntegrator(0, 1.3, 0.003),
    "LangevinMiddle without friction": lambda: mm.LangevinMiddleIntegrator(300, 0, 0.003),
    "Brownian at 0 K": lambda: mm.BrownianIntegrator(0, 1.3, 0.003),
}
RANDOM = {
    "LangevinMiddle": lambda: mm.LangevinMiddleIntegrator(TEMPERATURE, 1.3, 0.003),
    "Brownian": lambda: mm.BrownianIntegrator(TEMPERATURE, 1.3, 0.003),
}


def well(num_particles: int) -> mm.Force:
    """A potential without symmetry that holds every particle."""
    force = mm.CustomExternalForce("10 * x^2 + 20 * y^2 + depth * z^2 + sin(3 * x + y)")
    force.addGlobalParameter("depth", 10)
    for i in range(num_particles):
        force.addParticle(i)
    return force


def system_of(masses, *forces: mm.Force) -> mm.System:
    system = mm.System()
    for mass in masses:
        system.addParticle(mass)
    for force in forces:
        system.addForce(force)
    return system


def context_of(system, integrator, platform="Helfrich", threads=None, seed=5) -> mm.Context:
    if seed is not None and hasattr(integrator, "setRandomNumberSeed"):
        integrator.setRandomNumberSeed(seed)
    properties = {} if threads is None else {"Threads": str(threads)}
    where = mm.Platform.getPlatformByName(platform)
    context = mm.Context(system, integrator, where, properties)
    random = np.random.default_rng(3)
    n = system.getNumParticles()
    context.setPositions(random.normal(size=(n, 3)))
    context.setVelocities(random.normal(size=(n, 3)))
    return context


def state_of(context: mm.Context) -> list:
    state = context.getState(
        getPositions=True, getVelocities=True, getForces=True, getEnergy=True, getParameters=True
    )
    return [
        plain(state.getPositions(asNumpy=True)),
        plain(state.getVelocities(asNumpy=True)),
        plain(state.getForces(asNumpy=True)),
        plain(state.getPotentialEnergy()),
        plain(state.getKineticEnergy()),
        plain(state.getTime()),
        state.getStepCount(),
        plain(state.getPeriodicBoxVectors(asNumpy=True)),
    ]


def assert_same(one: list, other: list) -> None:
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


def after(context: mm.Context, steps: int) -> list:
    context.getIntegrator().step(steps)
    return state_of(context)


class TestPlatform:
    def test_it_is_there_and_not_chosen_without_membranes(self):
        platform = mm.Platform.getPlatformByName("Helfrich")
        assert 0 < platform.getSpeed() < mm.Platform.getPlatformByName("Reference").getSpeed()
        assert platform.supportsDoublePrecision()
        assert list(platform.getPropertyNames()) == ["Threads"]
        count = mm.Platform.getNumPlatforms()
        names = [mm.Platform.getPlatform(i).getName() for i in range(count)]
        # One object with two entries, by which it knows that OpenMM tries all platforms.
        twins = [i for i, name in enumerate(names) if name == "Helfrich"]
        assert len(twins) == 2
        first, second = (int(mm.Platform.getPlatform(i).this) for i in twins)
        assert first == second == int(platform.this)
        assert helfrich.platforms.names() == list(dict.fromkeys(names))
        context = mm.Context(system_of([1.0]), mm.VerletIntegrator(0.001))
        assert context.getPlatform().getName() != "Helfrich"

    def test_threads_belong_to_a_context(self):
        platform = mm.Platform.getPlatformByName("Helfrich")
        contexts = {
            n: context_of(system_of([1]), mm.VerletIntegrator(1), threads=n) for n in (1, 3)
        }
        for n, context in contexts.items():
            assert platform.getPropertyValue(context, "Threads") == str(n)
        default = platform.getPropertyDefaultValue("Threads")
        if "OPENMM_CPU_THREADS" not in os.environ:
            assert int(default) == len(os.sched_getaffinity(0))
        context = context_of(system_of([1]), mm.VerletIntegrator(1))
        assert platform.getPropertyValue(context, "Threads") == default

    @pytest.mark.parametrize("bad", ["0", "-1", "two", "2.5", "", "2 ", "99999999999999999999"])
    def test_a_bad_number_of_threads(self, bad):
        with pytest.raises(mm.OpenMMException, match=f'Threads must be a whole .* got "{bad}"'):
            context_of(system_of([1]), mm.VerletIntegrator(1), threads=bad)

    def test_an_unknown_property(self):
        platform = mm.Platform.getPlatformByName("Helfrich")
        with pytest.raises(mm.OpenMMException, match="Precision"):
            mm.Context(system_of([1]), mm.VerletIntegrator(1), platform, {"Precision": "single"})
        context = context_of(system_of([1]), mm.VerletIntegrator(1))
        with pytest.raises(mm.OpenMMException, match="property"):
            platform.getPropertyValue(context, "Precision")

    def test_the_environment_sets_the_default(self):
        code = (
            "import openmm, openmmhelfrich\n"
            "platform = openmm.Platform.getPlatformByName('Helfrich')\n"
            "print(platform.getPropertyDefaultValue('Threads'))"
        )
        environment = dict(os.environ, OPENMM_CPU_THREADS="5")
        command = [sys.executable, "-c", code]
        result = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert result.stdout.strip() == "5", result.stderr

    def test_an_idle_simulation_uses_no_processor(self):
        context = context_of(system_of(np.full(MANY, 50.0)), mm.VerletIntegrator(0.001), threads=2)
        context.getIntegrator().step(5)
        time.sleep(0.05)
        start = time.process_time()
        time.sleep(0.3)
        assert time.process_time() - start < 0.05


class TestSchemes:
    @pytest.mark.parametrize("masses", MASSES.values(), ids=MASSES)
    @pytest.mark.parametrize("integrator", DETERMINISTIC.values(), ids=DETERMINISTIC)
    def test_bits_of_reference(self, integrator, masses):
        """Operation by operation: whatever the instructions of the processor."""
        ends = []
        for platform in ("Reference", "Helfrich"):
            context = context_of(system_of(masses, well(SIZE)), integrator(), platform)
            ends.append([after(context, 1), after(context, 99)])
        for one, other in zip(*ends, strict=True):
            assert_same(one, other)
        assert ends[0][1][6] == 100

    @pytest.mark.parametrize("integrator", RANDOM.values(), ids=RANDOM)
    def test_massless_particles_stay_in_random_steps(self, integrator):
        masses = MASSES["some massless"]
        context = context_of(system_of(masses, well(SIZE)), integrator())
        before, later = state_of(context), after(context, 10)
        moved = (later[0] != before[0]).any(axis=1)
        np.testing.assert_array_equal(moved, masses != 0)
        for k in (0, 1):
            np.testing.assert_array_equal(later[k][masses == 0], before[k][masses == 0])

    @pytest.mark.parametrize("integrator", [*DETERMINISTIC.values(), *RANDOM.values()])
    def test_bits_do_not_depend_on_threads(self, integrator):
        masses = np.linspace(1, 90, MANY)
        ends = [
            after(context_of(system_of(masses, well(MANY)), integrator(), threads=n), 3)
            for n in (1, 2, 3)
        ]
        assert_same(ends[0], ends[1])
        assert_same(ends[0], ends[2])

    def test_changes_between_steps_take_effect(self):
        """Step size, temperature and friction can change at any time."""
        ends = []
        for platform in ("Reference", "Helfrich"):
            integrator = mm.LangevinMiddleIntegrator(0, 1.3, 0.003)
            context = context_of(system_of(MASSES["equal"], well(SIZE)), integrator, platform)
            integrator.step(3)
            integrator.setStepSize(0.001)
            integrator.setFriction(5)
            context.setParameter("depth", 30)
            ends.append(after(context, 3))
        assert_same(*ends)

    def test_force_groups_of_the_integrator(self):
        ends = []
        for platform in ("Reference", "Helfrich"):
            first, second = well(SIZE), well(SIZE)
            second.setForceGroup(1)
            integrator = mm.VerletIntegrator(0.003)
            integrator.setIntegrationForceGroups({1})
            system = system_of(MASSES["equal"], first, second)
            ends.append(after(context_of(system, integrator, platform), 10))
        assert_same(*ends)

    def test_an_energy_alone_leaves_the_forces(self):
        """Verlet's kinetic energy is shifted by the last forces, which an energy must not touch."""
        system = system_of(MASSES["equal"], well(SIZE))
        context = context_of(system, mm.VerletIntegrator(0.003))
        context.getIntegrator().step(2)
        first = context.getState(getEnergy=True)
        second = context.getState(getEnergy=True)
        assert first.getKineticEnergy() == second.getKineticEnergy()
        assert plain(first.getPotentialEnergy()) != 0


def constrained(system: mm.System) -> None:
    system.addConstraint(0, 1, 1.0)
    system.addConstraint(1, 2, 1.0)


def with_virtual_site(system: mm.System) -> None:
    system.setParticleMass(2, 0)
    system.setVirtualSite(2, mm.TwoParticleAverageSite(0, 1, 0.3, 0.7))


class TestDelegation:
    """What the kernels of this platform leave to those of Reference, random numbers included."""

    @pytest.mark.parametrize("change", [constrained, with_virtual_site])
    @pytest.mark.parametrize("integrator", [*DETERMINISTIC.values(), *RANDOM.values()])
    def test_constraints_and_virtual_sites(self, change, integrator):
        ends = []
        for platform in ("Reference", "Helfrich"):
            system = system_of(MASSES["different"], well(SIZE))
            change(system)
            ends.append(after(context_of(system, integrator(), platform), 20))
        assert_same(*ends)


def nonbonded() -> mm.Force:
    force = mm.NonbondedForce()
    for i in range(SIZE):
        force.addParticle((-1) ** i * 0.1, 0.2, 0.1)
    force.setNonbondedMethod(mm.NonbondedForce.CutoffPeriodic)
    return force


def collective() -> mm.Force:
    force = mm.CustomCVForce("spread^2 / 1000")
    force.addCollectiveVariable("spread", well(SIZE))
    return force


def pairs() -> mm.Force:
    force = mm.CustomNonbondedForce("0.1 / (1 + r)")
    for _ in range(SIZE):
        force.addParticle([])
    return force


def bonds() -> mm.Force:
    force = mm.CustomBondForce("stiffness * r^2")
    force.addGlobalParameter("stiffness", 3)
    force.addEnergyParameterDerivative("stiffness")
    force.setUsesPeriodicBoundaryConditions(True)
    for i in range(SIZE - 1):
        force.addBond(i, i + 1)
    return force


def barostat() -> mm.Force:
    force = mm.MonteCarloBarostat(1, TEMPERATURE, 2)
    force.setRandomNumberSeed(7)
    return force


def thermostat() -> mm.Force:
    force = mm.AndersenThermostat(TEMPERATURE, 50)
    force.setRandomNumberSeed(7)
    return force


def custom() -> mm.Integrator:
    integrator = mm.CustomIntegrator(0.001)
    integrator.addPerDofVariable("noise", 0)
    integrator.addComputePerDof("noise", "gaussian")
    integrator.addComputePerDof("v", "v + dt * f / m + 0.1 * noise")
    integrator.addComputePerDof("x", "x + dt * v")
    integrator.setRandomNumberSeed(7)
    return integrator


FORCES = {
    "NonbondedForce": nonbonded,
    "CustomNonbondedForce": pairs,
    "CustomBondForce": bonds,
    "CustomCVForce": collective,
    "CMMotionRemover": lambda: mm.CMMotionRemover(1),
    "MonteCarloBarostat": barostat,
    "AndersenThermostat": thermostat,
}
INTEGRATORS = {
    "VariableVerlet": lambda: mm.VariableVerletIntegrator(1e-4),
    "VariableLangevin": lambda: mm.VariableLangevinIntegrator(TEMPERATURE, 1, 1e-4),
    "NoseHoover": lambda: mm.NoseHooverIntegrator(TEMPERATURE, 10, 0.001),
    "CustomIntegrator": custom,
    "MTSIntegrator": lambda: mm.MTSIntegrator(0.002, [(0, 2)]),
}


def periodic(*forces: mm.Force) -> mm.System:
    system = system_of(MASSES["equal"], well(SIZE), *forces)
    system.setDefaultPeriodicBoxVectors([12, 0, 0], [0, 12, 0], [0, 0, 12])
    return system


class TestEverythingElse:
    """Other forces and integrators, through Reference's kernels: the same bits."""

    @pytest.mark.parametrize("make", FORCES.values(), ids=FORCES)
    def test_forces(self, make):
        ends = []
        for platform in ("Reference", "Helfrich"):
            context = context_of(periodic(make(), bonds()), mm.VerletIntegrator(0.001), platform)
            end = after(context, 10)
            state = context.getState(getParameterDerivatives=True)
            ends.append([*end, dict(state.getEnergyParameterDerivatives())["stiffness"]])
        assert_same(*ends)

    @pytest.mark.parametrize("make", INTEGRATORS.values(), ids=INTEGRATORS)
    def test_integrators(self, make):
        ends = []
        for platform in ("Reference", "Helfrich"):
            ends.append(after(context_of(periodic(), make(), platform), 10))
        assert_same(*ends)

    def test_the_minimizer(self):
        ends = []
        for platform in ("Reference", "Helfrich"):
            context = context_of(periodic(bonds()), mm.VerletIntegrator(0.001), platform)
            mm.LocalEnergyMinimizer.minimize(context, 1e-3, 50)
            ends.append(state_of(context))
        assert_same(*ends)

    def test_kernels_that_other_plugins_gave_to_reference(self):
        """OpenMM loads its Drude and RPMD plugins before this one."""
        ends = []
        for platform in ("Reference", "Helfrich"):
            system = system_of([10, 1, 10])
            drude = mm.DrudeForce()
            drude.addParticle(1, 0, -1, -1, -1, 1.0, 0.1, 1, 1)
            system.addForce(drude)
            integrator = mm.DrudeLangevinIntegrator(300, 1, 1, 1, 0.001)
            context = context_of(system, integrator, platform)
            context.setPositions([[0, 0, 0], [0.01, 0, 0], [1, 0, 0]])
            context.setVelocities(np.zeros((3, 3)))
            ends.append(after(context, 5))
        assert_same(*ends)
        context = context_of(system_of([1.0]), mm.RPMDIntegrator(4, 300, 1, 0.001))
        context.getIntegrator().setPositions(0, [[0, 0, 0]])
        context.getIntegrator().step(1)

    def test_membranes_inside_a_custom_cv_force(self, lumpy):
        """The inner Context is of this platform, too, and has a team of its own."""
        energies = []
        for wrap in (False, True):
            force = helfrich.BendingForce(lumpy, 50)
            if wrap:
                outer = mm.CustomCVForce("bending")
                outer.addCollectiveVariable("bending", force)
                force = outer
            system = system_of(np.full(lumpy.num_vertices, 50.0), force)
            context = context_of(system, mm.VerletIntegrator(0.001), threads=2)
            context.setPositions(lumpy.vertices)
            energies.append(plain(context.getState(getEnergy=True).getPotentialEnergy()))
        assert energies[0] == energies[1] > 1


def compound() -> mm.Integrator:
    integrator = mm.CompoundIntegrator()
    for make in RANDOM.values():
        part = make()
        part.setRandomNumberSeed(5)
        integrator.addIntegrator(part)
    return integrator


class TestRandomState:
    @pytest.mark.parametrize("make", [*RANDOM.values(), compound], ids=[*RANDOM, "Compound"])
    def test_a_checkpoint_goes_on_bit_for_bit(self, make):
        system = system_of(MASSES["different"], well(SIZE))
        context = context_of(system, make())
        context.getIntegrator().step(7)
        checkpoint = context.createCheckpoint()
        expected = after(context, 10)
        context.loadCheckpoint(checkpoint)
        assert_same(after(context, 10), expected)
        # A Context of another seed, with another number of threads, takes all from the checkpoint.
        other = context_of(system, make(), threads=2, seed=99)
        other.loadCheckpoint(checkpoint)
        assert_same(after(other, 10), expected)
        other.loadCheckpoint(checkpoint)
        other.reinitialize(preserveState=True)
        assert_same(after(other, 10), expected)

    def test_the_checkpoint_has_what_reference_has(self):
        """The thermostat's random numbers are those of Reference."""
        system = system_of(MASSES["equal"], well(SIZE), thermostat())
        context = context_of(system, mm.VerletIntegrator(0.001))
        context.getIntegrator().step(7)
        checkpoint = context.createCheckpoint()
        expected = after(context, 10)
        context.loadCheckpoint(checkpoint)
        assert_same(after(context, 10), expected)

    def test_a_checkpoint_of_another_integrator(self):
        system = system_of(MASSES["equal"], well(SIZE))
        langevin = context_of(system, RANDOM["LangevinMiddle"]())
        verlet = context_of(system, mm.VerletIntegrator(0.001))
        expected = after(langevin, 3)
        verlet.loadCheckpoint(langevin.createCheckpoint())
        np.testing.assert_array_equal(state_of(verlet)[0], expected[0])
        langevin.loadCheckpoint(verlet.createCheckpoint())
        np.testing.assert_array_equal(state_of(langevin)[0], expected[0])

    def test_a_damaged_checkpoint(self):
        context = context_of(system_of(MASSES["equal"]), RANDOM["LangevinMiddle"]())
        checkpoint = context.createCheckpoint()
        with pytest.raises(mm.OpenMMException, match="damaged"):
            context.loadCheckpoint(checkpoint[:-5])
        with pytest.raises(mm.OpenMMException, match="damaged"):
            context.loadCheckpoint(checkpoint[:-24] + bytes(24))

    @pytest.mark.parametrize("make", RANDOM.values(), ids=RANDOM)
    def test_seeds(self, make):
        system = system_of(MASSES["equal"])
        ends = {
            name: after(context_of(system, make(), seed=seed), 2)[0]
            for name, seed in {"a": 1, "same": 1, "b": 2, "any": 0, "other": 0}.items()
        }
        np.testing.assert_array_equal(ends["a"], ends["same"])
        assert (ends["a"] != ends["b"]).all()
        assert (ends["any"] != ends["other"]).all()

    def test_reinitialize_starts_the_stream_again(self):
        context = context_of(system_of(MASSES["equal"]), RANDOM["Brownian"]())
        start = state_of(context)[0]
        first = after(context, 2)[0]
        context.reinitialize()
        context.setPositions(start)
        np.testing.assert_array_equal(after(context, 2)[0], first)

    def test_integrators_of_one_seed_have_streams_of_their_own(self):
        integrator = mm.CompoundIntegrator()
        for _ in range(2):
            part = mm.BrownianIntegrator(TEMPERATURE, 1, 0.001)
            part.setRandomNumberSeed(5)
            integrator.addIntegrator(part)
        context = context_of(system_of(MASSES["equal"]), integrator)
        moves = []
        for k in (0, 1):
            integrator.setCurrentIntegrator(k)
            before = state_of(context)[0]
            moves.append(after(context, 1)[0] - before)
        assert abs(np.corrcoef(moves[0].ravel(), moves[1].ravel())[0, 1]) < 5 / np.sqrt(3 * SIZE)


def trap(num_particles: int, stiffness: float) -> mm.Force:
    force = mm.CustomExternalForce(f"{stiffness / 2} * (x^2 + y^2 + z^2)")
    for i in range(num_particles):
        force.addParticle(i)
    return force


class TestDistributions:
    """Many independent particles, so that a variance is known to √(2 / components)."""

    PARTICLES = 20_000
    ERROR = 5 * np.sqrt(2 / (3 * PARTICLES))  # five standard errors of a variance, relative

    @pytest.mark.parametrize("platform", ["Reference", "Helfrich"])
    def test_a_harmonic_trap(self, platform):
        """The variance of positions is exactly kT/k in this scheme, that of velocities up to a
        factor 1 − (ω dt / 2)² (doi:10.1021/acs.jpca.9b02771).
        """
        mass, stiffness, step = 50.0, 20_000.0, 0.02
        integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 20, step)
        system = system_of(np.full(self.PARTICLES, mass), trap(self.PARTICLES, stiffness))
        context = context_of(system, integrator, platform)
        context.setPositions(np.zeros((self.PARTICLES, 3)))
        context.setVelocities(np.zeros((self.PARTICLES, 3)))
        positions, velocities, *_ = after(context, 100)
        assert positions.var() == pytest.approx(KT / stiffness, rel=self.ERROR)
        # Velocities are those half a step before the forces, up to that factor.
        quarter = stiffness / mass * step**2 / 4
        measured = velocities.var() * mass / KT
        assert abs(measured - 1) < self.ERROR + quarter
        kinetic = plain(context.getState(getEnergy=True).getKineticEnergy())
        assert kinetic == pytest.approx(mass / 2 * (velocities**2).sum(), rel=1e-12)

    @pytest.mark.parametrize("platform", ["Reference", "Helfrich"])
    def test_free_diffusion(self, platform):
        """⟨Δx²⟩ = 2 kT t / (γ m), of light and heavy particles."""
        friction, step, steps = 2.0, 0.01, 20
        masses = np.where(np.arange(self.PARTICLES) % 2 == 0, 5.0, 80.0)
        integrator = mm.BrownianIntegrator(TEMPERATURE, friction, step)
        context = context_of(system_of(masses), integrator, platform)
        start = state_of(context)[0]
        positions, velocities, *_ = after(context, steps)
        for mass in (5.0, 80.0):
            some = masses == mass
            expected = 2 * KT * step / (friction * mass)
            error = self.ERROR * np.sqrt(2)
            displacement = (positions - start)[some]
            assert displacement.var() == pytest.approx(steps * expected, rel=error)
            assert (velocities[some] * step).var() == pytest.approx(expected, rel=error)

    def test_the_temperature_of_a_vesicle(self):
        """With membrane forces, over time: both platforms have the temperature asked for."""
        mesh = helfrich.Mesh.icosphere(4, 500.0)
        for platform in ("Reference", "Helfrich"):
            integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 1, 0.05)
            integrator.setRandomNumberSeed(5)
            simulation = helfrich.Vesicle(mesh).simulation(integrator, platform=platform)
            simulation.context.setVelocitiesToTemperature(TEMPERATURE, 1)
            kinetic = []
            for _ in range(150):
                simulation.step(20)  # a time 1/γ, after which velocities are new
                state = simulation.context.getState(getEnergy=True)
                kinetic.append(plain(state.getKineticEnergy()))
            components = 3 * mesh.num_vertices
            error = 5 * np.sqrt(2 / (components * len(kinetic))) * 2
            assert np.mean(kinetic) == pytest.approx(components * KT / 2, rel=error)
