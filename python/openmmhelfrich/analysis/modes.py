"""Amplitudes of the modes of a nearly spherical vesicle."""

import numpy as np

from ._arrays import dot, over_frames
from .harmonics import count_of, harmonics_of
from .solid_angles import triangle_solid_angles, vertex_solid_angles

# Harmonics of so many l above those asked for are fitted too, and take up what would else leak.
_MARGIN = 4

# The way to the centre of the surface gets shorter by about u_lm² a step.
_MOST_STEPS = 50
_CENTRED = 1e-12


def mode_amplitudes(vertices, triangles, lmax, quadrature="fit", centre="mass"):
    """Amplitudes u_lm of a nearly spherical vesicle, r(θ, φ) = R_V [1 + Σ u_lm Y_lm(θ, φ)].

    u_lm = ∫ (r / R_V − 1) Y_lm dΩ,   R_V = (3V / 4π)^⅓

    r is the distance from the centre of mass, **the mean of all vertices, which have equal
    masses**. Y_lm are real and orthonormal, see `real_harmonics`. u_00 is the mean radius against
    R_V, and u_1m the way from the centre to the middle of the surface. The integral is taken by

    ``"fit"``
        least squares: the amplitudes that minimise Σ_i w_i [r_i/R_V − 1 − Σ u_lm Y_lm(θ_i, φ_i)]²,
        w_i a third of the solid angle of the triangles around vertex i. In terms of the sum over
        vertices b = Σ_i w_i (r_i/R_V − 1) Y_lm this solves G u = b with the Gram matrix G of the
        harmonics on the vertices: G is not the identity where they are uneven. The fit runs to
        min(lmax + 4, √N/2), but at least to lmax. Shapes made of harmonics in that range come back
        to rounding, on any mesh; the power of an l does not depend on rotation. V is that of the
        same fit, ∫ r³ dΩ / 3.
    ``"vertices"``
        the paper's sum, doi:10.1103/PhysRevE.108.015301: b with the Voronoi cells on the unit
        sphere as weights, see `solid_angles`. V is that of the flat triangles, which at N = 1002
        enclose 0.55 % less than the smooth surface, so that all amplitudes are 0.18 % larger.
    ``"surface"``
        six Gauss points on every flat triangle: the integral over the triangulated surface. Of a
        smooth shape it misses what flat triangles cut off, the share
        l (l+1) ⟨a² + b² + c²⟩ / 48 R_V² of the amplitude, a, b and c the sides of the triangles.
        V as for ``"vertices"``.

    Parameters
    ----------
    vertices : array_like, Quantity, Mesh, State, Context, Simulation, Trajectory or path
        Shape (num_vertices, 3) for one frame or (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh
        Shape (num_triangles, 3), counter-clockwise seen from outside, a closed surface.
    lmax : int
        Largest l, 0 or more. A mesh resolves l up to about √num_vertices / 2.
    quadrature : {"fit", "vertices", "surface"}
        How the integral is taken.
    centre : {"mass", "surface"}
        The point from which r is measured: the mean of the vertices, or the point from which
        u_1m = 0, which does not depend on how the vertices lie within the surface. In a fluid mesh
        they drift: at N = 1002 their mean is some 1 % of the radius off the middle, and a mode l
        seen from a centre that is off by δ has a share of about l δ/R of its neighbours l ± 1.

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
        A wrong shape, an index out of range, a coordinate that is not finite, a negative lmax, one
        with more harmonics than vertices for the fit, another quadrature or centre, a mesh whose
        volume is not positive, or one so far from a sphere that no centre has u_1m = 0.

    Notes
    -----
    Bias on fluctuating meshes. In a fluid mesh at work (Ξ = 0.037, N = 1002) vertices are uneven.
    For known thermal amplitudes put on such vertices, what comes out of ⟨|u_lm|²⟩ is

    ========== ===== ===== ===== ===== =====
    quadrature l = 2     4     6     8    12
    ========== ===== ===== ===== ===== =====
    fit         1.00  1.00  1.00  1.01  1.06
    vertices    1.00  1.00  1.03  1.1    2.1
    surface     0.97  0.93  0.85  0.80  0.65
    ========== ===== ===== ===== ===== =====

    The paper's sum picks up the large amplitudes of small l in those of large l; flat triangles cut
    off crests; and modes above the range of the fit leak into its last few.

    That is a statement about the vertices. In a simulation their amplitudes are larger than theory
    has it, since a mesh resists bending less than a smooth membrane: of a mode l on an even mesh of
    1002 vertices `BendingForce` has 0.97 of the energy for l = 4, 0.88 for l = 8 and 0.76 for
    l = 12. The flat triangles, whose bending that energy is, have amplitudes smaller by about the
    same share, so that ``"surface"`` is the closest to (A17) there: 0.9 to 1.0 up to l = 15 at
    Ξ = 0.037, where ``"fit"`` has 1.3 at l = 8.
    """
    lmax = count_of("lmax", lmax)
    if quadrature not in _QUADRATURES:
        raise ValueError(f"quadrature: need one of {tuple(_QUADRATURES)}, got {quadrature!r}")
    if centre not in ("mass", "surface"):
        raise ValueError(f"centre: need 'mass' or 'surface', got {centre!r}")
    integrate = _QUADRATURES[quadrature]
    count = (lmax + 1) ** 2

    def work(frames, faces, first):
        if quadrature == "fit" and count > frames.shape[1]:
            raise ValueError(
                f"lmax: {lmax} has {count} harmonics, but there are {frames.shape[1]} vertices to "
                "fit them to; ask for fewer"
            )
        positions = frames - frames.mean(axis=1, keepdims=True)
        _check_volume(positions, faces, first)
        if centre == "surface":
            positions = _centred(positions, faces, integrate, first)
        return integrate(positions, faces, lmax)[0]

    # The surface has six Gauss points for each triangle, of which three are worked on at a time.
    return over_frames(work, vertices, triangles, lambda n, t: t * max(count, 30))


def _centred(positions, faces, integrate, first):
    """Positions about the point from which u_1m vanish."""
    for _ in range(_MOST_STEPS):
        amplitudes, radius = integrate(positions, faces, 1)
        # A shift of δ adds √(4π/3) δ/R to the amplitudes of Y_1−1, Y_10 and Y_11, along y, z and x.
        shift = radius[:, np.newaxis] * np.sqrt(3 / (4 * np.pi)) * amplitudes[:, [3, 1, 2]]
        positions = positions - shift[:, np.newaxis]
        length = np.linalg.norm(shift, axis=1) / radius
        if (length < _CENTRED).all():
            return positions
    frame = np.argmax(length)
    raise ValueError(
        f"vertices: frame {first + frame} has no centre with u_1m = 0, since it is far from a "
        "sphere; use centre='mass'"
    )


def _check_volume(positions, faces, first):
    volume = _volume(positions, faces)
    if not (volume > 0).all():
        frame = np.flatnonzero(~(volume > 0))[0]
        raise ValueError(
            f"vertices: the volume of frame {first + frame} is {volume[frame]} nm³; need a "
            "closed surface with triangles counter-clockwise seen from outside"
        )


def _volume(positions, faces):
    """Volume within the flat triangles, shape (num_frames,), nm³."""
    a, b, c = (positions[:, faces[:, corner]] for corner in range(3))
    return dot(a, np.cross(b, c)).sum(axis=1) / 6


def _fit(positions, faces, lmax):
    """Weighted least squares; returns u_lm and R_V."""
    num_vertices = positions.shape[1]
    degree = max(lmax, min(lmax + _MARGIN, int(num_vertices**0.5 / 2)))
    distance = np.linalg.norm(positions, axis=2)
    directions = positions / distance[:, :, np.newaxis]
    weights = triangle_solid_angles(directions, faces)
    harmonics = harmonics_of(directions, degree)
    weighted = harmonics * weights[:, np.newaxis]
    gram = weighted @ harmonics.transpose(0, 2, 1)
    # The mean is taken off first, so that rounding is that of the amplitudes; its own share is in
    # l = 0 only. r³ is fitted along, for the volume.
    mean = distance.mean(axis=1)[:, np.newaxis]
    strain = distance / mean - 1
    values = np.stack([strain, (distance / mean) ** 3 - 1], axis=2)
    solution = np.linalg.solve(gram, weighted @ values)
    radius = np.cbrt(1 + solution[:, 0, 1] / np.sqrt(4 * np.pi))
    amplitudes = solution[:, : (lmax + 1) ** 2, 0] / radius[:, np.newaxis]
    amplitudes[:, 0] += np.sqrt(4 * np.pi) * (1 / radius - 1)
    return amplitudes, radius * mean[:, 0]


def _sum(nodes):
    """A quadrature that sums over the points and weights which `nodes` yields."""

    def integrate(positions, faces, lmax):
        radius = np.cbrt(3 * _volume(positions, faces) / (4 * np.pi))
        # A constant has no share in modes above l = 0. Taken off before the sum it cannot leak into
        # them either.
        mean = np.linalg.norm(positions, axis=2).mean(axis=1) / radius
        amplitudes = np.zeros((len(positions), (lmax + 1) ** 2))
        amplitudes[:, 0] = np.sqrt(4 * np.pi) * (mean - 1)
        for points, weights in nodes(positions, faces):
            distance = np.linalg.norm(points, axis=2)
            harmonics = harmonics_of(points / distance[:, :, np.newaxis], lmax)
            integrand = weights * (distance / radius[:, np.newaxis] - mean[:, np.newaxis])
            amplitudes += np.einsum("fn,fkn->fk", integrand, harmonics)
        return amplitudes, radius

    return integrate


def _vertex_nodes(positions, faces):
    """The vertices with their solid angles."""
    directions = positions / np.linalg.norm(positions, axis=2, keepdims=True)
    yield positions, vertex_solid_angles(directions, faces)


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

_QUADRATURES = {"fit": _fit, "vertices": _sum(_vertex_nodes), "surface": _sum(_surface_nodes)}
