"""The longest time step that a Context can bear where it is now."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import openmm
from openmm import unit

from .._types import Array, Scalar

__all__ = ["stable_time_step"]

_NM = unit.nanometer
_FORCE = unit.kilojoule_per_mole / unit.nanometer
# How far the particle that moves most is moved to see how its force changes, relative to the
# lengths over which energies change: what rounding leaves of the forces is least then.
_DISPLACEMENT = {"double": 1e-5, "single": 1e-2}
# Relative error of the highest eigenvalue; its square root has half of it.
_TOLERANCE = 1e-2


def stable_time_step(context: openmm.Context, friction: Scalar | None = None) -> float:
    """Longest time step with which the present arrangement of particles can be integrated.

    The largest eigenvalue ω² of the Hessian of the energy, weighted by the masses, M^(−1/2) H
    M^(−1/2), is that of the fastest oscillation. Leapfrogs (Verlet, LangevinMiddle) are stable for
    Δt < 2/ω: B. Leimkuhler, C. Matthews, Molecular Dynamics, doi:10.1007/978-3-319-16375-8, section
    2.5. Steps without inertia (Brownian) are stable for Δt < 2 γ/ω². The Hessian is that of all
    forces of the Context, by finite differences along the vectors of a Lanczos iteration, which
    takes some forty evaluations of the forces.

    It is about this moment only. Forces of membranes grow steeply where triangles get thin, so a
    run at temperature meets arrangements that need shorter steps than this one: half of it is
    seldom safe, a tenth mostly is. It is no bound on the errors of a step that is stable.

    Parameters
    ----------
    context : openmm.Context
        With positions. They are as before afterwards.
    friction : float or Quantity, optional
        γ of Brownian steps, 1/ps. Default: steps with inertia.

    Returns
    -------
    float
        ps; infinite if nothing oscillates.

    Raises
    ------
    ValueError
        If the System has constraints, virtual sites, or no particle with a mass.
    openmm.OpenMMException
        If the forces cannot be computed.

    Examples
    --------
    >>> helfrich.stable_time_step(simulation.context)
    """
    if unit.is_quantity(friction):
        friction = friction.value_in_unit(unit.picosecond**-1)
    highest, _ = highest_eigenvalue(context)
    if highest <= 0:
        return math.inf
    return 2 / math.sqrt(highest) if friction is None else 2 * friction / highest


def highest_eigenvalue(context: Any) -> tuple[float, int]:
    """ω², 1/ps², of the fastest oscillation, and the particle that it moves most."""
    # Imported here, because it takes a fifth of a second.
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    masses = _masses(context.getSystem())
    moving = masses > 0
    weights = 1 / np.sqrt(masses[moving])[:, None]
    state = context.getState(getPositions=True)
    positions = np.array(state.getPositions(asNumpy=True).value_in_unit(_NM))
    step = _step(context, positions[moving])

    def forces(displaced: Array) -> Array:
        moved = positions.copy()
        moved[moving] += displaced
        context.setPositions(moved)
        found = context.getState(getForces=True).getForces(asNumpy=True)
        return np.array(found.value_in_unit(_FORCE))[moving]

    def times_hessian(vector: Array) -> Array:
        along = vector.reshape(-1, 3) * weights
        size = step / np.abs(along).max()
        change = forces(-size * along) - forces(size * along)
        return (change * weights / (2 * size)).ravel()

    count = weights.size * 3
    try:
        # From the same vector each time, for the same bits.
        start = np.random.default_rng(1).standard_normal(count)
        operator = LinearOperator((count, count), matvec=times_hessian, dtype=np.float64)
        if count <= 3:
            values, vectors = np.linalg.eigh(operator @ np.eye(count))
        else:
            try:
                values, vectors = eigsh(operator, k=1, which="LA", tol=_TOLERANCE, v0=start)
            except ArpackNoConvergence as reason:
                values, vectors = reason.eigenvalues, reason.eigenvectors
                if not len(values):
                    raise ValueError(
                        "stable_time_step: the highest frequency is not found"
                    ) from None
    finally:
        context.setPositions(positions)
    moves = np.linalg.norm(vectors[:, -1].reshape(-1, 3) * weights, axis=1)
    return float(values[-1]), int(np.flatnonzero(moving)[np.argmax(moves)])


def _masses(system: openmm.System) -> Array:
    count = system.getNumParticles()
    if system.getNumConstraints():
        raise ValueError("stable_time_step: the System has constraints, with which steps differ")
    if any(system.isVirtualSite(i) for i in range(count)):
        raise ValueError("stable_time_step: the System has virtual sites, with which steps differ")
    masses = np.array([system.getParticleMass(i).value_in_unit(unit.dalton) for i in range(count)])
    if not masses.any():
        raise ValueError("stable_time_step: no particle has a mass")
    return masses


def _step(context: openmm.Context, positions: Array) -> float:
    """How far to move, nm: a part of the distance between neighbours in a uniform arrangement."""
    name = context.getPlatform().getName()
    digits = "double" if name in ("Reference", "Helfrich") else "single"
    extent = np.ptp(positions, axis=0).max()
    return _DISPLACEMENT[digits] * max(float(extent), 1.0) / math.sqrt(len(positions))
