"""The energy of a mesh as a function of the place of one of its vertices."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import openmm
from openmm import unit

from .._mesh.on_openmm import context_of
from .._numbers import positive_number, whole_number
from .._types import Array


class Grid(NamedTuple):
    """Points to which a vertex is moved, as `sphere_grid` and `plane_grid` make them."""

    points: Array
    """Positions, shape (size, size, 3), nm; the first axis is that of `v`."""
    u: Array
    """First coordinate, shape (size,), nm."""
    v: Array
    """Second coordinate, shape (size,), nm."""


def sphere_grid(mesh: Any, vertex: int, half_width: float | None = None, size: int = 320) -> Grid:
    """Points on the sphere through a vertex, about the mean of all vertices.

    u and v are arc lengths along two perpendicular great circles through the vertex, u towards its
    first neighbour, on the map that keeps distances from the vertex (azimuthal equidistant).

    Parameters
    ----------
    mesh : Mesh
    vertex : int
        Index of the vertex.
    half_width : float, optional
        Range of u and v on either side, nm. Default: twice the mean length of the vertex' edges.
    size : int
        Points per side, 2 or more. An odd number has the vertex' own place at the centre. Default
        320, as in Figs. 16–19 of doi:10.1103/PhysRevE.108.015301.

    Returns
    -------
    Grid

    Raises
    ------
    ValueError
        There is no such vertex, it lies at the centre, or a number is out of range.
    """
    centre, radius, normal, first, axis = _frame("sphere_grid", mesh, vertex, half_width, size)
    second = np.cross(normal, first)
    u, v = np.meshgrid(axis, axis)
    distance = np.hypot(u, v)
    # sin x / x, which numpy has with a factor of π.
    along = np.sinc(distance / radius / np.pi)
    points = (
        centre
        + radius * np.cos(distance / radius)[..., np.newaxis] * normal
        + along[..., np.newaxis] * (u[..., np.newaxis] * first + v[..., np.newaxis] * second)
    )
    return Grid(points, axis, axis.copy())


def plane_grid(mesh: Any, vertex: Any, half_width: float | None = None, size: int = 320) -> Grid:
    """Points on a plane perpendicular to the surface, through a vertex.

    u is along the surface, towards the first neighbour of the vertex, v along the radius, outward.

    Parameters
    ----------
    mesh, vertex, half_width, size
        As for `sphere_grid`.

    Returns
    -------
    Grid

    Raises
    ------
    ValueError
        As for `sphere_grid`.
    """
    centre, radius, normal, first, axis = _frame("plane_grid", mesh, vertex, half_width, size)
    u, v = np.meshgrid(axis, axis)
    points = centre + (radius + v)[..., np.newaxis] * normal + u[..., np.newaxis] * first
    return Grid(points, axis, axis.copy())


def landscape(mesh: Any, forces: Any, vertex: int, points: Any) -> Any:
    """Energies of forces on a mesh with one vertex moved to each of many points.

    Every point is one evaluation of the whole mesh on OpenMM's Reference platform, in double
    precision, so that global terms are right too: about 0.25 ms a point and force for 1002
    vertices.

    Parameters
    ----------
    mesh : Mesh
        All other vertices stay where it has them.
    forces : openmm.Force or mapping of str to openmm.Force
        One force, or several by name, such as ``vesicle.placement.forces``. Particle i is vertex i.
        They are copied and stay as they are.
    vertex : int
        Index of the vertex that is moved.
    points : Grid or array_like
        Positions, shape (…, 3), nm.

    Returns
    -------
    ndarray or dict of str to ndarray
        Energies, shape (…), kJ/mol, as they are: subtract ``mesh.energy(force)`` for differences. A
        point at which the energy does not exist, because a triangle has no area there, has NaN.

    Raises
    ------
    MeshError
        The mesh has a periodic box, and a membrane force does not use it.
    ValueError
        There is no such vertex, the last axis of the points is not 3, a point is not finite, or
        there are more than 32 forces.
    openmm.OpenMMException
        The energy does not exist for the mesh itself either.
    """
    vertex = whole_number(vertex, "landscape", "vertex", 0, mesh.num_vertices - 1)
    points = np.asarray(points.points if isinstance(points, Grid) else points, dtype=float)
    if points.ndim == 0 or points.shape[-1] != 3:
        raise ValueError(f"landscape: points need shape (…, 3), got {points.shape}")
    if not np.isfinite(points).all():
        entry = np.argwhere(~np.isfinite(points))[0]
        raise ValueError(f"landscape: points: entry {entry} is not finite")
    single = isinstance(forces, openmm.Force)
    named = {"": forces} if single else dict(forces)
    if not 0 < len(named) <= 32:
        raise ValueError(
            f"landscape: forces need 1 to 32, one for each force group, got {len(named)}"
        )

    context = context_of(mesh.num_vertices, named.values(), mesh.box, "landscape")
    positions = np.array(mesh.vertices)

    def energy(group):
        state = context.getState(getEnergy=True, groups={group})
        return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)

    # What fails for the mesh itself is no matter of single points, and is not caught.
    context.setPositions(positions)
    for group in range(len(named)):
        energy(group)

    places = points.reshape(-1, 3)
    energies = np.full((len(named), len(places)), np.nan)
    for column, place in enumerate(places):
        positions[vertex] = place
        context.setPositions(positions)
        for group in range(len(named)):
            try:
                energies[group, column] = energy(group)
            except openmm.OpenMMException:
                # A triangle without area has no energy, and the entry stays NaN.
                continue
    shaped = {
        name: row.reshape(points.shape[:-1]) for name, row in zip(named, energies, strict=True)
    }
    return shaped[""] if single else shaped


def _frame(where, mesh, vertex, half_width, size):
    """Centre and radius of the sphere, normal and tangent at the vertex, and axis."""
    vertex = whole_number(vertex, where, "vertex", 0, mesh.num_vertices - 1)
    size = whole_number(size, where, "size", 2)
    centre = mesh.vertices.mean(axis=0)
    outward = mesh.vertices[vertex] - centre
    radius = np.linalg.norm(outward)
    if not radius > 0:
        raise ValueError(
            f"{where}: vertex {vertex} lies at the mean of the vertices, which has no normal"
        )
    ends = mesh.edges[(mesh.edges == vertex).any(axis=1)]
    others = np.where(ends[:, 0] == vertex, ends[:, 1], ends[:, 0])
    steps = mesh.vertices[others] - mesh.vertices[vertex]
    if half_width is None:
        half_width = 2 * np.linalg.norm(steps, axis=1).mean()
    half_width = positive_number(half_width, where, "half_width")
    normal = outward / radius
    tangent = steps[0] - (steps[0] @ normal) * normal
    tangent /= np.linalg.norm(tangent)
    axis = np.linspace(-half_width, half_width, size)
    return centre, radius, normal, tangent, axis
