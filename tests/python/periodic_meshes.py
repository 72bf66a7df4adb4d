"""Surfaces in a periodic box: sheet, tube and Schwarz P cell that span it, vesicle across faces.

Positions know their box, so that whoever takes differences of them can take the nearest images.
They are on a grid of dyadic fractions, as the box is: wrapping then changes no bit.
"""

from __future__ import annotations

from functools import cache

import meshes
import numpy as np
from meshes import Membrane, Surface

#: Rows are box vectors, nm, in OpenMM's reduced form.
BOXES = {
    "rectangular": np.diag([400.0, 420.0, 384.0]),
    "triclinic": np.array([[400.0, 0, 0], [96.0, 420, 0], [-112.0, 64, 384]]),
}


class Positions(np.ndarray):
    """Coordinates with their box: differences of two of them are nearest images."""

    box: np.ndarray

    def __array_finalize__(self, other) -> None:
        self.box = getattr(other, "box", None)

    def __sub__(self, other):
        difference = super().__sub__(other)
        if not isinstance(other, Positions):
            return difference
        nearest = np.array(difference)
        for axis in (2, 1, 0):
            images = np.round(nearest[..., axis] / self.box[axis, axis])
            nearest -= images[..., None] * self.box[axis]
        return nearest


def in_box(positions, box) -> Positions:
    result = np.array(positions, dtype=float).view(Positions)
    result.box = box
    return result


def dyadic(values) -> np.ndarray:
    return np.round(np.asarray(values) * 2**20) / 2**20


def grid(n: int, m: int) -> np.ndarray:
    """Triangles of a grid that closes in both directions."""
    i, j = (index.ravel() for index in np.meshgrid(range(n), range(m), indexing="ij"))
    a, b = i * m + j, (i + 1) % n * m + j
    c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


# Coordinates along the box vectors, from 0 to 1.


def sheet(n: int, m: int, rng: np.random.Generator) -> Surface:
    u, v = (index.ravel() for index in np.meshgrid(range(n), range(m), indexing="ij"))
    u, v = u + rng.uniform(-0.2, 0.2, n * m), v + rng.uniform(-0.2, 0.2, n * m)
    height = 0.03 * np.sin(2 * np.pi * u / n) + rng.uniform(-0.012, 0.012, n * m)
    return np.stack([u / n, v / m, height], axis=1), grid(n, m)


def tube(n: int, m: int, rng: np.random.Generator) -> Surface:
    """Along the third box vector."""
    u, v = (index.ravel() for index in np.meshgrid(range(n), range(m), indexing="ij"))
    turn = 2 * np.pi * (u + rng.uniform(-0.15, 0.15, n * m)) / n
    radius = 0.2 + rng.uniform(-0.012, 0.012, n * m)
    along = (v + rng.uniform(-0.2, 0.2, n * m)) / m
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), along], axis=1), grid(n, m)


def schwarz_p(k: int, rng: np.random.Generator) -> Surface:
    """cos X + cos Y + cos Z = 0, from cubes: a node and three arms a period, k³ cubes each."""
    n = 2 * k
    inside = (np.indices((n, n, n)) >= k).sum(axis=0) <= 1
    quads = []
    for cell in np.argwhere(inside):
        for axis in range(3):
            for side in (0, 1):
                beyond = cell.copy()
                beyond[axis] += 2 * side - 1
                if inside[tuple(beyond % n)]:
                    continue
                corner, (one, other) = cell.copy(), np.delete(np.eye(3, dtype=int), axis, axis=0)
                corner[axis] += side
                turn = [corner, corner + one, corner + one + other, corner + other]
                # Seen from outside counter-clockwise.
                outward = (np.cross(one, other)[axis] > 0) == (side == 1)
                quads.append(turn if outward else turn[::-1])
    points, index = np.unique(np.array(quads).reshape(-1, 3) % n, axis=0, return_inverse=True)
    a, b, c, d = index.reshape(-1, 4).T
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    phase = 2 * np.pi * (points - k / 2) / n
    for _ in range(20):
        slope = -np.sin(phase)
        phase -= slope * (np.cos(phase).sum(axis=1) / (slope**2).sum(axis=1))[:, None]
    phase += rng.uniform(-0.05, 0.05, phase.shape)
    return phase / (2 * np.pi), triangles


def vesicle(rng: np.random.Generator) -> Surface:
    """Across a corner of the box."""
    return meshes.moved(meshes.rough(meshes.icosphere(2), rng, 0.12), (0.2, 0.17, 0.18))


def spread(*surfaces: Surface) -> Surface:
    """Beside each other in the box; forces do not see whether parts cross."""
    rng = np.random.default_rng(17)
    parts = [meshes.moved(surface, shift=rng.uniform(0, 1, 3)) for surface in surfaces]
    return meshes.disjoint(*parts)


def _simple() -> Surface:
    """Rings that OpenMM can compile string forces for."""
    rng = np.random.default_rng(21)
    return spread(sheet(8, 7, rng), tube(7, 8, rng), vesicle(rng))


def _spanning() -> Surface:
    rng = np.random.default_rng(22)
    return spread(sheet(7, 8, rng), schwarz_p(4, rng), tube(8, 7, rng))


def _facing() -> Surface:
    """Two sheets that face each other across a face of the box, and cross nothing."""
    rng = np.random.default_rng(25)
    sheets = [sheet(12, 13, rng), sheet(13, 12, rng)]
    return meshes.disjoint(
        *(
            meshes.moved(s, (1, 1, 0.4), (0, 0, z))
            for s, z in zip(sheets, (0.04, 0.96), strict=True)
        )
    )


def _torn() -> Surface:
    """With holes, one of them across a face."""
    rng = np.random.default_rng(24)
    return spread(meshes.without(sheet(7, 8, rng), 0, 26, 27), meshes.without(tube(8, 7, rng), 30))


_MAKERS = {
    "simple": _simple,
    "spanning": _spanning,
    "torn": _torn,
    "vesicle": lambda: vesicle(np.random.default_rng(23)),
    "facing": _facing,
}
NAMES = tuple(_MAKERS)


@cache
def periodic(name: str, shape: str) -> Membrane:
    """One of NAMES in one of BOXES, its vertices wrapped anywhere; the same object each time."""
    box = BOXES[shape]
    membrane = meshes.embedded(name, _MAKERS[name](), seed=300 + NAMES.index(name))
    scaled = membrane.positions @ box
    scaled[membrane.foreign] = membrane.positions[membrane.foreign]
    positions = wrapped(in_box(dyadic(scaled), box), seed=1)
    positions.flags.writeable = False
    return Membrane(name, positions, membrane.triangles)


def wrapped(positions: Positions, seed: int) -> Positions:
    """The same with whole box vectors added at random."""
    images = np.random.default_rng(seed).integers(-3, 4, positions.shape)
    return in_box(np.asarray(positions) + images @ positions.box, positions.box)
