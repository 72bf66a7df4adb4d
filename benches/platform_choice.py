"""What a step costs on each of OpenMM's platforms, and what one gets without asking.

    python benches/platform_choice.py [--quick] [--output FILE]

Two tables in Markdown, of which docs/platforms.md has a run. The first has the vesicle of the paper
and its particles without any force; the second what OpenMM and this package choose by themselves,
beside what they chose before the platform Helfrich could be chosen. Times are the least of several
runs in turns, so that a busy minute hits all alike.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import openmm
from openmmhelfrich import Vesicle, _benchmark, platforms
from openmmhelfrich._benchmark import Steps, fastest, machine, start, versions

SIZES = {10: "1002", 20: "4002"}  # parts of the icosahedron's side: N
INTEGRATORS = ("Verlet", "LangevinMiddle")
REPULSION = "(1-delta(body1-body2))*25*(1-r/contact)^2*step(contact-r)"
CONTACT = 40.0  # nm


def main(arguments=None):
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a smoke test")
    parser.add_argument("--output", type=Path, help="a file to write the tables to, too")
    options = parser.parse_args(arguments)
    repeats, seconds = (1, 0.005) if options.quick else (7, 0.3)
    sizes = list(SIZES)[: 1 if options.quick else None]
    facts = [f"- {name}: {value}" for name, value in machine().items()]
    facts.append("- " + ", ".join(f"{name} {value}" for name, value in versions().items()))
    lines = [*facts, "", *every_platform(sizes, repeats, seconds), "", *unasked(repeats, seconds)]
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if options.output:
        options.output.write_text(text, encoding="utf-8")


def every_platform(sizes, repeats, seconds) -> list[str]:
    """A row for each platform: empty steps and the vesicle's, for each integrator and size."""
    targets, failed = _benchmark.targets()
    columns = [(n, kind, what) for n in sizes for kind in INTEGRATORS for what in ("empty", "ours")]
    titles = [f"{kind}, N = {SIZES[n]}, {what}" for n, kind, what in columns]
    cost: dict[tuple, dict[str, float]] = {}
    for n, kind, what in columns:
        vesicle = Vesicle(_benchmark.sphere(n))
        system = vesicle.system() if what == "ours" else _benchmark.empty_system(vesicle)
        steppers = {t.label: Steps(start(system, vesicle, kind, t)) for t in targets}
        cost[n, kind, what] = fastest(steppers, repeats, seconds)
    lines = [
        "µs per step:",
        "",
        f"| platform | {' | '.join(titles)} |",
        f"| --- |{' ---: |' * len(columns)}",
    ]
    for target in targets:
        cells = " | ".join(f"{cost[column][target.label]:.0f}" for column in columns)
        lines.append(f"| {target.label} | {cells} |")
    return lines + [f"\n{name}: {reason}" for name, reason in failed.items()]


def unasked(repeats, seconds) -> list[str]:
    """What is chosen where no platform is named, beside what was chosen before."""
    present = [name for name in platforms.names() if name != "Helfrich"]
    starting = [t.platform for t in _benchmark.targets(present)[0]]
    openmms = max(starting, key=lambda name: openmm.Platform.getPlatformByName(name).getSpeed())
    lines = [
        "LangevinMiddle, µs per step:",
        "",
        "| System | asked of | before | µs | now | µs |",
        "| --- | --- | --- | ---: | --- | ---: |",
    ]
    for name, vesicle, system in _systems():
        integrator = _benchmark.INTEGRATORS["LangevinMiddle"]()
        theirs = openmm.Context(system, integrator).getPlatform().getName()
        ours = platforms.choose(system, openmm.VerletIntegrator(0.1)).name
        rows = [("`openmm.Context`", openmms, theirs), ("this package", "Reference", ours)]
        steppers = {
            place: Steps(_start(system, vesicle, place))
            for place in dict.fromkeys(place for row in rows for place in row[1:])
        }
        cost = fastest(steppers, repeats, seconds)
        for door, before, now in rows:
            lines.append(
                f"| {name} | {door} | {before} | {cost[before]:.0f} | {now} | {cost[now]:.0f} |"
            )
    return lines


def _systems():
    vesicle = Vesicle(_benchmark.sphere(10))
    yield "one vesicle, N = 1002", vesicle, vesicle.system()
    yield "the same with 3000 springs", vesicle, _with_springs(vesicle)
    yield "two vesicles of N = 1002 that repel each other", vesicle, _pair(vesicle)


def _with_springs(vesicle) -> openmm.System:
    system = vesicle.system()
    springs = openmm.CustomBondForce("0.5*k*(r-r0)^2")
    springs.addGlobalParameter("k", 1e-4)
    springs.addPerBondParameter("r0")
    mesh = vesicle.mesh
    a, b = (mesh.vertices[column] for column in mesh.edges.T)
    for (i, j), length in zip(mesh.edges.tolist(), ((a - b) ** 2).sum(axis=1) ** 0.5, strict=True):
        springs.addBond(i, j, [length])
    system.addForce(springs)
    return system


def _pair(vesicle) -> openmm.System:
    system = openmm.System()
    force = openmm.CustomNonbondedForce(REPULSION)
    force.addGlobalParameter("contact", CONTACT)
    force.addPerParticleParameter("body")
    force.setNonbondedMethod(force.CutoffNonPeriodic)
    force.setCutoffDistance(CONTACT)
    for body in range(2):
        vesicle.add_to(system)
        for _ in range(vesicle.mesh.num_vertices):
            force.addParticle([body])
    system.addForce(force)
    return system


def _start(system, vesicle, name: str) -> openmm.Context:
    integrator = _benchmark.INTEGRATORS["LangevinMiddle"]()
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName(name))
    vertices = vesicle.mesh.vertices
    positions = vertices.tolist()
    if system.getNumParticles() > len(vertices):
        width = 2.05 * abs(vertices).max()
        positions += [[x + width, y, z] for x, y, z in positions]
    context.setPositions(positions)
    context.setVelocitiesToTemperature(300, 1)
    return context


if __name__ == "__main__":
    main()
