"""MonteCarloBondFlip in a Context: who drives it, what evaluations see, and what is refused."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import (
    TEMPERATURE,
    bits,
    flowing,
    forces_of,
    langevin,
    measure,
    mover_of,
    start,
    system_of,
)
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

EVERYWHERE = [*ON_PROCESSOR, *ON_OPENCL, *ON_GPU, *NATIVE]


def custom_integrator() -> mm.CustomIntegrator:
    """Verlet in velocity form, which has forces twice a step."""
    integrator = mm.CustomIntegrator(0.2)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    integrator.addComputePerDof("x", "x+dt*v")
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    return integrator


def compound_integrator() -> mm.CompoundIntegrator:
    integrator = mm.CompoundIntegrator()
    integrator.addIntegrator(mm.VerletIntegrator(0.2))
    integrator.addIntegrator(langevin())
    integrator.setCurrentIntegrator(1)
    return integrator


INTEGRATORS = {
    "Verlet": lambda: mm.VerletIntegrator(0.2),
    "LangevinMiddle": langevin,
    "Langevin": lambda: mm.LangevinIntegrator(TEMPERATURE, 0.01, 0.2),
    "Brownian": lambda: mm.BrownianIntegrator(TEMPERATURE, 10.0, 0.01),
    "NoseHoover": lambda: mm.NoseHooverIntegrator(TEMPERATURE, 0.01, 0.2),
    "Custom": custom_integrator,
    "Compound": compound_integrator,
}


#: With every platform; each Context on OpenCL takes a second, so there only two kinds make do.
driven = pytest.mark.parametrize(
    ("name", "target"),
    [
        pytest.param(
            name,
            target,
            id=f"{target}-{name}",
            marks=[pytest.mark.long]
            if is_slow and name not in ("Verlet", "LangevinMiddle")
            else [],
        )
        for target, is_slow in (
            (REFERENCE, False),
            (HELFRICH, False),
            (ON_OPENCL[2], True),
            (NATIVE[2], True),
        )
        for name in INTEGRATORS
    ],
)


def degrees(triangles: np.ndarray) -> np.ndarray:
    return np.bincount(triangles.ravel(), minlength=start().num_vertices)


def assert_as_fresh(context, force, target: Target, tolerance: float) -> None:
    """Energy and forces are those of a Context that was made with the present triangles."""
    present = force.getTrianglesInContext(context)
    forces = forces_of(start(), present)
    for one in forces:
        one.setBackend(target.backend)
    fresh = target.context(system_of(*forces))
    fresh.setPositions(context.getState(getPositions=True).getPositions(asNumpy=True))
    energy, f = measure(context)
    wanted, g = measure(fresh)
    assert energy == pytest.approx(wanted, rel=tolerance)
    assert np.abs(f - g).max() <= tolerance * np.abs(g).max()


class TestDriven:
    @driven
    def test_by_every_integrator(self, name, target):
        context, mover = flowing(target, INTEGRATORS[name]())
        context.getIntegrator().step(20)
        # Ten rounds of 0.3 × 270 edges, which is 81.
        statistics = mover.getStatistics(context)
        assert statistics["attempts"] == 810
        assert statistics["accepted"] > 20
        before = start().triangles
        assert (mover.getTrianglesInContext(context) != before).any()
        assert_as_fresh(context, mover, target, 1e-9)

    @pytest.mark.parametrize("target", sparing(EVERYWHERE))
    def test_evaluations_see_the_present_triangles(self, target):
        context, mover = flowing(target)
        for _ in range(3):
            context.getIntegrator().step(8)
            assert_as_fresh(context, mover, target, max(target.tolerance, 1e-9))
        assert mover.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("target", [CPU, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    @pytest.mark.parametrize(
        "make",
        [
            lambda: mm.VerletIntegrator(0.2),
            lambda: mm.LangevinMiddleIntegrator(TEMPERATURE, 0, 0.2),
            lambda: mm.NoseHooverIntegrator(TEMPERATURE, 0.01, 0.2),
        ],
        ids=["Verlet", "LangevinMiddle", "NoseHoover"],
    )
    def test_alike_on_all_platforms(self, target, make):
        # A force from before a flip would soon be seen.
        found = []
        for one in (REFERENCE, target):
            context, mover = flowing(one, make())
            velocities = np.random.default_rng(2).normal(0, 0.2, start().vertices.shape)
            context.setVelocities(velocities)
            context.getIntegrator().step(30)
            assert mover.getStatistics(context)["accepted"] > 20
            found.append(context.getState(getPositions=True).getPositions(asNumpy=True)._value)
        assert np.abs(found[0] - start().vertices).max() > 0.5
        np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-6)

    def test_not_where_the_state_is_not_updated(self):
        integrator = mm.CustomIntegrator(0.2)
        integrator.addComputePerDof("x", "x+dt*v")
        context, mover = flowing(integrator=integrator)
        integrator.step(20)
        assert mover.getStatistics(context)["attempts"] == 0

    def test_never_at_frequency_zero(self):
        context, mover = flowing(frequency=0)
        context.getIntegrator().step(20)
        assert mover.getStatistics(context)["attempts"] == 0
        np.testing.assert_array_equal(mover.getTrianglesInContext(context), start().triangles)

    @pytest.mark.parametrize("frequency", [1, 3, 10])
    def test_every_so_many_steps(self, frequency):
        context, mover = flowing(frequency=frequency)
        for step in range(1, 21):
            context.getIntegrator().step(1)
            assert mover.getStatistics(context)["attempts"] == step // frequency * 81

    @pytest.mark.parametrize("share", [0.0011, 0.005, 1 / 3, 1.7])
    def test_fractions_of_attempts_are_carried(self, share):
        context, mover = flowing(frequency=1, attemptsPerEdge=share)
        for step in range(1, 30):
            context.getIntegrator().step(1)
            assert mover.getStatistics(context)["attempts"] == int(np.floor(step * (share * 270)))

    def test_not_by_the_minimizer(self):
        context, mover = flowing(frequency=1)
        before, _ = measure(context)
        mm.LocalEnergyMinimizer.minimize(context, tolerance=1e-3, maxIterations=20)
        assert measure(context)[0] < before
        assert mover.getStatistics(context)["attempts"] == 0
        np.testing.assert_array_equal(mover.getTrianglesInContext(context), start().triangles)

    def test_particles_without_mass_keep_their_places_but_not_their_bonds(self):
        mover = mover_of(start(), frequency=1)
        system = system_of(*forces_of(start()), mover, mass=0.0)
        context = REFERENCE.context(system, langevin())
        context.setPositions(start().vertices)
        context.getIntegrator().step(10)
        positions = context.getState(getPositions=True).getPositions(asNumpy=True)._value
        np.testing.assert_array_equal(positions, start().vertices)
        assert mover.getStatistics(context)["accepted"] > 20
        assert_as_fresh(context, mover, REFERENCE, 1e-9)


class TestRules:
    def test_statistics_add_up(self):
        edges = start().vertices[start().edges]
        longest = 1.9 * np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1).mean()
        context, mover = flowing(
            frequency=1, attemptsPerEdge=2, maxDegree=7, maxEdgeLength=float(longest)
        )
        context.getIntegrator().step(50)
        found = mover.getStatistics(context)
        assert found["attempts"] == 27000
        assert found["accepted"] + sum(found["refused"].values()) == found["attempts"]
        assert set(found["refused"]) == {
            "border",
            "degree",
            "length",
            "shape",
            "energy",
            "edge",
        }
        for reason in ("degree", "length", "energy"):
            assert found["refused"][reason] > 100
        assert found["acceptance"] == found["accepted"] / 27000
        assert found["time"] == pytest.approx(50 * 0.2, rel=1e-12)
        assert found["rate"] == pytest.approx(found["accepted"] / 270 / 10, rel=1e-12)
        assert found["demonEnergy"] == 0

    def test_without_flips_there_are_no_ratios(self):
        context, mover = flowing()
        found = mover.getStatistics(context)
        assert np.isnan(found["acceptance"])
        assert np.isnan(found["rate"])

    def test_time_is_what_was_simulated(self):
        context, mover = flowing()
        context.getIntegrator().step(5)
        context.setTime(0)
        context.setStepCount(0)
        context.getIntegrator().step(5)
        # The step before the jump is the one that nobody saw end.
        assert mover.getStatistics(context)["time"] == pytest.approx(9 * 0.2, rel=1e-12)

    def test_degrees_stay_between_the_bounds(self):
        low, high = degrees(start().triangles).min(), degrees(start().triangles).max()
        context, mover = flowing(frequency=1, minDegree=int(low), maxDegree=int(high))
        context.getIntegrator().step(50)
        present = degrees(mover.getTrianglesInContext(context))
        assert mover.getStatistics(context)["accepted"] > 20
        assert present.min() >= low
        assert present.max() <= high

    def test_only_energies_of_the_integrators_groups_count(self):
        # An enormous rigidity forbids every flip that bends, unless its group is left out.
        accepted = {}
        for groups in ({0}, {0, 1}):
            stiff = helfrich.BendingForce(start(), 1e6)
            stiff.setForceGroup(1)
            mover = mover_of(start(), frequency=1)
            integrator = mm.VerletIntegrator(1e-6)
            integrator.setIntegrationForceGroups(groups)
            soft = helfrich.SurfaceAreaForce(start(), 1e-3, start().area)
            context = REFERENCE.context(system_of(soft, stiff, mover), integrator)
            context.setPositions(start().vertices)
            integrator.step(5)
            accepted[len(groups)] = mover.getStatistics(context)["accepted"]
        assert accepted[1] > 3 * accepted[2]

    def test_energies_of_groups_are_as_without(self):
        mover = mover_of(start())
        forces = [*forces_of(start()), mover]
        for number, force in enumerate(forces):
            force.setForceGroup(number)
        context = REFERENCE.context(system_of(*forces), langevin())
        context.setPositions(start().vertices)
        context.getIntegrator().step(10)
        assert mover.getStatistics(context)["accepted"] > 20
        whole, _ = measure(context)
        parts = [measure(context, {number})[0] for number in range(len(forces))]
        assert sum(parts) == pytest.approx(whole, rel=1e-12)
        assert parts[-1] == 0
        assert not measure(context, {len(forces) - 1})[1].any()

    def test_the_platform_is_chosen_as_without(self):
        context = mm.Context(system_of(mover_of(start()), *forces_of(start())), langevin())
        assert context.getPlatform().getName() == "Helfrich"

    def test_hot_and_cold(self):
        accepted = {}
        for temperature in (1.0, 1e6):
            context, mover = flowing(integrator=mm.VerletIntegrator(1e-6), frequency=1)
            assert context.getParameter(mover.Temperature()) == TEMPERATURE
            context.setParameter(mover.Temperature(), temperature)
            context.getIntegrator().step(5)
            accepted[temperature] = mover.getStatistics(context)["accepted"]
        assert accepted[1e6] > 3 * accepted[1.0]

    def test_a_demon_keeps_the_energy(self):
        mover = mover_of(start(), frequency=1)
        mover.setEnsemble(mover.Microcanonical)
        system = system_of(*forces_of(start()), mover, mass=0.0)
        context = REFERENCE.context(system, mm.VerletIntegrator(0.1))
        context.setPositions(start().vertices)
        # It does not ask for a temperature.
        context.setParameter(mover.Temperature(), -1)
        first, _ = measure(context)
        for _ in range(5):
            context.getIntegrator().step(4)
            demon = mover.getStatistics(context)["demonEnergy"]
            assert demon >= 0
            assert measure(context)[0] + demon == pytest.approx(first, rel=1e-9)
        assert mover.getStatistics(context)["accepted"] > 20

    @pytest.mark.parametrize("value", [0.0, -300.0, np.nan, np.inf])
    def test_a_context_temperature_that_makes_no_sense(self, value):
        context, mover = flowing()
        context.setParameter(mover.Temperature(), value)
        with pytest.raises(
            mm.OpenMMException, match=r"^MonteCarloBondFlip: .*BondFlipTemperature.*above zero"
        ):
            context.getIntegrator().step(4)

    def test_new_rules_for_a_context(self):
        context, mover = flowing()
        mover.setFrequency(0)
        mover.setAttemptsPerEdge(1)
        context.getIntegrator().step(4)
        assert mover.getStatistics(context)["attempts"] == 162
        mover.updateParametersInContext(context)
        context.getIntegrator().step(4)
        assert mover.getStatistics(context)["attempts"] == 162
        mover.setFrequency(4)
        mover.updateParametersInContext(context)
        context.getIntegrator().step(4)
        assert mover.getStatistics(context)["attempts"] == 162 + 270
        mover.setMaxDegree(4)
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*maxDegree = 4"):
            mover.updateParametersInContext(context)


class TestSameBits(SameBits):
    def made(self, target, integrator, seed):
        context, _ = flowing(target, integrator, seed=seed)
        return context

    def bits(self, context):
        found = bits(context)
        return found, found[2]

    def test_two_movers_of_one_seed_flip_different_edges(self):
        mesh = start()
        count = mesh.num_vertices
        second = mesh.triangles + count
        system = system_of(*forces_of(mesh), *forces_of(mesh, second))
        for _ in range(count):
            system.addParticle(50.0)
        movers = [mover_of(mesh), helfrich.MonteCarloBondFlip(second, TEMPERATURE, 2, 0.3)]
        for mover in movers:
            mover.setRandomNumberSeed(7)
            system.addForce(mover)
        context = REFERENCE.context(system, mm.VerletIntegrator(1e-6))
        context.setPositions(np.concatenate([mesh.vertices, mesh.vertices + 500.0]))
        context.getIntegrator().step(20)
        one, other = (mover.getTrianglesInContext(context) for mover in movers)
        assert movers[0].getStatistics(context)["accepted"] > 20
        assert (one != other - count).any()
        names = {name for name in context.getParameters() if name.startswith("BondFlip")}
        assert names == {
            "BondFlipTemperature",
            "BondFlipConnectivity0",
            f"BondFlipConnectivity{count}",
        }


class TestRefused:
    def context(self, *forces):
        return REFERENCE.context(system_of(*forces))

    def test_two_movers_on_one_mesh(self):
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*another"):
            self.context(mover_of(start()), *forces_of(start()), mover_of(start()))

    @pytest.mark.parametrize("turn", [1, -1], ids=["mover last", "mover first"])
    def test_other_triangles_of_the_same_particles(self, turn):
        shuffled = start().triangles[::-1]
        forces = [helfrich.BendingForce(shuffled, 50), mover_of(start())][::turn]
        with pytest.raises(
            mm.OpenMMException,
            match=r"Force|Flip: particle \d+ .* same triangles in the same order",
        ) as caught:
            self.context(*forces)
        assert str(caught.value).startswith(type(forces[1]).__name__ + ": ")
        # Nothing is left behind that would disturb the next one.
        self.context(*forces_of(start()), mover_of(start()))

    def test_other_triangles_without_a_mover_are_allowed(self):
        shuffled = start().triangles[::-1]
        self.context(helfrich.BendingForce(shuffled, 50), helfrich.DihedralForce(start(), 1))

    @pytest.mark.parametrize("turn", [1, -1], ids=["mover last", "mover first"])
    def test_forces_inside_of_others(self, turn):
        energy = mm.CustomCVForce("2*bending")
        energy.addCollectiveVariable("bending", helfrich.BendingForce(start(), 50))
        with pytest.raises(
            mm.OpenMMException, match=r"^MonteCarloBondFlip: .*BendingForce.*\"CustomCVForce\""
        ):
            self.context(*[energy, mover_of(start())][::turn])
        again = mm.CustomCVForce("2*bending")
        again.addCollectiveVariable("bending", helfrich.BendingForce(start(), 50))
        self.context(again)

    def test_bounds_that_the_mesh_violates(self):
        most = int(degrees(start().triangles).max())
        for arguments, word in (
            ({"maxDegree": most - 1}, f"maxDegree = {most - 1}"),
            ({"minDegree": 6}, "minDegree = 6"),
        ):
            with pytest.raises(mm.OpenMMException, match=rf"^MonteCarloBondFlip: .*{word}"):
                self.context(*forces_of(start()), mover_of(start(), **arguments))
        self.context(*forces_of(start()), mover_of(start(), maxDegree=most))

    def test_triangles_that_are_no_surface(self):
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: "):
            self.context(helfrich.MonteCarloBondFlip(start().triangles[:-1, [0, 0, 1]], 300))
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: "):
            self.context(helfrich.MonteCarloBondFlip([], 300))

    @pytest.mark.parametrize("first", [True, False])
    def test_any_order_of_forces(self, first):
        forces, mover = forces_of(start()), mover_of(start())
        order = [mover, *forces] if first else [*forces[:2], mover, *forces[2:]]
        context = REFERENCE.context(system_of(*order), mm.VerletIntegrator(0.2))
        context.setPositions(start().vertices)
        context.getIntegrator().step(20)
        assert mover.getStatistics(context)["accepted"] > 20
        assert_as_fresh(context, mover, REFERENCE, 1e-9)
        # All share one connectivity.
        found = [force.getTrianglesInContext(context) for force in order]
        for one in found[1:]:
            np.testing.assert_array_equal(one, found[0])


class TestConnectivity:
    def other(self) -> np.ndarray:
        context, mover = flowing(seed=99)
        context.getIntegrator().step(20)
        return mover.getTrianglesInContext(context)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2]], ids=str)
    @pytest.mark.parametrize("has_mover", [True, False])
    def test_can_be_set(self, target, has_mover):
        forces = forces_of(start()) + ([mover_of(start())] if has_mover else [])
        context = target.context(system_of(*forces), langevin())
        context.setPositions(start().vertices)
        before = measure(context)[0]
        other = self.other()
        for force in (forces[0], forces[-1]):
            force.setTrianglesInContext(context, other.tolist())
            for one in forces:
                np.testing.assert_array_equal(one.getTrianglesInContext(context), other)
            assert_as_fresh(context, force, target, 1e-9)
            assert measure(context)[0] != before
            force.setTrianglesInContext(context, start())
            assert measure(context)[0] == pytest.approx(before, rel=1e-12)
        context.getIntegrator().step(4)

    def test_what_is_refused_changes_nothing(self):
        context, mover = flowing(maxDegree=8)
        context.getIntegrator().step(4)
        before = bits(context)
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: has 180 triangles"):
            mover.setTrianglesInContext(context, start().triangles[1:])
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*index 92"):
            mover.setTrianglesInContext(context, start().triangles, offset=1)
        with pytest.raises(TypeError, match=r"^MonteCarloBondFlip: "):
            mover.setTrianglesInContext(context, start().triangles * 1.0)
        spiky = REFERENCE.context(
            system_of(wild := mover_of(start(), frequency=1, maxDegree=20)),
            mm.VerletIntegrator(0.1),
        )
        spiky.setPositions(start().vertices)
        spiky.getIntegrator().step(200)
        triangles = wild.getTrianglesInContext(spiky)
        assert degrees(triangles).max() > 8
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*maxDegree = 8"):
            mover.setTrianglesInContext(context, triangles)
        assert bits(context) == before
        context.getIntegrator().step(4)

    def test_a_mesh_of_the_present_state(self):
        context, mover = flowing()
        context.getIntegrator().step(20)
        positions = context.getState(getPositions=True).getPositions(asNumpy=True)._value
        bending = helfrich.BendingForce.cast(context.getSystem().getForce(0))
        for force in (mover, bending):
            mesh = helfrich.Mesh.from_context(context, force)
            np.testing.assert_array_equal(mesh.vertices, positions)
            np.testing.assert_array_equal(mesh.triangles, mover.getTrianglesInContext(context))

    def test_a_mesh_of_particles_among_others(self):
        octahedron = helfrich.Mesh.icosphere(1, 5.0)
        force = helfrich.BendingForce(octahedron, 10, offset=3)
        system = mm.System()
        for _ in range(20):
            system.addParticle(1)
        system.addForce(force)
        context = REFERENCE.context(system)
        positions = np.zeros((20, 3))
        positions[3:15] = octahedron.vertices
        context.setPositions(positions)
        assert helfrich.Mesh.from_context(context, force) == octahedron

    def test_of_another_context(self):
        _, mover = flowing()
        other, _ = flowing()
        with pytest.raises(mm.OpenMMException):
            mover.getTrianglesInContext(other)

    def test_parameters_can_still_be_updated(self):
        context, mover = flowing()
        context.getIntegrator().step(10)
        bending = helfrich.BendingForce.cast(context.getSystem().getForce(0))
        before = measure(context)[0]
        bending.setVertexRigidity([1.0] * start().num_vertices)
        bending.updateParametersInContext(context)
        assert measure(context)[0] < before
        context.getIntegrator().step(2)
        assert mover.getStatistics(context)["attempts"] == 6 * 81
