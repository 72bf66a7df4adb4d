"""The start mesh of a vesicle from its table."""

from __future__ import annotations

from pathlib import Path

from scipy.spatial.transform import Rotation

from ..errors import MeshError
from ..mesh import Mesh
from .tables import Table

__all__ = ["start_mesh"]

_SOURCES = ("file", "icosphere", "random")
_READING = ("triangulate", "merge", "drop_unused")


def start_mesh(table: Table, folder: Path) -> Mesh:
    """Make or read the mesh, then scale, deform, flatten or stretch, rotate and move it.

    Parameters
    ----------
    table : Table
        A ``[vesicle.mesh]``.
    folder : Path
        Where files are looked for.

    Raises
    ------
    ConfigError
        If it is not said where the mesh comes from, or said twice; if the mesh cannot be made, read
        or transformed.
    """
    sources = [name for name in _SOURCES if table.given(name)]
    if len(sources) != 1:
        said = f"got {' and '.join(sources)}" if sources else "got none"
        key = sources[1] if sources else None
        raise table.error(key, f"a mesh needs one of {', '.join(_SOURCES)}; {said}")
    (source,) = sources
    _check_companions(table, source)
    try:
        if source == "file":
            mesh = Mesh.read(folder / table["file"], **{name: table[name] for name in _READING})
        elif source == "icosphere":
            mesh = Mesh.icosphere(table["icosphere"], table["radius"])
        else:
            mesh = Mesh.random_sphere(table["random"], table["radius"], table["seed"] or 0)
    except (FileNotFoundError, MeshError) as reason:
        raise table.error(source, str(reason)) from None
    if table["oblate"] is not None and table["prolate"] is not None:
        raise table.error("prolate", "give either oblate or prolate, not both")
    steps = {
        "scale": lambda mesh, factor: mesh.scaled(factor),
        "deform": lambda mesh, mode: mesh.deformed(*mode),
        "oblate": lambda mesh, reduced_volume: mesh.oblate(reduced_volume),
        "prolate": lambda mesh, reduced_volume: mesh.prolate(reduced_volume),
        "rotate": lambda mesh, turn: mesh.rotated(Rotation.from_rotvec(turn, degrees=True)),
        "translate": lambda mesh, displacement: mesh.translated(displacement),
    }
    for name, transform in steps.items():
        if table[name] is not None:
            try:
                mesh = transform(mesh, table[name])
            except MeshError as reason:
                raise table.error(name, str(reason)) from None
    return mesh


def _check_companions(table: Table, source: str) -> None:
    """Keys that go with some sources only."""
    if source == "file" and table.given("radius"):
        raise table.error("radius", "a mesh from a file has its own size; use scale")
    if source != "file" and not table.given("radius"):
        raise table.error(source, "a sphere needs a radius, nm; add radius")
    for name in _READING:
        if source != "file" and table.given(name):
            raise table.error(name, "it says how to read a file, and this mesh is made")
    if source != "random" and table.given("seed"):
        raise table.error("seed", "only a random mesh has a seed")
