"""A whole vesicle: the model of the paper, with the paper's parameters as defaults.

Farnudi, Ejtehadi and Everaers, *Dynamics of fluid bilayer vesicles*, Phys. Rev. E 108, 015301
(2023), doi:10.1103/PhysRevE.108.015301; numbers in brackets are its equations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from openmm import unit

from ._in_systems import InSystems
from ._numbers import checked_field, checked_number
from ._types import Scalar, Values
from ._values import form_number
from ._vesicle_flips import checked_flips, mover_of
from ._vesicle_parameters import Parameters
from ._vesicle_skeleton import checked_skeleton, skeleton_of
from ._vesicle_times import TimeScales
from ._vesicle_totals import checked_area_difference, checked_osmotic, encloses
from ._vesicle_viscosity import checked_viscosity, thermostat_of
from .analysis import theory, triangle_areas
from .forces import (
    AreaDifferenceForce,
    BendingForce,
    DihedralForce,
    EdgeTensionForce,
    EnclosedVolumeForce,
    GaussianCurvatureForce,
    OsmoticPressureForce,
    PlaquetteAreaForce,
    PressureForce,
    SurfaceAreaForce,
    SurfaceTensionForce,
    TriangleAreaForce,
    TriangleAreaRepulsionForce,
    TriangleHeightForce,
)
from .mesh import Mesh

# kBT at the paper's 300 K, in kJ/mol: its energies are given in multiples of this.
KBT = theory.BOLTZMANN * 300

_ENERGY = unit.kilojoule_per_mole


class Vesicle(InSystems, Parameters, TimeScales):
    """A fluid vesicle: bending, global area, global volume, and soft triangle heights.

    E = ½ κ Σ_i [J_i²/a_i − 2 C0 J_i + C0² a_i] + ½ kA (A − A0)²/A0 + ½ kV (V − V0)²/V0 + U_h

    U_h = Σ ε [(d/h)⁸ − (d/h)⁴ + ¼] over all triangle heights h < 2^¼ d keeps triangles from
    collapsing and leaves the vertices free to flow; the softness Ξ = (d/h̄)², with h̄² =
    √3 A / num_triangles (29–31), says how much of their freedom it takes. The force classes
    document the terms.

    Every number may be an OpenMM Quantity; plain numbers are in the units below.

    Parameters
    ----------
    mesh : Mesh
        The vertices become particles in their order, at their places; a System gets its box. With
        kV = 0 it may have borders, or span its box; then there is no term of the volume.
    rigidity : float, array_like or Quantity
        Bending rigidity κ, kJ/mol, of the membrane or, with shape (num_vertices,), of each vertex.
        Default 20 kBT at 300 K.
    area_modulus, volume_modulus : float or Quantity
        kA, kJ/mol/nm², default 1.3, and kV, kJ/mol/nm³, default 0.04. Zero switches the term off:
        with kV = 0 the membrane is permeable, as in the paper's fluctuation spectra. They are for
        about 1000 nm: kA r² and kV r³ count, so 100 nm need 130 and 40 to be as stiff.
    softness : float
        Ξ, which fixes the least height d = mesh.min_height(Ξ). Default 0.037, d ≈ 20 nm for 1002
        vertices on a sphere of 1000 nm.
    epsilon : float or Quantity
        ε of the triangle heights, kJ/mol. Default 4 kBT at 300 K.
    mass : float or Quantity
        Mass of every vertex, amu. Default 50.
    scheme : int
        Discretization of the bending energy, a constant of `BendingForce`. Default Jülicher.
    spontaneous_curvature : float, array_like or Quantity
        C0, 1/nm, positive for bulging outward; 2/r for a preferred sphere of radius r. One value,
        or one for each vertex, shape (num_vertices,).
    area, volume : float or Quantity, optional
        Targets A0, nm², and V0, nm³. Default: the mesh's own.
    reduced_volume : float, optional
        V0 as a multiple of the volume of the sphere of area A0, instead of `volume`. A sphere is a
        stationary point for any V0, where a minimiser may stop: begin with `Mesh.oblate` or
        `Mesh.prolate`.
    unsigned_spontaneous_curvature : bool
        Take the magnitude of the curvature in the linear term of C0, as VCM does.
    dihedral_stiffness : float or Quantity
        Stiffness K of a `DihedralForce`, kJ/mol. Default 0: without that force.
    dihedral_form : int
        Form of the dihedral potential, a constant of `DihedralForce`. Default quartic.
    triangle_area_modulus : float or Quantity
        Modulus of a `TriangleAreaForce` that keeps each triangle near the area that it has in the
        mesh, kJ/mol/nm². Default 0: without.
    plaquette_stiffness : float or Quantity
        Stiffness of a `PlaquetteAreaForce` with target A0, kJ/mol. Default 0: without.
    min_triangle_area : float or Quantity
        Area below which a `TriangleAreaRepulsionForce` of strength ε repels, nm². Default 0:
        without.
    edge_tension : float or Quantity
        Energy γ per length of borders of an `EdgeTensionForce`, kJ/mol/nm. Default 0: without.
    gaussian_modulus : float or Quantity
        Modulus κ_G of a `GaussianCurvatureForce`, kJ/mol; it acts at borders. Default 0: without.
    pressure : float or Quantity
        Pressure p inside less outside of a `PressureForce`, kJ/mol/nm³. Default 0: without.
    surface_tension : float or Quantity
        Tension σ of a `SurfaceTensionForce`, kJ/mol/nm². Default 0: without.
    osmotic : mapping, optional
        Arguments of an `OsmoticPressureForce` by their names: ``solutes`` inside,
        ``concentration`` outside, 1/nm³, and ``thermalEnergy``, kJ/mol, default kT at 300 K.
    area_difference : mapping, optional
        ``alpha`` and ``delta_a0`` of `area_difference_parameters`, for κ and A0, or ``modulus``,
        kJ/mol/nm², and ``target``, nm, of an `AreaDifferenceForce`.
    skeleton : mapping, optional
        Elasticity against a reference: ``law``, "Skalak" (the default), "NeoHookean",
        "LinearElastic" or "Spring", with the arguments of that force by their names, such as
        ``shearModulus`` and ``areaModulus``. The ``reference`` is the mesh unless it is given.
    flips : float or mapping, optional
        Make the membrane fluid: attempts to flip a bond for each edge and time step (0.01 is a good
        start), or the arguments of a `MonteCarloBondFlip` after the triangles by their names, with
        ``randomNumberSeed`` and ``ensemble`` too. The temperature is that of the integrator in
        `simulation`, or else 300 K, unless it is given. Default: neighbours stay neighbours.
    viscosity : float, Quantity or mapping, optional
        Make the membrane viscous: the surface shear viscosity η, amu/ps, of a regular mesh, or the
        arguments of a `SurfaceViscosityThermostat` after the triangles by their names, with
        ``randomNumberSeed`` too. The temperature is as that of `flips`. The friction is the Context
        parameter ``SurfaceViscosityFriction``, with the index of the first particle behind it
        where that is not 0. Default: none.

    Raises
    ------
    TypeError
        Something else than a number, or a Quantity of another dimension.
    ValueError
        A number that is NaN, infinite, negative, or zero where only positive ones make sense;
        both `volume` and `reduced_volume`, or one of them for a mesh without a volume.
    MeshError
        A mesh without a volume, if kV is not 0.

    Examples
    --------
    >>> mesh = Mesh.random_sphere(1002, 1000, seed=1)
    >>> vesicle = Vesicle(mesh)
    >>> integrator = openmm.LangevinMiddleIntegrator(300, 0.01, 0.2)
    >>> simulation = vesicle.simulation(integrator)
    >>> simulation.minimizeEnergy(tolerance=0.01)  # kJ/mol/nm; OpenMM's default is for atoms
    >>> simulation.context.setVelocitiesToTemperature(300)
    >>> simulation.step(1000)
    >>> vesicle.energies(simulation.context)["bending"]
    """

    def __init__(
        self,
        mesh: Mesh,
        rigidity: Values = 20 * KBT,
        area_modulus: Scalar = 1.3,
        volume_modulus: Scalar = 0.04,
        softness: float = 0.037,
        epsilon: Scalar = 4 * KBT,
        mass: Scalar = 50.0,
        scheme: int = BendingForce.Julicher,
        spontaneous_curvature: Values = 0.0,
        *,
        area: Scalar | None = None,
        volume: Scalar | None = None,
        reduced_volume: float | None = None,
        unsigned_spontaneous_curvature: bool = False,
        dihedral_stiffness: Scalar = 0.0,
        dihedral_form: int = DihedralForce.Quartic,
        triangle_area_modulus: Scalar = 0.0,
        plaquette_stiffness: Scalar = 0.0,
        min_triangle_area: Scalar = 0.0,
        edge_tension: Scalar = 0.0,
        gaussian_modulus: Scalar = 0.0,
        pressure: Scalar = 0.0,
        surface_tension: Scalar = 0.0,
        osmotic: Mapping[str, Any] | None = None,
        area_difference: Mapping[str, Any] | None = None,
        skeleton: Mapping[str, Any] | None = None,
        flips: float | Mapping[str, Any] | None = None,
        viscosity: Scalar | Mapping[str, Any] | None = None,
    ) -> None:
        nm = unit.nanometer
        if not isinstance(mesh, Mesh):
            raise TypeError(f"Vesicle: mesh needs a Mesh, got {type(mesh).__name__}")
        self._mesh = mesh
        self._rigidity = checked_field("rigidity", rigidity, _ENERGY, mesh)
        self._area_modulus = checked_number("area_modulus", area_modulus, _ENERGY / nm**2)
        self._volume_modulus = checked_number("volume_modulus", volume_modulus, _ENERGY / nm**3)
        self._encloses = encloses(mesh, needed=self._volume_modulus > 0)
        if not self._encloses and not (volume is None and reduced_volume is None):
            raise ValueError("Vesicle: the mesh encloses no volume; give no volume to keep it at")
        self._softness = checked_number("softness", softness, unit.dimensionless)
        self._epsilon = checked_number("epsilon", epsilon, _ENERGY)
        self._mass = checked_number("mass", mass, unit.dalton, zero=False)
        self._scheme = form_number("BendingForce", "scheme", scheme)
        self._spontaneous_curvature = checked_field(
            "spontaneous_curvature", spontaneous_curvature, nm**-1, mesh, negative=True
        )
        self._unsigned = bool(unsigned_spontaneous_curvature)
        self._dihedral_stiffness = checked_number("dihedral_stiffness", dihedral_stiffness, _ENERGY)
        self._dihedral_form = dihedral_form
        self._triangle_area_modulus = checked_number(
            "triangle_area_modulus", triangle_area_modulus, _ENERGY / nm**2
        )
        self._plaquette_stiffness = checked_number(
            "plaquette_stiffness", plaquette_stiffness, _ENERGY
        )
        self._min_triangle_area = checked_number("min_triangle_area", min_triangle_area, nm**2)
        self._edge_tension = checked_number(
            "edge_tension", edge_tension, _ENERGY / nm, negative=True
        )
        self._gaussian_modulus = checked_number(
            "gaussian_modulus", gaussian_modulus, _ENERGY, negative=True
        )
        self._pressure = checked_number("pressure", pressure, _ENERGY / nm**3, negative=True)
        self._surface_tension = checked_number(
            "surface_tension", surface_tension, _ENERGY / nm**2, negative=True
        )
        self._osmotic = None if osmotic is None else checked_osmotic(osmotic)
        if not self._encloses and (self._pressure != 0 or self._osmotic is not None):
            raise ValueError("Vesicle: the mesh encloses no volume on which a pressure could act")
        self._skeleton = None if skeleton is None else checked_skeleton(skeleton)
        self._min_height = mesh.min_height(self._softness)
        self._area = checked_number("area", mesh.area if area is None else area, nm**2, zero=False)
        if not self._encloses:
            self._volume = None
        elif reduced_volume is None:
            volume = mesh.volume if volume is None else volume
        elif volume is None:
            ratio = checked_number("reduced_volume", reduced_volume, unit.dimensionless, zero=False)
            volume = ratio * 4 / 3 * math.pi * self.radius**3
        else:
            raise ValueError("Vesicle: give either volume or reduced_volume, not both")
        if self._encloses:
            self._volume = checked_number("volume", volume, nm**3, zero=False)
        self._area_difference = None
        if area_difference is not None:
            self._area_difference = checked_area_difference(
                area_difference, self._rigidity, self._area
            )
        self._flips = None if flips is None else checked_flips(flips)
        self._viscosity = None if viscosity is None else checked_viscosity(viscosity)
        # The forces refuse a scheme or form that does not exist: now, not when they are used.
        self._forces(0)
        if self._flips is not None:
            mover_of(self._flips, mesh, 0)
        if self._viscosity is not None:
            thermostat_of(self._viscosity, mesh, 0)

    def __repr__(self) -> str:
        return (
            f"Vesicle({self._mesh.num_vertices} vertices, rigidity={np.mean(self._rigidity):.6g}, "
            f"area_modulus={self._area_modulus:.6g}, volume_modulus={self._volume_modulus:.6g}, "
            f"softness={self._softness:.6g}, epsilon={self._epsilon:.6g}, mass={self._mass:.6g}, "
            f"area={self._area:.6g}" + (f", volume={self._volume:.6g})" if self._encloses else ")")
        )

    def _forces(self, offset):
        """The forces by name, for particles that start at `offset`."""
        mesh, at = self._mesh, {"offset": offset}
        bending = BendingForce(
            mesh, self._rigidity, self._spontaneous_curvature, self._scheme, **at
        )
        bending.setUnsignedSpontaneousCurvature(self._unsigned)
        forces = {"area": SurfaceAreaForce(mesh, self._area_modulus, self._area, **at)}
        if self._encloses:
            forces["volume"] = EnclosedVolumeForce(mesh, self._volume_modulus, self._volume, **at)
        forces["bending"] = bending
        forces["heights"] = TriangleHeightForce(mesh, self._min_height, self._epsilon, **at)
        if self._dihedral_stiffness > 0:
            forces["dihedrals"] = DihedralForce(
                mesh, self._dihedral_stiffness, self._dihedral_form, **at
            )
        if self._triangle_area_modulus > 0:
            forces["triangle_areas"] = TriangleAreaForce(
                mesh, self._triangle_area_modulus, triangle_areas(mesh, mesh), **at
            )
        if self._plaquette_stiffness > 0:
            forces["plaquettes"] = PlaquetteAreaForce(
                mesh, self._plaquette_stiffness, self._area, **at
            )
        if self._min_triangle_area > 0:
            forces["triangle_repulsion"] = TriangleAreaRepulsionForce(
                mesh, self._min_triangle_area, self._epsilon, **at
            )
        if self._edge_tension != 0:
            forces["edge_tension"] = EdgeTensionForce(mesh, self._edge_tension, **at)
        if self._gaussian_modulus != 0:
            forces["gaussian_curvature"] = GaussianCurvatureForce(
                mesh, self._gaussian_modulus, **at
            )
        if self._pressure != 0:
            forces["pressure"] = PressureForce(mesh, self._pressure, **at)
        if self._surface_tension != 0:
            forces["surface_tension"] = SurfaceTensionForce(mesh, self._surface_tension, **at)
        if self._osmotic is not None:
            forces["osmotic"] = OsmoticPressureForce(mesh, **self._osmotic, **at)
        if self._area_difference is not None:
            forces["area_difference"] = AreaDifferenceForce(mesh, **self._area_difference, **at)
        if self._skeleton is not None:
            forces["skeleton"] = skeleton_of(self._skeleton, mesh, offset)
        return forces
