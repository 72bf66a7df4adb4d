"""TriangleHeightForce; .ci/forces.py writes this file, from the header of C++."""

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
class TriangleHeightForce(MembraneForce):
    """Keeps triangles from degenerating by a repulsion at small heights:

        E = sum over triangles, sum over their three heights h < 2^(1/4) d of
            epsilon [ (d/h)^8 - (d/h)^4 + 1/4 ]

    The auxiliary potential of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301. Energy and force go to zero at h = 2^(1/4) d.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, minHeight: Scalar, epsilon: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        minHeight : float or Quantity
            The height d below which the repulsion is strong, nm, zero or above.
        epsilon : float or Quantity
            The strength, kJ/mol, zero or above.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, minHeight=minHeight, epsilon=epsilon)

    def getMinHeight(self) -> float:
        """Get the height d, nm."""
        return _forces.TriangleHeightForce_getMinHeight(self)

    def setMinHeight(self, minHeight: Scalar) -> None:
        """Set the height d, nm, zero or above."""
        _forces.TriangleHeightForce_setMinHeight(self, number(self, "minHeight", minHeight))

    def getEpsilon(self) -> float:
        """Get the strength epsilon, kJ/mol."""
        return _forces.TriangleHeightForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength epsilon, kJ/mol, zero or above."""
        _forces.TriangleHeightForce_setEpsilon(self, number(self, "epsilon", epsilon))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.TriangleHeightForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> TriangleHeightForce:
        """The same force as an object of this class."""
        return own(_forces.TriangleHeightForce_cast(force), force)
