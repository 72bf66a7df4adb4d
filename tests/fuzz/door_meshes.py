"""Mesh files: what is read is valid, and is read again from each format that it is written in."""

from __future__ import annotations

import zlib
from functools import cache, partial

import meshio
import numpy as np
from doors import Door, Wrong, attempt, folder
from mutations import binary, text
from openmmhelfrich import Mesh, MeshError

#: Written by Mesh.write: extension, and whether it is binary.
_WRITTEN = [
    *(("ply", False), ("ply", True), ("obj", None), ("off", None), ("stl", None)),
    *(("vtk", False), ("vtk", True), ("vtu", None), ("msh", None)),
]


@cache
def _meshes() -> list[Mesh]:
    return [
        Mesh.icosphere(1, 10.0),
        Mesh.disk(2, 5.0).translated((1.25, -3, 0.1)),
        Mesh.sheet(8, 8, 1.0, periodic=True),
        Mesh.random_sphere(12, 1e-3, seed=3),
    ]


def _by(mesh: Mesh, extension: str, is_binary: bool | None) -> bytes:
    path = folder() / f"seed.{extension}"
    mesh.write(path, binary=is_binary)
    return path.read_bytes()


def _seeds(extension: str) -> list[bytes]:
    found = []
    for mesh in _meshes():
        for written, is_binary in _WRITTEN:
            if written == extension and (mesh.box is None or extension == "ply"):
                found.append(_by(mesh, extension, is_binary))
    return found + _MORE.get(extension, lambda: [])()


def _plys() -> list[bytes]:
    """With other types, other elements, big-endian, quadrilaterals."""
    mesh = _meshes()[0]
    head = (
        "ply\nformat {0} 1.0\nobj_info none\nelement vertex 12\nproperty float x\n"
        "property float y\nproperty double z\nproperty uchar red\nelement face 20\n"
        "property ushort flags\n"
        "property list uchar {1} vertex_index\nelement edge 1\nproperty list int short ends\n"
        "end_header\n"
    )
    found = []
    for order, name, corner in ((">", "big", "uint"), ("<", "little", "short")):
        kind = {"uint": "u4", "short": "i2"}[corner]
        rows = [("x", "f4"), ("y", "f4"), ("z", "f8"), ("red", "u1")]
        table = np.zeros(12, [(axis, order + kind) for axis, kind in rows])
        for k, axis in enumerate("xyz"):
            table[axis] = mesh.vertices[:, k]
        faces = np.zeros(20, [("f", order + "u2"), ("n", "u1"), ("c", order + kind, 3)])
        faces["n"], faces["c"] = 3, mesh.triangles
        edge = np.array([2], order + "i4").tobytes() + np.array([0, 1], order + "i2").tobytes()
        text = head.format(f"binary_{name}_endian", corner).encode()
        found.append(text + table.tobytes() + faces.tobytes() + edge)
    rows = [f"{x!r} {y!r} {z!r} 7" for x, y, z in mesh.vertices.tolist()]
    rows += [f"1 3 {a} {b} {c}" for a, b, c in mesh.triangles.tolist()] + ["2 0 1", ""]
    found.append((head.format("ascii", "int") + "\n".join(rows)).encode())
    return found


_CUBE = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
_SQUARES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def _objs() -> list[bytes]:
    rows = ["mtllib x.mtl", "o cube", *("v {} {} {}".format(*row) for row in _CUBE), "vn 0 0 1"]
    rows += ["f " + " ".join(f"{corner + 1}/1/1" for corner in face) for face in _SQUARES[:3]]
    rows += ["f " + " ".join(f"{corner - 8}//1" for corner in face) for face in _SQUARES[3:]]
    return ["\n".join([*rows, ""]).encode(), "\r\n".join(["\ufeff# x", *rows]).encode()]


def _offs() -> list[bytes]:
    rows = ["COFF", "8 6 12", *("{} {} {} 0.1 0.2 0.3 1".format(*row) for row in _CUBE)]
    rows += ["4 " + " ".join(map(str, face)) + " 255 0 0 # red" for face in _SQUARES]
    return ["\n".join([*rows, ""]).encode(), "\r".join(["\ufeffOFF 8 6", *rows[2:]]).encode()]


def _stls() -> list[bytes]:
    mesh = _meshes()[0]
    facets = np.zeros(20, [("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    facets["c"] = mesh.vertices[mesh.triangles]
    return [b"solid x".ljust(80) + (20).to_bytes(4, "little") + facets.tobytes()]


def _vtks() -> list[bytes]:
    """Version 5 with offsets, metadata and fields, strips, as VTK itself writes them."""
    rows = ["# vtk DataFile Version 5.1", "cube", "ASCII", "DATASET POLYDATA"]
    rows += ["FIELD FieldData 1", "TIME 1 1 double", "0.5", "METADATA", "INFORMATION 0", ""]
    rows += ["POINTS 8 float", *("{} {} {}".format(*row) for row in _CUBE), "POLYGONS 7 24"]
    rows += ["OFFSETS vtktypeint64", "0 4 8 12 16 20 24", "CONNECTIVITY vtktypeint64"]
    rows += [" ".join(map(str, face)) for face in _SQUARES] + ["POINT_DATA 8", ""]
    return ["\n".join(rows).encode(), *_vtk_of(".vtk")]


def _vtk_of(extension: str, **settings) -> list[bytes]:
    """What VTK itself writes, if it is installed."""
    try:
        import pyvista
    except ImportError:
        return []
    mesh = _meshes()[0]
    faces = np.column_stack([np.full(20, 3), mesh.triangles])
    surface = pyvista.PolyData(mesh.vertices, faces)
    data = surface.cast_to_unstructured_grid() if extension == ".vtu" else surface
    found = []
    for is_binary in (True, False):
        path = folder() / f"vtk{extension}"
        data.save(path, binary=is_binary)
        found.append(path.read_bytes())
    return found


def _mshs() -> list[bytes]:
    rows = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", "8"]
    rows += ["{} {} {} {}".format(k, *row) for k, row in enumerate(_CUBE, start=1)]
    rows += ["$EndNodes", "$Elements", "7", "1 15 2 0 1 1"]
    rows += [
        "{} 3 2 0 1 {} {} {} {}".format(k, *(corner + 1 for corner in face))
        for k, face in enumerate(_SQUARES, start=2)
    ]
    found = ["\n".join([*rows, "$EndElements", ""]).encode()]
    made = meshio.Mesh(_meshes()[0].vertices, [("triangle", _meshes()[0].triangles)])
    for is_binary in (True, False):
        made.write(folder() / "ansys.msh", file_format="ansys", binary=is_binary)
        found.append((folder() / "ansys.msh").read_bytes())
    return found


_MORE = {
    "ply": _plys,
    "obj": _objs,
    "off": _offs,
    "stl": _stls,
    "vtk": _vtks,
    "vtu": lambda: _vtk_of(".vtu"),
    "vtp": lambda: _vtk_of(".vtp"),
    "msh": _mshs,
}


def _check(extension: str, data: bytes) -> None:
    path = folder() / f"mesh.{extension}"
    path.write_bytes(data)
    dice = zlib.crc32(data)
    options = {
        "triangulate": bool(dice & 1),
        "drop_unused": dice & 6 == 6,
        "merge": (None, None, None, 0.0, 0.0, 0.01, 1.0, 1e300)[dice >> 3 & 7],
    }
    mesh = attempt(lambda: Mesh.read(path, **options), MeshError, "Mesh.read", str(path))
    if mesh is None or mesh.num_vertices > 200:
        return
    written, is_binary = ("ply", False) if mesh.box is not None else _WRITTEN[(dice >> 6) % 9]
    again = folder() / f"again.{written}"
    mesh.write(again, binary=is_binary)
    other = Mesh.read(again, merge=0)
    same = np.array_equal(mesh.vertices[mesh.triangles], other.vertices[other.triangles])
    if not same or (written != "stl" and mesh != other):
        raise Wrong(f"{written} (binary: {is_binary}) gives another mesh than was read")


def _change(data: bytes, random) -> bytes:
    is_text = b"\0" not in data[:2000]
    return (text if is_text or random.random() < 0.4 else binary)(data, random)


DOORS = [
    Door(extension, partial(_seeds, extension), partial(_check, extension), _change)
    for extension in _MORE
]
