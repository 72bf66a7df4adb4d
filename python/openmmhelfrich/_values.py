"""What arguments of the force classes mean: scalars with units, names of forms, triangles.

What the scalars are called and which units they have is asked of the core, so a new potential needs
no word here.
"""

from __future__ import annotations

import ctypes
import functools
import inspect
import math
import operator
from typing import NamedTuple

import numpy as np
from openmm import unit

from . import _core
from ._types import Array

__all__ = [
    "DENSITY",
    "FRICTION",
    "Scalar",
    "capitalised",
    "constant",
    "element_values",
    "form_name",
    "form_number",
    "plain_value",
    "scalar",
    "scalar_of",
    "scalars_of",
    "triangles",
    "whole_number",
    "whole_numbers",
]


class Scalar(NamedTuple):
    """A scalar parameter of a force class."""

    name: str
    #: The unit of plain numbers.
    unit: unit.Unit
    #: The default, or ``inspect.Parameter.empty``.
    default: object
    #: The setter for values of single elements, None if there is only the scalar.
    element_setter: str | None
    #: Whether it stands behind the form in the constructor.
    last: bool = False


class _ParameterInfo(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_char_p),
        ("energy", ctypes.c_int),
        ("length", ctypes.c_int),
        ("default", ctypes.c_double),
        ("per", ctypes.c_int),
        ("last", ctypes.c_int),
    ]


#: How the setters for values of single elements are called, by the core's code.
_ELEMENT_SETTERS = {
    0: None,
    1: "setVertex{}",
    2: "setTriangle{}s",
    3: "setParticle{}",
    4: "setEdge{}",
}


def scalars_of(force: str) -> list[Scalar]:
    """The scalars of a force class, in the order of its constructor.

    Parameters
    ----------
    force : str
        The name of the class.
    """
    core = _core.library()
    found = []
    info = _ParameterInfo()
    while core.Helfrich_Potential_parameter(force.encode(), len(found), ctypes.byref(info)) == 0:
        dimension = unit.kilojoule_per_mole**info.energy * unit.nanometer**info.length
        default = inspect.Parameter.empty if math.isnan(info.default) else info.default
        name = info.name.decode()
        setter = _ELEMENT_SETTERS[info.per]
        setter = setter and setter.format(capitalised(name))
        found.append(Scalar(name, dimension, default, setter, bool(info.last)))
    return found


#: The unit of the surface's frictions and viscosities.
FRICTION = unit.dalton / unit.picosecond
DENSITY = Scalar("density", unit.amu / unit.nanometer**2, 0.0, None)

#: The units of what movers, thermostats and integrators take.
_UNITS = {
    "attemptsPerEdge": unit.dimensionless,
    "density": DENSITY.unit,
    "friction": unit.picosecond**-1,
    "frictionCoeff": unit.picosecond**-1,
    "maxEdgeLength": unit.nanometer,
    "pullingForce": unit.kilojoule_per_mole / unit.nanometer,
    "stepSize": unit.picosecond,
    "temperature": unit.kelvin,
    "tension": unit.kilojoule_per_mole / unit.nanometer**2,
}


@functools.cache
def scalar_of(name: str, argument: str) -> Scalar | None:
    """The scalar that an argument of a class is, None if it is something else.

    Parameters
    ----------
    name : str
        The name of the class.
    argument : str
        That of the argument.
    """
    if known := scalars_of(name):
        return next((s for s in known if s.name == argument), None)
    if name == "SurfaceViscosityThermostat" and argument == "friction":
        return Scalar(argument, FRICTION, inspect.Parameter.empty, None)
    if argument not in _UNITS:
        return None
    return Scalar(argument, _UNITS[argument], inspect.Parameter.empty, None)


def capitalised(name: str) -> str:
    return name[0].upper() + name[1:]


def form_name(force: str) -> str | None:
    """What the forms of a force class are called ("scheme"), None if it has none."""
    what, name = ctypes.c_char_p(), ctypes.c_char_p()
    status = _core.library().Helfrich_Potential_form(
        force.encode(), 0, ctypes.byref(what), ctypes.byref(name)
    )
    return what.value.decode() if status == 0 else None


def plain_value(where: str, parameter: Scalar, value):
    """`value` without its unit, which must be that of the parameter."""
    if not unit.is_quantity(value):
        return value
    if not value.unit.is_compatible(parameter.unit):
        wanted = parameter.unit.get_symbol()
        raise TypeError(f"{where} must be in units of {wanted}, got {value}")
    return value.value_in_unit(parameter.unit)


def element_values(force: str, parameter: Scalar, values) -> list[float]:
    """Plain numbers, one for each vertex or triangle.

    Parameters
    ----------
    force : str
        The name of the class, for messages.
    parameter : Scalar
        What the numbers are.
    values : array_like of float, or Quantity
        In OpenMM's units if they are plain.

    Raises
    ------
    TypeError
        If the values are not numbers, or a Quantity with another dimension.
    ValueError
        If they are not one list.
    """
    where = f"{force}: {parameter.name}"
    plain = plain_value(where, parameter, values)
    if isinstance(plain, (list, tuple)):
        plain = [plain_value(where, parameter, value) for value in plain]
    try:
        array = np.asarray(plain)
    except ValueError:
        raise TypeError(f"{where} must be a list of numbers, got lists of unequal length") from None
    if array.ndim != 1:
        raise ValueError(f"{where} must be one list of numbers, got the shape {array.shape}")
    if array.size and array.dtype.kind not in "iuf":
        raise TypeError(f"{where} must be a list of numbers, got dtype {array.dtype}")
    array = array.astype(np.float64)
    return array.tolist()


def form_number(force: str, what: str, value) -> int:
    """The number of a form of a potential, of a constant such as ``GompperKroll`` or its name.

    Parameters
    ----------
    force : str
        The name of the class.
    what : str
        What its forms are called, for messages.
    value : int or str
        A constant such as ``BendingForce.GompperKroll``, or ``"GompperKroll"``.

    Raises
    ------
    TypeError, ValueError
        If the value is neither, or an unknown name.
    """
    names = {name: number for number, name in enumerate(_form_names(force))}
    return constant(force, what, names, value)


def constant(name: str, what: str, known: dict[str, int], value) -> int:
    """The number of a constant of a class, given by its number or name.

    Parameters
    ----------
    name : str
        The name of the class.
    what : str
        What its constants are, for messages.
    known : dict of str to int
        The constants.
    value : int or str
        One of them, or its name. Whether there is one of that number is for C++ to say.

    Raises
    ------
    TypeError, ValueError
        If the value is neither, or an unknown name.
    """
    if isinstance(value, str):
        if value not in known:
            raise ValueError(f"{name}: there is no {what} {value!r}; known are: {', '.join(known)}")
        return known[value]
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: {what} must be a constant of the class, got {value!r}")
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: {what} must be a constant of the class, got {value!r}") from None


def _form_names(force: str) -> list[str]:
    names = []
    what, name = ctypes.c_char_p(), ctypes.c_char_p()
    find = _core.library().Helfrich_Potential_form
    while find(force.encode(), len(names), ctypes.byref(what), ctypes.byref(name)) == 0:
        names.append(name.value.decode())
    return names


def scalar(force: str, parameter: Scalar, value) -> float:
    """A plain number in OpenMM's units.

    Parameters
    ----------
    force : str
        The name of the class, for messages.
    parameter : Scalar
        What the number is.
    value : float or Quantity
        In OpenMM's units if it is plain.

    Raises
    ------
    TypeError
        If the value is not one number, or a Quantity with another dimension.
    """
    where = f"{force}: {parameter.name}"
    value = plain_value(where, parameter, value)
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise TypeError(f"{where} must be a number, got {value!r}")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{where} must be one number, got {value!r}") from None


def whole_numbers(force: str, argument: str, one: str, given) -> Array:
    """Indices as a contiguous array of C integers, one list.

    Parameters
    ----------
    force : str
        The name of the class, for messages.
    argument : str
        What they are called there.
    one : str
        What one of them is the index of.
    given : array_like of int
        The indices.

    Raises
    ------
    TypeError
        If the indices are not integers.
    ValueError
        If they are not one list, or an index does not fit a C int.
    """
    array = np.asarray(given)
    if array.ndim != 1:
        raise ValueError(f"{force}: {argument} must be one list of indices, got {array.shape}")
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(
            f"{force}: {argument} must be integers ({one} indices), got dtype {array.dtype}"
        )
    limits = np.iinfo(np.intc)
    for index in (int(array.min()), int(array.max())) if array.size else ():
        if not limits.min <= index <= limits.max:
            raise ValueError(
                f"{force}: {one} {index} is beyond what OpenMM can number; indices are C ints"
            )
    return np.ascontiguousarray(array, dtype=np.intc)


def triangles(force: str, given, offset: int = 0) -> Array:
    """Triangles as a contiguous array of C integers, shape (num_triangles, 3).

    Parameters
    ----------
    force : str
        The name of the class, for messages.
    given : Mesh or array_like of int
        A Mesh, or particle indices of shape (num_triangles, 3).
    offset : int
        Added to every index, so that vertex ``i`` is particle ``offset + i``.

    Raises
    ------
    TypeError
        If the indices are not integers.
    ValueError
        If the shape is another, or an index does not fit a C int.
    """
    given = getattr(given, "triangles", given)
    if unit.is_quantity(given):
        raise TypeError(f"{force}: triangles are particle indices, which have no unit")
    try:
        array = np.asarray(given)
    except ValueError:
        raise ValueError(
            f"{force}: triangles must be triples of particle indices, got lists of unequal length"
        ) from None
    if array.size == 0:
        array = np.empty((0, 3), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(
            f"{force}: triangles must have shape (num_triangles, 3), got {array.shape}"
        )
    if array.dtype.kind not in "iu":
        raise TypeError(
            f"{force}: triangles must be integers (particle indices), got dtype {array.dtype}"
        )
    if isinstance(offset, bool) or not isinstance(offset, (int, np.integer)):
        raise TypeError(f"{force}: offset must be an integer, got {offset!r}")
    limits = np.iinfo(np.intc)
    # Python's integers do not wrap, as those of an array would.
    for extreme in (array.min(axis=1), array.max(axis=1)) if len(array) else ():
        for triangle in (int(np.argmin(extreme)), int(np.argmax(extreme))):
            if not limits.min <= int(extreme[triangle]) + int(offset) <= limits.max:
                indices = tuple(int(index) + int(offset) for index in array[triangle].tolist())
                raise ValueError(
                    f"{force}: triangle {triangle} has the indices {indices}, "
                    "which are beyond what OpenMM can number"
                )
    shifted = array.astype(np.int64) + int(offset)
    return np.ascontiguousarray(shifted, dtype=np.intc)


def whole_number(mover: str, name: str, value) -> int:
    """A whole number that fits a C int."""
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{mover}: {name} must be a whole number, got {value!r}")
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{mover}: {name} must be a whole number, got {value!r}") from None
    limits = np.iinfo(np.intc)
    if not limits.min <= number <= limits.max:
        raise ValueError(f"{mover}: {name} = {number} is beyond what OpenMM can count")
    return number
