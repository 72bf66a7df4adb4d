"""EdgeTensionForce; .ci/forces.py writes this file, from the header of C++."""

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
class EdgeTensionForce(MembraneForce):
    """The line tension of a membrane's borders:

        E = gamma L

    with L the length of all borders, the edges that belong to one triangle. There is no energy on a
    closed surface. A disk closes to a vesicle where that costs less (Helfrich, Phys. Lett. A 50,
    115 (1974), doi:10.1016/0375-9601(74)90899-8). GaussianCurvatureForce is the other energy that
    borders have, and says what keeps free borders from folding over.
    """

    def __init__(self, triangles: Mesh | ArrayLike, tension: Scalar, *, offset: int = 0) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        tension : float or Quantity
            The energy gamma per length, kJ/mol/nm; below zero, borders grow.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, tension=tension)

    def getTension(self) -> float:
        """Get the energy per length, kJ/mol/nm."""
        return _forces.EdgeTensionForce_getTension(self)

    def setTension(self, tension: Scalar) -> None:
        """Set the energy per length, kJ/mol/nm."""
        _forces.EdgeTensionForce_setTension(self, number(self, "tension", tension))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.EdgeTensionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> EdgeTensionForce:
        """The same force as an object of this class."""
        return own(_forces.EdgeTensionForce_cast(force), force)
