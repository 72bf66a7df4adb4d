"""What a SurfaceViscosityThermostat does: conservation, the ensemble, and the viscosity."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import TEMPERATURE, forces_of, langevin, mover_of, start
from platforms import CPU, HELFRICH, NATIVE, ON_OPENCL, REFERENCE, Target
from viscous import (
    KT,
    mean_and_error,
    motion,
    thermostat_of,
    velocity_verlet,
    viscous,
)

#: Corners and triangles of an octahedron.
CORNERS = np.array(
    [[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0], [0, 0, 1.0], [0, 0, -1.0]]
)
OCTAHEDRON = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)


def edges_of(triangles) -> np.ndarray:
    """Each pair of neighbours once, shape (num_edges, 2)."""
    sides = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0)


def springs(integrator, friction: float, stiffness: float = 20_000.0) -> mm.Context:
    """An octahedron of springs, not at rest."""
    system = mm.System()
    for _ in CORNERS:
        system.addParticle(50.0)
    bonds = mm.HarmonicBondForce()
    for i, j in edges_of(OCTAHEDRON).tolist():
        bonds.addBond(i, j, 2**0.5, stiffness)
    system.addForce(bonds)
    system.addForce(thermostat_of(OCTAHEDRON, friction))
    context = REFERENCE.context(system, integrator)
    context.setPositions(CORNERS + np.random.default_rng(2).normal(0, 0.01, CORNERS.shape))
    return context


class TestConservation:
    """Of momentum and angular momentum about the origin, to rounding."""

    def momenta(self, context, masses) -> np.ndarray:
        positions, velocities = motion(context)
        each = masses[:, None] * velocities
        return np.concatenate([each.sum(axis=0), np.cross(positions, each).sum(axis=0)])

    @pytest.mark.parametrize("frequency", [1, 3])
    @pytest.mark.parametrize("friction", [1.0, 1000.0])
    def test_of_a_vesicle(self, friction, frequency):
        masses = np.linspace(20.0, 80.0, start().num_vertices)
        # Its velocities pass a step as they are; Verlet's go through differences of positions.
        passing = mm.LangevinMiddleIntegrator(TEMPERATURE, 0, 0.2)
        context, _ = viscous(
            friction=friction, frequency=frequency, masses=masses, forces=[], integrator=passing
        )
        context.setVelocitiesToTemperature(TEMPERATURE, 3)
        before, velocities = self.momenta(context, masses), motion(context)[1]
        context.getIntegrator().step(300)
        after = self.momenta(context, masses)
        assert abs(motion(context)[1] - velocities).max() > 0.1
        # Σ m |v| is 2000 amu nm/ps, and the radius 100 nm.
        np.testing.assert_allclose(after[:3], before[:3], rtol=0, atol=1e-11)
        np.testing.assert_allclose(after[3:], before[3:], rtol=0, atol=1e-9)

    def test_of_a_disk_that_crosses_faces_of_the_box(self):
        """With forces, which conserve them less exactly."""
        box = np.array([[60.0, 0, 0], [10, 55, 0], [-5, 8, 50]])
        mesh = helfrich.Mesh.disk(3, 12)
        mesh = helfrich.Mesh(mesh.vertices, mesh.triangles, box)
        vesicle = helfrich.Vesicle(
            mesh, volume_modulus=0, viscosity={"friction": 30.0, "randomNumberSeed": 5}
        )
        context = vesicle.simulation(mm.VerletIntegrator(0.01), "Reference").context
        context.setVelocitiesToTemperature(TEMPERATURE, 3)
        masses = np.full(mesh.num_vertices, 50.0)
        before, (_, start_velocities) = self.momenta(context, masses), motion(context)
        context.getIntegrator().step(200)
        after, (_, velocities) = self.momenta(context, masses), motion(context)
        np.testing.assert_allclose(after, before, rtol=0, atol=1e-9)
        assert abs(velocities - start_velocities).max() > 0.1


class TestEnsemble:
    """Temperatures and configurations are those of the bath, each within four standard errors."""

    def temperatures(self, context, moving: np.ndarray, freedom: int, samples: int) -> np.ndarray:
        """Twice the kinetic energy for each degree of freedom, over kT."""
        masses = np.array(
            [context.getSystem().getParticleMass(i)._value for i in np.flatnonzero(moving)]
        )
        found = np.empty(samples)
        context.getIntegrator().step(1000)
        for sample in range(samples):
            context.getIntegrator().step(10)
            velocities = motion(context)[1][moving]
            found[sample] = (masses[:, None] * velocities**2).sum() / (freedom * KT)
        return found

    def test_alone_it_keeps_the_temperature(self):
        """From rest: the six rigid motions stay where they are. Masses differ."""
        masses = np.linspace(20.0, 80.0, start().num_vertices)
        context, _ = viscous(friction=100.0, masses=masses)
        everything = np.full(start().num_vertices, True)
        found = self.temperatures(context, everything, 3 * len(masses) - 6, 2000)
        mean, error = mean_and_error(found)
        assert error < 0.005
        assert abs(mean - 1) < 4 * error

    def test_beside_langevin(self):
        context, _ = viscous(friction=100.0, integrator=langevin())
        everything = np.full(start().num_vertices, True)
        found = self.temperatures(context, everything, 3 * start().num_vertices, 2000)
        mean, error = mean_and_error(found)
        assert error < 0.005
        assert abs(mean - 1) < 4 * error

    def test_with_vertices_that_are_pinned(self):
        masses = np.full(start().num_vertices, 50.0)
        masses[::7] = 0
        context, _ = viscous(friction=100.0, masses=masses)
        found = self.temperatures(context, masses > 0, 3 * np.count_nonzero(masses), 2000)
        mean, error = mean_and_error(found)
        assert error < 0.005
        assert abs(mean - 1) < 4 * error
        pinned = motion(context)[0][::7]
        np.testing.assert_array_equal(pinned, start().vertices[::7])

    @pytest.mark.parametrize(
        ("integrator", "friction"),
        [
            (mm.VerletIntegrator(0.01), 5000.0),
            (mm.VerletIntegrator(0.01), 100.0),
            (mm.LangevinMiddleIntegrator(TEMPERATURE, 0.1, 0.01), 5000.0),
            (mm.NoseHooverIntegrator(TEMPERATURE, 1.0, 0.01), 5000.0),
            (mm.VariableVerletIntegrator(1e-4), 5000.0),
            (velocity_verlet(0.01), 5000.0),
        ],
        ids=["Verlet", "Verlet-weak", "LangevinMiddle", "NoseHoover", "VariableVerlet", "Custom"],
    )
    def test_springs_are_neither_cold_nor_hot(self, integrator, friction):
        """Where velocities are of half a step ago, friction on these at the present positions
        would make them a third too cold at γ Δt = m: 6 kT are 12 quadratic terms."""
        context = springs(integrator, friction)
        integrator.step(500)
        found = np.empty(2500)
        for sample in range(len(found)):
            integrator.step(20)
            found[sample] = context.getState(energy=True).getPotentialEnergy()._value
        mean, error = mean_and_error(found / (6 * KT))
        assert error < 0.02
        # The last 2 %, (ω Δt)²/4 of the stiffest, are velocity Verlet's own.
        assert abs(mean - 1) < 4 * error + (
            0.02 if isinstance(integrator, mm.CustomIntegrator) else 0
        )

    def test_configurations_are_those_without_it(self):
        """Energy and volume of soft springs, which are far from harmonic, and their squares."""
        found = []
        for friction in (0.0, 100.0):
            integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 1.0, 0.05)
            integrator.setRandomNumberSeed(5)
            context = springs(integrator, friction, stiffness=200.0)
            integrator.step(1000)
            samples = np.empty((4000, 2))
            for sample in samples:
                integrator.step(20)
                sample[0] = context.getState(energy=True).getPotentialEnergy()._value
                sides = motion(context)[0][OCTAHEDRON]
                sample[1] = np.linalg.det(sides).sum() / 6
            found.append(samples)
        for column in range(2):
            for power in (1, 2):
                (mean, error), (other, other_error) = (
                    mean_and_error(samples[:, column] ** power) for samples in found
                )
                assert error < 0.02 * mean
                assert abs(mean - other) < 4 * np.hypot(error, other_error)


class TestViscosity:
    """Plane waves on a periodic sheet decay as those of a fluid sheet do.

    With ρ the mass per area, a shear wave of the wave vector q decays at the rate η q²/ρ and a
    longitudinal one at (η + ζ) q²/ρ. Of a net of springs k the moduli are √3/4 k and √3/2 k; so of
    a net of frictions γ they are η = √3/4 γ and ζ = 2 η.
    """

    A, MASS = 10.0, 50.0

    def rate(self, cells, direction, *, friction=20.0, step=0.01, steps=400, **arguments) -> float:
        """How fast a wave of velocities along x, one in the box, decays, 1/ps. `cells` along x."""
        mesh = helfrich.Mesh.sheet(cells, 6, self.A, periodic=True)
        system = mm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(self.MASS)
        system.setDefaultPeriodicBoxVectors(*mesh.box)
        # No force has these triangles: the System says that there is a box.
        system.addForce(mm.CustomVolumeForce("0"))
        system.addForce(thermostat_of(mesh, friction, temperature=1e-30, **arguments))
        context = REFERENCE.context(system, mm.VerletIntegrator(step))
        context.setPositions(mesh.vertices)
        phase = 2 * np.pi * mesh.vertices[:, 0] / mesh.box[0, 0]
        # So slow that vertices stay where they are.
        wave = 1e-4 * np.sin(phase)[:, None] * np.eye(3)[direction]
        context.setVelocities(wave)
        context.getIntegrator().step(steps)
        left = (motion(context)[1] * wave).sum() / (wave**2).sum()
        return -np.log(left) / (steps * step)

    @pytest.mark.parametrize(("direction", "factor"), [(1, 1), (0, 3), (2, 0)])
    def test_waves_decay(self, direction, factor):
        """Shear, longitudinal, and normal to the sheet, where nothing is damped."""
        friction, cells = 20.0, 40
        viscosity = 3**0.5 / 4 * friction
        density = self.MASS / (3**0.5 / 2 * self.A**2)
        wave_number = 2 * np.pi / (cells * self.A)
        expected = factor * viscosity * wave_number**2 / density
        # A wave of 40 cells is 0.1 % slower on the net, and 0.2 % for lengths.
        assert self.rate(cells, direction) == pytest.approx(expected, rel=2.5e-3, abs=1e-12)

    @pytest.mark.parametrize("cells", [6, 12])
    def test_short_waves_decay_as_the_net_says(self, cells):
        x = 2 * np.pi / cells
        unit = 20.0 / self.MASS
        shear = 3 * unit * (1 - np.cos(x / 2))
        lengthwise = unit * (2 * (1 - np.cos(x)) + (1 - np.cos(x / 2)))
        assert self.rate(cells, 1) == pytest.approx(shear, rel=1e-4)
        assert self.rate(cells, 0) == pytest.approx(lengthwise, rel=1e-4)

    @pytest.mark.parametrize(("frequency", "friction"), [(5, 20.0), (1, 40.0), (7, 10.0)])
    def test_scales_with_friction_and_not_with_frequency(self, frequency, friction):
        """With up to 0.02 m for γ times the time from one sweep to the next."""
        one = self.rate(12, 1, steps=420)
        other = self.rate(12, 1, steps=420, friction=friction, frequency=frequency)
        assert other / one == pytest.approx(friction / 20, rel=1e-3)

    def test_the_error_is_of_second_order(self):
        """Sweeps forwards and backwards in turn: 0.8 (γ Δt / m)² is missing."""
        exact = self.rate(12, 1, step=0.001, steps=2000)
        missing = [1 - self.rate(12, 1, step=step, steps=8) / exact for step in (0.25, 0.5)]
        assert missing[0] == pytest.approx(0.8 * 0.1**2, rel=0.1)
        assert missing[1] / missing[0] == pytest.approx(4, rel=0.1)

    def test_a_vesicle_gets_the_viscosity_that_is_asked_for(self):
        vesicle = helfrich.Vesicle(start(), viscosity=10.0)
        vesicle.system()
        assert vesicle.placement.viscosity.getDefaultFriction() == pytest.approx(40 / 3**0.5)


class TestPresentTriangles:
    def test_a_new_context_of_them_goes_on_alike(self):
        """Edges come in an order that depends on the present triangles, not on their history."""
        flips = mover_of(start())
        context, thermostat = viscous(flips)
        context.setVelocitiesToTemperature(TEMPERATURE, 3)
        context.getIntegrator().step(40)
        triangles = flips.getTrianglesInContext(context)
        assert not np.array_equal(triangles, start().triangles)
        positions, velocities = motion(context)
        fresh = thermostat_of(triangles, seed=8)
        system = mm.System()
        for _ in positions:
            system.addParticle(50.0)
        for force in [*forces_of(start(), triangles), fresh]:
            system.addForce(force)
        other = REFERENCE.context(system, mm.VerletIntegrator(0.2))
        fresh._restoreState(other, thermostat._saveState(context))
        other.setPositions(positions)
        other.setVelocities(velocities)
        flips.setFrequency(0)
        flips.updateParametersInContext(context)
        for one in (context, other):
            one.getIntegrator().step(1)
        # Sums of forces are formed in another order.
        for now, then in zip(motion(context), motion(other), strict=True):
            np.testing.assert_allclose(now, then, rtol=0, atol=1e-9)

    def test_friction_is_along_them(self):
        """Without noise a strong one leaves no ends of edges that move against each other."""
        mesh = start()
        mover = mover_of(mesh)
        context, thermostat = viscous(mover, friction=1e6, temperature=1e-9)
        context.getIntegrator().step(40)
        now = mover.getTrianglesInContext(context)
        context.setParameter(thermostat.Friction(), 0.0)
        context.setVelocitiesToTemperature(TEMPERATURE, 3)
        assert self.largest_stretching(context, now) > 0.5
        context.setParameter(thermostat.Friction(), 1e4)
        # Many sweeps of γ Δt ≪ m at nearly the same positions, which stop all but rigid motions.
        context.getIntegrator().setStepSize(1e-5)
        context.getIntegrator().step(6000)
        new = {tuple(edge) for edge in edges_of(now).tolist()}
        old = {tuple(edge) for edge in edges_of(mesh.triangles).tolist()}
        assert len(new - old) > 20
        assert self.largest_stretching(context, now) < 0.05

    def largest_stretching(self, context, triangles) -> float:
        positions, velocities = motion(context)
        i, j = edges_of(triangles).T
        along = positions[i] - positions[j]
        along /= np.linalg.norm(along, axis=1)[:, None]
        return abs(((velocities[i] - velocities[j]) * along).sum(axis=1)).max()

    def test_of_several_membranes_that_flip_by_themselves(self):
        """One thermostat on the triangles of all, one after the other."""
        one = start()
        count = one.num_vertices
        triangles = [one.triangles, one.triangles + count]
        system = mm.System()
        for _ in range(2 * count):
            system.addParticle(50.0)
        movers = []
        both = thermostat_of(np.vstack(triangles))
        system.addForce(both)
        for corners in triangles:
            for force in forces_of(one, corners):
                system.addForce(force)
            movers.append(helfrich.MonteCarloBondFlip(corners, TEMPERATURE, 2, 0.5))
            movers[-1].setRandomNumberSeed(len(movers))
            system.addForce(movers[-1])
        context = REFERENCE.context(system, langevin())
        context.setPositions(np.vstack([one.vertices, one.translated((400, 0, 0)).vertices]))
        context.getIntegrator().step(41)
        now = [mover.getTrianglesInContext(context) for mover in movers]
        assert all(mover.getStatistics(context)["accepted"] > 20 for mover in movers)
        np.testing.assert_array_equal(both.getTrianglesInContext(context), np.vstack(now))


OTHERS = [CPU, HELFRICH, *ON_OPENCL, *NATIVE]


@pytest.mark.parametrize("target", OTHERS, ids=str)
@pytest.mark.parametrize("periodic", [False, True])
def test_on_every_platform(target: Target, periodic: bool):
    """The same seed gives the same motion, in the precision of the platform."""
    found = []
    for one in (REFERENCE, target):
        mesh = start()
        if periodic:
            mesh = helfrich.Mesh.sheet(8, 8, 20, periodic=True)
        forces = [
            helfrich.BendingForce(mesh, 40.0),
            helfrich.SurfaceAreaForce(mesh, 0.5, mesh.area),
        ]
        system = mm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(50.0)
        if periodic:
            system.setDefaultPeriodicBoxVectors(*mesh.box)
        for force in [*forces, thermostat_of(mesh)]:
            system.addForce(force)
        for force in forces:
            force.setBackend(one.backend)
        context = one.context(system, mm.VerletIntegrator(0.2))
        context.setPositions(mesh.vertices)
        context.getIntegrator().step(5)
        found.append(motion(context))
    for reference, other in zip(*found, strict=True):
        scale = abs(reference).max()
        tolerance = 3e-4 if target.properties.get("Precision") in ("single", "mixed") else 1e-10
        np.testing.assert_allclose(other, reference, rtol=0, atol=tolerance * scale)


def test_the_same_bits_on_any_number_of_threads():
    found = []
    for threads in ("1", "2"):
        target = Target("Helfrich", "Helfrich", 0, {"Threads": threads})
        context, _ = viscous(mover_of(start()), target=target, integrator=langevin())
        context.getIntegrator().step(60)
        found.append([array.tobytes() for array in motion(context)])
    assert found[0] == found[1]
