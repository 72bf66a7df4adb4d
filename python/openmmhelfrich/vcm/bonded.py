"""Which particles OpenMM's bonded forces hold together.

Bonds of OpenMM's forces are lists of particles that stay as they are. Where they follow the edges
of a mesh whose bonds flip, they would go on holding particles that are neighbours no longer.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import openmm

__all__ = ["find_bond_on"]

#: For each class, what counts its bonds and what tells their particles.
_BONDS = {
    openmm.HarmonicBondForce: ("getNumBonds", lambda f, i: f.getBondParameters(i)[:2]),
    openmm.CustomBondForce: ("getNumBonds", lambda f, i: f.getBondParameters(i)[:2]),
    openmm.HarmonicAngleForce: ("getNumAngles", lambda f, i: f.getAngleParameters(i)[:3]),
    openmm.CustomAngleForce: ("getNumAngles", lambda f, i: f.getAngleParameters(i)[:3]),
    openmm.PeriodicTorsionForce: ("getNumTorsions", lambda f, i: f.getTorsionParameters(i)[:4]),
    openmm.RBTorsionForce: ("getNumTorsions", lambda f, i: f.getTorsionParameters(i)[:4]),
    openmm.CustomTorsionForce: ("getNumTorsions", lambda f, i: f.getTorsionParameters(i)[:4]),
    openmm.CMAPTorsionForce: ("getNumTorsions", lambda f, i: f.getTorsionParameters(i)[1:9]),
    openmm.CustomCompoundBondForce: ("getNumBonds", lambda f, i: f.getBondParameters(i)[0]),
    openmm.CustomCentroidBondForce: ("getNumBonds", lambda f, i: _single_particles(f, i)),
}


def _single_particles(force: openmm.CustomCentroidBondForce, bond: int) -> list[int]:
    """The particles of a bond that are groups of their own; who is in larger ones is no bond."""
    groups = [force.getGroupParameters(group)[0] for group in force.getBondParameters(bond)[0]]
    return [group[0] for group in groups if len(group) == 1]


def _bonds(force: openmm.Force) -> Iterator[tuple[int, ...]]:
    """The particles of each bond, angle or torsion of a force, and of those inside of it."""
    if isinstance(force, openmm.CustomCVForce):
        for variable in range(force.getNumCollectiveVariables()):
            yield from _bonds(force.getCollectiveVariable(variable))
    for cls, (count, particles) in _BONDS.items():
        if isinstance(force, cls):
            for bond in range(getattr(force, count)()):
                yield tuple(particles(force, bond))


def find_bond_on(edges: Any, force: openmm.Force) -> tuple[int, int] | None:
    """Two ends of an edge that are in one bond of a force.

    Parameters
    ----------
    edges : container of (int, int)
        Pairs of particles, the smaller first.
    force : openmm.Force

    Returns
    -------
    tuple of int or None
        None if no bond of the force, nor of one inside of a CustomCVForce, has both ends of an
        edge: it may hold particles that are not neighbours, or others than those of the mesh.
    """
    for particles in _bonds(force):
        for pair in combinations(sorted(particles), 2):
            if pair in edges:
                return pair
    return None
