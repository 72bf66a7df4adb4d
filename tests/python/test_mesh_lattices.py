"""Sheets, tubes, disks, tori and the P surface: numbers, places, regularity, boxes."""

import numpy as np
import pytest
from openmm import unit
from openmmhelfrich.analysis import edge_lengths
from openmmhelfrich.mesh import Mesh, MeshError


def normals(mesh):
    corners = mesh.corner_positions
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


@pytest.mark.parametrize(("nx", "ny"), [(5, 4), (4, 7), (3, 3), (8, 8)])
def test_periodic_sheets_are_lattices(nx, ny):
    mesh = Mesh.sheet(nx, ny, 2.0 * unit.nanometer, periodic=True)
    assert (mesh.num_vertices, mesh.num_triangles) == (nx * ny, 2 * nx * ny)
    assert (mesh.degrees == 6).all()
    assert mesh.is_closed
    assert (mesh.genus, mesh.euler_characteristic) == (1, 0)
    np.testing.assert_allclose(edge_lengths(mesh, mesh), 2.0, rtol=1e-13)
    area = nx * ny * 4 * np.sqrt(0.75)
    assert mesh.area == pytest.approx(area, rel=1e-13)
    assert mesh.box[0, 0] * mesh.box[1, 1] == pytest.approx(area, rel=1e-13)
    assert (normals(mesh)[:, 2] > 0).all()


def test_open_sheet():
    mesh = Mesh.sheet(6, 5, 2.0)
    assert (mesh.num_vertices, mesh.num_triangles) == (30, 2 * 5 * 4)
    assert mesh.box is None
    (border,) = mesh.border_loops
    assert len(border) == 2 * (5 + 4)
    np.testing.assert_allclose(edge_lengths(mesh, mesh), 2.0, rtol=1e-14)
    assert mesh.vertices[0].tolist() == [0, 0, 0]
    # Along x at first, the surface on the left.
    assert border[:6].tolist() == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("periodic", [False, True])
def test_tube(periodic):
    mesh = Mesh.tube(12, 8, 3.0, 10.0, periodic)
    assert mesh.num_vertices == 96
    assert mesh.num_triangles == 2 * 12 * (8 if periodic else 7)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices[:, :2], axis=1), 3.0, rtol=1e-14)
    assert [len(loop) for loop in mesh.border_loops] == ([] if periodic else [12, 12])
    assert mesh.genus == periodic
    middles = mesh.corner_positions.mean(axis=1)
    assert (np.einsum("ij,ij->i", normals(mesh)[:, :2], middles[:, :2]) > 0).all()
    if periodic:
        assert mesh.box.tolist() == [[12, 0, 0], [0, 12, 0], [0, 0, 10]]
        assert (mesh.degrees == 6).all()
    else:
        assert np.ptp(mesh.vertices[:, 2]) == 10.0


def test_disk():
    for n in (1, 2, 7):
        mesh = Mesh.disk(n, 5.0)
        assert (mesh.num_vertices, mesh.num_triangles) == (3 * n * n + 3 * n + 1, 6 * n * n)
        (border,) = mesh.border_loops
        assert len(border) == 6 * n
        np.testing.assert_allclose(np.linalg.norm(mesh.vertices[border], axis=1), 5.0)
        assert (normals(mesh)[:, 2] > 0).all()
        inner = np.setdiff1d(np.arange(mesh.num_vertices), border)
        assert (mesh.degrees[inner] == 6).all()
    lengths = edge_lengths(mesh, mesh)
    assert lengths.max() / lengths.min() < 1.5


def test_torus():
    mesh = Mesh.torus(16, 9.0, 3.0)
    rings = 2 * round(16 * 9 / (np.sqrt(3) * 3))
    assert mesh.num_vertices == 16 * rings
    assert (mesh.genus, mesh.num_components) == (1, 1)
    assert (mesh.degrees == 6).all()
    assert mesh.area == pytest.approx(4 * np.pi**2 * 27, rel=0.02)
    assert mesh.volume == pytest.approx(2 * np.pi**2 * 81, rel=0.04)
    assert edge_lengths(mesh, mesh).mean() == pytest.approx(2 * np.pi * 3 / 16, rel=0.05)


def test_schwarz_p():
    for n in (1, 4):
        mesh = Mesh.schwarz_p(n, 20.0)
        assert (mesh.num_vertices, mesh.num_triangles) == (24 * n * n - 4, 48 * n * n)
        assert (mesh.euler_characteristic, mesh.genus) == (-4, 3)
        assert sorted(np.unique(mesh.degrees, return_counts=True)[1])[0] in (8, 12)
        level = np.cos(np.pi * mesh.vertices / 10).sum(axis=1)
        assert abs(level).max() < 1e-13
    assert mesh.area / 400 == pytest.approx(2.353, rel=0.01)
    # It faces one of its two sides everywhere, that of the level surface's gradient or the other.
    middles = mesh.corner_positions.mean(axis=1)
    sides = np.einsum("ij,ij->i", normals(mesh), np.sin(np.pi * middles / 10))
    assert (sides > 0).all() or (sides < 0).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Mesh.sheet(1, 5, 1), r"^Mesh.sheet: nx must be 2 or more"),
        (lambda: Mesh.sheet(3, 2, 1, periodic=True), r"^Mesh.sheet: ny must be 3 or more"),
        (lambda: Mesh.sheet(3, 3, -1), r"^Mesh.sheet: spacing must be above 0 nm"),
        (lambda: Mesh.tube(8, 5, 1, 3, True), r"^Mesh.tube: n_along must be even .* got 5"),
        (lambda: Mesh.tube(8, 4, 0, 3), r"^Mesh.tube: radius must be above 0"),
        (lambda: Mesh.tube(8, 4, 1, 3 * unit.kelvin), r"^Mesh.tube: length must be a length"),
        (lambda: Mesh.tube(4, 4, 9, 1, True), "shorter than 0.5"),
        (lambda: Mesh.disk(0, 1), r"^Mesh.disk: n must be 1 or more"),
        (lambda: Mesh.torus(6, 1, 2), r"^Mesh.torus: R must be larger than r, 2.0 nm, got 1.0"),
        (lambda: Mesh.schwarz_p(2.5, 1), r"^Mesh.schwarz_p: n must be an integer"),
    ],
)
def test_bad_arguments_are_refused_by_name(call, message):
    with pytest.raises(MeshError, match=message):
        call()
