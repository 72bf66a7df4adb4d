"""A sticky bead that a membrane wraps, and one that does not stick enough.

A disk of membrane touches a bead from below. Covering the bead costs bending, 4πκ for half of it,
and gains the adhesion w by area: it is wrapped from w R² = 2κ on.

    python examples/wrapping.py [--steps N] [--out DIR]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm import unit
from surface_picture import draw

KAPPA = 50.0  # kJ/mol, 20 kBT
BEAD, DISTANCE = 17.0, 3.0  # nm: radius, and how far the membrane keeps away
REACH = BEAD + DISTANCE
COLD = 30 * unit.kelvin


def run(adhesion, steps):
    """The membrane after a run with an adhesion in multiples of 2κ/R², and where the bead is."""
    flat = helfrich.Mesh.disk(16, 3.2 * REACH).translated((0, 0, -REACH))
    bead = flat.num_vertices
    system = openmm.System()
    for _ in range(bead):
        system.addParticle(50.0)
    system.addParticle(0.0)  # The bead stays where it is.
    system.addForce(helfrich.BendingForce(flat, KAPPA))
    system.addForce(helfrich.TriangleAreaForce(flat, 20.0, flat.area / flat.num_triangles))
    system.addForce(helfrich.EdgeTensionForce(flat, 1.0))
    system.addForce(helfrich.DihedralForce(flat, 0.1 * KAPPA))  # Borders do not fold over.
    system.addForce(helfrich.TriangleHeightForce(flat, flat.min_height(0.2), 1.0))
    system.addForce(
        helfrich.ParticleSurfaceForce(
            flat,
            [bead],
            DISTANCE,
            epsilon=2.5,
            adhesion=adhesion * 2 * KAPPA / REACH**2,
            radius=BEAD,
            attraction=helfrich.ParticleSurfaceForce.LennardJones,
        )
    )
    flips = helfrich.MonteCarloBondFlip(flat, COLD, frequency=10, attemptsPerEdge=0.1)
    system.addForce(flips)
    integrator = openmm.LangevinMiddleIntegrator(COLD, 0.03, 0.02)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform)
    context.setPositions([*flat.vertices, (0, 0, 0)])
    context.setVelocitiesToTemperature(COLD, 1)
    integrator.step(steps)
    positions = context.getState(positions=True).getPositions(asNumpy=True)
    return helfrich.Mesh.from_context(context, flips), positions[bead].value_in_unit(unit.nanometer)


def main(arguments=None) -> None:
    """Run both, and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=100000)
    parser.add_argument("--out", type=Path, default=Path("out/wrapping"))
    options = parser.parse_args(arguments)
    panels = {}
    for adhesion in (0.5, 2.0):
        mesh, bead = run(adhesion, options.steps)
        gaps = np.linalg.norm(mesh.corner_positions.mean(axis=1) - bead, axis=1) - BEAD
        covered = helfrich.analysis.triangle_areas(mesh, mesh)[gaps < 2 * DISTANCE].sum()
        share = covered / (4 * np.pi * REACH**2)
        print(f"w R²/2κ = {adhesion}: {100 * share:.0f} % of the bead is covered")
        panels[f"w R² = {2 * adhesion:g} κ"] = mesh.translated(-bead)
    draw(options.out / "wrapping.png", panels, [((0, 0, 0), BEAD)], view=(12, -60))
    print(f"picture is in {options.out}")


if __name__ == "__main__":
    main()
