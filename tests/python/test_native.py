"""Membranes that OpenMM's GPU platforms evaluate themselves: OpenCL, on PoCL for example.

`test_gpu.py` has the rows of the table of cases; here is what only these platforms have, and in
`test_native_*.py`. With the environment variable HELFRICH_NATIVE_PLATFORM, such as CUDA, all run on
that platform.
"""

from __future__ import annotations

import copy

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from meshes import membrane
from native_vesicle import context_of, forces_of, system_of, vesicle
from openmm import unit
from platforms import NATIVE, REFERENCE, UNASKED, counting, native_is_on_processor
from running import Running, plain

SINGLE, _, DOUBLE = NATIVE


# --- beside the processor ------------------------------------------------------------------------


def test_contacts_are_computed_beside_it():
    """The processor adds them to the same Context, by force groups and all together."""
    mesh = helfrich.Mesh.disk(8, 100.0)
    rng = np.random.default_rng(3)
    positions = mesh.vertices + rng.normal(scale=1.0, size=mesh.vertices.shape)

    def forces():
        return [
            helfrich.BendingForce(mesh, 50),
            helfrich.EdgeTensionForce(mesh, 3.0),
            helfrich.TriangleAreaForce(mesh, 1.0, mesh.area / len(mesh.triangles)),
            helfrich.SurfaceRepulsionForce(mesh, 8.0, 5.0),
        ]

    found = Running(forces(), mesh.num_vertices, DOUBLE)
    expected = Running(forces(), mesh.num_vertices, REFERENCE)
    with counting() as made:
        for group in (-1, 0, 1, 2, 3):
            energy, of_group = found.evaluate(positions, group)
            reference = expected.evaluate(positions, group)
            assert energy == pytest.approx(reference[0], rel=1e-9, abs=1e-12)
            allowed = 1e-9 * max(np.abs(reference[1]).max(), 1)
            assert np.abs(of_group - reference[1]).max() <= allowed
    assert made["native"] == 4


def test_a_volume_in_a_periodic_box_is_left_to_the_processor():
    """It needs the surface in one piece; `test_periodic.py` has the other forces."""
    mesh, forces = vesicle()
    for force in forces:
        force.setUsesPeriodicBoundaryConditions(True)
    system = system_of(mesh.num_vertices)
    system.setDefaultPeriodicBoxVectors(*(500 * np.eye(3)))
    context = context_of(DOUBLE, system, forces, mm.VerletIntegrator(0.01))
    # On a corner of the box, wrapped into it vertex by vertex.
    context.setPositions(mesh.vertices % 500)
    with counting() as made:
        state = context.getState(energy=True, forces=True)
    assert made.keys() == {"native", "cpu"}
    expected = Running(forces_of(mesh), mesh.num_vertices, REFERENCE).evaluate(mesh.vertices)
    assert plain(state.getPotentialEnergy()) == pytest.approx(expected[0], rel=1e-9)
    found = plain(state.getForces(asNumpy=True))
    assert np.abs(found - expected[1]).max() < 1e-9 * np.abs(expected[1]).max()


# --- choice --------------------------------------------------------------------------------------


def test_it_is_refused_on_other_platforms():
    m = membrane("octahedron")
    force = helfrich.BendingForce(m.triangles, 50)
    force.setBackend("native")
    with pytest.raises(
        mm.OpenMMException,
        match=r"BendingForce: .*native.*the platform Reference is none of OpenCL",
    ):
        Running([force], m.num_particles, REFERENCE)


def test_the_minimizers_context_beside_it_is_not_refused():
    """Where forces are too large for its numbers, OpenMM's minimizer has one on the processor."""
    mesh, forces = vesicle()
    system = system_of(mesh.num_vertices)
    context = context_of(SINGLE, system, forces, mm.VerletIntegrator(0.01))
    other = REFERENCE.context(system)
    energies = []
    for one in (context, other):
        one.setPositions(mesh.vertices)
        energies.append(plain(one.getState(energy=True).getPotentialEnergy()))
    assert energies[0] == pytest.approx(energies[1], rel=1e-5)
    del context, one, other
    with pytest.raises(mm.OpenMMException, match="Reference is none of OpenCL"):
        REFERENCE.context(system)


def test_a_driver_on_the_processor_is_taken_only_where_it_is_asked_for():
    """A real GPU is taken unasked."""
    m = membrane("octahedron")
    with counting() as made:
        run = Running([helfrich.BendingForce(m.triangles, 50)], m.num_particles, UNASKED)
        run.evaluate(m.positions)
    assert made.keys() == {"cpu" if native_is_on_processor() else "native"}


@pytest.mark.parametrize("place", [0, 3])
def test_one_force_asks_for_all_on_its_triangles(place: int):
    """Whichever of them it is: they are computed together."""
    mesh, forces = vesicle()
    forces[place].setBackend("native")
    system = system_of(mesh.num_vertices)
    for force in forces:
        system.addForce(force)
    context = DOUBLE.context(system)
    context.setPositions(mesh.vertices)
    with counting() as made:
        context.getState(energy=True)
    assert made == {"native": 1}


def test_derivatives_need_it():
    UNASKED.context(system_of(1))
    if not native_is_on_processor():
        pytest.skip("a GPU is taken unasked")
    m = membrane("octahedron")
    force = helfrich.BendingForce(m.triangles, 50)
    force.setContextParameter("rigidity", "kappa")
    force.addEnergyParameterDerivative("kappa")
    run = Running([copy.deepcopy(force)], m.num_particles, UNASKED)
    with counting() as made:
        run.context.setPositions(m.positions)
        state = run.context.getState(energy=True, parameterDerivatives=True)
    assert made == {"native": 1}
    energy = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    assert state.getEnergyParameterDerivatives()["kappa"] == pytest.approx(energy / 50, rel=1e-5)
    force.setBackend("cpu")
    with pytest.raises(mm.OpenMMException, match=r'energy parameter derivatives need .*"native"'):
        Running([force], m.num_particles, UNASKED)


# --- numbers ------------------------------------------------------------------------------------


def test_units_of_length_do_not_show():
    """A membrane at two sizes in a ratio of two has the same bits, but for the power of two."""
    mesh, _ = vesicle()
    found = []
    for scale in (1.0, 1024.0):
        force = helfrich.BendingForce(mesh, 50)
        run = Running([force], mesh.num_vertices, SINGLE)
        found.append(run.evaluate(scale * SINGLE.rounded(mesh.vertices)))
    assert found[0][0] == found[1][0]
    assert unit.is_quantity(run.context.getState(energy=True).getPotentialEnergy())
