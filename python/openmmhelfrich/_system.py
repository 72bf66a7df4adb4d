"""All that differs between Linux, macOS and Windows.

The package is tried on Linux only; what it does elsewhere follows the manuals of those systems, and
docs/installation.md says what is known of them.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

__all__ = ["LIBRARY", "ascii_name", "file_size_limit", "lock", "sync_folder", "written"]

#: The name of the library of the plugin.
LIBRARY = {"win32": "OpenMMHelfrich.dll", "darwin": "libOpenMMHelfrich.dylib"}.get(
    sys.platform, "libOpenMMHelfrich.so"
)


def lock(file: IO[bytes]) -> None:
    """Keep other processes from a file until it is closed, or this process has ended.

    Raises
    ------
    BlockingIOError
        Another process has it.
    OSError
        The file system has no locks.
    """
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except PermissionError as reason:
            raise BlockingIOError(*reason.args) from None
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def file_size_limit() -> int | None:
    """The largest file that this process may write, bytes; None if there is no limit."""
    if sys.platform == "win32":
        return None
    import resource

    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return None if limit == resource.RLIM_INFINITY else limit


def written(write: Callable[[str], object]) -> tuple[bytes, OSError | None]:
    """What a function writes to the file whose name it is given, and the error that it raised.

    The file is in memory on Linux, else a temporary one.
    """
    if sys.platform == "linux":
        handle = os.memfd_create("openmm-helfrich")
        try:
            failed = _error_of(write, f"/proc/self/fd/{handle}")
            return os.pread(handle, os.fstat(handle).st_size, 0), failed
        finally:
            os.close(handle)
    # Windows opens no file twice that vanishes when it is closed.
    with tempfile.TemporaryDirectory(prefix="openmm-helfrich") as folder:
        path = Path(folder, "frame")
        path.touch()
        failed = _error_of(write, str(path))
        return path.read_bytes(), failed


@contextmanager
def ascii_name(path: Path) -> Iterator[str]:
    """The name of a file, or another one of the same file, for libraries that take ASCII only."""
    if str(path).isascii():
        yield str(path)
        return
    with tempfile.TemporaryDirectory(prefix="openmm-helfrich") as folder:
        name = os.path.join(folder, "file")
        try:
            os.symlink(os.path.abspath(path), name)
        except OSError:
            # Windows lets few make links.
            shutil.copyfile(path, name)
        yield name


def _error_of(write: Callable[[str], object], name: str) -> OSError | None:
    try:
        write(name)
    except OSError as reason:
        return reason
    return None


def sync_folder(folder: Path) -> None:
    """Put the names of a folder on the disk, where the system can."""
    # Windows opens no folders.
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        # Some file systems of networks have no such thing.
        with suppress(OSError):
            os.fsync(handle)
    finally:
        os.close(handle)
