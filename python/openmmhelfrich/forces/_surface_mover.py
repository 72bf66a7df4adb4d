"""SurfaceMover; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._proxies import constant, number, proxy
from .._types import Scalar
from ._triangulated_mover import _TriangulatedMover

if TYPE_CHECKING:
    pass


@proxy
class _SurfaceMover(_TriangulatedMover):
    """What tries Monte Carlo moves of the edges of a surface now and then, each by the change of
    the energy of all membrane forces on it: what all such classes have in common.
    """

    Canonical = 0
    """A bath of a temperature."""

    Microcanonical = 1
    """A demon, which has no energy when a Context is made.

    The temperature is not used.
    """

    def getAttemptsPerEdge(self) -> float:
        """Get how many moves are tried each time, for each edge."""
        return _forces._SurfaceMover_getAttemptsPerEdge(self)

    def setAttemptsPerEdge(self, attemptsPerEdge: Scalar) -> None:
        """Set how many moves are tried each time, for each edge, from 0 to 1000."""
        _forces._SurfaceMover_setAttemptsPerEdge(
            self, number(self, "attemptsPerEdge", attemptsPerEdge)
        )

    def getEnsemble(self) -> int:
        """Get who pays for moves."""
        return _forces._SurfaceMover_getEnsemble(self)

    def setEnsemble(self, ensemble: int | str) -> None:
        """Set who pays for moves: Canonical, a bath, or Microcanonical, a demon."""
        _forces._SurfaceMover_setEnsemble(self, constant(self, "ensemble", ensemble))

    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy the values of this object to a Context, except for the seed.

        The temperature is a parameter of the Context; changed triangles are refused (use
        Context.reinitialize()).

        Parameters
        ----------
        context : openmm.Context
            The Context to update.
        """
        _forces._SurfaceMover_updateParametersInContext(self, context)

    def usesPeriodicBoundaryConditions(self) -> bool:
        """Positions are taken as they are, without periodic boundary conditions.

        Returns
        -------
        bool
            False.
        """
        return _forces._SurfaceMover_usesPeriodicBoundaryConditions(self)
