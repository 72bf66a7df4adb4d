"""A mesh as OpenMM sees it: a topology to draw, and particles to put a force on.

OpenMM is imported on first use, so that meshes can be made and measured without it.
"""

from __future__ import annotations

import copy

import numpy as np

from .._types import Array
from ..errors import MeshError

__all__ = ["context_of", "energy", "present", "topology"]


def topology(num_vertices: int, edges: Array, box: Array | None):
    """What `Mesh.topology` returns: one chain, an atom per vertex, a bond per edge."""
    from openmm import app

    result = app.Topology()
    chain = result.addChain("M")
    # A vertex is a patch of membrane and no chemical element. Each is a residue of its own, because
    # readers of PDB files take atoms of equal name in one residue for alternatives of one atom.
    residues = [result.addResidue("MEM", chain) for _ in range(num_vertices)]
    atoms = [result.addAtom("V", None, residue) for residue in residues]
    for i, j in edges.tolist():
        result.addBond(atoms[i], atoms[j])
    if box is not None:
        result.setPeriodicBoxVectors(box)
    return result


def energy(vertices: Array, force, box: Array | None) -> float:
    """What `Mesh.energy` returns: the energy of a copy of the force on the Reference platform."""
    import openmm
    from openmm import unit

    if not isinstance(force, openmm.Force):
        raise TypeError(f"Mesh.energy: force needs an openmm.Force, got {type(force).__name__}")
    context = context_of(len(vertices), [force], box, "Mesh.energy")
    context.setPositions(vertices)
    state = context.getState(getEnergy=True)
    return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)


def context_of(num_vertices: int, forces, box: Array | None, caller: str):
    """A Context of the Reference platform with copies of forces, in a group each."""
    import openmm

    system = openmm.System()
    for _ in range(num_vertices):
        system.addParticle(1.0)
    if box is not None:
        system.setDefaultPeriodicBoxVectors(*box)
    for group, force in enumerate(forces):
        if box is not None:
            _check_periodic(force, caller)
        force = copy.deepcopy(force)
        force.setForceGroup(group)
        system.addForce(force)
    platform = openmm.Platform.getPlatformByName("Reference")
    return openmm.Context(system, openmm.VerletIntegrator(0.001), platform)


def _check_periodic(force, caller: str) -> None:
    """Refuse a membrane force that takes edges across faces of the box for long ones."""
    from ..forces import MembraneForce

    for cls in MembraneForce.__subclasses__():
        if cls.isinstance(force) and not cls.cast(force).usesPeriodicBoundaryConditions():
            name = cls.__name__
            raise MeshError(
                f"{caller}: the mesh has a periodic box, but the {name} does not use it; make "
                f"it of the mesh, {name}(mesh, …), in place of mesh.triangles, or call its "
                "setUsesPeriodicBoundaryConditions(True)"
            )


def present(context, force) -> tuple[Array, Array, Array | None]:
    """What `Mesh.from_context` makes a mesh of: vertices, triangles, and the box."""
    from openmm import unit

    from .._present import is_periodic

    corners = force.getTrianglesInContext(context)
    particles, triangles = np.unique(corners, return_inverse=True)
    state = context.getState(getPositions=True)
    vertices = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)[particles]
    box = None
    if is_periodic(context, force):
        box = state.getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)
    return vertices, triangles.reshape(-1, 3), box
