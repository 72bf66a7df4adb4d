"""How long a simulation runs before it fails."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import openmm
from openmm import unit

from .._numbers import positive_number, whole_number
from .._types import Scalar

_ENERGY = unit.kilojoule_per_mole
_VARIABLE = (openmm.VariableVerletIntegrator, openmm.VariableLangevinIntegrator)


class Lifetime(NamedTuple):
    """What `time_to_failure` returns."""

    time: float
    """Time that was simulated until the failure, or in all, ps."""
    steps: int
    """The same in steps."""
    failed: bool
    """Whether it failed; if not, its lifetime is longer than `time`."""
    reason: str
    """What went wrong; empty if nothing did."""


def time_to_failure(
    simulation: openmm.app.Simulation,
    max_time: Scalar,
    interval: int = 100,
    max_heating: float = 10.0,
    check: Callable[..., Any] | None = None,
) -> Lifetime:
    """Run a Simulation until it fails, or for a given time.

    A run has failed when

    - the integrator, a force or a reporter raises an error: a position is not finite, a triangle
      has lost its area, an energy overflows;
    - a position or an energy is not finite;
    - its kinetic energy exceeds `max_heating` times that at the start of this call (or, without
      velocities, ½ kBT at 300 K for each of the 3N degrees of freedom): with Newton's equations the
      heat can only come from the integrator;
    - `check` says so.

    The state is looked at every `interval` steps, so that failures of the last three kinds are
    found up to that much too late; errors are found at the step at which they happen.

    Parameters
    ----------
    simulation : openmm.app.Simulation
        With positions, an integrator of fixed step size and, for Verlet, velocities. It is at the
        end of the run afterwards, and of no more use if that failed.
    max_time : float or Quantity
        Time after which the run ends without failure, ps.
    interval : int
        Steps between looks at the state, 1 or more.
    max_heating : float
        Bound of the kinetic energy, above 1.
    check : callable, optional
        check(positions) with positions of shape (num_particles, 3), nm. It returns what is wrong, a
        str, or something false. For instance, that the mesh has turned inside out::

            lambda x: shape(x, mesh).volume < 0 and "the volume is negative"

    Returns
    -------
    Lifetime
        The time, and why it ended.

    Raises
    ------
    ValueError
        A number is out of range, the integrator has variable time steps, or the simulation is out
        of order before its first step.
    """
    if unit.is_quantity(max_time):
        max_time = max_time.value_in_unit(unit.picosecond)
    max_time = positive_number(max_time, "time_to_failure", "max_time")
    interval = whole_number(interval, "time_to_failure", "interval", 1)
    if not max_heating > 1:
        raise ValueError(f"time_to_failure: max_heating needs more than 1, got {max_heating}")
    context, step_size = simulation.context, _step_size(simulation.integrator)
    total = int(np.ceil(max_time / step_size - 1e-9))
    began = context.getTime().value_in_unit(unit.picosecond)

    kinetic, wrong = _look(context, np.inf, check)
    if wrong:
        raise ValueError(f"time_to_failure: it is out of order before its first step: {wrong}")
    if kinetic == 0:
        particles = context.getSystem().getNumParticles()
        kinetic = 1.5 * particles * (unit.MOLAR_GAS_CONSTANT_R * 300 * unit.kelvin) / _ENERGY
    bound = max_heating * kinetic

    done = 0
    while done < total:
        count = min(interval, total - done)
        try:
            simulation.step(count)
            wrong = _look(context, bound, check)[1]
        except (openmm.OpenMMException, ValueError) as reason:
            # Time goes on with each step, so it says at which one the error came.
            wrong = str(reason)
            passed = context.getTime().value_in_unit(unit.picosecond) - began
            steps = int(np.clip(round(passed / step_size), done, done + count))
            return Lifetime(steps * step_size, steps, True, wrong)
        done += count
        if wrong:
            return Lifetime(done * step_size, done, True, wrong)
    return Lifetime(done * step_size, done, False, "")


def _step_size(integrator):
    """The length of all time steps, ps."""
    name = type(integrator).__name__
    if isinstance(integrator, _VARIABLE):
        raise ValueError(
            f"time_to_failure: needs time steps of one length, but those of {name} vary with the "
            "forces; use an integrator of fixed step size"
        )
    step_size = integrator.getStepSize().value_in_unit(unit.picosecond)
    if not step_size > 0:
        raise ValueError(
            f"time_to_failure: the step size of {name} is {step_size} ps; set a positive one"
        )
    return step_size


def _look(context, bound, check):
    """The kinetic energy, kJ/mol, and what is wrong with the state."""
    state = context.getState(getPositions=True, getEnergy=True)
    positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    kinetic = state.getKineticEnergy().value_in_unit(_ENERGY)
    potential = state.getPotentialEnergy().value_in_unit(_ENERGY)
    if not np.isfinite(positions).all():
        vertex = np.argwhere(~np.isfinite(positions))[0][0]
        return kinetic, f"the position of particle {vertex} is not finite"
    for name, energy in (("kinetic", kinetic), ("potential", potential)):
        if not np.isfinite(energy):
            return kinetic, f"the {name} energy is {energy} kJ/mol"
    if kinetic > bound:
        return kinetic, f"the kinetic energy is {kinetic:.6g} kJ/mol, above {bound:.6g}"
    return kinetic, (check(positions) if check is not None else "") or ""
