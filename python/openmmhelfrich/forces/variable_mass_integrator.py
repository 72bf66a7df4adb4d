"""VariableMassIntegrator; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._movers import Masses
from .._proxies import number, proxy
from .._types import Scalar

if TYPE_CHECKING:
    pass


@proxy
class VariableMassIntegrator(Masses, openmm.Integrator):
    """What VariableMassVerletIntegrator and VariableMassLangevinIntegrator have in common: the
    masses of vertices follow the areas of their plaquettes.
    """

    def getDensity(self) -> float:
        """Get the mass per area of surfaces, amu/nm^2, or 0 if each surface keeps its mass."""
        return _forces.VariableMassIntegrator_getDensity(self)

    def setDensity(self, density: Scalar) -> None:
        """Set the mass per area of surfaces, amu/nm^2, for Contexts that are made from now on: a
        vertex has the mass density times its area.

        With 0 each connected surface keeps the mass M that its vertices have in the System
        together, and a vertex has M times its share of the area.
        """
        _forces.VariableMassIntegrator_setDensity(self, number(self, "density", density))

    def step(self, steps: int) -> None:
        """Advance a simulation through time by taking a series of time steps.

        Parameters
        ----------
        steps : int
            The number of time steps to take.
        """
        _forces.VariableMassIntegrator_step(self, steps)

    def getTypeName(self) -> str:
        """Get the name of the class, as messages and XML have it."""
        return _forces.VariableMassIntegrator_getTypeName(self)
