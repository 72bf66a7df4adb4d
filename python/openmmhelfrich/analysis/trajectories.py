"""Trajectories on disk, read in chunks."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .. import _system
from .._numbers import whole_number
from .._types import Array, File
from ._gsd import GSDFrame, frames_in
from .elements import edges_of

__all__ = ["Trajectory", "read_triangles"]

_SUFFIXES = (".xtc", ".dcd", ".pdb", ".gsd")
_ANGSTROM = 0.1  # nm


def read_triangles(path: File, num_triangles: int) -> Array:
    """The triangles of each frame of a run whose bonds flip, which stand beside its XTC file.

    Parameters
    ----------
    path : str or Path
        ``<name>.triangles``: little-endian integers of 32 bits, three for each triangle.
    num_triangles : int
        Of all membranes together; it never changes.

    Returns
    -------
    ndarray of int
        Shape (num_frames, num_triangles, 3), by particle, mapped from the file and not read before
        it is needed; all functions of this package that take triangles take it.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        It does not consist of frames of so many triangles.

    Examples
    --------
    >>> triangles = read_triangles("run/run.triangles", mesh.num_triangles)
    >>> modes = mode_amplitudes("run/run.xtc", triangles, lmax=10)

    `Trajectory.triangles` finds the file beside its own, and needs no number.
    """
    path = Path(path)
    count = whole_number(num_triangles, "read_triangles", "num_triangles", 1)
    numbers, rest = divmod(path.stat().st_size, 4)
    if rest or numbers == 0 or numbers % (3 * count):
        raise ValueError(
            f"read_triangles: {path} has {path.stat().st_size} bytes, which are not frames of "
            f"{count} triangles, {12 * count} bytes each"
        )
    return np.memmap(path, dtype="<i4", mode="r").reshape(-1, count, 3)


class Trajectory:
    """Positions in an XTC, DCD, PDB or GSD file, which is read in chunks and never as a whole.

    All functions of this package that take vertices take a `Trajectory`, or the path of one, in
    place of an array, and refuse one set of triangles for all frames where bonds flipped: pass
    `triangles()` then. XTC and DCD need no topology. The files are read by MDTraj, which is
    installed with ``pip install openmm-helfrich[trajectories]``, and GSD by the package gsd, with
    ``openmm-helfrich[gsd]``; a PDB file is one chunk.

    Parameters
    ----------
    path : str or Path
        The extension gives the format.
    particles : array_like of int, slice or range, optional
        The particles that are the vertices, in their order, where the file has others too: the
        `particles` of a `Placement`. Default: all.
    start, stop, stride : int, optional
        First frame, frame to stop before, and step, as in range(). Default: all frames.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ImportError
        MDTraj, or gsd for a GSD file, is not installed.
    ValueError
        The extension is another one, a number is out of range, or the file has no frames.

    Examples
    --------
    >>> trajectory = Trajectory("vesicle.xtc", stride=10)
    >>> modes = mode_amplitudes(trajectory, mesh, lmax=10)
    """

    def __init__(
        self,
        path: File,
        particles: Any = None,
        start: int = 0,
        stop: int | None = None,
        stride: int = 1,
    ) -> None:
        self.path = Path(path)
        self.suffix = self.path.suffix.lower()
        if self.suffix not in _SUFFIXES:
            raise ValueError(
                f"Trajectory: {self.path} is none of {', '.join(_SUFFIXES)}; convert it, or pass "
                "an array of positions"
            )
        if not self.path.is_file():
            raise FileNotFoundError(f"Trajectory: there is no file {self.path}")
        self.start = whole_number(start, "Trajectory", "start", 0)
        self.stop = None if stop is None else whole_number(stop, "Trajectory", "stop", self.start)
        self.stride = whole_number(stride, "Trajectory", "stride", 1)
        self.particles = list(particles) if isinstance(particles, range) else particles
        for frames in self.chunks(1):
            self.num_vertices = frames.shape[1]
            break
        else:
            raise ValueError(f"Trajectory: {self.path} has no frame in the range asked for")

    def __repr__(self) -> str:
        return f"Trajectory({str(self.path)!r}, {self.num_vertices} vertices)"

    def __iter__(self) -> Iterator[Array]:
        """Frames of shape (num_vertices, 3), nm."""
        for frames in self.chunks(64):
            yield from frames

    def chunks(self, size: int) -> Iterator[Array]:
        """Successive frames.

        Parameters
        ----------
        size : int
            The most frames of one chunk.

        Yields
        ------
        ndarray
            Shape (1 … size, num_vertices, 3), float64, nm.

        Raises
        ------
        ValueError
            The file is broken, or has other particles than asked for.
        """
        first = 0
        for block in self._blocks(size * self.stride):
            # Places within the block of the frames start, start + stride, … below stop.
            begin = max(self.start - first, (self.start - first) % self.stride)
            end = len(block) if self.stop is None else min(len(block), self.stop - first)
            chosen = block[begin : max(end, 0) : self.stride]
            first += len(block)
            for place in range(0, len(chosen), size):
                yield self._select(chosen[place : place + size])
            if self.stop is not None and first >= self.stop:
                return

    def read(self) -> Array:
        """All frames at once, shape (num_frames, num_vertices, 3), nm."""
        return np.concatenate(list(self.chunks(256)))

    def times(self) -> Array:
        """The time of each frame, ps, shape (num_frames,).

        Raises
        ------
        ValueError
            The file is no XTC or GSD file, which store them, or a GSD file of another program.
        """
        if self.suffix == ".gsd":
            found = [frame.time for frame in self._chosen_gsd()]
            if None in found:
                raise ValueError(f"Trajectory: {self.path} has no times; HOOMD writes steps only")
            return np.array(found)
        return self._column(1, "times").astype(float)

    def steps(self) -> Array:
        """The step of the simulation of each frame, shape (num_frames,); errors as for `times`."""
        if self.suffix == ".gsd":
            return np.array([frame.step for frame in self._chosen_gsd()])
        return self._column(2, "steps").astype(np.int64)

    @property
    def timed(self) -> bool:
        """Whether the file has the time of each frame, and its step."""
        if self.suffix == ".gsd":
            return next(self._gsd()).time is not None
        return self.suffix == ".xtc"

    def boxes(self) -> Array | None:
        """The periodic box of each frame, nm, shape (num_frames, 3, 3).

        None if the file has none, or has boxes of no size, as XTC files without a box do. All
        functions of this package that take `box=` take it.
        """
        if self.suffix == ".gsd":
            boxes = [frame.box for frame in self._chosen_gsd()]
            return None if any(box is None for box in boxes) else np.stack(boxes)
        if self.suffix == ".xtc":
            found = self._rows(3)
        elif self.suffix == ".dcd":
            lengths, angles = self._rows(1), self._rows(2)
            found = None if lengths is None else _vectors(lengths * _ANGSTROM, angles)
        else:
            with _mdtraj_formats().PDBTrajectoryFile(str(self.path)) as file:
                if file.unitcell_lengths is None:
                    return None
                lengths = np.array([file.unitcell_lengths]) * _ANGSTROM
                found = _vectors(lengths, np.array([file.unitcell_angles]))
                found = np.repeat(found, self._num_stored(), axis=0)
        if found is None:
            return None
        found = found[self.start : self.stop : self.stride].astype(float)
        return found if found.any(axis=2).all() else None

    def _column(self, number: int, what: str) -> Array:
        """What MDTraj returns at this place for each of the chosen frames of an XTC file."""
        if self.suffix != ".xtc":
            raise ValueError(f"Trajectory: {self.path} has no {what}; XTC files have them")
        return self._rows(number)[self.start : self.stop : self.stride]

    def _rows(self, number: int) -> Array | None:
        """What MDTraj returns at this place for each frame of an XTC or DCD file, if anything."""
        found = []
        try:
            with self._opened() as file:
                while len((part := file.read(n_frames=256))[0]):
                    found.append(part[number])
        except (OSError, RuntimeError) as reason:
            raise ValueError(f"Trajectory: {self.path} cannot be read: {reason}") from None
        return None if found[0] is None else np.concatenate(found)

    def triangles(self, num_triangles: int | None = None) -> Array | None:
        """The triangles of each frame, of a GSD file or of ``<name>.triangles`` beside this one.

        Parameters
        ----------
        num_triangles : int, optional
            Of all membranes together. Default: what the two files say.

        Returns
        -------
        ndarray of int, or None
            Shape (num_frames, num_triangles, 3), of the chosen frames, as indices among the chosen
            particles; triangles of other particles are left out. None if there is no such file:
            bonds did not flip. A GSD file of `write_gsd` has its own.

        Raises
        ------
        ValueError
            It has another number of frames than the trajectory, or no closed surfaces; or only
            some corners of a triangle are among the particles.

        Examples
        --------
        >>> trajectory = Trajectory("run/run.xtc", stride=10)
        >>> modes = mode_amplitudes(trajectory, trajectory.triangles(), lmax=10)
        """
        if self.suffix == ".gsd" and next(self._gsd()).triangles is not None:
            found = [frame.triangles for frame in self._chosen_gsd()]
            return self._among_particles(np.stack(found), self.path)
        path = self.path.with_suffix(".triangles")
        if not path.is_file():
            return None
        stored = self._num_stored()
        count = num_triangles or path.stat().st_size // (12 * stored)
        try:
            found = read_triangles(path, max(1, count))
            if len(found) != stored:
                raise ValueError(f"it has the triangles of {len(found)} frames")
            edges_of(found[0].astype(np.intp))
        except ValueError as reason:
            raise ValueError(
                f"Trajectory: {path} does not match the {stored} frames of {self.path}: {reason}; "
                "if the run was killed, go on with 'openmm-helfrich run … --resume', which makes "
                "them match"
            ) from None
        return self._among_particles(found[self.start : self.stop : self.stride], path)

    def _among_particles(self, triangles, path):
        if self.particles is None:
            if triangles[0].max() >= self.num_vertices:
                raise ValueError(
                    f"Trajectory: {path} names particle {triangles[0].max()}, but {self.path} has "
                    f"{self.num_vertices}"
                )
            return triangles
        particles = np.asarray(self.particles)
        size = max(int(triangles[0].max()), int(particles.max())) + 1
        places = np.full(size, -1)
        places[particles] = np.arange(len(particles))
        inside = places[triangles[0]] >= 0
        # Flips leave each triangle on its surface.
        rows = inside.all(axis=1)
        if (inside.any(axis=1) != rows).any():
            row = int(np.flatnonzero(inside.any(axis=1) != rows)[0])
            raise ValueError(
                f"Trajectory: only some corners of triangle {row} of {path}, "
                f"{triangles[0, row].tolist()}, are among the particles; choose whole membranes"
            )
        return places[triangles[:, rows]]

    def _num_stored(self) -> int:
        """How many frames the file has, whichever were asked for."""
        return sum(len(block) for block in self._blocks(256))

    def _select(self, frames):
        if self.particles is None:
            return frames.astype(float)
        try:
            return frames[:, self.particles].astype(float)
        except IndexError as reason:
            raise ValueError(f"Trajectory: {self.path}: {reason}") from None

    def _blocks(self, size):
        """All frames of the file, in nm."""
        if self.suffix == ".gsd":
            frames = self._gsd()
            while block := list(itertools.islice(frames, size)):
                yield np.stack([frame.vertices for frame in block])
            return
        formats = _mdtraj_formats()
        try:
            if self.suffix == ".pdb":
                with formats.PDBTrajectoryFile(str(self.path)) as file:
                    yield np.asarray(file.positions) * _ANGSTROM
                return
            scale = 1.0 if self.suffix == ".xtc" else _ANGSTROM
            with self._opened() as file:
                while True:
                    positions = file.read(n_frames=size)[0]
                    if len(positions) == 0:
                        return
                    yield positions * scale
        except (OSError, RuntimeError) as reason:
            raise ValueError(f"Trajectory: {self.path} cannot be read: {reason}") from None

    def _gsd(self) -> Iterator[GSDFrame]:
        """All frames of a GSD file."""
        count = None
        for frame in frames_in(self.path, "Trajectory"):
            found = len(frame.vertices)
            if found != (count := count or found):
                raise ValueError(
                    f"Trajectory: {self.path} has frames of {count} and of {found} particles; need "
                    "the same number in all"
                )
            yield frame

    def _chosen_gsd(self) -> Iterator[GSDFrame]:
        return itertools.islice(self._gsd(), self.start, self.stop, self.stride)

    @contextlib.contextmanager
    def _opened(self) -> Iterator[Any]:
        formats = _mdtraj_formats()
        kinds = {".xtc": formats.XTCTrajectoryFile, ".dcd": formats.DCDTrajectoryFile}
        with _system.ascii_name(self.path) as name, kinds[self.suffix](name) as file:
            yield file


def _vectors(lengths: Array, angles: Array) -> Array:
    """Box vectors, shape (num_frames, 3, 3), of lengths and angles in degrees."""
    from mdtraj.utils import lengths_and_angles_to_box_vectors

    return np.stack(lengths_and_angles_to_box_vectors(*lengths.T, *angles.T), axis=1)


def _mdtraj_formats():
    try:
        import mdtraj.formats
    except ImportError as reason:
        raise ImportError(
            "Trajectory: reading trajectories needs MDTraj; install it with "
            f"'pip install openmm-helfrich[trajectories]' ({reason})"
        ) from None
    return mdtraj.formats
