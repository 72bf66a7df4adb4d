"""The classes of forces, movers, thermostats and integrators, a file for each.

.ci/forces.py writes them from the headers of C++.
"""

from .area_difference_force import AreaDifferenceForce
from .bending_force import BendingForce
from .dihedral_force import DihedralForce
from .edge_tension_force import EdgeTensionForce
from .enclosed_volume_force import EnclosedVolumeForce
from .gaussian_curvature_force import GaussianCurvatureForce
from .lim_force import LimForce
from .line_tension_force import LineTensionForce
from .linear_elastic_force import LinearElasticForce
from .membrane_force import MembraneForce
from .monte_carlo_bond_flip import MonteCarloBondFlip
from .monte_carlo_domain_swap import MonteCarloDomainSwap
from .monte_carlo_membrane_tension import MonteCarloMembraneTension
from .neo_hookean_force import NeoHookeanForce
from .osmotic_pressure_force import OsmoticPressureForce
from .particle_surface_force import ParticleSurfaceForce
from .plaquette_area_force import PlaquetteAreaForce
from .pressure_force import PressureForce
from .skalak_force import SkalakForce
from .spring_force import SpringForce
from .surface_area_force import SurfaceAreaForce
from .surface_repulsion_force import SurfaceRepulsionForce
from .surface_tension_force import SurfaceTensionForce
from .surface_viscosity_thermostat import SurfaceViscosityThermostat
from .triangle_area_force import TriangleAreaForce
from .triangle_area_repulsion_force import TriangleAreaRepulsionForce
from .triangle_height_force import TriangleHeightForce
from .triangulated_force import TriangulatedForce
from .variable_mass_langevin_integrator import VariableMassLangevinIntegrator
from .variable_mass_verlet_integrator import VariableMassVerletIntegrator

__all__ = [
    "AreaDifferenceForce",
    "BendingForce",
    "DihedralForce",
    "EdgeTensionForce",
    "EnclosedVolumeForce",
    "GaussianCurvatureForce",
    "LimForce",
    "LineTensionForce",
    "LinearElasticForce",
    "MembraneForce",
    "MonteCarloBondFlip",
    "MonteCarloDomainSwap",
    "MonteCarloMembraneTension",
    "NeoHookeanForce",
    "OsmoticPressureForce",
    "ParticleSurfaceForce",
    "PlaquetteAreaForce",
    "PressureForce",
    "SkalakForce",
    "SpringForce",
    "SurfaceAreaForce",
    "SurfaceRepulsionForce",
    "SurfaceTensionForce",
    "SurfaceViscosityThermostat",
    "TriangleAreaForce",
    "TriangleAreaRepulsionForce",
    "TriangleHeightForce",
    "TriangulatedForce",
    "VariableMassLangevinIntegrator",
    "VariableMassVerletIntegrator",
]
