"""Fluctuation spectra of nearly spherical vesicles, and what follows from them."""

import numpy as np

from ._checks import check_modes, check_not_negative, check_positive, plain


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
    check_modes(l)
    check_positive("kappa_over_kT", kappa_over_kT)
    return plain(1 / (kappa_over_kT * stiffness(l)))


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
    check_modes(l)
    check_positive("kappa_over_kT", kappa_over_kT)
    check_positive("radius", radius)
    check_not_negative("young_over_kT", young_over_kT)
    n = np.asarray(l, dtype=float) * (np.asarray(l, dtype=float) + 1)
    shear = young_over_kT * radius**2 * 3 * (n - 2) / (3 * n - 2)
    return plain(1 / (kappa_over_kT * stiffness(l) + shear))


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


def tense_spectrum(l, kappa_over_kT, tension_over_kT, radius):
    """Mean square amplitude of a mode of a fluid vesicle under a tension σ.

    kBT/⟨|u_lm|²⟩ = κ (l+2)(l+1) l (l−1) + σ r0² (l+2)(l−1)

    The paper's vesicles have σ = 0, which leaves (A17). Milner and Safran,
    doi:10.1103/PhysRevA.36.4371; Helfrich, doi:10.1051/jphys:01986004702032100.

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more.
    kappa_over_kT : float
        Bending rigidity κ over kBT.
    tension_over_kT : float
        σ over kBT, 1/nm². A sphere is stable above −6 κ / r0².
    radius : float
        Radius r0 of the vesicle, nm.

    Returns
    -------
    float or ndarray
        ⟨|u_lm|²⟩, the same for every m.

    Raises
    ------
    ValueError
        An l below 2, a rigidity or radius that is not positive, or a tension at which the sphere
        is not stable.
    """
    check_modes(l)
    check_positive("kappa_over_kT", kappa_over_kT)
    check_positive("radius", radius)
    reduced = tension_over_kT * radius**2 / kappa_over_kT
    if not reduced > -6:
        raise ValueError(
            f"tension_over_kT: need more than {-6 * kappa_over_kT / radius**2:.6g}, where a sphere "
            f"buckles, got {tension_over_kT}"
        )
    n = np.asarray(l, dtype=float) * (np.asarray(l, dtype=float) + 1)
    return plain(1 / (kappa_over_kT * (n - 2) * (n + reduced)))


def mode_energy(amplitudes, rigidity):
    """Bending energy of a nearly spherical shape, to second order in its amplitudes (A16).

    E = 8πκ + ½ κ Σ_lm (l+2)(l+1) l (l−1) u_lm²

    By equipartition each mode has ½ kBT, which is (A17). For u_20 alone it is (38).

    Parameters
    ----------
    amplitudes : array_like
        u_lm at index l² + l + m, shape (…, (lmax+1)²).
    rigidity : float
        κ; the result has its unit.

    Returns
    -------
    float or ndarray
        E, shape (…).

    Raises
    ------
    ValueError
        The last axis has no (lmax+1)² entries, or the rigidity is not positive.
    """
    check_positive("rigidity", rigidity)
    u = np.asarray(amplitudes, dtype=float)
    count = round(u.shape[-1] ** 0.5) if u.ndim else 0
    if not count or count**2 != u.shape[-1]:
        raise ValueError(f"amplitudes: need shape (…, (lmax+1)²), got {u.shape}")
    l = np.repeat(np.arange(count), 2 * np.arange(count) + 1)
    return plain(8 * np.pi * rigidity + rigidity / 2 * (u**2 @ stiffness(l)))


def area_excess(kappa_over_kT, lmax):
    """Mean area that undulations hide, ⟨A⟩ / 4πR_V² − 1, R_V being the radius of equal volume.

    ⟨A⟩/4πR_V² − 1 = Σ_lm (l+2)(l−1) ⟨|u_lm|²⟩ / 8π = (kBT / 8πκ) Σ_{l=2}^{lmax} (2l+1) / (l (l+1))

    with the spectrum (A17); at large lmax about (kBT/4πκ) ln lmax. A mesh of N vertices has modes
    up to lmax ≈ √N. `analysis.area_excess` measures it on a shape.

    Parameters
    ----------
    kappa_over_kT : float
        Bending rigidity κ over kBT.
    lmax : int
        Largest mode of the vesicle, 2 or more.

    Returns
    -------
    float
        The excess, without unit.

    Raises
    ------
    ValueError
        An lmax below 2, or a rigidity that is not positive.
    """
    check_modes(lmax)
    check_positive("kappa_over_kT", kappa_over_kT)
    l = np.arange(2, int(lmax) + 1)
    return float(np.sum((2 * l + 1) / (l * (l + 1))) / (8 * np.pi * kappa_over_kT))
