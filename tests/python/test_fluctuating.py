"""Fluctuating spheres, and the hardening of a mesh in a run."""

import numpy as np
import openmm
import pytest
from openmm import unit
from openmmhelfrich import Mesh, MeshError, Vesicle, harden


def edge_lengths(mesh):
    start, end = mesh.vertices[mesh.edges.T]
    return np.linalg.norm(start - end, axis=1)


class TestFluctuating:
    def test_is_an_irregular_sphere_of_the_same_triangles(self):
        still = Mesh.random_sphere(252, 300, seed=2).translated((50, -20, 10))
        mesh = still.fluctuating(0.15, seed=1)
        assert np.array_equal(mesh.triangles, still.triangles)
        centre = still.vertices.mean(axis=0)
        distance = np.linalg.norm(mesh.vertices - centre, axis=1)
        assert np.ptp(distance) < 1e-9
        assert distance.mean() == pytest.approx(300, rel=1e-2)
        # Thermal motion spreads the lengths of edges by a factor of several.
        spread = [edge_lengths(each).std() / edge_lengths(each).mean() for each in (still, mesh)]
        assert spread[0] < 0.1
        assert 0.2 < spread[1] < 0.5

    def test_softer_is_more_irregular(self):
        still = Mesh.icosphere(5, 1000)
        spreads = [edge_lengths(still.fluctuating(s)).std() for s in (0.59, 0.15, 0.037)]
        assert spreads == sorted(spreads)
        assert spreads[2] > 2 * spreads[0]

    def test_seeds(self):
        still = Mesh.icosphere(2, 10)
        assert still.fluctuating(0.15, seed=3) == still.fluctuating(0.15, seed=3)
        assert still.fluctuating(0.15, seed=3) != still.fluctuating(0.15, seed=4)

    def test_no_time_changes_nothing(self):
        still = Mesh.icosphere(3, 10)
        same = still.fluctuating(0.15, duration=0)
        np.testing.assert_allclose(same.vertices, still.vertices, atol=1e-12)

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ({"softness": 0}, "softness"),
            ({"softness": -1}, "softness"),
            ({"softness": 0.1, "seed": -1}, "seed"),
            ({"softness": 0.1, "duration": float("nan")}, "duration"),
        ],
    )
    def test_refuses(self, arguments, message):
        with pytest.raises(MeshError, match=f"Mesh.fluctuating: {message}"):
            Mesh.icosphere(2, 10).fluctuating(**arguments)

    def test_refuses_what_is_no_sphere(self):
        with pytest.raises(MeshError, match=r"sphere, but vertex \d+ is"):
            Mesh.icosphere(3, 10).oblate(0.8).fluctuating(0.1)

    def test_says_when_it_folds(self):
        with pytest.raises(MeshError, match="larger softness or a shorter duration"):
            Mesh.icosphere(20, 1000).fluctuating(0.005, duration=20)


class TestHarden:
    @staticmethod
    def simulation(parameter=None):
        mesh = Mesh.icosphere(4, 1000)
        vesicle = Vesicle(mesh, softness=0.037)
        system = vesicle.system()
        force = vesicle.placement.heights
        if parameter:
            force.setContextParameter("minHeight", parameter)
        integrator = openmm.LangevinMiddleIntegrator(300, 0.01, 0.2)
        integrator.setRandomNumberSeed(1)
        platform = openmm.Platform.getPlatformByName("Reference")
        simulation = openmm.app.Simulation(mesh.topology(), system, integrator, platform)
        simulation.context.setPositions(mesh.vertices)
        return mesh, simulation, force

    @staticmethod
    def heights_energy(simulation, force):
        state = simulation.context.getState(energy=True, groups={force.getForceGroup()})
        return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)

    @pytest.mark.parametrize("parameter", [None, "d"])
    def test_ends_at_the_target(self, parameter):
        mesh, simulation, force = self.simulation(parameter)
        target = mesh.min_height(0.7)
        assert self.heights_energy(simulation, force) == 0
        harden(simulation, force, target, steps=25, increments=10)
        assert simulation.currentStep == 25
        state = simulation.context.getState(positions=True)
        now = Mesh(state.getPositions(asNumpy=True), mesh.triangles)
        expected = now.energy(type(force)(now, target, force.getEpsilon()))
        assert expected > 1
        assert self.heights_energy(simulation, force) == pytest.approx(expected, rel=1e-12)

    def test_goes_there_in_steps(self):
        _, simulation, force = self.simulation("d")
        seen = []

        class Reporter:
            def describeNextReport(self, simulation):
                return {"steps": 1, "periodic": False, "include": []}

            def report(self, simulation, state):
                seen.append(simulation.context.getParameter("d"))

        simulation.reporters.append(Reporter())
        start = force.getMinHeight()
        harden(simulation, force, 2 * start, steps=4, increments=4)
        np.testing.assert_allclose(np.array(seen) / start, [1.25, 1.5, 1.75, 2], rtol=1e-12)

    @pytest.mark.parametrize(
        ("arguments", "error", "message"),
        [
            ({"min_height": -1}, ValueError, "min_height"),
            ({"steps": 0}, ValueError, "steps"),
            ({"steps": np.nan}, ValueError, "steps needs a whole number of 1 or more, got nan"),
            ({"increments": 1.5}, ValueError, "increments"),
            ({"force": 5}, TypeError, "force needs a TriangleHeightForce, got int"),
        ],
    )
    def test_refuses(self, arguments, error, message):
        _, simulation, force = self.simulation()
        with pytest.raises(error, match=f"harden: {message}"):
            harden(simulation, **{"force": force, "min_height": 1, "steps": 5, **arguments})
