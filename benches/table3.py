"""The paper's Table III: wall time of 10 τ_2, sampled every τ_2, at N = 252, 1002 and 4002.

Table III of doi:10.1103/PhysRevE.108.015301 has the times of two graphics cards, one of 3000 cores
and 250 W, one of 16 000 cores and 450 W. τ_2 = 2π/ω_2 is the period of the slowest mode (A30); the
mass of the vesicle grows with N, and τ_2 with √N. Vesicles are the paper's: r0 = 1000 nm,
κ = 20 kBT, Ξ = 0.037, m = 50 amu, T = 300 K, γ = 0.01/ps, Δt = 0.2 ps. A sample is what analysis
needs: positions, energy and temperature. The run starts with the kinetic energy of 300 K from a
mesh without fluctuations, to which Verlet's conserved energy then gives a part of it.

    python benches/table3.py [--quick] [--integrator LangevinMiddle] [--platform Helfrich]
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import openmm
from openmm import unit
from openmmhelfrich import Mesh, Vesicle, platforms
from openmmhelfrich._benchmark import machine, versions
from openmmhelfrich.analysis import theory
from openmmhelfrich.backend import get_backend

RADIUS = 1000.0  # nm
TIME_STEP = 0.2  # ps
TEMPERATURE = 300.0  # K
FRICTION = 0.01  # 1/ps
PERIODS = 10
# N: parts of the icosahedron's side, seconds of the paper's two cards, and what is asked of two
# cores here, s.
TABLE = {252: (5, (12, 10), None), 1002: (10, (3.83 * 60, 3.66 * 60), 30),
         4002: (20, (110 * 60, 72 * 60), 300)}  # fmt: skip
INTEGRATORS = {
    "Verlet": lambda: openmm.VerletIntegrator(TIME_STEP),
    "LangevinMiddle": lambda: openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, TIME_STEP),
    "Brownian": lambda: openmm.BrownianIntegrator(TEMPERATURE, FRICTION, TIME_STEP),
}


def main(arguments=None):
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--integrator", action="append", choices=INTEGRATORS,
        help="may be repeated (default: LangevinMiddle)",
    )  # fmt: skip
    parser.add_argument("--platform", help="default: the fastest for membranes, which is Helfrich")
    parser.add_argument("--threads", help="of platforms that have them (default: all processors)")
    parser.add_argument("--precision", help="of platforms that have several (default: OpenMM's)")
    parser.add_argument("--sizes", type=int, nargs="+", choices=TABLE, default=list(TABLE))
    parser.add_argument("--output", type=Path, help="a Markdown file to write too")
    parser.add_argument("--json", type=Path, help="a file to write all figures to")
    parser.add_argument(
        "--quick", action="store_true", help="run a hundredth of it, and say what all of it takes"
    )
    parser.add_argument(
        "--strict", action="store_true", help="exit with status 1 if a figure asked for is missed"
    )
    options = parser.parse_args(arguments)
    platform = platform_named(options.platform)
    properties = {}
    if "Threads" in platform.getPropertyNames():
        properties["Threads"] = options.threads or str(os.cpu_count() or 1)
    if options.precision and "Precision" in platform.getPropertyNames():
        properties["Precision"] = options.precision

    lines = _head(platform, properties, options.quick)
    print("\n".join(lines), flush=True)
    missed, figures = False, []
    for integrator in options.integrator or ["LangevinMiddle"]:
        for n in options.sizes:
            seconds, steps, temperature = run(
                n, INTEGRATORS[integrator](), platform, properties, options.quick
            )
            _, paper, asked = TABLE[n]
            figures.append({
                "integrator": integrator, "N": n, "steps": steps, "seconds": seconds,
                "extrapolated": options.quick, "paper": paper,
            })  # fmt: skip
            met = "" if asked is None else f"{asked} s: {'yes' if seconds <= asked else 'NO'}"
            missed |= asked is not None and seconds > asked
            cards = " / ".join(clock(value) for value in paper)
            lines.append(
                f"| {integrator} | {n} | {steps} | {clock(seconds)}{'*' * options.quick} | "
                f"{1e6 * seconds / steps:.1f} | {cards} | {paper[1] / seconds:.3g} | {met} | "
                f"{temperature:.0f} K |"
            )
            print(lines[-1], flush=True)
    if options.quick:
        lines.append("\n\\* extrapolated from a hundredth of the steps")
        print(lines[-1])
    if options.output:
        options.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    if options.json:
        found = {"platform": platform.getName(), "properties": properties, "backend": get_backend()}
        text = json.dumps({**found, "runs": figures}, indent=1)
        options.json.write_text(text + "\n", encoding="utf-8")
    sys.exit(1 if missed and options.strict else 0)


def _head(platform, properties, quick):
    where = platform.getName() + "".join(f", {k} {v}" for k, v in properties.items())
    return [
        f"# Table III: {PERIODS} τ_2, sampled every τ_2",
        "",
        f"Platform {where}; backend {get_backend()}. "
        + ", ".join(f"{name}: {value}" for name, value in machine().items())
        + ". "
        + ", ".join(f"{name} {value}" for name, value in versions().items())
        + ".",
        *(["", "A hundredth of each run; times are extrapolated."] if quick else []),
        "",
        "| integrator | N | steps | wall time | µs per step | the paper's cards | "
        "times as fast as the faster card | asked | mean T |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: |",
    ]


def platform_named(name):
    """The platform of that name, or the fastest for membranes that there is."""
    if name is None:
        vesicle = Vesicle(Mesh.icosphere(2, RADIUS))
        name = platforms.choose(vesicle.system(), openmm.VerletIntegrator(TIME_STEP)).name
    try:
        return openmm.Platform.getPlatformByName(platforms.find(name))
    except ValueError as reason:
        sys.exit(f"table3: {reason}")


def run(n, integrator, platform, properties, quick):
    """Wall time of the whole run, s, its steps, and the mean temperature of its samples, K."""
    vesicle = Vesicle(Mesh.icosphere(TABLE[n][0], RADIUS))
    if hasattr(integrator, "setRandomNumberSeed"):
        integrator.setRandomNumberSeed(1)
    context = openmm.Context(vesicle.system(), integrator, platform, properties)
    context.setPositions(vesicle.mesh.vertices)
    context.setVelocitiesToTemperature(TEMPERATURE, 1)
    # Buffers are allocated and threads started by the first steps.
    integrator.step(10)
    per_sample = round(vesicle.tau_2 / TIME_STEP)
    share = 100 if quick else 1
    temperatures = []
    begin = time.perf_counter()
    for _ in range(PERIODS):
        integrator.step(per_sample // share)
        temperatures.append(_sample(context, n))
    seconds = (time.perf_counter() - begin) * share
    return seconds, PERIODS * per_sample, float(np.mean(temperatures))


def _sample(context, n):
    """Read what analysis needs; returns the temperature, K."""
    state = context.getState(positions=True, energy=True)
    positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    if not np.isfinite(positions).all():
        sys.exit(f"table3: the run of N = {n} broke down, a position is not finite")
    kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
    return 2 * kinetic / (3 * n * theory.BOLTZMANN)


def clock(seconds):
    """Seconds as text, in minutes where they are many."""
    return f"{seconds:.1f} s" if seconds < 100 else f"{seconds / 60:.2f} min"


if __name__ == "__main__":
    main()
