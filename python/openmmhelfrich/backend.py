"""What computes the forces: the processor, a GPU, or whichever is faster.

The choice holds for Contexts that are made after it, on every OpenMM platform. It is separate from
the platform: OpenMM integrates where its platform says, and the membrane's forces come from the
backend. A force can have its own (``force.setBackend("gpu")``), which goes before the choice made
here; forces on the same triangles of one Context are computed together and must not contradict
each other.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import openmm

from . import _core

__all__ = ["Adapter", "Timing", "adapters", "evaluations", "get_backend", "set_backend", "timings"]

#: Below this number of vertices "auto" looks for no GPU (src/evaluator/chosen.rs).
LEAST_VERTICES = 20_000

_KINDS = ("auto", "cpu", "gpu", "native")
_PRECISIONS = ("auto", "single", "double")


@dataclass(frozen=True)
class Adapter:
    """A GPU, or a driver that computes on the processor like one.

    index: its place among all, as `set_backend` takes it
    name: as its driver calls it
    kind: "discrete", "integrated", "virtual", "software" or "other"
    interface: "Vulkan", "Metal" or "DirectX 12"
    driver: the driver and its version
    double: whether it computes in double precision
    timestamps: whether it can say how long it computes
    """

    index: int
    name: str
    kind: str
    interface: str
    driver: str
    double: bool
    timestamps: bool


@dataclass(frozen=True)
class Timing:
    """One of the measurements by which ``"auto"`` chooses.

    machine: the version of this package, adapter, driver, precision and number of cores
    vertices: about how many the mesh had
    cpu, gpu: the time of an evaluation, s
    """

    machine: str
    vertices: int
    cpu: float
    gpu: float


def set_backend(backend: str, *, precision: str = "auto", adapter: int | None = None) -> None:
    """Choose what computes the forces of all Contexts that are made from now on.

    Parameters
    ----------
    backend : str
        ``"cpu"``: the processor, in double precision.

        ``"gpu"``: a GPU. That there is none, or that it fails, is an error.

        ``"native"``: OpenMM's platform OpenCL, CUDA or HIP itself, in its own precision: positions
        and forces stay on its device. A Context on another platform is an error. Forces of
        contacts, and volumes in a periodic box, are computed on the processor beside the others.

        ``"auto"``, the default: on OpenMM's GPU platforms as ``"native"``, if the kernels can be
        compiled. Elsewhere a GPU for meshes of 20 000 vertices and more if it is faster than the
        processor, which is measured once and kept in the user's cache folder. Drivers that compute
        on the processor are never taken. If the GPU fails, the processor takes over, which is said
        once on the standard error.
    precision : str
        ``"single"``, ``"double"``, or ``"auto"``, which is single. In single precision forces have
        errors of 1e-6 of the largest one, also those of area and volume near their targets,
        because these are summed in integers. Few GPUs are fast in double precision, and some do
        not have it.
    adapter : int, optional
        The index of an adapter in the list of `adapters`; the best one if it is left out.

    Raises
    ------
    ValueError
        If a name is unknown, or the processor is asked for a precision or an adapter.
    openmm.OpenMMException
        If there is no such GPU, or it does not have the precision.

    Notes
    -----
    The environment variable ``HELFRICH_BACKEND`` chooses for programs that cannot be changed:
    ``cpu``, ``gpu``, ``gpu:double``, ``auto:single@1`` (backend, precision, adapter).
    """
    if backend not in _KINDS:
        raise ValueError(f"set_backend: backend must be one of {_KINDS}, got {backend!r}")
    if precision not in _PRECISIONS:
        raise ValueError(f"set_backend: precision must be one of {_PRECISIONS}, got {precision!r}")
    if adapter is not None and (isinstance(adapter, bool) or not isinstance(adapter, int)):
        raise ValueError(f"set_backend: adapter must be an index, got {adapter!r}")
    if backend in ("cpu", "native") and (precision != "auto" or adapter is not None):
        raise ValueError(f'set_backend: the backend "{backend}" has no precisions or adapters')
    choice = backend
    if precision != "auto":
        choice += f":{precision}"
    if adapter is not None:
        choice += f"@{adapter}"
    if _core.library().Helfrich_setBackend(choice.encode()) != 0:
        raise openmm.OpenMMException(_core.last_error())


def get_backend() -> str:
    """What has been chosen, such as ``"auto"`` or ``"gpu:double@1"``.

    Raises
    ------
    openmm.OpenMMException
        If the environment variable ``HELFRICH_BACKEND`` names no backend.
    """
    return _text("Helfrich_getBackend")


def adapters() -> list[Adapter]:
    """The GPUs of this machine, the most promising first; drivers that use the processor are last.

    Raises
    ------
    openmm.OpenMMException
        If a driver fails when it is asked.
    """
    found = []
    for index, line in enumerate(_text("Helfrich_adapters").splitlines()):
        name, kind, interface, driver, double, timestamps = line.split("\t")
        flags = double == "1", timestamps == "1"
        found.append(Adapter(index, name, kind, interface, driver, *flags))
    return found


def timings() -> list[Timing]:
    """The measurements by which ``"auto"`` chooses, of this and earlier processes."""
    found = []
    for line in _text("Helfrich_backendTimings").splitlines():
        machine, _, vertices, cpu, gpu = line.split("\t")
        found.append(Timing(machine, int(vertices), 1e-6 * float(cpu), 1e-6 * float(gpu)))
    return found


def evaluations() -> dict[str, int]:
    """How many evaluations have been done in this process.

    Keys: "cpu", the processor; "gpu", GPUs through wgpu; "native", OpenMM's GPU platforms.
    """
    counts = (ctypes.c_uint64 * 3)()
    _core.library().Helfrich_evaluations(counts)
    return {"cpu": counts[0], "gpu": counts[1], "native": counts[2]}


def _text(function: str) -> str:
    """The text that a function of the core writes into a buffer."""
    call = getattr(_core.library(), function)
    call.argtypes, call.restype = [ctypes.c_char_p, ctypes.c_int64], ctypes.c_int64
    size = 1024
    while True:
        buffer = ctypes.create_string_buffer(size)
        length = call(buffer, size)
        if length < 0:
            raise openmm.OpenMMException(_core.last_error())
        if length < size:
            return buffer.value.decode("utf-8", errors="replace")
        size = length + 1
