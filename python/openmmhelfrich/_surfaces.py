"""What the force classes have to do with arrays: triangles, particles, references, domains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from openmm import unit

from . import _forces
from ._mesh.inputs import box_array
from ._numbers import length_array
from ._proxies import Copies, add_triangles, name_of
from ._types import Array, Doubles, Integers, Values
from ._values import triangles, whole_numbers

if TYPE_CHECKING:
    import openmm

    from .mesh import Mesh

__all__ = ["Domains", "Particles", "Reference", "Triangulated", "domain_array"]


class Triangulated(Copies):
    """Triangles: those of a force, and those of a Context."""

    def addTriangle(self, particle1: int, particle2: int, particle3: int) -> int:
        """Add a triangle.

        Parameters
        ----------
        particle1, particle2, particle3 : int
            The indices of its corners, counter-clockwise seen from outside.

        Returns
        -------
        int
            The index of the triangle that was added.
        """
        ((one, two, three),) = triangles(name_of(self), [[particle1, particle2, particle3]])
        return _forces.TriangulatedForce_addTriangle(self, int(one), int(two), int(three))

    def addTriangles(self, given: Mesh | ArrayLike, *, offset: int = 0) -> None:
        """Add many triangles.

        Parameters
        ----------
        given : Mesh or array_like of int, shape (num_triangles, 3)
            Particle indices, counter-clockwise seen from outside.
        offset : int
            Added to all indices.

        Raises
        ------
        TypeError, ValueError
            If the indices are not integers in triples.
        """
        add_triangles(self, triangles(name_of(self), given, offset))

    def getTrianglesInContext(self, context: openmm.Context) -> Integers:
        """The triangles as they are in a Context now.

        Parameters
        ----------
        context : openmm.Context

        Returns
        -------
        ndarray of int, shape (num_triangles, 3)
            Particle indices, counter-clockwise seen from outside.
        """
        corners = _forces.TriangulatedForce__getTrianglesInContext(self, context)
        return _integers(corners).reshape(-1, 3)

    def setTrianglesInContext(
        self, context: openmm.Context, given: Mesh | ArrayLike, *, offset: int = 0
    ) -> None:
        """Connect the particles of a Context in another way, for all forces on the same triangles.

        Positions stay as they are, and so does the topology of the surface: each of its connected
        parts keeps its particles and its number of triangles, hence of handles.

        Only a MonteCarloBondFlip on the same triangles tells when positions of before come back: a
        Context without one takes a State or checkpoint of before for one of the new triangles, and
        has the triangles of the force again after ``Context.reinitialize()``. (Checkpoints of
        platform Helfrich have the triangles themselves.) One of ``frequency=0`` flips nothing, and
        tells.

        Parameters
        ----------
        context : openmm.Context
        given : Mesh or array_like of int, shape (num_triangles, 3)
            Particle indices, counter-clockwise seen from outside: as many triangles of the same
            particles as there are.
        offset : int
            Added to all indices.

        Raises
        ------
        openmm.OpenMMException
            If they are no such triangles, or a MonteCarloBondFlip does not allow their degrees.
            Nothing has changed then.
        TypeError, ValueError
            If the indices are not integers in triples.
        """
        corners = triangles(name_of(self), given, offset)
        _forces.TriangulatedForce__setTrianglesInContext(self, context, corners.tobytes())

    def getPermutationInContext(self, context: openmm.Context) -> Integers:
        """Whose values the vertices of the surface have in a Context now.

        A `MonteCarloDomainSwap` lets neighbours exchange them. What a force was given for vertices,
        such as `values`, is in the Context ``values[permutation]``.

        Parameters
        ----------
        context : openmm.Context

        Returns
        -------
        ndarray of int, shape (num_vertices,)
            For each vertex, in ascending order of particle index, the number of the vertex whose
            values it has.
        """
        return _integers(_forces.TriangulatedForce__getPermutationInContext(self, context))

    def setPermutationInContext(self, context: openmm.Context, permutation: ArrayLike) -> None:
        """Let the vertices of a surface have each other's values, in all forces on its triangles.

        What holds of `setTrianglesInContext` without a MonteCarloBondFlip holds here without a
        MonteCarloDomainSwap.

        Parameters
        ----------
        context : openmm.Context
        permutation : array_like of int, shape (num_vertices,)
            As `getPermutationInContext` returns it; each vertex comes once.

        Raises
        ------
        openmm.OpenMMException
            If it is no permutation of the vertices. Nothing has changed then.
        TypeError, ValueError
            If it is not integers in one list.
        """
        vertices = whole_numbers(name_of(self), "permutation", "vertex", permutation)
        _forces.TriangulatedForce__setPermutationInContext(self, context, vertices.tobytes())

    def _triangleBuffer(self) -> bytes:
        return _forces.TriangulatedForce__triangleBuffer(self)

    def _getVirial(self, context, groups: int) -> bytes:
        return _forces.TriangulatedForce__getVirial(self, context, groups)

    def _saveConnectivity(self, context) -> bytes:
        return _forces.TriangulatedForce__saveConnectivity(self, context)

    def _restoreConnectivity(self, context, saved: bytes) -> None:
        _forces.TriangulatedForce__restoreConnectivity(self, context, saved)


def _integers(buffer: bytes) -> Integers:
    """C integers as numpy has them."""
    return np.frombuffer(buffer, dtype=np.intc).astype(np.int64)


class Particles:
    """The particles that a surface acts on."""

    def setParticles(self, particles: ArrayLike) -> None:
        """Set the particles that the surface acts on.

        Parameters
        ----------
        particles : array_like of int
            Their indices, none of them a corner of a triangle.

        Raises
        ------
        TypeError, ValueError
            If they are not integers in one list.
        """
        indices = whole_numbers(name_of(self), "particles", "particle", particles)
        _forces.ParticleSurfaceForce__setParticleBuffer(self, indices.tobytes())

    def getParticles(self) -> Integers:
        """The indices of the particles that the surface acts on, shape (num_particles,)."""
        return _integers(_forces.ParticleSurfaceForce__particleBuffer(self))


class Domains:
    """The number of a domain for each vertex."""

    def setDomains(self, domains: ArrayLike) -> None:
        """Say to which domain each vertex belongs. Tell Contexts by updateParametersInContext().

        Parameters
        ----------
        domains : array_like of int, shape (num_vertices,)
            The numbers of the domains, in ascending order of particle index.

        Raises
        ------
        TypeError, ValueError
            If they are not integers in one list.
        """
        _set_vertex_numbers(self, domain_array(name_of(self), domains))

    def getDomains(self) -> Integers:
        """The domain of each vertex in ascending order of particle index, (num_vertices,), int."""
        return _vertex_numbers(self).astype(np.int64)

    def getDomainsInContext(self, context: openmm.Context) -> Integers:
        """The domain of each vertex as it is in a Context now, where neighbours may exchange them.

        Parameters
        ----------
        context : openmm.Context

        Returns
        -------
        ndarray of int, shape (num_vertices,)
            In ascending order of particle index.
        """
        return _integers(_forces.LineTensionForce__getDomainsInContext(self, context))


class Reference:
    """Where each vertex is at rest."""

    def setReference(self, reference: Mesh | Values) -> None:
        """Set where the vertices are at rest. Tell Contexts by updateParametersInContext().

        Parameters
        ----------
        reference : Mesh or array_like or Quantity, shape (num_vertices, 3)
            Positions, nm, in ascending order of particle index. A Mesh brings its periodic box, or
            that it has none; with an array the box stays as it is.

        Raises
        ------
        MeshError
            If they are no such positions.
        """
        points, box = _reference(name_of(self), reference)
        if hasattr(reference, "triangles"):
            self.setReferenceBox(box)
        _set_vertex_numbers(self, points)

    def getReference(self) -> Doubles:
        """Where the vertices are at rest, shape (num_vertices, 3), nm."""
        return _vertex_numbers(self).reshape(-1, 3).copy()

    def setReferenceBox(self, box: Values | None) -> None:
        """Say in which periodic box the reference is: its sides are nearest images in this box.

        A surface that spans the box of its Context needs one; the sides must be shorter than half
        of its least width. Without a box the reference is taken as it is, in one piece.

        Parameters
        ----------
        box : array_like or Quantity, shape (3, 3), or None
            Rows a, b, c in OpenMM's reduced form, nm; None for no box.
        """
        vectors = np.empty(0) if box is None else box_array(box, name_of(self))
        _forces.MembraneForce__setReferenceBoxBuffer(self, np.ascontiguousarray(vectors).tobytes())

    def getReferenceBox(self) -> Doubles | None:
        """The periodic box in which the reference is, shape (3, 3), nm, or None."""
        vectors = np.frombuffer(_forces.MembraneForce__referenceBoxBuffer(self))
        return vectors.reshape(3, 3).copy() if vectors.size else None


def _vertex_numbers(force) -> Doubles:
    return np.frombuffer(_forces.MembraneForce__vertexBuffer(force))


def _set_vertex_numbers(force, numbers: Doubles) -> None:
    _forces.MembraneForce__setVertexBuffer(force, numbers.tobytes())


def _reference(force: str, given) -> tuple[Array, Array | None]:
    """Positions, shape (num_vertices, 3), nm, and the box that a Mesh has."""
    if hasattr(given, "triangles"):
        return np.ascontiguousarray(given.vertices, dtype=np.float64), given.box
    points = length_array(given, force, "reference")
    if points.size and (points.ndim != 2 or points.shape[1] != 3):
        raise ValueError(
            f"{force}: reference must have the shape (num_vertices, 3), got {points.shape}"
        )
    return points, None


def domain_array(caller: str, given) -> Array:
    """Numbers of domains as floats, shape (num_vertices,).

    Parameters
    ----------
    caller : str
        What messages begin with.
    given : array_like of int
        What the user has given.

    Raises
    ------
    TypeError, ValueError
        If they are not integers in one list.
    """
    if unit.is_quantity(given):
        raise TypeError(f"{caller}: domains must be integers, got a Quantity in {given.unit}")
    try:
        array = np.asarray(given)
    except ValueError:
        raise ValueError(
            f"{caller}: domains must be one list, got lists of unequal length"
        ) from None
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(f"{caller}: domains must be integers, got dtype {array.dtype}")
    if array.ndim != 1:
        raise ValueError(f"{caller}: domains must be one list of integers, got {array.shape}")
    return array.astype(np.float64)
