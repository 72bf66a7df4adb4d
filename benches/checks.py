"""What the project asks of itself beside what was measured."""

__all__ = ["table"]

# How contenders that evaluate one number at a time are called.
_SCALAR = ("plain", "no lanes")


def table(results, used, evaluations):
    """Lines of Markdown, one for each figure that is asked for."""
    rows = [
        *_against_empty(results),
        *_against_competitors(results),
        *_large(results, used),
        *_evaluations(evaluations),
    ]
    lines = ["| what | asked | measured | met |", "| --- | --- | --- | --- |"]
    for what, sign, asked, measured, note in rows:
        if measured is None:
            lines.append(f"| {what} | {sign} {asked:g} | not measured: {note} | – |")
            continue
        met = measured <= asked if sign == "≤" else measured >= asked
        detail = f"{measured:.3g} ({note})" if note else f"{measured:.3g}"
        lines.append(f"| {what} | {sign} {asked:g} | {detail} | {'yes' if met else 'NO'} |")
    return lines


def _against_empty(results):
    """Our steps over OpenMM's empty step on Reference."""
    asked = [
        ("Verlet", 1002, 2.5, ""),
        *(("LangevinMiddle", n, 1, "Helfrich") for n in (1002, 4002)),
    ]
    for integrator, n, most, place in asked:
        ours = results.best("ours", integrator, n, place)
        empty = results.best("empty", integrator, n, "Reference")
        where = " on platform Helfrich" if place else ""
        what = f"{integrator} step{where} / empty {integrator} step on Reference, N = {n}"
        if ours is None or empty is None:
            yield what, "≤", most, None, "platform or size is missing"
        else:
            yield what, "≤", most, ours[0] / empty[0], ours[1].place


def _against_competitors(results):
    """The fastest competitor's step over our fastest."""
    for n in (1002, 4002):
        what = f"Verlet step of the fastest string forces or jax-md / ours, N = {n}"
        theirs = [found for side in ("strings", "jax")
                  if (found := results.best(side, "Verlet", n))]  # fmt: skip
        ours = results.best("ours", "Verlet", n)
        if not theirs or ours is None:
            yield what, "≥", 20, None, "side or size is missing"
        else:
            cost, row = min(theirs)
            yield what, "≥", 20, cost / ours[0], f"{row.label}; ours on {ours[1].place}"


def _large(results, used):
    """Memory of the largest mesh, and its time per vertex."""
    large, base = 998_562, 10_242
    what = f"peak memory at N = {large}, GB"
    if used is None or used[1] != large:
        yield what, "≤", 1.5, None, "run with all sizes"
    else:
        peak = max(stage["peak"] for stage in used[0].values())
        yield what, "≤", 1.5, peak * 2**20 / 1e9, used[2]
    for integrator in ("Verlet", "LangevinMiddle"):
        what = f"{integrator}: time per vertex at N = {large} over that at {base}"
        pair = [results.best("ours", integrator, n) for n in (large, base)]
        if None in pair:
            yield what, "≤", 1.5, None, "run with all sizes"
        else:
            ratio = pair[0][0] / large * base / pair[1][0]
            yield what, "≤", 1.5, ratio, f"{pair[0][1].place}; {pair[1][1].place}"


def _evaluations(found):
    """Ratios of evaluations of the forces alone, from `cargo bench`."""
    asked = [("1 thread", 1002, 0.25), ("1 thread", 4002, 0.25), ("2 threads", 4002, 0.14)]
    cost = {} if found is None else found.cost
    for threads, n, most in asked:
        what = f"Jülicher forces, {threads} / the faster scalar code on one thread, N = {n}"
        scalar = ("plain, 1 thread", "no lanes, 1 thread")
        known = [cost["Julicher", name, n] for name in scalar if ("Julicher", name, n) in cost]
        ours = [
            (value, name)
            for (scheme, name, size), value in cost.items()
            if scheme == "Julicher" and size == n and name.endswith(threads)
            and not name.startswith(_SCALAR)
        ]  # fmt: skip
        if not known or not ours:
            yield what, "≤", most, None, "cargo bench has no figure"
        else:
            value, name = min(ours)
            yield what, "≤", most, value / min(known), name
    for n in (1002, 4002):
        best = {}
        for (scheme, name, size), value in cost.items():
            if size == n and name.endswith("1 thread") and not name.startswith(_SCALAR):
                best[scheme] = min(value, best.get(scheme, value))
        what = f"slowest other scheme / Jülicher, 1 thread, N = {n}"
        if len(best) < 2 or "Julicher" not in best:
            yield what, "≤", 1.4, None, "cargo bench has no figure"
        else:
            scheme = max(best, key=best.get)
            yield what, "≤", 1.4, best[scheme] / best["Julicher"], scheme
