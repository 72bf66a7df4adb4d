"""Autocorrelation functions and times."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import next_fast_len

from .._numbers import finite_array, whole_number
from .._types import Array


def autocorrelation(
    series: ArrayLike, lags: int | None = None, subtract_mean: bool = False, normalise: bool = True
) -> Array:
    """Autocorrelation function C(k) = Σ_t x(t) x(t+k) / (n − k), by fast Fourier transform.

    Each lag is divided by the number of its pairs, so that the estimate of a series of known zero
    mean, such as u_lm, is unbiased; far lags have few pairs and much noise.

    Parameters
    ----------
    series : array_like
        Shape (n,), or (n, …) for several series at once, at equal intervals of time.
    lags : int, optional
        Number of lags, 0 … lags − 1. Default: n.
    subtract_mean : bool
        Take off the mean of each series. Not for u_lm, whose mean is zero by symmetry: a run that
        is not long has a mean of its own, without which all of C is biased downward by about
        2τσ²/n.
    normalise : bool
        Divide by C(0), so that the function starts at 1; a series of zeros then has NaN.

    Returns
    -------
    ndarray
        Shape (lags,) or (lags, …), without unit, or in that of the series squared if it is not
        normalised. Average equivalent series, such as the 2l + 1 of one l, *before*
        dividing by C(0): with ``normalise=False``.

    Raises
    ------
    ValueError
        No value, a value that is not finite, or a number of lags outside of 1 … n.
    """
    series = _series("autocorrelation", series)
    n = len(series)
    # More lags than values have no pairs.
    lags = n if lags is None else whole_number(lags, "autocorrelation", "lags", 1, n)
    if subtract_mean:
        series = series - series.mean(axis=0)
    # Zeros behind the series keep the circular sum of the transform from wrapping around.
    size = next_fast_len(n + lags, real=True)
    transform = np.fft.rfft(series, n=size, axis=0)
    sums = np.fft.irfft(abs(transform) ** 2, n=size, axis=0)[:lags]
    result = sums / (n - np.arange(lags)).reshape(-1, *[1] * (series.ndim - 1))
    if normalise:
        with np.errstate(divide="ignore", invalid="ignore"):
            result = result / result[0]
    return result


def mode_autocorrelation(amplitudes: ArrayLike, lags: int | None = None) -> Any:
    """Autocorrelation functions of the modes, averaged over m, ⟨u_lm(t) u_lm(0)⟩ / ⟨u_lm²⟩.

    Parameters
    ----------
    amplitudes : array_like
        From `mode_amplitudes`, shape (num_frames, (lmax+1)²), at equal intervals of time.
    lags : int, optional
        Number of lags. Default: all.

    Returns
    -------
    mean : ndarray
        Shape (lags, lmax+1), without unit; column l is 1 at lag 0, to be compared with `theory`.
    spread : ndarray
        The standard error of the mean from the spread of the 2l + 1 modes, same shape: jackknife,
        leaving out one m at a time. NaN for l = 0.

    Raises
    ------
    ValueError
        Another shape, a value that is not finite, or a number of lags that the series does not
        have.
    """
    amplitudes = np.asarray(amplitudes, dtype=float)
    count = round(amplitudes.shape[-1] ** 0.5) if amplitudes.ndim == 2 else 0
    if not count or count**2 != amplitudes.shape[1]:
        raise ValueError(
            "mode_autocorrelation: amplitudes need shape (num_frames, (lmax+1)²), got "
            f"{amplitudes.shape}"
        )
    finite_array(amplitudes, "mode_autocorrelation", "amplitudes")
    functions = autocorrelation(amplitudes, lags, normalise=False)
    mean, spread = (np.full((len(functions), count), np.nan) for _ in range(2))
    for l in range(count):
        of_l = functions[:, l**2 : (l + 1) ** 2]
        total = of_l.sum(axis=1, keepdims=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            mean[:, l] = (total / total[0])[:, 0]
            if l > 0:
                without = (total - of_l) / (total - of_l)[0]
                spread[:, l] = np.sqrt(2 * l * without.var(axis=1))
    return mean, spread


def autocorrelation_time(series: ArrayLike) -> float:
    """Integrated autocorrelation time τ = ½ + Σ_{k>0} ρ(k), in steps of the series.

    A mean over n values has the variance σ² · 2τ/n. The sum ends at the first lag k ≥ 5 τ(k),
    where more terms would add noise only (Sokal's window, doi:10.1007/978-1-4899-0319-8_6).

    Parameters
    ----------
    series : array_like
        Shape (n,), or (n, k) for k equivalent series, whose mean and autocorrelation are taken
        over all of them together: in a run that is not long, the mean of one series alone
        hides its slow part.

    Returns
    -------
    float
        τ in steps of the series, at least ½; ½ for a constant.

    Raises
    ------
    ValueError
        No value, or one that is not finite.
    """
    series = _series("autocorrelation_time", series)
    series = series.reshape(len(series), -1) - series.mean()
    n = len(series)
    # Twice the length in zeros keeps the transform's circular sum from wrapping around.
    transform = np.fft.rfft(series, n=2 * n, axis=0)
    covariance = np.fft.irfft(abs(transform) ** 2, axis=0)[:n].sum(axis=1)
    if not covariance[0] > 0:
        return 0.5
    # The mean over the pairs that a lag has; dividing by n for all would bias τ downward.
    correlation = covariance / covariance[0] * n / np.arange(n, 0, -1)
    time = np.cumsum(correlation) - 0.5
    ended = np.flatnonzero(np.arange(n) >= 5 * time)
    # A series shorter than its memory never meets the window: take the largest partial sum.
    return float(max(0.5, time[ended[0]] if len(ended) else time.max()))


def _series(where, series):
    """An array of finite numbers with an axis for the time."""
    series = np.asarray(series, dtype=float)
    if series.ndim == 0 or series.size == 0:
        raise ValueError(f"{where}: series needs shape (n,) or (n, …), got {series.shape}")
    return finite_array(series, where, "series")
