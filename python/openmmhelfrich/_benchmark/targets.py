"""What is raced: vesicles of growing size, OpenMM's platforms, its integrators."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import openmm

from .. import platforms
from ..mesh import Mesh

__all__ = ["INTEGRATORS", "TIME_STEP", "Target", "empty_system", "sphere", "start", "targets"]

TIME_STEP = 0.1  # ps
TEMPERATURE = 300.0  # K
FRICTION = 0.01  # 1/ps
# Radius of the sphere per part of the icosahedron's side, nm: 1000 nm at N = 1002. Larger meshes
# keep the size of their triangles.
RADIUS_PER_PART = 100.0

INTEGRATORS: dict[str, Callable[[], openmm.Integrator]] = {
    "Verlet": lambda: openmm.VerletIntegrator(TIME_STEP),
    "LangevinMiddle": lambda: openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, TIME_STEP),
    "Brownian": lambda: openmm.BrownianIntegrator(TEMPERATURE, FRICTION, TIME_STEP),
}


@dataclass(frozen=True)
class Target:
    """A platform with its properties, and what tables call it."""

    label: str
    platform: str
    properties: dict[str, str] = field(default_factory=dict, hash=False)


def targets(names: Sequence[str] | None = None) -> tuple[list[Target], dict[str, str]]:
    """The platforms that this OpenMM has and that start, and those that do not, with the reason.

    The platform ``Helfrich`` comes once with one thread and once with all.

    Parameters
    ----------
    names : sequence of str, optional
        Platforms to look for. Default: all that OpenMM has.

    Returns
    -------
    list of Target
        Those that can be used.
    dict of str
        For each of the others what it said.
    """
    present = platforms.names()
    found, failed = [], {}
    for name in present if names is None else names:
        if name not in present:
            failed[name] = f"this OpenMM has {', '.join(present)}"
            continue
        reason = _why_not(name)
        if reason is not None:
            failed[name] = reason
        elif name == "Helfrich":
            threads = dict.fromkeys([1, os.cpu_count() or 1])
            found += [
                Target(f"{name}, {n} thread{'s' * (n > 1)}", name, {"Threads": str(n)})
                for n in threads
            ]
        elif "Precision" in openmm.Platform.getPlatformByName(name).getPropertyNames():
            found.append(Target(f"{name} in single precision", name, {"Precision": "single"}))
        else:
            found.append(Target(name, name))
    return found, failed


def _why_not(name: str) -> str | None:
    """What keeps a platform from simulating one particle; None if nothing does."""
    system = openmm.System()
    system.addParticle(1)
    try:
        platform = openmm.Platform.getPlatformByName(name)
        openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
    except openmm.OpenMMException as reason:
        return str(reason)
    return None


def sphere(n: int) -> Mesh:
    """An icosphere of 10 n² + 2 vertices, with triangles of always the same size."""
    return Mesh.icosphere(n, RADIUS_PER_PART * n)


def empty_system(vesicle) -> openmm.System:
    """The particles of a vesicle without any force: its step is what OpenMM takes for itself."""
    system = openmm.System()
    for _ in range(vesicle.mesh.num_vertices):
        system.addParticle(vesicle.mass)
    return system


def start(
    system: openmm.System, vesicle, integrator: str, target: Target, positions=None
) -> openmm.Context:
    """A Context with the positions of a vesicle and velocities at 300 K.

    Parameters
    ----------
    system : openmm.System
        With one particle for each vertex.
    vesicle : Vesicle
    integrator : str
        One of `INTEGRATORS`.
    target : Target
    positions : array_like, optional
        Others than those of the mesh, if the System has more particles, nm.

    Raises
    ------
    openmm.OpenMMException
        If the platform cannot run the System.
    """
    made = INTEGRATORS[integrator]()
    if hasattr(made, "setRandomNumberSeed"):
        made.setRandomNumberSeed(1)
    platform = openmm.Platform.getPlatformByName(target.platform)
    context = openmm.Context(system, made, platform, target.properties)
    context.setPositions(vesicle.mesh.vertices if positions is None else positions)
    context.setVelocitiesToTemperature(TEMPERATURE, 1)
    return context
