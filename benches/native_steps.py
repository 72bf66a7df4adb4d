"""What a step costs where OpenMM's GPU platform evaluates the membrane itself.

    python benches/native_steps.py [--platform CUDA] [--precision mixed] [--json FILE]

The vesicle of `steps.py` under LangevinMiddle on a GPU platform: evaluated by the platform (the
backend "native"), on the processor, by string forces, and not at all; beside it the platform
Helfrich with the processor and with a GPU through wgpu, and jax-md if it is installed and uses a
GPU. Then a vesicle of 1002 vertices in a bath of 50 000 particles, and what share of a step its
membrane has. Every figure is the least of several runs, taken in turns. Drivers that compute on
the processor, as PoCL does, are said to do so.
"""

import argparse
import math
import os
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

import bath
import native_report
import openmmhelfrich as helfrich
from competitors import with_jax, with_strings
from openmmhelfrich import _benchmark
from openmmhelfrich._benchmark import Target, empty_system, sphere, start
from turns import add_options, energy, measure, say

PLATFORMS = ("CUDA", "HIP", "OpenCL")
# Without --sizes: on a driver that computes on the processor, and on a GPU.
SMALL = (1002, 4002, 40_962)
LARGE = (252, 1002, 4002, 10_242, 40_962, 163_842, 998_562)
# Share of the energy that platforms may differ by.
TOLERANCES = {"single": 1e-4, "mixed": 1e-4, "double": 1e-8}


@dataclass(frozen=True)
class Side:
    """One line of the table: a System somewhere, under a backend."""

    name: str
    label: str
    target: Target
    #: None for a System without membrane forces.
    backend: str | None = None


def main(arguments=None):
    """Measure, print, and write what was asked for."""
    options = _options(arguments)
    target = Target("", options.platform, {"Precision": options.precision})
    device, by_itself = _device(target)
    sizes = sorted(options.sizes or (LARGE if by_itself == "native" else SMALL))
    if options.quick:
        sizes, options.repeats, options.seconds = sizes[:1], 2, 0.03
    where = f"{options.platform} in {options.precision} precision"
    sides, missing = _sides(target, where)
    found = {
        "platform": options.platform, "precision": options.precision, "device": device,
        "on the processor": by_itself != "native", "auto": by_itself,
        "repeats": options.repeats, "seconds": options.seconds,
        "machine": _benchmark.machine(), "versions": _benchmark.versions(),
        "microseconds": {}, "missing": missing,
    }  # fmt: skip
    labels = {side.name: side.label for side in sides}
    # What was measured before a time limit is worth having.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("native_steps: stopped before the end"))
    try:
        if not options.no_bath:
            found["bath"] = _bath(target, options)
        for n in sizes:
            found["microseconds"][str(n)] = _race(n, sides, labels, options, missing)
    finally:
        native_report.save(found, labels, options)


def _options(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--platform", choices=PLATFORMS, help="default: the first of these that starts"
    )
    parser.add_argument(
        "--precision", choices=TOLERANCES, default="mixed", help="default: %(default)s"
    )
    parser.add_argument(
        "--sizes", type=int, nargs="+",
        help=f"numbers of vertices, 10 n² + 2 (default: {' '.join(map(str, LARGE))}, "
        f"or {' '.join(map(str, SMALL))} on a processor)",
    )  # fmt: skip
    add_options(parser, repeats=7)
    parser.add_argument(
        "--patience", type=float, default=60, metavar="SECONDS",
        help="string forces that take longer to compile are left out (default: %(default)g)",
    )  # fmt: skip
    parser.add_argument("--no-bath", action="store_true", help="without the vesicle in a bath")
    parser.add_argument("--output", type=Path, help="a Markdown file to write too")
    parser.add_argument("--json", type=Path, help="a file to write all figures to")
    parser.add_argument("--quick", action="store_true", help="one size, short runs: a smoke test")
    options = parser.parse_args(arguments)
    for n in options.sizes or ():
        if n < 12 or 10 * _parts(n) ** 2 + 2 != n:
            near = 10 * max(_parts(n), 1) ** 2 + 2
            parser.error(f"there is no icosphere of {n} vertices, but one of {near}")
    starting, failed = _benchmark.targets([options.platform] if options.platform else PLATFORMS)
    if not starting:
        parser.error("; ".join(f"{name}: {reason}" for name, reason in failed.items()))
    options.platform = starting[0].platform
    return options


def _parts(n):
    """Parts of the icosahedron's side."""
    return round(math.sqrt(max(n - 2, 0) / 10))


def _device(target):
    """What the platform computes on, and the backend that "auto" takes there."""
    vesicle = helfrich.Vesicle(sphere(2))
    side = Side("auto", "", target, "auto")
    context, used = _start(side, vesicle.system(), vesicle)
    return context.getPlatform().getPropertyValue(context, "DeviceName"), used


def _sides(target, where):
    """All sides but jax-md, and why others are missing, as {name: {N or "all": reason}}."""
    threads = str(os.cpu_count() or 1)
    plain = Target("", "Helfrich", {"Threads": threads})
    sides = [
        Side("empty", f"OpenMM's empty step, {where}", target),
        Side("native", f"native, {where}", target, "native"),
        Side("processor", f"on the processor, {where}", target, "cpu"),
        Side("helfrich", f"on the processor, Helfrich, {threads} threads", plain, "cpu"),
    ]
    missing = {}
    adapters = [adapter for adapter in helfrich.adapters() if adapter.kind != "software"]
    label = f"wgpu on {adapters[0].name}, Helfrich" if adapters else "wgpu, Helfrich"
    sides.append(Side("wgpu", label, plain, "gpu"))
    if not adapters:
        missing["wgpu"] = {"all": "no adapter for wgpu that is no processor"}
    sides.append(Side("strings", f"x, y, z string forces, {where}", target))
    return sides, missing


def _start(side, system, vesicle, positions=None):
    """A Context that has made a step, and the backend that has computed it.

    Raises
    ------
    SystemExit
        If another backend than the one that was asked for has computed the membrane.
    """
    before = helfrich.backend.evaluations()
    helfrich.set_backend(side.backend or "auto")
    try:
        context = start(system, vesicle, "LangevinMiddle", side.target, positions)
    finally:
        helfrich.set_backend("auto")
    context.getIntegrator().step(1)
    after = helfrich.backend.evaluations()
    used = [name for name in after if after[name] > before[name]]
    expected = [] if side.backend is None else [side.backend]
    if side.backend != "auto" and used != expected:
        sys.exit(f"native_steps: {side.label} was computed by {used}, not by {expected}")
    return context, "".join(used)


def _race(n, sides, labels, options, missing):
    """Least µs per step of each side at N."""
    vesicle = helfrich.Vesicle(sphere(_parts(n)))
    with_forces = vesicle.system()
    contexts, energies = {}, {}
    for side in sides:
        if "all" in missing.get(side.name, {}):
            continue
        say(f"{n}: starting {side.label}")
        system = empty_system(vesicle) if side.name == "empty" else with_forces
        if side.name == "strings":
            reason = _why_no_strings(n, side, options, missing.get("strings"))
            if reason is not None:
                missing.setdefault("strings", {})[str(n)] = reason
                continue
            system = with_strings.string_system(vesicle)
        contexts[side.name], _ = _start(side, system, vesicle)
        energies[side.name] = energy(contexts[side.name], vesicle)
    for name in set(energies) - {"empty"}:
        tolerance = TOLERANCES[options.precision]
        with_strings.check_agreement(energies["helfrich"], energies[name], labels[name], tolerance)
    say(f"{n}: {len(contexts)} Contexts in turns")
    cost = measure(contexts, n, options)
    contexts.clear()
    _jax(n, vesicle, energies["helfrich"], cost, labels, options, missing)
    say("")
    return cost


def _why_no_strings(n, side, options, failed):
    """What keeps string forces from being raced."""
    if failed:
        return f"left out above N = {min(map(int, failed))}, where they failed"
    return with_strings.why_no_step(_parts(n), side.target, options.patience)


def _jax(n, vesicle, ours, cost, labels, options, missing):
    """Steps of jax-md on a GPU, in the precision that forces have here."""
    precision = "double" if options.precision == "double" else "single"
    reason, name = None, ""
    if with_jax.jax_versions(options.jax_python) is None:
        reason = "jax and jax-md are not installed"
    else:
        kind, name = with_jax.jax_device(options.jax_python)
        if kind not in ("gpu", "cuda", "rocm"):
            reason = f"jax has no GPU, but {kind}"
    for form in with_jax.FORMS:
        key = f"jax, {form}"
        labels[key] = f"jax-md, {form}, Verlet, {precision} precision" + f", {name}" * bool(name)
        if reason is not None:
            missing[key] = {"all": reason}
            continue
        say(f"{n}: {labels[key]}")
        try:
            cost[key], theirs = with_jax.measure(
                vesicle, options.jax_python, form, options.repeats, options.seconds, precision
            )
        except RuntimeError as failure:
            missing.setdefault(key, {})[str(n)] = str(failure)
            continue
        with_strings.check_agreement(ours, theirs, labels[key], TOLERANCES[options.precision])


def _bath(target, options):
    """Least µs per step of a vesicle in a bath, without membrane forces and with them."""
    vesicle = helfrich.Vesicle(sphere(10))
    positions = bath.around(vesicle.mesh.vertices)
    contexts = {}
    for name, backend in (("bath", None), ("native", "native"), ("processor", "cpu")):
        say(f"bath: starting {name}")
        system = empty_system(vesicle) if backend is None else vesicle.system()
        bath.add(system, len(positions))
        contexts[name], _ = _start(Side(name, name, target, backend), system, vesicle, positions)
    say(f"bath: {len(contexts)} Contexts in turns")
    return measure(contexts, len(positions), options)


if __name__ == "__main__":
    main()
