"""Loading the plugin into OpenMM, once and for the right version."""

from __future__ import annotations

import ctypes
from importlib import metadata
from pathlib import Path

import openmm

from . import _core
from ._openmm_interface import interface_of, read_record

__all__ = ["built_for", "load", "version"]


def version() -> str:
    """The version of this package."""
    return metadata.version("openmm-helfrich")


def check_openmm(built: str, found: str, same_interface: bool = False) -> None:
    """Refuse an OpenMM that the library was not built for.

    A plugin that is loaded into an OpenMM with another C++ interface crashes. That changes from
    release to release, and may stay in a patch release, which differs in the last number.

    Parameters
    ----------
    built, found : str
        The version that the build saw, and the one that runs.
    same_interface : bool
        Whether the headers of both are known to be the same.

    Raises
    ------
    ImportError
        If it cannot be used.
    """
    if built != found and not (same_interface and _release(built) == _release(found)):
        raise ImportError(
            f"openmmhelfrich was built for OpenMM {built}, but this is OpenMM {found}, whose C++ "
            f"interface may be another. Install OpenMM {built} ('pip install openmm=={built}'), or "
            "build openmm-helfrich again beside this one ('pip install --no-build-isolation .')."
        )


def _release(version: str) -> list[str]:
    """The first two numbers of a version."""
    return version.split(".")[:2]


def has_same_interface() -> bool:
    """Whether the headers of the OpenMM that runs are those of the build, but for comments."""
    include = Path(openmm.version.openmm_library_path).parent / "include"
    known = read_record(Path(__file__).parent)
    return known is not None and known == interface_of(include)


def built_for() -> str:
    """The version of OpenMM that the library was built for."""
    core = _core.library()
    core.Helfrich_openmmVersion.restype = ctypes.c_char_p
    return core.Helfrich_openmmVersion().decode()


def load() -> None:
    """Check OpenMM's version and load the plugin, which makes its forces known to XML.

    Raises
    ------
    ImportError
        If the library is missing, or was built for an OpenMM with another interface.
    """
    built, found = built_for(), openmm.Platform.getOpenMMVersion()
    if built != found:
        # To read OpenMM's headers takes a tenth of a second.
        check_openmm(built, found, has_same_interface())
        _core.library().Helfrich_acceptOpenMM(found.encode())
    openmm.Platform.loadPluginLibrary(str(_core.LIBRARY_PATH))
