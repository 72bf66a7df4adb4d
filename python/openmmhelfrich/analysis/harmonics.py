"""Fluctuations of a nearly spherical vesicle in real spherical harmonics."""

import numpy as np

from ._arrays import dot, frames_of, gather_sum, triangles_of

# Frames are worked on in chunks whose harmonics take about this many numbers, which bounds the
# memory and stays close to the processor.
_CHUNK = 1 << 20


def mode_amplitudes(vertices, triangles, lmax, quadrature="vertices"):
    """Amplitudes u_lm of a nearly spherical vesicle, r(θ, φ) = R_V [1 + Σ u_lm Y_lm(θ, φ)].

    u_lm = ∫ (r / R_V − 1) Y_lm dΩ ≈ Σ_i Ω_i (r_i / R_V − 1) Y_lm(θ_i, φ_i),   R_V = (3V / 4π)^⅓

    r is the distance from the centre of mass, **the mean of all vertices, which have equal
    masses**. Y_lm are real and orthonormal, see `real_harmonics`. The sum runs over

    ``"vertices"``
        with their Voronoi cells on the unit sphere as solid angles Ω_i, see `solid_angles`: the
        definition of the paper's code, doi:10.1103/PhysRevE.108.015301. It gets smooth shapes on
        even meshes right: up to l = 6 at 1002 vertices within 0.1 % of the largest amplitude on a
        random mesh, within 0.6 % on an icosphere. A fluid mesh at work is uneven, and what large
        modes leave over there leaks into small ones: at Ξ = 0.037 and N = 1002, ⟨|u_lm|²⟩ of
        l = 8 comes out a third larger than with ``"surface"``, for l = 15 eight times.
    ``"surface"``
        six Gauss points on every flat triangle: the integral over the triangulated surface itself,
        however uneven. Of a smooth shape it misses what flat triangles cut off, the share
        l (l+1) ⟨a² + b² + c²⟩ / 48 R_V² of the amplitude, a, b and c the sides of the triangles:
        0.7 % for l = 2 and 4 % for l = 6 at 1002 vertices. It takes seven times as long.

    R_V is that of the flat triangles, which at N = 1002 enclose 0.55 % less than the smooth surface
    through the vertices, so that all amplitudes are 0.18 % larger. u_00 is the mean radius
    against R_V, and u_1m the way from the centre of mass to the middle of the surface.

    Parameters
    ----------
    vertices : array_like or Quantity
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int
        Shape (num_triangles, 3), counter-clockwise seen from outside, a closed surface.
    lmax : int
        Largest l, 0 or more. A mesh resolves l up to about √num_vertices / 2.
    quadrature : {"vertices", "surface"}
        Where the integrand is evaluated.

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
        A wrong shape, an index out of range, a coordinate that is not finite, a negative lmax,
        another quadrature, or a mesh whose volume is not positive.
    """
    lmax = _count("lmax", lmax)
    if quadrature not in _NODES:
        raise ValueError(f"quadrature: need one of {tuple(_NODES)}, got {quadrature!r}")
    frames, single = frames_of(vertices)
    num_frames, num_vertices, _ = frames.shape
    faces = triangles_of(triangles, num_vertices)
    amplitudes = np.zeros((num_frames, (lmax + 1) ** 2))
    chunk = max(1, _CHUNK // (len(faces) * (lmax + 1) ** 2))
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
        radius = np.cbrt(3 * volume / (4 * np.pi))[:, np.newaxis]
        # A constant has no share in modes above l = 0. Taken off before the sum it cannot leak into
        # them either.
        mean = np.linalg.norm(positions, axis=2).mean(axis=1, keepdims=True) / radius
        result = amplitudes[first : first + chunk]
        result[:, :1] = np.sqrt(4 * np.pi) * (mean - 1)
        for points, weights in _NODES[quadrature](positions, faces):
            distance = np.linalg.norm(points, axis=2)
            harmonics = _harmonics(points / distance[:, :, np.newaxis], lmax)
            integrand = weights * (distance / radius - mean)
            result += np.einsum("fn,fkn->fk", integrand, harmonics)
    return amplitudes[0] if single else amplitudes


def _vertex_nodes(positions, faces):
    """The vertices with their solid angles."""
    directions = positions / np.linalg.norm(positions, axis=2, keepdims=True)
    yield positions, _solid_angles(directions, faces)


def _surface_nodes(positions, faces):
    """Gauss points on the flat triangles, weighted with solid angle, dΩ = r·dA / |r|³."""
    a, b, c = (positions[:, faces[:, corner]] for corner in range(3))
    half = np.cross(b - a, c - a) / 2
    for weight, near in _GAUSS:
        far = 1 - 2 * near
        for p, q, r in ((a, b, c), (b, c, a), (c, a, b)):
            points = far * p + near * (q + r)
            yield points, weight * dot(points, half) / np.linalg.norm(points, axis=2) ** 3


# The symmetric rule of six points that is exact for polynomials of degree 4: weight, and the
# coordinate that two of the corners share (Dunavant, doi:10.1002/nme.1620210612).
_GAUSS = ((0.223381589678011, 0.445948490915965), (0.109951743655322, 0.091576213509771))

_NODES = {"vertices": _vertex_nodes, "surface": _surface_nodes}


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
