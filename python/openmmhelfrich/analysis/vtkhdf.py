"""Finished runs, or any frames, as one file that ParaView opens."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from .._writing import naming
from ._arrays import box_of, in_boxes, over_frames
from .surface_series import SurfaceFrame, SurfaceSeries
from .trajectories import Trajectory

__all__ = ["write_vtkhdf"]

# Frames that are added at a time.
_BATCH = 64


def write_vtkhdf(path, vertices, triangles=None, times=None, steps=None, *, box=None) -> int:
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
        ``<name>.triangles`` beside a trajectory.
    times : array_like, optional
        ps, ascending, shape (num_frames,). Default: those of an XTC file, or else 0, 1, 2, …
    steps : array_like of int, optional
        Steps of the simulation, shape (num_frames,), with defaults as for `times`.
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
    ValueError
        Another suffix, no triangles, numbers of frames that differ, times that do not ascend, or as
        for `mean_curvature`.
    OSError
        If the system refuses; a file that was there is as before.

    Examples
    --------
    >>> write_vtkhdf("run.vtkhdf", "run/run.xtc")  # with run/run.triangles beside it
    """
    path = Path(path)
    if path.suffix.lower() != ".vtkhdf":
        raise ValueError(f"write_vtkhdf: {path}: the suffix must be .vtkhdf")
    if isinstance(vertices, (str, os.PathLike)):
        vertices = Trajectory(vertices)
    if isinstance(vertices, Trajectory):
        triangles = vertices.triangles() if triangles is None else triangles
        if vertices.suffix == ".xtc":
            times = vertices.times() if times is None else times
            steps = vertices.steps() if steps is None else steps
    if triangles is None:
        raise ValueError("write_vtkhdf: need triangles; there is no file of them to take")
    box = box_of(box, vertices, triangles)
    fresh = path.with_name(f".{path.name}.{os.getpid()}.new")
    series, batch = SurfaceSeries(fresh), []
    stamps = _Stamps(times, steps)

    def collect(frames, faces, box):
        for frame in frames:
            batch.append(SurfaceFrame(*stamps.next(), frame, faces, box))
            if len(batch) == _BATCH:
                series.add(batch)
                batch.clear()
        return np.zeros(len(frames))

    try:
        count = np.size(over_frames(in_boxes(collect, box), vertices, triangles))
        series.add(batch)
        stamps.check(count)
        with naming(path):
            os.replace(fresh, path)
    finally:
        series.remove()
    return count


class _Stamps:
    """Steps and times of frames; the number of the frame where they are not given."""

    def __init__(self, times, steps):
        self._times = None if times is None else np.asarray(times, dtype=float).ravel()
        self._steps = None if steps is None else np.asarray(steps).ravel()
        if self._times is not None and not (np.diff(self._times) > 0).all():
            raise ValueError("write_vtkhdf: the times of the frames do not ascend")
        self._number = 0

    def next(self) -> tuple[int, float]:
        """Step and time of the next frame."""
        number = self._number
        self._number += 1
        self.check(number + 1, more=True)
        step = number if self._steps is None else int(self._steps[number])
        return step, float(number if self._times is None else self._times[number])

    def check(self, count: int, more: bool = False) -> None:
        """Raise a ValueError unless there are so many, or more if that is enough."""
        for name, given in (("times", self._times), ("steps", self._steps)):
            if given is not None and (len(given) < count or (len(given) > count and not more)):
                raise ValueError(
                    f"write_vtkhdf: there are {len(given)} {name}, but "
                    f"{'more' if more else count} frames"
                )
