"""A small vesicle of three components, for the tests of MonteCarloDomainSwap."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
from flowing import TEMPERATURE, langevin, start, system_of
from platforms import REFERENCE, Target

#: What vertices of each domain are.
TABLE = {
    -1: {"rigidity": 20.0, "spontaneousCurvature": 0.0, "modulus": -10.0},
    0: {"rigidity": 35.0, "spontaneousCurvature": 0.01, "modulus": -18.0},
    4: {"rigidity": 60.0, "spontaneousCurvature": -0.02, "modulus": -25.0},
}


def domains_of(count: int, seed: int = 8) -> np.ndarray:
    return np.random.default_rng(seed).choice(list(TABLE), count)


def forces_of(mesh: helfrich.Mesh, domains: np.ndarray, backend: str = "") -> list[mm.Force]:
    """Terms that depend on what the vertices are, and of all other kinds."""
    values = helfrich.values_of_domains(domains, TABLE)
    forces = [
        helfrich.BendingForce(mesh, values["rigidity"], values["spontaneousCurvature"]),
        helfrich.LineTensionForce(mesh, 0.15, domains),
        helfrich.GaussianCurvatureForce(mesh, values["modulus"]),
        helfrich.SurfaceAreaForce(mesh, 0.5, mesh.area),
        helfrich.EnclosedVolumeForce(mesh, 0.01, 0.95 * mesh.volume),
        helfrich.TriangleHeightForce(mesh, 4.0, 5.0),
        helfrich.DihedralForce(mesh, 3.0),
        helfrich.SkalakForce(mesh, 0.02, 0.02, mesh),
    ]
    for force in forces:
        force.setBackend(backend)
    return forces


def swap_of(mesh: helfrich.Mesh, seed: int = 7, **arguments) -> helfrich.MonteCarloDomainSwap:
    values = {"temperature": TEMPERATURE, "frequency": 2, "attemptsPerEdge": 0.3} | arguments
    mover = helfrich.MonteCarloDomainSwap(mesh, **values)
    mover.setRandomNumberSeed(seed)
    return mover


def mixing(
    target: Target = REFERENCE,
    integrator: mm.Integrator | None = None,
    more: list[mm.Force] | None = None,
    mass: float = 50.0,
    **arguments,
) -> tuple[mm.Context, helfrich.MonteCarloDomainSwap]:
    """A Context in which vertices exchange places, and what lets them."""
    mesh = start()
    mover = swap_of(mesh, **arguments)
    forces = forces_of(mesh, domains_of(mesh.num_vertices), target.backend)
    system = system_of(*forces, mover, *(more or []), mass=mass)
    context = target.context(system, integrator or langevin())
    context.setPositions(mesh.vertices)
    return context, mover


def force_in(context: mm.Context, cls: type):
    """The force of a class in a Context's System."""
    found = [force for force in context.getSystem().getForces() if cls.isinstance(force)]
    return cls.cast(found[0])


def bits(context: mm.Context) -> tuple[bytes, bytes, bytes, bytes]:
    """Positions, velocities, connectivity and permutation to the last bit."""
    state = context.getState(getPositions=True, getVelocities=True)
    force = force_in(context, helfrich.BendingForce)
    return (
        state.getPositions(asNumpy=True)._value.tobytes(),
        state.getVelocities(asNumpy=True)._value.tobytes(),
        force.getTrianglesInContext(context).tobytes(),
        force.getPermutationInContext(context).tobytes(),
    )
