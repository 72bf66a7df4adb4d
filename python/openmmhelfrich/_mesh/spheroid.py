"""Spheres flattened or stretched to a reduced volume: what `Mesh.oblate` and `prolate` compute."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from .._types import Array
from ..errors import MeshError
from .geometry import reduced_volume, surface_area, volume_enclosed
from .inputs import numbers

__all__ = ["spheroid"]

# Sums over the triangles of one shape differ by less, in whatever order and from whatever origin.
_ROUNDING = 1e-12


def spheroid(vertices: Array, triangles: Array, target, prolate: bool, where: str) -> Array:
    """Vertices stretched along z, or flattened, to a reduced volume at unchanged area.

    x' = c + s (x − c), y likewise, z' = c + s t (z − c): c is the mean of the vertices, t solves
    v(t) = target with the area and the volume of the triangles, s restores the area.

    Parameters
    ----------
    vertices, triangles : ndarray
        The mesh, close to a sphere.
    target : float
        The reduced volume wanted.
    prolate : bool
        Whether to look for t > 1, a cigar, or t < 1, a disk.
    where : str
        The name of the method, for the message of an error.

    Returns
    -------
    ndarray
        New vertices, shape (num_vertices, 3), nm; those of the mesh if it has that reduced volume,
        to rounding.

    Raises
    ------
    MeshError
        If the target is not a number between 0 and the reduced volume of the mesh itself.
    """
    target = numbers(target, where, "reduced_volume")
    if target.shape != ():
        raise MeshError(f"{where}: reduced_volume must be one number, got {target}")
    centre = vertices.mean(axis=0)
    centred = vertices - centre

    def stretched(log_aspect: float) -> Array:
        return centred * np.array([1.0, 1.0, np.exp(log_aspect)])

    def reduced(shape: Array) -> float:
        return reduced_volume(surface_area(shape[triangles]), volume_enclosed(shape, triangles))

    def excess(log_aspect: float) -> float:
        return reduced(stretched(log_aspect)) - target

    largest = reduced(vertices)
    if abs(target - largest) <= _ROUNDING * largest:
        return vertices.copy()
    if not 0 < target < largest:
        # All digits, so that the number can be copied.
        raise MeshError(
            f"{where}: reduced_volume must be above 0 and at most {largest}, that of the mesh "
            f"itself, got {target}; start from a mesh that is closer to a sphere"
        )
    # v falls steadily with |log t| on either side of the sphere, so doubling finds a bracket.
    bound = 0.5 if prolate else -0.5
    while excess(bound) > 0:
        bound *= 2
    log_aspect = brentq(excess, 0.0, bound, xtol=1e-15, rtol=4 * np.finfo(float).eps)
    shape = stretched(log_aspect)
    wanted = surface_area(centred[triangles])
    return centre + shape * np.sqrt(wanted / surface_area(shape[triangles]))
