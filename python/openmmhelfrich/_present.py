"""Triangles as they are now in a Context, where bonds flip or were connected by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import openmm
from openmm import Context, unit

from ._types import Array
from .forces import (
    MembraneForce,
    MonteCarloBondFlip,
    MonteCarloDomainSwap,
    MonteCarloMembraneTension,
    SurfaceViscosityThermostat,
)

__all__ = [
    "context_of",
    "has_energy",
    "is_periodic",
    "present_box",
    "present_triangles",
    "surfaces_of",
]

_MOVERS = (MonteCarloBondFlip, MonteCarloDomainSwap)
_CLASSES = [*_MOVERS, *MembraneForce.__subclasses__(), SurfaceViscosityThermostat]
#: What is a Force to OpenMM, and has no energy.
_WITHOUT_ENERGY = (*_MOVERS, MonteCarloMembraneTension, SurfaceViscosityThermostat)
_OPENMM_WITHOUT_ENERGY = (
    openmm.AndersenThermostat,
    openmm.CMMotionRemover,
    openmm.MonteCarloAnisotropicBarostat,
    openmm.MonteCarloBarostat,
    openmm.MonteCarloFlexibleBarostat,
    openmm.MonteCarloMembraneBarostat,
    openmm.RPMDMonteCarloBarostat,
)


def context_of(where: str, given) -> Context:
    """A Context, or that of a Simulation; TypeError for anything else."""
    found = getattr(given, "context", given)
    if not isinstance(found, Context):
        raise TypeError(
            f"{where}: context needs an openmm.Context, or a Simulation that has one, got "
            f"{type(given).__name__}"
        )
    return found


def has_energy(force: openmm.Force) -> bool:
    """Whether a force of a System has an energy: movers, thermostats and barostats have none."""
    if isinstance(force, _OPENMM_WITHOUT_ENERGY):
        return False
    return not any(cls.isinstance(force) for cls in _WITHOUT_ENERGY)


def is_periodic(context, force) -> bool:
    """Whether the surface of a membrane force or mover lives in the periodic box of the Context."""
    if isinstance(force, MembraneForce):
        return force.usesPeriodicBoundaryConditions()
    corners = force._triangleBuffer()
    for plain in context.getSystem().getForces():
        for cls in MembraneForce.__subclasses__():
            if cls.isinstance(plain):
                other = cls.cast(plain)
                if other._triangleBuffer() == corners:
                    return other.usesPeriodicBoundaryConditions()
    return False


def present_box(context, state, particles: Array) -> Array | None:
    """The box of a State, shape (3, 3), nm, if a surface on these particles lives in it."""
    for force in surfaces_of(context):
        corners = np.frombuffer(force._triangleBuffer(), dtype=np.intc)
        if np.isin(corners, particles).any() and is_periodic(context, force):
            return state.getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)
    return None


def surfaces_of(context) -> list[Any]:
    """One force on each of the triangulated surfaces of a Context, in their order.

    It is the MonteCarloBondFlip of a surface where there is one.
    """
    found = {}
    for plain in context.getSystem().getForces():
        for cls in _CLASSES:
            if cls.isinstance(plain):
                force = cls.cast(plain)
                corners = force._triangleBuffer()
                if cls is MonteCarloBondFlip:
                    found[corners] = force
                found.setdefault(corners, force)
                break
    return list(found.values())


def present_triangles(context, corners: Array) -> Array:
    """What has become of triangles with which a Context began.

    It does not matter what has changed them: a MonteCarloBondFlip, or `setTrianglesInContext` of
    any force.

    Parameters
    ----------
    context : openmm.Context
    corners : ndarray of int
        Particle indices, shape (num_triangles, 3): of one surface or several, each triangle
        beginning with the corner that it begins with in the force.

    Returns
    -------
    ndarray of int
        Shape (num_triangles, 3). A triangle keeps its place when an edge of it flips.

    Raises
    ------
    ValueError
        If bonds between these particles flip, or have been changed, but on other triangles.
    """
    present = corners
    rows = None
    for force in surfaces_of(context):
        initial = np.frombuffer(force._triangleBuffer(), dtype=np.intc).reshape(-1, 3)
        if not np.isin(initial, corners).any():
            continue
        now = force.getTrianglesInContext(context)
        flips = isinstance(force, MonteCarloBondFlip)
        if not flips and np.array_equal(now, initial):
            continue
        if rows is None:
            present = corners.copy()
            rows = {tuple(row): place for place, row in enumerate(corners.tolist())}
        places = np.array([rows.get(tuple(row), -1) for row in initial.tolist()])
        # A force of contacts may have the triangles of other surfaces too.
        lost = (places < 0) & np.isin(initial, corners).any(axis=1)
        if lost.any():
            does = "flips bonds" if flips else "acts, which have been changed"
            raise ValueError(
                f"the triangles are not those on which {force.getName()} {does}: its triangle "
                f"{np.flatnonzero(lost)[0]} is not among them; give the mesh that the forces have"
            )
        present[places[places >= 0]] = now[places >= 0]
    return present
