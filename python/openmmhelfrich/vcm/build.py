"""From a configuration to OpenMM: the plan of its potentials, and the System.

The plan is made when the file is read, so that what cannot be done is refused with its line; the
forces themselves are made anew for every System.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import openmm

from .._placement import NUM_GROUPS
from . import connectivity, interactions, membrane_forces, springs

if TYPE_CHECKING:
    from .config import Config

__all__ = ["Term", "plan", "system"]


@dataclass(frozen=True)
class Term:
    """One potential: its name, its force group, and a function that makes its force."""

    name: str
    group: int
    make: Callable[[], openmm.Force]


def plan(cfg: Config) -> tuple[Term, ...]:
    """The potentials that a configuration asks for, in the order of its membranes.

    Names are those of the potentials; with several membranes their labels follow. Each has its own
    force group as long as these last; with more potentials, those of one kind share one.

    Raises
    ------
    ConfigError
        If a potential is not done here, or its settings contradict each other.
    """
    found: list[tuple[str, str, Callable[[], openmm.Force]]] = []
    for membrane in cfg.membranes:
        makers = {
            **membrane_forces.makers(cfg, membrane),
            **springs.makers(cfg, membrane),
        }
        suffix = "" if len(cfg.membranes) == 1 else f" {membrane.label}"
        found += [(kind, kind + suffix, make) for kind, make in makers.items()]
    found += [(kind, kind, make) for kind, make in interactions.makers(cfg).items()]
    _check_general(cfg)
    # The last group is left to what a user adds.
    if len(found) < NUM_GROUPS:
        return tuple(Term(name, group, make) for group, (_, name, make) in enumerate(found))
    kinds = list(dict.fromkeys(kind for kind, _, _ in found))
    return tuple(Term(kind, kinds.index(kind), make) for kind, _, make in found)


def _check_general(cfg: Config) -> None:
    """Refuse general settings that nothing here can follow."""
    general = cfg.general
    if general["MinimumForceDecleration"][0]:
        raise general.error(
            "MinimumForceDecleration",
            "VCM's optimisation is not documented and not done here; set it to false, the physics "
            "is the same",
        )
    for name in ("MCBarostatPressure", "MCAnisoBarostatPressure"):
        wanted = np.any(general[name])
        if wanted and not general["SimulationBoxLength"]:
            raise general.error(name, "a barostat needs a periodic box; give SimulationBoxLength")
        if wanted and not interactions.makers(cfg):
            raise general.error(
                name,
                "a barostat needs potentials that see the periodic box, and only those of the "
                "-InteractionTable do; it has none",
            )
    if cfg.general["setVelocitiesToTemperature"] and not cfg.temperature:
        raise general.error("TemperatureinKelvin", "velocities cannot be drawn at 0 K")


def system(cfg: Config, terms: tuple[Term, ...]) -> openmm.System:
    """What `Config.system` returns."""
    result = openmm.System()
    for membrane in cfg.membranes:
        mass = 0 if membrane.settings["FreezeSubLattice"] else membrane.settings["NodeMass"]
        for _ in membrane.particles:
            result.addParticle(mass)
    for term in terms:
        force = term.make()
        force.setName(term.name)
        force.setForceGroup(term.group)
        result.addForce(force)
    if cfg.flips:
        connectivity.add_movers(cfg, result)
    _add_box(cfg, result)
    if cfg.general["CMMotionRemoverStep"]:
        result.addForce(openmm.CMMotionRemover(cfg.general["CMMotionRemoverStep"]))
    return result


def _add_box(cfg: Config, result: openmm.System) -> None:
    """The periodic box and its barostats."""
    general = cfg.general
    side = general["SimulationBoxLength"]
    if not side:
        return
    result.setDefaultPeriodicBoxVectors(*(np.eye(3) * side).tolist())
    if general["MCBarostatPressure"]:
        result.addForce(
            openmm.MonteCarloBarostat(
                general["MCBarostatPressure"],
                general["MCBarostatTemperature"] or cfg.temperature,
                general["MCBarostatFrequency"] or 25,
            )
        )
    pressures = general["MCAnisoBarostatPressure"]
    if any(pressures):
        result.addForce(
            openmm.MonteCarloAnisotropicBarostat(
                openmm.Vec3(*pressures),
                general["MCAnisoBarostatTemperature"] or cfg.temperature,
                *(pressure != 0 for pressure in pressures),
                general["MCAnisoBarostatFrequency"] or 25,
            )
        )
    for force in result.getForces():
        if isinstance(force, (openmm.MonteCarloBarostat, openmm.MonteCarloAnisotropicBarostat)):
            force.setRandomNumberSeed(cfg.seed)
