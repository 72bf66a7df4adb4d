"""How vertices move within the surface: mean squared angles against time, at several flip rates.

On a sphere free diffusion has ⟨r̂(0) · r̂(t)⟩ = exp(−2 D t), D in rad²/ps, so that −2 ln ⟨cos⟩ =
4 D t at all times, the mean squared angle while it is small. The rotation of the whole is removed.
D comes from a straight line through −2 ln ⟨cos⟩ from t to 5 t, t being τ_2 or, if that is longer,
the time in which each edge flips once: before, vertices are in their cages. Its error is the
standard error from the differences between runs.
"""

import numpy as np
from fluid_run import VERSION, flow
from reports import Report
from settings import with_flips, without_flips

SOFTNESS = 0.33

# Of the usual flips, with the number of runs and their length, τ_2.
SHARES = {0.01: (4, 150), 0.03: (6, 50), 0.1: (6, 50), 0.3: (2, 50), 1.0: (12, 50)}
QUICK = {0.3: (2, 8), 1.0: (2, 8)}

LAGS = (0.5, 1, 2, 5, 10, 20)


def main():
    report = Report("diffusion", __doc__)
    rows = []
    for share, (seeds, periods) in (QUICK if report.quick else SHARES).items():
        size = {"num_vertices": 252 if report.quick else 1002, "periods": periods}
        points = with_flips(SOFTNESS, range(1, 1 + seeds), share=share, **size)
        rows += row_of(report.runs(flow, points, VERSION))
    size = {"num_vertices": 252, "periods": 8} if report.quick else {}
    rows += row_of(report.runs(flow, without_flips(SOFTNESS, range(1, 3), **size), VERSION))
    names = ["flips", "D", "error", "D_per_flip", *(f"angle2({lag})" for lag in LAGS)]
    report.table(names, rows)
    print("flips: for each edge and τ_2; D: rad²/τ_2; angle2(t): −2 ln ⟨cos⟩ after t τ_2")


def row_of(runs):
    """One row, of runs at one rate, or none."""
    if not runs:
        return []
    flips = float(np.mean([run["rate"] * run["period"] for run in runs]))
    slopes = np.array([slope(run) for run in runs])
    error = slopes.std(ddof=1) / len(runs) ** 0.5 if len(runs) > 1 else np.nan
    mean = slopes.mean()
    angles = np.mean([angle_after(run) for run in runs], axis=0)
    return [
        (
            flips,
            float(mean),
            float(error),
            float(mean / flips) if flips else "",
            *map(float, angles),
        )
    ]


def slope(run):
    """D of one run, rad²/τ_2."""
    time = np.arange(len(run["cosine"])) * run["interval"] / run["period"]
    start = 1.0
    if run["rate"]:
        start = max(start, 1 / (run["rate"] * run["period"]))
    inside = (time > 0.99 * start) & (time < 5.01 * start) & (run["cosine"] > 0.1)
    return np.polyfit(time[inside], -2 * np.log(run["cosine"][inside]), 1)[0] / 4


def angle_after(run):
    """−2 ln ⟨cos⟩ after LAGS; NaN where the run is too short."""
    time = np.arange(len(run["cosine"])) * run["interval"] / run["period"]
    cosine = np.interp(LAGS, time, run["cosine"], right=np.nan)
    return -2 * np.log(np.where(cosine > 0, cosine, np.nan))


if __name__ == "__main__":
    main()
