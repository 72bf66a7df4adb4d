"""The meshes of a run for programs that draw surfaces: a file for each, or one for all."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .._mesh import files, geometry
from .._mesh.periodic import cut_images
from .._types import Array
from ..analysis.curvature import vertex_quantities
from ..analysis.frame_files import ExtendedXYZSeries, FrameFile, GSDSeries
from ..analysis.surface_series import SurfaceFrame, SurfaceSeries

__all__ = ["FRAMES", "MeshFrames", "SeriesFrames", "frames_writer"]

#: Vertices, shape (num_vertices, 3), nm, and triangles, shape (num_triangles, 3), of a membrane.
Part = tuple[np.ndarray, np.ndarray]

#: What frames can be written as; "none" writes none.
FRAMES = ("none", "ply", "obj", "stl", "vtk", "vtkhdf", "gsd", "extxyz")
# Formats that have room for values of the vertices.
_WITH_DATA = ("ply", "vtk")


def frames_writer(
    folder: Path, name: str, kind: str, labels: Iterable[str], masses: Any = 1.0
) -> Any:
    """What writes the meshes of a run in a format.

    Parameters
    ----------
    folder : Path
        Of the run.
    name : str
        Of the run.
    kind : str
        One of `FRAMES`.
    labels : iterable of str
        Of the membranes.
    masses : array_like, optional
        Of their vertices, amu, for formats that have masses.

    Returns
    -------
    MeshFrames or SeriesFrames or None
        None for "none".

    Raises
    ------
    ValueError
        If there is no such format.
    ImportError
        If VTKHDF is asked for without h5py, or GSD without gsd.
    """
    if kind not in FRAMES:
        raise ValueError(f"frames must be one of {', '.join(FRAMES)}, got {kind!r}")
    if kind == "none":
        return None
    path = folder / f"{name}.{kind}"
    if kind == "vtkhdf":
        return SeriesFrames(SurfaceSeries(path))
    if kind == "gsd":
        return SeriesFrames(GSDSeries(path, masses, "frames"))
    if kind == "extxyz":
        return SeriesFrames(ExtendedXYZSeries(path, "frames"))
    return MeshFrames(folder / "frames", name, kind, labels)


class SeriesFrames:
    """One file with all membranes and all frames.

    Parameters
    ----------
    series : SurfaceSeries or FrameFile
        The file.
    """

    def __init__(self, series: SurfaceSeries | FrameFile):
        self._series = series

    def write(
        self, number: int, step: int, time: float, parts: list[Part], box: Any = None
    ) -> None:
        """Add a frame; arguments as for `MeshFrames.write`."""
        if number:
            self._series.require()
        vertices, triangles = joined(parts)
        self._series.add([SurfaceFrame(step, time, vertices, triangles, box)])

    def misfit(self, number: int) -> str | None:
        """Why there are not so many frames; None if there are."""
        try:
            self._series.check(number)
        except ValueError as reason:
            return str(reason)
        return None

    def remove_from(self, number: int) -> None:
        """Remove the frames of this number and later ones.

        Raises
        ------
        ValueError
            If there are fewer.
        """
        if number:
            self._series.cut(number)
        else:
            self._series.remove()


class MeshFrames:
    """Files ``<name>_<label>_<number>.<kind>`` in a folder of their own.

    PLY and VTK carry ``mean_curvature``, H = C1 + C2 by Jülicher's scheme, 1/nm, and ``area``, a
    third of the triangles around a vertex, nm². Each frame has its own triangles.

    Parameters
    ----------
    folder : Path
        Where to write; made when the first frame is.
    name : str
        How all names begin.
    kind : str
        ``ply``, ``obj``, ``stl`` or ``vtk``.
    labels : iterable of str
        Of the membranes.
    """

    def __init__(self, folder: Path, name: str, kind: str, labels: Iterable[str]):
        self._folder = folder
        self._name = name
        self._kind = kind
        self._labels = list(labels)

    def write(
        self, number: int, step: int, time: float, parts: list[Part], box: Array | None = None
    ) -> None:
        """Write the meshes of one frame.

        Parameters
        ----------
        number : int
            Of the frame, from 0.
        step : int
            Of the simulation.
        time : float
            ps.
        parts : list of Part
            Of each membrane, as it is in this frame.
        box : ndarray, optional
            The periodic box that they live in, shape (3, 3), nm. PLY keeps it; other formats have
            surfaces that are cut at its faces.
        """
        self._folder.mkdir(exist_ok=True)
        for label, (vertices, triangles) in zip(self._labels, parts, strict=True):
            path = self._folder / f"{self._name}_{label}_{number:06d}.{self._kind}"
            self._write(path, vertices, triangles, box)

    def _write(self, path: Path, vertices: Array, triangles: Array, box) -> None:
        data = None
        if self._kind in _WITH_DATA:
            found = vertex_quantities(vertices, triangles, box=box)
            data = {"mean_curvature": found.mean_curvature(), "area": found.barycentric_area}
        if box is not None and self._kind != "ply":
            edges = geometry.edges_of(triangles)
            vertices, triangles, owners = cut_images(vertices, triangles, edges, box)
            data = data and {name: values[owners] for name, values in data.items()}
            box = None
        files.write(path, vertices, triangles, data, box=box)

    def misfit(self, number: int) -> str | None:
        """None: frames that were taken elsewhere are not missed."""
        return None

    def remove_from(self, number: int) -> None:
        """Remove the frames of this number and later ones."""
        for label in self._labels:
            # Nothing but digits may follow: one label may be the beginning of another.
            named = re.compile(re.escape(f"{self._name}_{label}_") + r"(\d+)")
            for path in self._folder.glob(f"*.{self._kind}"):
                found = named.fullmatch(path.stem)
                if found and int(found.group(1)) >= number:
                    path.unlink()


def joined(parts: Iterable[Part]) -> Part:
    """Several surfaces as one: their vertices one after another, and all triangles."""
    vertices, triangles, count = [], [], 0
    for points, corners in parts:
        vertices.append(points)
        triangles.append(corners + count)
        count += len(points)
    return np.concatenate(vertices), np.concatenate(triangles)
