"""Forces on the same triangles in one Context share one membrane, and nothing is left behind."""

from __future__ import annotations

import ctypes
import gc

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich import _core
from platforms import ON_OPENCL, ON_PROCESSOR


def membranes() -> int:
    """How many membranes the core holds in this process."""
    count = _core.library().Helfrich_Membrane_count
    count.restype = ctypes.c_int64
    return count()


@pytest.fixture
def mesh() -> helfrich.Mesh:
    return helfrich.Mesh.icosphere(3, 100.0).deformed(2, 1, 0.2)


def forces_on(mesh, offset=0) -> list[openmm.Force]:
    return [
        helfrich.BendingForce(mesh, 50, 0.01, offset=offset),
        helfrich.BendingForce(mesh, 7, scheme=helfrich.BendingForce.GompperKroll, offset=offset),
        helfrich.SurfaceAreaForce(mesh, 1.3, 1.1 * mesh.area, offset=offset),
        helfrich.EnclosedVolumeForce(mesh, 0.04, 0.9 * mesh.volume, offset=offset),
        helfrich.TriangleHeightForce(mesh, 30, 10, offset=offset),
        helfrich.DihedralForce(mesh, 3, offset=offset),
    ]


def context_of(forces, num_particles: int) -> openmm.Context:
    system = openmm.System()
    for _ in range(num_particles):
        system.addParticle(50)
    for group, force in enumerate(forces):
        force.setForceGroup(group)
        system.addForce(force)
    platform = openmm.Platform.getPlatformByName("Reference")
    return openmm.Context(system, openmm.VerletIntegrator(0.1), platform)


def test_one_membrane_for_all_forces_of_a_context(mesh):
    # What other tests have left must not go while this one counts.
    gc.collect()
    before = membranes()
    context = context_of(forces_on(mesh), mesh.num_vertices)
    assert membranes() == before + 1
    other = context_of(forces_on(mesh), mesh.num_vertices)
    assert membranes() == before + 2, "Contexts must not share"
    del context, other
    gc.collect()
    assert membranes() == before


def test_other_triangles_have_their_own(mesh):
    before = membranes()
    forces = forces_on(mesh) + forces_on(mesh, offset=mesh.num_vertices)
    context = context_of(forces, 2 * mesh.num_vertices)
    assert membranes() == before + 2
    context.reinitialize()
    assert membranes() == before + 2
    del context
    gc.collect()
    assert membranes() == before


def test_a_refused_context_does_not_harm_the_next(mesh):
    """OpenMM keeps what it has made of a Context that fails; a new one must not meet it."""
    for _ in range(3):
        broken = helfrich.BendingForce(mesh.triangles[:, [0, 0, 1]], 50)
        with pytest.raises(openmm.OpenMMException, match="BendingForce: triangle 0"):
            context_of([*forces_on(mesh), broken], mesh.num_vertices)
    context = context_of(forces_on(mesh), mesh.num_vertices)
    context.setPositions(mesh.vertices)
    expected = sum(mesh.energy(force) for force in forces_on(mesh))
    energy = context.getState(energy=True).getPotentialEnergy()._value
    assert energy == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("seed", range(5))
def test_any_mask_of_groups_is_the_sum_of_its_forces(mesh, seed: int):
    forces = forces_on(mesh)
    context = context_of(forces, mesh.num_vertices)
    context.setPositions(mesh.vertices)

    def measure(groups):
        state = context.getState(energy=True, forces=True, groups=groups)
        return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value

    alone = [measure({group}) for group in range(len(forces))]
    chosen = np.random.default_rng(seed).random(len(forces)) < 0.5
    groups = set(np.flatnonzero(chosen).tolist())
    energy, force = measure(groups)
    assert energy == pytest.approx(sum(alone[group][0] for group in groups), rel=1e-13)
    expected = sum((alone[group][1] for group in groups), np.zeros_like(force))
    scale = max(np.abs(part[1]).max() for part in alone)
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-13 * scale)


@pytest.mark.parametrize("target", [*ON_PROCESSOR, ON_OPENCL[0]], ids=str)
def test_groups_that_change_later_wait_for_reinitialize(mesh, target):
    """As those of OpenMM's own forces do, of which a bond stands beside."""
    forces = forces_on(mesh)
    bond = openmm.HarmonicBondForce()
    bond.addBond(0, 1, 0.0, 3.0)
    system = openmm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50)
    for group, force in enumerate([*forces, bond]):
        force.setForceGroup(group)
        system.addForce(force)
    context = target.context(system)
    context.setPositions(mesh.vertices)

    def energies(groups) -> list[float]:
        states = (context.getState(energy=True, groups={group}) for group in groups)
        return [state.getPotentialEnergy()._value for state in states]

    bonds = len(forces)
    before = energies(range(bonds + 1))
    assert before[0] and before[bonds]
    system = context.getSystem()
    system.getForce(0).setForceGroup(20)
    system.getForce(bonds).setForceGroup(21)
    assert energies(range(bonds + 1)) == before
    assert energies([20, 21]) == [0, 0]
    context.reinitialize(preserveState=True)
    assert energies([20, *range(1, bonds), 21]) == before
    assert energies([0, bonds]) == [0, 0]
