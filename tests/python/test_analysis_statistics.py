"""Autocorrelations, errors, theory of dynamics, and fits, on series of known statistics."""

import numpy as np
import pytest
from openmmhelfrich import analysis
from openmmhelfrich.analysis import theory
from scipy.linalg import expm
from scipy.signal import lfilter

# Under-, critically and overdamped: friction, in units of the frequency.
OMEGA = 1e-3


def oscillators(num_frames, interval, frequency, friction, count, seed):
    """Langevin oscillators with ⟨u²⟩ = 1, propagated exactly; shape (num_frames, count)."""
    rng = np.random.default_rng(seed)
    drift = np.array([[0, 1], [-(frequency**2), -friction]])
    keep = expm(drift * interval)
    equilibrium = np.diag([1, frequency**2])
    kick = np.linalg.cholesky(equilibrium - keep @ equilibrium @ keep.T)
    state = np.sqrt(equilibrium) @ rng.normal(size=(2, count))
    out = np.empty((num_frames, count))
    for frame in range(num_frames):
        out[frame] = state[0]
        state = keep @ state + kick @ rng.normal(size=(2, count))
    return out


def autoregressive(n, keep, count=1, seed=0):
    """x(t+1) = keep x(t) + noise with ⟨x²⟩ = 1, from equilibrium; τ = ½ (1 + keep)/(1 − keep)."""
    rng = np.random.default_rng(seed)
    noise = np.sqrt(1 - keep**2) * rng.normal(size=(n, count))
    noise[0] /= np.sqrt(1 - keep**2)
    return lfilter([1], [1, -keep], noise, axis=0)


class TestAutocorrelation:
    @pytest.mark.parametrize("shape", [(37,), (64, 3), (20, 2, 2)])
    @pytest.mark.parametrize("lags", [1, 7, 20])
    def test_is_the_direct_sum(self, shape, lags):
        x = np.random.default_rng(1).normal(size=shape) + 0.5
        n = len(x)
        direct = np.array([(x[: n - k] * x[k:]).mean(axis=0) for k in range(lags)])
        found = analysis.autocorrelation(x, lags, normalise=False)
        np.testing.assert_allclose(found, direct, atol=1e-13)
        np.testing.assert_allclose(analysis.autocorrelation(x, lags), direct / direct[0])

    def test_all_lags_and_the_mean(self):
        x = np.random.default_rng(1).normal(size=30) + 3
        assert len(analysis.autocorrelation(x)) == 30
        centred = analysis.autocorrelation(x - x.mean(), 5)
        np.testing.assert_allclose(
            analysis.autocorrelation(x, 5, subtract_mean=True), centred, atol=1e-12
        )

    def test_is_unbiased(self):
        found = analysis.autocorrelation(autoregressive(60, 0.8, 20000), 30, normalise=False)
        expected = 0.8 ** np.arange(30)
        error = found.std(axis=1) / np.sqrt(20000)
        assert (abs(found.mean(axis=1) - expected) < 4 * error).all()

    @pytest.mark.parametrize("ratio", [0.0, 0.2, 2.0, 10.0])
    def test_of_exact_oscillators_is_on_theory(self, ratio):
        interval, lags = 150.0, 80
        series = oscillators(2000, interval, OMEGA, ratio * OMEGA or 1e-9, 60, 3)
        functions = analysis.autocorrelation(series, lags, normalise=False)
        expected = theory.langevin_autocorrelation(
            interval * np.arange(lags), OMEGA, ratio * OMEGA or 1e-9
        )
        error = functions.std(axis=1) / np.sqrt(60)
        assert (abs(functions.mean(axis=1) - expected) < 4.5 * error + 1e-12).all()

    def test_of_modes_is_averaged_over_m(self):
        u = np.zeros((4000, 16))
        for l, keep in ((2, 0.5), (3, 0.9)):
            u[:, l * l : (l + 1) ** 2] = autoregressive(4000, keep, 2 * l + 1, l)
        mean, error = analysis.mode_autocorrelation(u, 8)
        assert mean.shape == error.shape == (8, 4)
        assert mean[0, 2] == 1
        for l, keep in ((2, 0.5), (3, 0.9)):
            assert (abs(mean[1:, l] - keep ** np.arange(1, 8)) < 5 * error[1:, l]).all()
            assert (error[1:, l] < 0.1).all()

    @pytest.mark.parametrize(
        ("call", "culprit"),
        [
            (lambda: analysis.autocorrelation([]), "^autocorrelation: series needs shape"),
            (lambda: analysis.autocorrelation([1.0, np.nan]), r"series\[1\] is nan.* not finite"),
            (lambda: analysis.autocorrelation([1.0, 2.0], 3), "lags needs .* 1 to 2, got 3"),
            (lambda: analysis.autocorrelation([1.0, 2.0], np.nan), "lags needs .*nan"),
            (lambda: analysis.mode_autocorrelation(np.zeros((5, 8))), "amplitudes"),
            (
                lambda: analysis.mode_autocorrelation([[np.inf], [0]]),
                r"mode_autocorrelation: amplitudes\[0, 0\] is inf",
            ),
            (
                lambda: analysis.autocorrelation_time([]),
                "^autocorrelation_time: series needs shape",
            ),
            (
                lambda: analysis.autocorrelation_time([[1, 2], [np.nan, 3]]),
                r"autocorrelation_time: series\[1, 0\] is nan",
            ),
        ],
    )
    def test_bad_input_is_named(self, call, culprit):
        with pytest.raises(ValueError, match=culprit):
            call()


class TestErrors:
    @pytest.mark.parametrize("keep", [0.0, 0.8, 0.95])
    def test_are_those_of_autoregressive_series(self, keep):
        tau = 0.5 * (1 + keep) / (1 - keep)
        expected = np.sqrt(2 * tau / 5000)
        found = [analysis.mean_with_error(autoregressive(5000, keep, 1, s)) for s in range(60)]
        means, errors, times, samples = np.array(found).T
        assert np.mean(errors) == pytest.approx(expected, rel=0.06)
        assert np.mean(times) == pytest.approx(tau, rel=0.1)
        assert np.mean(samples) == pytest.approx(2500 / tau, rel=0.12)
        # The means themselves scatter by what the error bars say.
        assert np.std(means / errors) == pytest.approx(1, abs=0.3)

    @pytest.mark.parametrize("keep", [0.0, 0.8, 0.95])
    def test_by_blocking_agree(self, keep):
        tau = 0.5 * (1 + keep) / (1 - keep)
        blocks = [analysis.blocking(autoregressive(8192, keep, 1, s)) for s in range(40)]
        errors = [block.mean_error for block in blocks]
        assert np.mean(errors) == pytest.approx(np.sqrt(2 * tau / 8192), rel=0.12)
        assert all(block.length[block.best] >= tau for block in blocks)
        # Blocks of one step know nothing of the correlation.
        np.testing.assert_allclose([b.error[0] for b in blocks], 1 / np.sqrt(8192), rtol=0.25)

    def test_blocking_counts_equivalent_series_together(self):
        block = analysis.blocking(np.random.default_rng(0).normal(size=(1024, 9)))
        assert block.error[0] == pytest.approx(1 / np.sqrt(9 * 1024), rel=0.05)
        assert block.length.tolist() == [2**k for k in range(10)]

    def test_bad_input_is_named(self):
        for function in (analysis.mean_with_error, analysis.blocking):
            with pytest.raises(ValueError, match="n ≥ 2"):
                function([1.0])
            with pytest.raises(ValueError, match=rf"{function.__name__}: series\[1\] is inf"):
                function([1.0, np.inf])


class TestTheoryOfDynamics:
    def test_autocorrelations_solve_the_equation_of_motion(self):
        """C̈ + γ Ċ + ω² C = 0 with C(0) = 1 and Ċ(0) = 0, in all three regimes."""
        for gamma in (0, 0.3e-3, 1.9e-3, 2e-3, 2.1e-3, 5e-3, 1e-1):
            h = 0.02 / max(OMEGA, gamma)
            t = h * np.arange(-2, 40)
            c = theory.langevin_autocorrelation(t, OMEGA, gamma)
            assert c[2] == 1
            assert c[1] == c[3]  # even, so that its slope at 0 vanishes
            second = (c[4:] - 2 * c[3:-1] + c[2:-2]) / h**2
            first = (c[4:] - c[2:-2]) / (2 * h)
            residual = second + gamma * first + OMEGA**2 * c[3:-1]
            # What finite differences of second order leave, (h ω)² and (h γ)² of the terms.
            assert abs(residual).max() < 1e-3 * (OMEGA**2 + gamma**2)

    def test_limits(self):
        t = np.linspace(0, 2e4, 50)
        newton = theory.newtonian_autocorrelation(t, OMEGA)
        np.testing.assert_allclose(theory.langevin_autocorrelation(t, OMEGA, 0), newton, atol=1e-12)
        gamma = 1e3 * OMEGA
        brown = theory.brownian_autocorrelation(t, OMEGA, gamma)
        np.testing.assert_allclose(
            theory.langevin_autocorrelation(t, OMEGA, gamma), brown, atol=2e-6
        )
        critical = theory.langevin_autocorrelation(t, OMEGA, 2 * OMEGA)
        for nearby in (1 - 1e-9, 1 + 1e-9):
            np.testing.assert_allclose(
                theory.langevin_autocorrelation(t, OMEGA, 2 * OMEGA * nearby), critical, atol=1e-7
            )
        assert theory.langevin_autocorrelation(1e12, OMEGA, 1) < 1e-300
        assert theory.overdamped_time(OMEGA, gamma) == pytest.approx(
            -t[10] / np.log(brown[10]), rel=1e-9
        )

    def test_deformations_have_the_numbers_of_a_sphere_with_a_mode(self):
        # physics.md: u20 = 0.3 on 1002 vertices of r0 = 1000 nm has E_A = 6381.7, E_V = 38126 and
        # E_b = 1304 for κ = 50; the formulae are of leading order in u.
        assert theory.area_energy(0.3, 1.3, 1000) == pytest.approx(6381.7, rel=0.06)
        assert theory.volume_energy(0.3, 0.04, 1000) == pytest.approx(38126, rel=0.06)
        assert theory.bending_energy(0.3, 50) == pytest.approx(1304, rel=0.02)

    def test_mode_energy(self):
        u = np.zeros(9)
        u[6] = 0.2
        assert theory.mode_energy(u, 50) == pytest.approx(theory.bending_energy(0.2, 50))
        u[:4] = 1
        assert theory.mode_energy(np.stack([u, 0 * u]), 50)[1] == pytest.approx(400 * np.pi)
        assert theory.mode_energy(u, 50) == pytest.approx(theory.bending_energy(0.2, 50))

    def test_tension_and_area(self):
        assert theory.tense_spectrum(3, 20, 0, 1000) == pytest.approx(theory.fluid_spectrum(3, 20))
        # l = 2: κ 24 + σ r0² 4, with κ = 20 kBT and σ r0² = 30 kBT.
        assert theory.tense_spectrum(2, 20, 3e-5, 1000) == pytest.approx(1 / 600)
        l = np.arange(2, 32)
        by_hand = np.sum((2 * l + 1) * (l + 2) * (l - 1) * theory.fluid_spectrum(l, 20))
        assert theory.area_excess(20, 31) == pytest.approx(by_hand / (8 * np.pi))
        assert theory.internal_friction(2e-3) == pytest.approx(3e-4)

    @pytest.mark.parametrize(
        ("function", "arguments"),
        [
            (theory.stiffness, (3,)),
            (theory.fluid_spectrum, (3, 20)),
            (theory.elastic_spectrum, (3, 20, 1e-4, 1000, 1e-7)),
            (theory.tense_spectrum, (3, 20, 3e-5, 1000)),
            (theory.young_modulus, (0.2,)),
            (theory.mode_frequency, (3, 50, 50, 1002, 1000)),
            (theory.mode_period, (3, 50, 50, 1002, 1000)),
            (theory.overdamped_time, (1e-3, 0.1)),
            (theory.internal_friction, (1e-3, 0.2)),
            (theory.newtonian_autocorrelation, (300, 1e-3)),
            (theory.langevin_autocorrelation, (300, 1e-3, 0.1)),
            (theory.brownian_autocorrelation, (300, 1e-3, 0.1)),
            (theory.area_energy, (0.1, 1.3, 1000)),
            (theory.volume_energy, (0.1, 0.04, 1000)),
            (theory.bending_energy, (0.1, 50)),
        ],
    )
    def test_every_argument_may_be_a_list(self, function, arguments):
        scalar = function(*arguments)
        assert type(scalar) is float
        for place, value in enumerate(arguments):
            lists = [*arguments[:place], [value, 2 * value], *arguments[place + 1 :]]
            doubled = [*arguments[:place], 2 * value, *arguments[place + 1 :]]
            expected = [scalar, function(*doubled)]
            assert expected[0] != expected[1]
            np.testing.assert_allclose(function(*lists), expected, rtol=1e-14)

    def test_rigidities_may_be_a_list(self):
        excess = [theory.area_excess(20, 31), theory.area_excess(40, 31)]
        np.testing.assert_allclose(theory.area_excess([20, 40], 31), excess)
        u = np.random.default_rng(1).normal(size=(2, 9))
        energies = [theory.mode_energy(u[0], 20), theory.mode_energy(u[1], 40)]
        np.testing.assert_allclose(theory.mode_energy(u, [20, 40]), energies)

    @pytest.mark.parametrize(
        ("call", "culprit"),
        [
            (lambda: theory.langevin_autocorrelation(1, 1, -1), "friction"),
            (lambda: theory.brownian_autocorrelation(1, 1, 0), "friction"),
            (lambda: theory.brownian_autocorrelation(1, -1, 1), "frequency"),
            (lambda: theory.newtonian_autocorrelation(1, -1), "frequency"),
            (lambda: theory.overdamped_time(1e-3, -0.1), r"friction.*-0\.1"),
            (lambda: theory.overdamped_time(0, 0.1), "frequency"),
            (lambda: theory.internal_friction(-1), "frequency"),
            (lambda: theory.young_modulus(-1), "softness: need 0 or more, got -1"),
            (lambda: theory.young_modulus([0.2, np.nan]), "softness.*nan"),
            (lambda: theory.tense_spectrum(2, 20, -1.3e-4, 1000), "tension_over_kT"),
            (
                lambda: theory.tense_spectrum(2, [20, 40], [0, -3e-4], 1000),
                r"more than -0\.00024, .* got -0\.0003",
            ),
            (lambda: theory.tense_spectrum(2, 20, np.nan, 1000), "tension_over_kT.*nan"),
            (lambda: theory.mode_energy(np.zeros(5), 1), "amplitudes"),
            (lambda: theory.area_energy(0.1, 1, 0), "radius"),
            (lambda: theory.area_excess(20, 1), "area_excess: lmax needs .* 2 or more, got 1"),
            (lambda: theory.area_excess(20, 2.7), r"area_excess: lmax needs .*2\.7"),
        ],
    )
    def test_bad_input_is_named(self, call, culprit):
        with pytest.raises(ValueError, match=culprit):
            call()


class TestFits:
    def spectrum(self, young, seed, kappa=20):
        l = np.arange(15)
        mean = np.ones(15)
        mean[2:] = theory.elastic_spectrum(l[2:], kappa, young, 1000)
        noise = 1 + 0.04 * np.random.default_rng(seed).normal(size=15)
        return analysis.Spectrum(l, mean * noise, 0.04 * mean * noise, np.ones(15))

    @pytest.mark.parametrize("young", [0, 1e-4, 1.8e-3])
    def test_of_the_young_modulus(self, young):
        known, fitted = [], []
        for seed in range(60):
            fit = analysis.fit_young(self.spectrum(young, seed), 1000, 20)
            known.append(((fit.young_over_kT - young) / fit.young_error, fit.reduced_chi_squared))
            both = analysis.fit_young(self.spectrum(young, seed), 1000)
            fitted.append(
                (
                    (both.young_over_kT - young) / both.young_error,
                    (both.kappa_over_kT - 20) / both.kappa_error,
                    both.reduced_chi_squared,
                )
            )
        for pulls in (*np.transpose(known)[:1], *np.transpose(fitted)[:2]):
            assert abs(np.mean(pulls)) < 0.5
            assert 0.7 < np.std(pulls) < 1.35
        assert np.mean(known, axis=0)[1] == pytest.approx(1, abs=0.25)
        assert np.mean(fitted, axis=0)[2] == pytest.approx(1, abs=0.25)
        assert fit.kappa_over_kT == 20
        assert fit.kappa_error == 0

    def test_in_a_range_of_modes(self):
        s = self.spectrum(1e-4, 1)
        s.mean[9:] *= 5
        with_all = analysis.fit_young(s, 1000, 20)
        fit = analysis.fit_young(s, 1000, 20, lmax=8)
        assert with_all.reduced_chi_squared > 100
        assert abs(fit.young_over_kT - 1e-4) < 4 * fit.young_error

    @pytest.mark.parametrize("ratio", [0.2, 1.0, 3.0])
    def test_of_damping(self, ratio):
        gamma = ratio * OMEGA
        # Of an overdamped mode, which is nearly an exponential, less can be told.
        count, sharp = (5, 0.4) if ratio < 2 else (15, 0.6)
        fits = [
            analysis.fit_damping(oscillators(8000, 150, OMEGA, gamma, count, seed), 150, 80)
            for seed in range(6)
        ]
        assert np.mean([fit.friction for fit in fits]) == pytest.approx(gamma, rel=0.15)
        assert np.mean([fit.frequency for fit in fits]) == pytest.approx(OMEGA, rel=0.1)
        pulls = [(fit.friction - gamma) / fit.friction_error for fit in fits]
        assert np.sqrt(np.mean(np.square(pulls))) < 2.5
        assert all(fit.friction_error < sharp * gamma for fit in fits)

    def test_of_damping_at_known_frequency_and_of_one_series(self):
        gamma = 10 * OMEGA
        fit = analysis.fit_damping(
            oscillators(16000, 1000, OMEGA, gamma, 7, 1), 1000, 20, frequency=OMEGA
        )
        assert fit.frequency == OMEGA
        assert fit.frequency_error == 0
        assert abs(fit.friction - gamma) < 4 * fit.friction_error < gamma
        one = analysis.fit_damping(oscillators(16000, 150, OMEGA, OMEGA, 1, 1)[:, 0], 150, 60)
        assert abs(one.friction - OMEGA) < 4 * one.friction_error < 2 * OMEGA

    def test_of_damping_that_cannot_be_told(self):
        series = autoregressive(20000, 0.99, 5)
        with pytest.raises(RuntimeError, match=r"only ω²/γ = 0\.0"):
            analysis.fit_damping(series, 1.0, 300)

    @pytest.mark.parametrize(
        ("call", "culprit"),
        [
            (lambda s: analysis.fit_young(s, 0), "radius"),
            (lambda s: analysis.fit_young(s, 1, -1), "kappa_over_kT"),
            (lambda s: analysis.fit_young(s, 1, lmin=14), "1 modes in the range"),
            (lambda s: analysis.fit_young(s._replace(mean=-s.mean), 1), "l = 2 must be positive"),
            (lambda s: analysis.fit_damping(np.zeros((50, 3)), 1), "series 0 is zero"),
            (lambda s: analysis.fit_damping(np.ones(40), 1), "no eight parts"),
            (lambda s: analysis.fit_damping(np.ones((50, 3)), 0), "interval"),
            (lambda s: analysis.fit_damping(np.ones((50, 3)), 1, frequency=-1), "frequency"),
            (
                lambda s: analysis.fit_damping(np.ones((50, 3)), 1, 1),
                "lags needs .* 3 to 50, got 1",
            ),
            (lambda s: analysis.fit_damping(np.ones((50, 3)), 1, 1, 0.1), "lags needs .* 2 to 50"),
            (lambda s: analysis.fit_damping(np.ones((50, 3)), 1, np.nan), "lags needs .*nan"),
            (
                lambda s: analysis.fit_damping([[0], [1], [np.nan], [1]], 1),
                r"series\[2, 0\] is nan",
            ),
            (lambda s: analysis.fit_young(s, np.inf), "radius"),
            (lambda s: analysis.fit_young(s, 1, lmin=np.nan), "lmin needs .*nan"),
            (lambda s: analysis.fit_young(s, 1, lmin=1), "lmin needs .* 2 or more, got 1"),
            (lambda s: analysis.fit_young(s, 1, lmax=4.5), r"lmax needs .*4\.5"),
        ],
    )
    def test_bad_input_is_named(self, call, culprit):
        with pytest.raises(ValueError, match=culprit):
            call(self.spectrum(0, 0))
