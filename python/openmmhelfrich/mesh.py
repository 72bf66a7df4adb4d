"""Triangulated surfaces: validated, oriented, immutable."""

from __future__ import annotations

import functools
import math

import numpy as np

from . import _core
from ._mesh import files, fluctuate, generate, geometry, inputs, on_openmm, transform
from ._units import length
from .errors import MeshError

__all__ = ["Mesh", "MeshError"]


class Mesh:
    """An oriented, 2-manifold triangulation of one or several surfaces, closed or with borders.

    Triangles are counter-clockwise seen from outside, so that normals point outward and the volume
    is positive. Several components are allowed; each closed one is oriented outward by itself, even
    if it lies inside of another one, and areas and volumes are sums over the components. One with
    borders is oriented as its first triangle is. What needs a closed surface, such as the volume,
    is refused where there is a border. A mesh never changes: its arrays are read-only, and
    transformations return a new mesh.

    Parameters
    ----------
    vertices : array_like or Quantity
        Positions, shape (num_vertices, 3), nm.
    triangles : array_like of int
        Vertex indices from 0, shape (num_triangles, 3), of any integer type, in any orientation:
        triangles are turned where needed.

    Raises
    ------
    MeshError
        If a shape, a type or a unit is wrong; if a coordinate is not finite or an index out of
        range; if a triangle repeats a vertex, repeats another triangle or has no area; if an edge
        belongs to more than two triangles; if the triangles at a vertex form more than one
        fan; if a vertex is unused or lies exactly on another one; if the surface cannot be oriented
        or is empty. The message names the culprit.

    Notes
    -----
    Equations (B…) and (29–31) in this class are those of doi:10.1103/PhysRevE.108.015301. Two
    meshes are equal if they have the same vertices and triangles in the same order.

    Examples
    --------
    >>> mesh = Mesh.icosphere(10, radius=1000)
    >>> mesh.num_vertices, mesh.num_triangles
    (1002, 2000)
    >>> flat = mesh.oblate(reduced_volume=0.6)
    >>> round(flat.reduced_volume, 6)
    0.6
    """

    def __init__(self, vertices, triangles):
        points = inputs.vertex_array(vertices)
        corners = inputs.triangle_array(triangles)
        _core.orient(points, corners)
        points.flags.writeable = False
        corners.flags.writeable = False
        # A view of an array that cannot be written to can never be made writeable.
        self.__dict__.update(_vertices=points.view(), _triangles=corners.view())

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
            an STL file.
        drop_unused : bool
            Leave out vertices that belong to no triangle. Default: they are refused.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        MeshError
            If the extension is unknown; if the file is broken or truncated, naming the line (the
            number of bytes, for binary files); if it has faces that cannot be split, or other than
            triangles without `triangulate`; if `merge` would join two corners of a triangle; or if
            its mesh is not valid, see `Mesh`, or has borders where vertices nearly coincide. The
            message names what would mend it.
        """
        if merge is not None:
            merge = inputs.not_negative(length(merge, "Mesh.read", "merge"), "Mesh.read", "merge")
        vertices, triangles = files.read(path, triangulate, merge, drop_unused)
        try:
            mesh = cls(vertices, triangles)
            files.check_seams(mesh.borders, vertices, triangles)
        except MeshError as reason:
            raise files.explained(path, reason, vertices, triangles) from None
        return mesh

    def write(self, path, *, point_data=None, binary=None) -> None:
        """Write a PLY, OBJ, STL, OFF, VTK, VTU or Gmsh (``.msh``) file, coordinates in nm.

        PLY, OBJ, OFF, STL and VTK are text by default, the others binary; all carry full double
        precision. VTK is legacy POLYDATA, which OVITO reads as text. STL stores no vertex numbers:
        after reading, vertices are in the order of first appearance.

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
            If the extension is unknown, or the format has no room for values or no binary form; if
            values have another shape, or a name has spaces.
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
        files.write(path, self._vertices, self._triangles, point_data, binary)

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
        return cls(*generate.icosphere(n, length(radius, "Mesh.icosphere", "radius")))

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
        radius = length(radius, "Mesh.random_sphere", "radius")
        return cls(*generate.random_sphere(num_vertices, radius, seed))

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
    def borders(self) -> tuple[np.ndarray, ...]:
        """The vertices of each border in turn, the surface on the left, from the lowest one.

        One int64 array for each border, read-only; none for a closed surface.
        """
        loops = geometry.border_loops(self._triangles)
        for loop in loops:
            loop.flags.writeable = False
        return loops

    @functools.cached_property
    def area(self) -> float:
        """Total area A = Σ_t |AB × AC| / 2 (B2), nm²."""
        return geometry.surface_area(self._vertices, self._triangles)

    @functools.cached_property
    def volume(self) -> float:
        """Enclosed volume V = Σ_t A · (B × C) / 6 (B3, B4), summed over components, nm³.

        Raises MeshError if the surface has a border.
        """
        geometry.check_closed(self.borders, "Mesh.volume")
        return geometry.volume_enclosed(self._vertices, self._triangles)

    @property
    def reduced_volume(self) -> float:
        """Volume over that of the sphere of equal total area, v = 6 √π V / A^{3/2}; at most 1.

        Raises MeshError if the surface has a border.
        """
        return geometry.reduced_volume(self.area, self.volume)

    @property
    def euler_characteristic(self) -> int:
        """num_vertices − num_edges + num_triangles: 2 for a sphere, 1 for a disk."""
        return self.num_vertices - len(self.edges) + self.num_triangles

    @functools.cached_property
    def num_components(self) -> int:
        """The number of connected surfaces that the mesh consists of."""
        return geometry.component_count(self.num_vertices, self.edges)

    def scaled(self, factor) -> Mesh:
        """The mesh with coordinates multiplied by a factor, x → s x, about the origin.

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
        return Mesh(transform.scaled(self._vertices, factor), self._triangles)

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
        return Mesh(transform.translated(self._vertices, displacement), self._triangles)

    def rotated(self, rotation) -> Mesh:
        """The mesh rotated about the origin, x → R x.

        Parameters
        ----------
        rotation : array_like or scipy.spatial.transform.Rotation
            R, shape (3, 3), orthogonal within 1e-8 and with determinant +1.

        Raises
        ------
        MeshError
            If R is not a rotation matrix.
        """
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
            the deformation would move a vertex to the origin or beyond.
        """
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
            If the reduced volume is out of this range, or the surface has a border.
        """
        return self._spheroid(reduced_volume, False, "Mesh.oblate")

    def prolate(self, reduced_volume) -> Mesh:
        """The mesh stretched along z to a reduced volume, at unchanged total area.

        The counterpart of `oblate`, which see for arguments and errors.
        """
        return self._spheroid(reduced_volume, True, "Mesh.prolate")

    def _spheroid(self, reduced_volume, prolate: bool, where: str) -> Mesh:
        geometry.check_closed(self.borders, where)
        arrays = self._vertices, self._triangles
        return Mesh(transform.spheroid(*arrays, reduced_volume, prolate, where), self._triangles)

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
            If an argument is out of range; if the mesh is no sphere; if triangles folded over, as
            happens to large meshes (4002 vertices) at the paper's least softness, 0.037.
        """
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
            length(min_height, "Mesh.softness", "min_height"), "Mesh.softness", "min_height"
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
            ``MEM`` of its own; one bond per edge, in the order of `edges`.

        Notes
        -----
        The PDB writer of OpenMM 8.6 loses some bonds of atoms with more than four; PDBx does not.
        """
        return on_openmm.topology(self.num_vertices, self.edges)

    def energy(self, force) -> float:
        """The energy of one force on this mesh, on OpenMM's Reference platform.

        Parameters
        ----------
        force : openmm.Force
            Any force whose particle i is vertex i. It is copied, so that it may belong to a System
            already and stays as it is.

        Returns
        -------
        float
            Energy, kJ/mol.
        """
        return on_openmm.energy(self._vertices, force)

    def __repr__(self) -> str:
        parts = "" if self.num_components == 1 else f", {self.num_components} components"
        rest = f"{len(self.borders)} border(s)" if self.borders else f"volume={self.volume:.6g} nm³"
        return (
            f"Mesh({self.num_vertices} vertices, {self.num_triangles} triangles{parts}, "
            f"area={self.area:.6g} nm², {rest})"
        )

    def __eq__(self, other) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        return np.array_equal(self._triangles, other._triangles) and np.array_equal(
            self._vertices, other._vertices
        )

    def __hash__(self) -> int:
        # Coordinates stay out of it, since 0.0 and −0.0 are equal but differ in their bytes.
        return hash((self.num_vertices, self._triangles.tobytes()))

    def __reduce__(self):
        # Copies and pickles go through the constructor, which makes their arrays read-only too.
        return Mesh, (self._vertices, self._triangles)
