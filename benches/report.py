"""The text and the plot of the benchmark: tables in Markdown, and what was asked beside it."""

import datetime

import checks
from openmmhelfrich._benchmark import INTEGRATORS, TIME_STEP, machine, versions
from race import SIDES
from tables import aligned, number, spaced

__all__ = ["compose", "save"]

# What comes from here on is of other scripts and machines, and stays.
KEPT = "\n## GPU platforms\n"


def compose(results, options, failed, jax, used, evaluations):
    """The whole text.

    Parameters
    ----------
    results : Results
    options : argparse.Namespace
        With `repeats`, `seconds`, and `load`, the machine's before the start.
    failed : dict of str
        Platforms that did not start, with the reason.
    jax : dict of str or None
        Versions of jax.
    used : tuple or None
        Stages of `memory.measure`, N, and the platform.
    evaluations : Evaluations or None
        What `cargo bench` has measured.
    """
    lines = ["# Benchmarks", "", *_circumstances(options, jax), ""]
    lines += ["![Time of a step against the number of vertices](benchmarks.png)", ""]
    for integrator in INTEGRATORS:
        lines += _steps(results, integrator)
    lines += _omissions(results, failed)
    lines += ["## Large meshes", "", *_growth(results), "", *_memory(used), ""]
    lines += ["## Forces alone", "", *_evaluations(evaluations), ""]
    lines += ["## Asked and measured", "", *checks.table(results, used, evaluations), ""]
    return "\n".join(lines)


def save(text, results, path):
    """Write the text in place of the one before, and the plot beside it under the same stem."""
    path.parent.mkdir(parents=True, exist_ok=True)
    picture = path.with_suffix(".png")
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    _, heading, kept = before.partition(KEPT)
    text = text.replace("(benchmarks.png)", f"({picture.name})")
    path.write_text(text + heading + kept, encoding="utf-8")
    _plot(results, picture)


def _circumstances(options, jax):
    which = {**versions(), **(jax or {})}
    return [
        "One vesicle as in doi:10.1103/PhysRevE.108.015301: Jülicher bending, area, volume, "
        f"triangle heights; Δt = {TIME_STEP:g} ps.",
        f"Microseconds per step, minimum of {options.repeats} runs of {options.seconds:g} s, in "
        "turns up to N = 20 000; written by `make bench`.",
        "",
        "- " + ", ".join(f"{name}: {value}" for name, value in machine().items()),
        "- " + ", ".join(f"{name} {value}" for name, value in which.items()),
        f"- {datetime.date.today().isoformat()}, with a load of {options.load:.1f} before the start"
        + (", too much for figures to be relied on" if options.load > 1.5 else ""),
    ]


def _steps(results, integrator):
    """The table of one integrator, and how much faster ours is than each competitor."""
    sizes = results.sizes
    rows = [["", *(f"N = {spaced(n)}" for n in sizes)]]
    for row in results.rows(integrator):
        rows.append([row.label, *(number(results.cost.get((row, n))) for n in sizes)])
    best = {n: results.best("ours", integrator, n) for n in sizes}
    for side in ("strings", "jax", "empty"):
        theirs = {n: results.best(side, integrator, n) for n in sizes}
        if any(theirs.values()):
            name = f"**fastest of {SIDES[side]} / fastest of ours**"
            ratios = (
                f"**{theirs[n][0] / best[n][0]:.3g}**" if theirs[n] and best[n] else "–"
                for n in sizes
            )
            rows.append([name, *ratios])
    return [f"## {integrator}, µs per step", "", *aligned(rows), ""]


def _omissions(results, failed):
    """Every row without a figure, with the reason."""
    lines = []
    for name, reason in failed.items():
        lines.append(f"- platform {name}: {reason}")
    reasons = {}
    for (row, n), reason in results.missing.items():
        reasons.setdefault((row.label, reason), set()).add(n)
    for (label, reason), sizes in reasons.items():
        lines.append(f"- {label}, N = {', '.join(spaced(n) for n in sorted(sizes))}: {reason}")
    lines.append(
        "- string forces and jax-md run with Verlet only: the step of another integrator costs "
        "them the same forces"
    )
    return ["Left out (–):", "", *lines, ""]


def _growth(results):
    """Time per vertex at every size, relative to N = 10 242."""
    sizes = results.sizes
    base = 10_242 if 10_242 in sizes else sizes[-1]
    rows = [["ns per vertex and step", *(f"N = {spaced(n)}" for n in sizes)]]
    for integrator in INTEGRATORS:
        each = {n: 1e3 * results.best("ours", integrator, n)[0] / n for n in sizes}
        rows.append([f"{integrator}, fastest of ours", *(f"{each[n]:.1f}" for n in sizes)])
        relative = (f"{each[n] / each[base]:.2f}" for n in sizes)
        rows.append([f"relative to N = {spaced(base)}", *relative])
    return aligned(rows)


def _memory(used):
    if used is None:
        return ["Memory was not measured."]
    stages, n, place = used
    rows = [["stage", "peak MB so far", "s"]]
    for name, stage in stages.items():
        rows.append([name, f"{stage['peak'] * 1.048576:.0f}", f"{stage['seconds']:.1f}"])
    return [f"Memory of a process with N = {spaced(n)}, {place}:", "", *aligned(rows)]


def _evaluations(found):
    if found is None:
        return ["Not measured: run `make bench`, or `cargo bench` before this."]
    when = datetime.datetime.fromtimestamp(found.newest).isoformat(" ", "minutes")
    sizes = sorted({n for _, _, n in found.cost})
    rows = [["scheme, evaluator", *(f"N = {spaced(n)}" for n in sizes)]]
    # Jülicher's scheme first, since the others are compared with it.
    order = sorted(found.cost, key=lambda key: (key[0] != "Julicher", key))
    for scheme, name in dict.fromkeys((scheme, name) for scheme, name, _ in order):
        costs = (number(found.cost.get((scheme, name, n))) for n in sizes)
        rows.append([f"{scheme}, {name}", *costs])
    return [f"µs per evaluation, minimum of criterion's samples of {when}.", "", *aligned(rows)]


def _plot(results, path):
    """One panel for each integrator: µs per step against N."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    styles = {"empty": ":", "ours": "-", "strings": "--", "jax": "-."}
    figure, panels = plt.subplots(
        1, len(INTEGRATORS), figsize=(15, 5.5), sharey=True, layout="constrained"
    )
    colours = {}
    for panel, integrator in zip(panels, INTEGRATORS, strict=True):
        for row in results.rows(integrator):
            points = [(n, results.cost[row, n]) for n in results.sizes if (row, n) in results.cost]
            if points:
                colour = colours.setdefault(row.place, f"C{len(colours)}")
                panel.loglog(
                    *zip(*points, strict=True), styles[row.side], marker="o", markersize=3,
                    color=colour, label=row.label,
                )  # fmt: skip
        panel.set_title(integrator)
        panel.set_xlabel("vertices N")
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("µs per step")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)
