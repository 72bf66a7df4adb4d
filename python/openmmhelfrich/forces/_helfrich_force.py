"""HelfrichForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._proxies import proxy

if TYPE_CHECKING:
    pass


@proxy
class _HelfrichForce(openmm.Force):
    """An OpenMM Force of this plugin, which knows its class and has its implementation made by the
    library.
    """

    def getTypeName(self) -> str:
        """Get the name of the class, as messages and XML have it."""
        return _forces._HelfrichForce_getTypeName(self)
