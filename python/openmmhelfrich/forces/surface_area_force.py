"""SurfaceAreaForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import number, own, proxy, start
from .._types import Scalar
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class SurfaceAreaForce(MembraneForce):
    """Keeps the total area A of a membrane near a target A0:

        E = 1/2 kA (A - A0)^2 / A0

    Equation (1) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301. A is the sum over all triangles, of all components of the
    surface.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, modulus: Scalar, target: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity
            The area modulus kA, kJ/mol/nm^2, zero or above.
        target : float or Quantity
            The target area A0, nm^2, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the area modulus kA, kJ/mol/nm^2."""
        return _forces.SurfaceAreaForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the area modulus kA, kJ/mol/nm^2, zero or above."""
        _forces.SurfaceAreaForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target area A0, nm^2."""
        return _forces.SurfaceAreaForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target area A0, nm^2, above zero."""
        _forces.SurfaceAreaForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.SurfaceAreaForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceAreaForce:
        """The same force as an object of this class."""
        return own(_forces.SurfaceAreaForce_cast(force), force)
