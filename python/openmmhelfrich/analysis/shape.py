"""Measures of the shape of a vesicle as a whole."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .._mesh.periodic import corner_positions, unfolded
from .._types import Array, Values
from ._arrays import box_of, check_whole, dot, in_boxes, over_frames
from .elements import edges_of


class Shape(NamedTuple):
    """What `shape` returns; arrays of shape (num_frames,), or scalars for one frame."""

    area: Array
    """Area A of the triangles, nm²."""
    volume: Array
    """Volume V within them, nm³; NaN where the surface has borders or spans its box."""
    reduced_volume: Array
    """6 √π V / A^{3/2}, without unit, 1 for a sphere."""
    radius_of_gyration: Array
    """√(λ1 + λ2 + λ3) of the gyration tensor's eigenvalues, nm."""
    asphericity: Array
    """λ3 − (λ1 + λ2)/2, nm², λ3 the largest."""
    acylindricity: Array
    """λ2 − λ1, nm²."""
    anisotropy: Array
    """Relative shape anisotropy κ², without unit: 0 for a sphere, ¼ for a flat disk and 1 for a
    rod."""


def shape(vertices: Any, triangles: Any, *, box: Values | None = None) -> Shape:
    """Area, volume, reduced volume and the measures of the gyration tensor.

    With the eigenvalues λ1 ≤ λ2 ≤ λ3 of the tensor of `gyration_tensor`: R_g² = λ1 + λ2 + λ3,
    asphericity b = λ3 − (λ1 + λ2)/2, acylindricity c = λ2 − λ1, and the relative shape anisotropy
    κ² = (b² + ¾ c²) / R_g⁴. Theodorou and Suter, doi:10.1021/ma00148a028.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own;
        counter-clockwise seen from outside.
    box : array_like or Quantity, optional
        Periodic box, shape (3, 3), or (num_frames, 3, 3) if each frame has its own, nm: each
        connected part is put together by nearest images. Default: that of a `Mesh` among the other
        arguments, if it has one; with a trajectory then the boxes in its file, if there are any.

    Returns
    -------
    Shape
        The measures, one value for each frame. Volume and reduced volume are NaN if the surface has
        a border; they and the measures of the gyration tensor if it spans the box.

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, an index out of range, or a coordinate that is not finite.
    """
    box = box_of(box, vertices, triangles)

    def work(frames, faces, box):
        start, end, _, right = edges_of(faces)
        has_border = bool((right < 0).any())
        spans = np.zeros(len(frames), dtype=bool)
        if box is not None:
            edges = np.column_stack([start, end])
            whole = [unfolded(frame, edges, box) for frame in frames]
            frames = np.stack([places for places, _, _ in whole])
            spans = np.array([spanning.any() for _, _, spanning in whole])
        positions = frames - frames.mean(axis=1, keepdims=True)
        a, b, c = np.moveaxis(corner_positions(positions, faces, box), 2, 0)
        normals = np.cross(b - a, c - a)
        area = np.linalg.norm(normals, axis=2).sum(axis=1) / 2
        # A sum of a·(b × c) about the mean of the vertices, where rounding is least.
        volume = dot(a, np.cross(b, c)).sum(axis=1) / 6
        volume = np.where(spans | has_border, np.nan, volume)
        values = np.linalg.eigvalsh(_tensor(positions))
        small, middle, large = np.where(spans[:, np.newaxis], np.nan, values).T
        square = small + middle + large
        asphericity = large - (small + middle) / 2
        acylindricity = middle - small
        return (
            area,
            volume,
            6 * np.sqrt(np.pi) * volume / area**1.5,
            np.sqrt(square),
            asphericity,
            acylindricity,
            (asphericity**2 + 0.75 * acylindricity**2) / square**2,
        )

    return Shape(*over_frames(in_boxes(work, box), vertices, triangles, lambda n, t: 20 * t))


def gyration_tensor(vertices: Any) -> Array:
    """Gyration tensor of the vertices, S = Σ_i (x_i − x̄)(x_i − x̄)ᵀ / N.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.

    Returns
    -------
    ndarray
        Shape (3, 3) or (num_frames, 3, 3), nm². Its trace is the square of the radius of gyration.

    Raises
    ------
    TypeError
        A Quantity that is no length.
    ValueError
        A wrong shape, a coordinate that is not finite, or a Mesh that spans its periodic box.
    """
    check_whole("gyration_tensor", vertices)

    def work(frames, faces, first):
        return _tensor(frames - frames.mean(axis=1, keepdims=True))

    return over_frames(work, vertices)


def area_excess(vertices: Any, triangles: Any, *, box: Any = None) -> Array | float:
    """Area in excess of the sphere of equal volume, A / 4πR_V² − 1 with R_V = (3V/4π)^⅓.

    `theory.area_excess` has its mean for thermal undulations. In terms of the reduced volume v it
    is v^{−2/3} − 1. Flat triangles have an excess of their own, 0.06 % for 1002 vertices
    on a sphere.

    Parameters
    ----------
    vertices, triangles, box
        As for `shape`.

    Returns
    -------
    float or ndarray
        The excess of each frame, without unit.

    Raises
    ------
    TypeError
        As for `shape`.
    ValueError
        As for `shape`; a surface that encloses nothing; a frame that is inside out, whose volume is
        negative.
    """
    reduced = np.asarray(shape(vertices, triangles, box=box).reduced_volume)
    if np.isnan(reduced).any():
        raise ValueError(
            "area_excess: the surface has a border or spans its periodic box, and so has no volume"
        )
    inverted = np.flatnonzero(reduced <= 0)
    if len(inverted):
        frame = f"frame {inverted[0]}" if reduced.ndim else "the mesh"
        raise ValueError(
            f"area_excess: {frame} is inside out, its volume is not positive; reverse its triangles"
        )
    return reduced[()] ** (-2 / 3) - 1


def _tensor(positions):
    return np.matmul(positions.transpose(0, 2, 1), positions) / positions.shape[1]
