"""Fig. 4 d–f: restoring forces of a deformation u20 on four types of mesh and with four models.

Spheres as in fig04_deformation.py. The force on u in r → r (1 + u Y20) is the projection of the
forces on all vertices, dE/du = −Σ f · ∂x/∂u. For small u the theory has (8/π) kA r0² u³ (35),
(3/2π) kV r0³ u³ (37) and 24 κ u (39).

Each value is tested by itself. Its tolerance is what the theory leaves out, the next orders in u of
the smooth surface (see `spheres.smooth_slopes`), MESH / N of flat triangles, and three standard
errors. Values are medians of the samples: where a triangle is so obtuse that a Voronoi area nearly
vanishes, the forces of one mesh of fifty are many times those of all others.
"""

import itertools

import matplotlib.pyplot as plt
import numpy as np
from _paper import SCHEMES, Figure
from openmmhelfrich.sweep import grid
from spheres import (
    AREA_MODULUS,
    DURATION,
    KINDS,
    MARKERS,
    RADIUS,
    RIGIDITY,
    SOFTNESS,
    VOLUME_MODULUS,
    context_of,
    fluctuating,
    smooth_slopes,
    still_sphere,
)

AMPLITUDES = [0.02, 0.05, *np.round(np.arange(0.1, 1.01, 0.1), 1).tolist()]
# The values that are tested; at larger ones the next orders are not small.
SMALL = 0.3
# Error of volumes within flat triangles, relative, times N; of the other terms it is less.
MESH = 90
TERMS = ["E_A", "E_V", *SCHEMES.values()]
EQUATIONS = ["(35)", "(37)", *["(39)"] * len(SCHEMES)]
# Unevenness of meshes, from more to less.
LADDER = (0.15, SOFTNESS, 0.33)


def restoring(base, subdivision, seed, softness, duration, amplitudes):
    """Forces on u20 of a sphere, as it is and fluctuating.

    Parameters
    ----------
    base : str
        "ordered" or "random".
    subdivision : int
        n of N = 10 n² + 2.
    seed : int
        Of random meshes and fluctuations.
    softness, duration : float
        Ξ, and length in τ_h, of the run that makes the fluctuating mesh.
    amplitudes : list of float
        u20.

    Returns
    -------
    dict
        "still" and "fluctuating", dE/du of area, volume and the four bending models at each
        amplitude, shape (len(amplitudes), 6), kJ/mol; "folded", the runs that were made again.
    """
    mesh = still_sphere(base, subdivision, seed)
    moved, folded = fluctuating(mesh, softness, seed, duration)
    return {
        "still": forces_of(mesh, amplitudes),
        "fluctuating": forces_of(moved, amplitudes),
        "folded": folded,
    }


def forces_of(mesh, amplitudes):
    """−Σ f · ∂x/∂u of each term at each amplitude, kJ/mol."""
    from openmm import unit

    context, groups = context_of(mesh)
    # Positions are linear in u.
    direction = 2 * (mesh.deformed(2, 0, 0.5).vertices - mesh.vertices)
    slopes = np.empty((len(amplitudes), groups))
    for row, amplitude in zip(slopes, amplitudes, strict=True):
        context.setPositions(mesh.vertices + amplitude * direction)
        for group in range(groups):
            forces = context.getState(forces=True, groups={group}).getForces(asNumpy=True)
            forces = forces.value_in_unit(unit.kilojoule_per_mole / unit.nanometer)
            row[group] = -(forces * direction).sum()
    return slopes


def theory(u):
    """What (35), (37) and (39) have for each term, shape (len(u), 6), kJ/mol."""
    area = 8 / np.pi * AREA_MODULUS * RADIUS**2 * u**3
    volume = 3 / (2 * np.pi) * VOLUME_MODULUS * RADIUS**3 * u**3
    return np.stack([area, volume, *[24 * RIGIDITY * u] * len(SCHEMES)], axis=1)


def smooth(u):
    """The forces of the smooth surface for each term, shape (len(u), 6), kJ/mol."""
    return np.array([smooth_slopes(each) for each in u])[:, [0, 1, 2, 2, 2, 2]]


def median_and_error(values):
    """The median along the first axis, and its standard error from the median deviation.

    The error is that of a normal distribution, √(π/2) σ / √n with σ = 1.483 times the median
    deviation; that of a single value is 0.
    """
    values = np.asarray(values)
    median = np.median(values, axis=0)
    deviation = 1.483 * np.median(abs(values - median), axis=0)
    return median, np.sqrt(np.pi / 2 / len(values)) * deviation


def main():
    figure = Figure("fig04d", "Fig. 4 d–f", "Restoring forces of a deformation u20", __doc__)
    largest, samples = figure.choose((30, 50), (10, 5))
    common = {"duration": DURATION, "amplitudes": AMPLITUDES}
    points = [
        {"base": base, "subdivision": largest, "seed": seed, "softness": SOFTNESS} | common
        for base in ("ordered", "random")
        for seed in range(samples)
    ]
    results = figure.sweep(restoring, points, description="forces")
    forces = {
        kind: median_and_error(
            [
                result["fluctuating" if "fluctuating" in kind else "still"]
                for point, result in zip(points, results, strict=True)
                if point["base"] in kind
            ][: 1 if kind == "ordered" else None]
        )
        for kind in KINDS
    }
    ladder = grid(
        base=["random"],
        subdivision=[figure.choose(14, 7)],
        seed=range(figure.choose(20, 8)),
        softness=LADDER,
        duration=[DURATION],
        amplitudes=[[0.05]],
    )
    rungs = figure.sweep(restoring, ladder, description="softnesses")
    count = 10 * largest**2 + 2
    figure.parameters(
        f"N = {count}, r0 = 1000 nm, {samples} samples of each type but the ordered one, κ = "
        f"{RIGIDITY:g} kJ/mol, kA = {AREA_MODULUS:g} kJ/mol/nm², kV = {VOLUME_MODULUS:g} "
        f"kJ/mol/nm³. Fluctuating meshes: runs of {DURATION:g} τ_h at Ξ = {SOFTNESS:g} with U_A, "
        "U_V and U_h, then put back on the sphere. Medians of the samples."
    )
    for kind in KINDS:
        check(figure, kind, *forces[kind], count)
    check_cause(figure, ladder, rungs)
    tabulate(figure, forces)
    draw(figure, forces)
    figure.finish()


def check(figure, kind, median, error, count):
    """Each value at u ≤ SMALL against the theory, a row for each term."""
    u = np.array(AMPLITUDES)
    expected = theory(u)
    next_orders = abs(smooth(u) / expected - 1)
    tolerance = next_orders + MESH / count + 3 * error / expected
    off = median / expected - 1
    small = u <= SMALL
    uneven = (
        "the curvature of uneven meshes scatters from vertex to vertex by an amount that grows "
        "with u, and its square adds to the energy: the row on Ξ below shows that the excess "
        "falls as meshes get more even"
    )
    for column, (term, equation) in enumerate(zip(TERMS, EQUATIONS, strict=True)):
        good = (abs(off) <= tolerance)[small, column]
        worst = np.argmax((abs(off) / tolerance)[small, column])
        value, uncertain = off[worst, column], (error / expected)[worst, column]
        figure.claim(
            f"{kind}, {term}: −Σ f · ∂x/∂u over {equation} − 1, each u ≤ {SMALL:g}",
            f"{good.sum()} of {len(good)} values; at u = {u[worst]:g} "
            f"{100 * value:.2f} ± {100 * uncertain:.2f} %",
            f"all; there within {100 * tolerance[worst, column]:.2f} %",
            good.all(),
            uneven if column >= 2 and "fluctuating" in kind else "",
        )


def check_cause(figure, ladder, rungs):
    """The excess of bending forces over the smooth surface's, by the Ξ that made the meshes."""
    expected = smooth([0.05])[0]
    excess = {
        softness: median_and_error(
            [
                100 * (result["fluctuating"][0] / expected - 1)
                for point, result in zip(ladder, rungs, strict=True)
                if point["softness"] == softness
            ]
        )
        for softness in LADDER
    }
    column = 2 + list(SCHEMES).index("JulicherVoronoi")
    values = [excess[softness][0][column] for softness in LADDER]
    errors = [excess[softness][1][column] for softness in LADDER]
    found = (f"{value:.2f} ± {error:.2f} %" for value, error in zip(values, errors, strict=True))
    figure.claim(
        "JV at u = 0.05: force over that of the smooth surface − 1",
        f"{', '.join(found)} at Ξ = {', '.join(f'{softness:g}' for softness in LADDER)}",
        "falls with Ξ, in all by more than three standard errors",
        all(a > b for a, b in itertools.pairwise(values))
        and values[0] - values[-1] > 3 * np.hypot(errors[0], errors[-1]),
    )
    count = 10 * ladder[0]["subdivision"] ** 2 + 2
    figure.table(
        f"Force of fluctuating random meshes of N = {count} at u = 0.05 over that of the smooth "
        "surface, less 1, per cent:",
        ["Ξ", *TERMS],
        [
            [f"{softness:g}", *(f"{m:.2f} ± {e:.2f}" for m, e in zip(*found, strict=True))]
            for softness, found in excess.items()
        ],
    )


def tabulate(figure, forces):
    shown = [AMPLITUDES.index(u) for u in (0.02, 0.05, 0.1, 0.2, 0.3, 0.5)]
    expected = theory(np.array(AMPLITUDES))
    exact = smooth(AMPLITUDES) / expected
    rows = [
        ["smooth surface", f"{AMPLITUDES[at]:g}", *(f"{value:.4f}" for value in exact[at])]
        for at in shown
    ]
    for kind, (median, error) in forces.items():
        for at in shown:
            cells = zip(median[at] / expected[at], error[at] / expected[at], strict=True)
            rows.append([kind, f"{AMPLITUDES[at]:g}", *(f"{v:.4f} ± {e:.4f}" for v, e in cells)])
    figure.table("Forces over (35), (37) and (39):", ["mesh", "u", *TERMS], rows)


def draw(figure, forces):
    u = np.array(AMPLITUDES)
    expected = theory(u)
    graph, axes = plt.subplots(1, 3, figsize=(11, 3.8), layout="constrained")
    for column in range(len(TERMS)):
        axis = axes[min(column, 2)]
        for kind, (median, _) in forces.items():
            named = kind == ("ordered" if column >= 2 else kind)
            axis.loglog(
                u,
                median[:, column],
                MARKERS[kind],
                ms=4,
                mfc="none",
                color=f"C{column}" if column >= 2 else None,
                label=(TERMS[column] if column >= 2 else kind) if named else None,
            )
    for axis, column, symbol in zip(axes, (0, 1, 2), ("E_A", "E_V", "E_b"), strict=True):
        axis.loglog(u, expected[:, column], color="black", lw=1, label=EQUATIONS[column])
        axis.loglog(u, smooth(u)[:, column], color="gray", lw=1, ls="--", label="smooth surface")
        axis.set(xlabel="$u_{20}$", ylabel=f"$d{symbol} / du$ (kJ/mol)")
        axis.legend(fontsize=6)
    caption = "Circles ordered, squares random, triangles fluctuating (up: ordered)."
    figure.save(graph, "", caption)


if __name__ == "__main__":
    main()
