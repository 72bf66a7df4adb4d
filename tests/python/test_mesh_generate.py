"""Generated spheres: numbers, degrees, evenness, reproducibility."""

import numpy as np
import pytest
from openmm import unit
from openmmhelfrich.mesh import Mesh, MeshError


@pytest.mark.parametrize("n", [1, 2, 3, 5, 10])
def test_icosphere(n):
    mesh = Mesh.icosphere(n, 25.0)
    assert (mesh.num_vertices, mesh.num_triangles) == (10 * n * n + 2, 20 * n * n)
    assert mesh.euler_characteristic == 2
    assert np.bincount(mesh.degrees, minlength=7).tolist() == [0] * 5 + [12, mesh.num_vertices - 12]
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 25.0, rtol=1e-14)
    # Chords of a sphere: the area approaches that of the sphere from below, as 1/n².
    excess = 1 - mesh.area / (4 * np.pi * 25.0**2)
    assert 0.2 < excess * n * n < 0.35


def test_icosphere_cuts_sides_into_equal_parts_before_projecting():
    """n = 2 halves the arcs; n = 3 has the points one and two thirds along each side."""
    icosahedron = Mesh.icosphere(1, 1.0)
    corners = {tuple(np.round(p, 12) + 0.0) for p in icosahedron.vertices}
    for n in (2, 3, 4):
        expected = set(corners)
        for i, j in icosahedron.edges:
            for k in range(1, n):
                point = (n - k) * icosahedron.vertices[i] + k * icosahedron.vertices[j]
                expected.add(tuple(np.round(point / np.linalg.norm(point), 12) + 0.0))
        found = {tuple(np.round(p, 12) + 0.0) for p in Mesh.icosphere(n, 1.0).vertices}
        assert expected <= found
        assert len(found) == 10 * n * n + 2


# After the usual number of steps, 18 and 20 with these seeds still have a degree out of range.
@pytest.mark.parametrize(
    ("num_vertices", "seed"),
    [(12, 1), (14, 1), (15, 1), (16, 1), (18, 0), (18, 1), (18, 4), (20, 12), (33, 1), (1002, 1)],
)
def test_random_sphere_degrees(num_vertices, seed):
    mesh = Mesh.random_sphere(num_vertices, 1000.0, seed)
    assert mesh.num_vertices == num_vertices
    assert mesh.num_triangles == 2 * num_vertices - 4
    assert mesh.euler_characteristic == 2
    counts = np.bincount(mesh.degrees, minlength=8)
    assert counts[5:8].sum() == num_vertices
    assert counts[5] - counts[7] == 12
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 1000.0, rtol=1e-14)


def test_random_sphere_is_nearly_even():
    """As even as the paper's sphere: areas within 4.3 %, edges within 5.3 %, of their means."""
    mesh = Mesh.random_sphere(1002, 1.0, seed=5)
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert areas.std() / areas.mean() < 0.06
    assert 0.7 < areas.min() / areas.mean() < areas.max() / areas.mean() < 1.4
    edges = np.linalg.norm(np.diff(mesh.vertices[mesh.edges], axis=1), axis=-1)
    assert edges.std() / edges.mean() < 0.08
    assert 0.7 < edges.min() / edges.mean() < edges.max() / edges.mean() < 1.4
    # The caps of the sphere hold vertices in proportion to their areas.
    for axis in range(3):
        for height in (-0.6, 0.0, 0.6):
            share = (mesh.vertices[:, axis] > height).mean()
            assert share == pytest.approx((1 - height) / 2, abs=0.015)


def test_random_sphere_is_irregular():
    """Unlike an icosphere it has vertices of degree 7, and they lie anywhere."""
    first, second = (Mesh.random_sphere(500, 1.0, seed) for seed in (1, 2))
    assert (first.degrees == 7).sum() > 5
    assert (second.degrees == 7).sum() > 5
    assert first != second


def test_random_sphere_follows_its_seed():
    assert Mesh.random_sphere(200, 3.0, 11) == Mesh.random_sphere(200, 3.0, seed=11)


def test_radius_with_unit():
    expected = Mesh.icosphere(2, 150.0).vertices
    assert np.allclose(Mesh.icosphere(2, 0.15 * unit.micrometer).vertices, expected, rtol=1e-14)
    mesh = Mesh.random_sphere(12, 30 * unit.angstrom, seed=1)
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 3.0, rtol=1e-14)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Mesh.icosphere(0, 1.0), "Mesh.icosphere: n must be 1 or more, got 0"),
        (lambda: Mesh.icosphere(2.0, 1.0), "Mesh.icosphere: n must be an integer, got 2.0"),
        (lambda: Mesh.icosphere(2, 0), "Mesh.icosphere: radius must be above 0 nm, got 0"),
        (lambda: Mesh.icosphere(2, [1, 2]), "Mesh.icosphere: radius must be one number"),
        (lambda: Mesh.icosphere(2, 1 * unit.kelvin), "Mesh.icosphere: radius must be a length"),
        (lambda: Mesh.random_sphere(11, 1, 0), "Mesh.random_sphere: num_vertices must be 12 or m"),
        (
            lambda: Mesh.random_sphere(13, 1, 0),
            "Mesh.random_sphere: no triangulation .*13 vertices",
        ),
        (lambda: Mesh.random_sphere(50, -1, 0), "Mesh.random_sphere: radius must be above 0 nm"),
        (lambda: Mesh.random_sphere(50, np.nan, 0), "Mesh.random_sphere: radius must be finite"),
        (lambda: Mesh.random_sphere(50, 1, -3), "Mesh.random_sphere: seed must be 0 or more"),
        (lambda: Mesh.random_sphere(50, 1, None), "Mesh.random_sphere: seed must be an integer"),
    ],
)
def test_bad_arguments_are_refused_by_name(call, message):
    with pytest.raises(MeshError, match=message):
        call()
