"""Loading the plugin into OpenMM, once and for the right version."""

from __future__ import annotations

import ctypes
from importlib import metadata

import openmm

from . import _core

__all__ = ["load", "version"]


def version() -> str:
    """The version of this package."""
    return metadata.version("openmm-helfrich")


def check_openmm(built: str, found: str) -> None:
    """Refuse an OpenMM that the library was not built for.

    OpenMM's C++ interface changes from release to release, and a plugin that is loaded into another
    one crashes.

    Parameters
    ----------
    built, found : str
        The version that the build saw, and the one that runs.

    Raises
    ------
    ImportError
        If they differ.
    """
    if built != found:
        raise ImportError(
            f"openmmhelfrich was built for OpenMM {built}, but this is OpenMM {found}. "
            f"Install OpenMM {built} ('pip install openmm=={built}'), or build "
            "openmm-helfrich again beside this one ('pip install --no-build-isolation .')."
        )


def load() -> None:
    """Check OpenMM's version and load the plugin, which makes its forces known to XML.

    Raises
    ------
    ImportError
        If the library is missing, or was built for another version of OpenMM.
    """
    core = _core.library()
    core.Helfrich_openmmVersion.restype = ctypes.c_char_p
    check_openmm(core.Helfrich_openmmVersion().decode(), openmm.Platform.getOpenMMVersion())
    openmm.Platform.loadPluginLibrary(str(_core.LIBRARY_PATH))
