"""Formats that other libraries read and write: Gmsh, and what else meshio or trimesh know.

Both are imported on first use: they are slow to import, and most meshes are PLY.
"""

from __future__ import annotations

import contextlib
import io
import re
import struct
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from .._writing import in_memory, naming, write_whole
from ..errors import MeshError
from . import repair
from .source import Source, merge_repeated

__all__ = ["meshio_extensions", "read_meshio", "read_trimesh", "trimesh_extensions", "write_meshio"]

# Cells of no area, such as the points and lines of a Gmsh model, do not matter to a surface.
_IGNORED = ("vertex", "line")
_FACES = ("triangle", "quad", "polygon")


def meshio_extensions() -> set[str]:
    """Extensions of the formats that meshio reads, such as ``.vtu``."""
    import meshio

    return set(meshio.extension_to_filetypes)


def trimesh_extensions() -> set[str]:
    """Extensions of the formats that trimesh reads as it is installed; empty without trimesh."""
    try:
        import trimesh
    except ImportError:
        return set()
    return {"." + name for name in trimesh.available_formats()}


def read_meshio(source: Source) -> tuple[Array, Array]:
    """Vertices and triangles of a file, read by meshio.

    Points and lines are ignored, together with vertices that belong to nothing else.

    Raises
    ------
    MeshError
        If meshio cannot read the file, or it has cells that are no faces.
    """
    if _is_gmsh(source):
        _check_nodes(source)
    elif source.path.suffix.lower() == ".msh" and not _is_ansys(source):
        raise source.error("begins neither with $MeshFormat, as files of Gmsh do, nor with '('")
    mesh = _load(source)
    source.by_line = False
    faces: list[Any] = []
    ignored = [np.empty(0, dtype=np.int64)]
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise source.error(f"vertices must have 3 coordinates, got {points.shape}")
    for block in mesh.cells:
        if block.type in _FACES:
            for face in np.asarray(block.data, dtype=np.int64).tolist():
                for corner in face:
                    if not 0 <= corner < len(points):
                        raise source.error(
                            f"face {len(faces)} names vertex {corner}, but the file has "
                            f"{len(points)} vertices, counted from 0"
                        )
                source.check_corners(len(face), len(faces))
                faces.append(face)
        elif block.type in _IGNORED:
            ignored.append(np.asarray(block.data, dtype=np.int64).ravel())
        elif len(block.data):
            cell = np.asarray(block.data[0]).tolist()
            raise source.error(
                f"found a cell of type '{block.type}' on vertices {cell}; only faces are allowed: "
                "extract the surface and save that"
            )
    points, triangles = source.mesh(points, faces)
    return repair.drop(points, triangles, np.setdiff1d(np.concatenate(ignored), triangles))


def write_meshio(
    path: Path,
    vertices: Array,
    triangles: Array,
    point_data: dict[str, Array] | None = None,
) -> None:
    """Write a VTU or Gmsh file of doubles, binary: as text meshio would round them."""
    import meshio

    file_format = {".vtu": "vtu", ".msh": "gmsh"}[path.suffix.lower()]
    made = meshio.Mesh(vertices, [("triangle", triangles)], point_data=point_data)
    # meshio says nothing of the file where it cannot be written.
    with naming(path):
        data = in_memory(lambda name: made.write(name, file_format=file_format))
    write_whole(path, data)


def read_trimesh(path: Path) -> tuple[Array, Array]:
    """Vertices and triangles of a file, read by trimesh, with repeated vertices merged.

    Formats made for rendering, such as glTF, repeat a vertex that has several normals or colours.

    Raises
    ------
    MeshError
        If trimesh cannot read the file.
    """
    import trimesh

    try:
        mesh = trimesh.load(path, process=False, force="mesh")
        corners = np.asarray(mesh.vertices, dtype=np.float64)[np.asarray(mesh.faces)]
    except Exception as reason:
        raise MeshError(f"Mesh.read: {path}: trimesh cannot read it: {_reason(reason)}") from reason
    vertices, numbers = merge_repeated(corners)
    return vertices, numbers.reshape(-1, 3)


#: Of a node; the list that meshio makes up to it then takes 800 MB.
_LARGEST_NUMBER = 100_000_000


def _is_gmsh(source: Source) -> bool:
    return source.data.startswith((b"$MeshFormat", b"$Comments"))


def _is_ansys(source: Source) -> bool:
    return source.path.suffix.lower() == ".msh" and source.data.lstrip().startswith(b"(")


class _Ending(io.BufferedReader):
    """A file that says so where it has come to its end, where meshio's reader of Ansys reads on."""

    ended = False

    def read(self, size: int | None = -1) -> bytes:
        data = super().read(size)
        if not data and size:
            raise EOFError("a bracket is not closed")
        return data

    def readline(self, size: int | None = -1) -> bytes:
        line = super().readline(size)
        # An empty line ends the file, once.
        if not line and self.ended:
            raise EOFError("a section is not complete")
        self.ended = not line
        return line


def _check_nodes(source: Source) -> None:
    """Refuse a Gmsh file that counts more nodes than it has, or gives one an enormous number.

    meshio makes room for as many as the file says, and leaves what does not come as the memory was;
    and it makes a list of all numbers up to the largest.
    """
    data = source.data
    begin = re.search(rb"\$Nodes *\r?\n", data)
    if begin is None:
        return
    form = re.match(rb"\$MeshFormat\s+4\.1\s+1\s+8\s", data)
    if form is not None and begin.end() + 32 <= len(data):
        # Blocks: three numbers of four bytes, how many nodes, and four numbers of eight bytes each.
        blocks, counted = struct.unpack_from("=QQ", data, begin.end())
        at, there, largest = begin.end() + 32, 0, 0
        while blocks and at + 20 <= len(data):
            (count,) = struct.unpack_from("=Q", data, at + 12)
            numbers = data[at + 20 : at + 20 + 8 * count]
            numbers = np.frombuffer(numbers[: len(numbers) // 8 * 8], dtype="<u8")
            largest = max(largest, int(numbers.max(initial=0)))
            there, at, blocks = there + count, at + 20 + 32 * count, blocks - 1
    else:
        words = data[begin.end() : begin.end() + 100].split(b"\n", 1)[0].split()
        word = words[1] if len(words) == 4 else words[0] if len(words) == 1 else b""
        counted = int(word) if word.isdigit() else 0
        # A number and three coordinates with what parts them.
        there = len(data) // 8
        largest = _largest_number(data, begin.end(), counted)
    if counted > there:
        raise source.error(f"counts {counted} nodes, more than it has; write it anew")
    if largest > _LARGEST_NUMBER:
        raise source.error(f"gives a node the number {largest}; number the nodes from 1 on")


def _largest_number(data: bytes, begin: int, count: int) -> int:
    """The largest number of a node in a file that is text, or binary of version 2."""
    if re.match(rb"\$MeshFormat\s+2\S*\s+1\s", data):
        first = data.find(b"\n", begin) + 1
        record = np.dtype([("number", "<i4"), ("position", "<f8", 3)])
        count = min(count, (len(data) - first) // record.itemsize)
        numbers = np.frombuffer(data, record, count, first)["number"]
        return int(numbers.max(initial=0))
    end = data.find(b"$EndNodes", begin)
    section = data[begin : end if end >= 0 else len(data)]
    # Alone or before three coordinates, which may be as large.
    found = re.findall(rb"(?m)^[ \t]*(\d{9,})(?:(?:[ \t]+\S+){3})?[ \t]*\r?$", section)
    return max((int(number[:20]) for number in found), default=0)


def _load(source: Source):
    """The file as meshio's mesh; any failure becomes a MeshError, with the line if it is known."""
    import meshio
    from meshio.ansys import read as read_ansys
    from meshio.gmsh.main import read_buffer as read_gmsh

    is_gmsh, is_ansys = _is_gmsh(source), _is_ansys(source)
    printed = io.StringIO()
    # An open file, rather than a path, tells afterwards how far meshio came; numpy's reader needs
    # a real one, and this one begins without a byte-order mark.
    with (
        tempfile.TemporaryFile() as file,
        warnings.catch_warnings(),
        contextlib.redirect_stderr(printed),
    ):
        file.write(source.data)
        file.seek(0)
        # numpy only warns, in these words, when a number cannot be read: that is an error here.
        warnings.filterwarnings("error", message="string or file could not be read")
        try:
            with contextlib.redirect_stdout(printed):
                if is_gmsh:
                    return read_gmsh(file)
                if is_ansys:
                    return read_ansys(_Ending(file.raw))
                return meshio.read(source.path)
        # meshio ends the process when no reader fits, and broken data can raise anything.
        except (Exception, SystemExit) as reason:
            where = str(source.path)
            if is_gmsh:
                where += f", line {max(1, len(source.data[: file.tell()].splitlines()))}"
            said = " ".join(printed.getvalue().split()) or _reason(reason)
            guess = "is the file truncated?"
            if source.data != source.raw:
                guess = "it begins with a byte-order mark: save it without"
            raise MeshError(
                f"Mesh.read: {where}: meshio cannot read on: {said}; {guess}"
            ) from reason


def _reason(reason: BaseException) -> str:
    return f"{type(reason).__name__}: {reason}".rstrip(": ")
