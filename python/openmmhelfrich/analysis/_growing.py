"""Files to which frames are added as a run goes on, and which are cut where it goes on again."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

from .._types import Array, File
from .._writing import naming

__all__ = ["GrowingFile"]


class GrowingFile(ABC):
    """A file of frames, closed between additions.

    Parameters
    ----------
    path : str or Path
        Of the file; it is made with the first frame.
    """

    def __init__(self, path: File) -> None:
        self.path = Path(path)

    @abstractmethod
    def steps(self) -> Array:
        """The step of the simulation of each frame, shape (num_frames,).

        Raises
        ------
        ValueError
            If the file is none of its class, or is damaged.
        """

    @abstractmethod
    def _shorten(self, num_frames: int) -> None:
        """Keep the first frames of more, one at least."""

    def _has_rest(self) -> bool:
        """Whether a kill has left something behind the last whole frame."""
        return False

    def remove(self) -> None:
        """Remove what is there, so that the next frame begins a new file."""
        with naming(self.path):
            self.path.unlink(missing_ok=True)

    def require(self) -> None:
        """Check that the file is there, so that the next frame does not begin a new one.

        Raises
        ------
        FileNotFoundError
            It has been taken away.
        """
        with naming(self.path):
            self.path.stat()

    def check(self, num_frames: int) -> int:
        """Check that there are so many frames, or more; returns how many.

        Raises
        ------
        ValueError
            If there are fewer.
        """
        found = len(self.steps())
        if num_frames > found:
            raise ValueError(f"{self.path} has {found} frames, not {num_frames}")
        return found

    def cut(self, num_frames: int) -> None:
        """Keep the first frames only, and nothing behind them.

        Raises
        ------
        ValueError
            If there are fewer.
        """
        if self.check(num_frames) == num_frames and not self._has_rest():
            return
        if num_frames == 0:
            self.remove()
        else:
            self._shorten(num_frames)
