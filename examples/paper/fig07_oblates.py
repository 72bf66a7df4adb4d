"""Fig. 7 and Fig. 8 of the supplement: vesicles of reduced volume 1 to 0.1 from affine oblates.

Each run starts from a sphere flattened to its reduced volume, soft (Ξ = 0.037), and gets harder in
a slow ramp of the least triangle height d to one of four softnesses. Then it runs on; the second
half gives the averages. Harder triangles cannot take the shapes of small reduced volume: there the
energy of the heights ⟨U_h⟩ rises.
"""

import numpy as np
from _paper import Figure, fastest_platform, mean_and_error
from _snapshots import along_axes, draw_meshes
from openmmhelfrich.sweep import grid

SOFTEST = 0.037
SAMPLES = 200


def oblate_run(reduced_volume, softness, duration, time_step, subdivision, seed):
    """Run one vesicle; the last shape, and energies per term at SAMPLES times after the ramp."""
    import openmm
    import openmmhelfrich as helfrich
    from openmm import unit

    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
    mesh = mesh.oblate(min(reduced_volume, mesh.reduced_volume))
    vesicle = helfrich.Vesicle(
        mesh,
        rigidity=50,
        softness=SOFTEST,
        scheme=helfrich.BendingForce.GompperKrollBarycentric,
    )
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, time_step)
    integrator.setRandomNumberSeed(seed)
    simulation = vesicle.simulation(integrator, fastest_platform())
    if vesicle.energies(simulation.context)["heights"] > vesicle.epsilon * mesh.num_vertices:
        # The flattest starts have triangles of nearly no height at their rim.
        simulation.minimizeEnergy(maxIterations=200)
    simulation.context.setVelocitiesToTemperature(300, seed)
    ramp = round(0.2 * duration / time_step)
    rows = []
    failed = ""
    shape = mesh.vertices
    try:
        if softness != SOFTEST:
            heights = vesicle.placement.heights
            helfrich.harden(simulation, heights, mesh.min_height(softness), ramp)
        else:
            simulation.step(ramp)
        for _ in range(SAMPLES):
            simulation.step(round(0.8 * duration / time_step / SAMPLES))
            rows.append(list(vesicle.energies(simulation.context).values()))
            state = simulation.context.getState(positions=True)
            shape = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    except openmm.OpenMMException as error:
        failed = str(error)
    return {
        "energies": np.array(rows).reshape(-1, 4),
        "shape": shape,
        "triangles": mesh.triangles,
        "failed": failed,
    }


def dimple(mesh):
    """Thickness in the middle over the largest one, of a disc whose axis is z; 1 without dimple."""
    rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    rings = np.minimum((8 * rho / np.percentile(rho, 98)).astype(int), 8)
    z = abs(mesh.vertices[:, 2])
    profile = np.array([z[rings == ring].mean() for ring in range(8)])
    return profile[0] / profile.max()


def main():
    import matplotlib.pyplot as plt
    import openmmhelfrich as helfrich

    figure = Figure("fig07", "Fig. 7, SM 8", "Vesicles of reduced volume 1 to 0.1", __doc__)
    volumes = figure.choose(np.arange(10, 0, -1) / 10, [1.0, 0.6, 0.3])
    softnesses = figure.choose([0.037, 0.15, 0.33, 0.59], [0.037, 0.59])
    duration = figure.choose(50_000.0, 10_000.0)
    common = {
        "duration": [duration],
        "time_step": [figure.choose(0.2, 1.0)],
        "subdivision": [figure.choose(10, 5)],
        "seed": [1],
    }
    points = grid(reduced_volume=volumes, softness=softnesses, **common)
    results = figure.sweep(oblate_run, points, description="oblates")
    table = {
        (point["reduced_volume"], point["softness"]): result
        for point, result in zip(points, results, strict=True)
    }
    count = 10 * common["subdivision"][0] ** 2 + 2
    figure.parameters(
        f"N = {count}, κ = 50 kJ/mol, GKB, kA and kV of the paper, LangevinMiddle, γ = 0.01/ps, "
        f"300 K, {duration / 1000:g} ns, of which a fifth is the ramp of d, "
        f"Δt = {common['time_step'][0]:g} ps."
    )
    stable = [key for key, result in table.items() if not result["failed"]]
    soft = [key for key in table if key[1] <= 0.15]
    figure.claim(
        "soft meshes (Ξ ≤ 0.15) run to the end",
        f"{sum(key in stable for key in soft)} of {len(soft)}",
        "all",
        all(key in stable for key in soft),
    )
    disc = along_axes(helfrich.Mesh(table[0.6, SOFTEST]["shape"], table[0.6, SOFTEST]["triangles"]))
    figure.claim(
        "ν = 0.6, Ξ = 0.037 is a discocyte",
        f"thickness in the middle / at the rim = {dimple(disc):.2f}",
        "< 0.75",
        dimple(disc) < figure.choose(0.75, 0.95),
    )
    hard, softest = max(softnesses), min(softnesses)

    def heights(volume, softness):
        """⟨U_h⟩ per vertex and its standard error, from five blocks of the second half."""
        energies = table[volume, softness]["energies"][SAMPLES // 2 :, 3] / count
        return mean_and_error([block.mean() for block in np.array_split(energies, 5)])

    lowest = min(volume for volume in volumes if (volume, hard) in stable)
    (round_mean, round_error), (flat_mean, flat_error) = heights(1.0, hard), heights(lowest, hard)
    figure.claim(
        f"⟨U_h⟩ of Ξ = {hard:g} rises from ν = 1 to {lowest:g}",
        f"{round_mean:.3f} ± {round_error:.3f} to {flat_mean:.3f} ± {flat_error:.3f} kJ/mol per "
        f"vertex, × {flat_mean / round_mean:.2f}",
        "a rise of more than 5 standard errors",
        flat_mean - round_mean > 5 * np.hypot(round_error, flat_error),
    )
    figure.table(
        "⟨E_b⟩ over the second half, kJ/mol:",
        ["ν", *(f"Ξ = {softness:g}" for softness in softnesses)],
        [
            [f"{volume:g}"]
            + [
                f"{table[volume, softness]['energies'][SAMPLES // 2 :, 2].mean():.0f}"
                if (volume, softness) in stable
                else "failed"
                for softness in softnesses
            ]
            for volume in volumes
        ],
    )
    figure.note(
        "Nothing keeps distant parts of a membrane apart, so that at small ν opposite sides touch "
        "and pass through each other."
    )
    for key, result in table.items():
        if result["failed"]:
            figure.note(f"ν = {key[0]:g}, Ξ = {key[1]:g} failed: {result['failed'][:120]}")

    graph, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for softness in softnesses:
        found = [volume for volume in volumes if (volume, softness) in stable]
        energies = [table[volume, softness]["energies"][SAMPLES // 2 :] for volume in found]
        for axis, column in zip(axes, (2, 3), strict=True):
            axis.plot(
                found,
                [each[:, column].mean() for each in energies],
                "o-",
                label=f"Ξ = {softness:g}",
            )
    axes[0].set(xlabel="reduced volume ν", ylabel="⟨E_b⟩ (kJ/mol)")
    axes[1].set(xlabel="reduced volume ν", ylabel="⟨U_h⟩ (kJ/mol)", yscale="log")
    axes[0].legend()
    figure.save(graph, "_energies", "Bending and height energies against reduced volume.")
    panels, views = [], []
    for softness in (softest, hard):
        for view in ("tilted", "cut"):
            for volume in volumes:
                result = table[volume, softness]
                title = f"ν = {volume:g}, Ξ = {softness:g}"
                try:
                    mesh = helfrich.Mesh(result["shape"], result["triangles"])
                except helfrich.MeshError:
                    # It blew up; its start stands in for it.
                    mesh = helfrich.Mesh.icosphere(common["subdivision"][0], 1000.0)
                    mesh = mesh.oblate(min(volume, mesh.reduced_volume))
                title += " (failed)" if result["failed"] else ""
                panels.append((title, along_axes(mesh), None))
                views.append(view)
    path = figure.picture(
        "", f"Last shapes at Ξ = {softest:g} (above) and {hard:g} (below), whole and cut in halves."
    )
    draw_meshes(path, panels, len(volumes), views=views, edges=False, size=figure.choose(150, 250))
    figure.finish()


if __name__ == "__main__":
    main()
