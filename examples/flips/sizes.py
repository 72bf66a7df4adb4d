"""What do meshes of several sizes add to the spectrum of a fluid? Spectra of N = 252 … 4002.

⟨|u_lm|²⟩ over (A17) for l up to √N / 3 and 16, otherwise as `spectrum.py` with flips.
"""

import numpy as np
from fluid_run import RIGIDITY, VERSION, flow
from openmmhelfrich.analysis import spectrum, theory
from reports import Report
from settings import SETTINGS, with_flips

FRAMES_PER_PERIOD = 4
SEEDS = {252: 12, 502: 12, 1002: 12, 2002: 12, 4002: 14}


def main():
    report = Report("sizes", __doc__, add_arguments)
    rows = []
    for softness in report.options.softness:
        for num_vertices in report.options.vertices:
            runs = report.survivors(flow, points_of(softness, num_vertices, report.quick), VERSION)
            if runs:
                rows += rows_of(runs, softness, num_vertices)
    report.table(["N", "Ξ", "l", "ratio", "error", "scatter", "periods", "T"], rows)


def add_arguments(parser):
    parser.add_argument("--softness", type=float, nargs="+", default=[0.33], choices=SETTINGS)
    parser.add_argument("--vertices", type=int, nargs="+", default=[*SEEDS], help="N")


def points_of(softness, num_vertices, quick):
    """Arguments of all runs."""
    seeds, periods = (range(1, 3), 3) if quick else (range(1, 1 + SEEDS[num_vertices]), None)
    points = with_flips(softness, seeds, num_vertices, periods=periods)
    more = {"lmax": highest(num_vertices), "frames_per_period": FRAMES_PER_PERIOD}
    return [point | more for point in points]


def highest(num_vertices):
    """The largest l of a mesh."""
    return min(16, int(num_vertices**0.5 / 3))


def rows_of(runs, softness, num_vertices):
    together = spectrum([run["modes"] for run in runs])
    each = [spectrum(run["modes"]).mean for run in runs]
    scatter = np.std(each, axis=0, ddof=1) / len(runs) ** 0.5
    length = sum(len(run["modes"]) * run["interval"] / run["period"] for run in runs)
    kelvin = float(np.mean([run["kinetic"].mean() for run in runs]))
    rows = []
    for l in range(2, highest(num_vertices) + 1):
        numbers = np.array([together.mean[l], together.error[l], scatter[l]])
        numbers = numbers / theory.fluid_spectrum(l, RIGIDITY)
        rows.append((num_vertices, softness, l, *map(float, numbers), length, kelvin))
    return rows


if __name__ == "__main__":
    main()
