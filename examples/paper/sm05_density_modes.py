"""Supplement 5: density modes of the vertices on the vesicle, for meshes from soft to hard.

The structure factor S(l) = ⟨|ρ_lm|²⟩ is 1 for vertices that know nothing of each other. In hard
meshes they keep even distances: long waves vanish, and a peak rises near l = 2√N, the number of
half waves around the vesicle at the spacing of the vertices. The runs are those of
`fig06_spectrum.py`, of ordered meshes, and those of `fig06e_random.py`: random meshes of several N,
soft and hard, and with either barycentric scheme.

At small l a fluid mesh is stiffer than a gas, for which S = 1: the entropy of places in the surface
and of heights, which scale with the square root of the area of a vertex, is that of 3/2 kBT a
vertex, the factor of the paper's (20), and the resistance to shear adds 4π μ r0²/N kBT.
"""

import fig06e_random as random_meshes
import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fig06e_random import HARD, SOFT, Mesh
from fluctuations import SOFTNESS
from openmmhelfrich.analysis import density_modes
from spectra import FULL, QUICK, SCHEMES, Point, measure

# S(l) of gas-like places and heights, without resistance to shear.
GAS_AND_HEIGHTS = 2 / 3


def main():
    figure = Figure("sm05", "SM 5", "Density modes of the vertices", __doc__)
    size = figure.choose(FULL, QUICK)
    points = [Point(size["base"], softness=softness) for softness in SOFTNESS]
    runs = measure(points, size["samples"], figure)
    factors = {
        point.softness: structure(of_point, size["base"]) for point, of_point in runs.items()
    }
    other_size = figure.choose(random_meshes.FULL, random_meshes.QUICK)
    others = {
        mesh: structure(of_mesh, mesh.num_vertices)
        for mesh, of_mesh in random_meshes.measure(other_size, figure).items()
        if mesh[:2] in other_size["scaled"]
    }
    figure.parameters(
        f"a: N = {size['base']}, κ = 20 kBT, r0 = 1000 nm, Jülicher, kV = 0, ordered meshes; 20 "
        f"frames of each of {size['samples']} samples. b, c: random meshes of N ∝ r0²"
    )
    check(figure, size["base"], factors)
    check_sizes(figure, others)
    check_schemes(figure, others)
    check_order(figure, other_size["ordered"], others)
    draw(figure, size["base"], factors, others)
    figure.finish()


def structure(runs, num_vertices):
    """S(l) for l = 0 … 2.6 √N and its error, from the spread of the samples' frames."""
    lmax = int(2.6 * num_vertices**0.5)
    frames = np.concatenate([run["snapshots"] for run in runs]).astype(float)
    # Frames are τ_2 / 2 apart, longer than density modes remember.
    powers = density_modes(frames, lmax) ** 2
    per_l = np.stack([powers[:, l**2 : (l + 1) ** 2].mean(axis=1) for l in range(lmax + 1)], axis=1)
    return mean_and_error(per_l)


def plateau(factor, first, last=None):
    """Mean of S over l = first … last, by default the largest there is, and its error."""
    mean, error = (values[first : None if last is None else last + 1] for values in factor)
    return mean.mean(), np.sqrt((error**2).sum()) / len(mean)


def long_waves(num_vertices, factor):
    """S of waves that are long against the spacing of the vertices, l = 3 … √N/2."""
    return plateau(factor, 3, int(num_vertices**0.5 / 2))


def check(figure, num_vertices, factors):
    softest, hardest = min(factors), max(factors)
    peak = int(np.argmax(factors[hardest][0][2:])) + 2
    expected = 2 * num_vertices**0.5
    figure.check(f"l of the peak at Ξ = {hardest:g}", peak, expected, 0.1 * expected)
    heights = [factors[softness][0][2:].max() for softness in factors]
    figure.claim(
        "height of the peak",
        ", ".join(f"{height:.2f}" for height in heights) + f" at Ξ = {tuple(factors)}",
        "rises with Ξ",
        all(np.diff(heights) > 0),
    )
    levels = [long_waves(num_vertices, factors[softness]) for softness in factors]
    figure.claim(
        "S of long waves, l = 3 … √N/2",
        ", ".join(f"{level:.3f} ± {error:.3f}" for level, error in levels),
        "falls with Ξ, below the 2/3 of free heights",
        all(np.diff([level for level, _ in levels]) < 0) and levels[0][0] < GAS_AND_HEIGHTS,
    )
    figure.check("S of long waves at Ξ = 0.037", levels[0][0], 1, 0.1, levels[0][1])
    mean, error = plateau(factors[softest], int(np.ceil(2.5 * num_vertices**0.5)))
    figure.check("S of short waves, l ≥ 2.5 √N, Ξ = 0.037", mean, 1, 0.1, error)
    figure.note(
        "The paper's curves go to 1 at small Ξ. Here S of short waves does; that of long waves "
        f"stays at {levels[0][0]:.2f}, near the 0.44 of 1 / (3/2 + 4π μ r0²/N kBT) "
        "with μ from fig06b_shear.py"
    )


def of_kind(others, softness, scheme="Julicher"):
    """The random meshes of a softness and a scheme, {N: S}."""
    return {
        mesh.num_vertices: factor
        for mesh, factor in others.items()
        if mesh.random and (mesh.softness, mesh.scheme) == (softness, scheme)
    }


def check_sizes(figure, others):
    """b: as a function of l / √N, S does not know of N."""
    hard, soft = (of_kind(others, softness) for softness in (HARD, SOFT))
    for num_vertices, (mean, _) in hard.items():
        root = num_vertices**0.5
        figure.check(
            f"b, random, N = {num_vertices}: l of the peak at Ξ = {HARD:g} over √N",
            (int(np.argmax(mean[2:])) + 2) / root,
            2,
            0.2,
        )
    levels = {
        count: plateau(factor, int(np.ceil(0.2 * count**0.5)), int(0.5 * count**0.5))
        for count, factor in soft.items()
    }
    (most, reference), *smaller = sorted(levels.items(), reverse=True)
    for count, level in smaller:
        figure.check_same(
            f"b, random: S of l = 0.2 … 0.5 √N at Ξ = {SOFT:g}, N = {count} less N = {most}",
            level,
            reference,
        )


def check_schemes(figure, others):
    """c: places in the surface do not know how its bending energy is computed."""
    julicher, other = (of_kind(others, SOFT, scheme) for scheme in SCHEMES)
    for count in julicher:
        figure.check_same(
            f"c, N = {count}: S of long waves at Ξ = {SOFT:g}, GK barycentric less Jülicher",
            *(long_waves(count, kind[count]) for kind in (other, julicher)),
        )


def check_order(figure, pair, others):
    """b: a random mesh against an ordered one."""
    for softness in (SOFT, HARD):
        levels = [
            long_waves(pair[0], others[Mesh(*pair, softness, random)]) for random in (True, False)
        ]
        (level, error), (reference, its_error) = levels
        both = np.hypot(error, its_error)
        figure.check(
            f"b, N = {pair[0]}: S of long waves at Ξ = {softness:g}, random over ordered mesh",
            level / reference,
            1,
            0.1,
            both / reference,
        )


def draw(figure, num_vertices, factors, others):
    page, (axis, *other_axes) = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    for softness, (mean, error) in factors.items():
        l = np.arange(2, len(mean))
        axis.errorbar(l, mean[2:], error[2:], fmt=".-", ms=3, lw=0.7, label=f"Ξ = {softness:g}")
    axis.axvline(2 * num_vertices**0.5, color="black", lw=0.8, ls=":")
    axis.axhline(1, color="black", lw=0.8)
    axis.set(xlabel="l", ylabel="⟨|ρ_lm|²⟩", yscale="log", title="a  ordered")
    axis.legend()
    kinds = {
        f"b  random, Ξ = {SOFT:g} and {HARD:g}": [
            (SOFT, "Julicher"),
            (HARD, "Julicher"),
        ],
        f"c  random, Ξ = {SOFT:g}, both schemes": [(SOFT, scheme) for scheme in SCHEMES],
    }
    for panel, (title, pairs) in zip(other_axes, kinds.items(), strict=True):
        for (softness, scheme), line in zip(pairs, ("-", "--"), strict=True):
            for shade, (count, (mean, _)) in enumerate(of_kind(others, softness, scheme).items()):
                l = np.arange(2, len(mean))
                label = f"N = {count}" if line == "-" else None
                panel.plot(l / count**0.5, mean[2:], line, lw=0.8, color=f"C{shade}", label=label)
        panel.axvline(2, color="black", lw=0.8, ls=":")
        panel.axhline(1, color="black", lw=0.8)
        panel.set(xlabel="l / √N", yscale="log", title=title)
        panel.legend(fontsize=8)
    figure.save(
        page,
        caption="Structure factor; the dotted lines are at 2√N; broken lines: the harder meshes in "
        "b, GK barycentric in c",
    )


if __name__ == "__main__":
    main()
