"""Harmonics, spectra, theory and curvature against shapes and numbers known beforehand."""

import numpy as np
import pytest
from openmm import unit
from openmmhelfrich import analysis
from openmmhelfrich.analysis import theory
from openmmhelfrich.mesh import Mesh
from scipy.special import sph_harm_y

LMAX = 6


@pytest.fixture(scope="module", params=["ordered", "random"])
def sphere(request):
    """A sphere of 1002 vertices; its cells vary by a factor of 1.8 if ordered, 1.3 if random."""
    if request.param == "ordered":
        return Mesh.icosphere(10, 1000)
    return Mesh.random_sphere(1002, 1000, seed=3)


def directions_of(mesh):
    return mesh.vertices / np.linalg.norm(mesh.vertices, axis=1)[:, None]


def shape(mesh, amplitudes):
    """Vertices moved along their radii to r (1 + Σ u_lm Y_lm)."""
    lmax = round(len(amplitudes) ** 0.5) - 1
    harmonics = analysis.real_harmonics(directions_of(mesh), lmax)
    return mesh.vertices * (1 + harmonics @ amplitudes)[:, None]


def volume_radius(vertices, triangles):
    a, b, c = vertices[triangles.T]
    return np.cbrt(np.einsum("ti,ti->", a, np.cross(b, c)) / 6 * 3 / (4 * np.pi))


def uneven(mesh):
    """The mesh with its vertices moved along the surface, at random, by a third of an edge."""
    noise = np.random.default_rng(9).normal(size=mesh.vertices.shape)
    step = 0.1 * np.sqrt(mesh.area / mesh.num_vertices)
    moved = mesh.vertices + step * noise
    length = np.linalg.norm(mesh.vertices, axis=1) / np.linalg.norm(moved, axis=1)
    return Mesh(moved * length[:, None], mesh.triangles)


def cut_in_four(mesh):
    """The same surface with a vertex in the middle of every edge."""
    middle = {tuple(edge): mesh.num_vertices + i for i, edge in enumerate(mesh.edges)}
    vertices = np.concatenate([mesh.vertices, mesh.vertices[mesh.edges].mean(axis=1)])
    triangles = []
    for a, b, c in mesh.triangles:
        ab, bc, ca = (middle[tuple(sorted(pair))] for pair in ((a, b), (b, c), (c, a)))
        triangles += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return Mesh(vertices, triangles)


class TestHarmonics:
    def test_are_scipys_complex_ones_made_real(self):
        points = np.random.default_rng(0).normal(size=(50, 3))
        points /= np.linalg.norm(points, axis=1)[:, None]
        theta = np.arccos(points[:, 2])
        phi = np.arctan2(points[:, 1], points[:, 0])
        ours = analysis.real_harmonics(points, 9)
        for l in range(10):
            for m in range(-l, l + 1):
                y = sph_harm_y(l, abs(m), theta, phi)
                # (−1)^m takes scipy's Condon–Shortley phase out again.
                want = y.real if m == 0 else np.sqrt(2) * (-1) ** m * (y.real if m > 0 else y.imag)
                np.testing.assert_allclose(ours[:, l * l + l + m], want, atol=1e-13)

    def test_first_ones_point_along_the_axes(self):
        y = analysis.real_harmonics(np.eye(3), 1)
        expected = np.sqrt(3 / (4 * np.pi)) * np.eye(3)
        np.testing.assert_allclose(y[:, [3, 1, 2]], expected, atol=1e-15)

    @pytest.mark.parametrize(
        ("directions", "message"),
        [
            ([[0, 0, 1.0], [0, 0, 2]], r"directions\[1\] has the length 2"),
            ([0, 0, 1.1], "directions has the length 1.1"),
            ([0, 1.0], r"need shape \(…, 3\), got \(2,\)"),
            (1.0, r"need shape \(…, 3\), got \(\)"),
            ([[0, 0, np.nan]], r"directions\[0, 2\] is nan"),
        ],
    )
    def test_directions_are_unit_vectors(self, directions, message):
        with pytest.raises(ValueError, match=f"real_harmonics: .*{message}"):
            analysis.real_harmonics(directions, 2)

    def test_poles_are_finite(self):
        assert np.isfinite(analysis.real_harmonics([[0, 0, 1.0], [0, 0, -1.0]], 12)).all()

    def test_are_those_of_mesh_deformed(self):
        mesh = Mesh.icosphere(4, 1000)
        for l, m in [(1, -1), (2, 0), (2, 1), (3, -2), (5, 4)]:
            u = np.zeros((l + 1) ** 2)
            u[l * l + l + m] = 0.1
            np.testing.assert_allclose(
                mesh.deformed(l, m, 0.1).vertices, shape(mesh, u), rtol=1e-12, atol=1e-9
            )


class TestSolidAngles:
    def test_add_up_to_the_full_sphere(self, sphere):
        omega = analysis.solid_angles(sphere.vertices, sphere.triangles)
        assert omega.sum() == pytest.approx(4 * np.pi, rel=1e-13)
        assert omega.min() > 0

    def test_of_a_regular_octahedron_are_equal(self):
        vertices = np.concatenate([np.eye(3), -np.eye(3)])
        triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]]
        triangles += [[1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
        omega = analysis.solid_angles(vertices, triangles)
        np.testing.assert_allclose(omega, 4 * np.pi / 6, rtol=1e-14)

    def test_add_up_even_when_triangles_are_inverted(self):
        mesh = Mesh.icosphere(4, 1)
        vertices = mesh.vertices.copy()
        # One vertex is pushed across the opposite side of a triangle of its one-ring.
        a, b, c = mesh.triangles[7]
        vertices[a] = vertices[b] + vertices[c] - 0.6 * vertices[a]
        omega = analysis.solid_angles(vertices, mesh.triangles)
        assert omega.sum() == pytest.approx(4 * np.pi, rel=1e-12)


class TestModeAmplitudes:
    @pytest.mark.parametrize(("l", "m"), [(2, 0), (3, 1), (4, -3), (6, 5)])
    def test_surface_misses_what_triangles_cut_off(self, sphere, l, m):
        mesh = sphere.deformed(l, m, 0.02)
        measured = analysis.mode_amplitudes(mesh.vertices, mesh.triangles, LMAX, "surface")
        radius = volume_radius(mesh.vertices, mesh.triangles)
        sides = mesh.vertices[mesh.triangles] - mesh.vertices[np.roll(mesh.triangles, 1, axis=1)]
        share = l * (l + 1) * (sides**2).sum(axis=(1, 2)).mean() / 48 / radius**2
        index = l * l + l + m
        assert measured[index] == pytest.approx(0.02 * (1 - share) * 1000 / radius, rel=3e-3)

    def test_surface_is_the_integral_over_the_triangles(self):
        """Cut every triangle into 64: the surface is the same, and so are its amplitudes."""
        mesh = uneven(Mesh.random_sphere(252, 1000, seed=2).deformed(3, 1, 0.1))
        fine = mesh
        for _ in range(3):
            fine = cut_in_four(fine)
        # The centre of mass is that of the vertices, so both sets are put there first.
        coarse = analysis.mode_amplitudes(mesh.vertices, mesh.triangles, LMAX, "surface")
        shift = fine.vertices.mean(axis=0) - mesh.vertices.mean(axis=0)
        assert np.linalg.norm(shift) < 5
        exact = analysis.mode_amplitudes(fine.vertices, fine.triangles, LMAX, "surface")
        np.testing.assert_allclose(coarse[4:], exact[4:], atol=2e-3 * abs(exact[4:]).max())

    def test_do_not_depend_on_size_and_place(self, sphere):
        u = np.zeros(16)
        u[4:] = 0.02
        vertices = shape(sphere, u)
        here = analysis.mode_amplitudes(vertices, sphere.triangles, LMAX)
        there = analysis.mode_amplitudes(
            3.7 * vertices + [4000, -700, 12345], sphere.triangles, LMAX
        )
        np.testing.assert_allclose(there, here, atol=1e-11)

    def test_frames_and_units(self, sphere):
        frames = np.stack([sphere.deformed(2, 0, u).vertices for u in np.linspace(-0.1, 0.1, 25)])
        together = analysis.mode_amplitudes(frames, sphere.triangles, 4)
        assert together.shape == (25, 25)
        apart = np.stack([analysis.mode_amplitudes(f, sphere.triangles, 4) for f in frames])
        np.testing.assert_allclose(together, apart, atol=1e-14)
        quantity = unit.Quantity(frames[0] / 1000, unit.micrometer)
        np.testing.assert_allclose(
            analysis.mode_amplitudes(quantity, sphere.triangles, 4), together[0], atol=1e-13
        )

    @pytest.mark.parametrize(
        ("change", "error", "culprit"),
        [
            (lambda v, t: (v * np.nan, t, 2), ValueError, "vertex 0"),
            (lambda v, t: (v[:, :2], t, 2), ValueError, "shape"),
            (lambda v, t: (v, t[:, ::-1], 2), ValueError, "volume of frame 0"),
            (lambda v, t: (v, t + len(v), 2), ValueError, "triangle 0 names vertex"),
            (lambda v, t: (v, t.astype(float), 2), TypeError, "float64"),
            (lambda v, t: (v, t, -1), ValueError, "lmax"),
            (lambda v, t: (v, t, 2, "volume"), ValueError, "quadrature"),
            (lambda v, t: (v * unit.picosecond, t, 2), TypeError, "length"),
        ],
    )
    def test_bad_input_is_named(self, change, error, culprit):
        mesh = Mesh.icosphere(2, 1)
        with pytest.raises(error, match=culprit):
            analysis.mode_amplitudes(*change(mesh.vertices, mesh.triangles))


class TestSpectrum:
    def correlated(self, frames, memory, lmax, seed):
        """Modes that follow (A17) at κ = 20 kBT and forget within `memory` frames, exactly."""
        rng = np.random.default_rng(seed)
        keep = np.exp(-1 / memory)
        series = np.empty((frames, (lmax + 1) ** 2))
        series[0] = rng.normal(size=series.shape[1])
        for t in range(1, frames):
            series[t] = keep * series[t - 1] + np.sqrt(1 - keep**2) * rng.normal(
                size=series.shape[1]
            )
        scale = np.zeros(series.shape[1])
        for l in range(2, lmax + 1):
            scale[l * l : (l + 1) ** 2] = theory.fluid_spectrum(l, 20) ** 0.5
        return series * scale

    def test_error_bars_cover_the_truth(self):
        # |u|² forgets in half the memory of u. Over many runs the deviation in units of the error
        # bar must be normal: an error bar without correlation would be 3 times too small.
        pulls = []
        for seed in range(40):
            s = analysis.spectrum(self.correlated(2000, 20, 3, seed))
            truth = theory.fluid_spectrum(s.l[2:], 20)
            pulls.append((s.mean[2:] - truth) / s.error[2:])
            np.testing.assert_allclose(s.correlation_time[2:], 10, rtol=0.5)
        assert abs(np.mean(pulls)) < 0.35
        assert 0.8 < np.std(pulls) < 1.25

    def test_intervals_cover_the_truth_in_short_runs(self):
        # 30 memories of |u|² in each mode: here the plain mean ± 1.96 errors covers less often.
        inside = []
        for seed in range(300):
            s = analysis.spectrum(self.correlated(300, 10, 2, seed))
            low, high = s.interval()
            inside.append(low[2] < theory.fluid_spectrum(2, 20) < high[2])
        assert 0.90 < np.mean(inside) < 0.99

    def test_interval_is_that_of_a_scale(self):
        one, zero = np.ones(3), np.zeros(3)
        s = analysis.Spectrum(np.arange(3), 4 * one, np.array([0, 1, 4.0]), zero)
        low, high = s.interval(2)
        np.testing.assert_allclose(low, [4, 4 / 1.5, 4 / 3])
        np.testing.assert_allclose(high, [4, 8, np.inf])

    def test_independent_frames_have_half_a_frame(self):
        noise = np.random.default_rng(1).normal(size=(4000, 9))
        s = analysis.spectrum(noise)
        np.testing.assert_allclose(s.correlation_time, 0.5, atol=0.1)
        np.testing.assert_allclose(s.error, np.sqrt(2 / 4000 / (2 * s.l + 1)), rtol=0.2)

    def test_bad_input(self):
        with pytest.raises(ValueError, match="shape"):
            analysis.spectrum(np.zeros((10, 8)))
        with pytest.raises(ValueError, match="two frames"):
            analysis.spectrum(np.zeros((1, 9)))
        with pytest.raises(ValueError, match=r"spectrum: amplitudes\[1, 3\] is nan"):
            analysis.spectrum(np.where(np.arange(9) == 3, [[0], [np.nan]], 0))

    @pytest.mark.parametrize("function", [analysis.spectrum, analysis.mean_shape])
    @pytest.mark.parametrize(
        ("runs", "message"),
        [
            ([np.zeros((5, 9)), np.zeros((5, 8))], r"of run 1: need shape .*, got \(5, 8\)"),
            ([np.zeros((5, 9)), np.zeros((5, 4))], "of run 1: there are 4 modes, and 9 in run 0"),
            ([np.zeros((5, 9)), np.zeros((1, 9))], "of run 1: .*two frames or more, got 1"),
            ([np.zeros((5, 9)), np.zeros(9)], r"of run 1: need shape .*, got \(9,\)"),
            ([np.ones((2, 9)), [[1] * 9, [np.inf] * 9]], r"of run 1\[1, 0\] is inf"),
            (np.zeros((3, 0, 9)), "of run 0: .*two frames or more, got 0"),
            ([], r"need shape .*, got \(0,\)"),
            (5.0, r"need shape .*, got \(\)"),
        ],
    )
    def test_bad_runs(self, function, runs, message):
        with pytest.raises(ValueError, match=f"{function.__name__}: amplitudes.*{message}"):
            function(runs)

    def test_runs_of_one_length_are_averaged(self):
        runs = [self.correlated(500, 10, 3, seed) for seed in range(4)]
        found, each = analysis.spectrum(runs), [analysis.spectrum(run) for run in runs]
        np.testing.assert_allclose(found.mean, np.mean([one.mean for one in each], axis=0))
        expected = np.sqrt(np.sum([one.error**2 for one in each], axis=0)) / 4
        np.testing.assert_allclose(found.error[2:], expected[2:], rtol=0.1)
        np.testing.assert_allclose(found.correlation_time[2:], 5, rtol=0.4)
        for name, values in analysis.spectrum(np.array(runs))._asdict().items():
            assert np.array_equal(values, getattr(found, name))
        assert np.array_equal(analysis.spectrum(runs[:1]).error, each[0].error)

    def test_longer_runs_weigh_more(self):
        run = self.correlated(3000, 10, 3, 1)
        parts = analysis.spectrum([run[:1000], run[1000:]])
        whole = analysis.spectrum(run)
        np.testing.assert_allclose(parts.mean, whole.mean)
        np.testing.assert_allclose(parts.error[2:], whole.error[2:], rtol=0.15)

    def test_a_mean_shape(self):
        """Shares, spectra and their errors with a shape that all runs have, over many trials."""
        shape = np.zeros(16)
        shape[9:] = np.sqrt(theory.fluid_spectrum(3, 20)) * np.array([0, 3, 0, 0, 1, 0, 2])
        truth = theory.fluid_spectrum(3, 20) * (1 + 14 / 7)
        pulls, share_pulls = [], []
        for seed in range(30):
            runs = [
                shape + self.correlated(length, 10, 3, 100 * seed + number)
                for number, length in enumerate((400, 500, 600, 700, 800))
            ]
            found = analysis.spectrum(runs)
            pulls.append((found.mean[3] - truth) / found.error[3])
            still = analysis.mean_shape(runs)
            assert abs(still.amplitudes - shape).max() < 0.2 * shape.max()
            share_pulls.append((still.share[2:] - [0, 2 / 3]) / still.error[2:])
            assert found.correlation_time[3] == pytest.approx(5, rel=0.4)
        for some in (pulls, *np.transpose(share_pulls)):
            assert abs(np.mean(some)) < 0.6
            assert 0.6 < np.std(some) < 1.4
        # What one run takes for fluctuations has a much larger error.
        assert analysis.spectrum(runs[0]).error[3] > 5 * found.error[3]

    def test_one_run_has_no_mean_shape(self):
        with pytest.raises(ValueError, match="two independent runs or more, got 1"):
            analysis.mean_shape(np.ones((5, 9)))


class TestTheory:
    def test_fluid_spectrum(self):
        assert theory.fluid_spectrum(2, 20) == pytest.approx(1 / 480)
        np.testing.assert_allclose(
            theory.fluid_spectrum(np.arange(2, 5), 20), [1 / 480, 1 / 2400, 1 / 7200]
        )

    def test_elastic_spectrum(self):
        assert theory.elastic_spectrum(3, 20, 0, 1000) == theory.fluid_spectrum(3, 20)
        # l = 2: 24 κ + Y r0² · 12/16 with κ = 20 kBT, Y r0² = 100 kBT.
        assert theory.elastic_spectrum(2, 20, 1e-4, 1000) == pytest.approx(1 / 555)
        assert theory.young_modulus(0.59) == pytest.approx(1.8e-3)
        assert theory.young_modulus(0.037) == pytest.approx(7.0790e-6, rel=1e-4)

    def test_frequencies_of_the_papers_vesicle(self):
        kappa = 20 * theory.BOLTZMANN * 300
        paper = dict(rigidity=kappa, mass=50, num_vertices=1002, radius=1000)
        # physics.md: τ_2 ≈ 11 460 ps and ω_2 = 5.486e-4 /ps, for kBT = 2.494 kJ/mol.
        assert theory.mode_period(2, **paper) == pytest.approx(11_460, rel=1e-3)
        assert theory.mode_frequency(2, **paper) == pytest.approx(5.486e-4, rel=2e-3)
        ratio = theory.mode_frequency(3, **paper) / theory.mode_frequency(2, **paper)
        assert ratio == pytest.approx(5**0.5)
        omega = theory.mode_frequency(2, **paper)
        assert theory.overdamped_time(omega, 0.01) == pytest.approx(33_300, rel=3e-3)

    @pytest.mark.parametrize(
        ("call", "culprit"),
        [
            (lambda: theory.fluid_spectrum(1, 20), "l: need 2"),
            (lambda: theory.fluid_spectrum([2, 0], 20), "l: need 2"),
            (lambda: theory.fluid_spectrum(2, 0), "kappa_over_kT"),
            (lambda: theory.elastic_spectrum(2, 20, -1, 1000), "young_over_kT"),
            (lambda: theory.mode_frequency(2, 50, 0, 1002, 1000), "mass"),
        ],
    )
    def test_bad_input_is_named(self, call, culprit):
        with pytest.raises(ValueError, match=culprit):
            call()


class TestMeanCurvature:
    def test_of_a_sphere(self, sphere):
        h = analysis.mean_curvature(sphere.vertices, sphere.triangles)
        assert h.shape == (1002,)
        assert h.mean() == pytest.approx(2 / 1000, rel=0.01)
        assert h.min() > 0

    def test_gives_the_bending_energy_of_physics_md(self):
        # ½ Σ H² a is E/κ of the Jülicher scheme; 8π on a smooth sphere.
        mesh = Mesh.icosphere(10, 1000)
        h = analysis.mean_curvature(mesh.vertices, mesh.triangles)
        a, b, c = mesh.vertices[mesh.triangles.T]
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        vertex_areas = np.bincount(mesh.triangles.ravel(), np.repeat(areas / 3, 3))
        assert np.sum(h**2 * vertex_areas) / 2 == pytest.approx(8 * np.pi, rel=0.01)

    def test_of_a_cube_by_hand(self):
        # A vertex of the unit cube has three edges of angle π/2, J = 3π/4; the diagonals are flat.
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
        squares = [
            (0, 1, 3, 2),
            (4, 6, 7, 5),
            (0, 4, 5, 1),
            (2, 3, 7, 6),
            (0, 2, 6, 4),
            (1, 5, 7, 3),
        ]
        triangles = [t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))]
        degrees = np.bincount(np.ravel(triangles))
        h = analysis.mean_curvature(corners, triangles)
        np.testing.assert_allclose(h, 3 * np.pi / 4 / (degrees / 6), rtol=1e-14)

    def test_is_negative_in_a_dent(self):
        mesh = Mesh.icosphere(6, 1000)
        vertices = mesh.vertices.copy()
        vertices[11] *= 0.8
        h = analysis.mean_curvature(vertices, mesh.triangles)
        assert np.argmin(h) == 11
        assert h[11] < 0

    def test_frames(self, sphere):
        frames = np.stack([sphere.vertices, 2 * sphere.vertices])
        h = analysis.mean_curvature(frames, sphere.triangles)
        np.testing.assert_allclose(h[1], h[0] / 2, rtol=1e-10)

    @pytest.mark.parametrize(
        ("change", "culprit"),
        [
            (lambda t: np.concatenate([t, t[:1]]), "same direction"),
            (lambda t: np.concatenate([t[:1, ::-1], t[1:]]), "same direction"),
            (lambda t: np.where(t == 5, 4, t), "vertex 5 belongs to no triangle"),
        ],
    )
    def test_bad_surfaces_are_named(self, change, culprit):
        mesh = Mesh.icosphere(2, 1)
        with pytest.raises(ValueError, match=culprit):
            analysis.mean_curvature(mesh.vertices, change(np.array(mesh.triangles)))
