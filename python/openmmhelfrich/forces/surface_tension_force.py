"""SurfaceTensionForce; .ci/forces.py writes this file, from the header of C++."""

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
class SurfaceTensionForce(MembraneForce):
    """A surface tension on the total area A of a membrane:

        E = sigma A

    sigma is the energy per area of a membrane that exchanges area with a reservoir, the Lagrange
    multiplier of the area in Deuling and Helfrich, J. Phys. (Paris) 37, 1335 (1976),
    doi:10.1051/jphys:0197600370110133500, and in Seifert, Adv. Phys. 46, 13 (1997),
    doi:10.1080/00018739700101488. A is the sum over all triangles, of all components of the
    surface, closed or with borders.

    Vertices are not exchanged with the reservoir: triangles grow or shrink, and a
    TriangleHeightForce, say, must keep them from collapsing. A membrane under tension by the frame
    that it spans, at constant area, is another thing: MonteCarloMembraneTension.
    """

    def __init__(self, triangles: Mesh | ArrayLike, tension: Scalar, *, offset: int = 0) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        tension : float or Quantity
            The tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, tension=tension)

    def getTension(self) -> float:
        """Get the tension sigma, kJ/mol/nm^2."""
        return _forces.SurfaceTensionForce_getTension(self)

    def setTension(self, tension: Scalar) -> None:
        """Set the tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign."""
        _forces.SurfaceTensionForce_setTension(self, number(self, "tension", tension))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.SurfaceTensionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceTensionForce:
        """The same force as an object of this class."""
        return own(_forces.SurfaceTensionForce_cast(force), force)
