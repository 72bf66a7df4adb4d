"""Fig. 11: how the bending energy of oblate and prolate starts relaxes.

Random spheres deformed to an oblate or a prolate of a given reduced volume run in Langevin and in
Verlet dynamics. Their bending energies, means over the runs, settle in less than the period τ_2 of
the slowest mode. What still drifts is not called relaxed: the slope of the last third must be
within two standard errors of 0.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from oblates import slope

# Energies have settled that differ from the plateau by less than this share of their largest
# difference from it.
BAND = 0.05
INTEGRATORS = {"langevin": "LangevinMiddle", "verlet": "Verlet"}
SOFTNESS, COUNT, RADIUS = 0.037, 1002, 1000.0


def relaxation(
    mesh, shape, reduced_volume, integrator, num_vertices, duration, samples, time_step, seed
):
    """Bending energy of one run from an oblate or a prolate.

    Parameters
    ----------
    mesh : str
        "ordered" or "random".
    shape : str
        "oblate" or "prolate".
    reduced_volume : float
        ν of the start.
    integrator : str
        "langevin" or "verlet".
    num_vertices : int
        N, 10 n² + 2 for an ordered mesh.
    duration : float
        τ_2.
    samples : int
        Number of equal intervals after each of which the energy is read.
    time_step : float
        ps.
    seed : int
        Of the mesh, velocities and noise.

    Returns
    -------
    dict
        "energies", shape (samples + 1,), kJ/mol, at "times", τ_2, fewer if the run failed;
        "failed", why it did, or ""; "tau_2", ps; "temperature", K, the mean over the last third.
    """
    import openmm
    import openmmhelfrich as helfrich
    from fluctuations import integrator_of, parts_of
    from openmm import unit

    if mesh == "ordered":
        sphere = helfrich.Mesh.icosphere(parts_of(num_vertices), RADIUS)
    else:
        sphere = helfrich.Mesh.random_sphere(num_vertices, RADIUS, seed)
    vesicle = helfrich.Vesicle(getattr(sphere, shape)(reduced_volume), softness=SOFTNESS)
    simulation = vesicle.simulation(integrator_of(integrator, 0.01, time_step, seed))
    context = simulation.context
    context.setVelocitiesToTemperature(300, seed)
    # τ_2 of the sphere of equal area.
    steps = round(duration * vesicle.tau_2 / samples / time_step)
    energies, kinetic = [vesicle.energies(context)["bending"]], []
    failed = ""
    for _ in range(samples):
        try:
            simulation.step(steps)
        except openmm.OpenMMException as error:
            failed = str(error)
            break
        energies.append(vesicle.energies(context)["bending"])
        energy = context.getState(energy=True).getKineticEnergy()
        kinetic.append(energy.value_in_unit(unit.kilojoule_per_mole))
    late = np.mean(kinetic[-(samples // 3) :]) if kinetic else 0.0
    per_kelvin = 1.5 * num_vertices * helfrich.analysis.theory.BOLTZMANN
    return {
        "failed": failed,
        "energies": np.array(energies),
        "times": np.arange(len(energies)) * steps * time_step / vesicle.tau_2,
        "tau_2": vesicle.tau_2,
        "temperature": float(late / per_kelvin),
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
    """How far the energies drift over the last third of their runs, by the slope of a line.

    Parameters
    ----------
    runs : array_like
        Energies in time, shape (num_runs, num_times), kJ/mol.

    Returns
    -------
    float, float
        The mean over the runs and its standard error, kJ/mol: that of their scatter, or that of the
        lines where it is larger, as runs that are few may agree by chance.
    """
    runs = np.asarray(runs)
    third = runs.shape[1] // 3
    changes, errors = np.transpose([slope(run[-third:]) for run in runs])
    mean, error = mean_and_error(changes)
    return float(mean), float(np.fmax(error, np.sqrt(errors @ errors) / len(runs)))


def points_of(starts, runs, duration, time_step):
    """The points of the sweep: random meshes, and a few icospheres under Langevin beside them."""
    points = []
    for mesh, integrator, seeds in (
        ("random", "langevin", runs),
        ("random", "verlet", runs),
        ("ordered", "langevin", max(1, runs // 5)),
    ):
        for shape, volume in starts:
            point = {"mesh": mesh, "shape": shape, "reduced_volume": volume}
            point |= {"integrator": integrator, "num_vertices": COUNT, "time_step": time_step}
            point |= {"duration": duration, "samples": round(100 * duration)}
            points += [{**point, "seed": seed} for seed in range(1, seeds + 1)]
    return points


def main():
    figure = Figure("fig11", "Fig. 11", "Relaxation of oblate and prolate starts", __doc__)
    duration, runs = figure.choose((3.0, 20), (2.0, 3))
    volumes = figure.choose([0.95, 0.8, 0.6, 0.4], [0.9])
    starts = [
        (shape, volume)
        for volume in volumes
        for shape in ("oblate", "prolate")
        # Opposite sides of the flattest disc pass through each other, see fig07_oblates.py.
        if (shape, volume) != ("oblate", 0.4)
    ]
    time_step = figure.choose(0.6, 0.8)
    points = points_of(starts, runs, duration, time_step)
    results = figure.sweep(relaxation, points, description="relaxations")
    found = {}
    for point, result in zip(points, results, strict=True):
        key = point["mesh"], point["integrator"], point["shape"], point["reduced_volume"]
        found.setdefault(key, []).append(result)
    figure.parameters(
        f"{runs} random meshes of N = {COUNT} for each start and integrator, κ = 20 kBT, Jülicher, "
        f"Ξ = {SOFTNESS:g}, LangevinMiddle with γ = 0.01/ps and Verlet, from velocities of 300 K, "
        f"Δt = {time_step:g} ps, {duration:g} τ_2, τ_2 = {results[0]['tau_2']:.0f} ps."
    )
    check_lived(figure, found)
    # What is left are the runs that went to the end.
    found = {key: [r for r in runs if not r.get("failed")] for key, runs in found.items()}
    found = {key: runs for key, runs in found.items() if runs}
    for key in found:
        if key[0] == "random":
            check(figure, key, found)
    tabulate(figure, found)
    draw(figure, found, volumes)
    figure.finish()


def check_lived(figure, found):
    """How many runs from each start went to the end."""
    for (mesh, integrator, shape, volume), runs in found.items():
        failed = [run for run in runs if run.get("failed")]
        if mesh != "random" and not failed:
            continue
        figure.claim(
            f"{INTEGRATORS[integrator]}, {mesh}, {shape}, ν = {volume:g}: runs to the end",
            f"{len(runs) - len(failed)} of {len(runs)}",
            "all",
            not failed,
        )
        if failed:
            times = ", ".join(f"{run['times'][-1]:.2f}" for run in failed)
            figure.note(
                f"{INTEGRATORS[integrator]}, {mesh}, {shape}, ν = {volume:g}: failed after {times} "
                f"τ_2. The first: {failed[0]['failed'][:110]}"
            )


def check(figure, key, found):
    _, integrator, shape, volume = key
    runs = [result["energies"] for result in found[key]]
    mean, _ = mean_and_error(runs)
    settled, plateau, band = settling_time(found[key][0]["times"], mean)
    change, error = drift(runs)
    name = f"{INTEGRATORS[integrator]}, {shape}, ν = {volume:g}"
    why = ""
    twin = found.get(("random", integrator, "oblate", volume))
    if shape == "prolate" and twin and late_mean(twin)[0] < plateau:
        why = (
            "the plateau of the prolate lies above that of the oblate of the same ν, see the "
            "table: it is on its way"
        )
    still = figure.check(
        f"{name}: E_b drifts over the last third", change, 0, 2 * error, error, " kJ/mol", why
    )
    figure.claim(
        f"{name}: E_b relaxes",
        f"{_settling(settled, still)}, from {mean[0]:.0f} to {plateau:.0f} kJ/mol",
        f"within {band:.0f} kJ/mol from τ_2 on, without a drift",
        settled < 1 and still,
        why,
    )


def _settling(settled, still):
    """When an energy has settled, τ_2, in words."""
    if not np.isfinite(settled):
        return "does not stay near its last values"
    return f"{'settles' if still else 'drifts; is near its last values'} after {settled:.2f} τ_2"


def late_mean(results):
    """The mean energy of the last third of runs, kJ/mol, and its standard error."""
    return mean_and_error([r["energies"][-(len(r["energies"]) // 3) :].mean() for r in results])


def tabulate(figure, found):
    rows = []
    for (mesh, integrator, shape, volume), results in found.items():
        plateau, error = late_mean(results)
        change, uncertain = drift([result["energies"] for result in results])
        temperature = np.mean([result["temperature"] for result in results])
        row = [mesh, INTEGRATORS[integrator], shape, f"{volume:g}"]
        row += [f"{plateau:.0f} ± {error:.0f}", f"{change:.0f} ± {uncertain:.0f}"]
        rows.append([*row, f"{temperature:.0f}", f"{len(results)}"])
    figure.table(
        "The last third of the runs: mean of E_b and its drift, kJ/mol, and temperature, K:",
        ["mesh", "integrator", "start", "ν", "E_b", "drift", "T", "runs"],
        rows,
    )


def draw(figure, found, volumes):
    graph, axes = plt.subplots(
        2, len(volumes), figsize=(3.2 * len(volumes), 5.4), squeeze=False, layout="constrained"
    )
    for (mesh, integrator, shape, volume), results in found.items():
        axis = axes[list(INTEGRATORS).index(integrator)][volumes.index(volume)]
        mean, error = mean_and_error([result["energies"] for result in results])
        times = results[0]["times"]
        color = {"oblate": "C0", "prolate": "C1"}[shape]
        if mesh == "ordered":
            axis.plot(times, mean, ":", lw=0.7, color=color, label=f"{shape}, ordered")
            continue
        axis.plot(times, mean, lw=0.9, color=color, label=shape)
        axis.fill_between(times, mean - error, mean + error, color=color, alpha=0.3)
        axis.set_title(f"ν = {volume:g}, {INTEGRATORS[integrator]}", fontsize=9)
    for axis in axes.flat:
        if axis.lines:
            axis.legend(fontsize=7)
    for axis in axes[1]:
        axis.set_xlabel("$t / τ_2$")
    for row in axes:
        row[0].set_ylabel("$E_b$ (kJ/mol)")
    figure.save(graph, "", "Mean bending energies over the runs, with their standard errors.")


if __name__ == "__main__":
    main()
