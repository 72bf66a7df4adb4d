"""Figs. 3 and 4 of the supplement: how areas of triangles and lengths of bonds get distributed.

Ordered meshes run with the potentials of area, volume and heights only, in Verlet dynamics from
velocities of 300 K. The distributions are stationary by 6.5 τ_h, τ_h = d √(m/ε).
"""

import numpy as np
from _paper import Figure, mean_and_error
from openmmhelfrich.sweep import grid

TIMES = (0.0, 0.5, 1.0, 2.0, 3.0, 4.5, 6.5, 9.0, 13.0, 20.0, 26.0)
STATIONARY = 6.5


def distributions(softness, subdivision, time_step, times, seed):
    """Areas of triangles and lengths of bonds in one run.

    Parameters
    ----------
    softness : float
        Ξ.
    subdivision : int
        n of N = 10 n² + 2.
    time_step : float
        ps.
    times : list of float
        When to look, τ_h.
    seed : int
        Of the velocities.

    Returns
    -------
    dict
        "areas" and "lengths" over their means, shapes (len(times), num_triangles) and (len(times),
        num_edges); "temperatures", K; "tau_heights", τ_h, ps; "min_height", d, nm.
    """
    import openmm
    import openmmhelfrich as helfrich
    from openmm import unit
    from openmmhelfrich.analysis import edge_lengths, triangle_areas
    from openmmhelfrich.analysis.theory import BOLTZMANN

    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
    vesicle = helfrich.Vesicle(mesh, rigidity=0, softness=softness)
    simulation = vesicle.simulation(openmm.VerletIntegrator(time_step))
    simulation.context.setVelocitiesToTemperature(300, seed)
    areas, lengths, temperatures = [], [], []
    for time in times:
        simulation.step(round(time * vesicle.tau_heights / time_step) - simulation.currentStep)
        state = simulation.context.getState(positions=True, energy=True)
        vertices = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        temperatures.append(2 * kinetic / (3 * mesh.num_vertices * BOLTZMANN))
        area = triangle_areas(vertices, mesh.triangles)
        length = edge_lengths(vertices, mesh.triangles)
        areas.append(area / area.mean())
        lengths.append(length / length.mean())
    return {
        "areas": np.array(areas, dtype=np.float32),
        "lengths": np.array(lengths, dtype=np.float32),
        "temperatures": np.array(temperatures),
        "tau_heights": vesicle.tau_heights,
        "min_height": vesicle.min_height,
    }


def main():
    import matplotlib.pyplot as plt

    figure = Figure("sm03", "SM 3–4", "Distributions of areas and bond lengths", __doc__)
    samples = figure.choose(20, 4)
    softness = 0.037
    points = grid(
        softness=[softness],
        subdivision=[10],
        time_step=[0.5],
        times=[list(TIMES)],
        seed=range(1, samples + 1),
    )
    results = figure.sweep(distributions, points, description="runs")
    tau = results[0]["tau_heights"]
    figure.parameters(
        f"N = 1002, Ξ = {softness:g} (d = {results[0]['min_height']:.1f} nm), {samples} ordered "
        "meshes with U_A, U_V and U_h, Verlet, Δt = 0.5 ps, velocities of 300 K at the start."
    )
    figure.check("τ_h = d √(m/ε)", tau, 45, 0.5, unit=" ps")
    at = TIMES.index(STATIONARY)
    graph, axes = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    for axis, (name, label) in zip(
        axes, {"areas": "triangle area", "lengths": "bond length"}.items(), strict=False
    ):
        data = np.array([result[name] for result in results])
        spread = data.std(axis=2)
        mean, error = mean_and_error(spread)
        later, later_error = mean_and_error(spread[:, at + 1 :].mean(axis=1))
        figure.check(
            f"{label}: spread at {STATIONARY:g} τ_h over its mean from {TIMES[at + 1]:g} to "
            f"{TIMES[-1]:g} τ_h",
            mean[at] / later,
            1,
            0.05,
            np.hypot(error[at], later_error) / later,
        )
        early = mean[TIMES.index(1.0)] / later
        figure.note(
            f"Spread of the {label} over its mean: {later:.3f} ± {later_error:.3f} after "
            f"{STATIONARY:g} τ_h; after 1 τ_h it has {100 * early:.0f} % of that, at the start "
            f"{100 * mean[0] / later:.0f} %."
        )
        bins = np.linspace(0, data[:, at:].max(), 60)
        for time in (0.5, 1.0, 2.0, STATIONARY, 13.0, 26.0):
            values = data[:, TIMES.index(time)].ravel()
            axis.hist(values, bins, density=True, histtype="step", label=f"{time:g} τ_h")
        axis.set(xlabel=f"{label} / mean", ylabel="probability density", xlim=(0, 3))
        axes[2].errorbar(TIMES, mean, error, fmt="o-", ms=3, label=label)
    axes[0].legend(fontsize=7)
    axes[2].axvline(STATIONARY, color="gray", lw=0.8, ls=":")
    axes[2].set(xlabel="t / τ_h", ylabel="standard deviation / mean")
    axes[2].legend(fontsize=7)
    temperature = np.mean([result["temperatures"] for result in results], axis=0)
    figure.note(
        f"The temperature falls from {temperature[0]:.0f} K to {temperature[-1]:.0f} K, since the "
        "start has no potential energy."
    )
    figure.save(graph, "", "Distributions at several times, and their widths over time.")
    figure.finish()


if __name__ == "__main__":
    main()
