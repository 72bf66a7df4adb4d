"""Values of vertices from a table of domains."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit

TABLE = {
    3: {"rigidity": 40, "spontaneousCurvature": 0.0},
    -1: {"rigidity": 60.5, "spontaneousCurvature": 0.02},
    7: {"spontaneousCurvature": -0.01, "rigidity": 0},
}


def test_values_are_those_of_the_domains():
    domains = [3, 3, -1, 3, -1]
    values = helfrich.values_of_domains(domains, TABLE)
    assert list(values) == ["rigidity", "spontaneousCurvature"]
    assert values["rigidity"].tolist() == [40, 40, 60.5, 40, 60.5]
    assert values["spontaneousCurvature"].tolist() == [0, 0, 0.02, 0, 0.02]
    assert helfrich.values_of_domains(np.array([7]), TABLE)["rigidity"].tolist() == [0]


def test_forces_take_them():
    mesh = helfrich.Mesh.icosphere(1, 5.0)
    domains = np.arange(12) % 2 * 4 - 1
    table = {
        -1: {"rigidity": 40 * unit.kilojoule_per_mole, "spontaneousCurvature": 0.1},
        3: {"rigidity": 10 * unit.kilocalorie_per_mole, "spontaneousCurvature": 0},
    }
    values = helfrich.values_of_domains(domains, table)
    force = helfrich.BendingForce(mesh, **values)
    expected = np.where(domains == 3, 41.84, 40)
    np.testing.assert_allclose(force.getVertexRigidity(), expected, rtol=1e-12)
    assert list(force.getVertexSpontaneousCurvature()) == np.where(domains == 3, 0, 0.1).tolist()


@pytest.mark.parametrize(
    ("domains", "table", "error", "words"),
    [
        ([3, 5], TABLE, ValueError, "vertex 1 is of domain 5, .* has -1, 3, 7"),
        ([0], {}, ValueError, "empty"),
        ([0, 1], {0: {"a": 1}, 1: {"b": 1}}, ValueError, "domain 1 has no 'a'"),
        ([0, 1], {0: {}, 1: {"b": 1}}, ValueError, "domain 0 has no 'b'"),
        ([0], {0: {"a": "stiff"}}, TypeError, "'a' of domain 0 must be a number, got 'stiff'"),
        ([0], {0: {"a": [1, 2]}}, TypeError, "'a' of domain 0 must be a number"),
        ([0], {0: {"a": 1}, 1: {"a": 1 * unit.kelvin}}, TypeError, "'a' of domain 1 is 1 K"),
        (
            [0],
            {0: {"a": 1 * unit.nanometer}, 1: {"a": 1 * unit.kelvin}},
            TypeError,
            "'a' of domain 1 is 1 K, but .* 1 nm",
        ),
        ([0.5], TABLE, TypeError, "domains must be integers"),
        ([[3]], TABLE, ValueError, "one list"),
    ],
)
def test_mistakes_are_named(domains, table, error, words):
    with pytest.raises(error, match=rf"^values_of_domains: .*{words}"):
        helfrich.values_of_domains(domains, table)


@pytest.mark.parametrize(
    ("domains", "table", "message"),
    [
        ([0], [{"rigidity": 1}], "the table needs a mapping of domains"),
        ([0], {0: 1.0}, "domain 0 needs a mapping of names to values, got 1.0"),
        ([0] * unit.nanometer, {0: {}}, "domains must be integers, got a Quantity in nanometer"),
    ],
)
def test_tables_that_are_none(domains, table, message):
    with pytest.raises(TypeError, match=f"values_of_domains: {message}"):
        helfrich.values_of_domains(domains, table)


def test_values_that_are_not_finite():
    with pytest.raises(ValueError, match="'rigidity' of domain 2 must be finite, got nan"):
        helfrich.values_of_domains([2], {2: {"rigidity": np.nan}})


@pytest.mark.parametrize(
    ("make", "setter", "list_"),
    [
        (helfrich.BendingForce, "setRigidity", "getVertexRigidity"),
        (helfrich.GaussianCurvatureForce, "setModulus", "getVertexModulus"),
    ],
)
def test_a_scalar_takes_the_place_of_values(make, setter, list_):
    """In a Context, too."""
    mesh = helfrich.Mesh.icosphere(1, 5.0)
    force, plain = make(mesh, np.linspace(1, 2, 12)), make(mesh, 3.0)
    system = mm.System()
    for _ in range(12):
        system.addParticle(1)
    system.addForce(force)
    context = mm.Context(system, mm.VerletIntegrator(1), mm.Platform.getPlatformByName("Reference"))
    context.setPositions(mesh.vertices)
    getattr(force, setter)(3.0)
    assert len(getattr(force, list_)()) == 0
    force.updateParametersInContext(context)
    energy = context.getState(energy=True).getPotentialEnergy()._value
    assert energy == pytest.approx(mesh.energy(plain), rel=1e-12)


def test_indices_have_no_unit():
    mesh = helfrich.Mesh.icosphere(1, 5.0)
    with pytest.raises(TypeError, match="PressureForce: triangles are particle indices"):
        helfrich.PressureForce(mesh.triangles * unit.nanometer, 1)
