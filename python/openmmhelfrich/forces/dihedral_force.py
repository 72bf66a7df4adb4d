"""DihedralForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import constant, elements, number, own, proxy, start
from .._types import Scalar, Values
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class DihedralForce(MembraneForce):
    """Stiff hinges between neighbouring triangles:

        E = K sum over edges of f(phi - phi0)

    with phi the angle between the normals of the two triangles of an edge, 0 when flat and positive
    at a convex edge, and phi0 the angle at rest. Unlike BendingForce its effect depends on the
    mesh. K and phi0 can be given for each edge of its own; edges are in lexicographic order of the
    particles at their ends, the lower one first (in Python Mesh.edges), those on borders among
    them, which have no angle and no energy. Such values do not follow bond flips, which are refused
    then.

    Sources: (B5) and the potential of fourth order of Farnudi, Ejtehadi and Everaers, Phys. Rev. E
    108, 015301 (2023), doi:10.1103/PhysRevE.108.015301. Angles at rest: Kantor and Nelson, Phys.
    Rev. Lett. 58, 2774 (1987), doi:10.1103/PhysRevLett.58.2774; for red cells (6) of Fedosov,
    Caswell and Karniadakis, Biophys. J. 98, 2215 (2010), doi:10.1016/j.bpj.2010.02.002, with the
    form Cosine.
    """

    Quartic = 0
    """f = c^2, about x^4 / 4: the paper's potential (VCM smoothTheta4)."""

    Cosine = 1
    """f = c, about x^2 / 2: Kantor and Nelson (B5) (VCM cosine)."""

    Exp = 2
    """f = 1/2 (exp(2c) - 1) (VCM exp)."""

    SmoothExp = 3
    """f = 0.04 (exp(10c) - 1) (VCM smoothExp)."""

    SmoothExp46 = 4
    """f = 1/2 (exp(2c) - 1 - x^2) (VCM smoothExp46)."""

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        stiffness: Scalar | ArrayLike,
        form: int | str = 0,
        restAngle: Scalar | ArrayLike = 0.0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        stiffness : float or Quantity, or one for each element
            The stiffness K, kJ/mol, zero or above.
        form : int or str, a constant of the class or its name, default: 0
            The function f.
        restAngle : float or Quantity, or one for each element, default: 0.0
            The angle phi0 at rest, from -pi to pi, radians.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, stiffness=stiffness, form=form, restAngle=restAngle)

    def getStiffness(self) -> float:
        """Get the stiffness K, kJ/mol."""
        return _forces.DihedralForce_getStiffness(self)

    def setStiffness(self, stiffness: Scalar) -> None:
        """Set the stiffness K, kJ/mol, zero or above.

        Values of single edges are given up.
        """
        _forces.DihedralForce_setStiffness(self, number(self, "stiffness", stiffness))

    def getRestAngle(self) -> float:
        """Get the angle phi0 at rest."""
        return _forces.DihedralForce_getRestAngle(self)

    def setRestAngle(self, restAngle: Scalar) -> None:
        """Set the angle phi0 at rest, from -pi to pi, positive for convex edges.

        Values of single edges are given up.
        """
        _forces.DihedralForce_setRestAngle(self, number(self, "restAngle", restAngle))

    def getEdgeStiffness(self) -> tuple[float, ...]:
        """Get the stiffness of each edge, kJ/mol; empty if all have the same."""
        return _forces.DihedralForce_getEdgeStiffness(self)

    def setEdgeStiffness(self, values: Values) -> None:
        """Give each edge its own stiffness, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each edge, in lexicographic order, kJ/mol; empty to go back.
        """
        _forces.DihedralForce_setEdgeStiffness(self, elements(self, "stiffness", values))

    def getEdgeRestAngle(self) -> tuple[float, ...]:
        """Get the angle at rest of each edge; empty if all have the same."""
        return _forces.DihedralForce_getEdgeRestAngle(self)

    def setEdgeRestAngle(self, values: Values) -> None:
        """Give each edge its own angle at rest, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each edge, in lexicographic order; empty to go back.
        """
        _forces.DihedralForce_setEdgeRestAngle(self, elements(self, "restAngle", values))

    def getForm(self) -> int:
        """Get the function of the angle."""
        return _forces.DihedralForce_getForm(self)

    def setForm(self, form: int | str) -> None:
        """Set the function of the angle.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.DihedralForce_setForm(self, constant(self, "form", form))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.DihedralForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> DihedralForce:
        """The same force as an object of this class."""
        return own(_forces.DihedralForce_cast(force), force)
