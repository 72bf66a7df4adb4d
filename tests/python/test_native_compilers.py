"""The programs for OpenMM's GPU platforms compile for CUDA and HIP, where there is no such GPU.

CUDA's compiler is NVRTC, which OpenMM uses too. HIP's is clang, whose library checks a program
without making code of it, for HIPRTC comes with drivers only. `test_native.py` runs OpenCL's.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import re
from functools import cache
from pathlib import Path

import pytest
from openmmhelfrich import _core

ROOT = Path(__file__).resolve().parents[2]
# What OpenMM calls its numbers, and what the library has OpenMM define.
PRECISIONS = {
    "single": ("float", "float", ""),
    "mixed": ("float", "double", "HELFRICH_MIXED"),
    "double": ("double", "double", "HELFRICH_DOUBLE"),
}
every_precision = pytest.mark.parametrize("precision", PRECISIONS)

# OpenMM's dialect, the same for CUDA and HIP; what the programs use of it.
DIALECT = """
#define KERNEL extern "C" __global__
#define DEVICE __device__
#define LOCAL __shared__
#define LOCAL_ARG
#define GLOBAL
#define RESTRICT __restrict__
#define LOCAL_ID threadIdx.x
#define LOCAL_SIZE blockDim.x
#define GLOBAL_ID (blockIdx.x*blockDim.x+threadIdx.x)
#define GLOBAL_SIZE (blockDim.x*gridDim.x)
#define GROUP_ID blockIdx.x
#define NUM_GROUPS gridDim.x
#define SYNC_THREADS __syncthreads();
typedef long long mm_long;
typedef unsigned long long mm_ulong;
"""

# HIP's headers, as far as the programs need them.
HIP = """
#define __global__ __attribute__((global))
#define __device__ __attribute__((device))
#define __shared__ __attribute__((shared))
struct Extent { unsigned x, y, z; };
extern const __device__ Extent threadIdx, blockIdx, blockDim, gridDim;
struct float4 { float x, y, z, w; };
struct double4 { double x, y, z, w; };
__device__ void __syncthreads();
__device__ unsigned atomicAdd(unsigned*, unsigned);
__device__ unsigned atomicMax(unsigned*, unsigned);
__device__ unsigned atomicOr(unsigned*, unsigned);
__device__ unsigned __float_as_uint(float);
__device__ float __uint_as_float(unsigned);
__device__ int __clz(int);
__device__ float sqrtf(float);
__device__ float fabsf(float);
__device__ float fminf(float, float);
__device__ float fmaxf(float, float);
__device__ float rintf(float);
__device__ float rint(float);
__device__ double sqrt(double);
__device__ double fabs(double);
__device__ double fmin(double, double);
__device__ double fmax(double, double);
__device__ double rint(double);
__device__ int min(int, int);
__device__ int max(int, int);
__device__ unsigned min(unsigned, unsigned);
__device__ unsigned max(unsigned, unsigned);
"""


@cache
def program(precision: str) -> str:
    """The program of a precision, after what OpenMM writes before it."""
    source = _core.library().Helfrich_Native_source
    source.argtypes, source.restype = [ctypes.c_int], ctypes.c_char_p
    real, mixed, define = PRECISIONS[precision]
    head = f"typedef {real} real;\ntypedef {real}4 real4;\ntypedef {mixed} mixed;\n"
    head += f"#define {define} 1\n" if define else ""
    return DIALECT + head + source(precision == "double").decode()


def missing(reason: str) -> None:
    """Skip, or fail where nothing may be skipped for want of a driver."""
    if os.environ.get("HELFRICH_REQUIRE_OPENCL") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@cache
def nvrtc() -> ctypes.CDLL | None:
    """NVRTC as NVIDIA's packages have it, each release in a folder of its own."""
    spec = importlib.util.find_spec("nvidia")
    folders = spec.submodule_search_locations if spec else []
    paths = [path for folder in folders for path in Path(folder).glob("*/lib/libnvrtc.so.*")]
    return ctypes.CDLL(str(max(paths))) if paths else None


def compile_for_cuda(text: str, architecture: str) -> tuple[str, str]:
    """What the compiler says, and the code for CUDA's virtual machine; none if it refuses."""
    library = nvrtc()
    if library is None:
        missing("no NVRTC; pip install nvidia-cuda-nvrtc-cu12")
    handle, size = ctypes.c_void_p(), ctypes.c_size_t()

    def ask(what: str) -> str:
        getattr(library, f"nvrtcGet{what}Size")(handle, ctypes.byref(size))
        answer = ctypes.create_string_buffer(size.value)
        getattr(library, f"nvrtcGet{what}")(handle, answer)
        return answer.value.decode()

    created = library.nvrtcCreateProgram(
        ctypes.byref(handle), text.encode(), b"helfrich.cu", 0, None, None
    )
    assert created == 0
    # As OpenMM has it, but for a real architecture, so that the assembler has its say, too.
    options = (ctypes.c_char_p * 2)(f"-arch={architecture}".encode(), b"--use_fast_math")
    failed = library.nvrtcCompileProgram(handle, len(options), options)
    said = ask("ProgramLog"), "" if failed else ask("PTX")
    library.nvrtcDestroyProgram(ctypes.byref(handle))
    return said


def check_for_hip(text: str, architecture: str) -> list[str]:
    """What clang says of a program."""
    try:
        from clang import cindex
    except ImportError:
        missing("no clang; pip install libclang")
    # The second row is OpenMM's.
    options = [
        *("-x", "hip", "--cuda-device-only", "-nogpuinc", "-nogpulib"),
        *("-O3", "-ffast-math", "-munsafe-fp-atomics", "-Wall"),
        f"--offload-arch={architecture}",
    ]
    unit = cindex.Index.create().parse(
        "helfrich.hip", args=options, unsaved_files=[("helfrich.hip", HIP + text)]
    )
    return [str(diagnostic) for diagnostic in unit.diagnostics]


@every_precision
@pytest.mark.parametrize("architecture", [pytest.param("sm_75", marks=pytest.mark.long), "sm_90"])
def test_for_cuda_without_a_word(precision: str, architecture: str):
    log, code = compile_for_cuda(program(precision), architecture)
    assert not log.strip("\0\n ")
    # What the host looks for by name.
    host = (ROOT / "wrappers/src/NativeDevice.cpp").read_text(encoding="utf-8")
    kernels = set(re.findall(r'"(h_\w+)"', host))
    kernels |= set(re.findall(r"KERNEL void (\w+)\(int h_groups", program(precision)))
    assert len(kernels) > 10
    assert kernels <= set(re.findall(r"\.visible \.entry (\w+)\(", code))


@every_precision
@pytest.mark.parametrize("architecture", ["gfx90a", "gfx1100"])
def test_for_hip_without_a_word(precision: str, architecture: str):
    assert check_for_hip(program(precision), architecture) == []


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ("DEVICE int h_wrong() { return h_unknown; }", "error"),
        ("DEVICE int h_wrong() { int unused = 1; return 0; }", "warning"),
    ],
)
def test_compilers_find_what_is_wrong(wrong: str, complaint: str):
    text = program("single") + wrong
    assert complaint in compile_for_cuda(text, "sm_75")[0]
    assert [said for said in check_for_hip(text, "gfx90a") if complaint in said]
