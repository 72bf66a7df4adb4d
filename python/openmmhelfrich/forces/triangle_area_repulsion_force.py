"""TriangleAreaRepulsionForce; .ci/forces.py writes this file, from the header of C++."""

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
class TriangleAreaRepulsionForce(MembraneForce):
    """Keeps triangles from vanishing by a repulsion at small areas:

        E = sum over triangles with area a < 2^(1/4) a_m of epsilon [ (a_m/a)^8 - (a_m/a)^4 + 1/4 ]

    The form of TriangleHeightForce on areas, VCM's SurfaceConstraint WCA and GWCA; energy and force
    go to zero at the cutoff, where VCM's are discontinuous. A triangle can still degenerate to a
    long needle; the paper (Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301) prefers heights.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, minArea: Scalar, epsilon: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        minArea : float or Quantity
            The area a_m below which the repulsion is strong, nm^2, zero or above.
        epsilon : float or Quantity
            The strength, kJ/mol, zero or above.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, minArea=minArea, epsilon=epsilon)

    def getMinArea(self) -> float:
        """Get the area a_m below which the repulsion is strong, nm^2."""
        return _forces.TriangleAreaRepulsionForce_getMinArea(self)

    def setMinArea(self, minArea: Scalar) -> None:
        """Set the area a_m below which the repulsion is strong, nm^2, zero or above."""
        _forces.TriangleAreaRepulsionForce_setMinArea(self, number(self, "minArea", minArea))

    def getEpsilon(self) -> float:
        """Get the strength, kJ/mol."""
        return _forces.TriangleAreaRepulsionForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength, kJ/mol, zero or above."""
        _forces.TriangleAreaRepulsionForce_setEpsilon(self, number(self, "epsilon", epsilon))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.TriangleAreaRepulsionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> TriangleAreaRepulsionForce:
        """The same force as an object of this class."""
        return own(_forces.TriangleAreaRepulsionForce_cast(force), force)
