"""What a model of a surface does with Systems: joins them, runs alone, tells its energies."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import openmm
from openmm import app

from . import platforms
from ._numbers import whole_number
from ._placement import Placement, groups_for
from ._vesicle_flips import bath_of, mover_of
from ._vesicle_viscosity import thermostat_of
from .forces import MembraneForce, MonteCarloBondFlip, SurfaceViscosityThermostat
from .mesh import Mesh

__all__ = ["InSystems"]

_MAX_SEED = 2**31 - 1


class InSystems(ABC):
    """A mesh of particles of one mass with forces by their names, bond flips and a viscosity.

    Derived classes have ``_mesh``, ``_mass``, and ``_forces(offset)`` for particles from `offset`
    on.
    """

    _mesh: Mesh
    _mass: float
    _flips: Mapping[str, Any] | None = None
    _viscosity: Mapping[str, Any] | None = None
    _placement: Placement | None = None

    @abstractmethod
    def _forces(self, offset: int) -> dict[str, MembraneForce]:
        """The forces by name, for particles that start at `offset`."""

    def add_to(self, system: openmm.System, force_groups: Sequence[int] | None = None) -> Placement:
        """Add the particles and the forces to a System.

        The particles follow those which the System has, so several surfaces can share one. Each
        force gets a force group of its own and its name.

        Parameters
        ----------
        system : openmm.System
        force_groups : sequence of int, optional
            One group for each force, in the order above. Default: the lowest groups that no force
            of the System uses.

        Returns
        -------
        Placement
            Where it is in the System, and its forces.

        Raises
        ------
        ValueError
            Too few force groups are free, or `force_groups` is not one of 0 … 31 for each force.
        """
        offset = system.getNumParticles()
        forces = self._forces(offset)
        groups = groups_for(forces, system, force_groups)
        for (name, force), group in zip(forces.items(), groups, strict=True):
            force.setName(name)
            force.setForceGroup(group)
        if self._mesh.box is not None:
            system.setDefaultPeriodicBoxVectors(*self._mesh.box)
        for _ in range(self._mesh.num_vertices):
            system.addParticle(self._mass)
        for force in forces.values():
            system.addForce(force)
        mover = thermostat = None
        if self._viscosity is not None:
            # Before flips, which are at the positions that it leaves.
            thermostat = thermostat_of(self._viscosity, self._mesh, offset)
            system.addForce(thermostat)
        if self._flips is not None:
            mover = mover_of(self._flips, self._mesh, offset)
            system.addForce(mover)
        placement = Placement(system, offset, self._mesh.num_vertices, forces, mover, thermostat)
        self._placement = placement
        return placement

    def system(self) -> openmm.System:
        """A new System that holds this surface alone: vertex i is particle i.

        Returns
        -------
        openmm.System
        """
        system = openmm.System()
        self.add_to(system)
        return system

    def simulation(
        self,
        integrator: openmm.Integrator,
        platform: openmm.Platform | str | None = None,
        *,
        seed: int | None = None,
    ) -> app.Simulation:
        """A Simulation of this surface alone, with the positions of the mesh and no velocities.

        Parameters
        ----------
        integrator : openmm.Integrator
        platform : openmm.Platform or str, optional
            Default: the fastest one for it, see `platforms.choose`: mostly ``Helfrich``.
        seed : int, optional
            Of the random numbers of the integrator, and of flips and viscosity unless they have a
            ``randomNumberSeed``: 1 or more; equal seeds give equal runs. Default: others each time.
            `setVelocitiesToTemperature` of the Context takes a seed of its own.

        Returns
        -------
        openmm.app.Simulation

        Raises
        ------
        ValueError
            A seed out of range.
        """
        system = self.system()
        if seed is not None:
            name = type(self).__name__
            self._sow(integrator, whole_number(seed, name, "seed", 1, _MAX_SEED))
        if platform is None:
            platform = platforms.choose(system, integrator).name
        if isinstance(platform, str):
            platform = openmm.Platform.getPlatformByName(platform)
        simulation = app.Simulation(self._mesh.topology(), system, integrator, platform)
        simulation.context.setPositions(self._mesh.vertices)
        for given, cls in (
            (self._flips, MonteCarloBondFlip),
            (self._viscosity, SurfaceViscosityThermostat),
        ):
            if given is not None and "temperature" not in given:
                simulation.context.setParameter(cls.Temperature(), bath_of(integrator))
        return simulation

    def _sow(self, integrator: openmm.Integrator, seed: int) -> None:
        """Give all that draws random numbers, and has no seed of its own, this one."""
        several = isinstance(integrator, openmm.CompoundIntegrator)
        count = integrator.getNumIntegrators() if several else 1
        for number in range(count):
            one = integrator.getIntegrator(number) if several else integrator
            if hasattr(one, "setRandomNumberSeed"):
                one.setRandomNumberSeed(seed)
        placement = self.placement
        for given, mover in (
            (self._flips, placement.flips),
            (self._viscosity, placement.viscosity),
        ):
            if given is not None and mover is not None and "randomNumberSeed" not in given:
                mover.setRandomNumberSeed(seed)

    @property
    def placement(self) -> Placement:
        """The `Placement` in the System to which this surface was added last.

        Raises RuntimeError if it was not added to one yet.
        """
        if self._placement is None:
            raise RuntimeError(
                f"{type(self).__name__}: it is in no System yet; call simulation(), system() or "
                "add_to() first"
            )
        return self._placement

    def energies(self, context: openmm.Context) -> dict[str, float]:
        """Energies per term of the System to which this surface was added last.

        Parameters
        ----------
        context : openmm.Context
            A Context of that System. For a surface that was added to several Systems, ask the
            `Placement` that `add_to` returned.

        Returns
        -------
        dict of str to float
            Energy of each of the forces, kJ/mol.

        Raises
        ------
        RuntimeError
            It was not added to a System yet.
        """
        return self.placement.energies(context)
