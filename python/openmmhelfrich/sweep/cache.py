"""Results on disk, one file for each point of a sweep."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from tqdm import tqdm

__all__ = ["RECORD", "Cache"]

#: The entry of a file that holds the point, and those results that are no arrays.
RECORD = "json"


class Cache:
    """A folder of results, one NumPy ``.npz`` file for each point of each function.

    A file appears only when it is complete, so that several sweeps may share a folder and an
    interruption leaves no broken one. ``numpy.load(file)["json"]`` shows the point.

    Parameters
    ----------
    folder : str or Path
        Made where needed, when the first result is stored.
    """

    def __init__(self, folder):
        self.folder = Path(folder)

    @staticmethod
    def key(name: str, point: Mapping, version: int = 1) -> str:
        """The name of a result: 20 hexadecimal digits of the SHA-256 of what it depends on."""
        text = json.dumps([name, version, point], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    def path(self, name: str, key: str) -> Path:
        """Where the result of a function of this name is, or would be."""
        return self.folder / name.strip("_<>") / f"{key}.npz"

    def load(self, name: str, key: str, point: Mapping) -> dict | None:
        """The stored result; None if there is none, or only the remains of one."""
        path = self.path(name, key)
        try:
            with np.load(path, allow_pickle=False) as file:
                record = json.loads(str(file[RECORD]))
                arrays = {entry: file[entry] for entry in file.files if entry != RECORD}
        except FileNotFoundError:
            return None
        except (zipfile.BadZipFile, EOFError, ValueError, KeyError) as error:
            tqdm.write(
                f"sweep: computing {dict(point)} again: {path} is broken ({error})", sys.stderr
            )
            return None
        if record["point"] != json.loads(json.dumps(point)):
            return None
        return {**record["result"], **arrays}

    def save(self, name: str, key: str, point: Mapping, result: Mapping) -> None:
        """Store a result, at once and completely or not at all."""
        path = self.path(name, key)
        path.parent.mkdir(parents=True, exist_ok=True)
        arrays = {entry: value for entry, value in result.items() if isinstance(value, np.ndarray)}
        rest = {entry: value for entry, value in result.items() if entry not in arrays}
        record = json.dumps({"point": point, "result": rest})
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez_compressed(file, **{RECORD: np.array(record)}, **arrays)
            # Temporary files are for their owner alone; a folder of results may be shared.
            os.chmod(temporary, 0o666 & ~_umask())
            os.replace(temporary, path)
        except BaseException:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(temporary)
            raise


def _umask():
    """The mask of new files, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
