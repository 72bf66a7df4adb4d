"""Buds on finer meshes: their energy beside that of two spheres that touch.

With α = 10 and a large Δa0 the shape of least energy is two spheres with a neck of no width. A mesh
has no such neck, so the energies of `ade_shapes.py`, which sees to all else, are too high there.
Here vesicles that begin as two spheres are cooled at several numbers of vertices N, of which

    E = E_∞ + b / √N,    an edge is 2.7 / √N of a sphere's radius,

is the limit, fitted to all of them.
"""

import numpy as np
from ade_shapes import VERSION, least_axisymmetric, row_of, shape_of
from reports import Report

SEEDS = {502: 2, 1002: 2, 2002: 2, 4002: 1}
"""Runs at each number of vertices."""

BUDS = [(0.85, 1.4), (0.95, 1.3), (0.95, 1.4)]
"""ν and Δa0."""


def limit(numbers, energies):
    """E_∞ and its standard error, from the scatter of the runs about the line.

    Parameters
    ----------
    numbers, energies : array_like
        Vertices and E of each run, three or more.
    """
    rows = np.column_stack([np.ones(len(numbers)), np.asarray(numbers, dtype=float) ** -0.5])
    found, *_ = np.linalg.lstsq(rows, np.asarray(energies), rcond=None)
    scatter = np.sum((rows @ found - energies) ** 2) / (len(numbers) - 2)
    return float(found[0]), float((scatter * np.linalg.inv(rows.T @ rows)[0, 0]) ** 0.5)


def main():
    report = Report("ade_buds", __doc__, folder="ade")
    buds, seeds = BUDS, SEEDS
    if report.quick:
        buds, seeds = BUDS[:1], {132: 1, 192: 1, 252: 1}
    runs = {bud: [] for bud in buds}
    # All small meshes first.
    for number, count in seeds.items():
        for volume, target in buds:
            points = [
                {
                    "num_vertices": number,
                    "start": "spheres",
                    "reduced_volume": volume,
                    "delta_a0": target,
                    "seed": seed,
                }
                for seed in range(1, 1 + count)
            ]
            found = report.runs(shape_of, points, VERSION)
            runs[volume, target] += [(number, run) for run in found]
    rows, limits = [], []
    for (volume, target), all_runs in runs.items():
        rows += [(number, *row_of(volume, target, [run])) for number, run in all_runs]
        numbers = [number for number, _ in all_runs]
        energies = [run["bending"] + run["area_difference"] for _, run in all_runs]
        energy, error = limit(numbers, energies)
        expected, kind = least_axisymmetric(volume, target)
        deviation, uncertain = 100 * (energy / expected - 1), 100 * error / expected
        limits.append((volume, target, kind, energy, expected, deviation, uncertain))
    names = ["ν", "Δa0", "shape", "Δa", "E/8πκ", "theory", "E_theory", "deviation/%"]
    report.table(["N", *names], rows)
    names = ["ν", "Δa0", "theory", "E_∞/8πκ", "E_theory", "deviation/%", "error/%"]
    report.table(names, limits, "_limit")


if __name__ == "__main__":
    main()
