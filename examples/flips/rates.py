"""Averages that must not depend on how often bonds flip: energy of bending, degrees, spectrum.

Two rates a factor ten apart, with standard errors; "sigmas" is their difference over its error.
"""

import numpy as np
from fluid_run import RIGIDITY, VERSION, flow
from openmmhelfrich.analysis import mean_with_error
from openmmhelfrich.vesicle import KBT
from reports import Report
from settings import with_flips
from spectrum import L, ratios_of

SOFTNESS = 0.33
DEGREES = range(4, 9)


def main():
    report = Report("rates", __doc__)
    size = {"num_vertices": 252, "periods": 8} if report.quick else {}
    rates = []
    for share, seeds in ((1.0, 12), (0.1, 2)):
        seeds = 2 if report.quick else seeds
        points = with_flips(SOFTNESS, range(1, 1 + seeds), share=share, **size)
        rates.append(averages(report.runs(flow, points, VERSION)))
    rows = []
    for name, (fast, fast_error) in rates[0].items():
        slow, slow_error = rates[1][name]
        apart = (fast - slow) / np.hypot(fast_error, slow_error)
        rows.append((name, *map(float, (fast, fast_error, slow, slow_error, apart))))
    report.table(["average", "fast", "error", "slow", "error", "sigmas"], rows)


def averages(runs):
    """{name: (mean, standard error)} of runs at one rate."""
    num_vertices = int(runs[0]["degrees"][0].sum())
    bending = [run["bending"] / KBT for run in runs]
    found = {
        "(E_b − 8πκ)/N kBT": over(
            [(each - 8 * np.pi * RIGIDITY) / num_vertices for each in bending]
        )
    }
    for degree in DEGREES:
        found[f"p_{degree}"] = over([run["degrees"][:, degree] / num_vertices for run in runs])
    found["T, K"] = over([run["kinetic"] for run in runs])
    ratio, error, _ = ratios_of(runs)
    for index, l in enumerate(L):
        found[f"l = {l}"] = ratio[index], error[index]
    return found


def over(series):
    """Mean and error of runs of equal length."""
    each = [mean_with_error(one) for one in series]
    means, errors = (np.array([getattr(one, name) for one in each]) for name in ("mean", "error"))
    return means.mean(), np.sqrt((errors**2).sum()) / len(each)


if __name__ == "__main__":
    main()
