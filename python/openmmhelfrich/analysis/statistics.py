"""Means over a run, with error bars that know about correlation in time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._numbers import finite_array
from .._types import Array
from .correlation import autocorrelation_time


class Estimate(NamedTuple):
    """A mean with its standard error, as `mean_with_error` returns it."""

    mean: float
    """Mean of all values, in the unit of the series."""
    error: float
    """Standard error of the mean, in the same unit."""
    correlation_time: float
    """Integrated autocorrelation time τ in steps; ½ if values are independent."""
    effective_samples: float
    """Number of independent values that would give the same error, n / 2τ."""


class Spectrum(NamedTuple):
    """Mean square amplitudes per l, as `spectrum` returns them; arrays of equal length."""

    l: Array
    """Mode number, 0 … lmax."""
    mean: Array
    """⟨|u_lm|²⟩, without unit, mean over the 2l + 1 values of m and over the frames."""
    error: Array
    """Standard error of the mean, without unit."""
    correlation_time: Array
    """Integrated autocorrelation time of |u_lm|², in frames; ½ if frames are independent."""

    def interval(self, width: float = 1.96) -> Any:
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
            Bounds per l, without unit; `high` is infinite where the error is too large to give one.
        """
        # A mode that never moves has 0/0, and an interval of NaN.
        with np.errstate(divide="ignore", invalid="ignore"):
            share = width * self.error / self.mean
            high = np.where(share < 1, self.mean / np.maximum(1 - share, 0), np.inf)
        return self.mean / (1 + share), high


class MeanShape(NamedTuple):
    """The part of the modes that does not fluctuate, as `mean_shape` returns it."""

    amplitudes: Array
    """⟨u_lm⟩, without unit, shape ((lmax+1)²,)."""
    l: Array
    """Mode number, 0 … lmax."""
    share: Array
    """Σ_m ⟨u_lm⟩² / Σ_m ⟨u_lm²⟩, without unit, free of bias and so below 0 now and then."""
    error: Array
    """Standard error of the share, without unit."""


def spectrum(amplitudes: Any) -> Spectrum:
    """Fluctuation spectrum ⟨|u_lm|²⟩ per l with error bars, of one run or of several.

    The standard error is √(2 τ σ² / n): σ² is the variance of |u_lm|², n the number of
    frames times 2l + 1, because the modes of one l are equivalent on a sphere, and τ their
    integrated autocorrelation time, see `autocorrelation_time`. A run shorter than a few τ
    does not know its own τ, and its error bars are too small. Several runs are averaged with the
    numbers of their frames as weights w, and their errors added up as √(Σ w² ε²).

    The modes of one l are equivalent if the mesh has no shape of its own. A mesh that keeps its
    neighbours has a mean shape ⟨u_lm⟩, see `mean_shape`: an ordered one that of an icosahedron, at
    l = 6, the more so the harder or finer it is. Its square, which is no fluctuation, is part of
    the mean square. From one run it cannot be told from fluctuations without end, which τ and the
    error then take it for; from several it can, and the error is that of u_lm − ⟨u_lm⟩ together
    with that of ⟨u_lm⟩².

    Parameters
    ----------
    amplitudes : array_like, or sequence of array_like
        u_lm from `mode_amplitudes`, without unit, shape (num_frames, (lmax+1)²), at equal intervals
        of time; or several of these with equal lmax and interval, from independent runs of one
        vesicle.

    Returns
    -------
    Spectrum
        l, mean, error and correlation time.

    Raises
    ------
    ValueError
        Another shape, fewer than two frames in a run, or an amplitude that is not finite.
    """
    runs = _runs("spectrum", amplitudes)
    weights = _weights(runs)
    num_modes = runs[0].shape[1]
    shape, variance = _common_shape(runs, weights) if len(runs) > 1 else np.zeros((2, num_modes))
    error, time = _fluctuations(runs, weights, shape)
    modes, (mean, wandering) = _over_m(_powers(runs, weights), 4 * shape**2 * variance)
    width = 2 * modes + 1
    return Spectrum(modes, mean / width, np.sqrt(error**2 + wandering / width**2), time)


def mean_shape(runs: Any) -> MeanShape:
    """The mean shape ⟨u_lm⟩ of several runs, and its share of ⟨|u_lm|²⟩ for each l.

    ⟨u_lm⟩² is estimated without bias from the means ū_i of independent runs, as a mean over
    products of different runs, whose noise has nothing in common: (Σ w_i ū_i)² less the variance
    of that sum, which the differences between the runs tell. The error of the share s = S / (S + F)
    is √((1−s)² ε_S² + s² ε_F²) / (S + F), with S the sum over m of these squares and F of what
    fluctuates.

    Parameters
    ----------
    runs : sequence of array_like
        u_lm from `mode_amplitudes`, without unit, shape (num_frames, (lmax+1)²) each, of two or
        more independent runs of one vesicle that keep its orientation. Their weights w are the
        numbers of their frames.

    Returns
    -------
    MeanShape
        Amplitudes, l, share and its error. In a spectrum, mean · (1 − share) is what fluctuates.

    Raises
    ------
    ValueError
        Fewer than two runs, another shape, fewer than two frames in a run, or an amplitude that is
        not finite.
    """
    runs = _runs("mean_shape", runs)
    if len(runs) < 2:
        raise ValueError("mean_shape: a shape shows in two independent runs or more, got 1")
    weights = _weights(runs)
    shape, variance = _common_shape(runs, weights)
    squares = shape**2 - variance
    noise = 4 * squares.clip(min=0) * variance + 2 * variance**2 / (1 - (weights**2).sum())
    modes, (squares, noise, powers) = _over_m(squares, noise, _powers(runs, weights))
    rest = (2 * modes + 1) * _fluctuations(runs, weights, shape)[0]
    # A mode that never moves has 0/0, and a share of NaN.
    with np.errstate(divide="ignore", invalid="ignore"):
        share = squares / powers
        error = np.sqrt((1 - share) ** 2 * noise + share**2 * rest**2) / powers
    return MeanShape(shape, modes, share, error)


def mean_with_error(series: ArrayLike) -> Estimate:
    """Mean of a correlated series with its standard error, √(2 τ σ² / n).

    τ is the integrated autocorrelation time, see `autocorrelation_time`. The variance σ² is that
    about the known mean, σ²_n / (1 − 2τ/n) with σ²_n that about the mean of the series. For a
    check by a method without τ see `blocking`.

    Parameters
    ----------
    series : array_like
        Shape (n,), or (n, k) for k equivalent series, at equal intervals of time; n of 2 or more.

    Returns
    -------
    Estimate
        Mean, error, correlation time, and effective number of samples.

    Raises
    ------
    ValueError
        Another shape, fewer than two values, or a value that is not finite.
    """
    series = _series("mean_with_error", series)
    time = autocorrelation_time(series)
    samples = series.size / (2 * time)
    # With a single effective sample the variance about the mean says nothing.
    lost = min(1 / samples, 0.5)
    variance = series.var() / (1 - lost)
    return Estimate(float(series.mean()), float(np.sqrt(variance / samples)), time, float(samples))


class Blocking(NamedTuple):
    """Errors of a mean by block length, as `blocking` returns them."""

    length: Array
    """Block lengths 1, 2, 4, … in steps."""
    error: Array
    """Standard error of the mean from blocks of this length, in the unit of the series."""
    uncertainty: Array
    """Standard error of that error, error / √(2 (blocks − 1)), in the same unit."""
    best: int
    """Index of the shortest length whose blocks are long against the correlation."""

    @property
    def mean_error(self) -> float:
        """The error at the best length, in the unit of the series."""
        return float(self.error[self.best])


def blocking(series: ArrayLike) -> Blocking:
    """Standard error of a mean by blocking: neighbours are averaged in pairs, again and again.

    As soon as blocks are longer than the memory of the series they are independent, and the
    estimate √(σ² / (blocks − 1)) stops growing: Flyvbjerg and Petersen, doi:10.1063/1.457480. The
    best length B is the shortest with B³ > 2 n (ε_B / ε_1)⁴, ε the errors, see Lee et al.,
    doi:10.1103/PhysRevE.83.066706; the longest, if none is: then the run is too short for its
    error.

    Parameters
    ----------
    series : array_like
        Shape (n,), or (n, k) for k equivalent series, whose blocks are counted together; n of 2 or
        more. What is left over at the end of an odd number of blocks is dropped.

    Returns
    -------
    Blocking
        Lengths, errors, their uncertainty, and the index of the best.

    Raises
    ------
    ValueError
        Another shape, fewer than two values, or a value that is not finite.
    """
    blocks = _series("blocking", series)
    n = len(blocks)
    mean = blocks.mean()
    lengths, errors, counts = [], [], []
    length = 1
    while len(blocks) >= 2:
        count = blocks.size
        lengths.append(length)
        counts.append(count)
        errors.append(np.sqrt(np.mean((blocks - mean) ** 2) / (count - 1)))
        even = len(blocks) // 2 * 2
        blocks = (blocks[0:even:2] + blocks[1:even:2]) / 2
        length *= 2
    lengths, errors, counts = np.array(lengths), np.array(errors), np.array(counts)
    with np.errstate(divide="ignore", invalid="ignore"):
        long_enough = lengths.astype(float) ** 3 > 2 * n * (errors / errors[0]) ** 4
    best = int(np.argmax(long_enough)) if long_enough.any() else len(lengths) - 1
    return Blocking(lengths, errors, errors / np.sqrt(2 * (counts - 1)), best)


def _runs(where, amplitudes):
    """The amplitudes of one or several runs as a list of arrays (num_frames, (lmax+1)²)."""
    if isinstance(amplitudes, np.ndarray):
        several = amplitudes.ndim == 3 and len(amplitudes) > 0
    else:
        several = isinstance(amplitudes, Sequence) and any(np.ndim(run) == 2 for run in amplitudes)
    runs = [np.asarray(run, dtype=float) for run in (amplitudes if several else [amplitudes])]
    for number, run in enumerate(runs):
        name = f"amplitudes of run {number}" if several else "amplitudes"
        if run.ndim != 2 or round(run.shape[1] ** 0.5) ** 2 != run.shape[1]:
            raise ValueError(
                f"{where}: {name}: need shape (num_frames, (lmax+1)²), got {run.shape}"
            )
        if run.shape[1] != runs[0].shape[1]:
            raise ValueError(
                f"{where}: {name}: there are {run.shape[1]} modes, and {runs[0].shape[1]} in run 0"
            )
        if len(run) < 2:
            raise ValueError(
                f"{where}: {name}: an error bar needs two frames or more, got {len(run)}"
            )
        finite_array(run, where, name)
    return runs


def _weights(runs):
    """The share of each run in all frames."""
    counts = np.array([len(run) for run in runs])
    return counts / counts.sum()


def _common_shape(runs, weights):
    """The mean of each mode over all runs, and the variance of this mean."""
    means = np.array([run.mean(axis=0) for run in runs])
    shape = weights @ means
    squares = (weights**2).sum()
    return shape, weights @ (means - shape) ** 2 * squares / (1 - squares)


def _powers(runs, weights):
    """⟨u_lm²⟩ of each mode over all runs."""
    return sum(weight * (run**2).mean(axis=0) for run, weight in zip(runs, weights, strict=True))


def _over_m(*each):
    """The l of modes, and sums of the arguments over m."""
    modes = np.arange(round(len(each[0]) ** 0.5))
    return modes, [np.add.reduceat(values, modes**2) for values in each]


def _fluctuations(runs, weights, shape):
    """The error of the mean square of u_lm − shape per l, and its correlation time."""
    modes = np.arange(round(len(shape) ** 0.5))
    variance, time = np.zeros((2, len(modes)))
    for l in modes:
        of_l = slice(l**2, (l + 1) ** 2)
        for run, weight in zip(runs, weights, strict=True):
            squares = (run[:, of_l] - shape[of_l]) ** 2
            memory = autocorrelation_time(squares)
            time[l] += weight * memory
            variance[l] += weight**2 * 2 * memory * squares.var() / squares.size
    return np.sqrt(variance), time


def _series(where, series):
    """Shape (n, k) with two rows or more of finite numbers."""
    series = np.asarray(series, dtype=float)
    if series.ndim not in (1, 2) or len(series) < 2 or series.size == 0:
        raise ValueError(
            f"{where}: series needs shape (n,) or (n, k) with n ≥ 2, got {series.shape}"
        )
    return finite_array(series, where, "series").reshape(len(series), -1)
