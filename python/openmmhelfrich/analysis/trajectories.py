"""Trajectories on disk, read in chunks."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from .._numbers import whole_number

__all__ = ["Trajectory", "read_triangles"]

_SUFFIXES = (".xtc", ".dcd", ".pdb")
_ANGSTROM = 0.1  # nm


def read_triangles(path, num_triangles: int) -> np.ndarray:
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
    """Positions in an XTC, DCD or PDB file, which is read in chunks and never as a whole.

    All functions of this package that take vertices take a `Trajectory`, or the path of one, in
    place of an array. XTC and DCD need no topology. The files are read by MDTraj, which is
    installed with ``pip install openmm-helfrich[trajectories]``; a PDB file is one chunk.

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
        MDTraj is not installed.
    ValueError
        The extension is another one, a number is out of range, or the file has no frames.

    Examples
    --------
    >>> trajectory = Trajectory("vesicle.xtc", stride=10)
    >>> modes = mode_amplitudes(trajectory, mesh, lmax=10)
    """

    def __init__(self, path, particles=None, start=0, stop=None, stride=1):
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

    def __repr__(self):
        return f"Trajectory({str(self.path)!r}, {self.num_vertices} vertices)"

    def __iter__(self) -> Iterator[np.ndarray]:
        """Frames of shape (num_vertices, 3), nm."""
        for frames in self.chunks(64):
            yield from frames

    def chunks(self, size) -> Iterator[np.ndarray]:
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

    def read(self) -> np.ndarray:
        """All frames at once, shape (num_frames, num_vertices, 3), nm."""
        return np.concatenate(list(self.chunks(256)))

    def _select(self, frames):
        if self.particles is None:
            return frames.astype(float)
        try:
            return frames[:, self.particles].astype(float)
        except IndexError as reason:
            raise ValueError(f"Trajectory: {self.path}: {reason}") from None

    def _blocks(self, size):
        """All frames of the file, in nm."""
        formats = _mdtraj_formats()
        try:
            if self.suffix == ".pdb":
                with formats.PDBTrajectoryFile(str(self.path)) as file:
                    yield np.asarray(file.positions) * _ANGSTROM
                return
            opened = {".xtc": formats.XTCTrajectoryFile, ".dcd": formats.DCDTrajectoryFile}
            scale = 1.0 if self.suffix == ".xtc" else _ANGSTROM
            with opened[self.suffix](str(self.path)) as file:
                while True:
                    positions = file.read(n_frames=size)[0]
                    if len(positions) == 0:
                        return
                    yield positions * scale
        except (OSError, RuntimeError) as reason:
            raise ValueError(f"Trajectory: {self.path} cannot be read: {reason}") from None


def _mdtraj_formats():
    try:
        import mdtraj.formats
    except ImportError as reason:
        raise ImportError(
            "Trajectory: reading trajectories needs MDTraj; install it with "
            f"'pip install openmm-helfrich[trajectories]' ({reason})"
        ) from None
    return mdtraj.formats
