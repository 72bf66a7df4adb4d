"""Where results of the tutorials are kept between builds."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import openmmhelfrich

ROOT = Path(__file__).parents[2]


def cache_folder() -> Path:
    """The folder of the cache, one for each state of the package.

    MyST-NB runs a notebook again where its code has changed. What it imports has its part in the
    results too, so another package begins with an empty cache, and the old
    one is removed.
    """
    package = Path(openmmhelfrich.__file__).parent
    files = [
        *package.rglob("*.py"),
        *package.rglob("*.so"),
        *(ROOT / "examples").glob("vesicle.cpp"),
    ]
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.name.encode())
        digest.update(file.read_bytes())
    folder = ROOT / "out" / "docs" / "notebooks" / digest.hexdigest()[:16]
    for other in folder.parent.glob("*"):
        if other != folder:
            shutil.rmtree(other)
    return folder
