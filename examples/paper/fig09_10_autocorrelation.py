"""Figs. 9 and 10: autocorrelations of u_lm for l = 2 … 7 under OpenMM's integrators.

Verlet, LangevinMiddle with γ = 0.001/ps and 0.01/ps, and Brownian with γ = 0.01/ps, beside the
theory of single modes: (A30) with the internal friction γ_l = 0.15 ω_l, (A35–A37) with γ alone
and with γ_l added, for the mesh brakes modes beside the thermostat too, and (A39).

Dashed lines are the theory of `two_modes.py`, in which vertices also flow within the surface: a
bulge stretches the mesh, and the flow that evens it out has an inertia of its own. It has no free
parameter, and describes l = 2, where the stiffness of the mesh is that of bending; from l = 4 on
modes lose energy in other ways too.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure
from fluctuations import MASS, RADIUS, RIGIDITY, VERSION, relax
from openmmhelfrich.analysis import autocorrelation, theory
from openmmhelfrich.vesicle import KBT
from two_modes import two_mode_autocorrelation

MODES = range(2, 8)
INTERNAL_FRICTION = 0.15

# Integrator, friction in 1/ps, number of runs, time between frames and time step in ps. Without
# inertia a step Δt F / γm along the repulsion of a pressed triangle overshoots sooner: with 0.1 ps
# one of four runs blew up.
FULL = (
    ("verlet", 0.0, 6, 80, 0.8),
    ("langevin", 0.001, 4, 80, 0.8),
    ("langevin", 0.01, 4, 200, 0.8),
    ("brownian", 0.01, 4, 200, 0.05),
)
QUICK = tuple((name, friction, 1, every, step) for name, friction, _, every, step in FULL)
TITLES = {
    ("verlet", 0.0): "Verlet",
    ("langevin", 0.001): "LangevinMiddle, γ = 0.001/ps",
    ("langevin", 0.01): "LangevinMiddle, γ = 0.01/ps",
    ("brownian", 0.01): "Brownian, γ = 0.01/ps",
}

# Length of a run in τ_2, that of the paper's runs, so that the spread of the m's is theirs.
PERIODS = 10


def main():
    figure = Figure("fig09_10", "Figs. 9, 10", "Autocorrelations of the modes", __doc__)
    num_vertices = figure.choose(1002, 252)
    settings = figure.choose(FULL, QUICK)
    results = iter(figure.sweep(relax, points_of(num_vertices, settings), VERSION))
    figure.parameters(
        f"N = {num_vertices}, κ = 20 kBT, r0 = 1000 nm, Ξ = 0.037, Jülicher, kV = 0, 300 K, runs "
        f"of {PERIODS} τ_2; "
        + "; ".join(
            f"{TITLES[name, friction]}: {count} runs, Δt = {step:g} ps"
            for name, friction, count, _, step in settings
        )
    )
    measured = {}
    for name, friction, count, _, _ in settings:
        runs = [next(results) for _ in range(count)]
        for l in modes_of(num_vertices):
            measured[name, friction, l] = Measured(runs, l, friction, num_vertices)
    check(figure, num_vertices, measured)
    draw(figure, num_vertices, measured)
    figure.finish()


def points_of(num_vertices, settings):
    """The arguments of `relax` for all runs, one integrator after the other."""
    # Frames per period and heights of triangles are the same for other N if times go with them.
    scale = (num_vertices / 1002) ** 0.5
    return [
        {
            "num_vertices": num_vertices,
            "integrator": name,
            "friction": friction,
            "lmax": max(MODES),
            "periods": PERIODS,
            "interval": interval * scale,
            "time_step": step,
            "seed": 100 * (place + 1) + run,
        }
        for place, (name, friction, count, interval, step) in enumerate(settings)
        for run in range(count)
    ]


def modes_of(num_vertices):
    """Those of MODES that the mesh resolves, up to √N / 3."""
    return [l for l in MODES if l <= num_vertices**0.5 / 3]


def frequency_of(l, num_vertices):
    """The frequency ω_l of (A30), rad/ps."""
    return theory.mode_frequency(l, RIGIDITY * KBT, MASS, num_vertices, RADIUS)


def modes_in(runs, l):
    """The modes of one l in all runs, shape (num_frames, len(runs) (2l+1))."""
    return np.concatenate([run["fit"][:, l**2 : (l + 1) ** 2] for run in runs], axis=1, dtype=float)


class Measured:
    """Autocorrelation of one l in several runs: times, mean over runs and m, spread of the m's."""

    def __init__(self, runs, l, friction, num_vertices):
        interval = runs[0]["interval"]
        omega = frequency_of(l, num_vertices)
        period_2 = 2 * np.pi / frequency_of(2, num_vertices)
        # Three periods or memories, and never beyond half of a run.
        horizon = min(max(6 * np.pi / omega, 3 * friction / omega**2), PERIODS * period_2 / 2)
        lags = int(horizon / interval) + 1
        self.times = interval * np.arange(lags)
        single = autocorrelation(modes_in(runs, l), lags, normalise=False)
        functions = single.mean(axis=1)
        self.mean = functions / functions[0]
        self.spread = (single / functions[0]).std(axis=1)


def expected(name, friction, l, num_vertices, times):
    """The paper's theory of one mode: (A30) with friction of the mesh, (A35–A37), or (A39)."""
    omega = frequency_of(l, num_vertices)
    if name == "verlet":
        return theory.langevin_autocorrelation(times, omega, INTERNAL_FRICTION * omega)
    if name == "brownian":
        return theory.brownian_autocorrelation(times, omega, friction)
    return theory.langevin_autocorrelation(times, omega, friction)


def check(figure, num_vertices, measured):
    """Compare all autocorrelations with the theory of one mode."""
    names = {"verlet": "(A30) with γ_l = 0.15 ω_l", "brownian": "(A39)", "langevin": "(A35–A37)"}
    for (name, friction, l), found in measured.items():
        what = f"{TITLES[name, friction]}, l = {l}: rms deviation from"
        single = expected(name, friction, l, num_vertices, found.times)
        check_deviation(figure, f"{what} {names[name]}", found, single)
        if name == "langevin":
            omega = frequency_of(l, num_vertices)
            total = friction + INTERNAL_FRICTION * omega
            braked = theory.langevin_autocorrelation(found.times, omega, total)
            check_deviation(figure, f"{what} (A35–A37) with γ + 0.15 ω_l", found, braked)
    figure.table(
        "Rms deviations from the two coupled modes of two_modes.py, which have no free parameter:",
        ["", *(f"l = {l}" for l in modes_of(num_vertices))],
        [
            [title]
            + [
                f"{rms(found.mean - two_modes(name, friction, l, num_vertices, found.times)):.3f}"
                for (*which, l), found in measured.items()
                if tuple(which) == (name, friction)
            ]
            for (name, friction), title in TITLES.items()
        ],
    )


def check_deviation(figure, what, found, theoretical):
    """The rms deviation of the mean over m from theory must be less than the rms spread."""
    deviation, spread = rms(found.mean - theoretical), rms(found.spread)
    figure.claim(
        what, f"{deviation:.3f}", f"below the spread of the m's, {spread:.3f}", deviation < spread
    )


def two_modes(name, friction, l, num_vertices, times):
    """Theory of undulations with flow of the vertices within the surface."""
    return two_mode_autocorrelation(times, l, num_vertices, friction, name)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def draw(figure, num_vertices, measured):
    kinds = list(dict.fromkeys((name, friction) for name, friction, _ in measured))
    page, axes = plt.subplots(
        len(kinds),
        len(modes_of(num_vertices)),
        figsize=(13, 1 + 1.8 * len(kinds)),
        layout="constrained",
        sharey=True,
        squeeze=False,
    )
    for row, (name, friction) in zip(axes, kinds, strict=True):
        for axis, l in zip(row, modes_of(num_vertices), strict=True):
            found = measured[name, friction, l]
            times = found.times / 1000
            axis.fill_between(
                times, found.mean - found.spread, found.mean + found.spread, color="C0", alpha=0.25
            )
            axis.plot(times, found.mean, color="C0", label="mean over m, spread of the m's")
            fine = np.linspace(0, found.times[-1], 300)
            axis.plot(
                fine / 1000,
                expected(name, friction, l, num_vertices, fine),
                color="black",
                lw=0.9,
                label="one mode",
            )
            axis.plot(
                fine / 1000,
                two_modes(name, friction, l, num_vertices, fine),
                color="C3",
                lw=0.9,
                ls="--",
                label="two modes",
            )
            axis.set_title(f"l = {l}", fontsize=8)
            axis.tick_params(labelsize=7)
        row[0].set_ylabel(TITLES[name, friction], fontsize=7)
    for axis in axes[-1]:
        axis.set_xlabel("t / ns", fontsize=8)
    page.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=3, fontsize=8
    )
    figure.save(page, caption="Autocorrelations of u_lm")


if __name__ == "__main__":
    main()
