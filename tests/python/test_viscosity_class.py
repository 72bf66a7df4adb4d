"""The class SurfaceViscosityThermostat as any OpenMM Force, what it refuses, and its state."""

from __future__ import annotations

import copy
import ctypes

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import TEMPERATURE, arguments_of, forces_of, langevin, mover_of, start, system_of
from openmm import unit
from openmmhelfrich import _core, config
from openmmhelfrich.simulation.runner import Run
from openmmhelfrich.vcm import ConfigError
from platforms import CPU, HELFRICH, ON_OPENCL, REFERENCE
from viscous import Thermostat, motion, thermostat_of, velocity_verlet, viscous

NAME = "SurfaceViscosityThermostat"


class TestArguments:
    def test_names_of_parameters(self):
        assert Thermostat.Friction() == "SurfaceViscosityFriction"
        assert Thermostat.Temperature() == "SurfaceViscosityTemperature"
        context, thermostat = viscous(friction=12.5)
        assert context.getParameter(Thermostat.Friction()) == 12.5
        assert context.getParameter(Thermostat.Temperature()) == TEMPERATURE
        assert not thermostat.usesPeriodicBoundaryConditions()

    def test_signature(self):
        assert arguments_of(Thermostat) == (
            "(triangles, friction, temperature, frequency=1, *, offset=0)"
        )
        assert "amu/ps" in Thermostat.setDefaultFriction.__doc__

    def test_with_units(self):
        thermostat = Thermostat(
            start(), 3 * unit.dalton / unit.femtosecond, 300 * unit.kelvin, offset=5
        )
        assert thermostat.getDefaultFriction() == pytest.approx(3000)
        assert min(thermostat.getTriangle(0)) >= 5
        thermostat.setDefaultFriction(1 * unit.dalton / unit.nanosecond)
        thermostat.setDefaultTemperature(310 * unit.kelvin)
        assert thermostat.getDefaultFriction() == pytest.approx(1e-3)
        assert thermostat.getDefaultTemperature() == 310

    @pytest.mark.parametrize(
        ("friction", "error", "words"),
        [
            (-1, mm.OpenMMException, r"friction.*0 or more, got -1"),
            (float("inf"), mm.OpenMMException, "friction.*inf"),
            (3 * unit.nanometer, TypeError, "friction.*units of"),
            ("thick", TypeError, "friction.*thick"),
        ],
    )
    def test_frictions_that_are_refused(self, friction, error, words):
        with pytest.raises(error, match=rf"^{NAME}: {words}"):
            thermostat_of(start(), friction)
        thermostat = thermostat_of(start(), 7.0)
        with pytest.raises(error, match=rf"^{NAME}: {words}"):
            thermostat.setDefaultFriction(friction)
        assert thermostat.getDefaultFriction() == 7

    def test_friction_has_no_default(self):
        with pytest.raises(TypeError, match=rf"^{NAME}.*missing.*'temperature'"):
            Thermostat(start(), 300)

    @pytest.mark.parametrize("name", ["", "SurfaceViscosityTemperature"])
    def test_names_that_are_refused(self, name):
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*name of its own"):
            thermostat_of(start()).setFrictionParameter(name)

    def test_is_told_from_others(self):
        context, _ = viscous(mover_of(start()))
        plain = list(context.getSystem().getForces())
        others = [False] * (len(plain) - 2)
        assert [Thermostat.isinstance(force) for force in plain] == [*others, True, False]
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: cannot cast"):
            Thermostat.cast(plain[0])

    def test_the_platform_is_chosen(self):
        context, _ = viscous(mover_of(start()))
        system = copy.deepcopy(context.getSystem())
        chosen = mm.Context(system, mm.VerletIntegrator(0.001)).getPlatform()
        assert chosen.getName() == "Helfrich"


class TestParameters:
    def test_that_change_act(self):
        """From rest: no friction, no noise; then noise that grows with the temperature."""
        context, thermostat = viscous(forces=[], friction=0.0)
        step = context.getIntegrator().step
        step(3)
        assert (motion(context)[1] == 0).all()
        np.testing.assert_array_equal(motion(context)[0], start().vertices)
        context.setParameter(Thermostat.Friction(), 5.0)
        speeds = []
        for temperature in (300.0, 1200.0):
            context.setParameter(Thermostat.Temperature(), temperature)
            context.setPositions(start().vertices)
            context.setVelocities(np.zeros((start().num_vertices, 3)))
            thermostat._restoreState(context, bytes(24))
            step(1)
            speeds.append(motion(context)[1])
        assert abs(speeds[0]).max() > 0.01
        np.testing.assert_allclose(speeds[1], 2 * speeds[0], rtol=0, atol=1e-10)

    @pytest.mark.parametrize(
        ("name", "value", "words"),
        [
            ("SurfaceViscosityFriction", -1.0, "SurfaceViscosityFriction.*0 or more, got -1"),
            ("SurfaceViscosityFriction", float("nan"), "SurfaceViscosityFriction.*nan"),
            ("SurfaceViscosityTemperature", 0.0, "SurfaceViscosityTemperature.*above zero"),
        ],
    )
    def test_that_make_no_sense(self, name, value, words):
        context, _ = viscous()
        context.setParameter(name, value)
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*{words}"):
            context.getIntegrator().step(1)

    def test_the_frequency_is_updated(self):
        context, thermostat = viscous(forces=[], frequency=0)
        context.getIntegrator().step(5)
        assert (motion(context)[1] == 0).all()
        thermostat.setFrequency(2)
        context.getIntegrator().step(5)
        assert (motion(context)[1] == 0).all()
        thermostat.updateParametersInContext(context)
        context.getIntegrator().step(1)
        assert (motion(context)[1] == 0).all()
        context.getIntegrator().step(1)
        assert (motion(context)[1] != 0).any()

    def test_triangles_need_a_new_context(self):
        context, thermostat = viscous()
        thermostat.addTriangle(0, 1, 2)
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: the triangles.*reinitialize"):
            thermostat.updateParametersInContext(context)

    def test_two_with_a_friction_each(self):
        mesh = start()
        count = mesh.num_vertices
        one, other = (thermostat_of(mesh.triangles + k * count, 10.0 * k) for k in (0, 1))
        other.setFrictionParameter("of the other")
        system = mm.System()
        for _ in range(2 * count):
            system.addParticle(50.0)
        system.addForce(one)
        system.addForce(other)
        context = REFERENCE.context(system)
        assert context.getParameter(Thermostat.Friction()) == 0
        assert context.getParameter("of the other") == 10
        context.setPositions(np.vstack([mesh.vertices, mesh.vertices]))
        context.getIntegrator().step(1)
        velocities = motion(context)[1]
        assert (velocities[:count] == 0).all()
        assert (velocities[count:] != 0).all()

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            ({"friction": 21.0}, r'"second".*"first".*SurfaceViscosityFriction.*setFriction'),
            ({"temperature": 310.0}, r"SurfaceViscosityTemperature.*the same temperature"),
        ],
    )
    def test_one_parameter_holds_one_value(self, arguments, words):
        first, second = thermostat_of(start()), thermostat_of(start(), **arguments)
        first.setName("second")
        second.setName("first")
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*{words}"):
            REFERENCE.context(system_of(first, second))


class TestRefusals:
    @pytest.mark.parametrize(
        ("integrator", "words"),
        [
            (mm.BrownianIntegrator(300, 1, 0.01), "BrownianIntegrator has no velocities"),
            (mm.QTBIntegrator(300, 1, 0.01), "QTBIntegrator are not those of one temperature"),
            (mm.RPMDIntegrator(2, 300, 1, 0.01), "beads of an RPMDIntegrator"),
            (mm.DrudeSCFIntegrator(0.01), "not known of which moment"),
        ],
        ids=lambda value: type(value).__name__,
    )
    def test_integrators(self, integrator, words):
        force = mm.DrudeForce()
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*{words}.*VerletIntegrator"):
            REFERENCE.context(system_of(thermostat_of(start()), force), integrator)

    def test_one_of_several_integrators(self):
        compound = mm.CompoundIntegrator()
        compound.addIntegrator(mm.VerletIntegrator(0.01))
        compound.addIntegrator(mm.BrownianIntegrator(300, 1, 0.01))
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*BrownianIntegrator"):
            viscous(integrator=compound)

    def test_a_constraint(self):
        system = system_of(thermostat_of(start()))
        system.addConstraint(3, 4, 1.5)
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*particles 3 and 4"):
            REFERENCE.context(system)

    @pytest.mark.parametrize("particle", [-1, 92, 10**9])
    def test_a_particle_that_is_not_there(self, particle):
        triangles = start().triangles.copy()
        triangles[triangles == 3] = particle
        with pytest.raises(
            mm.OpenMMException, match=rf"^{NAME}: triangle 29 refers to index {particle},"
        ):
            REFERENCE.context(system_of(thermostat_of(triangles)))

    def test_a_virtual_site(self):
        system = system_of(thermostat_of(start()))
        system.setParticleMass(3, 0)
        system.setVirtualSite(3, mm.TwoParticleAverageSite(4, 5, 0.5, 0.5))
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: particle 3 is a virtual site"):
            REFERENCE.context(system)

    def test_no_surface(self):
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*triangle"):
            REFERENCE.context(system_of(thermostat_of([[0, 1, 2], [1, 0, 2], [0, 1, 3]])))

    @pytest.mark.parametrize("late", [True, False])
    def test_what_blows_up(self, late):
        integrator = mm.VerletIntegrator(0.2) if late else velocity_verlet(0.2)
        context, _ = viscous(forces=[], integrator=integrator)
        velocities = np.zeros((start().num_vertices, 3))
        velocities[17, 1] = np.inf
        context.setVelocities(velocities)
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: particle 17 .*velocity.*inf"):
            integrator.step(1)
        context.setVelocities(0 * start().vertices)
        positions = start().vertices.copy()
        one, other, _ = start().triangles[5]
        positions[one] = positions[other]
        context.setPositions(positions)
        words = rf"^{NAME}: particles ({one} and {other}|{other} and {one}),.*no direction"
        with pytest.raises(mm.OpenMMException, match=words):
            integrator.step(1)
        np.testing.assert_array_equal(motion(context)[0], positions)

    def test_edges_across_the_box(self):
        mesh = helfrich.Mesh.sheet(8, 8, 20, periodic=True)
        system = mm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(50.0)
        system.setDefaultPeriodicBoxVectors(*np.diag([30.0, 30, 30]))
        system.addForce(mm.CustomVolumeForce("0"))
        system.addForce(thermostat_of(mesh))
        context = REFERENCE.context(system)
        context.setPositions(mesh.vertices)
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*must be shorter than 15"):
            context.getIntegrator().step(1)

    def test_virtual_sites_elsewhere_follow(self):
        system = system_of(thermostat_of(start()))
        site = system.addParticle(0)
        system.setVirtualSite(site, mm.TwoParticleAverageSite(4, 5, 0.25, 0.75))
        context = REFERENCE.context(system, mm.VerletIntegrator(0.2))
        context.setPositions(np.vstack([start().vertices, [0, 0, 0]]))
        context.computeVirtualSites()
        context.getIntegrator().step(3)
        positions, _ = motion(context)
        expected = 0.25 * positions[4] + 0.75 * positions[5]
        np.testing.assert_allclose(positions[site], expected, rtol=0, atol=1e-12)


class TestState:
    def bits(self, context) -> list[bytes]:
        return [array.tobytes() for array in motion(context)]

    def begin(self, *, target=HELFRICH, seed: int = 7, integrator=None):
        flips = mover_of(start())
        context, _ = viscous(
            flips, target=target, seed=seed, frequency=2, integrator=integrator or langevin()
        )
        return context

    @pytest.mark.parametrize("same_context", [True, False])
    def test_a_checkpoint_goes_on_with_the_same_bits(self, same_context):
        context = self.begin()
        context.getIntegrator().step(31)
        checkpoint = context.createCheckpoint()
        context.getIntegrator().step(30)
        wanted = self.bits(context)
        if not same_context:
            context = self.begin(seed=99)
        context.loadCheckpoint(checkpoint)
        context.getIntegrator().step(30)
        assert self.bits(context) == wanted

    def test_the_same_seed_gives_the_same_bits_and_another_does_not(self):
        found = []
        for seed in (7, 7, 8):
            context = self.begin(seed=seed)
            context.getIntegrator().step(30)
            found.append(self.bits(context))
        assert found[0] == found[1]
        assert found[0] != found[2]

    def test_checkpoints_without_it_are_as_before(self):
        context = self.begin()
        assert b"HLF4" in context.createCheckpoint()
        plain = HELFRICH.context(system_of(*forces_of(start()), mover_of(start())), langevin())
        plain.setPositions(start().vertices)
        old = plain.createCheckpoint()
        assert b"HLF2" in old
        assert b"HLF4" not in old
        context.getIntegrator().step(5)
        context.loadCheckpoint(old)
        np.testing.assert_array_equal(motion(context)[0], start().vertices)

    def test_damaged_checkpoints_change_nothing(self):
        context = self.begin()
        context.getIntegrator().step(31)
        checkpoint, before = context.createCheckpoint(), self.bits(context)
        with pytest.raises(mm.OpenMMException, match=r"^loadCheckpoint: .*too early"):
            context.loadCheckpoint(checkpoint[:-5])
        assert self.bits(context) == before

    @pytest.mark.parametrize("target", [HELFRICH, CPU, ON_OPENCL[2]], ids=str)
    def test_a_file_goes_on_with_the_same_bits(self, tmp_path, target):
        found = []
        for seed in (7, 8):
            context = self.begin(target=target, seed=seed, integrator=mm.VerletIntegrator(0.2))
            if found:
                helfrich.load_state(context, tmp_path / "state")
            else:
                context.getIntegrator().step(31)
                helfrich.save_state(context, tmp_path / "state")
            context.getIntegrator().step(30)
            found.append(self.bits(context))
        assert found[0] == found[1]
        other, _ = viscous(mover_of(start()), thermostat_of(start()))
        with pytest.raises(ValueError, match=rf"has 1 {NAME}, but the Context has 2"):
            helfrich.load_state(other, tmp_path / "state")

    def test_reinitialize_keeps_it(self):
        context, other = self.begin(), self.begin()
        for one in (context, other):
            one.getIntegrator().step(31)
        context.reinitialize(preserveState=True)
        for one in (context, other):
            one.getIntegrator().step(20)
        assert self.bits(context) == self.bits(other)

    def test_a_state_of_another_length_is_refused(self):
        context, thermostat = viscous()
        with pytest.raises(mm.OpenMMException, match=rf"^{NAME}: .*3 bytes, not 24"):
            thermostat._restoreState(context, b"abc")

    def test_of_triangles_that_no_other_force_has(self, tmp_path):
        """They are state as those of forces are."""
        flipped = mover_of(start())
        flowing, _ = viscous(flipped)
        flowing.getIntegrator().step(20)
        triangles = flipped.getTrianglesInContext(flowing)
        context, thermostat = viscous(forces=[])
        thermostat.setTrianglesInContext(context, triangles)
        helfrich.save_state(context, tmp_path / "state")
        other, thermostat = viscous(forces=[])
        helfrich.load_state(other, tmp_path / "state")
        np.testing.assert_array_equal(thermostat.getTrianglesInContext(other), triangles)
        assert helfrich.Mesh.from_context(other, thermostat).num_vertices == start().num_vertices

    def test_no_membrane_is_left_over(self):
        before = _core.library().Helfrich_Membrane_count()
        context, _ = viscous(forces=[])
        assert _core.library().Helfrich_Membrane_count() == before + 1
        del context
        assert _core.library().Helfrich_Membrane_count() == before


class TestVesicle:
    def test_arguments(self):
        given = {"friction": 30.0, "frequency": 5, "temperature": 310.0, "randomNumberSeed": 4}
        vesicle = helfrich.Vesicle(start(), viscosity=given)
        assert vesicle.viscosity == given
        vesicle.system()
        thermostat = vesicle.placement.viscosity
        assert thermostat.getName() == "viscosity"
        assert thermostat.getDefaultFriction() == 30
        assert thermostat.getFrequency() == 5
        assert thermostat.getDefaultTemperature() == 310
        assert thermostat.getRandomNumberSeed() == 4
        assert helfrich.Vesicle(start()).viscosity is None

    def test_the_temperature_is_that_of_the_integrator(self):
        vesicle = helfrich.Vesicle(start(), viscosity=5 * unit.dalton / unit.picosecond, flips=0.01)
        simulation = vesicle.simulation(mm.LangevinMiddleIntegrator(350, 1, 0.1))
        context = simulation.context
        assert context.getParameter(Thermostat.Temperature()) == 350
        assert context.getParameter("BondFlipTemperature") == 350
        assert context.getParameter(Thermostat.Friction()) == pytest.approx(20 / 3**0.5)
        simulation.step(3)

    def test_several_have_frictions_of_their_own(self):
        system = mm.System()
        placements = [
            helfrich.Vesicle(start(), viscosity=viscosity).add_to(system)
            for viscosity in (1.0, 2.0)
        ]
        context = HELFRICH.context(system)
        names = [one.viscosity.getFrictionParameter() for one in placements]
        assert names == [Thermostat.Friction(), f"{Thermostat.Friction()}{start().num_vertices}"]
        frictions = [context.getParameter(name) * 3**0.5 / 4 for name in names]
        assert frictions == pytest.approx([1, 2])

    @pytest.mark.parametrize(
        ("viscosity", "words"),
        [
            (-1, "viscosity needs 0 or more"),
            ({"frequency": 3}, "lacks the argument 'friction'"),
            ({"friction": 3, "speed": 1}, "no argument 'speed'.*friction, temperature"),
        ],
    )
    def test_mistakes(self, viscosity, words):
        with pytest.raises(ValueError, match=f"^Vesicle: .*{words}"):
            helfrich.Vesicle(start(), viscosity=viscosity)


class TestToml:
    TEXT = """simulation.duration = 4
simulation.seed = 3
integrator = { time_step = 0.1, temperature = 310 }
output = { interval = 1, xtc = false }

[[vesicle]]
viscosity = 3
mesh = { icosphere = 2, radius = 30 }

[[vesicle]]
viscosity = { friction = 2, frequency = 4, temperature = 310 }
flips = 0.05
mesh = { icosphere = 2, radius = 30, translate = [80, 0, 0] }
"""

    def write(self, tmp_path, old: str = "", new: str = ""):
        path = tmp_path / "own.toml"
        path.write_text(self.TEXT.replace(old, new, 1), encoding="utf-8")
        return path

    def test_is_as_by_hand(self, tmp_path):
        system = config.read(self.write(tmp_path)).system()
        found = [Thermostat.cast(f) for f in system.getForces() if Thermostat.isinstance(f)]
        assert [f.getDefaultFriction() for f in found] == pytest.approx([12 / 3**0.5, 2])
        assert [f.getFrequency() for f in found] == [1, 4]
        assert [f.getDefaultTemperature() for f in found] == [310, 310]
        assert [f.getRandomNumberSeed() for f in found] == [3, 3]
        corners = np.array([found[1].getTriangle(i) for i in range(found[1].getNumTriangles())])
        assert corners.min() == 42

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("viscosity = 3", "viscosity = -3", r"7: key vesicle\[0\].viscosity: must be 0 or"),
            ("friction = 2, ", "", r"viscosity: it lacks friction"),
            ("friction = 2", "fricton = 2", r"viscosity: .*'fricton'.*did you mean friction"),
            ("frequency = 4", "frequency = 0.5", r"viscosity: frequency: expected an integer"),
            (
                "temperature = 310 }",
                'temperature = 310, kind = "Brownian" }',
                "3: key integrator.kind: Brownian dynamics have no velocities",
            ),
        ],
    )
    def test_mistakes(self, tmp_path, old, new, words):
        with pytest.raises(ConfigError, match=words):
            config.read(self.write(tmp_path, old, new))

    @pytest.mark.parametrize("platform", ["Helfrich", "Reference"])
    def test_a_run_goes_on_with_the_same_bits(self, tmp_path, platform):
        kind = 'kind = "Verlet", time_step'
        path = self.write(tmp_path, "time_step", kind)
        whole = Run(path, tmp_path / "whole", platform=platform)
        assert whole.advance(40)
        whole.close()
        parts = Run(path, tmp_path / "parts", platform=platform)
        parts.advance(17)
        parts.save()
        parts.close()
        parts = Run(path, tmp_path / "parts", resume=True)
        assert parts.advance(40)
        parts.close()
        assert np.array_equal(parts.frame.positions, whole.frame.positions)


class TestC:
    """The C functions, on forces and Contexts that Python holds."""

    def test_create_get_set(self):
        library = _core.library()
        prefix = f"Helfrich_{NAME}_"
        create = getattr(library, prefix + "create")
        create.restype = ctypes.c_void_p
        number = ctypes.c_double
        corners = np.ascontiguousarray(start().triangles, dtype=np.intc)
        pointer = corners.ctypes.data_as(ctypes.c_void_p)
        force = ctypes.c_void_p(create(pointer, len(corners), number(12.5), number(300), 5))
        assert force.value
        for name, old, new in (("DefaultFriction", 12.5, 3.0), ("DefaultTemperature", 300, 310)):
            get = getattr(library, f"{prefix}get{name}")
            get.restype = number
            assert get(force) == old
            assert getattr(library, f"{prefix}set{name}")(force, number(new)) == 0
            assert get(force) == new
        for name, old, new in (("Frequency", 5, 6), ("RandomNumberSeed", 0, -5)):
            assert getattr(library, f"{prefix}get{name}")(force) == old
            assert getattr(library, f"{prefix}set{name}")(force, new) == 0
            assert getattr(library, f"{prefix}get{name}")(force) == new
        assert getattr(library, prefix + "setFrictionParameter")(force, b"mine") == 0
        assert getattr(library, prefix + "setFrictionParameter")(force, b"") == 1
        assert _core.last_error().startswith(f"{NAME}: ")
        assert library.Helfrich_MembraneForce_getNumTriangles(force) == len(corners)
        library.Helfrich_MembraneForce_destroy(force)
        assert create(pointer, len(corners), number(-1), number(300), 5) is None
        assert "friction" in _core.last_error()
        assert create(None, -1, number(1), number(300), 5) is None
        assert "negative" in _core.last_error()

    def test_in_a_context(self):
        context, thermostat = viscous(forces=[])
        thermostat.setFrequency(0)
        force, there = (ctypes.c_void_p(int(one.this)) for one in (thermostat, context))
        update = getattr(_core.library(), f"Helfrich_{NAME}_updateParametersInContext")
        assert update(force, there) == 0
        context.getIntegrator().step(3)
        assert (motion(context)[1] == 0).all()
