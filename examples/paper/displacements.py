"""Displacements of vertices within the surface of a nearly spherical vesicle.

A vertex whose place in the undeformed mesh is r0 R̂ has moved, seen from the centre, into the
direction r̂. The tangential field r̂ − R̂ splits into two kinds of vector harmonics,

    Σ_lm s_lm ∇Y_lm + t_lm R̂ × ∇Y_lm,

compressions s_lm and rotations t_lm. The rotations are pure shear: they change neither the shape
of the membrane nor the density of its vertices. In a fluid nothing resists them; in a sheet of
shear modulus μ each is a harmonic oscillator,

    E = ½ μ r0² (l+2)(l+1) l (l−1) t_lm²,    kBT / ⟨t_lm²⟩ = μ r0² (l+2)(l+1) l (l−1),

so that ⟨t_lm²⟩ measures μ without any reference to undulations. Compressions are coupled to the
amplitudes u_lm of the shape, since a bulge stretches the mesh: with n = l (l+1),

    E = ½ [κ (l+2)(l+1) l (l−1) u² + K r0² (2u − n s)² + μ r0² n (n−2) s²],

K being the modulus of the vertex density. Whoever integrates s out finds (A18) of
doi:10.1103/PhysRevE.108.015301 for K = 2μ, and in general
kBT/⟨|u_lm|²⟩ = κ (l+2)(l+1) l (l−1) + 4 μK r0² (n−2) / (μ(n−2) + K n).
"""

import numpy as np
from openmmhelfrich.analysis import real_harmonics


class Displacements:
    """Tangential displacements against an undeformed mesh.

    Parameters
    ----------
    vertices : array_like
        The undeformed mesh, shape (num_vertices, 3), about the origin.
    lmax : int
        Largest l. Harmonics up to it are fitted together by least squares.
    """

    def __init__(self, vertices, lmax):
        self._reference = _directions(np.asarray(vertices, dtype=float))
        self._lmax = lmax
        gradients = _gradients(self._reference, lmax)[:, 1:]
        curls = np.cross(self._reference[:, np.newaxis], gradients)
        fields = np.concatenate([gradients, curls], axis=1)
        self._inverse = np.linalg.pinv(fields.transpose(0, 2, 1).reshape(-1, fields.shape[1]))

    def aligned(self, positions):
        """The frames about their centres of mass, rotated to fit the undeformed mesh best (Kabsch).

        Parameters
        ----------
        positions : array_like
            Shape (num_frames, num_vertices, 3).

        Returns
        -------
        ndarray
            Same shape.
        """
        positions = np.asarray(positions, dtype=float)
        positions = positions - positions.mean(axis=1, keepdims=True)
        left, _, right = np.linalg.svd(_directions(positions).transpose(0, 2, 1) @ self._reference)
        left[:, :, 2] *= np.linalg.det(left @ right)[:, np.newaxis]
        return positions @ (left @ right)

    def __call__(self, aligned):
        """Amplitudes (s_lm, t_lm) of frames that `aligned` has rotated.

        Parameters
        ----------
        aligned : array_like
            Shape (num_frames, num_vertices, 3).

        Returns
        -------
        tuple of ndarray
            s and t, each of shape (num_frames, (lmax+1)²), index l² + l + m; zero for l = 0.
        """
        reference = self._reference
        moved = _directions(np.asarray(aligned, dtype=float)) - reference
        moved -= np.einsum("fia,ia->fi", moved, reference)[:, :, np.newaxis] * reference
        amplitudes = moved.reshape(len(moved), -1) @ self._inverse.T
        result = np.zeros((2, len(moved), (self._lmax + 1) ** 2))
        result[0, :, 1:], result[1, :, 1:] = np.split(amplitudes, 2, axis=1)
        return result[0], result[1]


def shear_modulus(toroidal, l, blocks=10):
    """μ r0² / kBT from the rotations of one l, and its standard error (jackknife of blocks).

    Parameters
    ----------
    toroidal : array_like
        t_lm, shape (num_frames, (lmax+1)²).
    l : int
        2 or more.
    blocks : int
        Number of blocks of consecutive frames, each longer than the memory of the mode.

    Returns
    -------
    tuple of float
    """

    def estimate(chosen):
        return np.array([1 / (chosen**2).mean() / ((l + 2) * (l + 1) * l * (l - 1))])

    value, error = jackknife(np.asarray(toroidal)[:, l**2 : (l + 1) ** 2], estimate, blocks)
    return value[0], error[0]


def moduli(shape, compression, l, blocks=10):
    """K r0², μ r0² and κ over kBT from the covariance of u_lm and s_lm, and their errors.

    The inverse of the covariance matrix of (u, s) is the matrix of the energy above over kBT, whose
    three entries give the three moduli.

    Parameters
    ----------
    shape, compression : array_like
        u_lm and s_lm of the same frames, each of shape (num_frames, (lmax+1)²). Both have to be
        taken in the same rotated frame; only their scalar products over m enter.
    l : int
        2 or more.
    blocks : int
        As for `shear_modulus`.

    Returns
    -------
    tuple of ndarray
        Values and errors, each of shape (3,): K r0², μ r0², κ.
    """
    of_l = slice(l**2, (l + 1) ** 2)
    n = l * (l + 1)

    def estimate(pairs):
        stiffness = np.linalg.inv(np.einsum("fkm,fjm->kj", pairs, pairs) / pairs[:, 0].size)
        area = -stiffness[0, 1] / (2 * n)
        shear = (stiffness[1, 1] - area * n**2) / (n * (n - 2))
        bending = (stiffness[0, 0] - 4 * area) / ((l + 2) * (l + 1) * l * (l - 1))
        return np.array([area, shear, bending])

    pairs = np.stack([np.asarray(shape)[:, of_l], np.asarray(compression)[:, of_l]], axis=1)
    return jackknife(pairs, estimate, blocks)


def jackknife(frames, estimate, blocks):
    """An estimate from all frames, and its error from leaving out one block at a time."""
    parts = np.array_split(np.asarray(frames, dtype=float), blocks)
    without = [estimate(np.concatenate(parts[:left] + parts[left + 1 :])) for left in range(blocks)]
    error = np.sqrt((blocks - 1) * np.var(without, axis=0))
    return estimate(np.concatenate(parts)), error


def _directions(positions):
    return positions / np.linalg.norm(positions, axis=-1, keepdims=True)


def _gradients(directions, lmax):
    """Surface gradients of the harmonics, shape (num_vertices, (lmax+1)², 3).

    By central differences, whose error of 1e-10 is far below the noise of any run.
    """
    step = 1e-5
    axes = np.eye(3) * step
    difference = [
        real_harmonics(_directions(directions + axis), lmax)
        - real_harmonics(_directions(directions - axis), lmax)
        for axis in axes
    ]
    return np.stack(difference, axis=-1) / (2 * step)
