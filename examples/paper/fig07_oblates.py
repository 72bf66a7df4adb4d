"""Fig. 7 and Fig. 8 of the supplement: vesicles of reduced volume 1 to 0.1 from affine oblates.

Each run starts from a sphere flattened to its reduced volume, soft (Ξ = 0.037), and gets harder in
a slow ramp of the least triangle height d to one of four softnesses. Then it runs on; the second
half gives the averages. Harder triangles cannot take the shapes of small reduced volume: there the
energy of the heights ⟨U_h⟩ rises.
"""

import matplotlib.pyplot as plt
import numpy as np
import openmmhelfrich as helfrich
from _paper import Figure
from _snapshots import along_axes, draw_meshes
from openmmhelfrich.analysis import mean_with_error
from openmmhelfrich.sweep import grid

SOFTEST = 0.037
SAMPLES = 200


def oblate_run(reduced_volume, softness, duration, time_step, subdivision, seed):
    """Run one vesicle from an oblate, with a ramp of the heights and some time after it.

    Parameters
    ----------
    reduced_volume : float
        ν of the oblate.
    softness : float
        Ξ at the end of the ramp, which starts at SOFTEST.
    duration, time_step : float
        ps; a fifth of the duration is the ramp.
    subdivision : int
        n of N = 10 n² + 2.
    seed : int
        Of velocities and noise.

    Returns
    -------
    dict
        "energies" per term at SAMPLES times after the ramp, shape (SAMPLES, 4), kJ/mol; the last
        "shape", shape (N, 3), nm, and its "triangles"; "failed", why the run ended early, or "".
    """
    import openmm
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
    simulation = vesicle.simulation(integrator)
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


def upright(vesicle):
    """The last shape of a vesicle, its axis along z."""
    return along_axes(helfrich.Mesh(vesicle["shape"], vesicle["triangles"]))


def dimple(mesh):
    """Thickness in the middle over the largest one, of a disc whose axis is z; 1 without dimple."""
    rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    rings = np.minimum((8 * rho / np.percentile(rho, 98)).astype(int), 8)
    z = abs(mesh.vertices[:, 2])
    profile = np.array([z[rings == ring].mean() for ring in range(8)])
    return profile[0] / profile.max()


def main():
    figure = Figure("fig07", "Fig. 7, SM 8", "Vesicles of reduced volume 1 to 0.1", __doc__)
    volumes = figure.choose(np.arange(10, 0, -1) / 10, [1.0, 0.6, 0.3])
    softnesses = figure.choose([0.037, 0.15, 0.33, 0.59], [0.037, 0.59])
    duration, time_step = figure.choose((50_000.0, 0.2), (10_000.0, 1.0))
    subdivision = figure.choose(10, 5)
    points = grid(
        reduced_volume=volumes,
        softness=softnesses,
        duration=[duration],
        time_step=[time_step],
        subdivision=[subdivision],
        seed=[1],
    )
    results = figure.sweep(oblate_run, points, description="oblates")
    vesicles = {
        (point["reduced_volume"], point["softness"]): result
        for point, result in zip(points, results, strict=True)
    }
    count = 10 * subdivision**2 + 2
    figure.parameters(
        f"N = {count}, κ = 50 kJ/mol, GKB, kA and kV of the paper, LangevinMiddle, γ = 0.01/ps, "
        f"300 K, {duration / 1000:g} ns, of which a fifth is the ramp of d, Δt = {time_step:g} ps."
    )
    check(figure, vesicles, count)
    note(figure, vesicles, volumes, softnesses)
    draw_energies(figure, vesicles, volumes, softnesses)
    draw_shapes(figure, vesicles, volumes, (min(softnesses), max(softnesses)), subdivision)
    figure.finish()


def second_half(vesicle, column):
    """Energies of one term in the second half of the samples, kJ/mol."""
    return vesicle["energies"][SAMPLES // 2 :, column]


def check(figure, vesicles, count):
    stable = [key for key, vesicle in vesicles.items() if not vesicle["failed"]]
    soft = [key for key in vesicles if key[1] <= 0.15]
    figure.claim(
        "soft meshes (Ξ ≤ 0.15) run to the end",
        f"{sum(key in stable for key in soft)} of {len(soft)}",
        "all",
        all(key in stable for key in soft),
    )
    disc = vesicles[0.6, SOFTEST]
    thickness = dimple(upright(disc))
    # A coarse mesh that has run for a short time is a shallow one.
    limit = figure.choose(0.75, 0.95)
    figure.claim(
        "ν = 0.6, Ξ = 0.037 is a discocyte",
        f"thickness in the middle / at the rim = {thickness:.2f}",
        f"< {limit:g}",
        thickness < limit,
    )
    hard = max(softness for _, softness in vesicles)
    lowest = min(volume for volume, softness in stable if softness == hard)
    (round_mean, round_error, *_), (flat_mean, flat_error, *_) = (
        mean_with_error(second_half(vesicles[volume, hard], 3) / count) for volume in (1.0, lowest)
    )
    figure.claim(
        f"⟨U_h⟩ of Ξ = {hard:g} rises from ν = 1 to {lowest:g}",
        f"{round_mean:.3f} ± {round_error:.3f} to {flat_mean:.3f} ± {flat_error:.3f} kJ/mol per "
        f"vertex, × {flat_mean / round_mean:.2f}",
        "a rise of more than 5 standard errors",
        flat_mean - round_mean > 5 * np.hypot(round_error, flat_error),
    )


def note(figure, vesicles, volumes, softnesses):
    for column, symbol, digits in ((2, "⟨E_b⟩", 0), (3, "⟨U_h⟩", 1)):
        figure.table(
            f"{symbol} over the second half, kJ/mol:",
            ["ν", *(f"Ξ = {softness:g}" for softness in softnesses)],
            [
                [f"{volume:g}"]
                + [
                    "failed"
                    if vesicles[volume, softness]["failed"]
                    else f"{second_half(vesicles[volume, softness], column).mean():.{digits}f}"
                    for softness in softnesses
                ]
                for volume in volumes
            ],
        )
    figure.table(
        "The paper describes a discocyte near ν = 0.6. Thickness in the middle over that at the "
        "rim of the last shapes; below ν = 0.5 the middle has gone through itself and bulges out:",
        ["ν", *(f"Ξ = {softness:g}" for softness in softnesses)],
        [
            [f"{volume:g}"]
            + [
                "failed"
                if vesicles[volume, softness]["failed"]
                else f"{dimple(upright(vesicles[volume, softness])):.2f}"
                for softness in softnesses
            ]
            for volume in volumes
        ],
    )
    figure.note(
        "Nothing keeps distant parts of a membrane apart, so that at small ν opposite sides touch "
        "and pass through each other."
    )
    for (volume, softness), vesicle in vesicles.items():
        if vesicle["failed"]:
            figure.note(f"ν = {volume:g}, Ξ = {softness:g} failed: {vesicle['failed'][:120]}")


def draw_energies(figure, vesicles, volumes, softnesses):
    graph, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for softness in softnesses:
        found = [volume for volume in volumes if not vesicles[volume, softness]["failed"]]
        for axis, column in zip(axes, (2, 3), strict=True):
            means = [second_half(vesicles[volume, softness], column).mean() for volume in found]
            axis.plot(found, means, "o-", label=f"Ξ = {softness:g}")
    axes[0].set(xlabel="reduced volume ν", ylabel="⟨E_b⟩ (kJ/mol)")
    axes[1].set(xlabel="reduced volume ν", ylabel="⟨U_h⟩ (kJ/mol)", yscale="log")
    axes[0].legend()
    figure.save(graph, "_energies", "Bending and height energies against reduced volume.")


def draw_shapes(figure, vesicles, volumes, softnesses, subdivision):
    panels, views = [], []
    for softness in softnesses:
        for view in ("tilted", "cut"):
            for volume in volumes:
                vesicle = vesicles[volume, softness]
                title = f"ν = {volume:g}, Ξ = {softness:g}"
                try:
                    mesh = helfrich.Mesh(vesicle["shape"], vesicle["triangles"])
                except helfrich.MeshError:
                    # It blew up; its start stands in for it.
                    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
                    mesh = mesh.oblate(min(volume, mesh.reduced_volume))
                title += " (failed)" if vesicle["failed"] else ""
                panels.append((title, along_axes(mesh), None))
                views.append(view)
    soft, hard = softnesses
    path = figure.picture(
        "", f"Last shapes at Ξ = {soft:g} (above) and {hard:g} (below), whole and cut in halves."
    )
    draw_meshes(path, panels, len(volumes), views=views, edges=False, size=figure.choose(150, 250))


if __name__ == "__main__":
    main()
