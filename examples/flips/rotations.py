"""Flow within the surface of a nearly spherical vesicle, by modes.

A velocity field along a sphere without sources is a sum of rotations,

    v(r̂) = Σ_lm v_lm Φ_lm(r̂),    Φ_lm = r̂ × ∇Y_lm,    ∫ Φ_lm · Φ_l'm' dΩ = l (l+1) δ_ll' δ_mm',

∇ being the gradient on the unit sphere. l = 1 is a rigid rotation, l ≥ 2 is pure shear: it changes
neither the shape nor the density of vertices. With N vertices of mass m the modes are

    v_lm = 4π / [N l (l+1)] Σ_i v_i · Φ_lm(r̂_i),    ⟨v_lm²⟩ = 4π kBT / [N m l (l+1)].

A vertex is not a place: r̂_i is where it is at the moment.
"""

import numpy as np
from openmmhelfrich.analysis import real_harmonics


class Rotations:
    """The fields Φ_lm, and the amplitudes of velocities in them.

    Turning a point about an axis turns Y_lm into others of the same l, so that the component of
    Φ_lm along the axis is a fixed sum of them: d/dε Y_lm(r̂ + ε e × r̂) = e · Φ_lm. One evaluation of
    the harmonics is all that a frame needs.

    Parameters
    ----------
    lmax : int
        Largest l.
    """

    def __init__(self, lmax):
        self._lmax = lmax
        degree = np.repeat(np.arange(lmax + 1), 2 * np.arange(lmax + 1) + 1)
        self._norm = degree * (degree + 1)
        # Any points will do that tell (lmax+1)² harmonics apart.
        points = np.random.default_rng(1).normal(size=(4 * len(degree), 3))
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        inverse = np.linalg.pinv(real_harmonics(points, lmax))
        angle = 1e-5
        self._turns = np.empty((3, len(degree), len(degree)))
        for axis, turn in enumerate(self._turns):
            ahead, behind = (
                real_harmonics(rotated(points, axis, each), lmax) for each in (angle, -angle)
            )
            turn[:] = inverse @ (ahead - behind) / (2 * angle)
        # Rounding aside, there is nothing between different l.
        self._turns[:, degree[:, np.newaxis] != degree] = 0

    def field(self, directions, l, m):
        """Φ_lm at unit vectors, shape (num_vertices, 3), without unit."""
        return real_harmonics(directions, self._lmax) @ self._turns[:, :, l**2 + l + m].T

    def __call__(self, positions, velocities):
        """Amplitudes v_lm of frames, about the mean of the positions and of the velocities.

        Parameters
        ----------
        positions, velocities : array_like
            Shape (num_frames, num_vertices, 3), nm and nm/ps.

        Returns
        -------
        ndarray
            Shape (num_frames, (lmax+1)²), index l² + l + m, nm/ps; zero for l = 0.
        """
        velocities = velocities - velocities.mean(axis=1, keepdims=True)
        harmonics = real_harmonics(directions_of(positions), self._lmax)
        sums = velocities.transpose(0, 2, 1) @ harmonics
        amplitudes = np.einsum("fak,akm->fm", sums, self._turns)
        return amplitudes * (4 * np.pi / positions.shape[1]) / np.maximum(self._norm, 1)


def rotated(points, axis, angle):
    """Points turned about a coordinate axis."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    result = np.array(points)
    result[:, first] = np.cos(angle) * points[:, first] - np.sin(angle) * points[:, second]
    result[:, second] = np.sin(angle) * points[:, first] + np.cos(angle) * points[:, second]
    return result


def directions_of(positions):
    """Unit vectors from the mean of positions of shape (…, num_vertices, 3)."""
    arms = positions - positions.mean(axis=-2, keepdims=True)
    return arms / np.linalg.norm(arms, axis=-1, keepdims=True)
