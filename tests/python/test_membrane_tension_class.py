"""The class MonteCarloMembraneTension as any OpenMM Force, what it refuses, and its state."""

from __future__ import annotations

import copy
import ctypes

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import arguments_of
from openmm import unit
from openmmhelfrich import _core
from platforms import HELFRICH, REFERENCE
from tense import BOX, TEMPERATURE, box_of, mover_of, of_box, positions_of, system_of, tense
from test_membrane_tension_bodies import forces_of, sheet

Tension = helfrich.MonteCarloMembraneTension


class TestArguments:
    def test_names_of_parameters(self):
        assert Tension.Tension() == "MembraneTension"
        assert Tension.PullingForce() == "MembranePullingForce"
        assert Tension.Temperature() == "MembraneTensionTemperature"

    def test_signature(self):
        assert arguments_of(Tension) == (
            "(temperature, tension=0.0, frequency=25, axes=0, pullingForce=0.0)"
        )
        assert "kJ/mol/nm^2" in Tension.setDefaultTension.__doc__

    def test_with_units(self):
        mover = Tension(
            300 * unit.kelvin, 1 * unit.millijoule / unit.meter**2 * unit.AVOGADRO_CONSTANT_NA
        )
        assert mover.getDefaultTension() == pytest.approx(0.602214, rel=1e-5)
        mover.setDefaultPullingForce(1 * unit.kilocalorie_per_mole / unit.angstrom)
        assert mover.getDefaultPullingForce() == pytest.approx(41.84)
        mover.setDefaultTemperature(310 * unit.kelvin)
        assert mover.getDefaultTemperature() == 310

    def test_axes_by_name(self):
        mover = Tension(300, axes="XYConstantArea")
        assert mover.getAxes() == Tension.XYConstantArea
        mover.setAxes("ZOnly")
        assert mover.getAxes() == Tension.ZOnly

    def test_are_told_from_others(self):
        context = tense(of_box(), mover_of())
        plain = list(context.getSystem().getForces())
        assert [Tension.isinstance(force) for force in plain] == [False, True]
        assert Tension.cast(plain[1]).getStatistics(context)["attempts"] == 0
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloMembraneTension: cannot cast"):
            Tension.cast(plain[0])


class TestRefusals:
    def test_no_box(self):
        bond = mm.HarmonicBondForce()
        with pytest.raises(
            mm.OpenMMException, match=r"^MonteCarloMembraneTension: no force .*periodic"
        ):
            tense(bond, mover_of())

    @pytest.mark.parametrize("second", ["XYIsotropic", "XYConstantArea"])
    def test_two_of_the_same_axes(self, second):
        one, other = mover_of(), mover_of(axes=second)
        other.setName("another")
        with pytest.raises(mm.OpenMMException, match=r'two of them.*"another".*x and y'):
            tense(of_box(), one, other)

    @pytest.mark.parametrize("number", range(5))
    def test_beside_a_barostat(self, number):
        barostat = barostats()[number]
        context = None
        with pytest.raises(
            mm.OpenMMException, match=rf'^MonteCarloMembraneTension: .*"{barostat.getName()}"'
        ):
            context = tense(of_box(), mover_of(), barostat)
        assert context is None
        if hasattr(barostat, "setScaleMoleculesAsRigid"):
            idle = barostats(frequency=0)[number]
            context = tense(of_box(), mover_of(), idle)
            context.getIntegrator().step(3)
            assert box_of(context)[0, 0] != BOX[0, 0]

    def test_beads(self):
        integrator = mm.RPMDIntegrator(2, TEMPERATURE, 1.0, 0.001)
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloMembraneTension: .*RPMD"):
            tense(of_box(), mover_of(), target=REFERENCE, integrator=integrator)

    def test_a_constraint_of_a_vertex(self):
        triangles, positions, box = sheet()
        system = system_of(*forces_of(triangles), mover_of(), count=len(positions), box=box)
        system.addConstraint(3, 4, 1.5)
        with pytest.raises(mm.OpenMMException, match=r"constraint between the particles 3 and 4"):
            HELFRICH.context(system)

    def test_a_constraint_where_nothing_is_rigid(self):
        system = system_of(of_box(), mover_of(rigid=False))
        system.addConstraint(3, 4, 1.5)
        with pytest.raises(mm.OpenMMException, match=r"setScaleMoleculesAsRigid"):
            HELFRICH.context(system)

    def test_a_change_that_needs_a_new_context(self):
        mover = mover_of()
        context = tense(of_box(), mover)
        mover.setAxes("ZOnly")
        with pytest.raises(mm.OpenMMException, match=r"axes.*reinitialize"):
            mover.updateParametersInContext(context)
        context.reinitialize()
        context.setPositions(np.zeros((6, 3)))
        context.getIntegrator().step(5)
        assert (np.diag(box_of(context))[:2] == np.diag(BOX)[:2]).all()
        assert box_of(context)[2, 2] != BOX[2, 2]

    def test_a_box_that_becomes_too_small(self):
        """For a cutoff: OpenMM says so, and the Context is as it was."""
        force = mm.NonbondedForce()
        for _ in range(6):
            force.addParticle(0, 1, 0)
        force.setNonbondedMethod(force.CutoffPeriodic)
        force.setCutoffDistance(1.99)
        mover = mover_of(tension=-100.0)
        context = tense(force, of_box(), mover)
        with pytest.raises(mm.OpenMMException, match="cutoff"):
            context.getIntegrator().step(1000)
        # All moves before have been of free particles.
        fractions = positions_of(tense(of_box())) @ np.linalg.inv(BOX)
        now = box_of(context)
        np.testing.assert_allclose(positions_of(context) @ np.linalg.inv(now), fractions, atol=1e-9)
        assert min(np.diag(now)) >= 2 * 1.99


def barostats(frequency: int = 25, rigid: bool = True) -> list[mm.Force]:
    """All of OpenMM's."""
    membrane = mm.MonteCarloMembraneBarostat
    found = [
        mm.MonteCarloBarostat(1, TEMPERATURE, frequency),
        mm.MonteCarloAnisotropicBarostat((1, 1, 1), TEMPERATURE, True, True, True, frequency),
        membrane(1, 0, TEMPERATURE, membrane.XYIsotropic, membrane.ZFixed, frequency),
        mm.MonteCarloFlexibleBarostat(1, TEMPERATURE, frequency),
    ]
    for barostat in found:
        barostat.setScaleMoleculesAsRigid(rigid)
    return [*found, mm.RPMDMonteCarloBarostat(1, max(frequency, 1))]


class TestBarostatsOfOpenMM:
    @pytest.mark.parametrize("number", range(4))
    def test_would_tear_what_spans_the_box(self, number):
        triangles, positions, box = sheet()
        context = tense(*forces_of(triangles), barostats()[number], positions=positions, box=box)
        name = barostats()[number].getName()
        with pytest.raises(mm.OpenMMException, match=rf'spans the periodic box.*"{name}".*tears'):
            context.getIntegrator().step(1)

    @pytest.mark.parametrize("arguments", [{"frequency": 0}, {"rigid": False}], ids=str)
    @pytest.mark.parametrize("number", range(4))
    def test_that_do_not(self, number, arguments):
        triangles, positions, box = sheet()
        context = tense(
            *forces_of(triangles), barostats(**arguments)[number], positions=positions, box=box
        )
        context.getIntegrator().step(2)

    @pytest.mark.parametrize("periodic", [True, False])
    def test_move_a_vesicle_as_a_whole(self, periodic, lumpy):
        barostat = barostats(frequency=1)[0]
        forces = forces_of(lumpy.triangles, periodic)
        box = np.diag([30.0, 30, 30])
        context = tense(
            *forces,
            of_box(),
            barostat,
            positions=lumpy.vertices,
            box=box,
            integrator=mm.VerletIntegrator(1e-9),
        )
        context.getIntegrator().step(30)
        assert box_of(context)[0, 0] != 30
        centred = [p - p.mean(axis=0) for p in (positions_of(context), lumpy.vertices)]
        np.testing.assert_allclose(*centred, atol=1e-5)


class TestState:
    def test_what_cannot_be_is_refused(self):
        context = tense(of_box(), mover_of())
        context.getIntegrator().step(50)
        mover = Tension.cast(context.getSystem().getForce(1))
        saved, before = mover._saveState(context), mover.getStatistics(context)
        for broken in (saved[:-1], b"\xff" * len(saved), saved[:24] + b"\xff" * 8 + saved[32:]):
            with pytest.raises(mm.OpenMMException, match=r"^MonteCarloMembraneTension: .*damaged"):
                mover._restoreState(context, broken)
        assert mover.getStatistics(context) == before
        mover._restoreState(context, saved)

    def start(self, target=HELFRICH, seed: int = 7):
        triangles, positions, box = sheet()
        integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 1.0, 0.002)
        integrator.setRandomNumberSeed(4)
        movers = [
            mover_of(tension=0.5, frequency=2, seed=seed, adaptive=20),
            mover_of(axes="ZOnly", frequency=3, seed=seed, adaptive=20),
        ]
        flips = helfrich.MonteCarloBondFlip(triangles, TEMPERATURE, 2)
        flips.setRandomNumberSeed(3)
        return tense(
            *forces_of(triangles),
            *movers,
            flips,
            target=target,
            positions=positions,
            box=box,
            integrator=integrator,
        ), movers

    def bits(self, context) -> tuple[bytes, bytes]:
        return positions_of(context).tobytes(), box_of(context).tobytes()

    @pytest.mark.parametrize("same_context", [True, False])
    def test_a_checkpoint_goes_on_with_the_same_bits(self, same_context):
        context, movers = self.start()
        context.getIntegrator().step(31)
        checkpoint = context.createCheckpoint()
        context.getIntegrator().step(40)
        wanted, statistics = self.bits(context), [m.getStatistics(context) for m in movers]
        assert statistics[0]["accepted"] > 0
        if not same_context:
            context, movers = self.start(seed=99)
        context.loadCheckpoint(checkpoint)
        context.getIntegrator().step(40)
        assert self.bits(context) == wanted
        assert [m.getStatistics(context) for m in movers] == statistics

    def test_the_same_seed_gives_the_same_bits(self):
        found = []
        for target in (HELFRICH, HELFRICH, REFERENCE):
            context, _ = self.start(target)
            context.setVelocities(np.zeros((36, 3)))
            context.getIntegrator().step(30)
            found.append(self.bits(context))
        assert found[0] == found[1]
        assert found[0][1] != sheet()[2].tobytes()

    def test_a_file_goes_on_with_the_same_moves(self, tmp_path):
        """Without heat and flips, which have random numbers of their own."""
        triangles, positions, box = sheet()
        found = []
        for _ in range(2):
            mover = mover_of(tension=0.5, seed=7 + len(found), adaptive=20)
            context = tense(*forces_of(triangles), mover, positions=positions, box=box)
            if found:
                helfrich.load_state(context, tmp_path / "state")
            else:
                context.getIntegrator().step(31)
                helfrich.save_state(context, tmp_path / "state")
            context.getIntegrator().step(40)
            found.append((self.bits(context), mover.getStatistics(context)))
        assert found[0] == found[1]
        assert found[0][1]["attempts"] == 71
        other = tense(
            *forces_of(triangles),
            mover_of(),
            mover_of(axes="ZOnly"),
            positions=positions,
            box=box,
        )
        with pytest.raises(ValueError, match=r"has 1 MonteCarloMembraneTension.* has 2"):
            helfrich.load_state(other, tmp_path / "state")

    def test_reinitialize_keeps_it(self):
        context, movers = self.start()
        context.getIntegrator().step(31)
        other, _ = self.start()
        other.getIntegrator().step(31)
        context.reinitialize(preserveState=True)
        assert movers[0].getStatistics(context)["attempts"] == 15
        for one in (context, other):
            one.getIntegrator().step(20)
        assert self.bits(context) == self.bits(other)

    def test_a_checkpoint_from_before_there_was_a_mover(self):
        triangles, positions, box = sheet()
        plain = tense(*forces_of(triangles), positions=positions, box=box)
        mover = mover_of(tension=0.5)
        context = tense(*forces_of(triangles), mover, positions=positions, box=box)
        context.getIntegrator().step(5)
        context.loadCheckpoint(plain.createCheckpoint())
        assert self.bits(context) == (positions.tobytes(), box.tobytes())
        context.getIntegrator().step(5)
        assert mover.getStatistics(context)["attempts"] == 10

    def test_the_platform_is_chosen(self):
        context, _ = self.start()
        system = copy.deepcopy(context.getSystem())
        chosen = mm.Context(system, mm.VerletIntegrator(0.001)).getPlatform()
        assert chosen.getName() == "Helfrich"


class TestC:
    """The C functions, on forces and Contexts that Python holds."""

    def test_create_get_set(self):
        library = _core.library()
        prefix = "Helfrich_MonteCarloMembraneTension_"
        create = getattr(library, prefix + "create")
        create.restype = ctypes.c_void_p
        number = ctypes.c_double
        force = ctypes.c_void_p(create(number(300), number(0.5), 5, 3, number(-2)))
        assert force.value
        getattr(library, prefix + "getDefaultPullingForce").restype = number
        assert getattr(library, prefix + "getDefaultPullingForce")(force) == -2
        for name, old, new in (
            ("Frequency", 5, 6),
            ("Axes", 3, 1),
            ("ScaleMoleculesAsRigid", 1, 0),
            ("AdaptiveMoves", 1000, 3),
            ("RandomNumberSeed", 0, -5),
        ):
            assert getattr(library, f"{prefix}get{name}")(force) == old
            assert getattr(library, f"{prefix}set{name}")(force, new) == 0
            assert getattr(library, f"{prefix}get{name}")(force) == new
        assert getattr(library, prefix + "setAxes")(force, 7) == 1
        assert _core.last_error() == "MonteCarloMembraneTension: there are no axes 7"
        library.Helfrich_MembraneForce_destroy(force)
        assert create(number(-1), number(0), 5, 0, number(0)) is None
        assert "temperature" in _core.last_error()

    def test_in_a_context(self):
        library = _core.library()
        mover = mover_of()
        context = tense(of_box(), mover)
        context.getIntegrator().step(10)
        force, there = (ctypes.c_void_p(int(one.this)) for one in (mover, context))
        value = ctypes.c_double()
        get = library.Helfrich_MonteCarloMembraneTension_getStatistic
        assert get(force, there, b"attempts", ctypes.byref(value)) == 0
        assert value.value == 10
        assert get(force, there, b"luck", ctypes.byref(value)) == 1
        assert "luck" in _core.last_error()
        assert "widthX" not in _core.last_error()
        mover.setFrequency(0)
        update = library.Helfrich_MonteCarloMembraneTension_updateParametersInContext
        assert update(force, there) == 0
        context.getIntegrator().step(10)
        assert mover.getStatistics(context)["attempts"] == 10
