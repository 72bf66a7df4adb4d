"""Whether another release of OpenMM has the C++ interface that the library was built for.

setup.py uses this module by itself, so it imports nothing of the package.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

__all__ = ["RECORD", "interface_of", "read_record", "write_record"]

#: Where the build notes what it saw, in the package.
RECORD = Path("include") / "openmm-interface.txt"

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def interface_of(include: Path) -> str | None:
    """A digest of the C++ headers of an OpenMM, without comments and white space.

    Parameters
    ----------
    include : Path
        Its folder ``include``.

    Returns
    -------
    str or None
        None if there are no headers.
    """
    headers = sorted(include.rglob("*.h"))
    # The C wrappers list the same in another order each time.
    headers = [path for path in headers if not path.name.endswith("CWrapper.h")]
    if not headers:
        return None
    digest = hashlib.sha256()
    for path in headers:
        code = "".join(_COMMENT.sub("", path.read_text(encoding="utf-8", errors="replace")).split())
        digest.update(f"{path.relative_to(include).as_posix()}\n{code}\n".encode())
    return digest.hexdigest()


def write_record(package: Path, include: Path) -> None:
    """Note the interface of the OpenMM that the package is built for."""
    (package / RECORD).write_text(f"{interface_of(include)}\n", encoding="utf-8")


def read_record(package: Path) -> str | None:
    """What the build has noted; None if nothing."""
    try:
        return (package / RECORD).read_text(encoding="utf-8").strip()
    except FileNotFoundError:
        return None
