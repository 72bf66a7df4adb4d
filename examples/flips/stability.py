"""Which time steps last: temperature, acceptance and degrees of short runs with flips.

For each softness Ξ the time step of `settings.py`, and one half as long again; 1002 vertices and
kV = 0.
A run that breaks down is a row with NaN.
"""

import numpy as np
from fluid_run import VERSION, flow
from openmmhelfrich.analysis import mean_with_error
from reports import Report
from settings import SETTINGS, with_flips

PERIODS = 4
FACTORS = (1.0, 1.5)


def main():
    report = Report("stability", __doc__)
    size = {"num_vertices": 252, "periods": 1} if report.quick else {"periods": PERIODS}
    rows = []
    for softness in SETTINGS:
        for factor in FACTORS:
            points = with_flips(softness, [1], **size)
            for point in points:
                point["time_step"] *= factor
            time_step = points[0]["time_step"]
            rows.append(
                (softness, time_step, *row_of(report.runs(flow, points, VERSION), time_step))
            )
    report.table(["Ξ", "Δt", "vertex_steps", "acceptance", "T", "T_error", "p9_up"], rows)


def row_of(runs, time_step):
    """Numbers of one run, or NaN if there is none."""
    if not runs:
        return (np.nan,) * 5
    run = runs[0]
    kelvin = mean_with_error(run["kinetic"])
    num_vertices = run["degrees"][0].sum()
    many = run["degrees"][:, 9:].sum(axis=1).mean() / num_vertices
    steps = len(run["kinetic"]) * run["interval"] / time_step * num_vertices
    numbers = (steps, run["acceptance"], kelvin.mean, kelvin.error, many)
    return tuple(map(float, numbers))


if __name__ == "__main__":
    main()
