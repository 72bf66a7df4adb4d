"""Where a vesicle is in a System, and the forces that act on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import openmm
from openmm import unit

from .forces import (
    BendingForce,
    EnclosedVolumeForce,
    MembraneForce,
    MonteCarloBondFlip,
    SurfaceAreaForce,
    SurfaceViscosityThermostat,
    TriangleHeightForce,
)
from .mesh import Mesh

__all__ = ["NUM_GROUPS", "Placement", "groups_for"]

_ENERGY = unit.kilojoule_per_mole
#: Force groups that OpenMM has.
NUM_GROUPS = 32


@dataclass(frozen=True)
class Placement:
    """Where one vesicle is in a System, and the forces that act on it."""

    system: openmm.System
    """The System."""
    offset: int
    """Index of the particle that is vertex 0."""
    num_vertices: int
    """Number of particles."""
    forces: Mapping[str, MembraneForce]
    """The forces by name: "area", "volume", "bending", "heights", and those switched on."""
    flips: MonteCarloBondFlip | None = None
    """What flips bonds, if anything does."""
    viscosity: SurfaceViscosityThermostat | None = None
    """What makes the membrane viscous, if anything does."""

    def __post_init__(self) -> None:
        # The forces live as long as their System, so whoever holds one holds that too.
        for force in (*self.forces.values(), self.flips, self.viscosity):
            if force is not None:
                force._system = self.system

    @property
    def area(self) -> SurfaceAreaForce:
        """The `SurfaceAreaForce`."""
        return cast(SurfaceAreaForce, self.forces["area"])

    @property
    def volume(self) -> EnclosedVolumeForce:
        """The `EnclosedVolumeForce`."""
        return cast(EnclosedVolumeForce, self.forces["volume"])

    @property
    def bending(self) -> BendingForce:
        """The `BendingForce`."""
        return cast(BendingForce, self.forces["bending"])

    @property
    def heights(self) -> TriangleHeightForce:
        """The `TriangleHeightForce`."""
        return cast(TriangleHeightForce, self.forces["heights"])

    @property
    def particles(self) -> range:
        """Indices of the particles, a range."""
        return range(self.offset, self.offset + self.num_vertices)

    def mesh(self, context: openmm.Context) -> Mesh:
        """The `Mesh` as it is now in a Context of the System: positions and triangles."""
        return Mesh.from_context(context, self.area)

    def energies(self, context: openmm.Context) -> dict[str, float]:
        """Energy per term in a Context of the System, a dict of float, kJ/mol.

        Each is the energy of the term's force group, and so holds other forces that share it.
        """
        return {
            name: context.getState(getEnergy=True, groups={force.getForceGroup()})
            .getPotentialEnergy()
            .value_in_unit(_ENERGY)
            for name, force in self.forces.items()
        }


def groups_for(forces, system, wanted=None):
    """A force group for each of the forces of a vesicle that is to be added to a System.

    Parameters
    ----------
    forces : collection
    system : openmm.System
    wanted : sequence of int, optional
        What `Vesicle.add_to` was given. Default: the lowest groups that no force uses.
    """
    count = len(forces)
    if wanted is None:
        used = {force.getForceGroup() for force in system.getForces()}
        wanted = [group for group in range(NUM_GROUPS) if group not in used][:count]
        if len(wanted) < count:
            raise ValueError(
                f"Vesicle: the System's forces use {len(used)} of the {NUM_GROUPS} force "
                f"groups, and {count} are needed; pass force_groups to share some"
            )
    groups = [int(group) for group in wanted]
    if len(groups) != count or not all(0 <= group < NUM_GROUPS for group in groups):
        raise ValueError(
            f"Vesicle: force_groups needs {count} groups of 0 to {NUM_GROUPS - 1}, "
            f"got {list(wanted)}"
        )
    return groups
