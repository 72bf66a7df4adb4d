"""AreaDifferenceForce; .ci/forces.py writes this file, from the header of C++."""

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
class AreaDifferenceForce(MembraneForce):
    """Area-difference elasticity: the two monolayers of a closed membrane cannot exchange lipids,
    and resist changes of the difference in their areas.

        E = 1/2 m (M - M0)^2,   M = sum over edges of 1/2 l phi

    M is the integral of the mean curvature (C1 + C2) / 2 over the surface, nm, with l the length of
    an edge and phi the dihedral angle there, positive where the surface is convex: 4 pi r on a
    sphere, pi L on a tube of length L, 2 pi^2 R on a torus whose tube has its middle at R. It is
    half the sum of the curvatures J of BendingForce's scheme Julicher.

    With D the distance of the monolayers' neutral surfaces, their areas differ by dA = 2 D M, and

        E = alpha kappa pi / (2 A D^2) (dA - dA0)^2

    in Miao, Seifert, Wortis and Dobereiner, Phys. Rev. E 49, 5389 (1994),
    doi:10.1103/PhysRevE.49.5389, and in Seifert, Adv. Phys. 46, 13 (1997),
    doi:10.1080/00018739700101488. So m = 4 pi alpha kappa / A and M0 = dA0 / 2 D = 4 pi RA da0,
    where da0 is the reduced difference dA0 / (8 pi D RA) and A = 4 pi RA^2 the area of the relaxed
    membrane, a number here. D itself drops out. Python's area_difference_parameters() makes m and
    M0 of kappa, alpha, A and da0. To the bending energy, which a BendingForce without spontaneous
    curvature gives, this adds the rest of the ADE model.

    Edges at borders have no dihedral angle and do not count; there lipids can go round, and the
    energy means little. A fold that goes on through 180 degrees lets M jump, as in BendingForce.
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
            The modulus m, kJ/mol/nm^2, zero or above.
        target : float or Quantity
            The target M0 of the integral of mean curvature, nm, of either sign.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the modulus m, kJ/mol/nm^2."""
        return _forces.AreaDifferenceForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the modulus m, kJ/mol/nm^2, zero or above."""
        _forces.AreaDifferenceForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target M0 of the integral of mean curvature, nm."""
        return _forces.AreaDifferenceForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target M0 of the integral of mean curvature, nm, of either sign."""
        _forces.AreaDifferenceForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.AreaDifferenceForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> AreaDifferenceForce:
        """The same force as an object of this class."""
        return own(_forces.AreaDifferenceForce_cast(force), force)
