"""Object File Format, ASCII: http://www.geomview.org/docs/html/OFF.html."""

from __future__ import annotations

from .._types import Array
from .source import Source, shorten

__all__ = ["read", "write"]

# The prefixes announce texture coordinates, colours and normals after the three coordinates.
_KEYWORDS = [st + c + n + "OFF" for st in ("", "ST") for c in ("", "C") for n in ("", "N")]


def read(source: Source) -> tuple[Array, Array]:
    """Vertices and triangles of an OFF file; colours, normals and texture are skipped."""
    words = source.need("'OFF'", comment=b"#")
    if words[0] not in _KEYWORDS:
        raise source.error(f"an ASCII OFF file starts with 'OFF', got {shorten(words)}")
    if words[1:2] == ["BINARY"]:
        raise source.error("binary OFF files cannot be read; convert it to ASCII OFF or PLY")
    counts = words[1:] or source.need("the numbers of vertices, faces and edges", comment=b"#")
    if len(counts) not in (2, 3):
        raise source.error(
            f"expected the numbers of vertices, faces and edges, got {shorten(counts)}"
        )
    num_vertices = source.integer(counts[0], "the number of vertices")
    num_faces = source.integer(counts[1], "the number of faces")
    vertices, faces, lines = [], [], []
    for item in range(num_vertices):
        words = source.need(f"vertex {item} of {num_vertices}", comment=b"#")
        vertices.append(source.point(words, f"vertex {item}"))
    for item in range(num_faces):
        words = source.need(f"face {item} of {num_faces}", comment=b"#")
        faces.append(source.face(words, item, num_vertices))
        lines.append(source.line)
    source.finish(comment=b"#")
    return source.mesh(vertices, faces, lines)


def write(vertices: Array, triangles: Array) -> bytes:
    """An OFF file of doubles, each with the fewest digits that give it back exactly."""
    lines = [
        "OFF",
        "# openmm-helfrich mesh, nm",
        f"{len(vertices)} {len(triangles)} 0",
        *(f"{x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()),
        *(f"3 {a} {b} {c}" for a, b, c in triangles.tolist()),
    ]
    return ("\n".join(lines) + "\n").encode()
