"""Axisymmetric vesicles with a domain at each pole and a tension of their lines: a reference.

At constant areas of both domains, at the share α of the area each, and of the rest, without a
constraint of volume, stationary are

    E = π κ ∫ (dψ/ds + sin ψ / r)² r ds + 2 · 2π λ r,

with the radius r of a line, where the area from the pole on is that of a domain. Slopes are
continuous. The branch from the sphere to two buds is followed with r prescribed: E is least at that
r, and λ is its Lagrange multiplier, so that states are found whether they are stable at constant λ
or not. Where λ is highest the domains have to bud, at the spinodal; where it is lowest thereafter
buds have to open. Lengths are those of a vesicle of radius 1, energies are over 8πκ, and a tension
is λL/κ with the domain's area πL².
"""

from typing import NamedTuple

import numpy as np
from axisymmetric import NODES, Shapes
from constrained import minimum
from numpy.polynomial.legendre import leggauss
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

HIGHEST = 96
OPENINGS = np.concatenate([np.linspace(0.99, 0.15, 43), [0.13, 0.11, 0.09, 0.075, 0.06]])
"""r over its value on the sphere, along the branch."""


class LinedShapes(Shapes):
    """Shapes that are their own image, with a line around each pole.

    Parameters
    ----------
    highest : int
        Highest n.
    share : float
        α, area of each domain over that of the vesicle.
    """

    def __init__(self, highest, share):
        super().__init__(highest, 2)
        self.share = share
        nodes, weights = leggauss(NODES)
        self._barycentric = (-1.0) ** np.arange(NODES) * np.sqrt((1 - nodes**2) * weights)

    def sphere(self):
        """Variables of the sphere."""
        return np.append(0.0 * self.n, np.pi)

    def row_at(self, x):
        """What takes values at the nodes to that of their polynomial at x, shape (num_nodes,)."""
        away = x - self.x
        if not away.all():
            return (away == 0).astype(float)
        row = self._barycentric / away
        return row / row.sum()

    def at_area(self, variables, share):
        """Where, in x, the area from the pole on is a share of all."""
        r = self._radius(self.angles(variables)[0], variables[-1])[0]
        areas, whole = self.integral @ r, self.weights @ r
        x = np.interp(share * whole, areas, self.x)
        for _ in range(8):
            row = self.row_at(x)
            step = (row @ areas - share * whole) / (row @ r)
            x -= step
            if abs(step) < 1e-14:
                break
        return x

    def line(self, variables):
        """The radius of the line and its gradient."""
        length = variables[-1]
        psi, _ = self.angles(variables)
        r, end, _, pulled = self._radius(psi, length)
        row = self.row_at(self.at_area(variables, self.share))
        # The place moves so that the share of the area up to it stays.
        d_share = pulled(row @ self.integral - self.share * self.weights)
        slope = length * (row @ np.cos(psi)) - end
        return row @ r, pulled(row) - slope * d_share / (row @ r)

    def lined_energy(self, variables, tension):
        """E / 8πκ and its gradient, at a tension λL/κ."""
        bending, d_bending = self.energy(variables)
        radius, d_radius = self.line(variables)
        factor = tension / (4 * np.sqrt(self.share))
        return bending + factor * radius, d_bending + factor * d_radius

    def constrained(self, variables, radius):
        """What is 0 at the area 4π and at a radius of the line, and its gradients."""
        (area, _, _), (d_area, _, _) = self.constraints(variables)
        at, d_at = self.line(variables)
        return np.array([area - 1, at - radius]), np.array([d_area, d_at])

    def minimum_at(self, radius, start):
        """Variables of the least bending energy near a start, and the tension λL/κ that holds it.

        Raises
        ------
        RuntimeError
            There is none.
        """
        try:
            found = minimum(
                self.energy, lambda each: self.constrained(each, radius), start, self.is_shape
            )
        except RuntimeError as error:
            raise RuntimeError(
                f"lined_shapes: no shape whose line has the radius {radius:g}: {error}"
            ) from None
        gradients = self.constrained(found, radius)[1]
        multipliers = np.linalg.lstsq(gradients.T, self.energy(found)[1], rcond=None)[0]
        return found, -4 * np.sqrt(self.share) * multipliers[1]

    def points(self, variables, shares):
        """Points up to which the area from one pole on is each of `shares` of all: r, and z.

        Returns
        -------
        ndarray
            Shape (num_shares, 2); z is 0 between the poles.
        """
        length = variables[-1]
        psi, _ = self.angles(variables)
        r = self._radius(psi, length)[0]
        z = length * (self.integral @ np.sin(psi))
        rows = [self.row_at(self.at_area(variables, share)) for share in shares]
        return np.array(rows) @ np.stack([r, z - length * self.weights @ np.sin(psi) / 2], axis=1)


class Branch(NamedTuple):
    """States from the sphere to the buds.

    shapes : LinedShapes
    openings : ndarray
        r over that on the sphere, falling.
    tensions : ndarray
        λL/κ.
    energies : ndarray
        Of bending, over 8πκ.
    variables : ndarray
        Shape (num_states, num_variables).
    """

    shapes: LinedShapes
    openings: np.ndarray
    tensions: np.ndarray
    energies: np.ndarray
    variables: np.ndarray

    def _curve(self, values):
        # Openings from low to high, as splines need them.
        return CubicSpline(self.openings[::-1], values[::-1])

    def spinodals(self):
        """(λL/κ, opening) where domains have to bud, and where buds have to open."""
        curve = self._curve(self.tensions)
        bottom, top = curve.derivative().roots(extrapolate=False)[-2:]
        return [(float(curve(at)), float(at)) for at in (top, bottom)]

    def opening_at(self, tension):
        """The opening of domains that have not budded."""
        curve = self._curve(self.tensions)
        (_, top), _ = self.spinodals()
        return brentq(lambda opening: curve(opening) - tension, top, self.openings[0])

    def crossing(self):
        """λL/κ where buds have the energy of domains that have not budded."""
        (high, _), (low, bottom) = self.spinodals()
        radius = 2 * np.sqrt(self.shapes.share * (1 - self.shapes.share))
        curve, bending = self._curve(self.tensions), self._curve(self.energies)

        def energy(opening, tension):
            line = tension * radius * opening / (4 * np.sqrt(self.shapes.share))
            return bending(opening) + line

        def difference(tension):
            bud = brentq(lambda opening: curve(opening) - tension, self.openings[-1], bottom)
            return energy(self.opening_at(tension), tension) - energy(bud, tension)

        return brentq(difference, low, min(high, self.tensions[-1]))


def branch(share, openings=OPENINGS, highest=HIGHEST):
    """The Branch of domains of a share of the area each."""
    shapes = LinedShapes(highest, share)
    variables, states, tensions = shapes.sphere(), [], []
    radius = 2 * np.sqrt(share * (1 - share))
    for opening in openings:
        variables, tension = shapes.minimum_at(opening * radius, variables)
        states.append(variables)
        tensions.append(tension)
    energies = [shapes.energy(each)[0] for each in states]
    return Branch(
        shapes, np.array(openings), np.array(tensions), np.array(energies), np.array(states)
    )
