"""What writers of surfaces over time share: frames with times and triangles, and new files."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from openmm import unit

from .._numbers import values_in, whole_number
from .._types import Array
from .._writing import naming
from ._arrays import box_of, in_boxes, over_frames
from .surface_series import SurfaceFrame, components
from .trajectories import Trajectory

__all__ = ["Types", "each_surface", "fresh_file"]


def each_surface(
    where: str,
    take: Callable[[SurfaceFrame], None],
    vertices,
    triangles=None,
    times=None,
    steps=None,
    box=None,
) -> int:
    """Call a function of every frame; arguments and errors as for `write_vtkhdf`.

    Parameters
    ----------
    where : str
        The function that the user called, for messages.
    take : callable
        Of a `SurfaceFrame`.

    Returns
    -------
    int
        How many frames there were.
    """
    if isinstance(vertices, (str, os.PathLike)):
        vertices = Trajectory(vertices)
    if isinstance(vertices, Trajectory):
        triangles = vertices.triangles() if triangles is None else triangles
        if vertices.timed:
            times = vertices.times() if times is None else times
            steps = vertices.steps() if steps is None else steps
        if vertices.suffix == ".gsd":
            # Of a file of ours it is there only if the surface lives in it.
            box = vertices.boxes() if box is None else box
    if triangles is None:
        raise ValueError(f"{where}: need triangles; there is no file of them to take")
    box = box_of(box, vertices, triangles)
    stamps = _Stamps(where, times, steps)

    def collect(frames, faces, box):
        for frame in frames:
            take(SurfaceFrame(*stamps.next(), frame, faces, box))
        return np.zeros(len(frames))

    count = np.size(over_frames(in_boxes(collect, box), vertices, triangles))
    stamps.check(count)
    return count


@contextlib.contextmanager
def fresh_file(path: Path) -> Iterator[Path]:
    """The name of a file that takes the place of another once it is whole.

    Raises
    ------
    OSError
        The system refuses; the message names `path`, and a file that was there is as before.
    """
    fresh = path.with_name(f".{path.name}.{os.getpid()}.new")
    try:
        # gsd would leave it to its owner and group alone.
        fresh.touch()
        yield fresh
        with fresh.open("rb") as file:
            os.fsync(file.fileno())
        os.replace(fresh, path)
    except OSError as reason:
        if reason.errno is None:
            raise
        with naming(path):
            raise OSError(reason.errno, reason.strerror) from None
    finally:
        with contextlib.suppress(OSError):
            # A library that fails to close it would keep its space until the process ends.
            os.truncate(fresh, 0)
            fresh.unlink()


class Types:
    """Kinds of vertices, given or the numbers of their connected surfaces.

    Parameters
    ----------
    where : str
        The function that the user called, for messages.
    given : array_like of int or None
        Shape (num_vertices,), or (num_frames, num_vertices) if they change.

    Raises
    ------
    ValueError
        They are no whole numbers from 0, or of another shape.
    """

    def __init__(self, where: str, given):
        self.where, self._number = where, 0
        self._given = None if given is None else np.asarray(given)
        if self._given is None:
            return
        if self._given.dtype.kind not in "iu" or self._given.min(initial=0) < 0:
            raise ValueError(f"{where}: types: need whole numbers from 0")
        if self._given.ndim not in (1, 2):
            raise ValueError(
                f"{where}: types: need shape (num_vertices,) or (num_frames, num_vertices), got "
                f"{self._given.shape}"
            )

    def next(self, frame: SurfaceFrame) -> Array:
        """Those of the next frame, shape (num_vertices,)."""
        count, number = len(frame.vertices), self._number
        self._number += 1
        if self._given is None:
            return components(frame.triangles, count)
        if self._given.ndim == 2 and number >= len(self._given):
            raise ValueError(
                f"{self.where}: types: there are those of {len(self._given)} frames, but more "
                "frames"
            )
        found = self._given[number] if self._given.ndim == 2 else self._given
        if len(found) != count:
            raise ValueError(f"{self.where}: types: there are {len(found)}, but {count} vertices")
        return found


class _Stamps:
    """Steps and times of frames; the number of the frame where they are not given."""

    def __init__(self, where, times, steps):
        self._where = where
        self._times = self._steps = None
        if times is not None:
            self._times = values_in(unit.picosecond, times, where, "times").ravel()
            if not (np.isfinite(self._times).all() and (np.diff(self._times) > 0).all()):
                raise ValueError(f"{where}: the times of the frames do not ascend")
        if steps is not None:
            self._steps = np.asarray(steps).ravel()
            for step in self._steps.tolist():
                whole_number(step, where, "steps", 0, 2**63 - 1)
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
                    f"{self._where}: there are {len(given)} {name}, but "
                    f"{'more' if more else count} frames"
                )
