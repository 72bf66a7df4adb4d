"""TriangulatedMover; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import _forces
from .._proxies import number, proxy, whole
from .._types import Scalar
from .triangulated_force import TriangulatedForce

if TYPE_CHECKING:
    pass


@proxy
class _TriangulatedMover(TriangulatedForce):
    """What makes random moves now and then, at the temperature of a bath: what all such classes
    have in common.

    Base is a HelfrichForce.
    """

    def getDefaultTemperature(self) -> float:
        """Get the default temperature, K."""
        return _forces._TriangulatedMover_getDefaultTemperature(self)

    def setDefaultTemperature(self, temperature: Scalar) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
        _forces._TriangulatedMover_setDefaultTemperature(
            self, number(self, "temperature", temperature)
        )

    def getFrequency(self) -> int:
        """Get every how many time steps there are moves."""
        return _forces._TriangulatedMover_getFrequency(self)

    def setFrequency(self, frequency: int) -> None:
        """Set every how many time steps there are moves; 0 for never."""
        _forces._TriangulatedMover_setFrequency(self, whole(self, "frequency", frequency))

    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
        return _forces._TriangulatedMover_getRandomNumberSeed(self)

    def setRandomNumberSeed(self, seed: int) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on.

        The same seed gives the same moves, on any number of threads. With 0, the default, each
        Context gets a seed of its own.
        """
        _forces._TriangulatedMover_setRandomNumberSeed(self, whole(self, "randomNumberSeed", seed))
