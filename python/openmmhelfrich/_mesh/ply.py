"""PLY files, ASCII and binary: http://paulbourke.net/dataformats/ply.

The paper's files declare ``float`` and print seventeen digits. ASCII numbers are read as doubles
whatever the header declares, so that none of the digits is lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .._types import Array
from ..errors import MeshError
from .source import Source, shorten

__all__ = ["read", "write"]

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("long", "int64"), "i8"),
    **dict.fromkeys(("ulong", "uint64"), "u8"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_BYTE_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
# The line of the header that has the periodic box, before its nine components.
_BOX = ["comment", "openmm-helfrich", "box"]
_CORNERS = ("vertex_indices", "vertex_index")


class _Property(NamedTuple):
    """One property of an element; `count` is the type of a list's length, None for a scalar."""

    name: str
    type: str
    count: str | None


class _Element(NamedTuple):
    """One element of the header, such as 1002 vertices with x, y and z."""

    name: str
    count: int
    properties: list[_Property]


def read(source: Source) -> tuple[Array, Array]:
    """Vertices and triangles of a PLY file; elements and properties besides those are skipped."""
    if source.words() != ["ply"]:
        raise source.error("a PLY file starts with a line 'ply'")
    words = source.need("the format")
    if len(words) != 3 or words[0] != "format" or words[1] not in ("ascii", *_BYTE_ORDERS):
        raise source.error(
            "expected 'format ascii 1.0', 'format binary_little_endian 1.0' or 'format "
            f"binary_big_endian 1.0', got {shorten(words)}"
        )
    elements = _read_header(source)
    if words[1] == "ascii":
        return _read_ascii(source, elements)
    return _read_binary(source, elements, _BYTE_ORDERS[words[1]])


def write(
    vertices: Array,
    triangles: Array,
    point_data: dict[str, Array] | None = None,
    binary: bool = False,
    box: Array | None = None,
    comments: Sequence[str] = (),
) -> bytes:
    """A PLY file of doubles; as text, each with the fewest digits that give it back exactly.

    Values of the vertices are properties after the coordinates; vectors are three, ``name_x`` and
    so on. The periodic box is a comment, and there may be others, each of one line.
    """
    columns = {axis: vertices[:, k] for k, axis in enumerate("xyz")}
    for name, values in (point_data or {}).items():
        parts = [values] if values.ndim == 1 else list(values.T)
        names = [name] if values.ndim == 1 else [f"{name}_{axis}" for axis in "xyz"]
        for part, called in zip(parts, names, strict=True):
            if called in columns:
                raise MeshError(
                    f"Mesh.write: point_data {name!r}: PLY has one property {called!r} already; "
                    "give it another name"
                )
            columns[called] = part
    header = [
        "ply",
        f"format {'binary_little_endian' if binary else 'ascii'} 1.0",
        "comment openmm-helfrich mesh, nm",
        *([] if box is None else [" ".join([*_BOX, *map(repr, box.ravel().tolist())])]),
        *(f"comment {text}" for text in comments),
        f"element vertex {len(vertices)}",
        *(f"property double {name}" for name in columns),
        f"element face {len(triangles)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    table = np.column_stack(list(columns.values()))
    if binary:
        faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, triangles
        return "\n".join([*header, ""]).encode() + table.astype("<f8").tobytes() + faces.tobytes()
    lines = [
        *header,
        *(" ".join(map(repr, row)) for row in table.tolist()),
        *(f"3 {a} {b} {c}" for a, b, c in triangles.tolist()),
    ]
    return ("\n".join(lines) + "\n").encode()


def _read_header(source: Source) -> list[_Element]:
    elements: list[_Element] = []
    while True:
        words = source.need("the rest of the header")
        if words == ["end_header"]:
            break
        if words[:3] == _BOX:
            if len(words) != 12:
                raise source.error(f"expected the 9 components of a box, got {shorten(words)}")
            source.box = [*source.point(words[3:6], "a"), *source.point(words[6:9], "b")]
            source.box += source.point(words[9:], "c")
        if words[0] in ("comment", "obj_info"):
            continue
        if words[0] == "element" and len(words) == 3:
            count = source.integer(words[2], f"the number of elements {words[1]!r}")
            if count < 0:
                raise source.error(f"the number of elements {words[1]!r} is {count}")
            elements.append(_Element(words[1], count, []))
        elif words[0] == "property" and len(words) in (3, 5) and elements:
            *types, name = words[1:]
            if len(types) == 3 and types.pop(0) != "list":
                raise source.error(f"expected a property list, got {shorten(words)}")
            for name_of_type in types:
                if name_of_type not in _TYPES:
                    raise source.error(f"unknown type {name_of_type!r}")
            count_type = _TYPES[types[0]] if len(types) == 2 else None
            elements[-1].properties.append(_Property(name, _TYPES[types[-1]], count_type))
        else:
            raise source.error(f"expected an element or property, got {shorten(words)}")
    _check_elements(source, elements)
    return elements


def _check_elements(source: Source, elements: list[_Element]) -> None:
    _refuse_repeated(source, [entry.name for entry in elements], "elements")
    for element in elements:
        _refuse_repeated(
            source, [entry.name for entry in element.properties], f"properties of {element.name}"
        )
        if not element.properties:
            raise source.error(f"the element {element.name!r} has no property; remove it")
        for entry in element.properties:
            if entry.count is not None and "f" in entry.count:
                raise source.error(
                    f"the length of the list {entry.name!r} of {element.name} must be of a type of "
                    "integers"
                )
    found = {element.name: element for element in elements}
    for name in ("vertex", "face"):
        if name not in found:
            raise source.error(f"the header ends without an element '{name}'")
    scalars = [entry.name for entry in found["vertex"].properties if entry.count is None]
    if len(scalars) < len(found["vertex"].properties) or not set("xyz") <= set(scalars):
        raise source.error(f"vertices need the scalars x, y and z, got {scalars}")
    lists = [entry.name for entry in found["face"].properties if entry.count is not None]
    if not set(_CORNERS) & set(lists):
        raise source.error("faces need a list vertex_indices")
    for entry in found["face"].properties:
        if entry.name in _CORNERS and "f" in entry.type:
            raise source.error(f"{entry.name} must be of a type of integers; convert the file")


def _refuse_repeated(source: Source, names: list[str], what: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise source.error(f"two {what} are called {name!r}; rename one of them")


def _read_ascii(source: Source, elements: list[_Element]) -> tuple[Array, Array]:
    num_vertices = next(element.count for element in elements if element.name == "vertex")
    vertices, faces, lines = [], [], []
    for name, count, properties in elements:
        names = [entry.name for entry in properties]
        axes = [names.index(axis) for axis in "xyz"] if name == "vertex" else []
        for item in range(count):
            words = source.need(f"{name} {item} of {count}")
            if name == "vertex":
                if len(words) != len(names):
                    raise source.error(
                        f"vertex {item} needs {len(names)} numbers ({' '.join(names)}), "
                        f"got {len(words)}: {shorten(words)}"
                    )
                vertices.append(source.point([words[axis] for axis in axes], f"vertex {item}"))
            elif name == "face":
                corners = words[_start_of_corners(source, properties, words, item) :]
                faces.append(source.face(corners, item, num_vertices))
                lines.append(source.line)
    source.finish()
    return source.mesh(vertices, faces, lines)


def _start_of_corners(source: Source, properties: list[Any], words: list[str], face: int) -> int:
    """Where in a line the list of corners starts: scalars and other lists may precede it."""
    at = 0
    for entry in properties:
        if at >= len(words):
            break
        if entry.name in _CORNERS:
            return at
        at += 1
        if entry.count is not None:
            at += source.integer(words[at - 1], f"the length of {entry.name} of face {face}")
    raise source.error(f"face {face} ends before its vertex indices: {shorten(words)}")


def _read_binary(source: Source, elements: list[_Element], order: str) -> tuple[Array, Array]:
    data = source.rest()
    at = 0
    vertices, faces = np.empty((0, 3)), []

    def take(dtype: np.dtype, count: int, what: str) -> Array:
        nonlocal at
        needed = dtype.itemsize * count
        if at + needed > len(data):
            raise source.error(
                f"{what} needs {needed} bytes from byte {at} after this line, but only "
                f"{len(data) - at} follow; is the file truncated?"
            )
        values = np.frombuffer(data, dtype, count, at)
        at += needed
        return values

    for name, count, properties in elements:
        if all(entry.count is None for entry in properties):
            row = np.dtype([(entry.name, order + entry.type) for entry in properties])
            values = take(row, count, f"element {name} ({count} of them)")
            if name == "vertex":
                vertices = np.stack([values[axis] for axis in "xyz"], axis=1).astype(np.float64)
            continue
        # Lists have any length, so where one row ends is known only after reading it.
        for item in range(count):
            for entry in properties:
                length = 1
                if entry.count is not None:
                    what = f"{entry.name} of {name} {item}"
                    length = int(take(np.dtype(order + entry.count), 1, what)[0])
                    if length < 0:
                        raise source.error(f"{what} has the length {length}; is the file damaged?")
                what = f"{entry.name} of {name} {item}"
                values = take(np.dtype(order + entry.type), length, what)
                if name == "face" and entry.name in _CORNERS:
                    source.check_corners(length, item)
                    faces.append(values)
    if at < len(data):
        raise source.error(
            f"the elements take {at} bytes after this line, but {len(data)} follow; do the counts "
            "in the header fit?"
        )
    source.by_line = False
    for face, corners in enumerate(faces):
        for corner in corners.tolist():
            if not 0 <= corner < len(vertices):
                raise source.error(
                    f"face {face} names vertex {corner}, but the file has {len(vertices)} "
                    "vertices, counted from 0"
                )
    return source.mesh(vertices, faces)
