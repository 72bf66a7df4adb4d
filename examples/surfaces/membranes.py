"""What the scripts of this folder share: Systems of a mesh, and derivatives by the box."""

import sys
from pathlib import Path

import numpy as np
import openmm
from openmm import unit

FOLDER = "surfaces"
KBT = 8.31446261815324e-3 * 300.0
"""kBT at 300 K, kJ/mol."""
TEMPERATURE = 300.0  # K

sys.path.append(str(Path(__file__).resolve().parents[1] / "flips"))


def system_of(mesh, forces, mass=50.0, others=0):
    """A System of the vertices of a mesh, in its box, and further particles, with forces.

    Parameters
    ----------
    mesh : Mesh
    forces : iterable of openmm.Force
    mass : float
        Of a vertex, amu.
    others : int
        Particles behind the vertices, of mass 0: they stay where they are.
    """
    system = openmm.System()
    if mesh.box is not None:
        system.setDefaultPeriodicBoxVectors(*mesh.box)
    for each in [mass] * mesh.num_vertices + [0.0] * others:
        system.addParticle(each)
    for force in forces:
        system.addForce(force)
    return system


def context_of(mesh, forces, integrator=None, mass=50.0, others=()):
    """A Context of a mesh on one thread of platform Helfrich, at the positions of the mesh.

    `others` are positions of further particles that do not move, shape (count, 3), nm.
    """
    integrator = integrator or openmm.VerletIntegrator(1e-3)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(
        system_of(mesh, forces, mass, len(others)), integrator, platform, {"Threads": "1"}
    )
    context.setPositions(np.concatenate([mesh.vertices, np.reshape(others, (-1, 3))]))
    return context


def positions_of(context):
    """Positions, shape (num_particles, 3), nm."""
    state = context.getState(positions=True)
    return state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def box_of(context):
    """Box vectors, shape (3, 3), nm."""
    return context.getState().getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)


def energy_of(context, groups=-1):
    """Potential energy, kJ/mol."""
    state = context.getState(energy=True, groups=groups)
    return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)


def strained(context, strain):
    """Set box and positions to those of a homogeneous strain, x → (1 + ε) x along each axis.

    Parameters
    ----------
    context : openmm.Context
    strain : array_like
        ε along x, y and z.
    """
    factors = 1 + np.asarray(strain)
    positions, box = positions_of(context), box_of(context)
    context.setPeriodicBoxVectors(*(box * factors))
    context.setPositions(positions * factors)


def strain_derivative(context, axis, step=1e-5):
    """dE/dε for a strain along one axis, kJ/mol, by a central difference.

    What `openmmhelfrich.virial` has on its diagonal, found in another way.
    """
    positions, box = positions_of(context), box_of(context)
    energies = []
    for sign in (1, -1):
        strained(context, sign * step * np.eye(3)[axis])
        energies.append(energy_of(context))
        context.setPeriodicBoxVectors(*box)
        context.setPositions(positions)
    return (energies[0] - energies[1]) / (2 * step)
