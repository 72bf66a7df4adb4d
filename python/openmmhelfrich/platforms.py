"""Which of OpenMM's platforms a System is simulated on where nobody names one.

There is one rule, and `choose` is it. All commands and functions of this package that simulate
follow it; ``docs/platforms.md`` has the measurements behind it. The part of it that is about
membranes alone is also what ``openmm.Context(system, integrator)`` does.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
from typing import NamedTuple

import openmm

from .forces import _why_not_helfrich

__all__ = ["LEAST_FOR_GPU", "Choice", "choose", "find", "names"]

#: From this number of particles on, costly forces are worth the way to a GPU and back: on CPU their
#: step takes milliseconds then, beside which some hundred microseconds for the way are little.
LEAST_FOR_GPU = 10_000

_ENVIRONMENT = "OPENMM_DEFAULT_PLATFORM"


class Choice(NamedTuple):
    """A platform, and why it was chosen.

    name: as OpenMM calls it; reason: half a sentence for people.
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
    - ``Helfrich`` if membranes, or terms that no platform computes faster, are most of the work.
    - Else, for pairs of particles and the like, CUDA, HIP, or OpenCL on a real GPU, from 10 000
      particles on.
    - Else ``CPU``, which has neighbour lists. OpenCL on a processor (PoCL) is never chosen.

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
    costly = _why_not_helfrich(system, integrator)
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
