"""Area, volume and bending energy of nearly spherical shapes as sums over their modes (A7–A12).

r = r0 (1 + u), u = Σ u_lm Y_lm. From A = ∫ r √(r² + |∇r|²) dΩ and V = ∫ r³/3 dΩ follow, to second
order, with ∫ u dΩ = √4π u_00, ∫ u² dΩ = Σ u_lm² and ∫ |∇u|² dΩ = Σ l (l+1) u_lm²,

    A / r0² = 4π + 2 √4π u_00 + Σ (1 + ½ l (l+1)) u_lm²
    V / r0³ = 4π/3 + √4π u_00 + Σ u_lm²

A shape with the volume of the sphere has √4π u_00 = −Σ u_lm², and the excess of area
½ r0² Σ (l+2)(l−1) u_lm².
"""

import numpy as np

from ..._numbers import positive
from ._modes import plain
from .spectra import stiffness


def mode_area(amplitudes, radius):
    """Area of a nearly spherical shape, to second order in its amplitudes.

    A = r0² [4π + 2 √4π u_00 + Σ_lm (1 + ½ l (l+1)) u_lm²]

    Parameters
    ----------
    amplitudes : array_like
        u_lm at index l² + l + m, without unit, shape (…, (lmax+1)²).
    radius : float or array_like
        r0, nm; an array has one for each set of amplitudes.

    Returns
    -------
    float or ndarray
        A, nm², shape (…).

    Raises
    ------
    ValueError
        The last axis has no (lmax+1)² entries, or the radius is not positive.
    """
    radius = positive("radius", radius)
    u, l = _modes(amplitudes)
    first = 4 * np.pi + 2 * np.sqrt(4 * np.pi) * u[..., 0]
    return plain(radius**2 * (first + u**2 @ (1 + l * (l + 1) / 2)))


def mode_volume(amplitudes, radius):
    """Volume of a nearly spherical shape, to second order in its amplitudes.

    V = r0³ [4π/3 + √4π u_00 + Σ_lm u_lm²]

    Parameters
    ----------
    amplitudes, radius
        As for `mode_area`: without unit, and r0 in nm.

    Returns
    -------
    float or ndarray
        V, nm³, shape (…).

    Raises
    ------
    ValueError
        As for `mode_area`.
    """
    radius = positive("radius", radius)
    u, _ = _modes(amplitudes)
    first = 4 * np.pi / 3 + np.sqrt(4 * np.pi) * u[..., 0]
    return plain(radius**3 * (first + np.sum(u**2, axis=-1)))


def mode_energy(amplitudes, rigidity):
    """Bending energy of a nearly spherical shape, to second order in its amplitudes (A16).

    E = 8πκ + ½ κ Σ_lm (l+2)(l+1) l (l−1) u_lm²

    By equipartition each mode has ½ kBT, which is (A17). For u_20 alone it is (38).

    Parameters
    ----------
    amplitudes : array_like
        u_lm at index l² + l + m, without unit, shape (…, (lmax+1)²).
    rigidity : float or array_like
        κ, kJ/mol, or in any other unit of energy, which the result then has; an array has one for
        each set of amplitudes.

    Returns
    -------
    float or ndarray
        E, kJ/mol, shape (…).

    Raises
    ------
    ValueError
        The last axis has no (lmax+1)² entries, or the rigidity is not positive.
    """
    rigidity = positive("rigidity", rigidity)
    u, l = _modes(amplitudes)
    return plain(8 * np.pi * rigidity + rigidity / 2 * (u**2 @ stiffness(l)))


def _modes(amplitudes):
    """Amplitudes as an array, and the l of each entry of its last axis."""
    u = np.asarray(amplitudes, dtype=float)
    count = round(u.shape[-1] ** 0.5) if u.ndim else 0
    if not count or count**2 != u.shape[-1]:
        raise ValueError(f"amplitudes: need shape (…, (lmax+1)²), got {u.shape}")
    return u, np.repeat(np.arange(count), 2 * np.arange(count) + 1)
