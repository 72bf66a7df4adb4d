"""From a value of a TOML file to what the simulation needs.

A reader is a function of the value and of kB T, kJ/mol. It returns what is meant, or raises
ValueError with what is wrong; the caller adds file, line and key.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from .._mesh.inputs import box_array
from ..errors import MeshError
from ..vcm.grammar import nearest

__all__ = [
    "Reader",
    "area_difference",
    "boolean",
    "box",
    "choice",
    "choices",
    "counts",
    "energy",
    "flips",
    "integer",
    "mode",
    "number",
    "osmotic",
    "scale",
    "signed_energy",
    "skeleton",
    "table",
    "text",
    "vector",
    "viscosity",
]

Reader = Callable[[Any, float], Any]


def _finite(value: Any, what: str = "a number") -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"expected {what}, got {value!r}")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise ValueError(f"expected a finite number, got {value}")
    return result


def _check_range(
    value: float, least: float | None, above: float | None, most: float | None = None
) -> None:
    if least is not None and value < least:
        raise ValueError(f"must be {least:g} or more, got {value:g}")
    if above is not None and value <= above:
        raise ValueError(f"must be above {above:g}, got {value:g}")
    if most is not None and value > most:
        raise ValueError(f"must be {most:g} or less, got {value:g}")


def number(
    least: float | None = None, above: float | None = None, most: float | None = None
) -> Reader:
    """A finite number in a range."""

    def read(value, kT):
        result = _finite(value)
        _check_range(result, least, above, most)
        return result

    return read


def energy(value: Any, kT: Any) -> Any:
    """A number in kJ/mol, or a string such as ``"20 kT"``; 0 or more."""
    result = signed_energy(value, kT)
    _check_range(result, 0, None)
    return result


def signed_energy(value: Any, kT: Any) -> Any:
    """A number in kJ/mol, or a string such as ``"-20 kT"``."""
    if isinstance(value, str):
        found = re.fullmatch(r"\s*(\S+)\s*kT\s*", value)
        try:
            factor = float(found.group(1)) if found else math.nan
        except ValueError:
            factor = math.nan
        if not math.isfinite(factor):
            raise ValueError(
                f'expected a number in kJ/mol or a string such as "20 kT", got {value!r}'
            )
        return factor * kT
    return _finite(value, 'a number in kJ/mol or a string such as "20 kT"')


def integer(least: int, most: int = 2**31 - 1) -> Reader:
    """An integer in a range; OpenMM's have 32 bits."""

    def read(value, kT):
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError(f"expected an integer, got {value!r}")
        if value < least:
            raise ValueError(f"must be {least} or more, got {value}")
        if value > most:
            raise ValueError(f"must be {most} or less, got {value}")
        return value

    return read


def boolean(value: Any, kT: Any) -> Any:
    """True or false."""
    if not isinstance(value, bool):
        raise ValueError(f"expected true or false, got {value!r}")
    return value


def text(value: Any, kT: Any) -> Any:
    """A string that is not empty."""
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"expected a string, got {value!r}")
    return value


def choice(meanings: Mapping[str, Any] | Iterable[str]) -> Reader:
    """One of several strings, which may stand for something."""
    known = meanings if isinstance(meanings, Mapping) else {name: name for name in meanings}

    def read(value, kT):
        if not isinstance(value, str):
            raise ValueError(f"expected a string, one of {', '.join(known)}, got {value!r}")
        if value not in known:
            raise ValueError(f"there is no {value!r}; {nearest(value, known)}")
        return known[value]

    return read


def choices(meanings: Mapping[str, Any]) -> Reader:
    """An array of strings, each one of several."""
    one = choice(meanings)

    def read(value, kT):
        if not isinstance(value, list):
            raise ValueError(f"expected an array of strings, got {value!r}")
        return tuple(one(item, kT) for item in value)

    return read


def vector(value: Any, kT: Any) -> Any:
    """Three finite numbers."""
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError(f"expected three numbers [x, y, z], got {value!r}")
    return tuple(_finite(component) for component in value)


def counts(least: int) -> Reader:
    """Two integers in a range."""

    def read(value, kT):
        if not isinstance(value, list) or len(value) != 2:
            raise ValueError(f"expected two integers, got {value!r}")
        return tuple(integer(least)(count, kT) for count in value)

    return read


def box(value: Any, kT: Any) -> Any:
    """Three lengths, or three box vectors, as an array of vectors."""
    if isinstance(value, list) and value and not isinstance(value[0], list):
        rows = np.diag(vector(value, kT))
    elif isinstance(value, list) and len(value) == 3:
        rows = [vector(row, kT) for row in value]
    else:
        raise ValueError(f"expected [x, y, z] or three vectors, got {value!r}")
    try:
        return box_array(rows, "[box]")
    except MeshError as reason:
        raise ValueError(str(reason).removeprefix("[box]: ")) from None


def scale(value: Any, kT: Any) -> Any:
    """A factor, or one for each axis; none of them 0."""
    factors = vector(value, kT) if isinstance(value, list) else (_finite(value),)
    if 0 in factors:
        raise ValueError(f"a factor must not be 0, got {value!r}")
    return factors if len(factors) == 3 else factors[0]


def mode(value: Any, kT: Any) -> Any:
    """A deformation ``{ l = 2, m = 0, amplitude = 0.1 }``, as a tuple."""
    if not isinstance(value, dict) or set(value) != {"l", "m", "amplitude"}:
        raise ValueError(f"expected {{ l = …, m = …, amplitude = … }}, got {value!r}")
    l = integer(0)(value["l"], kT)
    return l, integer(-l, l)(value["m"], kT), _finite(value["amplitude"])


#: The keys of ``flips``, with the arguments of `MonteCarloBondFlip` that they are.
_FLIPS = {
    "temperature": ("temperature", number(above=0)),
    "frequency": ("frequency", integer(0)),
    "attempts_per_edge": ("attemptsPerEdge", number(least=0, most=1000)),
    "min_degree": ("minDegree", integer(3)),
    "max_degree": ("maxDegree", integer(3)),
    "max_edge_length": ("maxEdgeLength", number(least=0)),
}


def flips(value: Any, kT: Any) -> Any:
    """Attempts per edge and step, or a table of what `MonteCarloBondFlip` takes."""
    if not isinstance(value, dict):
        return number(least=0, most=100)(value, kT)
    given = _arguments("flips", _FLIPS, value, kT)
    least, most = given.get("minDegree", 3), given.get("maxDegree", 10)
    if least > most:
        raise ValueError(f"max_degree must not be below min_degree, got {most} and {least}")
    return given


#: The same for ``osmotic`` and `OsmoticPressureForce`.
_OSMOTIC = {
    "solutes": ("solutes", number(above=0)),
    "concentration": ("concentration", number(above=0)),
    "thermal_energy": ("thermalEnergy", energy),
}
#: The same for ``area_difference`` and `area_difference_parameters` or `AreaDifferenceForce`.
_AREA_DIFFERENCE = {
    "alpha": ("alpha", number(least=0)),
    "delta_a0": ("delta_a0", number()),
    "modulus": ("modulus", number(least=0)),
    "target": ("target", number()),
}


def osmotic(value: Any, kT: Any) -> Any:
    """A table of what `OsmoticPressureForce` takes; kT is that of the integrator."""
    given = _arguments("osmotic", _OSMOTIC, table(value, kT), kT)
    _need("osmotic", given, _OSMOTIC, "solutes", "concentration")
    return {"thermalEnergy": kT, **given}


def area_difference(value: Any, kT: Any) -> Any:
    """A table of what `area_difference_parameters` or `AreaDifferenceForce` takes."""
    given = _arguments("area_difference", _AREA_DIFFERENCE, table(value, kT), kT)
    if set(given) not in ({"alpha", "delta_a0"}, {"modulus", "target"}):
        have = ", ".join(value) or "nothing"
        raise ValueError(f"needs either alpha and delta_a0, or modulus and target, got {have}")
    return given


#: The keys of ``viscosity``, with the arguments of `SurfaceViscosityThermostat` that they are.
_VISCOSITY = {
    "friction": ("friction", number(least=0)),
    "temperature": ("temperature", number(above=0)),
    "frequency": ("frequency", integer(0)),
}


def viscosity(value: Any, kT: Any) -> Any:
    """A surface shear viscosity, or a table of what `SurfaceViscosityThermostat` takes."""
    if not isinstance(value, dict):
        return number(least=0)(value, kT)
    arguments = _arguments("viscosity", _VISCOSITY, value, kT)
    if "friction" not in arguments:
        raise ValueError("it lacks friction, amu/ps")
    return arguments


def _share(value, kT):
    result = number(above=0)(value, kT)
    if result >= 1:
        raise ValueError(f"must be below 1, got {result:g}")
    return result


#: The same for ``skeleton`` and the forces that it may be.
_SKELETON = {
    "law": ("law", choice(("Skalak", "NeoHookean", "LinearElastic", "Spring"))),
    "shear_modulus": ("shearModulus", number(least=0)),
    "area_modulus": ("areaModulus", number(least=0)),
    "stiffness": ("stiffness", number(least=0)),
    "ratio": ("ratio", _share),
    "form": ("form", choice(("Harmonic", "WLCPower"))),
}


#: What each law needs, and what it may have.
_OF_LAW = {
    "Skalak": (("shear_modulus", "area_modulus"), ()),
    "NeoHookean": (("shear_modulus", "area_modulus"), ()),
    "LinearElastic": (("shear_modulus", "area_modulus"), ()),
    "Spring": (("stiffness",), ("ratio", "form")),
}


def skeleton(value: Any, kT: Any) -> Any:
    """A table of a law and of what its force takes."""
    given = _arguments("skeleton", _SKELETON, table(value, kT), kT)
    law = given.get("law", "Skalak")
    needed, allowed = _OF_LAW[law]
    _need(law, given, _SKELETON, *needed)
    for name in value:
        if name not in ("law", *needed, *allowed):
            known = ", ".join((*needed, *allowed))
            raise ValueError(f"the law {law} has no {name}; its keys are {known}")
    return given


def _need(what: str, given: Mapping[str, Any], known: Mapping[str, Any], *names: str) -> None:
    """Refuse a table without some keys."""
    for name in names:
        if known[name][0] not in given:
            raise ValueError(f"{what} needs {name}")


def _arguments(where, known, value, kT):
    """The values of a table by the names of a class."""
    arguments = {}
    for name, given in value.items():
        if name not in known:
            raise ValueError(f"there is no {name!r} in {where}; {nearest(name, known)}")
        argument, read = known[name]
        try:
            arguments[argument] = read(given, kT)
        except ValueError as reason:
            raise ValueError(f"{name}: {reason}") from None
    return arguments


def table(value: Any, kT: Any) -> Any:
    """A table, whose keys are read by themselves."""
    if not isinstance(value, dict):
        raise ValueError(f"expected a table, got {value!r}")
    return value
