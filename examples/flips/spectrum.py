"""Is it a fluid? Spectra of vesicles with bond flips beside those of fixed neighbours.

⟨|u_lm|²⟩ over that of a continuous fluid, (A17) of doi:10.1103/PhysRevE.108.015301, at several Ξ,
for random meshes, Jülicher's scheme, kV = 0 and κ = 20 kBT. What meshes add to (A17), with n =
l (l+1) and energies in kBT:

    1/⟨|u_lm|²⟩ = [κ − (3/4π) ln(√N / l)] n (n−2) / (1 + c n / N) + y N · 3 (n−2) / (3n−2)

c, the softness of waves that come near to the spacing of the vertices, is fitted once for all
meshes with flips; y = Y r0² / N is the shear modulus that is left, fitted for each Ξ. See
`../paper/mesh_corrections.py`. "corrected" is the ratio to what this has with c, and y = 0.

Errors know about correlation in time (`analysis.spectrum`); "scatter" is the standard error from
the differences between runs alone.
"""

import sys
from pathlib import Path

import numpy as np
from fluid_run import RIGIDITY, VERSION, flow
from openmmhelfrich.analysis import spectrum, theory
from reports import Report
from scipy.optimize import curve_fit
from settings import SETTINGS, of_sizes, with_flips, without_flips

sys.path.append(str(Path(__file__).resolve().parents[1] / "paper"))
from mesh_corrections import bending_ratio, shear_ratio

L = np.arange(2, 9)
SEEDS = {0.037: 12, 0.15: 12, 0.33: 12, 0.59: 12}
FIXED_SEEDS = 4


def main():
    report = Report("spectrum", __doc__, add_arguments)
    options = report.options
    found = {}
    for softness in options.softness:
        # Larger meshes with fixed neighbours are those of ../paper/fig06_spectrum.py.
        for flips in (True, False) if options.vertices <= 1002 else (True,):
            points = points_of(softness, flips, options.vertices, report.quick)
            runs = report.survivors(flow, points, VERSION)
            if runs:
                found[softness, flips] = ratios_of(runs), runs
    fluid = {softness: each[0] for (softness, flips), each in found.items() if flips}
    c, c_error, moduli, quality = fit(fluid, options.vertices)
    rows = []
    for (softness, flips), (ratios, runs) in found.items():
        y, y_error = moduli[softness] if flips else rigid(ratios, options.vertices, c)
        corrected = ratios[:2] * bending_ratio(options.vertices, RIGIDITY, L, c)
        length = sum(len(run["modes"]) * run["interval"] / run["period"] for run in runs)
        kelvin = np.mean([run["kinetic"].mean() for run in runs])
        for index, l in enumerate(L):
            numbers = (*ratios[:, index], *corrected[:, index])
            about = (options.vertices, softness, "flips" if flips else "fixed", int(l))
            rows.append((*about, *map(float, numbers), float(y), float(y_error), length, kelvin))
    columns = "N Ξ bonds l ratio error scatter corrected corrected_error y y_error periods T"
    suffix = "" if options.vertices == 1002 else f"_{options.vertices}"
    report.table(columns.split(), rows, suffix)
    print(f"c = {c:.2f} ± {c_error:.2f}, χ² per degree of freedom {quality:.2f}")
    if options.picture:
        draw(rows, options.picture)


def add_arguments(parser):
    parser.add_argument("--softness", type=float, nargs="+", default=[0.33], choices=SETTINGS)
    parser.add_argument("--vertices", type=int, default=1002, help="N; default 1002")
    parser.add_argument("--picture", type=Path, help="PNG to draw")


def points_of(softness, flips, num_vertices, quick):
    """Arguments of all runs."""
    if num_vertices > 1002:
        return of_sizes(softness, num_vertices, quick)
    make = with_flips if flips else without_flips
    if quick:
        return make(softness, range(1, 3), num_vertices, periods=3)
    return make(softness, range(1, 1 + (SEEDS[softness] if flips else FIXED_SEEDS)), num_vertices)


def ratios_of(runs, l=L):
    """⟨|u_lm|²⟩ over (A17), its error, and that from differences between runs, for each l."""
    fluid = theory.fluid_spectrum(l, RIGIDITY)
    together = spectrum([run["modes"] for run in runs])
    each = [spectrum(run["modes"]).mean for run in runs]
    scatter = np.std(each, axis=0, ddof=1) / len(runs) ** 0.5 if len(runs) > 1 else np.nan * each[0]
    return np.array([values[l] / fluid for values in (together.mean, together.error, scatter)])


def fit(fluid, num_vertices):
    """Fit c and its error, {Ξ: (y, error)}, and χ² per degree of freedom, of spectra with flips."""
    softnesses = list(fluid)
    ratio, error = (np.concatenate([fluid[each][row] for each in softnesses]) for row in (0, 1))

    def model(_, c, *y):
        rest = bending_ratio(num_vertices, RIGIDITY, L, c)
        stiffness = [rest + each * shear_ratio(num_vertices, RIGIDITY, L) for each in y]
        return -np.log(np.concatenate(stiffness))

    relative = error / ratio
    start = (2.4, *[0.0] * len(softnesses))
    found, covariance = curve_fit(
        model, L, np.log(ratio), start, sigma=relative, absolute_sigma=True
    )
    deviations = (np.log(ratio) - model(L, *found)) / relative
    errors = np.sqrt(np.diag(covariance))
    moduli = dict(zip(softnesses, zip(found[1:], errors[1:], strict=True), strict=True))
    freedom = len(ratio) - len(found)
    return found[0], errors[0], moduli, float(deviations @ deviations / freedom)


def rigid(ratios, num_vertices, c):
    """Fit y and its error of a mesh with fixed neighbours, from l = 2 … 5, c given."""
    few = L <= 5
    ratio, error = ratios[0, few], ratios[1, few]
    weights = ratio**2 / error * shear_ratio(num_vertices, RIGIDITY, L[few])
    rest = ratio**2 / error * (1 / ratio - bending_ratio(num_vertices, RIGIDITY, L[few], c))
    return weights @ rest / (weights @ weights), (weights @ weights) ** -0.5


def draw(rows, path):
    """Ratios against l: filled with flips, open without."""
    import matplotlib.pyplot as plt

    page, axes = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
    softnesses = list(dict.fromkeys(row[1] for row in rows))
    for place, softness in enumerate(softnesses):
        for bonds, face in (("flips", f"C{place}"), ("fixed", "white")):
            some = [row for row in rows if row[1:3] == (softness, bonds)]
            if some:
                l, ratio, error = (np.array([row[column] for row in some]) for column in (3, 4, 5))
                axes.errorbar(
                    l + 0.06 * place, ratio, error, fmt="o-" if bonds == "flips" else "s--", lw=0.8,
                    ms=4, color=f"C{place}", mfc=face, label=f"Ξ = {softness:g}, {bonds}",
                )  # fmt: skip
    axes.axhline(1, color="black", lw=0.8)
    axes.set(xlabel="l", ylabel="⟨|u_lm|²⟩ / (A17)", ylim=(0, None), xticks=L)
    axes.legend(fontsize=7)
    page.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
