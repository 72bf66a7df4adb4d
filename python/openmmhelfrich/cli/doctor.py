"""``openmm-helfrich doctor``: what is installed, what is missing, and what to do."""

from __future__ import annotations

import importlib
import math
import os
import platform
import sys
import tempfile
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import click

from .options import json_option, print_json

__all__ = ["Check", "checks", "doctor", "doctor_if_asked"]

# What is of use and need not be there: the module, what needs it, what installs it.
_EXTRAS = (
    ("h5py", "modes and tables in HDF5, frames in VTKHDF", "openmm-helfrich[hdf5]"),
    ("mdtraj", "analysis of trajectories in XTC and DCD", "openmm-helfrich[trajectories]"),
    ("lz4", "VTK files that are compressed by LZ4", "openmm-helfrich[lz4]"),
    ("dask", "sweeps on a Dask scheduler", "openmm-helfrich[paper]"),
    ("distributed", "sweeps on a Dask scheduler", "openmm-helfrich[paper]"),
    ("pyvista", "pictures of membranes in the paper's figures", "openmm-helfrich[paper]"),
    ("IPython", "views in notebooks", "ipython"),
    ("playwright", "pictures of views by examples/viewer_pictures.py", "playwright"),
)
# The releases that the package depends on.
_OPENMM = "pip install --force-reinstall 'openmm==8.6.*'"
_REQUIRED = ("numpy", "scipy", "meshio", "trimesh", "matplotlib", "tqdm", "click")

_VARIABLES = {
    "HELFRICH_BACKEND": "what computes membranes where no program chooses: cpu, gpu, native, auto",
    "HELFRICH_LOG": "how much is said: debug, info, warning, error, critical",
    "OPENMM_CPU_THREADS": "how many threads the platforms Helfrich and CPU have",
    "OPENMM_DEFAULT_PLATFORM": "the platform where none is named",
    "OPENMM_PLUGIN_DIR": "where OpenMM looks for its plugins",
}


class Check(NamedTuple):
    """What was found of one thing.

    status: "ok", "missing" (it works without) or "wrong"; advice: what to do, if anything
    """

    name: str
    status: str
    found: str
    advice: str = ""


@click.command()
@json_option
def doctor(as_json):
    """Check what is installed, and say what is missing and what to do.

    Versions, the library and OpenMM's platforms, a step of a small vesicle, GPUs, optional
    packages, the cache folder, and the environment variables that matter. What is missing may stay
    so; the exit status is 1 if something is wrong.
    """
    found = []
    for check in checks():
        found.append(check)
        if not as_json:
            click.echo(f"{check.status:<8s} {check.name}: {check.found}")
            if check.advice:
                click.echo(f"{'':8s}   {check.advice}")
    is_wrong = any(check.status == "wrong" for check in found)
    if as_json:
        print_json({"ok": not is_wrong, "checks": [check._asdict() for check in found]})
    elif is_wrong:
        click.echo(
            "\nSomething is wrong; docs/installation.md and docs/troubleshooting.md say more."
        )
    else:
        click.echo("\nAll that is needed is there.")
    sys.exit(int(is_wrong))


def doctor_if_asked() -> None:
    """Run the doctor, and end, if that is what this process is for; else do nothing.

    For the package where it cannot load its library, without which no other command works.
    """
    program = Path(sys.argv[0]).stem if sys.argv else ""
    if program in ("openmm-helfrich", "-m", "__main__") and sys.argv[1:2] == ["doctor"]:
        doctor.main(sys.argv[2:], prog_name="openmm-helfrich doctor")


def checks() -> Iterator[Check]:
    """All checks, one after the other. Those that need the library end where it does not load."""
    yield _python()
    yield from map(_required, _REQUIRED)
    openmm_check, plugin_check = _guarded("OpenMM", _openmm), None
    yield openmm_check
    if openmm_check.status == "ok":
        plugin_check = _guarded("openmm-helfrich", _plugin)
        yield plugin_check
    if plugin_check is not None and plugin_check.status == "ok":
        yield _guarded("OpenMM's platforms", _platforms)
        yield from _failures()
        yield _guarded("platform Helfrich", _vesicle)
        yield _guarded("processor", _processor)
        yield _guarded("backend", _backend)
        yield _guarded("GPUs", _gpus)
    yield from (_extra(*extra) for extra in _EXTRAS)
    yield _cache()
    yield from _variables()


def _guarded(name: str, check: Callable[[], Check]) -> Check:
    """A check; any error in it is what was found."""
    try:
        return check()
    except Exception as reason:
        return Check(
            name,
            "wrong",
            f"{type(reason).__name__}: {' '.join(str(reason).split())}",
            "docs/troubleshooting.md#before-the-first-step lists messages and what to do",
        )


def _python() -> Check:
    return Check("Python", "ok", f"{platform.python_version()}, {sys.executable}")


def _required(name: str) -> Check:
    try:
        importlib.import_module(name)
    except Exception as reason:
        return Check(name, "wrong", str(reason), f"pip install --force-reinstall {name}")
    return Check(name, "ok", metadata.version(name))


def _openmm() -> Check:
    try:
        import openmm
    except Exception as reason:
        return Check("OpenMM", "wrong", str(reason), _OPENMM)
    library = openmm.version.openmm_library_path
    return Check("OpenMM", "ok", f"{openmm.Platform.getOpenMMVersion()}, {library}")


def _plugin() -> Check:
    """The library, and whether it accepts this OpenMM."""
    import openmm

    from .. import _core, _plugin

    name, version = "openmm-helfrich", metadata.version("openmm-helfrich")
    try:
        _plugin.load()
    except ImportError as reason:
        # The message says what to do.
        return Check(name, "wrong", f"{version}, cannot be loaded", str(reason))
    except openmm.OpenMMException as reason:
        return Check(
            name,
            "wrong",
            f"{version}, cannot be loaded: {reason}",
            "install the package again with 'pip install .'",
        )
    built, found = _plugin.built_for(), openmm.Platform.getOpenMMVersion()
    relation = "for which it was built"
    if built != found:
        relation = f"whose interface is that of {built}, for which it was built"
    path = _core.LIBRARY_PATH
    return Check(name, "ok", f"{version}, accepts OpenMM {found}, {relation}; {path}")


def _platforms() -> Check:
    from ..platforms import ON_DEVICES, names

    present = names()
    needed = [name for name in ("Reference", "Helfrich") if name not in present]
    if needed:
        return Check(
            "OpenMM's platforms",
            "wrong",
            f"no {', '.join(needed)}",
            f"unset OPENMM_PLUGIN_DIR, or {_OPENMM}",
        )
    wanted = os.environ.get("OPENMM_DEFAULT_PLATFORM")
    if wanted is not None and wanted.lower() not in map(str.lower, present):
        found = f"no {wanted!r}, which OPENMM_DEFAULT_PLATFORM names"
        return Check("OpenMM's platforms", "wrong", found, "unset it, or name another")
    found = ", ".join(present)
    if not any(name in present for name in ON_DEVICES):
        return Check(
            "OpenMM's platforms",
            "missing",
            f"{found}; none for GPUs",
            "for one: pip install 'openmm-helfrich[cuda12]' (or cuda13, hip6, hip7)",
        )
    return Check("OpenMM's platforms", "ok", found)


def _failures() -> Iterator[Check]:
    """Plugins of OpenMM that did not load; those for a GPU need its driver."""
    import openmm

    for failure in openmm.Platform.getPluginLoadFailures():
        yield Check(
            "plugin of OpenMM",
            "missing",
            " ".join(failure.split()),
            "if it is for a GPU, it needs the driver of that GPU; all else works",
        )


def _vesicle() -> Check:
    """A step of a small vesicle on the platform Helfrich."""
    import openmm

    from ..mesh import Mesh
    from ..vesicle import Vesicle

    mesh = Mesh.icosphere(2, 100.0)
    chosen = openmm.Platform.getPlatformByName("Helfrich")
    integrator = openmm.VerletIntegrator(0.01)
    context = openmm.Context(Vesicle(mesh).system(), integrator, chosen)
    context.setPositions(mesh.vertices)
    integrator.step(1)
    energy = context.getState(energy=True).getPotentialEnergy()._value
    threads = chosen.getPropertyValue(context, "Threads")
    found = f"a step of {mesh.num_vertices} vertices, {energy:.6g} kJ/mol, {threads} thread(s)"
    if not math.isfinite(energy):
        return Check("platform Helfrich", "wrong", found, "report it, with this output")
    return Check("platform Helfrich", "ok", found)


def _processor() -> Check:
    from .. import _benchmark

    facts = _benchmark.machine()
    return Check("processor", "ok", f"{facts['processor']}; {facts['cores']} cores")


def _backend() -> Check:
    import openmm

    from .. import backend

    try:
        return Check("backend", "ok", backend.get_backend())
    except openmm.OpenMMException as reason:
        return Check("backend", "wrong", str(reason), "unset HELFRICH_BACKEND")


def _gpus() -> Check:
    from .. import backend

    found = backend.adapters()
    words = "; ".join(f"{gpu.name} ({gpu.kind}, {gpu.interface})" for gpu in found)
    if all(gpu.kind == "software" for gpu in found):
        return Check(
            "GPUs",
            "missing",
            words or "none, nor any driver of one",
            "if there is one, install its driver for Vulkan; the processor does",
        )
    return Check("GPUs", "ok", words)


def _extra(name: str, purpose: str, source: str) -> Check:
    advice = f"pip install '{source}'"
    try:
        importlib.import_module(name)
        return Check(name, "ok", f"{metadata.version(name)}, for {purpose}")
    except ModuleNotFoundError as reason:
        if reason.name == name:
            return Check(name, "missing", f"needed for {purpose}", advice)
        found = str(reason)
    except Exception as reason:
        found = str(reason)
    return Check(name, "wrong", f"does not load: {found}", f"pip install --force-reinstall {name}")


def _cache() -> Check:
    """Whether what was measured of GPUs can be kept; where, is the rule of the core."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    folder = Path(base, "openmm-helfrich")
    # It is made when it is first needed.
    nearest = next(path for path in (folder, *folder.parents) if path.exists())
    try:
        with tempfile.TemporaryFile(dir=nearest):
            pass
    except OSError as reason:
        return Check(
            "cache folder",
            "missing",
            f"{folder}: {reason.strerror}",
            "make it writable or set XDG_CACHE_HOME, or GPUs are measured anew",
        )
    return Check("cache folder", "ok", str(folder))


def _variables() -> Iterator[Check]:
    """The environment variables that are set."""
    for name, purpose in _VARIABLES.items():
        if name in os.environ:
            yield Check(name, "ok", f"{os.environ[name]!r}, {purpose}")
    for name in sorted(os.environ):
        if name.startswith("HELFRICH_") and name not in _VARIABLES:
            yield Check(name, "ok", f"{os.environ[name]!r}, which the package does not use")
