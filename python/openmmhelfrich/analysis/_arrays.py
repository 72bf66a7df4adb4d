"""Vertices and triangles as the functions of this package take them."""

import numpy as np
from openmm import unit


def frames_of(vertices) -> tuple[np.ndarray, bool]:
    """Positions as an array of frames.

    Parameters
    ----------
    vertices : array_like or Quantity
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.

    Returns
    -------
    frames : ndarray
        Shape (num_frames, num_vertices, 3), nm.
    single : bool
        Whether one frame came without the leading axis, so that the caller drops it again.

    Raises
    ------
    TypeError
        The Quantity is no length.
    ValueError
        The shape is another one, or a coordinate is not finite.
    """
    if unit.is_quantity(vertices):
        if not vertices.unit.is_compatible(unit.nanometer):
            raise TypeError(f"vertices: need a length, got {vertices.unit}")
        vertices = vertices.value_in_unit(unit.nanometer)
    frames = np.asarray(vertices, dtype=float)
    if frames.ndim not in (2, 3) or frames.shape[-1] != 3:
        raise ValueError(
            "vertices: need shape (num_vertices, 3) or (num_frames, num_vertices, 3), "
            f"got {frames.shape}"
        )
    single = frames.ndim == 2
    if single:
        frames = frames[np.newaxis]
    if not np.isfinite(frames).all():
        frame, vertex, axis = np.argwhere(~np.isfinite(frames))[0]
        raise ValueError(
            f"vertices: coordinate {'xyz'[axis]} of vertex {vertex} in frame {frame} is "
            f"{frames[frame, vertex, axis]}"
        )
    return frames, single


def triangles_of(triangles, num_vertices: int) -> np.ndarray:
    """Triangles as an integer array of shape (num_triangles, 3) whose indices are vertices.

    Raises
    ------
    TypeError
        The indices are no integers.
    ValueError
        The shape is another one, or an index is outside of 0 … num_vertices − 1.
    """
    array = np.asarray(triangles)
    if not np.issubdtype(array.dtype, np.integer):
        raise TypeError(f"triangles: need integers, got {array.dtype}")
    if array.ndim != 2 or array.shape[1] != 3 or len(array) == 0:
        raise ValueError(f"triangles: need shape (num_triangles, 3), got {array.shape}")
    outside = (array < 0) | (array >= num_vertices)
    if outside.any():
        row, column = np.argwhere(outside)[0]
        raise ValueError(
            f"triangles: triangle {row} names vertex {array[row, column]}, but there are "
            f"{num_vertices} vertices"
        )
    return array.astype(np.intp, copy=False)


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar products over the last axis."""
    return np.einsum("...i,...i->...", a, b)


def gather_sum(values: np.ndarray, owners: np.ndarray, num_vertices: int) -> np.ndarray:
    """Sum per-corner values over the vertices that own them.

    Parameters
    ----------
    values : ndarray
        Shape (num_frames, num_corners).
    owners : ndarray of int
        The vertex of each corner, shape (num_corners,).
    num_vertices : int
        Length of the result's last axis.

    Returns
    -------
    ndarray
        Shape (num_frames, num_vertices).
    """
    num_frames = len(values)
    # One bincount over all frames is an order of magnitude faster than numpy.add.at.
    index = owners + num_vertices * np.arange(num_frames)[:, np.newaxis]
    flat = np.bincount(index.ravel(), values.ravel(), minlength=num_frames * num_vertices)
    return flat.reshape(num_frames, num_vertices)
