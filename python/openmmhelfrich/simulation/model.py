"""A simulation as a configuration asks for it, whatever the configuration is written in."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import openmm
from openmm import app, unit

from .. import _present, platforms
from .._types import Array
from ..analysis import theory
from ..blowup import Limits
from ..logs import logger
from ..mesh import Mesh

__all__ = ["Membrane", "Model", "too_many_steps"]

_ENERGY = unit.kilojoule_per_mole
_VELOCITY = unit.nanometer / unit.picosecond


@dataclass(frozen=True)
class Membrane:
    """One membrane of a configuration.

    label: what the file calls it; settings: its values, by VCM's names; mesh: how it starts, in nm,
    triangles outward; offset: the particle that is vertex 0; num_reversed: how many triangles of
    the file faced the wrong way.
    """

    label: str
    settings: Mapping[str, Any]
    mesh: Mesh
    offset: int
    num_reversed: int

    @property
    def particles(self) -> range:
        """Indices of its particles."""
        return range(self.offset, self.offset + self.mesh.num_vertices)


_MOST_STEPS = 1e15


def too_many_steps(duration: float, step_size: float) -> str:
    """What is wrong with a time to simulate in such time steps, ps; empty if nothing is."""
    steps = duration / step_size if step_size > 0 else math.inf
    if steps < _MOST_STEPS:
        return ""
    return (
        f"{duration:g} ps are {steps:.3g} time steps of {step_size:g} ps, more than "
        f"{_MOST_STEPS:.0e}; make the one shorter or the other longer"
    )


class Model(ABC):
    """What a configuration file asks for.

    Attributes
    ----------
    path : Path
        The file.
    general : mapping
        The settings of the whole, by VCM's names and in VCM's units.
    membranes : tuple of Membrane
        In the order of the file, which is that of their particles.
    seed : int
        Of all random numbers, above 0: the file's, or one drawn if that is 0.
    platform : str or None
        OpenMM platform for a run that is told no other.
    writes : mapping
        What a run that is not told writes: "xtc", a bool, and "frames", one of `frames.FRAMES`.
    file_seed : int
        The seed that the file gives, or 0.
    limits : Limits
        Beyond which a run counts as broken down.
    """

    path: Path
    general: Mapping[str, Any]
    membranes: tuple[Membrane, ...]
    seed: int
    file_seed: int
    platform: str | None = None
    writes: Mapping[str, bool | str] = MappingProxyType({"xtc": True, "frames": "none"})
    limits = Limits()

    def __repr__(self) -> str:
        return f"<{self.name}: {len(self.membranes)} membranes, {self.num_particles} particles>"

    @abstractmethod
    def system(self) -> openmm.System:
        """A new System: vertex i of a membrane is particle `offset` + i.

        Every potential is one force with a name and a force group, see `terms`.
        """

    @property
    @abstractmethod
    def terms(self) -> dict[str, int]:
        """The potentials of the System by name, with the force group of each."""

    @property
    @abstractmethod
    def flows(self) -> bool:
        """Whether bonds flip in any membrane."""

    @property
    def name(self) -> str:
        """The project's name."""
        return self.general["ProjectName"]

    @property
    def num_particles(self) -> int:
        """Number of particles of the System."""
        return self.membranes[-1].particles.stop

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """The start mesh of every membrane."""
        return tuple(membrane.mesh for membrane in self.membranes)

    @property
    def temperature(self) -> float:
        """T, K."""
        return self.general["TemperatureinKelvin"]

    @property
    def kT(self) -> float:
        """The thermal energy kB T, kJ/mol."""
        return theory.BOLTZMANN * self.temperature

    @property
    def step_size(self) -> float:
        """Time step, ps."""
        return self.general["StepSizeInFs"] / 1000

    @property
    def num_steps(self) -> int:
        """Steps of the whole simulation."""
        return round(self.general["SimulationTimeInPs"] / self.step_size)

    @cached_property
    def positions(self) -> Array:
        """Start positions of all particles, shape (num_particles, 3), nm."""
        return np.concatenate([mesh.vertices for mesh in self.meshes])

    @property
    def velocity_shifts(self) -> Array:
        """Added to the first velocities, shape (num_particles, 3), nm/ps."""
        return np.zeros((self.num_particles, 3))

    def topology(self) -> app.Topology:
        """A chain per membrane, an atom per vertex, a bond per edge.

        Membrane n is chain n, and its atoms are called M<n>.
        """
        result = app.Topology()
        for number, membrane in enumerate(self.membranes):
            chain = result.addChain(f"M{number}")
            atoms = []
            for _ in membrane.particles:
                # A vertex is no chemical element; each is a residue of its own, see
                # `Mesh.topology`.
                residue = result.addResidue("MEM", chain)
                atoms.append(result.addAtom(f"M{number}", None, residue))
            for i, j in membrane.mesh.edges.tolist():
                result.addBond(atoms[i], atoms[j])
        if self.general["SimulationBoxLength"]:
            result.setUnitCellDimensions([self.general["SimulationBoxLength"]] * 3)
        return result

    def integrator(self) -> openmm.Integrator:
        """A new integrator as the file asks for, with the seed set."""
        kind, friction = self.general["Integrator"], self.general["FrictionIninvertPs"]
        if kind == "Verlet":
            return openmm.VerletIntegrator(self.step_size)
        cls = {
            "Brownian": openmm.BrownianIntegrator,
            "Langevin": openmm.LangevinIntegrator,
            "LangevinMiddle": openmm.LangevinMiddleIntegrator,
        }[kind]
        result = cls(self.temperature, friction, self.step_size)
        result.setRandomNumberSeed(self.seed)
        return result

    def simulation(self, platform: Any = None) -> app.Simulation:
        """A Simulation at its start: positions and velocities set, minimised if the file says so.

        Parameters
        ----------
        platform : openmm.Platform or str, optional
            Default: the fastest one for it, see `platforms.choose`. `Precision` is handed to
            platforms that have it.
        """
        made = self.unprepared_simulation(platform)
        self.prepare(made.context)
        return made

    def unprepared_simulation(self, platform: Any = None) -> app.Simulation:
        """A Simulation without positions and velocities, which a checkpoint may give instead."""
        system, integrator = self.system(), self.integrator()
        if platform is None:
            chosen = platforms.choose(system, integrator)
            logger("run").info("platform %s, for %s", chosen.name, chosen.reason)
            platform = chosen.name
        if isinstance(platform, str):
            platform = openmm.Platform.getPlatformByName(platform)
        properties = {}
        if "Precision" in platform.getPropertyNames():
            properties = {"Precision": self.general["Precision"]}
        return app.Simulation(self.topology(), system, integrator, platform, properties)

    def prepare(self, context: openmm.Context) -> None:
        """Bring a Context to the start of the simulation."""
        context.setPositions(self.positions)
        general = self.general
        if general["Minimise"]:
            openmm.LocalEnergyMinimizer.minimize(
                context, general["MinimiseTolerance"], general["MinimiseMaxIterations"]
            )
        if general["setVelocitiesToTemperature"]:
            context.setVelocitiesToTemperature(self.temperature, self.seed)
        if self.velocity_shifts.any():
            state = context.getState(getVelocities=True)
            drawn = state.getVelocities(asNumpy=True).value_in_unit(_VELOCITY)
            context.setVelocities(drawn + self.velocity_shifts)

    def energies(self, context: openmm.Context) -> dict[str, float]:
        """The energy of each of the `terms` in a Context of the System, kJ/mol."""
        return {
            name: context.getState(getEnergy=True, groups={group})
            .getPotentialEnergy()
            .value_in_unit(_ENERGY)
            for name, group in self.terms.items()
        }

    def present_triangles(self, context: openmm.Context) -> tuple[Array, ...]:
        """The triangles of each membrane now, shape (num_triangles, 3), from its vertex 0."""
        return tuple(
            _present.present_triangles(context, membrane.mesh.triangles + membrane.offset)
            - membrane.offset
            for membrane in self.membranes
        )
