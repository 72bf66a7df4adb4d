"""The text of `native_steps.py`: tables in Markdown, and a file with all figures."""

import json

import bath
from tables import aligned, number, spaced

__all__ = ["save"]


def save(found, labels, options):
    """Print the tables, and write what was asked for."""
    where = f"{found['platform']} in {found['precision']} precision"
    kind = ", which computes on the processor" if found["on the processor"] else ""
    lines = [
        f"LangevinMiddle on {where}, µs per step, minimum of {found['repeats']} runs of "
        f"{found['seconds']:g} s in turns.",
        "",
        f"- device: {found['device']}{kind}; the backend `auto` takes `{found['auto']}` on it",
        *(f"- {name}: {value}" for name, value in found["machine"].items()),
        "- " + ", ".join(f"{name} {value}" for name, value in found["versions"].items()),
        "",
        *_table(found["microseconds"], labels),
        *_left_out(found["missing"], labels),
    ]
    if "bath" in found:
        lines += ["", *_about_bath(found["bath"], where)]
    text = "\n".join(lines)
    print(text)
    for path, content in (
        (options.output, text),
        (options.json, json.dumps(found, indent=1, ensure_ascii=False)),
    ):
        if path:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content + "\n", encoding="utf-8")


def _table(microseconds, labels):
    """A row for each side, and how many times as long as native each takes."""
    sizes = list(microseconds)
    names = [name for name in labels if any(name in microseconds[n] for n in sizes)]
    rows = [["", *(f"N = {spaced(int(n))}" for n in sizes)]]
    for name in names:
        rows.append([labels[name], *(number(microseconds[n].get(name)) for n in sizes)])
    for name in names:
        if name != "native":
            ratios = (
                f"**{microseconds[n][name] / microseconds[n]['native']:.3g}**"
                if name in microseconds[n]
                else "–"
                for n in sizes
            )
            rows.append([f"**{labels[name]} / native**", *ratios])
    return aligned(rows)


def _left_out(missing, labels):
    lines = [
        f"- {labels[name]}{'' if n == 'all' else f', N = {spaced(int(n))}'}: {reason}"
        for name, reasons in missing.items()
        for n, reason in reasons.items()
    ]
    return ["", "Left out:", "", *lines] if lines else []


def _about_bath(cost, where):
    """The table of the bath, with the share of the membrane."""
    rows = [["", "µs per step", "membrane's share"]]
    for name, label in (
        ("bath", "no membrane forces"), ("native", "native"), ("processor", "on the processor")
    ):  # fmt: skip
        share = 1 - cost["bath"] / cost[name]
        rows.append([label, number(cost[name]), "" if name == "bath" else f"{100 * share:.1f} %"])
    return [
        f"A vesicle of 1002 vertices in a bath of {spaced(bath.COUNT)} particles, NonbondedForce "
        f"with a cutoff, {where}:",
        "",
        *aligned(rows),
    ]
