"""Which of OpenMM's platforms a System is simulated on where nobody names one.

There is one rule, and `choose` is it. All commands and functions of this package that simulate
follow it; ``docs/platforms.md`` has the measurements behind it. The part of it that is about
membranes alone is also what ``openmm.Context(system, integrator)`` does. `evaluators` says what
computes the membranes on a platform.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
from typing import NamedTuple

import numpy as np
import openmm

from . import _core, backend
from ._proxies import why_not_helfrich
from .forces import MembraneForce

__all__ = [
    "LEAST_FOR_GPU",
    "ON_DEVICES",
    "Choice",
    "choose",
    "evaluators",
    "find",
    "membranes_of",
    "names",
]

#: From this number of particles on, costly forces are worth the way to a GPU and back: on CPU their
#: step takes milliseconds then, beside which some hundred microseconds for the way are little.
LEAST_FOR_GPU = 10_000

_ENVIRONMENT = "OPENMM_DEFAULT_PLATFORM"

#: The platforms that can evaluate membranes themselves, the fastest first.
ON_DEVICES = ("CUDA", "HIP", "OpenCL")

#: What these platforms compute on their device, and wgpu does not.
_OF_BORDERS = ("EdgeTensionForce", "GaussianCurvatureForce")


class Choice(NamedTuple):
    """A platform or a backend, and why it was chosen.

    name: as OpenMM or `set_backend` calls it; reason: half a sentence for people.
    """

    name: str
    reason: str


def names() -> list[str]:
    """The platforms of this OpenMM, each once.

    OpenMM's own list has ``Helfrich`` twice, which is how it can choose it unasked.
    """
    count = openmm.Platform.getNumPlatforms()
    return list(dict.fromkeys(openmm.Platform.getPlatform(i).getName() for i in range(count)))


def find(name: str) -> str:
    """The platform of that name as OpenMM spells it, whatever the case.

    Raises
    ------
    ValueError
        If there is none; the message lists those that there are.
    """
    present = {platform.lower(): platform for platform in names()}
    if name.lower() not in present:
        raise ValueError(f"no platform {name!r}; this OpenMM has {', '.join(present.values())}")
    return present[name.lower()]


def choose(system: openmm.System, integrator: openmm.Integrator, *, double: bool = False) -> Choice:
    """The fastest platform for a System, by what is in it.

    - What the environment variable ``OPENMM_DEFAULT_PLATFORM`` names, as OpenMM does.
    - For membranes under the backend ``"native"`` CUDA, HIP or OpenCL, on a processor too.
    - ``Helfrich`` if membranes, or terms that no platform computes faster, are most of the work.
    - Else, for pairs of particles and the like, CUDA, HIP, or OpenCL on a real GPU, from 10 000
      particles on.
    - Else ``CPU``, which has neighbour lists, and not OpenCL on a processor (PoCL).

    Parameters
    ----------
    system : openmm.System
    integrator : openmm.Integrator
        Not used up: it may belong to no Context yet, or to one.
    double : bool
        Whether all forces must be in double precision: ``Helfrich`` then, whatever the System.

    Returns
    -------
    Choice
    """
    wanted = os.environ.get(_ENVIRONMENT)
    if wanted is not None:
        return Choice(find(wanted), f"the environment variable {_ENVIRONMENT} names it")
    if not double and any(_backend_of(force) == "native" for force in membranes_of(system)):
        device = _gpu_platform() or ("OpenCL" if "OpenCL" in names() else None)
        if device is not None:
            return Choice(device, 'the backend "native" is for platforms of GPUs')
    costly = why_not_helfrich(system, integrator)
    if not costly:
        return Choice("Helfrich", "nothing costs more than the membranes")
    if double:
        return Choice("Helfrich", f"it computes all forces in double precision, though {costly}")
    gpu = _gpu_platform()
    if gpu is not None and system.getNumParticles() >= LEAST_FOR_GPU:
        return Choice(gpu, f"{costly}, and there is a GPU")
    if "CPU" in names():
        return Choice("CPU", f"{costly}, and CPU has neighbour lists and threads")
    return Choice("Helfrich", f"{costly}, but there is no platform CPU")


def evaluators(system: openmm.System, platform: str) -> dict[Choice, list[str]]:
    """What would compute the membranes of a System on a platform.

    Parameters
    ----------
    system : openmm.System
    platform : str
        Its name, as OpenMM spells it.

    Returns
    -------
    dict
        The classes of the forces that each backend computes, by the backend with the reason:
        ``"native"``, the platform itself; ``"cpu"``; ``"gpu"``; ``"auto"``, the faster of these
        two; ``"none"`` where a Context is an error.
    """
    found: dict[Choice, list[str]] = {}
    for force in membranes_of(system):
        found.setdefault(_evaluator(force, platform), []).append(type(force).__name__)
    return found


def _evaluator(force: MembraneForce, platform: str) -> Choice:
    """The rule of `SharedMembrane::startNative` and of the core's backends, in words."""
    kind = _backend_of(force)
    chosen = f'the backend "{kind}" is chosen'
    on_device = platform in ON_DEVICES
    elsewhere = f"{platform} is none of {', '.join(ON_DEVICES)}"
    if kind == "cpu":
        return Choice("cpu", chosen)
    if kind == "native" and not on_device:
        return Choice("none", f"{chosen}, but {elsewhere}")
    if not _can_leave_processor(force, False):
        return Choice("cpu", "contacts are for the processor")
    if _is_of_borders(force) and (kind == "gpu" or not on_device):
        return Choice("cpu", "borders are for the processor")
    if kind == "gpu":
        spanning = "; what spans the box is for the processor"
        return Choice("gpu", chosen + spanning * force.usesPeriodicBoundaryConditions())
    if not on_device:
        return Choice("auto" if _is_for_gpu(force) else "cpu", elsewhere)
    if kind == "auto" and platform == "OpenCL" and not _count_opencl_gpus():
        return Choice("cpu", "the device of OpenCL is the processor, which is faster without it")
    if not _can_leave_processor(force, force.usesPeriodicBoundaryConditions()):
        return Choice("cpu", "volumes in a periodic box are for the processor")
    return Choice("native", chosen if kind == "native" else f"{platform} has a GPU")


def membranes_of(system: openmm.System) -> list[MembraneForce]:
    """The forces on membranes of a System, as their own classes."""
    classes = MembraneForce.__subclasses__()
    forces = system.getForces()
    return [cls.cast(force) for force in forces for cls in classes if cls.isinstance(force)]


def _is_of_borders(force: MembraneForce) -> bool:
    """Whether it acts on borders only; a modulus by vertex acts on all triangles."""
    if type(force).__name__ not in _OF_BORDERS:
        return False
    names = map(force.getParameterName, range(force.getNumParameters()))
    return not any(force.getElementValues(name) for name in names)


def _backend_of(force: MembraneForce) -> str:
    """What is to compute a force, without a precision or an adapter."""
    return (force.getBackend() or backend.get_backend()).partition("@")[0].partition(":")[0]


def _can_leave_processor(force: MembraneForce, is_periodic: bool) -> bool:
    """Whether OpenMM's GPU platforms have its potential, in a periodic box or without."""
    number = ctypes.c_int()
    library = _core.library()
    library.Helfrich_Potential_find(type(force).__name__.encode(), ctypes.byref(number))
    return bool(library.Helfrich_Native_canEvaluate(number, int(is_periodic)))


def _is_for_gpu(force: MembraneForce) -> bool:
    """Whether ``"auto"`` looks for a GPU for its mesh, and finds one."""
    corners = np.frombuffer(force._triangleBuffer(), dtype=np.intc)
    is_large = len(np.unique(corners)) >= backend.LEAST_VERTICES
    return is_large and any(adapter.kind != "software" for adapter in backend.adapters())


@functools.cache
def _gpu_platform() -> str | None:
    """OpenMM's fastest platform that has a real GPU, or None."""
    present = names()
    for name in ("CUDA", "HIP"):
        if name in present:
            try:
                if openmm.Platform.getPlatformByName(name).getDevices():
                    return name
            except openmm.OpenMMException:
                pass  # Its libraries are there, and the driver is not.
    return "OpenCL" if "OpenCL" in present and _count_opencl_gpus() else None


def _count_opencl_gpus() -> int:
    """The devices of OpenCL that call themselves GPUs; processors, as PoCL has them, do not.

    OpenMM tells only the names of its devices, which say nothing of their kind.
    """
    path = ctypes.util.find_library("OpenCL")
    if path is None:
        return 0
    library = ctypes.CDLL(path)
    gpu = ctypes.c_uint64(1 << 2)  # CL_DEVICE_TYPE_GPU
    count = ctypes.c_uint32(0)
    if library.clGetPlatformIDs(0, None, ctypes.byref(count)) != 0 or count.value == 0:
        return 0
    drivers = (ctypes.c_void_p * count.value)()
    library.clGetPlatformIDs(count, drivers, None)
    found = 0
    for driver in drivers:
        devices = ctypes.c_uint32(0)
        arguments = (ctypes.c_void_p(driver), gpu, 0, None, ctypes.byref(devices))
        # A driver without a GPU says that it has found none, which is an error.
        if library.clGetDeviceIDs(*arguments) == 0:
            found += devices.value
    return found
