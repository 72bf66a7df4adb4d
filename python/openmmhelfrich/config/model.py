"""A configuration as it was read: vesicles, and the OpenMM objects made of them."""

from __future__ import annotations

import re
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import openmm
from openmm import unit

from .. import platforms, vcm
from .._placement import NUM_GROUPS
from .._types import Array, File
from ..blowup import Limits
from ..errors import MeshError
from ..forces import MonteCarloMembraneTension, SurfaceRepulsionForce
from ..mesh import Mesh
from ..simulation.model import Membrane, Model, too_many_steps
from ..vcm.grammar import GENERAL, MEMBRANE, ConfigError, nearest
from ..vcm.parsers import Interval
from ..vcm.settings import Settings
from ..vesicle import Vesicle
from .checks import check_box, check_reach, check_tension
from .document import Document
from .keys import keys_of
from .meshes import start_mesh
from .tables import Table

__all__ = ["Configuration", "VesicleMembrane", "read", "read_any"]

_TABLES = ("simulation", "integrator", "output", "box", "vesicle", "tension", "repulsion", "watch")
_MAX_SEED = 2**31 - 1
# kJ/mol/nm. OpenMM's default, 10, is for atoms: forces in a membrane are below that from the start.
_MINIMISE_TOLERANCE = 0.01


@dataclass(frozen=True)
class VesicleMembrane(Membrane):
    """One vesicle of a configuration: a `Membrane`, and the `Vesicle` that it is."""

    vesicle: Vesicle


class Configuration(Model):
    """What a TOML file asks for. `read` makes it; its attributes are those of `Model`."""

    def __init__(self, document: Document, seed: int = 0) -> None:
        self.path = document.path
        for name in document.data:
            if name not in _TABLES:
                hint = nearest(name, _TABLES)
                raise document.error((name,), f"there is no such table; {hint}")
        simulation = Table(document, ("simulation",), "simulation")
        integrator = Table(document, ("integrator",), "integrator")
        output = Table(document, ("output",), "output")
        self._step_size = integrator["time_step"]
        if output["interval"] < self._step_size:
            raise output.error(
                "interval",
                f"{output['interval']:g} ps is less than the time step of {self._step_size:g} ps",
            )
        self.general = _general(simulation, integrator, output, self.path.stem)
        self.file_seed = simulation["seed"] or 0
        self.seed = seed or self.file_seed or secrets.randbelow(_MAX_SEED) + 1
        self.platform = _platform(simulation)
        if output.given("ply") and output.given("frames"):
            raise output.error("ply", "give either frames or ply, not both")
        frames = "ply" if output["ply"] else output["frames"]
        self.writes = {"xtc": output["xtc"], "frames": frames}
        watch = Table(document, ("watch",), "watch")
        self.limits = Limits(*(watch[name] for name in keys_of("watch")))
        self.box, self.membranes = _vesicles(document, self.kT)
        if self.box is not None:
            # Outputs have a box then.
            self.general["SimulationBoxLength"] = float(self.box[0, 0])
        if integrator["kind"] == "Brownian" and integrator["friction"] == 0:
            raise integrator.error("friction", "Brownian dynamics need more than 0")
        viscous = any(membrane.vesicle.viscosity is not None for membrane in self.membranes)
        if viscous and integrator["kind"] == "Brownian":
            raise integrator.error(
                "kind", "Brownian dynamics have no velocities for a viscosity to act on"
            )
        self._tension = None
        if "tension" in document.data:
            self._tension = Table(document, ("tension",), "tension")
            check_tension(self._tension, self.box, self.membranes)
        self._repulsion = None
        if "repulsion" in document.data:
            self._repulsion = Table(document, ("repulsion",), "repulsion", self.kT)
            if len(self.membranes) == 1 and not self._repulsion["within"]:
                raise self._repulsion.error(
                    None,
                    "it acts between vesicles, and there is one only; within = true lets it act "
                    "within a vesicle, too",
                )
            if self._repulsion["within"]:
                check_reach(self._repulsion, self.membranes)
        # The potentials of each vesicle, by Vesicle's names.
        self._kinds = [list(membrane.vesicle._forces(0)) for membrane in self.membranes]
        self._terms: dict[str, int] = {}
        # What cannot be built shall be refused when the file is read.
        try:
            self.system()
        except openmm.OpenMMException as reason:
            raise ConfigError(f"{self.path}:1: the System cannot be built: {reason}") from None

    @property
    def flows(self) -> bool:
        """Whether bonds flip in any vesicle."""
        return any(membrane.vesicle.flips is not None for membrane in self.membranes)

    @property
    def step_size(self) -> float:
        """Time step, ps."""
        return self._step_size

    @property
    def terms(self) -> dict[str, int]:
        """The potentials of the System by name, with the force group of each."""
        return dict(self._terms)

    def system(self) -> openmm.System:
        """A new System: vertex i of a vesicle is particle `offset` + i.

        Every potential is one force with a name, see `terms`. Each has its own force group as long
        as these last; with more potentials, those of one kind share one.
        """
        result = openmm.System()
        kinds = list(dict.fromkeys(kind for names in self._kinds for kind in names))
        # One more is for a repulsion, and the last is left to what a user adds.
        apart = sum(map(len, self._kinds)) + 1 < NUM_GROUPS
        self._terms, used = {}, 0
        for membrane, names in zip(self.membranes, self._kinds, strict=True):
            groups = [used + i if apart else kinds.index(kind) for i, kind in enumerate(names)]
            used += len(names)
            placement = membrane.vesicle.add_to(result, groups)
            mover = placement.flips
            if mover is not None:
                mover.setRandomNumberSeed(self.seed)
                if "temperature" not in membrane.vesicle.flips:
                    mover.setDefaultTemperature(self.temperature)
            thermostat = placement.viscosity
            if thermostat is not None:
                thermostat.setRandomNumberSeed(self.seed)
                if "temperature" not in membrane.vesicle.viscosity:
                    thermostat.setDefaultTemperature(self.temperature)
            for kind, group in zip(names, groups, strict=True):
                alone = len(self.membranes) == 1 or not apart
                term = kind if alone else f"{kind} {membrane.label}"
                placement.forces[kind].setName(term)
                self._terms[term] = group
        if self._repulsion is not None:
            force = self._repulsive_force()
            force.setForceGroup(max(self._terms.values()) + 1)
            self._terms[force.getName()] = force.getForceGroup()
            result.addForce(force)
        if self.box is not None:
            result.setDefaultPeriodicBoxVectors(*self.box)
        if self._tension is not None:
            result.addForce(self._mover_of_box())
        return result

    def topology(self) -> openmm.app.Topology:
        """A chain per vesicle, an atom per vertex, a bond per edge, and the periodic box."""
        result = super().topology()
        if self.box is not None:
            result.setPeriodicBoxVectors(self.box * unit.nanometer)
        return result

    def _mover_of_box(self) -> openmm.Force:
        given = self._tension
        force = MonteCarloMembraneTension(
            self.temperature,
            given["tension"],
            given["frequency"],
            MonteCarloMembraneTension.XYIsotropic if given["axes"] is None else given["axes"],
            given["pulling_force"],
        )
        force.setRandomNumberSeed(self.seed)
        force.setName("tension")
        return force

    def _repulsive_force(self) -> openmm.Force:
        """A SurfaceRepulsionForce on the triangles of all vesicles."""
        offsets = (membrane.particles[0] for membrane in self.membranes)
        triangles = [
            membrane.vesicle.mesh.triangles + offset
            for membrane, offset in zip(self.membranes, offsets, strict=True)
        ]
        repulsion = self._repulsion
        force = SurfaceRepulsionForce(
            np.vstack(triangles), repulsion["distance"], repulsion["strength"]
        )
        force.setOnlyBetweenParts(not repulsion["within"])
        force.setName("repulsion")
        force.setUsesPeriodicBoundaryConditions(self.box is not None)
        return force


def read(path: File, *, seed: int = 0) -> Configuration:
    """Read a configuration in TOML; ``docs/config.md`` describes it.

    Parameters
    ----------
    path : str or Path
        The file. Meshes are looked for beside it.
    seed : int
        In place of the file's, if not 0.

    Returns
    -------
    Configuration

    Raises
    ------
    FileNotFoundError
        If the file is not there.
    ConfigError
        If it is not TOML, has an unknown key or a bad value, lacks a key that is needed, or names a
        mesh that cannot be used. The message has file, line and key.
    """
    if not 0 <= seed <= _MAX_SEED:
        raise ValueError(f"read: seed must be 0 to {_MAX_SEED}, got {seed}")
    return Configuration(Document(path), seed)


def read_any(
    path: File,
    vcm_compatible: bool = False,
    *,
    ignore_unknown: bool = False,
    seed: int = 0,
    flips: float = 0.0,
) -> Any:
    """Read a configuration of either kind: TOML if the name ends in ``.toml``, or else VCM's.

    Arguments and errors are those of `vcm.read`; options that only VCM's have are refused with
    TOML.
    """
    if Path(path).suffix.lower() != ".toml":
        return vcm.read(path, vcm_compatible, ignore_unknown=ignore_unknown, seed=seed, flips=flips)
    if flips:
        raise ConfigError(f"{path}:1: write flips = {flips:g} in [[vesicle]], in place of --flips")
    for name, given in (("vcm_compatible", vcm_compatible), ("ignore_unknown", ignore_unknown)):
        if given:
            raise ConfigError(f"{path}:1: {name} is for VCM's configurations, and this is TOML")
    return read(path, seed=seed)


def _general(simulation: Table, integrator: Table, output: Table, stem: str) -> dict[str, Any]:
    """The settings that runs and outputs look at, by VCM's names and in VCM's units."""
    name = simulation["name"] or stem
    if not re.fullmatch(r"[^/\\\0]+", name) or name in (".", ".."):
        raise simulation.error("name", f"expected a name for files, got {name!r}")
    if 0 < simulation["duration"] < integrator["time_step"]:
        raise simulation.error(
            "duration",
            f"{simulation['duration']:g} ps is less than the time step of "
            f"{integrator['time_step']:g} ps",
        )
    if wrong := too_many_steps(simulation["duration"], integrator["time_step"]):
        raise simulation.error("duration", wrong)
    return {
        **Settings(None, GENERAL),
        "ProjectName": name,
        "SimulationTimeInPs": simulation["duration"],
        "StepSizeInFs": 1000 * integrator["time_step"],
        "Integrator": integrator["kind"],
        "FrictionIninvertPs": integrator["friction"],
        "TemperatureinKelvin": integrator["temperature"],
        "setVelocitiesToTemperature": simulation["thermal_velocities"],
        "Minimise": simulation["minimise"],
        "MinimiseTolerance": _MINIMISE_TOLERANCE,
        "ReportIntervalInFs": Interval(fs=1000 * output["interval"]),
        "TextOutputs": output["text"],
        "BinOutputs": (),
    }


def _platform(simulation: Table) -> str | None:
    """The platform that the file names, as OpenMM calls it."""
    wanted = simulation["platform"]
    if wanted is None:
        return None
    try:
        return platforms.find(wanted)
    except ValueError as reason:
        raise simulation.error("platform", str(reason)) from None


def _vesicles(document: Document, kT: float) -> tuple[Array | None, tuple[VesicleMembrane, ...]]:
    """The box, and all vesicles in the order of the file, which is that of their particles."""
    given = document.data.get("vesicle")
    if not isinstance(given, list) or not given:
        raise document.error(("vesicle",), "a configuration needs one or more [[vesicle]] tables")
    tables, meshes = [], []
    for number in range(len(given)):
        place = ("vesicle", number)
        table = Table(document, place, "vesicle", kT, tables=("mesh",))
        if not table.given("mesh"):
            raise table.error("mesh", "a vesicle needs a mesh; add [vesicle.mesh]")
        of_mesh = Table(document, (*place, "mesh"), "vesicle.mesh", kT)
        tables.append((table, of_mesh))
        meshes.append(start_mesh(of_mesh, document.path.parent))
    box = _box_of(document, tables, meshes)
    found: list[VesicleMembrane] = []
    for number, ((table, of_mesh), start) in enumerate(zip(tables, meshes, strict=True)):
        try:
            mesh = start if box is None else Mesh(start.vertices, start.triangles, box)
        except MeshError as reason:
            raise of_mesh.error(None, str(reason)) from None
        label = table["name"] or str(number)
        if re.search(r"[\s/\\,]", label):
            raise table.error("name", f"expected a word without spaces or slashes, got {label!r}")
        if label in [other.label for other in found]:
            raise table.error("name", f"another vesicle is called {label!r}; names tell them apart")
        offset = found[-1].particles.stop if found else 0
        settings = Settings(None, MEMBRANE)
        found.append(VesicleMembrane(label, settings, mesh, offset, 0, _vesicle(table, mesh)))
    return box, tuple(found)


def _box_of(document: Document, tables: list[Any], meshes: list[Mesh]) -> Array | None:
    """The box of the file, or else that of the meshes, which must agree."""
    if "box" in document.data:
        table = Table(document, ("box",), "box")
        check_box(table, meshes)
        return table["vectors"]
    box = None
    for (_, table), mesh in zip(tables, meshes, strict=True):
        if mesh.box is not None:
            if box is not None and not np.array_equal(box, mesh.box):
                raise table.error(
                    None, "its box is not that of the mesh before; say which it is in [box]"
                )
            box = mesh.box
    return box


def _vesicle(table: Table, mesh) -> Vesicle:
    names = [name for name in keys_of("vesicle") if name != "name"]
    if table.given("volume") and table.given("reduced_volume"):
        raise table.error("reduced_volume", "give either volume or reduced_volume, not both")
    given = {name: table[name] for name in names if table[name] is not None}
    try:
        return Vesicle(mesh, **given)
    except (TypeError, ValueError, openmm.OpenMMException) as reason:
        raise table.error(None, str(reason)) from None
