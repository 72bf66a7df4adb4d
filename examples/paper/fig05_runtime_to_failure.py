"""Fig. 5: how long Newtonian dynamics runs before it fails, against the time step.

Verlet dynamics of the four bending models on a hard (Ξ = 0.59) and on a soft mesh (Ξ = 0.037). Time
steps are given in units of √Ξ τ, where τ is the period of the fastest mode of the mesh. A run fails
when a position or an energy is not finite or its kinetic energy has grown tenfold.
"""

import numpy as np
from _paper import SCHEMES, Figure, fastest_platform
from openmmhelfrich.sweep import grid

SOFTNESSES = (0.59, 0.037)
BARYCENTRIC = ("Julicher", "GompperKrollBarycentric")


def runtime(scheme, softness, fraction, subdivision, duration, seed):
    """Time to failure of one run, in units of τ_2, at most `duration`."""
    import openmm
    import openmmhelfrich as helfrich
    from openmmhelfrich.analysis import time_to_failure

    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
    vesicle = helfrich.Vesicle(
        mesh, softness=softness, scheme=getattr(helfrich.BendingForce, scheme)
    )
    time_step = fraction * np.sqrt(softness) * vesicle.tau_fastest
    simulation = vesicle.simulation(openmm.VerletIntegrator(time_step), fastest_platform())
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
    import matplotlib.pyplot as plt

    figure = Figure("fig05", "Fig. 5", "Runtime to failure of Newtonian dynamics", __doc__)
    duration = figure.choose(30.0, 2.0)
    fractions = figure.choose([0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0], [0.1, 1.0])
    points = grid(
        scheme=list(SCHEMES),
        softness=SOFTNESSES,
        fraction=fractions,
        subdivision=[10],
        duration=[duration],
        seed=figure.choose([1, 2, 3], [1]),
    )
    results = figure.sweep(runtime, points, description="runs")

    def lives(scheme, softness, fraction):
        """Lifetimes of the samples, and whether all of them were alive at the end."""
        found = [
            result
            for point, result in zip(points, results, strict=True)
            if (point["scheme"], point["softness"], point["fraction"])
            == (scheme, softness, fraction)
        ]
        return [each["lifetime"] for each in found], not any(each["failed"] for each in found)

    units = {
        point["softness"]: result["unit"] for point, result in zip(points, results, strict=True)
    }
    count = 10 * points[0]["subdivision"] ** 2 + 2
    figure.parameters(
        f"Icospheres of N = {count}, κ = 20 kBT, kA and kV of the paper, Verlet from velocities of "
        f"300 K, at most {duration:g} τ_2, {len(results) // (8 * len(fractions))} runs per point; "
        + ", ".join(f"√Ξ τ = {units[xi]:.1f} ps at Ξ = {xi:g}" for xi in SOFTNESSES)
        + "."
    )
    if not figure.quick:
        figure.check("√Ξ τ at Ξ = 0.037", units[0.037], 10.8, 0.1, unit=" ps")
    allowed = [fraction for fraction in fractions if fraction <= 0.1]
    for scheme, label in SCHEMES.items():
        alive = [fraction for fraction in allowed if lives(scheme, 0.59, fraction)[1]]
        figure.claim(
            f"Ξ = 0.59, {label}: alive at Δt ≤ 0.1 √Ξ τ",
            f"{len(alive)} of {len(allowed)} time steps",
            "all",
            alive == allowed,
        )
    for scheme in BARYCENTRIC:
        alive = [fraction for fraction in allowed if lives(scheme, 0.037, fraction)[1]]
        figure.claim(
            f"Ξ = 0.037, {SCHEMES[scheme]}: alive at Δt ≤ 0.1 √Ξ τ",
            f"{len(alive)} of {len(allowed)} time steps",
            "all",
            alive == allowed,
        )
    for scheme in (each for each in SCHEMES if each not in BARYCENTRIC):
        longest = max(np.median(lives(scheme, 0.037, fraction)[0]) for fraction in allowed)
        survivors = sum(lives(scheme, 0.037, fraction)[1] for fraction in allowed)
        figure.claim(
            f"Ξ = 0.037, {SCHEMES[scheme]}: fails at every time step",
            f"median T_f at most {longest:.2g} τ_2, {duration / longest:.0f} times less than the "
            "barycentric models reached",
            f"{figure.choose(100, 10)} times less or more",
            survivors == 0 and longest < duration / figure.choose(100, 10),
        )
    largest = {
        scheme: max([f for f in fractions if lives(scheme, 0.59, f)[1]], default=0)
        for scheme in SCHEMES
    }
    figure.note(
        "Largest Δt / √Ξ τ that lived, Ξ = 0.59: "
        + ", ".join(f"{SCHEMES[scheme]} {value:g}" for scheme, value in largest.items())
        + "; Ξ = 0.037: "
        + ", ".join(
            f"{SCHEMES[s]} {max([f for f in fractions if lives(s, 0.037, f)[1]], default=0):g}"
            for s in BARYCENTRIC
        )
        + "."
    )

    graph, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
    for axis, softness in zip(axes, SOFTNESSES, strict=True):
        for shift, (scheme, label) in enumerate(SCHEMES.items()):
            medians = [np.median(lives(scheme, softness, f)[0]) for f in fractions]
            alive = [lives(scheme, softness, f)[1] for f in fractions]
            # Curves that coincide are moved apart a little.
            x = np.array(fractions) * 1.03**shift
            [line] = axis.loglog(x, medians, "-", lw=1, label=label)
            for here, life, lives_on in zip(x, medians, alive, strict=True):
                axis.plot(here, life, "^" if lives_on else "x", color=line.get_color())
        axis.axvline(0.1, color="gray", lw=0.8, ls=":")
        axis.set(xlabel="Δt / √Ξ τ", title=f"Ξ = {softness:g}")
    axes[0].set_ylabel("runtime to failure / τ_2")
    axes[0].legend(fontsize=7)
    figure.save(graph, "", "Median time to failure; triangles: all runs were alive at the end.")
    figure.finish()


if __name__ == "__main__":
    main()
