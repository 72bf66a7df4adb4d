"""A configuration as it was read: settings, start meshes, and the OpenMM objects made of them."""

from __future__ import annotations

import secrets
from functools import cached_property
from pathlib import Path

import numpy as np
import openmm
from scipy.spatial.transform import Rotation

from .._mesh import files
from .._types import Array, File
from ..analysis import theory
from ..errors import MeshError
from ..mesh import Mesh
from ..simulation.model import Membrane, Model, too_many_steps
from . import build, interactions
from .grammar import GENERAL, MEMBRANE, TABLE, Section, read_sections
from .settings import Settings

__all__ = ["Config", "Membrane", "read"]

# VCM's value of the gas constant, kJ/mol/K, from before the SI of 2019.
_VCM_BOLTZMANN = 0.008314459920816468
# What MonteCarloBondFlip takes, over the steps between two rounds.
_MAX_FLIPS = 100
# The largest seed that OpenMM's generators take.
_MAX_SEED = 2**31 - 1


class Config(Model):
    """What a VCM configuration file asks for. `read` makes it.

    Attributes
    ----------
    vcm_compatible : bool
        Whether VCM's quirks are followed that change numbers.
    table : list of list of str
        The interaction of each pair of membranes, lower triangular.
    flips : float
        Attempts to flip a bond for each edge and time step; 0 for none.

    and those of `Model`.
    """

    def __init__(
        self,
        path: File,
        sections: list[Section],
        compatible: bool,
        ignore: bool,
        seed: int,
        flips: float = 0.0,
    ) -> None:
        self.path = Path(path)
        self.flips = flips
        self.vcm_compatible = compatible
        found = [section for section in sections if section.kind == GENERAL]
        self.general = Settings(found[0] if found else None, GENERAL, ignore)
        if wrong := too_many_steps(self.general["SimulationTimeInPs"], self.step_size):
            raise self.general.error("SimulationTimeInPs", wrong)
        if self.general["Integrator"] == "Brownian" and self.general["FrictionIninvertPs"] == 0:
            reason = "Brownian dynamics need more than 0"
            raise self.general.error("FrictionIninvertPs", reason)
        self.file_seed = self.general["Seed"]
        self.seed = seed or self.file_seed or secrets.randbelow(_MAX_SEED) + 1
        random = np.random.default_rng(self.seed)
        membranes: list[Membrane] = []
        for section in sections:
            if section.kind == MEMBRANE:
                offset = membranes[-1].particles.stop if membranes else 0
                settings = Settings(section, MEMBRANE, ignore)
                mesh, num_reversed = _start_mesh(settings, self.path.parent, random)
                membranes.append(Membrane(section.label, settings, mesh, offset, num_reversed))
        self.membranes = tuple(membranes)
        tables = [section for section in sections if section.kind == TABLE]
        self.table = interactions.read_table(tables[0] if tables else None, len(membranes))
        # What cannot be built shall be refused when the file is read, with its line.
        self._plan = build.plan(self)
        if flips:
            self.system()

    @property
    def kT(self) -> float:
        """The thermal energy kB T, kJ/mol, with VCM's kB if it is to be followed."""
        return (_VCM_BOLTZMANN if self.vcm_compatible else theory.BOLTZMANN) * self.temperature

    @cached_property
    def velocity_shifts(self) -> Array:
        """VelocityShiftVector of every particle, shape (num_particles, 3), nm/ps; 0 if frozen."""
        rows = []
        for membrane in self.membranes:
            shift = membrane.settings["VelocityShiftVector"]
            moving = not membrane.settings["FreezeSubLattice"]
            rows.append(np.tile(shift * moving, (membrane.mesh.num_vertices, 1)))
        return np.concatenate(rows)

    @property
    def flows(self) -> bool:
        """Whether bonds flip in any membrane."""
        return self.flips > 0

    @property
    def terms(self) -> dict[str, int]:
        """The potentials of the System by name, with the force group of each."""
        return {term.name: term.group for term in self._plan}

    def system(self) -> openmm.System:
        """A new System: vertex i of a membrane is particle `offset` + i.

        Every potential is one force with a name and a force group, see `terms`.
        """
        return build.system(self, self._plan)


def read(
    path: File,
    vcm_compatible: bool = False,
    *,
    ignore_unknown: bool = False,
    seed: int = 0,
    flips: float = 0.0,
) -> Config:
    """Read a configuration file of the Virtual Cell Model.

    Parameters
    ----------
    path : str or Path
        The file. Meshes are looked for beside it.
    vcm_compatible : bool
        Follow those of VCM's quirks that change numbers, to compare with old results; by default
        the file is taken at its word. ``docs/vcm.md`` lists them.
    ignore_unknown : bool
        Skip keys that do not exist, instead of refusing them.
    seed : int
        In place of the file's, if not 0.
    flips : float
        Make all membranes fluid, which VCM's are not: attempts to flip a bond for each edge and
        time step, see `MonteCarloBondFlip`. Default: none.

    Returns
    -------
    Config

    Raises
    ------
    FileNotFoundError
        If the file is not there.
    ConfigError
        If the file breaks the grammar, has an unknown key or a bad value, asks for a potential that
        is not done here, or names a mesh that cannot be read. The message has file, line and key.
    """
    if not 0 <= seed <= _MAX_SEED:
        raise ValueError(f"read: seed must be 0 to {_MAX_SEED}, got {seed}")
    if not 0 <= flips <= _MAX_FLIPS:
        raise ValueError(f"read: flips must be 0 to {_MAX_FLIPS} per edge and step, got {flips}")
    return Config(path, read_sections(path), bool(vcm_compatible), ignore_unknown, seed, flips)


def _start_mesh(settings: Settings, folder: Path, random) -> tuple[Mesh, int]:
    """The mesh of a membrane as it starts, and how many triangles had to be turned."""
    if not settings.given("MeshFile"):
        raise settings.error("MeshFile", "a membrane needs a mesh")
    path = folder / settings["MeshFile"]
    if path.suffix.lower() not in (".ply", ".msh", ".obj"):
        raise settings.error("MeshFile", f"expected a .ply, .msh or .obj file, got {path.name!r}")
    try:
        vertices, triangles, box = files.read(path)
        if box is not None:
            raise MeshError(
                f"{path.name} has a periodic box, which a membrane of VCM cannot have; write "
                "Mesh(*mesh.unfolded()), whose triangles are whole, or take a TOML file, where "
                "surfaces may span their box"
            )
        mesh = Mesh(vertices, triangles)
        num_reversed = _reversals(triangles, mesh.triangles)
        mesh = mesh.scaled(settings["Scale"]).scaled(settings["XYZscale"])
    except (FileNotFoundError, MeshError) as reason:
        raise settings.error("MeshFile", str(reason)) from None
    key = "ULM"
    try:
        amplitude, l, m = settings["ULM"]
        if amplitude:
            mesh = mesh.deformed(l, m, amplitude)
        key = "NUL"
        count, amplitude, lmax = settings["NUL"]
        for _ in range(count if amplitude else 0):
            l = int(random.integers(2, lmax + 1))
            mesh = mesh.deformed(l, int(random.integers(-l, l + 1)), amplitude)
        if settings["InitRandomRotation"]:
            mesh = mesh.rotated(Rotation.random(random_state=random))
        key = "CoordinateTranslateVector"
        mesh = mesh.translated(settings[key])
    except MeshError as reason:
        raise settings.error(key, str(reason)) from None
    return mesh, num_reversed


def _reversals(before: Array, after: Array) -> int:
    """How many triangles run the other way round."""
    same = np.zeros(len(after), dtype=bool)
    for shift in range(3):
        same |= (np.roll(before, shift, axis=1) == after).all(axis=1)
    return int((~same).sum())
