"""New vertices from old ones: what the transformations of `Mesh` compute.

Each function takes vertices of shape (num_vertices, 3), nm, checks the arguments of the method of
the same name, which `Mesh` documents, and returns new vertices. Errors are `MeshError`.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from .._units import length_array
from ..errors import MeshError
from .geometry import reduced_volume, surface_area, volume_enclosed
from .inputs import integer, numbers

__all__ = ["deformed", "rotated", "scaled", "spheroid", "translated"]


def scaled(vertices: np.ndarray, factor, box: np.ndarray | None = None):
    """Multiply vertices and box, x → s x, with one factor or one per axis."""
    factors = numbers(factor, "Mesh.scaled", "factor")
    if factors.shape not in ((), (3,)) or not (np.isfinite(factors) & (factors != 0)).all():
        raise MeshError(
            "Mesh.scaled: factor must be one number or three (x, y, z), finite and not 0, "
            f"got {factor!r}"
        )
    if box is not None:
        # A box vector may point the other way; its own axis' component is to be above 0.
        box = box * factors * np.sign(factors * np.ones(3))[:, np.newaxis] + 0.0
    return vertices * factors, box


def translated(vertices: np.ndarray, displacement) -> np.ndarray:
    """Move, x → x + v."""
    vector = length_array(displacement, "Mesh.translated", "displacement")
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise MeshError(
            "Mesh.translated: displacement must be three finite lengths x, y, z, "
            f"got {displacement!r}"
        )
    return vertices + vector


def rotated(vertices: np.ndarray, rotation) -> np.ndarray:
    """Rotate, x → R x, with a 3 × 3 matrix or a Rotation of scipy."""
    where = "Mesh.rotated"
    as_matrix = getattr(rotation, "as_matrix", None)
    matrix = numbers(as_matrix() if as_matrix else rotation, where, "rotation")
    if matrix.shape != (3, 3):
        raise MeshError(f"{where}: rotation must have shape (3, 3), got {matrix.shape}")
    if not np.abs(matrix @ matrix.T - np.eye(3)).max() < 1e-8:
        raise MeshError(f"{where}: rotation must be orthogonal, but R Rᵀ is not the identity")
    if np.linalg.det(matrix) < 0:
        raise MeshError(f"{where}: rotation has determinant −1; use scaled to mirror a mesh")
    return vertices @ matrix.T


def deformed(vertices: np.ndarray, l, m, amplitude) -> np.ndarray:
    """Deform, r → r (1 + u Y_lm), about the origin."""
    where = "Mesh.deformed"
    l = integer(l, where, "l", 0)
    m = integer(m, where, "m", -l)
    if m > l:
        raise MeshError(f"{where}: m must be {l} or less, as l is, got {m}")
    amplitude = numbers(amplitude, where, "amplitude")
    if amplitude.shape != () or not np.isfinite(amplitude):
        raise MeshError(f"{where}: amplitude must be one finite number, got {amplitude}")
    distance = np.linalg.norm(vertices, axis=1)
    if not distance.all():
        raise MeshError(
            f"{where}: vertex {np.argmin(distance)} lies at the origin, where no direction is "
            "defined; translate the mesh so that the origin is inside of it"
        )
    # Imported here, because a mesh is of use without the analysis of its fluctuations.
    from ..analysis import real_harmonics

    directions = vertices / distance[:, np.newaxis]
    factor = 1 + amplitude * real_harmonics(directions, l)[:, l * l + l + m]
    if not (factor > 0).all():
        raise MeshError(
            f"{where}: amplitude {amplitude} moves vertex {np.argmin(factor)} to the origin or "
            f"beyond (1 + u Y = {factor.min():.3g}); take a smaller one"
        )
    return vertices * factor[:, np.newaxis]


def spheroid(
    vertices: np.ndarray, triangles: np.ndarray, target, prolate: bool, where: str
) -> np.ndarray:
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
        New vertices, shape (num_vertices, 3), nm.

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

    def stretched(log_aspect: float) -> np.ndarray:
        return centred * np.array([1.0, 1.0, np.exp(log_aspect)])

    def excess(log_aspect: float) -> float:
        shape = stretched(log_aspect)
        area, volume = surface_area(shape[triangles]), volume_enclosed(shape, triangles)
        return reduced_volume(area, volume) - target

    largest = excess(0.0) + target
    if not 0 < target <= largest:
        raise MeshError(
            f"{where}: reduced_volume must be above 0 and at most {largest:.6g}, that of the mesh "
            f"itself, got {target}; start from a mesh that is closer to a sphere"
        )
    if target == largest:
        return vertices.copy()
    # v falls steadily with |log t| on either side of the sphere, so doubling finds a bracket.
    bound = 0.5 if prolate else -0.5
    while excess(bound) > 0:
        bound *= 2
    log_aspect = brentq(excess, 0.0, bound, xtol=1e-15, rtol=4 * np.finfo(float).eps)
    shape = stretched(log_aspect)
    wanted = surface_area(centred[triangles])
    return centre + shape * np.sqrt(wanted / surface_area(shape[triangles]))
