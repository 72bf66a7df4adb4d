"""LimForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import constant, number, own, proxy, start
from .._surfaces import Reference
from .._types import Scalar, Values
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class LimForce(Reference, MembraneForce):
    """Elasticity of the skeleton of a red blood cell, which hardens, against a reference shape:

        E = sum over triangles of A0 [ K/2 (a^2 + a3 a^3 + a4 a^4) + mu (b + b1 a b + b2 b^2) ]

    with a = l1 l2 - 1 and b = (l1 - l2)^2 / (2 l1 l2) of the principal stretches l1, l2 of a
    triangle, whose area in the reference is A0. It has no energy in the reference, and none of
    bending. At small strains the shear modulus is mu and the area modulus K. a3 = -2, a4 = 8, b1 =
    0.7, and b2 is chosen among those of the literature.

    Sources: Lim, Wortis and Mukhopadhyay, PNAS 99, 16766 (2002), doi:10.1073/pnas.202617299, and in
    Soft Matter 4 (Wiley, 2008), doi:10.1002/9783527623372.ch2a; Amoudruz et al., Biophys. J. 122,
    1517 (2023), doi:10.1016/j.bpj.2023.03.019.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; one whose corners are in one line there is never
    made.
    """

    Lim2002 = 0
    """b2 = 0.75: Lim, Wortis and Mukhopadhyay."""

    Amoudruz2023 = 1
    """b2 = 1.84: Amoudruz et al., from experiments."""

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        shearModulus: Scalar,
        areaModulus: Scalar,
        reference: Mesh | Values,
        coefficients: int | str = 0,
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
        coefficients : int or str, a constant of the class or its name, default: 0
            The set of coefficients.
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
            coefficients=coefficients,
        )

    def getCoefficients(self) -> int:
        """Get the set of coefficients."""
        return _forces.LimForce_getCoefficients(self)

    def setCoefficients(self, coefficients: int | str) -> None:
        """Set the set of coefficients.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.LimForce_setCoefficients(self, constant(self, "coefficients", coefficients))

    def getShearModulus(self) -> float:
        """Get the modulus mu, kJ/mol/nm^2."""
        return _forces.LimForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.LimForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the modulus K, kJ/mol/nm^2."""
        return _forces.LimForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the modulus K, kJ/mol/nm^2, zero or above."""
        _forces.LimForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.LimForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> LimForce:
        """The same force as an object of this class."""
        return own(_forces.LimForce_cast(force), force)
