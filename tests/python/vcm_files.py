"""Small configuration files for the tests of the reader, and what they give on Reference."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import openmm as mm
from openmmhelfrich import vcm

SIZE = 42


class Folder:
    """A folder with `mesh.ply`, a lumpy sphere of 42 vertices, and configurations made by tests."""

    def __init__(self, path: Path, mesh):
        self.path = path
        self.mesh = mesh
        mesh.write(path / "mesh.ply")

    def write(self, text: str) -> Path:
        path = self.path / "config.txt"
        path.write_text(text, encoding="utf-8")
        return path

    def text(self, membrane="", general="", table="", more="") -> str:
        """A configuration of one membrane with these lines in its sections."""
        rows = f"-InteractionTable\n{table}\n" if table else ""
        return (
            f"-GeneralParameters\n{general}\n-Membrane 0\nMeshFile mesh.ply\n{membrane}\n"
            f"{more}\n{rows}"
        )

    def read(self, membrane="", general="", table="", more="", **options) -> vcm.Config:
        text = self.text(membrane, general, table, more)
        return vcm.read(self.write(text), **options)

    def refused(self, membrane="", general="", table="", more="") -> str:
        """The message with which such a configuration is refused, without the folder's name."""
        return self.message(self.text(membrane, general, table, more))

    def message(self, text: str) -> str:
        path = self.write(text)
        try:
            vcm.read(path)
        except vcm.ConfigError as error:
            return str(error).replace(str(self.path) + "/", "")
        raise AssertionError(f"was not refused:\n{text}")


def context(cfg: vcm.Config, positions=None) -> mm.Context:
    platform = mm.Platform.getPlatformByName("Reference")
    made = mm.Context(cfg.system(), mm.VerletIntegrator(0.001), platform)
    made.setPositions(cfg.positions if positions is None else positions)
    return made


def energies(cfg: vcm.Config, positions=None) -> dict[str, float]:
    """Energy by term at these positions, the start if None, kJ/mol."""
    return cfg.energies(context(cfg, positions))


def forces(cfg: vcm.Config, positions=None) -> np.ndarray:
    """Shape (num_particles, 3), kJ/mol/nm."""
    state = context(cfg, positions).getState(getForces=True)
    return state.getForces(asNumpy=True)._value


def line_of(path_or_text, word: str) -> int:
    """The number of the first line that starts with a word."""
    lines = str(path_or_text).splitlines()
    return next(number for number, line in enumerate(lines, 1) if line.startswith(word))
