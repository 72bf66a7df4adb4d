"""VTK's files, legacy and XML: by hand, by VTK itself as ParaView writes them, and ours."""

import base64
import itertools
import lzma
import struct
import sys
import zlib

import lz4.block
import meshio
import numpy as np
import pytest
from openmmhelfrich.mesh import Mesh, MeshError

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.5]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
VOLUME = 0.25


def read(tmp_path, name, data, **options):
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return Mesh.read(path, **options)


# --- Legacy files by hand -------------------------------------------------------------------------

LEGACY = """# vtk DataFile Version 4.2
a tetrahedron
ASCII
DATASET POLYDATA
FIELD FieldData 1
TimeValue 1 1 double
0.5
METADATA
INFORMATION 0

POINTS 5 float
0 0 0 1 0 0 0 1 0
0 0 1.5 7 7 7
METADATA
INFORMATION 1
NAME L2_NORM_RANGE LOCATION vtkDataArray
DATA 2 0 1.5

VERTICES 1 2
1 4
POLYGONS 2 8
3 0 2 1
3 0 1 3
TRIANGLE_STRIPS 1 5
4 1 2 3 0
CELL_DATA 4
SCALARS anything float
1 2 3 4
"""
# The second layout of cells, of version 5.
OFFSETS = LEGACY.replace("Version 4.2", "Version 5.1")
OFFSETS = OFFSETS.replace(
    "VERTICES 1 2\n1 4\n",
    "VERTICES 2 1\nOFFSETS vtktypeint64\n0 1\nCONNECTIVITY vtktypeint64\n4\n",
)
OFFSETS = OFFSETS.replace(
    "POLYGONS 2 8\n3 0 2 1\n3 0 1 3\n",
    "POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 2 1\n0 1 3\n",
)
OFFSETS = OFFSETS.replace(
    "TRIANGLE_STRIPS 1 5\n4 1 2 3 0\n",
    "TRIANGLE_STRIPS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n1 2 3 0\n",
)


@pytest.mark.parametrize("text", [LEGACY, OFFSETS, LEGACY.replace("\n", "\r\n")])
def test_polydata(tmp_path, text):
    """A vertex cell of its own is left out; a strip is two triangles, the second one turned."""
    mesh = read(tmp_path, "mesh.vtk", text)
    assert np.array_equal(mesh.vertices, TETRAHEDRON)
    assert mesh.triangles.tolist() == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [3, 2, 0]]
    assert mesh.volume == pytest.approx(VOLUME, rel=1e-15)


def binary(kind, offsets):
    """LEGACY as binary, with points of a kind."""
    data = f"# vtk DataFile Version {'5.1' if offsets else '3.0'}\n\nBINARY\nDATASET POLYDATA\n"
    data += f"FIELD FieldData 1\nTimeValue 1 1 double\n{'{}'}\nPOINTS 4 {kind}\n"
    head, _, tail = data.partition("{}")
    # A number whose bytes look like the end of a line and a keyword.
    data = head.encode() + b"\nMETADAT" + tail.encode()
    data += TETRAHEDRON.astype({"float": ">f4", "double": ">f8"}[kind]).tobytes()
    if offsets:
        data += b"\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n" + np.arange(0, 15, 3, ">i8").tobytes()
        return data + b"\nCONNECTIVITY vtktypeint64\n" + FACES.astype(">i8").tobytes() + b"\n"
    cells = np.insert(FACES, 0, 3, axis=1).astype(">i4")
    return data + b"\nPOLYGONS 4 16\n" + cells.tobytes() + b"\n"


@pytest.mark.parametrize("kind", ["float", "double"])
@pytest.mark.parametrize("offsets", [False, True])
def test_binary_polydata(tmp_path, kind, offsets):
    data = binary(kind, offsets)
    mesh = read(tmp_path, "mesh.vtk", data)
    assert np.array_equal(mesh.vertices, TETRAHEDRON)
    assert np.array_equal(mesh.triangles, FACES)
    # In the last array, after the points, and among them.
    after = data.index(b"\nPOLYGONS")
    for length in (len(data) - 10, after, after - 30):
        with pytest.raises(MeshError, match=r"mesh.vtk, line \d+: .*is (it|the file) truncated"):
            read(tmp_path, "mesh.vtk", data[:length])


def test_other_cells_of_a_grid(tmp_path):
    """Pixels have their last corners the other way round; lines do not matter."""
    text = (
        "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n"
        "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 2\n1 0 2\n0 1 2\n1 1 2\n5 5 5\nCELLS 7 33\n"
        "4 0 2 3 1\n4 4 5 6 7\n4 0 1 4 5\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n2 8 0\n"
        "CELL_TYPES 7\n9 8 8 7 9 9 3\n"
    )
    with pytest.raises(MeshError, match=r"mesh.vtk: face 0 has 4 vertices, not 3; read it with"):
        read(tmp_path, "mesh.vtk", text)
    mesh = read(tmp_path, "mesh.vtk", text, triangulate=True)
    assert (mesh.num_vertices, mesh.num_triangles) == (8, 12)
    assert mesh.volume == pytest.approx(2, rel=1e-15)
    with pytest.raises(MeshError, match=r"cell of type 'tetrahedron' on vertices \[4, 5, 6, 7\]"):
        read(tmp_path, "mesh.vtk", text.replace("9 8 8 7", "9 10 8 7"), triangulate=True)


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("# vtk DataFile Version 4.2", "VTK", 1, "starts with '# vtk DataFile Version', got 'VTK'"),
        ("Version 4.2", "Version x", 1, "expected the version of VTK files"),
        ("ASCII", "TEXT", 3, "expected 'ASCII' or 'BINARY', got 'TEXT'"),
        ("POLYDATA", "RECTILINEAR_GRID", 4, "'DATASET UNSTRUCTURED_GRID', got .*extract the surf"),
        ("1 1 double", "1 1 string", 6, "an array of numbers of a field, got 'TimeValue 1 1 strin"),
        ("POINTS 5 float", "POINTS 5 real", 11, "unknown type 'real' of 5 points"),
        ("POINTS 5 float", "POINTS 5", 11, "expected 3 words, got 'POINTS 5'"),
        ("POINTS 5 float", "POINTS -5 float", 11, "the number after POINTS is -5"),
        ("0 0 1.5 7 7 7", "0 0 1.5 7 7", 14, "expected numbers of 5 points, got 'METADATA'"),
        ("0 0 1.5 7 7 7", "0 0 1.5 7 7 7 7", 13, "5 points need 15 numbers, but more are here"),
        ("0 0 1.5 7 7 7", "0 0 O.5 7 7 7", 13, "expected numbers of 5 points, got '0 0 O.5 7"),
        ("POLYGONS 2 8", "POLYGONES 2 8", 21, "expected points or cells of POLYDATA, got 'POLYGON"),
        ("POLYGONS 2 8", "POLYGONS 3 8", 23, "3 POLYGONS do not fit into 8 numbers"),
        ("3 0 1 3", "2 0 1 3", 23, "2 POLYGONS take 7 numbers, not 8"),
    ],
)
def test_broken_legacy_files(tmp_path, old, new, line, message):
    assert LEGACY.count(old) == 1
    with pytest.raises(MeshError, match=message) as caught:
        read(tmp_path, "mesh.vtk", LEGACY.replace(old, new))
    assert str(caught.value).startswith(f"Mesh.read: {tmp_path / 'mesh.vtk'}, line {line}: ")


def test_indices_out_of_range(tmp_path):
    for text, old in ((LEGACY, "3 0 1 3\n"), (OFFSETS, "\n0 1 3\n")):
        with pytest.raises(MeshError, match=r"mesh.vtk: cell 2 names vertex 9, but .* 5 vertices"):
            read(tmp_path, "mesh.vtk", text.replace(old, old.replace("1 3", "1 9")))
    with pytest.raises(
        MeshError, match="offsets and types of the cells do not fit their 6 corners"
    ):
        read(tmp_path, "mesh.vtk", OFFSETS.replace("0 3 6", "0 3 5"))
    with pytest.raises(MeshError, match="the file has no POLYGONS; is it truncated"):
        read(tmp_path, "mesh.vtk", LEGACY.partition("VERTICES")[0])


# --- XML by hand ----------------------------------------------------------------------------------

_COMPRESSORS = {
    "vtkZLibDataCompressor": zlib.compress,
    "vtkLZMADataCompressor": lambda data: lzma.compress(data, lzma.FORMAT_XZ),
    "vtkLZ4DataCompressor": lambda data: lz4.block.compress(data, store_size=False),
}


def packed(values, header, compressor, block=40):
    """The header and the body of an array, as VTK lays them out."""
    data = values.tobytes()
    if compressor is None:
        return struct.pack(header, len(data)), data
    blocks = [data[at : at + block] for at in range(0, len(data), block)]
    parts = [_COMPRESSORS[compressor](part) for part in blocks]
    numbers = [len(parts), block, len(data) % block, *map(len, parts)]
    return b"".join(struct.pack(header, number) for number in numbers), b"".join(parts)


def xml(form, order="<", wide=False, compressor=None, kind="PolyData", appended="raw"):
    """The tetrahedron as a file in XML: arrays as text, base64 or appended."""
    header = order + ("Q" if wide else "I")
    arrays, tail = {}, b""
    for name, values, stored in (
        ("points", TETRAHEDRON, "f8"),
        ("connectivity", FACES, "i8"),
        ("offsets", np.arange(3, 15, 3), "i4"),
        ("types", np.full(4, 5), "u1"),
    ):
        called = {"f8": "Float64", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}[stored]
        text, offset = "", ""
        if form == "ascii":
            text = " ".join(map(repr, values.ravel().tolist()))
        else:
            head, body = packed(values.astype(order + stored), header, compressor)
            raw = head + body
            together = compressor is None
            code = base64.b64encode
            encoded = code(raw) if together else code(head) + code(body)
            if form == "binary":
                text = encoded.decode()
            else:
                offset = f' offset="{len(tail)}"'
                tail += raw if appended == "raw" else encoded
        arrays[name] = (
            f'<DataArray type="{called}" Name="{name}" NumberOfComponents="3" format="{form}"'
            f"{offset}>\n{text}\n</DataArray>\n"
        )
    cells = arrays["connectivity"] + arrays["offsets"]
    if kind == "PolyData":
        piece = 'NumberOfPoints="4" NumberOfVerts="0" NumberOfPolys="4"'
        cells = f"<Polys>{cells}</Polys>"
    else:
        piece = 'NumberOfPoints="4" NumberOfCells="4"'
        cells = f"<Cells>{cells}{arrays['types']}</Cells>"
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" '
        f'byte_order="{"LittleEndian" if order == "<" else "BigEndian"}" '
        f'header_type="UInt{64 if wide else 32}"'
        + (f' compressor="{compressor}"' if compressor else "")
        + f">\n<{kind}>\n<Piece {piece}>\n<PointData/>\n<Points>{arrays['points']}</Points>\n"
        f"{cells}\n</Piece>\n</{kind}>\n"
    ).encode()
    if form == "appended":
        text += f'<AppendedData encoding="{appended}">\n_'.encode() + tail + b"\n</AppendedData>\n"
    return text + b"</VTKFile>\n"


FORMS = [("ascii", ""), ("binary", ""), ("appended", "raw"), ("appended", "base64")]


@pytest.mark.parametrize(("kind", "name"), [("PolyData", "m.vtp"), ("UnstructuredGrid", "m.vtu")])
@pytest.mark.parametrize(("form", "appended"), FORMS)
def test_xml_in_every_encoding(tmp_path, kind, name, form, appended):
    for order, wide, compressor in itertools.product("<>", (False, True), (None, *_COMPRESSORS)):
        data = xml(form, order, wide, compressor, kind, appended)
        for content in (data, b"\xef\xbb\xbf" + data):
            mesh = read(tmp_path, name, content)
            assert np.array_equal(mesh.vertices, TETRAHEDRON)
            assert np.array_equal(mesh.triangles, FACES)


@pytest.mark.parametrize(("form", "appended"), FORMS)
@pytest.mark.parametrize("compressor", [None, *_COMPRESSORS])
def test_xml_cut_or_damaged_is_refused(tmp_path, form, appended, compressor):
    data = xml(form, compressor=compressor, appended=appended)
    for length in np.linspace(0, len(data) - 20, 20, dtype=int):
        with pytest.raises(MeshError, match=r"^Mesh.read: .*cut.vtp.* truncated"):
            read(tmp_path, "cut.vtp", data[:length])
    if form == "ascii":
        return
    wrong = data.replace(b'NumberOfPoints="4"', b'NumberOfPoints="5"')
    with pytest.raises(MeshError, match="5 points were announced, but there are 12 coordinates"):
        read(tmp_path, "wrong.vtp", wrong)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b'type="PolyData"', b'type="ImageData"', "expected a VTKFile of type PolyData .*ImageDa"),
        (b"VTKFile", b"SVGFile", "expected a VTKFile"),
        (b'"Float64"', b'"Float99"', "unknown type 'Float99' of the array of the points"),
        (b'format="binary"', b'format="bin"', "unknown format 'bin' of the array"),
        (b'header_type="UInt32"', b'header_type="Int"', "unknown header_type 'Int'"),
        (b"vtkZLib", b"vtkSnappy", "unknown compressor 'vtkSnappyDataCompressor'; save it with"),
        (b"Polys>", b"Poles>", "the PolyData has no Polys"),
        (b'"offsets"', b'"ends"', "Polys have no DataArray offsets"),
        (b"<Piece", b"<Part", "line 17: not a VTK file in XML: mismatched tag"),
        (
            b"AAAAA",
            b"&lt;*$#",
            "the array of the points of Points cannot be read: .*is the file damaged or truncated",
        ),
    ],
)
def test_broken_xml(tmp_path, old, new, message):
    data = xml("binary", compressor="vtkZLibDataCompressor")
    assert old in data
    with pytest.raises(MeshError, match=rf"^Mesh.read: .*mesh.vtp.*[:,] {message}"):
        read(tmp_path, "mesh.vtp", data.replace(old, new))


def test_lz4_is_named_where_its_package_is_not_installed(tmp_path, monkeypatch):
    data = xml("binary", compressor="vtkLZ4DataCompressor")
    monkeypatch.setitem(sys.modules, "lz4.block", None)
    with pytest.raises(
        MeshError, match="compressed by LZ4; run 'pip install lz4', or save it with"
    ):
        read(tmp_path, "mesh.vtp", data)


def test_pieces_follow_one_another(tmp_path):
    """As parallel filters leave them; empty ones too."""
    text = xml("ascii").decode()
    head, _, tail = text.partition("<Piece")
    piece, _, end = ("<Piece" + tail).partition("</Piece>\n")
    shifted = piece.replace("0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0 0.0 0.0", "9 9 9 8 9 9 9 8 9 9")
    assert shifted != piece
    empty = '<Piece NumberOfPoints="0" NumberOfPolys="0"></Piece>'
    mesh = read(
        tmp_path, "mesh.vtp", head + piece + "</Piece>" + empty + shifted + "</Piece>" + end
    )
    assert (mesh.num_vertices, mesh.num_components) == (8, 2)


# --- Files of VTK itself --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def vtk_surface(lumpy):
    """The mesh as VTK's vtkPolyData, in double precision, with values that must be skipped."""
    pytest.importorskip("vtkmodules")
    pyvista = pytest.importorskip("pyvista")
    cells = np.insert(lumpy.triangles, 0, 3, axis=1)
    surface = pyvista.PolyData(lumpy.vertices.copy(), cells.ravel())
    surface.point_data["height"] = lumpy.vertices[:, 2]
    surface.cell_data["number"] = np.arange(lumpy.num_triangles)
    surface.field_data["TimeValue"] = [0.25]
    return surface


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("mode", [1, 2])
@pytest.mark.parametrize("grid", [False, True])
def test_legacy_files_of_vtk(tmp_path, lumpy, vtk_surface, version, mode, grid):
    from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkUnstructuredGridWriter

    path = tmp_path / "mesh.vtk"
    writer = vtkUnstructuredGridWriter() if grid else vtkPolyDataWriter()
    writer.SetInputData(vtk_surface.cast_to_unstructured_grid() if grid else vtk_surface)
    writer.SetFileName(str(path))
    writer.SetFileVersion(version)
    writer.SetFileType(mode)
    assert writer.Write()
    mesh = Mesh.read(path)
    assert np.array_equal(mesh.triangles, lumpy.triangles)
    assert np.allclose(mesh.vertices, lumpy.vertices, rtol=1e-5 if mode == 1 else 0, atol=0)


@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
@pytest.mark.parametrize("compressor", ["None", "ZLib", "LZMA", "LZ4"])
@pytest.mark.parametrize("grid", [False, True])
def test_xml_files_of_vtk(tmp_path, lumpy, vtk_surface, mode, compressor, grid):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

    path = tmp_path / ("mesh.vtu" if grid else "mesh.vtp")
    for encoded, order, header in itertools.product((0, 1), (0, 1), (32, 64)):
        writer = vtkXMLUnstructuredGridWriter() if grid else vtkXMLPolyDataWriter()
        writer.SetInputData(vtk_surface.cast_to_unstructured_grid() if grid else vtk_surface)
        writer.SetFileName(str(path))
        getattr(writer, f"SetDataModeTo{mode}")()
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        writer.SetEncodeAppendedData(encoded)
        writer.SetByteOrder(order)
        writer.SetHeaderType(header)
        # Several blocks for each array.
        writer.SetBlockSize(512)
        assert writer.Write()
        mesh = Mesh.read(path)
        assert np.array_equal(mesh.triangles, lumpy.triangles)
        assert np.array_equal(mesh.vertices, lumpy.vertices)


def test_strips_of_vtk(tmp_path, lumpy, vtk_surface):
    strips = vtk_surface.strip()
    assert strips.n_strips > 0
    for name, options in (("mesh.vtp", {}), ("mesh.vtk", {"binary": True})):
        strips.save(tmp_path / name, **options)
        mesh = Mesh.read(tmp_path / name)
        assert mesh.num_triangles == lumpy.num_triangles
        assert mesh.volume == pytest.approx(lumpy.volume, rel=1e-12)


# --- Our own files --------------------------------------------------------------------------------


def test_vtk_is_text_unless_asked(tmp_path, pair):
    path = tmp_path / "mesh.vtk"
    pair.write(path)
    head = path.read_bytes().splitlines()[:5]
    assert head[2:] == [b"ASCII", b"DATASET UNSTRUCTURED_GRID", b"POINTS 84 double"]
    path.read_text(encoding="ascii")
    assert Mesh.read(path) == pair
    pair.write(path, binary=True)
    assert path.read_bytes().splitlines()[2] == b"BINARY"
    assert Mesh.read(path) == pair
    assert np.array_equal(meshio.read(path).points, pair.vertices)


@pytest.mark.parametrize(
    ("extension", "binary"),
    [("ply", False), ("ply", True), ("vtk", False), ("vtk", True), ("vtu", None), ("msh", True)],
)
def test_values_of_the_vertices_go_along(tmp_path, lumpy, extension, binary):
    path = tmp_path / f"mesh.{extension}"
    random = np.random.default_rng(4)
    height, force = random.normal(size=42), random.normal(size=(42, 3))
    lumpy.write(path, point_data={"height": height, "force": force}, binary=binary)
    # Those who read surfaces need not know of them.
    assert Mesh.read(path) == lumpy
    if extension != "ply":
        data = meshio.read(path).point_data
        assert np.allclose(data["height"].ravel(), height, rtol=1e-15)
        assert np.allclose(data["force"], force, rtol=1e-15)
        return
    header, body = path.read_bytes().split(b"end_header\n", 1)
    names = [line.split()[-1].decode() for line in header.splitlines() if b" double " in line]
    assert names == ["x", "y", "z", "height", "force_x", "force_y", "force_z"]
    if binary:
        found = np.frombuffer(body, "<f8", 42 * 7).reshape(42, 7)
    else:
        found = np.array([line.split() for line in body.splitlines()[:42]], dtype=float)
    assert np.array_equal(found, np.column_stack([lumpy.vertices, height, force]))


def test_vtk_reads_the_values(tmp_path, lumpy):
    pyvista = pytest.importorskip("pyvista")
    path = tmp_path / "mesh.vtk"
    values = {"h": lumpy.vertices[:, 2], "normal": lumpy.vertices / 3}
    for binary in (False, True):
        lumpy.write(path, point_data=values, binary=binary)
        found = pyvista.read(path)
        assert np.array_equal(found.points, lumpy.vertices)
        assert np.array_equal(found.point_data["h"], values["h"])
        assert np.array_equal(found.point_data["normal"], values["normal"])


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        (
            "m.obj",
            {"point_data": {"h": 1}},
            r"m.obj: .obj has no room for values .*\(h\); leave out",
        ),
        ("m.stl", {"binary": True}, "m.stl: .stl is written as text only.* write .ply or .vtk"),
        ("m.vtu", {"binary": False}, "m.vtu: .vtu is written as binary only.* write .ply or .vtk"),
        ("m.ply", {"point_data": {"h": [1, 2]}}, r"'h' must have shape \(42,\) or \(42, 3\), got"),
        ("m.ply", {"point_data": {"a b": [1]}}, "'a b': a name must be one word"),
        ("m.ply", {"point_data": {"h": "high"}}, "'h' must be numbers without a unit"),
        ("m.ply", {"point_data": {"x": np.zeros(42)}}, "PLY has one property 'x' already"),
    ],
)
def test_what_cannot_be_written(tmp_path, lumpy, name, options, message):
    with pytest.raises(MeshError, match=f"^Mesh.write: .*{message}"):
        lumpy.write(tmp_path / name, **options)
    assert not (tmp_path / name).exists()


def test_ovito_reads_the_text(tmp_path, lumpy):
    """Vertices and triangles arrive; OVITO's reader skips the values."""
    ovito = pytest.importorskip("ovito.io")
    for name in ("mesh.vtk", "mesh.obj"):
        options = {"point_data": {"h": lumpy.vertices[:, 2]}} if name == "mesh.vtk" else {}
        lumpy.write(tmp_path / name, **options)
        data = ovito.import_file(str(tmp_path / name)).compute()
        (surface,) = (o for o in data.objects if type(o).__name__ == "TriangleMesh")
        assert np.allclose(surface.get_vertices(), lumpy.vertices, rtol=1e-6)
        assert np.array_equal(surface.get_faces(), lumpy.triangles)
