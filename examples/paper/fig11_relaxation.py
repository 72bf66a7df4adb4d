"""Fig. 11: how the bending energy of oblate and prolate starts relaxes.

Spheres deformed to an oblate or a prolate of a given reduced volume run in Langevin dynamics. Their
bending energies, means over several seeds, settle in less than the period τ_2 of the slowest mode.
"""

import numpy as np
from _paper import Figure, mean_and_error
from openmmhelfrich.sweep import grid

# Energies have relaxed that differ from the plateau by less than this share of their largest
# difference from it.
BAND = 0.05


def relaxation(shape, reduced_volume, softness, subdivision, duration, samples, time_step, seed):
    """Bending energy of one run from an oblate or a prolate.

    Parameters
    ----------
    shape : str
        "oblate" or "prolate".
    reduced_volume, softness : float
        ν of the start, and Ξ.
    subdivision : int
        n of N = 10 n² + 2.
    duration : float
        τ_2.
    samples : int
        Number of equal intervals after each of which the energy is read.
    time_step : float
        ps.
    seed : int
        Of velocities and noise.

    Returns
    -------
    dict
        "energies", shape (samples + 1,), kJ/mol, at "times", τ_2; "tau_2", ps.
    """
    import openmm
    import openmmhelfrich as helfrich

    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
    mesh = getattr(mesh, shape)(reduced_volume)
    vesicle = helfrich.Vesicle(mesh, softness=softness)
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, time_step)
    integrator.setRandomNumberSeed(seed)
    simulation = vesicle.simulation(integrator)
    simulation.context.setVelocitiesToTemperature(300, seed)
    # τ_2 of the sphere of equal area.
    steps = round(duration * vesicle.tau_2 / samples / time_step)
    energies = [vesicle.energies(simulation.context)["bending"]]
    for _ in range(samples):
        simulation.step(steps)
        energies.append(vesicle.energies(simulation.context)["bending"])
    return {
        "energies": np.array(energies),
        "times": np.arange(samples + 1) * steps * time_step / vesicle.tau_2,
        "tau_2": vesicle.tau_2,
    }


def settling_time(times, energies):
    """When the energy, a mean over seeds, comes to stay near its plateau.

    The plateau is the mean of the last half; near it are values that differ by less than BAND of
    the largest difference in the run. Means over windows of 0.1 τ_2 are looked at.

    Parameters
    ----------
    times : array_like
        In τ_2, at equal intervals.
    energies : array_like
        At these times, kJ/mol.

    Returns
    -------
    settled : float
        The end of the first window from which on all are near, in τ_2.
    plateau, band : float
        The plateau, and how far from it is near, kJ/mol.
    """
    width = max(1, round(0.1 / (times[1] - times[0])))
    count = len(energies) // width
    windows = energies[: count * width].reshape(count, width).mean(axis=1)
    ends = np.append(times[width - 1 : count * width : width], np.inf)
    plateau = energies[len(energies) // 2 :].mean()
    band = BAND * abs(energies - plateau).max()
    away = np.flatnonzero(abs(windows - plateau) > band)
    return ends[away[-1] + 1 if len(away) else 0], plateau, band


def drift(runs):
    """How far the last quarter of each run lies above the quarter before it, kJ/mol.

    Parameters
    ----------
    runs : array_like
        Energies in time, shape (num_runs, num_times), kJ/mol.

    Returns
    -------
    float, float
        The mean over the runs and its standard error.
    """
    quarter = np.shape(runs)[1] // 4
    late = np.asarray(runs)[:, -quarter:].mean(axis=1)
    return mean_and_error(late - np.asarray(runs)[:, -2 * quarter : -quarter].mean(axis=1))


def main():
    import matplotlib.pyplot as plt

    figure = Figure("fig11", "Fig. 11", "Relaxation of oblate and prolate starts", __doc__)
    duration = figure.choose(3.0, 2.0)
    time_step = figure.choose(0.2, 0.5)
    seeds = figure.choose(10, 2)
    volumes = figure.choose([0.95, 0.8, 0.6], [0.9])
    points = grid(
        shape=["oblate", "prolate"],
        reduced_volume=volumes,
        softness=[0.037],
        subdivision=[10],
        duration=[duration],
        samples=[round(100 * duration)],
        time_step=[time_step],
        seed=range(1, seeds + 1),
    )
    results = figure.sweep(relaxation, points, description="relaxations")
    count = 10 * points[0]["subdivision"] ** 2 + 2
    tau = results[0]["tau_2"]
    figure.parameters(
        f"N = {count}, κ = 20 kBT, Jülicher, Ξ = 0.037, LangevinMiddle, γ = 0.01/ps, 300 K, "
        f"Δt = {time_step:g} ps, {seeds} runs of {duration:g} τ_2 each, τ_2 = {tau:.0f} ps."
    )
    graph, axes = plt.subplots(1, len(volumes), figsize=(3.6 * len(volumes), 3.4), squeeze=False)
    for axis, volume in zip(axes[0], volumes, strict=True):
        for shape in ("oblate", "prolate"):
            runs = [
                result
                for point, result in zip(points, results, strict=True)
                if (point["shape"], point["reduced_volume"]) == (shape, volume)
            ]
            times = runs[0]["times"]
            mean, error = mean_and_error([run["energies"] for run in runs])
            late = np.mean([run["energies"][len(times) // 2 :].mean() for run in runs])
            spread = mean_and_error([r["energies"][len(times) // 2 :].mean() for r in runs])[1]
            settled, plateau, band = settling_time(times, mean)
            figure.claim(
                f"{shape}, ν = {volume:g}: E_b settles",
                f"{settled:.2f} τ_2, from {mean[0]:.0f} to {plateau:.0f} ± {spread:.0f} kJ/mol",
                f"within {band:.0f} kJ/mol from τ_2 on",
                settled < 1,
            )
            rise, uncertain = drift([run["energies"] for run in runs])
            figure.check(
                f"{shape}, ν = {volume:g}: last quarter less the one before",
                rise,
                0,
                band,
                uncertain,
                " kJ/mol",
            )
            late_half = np.array([run["energies"][len(times) // 2 :] for run in runs])
            figure.note(
                f"{shape}, ν = {volume:g}: in the second half single runs are between "
                f"{late_half.min():.0f} and {late_half.max():.0f} kJ/mol."
            )
            [line] = axis.plot(times, mean, lw=0.8, label=shape)
            axis.fill_between(times, mean - error, mean + error, color=line.get_color(), alpha=0.3)
            axis.axhline(late, color=line.get_color(), lw=0.6, ls=":")
        axis.set(xlabel="$t / τ_2$", title=f"ν = {volume:g}")
        axis.legend(fontsize=7)
    axes[0][0].set_ylabel("$E_b$ (kJ/mol)")
    graph.set_layout_engine("constrained")
    figure.save(graph, "", "Mean bending energies over the seeds, with their standard errors.")
    figure.finish()


if __name__ == "__main__":
    main()
