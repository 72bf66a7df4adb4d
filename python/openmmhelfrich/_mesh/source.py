"""A file under examination: its lines, and errors that name the line where it breaks."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from .._types import Array
from ..errors import MeshError
from . import polygons

__all__ = ["Source", "merge_repeated", "plain", "shorten"]

# The name of the option that a refusal of polygons points to, in Python and on the command line.
_OPTION = "read it with triangulate=True, or --triangulate of 'openmm-helfrich mesh', to split it"
_UTF8_MARK = b"\xef\xbb\xbf"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


class Source:
    """The bytes of a file, read line by line, with errors that name the file and the line.

    Lines end with a line feed, a carriage return, or both. A byte-order mark of UTF-8 at the
    beginning is skipped, one of UTF-16 refused.

    Parameters
    ----------
    path : str or Path
        The file's name, for messages only.
    data : bytes
        Its contents.
    triangulate : bool
        Whether faces may have more than three corners.

    Attributes
    ----------
    raw, data : bytes
        The contents with and without a byte-order mark.
    by_line : bool
        Whether the line that was read last says where an error is.
    box : list of float or None
        The nine components of the periodic box, nm, where a reader has found one.
    """

    def __init__(self, path, data: bytes, triangulate: bool = False):
        self.path = path
        self.line = 0
        self.by_line = True
        self.box = None
        self.triangulate = triangulate
        self.raw = data
        self.data = data.removeprefix(_UTF8_MARK)
        self._next = 0
        first = re.search(rb"\r\n?|\n", self.data)
        # After a bare carriage return a line feed may be the first byte of binary data.
        bare = first is not None and first.group() == b"\r"
        self._end_of_line = re.compile(rb"\r|\n" if bare else rb"\r\n?|\n")

    def error(self, reason: str, line: int | None = None) -> MeshError:
        """The exception for a fault in a line, the current one unless another is given."""
        if line is None and not self.by_line:
            return MeshError(f"Mesh.read: {self.path}: {reason}")
        return MeshError(f"Mesh.read: {self.path}, line {line or max(self.line, 1)}: {reason}")

    def raw_line(self) -> bytes | None:
        """The next line without its end; None at the end of the file."""
        if self._next == 0 and self.data.startswith(_UTF16_MARKS):
            raise self.error("the file is text in UTF-16; save it as UTF-8 or ASCII")
        if self._next >= len(self.data):
            return None
        end = self._end_of_line.search(self.data, self._next)
        stop, following = end.span() if end else (len(self.data), len(self.data))
        raw = self.data[self._next : stop]
        self._next = following
        self.line += 1
        return raw

    def words(self, comment: bytes | None = None) -> list[str]:
        """The words of the next line that is not blank; an empty list at the end of the file.

        Text from `comment` to the end of a line does not count.
        """
        while (raw := self.raw_line()) is not None:
            if comment is not None:
                raw = raw.partition(comment)[0]
            words = raw.decode("utf-8", errors="replace").split()
            if words:
                return words
        return []

    def take(self, size: int, what: str) -> bytes:
        """So many bytes after the lines that were read."""
        found = self.data[self._next : self._next + size]
        if len(found) < size:
            raise self.error(
                f"{what} needs {size} bytes after this line, but only {len(found)} follow; is the "
                "file truncated?"
            )
        self._next += size
        return found

    def rest(self) -> bytes:
        """Everything after the lines that were read."""
        return self.data[self._next :]

    def need(self, what: str, comment: bytes | None = None) -> list[str]:
        """Like `words`, but the end of the file is an error."""
        words = self.words(comment)
        if not words:
            raise self.error(f"the file ends here, where {what} should follow; is it truncated?")
        return words

    def finish(self, comment: bytes | None = None) -> None:
        """Refuse anything that is left over."""
        words = self.words(comment)
        if words:
            raise self.error(
                f"expected the end of the file, got {shorten(words)}; do the counts in the header "
                "fit?"
            )

    def point(self, words: list[str], what: str) -> list[float]:
        """Three coordinates, the first three words; further ones are colours and the like."""
        if len(words) < 3:
            raise self.error(f"{what} needs 3 coordinates, got {shorten(words) or 'none'}")
        try:
            return [float(word) for word in plain(words[:3])]
        except ValueError:
            raise self.error(f"{what} needs 3 coordinates, got {shorten(words)}") from None

    def integer(self, word: str, what: str) -> int:
        """One integer."""
        # As in `plain`, for many words.
        try:
            if word.isascii() and "_" not in word:
                return int(word)
        except ValueError:
            pass
        raise self.error(f"{what} must be an integer, got {shorten([word])}")

    def face(self, words: list[str], face: int, num_vertices: int) -> list[int]:
        """The corners of a face that is written as a count and as many indices."""
        what = f"face {face}"
        count = self.integer(words[0], f"the number of vertices of {what}")
        self.check_corners(count, face)
        if len(words) <= count:
            raise self.error(f"{what} needs {count} vertex indices, got {len(words) - 1}")
        corners = [self.integer(word, f"a vertex index of {what}") for word in words[1 : count + 1]]
        for corner in corners:
            if not 0 <= corner < num_vertices:
                raise self.error(
                    f"{what} names vertex {corner}, but the file has {num_vertices} vertices, "
                    "counted from 0"
                )
        return corners

    def check_corners(self, count: int, face: int) -> None:
        """Refuse a face without area, and one that is not a triangle unless it may be split."""
        if count < 3:
            raise self.error(f"face {face} has {count} vertices; a face needs 3 or more; remove it")
        if count > 3 and not self.triangulate:
            raise self.error(f"face {face} has {count} vertices, not 3; {_OPTION}")

    def mesh(
        self, vertices, faces: list[Any], lines: list[int] | None = None, first: int = 0
    ) -> tuple[Array, Array]:
        """Vertices and triangles as arrays; larger faces are split, see `polygons`.

        Parameters
        ----------
        vertices : array_like
            Shape (num_vertices, 3).
        faces : list of sequence of int
            The corners of every face, which `check_corners` has seen, in range.
        lines : list of int, optional
            The line of every face.
        first : int
            The number that messages give the first face.
        """
        points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
        if any(len(face) > 3 for face in faces) and not np.isfinite(points).all():
            vertex = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
            raise MeshError(
                f"Mesh.read: {self.path}: vertex {vertex} (counted from 0) has a coordinate that "
                f"is not finite, {points[vertex].tolist()}; correct it"
            )

        def fail(face: int, reason: str) -> MeshError:
            return self.error(f"face {face + first} {reason}", lines[face] if lines else None)

        return points, polygons.split(points, faces, fail)


def plain(words: list[str]) -> list[str]:
    """Words that may be numbers; ValueError at what only Python takes for one, such as 1_000."""
    text = "".join(words)
    if not text.isascii() or "_" in text:
        raise ValueError(text)
    return words


def shorten(words: list[str]) -> str:
    text = " ".join(words)
    return repr(text if len(text) <= 40 else text[:37] + "...") if text else ""


def merge_repeated(corners: Array) -> tuple[Array, Array]:
    """The vertices of facets that repeat the coordinates of their corners.

    Parameters
    ----------
    corners : ndarray
        Positions of all corners, one facet after another, shape (num_corners, 3).

    Returns
    -------
    vertices : ndarray
        Each position once, in the order of first appearance, shape (num_vertices, 3). Only corners
        with exactly equal coordinates are merged.
    numbers : ndarray
        The vertex of every corner, shape (num_corners,).
    """
    # Adding zero turns −0.0 into 0.0, so that equal positions have equal bytes.
    points = corners.reshape(-1, 3) + 0.0
    _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return points[first[order]], rank[inverse.ravel()]
