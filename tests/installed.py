"""What must hold in an environment into which nothing but the package was installed.

`make test` runs this after `pip install .` there and `make wheel` after installing the wheel, so it
needs no test framework.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich


def main():
    package = Path(helfrich.__file__).parent
    # The package must be the installed one, not a source tree that happens to be near.
    assert package.is_relative_to(sys.prefix), f"{package} is not in {sys.prefix}"

    (library,) = (package / "lib").iterdir()
    assert library.name == "libOpenMMHelfrich.so"
    assert (package / "include" / "OpenMMHelfrich.h").exists()
    assert (package / "include" / "openmm-helfrich" / "BendingForce.h").exists()
    assert (package / "py.typed").exists()
    # The page of a mesh has all the files of the viewer in it.
    assert "class Viewer" in helfrich.view(helfrich.Mesh.icosphere(1, 1.0))._repr_html_()

    (extension,) = package.glob("_forces*.so")
    for binary in (library, extension):
        check_alone(binary)
        check_rpath(binary)

    simulate()
    check_xml()
    print(f"openmmhelfrich {helfrich.__version__} installs and runs on Python "
          f"{sys.version_info.major}.{sys.version_info.minor}, numpy {np.__version__}, "
          f"OpenMM {openmm.Platform.getOpenMMVersion()}")  # fmt: skip


def check_alone(binary):
    """It finds OpenMM's libraries where nothing else has loaded them, as in a C++ program."""
    script = "import ctypes, sys; ctypes.CDLL(sys.argv[1])"
    subprocess.run([sys.executable, "-c", script, binary], check=True)


def check_rpath(binary):
    """The place where it was built is gone; only folders beside the package may be searched."""
    if shutil.which("readelf") is None:
        return
    text = subprocess.run(["readelf", "-d", binary], capture_output=True, text=True, check=True)
    (folders,) = re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", text.stdout)
    assert all(folder.startswith("$ORIGIN/") for folder in folders.split(":")), folders


def simulate():
    """Ten steps of a small vesicle hold together."""
    mesh = helfrich.Mesh.icosphere(3, radius=300)
    simulation = helfrich.Vesicle(mesh).simulation(
        openmm.LangevinMiddleIntegrator(300, 0.01, 0.2), "Reference"
    )
    simulation.step(10)
    positions = simulation.context.getState(getPositions=True).getPositions(asNumpy=True)._value
    moved = np.abs(positions - mesh.vertices).max()
    assert 0 < moved < 30, f"vertices moved by {moved} nm"


def check_xml():
    """Forces survive XML, which they do only where OpenMM knows the plugin."""
    force = helfrich.BendingForce(helfrich.Mesh.icosphere(1, 1.0), rigidity=50)
    copy = openmm.XmlSerializer.deserialize(openmm.XmlSerializer.serialize(force))
    assert helfrich.BendingForce.cast(copy).getRigidity() == 50


if __name__ == "__main__":
    main()
