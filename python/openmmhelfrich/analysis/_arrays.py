"""Vertices and triangles as the functions of this package take them, frames in chunks."""

import os

import numpy as np
import openmm
import openmm.app
from openmm import unit

from .._mesh.inputs import box_array
from .._mesh.periodic import unfolded

# Frames are worked on in chunks of about this many numbers, which bounds the memory and stays
# close to the processor.
_CHUNK = 1 << 20


def positions_in(source):
    """Positions of a Mesh, State, Context or Simulation; anything else as it is.

    Those of a Mesh in a periodic box are unfolded, so that parts that cross its faces are whole.

    Raises
    ------
    ValueError
        The State has no positions.
    """
    if hasattr(source, "vertices") and hasattr(source, "triangles"):
        box = getattr(source, "box", None)
        return source.vertices if box is None else unfolded(source.vertices, source.edges, box)[0]
    state = _state_of(source, getPositions=True)
    if state is None:
        return source
    try:
        return state.getPositions(asNumpy=True)
    except (openmm.OpenMMException, TypeError):
        raise ValueError(
            "vertices: the State has no positions; take it with getState(getPositions=True)"
        ) from None


def box_of(box, vertices, triangles=None):
    """The periodic box of an argument, nm, or else that of a Mesh among vertices and triangles.

    With positions of a State, Context or Simulation it is the box that these have now, with those
    of a trajectory that of each frame, if the file has boxes.

    Returns
    -------
    ndarray or None
        Shape (3, 3), or (num_frames, 3, 3) where it changes; None for no box.

    Raises
    ------
    ValueError
        Vectors that are not three, or not of OpenMM's reduced form; boxes of another number of
        frames.
    """
    if box is None:
        boxes = (getattr(source, "box", None) for source in (vertices, triangles))
        box = next((box for box in boxes if box is not None), None)
        return box if box is None else _present_box(vertices, box)
    if np.ndim(getattr(box, "_value", box)) != 3:
        return box_array(box, "analysis")
    if unit.is_quantity(box):
        box = box.value_in_unit(unit.nanometer)
    if len(box) == 0:
        raise ValueError("box: there are those of no frames")
    if np.ndim(getattr(vertices, "_value", vertices)) == 3 and len(vertices) != len(box):
        raise ValueError(f"box: there are those of {len(box)} frames, but {len(vertices)} frames")
    boxes = np.stack([box_array(each, "analysis") for each in box])
    return boxes[0] if (boxes == boxes[0]).all() else boxes


def in_boxes(work, box):
    """A function for `over_frames`, of one that takes frames, triangles and the box of the frames.

    Parameters
    ----------
    work : callable
        work(frames, faces, box), with a box of shape (3, 3) or None.
    box : ndarray or None
        What `box_of` returns.
    """
    if box is None or box.ndim == 2:
        return lambda frames, faces, first: work(frames, faces, box)

    def each(frames, faces, first):
        if first + len(frames) > len(box):
            raise ValueError(f"box: there are those of {len(box)} frames, but more frames")
        parts = [work(frame[np.newaxis], faces, box[first + k]) for k, frame in enumerate(frames)]
        return _joined(parts)

    return each


def check_whole(where: str, vertices, triangles=None) -> None:
    """Refuse a surface whose positions are in pieces, for what has no use for its box.

    Raises
    ------
    ValueError
        A Mesh that spans its periodic box; triangles of a Mesh that has one, with positions of
        something else.
    """
    if getattr(vertices, "box", None) is not None:
        if unfolded(vertices.vertices, vertices.edges, vertices.box)[2].any():
            raise ValueError(f"{where}: the surface spans its periodic box, and so has no centre")
    elif getattr(triangles, "box", None) is not None:
        raise ValueError(
            f"{where}: the mesh of the triangles has a periodic box, which the positions are not "
            "unfolded in; if its surface is whole in them, pass mesh.triangles"
        )


def _state_of(source, **wanted):
    """A State, or that of a Context or Simulation, with what is wanted; of anything else None."""
    if isinstance(source, openmm.app.Simulation):
        source = source.context
    if isinstance(source, openmm.Context):
        source = source.getState(**wanted)
    return source if isinstance(source, openmm.State) else None


def _present_box(source, box):
    """The box, nm, of an object of OpenMM, or boxes of a trajectory; of anything else `box`."""
    state = _state_of(source)
    if state is not None:
        return state.getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)
    from .trajectories import Trajectory

    if isinstance(source, (str, os.PathLike)):
        source = Trajectory(source)
    if isinstance(source, Trajectory):
        boxes = source.boxes()
        return box if boxes is None else box_of(boxes, source)
    return box


def over_frames(work, vertices, triangles=None, cost=None):
    """Call a function of frames on everything that holds frames, chunk by chunk.

    Parameters
    ----------
    work : callable
        work(frames, faces, first) of frames of shape (num_frames, num_vertices, 3) and the index of
        the first of them. It returns an array, or a tuple of arrays, whose first axis is that of
        the frames.
    vertices
        What `frames_of` takes, or a path or `Trajectory`, whose chunks are read as they are needed.
    triangles : array_like of int or Mesh, optional
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own, as
        where bonds flip. Without, `faces` is None.
    cost : callable, optional
        cost(num_vertices, num_triangles), about how many numbers a frame needs in memory. Default:
        30 for each vertex.

    Returns
    -------
    ndarray or tuple of ndarray
        The results of all frames, without their axis if one frame came without it.
    """
    from .trajectories import Trajectory

    if isinstance(vertices, (str, os.PathLike)):
        vertices = Trajectory(vertices)
    single = False
    if isinstance(vertices, Trajectory):
        num_vertices, chunks = vertices.num_vertices, vertices.chunks
        if triangles is not None and np.ndim(triangles) != 3:
            _refuse_triangles_of_the_start(vertices, triangles_of(triangles, num_vertices))
    else:
        frames, single = frames_of(vertices)
        num_vertices = frames.shape[1]

        def chunks(size):
            return (frames[first : first + size] for first in range(0, len(frames), size))

    if np.ndim(triangles) == 3:
        triangles = np.asarray(triangles)
        work, faces, num_faces = _with_own_triangles(work, triangles, num_vertices)
    else:
        faces = None if triangles is None else triangles_of(triangles, num_vertices)
        num_faces = 0 if faces is None else len(faces)
    numbers = 30 * num_vertices if cost is None else cost(num_vertices, num_faces)
    first, parts = 0, []
    for part in chunks(max(1, _CHUNK // max(1, numbers))):
        parts.append(work(frames_of(part)[0], faces, first))
        first += len(part)
    if not parts:
        raise ValueError("vertices: there are no frames")
    if np.ndim(triangles) == 3 and first != len(triangles):
        raise ValueError(
            f"triangles: there are those of {len(triangles)} frames, but {first} frames"
        )
    joined = _joined(parts)
    if not single:
        return joined
    return tuple(column[0] for column in joined) if isinstance(joined, tuple) else joined[0]


def _joined(parts):
    """Results of some frames after another, arrays or tuples of arrays."""
    if not isinstance(parts[0], tuple):
        return np.concatenate(parts)
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


def _refuse_triangles_of_the_start(trajectory, faces: np.ndarray) -> None:
    """Raise a ValueError if bonds on these triangles flipped during the trajectory."""
    own = trajectory.triangles()
    if own is None:
        return
    rows = np.isin(own[0], faces).any(axis=1)
    if any((frame[rows] != own[0, rows]).any() for frame in own):
        raise ValueError(
            f"triangles: bonds flipped in {trajectory.path}, and each frame has triangles of its "
            "own; pass those that Trajectory.triangles() returns, or, to take the same ones for "
            "all frames nevertheless, the array that Trajectory.read() returns as vertices"
        )


def _with_own_triangles(work, triangles, num_vertices: int):
    """Let a function of frames with the same triangles work on frames that have their own."""

    def each(frames, faces, first):
        if first + len(frames) > len(triangles):
            raise ValueError(
                f"triangles: there are those of {len(triangles)} frames, but more frames"
            )
        parts = [
            work(frame[np.newaxis], triangles_of(triangles[first + k], num_vertices), first + k)
            for k, frame in enumerate(frames)
        ]
        return _joined(parts)

    return each, None, triangles.shape[1]


def frames_of(vertices) -> tuple[np.ndarray, bool]:
    """Positions as an array of frames.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context or Simulation
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm; of an object of
        OpenMM, the positions of all its particles.

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
    vertices = positions_in(vertices)
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

    A `Mesh` may stand for its triangles.

    Raises
    ------
    TypeError
        The indices are no integers.
    ValueError
        The shape is another one, or an index is outside of 0 … num_vertices − 1.
    """
    array = np.asarray(getattr(triangles, "triangles", triangles))
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
