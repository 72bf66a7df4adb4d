"""Triangulated surfaces, closed, open or periodic: validated, oriented, immutable."""

from __future__ import annotations

import functools
import math

import numpy as np

from . import _core
from ._mesh import (
    files,
    fluctuate,
    generate,
    geometry,
    inputs,
    lattices,
    on_openmm,
    periodic,
    transform,
)
from ._units import length as _length
from .errors import MeshError

__all__ = ["Mesh", "MeshError"]


class Mesh:
    """An oriented, 2-manifold triangulation of one or several surfaces, closed or with borders.

    Triangles of a closed surface are counter-clockwise seen from outside, so that normals point
    outward and the volume is positive. Each connected part is oriented by itself, even if it lies
    inside of another one; one with borders, or one that spans a periodic box, has no outside, and
    keeps the orientation of its first triangle. Areas and volumes are sums over the parts. A mesh
    never changes: its arrays are read-only, and transformations return a new mesh.

    In a periodic box a vertex stands for all of its images, and a triangle has those corners that
    are nearest to each other. So vertices may be wrapped into the box or not, each by itself. A
    force made of such a mesh uses periodic boundary conditions; give its System the box,
    ``system.setDefaultPeriodicBoxVectors(*mesh.box)``.

    Parameters
    ----------
    vertices : array_like or Quantity
        Positions, shape (num_vertices, 3), nm.
    triangles : array_like of int
        Vertex indices from 0, shape (num_triangles, 3), of any integer type, in any orientation:
        triangles are turned where needed.
    box : array_like or Quantity, optional
        Periodic box, rows a, b, c in OpenMM's reduced form, shape (3, 3), nm. Default: none.

    Raises
    ------
    MeshError
        If a shape, a type or a unit is wrong; if a coordinate is not finite or an index out of
        range; if a triangle repeats a vertex, repeats another triangle or has no area; if an edge
        belongs to more than two triangles; if the triangles at a vertex form more than one fan; if
        a vertex is unused or lies exactly on another one; if the surface cannot be oriented or is
        empty; if an edge is not shorter than half the width of the box, so that its nearest image
        may be another one. The message names the culprit.

    Notes
    -----
    Equations (B…) and (29–31) in this class are those of doi:10.1103/PhysRevE.108.015301. Two
    meshes are equal if they have the same vertices and triangles in the same order, and equal
    boxes.

    Examples
    --------
    >>> mesh = Mesh.icosphere(10, radius=1000)
    >>> mesh.num_vertices, mesh.num_triangles
    (1002, 2000)
    >>> flat = mesh.oblate(reduced_volume=0.6)
    >>> round(flat.reduced_volume, 6)
    0.6
    >>> Mesh.sheet(8, 8, spacing=5, periodic=True).is_closed
    True
    """

    def __init__(self, vertices, triangles, box=None):
        points = inputs.vertex_array(vertices)
        corners = inputs.triangle_array(triangles)
        cell = None if box is None else inputs.box_array(box, "Mesh")
        _core.orient(points, corners, cell)
        points.flags.writeable = False
        corners.flags.writeable = False
        # A view of an array that cannot be written to can never be made writeable.
        self.__dict__.update(_vertices=points.view(), _triangles=corners.view(), _box=cell)

    def __setattr__(self, name, value):
        raise AttributeError(f"Mesh: cannot set {name}, a mesh is immutable; make a new one")

    @classmethod
    def read(cls, path, *, triangulate=False, merge=None, drop_unused=False) -> Mesh:
        """Read a mesh from a PLY, OBJ, STL, OFF, VTK, VTP, VTU or Gmsh (``.msh``) file.

        Numbers are taken as nm; use `scaled` for other units. Digits of text files are kept to
        double precision, whatever type a PLY header declares. The repeated corners of an STL file
        become one vertex if their coordinates are equal. Points and lines of VTK's files and of a
        Gmsh model are ignored. A byte-order mark is skipped, and lines may end in any way. Further
        formats that meshio or trimesh can read are handed to them.

        Parameters
        ----------
        path : str or Path
            The extension gives the format.
        triangulate : bool
            Split faces of more than three corners: quadrilaterals along the shorter diagonal,
            larger ones by cutting off corners along the shortest diagonals inside; of equal ones,
            along that at the earliest corner. Default: such faces are refused.
        merge : float or Quantity, optional
            Join vertices at most so far apart, nm, in the numbers of the file; the first one stays
            where it is. 0 joins vertices in the same place. Default: none but the equal corners of
            an STL file, and a mesh is refused whose borders nearly touch, as if vertices had been
            written twice.
        drop_unused : bool
            Leave out vertices that belong to no triangle. Default: they are refused.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        MeshError
            If the extension is unknown; if the file is broken or truncated, naming the line (the
            number of bytes, for binary files); if it has faces that cannot be split, or other than
            triangles without `triangulate`; if `merge` would join two corners of a triangle; if
            its mesh is not valid, see `Mesh`, or open along vertices that nearly coincide. The
            message names what would mend it.
        """
        if merge is not None:
            merge = inputs.not_negative(_length(merge, "Mesh.read", "merge"), "Mesh.read", "merge")
        vertices, triangles, box = files.read(path, triangulate, merge, drop_unused)
        try:
            mesh = cls(vertices, triangles, box)
        except MeshError as reason:
            raise files.explained(path, reason, vertices, triangles) from None
        if merge != 0:
            files.refuse_cracks(path, mesh)
        return mesh

    def write(self, path, *, point_data=None, binary=None) -> None:
        """Write a PLY, OBJ, STL, OFF, VTK, VTU or Gmsh (``.msh``) file, coordinates in nm.

        PLY, OBJ, OFF, STL and VTK are text by default, the others binary; all carry full double
        precision. VTK is legacy POLYDATA, which OVITO reads as text. STL stores no vertex numbers:
        after reading, vertices are in the order of first appearance. The periodic box goes into a
        comment of PLY, where `read` finds it; others have no place for it, see `unfolded`.

        Parameters
        ----------
        path : str or Path
            The extension gives the format. An existing file is overwritten.
        point_data : mapping of str to array_like, optional
            Values of the vertices by name, shape (num_vertices,) or (num_vertices, 3), such as
            curvatures: vertex properties in PLY, point data in VTK, VTU and Gmsh. `read` skips
            them.
        binary : bool, optional
            Write PLY or VTK as binary, which the others are always or never.

        Raises
        ------
        MeshError
            If the extension is unknown, or the format has no room for values or the box or no
            binary form; if values have another shape, or a name has spaces.
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> from openmmhelfrich.analysis import mean_curvature
        >>> mesh = Mesh.icosphere(3, radius=10)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     curvature = mean_curvature(mesh.vertices, mesh.triangles)
        ...     mesh.write(f"{folder}/ball.vtk", point_data={"mean_curvature": curvature})
        """
        files.write(path, self._vertices, self._triangles, point_data, binary, self._box)

    @classmethod
    def from_context(cls, context, force) -> Mesh:
        """The surface of a force in its present state: positions, and triangles after bond flips.

        Parameters
        ----------
        context : openmm.Context
        force : MembraneForce or MonteCarloBondFlip
            Of the System of the Context. Vertex i is the i-th of its particles, in ascending order.

        Returns
        -------
        Mesh
            With the box that the Context has now if the force is periodic.
        """
        return cls(*on_openmm.present(context, force))

    @classmethod
    def icosphere(cls, n, radius) -> Mesh:
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
        return cls(*generate.icosphere(n, _length(radius, "Mesh.icosphere", "radius")))

    @classmethod
    def random_sphere(cls, num_vertices, radius, seed=0) -> Mesh:
        """An irregular, nearly even sphere about the origin, with degrees 5 to 7.

        A jittered lattice relaxed with Lloyd's algorithm, see `_mesh.generate`. Vertices of degree
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
        return cls(*generate.random_sphere(num_vertices, radius, seed))

    @classmethod
    def sheet(cls, nx, ny, spacing, periodic=False) -> Mesh:
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
    def tube(cls, n_around, n_along, radius, length, periodic=False) -> Mesh:
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
    def disk(cls, n, radius) -> Mesh:
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
    def torus(cls, n, R, r) -> Mesh:
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
    def schwarz_p(cls, n, size) -> Mesh:
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

    @property
    def vertices(self) -> np.ndarray:
        """Positions, shape (num_vertices, 3), float64, nm, read-only."""
        return self._vertices

    @property
    def triangles(self) -> np.ndarray:
        """Vertex indices, counter-clockwise seen from outside.

        Shape (num_triangles, 3), int64, read-only.
        """
        return self._triangles

    @property
    def box(self) -> np.ndarray | None:
        """Periodic box, rows a, b, c, shape (3, 3), float64, nm, read-only; None without one."""
        return self._box

    @functools.cached_property
    def corner_positions(self) -> np.ndarray:
        """Corners of every triangle, in a box those beside the first as its nearest images.

        Shape (num_triangles, 3 corners, 3), float64, nm, read-only.
        """
        corners = periodic.corner_positions(self._vertices, self._triangles, self._box)
        corners.flags.writeable = False
        return corners

    @functools.cached_property
    def edges(self) -> np.ndarray:
        """Every edge once, lower index first, in lexicographic order.

        Shape (num_edges, 2), int64, read-only.
        """
        edges = geometry.edges_of(self._triangles)
        edges.flags.writeable = False
        return edges

    @functools.cached_property
    def degrees(self) -> np.ndarray:
        """The number of edges at every vertex, shape (num_vertices,), int64, read-only."""
        degrees = np.bincount(self.edges.ravel(), minlength=self.num_vertices)
        degrees.flags.writeable = False
        return degrees

    @property
    def num_vertices(self) -> int:
        """The number of vertices."""
        return len(self._vertices)

    @property
    def num_triangles(self) -> int:
        """The number of triangles."""
        return len(self._triangles)

    @functools.cached_property
    def border_loops(self) -> list[np.ndarray]:
        """The borders, as the vertices round each: none if the mesh is closed.

        In the direction in which the triangles at the border name them, the surface on the left
        seen from the side of the normals. Each loop begins with its lowest vertex, and loops are in
        the order of those; int64, read-only.
        """
        loops = geometry.border_loops(self._triangles)
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
        vertices = self._vertices
        if self._box is not None:
            vertices, part, spanning = periodic.unfolded(vertices, self.edges, self._box)
            if spanning.any():
                vertex = np.flatnonzero(spanning.any(axis=1)[part])[0]
                raise MeshError(
                    f"Mesh.volume: the part of the mesh with vertex {vertex} spans its periodic "
                    "box and encloses no volume"
                )
        return geometry.volume_enclosed(vertices, self._triangles)

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

    def unfolded(self) -> tuple[np.ndarray, np.ndarray]:
        """The surface as it looks without a box: whole triangles, to draw or to write.

        A part that spans the box is cut at its faces, so it gets borders, and a vertex of triangles
        on both sides appears once for each of its images there. Other parts stay whole.

        Returns
        -------
        vertices : ndarray
            Shape (num_images, 3), nm, in the order of the mesh, images one after another.
        triangles : ndarray of int
            Shape (num_triangles, 3), in the order of the mesh.
        """
        if self._box is None:
            return self._vertices, self._triangles
        return periodic.cut(self._vertices, self._triangles, self.edges, self._box)

    def scaled(self, factor) -> Mesh:
        """The mesh with coordinates multiplied by a factor, x → s x, about the origin, and its box.

        Parameters
        ----------
        factor : float or sequence of 3 floats
            One factor s, or one per axis (s_x, s_y, s_z), not 0. Where the product is negative the
            mesh is mirrored, and its triangles are turned so that they face outward again.

        Raises
        ------
        MeshError
            If the factors are not finite numbers other than 0, or not one or three.
        """
        vertices, box = transform.scaled(self._vertices, factor, self._box)
        return Mesh(vertices, self._triangles, box)

    def translated(self, displacement) -> Mesh:
        """The mesh moved by a displacement.

        Parameters
        ----------
        displacement : array_like or Quantity
            Shape (3,), nm.

        Raises
        ------
        MeshError
            If the displacement is not three finite lengths.
        """
        vertices = transform.translated(self._vertices, displacement)
        return Mesh(vertices, self._triangles, self._box)

    def rotated(self, rotation) -> Mesh:
        """The mesh rotated about the origin, x → R x.

        Parameters
        ----------
        rotation : array_like or scipy.spatial.transform.Rotation
            R, shape (3, 3), orthogonal within 1e-8 and with determinant +1.

        Raises
        ------
        MeshError
            If R is not a rotation matrix, or the mesh has a periodic box, which cannot turn.
        """
        self._refuse_box("Mesh.rotated")
        return Mesh(transform.rotated(self._vertices, rotation), self._triangles)

    def deformed(self, l, m, amplitude) -> Mesh:
        """The mesh with a spherical harmonic added to its radius, r → r (1 + u Y_lm(θ, φ)).

        r, θ and φ are spherical coordinates about the **origin**, θ from the z axis, φ from the
        x axis. Y_lm are real and orthonormal without the Condon–Shortley phase, as in
        `analysis.real_harmonics`: m > 0 goes with cos mφ, m < 0 with sin |m|φ.

        Parameters
        ----------
        l, m : int
            Mode, l ≥ 0 and −l ≤ m ≤ l.
        amplitude : float
            u, without unit.

        Raises
        ------
        MeshError
            If there is no such mode, the amplitude is not finite, a vertex lies at the origin, or
            the deformation would move a vertex to the origin or beyond; if the mesh has a box.
        """
        self._refuse_box("Mesh.deformed")
        return Mesh(transform.deformed(self._vertices, l, m, amplitude), self._triangles)

    def oblate(self, reduced_volume) -> Mesh:
        """The mesh flattened along z to a reduced volume, at unchanged total area.

        An affine deformation about the mean of the vertices, equal along x and y. Area and volume
        are those of the triangles, so that `area` and `reduced_volume` of the result are exact to
        rounding. Meant for spheres: the shape is then close to an oblate spheroid.

        Parameters
        ----------
        reduced_volume : float
            v = 6 √π V / A^{3/2}, above 0 and at most that of the mesh itself.

        Raises
        ------
        MeshError
            If the reduced volume is out of this range, or the mesh is open or has a box.
        """
        return self._spheroid(reduced_volume, False, "Mesh.oblate")

    def prolate(self, reduced_volume) -> Mesh:
        """The mesh stretched along z to a reduced volume, at unchanged total area.

        The counterpart of `oblate`, which see for arguments and errors.
        """
        return self._spheroid(reduced_volume, True, "Mesh.prolate")

    def _spheroid(self, reduced_volume, prolate: bool, where: str) -> Mesh:
        self._refuse_box(where)
        geometry.check_closed(self.border_loops, where)
        arrays = self._vertices, self._triangles
        return Mesh(transform.spheroid(*arrays, reduced_volume, prolate, where), self._triangles)

    def _refuse_box(self, where: str) -> None:
        if self._box is not None:
            raise MeshError(
                f"{where}: the mesh has a periodic box; transform Mesh(*mesh.unfolded()), which "
                "has none"
            )

    def fluctuating(self, softness, seed=0, duration=6.5) -> Mesh:
        """A sphere with the same triangles after its vertices have flowed for a short time.

        A run at 300 K with the potentials of area, volume and triangle heights only, from random
        velocities, with OpenMM's Verlet integrator; then the vertices are moved radially back on
        the sphere. With `icosphere` and `random_sphere` it gives the "fluctuating ordered" and
        "fluctuating random" meshes of the paper.

        Parameters
        ----------
        softness : float
            Ξ, which fixes the least height of the triangles, above 0. Softer meshes (smaller Ξ) get
            more irregular.
        seed : int
            Of the velocities. Equal seeds give equal meshes. Default 0.
        duration : float
            Length of the run in relaxation times τ_h = d √(m/ε) of the heights. Default 6.5, after
            which the paper finds the distribution of areas stationary.

        Raises
        ------
        MeshError
            If an argument is out of range; if the mesh is no sphere or has a box; if triangles
            folded over, as happens to large meshes (4002 vertices) at the paper's least softness,
            0.037.
        """
        self._refuse_box("Mesh.fluctuating")
        return Mesh(fluctuate.fluctuating(self, softness, seed, duration), self._triangles)

    def softness(self, min_height) -> float:
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

    def min_height(self, softness) -> float:
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

    def topology(self):
        """An OpenMM topology that shows the mesh as a wire frame in VMD or OVITO.

        Returns
        -------
        openmm.app.Topology
            One chain; one atom ``V`` without element per vertex, in order, each in a residue
            ``MEM`` of its own; one bond per edge, in the order of `edges`; the periodic box.

        Notes
        -----
        The PDB writer of OpenMM 8.6 loses some bonds of atoms with more than four; PDBx does not.
        """
        return on_openmm.topology(self.num_vertices, self.edges, self._box)

    def energy(self, force) -> float:
        """The energy of one force on this mesh, on OpenMM's Reference platform.

        Parameters
        ----------
        force : openmm.Force
            Any force whose particle i is vertex i, in the box of the mesh if it has one. It is
            copied, so that it may belong to a System already and stays as it is.

        Returns
        -------
        float
            Energy, kJ/mol.

        Raises
        ------
        MeshError
            If the mesh has a box and the force is one on triangles that does not use it.
        """
        return on_openmm.energy(self._vertices, force, self._box)

    def __repr__(self) -> str:
        words = [f"{self.num_vertices} vertices", f"{self.num_triangles} triangles"]
        if self.num_components > 1:
            words.append(f"{self.num_components} components")
        if not self.is_closed:
            words.append(f"{len(self.border_loops)} border{'s' * (len(self.border_loops) > 1)}")
        words.append(f"area={self.area:.6g} nm²")
        if self._box is not None:
            words.append(f"box={self._box.tolist()} nm")
        elif self.is_closed:
            words.append(f"volume={self.volume:.6g} nm³")
        return f"Mesh({', '.join(words)})"

    def __eq__(self, other) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        return (
            np.array_equal(self._triangles, other._triangles)
            and np.array_equal(self._vertices, other._vertices)
            # None is equal to itself only.
            and np.array_equal(self._box, other._box)
        )

    def __hash__(self) -> int:
        # Coordinates stay out of it, since 0.0 and −0.0 are equal but differ in their bytes.
        return hash((self.num_vertices, self._triangles.tobytes()))

    def __reduce__(self):
        # Copies and pickles go through the constructor, which makes their arrays read-only too.
        return Mesh, (self._vertices, self._triangles, self._box)
