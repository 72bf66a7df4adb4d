"""Fig. 6: fluctuation spectra ⟨|u_lm|²⟩ of a vesicle against l.

    python fig06_spectrum.py            # everything: hours on one core
    python fig06_spectrum.py --quick    # N = 252 and fewer samples, about a minute

Six panels: number of vertices N, rigidity κ, radius r0, softness Ξ, the Young modulus Y(Ξ) of the
mesh, and the bending schemes of Jülicher and Gompper–Kroll (barycentric). LangevinMiddle at 300 K
with kV = 0; ten samples of 10 τ_2 each at the paper's parameters, four elsewhere.

(A17) holds for a fluid. A mesh whose vertices keep their neighbours is none at the largest scales:
it resists shear, and (A18) with Y r0² ≈ 0.15 N kBT is below (A17) for l = 2. `fig06_shear.py`
measures that modulus by itself, from the displacement of vertices within the surface.

doi:10.1103/PhysRevE.108.015301
"""

import math
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure
from fluctuations import RADIUS, SOFTNESS, VERSION, fluctuate
from openmmhelfrich.analysis import spectrum, theory
from scipy.optimize import curve_fit

# Full size and --quick. Fewer vertices make cheaper steps and shorter periods.
FULL = {
    "base": 1002,
    "vertices": (252, 492, 1002, 1962),
    "rigidities": (10.0, 20.0, 40.0),
    "radii": (500.0, 1000.0, 2000.0),
    "samples": 10,
    "few": 4,
    "periods": 10,
}
QUICK = {
    "base": 252,
    "vertices": (252, 492),
    "rigidities": (20.0, 40.0),
    "radii": (500.0, 1000.0),
    "samples": 4,
    "few": 2,
    "periods": 10,
}
SCHEMES = {"Julicher": "Jülicher", "GompperKrollBarycentric": "GK barycentric"}

# Y(Ξ) is read off the small l, where the shear modulus matters and bending is well resolved.
FIT_MODES = np.arange(2, 7)


def main():
    figure = Figure("fig06", "Fig. 6 a–f", "Fluctuation spectra of vesicles", __doc__)
    size = figure.choose(FULL, QUICK)
    spectra = measure(size, figure)
    young = {point: fit_young(found, point) for point, found in spectra.items()}
    show(spectra, young)
    figure.parameters(
        f"LangevinMiddle, 300 K, γ = ω_2, Δt = half of 0.1 √Ξ τ_fastest, kV = 0; ordered meshes; "
        f"N = {size['base']}, κ = 20 kBT, r0 = 1000 nm, Ξ = 0.037, Jülicher where not varied; "
        f"{size['samples']} samples of {size['periods']} τ_2 (others: {size['few']}), 8 frames a τ_2"
    )
    check(figure, size, spectra, young)
    draw(figure, size, spectra, young)
    figure.finish()


# --- the runs --------------------------------------------------------------------------------


class Point(NamedTuple):
    """Parameters of a vesicle: N, κ in kBT, r0 in nm, Ξ and the name of the bending scheme."""

    num_vertices: int
    rigidity: float = 20.0
    radius: float = RADIUS
    softness: float = SOFTNESS[0]
    scheme: str = "Julicher"


def points_of(size):
    """The points that are needed, and the number of samples of each."""
    base = Point(size["base"])
    wanted = {}

    def add(samples, **changes):
        point = base._replace(**changes)
        wanted[point] = max(samples, wanted.get(point, 0))

    add(size["samples"])
    for scheme in SCHEMES:
        add(size["samples"], scheme=scheme)
    for radius in size["radii"]:
        add(size["samples"], radius=radius)
    for num_vertices in size["vertices"]:
        # Short periods and cheap steps make small meshes nearly free.
        add(size["samples"] if num_vertices < 1000 else size["few"], num_vertices=num_vertices)
    for rigidity in size["rigidities"]:
        add(size["few"], rigidity=rigidity)
    for softness in SOFTNESS:
        add(size["few"], softness=softness)
    return wanted


def runs_of(point, samples, periods):
    """The arguments of `fluctuate` for the samples of one point."""
    return [
        {
            **point._asdict(),
            "lmax": lmax_of(point.num_vertices),
            "periods": periods,
            "frames_per_period": 8,
            "settle_periods": 4,
            "seed": seed + 1,
        }
        for seed in range(samples)
    ]


def lmax_of(num_vertices):
    """Half of the largest l that the mesh has, l_max = √N: what the paper shows."""
    return int(num_vertices**0.5 / 2)


class Pooled:
    """Spectrum of several samples: the mean over them, with the error of their mean."""

    def __init__(self, runs, name):
        each = [spectrum(run[name]) for run in runs]
        self.l = each[0].l
        self.mean = np.mean([one.mean for one in each], axis=0)
        self.error = np.sqrt(np.sum([one.error**2 for one in each], axis=0)) / len(each)
        self.time = len(runs) * len(runs[0][name]) * runs[0]["interval"]
        self.temperature = np.mean([run["temperature"] for run in runs])


def measure(size, figure):
    """Spectra by point, each with both quadratures: {point: {"fit": …, "vertices": …}}."""
    runs = {
        point: runs_of(point, samples, size["periods"])
        for point, samples in points_of(size).items()
    }
    flat = [run for of_point in runs.values() for run in of_point]
    results = iter(figure.sweep(fluctuate, flat, VERSION))
    spectra = {}
    for point, of_point in runs.items():
        found = [next(results) for _ in of_point]
        spectra[point] = {name: Pooled(found, name) for name in ("fit", "vertices")}
    return spectra


# --- what they mean --------------------------------------------------------------------------


def ratio_of(found, point):
    """⟨|u_lm|²⟩ over (A17), with its error, for l = 2 … lmax."""
    l = found.l[2:]
    fluid = theory.fluid_spectrum(l, point.rigidity)
    return l, found.mean[2:] / fluid, found.error[2:] / fluid


def fit_young(found, point):
    """Y r0² over kBT and its error from a least-squares fit of (A18) to the smallest l."""
    modes = FIT_MODES[FIT_MODES <= found["fit"].l[-1]]
    mean, error = found["fit"].mean[modes], found["fit"].error[modes]

    def model(l, young):
        # curve_fit may try a negative modulus, which the theory function refuses.
        n = l * (l + 1)
        return 1 / (1 / theory.fluid_spectrum(l, point.rigidity) + young * 3 * (n - 2) / (3 * n - 2))

    value, covariance = curve_fit(model, modes, mean, [0.0], sigma=error, absolute_sigma=True)
    return value[0], math.sqrt(covariance[0, 0])


def mean_ratio(found, point, first, last):
    """Weighted mean of the ratio to (A17) over l = first … last, and its error."""
    l, ratio, error = ratio_of(found, point)
    chosen = (l >= first) & (l <= last)
    weights = 1 / error[chosen] ** 2
    return (ratio[chosen] @ weights) / weights.sum(), 1 / math.sqrt(weights.sum())


def show(spectra, young):
    print("\n⟨|u_lm|²⟩ over (A17), fitted amplitudes; Y r0²/N kBT from (A18), l = 2 … 6")
    for point, found in spectra.items():
        l, ratio, error = ratio_of(found["fit"], point)
        values = " ".join(f"{r:.3f}±{e:.3f}" for r, e in zip(ratio, error, strict=True))
        y, dy = (value / point.num_vertices for value in young[point])
        print(
            f"N {point.num_vertices} κ {point.rigidity:g} kBT r0 {point.radius:g} nm "
            f"Ξ {point.softness:g} {point.scheme}: "
            f"{found['fit'].time / 1e6:.2f} µs, {found['fit'].temperature:.1f} K\n"
            f"    l = 2 …: {values}\n    Y r0²/N kBT = {y:.3f} ± {dy:.3f}"
        )
        _, sums, _ = ratio_of(found["vertices"], point)
        print("    paper's vertex sum: " + " ".join(f"{r:.3f}" for r in sums))


def check(figure, size, spectra, young):
    base = Point(size["base"])
    last = min(10, lmax_of(size["base"]))
    for name, changes in (
        ("Jülicher", {}),
        ("GK barycentric", {"scheme": "GompperKrollBarycentric"}),
        *((f"r0 = {radius:g} nm", {"radius": radius}) for radius in size["radii"]),
    ):
        point = base._replace(**changes)
        mean, error = mean_ratio(spectra[point]["fit"], point, 2, last)
        figure.check(
            f"mean of ⟨|u|²⟩ / (A17), l = 2 … {last}, {name}", mean, 1, 2 * error, error
        )
        _, ratio, errors = ratio_of(spectra[point]["fit"], point)
        figure.note(f"{name}: ratio for l = 2 … " + ", ".join(
            f"{r:.3f} ± {e:.3f}" for r, e in zip(ratio, errors, strict=True)
        ))
    slope, error = fit_slope(young, base)
    figure.check("Y at Ξ = 0.59 over that of (45)", slope, 1, 0.3, error)
