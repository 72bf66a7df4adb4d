"""Solid angles of vertices and triangles."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._types import Array
from ._arrays import check_whole, dot, gather_sum, over_frames


def solid_angles(vertices: Any, triangles: Any) -> Array:
    """Solid angle Ω_i of every vertex: its Voronoi cell after projection to the unit sphere.

    The vertices are projected from the origin. Every spherical triangle is divided among its
    corners by the great circles from its circumcentre to the middles of its sides; parts of
    an obtuse or inverted triangle count with their sign, so that Σ Ω_i = 4π exactly if the origin
    is inside of the surface.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) or (num_frames, num_vertices, 3), nm, from the centre of
        projection.
    triangles : array_like of int or Mesh
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own;
        counter-clockwise seen from outside.

    Returns
    -------
    ndarray
        Ω, shape (num_vertices,) or (num_frames, num_vertices), steradian.

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, an index out of range, a coordinate that is not finite, or a vertex at the
        origin; a Mesh that spans its periodic box, or one that has a box beside other positions.
    """
    check_whole("solid_angles", vertices, triangles)

    def work(frames, faces, first):
        if not frames.any(axis=2).all():
            frame, vertex = np.argwhere(~frames.any(axis=2))[0]
            raise ValueError(
                f"vertices: vertex {vertex} of frame {first + frame} is at the origin, the centre "
                "of projection"
            )
        directions = frames / np.linalg.norm(frames, axis=2, keepdims=True)
        return vertex_solid_angles(directions, faces)

    return over_frames(work, vertices, triangles)


def vertex_solid_angles(directions: Any, faces: Any) -> Any:
    """`solid_angles` of unit vectors, shape (num_frames, num_vertices, 3)."""
    corners = [directions[:, faces[:, corner]] for corner in range(3)]
    a, b, c = corners
    # The circumcentre lies along the normal of the plane triangle. That vector is right for
    # inverted triangles too: it points inward, and the signed areas then come out negative.
    centre = np.cross(b - a, c - a)
    shares = np.zeros((*a.shape[:2], 3))
    for corner in range(3):
        following = (corner + 1) % 3
        middle = corners[corner] + corners[following]
        # The halves of a side are mirror images, so one triangle serves both of its ends.
        half = _signed_solid_angle(corners[corner], middle, centre)
        shares[:, :, corner] += half
        shares[:, :, following] += half
    return gather_sum(shares.reshape(len(shares), -1), faces.ravel(), directions.shape[1])


def triangle_solid_angles(directions: Array, faces: Array) -> Array:
    """A third of the signed solid angles of the triangles around each vertex.

    Parameters
    ----------
    directions : ndarray
        Unit vectors, shape (num_frames, num_vertices, 3).
    faces : ndarray of int
        Shape (num_triangles, 3).

    Returns
    -------
    ndarray
        Shape (num_frames, num_vertices), steradian, 4π in sum.
    """
    angles = _signed_solid_angle(*(directions[:, faces[:, corner]] for corner in range(3)))
    return gather_sum(np.repeat(angles / 3, 3, axis=1), faces.ravel(), directions.shape[1])


def _signed_solid_angle(a, b, c):
    """Solid angle of the triangle a, b, c seen from the origin, positive if counter-clockwise.

    tan(Ω/2) = a·(b×c) / (abc + (a·b)c + (b·c)a + (c·a)b), Van Oosterom and Strackee,
    doi:10.1109/TBME.1983.325207. The vectors need not be unit vectors.
    """
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return 2 * np.arctan2(dot(a, np.cross(b, c)), below)
