"""The fluid twins of Fig. 6: spectra with fixed neighbours beside those with bond flips.

⟨|u_lm|²⟩ over that of a continuous fluid, (A17), value by value, of random meshes: from the tables
of `docs/flips`, which `examples/flips/spectrum.py` makes in hours; nothing is simulated here. What
the paper says of its meshes, which keep their neighbours, is tried on both kinds.

"corrected" is over (A17) with what short waves add, [1 − (3/4πκ) ln(√N / l)] / (1 + c l (l+1) / N)
on any mesh, see `mesh_corrections.py`; c is fitted once for all meshes of one N with flips.
"""

import csv
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure
from fig09_10_autocorrelation import frequency_of
from fluctuations import RADIUS, RIGIDITY
from openmmhelfrich.analysis import theory
from scipy.stats import chi2

TABLES = Path(__file__).resolve().parents[2] / "docs" / "flips"
KINDS = {"fixed": "fixed neighbours", "flips": "bond flips"}

# The paper's samples of a point, length of one in τ_2, and friction in 1/ps.
SAMPLES, PERIODS, FRICTION = 10, 20, 0.01
# A value of χ² that one of a hundred right theories exceeds is too large.
CHANCE = 0.01
SHEAR = (
    "neighbours that do not change resist shear, with a modulus that fig06b measures in "
    "displacements within the surface, and bond flips remove it"
)
SHORT = (
    "waves near the spacing of the vertices are softer on any mesh: with flips the same values, "
    "divided by what mesh_corrections.py has for them, are within 0.04 of (A17), see below"
)
FOLDS = (
    "folded edges: five of twelve runs lost their shape by them and are left out, and what comes "
    "before that is in the others; l = 3 is 0.96 and l = 8 1.03, each ± 0.01"
)


def read(name):
    """The columns of a table: {(N, Ξ, bonds): {column: array over l}}."""
    with open(TABLES / name, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    found = {}
    for row in rows:
        found.setdefault((int(row["N"]), float(row["Ξ"]), row["bonds"]), []).append(row)
    numbers = [column for column in rows[0] if column not in ("N", "Ξ", "bonds")]
    return {
        point: {column: np.array([float(row[column]) for row in some]) for column in numbers}
        for point, some in found.items()
    }


def chi_squared(values, errors):
    """Σ ((value − 1) / error)²."""
    return float(np.sum(((values - 1) / errors) ** 2))


def error_of_the_paper(l, num_vertices):
    """Standard error of ⟨|u_lm|²⟩ over its mean, of the paper's samples with a frame every τ_2.

    The mean square of a Gaussian process in n frames has the relative variance
    (2/n) [1 + 2 Σ_k ρ(k τ_2)²], over 2l+1 modes; ρ is (A35–A37).
    """
    omega = frequency_of(l, num_vertices)
    period = 2 * np.pi / frequency_of(2, num_vertices)
    memory = theory.langevin_autocorrelation(period * np.arange(1, PERIODS), omega, FRICTION)
    return np.sqrt(2 * (1 + 2 * np.sum(memory**2)) / (SAMPLES * PERIODS * (2 * l + 1)))


def modulus_of_the_paper(softness, num_vertices):
    """Y r0² / N kBT of (45)."""
    return (softness / 0.59) ** 2 * 1.8e-3 * RADIUS**2 / num_vertices


def main():
    figure = Figure("fig06c", "Fig. 6, fluid", "Spectra with fixed neighbours and flips", __doc__)
    found = read("spectrum.csv") | read("spectrum_4002.csv")
    figure.parameters(
        f"Random meshes, κ = {RIGIDITY:g} kBT, r0 = 1000 nm, Jülicher, kV = 0, 300 K; N = 1002 at "
        "four Ξ with fixed neighbours (60 to 120 τ_2) and with flips (100 to 600 τ_2), N = 4002 at "
        "two Ξ with flips (350 τ_2)."
    )
    figure.note(
        "c of what short waves add has been fitted to the spectra with flips, once for each N: one "
        "constant for 28 values of N = 1002, and 14 of N = 4002."
    )
    check_values(figure, found)
    check_spectra(figure, found)
    check_moduli(figure, found)
    check_softness(figure, found)
    tables(figure, found)
    draw(figure, found)
    figure.finish()


def check_values(figure, found):
    """Each value of soft meshes over (A17), at the errors that the paper has."""
    for (num_vertices, softness, bonds), data in found.items():
        if softness != 0.037:
            continue
        for l, ratio, error in zip(data["l"], data["ratio"], data["error"], strict=True):
            papers = error_of_the_paper(l, num_vertices)
            figure.check(
                f"Ξ = 0.037, {KINDS[bonds]}: over (A17), l = {l:g}, at two of the paper's errors",
                ratio,
                1,
                2 * np.hypot(papers, error),
                error,
                why=SHORT if l > 3 else SHEAR,
            )


def check_spectra(figure, found):
    """χ² of each spectrum, to (A17) alone and to (A17) with what short waves add."""
    for (num_vertices, softness, bonds), data in found.items():
        freedom = len(data["l"])
        most = chi2.isf(CHANCE, freedom)
        for what, column, why in (
            ("(A17)", "ratio", SHORT),
            ("(A17) with short waves", "corrected", FOLDS if bonds == "flips" else SHEAR),
        ):
            if column == "ratio" and softness != 0.037:
                continue
            error = data["error" if column == "ratio" else f"{column}_error"]
            value = chi_squared(data[column], error)
            figure.claim(
                f"N = {num_vertices}, Ξ = {softness:g}, {KINDS[bonds]}: χ² of l = 2 … 8 to {what}",
                f"{value:.1f}",
                f"less than {most:.1f}, 1 % of chance at {freedom} values",
                value < most,
                why,
            )


def check_moduli(figure, found):
    """The modulus that is left, which is that of (45), or with flips none at all."""
    for (num_vertices, softness, bonds), data in found.items():
        modulus, error = data["y"][0], data["y_error"][0]
        expected = modulus_of_the_paper(softness, num_vertices)
        about = f"N = {num_vertices}, Ξ = {softness:g}, {KINDS[bonds]}: Y r0² / N kBT"
        why = (
            "the modulus of meshes with fixed neighbours is an entropy, of 0.06 N kBT in shear "
            "already at small Ξ (fig06b), which (45) lacks"
        )
        if bonds == "flips":
            figure.check(f"{about}, none in a fluid", modulus, 0, 3 * error, error)
        else:
            figure.check(f"{about}, (45)", modulus, expected, 3 * error, error, why=why)


def check_softness(figure, found):
    """How l = 2 depends on Ξ: as the paper has it, or with flips not at all."""
    for bonds, name in KINDS.items():
        some = [data for (size, _, kind), data in found.items() if size == 1002 and kind == bonds]
        values, errors = (np.array([data[key][0] for data in some]) for key in ("ratio", "error"))
        weights = errors**-2
        mean = np.sum(weights * values) / np.sum(weights)
        spread = float(np.sum(((values - mean) / errors) ** 2))
        most = chi2.isf(CHANCE, len(values) - 1)
        depends = spread > most
        wanted = bonds == "fixed"
        figure.claim(
            f"N = 1002, {name}: l = 2 over (A17) at Ξ = 0.037 … 0.59",
            ", ".join(
                f"{value:.2f} ± {error:.2f}" for value, error in zip(values, errors, strict=True)
            )
            + f"; χ² to one value {spread:.1f}",
            f"{'falls with Ξ as in the paper, χ² above' if wanted else 'one value, χ² below'} "
            f"{most:.1f}",
            depends == wanted and (not wanted or bool(np.all(np.diff(values) < 0))),
        )


def tables(figure, found):
    """All values, and which sentences of the paper hold with which meshes."""
    l = next(iter(found.values()))["l"]
    for caption, column in (
        ("⟨|u_lm|²⟩ over (A17):", "ratio"),
        ("Over (A17) with what short waves add:", "corrected"),
    ):
        rows = []
        for (num_vertices, softness, bonds), data in found.items():
            error = data["error" if column == "ratio" else f"{column}_error"]
            rows.append(
                [f"N = {num_vertices}, Ξ = {softness:g}, {KINDS[bonds]}"]
                + [f"{one:.3f} ± {e:.3f}" for one, e in zip(data[column], error, strict=True)]
            )
        figure.table(caption, ["mesh", *(f"l = {each:g}" for each in l)], rows)
    figure.table(
        "Sentences of the paper, and on which meshes they hold (rows above):",
        ["sentence", *KINDS.values()],
        sentences(found),
    )


def sentences(found):
    """Rows of sentence, and "holds" or what is measured instead, for each of KINDS."""

    def of(size, softness, bonds):
        return found[size, softness, bonds]

    def long_waves(softness, bonds, size=1002):
        data = of(size, softness, bonds)
        value, error = data["corrected"][0], data["corrected_error"][0]
        verdict = "holds" if abs(value - 1) <= 3 * error else "does not hold"
        return f"{verdict}: l = 2 at {value:.2f} ± {error:.2f}"

    def law(bonds):
        data = [(s, found[1002, s, bonds]) for s in (0.037, 0.15, 0.33, 0.59)]
        holding = [
            f"{s:g}"
            for s, each in data
            if abs(each["y"][0] - modulus_of_the_paper(s, 1002)) <= 3 * each["y_error"][0]
        ]
        return f"holds at Ξ = {', '.join(holding)}" if holding else "does not hold"

    return [
        [f"Ξ = {softness:g}: long waves are those of a fluid, (A17), N = 1002"]
        + [long_waves(softness, bonds) for bonds in KINDS]
        for softness in (0.037, 0.15, 0.33, 0.59)
    ] + [
        ["the same at N = 4002, Ξ = 0.15", "see Fig. 6", long_waves(0.15, "flips", 4002)],
        ["Y(Ξ) of harder meshes, (45), from the long waves", *map(law, KINDS)],
    ]


def draw(figure, found):
    page, axes = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained", sharey=True)
    softnesses = sorted({softness for _, softness, _ in found})
    panels = ((1002, "fixed", "ratio"), (1002, "flips", "ratio"), (None, "flips", "corrected"))
    for axis, (size, kind, column) in zip(axes, panels, strict=True):
        for (num_vertices, softness, bonds), data in found.items():
            if bonds != kind or size not in (None, num_vertices):
                continue
            place = softnesses.index(softness)
            axis.errorbar(
                data["l"] + 0.06 * place + 0.25 * (num_vertices != 1002),
                data[column],
                data["error" if column == "ratio" else f"{column}_error"],
                fmt="o-" if num_vertices == 1002 else "s--",
                lw=0.8,
                ms=4,
                color=f"C{place}",
                label=f"N = {num_vertices}, Ξ = {softness:g}",
            )
        axis.axhline(1, color="black", lw=0.8)
        what = "(A17)" if column == "ratio" else "(A17) with short waves"
        axis.set(xlabel="l", title=f"{KINDS[kind]}, over {what}", ylim=(0, 1.4))
        axis.legend(fontsize=7)
    axes[0].set_ylabel("⟨|u_lm|²⟩ / theory")
    figure.save(page, caption="Spectra over (A17) with fixed neighbours, with flips, and corrected")


if __name__ == "__main__":
    main()
