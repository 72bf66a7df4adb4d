"""The theory of nearly spherical vesicles, r(θ, φ) = r0 [1 + Σ u_lm Y_lm(θ, φ)].

Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
doi:10.1103/PhysRevE.108.015301; the numbers in brackets are its equations. Lengths are in nm,
times in ps, masses in amu, energies in kJ/mol; a ratio to kBT has no unit. All functions work
element by element on arrays of l.
"""

import numpy as np

# Boltzmann's constant, kJ/mol/K (exact since the SI of 2019).
BOLTZMANN = 8.31446261815324e-3


def stiffness(l):
    """The factor (l+2)(l+1) l (l−1) by which bending grows with the mode number; 24 for l = 2."""
    l = np.asarray(l, dtype=float)
    return (l + 2) * (l + 1) * l * (l - 1)


def fluid_spectrum(l, kappa_over_kT):
    """Mean square amplitude of a mode of a fluid vesicle without tension (A17).

    ⟨|u_lm|²⟩ = (kBT/κ) / [(l+2)(l+1) l (l−1)]

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more: l = 0 and 1 change size and place, which bending does not resist.
    kappa_over_kT : float
        Bending rigidity κ over kBT.

    Returns
    -------
    float or ndarray
        ⟨|u_lm|²⟩, the same for every m.

    Raises
    ------
    ValueError
        An l below 2, or a rigidity that is not positive.
    """
    _check_modes(l)
    _check_positive("kappa_over_kT", kappa_over_kT)
    return _plain(1 / (kappa_over_kT * stiffness(l)))


def elastic_spectrum(l, kappa_over_kT, young_over_kT, radius):
    """Mean square amplitude of a mode of a vesicle with a shear modulus (A18).

    kBT/⟨|u_lm|²⟩ = κ (l+2)(l+1) l (l−1) + Y r0² · 3 (l² + l − 2) / (3 (l² + l) − 2)

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more.
    kappa_over_kT : float
        Bending rigidity κ over kBT.
    young_over_kT : float
        Two-dimensional Young modulus Y over kBT, 1/nm². `young_modulus` gives that of a mesh.
    radius : float
        Radius r0 of the vesicle, nm.

    Returns
    -------
    float or ndarray
        ⟨|u_lm|²⟩, the same for every m.

    Raises
    ------
    ValueError
        An l below 2, a rigidity or radius that is not positive, or a negative Young modulus.
    """
    _check_modes(l)
    _check_positive("kappa_over_kT", kappa_over_kT)
    _check_positive("radius", radius)
    if not young_over_kT >= 0:
        raise ValueError(f"young_over_kT: need 0 or more, got {young_over_kT}")
    n = np.asarray(l, dtype=float) * (np.asarray(l, dtype=float) + 1)
    shear = young_over_kT * radius**2 * 3 * (n - 2) / (3 * n - 2)
    return _plain(1 / (kappa_over_kT * stiffness(l) + shear))


def young_modulus(softness):
    """Effective Young modulus of a mesh, Y = (Ξ / 0.59)² · 1.8e-3 kBT/nm² (45).

    Parameters
    ----------
    softness : float
        Ξ = (d / h̄)², the square of least over mean triangle height.

    Returns
    -------
    float
        Y over kBT, 1/nm².
    """
    return 1.8e-3 * (softness / 0.59) ** 2


def mode_frequency(l, rigidity, mass, num_vertices, radius):
    """Angular frequency of an undamped mode, ω_l = √[(4πκ / M r0²) (l+2)(l+1) l (l−1)] (A30).

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more.
    rigidity : float
        Bending rigidity κ, kJ/mol.
    mass : float
        Mass m of one vertex, amu; the vesicle's is M = N m.
    num_vertices : int
        Number N of vertices.
    radius : float
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
    _check_modes(l)
    for name, value in (
        ("rigidity", rigidity),
        ("mass", mass),
        ("num_vertices", num_vertices),
        ("radius", radius),
    ):
        _check_positive(name, value)
    return _plain(np.sqrt(4 * np.pi * rigidity / (num_vertices * mass * radius**2) * stiffness(l)))


def mode_period(l, rigidity, mass, num_vertices, radius):
    """Period of an undamped mode, τ_l = 2π / ω_l with ω_l of `mode_frequency`, ps.

    The slowest is τ_2, about 11 460 ps for the vesicle of the paper.
    """
    return 2 * np.pi / mode_frequency(l, rigidity, mass, num_vertices, radius)


def overdamped_time(frequency, friction):
    """Relaxation time of an overdamped mode, γ / ω², as in exp(−t ω²/γ) (A39).

    Parameters
    ----------
    frequency : float or array_like
        ω of the undamped mode, rad/ps.
    friction : float
        γ, 1/ps. The formula holds for γ much larger than 2ω, and always for Brownian dynamics.

    Returns
    -------
    float or ndarray
        Relaxation time of u_lm, ps; that of |u_lm|² is half as long.
    """
    return _plain(friction / np.asarray(frequency, dtype=float) ** 2)


def _check_modes(l):
    lowest = np.min(l)
    if lowest < 2:
        raise ValueError(f"l: need 2 or more, got {lowest}")


def _check_positive(name, value):
    if not value > 0:
        raise ValueError(f"{name}: need a positive number, got {value}")


def _plain(value):
    """A float for a scalar, the array for an array."""
    return float(value) if np.ndim(value) == 0 else value
