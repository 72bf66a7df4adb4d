"""What commands that read trajectories share: positions, and the triangles that belong to them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

__all__ = ["open_trajectory"]


def open_trajectory(
    source: Path, mesh_path: Any, membrane: Any, start: int, stride: int, several: bool = False
) -> Any:
    """A trajectory with its triangles: those of each frame if bonds flipped, else those of a mesh.

    Parameters
    ----------
    source : Path
        Of the trajectory.
    mesh_path : Path or None
        Of the mesh. Beside the triangles of each frame it has to have as many, and is not used
        otherwise.
    membrane : int or None
        Which closed surface to take where there are several; None if there is one.
    start, stride : int
        As for `analysis.Trajectory`.
    several : bool
        Whether to take all surfaces if none is asked for.

    Returns
    -------
    trajectory : analysis.Trajectory
        Its vertices are those of the surface that was asked for, without other particles.
    triangles : ndarray of int or Mesh
        Shape (num_frames, num_triangles, 3) if bonds flipped, else (num_triangles, 3).

    Raises
    ------
    ValueError
        Files do not match, or there are several surfaces and none was asked for.
    """
    import numpy as np

    from .. import analysis
    from ..analysis.surface_series import components
    from ..mesh import Mesh

    trajectory = analysis.Trajectory(source, start=start, stride=stride)
    mesh = None if mesh_path is None else Mesh.read(mesh_path)
    if mesh is not None and mesh.num_vertices != trajectory.num_vertices:
        raise ValueError(
            f"{source} has {trajectory.num_vertices} particles, and {mesh_path} "
            f"{mesh.num_vertices} vertices; give the mesh of all membranes, or cut out the "
            "membrane first"
        )
    own = trajectory.triangles(None if mesh is None else mesh.num_triangles)
    if own is None and mesh is None:
        raise click.UsageError(
            f"a trajectory needs --mesh, which has its triangles: there is no "
            f"{source.with_suffix('.triangles').name} beside it"
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
    if len(chosen) == trajectory.num_vertices:
        return trajectory, corners if own is None else own
    trajectory = analysis.Trajectory(source, chosen, start, stride=stride)
    if own is not None:
        return trajectory, trajectory.triangles()
    inside = np.isin(corners[:, 0], chosen)
    return trajectory, np.searchsorted(chosen, corners[inside])
