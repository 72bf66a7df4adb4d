"""Reporters for OpenMM's Simulation: modes, energies per term, shape and surfaces as it runs."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import openmm
from openmm import unit

from ._frame_reporters import ExtendedXYZReporter, GSDReporter, VTKHDFReporter
from ._numbers import whole_number
from ._present import has_energy
from ._surface_reporters import TableReporter
from ._types import File
from .analysis import mode_amplitudes, shape
from .virials import virial

__all__ = [
    "ExtendedXYZReporter",
    "GSDReporter",
    "MembraneReporter",
    "ModeReporter",
    "VTKHDFReporter",
    "VirialReporter",
]

_ENERGY = unit.kilojoule_per_mole

# Of a symmetric tensor.
_ELEMENTS = {
    "xx": (0, 0),
    "yy": (1, 1),
    "zz": (2, 2),
    "xy": (0, 1),
    "xz": (0, 2),
    "yz": (1, 2),
}


class ModeReporter(TableReporter):
    """Writes the amplitudes u_lm of a vesicle while a Simulation runs.

    Columns ``step``, ``time`` (ps) and ``u_l_m`` for l = 0 … lmax, m = −l … l; see
    `analysis.mode_amplitudes`. `analysis.read_modes` reads the file back. Every row is on disk when
    it has been written, so that a run that is killed loses nothing.

    Parameters
    ----------
    file : str or Path
        ``.csv``, or ``.h5`` / ``.hdf5`` for HDF5, which needs h5py
        (``pip install openmm-helfrich[hdf5]``).
    reportInterval : int
        Steps between rows, 1 or more.
    triangles : Mesh or array_like of int
        The triangles as particle indices, shape (num_triangles, 3), counter-clockwise seen from
        outside, as for the forces; or a Mesh whose vertex i is particle offset + i. Where a
        `MonteCarloBondFlip` acts, these are the triangles at the start, and each row is about those
        of its moment.
    lmax : int
        Largest l, 0 or more.
    quadrature, centre : str
        As for `analysis.mode_amplitudes`.
    offset : int
        Added to the indices of the triangles. Default 0.
    append : bool
        Go on with an existing file, from the step of the simulation: rows of later steps are
        dropped, since they will be written again, and a warning says if some before it are missing,
        or if all are dropped because the simulation is at step 0.
        Load the checkpoint or state first, with ``simulation.currentStep``, which
        `Simulation.loadCheckpoint` restores.

    Raises
    ------
    ValueError
        A number out of range; at the first report, another suffix, a file with other columns or of
        another reporter of the Simulation, or a surface that is not closed.

    Examples
    --------
    >>> simulation.reporters.append(ModeReporter("modes.csv", 500, mesh, lmax=10))
    >>> simulation.step(100_000)
    >>> step, time, amplitudes = analysis.read_modes("modes.csv")
    """

    def __init__(
        self,
        file: File,
        reportInterval: int,
        triangles: Any,
        lmax: int,
        quadrature: str = "fit",
        centre: str | None = None,
        *,
        offset: int = 0,
        append: bool = False,
    ) -> None:
        super().__init__(file, reportInterval, triangles, offset, append)
        self._lmax = whole_number(lmax, "ModeReporter", "lmax", 0)
        self._options = {"quadrature": quadrature, "centre": centre}

    def _columns(self, simulation):
        return {f"u_{l}_{m}": "" for l in range(self._lmax + 1) for m in range(-l, l + 1)}

    def _values(self, simulation, state, positions, triangles, box):
        return mode_amplitudes(positions, triangles, self._lmax, **self._options)


class MembraneReporter(TableReporter):
    """Writes energies per term and the shape of a membrane while a Simulation runs.

    Columns, in this order: ``step``; ``time`` (ps); ``NAME_energy`` (kJ/mol) for each force group
    of the System; ``potential_energy`` and ``kinetic_energy`` (kJ/mol) of the whole System;
    ``temperature`` (K); and of the membrane the fields of `analysis.Shape`: ``area`` (nm²),
    ``volume`` (nm³), ``reduced_volume``, ``radius_of_gyration`` (nm), ``asphericity`` and
    ``acylindricity`` (nm²), ``anisotropy``; NaN where a border or a periodic box that the surface
    spans leaves them without meaning. `analysis.read_table` reads the file back.

    Energies per term are those of the Context itself, group by group, and so are exact whatever was
    changed during the run. NAME is the name of the force; forces that share a group have one column
    under their names joined by ``+``. Give them groups of their own, as `Vesicle` does, to have
    them apart. A report costs about one evaluation for each group.

    Parameters
    ----------
    file : str or Path
        ``.csv``, or ``.h5`` / ``.hdf5`` for HDF5.
    reportInterval : int
        Steps between rows.
    triangles : Mesh or array_like of int
        As for `ModeReporter`.
    offset : int
        Added to the indices of the triangles. Default 0.
    append : bool
        As for `ModeReporter`.

    Raises
    ------
    ValueError
        As for `ModeReporter`.

    Examples
    --------
    >>> simulation.reporters.append(MembraneReporter("energies.csv", 500, vesicle.mesh))
    >>> simulation.step(100_000)
    >>> analysis.read_table("energies.csv")["bending_energy"].mean()
    """

    _include = ("positions", "energy")
    _spans = True

    def __init__(
        self,
        file: File,
        reportInterval: int,
        triangles: Any,
        *,
        offset: int = 0,
        append: bool = False,
    ) -> None:
        super().__init__(file, reportInterval, triangles, offset, append)

    def _columns(self, simulation):
        self._groups = _group_names(simulation.system)
        self._freedom = degrees_of_freedom(simulation.system)
        energies = [*self._groups.values(), "potential", "kinetic"]
        return {
            **{f"{name}_energy": "kJ/mol" for name in energies},
            "temperature": "K",
            "area": "nm^2",
            "volume": "nm^3",
            "reduced_volume": "",
            "radius_of_gyration": "nm",
            "asphericity": "nm^2",
            "acylindricity": "nm^2",
            "anisotropy": "",
        }

    def _values(self, simulation, state, positions, triangles, box):
        context = simulation.context
        terms = [
            context.getState(getEnergy=True, groups={group}).getPotentialEnergy() / _ENERGY
            for group in self._groups
        ]
        kinetic = state.getKineticEnergy()
        gas = unit.MOLAR_GAS_CONSTANT_R
        temperature = 2 * kinetic / (self._freedom * gas) / unit.kelvin if self._freedom else 0.0
        potential = state.getPotentialEnergy() / _ENERGY
        return [
            *terms,
            potential,
            kinetic / _ENERGY,
            temperature,
            *shape(positions, triangles, box=box),
        ]


class VirialReporter(TableReporter):
    """Writes virial, tension and pull of a membrane that spans the periodic box.

    Columns: ``step``; ``time`` (ps); ``ax``, ``bx``, ``by``, ``cx``, ``cy``, ``cz`` (nm), the
    vectors of the box; ``virial_xx``, ``_yy``, ``_zz``, ``_xy``, ``_xz``, ``_yz`` (kJ/mol), W =
    ∂E/∂ε of `virial`, of all membrane forces of the Context; ``motion_xx`` and so on (kJ/mol), K =
    Σ m v ⊗ v of the membrane's particles; ``tension`` (kJ/mol/nm²), (W_xx + W_yy − K_xx − K_yy) /
    (2 ax by), of a sheet in the xy plane, positive where it would shrink; and ``pull`` (kJ/mol/nm),
    (W_zz − K_zz) / cz, of a tube along z. Means of these two over a run are what
    `MonteCarloMembraneTension` imposes: M. P. Allen, D. J. Tildesley, Computer Simulation of
    Liquids, doi:10.1093/oso/9780198803195.001.0001, section 2.4.

    Parameters
    ----------
    file, reportInterval, triangles, offset, append
        As for `ModeReporter`.

    Raises
    ------
    ValueError
        As for `ModeReporter`; at the first report, a surface without periodic boundary conditions.

    Examples
    --------
    >>> simulation.reporters.append(VirialReporter("virial.csv", 100, sheet))
    >>> simulation.step(100_000)
    >>> analysis.read_table("virial.csv")["tension"].mean()
    """

    _include = ("positions", "velocities")
    _spans = True

    def __init__(
        self,
        file: File,
        reportInterval: int,
        triangles: Any,
        *,
        offset: int = 0,
        append: bool = False,
    ) -> None:
        super().__init__(file, reportInterval, triangles, offset, append)

    def _columns(self, simulation):
        system = simulation.system
        masses = [system.getParticleMass(int(i)) / unit.dalton for i in self._particles]
        self._masses = np.array(masses)[:, np.newaxis]
        return {
            **dict.fromkeys(("ax", "bx", "by", "cx", "cy", "cz"), "nm"),
            **{f"{name}_{ij}": "kJ/mol" for name in ("virial", "motion") for ij in _ELEMENTS},
            "tension": "kJ/mol/nm^2",
            "pull": "kJ/mol/nm",
        }

    def _values(self, simulation, state, positions, triangles, box):
        if box is None:
            raise ValueError(
                "VirialReporter: the membrane is in no periodic box; call "
                "setUsesPeriodicBoundaryConditions(True) of its forces"
            )
        speed = unit.nanometer / unit.picosecond
        velocities = state.getVelocities(asNumpy=True).value_in_unit(speed)
        velocities = np.asarray(velocities)[self._particles]
        stored, motion = virial(simulation.context), velocities.T @ (self._masses * velocities)
        xx, yy, zz = np.diag(stored - motion)
        elements = list(_ELEMENTS.values())
        return [
            *box[np.tril_indices(3)],
            *(matrix[ij] for matrix in (stored, motion) for ij in elements),
            (xx + yy) / (2 * box[0, 0] * box[1, 1]),
            zz / box[2, 2],
        ]


def _group_names(system):
    """The names of the forces of each force group, joined, by group in ascending order."""
    names = {}
    for force in system.getForces():
        if has_energy(force):
            names.setdefault(force.getForceGroup(), []).append(force.getName())
    joined, taken = {}, set()
    for group, parts in sorted(names.items()):
        # These would end the column or its line. Equal names, of several vesicles, get their
        # group's number.
        name = re.sub('[,"\r\n]', ";", "+".join(parts))
        if name in taken or name in ("potential", "kinetic"):
            name = f"{name}_{group}"
        taken.add(name)
        joined[group] = name
    return joined


def degrees_of_freedom(system: Any) -> Any:
    masses = [system.getParticleMass(i) / unit.dalton for i in range(system.getNumParticles())]
    count = 3 * np.count_nonzero(masses) - system.getNumConstraints()
    fixed = any(isinstance(force, openmm.CMMotionRemover) for force in system.getForces())
    return count - 3 * fixed
