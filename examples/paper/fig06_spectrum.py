"""Fig. 6: fluctuation spectra ⟨|u_lm|²⟩ of a vesicle against l.

Six panels: number of vertices N, rigidity κ, radius r0, softness Ξ, the Young modulus Y(Ξ) of the
mesh, and the bending schemes of Jülicher and Gompper–Kroll (barycentric), as ratios to (A17).

(A17) holds for a fluid. A mesh whose vertices keep their neighbours resists shear a little, about
Y r0² = 0.15 N kBT however soft it is, and (A18) takes l = 2 below (A17) by a share that grows with
N kBT / κ. `fig06b_shear.py` measures that modulus by itself, from the displacements of vertices
within the surface, and predicts the spectrum from it.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure
from fluctuations import RADIUS, SOFTNESS
from mesh_corrections import SOFTENING, bending_ratio, fit_meshes, fit_shear, shear_ratio
from openmmhelfrich.analysis import fit_young, mean_shape, mean_with_error, theory
from spectra import (
    FRAMES_PER_PERIOD,
    FULL,
    PERIODS,
    QUICK,
    SCHEMES,
    Point,
    measure,
    named,
    points_of,
    ratio_of,
    spectrum_of,
)

# Y is read off the small l, where the shear modulus matters and the mesh resolves bending. From
# l = 6 on the mean shape of a hard ordered mesh counts too, which is icosahedral.
LARGEST_FITTED = 5

# The common fit is to meshes of so many vertices and more: coarser ones are softer in other ways.
FINE = 1000


def main():
    figure = Figure("fig06", "Fig. 6 a–f", "Fluctuation spectra of vesicles", __doc__)
    size = figure.choose(FULL, QUICK)
    runs = measure(points_of(size), size["samples"], figure)
    spectra = {point: spectrum_of(of_point) for point, of_point in runs.items()}
    figure.parameters(
        f"N = {size['base']}, κ = 20 kBT, r0 = 1000 nm, Ξ = 0.037, Jülicher where not varied; "
        f"kV = 0; LangevinMiddle, 300 K, γ = ω_2, Δt = 0.075 √Ξ τ_fastest, ordered meshes; "
        f"{size['samples']} samples of {PERIODS} τ_2"
    )
    check(figure, size, runs, spectra)
    base = Point(size["base"])
    note_ten_frames(figure, base, runs[base])
    tabulate(figure, runs, spectra)
    draw(figure, size, spectra)
    figure.finish()


def mean_ratio(runs, point, first, last):
    """Mean of the ratio to (A17) over l = first … last, each l alike, and its error."""
    modes = np.array([run["fit"] for run in runs], dtype=float) ** 2
    ratios = [
        modes[:, :, l**2 : (l + 1) ** 2].mean(axis=2) / theory.fluid_spectrum(l, point.rigidity)
        for l in range(first, last + 1)
    ]
    # Frame by frame, since what one l has in excess others may lack.
    found = mean_with_error(np.mean(ratios, axis=0).T)
    return found.mean, found.error


def young_of(found, point):
    """Y r0² over N kBT and its error from the smallest l, see `mesh_corrections.py`."""
    l, ratio, error = ratio_of(found, point)
    chosen = slice(0, LARGEST_FITTED - 1)
    return fit_shear(
        point.num_vertices,
        point.rigidity,
        l[chosen],
        ratio[chosen],
        error[chosen],
        SOFTENING[point.scheme],
    )


def check(figure, size, runs, spectra):
    base = Point(size["base"])
    if not figure.quick:
        for scheme in SCHEMES:
            check_common_fit(figure, runs, spectra, scheme)
    compared = {
        "Jülicher": base,
        "GK barycentric": base._replace(scheme="GompperKrollBarycentric"),
        **{f"r0 = {r:g} nm": base._replace(radius=r) for r in size["radii"] if r != base.radius},
    }
    # The largest l that a mesh resolves within a third or so: 10 for N = 1002.
    last = int(base.num_vertices**0.5 / 3)
    means = {name: mean_ratio(runs[point], point, 2, last) for name, point in compared.items()}
    if not figure.quick:
        for name, (mean, error) in means.items():
            figure.check(
                f"⟨|u|²⟩ over (A17), mean of l = 2 … {last}, {name}", mean, 1, 2 * error, error
            )
    reference = means.pop("Jülicher")
    for name, mean in means.items():
        what = f"mean over l = 2 … {last}, {name}, less that of Jülicher at 1000 nm"
        figure.check_same(what, mean, reference)
    _, ratio, error = ratio_of(spectra[base], base)
    near = abs(ratio[: last - 1] - 1) < 2 * error[: last - 1]
    if not figure.quick:
        figure.claim(
            f"⟨|u|²⟩ of each l = 2 … {last} on (A17), Jülicher",
            f"{near.sum()} of {len(near)} within two standard errors",
            "all",
            near.all(),
        )
    for softness in SOFTNESS[1:]:
        # As the paper does it: nothing but (A18) with the given κ.
        harder = base._replace(softness=softness)
        plain = fit_young(spectra[harder], RADIUS, harder.rigidity, lmax=LARGEST_FITTED)
        measured, error = plain.young_over_kT * RADIUS**2, plain.young_error * RADIUS**2
        # (45) was measured at N = 1002; the modulus of a mesh is proportional to its vertices.
        expected = theory.young_modulus(softness) * RADIUS**2 * base.num_vertices / 1002
        figure.check(
            f"Y r0²/kBT at Ξ = {softness:g} against (45)", measured, expected, 3 * error, error
        )


def fluctuating(runs, found, point):
    """As `ratio_of`, without what the mean shape adds."""
    l, ratio, error = ratio_of(found, point)
    still = mean_shape([run["fit"] for run in runs]).share
    return l, ratio * (1 - still[2:]), error


def check_common_fit(figure, runs, spectra, scheme):
    """The rigidity that the soft meshes of a scheme together have, and their corrections."""
    label = SCHEMES[scheme]
    fitted = 0
    for least in (FINE, 0):
        soft_meshes = [
            (point.num_vertices, point.rigidity, *fluctuating(runs[point], found, point))
            for point, found in spectra.items()
            if (point.softness, point.scheme) == (SOFTNESS[0], scheme)
            and point.num_vertices > least
        ]
        if len(soft_meshes) == fitted:
            # There are none of fewer vertices.
            continue
        fitted = len(soft_meshes)
        (rigidity, c, young), errors, quality = fit_meshes(soft_meshes)
        vesicles = f"{fitted} soft vesicle{'s' * (fitted > 1)} of N > {least}"
        if least:
            figure.check(
                f"rigidity in the spectra over κ, {label}, {vesicles}",
                rigidity,
                1,
                0.05,
                errors[0],
            )
        figure.note(
            f"{label}, {vesicles}, l ≤ √N/3, without mean shapes, formula of mesh_corrections.py: "
            f"a = {rigidity:.3f} ± {errors[0]:.3f}, c = {c:.2f} ± {errors[1]:.2f}, "
            f"y = {young:.3f} ± {errors[2]:.3f}, χ² per degree of freedom {quality:.2f}"
        )


def note_ten_frames(figure, point, runs):
    """What ten frames τ_2 apart show of the deviations: what a run of the paper's Table III has."""
    modes = np.array([run["fit"][::FRAMES_PER_PERIOD][:10] for run in runs], dtype=float)
    l = np.arange(2, int(point.num_vertices**0.5 / 3) + 1)
    fluid = theory.fluid_spectrum(l, point.rigidity)
    powers = [(modes[:, :, j**2 : (j + 1) ** 2] ** 2).reshape(len(runs), -1) for j in l]
    ratio = np.array([power.mean(axis=1) for power in powers]) / fluid[:, None]
    # Frames and m's are taken as independent, which they nearly are.
    error = np.array([power.std(axis=1) / power.shape[1] ** 0.5 for power in powers])
    near = abs(ratio - 1) < 2 * error / fluid[:, None]
    means = ratio.mean(axis=0)
    figure.note(
        f"Of ten frames τ_2 apart, those of a run of Table III, l = 2 … {l[-1]} together are "
        f"{means.mean():.2f} of (A17), from run to run ± {means.std(ddof=1):.2f}, and "
        f"{near.mean():.0%} of the values lie within two of their standard errors of it."
    )


def tabulate(figure, runs, spectra):
    """Every spectrum in figures, up to l = 10, and the Y that its smallest l have."""
    shown = range(2, 11)
    rows, sums = [], []
    for point, found in spectra.items():
        _, ratio, error = ratio_of(found, point)
        _, summed, _ = ratio_of(spectrum_of(runs[point], "vertices"), point)
        young, young_error = young_of(found, point)
        temperature = np.mean([run["temperature"] for run in runs[point]])
        still = mean_shape([run["fit"] for run in runs[point]])
        count = min(len(shown), len(ratio))
        gap = [""] * (len(shown) - count)
        values = zip(ratio[:count], error[:count], strict=True)
        rows.append(
            [named(point), f"{len(runs[point])}", f"{temperature:.1f}"]
            + [f"{value:.2f} ± {uncertain:.2f}" for value, uncertain in values]
            + gap
            + [f"{young:.2f} ± {young_error:.2f}"]
            + [f"{still.share[6]:.1%} ± {still.error[6]:.1%}"]
        )
        sums.append([named(point)] + [f"{value:.2f}" for value in summed[:count]] + gap)
    orders = [f"l = {l}" for l in shown]
    figure.table(
        "⟨|u_lm|²⟩ over (A17), by the least-squares fit of `mode_amplitudes`, and what of l = 6 "
        "does not fluctuate but is a mean shape, with corners of an icosahedron at the twelve "
        "vertices of five neighbours:",
        ["vesicle", "runs", "T / K", *orders, "Y r0² / N kBT", "still at l = 6"],
        rows,
    )
    figure.table(
        "The same by the paper's sum over vertices, in which modes leak into those of larger l:",
        ["vesicle", *orders],
        sums,
    )


# --- the picture -----------------------------------------------------------------------------


def draw(figure, size, spectra):
    """The panels as the paper has them, and again as ratios to (A17), where deviations show."""
    for relative, suffix, caption in (
        (False, "", "Spectra; lines: (A18) with the Y of panel e, softened by mesh_corrections.py"),
        (True, "_ratio", "The same over (A17)"),
    ):
        page, axes = plt.subplots(2, 3, figsize=(11, 6.6), layout="constrained")
        draw_panels(axes, size, spectra, relative)
        figure.save(page, suffix, caption)


def draw_panels(axes, size, spectra, relative):
    base = Point(size["base"])
    a, b, c, d, e, f = axes.flat
    panels = (
        (a, "a  number of vertices", "num_vertices", size["vertices"], "N = {:d}"),
        (b, "b  rigidity", "rigidity", size["rigidities"], "κ = {:g} kBT"),
        (c, "c  radius", "radius", size["radii"], "r0 = {:g} nm"),
        (d, "d  softness", "softness", SOFTNESS, "Ξ = {:g}"),
        (f, "f  bending scheme", "scheme", SCHEMES, "{}"),
    )
    for axis, title, name, values, form in panels:
        for shift, value in enumerate(values):
            point = base._replace(**{name: value})
            label = form.format(SCHEMES.get(value, value))
            show(axis, spectra[point], point, label, shift, relative)
        axis.set_title(title, loc="left")
        axis.set(xlabel="l", xscale="log")
        axis.set_xticks([2, 3, 4, 6, 8, 12, 20, 30], ["2", "3", "4", "6", "8", "12", "20", "30"])
        axis.minorticks_off()
        axis.legend(fontsize=8)
        if relative:
            axis.axhline(1, color="black", linewidth=0.8)
            axis.set(ylabel="⟨|u_lm|²⟩ / (A17)", ylim=(0, 3 if name == "softness" else 2.2))
        else:
            axis.set(ylabel="⟨|u_lm|²⟩", yscale="log")
    found = [base._replace(softness=softness) for softness in SOFTNESS]
    young = np.array([young_of(spectra[point], point) for point in found])
    e.errorbar(SOFTNESS, *young.T, fmt="o", label="measured")
    grid = np.geomspace(0.02, 0.8, 50)
    e.plot(grid, theory.young_modulus(grid) * 1e6 / 1002, color="black", lw=0.8, label="(45)")
    e.set(xscale="log", yscale="log", xlabel="Ξ", ylabel="Y r0² / N kBT")
    e.set_title("e  Young modulus", loc="left")
    e.legend(fontsize=8)


def show(axis, found, point, label, shift, relative):
    """One spectrum with error bars, and the line of (A18) with the modulus fitted to it."""
    l, ratio, error = ratio_of(found, point)
    young, _ = young_of(found, point)
    grid = np.linspace(2, l[-1], 100)
    mesh = point.num_vertices, point.rigidity, grid
    curve = 1 / (bending_ratio(*mesh, SOFTENING[point.scheme]) + young * shear_ratio(*mesh))
    scale, grid_scale = (
        1 if relative else theory.fluid_spectrum(values, point.rigidity) for values in (l, grid)
    )
    color = f"C{shift}"
    # Points of spectra that coincide are moved apart a little.
    x = l * 1.01**shift
    axis.errorbar(x, scale * ratio, scale * error, fmt="o", ms=3.5, color=color, label=label)
    axis.plot(grid, grid_scale * curve, color=color, linewidth=0.7)


if __name__ == "__main__":
    main()
