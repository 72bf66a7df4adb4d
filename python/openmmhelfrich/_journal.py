"""Files that are changed in places, and are whole again after a kill at any moment.

HDF5 changes its tables of contents in place, so that a kill in the middle of an addition could cost
the whole file. Here a change is collected in memory, written to a journal beside the file, and only
then made: what a kill leaves is the file without the change, or a journal to make it from.
"""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from . import _blocks
from ._writing import naming, replace

__all__ = ["JournaledFile"]

_PAGE = 4096
_KIND = "journal"
_KNOWN = {"pages": 1, "bytes": 1, "length": 1}


class JournaledFile:
    """A file that one process at a time changes, and its journal, ``<name>.journal``.

    Parameters
    ----------
    path : Path
        Need not exist; its folder does.
    """

    def __init__(self, path: Path):
        self.path = path
        self._journal = path.with_name(path.name + ".journal")

    @contextlib.contextmanager
    def change(self, fresh: bool = False) -> Iterator[io.RawIOBase]:
        """A file object whose changes are made when the block ends, and not if it is left early.

        Parameters
        ----------
        fresh : bool
            Begin with an empty file in place of what is there.

        Raises
        ------
        FileNotFoundError
            If there is no file, and `fresh` is False.
        OSError
            If the system refuses; the change is then made in whole or not at all.
        """
        if fresh:
            self.remove()
            pages = _Pages(io.BytesIO())
            yield pages
        else:
            self.recover()
            with naming(self.path), self.path.open("rb") as file:
                pages = _Pages(file)
                yield pages
        blocks = {
            "pages": _blocks.Block(np.array(sorted(pages.changed), dtype=np.int64)),
            "bytes": _blocks.Block(b"".join(pages.changed[n] for n in sorted(pages.changed))),
            "length": _blocks.Block(pages.length),
        }
        try:
            replace(self._journal, _blocks.pack(_KIND, blocks))
        except OSError as reason:
            raise OSError(reason.errno, reason.strerror, os.fspath(self.path)) from None
        self.recover()

    def recover(self) -> None:
        """Make the change that a journal was left of.

        Raises
        ------
        ValueError
            If the journal is damaged.
        OSError
            If the system refuses; the journal is kept.
        """
        try:
            with naming(self._journal):
                data = self._journal.read_bytes()
        except FileNotFoundError:
            return
        try:
            blocks = _blocks.unpack(data, _KIND, _KNOWN)
        except _blocks.BlockError as reason:
            raise ValueError(
                f"{self._journal} {reason}; a part of its change may be in {self.path} already: "
                "bring both back"
            ) from None
        changed, length = blocks["bytes"].value, blocks["length"].value
        with naming(self.path):
            handle = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o666)
            with open(handle, "r+b", buffering=0) as file:
                for number, page in enumerate(blocks["pages"].value.tolist()):
                    file.seek(page * _PAGE)
                    _write_all(file, changed[number * _PAGE : (number + 1) * _PAGE])
                file.truncate(length)
                os.fsync(file.fileno())
        with naming(self._journal):
            self._journal.unlink()

    def remove(self) -> None:
        """Remove the file and its journal, if they are there."""
        for path in (self._journal, self.path):
            with naming(path):
                path.unlink(missing_ok=True)


def _write_all(file, data: bytes) -> None:
    rest = memoryview(data)
    while rest:
        rest = rest[file.write(rest) :]


class _Pages(io.RawIOBase):
    """A file with changes in memory, by pages.

    changed: the contents of pages by their number; length: of the file as changed, bytes.
    """

    def __init__(self, file):
        self._file = file
        self._position = 0
        self._stored = self.length = file.seek(0, os.SEEK_END)
        self.changed: dict[int, bytearray] = {}

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self.length}[whence]
        self._position = start + offset
        return self._position

    def tell(self) -> int:
        return self._position

    def truncate(self, size: int | None = None) -> int:
        self.length = self._position if size is None else size
        return self.length

    def readinto(self, buffer) -> int:
        target = memoryview(buffer).cast("B")
        count = max(0, min(len(target), self.length - self._position))
        for page, within, start, stop in _parts(self._position, count):
            target[start:stop] = self._page(page)[within : within + stop - start]
        self._position += count
        return count

    def write(self, data) -> int:
        source = memoryview(data).cast("B")
        for page, within, start, stop in _parts(self._position, len(source)):
            self.changed.setdefault(page, self._page(page))
            self.changed[page][within : within + stop - start] = source[start:stop]
        self._position += len(source)
        self.length = max(self.length, self._position)
        return len(source)

    def _page(self, number: int) -> bytearray:
        """The present contents of a page; beyond the end of the file there are zeros."""
        if number in self.changed:
            return self.changed[number]
        self._file.seek(number * _PAGE)
        stored = self._file.read(max(0, min(_PAGE, self._stored - number * _PAGE)))
        return bytearray(stored.ljust(_PAGE, b"\0"))


def _parts(position: int, count: int) -> Iterator[tuple[int, int, int, int]]:
    """The pages of a range: number, place in the page, and start and stop in the range."""
    done = 0
    while done < count:
        page, within = divmod(position + done, _PAGE)
        stop = min(count, done + _PAGE - within)
        yield page, within, done, stop
        done = stop
