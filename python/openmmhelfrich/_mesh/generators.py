"""`Mesh.icosphere` and its like: meshes of simple shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._numbers import length
from .._types import Scalar
from ..errors import MeshError
from . import lattices, spheres

if TYPE_CHECKING:
    from ..mesh import Mesh

__all__ = ["Generators"]

# Squares of areas of larger meshes, nm, overflow.
_LARGEST = 1e70


def _length(value: Scalar, where: str, name: str) -> float:
    """The size of a mesh, nm."""
    size = length(value, where, name)
    if size >= _LARGEST:
        raise MeshError(f"{where}: {name} must be below {_LARGEST:g} nm, got {size}")
    return size


class Generators:
    """What `Mesh` has for making meshes of simple shapes.

    The arrays are made in ``spheres.py`` and ``lattices.py``.
    """

    @classmethod
    def icosphere(cls, n: int, radius: Scalar) -> Mesh:
        """A regular sphere about the origin, of 10 n² + 2 vertices and 20 n² triangles.

        The icosahedron with every side cut into n parts, projected on the sphere (class-I
        subdivision). Twelve vertices have degree 5, all others degree 6.

        Parameters
        ----------
        n : int
            Parts per side of the icosahedron, 1 or more.
        radius : float or Quantity
            Radius, nm, above 0.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        return cls(*spheres.icosphere(n, _length(radius, "Mesh.icosphere", "radius")))

    @classmethod
    def random_sphere(cls, num_vertices: int, radius: Scalar, seed: int = 0) -> Mesh:
        """An irregular, nearly even sphere about the origin, with degrees 5 to 7.

        A jittered lattice relaxed with Lloyd's algorithm, see `_mesh.spheres`. Vertices of degree
        5 outnumber those of degree 7 by 12 (Euler). Some 0.5 s for 1002 vertices, 8 s for 10 002.

        Parameters
        ----------
        num_vertices : int
            12, or 14 and more: 13 vertices of degree 5 to 7 do not exist.
        radius : float or Quantity
            Radius, nm, above 0.
        seed : int
            Equal seeds give equal meshes. Default 0.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        radius = _length(radius, "Mesh.random_sphere", "radius")
        return cls(*spheres.random_sphere(num_vertices, radius, seed))

    @classmethod
    def sheet(cls, nx: int, ny: int, spacing: Scalar, periodic: bool = False) -> Mesh:
        """A flat sheet of equilateral triangles in the plane z = 0, its normal along z.

        Of ny rows along x of nx vertices each, the first vertex at the origin; odd rows are shifted
        by half of the spacing, and rows are √3/2 of it apart. A periodic sheet spans its box in x
        and y, which is as high as it is long; if ny is odd, b leans over by half of the spacing.

        Parameters
        ----------
        nx, ny : int
            Vertices in a row, and rows; each 2 or more, 3 or more if periodic.
        spacing : float or Quantity
            Length of every edge, nm, above 0.
        periodic : bool
            Default: with a border.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        return cls(*lattices.sheet(nx, ny, _length(spacing, "Mesh.sheet", "spacing"), periodic))

    @classmethod
    def tube(
        cls, n_around: int, n_along: int, radius: Scalar, length: Scalar, periodic: bool = False
    ) -> Mesh:
        """A tube about the z axis, of rings of vertices, its normal outward.

        Of n_along rings of n_around vertices each, from z = 0; odd rings are turned by half of a
        step. Equal edges need rings √3/2 of a step apart, n_along ≈ n_around length / (√3 π
        radius). An open tube has rings at both of its ends, n_along − 1 steps apart. A periodic one
        spans its box along z, n_along steps; across, the box is two diameters wide.

        Parameters
        ----------
        n_around : int
            Vertices in a ring, 3 or more.
        n_along : int
            Rings, 2 or more; an even number from 4 if periodic.
        radius : float or Quantity
            Distance of the vertices from the axis, nm, above 0. The area is a little below
            2 π radius length, since edges are chords.
        length : float or Quantity
            From end to end, or of the box, nm, above 0.
        periodic : bool
            Default: with two borders.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        radius = _length(radius, "Mesh.tube", "radius")
        length = _length(length, "Mesh.tube", "length")
        return cls(*lattices.tube(n_around, n_along, radius, length, periodic))

    @classmethod
    def disk(cls, n: int, radius: Scalar) -> Mesh:
        """A flat disk about the origin in the plane z = 0, of 3 n² + 3 n + 1 vertices.

        A hexagon of a triangular lattice drawn out to a disk: rings k = 1 … n about the middle, of
        6 k evenly spaced vertices at radius k radius / n. All inner vertices have degree 6. Its
        normal is along z.

        Parameters
        ----------
        n : int
            Rings, 1 or more; the border has 6 n vertices.
        radius : float or Quantity
            Of the vertices at the border, nm, above 0.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        return cls(*lattices.disk(n, _length(radius, "Mesh.disk", "radius")))

    @classmethod
    def torus(cls, n: int, R: Scalar, r: Scalar) -> Mesh:
        """A torus about the z axis, of n vertices round its tube, all of degree 6.

        Of m = 2 round(n R / √3 r) rings, but at least 4, so that triangles are equilateral on the
        average; they are longer outside and shorter inside, by r / R. n m vertices.

        Parameters
        ----------
        n : int
            Vertices in a ring, 3 or more.
        R, r : float or Quantity
            Distance of the tube's middle from the axis, and radius of the tube, nm, R > r > 0.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        R, r = _length(R, "Mesh.torus", "R"), _length(r, "Mesh.torus", "r")
        return cls(*lattices.torus(n, R, r))

    @classmethod
    def schwarz_p(cls, n: int, size: Scalar) -> Mesh:
        """A cubic cell of Schwarz' P surface, which is triply periodic, nearly: of genus 3.

        Vertices are on the level surface cos x + cos y + cos z = 0 of the cube −π … π, whose
        mean curvature is nearly zero; its area, 2.353 size², is 0.4 % above that of the minimal
        surface, 2.345 size². Eight hexagonal patches, mirror images of one another, with n edges on
        each side have 24 n² − 4 vertices and 48 n² triangles. Twelve vertices have degree 8, all
        others 6. Minimize the bending energy to come to the minimal surface.

        Parameters
        ----------
        n : int
            Edges on each side of a patch, 1 or more.
        size : float or Quantity
            Of the cube and the box, nm, above 0.

        Raises
        ------
        MeshError
            If an argument is out of range.
        """
        return cls(*lattices.schwarz_p(n, _length(size, "Mesh.schwarz_p", "size")))
