"""Fluctuations of a nearly spherical vesicle in real spherical harmonics."""

# ruff: noqa: E741 - l is the mode number, as in every source.

from typing import NamedTuple

import numpy as np

from ._arrays import dot, frames_of, gather_sum, triangles_of

# Frames are worked on in chunks whose harmonics take about this many numbers, which bounds the
# memory and stays close to the processor.
_CHUNK = 1 << 20


def mode_amplitudes(vertices, triangles, lmax, refinements=1):
    """Amplitudes u_lm of a nearly spherical vesicle, r(θ, φ) = R_V [1 + Σ u_lm Y_lm(θ, φ)].

    u_lm = Σ_i Ω_i (r_i / R_V − 1) Y_lm(θ_i, φ_i),   R_V = (3V / 4π)^⅓

    r_i is the distance of vertex i from the centre of mass, **the mean of all vertices, which
    have equal masses**; Ω_i is its solid angle, see `solid_angles`; Y_lm are real and orthonormal,
    see `real_harmonics`. The definition is that of the code of the paper,
    doi:10.1103/PhysRevE.108.015301.

    The sum over vertices is no exact integral: the harmonics are orthonormal to 2e-4 on a random
    mesh of 1002 vertices and to 5e-3 on an icosphere, up to l = 6. So by default the sum is
    applied once more to what it left, u ← u + Σ_i Ω_i [r_i / R_V − 1 − Σ u_l'm' Y_l'm'(i)] Y_lm(i),
    which squares this error for all modes up to lmax. `refinements=0` is the paper's plain sum.

    R_V comes from the mesh, whose flat triangles enclose less than the smooth surface through its
    vertices: 0.55 % at N = 1002, which makes all amplitudes 0.18 % larger. u_00 is the mean radius
    against R_V, and u_1m the way from the centre of mass to the middle of the surface.

    Parameters
    ----------
    vertices : array_like or Quantity
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int
        Shape (num_triangles, 3), counter-clockwise seen from outside, a closed surface.
    lmax : int
        Largest l, 0 or more. A mesh resolves l up to about √num_vertices / 2.
    refinements : int
        How often the sum is applied to its own residual. Default 1.

    Returns
    -------
    ndarray
        u_lm at index l² + l + m, without unit, shape ((lmax+1)²,) for one frame or
        (num_frames, (lmax+1)²).

    Raises
    ------
    TypeError
        A Quantity that is no length, or indices that are no integers.
    ValueError
        A wrong shape, an index out of range, a coordinate that is not finite, a negative lmax, or
        a mesh whose volume is not positive.
    """
    lmax = _count("lmax", lmax)
    refinements = _count("refinements", refinements)
    frames, single = frames_of(vertices)
    num_frames, num_vertices, _ = frames.shape
    faces = triangles_of(triangles, num_vertices)
    amplitudes = np.empty((num_frames, (lmax + 1) ** 2))
    chunk = max(1, _CHUNK // (num_vertices * (lmax + 1) ** 2))
    for first in range(0, num_frames, chunk):
        positions = frames[first : first + chunk]
        positions = positions - positions.mean(axis=1, keepdims=True)
        a, b, c = (positions[:, faces[:, corner]] for corner in range(3))
        volume = dot(a, np.cross(b, c)).sum(axis=1) / 6
        if not (volume > 0).all():
            frame = np.flatnonzero(~(volume > 0))[0]
            raise ValueError(
                f"vertices: the volume of frame {first + frame} is {volume[frame]} nm³; need a "
                "closed surface with triangles counter-clockwise seen from outside"
            )
        radius = np.cbrt(3 * volume / (4 * np.pi))
        distance = np.linalg.norm(positions, axis=2)
        directions = positions / distance[:, :, np.newaxis]
        weights = _solid_angles(directions, faces)[:, np.newaxis]
        harmonics = _harmonics(directions, lmax)
        residual = (distance / radius[:, np.newaxis] - 1)[:, np.newaxis]
        modes = np.zeros((len(positions), 1, (lmax + 1) ** 2))
        for _ in range(1 + refinements):
            change = (weights * residual) @ harmonics.transpose(0, 2, 1)
            modes += change
            residual = residual - change @ harmonics
        amplitudes[first : first + chunk] = modes[:, 0]
    return amplitudes[0] if single else amplitudes


def solid_angles(vertices, triangles):
    """Solid angle Ω_i of every vertex: its Voronoi cell after projection to the unit sphere.

    The vertices are projected from the origin. Every spherical triangle is divided among its
    corners by the great circles from its circumcentre to the middles of its sides; parts of
    an obtuse or inverted triangle count with their sign, so that Σ Ω_i = 4π exactly if the origin
    is inside of the surface.

    Parameters
    ----------
    vertices : array_like
        Shape (num_vertices, 3) or (num_frames, num_vertices, 3), from the centre of projection.
    triangles : array_like of int
        Shape (num_triangles, 3), counter-clockwise seen from outside.

    Returns
    -------
    ndarray
        Ω, shape (num_vertices,) or (num_frames, num_vertices), steradian.
    """
    frames, single = frames_of(vertices)
    faces = triangles_of(triangles, frames.shape[1])
    directions = frames / np.linalg.norm(frames, axis=2, keepdims=True)
    angles = _solid_angles(directions, faces)
    return angles[0] if single else angles


def _solid_angles(directions, faces):
    """`solid_angles` of unit vectors, shape (num_frames, num_vertices, 3)."""
    corners = [directions[:, faces[:, corner]] for corner in range(3)]
    a, b, c = corners
    # The circumcentre lies along the normal of the plane triangle. That vector is right for
    # inverted triangles too: it points inward, and the signed areas then come out negative.
    centre = np.cross(b - a, c - a)
    shares = np.zeros((*a.shape[:2], 3))
    for corner in range(3):
        following = (corner + 1) % 3
        middle = corners[corner] + corners[following]
        # The halves of a side are mirror images, so one triangle serves both of its ends.
        half = _signed_solid_angle(corners[corner], middle, centre)
        shares[:, :, corner] += half
        shares[:, :, following] += half
    return gather_sum(shares.reshape(len(shares), -1), faces.ravel(), directions.shape[1])


def _signed_solid_angle(a, b, c):
    """Solid angle of the triangle a, b, c seen from the origin, positive if counter-clockwise.

    tan(Ω/2) = a·(b×c) / (abc + (a·b)c + (b·c)a + (c·a)b), Van Oosterom and Strackee,
    doi:10.1109/TBME.1983.325207. The vectors need not be unit vectors.
    """
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return 2 * np.arctan2(dot(a, np.cross(b, c)), below)


def real_harmonics(directions, lmax):
    """Real orthonormal spherical harmonics, ∫ Y_lm Y_l'm' dΩ = δ_ll' δ_mm'.

    Y_lm = √2 N P_l^m(cos θ) cos mφ for m > 0, N P_l(cos θ) for m = 0 and √2 N P_l^|m|(cos θ)
    sin |m|φ for m < 0, without the Condon–Shortley phase: Y_1−1, Y_10 and Y_11 are
    √(3/4π) times y, z and x.

    Parameters
    ----------
    directions : array_like
        Unit vectors, shape (…, 3).
    lmax : int
        Largest l.

    Returns
    -------
    ndarray
        Shape (…, (lmax+1)²), index l² + l + m.
    """
    directions = np.asarray(directions, dtype=float)
    harmonics = _harmonics(directions[np.newaxis], _count("lmax", lmax))[0]
    return np.moveaxis(harmonics, 0, -1)


def _harmonics(directions, lmax):
    """Y_lm for unit vectors of shape (num_frames, …, 3), shape (num_frames, (lmax+1)², …).

    The Legendre functions are divided by sin^m θ, which leaves polynomials of z that a stable
    recurrence in l gives; the powers of x + iy carry sin^m θ cos mφ and sin^m θ sin mφ. No
    trigonometric function is called and the poles are points like others.
    """
    x, y, z = np.moveaxis(directions, -1, 0)
    result = np.empty((len(x), (lmax + 1) ** 2, *x.shape[1:]))
    cosine, sine = np.ones_like(x), np.zeros_like(x)
    diagonal = np.sqrt(1 / (4 * np.pi))
    for m in range(lmax + 1):
        if m > 0:
            cosine, sine = x * cosine - y * sine, x * sine + y * cosine
            diagonal *= np.sqrt((2 * m + 1) / (2 * m))
        before, legendre = 0, np.full_like(x, diagonal)
        for l in range(m, lmax + 1):
            if l > m:
                a = np.sqrt((4 * l**2 - 1) / (l**2 - m**2))
                b = np.sqrt(((l - 1) ** 2 - m**2) / (4 * (l - 1) ** 2 - 1))
                before, legendre = legendre, (a * z) * legendre - (a * b) * before
            if m == 0:
                result[:, l * l + l] = legendre
            else:
                result[:, l * l + l + m] = np.sqrt(2) * legendre * cosine
                result[:, l * l + l - m] = np.sqrt(2) * legendre * sine
    return result


def _count(name, value):
    """A checked integer of 0 or more."""
    if int(value) != value or value < 0:
        raise ValueError(f"{name}: need an integer of 0 or more, got {value}")
    return int(value)


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
