"""The vesicle of the tests of native evaluation, and its Contexts."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
from platforms import Target


def vesicle(num_vertices: int = 252) -> tuple[helfrich.Mesh, list[mm.Force]]:
    """A vesicle with one force for each kind of element."""
    mesh = helfrich.Mesh.random_sphere(num_vertices, radius=100.0, seed=1)
    return mesh, forces_of(mesh)


def forces_of(mesh: helfrich.Mesh, triangles=None, offset: int = 0) -> list[mm.Force]:
    """The forces of that vesicle, of other triangles if some are given."""
    triangles = mesh.triangles if triangles is None else triangles
    height = 0.4 * float(np.sqrt(mesh.area / len(mesh.triangles)))
    return [
        helfrich.BendingForce(triangles, 50, offset=offset),
        helfrich.SurfaceAreaForce(triangles, 10, mesh.area, offset=offset),
        helfrich.EnclosedVolumeForce(triangles, 1, 0.9 * mesh.volume, offset=offset),
        helfrich.TriangleHeightForce(triangles, height, 10, offset=offset),
    ]


def context_of(target: Target, system: mm.System, forces, integrator: mm.Integrator) -> mm.Context:
    """A Context of a System with some forces, which the target's backend computes."""
    for force in forces:
        if target.backend:
            force.setBackend(target.backend)
        system.addForce(force)
    return target.context(system, integrator)


def system_of(count: int, mass: float = 50.0) -> mm.System:
    """A System of particles."""
    system = mm.System()
    for _ in range(count):
        system.addParticle(mass)
    return system
