"""Surfaces over time in one file that ParaView opens, triangles of each frame among them: VTKHDF.

VTKHDF is HDF5 with a group of a fixed layout, of which this is the part for surfaces (PolyData)
over time, version 2.0: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format. It takes
VTK 9.3, ParaView 5.12 or newer ones to read it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from .._journal import JournaledFile
from .._mesh.periodic import cut_images
from .._types import Array, File
from ._arrays import triangles_of
from ._growing import GrowingFile
from .curvature import vertex_quantities
from .elements import edges_of, triangle_areas
from .tables import import_h5py

__all__ = ["SurfaceFrame", "SurfaceSeries", "components"]

# Our own group, which VTK does not look at.
_OURS = "openmm-helfrich"
_UNUSED = ("Vertices", "Lines", "Strips")
# The place of polygons among the four kinds of cells.
_POLYGONS = 2
_POINT_DATA = {"mean_curvature": "<f4", "area": "<f4", "neighbours": "<i4"}
_CELL_DATA = {"area": "<f4"}
_COMPONENT = {"component": "<i4"}
# Rows of one chunk of a dataset, at least.
_CHUNK = 256


class SurfaceFrame(NamedTuple):
    """One moment of a surface."""

    step: int
    """Of the simulation."""
    time: float
    """ps."""
    vertices: Array
    """Shape (num_vertices, 3), nm."""
    triangles: Array
    """Shape (num_triangles, 3), counter-clockwise seen from outside."""
    box: Array | None = None
    """The periodic box, shape (3, 3), nm, if the surface lives in one."""


class SurfaceSeries(GrowingFile):
    """A VTKHDF file to which frames are added, each with positions and triangles of its own.

    Vertices carry ``mean_curvature``, H = C1 + C2 by Jülicher's scheme (B13), 1/nm; ``area``, a
    third of the triangles around, nm²; ``neighbours``, how many there are; ``component``, the
    number of the connected surface that they belong to, from 0. Triangles carry ``area``, nm², and
    ``component``. Coordinates are in nm in double precision, values in single precision, times in
    ps. Triangles are stored anew only where they have changed. Of a surface in a periodic box, each
    connected part is in one piece; one that spans the box is cut at its faces, where a vertex with
    triangles on both sides is there once for each of its images (`Mesh.unfolded`), with the same
    values. The group ``/openmm-helfrich`` has the ``step`` of the simulation of each frame.

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

    def __init__(self, path: File) -> None:
        super().__init__(path)
        self._h5py = import_h5py("or write PLY, OBJ or VTK")
        self._file = JournaledFile(self.path)

    def remove(self) -> None:
        """Remove what is there, so that `add` begins a new file."""
        self._file.remove()

    def require(self) -> None:
        """Check that the file is there, so that `add` does not begin a new one.

        Raises
        ------
        FileNotFoundError
            It has been taken away.
        """
        self._file.recover()
        super().require()

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

    def steps(self) -> Array:
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
                f"{self.path} is no VTKHDF file of this package, or is damaged ({reason})"
            ) from None

    def _shorten(self, num_frames: int) -> None:
        with self._file.change() as raw, self._open(raw, "r+") as file:
            self._resize(file, num_frames)

    def _open(self, raw, mode: str):
        return self._h5py.File(raw, mode)

    def _lay_out(self, file, frame: SurfaceFrame) -> None:
        """Everything but frames."""
        num_vertices, num_triangles = len(frame.vertices), len(frame.triangles)
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0], dtype=np.int64)
        # VTK reads a string of fixed length only.
        root.attrs.create("Type", np.bytes_("PolyData"))
        _growing(root, "NumberOfPoints", "<i8")
        _growing(root, "Points", "<f8", num_vertices, (3,))
        for name in (*_UNUSED, "Polygons"):
            rows = 3 * num_triangles if name == "Polygons" else 1
            for size in ("NumberOfCells", "NumberOfConnectivityIds"):
                _growing(root, f"{name}/{size}", "<i8")
            # Of one type, which VTK before 9.7 insists on.
            _growing(root, f"{name}/Offsets", "<i4", rows // 3 + 1)
            _growing(root, f"{name}/Connectivity", "<i4", rows)
        for name, dtype in (_POINT_DATA | _COMPONENT).items():
            _growing(root, f"PointData/{name}", dtype, num_vertices)
        for name, dtype in (_CELL_DATA | _COMPONENT).items():
            _growing(root, f"CellData/{name}", dtype, num_triangles)
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(0)
        _growing(steps, "Values", "<f8")
        for name in ("NumberOfParts", "PartOffsets", "PointOffsets"):
            _growing(steps, name, "<i8")
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            _growing(steps, name, "<i8", shape=(4,))
        for name in (*_POINT_DATA, *_COMPONENT):
            _growing(steps, f"PointDataOffsets/{name}", "<i8")
        for name in (*_CELL_DATA, *_COMPONENT):
            _growing(steps, f"CellDataOffsets/{name}", "<i8")
        ours = file.create_group(_OURS)
        ours.attrs["units"] = "nm, ps"
        ours.attrs["vertices"] = num_vertices
        ours.attrs["triangles"] = num_triangles
        _growing(ours, "step", "<i8")

    def _append(self, file, frame: SurfaceFrame) -> None:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        num_vertices, num_triangles = self._sizes(file)
        if (len(frame.vertices), len(frame.triangles)) != (num_vertices, num_triangles):
            raise ValueError(
                f"{self.path}: its frames have {num_vertices} vertices and {num_triangles} "
                f"triangles, not {len(frame.vertices)} and {len(frame.triangles)}; give another "
                "file"
            )
        corners = triangles_of(frame.triangles, num_vertices)
        start, end = edges_of(corners)[:2]
        found = vertex_quantities(frame.vertices, corners, box=frame.box)
        kind = components(corners, num_vertices)
        points, polygons, owners = frame.vertices, corners, slice(None)
        if frame.box is not None:
            edges = np.column_stack([start, end])
            points, polygons, owners = cut_images(points, corners, edges, frame.box)
        neighbours = np.bincount(np.concatenate([start, end]), minlength=num_vertices)
        part = self._part_of(root, len(points), num_triangles)
        cells, ids = [0, 0, 0, 0], [0, 0, 0, 0]
        cells[_POLYGONS] = part * num_triangles
        ids[_POLYGONS] = _extend_if_new(root["Polygons/Connectivity"], polygons.ravel())
        point_data = {
            "mean_curvature": found.mean_curvature()[owners],
            "area": found.barycentric_area[owners],
            "neighbours": neighbours[owners],
        }
        areas = triangle_areas(frame.vertices, corners, box=frame.box)
        of_points = _extend_if_new(root["PointData/component"], kind[owners])
        of_cells = _extend_if_new(root["CellData/component"], kind[corners[:, 0]])
        rows = {
            "Values": frame.time,
            "NumberOfParts": 1,
            "PartOffsets": part,
            "PointOffsets": _extend(root["Points"], points),
            "CellOffsets": cells,
            "ConnectivityIdOffsets": ids,
            "PointDataOffsets/component": of_points,
            "CellDataOffsets/component": of_cells,
            "CellDataOffsets/area": _extend(root["CellData/area"], areas),
        }
        for name, values in point_data.items():
            rows[f"PointDataOffsets/{name}"] = _extend(root[f"PointData/{name}"], values)
        for name, row in rows.items():
            _extend(steps[name], [row])
        _extend(file[f"{_OURS}/step"], [frame.step])
        steps.attrs["NSteps"] = np.int64(steps.attrs["NSteps"] + 1)

    @staticmethod
    def _part_of(root, num_points: int, num_triangles: int) -> int:
        """The place of the sizes of a frame: the last ones, or new ones if they differ."""
        sizes = root["NumberOfPoints"]
        if len(sizes) == 0 or sizes[-1] != num_points:
            _extend(sizes, [num_points])
            for name in (*_UNUSED, "Polygons"):
                count = num_triangles if name == "Polygons" else 0
                _extend(root[f"{name}/NumberOfCells"], [count])
                _extend(root[f"{name}/NumberOfConnectivityIds"], [3 * count])
                _extend(root[f"{name}/Offsets"], np.arange(0, 3 * count + 1, 3))
        return len(sizes) - 1

    def _resize(self, file, num_frames: int) -> None:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        num_triangles = self._sizes(file)[1]
        last = num_frames - 1
        part = int(steps["PartOffsets"][last])
        num_points = int(root["NumberOfPoints"][part])
        used = steps["ConnectivityIdOffsets"][last, _POLYGONS] + 3 * num_triangles
        root["Polygons/Connectivity"].resize(used, axis=0)
        root["Points"].resize(steps["PointOffsets"][last] + num_points, axis=0)
        for kind, size in (("PointData", num_points), ("CellData", num_triangles)):
            for name, values in root[kind].items():
                values.resize(steps[f"{kind}Offsets/{name}"][last] + size, axis=0)
        root["NumberOfPoints"].resize(part + 1, axis=0)
        for name in (*_UNUSED, "Polygons"):
            count = num_triangles if name == "Polygons" else 0
            root[f"{name}/NumberOfCells"].resize(part + 1, axis=0)
            root[f"{name}/NumberOfConnectivityIds"].resize(part + 1, axis=0)
            root[f"{name}/Offsets"].resize((part + 1) * (count + 1), axis=0)

        def shorten(name, found):
            if isinstance(found, self._h5py.Dataset):
                found.resize(num_frames, axis=0)

        steps.visititems(shorten)
        file[f"{_OURS}/step"].resize(num_frames, axis=0)
        steps.attrs["NSteps"] = np.int64(num_frames)

    def _sizes(self, file) -> tuple[int, int]:
        """The numbers of vertices and triangles, images not counted."""
        ours = file[_OURS]
        if "vertices" not in ours.attrs:
            raise ValueError(f"{self.path} was begun by an older version; give another file")
        return int(ours.attrs["vertices"]), int(ours.attrs["triangles"])


def components(triangles: Array, num_vertices: int) -> Array:
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


def _extend(dataset, rows) -> int:
    """Add rows; returns where they begin."""
    begin = len(dataset)
    dataset.resize(begin + len(rows), axis=0)
    dataset[begin:] = rows
    return begin


def _extend_if_new(dataset, rows) -> int:
    """Where rows begin that a dataset ends with, added if it does not."""
    begin = len(dataset) - len(rows)
    if begin >= 0 and np.array_equal(dataset[begin:], rows):
        return begin
    return _extend(dataset, rows)
