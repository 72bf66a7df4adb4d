"""Bonds of all kinds: springs on edges, sticky bonds, the hold of a surface.

These are forces of OpenMM's own. Each maker is a function without arguments that makes a new one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import openmm
from scipy.spatial import cKDTree

from .._types import Array
from .keys import NotDone

if TYPE_CHECKING:
    from .config import Config, Membrane

__all__ = ["edge_lengths", "makers", "sticky_pairs"]

Maker = Callable[[], openmm.Force]

# Vertices of two membranes as close as this are at the same place, nm.
_SAME_PLACE = 1e-8
# Stiffness of a sticky bond, kBT/nm².
_STICKY = 100

# Y20 on the unit sphere as a function of the square of cos θ = z/r.
_Y20 = f"{float(np.sqrt(5 / np.pi) / 4)!r}*(3*z^2/(r*r)-1)"


def makers(cfg: Config, membrane: Membrane) -> dict[str, Maker]:
    """The bonds of a membrane, by kind: some of "springs", "sticky", "lock-on".

    Raises
    ------
    ConfigError
        If a model is not done here, or a sticky membrane has nothing to stick to.
    """
    result = {
        "springs": _springs(membrane),
        "sticky": _sticky(cfg, membrane),
        "lock-on": _lock_on(cfg, membrane),
    }
    return {kind: make for kind, make in result.items() if make is not None}


def edge_lengths(membrane: Membrane) -> Array:
    """The length of every edge of the start mesh, in the order of `Mesh.edges`, nm."""
    ends = membrane.mesh.vertices[membrane.mesh.edges]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)


def _springs(membrane: Membrane) -> Maker | None:
    """½ k (r − r0)² on every edge."""
    settings = membrane.settings
    model, stiffness = settings["SpringModel"], settings["SpringCoeff"]
    if not stiffness or not model:
        return None
    if isinstance(model, NotDone):
        raise settings.error("SpringModel", f"{model.name} is not done here: {model.reason}")
    own, length = edge_lengths(membrane), settings["NominalLengthInNm"]
    lengths = {"Au": own, "Av": np.full_like(own, own.mean())}.get(length)
    if lengths is None:
        lengths = np.full_like(own, length)
    edges = membrane.mesh.edges + membrane.offset

    def make() -> openmm.Force:
        force = openmm.HarmonicBondForce()
        for (i, j), rest in zip(edges.tolist(), lengths.tolist(), strict=True):
            force.addBond(i, j, rest, stiffness)
        return force

    return make


def sticky_pairs(cfg: Config, membrane: Membrane) -> list[tuple[int, int]]:
    """Particles of a sticky membrane, each with one of another membrane at the same place.

    A pair of two sticky membranes belongs to the first of them.
    """
    pairs = []
    for number, other in enumerate(cfg.membranes):
        if other is membrane:
            own_number = number
    for number, other in enumerate(cfg.membranes):
        if number == own_number or (other.settings["Sticky"] and number < own_number):
            continue
        near = cKDTree(other.mesh.vertices).query_ball_point(membrane.mesh.vertices, _SAME_PLACE)
        for vertex, found in enumerate(near):
            pairs += [(membrane.offset + vertex, other.offset + partner) for partner in found]
    return pairs


def _sticky(cfg: Config, membrane: Membrane) -> Maker | None:
    """½ k r² with k = 100 kBT/nm² between vertices at the same place."""
    if not membrane.settings["Sticky"]:
        return None
    pairs = sticky_pairs(cfg, membrane)
    if not pairs:
        others_stick = any(
            other.settings["Sticky"] and sticky_pairs(cfg, other)
            for other in cfg.membranes
            if other is not membrane
        )
        if others_stick:
            return None
        raise membrane.settings.error(
            "Sticky",
            f"no vertex of membrane {membrane.label} lies within {_SAME_PLACE:g} nm of one of "
            "another membrane; do both have the same Scale?",
        )
    stiffness = _STICKY * cfg.kT

    def make() -> openmm.Force:
        force = openmm.HarmonicBondForce()
        for i, j in pairs:
            force.addBond(i, j, 0.0, stiffness)
        return force

    return make


def _lock_on(cfg: Config, membrane: Membrane) -> Maker | None:
    """½ k (r − R)² on a sphere about the origin, or R (1 + u Y20(θ)) in place of R."""
    settings = membrane.settings
    shape, amplitude = settings["LockOnPotential"]
    stiffness, radius = settings["LockOnRigidity"], settings["LockOnCoordinate"]
    if not shape or not stiffness:
        return None
    if shape == "Ellipsoid":
        raise settings.error(
            "LockOnPotential",
            "Ellipsoid is not done here: where its axes come from is not documented; use Sphere "
            "or ULM2_0",
        )
    if cfg.vcm_compatible:
        raise settings.error(
            "LockOnPotential",
            "VCM's prefactor and radius are not documented, so its numbers cannot be matched; read "
            "the file without vcm_compatible",
        )
    if not radius:
        raise settings.error("LockOnCoordinate", f"{shape} needs a radius above 0 nm")
    surface = f"{radius!r}*(1+{amplitude!r}*{_Y20})" if amplitude else f"{radius!r}"
    expression = f"{0.5 * stiffness!r}*(r-{surface})^2;r=sqrt(x^2+y^2+z^2)"

    def make() -> openmm.Force:
        force = openmm.CustomExternalForce(expression)
        for particle in membrane.particles:
            force.addParticle(particle, [])
        return force

    return make
