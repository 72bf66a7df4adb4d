"""Faces of more than three corners: which diagonals split them, and which cannot be split."""

import meshio
import numpy as np
import pytest
from openmmhelfrich._mesh import polygons
from openmmhelfrich.mesh import Mesh, MeshError
from scipy.spatial import ConvexHull, Voronoi
from scipy.spatial.transform import Rotation

CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def written(extension, vertices, faces):
    """A text file of polygons."""
    rows = [" ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    polygon = [f"{len(face)} " + " ".join(map(str, face)) for face in faces]
    if extension == "obj":
        lines = [f"v {row}" for row in rows]
        lines += ["f " + " ".join(f"{corner + 1}/1" for corner in face) for face in faces]
    elif extension == "off":
        lines = ["OFF", f"{len(rows)} {len(faces)} 0", *rows, *(f"{p} 255 0 0" for p in polygon)]
    elif extension == "stl":
        lines = ["solid s"]
        for face in faces:
            lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {rows[k]}" for k in face)]
            lines += ["endloop", "endfacet"]
        lines.append("endsolid s")
    elif extension == "vtk":
        size = sum(len(face) + 1 for face in faces)
        lines = ["# vtk DataFile Version 2.0", "", "ASCII", "DATASET POLYDATA"]
        lines += [f"POINTS {len(rows)} double", *rows, f"POLYGONS {len(faces)} {size}", *polygon]
    else:
        lines = ["ply", "format ascii 1.0", f"element vertex {len(rows)}"]
        lines += [f"property double {axis}" for axis in "xyz"]
        lines += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
        lines += ["end_header", *rows, *polygon]
    return "\n".join(lines) + "\n"


def read(tmp_path, extension, vertices, faces, **options):
    path = tmp_path / f"mesh.{extension}"
    path.write_text(written(extension, vertices, faces))
    return Mesh.read(path, **options)


def split(points, *faces):
    """The triangles, as tuples."""

    def fail(face, reason):
        return ValueError(f"face {face} {reason}")

    points = np.array(points, dtype=float)
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    faces = faces or (range(len(points)),)
    found = polygons.split(points, [list(face) for face in faces], fail)
    return [tuple(triangle) for triangle in found.tolist()]


def cycles(triangles):
    """Triangles without regard to where each one begins."""
    return {min((t, t[1:] + t[:1], t[2:] + t[:2])) for t in triangles}


def double_areas(points, triangles):
    a, b, c = np.moveaxis(np.array(points, dtype=float)[np.array(triangles)], 1, 0)
    return np.cross(b - a, c - a)


# --- Files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("extension", ["obj", "off", "ply", "stl", "vtk"])
def test_a_cube_of_squares(tmp_path, extension):
    with pytest.raises(
        MeshError,
        match=r"face \d has 4 vertices, not 3; read it with triangulate=True, or --triangulate of "
        "'openmm-helfrich mesh', to split it",
    ):
        read(tmp_path, extension, CORNERS, QUADS)
    mesh = read(tmp_path, extension, CORNERS, QUADS, triangulate=True)
    assert (mesh.num_vertices, mesh.num_triangles) == (8, 12)
    assert (mesh.volume, mesh.area) == (pytest.approx(1), pytest.approx(6))
    if extension != "stl":
        # Diagonals are equal, so that each runs from the first corner of its face.
        expected = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]
        assert cycles(map(tuple, mesh.triangles.tolist())) == cycles(expected)


@pytest.mark.parametrize("name", ["mesh.msh", "mesh.vtu", "mesh.inp"])
def test_quads_of_meshio(tmp_path, name):
    path = tmp_path / name
    meshio.Mesh(np.array(CORNERS, float), [("quad", QUADS[:4]), ("quad", QUADS[4:])]).write(path)
    with pytest.raises(MeshError, match=rf"{name}: face 0 has 4 vertices, not 3; .*triangulate="):
        Mesh.read(path)
    assert Mesh.read(path, triangulate=True).volume == pytest.approx(1)


def test_binary_ply(tmp_path):
    path = tmp_path / "mesh.ply"
    header = written("ply", CORNERS, QUADS).split("end_header")[0] + "end_header\n"
    data = header.replace("ascii", "binary_little_endian").encode()
    data += np.array(CORNERS, "<f8").tobytes()
    for face in QUADS:
        data += b"\x04" + np.array(face, "<i4").tobytes()
    path.write_bytes(data)
    with pytest.raises(MeshError, match="face 0 has 4 vertices, not 3; read it with triangulate"):
        Mesh.read(path)
    assert Mesh.read(path, triangulate=True).volume == pytest.approx(1)
    path.write_bytes(data[:-4] + np.array([8], "<i4").tobytes())
    with pytest.raises(MeshError, match=r"mesh.ply: face 5 names vertex 8, but .* 8 vertices"):
        Mesh.read(path, triangulate=True)


def test_a_dual_of_many_polygons(tmp_path):
    """Pentagons to heptagons and more, jittered a little out of their planes, with known volume."""
    sphere = Mesh.random_sphere(100, 10.0, seed=2)
    points = np.random.default_rng(3).normal(size=(100, 3)) * 0.02 + sphere.vertices
    centres = points[sphere.triangles].mean(axis=1)
    faces = []
    for vertex in range(100):
        around = np.flatnonzero((sphere.triangles == vertex).any(axis=1))
        outward = points[vertex] / np.linalg.norm(points[vertex])
        first = np.cross(outward, [0.3, 0.5, 0.9])
        second = np.cross(outward, first)
        angles = np.arctan2(centres[around] @ second, centres[around] @ first)
        faces.append(around[np.argsort(angles)].tolist())
    mesh = read(tmp_path, "obj", centres, faces, triangulate=True)
    assert {len(face) for face in faces} == {5, 6, 7}
    assert mesh.num_triangles == sum(len(face) - 2 for face in faces)
    assert mesh.euler_characteristic == 2
    assert mesh.volume == pytest.approx(ConvexHull(centres).volume, rel=0.01)


# --- Which diagonals ------------------------------------------------------------------------------


def test_a_quadrilateral_is_cut_along_its_shorter_diagonal():
    kite = [(0, 0), (1, 0), (3, 3), (0, 1)]
    assert cycles(split(kite)) == cycles([(0, 1, 3), (1, 2, 3)])
    assert cycles(split(kite, (1, 2, 3, 0))) == cycles([(0, 1, 3), (1, 2, 3)])
    assert cycles(split(kite, (3, 2, 1, 0))) == cycles([(0, 3, 1), (1, 3, 2)])


def test_equal_diagonals_begin_at_the_first_corner_whatever_the_rounding():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    for seed in range(50):
        turn = Rotation.random(random_state=seed).as_matrix()
        assert split(square @ turn.T + seed / 7) == [(0, 1, 2), (0, 2, 3)]


def test_a_concave_quadrilateral_is_cut_inside():
    """The diagonal outside of the arrowhead is the shorter one."""
    arrow = [(0, 0), (2, 1), (0, 2), (0.9, 1)]
    assert np.linalg.norm(np.subtract(arrow[0], arrow[2])) == 2
    arrow = [(0, 0.5), (2, 1), (0, 1.5), (0.5, 1)]
    assert cycles(split(arrow)) == cycles([(0, 1, 3), (1, 2, 3)])


def test_a_corner_on_a_straight_side():
    assert cycles(split([(0, 0), (1, 0), (2, 0), (1, 1)])) == cycles([(0, 1, 3), (1, 2, 3)])
    # As single precision leaves it: the shorter diagonal would make a sliver of 1e-7.
    near = [(0, 0), (1, -1e-7), (2, 0), (1, 5)]
    assert cycles(split(near)) == cycles([(0, 1, 3), (1, 2, 3)])
    hexagon = [(0, 0), (1, 0), (2, 0), (1.5, 1), (1, 2), (0.5, 1)]
    assert len(split(hexagon)) == 4
    assert (double_areas(np.pad(hexagon, ((0, 0), (0, 1))), split(hexagon))[:, 2] > 0.1).all()


def test_a_quadrilateral_that_is_not_flat():
    saddle = [(0, 0, 0.3), (1, 0, -0.3), (1.2, 1.2, 0.3), (0, 1, -0.3)]
    assert cycles(split(saddle)) == cycles([(0, 1, 3), (1, 2, 3)])


@pytest.mark.parametrize("seed", range(12))
def test_random_polygons_keep_their_area_and_their_sense(seed):
    """Star-shaped, mostly concave, turned in space: triangles face one way and add up."""
    random = np.random.default_rng(seed)
    count = random.integers(5, 30)
    angles = np.sort(random.uniform(0, 2 * np.pi, count))
    radii = random.uniform(0.3, 2, count)
    flat = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    if np.diff(np.append(angles, angles[0] + 2 * np.pi)).max() > np.pi:
        pytest.skip("the origin is not inside of this one")
    x, y = flat.T
    expected = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    turn = Rotation.random(random_state=seed).as_matrix()
    points = np.pad(flat, ((0, 0), (0, 1))) @ turn.T
    triangles = split(points)
    assert len(triangles) == count - 2
    areas = double_areas(points, triangles) @ turn[:, 2]
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(expected, rel=1e-12)
    # Every inner edge once in each direction, every outer one once.
    edges = [(t[k], t[(k + 1) % 3]) for t in triangles for k in range(3)]
    assert len(set(edges)) == len(edges)
    assert {e for e in edges if e[::-1] not in edges} == {
        (k, (k + 1) % count) for k in range(count)
    }


def test_triangles_take_the_places_of_their_faces():
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (-1, 0.5), (2, 0.5), (0.5, -1)]
    triangles = split(points, (0, 6, 1), (0, 1, 2, 3, 4), (1, 5, 2), (0, 1, 2, 3))
    assert triangles[0] == (0, 6, 1)
    assert set(sum(triangles[1:4], ())) == {0, 1, 2, 3, 4}
    assert triangles[4] == (1, 5, 2)
    assert triangles[5:] == [(0, 1, 2), (0, 2, 3)]


@pytest.mark.parametrize(("extension", "first"), [("obj", 1), ("off", 0), ("ply", 0), ("stl", 0)])
@pytest.mark.parametrize(
    ("faces", "reason"),
    [
        ((0, 2, 1, 3), "crosses itself or has no area; split it by hand"),
        ((0, 1, 1, 2), r"has vertex 1 twice \(counted from 0\)"),
        ((0, 1, 2, 3, 1), r"has vertex 1 twice"),
        ((0, 3, 5, 7, 0, 2), r"has vertex 0 twice"),
    ],
)
def test_faces_that_cannot_be_split_are_named(tmp_path, extension, first, faces, reason):
    if extension == "stl":
        reason = "face 2 (has vertex|cannot be split)"
    elif "twice" not in reason:
        reason = f"face {2 + first} cannot be split into triangles: .*{reason}"
    else:
        reason = f"face {2 + first} {reason}"
    with pytest.raises(MeshError, match=rf"^Mesh.read: .*mesh.{extension}, line \d+: {reason}"):
        read(tmp_path, extension, CORNERS, [*QUADS[:2], faces, *QUADS[2:]], triangulate=True)


def test_a_polygon_that_crosses_itself_is_refused():
    star = [(np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5)) for k in range(5)]
    with pytest.raises(ValueError, match="face 0 cannot be split"):
        split(star)
    with pytest.raises(ValueError, match="face 0 cannot be split"):
        split([(0, 0), (1, 0), (2, 0), (3, 0), (4, 0)])
    with pytest.raises(ValueError, match="face 0 cannot be split"):
        split([(0, 0), (1, 0), (2, 0), (3, 0)])


def test_voronoi_cells_of_the_plane_are_filled_whole():
    """Convex cells of any number of corners, in both senses of rotation."""
    cells = Voronoi(np.random.default_rng(5).uniform(size=(200, 2)))
    for region in cells.regions:
        if len(region) > 3 and -1 not in region:
            corners = cells.vertices[region]
            area = ConvexHull(corners).volume
            points = np.pad(corners, ((0, 0), (0, 1)))
            found = double_areas(points, split(points))[:, 2]
            assert abs(found.sum()) / 2 == pytest.approx(area, rel=1e-9)
            assert (found > 0).all() or (found < 0).all()


def test_a_vertex_that_is_not_finite_is_named(tmp_path):
    with pytest.raises(MeshError, match=r"vertex 3 \(counted from 0\) .* not finite, .*; correct"):
        read(tmp_path, "off", [*CORNERS[:3], (np.nan, 1, 0), *CORNERS[4:]], QUADS, triangulate=True)
