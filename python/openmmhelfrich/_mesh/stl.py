"""STL files, ASCII and binary: http://paulbourke.net/dataformats/stl.

A facet repeats the coordinates of its corners. Corners with exactly equal coordinates become one
vertex, numbered in the order of first appearance.
"""

from __future__ import annotations

import numpy as np

from .._types import Array
from .source import Source, merge_repeated, shorten

__all__ = ["read", "write"]

_HEADER_BYTES = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read(source: Source) -> tuple[Array, Array]:
    """Vertices and triangles of an STL file; the normals are ignored, solids are merged."""
    # Some programs begin binary files with 'solid' too, but their length gives them away.
    count = int.from_bytes(source.raw[_HEADER_BYTES - 4 : _HEADER_BYTES], "little")
    expected = _HEADER_BYTES + count * _FACET.itemsize
    if len(source.raw) >= _HEADER_BYTES and len(source.raw) == expected:
        facets = np.frombuffer(source.raw, _FACET, count, _HEADER_BYTES)
        vertices, numbers = merge_repeated(facets["corners"].astype(np.float64))
        return vertices, numbers.reshape(-1, 3)
    if source.data.lstrip()[:5].lower() == b"solid":
        return _read_ascii(source)
    if _is_text(source):
        raise source.error(f"an ASCII STL file starts with 'solid', got {shorten(source.words())}")
    if len(source.raw) < _HEADER_BYTES:
        expectation = f"at least the {_HEADER_BYTES} bytes of the header"
    else:
        expectation = f"{expected} bytes for the {count} facets that its header announces"
    raise source.error(
        f"not an STL file: neither 'solid' nor a binary file, which has {expectation}; this file "
        f"has {len(source.raw)} bytes; is it truncated?",
        line=1,
    )


def _is_text(source: Source) -> bool:
    """Whether the beginning is text, of which a count of facets would be nonsense."""
    head = source.raw[:_HEADER_BYTES]
    return source.raw != source.data or (len(head) > 0 and all(9 <= byte < 127 for byte in head))


def _read_ascii(source: Source) -> tuple[Array, Array]:
    corners: list[list[float]] = []
    sizes, lines = [], []
    open_solid = False
    while words := source.words():
        keyword = words[0].lower()
        if keyword in ("solid", "endsolid"):
            open_solid = keyword == "solid"
        elif keyword == "facet":
            lines.append(source.line)
            facet = _read_facet(source, len(sizes))
            corners += facet
            sizes.append(len(facet))
        else:
            raise source.error(f"expected 'facet' or 'endsolid', got {shorten(words)}")
    if open_solid:
        raise source.error("the file ends here without 'endsolid'; is it truncated?")
    vertices, numbers = merge_repeated(np.array(corners, dtype=np.float64).reshape(-1, 3))
    facets = np.split(numbers, np.cumsum(sizes)[:-1]) if sizes else []
    return source.mesh(vertices, facets, lines)


def _read_facet(source: Source, facet: int) -> list[list[float]]:
    """The corners of a facet, after its first line."""
    corners = []
    _expect(source, ["outer", "loop"], facet)
    while True:
        words = source.need(f"the rest of facet {facet}")
        if words[0].lower() != "vertex":
            break
        corners.append(source.point(words[1:], f"a vertex of facet {facet}"))
    if [word.lower() for word in words] != ["endloop"]:
        raise source.error(f"expected 'vertex' or 'endloop', got {shorten(words)}")
    source.check_corners(len(corners), facet)
    _expect(source, ["endfacet"], facet)
    return corners


def _expect(source: Source, keywords: list[str], facet: int) -> None:
    words = source.need(f"the rest of facet {facet}")
    if [word.lower() for word in words] != keywords:
        raise source.error(f"expected {shorten(keywords)}, got {shorten(words)}")


def write(vertices: Array, triangles: Array) -> bytes:
    """An ASCII STL file, which unlike a binary one has room for all digits of a double."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lines = ["solid openmm-helfrich"]
    for normal, facet in zip(normals.tolist(), corners.tolist(), strict=True):
        lines += [
            "facet normal " + " ".join(f"{x:.9g}" for x in normal),
            "  outer loop",
            *(f"    vertex {x!r} {y!r} {z!r}" for x, y, z in facet),
            "  endloop",
            "endfacet",
        ]
    lines.append("endsolid openmm-helfrich")
    return ("\n".join(lines) + "\n").encode()
