"""What surface viscosity costs a time step: `python benches/viscosity_steps.py [--quick]`.

LangevinMiddle on platform Helfrich, one thread: a vesicle without it, and with a
SurfaceViscosityThermostat every step and every ten steps, with bonds that stay and with bonds that
flip. µs of processor time a step, the shortest of many turns, which all take one after the other.
"""

import sys
import time

import openmm
import openmmhelfrich as helfrich

FREQUENCIES = (0, 10, 1)


def make(mesh, frequency, flips):
    """A Context in equilibrium."""
    viscosity = {"friction": 20.0, "frequency": frequency, "randomNumberSeed": 1}
    vesicle = helfrich.Vesicle(
        mesh,
        volume_modulus=0,
        softness=0.33,
        flips={"attemptsPerEdge": 0.1, "randomNumberSeed": 1} if flips else None,
        viscosity=viscosity if frequency else None,
    )
    step = (1002 / mesh.num_vertices) ** 0.5
    integrator = openmm.LangevinMiddleIntegrator(300, 0.001, step)
    integrator.setRandomNumberSeed(1)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(vesicle.system(), integrator, platform, {"Threads": "1"})
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(3000)
    return context


def main():
    """Measure and print."""
    quick = "--quick" in sys.argv
    print("vertices  flips  without  every 10 steps  every step")
    for num_vertices in (1002,) if quick else (1002, 4002):
        mesh = helfrich.Mesh.random_sphere(num_vertices, 1000, seed=1)
        for flips in (False, True):
            contexts = [make(mesh, frequency, flips) for frequency in FREQUENCIES]
            shortest = [float("inf")] * len(contexts)
            steps = 1_000_000 // num_vertices
            for _ in range(5 if quick else 25):
                for index, context in enumerate(contexts):
                    begin = time.thread_time()
                    context.getIntegrator().step(steps)
                    took = (time.thread_time() - begin) / steps * 1e6
                    shortest[index] = min(shortest[index], took)
            without, seldom, always = shortest
            said = "yes" if flips else "no"
            print(f"{num_vertices:8}  {said:>5}  {without:7.1f}  {seldom:14.1f}  {always:10.1f}")


if __name__ == "__main__":
    main()
