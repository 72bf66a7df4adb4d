"""Steps of jax-md, measured in processes of their own by the Python that has it."""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

__all__ = ["FORMS", "jax_device", "jax_versions", "measure"]

# The ways to write the energy in `jax_worker.py`.
FORMS = ("edges", "rings")

_WORKER = Path(__file__).with_name("jax_worker.py")
_ASK = (
    "import json; from importlib.metadata import version; import jax, jax_md;"
    "print(json.dumps({name: version(name) for name in ('jax', 'jaxlib', 'jax-md')}))"
)


def jax_versions(python):
    """Versions of jax and jax-md as that Python has them, or None."""
    try:
        asked = subprocess.run([python, "-c", _ASK], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return json.loads(asked.stdout.splitlines()[-1])


def jax_device(python):
    """The kind and the name of the device that jax takes there, such as "gpu", "NVIDIA H100"."""
    ask = "import jax; device = jax.devices()[0]; print(device.platform, device.device_kind)"
    asked = subprocess.run([python, "-c", ask], capture_output=True, text=True, check=True)
    kind, _, name = asked.stdout.splitlines()[-1].partition(" ")
    return kind, name


def measure(vesicle, python, form, repeats, seconds, precision="double"):
    """Least microseconds of a Verlet step, and the energy at the start, kJ/mol.

    Parameters
    ----------
    vesicle : Vesicle
    python : str
        A Python with jax and jax-md.
    form : str
        One of `FORMS`.
    repeats : int
    seconds : float
        Length of one run.
    precision : str
        "single" or "double".

    Raises
    ------
    RuntimeError
        If the process fails, with the last line of what it said.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "vesicle.npz"
        np.savez(path, **_arrays(vesicle))
        command = [python, str(_WORKER), str(path), "--form", form]
        command += ["--repeats", str(repeats), "--seconds", str(seconds)]
        environment = {
            **os.environ,
            "JAX_ENABLE_X64": str(int(precision == "double")),
            # Others need memory of a GPU, too.
            "XLA_PYTHON_CLIENT_PREALLOCATE": "false",
        }
        said = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if said.returncode != 0:
        lines = said.stderr.strip().splitlines() or [f"exit status {said.returncode}"]
        raise RuntimeError(f"jax-md: {lines[-1]}")
    found = json.loads(said.stdout.splitlines()[-1])
    return found["microseconds"], found["energy"]


def _arrays(vesicle):
    """The mesh in the arrays that both forms need, and the parameters of the energy."""
    mesh = vesicle.mesh
    left = {}
    successor = [{} for _ in range(mesh.num_vertices)]
    for number, (a, b, c) in enumerate(mesh.triangles.tolist()):
        left[a, b] = left[b, c] = left[c, a] = number
        successor[a][b], successor[b][c], successor[c][a] = c, a, b
    edges = [(a, b, left[a, b], left[b, a]) for a, b in mesh.edges.tolist()]
    rings = {}
    for vertex, following in enumerate(successor):
        ring = [min(following)]
        while len(ring) < len(following):
            ring.append(following[ring[-1]])
        rings.setdefault(f"ring_of_{len(ring)}", []).append([vertex, *ring])
    return {
        "vertices": mesh.vertices,
        "triangles": mesh.triangles,
        "edges": np.array(edges),
        **{name: np.array(rows) for name, rows in rings.items()},
        "rigidity": vesicle.rigidity,
        "area_modulus": vesicle.area_modulus,
        "area_target": vesicle.area,
        "volume_modulus": vesicle.volume_modulus,
        "volume_target": vesicle.volume,
        "min_height": vesicle.min_height,
        "epsilon": vesicle.epsilon,
        "mass": vesicle.mass,
    }
