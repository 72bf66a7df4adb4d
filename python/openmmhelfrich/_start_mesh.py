"""``NAME.ply`` beside ``NAME.xtc``: the mesh at the start of a run, and whether its bonds flip."""

from __future__ import annotations

from pathlib import Path

from ._mesh import files
from ._types import Array
from ._writing import naming

__all__ = ["check_whole", "write_start"]

# A comment of the header. Of the triangles of such a run those of the start are but the first.
_FLIPS = b"comment openmm-helfrich bonds flip"
_END = b"\nend_header\n"
_LONGEST = 4096


def write_start(
    path: Path, vertices: Array, triangles: Array, box: Array | None, flows: bool
) -> None:
    """Write it; with `flows` it says that the triangles of each frame are in ``NAME.triangles``."""
    with naming(path):
        files.write(path, vertices, triangles, binary=True, box=box)
        if flows:
            header, end, body = path.read_bytes().partition(_END)
            path.write_bytes(header + b"\n" + _FLIPS + end + body)


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
        header = file.read(_LONGEST).partition(_END)[0]
    if _FLIPS in header:
        raise ValueError(
            f"bonds flip in the run of {trajectory}, and {trajectory.stem}.triangles, which has "
            "the triangles of each frame, is gone; bring it back beside the trajectory, or give "
            "a mesh, if its triangles are those of all frames that you want"
        )
