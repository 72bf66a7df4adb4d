"""The start mesh of a vesicle from its table."""

from __future__ import annotations

from pathlib import Path

from scipy.spatial.transform import Rotation

from ..errors import MeshError
from ..mesh import Mesh
from .tables import Table

__all__ = ["start_mesh"]

_READING = ("triangulate", "merge", "drop_unused")
#: Where meshes come from, and the keys that each needs and takes.
_SOURCES = {
    "file": ((), _READING),
    "icosphere": (("radius",), ()),
    "random": (("radius",), ("seed",)),
    "sheet": (("spacing",), ("periodic",)),
    "tube": (("radius", "length"), ("periodic",)),
    "disk": (("radius",), ()),
}
_COMPANIONS = ("radius", "spacing", "length", "periodic", "seed")
_ARTICLES = {
    "icosphere": "a sphere",
    "random": "a sphere",
    "sheet": "a sheet",
    "tube": "a tube",
    "disk": "a disk",
}


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
        else:
            mesh = _MADE[source](table)
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


_MADE = {
    "icosphere": lambda t: Mesh.icosphere(t["icosphere"], t["radius"]),
    "random": lambda t: Mesh.random_sphere(t["random"], t["radius"], t["seed"] or 0),
    "sheet": lambda t: Mesh.sheet(*t["sheet"], t["spacing"], t["periodic"]),
    "tube": lambda t: Mesh.tube(*t["tube"], t["radius"], t["length"], t["periodic"]),
    "disk": lambda t: Mesh.disk(t["disk"], t["radius"]),
}


def _check_companions(table: Table, source: str) -> None:
    """Keys that go with some sources only."""
    needed, taken = _SOURCES[source]
    for name in needed:
        if not table.given(name):
            raise table.error(source, f"{_ARTICLES[source]} needs a {name}, nm; add {name}")
    for name in _READING:
        if source != "file" and table.given(name):
            raise table.error(name, "it says how to read a file, and this mesh is made")
    for name in _COMPANIONS:
        if table.given(name) and name not in needed + taken:
            if source == "file" and name != "seed":
                raise table.error(name, "a mesh from a file has its own size; use scale")
            others = [other for other, keys in _SOURCES.items() if name in keys[0] + keys[1]]
            has = f"only a {' or '.join(others)} mesh has a {name}"
            raise table.error(name, has)
