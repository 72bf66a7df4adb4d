"""Masses that follow plaquettes: the equations of motion, what they conserve and sample.

The Hamiltonian is computed here anew, from its definition and the potential energy of the Context.
"""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import forces_of, start
from openmm import unit
from openmmhelfrich import VariableMassLangevinIntegrator, VariableMassVerletIntegrator
from platforms import HELFRICH, REFERENCE

KT = 0.00831446261815324 * 300
#: amu/nm²; 0 keeps the mass of the surface.
DENSITIES = [0.0, 0.035]
PLATFORMS = [REFERENCE, HELFRICH]


def values(context, *what) -> list[np.ndarray]:
    state = context.getState(**dict.fromkeys(what, True))
    names = ["get" + name.capitalize() for name in what]
    return [
        np.array(getattr(state, name)(asNumpy=True).value_in_unit_system(unit.md_unit_system))
        for name in names
    ]


def energies(context) -> tuple[float, float]:
    state = context.getState(energy=True)
    both = state.getKineticEnergy(), state.getPotentialEnergy()
    return tuple(energy.value_in_unit(unit.kilojoule_per_mole) for energy in both)


def areas_of(positions, triangles, box=None) -> np.ndarray:
    """aᵢ of all particles, as the textbook has them."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    sides = [b - a, c - a]
    if box is not None:
        for side in sides:
            for axis in (2, 1, 0):
                side -= np.round(side[:, axis] / box[axis, axis])[:, None] * box[axis]
    areas = np.linalg.norm(np.cross(*sides), axis=1) / 2
    return np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), len(positions))


class Thing:
    """A System with a surface, two other particles and two vertices that do not move."""

    def __init__(self, density, platform=REFERENCE, integrator=None, step=0.05, forces=True):
        mesh = start()
        self.mesh, self.density = mesh, density
        self.count = mesh.num_vertices + 2
        self.constant = np.linspace(40.0, 60.0, self.count)
        self.constant[[7, 30]] = 0.0
        self.system = mm.System()
        for mass in self.constant:
            self.system.addParticle(mass)
        if forces:
            for force in forces_of(mesh):
                self.system.addForce(force)
        else:
            # It has no energy worth naming.
            self.system.addForce(helfrich.SurfaceAreaForce(mesh, 1e-12, mesh.area))
        others = mesh.vertices[3] * [[1.4], [1.5]]
        self.positions = np.concatenate([mesh.vertices, others])
        bond = mm.HarmonicBondForce()
        bond.addBond(3, self.count - 2, 0.38 * np.linalg.norm(others[0]) / 1.4, 2.0)
        bond.addBond(self.count - 2, self.count - 1, 9.0, 3.0)
        self.system.addForce(bond)
        self.integrator = integrator or VariableMassVerletIntegrator(step, density)
        self.context = platform.context(self.system, self.integrator)
        self.moving = self.constant > 0
        random = np.random.default_rng(4)
        self.context.setPositions(self.positions)
        velocities = random.normal(0, 0.5, (self.count, 3)) * self.moving[:, None]
        self.context.setVelocities(velocities)

    def masses(self, positions) -> np.ndarray:
        areas = areas_of(positions, self.mesh.triangles)
        vertices = self.mesh.num_vertices
        total = self.constant[:vertices].sum()
        masses = self.density * areas if self.density else total * areas / areas.sum()
        masses[vertices:] = self.constant[vertices:]
        return masses * self.moving

    def state(self) -> tuple[np.ndarray, np.ndarray]:
        """q and p."""
        positions, velocities = values(self.context, "positions", "velocities")
        return positions, self.masses(positions)[:, None] * velocities

    def set(self, positions, momenta) -> None:
        masses = self.masses(positions)
        self.context.setPositions(positions)
        velocities = np.divide(momenta, masses[:, None], where=self.moving[:, None])
        self.context.setVelocities(np.where(self.moving[:, None], velocities, 0.0))

    def hamiltonian(self, positions, momenta) -> float:
        """From the definition, but for the potential energy."""
        self.context.setPositions(positions)
        squares = (momenta**2).sum(axis=1)[self.moving]
        kinetic = (squares / (2 * self.masses(positions)[self.moving])).sum()
        return kinetic + energies(self.context)[1]


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("platform", PLATFORMS, ids=str)
def test_masses_and_kinetic_energies_are_those_of_the_definition(density, platform):
    thing = Thing(density, platform)
    thing.integrator.step(3)
    positions, velocities = values(thing.context, "positions", "velocities")
    masses = thing.masses(positions)
    assert thing.integrator.getMasses() == pytest.approx(masses, rel=1e-13)
    kinetic = 0.5 * (masses[:, None] * velocities**2).sum()
    assert energies(thing.context)[0] == pytest.approx(kinetic, rel=1e-13)
    assert (positions[[7, 30]] == thing.positions[[7, 30]]).all()
    assert not velocities[[7, 30]].any()


@pytest.mark.parametrize("density", DENSITIES)
def test_momenta_change_by_the_gradient_of_the_hamiltonian(density):
    """A short step and one back in time, against finite differences in every component."""
    thing = Thing(density)
    positions, momenta = thing.state()
    step = 1e-4
    ends = []
    thing.integrator.setStepSize(step)
    for sign in (1, -1):
        thing.set(positions, sign * momenta)
        thing.integrator.step(1)
        end = thing.state()
        ends.append((end[0], sign * end[1]))
    found = (ends[0][1] - ends[1][1]) / (2 * step)
    velocity = (ends[0][0] - ends[1][0]) / (2 * step)
    masses = thing.masses(positions)[:, None]
    expected = momenta[thing.moving] / masses[thing.moving]
    assert velocity[thing.moving] == pytest.approx(expected, abs=1e-7)

    expected = np.zeros_like(momenta)
    shift = 1e-4
    for index in np.ndindex(momenta.shape):
        if thing.moving[index[0]]:
            sides = []
            for sign in (1, -1):
                moved = positions.copy()
                moved[index] += sign * shift
                sides.append(thing.hamiltonian(moved, momenta))
            expected[index] = -(sides[0] - sides[1]) / (2 * shift)
    assert found == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    # The forces of the kinetic energy are a part that matters.
    thing.context.setPositions(positions)
    (forces,) = values(thing.context, "forces")
    assert np.abs(found - forces)[thing.moving].max() > 1e-3 * np.abs(expected).max()


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("platform", PLATFORMS, ids=str)
def test_steps_are_reversible_to_rounding(density, platform):
    thing = Thing(density, platform)
    before = values(thing.context, "positions", "velocities")
    thing.integrator.step(200)
    positions, velocities = values(thing.context, "positions", "velocities")
    assert np.abs(positions - before[0]).max() > 1
    thing.context.setVelocities(-velocities)
    thing.integrator.step(200)
    positions, velocities = values(thing.context, "positions", "velocities")
    assert positions == pytest.approx(before[0], abs=1e-9)
    assert velocities == pytest.approx(-before[1], abs=1e-9)


def test_halving_the_step_quarters_the_error_of_the_energy():
    errors = []
    for step in (0.2, 0.1, 0.05):
        thing = Thing(0.0, step=step)
        total = []
        for _ in range(40):
            thing.integrator.step(round(0.4 / step))
            total.append(sum(energies(thing.context)))
        errors.append(np.std(total))
    ratios = np.array(errors[:-1]) / errors[1:]
    assert ratios == pytest.approx(4.0, abs=0.25)


@pytest.mark.parametrize("density", DENSITIES)
def test_a_step_is_symplectic(density):
    """J^T Ω J = Ω for the Jacobian J of the map of (q, p), by differences of fourth order."""
    mesh = helfrich.Mesh.icosphere(1, 10.0)
    random = np.random.default_rng(2)
    positions = mesh.vertices + random.normal(0, 1.0, mesh.vertices.shape)
    system = mm.System()
    for _ in range(12):
        system.addParticle(10.0)
    system.addForce(helfrich.BendingForce(mesh, 20.0))
    system.addForce(helfrich.SurfaceAreaForce(mesh, 1.0, mesh.area))
    integrator = VariableMassVerletIntegrator(0.5, density)
    context = REFERENCE.context(system, integrator)

    def masses(q):
        areas = areas_of(q, mesh.triangles)
        return density * areas if density else 120.0 * areas / areas.sum()

    def step(state):
        q, p = state.reshape(2, 12, 3)
        context.setPositions(q)
        context.setVelocities(p / masses(q)[:, None])
        integrator.step(1)
        q, v = values(context, "positions", "velocities")
        return np.concatenate([q.ravel(), (masses(q)[:, None] * v).ravel()])

    momenta = random.normal(0, np.sqrt(10.0 * KT), (12, 3))
    state = np.concatenate([positions.ravel(), momenta.ravel()])
    columns = []
    for i in range(72):
        unit_vector = np.zeros(72)
        unit_vector[i] = 1e-2
        near, far = (step(state + k * unit_vector) - step(state - k * unit_vector) for k in (1, 2))
        columns.append((8 * near - far) / (12 * 1e-2))
    jacobian = np.array(columns).T
    omega = np.kron([[0, 1], [-1, 0]], np.eye(36))
    assert jacobian.T @ omega @ jacobian == pytest.approx(omega, abs=2e-7)
    # The same of a step that takes masses for constant fails: coupling matters.
    assert np.abs(jacobian[:36, :36] - np.eye(36)).max() > 1e-2


def test_momentum_and_angular_momentum_are_conserved():
    mesh = start()
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    for force in forces_of(mesh):
        system.addForce(force)
    integrator = VariableMassVerletIntegrator(0.2)
    context = HELFRICH.context(system, integrator)
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 5)

    def measure():
        q, v = values(context, "positions", "velocities")
        p = integrator.getMasses()[:, None] * v
        return p.sum(axis=0), np.cross(q, p).sum(axis=0)

    before = measure()
    integrator.step(1000)
    after = measure()
    assert after[0] == pytest.approx(before[0], abs=1e-9)
    assert after[1] == pytest.approx(before[1], abs=1e-7)


@pytest.mark.parametrize("density", DENSITIES)
def test_velocities_to_temperature_are_drawn_for_the_present_masses(density):
    mesh = helfrich.Mesh.random_sphere(1002, 1000, seed=2)
    system = mm.System()
    for mass in np.linspace(1.0, 200.0, 1002):
        system.addParticle(mass)
    system.addForce(helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area))
    integrator = VariableMassVerletIntegrator(0.1, density)
    context = HELFRICH.context(system, integrator)
    context.setPositions(mesh.vertices)
    squares = []
    for seed in range(1, 21):
        context.setVelocitiesToTemperature(300, seed)
        (velocities,) = values(context, "velocities")
        squares.append(integrator.getMasses()[:, None] * velocities**2 / KT)
    squares = np.array(squares)
    # Of n squares of normals the mean scatters by sqrt(2 / n).
    assert squares.mean() == pytest.approx(1.0, abs=4 * np.sqrt(2 / squares.size))
    by_vertex = squares.mean(axis=(0, 2))
    assert by_vertex.std() == pytest.approx(np.sqrt(2 / 60), rel=0.1)


class Patches:
    """Vertices that move within fixed rings of uneven shape, each with a spring to its place.

    Momenta of fixed vertices do not exist, so of a patch the integral over the one momentum leaves
    m(q)^(3/2) exp(−U(q) / kT) for the vertex that moves: m = ρ a, or M a / A with the area A of the
    whole patch, in which an outer ring of fixed vertices has a part.
    """

    CENTRE = np.array([0.0, 0.0, 0.0])
    STIFFNESS = np.array([0.35, 0.5, 0.25])
    MODULUS, TARGET = 0.02, 20.0

    def __init__(self):
        angles = np.array([0.1, 1.0, 2.3, 3.2, 4.1, 5.4])
        inner = np.stack([6 * np.cos(angles), 5 * np.sin(angles), 0.8 * np.sin(3 * angles)], axis=1)
        outer = np.stack([9 * np.cos(angles + 0.4), 8 * np.sin(angles + 0.4), 0 * angles], axis=1)
        self.vertices = np.concatenate([[self.CENTRE], inner, outer])
        ring = [(1 + k, 1 + (k + 1) % 6, 7 + k, 7 + (k + 1) % 6) for k in range(6)]
        fan = [(0, a, b) for a, b, _, _ in ring]
        rest = [t for a, b, c, d in ring for t in ((a, c, b), (b, c, d))]
        self.triangles = np.array(fan + rest)

    def energy(self, centres):
        """U of some places of the vertex that moves, kJ/mol."""
        return 0.5 * (self.STIFFNESS * (centres - self.CENTRE) ** 2).sum(axis=-1) + (
            0.5 * self.MODULUS * (self.areas(centres) - self.TARGET) ** 2 / self.TARGET
        ).sum(axis=-1)

    def areas(self, centres):
        """Of the six triangles around the vertex that moves."""
        a, b = (self.vertices[self.triangles[:6, k]] for k in (1, 2))
        sides = a - centres[..., None, :], b - centres[..., None, :]
        return np.linalg.norm(np.cross(*sides), axis=-1) / 2

    def share(self, centres):
        """a / A."""
        rest = areas_of(self.vertices, self.triangles[6:]).sum()
        around = self.areas(centres).sum(axis=-1)
        return around / 3 / (around + rest)

    def expectations(self, power):
        """Of x, y², z² and the share, with the weight (a / A or a)^power exp(−U / kT)."""
        axes = [np.linspace(-5.2, 5.2, 27) * np.sqrt(KT / k) for k in self.STIFFNESS]
        centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        weight = np.exp(-self.energy(centres) / KT) * power(centres)
        return (observables(self, centres) * weight[..., None]).sum(axis=(0, 1, 2)) / weight.sum()


def observables(patches, centres):
    x, y, z = np.moveaxis(centres, -1, 0)
    return np.stack([x, y, x**2, y**2, z**2, patches.share(centres)], axis=-1)


@pytest.mark.parametrize("density", [0.0, 2.0])
def test_langevin_samples_the_exact_distribution_of_a_vertex_in_a_fixed_ring(density):
    patches, copies = Patches(), 60
    size = len(patches.vertices)
    system = mm.System()
    springs = mm.CustomExternalForce("(kx*x^2 + ky*y^2 + kz*(z-z0)^2)/2")
    for name, value in zip(("kx", "ky", "kz"), patches.STIFFNESS, strict=True):
        springs.addGlobalParameter(name, value)
    springs.addPerParticleParameter("z0")
    triangles, positions = [], []
    for copy in range(copies):
        for i in range(size):
            system.addParticle(30.0 if i == 0 else 0.0)
        # Apart along z, so that nothing but the springs knows where they are.
        springs.addParticle(copy * size, [100.0 * copy])
        triangles.append(patches.triangles + copy * size)
        positions.append(np.add(patches.vertices, (0, 0, 100.0 * copy)))
    system.addForce(springs)
    system.addForce(
        helfrich.TriangleAreaForce(np.concatenate(triangles), patches.MODULUS, patches.TARGET)
    )
    integrator = VariableMassLangevinIntegrator(300, 0.5, 0.3, density)
    integrator.setRandomNumberSeed(8)
    context = HELFRICH.context(system, integrator)
    context.setPositions(np.concatenate(positions))
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(300)
    moving = size * np.arange(copies)
    sums, kinetic = [], []
    for _ in range(2000):
        integrator.step(12)
        q, v = values(context, "positions", "velocities")
        centres = q[moving] - [0, 0, 1] * (100.0 * np.arange(copies))[:, None]
        sums.append(observables(patches, centres))
        kinetic.append(integrator.getMasses()[moving] * (v[moving] ** 2).sum(axis=1) / KT)
    # Copies are independent of each other, whatever the correlation in time.
    by_copy = np.mean(sums, axis=0)
    found, errors = by_copy.mean(axis=0), by_copy.std(axis=0, ddof=1) / np.sqrt(copies)
    area = (lambda c: patches.areas(c).sum(axis=-1)) if density else patches.share
    expected = patches.expectations(lambda centres: area(centres) ** 1.5)
    deviations = (found - expected) / errors
    assert np.abs(deviations).max() < 4, deviations
    # Without the momenta's weight the distribution is another one, as these errors can tell.
    without = patches.expectations(lambda centres: 1.0)
    assert np.abs((found - without) / errors).max() > 8
    temperature = np.mean(kinetic) / 3
    assert temperature == pytest.approx(1.0, abs=0.01)
