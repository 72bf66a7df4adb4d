"""Configurations, in TOML and as VCM writes them: whole simulations, or a message with the line."""

from __future__ import annotations

import re
from pathlib import Path

import openmm
from doors import Door, Wrong, attempt, folder, shared_files
from openmmhelfrich import Mesh, config, vcm

_ROOT = Path(__file__).resolve().parents[2]
#: Larger meshes than this are the user's wish, and take time.
_MOST = 400
_LARGE = re.compile(rb"(icosphere|random|sheet|tube|disk)\s*=\s*\[?\s*[\d_]{3,}")
_SMALL = [
    (rb"random *= *\d+", b"random = 42"),
    (rb"icosphere *= *\d+", b"icosphere = 2"),
    (rb"sheet *= *\[[^\]]*\]", b"sheet = [10, 10]"),
]
_TOML = b"""
simulation.duration = 0.4
simulation.platform = "Reference"
integrator = { kind = "Verlet", time_step = 0.02, temperature = 310 }
[box]
vectors = [[500, 0, 0], [0, 500, 0], [0, 0, 500]]
[[vesicle]]
name = "one"
mesh = { file = "mesh.ply", scale = 1.1, rotate = [10, 20, 30], translate = [100, 0, 0] }
rigidity = "20 kT"
flips = { attempts_per_edge = 0.1, min_degree = 3, max_degree = 12 }
viscosity = 1e-3
[[vesicle]]
mesh = { disk = 3, radius = 40 }
volume_modulus = 0
"""


def _read_toml(path: Path) -> config.Configuration | None:
    return attempt(lambda: config.read(path), config_errors, f"{path}:")


config_errors = (vcm.ConfigError,)


def _mesh() -> None:
    path = folder() / "mesh.ply"
    if not path.exists():
        Mesh.icosphere(2, 100.0).write(path)


def _tomls() -> list[bytes]:
    found = [_TOML]
    for name in ("vesicle", "sheet"):
        data = (_ROOT / "examples" / f"{name}.toml").read_bytes()
        for pattern, small in _SMALL:
            data = re.sub(pattern, small, data)
        found.append(data)
    return found


def _check_toml(data: bytes) -> None:
    _mesh()
    if _LARGE.search(data):
        return
    path = folder() / "run.toml"
    path.write_bytes(data)
    cfg = _read_toml(path)
    if cfg is not None:
        _begins(cfg)


def _begins(cfg) -> None:
    """What was read makes a Context that has an energy, or says why not."""
    if cfg.num_particles > 3 * _MOST:
        return
    for name in ("Helfrich", "Reference"):
        context = attempt(
            lambda name=name: openmm.Context(
                cfg.system(), cfg.integrator(), openmm.Platform.getPlatformByName(name)
            ),
            openmm.OpenMMException,
        )
        if context is None:
            continue
        context.setPositions(cfg.positions)
        attempt(lambda context=context: cfg.energies(context), openmm.OpenMMException)
        attempt(lambda context=context: context.getIntegrator().step(2), openmm.OpenMMException)
    if cfg.num_steps < 0 or cfg.step_size <= 0:
        raise Wrong(f"{cfg.num_steps} steps of {cfg.step_size} ps")


_VCM = b"""-GeneralParameters
ProjectName cell
SimulationTimeInPs 4
StepSizeInFs 20
ReportIntervalInFs 400
Integrator LM
FrictionIninvertPs 0.1
TextOutputs PSF XYZ PDB VEL FORCE CURVE
-Membrane 0
MeshFile mesh.ply
NodeMass 50
ULM 0.1 2 0
MeanCurvatureModel Julicher1996
MeanCurvatureCoeff 20
SurfaceConstraint GWCAH 0.3
SurfaceConstraintCoeff 40
VolumeConstraint G
VolumeConstraintCoeff 40
DihedralBendingModel smoothTheta4
DihedralBendingCoeff 10
-Membrane 1 from 0
CoordinateTranslateVector 300 0 0
NUL 3 0.01 6
-InteractionTable
M0 0
M1 LJ 0
"""


def _vcms() -> list[bytes]:
    files = [path.read_bytes() for path in shared_files("vcm/*.txt")]
    mesh = rb"MeshFile mesh.ply"
    return [_VCM, *(re.sub(rb"MeshFile\s+\S+", mesh, data) for data in files)]


def _check_vcm(data: bytes) -> None:
    _mesh()
    path = folder() / "run.txt"
    path.write_bytes(data)
    # Membranes without end are the user's wish.
    if data.count(b"-Membrane") > 4 or re.search(rb"NUL\s+\d{3,}", data):
        return
    cfg = attempt(lambda: vcm.read(path), config_errors, f"{path}:")
    if cfg is not None:
        _begins(cfg)


DOORS = [Door("toml", _tomls, _check_toml), Door("vcm", _vcms, _check_vcm)]
