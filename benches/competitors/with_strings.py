"""The vesicle from OpenMM's Custom forces, by the cheapest x, y, z expressions that we know."""

import sys
from pathlib import Path

import numpy as np
from openmmhelfrich._benchmark import empty_system

# The builders are those of the tests, which compare them with the plugin on many meshes.
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "python"))
import string_forces

__all__ = ["check_agreement", "string_system"]


def string_system(vesicle):
    """The System of a vesicle without the plugin; its cost is O(N)."""
    system = empty_system(vesicle)
    for force in string_forces.fastest(
        vesicle.mesh.triangles,
        rigidity=vesicle.rigidity,
        area_modulus=vesicle.area_modulus,
        area_target=vesicle.area,
        volume_modulus=vesicle.volume_modulus,
        volume_target=vesicle.volume,
        min_height=vesicle.min_height,
        epsilon=vesicle.epsilon,
        style="cartesian",
    ):
        system.addForce(force)
    return system


def check_agreement(ours, theirs, who, tolerance=1e-5):
    """Refuse to race two sides whose energies at the same positions differ.

    Parameters
    ----------
    ours, theirs : float
        kJ/mol.
    who : str
        The other side, for the message.
    tolerance : float
        A share of the energy.
    """
    if not np.isclose(ours, theirs, rtol=tolerance):
        sys.exit(f"steps: {who} has the energy {theirs} kJ/mol, openmm-helfrich {ours}")
