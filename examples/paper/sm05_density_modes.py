"""Supplement 5: density modes of the vertices on the vesicle, for meshes from soft to hard.

The structure factor S(l) = ⟨|ρ_lm|²⟩ is 1 for vertices that know nothing of each other. In hard
meshes they keep even distances: long waves vanish, and a peak rises near l = 2√N, the number of
half waves around the vesicle at the spacing of the vertices. The runs are those of
`fig06_spectrum.py`.

At small l a fluid mesh is stiffer than a gas, for which S = 1: the entropy of places in the surface
and of heights, which scale with the square root of the area of a vertex, is that of 3/2 kBT a
vertex, the factor of the paper's (20), and the resistance to shear adds 4π μ r0²/N kBT.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fluctuations import SOFTNESS
from openmmhelfrich.analysis import density_modes
from spectra import FULL, QUICK, Point, measure

# S(l) of gas-like places and heights, without resistance to shear.
GAS_AND_HEIGHTS = 2 / 3


def main():
    figure = Figure("sm05", "SM 5", "Density modes of the vertices", __doc__)
    size = figure.choose(FULL, QUICK)
    points = [Point(size["base"], softness=softness) for softness in SOFTNESS]
    runs = measure(points, size["samples"], figure)
    lmax = int(2.6 * size["base"] ** 0.5)
    factors = {point.softness: structure(of_point, lmax) for point, of_point in runs.items()}
    figure.parameters(
        f"N = {size['base']}, κ = 20 kBT, r0 = 1000 nm, Jülicher, kV = 0; 20 frames of each of "
        f"{size['samples']} samples"
    )
    check(figure, size["base"], factors)
    draw(figure, size["base"], factors)
    figure.finish()


def structure(runs, lmax):
    """S(l) for l = 0 … lmax and its error, from the spread of the samples' frames."""
    frames = np.concatenate([run["snapshots"] for run in runs]).astype(float)
    # Frames are τ_2 / 2 apart, longer than density modes remember.
    powers = density_modes(frames, lmax) ** 2
    per_l = np.stack([powers[:, l**2 : (l + 1) ** 2].mean(axis=1) for l in range(lmax + 1)], axis=1)
    return mean_and_error(per_l)


def plateau(factor, first, last=None):
    """Mean of S over l = first … last, by default the largest there is, and its error."""
    mean, error = (values[first : None if last is None else last + 1] for values in factor)
    return mean.mean(), np.sqrt((error**2).sum()) / len(mean)


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
    # Where waves are long against the spacing of the vertices, and where they are short.
    long, short = int(num_vertices**0.5 / 2), int(np.ceil(2.5 * num_vertices**0.5))
    levels = [plateau(factors[softness], 3, long) for softness in factors]
    figure.claim(
        "S of long waves, l = 3 … √N/2",
        ", ".join(f"{level:.3f} ± {error:.3f}" for level, error in levels),
        "falls with Ξ, below the 2/3 of free heights",
        all(np.diff([level for level, _ in levels]) < 0) and levels[0][0] < GAS_AND_HEIGHTS,
    )
    figure.check("S of long waves at Ξ = 0.037", levels[0][0], 1, 0.1, levels[0][1])
    mean, error = plateau(factors[softest], short)
    figure.check("S of short waves, l ≥ 2.5 √N, Ξ = 0.037", mean, 1, 0.1, error)
    figure.note(
        "The paper's curves go to 1 at small Ξ. Here S of short waves does; that of long waves "
        f"stays at {levels[0][0]:.2f}, near the 0.44 of 1 / (3/2 + 4π μ r0²/N kBT) "
        "with μ from fig06b_shear.py"
    )


def draw(figure, num_vertices, factors):
    page, axis = plt.subplots(figsize=(6, 4), layout="constrained")
    for softness, (mean, error) in factors.items():
        l = np.arange(2, len(mean))
        axis.errorbar(l, mean[2:], error[2:], fmt=".-", ms=3, lw=0.7, label=f"Ξ = {softness:g}")
    axis.axvline(2 * num_vertices**0.5, color="black", lw=0.8, ls=":")
    axis.axhline(1, color="black", lw=0.8)
    axis.set(xlabel="l", ylabel="⟨|ρ_lm|²⟩", yscale="log")
    axis.legend()
    figure.save(page, caption="Structure factor; the dotted line is at 2√N")


if __name__ == "__main__":
    main()
