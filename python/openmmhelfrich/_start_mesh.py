"""``NAME.ply`` beside ``NAME.xtc``: the mesh at the start of a run, and whether its bonds flip."""

from __future__ import annotations

from pathlib import Path

from ._mesh import ply
from ._types import Array
from ._writing import naming, write_whole

__all__ = ["check_whole", "write_start"]

# A comment of the header. Of the triangles of such a run those of the start are but the first.
_FLIPS = "openmm-helfrich bonds flip"
# More than a header that `write_start` makes is long.
_LONGEST = 4096


def write_start(
    path: Path, vertices: Array, triangles: Array, box: Array | None, flows: bool
) -> None:
    """Write it; with `flows` it says that the triangles of each frame are in ``NAME.triangles``."""
    comments = [_FLIPS] if flows else []
    with naming(path):
        write_whole(path, ply.write(vertices, triangles, None, True, box, comments))


def check_whole(start: Path, trajectory: Path) -> None:
    """Refuse to take triangles of the start for those of all frames where bonds flip.

    Parameters
    ----------
    start : Path
        ``NAME.ply``.
    trajectory : Path
        Of a run without ``NAME.triangles``.

    Raises
    ------
    ValueError
        If they flip.
    """
    with start.open("rb") as file:
        header = file.read(_LONGEST).partition(b"end_header")[0]
    if f"comment {_FLIPS}".encode() in header.splitlines():
        raise ValueError(
            f"bonds flip in the run of {trajectory}, and {trajectory.stem}.triangles, which has "
            "the triangles of each frame, is gone; bring it back beside the trajectory, or give "
            "a mesh, if its triangles are those of all frames that you want"
        )
