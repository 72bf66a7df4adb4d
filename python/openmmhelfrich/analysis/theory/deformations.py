"""Energies of a sphere with one mode, r = r0 (1 + u Y_20), at given targets of the sphere."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..._numbers import not_negative, positive
from ..._types import Array
from ._modes import plain


def area_energy(amplitude: ArrayLike, modulus: ArrayLike, radius: ArrayLike) -> Array | float:
    """Energy of the area term of a sphere deformed by u_20, E_A = (2/π) kA u⁴ r0² (34).

    ½ kA (A − A0)² / A0 with A0 = 4π r0² and A − A0 = 4 u² r0² to leading order.

    Parameters
    ----------
    amplitude : float or array_like
        u_20, without unit.
    modulus : float or array_like
        kA, kJ/mol/nm².
    radius : float or array_like
        r0, nm.

    Returns
    -------
    float or ndarray
        E_A, kJ/mol, with an error of higher order in u.

    Raises
    ------
    ValueError
        A negative modulus, or a radius that is not positive.
    """
    modulus, radius = not_negative("modulus", modulus), positive("radius", radius)
    return plain(2 / np.pi * modulus * np.asarray(amplitude, dtype=float) ** 4 * radius**2)


def volume_energy(amplitude: ArrayLike, modulus: ArrayLike, radius: ArrayLike) -> Array | float:
    """Energy of the volume term of a sphere deformed by u_20, E_V = (3/8π) kV u⁴ r0³ (36).

    ½ kV (V − V0)² / V0 with V0 = 4π r0³ / 3 and V − V0 = u² r0³ to leading order.

    Parameters
    ----------
    amplitude : float or array_like
        u_20, without unit.
    modulus : float or array_like
        kV, kJ/mol/nm³.
    radius : float or array_like
        r0, nm.

    Returns
    -------
    float or ndarray
        E_V, kJ/mol, with an error of higher order in u.

    Raises
    ------
    ValueError
        A negative modulus, or a radius that is not positive.
    """
    modulus, radius = not_negative("modulus", modulus), positive("radius", radius)
    u = np.asarray(amplitude, dtype=float)
    return plain(3 / (8 * np.pi) * modulus * u**4 * radius**3)


def bending_energy(amplitude: ArrayLike, rigidity: ArrayLike) -> Array | float:
    """Bending energy of a sphere deformed by u_20, E_b = 8πκ + 12 κ u² (38).

    Parameters
    ----------
    amplitude : float or array_like
        u_20, without unit.
    rigidity : float or array_like
        κ, kJ/mol.

    Returns
    -------
    float or ndarray
        E_b, kJ/mol, with an error of higher order in u. `mode_energy` has any set of modes.

    Raises
    ------
    ValueError
        A negative rigidity.
    """
    rigidity = not_negative("rigidity", rigidity)
    return plain(rigidity * (8 * np.pi + 12 * np.asarray(amplitude, dtype=float) ** 2))
