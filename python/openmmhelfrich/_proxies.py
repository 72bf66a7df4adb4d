"""What the classes of ``forces`` share: C++ objects, and arguments as users have them.

SWIG's module ``_forces`` has a function for each C++ function, which takes plain numbers and lists.
The classes call these with what the functions here make of Meshes, arrays, Quantities and names.
"""

from __future__ import annotations

import numpy as np
import openmm

# OpenMM has the types on which those of the module are built.
from . import _forces, _values

__all__ = [
    "Copies",
    "constant",
    "elements",
    "number",
    "own",
    "proxy",
    "start",
    "whole",
    "why_not_helfrich",
]

_PACKAGE = f"{__package__}.forces."


def proxy(cls: type) -> type:
    """Make a class the one that SWIG has for the C++ objects of its name."""
    cls.__swig_destroy__ = getattr(_forces, f"delete_{cls.__name__}")
    getattr(_forces, f"{cls.__name__}_swigregister")(cls)
    return cls


def name_of(force) -> str:
    """The name of the class that an object has here, for messages; a user's subclass has none."""
    return next(cls.__name__ for cls in type(force).__mro__ if cls.__module__.startswith(_PACKAGE))


def number(force, argument: str, value) -> float:
    """A plain number in OpenMM's units, of a number or Quantity; see `_values.scalar`."""
    name = name_of(force)
    return _values.scalar(name, _values.scalar_of(name, argument), value)


def whole(force, argument: str, value) -> int:
    """A whole number; see `_values.whole_number`."""
    return _values.whole_number(name_of(force), argument, value)


def elements(force, argument: str, values) -> list[float]:
    """Plain numbers in OpenMM's units, one for each element; see `_values.element_values`."""
    name = name_of(force)
    return _values.element_values(name, _values.scalar_of(name, argument), values)


def constant(force, argument: str, value) -> int:
    """The number of one of the constants of a class, which may be given by name."""
    for cls in type(force).__mro__:
        known = {name: number for name, number in vars(cls).items() if type(number) is int}
        if known:
            return _values.constant(name_of(force), argument, known, value)
    raise AttributeError(f"{name_of(force)} has no constants")


def own(cast, given):
    """Hand over the ownership of what no System or Context has, from an object to its cast.

    What was read from XML belongs to the Python object that was read; without this it would die
    with that object, while the result of the cast still points to it.
    """
    if given.thisown:
        given.thisown = False
        cast.thisown = True
        # The given object stays usable, so what it points to must live as long.
        given._cast = cast
    return cast


def start(force, triangles, offset: int, **arguments) -> None:
    """Make the C++ object of a force on triangles.

    Parameters
    ----------
    force : MembraneForce
        Which has no C++ object yet.
    triangles : Mesh or array_like of int, shape (num_triangles, 3)
        Particle indices.
    offset : int
        Added to all of them.
    **arguments
        The others of the constructor, in its order. A scalar may be given as many values, one for
        each of its elements; those of `_AS_ARRAYS` are set by their setters.
    """
    name = name_of(force)
    corners = _values.triangles(name, triangles, offset)
    plain, elements = [], {}
    for argument, value in arguments.items():
        if argument in _AS_ARRAYS:
            plain.append([])
            continue
        scalar = _values.scalar_of(name, argument)
        if scalar is None:
            plain.append(constant(force, argument, value))
            continue
        if scalar.element_setter is not None and _are_many(
            _values.plain_value(f"{name}: {argument}", scalar, value)
        ):
            elements[argument] = _values.element_values(name, scalar, value)
            # Any scalar is allowed to be 1, until the values themselves are accepted.
            value = 1.0
        plain.append(_values.scalar(name, scalar, value))
    make(force, [], *plain)
    for argument in _AS_ARRAYS & arguments.keys():
        getattr(force, f"set{_values.capitalised(argument)}")(arguments[argument])
    for argument, values in elements.items():
        if not values:
            raise ValueError(f"{name}: {argument} is an empty list; give one value or many")
        # First of all, since it names what it refuses.
        _forces.MembraneForce__setElementValues(force, argument, values)
        # The scalar is not used beside them; their mean is what a reader would expect.
        getattr(force, f"set{_values.capitalised(argument)}")(float(np.mean(values)))
        _forces.MembraneForce__setElementValues(force, argument, values)
    add_triangles(force, corners)
    if getattr(triangles, "box", None) is not None:
        force.setUsesPeriodicBoundaryConditions(True)


#: What constructors take as arrays.
_AS_ARRAYS = {"particles", "reference", "domains"}


def _are_many(value) -> bool:
    """Whether there is a value for each element; lists may hold Quantities, or no numbers."""
    return isinstance(value, (list, tuple)) or np.ndim(value) > 0


def make(force, *plain) -> None:
    """Make the C++ object of plain numbers and lists."""
    name = name_of(force)
    getattr(_forces, f"{name}_swiginit")(force, getattr(_forces, f"new_{name}")(*plain))


def make_on(force, triangles, offset: int, *plain) -> None:
    """Make the C++ object of what moves on triangles, of these and plain numbers."""
    corners = _values.triangles(name_of(force), triangles, offset)
    make(force, [], *plain)
    add_triangles(force, corners)


def add_triangles(force, corners) -> None:
    """Add triangles, of an array of C integers."""
    _forces.TriangulatedForce__addTriangleBuffer(force, corners.tobytes())


def why_not_helfrich(system: openmm.System, integrator: openmm.Integrator) -> str:
    """Why a System is not one for the platform Helfrich, or an empty text."""
    return _forces._why_not_helfrich(system, integrator)


class Copies:
    """Copies, and what is unpickled, know their class.

    OpenMM's own methods make an openmm.Force, on which the methods of the class do not work.
    """

    def __setstate__(self, xml):
        self._adopt(openmm.XmlSerializer.deserialize(xml))

    def __copy__(self):
        duplicate = type(self).__new__(type(self))
        duplicate._adopt(openmm.XmlSerializer.clone(self))
        return duplicate

    def __deepcopy__(self, memo):
        return self.__copy__()

    def _adopt(self, plain):
        self.this = type(self).cast(plain).this
        self.thisown = True
        plain._cast = None
