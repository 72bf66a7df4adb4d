"""Formats that other libraries read and write: VTK, VTU, Gmsh and what else meshio or trimesh know.

Both are imported on first use: they are slow to import, and most meshes are PLY.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .._writing import in_memory, naming, write_whole
from ..errors import MeshError
from .source import arrays, merge_repeated

__all__ = ["meshio_extensions", "read_meshio", "read_trimesh", "trimesh_extensions", "write_meshio"]

# Cells of no area, such as the points and lines of a Gmsh model, do not matter to a surface.
_IGNORED = ("vertex", "line")


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


def read_meshio(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a file, read by meshio.

    Points and lines are ignored, together with vertices that belong to nothing else.

    Raises
    ------
    MeshError
        If meshio cannot read the file, or it has cells other than triangles.
    """
    mesh = _load(path)
    triangles = [np.empty((0, 3), dtype=np.int64)]
    ignored = [np.empty(0, dtype=np.int64)]
    for block in mesh.cells:
        if block.type == "triangle":
            triangles.append(np.asarray(block.data, dtype=np.int64))
        elif block.type in _IGNORED:
            ignored.append(np.asarray(block.data, dtype=np.int64).ravel())
        elif len(block.data):
            cell = np.asarray(block.data[0]).tolist()
            raise MeshError(
                f"Mesh.read: {path}: found a cell of type '{block.type}' on vertices {cell}; only "
                "triangles are allowed: extract the surface and triangulate it"
            )
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshError(f"Mesh.read: {path}: vertices must have 3 coordinates, got {points.shape}")
    corners = np.concatenate(triangles)
    return _drop(points, corners, np.setdiff1d(np.concatenate(ignored), corners))


def write_meshio(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Write a VTK, VTU or Gmsh file of doubles, in the binary form of the format."""
    import meshio

    file_format = {".vtk": "vtk", ".vtu": "vtu", ".msh": "gmsh"}[path.suffix.lower()]
    made = meshio.Mesh(vertices, [("triangle", triangles)])
    # meshio says nothing of the file where it cannot be written.
    with naming(path):
        data = in_memory(lambda name: made.write(name, file_format=file_format))
    write_whole(path, data)


def read_trimesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
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
    return merge_repeated(corners)


def _load(path: Path):
    """The file as meshio's mesh; any failure becomes a MeshError, with the line if it is known."""
    import meshio
    from meshio.gmsh.main import read_buffer as read_gmsh
    from meshio.vtk._main import read_buffer as read_vtk

    data = path.read_bytes()
    reader = read_vtk if path.suffix.lower() == ".vtk" else None
    if data.startswith((b"$MeshFormat", b"$Comments")):
        reader = read_gmsh
    position = len(data)
    printed = io.StringIO()
    with warnings.catch_warnings(), contextlib.redirect_stderr(printed):
        # numpy only warns, in these words, when a number cannot be read: that is an error here.
        warnings.filterwarnings("error", message="string or file could not be read")
        try:
            with contextlib.redirect_stdout(printed):
                if reader is None:
                    return meshio.read(path)
                # An open file, rather than a path, tells afterwards how far meshio came.
                with path.open("rb") as file:
                    try:
                        return reader(file)
                    finally:
                        position = file.tell()
        # meshio ends the process when no reader fits, and broken data can raise anything.
        except (Exception, SystemExit) as reason:
            if reader is None:
                line = _line_of_broken_xml(path, data)
            else:
                line = max(1, len(data[:position].splitlines()))
            where = f"{path}, line {line}" if line else str(path)
            said = " ".join(printed.getvalue().split()) or _reason(reason)
            raise MeshError(
                f"Mesh.read: {where}: meshio cannot read on: {said}; is the file truncated?"
            ) from reason


def _line_of_broken_xml(path: Path, data: bytes) -> int | None:
    """The line where a VTU file ceases to be XML; None if it is XML, or another format."""
    if path.suffix.lower() == ".vtu":
        try:
            ElementTree.fromstring(data)
        except ElementTree.ParseError as reason:
            return reason.position[0]
    return None


def _reason(reason: BaseException) -> str:
    return f"{type(reason).__name__}: {reason}".rstrip(": ")


def _drop(
    points: np.ndarray, corners: np.ndarray, dropped: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The mesh without some vertices, which no triangle uses."""
    in_range = ((corners >= 0) & (corners < len(points))).all()
    if len(dropped) == 0 or not in_range:
        # An index out of range is left to the validation of the mesh, which names it.
        return arrays(points, corners)
    kept = np.setdiff1d(np.arange(len(points)), dropped)
    number = np.full(len(points), -1)
    number[kept] = np.arange(len(kept))
    return arrays(points[kept], number[corners])
