"""Fluid membranes in OpenMM: curvature elasticity of triangulated vesicles.

Importing the package loads the plugin. Forces on triangulated membranes are then OpenMM Forces like
any other::

    import openmmhelfrich as helfrich

    mesh = helfrich.Mesh.random_sphere(1002, radius=1000, seed=1)
    system.addForce(helfrich.BendingForce(mesh, rigidity=50))

`Mesh` makes, reads and transforms triangulated surfaces, `Vesicle` is a whole model with the
defaults of Farnudi, Ejtehadi and Everaers (doi:10.1103/PhysRevE.108.015301), and `analysis` has
fluctuation spectra with their theory. Units are OpenMM's: nm, ps, amu, kJ/mol.
"""

from __future__ import annotations

try:
    from . import _plugin

    _plugin.load()
except ImportError:
    from .cli.doctor import doctor_if_asked

    doctor_if_asked()
    raise

from . import analysis, backend, config, platforms, vcm
from ._paths import cmake_path, include_path, library_path
from .area_difference import area_difference_parameters
from .backend import adapters, get_backend, set_backend
from .blowup import BlowUpError, BlowUpReporter, stable_time_step
from .domains import values_of_domains
from .errors import MeshError
from .forces import *  # noqa: F403
from .forces import __all__ as _force_names
from .masses import plaquette_masses
from .mesh import Mesh
from .pulling import pull
from .ramps import harden
from .red_cell import RedCell, RedCellModel
from .reporters import (
    ExtendedXYZReporter,
    GSDReporter,
    MembraneReporter,
    ModeReporter,
    VirialReporter,
    VTKHDFReporter,
)
from .states import load_state, save_state
from .vesicle import Vesicle
from .viewer import LiveView, View, view
from .virials import virial

__version__ = _plugin.version()

__all__ = [
    "BlowUpError",
    "BlowUpReporter",
    "ExtendedXYZReporter",
    "GSDReporter",
    "LiveView",
    "MembraneReporter",
    "Mesh",
    "MeshError",
    "ModeReporter",
    "RedCell",
    "RedCellModel",
    "VTKHDFReporter",
    "VirialReporter",
    "Vesicle",
    "View",
    "adapters",
    "analysis",
    "area_difference_parameters",
    "backend",
    "cmake_path",
    "config",
    "get_backend",
    "harden",
    "include_path",
    "library_path",
    "load_state",
    "plaquette_masses",
    "platforms",
    "pull",
    "save_state",
    "set_backend",
    "stable_time_step",
    "values_of_domains",
    "vcm",
    "view",
    "virial",
    *_force_names,
]
