"""The potentials of one membrane that are forces of this package.

Each maker is a function without arguments that makes a new force, because a System takes its
forces over. Formulas are in the documentation of the force classes.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import openmm

from .._types import Array
from ..forces import (
    BendingForce,
    DihedralForce,
    EnclosedVolumeForce,
    SurfaceAreaForce,
    TriangleAreaForce,
    TriangleAreaRepulsionForce,
    TriangleHeightForce,
)
from ..mesh import Mesh

if TYPE_CHECKING:
    from .config import Config, Membrane

__all__ = ["makers", "min_height"]

Maker = Callable[[], openmm.Force]


def _constant(cfg: Config, value: float) -> float:
    """A constant of an energy expression, with the six decimals that VCM prints it with."""
    return float(f"{value:.6f}") if cfg.vcm_compatible else value


def makers(cfg: Config, membrane: Membrane) -> dict[str, Maker]:
    """The potentials of a membrane on its triangles, by kind.

    Parameters
    ----------
    cfg : Config
    membrane : Membrane

    Returns
    -------
    dict of str to callable
        Some of "area", "volume", "bending", "heights", "triangle areas", "dihedrals".

    Raises
    ------
    ConfigError
        If a potential is not done here.
    """
    result = {
        "area": _area(cfg, membrane),
        "volume": _volume(cfg, membrane),
        "bending": _bending(cfg, membrane),
        "heights": _heights(cfg, membrane),
        "triangle areas": _areas(cfg, membrane),
        "dihedrals": _dihedrals(cfg, membrane),
    }
    return {kind: make for kind, make in result.items() if make is not None}


def _area(cfg: Config, membrane: Membrane) -> Maker | None:
    settings, mesh, offset = membrane.settings, membrane.mesh, membrane.offset
    model = settings["SurfaceConstraint"].area
    modulus = _constant(cfg, settings["SurfaceConstraintCoeff"])
    if not model or not modulus:
        return None
    value, ratio = settings["SurfaceConstraintValue"], settings["SurfaceConstraintRatio"]
    if model == "global":
        target = _constant(cfg, (mesh.area if value == "Au" else value) * ratio)
        return lambda: SurfaceAreaForce(mesh, modulus, target, offset=offset)
    targets = (_triangle_areas(mesh) if value == "Au" else value) * ratio
    return lambda: TriangleAreaForce(mesh, modulus, targets, offset=offset)


def _triangle_areas(mesh: Mesh) -> Array:
    a, b, c = (mesh.vertices[corner] for corner in mesh.triangles.T)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def _volume(cfg: Config, membrane: Membrane) -> Maker | None:
    settings, mesh = membrane.settings, membrane.mesh
    modulus = _constant(cfg, settings["VolumeConstraintCoeff"])
    if not settings["VolumeConstraint"] or not modulus:
        return None
    value, ratio = settings["VolumeConstraintValue"], settings["VolumeConstraintRatio"]
    if value == "Au":
        # VCM multiplies the mesh's own volume by the ratio twice.
        value = mesh.volume * (ratio if cfg.vcm_compatible else 1)
    target = _constant(cfg, value * ratio)
    return lambda: EnclosedVolumeForce(mesh, modulus, target, offset=membrane.offset)


def _bending(cfg: Config, membrane: Membrane) -> Maker | None:
    settings = membrane.settings
    scheme = settings["MeanCurvatureModel"]
    rigidity = _constant(cfg, settings["MeanCurvatureCoeff"])
    if scheme is None or not rigidity:
        return None
    curvature = _constant(cfg, settings["MeanspontaneousCurvature"])
    barycentric = scheme == BendingForce.GompperKrollBarycentric
    if cfg.vcm_compatible and not barycentric:
        # VCM's other models have no spontaneous curvature.
        curvature = 0.0

    def make() -> openmm.Force:
        force = BendingForce(membrane.mesh, rigidity, curvature, scheme, offset=membrane.offset)
        force.setUnsignedSpontaneousCurvature(cfg.vcm_compatible and barycentric and curvature != 0)
        return force

    return make


def min_height(cfg: Config, membrane: Membrane) -> float:
    """The least height d of a membrane's triangles, nm; 0 without a repulsion."""
    own = membrane.settings["SurfaceConstraint"]
    if cfg.vcm_compatible and own.min_height and not own.area:
        # In VCM, membranes with a repulsion of heights alone share the first one's d.
        for other in cfg.membranes:
            model = other.settings["SurfaceConstraint"]
            if model.min_height and not model.area:
                return model.min_height
    return own.min_height


def _heights(cfg: Config, membrane: Membrane) -> Maker | None:
    least, epsilon = min_height(cfg, membrane), _constant(cfg, cfg.general["EpsilonH"] * cfg.kT)
    if not least or not epsilon:
        return None
    return lambda: TriangleHeightForce(membrane.mesh, least, epsilon, offset=membrane.offset)


def _areas(cfg: Config, membrane: Membrane) -> Maker | None:
    model, epsilon = membrane.settings["SurfaceConstraint"], cfg.general["EpsilonH"] * cfg.kT
    least, epsilon = model.min_area, _constant(cfg, epsilon)
    if not least or not epsilon:
        return None
    if cfg.vcm_compatible and model.area:
        return lambda: _areas_of_vcm(membrane, least, epsilon)
    return lambda: TriangleAreaRepulsionForce(membrane.mesh, least, epsilon, offset=membrane.offset)


def _areas_of_vcm(membrane: Membrane, least: float, epsilon: float) -> openmm.Force:
    """GWCA as VCM has it: cut off where twice the area is 2^¼ a_m, with a jump of the energy."""
    force = openmm.CustomCompoundBondForce(
        3,
        f"{epsilon!r}*((least/area)^8-(least/area)^4+0.25)*step(2^0.25*least-2*area);"
        f"least={least!r};area=0.5*distance(p1,p2)*distance(p1,p3)*sin(angle(p2,p1,p3))",
    )
    for corners in (membrane.mesh.triangles + membrane.offset).tolist():
        force.addBond(corners, [])
    return force


def _dihedrals(cfg: Config, membrane: Membrane) -> Maker | None:
    settings = membrane.settings
    form, stiffness = settings["DihedralBendingModel"], settings["DihedralBendingCoeff"]
    stiffness = _constant(cfg, stiffness)
    if form is None or not stiffness:
        return None
    angle = settings["SpontaneousTriangleBendingAngleInDegrees"]

    def own() -> Array:
        return membrane.mesh.dihedral_angles

    rest = {180: lambda: 0.0, "Au": own, "Av": lambda: own().mean()}.get(angle)
    if rest is None:
        rest = functools.partial(float, np.pi - np.deg2rad(angle))
    offset = membrane.offset
    return lambda: DihedralForce(membrane.mesh, stiffness, form, rest(), offset=offset)
