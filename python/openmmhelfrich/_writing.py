"""Files that are written whole or not at all, and what to do where the system refuses.

A full disk, a quota, a limit on the size of files, a folder that has vanished: such errors reach
the user as one line with the name of the file, which Python leaves out where a file is open
already, and with what to do.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

from . import _system

__all__ = ["describe", "in_memory", "naming", "replace", "write_whole"]

_ADVICE = {
    errno.ENOSPC: "free some space there",
    errno.EDQUOT: "free some of your quota there",
    errno.EFBIG: "raise the limit on the size of a file ('ulimit -f'), or write to a file system "
    "that holds larger ones",
    errno.EROFS: "make the file system writable, or write to another",
    errno.EACCES: "get the permission to write there, or write elsewhere",
    errno.EPERM: "get the permission to write there, or write elsewhere",
    errno.ENOENT: "see whether its folder is there",
    errno.ENOTDIR: "see whether its folder is there",
    errno.EISDIR: "give the name of a file",
    errno.EIO: "see whether the disk is sound",
    errno.ESTALE: "see whether the network's file system is there",
}


def describe(reason: OSError) -> str:
    """An error of the system as one line: the file, what is wrong, and what to do."""
    if reason.errno is None:
        return " ".join(str(reason).split())
    said = _advised(reason)
    return said if reason.filename is None else f"{os.fsdecode(reason.filename)}: {said}"


def _advised(reason: OSError) -> str:
    """What is wrong and what to do, also where `naming` has said that already."""
    said, advice = reason.strerror or os.strerror(reason.errno), _ADVICE.get(reason.errno)
    return said if advice is None or advice in said else f"{said}; {advice}"


@contextlib.contextmanager
def naming(path) -> Iterator[None]:
    """Errors of the system inside name the file, and say what to do.

    Raises
    ------
    OSError
        Of the same errno, and so of the same class, as the error that it stands for. One without an
        errno, which a library has made up, is passed on.
    """
    try:
        yield
    except OSError as reason:
        if reason.errno is None:
            raise
        name = path if reason.filename is None else reason.filename
        raise OSError(reason.errno, _advised(reason), os.fspath(name)) from None


def replace(path: Path, data: bytes, previous: Path | None = None) -> None:
    """Put a file in the place of another in one go, so that at any moment there is a whole one.

    The data are on the disk before the old file goes, so that a kill or a loss of power leaves the
    old file or the new one. For files that one process at a time writes: the new one is first
    written under the name of `path` with ``.new``, and what a kill has left there is overwritten.

    Parameters
    ----------
    path : Path
        Of the file; its folder exists.
    data : bytes
        All that it shall hold.
    previous : Path, optional
        Where the file that was there shall be kept, in place of what is there.

    Raises
    ------
    OSError
        The system refuses; `path` and `previous` are then as before, or `previous` is the file that
        still is at `path` too.
    """
    fresh = path.with_name(path.name + ".new")
    with naming(path):
        try:
            _write(fresh, data)
            if previous is not None and path.exists():
                _keep(path, previous)
            os.replace(fresh, path)
            _system.sync_folder(path.parent)
        except OSError:
            # Where the disk is full, a part of a file would take the last of it.
            with contextlib.suppress(OSError):
                fresh.unlink()
            raise


def write_whole(path, data: bytes) -> None:
    """Write a file that another process, or a user after an error, never finds in part.

    Where the system refuses, a file that was there stays as it was. What is no regular file, such
    as a pipe, is written to directly; so is a file in a folder where none can be made.

    Raises
    ------
    OSError
        The system refuses; the message names the file and says what to do.
    """
    with naming(path):
        # A link shall still be one afterwards.
        real = Path(os.path.realpath(path))
        try:
            mode = real.stat().st_mode
        except FileNotFoundError:
            mode = None
        direct = mode is not None and not stat.S_ISREG(mode)
        if direct or (mode is not None and not os.access(real.parent, os.W_OK)):
            real.write_bytes(data)
            return
        fresh = real.with_name(f".{real.name}.{os.getpid()}.new")
        try:
            _write(fresh, data)
            if mode is not None:
                fresh.chmod(stat.S_IMODE(mode))
            os.replace(fresh, real)
        except OSError as reason:
            with contextlib.suppress(OSError):
                fresh.unlink()
            raise OSError(reason.errno, reason.strerror, os.fspath(path)) from None


def in_memory(write: Callable[[str], object]) -> bytes:
    """What a function writes to the file whose name it is given.

    For libraries that take names only, and say little or nothing if the disk is full.

    Raises
    ------
    OSError
        If it is more than the limit on the size of a file, which holds in memory too.
    """
    data, failed = _system.written(write)
    limit = _system.file_size_limit()
    if limit is not None and len(data) >= limit:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))
    if failed is not None:
        raise failed
    return data


def _write(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _keep(path: Path, previous: Path) -> None:
    """Give a file a second name, in the place of another file in one go."""
    if previous.exists() and previous.samefile(path):
        # A kill came right after this; to rename a file to itself would do nothing.
        return
    fresh = previous.with_name(previous.name + ".new")
    fresh.unlink(missing_ok=True)
    try:
        try:
            # Takes no space, and leaves the file where it is.
            os.link(path, fresh)
        except OSError:
            # File systems without links, such as FAT.
            shutil.copyfile(path, fresh)
        os.replace(fresh, previous)
    except OSError:
        with contextlib.suppress(OSError):
            fresh.unlink()
        raise
