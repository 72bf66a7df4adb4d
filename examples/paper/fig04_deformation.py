"""Fig. 4: energies of the mode u20 on four types of mesh and with four bending models.

Ordered and random spheres, as they are and fluctuating, are deformed by r → r (1 + u Y20) with u
from 0 to 1. Small deformations cost E_A = (2/π) kA r0² u⁴ (34), E_V = (3/8π) kV r0³ u⁴ (36) and
E_b = 8πκ + 12κ u² (38). On fluctuating meshes the barycentric bending models lie above by a share
that grows with the number of vertices, see fig04b_bias.py.
"""

import itertools

import matplotlib.pyplot as plt
import numpy as np
from _paper import SCHEMES, Figure, mean_and_error
from openmmhelfrich.analysis import theory
from spheres import (
    AREA_MODULUS,
    BARYCENTRIC,
    DURATION,
    KINDS,
    MARKERS,
    RADIUS,
    RIGIDITY,
    SOFTNESS,
    VOLUME_MODULUS,
    context_of,
    fluctuating,
    still_sphere,
)

AMPLITUDES = [0.0, 0.02, 0.05, *np.round(np.arange(0.1, 1.01, 0.1), 1).tolist()]


def deformation(kind, subdivision, seed, softness, duration, amplitudes):
    """Energies of one mesh, deformed by u20.

    Parameters
    ----------
    kind : str
        One of KINDS.
    subdivision : int
        n of N = 10 n² + 2.
    seed : int
        Of random meshes and fluctuations.
    softness, duration : float
        Ξ, and length in τ_h, of the run that makes fluctuating meshes.
    amplitudes : list of float
        u20.

    Returns
    -------
    dict
        "energies" of area, volume and the four bending models at each amplitude, shape
        (len(amplitudes), 6), kJ/mol; "folded", the runs that were made again since they folded a
        triangle over.
    """
    from openmm import unit

    mesh = still_sphere(kind, subdivision, seed)
    folded = 0
    if "fluctuating" in kind:
        mesh, folded = fluctuating(mesh, softness, seed, duration)
    context, groups = context_of(mesh)
    energies = np.empty((len(amplitudes), groups))
    for row, amplitude in zip(energies, amplitudes, strict=True):
        context.setPositions(mesh.deformed(2, 0, amplitude).vertices)
        for group in range(groups):
            state = context.getState(energy=True, groups={group})
            row[group] = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    return {"energies": energies, "folded": folded}


def main():
    figure = Figure(
        "fig04", "Fig. 4", "Energies of a deformation u20 on four types of mesh", __doc__
    )
    samples = figure.choose(50, 3)
    largest = figure.choose(30, 10)
    common = {"softness": SOFTNESS, "duration": DURATION}
    points = [
        {"kind": kind, "subdivision": largest, "seed": seed, "amplitudes": AMPLITUDES, **common}
        for kind in KINDS
        for seed in range(1 if kind == "ordered" else samples)
    ]
    results = figure.sweep(deformation, points, description="deformations")
    energies = {
        kind: np.array(
            [r["energies"] for p, r in zip(points, results, strict=True) if p["kind"] == kind]
        )
        for kind in KINDS
    }
    figure.parameters(
        f"N = {10 * largest**2 + 2}, r0 = 1000 nm, {samples} samples of each type but the ordered "
        f"one, κ = {RIGIDITY:g} kJ/mol, kA = {AREA_MODULUS:g} kJ/mol/nm², kV = {VOLUME_MODULUS:g} "
        f"kJ/mol/nm³. Fluctuating meshes: runs of {DURATION:g} τ_h at Ξ = {SOFTNESS:g} with U_A, "
        "U_V and U_h, then put back on the sphere."
    )
    folded = sum(result["folded"] for result in results)
    if folded:
        runs = sum("fluctuating" in point["kind"] for point in points)
        figure.note(
            f"{folded} of {runs} runs of fluctuating meshes folded a triangle and was made again."
        )
    check_area_and_volume(figure, energies)
    check_bending(figure, energies)
    draw(figure, energies)
    figure.finish()


def global_theory(u):
    """Energies of area and volume for each amplitude, (34) and (36), kJ/mol."""
    return {
        "E_A": theory.area_energy(u, AREA_MODULUS, RADIUS),
        "E_V": theory.volume_energy(u, VOLUME_MODULUS, RADIUS),
    }


def tolerance(figure):
    """Of ratios to a theory of continua: meshes of 1002 vertices are a few per cent below it."""
    return figure.choose(0.05, 0.1)


def check_area_and_volume(figure, energies):
    u = np.array(AMPLITUDES)
    at = AMPLITUDES.index(0.1)
    small = (u >= 0.05) & (u <= 0.2)
    for kind in KINDS:
        for column, (name, expected) in enumerate(global_theory(u).items()):
            value, error = mean_and_error(energies[kind][:, at, column] / expected[at])
            figure.check(f"{kind}: {name} / theory at u = 0.1", value, 1, tolerance(figure), error)
            mean = energies[kind][:, small, column].mean(axis=0)
            slope = np.polyfit(np.log(u[small]), np.log(mean), 1)[0]
            figure.check(f"{kind}: slope of {name}, u = 0.05 … 0.2", slope, 4, 0.1)


def check_bending(figure, energies):
    u = np.array(AMPLITUDES)
    # The least deformation at which the rise stands out of the rounding of the mesh.
    at = AMPLITUDES.index(0.1)
    expected = theory.bending_energy(u, RIGIDITY)
    for kind, (column, (scheme, label)) in itertools.product(
        KINDS, enumerate(SCHEMES.items(), start=2)
    ):
        fluctuating = "fluctuating" in kind
        # Barycentric models have a bias there, which is checked by itself.
        if not (fluctuating and scheme in BARYCENTRIC):
            ratio = (energies[kind].mean(axis=0)[:, column] / expected)[u < 0.5]
            worst = ratio[np.argmax(abs(ratio - 1))]
            figure.check(f"{kind}, {label}: E_b / theory, u < 0.5, farthest from 1", worst, 1, 0.02)
        if not fluctuating:
            rise = energies[kind][:, at, column] - energies[kind][:, 0, column]
            value, error = mean_and_error(rise / (expected[at] - expected[0]))
            what = f"{kind}, {label}: rise of E_b / 12κu² at u = 0.1"
            figure.check(what, value, 1, tolerance(figure), error)


def draw(figure, energies):
    u = np.array(AMPLITUDES)
    graph, axes = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained")
    for column, (name, expected) in enumerate(global_theory(u).items()):
        axes[0].loglog(u[1:], expected[1:], color="black", lw=1, label="theory" if column else None)
        for kind in KINDS:
            label = f"{name}, {kind}" if column == 0 else None
            mean = energies[kind].mean(axis=0)
            axes[0].loglog(u[1:], mean[1:, column], MARKERS[kind], ms=4, mfc="none", label=label)
    axes[0].set(xlabel="$u_{20}$", ylabel="$E_A$ (below), $E_V$ (kJ/mol)")
    sphere = theory.bending_energy(0, RIGIDITY)
    for place, label in enumerate(SCHEMES.values()):
        color = f"C{place}"
        for kind in KINDS:
            mean = energies[kind].mean(axis=0)[:, 2 + place] / sphere
            style = {"color": color, "ms": 4, "mfc": "none"}
            axes[1].plot(
                u, mean, MARKERS[kind], label=label if kind == "ordered" else None, **style
            )
    bending = theory.bending_energy(u, RIGIDITY) / sphere
    axes[1].plot(u, bending, color="black", lw=1, label="theory")
    axes[1].set(xlabel="$u_{20}$", ylabel="$E_b / 8πκ$")
    for axis in axes:
        axis.legend(fontsize=6)
    caption = "Circles ordered, squares random, triangles fluctuating (up: ordered)."
    figure.save(graph, "", caption)


if __name__ == "__main__":
    main()
