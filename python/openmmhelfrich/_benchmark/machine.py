"""What a measurement was taken with: processor and versions."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from pathlib import Path

import openmm

from .. import _plugin

__all__ = ["machine", "versions"]


def machine() -> dict[str, str]:
    """Processor, number of cores, memory and operating system, as far as they can be found."""
    found = {"processor": _processor(), "cores": str(os.cpu_count() or "unknown")}
    memory = _gibibytes()
    if memory is not None:
        found["memory"] = f"{memory:.0f} GiB"
    found["system"] = f"{platform.system()} {platform.machine()}"
    return found


def versions() -> dict[str, str]:
    """Versions of what takes part: this package, OpenMM, Python, and rustc if it is there."""
    found = {
        "openmm-helfrich": _plugin.version(),
        "OpenMM": openmm.Platform.getOpenMMVersion(),
        "Python": platform.python_version(),
    }
    rustc = shutil.which("rustc")
    if rustc:
        said = subprocess.run([rustc, "--version"], capture_output=True, text=True, check=False)
        if said.returncode == 0:
            found["rustc"] = said.stdout.split()[1]
    return found


def _processor() -> str:
    """The model of the processor; with its family where the name is that of a brand only."""
    fields: dict[str, str] = {}
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8", errors="replace").splitlines():
            name, _, value = line.partition(":")
            fields.setdefault(name.strip(), value.strip())
    name = fields.get("model name") or platform.processor() or platform.machine()
    if "cpu family" in fields:
        name += f" (family {fields['cpu family']}, model {fields.get('model', '?')})"
    wide = [flag for flag in ("avx2", "avx512f") if flag in fields.get("flags", "").split()]
    return ", ".join([name, *wide])


def _gibibytes() -> float | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    except (AttributeError, OSError, ValueError):
        return None
