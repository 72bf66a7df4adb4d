"""Mesh files: formats, precision, other programs' files, and errors that name the line."""

import struct

import meshio
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from openmmhelfrich.mesh import Mesh, MeshError

TEXT = ["ply", "obj", "off", "stl"]
BINARY = ["vtk", "vtu", "msh"]


def facets(mesh):
    """Coordinates of the corners, triangle by triangle, which do not depend on numbering."""
    return mesh.vertices[mesh.triangles]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("meshes")


# --- Round trips ----------------------------------------------------------------------------------


@pytest.mark.parametrize("extension", TEXT + BINARY)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), magnitude=st.integers(-6, 6))
def test_round_trip_keeps_every_bit(folder, pair, extension, seed, magnitude):
    random = np.random.default_rng(seed)
    vertices = (
        pair.vertices + random.normal(scale=0.01, size=pair.vertices.shape)
    ) * 10.0**magnitude
    mesh = Mesh(vertices, pair.triangles)
    path = folder / f"mesh.{extension}"
    mesh.write(path)
    again = Mesh.read(path)
    assert np.array_equal(facets(again), facets(mesh))
    if extension != "stl":
        assert again == mesh


@pytest.mark.parametrize("extension", TEXT + BINARY)
def test_written_files_are_read_by_other_libraries(tmp_path, pair, extension):
    path = tmp_path / f"mesh.{extension.upper()}"
    pair.write(path)
    assert Mesh.read(str(path)).area == pytest.approx(pair.area, rel=1e-14)
    plain = path.rename(tmp_path / f"mesh.{extension}")
    if extension in BINARY:
        other = meshio.read(plain)
        found = other.points[other.cells_dict["triangle"]]
    else:
        other = trimesh.load(plain, process=False)
        found = other.vertices[other.faces]
    assert np.allclose(found, facets(pair), rtol=1e-6)


# --- Files of other programs ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("binary.ply", {"encoding": "binary"}),
        ("ascii.ply", {"encoding": "ascii"}),
        ("normals.ply", {"encoding": "binary", "vertex_normal": True}),
        ("binary.stl", {}),
        ("ascii.stl", {"file_type": "stl_ascii"}),
        ("mesh.obj", {}),
        ("mesh.off", {}),
        ("mesh.glb", {}),
    ],
)
def test_files_of_trimesh(tmp_path, pair, name, options):
    path = tmp_path / name
    trimesh.Trimesh(pair.vertices, pair.triangles, process=False).export(path, **options)
    mesh = Mesh.read(path)
    assert mesh.num_vertices == pair.num_vertices
    assert np.allclose(facets(mesh), facets(pair), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("binary.ply", {"binary": True}),
        ("ascii.ply", {"binary": False}),
        ("binary.stl", {"binary": True}),
        ("ascii.stl", {"binary": False}),
        ("mesh.obj", {}),
        ("mesh.off", {}),
        ("ascii.vtk", {"binary": False}),
        ("old.vtk", {"file_format": "vtk42"}),
        ("ascii.vtu", {"binary": False}),
        ("ascii.msh", {"file_format": "gmsh", "binary": False}),
        ("old.msh", {"file_format": "gmsh22"}),
        ("mesh.inp", {}),
    ],
)
def test_files_of_meshio(tmp_path, lumpy, name, options):
    path = tmp_path / name
    meshio.Mesh(lumpy.vertices, [("triangle", lumpy.triangles)]).write(path, **options)
    mesh = Mesh.read(path)
    assert mesh.num_vertices == lumpy.num_vertices
    assert np.allclose(facets(mesh), facets(lumpy), rtol=1e-6, atol=1e-6)


def test_every_digit_of_the_papers_files_is_read(shared):
    """They declare single precision, and some print more than that."""
    more = []
    for path in sorted((shared / "vcm").glob("*.ply")):
        lines = path.read_text().splitlines()
        start = lines.index("end_header") + 1
        mesh = Mesh.read(path)
        expected = [line.split() for line in lines[start : start + mesh.num_vertices]]
        assert np.array_equal(mesh.vertices, np.array(expected, dtype=float))
        if not np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32)):
            more.append(path.stem)
    assert "USphere_1002d_r_s0" in more


@pytest.mark.parametrize("order", ["<", ">"])
def test_binary_ply_with_more_than_it_needs(tmp_path, lumpy, order):
    """Extra elements, scalars before the corners and a second list, in both byte orders."""
    endian = {"<": "little", ">": "big"}[order]
    header = f"""ply
format binary_{endian}_endian 1.0
comment made by hand
element vertex {lumpy.num_vertices}
property uchar red
property double z
property double y
property double x
element camera 2
property float angle
element face {lumpy.num_triangles}
property short material
property list uchar float texture
property list ushort uint vertex_index
element strip 1
property list int int vertex_indices
end_header
"""
    data = header.encode()
    for x, y, z in lumpy.vertices:
        data += struct.pack(order + "Bddd", 10, z, y, x)
    data += struct.pack(order + "ff", 1.5, 2.5)
    for number, corners in enumerate(lumpy.triangles):
        data += struct.pack(order + "hBff", number, 2, 0.5, 0.25)
        data += struct.pack(order + "HIII", 3, *corners)
    data += struct.pack(order + "iiiii", 4, 0, 1, 2, 3)
    path = tmp_path / "mesh.ply"
    path.write_bytes(data)
    assert Mesh.read(path) == lumpy
    path.write_bytes(data[:-7])
    with pytest.raises(
        MeshError, match=r"line 17: vertex_indices of strip 0 needs 16 bytes .*only 9"
    ):
        Mesh.read(path)
    path.write_bytes(data[:1000])
    with pytest.raises(MeshError, match=r"element vertex \(42 of them\) needs 1050 bytes"):
        Mesh.read(path)
    path.write_bytes(data + b"\n")
    with pytest.raises(MeshError, match="do the counts in the header fit"):
        Mesh.read(path)


def test_ascii_ply_with_more_than_it_needs(tmp_path):
    """Normals, another element, and a scalar and a list before the corners of a face."""
    path = tmp_path / "mesh.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nobj_info by hand\nelement edge 1\nproperty int a\nproperty int b\n"
        "element vertex 4\nproperty float nx\nproperty double z\nproperty double x\n"
        "property double y\nelement face 4\nproperty int material\n"
        "property list uchar float texture\nproperty list uchar int vertex_index\n"
        "property uchar red\nend_header\n0 1\n9 0 0 0\n9 0 1 0\n9 0 0 1\n9 1 0 0\n"
        "7 2 0.5 0.5 3 0 2 1 255\n7 0 3 0 1 3 255\n7 1 0.5 3 1 2 3 255\n7 0 3 2 0 3 255\n"
    )
    mesh = Mesh.read(path)
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert mesh.triangles.tolist() == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def test_gmsh_points_and_lines_are_ignored(tmp_path, lumpy):
    """A Gmsh model keeps its construction points, such as the centre of a sphere."""
    n = lumpy.num_vertices
    points = np.concatenate([[[0.4, -0.2, 0.9]], lumpy.vertices])
    cells = [
        ("vertex", [[0], [5]]),
        ("line", [[3, 4]]),
        ("triangle", lumpy.triangles + 1),
    ]
    path = tmp_path / "model.msh"
    meshio.Mesh(points, cells).write(path, file_format="gmsh22")
    mesh = Mesh.read(path)
    assert mesh.num_vertices == n
    assert np.array_equal(facets(mesh), facets(lumpy))


def test_obj_corners_with_slashes_and_backward_numbers(tmp_path):
    path = tmp_path / "mesh.obj"
    path.write_text(
        "# a tetrahedron\nmtllib x.mtl\no thing\r\n"
        "v 0 0 0 1.0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 3/1/1 2/1/1\n"
        "v 0 0 1 # the top\nf -4 -3 -1\nf 2//1 3//1 4//1\nusemtl y\nf 3/1 1/1 4/1\n"
    )
    mesh = Mesh.read(path)
    assert mesh.triangles.tolist() == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    assert mesh.volume == pytest.approx(1 / 6, rel=1e-15)


def test_off_with_colours_and_comments(tmp_path):
    path = tmp_path / "mesh.off"
    path.write_text(
        "COFF 4 4 6  # counts on the first line\n\n0 0 0 255 0 0\n1 0 0 255 0 0\n# no vertex\n"
        "0 1 0 255 0 0\n0 0 1 255 0 0\n3 0 2 1 0.5\n3 0 1 3\n3 1 2 3\n3 2 0 3 255 255 0\n"
    )
    assert Mesh.read(path).volume == pytest.approx(1 / 6, rel=1e-15)


# --- Broken files ---------------------------------------------------------------------------------

PLY = """ply
format ascii 1.0
comment a tetrahedron
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar uint vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
"""
OBJ = "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
OFF = (
    "OFF\n# a tetrahedron\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
)
STL = "solid s\n" + "".join(
    "facet normal 0 0 0\nouter loop\n"
    + "".join(
        f"vertex {'1 0 0' if k == 1 else '0 1 0' if k == 2 else f'0 0 {k // 3}'}\n" for k in t
    )
    + "endloop\nendfacet\n"
    for t in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
)
STL += "endsolid s\n"


def lines(text, *kept):
    return "\n".join(text.splitlines()[slice(*kept)]) + "\n"


BROKEN = [
    ("ply", lines(PLY, 16), 16, "ends here, where face 2 of 4 should follow"),
    ("ply", lines(PLY, 12), 12, "ends here, where vertex 2 of 4"),
    ("ply", lines(PLY, 6), 6, "ends here, where the rest of the header"),
    ("ply", PLY[: PLY.index("1 3\n3 1") + 1], 16, "face 1 needs 3 vertex indices, got 2"),
    ("ply", PLY.replace("1 0 0", "1 0"), 12, r"vertex 1 needs 3 numbers \(x y z\), got 2"),
    ("ply", PLY.replace("1 0 0", "1 O 0"), 12, "vertex 1 needs 3 coordinates, got '1 O 0'"),
    ("ply", PLY.replace("3 1 2 3", "3 1 2 7"), 17, "face 2 names vertex 7, but .* 4 vertices"),
    ("ply", PLY.replace("3 1 2 3", "3 1 2 -3"), 17, "face 2 names vertex -3"),
    ("ply", PLY.replace("3 1 2 3", "3 1 2 x"), 17, "a vertex index of face 2 must be an integer"),
    (
        "ply",
        PLY.replace("3 1 2 3", "4 1 2 3 0"),
        17,
        "face 2 has 4 vertices, not 3; read it with triangulate=True",
    ),
    ("ply", PLY.replace("vertex 4", "vertex 5"), 15, "vertex 4 needs 3 numbers"),
    ("ply", PLY.replace("face 4", "face 3"), 18, "expected the end of the file, got '3 2 0 3'"),
    ("ply", PLY.replace("face 4", "face four"), 8, "'face' must be an integer, got 'four'"),
    ("ply", PLY.replace("vertex 4", "vertex -4"), 4, "number of elements 'vertex' is -4"),
    ("ply", PLY.replace("float y", "real y"), 6, "unknown type 'real'"),
    ("ply", PLY.replace("float z", "float w"), 10, "vertices need the scalars x, y and z"),
    ("ply", PLY.replace("element face 4", "element edge 4"), 10, "without an element 'face'"),
    ("ply", PLY.replace("vertex_indices", "texture"), 10, "faces need a list vertex_indices"),
    ("ply", PLY.replace("element", "elephant"), 4, "expected an element or property"),
    ("ply", PLY.replace("ascii", "utf8"), 2, "expected 'format ascii 1.0'"),
    ("ply", OFF, 1, "starts with a line 'ply'"),
    ("ply", "", 1, "starts with a line 'ply'"),
    ("obj", lines(OBJ, 5) + "f 1 3\n", 6, "face 1 has 2 vertices; a face needs 3"),
    (
        "obj",
        OBJ.replace("f 1 2 4", "f 1 2 4 3"),
        7,
        "face 2 has 4 vertices, not 3; read it with triangulate=True",
    ),
    ("obj", OBJ.replace("f 1 2 4", "f 1 2 5"), 7, "face 2 names vertex 5, .*counted from 1"),
    ("obj", OBJ.replace("f 1 2 4", "f 0 2 4"), 7, "face 2 names vertex 0"),
    ("obj", OBJ.replace("f 1 2 4", "f a 2 4"), 7, "a vertex index of face 2 must be an integer"),
    ("obj", OBJ.replace("v 0 1 0", "v 0 1"), 4, "vertex 3 needs 3 coordinates, got '0 1'"),
    ("obj", OBJ.replace("v 0 1 0", "v 0 , 1"), 4, "vertex 3 needs 3 coordinates"),
    ("obj", lines(OBJ, 5), 5, "ends without a face"),
    ("obj", "\0\1\2 binary", 1, "expected text"),
    ("off", lines(OFF, 9), 9, "ends here, where face 2 of 4"),
    ("off", lines(OFF, 5), 5, "ends here, where vertex 2 of 4"),
    ("off", OFF.replace("0 1 0", "0 1"), 6, "vertex 2 needs 3 coordinates, got '0 1'"),
    ("off", OFF.replace("3 0 1 3", "4 0 1 3 2"), 9, "face 1 has 4 vertices, not 3"),
    ("off", OFF.replace("3 0 1 3", "3 0 1 4"), 9, "face 1 names vertex 4"),
    ("off", OFF.replace("4 4 6", "4"), 3, "expected the numbers of vertices, faces and edges"),
    ("off", OFF.replace("4 4 6", "4 3 6"), 11, "expected the end of the file"),
    ("off", OFF.replace("4 4 6", "4 x 6"), 3, "number of faces must be an integer, got 'x'"),
    ("off", OFF.replace("OFF", "OFF BINARY"), 1, "binary OFF"),
    ("off", PLY, 1, "starts with 'OFF', got 'ply'"),
    ("stl", lines(STL, 22), 22, "ends here without 'endsolid'"),
    ("stl", lines(STL, 20), 20, "ends here, where the rest of facet 2"),
    ("stl", STL.replace("vertex 1 0 0", "vertex 1 0", 1), 6, "a vertex of facet 0 needs 3"),
    ("stl", STL.replace("vertex 1 0 0\n", "", 1), 6, "face 0 has 2 vertices; a face needs 3"),
    ("stl", STL.replace("endfacet", "end", 1), 8, "expected 'endfacet', got 'end'"),
    ("stl", STL.replace("facet normal", "face normal", 1), 2, "expected 'facet' or 'endsolid'"),
    ("stl", "not a solid", 1, "an ASCII STL file starts with 'solid', got 'not a solid'"),
    ("stl", "not\0a solid", 1, "not an STL file.*has 11 bytes"),
]


@pytest.mark.parametrize(("extension", "text", "line", "message"), BROKEN)
def test_broken_text_is_reported_with_its_line(tmp_path, extension, text, line, message):
    path = tmp_path / f"broken.{extension}"
    path.write_bytes(text.encode())
    with pytest.raises(MeshError, match=message) as caught:
        Mesh.read(path)
    assert str(caught.value).startswith(f"Mesh.read: {path}, line {line}: ")


@pytest.mark.parametrize(
    ("extension", "text"), [("ply", PLY), ("obj", OBJ), ("off", OFF), ("stl", STL)]
)
def test_the_unbroken_text_is_read(tmp_path, extension, text):
    """So that the cases above fail for the reason that they name, with either end of line."""
    path = tmp_path / f"whole.{extension}"
    for content in (text, text.replace("\n", "\r\n"), text.rstrip("\n")):
        path.write_bytes(content.encode())
        assert Mesh.read(path).volume == pytest.approx(1 / 6, rel=1e-15)


@pytest.mark.parametrize("extension", TEXT + BINARY)
def test_a_file_cut_anywhere_is_refused(tmp_path, lumpy, extension):
    whole = tmp_path / f"whole.{extension}"
    lumpy.write(whole)
    data = whole.read_bytes()
    path = tmp_path / f"cut.{extension}"
    refused = 0
    # The last few bytes can be a closing tag or the end of a comment, which nobody misses.
    for length in np.linspace(0, 0.97 * len(data), 25, dtype=int):
        path.write_bytes(data[:length])
        with pytest.raises(MeshError, match=r"^Mesh.read: .*cut"):
            Mesh.read(path)
        refused += 1
    assert refused == 25


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("mesh.vtk", {"binary": False}),
        ("mesh.vtu", {"binary": False}),
        ("mesh.msh", {"file_format": "gmsh", "binary": False}),
    ],
)
def test_truncated_ascii_of_meshio_is_reported_with_its_line(tmp_path, lumpy, name, options):
    path = tmp_path / name
    meshio.Mesh(lumpy.vertices, [("triangle", lumpy.triangles)]).write(path, **options)
    content = path.read_text().splitlines(keepends=True)
    kept = len(content) // 2
    path.write_text("".join(content[:kept]))
    with pytest.raises(MeshError, match=rf"^Mesh.read: .*{name}, line ({kept}|{kept + 1}): "):
        Mesh.read(path)


def test_truncated_binary_stl_says_how_many_bytes_were_expected(tmp_path, lumpy):
    path = tmp_path / "mesh.stl"
    trimesh.Trimesh(lumpy.vertices, lumpy.triangles, process=False).export(path)
    whole = path.read_bytes()
    assert len(whole) == 84 + 80 * 50
    path.write_bytes(whole[:3000])
    with pytest.raises(MeshError, match=r"4084 bytes for the 80 facets .*has 3000 bytes"):
        Mesh.read(path)


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ([("quad", [[0, 1, 2, 3]])], "face 0 has 4 vertices, not 3; .*--triangulate"),
        (
            [("tetra", [[0, 1, 2, 3]])],
            r"cell of type 'tetrahedron' on vertices \[0, 1, 2, 3\].*extract the surface",
        ),
        ([("vertex", [[0]])], "no triangles"),
    ],
)
def test_other_cells_are_refused(tmp_path, cells, message):
    path = tmp_path / "mesh.vtu"
    meshio.Mesh(np.random.default_rng(1).normal(size=(4, 3)), cells).write(path)
    with pytest.raises(MeshError, match=f"^Mesh.read: .*mesh.vtu: .*{message}"):
        Mesh.read(path)


def test_an_invalid_mesh_is_reported_with_its_file(tmp_path):
    path = tmp_path / "open.off"
    path.write_text(lines(OFF.replace("4 4 6", "4 1 6"), 8))
    with pytest.raises(
        MeshError, match=r"^Mesh.read: .*open.off: vertex \d belongs to no triangle"
    ):
        Mesh.read(path)


def test_missing_files_and_unknown_formats(tmp_path, lumpy):
    with pytest.raises(FileNotFoundError, match=r"there is no file .*nowhere.ply"):
        Mesh.read(tmp_path / "nowhere.ply")
    with pytest.raises(MeshError, match="is not a file"):
        Mesh.read(tmp_path)
    path = tmp_path / "mesh.doc"
    path.write_text(PLY)
    with pytest.raises(
        MeshError,
        match=r"known are .ply, .obj, .stl, .off, .vtk, .vtp, .vtu, .msh, "
        r"and what else meshio and trimesh read(\n|$)",
    ):
        Mesh.read(path)
    with pytest.raises(MeshError, match=r"^Mesh.write: .*'.doc'; known are .*\.msh, .*\.vtu"):
        lumpy.write(path)
    assert path.read_text() == PLY
    with pytest.raises(FileNotFoundError):
        lumpy.write(tmp_path / "nowhere" / "mesh.ply")


def test_meshio_prints_nothing(tmp_path, lumpy, capfd):
    """It remarks on missing tags when writing, and prints errors besides raising them."""
    for extension in BINARY:
        path = tmp_path / f"mesh.{extension}"
        lumpy.write(path)
        Mesh.read(path)
        path.write_bytes(b"nonsense")
        with pytest.raises(MeshError):
            Mesh.read(path)
    captured = capfd.readouterr()
    assert captured.out + captured.err == ""
