"""Fig. 6 on random meshes: spectra and the Young modulus Y against radius, N and scheme.

Random meshes, each sample on its own. The paper scales N with r0², so that a radius changes nothing
but the size; and it has Y, in kBT/nm², as a function of Ξ alone, (45). Here N and r0 are varied
apart too at Ξ = 0.59, which tells Y r0² ∝ r0² at given N, as a material of that Y has it, from
Y r0² ∝ N kBT at any r0, an entropy of the vertices. Y is that of (A18) for l = 2 … 5, with what
short waves add (`mesh_corrections.py`). The mean shape of a mesh is not part of fluctuations: its
square is the product of the means over the two halves of a run.

Soft meshes of all N have both barycentric schemes, and an ordered one stands beside the random ones
of its size. `sm05_density_modes.py` has the density modes of these runs.
"""

from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from fluctuations import RIGIDITY, SOFTNESS, VERSION, fluctuate
from mesh_corrections import SOFTENING, fit_shear
from openmmhelfrich.analysis import theory
from spectra import SCHEMES

SOFT, HARD = SOFTNESS[0], SOFTNESS[-1]

# Why moduli differ from (45).
WITH_SHAPES = (
    "(45) is one line through all Ξ and N; the moduli here scatter about 1.5e-3/nm², with the mean "
    "shapes of ten meshes"
)
WITHOUT_SHAPES = (
    "a random mesh that is hard has a mean shape of its own, which adds to ⟨|u|²⟩ of long waves "
    "and takes a modulus that is read off them down to what it is with mean shapes (rows above)"
)
L = np.arange(2, 6)

# c of the cotangent Laplacian on an even triangular lattice, see `mesh_corrections.py`.
EVEN = 1.8


class Mesh(NamedTuple):
    """N, r0 in nm, Ξ, whether the mesh is random, and the bending scheme."""

    num_vertices: int
    radius: float = 1000.0
    softness: float = HARD
    random: bool = True
    scheme: str = "Julicher"


FULL = {
    "scaled": ((252, 500.0), (492, 700.0), (1002, 1000.0), (1962, 1400.0)),
    "radii": ((1002, 500.0), (1002, 1000.0), (1002, 2000.0)),
    "vertices": ((252, 1000.0), (492, 1000.0), (1002, 1000.0), (1962, 1000.0)),
    "ordered": (1002, 1000.0),
    "samples": 10,
}
QUICK = {
    "scaled": ((252, 700.0), (492, 1000.0)),
    "radii": ((252, 700.0), (252, 1000.0)),
    "vertices": ((252, 1000.0), (492, 1000.0)),
    "ordered": (252, 700.0),
    "samples": 3,
}


def meshes_of(size):
    """All meshes that are needed, each once."""
    found = [Mesh(*pair) for name in ("scaled", "radii", "vertices") for pair in size[name]]
    found += [Mesh(*pair, SOFT) for pair in size["scaled"]]
    found.append(Mesh(*size["ordered"], random=False))
    found += [Mesh(*pair, SOFT, scheme=scheme) for pair in size["scaled"] for scheme in SCHEMES]
    found.append(Mesh(*size["ordered"], SOFT, random=False))
    return list(dict.fromkeys(found))


def arguments_of(mesh, place, samples):
    """The arguments of `fluctuate`, with seeds of their own for each mesh."""
    return [
        {
            **mesh._asdict(),
            "rigidity": RIGIDITY,
            "lmax": max(7, resolved(mesh)),
            "periods": 10,
            "frames_per_period": 8,
            "settle_periods": 2,
            "seed": 60_000 + 100 * place + sample,
        }
        for sample in range(samples)
    ]


def measure(size, figure):
    """The runs of each mesh, {mesh: [result, …]}."""
    meshes = meshes_of(size)
    points = [
        arguments
        for place, mesh in enumerate(meshes)
        for arguments in arguments_of(mesh, place, size["samples"])
    ]
    results = iter(figure.sweep(fluctuate, points, VERSION))
    return {mesh: [next(results) for _ in range(size["samples"])] for mesh in meshes}


def resolved(mesh):
    """The largest l that a mesh resolves within a third or so: 10 for N = 1002."""
    return int(mesh.num_vertices**0.5 / 3)


def power(run, l, still=True):
    """⟨|u_lm|²⟩ of a run, the mean over m, with or without the square of its mean shape."""
    modes = run["fit"][:, l**2 : (l + 1) ** 2].astype(float)
    total = (modes**2).mean()
    if still:
        return total
    first, second = (half.mean(axis=0) for half in np.array_split(modes, 2))
    return total - (first * second).mean()


def ratios(runs, still=False, orders=L):
    """⟨|u_lm|²⟩ over (A17) for each l, and its error from the runs."""
    powers = [[power(run, l, still) for l in orders] for run in runs]
    mean, error = mean_and_error(powers)
    fluid = theory.fluid_spectrum(orders, RIGIDITY)
    return mean / fluid, error / fluid


def modulus(mesh, runs, still=False, softening=None):
    """Y r0²/kBT and its error, with or without mean shapes, by the c of soft meshes or another."""
    if softening is None:
        softening = SOFTENING[mesh.scheme]
    y, error = fit_shear(mesh.num_vertices, RIGIDITY, L, *ratios(runs, still), softening)
    return mesh.num_vertices * y, mesh.num_vertices * error


def exponent(x, values, errors):
    """The power of x with which values grow, and its error, by weighted least squares of logs."""
    logs, weights = np.log(x), (values / errors) ** 2
    centred = logs - np.average(logs, weights=weights)
    scale = np.sum(weights * centred**2)
    return float(np.sum(weights * centred * np.log(values)) / scale), float(scale**-0.5)


def main():
    figure = Figure("fig06e", "Fig. 6, random", "Spectra and Y of random meshes", __doc__)
    size = figure.choose(FULL, QUICK)
    runs = measure(size, figure)
    figure.parameters(
        f"κ = {RIGIDITY:g} kBT, Jülicher where nothing else is said, kV = 0; LangevinMiddle, "
        f"300 K, γ = ω_2, Δt = 0.075 √Ξ τ_fastest, {size['samples']} samples of 10 τ_2"
    )
    found = {mesh: modulus(mesh, of_mesh) for mesh, of_mesh in runs.items() if mesh.random}
    check_scaled(figure, size, runs)
    check_apart(figure, size, runs, found)
    check_spike(figure, size, runs)
    check_schemes(figure, size, runs)
    check_order(figure, size, runs)
    figure.table(
        "⟨|u_lm|²⟩ that fluctuates over (A17), and the modulus:",
        ["mesh", *(f"l = {l}" for l in L), "Y r0²/kBT", "Y r0² / N kBT", "Y / kBT, 1/nm²"],
        [row(mesh, runs[mesh], found[mesh]) for mesh in found],
    )
    draw(figure, size, runs, found)
    figure.finish()


def row(mesh, runs, found):
    value, error = found
    cells = [
        f"N = {mesh.num_vertices}, r0 = {mesh.radius:g} nm, Ξ = {mesh.softness:g}, "
        f"{SCHEMES[mesh.scheme]}"
    ]
    cells += [f"{one:.2f} ± {e:.2f}" for one, e in zip(*ratios(runs), strict=True)]
    for scale, form in ((1, "{:.0f} ± {:.0f}"), (mesh.num_vertices, "{:.3f} ± {:.3f}")):
        cells.append(form.format(value / scale, error / scale))
    cells.append(f"{value / mesh.radius**2:.2e} ± {error / mesh.radius**2:.1e}")
    return cells


def check_scaled(figure, size, runs):
    """N ∝ r0²: the spectrum of soft meshes is that of one size, and Y of hard ones is (45)."""
    (first, *others) = (Mesh(*pair, SOFT) for pair in size["scaled"])
    reference = [both[0] for both in ratios(runs[first])]
    for mesh in others:
        figure.check_same(
            f"Ξ = {SOFT:g}, l = 2 over (A17), r0 = {mesh.radius:g} nm less {first.radius:g} nm, "
            "N ∝ r0²",
            [both[0] for both in ratios(runs[mesh])],
            reference,
            why="the modulus of a mesh with fixed neighbours is an entropy of its N vertices, and "
            "Y r0² grows with N (rows of Ξ = 0.59 below)",
        )
    expected = theory.young_modulus(HARD)
    for still, name, why in (
        (True, "with mean shapes, as in the paper's spectra", WITH_SHAPES),
        (False, "of fluctuations", WITHOUT_SHAPES),
    ):
        for pair in size["scaled"]:
            mesh = Mesh(*pair)
            value, error = (one / mesh.radius**2 for one in modulus(mesh, runs[mesh], still))
            figure.check(
                f"Ξ = {HARD:g}, Y/kBT {name}, N = {mesh.num_vertices}, r0 = {mesh.radius:g} nm, "
                "(45), in 1e-3/nm²",
                1e3 * value,
                1e3 * expected,
                3e3 * error,
                1e3 * error,
                why=why,
            )


def check_apart(figure, size, runs, found):
    """N and r0 varied apart: powers of each with which Y r0² grows."""
    power_of_radius = growth(size["radii"], 1, found)
    what = f"Ξ = {HARD:g}: power of r0 at one N in Y r0²"
    check_power(
        figure,
        f"{what}, if Y is (45)",
        power_of_radius,
        2,
        "Y r0² is N kBT times a function of Ξ, whatever r0 is: an entropy of the vertices, not an "
        "energy per area; next row",
    )
    check_power(figure, f"{what}, if Y is an entropy", power_of_radius, 0)
    what = f"Ξ = {HARD:g}: power of N at one r0 in Y r0²"
    check_power(
        figure,
        what,
        growth(size["vertices"], 0, found),
        1,
        "what short waves add is taken from soft meshes, c = 2.3; hard ones are nearer to an even "
        "lattice, next row",
    )
    meshes = [Mesh(*pair) for pair in size["vertices"]]
    even = {mesh: modulus(mesh, runs[mesh], softening=EVEN) for mesh in meshes}
    name = f"{what}, with the c = {EVEN:g} of an even lattice"
    check_power(figure, name, growth(size["vertices"], 0, even), 1)


def growth(pairs, column, found):
    """The power of N (column 0) or r0 (1) with which moduli, all above 0, grow, and its error."""
    values, errors = np.array([found[Mesh(*pair)] for pair in pairs]).T
    return exponent([pair[column] for pair in pairs], values, errors) if min(values) > 0 else None


def check_power(figure, name, power_and_error, expected, why=""):
    if power_and_error is None:
        figure.claim(name, "a modulus is negative", "positive", False, why)
    else:
        power, error = power_and_error
        figure.check(name, power, expected, 3 * error, error, why=why)


def check_spike(figure, size, runs):
    """The mean shape at l = 6, which an ordered mesh has and a random one should not."""
    orders = np.array([5, 6, 7])
    for random, name in ((True, "random"), (False, "ordered")):
        mesh = Mesh(*size["ordered"], random=random)
        values, errors = ratios(runs[mesh], True, orders)
        around = (values[0] + values[2]) / 2
        error = np.hypot(errors[1], np.hypot(errors[0], errors[2]) / 2) / around
        figure.check(
            f"Ξ = {HARD:g}, {name} mesh: l = 6 over the mean of 5 and 7",
            values[1] / around,
            1,
            0.2,
            error,
            why="an ordered mesh has the mean shape of an icosahedron, whose corners are at its "
            "twelve vertices of five neighbours; random meshes have none (row above)",
        )


def overall(mesh, runs):
    """⟨|u|²⟩ over (A17), the mean over the l that a mesh resolves, each alike, and its error."""
    values, errors = ratios(runs[mesh], True, np.arange(2, resolved(mesh) + 1))
    return values.mean(), np.hypot.reduce(errors) / len(errors)


def check_spectra(figure, name, mesh, other, runs, why=""):
    """That the spectra of two meshes are the same, by their means over l."""
    figure.check_same(
        f"Ξ = {mesh.softness:g}, N = {mesh.num_vertices}, mean over l = 2 … {resolved(mesh)} over "
        f"(A17), {name}",
        overall(mesh, runs),
        overall(other, runs),
        why,
    )


def check_schemes(figure, size, runs):
    """Both barycentric schemes at all N."""
    barycentric = "GompperKrollBarycentric"
    for pair in size["scaled"]:
        mesh = Mesh(*pair, SOFT)
        check_spectra(
            figure,
            f"{SCHEMES[barycentric]} less {SCHEMES[mesh.scheme]}",
            mesh._replace(scheme=barycentric),
            mesh,
            runs,
            "short waves are softer with GK barycentric, c = 2.6 against 2.3 in the common fits of "
            "Fig. 6, and on coarse meshes all waves are short",
        )


def check_order(figure, size, runs):
    """A random mesh against an ordered one."""
    mesh = Mesh(*size["ordered"], SOFT)
    check_spectra(figure, "random less ordered mesh", mesh, mesh._replace(random=False), runs)


def draw(figure, size, runs, found):
    page, axes = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    for axis, softness in zip(axes, (SOFT, HARD), strict=False):
        for index, pair in enumerate(size["scaled"]):
            mesh = Mesh(*pair, softness)
            axis.errorbar(
                L + 0.05 * index,
                *ratios(runs[mesh]),
                fmt="o-",
                ms=4,
                lw=0.8,
                label=f"r0 = {mesh.radius:g} nm, N = {mesh.num_vertices}",
            )
        axis.axhline(1, color="black", lw=0.8)
        axis.set(xlabel="l", ylabel="⟨|u_lm|²⟩ / (A17)", title=f"Ξ = {softness:g}", ylim=(0, None))
        axis.set_xticks(L)
        axis.legend(fontsize=7)
    for name, label in (
        ("radii", f"N = {size['radii'][0][0]}"),
        ("vertices", "r0 = 1000 nm"),
        ("scaled", "N ∝ r0²"),
    ):
        meshes = [Mesh(*pair) for pair in size[name]]
        x = [mesh.radius**2 / mesh.num_vertices for mesh in meshes]
        values, errors = np.array([found[mesh] for mesh in meshes]).T
        counts = np.array([mesh.num_vertices for mesh in meshes])
        axes[2].errorbar(x, values / counts, errors / counts, fmt="o", ms=4, label=label)
    axes[2].set(xscale="log", xlabel="r0² / N (nm²)", ylabel="Y r0² / N kBT", ylim=(0, None))
    grid = np.geomspace(200, 4500, 50)
    axes[2].plot(grid, theory.young_modulus(HARD) * grid, color="black", lw=0.8, label="(45)")
    axes[2].legend(fontsize=7)
    figure.save(page, caption="Spectra for N ∝ r0², and Y with N and r0 varied apart")


if __name__ == "__main__":
    main()
