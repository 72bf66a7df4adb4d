"""Fig. 7 and Fig. 8 of the supplement: vesicles of reduced volume 1 to 0.1 from affine oblates.

Each run starts from a random sphere flattened to its reduced volume, soft (Ξ = 0.037), and gets
harder in a slow ramp of the least triangle height d to one of four softnesses. Then it runs on; the
last third gives the averages. `analysis.crossings`, which knows nothing of the forces, looks for
triangles that pass through each other. Classes as in the paper: green is settled and intact, yellow
intact but still drifting or strained, red failed or crossing itself; see `oblates.class_of`.

--seeds N runs N random meshes for each point (default 1), one after the other.
"""

import argparse
from collections import Counter

import matplotlib.pyplot as plt
import numpy as np
import openmmhelfrich as helfrich
from _paper import Figure
from _snapshots import along_axes, draw_meshes
from oblates import (
    CLASSES,
    FRICTION,
    RAMP,
    RIGIDITY,
    SOFTEST,
    STRAINED,
    class_of,
    dimple,
    late,
    late_energy,
    oblate_run,
    over_seeds,
    start_of,
    upright,
)
from openmmhelfrich.sweep import grid

# What the paper shows as running well: soft meshes down to the discocyte.
SOFT, INTACT_FROM = 0.15, 0.6


def number_of_seeds():
    """The number of random meshes for each point, and the other arguments of the command line."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--seeds", type=int, default=1)
    options, rest = parser.parse_known_args()
    if options.seeds < 1:
        parser.error(f"--seeds: need 1 or more, got {options.seeds}")
    return options.seeds, rest


def main():
    seeds, rest = number_of_seeds()
    figure = Figure("fig07", "Fig. 7, SM 8", "Vesicles of reduced volume 1 to 0.1", __doc__, rest)
    volumes = figure.choose(np.arange(10, 0, -1) / 10, [1.0, 0.6, 0.3])
    softnesses = figure.choose([0.037, 0.15, 0.33, 0.59], [0.037, 0.59])
    periods, count = figure.choose((160, 1002), (2, 1002))
    points = grid(
        # A seed is finished before the next one begins.
        seed=range(1, seeds + 1),
        reduced_volume=volumes,
        softness=softnesses,
        periods=[periods],
        num_vertices=[count],
    )
    results = figure.sweep(oblate_run, points, description="oblates")
    vesicles = {}
    for point, result in zip(points, results, strict=True):
        vesicles.setdefault((point["reduced_volume"], point["softness"]), []).append(result)
    steps = ", ".join(
        f"{vesicles[volumes[0], softness][0]['time_step']:.2g} ps at Ξ = {softness:g}"
        for softness in softnesses
    )
    meshes = "One random mesh" if seeds == 1 else f"{seeds} random meshes"
    figure.parameters(
        f"{meshes} of N = {count}, κ = {RIGIDITY:g} kJ/mol, GKB, kA and kV of the "
        f"paper, LangevinMiddle, γ = {FRICTION:g}/ps, 300 K, {periods:g} τ_2, the first "
        f"{RAMP * periods:g} of which are the ramp of d, Δt = {steps}."
    )
    classes = classes_of(vesicles, max(volumes))
    check(figure, vesicles, classes, count)
    tabulate(figure, vesicles, classes, volumes, softnesses)
    draw_energies(figure, vesicles, volumes, softnesses)
    draw_classes(figure, classes, volumes, softnesses)
    draw_shapes(figure, vesicles, volumes, (min(softnesses), max(softnesses)), count)
    figure.finish()


def classes_of(vesicles, roundest):
    """The class of each vesicle, {(ν, Ξ): [class of each seed]}."""
    spheres = {
        softness: late_energy(found, 3)[0]
        for (volume, softness), found in vesicles.items()
        if volume == roundest
    }
    return {
        key: [class_of(each, spheres[key[1]]) for each in found] for key, found in vesicles.items()
    }


def check(figure, vesicles, classes, count):
    hard = max(softness for _, softness in vesicles)
    failed = [key for key, found in vesicles.items() for each in found if each["failed"]]
    soft_runs = sum(len(found) for (_, softness), found in vesicles.items() if softness <= SOFT)
    soft_failed = sum(softness <= SOFT for _, softness in failed)
    figure.claim(
        f"soft meshes (Ξ ≤ {SOFT:g}) run to the end",
        f"{soft_runs - soft_failed} of {soft_runs}",
        "all",
        soft_failed == 0,
    )
    good = [
        each
        for (volume, softness), found in classes.items()
        if softness <= SOFT and volume >= INTACT_FROM
        for each in found
    ]
    if figure.quick:
        # Short runs have not settled.
        intact = sum(each != "red" for each in good)
        wanted = "all green or yellow"
    else:
        intact, wanted = good.count("green"), "all green"
    figure.claim(
        f"soft meshes (Ξ ≤ {SOFT:g}) from ν = {INTACT_FROM:g} to 1",
        f"{intact} of {len(good)}",
        wanted,
        intact == len(good),
    )
    discs = [dimple(upright(each)) for each in vesicles[0.6, SOFTEST] if not each["failed"]]
    # A coarse mesh that has run for a short time is a shallow one.
    limit = figure.choose(0.75, 0.95)
    figure.claim(
        f"ν = 0.6, Ξ = {SOFTEST:g} is a discocyte in each run",
        f"thickness in the middle / at the rim = {', '.join(f'{each:.2f}' for each in discs)}",
        f"< {limit:g}",
        bool(discs) and max(discs) < limit,
    )
    roundest = max(volume for volume, _ in vesicles)
    sphere, error, _ = late_energy(vesicles[roundest, hard], 3)
    whole = [
        volume
        for volume in sorted({volume for volume, _ in vesicles} - {roundest})
        if "red" not in classes[volume, hard]
    ]
    # Without any that are whole there is no rise.
    rises = {volume: late_energy(vesicles[volume, hard], 3)[:2] for volume in whole}
    flat = max(rises, key=lambda volume: rises[volume][0], default=roundest)
    value, uncertain = rises.get(flat, (sphere, error))
    share, known = value / sphere - 1, np.hypot(error, uncertain)
    figure.claim(
        f"⟨U_h⟩ of Ξ = {hard:g} rises with less volume, of whole vesicles: most at ν = {flat:g}",
        f"{sphere / count:.3f} to {value / count:.3f} kJ/mol per vertex, {100 * share:.0f} %",
        "a rise of more than 5 %"
        + (" and three standard errors" if np.isfinite(known) else "; of one mesh, without error"),
        share > 0.05 and (not np.isfinite(known) or value - sphere > 3 * known),
    )
    order = list(CLASSES)
    mean = {
        softness: np.mean(
            [order.index(c) for (_, s), f in classes.items() if s == softness for c in f]
        )
        for softness in sorted({softness for _, softness in vesicles})
    }
    figure.claim(
        "mean class (0 green, 1 yellow, 2 red) of the hardest and of the softest mesh",
        f"{mean[hard]:.2f} and {mean[SOFTEST]:.2f}",
        "that of the hardest is no better",
        mean[hard] >= mean[SOFTEST],
    )


def tabulate(figure, vesicles, classes, volumes, softnesses):
    header = ["ν", *(f"Ξ = {softness:g}" for softness in softnesses)]

    def rows(cell):
        return [[f"{volume:g}", *(cell((volume, xi)) for xi in softnesses)] for volume in volumes]

    def numbers(value, digits):
        def cell(key):
            mean, error, number = over_seeds(vesicles[key], value)
            spread = "" if np.isnan(error) else f" ± {error:.{digits}f}"
            return f"{mean:.{digits}f}{spread}" if number else "failed"

        return cell

    def counted(key):
        return ", ".join(f"{n} {name}" for name, n in Counter(classes[key]).items())

    meaning = "; ".join(f"{name}: {what}" for name, what in CLASSES.items())
    figure.table(f"Classes ({meaning}):", header, rows(counted))
    for column, symbol, digits in ((2, "⟨E_b⟩", 0), (3, "⟨U_h⟩", 1)):
        value = numbers(lambda each, column=column: late(each, column).mean(), digits)
        figure.table(f"{symbol} over the last third, kJ/mol:", header, rows(value))
    figure.table(
        "Part of the tests at which the surface passed through itself:",
        header,
        rows(numbers(lambda each: (each["crossings"] > 0).mean(), 2)),
    )
    figure.table(
        "Thickness in the middle over that at the rim of the last shapes; where the surface has "
        "passed through itself the middle bulges out:",
        header,
        rows(numbers(lambda each: dimple(upright(each)), 2)),
    )
    figure.note(
        "Nothing keeps distant parts of a membrane apart, so that at small ν opposite sides touch "
        f"and pass through each other. Strained are meshes whose ⟨U_h⟩ is over {100 * STRAINED:g} "
        "% above that of the sphere."
    )
    for (volume, softness), found in vesicles.items():
        again = sum(each["attempts"] > 1 for each in found)
        for each in found:
            if each["failed"]:
                figure.note(f"ν = {volume:g}, Ξ = {softness:g} failed: {each['failed'][:120]}")
        if again:
            figure.note(
                f"ν = {volume:g}, Ξ = {softness:g}: {again} of {len(found)} runs with a quarter of "
                "the time step, after one that failed."
            )


def draw_classes(figure, classes, volumes, softnesses):
    """A dot for each run, side by side at each point."""
    colours = {"green": "tab:green", "yellow": "gold", "red": "tab:red"}
    graph, axis = plt.subplots(figsize=(6, 2.6), layout="constrained")
    for (volume, softness), found in classes.items():
        for place, name in enumerate(found):
            shift = 0.02 * (place - (len(found) - 1) / 2)
            axis.plot(volume + shift, softnesses.index(softness), "o", color=colours[name])
    axis.set(xlabel="reduced volume ν", ylabel="Ξ", yticks=range(len(softnesses)))
    axis.set_yticklabels([f"{softness:g}" for softness in softnesses])
    axis.set(ylim=(-0.5, len(softnesses) - 0.5), xlim=(max(volumes) + 0.06, min(volumes) - 0.06))
    meaning = "; ".join(f"{name}: {what}" for name, what in CLASSES.items())
    figure.save(graph, "_classes", f"Classes of the runs. {meaning}.")


def draw_energies(figure, vesicles, volumes, softnesses):
    graph, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for softness in softnesses:
        for axis, column in zip(axes, (2, 3), strict=True):
            means, errors, _ = np.transpose(
                [late_energy(vesicles[volume, softness], column) for volume in volumes]
            )
            axis.errorbar(volumes, means, errors, fmt="o-", ms=4, label=f"Ξ = {softness:g}")
    axes[0].set(xlabel="reduced volume ν", ylabel="⟨E_b⟩ (kJ/mol)")
    axes[1].set(xlabel="reduced volume ν", ylabel="⟨U_h⟩ (kJ/mol)", yscale="log")
    axes[0].legend()
    figure.save(graph, "_energies", "Bending and height energies against reduced volume.")


def draw_shapes(figure, vesicles, volumes, softnesses, count):
    panels, views = [], []
    for softness in softnesses:
        for view in ("tilted", "cut"):
            for volume in volumes:
                vesicle = vesicles[volume, softness][0]
                title = f"ν = {volume:g}, Ξ = {softness:g}"
                try:
                    mesh = helfrich.Mesh(vesicle["shape"], vesicle["triangles"])
                except helfrich.MeshError:
                    # It blew up; its start stands in for it.
                    mesh = start_of(volume, count, 1)
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
