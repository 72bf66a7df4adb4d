"""MonteCarloDomainSwap in a Context: what is exchanged, what evaluations see, what is refused."""

from __future__ import annotations

import ctypes
import itertools

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import TEMPERATURE, langevin, measure, mover_of, start, system_of
from mixing import TABLE, bits, domains_of, force_in, forces_of, mixing, swap_of
from openmmhelfrich import _core
from platforms import (
    CPU,
    HELFRICH,
    NATIVE,
    ON_GPU,
    ON_OPENCL,
    ON_PROCESSOR,
    REFERENCE,
    Target,
    sparing,
)
from surface_movers import SameBits
from test_bond_flip import INTEGRATORS, driven

EVERYWHERE = [*ON_PROCESSOR, *ON_OPENCL, *ON_GPU, *NATIVE]
COUNT = start().num_vertices


def assert_as_fresh(context: mm.Context, target: Target, tolerance: float) -> None:
    """Energy and forces are those of a Context that was made with the present values."""
    line = force_in(context, helfrich.LineTensionForce)
    permutation = line.getPermutationInContext(context)
    domains = line.getDomainsInContext(context)
    np.testing.assert_array_equal(domains, domains_of(COUNT)[permutation])
    np.testing.assert_array_equal(np.sort(permutation), np.arange(COUNT))
    mesh = helfrich.Mesh(start().vertices, line.getTrianglesInContext(context))
    forces = forces_of(start(), domains, target.backend)
    fresh = target.context(system_of(*forces))
    fresh.setPositions(context.getState(getPositions=True).getPositions(asNumpy=True))
    forces[0].setTrianglesInContext(fresh, mesh)
    energy, f = measure(context)
    wanted, g = measure(fresh)
    assert energy == pytest.approx(wanted, rel=tolerance)
    assert np.abs(f - g).max() <= tolerance * np.abs(g).max()


class TestDriven:
    @driven
    def test_by_every_integrator(self, name, target):
        context, mover = mixing(target, INTEGRATORS[name]())
        context.getIntegrator().step(20)
        # Ten rounds of 0.3 × 270 edges, which is 81.
        statistics = mover.getStatistics(context)
        assert statistics["attempts"] == 810
        assert statistics["accepted"] > 20
        assert (mover.getPermutationInContext(context) != np.arange(COUNT)).any()
        assert_as_fresh(context, target, 1e-9)

    @pytest.mark.parametrize("target", sparing(EVERYWHERE))
    def test_evaluations_see_the_present_values(self, target):
        context, mover = mixing(target)
        for _ in range(3):
            context.getIntegrator().step(8)
            assert_as_fresh(context, target, max(target.tolerance, 1e-9))
        assert mover.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    @pytest.mark.parametrize("first", [True, False], ids=["flips last", "flips first"])
    def test_beside_flips(self, target, first):
        flips, swaps = mover_of(start(), frequency=1), swap_of(start(), frequency=1)
        movers = [swaps, flips] if first else [flips, swaps]
        # A reference that flips do not soon make crossed.
        forces = forces_of(start(), domains_of(COUNT), target.backend)[:-1]
        context = target.context(system_of(*movers, *forces), langevin())
        context.setPositions(start().vertices)
        for _ in range(3):
            context.getIntegrator().step(8)
            line = force_in(context, helfrich.LineTensionForce)
            fresh_forces = forces_of(start(), line.getDomainsInContext(context), target.backend)
            fresh = target.context(system_of(*fresh_forces[:-1]))
            positions = context.getState(getPositions=True).getPositions(asNumpy=True)
            fresh.setPositions(positions)
            fresh_forces[0].setTrianglesInContext(fresh, flips.getTrianglesInContext(context))
            (energy, f), (wanted, g) = measure(context), measure(fresh)
            assert energy == pytest.approx(wanted, rel=1e-9)
            assert np.abs(f - g).max() <= 1e-9 * np.abs(g).max()
        assert flips.getStatistics(context)["accepted"] > 20
        assert swaps.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("target", [CPU, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    def test_alike_on_all_platforms(self, target):
        # A force from before an exchange would soon be seen.
        found = []
        for one in (REFERENCE, target):
            context, mover = mixing(one, mm.VerletIntegrator(0.2))
            velocities = np.random.default_rng(2).normal(0, 0.2, (COUNT, 3))
            context.setVelocities(velocities)
            context.getIntegrator().step(30)
            assert mover.getStatistics(context)["accepted"] > 20
            found.append(context.getState(getPositions=True).getPositions(asNumpy=True)._value)
        assert np.abs(found[0] - start().vertices).max() > 0.5
        np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-6)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    def test_between_two_half_kicks(self, target):
        context, mover = mixing(target, mm.VerletIntegrator(0.2), frequency=1, attemptsPerEdge=1)
        before = measure(context)[1]
        context.getIntegrator().step(1)
        assert mover.getStatistics(context)["accepted"] > 20
        moved = context.getState(getPositions=True).getPositions(asNumpy=True)._value
        context.setPositions(start().vertices)
        after = measure(context)[1]
        assert np.abs(after - before).max() > 0.01 * np.abs(before).max()
        expected = start().vertices + 0.2**2 / 50 * (before + after) / 2
        np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-9)

    def test_never_at_frequency_zero(self):
        context, mover = mixing(frequency=0)
        context.getIntegrator().step(20)
        assert mover.getStatistics(context)["attempts"] == 0
        np.testing.assert_array_equal(mover.getPermutationInContext(context), np.arange(COUNT))

    def test_not_by_the_minimizer(self):
        context, mover = mixing(frequency=1)
        mm.LocalEnergyMinimizer.minimize(context, tolerance=1e-3, maxIterations=20)
        assert mover.getStatistics(context)["attempts"] == 0


def octahedron() -> helfrich.Mesh:
    corners = 3 * np.concatenate([np.eye(3), -np.eye(3)])[[0, 3, 1, 4, 2, 5]]
    noise = np.random.default_rng(3).normal(0, 0.4, corners.shape)
    rows = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    return helfrich.Mesh(corners + noise, np.array(rows))


#: In its units, kJ/mol and nm.
KINDS = {
    1: {"rigidity": 1.0, "spontaneousCurvature": 0.0, "modulus": 0.0},
    2: {"rigidity": 2.5, "spontaneousCurvature": 0.3, "modulus": -1.5},
}


class TestDistribution:
    """Frozen vertices, whose arrangements are all enumerated."""

    def forces(self, mesh, which, domains):
        values = helfrich.values_of_domains(domains, KINDS)
        moduli = values.pop("modulus")
        forces = {
            "lines": helfrich.LineTensionForce(mesh, 1.0, domains),
            "bending": helfrich.BendingForce(mesh, **values),
            "moduli": helfrich.GaussianCurvatureForce(mesh, moduli),
        }
        return [forces[name] for name in which]

    def context(self, mesh, forces, target):
        system = mm.System()
        for _ in range(6):
            system.addParticle(0.0)
        for force in forces:
            system.addForce(force)
        context = target.context(system)
        context.setPositions(mesh.vertices)
        return context

    @pytest.mark.parametrize("target", [HELFRICH, REFERENCE], ids=str)
    @pytest.mark.parametrize(
        ("which", "energy", "removed"),
        [
            pytest.param(["lines"], 4.0, 0, id="lines"),
            pytest.param(["bending"], 2.0, 0, id="bending"),
            pytest.param(["moduli"], 1.0, 0, id="moduli"),
            pytest.param(["bending", "lines", "moduli"], 5.0, 0, id="all"),
            # Without two triangles four vertices are on the border.
            pytest.param(["lines"], 4.0, 2, id="lines-open"),
            pytest.param(["moduli"], 2.5, 2, id="moduli-open"),
            pytest.param(["bending", "lines", "moduli"], 5.0, 2, id="all-open"),
        ],
    )
    def test_is_boltzmanns(self, target, which, energy, removed):
        whole = octahedron()
        mesh = helfrich.Mesh(whole.vertices, whole.triangles[: 8 - removed])
        domains = np.array([1, 2, 1, 1, 2, 2])
        states = sorted(set(itertools.permutations(domains.tolist())))
        assert len(states) == 20

        def energy_of(state):
            return measure(self.context(mesh, self.forces(mesh, which, state), REFERENCE))[0]

        energies = np.array([energy_of(state) for state in states])
        weights = np.exp(-(energies - energies.min()) / energy)
        weights /= weights.sum()
        looks = 4000
        # Each is visited, and they differ.
        assert weights.min() * looks > 10
        assert weights.max() > 1.5 * weights.min()

        temperature = energy / 0.00831446261815324
        mover = helfrich.MonteCarloDomainSwap(mesh, temperature, 1, 5)
        mover.setRandomNumberSeed(11)
        forces = self.forces(mesh, which, domains)
        context = self.context(mesh, [*forces, mover], target)
        visits = dict.fromkeys(states, 0)
        for _ in range(looks):
            context.getIntegrator().step(1)
            visits[tuple(domains[mover.getPermutationInContext(context)].tolist())] += 1
        found = np.array([visits[state] for state in states])
        chi_squared = ((found - looks * weights) ** 2 / (looks * weights)).sum()
        # 19 degrees of freedom; beyond these lie 0.01 % each.
        assert 4.0 < chi_squared < 49.0

    def test_a_demon_keeps_the_energy(self):
        context, mover = mixing(integrator=mm.VerletIntegrator(0.1), mass=0.0, frequency=1)
        mover.setEnsemble("Microcanonical")
        mover.updateParametersInContext(context)
        # It does not ask for a temperature.
        context.setParameter(mover.Temperature(), -1)
        first, _ = measure(context)
        for _ in range(5):
            context.getIntegrator().step(4)
            demon = mover.getStatistics(context)["demonEnergy"]
            assert demon >= 0
            assert measure(context)[0] + demon == pytest.approx(first, rel=1e-12)
        assert mover.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("target", [HELFRICH, NATIVE[2]], ids=str)
    def test_a_demon_keeps_the_energy_of_a_sheet_that_spans_the_box(self, target):
        mesh = helfrich.Mesh.sheet(10, 10, 8.0, periodic=True)
        rough = mesh.vertices + np.random.default_rng(2).normal(0, 0.8, mesh.vertices.shape)
        domains = domains_of(mesh.num_vertices)
        mover = swap_of(mesh, frequency=1)
        mover.setEnsemble("Microcanonical")
        forces = self.forces_of_sheet(mesh, domains)
        for force in forces:
            force.setBackend(target.backend)
        system = mm.System()
        system.setDefaultPeriodicBoxVectors(*mesh.box)
        for _ in range(mesh.num_vertices):
            system.addParticle(0.0)
        for force in [*forces, mover]:
            system.addForce(force)
        context = target.context(system, mm.VerletIntegrator(0.1))
        # Positions are wrapped into the box, so that neighbours are images here and there.
        context.setPositions(rough % np.diag(mesh.box))
        first, _ = measure(context)
        context.getIntegrator().step(20)
        found = mover.getStatistics(context)
        assert found["accepted"] > 20
        assert measure(context)[0] + found["demonEnergy"] == pytest.approx(first, rel=1e-9)

    def forces_of_sheet(self, mesh, domains):
        values = helfrich.values_of_domains(domains, TABLE)
        moduli = values.pop("modulus")
        return [
            helfrich.BendingForce(mesh, **values),
            helfrich.LineTensionForce(mesh, 0.5, domains),
            helfrich.GaussianCurvatureForce(mesh, moduli),
        ]


class TestRules:
    def test_statistics_add_up(self):
        context, mover = mixing(frequency=1, attemptsPerEdge=2)
        context.getIntegrator().step(50)
        found = mover.getStatistics(context)
        assert found["attempts"] == 27000
        assert set(found["refused"]) == {"kind", "energy"}
        assert found["accepted"] + sum(found["refused"].values()) == found["attempts"]
        assert min(found["refused"].values()) > 1000
        assert found["acceptance"] == found["accepted"] / 27000
        assert found["time"] == pytest.approx(50 * 0.2, rel=1e-12)
        assert found["rate"] == pytest.approx(found["accepted"] / 270 / 10, rel=1e-12)
        assert found["demonEnergy"] == 0

    def test_nothing_to_exchange(self):
        mesh = start()
        mover = swap_of(mesh, frequency=1, attemptsPerEdge=3)
        context = REFERENCE.context(system_of(helfrich.BendingForce(mesh, 30), mover))
        context.setPositions(mesh.vertices)
        message = "MonteCarloDomainSwap: no force on these triangles has values of single vertices"
        with pytest.raises(mm.OpenMMException, match=message):
            context.getIntegrator().step(1)

    @pytest.mark.parametrize("what", ["one domain", "rigidity", "elsewhere"])
    def test_whoever_is_alike_stays(self, what):
        # Edges whose ends differ in anything of any force are tried, whatever its group.
        mesh = start()
        force = {
            "one domain": helfrich.LineTensionForce(mesh, 1, [5] * COUNT),
            "rigidity": helfrich.BendingForce(mesh, [30.0] * (COUNT - 1) + [31.0]),
            "elsewhere": helfrich.BendingForce(mesh, [30.0] * (COUNT - 1) + [31.0]),
        }[what]
        force.setForceGroup(3 if what == "elsewhere" else 0)
        mover = swap_of(mesh, frequency=1, attemptsPerEdge=3)
        integrator = mm.VerletIntegrator(0.1)
        integrator.setIntegrationForceGroups({0})
        context = REFERENCE.context(system_of(force, mover), integrator)
        context.setPositions(mesh.vertices)
        integrator.step(20)
        found = mover.getStatistics(context)
        tried = found["attempts"] - found["refused"]["kind"]
        if what == "one domain":
            assert tried == 0
        else:
            degree = np.count_nonzero(mesh.edges == COUNT - 1)
            assert tried == pytest.approx(found["attempts"] * degree / 270, rel=0.3)
        if what == "elsewhere":
            assert found["accepted"] == tried > 20

    def test_only_energies_of_the_integrators_groups_count(self):
        accepted = {}
        for groups in ({0}, {0, 1}):
            line = helfrich.LineTensionForce(start(), 1e4, domains_of(COUNT))
            line.setForceGroup(1)
            mover = swap_of(start(), frequency=1)
            integrator = mm.VerletIntegrator(1e-6)
            integrator.setIntegrationForceGroups(groups)
            context = REFERENCE.context(system_of(line, mover), integrator)
            context.setPositions(start().vertices)
            integrator.step(5)
            accepted[len(groups)] = mover.getStatistics(context)["accepted"]
        assert accepted[1] > 3 * accepted[2]

    def test_hot_and_cold(self):
        accepted = {}
        for temperature in (1.0, 1e6):
            context, mover = mixing(integrator=mm.VerletIntegrator(1e-6), frequency=1)
            assert context.getParameter("DomainSwapTemperature") == TEMPERATURE
            context.setParameter(mover.Temperature(), temperature)
            context.getIntegrator().step(5)
            accepted[temperature] = mover.getStatistics(context)["accepted"]
        assert accepted[1e6] > 1.5 * accepted[1.0]
        context.setParameter(mover.Temperature(), np.nan)
        with pytest.raises(
            mm.OpenMMException, match=r"^MonteCarloDomainSwap: .*DomainSwapTemperature.*above zero"
        ):
            context.getIntegrator().step(1)

    def test_the_platform_is_chosen_as_without(self):
        forces = forces_of(start(), domains_of(COUNT))
        context = mm.Context(system_of(swap_of(start()), *forces), langevin())
        assert context.getPlatform().getName() == "Helfrich"

    def test_new_rules_for_a_context(self):
        context, mover = mixing()
        mover.setAttemptsPerEdge(1)
        context.getIntegrator().step(4)
        assert mover.getStatistics(context)["attempts"] == 162
        mover.updateParametersInContext(context)
        context.getIntegrator().step(4)
        assert mover.getStatistics(context)["attempts"] == 162 + 540


class TestSameBits(SameBits):
    def made(self, target, integrator, seed):
        context, _ = mixing(target, integrator, seed=seed)
        return context

    def bits(self, context):
        found = bits(context)
        return found, found[3]

    def test_two_surfaces_go_their_own_ways(self):
        mesh, domains = start(), domains_of(COUNT)
        second = mesh.triangles + COUNT
        lines = [helfrich.LineTensionForce(corners, 0.1, domains) for corners in (mesh, second)]
        movers = [swap_of(mesh), helfrich.MonteCarloDomainSwap(second, TEMPERATURE, 2, 0.3)]
        for mover in movers:
            mover.setRandomNumberSeed(7)
        system = system_of(*lines, *movers)
        for _ in range(COUNT):
            system.addParticle(50.0)
        context = REFERENCE.context(system, mm.VerletIntegrator(1e-6))
        context.setPositions(np.concatenate([mesh.vertices, mesh.vertices + 500.0]))
        context.getIntegrator().step(20)
        one, other = (mover.getPermutationInContext(context) for mover in movers)
        assert (one != other).any()
        np.testing.assert_array_equal(lines[1].getDomainsInContext(context), domains[other])
        names = {name for name in context.getParameters() if name.startswith("DomainSwap")}
        assert names == {
            "DomainSwapTemperature",
            "DomainSwapPermutation0",
            f"DomainSwapPermutation{COUNT}",
        }


class TestPermutation:
    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    @pytest.mark.parametrize("has_mover", [True, False])
    def test_can_be_set(self, target, has_mover):
        forces = forces_of(start(), domains_of(COUNT), target.backend)
        forces += [swap_of(start())] if has_mover else []
        context = target.context(system_of(*forces), langevin())
        context.setPositions(start().vertices)
        before = measure(context)[0]
        random = np.random.default_rng(4)
        for force in (forces[0], forces[3], forces[-1]):
            other = random.permutation(COUNT)
            force.setPermutationInContext(context, other.tolist())
            for one in forces:
                np.testing.assert_array_equal(one.getPermutationInContext(context), other)
            assert_as_fresh(context, target, 1e-9)
            assert measure(context)[0] != before
            force.setPermutationInContext(context, np.arange(COUNT))
            assert measure(context)[0] == pytest.approx(before, rel=1e-12)
        context.getIntegrator().step(4)

    @pytest.mark.parametrize(
        ("given", "error", "words"),
        [
            (np.arange(COUNT - 1), mm.OpenMMException, "of 91 vertices, but there are 92"),
            (np.arange(COUNT) + 1, mm.OpenMMException, "has 92, but .* 0 to 91"),
            ([-1, *range(1, COUNT)], mm.OpenMMException, "has -1"),
            ([3, *range(1, COUNT)], mm.OpenMMException, "vertex 3 twice"),
            (np.arange(COUNT) * 1.0, TypeError, "permutation must be integers"),
            (np.arange(COUNT).reshape(2, -1), ValueError, "one list"),
        ],
    )
    def test_what_is_refused_changes_nothing(self, given, error, words):
        context, mover = mixing()
        context.getIntegrator().step(10)
        before = bits(context)
        with pytest.raises(error, match=rf"^MonteCarloDomainSwap: .*{words}"):
            mover.setPermutationInContext(context, given)
        assert bits(context) == before
        context.getIntegrator().step(2)

    def test_new_values_go_through_it(self):
        context, mover = mixing()
        context.getIntegrator().step(20)
        permutation = mover.getPermutationInContext(context)
        assert (permutation != np.arange(COUNT)).any()
        bending = force_in(context, helfrich.BendingForce)
        line = force_in(context, helfrich.LineTensionForce)
        # Values by the places of the vertices, so that no two have the same.
        rigidity = np.linspace(20.0, 40.0, COUNT)
        bending.setVertexRigidity(rigidity)
        line.setDomains(np.arange(COUNT) % 7)
        # Nothing has changed in the Context yet.
        np.testing.assert_array_equal(
            line.getDomainsInContext(context), domains_of(COUNT)[permutation]
        )
        bending.updateParametersInContext(context)
        line.updateParametersInContext(context)
        np.testing.assert_array_equal(line.getDomainsInContext(context), permutation % 7)
        np.testing.assert_array_equal(mover.getPermutationInContext(context), permutation)
        energy = measure(context)[0]
        forces = forces_of(start(), domains_of(COUNT)[permutation])
        forces[0].setVertexRigidity(rigidity[permutation])
        forces[1].setDomains(permutation % 7)
        fresh = REFERENCE.context(system_of(*forces))
        fresh.setPositions(context.getState(getPositions=True).getPositions(asNumpy=True))
        assert energy == pytest.approx(measure(fresh)[0], rel=1e-12)
        # Now all differ, and are tried.
        before = mover.getStatistics(context)["refused"]["kind"]
        context.getIntegrator().step(10)
        assert mover.getStatistics(context)["refused"]["kind"] == before

    def test_references_stay(self):
        context, mover = mixing(frequency=1)
        skalak = force_in(context, helfrich.SkalakForce)
        skalak.setForceGroup(5)
        system = system_of(skalak.__copy__(), mass=0.0)
        alone = REFERENCE.context(system)
        alone.setPositions(start().vertices)
        moved = start().vertices * [1.1, 1.0, 0.9]
        context.getIntegrator().step(20)
        assert mover.getStatistics(context)["accepted"] > 20
        context.reinitialize(preserveState=True)
        for one in (context, alone):
            one.setPositions(moved)
        assert measure(context, {5})[0] == pytest.approx(measure(alone)[0], rel=1e-12)


class TestRefused:
    def context(self, *forces):
        return REFERENCE.context(system_of(*forces))

    def test_two_movers_on_one_mesh(self):
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloDomainSwap: .*another"):
            self.context(swap_of(start()), helfrich.BendingForce(start(), 9), swap_of(start()))

    @pytest.mark.parametrize("turn", [1, -1], ids=["mover last", "mover first"])
    def test_other_triangles_of_the_same_particles(self, turn):
        shuffled = start().triangles[::-1]
        forces = [helfrich.BendingForce(shuffled, 50), swap_of(start())][::turn]
        with pytest.raises(
            mm.OpenMMException, match=r"particle \d+ .*MonteCarloDomainSwap.* same order"
        ) as caught:
            self.context(*forces)
        assert str(caught.value).startswith(type(forces[1]).__name__ + ": ")
        self.context(*forces_of(start(), domains_of(COUNT)), swap_of(start()))

    def test_forces_inside_of_others(self):
        energy = mm.CustomCVForce("2*bending")
        energy.addCollectiveVariable("bending", helfrich.BendingForce(start(), 50))
        with pytest.raises(
            mm.OpenMMException, match=r"^MonteCarloDomainSwap: .*BendingForce.*\"CustomCVForce\""
        ):
            self.context(energy, swap_of(start()))

    def test_beads_that_would_share_vertices(self):
        with pytest.raises(
            mm.OpenMMException, match=r"^MonteCarloDomainSwap: the beads of an RPMDIntegrator"
        ):
            REFERENCE.context(system_of(swap_of(start())), mm.RPMDIntegrator(2, 300, 1, 0.01))

    def test_parts_that_another_force_follows(self):
        mesh = start()
        second = mesh.triangles + COUNT
        both = np.concatenate([mesh.triangles, second])
        contact = helfrich.SurfaceRepulsionForce(both, 3.0, 1.0)
        lines = [helfrich.LineTensionForce(one, 0.1, domains_of(COUNT)) for one in (mesh, second)]
        mover = swap_of(mesh)
        system = system_of(*lines, contact, mover)
        for _ in range(COUNT):
            system.addParticle(50.0)
        context = REFERENCE.context(system, mm.VerletIntegrator(1e-6))
        context.setPositions(np.concatenate([mesh.vertices, mesh.vertices + 500.0]))
        context.getIntegrator().step(10)
        assert mover.getStatistics(context)["accepted"] > 20
        measure(context)
        with pytest.raises(mm.OpenMMException, match=r"^SurfaceRepulsionForce: .*set their perm"):
            contact.setPermutationInContext(context, np.arange(2 * COUNT))
        with pytest.raises(mm.OpenMMException, match=r"^SurfaceRepulsionForce: .*ask those"):
            contact.getPermutationInContext(context)
        # Of all of them, no single surface moves.
        whole = helfrich.MonteCarloDomainSwap(both, 300)
        for order in (
            [*lines, contact, whole],
            [whole, *lines],
            [contact, whole, *lines],
        ):
            system = system_of(*(force.__copy__() for force in order))
            for _ in range(COUNT):
                system.addParticle(50.0)
            with pytest.raises(mm.OpenMMException, match=r"particle \d+ .* same order"):
                REFERENCE.context(system)


class TestC:
    """The C functions, on forces and Contexts that Python holds."""

    def test_create_get_set(self):
        library = _core.library()
        library.Helfrich_MonteCarloDomainSwap_create.restype = ctypes.c_void_p
        library.Helfrich_MonteCarloDomainSwap_getAttemptsPerEdge.restype = ctypes.c_double
        corners = np.ascontiguousarray(start().triangles, dtype=np.intc)
        force = ctypes.c_void_p(
            library.Helfrich_MonteCarloDomainSwap_create(
                corners.ctypes.data_as(ctypes.c_void_p),
                len(corners),
                ctypes.c_double(300),
                5,
                ctypes.c_double(0.25),
            )
        )
        assert force.value
        assert library.Helfrich_MonteCarloDomainSwap_getFrequency(force) == 5
        assert library.Helfrich_MonteCarloDomainSwap_getAttemptsPerEdge(force) == 0.25
        assert library.Helfrich_MonteCarloDomainSwap_setEnsemble(force, 1) == 0
        assert library.Helfrich_MonteCarloDomainSwap_getEnsemble(force) == 1
        assert library.Helfrich_MonteCarloDomainSwap_setFrequency(force, -2) == 1
        assert _core.last_error().startswith("MonteCarloDomainSwap: frequency must be")
        assert library.Helfrich_MonteCarloBondFlip_getFrequency(force) == -1
        assert "of another class" in _core.last_error()
        library.Helfrich_MembraneForce_destroy(force)

    def test_in_a_context(self):
        library = _core.library()
        context, mover = mixing()
        context.getIntegrator().step(20)
        line = force_in(context, helfrich.LineTensionForce)

        def address(thing):
            return ctypes.c_void_p(int(thing.this))

        numbers = (ctypes.c_int * COUNT)()
        pair = address(mover), address(context)
        assert library.Helfrich_MembraneForce_getPermutationInContext(*pair, numbers) == 0
        permutation = mover.getPermutationInContext(context)
        assert list(numbers) == permutation.tolist()
        of_line = address(line), address(context)
        assert library.Helfrich_LineTensionForce_getDomainsInContext(*of_line, numbers) == 0
        assert list(numbers) == line.getDomainsInContext(context).tolist()
        assert library.Helfrich_LineTensionForce_getDomainsInContext(*pair, numbers) == 1
        backwards = (ctypes.c_int * COUNT)(*range(COUNT)[::-1])
        set_permutation = library.Helfrich_MembraneForce_setPermutationInContext
        assert set_permutation(*pair, backwards, COUNT) == 0
        assert mover.getPermutationInContext(context).tolist() == list(range(COUNT))[::-1]
        assert set_permutation(*pair, backwards, COUNT - 1) == 1
        assert "of 91 vertices" in _core.last_error()
        value = ctypes.c_double()
        get = library.Helfrich_MonteCarloDomainSwap_getStatistic
        assert get(*pair, b"accepted", ctypes.byref(value)) == 0
        assert value.value == mover.getStatistics(context)["accepted"]
        assert get(*pair, b"refusedByEdge", ctypes.byref(value)) == 1
        assert "refusedByKind" in _core.last_error()


def test_table_is_of_three():
    assert set(domains_of(COUNT).tolist()) == set(TABLE)
