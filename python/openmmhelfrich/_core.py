"""The Rust core, called through ctypes: what Python needs of it besides the forces.

The forces reach the core through OpenMM. The validation and orientation of a mesh are plain
functions of the same library (``src/ffi/``), so that there is one set of rules and one set of
messages for meshes and forces alike.
"""

from __future__ import annotations

import ctypes
import functools
from pathlib import Path

import numpy as np

from ._system import LIBRARY
from ._types import Array
from .errors import MeshError

__all__ = ["LIBRARY_PATH", "last_error", "library", "orient"]

LIBRARY_PATH = Path(__file__).with_name("lib") / LIBRARY

_DOUBLES = np.ctypeslib.ndpointer(np.float64, ndim=2, flags="C_CONTIGUOUS")
_INDICES = np.ctypeslib.ndpointer(np.int64, ndim=2, flags=("C_CONTIGUOUS", "WRITEABLE"))


@functools.cache
def library() -> ctypes.CDLL:
    """The loaded library, with the argument types of its mesh functions declared.

    It is loaded on first use. OpenMM is imported before it, so that ``libOpenMM.so``, on which the
    library depends, is the one that this process already uses.

    Raises
    ------
    ImportError
        If the library has not been built or cannot be loaded.
    """
    import openmm  # noqa: F401

    if not LIBRARY_PATH.exists():
        raise ImportError(
            f"openmmhelfrich: {LIBRARY_PATH} is missing; build and install the package with "
            "'make build' or 'pip install .'"
        )
    try:
        loaded = ctypes.CDLL(str(LIBRARY_PATH))
    except OSError as reason:
        raise ImportError(f"openmmhelfrich: cannot load {LIBRARY_PATH}: {reason}") from reason
    loaded.Helfrich_Mesh_orient.argtypes = [
        *(ctypes.c_int64, _DOUBLES),
        *(ctypes.c_int64, _INDICES),
        ctypes.c_void_p,
    ]
    loaded.Helfrich_Mesh_orient.restype = ctypes.c_int
    loaded.Helfrich_lastError.argtypes = [ctypes.c_char_p, ctypes.c_int64]
    loaded.Helfrich_lastError.restype = ctypes.c_int64
    return loaded


def last_error() -> str:
    """The message of the last call that failed on this thread."""
    size = 1024
    while True:
        buffer = ctypes.create_string_buffer(size)
        length = library().Helfrich_lastError(buffer, size)
        if length < size:
            return buffer.value.decode("utf-8", errors="replace")
        size = length + 1


def orient(vertices: Array, triangles: Array, box: Array | None = None) -> None:
    """Validate a mesh and turn its triangles outward, in place.

    Parameters
    ----------
    vertices : ndarray
        Shape (num_vertices, 3), float64, C-contiguous, nm.
    triangles : ndarray
        Shape (num_triangles, 3), int64, C-contiguous, writeable. Triangles are reversed where
        needed, so that neighbours agree and every component that encloses a volume has a positive
        one; others keep the orientation of their first triangle.
    box : ndarray, optional
        Periodic box, shape (3, 3), float64, C-contiguous, nm: corners are nearest images.

    Raises
    ------
    MeshError
        With the core's message, if the mesh is not 2-manifold, orientable and free of repeated,
        unused and degenerate elements; if an edge is not shorter than half the width of the box.
    """
    cell = None if box is None else box.ctypes.data
    arrays = len(vertices), vertices, len(triangles), triangles
    if library().Helfrich_Mesh_orient(*arrays, cell) != 0:
        raise MeshError(last_error())
