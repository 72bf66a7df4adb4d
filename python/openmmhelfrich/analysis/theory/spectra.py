"""Fluctuation spectra of nearly spherical vesicles, and what follows from them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..._numbers import not_negative, positive, whole_number
from ..._types import Array
from ._modes import check_modes, plain


def stiffness(l: ArrayLike) -> Array | float:
    """The factor (l+2)(l+1) l (l−1) by which bending grows with the mode number (A16).

    Parameters
    ----------
    l : int or array_like
        Mode number.

    Returns
    -------
    float or ndarray
        The factor, without unit: 0 for l = 0 and 1, 24 for l = 2. Times κ it is the stiffness of a
        mode, in the unit of κ.
    """
    l = np.asarray(l, dtype=float)
    return plain((l + 2) * (l + 1) * l * (l - 1))


def fluid_spectrum(l: ArrayLike, kappa_over_kT: ArrayLike) -> Array | float:
    """Mean square amplitude of a mode of a fluid vesicle without tension (A17).

    ⟨|u_lm|²⟩ = (kBT/κ) / [(l+2)(l+1) l (l−1)]

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more: l = 0 and 1 change size and place, which bending does not resist.
    kappa_over_kT : float or array_like
        Bending rigidity κ over kBT, without unit.

    Returns
    -------
    float or ndarray
        ⟨|u_lm|²⟩, without unit, the same for every m.

    Raises
    ------
    ValueError
        An l below 2, or a rigidity that is not positive.
    """
    check_modes(l)
    return plain(1 / (positive("kappa_over_kT", kappa_over_kT) * stiffness(l)))


def elastic_spectrum(
    l: ArrayLike,
    kappa_over_kT: ArrayLike,
    young_over_kT: ArrayLike,
    radius: ArrayLike,
    pressure_over_kT: ArrayLike = 0.0,
) -> Array | float:
    """Mean square amplitude of a mode of a vesicle with a shear modulus (A18).

    kBT/⟨|u_lm|²⟩ = κ (l+2)(l+1) l (l−1) + Y r0² · 3 (l² + l − 2) / (3 (l² + l) − 2)
                    + ½ p r0³ (l+2)(l−1)

    A pressure p puts the surface under the tension σ = p r0 / 2, which adds σ r0² (l+2)(l−1) as in
    `tense_spectrum`. Y and r0 are those under the pressure, which stretches the shell.

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more.
    kappa_over_kT : float or array_like
        Bending rigidity κ over kBT, without unit.
    young_over_kT : float or array_like
        Two-dimensional Young modulus Y over kBT, 1/nm². `young_modulus` gives that of a mesh.
    radius : float or array_like
        Radius r0 of the vesicle, nm.
    pressure_over_kT : float or array_like
        p over kBT, inside less outside, 1/nm³. Default 0.

    Returns
    -------
    float or ndarray
        ⟨|u_lm|²⟩, without unit, the same for every m.

    Raises
    ------
    ValueError
        An l below 2, a rigidity or radius that is not positive, a negative Young modulus, or a
        pressure at which the mode buckles.
    """
    check_modes(l)
    kappa_over_kT, radius = (
        positive("kappa_over_kT", kappa_over_kT),
        positive("radius", radius),
    )
    young_over_kT = not_negative("young_over_kT", young_over_kT)
    n = np.asarray(l, dtype=float) * (np.asarray(l, dtype=float) + 1)
    shear = young_over_kT * radius**2 * 3 * (n - 2) / (3 * n - 2)
    pressure = np.asarray(pressure_over_kT, dtype=float)
    total = kappa_over_kT * stiffness(l) + shear + pressure * radius**3 * (n - 2) / 2
    buckled = ~(total > 0)
    if buckled.any():
        first = np.broadcast_to(pressure, total.shape)[buckled][0]
        raise ValueError(f"pressure_over_kT: a mode of the shell buckles under {first:g}")
    return plain(1 / total)


def young_modulus(softness: ArrayLike) -> Array | float:
    """Effective Young modulus of a mesh, Y = (Ξ / 0.59)² · 1.8e-3 kBT/nm² (45).

    Parameters
    ----------
    softness : float or array_like
        Ξ = (d / h̄)², the square of least over mean triangle height, without unit, 0 or more.

    Returns
    -------
    float or ndarray
        Y over kBT, 1/nm².

    Raises
    ------
    ValueError
        A negative softness.
    """
    return plain(1.8e-3 * (not_negative("softness", softness) / 0.59) ** 2)


def tense_spectrum(
    l: ArrayLike, kappa_over_kT: ArrayLike, tension_over_kT: ArrayLike, radius: ArrayLike
) -> Array | float:
    """Mean square amplitude of a mode of a fluid vesicle under a tension σ.

    kBT/⟨|u_lm|²⟩ = κ (l+2)(l+1) l (l−1) + σ r0² (l+2)(l−1)

    The paper's vesicles have σ = 0, which leaves (A17). Milner and Safran,
    doi:10.1103/PhysRevA.36.4371; Helfrich, doi:10.1051/jphys:01986004702032100.

    Parameters
    ----------
    l : int or array_like
        Mode number, 2 or more.
    kappa_over_kT : float or array_like
        Bending rigidity κ over kBT, without unit.
    tension_over_kT : float or array_like
        σ over kBT, 1/nm². A sphere is stable above −6 κ / r0².
    radius : float or array_like
        Radius r0 of the vesicle, nm.

    Returns
    -------
    float or ndarray
        ⟨|u_lm|²⟩, without unit, the same for every m.

    Raises
    ------
    ValueError
        An l below 2, a rigidity or radius that is not positive, or a tension at which the sphere
        is not stable.
    """
    check_modes(l)
    kappa_over_kT, radius = (
        positive("kappa_over_kT", kappa_over_kT),
        positive("radius", radius),
    )
    tension, least = np.broadcast_arrays(
        np.asarray(tension_over_kT, dtype=float), -6 * kappa_over_kT / radius**2
    )
    buckled = ~(tension > least)
    if buckled.any():
        raise ValueError(
            f"tension_over_kT: need more than {least[buckled][0]:.6g}, where a sphere buckles, got "
            f"{tension[buckled][0]:g}"
        )
    reduced = tension * radius**2 / kappa_over_kT
    n = np.asarray(l, dtype=float) * (np.asarray(l, dtype=float) + 1)
    return plain(1 / (kappa_over_kT * (n - 2) * (n + reduced)))


def area_excess(kappa_over_kT: ArrayLike, lmax: int) -> Array | float:
    """Mean area that undulations hide, ⟨A⟩ / 4πR_V² − 1, R_V being the radius of equal volume.

    ⟨A⟩/4πR_V² − 1 = Σ_lm (l+2)(l−1) ⟨|u_lm|²⟩ / 8π = (kBT / 8πκ) Σ_{l=2}^{lmax} (2l+1) / (l (l+1))

    with the spectrum (A17); at large lmax about (kBT/4πκ) ln lmax. A mesh of N vertices has modes
    up to lmax ≈ √N. `analysis.area_excess` measures it on a shape.

    Parameters
    ----------
    kappa_over_kT : float or array_like
        Bending rigidity κ over kBT, without unit.
    lmax : int
        Largest mode of the vesicle, 2 or more.

    Returns
    -------
    float or ndarray
        The excess, without unit.

    Raises
    ------
    ValueError
        An lmax that is no whole number of 2 or more, or a rigidity that is not positive.
    """
    l = np.arange(2, whole_number(lmax, "area_excess", "lmax", 2) + 1)
    kappa_over_kT = positive("kappa_over_kT", kappa_over_kT)
    return plain(np.sum((2 * l + 1) / (l * (l + 1))) / (8 * np.pi * kappa_over_kT))
