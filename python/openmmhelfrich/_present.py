"""Triangles as they are now in a Context, where bonds flip."""

from __future__ import annotations

import numpy as np

from .forces import MonteCarloBondFlip

__all__ = ["present_triangles"]


def present_triangles(context, corners: np.ndarray) -> np.ndarray:
    """What has become of triangles with which a Context began.

    Parameters
    ----------
    context : openmm.Context
    corners : ndarray of int
        Particle indices, shape (num_triangles, 3): of one surface or several, each triangle
        beginning with the corner that it begins with in the force.

    Returns
    -------
    ndarray of int
        Shape (num_triangles, 3). A triangle keeps its place when an edge of it flips.

    Raises
    ------
    ValueError
        If bonds between these particles flip, but on other triangles.
    """
    present = corners
    rows = None
    for plain in context.getSystem().getForces():
        if not MonteCarloBondFlip.isinstance(plain):
            continue
        mover = MonteCarloBondFlip.cast(plain)
        initial = np.frombuffer(mover._triangleBuffer(), dtype=np.intc).reshape(-1, 3)
        if not np.isin(initial, corners).any():
            continue
        if rows is None:
            present = corners.copy()
            rows = {tuple(row): place for place, row in enumerate(corners.tolist())}
        places = [rows.get(tuple(row), -1) for row in initial.tolist()]
        if min(places) < 0:
            raise ValueError(
                f"the triangles are not those on which {mover.getName()} flips bonds: its triangle "
                f"{places.index(min(places))} is not among them; give the mesh that the forces have"
            )
        present[places] = mover.getTrianglesInContext(context)
    return present
