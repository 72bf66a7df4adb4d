"""Figs. 3 and 4 of the supplement: how areas of triangles and lengths of bonds get distributed.

Random meshes, and ordered ones, run for 1100 τ_h with the potentials of area, volume and heights
only, in Verlet dynamics from velocities of 300 K; τ_h = d √(m/ε). The paper has the distributions
stationary by 6.5 τ_h. That is tested between two windows of time, from 6.5 τ_h on and over the last
half. The independent samples are the runs: of each, the shares of values below three quantiles in
one window less those in the other; their mean is 0, or Hotelling's T² is large.
"""

import numpy as np
from _paper import Figure, mean_and_error
from fluctuations import parts_of
from scipy.stats import f as fisher

# When the paper has them stationary, and until when that is looked at, τ_h.
STATIONARY, UNTIL = 6.5, 26.0
# The quantiles of the last half whose shares are compared.
SHARES = (0.1, 0.5, 0.9)
# Of a hundred thousand right theories one hundred look as bad by chance.
CHANCE = 1e-3
LABELS = {"areas": "triangle area", "lengths": "bond length"}


def times_of(end):
    """When to look, τ_h, and the indices of the two windows that are compared."""
    early = np.array([0.0, 0.5, 1.0, 2.0, 3.0, 4.5, 6.5, 8.0, 10.0, 12.0, 16.0, 20.0, 26.0])
    middle = np.geomspace(32, end / 2.2, 5)
    late = np.linspace(end / 2, end, 12)
    times = np.concatenate([early, middle, late])
    return times, np.flatnonzero((times >= STATIONARY) & (times <= UNTIL)), len(times) - 12


def distributions(kind, num_vertices, softness, time_step, times, seed):
    """Areas of triangles and lengths of bonds in one run.

    Parameters
    ----------
    kind : str
        "random", a mesh of its own for each seed, or "ordered".
    num_vertices : int
        N, that of an ordered mesh 10 n² + 2.
    softness : float
        Ξ.
    time_step : float
        ps.
    times : list of float
        When to look, τ_h.
    seed : int
        Of the mesh and of the velocities.

    Returns
    -------
    dict
        "areas" and "lengths" over their means, shapes (len(times), num_triangles) and (len(times),
        num_edges); "temperatures", K; "energies", total, kJ/mol; "tau_heights", τ_h, ps;
        "min_height", d, nm; "vertices", shape (len(times), num_vertices, 3), nm, and "triangles".
    """
    import openmm
    import openmmhelfrich as helfrich
    from openmm import unit
    from openmmhelfrich.analysis import edge_lengths, triangle_areas
    from openmmhelfrich.analysis.theory import BOLTZMANN

    if kind == "random":
        mesh = helfrich.Mesh.random_sphere(num_vertices, 1000.0, seed)
    else:
        mesh = helfrich.Mesh.icosphere(parts_of(num_vertices), 1000.0)
    vesicle = helfrich.Vesicle(mesh, rigidity=0, softness=softness)
    simulation = vesicle.simulation(openmm.VerletIntegrator(time_step))
    simulation.context.setVelocitiesToTemperature(300, seed)
    frames, temperatures, energies = [], [], []
    for time in times:
        simulation.step(round(time * vesicle.tau_heights / time_step) - simulation.currentStep)
        state = simulation.context.getState(positions=True, energy=True)
        frames.append(state.getPositions(asNumpy=True).value_in_unit(unit.nanometer))
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        potential = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
        temperatures.append(2 * kinetic / (3 * mesh.num_vertices * BOLTZMANN))
        energies.append(kinetic + potential)
    areas = triangle_areas(np.array(frames), mesh.triangles)
    lengths = edge_lengths(np.array(frames), mesh.triangles)
    return {
        "areas": (areas / areas.mean(axis=1, keepdims=True)).astype(np.float32),
        "lengths": (lengths / lengths.mean(axis=1, keepdims=True)).astype(np.float32),
        "temperatures": np.array(temperatures),
        "energies": np.array(energies),
        "tau_heights": vesicle.tau_heights,
        "min_height": vesicle.min_height,
        "vertices": np.array(frames, dtype=np.float32),
        "triangles": np.asarray(mesh.triangles),
    }


def points_of(quick):
    """The arguments of all runs, the random meshes first; SM IV takes these runs too."""
    times = times_of(130 if quick else 1100)[0]
    return [
        {
            "kind": kind,
            "num_vertices": 252 if quick else 1002,
            "softness": 0.037,
            "time_step": 0.5,
            "times": times.tolist(),
            "seed": seed,
        }
        for kind, count in (("random", 8 if quick else 24), ("ordered", 8 if quick else 12))
        for seed in range(1, count + 1)
    ]


def hotelling(differences):
    """T² of vectors whose mean should be 0, in units of F, and its chance.

    Parameters
    ----------
    differences : ndarray
        Shape (num_samples, k), independent samples.

    Returns
    -------
    tuple of float
        F = (n−k) n / k (n−1) · d̄ᵀ S⁻¹ d̄ and the probability of a larger one at mean 0.
    """
    n, k = differences.shape
    mean = differences.mean(axis=0)
    covariance = np.cov(differences, rowvar=False)
    value = n * (n - k) / (k * (n - 1)) * mean @ np.linalg.solve(covariance, mean)
    return float(value), float(fisher.sf(value, k, n - k))


def shares_below(values, limits):
    """The shares of values below limits in windows of runs, shape (num_runs, len(limits))."""
    return np.array([[(run < limit).mean() for limit in limits] for run in values])


def main():
    figure = Figure("sm03", "SM 3–4", "Distributions of areas and bond lengths", __doc__)
    points = points_of(figure.quick)
    results = figure.sweep(distributions, points, description="runs")
    runs = {
        kind: [run for point, run in zip(points, results, strict=True) if point["kind"] == kind]
        for kind in ("random", "ordered")
    }
    times = np.array(points[0]["times"])
    tau = results[0]["tau_heights"]
    counts = " and ".join(f"{len(some)} {kind}" for kind, some in runs.items())
    figure.parameters(
        f"N = {points[0]['num_vertices']}, Ξ = {points[0]['softness']:g} (d = "
        f"{results[0]['min_height']:.1f} nm), {counts} meshes with U_A, U_V and U_h, Verlet, "
        f"Δt = 0.5 ps, velocities of 300 K at the start, {times[-1]:g} τ_h."
    )
    # 45 ps at N = 1002; d goes as the spacing of the vertices.
    expected = 45 * (1002 / points[0]["num_vertices"]) ** 0.5
    figure.check("τ_h = d √(m/ε)", tau, expected, 0.01 * expected, unit=" ps")
    for kind, some in runs.items():
        check(figure, kind, some)
    drift = [abs(run["energies"][-1] - run["energies"][0]) / run["energies"][0] for run in results]
    figure.check("energy of a run, largest drift of all over it", max(drift), 0, 0.01)
    temperature = np.mean([run["temperatures"] for run in runs["random"]], axis=0)
    figure.note(
        f"The temperature falls from {temperature[0]:.0f} K to {temperature[-1]:.0f} K, since the "
        "start has no potential energy."
    )
    draw(figure, times, runs)
    figure.finish()


def check(figure, kind, runs):
    """Stationarity of one kind of mesh by 6.5 τ_h, and that the test sees what is not."""
    times, early, first = times_of(130 if figure.quick else 1100)
    for name, label in LABELS.items():
        data = np.array([run[name] for run in runs])
        late = data[:, first:].reshape(len(runs), -1)
        limits = np.quantile(late, SHARES)
        at_end = shares_below(late, limits)
        for what, window, wanted in (
            (f"the same from {STATIONARY:g} to {UNTIL:g} τ_h as", early, True),
            ("at 1 τ_h another than", [int(np.argmax(times == 1.0))], False),
        ):
            there = shares_below(data[:, window].reshape(len(runs), -1), limits)
            value, chance = hotelling(there - at_end)
            figure.claim(
                f"{kind}, {label}: distribution {what} from {times[first]:g} to {times[-1]:g} τ_h",
                f"F = {value:.2f}, chance {chance:.2g}",
                f"chance {'above' if wanted else 'below'} {CHANCE:g}",
                (chance > CHANCE) == wanted,
                "the widths swing about their last value until some 20 τ_h, see the figure: "
                "vertices fly freely and collide for the first time together",
            )
        spread = data.std(axis=2)
        early_mean, later = spread[:, early].mean(axis=1), spread[:, first:].mean(axis=1)
        change, error = mean_and_error(early_mean - later)
        # The paper's ± 0.005 for lengths; areas go as their squares, with a half larger spread.
        tolerance = 0.005 if name == "lengths" else 0.015
        figure.check(
            f"{kind}, {label}: standard deviation over mean, from {STATIONARY:g} to {UNTIL:g} τ_h "
            "less the last half",
            change,
            0,
            tolerance,
            error,
            why="the widths swing about their last value until some 20 τ_h, see the figure",
        )
        widths, width_error = mean_and_error(later)
        start = spread[:, 0].mean()
        figure.note(
            f"{kind}, {label}: standard deviation over mean {start:.3f} at the start, "
            f"{widths:.4f} ± {width_error:.4f} in the last half."
        )


def draw(figure, times, runs):
    import matplotlib.pyplot as plt

    graph, axes = plt.subplots(2, 3, figsize=(11, 6.4), layout="constrained")
    styles = {"random": "-", "ordered": "--"}
    for row, (name, label) in zip(axes, LABELS.items(), strict=True):
        for kind, some in runs.items():
            data = np.array([run[name] for run in some])
            # Bond lengths are those of the paper, at ± 0.005.
            bins = np.arange(0, 3, 0.01 if name == "lengths" else 0.02)
            if kind == "random":
                for time in (0.5, 1.0, 2.0, STATIONARY, 12.0):
                    values = data[:, np.argmax(times == time)].ravel()
                    row[0].hist(values, bins, density=True, histtype="step", label=f"{time:g} τ_h")
            row[1].hist(
                data[:, -12:].ravel(),
                bins,
                density=True,
                histtype="step",
                ls=styles[kind],
                label=f"{kind}, last half",
            )
            mean, error = mean_and_error(data.std(axis=2))
            row[2].errorbar(times, mean, error, fmt=f"o{styles[kind]}", ms=3, lw=1, label=kind)
        for axis in row[:2]:
            axis.set(xlabel=f"{label} / mean", ylabel="probability density", xlim=(0, 3))
            axis.legend(fontsize=7)
        row[2].axvline(STATIONARY, color="gray", lw=0.8, ls=":")
        row[2].set(xlabel="t / τ_h", ylabel=f"{label}: standard deviation / mean")
        row[2].set_xscale("symlog", linthresh=1)
        row[2].set_xlim(0, None)
        row[2].legend(fontsize=7)
    figure.save(graph, "", "Distributions at several times, in the last half, and their widths.")


if __name__ == "__main__":
    main()
