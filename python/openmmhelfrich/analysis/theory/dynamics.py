"""Frequencies, damping and autocorrelations of the modes of a vesicle."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..._numbers import not_negative, positive
from ..._types import Array
from ._modes import check_modes, plain
from .spectra import stiffness


def mode_frequency(
    l: ArrayLike, rigidity: ArrayLike, mass: ArrayLike, num_vertices: ArrayLike, radius: ArrayLike
) -> Array | float:
    """Angular frequency of an undamped mode, ω_l = √[(4πκ / M r0²) (l+2)(l+1) l (l−1)] (A30).

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more.
    rigidity : float or array_like
        Bending rigidity κ, kJ/mol.
    mass : float or array_like
        Mass m of one vertex, amu; the vesicle's is M = N m.
    num_vertices : int or array_like
        Number N of vertices.
    radius : float or array_like
        Radius r0 of the vesicle, nm.

    Returns
    -------
    float or ndarray
        ω_l, rad/ps.

    Raises
    ------
    ValueError
        An l below 2, or another argument that is not positive.
    """
    check_modes(l)
    total = positive("num_vertices", num_vertices) * positive("mass", mass)
    rigidity, radius = positive("rigidity", rigidity), positive("radius", radius)
    return plain(np.sqrt(4 * np.pi * rigidity / (total * radius**2) * stiffness(l)))


def mode_period(
    l: ArrayLike, rigidity: Any, mass: Any, num_vertices: Any, radius: Any
) -> Array | float:
    """Period of an undamped mode, τ_l = 2π / ω_l with ω_l of `mode_frequency`.

    The slowest is τ_2, about 11 460 ps for the vesicle of the paper.

    Parameters
    ----------
    l, rigidity, mass, num_vertices, radius
        As for `mode_frequency`: κ in kJ/mol, m in amu, r0 in nm.

    Returns
    -------
    float or ndarray
        τ_l, ps.

    Raises
    ------
    ValueError
        As for `mode_frequency`.
    """
    return 2 * np.pi / mode_frequency(l, rigidity, mass, num_vertices, radius)


def overdamped_time(frequency: ArrayLike, friction: ArrayLike) -> Array | float:
    """Relaxation time of an overdamped mode, γ / ω², as in exp(−t ω²/γ) (A39).

    Parameters
    ----------
    frequency : float or array_like
        ω of the undamped mode, rad/ps, above 0.
    friction : float or array_like
        γ, 1/ps, above 0. The formula holds for γ much larger than 2ω, and always for Brownian
        dynamics.

    Returns
    -------
    float or ndarray
        Relaxation time of u_lm, ps; that of |u_lm|² is half as long.

    Raises
    ------
    ValueError
        A frequency or friction that is not positive.
    """
    return plain(positive("friction", friction) / positive("frequency", frequency) ** 2)


def internal_friction(frequency: ArrayLike, ratio: ArrayLike = 0.15) -> Array | float:
    """Damping of a mode by the mesh itself, without any thermostat: γ_l ≈ 0.15 ω_l.

    What the paper finds at softness Ξ = 0.037 under Newton's equations (SM 9): undulations lose
    their energy to the motion of vertices within the surface.

    Parameters
    ----------
    frequency : float or array_like
        ω_l, rad/ps, 0 or more, see `mode_frequency`.
    ratio : float or array_like
        γ_l / ω_l, 0 or more, without unit. Default 0.15.

    Returns
    -------
    float or ndarray
        γ_l, 1/ps, a rate as in `langevin_autocorrelation`.

    Raises
    ------
    ValueError
        A negative frequency or ratio.
    """
    return plain(not_negative("ratio", ratio) * not_negative("frequency", frequency))


def newtonian_autocorrelation(time: ArrayLike, frequency: ArrayLike) -> Array | float:
    """⟨u(t) u(0)⟩ / ⟨u²⟩ of an undamped mode, cos ω t (A30).

    Parameters
    ----------
    time : float or array_like
        t, ps.
    frequency : float or array_like
        ω, rad/ps, 0 or more; it broadcasts against the time.

    Returns
    -------
    float or ndarray
        The normalised autocorrelation, without unit, 1 at t = 0.

    Raises
    ------
    ValueError
        A negative frequency.
    """
    return plain(np.cos(not_negative("frequency", frequency) * np.asarray(time, dtype=float)))


def langevin_autocorrelation(
    time: ArrayLike, frequency: ArrayLike, friction: ArrayLike
) -> Array | float:
    """⟨u(t) u(0)⟩ / ⟨u²⟩ of a mode under Langevin dynamics (A35–A37).

    ü = −ω² u − γ u̇ + noise gives, with ω' = √(ω² − γ²/4),

    - ω > γ/2, underdamped: e^{−γt/2} [cos ω't + γ/(2ω') sin ω't]
    - ω = γ/2, critical: e^{−γt/2} [1 + γt/2]
    - ω < γ/2, overdamped: e^{−γt/2} [cosh |ω'|t + γ/(2|ω'|) sinh |ω'|t]

    All are 1 at t = 0. (A37) as printed in the paper lacks a factor of γ / (2|ω'|) for that.
    Which modes are overdamped follows from the exact ω_l; the paper's l_crit has l⁴ in place of
    (l+2)(l+1) l (l−1) and calls l = 2 overdamped at γ = 0.001/ps, which it is not.

    Parameters
    ----------
    time : float or array_like
        t, ps; the function is even in t.
    frequency : float or array_like
        ω, rad/ps, 0 or more.
    friction : float or array_like
        γ, 1/ps, 0 or more. The three arguments broadcast against each other.

    Returns
    -------
    float or ndarray
        The normalised autocorrelation, without unit.

    Raises
    ------
    ValueError
        A negative frequency or friction.
    """
    t, omega, gamma = np.broadcast_arrays(
        np.abs(np.asarray(time, dtype=float)),
        not_negative("frequency", frequency),
        not_negative("friction", friction),
    )
    square = (omega - gamma / 2) * (omega + gamma / 2)
    shifted = np.sqrt(np.abs(square))
    phase = shifted * t
    # sin x / x and sinh x / x have no pole at the critical point, so that t γ/2 stands in front.
    under = np.exp(-gamma * t / 2) * (np.cos(phase) + gamma * t / 2 * np.sinc(phase / np.pi))
    # The hyperbolic functions overflow long before their product with the exponential vanishes;
    # so this branch has the two decaying exponentials instead. e^{−γt/2 + |ω'|t} is written with
    # ω² / (γ/2 + |ω'|), which loses no digits where γ is large.
    slow = np.exp(-_ratio(omega**2, gamma / 2 + shifted) * t)
    drop = -np.expm1(-2 * phase)
    over = slow * ((2 - drop) / 2 + gamma * t / 2 * np.where(phase > 0, _ratio(drop, 2 * phase), 1))
    return plain(np.where(square >= 0, under, over)[()])


def brownian_autocorrelation(
    time: ArrayLike, frequency: ArrayLike, friction: ArrayLike
) -> Array | float:
    """⟨u(t) u(0)⟩ / ⟨u²⟩ of a mode under Brownian dynamics, exp(−t ω²/γ) (A39).

    Also the limit of `langevin_autocorrelation` for γ ≫ 2ω.

    Parameters
    ----------
    time : float or array_like
        t, ps; the function is even in t.
    frequency : float or array_like
        ω, rad/ps, 0 or more.
    friction : float or array_like
        γ, 1/ps, above 0. The three arguments broadcast against each other.

    Returns
    -------
    float or ndarray
        The normalised autocorrelation, without unit, 1 at t = 0.

    Raises
    ------
    ValueError
        A negative frequency, or a friction that is not positive.
    """
    rate = not_negative("frequency", frequency) ** 2 / positive("friction", friction)
    return plain(np.exp(-np.abs(np.asarray(time, dtype=float)) * rate))


def _ratio(above, below):
    """Quotient with 0/0 = 0."""
    return np.divide(above, below, out=np.zeros_like(below), where=below > 0)
