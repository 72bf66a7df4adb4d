"""The least time of a step of several simulations, measured in turns."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Hashable, Mapping

import openmm
from openmm import unit

__all__ = ["Steps", "fastest"]

# Platforms whose step(n) returns when the steps are done; others work in the background.
_SYNCHRONOUS = ("Reference", "CPU", "Helfrich")


class Steps:
    """Makes steps of one Context: ``steps(count)``.

    Parameters
    ----------
    context : openmm.Context
        With positions.
    """

    def __init__(self, context: openmm.Context):
        self._context = context
        self._integrator = context.getIntegrator()
        self._waits = context.getPlatform().getName() not in _SYNCHRONOUS

    def __call__(self, count: int) -> None:
        self._integrator.step(count)
        if self._waits:
            self._context.getState(positions=True)

    def check(self) -> None:
        """Refuse a simulation that broke down.

        Raises
        ------
        FloatingPointError
            If its energy is not finite: steps of such a run say nothing.
        """
        state = self._context.getState(energy=True)
        total = state.getPotentialEnergy() + state.getKineticEnergy()
        if not math.isfinite(total.value_in_unit(unit.kilojoule_per_mole)):
            raise FloatingPointError(f"the energy is {total} after the steps")


def fastest(
    steppers: Mapping[Hashable, Callable[[int], None]],
    repeats: int,
    seconds: float,
    least: int = 5,
) -> dict[Hashable, float]:
    """Least microseconds per step of each of several simulations.

    Every simulation is run `repeats` times, in turns, so that a slow spell of the machine does not
    hit one side alone; of each the fastest run counts.

    Parameters
    ----------
    steppers : mapping of callable
        Each makes as many steps as it is told.
    repeats : int
        Runs of each.
    seconds : float
        Approximate length of one run, s.
    least : int
        Least number of steps in a run, however long they take.

    Returns
    -------
    dict of float
        µs per step, by the names of `steppers`.
    """
    counts = {name: _steps_in(seconds, least, step) for name, step in steppers.items()}
    best = dict.fromkeys(steppers, math.inf)
    for _ in range(repeats):
        for name, step in steppers.items():
            begin = time.perf_counter()
            step(counts[name])
            cost = (time.perf_counter() - begin) / counts[name]
            best[name] = min(best[name], 1e6 * cost)
    return best


def _steps_in(seconds: float, least: int, step: Callable[[int], None]) -> int:
    """How many steps make a run of about so many seconds, found by longer and longer runs."""
    step(1)
    count = 1
    while True:
        begin = time.perf_counter()
        step(count)
        passed = time.perf_counter() - begin
        if passed > seconds / 20:
            return max(least, int(count * seconds / passed))
        count = max(least, 4 * count)
