"""Bond flips in a run: the movers of a configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import openmm

from ..forces import MonteCarloBondFlip
from .bonded import find_bond_on
from .grammar import ConfigError

if TYPE_CHECKING:
    from .config import Config

__all__ = ["add_movers"]

#: Steps from one round of flips to the next, where only a rate is given.
FLIP_STEPS = 10


def add_movers(cfg: Config, system: openmm.System) -> None:
    """Let the bonds of a VCM configuration's membranes flip, at its temperature.

    Raises
    ------
    ConfigError
        If a force has a bond, an angle or a torsion on an edge of a mesh, which would not follow,
        or leaves out what the edges join.
    """
    if cfg.general["bondCutoff"] and any(
        row[number] != "0" for number, row in enumerate(cfg.table)
    ):
        raise cfg.general.error(
            "bondCutoff",
            "vertices near each other on the mesh do not interact, by the edges that it starts "
            "with, and that does not follow flips; leave out the flips, set it to 0, or let no "
            "membrane interact with itself",
        )
    edges = {
        (i, j)
        for membrane in cfg.membranes
        for i, j in np.sort(membrane.mesh.edges + membrane.offset, axis=1).tolist()
    }
    for force in system.getForces():
        pair = find_bond_on(edges, force)
        if pair is not None:
            raise ConfigError(
                f'{cfg.path}: flips: the potential "{force.getName()}" acts on particles {pair[0]} '
                f"and {pair[1]}, which the mesh connects, and does not follow flips; leave out one "
                "of the two"
            )
    for membrane in cfg.membranes:
        mover = MonteCarloBondFlip(
            membrane.mesh,
            cfg.temperature,
            frequency=FLIP_STEPS,
            attemptsPerEdge=FLIP_STEPS * cfg.flips,
            offset=membrane.offset,
        )
        mover.setName(f"flips {membrane.label}")
        mover.setRandomNumberSeed(cfg.seed)
        system.addForce(mover)
