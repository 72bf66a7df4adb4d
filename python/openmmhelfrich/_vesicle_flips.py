"""`Vesicle(flips=)`: what it may be, and the mover that comes of it."""

from collections.abc import Mapping

import openmm
from openmm import unit

from ._numbers import checked_number
from .analysis import theory
from .forces import MonteCarloBondFlip

# The paper's, K.
TEMPERATURE = 300.0
# Steps from one round of flips to the next, where only a rate is given.
_STEPS = 10
_ARGUMENTS = (
    "temperature",
    "frequency",
    "attemptsPerEdge",
    "minDegree",
    "maxDegree",
    "maxEdgeLength",
    "randomNumberSeed",
    "ensemble",
)


def checked_flips(flips):
    """The arguments of the mover by name."""
    if not isinstance(flips, Mapping):
        rate = checked_number("flips", flips, unit.dimensionless)
        return {"frequency": _STEPS, "attemptsPerEdge": _STEPS * rate}
    for name in flips:
        if name not in _ARGUMENTS:
            raise ValueError(
                f"Vesicle: flips has no argument {name!r}; known are {', '.join(_ARGUMENTS)}"
            )
    return dict(flips)


def mover_of(flips, mesh, offset):
    """The mover for a mesh whose particles start at `offset`, from what `checked_flips` gave."""
    arguments = {"temperature": TEMPERATURE, **flips}
    seed = arguments.pop("randomNumberSeed", 0)
    ensemble = arguments.pop("ensemble", MonteCarloBondFlip.Canonical)
    mover = MonteCarloBondFlip(mesh, **arguments, offset=offset)
    mover.setName("flips")
    mover.setRandomNumberSeed(seed)
    mover.setEnsemble(ensemble)
    return mover


def bath_of(integrator):
    """The temperature of an integrator's bath, K; 300 K if it has none that can be asked for."""
    if isinstance(integrator, openmm.CompoundIntegrator):
        count = integrator.getNumIntegrators()
        found = {bath_of(integrator.getIntegrator(number)) for number in range(count)}
        if len(found) > 1:
            raise ValueError(
                f"Vesicle: the integrators have the temperatures {', '.join(map(str, found))}; "
                "give the flips one of their own, flips={'temperature': …}"
            )
        return found.pop()
    if hasattr(integrator, "getTemperature"):
        temperature = integrator.getTemperature()
        return temperature / unit.kelvin if unit.is_quantity(temperature) else float(temperature)
    if isinstance(integrator, openmm.CustomIntegrator):
        names = [
            integrator.getGlobalVariableName(number)
            for number in range(integrator.getNumGlobalVariables())
        ]
        # As OpenMM's own, such as MTSLangevinIntegrator, call it.
        if "kT" in names:
            return integrator.getGlobalVariableByName("kT") / theory.BOLTZMANN
    return TEMPERATURE
