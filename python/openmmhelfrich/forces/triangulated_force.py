"""TriangulatedForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import _forces
from .._proxies import proxy
from .._surfaces import Triangulated
from ._helfrich_force import _HelfrichForce

if TYPE_CHECKING:
    pass


@proxy
class TriangulatedForce(Triangulated, _HelfrichForce):
    """What acts on a triangulated surface of particles.

    The triangles are those that a Context begins with, and they tell which forces act on the same
    surface. Bond flips (MonteCarloBondFlip) and setTrianglesInContext() change which particles are
    connected in a Context, for all forces on the same triangles at once; triangles keep their
    numbers.
    """

    def getNumTriangles(self) -> int:
        """Get the number of triangles."""
        return _forces.TriangulatedForce_getNumTriangles(self)

    def getTriangle(self, index: int) -> list[int]:
        """Get the corners of a triangle.

        Parameters
        ----------
        index : int
            The index of the triangle.
        """
        return _forces.TriangulatedForce_getTriangle(self, index)
