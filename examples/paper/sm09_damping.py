"""Supplement 9: how fast modes lose their energy to the mesh under Newton's equations.

The damped oscillation (A35–A37) is fitted to the autocorrelations of u_lm in Verlet runs, over
three periods, for each l and Ξ; those of Ξ = 0.037 are the runs of `fig09_10_autocorrelation.py`.
The paper finds γ_l ≈ 0.15 ω_l, whatever l is, with ω_l of (A30). Each value is tested, and for each
Ξ that γ_l / ω_l is one number. The mean shape of a random mesh, which does not move, is left out.

The same fit to the two coupled oscillators of `two_modes.py`, which have no friction at all, tells
what of a damping and of a frequency is the beat with flow of the vertices within the surface.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fig09_10_autocorrelation import (
    FULL,
    QUICK,
    frequency_of,
    modes_in,
    modes_of,
    note_halved,
    points_of,
)
from fluctuations import SOFTNESS, VERSION, relax
from openmmhelfrich.analysis import autocorrelation, theory
from scipy.optimize import curve_fit
from scipy.stats import chi2
from two_modes import two_mode_autocorrelation

PAPER = 0.15
# The paper's "≈", of γ_l / ω_l and of ω / ω_l.
CLOSE, CLOSE_FREQUENCY = 0.03, 0.03
PERIODS = 3
# Runs are taken together in so many groups, whose differences tell the errors.
GROUPS = 7
# A value of χ² that one of a hundred right theories exceeds is too large.
CHANCE = 0.01
# The share of a difference that its cause has to have.
MOST = 0.75


def main():
    figure = Figure("sm09", "SM 9", "Internal friction of soft meshes", __doc__)
    [setting] = [row for row in figure.choose(FULL, QUICK) if row.integrator == "verlet"]
    softnesses = figure.choose(SOFTNESS, SOFTNESS[::3])
    modes = modes_of(setting.num_vertices)
    found, kelvin = {}, []
    for softness in softnesses:
        # The bound of stable steps goes with √Ξ.
        step = setting.time_step * (softness / SOFTNESS[0]) ** 0.5
        runs = figure.sweep(relax, points_of([setting._replace(time_step=step)], softness), VERSION)
        note_halved(figure, f"Ξ = {softness:g}", runs, step)
        kelvin.append(mean_and_error([run["temperature"] for run in runs]))
        found[softness] = [damping_of(runs, l, setting.num_vertices, softness) for l in modes]
    figure.parameters(
        f"N = {setting.num_vertices}, κ = 20 kBT, r0 = 1000 nm, Jülicher, kV = 0; Verlet, "
        f"{setting.runs} runs of 10 τ_2 for each Ξ, each on a random mesh of its own, "
        f"Δt = {setting.time_step:g} ps √(Ξ/0.037); fit over {PERIODS} periods of each mode, modes "
        "in the frame of the body"
    )
    for softness in softnesses:
        check(figure, modes, softness, found[softness])
    figure.note(
        "Mean kinetic temperatures, K: "
        + ", ".join(
            f"{mean:.1f} ± {error:.1f} (Ξ = {softness:g})"
            for softness, (mean, error) in zip(softnesses, kelvin, strict=True)
        )
    )
    tables(figure, modes, found)
    draw(figure, modes, found)
    figure.finish()


def damping_of(runs, l, num_vertices, softness):
    """What is known of the damping of one l.

    Returns
    -------
    dict
        "friction" and "frequency", (value, standard error) over ω_l; "space", those of the friction
        in the frame of the laboratory; "coupled", friction and frequency of two modes without
        friction.
    """
    omega = frequency_of(l, num_vertices)
    interval = runs[0]["interval"]
    lags = int(PERIODS * 2 * np.pi / omega / interval) + 1
    times = interval * np.arange(lags)
    coupled = two_mode_autocorrelation(times, l, num_vertices, 0.0, softness=softness)
    values, errors = fitted(runs, l, times, omega, "fit")
    space, space_errors = fitted(runs, l, times, omega, "space")
    return {
        "friction": (values[0], errors[0]),
        "frequency": (values[1], errors[1]),
        "space": (space[0], space_errors[0]),
        "coupled": tuple(damped(times, coupled, omega)),
    }


def fitted(runs, l, times, omega, name):
    """γ/ω_l and ω/ω_l of all runs, and their standard errors from groups of runs left out."""
    functions = np.stack([autocorrelation_of(run, l, len(times), name) for run in runs])
    total = functions.sum(axis=0)
    groups = np.array_split(functions, min(GROUPS, len(runs)))
    without = np.array([damped(times, total - group.sum(axis=0), omega) for group in groups])
    errors = np.sqrt((len(groups) - 1) * without.var(axis=0))
    return damped(times, total, omega), errors


def autocorrelation_of(run, l, lags, name):
    """The autocorrelation of a run, the mean over m, of what moves, shape (lags,)."""
    modes = modes_in(run, l, name)
    moving = modes - modes.mean(axis=0)
    return autocorrelation(moving, lags, normalise=False).mean(axis=1)


def damped(times, function, omega):
    """γ/ω_l and ω/ω_l of the damped oscillation that fits an autocorrelation best."""

    def model(t, friction, frequency):
        return theory.langevin_autocorrelation(t, abs(frequency) * omega, abs(friction) * omega)

    starts = [(0.1, frequency) for frequency in (0.8, 1.0, 1.3, 1.8)]
    fits = [curve_fit(model, times, function / function[0], start)[0] for start in starts]
    best = min(fits, key=lambda fit: np.sum((model(times, *fit) - function / function[0]) ** 2))
    return np.abs(best)


def check(figure, modes, softness, found):
    """Each γ_l and ω_l, and that γ_l / ω_l does not depend on l."""
    for l, one in zip(modes, found, strict=True):
        for place, (name, what, paper, close) in enumerate(
            (("friction", "γ_l", PAPER, CLOSE), ("frequency", "ω", 1, CLOSE_FREQUENCY))
        ):
            value, error = one[name]
            figure.check(
                f"Ξ = {softness:g}: {what} / ω_l, l = {l}",
                value,
                paper,
                close,
                error,
                why=beat(value, paper, one["coupled"][place]),
            )
    values, errors = np.array([one["friction"] for one in found]).T
    weights = errors**-2
    mean = np.sum(weights * values) / np.sum(weights)
    spread = float(np.sum(weights * (values - mean) ** 2))
    most = chi2.isf(CHANCE, len(values) - 1)
    figure.claim(
        f"Ξ = {softness:g}: γ_l / ω_l is independent of l, χ² to one value",
        f"{spread:.1f} to {mean:.3f}, from {values.min():.3f} to {values.max():.3f}",
        f"less than {most:.1f}, 1 % of chance at {len(values)} values",
        spread < most,
        "a part is the beat with flow within the surface, which depends on l: two coupled modes "
        "without friction have " + ", ".join(f"{one['coupled'][0]:.3f}" for one in found),
    )


def beat(value, paper, coupled):
    """Say that flow is the cause where two coupled modes have most of the difference."""
    rest, difference = abs(value - coupled), abs(value - paper)
    if rest > (1 - MOST) * difference:
        return ""
    return (
        "vertices flow along the surface in beat with the undulations: two coupled modes without "
        f"any friction or free parameter (two_modes.py) have {coupled:.3f} here, which leaves "
        f"{100 * rest / difference:.0f} % of the difference open"
    )


def tables(figure, modes, found):
    for caption, name in (
        ("γ_l / ω_l:", "friction"),
        ("ω / ω_l:", "frequency"),
        ("γ_l / ω_l in the frame of the laboratory, by the paper's sum over vertices:", "space"),
    ):
        rows = [
            [f"Ξ = {softness:g}"] + ["{:.3f} ± {:.3f}".format(*one[name]) for one in some]
            for softness, some in found.items()
        ]
        figure.table(caption, ["", *(f"l = {l}" for l in modes)], rows)
    figure.table(
        "γ and ω over ω_l of two coupled modes without friction:",
        ["", *(f"l = {l}" for l in modes)],
        [
            [f"Ξ = {softness:g}"] + ["{:.3f}, {:.3f}".format(*one["coupled"]) for one in some]
            for softness, some in found.items()
        ],
    )


def draw(figure, modes, found):
    page, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for axis, name, place in zip(axes, ("friction", "frequency"), (0, 1), strict=True):
        for index, (softness, some) in enumerate(found.items()):
            values, errors = np.array([one[name] for one in some]).T
            l = np.array(modes) + 0.06 * index
            axis.errorbar(
                l, values, errors, fmt="o", ms=4, color=f"C{index}", label=f"Ξ = {softness:g}"
            )
            axis.plot(l, [one["coupled"][place] for one in some], "_", ms=10, color=f"C{index}")
        axis.set(xlabel="l")
    axes[0].axhline(PAPER, color="black", lw=0.8, label="paper")
    axes[1].axhline(1, color="black", lw=0.8)
    axes[0].set(ylabel="γ_l / ω_l", ylim=(0, None))
    axes[1].set(ylabel="ω / ω_l")
    axes[0].plot([], [], "_", ms=10, color="gray", label="two modes, no friction")
    axes[0].legend(fontsize=7)
    figure.save(page, caption="Damping and frequency of Newtonian modes")


if __name__ == "__main__":
    main()
