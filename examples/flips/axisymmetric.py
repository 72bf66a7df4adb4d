"""Axisymmetric shapes of least bending energy at given area and volume: an independent reference.

The branches of U. Seifert, K. Berndl and R. Lipowsky, Phys. Rev. A 44, 1182 (1991),
doi:10.1103/PhysRevA.44.1182, without spontaneous curvature: prolates, oblates (discocytes where
they are thin) and stomatocytes. No shape or energy of openmmhelfrich is used here.

A contour is its tangent angle ψ from one pole, ψ = 0, to the other, ψ = π:

    ψ(u) = π u + Σ_n a_n sin(n π u) / n,    r' = cos ψ,    z' = sin ψ

with even n only where the shape is its own image in the plane of the equator. Arc length is
s = L u, but for stomatocytes s = L x(u), which gives half of all u to the lip, whose curvature is
high. Of

    E = π κ ∫ (dψ/ds + sin ψ / r)² r ds,    A = 2π ∫ r ds,    V = π ∫ r² sin ψ ds

E is least at A = 4π and V = ν 4π/3, under the condition that the contour ends on the axis.
Integrals are Gauss–Legendre's, gradients are exact, the minimum is found by Newton's method
(`constrained.py`). Each shape is the start of the next one along its branch.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from constrained import minimum
from numpy.polynomial.legendre import leggauss, legvander
from scipy.optimize import brentq

NODES = 200
MODES = {"prolate": 64, "oblate": 48, "stomatocyte": 64}
"""Highest n of each branch."""

STARTS = {"prolate": 0.95, "oblate": 0.95, "stomatocyte": 0.4}
"""Reduced volume of the first shape of each branch."""

RANGES = {"prolate": (0.3, 0.99), "oblate": (0.5, 0.99), "stomatocyte": (0.2, 0.66)}
"""Reduced volumes of each branch; thinner oblates go through themselves."""

STEP = 0.02


class Contour(NamedTuple):
    """A shape with the area 4π of a unit sphere.

    branch : str
    reduced_volume : float
        ν.
    energy : float
        E / 8πκ.
    r, z : ndarray
        The contour from pole to pole, each of shape (num_points,).
    """

    branch: str
    reduced_volume: float
    energy: float
    r: np.ndarray
    z: np.ndarray


@cache
def _nodes():
    """u, weights, and the matrix that integrates from 0 to each u, exact for polynomials."""
    t, weights = leggauss(NODES)
    degree = np.arange(NODES)
    values = legvander(t, NODES)
    integrals = np.empty((NODES, NODES))
    integrals[:, 0] = t + 1
    integrals[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * degree[1:] + 1)
    to_coefficients = (degree[:, None] + 0.5) * values[:, :-1].T * weights
    return (t + 1) / 2, weights / 2, integrals @ to_coefficients / 2


def _stretched(u, lip):
    """x(u) and dx/du that give half of all u to a lip, (centre, width) in x; x = u without one.

    u = ½ x + ½ B(x), where B' is a Lorentzian at the lip, and B goes from 0 to 1.
    """
    if lip is None:
        return u, np.ones_like(u)
    centre, width = lip
    low, high = np.arctan(-centre / width), np.arctan((1 - centre) / width)

    def u_of(x):
        return 0.5 * (x + (np.arctan((x - centre) / width) - low) / (high - low))

    def slope(x):
        return 0.5 * (1 + width / ((x - centre) ** 2 + width**2) / (high - low))

    # The grid is that of u itself, mapped the other way round, so that it is dense at the lip.
    grid = centre + width * np.tan(np.linspace(low, high, 4001))
    x = np.interp(u, u_of(grid), grid)
    for _ in range(3):
        x = x - (u_of(x) - u) / slope(x)
    return x, 1 / slope(x)


class Shapes:
    """Energy and constraints as functions of the variables (a_n …, L).

    Parameters
    ----------
    highest : int
        Highest n.
    every : int
        1 for any shape, 2 for those that are their own image.
    lip : (float, float), optional
        Centre and width, in x, of what gets half of all nodes.
    """

    def __init__(self, highest, every, lip=None):
        self.n = np.arange(every, 1 + highest, every)
        u, weights, integral = _nodes()
        self.u, self.u_weights = u, weights
        self.x, self.stretch = _stretched(u, lip)
        self.weights, self.integral = weights * self.stretch, integral * self.stretch
        angles = np.pi * np.outer(u, self.n)
        self.sines, self.cosines = np.sin(angles) / self.n, np.pi * np.cos(angles)

    def angles(self, variables):
        """ψ and dψ/dx at the nodes."""
        psi = np.pi * self.u + self.sines @ variables[:-1]
        return psi, (np.pi + self.cosines @ variables[:-1]) / self.stretch

    def variables(self, psi, length):
        """Variables of the ψ at the nodes."""
        amplitudes = 2 * self.n**2 * ((self.u_weights * (psi - np.pi * self.u)) @ self.sines)
        return np.append(amplitudes, length)

    def _radius(self, psi, length):
        """Radii r, the end of r and its derivatives, and what takes Σ f ∂r of any f."""
        derivatives = np.column_stack([-np.sin(psi)[:, None] * self.sines * length, np.cos(psi)])
        r, end = length * (self.integral @ np.cos(psi)), length * self.weights @ np.cos(psi)
        d_end = self.weights @ derivatives

        def pulled(f):
            return (f @ self.integral) @ derivatives - (f @ self.x) * d_end

        # On the axis at both ends, also while the constraint is not yet met.
        return r - self.x * end, end, d_end, pulled

    def energy(self, variables):
        """E / 8πκ and its gradient."""
        length = variables[-1]
        psi, slope = self.angles(variables)
        r, _, _, pulled = self._radius(psi, length)
        curvature = slope / length + np.sin(psi) / r
        weights = self.weights / 8
        energy = length * weights @ (curvature**2 * r)
        by_curvature = 2 * length * weights * curvature * r
        gradient = pulled(length * weights * curvature**2 - by_curvature * np.sin(psi) / r**2)
        gradient[:-1] += (by_curvature / (length * self.stretch)) @ self.cosines
        gradient[:-1] += (by_curvature * np.cos(psi) / r) @ self.sines
        gradient[-1] += energy / length - by_curvature @ slope / length**2
        return energy, gradient

    def area_difference(self, variables):
        """Δa = ∫ (dψ/ds + sin ψ / r) r ds / 4 at A = 4π, and its gradient."""
        length = variables[-1]
        psi, slope = self.angles(variables)
        r, _, _, pulled = self._radius(psi, length)
        weights = self.weights / 4
        gradient = pulled(weights * slope)
        gradient[:-1] += (weights * r / self.stretch) @ self.cosines
        gradient[:-1] += length * (weights * np.cos(psi)) @ self.sines
        gradient[-1] += weights @ np.sin(psi)
        return weights @ (slope * r + length * np.sin(psi)), gradient

    def constraints(self, variables):
        """A / 4π and V / (4π/3), the end of r, and their gradients."""
        length, weights = variables[-1], self.weights
        psi, _ = self.angles(variables)
        r, end, d_end, pulled = self._radius(psi, length)
        area, volume = length / 2 * weights @ r, 0.75 * length * weights @ (r**2 * np.sin(psi))
        d_area = pulled(length / 2 * weights)
        d_volume = pulled(1.5 * length * weights * r * np.sin(psi))
        d_volume[:-1] += 0.75 * length * (weights * r**2 * np.cos(psi)) @ self.sines
        d_area[-1] += area / length
        d_volume[-1] += volume / length
        return np.array([area, volume, end]), np.array([d_area, d_volume, d_end])

    def is_shape(self, variables):
        """Whether no part is beyond the axis, where areas and energies would be below zero."""
        psi, _ = self.angles(variables)
        return variables[-1] > 0 and self._radius(psi, variables[-1])[0].min() > 0

    def minimum(self, reduced_volume, start, energy=None):
        """Variables of the least energy near a start, or RuntimeError.

        Another energy than that of bending alone is a function of the variables, with its gradient.
        """
        targets = np.array([1, reduced_volume, 0])
        # Up-down symmetric contours end on the axis by themselves.
        used = slice(0, 3 if self.n[0] == 1 else 2)

        def constraints(variables):
            values, gradients = self.constraints(variables)
            return (values - targets)[used], gradients[used]

        try:
            return minimum(energy or self.energy, constraints, start, self.is_shape)
        except RuntimeError as error:
            raise RuntimeError(
                f"axisymmetric: no shape at ν = {reduced_volume:g}: {error}"
            ) from None

    def contour(self, branch, reduced_volume, variables):
        """The Contour of variables."""
        length = variables[-1]
        psi, _ = self.angles(variables)
        r, z = self._radius(psi, length)[0], length * (self.integral @ np.sin(psi))
        height = length * self.weights @ np.sin(psi)
        return Contour(
            branch,
            float(reduced_volume),
            float(self.energy(variables)[0]),
            np.array([0, *r, 0]),
            np.array([0, *z, height]) - height / 2,
        )


def contour(branch, reduced_volume):
    """The shape of least energy on a branch.

    Parameters
    ----------
    branch : str
        "prolate", "oblate" or "stomatocyte".
    reduced_volume : float
        ν, in the range of the branch.

    Returns
    -------
    Contour

    Raises
    ------
    ValueError
        A branch that is none, or a reduced volume where the branch does not go.
    RuntimeError
        No minimum was found.
    """
    if branch not in RANGES:
        raise ValueError(f"axisymmetric: branch needs one of {', '.join(RANGES)}, got {branch!r}")
    low, high = RANGES[branch]
    if not low <= reduced_volume <= high:
        raise ValueError(
            f"axisymmetric: reduced_volume of {branch}s needs {low} to {high}, got {reduced_volume}"
        )
    away = reduced_volume - STARTS[branch]
    shapes, start = _continued(branch, *_along(branch, int(abs(away) / STEP), away > 0))
    return shapes.contour(branch, reduced_volume, shapes.minimum(reduced_volume, start))


def _shapes(branch, lip=None):
    return Shapes(MODES[branch], 1 if branch == "stomatocyte" else 2, lip)


@cache
def _along(branch, steps, upwards):
    """The shape that many steps in ν from the start of its branch, and its variables."""
    if not steps:
        shapes, start = _first(branch)
    else:
        shapes, start = _continued(branch, *_along(branch, steps - 1, upwards))
    reduced_volume = STARTS[branch] + STEP * (steps if upwards else -steps)
    return shapes, shapes.minimum(reduced_volume, start)


def _first(branch):
    """A start for the first shape of a branch."""
    if branch != "stomatocyte":
        shapes = _shapes(branch)
        start = np.append(0 * shapes.n, np.pi)
        start[0] = 0.6 if branch == "prolate" else -0.6
        return shapes, start
    # Two spheres, one in the other, of the radii that have area and volume right, and a lip.
    outer = brentq(lambda r: r**3 - (1 - r**2) ** 1.5 - STARTS[branch], 0.75, 1)
    inner = (1 - outer**2) ** 0.5
    lengths = np.pi * np.cumsum([0, 0.8 * outer, 0.5 * (outer - inner), 0.8 * inner])
    ends = lengths / lengths[-1]
    shapes = _shapes(branch, ((ends[1] + ends[2]) / 2, ends[2] - ends[1]))
    psi = np.interp(shapes.x, ends, np.pi * np.array([0, 0.8, 1.8, 1]))
    start = shapes.variables(psi, lengths[-1])
    start[:-1] /= 1 + (shapes.n / 10) ** 2
    return shapes, start


def _continued(branch, shapes, variables):
    """A shape and its variables once more, with the nodes where its own lip is."""
    if branch != "stomatocyte":
        return shapes, variables
    psi, slope = shapes.angles(variables)
    highest = np.argmax(slope)
    again = _shapes(branch, (shapes.x[highest], np.pi / slope[highest]))
    return again, again.variables(np.interp(again.x, shapes.x, psi), variables[-1])


def crossing(one, other, low, high):
    """ν between `low` and `high` at which two branches have the same energy."""
    return brentq(lambda v: contour(one, v).energy - contour(other, v).energy, low, high, xtol=1e-5)


def main():
    from reports import Report

    report = Report("axisymmetric", __doc__)
    step = 0.1 if report.quick else 0.01
    rows = []
    for volume in map(float, np.arange(0.2, 1, step).round(6)):
        energies = [
            contour(branch, volume).energy if low <= volume <= high else ""
            for branch, (low, high) in RANGES.items()
        ]
        rows.append((f"{volume:g}", *(f"{each:.6f}" if each else "" for each in energies)))
    report.table(["ν", *RANGES], rows)
    print("E / 8πκ; prolate and oblate cross at ν = ", end="")
    print(f"{crossing('prolate', 'oblate', 0.6, 0.7):.4f}, oblate and stomatocyte at ", end="")
    print(f"{crossing('oblate', 'stomatocyte', 0.55, 0.65):.4f}")


if __name__ == "__main__":
    main()
