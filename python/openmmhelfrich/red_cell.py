"""Red blood cells: models of the literature, on meshes of any size."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

from openmm import unit

from ._in_systems import InSystems
from ._mesh.discs import EVANS_FUNG_DIAMETER, evans_fung, spheroid
from ._numbers import checked_number
from ._types import Scalar
from .analysis import triangle_areas
from .area_difference import area_difference_parameters
from .forces import (
    AreaDifferenceForce,
    BendingForce,
    DihedralForce,
    EnclosedVolumeForce,
    LimForce,
    SkalakForce,
    SpringForce,
    SurfaceAreaForce,
    TriangleAreaForce,
)
from .mesh import Mesh

__all__ = ["RED_CELL_MODELS", "RedCell", "RedCellModel"]

_ENERGY, _NM = unit.kilojoule_per_mole, unit.nanometer
#: kJ/mol of a joule of a single cell.
_JOULE = 6.02214076e20
#: kJ/mol/nm² of 1 µN/m, and kJ/mol/nm³ of 1 Pa.
_MICRONEWTON_PER_METER, _PASCAL = 1e-24 * _JOULE, 1e-27 * _JOULE


@dataclass(frozen=True, kw_only=True)
class RedCellModel:
    """What a red cell is made of. Numbers may be Quantities; plain ones are in the units below.

    Attributes
    ----------
    shear_law : str
        "springs" or "harmonic": a network of springs, worm-like chains with a power law
        (`SpringForce` of form ``WLCPower``) or harmonic ones; "Skalak", "Lim" or "Amoudruz": a
        continuum (`SkalakForce`, `LimForce`).
    shear_modulus : float or Quantity
        μ of small strains, kJ/mol/nm².
    local_area_modulus : float or Quantity
        K of small strains of the continuum, or that of a `TriangleAreaForce` beside springs,
        kJ/mol/nm².
    rigidity : float or Quantity
        Bending rigidity κ, kJ/mol.
    bending : str
        A scheme of `BendingForce`, or "dihedral": hinges of stiffness 2κ/√3, at rest at the angle
        of a sphere of as many vertices.
    area_modulus, volume_modulus : float or Quantity
        kA, kJ/mol/nm², and kV, kJ/mol/nm³, that keep the whole area and the volume.
    diameter : float or Quantity
        Of the biconcave cell, nm.
    reference : float or None
        Shape of the skeleton at rest: reduced volume of an oblate spheroid of the same area, 1 for
        a sphere; None for the biconcave cell itself.
    area_difference : float or None
        Relaxed difference Δa₀ of the monolayers' areas, in multiples of that of a sphere; None
        without an `AreaDifferenceForce`.
    area_difference_ratio : float
        α, its modulus over κ.
    spring_ratio : float
        x₀ of "springs": their lengths at rest over their greatest.
    source : str
        Where the numbers are from.
    """

    shear_law: str
    shear_modulus: float
    local_area_modulus: float
    rigidity: float
    bending: str = "Julicher"
    area_modulus: float
    volume_modulus: float
    diameter: float = EVANS_FUNG_DIAMETER
    reference: float | None = None
    area_difference: float | None = None
    area_difference_ratio: float = 2 / math.pi
    spring_ratio: float = 1 / 2.2
    source: str = ""


#: The models by name.
RED_CELL_MODELS = {
    "fedosov": RedCellModel(
        shear_law="springs",
        shear_modulus=6.3 * _MICRONEWTON_PER_METER,
        local_area_modulus=6.3 * _MICRONEWTON_PER_METER,
        rigidity=2.4e-19 * _JOULE,
        bending="dihedral",
        area_modulus=49 * 6.3 * _MICRONEWTON_PER_METER,
        volume_modulus=332 * _PASCAL,
        source="D. A. Fedosov, B. Caswell, G. E. Karniadakis, doi:10.1016/j.bpj.2010.02.002",
    ),
    "lim": RedCellModel(
        shear_law="Lim",
        shear_modulus=2.5 * _MICRONEWTON_PER_METER,
        local_area_modulus=5.0 * _MICRONEWTON_PER_METER,
        rigidity=2.0e-19 * _JOULE,
        area_modulus=2000 * _MICRONEWTON_PER_METER,
        volume_modulus=2000 * _PASCAL,
        reference=0.95,
        area_difference=10 / (4 * math.pi),
        source="G. Lim H. W., M. Wortis, R. Mukhopadhyay, doi:10.1073/pnas.202617299",
    ),
    "amoudruz": RedCellModel(
        shear_law="Amoudruz",
        shear_modulus=4.99 * _MICRONEWTON_PER_METER,
        local_area_modulus=4.99 * _MICRONEWTON_PER_METER,
        rigidity=2.1e-19 * _JOULE,
        area_modulus=2000 * _MICRONEWTON_PER_METER,
        volume_modulus=2000 * _PASCAL,
        reference=0.95,
        source="L. Amoudruz et al., doi:10.1016/j.bpj.2023.03.019, as Mirheo's users have it",
    ),
    "farnudi": RedCellModel(
        shear_law="harmonic",
        shear_modulus=0.00025 * math.sqrt(3) / 4,
        local_area_modulus=0.0,
        rigidity=120.0,
        bending="GompperKrollBarycentric",
        area_modulus=1.3,
        volume_modulus=0.04,
        diameter=2640.0,
        source="A. Farnudi, M. R. Ejtehadi, R. Everaers, doi:10.1103/PhysRevE.108.015301, Fig. 8, "
        "with one mesh in place of two",
    ),
}

_UNITS = {
    "shear_modulus": _ENERGY / _NM**2,
    "local_area_modulus": _ENERGY / _NM**2,
    "rigidity": _ENERGY,
    "area_modulus": _ENERGY / _NM**2,
    "volume_modulus": _ENERGY / _NM**3,
    "diameter": _NM,
    "spring_ratio": unit.dimensionless,
    "area_difference_ratio": unit.dimensionless,
}


class RedCell(InSystems):
    """A red blood cell: a fluid membrane on an elastic skeleton, biconcave at the start.

    Parameters
    ----------
    model : str or RedCellModel
        A name among `RED_CELL_MODELS`: "fedosov", a network of springs; "lim", with
        area-difference elasticity; "amoudruz", inferred from experiments; "farnudi", the small cell
        of the paper. Or one of your own.
    num_vertices : int
        How fine the mesh is.
    mass : float or Quantity
        Mass of every vertex, amu.
    seed : int
        Of the mesh.
    **changes
        Numbers in place of those of the model, by the names in `RedCellModel`:
        ``reference=1`` for a skeleton that is at rest as a sphere, ``shear_modulus=…``.

    Raises
    ------
    TypeError
        Something else than a number, a Quantity of another dimension, or a name that a model
        does not have.
    ValueError
        A model, law or scheme that is not known, or a number out of range.
    MeshError
        Too few vertices.

    Notes
    -----
    The biconcave shape is that of E. A. Evans and Y.-C. Fung, doi:10.1016/0026-2862(72)90069-6,
    with a diameter of 7.82 µm, an area of 134 µm² and a volume of 94 µm³, which are the targets.
    All shapes, at the start and at rest, are images of one triangulated sphere by maps that keep
    areas.

    Examples
    --------
    >>> cell = RedCell("amoudruz", 1002)
    >>> simulation = cell.simulation(openmm.LangevinMiddleIntegrator(300, 0.01, 1.0))
    >>> simulation.minimizeEnergy(tolerance=0.01)  # kJ/mol/nm; OpenMM's default is for atoms
    >>> cell.energies(simulation.context)["shear"]
    """

    def __init__(
        self,
        model: str | RedCellModel = "fedosov",
        num_vertices: int = 1002,
        *,
        mass: Scalar = 50.0,
        seed: int = 1,
        **changes: Any,
    ) -> None:
        if isinstance(model, str):
            if model not in RED_CELL_MODELS:
                known = ", ".join(RED_CELL_MODELS)
                raise ValueError(f"RedCell: there is no model {model!r}; known are: {known}")
            model = RED_CELL_MODELS[model]
        elif not isinstance(model, RedCellModel):
            raise TypeError(
                f"RedCell: model needs a name or a RedCellModel, got {type(model).__name__}"
            )
        fields = {field.name for field in dataclasses.fields(RedCellModel)}
        for name in changes:
            if name not in fields:
                known = ", ".join(sorted(fields))
                raise TypeError(f"RedCell: a model has no {name!r}; it has: {known}")
        self._model = _checked(dataclasses.replace(model, **changes))
        self._mass = checked_number("mass", mass, unit.dalton, zero=False, caller="RedCell")
        profile = evans_fung(self._model.diameter)
        ball = Mesh.random_sphere(num_vertices, 1.0, seed=seed)
        self._mesh = Mesh(profile.of_sphere(ball.vertices), ball.triangles)
        self._reference = self._mesh
        if self._model.reference is not None:
            rest = spheroid(self._mesh.area, self._model.reference).of_sphere(ball.vertices)
            found = Mesh(rest, ball.triangles)
            self._reference = found.scaled(math.sqrt(self._mesh.area / found.area))
        self._forces(0)

    mesh = property(lambda self: self._mesh, doc="The biconcave Mesh, with which it starts.")
    reference = property(
        lambda self: self._reference, doc="The Mesh with the skeleton's shape at rest."
    )
    model = property(lambda self: self._model, doc="The `RedCellModel`, in plain numbers.")
    mass = property(lambda self: self._mass, doc="Mass of one vertex, amu.")

    def __repr__(self) -> str:
        return f"RedCell({self._model.shear_law}, {self._mesh.num_vertices} vertices)"

    def _forces(self, offset):
        """The forces by name, for particles that start at `offset`."""
        mesh, model, at = self._mesh, self._model, {"offset": offset}
        forces = {
            "area": SurfaceAreaForce(mesh, model.area_modulus, mesh.area, **at),
            "volume": EnclosedVolumeForce(mesh, model.volume_modulus, mesh.volume, **at),
            "shear": _SHEAR[model.shear_law](mesh, model, self._reference, at),
        }
        if model.bending == "dihedral":
            stiffness = 2 / math.sqrt(3) * model.rigidity
            rest = _angle_of_sphere(mesh.num_vertices)
            forces["dihedrals"] = DihedralForce(mesh, stiffness, DihedralForce.Cosine, rest, **at)
        else:
            forces["bending"] = BendingForce(mesh, model.rigidity, scheme=model.bending, **at)
        if model.shear_law in _NETWORKS and model.local_area_modulus > 0:
            targets = triangle_areas(self._reference, self._reference)
            forces["triangle_areas"] = TriangleAreaForce(
                mesh, model.local_area_modulus, targets, **at
            )
        if model.area_difference is not None:
            modulus, target = area_difference_parameters(
                model.rigidity, model.area_difference_ratio, mesh.area, model.area_difference
            )
            forces["area_difference"] = AreaDifferenceForce(mesh, modulus, target, **at)
        return forces


def _springs(form):
    def make(mesh, model, reference, at):
        # The shear modulus of a net of equal triangles is √3/4 of the springs' stiffness.
        stiffness = 4 / math.sqrt(3) * model.shear_modulus
        return SpringForce(mesh, stiffness, reference, ratio=model.spring_ratio, form=form, **at)

    return make


def _skalak(mesh, model, reference, at):
    # At small strains Skalak's moduli B and C make the shear modulus B/2, the area modulus C + B/2.
    area = model.local_area_modulus - model.shear_modulus
    return SkalakForce(mesh, 2 * model.shear_modulus, area, reference, **at)


def _lim(coefficients):
    def make(mesh, model, reference, at):
        moduli = (model.shear_modulus, model.local_area_modulus)
        return LimForce(mesh, *moduli, reference, coefficients, **at)

    return make


_SHEAR = {
    "springs": _springs("WLCPower"),
    "harmonic": _springs("Harmonic"),
    "Skalak": _skalak,
    "Lim": _lim("Lim2002"),
    "Amoudruz": _lim("Amoudruz2023"),
}
_NETWORKS = ("springs", "harmonic")
_BENDINGS = (
    "dihedral",
    "Julicher",
    "GompperKroll",
    "GompperKrollBarycentric",
    "JulicherVoronoi",
    "Espriu",
)


def _checked(model: RedCellModel) -> RedCellModel:
    """The model in plain numbers."""
    for name, known in (("shear_law", _SHEAR), ("bending", _BENDINGS)):
        value = getattr(model, name)
        if value not in known:
            raise ValueError(
                f"RedCell: there is no {name} {value!r}; known are: {', '.join(known)}"
            )
    plain = {
        name: checked_number(
            name, getattr(model, name), dimension, zero=name != "diameter", caller="RedCell"
        )
        for name, dimension in _UNITS.items()
    }
    for name, negative in (("reference", False), ("area_difference", True)):
        value = getattr(model, name)
        if value is not None:
            dimension = unit.dimensionless
            plain[name] = checked_number(
                name, value, dimension, negative=negative, caller="RedCell"
            )
    if model.shear_law == "Skalak" and plain["local_area_modulus"] < plain["shear_modulus"]:
        raise ValueError(
            "RedCell: Skalak's law has a local_area_modulus of at least shear_modulus, got "
            f"{plain['local_area_modulus']} and {plain['shear_modulus']}"
        )
    if model.reference is not None and not 0.01 <= plain["reference"] <= 1:
        raise ValueError(
            f"RedCell: reference needs a reduced volume from 0.01 to 1, got {plain['reference']}"
        )
    return dataclasses.replace(model, **plain)


def _angle_of_sphere(num_vertices: int) -> float:
    """The dihedral angle of a sphere of equal triangles (Fedosov et al., below equation (13))."""
    root = math.sqrt(3) * (num_vertices - 2)
    return math.acos((root - 5 * math.pi) / (root - 3 * math.pi))
