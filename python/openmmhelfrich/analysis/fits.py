"""Elastic constants and damping rates from measured spectra and autocorrelations."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import curve_fit, least_squares

from .._numbers import finite_array, positive_number, whole_number
from . import theory
from .correlation import autocorrelation


class ElasticFit(NamedTuple):
    """What `fit_young` finds."""

    young_over_kT: float
    """Two-dimensional Young modulus Y over kBT, 1/nm²; noise can make it negative."""
    young_error: float
    """Its standard error, 1/nm²."""
    kappa_over_kT: float
    """Bending rigidity κ over kBT, without unit, as given or as fitted."""
    kappa_error: float
    """Its standard error, without unit, 0 if it was given."""
    reduced_chi_squared: float
    """Σ of the squared deviations in error bars, over the degrees of freedom; about 1 if (A18)
    describes the spectrum. NaN without a degree of freedom."""


class DampingFit(NamedTuple):
    """What `fit_damping` finds."""

    friction: float
    """Damping rate γ, 1/ps."""
    friction_error: float
    """Its standard error, 1/ps."""
    frequency: float
    """Angular frequency ω of the undamped mode, rad/ps, as given or as fitted."""
    frequency_error: float
    """Its standard error, rad/ps, 0 if it was given."""


def fit_young(
    spectrum: Any,
    radius: float,
    kappa_over_kT: float | None = None,
    lmin: int = 2,
    lmax: int | None = None,
) -> ElasticFit:
    """Young modulus of a vesicle from its spectrum, by (A18).

    ln ⟨|u_lm|²⟩ = −ln [κ (l+2)(l+1) l (l−1) + Y r0² · 3 (l² + l − 2) / (3 (l² + l) − 2)]

    (kBT = 1) is fitted to l = lmin … lmax, weighted with the relative errors of the spectrum: what
    a run fixes is the relative error of a mean square. Errors are those of a linearised fit.

    Parameters
    ----------
    spectrum : Spectrum
        From `analysis.spectrum`, with positive means and errors in the range.
    radius : float
        r0, nm.
    kappa_over_kT : float, optional
        κ over kBT, without unit. Default: fitted along.
    lmin, lmax : int, optional
        Range of the fit, 2 or more. Default: all from 2. Modes above about √N / 2 are not those of
        a continuum.

    Returns
    -------
    ElasticFit
        Y and κ with errors, and how good the fit is.

    Raises
    ------
    ValueError
        Fewer modes than constants, a mean or an error that is not positive, or a number out of
        range.
    RuntimeError
        The fit does not converge.
    """
    radius = positive_number(radius, "fit_young", "radius")
    if kappa_over_kT is not None:
        kappa_over_kT = positive_number(kappa_over_kT, "fit_young", "kappa_over_kT")
    lmin = whole_number(lmin, "fit_young", "lmin", 2)
    l = np.asarray(spectrum.l)
    lmax = l.max() if lmax is None else whole_number(lmax, "fit_young", "lmax", lmin)
    chosen = (l >= lmin) & (l <= lmax)
    l, mean, error = l[chosen], spectrum.mean[chosen], spectrum.error[chosen]
    constants = 1 if kappa_over_kT is not None else 2
    if len(l) < constants:
        raise ValueError(f"spectrum: {len(l)} modes in the range do not fix {constants} constants")
    if not ((mean > 0) & (error > 0)).all():
        bad = l[~((mean > 0) & (error > 0))][0]
        raise ValueError(f"spectrum: the mean and the error of l = {bad} must be positive")

    bending = theory.stiffness(l)
    n = l * (l + 1.0)
    shear = 3 * (n - 2) / (3 * n - 2)
    relative = error / mean
    # The linear problem 1/⟨|u|²⟩ = κ s + Y r0² g gives the start.
    scale = 1 / (relative / mean)
    if constants == 1:
        rest = (1 / mean - kappa_over_kT * bending) * scale
        start = [shear * scale @ rest / np.sum((shear * scale) ** 2)]
        floor = -kappa_over_kT * np.min(bending / shear)
        start = [max(start[0], floor / 2)]

        def model(_, modulus):
            return -np.log(kappa_over_kT * bending + modulus * shear)

        bounds = ([floor * (1 - 1e-9)], [np.inf])
    else:
        columns = np.stack([bending, shear], axis=1)
        first = np.linalg.lstsq(columns * scale[:, None], scale / mean, rcond=None)[0]
        kappa = max(first[0], 1e-3 / np.median(mean * bending))
        # In terms of κ and Y r0² / κ the stiffness stays positive within fixed bounds.
        floor = -np.min(bending / shear)
        start = [np.log(kappa), max(first[1] / kappa, floor / 2)]

        def model(_, log_kappa, ratio):
            return -log_kappa - np.log(bending + ratio * shear)

        bounds = ([-np.inf, floor * (1 - 1e-9)], [np.inf, np.inf])
    found, covariance = curve_fit(
        model,
        l,
        np.log(mean),
        p0=start,
        sigma=relative,
        absolute_sigma=True,
        bounds=bounds,
        x_scale=[1.0] * (constants - 1) + [max(abs(start[-1]), 1.0)],
    )
    deviations = (np.log(mean) - model(l, *found)) / relative
    freedom = len(l) - constants
    quality = float(deviations @ deviations / freedom) if freedom else float("nan")
    if constants == 1:
        modulus, modulus_error = found[0], np.sqrt(covariance[0, 0])
        kappa, kappa_error = kappa_over_kT, 0.0
    else:
        kappa = np.exp(found[0])
        kappa_error = kappa * np.sqrt(covariance[0, 0])
        modulus = kappa * found[1]
        gradient = np.array([modulus, kappa])
        modulus_error = np.sqrt(gradient @ covariance @ gradient)
    area = radius**2
    return ElasticFit(
        float(modulus / area),
        float(modulus_error / area),
        float(kappa),
        float(kappa_error),
        quality,
    )


def fit_damping(
    series: ArrayLike, interval: float, lags: int | None = None, frequency: float | None = None
) -> DampingFit:
    """Damping rate γ and frequency ω of a mode from its autocorrelation function.

    `theory.langevin_autocorrelation` (A35–A37) is fitted to the unbiased autocorrelation, averaged
    over equivalent series. Errors are those of a jackknife that leaves out one series at a time, so
    they know about everything in which the series differ; a single series is cut in eight parts
    instead, whose autocorrelations are compared. Where γ ≫ 2ω the function depends on ω²/γ alone:
    then give the frequency.

    Parameters
    ----------
    series : array_like
        Shape (n,), or (n, k) for k equivalent series, such as ``amplitudes[:, l**2 : (l + 1)**2]``,
        of zero mean, at equal intervals of time.
    interval : float
        Time between frames, ps.
    lags : int, optional
        Lags that are fitted, 0 … lags − 1: 3 or more, or 2 if the frequency is given, since lag 0
        is 1 by definition. Default: n // 10, at least 10. Take one or two memories: what follows
        is noise.
    frequency : float, optional
        ω, rad/ps, if it is known. Default: fitted along.

    Returns
    -------
    DampingFit
        γ and ω with errors.

    Raises
    ------
    ValueError
        Too few frames, a value that is not finite, or a number out of range.
    RuntimeError
        The fit does not converge, or the mode is too overdamped to tell γ without the frequency.
    """
    series = np.asarray(series, dtype=float)
    if series.ndim not in (1, 2) or len(series) < 4:
        raise ValueError(
            f"fit_damping: series needs shape (n,) or (n, k) with n ≥ 4, got {series.shape}"
        )
    finite_array(series, "fit_damping", "series")
    interval = positive_number(interval, "fit_damping", "interval")
    if frequency is not None:
        frequency = positive_number(frequency, "fit_damping", "frequency")
    n = len(series)
    if lags is None:
        lags = min(n, max(10, n // 10))
    # Each rate takes a lag beyond the first, at which all curves are 1.
    lags = whole_number(lags, "fit_damping", "lags", 3 if frequency is None else 2, n)
    if series.ndim == 1 or series.shape[1] == 1:
        length = len(series) // 8
        if length < lags:
            raise ValueError(
                f"fit_damping: one series of {len(series)} frames has no eight parts of {lags} "
                "lags for an error; take fewer lags, or several equivalent series"
            )
        series = series.reshape(-1)[: 8 * length].reshape(8, length).T
    functions = autocorrelation(series, lags, normalise=False)
    if not (functions[0] > 0).all():
        raise ValueError(f"fit_damping: series {np.argmin(functions[0])} is zero throughout")
    times = interval * np.arange(lags)
    total = functions.sum(axis=1)
    best = _damped(times, total / total[0], frequency)
    count = functions.shape[1]
    without = np.array(
        [
            _damped(times, part / part[0], frequency, best)
            for part in (total[:, np.newaxis] - functions).T
        ]
    )
    error = np.sqrt((count - 1) * without.var(axis=0))
    overdamped = best[0] > 2 * best[1]
    if frequency is None and overdamped and not error[0] < best[0]:
        # The curve is an exponential for all that can be seen, which has one rate and not two.
        raise RuntimeError(
            "fit_damping: the mode is overdamped, and of its two rates only "
            f"ω²/γ = {best[1] ** 2 / best[0]:.4g} /ps can be told from its autocorrelation; "
            "give the frequency"
        )
    return DampingFit(float(best[0]), float(error[0]), float(best[1]), float(error[1]))


def _damped(times, correlation, frequency, start=None):
    """γ and ω that describe an autocorrelation function best, ω fixed if it is given."""
    if start is None:
        # The scale of time is unknown over decades, so a coarse search comes before the fit.
        trial = np.pi / times[-1] * np.geomspace(0.02, len(times), 60)
        ratios = np.geomspace(0.01, 100, 25)
        omega, ratio = np.meshgrid(trial if frequency is None else [frequency], ratios)
        omega, gamma = omega.ravel(), (omega * ratio).ravel()
        curves = theory.langevin_autocorrelation(
            times[:, np.newaxis], omega[np.newaxis], gamma[np.newaxis]
        )
        place = np.argmin(((curves - correlation[:, np.newaxis]) ** 2).sum(axis=0))
        start = gamma[place], omega[place]

    def unpack(logarithms):
        gamma = np.exp(logarithms[0])
        return gamma, np.exp(logarithms[1]) if frequency is None else frequency

    def deviation(logarithms):
        gamma, omega = unpack(logarithms)
        return theory.langevin_autocorrelation(times, omega, gamma) - correlation

    found = least_squares(
        deviation, np.log(start if frequency is None else start[:1]), method="trf", max_nfev=500
    )
    if not found.success:
        raise RuntimeError(f"fit_damping: the fit does not converge ({found.message})")
    return unpack(found.x)
