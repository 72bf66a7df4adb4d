"""Fig. 5: how long Newtonian dynamics runs before it fails, against the time step.

Verlet dynamics of the four bending models on a hard (Ξ = 0.59) and on a soft mesh (Ξ = 0.037). Time
steps are given in units of √Ξ τ, where τ is the period of the fastest mode of the mesh. A run fails
when a position or an energy is not finite or its kinetic energy has grown tenfold.
"""

from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from _paper import SCHEMES, Figure
from openmmhelfrich.sweep import grid

SOFTNESSES = (0.59, 0.037)
BARYCENTRIC = ("Julicher", "GompperKrollBarycentric")


def runtime(scheme, softness, fraction, subdivision, duration, seed):
    """Time to failure of one run.

    Parameters
    ----------
    scheme : str
        Name of a constant of `BendingForce`.
    softness : float
        Ξ.
    fraction : float
        Time step in units of √Ξ τ.
    subdivision : int
        n of N = 10 n² + 2.
    duration : float
        When a run that lives is ended, τ_2.
    seed : int
        Of the velocities.

    Returns
    -------
    dict
        "lifetime", τ_2; "failed", and the "reason"; "time_step" and "unit" (√Ξ τ), ps.
    """
    import openmm
    import openmmhelfrich as helfrich
    from openmmhelfrich.analysis import time_to_failure

    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
    vesicle = helfrich.Vesicle(
        mesh, softness=softness, scheme=getattr(helfrich.BendingForce, scheme)
    )
    time_step = fraction * np.sqrt(softness) * vesicle.tau_fastest
    simulation = vesicle.simulation(openmm.VerletIntegrator(time_step))
    simulation.context.setVelocitiesToTemperature(300, seed)
    # Looked at every half percent of τ_2, so that a heated run is not taken for a living one.
    interval = max(1, round(0.005 * vesicle.tau_2 / time_step))
    life = time_to_failure(simulation, duration * vesicle.tau_2, interval)
    return {
        "lifetime": life.time / vesicle.tau_2,
        "failed": life.failed,
        "reason": life.reason,
        "time_step": time_step,
        "unit": np.sqrt(softness) * vesicle.tau_fastest,
    }


def main():
    figure = Figure("fig05", "Fig. 5", "Runtime to failure of Newtonian dynamics", __doc__)
    duration = figure.choose(30.0, 2.0)
    fractions = figure.choose([0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0], [0.1, 1.0])
    seeds = figure.choose([1, 2, 3], [1])
    points = grid(
        scheme=list(SCHEMES),
        softness=SOFTNESSES,
        fraction=fractions,
        subdivision=[10],
        duration=[duration],
        seed=seeds,
    )
    results = figure.sweep(runtime, points, description="runs")
    lives, units = {}, {}
    for point, result in zip(points, results, strict=True):
        units[point["softness"]] = result["unit"]
        key = point["scheme"], point["softness"], point["fraction"]
        lives.setdefault(key, []).append((result["lifetime"], result["failed"]))
    lives = {
        key: Life(np.median([time for time, _ in found]), not any(failed for _, failed in found))
        for key, found in lives.items()
    }
    figure.parameters(
        f"Icospheres of N = 1002, κ = 20 kBT, kA and kV of the paper, Verlet from velocities of "
        f"300 K, at most {duration:g} τ_2, {len(seeds)} runs per point; "
        + ", ".join(f"√Ξ τ = {units[xi]:.1f} ps at Ξ = {xi:g}" for xi in SOFTNESSES)
        + "."
    )
    if not figure.quick:
        figure.check("√Ξ τ at Ξ = 0.037", units[0.037], 10.8, 0.1, unit=" ps")
    check(figure, lives, fractions, duration)
    draw(figure, lives, fractions)
    figure.finish()


class Life(NamedTuple):
    """Median time to failure of the runs of one point in τ_2, and whether all lived to the end."""

    median: float
    all_alive: bool


def check(figure, lives, fractions, duration):
    allowed = [fraction for fraction in fractions if fraction <= 0.1]
    for softness, schemes in ((0.59, SCHEMES), (0.037, BARYCENTRIC)):
        for scheme in schemes:
            alive = sum(lives[scheme, softness, fraction].all_alive for fraction in allowed)
            figure.claim(
                f"Ξ = {softness:g}, {SCHEMES[scheme]}: alive at Δt ≤ 0.1 √Ξ τ",
                f"{alive} of {len(allowed)} time steps",
                "all",
                alive == len(allowed),
            )
    least = figure.choose(100, 10)
    for scheme in (each for each in SCHEMES if each not in BARYCENTRIC):
        longest = max(lives[scheme, 0.037, fraction].median for fraction in allowed)
        survived = any(lives[scheme, 0.037, fraction].all_alive for fraction in allowed)
        figure.claim(
            f"Ξ = 0.037, {SCHEMES[scheme]}: fails at every time step",
            f"median T_f at most {longest:.2g} τ_2, {duration / longest:.0f} times less than the "
            "barycentric models reached",
            f"{least} times less or more",
            not survived and longest < duration / least,
        )
    figure.table(
        "Largest Δt / √Ξ τ at which all runs lived:",
        ["Ξ", *SCHEMES.values()],
        [
            [f"{xi:g}"]
            + [
                f"{max((f for f in fractions if lives[scheme, xi, f].all_alive), default='none')}"
                for scheme in SCHEMES
            ]
            for xi in SOFTNESSES
        ],
    )


def draw(figure, lives, fractions):
    graph, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
    for axis, softness in zip(axes, SOFTNESSES, strict=True):
        for shift, (scheme, label) in enumerate(SCHEMES.items()):
            found = [lives[scheme, softness, fraction] for fraction in fractions]
            # Curves that coincide are moved apart a little.
            x = np.array(fractions) * 1.03**shift
            [line] = axis.loglog(x, [life.median for life in found], "-", lw=1, label=label)
            for here, life in zip(x, found, strict=True):
                axis.plot(here, life.median, "^" if life.all_alive else "x", color=line.get_color())
        axis.axvline(0.1, color="gray", lw=0.8, ls=":")
        axis.set(xlabel="Δt / √Ξ τ", title=f"Ξ = {softness:g}")
    axes[0].set_ylabel("runtime to failure / τ_2")
    axes[0].legend(fontsize=7)
    figure.save(graph, "", "Median time to failure; triangles: all runs were alive at the end.")


if __name__ == "__main__":
    main()
