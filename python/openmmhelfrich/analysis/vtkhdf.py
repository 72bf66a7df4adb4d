"""Surfaces over time in one file that ParaView opens, triangles of each frame among them: VTKHDF.

VTKHDF is HDF5 with a group of a fixed layout, of which this is the part for surfaces (PolyData)
over time, version 2.0: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format. It takes
VTK 9.3, ParaView 5.12 or newer ones to read it.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .._journal import JournaledFile
from .._writing import naming
from ._arrays import over_frames, triangles_of
from .curvature import vertex_quantities
from .elements import edges_of, triangle_areas
from .tables import import_h5py
from .trajectories import Trajectory

__all__ = ["SurfaceFrame", "SurfaceSeries", "components", "write_vtkhdf"]

# Our own group, which VTK does not look at.
_OURS = "openmm-helfrich"
_UNUSED = ("Vertices", "Lines", "Strips")
# The place of polygons among the four kinds of cells.
_POLYGONS = 2
_POINT_DATA = {"mean_curvature": "<f4", "area": "<f4", "neighbours": "<i4"}
_CELL_DATA = {"area": "<f4"}
# Rows of one chunk of a dataset, at least.
_CHUNK = 256
# Frames that are added at a time.
_BATCH = 64


def write_vtkhdf(path, vertices, triangles=None, times=None, steps=None) -> int:
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
        counter-clockwise seen from outside, closed surfaces that all vertices belong to. Default:
        those of ``<name>.triangles`` beside a trajectory.
    times : array_like, optional
        ps, ascending, shape (num_frames,). Default: those of an XTC file, or else 0, 1, 2, …
    steps : array_like of int, optional
        Steps of the simulation, shape (num_frames,), with defaults as for `times`.

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
    fresh = path.with_name(f".{path.name}.{os.getpid()}.new")
    series, batch = SurfaceSeries(fresh), []
    stamps = _Stamps(times, steps)

    def collect(frames, faces, first):
        for number, frame in enumerate(frames, start=first):
            batch.append(SurfaceFrame(*stamps.at(number), frame, faces))
            if len(batch) == _BATCH:
                series.add(batch)
                batch.clear()
        return np.zeros(len(frames))

    try:
        count = np.size(over_frames(collect, vertices, triangles))
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

    def at(self, number: int) -> tuple[int, float]:
        """Step and time of a frame."""
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


class SurfaceFrame(NamedTuple):
    """One moment of a surface."""

    step: int
    """Of the simulation."""
    time: float
    """ps."""
    vertices: np.ndarray
    """Shape (num_vertices, 3), nm."""
    triangles: np.ndarray
    """Shape (num_triangles, 3), counter-clockwise seen from outside."""


class SurfaceSeries:
    """A VTKHDF file to which frames are added, each with positions and triangles of its own.

    Vertices carry ``mean_curvature``, H = C1 + C2 by Jülicher's scheme (B13), 1/nm; ``area``, a
    third of the triangles around, nm²; ``neighbours``, how many there are; ``component``, the
    number of the connected surface that they belong to, from 0. Triangles carry ``area``, nm², and
    ``component``. Coordinates are in nm in double precision, values in single precision, times in
    ps. Triangles are stored anew only where they have changed. The group ``/openmm-helfrich`` has
    the ``step`` of the simulation of each frame.

    The file is closed between additions, so that ParaView can look at it during a run. A kill at
    any moment leaves a file that `frames`, `add` or `cut` make whole again, see `_journal`.

    Parameters
    ----------
    path : str or Path
        Of the file, ``.vtkhdf``; it is made with the first frame.

    Raises
    ------
    ImportError
        Without h5py.
    """

    def __init__(self, path):
        self.path = Path(path)
        self._h5py = import_h5py("or write PLY, OBJ or VTK")
        self._file = JournaledFile(self.path)

    def remove(self) -> None:
        """Remove what is there, so that `add` begins a new file."""
        self._file.remove()

    def add(self, frames: Iterable[SurfaceFrame]) -> None:
        """Add frames; they are on the disk when this returns.

        Raises
        ------
        OSError
            If the system refuses; no frame has been added then.
        ValueError
            If the numbers of vertices or triangles are not those of the file, or as for
            `mean_curvature`.
        """
        frames = list(frames)
        if not frames:
            return
        self._file.recover()
        new = not self.path.exists()
        with self._file.change(new) as raw, self._open(raw, "w" if new else "r+") as file:
            if new:
                self._lay_out(file, frames[0])
            for frame in frames:
                self._append(file, frame)

    def cut(self, num_frames: int) -> None:
        """Keep the first frames only.

        Raises
        ------
        ValueError
            If there are fewer.
        """
        steps = self.steps()
        if num_frames > len(steps):
            raise ValueError(f"{self.path} has {len(steps)} frames, not {num_frames}")
        if num_frames == len(steps):
            return
        if num_frames == 0:
            self.remove()
            return
        with self._file.change() as raw, self._open(raw, "r+") as file:
            self._resize(file, num_frames)

    def steps(self) -> np.ndarray:
        """The step of the simulation of each frame, shape (num_frames,).

        Raises
        ------
        ValueError
            If the file is none of this class.
        """
        self._file.recover()
        if not self.path.exists():
            return np.empty(0, dtype=np.int64)
        try:
            with self._h5py.File(self.path, "r") as file:
                return file[f"{_OURS}/step"][:]
        except (OSError, KeyError) as reason:
            raise ValueError(
                f"{self.path} is no VTKHDF file of this package ({reason}); do not append"
            ) from None

    def _open(self, raw, mode: str):
        return self._h5py.File(raw, mode)

    def _lay_out(self, file, frame: SurfaceFrame) -> None:
        """Everything but frames; what is the same in all frames is stored once."""
        num_vertices, num_triangles = len(frame.vertices), len(frame.triangles)
        kind = components(frame.triangles, num_vertices)
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0], dtype=np.int64)
        # VTK reads a string of fixed length only.
        root.attrs.create("Type", np.bytes_("PolyData"))
        root["NumberOfPoints"] = np.array([num_vertices], dtype=np.int64)
        _growing(root, "Points", "<f8", num_vertices, (3,))
        for name in _UNUSED:
            _cells(root, name, 0)
            root[f"{name}/Connectivity"] = np.empty(0, dtype=np.int32)
        _cells(root, "Polygons", num_triangles)
        _growing(root, "Polygons/Connectivity", "<i4", 3 * num_triangles)
        for name, dtype in _POINT_DATA.items():
            _growing(root, f"PointData/{name}", dtype, num_vertices)
        for name, dtype in _CELL_DATA.items():
            _growing(root, f"CellData/{name}", dtype, num_triangles)
        root["PointData/component"] = kind.astype(np.int32)
        root["CellData/component"] = kind[frame.triangles[:, 0]].astype(np.int32)
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(0)
        _growing(steps, "Values", "<f8")
        for name in ("NumberOfParts", "PartOffsets", "PointOffsets"):
            _growing(steps, name, "<i8")
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            _growing(steps, name, "<i8", shape=(4,))
        for name in (*_POINT_DATA, "component"):
            _growing(steps, f"PointDataOffsets/{name}", "<i8")
        for name in (*_CELL_DATA, "component"):
            _growing(steps, f"CellDataOffsets/{name}", "<i8")
        ours = file.create_group(_OURS)
        ours.attrs["units"] = "nm, ps"
        _growing(ours, "step", "<i8")

    def _append(self, file, frame: SurfaceFrame) -> None:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        number = int(steps.attrs["NSteps"])
        num_vertices, num_triangles = self._sizes(root)
        if (len(frame.vertices), len(frame.triangles)) != (num_vertices, num_triangles):
            raise ValueError(
                f"{self.path}: its frames have {num_vertices} vertices and {num_triangles} "
                f"triangles, not {len(frame.vertices)} and {len(frame.triangles)}; give another "
                "file"
            )
        corners = triangles_of(frame.triangles, num_vertices)
        found = vertex_quantities(frame.vertices, corners)
        _extend(root["Points"], frame.vertices)
        _extend(root["PointData/mean_curvature"], found.mean_curvature())
        _extend(root["PointData/area"], found.barycentric_area)
        ends = np.concatenate(edges_of(corners)[:2])
        neighbours = np.bincount(ends, minlength=num_vertices)
        _extend(root["PointData/neighbours"], neighbours)
        _extend(root["CellData/area"], triangle_areas(frame.vertices, corners))
        connectivity = root["Polygons/Connectivity"]
        last = np.array(connectivity[-3 * num_triangles :])
        if not np.array_equal(last, corners.ravel()):
            _extend(connectivity, corners.ravel())
        begin = [0, 0, 0, 0]
        begin[_POLYGONS] = len(connectivity) - 3 * num_triangles
        rows = {
            "Values": frame.time,
            "NumberOfParts": 1,
            "PartOffsets": 0,
            "PointOffsets": number * num_vertices,
            "CellOffsets": [0, 0, 0, 0],
            "ConnectivityIdOffsets": begin,
            "PointDataOffsets/component": 0,
            "CellDataOffsets/component": 0,
        }
        rows |= {f"PointDataOffsets/{name}": number * num_vertices for name in _POINT_DATA}
        rows |= {f"CellDataOffsets/{name}": number * num_triangles for name in _CELL_DATA}
        for name, row in rows.items():
            _extend(steps[name], [row])
        _extend(file[f"{_OURS}/step"], [frame.step])
        steps.attrs["NSteps"] = np.int64(number + 1)

    def _resize(self, file, num_frames: int) -> None:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        num_vertices, num_triangles = self._sizes(root)
        used = steps["ConnectivityIdOffsets"][num_frames - 1, _POLYGONS] + 3 * num_triangles
        root["Polygons/Connectivity"].resize(used, axis=0)
        root["Points"].resize(num_frames * num_vertices, axis=0)
        for name in _POINT_DATA:
            root[f"PointData/{name}"].resize(num_frames * num_vertices, axis=0)
        for name in _CELL_DATA:
            root[f"CellData/{name}"].resize(num_frames * num_triangles, axis=0)

        def shorten(name, found):
            if isinstance(found, self._h5py.Dataset):
                found.resize(num_frames, axis=0)

        steps.visititems(shorten)
        file[f"{_OURS}/step"].resize(num_frames, axis=0)
        steps.attrs["NSteps"] = np.int64(num_frames)

    @staticmethod
    def _sizes(root) -> tuple[int, int]:
        return int(root["NumberOfPoints"][0]), int(root["Polygons/NumberOfCells"][0])


def components(triangles: np.ndarray, num_vertices: int) -> np.ndarray:
    """The number of the connected surface of each vertex, in the order of their first vertices.

    Parameters
    ----------
    triangles : ndarray of int
        Shape (num_triangles, 3).
    num_vertices : int

    Returns
    -------
    ndarray of int
        Shape (num_vertices,).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    start, end = triangles[:, [0, 1]].T
    other = triangles[:, 2]
    rows, columns = np.concatenate([start, end]), np.concatenate([end, other])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(num_vertices, num_vertices))
    return connected_components(graph, directed=False)[1]


def _growing(group, name: str, dtype: str, rows: int = 1, shape: tuple[int, ...] = ()) -> None:
    """An empty dataset to which so many rows at a time are added."""
    chunk = (rows * -(-_CHUNK // rows), *shape)
    group.create_dataset(name, (0, *shape), dtype, maxshape=(None, *shape), chunks=chunk)


def _cells(root, name: str, count: int) -> None:
    """The sizes of one kind of cells, all triangles."""
    root[f"{name}/NumberOfCells"] = np.array([count], dtype=np.int64)
    root[f"{name}/NumberOfConnectivityIds"] = np.array([3 * count], dtype=np.int64)
    # Of the type that the connectivity has, which VTK before 9.7 insists on.
    root[f"{name}/Offsets"] = np.arange(0, 3 * count + 1, 3, dtype=np.int32)


def _extend(dataset, rows) -> None:
    count = len(rows)
    dataset.resize(len(dataset) + count, axis=0)
    dataset[-count:] = rows
