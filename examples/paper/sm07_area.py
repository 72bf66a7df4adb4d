"""Supplement 7: mean area of fluctuating vesicles, ⟨A⟩ / 4π r0², against N, κ, r0 and Ξ.

The area modulus holds the area at its target, that of the ordered mesh, which is a little less than
4π r0². What pushes it up is the entropy of the vertices and the repulsion of the heights: since
bending energy does not depend on size, scaling all coordinates gives, for kV = 0,

    2 kA (⟨A⟩ − A0) ⟨A⟩ / A0 = 3 N kBT + W,

W = −⟨Σ h ∂U_h/∂h⟩ of all heights. Bending drops out, so the area does not depend on κ. The runs are
those of `fig06_spectrum.py`.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fluctuations import AREA_MODULUS, SOFTNESS, heights_virial, vesicle_of
from openmmhelfrich.analysis import mean_with_error
from openmmhelfrich.vesicle import KBT
from spectra import FULL, QUICK, Point, measure, named, points_of


def main():
    figure = Figure("sm07", "SM 7", "Mean area of fluctuating vesicles", __doc__)
    size = figure.choose(FULL, QUICK)
    runs = measure(points_of(size), size["samples"], figure)
    areas = {point: mean_area(of_point) for point, of_point in runs.items()}
    figure.parameters("the runs of Fig. 6; targets A0 are the areas of the ordered meshes")
    check(figure, size, runs, areas)
    draw(figure, size, areas)
    figure.finish()


def mean_area(runs):
    """⟨A⟩/4π r0² and its error, from the frames of all samples."""
    return mean_with_error(np.transpose([run["area"] for run in runs]))[:2]


def strain(point, area):
    """⟨A⟩/A0 − 1 and its error."""
    return area[0] / target(point) - 1, area[1] / target(point)


def target(point):
    """A0 / 4π r0²."""
    vesicle = vesicle_of(*point)
    return vesicle.area / (4 * np.pi * point.radius**2)


def virial_strain(point, runs):
    """The strain that the virial theorem demands, with the heights of the stored frames."""
    vesicle = vesicle_of(*point)
    work = [heights_virial(vesicle, frame) for run in runs for frame in run["snapshots"]]
    mean, error = mean_and_error(work)
    below = 2 * AREA_MODULUS * vesicle.area
    return (3 * point.num_vertices * KBT + mean) / below, error / below


def check(figure, size, runs, areas):
    base = Point(size["base"])
    reference, error = areas[base]
    for rigidity in size["rigidities"]:
        if rigidity != base.rigidity and base._replace(rigidity=rigidity) in areas:
            area, other = areas[base._replace(rigidity=rigidity)]
            both = np.hypot(error, other)
            figure.check(
                f"⟨A⟩/4πr0² at κ = {rigidity:g} kBT less that at 20 kBT",
                area - reference,
                0,
                max(3 * both, 1e-5),
                both,
            )
    found = [x for x in SOFTNESS if base._replace(softness=x) in areas]
    means, errors = np.array([areas[base._replace(softness=softness)] for softness in found]).T
    uncertain = np.hypot(errors[1:], errors[:-1])
    figure.claim(
        "⟨A⟩/4πr0²",
        ", ".join(f"{area:.5f}" for area in means) + f" at Ξ = {found}",
        "rises with Ξ (within 3 standard errors)",
        all(np.diff(means) > -3 * uncertain) and means[-1] - means[0] > 3 * uncertain.max(),
    )
    labelled = {f"Ξ = {x:g}": base._replace(softness=x) for x in found}
    labelled |= {
        f"r0 = {r:g} nm": base._replace(radius=r) for r in size["radii"] if r != base.radius
    }
    for label, point in labelled.items():
        measured, error = strain(point, areas[point])
        demanded, demanded_error = virial_strain(point, runs[point])
        both = np.hypot(error, demanded_error)
        figure.check(
            f"10⁴ (⟨A⟩/A0 − 1) at {label} against the virial theorem",
            1e4 * measured,
            1e4 * demanded,
            1e4 * max(3 * both, 0.03 * demanded),
            1e4 * both,
        )
    figure.table(
        "Mean areas:",
        ["vesicle", "⟨A⟩ / 4π r0²", "A0 / 4π r0²"],
        [
            [named(point), f"{area:.6f} ± {spread:.1g}", f"{target(point):.6f}"]
            for point, (area, spread) in areas.items()
        ],
    )


def draw(figure, size, areas):
    base = Point(size["base"])
    axes_of = {
        "num_vertices": ("N", size["vertices"]),
        "rigidity": ("κ / kBT", size["rigidities"]),
        "radius": ("r0 / nm", size["radii"]),
        "softness": ("Ξ", SOFTNESS),
    }
    page, axes = plt.subplots(1, 4, figsize=(11, 3), layout="constrained", sharey=True)
    for axis, (name, (label, values)) in zip(axes, axes_of.items(), strict=True):
        values = [value for value in values if base._replace(**{name: value}) in areas]
        points = [base._replace(**{name: value}) for value in values]
        means, errors = np.array([areas[point] for point in points]).T
        axis.errorbar(values, means, errors, fmt="o", label="⟨A⟩")
        axis.plot(values, [target(point) for point in points], "k_", ms=12, label="A0")
        axis.set(xlabel=label, xscale="log", xticks=values, xticklabels=[f"{v:g}" for v in values])
        axis.minorticks_off()
    axes[0].set_ylabel("area / 4π r0²")
    axes[0].legend()
    figure.save(page, caption="Mean area and its target")


if __name__ == "__main__":
    main()
