"""GSD files read: positions, bonds and triangles of each frame."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .._types import Array

__all__ = ["GSDFrame", "frames_in", "import_gsd", "open_gsd", "read_gsd"]

# How often a file that looks damaged is looked at, and after how many seconds again.
_LOOKS, _PAUSE = 5, 0.01


class GSDFrame(NamedTuple):
    """One frame of a GSD file, as `read_gsd` returns it."""

    step: int
    """Of the simulation."""
    time: float | None
    """ps; None in a file of another program."""
    vertices: Array
    """Shape (num_vertices, 3), nm, with the images of the periodic box undone."""
    triangles: Array | None
    """Shape (num_triangles, 3); None in a file of another program."""
    bonds: Array
    """Pairs of vertices, shape (num_bonds, 2): the edges."""
    box: Array | None
    """The periodic box, shape (3, 3), nm, in OpenMM's form; None without one."""
    types: Array
    """Kind of each vertex, from 0, shape (num_vertices,)."""
    masses: Array
    """amu, shape (num_vertices,)."""


def read_gsd(path) -> list[GSDFrame]:
    """The frames of a GSD file, of `write_gsd` or of HOOMD.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    list of GSDFrame
        All of them, in memory.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ImportError
        Without the package gsd.
    ValueError
        It is no GSD file, or is damaged.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"read_gsd: there is no file {path}")
    return list(frames_in(path, "read_gsd"))


def frames_in(path: Path, where: str) -> Iterator[GSDFrame]:
    """The frames of a GSD file, one at a time; errors as for `read_gsd`, which name `where`."""
    hoomd = import_gsd(where)
    try:
        with open_gsd(hoomd, path) as file:
            for frame in file:
                yield _read(frame)
    except (OSError, RuntimeError, KeyError) as reason:
        raise ValueError(
            f"{where}: {path} is no GSD file of particles, or is damaged ({reason}); write it anew"
        ) from None


def open_gsd(hoomd, path: Path):
    """A GSD file opened for reading, which a simulation may be writing.

    gsd reads the head, the size, the names and the index one after the other: what is written
    meanwhile can name data beyond that size, which looks damaged and is not, a moment later.

    Raises
    ------
    OSError, RuntimeError
        gsd's, if it is no GSD file, or if its beginning or its last frame is damaged.
    """
    for _ in range(_LOOKS - 1):
        try:
            return _open_whole(hoomd, path)
        except RuntimeError:
            time.sleep(_PAUSE)
    return _open_whole(hoomd, path)


def _open_whole(hoomd, path: Path):
    """A GSD file whose last frame can be read."""
    file = hoomd.open(name=str(path), mode="r")
    try:
        if len(file):
            _ = file[len(file) - 1]
    except BaseException:
        file.close()
        raise
    return file


def _vectors(box: Array) -> Array:
    """Box vectors, shape (3, 3), of HOOMD's six numbers."""
    x, y, z, xy, xz, yz = box.astype(float)
    return np.array([[x, 0, 0], [xy * y, y, 0], [xz * z, yz * z, z]])


def _read(frame) -> GSDFrame:
    box = _vectors(frame.configuration.box)
    log, particles = frame.log, frame.particles
    triangles = log.get("triangles")
    return GSDFrame(
        int(frame.configuration.step),
        float(log["time"][0]) if "time" in log else None,
        particles.position.astype(float) + particles.image @ box,
        None if triangles is None else triangles.astype(np.int64),
        frame.bonds.group.astype(np.int64),
        box if "periodic" not in log or log["periodic"][0] else None,
        particles.typeid.astype(np.int64),
        particles.mass.astype(float),
    )


def import_gsd(where: str):
    """The module gsd.hoomd, or an ImportError that says how to get it."""
    try:
        import gsd.hoomd
    except ImportError as reason:
        raise ImportError(
            f"{where}: GSD files need the package gsd; install it with "
            f"'pip install openmm-helfrich[gsd]' ({reason})"
        ) from None
    return gsd.hoomd
