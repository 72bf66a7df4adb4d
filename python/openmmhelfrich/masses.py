"""Masses of vertices by the areas of their plaquettes, constant in time."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
from openmm import unit

from ._types import Array
from ._values import DENSITY, Scalar, plain_value, scalar
from .analysis import triangle_areas
from .mesh import Mesh

__all__ = ["plaquette_masses"]

_NAME = "plaquette_masses"
_MASS = Scalar("total_mass", unit.amu, inspect.Parameter.empty, None)
_AREAS = Scalar("areas", unit.nanometer**2, inspect.Parameter.empty, None)


def plaquette_masses(
    areas: Any, density: Scalar | None = None, total_mass: Scalar | None = None
) -> Array:
    """Masses in proportion to the mean areas of the plaquettes, ρ ⟨aᵢ⟩, for `System.addParticle`.

    What VariableMassVerletIntegrator does in every step, once and for all: for meshes whose
    plaquettes are of different sizes that last, with any integrator.

    Parameters
    ----------
    areas : Mesh, array_like or Quantity
        A mesh, of which the plaquettes at the vertices have a third of the area of the triangles
        around; or areas, nm², of shape (num_vertices,), or (num_frames, num_vertices) to be
        averaged over.
    density : float or Quantity, optional
        ρ, amu/nm².
    total_mass : float or Quantity, optional
        The mass of all vertices together, amu, instead of a density.

    Returns
    -------
    ndarray
        Shape (num_vertices,), amu.

    Raises
    ------
    TypeError
        If both or none of density and total mass are given, or a Quantity of another dimension.
    ValueError
        If they are not finite numbers above zero, or areas are no array of such.

    Examples
    --------
    >>> import openmm
    >>> import openmmhelfrich as helfrich
    >>> mesh = helfrich.Mesh.random_sphere(252, radius=500, seed=1)
    >>> system = openmm.System()
    >>> for mass in helfrich.plaquette_masses(mesh, total_mass=252 * 50):
    ...     _ = system.addParticle(mass)
    """
    if (density is None) == (total_mass is None):
        raise TypeError(f"{_NAME}: give either a density or a total_mass")
    means = _mean_areas(areas)
    if density is not None:
        return _above_zero(DENSITY, density) * means
    return _above_zero(_MASS, total_mass) * means / means.sum()


def _mean_areas(areas) -> Array:
    if isinstance(areas, Mesh):
        thirds = np.repeat(triangle_areas(areas, areas) / 3, 3)
        return np.bincount(areas.triangles.ravel(), thirds, areas.num_vertices)
    plain = np.asarray(plain_value(f"{_NAME}: areas", _AREAS, areas))
    if plain.ndim not in (1, 2) or plain.size == 0 or plain.dtype.kind not in "iuf":
        raise ValueError(
            f"{_NAME}: areas must be numbers of shape (num_vertices,) or (num_frames, "
            f"num_vertices), got the shape {plain.shape} and the dtype {plain.dtype}"
        )
    means = plain.reshape(-1, plain.shape[-1]).mean(axis=0, dtype=np.float64)
    wrong = np.flatnonzero(~(np.isfinite(means) & (means > 0)))
    if wrong.size:
        raise ValueError(
            f"{_NAME}: areas must be finite and above zero, got {means[wrong[0]]} nm² for vertex "
            f"{wrong[0]}"
        )
    return means


def _above_zero(parameter: Scalar, value) -> float:
    number = scalar(_NAME, parameter, value)
    if not (np.isfinite(number) and number > 0):
        raise ValueError(
            f"{_NAME}: {parameter.name} must be a finite number above zero, got {number}"
        )
    return number
