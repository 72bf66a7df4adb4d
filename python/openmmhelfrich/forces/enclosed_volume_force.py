"""EnclosedVolumeForce; .ci/forces.py writes this file, from the header of C++."""

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
class EnclosedVolumeForce(MembraneForce):
    """Keeps the volume V that a membrane encloses near a target V0:

        E = 1/2 kV (V - V0)^2 / V0

    Equation (2) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301. V is positive for outward triangles, the sum over all
    components of the surface, and does not depend on the origin.

    A surface with a border encloses nothing: creating a Context throws an exception that names the
    border.

    Triangles must run counter-clockwise seen from outside. Where V is below zero when a Context
    first evaluates the force, it throws an exception: swap two corners of each triangle. Of several
    surfaces some may face inward, as the inner wall of a shell does, if V as a whole is above zero,
    and a flat surface (|V| below a thousandth of a sphere's of the same area) may start. A shape
    that turns inside out or crosses itself later is not refused; the formula holds for V of either
    sign.
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
            The volume modulus kV, kJ/mol/nm^3, zero or above.
        target : float or Quantity
            The target volume V0, nm^3, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the volume modulus kV, kJ/mol/nm^3."""
        return _forces.EnclosedVolumeForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the volume modulus kV, kJ/mol/nm^3, zero or above."""
        _forces.EnclosedVolumeForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target volume V0, nm^3."""
        return _forces.EnclosedVolumeForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target volume V0, nm^3, above zero."""
        _forces.EnclosedVolumeForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.EnclosedVolumeForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> EnclosedVolumeForce:
        """The same force as an object of this class."""
        return own(_forces.EnclosedVolumeForce_cast(force), force)
