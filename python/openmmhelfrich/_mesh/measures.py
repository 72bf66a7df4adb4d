"""`Mesh.area` and its like: what a mesh measures, its borders and its topology."""

from __future__ import annotations

import functools
import math

import numpy as np

from .._numbers import length as _length
from .._types import Integers, Scalar
from ..errors import MeshError
from . import geometry, inputs, periodic

__all__ = ["Measures"]


class Measures:
    """What `Mesh` has for measuring the surface of its arrays.

    Equations (B…) and (29–31) are those of doi:10.1103/PhysRevE.108.015301.
    """

    @functools.cached_property
    def border_loops(self) -> list[Integers]:
        """The borders, as the vertices round each: none if the mesh is closed.

        In the direction in which the triangles at the border name them, the surface on the left
        seen from the side of the normals. Each loop begins with its lowest vertex, and loops are in
        the order of those; int64, read-only.
        """
        loops = geometry.border_loops(self.triangles)
        for loop in loops:
            loop.flags.writeable = False
        return loops

    @property
    def is_closed(self) -> bool:
        """Whether there is no border. A surface that spans its periodic box may be closed."""
        return not self.border_loops

    @functools.cached_property
    def area(self) -> float:
        """Total area A = Σ_t |AB × AC| / 2 (B2), nm²."""
        return geometry.surface_area(self.corner_positions)

    @functools.cached_property
    def volume(self) -> float:
        """Enclosed volume V = Σ_t A · (B × C) / 6 (B3, B4), summed over components, nm³.

        Raises
        ------
        MeshError
            If the mesh has a border, or spans its periodic box: there is no inside then.
        """
        geometry.check_closed(self.border_loops, "Mesh.volume")
        vertices = self.vertices
        if self.box is not None:
            vertices, part, spanning = periodic.unfolded(vertices, self.edges, self.box)
            if spanning.any():
                vertex = np.flatnonzero(spanning.any(axis=1)[part])[0]
                raise MeshError(
                    f"Mesh.volume: the part of the mesh with vertex {vertex} spans its periodic "
                    "box and encloses no volume"
                )
        return geometry.volume_enclosed(vertices, self.triangles)

    @property
    def reduced_volume(self) -> float:
        """Volume over that of the sphere of equal total area, v = 6 √π V / A^{3/2}; at most 1.

        Raises
        ------
        MeshError
            As `volume`.
        """
        return geometry.reduced_volume(self.area, self.volume)

    @property
    def euler_characteristic(self) -> int:
        """num_vertices − num_edges + num_triangles, summed over components.

        2 for a sphere, 1 for a disk, 0 for a torus, a tube, or a sheet that spans its box.
        """
        return self.num_vertices - len(self.edges) + self.num_triangles

    @property
    def genus(self) -> int:
        """The number of handles, summed over components: 0 for spheres and disks, 1 for a torus.

        From χ = Σ (2 − 2 g − borders). In a periodic box, that of the surface with its images
        identified: 1 for a sheet, 3 for `schwarz_p`.
        """
        borders = len(self.border_loops)
        return (2 * self.num_components - borders - self.euler_characteristic) // 2

    @functools.cached_property
    def num_components(self) -> int:
        """The number of connected surfaces that the mesh consists of."""
        return geometry.component_count(self.num_vertices, self.edges)

    def softness(self, min_height: Scalar) -> float:
        """Softness Ξ = (d / h̄)², h̄² = √3 A / num_triangles (29–31).

        h̄ is the height of the equilateral triangle whose area is the mean one, d the least height
        of `TriangleHeightForce`. The paper's meshes have Ξ = 0.037 to 0.59.

        Parameters
        ----------
        min_height : float or Quantity
            d, nm, 0 or more.

        Raises
        ------
        MeshError
            If d is negative or not a finite length.
        """
        height = inputs.not_negative(
            _length(min_height, "Mesh.softness", "min_height"), "Mesh.softness", "min_height"
        )
        return height**2 / self._mean_height_squared

    def min_height(self, softness: float) -> float:
        """The least triangle height d = h̄ √Ξ that gives a softness, the inverse of `softness`.

        Parameters
        ----------
        softness : float
            Ξ, 0 or more.

        Returns
        -------
        float
            d, nm.

        Raises
        ------
        MeshError
            If Ξ is negative or not a finite number.
        """
        value = inputs.not_negative(softness, "Mesh.min_height", "softness")
        return math.sqrt(value * self._mean_height_squared)

    @property
    def _mean_height_squared(self) -> float:
        """h̄² = √3 A / num_triangles, nm²."""
        return math.sqrt(3) * self.area / self.num_triangles
