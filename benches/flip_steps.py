"""What bond flips cost a time step: `python benches/flip_steps.py [--quick]`.

LangevinMiddle on platform Helfrich, one thread: a vesicle at Ξ = 0.33 without flips, with 0.1
attempts for each edge every ten steps, and with the mesh that comes of these but no more flips. µs
a step, the shortest of many turns, which the three take one after the other.
"""

import sys
import time

import openmm
import openmmhelfrich as helfrich

SOFTNESS = 0.33
FREQUENCY = 10
ATTEMPTS = 0.1


def make(mesh, attempts):
    """A Context in equilibrium, and its mover."""
    vesicle = helfrich.Vesicle(mesh, volume_modulus=0, softness=SOFTNESS)
    system = vesicle.system()
    mover = helfrich.MonteCarloBondFlip(mesh, 300, FREQUENCY, attempts)
    mover.setRandomNumberSeed(1)
    if attempts:
        system.addForce(mover)
    integrator = openmm.LangevinMiddleIntegrator(
        300, 0.001, 1.0 * (1002 / mesh.num_vertices) ** 0.5
    )
    integrator.setRandomNumberSeed(1)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform, {"Threads": "1"})
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(3000)
    return context, mover


def main():
    """Measure and print."""
    quick = "--quick" in sys.argv
    print("vertices  without  flipped mesh  with flips  ratio")
    for num_vertices in (1002,) if quick else (1002, 4002):
        mesh = helfrich.Mesh.random_sphere(num_vertices, 1000, seed=1)
        contexts = [make(mesh, attempts) for attempts in (0, ATTEMPTS, ATTEMPTS)]
        context, mover = contexts[1]
        mover.setFrequency(0)
        mover.updateParametersInContext(context)
        shortest = [float("inf")] * 3
        steps = 1_000_000 // num_vertices
        for _ in range(5 if quick else 25):
            for index, (context, _) in enumerate(contexts):
                begin = time.perf_counter()
                context.getIntegrator().step(steps)
                took = (time.perf_counter() - begin) / steps * 1e6
                shortest[index] = min(shortest[index], took)
        without, idle, flipping = shortest
        ratio = flipping / without
        print(f"{num_vertices:8}  {without:7.1f}  {idle:12.1f}  {flipping:10.1f}  {ratio:5.2f}")


if __name__ == "__main__":
    main()
