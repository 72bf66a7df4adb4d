"""The membrane potentials in numpy: energies only, a page of array arithmetic.

A third opinion beside the plugin and the string forces, and the one that is easiest to read
against the formulas. Vertices have shape (num_vertices, 3) in nm, triangles (num_triangles, 3),
counter-clockwise seen from outside; per-vertex results are in the order of the vertices.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np


class Geometry:
    """The quantities of one oriented surface that the potentials are functions of.

    Curvatures, vectors and Voronoi areas mean something at vertices that are `inner` only.
    """

    def __init__(self, vertices, triangles) -> None:
        # Those in a periodic box know how to take differences.
        self.vertices = np.asanyarray(vertices, dtype=float)
        self.triangles = np.asarray(triangles, dtype=int)

    def _sum(self, index, values) -> np.ndarray:
        """Sum of `values` by vertex."""
        values = np.asarray(values, dtype=float)
        if values.ndim == 1:
            return np.bincount(index, values, minlength=len(self.vertices))
        return np.stack([self._sum(index, column) for column in values.T], axis=1)

    @cached_property
    def normals(self) -> np.ndarray:
        """AB × AC of each triangle, shape (num_triangles, 3), nm²."""
        a, b, c = (self.vertices[column] for column in self.triangles.T)
        return np.cross(b - a, c - a)

    @cached_property
    def areas(self) -> np.ndarray:
        return np.linalg.norm(self.normals, axis=1) / 2

    @cached_property
    def area(self) -> float:
        return float(self.areas.sum())

    @cached_property
    def volume(self) -> float:
        # Relative to a vertex, so that a mesh far from the origin loses no digits.
        relative = self.vertices - self.vertices[self.triangles[0, 0]]
        a, b, c = (relative[column] for column in self.triangles.T)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @cached_property
    def half_edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Tail, head, opposite corner and twin's opposite corner of every half-edge.

        At a border, where there is no twin, the last is the opposite corner again.
        """
        t = self.triangles
        tail, head = t.ravel(), t[:, [1, 2, 0]].ravel()
        corner = t[:, [2, 0, 1]].ravel()
        return tail, head, corner, corner[self._twins[0]]

    @cached_property
    def _twins(self) -> tuple[np.ndarray, np.ndarray]:
        """The twin of every half-edge, itself at a border; and where that is."""
        tail, head = self.triangles.ravel(), self.triangles[:, [1, 2, 0]].ravel()
        n = len(self.vertices)
        order = np.argsort(tail * n + head)
        keys = (tail * n + head)[order]
        if (keys[1:] == keys[:-1]).any():
            raise ValueError("the triangles are not a consistently oriented surface")
        place = np.minimum(np.searchsorted(keys, head * n + tail), len(keys) - 1)
        border = keys[place] != head * n + tail
        return np.where(border, np.arange(len(keys)), order[place]), border

    @cached_property
    def border(self) -> np.ndarray:
        """Which half-edges are along borders."""
        return self._twins[1]

    @cached_property
    def inner(self) -> np.ndarray:
        """Which vertices belong to triangles and are on no border."""
        tail, head, _, _ = self.half_edges
        inner = np.zeros(len(self.vertices), dtype=bool)
        inner[tail] = True
        inner[tail[self.border]] = inner[head[self.border]] = False
        return inner

    @cached_property
    def lengths(self) -> np.ndarray:
        tail, head, _, _ = self.half_edges
        return np.linalg.norm(self.vertices[tail] - self.vertices[head], axis=1)

    @cached_property
    def angles(self) -> np.ndarray:
        """φ of every half-edge: 0 if flat, positive at a convex edge, negative at a concave one."""
        a, b, c, d = (self.vertices[index] for index in self.half_edges)
        left, right = np.cross(b - a, c - a), np.cross(a - b, d - b)
        sine = -self.lengths * np.einsum("ij,ij->i", left, d - a)
        angles = np.arctan2(sine, np.einsum("ij,ij->i", left, right))
        return np.where(self.border, 0.0, angles)

    @cached_property
    def cotangents(self) -> np.ndarray:
        """cot θ1 + cot θ2 of the two angles opposite every half-edge."""
        a, b, c, d = (self.vertices[index] for index in self.half_edges)
        total = np.zeros(len(a))
        for wing in (c, d):
            u, v = a - wing, b - wing
            cross = np.linalg.norm(np.cross(u, v), axis=1)
            total += np.einsum("ij,ij->i", u, v) / cross
        return total

    @cached_property
    def barycentric_areas(self) -> np.ndarray:
        return self._sum(self.triangles.ravel(), np.repeat(self.areas, 3) / 3)

    @cached_property
    def voronoi_areas(self) -> np.ndarray:
        return self._sum(self.half_edges[0], self.lengths**2 * self.cotangents / 8)

    @cached_property
    def integrated_curvatures(self) -> np.ndarray:
        """J of (B11)."""
        return self._sum(self.half_edges[0], self.lengths * self.angles / 2)

    @cached_property
    def mean_curvature(self) -> float:
        """Σ l φ / 2 over the edges, each of which is two half-edges."""
        return float(np.sum(self.lengths * self.angles) / 4)

    @cached_property
    def curvature_vectors(self) -> np.ndarray:
        """S of (B7)."""
        tail, head, _, _ = self.half_edges
        steps = self.vertices[tail] - self.vertices[head]
        return self._sum(tail, self.cotangents[:, None] * steps / 2)

    @cached_property
    def neighbour_sums(self) -> np.ndarray:
        """Σ_j (r_i − r_j), √3 times S if all triangles are equilateral."""
        tail, head, _, _ = self.half_edges
        return self._sum(tail, self.vertices[tail] - self.vertices[head])

    @cached_property
    def vertex_normals(self) -> np.ndarray:
        """n of (B9)."""
        tail, head, corner, _ = self.half_edges
        u, v = (self.vertices[end] - self.vertices[tail] for end in (head, corner))
        cross = np.cross(u, v)
        size = np.linalg.norm(cross, axis=1)
        theta = np.arctan2(size, np.einsum("ij,ij->i", u, v))
        total = self._sum(tail, (theta / size)[:, None] * cross)
        return total / np.linalg.norm(total, axis=1)[:, None]

    @cached_property
    def angle_sums(self) -> np.ndarray:
        """The sum of the triangles' angles at each vertex."""
        tail, head, corner, _ = self.half_edges
        u, v = (self.vertices[end] - self.vertices[tail] for end in (head, corner))
        size = np.linalg.norm(np.cross(u, v), axis=1)
        return self._sum(tail, np.arctan2(size, np.einsum("ij,ij->i", u, v)))

    @cached_property
    def heights(self) -> np.ndarray:
        """The three heights of each triangle."""
        return 2 * np.repeat(self.areas, 3) / self.lengths


def quadratic(value: float, modulus: float, target: float) -> float:
    return float(0.5 * modulus * (value - target) ** 2 / target)


def global_area(vertices, triangles, modulus: float, target: float) -> float:
    return quadratic(Geometry(vertices, triangles).area, modulus, target)


def global_volume(vertices, triangles, modulus: float, target: float) -> float:
    return quadratic(Geometry(vertices, triangles).volume, modulus, target)


def osmotic_pressure(vertices, triangles, solutes, concentration, thermalEnergy) -> float:  # noqa: N803
    x = concentration * Geometry(vertices, triangles).volume / solutes
    return float(solutes * thermalEnergy * (x - 1 - np.log(x)))


def triangle_area(vertices, triangles, modulus: float, target) -> float:
    areas = Geometry(vertices, triangles).areas
    return float(np.sum(0.5 * modulus * (areas - target) ** 2 / np.asarray(target)))


def triangle_heights(vertices, triangles, min_height: float, epsilon: float) -> float:
    heights = Geometry(vertices, triangles).heights
    x = (min_height / heights[heights < 2**0.25 * min_height]) ** 4
    return float(epsilon * np.sum(x**2 - x + 0.25))


def triangle_area_repulsion(vertices, triangles, min_area: float, epsilon: float) -> float:
    areas = Geometry(vertices, triangles).areas
    x = (min_area / areas[areas < 2**0.25 * min_area]) ** 4
    return float(epsilon * np.sum(x**2 - x + 0.25))


def plaquette_area(vertices, triangles, stiffness: float, target: float) -> float:
    used = np.unique(triangles)
    areas = Geometry(vertices, triangles).barycentric_areas[used]
    return float(0.5 * stiffness * np.sum((len(used) * areas / target - 1) ** 2))


def bending(
    vertices,
    triangles,
    rigidity,
    spontaneous_curvature=0.0,
    scheme: str = "Julicher",
    unsigned: bool = False,
) -> float:
    """The bending energy; vertices that belong to no triangle are left out."""
    used = np.unique(triangles)
    g = Geometry(np.asanyarray(vertices)[used], np.searchsorted(used, triangles))
    voronoi = scheme in ("GompperKroll", "JulicherVoronoi")
    area = g.voronoi_areas if voronoi else g.barycentric_areas
    if scheme in ("Julicher", "JulicherVoronoi"):
        squared, linear = g.integrated_curvatures**2, g.integrated_curvatures
    else:
        vectors = g.neighbour_sums / 3**0.5 if scheme == "Espriu" else g.curvature_vectors
        squared = (vectors**2).sum(axis=1)
        signed = (vectors * g.vertex_normals).sum(axis=1)
        linear = np.sqrt(squared) if unsigned else signed
    c0 = spontaneous_curvature
    with np.errstate(all="ignore"):
        each = 0.5 * rigidity * (squared / area - 2 * c0 * linear + c0**2 * area)
    return float(np.sum(each[g.inner]))


def edge_tension(vertices, triangles, tension: float) -> float:
    g = Geometry(vertices, triangles)
    return float(tension * np.sum(g.lengths[g.border]))


def gaussian_curvature(vertices, triangles, modulus) -> float:
    """By its definition, with no theorem; of one modulus, or one for each vertex in use."""
    g = Geometry(vertices, triangles)
    moduli = np.zeros(len(g.vertices))
    moduli[np.unique(triangles)] = modulus
    return float(np.sum((moduli * (2 * np.pi - g.angle_sums))[g.inner]))


# --- against a reference -------------------------------------------------------------------------


def placed(vertices, triangles, numbers) -> np.ndarray:
    """Rows of vertices, in ascending order, at their places among all particles."""
    used = np.unique(triangles)
    everywhere = np.array(vertices, copy=True, subok=True)
    everywhere[used] = numbers
    return everywhere


def _metric(vertices, triangles) -> np.ndarray:
    """Products of the sides ab and ac of each triangle, shape (num_triangles, 2, 2)."""
    a, b, c = (np.asanyarray(vertices)[column] for column in np.asarray(triangles).T)
    sides = np.stack([np.asarray(b - a), np.asarray(c - a)], axis=1)
    return np.einsum("tik,tjk->tij", sides, sides)


def _stretches(vertices, triangles, reference) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The principal stretches of each triangle, and its area at rest."""
    at_rest = _metric(placed(vertices, triangles, reference), triangles)
    squares = np.linalg.eigvals(np.linalg.solve(at_rest, _metric(vertices, triangles))).real
    one, other = np.sqrt(squares).T
    return one, other, np.sqrt(np.linalg.det(at_rest)) / 2


def skalak(vertices, triangles, shear_modulus: float, area_modulus: float, reference) -> float:
    one, other, area = _stretches(vertices, triangles, reference)
    first, second = one**2 + other**2 - 2, (one * other) ** 2 - 1
    shear = shear_modulus / 4 * (first**2 / 2 + first - second)
    return float(np.sum(area * (shear + area_modulus / 8 * second**2)))


def neo_hookean(vertices, triangles, shear_modulus: float, area_modulus: float, reference) -> float:
    one, other, area = _stretches(vertices, triangles, reference)
    shear = shear_modulus / 2 * (one / other + other / one - 2)
    return float(np.sum(area * (shear + area_modulus / 2 * (one * other - 1) ** 2)))


def linear_elastic(
    vertices, triangles, shear_modulus: float, area_modulus: float, reference
) -> float:
    one, other, area = _stretches(vertices, triangles, reference)
    one, other = (one**2 - 1) / 2, (other**2 - 1) / 2
    shear = shear_modulus / 2 * (one - other) ** 2
    return float(np.sum(area * (shear + area_modulus / 2 * (one + other) ** 2)))


def edges(triangles) -> np.ndarray:
    """Both ends of each edge, shape (num_edges, 2)."""
    t = np.asarray(triangles)
    return np.unique(np.sort(t[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)


def edge_lengths(vertices, triangles) -> np.ndarray:
    start, end = (np.asanyarray(vertices)[column] for column in edges(triangles).T)
    return np.linalg.norm(np.asarray(end - start), axis=1)


def chain(ratio: float) -> tuple[float, float]:
    """Of a spring of stiffness and length 1 at rest: A of the worm-like chain, p of the power."""
    slope = 1 / (1 - ratio) ** 2 - 1 + 4 * ratio
    bend = 2 / (1 - ratio) ** 3 + 4
    strength = 1 / ratio**2 / (bend + 2 * slope / ratio)
    return strength, strength * slope * ratio


def spring(
    vertices, triangles, stiffness: float, reference, ratio: float = 1 / 2.2, form: str = "Harmonic"
) -> float:
    at_rest = edge_lengths(placed(vertices, triangles, reference), triangles)
    stretch = edge_lengths(vertices, triangles) / at_rest
    if form == "Harmonic":
        energy = (stretch - 1) ** 2 / 2
    else:
        strength, power = chain(ratio)
        x = np.stack([stretch, np.ones_like(stretch)]) * ratio
        worm = (3 * x**2 - 2 * x**3) / (1 - x)
        energy = strength * (worm[0] - worm[1]) + power * (1 / stretch - 1)
    return float(stiffness * np.sum(energy * at_rest**2))


def line_tension(vertices, triangles, tension: float, domains) -> float:
    """The pieces of the line one by one."""
    used = np.unique(triangles)
    kind = dict(zip(used.tolist(), np.asarray(domains).tolist(), strict=True))
    length = 0.0
    for a, b, c in np.asarray(triangles).tolist():
        origin = np.asanyarray(vertices)[a]
        points = [np.asarray(np.asanyarray(vertices)[v] - origin) for v in (a, b, c)]
        corners = [(kind[v], point) for v, point in zip((a, b, c), points, strict=True)]
        middles = [
            (p + q) / 2
            for (k, p), (m, q) in zip(corners, corners[1:] + corners[:1], strict=True)
            if k != m
        ]
        if len(middles) == 2:
            length += np.linalg.norm(middles[0] - middles[1])
        for middle in middles if len(middles) == 3 else []:
            length += np.linalg.norm(middle - sum(points) / 3)
    return float(tension * length)


DIHEDRAL_FORMS = {
    "Quartic": lambda phi: (1 - np.cos(phi)) ** 2,
    "Cosine": lambda phi: 1 - np.cos(phi),
    "Exp": lambda phi: 0.5 * np.expm1(2 * (1 - np.cos(phi))),
    "SmoothExp": lambda phi: 0.04 * np.expm1(10 * (1 - np.cos(phi))),
    "SmoothExp46": lambda phi: 0.5 * (np.expm1(2 * (1 - np.cos(phi))) - phi**2),
}


def dihedral(vertices, triangles, stiffness, form: str = "Quartic", rest=0.0) -> float:
    """Stiffness and angle at rest are one for all, or one for each edge in lexicographic order."""
    g = Geometry(vertices, triangles)
    tail, head, _, _ = g.half_edges
    once = (tail < head) | g.border
    order = np.lexsort((np.maximum(tail, head)[once], np.minimum(tail, head)[once]))
    angles = g.angles[once][order] - rest
    energies = stiffness * DIHEDRAL_FORMS[form](angles - 2 * np.pi * np.round(angles / (2 * np.pi)))
    return float(np.sum(energies[~g.border[once][order]]))


def has_angle(triangles) -> np.ndarray:
    """Which of the edges in lexicographic order are on no border."""
    t = np.asarray(triangles, dtype=int)
    ends = np.sort(np.stack([t, t[:, [1, 2, 0]]], axis=-1).reshape(-1, 2), axis=1)
    return np.unique(ends, axis=0, return_counts=True)[1] == 2
