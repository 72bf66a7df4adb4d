"""What a repulsion of surfaces costs: time steps of platform Helfrich with it and without it.

    python benches/contact_steps.py

µs a step, LangevinMiddle of 0.1 ps at 300 K, the least of several rounds in which both take turns,
as docs/contact.md has them. "sphere": a vesicle of N = 1002; "flips": with a round of bond flips
every ten steps; "folded": the same vesicle, with the repulsion, brought to a reduced volume of 0.3
and flipped or not; "box": vesicles of N = 252 side by side, 1.2 D apart, with one force between
parts only.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import openmm
from openmmhelfrich import Mesh, MonteCarloBondFlip, SurfaceRepulsionForce

sys.path.append(str(Path(__file__).resolve().parents[1] / "examples/surfaces"))
from crossing import DISTANCE, FRICTION, KBT, TEMPERATURE, TIME_STEP, elasticity, mean_edge
from membranes import positions_of, system_of


def context_of(mesh, forces, threads=1):
    """A Context of some forces on a mesh."""
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, TIME_STEP)
    integrator.setRandomNumberSeed(1)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    system = system_of(mesh, forces)
    context = openmm.Context(system, integrator, platform, {"Threads": str(threads)})
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(TEMPERATURE, 1)
    return context


def one(distance, flips=False, volume=None, threads=1, mesh=None):
    """Contexts of a vesicle with and without the repulsion."""
    start = Mesh.icosphere(10, 100.0)
    contexts = []
    for contact in (True, False):
        forces = elasticity(start)
        if contact:
            forces.append(SurfaceRepulsionForce(start, distance, KBT))
        if flips:
            mover = MonteCarloBondFlip(start, TEMPERATURE, frequency=10, attemptsPerEdge=0.1)
            mover.setRandomNumberSeed(1)
            forces.append(mover)
        context = context_of(mesh or start, forces, threads)
        if volume is not None:
            context.setParameter("volume", volume)
        contexts.append(context)
    return contexts


def folded(distance):
    """A vesicle that has been brought to a reduced volume of 0.3."""
    mesh = Mesh.icosphere(10, 100.0)
    context = context_of(mesh, [*elasticity(mesh), SurfaceRepulsionForce(mesh, distance, KBT)])
    for reduced in np.arange(1000, 299, -1) / 1000:
        context.setParameter("volume", mesh.volume * reduced)
        context.getIntegrator().step(100)
    return Mesh(positions_of(context), mesh.triangles)


def box(count, distance, threads):
    """Contexts of vesicles side by side."""
    start = Mesh.icosphere(5, 100.0)
    across = round(count ** (1 / 3) + 0.49)
    pitch = 200.0 + 1.2 * distance
    places = [(x, y, z) for x in range(across) for y in range(across) for z in range(across)]
    vertices = np.concatenate([start.vertices + pitch * np.array(p) for p in places[:count]])
    triangles = np.concatenate([start.triangles + k * start.num_vertices for k in range(count)])
    mesh = Mesh(vertices, triangles)
    contexts = []
    for contact in (True, False):
        forces = []
        for k in range(count):
            forces += elasticity(start, k * start.num_vertices)
        if contact:
            force = SurfaceRepulsionForce(mesh, distance, KBT)
            force.setOnlyBetweenParts(True)
            forces.append(force)
        context = context_of(mesh, forces, threads)
        context.setParameter("volume", start.volume)
        contexts.append(context)
    return contexts


def compare(name, contexts, rounds, steps):
    """Print the least µs a step with and without."""
    for context in contexts:
        context.getIntegrator().step(2 * steps)
    least = [np.inf, np.inf]
    for _ in range(rounds):
        for place, context in enumerate(contexts):
            context.getState(energy=True)
            start = time.perf_counter()
            context.getIntegrator().step(steps)
            context.getState(energy=True)
            least[place] = min(least[place], (time.perf_counter() - start) / steps * 1e6)
    contact, plain = least
    print(f"{name:32} {plain:8.1f} {contact:8.1f} {contact / plain:6.2f}", flush=True)


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--only", choices=["sphere", "flips", "folded", "box"])
    options = parser.parse_args()
    rounds, steps, only = options.rounds, options.steps, options.only
    distance = DISTANCE * mean_edge(Mesh.icosphere(10, 100.0))
    print(f"{'µs a step':32} {'without':>8} {'with':>8} {'ratio':>6}")
    if only in (None, "sphere"):
        compare("sphere", one(distance), rounds, steps)
    if only in (None, "flips"):
        compare("sphere, flips", one(distance, flips=True), rounds, steps)
    if only in (None, "folded"):
        mesh = folded(distance)
        volume = 0.3 * Mesh.icosphere(10, 100.0).volume
        compare("folded", one(distance, volume=volume, mesh=mesh), rounds, steps)
        both = one(distance, flips=True, volume=volume, mesh=mesh)
        compare("folded, flips", both, rounds, steps)
    if only in (None, "box"):
        wide = DISTANCE * mean_edge(Mesh.icosphere(5, 100.0))
        for count in (1, 8, 64):
            for threads in (1, 2):
                name = f"box of {count}, threads {threads}"
                compare(name, box(count, wide, threads), rounds, max(50, steps // count))


if __name__ == "__main__":
    main()
