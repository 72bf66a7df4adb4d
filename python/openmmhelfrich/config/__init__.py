"""Configurations of our own, in TOML: vesicles, forces, integrator and outputs of a simulation.

`read` understands them and makes OpenMM objects of them, as `vcm.read` does of VCM's files::

    cfg = helfrich.config.read("vesicle.toml")
    simulation = cfg.simulation()

``docs/config.md`` describes the format.
"""

from __future__ import annotations

from .keys import KEYS, Key
from .model import Configuration, VesicleMembrane, read, read_any

__all__ = ["KEYS", "Configuration", "Key", "VesicleMembrane", "read", "read_any"]
