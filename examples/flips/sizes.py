"""What do meshes of several sizes add to the spectrum of a fluid? Vesicles of N = 252 … 4002.

⟨|u_lm|²⟩ over (A17) for l up to √N / 3 and 16, as in `spectrum.py` with flips. Two formulas are
fitted to these ratios and to those of `spectrum.csv` in the folder of tables, with x = l (l+1) / N
and energies in kBT; each has one parameter, c, the softness of waves near the spacing of the
vertices:

    by shorter waves   (1 + c x) / [1 − (3/4πκ) ln(√N / l)]
    by all waves       (1 + c x) [1 + (3/2) ⟨|∇u|²⟩],  ⟨|∇u|²⟩ = Σ (2p+1) / [4πκ (p−1) (p+2)]

The first is the rigidity of Peliti and Leibler (doi:10.1103/PhysRevLett.54.1690) at the scale of l:
waves shorter than l soften the membrane. But u is measured along radii, and waves longer than l
tilt the surface against these: a wave of the tilted surface has a larger amplitude along the radius
and a shorter length across it. To first order in 1/κ that is as much again for each octave, so
that all waves, p = 2 … √N, count alike: 3/2 of the mean square slope, for every l. (It is the
one-loop term of ½ κ ∫ (2H)² √g in the heights above a plane, in which the waves p of the loop
have no bounds but those of the membrane.)
"""

import csv

import numpy as np
from fluid_run import RIGIDITY, VERSION, flow
from reports import Report
from scipy.optimize import curve_fit
from settings import SEEDS_OF_SIZES, SETTINGS, highest, of_sizes
from spectrum import bending_ratio, ratios_of

# Of very soft meshes folds are a part of the spectrum.
LEAST_SOFTNESS = 0.1


def main():
    report = Report("sizes", __doc__, add_arguments)
    options, rows = report.options, []
    for softness in options.softness:
        for num_vertices in options.vertices:
            points = of_sizes(softness, num_vertices, report.quick)
            runs = report.survivors(flow, points, VERSION)
            if runs:
                rows += rows_of(runs, softness, num_vertices)
    report.table(["N", "Ξ", "l", "ratio", "error", "scatter", "periods", "T"], rows)
    compare([(row[0], *row[2:5]) for row in rows] + of_spectrum(report.tables / "spectrum.csv"))


def add_arguments(parser):
    parser.add_argument("--softness", type=float, nargs="+", default=[0.33], choices=SETTINGS)
    parser.add_argument("--vertices", type=int, nargs="+", default=[*SEEDS_OF_SIZES], help="N")


def rows_of(runs, softness, num_vertices):
    """For each l: the ratio, its error, that from differences between runs, their length and T."""
    length = sum(len(run["modes"]) * run["interval"] / run["period"] for run in runs)
    kelvin = float(np.mean([run["kinetic"].mean() for run in runs]))
    l = np.arange(2, highest(num_vertices) + 1)
    return [
        (num_vertices, softness, int(each), *map(float, numbers), float(length), kelvin)
        for each, numbers in zip(l, ratios_of(runs, l).T, strict=True)
    ]


def of_spectrum(path):
    """N, l, ratio and error of the runs with flips in the table of `spectrum.py`, if any."""
    if not path.is_file():
        return []
    with path.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["bonds"] == "flips"]
    chosen = [row for row in rows if float(row["Ξ"]) >= LEAST_SOFTNESS]
    return [
        (int(row["N"]), int(row["l"]), float(row["ratio"]), float(row["error"])) for row in chosen
    ]


def compare(rows):
    """Fit both formulas, to all sizes and to each alone, and print how well they do."""
    num_vertices, l, ratio, error = np.array(rows, dtype=float).T
    shorter = 1 / bending_ratio(num_vertices, RIGIDITY, l, c=0)
    every = 1 + 1.5 * np.array([mean_square_slope(int(n)) for n in num_vertices])
    for name, thermal in (("by shorter waves", shorter), ("by all waves", every)):
        points = np.stack([l * (l + 1) / num_vertices, ratio / thermal, error / ratio])
        c, c_error, quality = fit_c(*points)
        print(f"{name}: c = {c:.2f} ± {c_error:.2f}, χ² per degree of freedom {quality:.2f}")
        for n in np.unique(num_vertices):
            c, c_error, quality = fit_c(*points[:, num_vertices == n])
            print(f"    N = {n:4.0f} alone: {c:.2f} ± {c_error:.2f}, {quality:.2f}")


def fit_c(x, ratio, relative_error):
    """C of 1 + c x, its error, and χ² per degree of freedom."""

    def model(x, c):
        return np.log(1 + c * x)

    (c,), ((variance,),) = curve_fit(
        model, x, np.log(ratio), [2.0], sigma=relative_error, absolute_sigma=True
    )
    deviations = (np.log(ratio) - model(x, c)) / relative_error
    return c, variance**0.5, deviations @ deviations / (len(x) - 1)


def mean_square_slope(num_vertices):
    """⟨|∇u|²⟩ of waves up to √N."""
    p = np.arange(2, int(num_vertices**0.5) + 1)
    return np.sum((2 * p + 1) / ((p - 1) * (p + 2))) / (4 * np.pi * RIGIDITY)


if __name__ == "__main__":
    main()
