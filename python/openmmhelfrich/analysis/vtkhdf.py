"""Finished runs, or any frames, as one file that ParaView opens."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from .._types import File, Values
from .._writing import naming
from ._surface_frames import each_surface
from .surface_series import SurfaceSeries

__all__ = ["write_vtkhdf"]

# Frames that are added at a time.
_BATCH = 64


def write_vtkhdf(
    path: File,
    vertices: Any,
    triangles: Any = None,
    times: ArrayLike | None = None,
    steps: ArrayLike | None = None,
    *,
    box: Values | None = None,
) -> int:
    """Write surfaces over time as VTKHDF, which ParaView opens: a finished run, or any frames.

    `SurfaceSeries` says what is in the file.

    Parameters
    ----------
    path : str or Path
        ``.vtkhdf``; a file that is there is replaced when the new one is whole.
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh, optional
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own;
        counter-clockwise seen from outside, surfaces that all vertices belong to. Default: those of
        a GSD file or of ``<name>.triangles`` beside a trajectory.
    times : array_like or Quantity, optional
        ps, ascending, shape (num_frames,). Default: those of an XTC or GSD file, or else 0, 1, 2,
        …
    steps : array_like of int, optional
        Steps of the simulation, from 0, shape (num_frames,), with defaults as for `times`.
    box : array_like or Quantity, optional
        Periodic box, shape (3, 3), or (num_frames, 3, 3) if each frame has its own, nm. Default:
        that of a `Mesh` among the other arguments, if it has one; with a trajectory then the boxes
        in its file, if there are any.

    Returns
    -------
    int
        How many frames were written.

    Raises
    ------
    ImportError
        Without h5py.
    TypeError
        Times that are no numbers, or of another dimension.
    ValueError
        Another suffix, no triangles, numbers of frames that differ, times that do not ascend, steps
        that are no whole numbers from 0, or as for `mean_curvature`.
    OSError
        If the system refuses; a file that was there is as before.

    Examples
    --------
    >>> write_vtkhdf("run.vtkhdf", "run/run.xtc")  # with run/run.triangles beside it
    """
    path = Path(path)
    if path.suffix.lower() != ".vtkhdf":
        raise ValueError(f"write_vtkhdf: {path}: the suffix must be .vtkhdf")
    fresh = path.with_name(f".{path.name}.{os.getpid()}.new")
    series, batch = SurfaceSeries(fresh), []

    def add(frame):
        batch.append(frame)
        if len(batch) == _BATCH:
            series.add(batch)
            batch.clear()

    try:
        count = each_surface("write_vtkhdf", add, vertices, triangles, times, steps, box)
        series.add(batch)
        with naming(path):
            os.replace(fresh, path)
    finally:
        series.remove()
    return count
