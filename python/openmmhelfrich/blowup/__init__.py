"""Simulations that break down, explained.

`BlowUpReporter` watches a Simulation and says why it broke down; ``openmm-helfrich run`` does the
same for its runs. `stable_time_step` is the bound with which it compares the time step.
"""

from .diagnosis import BlowUpError
from .moments import Limits
from .reporter import BlowUpReporter
from .stability import stable_time_step
from .watch import Watch

__all__ = ["BlowUpError", "BlowUpReporter", "Limits", "Watch", "stable_time_step"]
