"""Many vesicles in one Context: `python benches/many_steps.py [--quick]`.

LangevinMiddle on platform Helfrich with one thread and with two: vesicles of the paper's forces
side by side. µs a step, the shortest of many turns, which both Contexts take one after the other;
the ratio of the two; and the time of one vesicle.
"""

import sys
import time

import numpy as np
import openmm
import openmmhelfrich as helfrich

THREADS = (1, 2)
CASES = ((1, 252), (16, 252), (64, 252), (256, 252), (4, 1002), (2, 4002))


def make(mesh, count, threads):
    """A Context of so many vesicles with a mesh."""
    system, positions = openmm.System(), []
    for number in range(count):
        corners = mesh.triangles + system.getNumParticles()
        for _ in range(mesh.num_vertices):
            system.addParticle(50)
        for force in (
            helfrich.BendingForce(corners, 50),
            helfrich.SurfaceAreaForce(corners, 1.3, mesh.area),
            helfrich.EnclosedVolumeForce(corners, 1e-3, mesh.volume),
            helfrich.TriangleHeightForce(corners, mesh.min_height(0.15), 10),
        ):
            system.addForce(force)
        positions.append(mesh.vertices + np.array([3000.0 * number, 0, 0]))
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, 0.2)
    integrator.setRandomNumberSeed(1)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform, {"Threads": str(threads)})
    context.setPositions(np.concatenate(positions))
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(50)
    return context


def main():
    """Measure and print."""
    quick = "--quick" in sys.argv
    print("vesicles  vertices  1 thread  2 threads  ratio  per vesicle")
    for count, num_vertices in CASES[:2] if quick else CASES:
        mesh = helfrich.Mesh.random_sphere(num_vertices, 1000, seed=1)
        contexts = [make(mesh, count, threads) for threads in THREADS]
        shortest = [float("inf")] * len(contexts)
        steps = max(5, 1_000_000 // (count * num_vertices))
        for _ in range(5 if quick else 25):
            for index, context in enumerate(contexts):
                begin = time.perf_counter()
                context.getIntegrator().step(steps)
                took = (time.perf_counter() - begin) / steps * 1e6
                shortest[index] = min(shortest[index], took)
        one, two = shortest
        print(f"{count:8}  {num_vertices:8}  {one:8.1f}  {two:9.1f}", end="")
        print(f"  {two / one:5.2f}  {two / count:11.2f}")


if __name__ == "__main__":
    main()
