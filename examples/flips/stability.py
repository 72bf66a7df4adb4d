"""Which time steps last: temperature, acceptance and degrees of short runs with flips.

For each softness Ξ the time step of `settings.py`, and one half as long again; 1002 vertices and
kV = 0; several runs of 10⁸ vertex-steps each. Runs that break down are counted.
"""

import numpy as np
from fluid_run import VERSION, flow, vesicle_of
from openmmhelfrich.analysis import mean_with_error
from reports import Report
from settings import SETTINGS, with_flips

VERTEX_STEPS = 1e8
SEEDS = 4
FRAMES = 30  # for each τ_2
FACTORS = (1.0, 1.5)


def main():
    report = Report("stability", __doc__)
    num_vertices, steps, seeds = (252, 1e6, 2) if report.quick else (1002, VERTEX_STEPS, SEEDS)
    rows = []
    for softness in SETTINGS:
        for factor in FACTORS:
            points = with_flips(softness, range(1, 1 + seeds), num_vertices)
            for point in points:
                point["time_step"] *= factor
                time = steps / num_vertices * point["time_step"]
                point["periods"] = time / vesicle_of(num_vertices, softness, 1).tau_2
                point["frames_per_period"] = FRAMES
            runs = report.survivors(flow, points, VERSION)
            row = row_of(runs, points[0]["time_step"])
            rows.append((softness, points[0]["time_step"], len(points) - len(runs), *row))
    report.table(["Ξ", "Δt", "failed", "vertex_steps", "acceptance", "T", "T_error", "p9_up"], rows)


def row_of(runs, time_step):
    """Numbers of the runs that went on to their ends."""
    if not runs:
        return (np.nan,) * 5
    kelvin = [mean_with_error(run["kinetic"]) for run in runs]
    error = np.sqrt(sum(each.error**2 for each in kelvin)) / len(runs)
    num_vertices = runs[0]["degrees"][0].sum()
    many = np.mean([run["degrees"][:, 9:].sum(axis=1).mean() for run in runs]) / num_vertices
    time = sum(len(run["kinetic"]) * run["interval"] for run in runs)
    numbers = (
        time / time_step * num_vertices,
        np.mean([run["acceptance"] for run in runs]),
        np.mean([each.mean for each in kelvin]),
        error,
        many,
    )
    return tuple(map(float, numbers))


if __name__ == "__main__":
    main()
