"""Where the plugin's files are, for the build systems of C, C++ and Rust programs."""

from __future__ import annotations

from pathlib import Path

from . import _core

__all__ = ["cmake_path", "include_path", "library_path"]

_PACKAGE = Path(__file__).resolve().parent


def _existing(path: Path) -> str:
    if not path.exists():
        raise FileNotFoundError(
            f"openmmhelfrich: {path} is missing; install the package again with 'pip install .'"
        )
    return str(path)


def include_path() -> str:
    """The folder of the headers ``OpenMMHelfrich.h`` (C++) and ``OpenMMHelfrichCWrapper.h`` (C).

    OpenMM's own headers, which they include, are in ``OpenMM.libs/include`` beside the ``openmm``
    package.

    Raises
    ------
    FileNotFoundError
        If the installation is damaged.
    """
    return _existing(_PACKAGE / "include")


def library_path() -> str:
    """The file ``libOpenMMHelfrich.so``, or what it is called on other systems than Linux.

    Its folder can serve as ``OPENMM_PLUGIN_DIR``.

    Raises
    ------
    FileNotFoundError
        If the installation is damaged.
    """
    return _existing(_core.LIBRARY_PATH)


def cmake_path() -> str:
    """The folder of ``OpenMMHelfrichConfig.cmake``, for ``-DOpenMMHelfrich_DIR=``.

    Raises
    ------
    FileNotFoundError
        If the installation is damaged.
    """
    return _existing(_PACKAGE / "cmake")
