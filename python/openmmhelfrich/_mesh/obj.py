"""Wavefront OBJ files: http://paulbourke.net/dataformats/obj. Vertices and faces are read."""

from __future__ import annotations

import numpy as np

from .source import Source, arrays, shorten

__all__ = ["read", "write"]


def read(source: Source) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (``v``) and triangles (``f``) of an OBJ file; everything else is skipped.

    Corners count from 1, or backward from −1 for the last vertex that has been read, and may carry
    a texture and a normal after slashes.
    """
    vertices, triangles, lines = [], [], []
    while words := source.words(comment=b"#"):
        keyword, *values = words
        if keyword == "v":
            vertices.append(source.point(values, f"vertex {len(vertices) + 1}"))
        elif keyword == "f":
            face = len(triangles) + 1
            source.check_corners(len(values), face)
            triangles.append([_corner(source, word, face, len(vertices)) for word in values])
            lines.append(source.line)
        elif "\0" in keyword:
            raise source.error(f"expected text, got {shorten(words)}")
    # A face may come before its vertices in the file, so that the range is known only at the end.
    for face, (corners, line) in enumerate(zip(triangles, lines, strict=True), start=1):
        for corner in corners:
            if not 0 <= corner < len(vertices):
                raise source.error(
                    f"face {face} names vertex {corner + 1}, but the file has {len(vertices)} "
                    "vertices, counted from 1",
                    line,
                )
    if not triangles:
        raise source.error("the file ends without a face ('f' and three corners)")
    return arrays(vertices, triangles)


def _corner(source: Source, word: str, face: int, vertices_so_far: int) -> int:
    number = source.integer(word.partition("/")[0], f"a vertex index of face {face}")
    if number < 0:
        return vertices_so_far + number
    return number - 1


def write(vertices: np.ndarray, triangles: np.ndarray) -> str:
    """An OBJ file of doubles, each with the fewest digits that give it back exactly."""
    lines = [
        "# openmm-helfrich mesh, nm",
        *(f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()),
        *(f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()),
    ]
    return "\n".join(lines) + "\n"
