"""A membrane tube under tension: its radius, and the force that pulls it.

The tube spans its periodic box. Bending wants it wide, tension narrow; it comes to rest at the
radius √(κ/2σ), and pulls at the box with 2π √(2κσ).

    python examples/tube.py [--out DIR]
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
LENGTH = 120.0  # nm
TENSION = KAPPA / (2 * 15.0**2)  # kJ/mol/nm², for a radius of 15 nm


def main(arguments=None) -> None:
    """Relax a tube that is too wide, and compare it with theory."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("out/tube"))
    options = parser.parse_args(arguments)

    wide = helfrich.Mesh.tube(28, 42, 22.0, LENGTH, periodic=True)
    system = openmm.System()
    system.setDefaultPeriodicBoxVectors(*wide.box)
    for _ in range(wide.num_vertices):
        system.addParticle(50.0)
    system.addForce(helfrich.BendingForce(wide, KAPPA))
    # A soft spring far from its rest: the tension is modulus · (A/A0 − 1), nearly constant.
    area = helfrich.SurfaceAreaForce(wide, TENSION, np.pi * 15.0 * LENGTH)
    system.addForce(area)
    context = openmm.Context(system, openmm.VerletIntegrator(0.01))
    context.setPositions(wide.vertices)
    openmm.LocalEnergyMinimizer.minimize(context, 1e-4)

    positions = context.getState(positions=True).getPositions(asNumpy=True)
    tube = helfrich.Mesh(positions.value_in_unit(unit.nanometer), wide.triangles, wide.box)
    tension = area.getModulus() * (tube.area / area.getTarget() - 1)
    radius = tube.area / (2 * np.pi * LENGTH)
    force = helfrich.virial(context)[2, 2] / LENGTH
    print(f"tension σ      {tension:8.4f} kJ/mol/nm²")
    print(f"radius         {radius:8.3f} nm          √(κ/2σ)   {np.sqrt(KAPPA / 2 / tension):8.3f}")
    theory = 2 * np.pi * np.sqrt(2 * KAPPA * tension)
    print(f"pulling force  {force:8.3f} kJ/mol/nm   2π √(2κσ) {theory:8.3f}")
    draw(options.out / "tube.png", {"at first": wide, "at rest": tube}, view=(15, -60))
    tube.write(options.out / "tube.ply")
    print(f"picture and mesh are in {options.out}")


if __name__ == "__main__":
    main()
