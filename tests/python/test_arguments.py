"""What functions take beside what their first example shows, and what they say of anything else."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich import analysis, vcm

MESH = helfrich.Mesh.icosphere(2, 10.0)
ENERGY = unit.kilojoule_per_mole
RIGIDITIES = np.linspace(40.0, 60.0, MESH.num_vertices)


def simulation():
    integrator = mm.VerletIntegrator(0.001)
    made = helfrich.Vesicle(MESH).simulation(integrator, "Reference")
    made.context.setPositions(MESH.vertices)
    return made


@pytest.mark.parametrize("whole", [np.int64, np.int32, np.uint8, int])
def test_indices_of_any_integer_type(whole):
    force = helfrich.BendingForce(MESH, 50.0)
    force.setContextParameter("rigidity", "kappa")
    force.addEnergyParameterDerivative("kappa")
    assert force.getTriangle(whole(3)) == MESH.triangles[3].tolist()
    assert force.getParameterName(whole(0)) == "rigidity"
    assert force.getEnergyParameterDerivativeName(whole(0)) == "kappa"


@pytest.mark.parametrize("index", [1.0, "1", None])
def test_other_indices_are_refused(index):
    with pytest.raises(TypeError, match=r"getTriangle', argument 2 must be an integer"):
        helfrich.BendingForce(MESH, 50.0).getTriangle(index)


@pytest.mark.parametrize("index", [2**31, -(2**70)])
def test_indices_beyond_all_are_refused(index):
    with pytest.raises(OverflowError, match=r"getTriangle', argument 2 must be of 32 bits"):
        helfrich.BendingForce(MESH, 50.0).getTriangle(index)


def test_what_an_index_raises_goes_on():
    class Odd:
        def __index__(self):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        helfrich.BendingForce(MESH, 50.0).getTriangle(Odd())


def test_lists_of_quantities():
    plain = helfrich.BendingForce(MESH, RIGIDITIES)
    energy = MESH.energy(plain)
    in_kilocalories = [(k * ENERGY).in_units_of(unit.kilocalorie_per_mole) for k in RIGIDITIES]
    for values in ([k * ENERGY for k in RIGIDITIES], in_kilocalories, RIGIDITIES.tolist()):
        assert MESH.energy(helfrich.BendingForce(MESH, values)) == pytest.approx(energy, rel=1e-14)
        setting = helfrich.BendingForce(MESH, 1.0)
        setting.setVertexRigidity(values)
        assert MESH.energy(setting) == pytest.approx(energy, rel=1e-14)
        rigidity = helfrich.Vesicle(MESH, rigidity=values).rigidity
        np.testing.assert_allclose(rigidity, RIGIDITIES, rtol=1e-14)
    areas = analysis.triangle_areas(MESH, MESH)
    forces = [
        helfrich.TriangleAreaForce(MESH, 1.0, targets)
        for targets in (areas, [a * unit.nanometer**2 for a in areas])
    ]
    assert MESH.energy(forces[0]) == MESH.energy(forces[1])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([1, [2, 3]], "BendingForce: rigidity must be a list of numbers, got lists"),
        ([1.0 * unit.nanometer], "BendingForce: rigidity must be in units of kJ/mol"),
        (["a", "b"], "BendingForce: rigidity must be a list of numbers, got dtype"),
    ],
)
def test_other_lists_are_refused_by_name(values, message):
    with pytest.raises(TypeError, match=message):
        helfrich.BendingForce(MESH, values)


def test_a_list_with_another_unit_is_refused_by_vesicles():
    with pytest.raises(TypeError, match="Vesicle: rigidity needs the unit"):
        helfrich.Vesicle(MESH, rigidity=[1.0 * unit.nanometer] * MESH.num_vertices)


def test_schemes_by_name():
    vesicle = helfrich.Vesicle(MESH, scheme="GompperKroll")
    assert vesicle.scheme == helfrich.BendingForce.GompperKroll
    with pytest.raises(ValueError, match="there is no scheme 'Kroll'; known are: Julicher, "):
        helfrich.Vesicle(MESH, scheme="Kroll")


def test_a_simulation_will_do_for_its_context(tmp_path):
    made = simulation()
    helfrich.save_state(made, tmp_path / "a.state")
    made.context.setPositions(1.1 * MESH.vertices)
    helfrich.load_state(made, tmp_path / "a.state")
    found = made.context.getState(positions=True).getPositions(asNumpy=True)
    assert (found.value_in_unit(unit.nanometer) == MESH.vertices).all()
    assert (helfrich.virial(made) == helfrich.virial(made.context)).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda path: helfrich.save_state(3, path), "save_state: context needs an openmm.Context"),
        (lambda path: helfrich.load_state(3, path), "load_state: context needs an openmm.Context"),
        (lambda path: helfrich.virial(None), "virial: context needs an openmm.Context"),
        (lambda path: helfrich.virial(simulation(), "a"), "virial: groups needs force groups"),
        (lambda path: helfrich.virial(simulation(), None), "virial: groups needs force groups"),
        (lambda path: MESH.energy(3), "Mesh.energy: force needs an openmm.Force, got int"),
        (lambda path: vcm.accelerate(3), "accelerate: system needs an openmm.System, got int"),
    ],
)
def test_what_is_none_of_openmms_is_named(call, message, tmp_path):
    with pytest.raises(TypeError, match=message):
        call(tmp_path / "a.state")


@pytest.mark.parametrize("groups", [[-1], [1.5], [32], [0, 1 << 40], 1 << 32, -(1 << 40), 1.5])
def test_groups_that_are_none(groups):
    with pytest.raises(TypeError, match="virial: groups needs force groups from 0 to 31"):
        helfrich.virial(simulation(), groups)


def test_corners_on_a_line_up_to_rounding_are_refused():
    corners = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]
    line = np.array([[0, 0, 0], [0.3, 0.6, 0.9], [0.1, 0.2, 0.3]])
    for shift in (0.0, 1e4):
        with pytest.raises(helfrich.MeshError, match=r"triangle 0 \(0, 1, 2\) has no area"):
            helfrich.Mesh(np.vstack([line, [1, 1, 1]]) + shift, corners)
    line[2, 0] += 1e-9
    assert helfrich.Mesh(np.vstack([line, [1, 1, 1]]), corners).num_triangles == 4
