"""A Context at a moment: what it takes to go on from there, on the same platform, bit by bit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import openmm

from .forces import (
    MonteCarloBondFlip,
    MonteCarloDomainSwap,
    MonteCarloMembraneTension,
    SurfaceViscosityThermostat,
)

__all__ = ["Snapshot", "all_of", "moving_surfaces", "tensions_of", "thermostats_of"]


@dataclass(frozen=True)
class Snapshot:
    """The state of a Context.

    openmm: OpenMM's checkpoint; connectivity: what is saved of each surface that a mover changes,
    which OpenMM's checkpoint has on the platform Helfrich only; tension: of what moves the box;
    viscosity: of what makes surfaces viscous.
    """

    openmm: bytes
    connectivity: tuple[bytes, ...] = ()
    tension: tuple[bytes, ...] = ()
    viscosity: tuple[bytes, ...] = ()

    @classmethod
    def take(cls, context: openmm.Context) -> Snapshot:
        """The present state."""
        return cls(
            context.createCheckpoint(),
            tuple(mover._saveConnectivity(context) for mover in moving_surfaces(context)),
            tuple(mover._saveState(context) for mover in tensions_of(context)),
            tuple(force._saveState(context) for force in thermostats_of(context)),
        )

    def restore(self, context: openmm.Context) -> None:
        """Bring a Context of the same System and platform to this state.

        Raises
        ------
        openmm.OpenMMException
            If it is the state of another System or platform.
        ValueError
            If there are other movers.
        """
        context.loadCheckpoint(self.openmm)
        for mover, surface in zip(moving_surfaces(context), self.connectivity, strict=True):
            mover._restoreConnectivity(context, surface)
        for mover, moves in zip(tensions_of(context), self.tension, strict=True):
            mover._restoreState(context, moves)
        for force, sweeps in zip(thermostats_of(context), self.viscosity, strict=True):
            force._restoreState(context, sweeps)


def moving_surfaces(context: openmm.Context) -> list[Any]:
    """A mover on each surface that has one: those that flip bonds, then those that swap only."""
    flips = all_of(context, MonteCarloBondFlip)
    flipping = {mover._triangleBuffer() for mover in flips}
    swaps = {
        mover._triangleBuffer(): mover
        for mover in all_of(context, MonteCarloDomainSwap)
        if mover._triangleBuffer() not in flipping
    }
    return [*flips, *swaps.values()]


def tensions_of(context: openmm.Context) -> list[MonteCarloMembraneTension]:
    """What changes the box of a Context, in its order."""
    return all_of(context, MonteCarloMembraneTension)


def thermostats_of(context: openmm.Context) -> list[SurfaceViscosityThermostat]:
    """What makes surfaces of a Context viscous, in its order."""
    return all_of(context, SurfaceViscosityThermostat)


def all_of(context: openmm.Context, cls: type) -> list[Any]:
    """The forces of a class in a Context, in its order."""
    return [cls.cast(force) for force in context.getSystem().getForces() if cls.isinstance(force)]
