"""A file under examination: its lines, and errors that name the line where it breaks."""

from __future__ import annotations

import numpy as np

from ..errors import MeshError

__all__ = ["Source", "arrays", "merge_repeated", "shorten"]


class Source:
    """The bytes of a file, read line by line, with errors that name the file and the line.

    Parameters
    ----------
    path : str or Path
        The file's name, for messages only.
    data : bytes
        Its contents.
    """

    def __init__(self, path, data: bytes):
        self.path = path
        self.data = data
        self.line = 0
        self._next = 0

    def error(self, reason: str, line: int | None = None) -> MeshError:
        """The exception for a fault in a line, the current one unless another is given."""
        return MeshError(f"Mesh.read: {self.path}, line {line or max(self.line, 1)}: {reason}")

    def words(self, comment: bytes | None = None) -> list[str]:
        """The words of the next line that is not blank; an empty list at the end of the file.

        Text from `comment` to the end of a line does not count.
        """
        while self._next < len(self.data):
            end = self.data.find(b"\n", self._next)
            end = len(self.data) if end < 0 else end
            raw = self.data[self._next : end]
            self._next = end + 1
            self.line += 1
            if comment is not None:
                raw = raw.partition(comment)[0]
            words = raw.decode("utf-8", errors="replace").split()
            if words:
                return words
        return []

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
            return [float(word) for word in words[:3]]
        except ValueError:
            raise self.error(f"{what} needs 3 coordinates, got {shorten(words)}") from None

    def integer(self, word: str, what: str) -> int:
        """One integer."""
        try:
            return int(word)
        except ValueError:
            raise self.error(f"{what} must be an integer, got {word!r}") from None

    def triangle(self, words: list[str], face: int, num_vertices: int) -> list[int]:
        """The corners of a face that is written as a count and as many indices."""
        what = f"face {face}"
        count = self.integer(words[0], f"the number of vertices of {what}")
        self.check_corners(count, face)
        if len(words) < 4:
            raise self.error(f"{what} needs 3 vertex indices, got {len(words) - 1}")
        corners = [self.integer(word, f"a vertex index of {what}") for word in words[1:4]]
        for corner in corners:
            if not 0 <= corner < num_vertices:
                raise self.error(
                    f"{what} names vertex {corner}, but the file has {num_vertices} vertices, "
                    "counted from 0"
                )
        return corners

    def check_corners(self, count: int, face: int) -> None:
        """Refuse a face that is not a triangle."""
        if count != 3:
            raise self.error(
                f"face {face} has {count} vertices, not 3; triangulate the mesh before reading it"
            )


def shorten(words: list[str]) -> str:
    text = " ".join(words)
    return repr(text if len(text) <= 40 else text[:37] + "...") if text else ""


def arrays(vertices: list, triangles: list) -> tuple[np.ndarray, np.ndarray]:
    return (
        np.array(vertices, dtype=np.float64).reshape(-1, 3),
        np.array(triangles, dtype=np.int64).reshape(-1, 3),
    )


def merge_repeated(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of facets that repeat the coordinates of their corners.

    Parameters
    ----------
    corners : ndarray
        Shape (num_triangles, 3, 3): facet, corner, axis.

    Returns
    -------
    vertices : ndarray
        Each position once, in the order of first appearance, shape (num_vertices, 3). Only corners
        with exactly equal coordinates are merged.
    triangles : ndarray
        Shape (num_triangles, 3).
    """
    # Adding zero turns −0.0 into 0.0, so that equal positions have equal bytes.
    points = corners.reshape(-1, 3) + 0.0
    _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return points[first[order]], rank[inverse.ravel()].reshape(-1, 3)
