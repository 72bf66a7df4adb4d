"""Wavefront OBJ files: http://paulbourke.net/dataformats/obj. Vertices and faces are read."""

from __future__ import annotations

from .._types import Array
from .source import Source, shorten

__all__ = ["read", "write"]

# Lines that say nothing about the surface: texture, normals, names, groups, materials, rendering,
# and points and lines beside the faces.
_SKIPPED = {
    *("vt", "vn", "vp", "p", "l", "g", "s", "mg", "o", "bevel", "c_interp", "d_interp", "lod"),
    *("usemtl", "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj", "csh"),
}
# Surfaces that are no polygons: without them the mesh would be another one.
_CURVED = {
    *("cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv"),
    *("sp", "end", "con", "ctech", "stech", "bzp", "bsp", "cdc", "cdp", "res"),
}


def read(source: Source) -> tuple[Array, Array]:
    """Vertices (``v``) and triangles (``f``) of an OBJ file.

    Corners count from 1, or backward from −1 for the last vertex that has been read, and may carry
    a texture and a normal after slashes. A line that ends with a backslash goes on in the next one.
    """
    vertices, faces, lines = [], [], []
    while words := _statement(source):
        keyword, *values = words
        if keyword == "v":
            vertices.append(source.point(values, f"vertex {len(vertices) + 1}"))
        elif keyword in ("f", "fo"):
            face = len(faces) + 1
            source.check_corners(len(values), face)
            faces.append([_corner(source, word, face, len(vertices)) for word in values])
            lines.append(source.line)
        elif "\0" in keyword:
            raise source.error(f"expected text, got {shorten(words)}")
        elif keyword in _CURVED:
            raise source.error(
                f"curved surfaces ('{keyword}') cannot be read; convert the file to polygons"
            )
        elif keyword == "call":
            raise source.error(f"other files are not read ({shorten(words)}); put them in here")
        elif keyword not in _SKIPPED:
            raise source.error(
                f"a line of an OBJ file cannot begin with {shorten([keyword])} (v, f, vn, vt, g, "
                "o, s, usemtl, ... can); correct it, or make it a comment with '#'"
            )
    # A face may come before its vertices in the file, so that the range is known only at the end.
    for face, (corners, line) in enumerate(zip(faces, lines, strict=True), start=1):
        for corner in corners:
            if not 0 <= corner < len(vertices):
                raise source.error(
                    f"face {face} names vertex {corner + 1}, but the file has {len(vertices)} "
                    "vertices, counted from 1",
                    line,
                )
    if not faces:
        raise source.error("the file ends without a face ('f' and three corners)")
    return source.mesh(vertices, faces, lines, first=1)


def _statement(source: Source) -> list[str]:
    """The words of the next line and of those that continue it."""
    words = source.words(comment=b"#")
    while words and words[-1].endswith("\\"):
        words[-1] = words[-1][:-1]
        words = [*filter(None, words), *source.need("the rest of a continued line", comment=b"#")]
    return words


def _corner(source: Source, word: str, face: int, vertices_so_far: int) -> int:
    number = source.integer(word.partition("/")[0], f"a vertex index of face {face}")
    if number < 0:
        return vertices_so_far + number
    return number - 1


def write(vertices: Array, triangles: Array) -> bytes:
    """An OBJ file of doubles, each with the fewest digits that give it back exactly."""
    lines = [
        "# openmm-helfrich mesh, nm",
        *(f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()),
        *(f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()),
    ]
    return ("\n".join(lines) + "\n").encode()
