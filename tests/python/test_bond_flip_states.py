"""Checkpoints, States and saved states of Contexts in which bonds flip."""

from __future__ import annotations

import io

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import (
    bits,
    flowing,
    forces_of,
    langevin,
    measure,
    mover_of,
    start,
    system_of,
)
from openmm import app
from platforms import CPU, HELFRICH, NATIVE, ON_OPENCL, REFERENCE, Target
from surface_movers import ForeignStates, step
from test_bond_flip import assert_as_fresh, custom_integrator

FOREIGN = "^MonteCarloBondFlip: .*BondFlipConnectivity0.*load_state"


class TestCheckpoints:
    """On platform Helfrich they hold all."""

    @pytest.mark.parametrize("threads", ["1", "2"])
    @pytest.mark.parametrize("anew", [True, False])
    def test_go_on_with_the_same_bits(self, threads, anew):
        target = Target("Helfrich", "Helfrich", 1e-9, {"Threads": threads})
        # Neither a whole number of rounds nor of attempts has been made at step 13.
        arguments = {"frequency": 3, "attemptsPerEdge": 0.2513, "seed": 0}
        context, mover = flowing(target, **arguments)
        checkpoint = step(context, 13).createCheckpoint()
        wanted = bits(step(context, 20)), mover.getStatistics(context)
        if anew:
            context, mover = flowing(target, **arguments)
        context.loadCheckpoint(checkpoint)
        assert (bits(step(context, 20)), mover.getStatistics(context)) == wanted
        assert wanted[1]["accepted"] > 20

    def test_hold_what_a_user_has_set(self):
        context = HELFRICH.context(system_of(*forces_of(start())), langevin())
        context.setPositions(start().vertices)
        bending = helfrich.BendingForce.cast(context.getSystem().getForce(0))
        plain = context.createCheckpoint()
        other, mover = flowing(seed=5)
        triangles = mover.getTrianglesInContext(step(other, 20))
        bending.setTrianglesInContext(context, triangles)
        changed = context.createCheckpoint()
        context.loadCheckpoint(plain)
        np.testing.assert_array_equal(bending.getTrianglesInContext(context), start().triangles)
        context.loadCheckpoint(changed)
        np.testing.assert_array_equal(bending.getTrianglesInContext(context), triangles)

    def test_without_flips_are_as_before(self):
        context = HELFRICH.context(system_of(*forces_of(start())), langevin())
        context.setPositions(start().vertices)
        checkpoint = context.createCheckpoint()
        assert b"HLF1" in checkpoint
        assert b"HLF2" not in checkpoint
        context, _ = flowing(HELFRICH)
        assert b"HLF2" in context.createCheckpoint()

    def test_that_are_damaged(self):
        context, _ = flowing(HELFRICH)
        checkpoint = step(context, 10).createCheckpoint()
        begin = checkpoint.index(b"HLC2")
        before = bits(context)[2]
        for place in (begin - 3, begin + 5, begin + 30, begin + 400, begin + 2500):
            broken = bytearray(checkpoint)
            broken[place] ^= 1
            with pytest.raises(mm.OpenMMException, match=r"^loadCheckpoint: .*damaged"):
                context.loadCheckpoint(bytes(broken))
            assert bits(context)[2] == before
        with pytest.raises(mm.OpenMMException, match=r"^loadCheckpoint: .*damaged"):
            context.loadCheckpoint(checkpoint[: begin + 100])

    def test_of_a_context_made_anew(self):
        context, mover = flowing(HELFRICH)
        before = bits(step(context, 10))
        context.reinitialize(preserveState=True)
        assert bits(context) == before
        step(context, 4)
        assert mover.getStatistics(context)["attempts"] == 7 * 81


class TestForeignStates(ForeignStates):
    foreign = FOREIGN

    def made(self, target):
        return flowing(target)

    def moved(self, context, mover):
        return mover.getTrianglesInContext(context)

    def put(self, context, mover, moved):
        mover.setTrianglesInContext(context, moved)

    def test_a_simulation_that_loads_its_own(self):
        context, _ = flowing()
        topology = start().topology()
        simulation = app.Simulation(topology, context.getSystem(), langevin(), REFERENCE_PLATFORM)
        simulation.context.setPositions(start().vertices)
        simulation.step(10)
        stream = io.BytesIO()
        simulation.saveCheckpoint(stream)
        simulation.step(10)
        stream.seek(0)
        simulation.loadCheckpoint(stream)
        with pytest.raises(mm.OpenMMException, match=FOREIGN):
            simulation.step(1)

    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH, ON_OPENCL[2], NATIVE[2]], ids=str)
    @pytest.mark.parametrize("writes", [True, False])
    def test_not_by_mistake_under_a_custom_integrator(self, target, writes):
        # It sets parameters back that change during its steps, on Reference always.
        integrator = custom_integrator()
        if writes:
            integrator.addComputeGlobal("BondFlipTemperature", "BondFlipTemperature+1")
        context, mover = flowing(target, integrator)
        for _ in range(5):
            step(context, 7)
            measure(context)
        assert mover.getStatistics(context)["accepted"] > 20
        assert_as_fresh(context, mover, target, 1e-9)
        wanted = 300 + 35 * writes
        assert context.getParameter("BondFlipTemperature") == wanted
        # States that come with an evaluation have the right fingerprint.
        state = context.getState(getPositions=True, getParameters=True, getEnergy=True)
        other, _ = flowing(target, custom_integrator())
        other.setState(state)
        with pytest.raises(mm.OpenMMException, match=FOREIGN):
            measure(other)


REFERENCE_PLATFORM = mm.Platform.getPlatformByName("Reference")


class TestSaved:
    @pytest.mark.parametrize("target", [REFERENCE, HELFRICH], ids=str)
    @pytest.mark.parametrize("anew", [True, False])
    def test_go_on_with_the_same_bits(self, target, anew, tmp_path):
        arguments = {"frequency": 3, "attemptsPerEdge": 0.2513, "seed": 0}
        context, mover = flowing(target, mm.VerletIntegrator(0.2), **arguments)
        step(context, 13)
        context.setParameter("BondFlipTemperature", 321.5)
        helfrich.save_state(context, tmp_path / "state")
        clock = context.getTime(), context.getStepCount()
        wanted = bits(step(context, 20)), mover.getStatistics(context)
        if anew:
            context, mover = flowing(target, mm.VerletIntegrator(0.2), **arguments)
        helfrich.load_state(context, str(tmp_path / "state"))
        assert (context.getTime(), context.getStepCount()) == clock
        assert context.getParameter("BondFlipTemperature") == 321.5
        assert (bits(step(context, 20)), mover.getStatistics(context)) == wanted

    def test_on_another_platform(self, tmp_path):
        context, _ = flowing(HELFRICH)
        step(context, 20)
        helfrich.save_state(context, tmp_path / "state")
        energy = measure(context)[0]
        for target in (REFERENCE, CPU, ON_OPENCL[2], NATIVE[2]):
            other, mover = flowing(target, seed=123)
            helfrich.load_state(step(other, 5), tmp_path / "state")
            assert measure(other)[0] == pytest.approx(energy, rel=1e-9)
            assert bits(other) == bits(context)
            assert_as_fresh(other, mover, target, 1e-9)
            step(other, 4)

    def test_of_systems_without_flips(self, tmp_path):
        system = system_of(*forces_of(start()))
        context = REFERENCE.context(system, langevin())
        context.setPositions(start().vertices)
        step(context, 5)
        before = bits(context)
        helfrich.save_state(context, tmp_path / "state")
        step(context, 5)
        helfrich.load_state(context, tmp_path / "state")
        assert bits(context) == before

    def test_box_vectors(self, tmp_path):
        context, _ = flowing()
        box = np.diag([300.0, 310.0, 320.0]) + np.tril(np.full((3, 3), 7.0), -1)
        context.setPeriodicBoxVectors(*box)
        helfrich.save_state(context, tmp_path / "state")
        context.setPeriodicBoxVectors(*np.eye(3))
        helfrich.load_state(context, tmp_path / "state")
        found = context.getState().getPeriodicBoxVectors(asNumpy=True)._value
        np.testing.assert_array_equal(found, box)

    def test_that_do_not_fit(self, tmp_path):
        context, _ = flowing()
        path = tmp_path / "state"
        helfrich.save_state(step(context, 10), path)
        data = path.read_bytes()

        bare = system_of(*forces_of(start()))
        cases = {"parameter BondFlip": REFERENCE.context(bare)}
        more = system_of(*forces_of(start()), mover_of(start()))
        more.addParticle(1.0)
        cases["92 particles, but the Context has 93"] = REFERENCE.context(more)
        apart = system_of(mover_of(start()))
        for _ in range(12):
            apart.addParticle(1.0)
        octahedron = helfrich.Mesh.icosphere(1, 5.0)
        apart.addForce(helfrich.BendingForce(octahedron, 5, offset=92))
        cases["92 particles, but the Context has 104"] = REFERENCE.context(apart)
        for words, other in cases.items():
            other.setPositions(np.zeros((other.getSystem().getNumParticles(), 3)))
            with pytest.raises(ValueError, match=rf"^load_state: .*state.*{words}"):
                helfrich.load_state(other, path)

        before = bits(step(context, 10))
        for place in (3, 30, 70, len(data) // 2, len(data) - 5):
            broken = bytearray(data)
            broken[place] ^= 0x20
            path.write_bytes(bytes(broken))
            with pytest.raises(ValueError, match=r"^load_state: .*state is damaged"):
                helfrich.load_state(context, path)
        path.write_bytes(data[:-1])
        with pytest.raises(ValueError, match=r"^load_state: .*state is damaged"):
            helfrich.load_state(context, path)
        with pytest.raises(FileNotFoundError):
            helfrich.load_state(context, tmp_path / "nothing")
        with pytest.raises(OSError, match=r"nowhere"):
            helfrich.save_state(context, tmp_path / "nowhere" / "state")
        assert bits(context) == before
        step(context, 2)

    def test_several_surfaces(self, tmp_path):
        mesh = start()
        second = mesh.triangles + mesh.num_vertices
        forces = [helfrich.BendingForce(mesh, 30), helfrich.BendingForce(second, 40)]
        movers = [mover_of(mesh), helfrich.MonteCarloBondFlip(second, 300, 1, 0.5)]
        system = system_of(*forces, *movers)
        for _ in range(mesh.num_vertices):
            system.addParticle(50)
        context = REFERENCE.context(system, mm.VerletIntegrator(0.1))
        context.setPositions(np.concatenate([mesh.vertices, mesh.vertices + 500.0]))
        step(context, 10)
        helfrich.save_state(context, tmp_path / "state")

        def connectivity():
            return [force.getTrianglesInContext(context).tolist() for force in forces]

        before = connectivity()
        step(context, 10)
        assert connectivity()[0] != before[0]
        assert connectivity()[1] != before[1]
        helfrich.load_state(context, tmp_path / "state")
        assert connectivity() == before
        step(context, 2)
