"""Figs. 9 and 10: autocorrelations of u_lm for l = 2 … 7 under OpenMM's integrators.

Verlet, LangevinMiddle with γ = 0.001/ps and 0.01/ps, and Brownian with γ = 0.01/ps, beside the
theory of single modes: (A30) with the internal friction γ_l = 0.15 ω_l, (A35–A37) with γ alone
and with γ_l added, for the mesh brakes modes beside the thermostat too, and (A39).

Dashed lines are the theory of `two_modes.py`, in which vertices also flow within the surface: a
bulge stretches the mesh, and the flow that evens it out has an inertia of its own. It has no free
parameter, and describes l = 2, where the stiffness of the mesh is that of bending; from l = 4 on
modes lose energy in other ways too.
"""

from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fluctuations import MASS, RADIUS, RIGIDITY, SOFTNESS, VERSION, relax
from openmmhelfrich.analysis import autocorrelation, theory
from openmmhelfrich.vesicle import KBT
from two_modes import two_mode_autocorrelation

MODES = range(2, 8)
INTERNAL_FRICTION = 0.15

# Length of a run in τ_2. 35 of them make the 350 τ_2 that the paper has for a thermostat (its
# Sec. III.E), and tell the standard error.
PERIODS = 10
RUNS = 35

# A deviation of so many standard errors, root mean square over time, is too large.
SIGMAS = 2


class Setting(NamedTuple):
    """The runs of one integrator: friction in 1/ps, N, their number, frames and time step in ps."""

    integrator: str
    friction: float
    num_vertices: int = 1002
    runs: int = RUNS
    interval: float = 100
    time_step: float = 0.8


# Without inertia a step Δt F / γm along the repulsion of a pressed triangle overshoots sooner: with
# 0.1 ps and N = 1002 one of four runs blew up. 0.05 ps would take 350 τ_2 two hours. With N = 492,
# the smallest mesh that resolves l = 7, triangles are larger, and so are steps, in proportion.
FULL = (
    Setting("verlet", 0.0),
    Setting("langevin", 0.001),
    Setting("langevin", 0.01, interval=200),
    Setting("brownian", 0.01, 492, interval=200, time_step=0.1),
)
QUICK = tuple(
    setting._replace(
        num_vertices=252, runs=3, time_step=0.19 if setting.integrator == "brownian" else 1.6
    )
    for setting in FULL
)
TITLES = {
    ("verlet", 0.0): "Verlet",
    ("langevin", 0.001): "LangevinMiddle, γ = 0.001/ps",
    ("langevin", 0.01): "LangevinMiddle, γ = 0.01/ps",
    ("brownian", 0.01): "Brownian, γ = 0.01/ps",
}


def main():
    figure = Figure("fig09_10", "Figs. 9, 10", "Autocorrelations of the modes", __doc__)
    settings = figure.choose(FULL, QUICK)
    results = iter(figure.sweep(relax, points_of(settings), VERSION))
    figure.parameters(
        f"Random meshes, κ = 20 kBT, r0 = 1000 nm, Ξ = 0.037, Jülicher, kV = 0, 300 K, runs of "
        f"{PERIODS} τ_2, each on its own mesh; "
        + "; ".join(
            f"{title_of(setting)}: N = {setting.num_vertices}, {setting.runs} runs, "
            f"Δt = {setting.time_step:g} ps"
            for setting in settings
        )
    )
    measured = {}
    for setting in settings:
        runs = [next(results) for _ in range(setting.runs)]
        note_halved(figure, title_of(setting), runs, setting.time_step)
        for l in modes_of(setting.num_vertices):
            measured[setting, l] = Measured(runs, l, setting)
    check(figure, measured)
    draw(figure, measured)
    figure.finish()


def note_halved(figure, title, runs, time_step):
    """Say of how many runs the time step had to be halved."""
    halved = sum(run.get("time_step", time_step) < time_step for run in runs)
    if halved:
        figure.note(f"{title}: {halved} of {len(runs)} runs broke down and took half of the step.")


def title_of(setting):
    """Name and friction of an integrator, as the report writes them."""
    return TITLES[setting.integrator, setting.friction]


def points_of(settings, softness=SOFTNESS[0]):
    """The arguments of `relax` for all runs, one integrator after the other."""
    return [
        {
            "num_vertices": setting.num_vertices,
            "softness": softness,
            "integrator": setting.integrator,
            "friction": setting.friction,
            "lmax": max(MODES),
            "periods": PERIODS,
            # Frames per period are the same for other N if times go with them.
            "interval": setting.interval * (setting.num_vertices / 1002) ** 0.5,
            "time_step": setting.time_step,
            "seed": round(1000 * softness) * 1000 + 100 * (place + 1) + run,
        }
        for place, setting in enumerate(settings)
        for run in range(setting.runs)
    ]


def modes_of(num_vertices):
    """Those of MODES that the mesh resolves, up to √N / 3."""
    return [l for l in MODES if l <= num_vertices**0.5 / 3]


def frequency_of(l, num_vertices):
    """The frequency ω_l of (A30), rad/ps."""
    return theory.mode_frequency(l, RIGIDITY * KBT, MASS, num_vertices, RADIUS)


def modes_in(run, l, name="fit"):
    """The modes of one l in a run, shape (num_frames, 2l+1)."""
    return run[name][:, l**2 : (l + 1) ** 2].astype(float)


class Measured:
    """Autocorrelation of one l: times, mean over runs and m, its error, and spread of the m's.

    A run has C_r(t), the mean over m of ⟨u(t) u(0)⟩; "mean" is C = Σ C_r(t) / Σ C_r(0). "error" is
    its standard error from the runs, those of a ratio: of C_r(t) − C(t) C_r(0).
    """

    def __init__(self, runs, l, setting):
        # That of a run with half of the time step differs by less than a thousandth.
        interval = runs[0]["interval"]
        omega = frequency_of(l, setting.num_vertices)
        period_2 = 2 * np.pi / frequency_of(2, setting.num_vertices)
        # Three periods or memories, and never beyond half of a run.
        horizon = max(6 * np.pi / omega, 3 * setting.friction / omega**2)
        lags = int(min(horizon, PERIODS * period_2 / 2) / interval) + 1
        self.times = interval * np.arange(lags)
        single = np.stack(
            [autocorrelation(modes_in(run, l), lags, normalise=False) for run in runs]
        )
        functions = single.mean(axis=2)
        scale = functions[:, 0].mean()
        self.mean = functions.mean(axis=0) / scale
        residuals = (functions - self.mean * functions[:, :1]) / scale
        self.error = mean_and_error(residuals)[1]
        self.spread = (single / scale).std(axis=(0, 2))


def expected(setting, l, times):
    """The paper's theory of one mode: (A30) with friction of the mesh, (A35–A37), or (A39)."""
    omega = frequency_of(l, setting.num_vertices)
    if setting.integrator == "verlet":
        return theory.langevin_autocorrelation(times, omega, INTERNAL_FRICTION * omega)
    if setting.integrator == "brownian":
        return theory.brownian_autocorrelation(times, omega, setting.friction)
    return theory.langevin_autocorrelation(times, omega, setting.friction)


def check(figure, measured):
    """Compare all autocorrelations with the theory of one mode."""
    names = {"verlet": "(A30) with γ_l = 0.15 ω_l", "brownian": "(A39)", "langevin": "(A35–A37)"}
    for (setting, l), found in measured.items():
        coupled = rms(found.mean - two_modes(setting, l, found.times))
        what = f"{title_of(setting)}, l = {l}: rms deviation from"
        single = expected(setting, l, found.times)
        check_deviation(figure, f"{what} {names[setting.integrator]}", found, single, coupled)
        if setting.integrator == "langevin":
            omega = frequency_of(l, setting.num_vertices)
            total = setting.friction + INTERNAL_FRICTION * omega
            braked = theory.langevin_autocorrelation(found.times, omega, total)
            named = f"{what} (A35–A37) with γ + 0.15 ω_l"
            check_deviation(figure, named, found, braked, coupled)
    modes = sorted({l for _, l in measured})
    settings = list(dict.fromkeys(setting for setting, _ in measured))
    figure.table(
        "Rms deviations from the two coupled modes of two_modes.py, which have no free parameter, "
        "and rms standard errors:",
        ["", *(f"l = {l}" for l in modes)],
        [
            [title_of(setting)]
            + [
                f"{rms(found.mean - two_modes(setting, l, found.times)):.3f} ± "
                f"{rms(found.error):.3f}"
                for (which, l), found in measured.items()
                if which == setting
            ]
            for setting in settings
        ],
    )


def check_deviation(figure, what, found, theoretical, coupled):
    """Check that the rms deviation of a mean from theory is of SIGMAS rms standard errors."""
    deviation, error = rms(found.mean - theoretical), rms(found.error)
    flow = (
        "vertices flow along the surface with a stiffness and an inertia of their own: the two "
        f"coupled modes of two_modes.py, without a free parameter, deviate by {coupled:.3f}"
    )
    losses = "the mesh takes up energy at a rate that depends on l, as fits for each l show (SM 9)"
    if coupled <= SIGMAS * error:
        why = flow
    elif coupled < deviation:
        why = f"{flow}; and {losses}"
    else:
        why = f"{losses}; flow alone explains less, the two coupled modes deviate by {coupled:.3f}"
    figure.check(what, deviation, 0, SIGMAS * error, error, why=why)


def two_modes(setting, l, times):
    """Theory of undulations with flow of the vertices within the surface."""
    return two_mode_autocorrelation(
        times, l, setting.num_vertices, setting.friction, setting.integrator
    )


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def draw(figure, measured):
    settings = list(dict.fromkeys(setting for setting, _ in measured))
    modes = sorted({l for _, l in measured})
    page, axes = plt.subplots(
        len(settings),
        len(modes),
        figsize=(13, 1 + 1.8 * len(settings)),
        layout="constrained",
        sharey=True,
        squeeze=False,
    )
    for row, setting in zip(axes, settings, strict=True):
        for axis, l in zip(row, modes, strict=True):
            found = measured[setting, l]
            times = found.times / 1000
            for width, shade, label in (
                (found.spread, 0.15, "spread of the m's in a run"),
                (SIGMAS * found.error, 0.5, f"{SIGMAS} standard errors"),
            ):
                low, high = found.mean - width, found.mean + width
                axis.fill_between(times, low, high, color="C0", alpha=shade, lw=0, label=label)
            axis.plot(times, found.mean, color="C0", label="mean over runs and m")
            fine = np.linspace(0, found.times[-1], 300)
            single, coupled = expected(setting, l, fine), two_modes(setting, l, fine)
            axis.plot(fine / 1000, single, color="black", lw=0.9, label="one mode")
            axis.plot(fine / 1000, coupled, color="C3", lw=0.9, ls="--", label="two modes")
            axis.set_title(f"l = {l}", fontsize=8)
            axis.tick_params(labelsize=7)
        row[0].set_ylabel(title_of(setting), fontsize=7)
    axes[0, 0].set_ylim(-1.3, 1.3)
    for axis in axes[-1]:
        axis.set_xlabel("t / ns", fontsize=8)
    page.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=5, fontsize=8
    )
    figure.save(page, caption="Autocorrelations of u_lm")


if __name__ == "__main__":
    main()
