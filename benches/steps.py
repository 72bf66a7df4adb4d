"""Cost of one Verlet step: the plugin against string forces, and as the mesh grows.

Both sides have the vesicle of the paper (doi:10.1103/PhysRevE.108.015301): Jülicher bending, global
area, global volume, triangle heights. The string forces are the cheapest x, y, z expressions that
we know (`tests/python/string_forces.py`), as OpenMM Custom forces. An empty System's step is what
OpenMM takes for itself; what is above it belongs to the forces. Every figure is the minimum of
several runs, taken in turns so that a slow spell of the machine does not hit one side alone.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import numpy as np
import openmm
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import Vesicle

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "python"))
import string_forces

RADIUS = 1000.0  # nm at N = 1002; larger meshes keep the size of their triangles
SIZES = (5, 10, 20, 40)  # subdivisions of the icosahedron: N = 252, 1002, 4002, 16 002
SECONDS = 0.25  # length of one run


def main():
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--platform", default="Reference", help="default: %(default)s")
    parser.add_argument("--repeats", type=int, default=10, help="default: %(default)d")
    parser.add_argument("--quick", action="store_true", help="two short runs each")
    options = parser.parse_args()
    repeats = 2 if options.quick else options.repeats
    seconds = SECONDS / 5 if options.quick else SECONDS
    sizes = SIZES[:2] if options.quick else SIZES

    print(f"OpenMM {openmm.version.version}, platform {options.platform}, "
          f"{os.cpu_count()} processors, minimum of {repeats} runs\n")  # fmt: skip
    compare(options.platform, repeats, seconds)
    scaling(options.platform, repeats, seconds, sizes)


def compare(platform, repeats, seconds):
    """One mesh: string forces against the plugin, both against an empty System."""
    vesicle = Vesicle(sphere(10))
    contexts = {
        "OpenMM's empty step": start(empty_system(vesicle), vesicle, platform),
        "x, y, z string forces": start(string_system(vesicle), vesicle, platform),
        "openmm-helfrich": start(vesicle.system(), vesicle, platform),
    }
    check_agreement(contexts["x, y, z string forces"], contexts["openmm-helfrich"])
    best = fastest(contexts, repeats, seconds)
    empty = best["OpenMM's empty step"]
    print("N = 1002             step µs   without the empty step µs")
    for name, cost in best.items():
        print(f"  {name:22s} {cost:9.1f} {cost - empty:12.1f}")
    strings, ours = best["x, y, z string forces"], best["openmm-helfrich"]
    without = (strings - empty) / (ours - empty)
    print(f"  ratio strings / ours   {strings / ours:7.1f} {without:12.1f}\n")


def scaling(platform, repeats, seconds, sizes):
    """The plugin alone on meshes of growing size."""
    contexts = {}
    for n in sizes:
        vesicle = Vesicle(sphere(n))
        size = vesicle.mesh.num_vertices
        contexts["empty", size] = start(empty_system(vesicle), vesicle, platform)
        contexts["ours", size] = start(vesicle.system(), vesicle, platform)
    best = fastest(contexts, repeats, seconds)
    numbers = np.array([size for kind, size in contexts if kind == "ours"])
    forces = np.array([best["ours", n] - best["empty", n] for n in numbers])
    print("       N    step µs   empty µs   forces µs   forces ns per vertex")
    for n, cost in zip(numbers, forces, strict=True):
        print(f"  {n:6d} {best['ours', n]:10.1f} {best['empty', n]:10.1f} {cost:11.1f} "
              f"{1000 * cost / n:12.1f}")  # fmt: skip
    slope = np.polyfit(np.log(numbers), np.log(forces), 1)[0]
    print(f"  forces grow as N^{slope:.3f}; N^1 is linear")


def sphere(n):
    """An icosphere with triangles of always the same size."""
    return Mesh.icosphere(n, RADIUS * n / 10)


def empty_system(vesicle):
    """The particles without any force."""
    system = openmm.System()
    for _ in range(vesicle.mesh.num_vertices):
        system.addParticle(vesicle.mass)
    return system


def string_system(vesicle):
    """The same vesicle from OpenMM's Custom forces."""
    system = empty_system(vesicle)
    for force in string_forces.fastest(
        vesicle.mesh.triangles,
        rigidity=vesicle.rigidity,
        area_modulus=vesicle.area_modulus,
        area_target=vesicle.area,
        volume_modulus=vesicle.volume_modulus,
        volume_target=vesicle.volume,
        min_height=vesicle.min_height,
        epsilon=vesicle.epsilon,
        style="cartesian",
    ):
        system.addForce(force)
    return system


def start(system, vesicle, platform):
    """A Context at 300 K; the first steps, which compile and allocate, are over."""
    context = openmm.Context(
        system, openmm.VerletIntegrator(0.1), openmm.Platform.getPlatformByName(platform)
    )
    context.setPositions(vesicle.mesh.vertices)
    context.setVelocitiesToTemperature(300, 1)
    context.getIntegrator().step(20)
    return context


def check_agreement(one, other):
    """Refuse to race forces that are not the same."""
    energies = [c.getState(getEnergy=True).getPotentialEnergy()._value for c in (one, other)]
    if not np.isclose(*energies, rtol=1e-6):
        sys.exit(f"steps: the two sides have different energies, {energies[0]} and {energies[1]}")


def fastest(contexts, repeats, seconds):
    """Least microseconds per step of each Context."""
    counts = {}
    for name, context in contexts.items():
        begin = time.perf_counter()
        context.getIntegrator().step(20)
        counts[name] = max(10, int(20 * seconds / (time.perf_counter() - begin)))
    best = dict.fromkeys(contexts, np.inf)
    for _ in range(repeats):
        for name, context in contexts.items():
            begin = time.perf_counter()
            context.getIntegrator().step(counts[name])
            # Reading the energy waits for platforms that work in the background.
            context.getState(getEnergy=True)
            cost = (time.perf_counter() - begin) / counts[name]
            best[name] = min(best[name], 1e6 * cost)
    return best


if __name__ == "__main__":
    main()
