"""What commands that read trajectories share: positions, and the triangles that belong to them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

__all__ = ["open_trajectory"]


def open_trajectory(
    source: Path, mesh_path: Any, membrane: Any, first: int, stride: int, several: bool = False
) -> Any:
    """A trajectory with its triangles: those of each frame if bonds flipped, else those of a mesh.

    Parameters
    ----------
    source : Path
        Of the trajectory.
    mesh_path : Path or None
        Of the mesh. Beside the triangles of each frame it has to have as many, and only its box is
        used. Default: ``<name>.ply`` beside the trajectory, where a run has the mesh of its start,
        if it is of all particles.
    membrane : int or None
        Which closed surface to take where there are several; None if there is one.
    first, stride : int
        First frame, and step, as `start` and `stride` of `analysis.Trajectory`.
    several : bool
        Whether to take all surfaces if none is asked for.

    Returns
    -------
    trajectory : analysis.Trajectory
        Its vertices are those of the surface that was asked for, without other particles.
    triangles : ndarray of int or Mesh
        Shape (num_frames, num_triangles, 3) if bonds flipped, else (num_triangles, 3).
    box : ndarray or None
        The periodic box of the mesh, or of each frame where the file of the trajectory has it.

    Raises
    ------
    ValueError
        Files do not match, or there are several surfaces and none was asked for.
    """
    import numpy as np

    from .. import analysis
    from .._start_mesh import check_whole
    from ..analysis.surface_series import components
    from ..mesh import Mesh

    trajectory = analysis.Trajectory(source, start=first, stride=stride)
    start = source.with_suffix(".ply")
    mesh = None if mesh_path is None else Mesh.read(mesh_path)
    if mesh is None and source.suffix.lower() != ".gsd" and start.is_file():
        beside = Mesh.read(start)
        mesh = beside if beside.num_vertices == trajectory.num_vertices else None
    if mesh is not None and mesh.num_vertices != trajectory.num_vertices:
        raise ValueError(
            f"{source} has {trajectory.num_vertices} particles, and {mesh_path} "
            f"{mesh.num_vertices} vertices; give the mesh of all membranes, or cut out the "
            "membrane first"
        )
    own = trajectory.triangles(None if mesh is None else mesh.num_triangles)
    if own is None and mesh is not None and mesh_path is None:
        check_whole(start, source)
    if own is None and mesh is None:
        raise click.UsageError(
            f"a trajectory needs --mesh, which has its triangles: there is neither {start.name} "
            f"nor {source.with_suffix('.triangles').name} beside it"
        )
    corners = mesh.triangles if own is None else own[0]
    surfaces = components(corners, trajectory.num_vertices)
    numbers = np.unique(surfaces[corners])
    if membrane is None and len(numbers) > 1 and not several:
        raise ValueError(
            f"{source} has {len(numbers)} membranes; choose one with --membrane 0 … "
            f"{len(numbers) - 1}"
        )
    if membrane is not None and membrane >= len(numbers):
        raise ValueError(
            f"--membrane {membrane}: {source} has {len(numbers)}, which are counted from 0"
        )
    wanted = numbers if membrane is None else numbers[membrane]
    chosen = np.flatnonzero(np.isin(surfaces, wanted))
    box = None
    if mesh is not None and mesh.box is not None:
        # A box that breathes is another one in each frame.
        box = mesh.box if (boxes := trajectory.boxes()) is None else boxes
    if len(chosen) == trajectory.num_vertices:
        return trajectory, corners if own is None else own, box
    trajectory = analysis.Trajectory(source, chosen, first, stride=stride)
    if own is not None:
        return trajectory, trajectory.triangles(), box
    inside = np.isin(corners[:, 0], chosen)
    return trajectory, np.searchsorted(chosen, corners[inside]), box
