"""The viscosity of the membrane against the rate of flips, from rotations at rest and driven ones.

Along a sphere of mass density ρ, radius R and viscosity η (in two dimensions, amu/ps) a rotation
v_lm (`rotations.py`) under LangevinMiddle slows down at the rate

    Γ_l = γ + η (l−1)(l+2) / ρR²,    ρR² = N m / 4π,

for the viscous stress pulls with η (Δ + 1/R²) v at a flow without sources, and Δ has the
eigenvalue −[l(l+1) − 1] / R² for it (L. E. Scriven, doi:10.1016/0009-2509(60)87003-0; M. L. Henle,
A. J. Levine, doi:10.1103/PhysRevE.81.011905). l = 1 turns rigidly.

1. At rest: ∫_0^∞ ⟨v_lm(0) v_lm(t)⟩ dt = ⟨v_lm²⟩ d_l with d_l = 1/Γ_l, Γ_l being that of slow flow,
   whatever fast motion is like. The integral is that of Einstein, the slope of the mean squared
   displacement between the times W and 2W, W = `window_of` the rate.
2. Driven: all vertices have the acceleration a Φ_20, and ⟨v_20⟩ = a d_2; at two strengths.

A little of d_l is left where neighbours are fixed: what rattles in its cage on a surface that
undulates stirs. It is measured at the same N and Ξ, and taken off both.

Viscosities are in kBT τ/a², a² = 4πR²/N being the area of a vertex and τ = 11 448 ps the τ_2 of
N = 1002, in which meshes of any N and one softness should agree. η is the mean of those of l = 2
and 3. The line η = η_0 + C / rate is fitted for each Ξ.
"""

import sys
from pathlib import Path

import numpy as np
from fluid_run import RADIUS
from openmmhelfrich.vesicle import KBT
from reports import Report
from scipy.optimize import curve_fit
from settings import SETTINGS
from viscous_run import VERSION, rotate, window_of

sys.path.append(str(Path(__file__).resolve().parents[1] / "paper"))
from displacements import jackknife
from fluctuations import MASS

TIME = 11448.0  # ps, τ
FRICTION = 2e-4  # γ, 1/ps
ACCELERATION = 5e-5  # a, nm/ps²
L = np.array([2, 3, 4])

NUM_VERTICES = 252
SHARES = {0.33: (0.05, 0.1, 0.2, 0.5, 1.0, 3.0), 0.15: (0.05, 0.2, 1.0)}
"""By Ξ, flips over the usual ones."""

SEEDS, DRIVEN_SEEDS = 6, 4
PERIODS, DRIVEN_PERIODS = 300, 150
"""Length of a run at rest, and of a driven one, τ_2."""


def main():
    report = Report("viscosity", __doc__)
    rows = []
    for softness, shares in ({0.33: (0.2, 1.0)} if report.quick else SHARES).items():
        still = report.runs(rotate, points_of(softness, 0.0, report.quick), VERSION)
        if len(still) < 2:
            continue
        left = mobilities(still)
        for share in shares:
            runs = report.runs(rotate, points_of(softness, share, report.quick), VERSION)
            if len(runs) < 2:
                continue
            driven = []
            for strength in (1, 2):
                points = points_of(softness, share, report.quick, strength)
                driven += driven_of(report.runs(rotate, points, VERSION), strength, left)
            rate = float(np.mean([run["rate"] for run in runs])) * TIME
            values, errors = viscosities(runs, left)
            each = [number for pair in zip(values, errors, strict=True) for number in pair]
            numbers = (rate, *each, *driven, rate * values[-1], rate * errors[-1])
            rows.append((NUM_VERTICES, softness, *map(float, numbers)))
    names = "N Ξ flips η_2 error η_3 error η_4 error η error driven error twice error Cη error"
    report.table(names.replace("Cη", "η·flips").split(), rows)
    for softness in dict.fromkeys(row[1] for row in rows):
        law([row for row in rows if row[1] == softness])


def points_of(softness, share, quick, strength=0):
    """Arguments of `rotate`: at rest, or driven by `strength` times ACCELERATION."""
    setting = SETTINGS[softness]
    periods, seeds = (DRIVEN_PERIODS, DRIVEN_SEEDS) if strength else (PERIODS, SEEDS)
    if quick:
        periods, seeds = 60, 2
    return [
        {
            "num_vertices": NUM_VERTICES,
            "softness": softness,
            "attempts": share * setting.attempts,
            "every": setting.every,
            "time_step": setting.time_step * (1002 / NUM_VERTICES) ** 0.5,
            "periods": periods,
            "seed": seed,
            "friction": FRICTION,
            "acceleration": strength * ACCELERATION,
        }
        for seed in range(1, 1 + seeds)
    ]


def integrals(correlation, interval, window):
    """∫_0^∞ of a correlation, of each column: weight 1 up to W, then falling to 0 at 2W."""
    steps = round(window / interval)
    weights = np.clip(2 - np.arange(len(correlation)) / steps, 0, 1)
    weights[0] = 0.5
    return interval * weights @ correlation


def mobilities(runs):
    """d_l of L, ps, and its errors, from runs at rest."""
    window = window_of(np.mean([run["rate"] for run in runs]))
    equal = 4 * np.pi * KBT / (NUM_VERTICES * MASS * L * (L + 1))
    shortest = min(len(run["correlation"]) for run in runs)
    functions = np.array([run["correlation"][:shortest, L] for run in runs], dtype=float)

    def estimate(chosen):
        return integrals(chosen.mean(axis=0), runs[0]["interval"], window) / equal

    return jackknife(functions, estimate, len(runs))


def viscosity_of(mobility, l):
    """η, kBT τ/a², of what is left of d_l."""
    return (1 / mobility - FRICTION) / ((l - 1) * (l + 2)) * MASS * RADIUS**2 / KBT / TIME


def with_error(mobility, error, l):
    """η of d_l, and its error: η and γ together are as 1/d_l."""
    value = viscosity_of(mobility, l)
    return value, (value - viscosity_of(np.inf, l)) * error / mobility


def viscosities(runs, left):
    """η of L and of l = 2 and 3 together, and errors."""
    mobility, error = mobilities(runs)
    each, errors = with_error(mobility - left[0], np.hypot(error, left[1]), L)
    weights = (2 * L[:2] + 1) / (2 * L[:2] + 1).sum()
    return np.append(each, weights @ each[:2]), np.append(errors, np.hypot(*weights * errors[:2]))


def driven_of(runs, strength, left):
    """η of l = 2 from driven runs, and its error; NaN without them."""
    if len(runs) < 2:
        return np.nan, np.nan
    each = np.array([run["driven"] for run in runs]) / (strength * ACCELERATION)
    error = np.hypot(each.std(ddof=1) / len(each) ** 0.5, left[1][0])
    return with_error(each.mean() - left[0][0], error, 2)


def law(rows):
    """Print η_0 and C of η = η_0 + C / rate, and how well they fit."""
    if len(rows) < 3:
        return
    flips, value, error = (np.array([row[place] for row in rows]) for place in (2, 9, 10))

    def line(rate, rest, constant):
        return rest + constant / rate

    found, covariance = curve_fit(line, flips, value, sigma=error, absolute_sigma=True)
    deviations = (value - line(flips, *found)) / error
    errors = np.sqrt(np.diag(covariance))
    print(
        f"Ξ = {rows[0][1]}: η_0 = {found[0]:.3f} ± {errors[0]:.3f}, C = {found[1]:.2f} ± "
        f"{errors[1]:.2f}, χ² per degree of freedom "
        f"{deviations @ deviations / (len(rows) - 2):.2f}"
    )


if __name__ == "__main__":
    main()
