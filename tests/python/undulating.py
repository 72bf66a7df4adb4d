"""Icospheres with a mode on them, and what their second derivatives go to on ever finer ones."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import openmmhelfrich as helfrich
from openmmhelfrich.analysis import real_harmonics

#: nm.
RADIUS = 100.0
#: n of N = 10 n² + 2.
SUBDIVISIONS = (8, 16, 32)


def surface_gradient(
    function: Callable[[np.ndarray], np.ndarray], directions: np.ndarray, step: float = 1e-5
) -> np.ndarray:
    """Gradient on the unit sphere of a function of directions, by differences along three axes."""
    result = np.zeros_like(directions)
    for axis in np.eye(3):
        along = axis - (directions @ axis)[:, np.newaxis] * directions
        ahead, behind = (directions + sign * step * along for sign in (1, -1))
        ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
        behind /= np.linalg.norm(behind, axis=1, keepdims=True)
        slope = (function(ahead) - function(behind)) / (2 * step)
        result += slope[:, np.newaxis] * axis
    return result


class Undulating:
    """An icosphere with the normal field of one l, of all its m and of norm 1."""

    def __init__(self, l: int, subdivision: int) -> None:
        self.mesh = helfrich.Mesh.icosphere(subdivision, RADIUS)
        self.directions = self.mesh.vertices / RADIUS
        self.amplitudes = np.zeros((l + 1) ** 2)
        self.amplitudes[l**2 :] = np.random.default_rng(l).normal(size=2 * l + 1)
        self.amplitudes /= np.linalg.norm(self.amplitudes)
        self.field = self.of(self.directions)

    def of(self, directions: np.ndarray) -> np.ndarray:
        """Σ_m u_lm Y_lm."""
        lmax = round(len(self.amplitudes) ** 0.5) - 1
        return real_harmonics(directions, lmax) @ self.amplitudes

    def gradient(self) -> np.ndarray:
        """r0 times its gradient on the sphere."""
        return surface_gradient(self.of, self.directions)

    def bulged(self, amplitude: float) -> helfrich.Mesh:
        """r = r0 (1 + u Y)."""
        scale = 1 + amplitude * self.field[:, np.newaxis]
        return helfrich.Mesh(self.mesh.vertices * scale, self.mesh.triangles)


def half_second_derivative(function: Callable[[float], float], step: float = 1e-3) -> float:
    """The coefficient of u² by differences."""
    return (function(step) + function(-step) - 2 * function(0.0)) / (2 * step**2)


def limit(of_mesh: Callable[[int], np.ndarray | float]) -> np.ndarray | float:
    """What a value on icospheres goes to, whose error is a series in 1/n² (Richardson)."""
    values = [of_mesh(subdivision) for subdivision in SUBDIVISIONS]
    first = [(4 * fine - coarse) / 3 for coarse, fine in itertools.pairwise(values)]
    return (16 * first[1] - first[0]) / 15
