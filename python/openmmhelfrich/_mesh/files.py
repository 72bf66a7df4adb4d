"""Which reader and which writer serves a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from .._writing import write_whole
from ..errors import MeshError
from . import obj, off, other, ply, repair, stl, vtk_legacy, vtk_xml
from .source import Source

__all__ = ["explained", "read", "refuse_cracks", "write"]

_READERS = {
    ".ply": ply.read,
    ".obj": obj.read,
    ".stl": stl.read,
    ".off": off.read,
    ".vtk": vtk_legacy.read,
    ".vtp": vtk_xml.read,
    ".vtu": vtk_xml.read,
}
# What has room for values of the vertices, text or binary; what is binary only; what is text only.
_EITHER = {".ply": ply.write, ".vtk": vtk_legacy.write}
_BINARY_ONLY = (".vtu", ".msh")
_TEXT_ONLY = {".obj": obj.write, ".off": off.write, ".stl": stl.write}


def read(
    path, triangulate: bool = False, merge: float | None = None, drop_unused: bool = False
) -> tuple[Array, Array, Array | None]:
    """Vertices, triangles and box of a file, not yet validated as a mesh.

    Parameters
    ----------
    path : str or Path
        The format follows from the extension, in upper or lower case.
    triangulate, merge, drop_unused
        As for `Mesh.read`; `merge` in the numbers of the file.

    Returns
    -------
    vertices : ndarray
        Shape (num_vertices, 3), float64, the numbers of the file.
    triangles : ndarray
        Shape (num_triangles, 3), int64.
    box : ndarray or None
        Shape (3, 3), the numbers of the file; only PLY files have one.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    MeshError
        If the format is unknown, or the file breaks it.
    """
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"Mesh.read: there is no file {path}")
    if not path.is_file():
        raise MeshError(f"Mesh.read: {path} is not a file")
    extension = path.suffix.lower()
    source = Source(path, path.read_bytes(), triangulate)
    if extension in _READERS:
        # Of numbers that are none, even of those that signal it, the mesh names the vertex.
        with np.errstate(invalid="ignore"):
            vertices, triangles = _READERS[extension](source)
    elif extension in other.meshio_extensions():
        vertices, triangles = other.read_meshio(source)
    elif extension in other.trimesh_extensions():
        vertices, triangles = other.read_trimesh(path)
    else:
        known = f"{', '.join([*_READERS, '.msh'])}, and what else meshio and trimesh read"
        raise _unknown("read", path, known)
    if merge is not None:
        try:
            vertices, triangles = repair.merge(vertices, triangles, merge)
        except MeshError as reason:
            raise MeshError(f"Mesh.read: {path}: {reason}") from None
    if drop_unused:
        vertices, triangles = repair.drop(vertices, triangles)
    return vertices, triangles, None if source.box is None else np.reshape(source.box, (3, 3))


def explained(path, reason: MeshError, vertices: Array, triangles: Array) -> MeshError:
    """The error of a mesh that is not valid, with its file and with what could mend it."""
    text = str(reason).removeprefix("Mesh: ")
    return MeshError(f"Mesh.read: {path}: {text}{repair.hints(vertices, triangles)}")


def refuse_cracks(path, mesh) -> None:
    """Refuse borders that may be none, but vertices that a program has written twice."""
    found = "" if mesh.is_closed else repair.doubled(mesh.vertices, mesh.triangles)
    if found:
        raise MeshError(
            f"Mesh.read: {path}: the mesh is open, with {len(mesh.border_loops)} border(s){found}, "
            "merge=0 (--merge 0) takes the borders as they are"
        )


def write(
    path,
    vertices: Array,
    triangles: Array,
    point_data: dict[str, Array] | None = None,
    binary: bool | None = None,
    box: Array | None = None,
) -> None:
    """Write a mesh in the format of the extension; arguments and errors as for `Mesh.write`."""
    path = Path(path)
    extension = path.suffix.lower()
    if box is not None and extension != ".ply":
        raise MeshError(
            f"Mesh.write: {path}: {extension} has no room for the periodic box of the mesh; write "
            ".ply, or Mesh(*mesh.unfolded()), whose triangles are whole and which has no box"
        )
    if extension in _TEXT_ONLY:
        if binary:
            raise MeshError(
                f"Mesh.write: {path}: {extension} is written as text only, with all digits; leave "
                f"out binary, or write {' or '.join(_EITHER)}"
            )
        if point_data:
            raise MeshError(
                f"Mesh.write: {path}: {extension} has no room for values of the vertices "
                f"({', '.join(map(str, point_data))}); leave out point_data, or write "
                + ", ".join([*_EITHER, *_BINARY_ONLY])
            )
        write_whole(path, _TEXT_ONLY[extension](vertices, triangles))
        return
    data = _checked(point_data or {}, len(vertices))
    if extension in _EITHER:
        options = {} if box is None else {"box": box}
        write_whole(path, _EITHER[extension](vertices, triangles, data, bool(binary), **options))
    elif extension in _BINARY_ONLY:
        if binary is not None and not binary:
            raise MeshError(
                f"Mesh.write: {path}: {extension} is written as binary only; leave out binary, or "
                f"write {' or '.join(_EITHER)}"
            )
        other.write_meshio(path, vertices, triangles, data)
    else:
        known = ", ".join(sorted([*_EITHER, *_BINARY_ONLY, *_TEXT_ONLY]))
        raise _unknown("write", path, known)


def _checked(point_data: dict[str, Any], num_vertices: int) -> dict[str, Array]:
    """Values of the vertices as arrays of doubles."""
    found = {}
    for name, values in point_data.items():
        where = f"Mesh.write: point_data {name!r}"
        if not isinstance(name, str) or not name.isprintable() or len(name.split()) != 1:
            raise MeshError(f"{where}: a name must be one word, without spaces")
        try:
            array = np.array(values, dtype=np.float64)
        except (TypeError, ValueError):
            raise MeshError(f"{where} must be numbers without a unit, got {values!r}") from None
        if array.shape not in ((num_vertices,), (num_vertices, 3)):
            raise MeshError(
                f"{where} must have shape ({num_vertices},) or ({num_vertices}, 3), got "
                f"{array.shape}; give one number or one vector per vertex"
            )
        found[name] = array
    return found


def _unknown(method: str, path: Path, known: str) -> MeshError:
    return MeshError(f"Mesh.{method}: {path}: unknown extension '{path.suffix}'; known are {known}")
