"""LinearElasticForce; .ci/forces.py writes this file, from the header of C++."""

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
class LinearElasticForce(Reference, MembraneForce):
    """The simplest elasticity against a reference shape, quadratic in Green's strain e of each
    triangle:

        E = sum over triangles of A0 [ K/2 (e1 + e2)^2 + mu/2 (e1 - e2)^2 ]

    with the principal strains e = (l^2 - 1)/2 of the principal stretches l1, l2 and the area A0 of
    the triangle in the reference. mu is the shear and K the area modulus at small strains. This is
    the law of de Saint-Venant and Kirchhoff (P. G. Ciarlet, Mathematical Elasticity I, North-
    Holland 1988). It is for small strains: a triangle that is compressed to nothing has a finite
    energy, and resists less and less on the way there.

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
        return _forces.LinearElasticForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the shear modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.LinearElasticForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the area modulus K, kJ/mol/nm^2."""
        return _forces.LinearElasticForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the area modulus K, kJ/mol/nm^2, zero or above."""
        _forces.LinearElasticForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.LinearElasticForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> LinearElasticForce:
        """The same force as an object of this class."""
        return own(_forces.LinearElasticForce_cast(force), force)
