"""Triangles that pass through each other: known cases, brute force, periodic boxes, speed."""

import time

import numpy as np
import pytest
from openmmhelfrich.analysis import crossings
from openmmhelfrich.mesh import Mesh

APART = np.array([[0, 1, 2], [3, 4, 5]])


def by_brute_force(vertices, triangles):
    """Each edge against each triangle without a common vertex, as a linear system."""
    found = set()
    for one in range(len(triangles)):
        for two in range(len(triangles)):
            a, b, c = vertices[triangles[two]]
            for side in range(3):
                ends = triangles[one][[side, (side + 1) % 3]]
                if np.isin(ends, triangles[two]).any():
                    continue
                p, q = vertices[ends]
                share, u, v = np.linalg.solve(np.stack([q - p, a - b, a - c], axis=1), a - p)
                if 0 <= share <= 1 and u >= 0 and v >= 0 and u + v <= 1:
                    found.add((min(one, two), max(one, two)))
    return sorted(found)


def test_a_needle_through_a_triangle():
    plate = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], dtype=float)
    needle = np.array([[1, 1, -1], [1, 1.2, 3], [1.2, 1, 3]])
    assert crossings(np.concatenate([plate, needle]), APART).tolist() == [[0, 1]]
    assert len(crossings(np.concatenate([plate, np.add(needle, [3, 3, 0])]), APART)) == 0
    assert len(crossings(np.concatenate([plate, np.add(needle, [0, 0, 1.5])]), APART)) == 0


def test_a_fan_that_crosses_itself_at_a_distance_from_its_vertex():
    """Two triangles with one common vertex."""
    vertices = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [3, 3, 1], [1, 1, -1.0]])
    assert crossings(vertices, np.array([[0, 1, 2], [0, 3, 4]])).tolist() == [[0, 1]]


def test_agrees_with_brute_force():
    sphere = Mesh.icosphere(2, 1.0)
    vertices = sphere.vertices + 0.3 * np.random.default_rng(1).normal(size=sphere.vertices.shape)
    expected = by_brute_force(vertices, sphere.triangles)
    assert len(expected) > 20
    assert crossings(vertices, sphere).tolist() == [list(pair) for pair in expected]


def test_flat_and_convex_surfaces_do_not_cross():
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    for mesh in (Mesh.sheet(9, 9, 1.0), Mesh.disk(6, 3.0), Mesh.tube(9, 6, 1.0, 3.0)):
        assert len(crossings(mesh.vertices @ turn, mesh)) == 0
    assert len(crossings(Mesh.torus(9, 3.0, 1.0))) == 0


def test_spheres_that_overlap_in_a_triclinic_box():
    sphere = Mesh.icosphere(5, 3.0)
    vertices = np.concatenate([sphere.vertices, np.add(sphere.vertices, [4.1, 1.3, 0.7])])
    triangles = np.concatenate([sphere.triangles, sphere.triangles + sphere.num_vertices])
    pairs = crossings(vertices, triangles)
    assert len(pairs) > 30
    assert ((pairs[:, 0] < 500) & (pairs[:, 1] >= 500)).all()
    box = np.array([[30.0, 0, 0], [11, 28, 0], [-14, 13, 26]])
    images = np.random.default_rng(4).integers(-3, 4, vertices.shape)
    assert np.array_equal(crossings(vertices + images @ box, triangles, box=box), pairs)
    # A sphere and its own image, through a face that leans.
    for tilt in (0.0, 2.8):
        narrow = np.array([[5.7, 0, 0], [tilt, 9, 0], [-tilt, 0, 9]])
        mesh = Mesh(sphere.vertices, sphere.triangles, narrow)
        assert len(crossings(mesh)) > 10
    assert len(crossings(sphere.vertices, sphere, box=6.2 * np.eye(3))) == 0


def test_one_large_triangle_among_small_ones():
    sphere = Mesh.icosphere(6, 1.0)
    plate = np.array([[-90, -80, 0.1], [95, -70, 0.2], [3, 100, 0.3]])
    vertices = np.concatenate([sphere.vertices, plate])
    triangles = np.concatenate([sphere.triangles, [[362, 363, 364]]])
    pairs = crossings(vertices, triangles)
    assert len(pairs) > 30
    assert (pairs[:, 1] == 720).all()


def test_speed():
    mesh = Mesh.icosphere(16, 1.0)
    start = time.perf_counter()
    assert len(crossings(mesh)) == 0
    assert time.perf_counter() - start < 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros((3, 3)),), "^crossings: triangles are needed"),
        ((np.zeros((2, 6, 3)), APART), "^crossings: vertices of one frame are taken, got 2"),
        ((np.zeros((5, 3)), APART), "names vertex 5"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        crossings(*arguments)
