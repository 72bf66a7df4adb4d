"""Values of vertices from a table of domains."""

from __future__ import annotations

import numpy as np
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
