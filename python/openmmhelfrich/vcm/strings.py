"""The forces of this package written as Custom forces of OpenMM, in the way of string-built codes.

They are the other side of a comparison: the same energies, but from expressions that OpenMM parses,
differentiates and interprets, bond by bond. Bending energies are one CustomCompoundBondForce for
each number of neighbours; global area and volume are a CustomCVForce of a sum over triangles
(``"sums"``, O(N)) or forces over all pairs of triangles (``"pairs"``, O(N²), as the Virtual Cell
Model has them).

Lengths and angles are written with OpenMM's ``distance``, ``angle`` and ``dihedral``, which its
differentiation takes as they are: written out in coordinates, the longer energies take it minutes.
"""

from __future__ import annotations

from collections import defaultdict
from math import pi

import numpy as np
import openmm as mm

from .. import forces as our_forces
from .._types import Array

__all__ = ["STYLES", "custom_forces", "custom_system", "is_ours"]

#: How global area and volume can be written.
STYLES = ("sums", "pairs")
_SCHEMES = ("Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi", "Espriu")
_DIHEDRALS = (
    "K*u^2",
    "K*u",
    "0.5*K*(exp(2*u)-1)",
    "0.04*K*(exp(10*u)-1)",
    "0.5*K*(exp(2*u)-1-phi^2)",
)


def custom_system(system: mm.System, style: str = "sums") -> mm.System:
    """A System with Custom forces in place of ours; the other forces are copied.

    Parameters
    ----------
    system : openmm.System
        Is not changed. Constraints and virtual sites are kept.
    style : str
        One of `STYLES`.
    """
    result = mm.XmlSerializer.clone(system)
    for index in reversed(range(system.getNumForces())):
        force = system.getForce(index)
        if is_ours(force):
            for custom in custom_forces(force, style):
                custom.setForceGroup(force.getForceGroup())
                custom.setName(force.getName())
                result.addForce(custom)
            result.removeForce(index)
    return result


def is_ours(force: mm.Force) -> bool:
    """Whether a force is one of this package that can be written with strings."""
    return any(getattr(our_forces, name).isinstance(force) for name in _MAKERS)


def custom_forces(force: mm.Force, style: str = "sums") -> list[mm.Force]:
    """Custom forces with the energy of one of ours.

    Parameters
    ----------
    force : openmm.Force
        Of this package. Parameters of the Context become numbers.
    style : str
        One of `STYLES`.

    Returns
    -------
    list of openmm.Force
        Whose energies add up to that of `force`, in force group 0.

    Raises
    ------
    ValueError
        If the force or the style is none of ours.
    """
    if style not in STYLES:
        raise ValueError(f"custom_forces: style must be one of {STYLES}, got {style!r}")
    for name, make in _MAKERS.items():
        cls = getattr(our_forces, name)
        if cls.isinstance(force):
            ours = cls.cast(force)
            triangles = np.array([ours.getTriangle(i) for i in range(ours.getNumTriangles())])
            return make(ours, triangles, style)
    raise ValueError(f"custom_forces: no expression is known for {force.getName()!r}")


def _compound(expression: str, bonds, names=(), values=None) -> mm.CustomCompoundBondForce:
    result = mm.CustomCompoundBondForce(len(bonds[0]), expression)
    for name in names:
        result.addPerBondParameter(name)
    for number, particles in enumerate(np.asarray(bonds).tolist()):
        result.addBond(particles, [] if values is None else [float(v) for v in values[number]])
    return result


def _constants(**values: float) -> str:
    """Definitions of numbers, to the last bit."""
    return "".join(f"; {name}={value!r}" for name, value in values.items())


# --- global area and volume --------------------------------------------------------------------


def _area(a: int, b: int, c: int) -> str:
    return f"0.5*distance(p{a},p{b})*distance(p{a},p{c})*sin(angle(p{b},p{a},p{c}))"


def _volume(a: int, b: int, c: int) -> str:
    """Of the tetrahedron of a triangle and the origin."""
    terms = [
        f"x{i}*(y{j}*z{k}-z{j}*y{k})" for i, j, k in ((a, b, c), (b, c, a), (c, a, b))
    ]  # fmt: skip
    return f"({'+'.join(terms)})/6"


def _constraint(measure, ours, triangles: Array, style: str) -> list[mm.Force]:
    """½ k (Σ q − q0)²/q0."""
    constants = _constants(k=ours.getModulus(), target=ours.getTarget())
    if style == "sums":
        result = mm.CustomCVForce(f"0.5*k*(total-target)^2/target{constants}")
        result.addCollectiveVariable("total", _compound(measure(1, 2, 3), triangles))
        return [result]
    # (Σ q − q0)² = Σ [(q − q0)² − (N − 1)/N q0²] + 2 Σ over pairs of q q'.
    n = len(triangles)
    single = _compound(
        f"0.5*k*((q-target)^2-{(n - 1) / n!r}*target^2)/target; q={measure(1, 2, 3)}{constants}",
        triangles,
    )
    first, second = np.triu_indices(n, 1)
    pairs = np.concatenate([triangles[first], triangles[second]], axis=1)
    expression = f"k*q*r/target; q={measure(1, 2, 3)}; r={measure(4, 5, 6)}{constants}"
    return [single, _compound(expression, pairs)]


def _surface_area(ours, triangles: Array, style: str) -> list[mm.Force]:
    return _constraint(_area, ours, triangles, style)


def _enclosed_volume(ours, triangles: Array, style: str) -> list[mm.Force]:
    return _constraint(_volume, ours, triangles, style)


def _turning(c: int, a: int, b: int, d: int) -> str:
    """φ of edge ab of triangles abc and bad; OpenMM's dihedral is positive at concave edges."""
    torsion = f"dihedral(p{c},p{a},p{b},p{d})"
    return f"((1-2*step({torsion}))*({pi!r}-abs({torsion})))"


def _of_total(expression: str, total: mm.Force, **constants: float) -> list[mm.Force]:
    result = mm.CustomCVForce(expression + _constants(**constants))
    result.addCollectiveVariable("total", total)
    return [result]


def _pressure(ours, triangles: Array, style: str) -> list[mm.Force]:
    return _of_total("-p*total", _compound(_volume(1, 2, 3), triangles), p=ours.getPressure())


def _surface_tension(ours, triangles: Array, style: str) -> list[mm.Force]:
    return [_compound(f"s*{_area(1, 2, 3)}" + _constants(s=ours.getTension()), triangles)]


def _osmotic_pressure(ours, triangles: Array, style: str) -> list[mm.Force]:
    values = {"n": ours.getSolutes(), "c": ours.getConcentration(), "kT": ours.getThermalEnergy()}
    volume = _compound(_volume(1, 2, 3), triangles)
    return _of_total("n*kT*(x-1-log(x)); x=c*total/n", volume, **values)


def _area_difference(ours, triangles: Array, style: str) -> list[mm.Force]:
    share = f"0.5*distance(p2,p3)*{_turning(1, 2, 3, 4)}"
    values = {"m": ours.getModulus(), "target": ours.getTarget()}
    return _of_total("0.5*m*(total-target)^2", _compound(share, _wings(triangles)), **values)


# --- triangles and edges -----------------------------------------------------------------------


def _repulsion(ratios: list[str]) -> str:
    """Σ ε [r⁸ − r⁴ + ¼] where r⁴ > ½."""
    return "+".join(f"eps*(({r})^8-({r})^4+0.25)*step(({r})^4-0.5)" for r in ratios)


def _heights(ours, triangles: Array, style: str) -> list[mm.Force]:
    heights = [
        f"(distance(p{a},p{b})*sin(angle(p{a},p{b},p{c})))"
        for a, b, c in ((1, 2, 3), (2, 3, 1), (3, 1, 2))
    ]
    constants = _constants(d=ours.getMinHeight(), eps=ours.getEpsilon())
    return [_compound(_repulsion([f"d/{h}" for h in heights]) + constants, triangles)]


def _area_repulsion(ours, triangles: Array, style: str) -> list[mm.Force]:
    constants = _constants(least=ours.getMinArea(), eps=ours.getEpsilon())
    return [_compound(_repulsion([f"least/({_area(1, 2, 3)})"]) + constants, triangles)]


def _triangle_area(ours, triangles: Array, style: str) -> list[mm.Force]:
    targets = np.array(ours.getTriangleTargets() or [ours.getTarget()] * len(triangles))
    expression = f"0.5*k*({_area(1, 2, 3)}-target)^2/target"
    constants = _constants(k=ours.getModulus())
    return [_compound(expression + constants, triangles, ["target"], targets[:, None])]


def _wings(triangles: Array) -> list[tuple[int, int, int, int]]:
    """(c, a, b, d) for each edge ab of triangles abc and bad."""
    opposite = {}
    for a, b, c in triangles.tolist():
        opposite[a, b], opposite[b, c], opposite[c, a] = c, a, b
    return [(c, a, b, opposite[b, a]) for (a, b), c in sorted(opposite.items()) if a < b]


def _dihedral(ours, triangles: Array, style: str) -> list[mm.Force]:
    edges = _wings(triangles)
    # The half angle, because 1 − cos φ itself cancels where the surface is nearly flat.
    expression = _DIHEDRALS[ours.getForm()] + "; u=2*sin(0.5*phi)^2"
    values = {}
    rest, stiffness = list(ours.getEdgeRestAngle()), list(ours.getEdgeStiffness())
    if rest or ours.getRestAngle():
        # The dihedral is ±π where the surface is flat, and turns round there.
        expression += (
            f"; phi=d-2*{pi!r}*floor(0.5+d/(2*{pi!r})); d=dihedral(p1,p2,p3,p4)+{pi!r}-rest"
        )
        values["rest"] = rest or [ours.getRestAngle()] * len(edges)
    else:
        expression += f"; phi={pi!r}-abs(dihedral(p1,p2,p3,p4))"
    if stiffness:
        values["K"] = stiffness
    else:
        expression += _constants(K=ours.getStiffness())
    rows = np.array(list(values.values())).T if values else None
    return [_compound(expression, edges, list(values), rows)]


# --- bending -----------------------------------------------------------------------------------


def _rings(triangles: Array) -> dict[int, list[int]]:
    """The neighbours of each vertex, counter-clockwise."""
    following: dict[int, dict[int, int]] = defaultdict(dict)
    for a, b, c in triangles.tolist():
        following[a][b], following[b][c], following[c][a] = c, a, b
    rings = {}
    for vertex, successor in sorted(following.items()):
        ring = [next(iter(successor))]
        while successor[ring[-1]] != ring[0]:
            ring.append(successor[ring[-1]])
        rings[vertex] = ring
    return rings


class _Vertex:
    """Expressions for particle 1 and its ring, particles 2 to degree + 1."""

    def __init__(self, degree: int):
        ring = list(range(2, degree + 2))
        # (previous, neighbour, next) around the vertex
        self._spokes = list(zip(ring[-1:] + ring, ring, ring[1:] + ring[:1], strict=False))
        self._fan = [(b, c) for _, b, c in self._spokes]

    def _double_areas(self) -> list[str]:
        return [
            f"distance(p1,p{b})*distance(p1,p{c})*sin(angle(p{b},p1,p{c}))" for b, c in self._fan
        ]

    def _weights(self) -> list[str]:
        """The cotangents of the two angles opposite each spoke."""
        return [f"(cot(angle(p1,p{a},p{b}))+cot(angle(p1,p{c},p{b})))" for a, b, c in self._spokes]

    def barycentric(self) -> str:
        return f"({'+'.join(self._double_areas())})/6"

    def voronoi(self) -> str:
        parts = zip(self._spokes, self._weights(), strict=True)
        return f"({'+'.join(f'distance(p1,p{b})^2*{w}' for (_, b, _), w in parts)})/8"

    def turning(self) -> str:
        """J; the dihedral has the sign of the edge's angle, and is ±π where that is zero."""
        terms = []
        for a, b, c in self._spokes:
            torsion = f"dihedral(p{c},p1,p{b},p{a})"
            terms.append(f"distance(p1,p{b})*(2*step({torsion})-1)*({pi!r}-abs({torsion}))")
        # OpenMM's dihedral is positive here at concave edges.
        return f"-0.5*({'+'.join(terms)})"

    def cotangent_vector(self) -> list[str]:
        """S by component."""
        parts = list(zip(self._spokes, self._weights(), strict=True))
        return [
            "0.5*(" + "+".join(f"({x}1-{x}{b})*{w}" for (_, b, _), w in parts) + ")" for x in "xyz"
        ]

    def neighbour_vector(self) -> list[str]:
        """Σ (r_i − r_j) / √3 by component."""
        factor = repr(1 / np.sqrt(3).item())
        return [
            factor + "*(" + "+".join(f"({x}1-{x}{b})" for _, b, _ in self._spokes) + ")"
            for x in "xyz"
        ]

    def normal(self) -> list[str]:
        """The normals of the triangles weighted by their angles, by component, not normalised."""
        components = []
        for x, y in ("yz", "zx", "xy"):
            terms = []
            for (b, c), area in zip(self._fan, self._double_areas(), strict=True):
                cross = f"({x}{b}-{x}1)*({y}{c}-{y}1)-({y}{b}-{y}1)*({x}{c}-{x}1)"
                terms.append(f"angle(p{b},p1,p{c})/({area})*({cross})")
            components.append(f"({'+'.join(terms)})")
        return components


def _vertex_energy(degree: int, scheme: str, curved: bool, unsigned: bool) -> str:
    """½ k (c²/a − 2 C0 c + C0² a), with k and C0 by vertex."""
    v = _Vertex(degree)
    area = v.voronoi() if scheme in ("GompperKroll", "JulicherVoronoi") else v.barycentric()
    if scheme.startswith("Julicher"):
        form = "J^2/a-2*C0*J+C0^2*a" if curved else "J^2/a"
        return f"0.5*k*({form}); J={v.turning()}; a={area}"
    vector = v.neighbour_vector() if scheme == "Espriu" else v.cotangent_vector()
    components = "; ".join(f"c{x}={text}" for x, text in zip("xyz", vector, strict=True))
    square = f"s=cx^2+cy^2+cz^2; {components}; a={area}"
    if not curved:
        return f"0.5*k*s/a; {square}"
    if unsigned:
        return f"0.5*k*(s/a-2*C0*sqrt(s)+C0^2*a); {square}"
    normal = "; ".join(f"n{x}={text}" for x, text in zip("xyz", v.normal(), strict=True))
    along = "(nx*cx+ny*cy+nz*cz)/sqrt(nx^2+ny^2+nz^2)"
    return f"0.5*k*(s/a-2*C0*{along}+C0^2*a); {normal}; {square}"


def _bending(ours, triangles: Array, style: str) -> list[mm.Force]:
    rings = _rings(triangles)
    rigidity = ours.getVertexRigidity() or [ours.getRigidity()] * len(rings)
    curvature = ours.getVertexSpontaneousCurvature()
    curvature = curvature or [ours.getSpontaneousCurvature()] * len(rings)
    curved = any(curvature)
    by_degree = defaultdict(list)
    for (vertex, ring), k, c0 in zip(rings.items(), rigidity, curvature, strict=True):
        by_degree[len(ring)].append(([vertex, *ring], (k, c0) if curved else (k,)))
    scheme, unsigned = _SCHEMES[ours.getScheme()], ours.getUnsignedSpontaneousCurvature()
    return [
        _compound(
            _vertex_energy(degree, scheme, curved, unsigned),
            [bond for bond, _ in bonds],
            ["k", "C0"] if curved else ["k"],
            [values for _, values in bonds],
        )
        for degree, bonds in sorted(by_degree.items())
    ]


_MAKERS = {
    "SurfaceAreaForce": _surface_area,
    "EnclosedVolumeForce": _enclosed_volume,
    "TriangleHeightForce": _heights,
    "TriangleAreaRepulsionForce": _area_repulsion,
    "TriangleAreaForce": _triangle_area,
    "DihedralForce": _dihedral,
    "BendingForce": _bending,
    "PressureForce": _pressure,
    "SurfaceTensionForce": _surface_tension,
    "OsmoticPressureForce": _osmotic_pressure,
    "AreaDifferenceForce": _area_difference,
}
