"""Amplitudes of the modes of a nearly spherical vesicle."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._numbers import whole_number
from .._types import Array
from ._arrays import check_whole, dot, over_frames
from .elements import edges_of
from .harmonics import harmonics_of
from .solid_angles import triangle_solid_angles, vertex_solid_angles

# Harmonics of so many l above those asked for are fitted too, and take up what would else leak.
_MARGIN = 4

# Steps to the middle of the surface: some five for a vesicle near a sphere; in radii, the longest.
_MOST_STEPS = 30
_LONGEST_STEP = 0.2

# Least eigenvalue of the Gram matrix with which a fit is taken for determined; it is 1 on an even
# mesh, and 0.3 at l = 15 on a fluctuating one of 1002 vertices.
_DETERMINED = 0.02


def mode_amplitudes(
    vertices: Any, triangles: Any, lmax: int, quadrature: str = "fit", centre: Any = None
) -> Array:
    """Amplitudes u_lm of a nearly spherical vesicle, r(θ, φ) = R_V [1 + Σ u_lm Y_lm(θ, φ)].

    u_lm = ∫ (r / R_V − 1) Y_lm dΩ,   R_V = (3V / 4π)^⅓

    r is the distance from the centre. Y_lm are real and orthonormal, see `real_harmonics`. u_00 is
    the mean radius against R_V, and u_1m the way from the centre to the middle of the surface. The
    integral is taken by

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
        Shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has its own;
        counter-clockwise seen from outside, a closed surface.
    lmax : int
        Largest l, 0 or more. A mesh resolves l up to about √num_vertices / 2.
    quadrature : {"fit", "vertices", "surface"}
        How the integral is taken.
    centre : {"surface", "mass"}, optional
        The point from which r is measured. ``"surface"``, the default for the fit, is the middle of
        the surface, where u_1m = 0: translations are removed whatever the vertices do within it.
        ``"mass"``, the default for the others, is the mean of the vertices, which have equal
        masses, as in the paper. A mode l seen from a centre that is off by δ has a share of about
        l δ/R of its neighbours l ± 1, and the mean of the vertices *is* off: by a hundredth of R in
        a fluid mesh of 1002 vertices, and by 1 % of u_5m R on an icosphere of any size, since its
        vertices are denser at the twelve corners. It exists for any shape; the middle of the
        surface takes five times as long, and strongly deformed shapes may have none.

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
        volume is not positive or with a vertex at its centre of mass, or one so far from a sphere
        that it has no centre with u_1m = 0 or too few vertices in some directions for the fit.

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

    That is a statement about the vertices. In ten long runs at Ξ = 0.037 and N = 1002 their
    ⟨|u_lm|²⟩ at l = 8 is 1.17 times (A17) by the fit and 1.24 times by the sum, with standard
    errors of 0.015. The discrete energy is one reason: of a mode on an even mesh of 1002 vertices
    `BendingForce` has 0.97 of the energy of a smooth membrane for l = 4, 0.88 for l = 8 and 0.76
    for l = 12. That of the flat triangles, by ``"surface"``, is 0.9 to 1.1 times (A17) from l = 3
    to 15, because two errors cancel: flat triangles cut off about as much of the crests as the mesh
    softens short waves. Say which quadrature a spectrum was measured with.
    """
    check_whole("mode_amplitudes", vertices, triangles)
    lmax = whole_number(lmax, "mode_amplitudes", "lmax", 0)
    if quadrature not in _QUADRATURES:
        raise ValueError(f"quadrature: need one of {tuple(_QUADRATURES)}, got {quadrature!r}")
    if centre is None:
        centre = "surface" if quadrature == "fit" else "mass"
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
        _check(positions, faces, first)
        if centre == "surface":
            positions = _centred(positions, faces, integrate, lmax, first)
        return integrate(positions, faces, lmax)[0]

    # The surface has six Gauss points for each triangle, of which three are worked on at a time.
    return over_frames(work, vertices, triangles, lambda n, t: t * max(count, 30))


def _centred(positions, faces, integrate, lmax, first):
    """Positions about the point from which u_1m vanish.

    Cheaply with few harmonics first, then with those that are asked for.
    """
    for degree, tolerance in ((1, 1e-5), (max(lmax, 1), 1e-9)):
        positions, length = _without_first_modes(positions, faces, integrate, degree, tolerance)
    if not (length < tolerance).all():
        frame = np.argmin(length < tolerance)
        raise ValueError(
            f"vertices: frame {first + frame} has no centre with u_1m = 0, since it is far from a "
            "sphere; use centre='mass'"
        )
    return positions


def _without_first_modes(positions, faces, integrate, lmax, tolerance):
    """Positions moved so that u_1m vanish, and what is left of them, in radii.

    Broyden's method (doi:10.1090/S0025-5718-1965-0198670-6) on the vector from the origin to where
    u_1m puts the middle of the surface. Its derivative by the origin is −1 for a sphere.
    """
    count = len(positions)
    inverse = np.tile(-np.eye(3), (count, 1, 1))
    step = change = None
    for _ in range(_MOST_STEPS):
        amplitudes, radius = integrate(positions, faces, lmax)
        # A shift of δ adds √(4π/3) δ/R to the amplitudes of Y_1−1, Y_10 and Y_11, along y, z and x.
        middle = radius[:, np.newaxis] * np.sqrt(3 / (4 * np.pi)) * amplitudes[:, [3, 1, 2]]
        length = np.linalg.norm(middle, axis=1) / radius
        if (length < tolerance).all():
            break
        if step is not None:
            change = middle - change
            moved = np.einsum("fij,fj->fi", inverse, change)
            along = np.einsum("fi,fij->fj", step, inverse)
            below = dot(along, change)
            # Frames that have arrived move no more, and have nothing to learn from.
            with np.errstate(divide="ignore", invalid="ignore"):
                update = ((step - moved) / below[:, np.newaxis])[:, :, np.newaxis] * along[
                    :, np.newaxis
                ]
            inverse += np.where(np.isfinite(update), update, 0)
        change = middle
        step = -np.einsum("fij,fj->fi", inverse, middle)
        size = np.linalg.norm(step, axis=1) / radius
        step *= (np.minimum(size, _LONGEST_STEP) / np.where(size > 0, size, 1))[:, np.newaxis]
        step[length < tolerance] = 0
        positions = positions - step[:, np.newaxis]
    return positions, length


def _check(positions, faces, first):
    """Refuse frames whose volume is not positive, or with a vertex where it has no direction."""
    distance = np.linalg.norm(positions, axis=2)
    if not distance.all():
        frame, vertex = np.argwhere(distance == 0)[0]
        raise ValueError(
            f"vertices: vertex {vertex} of frame {first + frame} is at the centre of mass, where "
            "it has no direction"
        )
    if (edges_of(faces)[3] < 0).any():
        raise ValueError("triangles: the surface has a border; need a closed one")
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
    distance = np.linalg.norm(positions, axis=2)
    directions = positions / distance[:, :, np.newaxis]
    weights = triangle_solid_angles(directions, faces)
    # The mean is taken off first, so that rounding is that of the amplitudes; its own share is in
    # l = 0 only. r³ is fitted along, for the volume.
    mean = distance.mean(axis=1)[:, np.newaxis]
    strain = distance / mean - 1
    values = np.stack([strain, (distance / mean) ** 3 - 1], axis=2)
    degree = max(lmax, min(lmax + _MARGIN, int(num_vertices**0.5 / 2)))
    harmonics = harmonics_of(directions, degree)
    weighted = harmonics * weights[:, np.newaxis]
    gram = weighted @ harmonics.transpose(0, 2, 1)
    right = weighted @ values
    count = (lmax + 1) ** 2
    solution = np.empty((len(positions), count, 2))
    full = _determined(gram)
    solution[full] = np.linalg.solve(gram[full], right[full])[:, :count]
    # Seen from within a shape far from a sphere, vertices leave wide gaps, which the harmonics
    # beyond lmax fill with what they like. There they are left out.
    rest = ~full
    if rest.any():
        low = gram[rest][:, :count, :count]
        if not _determined(low).all():
            raise ValueError(
                f"vertices: the vertices lie too unevenly around their centre to fit modes up to "
                f"l = {lmax}, since the shape is far from a sphere; ask for fewer, or use "
                "quadrature='surface' or 'vertices'"
            )
        solution[rest] = np.linalg.solve(low, right[rest][:, :count])
    radius = np.cbrt(1 + solution[:, 0, 1] / np.sqrt(4 * np.pi))
    amplitudes = solution[:, :, 0] / radius[:, np.newaxis]
    amplitudes[:, 0] += np.sqrt(4 * np.pi) * (1 / radius - 1)
    return amplitudes, radius * mean[:, 0]


def _determined(gram):
    """Whether the least eigenvalue of each matrix is at least `_DETERMINED`."""
    shifted = gram - _DETERMINED * np.eye(gram.shape[-1])
    try:
        np.linalg.cholesky(shifted)
    except np.linalg.LinAlgError:
        return np.linalg.eigvalsh(shifted)[:, 0] > 0
    return np.ones(len(gram), dtype=bool)


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
