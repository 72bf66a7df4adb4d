"""Files of save_state, connectivity, and checkpoints of platform Helfrich.

What is refused has changed nothing; what is taken can be gone on with.
"""

from __future__ import annotations

import struct
from functools import cache
from random import Random

import meshes
import numpy as np
import openmm
import openmmhelfrich as helfrich
from doors import Door, Wrong, attempt, folder
from mutations import NUMBERS, binary
from openmm import unit
from openmmhelfrich import _blocks

_REFUSED = openmm.OpenMMException


@cache
def _context() -> tuple[openmm.Context, object]:
    """A membrane of two movers, a thermostat and two kinds of vertices, and a force on it."""
    membrane = meshes.membrane("octahedron")
    bending = helfrich.BendingForce(membrane.triangles, 50)
    lines = helfrich.LineTensionForce(membrane.triangles, 1.0, np.arange(len(membrane.members)) % 2)
    system = openmm.System()
    for _ in range(membrane.num_particles):
        system.addParticle(50)
    system.setDefaultPeriodicBoxVectors((900, 0, 0), (0, 900, 0), (0, 0, 900))
    for force in (bending, lines):
        force.setUsesPeriodicBoundaryConditions(True)
        system.addForce(force)
    for force in (
        helfrich.MonteCarloBondFlip(membrane.triangles, 300, 1, 0.5),
        helfrich.MonteCarloDomainSwap(membrane.triangles, 300, 1, 0.5),
        helfrich.SurfaceViscosityThermostat(membrane.triangles, 0.1, 300),
        helfrich.MonteCarloMembraneTension(300, 0.0),
    ):
        system.addForce(force)
    integrator = openmm.LangevinMiddleIntegrator(300, 0.1, 1e-4)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform)
    context.setPositions(membrane.positions)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(5)
    return context, bending


@cache
def _file() -> bytes:
    path = folder() / "seed.state"
    helfrich.save_state(_context()[0], path)
    return path.read_bytes()


@cache
def _checkpoint() -> bytes:
    return _context()[0].createCheckpoint()


@cache
def _connectivity() -> bytes:
    context, force = _context()
    return force._saveConnectivity(context)


def _present() -> tuple:
    context, force = _context()
    state = context.getState(positions=True, velocities=True)
    arrays = (
        state.getPositions(asNumpy=True),
        state.getVelocities(asNumpy=True),
        state.getPeriodicBoxVectors(asNumpy=True),
    )
    return (
        *(a.value_in_unit_system(unit.md_unit_system).tobytes() for a in arrays),
        force._saveConnectivity(context),
        context.getStepCount(),
    )


def _loaded(action) -> None:
    """Load something; the Context is as it was then, or goes on from what was loaded."""
    context, _ = _context()
    first = _checkpoint()
    before = _present()
    refused = []

    def load() -> None:
        try:
            action()
        except (_REFUSED, ValueError) as reason:
            refused.append(reason)
            raise

    try:
        attempt(load, (_REFUSED, ValueError))
        if refused and _present() != before:
            raise Wrong(f"what was refused has changed the Context: {refused[0]}")
        if not refused:
            attempt(lambda: context.getState(energy=True, forces=True), _REFUSED)
            attempt(lambda: context.getIntegrator().step(1), _REFUSED)
    finally:
        context.loadCheckpoint(first)
    if _present() != before:
        after = [a == b for a, b in zip(_present(), before, strict=True)]
        raise Wrong(f"the Context cannot go back to where it was: {after}")


def _check_file(data: bytes) -> None:
    path = folder() / "input.state"
    path.write_bytes(data)
    _loaded(lambda: helfrich.load_state(_context()[0], path))


def _change_file(data: bytes, random: Random) -> bytes:
    """What is inside, under a checksum that is right; sometimes the file itself."""
    try:
        blocks = _blocks.unpack(data, "state", dict.fromkeys(_NAMES, 1))
    except _blocks.BlockError:
        return binary(data, random)
    if random.random() < 0.2 or not blocks:
        return binary(data, random)
    name = random.choice(list(blocks))
    value = blocks[name].value
    if random.random() < 0.15:
        del blocks[name]
    elif random.random() < 0.1:
        blocks[name] = blocks[random.choice(list(blocks))]
    elif isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.ndim == 2:
        value = value.copy()
        if random.random() < 0.5 and value.size:
            wild = (np.nan, np.inf, 0.0, 1e300, -1e-300, 1e30)
            value.flat[random.randrange(value.size)] = random.choice(wild)
        else:
            other = random.choice(
                (value[:-1], value.T, value.ravel(), value.astype("f4"), value[:1])
            )
            value = random.choice((other, value.astype("i8"), np.array(["x"]), np.zeros((2, 0))))
        blocks[name] = _blocks.Block(value)
    elif isinstance(value, bytes):
        blocks[name] = _blocks.Block(_change_connectivity(value, random))
    else:
        found = dict(value) if isinstance(value, dict) else {}
        key = random.choice([*found, "extra"])
        wild = (*NUMBERS, 3, -1, 2**70, 1.5, None, [], {}, True, float("nan"))
        found[key] = random.choice(wild)
        if random.random() < 0.2:
            found.pop(random.choice(list(found)))
        blocks[name] = _blocks.Block(random.choice((found, found, found, [found], 3, None)))
    return _blocks.pack("state", blocks)


_NAMES = ("positions", "velocities", "box", "parameters", "clock", "connectivity", "tension")
_NAMES += ("viscosity",)


def _check_connectivity(data: bytes) -> None:
    context, force = _context()
    _loaded(lambda: force._restoreConnectivity(context, data))


def _change_connectivity(data: bytes, random: Random) -> bytes:
    """Under a checksum that is right."""
    inner = data[:-8]
    if random.random() < 0.4:
        # The counts are in the head.
        at = random.choice((12, 16, 20, 24, 4, 28))
        wild = (-1, 0, 1, 2, 5, 7, 9, 2**31 - 1, -(2**31), random.randrange(2**30))
        inner = inner[:at] + struct.pack("<i", random.choice(wild)) + inner[at + 4 :]
    else:
        inner = binary(inner, random)
    return inner + struct.pack("<Q", _checksum(inner))


def _checksum(data: bytes) -> int:
    """FNV-1a."""
    found = 0xCBF29CE484222325
    for byte in data:
        found = (found ^ byte) * 0x100000001B3 % 2**64
    return found


def _check_checkpoint(data: bytes) -> None:
    end = _end_of_parameters()
    if data[:end] != _checkpoint()[:end]:
        return
    _loaded(lambda: _context()[0].loadCheckpoint(data))


@cache
def _end_of_parameters() -> int:
    """What comes before is OpenMM's, which believes any number of parameters that it says."""
    data = _checkpoint()
    names = [name.encode() for name in _context()[0].getParameters()]
    return max(data.rfind(name) + len(name) + 8 for name in names)


def _change_checkpoint(data: bytes, random: Random) -> bytes:
    start = _end_of_parameters()
    saved = _connectivity()
    at = data.find(saved[:20])
    if at >= 0 and random.random() < 0.4:
        changed = _change_connectivity(data[at : at + len(saved)], random)
        size = struct.pack("<Q", len(changed))
        return data[: at - 8] + size + changed + data[at + len(saved) :]
    if random.random() < 0.5:
        # What this platform adds is at the end.
        start = max(start, len(data) - len(saved) - 700)
    return data[:start] + binary(data[start:], random)


DOORS = [
    Door("saved", lambda: [_file()], _check_file, _change_file),
    Door("connectivity", lambda: [_connectivity()], _check_connectivity, _change_connectivity),
    Door("checkpoint", lambda: [_checkpoint()], _check_checkpoint, _change_checkpoint),
]
