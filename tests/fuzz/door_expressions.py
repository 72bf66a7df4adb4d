"""Expressions of Custom forces in `accelerate`: never an error, and always the same energy."""

from __future__ import annotations

from functools import cache
from random import Random
from xml.etree import ElementTree

import meshes
import numpy as np
import numpy_energies
import openmm
import openmmhelfrich as helfrich
import string_forces
from doors import Door, Wrong, attempt
from mutations import NUMBERS, xml
from openmm import XmlSerializer, unit
from openmmhelfrich.vcm import strings
from openmmhelfrich.vcm.accelerate import accelerate
from openmmhelfrich.vcm.expression_parser import tokens

_WORDS = [
    *("+-*/^(),;=" + "x"),
    *(
        "p1",
        "p2",
        "p9",
        "p\u00b2",
        "p" + "9" * 5000,
        "distance",
        "distance(p1,p2)",
        "angle(p1,p2,p3)",
        "dihedral(p1,p2,p3,p4)",
    ),
    *("sqrt", "exp", "log", "sin", "acos", "atan2", "min", "select", "step", "delta", "abs", "pi"),
    *(
        "table",
        "x1",
        "y1",
        "z3",
        "1/0",
        "0^0",
        "0/0",
        "sqrt(-1)",
        "-",
        "2^-2",
        "1e",
        "((((",
        "))))",
    ),
]


@cache
def _membrane() -> meshes.Membrane:
    return meshes.membrane("octahedron")


def _forces() -> list[openmm.Force]:
    membrane = _membrane()
    t = membrane.triangles
    geometry = numpy_energies.Geometry(membrane.positions, t)
    made = [
        helfrich.SurfaceAreaForce(t, 1.3, 1.01 * geometry.area),
        helfrich.EnclosedVolumeForce(t, 0.04, 0.98 * geometry.volume),
        helfrich.TriangleHeightForce(t, float(np.quantile(geometry.heights, 0.5)), 10),
        helfrich.TriangleAreaRepulsionForce(t, float(np.median(geometry.areas)), 10),
        helfrich.TriangleAreaForce(t, 2.5, geometry.area / len(t)),
        helfrich.DihedralForce(t, 40, helfrich.DihedralForce.Quartic),
    ]
    for scheme in string_forces.BENDING_SCHEMES:
        made.append(helfrich.BendingForce(t, 50, 0, getattr(helfrich.BendingForce, scheme)))
    return made


def _system(forces) -> openmm.System:
    system = openmm.System()
    for _ in range(_membrane().num_particles):
        system.addParticle(50)
    for force in forces:
        system.addForce(force)
    return system


@cache
def _seeds() -> list[bytes]:
    systems = [_system(strings.custom_forces(force, "sums")) for force in _forces()]
    found = [XmlSerializer.serialize(system).encode() for system in systems]
    # What is longer takes OpenMM seconds to compile.
    return [data for data in found if len(data) < 40000]


def _change(data: bytes, random: Random) -> bytes:
    if random.random() < 0.2:
        # OpenMM's own readers are not safe from elements that are missing.
        return xml(data, random, within="./Forces/*", only_values=True)
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError:
        return data
    having = [element for element in root.iter() if "energy" in element.attrib]
    if not having:
        return data
    element = random.choice(having)
    words = _tokens(element.get("energy"))
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        at = random.randrange(len(words) + 1)
        end = min(len(words), at + random.choice((1, 1, 2, 5, 20)))
        match random.randrange(7):
            case 0:
                words[at:end] = [random.choice(_WORDS)]
            case 1:
                words[at : at + 1] = [random.choice(NUMBERS)]
            case 2:
                del words[at:end]
            case 3:
                words[at:at] = [random.choice(_WORDS)]
            case 4:
                words[at:at] = words[at:end]
            case 5 if words:
                words[at : at + 1] = [random.choice(words)]
            case 6:
                count = random.choice((1, 2, 50, 3000))
                words[at:end] = ["(" * count, *words[at:end], ")" * count]
    element.set("energy", "".join(words))
    return ElementTree.tostring(root, encoding="unicode").replace("\0", "").encode()


def _tokens(expression: str) -> list[str]:
    return [word for part in expression.split(";") for word in [*tokens(part), ";"]][:-1]


def _check(data: bytes) -> None:
    try:
        root = ElementTree.fromstring(data)
        given = data.decode()
    except (ElementTree.ParseError, UnicodeDecodeError, ValueError):
        return
    # OpenMM's own parser calls itself for each bracket.
    if any("(" * 20000 in element.get("energy", "") for element in root.iter()):
        return
    try:
        system = XmlSerializer.deserialize(given)
    except Exception:
        return
    if not isinstance(system, openmm.System) or system.getNumParticles() != len(_positions()):
        return
    faster, _ = attempt(lambda: accelerate(system, _positions()), ())
    if XmlSerializer.serialize(faster) == XmlSerializer.serialize(system):
        return
    one, other = (_energy(each) for each in (system, faster))
    if one is None:
        # OpenMM itself cannot evaluate what was given.
        return
    if other is None or not abs(one[0] - other[0]) <= 1e-6 * max(1, abs(one[0])):
        raise Wrong(f"the energy is {other and other[0]} kJ/mol, and was {one[0]}")
    if np.abs(one[1] - other[1]).max() > 1e-6 * max(1, np.abs(one[1]).max()):
        raise Wrong("forces differ")


def _positions() -> np.ndarray:
    return np.array(_membrane().positions)


def _energy(system: openmm.System) -> tuple[float, np.ndarray] | None:
    platform = openmm.Platform.getPlatformByName("Reference")
    try:
        context = openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
        context.setPositions(_positions())
        state = context.getState(energy=True, forces=True)
    except openmm.OpenMMException:
        return None
    md = unit.md_unit_system
    energy = state.getPotentialEnergy().value_in_unit_system(md)
    forces = state.getForces(asNumpy=True).value_in_unit_system(md)
    return (energy, forces) if np.isfinite(energy) and np.isfinite(forces).all() else None


DOORS = [Door("expression", _seeds, _check, _change)]
