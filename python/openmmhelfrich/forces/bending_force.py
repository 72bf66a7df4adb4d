"""BendingForce; .ci/forces.py writes this file, from the header of C++."""

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
class BendingForce(MembraneForce):
    """Bending energy of a fluid membrane (Helfrich), with spontaneous curvature, in five
    discretisations:

        E = 1/2 kappa sum_i [ c_i^2 / a_i - 2 C0 c_i + C0^2 a_i ]

    over the vertices i, with an integrated curvature c_i and an area a_i that the scheme chooses.
    kappa multiplies half the square of the sum of the principal curvatures less C0: a sphere of
    radius R has E = 8 pi kappa (1 - C0 R / 2)^2 up to the error of the mesh.

    Where c is a vector, c^2 is its square and the linear term takes n.c, with n the mean of the
    normals of the triangles at the vertex weighted by their angles (B9);
    setUnsignedSpontaneousCurvature() chooses |c| instead, as VCM does, which cannot tell a bulge
    from a dent.

    Borders are free, as in Capovilla, Guven and Santiago, Phys. Rev. E 66, 021607 (2002),
    doi:10.1103/PhysRevE.66.021607, without tension of their own: no scheme has curvature at a
    vertex on a border, which is left out of the sum, and a border edge has no angle. An inner edge
    that ends at a border counts for its inner end.

    The Voronoi area of the schemes GompperKroll and JulicherVoronoi goes through zero where
    triangles are obtuse. The energy then has pits and poles, as the formula has; it is not clamped.

    Source: Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301.
    """

    Julicher = 0
    """c = J = sum_j l_ij phi_ij / 2 over the edges, with phi the angle between the normals of their
    two triangles, positive where the surface is convex; a is barycentric (B13).
    """

    GompperKroll = 1
    """c = S = sum_j (cot theta_1 + cot theta_2)(r_i - r_j) / 2 with the two angles opposite the
    edge; a is Voronoi's, sum_j l_ij^2 (cot theta_1 + cot theta_2) / 8 (B10).
    """

    GompperKrollBarycentric = 2
    """c = S; a is barycentric, a third of the area of the triangles at the vertex (B15)."""

    JulicherVoronoi = 3
    """c = J; a is Voronoi's (B16)."""

    Espriu = 4
    """c = sum_j (r_i - r_j) / sqrt(3), as S if all triangles were equilateral; a is barycentric.

    At C0 = 0 this is VCM's Espiru1987, kappa sum_i |sum_j r_j - n_i r_i|^2 / (6 a_i).
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        rigidity: Scalar | ArrayLike,
        spontaneousCurvature: Scalar | ArrayLike = 0.0,
        scheme: int | str = 0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        rigidity : float or Quantity, or one for each element
            The bending rigidity kappa, kJ/mol, zero or above.
        spontaneousCurvature : float or Quantity, or one for each element, default: 0.0
            The spontaneous curvature C0, 1/nm, positive for bulging outward.
        scheme : int or str, a constant of the class or its name, default: 0
            The discretisation.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            rigidity=rigidity,
            spontaneousCurvature=spontaneousCurvature,
            scheme=scheme,
        )

    def getRigidity(self) -> float:
        """Get the bending rigidity kappa, kJ/mol."""
        return _forces.BendingForce_getRigidity(self)

    def setRigidity(self, rigidity: Scalar) -> None:
        """Set the bending rigidity kappa, kJ/mol, zero or above.

        Values of single vertices are given up.
        """
        _forces.BendingForce_setRigidity(self, number(self, "rigidity", rigidity))

    def getSpontaneousCurvature(self) -> float:
        """Get the spontaneous curvature C0, 1/nm, positive for bulging outward."""
        return _forces.BendingForce_getSpontaneousCurvature(self)

    def setSpontaneousCurvature(self, spontaneousCurvature: Scalar) -> None:
        """Set the spontaneous curvature C0, 1/nm, positive for bulging outward.

        Values of single vertices are given up.
        """
        _forces.BendingForce_setSpontaneousCurvature(
            self, number(self, "spontaneousCurvature", spontaneousCurvature)
        )

    def getScheme(self) -> int:
        """Get the discretisation."""
        return _forces.BendingForce_getScheme(self)

    def setScheme(self, scheme: int | str) -> None:
        """Set the discretisation.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.BendingForce_setScheme(self, constant(self, "scheme", scheme))

    def getUnsignedSpontaneousCurvature(self) -> bool:
        """Get whether the linear term of the spontaneous curvature takes |c|."""
        return _forces.BendingForce_getUnsignedSpontaneousCurvature(self)

    def setUnsignedSpontaneousCurvature(self, isUnsigned: bool) -> None:
        """Choose whether the linear term of the spontaneous curvature takes |c| (VCM) instead of
        n.c.

        Parameters
        ----------
        isUnsigned : bool
            True for |c|; False, the default, for n.c.
        """
        _forces.BendingForce_setUnsignedSpontaneousCurvature(self, isUnsigned)

    def getVertexRigidity(self) -> tuple[float, ...]:
        """Get the bending rigidity of each vertex, kJ/mol; empty if all have the same."""
        return _forces.BendingForce_getVertexRigidity(self)

    def setVertexRigidity(self, values: Values) -> None:
        """Give each vertex its own bending rigidity, which replaces the scalar: domains.

        Parameters
        ----------
        values : array_like or Quantity
            One for each vertex, in ascending order of particle index, kJ/mol; empty to go back.
        """
        _forces.BendingForce_setVertexRigidity(self, elements(self, "rigidity", values))

    def getVertexSpontaneousCurvature(self) -> tuple[float, ...]:
        """Get the spontaneous curvature of each vertex, 1/nm; empty if all have the same."""
        return _forces.BendingForce_getVertexSpontaneousCurvature(self)

    def setVertexSpontaneousCurvature(self, values: Values) -> None:
        """Give each vertex its own spontaneous curvature, which replaces the scalar: domains.

        Parameters
        ----------
        values : array_like or Quantity
            One for each vertex, in ascending order of particle index, 1/nm; empty to go back.
        """
        _forces.BendingForce_setVertexSpontaneousCurvature(
            self, elements(self, "spontaneousCurvature", values)
        )

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.BendingForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> BendingForce:
        """The same force as an object of this class."""
        return own(_forces.BendingForce_cast(force), force)
