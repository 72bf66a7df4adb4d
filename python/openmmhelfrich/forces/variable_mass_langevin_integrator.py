"""VariableMassLangevinIntegrator; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._proxies import make, number, own, proxy, whole
from .._types import Scalar
from .variable_mass_integrator import VariableMassIntegrator

if TYPE_CHECKING:
    pass


@proxy
class VariableMassLangevinIntegrator(VariableMassIntegrator):
    """VariableMassVerletIntegrator in a bath: before and after the leapfrog, momenta take half a
    step of

        dp_i = -gamma p_i dt + sqrt(2 gamma m_i(q) kB T) dW

    at constant positions, which is solved exactly. For small steps positions and momenta have the
    weight exp(-H(p, q) / kB T).

    The random numbers are functions of the seed and the number of the step: the same seed gives the
    same bits on any number of threads. Checkpoints have where they are.
    """

    def __init__(
        self, temperature: Scalar, frictionCoeff: Scalar, stepSize: Scalar, density: Scalar = 0.0
    ) -> None:
        """Make the integrator.

        Parameters
        ----------
        temperature : float or Quantity
            The temperature of the bath, K.
        frictionCoeff : float or Quantity
            Gamma, what couples the momenta to the bath, 1/ps.
        stepSize : float or Quantity
            The step size, ps.
        density : float or Quantity, default: 0.0
            The mass per area, amu/nm^2, or 0 for surfaces of constant mass.
        """
        make(
            self,
            number(self, "temperature", temperature),
            number(self, "frictionCoeff", frictionCoeff),
            number(self, "stepSize", stepSize),
            number(self, "density", density),
        )

    def getTemperature(self) -> float:
        """Get the temperature of the bath, K."""
        return _forces.VariableMassLangevinIntegrator_getTemperature(self)

    def setTemperature(self, temperature: Scalar) -> None:
        """Set the temperature of the bath, K."""
        _forces.VariableMassLangevinIntegrator_setTemperature(
            self, number(self, "temperature", temperature)
        )

    def getFriction(self) -> float:
        """Get what couples the momenta to the bath, 1/ps."""
        return _forces.VariableMassLangevinIntegrator_getFriction(self)

    def setFriction(self, friction: Scalar) -> None:
        """Set what couples the momenta to the bath, 1/ps."""
        _forces.VariableMassLangevinIntegrator_setFriction(self, number(self, "friction", friction))

    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
        return _forces.VariableMassLangevinIntegrator_getRandomNumberSeed(self)

    def setRandomNumberSeed(self, seed: int) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on.

        With 0, the default, each Context gets a seed of its own.
        """
        _forces.VariableMassLangevinIntegrator_setRandomNumberSeed(
            self, whole(self, "randomNumberSeed", seed)
        )

    @staticmethod
    def isinstance(integrator: openmm.Integrator) -> bool:
        """Whether some integrator of OpenMM is of this class."""
        return _forces.VariableMassLangevinIntegrator_isinstance(integrator)

    @staticmethod
    def cast(integrator: openmm.Integrator) -> VariableMassLangevinIntegrator:
        """The same integrator as an object of this class."""
        return own(_forces.VariableMassLangevinIntegrator_cast(integrator), integrator)
