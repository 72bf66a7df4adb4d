"""Vertices over time as extended XYZ, with values of each: text that OVITO and ASE read.

The format: https://github.com/libAtoms/extxyz.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._types import Array, File
from ._surface_frames import Types, each_surface, fresh_file
from .curvature import vertex_quantities
from .elements import edges_of
from .surface_series import SurfaceFrame, components

__all__ = ["FORMAT", "text_of", "write_extended_xyz"]

_SUFFIXES = (".xyz", ".extxyz")
# X is an atom of no element, which ASE insists on.
#: The columns, as the line above them says.
FORMAT = (
    "Properties=species:S:1:pos:R:3:mean_curvature:R:1:area:R:1:neighbours:I:1:component:I:1:"
    "kind:I:1"
)


def write_extended_xyz(
    path: File,
    vertices: Any,
    triangles: Any = None,
    times: Any = None,
    steps: Any = None,
    *,
    box: Any = None,
    types: ArrayLike | None = None,
) -> int:
    """Write vertices over time as extended XYZ, with values of each: OVITO and ASE read it.

    The columns are ``species`` (X, no element), ``pos`` (nm, not Å), ``mean_curvature``,
    H = C1 + C2 by Jülicher's scheme (B13), 1/nm, ``area``, a third of the triangles around, nm²,
    ``neighbours``, how many there are, ``component``, the number of the connected surface, from 0,
    and ``kind``, the type. The line above them has ``time`` in ps, ``step``, ``unit=nm``, and in a
    periodic box ``Lattice`` (three vectors, nm) and ``pbc="T T T"``, else ``pbc="F F F"``. Numbers
    have 9 digits; at a border the curvature is nan. The format has no triangles: OVITO takes
    surfaces from OBJ, STL or VTK, and bonds from GSD.

    Parameters
    ----------
    path : str or Path
        ``.xyz`` or ``.extxyz``; a file that is there is replaced when the new one is whole.
    vertices, triangles, times, steps, box
        As for `write_vtkhdf`.
    types : array_like of int, optional
        As for `write_gsd`.

    Returns
    -------
    int
        How many frames were written.

    Raises
    ------
    ValueError
        Another suffix, types that do not fit, or as for `write_vtkhdf`.
    OSError
        If the system refuses; a file that was there is as before.

    Examples
    --------
    >>> write_extended_xyz("run.xyz", "run/run.xtc")  # with run/run.triangles beside it
    """
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        raise ValueError(f"write_extended_xyz: {path}: the suffix must be .xyz or .extxyz")
    kinds = Types("write_extended_xyz", types)
    with fresh_file(path) as fresh, fresh.open("w", encoding="ascii") as file:

        def add(frame):
            file.write(text_of(frame, kinds.next(frame)))

        return each_surface("write_extended_xyz", add, vertices, triangles, times, steps, box)


def text_of(frame: SurfaceFrame, kinds: Array) -> str:
    """One frame; kinds: the type of each vertex, shape (num_vertices,)."""
    count = len(frame.vertices)
    start, end = edges_of(frame.triangles)[:2]
    neighbours = np.bincount(np.concatenate([start, end]), minlength=count)
    found = vertex_quantities(frame.vertices, frame.triangles, box=frame.box)
    parts = components(frame.triangles, count)
    words = [
        FORMAT,
        f"time={frame.time:.10g}",
        f"step={frame.step}",
        "unit=nm",
    ]
    if frame.box is None:
        words.append('pbc="F F F"')
    else:
        lattice = " ".join(f"{number:.9g}" for number in frame.box.ravel())
        words = [f'Lattice="{lattice}"', *words, 'pbc="T T T"']
    reals = [*frame.vertices.T, found.mean_curvature(), found.barycentric_area]
    rows = zip(*(values.tolist() for values in (*reals, neighbours, parts, kinds)), strict=True)
    lines = [
        f"X {x:.9g} {y:.9g} {z:.9g} {curvature:.9g} {area:.9g} {degree} {part} {kind}"
        for x, y, z, curvature, area, degree, part, kind in rows
    ]
    return "\n".join([str(count), " ".join(words), *lines]) + "\n"
