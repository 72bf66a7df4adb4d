"""Ramps of parameters during a run."""

from __future__ import annotations

from typing import Any

from ._numbers import length, whole_number
from ._types import Scalar
from .forces import TriangleHeightForce

__all__ = ["harden"]


def harden(
    simulation: Any,
    force: TriangleHeightForce,
    min_height: Scalar,
    steps: int,
    increments: int = 100,
) -> None:
    """Raise (or lower) the least triangle height d of a running simulation, slowly.

    A mesh that is hard from the start would push violently where its triangles are still flat. So
    d goes from its present value to the new one in equal increments, spread over the run.

    Parameters
    ----------
    simulation : openmm.app.Simulation
        It runs for `steps` steps.
    force : TriangleHeightForce
        The force, in the simulation's System. If its ``minHeight`` is a Context parameter, that is
        ramped; else the force itself is changed.
    min_height : float or Quantity
        The new d, nm, 0 or more; ``mesh.min_height(softness)`` gives that of a softness Ξ.
    steps : int
        Length of the ramp, time steps, 1 or more.
    increments : int
        Number of increments, 1 or more; at most one a step.

    Raises
    ------
    TypeError
        Another force.
    ValueError
        A height, steps or increments out of range.
    MeshError
        A height that is no length.

    Examples
    --------
    >>> vesicle = Vesicle(mesh, softness=0.037)
    >>> simulation = vesicle.simulation(integrator)
    >>> harden(simulation, vesicle.placement.heights, mesh.min_height(0.59), steps=50_000)
    """
    if not isinstance(force, TriangleHeightForce):
        raise TypeError(f"harden: force needs a TriangleHeightForce, got {type(force).__name__}")
    target = length(min_height, "harden", "min_height")
    if not target >= 0:
        raise ValueError(f"harden: min_height needs 0 nm or more, got {target}")
    steps = whole_number(steps, "harden", "steps", 1)
    increments = whole_number(increments, "harden", "increments", 1)
    context = simulation.context
    parameter = force.getContextParameter("minHeight")
    start = context.getParameter(parameter) if parameter else force.getMinHeight()
    increments = min(increments, steps)
    done = 0
    for increment in range(1, increments + 1):
        # The last one is the target to the last bit.
        share = increment / increments
        value = target if increment == increments else start + share * (target - start)
        if parameter:
            context.setParameter(parameter, value)
        else:
            force.setMinHeight(value)
            force.updateParametersInContext(context)
        wanted = steps * increment // increments
        simulation.step(wanted - done)
        done = wanted
