"""Triangulated surfaces, closed, open or periodic: validated, oriented, immutable.

`Mesh` has its generators, measures and transformations from the classes of these names in
``_mesh/``, each in a file of its own; here are its arrays, and what reads and writes them.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._mesh import files, geometry, inputs, on_openmm, periodic
from ._mesh.generators import Generators
from ._mesh.measures import Measures
from ._mesh.transformations import Transformations
from ._numbers import length as _length
from ._types import Doubles, File, Integers, Scalar, Values
from .errors import MeshError

if TYPE_CHECKING:
    import openmm

    from .forces import TriangulatedForce

__all__ = ["Mesh", "MeshError"]

# Vertices of a mesh that a notebook draws.
MOST_SHOWN = 20_000


class Mesh(Generators, Measures, Transformations):
    """An oriented, 2-manifold triangulation of one or several surfaces, closed or with borders.

    Triangles of a closed surface are counter-clockwise seen from outside, so that normals point
    outward and the volume is positive. Each connected part is oriented by itself, even if it lies
    inside of another one; one with borders, or one that spans a periodic box, has no outside, and
    keeps the orientation of its first triangle, as does one whose volume is lost in rounding. Areas
    and volumes are sums over the parts. A mesh never changes: its arrays are read-only, and
    transformations return a new mesh.

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
        If a shape, a type or a unit is wrong; if a coordinate is not below 1e100 or an index out of
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

    def __init__(self, vertices: Values, triangles: ArrayLike, box: Values | None = None) -> None:
        points = inputs.vertex_array(vertices)
        corners = inputs.triangle_array(triangles)
        cell = None if box is None else inputs.box_array(box, "Mesh")
        _core.orient(points, corners, cell)
        points.flags.writeable = False
        corners.flags.writeable = False
        # A view of an array that cannot be written to can never be made writeable.
        self.__dict__.update(_vertices=points.view(), _triangles=corners.view(), _box=cell)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"Mesh: cannot set {name}, a mesh is immutable; make a new one")

    @classmethod
    def read(
        cls,
        path: File,
        *,
        triangulate: bool = False,
        merge: Scalar | None = None,
        drop_unused: bool = False,
    ) -> Mesh:
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

    def write(
        self,
        path: File,
        *,
        point_data: Mapping[str, ArrayLike] | None = None,
        binary: bool | None = None,
    ) -> None:
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
    def from_context(cls, context: openmm.Context, force: TriangulatedForce) -> Mesh:
        """The surface of a force in its present state: positions, and triangles after bond flips.

        Parameters
        ----------
        context : openmm.Context
        force : MembraneForce, MonteCarloBondFlip or MonteCarloDomainSwap
            Of the System of the Context. Vertex i is the i-th of its particles, in ascending order.

        Returns
        -------
        Mesh
            With the box that the Context has now if the force is periodic.
        """
        return cls(*on_openmm.present(context, force))

    @property
    def vertices(self) -> Doubles:
        """Positions, shape (num_vertices, 3), float64, nm, read-only."""
        return self._vertices

    @property
    def triangles(self) -> Integers:
        """Vertex indices, counter-clockwise seen from outside.

        Shape (num_triangles, 3), int64, read-only.
        """
        return self._triangles

    @property
    def box(self) -> Doubles | None:
        """Periodic box, rows a, b, c, shape (3, 3), float64, nm, read-only; None without one."""
        return self._box

    @functools.cached_property
    def corner_positions(self) -> Doubles:
        """Corners of every triangle, in a box those beside the first as its nearest images.

        Shape (num_triangles, 3 corners, 3), float64, nm, read-only.
        """
        corners = periodic.corner_positions(self._vertices, self._triangles, self._box)
        corners.flags.writeable = False
        return corners

    @functools.cached_property
    def edges(self) -> Integers:
        """Every edge once, lower index first, in lexicographic order.

        Shape (num_edges, 2), int64, read-only.
        """
        edges = geometry.edges_of(self._triangles)
        edges.flags.writeable = False
        return edges

    @functools.cached_property
    def dihedral_angles(self) -> Doubles:
        """The angle φ between the normals of the two triangles of every edge, radians.

        0 if flat, positive if convex, in (−π, π]; 0 at borders. Shape (num_edges,), in the order
        of `edges`, float64, read-only: what `DihedralForce` takes as angles at rest.
        """
        angles = geometry.dihedral_angles(self.corner_positions, self._triangles)
        angles.flags.writeable = False
        return angles

    @functools.cached_property
    def degrees(self) -> Integers:
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

    def unfolded(self) -> tuple[Doubles, Integers]:
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

    def topology(self) -> openmm.app.Topology:
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

    def energy(self, force: openmm.Force) -> float:
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
        TypeError
            No Force.
        """
        return on_openmm.energy(self._vertices, force, self._box)

    def _with(self, vertices, box=None) -> Mesh:
        """A mesh of the same triangles."""
        return Mesh(vertices, self._triangles, box)

    def _repr_html_(self) -> str | None:
        """What a notebook shows: the surface, or its words alone where it is large."""
        # Each cell would take megabytes, and a browser has room for few of them.
        if self.num_vertices > MOST_SHOWN:
            return None
        from .viewer import view

        title = f"{self.num_vertices} vertices, {self.num_triangles} triangles"
        return view(self, title=title)._repr_html_()

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

    def __eq__(self, other: object) -> bool:
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

    def __reduce__(self) -> tuple[Any, ...]:
        # Copies and pickles go through the constructor, which makes their arrays read-only too.
        return Mesh, (self._vertices, self._triangles, self._box)
