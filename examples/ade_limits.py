"""Shapes on finer meshes whose energies are not those of theory at N = 1002.

With α = 10 and a large Δa0 the shape of least energy is two spheres with a neck of no width. A mesh
has no such neck, so the energies of `ade_shapes.py`, which sees to all else, are too high there;
those of a dimple as narrow as the stomatocyte's of ν = 0.95 are too low. Here vesicles that begin
as two spheres, or as theory has them, are cooled at several numbers of vertices N. The limit is

    E / E_theory = e_∞ + b / √N,    an edge is 3.8 / √N of R_A,

fitted to all of one ν and Δa0 that begin as two spheres and do not pass through themselves. A bud
may go back through its neck, which is an energy below that of any vesicle, so at ν = 0.85 a
repulsion of the surface, which does not count, keeps it from that.
"""

import numpy as np
from ade_shapes import VERSION, row_of, shape_of
from openmmhelfrich import analysis
from reports import Report

FINE = {502: 2, 1002: 2, 2002: 2}
FINEST = FINE | {4002: 1}
"""Runs at each number of vertices."""

SHAPES = {
    (0.85, 1.4): ({"start": "spheres", "repulsion": True}, FINE),
    (0.95, 0.8): ({"start": "theory"}, FINEST),
    (0.95, 1.2): ({"start": "theory"}, FINEST),
    (0.95, 1.3): ({"start": "spheres"}, FINEST),
    (0.95, 1.4): ({"start": "spheres"}, FINEST),
}
"""By ν and Δa0 how they begin, and how many runs there are."""


def limit(numbers, values):
    """The value at N → ∞ and its standard error, from the scatter of the runs about the line.

    Parameters
    ----------
    numbers, values : array_like
        Vertices and value of each run, three or more.
    """
    rows = np.column_stack([np.ones(len(numbers)), np.asarray(numbers, dtype=float) ** -0.5])
    found, *_ = np.linalg.lstsq(rows, np.asarray(values), rcond=None)
    scatter = np.sum((rows @ found - values) ** 2) / (len(numbers) - 2)
    return float(found[0]), float((scatter * np.linalg.inv(rows.T @ rows)[0, 0]) ** 0.5)


def main():
    report = Report("ade_limits", __doc__, folder="ade")
    shapes = SHAPES
    if report.quick:
        shape, (arguments, _) = next(iter(SHAPES.items()))
        shapes = {shape: (arguments, {132: 1, 192: 1, 252: 1})}
    runs = {shape: [] for shape in shapes}
    # All small meshes first.
    for number in sorted({number for _, seeds in shapes.values() for number in seeds}):
        for (volume, target), (arguments, seeds) in shapes.items():
            points = [
                {
                    "num_vertices": number,
                    "reduced_volume": volume,
                    "delta_a0": target,
                    "seed": seed,
                    **arguments,
                }
                for seed in range(1, 1 + seeds.get(number, 0))
            ]
            found = report.runs(shape_of, points, VERSION)
            runs[volume, target] += [(number, run) for run in found]
    rows, limits = [], []
    for (volume, target), all_runs in runs.items():
        some = [(number, *row_of(volume, target, [run]), crossed(run)) for number, run in all_runs]
        rows += some
        whole = [(row[0], 1 + row[-2] / 100) for row in some if not row[-1]]
        if shapes[volume, target][0]["start"] == "spheres" and len({n for n, _ in whole}) > 2:
            ratio, error = limit(*zip(*whole, strict=True))
            limits.append((volume, target, len(whole), 100 * (ratio - 1), 100 * error))
    names = ["ν", "Δa0", "shape", "Δa", "E/8πκ", "theory", "E_theory", "deviation/%", "crossings"]
    report.table(["N", *names], rows)
    report.table(["ν", "Δa0", "runs", "deviation/%", "error/%"], limits, "_limit")


def crossed(run):
    """How many pairs of triangles cross each other."""
    return len(analysis.crossings(run["vertices"], run["triangles"]))


if __name__ == "__main__":
    main()
