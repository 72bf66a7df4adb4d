"""Measurements on membranes, and the theory to set beside them.

`mode_amplitudes` expands a nearly spherical vesicle in spherical harmonics, `spectrum` averages the
amplitudes with an error bar that knows about correlation in time, `mode_autocorrelation` has their
dynamics, `density_modes` and `structure_factor` the order of the vertices, `shape` and
`vertex_quantities` global and local measures, and `theory` holds the formulae for nearly spherical
vesicles of the paper, doi:10.1103/PhysRevE.108.015301.

Vertices are arrays of one frame or many, or whatever holds them: a `Mesh`, a State, Context or
Simulation of OpenMM, a `Trajectory` or the path of one. Long trajectories are read and worked on in
chunks.
"""

from . import theory
from ._gsd import GSDFrame, read_gsd
from .correlation import autocorrelation, autocorrelation_time, mode_autocorrelation
from .crossings import crossings
from .curvature import (
    VertexQuantities,
    area_difference,
    mean_curvature,
    total_mean_curvature,
    vertex_quantities,
)
from .density import density_modes, structure_factor
from .elements import edge_lengths, triangle_areas, triangle_heights
from .extended_xyz import write_extended_xyz
from .fits import DampingFit, ElasticFit, fit_damping, fit_young
from .gsd_files import write_gsd
from .harmonics import real_harmonics
from .landscapes import Grid, landscape, plane_grid, sphere_grid
from .lifetime import Lifetime, time_to_failure
from .modes import mode_amplitudes
from .shape import Shape, area_excess, gyration_tensor, shape
from .solid_angles import solid_angles
from .statistics import (
    Blocking,
    Estimate,
    MeanShape,
    Spectrum,
    blocking,
    mean_shape,
    mean_with_error,
    spectrum,
)
from .tables import Modes, read_modes, read_table
from .trajectories import Trajectory, read_triangles
from .vtkhdf import write_vtkhdf

__all__ = [
    "Blocking",
    "DampingFit",
    "ElasticFit",
    "Estimate",
    "GSDFrame",
    "Grid",
    "Lifetime",
    "MeanShape",
    "Modes",
    "Shape",
    "Spectrum",
    "Trajectory",
    "VertexQuantities",
    "area_difference",
    "area_excess",
    "autocorrelation",
    "autocorrelation_time",
    "blocking",
    "crossings",
    "density_modes",
    "edge_lengths",
    "fit_damping",
    "fit_young",
    "gyration_tensor",
    "landscape",
    "mean_curvature",
    "mean_shape",
    "mean_with_error",
    "mode_amplitudes",
    "mode_autocorrelation",
    "plane_grid",
    "read_gsd",
    "read_modes",
    "read_table",
    "read_triangles",
    "real_harmonics",
    "shape",
    "solid_angles",
    "spectrum",
    "sphere_grid",
    "structure_factor",
    "theory",
    "time_to_failure",
    "total_mean_curvature",
    "triangle_areas",
    "triangle_heights",
    "vertex_quantities",
    "write_extended_xyz",
    "write_gsd",
    "write_vtkhdf",
]
