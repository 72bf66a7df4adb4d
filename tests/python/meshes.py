"""Membranes for the tests: small, irregular, and awkwardly numbered.

Nothing here is symmetric, because symmetry hides errors: vertices are jittered, triangles come in
random order, starting from a random corner. A membrane's particles are shuffled among particles
that belong to no membrane, and particle 0 is never one of them. All sizes are in nm; radii near
100 nm keep the forces of the default parameters near 1 kJ/mol/nm, far above the 2⁻³² kJ/mol/nm
that OpenMM's GPU platforms round to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import contact_twin
import numpy as np

FOREIGN_PARTICLES = 9


@dataclass(frozen=True, eq=False)
class Membrane:
    """A surface within a System: positions of all particles, triangles of particle indices.

    positions: shape (num_particles, 3), nm; triangles: shape (num_triangles, 3), outward.
    """

    name: str
    positions: np.ndarray
    triangles: np.ndarray

    @property
    def num_particles(self) -> int:
        return len(self.positions)

    @cached_property
    def members(self) -> np.ndarray:
        """The particles of the surface, ascending; the order of per-vertex values."""
        return np.unique(self.triangles)

    @cached_property
    def foreign(self) -> np.ndarray:
        return np.setdiff1d(np.arange(self.num_particles), self.members)

    @cached_property
    def parts(self) -> np.ndarray:
        """For each particle the lowest vertex that it is connected with, or itself."""
        labels = np.arange(self.num_particles)
        while True:
            lowest = labels[self.triangles].min(axis=1)
            updated = labels.copy()
            np.minimum.at(updated, self.triangles, lowest[:, None])
            if (updated == labels).all():
                return labels
            labels = updated

    @cached_property
    def max_degree(self) -> int:
        return int(np.bincount(self.triangles.ravel()).max())

    @cached_property
    def mean_edge(self) -> float:
        a, b = self.triangles[:, 0], self.triangles[:, 1]
        return float(np.linalg.norm(self.positions[a] - self.positions[b], axis=1).mean())


# --- surfaces: (vertices of shape (n, 3), triangles of shape (t, 3)) -----------------------------

Surface = tuple[np.ndarray, np.ndarray]


def icosahedron() -> Surface:
    golden = (1 + 5**0.5) / 2
    vertices = np.array(
        [[0, i, j * golden] for i in (-1, 1) for j in (-1, 1)]
        + [[i, j * golden, 0] for i in (-1, 1) for j in (-1, 1)]
        + [[j * golden, 0, i] for i in (-1, 1) for j in (-1, 1)]
    )
    return vertices / np.linalg.norm(vertices[0]), hull_triangles(vertices)


def hull_triangles(vertices: np.ndarray) -> np.ndarray:
    """The triangles of a convex set of points about the origin, outward."""
    from scipy.spatial import ConvexHull

    triangles = ConvexHull(vertices).simplices.astype(int)
    a, b, c = (vertices[column] for column in triangles.T)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return triangles


def icosphere(n: int) -> Surface:
    """A sphere of radius 1 of N = 10 n² + 2 vertices, 5 or 6 neighbours each."""
    corners, faces = icosahedron()
    numbers: dict[tuple[int, ...], int] = {}
    points: list[np.ndarray] = []
    triangles = []
    for face in faces.tolist():

        def vertex(i: int, j: int, face: list[int] = face) -> int:
            # Named by the corners' exact weights, so that neighbouring faces share their edge.
            weights = {face[0]: n - i - j, face[1]: i, face[2]: j}
            key = tuple(x for pair in sorted(weights.items()) if pair[1] for x in pair)
            if key not in numbers:
                point = sum(weight * corners[corner] for corner, weight in weights.items())
                numbers[key] = len(points)
                points.append(point / np.linalg.norm(point))
            return numbers[key]

        for i in range(n):
            for j in range(n - i):
                triangles.append((vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)))
                if i + j < n - 1:
                    triangles.append((vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)))
    return np.array(points), np.array(triangles)


def bipyramid(sides: int) -> Surface:
    """Two tips of `sides` neighbours each over a ring of vertices of four neighbours."""
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    following = np.roll(np.arange(sides), -1)
    triangles = [(i, j, sides) for i, j in enumerate(following)]
    triangles += [(j, i, sides + 1) for i, j in enumerate(following)]
    return np.concatenate([ring, [[0, 0, 0.7], [0, 0, -0.7]]]), np.array(triangles)


def with_pyramid(surface: Surface, face: int, height: float) -> Surface:
    """Raises a vertex of three neighbours from one triangle."""
    vertices, triangles = surface
    a, b, c = triangles[face]
    tip, new = vertices[[a, b, c]].mean(axis=0) * (1 + height), len(vertices)
    rest = np.delete(triangles, face, axis=0)
    return (
        np.concatenate([vertices, [tip]]),
        np.concatenate([rest, [[a, b, new], [b, c, new], [c, a, new]]]),
    )


def disjoint(*surfaces: Surface) -> Surface:
    """Several closed components in one list of triangles."""
    vertices, triangles, offset = [], [], 0
    for points, rows in surfaces:
        vertices.append(points)
        triangles.append(rows + offset)
        offset += len(points)
    return np.concatenate(vertices), np.concatenate(triangles)


def moved(surface: Surface, scale=(1, 1, 1), shift=(0, 0, 0)) -> Surface:
    vertices, triangles = surface
    return vertices * np.asarray(scale, dtype=float) + np.asarray(shift, dtype=float), triangles


def red_cell(surface: Surface) -> Surface:
    """The biconcave disc of Evans and Fung over the same vertices: most rim, dimpled middle."""
    (x, y, z), triangles = surface[0].T, surface[1]
    rho2 = x**2 + y**2
    height = 0.5 * z * (0.207 + 2.003 * rho2 - 1.123 * rho2**2)
    return np.stack([x, y, height], axis=1), triangles


def without(surface: Surface, *gone: int) -> Surface:
    """Without the triangles at some vertices, and without what belongs to none then."""
    vertices, triangles = surface
    kept = triangles[~np.isin(triangles, gone).any(axis=1)]
    used = np.unique(kept)
    return vertices[used], np.searchsorted(used, kept)


def grid(rows: int, columns: int, place, closed: bool) -> Surface:
    """Squares of two triangles round a tube; `place` has the points by turns in [0, 1)."""
    u, v = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    vertices = np.stack(place(u.ravel() / rows, v.ravel() / columns), axis=1)
    at = u * columns + v
    if not closed:
        rows -= 1
    a, c = at[:rows], np.roll(at, -1, axis=0)[:rows]
    b, d = np.roll(a, -1, axis=1), np.roll(c, -1, axis=1)
    return vertices, np.concatenate(
        [np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, c, d), (a, d, b))]
    )


def torus(rows: int, columns: int) -> Surface:
    def place(u, v):
        wide = 1 + 0.45 * np.cos(2 * np.pi * v)
        return (
            wide * np.cos(2 * np.pi * u),
            wide * np.sin(2 * np.pi * u),
            0.45 * np.sin(2 * np.pi * v),
        )

    return grid(rows, columns, place, True)


def joined(one: Surface, other: Surface) -> Surface:
    """A tube from the first triangle of one surface to that of another: the handles add up."""
    vertices, triangles = disjoint(one, other)
    a, b, c = triangles[0]
    second = len(one[1])
    # Round it the other way; the corner of `other` that is nearest begins.
    p, r, q = np.roll(
        triangles[second],
        -int(np.argmin(np.linalg.norm(vertices[triangles[second]] - vertices[a], axis=1))),
    )
    rest = np.delete(triangles, [0, second], axis=0)
    tube = [(a, b, p), (b, q, p), (b, c, q), (c, r, q), (c, a, r), (a, p, r)]
    return vertices, np.concatenate([rest, tube])


def rough(surface: Surface, rng: np.random.Generator, fraction: float) -> Surface:
    """Jitter by a fraction of the mean edge, in all directions, so that edges turn concave."""
    vertices, triangles = surface
    edge = np.linalg.norm(vertices[triangles[:, 0]] - vertices[triangles[:, 1]], axis=1).mean()
    return vertices + fraction * edge * rng.uniform(-1, 1, vertices.shape), triangles


def embedded(
    name: str, surface: Surface, seed: int, num_foreign: int = FOREIGN_PARTICLES
) -> Membrane:
    """The surface among particles that belong to no membrane, everything in random order."""
    rng = np.random.default_rng(seed)
    vertices, triangles = surface
    total = len(vertices) + num_foreign
    # Particle 0 and the last one stay foreign.
    index = 1 + rng.permutation(total - 2)[: len(vertices)]
    positions = rng.uniform(-200, 200, (total, 3))
    positions[index] = vertices
    rows = index[triangles][rng.permutation(len(triangles))]
    turns = rng.integers(3, size=len(rows))
    rows = np.stack([np.roll(row, turn) for row, turn in zip(rows, turns, strict=True)])
    return Membrane(name, positions, rows)


# --- the membranes of the tests ------------------------------------------------------------------


def _jittered() -> Surface:
    rng = np.random.default_rng(1)
    return rough(moved(icosphere(2), (100, 100, 100), (30, -20, 10)), rng, 0.15)


def _stretched() -> Surface:
    rng = np.random.default_rng(2)
    return moved(rough(icosphere(3), rng, 0.12), (190, 100, 55), (-40, 10, 25))


def _concave() -> Surface:
    rng = np.random.default_rng(3)
    return moved(rough(red_cell(icosphere(5)), rng, 0.06), (160, 160, 160), (5, 60, -15))


def _two_parts() -> Surface:
    rng = np.random.default_rng(4)
    large = moved(rough(icosphere(2), rng, 0.15), (90, 110, 100), (-70, 0, 0))
    small = moved(rough(icosphere(2), rng, 0.15), (50, 35, 60), (120, 25, -30))
    return disjoint(large, small)


def _icosahedron() -> Surface:
    """Five neighbours each; one vertex is pushed in below its ring."""
    rng = np.random.default_rng(5)
    surface = moved(rough(icosahedron(), rng, 0.15), (90, 60, 75))
    surface[0][3] *= 0.3
    return moved(surface, shift=(-80, 5, 0))


def _octahedron() -> Surface:
    """Four neighbours each; one tip is pushed through the middle."""
    rng = np.random.default_rng(6)
    surface = moved(rough(bipyramid(4), rng, 0.1), (70, 95, 80))
    surface[0][4] *= -0.2
    return moved(surface, shift=(100, 10, 20))


def _many_neighbours() -> Surface:
    """Three to twelve neighbours, with obtuse triangles."""
    rng = np.random.default_rng(7)
    return moved(rough(with_pyramid(bipyramid(11), 3, 0.25), rng, 0.08), (110, 90, 100))


def _torus() -> Surface:
    rng = np.random.default_rng(8)
    return moved(rough(torus(9, 5), rng, 0.1), (90, 80, 95), (20, 0, -10))


def _double_torus() -> Surface:
    rng = np.random.default_rng(9)
    left, right = torus(7, 5), moved(torus(8, 5), shift=(3.2, 0.2, 0.1))
    # The triangles that are nearest to each other come first.
    middles = [vertices[triangles].mean(axis=1) for vertices, triangles in (left, right)]
    gaps = np.linalg.norm(middles[0][:, None] - middles[1][None], axis=2)
    first = np.unravel_index(np.argmin(gaps), gaps.shape)
    left, right = (
        (v, np.roll(t, -int(k), axis=0)) for (v, t), k in zip((left, right), first, strict=True)
    )
    return moved(rough(joined(left, right), rng, 0.06), (80, 85, 75), (-60, 0, 0))


def _disk() -> Surface:
    """A hexagonal patch; its inner vertices have six neighbours each."""
    rng = np.random.default_rng(10)
    steps = np.arange(-2, 3)
    i, j = (x.ravel() for x in np.meshgrid(steps, steps, indexing="ij"))
    inside = np.abs(i + j) <= 2
    number = {pair: n for n, pair in enumerate(map(tuple, np.stack([i, j], 1)[inside].tolist()))}
    triangles = [
        [number[corner] for corner in corners]
        for i, j in number
        for corners in (
            ((i, j), (i + 1, j), (i, j + 1)),
            ((i + 1, j), (i + 1, j + 1), (i, j + 1)),
        )
        if all(corner in number for corner in corners)
    ]
    i, j = np.array(list(number)).T
    vertices = np.stack([i + j / 2, j * 0.75**0.5, 0.35 * i * j], axis=1)
    return moved(rough((vertices, np.array(triangles)), rng, 0.12), (45, 40, 42), (10, 0, 30))


def _cap() -> Surface:
    """An icosahedron without a vertex: five neighbours each, and a border of five edges."""
    rng = np.random.default_rng(11)
    return moved(rough(without(icosahedron(), 4), rng, 0.12), (90, 70, 80), (0, -20, 0))


def _holed() -> Surface:
    """An octahedron without a face: three inner vertices of four neighbours."""
    rng = np.random.default_rng(12)
    vertices, triangles = bipyramid(4)
    return moved(rough((vertices, np.delete(triangles, 3, axis=0)), rng, 0.1), (80, 90, 85))


def _tube() -> Surface:
    """Two borders."""
    rng = np.random.default_rng(13)

    def place(u, v):
        return np.cos(2 * np.pi * v), np.sin(2 * np.pi * v), 4 * u

    return moved(rough(grid(5, 6, place, False), rng, 0.1), (70, 60, 75), (15, 15, -90))


def _torn_torus() -> Surface:
    """A handle, and a border where two neighbours have been."""
    rng = np.random.default_rng(14)
    return moved(rough(without(torus(8, 5), 7, 8), rng, 0.08), (90, 80, 95))


def _mixed() -> Surface:
    """A closed part and one with two borders, in one list."""
    rng = np.random.default_rng(15)
    closed = moved(rough(icosphere(1), rng, 0.12), (50, 60, 55), (-90, 0, 0))
    annulus = without(icosphere(2), 0, int(np.argmin(icosphere(2)[0] @ icosphere(2)[0][0])))
    return disjoint(closed, moved(rough(annulus, rng, 0.1), (70, 80, 60), (70, 0, 0)))


def _crumpled() -> Membrane:
    """A disk so thin that its sides touch, and a small sphere beside it that touches, too.

    30 particles beside it are near, some inside.
    """
    rng = np.random.default_rng(4)
    vertices, triangles = icosphere(4)
    thickness = 2.0 + 60 * (vertices[:, :2] ** 2).sum(axis=1)
    vertices = vertices * np.stack([np.full(162, 50), np.full(162, 60), thickness], axis=1)
    disk = rough((vertices, triangles), rng, 0.08)
    small = rough(icosphere(1), rng, 0.08)
    surface = disjoint(disk, moved(small, scale=(12, 12, 12), shift=(10, 5, 23)))
    result = embedded("crumpled", surface, 4, 60)
    tried = result.positions[rng.choice(result.members, 300)] + rng.uniform(-9, 9, (300, 3))
    near = contact_twin.nearest(tried, result.positions[result.triangles])
    gaps = np.linalg.norm(near, axis=2).min(axis=1)
    result.positions[result.foreign[::2]] = tried[(gaps > 4) & (gaps < 9)][:30]
    return result


_MAKERS: dict[str, Callable[[], Surface]] = {
    "jittered": _jittered,
    "stretched": _stretched,
    "concave": _concave,
    "two parts": _two_parts,
    "icosahedron": _icosahedron,
    "octahedron": _octahedron,
    "many neighbours": _many_neighbours,
}
NAMES = tuple(_MAKERS)
# Closed, with handles; with borders.
_WITH_HANDLES = {"torus": _torus, "double torus": _double_torus}
_OPEN = {
    "disk": _disk,
    "cap": _cap,
    "holed": _holed,
    "tube": _tube,
    "torn torus": _torn_torus,
    "mixed": _mixed,
}
_MAKERS |= _WITH_HANDLES | _OPEN
HANDLE_NAMES = tuple(_WITH_HANDLES)
OPEN_NAMES = tuple(_OPEN)
# For contacts: what is no neighbour is near.
TOUCHING_NAMES = ("crumpled",)
# Of several parts.
PARTS_NAMES = ("two parts", "mixed", "crumpled")


@cache
def membrane(name: str) -> Membrane:
    """One of these names; the same object each time, its arrays read-only."""
    if name in TOUCHING_NAMES:
        result = _crumpled()
    else:
        result = embedded(name, _MAKERS[name](), seed=100 + list(_MAKERS).index(name))
    result.positions.flags.writeable = False
    result.triangles.flags.writeable = False
    return result
