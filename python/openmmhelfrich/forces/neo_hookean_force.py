"""NeoHookeanForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import number, own, proxy, start
from .._surfaces import Reference
from .._types import Scalar, Values
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class NeoHookeanForce(Reference, MembraneForce):
    """Elasticity of a rubber-like membrane against a reference shape:

        E = sum over triangles of A0 [ mu/2 (l1/l2 + l2/l1 - 2) + K/2 (l1 l2 - 1)^2 ]

    with the principal stretches l1, l2 of a triangle, whose area in the reference is A0. Shear at
    fixed area costs mu and growth K only, however large they are; at small strains mu is the shear
    and K the area modulus.

    It is the first-order material of E. A. Evans and R. Skalak, Mechanics and Thermodynamics of
    Biomembranes (CRC Press, 1980), mu beta + K/2 alpha^2 with alpha = l1 l2 - 1 and beta = (l1^2 +
    l2^2)/(2 l1 l2) - 1, to which G. Lim, M. Wortis and R. Mukhopadhyay (doi:10.1073/pnas.202617299)
    add terms of higher order.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; see SkalakForce.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        shearModulus: Scalar,
        areaModulus: Scalar,
        reference: Mesh | Values,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        shearModulus : float or Quantity
            The shear modulus mu, kJ/mol/nm^2, zero or above.
        areaModulus : float or Quantity
            The area modulus K, kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            shearModulus=shearModulus,
            areaModulus=areaModulus,
            reference=reference,
        )

    def getShearModulus(self) -> float:
        """Get the shear modulus mu, kJ/mol/nm^2."""
        return _forces.NeoHookeanForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the shear modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.NeoHookeanForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the area modulus K, kJ/mol/nm^2."""
        return _forces.NeoHookeanForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the area modulus K, kJ/mol/nm^2, zero or above."""
        _forces.NeoHookeanForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.NeoHookeanForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> NeoHookeanForce:
        """The same force as an object of this class."""
        return own(_forces.NeoHookeanForce_cast(force), force)
