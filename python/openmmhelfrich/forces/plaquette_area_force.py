"""PlaquetteAreaForce; .ci/forces.py writes this file, from the header of C++."""

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
class PlaquetteAreaForce(MembraneForce):
    """Keeps the plaquettes of all N vertices alike:

        E = 1/2 k sum_i (N a_i / A0 - 1)^2

    with a_i the barycentric area of vertex i, a third of the area of its triangles.

    Source: equation (20) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301, with k = (3/2) kB T.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, stiffness: Scalar, target: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        stiffness : float or Quantity
            The stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above.
        target : float or Quantity
            The target A0 of the total area, nm^2, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, stiffness=stiffness, target=target)

    def getStiffness(self) -> float:
        """Get the stiffness k, (3/2) kB T in the paper, kJ/mol."""
        return _forces.PlaquetteAreaForce_getStiffness(self)

    def setStiffness(self, stiffness: Scalar) -> None:
        """Set the stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above."""
        _forces.PlaquetteAreaForce_setStiffness(self, number(self, "stiffness", stiffness))

    def getTarget(self) -> float:
        """Get the target A0 of the total area, nm^2."""
        return _forces.PlaquetteAreaForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target A0 of the total area, nm^2, above zero."""
        _forces.PlaquetteAreaForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.PlaquetteAreaForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> PlaquetteAreaForce:
        """The same force as an object of this class."""
        return own(_forces.PlaquetteAreaForce_cast(force), force)
