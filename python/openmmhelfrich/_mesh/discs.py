"""Axisymmetric shapes, and maps of a triangulated sphere to them that keep areas."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from .._types import Array

__all__ = ["EVANS_FUNG_DIAMETER", "Profile", "evans_fung", "spheroid"]

#: Diameter of the mean red cell of Evans and Fung, nm.
EVANS_FUNG_DIAMETER = 7820.0
# Thickness of that cell, nm: √(1 − x²) (c0 + c1 x² + c2 x⁴) at x radii from the axis.
_THICKNESS = (810.0, 7830.0, -4390.0)
_POINTS = 20_001


class Profile:
    """A meridian from pole to equator, ρ(t) and z(t) with 0 ≤ t ≤ π/2, mirrored at the equator."""

    def __init__(self, distance: Callable[..., Any], height: Callable[..., Any]) -> None:
        self._t = np.linspace(0, np.pi / 2, _POINTS)
        self._distance, self._height = distance, height
        rho, z = distance(self._t), height(self._t)
        by_t = [np.gradient(values, self._t, edge_order=2) for values in (rho, z)]
        self._areas = cumulative_simpson(2 * np.pi * rho * np.hypot(*by_t), x=self._t, initial=0)
        volume = cumulative_simpson(-np.pi * rho**2 * by_t[1], x=self._t, initial=0)
        #: nm² and nm³, of the whole surface.
        self.area, self.volume = 2 * float(self._areas[-1]), 2 * float(volume[-1])

    def of_sphere(self, points: Array) -> Array:
        """The images of points on a sphere: meridians stay meridians, and areas their share."""
        unit = points / np.linalg.norm(points, axis=1)[:, None]
        # Near the pole areas grow as t², so their roots are what is smooth.
        share = np.sqrt((1 - np.abs(unit[:, 2])) * self._areas[-1])
        t = np.interp(share, np.sqrt(self._areas), self._t)
        rho = np.hypot(unit[:, 0], unit[:, 1])
        stretch = np.divide(self._distance(t), rho, where=rho > 0, out=np.zeros_like(rho))
        z = np.copysign(self._height(t), unit[:, 2])
        return np.column_stack([unit[:, 0] * stretch, unit[:, 1] * stretch, z])


def evans_fung(diameter: float) -> Profile:
    """The biconcave mean red cell, scaled to a diameter, nm.

    E. A. Evans, Y.-C. Fung, Microvasc. Res. 4, 335 (1972), doi:10.1016/0026-2862(72)90069-6.
    """
    scale = diameter / EVANS_FUNG_DIAMETER
    c0, c1, c2 = (0.5 * scale * c for c in _THICKNESS)

    def height(t):
        squared = np.sin(t) ** 2
        return np.cos(t) * (c0 + c1 * squared + c2 * squared**2)

    return Profile(lambda t: 0.5 * diameter * np.sin(t), height)


def spheroid(area: float, reduced_volume: float) -> Profile:
    """The oblate spheroid of an area, nm², and a reduced volume 6 √π V / A^{3/2}; 1 is a sphere."""
    # Near a sphere the reduced volume hardly depends on the aspect ratio: no equation to solve.
    low, high = (1.0, 1.0) if reduced_volume == 1 else (1e-3, 1.0)
    for _ in range(60):
        aspect = 0.5 * (low + high)
        shape = Profile(np.sin, lambda t, aspect=aspect: aspect * np.cos(t))
        found = 6 * np.sqrt(np.pi) * shape.volume / shape.area**1.5
        low, high = (aspect, high) if found < reduced_volume else (low, aspect)
    radius = np.sqrt(area / shape.area)
    return Profile(lambda t: radius * np.sin(t), lambda t: radius * aspect * np.cos(t))
