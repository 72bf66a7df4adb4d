"""The membrane potentials once more, as OpenMM Custom forces: an oracle that shares no code with
the plugin.

Every potential comes in two styles of expression, which OpenMM differentiates along different
paths, so that a slip in one of them shows as a disagreement between the two:

* ``"geometric"``: OpenMM's ``distance()``, ``angle()`` and ``dihedral()`` functions;
* ``"cartesian"``: plain algebra of ``x1, y1, z1, …``.

Each function takes the triangles as particle indices, shape (num_triangles, 3), counter-clockwise
seen from outside, and returns a list of forces whose energies add up to the potential. Their cost
is O(N): one bond for each vertex, edge or triangle, whatever the potential.

Two choices keep the expressions well-conditioned. An edge's angle never comes from the arc cosine
of the normals' product, which loses half of the digits where the membrane is flat: it is an
``atan2``, or pi minus OpenMM's dihedral, which is accurate near 0 and near pi. And differences of
positions are taken before anything is squared, so that a mesh far from the origin loses nothing.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np
import openmm as mm

STYLES = ("geometric", "cartesian")
PI = repr(np.pi)

Values = float | Sequence[float] | np.ndarray


# --- topology ----------------------------------------------------------------------------------


def rings(triangles) -> dict[int, list[int]]:
    """The neighbours of each vertex, counter-clockwise seen from outside, by ascending vertex.

    Those of a vertex on a border begin and end with the ends of border edges.
    """
    following: dict[int, dict[int, int]] = {}
    for a, b, c in np.asarray(triangles, dtype=int).tolist():
        following.setdefault(a, {})[b] = c
        following.setdefault(b, {})[c] = a
        following.setdefault(c, {})[a] = b
    result = {}
    for vertex in sorted(following):
        successor = following[vertex]
        ring = [min(set(successor) - set(successor.values()), default=min(successor))]
        while ring[-1] in successor and successor[ring[-1]] != ring[0]:
            ring.append(successor[ring[-1]])
            if len(ring) > len(successor) + 1:
                raise ValueError(f"the triangles around vertex {vertex} make no ring")
        if len(ring) != len(successor) + (ring[-1] not in successor):
            raise ValueError(f"vertex {vertex} joins two fans of triangles")
        result[vertex] = ring
    return result


def on_borders(triangles) -> set[int]:
    """The vertices on borders."""
    rows = np.asarray(triangles, dtype=int).tolist()
    sides = {side for a, b, c in rows for side in ((a, b), (b, c), (c, a))}
    return {vertex for a, b in sides if (b, a) not in sides for vertex in (a, b)}


def edges_with_wings(triangles) -> list[tuple[int, int, int, int]]:
    """(c, a, b, d) for each edge ab with triangle abc on its left and triangle bad on its right."""
    opposite = {}
    for a, b, c in np.asarray(triangles, dtype=int).tolist():
        opposite[a, b] = c
        opposite[b, c] = a
        opposite[c, a] = b
    return [
        (c, a, b, opposite[b, a])
        for (a, b), c in sorted(opposite.items())
        if a < b and (b, a) in opposite
    ]


# --- writing expressions -----------------------------------------------------------------------


def _sum(terms: Sequence[str]) -> str:
    """The terms in a balanced tree of brackets.

    OpenMM copies an expression's tree at every level as it parses and differentiates it. A chain
    of n sums is n levels deep, and the long expressions then take minutes instead of seconds.
    """
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return f"({_sum(terms[:half])}+{_sum(terms[half:])})"


def _number(value: float) -> str:
    """A literal that reads back as the same double, in brackets for the sake of its sign."""
    return f"({float(value)!r})"


class _Stencil(ABC):
    """Writes one bond's expression: quantities are named once, however often they are used.

    Points are the bond's particles, numbered from 1 as in OpenMM's ``p1``. The two subclasses say
    how a quantity is written; the formulas below know only the quantities.
    """

    def __init__(self) -> None:
        self._definitions: dict[str, str] = {}

    def define(self, name: str, expression: str) -> str:
        self._definitions.setdefault(name, expression)
        return name

    def expression(self, energy: str) -> str:
        """The energy, followed by what it uses; OpenMM wants users before what they use."""
        definitions = reversed(self._definitions.items())
        return "; ".join([energy, *(f"{name}={text}" for name, text in definitions)])

    @abstractmethod
    def turning(self, c: int, a: int, b: int, d: int) -> str:
        """φ of edge ab between triangles abc and bad: 0 if flat, positive if convex."""

    @abstractmethod
    def length(self, a: int, b: int) -> str:
        """Distance of a and b."""

    def length2(self, a: int, b: int) -> str:
        return self.define(f"q{min(a, b)}_{max(a, b)}", f"{self.length(a, b)}^2")

    @abstractmethod
    def double_area(self, a: int, b: int, c: int) -> str:
        """Twice the area of the triangle abc."""

    @abstractmethod
    def corner(self, b: int, a: int, c: int) -> str:
        """The angle at a, between the directions to b and to c."""

    @abstractmethod
    def dot(self, a: int, b: int, c: int) -> str:
        """(b − a) · (c − a)."""


class _Geometric(_Stencil):
    def length(self, a: int, b: int) -> str:
        a, b = sorted((a, b))
        return self.define(f"l{a}_{b}", f"distance(p{a},p{b})")

    def corner(self, b: int, a: int, c: int) -> str:
        b, c = sorted((b, c))
        return self.define(f"t{b}_{a}_{c}", f"angle(p{b},p{a},p{c})")

    def turning(self, c: int, a: int, b: int, d: int) -> str:
        # The dihedral is ±pi where the surface is flat. Half of a turn off either branch leaves
        # one smooth function, exact to the last bits because OpenMM's angle is.
        name = self.define(f"o{a}_{b}", f"dihedral(p{c},p{a},p{b},p{d})")
        return self.define(f"f{a}_{b}", f"{name}-{PI}*(2*step({name})-1)")

    def double_area(self, a: int, b: int, c: int) -> str:
        sides = f"{self.length(a, b)}*{self.length(a, c)}"
        return self.define(f"n{a}_{b}_{c}", f"{sides}*sin({self.corner(b, a, c)})")

    def cotangent(self, b: int, a: int, c: int) -> str:
        angle = self.corner(b, a, c)
        return self.define(f"c{a}_{min(b, c)}_{max(b, c)}", f"cos({angle})/sin({angle})")

    def dot(self, a: int, b: int, c: int) -> str:
        # By lengths rather than by the angle: opposite neighbours of a vertex are nearly in line
        # with it, and there the angle's own derivative diverges.
        if b == c:
            return self.length2(a, b)
        b, c = sorted((b, c))
        sides = f"{self.length2(a, b)}+{self.length2(a, c)}-{self.length2(b, c)}"
        return self.define(f"d{a}_{b}_{c}", f"0.5*({sides})")

    def height_above(self, a: int, b: int, c: int, d: int) -> str:
        """Height of d above the plane of triangle abc, positive on the side of its normal."""
        # Around edge bc, because d, b, c are never in line where a and d are neighbours of b.
        tilt = self.define(f"g{a}_{b}_{c}_{d}", f"dihedral(p{a},p{b},p{c},p{d})")
        arm = f"{self.length(b, d)}*sin({self.corner(d, b, c)})"
        return self.define(f"h{a}_{b}_{c}_{d}", f"{arm}*sin({tilt})")


class _Cartesian(_Stencil):
    def difference(self, axis: str, a: int, b: int) -> str:
        """The component of b − a."""
        return f"({axis}{b}-{axis}{a})"

    def dot(self, a: int, b: int, c: int) -> str:
        if b == c:
            return self.length2(a, b)
        b, c = sorted((b, c))
        terms = [self.difference(x, a, b) + "*" + self.difference(x, a, c) for x in "xyz"]
        return self.define(f"d{a}_{b}_{c}", _sum(terms))

    def length2(self, a: int, b: int) -> str:
        a, b = sorted((a, b))
        terms = [self.difference(x, a, b) + "^2" for x in "xyz"]
        return self.define(f"q{a}_{b}", _sum(terms))

    def length(self, a: int, b: int) -> str:
        return self.define(f"l{min(a, b)}_{max(a, b)}", f"sqrt({self.length2(a, b)})")

    def normal(self, a: int, b: int, c: int) -> list[str]:
        """(b − a) × (c − a), by component."""
        components = []
        for x, y, z in ("xyz", "yzx", "zxy"):
            first = f"{self.difference(y, a, b)}*{self.difference(z, a, c)}"
            second = f"{self.difference(z, a, b)}*{self.difference(y, a, c)}"
            components.append(self.define(f"n{x}{a}_{b}_{c}", f"{first}-{second}"))
        return components

    def double_area2(self, a: int, b: int, c: int) -> str:
        product = f"{self.length2(a, b)}*{self.length2(a, c)}-{self.dot(a, b, c)}^2"
        return self.define(f"m{a}_{b}_{c}", product)

    def double_area(self, a: int, b: int, c: int) -> str:
        return self.define(f"n{a}_{b}_{c}", f"sqrt({self.double_area2(a, b, c)})")

    def corner(self, b: int, a: int, c: int) -> str:
        angle = f"atan2({self.double_area(a, b, c)},{self.dot(a, b, c)})"
        return self.define(f"t{b}_{a}_{c}", angle)

    def determinant(self, a: int, b: int, c: int, d: int) -> str:
        """(b − a) · [(c − a) × (d − a)]."""
        terms = []
        for x, y, z in ("xyz", "yzx", "zxy"):
            first = f"{self.difference(y, a, c)}*{self.difference(z, a, d)}"
            second = f"{self.difference(z, a, c)}*{self.difference(y, a, d)}"
            terms.append(f"{self.difference(x, a, b)}*({first}-{second})")
        return self.define(f"v{a}_{b}_{c}_{d}", _sum(terms))

    def turning(self, c: int, a: int, b: int, d: int) -> str:
        # With u, v, w the directions from a to d, b, c, the normals are u × v and v × w. Their
        # cross product is v det(u, v, w), their dot product (u·v)(v·w) − (u·w)(v·v).
        sine = f"{self.length(a, b)}*{self.determinant(a, d, b, c)}"
        cosine = f"{self.dot(a, d, b)}*{self.dot(a, b, c)}-{self.dot(a, d, c)}*{self.length2(a, b)}"
        return self.define(f"f{a}_{b}", f"-atan2({sine},{cosine})")


def _stencil(style: str) -> _Stencil:
    if style == "geometric":
        return _Geometric()
    if style == "cartesian":
        return _Cartesian()
    raise ValueError(f"style {style!r} is neither of {STYLES}")


def _compound(expression: str, bonds, parameters=(), values=None) -> mm.CustomCompoundBondForce:
    """One CustomCompoundBondForce; row i of `values` holds the parameters of bond i."""
    force = mm.CustomCompoundBondForce(len(bonds[0]), expression)
    for name in parameters:
        force.addPerBondParameter(name)
    for number, particles in enumerate(bonds):
        row = [] if values is None else [float(value) for value in values[number]]
        force.addBond([int(particle) for particle in particles], row)
    return force


def _tuples(triangles) -> list[tuple[int, int, int]]:
    return [tuple(row) for row in np.asarray(triangles, dtype=int).tolist()]


# --- global area and volume --------------------------------------------------------------------


def _area_sum(triangles, style: str) -> mm.CustomCompoundBondForce:
    stencil = _stencil(style)
    return _compound(stencil.expression(f"0.5*{stencil.double_area(1, 2, 3)}"), _tuples(triangles))


def _volume_sum(triangles, style: str) -> mm.CustomCompoundBondForce:
    """Each triangle's cone to a vertex of the surface: any apex gives the same sum."""
    rows = _tuples(triangles)
    stencil = _stencil(style)
    # An apex for each connected part, and none outside: far away, the cones would cancel badly.
    root = {vertex: vertex for row in rows for vertex in row}

    def find(vertex: int) -> int:
        while root[vertex] != vertex:
            root[vertex] = root[root[vertex]]
            vertex = root[vertex]
        return vertex

    for a, b, c in rows:
        first, *others = sorted({find(a), find(b), find(c)})
        for other in others:
            root[other] = first
    cones = [(a, b, c, find(a)) for a, b, c in rows if find(a) not in (a, b, c)]
    if isinstance(stencil, _Geometric):
        height = f"{stencil.double_area(1, 2, 3)}*{stencil.height_above(1, 2, 3, 4)}"
        # An outward normal has the apex below it.
        return _compound(stencil.expression(f"-{height}/6"), cones)
    return _compound(stencil.expression(f"{stencil.determinant(4, 1, 2, 3)}/6"), cones)


def _volume_sum_about_origin(triangles) -> mm.CustomCompoundBondForce:
    """The shortest expression, as most people would write it; it needs no fourth particle."""
    expression = "(x1*(y2*z3-z2*y3)+y1*(z2*x3-x2*z3)+z1*(x2*y3-y2*x3))/6"
    return _compound(expression, _tuples(triangles))


def global_area(triangles, modulus: float, target: float, style: str) -> list[mm.Force]:
    """½ k (A − A0)² / A0 (paper, eq. 1)."""
    force = mm.CustomCVForce(f"{_number(0.5 * modulus / target)}*(total-{_number(target)})^2")
    force.addCollectiveVariable("total", _area_sum(triangles, style))
    return [force]


def global_volume(triangles, modulus: float, target: float, style: str) -> list[mm.Force]:
    """½ k (V − V0)² / V0 (paper, eq. 2)."""
    force = mm.CustomCVForce(f"{_number(0.5 * modulus / target)}*(total-{_number(target)})^2")
    force.addCollectiveVariable("total", _volume_sum(triangles, style))
    return [force]


def pressure(triangles, pressure: float, style: str) -> list[mm.Force]:
    """−p V."""
    force = mm.CustomCVForce(f"{_number(-pressure)}*total")
    force.addCollectiveVariable("total", _volume_sum(triangles, style))
    return [force]


def surface_tension(triangles, tension: float, style: str) -> list[mm.Force]:
    """σ A."""
    force = mm.CustomCVForce(f"{_number(tension)}*total")
    force.addCollectiveVariable("total", _area_sum(triangles, style))
    return [force]


def osmotic_pressure(
    triangles,
    solutes: float,
    concentration: float,
    thermalEnergy: float,  # noqa: N803
    style: str,
) -> list[mm.Force]:
    """n kT (x − 1 − ln x) with x = c V / n."""
    x = f"x={_number(concentration / solutes)}*total"
    force = mm.CustomCVForce(f"{_number(solutes * thermalEnergy)}*(x-1-log(x)); {x}")
    force.addCollectiveVariable("total", _volume_sum(triangles, style))
    return [force]


def area_difference(triangles, modulus: float, target: float, style: str) -> list[mm.Force]:
    """½ m (M − M0)² with M = Σ l φ / 2."""
    stencil = _stencil(style)
    share = f"0.5*{stencil.length(2, 3)}*{stencil.turning(1, 2, 3, 4)}"
    force = mm.CustomCVForce(f"{_number(0.5 * modulus)}*(total-{_number(target)})^2")
    total = _compound(stencil.expression(share), edges_with_wings(triangles))
    force.addCollectiveVariable("total", total)
    return [force]


# --- triangles ---------------------------------------------------------------------------------


def triangle_heights(triangles, min_height: float, epsilon: float, style: str) -> list[mm.Force]:
    """Σ ε [(d/h)⁸ − (d/h)⁴ + ¼] over heights h < 2^¼ d, which is ε max((d/h)⁴ − ½, 0)²."""
    stencil = _stencil(style)
    terms = []
    if isinstance(stencil, _Geometric):
        for number, (a, b, c) in enumerate(((1, 2, 3), (2, 3, 1), (3, 1, 2))):
            height = stencil.define(
                f"h{number}", f"{stencil.length(a, b)}*sin({stencil.corner(a, b, c)})"
            )
            terms.append(f"max(({_number(min_height)}/{height})^4-0.5,0)^2")
    else:
        double_area2 = stencil.double_area2(1, 2, 3)
        inverse = stencil.define("i", f"{_number(min_height**2)}/({double_area2})")
        for a, b in ((1, 2), (2, 3), (3, 1)):
            terms.append(f"max(({inverse}*{stencil.length2(a, b)})^2-0.5,0)^2")
    energy = f"{_number(epsilon)}*({'+'.join(terms)})"
    return [_compound(stencil.expression(energy), _tuples(triangles))]


def triangle_area(triangles, modulus: float, target: Values, style: str) -> list[mm.Force]:
    """Σ_t ½ k (a_t − a0)² / a0, one target for all triangles or one for each."""
    stencil = _stencil(style)
    targets = np.broadcast_to(np.asarray(target, dtype=float), (len(triangles),))
    area = stencil.double_area(1, 2, 3)
    energy = f"{_number(0.5 * modulus)}*(0.5*{area}-target)^2/target"
    return [_compound(stencil.expression(energy), _tuples(triangles), ["target"], targets[:, None])]


def triangle_area_repulsion(
    triangles, min_area: float, epsilon: float, style: str
) -> list[mm.Force]:
    """Σ_t ε [(m/a)⁸ − (m/a)⁴ + ¼] over areas a < 2^¼ m, which is ε max((m/a)⁴ − ½, 0)²."""
    stencil = _stencil(style)
    ratio = f"({_number(2 * min_area)}/{stencil.double_area(1, 2, 3)})"
    energy = f"{_number(epsilon)}*max({ratio}^4-0.5,0)^2"
    return [_compound(stencil.expression(energy), _tuples(triangles))]


# --- dihedrals ---------------------------------------------------------------------------------

# u stands for 1 − cos f, f for φ − φ₀ in (−π, π], K for the stiffness.
DIHEDRAL_FORMS = {
    "Quartic": "K*u^2",
    "Cosine": "K*u",
    "Exp": "0.5*K*(exp(2*u)-1)",
    "SmoothExp": "0.04*K*(exp(10*u)-1)",
    "SmoothExp46": "0.5*K*(exp(2*u)-1-f^2)",
}


def dihedral(
    triangles, stiffness: Values, form: str, style: str, rest: Values = 0.0
) -> list[mm.Force]:
    """A function of each edge's φ − φ₀; the forms are in DIHEDRAL_FORMS.

    Stiffness and angle at rest are one for all, or one for each edge that is no border.
    """
    stencil = _stencil(style)
    turning = stencil.turning(1, 2, 3, 4)
    bonds = edges_with_wings(triangles)
    values = [np.broadcast_to(np.asarray(v, float), (len(bonds),)) for v in (stiffness, rest)]
    turned = stencil.define("turned", f"{turning}-rest")
    around = f"{turned}-{2 * np.pi}*(step({turned}-{PI})-step(-{PI}-{turned}))"
    angle = stencil.define("f", around if np.any(rest) else turned)
    # Half-angle, because 1 − cos x itself cancels where the surface is nearly at rest.
    stencil.define("u", f"2*sin(0.5*{angle})^2")
    expression = stencil.expression(DIHEDRAL_FORMS[form])
    return [_compound(expression, bonds, ["K", "rest"], np.stack(values, axis=1))]


# --- bending -----------------------------------------------------------------------------------


class _VertexTerms:
    """The sums over the ring of vertex 1; its neighbours are points 2 … degree + 1.

    If `open`, no triangle has the last and the first of them; that is for areas only.
    """

    def __init__(self, degree: int, style: str, open: bool = False) -> None:
        self.stencil = _stencil(style)
        self.ring = list(range(2, degree + 2))
        # (left wing, neighbour, right wing) and (neighbour, next neighbour)
        self.spokes = list(
            zip(
                self.ring[1:] + self.ring[:1],
                self.ring,
                self.ring[-1:] + self.ring[:-1],
                strict=True,
            )
        )
        self.fan = list(zip(self.ring, self.ring[1:] + self.ring[:1], strict=True))
        if open:
            self.fan.pop()

    def barycentric_area(self) -> str:
        areas = [self.stencil.double_area(1, b, c) for b, c in self.fan]
        return self.stencil.define("aB", f"{_sum(areas)}/6")

    def _weight(self, left: int, spoke: int, right: int) -> str:
        """cot θ1 + cot θ2 of the angles opposite the edge to `spoke`, for the geometric style."""
        s = self.stencil
        cotangents = [s.cotangent(1, left, spoke), s.cotangent(1, right, spoke)]
        return s.define(f"w{spoke}", _sum(cotangents))

    def voronoi_area(self) -> str:
        s = self.stencil
        if isinstance(s, _Geometric):
            terms = [f"{s.length2(1, k[1])}*{self._weight(*k)}" for k in self.spokes]
            return s.define("aV", f"{_sum(terms)}/8")
        # Triangle by triangle, with u and v its two sides at the vertex: the cotangents are
        # (v·v − u·v) / |u × v| opposite u and (u·u − u·v) / |u × v| opposite v.
        terms = []
        for b, c in self.fan:
            uu, vv, uv = s.length2(1, b), s.length2(1, c), s.dot(1, b, c)
            terms.append(f"({uu}*{vv}-0.5*{uv}*({uu}+{vv}))/{s.double_area(1, b, c)}")
        return s.define("aV", f"{_sum(terms)}/4")

    def integrated_curvature(self) -> str:
        s = self.stencil
        terms = [
            f"{s.length(1, spoke)}*{s.turning(left, 1, spoke, right)}"
            for left, spoke, right in self.spokes
        ]
        return s.define("J", f"0.5*{_sum(terms)}")

    def _curvature_vector(self) -> list[str]:
        """S by component, for the cartesian style.

        S is the gradient of the area with respect to the vertex, and what a triangle adds to it is
        half of its unit normal turned against its outer edge: a shorter sum than by cotangents.
        """
        s = self.stencil
        components = []
        for x, y, z in ("xyz", "yzx", "zxy"):
            terms = []
            for b, c in self.fan:
                normal = dict(zip("xyz", s.normal(1, b, c), strict=True))
                first = f"{normal[y]}*{s.difference(z, b, c)}"
                second = f"{normal[z]}*{s.difference(y, b, c)}"
                terms.append(f"({first}-{second})/{s.double_area(1, b, c)}")
            components.append(s.define(f"S{x}", f"0.5*{_sum(terms)}"))
        return components

    def curvature_vector_squared(self) -> str:
        s = self.stencil
        if isinstance(s, _Cartesian):
            return s.define("SS", _sum([f"{x}^2" for x in self._curvature_vector()]))
        terms = [f"{self._weight(*k)}^2*{s.length2(1, k[1])}" for k in self.spokes]
        for j, k in combinations(self.spokes, 2):
            terms.append(f"2*{self._weight(*j)}*{self._weight(*k)}*{s.dot(1, j[1], k[1])}")
        return s.define("SS", f"0.25*{_sum(terms)}")

    def _along_normal(self, name: str, vector: list[str], weights: list[str]) -> str:
        """n·v, n the mean of the triangles' normals weighted by their angles at the vertex.

        v comes by component for the cartesian style, as half the weighted sum of r_i − r_j over
        the neighbours for the geometric style.
        """
        s = self.stencil
        if isinstance(s, _Cartesian):
            components = [[], [], []]
            for b, c in self.fan:
                weight = s.define(f"r{b}", f"{s.corner(b, 1, c)}/{s.double_area(1, b, c)}")
                for terms, normal in zip(components, s.normal(1, b, c), strict=True):
                    terms.append(f"{weight}*{normal}")
            sums = [
                s.define(f"N{x}", _sum(terms)) for x, terms in zip("xyz", components, strict=True)
            ]
            projection = _sum([f"{n}*{c}" for n, c in zip(sums, vector, strict=True)])
            return s.define(name, f"{projection}/sqrt({_sum([f'{n}^2' for n in sums])})")
        # Without components: v·n_t needs each neighbour's height above triangle t, and |Σ θ n|
        # the products of normals, (u × v)·(w × z) = (u·w)(v·z) − (u·z)(v·w).
        projections, products = [], []
        for b, c in self.fan:
            heights = [
                f"{weight}*{s.height_above(1, b, c, k)}"
                for k, weight in zip(self.ring, weights, strict=True)
                if k not in (b, c)
            ]
            projections.append(f"-0.5*{s.corner(b, 1, c)}*{_sum(heights)}")
            products.append(f"{s.corner(b, 1, c)}^2")
        for (b, c), (d, e) in combinations(self.fan, 2):
            gram = f"({s.dot(1, b, d)})*({s.dot(1, c, e)})-({s.dot(1, b, e)})*({s.dot(1, c, d)})"
            angles = f"{s.corner(b, 1, c)}*{s.corner(d, 1, e)}"
            areas = f"({s.double_area(1, b, c)}*{s.double_area(1, d, e)})"
            products.append(f"2*{angles}*({gram})/{areas}")
        return s.define(name, f"{_sum(projections)}/sqrt({_sum(products)})")

    def curvature_along_normal(self) -> str:
        """n·S."""
        if isinstance(self.stencil, _Cartesian):
            return self._along_normal("nS", self._curvature_vector(), [])
        return self._along_normal("nS", [], [self._weight(*k) for k in self.spokes])

    def neighbour_sum_along_normal(self) -> str:
        """n·Σ_j (r_i − r_j)."""
        s = self.stencil
        vector = []
        if isinstance(s, _Cartesian):
            vector = [_sum([s.difference(x, j, 1) for j in self.ring]) for x in "xyz"]
        return self._along_normal("nE", vector, ["2"] * len(self.ring))

    def neighbour_sum_squared(self) -> str:
        """|Σ_j (r_j − r_i)|²."""
        s = self.stencil
        if isinstance(s, _Cartesian):
            sums = [_sum([s.difference(x, 1, j) for j in self.ring]) for x in "xyz"]
            return s.define("E2", _sum([f"({x})^2" for x in sums]))
        terms = [s.length2(1, j) for j in self.ring]
        terms += [f"2*{s.dot(1, j, k)}" for j, k in combinations(self.ring, 2)]
        return s.define("E2", _sum(terms))


# What each scheme adds up over the vertices: K is the rigidity, C the spontaneous curvature. The
# Jülicher schemes complete the square. The others do not, and their three parts are forces apart,
# because each is then short enough for OpenMM to differentiate in reasonable time.
_Write = Callable[[_VertexTerms], str]


def _square(area: _Write) -> dict[str, _Write]:
    return {
        "quadratic": lambda v: f"0.5*K*({v.integrated_curvature()}-C*{area(v)})^2/{area(v)}",
    }


def _itzykson(area: _Write) -> dict[str, _Write]:
    return {
        "quadratic": lambda v: f"0.5*K*{v.curvature_vector_squared()}/{area(v)}",
        "linear": lambda v: f"-K*C*{v.curvature_along_normal()}",
        "linear unsigned": lambda v: f"-K*C*sqrt({v.curvature_vector_squared()})",
        "constant": lambda v: f"0.5*K*C^2*{area(v)}",
    }


BENDING_SCHEMES: dict[str, dict[str, _Write]] = {
    "Julicher": _square(_VertexTerms.barycentric_area),
    "JulicherVoronoi": _square(_VertexTerms.voronoi_area),
    "GompperKroll": _itzykson(_VertexTerms.voronoi_area),
    "GompperKrollBarycentric": _itzykson(_VertexTerms.barycentric_area),
    # As Gompper–Kroll's with Σ_j (r_i − r_j) / √3, which is S if all triangles are equilateral.
    "Espriu": {
        "quadratic": lambda v: f"K*{v.neighbour_sum_squared()}/(6*{v.barycentric_area()})",
        "linear": lambda v: f"-K*C*{v.neighbour_sum_along_normal()}/sqrt(3)",
        "linear unsigned": lambda v: f"-K*C*sqrt({v.neighbour_sum_squared()}/3)",
        "constant": lambda v: f"0.5*K*C^2*{v.barycentric_area()}",
    },
}


def bending_parts(scheme: str, curved: bool, unsigned: bool = False) -> list[str]:
    """The parts of a scheme's energy, of which only one is there without spontaneous curvature."""
    if not curved or "linear" not in BENDING_SCHEMES[scheme]:
        return ["quadratic"]
    return ["quadratic", "linear unsigned" if unsigned else "linear", "constant"]


def bending(
    triangles,
    rigidity: Values,
    spontaneous_curvature: Values = 0.0,
    scheme: str = "Julicher",
    style: str = "cartesian",
    unsigned: bool = False,
    parts: Sequence[str] | None = None,
) -> list[mm.Force]:
    """One of the five bending energies, a force for each part and number of neighbours.

    Rigidity and spontaneous curvature may be given for each vertex, in ascending order of particle
    index; they are then the parameters K and C of each bond. `unsigned` is VCM's |S| in place of
    n·S. Vertices on borders have no bending energy.
    """
    ring_of, left_out = rings(triangles), on_borders(triangles)
    vertices = list(ring_of)
    if parts is None:
        curved = bool(np.any(np.asarray(spontaneous_curvature) != 0))
        parts = bending_parts(scheme, curved, unsigned)

    literals, columns = {}, {}
    for name, given in (("K", rigidity), ("C", spontaneous_curvature)):
        if np.ndim(given) == 0:
            literals[name] = _number(given)
        elif len(given) == len(vertices):
            columns[name] = np.asarray(given, dtype=float)
        else:
            raise ValueError(f"{len(given)} values for {len(vertices)} vertices")

    forces: list[mm.Force] = []
    for degree in sorted({len(ring) for vertex, ring in ring_of.items() if vertex not in left_out}):
        rows = [
            row
            for row, vertex in enumerate(vertices)
            if len(ring_of[vertex]) == degree and vertex not in left_out
        ]
        bonds = [[vertices[row], *ring_of[vertices[row]]] for row in rows]
        values = np.stack([v[rows] for v in columns.values()], axis=1) if columns else None
        for part in parts:
            terms = _VertexTerms(degree, style)
            energy = BENDING_SCHEMES[scheme][part](terms)
            for name, literal in literals.items():
                terms.stencil.define(name, literal)
            forces.append(_compound(terms.stencil.expression(energy), bonds, list(columns), values))
    return forces


def plaquette_area(triangles, stiffness: float, target: float, style: str) -> list[mm.Force]:
    """½ k Σ_i (N a_i / A0 − 1)² with the barycentric areas of all N vertices (paper, eq. 20)."""
    ring_of, borders = rings(triangles), on_borders(triangles)
    kinds = {vertex: (len(ring), vertex in borders) for vertex, ring in ring_of.items()}
    forces: list[mm.Force] = []
    for kind in sorted(set(kinds.values())):
        terms = _VertexTerms(kind[0], style, kind[1])
        share = f"{_number(len(ring_of) / target)}*{terms.barycentric_area()}"
        energy = terms.stencil.expression(f"{_number(0.5 * stiffness)}*({share}-1)^2")
        bonds = [[vertex, *ring] for vertex, ring in ring_of.items() if kinds[vertex] == kind]
        forces.append(_compound(energy, bonds))
    return forces


# --- borders -----------------------------------------------------------------------------------


def edge_tension(triangles, tension: float, style: str) -> list[mm.Force]:
    """γ times the length of all borders."""
    rows = _tuples(triangles)
    sides = {side for a, b, c in rows for side in ((a, b), (b, c), (c, a))}
    bonds = sorted((a, b) for a, b in sides if (b, a) not in sides)
    stencil = _stencil(style)
    energy = f"{_number(tension)}*{stencil.length(1, 2)}"
    return [_compound(stencil.expression(energy), bonds)] if bonds else []


def gaussian_curvature(triangles, modulus: Values, style: str) -> list[mm.Force]:
    """κ_G Σ (2π − Σ θ) over the vertices on no border, where it is defined: a bond each corner.

    The modulus may be one for each vertex, ascending.
    """
    left_out, ring_of = on_borders(triangles), rings(triangles)
    moduli = dict(zip(ring_of, np.broadcast_to(modulus, len(ring_of)).tolist(), strict=True))
    bonds, shares = [], []
    for a, b, c in _tuples(triangles):
        for corner in ((a, b, c), (b, c, a), (c, a, b)):
            if corner[0] not in left_out:
                bonds.append(corner)
                shares.append([moduli[corner[0]], 2 * np.pi / len(ring_of[corner[0]])])
    stencil = _stencil(style)
    energy = f"modulus*(share-{stencil.corner(2, 1, 3)})"
    names = ["modulus", "share"]
    return [_compound(stencil.expression(energy), bonds, names, shares)] if bonds else []


# --- against a reference -------------------------------------------------------------------------


def _strained(triangles, at_rest, style: str, density: str) -> list[mm.Force]:
    """A density of energy in the reference, of I1, I2 and J; `at_rest` places each particle."""
    a, b, c = (at_rest[column] for column in np.asarray(triangles).T)
    ab, bc, ca = (np.asarray(side) for side in (b - a, c - b, a - c))
    dots = [-np.sum(one * other, axis=1) for one, other in ((ca, ab), (ab, bc), (bc, ca))]
    normal = np.linalg.norm(np.cross(ab, ca), axis=1)
    weights = [dots[2] / normal**2, dots[0] / normal**2, dots[1] / normal**2]
    stencil = _stencil(style)
    squares = [stencil.length2(1, 2), stencil.length2(2, 3), stencil.length2(1, 3)]
    double_area = stencil.double_area(1, 2, 3)
    stencil.define("J", f"{double_area}/n0")
    stencil.define("I2", "J^2-1")
    products = [
        f"{weight}*{square}" for weight, square in zip(("wa", "wb", "wc"), squares, strict=True)
    ]
    stencil.define("I1", f"{_sum(products)}-2")
    rows = np.stack([*weights, normal], axis=1)
    energy = stencil.expression(f"0.5*n0*({density})")
    return [_compound(energy, _tuples(triangles), ["wa", "wb", "wc", "n0"], rows)]


def skalak(triangles, shear: float, area: float, at_rest, style: str) -> list[mm.Force]:
    """A0 [μ/4 (½ I1² + I1 − I2) + K/8 I2²] (doi:10.1016/S0006-3495(73)85983-1)."""
    mu, k = _number(shear / 4), _number(area / 8)
    return _strained(triangles, at_rest, style, f"{mu}*(0.5*I1^2+I1-I2)+{k}*I2^2")


def neo_hookean(triangles, shear: float, area: float, at_rest, style: str) -> list[mm.Force]:
    """A0 [μ/2 (l1/l2 + l2/l1 − 2) + ½ K (J − 1)²]."""
    mu, k = _number(shear / 2), _number(area / 2)
    return _strained(triangles, at_rest, style, f"{mu}*((I1+2)/J-2)+{k}*(J-1)^2")


def linear_elastic(triangles, shear: float, area: float, at_rest, style: str) -> list[mm.Force]:
    """A0 [½ K (tr e)² + ½ μ ((tr e)² − 4 det e)], with Green's strain e."""
    mu, k = _number(shear / 2), _number(area / 8)
    return _strained(triangles, at_rest, style, f"{k}*I1^2+{mu}*(0.25*I1^2+I1-I2)")


def spring(
    triangles, stiffness: float, at_rest, ratio: float, form: str, style: str
) -> list[mm.Force]:
    """Springs along the edges, with rest lengths by the positions of all particles at rest."""
    rows = _tuples(triangles)
    bonds = sorted({tuple(sorted(side)) for a, b, c in rows for side in ((a, b), (b, c), (c, a))})
    start, end = (at_rest[list(column)] for column in zip(*bonds, strict=True))
    lengths = np.linalg.norm(np.asarray(end - start), axis=1)
    stencil = _stencil(style)
    length = stencil.length(1, 2)
    if form == "Harmonic":
        energy = f"{_number(stiffness / 2)}*({length}-l0)^2"
    else:
        slope = 1 / (1 - ratio) ** 2 - 1 + 4 * ratio
        strength = 1 / ratio**2 / (2 / (1 - ratio) ** 3 + 4 + 2 * slope / ratio)
        stencil.define("x", f"{_number(ratio)}*{length}/l0")
        worm = f"{_number(strength)}*((3*x^2-2*x^3)/(1-x)-rest)"
        power = f"{_number(strength * slope * ratio)}*(l0/{length}-1)"
        rest = (3 * ratio**2 - 2 * ratio**3) / (1 - ratio)
        energy = f"{_number(stiffness)}*l0^2*({worm}+{power})".replace("rest", _number(rest))
    return [_compound(stencil.expression(energy), bonds, ["l0"], lengths[:, None])]


def line_tension(triangles, tension: float, kind, style: str) -> list[mm.Force]:
    """Half of the sides opposite odd corners, a third of the medians; `kind` of each particle."""
    pairs, triples = [], []
    for a, b, c in _tuples(triangles):
        same = [(p, q) for p, q in ((a, b), (b, c), (c, a)) if kind[p] == kind[q]]
        pairs += same if len(same) == 1 else []
        triples += [] if same else [(a, b, c), (b, c, a), (c, a, b)]
    forces = []
    if pairs:
        stencil = _stencil(style)
        forces.append(
            _compound(stencil.expression(f"{_number(tension / 2)}*{stencil.length(1, 2)}"), pairs)
        )
    if triples:
        stencil = _stencil(style)
        squares = f"2*{stencil.length2(1, 2)}+2*{stencil.length2(1, 3)}-{stencil.length2(2, 3)}"
        forces.append(
            _compound(stencil.expression(f"{_number(tension / 6)}*sqrt({squares})"), triples)
        )
    return forces


# --- the whole vesicle, for races --------------------------------------------------------------


def fastest(
    triangles,
    *,
    rigidity: float,
    area_modulus: float,
    area_target: float,
    volume_modulus: float,
    volume_target: float,
    min_height: float,
    epsilon: float,
    style: str,
) -> list[mm.Force]:
    """Jülicher (C0 = 0), area, volume and heights by the cheapest expressions that we know.

    What a patient user would write: one CustomCVForce for both constraints, so that there is one
    inner Context, nothing multiplied by a curvature that is zero, and the volume about the origin.
    """
    constraint = mm.CustomCVForce(
        f"{_number(0.5 * area_modulus / area_target)}*(A-{_number(area_target)})^2"
        f"+{_number(0.5 * volume_modulus / volume_target)}*(V-{_number(volume_target)})^2"
    )
    constraint.addCollectiveVariable("A", _area_sum(triangles, style))
    cartesian = style == "cartesian"
    volume = _volume_sum_about_origin(triangles) if cartesian else _volume_sum(triangles, style)
    constraint.addCollectiveVariable("V", volume)

    curvature = []
    ring_of = rings(triangles)
    for degree in sorted({len(ring) for ring in ring_of.values()}):
        terms = _VertexTerms(degree, style)
        square = f"{terms.integrated_curvature()}^2/{terms.barycentric_area()}"
        bonds = [[vertex, *ring] for vertex, ring in ring_of.items() if len(ring) == degree]
        energy = terms.stencil.expression(f"{_number(0.5 * rigidity)}*{square}")
        curvature.append(_compound(energy, bonds))
    return [constraint, *curvature, *triangle_heights(triangles, min_height, epsilon, style)]
