"""TriangleAreaForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import elements, number, own, proxy, start
from .._types import Scalar, Values
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class TriangleAreaForce(MembraneForce):
    """Keeps the area a of each triangle near a target a0:

        E = sum over triangles of 1/2 kA (a - a0)^2 / a0

    which gives a membrane local resistance to changes of area, as VCM's SurfaceConstraint L. The
    target can be one value or one for each triangle. Compare SurfaceAreaForce, equation (1) of
    Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301, which keeps the sum.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        modulus: Scalar,
        target: Scalar | ArrayLike,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity
            The area modulus kA, kJ/mol/nm^2, zero or above.
        target : float or Quantity, or one for each element
            The target area a0 of each triangle, nm^2, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the area modulus kA, kJ/mol/nm^2."""
        return _forces.TriangleAreaForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the area modulus kA, kJ/mol/nm^2, zero or above."""
        _forces.TriangleAreaForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target area a0 of each triangle, nm^2."""
        return _forces.TriangleAreaForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target area a0 of each triangle, nm^2, above zero.

        Values of single triangles are given up.
        """
        _forces.TriangleAreaForce_setTarget(self, number(self, "target", target))

    def getTriangleTargets(self) -> tuple[float, ...]:
        """Get the target area of each triangle, nm^2; empty if all have the same."""
        return _forces.TriangleAreaForce_getTriangleTargets(self)

    def setTriangleTargets(self, values: Values) -> None:
        """Give each triangle its own target area, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each triangle, nm^2; empty to go back to the scalar.
        """
        _forces.TriangleAreaForce_setTriangleTargets(self, elements(self, "target", values))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.TriangleAreaForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> TriangleAreaForce:
        """The same force as an object of this class."""
        return own(_forces.TriangleAreaForce_cast(force), force)
