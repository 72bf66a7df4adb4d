"""A bath around a vesicle: many more particles in a periodic box, which OpenMM computes."""

import itertools
import math

import numpy as np
import openmm
from scipy.spatial import cKDTree

__all__ = ["COUNT", "add", "around"]

# Particles, side of the periodic box, nm, and their diameter, nm.
COUNT, BOX, DIAMETER = 50_000, 3000.0, 72.0


def around(vertices):
    """The vertices in the middle of the box, and particles of a jittered lattice around them."""
    vertices = vertices + BOX / 2
    per_side = math.ceil((1.08 * COUNT) ** (1 / 3))
    lattice = np.array(list(itertools.product(range(per_side), repeat=3)), dtype=float)
    rng = np.random.default_rng(1)
    spacing = BOX / per_side
    lattice = spacing * (lattice + rng.uniform(0.45, 0.55, lattice.shape))
    distance, _ = cKDTree(vertices).query(lattice)
    free = lattice[distance > 0.8 * DIAMETER]
    chosen = rng.choice(len(free), COUNT, replace=False)
    return np.concatenate([vertices, free[np.sort(chosen)]])


def add(system, num_particles):
    """Particles that repel and attract each other and the vertices, with a cutoff."""
    pairs = openmm.NonbondedForce()
    pairs.setNonbondedMethod(pairs.CutoffPeriodic)
    pairs.setCutoffDistance(2.5 * DIAMETER)
    pairs.setUseDispersionCorrection(False)
    for _ in range(system.getNumParticles()):
        pairs.addParticle(0, 0.7 * DIAMETER, 1)
    while system.getNumParticles() < num_particles:
        system.addParticle(50)
        pairs.addParticle(0, DIAMETER, 1)
    system.addForce(pairs)
    system.setDefaultPeriodicBoxVectors(*(BOX * np.eye(3)))
