"""A fluid membrane that spans its periodic box, at the temperature of a room.

The sheet bends and keeps its area, and its neighbours change by bond flips. It is wider than its
box, and too wide to undulate only by heat, so it buckles and pushes: its tension is below zero.

    python examples/sheet.py [--steps N] [--out DIR]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm import unit
from openmmhelfrich.analysis import crossings
from surface_picture import draw

TEMPERATURE = 300 * unit.kelvin
KBT = (unit.MOLAR_GAS_CONSTANT_R * TEMPERATURE).value_in_unit(unit.kilojoule_per_mole)


def main(arguments=None) -> None:
    """Simulate, measure the tension, and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=40000)
    parser.add_argument("--out", type=Path, default=Path("out/sheet"))
    options = parser.parse_args(arguments)

    # 24 × 28 vertices, 100 nm apart. The mesh knows its box, and the forces made of it use it.
    flat = helfrich.Mesh.sheet(24, 28, 100.0, periodic=True)
    system = openmm.System()
    system.setDefaultPeriodicBoxVectors(*flat.box)
    for _ in range(flat.num_vertices):
        system.addParticle(50.0)
    system.addForce(helfrich.BendingForce(flat, 20 * KBT))
    system.addForce(helfrich.SurfaceAreaForce(flat, 1.3, 1.05 * flat.area))
    system.addForce(helfrich.TriangleHeightForce(flat, flat.min_height(0.33), 4 * KBT))
    flips = helfrich.MonteCarloBondFlip(flat, TEMPERATURE, frequency=10, attemptsPerEdge=0.1)
    system.addForce(flips)

    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, 0.002, 1.3)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform)
    context.setPositions(flat.vertices)
    context.setVelocitiesToTemperature(TEMPERATURE)
    frame = flat.box[0, 0] * flat.box[1, 1]
    tensions = []
    for _ in range(40):
        integrator.step(options.steps // 40)
        stretching = np.diag(helfrich.virial(context))[:2].mean()
        tensions.append((stretching - flat.num_vertices * KBT) / frame)
    sheet = helfrich.Mesh.from_context(context, flips)
    print(sheet)
    print(f"flips accepted: {flips.getStatistics(context)['acceptance']:.2f}")
    print(f"area over that of the box: {sheet.area / frame:.4f}")
    tension = np.mean(tensions[10:]) / KBT
    print(f"tension: {tension:.2e} kBT/nm², {4.14 * tension:.2e} mN/m")
    print(f"triangles that cross: {len(crossings(sheet))}")
    draw(options.out / "sheet.png", {"a periodic sheet": sheet})
    sheet.write(options.out / "sheet.ply")
    print(f"picture and mesh are in {options.out}")


if __name__ == "__main__":
    main()
