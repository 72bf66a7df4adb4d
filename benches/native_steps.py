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
import itertools
import json
import math
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
from competitors import with_jax, with_strings
from openmm import unit
from openmmhelfrich import _benchmark
from openmmhelfrich._benchmark import Steps, Target, empty_system, fastest, sphere, start
from scipy.spatial import cKDTree
from tables import aligned, number, spaced

PLATFORMS = ("CUDA", "HIP", "OpenCL")
# Without --sizes: on a driver that computes on the processor, and on a GPU.
SMALL = (1002, 4002, 40_962)
LARGE = (252, 1002, 4002, 10_242, 40_962, 163_842, 998_562)
# Share of the energy that platforms may differ by.
TOLERANCES = {"single": 1e-4, "mixed": 1e-4, "double": 1e-8}
# The bath: particles, side of its periodic box, nm, and their diameter, nm.
BATH, BOX, DIAMETER = 50_000, 3000.0, 72.0


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
        _write(found, labels, options)


def _write(found, labels, options):
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
    parser.add_argument(
        "--repeats", type=int, default=7, help="runs of each (default: %(default)d)"
    )
    parser.add_argument(
        "--seconds", type=float, default=0.3, help="length of a run, s (default: %(default)g)"
    )
    parser.add_argument(
        "--patience", type=float, default=60, metavar="SECONDS",
        help="string forces that take longer to compile are left out (default: %(default)g)",
    )  # fmt: skip
    parser.add_argument("--no-bath", action="store_true", help="without the vesicle in a bath")
    parser.add_argument(
        "--jax-python", default=sys.executable, help="a Python with jax and jax-md, if not this one"
    )
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


# --- sides ---------------------------------------------------------------------------------------


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
        _say(f"{n}: starting {side.label}")
        system = empty_system(vesicle) if side.name == "empty" else with_forces
        if side.name == "strings":
            reason = _why_no_strings(n, side, options, missing.get("strings", {}))
            if reason is not None:
                missing.setdefault("strings", {})[str(n)] = reason
                continue
            system = with_strings.string_system(vesicle)
        contexts[side.name], _ = _start(side, system, vesicle)
        energies[side.name] = _energy(contexts[side.name], vesicle)
    for name in set(energies) - {"empty"}:
        tolerance = TOLERANCES[options.precision]
        with_strings.check_agreement(energies["helfrich"], energies[name], labels[name], tolerance)
    cost = _measure(contexts, options, n)
    contexts.clear()
    _jax(n, vesicle, energies["helfrich"], cost, labels, options, missing)
    _say("")
    return cost


def _measure(contexts, options, n):
    _say(f"{n}: {len(contexts)} Contexts in turns")
    steppers = {name: Steps(context) for name, context in contexts.items()}
    cost = fastest(steppers, options.repeats, options.seconds)
    for name, stepper in steppers.items():
        try:
            stepper.check()
        except FloatingPointError as reason:
            sys.exit(f"native_steps: {name}, N = {n}: {reason}")
    return cost


def _energy(context, vesicle):
    """Potential energy at the positions of the mesh, kJ/mol."""
    context.setPositions(vesicle.mesh.vertices)
    state = context.getState(energy=True)
    return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)


def _why_no_strings(n, side, options, before):
    """What keeps string forces from being raced: their compilation, tried in another process."""
    if before:
        return f"left out above N = {min(map(int, before))}, where they failed"
    command = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); "
        f"import native_steps; native_steps.compile_strings({n}, {side.target.platform!r}, "
        f"{side.target.properties!r})"
    )
    try:
        said = subprocess.run(
            [sys.executable, "-c", command],
            capture_output=True, text=True, check=False, timeout=options.patience,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"no step within {options.patience:g} s"
    if said.returncode != 0:
        return (said.stderr.strip().splitlines() or [f"exit status {said.returncode}"])[-1]
    return None


def compile_strings(n, platform, properties):
    """Make one step of the string forces, in a process of its own: it may take very long."""
    vesicle = helfrich.Vesicle(sphere(_parts(n)))
    system = with_strings.string_system(vesicle)
    context = start(system, vesicle, "LangevinMiddle", Target("", platform, properties))
    Steps(context)(1)


def _jax(n, vesicle, energy, cost, labels, options, missing):
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
        _say(f"{n}: {labels[key]}")
        try:
            cost[key], theirs = with_jax.measure(
                vesicle, options.jax_python, form, options.repeats, options.seconds, precision
            )
        except RuntimeError as failure:
            missing.setdefault(key, {})[str(n)] = str(failure)
            continue
        with_strings.check_agreement(energy, theirs, labels[key], TOLERANCES[options.precision])


def _say(text):
    """Show on a terminal what is going on, in place of what was shown before."""
    if sys.stderr.isatty():
        print(f"\r{text:78.78s}\r", end="", file=sys.stderr, flush=True)


# --- a bath --------------------------------------------------------------------------------------


def _bath(target, options):
    """Least µs per step of a vesicle in a bath, without membrane forces and with them."""
    vesicle = helfrich.Vesicle(sphere(10))
    positions = _in_bath(vesicle.mesh.vertices)
    contexts = {}
    for name, backend in (("bath", None), ("native", "native"), ("processor", "cpu")):
        _say(f"bath: starting {name}")
        system = empty_system(vesicle) if backend is None else vesicle.system()
        _add_bath(system, len(positions))
        contexts[name], _ = _start(Side(name, name, target, backend), system, vesicle, positions)
    return _measure(contexts, options, len(positions))


def _in_bath(vertices):
    """The vertices in the middle of the box, and particles of a jittered lattice around them."""
    vertices = vertices + BOX / 2
    per_side = math.ceil((1.08 * BATH) ** (1 / 3))
    lattice = np.array(list(itertools.product(range(per_side), repeat=3)), dtype=float)
    rng = np.random.default_rng(1)
    spacing = BOX / per_side
    lattice = spacing * (lattice + rng.uniform(0.45, 0.55, lattice.shape))
    distance, _ = cKDTree(vertices).query(lattice)
    free = lattice[distance > 0.8 * DIAMETER]
    chosen = rng.choice(len(free), BATH, replace=False)
    return np.concatenate([vertices, free[np.sort(chosen)]])


def _add_bath(system, num_particles):
    """Particles that repel and attract each other and the vertices, with a cutoff."""
    pairs = openmm.NonbondedForce()
    pairs.setNonbondedMethod(pairs.CutoffPeriodic)
    pairs.setCutoffDistance(2.5 * DIAMETER)
    pairs.setUseDispersionCorrection(False)
    for _ in range(system.getNumParticles()):
        pairs.addParticle(0, 0.7 * DIAMETER, 1)
    while system.getNumParticles() < num_particles:
        system.addParticle(50)
        pairs.addParticle(0, DIAMETER, 1)
    system.addForce(pairs)
    system.setDefaultPeriodicBoxVectors(*(BOX * np.eye(3)))


# --- text ----------------------------------------------------------------------------------------


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
        f"A vesicle of 1002 vertices in a bath of {spaced(BATH)} particles, NonbondedForce with a "
        f"cutoff, {where}:",
        "",
        *aligned(rows),
    ]


if __name__ == "__main__":
    main()
