"""Which reader and which writer serves a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .._writing import write_whole
from ..errors import MeshError
from . import obj, off, other, ply, stl
from .source import Source

__all__ = ["read", "write"]

_OWN = {".ply": ply, ".obj": obj, ".off": off, ".stl": stl}
_MESHIO_WRITES = (".vtk", ".vtu", ".msh")


def read(path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a file, not yet validated as a mesh.

    Parameters
    ----------
    path : str or Path
        The format follows from the extension, in upper or lower case.

    Returns
    -------
    vertices : ndarray
        Shape (num_vertices, 3), float64, the numbers of the file.
    triangles : ndarray
        Shape (num_triangles, 3), int64.

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
    if extension in _OWN:
        return _OWN[extension].read(Source(path, path.read_bytes()))
    meshio, trimesh = other.meshio_extensions(), other.trimesh_extensions()
    if extension in meshio:
        return other.read_meshio(path)
    if extension in trimesh:
        return other.read_trimesh(path)
    raise _unknown("read", path, {*_OWN, *meshio, *trimesh})


def write(path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Write a mesh in the format of the extension.

    Raises
    ------
    MeshError
        If the format is unknown.
    OSError
        If the file cannot be written; one that was there is still as it was.
    """
    path = Path(path)
    extension = path.suffix.lower()
    if extension in _OWN:
        write_whole(path, _OWN[extension].write(vertices, triangles).encode("ascii"))
    elif extension in _MESHIO_WRITES:
        other.write_meshio(path, vertices, triangles)
    else:
        raise _unknown("write", path, {*_OWN, *_MESHIO_WRITES})


def _unknown(method: str, path: Path, known: set[str]) -> MeshError:
    return MeshError(
        f"Mesh.{method}: {path}: unknown extension '{path.suffix}'; known are "
        + ", ".join(sorted(known))
    )
