"""XML of Systems with each of our forces, and of States."""

from __future__ import annotations

import contextlib
from functools import cache
from random import Random
from xml.etree import ElementTree

import cases
import meshes
import numpy as np
import openmm
import openmmhelfrich as helfrich
from doors import Door, Wrong, attempt
from mutations import xml
from openmm import XmlSerializer

_REFUSED = openmm.OpenMMException
#: More attempts than this are the user's wish, and take time.
_MOST_ATTEMPTS = 50
_FALSE, _TRUE = ("0", "false"), ("1", "true")


def _others(triangles) -> list[openmm.Force]:
    """What is no energy: movers, a thermostat."""
    return [
        helfrich.MonteCarloBondFlip(triangles, 300, 2, 1.0),
        helfrich.MonteCarloDomainSwap(triangles, 300, 2, 1.0),
        helfrich.SurfaceViscosityThermostat(triangles, 0.1, 300),
        helfrich.MonteCarloMembraneTension(300, 0.5),
    ]


def _system(forces, membrane) -> openmm.System:
    system = openmm.System()
    for _ in range(membrane.num_particles):
        system.addParticle(50)
    if membrane in _membranes():
        system.setParticleMass(0, 50 + _membranes().index(membrane))
    system.setDefaultPeriodicBoxVectors((900, 0, 0), (0, 900, 0), (0, 0, 900))
    for force in forces:
        system.addForce(force)
    return system


@cache
def _membranes() -> list[meshes.Membrane]:
    """The mass of a System's first particle, less 50, says which one it is."""
    return [meshes.membrane(name) for name in ("octahedron", "holed", "mixed")]


@cache
def _systems() -> list[bytes]:
    found = []
    for case in cases.CASES:
        membrane = meshes.membrane(case.place("octahedron"))
        if case.exists and membrane in _membranes():
            found.append(_system([case.make(membrane)], membrane))
    octahedron = meshes.membrane("octahedron")
    for other in _others(octahedron.triangles):
        bending = helfrich.BendingForce(octahedron.triangles, 50)
        bending.setUsesPeriodicBoundaryConditions(True)
        found.append(_system([bending, other], octahedron))
    return [XmlSerializer.serialize(system).encode() for system in found]


def _change(data: bytes, random: Random) -> bytes:
    return xml(data, random, within="./Forces/*")


def _check(data: bytes) -> None:
    try:
        root = ElementTree.fromstring(data)
        given = data.decode()
    except (ElementTree.ParseError, UnicodeDecodeError, ValueError):
        # What is no XML is OpenMM's to refuse.
        return
    system = attempt(lambda: XmlSerializer.deserialize(given), _REFUSED)
    if not isinstance(system, openmm.System):
        return
    again = ElementTree.fromstring(XmlSerializer.serialize(system))
    # OpenMM takes all that is there for a force, whatever the element is called.
    for one, other in zip(root.findall("./Forces/*"), again.findall("./Forces/*"), strict=True):
        if one.get("type", "").startswith("Helfrich"):
            _compare(one, other)
    if all(float(e.get("attemptsPerEdge", "1")) < _MOST_ATTEMPTS for e in again.iter("Force")):
        _evaluate(system)


def _compare(one, other) -> None:
    """Whatever was given is there, with the same value; nothing has been clamped or lost."""
    for name, value in one.attrib.items():
        # A force in no periodic box may have the version of those in one; without a name OpenMM
        # gives it that of its type.
        if name == "version" or (name == "name" and not value):
            continue
        if not _same(value, other.get(name)):
            raise Wrong(f"<{one.tag} {name}={value!r}> was read as {other.get(name)!r}")
    if other.tag == "Parameters":
        # These may come in any order, and those with a default may be left out.
        for child in one:
            found = [c for c in other if _same(child.get("name"), c.get("name"))]
            _compare(child, found[0])
        return
    if len(one):
        named = {child.tag: child for child in other} if other.tag == "Force" else None
        others = [named.get(c.tag) for c in one] if named else list(other)
        if None in others or len(others) != len(one):
            raise Wrong(f"<{one.tag}> has lost or got children: {ElementTree.tostring(other)}")
        for child, kept in zip(one, others, strict=True):
            _compare(child, kept)


def _same(given: str | None, kept: str | None) -> bool:
    if given == kept or (not given and kept is None):
        return True
    if kept is None:
        return False
    try:
        a, b = float(given), float(kept)
        return a == b or (np.isnan(a) and np.isnan(b))
    except ValueError:
        return any(given in words and kept in words for words in (_FALSE, _TRUE))


def _evaluate(system: openmm.System) -> None:
    number = system.getParticleMass(0)._value - 50 if system.getNumParticles() else -1
    if number not in range(len(_membranes())):
        return
    membrane = _membranes()[int(number)]
    if membrane.num_particles != system.getNumParticles():
        return
    for name in ("Helfrich", "Reference"):
        platform = openmm.Platform.getPlatformByName(name)
        integrator = openmm.VerletIntegrator(1e-6)
        context = attempt(
            lambda integrator=integrator, platform=platform: openmm.Context(
                system, integrator, platform
            ),
            _REFUSED,
        )
        if context is None:
            continue
        context.setPositions(membrane.positions)
        attempt(lambda context=context: context.getState(energy=True, forces=True), _REFUSED)
        attempt(lambda integrator=integrator: integrator.step(2), _REFUSED)


@cache
def _flowing() -> openmm.Context:
    octahedron = meshes.membrane("jittered")
    bending = helfrich.BendingForce(octahedron.triangles, 50)
    mover = helfrich.MonteCarloBondFlip(octahedron.triangles, 300, 1, 0.5)
    system = _system([bending, mover], octahedron)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, openmm.VerletIntegrator(1e-4), platform)
    context.setPositions(octahedron.positions)
    return context


@cache
def _states() -> list[bytes]:
    context = _flowing()
    found = []
    for _ in range(2):
        state = context.getState(positions=True, velocities=True, parameters=True, energy=True)
        found.append(XmlSerializer.serialize(state).encode())
        context.getIntegrator().step(3)
    return found


def _check_state(data: bytes) -> None:
    first = _states()
    try:
        ElementTree.fromstring(data)
        given = data.decode()
    except (ElementTree.ParseError, UnicodeDecodeError, ValueError):
        return
    context = _flowing()
    # OpenMM's own reader may say anything; what it has read is handed to ours.
    try:
        state = XmlSerializer.deserialize(given)
    except Exception:
        return
    if not isinstance(state, openmm.State):
        return
    # What a State lacks, or has too many of, is OpenMM's to say.
    with contextlib.suppress(Exception):
        context.setState(state)
    attempt(lambda: context.getState(energy=True, forces=True), _REFUSED)
    attempt(lambda: context.getIntegrator().step(1), _REFUSED)
    context.reinitialize()
    context.setState(XmlSerializer.deserialize(first[0].decode()))
    attempt(lambda: context.getState(energy=True), ())


DOORS = [
    Door("system", _systems, _check, _change),
    Door("state", _states, _check_state, xml),
]
