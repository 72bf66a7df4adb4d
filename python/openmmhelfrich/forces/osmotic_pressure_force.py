"""OsmoticPressureForce; .ci/forces.py writes this file, from the header of C++."""

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
class OsmoticPressureForce(MembraneForce):
    """The osmotic pressure of solutes that cannot pass a membrane, which water can:

        E = n kT (x - 1 - ln x),   x = c V / n

    with n the number of solutes inside, c their concentration outside and V the enclosed volume.
    The solutions are ideal (van 't Hoff, Z. Phys. Chem. 1, 481 (1887), doi:10.1515/zpch-1887-0151),
    and the one outside is large: E is the work against the pressure difference

        -dE/dV = kT (n / V - c)

    It is zero, and least, at V = n / c, where its stiffness is that of an EnclosedVolumeForce of
    modulus kT c; for the few bars of real solutions that is a fixed volume. E is infinite at V = 0.
    A shape without a volume, as one that has turned inside out, is refused by an exception.

    Numbers are counted in molecules: a concentration of 1 mol/l is 0.602214 / nm^3. In Python,
    thermalEnergy may be unit.MOLAR_GAS_CONSTANT_R * 300 * unit.kelvin.

    Triangles must run counter-clockwise seen from outside, and a surface with a border is refused,
    as EnclosedVolumeForce says.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        solutes: Scalar,
        concentration: Scalar,
        thermalEnergy: Scalar,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        solutes : float or Quantity
            The number n of solutes inside, above zero.
        concentration : float or Quantity
            The concentration c of solutes outside, 1/nm^3, above zero.
        thermalEnergy : float or Quantity
            The thermal energy kT, kJ/mol, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            solutes=solutes,
            concentration=concentration,
            thermalEnergy=thermalEnergy,
        )

    def getSolutes(self) -> float:
        """Get the number n of solutes inside."""
        return _forces.OsmoticPressureForce_getSolutes(self)

    def setSolutes(self, solutes: Scalar) -> None:
        """Set the number n of solutes inside, above zero."""
        _forces.OsmoticPressureForce_setSolutes(self, number(self, "solutes", solutes))

    def getConcentration(self) -> float:
        """Get the concentration c of solutes outside, 1/nm^3."""
        return _forces.OsmoticPressureForce_getConcentration(self)

    def setConcentration(self, concentration: Scalar) -> None:
        """Set the concentration c of solutes outside, 1/nm^3, above zero."""
        _forces.OsmoticPressureForce_setConcentration(
            self, number(self, "concentration", concentration)
        )

    def getThermalEnergy(self) -> float:
        """Get the thermal energy kT, kJ/mol."""
        return _forces.OsmoticPressureForce_getThermalEnergy(self)

    def setThermalEnergy(self, thermalEnergy: Scalar) -> None:
        """Set the thermal energy kT, kJ/mol, above zero."""
        _forces.OsmoticPressureForce_setThermalEnergy(
            self, number(self, "thermalEnergy", thermalEnergy)
        )

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.OsmoticPressureForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> OsmoticPressureForce:
        """The same force as an object of this class."""
        return own(_forces.OsmoticPressureForce_cast(force), force)
