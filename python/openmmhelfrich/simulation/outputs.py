"""The files of a run: VCM's own formats, XTC, CSV and meshes.

Every file only grows, and `Outputs` knows how long each one was at a checkpoint, so that a run can
go on from there with nothing lost and nothing doubled.
"""

from __future__ import annotations

import hashlib
import os
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import openmm
from openmm import unit
from openmm.app.internal.xtc_utils import xtc_write_frame

from .._mesh import geometry
from .._start_mesh import write_start
from .._types import Array, File
from .._writing import in_memory, naming
from ..analysis import mean_curvature, shape
from ..wireframe import write_psf
from .frames import frames_writer, joined

if TYPE_CHECKING:
    from ..vcm.parsers import Interval
    from .model import Model

__all__ = ["Frame", "Outputs", "report_steps", "take_frame"]

_KILOJOULE = unit.kilojoule_per_mole
_FORCE = unit.kilojoule_per_mole / unit.nanometer
_VELOCITY = unit.nanometer / unit.picosecond
# Of which a checkpoint has a digest, bytes.
_END = 4096


def report_steps(interval: Interval, step_size: float, num_steps: int) -> Iterator[int]:
    """The steps after which to report, ascending, without end or up to the last one.

    Parameters
    ----------
    interval : Interval
        What the file says.
    step_size : float
        ps.
    num_steps : int
        Steps of the whole simulation as the file says, for a fixed number of growing intervals.
    """
    if interval.fs:
        every = max(1, round(interval.fs / 1000 / step_size))
        number = every
        while True:
            yield number
            number += every
    if interval.reports:
        steps = np.geomspace(1, max(num_steps, 1), interval.reports)
        yield from np.unique(np.rint(steps).astype(int)).tolist()
        return
    exact, last = 1.0, 0
    while True:
        if round(exact) > last:
            last = round(exact)
            yield last
        exact *= interval.factor


@dataclass(frozen=True)
class Frame:
    """What is known about one moment of a simulation, in OpenMM's units.

    positions, velocities, forces: shape (num_particles, 3), nm, nm/ps, kJ/mol/nm; forces are None
    unless asked for; terms: kJ/mol by name; triangles: those of each membrane, shape
    (num_triangles, 3), from its vertex 0.
    """

    step: int
    time: float
    potential: float
    kinetic: float
    positions: Array
    velocities: Array
    forces: Array | None
    terms: dict[str, float]
    box: Array
    triangles: tuple[Array, ...]


def take_frame(cfg: Model, context: openmm.Context, step: int) -> Frame:
    """The present state of a Context.

    Raises
    ------
    FloatingPointError
        If the energy is not finite.
    """
    with_forces = "FORCE" in cfg.general["TextOutputs"]
    # Energies by term come first, so that the forces of all of them are the last ones computed.
    terms = cfg.energies(context) if cfg.general["ReportEnergy"] else {}
    state = context.getState(
        getPositions=True, getVelocities=True, getEnergy=True, getForces=with_forces
    )
    energies = [state.getPotentialEnergy(), state.getKineticEnergy()]
    potential, kinetic = (energy.value_in_unit(_KILOJOULE) for energy in energies)
    if not np.isfinite(potential + kinetic):
        raise FloatingPointError(f"the energy is {potential} + {kinetic} kJ/mol at step {step}")
    forces = None
    if with_forces:
        forces = state.getForces(asNumpy=True).value_in_unit(_FORCE)
    box = state.getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)
    if not cfg.general["SimulationBoxLength"]:
        box = np.zeros((3, 3))
    return Frame(
        step,
        step * cfg.step_size,
        potential,
        kinetic,
        state.getPositions(asNumpy=True).value_in_unit(unit.nanometer),
        state.getVelocities(asNumpy=True).value_in_unit(_VELOCITY),
        forces,
        terms,
        np.asarray(box),
        cfg.present_triangles(context),
    )


def _digest_of_end(path: Path, size: int) -> str:
    """SHA-256 of the last bytes of the first so many of a file: another run has others."""
    with naming(path), path.open("rb") as file:
        file.seek(max(0, size - _END))
        return hashlib.sha256(file.read(min(size, _END))).hexdigest()


def _masses(cfg: Model) -> list[float]:
    """Of the vertices of all membranes, amu."""
    system = cfg.system()
    particles = (i for membrane in cfg.membranes for i in membrane.particles)
    return [system.getParticleMass(i).value_in_unit(unit.dalton) for i in particles]


class Outputs:
    """All files of one run that grow, in one folder.

    Parameters
    ----------
    cfg : Model
    folder : str or Path
        Exists already.
    xtc : bool
        Write ``<name>.xtc`` too.
    frames : str
        One of `frames.FRAMES`: what to write meshes as, ``frames/<name>_<label>_<number>`` for each
        membrane and frame, or ``<name>.vtkhdf``, ``.gsd`` or ``.extxyz`` for all.
    """

    def __init__(self, cfg: Model, folder: File, xtc: bool = True, frames: str = "none") -> None:
        self._cfg = cfg
        self._folder = Path(folder)
        self._names = [atom.name for atom in cfg.topology().atoms()]
        labels = [membrane.label for membrane in cfg.membranes]
        masses = _masses(cfg) if frames == "gsd" else 1.0
        self._frames = frames_writer(self._folder, cfg.name, frames, labels, masses)
        self._num_frames = 0
        self._start = self._folder / f"{cfg.name}.ply" if xtc else None
        text, binary = cfg.general["TextOutputs"], cfg.general["BinOutputs"]
        double = cfg.general["Precision"] == "double"
        self._type = np.dtype("<f8" if double else "<f4")
        kind = "double" if double else "single"
        writers: dict[str, tuple[bool, Callable[[Frame], bytes]]] = {
            ".xyz": ("XYZ" in text, lambda f: self._xyz(f, f.positions)),
            ".vel": ("VEL" in text, lambda f: self._xyz(f, f.velocities)),
            ".force": ("FORCE" in text, lambda f: self._xyz(f, f.forces)),
            ".curve": ("CURVE" in text, lambda f: self._xyz(f, self._curvatures(f))),
            ".pdb": ("PDB" in text, self._pdb),
            f".bin_xyz_{kind}": ("XYZ" in binary, lambda f: self._binary(f.positions)),
            f".bin_vel_{kind}": ("VEL" in binary, lambda f: self._binary(f.velocities)),
            f".bin_tpk_{kind}": (
                "TPK" in binary,
                lambda f: self._binary([f.time, f.potential, f.kinetic]),
            ),
            ".csv": (True, self._csv),
            ".xtc": (xtc, self._xtc),
            ".triangles": (xtc and cfg.flows, self._all_triangles),
        }
        self._writers = {
            self._folder / (cfg.name + suffix): write
            for suffix, (wanted, write) in writers.items()
            if wanted
        }

    @property
    def paths(self) -> list[Path]:
        """The files that grow."""
        return list(self._writers)

    @property
    def num_frames(self) -> int:
        """How many frames have been written."""
        return self._num_frames

    def start(self) -> None:
        """Make empty files, the PSF file, and the mesh at the start for readers of the XTC file."""
        for path in self.paths:
            path.write_bytes(b"")
        if self._frames is not None:
            self._frames.remove_from(0)
        if "PSF" in self._cfg.general["TextOutputs"]:
            psf = self._folder / f"{self._cfg.name}.psf"
            with naming(psf):
                write_psf(psf, self._cfg.topology(), self._cfg.system())
        if self._start is not None:
            meshes = [membrane.mesh for membrane in self._cfg.membranes]
            vertices, triangles = joined((mesh.vertices, mesh.triangles) for mesh in meshes)
            box = next((mesh.box for mesh in meshes if mesh.box is not None), None)
            write_start(self._start, vertices, triangles, box, self._cfg.flows)

    def write(self, frame: Frame) -> None:
        """Add one frame to every file.

        Raises
        ------
        OSError
            If the system refuses, or a file has been taken away. Files may then have a part of the
            frame, until `restore`.
        """
        for path, encode in self._writers.items():
            # Not "ab", which would make a new file where one was taken away.
            with naming(path), path.open("r+b") as file:
                file.seek(0, os.SEEK_END)
                file.write(encode(frame))
        if self._frames is not None:
            parts = [(vertices, triangles) for _, vertices, triangles, _ in self._parts(frame)]
            box = next((box for *_, box in self._parts(frame)), None)
            self._frames.write(self._num_frames, frame.step, frame.time, parts, box)
        self._num_frames += 1

    def state(self) -> dict[str, Any]:
        """Frames so far, lengths of all files and digests of their ends, once on the disk."""
        sizes, ends = {}, {}
        for path in self.paths:
            with naming(path), path.open("rb") as file:
                os.fsync(file.fileno())
                sizes[path.name] = os.fstat(file.fileno()).st_size
            ends[path.name] = _digest_of_end(path, sizes[path.name])
        return {"frames": self._num_frames, "sizes": sizes, "ends": ends}

    def restore(self, state: dict[str, Any]) -> None:
        """Cut every file back to an earlier `state`.

        Raises
        ------
        ValueError
            If the set of files is another, or a file is shorter than it was, or another one.
        """
        if wrong := self.misfit(state):
            raise ValueError(wrong)
        sizes = state["sizes"]
        if self._frames is not None:
            self._frames.remove_from(state["frames"])
        for path in self.paths:
            os.truncate(path, sizes[path.name])
        self._num_frames = state["frames"]

    def misfit(self, state: dict[str, Any]) -> str | None:
        """Why the files cannot be cut back to an earlier `state`; None if they can."""
        sizes = state["sizes"]
        if {path.name for path in self.paths} != set(sizes):
            return (
                f"the run wrote the files {', '.join(sorted(sizes))}, but now these are asked for: "
                + ", ".join(sorted(path.name for path in self.paths))
            )
        for path in self.paths:
            length = path.stat().st_size if path.exists() else 0
            if length < sizes[path.name]:
                return f"{path} had {sizes[path.name]} bytes at the checkpoint and has {length} now"
        # Checkpoints of earlier versions have none.
        for name, digest in state.get("ends", {}).items():
            if _digest_of_end(self._folder / name, sizes[name]) != digest:
                return f"{self._folder / name} is not the file that the checkpoint was saved beside"
        return None if self._frames is None else self._frames.misfit(state["frames"])

    def _xyz(self, frame: Frame, values: Array) -> bytes:
        """A frame in the XYZ format, with VCM's comment line; coordinates in nm."""
        lines = [
            str(len(self._names)),
            f"timePs {frame.time:.10g} potential_energy_inKJpermol {frame.potential:.16g} "
            f"energy_inKJpermol {frame.potential + frame.kinetic:.16g}",
        ]
        rows = np.asarray(values).reshape(len(self._names), -1).tolist()
        lines += [
            f"{name} " + " ".join(f"{value:.9g}" for value in row)
            for name, row in zip(self._names, rows, strict=True)
        ]
        return ("\n".join(lines) + "\n").encode()

    def _pdb(self, frame: Frame) -> bytes:
        """A model of a PDB file, in nm: a vesicle of a micrometre in Å is too wide for a column."""
        if np.abs(frame.positions).max() >= 9999:
            warnings.warn("PDB: coordinates beyond 9999 nm do not fit their columns", stacklevel=2)
        lines = [
            f"MODEL {frame.step:>9d}",
            f"REMARK 250 COORDINATES IN NANOMETRES, TIME {frame.time:.10g} PS",
        ]
        rows = zip(self._names, frame.positions.tolist(), strict=True)
        for number, (name, (x, y, z)) in enumerate(rows, start=1):
            lines.append(
                f"ATOM  {number % 100000:5d} {name[:4]:<4s} MEM {name[-1]}{number % 10000:4d}    "
                f"{x:8.3f}{y:8.3f}{z:8.3f}{1:6.2f}{0:6.2f}"
            )
        return ("\n".join([*lines, "ENDMDL"]) + "\n").encode()

    def _xtc(self, frame: Frame) -> bytes:
        """A frame of an XTC file.

        OpenMM says nothing if a file cannot be written. The format has 32 bits for the number of
        the step, which begins anew after 2³¹ − 1; the time goes on.
        """
        values = (
            frame.positions.astype(np.float32),
            frame.box.astype(np.float32),
            np.float32(frame.time),
            np.int32(frame.step % 2**31),
        )
        return in_memory(lambda name: xtc_write_frame(name.encode(), *values))

    def _all_triangles(self, frame: Frame) -> bytes:
        """Those of all membranes by particle, three little-endian integers of 32 bits each."""
        offsets = [membrane.offset for membrane in self._cfg.membranes]
        parts = [t + offset for t, offset in zip(frame.triangles, offsets, strict=True)]
        return np.concatenate(parts).astype("<i4").tobytes()

    def _binary(self, values) -> bytes:
        return np.ascontiguousarray(values, dtype=self._type).tobytes()

    def _parts(self, frame: Frame):
        """Each membrane with the positions of its vertices, its triangles and its box."""
        for membrane, triangles in zip(self._cfg.membranes, frame.triangles, strict=True):
            vertices = frame.positions[membrane.offset : membrane.particles.stop]
            yield membrane, vertices, triangles, None if membrane.mesh.box is None else frame.box

    def _curvatures(self, frame: Frame) -> Array:
        """Mean curvature H = C1 + C2 of every vertex, 1/nm."""
        parts = self._parts(frame)
        return np.concatenate(
            [mean_curvature(vertices, corners, box=box) for _, vertices, corners, box in parts]
        )

    def _csv(self, frame: Frame) -> bytes:
        columns: dict[str, float] = {"step": frame.step, "time (ps)": frame.time}
        columns.update({f"{name} (kJ/mol)": energy for name, energy in frame.terms.items()})
        columns["potential (kJ/mol)"] = frame.potential
        columns["kinetic (kJ/mol)"] = frame.kinetic
        for membrane, vertices, triangles, box in self._parts(frame):
            if box is None and membrane.mesh.is_closed:
                area = geometry.surface_area(vertices[triangles])
                volume = geometry.volume_enclosed(vertices, triangles)
            else:
                area, volume, *_ = shape(vertices, triangles, box=box)
            columns[f"area {membrane.label} (nm^2)"] = area
            if not np.isnan(volume):
                columns[f"volume {membrane.label} (nm^3)"] = volume
        line = ",".join(f"{value:.12g}" for value in columns.values()) + "\n"
        header = ",".join(columns) + "\n" if self._num_frames == 0 else ""
        return (header + line).encode()
