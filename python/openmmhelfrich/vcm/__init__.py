"""Configurations and Systems of the Virtual Cell Model (VCM), run as they are.

`read` understands VCM's configuration files and makes OpenMM objects of them::

    cfg = helfrich.vcm.read("SM_AVh_GKB_L_nu0.6.txt")
    simulation = cfg.simulation()
    simulation.step(1000)
    cfg.energies(simulation.context)["bending"]

`accelerate` replaces the Custom forces of a System, which VCM builds from strings, by the forces of
this package.
"""

from __future__ import annotations

from .accelerate import accelerate
from .config import Config, Membrane, read
from .grammar import ConfigError, ConfigWarning
from .keys import KEYS, Key

__all__ = [
    "KEYS",
    "Config",
    "ConfigError",
    "ConfigWarning",
    "Key",
    "Membrane",
    "accelerate",
    "read",
]
