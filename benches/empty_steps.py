"""Cost of one time step without forces: OpenMM's platforms against the platform Helfrich.

It is what a simulation pays besides its forces: clearing them, random numbers, integration, and
the way there. Every figure is the minimum of several runs, taken in turns so that a slow spell of
the machine does not hit one platform alone.
"""

import argparse
import time

import numpy as np
import openmm
import openmmhelfrich  # noqa: F401  (loads the platform)

COLUMNS = [
    ("Reference", None),
    ("CPU", 1),
    ("CPU", 2),
    ("Helfrich", 1),
    ("Helfrich", 2),
]
INTEGRATORS = {
    "Verlet": lambda: openmm.VerletIntegrator(0.001),
    "LangevinMiddle": lambda: openmm.LangevinMiddleIntegrator(300, 1, 0.001),
    "Brownian": lambda: openmm.BrownianIntegrator(300, 1, 0.001),
}
SIZES = (252, 1002, 4002, 16_002, 100_002)


def start(num_particles, integrator, platform, threads):
    """A Context of free particles."""
    system = openmm.System()
    for _ in range(num_particles):
        system.addParticle(50)
    where = openmm.Platform.getPlatformByName(platform)
    properties = {} if threads is None else {"Threads": str(threads)}
    context = openmm.Context(system, integrator, where, properties)
    context.setPositions(np.random.default_rng(1).normal(size=(num_particles, 3)))
    context.setVelocitiesToTemperature(300, 1)
    context.getIntegrator().step(3)
    return context


def fastest(contexts, repeats, seconds):
    """Microseconds a step of each Context, the minimum over runs of some seconds."""
    best = np.full(len(contexts), 1e-3)
    for repeat in range(repeats + 1):
        for k, context in enumerate(contexts):
            steps = max(3, int(seconds / best[k]))
            begin = time.perf_counter()
            context.getIntegrator().step(steps)
            cost = (time.perf_counter() - begin) / steps
            # The first run only tells how long the others must be.
            best[k] = cost if repeat == 0 else min(best[k], cost)
    return 1e6 * best


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=10, help="default: %(default)d")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="default: %(default)s")
    options = parser.parse_args()
    titles = [name if threads is None else f"{name} x{threads}" for name, threads in COLUMNS]
    print(f"µs per step, minimum of {options.repeats} runs; x: number of threads\n")
    print(f"{'':14s} {'N':>7s}" + "".join(f"{title:>12s}" for title in titles))
    for name, make in INTEGRATORS.items():
        for size in options.sizes:
            contexts = [start(size, make(), *column) for column in COLUMNS]
            costs = fastest(contexts, options.repeats, 0.02)
            print(f"{name:14s} {size:7d}" + "".join(f"{c:12.1f}" for c in costs), flush=True)


if __name__ == "__main__":
    main()
