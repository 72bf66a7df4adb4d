"""Closed surfaces, put together from triangles that were listed in any order and orientation."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from ..._types import Array

__all__ = ["Component", "NotClosed", "Surfaces", "distinct", "parity"]

Triple = tuple[int, int, int]


class NotClosed(ValueError):
    """Triangles that are not a closed orientable surface, with the reason."""


def _cyclic(a: int, b: int, c: int) -> Triple:
    """The triangle starting at its lowest particle."""
    if b < a and b < c:
        return b, c, a
    if c < a and c < b:
        return c, a, b
    return a, b, c


def parity(a: int, b: int, c: int) -> tuple[Triple, int]:
    """The particles in ascending order, and −1 if that reverses the orientation."""
    a, b, c = _cyclic(a, b, c)
    return ((a, b, c), 1) if b < c else ((a, c, b), -1)


def distinct(rows: Array) -> tuple[Array, Array]:
    """The different triangles of a list, as they are listed, and which one each row is.

    Sums over pairs list every triangle thousands of times.

    Parameters
    ----------
    rows : ndarray of int, shape (num_rows, 3)

    Returns
    -------
    ndarray of int, shape (num_distinct, 3)
    ndarray of int, shape (num_rows,)
    """
    size = int(rows.max()) + 1
    if size**3 >= 2**63:
        found, number = np.unique(rows, axis=0, return_inverse=True)
        return found, number.ravel()
    code = (rows[:, 0] * size + rows[:, 1]) * size + rows[:, 2]
    _, first, number = np.unique(code, return_index=True, return_inverse=True)
    return rows[first], number.ravel()


class Component:
    """One connected closed surface.

    triangles: from ascending particles to +1 or −1, the orientation of the surface seen along the
    ascending order. Which of its two sides is outside is decided once all forces are read.
    """

    def __init__(self, triangles: dict[Triple, int]):
        self.triangles = triangles
        self.vertices = sorted({v for triple in triangles for v in triple})
        self._votes = 0.0
        self._certain = 0

    def vote(self, sign: int, weight: float = 1.0) -> None:
        """Say that a listing had this orientation relative to ours; the majority wins."""
        self._votes += sign * weight

    def decide(self, sign: int) -> bool:
        """Fix which side is outside; False if it was fixed the other way."""
        if self._certain == 0:
            self._certain = sign
        return self._certain == sign

    @property
    def sign(self) -> int:
        """+1 if `triangles` is counter-clockwise seen from outside."""
        return self._certain or (-1 if self._votes < 0 else 1)

    def outward(self) -> Array:
        """The triangles, counter-clockwise seen from outside, shape (num_triangles, 3)."""
        rows = [
            (a, b, c) if orientation * self.sign > 0 else (a, c, b)
            for (a, b, c), orientation in sorted(self.triangles.items())
        ]
        return np.array(rows, dtype=np.int64)


class Surfaces:
    """All surfaces that forces of one System are on; equal ones are one object."""

    def __init__(self, positions: Array | None = None) -> None:
        self._known: dict[frozenset[Triple], Component] = {}
        self._positions = positions

    def components(self, listed: Array) -> list[Component]:
        """The connected parts of a set of triangles.

        Parameters
        ----------
        listed : ndarray, shape (num_triangles, 3)
            Particle indices, repetitions allowed. Orientations may be inconsistent.

        Raises
        ------
        NotClosed
            If they are no closed orientable surface. The message names an edge or a vertex.
        """
        triples = {parity(*row)[0] for row in distinct(np.asarray(listed))[0].tolist()}
        for a, b, c in triples:
            if a == b or b == c:
                raise NotClosed(f"the triangle {(a, b, c)} repeats a particle")
        at_edge: dict[tuple[int, int], list[Triple]] = defaultdict(list)
        for a, b, c in sorted(triples):
            for edge in ((a, b), (b, c), (a, c)):
                at_edge[edge].append((a, b, c))
        for (a, b), owners in sorted(at_edge.items()):
            if len(owners) != 2:
                raise NotClosed(
                    f"the edge between particles {a} and {b} belongs to {len(owners)} of its "
                    "triangles, not 2"
                )
        result, rest = [], set(triples)
        while rest:
            oriented = _orient(min(rest), at_edge)
            rest -= oriented.keys()
            _check_fans(oriented)
            key = frozenset(oriented)
            if key not in self._known:
                self._known[key] = self._new(oriented)
            result.append(self._known[key])
        return sorted(result, key=lambda component: component.vertices[0])

    def _new(self, oriented: dict[Triple, int]) -> Component:
        component = Component(oriented)
        if self._positions is not None:
            corners = self._positions[component.outward()]
            corners = corners - corners.mean(axis=(0, 1))
            volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
            component.vote(1 if volume > 0 else -1, np.inf)
        return component


def _orient(start: Triple, at_edge: dict[tuple[int, int], list[Triple]]) -> dict[Triple, int]:
    """The orientations of all triangles that hang together with the first."""
    oriented = {start: 1}
    queue = [start]
    while queue:
        a, b, c = triple = queue.pop()
        for edge, along in (((a, b), 1), ((b, c), 1), ((a, c), -1)):
            (other,) = (t for t in at_edge[edge] if t != triple)
            # Neighbours run along their common edge in opposite directions.
            its = -1 if edge == (other[0], other[2]) else 1
            wanted = -oriented[triple] * along * its
            if other not in oriented:
                oriented[other] = wanted
                queue.append(other)
            elif oriented[other] != wanted:
                raise NotClosed(f"its triangles cannot be oriented; see {triple} and {other}")
    return oriented


def _check_fans(oriented: dict[Triple, int]) -> None:
    following: dict[int, dict[int, int]] = defaultdict(dict)
    for (a, b, c), orientation in oriented.items():
        if orientation < 0:
            b, c = c, b
        following[a][b], following[b][c], following[c][a] = c, a, b
    for vertex, successor in following.items():
        start = at = next(iter(successor))
        steps = 0
        while steps == 0 or at != start:
            at, steps = successor[at], steps + 1
        if steps != len(successor):
            raise NotClosed(f"its triangles around particle {vertex} form more than one fan")
