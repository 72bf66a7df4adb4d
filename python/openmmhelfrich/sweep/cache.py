"""Results on disk, one file for each point of a sweep."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .._types import File
from .._writing import naming
from ..logs import logger

__all__ = ["RECORD", "Cache"]

#: The entry of a file that holds the point, and those results that are no arrays.
RECORD = "json"

# How NumPy's entries end, and what they are called in files that have arrays of other names.
_SUFFIX = ".npy"
# How files end that are being written.
_PART = ".part"
_NUMBERED = "array {}"


class Cache:
    """A folder of results, one NumPy ``.npz`` file for each point of each function.

    Functions are told apart by their modules and names, points by all of their arguments. A file
    appears only when it is complete, so that several sweeps may share a folder and an interruption
    leaves no broken one. ``numpy.load(file)["json"]`` shows the point.

    Parameters
    ----------
    folder : str or Path
        Made where needed, when the first result is stored.
    """

    def __init__(self, folder: File) -> None:
        self.folder = Path(folder)
        self._entered: set[Path] = set()

    @staticmethod
    def key(name: str, point: Mapping[str, Any], version: int = 1) -> str:
        """The name of a result: 20 hexadecimal digits of the SHA-256 of what it depends on.

        Parameters
        ----------
        name : str
            Of the function, ``module.name``.
        point : mapping
            Its arguments, such as JSON has.
        version : int
            Of the function.

        Returns
        -------
        str
        """
        text = json.dumps([name, version, point], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    def path(self, name: str, key: str) -> Path:
        """Where a result is, or would be.

        Parameters
        ----------
        name, key : str
            The function, ``module.name``, and what `key` makes of it and a point.

        Returns
        -------
        Path
        """
        return self.folder / name / f"{key}.npz"

    def load(self, name: str, key: str, point: Mapping[str, Any]) -> dict[str, Any] | None:
        """Look for a result.

        Parameters
        ----------
        name, key : str
            As for `path`.
        point : mapping
            The arguments, which must be those that were stored.

        Returns
        -------
        dict or None
            None if there is no such result, or a broken file, which is a warning of the logger.
        """
        path = self.path(name, key)
        try:
            with np.load(path, allow_pickle=False) as file:
                record = json.loads(str(file[RECORD]))
                if missing := set(record.get("entries", ())) - set(file.files):
                    raise KeyError(f"no {min(missing)}")
                # Without a list of names in the record the entries have those of the arrays.
                names = record.get("arrays")
                stored = [_NUMBERED.format(i) for i in range(len(names))] if names else file.files
                arrays = {
                    name: file[entry]
                    for name, entry in zip(names or stored, stored, strict=True)
                    if entry != RECORD
                }
        except FileNotFoundError:
            if not self.folder.is_dir():
                self._entered.clear()
            return None
        except Exception as error:
            # A damaged file may ask for encryption, methods of compression or places that there
            # are not; what the system refuses has a number, but for a place before the first byte.
            if getattr(error, "errno", None) not in (None, errno.EINVAL):
                raise
            logger("sweep").warning(
                "sweep: computing %s again: %s is broken (%s)", dict(point), path, error
            )
            return None
        if record["point"] != json.loads(json.dumps(point)):
            return None
        return {**record["result"], **arrays}

    def save(
        self, name: str, key: str, point: Mapping[str, Any], result: Mapping[str, Any]
    ) -> None:
        """Store a result, at once and completely or not at all.

        Parameters
        ----------
        name, key, point
            As for `load`.
        result : mapping
            Arrays, and what JSON has.

        Raises
        ------
        OSError
            The folder cannot be written to, or has vanished since the first result.
        """
        path = self.path(name, key)
        with naming(path):
            self._enter(path.parent)
            try:
                self._save(path, point, result)
            except FileNotFoundError:
                # Another sweep has just tidied up.
                self._save(path, point, result)

    def _enter(self, folder: Path) -> None:
        """Make a folder when it is first needed, and remove what kills have left in it."""
        if folder in self._entered:
            return
        # Not where the whole folder has vanished, with what is in it.
        if not self._entered or self.folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
        for part in folder.glob(f"*{_PART}"):
            part.unlink(missing_ok=True)
        self._entered.add(folder)

    def _save(self, path: Path, point: Mapping[str, Any], result: Mapping[str, Any]) -> None:
        arrays = {entry: value for entry, value in result.items() if isinstance(value, np.ndarray)}
        rest = {entry: value for entry, value in result.items() if entry not in arrays}
        record = {"point": point, "result": rest}
        if not all(map(_names_an_entry, arrays)):
            record["arrays"] = list(arrays)
            arrays = {_NUMBERED.format(i): value for i, value in enumerate(arrays.values())}
        # A damaged index may have fewer.
        record["entries"] = list(arrays)
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=_PART)
        try:
            with os.fdopen(handle, "wb") as file:
                _write(file, {RECORD: np.array(json.dumps(record)), **arrays})
            # Temporary files are for their owner alone; a folder of results may be shared.
            os.chmod(temporary, 0o666 & ~_umask())
            os.replace(temporary, path)
        except BaseException:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(temporary)
            raise


def _names_an_entry(name):
    """Whether an entry of a file can have the name of an array, and be found by it."""
    return name != "" and name.isprintable() and not name.endswith(_SUFFIX)


def _write(file, arrays):
    """Do as `numpy.savez_compressed`, which has arguments that arrays must not be called like."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            with archive.open(name + _SUFFIX, "w", force_zip64=True) as entry:
                np.lib.format.write_array(entry, np.asanyarray(array), allow_pickle=False)


def _umask():
    """The mask of new files, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
