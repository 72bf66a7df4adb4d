"""PressureForce; .ci/forces.py writes this file, from the header of C++."""

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
class PressureForce(MembraneForce):
    """A pressure difference across a membrane that encloses the volume V:

        E = -p V

    with p the pressure inside less that outside: above zero it blows the membrane up, below zero it
    sucks it in. The force on a vertex is p/3 times the sum of the area vectors of its triangles.
    Bending, a tension and a pressure together are the functional of Deuling and Helfrich, J. Phys.
    (Paris) 37, 1335 (1976), doi:10.1051/jphys:0197600370110133500, whose pressure difference has
    the other sign; see also Seifert, Adv. Phys. 46, 13 (1997), doi:10.1080/00018739700101488.

    E has no lower bound for p above zero: something else must keep the area finite, such as a
    SurfaceAreaForce. p can be a parameter of the Context, see setContextParameter(). Where the
    volume changes with osmotic pressure, take an OsmoticPressureForce.

    Triangles must run counter-clockwise seen from outside, and a surface with a border is refused,
    as EnclosedVolumeForce says.
    """

    def __init__(self, triangles: Mesh | ArrayLike, pressure: Scalar, *, offset: int = 0) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        pressure : float or Quantity
            The pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar).
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, pressure=pressure)

    def getPressure(self) -> float:
        """Get the pressure difference p, inside less outside, kJ/mol/nm^3."""
        return _forces.PressureForce_getPressure(self)

    def setPressure(self, pressure: Scalar) -> None:
        """Set the pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar)."""
        _forces.PressureForce_setPressure(self, number(self, "pressure", pressure))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.PressureForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> PressureForce:
        """The same force as an object of this class."""
        return own(_forces.PressureForce_cast(force), force)
