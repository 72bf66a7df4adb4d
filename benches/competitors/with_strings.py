"""The vesicle from OpenMM's Custom forces, by the cheapest x, y, z expressions that we know."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from openmmhelfrich import Vesicle
from openmmhelfrich._benchmark import Steps, Target, empty_system, sphere, start

# The builders are those of the tests, which compare them with the plugin on many meshes.
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "python"))
import string_forces

__all__ = ["check_agreement", "make_a_step", "string_system", "why_no_step"]


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


def why_no_step(parts, target, patience):
    """What keeps a platform from a step with them, which a process of its own tries; or None.

    Parameters
    ----------
    parts : int
        Of the icosahedron's side.
    target : Target
    patience : float
        How long their compilation and the step may take, s.
    """
    command = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r}); "
        "from competitors import with_strings; "
        f"with_strings.make_a_step({parts}, {target.platform!r}, {target.properties!r})"
    )
    try:
        said = subprocess.run(
            [sys.executable, "-c", command],
            capture_output=True, text=True, check=False, timeout=patience,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"no step within {patience:g} s"
    if said.returncode != 0:
        return (said.stderr.strip().splitlines() or [f"exit status {said.returncode}"])[-1]
    return None


def make_a_step(parts, platform, properties):
    """Make one step with them."""
    vesicle = Vesicle(sphere(parts))
    context = start(
        string_system(vesicle), vesicle, "LangevinMiddle", Target("", platform, properties)
    )
    Steps(context)(1)


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
