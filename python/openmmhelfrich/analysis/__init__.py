"""Measurements on membranes, and the theory to set beside them.

`mode_amplitudes` expands a nearly spherical vesicle in spherical harmonics, `spectrum` averages the
amplitudes with an error bar that knows about correlation in time, `mean_curvature` gives the local
curvature of every vertex, and `theory` holds the formulae for nearly spherical vesicles of the
paper, doi:10.1103/PhysRevE.108.015301.
"""

from . import theory
from .curvature import mean_curvature
from .harmonics import real_harmonics
from .modes import mode_amplitudes
from .solid_angles import solid_angles
from .statistics import Spectrum, autocorrelation_time, spectrum
from .trajectories import Trajectory

__all__ = [
    "Spectrum",
    "Trajectory",
    "autocorrelation_time",
    "mean_curvature",
    "mode_amplitudes",
    "real_harmonics",
    "solid_angles",
    "spectrum",
    "theory",
]
