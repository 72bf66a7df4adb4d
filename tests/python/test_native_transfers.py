"""What time steps transfer where OpenMM's GPU platforms evaluate membranes themselves."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

import pytest
from native_vesicle import system_of
from platforms import NATIVE

DOUBLE = NATIVE[2]

COUNTER = r"""
#include <dlfcn.h>
#include <stddef.h>
static long reads, writes;
long count_reads(void) { return reads; }
long count_writes(void) { return writes; }
static void* real(const char* library, const char* name) {
    return dlsym(dlopen(library, RTLD_LAZY), name);
}

#define TRANSFER(NAME, COUNT) \
int NAME(void* q, void* b, unsigned w, size_t o, size_t s, void* p, unsigned n, void* l, void* e) \
{ \
    COUNT++; \
    return ((int (*)(void*, void*, unsigned, size_t, size_t, void*, unsigned, void*, void*)) \
        real("libOpenCL.so.1", #NAME))(q, b, w, o, s, p, n, l, e); \
}
TRANSFER(clEnqueueReadBuffer, reads)
TRANSFER(clEnqueueWriteBuffer, writes)
void* clEnqueueMapBuffer(void* q, void* b, unsigned w, unsigned long f, size_t o, size_t s,
        unsigned n, void* l, void* e, int* r) {
    reads++;
    return ((void* (*)(void*, void*, unsigned, unsigned long, size_t, size_t, unsigned, void*,
        void*, int*)) real("libOpenCL.so.1", "clEnqueueMapBuffer"))(q, b, w, f, o, s, n, l, e, r);
}

#define COPY(NAME, COUNT) \
int NAME(void* to, void* from, size_t size, void* stream) \
{ \
    COUNT++; \
    return ((int (*)(void*, void*, size_t, void*)) real("libcuda.so.1", #NAME))( \
        to, from, size, stream); \
}
// Those without a stream ignore what is in the place of one.
COPY(cuMemcpyDtoH_v2, reads)
COPY(cuMemcpyDtoHAsync_v2, reads)
COPY(cuMemcpyHtoD_v2, writes)
COPY(cuMemcpyHtoDAsync_v2, writes)
"""

STEPS = """
import ctypes, sys
import openmm as mm
import openmmhelfrich as helfrich

count = ctypes.CDLL(sys.argv[1])
mesh = helfrich.Mesh.icosphere(4, 100.0)
system = mm.System()
for _ in mesh.vertices:
    system.addParticle(50)
if sys.argv[3] != "none":
    for force in (
        helfrich.BendingForce(mesh, 50),
        helfrich.SurfaceAreaForce(mesh, 10, mesh.area),
        helfrich.EnclosedVolumeForce(mesh, 1, 0.9 * mesh.volume),
        helfrich.TriangleHeightForce(mesh, 5, 10),
    ):
        force.setBackend(sys.argv[3])
        if sys.argv[4:] == ["derivatives"]:
            name = f"{type(force).__name__} 0"
            force.setContextParameter(force.getParameterName(0), name)
            force.addEnergyParameterDerivative(name)
        system.addForce(force)
integrator = mm.LangevinMiddleIntegrator(300, 1, 0.01)
platform = mm.Platform.getPlatformByName(sys.argv[2])
context = mm.Context(system, integrator, platform, {"Precision": "mixed"})
context.setPositions(mesh.vertices)
integrator.step(10)
context.getState(energy=True)
integrator.step(1)
before = count.count_reads(), count.count_writes()
integrator.step(300)
print("transfers", count.count_reads() - before[0], count.count_writes() - before[1])
"""


def test_a_step_transfers_nothing(tmp_path):
    """Counted where OpenCL or CUDA is called: as many reads and writes as without any force.

    Derivatives, which OpenMM has in every step once they are asked for, change nothing.
    """
    DOUBLE.context(system_of(1))
    if DOUBLE.platform not in ("OpenCL", "CUDA"):
        pytest.skip(f"transfers of {DOUBLE.platform} are not counted")
    source, library = tmp_path / "count.c", tmp_path / "count.so"
    source.write_text(COUNTER, encoding="ascii")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)

    def transfers(*wanted: str) -> list[int]:
        result = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(STEPS), library, DOUBLE.platform, *wanted],
            env={**os.environ, "LD_PRELOAD": str(library)},
            capture_output=True,
            text=True,
            timeout=300,
            check=True,
        )
        line = next(line for line in result.stdout.splitlines() if line.startswith("transfers"))
        return [int(word) for word in line.split()[1:]]

    assert transfers("native") == transfers("none")
    assert transfers("native", "derivatives") == transfers("none")
    assert sum(transfers("cpu")) >= 600
