"""Supplement 9: how fast modes lose their energy to the mesh under Newton's equations.

The damped oscillation (A35–A37) is fitted to the autocorrelations of u_lm in the Verlet run of
`fig09_10_autocorrelation.py`, over three periods. The paper finds γ_l ≈ 0.15 ω_l at Ξ = 0.037. The
same fit to the two coupled oscillators of `two_modes.py`, which have no friction at all, tells how
much of that is the beat with flow of the vertices within the surface: a third of it at l = 2 and
half at l = 3.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fig09_10_autocorrelation import FULL, QUICK, frequency_of, modes_in, modes_of, points_of
from fluctuations import VERSION, relax
from openmmhelfrich.analysis import fit_damping, theory
from scipy.optimize import curve_fit
from two_modes import two_mode_autocorrelation

PAPER = 0.15
PERIODS = 3


def main():
    figure = Figure("sm09", "SM 9", "Internal friction of soft meshes", __doc__)
    num_vertices = figure.choose(1002, 252)
    settings = [row for row in figure.choose(FULL, QUICK) if row[0] == "verlet"]
    runs = figure.sweep(relax, points_of(num_vertices, settings), VERSION)
    figure.parameters(
        f"N = {num_vertices}, κ = 20 kBT, r0 = 1000 nm, Ξ = 0.037, Jülicher, kV = 0; Verlet, "
        f"{len(runs)} runs of 10 τ_2, Δt = {settings[0][4]:g} ps; fit over {PERIODS} periods of "
        "each mode"
    )
    interval = runs[0]["interval"]
    rows = []
    all_modes = modes_of(num_vertices)
    for l in all_modes:
        omega = frequency_of(l, num_vertices)
        lags = int(PERIODS * 2 * np.pi / omega / interval) + 1
        fit = fit_damping(modes_in(runs, l), interval, lags)
        two, two_frequency = two_mode_fit(l, num_vertices, omega, interval * np.arange(lags))
        rows.append((fit.friction / omega, fit.friction_error / omega, fit.frequency / omega, two))
        figure.note(
            f"l = {l}: γ_l/ω_l = {fit.friction / omega:.3f} ± {fit.friction_error / omega:.3f}, "
            f"ω/ω_l = {fit.frequency / omega:.3f} ± {fit.frequency_error / omega:.3f}; "
            f"two modes without friction: {two:.3f}, {two_frequency:.3f}"
        )
    ratio, error, shift, two = np.array(rows).T
    for what, values, wanted in (
        ("γ_l / ω_l", ratio, PAPER),
        ("ω of the fit over (A30)", shift, 1),
    ):
        mean, spread = mean_and_error(values)
        figure.check(f"{what}, mean of l = 2 … {all_modes[-1]}", mean, wanted, 0.05, spread)
    for l, value, uncertain in zip(all_modes, ratio, error, strict=True):
        figure.claim(
            f"γ_l / ω_l of l = {l}",
            f"{value:.3f} ± {uncertain:.2g}",
            f"{PAPER} within a factor of two",
            PAPER / 2 <= value <= PAPER * 2,
        )
    page, axis = plt.subplots(figsize=(5, 3.6), layout="constrained")
    axis.errorbar(all_modes, ratio, error, fmt="o", label="measured")
    axis.plot(all_modes, two, "s", mfc="none", color="C3", label="two modes, no friction")
    axis.axhline(PAPER, color="black", lw=0.8, label="paper")
    axis.set(xlabel="l", ylabel="γ_l / ω_l", ylim=(0, None))
    axis.legend()
    figure.save(page, caption="Damping of Newtonian modes")
    figure.finish()


def two_mode_fit(l, num_vertices, omega, times):
    """γ/ω_l and ω/ω_l of the damped oscillation that fits the frictionless two modes best."""
    function = two_mode_autocorrelation(times, l, num_vertices, 0.0)

    def model(t, friction, frequency):
        return theory.langevin_autocorrelation(t, abs(frequency) * omega, abs(friction) * omega)

    found, _ = curve_fit(model, times, function, [0.1, 1.0])
    return np.abs(found)


if __name__ == "__main__":
    main()
