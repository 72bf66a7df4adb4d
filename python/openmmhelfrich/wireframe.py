"""Topology files with which viewers draw a trajectory as a wire mesh, one bond per edge.

A PDB file will not do: its columns overflow at 10 000 Å, the size of one vesicle.
"""

from __future__ import annotations

from typing import Any

from openmm import unit

from ._types import Values
from ._writing import write_whole

# Readers of PSF expect these too.
_EMPTY_PSF_SECTIONS = (
    "NTHETA: angles",
    "NPHI: dihedrals",
    "NIMPHI: impropers",
    "NDON: donors",
    "NACC: acceptors",
    "NNB",
)


def write_psf(path: Any, topology: Any, system: Any) -> None:
    """Write the atoms and bonds of a topology as a PSF file, which VMD reads.

    ``vmd vesicle.psf vesicle.xtc`` then shows the mesh in the drawing method "Lines". The file is
    in X-PLOR's format; charges and atom types mean nothing for a membrane.

    Parameters
    ----------
    path : str or PathLike
        File to write.
    topology : openmm.app.Topology
        Its atoms and bonds, as `Mesh.topology` gives them.
    system : openmm.System
        Gives the masses; particle i is atom i.

    Raises
    ------
    ValueError
        The numbers of atoms and particles differ.
    """
    atoms, bonds, masses = _contents("write_psf", topology, system)
    lines = ["PSF", "", f"{1:8d} !NTITLE", " REMARKS written by openmm-helfrich", ""]
    lines.append(f"{len(atoms):8d} !NATOM")
    for number, (atom, mass) in enumerate(zip(atoms, masses, strict=True), start=1):
        residue = atom.residue
        segment = (residue.chain.id or "M")[:4]
        name = (atom.name or "V")[:4]
        lines.append(
            f"{number:8d} {segment:<4s} {residue.id[:4]:<4s} {(residue.name or 'MEM')[:4]:<4s} "
            f"{name:<4s} {name:<4s} {0:14.6f}{mass:14.6f}{0:8d}"
        )
    lines += ["", f"{len(bonds):8d} !NBOND: bonds"]
    flat = [f"{end + 1:8d}" for bond in bonds for end in bond]
    lines += ["".join(flat[i : i + 8]) for i in range(0, len(flat), 8)]
    for section in _EMPTY_PSF_SECTIONS:
        lines += ["", f"{0:8d} !{section}", ""]
    _write(path, lines)


def write_lammps_data(path: Any, topology: Any, system: Any, positions: Values) -> None:
    """Write atoms, bonds and positions as a LAMMPS data file, which OVITO reads.

    Open the file in OVITO and add the modifier "Load trajectory" with the XTC file. Positions are
    in Å, because OVITO converts XTC's nm to Å.

    Parameters
    ----------
    path : str or PathLike
        File to write.
    topology : openmm.app.Topology
        Its atoms and bonds, as `Mesh.topology` gives them.
    system : openmm.System
        Gives the masses; particle i is atom i.
    positions : array_like or Quantity
        Shape (num_atoms, 3), nm.

    Raises
    ------
    ValueError
        The numbers of atoms, particles and positions differ.
    """
    atoms, bonds, masses = _contents("write_lammps_data", topology, system)
    if unit.is_quantity(positions):
        positions = positions.value_in_unit(unit.nanometer)
    places = [[10 * float(x) for x in place] for place in positions]
    if len(places) != len(atoms):
        raise ValueError(f"write_lammps_data: {len(atoms)} atoms, but {len(places)} positions")
    types = {mass: kind for kind, mass in enumerate(dict.fromkeys(masses), start=1)}
    lines = ["written by openmm-helfrich", "", f"{len(atoms)} atoms", f"{len(bonds)} bonds"]
    lines += [f"{len(types)} atom types", "1 bond types", ""]
    for axis, values in zip("xyz", zip(*places, strict=True), strict=True):
        # Room around the mesh, into which it may move.
        margin = (max(values) - min(values)) / 2
        lines.append(f"{min(values) - margin:.3f} {max(values) + margin:.3f} {axis}lo {axis}hi")
    lines += ["", "Masses", ""] + [f"{kind} {mass:.6f}" for mass, kind in types.items()]
    lines += ["", "Atoms # bond", ""]
    for number, (place, mass) in enumerate(zip(places, masses, strict=True), start=1):
        lines.append(f"{number} 1 {types[mass]} " + " ".join(f"{x:.3f}" for x in place))
    lines += ["", "Bonds", ""]
    lines += [f"{i} 1 {a + 1} {b + 1}" for i, (a, b) in enumerate(bonds, start=1)]
    _write(path, lines)


def _contents(caller, topology, system):
    """Atoms, bonds as pairs of indices, and masses in amu."""
    atoms = list(topology.atoms())
    if len(atoms) != system.getNumParticles():
        raise ValueError(
            f"{caller}: the topology has {len(atoms)} atoms, but the System has "
            f"{system.getNumParticles()} particles"
        )
    bonds = [(bond.atom1.index, bond.atom2.index) for bond in topology.bonds()]
    masses = [system.getParticleMass(i).value_in_unit(unit.dalton) for i in range(len(atoms))]
    return atoms, bonds, masses


def _write(path, lines):
    write_whole(path, ("\n".join(lines) + "\n").encode("ascii"))
