"""SpringForce; .ci/forces.py writes this file, from the header of C++."""

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
class SpringForce(Reference, MembraneForce):
    """Springs along the edges, a network such as the spectrin skeleton of a red blood cell:

        E = sum over edges of f(l)

    with the length l of an edge. Each spring has its minimum, f = 0, at the length l0 that its edge
    has in the reference, and there the stiffness k = f'' that all have. A net of equilateral
    triangles without tension has the shear modulus sqrt(3)/4 k and the area modulus sqrt(3)/2 k.

    The reference gives each vertex a position, so that an edge which bond flips make is as long at
    rest as its ends are apart there.
    """

    Harmonic = 0
    """f = 1/2 k (l - l0)^2."""

    WLCPower = 1
    """f = A [g(x) - g(x0)] + p (1/l - 1/l0), a worm-like chain with g(x) = (3 x^2 - 2 x^3)/(1 - x),
    x = l/lmax, and a repulsion, of which l0 and k determine A and p: D.

    A. Fedosov, B. Caswell and G. E. Karniadakis, Biophys. J. 98, 2215 (2010),
    doi:10.1016/j.bpj.2010.02.002, with m = 2, p = k_p and A = kBT lmax/(4p) there. An edge of
    length lmax or more is an error that names it.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        stiffness: Scalar,
        reference: Mesh | Values,
        ratio: Scalar = 0.45454545454545453,
        form: int | str = 0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        stiffness : float or Quantity
            The stiffness k = f''(l0), kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        ratio : float or Quantity, default: 0.45454545454545453
            The length at rest as a share of the longest, l0/lmax, above zero and below one; of
            WLCPower only.
        form : int or str, a constant of the class or its name, default: 0
            The function f.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            stiffness=stiffness,
            reference=reference,
            ratio=ratio,
            form=form,
        )

    def getStiffness(self) -> float:
        """Get the stiffness k of all springs at rest, kJ/mol/nm^2."""
        return _forces.SpringForce_getStiffness(self)

    def setStiffness(self, stiffness: Scalar) -> None:
        """Set the stiffness k of all springs at rest, kJ/mol/nm^2, zero or above."""
        _forces.SpringForce_setStiffness(self, number(self, "stiffness", stiffness))

    def getRatio(self) -> float:
        """Get the length at rest as a share of the longest, l0/lmax."""
        return _forces.SpringForce_getRatio(self)

    def setRatio(self, ratio: Scalar) -> None:
        """Set the length at rest as a share of the longest, l0/lmax, above zero and below one."""
        _forces.SpringForce_setRatio(self, number(self, "ratio", ratio))

    def getForm(self) -> int:
        """Get the function of the length."""
        return _forces.SpringForce_getForm(self)

    def setForm(self, form: int | str) -> None:
        """Set the function of the length.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.SpringForce_setForm(self, constant(self, "form", form))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.SpringForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SpringForce:
        """The same force as an object of this class."""
        return own(_forces.SpringForce_cast(force), force)
