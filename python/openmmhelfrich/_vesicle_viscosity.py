"""`Vesicle(viscosity=)`: what it may be, and the thermostat that comes of it."""

import math
from collections.abc import Mapping

from ._numbers import checked_number
from ._values import FRICTION
from ._vesicle_flips import TEMPERATURE
from .forces import SurfaceViscosityThermostat

_ARGUMENTS = ("friction", "temperature", "frequency", "randomNumberSeed")


def checked_viscosity(viscosity):
    """The arguments of the thermostat by name."""
    if not isinstance(viscosity, Mapping):
        shear = checked_number("viscosity", viscosity, FRICTION)
        # A regular net of frictions has the surface shear viscosity √3/4 of each.
        return {"friction": 4 / math.sqrt(3) * shear}
    for name in viscosity:
        if name not in _ARGUMENTS:
            raise ValueError(
                f"Vesicle: viscosity has no argument {name!r}; known are {', '.join(_ARGUMENTS)}"
            )
    if "friction" not in viscosity:
        raise ValueError("Vesicle: viscosity lacks the argument 'friction'")
    return dict(viscosity)


def thermostat_of(viscosity, mesh, offset):
    """The thermostat for a mesh whose particles start at `offset`, from `checked_viscosity`.

    Vesicles may differ in their friction, so each but the first of a System has a Context parameter
    of its own for it.
    """
    arguments = {"temperature": TEMPERATURE, **viscosity}
    seed = arguments.pop("randomNumberSeed", 0)
    thermostat = SurfaceViscosityThermostat(mesh, **arguments, offset=offset)
    thermostat.setName("viscosity")
    thermostat.setRandomNumberSeed(seed)
    if offset > 0:
        thermostat.setFrictionParameter(f"{thermostat.Friction()}{offset}")
    return thermostat
