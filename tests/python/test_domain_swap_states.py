"""Checkpoints, States and saved states of Contexts in which vertices exchange what they are."""

from __future__ import annotations

import struct

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import langevin, measure, mover_of, start, system_of
from mixing import bits, domains_of, force_in, forces_of, mixing, swap_of
from platforms import CPU, HELFRICH, NATIVE, ON_OPENCL, REFERENCE, Target
from surface_movers import ELSEWHERE, ForeignStates, step
from test_bond_flip import custom_integrator
from test_domain_swap import COUNT, assert_as_fresh

FOREIGN = "^MonteCarloDomainSwap: .*DomainSwapPermutation0.*load_state.*setPermutationInContext"
#: Neither a whole number of rounds nor of attempts has been made at step 13.
UNEVEN = {"frequency": 3, "attemptsPerEdge": 0.2513}


def both(target: Target = HELFRICH, integrator: mm.Integrator | None = None, seed: int = 7):
    """A Context in which bonds flip and vertices exchange, and what does both."""
    swaps = swap_of(start(), seed, **UNEVEN)
    flips = mover_of(start(), seed, frequency=2, attemptsPerEdge=0.171)
    forces = forces_of(start(), domains_of(COUNT), target.backend)[:-1]
    context = target.context(system_of(*forces, swaps, flips), integrator or langevin())
    context.setPositions(start().vertices)
    return context, swaps, flips


def all_of(context, *movers):
    return bits(context), [mover.getStatistics(context) for mover in movers]


class TestCheckpoints:
    """On platform Helfrich they hold all."""

    @pytest.mark.parametrize("threads", ["1", "2"])
    @pytest.mark.parametrize("anew", [True, False])
    def test_go_on_with_the_same_bits(self, threads, anew):
        target = Target("Helfrich", "Helfrich", 1e-9, {"Threads": threads})
        context, *movers = both(target, seed=0)
        checkpoint = step(context, 13).createCheckpoint()
        assert b"HLC3" in checkpoint
        wanted = all_of(step(context, 20), *movers)
        assert min(statistics["accepted"] for statistics in wanted[1]) > 20
        if anew:
            context, *movers = both(target, seed=0)
        context.loadCheckpoint(checkpoint)
        assert all_of(step(context, 20), *movers) == wanted

    def test_hold_what_a_user_has_set(self):
        context = HELFRICH.context(system_of(*forces_of(start(), domains_of(COUNT))), langevin())
        context.setPositions(start().vertices)
        bending = force_in(context, helfrich.BendingForce)
        plain = context.createCheckpoint()
        assert b"HLC" not in plain
        permutation = np.random.default_rng(3).permutation(COUNT)
        bending.setPermutationInContext(context, permutation)
        energy = measure(context)[0]
        changed = context.createCheckpoint()
        context.loadCheckpoint(plain)
        np.testing.assert_array_equal(bending.getPermutationInContext(context), np.arange(COUNT))
        assert measure(context)[0] != energy
        context.loadCheckpoint(changed)
        np.testing.assert_array_equal(bending.getPermutationInContext(context), permutation)
        assert measure(context)[0] == energy

    def test_of_before_there_were_exchanges(self):
        # What has only flips is written as it was then.
        forces = forces_of(start(), domains_of(COUNT))[:-1]
        flips = mover_of(start())
        context = HELFRICH.context(system_of(*forces, flips), langevin())
        context.setPositions(start().vertices)
        old = step(context, 10).createCheckpoint()
        assert b"HLC2" in old
        assert b"HLC3" not in old
        triangles = flips.getTrianglesInContext(context)
        flips.setPermutationInContext(context, np.arange(COUNT)[::-1])
        assert b"HLC3" in context.createCheckpoint()
        context.loadCheckpoint(old)
        np.testing.assert_array_equal(flips.getPermutationInContext(context), np.arange(COUNT))
        np.testing.assert_array_equal(flips.getTrianglesInContext(context), triangles)

    def test_of_a_system_without_the_mover(self):
        """What the mover has exchanged is as it was then, and the Context's parameters say so."""
        without = HELFRICH.context(system_of(*forces_of(start(), domains_of(COUNT))), langevin())
        without.setPositions(start().vertices)
        old = without.createCheckpoint()
        context, mover = mixing(HELFRICH)
        assert mover.getStatistics(step(context, 20))["accepted"] > 20
        assert context.getParameter("DomainSwapPermutation0") != 0
        context.loadCheckpoint(old)
        np.testing.assert_array_equal(mover.getPermutationInContext(context), np.arange(COUNT))
        assert context.getParameter("DomainSwapPermutation0") == 0
        assert measure(context)[0] == pytest.approx(measure(without)[0], rel=1e-12)
        state = context.getState(positions=True, parameters=True, energy=True)
        other, _ = mixing(HELFRICH)
        other.setState(state)
        assert measure(other)[0] == pytest.approx(measure(without)[0], rel=1e-12)
        assert_as_fresh(step(context, 4), HELFRICH, 1e-9)

    def test_that_are_damaged(self):
        context, swaps, _ = both()
        saved = bytearray(swaps._saveConnectivity(step(context, 10)))
        before = bits(context)
        for place in (2, 30, len(saved) // 2, len(saved) - 90):
            broken = saved.copy()
            broken[place] ^= 1
            with pytest.raises(mm.OpenMMException, match=r"^MonteCarloDomainSwap: .*damaged"):
                swaps._restoreConnectivity(context, bytes(broken))
        # A wrong permutation with a right checksum.
        permutation = swaps.getPermutationInContext(context).astype("<u4").tobytes()
        place = saved.index(permutation)
        saved[place : place + 4] = saved[place + 4 : place + 8]
        checksum = 0xCBF29CE484222325
        for byte in saved[:-8]:
            checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
        saved[-8:] = struct.pack("<Q", checksum)
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloDomainSwap: .*permutation.*none"):
            swaps._restoreConnectivity(context, bytes(saved))
        assert bits(context) == before


class TestForeignStates(ForeignStates):
    foreign = FOREIGN

    def made(self, target):
        return mixing(target)

    def moved(self, context, mover):
        return mover.getPermutationInContext(context)

    def put(self, context, mover, moved):
        mover.setPermutationInContext(context, moved)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, NATIVE[2]], ids=str)
    def test_not_by_mistake_under_a_custom_integrator(self, target):
        context, mover = mixing(target, custom_integrator())
        for _ in range(5):
            step(context, 7)
            measure(context)
        assert mover.getStatistics(context)["accepted"] > 20
        assert_as_fresh(context, target, 1e-9)


class TestSaved:
    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH], ids=str)
    @pytest.mark.parametrize("anew", [True, False])
    def test_go_on_with_the_same_bits(self, target, anew, tmp_path):
        context, *movers = both(target, mm.VerletIntegrator(0.2), seed=0)
        step(context, 13)
        context.setParameter("DomainSwapTemperature", 321.5)
        helfrich.save_state(context, tmp_path / "state")
        wanted = all_of(step(context, 20), *movers)
        if anew:
            context, *movers = both(target, mm.VerletIntegrator(0.2), seed=0)
        helfrich.load_state(context, tmp_path / "state")
        assert context.getParameter("DomainSwapTemperature") == 321.5
        assert all_of(step(context, 20), *movers) == wanted

    def test_on_another_platform(self, tmp_path):
        context, _ = mixing(HELFRICH)
        step(context, 20)
        helfrich.save_state(context, tmp_path / "state")
        energy = measure(context)[0]
        for target in (REFERENCE, CPU, ON_OPENCL[2], NATIVE[2]):
            other, _ = mixing(target, seed=123)
            helfrich.load_state(step(other, 5), tmp_path / "state")
            assert measure(other)[0] == pytest.approx(energy, rel=1e-9)
            assert bits(other) == bits(context)
            assert_as_fresh(other, target, 1e-9)
            step(other, 4)


class TestMadeAnew:
    """`Context.reinitialize(preserveState=True)`."""

    @pytest.mark.parametrize("target", [REFERENCE, CPU, HELFRICH], ids=str)
    def test_go_on_with_the_same_bits(self, target):
        context, *movers = both(target, mm.VerletIntegrator(0.2))
        again, *others = both(target, mm.VerletIntegrator(0.2))
        step(context, 13).reinitialize(preserveState=True)
        assert all_of(step(context, 20), *movers) == all_of(step(again, 33), *others)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH], ids=str)
    def test_under_an_integrator_of_variable_masses(self, target):
        def made():
            return mixing(target, helfrich.VariableMassVerletIntegrator(0.2))

        (context, mover), (again, other) = made(), made()
        step(context, 13).reinitialize(preserveState=True)
        assert all_of(step(context, 20), mover) == all_of(step(again, 33), other)
        assert mover.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("target", [HELFRICH, *ELSEWHERE], ids=str)
    def test_whatever_asks_first(self, target):
        context, mover = mixing(target)
        before = all_of(step(context, 10), mover)
        bending = force_in(context, helfrich.BendingForce)
        line = force_in(context, helfrich.LineTensionForce)
        domains = line.getDomainsInContext(context).tolist()
        for ask, wanted in [
            (lambda: mover.getPermutationInContext(context).tobytes(), before[0][3]),
            (lambda: line.getDomainsInContext(context).tolist(), domains),
            (lambda: mover.getStatistics(context), before[1][0]),
            (lambda: assert_as_fresh(context, target, 1e-9), None),
            (lambda: bending.updateParametersInContext(context), None),
        ]:
            context.reinitialize(preserveState=True)
            found = ask()
            assert found == wanted
            assert all_of(context, mover) == before
        assert_as_fresh(step(context, 4), target, 1e-9)

    def test_without_the_state_begin_at_the_beginning(self):
        context, mover = mixing()
        step(context, 10)
        context.reinitialize()
        context.setPositions(start().vertices)
        np.testing.assert_array_equal(mover.getPermutationInContext(context), np.arange(COUNT))
        assert mover.getStatistics(context)["attempts"] == 0
        assert_as_fresh(step(context, 4), REFERENCE, 1e-9)

    def test_forces_that_have_come_and_gone(self):
        # The permutation is the membrane's, whoever is there.
        context, mover = mixing()
        permutation = mover.getPermutationInContext(step(context, 20))
        system = context.getSystem()
        new = helfrich.LineTensionForce(start(), 0.2, np.arange(COUNT) % 5)
        system.addForce(new)
        system.removeForce(0)
        context.reinitialize(preserveState=True)
        np.testing.assert_array_equal(new.getDomainsInContext(context), permutation % 5)
        energy = measure(context)[0]
        forces = forces_of(start(), domains_of(COUNT)[permutation])[1:]
        more = helfrich.LineTensionForce(start(), 0.2, permutation % 5)
        fresh = REFERENCE.context(system_of(*forces, more))
        fresh.setPositions(context.getState(getPositions=True).getPositions(asNumpy=True))
        assert energy == pytest.approx(measure(fresh)[0], rel=1e-12)
        step(context, 4)
