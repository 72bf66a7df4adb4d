"""The one table of potentials that drives the force tests.

A row is one way to make a force: its class and variant, its arguments as functions of the
membrane, arguments that must be refused, and the two independent opinions of what it should
compute. A new potential is one new row; `test_forces.py` runs it over all membranes and platforms.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import contact_twin
import meshes
import numpy as np
import numpy_energies
import openmm as mm
import openmmhelfrich as helfrich
import oracle
import string_forces
from meshes import Membrane
from oracle import Result

Arguments = Mapping[str, Any]


@dataclass(frozen=True)
class Invalid:
    """An argument that must be refused by a message with the class, its name and the fragment."""

    argument: str
    value: float
    fragment: str


@dataclass(frozen=True)
class Case:
    """One row.

    name: what the test's id says
    force: the class in openmmhelfrich
    arguments: the constructor's scalars, for a membrane
    energy: the same energy by numpy, in kJ/mol
    strings: energy and forces by string forces in a style; none of contacts, since no string force
        finds the nearest point of a triangle
    compiles: whether OpenMM compiles these string forces in reasonable time
    step: for finite differences, in mean edge lengths
    variant: keyword and name of the class's constant, e.g. ("scheme", "Julicher")
    settings: setters to call after construction, with their values
    surface: "closed", "open" or "parts" if the force needs one, or has none on others
    others: the particles beside the vertices that it acts on
    invalid: listed once for each class
    """

    name: str
    force: str
    arguments: Callable[[Membrane], dict[str, Any]]
    energy: Callable[[Membrane, Arguments], float]
    strings: Callable[[Membrane, Arguments, str], Result] | None = None
    compiles: Callable[[Membrane, str], bool] = field(default=lambda membrane, style: True)
    step: float = 3e-4
    variant: tuple[str, str] | None = None
    settings: Callable[[Membrane], dict[str, Any]] = field(default=lambda membrane: {})
    surface: str = "any"
    others: Callable[[Membrane], np.ndarray] | None = None
    invalid: tuple[Invalid, ...] = ()

    @property
    def has_own_values(self) -> bool:
        """Whether each element has values of its own in place of all scalars."""
        return "domains" in self.name or "each its own" in self.name

    @property
    def is_contact(self) -> bool:
        """Whether it acts on pairs of what is near, and not on the elements of a mesh."""
        return self.force in CONTACTS

    def acts_on(self, where: str) -> bool:
        """Whether the force can act on a membrane of this name."""
        if where in meshes.TOUCHING_NAMES and not self.is_contact:
            return False
        fits = {
            "any": True,
            "open": where in meshes.OPEN_NAMES,
            "closed": where not in meshes.OPEN_NAMES,
            "parts": where in meshes.PARTS_NAMES,
        }
        return fits[self.surface]

    def place(self, usual: str) -> str:
        """The name of a membrane that the force acts on: the usual one if it does."""
        return usual if self.acts_on(usual) else {"open": "holed", "parts": "mixed"}[self.surface]

    def acted_on(self, membrane: Membrane) -> np.ndarray:
        """The particles that feel the force."""
        others = [] if self.others is None else self.others(membrane)
        return np.union1d(membrane.members, others).astype(int)

    def strangers(self, membrane: Membrane) -> np.ndarray:
        """The particles that do not."""
        return np.setdiff1d(np.arange(membrane.num_particles), self.acted_on(membrane))

    @property
    def exists(self) -> bool:
        """Whether the package has the class, its variant and its setters."""
        cls = getattr(helfrich, self.force, None)
        names = list(self.settings(meshes.membrane(self.place("octahedron"))))
        if self.variant is not None:
            names.append(self.variant[1])
        return cls is not None and all(hasattr(cls, name) for name in names)

    def make(self, membrane: Membrane, **replaced: Any) -> mm.Force:
        """The plugin's force on a membrane."""
        return self.make_on(membrane.triangles, membrane, **replaced)

    def make_on(self, triangles, membrane: Membrane, shift: int = 0, **replaced: Any) -> mm.Force:
        """The same on other triangles; other particles are `shift` beyond those of the membrane."""
        cls = getattr(helfrich, self.force)
        arguments = {**self.arguments(membrane), **replaced}
        if self.variant is not None:
            keyword, constant = self.variant
            arguments[keyword] = getattr(cls, constant)
        if self.others is not None:
            arguments["particles"] = self.others(membrane) + shift
        force = cls(triangles, **arguments)
        for setter, value in self.settings(membrane).items():
            getattr(force, setter)(value)
        return force

    def expected_energy(self, membrane: Membrane) -> float:
        return self.energy(membrane, self.arguments(membrane))

    def expected(self, membrane: Membrane, style: str) -> Result:
        return self.strings(membrane, self.arguments(membrane), style)

    def __str__(self) -> str:
        return self.name


def _never_below(argument: str, *, zero: bool) -> tuple[Invalid, ...]:
    refused = [Invalid(argument, -1.5, "-1.5"), Invalid(argument, float("nan"), "nan")]
    refused.append(Invalid(argument, float("inf"), "inf"))
    if not zero:
        refused.append(Invalid(argument, 0.0, "0"))
    return tuple(refused)


def _never_infinite(argument: str) -> tuple[Invalid, ...]:
    return tuple(Invalid(argument, value, str(value)) for value in (np.nan, np.inf, -np.inf))


# --- area, volume, triangles -------------------------------------------------------------------


def _geometry(membrane: Membrane) -> numpy_energies.Geometry:
    return numpy_energies.Geometry(membrane.positions, membrane.triangles)


def _surface_area() -> list[Case]:
    return [
        Case(
            name=f"surface area, {word}",
            force="SurfaceAreaForce",
            arguments=lambda m, ratio=ratio: {"modulus": 1.3, "target": ratio * _geometry(m).area},
            energy=lambda m, a: numpy_energies.global_area(
                m.positions, m.triangles, a["modulus"], a["target"]
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.global_area(m.triangles, a["modulus"], a["target"], style),
                m.positions,
            ),
            invalid=invalid,
        )
        for word, ratio, invalid in (
            (
                "too large",
                0.93,
                _never_below("modulus", zero=True) + _never_below("target", zero=False),
            ),
            ("too small", 1.08, ()),
        )
    ]


def _enclosed_volume() -> list[Case]:
    return [
        Case(
            name=f"enclosed volume, {word}",
            force="EnclosedVolumeForce",
            arguments=lambda m, ratio=ratio: {
                "modulus": 0.04,
                "target": ratio * _geometry(m).volume,
            },
            energy=lambda m, a: numpy_energies.global_volume(
                m.positions, m.triangles, a["modulus"], a["target"]
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.global_volume(m.triangles, a["modulus"], a["target"], style),
                m.positions,
            ),
            surface="closed",
            invalid=invalid,
        )
        for word, ratio, invalid in (
            (
                "too large",
                0.9,
                _never_below("modulus", zero=True) + _never_below("target", zero=False),
            ),
            ("too small", 1.07, ()),
        )
    ]


def _pressures() -> list[Case]:
    return [
        *(
            Case(
                name=f"pressure, {word}",
                force="PressureForce",
                arguments=lambda m, pressure=pressure: {"pressure": pressure},
                energy=lambda m, a: -a["pressure"] * _geometry(m).volume,
                strings=lambda m, a, style: oracle.evaluate(
                    string_forces.pressure(m.triangles, a["pressure"], style), m.positions
                ),
                surface="closed",
                invalid=invalid,
            )
            for word, pressure, invalid in (
                ("outward", 0.04, _never_infinite("pressure")),
                ("inward", -0.02, ()),
            )
        ),
        *(
            Case(
                name=f"osmotic pressure, {word}",
                force="OsmoticPressureForce",
                arguments=lambda m, ratio=ratio: {
                    "solutes": ratio * 0.01 * _geometry(m).volume,
                    "concentration": 0.01,
                    "thermalEnergy": 2.494,
                },
                energy=lambda m, a: numpy_energies.osmotic_pressure(m.positions, m.triangles, **a),
                strings=lambda m, a, style: oracle.evaluate(
                    string_forces.osmotic_pressure(m.triangles, **a, style=style), m.positions
                ),
                surface="closed",
                invalid=invalid,
            )
            for word, ratio, invalid in (
                (
                    "swollen",
                    0.9,
                    _never_below("solutes", zero=False)
                    + _never_below("concentration", zero=False)
                    + _never_below("thermalEnergy", zero=False),
                ),
                ("shrunken", 2.5, ()),
            )
        ),
    ]


def _surface_tensions() -> list[Case]:
    return [
        Case(
            name=f"surface tension, {word}",
            force="SurfaceTensionForce",
            arguments=lambda m, tension=tension: {"tension": tension},
            energy=lambda m, a: a["tension"] * _geometry(m).area,
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.surface_tension(m.triangles, a["tension"], style), m.positions
            ),
            invalid=invalid,
        )
        for word, tension, invalid in (
            ("above zero", 1.2, _never_infinite("tension")),
            ("below zero", -0.7, ()),
        )
    ]


def _area_differences() -> list[Case]:
    return [
        Case(
            name=f"area difference, {word}",
            force="AreaDifferenceForce",
            arguments=lambda m, ratio=ratio: {
                "modulus": 0.5,
                "target": ratio * _geometry(m).mean_curvature,
            },
            energy=lambda m, a: (
                0.5 * a["modulus"] * (_geometry(m).mean_curvature - a["target"]) ** 2
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.area_difference(m.triangles, a["modulus"], a["target"], style),
                m.positions,
            ),
            invalid=invalid,
        )
        for word, ratio, invalid in (
            (
                "too large",
                0.9,
                _never_below("modulus", zero=True) + _never_infinite("target"),
            ),
            ("too small", 1.2, ()),
            ("of the other sign", -0.1, ()),
        )
    ]


def _triangle_heights() -> list[Case]:
    return [
        Case(
            name=f"triangle heights, {word}",
            force="TriangleHeightForce",
            # At a share of the heights, so that some of them repel and some do not.
            arguments=lambda m, share=share: {
                "minHeight": float(np.quantile(_geometry(m).heights, share)),
                "epsilon": 10.0,
            },
            energy=lambda m, a: numpy_energies.triangle_heights(
                m.positions, m.triangles, a["minHeight"], a["epsilon"]
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.triangle_heights(m.triangles, a["minHeight"], a["epsilon"], style),
                m.positions,
            ),
            # The second derivative jumps at the cutoff: no large steps across it.
            step=2e-5,
            invalid=invalid,
        )
        for word, share, invalid in (
            (
                "few",
                0.05,
                _never_below("minHeight", zero=True) + _never_below("epsilon", zero=True),
            ),
            ("many", 0.35, ()),
        )
    ]


def _triangle_area() -> list[Case]:
    def one(m: Membrane) -> dict[str, Any]:
        return {"modulus": 1.3, "target": 0.9 * _geometry(m).area / len(m.triangles)}

    def each(m: Membrane) -> dict[str, Any]:
        rng = np.random.default_rng(11)
        return {"modulus": 1.3, "target": _geometry(m).areas * rng.uniform(0.8, 1.2)}

    return [
        Case(
            name=f"triangle areas, {word}",
            force="TriangleAreaForce",
            arguments=arguments,
            energy=lambda m, a: numpy_energies.triangle_area(
                m.positions, m.triangles, a["modulus"], a["target"]
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.triangle_area(m.triangles, a["modulus"], a["target"], style),
                m.positions,
            ),
            invalid=invalid,
        )
        for word, arguments, invalid in (
            (
                "one target",
                one,
                _never_below("modulus", zero=True) + _never_below("target", zero=False),
            ),
            ("a target each", each, ()),
        )
    ]


def _triangle_area_repulsion() -> list[Case]:
    return [
        Case(
            name="triangle area repulsion",
            force="TriangleAreaRepulsionForce",
            arguments=lambda m: {
                "minArea": float(np.quantile(_geometry(m).areas, 0.4)),
                "epsilon": 10.0,
            },
            energy=lambda m, a: numpy_energies.triangle_area_repulsion(
                m.positions, m.triangles, a["minArea"], a["epsilon"]
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.triangle_area_repulsion(
                    m.triangles, a["minArea"], a["epsilon"], style
                ),
                m.positions,
            ),
            # The second derivative jumps at the cutoff: no large steps across it.
            step=2e-5,
            invalid=_never_below("minArea", zero=True) + _never_below("epsilon", zero=True),
        )
    ]


def _plaquette_area() -> list[Case]:
    return [
        Case(
            name="plaquette areas",
            force="PlaquetteAreaForce",
            arguments=lambda m: {"stiffness": 400.0, "target": 0.9 * _geometry(m).area},
            energy=lambda m, a: numpy_energies.plaquette_area(
                m.positions, m.triangles, a["stiffness"], a["target"]
            ),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.plaquette_area(m.triangles, a["stiffness"], a["target"], style),
                m.positions,
            ),
            invalid=_never_below("stiffness", zero=True) + _never_below("target", zero=False),
        )
    ]


def _dihedrals() -> list[Case]:
    def flat(m: Membrane) -> dict[str, Any]:
        return {"stiffness": 40.0}

    def bent(m: Membrane) -> dict[str, Any]:
        return {"stiffness": 400.0, "restAngle": 0.4}

    def each(m: Membrane) -> dict[str, Any]:
        rng = np.random.default_rng(12)
        count = len(numpy_energies.has_angle(m.triangles))
        return {"stiffness": rng.uniform(20, 60, count), "restAngle": rng.uniform(-0.5, 0.9, count)}

    def strings(m: Membrane, a: Arguments, style: str, form: str) -> Result:
        hinges = numpy_energies.has_angle(m.triangles)
        stiffness, rest = (
            value[hinges] if np.ndim(value) else value
            for value in (a["stiffness"], a.get("restAngle", 0.0))
        )
        forces = string_forces.dihedral(m.triangles, stiffness, form, style, rest)
        return oracle.evaluate(forces, m.positions)

    forms = list(string_forces.DIHEDRAL_FORMS)
    rows = [(form, "", flat) for form in forms]
    rows += [(form, ", at rest bent", bent) for form in ("Quartic", "SmoothExp46")]
    rows += [("Cosine", ", each its own", each)]
    invalid = _never_below("stiffness", zero=True)
    invalid += tuple(Invalid("restAngle", value, "-pi to pi") for value in (3.2, -4.0, np.nan))
    return [
        Case(
            name=f"dihedrals, {form}{word}",
            force="DihedralForce",
            variant=("form", form),
            arguments=arguments,
            energy=lambda m, a, form=form: numpy_energies.dihedral(
                m.positions, m.triangles, a["stiffness"], form, a.get("restAngle", 0.0)
            ),
            strings=functools.partial(strings, form=form),
            invalid=invalid if (form, word) == ("Quartic", "") else (),
        )
        for form, word, arguments in rows
    ]


# --- borders -----------------------------------------------------------------------------------


def _borders() -> list[Case]:
    return [
        Case(
            name="edge tension",
            force="EdgeTensionForce",
            arguments=lambda m: {"tension": 3.0},
            energy=lambda m, a: numpy_energies.edge_tension(m.positions, m.triangles, a["tension"]),
            strings=lambda m, a, style: oracle.evaluate(
                string_forces.edge_tension(m.triangles, a["tension"], style), m.positions
            ),
            surface="open",
            invalid=_never_infinite("tension"),
        ),
        *(
            Case(
                name=f"Gaussian curvature, {word}",
                force="GaussianCurvatureForce",
                arguments=lambda m, modulus=modulus: {"modulus": modulus},
                energy=lambda m, a: numpy_energies.gaussian_curvature(
                    m.positions, m.triangles, a["modulus"]
                ),
                strings=lambda m, a, style: oracle.evaluate(
                    string_forces.gaussian_curvature(m.triangles, a["modulus"], style), m.positions
                ),
                surface="open",
                invalid=invalid,
            )
            for word, modulus, invalid in (
                ("below zero", -45.0, _never_infinite("modulus")),
                ("above zero", 30.0, ()),
            )
        ),
    ]


def _gaussian_domains() -> Case:
    def moduli(m: Membrane) -> np.ndarray:
        return np.random.default_rng(31).uniform(-60, 30, len(m.members))

    return Case(
        name="Gaussian curvature, domains",
        force="GaussianCurvatureForce",
        arguments=lambda m: {"modulus": -45.0},
        energy=lambda m, a: numpy_energies.gaussian_curvature(m.positions, m.triangles, moduli(m)),
        strings=lambda m, a, style: oracle.evaluate(
            string_forces.gaussian_curvature(m.triangles, moduli(m), style), m.positions
        ),
        settings=lambda m: {"setVertexModulus": moduli(m)},
    )


# --- against a reference, and between domains -----------------------------------------------------


@cache
def at_rest(m: Membrane) -> np.ndarray:
    """Positions of the vertices near those of now, by a share of the shortest edge at each."""
    shortest = np.full(m.num_particles, np.inf)
    lengths = numpy_energies.edge_lengths(m.positions, m.triangles)
    for column in numpy_energies.edges(m.triangles).T:
        np.minimum.at(shortest, column, lengths)
    moves = np.random.default_rng(23).uniform(-0.15, 0.15, (len(m.members), 3))
    points = np.asarray(m.positions)[m.members] + shortest[m.members, None] * moves
    points.flags.writeable = False
    return points


def _in_its_box(m: Membrane) -> dict[str, Any]:
    """The reference is in the box that the membrane is in."""
    box = getattr(m.positions, "box", None)
    return {} if box is None else {"setReferenceBox": box}


def _strains() -> list[Case]:
    def placed(m: Membrane, a: Arguments) -> np.ndarray:
        return numpy_energies.placed(m.positions, m.triangles, a["reference"])

    invalid = _never_below("shearModulus", zero=True) + _never_below("areaModulus", zero=True)
    return [
        Case(
            name=f"strains, {word}",
            force=force,
            variant=variant,
            arguments=lambda m: {
                "shearModulus": 2.0,
                "areaModulus": 3.0,
                "reference": at_rest(m),
            },
            energy=lambda m, a, word=word: getattr(numpy_energies, word)(
                m.positions, m.triangles, a["shearModulus"], a["areaModulus"], a["reference"]
            ),
            strings=lambda m, a, style, word=word: oracle.evaluate(
                getattr(string_forces, word)(
                    m.triangles, a["shearModulus"], a["areaModulus"], placed(m, a), style
                ),
                m.positions,
            ),
            settings=_in_its_box,
            invalid=invalid if word != "amoudruz" else (),
        )
        for word, force, variant in (
            ("skalak", "SkalakForce", None),
            ("neo_hookean", "NeoHookeanForce", None),
            ("linear_elastic", "LinearElasticForce", None),
            ("lim", "LimForce", ("coefficients", "Lim2002")),
            ("amoudruz", "LimForce", ("coefficients", "Amoudruz2023")),
        )
    ]


def _springs() -> list[Case]:
    def expected(m: Membrane, a: Arguments, style: str, form: str) -> Result:
        placed = numpy_energies.placed(m.positions, m.triangles, a["reference"])
        ratio = a.get("ratio", 1 / 2.2)
        forces = string_forces.spring(m.triangles, a["stiffness"], placed, ratio, form, style)
        return oracle.evaluate(forces, m.positions)

    return [
        Case(
            name=f"springs, {form}",
            force="SpringForce",
            variant=("form", form),
            arguments=lambda m, also=also: {"stiffness": 2.0, "reference": at_rest(m), **also},
            energy=lambda m, a, form=form: numpy_energies.spring(
                m.positions, m.triangles, **a, form=form
            ),
            strings=lambda m, a, style, form=form: expected(m, a, style, form),
            settings=_in_its_box,
            invalid=invalid,
        )
        for form, also, invalid in (
            (
                "Harmonic",
                {},
                _never_below("stiffness", zero=True)
                + _never_below("ratio", zero=False)
                + (Invalid("ratio", 1.0, "1"),),
            ),
            ("WLCPower", {"ratio": 0.4}, ()),
        )
    ]


def _line_tension() -> list[Case]:
    def domains(m: Membrane) -> np.ndarray:
        """Three that are mixed, and a few vertices of others."""
        rng = np.random.default_rng(29)
        return np.where(rng.random(len(m.members)) < 0.8, m.members % 3, rng.integers(-9, 9))

    def strings(m: Membrane, a: Arguments, style: str) -> Result:
        kind = dict(zip(m.members.tolist(), np.asarray(a["domains"]).tolist(), strict=True))
        forces = string_forces.line_tension(m.triangles, a["tension"], kind, style)
        return oracle.evaluate(forces, m.positions)

    return [
        Case(
            name="line tension",
            force="LineTensionForce",
            arguments=lambda m: {"tension": 3.0, "domains": domains(m)},
            energy=lambda m, a: numpy_energies.line_tension(
                m.positions, m.triangles, a["tension"], a["domains"]
            ),
            strings=strings,
            invalid=_never_infinite("tension"),
        )
    ]


# --- bending -----------------------------------------------------------------------------------


def _bending(
    name: str,
    scheme: str,
    curvature: float = 0.0,
    unsigned: bool = False,
    invalid: tuple[Invalid, ...] = (),
) -> Case:
    def arguments(m: Membrane) -> dict[str, Any]:
        scalars = {"rigidity": 50.0}
        # Where it is zero it stays away, so that the default is tested too.
        return {**scalars, "spontaneousCurvature": curvature} if curvature else scalars

    def energy(m: Membrane, a: Arguments) -> float:
        return numpy_energies.bending(
            m.positions, m.triangles, a["rigidity"], curvature, scheme, unsigned
        )

    def strings(m: Membrane, a: Arguments, style: str) -> Result:
        return oracle.bending(m, scheme, style, a["rigidity"], curvature, unsigned)

    return Case(
        name=f"bending, {name}",
        force="BendingForce",
        variant=("scheme", scheme),
        arguments=arguments,
        energy=energy,
        strings=strings,
        compiles=lambda m, style: oracle.bending_within_limits(
            m, scheme, style, curvature != 0, unsigned
        ),
        # |S| comes to a point at S = 0, and some vertices are near it.
        step=2e-5 if unsigned else 3e-4,
        settings=lambda m: {"setUnsignedSpontaneousCurvature": True} if unsigned else {},
        invalid=invalid,
    )


def _domains(scheme: str) -> Case:
    """Rigidity and spontaneous curvature by vertex."""

    def values(m: Membrane) -> tuple[np.ndarray, np.ndarray]:
        rng = np.random.default_rng(13)
        n = len(m.members)
        return rng.uniform(20, 80, n), rng.uniform(-0.02, 0.02, n)

    def settings(m: Membrane) -> dict[str, Any]:
        rigidity, curvature = values(m)
        return {
            "setVertexRigidity": rigidity.tolist(),
            "setVertexSpontaneousCurvature": curvature.tolist(),
        }

    def strings(m: Membrane, a: Arguments, style: str) -> Result:
        return oracle.bending(m, scheme, style, *values(m))

    return Case(
        name=f"bending, {scheme} domains",
        force="BendingForce",
        variant=("scheme", scheme),
        arguments=lambda m: {"rigidity": 50.0},
        energy=lambda m, a: numpy_energies.bending(m.positions, m.triangles, *values(m), scheme),
        strings=strings,
        compiles=lambda m, style: oracle.bending_within_limits(m, scheme, style, True),
        settings=settings,
    )


def _bendings() -> list[Case]:
    julicher = _bending(
        "Julicher",
        "Julicher",
        invalid=_never_below("rigidity", zero=True) + _never_infinite("spontaneousCurvature"),
    )
    rows = [julicher]
    for scheme in string_forces.BENDING_SCHEMES:
        if scheme != "Julicher":
            rows.append(_bending(scheme, scheme))
        rows.append(_bending(f"{scheme} bulging out", scheme, 0.02))
        rows.append(_bending(f"{scheme} bulging in", scheme, -0.015))
        rows.append(_domains(scheme))
        if not scheme.startswith("Julicher"):
            rows.append(_bending(f"{scheme} unsigned", scheme, 0.02, unsigned=True))
    return rows


# --- contacts ----------------------------------------------------------------------------------

CONTACTS = ("SurfaceRepulsionForce", "ParticleSurfaceForce")


@cache
def _pairs(m: Membrane, between: bool) -> tuple[np.ndarray, np.ndarray]:
    """Distances and weights of the pairs of a surface that are nearer than two edges are long."""
    part = m.parts if between else None
    return contact_twin.surface_pairs(m.positions, m.triangles, 2 * m.mean_edge, part)


def _surface_repulsion() -> list[Case]:
    def arguments(m: Membrane, between: bool) -> dict[str, Any]:
        gaps, _ = _pairs(m, between)
        nearest = gaps.min() if len(gaps) else m.mean_edge
        return {"distance": 1.3 * float(nearest), "epsilon": 2.5}

    def energy(m: Membrane, a: Arguments, between: bool) -> float:
        gaps, weights = _pairs(m, between)
        return float((weights * contact_twin.core(gaps, **a)).sum())

    return [
        Case(
            name=f"repulsion, {word}",
            force="SurfaceRepulsionForce",
            arguments=lambda m, between=between: arguments(m, between),
            energy=lambda m, a, between=between: energy(m, a, between),
            # The second derivative jumps at the cutoff: no large steps across it.
            step=2e-5,
            settings=lambda m, between=between: {"setOnlyBetweenParts": True} if between else {},
            surface="parts" if between else "any",
            invalid=invalid,
        )
        for word, between, invalid in (
            (
                "all pairs",
                False,
                _never_below("distance", zero=False) + _never_below("epsilon", zero=True),
            ),
            ("between parts", True, ()),
        )
    ]


@cache
def beads(m: Membrane) -> tuple[np.ndarray, np.ndarray]:
    """The half of the foreign particles that is nearest to the surface, in some order, and how far
    they are from it.
    """
    gaps = contact_twin.particle_gaps(m.positions, m.triangles, m.foreign).min(axis=1)
    chosen = np.argsort(gaps)[: (len(gaps) + 1) // 2]
    chosen = np.random.default_rng(19).permutation(chosen)
    return m.foreign[chosen], gaps[chosen]


def _particle_surface() -> list[Case]:
    def bare(m: Membrane) -> dict[str, Any]:
        return {"distance": 1.3 * float(beads(m)[1].min()), "epsilon": 2.5}

    def of_one_radius(m: Membrane) -> dict[str, Any]:
        nearest = float(beads(m)[1].min())
        sizes = {"distance": 0.84 * nearest, "radius": 0.3 * nearest}
        return {**sizes, "epsilon": 2.5, "adhesion": 0.02}

    def of_radii(m: Membrane) -> dict[str, Any]:
        """Those touch that are not far."""
        _, gaps = beads(m)
        # No gap is at the cutoff.
        distance = 1.1 * float(gaps.min())
        left = distance * np.random.default_rng(20).uniform(0.85, 2.0, len(gaps))
        left = np.minimum(gaps, left)
        radii = np.minimum(gaps - left, 0.6 * m.mean_edge)
        return {"distance": distance, "epsilon": 2.5, "adhesion": 0.03, "radius": radii}

    return [
        Case(
            name=f"particles, {word}",
            force="ParticleSurfaceForce",
            variant=("attraction", attraction),
            arguments=arguments,
            energy=lambda m, a, attraction=attraction: contact_twin.particle_surface(
                m.positions, m.triangles, beads(m)[0], attraction=attraction, **a
            ),
            # The second derivative jumps at the cutoff: no large steps across it.
            step=2e-5,
            others=lambda m: beads(m)[0],
            invalid=invalid,
        )
        for word, attraction, arguments, invalid in (
            (
                "WCA",
                "WCA",
                bare,
                _never_below("distance", zero=False)
                + _never_below("epsilon", zero=True)
                + _never_below("adhesion", zero=True)
                + _never_below("radius", zero=True),
            ),
            ("LennardJones", "LennardJones", of_one_radius, ()),
            ("NineThree, a radius each", "NineThree", of_radii, ()),
        )
    ]


CASES = [
    *_surface_area(),
    *_enclosed_volume(),
    *_triangle_heights(),
    *_bendings(),
    *_dihedrals(),
    *_triangle_area(),
    *_triangle_area_repulsion(),
    *_plaquette_area(),
    *_borders(),
    _gaussian_domains(),
    *_strains(),
    *_springs(),
    *_line_tension(),
    *_surface_repulsion(),
    *_particle_surface(),
    *_pressures(),
    *_surface_tensions(),
    *_area_differences(),
]
PRESENT = [case for case in CASES if case.exists]
