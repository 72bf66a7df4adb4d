"""Real spherical harmonics."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._numbers import finite_array, whole_number
from .._types import Array


def real_harmonics(directions: ArrayLike, lmax: int) -> Array:
    """Real orthonormal spherical harmonics, ∫ Y_lm Y_l'm' dΩ = δ_ll' δ_mm'.

    Y_lm = √2 N P_l^m(cos θ) cos mφ for m > 0, N P_l(cos θ) for m = 0 and √2 N P_l^|m|(cos θ)
    sin |m|φ for m < 0, without the Condon–Shortley phase: Y_1−1, Y_10 and Y_11 are
    √(3/4π) times y, z and x.

    Parameters
    ----------
    directions : array_like
        Unit vectors, shape (…, 3).
    lmax : int
        Largest l, 0 or more.

    Returns
    -------
    ndarray
        Shape (…, (lmax+1)²), index l² + l + m, without unit.

    Raises
    ------
    ValueError
        Another shape, a vector whose length is not 1 within 1e-6, or an lmax that is no whole
        number of 0 or more.
    """
    directions = finite_array(directions, "real_harmonics", "directions")
    if directions.ndim == 0 or directions.shape[-1] != 3:
        raise ValueError(f"real_harmonics: directions: need shape (…, 3), got {directions.shape}")
    lengths = np.linalg.norm(directions, axis=-1)
    wrong = np.argwhere(abs(lengths - 1) > 1e-6)
    if len(wrong):
        place = tuple(wrong[0].tolist())
        index = f"[{', '.join(map(str, place))}]" if place else ""
        raise ValueError(
            f"real_harmonics: directions{index} has the length {lengths[place]:g}; divide by it"
        )
    lmax = whole_number(lmax, "real_harmonics", "lmax", 0)
    harmonics = harmonics_of(directions[np.newaxis], lmax)[0]
    return np.moveaxis(harmonics, 0, -1)


def harmonics_of(directions: Any, lmax: int) -> Any:
    """Y_lm for unit vectors of shape (num_frames, …, 3), shape (num_frames, (lmax+1)², …).

    The Legendre functions are divided by sin^m θ, which leaves polynomials of z that a stable
    recurrence in l gives; the powers of x + iy carry sin^m θ cos mφ and sin^m θ sin mφ. No
    trigonometric function is called and the poles are points like others.
    """
    x, y, z = np.moveaxis(directions, -1, 0)
    result = np.empty((len(x), (lmax + 1) ** 2, *x.shape[1:]))
    for m, (diagonal, cosine, sine) in zip(range(lmax + 1), _orders(x, y), strict=False):
        for l, legendre in zip(range(m, lmax + 1), _degrees(z, m, diagonal), strict=False):
            if m == 0:
                result[:, l * l + l] = legendre
            else:
                result[:, l * l + l + m] = np.sqrt(2) * legendre * cosine
                result[:, l * l + l - m] = np.sqrt(2) * legendre * sine
    return result


def one_harmonic(directions: Any, l: int, m: int) -> Any:
    """Y_lm for unit vectors of shape (…, 3), shape (…), with the bits of `harmonics_of`."""
    x, y, z = np.moveaxis(directions, -1, 0)
    order = abs(m)
    diagonal, cosine, sine = next(itertools.islice(_orders(x, y), order, None))
    legendre = next(itertools.islice(_degrees(z, order, diagonal), l - order, None))
    if m == 0:
        return legendre
    return np.sqrt(2) * legendre * (cosine if m > 0 else sine)


def _orders(x: Any, y: Any) -> Iterator[tuple[Any, Any, Any]]:
    """For m = 0, 1 …: the first Legendre function, l = m, sin^m θ cos mφ and sin^m θ sin mφ."""
    cosine, sine = np.ones_like(x), np.zeros_like(x)
    diagonal = np.sqrt(1 / (4 * np.pi))
    yield diagonal, cosine, sine
    for m in itertools.count(1):
        cosine, sine = x * cosine - y * sine, x * sine + y * cosine
        diagonal *= np.sqrt((2 * m + 1) / (2 * m))
        yield diagonal, cosine, sine


def _degrees(z: Any, m: int, diagonal: Any) -> Iterator[Any]:
    """For l = m, m + 1 …: the Legendre function over sin^m θ."""
    before, legendre = 0, np.full_like(z, diagonal)
    yield legendre
    for l in itertools.count(m + 1):
        a = np.sqrt((4 * l**2 - 1) / (l**2 - m**2))
        b = np.sqrt(((l - 1) ** 2 - m**2) / (4 * (l - 1) ** 2 - 1))
        before, legendre = legendre, (a * z) * legendre - (a * b) * before
        yield legendre
