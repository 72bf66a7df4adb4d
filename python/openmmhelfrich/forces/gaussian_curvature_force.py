"""GaussianCurvatureForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import elements, number, own, proxy, start
from .._types import Scalar, Values
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class GaussianCurvatureForce(MembraneForce):
    """The elasticity of Gaussian curvature:

        E = kappa_G [ sum over vertices on no border of (2 pi - sum of theta) ]
          = kappa_G [ 2 pi chi - sum over vertices on borders of (pi - sum of theta) ]

    with theta the angles of the triangles at a vertex (Meyer et al., in Visualization and
    Mathematics III, 35 (2003), doi:10.1007/978-3-662-05105-4_2) and chi the number of vertices less
    that of edges plus that of triangles. The two are equal by the theorem of Gauss and Bonnet, in
    which the second sum is the integrated geodesic curvature of the borders; forces act on the
    triangles at borders only. On a closed surface E is the constant 2 pi chi kappa_G, 4 pi kappa_G
    on a sphere, and there are no forces.

    The modulus can have a value for each vertex, so that domains may differ. Then

        E = sum over vertices on no border of kappa_G,i (2 pi - sum of theta)

    has forces on closed surfaces, too: those of the line between domains, by its geodesic curvature
    (F. Juelicher and R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993),
    doi:10.1103/PhysRevLett.70.2964; LineTensionForce is the line's tension).

    With kappa_G below zero and bond flips, meshes with borders may crumple: where the dihedral
    angles at a vertex cancel, BendingForce's scheme Julicher sees no curvature however the surface
    zigzags, and folds at a border gain energy. A DihedralForce of the stiffness of the membrane's
    rigidity prevents that for kappa_G down to minus the rigidity; at -1.5 of it borders ruffle
    nevertheless. Free borders also fold over and heat up at low friction, with or without this
    force; a DihedralForce of 0.2 of the rigidity keeps them from it. docs/surfaces.md has the
    measurements.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, modulus: Scalar | ArrayLike, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity, or one for each element
            The modulus kappa_G, kJ/mol; of lipid membranes it is below zero, about -rigidity.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus)

    def getModulus(self) -> float:
        """Get the modulus kappa_G, kJ/mol."""
        return _forces.GaussianCurvatureForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the modulus kappa_G, kJ/mol.

        Values of single vertices are given up.
        """
        _forces.GaussianCurvatureForce_setModulus(self, number(self, "modulus", modulus))

    def getVertexModulus(self) -> tuple[float, ...]:
        """Get the modulus of each vertex, kJ/mol; empty if all have the same."""
        return _forces.GaussianCurvatureForce_getVertexModulus(self)

    def setVertexModulus(self, values: Values) -> None:
        """Give each vertex its own modulus, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each vertex, in ascending order of particle index, kJ/mol; empty to go back
            to the scalar.
        """
        _forces.GaussianCurvatureForce_setVertexModulus(self, elements(self, "modulus", values))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.GaussianCurvatureForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> GaussianCurvatureForce:
        """The same force as an object of this class."""
        return own(_forces.GaussianCurvatureForce_cast(force), force)
