"""The forces of this package against Custom forces built from strings, term by term."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import openmm as mm
from openmm import unit

from .. import platforms
from .._types import Array
from .strings import custom_system, is_ours

__all__ = ["Comparison", "TermComparison", "compare"]

_SIZES = (1.0, 0.5, 0.25, 0.125, 0.0625)


@dataclass(frozen=True)
class TermComparison:
    """One potential in both Systems.

    energies: theirs and ours, kJ/mol; largest_force: of theirs, kJ/mol/nm; energy_error,
    force_error: relative, the latter to the largest force; shrunk: by how much the membranes were
    made smaller for this term, because a repulsion is out of reach otherwise; ours: whether it is
    a force of this package, and not one that is the same in both Systems.
    """

    name: str
    energies: tuple[float, float]
    largest_force: float
    energy_error: float
    force_error: float
    shrunk: float
    ours: bool


@dataclass(frozen=True)
class Comparison:
    """All potentials, and the time that both Systems take for a step.

    seconds: per step, theirs and ours, None where not measured; setup: to make the Contexts;
    platform: OpenMM's name of the one for both.
    """

    terms: tuple[TermComparison, ...]
    seconds: tuple[float, float] | None
    setup: tuple[float, float]
    platform: str

    def disagreements(self, tolerance: float) -> list[TermComparison]:
        """The terms whose relative errors are above a tolerance, or not numbers."""
        return [
            t
            for t in self.terms
            if not (t.energy_error <= tolerance and t.force_error <= tolerance)
        ]


def compare(
    cfg: Any,
    style: str = "sums",
    platform: str | None = None,
    seconds: float = 2.0,
    strain: float = 0.02,
) -> Comparison:
    """Evaluate a configuration with Custom forces and with ours.

    Energies and forces are compared off the start positions, because there area and volume have
    their targets, and what is left of their energies is rounding. A term that is zero there, such
    as a repulsion out of reach, is compared with smaller membranes.

    Parameters
    ----------
    cfg : Config
        As `openmmhelfrich.vcm.read` returns it.
    style : str
        How global area and volume are written: "sums" over triangles or "pairs" of triangles.
    platform : str, optional
        OpenMM's name of the platform for both. Default: the fastest one in double precision.
    seconds : float
        How long to measure the steps of each, s; 0 to leave it out. At least one step is made.
    strain : float
        Displacement of each particle along each axis: at random up to this fraction of the mean
        edge, on top of a dilation by this fraction.

    Returns
    -------
    Comparison
    """
    if platform is None:
        platform = platforms.choose(cfg.system(), cfg.integrator(), double=True).name
    systems = (lambda: custom_system(cfg.system(), style), cfg.system)
    contexts, setup = [], []
    for make in systems:
        begin = time.perf_counter()
        integrator = cfg.integrator()
        contexts.append(mm.Context(make(), integrator, mm.Platform.getPlatformByName(platform)))
        setup.append(time.perf_counter() - begin)
    terms = _terms(cfg, contexts, strain)
    per_step = None
    if seconds:
        per_step = tuple(_seconds_per_step(cfg, context, seconds) for context in contexts)
    return Comparison(terms, per_step, tuple(setup), platform)


def _terms(cfg, contexts: list[mm.Context], strain: float) -> tuple[TermComparison, ...]:
    """All terms, each at the first of several sizes at which it is not zero."""
    found: dict[str, TermComparison] = {}
    # The forces live as long as their System.
    system = cfg.system()
    ours = {force.getName() for force in system.getForces() if is_ours(force)}
    for size in _SIZES:
        missing = {name: g for name, g in cfg.terms.items() if name not in found}
        positions = _strained(cfg, strain, size)
        for context in contexts:
            context.setPositions(positions)
        for name, group in missing.items():
            states = [_state(context, group) for context in contexts]
            if size == _SIZES[-1] or any(energy or forces.any() for energy, forces in states):
                found[name] = _term(name, *states, size, name in ours)
    return tuple(found[name] for name in cfg.terms)


def _strained(cfg, strain: float, size: float) -> Array:
    random = np.random.default_rng(1)
    parts = []
    for mesh in cfg.meshes:
        a, b = (mesh.vertices[column] for column in mesh.edges.T)
        edge = np.linalg.norm(a - b, axis=1).mean()
        centre = mesh.vertices.mean(axis=0)
        moved = centre + (1 + strain) * (mesh.vertices - centre)
        moved += random.uniform(-1, 1, moved.shape) * strain * edge
        parts.append(centre + size * (moved - centre))
    return np.concatenate(parts)


def _state(context: mm.Context, group: int) -> tuple[float, Array]:
    state = context.getState(energy=True, forces=True, groups={group})
    md = unit.md_unit_system
    energy = state.getPotentialEnergy().value_in_unit_system(md)
    return energy, np.array(state.getForces(asNumpy=True).value_in_unit_system(md))


def _seconds_per_step(cfg, context: mm.Context, seconds: float) -> float:
    context.setPositions(cfg.positions)
    context.setVelocitiesToTemperature(cfg.temperature, cfg.seed)
    integrator = context.getIntegrator()
    # The first step starts threads and compiles; the energy waits until a GPU has finished.
    integrator.step(1)
    context.getState(energy=True)
    steps = done = 1
    begin = time.perf_counter()
    integrator.step(1)
    while True:
        context.getState(energy=True)
        passed = time.perf_counter() - begin
        if passed >= seconds:
            return passed / done
        # Longer and longer, so that looking at the clock costs nothing.
        steps = max(1, min(2 * steps, int(steps * (seconds - passed) / passed)))
        integrator.step(steps)
        done += steps


def _term(name: str, theirs, ours, size: float, is_ours: bool) -> TermComparison:
    largest = float(np.abs(theirs[1]).max())
    force_error = float(np.abs(theirs[1] - ours[1]).max())
    energy_error = abs(theirs[0] - ours[0])
    scale = max(abs(theirs[0]), abs(ours[0]))
    return TermComparison(
        name,
        (theirs[0], ours[0]),
        largest,
        energy_error / scale if scale else energy_error,
        force_error / largest if largest else force_error,
        size,
        is_ours,
    )
