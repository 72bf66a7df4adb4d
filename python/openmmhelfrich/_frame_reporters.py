"""Reporters that write the surface of a membrane, frame by frame, to one file."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path

import numpy as np
from openmm import unit

from ._surface_reporters import SurfaceReporter
from .analysis.frame_files import ExtendedXYZSeries, FrameFile, GSDSeries
from .analysis.surface_series import SurfaceFrame, SurfaceSeries

__all__ = ["ExtendedXYZReporter", "GSDReporter", "VTKHDFReporter"]


class SeriesReporter(SurfaceReporter):
    """Frames of one surface, with the triangles of their moments, to a file that grows.

    Subclasses have `_suffixes`, of the names that they take, and `_series`, the file.
    """

    _suffixes: tuple[str, ...]
    _spans = True

    def __init__(self, file, reportInterval, triangles, *, offset=0, append=False):
        super().__init__(file, reportInterval, triangles, offset, append)
        if Path(file).suffix.lower() not in self._suffixes:
            raise ValueError(
                f"{type(self).__name__}: {file}: the suffix must be {' or '.join(self._suffixes)}"
            )

    @abstractmethod
    def _series_of(self, simulation) -> FrameFile | SurfaceSeries:
        """The file of a simulation."""

    def _begin(self, simulation):
        self._series, self._num_frames = self._series_of(simulation), 0
        if not self._append:
            self._series.remove()
            return None
        try:
            steps = self._series.steps()
        except ValueError as reason:
            raise ValueError(f"{type(self).__name__}: {reason}; do not append") from None
        kept = steps[steps <= simulation.currentStep]
        self._series.cut(len(kept))
        self._dropped = len(steps) - len(kept)
        self._num_frames = len(kept)
        return kept[-1] if len(kept) else None

    def _write(self, simulation, state, time, vertices, triangles, box):
        if self._num_frames:
            self._series.require()
        step = int(simulation.currentStep)
        self._series.add([SurfaceFrame(step, time, vertices, triangles, box)])
        self._num_frames += 1


class VTKHDFReporter(SeriesReporter):
    """Writes the surface of a membrane while a Simulation runs, in one file that ParaView opens.

    Each frame has its own positions and triangles, so that membranes whose bonds flip are shown as
    they are. Vertices carry ``mean_curvature``, H = C1 + C2 by Jülicher's scheme (B13,
    doi:10.1103/PhysRevE.108.015301), 1/nm; ``area``, a third of the triangles around, nm²;
    ``neighbours``, how many there are; and ``component``, the number of their connected surface,
    from 0. Triangles carry ``area``, nm², and ``component``. A surface that spans its periodic box
    is cut at the faces of the box, where vertices are there once for each image. Coordinates are in
    nm, times in ps. It takes VTK 9.3, ParaView 5.12 or newer ones to read them.

    Every frame is on disk when it has been written, and the file is closed in between: ParaView may
    look at it during the run. A kill in the middle of a frame leaves ``<file>.journal``, from which
    the next reporter with ``append=True`` makes the file whole.

    Parameters
    ----------
    file : str or Path
        ``.vtkhdf``. It needs h5py (``pip install openmm-helfrich[hdf5]``).
    reportInterval : int
        Steps between frames, 1 or more.
    triangles : Mesh or array_like of int
        As for `ModeReporter`; point i of the file is the i-th of their particles, in ascending
        order.
    offset : int
        Added to the indices of the triangles. Default 0.
    append : bool
        As for `ModeReporter`: frames of later steps are dropped.

    Raises
    ------
    ImportError
        Without h5py.
    ValueError
        A number out of range, or another suffix; at the first report, a file that is none of this
        reporter, belongs to another one of the Simulation, or has other numbers of vertices or
        triangles.

    Examples
    --------
    >>> simulation.reporters.append(VTKHDFReporter("vesicle.vtkhdf", 500, vesicle.mesh))
    >>> simulation.step(100_000)
    """

    _suffixes = (".vtkhdf",)

    def __init__(self, file, reportInterval, triangles, *, offset=0, append=False):
        super().__init__(file, reportInterval, triangles, offset=offset, append=append)
        self._made = SurfaceSeries(file)

    def _series_of(self, simulation):
        return self._made


class GSDReporter(SeriesReporter):
    """Writes the surface of a membrane while a Simulation runs as GSD, for HOOMD and OVITO.

    Each frame has its own positions, bonds and triangles, see `analysis.write_gsd` for what is
    in it; masses are those of the System, and types the numbers of connected surfaces.
    `analysis.read_gsd` and `analysis.Trajectory` read the file back. Numbers are in single
    precision, nm, amu, ps.

    Every frame is on disk when it has been written, and the file is closed in between.

    Parameters
    ----------
    file : str or Path
        ``.gsd``. It needs the package gsd (``pip install openmm-helfrich[gsd]``).
    reportInterval : int
        Steps between frames, 1 or more.
    triangles : Mesh or array_like of int
        As for `ModeReporter`; particle i of the file is the i-th of their particles, in ascending
        order.
    offset : int
        Added to the indices of the triangles. Default 0.
    append : bool
        As for `ModeReporter`: frames of later steps are dropped.

    Raises
    ------
    ImportError
        At the first report, without the package gsd.
    ValueError
        A number out of range, or another suffix; at the first report, a file that is no GSD file,
        belongs to another reporter of the Simulation, or has another number of vertices.

    Examples
    --------
    >>> simulation.reporters.append(GSDReporter("vesicle.gsd", 500, vesicle.mesh))
    >>> simulation.step(100_000)
    """

    _suffixes = (".gsd",)

    def _series_of(self, simulation):
        system = simulation.system
        masses = [system.getParticleMass(int(i)) / unit.dalton for i in self._particles]
        return GSDSeries(self._file, np.array(masses), "GSDReporter")


class ExtendedXYZReporter(SeriesReporter):
    """Writes the vertices of a membrane while a Simulation runs as extended XYZ, for OVITO and ASE.

    Each frame has positions and, of each vertex, curvature, area, neighbours and component of its
    moment, see `analysis.write_extended_xyz`; the format has no triangles.

    Every frame is on disk when it has been written, and the file is closed in between.

    Parameters
    ----------
    file : str or Path
        ``.extxyz`` or ``.xyz``.
    reportInterval, triangles, offset, append
        As for `GSDReporter`.

    Raises
    ------
    ValueError
        A number out of range, or another suffix; at the first report, a file of something else, or
        one of another reporter of the Simulation.

    Examples
    --------
    >>> simulation.reporters.append(ExtendedXYZReporter("vesicle.extxyz", 500, vesicle.mesh))
    >>> simulation.step(100_000)
    """

    _suffixes = (".extxyz", ".xyz")

    def _series_of(self, simulation):
        return ExtendedXYZSeries(self._file, "ExtendedXYZReporter")
