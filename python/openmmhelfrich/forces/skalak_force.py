"""SkalakForce; .ci/forces.py writes this file, from the header of C++."""

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
class SkalakForce(Reference, MembraneForce):
    """Elasticity of a membrane with a skeleton, such as that of a red blood cell, against a
    reference shape:

        E = sum over triangles of A0 [ mu/4 (1/2 I1^2 + I1 - I2) + K/8 I2^2 ]

    with I1 = l1^2 + l2^2 - 2 and I2 = l1^2 l2^2 - 1 of the principal stretches l1, l2 of a
    triangle, whose area in the reference is A0. It has no energy in the reference, and none of
    bending. The area term makes it stiffer the more it is stretched; for red cells K is some 1000
    mu at short times (a membrane whose area is kept) and of the order of mu for the skeleton alone.

    mu and K are B and C of R. Skalak, A. Tozeren, R. P. Zarda and S. Chien, Biophys. J. 13, 245
    (1973), doi:10.1016/S0006-3495(73)85983-1. At small strains the shear modulus is mu/2 and the
    area modulus K + mu/2. LinearElasticForce and NeoHookeanForce have these moduli themselves for
    arguments.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; one whose corners are in one line there is never
    made.
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
            The modulus mu, kJ/mol/nm^2, zero or above.
        areaModulus : float or Quantity
            The modulus K, kJ/mol/nm^2, zero or above.
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
        """Get the modulus mu, kJ/mol/nm^2."""
        return _forces.SkalakForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.SkalakForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the modulus K, kJ/mol/nm^2."""
        return _forces.SkalakForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the modulus K, kJ/mol/nm^2, zero or above."""
        _forces.SkalakForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.SkalakForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SkalakForce:
        """The same force as an object of this class."""
        return own(_forces.SkalakForce_cast(force), force)
