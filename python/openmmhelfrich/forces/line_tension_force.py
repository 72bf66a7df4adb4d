"""LineTensionForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import number, own, proxy, start
from .._surfaces import Domains
from .._types import Scalar
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class LineTensionForce(Domains, MembraneForce):
    """The tension of the line between domains of a membrane:

        E = gamma L

    with the length L of the line that separates vertices of different domains. In a triangle with
    two corners in one domain and the third in another it joins the middles of the two mixed sides,
    and in a triangle of three domains it leads from the middles of all sides to the centroid. There
    may be any number of domains. BendingForce can have a rigidity and a spontaneous curvature for
    each vertex, and so for each domain.

    The smooth counterpart is F. Juelicher and R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993),
    doi:10.1103/PhysRevLett.70.2964. A line through a mesh goes in zigzag and is longer than a
    smooth one, however fine the mesh is: on equilateral triangles by 1 along their edges, 2/sqrt(3)
    at 30 degrees to these and 2 sqrt(3)/pi = 1.103 on average, on random meshes by 1.107. So gamma
    is to be the energy of a smooth line by length, divided by this.

    Domains belong to the vertices: bond flips take a vertex along with its domain, so that domains
    mix and sort on a membrane that flows. With a MonteCarloDomainSwap neighbours exchange them.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, tension: Scalar, domains: ArrayLike, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        tension : float or Quantity
            The energy gamma per length, kJ/mol/nm; below zero, domains mix.
        domains : array_like of int
            The number of each vertex' domain, in ascending order of particle index.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, tension=tension, domains=domains)

    def getTension(self) -> float:
        """Get the energy per length, kJ/mol/nm."""
        return _forces.LineTensionForce_getTension(self)

    def setTension(self, tension: Scalar) -> None:
        """Set the energy per length, kJ/mol/nm."""
        _forces.LineTensionForce_setTension(self, number(self, "tension", tension))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.LineTensionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> LineTensionForce:
        """The same force as an object of this class."""
        return own(_forces.LineTensionForce_cast(force), force)
