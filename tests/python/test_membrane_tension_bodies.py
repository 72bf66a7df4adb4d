"""What MonteCarloMembraneTension scales: vertices one by one, and molecules by their centres."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from platforms import CPU, HELFRICH, ON_OPENCL, REFERENCE
from tense import KT, TEMPERATURE, box_of, mover_of, of_box, positions_of, system_of, tense

#: Corners of a surface between two planes, n x n vertices.
SIZE = 6


def sheet(size: int = SIZE, spacing: float = 1.5, first: int = 0):
    """A wavy sheet that spans a slanted box along x and y: triangles, positions and box."""
    number = first + np.arange(size**2).reshape(size, size)
    right, up = np.roll(number, -1, 0), np.roll(number, -1, 1)
    both = np.roll(right, -1, 1)
    triangles = np.concatenate(
        [np.stack([number, right, both], -1), np.stack([number, both, up], -1)]
    ).reshape(-1, 3)
    edge = size * spacing
    box = np.array([[edge, 0, 0], [-0.5 * edge, 0.86 * edge, 0], [0, 0, 2 * edge]])
    grid = np.stack(np.meshgrid(range(size), range(size), indexing="ij"), -1).reshape(-1, 2)
    positions = (grid / size) @ box[:2] + [0, 0, edge]
    positions += np.random.default_rng(2).normal(0, 0.05 * spacing, positions.shape)
    return triangles, positions, box


def forces_of(triangles, periodic: bool = True) -> list[mm.Force]:
    forces = [
        helfrich.BendingForce(triangles, 20.0),
        helfrich.SurfaceAreaForce(triangles, 10.0, 70.0),
    ]
    for force in forces:
        force.setUsesPeriodicBoundaryConditions(periodic)
    return forces


def scaled_once(context: mm.Context) -> np.ndarray:
    """Step until a move has been accepted; the factors by which the box has changed."""
    before = box_of(context)
    for _ in range(50):
        context.getIntegrator().step(1)
        if (box_of(context) != before).any():
            break
    factors = np.diag(box_of(context)) / np.diag(before)
    assert abs(factors[0] - 1) > 1e-4
    return factors


def test_molecules_move_by_their_centres():
    """A pair, a particle, one of mass 0, a constrained pair and a virtual site in their midst."""
    positions = np.random.default_rng(5).uniform(1, 4, (7, 3))
    bond = mm.HarmonicBondForce()
    bond.addBond(0, 1, 1, 0)
    mover = mover_of(tension=-1.0)
    system = system_of(bond, of_box(), mover, count=7)
    system.setParticleMass(3, 0)
    system.addConstraint(4, 5, np.linalg.norm(positions[4] - positions[5]))
    system.setParticleMass(6, 0)
    system.setVirtualSite(6, mm.TwoParticleAverageSite(4, 5, 0.25, 0.75))
    context = REFERENCE.context(system)
    context.setPositions(positions)
    context.computeVirtualSites()
    positions = positions_of(context)
    expected = positions * (factors := scaled_once(context))
    for pair in ([0, 1], [4, 5]):
        shift = (factors - 1) * positions[pair].mean(axis=0)
        expected[pair] = positions[pair] + shift
    expected[6] = 0.25 * expected[4] + 0.75 * expected[5]
    np.testing.assert_allclose(positions_of(context), expected, rtol=1e-9)
    # The one of mass 0 is not counted, nor is the virtual site.
    assert mover.getStatistics(context)["bodies"] == 3


def test_every_particle_where_molecules_are_not_rigid():
    positions = np.random.default_rng(5).uniform(1, 4, (4, 3))
    bond = mm.HarmonicBondForce()
    bond.addBond(0, 1, 1, 0)
    mover = mover_of(tension=-1.0, rigid=False)
    context = tense(bond, of_box(), mover, positions=positions)
    factors = scaled_once(context)
    np.testing.assert_allclose(positions_of(context), positions * factors, rtol=1e-12)
    assert mover.getStatistics(context)["bodies"] == 4


@pytest.mark.parametrize("periodic", [True, False])
def test_membranes_by_vertices_if_they_are_in_the_box(periodic, lumpy):
    """And a molecule that hangs on a vertex by its own centre."""
    tail = mm.HarmonicBondForce()
    tail.addBond(0, 42, 1, 0)
    tail.addBond(42, 43, 1, 0)
    positions = np.concatenate([lumpy.vertices, [[5.0, 5, 5], [6.0, 5, 5]]])
    mover = mover_of(tension=0.0)
    forces = forces_of(lumpy.triangles, periodic)
    for force in forces:
        # Whether it is accepted is not the question.
        force.setForceGroup(1)
    integrator = mm.VerletIntegrator(1e-9)
    integrator.setIntegrationForceGroups({0})
    box = np.diag([30.0, 30.0, 30.0])
    context = tense(
        *forces, tail, of_box(), mover, positions=positions, box=box, integrator=integrator
    )
    factors = scaled_once(context)
    expected = positions * factors
    groups = [[42, 43]] if periodic else [list(range(44))]
    for group in groups:
        expected[group] = positions[group] + (factors - 1) * positions[group].mean(axis=0)
    np.testing.assert_allclose(positions_of(context), expected, rtol=1e-9)
    assert mover.getStatistics(context)["bodies"] == (43 if periodic else 1)


def test_a_membrane_in_a_force_of_variables():
    triangles, positions, box = sheet()
    bending = forces_of(triangles)[0]
    outer = mm.CustomCVForce("0*bending")
    outer.addCollectiveVariable("bending", bending)
    mover = mover_of()
    context = tense(outer, mover, positions=positions, box=box)
    factors = scaled_once(context)
    np.testing.assert_allclose(positions_of(context), positions * factors, rtol=1e-6)
    assert mover.getStatistics(context)["bodies"] == SIZE**2


class TestSheets:
    @pytest.mark.parametrize("target", [REFERENCE, CPU, HELFRICH, ON_OPENCL[2]], ids=str)
    def test_are_accepted_by_their_energy(self, target):
        """One move of a given seed, decided again here with the energy of a box that is scaled."""
        triangles, positions, box = sheet()
        tension = 3.0
        found = []
        seeds = range(1, 5) if target.platform == "OpenCL" else range(1, 13)
        for seed in seeds:
            mover = mover_of(seed=seed, tension=tension, adaptive=0)
            integrator = mm.VerletIntegrator(1e-9)
            context = tense(
                *forces_of(triangles),
                mover,
                target=target,
                positions=positions,
                box=box,
                integrator=integrator,
            )
            integrator.step(1)
            found.append(box_of(context)[0, 0] != box[0, 0])
        assert found == [accept(seed, triangles, positions, box, tension) for seed in seeds]
        assert 0 < sum(found) < len(found)

    def test_wrapped_or_not(self):
        """Positions in other images of the box give the same boxes."""
        triangles, positions, box = sheet()
        shifts = np.random.default_rng(3).integers(-2, 3, positions.shape) @ box
        boxes = []
        for start in (positions, positions + shifts):
            context = tense(*forces_of(triangles), mover_of(tension=1.0), positions=start, box=box)
            context.getIntegrator().step(30)
            boxes.append(box_of(context))
        assert boxes[0][0, 0] != box[0, 0]
        np.testing.assert_allclose(*boxes, rtol=1e-9)

    @pytest.mark.parametrize("flows", [False, True])
    def test_pay_for_the_area_of_their_frame(self, flows):
        """On average N kT / A_p + tau = dE/dA_p, which is what makes the mean derivative zero."""
        triangles, positions, box = sheet()
        tension = 2.0
        integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 2.0, 0.01)
        integrator.setRandomNumberSeed(5)
        forces = springy(triangles)
        mover = mover_of(tension=tension, frequency=4)
        movers = [mover]
        if flows:
            flips = helfrich.MonteCarloBondFlip(triangles, TEMPERATURE, 5, 0.2, maxEdgeLength=3.0)
            flips.setRandomNumberSeed(2)
            movers.append(flips)
        context = tense(*forces, *movers, positions=positions, box=box, integrator=integrator)
        others = springy(triangles)
        twin = tense(*others, positions=positions, box=box)
        integrator.step(5000)
        residues = []
        for _ in range(3000):
            integrator.step(50)
            now, frame = positions_of(context), box_of(context)
            others[0].setTrianglesInContext(twin, forces[0].getTrianglesInContext(context))
            area = frame[0, 0] * frame[1, 1]
            energies = [energy_of(twin, now, frame, ratio) for ratio in (1 - 1e-5, 1 + 1e-5)]
            slope = (energies[1] - energies[0]) / (2e-5 * area)
            residues.append(SIZE**2 * KT / area + tension - slope)
        blocks = np.reshape(residues, (20, -1)).mean(axis=1)
        error = blocks.std(ddof=1) / np.sqrt(20)
        assert error < 0.05
        assert abs(np.mean(residues)) < 3 * error
        assert mover.getStatistics(context)["bodies"] == SIZE**2


def springy(triangles) -> list[mm.Force]:
    """Of a sheet that keeps its shape, also while bonds flip."""
    forces = [
        helfrich.BendingForce(triangles, 50.0),
        helfrich.TriangleAreaForce(triangles, 60.0, 0.97),
        helfrich.TriangleHeightForce(triangles, 0.6, 10.0),
    ]
    for force in forces:
        force.setUsesPeriodicBoundaryConditions(True)
    return forces


def energy_of(context, positions, box, ratio: float) -> float:
    """Of the box with another area of x and y, and all positions in it."""
    factors = np.array([np.sqrt(ratio), np.sqrt(ratio), 1])
    context.setPeriodicBoxVectors(*(box * factors))
    context.setPositions(positions * factors)
    energy = context.getState(getEnergy=True).getPotentialEnergy()
    return energy.value_in_unit(unit.kilojoule_per_mole)


def accept(seed: int, triangles, positions, box, tension: float) -> bool:
    """Whether the first move is made, by the random numbers of the seed: not the class's words."""
    words = [philox(number, (seed, 0x4D540000)) for number in range(2)]
    # The second and third number of 64 bits, of which the upper half is enough.
    second, third = words[0][3] / 2**32, words[1][1] / 2**32
    area = box[0, 0] * box[1, 1]
    change = 0.01 * area * (2 * second - 1)
    twin = tense(*forces_of(triangles), positions=positions, box=box)
    before, after = (energy_of(twin, positions, box, ratio) for ratio in (1, 1 + change / area))
    exponent = (before - after + tension * change) / KT
    exponent += len(positions) * np.log(1 + change / area)
    return third < np.exp(exponent)


def philox(number: int, key: tuple[int, int]) -> list[int]:
    """Philox4x32-10, doi:10.1145/2063384.2063405."""
    words, (one, two) = [number, 0, 0, 0], key
    for _ in range(10):
        first, other = words[0] * 0xD2511F53, words[2] * 0xCD9E8D57
        words = [
            (other >> 32) ^ words[1] ^ one,
            other & 0xFFFFFFFF,
            (first >> 32) ^ words[3] ^ two,
            first & 0xFFFFFFFF,
        ]
        one, two = (one + 0x9E3779B9) & 0xFFFFFFFF, (two + 0xBB67AE85) & 0xFFFFFFFF
    return words
