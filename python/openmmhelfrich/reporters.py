"""Reporters for OpenMM's Simulation: modes, energies per term, shape and surfaces as it runs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import openmm
from openmm import unit

from ._numbers import whole_number
from ._surface_reporters import SurfaceReporter, TableReporter
from ._types import File
from .analysis import mode_amplitudes, shape
from .analysis.surface_series import SurfaceFrame, SurfaceSeries
from .forces import MonteCarloBondFlip, MonteCarloDomainSwap, MonteCarloMembraneTension
from .virials import virial

__all__ = ["MembraneReporter", "ModeReporter", "VTKHDFReporter", "VirialReporter"]

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
        dropped, since they will be written again, and a warning says if some before it are missing.
        Load the checkpoint or state first, with ``simulation.currentStep``, which
        `Simulation.loadCheckpoint` restores.

    Raises
    ------
    ValueError
        A number out of range; at the first report, another suffix, a file with other columns, or a
        surface that is not closed.

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


class VTKHDFReporter(SurfaceReporter):
    """Writes the surface of a membrane while a Simulation runs, in one file that ParaView opens.

    Each frame has its own positions and triangles, so that membranes whose bonds flip are shown as
    they are. Vertices carry ``mean_curvature``, H = C1 + C2 by Jülicher's scheme (B13,
    doi:10.1103/PhysRevE.108.015301), 1/nm; ``area``, a third of the triangles around, nm²;
    ``neighbours``, how many there are; and ``component``, the number of their connected surface,
    from 0. Triangles carry ``area``, nm², and ``component``. A surface that spans its periodic box
    is cut at the faces of the box, where vertices are there once for each image. Coordinates are in
    nm, times in ps. It takes VTK 9.3, ParaView 5.12 or newer ones to read them.

    Every frame is on disk when it has been written, and the file is closed in between: ParaView may
    look at it during the run. A kill in the middle of a frame leaves ``<file>.journal``, from which
    the next reporter with ``append=True`` makes the file whole.

    Parameters
    ----------
    file : str or Path
        ``.vtkhdf``. It needs h5py (``pip install openmm-helfrich[hdf5]``).
    reportInterval : int
        Steps between frames, 1 or more.
    triangles : Mesh or array_like of int
        As for `ModeReporter`; point i of the file is the i-th of their particles, in ascending
        order.
    offset : int
        Added to the indices of the triangles. Default 0.
    append : bool
        As for `ModeReporter`: frames of later steps are dropped.

    Raises
    ------
    ImportError
        Without h5py.
    ValueError
        A number out of range, or another suffix; at the first report, a file that is none of this
        reporter or has other numbers of vertices or triangles.

    Examples
    --------
    >>> simulation.reporters.append(VTKHDFReporter("vesicle.vtkhdf", 500, vesicle.mesh))
    >>> simulation.step(100_000)
    """

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
        if Path(file).suffix.lower() != ".vtkhdf":
            raise ValueError(f"VTKHDFReporter: {file}: the suffix must be .vtkhdf")
        self._series = SurfaceSeries(file)

    def _begin(self, simulation):
        self._num_frames = 0
        if not self._append:
            self._series.remove()
            return None
        try:
            steps = self._series.steps()
        except ValueError as reason:
            raise ValueError(f"VTKHDFReporter: {reason}; do not append") from None
        kept = steps[steps <= simulation.currentStep]
        self._series.cut(len(kept))
        self._num_frames = len(kept)
        return kept[-1] if len(kept) else None

    def _write(self, simulation, state, time, vertices, triangles, box):
        if self._num_frames:
            self._series.require()
        step = int(simulation.currentStep)
        self._series.add([SurfaceFrame(step, time, vertices, triangles, box)])
        self._num_frames += 1


def _group_names(system):
    """The names of the forces of each force group, joined, by group in ascending order."""
    names = {}
    for force in system.getForces():
        # These have no energy.
        if not (
            isinstance(force, openmm.CMMotionRemover)
            or MonteCarloBondFlip.isinstance(force)
            or MonteCarloDomainSwap.isinstance(force)
            or MonteCarloMembraneTension.isinstance(force)
        ):
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
