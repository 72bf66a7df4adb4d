"""Energies and forces of the string forces, on the Reference platform.

OpenMM takes seconds to differentiate the longer expressions, and minutes for all of them. So the
bending forces are compiled once for all membranes of the tests: they lie side by side in one
System, and the rigidities of all but one are zero when that one is asked for.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache

import meshes
import numpy as np
import openmm as mm
import published
import string_forces
from meshes import Membrane

# Vertices of more neighbours than this take OpenMM too long, by scheme and part, then by style.
# HELFRICH_SLOW_TESTS=1 raises the limits to what takes minutes.
_LIMITS = {
    ("Espriu", "quadratic"): {"geometric": 6, "cartesian": 12},
    ("Julicher", "quadratic"): {"geometric": 12, "cartesian": 6},
}
_ORDINARY = {"geometric": 6, "cartesian": 5}
_LONG = {"geometric": 4, "cartesian": 4}
# The membranes with handles and borders that have string forces: of few neighbours, and of many.
STRINGS_NAMES = ("cap", "holed", "torn torus", "mixed")
SLOW = os.environ.get("HELFRICH_SLOW_TESTS") == "1"
if SLOW:
    _ORDINARY = _LONG = {"geometric": 6, "cartesian": 6}


@dataclass(frozen=True)
class Result:
    """energy in kJ/mol; forces of all particles of the System, shape (num_particles, 3)."""

    energy: float
    forces: np.ndarray


def _context(forces: list[mm.Force], num_particles: int) -> mm.Context:
    system = mm.System()
    for _ in range(num_particles):
        system.addParticle(1.0)
    for force in forces:
        system.addForce(force)
    platform = mm.Platform.getPlatformByName("Reference")
    return mm.Context(system, mm.VerletIntegrator(0.001), platform)


def _result(context: mm.Context) -> Result:
    state = context.getState(getEnergy=True, getForces=True)
    energy = state.getPotentialEnergy().value_in_unit_system(mm.unit.md_unit_system)
    forces = state.getForces(asNumpy=True).value_in_unit_system(mm.unit.md_unit_system)
    return Result(energy, np.array(forces))


def _in_box(force: mm.Force) -> None:
    """Let a Custom force take nearest images."""
    if isinstance(force, mm.CustomCVForce):
        for index in range(force.getNumCollectiveVariables()):
            _in_box(force.getCollectiveVariable(index))
    else:
        force.setUsesPeriodicBoundaryConditions(True)


def evaluate(forces: list[mm.Force], positions) -> Result:
    """Any forces at any positions, in a periodic box if the positions have one."""
    box = getattr(positions, "box", None)
    if box is not None:
        for force in forces:
            _in_box(force)
    context = _context(forces, len(positions))
    if box is not None:
        context.setPeriodicBoxVectors(*box)
    context.setPositions(positions)
    return _result(context)


def _limit(scheme: str, part: str, style: str) -> int:
    if part.startswith("linear"):
        return _LONG[style]
    return _LIMITS.get((scheme, part), _ORDINARY)[style]


class _BendingPart:
    """One part of one scheme in one style, for all membranes that are within its limit.

    Those of VCM's golden files are among them, where these files are.
    """

    def __init__(self, scheme: str, part: str, style: str) -> None:
        self.members = [
            membrane
            for membrane in [
                *map(meshes.membrane, [*meshes.NAMES, *STRINGS_NAMES]),
                *published.golden_membranes(),
            ]
            if membrane.max_degree <= _limit(scheme, part, style)
        ]
        sizes = [membrane.num_particles for membrane in self.members]
        self.starts = np.concatenate([[0], np.cumsum(sizes)])
        triangles = np.concatenate(
            [m.triangles + start for m, start in zip(self.members, self.starts, strict=False)]
        )
        ones = np.ones(len(np.unique(triangles)))
        self.forces = string_forces.bending(triangles, ones, ones, scheme, style, parts=[part])
        self.context = _context(self.forces, int(self.starts[-1]))
        self.context.setPositions(np.concatenate([m.positions for m in self.members]))

    def evaluate(self, membrane: Membrane, rigidity, curvature) -> Result:
        number = self.members.index(membrane)
        start, stop = self.starts[number], self.starts[number + 1]
        rigidities, curvatures = (
            dict(zip((membrane.members + start).tolist(), np.broadcast_to(x, n), strict=True))
            for x, n in ((rigidity, len(membrane.members)), (curvature, len(membrane.members)))
        )
        for force in self.forces:
            for bond in range(force.getNumBonds()):
                particles, _ = force.getBondParameters(bond)
                centre = particles[0]
                values = [rigidities.get(centre, 0.0), curvatures.get(centre, 0.0)]
                force.setBondParameters(bond, particles, values)
            force.updateParametersInContext(self.context)
        result = _result(self.context)
        return Result(result.energy, result.forces[start:stop])


_compiled = cache(_BendingPart)


def _bending_part(scheme: str, part: str, style: str) -> _BendingPart:
    # S knows nothing of areas, so both Gompper–Kroll schemes share the linear part.
    if scheme == "GompperKrollBarycentric" and part.startswith("linear"):
        scheme = "GompperKroll"
    return _compiled(scheme, part, style)


def bending_within_limits(
    membrane: Membrane, scheme: str, style: str, curved: bool, unsigned: bool = False
) -> bool:
    """Whether `bending` can be asked for."""
    parts = string_forces.bending_parts(scheme, curved, unsigned)
    return all(membrane.max_degree <= _limit(scheme, part, style) for part in parts)


def bending(
    membrane: Membrane, scheme: str, style: str, rigidity, curvature=0.0, unsigned: bool = False
) -> Result:
    """The bending energy and forces of one of the tests' membranes."""
    curved = bool(np.any(np.asarray(curvature) != 0))
    parts = string_forces.bending_parts(scheme, curved, unsigned)
    results = [
        _bending_part(scheme, part, style).evaluate(membrane, rigidity, curvature) for part in parts
    ]
    return Result(sum(r.energy for r in results), sum(r.forces for r in results))
