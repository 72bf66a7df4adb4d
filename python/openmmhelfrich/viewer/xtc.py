"""XTC files of runs that are not over, or were killed: their whole frames."""

from __future__ import annotations

import os
import shutil
import struct
import tempfile
from pathlib import Path

import numpy as np
from openmm.app.internal.xtc_utils import read_xtc

from .._types import Array

__all__ = ["read"]

# A frame begins with a magic number, the number of particles, step, time and box, and the number of
# particles again. So few have plain coordinates then; others have eight words and the number of
# bytes that follow, filled up to a word.
_MAGIC = 1995
_HEAD = 56
_PLAIN = 9
_WORDS = 32


def read(path: Path) -> tuple[Array, Array, Array, Array]:
    """Positions, boxes, times and steps of all whole frames.

    Returns
    -------
    positions : ndarray
        Shape (num_frames, num_particles, 3), nm.
    boxes : ndarray
        Shape (num_frames, 3, 3), nm.
    times : ndarray
        ps.
    steps : ndarray

    Raises
    ------
    ValueError
        If it is no XTC file, or has no whole frame.
    """
    length = _whole(path)
    if length == 0:
        raise ValueError(f"{path} has no whole frame of an XTC file")
    try:
        if length == path.stat().st_size:
            found = read_xtc(os.fsencode(path))
        else:
            with tempfile.NamedTemporaryFile(suffix=".xtc") as part, path.open("rb") as file:
                shutil.copyfileobj(file, part)
                part.truncate(length)
                part.flush()
                found = read_xtc(os.fsencode(part.name))
    except (OSError, RuntimeError, ValueError) as reason:
        raise ValueError(f"{path} cannot be read: {reason}") from None
    positions, boxes, times, steps = found
    return np.moveaxis(positions, -1, 0), np.moveaxis(boxes, -1, 0).astype(float), times, steps


def _whole(path: Path) -> int:
    """Up to which byte there are whole frames."""
    size, end = path.stat().st_size, 0
    with path.open("rb") as file:
        while True:
            file.seek(end)
            head = file.read(_HEAD + _WORDS + 4)
            if len(head) < _HEAD or struct.unpack_from(">i", head)[0] != _MAGIC:
                return end
            (particles,) = struct.unpack_from(">i", head, _HEAD - 4)
            if particles <= _PLAIN:
                following = end + _HEAD + 12 * particles
            elif len(head) < _HEAD + _WORDS + 4:
                return end
            else:
                (count,) = struct.unpack_from(">i", head, _HEAD + _WORDS)
                following = end + _HEAD + _WORDS + 4 + -(-count // 4) * 4
            if following > size:
                return end
            end = following
