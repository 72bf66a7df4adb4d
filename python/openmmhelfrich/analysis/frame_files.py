"""GSD and extended XYZ files to which frames are added, as a run or a simulation goes on."""

from __future__ import annotations

import contextlib
import os
import re
from abc import abstractmethod
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .._writing import in_memory, naming, replace
from ._growing import GrowingFile
from ._gsd import import_gsd, open_gsd
from ._surface_frames import Types, fresh_file
from .extended_xyz import FORMAT, text_of
from .gsd_files import Frames, masses_of
from .surface_series import SurfaceFrame

__all__ = ["ExtendedXYZSeries", "FrameFile", "GSDSeries"]


class FrameFile(GrowingFile):
    """A file whose frames are added and counted by its subclasses, of one format each.

    Parameters
    ----------
    path : str or Path
        Of the file; it is made with the first frame.
    """

    def add(self, frames: Iterable[SurfaceFrame]) -> None:
        """Add frames; they are on the disk when this returns.

        Raises
        ------
        OSError
            If the system refuses.
        ValueError
            If the file cannot take them.
        """
        with naming(self.path):
            self._add(frames)

    def steps(self) -> np.ndarray:
        """The step of the simulation of each frame, shape (num_frames,).

        Raises
        ------
        ValueError
            If the file is none of its format, or is damaged.
        """
        with naming(self.path):
            found = self._steps() if self.path.exists() else []
        return np.array(found, dtype=np.int64)

    @abstractmethod
    def _add(self, frames: Iterable[SurfaceFrame]) -> None:
        """Add frames to the file, or make it with them, and bring them on the disk."""

    @abstractmethod
    def _steps(self) -> list[int]:
        """Those of a file that is there."""


@contextlib.contextmanager
def _readable(path: Path) -> Iterator[None]:
    """What gsd raises of a file that it cannot read becomes a ValueError that names it."""
    try:
        yield
    except (RuntimeError, KeyError) as reason:
        raise ValueError(f"{path} is no GSD file of particles, or is damaged ({reason})") from None


class GSDSeries(FrameFile):
    """Frames as `write_gsd` writes them.

    Parameters
    ----------
    path : str or Path
        ``.gsd``.
    masses : float or array_like
        As for `write_gsd`.
    where : str
        Who writes, for messages.

    Raises
    ------
    ImportError
        Without the package gsd.
    """

    def __init__(self, path, masses=1.0, where: str = "GSDSeries"):
        super().__init__(path)
        self._hoomd, self._where = import_gsd(where), where
        self._masses = masses_of(where, masses)
        self._frames = None

    def _add(self, frames: Iterable[SurfaceFrame]) -> None:
        if not self.path.exists():
            self._begin()
        try:
            with _readable(self.path), self._hoomd.open(name=str(self.path), mode="r+") as file:
                for frame in frames:
                    file.append(self._next(file, frame))
            with self.path.open("rb") as written:
                os.fsync(written.fileno())
        except BaseException:
            # A frame that is not there has no triangles for those after it: look again.
            self._frames = None
            raise

    def _begin(self) -> None:
        """Make a file of no frames in one go; gsd writes its head where a kill could cut it."""
        self._frames = None
        empty = in_memory(lambda name: self._hoomd.open(name=name, mode="w").close())
        replace(self.path, empty)

    def _next(self, file, frame: SurfaceFrame):
        """The next frame of a file that is open."""
        if self._frames is None:
            self._frames = Frames(self._hoomd, Types(self._where, None), self._masses)
            if len(file):
                self._require_ours(file)
                self._frames.go_on(file[0], file[len(file) - 1])
        if len(file):
            _require_count(self.path, file[0].particles.N, frame)
        return self._frames.next(frame)

    def _require_ours(self, file) -> None:
        """Refuse a file of HOOMD: what is not in its frame 0 would be missing in all of ours."""
        if not file.file.chunk_exists(0, "log/triangles"):
            raise ValueError(
                f"{self.path} has no triangles: it is a GSD file of another program, which is left "
                "as it is; give another file"
            )

    def _steps(self) -> list[int]:
        with _readable(self.path), open_gsd(self._hoomd, self.path) as file:
            raw, name = file.file, "configuration/step"
            if len(file):
                self._require_ours(file)
            # What is not there is that of frame 0, or else 0.
            first = raw.read_chunk(0, name)[0] if raw.chunk_exists(0, name) else 0
            return [
                raw.read_chunk(number, name)[0] if raw.chunk_exists(number, name) else first
                for number in range(len(file))
            ]

    def _shorten(self, num_frames: int) -> None:
        with (
            fresh_file(self.path) as fresh,
            open_gsd(self._hoomd, self.path) as old,
            self._hoomd.open(name=str(fresh), mode="w") as new,
        ):
            for number in range(num_frames):
                frame = old[number]
                if not old.file.chunk_exists(number, "log/triangles"):
                    # They were read from frame 0.
                    del frame.log["triangles"]
                new.append(frame)
        self._frames = None


class ExtendedXYZSeries(FrameFile):
    """Frames as `write_extended_xyz` writes them.

    A kill leaves a part of a frame at the end at most, which counts for nothing and goes with the
    next addition or cut.

    Parameters
    ----------
    path : str or Path
        ``.extxyz`` or ``.xyz``.
    where : str
        Who writes, for messages.
    """

    def __init__(self, path, where: str = "ExtendedXYZSeries"):
        super().__init__(path)
        self._where = where
        self._last: _End | None = None

    def _add(self, frames: Iterable[SurfaceFrame]) -> None:
        last = self._last
        if last is None or not self.path.exists() or self.path.stat().st_size != last.place:
            last = self._ends()[-1] if self.path.exists() else _BEGIN
        kinds, parts, count = Types(self._where, None), [], last.count
        for frame in frames:
            if count:
                _require_count(self.path, count, frame)
            count = len(frame.vertices)
            parts.append(text_of(frame, kinds.next(frame)))
        text = "".join(parts).encode("ascii")
        try:
            with self.path.open("r+b" if self.path.exists() else "wb") as file:
                file.truncate(last.place)
                file.seek(last.place)
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
        except OSError:
            # What may not be on the disk does not count, so that it can be added again.
            with contextlib.suppress(OSError):
                os.truncate(self.path, last.place)
            raise
        self._last = _End(-1, last.place + len(text), count)

    def _steps(self) -> list[int]:
        return [end.step for end in self._ends()[1:]]

    def _shorten(self, num_frames: int) -> None:
        end = self._ends()[num_frames]
        with naming(self.path):
            os.truncate(self.path, end.place)
        self._last = end

    def _has_rest(self) -> bool:
        return self.path.exists() and self.path.stat().st_size > self._ends()[-1].place

    def _ends(self) -> list[_End]:
        """Those of each whole frame, after that of none."""
        found = [_BEGIN]
        with self.path.open("rb") as file:
            while head := file.readline():
                comment = file.readline()
                count, step = _head_of(head, comment)
                if count is None:
                    raise ValueError(
                        f"{self.path} is no extended XYZ file of this package, or is damaged, in "
                        f"its frame {len(found)}"
                    )
                last = b""
                for _ in range(count):
                    if not (last := file.readline()):
                        break
                if step is None or not last.endswith(b"\n"):
                    break
                found.append(_End(step, file.tell(), count))
        return found


class _End(NamedTuple):
    """Where a frame of text ends."""

    step: int
    place: int
    count: int
    """Of its vertices."""


_BEGIN = _End(-1, 0, 0)
_WORD = f" {FORMAT} ".encode("ascii")
_STEP = re.compile(rb" step=(-?\d+) ")
# How the second line of a frame begins, in a periodic box and without.
_BEGINNINGS = (b'Lattice="', _WORD.lstrip())


def _head_of(head: bytes, comment: bytes) -> tuple[int | None, int | None]:
    """Number of vertices and step of a frame, of its first two lines.

    The step is None if a kill has cut them off, and both are if they are of another file, which
    must not be cut back to frames of ours.
    """
    begins = any(comment[: len(known)] == known[: len(comment)] for known in _BEGINNINGS)
    if not (head.rstrip().isdigit() and int(head) > 0 and begins):
        return None, None
    if not comment.endswith(b"\n"):
        return int(head), None
    step = _STEP.search(comment)
    ours = step is not None and _WORD in b" " + comment
    return (int(head), int(step[1])) if ours else (None, None)


def _require_count(path: Path, count: int, frame: SurfaceFrame) -> None:
    """Refuse a frame of another surface than those that are there."""
    if len(frame.vertices) != count:
        raise ValueError(
            f"{path}: its frames have {count} vertices, not {len(frame.vertices)}; give another "
            "file"
        )
