"""Density of the vertices on the sphere, and its structure factor."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._numbers import whole_number
from .._types import Array
from ._arrays import check_whole, over_frames
from .harmonics import harmonics_of
from .statistics import Spectrum, spectrum


def density_modes(vertices: Any, lmax: int) -> Array:
    """Modes of the density of vertices on the unit sphere, ρ_lm = √(4π/N) Σ_i Y_lm(θ_i, φ_i).

    The directions are those seen from the centre of mass, the mean of the vertices. In this norm
    ⟨|ρ_lm|²⟩ is the structure factor: 1 for independent vertices, l ≥ 1, because
    ∫ Y_lm² dΩ / 4π = 1 / 4π; less where vertices keep an even distance; and with a peak near
    l = 2√N where they are in order (SM 5 of doi:10.1103/PhysRevE.108.015301). ρ_00 = √N. The modes
    l = 1 of vertices on a sphere vanish, because the centre is their mean.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    lmax : int
        Largest l, 0 or more.

    Returns
    -------
    ndarray
        ρ_lm at index l² + l + m, without unit, shape ((lmax+1)²,) for one frame or
        (num_frames, (lmax+1)²).

    Raises
    ------
    TypeError
        A Quantity that is no length.
    ValueError
        A wrong shape, a coordinate that is not finite, a vertex at the centre, an lmax that is no
        whole number of 0 or more, or a Mesh that spans its periodic box.
    """
    check_whole("density_modes", vertices)
    lmax = whole_number(lmax, "density_modes", "lmax", 0)

    def work(frames, faces, first):
        positions = frames - frames.mean(axis=1, keepdims=True)
        distance = np.linalg.norm(positions, axis=2)
        if not distance.all():
            frame, vertex = np.argwhere(distance == 0)[0]
            raise ValueError(
                f"density_modes: vertex {vertex} of frame {first + frame} is at the centre of "
                "mass, where it has no direction"
            )
        directions = positions / distance[:, :, np.newaxis]
        norm = np.sqrt(4 * np.pi / frames.shape[1])
        return norm * harmonics_of(directions, lmax).sum(axis=2)

    return over_frames(work, vertices, cost=lambda n, t: n * max(30, (lmax + 1) ** 2))


def structure_factor(vertices: Any, lmax: int) -> Spectrum:
    """Structure factor S(l) = ⟨|ρ_lm|²⟩ of the vertices on the sphere, with error bars.

    The mean over m and over the frames of `density_modes`, with errors that account for correlation
    in time as those of `spectrum`.

    Parameters
    ----------
    vertices : array_like, Quantity, Trajectory or path
        Two frames or more, shape (num_frames, num_vertices, 3), nm, at equal intervals of time.
    lmax : int
        Largest l. The peak of an even mesh is near 2√N, where (lmax+1)² is 4N.

    Returns
    -------
    Spectrum
        l, S(l), its error, both without unit, and its correlation time in frames. S(0) = N.

    Raises
    ------
    TypeError, ValueError
        As for `density_modes`; fewer than two frames.
    """
    modes = density_modes(vertices, whole_number(lmax, "structure_factor", "lmax", 0))
    if modes.ndim < 2 or len(modes) < 2:
        raise ValueError("structure_factor: an error bar needs two frames or more, got 1")
    return spectrum(modes)
