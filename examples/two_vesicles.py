"""Two different vesicles and a solution of ordinary particles in one System.

A soft vesicle with a stiff domain and a hard one with spontaneous curvature sit side by side in a
cloud of beads. A SurfaceRepulsionForce keeps the vesicles apart and a ParticleSurfaceForce the
beads outside of both; beads pass through each other. The script prints energies per term of each
vesicle and writes the last meshes.

    python examples/two_vesicles.py [--steps N] [--out DIR]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm import unit
from tqdm import tqdm

TEMPERATURE = 300 * unit.kelvin
KBT = (unit.MOLAR_GAS_CONSTANT_R * TEMPERATURE).value_in_unit(unit.kilojoule_per_mole)
RADIUS = 200.0
CONTACT = 40.0
BEAD = 15.0


def build(seed: int):
    """The System, its positions (nm), and the placements and meshes of the two vesicles."""
    rng = np.random.default_rng(seed)
    mesh = helfrich.Mesh.random_sphere(252, RADIUS, seed=seed)
    stiff = np.where(mesh.vertices[:, 2] > 0.5 * RADIUS, 60 * KBT, 15 * KBT)
    soft = helfrich.Vesicle(mesh, rigidity=stiff, softness=0.037, reduced_volume=0.9)
    hard_mesh = helfrich.Mesh.icosphere(4, 0.8 * RADIUS).translated((1.95 * RADIUS, 0, 0))
    hard = helfrich.Vesicle(
        hard_mesh,
        scheme=helfrich.BendingForce.GompperKrollBarycentric,
        spontaneous_curvature=2 / RADIUS,
        softness=0.33,
    )
    system = openmm.System()
    placements = [soft.add_to(system), hard.add_to(system)]
    positions = [mesh.vertices, hard_mesh.vertices]

    # Beads start outside both vesicles and apart from each other.
    beads = []
    while len(beads) < 100:
        bead = rng.uniform((-2 * RADIUS,) * 3, (4 * RADIUS, 2 * RADIUS, 2 * RADIUS))
        far = np.linalg.norm(np.vstack([*positions, *beads]) - bead, axis=1).min() > CONTACT
        outside = all(
            np.linalg.norm(bead - part.mean(axis=0)) > 1.1 * RADIUS for part in positions[:2]
        )
        if far and outside:
            beads.append(bead[None])
            system.addParticle(50)
    # A weak spring to the middle keeps the beads around.
    home = openmm.CustomExternalForce("0.5*k*((x-x0)^2+y^2+z^2)")
    home.addGlobalParameter("k", 1e-6)
    home.addGlobalParameter("x0", RADIUS)
    # Both vesicles, one after the other.
    surfaces = np.vstack([mesh.triangles, hard_mesh.triangles + placements[1].offset])
    between = helfrich.SurfaceRepulsionForce(surfaces, distance=0.5 * CONTACT, epsilon=KBT)
    between.setOnlyBetweenParts(True)
    particles = np.arange(system.getNumParticles() - len(beads), system.getNumParticles())
    around = helfrich.ParticleSurfaceForce(
        surfaces, particles, distance=10, epsilon=KBT, radius=BEAD
    )
    for bead in particles:
        home.addParticle(int(bead))
    for group, force in ((30, home), (31, between), (31, around)):
        force.setForceGroup(group)
        system.addForce(force)
    return system, np.vstack([*positions, *beads]), placements, [mesh, hard_mesh]


def main(arguments=None) -> None:
    """Simulate and report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("out/two_vesicles"))
    options = parser.parse_args(arguments)
    system, positions, placements, meshes = build(options.seed)
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, 0.01, 0.05)
    integrator.setRandomNumberSeed(options.seed)
    platform, reason = helfrich.platforms.choose(system, integrator)
    print(f"Platform {platform}: {reason}")
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName(platform))
    context.setPositions(positions)
    openmm.LocalEnergyMinimizer.minimize(context, maxIterations=200)
    context.setVelocitiesToTemperature(TEMPERATURE, options.seed)
    chunk = max(1, options.steps // 20)
    with tqdm(total=options.steps, unit="step") as progress:
        while progress.n < options.steps:
            count = min(chunk, options.steps - progress.n)
            integrator.step(count)
            progress.update(count)

    state = context.getState(positions=True, energy=True)
    final = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    options.out.mkdir(parents=True, exist_ok=True)
    for name, placement, mesh in zip(("soft", "hard"), placements, meshes, strict=True):
        vertices = final[placement.offset : placement.offset + placement.num_vertices]
        shape = helfrich.Mesh(vertices, mesh.triangles)
        terms = ", ".join(
            f"{term} {energy:.1f}" for term, energy in placement.energies(context).items()
        )
        print(f"{name} vesicle: reduced volume {shape.reduced_volume:.3f}; kJ/mol: {terms}")
        shape.write(options.out / f"{name}.ply")
    contact = context.getState(energy=True, groups={31}).getPotentialEnergy()
    print(f"repulsion between vesicles and beads: {contact}")


if __name__ == "__main__":
    main()
