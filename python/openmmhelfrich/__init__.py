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

from . import _plugin

_plugin.load()

from . import analysis, backend, config, platforms, vcm  # noqa: E402
from ._paths import cmake_path, include_path, library_path  # noqa: E402
from .area_difference import area_difference_parameters  # noqa: E402
from .backend import adapters, get_backend, set_backend  # noqa: E402
from .blowup import BlowUpError, BlowUpReporter, stable_time_step  # noqa: E402
from .domains import values_of_domains  # noqa: E402
from .errors import MeshError  # noqa: E402
from .forces import *  # noqa: E402, F403
from .forces import __all__ as _force_names  # noqa: E402
from .masses import plaquette_masses  # noqa: E402
from .mesh import Mesh  # noqa: E402
from .ramps import harden  # noqa: E402
from .red_cell import RedCell, RedCellModel  # noqa: E402
from .reporters import (  # noqa: E402
    MembraneReporter,
    ModeReporter,
    VirialReporter,
    VTKHDFReporter,
)
from .states import load_state, save_state  # noqa: E402
from .vesicle import Vesicle  # noqa: E402
from .viewer import LiveView, View, view  # noqa: E402
from .virials import virial  # noqa: E402

__version__ = _plugin.version()

__all__ = [
    "BlowUpError",
    "BlowUpReporter",
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
    "save_state",
    "set_backend",
    "stable_time_step",
    "values_of_domains",
    "vcm",
    "view",
    "virial",
    *_force_names,
]
