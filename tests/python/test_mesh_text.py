"""Text as other programs leave it: marks, ends of lines, strange words, near vertices."""

import numpy as np
import pytest
from openmmhelfrich.mesh import Mesh, MeshError

MARK = b"\xef\xbb\xbf"
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
# Two triangles for each side of the unit cube, counter-clockwise seen from outside.
CUBE = np.array(
    [
        triangle
        for a, b, c, d in (
            *((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4)),
            *((2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)),
        )
        for triangle in ((a, b, c), (a, c, d))
    ]
)


def written(extension, vertices=CORNERS, triangles=CUBE):
    """A file of the format by hand, ten digits."""
    rows = [" ".join(f"{x:.10g}" for x in vertex) for vertex in vertices]
    n, t = len(rows), len(triangles)
    if extension == "obj":
        lines = [f"v {row}" for row in rows]
        lines += ["f {} {} {}".format(*(corner + 1 for corner in face)) for face in triangles]
    elif extension == "stl":
        lines = ["solid cube"]
        for face in triangles:
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += [f"vertex {rows[corner]}" for corner in face] + ["endloop", "endfacet"]
        lines.append("endsolid cube")
    else:
        lines = ["OFF", f"{n} {t} 0"]
        if extension == "ply":
            lines = ["ply", "format ascii 1.0", f"element vertex {n}"]
            lines += [f"property float {axis}" for axis in "xyz"]
            lines += [f"element face {t}", "property list uchar int vertex_indices", "end_header"]
        elif extension == "vtk":
            lines = ["# vtk DataFile Version 3.0", "cube", "ASCII", "DATASET POLYDATA"]
            lines += [f"POINTS {n} float"]
        faces = ["3 {} {} {}".format(*face) for face in triangles]
        lines += rows + ([f"POLYGONS {t} {4 * t}"] if extension == "vtk" else []) + faces
    if extension == "msh":
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(n)]
        lines += [f"{k} {row}" for k, row in enumerate(rows, start=1)]
        lines += ["$EndNodes", "$Elements", str(t)]
        lines += [
            "{} 2 0 {} {} {}".format(k, *(corner + 1 for corner in face))
            for k, face in enumerate(triangles, start=1)
        ]
        lines += ["$EndElements"]
    return ("\n".join(lines) + "\n").encode()


FORMATS = ["obj", "ply", "off", "stl", "vtk", "msh"]
INDEXED = [extension for extension in FORMATS if extension != "stl"]


def read(tmp_path, extension, data, **options):
    path = tmp_path / f"cube.{extension}"
    path.write_bytes(data)
    return Mesh.read(path, **options)


# --- Byte-order marks and ends of lines -----------------------------------------------------------


@pytest.mark.parametrize("extension", FORMATS)
@pytest.mark.parametrize("mark", [b"", MARK])
@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_marks_and_ends_of_lines_change_nothing(tmp_path, extension, mark, end):
    if extension == "msh" and end == b"\r":
        pytest.skip("Gmsh's files are meshio's, which knows the two usual ends of lines")
    mesh = read(tmp_path, extension, mark + written(extension).replace(b"\n", end))
    assert (mesh.num_vertices, mesh.num_triangles) == (8, 12)
    assert mesh.volume == pytest.approx(1, rel=1e-15)
    assert mesh.area == pytest.approx(6, rel=1e-15)
    if extension != "stl":
        assert mesh.vertices.tolist() == [list(map(float, corner)) for corner in CORNERS]


@pytest.mark.parametrize("extension", INDEXED)
@pytest.mark.parametrize("mark", [b"", MARK])
def test_a_mark_does_not_shift_the_vertices(tmp_path, extension, mark):
    """A lost first vertex and a ninth one at (5, 5, 5) made an area of 30.25, and no error."""
    data = mark + written(extension, [*CORNERS, (5, 5, 5)])
    with pytest.raises(MeshError, match=r"vertex 8 belongs to no triangle.*drop_unused=True"):
        read(tmp_path, extension, data)
    mesh = read(tmp_path, extension, data, drop_unused=True)
    assert (mesh.num_vertices, mesh.area, mesh.volume) == (8, pytest.approx(6), pytest.approx(1))


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
@pytest.mark.parametrize("mark", [b"", MARK])
def test_binary_ply_after_any_end_of_line(tmp_path, order, end, mark):
    """The first byte of the data is a line feed, which is not the end of a carriage return."""
    kind = {"little": "<", "big": ">"}[order]
    corners = np.array(CORNERS, dtype=float)
    corners[0, 0] = np.frombuffer(b"\n" * 8, "f8")[0]
    header = written("ply").decode().partition("end_header")[0] + "end_header\n"
    header = header.replace("float", "double").replace("ascii", f"binary_{order}_endian")
    data = mark + header.encode().replace(b"\n", end) + corners.astype(kind + "f8").tobytes()
    for face in CUBE:
        data += b"\x03" + face.astype(kind + "i4").tobytes()
    assert b"end_header" + end + b"\n\n" in data
    mesh = read(tmp_path, "ply", data)
    assert np.array_equal(mesh.vertices, corners)


@pytest.mark.parametrize("codec", ["utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("extension", ["obj", "ply", "off", "vtk"])
def test_utf16_is_refused_by_name(tmp_path, extension, codec):
    text = "\ufeff" + written(extension).decode()
    with pytest.raises(MeshError, match=r"cube.*, line 1: the file is text in UTF-16; save it as"):
        read(tmp_path, extension, text.encode(codec))


def test_text_that_is_no_stl_is_not_counted_as_facets(tmp_path):
    with pytest.raises(MeshError, match="line 1: an ASCII STL file starts with 'solid', got '# a"):
        read(tmp_path, "stl", MARK + b"# a comment\n" + written("stl"))


def test_a_binary_stl_may_begin_with_any_bytes(tmp_path):
    facets = np.zeros(12, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("a", "<u2")])
    facets["corners"] = np.array(CORNERS)[CUBE]
    for head in (MARK, b"\xff\xfe", b"solid"):
        data = head.ljust(80, b"\0") + (12).to_bytes(4, "little") + facets.tobytes()
        assert read(tmp_path, "stl", data).volume == pytest.approx(1, rel=1e-6)


# --- Words of OBJ files ---------------------------------------------------------------------------


def test_every_known_word_of_an_obj_is_skipped(tmp_path):
    extra = (
        "mtllib a.mtl\no thing\ng a b\ns off\nusemtl red\nvn 0 0 1\nvt 0 0\nvp 0 0\nl 1 2\np 3\n"
        "mg off\nbevel on\nc_interp off\nd_interp off\nlod 3\nusemap off\nmaplib a\nshadow_obj x\n"
        "trace_obj x\n# v 9 9 9\n"
    )
    mesh = read(tmp_path, "obj", extra.encode() + written("obj"))
    assert (mesh.num_vertices, mesh.num_triangles) == (8, 12)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("V 5 5 5", "cannot begin with 'V'"),
        ("vertex 5 5 5", "cannot begin with 'vertex'"),
        ("5 5 5", "cannot begin with '5'"),
        ("\ufeffv 5 5 5", r"cannot begin with '.ufeffv'"),
        ("surf 0 1 0 1 1 2 3 4", "curved surfaces .'surf'. cannot be read; convert"),
        ("call other.obj", "other files are not read .'call other.obj'.; put them in here"),
    ],
)
def test_other_words_of_an_obj_are_refused(tmp_path, line, message):
    rows = written("obj").decode().splitlines()
    rows.insert(3, line)
    with pytest.raises(MeshError, match=rf"cube.obj, line 4: .*{message}"):
        read(tmp_path, "obj", "\n".join(rows).encode())


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_an_obj_line_goes_on_after_a_backslash(tmp_path, end):
    text = written("obj").decode()
    text = text.replace("v 0 0 0", "v 0 \\\n 0\\\n\t0").replace("f 1 3 4", "f 1 \\\n3 \\  \n4")
    assert text.count("\\") == 4
    mesh = read(tmp_path, "obj", text.replace("\n", end).encode())
    assert mesh == read(tmp_path, "obj", written("obj"))
    with pytest.raises(MeshError, match="the file ends here, where the rest of a continued line"):
        read(tmp_path, "obj", written("obj") + b"f 1 2 \\\n")
    broken = text.replace("v 0 0 1", "v x 0 1").encode()
    with pytest.raises(MeshError, match="line 7: vertex 5 needs 3 coordinates, got 'x 0 1'"):
        read(tmp_path, "obj", broken)


# --- Vertices that nearly coincide ----------------------------------------------------------------


def torn(gap):
    """The cube with the vertices of every triangle of its own, up to `gap` apart."""
    shifts = np.linspace(-gap / 2, gap / 2, 36).reshape(12, 3, 1) * [1, 0, 0]
    return (np.array(CORNERS)[CUBE] + shifts).reshape(-1, 3), np.arange(36).reshape(12, 3)


@pytest.mark.parametrize("extension", FORMATS)
def test_near_vertices_are_merged_or_hinted_at(tmp_path, extension):
    data = written(extension, *torn(1e-7))
    with pytest.raises(
        MeshError, match=r"mesh is open, with 12 border.*; .*nearly coincide"
    ) as caught:
        read(tmp_path, extension, data)
    hint = str(caught.value)
    assert "pair(s) of vertices nearly coincide, such as " in hint
    assert "e-08 nm apart: merge=2e-07 (--merge 2e-07) joins them" in hint
    for merge in (2e-7, 0.4):
        mesh = read(tmp_path, extension, data, merge=merge)
        assert (mesh.num_vertices, mesh.num_triangles) == (8, 12)
        assert mesh.volume == pytest.approx(1, abs=1e-6)
    # The first one in the file stays where it is.
    assert mesh.vertices[0].tolist() == [pytest.approx(-5e-8, abs=1e-12), 0, 0]
    with pytest.raises(MeshError, match="nearly coincide"):
        read(tmp_path, extension, data, merge=1e-9)


def test_chains_of_near_vertices_become_one(tmp_path):
    """Corners at 0, 6e-8 and 12e-8: the first and the last are joined by the one between."""
    vertices, triangles = torn(0)
    at_origin = np.flatnonzero((vertices == 0).all(axis=1))
    vertices[at_origin, 2] += 6e-8 * np.arange(len(at_origin))
    data = written("obj", vertices, triangles)
    assert read(tmp_path, "obj", data, merge=7e-8).num_vertices == 8
    with pytest.raises(MeshError, match="nearly coincide"):
        read(tmp_path, "obj", data, merge=5e-8)


def test_equal_vertices_are_merged_at_no_distance(tmp_path):
    data = written("off", *torn(0))
    with pytest.raises(MeshError, match=r"0 nm apart: merge=0 \(--merge 0\)"):
        read(tmp_path, "off", data)
    mesh = read(tmp_path, "off", data, merge=0)
    assert mesh.num_vertices == 8
    # By first appearance in the file.
    assert mesh.vertices[:4].tolist() == [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]


def test_a_distance_that_would_join_corners_is_refused(tmp_path):
    data = written("ply")
    with pytest.raises(
        MeshError,
        match=r"^Mesh.read: .*cube.ply: merge=1 joins two corners of triangle 0, vertices 0 and 2, "
        "1 nm apart; take a smaller distance",
    ):
        read(tmp_path, "ply", data, merge=1)
    assert read(tmp_path, "ply", data, merge=0.9).num_vertices == 8
    for merge, message in ((-1, "must be one finite number, 0 or more"), ("a", "merge")):
        with pytest.raises((MeshError, TypeError), match=message):
            read(tmp_path, "ply", data, merge=merge)


def test_distances_of_the_size_of_the_mesh_do_not_fill_the_memory(tmp_path):
    """Of 40 962 vertices there are 839 million pairs."""
    sphere = Mesh.icosphere(64, 1.0)
    path = tmp_path / "sphere.vtk"
    sphere.write(path, binary=True)
    with pytest.raises(MeshError, match="merge=3 joins more than 100 vertices with each; take"):
        Mesh.read(path, merge=3)
    data = path.read_bytes()
    # One vertex far away makes the mean edge long, and a lost triangle the mesh invalid.
    far = np.array([1e9, 0, 0], ">f8").tobytes()
    at = data.index(b"double\n") + len(b"double\n")
    broken = data[:at] + far + data[at + 24 :]
    path.write_bytes(broken.replace(np.array([3, 0], ">i4").tobytes(), b"\0\0\0\3\0\0\0\1", 1))
    with pytest.raises(MeshError, match=r"(?s)^Mesh.read: ((?!nearly coincide).)*$"):
        Mesh.read(path)


def test_no_hint_where_it_would_not_help(tmp_path):
    with pytest.raises(MeshError, match=r"vertex 8 belongs to no triangle; remove it; [^;]*$"):
        read(tmp_path, "off", written("off", [*CORNERS, (5, 5, 5)]))


def test_borders_that_are_none_are_told_from_holes(tmp_path):
    hole = read(tmp_path, "off", written("off", CORNERS, CUBE[:-1]))
    assert [len(loop) for loop in hole.border_loops] == [3]
    # Without a triangle of its own corners a cube of separate sheets has a crack all round each.
    data = written("off", *torn(1e-7))
    assert len(read(tmp_path, "off", data, merge=0).border_loops) == 12
