"""`Vesicle(osmotic=, area_difference=)`: what they may be, and the forces that come of them."""

from collections.abc import Mapping

import numpy as np
from openmm import unit

from ._numbers import checked_number
from .analysis import theory
from .area_difference import area_difference_parameters
from .errors import MeshError

_ENERGY = unit.kilojoule_per_mole
# At the paper's 300 K.
_KT = theory.BOLTZMANN * 300
_OSMOTIC = ("solutes", "concentration", "thermalEnergy")
_MODEL = ("alpha", "delta_a0")
_PLAIN = ("modulus", "target")


def encloses(mesh, needed):
    """Whether a mesh encloses a volume; a MeshError says why not, if it is needed."""
    try:
        return mesh.volume is not None
    except MeshError as reason:
        if not needed:
            return False
        said = str(reason).removeprefix("Mesh.volume")
        raise MeshError(f"Vesicle: mesh{said}; volume_modulus=0 leaves the volume out") from None


def _checked_names(argument, given, *choices):
    """Refuse what is none of several sets of names."""
    if not isinstance(given, Mapping):
        raise TypeError(f"Vesicle: {argument} needs a mapping of names to numbers, got {given!r}")
    if not any(set(given) == set(names) for names in choices):
        wanted = ", or ".join(" and ".join(names) for names in choices)
        raise ValueError(f"Vesicle: {argument} needs {wanted}, got {', '.join(given) or 'nothing'}")


def checked_osmotic(given):
    """The arguments of an `OsmoticPressureForce` by name."""
    _checked_names("osmotic", given, _OSMOTIC[:2], _OSMOTIC)
    units = (unit.dimensionless, unit.nanometer**-3, _ENERGY)
    values = {"thermalEnergy": _KT, **given}
    return {
        name: checked_number(f"osmotic {name}", values[name], dimension, zero=False)
        for name, dimension in zip(_OSMOTIC, units, strict=True)
    }


def checked_area_difference(given, rigidity, area):
    """The arguments of an `AreaDifferenceForce` by name, for a vesicle of κ and A0."""
    _checked_names("area_difference", given, _MODEL, _PLAIN)
    if set(given) == set(_MODEL):
        if np.ndim(rigidity) > 0:
            raise ValueError(
                "Vesicle: area_difference needs one rigidity for alpha; give modulus and target"
            )
        return dict(
            zip(_PLAIN, area_difference_parameters(rigidity, **given, area=area), strict=True)
        )
    units = (_ENERGY / unit.nanometer**2, unit.nanometer)
    return {
        name: checked_number(
            f"area_difference {name}", given[name], dimension, negative=name == "target"
        )
        for name, dimension in zip(_PLAIN, units, strict=True)
    }
