"""GSD and extended XYZ files to which frames are added, as a run or a simulation goes on."""

from __future__ import annotations

import contextlib
import os
from abc import abstractmethod
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from .._writing import naming
from ._growing import GrowingFile
from ._gsd import import_gsd
from ._surface_frames import Types, fresh_file
from .extended_xyz import text_of
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
            with self.path.open("rb") as written:
                os.fsync(written.fileno())

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
        """Add frames to the file, or make it with them."""

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
        new = not self.path.exists()
        if new:
            self._frames = None
        mode = "w" if new else "r+"
        with _readable(self.path), self._hoomd.open(name=str(self.path), mode=mode) as file:
            for frame in frames:
                file.append(self._next(file, frame))

    def _next(self, file, frame: SurfaceFrame):
        """The next frame of a file that is open."""
        if self._frames is None:
            self._frames = Frames(self._hoomd, Types(self._where, None), self._masses)
            if len(file):
                self._frames.go_on(file[0], file[len(file) - 1])
        if len(file) and len(frame.vertices) != file[0].particles.N:
            raise ValueError(
                f"{self.path}: its frames have {file[0].particles.N} vertices, not "
                f"{len(frame.vertices)}; give another file"
            )
        return self._frames.next(frame)

    def _steps(self) -> list[int]:
        with _readable(self.path), self._hoomd.open(name=str(self.path), mode="r") as file:
            raw, name = file.file, "configuration/step"
            # What is not there is that of frame 0, or else 0.
            first = raw.read_chunk(0, name)[0] if raw.chunk_exists(0, name) else 0
            return [
                raw.read_chunk(number, name)[0] if raw.chunk_exists(number, name) else first
                for number in range(len(file))
            ]

    def _shorten(self, num_frames: int) -> None:
        with (
            fresh_file(self.path) as fresh,
            self._hoomd.open(name=str(self.path), mode="r") as old,
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
    next addition.

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
        self._end: int | None = None

    def _add(self, frames: Iterable[SurfaceFrame]) -> None:
        whole = self._end
        if whole is None or not self.path.exists() or self.path.stat().st_size != whole:
            whole = self._ends()[-1][1] if self.path.exists() else 0
        kinds = Types(self._where, None)
        text = "".join(text_of(frame, kinds.next(frame)) for frame in frames).encode("ascii")
        with self.path.open("r+b" if self.path.exists() else "wb") as file:
            file.truncate(whole)
            file.seek(whole)
            file.write(text)
        self._end = whole + len(text)

    def _steps(self) -> list[int]:
        return [step for step, _ in self._ends()[1:]]

    def _shorten(self, num_frames: int) -> None:
        end = self._ends()[num_frames][1]
        with naming(self.path):
            os.truncate(self.path, end)
        self._end = end

    def _ends(self) -> list[tuple[int, int]]:
        """Step, and end in the file, of each whole frame, after (−1, 0)."""
        found = [(-1, 0)]
        with self.path.open("rb") as file:
            while head := file.readline():
                comment = file.readline()
                try:
                    count = int(head)
                    words = dict(
                        word.split("=", 1) for word in comment.decode().split() if "=" in word
                    )
                    step = int(words["step"])
                except (ValueError, KeyError):
                    if not comment.endswith(b"\n"):
                        break
                    raise ValueError(
                        f"{self.path} is no extended XYZ file of this package, or is damaged, in "
                        f"its frame {len(found)}"
                    ) from None
                last = b""
                for _ in range(count):
                    last = file.readline()
                if not last.endswith(b"\n"):
                    break
                found.append((step, file.tell()))
        return found
