"""The platforms that the force tests run on."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest


@dataclass(frozen=True)
class Target:
    """A platform in one precision, and how far its forces may be off, relative to the largest."""

    name: str
    platform: str
    tolerance: float
    properties: dict[str, str] = field(default_factory=dict, hash=False)
    #: What computes the membrane's forces, as `MembraneForce.setBackend` takes it.
    backend: str = ""

    def __str__(self) -> str:
        return self.name

    @property
    def counter(self) -> str:
        """What `backend.evaluations` calls evaluations on it."""
        return self.backend.partition(":")[0] or "cpu"

    def rounded(self, positions: np.ndarray) -> np.ndarray:
        """Positions as the platform has them."""
        if self.properties.get("Precision") == "single":
            return positions.astype(np.float32).astype(np.float64)
        return positions

    def context(self, system: mm.System, integrator: mm.Integrator | None = None) -> mm.Context:
        """A Context on this platform; skips the test, or fails it, if there is none."""
        _require(self)
        if integrator is None:
            integrator = mm.VerletIntegrator(0.001)
        platform = mm.Platform.getPlatformByName(self.platform)
        return mm.Context(system, integrator, platform, self.properties)


REFERENCE = Target("Reference", "Reference", 1e-9)
CPU = Target("CPU", "CPU", 1e-9, {"Threads": "2"})
HELFRICH = Target("Helfrich", "Helfrich", 1e-9, {"Threads": "2"})
ON_PROCESSOR = [REFERENCE, CPU, HELFRICH]
ON_OPENCL = [
    Target("OpenCL-single", "OpenCL", 1e-4, {"Precision": "single"}),
    # Positions are doubles here; forces pass through single precision on their way.
    Target("OpenCL-mixed", "OpenCL", 1e-6, {"Precision": "mixed"}),
    Target("OpenCL-double", "OpenCL", 1e-9, {"Precision": "double"}),
]

ON_GPU = [
    Target("GPU-single", "Reference", 1e-4, backend="gpu:single"),
    Target("GPU-double", "Reference", 1e-10, backend="gpu:double"),
]


# Where membranes are evaluated by OpenMM's GPU platform: OpenCL, or what this variable names.
NATIVE_PLATFORM = os.environ.get("HELFRICH_NATIVE_PLATFORM", "OpenCL")
# PoCL computes on the processor, which is only taken where it is asked for.
NATIVE = [
    Target("native-single", NATIVE_PLATFORM, 1e-5, {"Precision": "single"}, "native"),
    Target("native-mixed", NATIVE_PLATFORM, 1e-5, {"Precision": "mixed"}, "native"),
    Target("native-double", NATIVE_PLATFORM, 1e-9, {"Precision": "double"}, "native"),
]
UNASKED = Target("unasked", NATIVE_PLATFORM, 1e-9, {"Precision": "double"})
ON_DEVICE = ON_GPU + NATIVE


def sparing(targets: list[Target], keep: str = "double") -> list:
    """Parameters of which those that take a second to start are for `make test-long`, but one.

    Parameters
    ----------
    targets : list of Target
        Where a test runs.
    keep : str
        The precision in which OpenMM's GPU platforms run always.
    """
    return [
        pytest.param(
            target,
            id=str(target),
            marks=[pytest.mark.long]
            if "Precision" in target.properties and target.properties["Precision"] != keep
            else [],
        )
        for target in targets
    ]


@contextmanager
def counting() -> Iterator[dict[str, int]]:
    """At the end the dict has how many evaluations each backend has made meanwhile, if any."""
    before = helfrich.backend.evaluations()
    made: dict[str, int] = {}
    yield made
    now = helfrich.backend.evaluations()
    made.update({name: now[name] - before[name] for name in now if now[name] > before[name]})


def native_is_on_processor() -> bool:
    """Whether the driver of the platform above computes on the processor, as PoCL does."""
    return NATIVE_PLATFORM == "OpenCL" and helfrich.platforms._count_opencl_gpus() == 0


def require_gpu(double: bool = False) -> None:
    """Skip the test where there is no GPU, or fail it where HELFRICH_REQUIRE_GPU=1 demands one."""
    found = helfrich.adapters()
    if found and (found[0].double or not double):
        return
    reason = f"{found[0].name} has no double precision" if found else "no GPU, not even in software"
    if os.environ.get("HELFRICH_REQUIRE_GPU") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@cache
def _why_not(name: str, precision: str) -> str | None:
    """What keeps a platform from running a plain force of OpenMM's own; None if it runs."""
    present = [mm.Platform.getPlatform(i).getName() for i in range(mm.Platform.getNumPlatforms())]
    if name not in present:
        return f"this OpenMM has no {name} platform, only {', '.join(present)}"
    system = mm.System()
    bond = mm.HarmonicBondForce()
    for _ in range(4):
        system.addParticle(1)
    bond.addBond(0, 1, 1, 1)
    system.addForce(bond)
    try:
        platform = mm.Platform.getPlatformByName(name)
        mm.Context(system, mm.VerletIntegrator(0.001), platform, {"Precision": precision})
    except mm.OpenMMException as error:
        return f"{name} in {precision} precision does not start: {error}"
    return None


def _require(target: Target) -> None:
    if target.backend.startswith("gpu"):
        require_gpu(double=target.backend.endswith("double"))
    if "Precision" not in target.properties:
        return
    reason = _why_not(target.platform, target.properties["Precision"])
    if reason is None:
        return
    asked = target.platform == os.environ.get("HELFRICH_NATIVE_PLATFORM")
    if asked or os.environ.get("HELFRICH_REQUIRE_OPENCL") == "1":
        pytest.fail(reason)
    pytest.skip(reason)
