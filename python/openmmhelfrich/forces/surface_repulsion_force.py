"""SurfaceRepulsionForce; .ci/forces.py writes this file, from the header of C++."""

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
class SurfaceRepulsionForce(MembraneForce):
    """Keeps surfaces from passing through themselves and each other, by a repulsion of vertices and
    triangles and of edges:

        E = sum over pairs at a distance d < D of m epsilon [ (D/d)^6 - 1 ]^2

    A pair is a vertex and a triangle, or two edges, that share no vertex; d is the distance of
    their nearest points. m is 1, but for edges at an angle theta with q = sin^2 theta / 0.01 < 1 it
    is q (2 - q): where edges become parallel their ends take over. Energy and force go to zero at D
    (Weeks, Chandler and Andersen, doi:10.1063/1.1674820).

    Two triangles without a common vertex can begin to cross only where a vertex meets a triangle or
    an edge meets an edge, at d = 0, where the energy is infinite. So nothing crosses that is not
    crossed at the beginning, whatever the lengths of edges, as long as no vertex moves by a good
    part of D in a step. Within a flat surface, pairs are as far apart as triangles are high: take a
    D below the least height, about a fifth of the mean edge, and epsilon of kT.

    The triangles may be of several surfaces. If bonds flip on some of them, give those of whole
    membranes one after another, each as its MonteCarloBondFlip and its other forces have them: the
    force follows their flips, and its energy counts in each. A flip does not look whether the
    quadrilateral that it turns sweeps over something.

    The processor computes it, whatever computes other forces.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, distance: Scalar, epsilon: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        distance : float or Quantity
            The distance D below which there is a repulsion, nm, above zero.
        epsilon : float or Quantity
            The strength, kJ/mol, zero or above.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, distance=distance, epsilon=epsilon)

    def getDistance(self) -> float:
        """Get the distance D below which there is a repulsion, nm."""
        return _forces.SurfaceRepulsionForce_getDistance(self)

    def setDistance(self, distance: Scalar) -> None:
        """Set the distance D below which there is a repulsion, nm, above zero."""
        _forces.SurfaceRepulsionForce_setDistance(self, number(self, "distance", distance))

    def getEpsilon(self) -> float:
        """Get the strength, kJ/mol."""
        return _forces.SurfaceRepulsionForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength, kJ/mol, zero or above."""
        _forces.SurfaceRepulsionForce_setEpsilon(self, number(self, "epsilon", epsilon))

    def getOnlyBetweenParts(self) -> bool:
        """Get whether only different connected parts of the triangles repel each other."""
        return _forces.SurfaceRepulsionForce_getOnlyBetweenParts(self)

    def setOnlyBetweenParts(self, only: bool) -> None:
        """Choose whether only different connected parts of the triangles repel each other.

        Parameters
        ----------
        only : bool
            True to leave out pairs within a part; False, the default, for all pairs.
        """
        _forces.SurfaceRepulsionForce_setOnlyBetweenParts(self, only)

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.SurfaceRepulsionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceRepulsionForce:
        """The same force as an object of this class."""
        return own(_forces.SurfaceRepulsionForce_cast(force), force)
