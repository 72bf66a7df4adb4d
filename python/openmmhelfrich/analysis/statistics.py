"""Means over a run, with error bars that know about correlation in time."""

from typing import NamedTuple

import numpy as np


class Spectrum(NamedTuple):
    """Mean square amplitudes per l, as `spectrum` returns them; arrays of equal length."""

    l: np.ndarray
    """Mode number, 0 … lmax."""
    mean: np.ndarray
    """⟨|u_lm|²⟩, mean over the 2l + 1 values of m and over the frames."""
    error: np.ndarray
    """Standard error of the mean."""
    correlation_time: np.ndarray
    """Integrated autocorrelation time of |u_lm|², in frames; ½ if frames are independent."""

    def interval(self, width=1.96):
        """Confidence interval of ⟨|u_lm|²⟩, [mean / (1 + w ε), mean / (1 − w ε)], ε = error / mean.

        What a run fixes is the *relative* error, for a mode that happened to be quiet has a mean
        and an error bar that are both too small by the same factor. So the interval is that of a
        scale: it reaches further up than down. Normal modes of a run of 60 memories are covered
        in 94 of 100 cases by it, and in 91 by mean ± w error.

        Parameters
        ----------
        width : float
            w, in standard errors. Default 1.96, for 95 % confidence.

        Returns
        -------
        low, high : ndarray
            Bounds per l; `high` is infinite where the error is too large to give one.
        """
        # A mode that never moves has 0/0, and an interval of NaN.
        with np.errstate(divide="ignore", invalid="ignore"):
            share = width * self.error / self.mean
            high = np.where(share < 1, self.mean / np.maximum(1 - share, 0), np.inf)
        return self.mean / (1 + share), high


def spectrum(amplitudes):
    """Fluctuation spectrum ⟨|u_lm|²⟩ per l with error bars.

    The standard error is √(2 τ σ² / n): σ² is the variance of |u_lm|², n the number of
    frames times 2l + 1, because the modes of one l are equivalent on a sphere, and τ their
    integrated autocorrelation time, see `autocorrelation_time`. A run shorter than a few τ
    does not know its own τ, and its error bars are too small.

    Parameters
    ----------
    amplitudes : array_like
        From `mode_amplitudes`, shape (num_frames, (lmax+1)²), at equal intervals of time.

    Returns
    -------
    Spectrum
        l, mean, error and correlation time.

    Raises
    ------
    ValueError
        Another shape, or fewer than two frames.
    """
    amplitudes = np.asarray(amplitudes, dtype=float)
    if amplitudes.ndim != 2 or round(amplitudes.shape[1] ** 0.5) ** 2 != amplitudes.shape[1]:
        raise ValueError(f"amplitudes: need shape (num_frames, (lmax+1)²), got {amplitudes.shape}")
    num_frames = len(amplitudes)
    if num_frames < 2:
        raise ValueError(f"amplitudes: an error bar needs two frames or more, got {num_frames}")
    modes = np.arange(round(amplitudes.shape[1] ** 0.5))
    mean, error, time = (np.empty(len(modes)) for _ in range(3))
    for l in modes:
        squares = amplitudes[:, l**2 : (l + 1) ** 2] ** 2
        mean[l] = squares.mean()
        time[l] = autocorrelation_time(squares)
        error[l] = np.sqrt(2 * time[l] * squares.var() / squares.size)
    return Spectrum(modes, mean, error, time)


def autocorrelation_time(series):
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
        τ, at least ½; ½ for a constant.
    """
    series = np.asarray(series, dtype=float)
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
