"""Contexts with flips that are made anew, and States that are refused, wholly or not at all."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import bits, flowing, forces_of, langevin, measure, mover_of, start, system_of
from platforms import CPU, HELFRICH, NATIVE, ON_OPENCL, REFERENCE
from test_bond_flip import assert_as_fresh, custom_integrator
from test_bond_flip_states import FOREIGN, step

ANYWHERE = [REFERENCE, CPU, HELFRICH, ON_OPENCL[2], NATIVE[2]]


def state_of(context: mm.Context, **more) -> mm.State:
    return context.getState(positions=True, velocities=True, parameters=True, **more)


def two_surfaces(target, integrator, second_degree: int = 10):
    """Two vesicles that flow, far from each other, and the forces on them."""
    mesh = start()
    second = mesh.triangles + mesh.num_vertices
    forces = [helfrich.BendingForce(mesh, 30), helfrich.BendingForce(second, 40)]
    other = helfrich.MonteCarloBondFlip(second, 300, 1, 0.5, maxDegree=second_degree)
    other.setRandomNumberSeed(4)
    system = system_of(*forces, mover_of(mesh), other)
    for _ in range(mesh.num_vertices):
        system.addParticle(50)
    context = target.context(system, integrator)
    context.setPositions(np.concatenate([mesh.vertices, mesh.vertices + 500.0]))
    return context, forces, other


class TestMadeAnew:
    """`Context.reinitialize(preserveState=True)`."""

    @pytest.mark.parametrize("target", [REFERENCE, CPU, HELFRICH], ids=str)
    def test_go_on_with_the_same_bits(self, target):
        # Neither a whole number of rounds nor of attempts has been made at step 13.
        arguments = {"frequency": 3, "attemptsPerEdge": 0.2513}
        context, mover = flowing(target, mm.VerletIntegrator(0.2), **arguments)
        again, other = flowing(target, mm.VerletIntegrator(0.2), **arguments)
        step(context, 13).reinitialize(preserveState=True)
        assert bits(step(context, 20)) == bits(step(again, 33))
        assert mover.getStatistics(context) == other.getStatistics(again)
        assert mover.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("target", ANYWHERE, ids=str)
    def test_whatever_asks_first(self, target, tmp_path):
        context, mover = flowing(target)
        other, _ = flowing(target)
        before = bits(step(context, 10))
        statistics = mover.getStatistics(context)

        def loaded():
            helfrich.save_state(context, tmp_path / "state")
            helfrich.load_state(other, tmp_path / "state")
            return bits(other)[2]

        for ask, wanted in [
            (lambda: mover.getTrianglesInContext(context).tobytes(), before[2]),
            (lambda: mover.getStatistics(context), statistics),
            (lambda: assert_as_fresh(context, mover, target, 1e-9), None),
            (lambda: mover.updateParametersInContext(context), None),
            (loaded, before[2]),
        ]:
            context.reinitialize(preserveState=True)
            context.reinitialize(preserveState=True)
            assert ask() == wanted
            assert bits(context)[2] == before[2]
            assert mover.getStatistics(context) == statistics
        assert_as_fresh(step(context, 4), mover, target, 1e-9)

    @pytest.mark.parametrize("target", ANYWHERE, ids=str)
    def test_without_the_state_begin_at_the_beginning(self, target):
        context, mover = flowing(target)
        step(context, 10)
        context.reinitialize()
        context.setPositions(start().vertices)
        np.testing.assert_array_equal(mover.getTrianglesInContext(context), start().triangles)
        assert mover.getStatistics(context)["attempts"] == 0
        assert_as_fresh(step(context, 4), mover, target, 1e-9)

    def test_and_then_given_another_state(self):
        context, _ = flowing()
        early = state_of(step(context, 6))
        step(context, 10).reinitialize()
        context.setState(early)
        with pytest.raises(mm.OpenMMException, match=FOREIGN):
            step(context, 1)

    def test_do_not_touch_the_next_context(self):
        arguments = {"frequency": 1, "attemptsPerEdge": 1}
        wanted = [bits(step(flowing(seed=seed, **arguments)[0], 3))[2] for seed in (1, 2)]
        context, _ = flowing(seed=1, **arguments)
        assert bits(step(context, 3))[2] == wanted[0]
        del context
        context, mover = flowing(seed=2, **arguments)
        assert mover.getStatistics(context)["attempts"] == 0
        assert bits(step(context, 3))[2] == wanted[1]

    def test_with_bounds_that_the_triangles_violate(self):
        context, mover = flowing()
        degrees = np.bincount(mover.getTrianglesInContext(step(context, 40)).ravel())
        assert degrees.max() > np.bincount(start().triangles.ravel()).max()
        mover.setMaxDegree(int(degrees.max()) - 1)
        context.reinitialize(preserveState=True)
        for _ in range(2):
            with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*neighbours"):
                measure(context)
        # Triangles that it allows help.
        mover.setTrianglesInContext(context, start().triangles)
        measure(context)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH], ids=str)
    def test_with_several_surfaces(self, target):
        context, forces, _ = two_surfaces(target, mm.VerletIntegrator(0.1))
        step(context, 10)
        before = [force.getTrianglesInContext(context).tolist() for force in forces]
        assert before[0] != start().triangles.tolist()
        context.reinitialize(preserveState=True)
        energy, _ = measure(context)
        assert [force.getTrianglesInContext(context).tolist() for force in forces] == before
        context.reinitialize(preserveState=True)
        assert measure(context)[0] == energy

    @pytest.mark.parametrize("target", ANYWHERE, ids=str)
    def test_without_the_mover(self, target):
        context, mover = flowing(target)
        triangles = mover.getTrianglesInContext(step(context, 10))
        energy, _ = measure(context)
        context.getSystem().removeForce(context.getSystem().getNumForces() - 1)
        context.reinitialize(preserveState=True)
        assert measure(context)[0] == pytest.approx(energy, rel=1e-9)
        bending = helfrich.BendingForce.cast(context.getSystem().getForce(0))
        np.testing.assert_array_equal(bending.getTrianglesInContext(step(context, 10)), triangles)

    def test_with_other_triangles(self):
        context = step(flowing()[0], 10)
        while context.getSystem().getNumForces() > 0:
            context.getSystem().removeForce(0)
        other = np.roll(start().triangles, 1, axis=0)
        for force in (*forces_of(start(), other), helfrich.MonteCarloBondFlip(other, 300)):
            context.getSystem().addForce(force)
        context.reinitialize(preserveState=True)
        with pytest.raises(mm.OpenMMException, match=FOREIGN):
            measure(context)

    @pytest.mark.parametrize("target", [REFERENCE, CPU], ids=str)
    def test_with_triangles_set_by_hand(self, target):
        other, mover = flowing(seed=5)
        triangles = mover.getTrianglesInContext(step(other, 20))
        guard = helfrich.MonteCarloBondFlip(start(), 300, frequency=0)
        context = target.context(system_of(*forces_of(start()), guard), langevin())
        context.setPositions(start().vertices)
        before = state_of(context)
        guard.setTrianglesInContext(context, triangles)
        step(context, 5).reinitialize(preserveState=True)
        np.testing.assert_array_equal(guard.getTrianglesInContext(context), triangles)
        np.testing.assert_array_equal(guard.getTrianglesInContext(step(context, 20)), triangles)
        context.setState(before)
        with pytest.raises(mm.OpenMMException, match=FOREIGN):
            measure(context)


class TestUnderACustomIntegrator:
    """It sets parameters back that change during its steps, the fingerprint too."""

    @pytest.mark.parametrize("steps", [3, 4, 30])
    @pytest.mark.parametrize("evaluate", [True, False])
    def test_states_from_before_the_last_flips_are_refused(self, steps, evaluate):
        context, _ = flowing(REFERENCE, custom_integrator())
        for _ in range(2):
            early = state_of(context, energy=True)
            step(context, steps)
            context.setState(early)
            with pytest.raises(mm.OpenMMException, match=FOREIGN):
                measure(context) if evaluate else step(context, 1)
            context, _ = flowing(REFERENCE, custom_integrator())
            step(context, 6)

    def test_states_without_evaluation_are_those_of_the_last_one(self):
        # Their fingerprint is older than they are; that much OpenMM leaves us.
        context, _ = flowing(REFERENCE, custom_integrator())
        stale = state_of(step(context, 10))
        step(context, 10)
        context.setState(stale)
        with pytest.raises(mm.OpenMMException, match=FOREIGN):
            measure(context)

    @pytest.mark.parametrize("target", ANYWHERE, ids=str)
    @pytest.mark.parametrize("steps", [3, 4])
    def test_contexts_made_anew_lose_nothing(self, target, steps):
        context, mover = flowing(target, custom_integrator())
        for _ in range(2):
            triangles = mover.getTrianglesInContext(step(context, steps))
            context.reinitialize(preserveState=True)
            assert_as_fresh(context, mover, target, 1e-9)
            np.testing.assert_array_equal(mover.getTrianglesInContext(context), triangles)
        assert mover.getStatistics(step(context, 10))["attempts"] == (2 * steps + 10) // 2 * 81

    def test_contexts_with_another_state_get_nothing(self):
        still, _ = flowing(REFERENCE, custom_integrator(), frequency=0)
        state = state_of(step(still, 10))
        step(flowing(REFERENCE, custom_integrator())[0], 10)
        context, mover = flowing(REFERENCE, custom_integrator())
        context.setState(state)
        np.testing.assert_array_equal(mover.getTrianglesInContext(context), start().triangles)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    def test_clocks_may_be_set(self, target):
        context, mover = flowing(target, custom_integrator())
        for set_clock in (lambda: context.setTime(0), lambda: context.setStepCount(0)):
            step(context, 10)
            set_clock()
            step(context, 3)
            set_clock()
            measure(context)
        context.setTime(0)
        context.setStepCount(0)
        step(context, 3)
        assert mover.getStatistics(context)["accepted"] > 20

    def test_updates_need_not_be_in_every_step(self):
        integrator = mm.CustomIntegrator(0.2)
        integrator.addGlobalVariable("k", 0)
        integrator.beginIfBlock("k = 4")
        integrator.addUpdateContextState()
        integrator.addComputeGlobal("k", "-1")
        integrator.endBlock()
        integrator.addComputeGlobal("k", "k+1")
        integrator.addComputePerDof("v", "v+dt*f/m")
        integrator.addComputePerDof("x", "x+dt*v")
        context, mover = flowing(REFERENCE, integrator, frequency=1)
        step(context, 50)
        measure(context)
        step(context, 50)
        assert mover.getStatistics(context)["attempts"] == 20 * 81
        assert_as_fresh(context, mover, REFERENCE, 1e-9)


class TestAllOrNothing:
    """What one of several surfaces refuses."""

    WORDS = r"MonteCarloBondFlip: .*neighbours"

    def contexts(self, target):
        """A Context with flips, and another that will not have the second surface of the first."""
        context, (_, second), _ = two_surfaces(target, mm.VerletIntegrator(0.1))
        most = int(np.bincount(start().triangles.ravel()).max())
        degrees = np.bincount(second.getTrianglesInContext(step(context, 40)).ravel())
        assert degrees.max() > most
        other, forces, mover = two_surfaces(target, mm.VerletIntegrator(0.1), most)
        return context, step(other, 5), forces, mover

    def found(self, context, forces, mover):
        state = state_of(context)
        return (
            state.getPositions(asNumpy=True)._value.tobytes(),
            state.getTime(),
            context.getStepCount(),
            [force.getTrianglesInContext(context).tolist() for force in forces],
            mover.getStatistics(context)["attempts"],
        )

    def test_checkpoints(self):
        context, other, forces, mover = self.contexts(HELFRICH)
        before = self.found(other, forces, mover)
        with pytest.raises(mm.OpenMMException, match=self.WORDS):
            other.loadCheckpoint(context.createCheckpoint())
        assert self.found(other, forces, mover) == before

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH], ids=str)
    def test_saved_states(self, target, tmp_path):
        context, other, forces, mover = self.contexts(target)
        before = self.found(other, forces, mover)
        helfrich.save_state(context, tmp_path / "state")
        with pytest.raises(mm.OpenMMException, match=self.WORDS):
            helfrich.load_state(other, tmp_path / "state")
        assert self.found(other, forces, mover) == before
        step(other, 3)


def test_movers_of_two_temperatures_are_refused():
    mesh = start()
    second = mesh.triangles + mesh.num_vertices
    movers = [mover_of(mesh), helfrich.MonteCarloBondFlip(second, 310)]
    system = system_of(*movers)
    for _ in range(mesh.num_vertices):
        system.addParticle(50)
    with pytest.raises(mm.OpenMMException, match="BondFlipTemperature"):
        REFERENCE.context(system)
