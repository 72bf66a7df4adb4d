"""What has come of random moves, what saves it, and the masses of an integrator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _forces
from ._proxies import Copies
from ._types import Doubles
from ._values import capitalised

if TYPE_CHECKING:
    import openmm

__all__ = ["Flips", "Masses", "Swaps", "Tension", "Viscosity"]


class Flips:
    """The statistics of MonteCarloBondFlip."""

    def getStatistics(self, context: openmm.Context) -> dict[str, Any]:
        """What has come of the flips that were tried in a Context since it was made.

        Parameters
        ----------
        context : openmm.Context

        Returns
        -------
        dict
            ``attempts``, and those ``accepted``; ``refused``, a dict of those refused by the first
            of these that they failed: ``border`` (the edge has one triangle only), ``degree``,
            ``length``, ``shape`` (a triangle would have no area), ``energy`` and ``edge`` (the new
            edge was there already); ``acceptance``, accepted over attempts; ``time``, the time that
            has been simulated, ps; ``rate``, accepted for each edge and ps; ``demonEnergy``,
            kJ/mol. Ratios are NaN as long as there is nothing to divide by.
        """
        return _statistics(self, context, "border", "degree", "length", "shape", "energy", "edge")


class Swaps:
    """The statistics of MonteCarloDomainSwap."""

    def getStatistics(self, context: openmm.Context) -> dict[str, Any]:
        """What has come of the exchanges that were tried in a Context since it was made.

        Parameters
        ----------
        context : openmm.Context

        Returns
        -------
        dict
            ``attempts``, and those ``accepted``; ``refused``, a dict of those refused by ``kind``
            (both ends of the edge were alike) or by ``energy``; ``acceptance``, accepted over
            attempts; ``time``, the time that has been simulated, ps; ``rate``, accepted for each
            edge and ps; ``demonEnergy``, kJ/mol. Ratios are NaN as long as there is nothing to
            divide by.
        """
        return _statistics(self, context, "kind", "energy")


def _statistics(mover, context, *reasons: str) -> dict[str, Any]:
    """Counts are integers, and refusals a dict by their reasons."""
    found = _forces._SurfaceMover__getStatistics(mover, context)
    statistics: dict[str, Any] = {name: int(found[name]) for name in ("attempts", "accepted")}
    statistics["refused"] = {
        reason: int(found["refusedBy" + capitalised(reason)]) for reason in reasons
    }
    return statistics | {
        name: found[name] for name in ("acceptance", "time", "rate", "demonEnergy")
    }


class Tension(Copies):
    """The statistics and states of MonteCarloMembraneTension."""

    def getStatistics(self, context: openmm.Context) -> dict[str, Any]:
        """What has come of the moves that were tried in a Context since it was made.

        Parameters
        ----------
        context : openmm.Context

        Returns
        -------
        dict
            ``attempts``, and those ``accepted``; ``acceptance``, accepted over attempts, NaN before
            the first; ``adapting``, whether the width is still being adapted; ``bodies``, how many
            are scaled, 0 before the first; ``width``, how far a move goes at most: nm² for
            XYIsotropic, nm for ZOnly, a change of ln L_x for XYConstantArea. XYIndependent has
            ``widthX`` and ``widthY``, nm. A width is 0 before the first move.
        """
        found = _forces.MonteCarloMembraneTension__getStatistics(self, context)
        statistics = {name: int(found.pop(name)) for name in ("attempts", "accepted", "bodies")}
        return statistics | {"adapting": bool(found.pop("adapting"))} | found

    def _saveState(self, context) -> bytes:
        return _forces.MonteCarloMembraneTension__saveState(self, context)

    def _restoreState(self, context, saved: bytes) -> None:
        _forces.MonteCarloMembraneTension__restoreState(self, context, saved)


class Viscosity:
    """The states of SurfaceViscosityThermostat."""

    def _saveState(self, context) -> bytes:
        return _forces.SurfaceViscosityThermostat__saveState(self, context)

    def _restoreState(self, context, saved: bytes) -> None:
        _forces.SurfaceViscosityThermostat__restoreState(self, context, saved)


class Masses(Copies):
    """The masses of VariableMassIntegrator."""

    def getMasses(self) -> Doubles:
        """The masses of all particles at the present positions of the Context.

        ``Context.setVelocitiesToTemperature`` draws momenta for these masses, and the kinetic
        energy of a State has them.

        Returns
        -------
        ndarray, shape (num_particles,)
            amu; 0 for particles that do not move.
        """
        return np.frombuffer(_forces.VariableMassIntegrator__getMasses(self), np.float64).copy()
