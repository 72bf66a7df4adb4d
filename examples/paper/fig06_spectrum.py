"""Fig. 6: fluctuation spectra ⟨|u_lm|²⟩ of a vesicle against l.

Six panels: number of vertices N, rigidity κ, radius r0, softness Ξ, the Young modulus Y(Ξ) of the
mesh, and the bending schemes of Jülicher and Gompper–Kroll (barycentric), as ratios to (A17).

(A17) holds for a fluid. A mesh whose vertices keep their neighbours resists shear a little, about
Y r0² = 0.15 N kBT however soft it is, and (A18) takes l = 2 below (A17) by a share that grows with
N kBT / κ. `fig06b_shear.py` measures that modulus by itself, from the displacements of vertices
within the surface, and predicts the spectrum from it.
"""

from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure
from fluctuations import RADIUS, SOFTNESS, VERSION, fluctuate
from mesh_corrections import bending_ratio, fit_meshes, fit_shear, shear_ratio
from openmmhelfrich.analysis import Spectrum, fit_young, spectrum, theory
from openmmhelfrich.sweep import Cache

# Numbers of samples: at the paper's parameters, of small meshes, of other radii and schemes, and of
# all other points.
FULL = {
    "base": 1002,
    "vertices": (252, 492, 1002, 1962, 4002),
    "rigidities": (10.0, 20.0, 40.0),
    "radii": (500.0, 1000.0, 2000.0),
    "samples": 10,
    "small": 10,
    "same": 10,
    "few": 4,
}
MEDIUM = {**FULL, "vertices": (252, 492, 1002, 1962), "small": 4, "same": 2, "few": 2}
QUICK = {
    "base": 252,
    "vertices": (252,),
    "rigidities": (20.0, 40.0),
    "radii": (500.0, 1000.0),
    "samples": 2,
    "small": 2,
    "same": 2,
    "few": 2,
}
PERIODS = 10
SCHEMES = {"Julicher": "Jülicher", "GompperKrollBarycentric": "GK barycentric"}

# Y is read off the small l, where the shear modulus matters and the mesh resolves bending.
LARGEST_FITTED = 6


class Point(NamedTuple):
    """Parameters of a vesicle: N, κ in kBT, r0 in nm, Ξ and the name of the bending scheme."""

    num_vertices: int
    rigidity: float = 20.0
    radius: float = RADIUS
    softness: float = SOFTNESS[0]
    scheme: str = "Julicher"


def main():
    figure = Figure("fig06", "Fig. 6 a–f", "Fluctuation spectra of vesicles", __doc__)
    size = figure.choose(FULL, QUICK, MEDIUM)
    runs = measure(points_of(size), figure)
    spectra = {point: pooled(of_point, "fit") for point, of_point in runs.items()}
    figure.parameters(
        f"N = {size['base']}, κ = 20 kBT, r0 = 1000 nm, Ξ = 0.037, Jülicher where not varied; "
        f"kV = 0; LangevinMiddle, 300 K, γ = ω_2, Δt = 0.075 √Ξ τ_fastest, ordered meshes; "
        f"{size['samples']} samples of {PERIODS} τ_2 ({size['same']} of other r0 and schemes, "
        f"{size['small']} of N < 1000, {size['few']} of other N, κ, Ξ)"
    )
    if figure.size == "medium":
        figure.reduced("Fewer samples of all points but the first, and no N = 4002.")
    check(figure, size, spectra)
    note(figure, runs, spectra)
    draw(figure, size, spectra)
    figure.finish()


# --- the runs --------------------------------------------------------------------------------


def points_of(size):
    """The points that are needed, and the number of samples of each."""
    base = Point(size["base"])
    wanted = {}

    def add(samples, **changes):
        point = base._replace(**changes)
        wanted[point] = max(samples, wanted.get(point, 0))

    add(size["samples"])
    for scheme in SCHEMES:
        add(size["same"], scheme=scheme)
    for radius in size["radii"]:
        add(size["same"], radius=radius)
    for num_vertices in size["vertices"]:
        add(size["small"] if num_vertices < 1000 else size["few"], num_vertices=num_vertices)
    for rigidity in size["rigidities"]:
        add(size["few"], rigidity=rigidity)
    for softness in SOFTNESS:
        add(size["few"], softness=softness)
    return wanted


def arguments_of(point, samples):
    """The arguments of `fluctuate` for the samples of one point."""
    return [
        {
            **point._asdict(),
            # Half of the largest l that the mesh has, l_max = √N: what the paper shows.
            "lmax": int(point.num_vertices**0.5 / 2),
            "periods": PERIODS,
            "frames_per_period": 8,
            "settle_periods": 2,
            "seed": first_seed(point) + seed,
        }
        for seed in range(samples)
    ]


def first_seed(point):
    """Seeds that are others for each N, κ, r0 and scheme, so that all samples are independent.

    In reduced units, which Δt and γ follow, equal seeds mean equal noise: large modes then move
    alike whatever the scheme is, and vesicles of all radii are one.
    """
    usual = Point(1002)
    return (
        1
        + abs(point.num_vertices - usual.num_vertices)
        + round(1000 * abs(point.rigidity - usual.rigidity))
        + round(10 * abs(point.radius - usual.radius))
        + 7000 * (point.scheme != usual.scheme)
    )


def measure(points, figure):
    """The runs of each point: {point: [result, …]}.

    With --plot-only these are the runs that are stored, be they all or not.
    """
    arguments = {point: arguments_of(point, samples) for point, samples in points.items()}
    if figure.plot_only:
        store = Cache(figure.results / "cache")
        name = fluctuate.__name__
        wanted = sum(len(of_point) for of_point in arguments.values())
        arguments = {
            point: [
                one for one in of_point if store.path(name, store.key(name, one, VERSION)).exists()
            ]
            for point, of_point in arguments.items()
        }
        arguments = {point: of_point for point, of_point in arguments.items() if of_point}
        found = sum(len(of_point) for of_point in arguments.values())
        if found < wanted:
            figure.reduced(f"{found} of {wanted} runs of Fig. 6")
    flat = [one for of_point in arguments.values() for one in of_point]
    results = iter(figure.sweep(fluctuate, flat, VERSION))
    return {point: [next(results) for _ in of_point] for point, of_point in arguments.items()}


# --- what they mean --------------------------------------------------------------------------


def pooled(runs, name):
    """Spectrum of several samples: the mean over them, with the error of their mean."""
    each = [spectrum(run[name]) for run in runs]
    return Spectrum(
        each[0].l,
        np.mean([one.mean for one in each], axis=0),
        np.sqrt(np.sum([one.error**2 for one in each], axis=0)) / len(each),
        np.mean([one.correlation_time for one in each], axis=0),
    )


def ratio_of(found, point):
    """Modes l = 2 … lmax, ⟨|u_lm|²⟩ over (A17), and its error."""
    l = found.l[2:]
    fluid = theory.fluid_spectrum(l, point.rigidity)
    return l, found.mean[2:] / fluid, found.error[2:] / fluid


def mean_ratio(found, point, first, last):
    """Mean of the ratio to (A17) over l = first … last, each l alike, and its error."""
    l, ratio, error = ratio_of(found, point)
    chosen = (l >= first) & (l <= last)
    return ratio[chosen].mean(), np.sqrt(np.sum(error[chosen] ** 2)) / chosen.sum()


def young_of(found, point):
    """Y r0² over N kBT and its error from the smallest l, see `mesh_corrections.py`."""
    l, ratio, error = ratio_of(found, point)
    chosen = slice(0, LARGEST_FITTED - 1)
    return fit_shear(point.num_vertices, point.rigidity, l[chosen], ratio[chosen], error[chosen])


def check(figure, size, spectra):
    base = Point(size["base"])
    soft_meshes = [
        (point.num_vertices, point.rigidity, *ratio_of(found, point))
        for point, found in spectra.items()
        if point.softness == base.softness
    ]
    if not figure.quick:
        note_common_fit(figure, soft_meshes)
    named = {
        "Jülicher": base,
        "GK barycentric": base._replace(scheme="GompperKrollBarycentric"),
        **{f"r0 = {r:g} nm": base._replace(radius=r) for r in size["radii"] if r != base.radius},
    }
    # The largest l that a mesh resolves within a third or so: 10 for N = 1002.
    last = int(base.num_vertices**0.5 / 3)
    means = {
        name: mean_ratio(spectra[point], point, 2, last)
        for name, point in named.items()
        if point in spectra
    }
    if not figure.quick:
        for name, (mean, error) in means.items():
            figure.check(
                f"⟨|u|²⟩ over (A17), mean of l = 2 … {last}, {name}", mean, 1, 2 * error, error
            )
    reference, reference_error = means.pop("Jülicher")
    for name, (mean, error) in means.items():
        both = np.hypot(error, reference_error)
        # Radii are the same vesicle in other units; schemes differ where the mesh is coarse.
        tolerance = 3 * both if name.startswith("r0") else max(3 * both, 0.1)
        figure.check(
            f"the same, {name} less Jülicher at 1000 nm", mean - reference, 0, tolerance, both
        )
    hardest = base._replace(softness=SOFTNESS[-1])
    if hardest not in spectra:
        return
    # As the paper does it: nothing but (A18) with the given κ.
    plain = fit_young(spectra[hardest], RADIUS, hardest.rigidity, lmax=LARGEST_FITTED)
    measured, error = plain.young_over_kT * RADIUS**2, plain.young_error * RADIUS**2
    # (45) was measured at N = 1002; the modulus of a mesh is proportional to its vertices.
    expected = theory.young_modulus(SOFTNESS[-1]) * RADIUS**2 * base.num_vertices / 1002
    figure.check("Y r0²/kBT at Ξ = 0.59 against (45)", measured, expected, 0.3 * expected, error)


def note_common_fit(figure, soft_meshes):
    """The fluid's rigidity that all soft meshes together have, and their corrections."""
    (rigidity, c, young), errors, quality = fit_meshes(soft_meshes)
    figure.check("rigidity in all soft spectra over κ", rigidity, 1, 0.05, errors[0])
    figure.note(
        "All soft meshes, l ≤ √N/3, formula of mesh_corrections.py: "
        f"a = {rigidity:.3f} ± {errors[0]:.3f}, c = {c:.2f} ± {errors[1]:.2f}, "
        f"y = {young:.3f} ± {errors[2]:.3f}, χ² per degree of freedom {quality:.2f}"
    )


def note(figure, runs, spectra):
    """Every spectrum in figures."""
    for point, found in spectra.items():
        _, ratio, error = ratio_of(found, point)
        _, sums, _ = ratio_of(pooled(runs[point], "vertices"), point)
        young, young_error = young_of(found, point)
        temperature = np.mean([run["temperature"] for run in runs[point]])
        values = ", ".join(f"{r:.3f} ± {e:.3f}" for r, e in zip(ratio, error, strict=True))
        figure.note(
            f"N = {point.num_vertices}, κ = {point.rigidity:g} kBT, r0 = {point.radius:g} nm, "
            f"Ξ = {point.softness:g}, {SCHEMES[point.scheme]}, {len(runs[point])} samples, "
            f"{temperature:.1f} K: over (A17), l = 2 …: {values}; "
            f"by the paper's vertex sum {', '.join(f'{value:.2f}' for value in sums)}; "
            f"Y r0² = ({young:.3f} ± {young_error:.3f}) N kBT"
        )


# --- the picture -----------------------------------------------------------------------------


def draw(figure, size, spectra):
    base = Point(size["base"])
    panels = (
        ("a  number of vertices", "N", "num_vertices", size["vertices"], "{:d}"),
        ("b  rigidity", "κ", "rigidity", size["rigidities"], "{:g} kBT"),
        ("c  radius", "r0", "radius", size["radii"], "{:g} nm"),
        ("d  softness", "Ξ", "softness", SOFTNESS, "{:g}"),
    )
    page, axes = plt.subplots(2, 3, figsize=(11, 6.6), layout="constrained")
    a, b, c, d, e, f = axes.flat
    for axis, (title, symbol, name, values, form) in zip((a, b, c, d), panels, strict=True):
        for shift, value in enumerate(values):
            point = base._replace(**{name: value})
            if point not in spectra:
                continue
            show(axis, spectra[point], point, f"{symbol} = {form.format(value)}", shift)
        axis.set_title(title, loc="left")
    for shift, (scheme, label) in enumerate(SCHEMES.items()):
        point = base._replace(scheme=scheme)
        if point not in spectra:
            continue
        show(f, spectra[point], point, label, shift)
    f.set_title("f  bending scheme", loc="left")
    for axis in (a, b, c, d, f):
        axis.axhline(1, color="black", linewidth=0.8)
        axis.set(xlabel="l", ylabel="⟨|u_lm|²⟩ / (A17)", xscale="log", ylim=(0, 1.5))
        axis.set_xticks([2, 3, 4, 6, 8, 12], ["2", "3", "4", "6", "8", "12"])
        axis.minorticks_off()
        axis.legend(fontsize=8, loc="lower right")
    found = {x: base._replace(softness=x) for x in SOFTNESS if base._replace(softness=x) in spectra}
    young = np.array([young_of(spectra[point], point) for point in found.values()])
    e.errorbar(list(found), *young.T, fmt="o", label="measured")
    grid = np.geomspace(0.02, 0.8, 50)
    e.plot(grid, theory.young_modulus(grid) * 1e6 / 1002, color="black", lw=0.8, label="(45)")
    e.set(xscale="log", yscale="log", xlabel="Ξ", ylabel="Y r0² / N kBT")
    e.set_title("e  Young modulus", loc="left")
    e.legend(fontsize=8)
    figure.save(page, caption="Spectra over (A17), thin lines: mesh_corrections.py")


def show(axis, found, point, label, shift):
    """One spectrum with error bars, and (A18) with the modulus that was fitted to it."""
    l, ratio, error = ratio_of(found, point)
    color = f"C{shift}"
    axis.errorbar(l, ratio, error, fmt="o", ms=3.5, color=color, label=label)
    young, _ = young_of(found, point)
    grid = np.linspace(2, l[-1], 100)
    shear = young * shear_ratio(point.num_vertices, point.rigidity, grid)
    curve = 1 / (bending_ratio(point.num_vertices, grid) + shear)
    axis.plot(grid, curve, color=color, linewidth=0.7)


if __name__ == "__main__":
    main()
