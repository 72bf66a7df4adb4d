"""What is noted of a moment of a simulation, to tell later how it went wrong."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import openmm
from openmm import unit

from .._mesh.geometry import dihedral_angles, edges_of
from .._mesh.periodic import corner_positions
from .._present import is_periodic, surfaces_of
from .._types import Array
from ..reporters import degrees_of_freedom

__all__ = ["Gauge", "Limits", "Moment", "Surface"]

_ENERGY = unit.kilojoule_per_mole
_FORCE = _ENERGY / unit.nanometer


@dataclass(frozen=True)
class Limits:
    """Beyond which a simulation counts as broken down; None for no limit.

    max_temperature: K, of all particles; min_height: nm, of the triangle that is least high;
    max_fold: degrees, of the edge that is bent most, 0 if flat, 180 if its triangles lie upon each
    other.
    """

    max_temperature: float | None = None
    min_height: float | None = None
    max_fold: float | None = None

    def broken(self, moment: Moment) -> str | None:
        """What is wrong with a moment, None if nothing is."""
        if not math.isfinite(moment.potential + moment.kinetic):
            return f"the energy is {moment.potential:g} + {moment.kinetic:g} kJ/mol"
        if self.max_temperature is not None and moment.temperature > self.max_temperature:
            return (
                f"the temperature is {moment.temperature:.6g} K, above the limit of "
                f"{self.max_temperature:g} K"
            )
        if self.min_height is not None and moment.height < self.min_height:
            return (
                f"{moment.named_triangle} is {moment.height:.4g} nm high, below the limit of "
                f"{self.min_height:g} nm"
            )
        if self.max_fold is not None and moment.fold > self.max_fold:
            return (
                f"{moment.named_edge} is bent by {moment.fold:.4g}°, above the limit of "
                f"{self.max_fold:g}°"
            )
        return None


@dataclass(frozen=True)
class Moment:
    """One moment.

    step; time, ps; potential, kinetic: kJ/mol; temperature, K; height: nm, of the triangle that is
    least high, of the surface, with its number and particles; fold: degrees, of the edge that is
    bent most, with its particles; force: kJ/mol/nm, the largest, with its particle. What cannot be
    computed is NaN, and what there is none of has the number −1.
    """

    step: int
    time: float
    potential: float
    kinetic: float
    temperature: float
    height: float
    surface: int
    triangle: int
    corners: tuple[int, ...]
    fold: float
    edge: tuple[int, ...]
    force: float
    particle: int

    @property
    def named_triangle(self) -> str:
        """The triangle that is least high."""
        return f"triangle {self.triangle} ({', '.join(map(str, self.corners))})"

    @property
    def named_edge(self) -> str:
        """The edge that is bent most."""
        return f"edge ({', '.join(map(str, self.edge))})"


@dataclass(frozen=True)
class Surface:
    """A surface of a moment: positions of all particles, nm, its triangles, its box or None."""

    positions: Array
    triangles: Array
    box: Array | None

    @property
    def heights(self) -> Array:
        """The least height of each triangle, nm, shape (num_triangles,)."""
        corners = corner_positions(self.positions, self.triangles, self.box)
        sides = np.roll(corners, -1, axis=1) - corners
        doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        return doubled / np.linalg.norm(sides, axis=2).max(axis=1)

    @property
    def folds(self) -> Array:
        """By how much each edge is bent, degrees, in the order of `edges_of`."""
        corners = corner_positions(self.positions, self.triangles, self.box)
        return np.degrees(np.abs(dihedral_angles(corners, self.triangles)))


class Gauge:
    """Takes `Moment` after `Moment` of a Context."""

    def __init__(self, context: openmm.Context):
        self._context = context
        self._forces = surfaces_of(context)
        self._periodic = [is_periodic(context, force) for force in self._forces]
        self._freedom = degrees_of_freedom(context.getSystem())

    def surfaces(self, state: Any) -> list[Surface]:
        """The triangulated surfaces, as they are in a State with positions."""
        positions = np.array(state.getPositions(asNumpy=True).value_in_unit(unit.nanometer))
        box = np.array(state.getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer))
        return [
            Surface(positions, force.getTrianglesInContext(self._context), box if wraps else None)
            for force, wraps in zip(self._forces, self._periodic, strict=True)
        ]

    def take(self) -> Moment:
        """The present moment."""
        potential = kinetic = temperature = force = math.nan
        particle = -1
        try:
            state = self._context.getState(getPositions=True, getEnergy=True, getForces=True)
        except openmm.OpenMMException:
            state = self._context.getState(getPositions=True)
        else:
            potential, kinetic = (
                energy.value_in_unit(_ENERGY)
                for energy in (state.getPotentialEnergy(), state.getKineticEnergy())
            )
            gas = unit.MOLAR_GAS_CONSTANT_R.value_in_unit(_ENERGY / unit.kelvin)
            temperature = 2 * kinetic / (max(self._freedom, 1) * gas)
            forces = state.getForces(asNumpy=True).value_in_unit(_FORCE)
            with np.errstate(over="ignore"):
                forces = np.linalg.norm(forces, axis=1)
            particle = int(np.argmax(forces))
            force = float(forces[particle])
        return Moment(
            self._context.getStepCount(),
            state.getTime().value_in_unit(unit.picosecond),
            potential,
            kinetic,
            temperature,
            *self._extremes(state),
            force,
            particle,
        )

    def _extremes(self, state):
        """Least height, of which triangle, and sharpest fold, of which edge."""
        lowest = (math.nan, -1, -1, ())
        sharpest = (math.nan, ())
        for number, surface in enumerate(self.surfaces(state)):
            if not np.isfinite(surface.positions[surface.triangles]).all():
                continue
            with np.errstate(all="ignore"):
                heights, folds = surface.heights, surface.folds
            triangle, edge = int(np.argmin(heights)), int(np.argmax(folds))
            if not lowest[0] <= heights[triangle]:
                corners = tuple(surface.triangles[triangle].tolist())
                lowest = (float(heights[triangle]), number, triangle, corners)
            if not sharpest[0] >= folds[edge]:
                ends = tuple(edges_of(surface.triangles)[edge].tolist())
                sharpest = (float(folds[edge]), ends)
        return *lowest, *sharpest
