"""Beside Fig. 6: the resistance of fluid meshes to shear, and what it does to the spectrum.

Vertices of a mesh that keep their neighbours cannot flow without end. How much they resist is
measured here without undulations: rotations t_lm of the vertices within the surface would be free
in a fluid; their mean squares give the shear modulus μ (see `displacements.py`). With the modulus K
of the vertex density it predicts

    ⟨|u_lm|²⟩ / (A17) = 1 / [b_l + 4 μK r0² (n−2) / (μ(n−2) + K n) / κ n (n−2)],  n = l (l+1),

without a fit of the shear modulus; b_l, close to 1, is the softening of bending by short waves and
by the spacing of the vertices, whose c comes from the spectra, see `mesh_corrections.py`. The runs
are those of `fig06_spectrum.py`.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure
from displacements import moduli, shear_modulus
from fluctuations import SOFTNESS
from mesh_corrections import SOFTENING, bending_ratio
from openmmhelfrich.analysis import theory
from spectra import FULL, QUICK, measure, named, points_of, ratio_of, spectrum_of

MODES = np.array([2, 3, 4, 5])

# What the entropy of undulations alone gives. Heights of a sheared triangular lattice cost more
# bending energy on average: the logarithm of its cotangent Laplacian, averaged over the Brillouin
# zone, rises by 1.307 ε² for a stretch of e^ε along one axis and e^−ε along the other, which is so
# many kBT a vertex whatever κ is, and a shear modulus of 1.307 / 8π.
UNDULATION_ENTROPY = 1.307 / (8 * np.pi)

BLOCKS = 10


def main():
    figure = Figure("fig06b", "Fig. 6, l = 2", "Shear modulus of fluid meshes", __doc__)
    size = figure.choose(FULL, QUICK)
    runs = measure(points_of(size), size["samples"], figure)
    elastic = {point: elasticity(of_point) for point, of_point in runs.items()}
    spectra = {point: spectrum_of(of_point) for point, of_point in runs.items()}
    figure.parameters("the runs of Fig. 6; displacements against the ordered mesh, l ≤ 8 fitted")
    soft = [point for point in runs if point.softness == SOFTNESS[0]]
    for point in soft:
        _, ratio, error = ratio_of(spectra[point], point)
        predicted, uncertain = prediction(point, elastic[point])
        both = np.hypot(error[0], uncertain[0])
        figure.check(
            f"l = 2 over (A17), {named(point)}", ratio[0], predicted[0], 3 * both, error[0]
        )
    tabulate(figure, elastic)
    draw(figure, elastic, spectra, soft)
    figure.finish()


def elasticity(runs):
    """Moduli of the mesh over N kBT for each of MODES, with errors.

    Returns
    -------
    dict
        "shear", μ r0² from the rotations; "density", K r0², and "bending", κ over kBT, from the
        covariance of shape and compression. Each has the shape (2, len(MODES)): values, errors.
    """
    num_vertices = runs[0]["snapshots"].shape[1]
    shape, compression, rotation = (
        np.concatenate([run[name] for run in runs]) for name in ("fit", "compression", "rotation")
    )
    shear = np.array([shear_modulus(rotation, l, BLOCKS) for l in MODES]).T / num_vertices
    three = np.array([moduli(shape, compression, l, BLOCKS) for l in MODES])
    return {
        "shear": shear,
        "density": three[:, :, 0].T / num_vertices,
        "bending": three[:, :, 2].T,
    }


def prediction(point, elastic):
    """Ratio to (A17) for MODES that the measured moduli give, and its error."""
    n = MODES * (MODES + 1)
    bending = point.rigidity * theory.stiffness(MODES)
    rest = bending_ratio(point.num_vertices, point.rigidity, MODES, SOFTENING[point.scheme])
    (shear, shear_error), (density, density_error) = (
        point.num_vertices * elastic[name] for name in ("shear", "density")
    )
    below = shear * (n - 2) + density * n
    ratio = 1 / (rest + 4 * shear * density * (n - 2) / below / bending)
    # The derivatives of the stiffness 4 μK (n−2) / (μ(n−2) + Kn) by μ and by K.
    by_shear = 4 * (n - 2) * n * density**2 / below**2
    by_density = 4 * (n - 2) ** 2 * shear**2 / below**2
    error = np.hypot(by_shear * shear_error, by_density * density_error) / bending * ratio**2
    return ratio, error


def tabulate(figure, elastic):
    """All moduli in figures."""
    kinds = {"shear": "μ r0² / N kBT", "density": "K r0² / N kBT", "bending": "κ / kBT"}
    for kind, symbol in kinds.items():
        figure.table(
            f"{symbol}, from modes of one l each:",
            ["vesicle", *(f"l = {l}" for l in MODES)],
            [
                [named(point)]
                + ["{:.3g} ± {:.2g}".format(*values[kind][:, place]) for place in range(len(MODES))]
                for point, values in elastic.items()
            ],
        )


def draw(figure, elastic, spectra, soft):
    page, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    marks = dict(zip(elastic, "osD^v<>PX*hpd" * 2, strict=False))
    for index, (point, moduli_of) in enumerate(elastic.items()):
        style = {"fmt": marks[point], "ms": 4, "color": f"C{index}", "label": named(point)}
        left.errorbar(MODES + 0.02 * index, *moduli_of["shear"], **style)
        if point in soft:
            _, ratio, error = ratio_of(spectra[point], point)
            count = len(MODES)
            predicted, uncertain = prediction(point, moduli_of)
            right.errorbar(predicted, ratio[:count], error[:count], uncertain, **style)
    left.axhline(UNDULATION_ENTROPY, color="black", lw=0.8)
    left.text(2, UNDULATION_ENTROPY, "entropy of undulations, lattice", va="top", fontsize=7)
    left.set(xlabel="l", ylabel="μ r0² / N kBT", yscale="log", xticks=MODES)
    right.plot([0, 1.3], [0, 1.3], color="black", lw=0.8)
    right.set(
        xlabel="⟨|u_lm|²⟩ / (A17) from the moduli, l = 2 … 5",
        ylabel="⟨|u_lm|²⟩ / (A17), measured",
        xlim=(0.45, 1.25),
        ylim=(0.45, 1.25),
    )
    left.legend(fontsize=5)
    figure.save(page, caption="Left: shear modulus from rotations. Right: spectra against it")


if __name__ == "__main__":
    main()
