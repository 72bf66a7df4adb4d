"""Measuring steps: what ``openmm-helfrich bench`` and the scripts of ``benches/`` share."""

from .machine import machine, versions
from .targets import INTEGRATORS, TIME_STEP, Target, empty_system, sphere, start, targets
from .timing import Steps, fastest

__all__ = [
    "INTEGRATORS",
    "TIME_STEP",
    "Steps",
    "Target",
    "empty_system",
    "fastest",
    "machine",
    "sphere",
    "start",
    "targets",
    "versions",
]
