"""Energy expressions of OpenMM's Custom forces: parsed, evaluated on arrays, differentiated.

OpenMM takes seconds to minutes to differentiate and compile the long expressions of a bending
energy. To find out what an expression *means* we only need its values, at many places, so it is
parsed here and evaluated with numpy on all places at once; gradients come by the reverse mode.

The language is that of Lepton, OpenMM's parser: ``+ - * / ^``, the functions of `FUNCTIONS`,
definitions after semicolons which may use the definitions that follow them, and in forces between
particles the variables ``x1, y1, z1, …`` and the functions ``distance``, ``angle`` and
``dihedral`` of ``p1, p2, …``.

An expression becomes a list of operations without repetitions, each on the results of earlier
ones. Lists rather than trees, because the longest expressions are too deep for recursion.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from math import pi
from typing import Any

import numpy as np
from scipy import special

from .._types import Array
from .expression_parser import ExpressionError, Parser

__all__ = ["FUNCTIONS", "Expression", "ExpressionError"]


def _power(base, exponent):
    return np.power(base, exponent)


def _power_slopes(value, base, exponent):
    # The slope by the exponent is wanted only where the base is positive.
    with np.errstate(all="ignore"):
        by_exponent = np.where(base > 0, value * np.log(np.where(base > 0, base, 1.0)), 0.0)
    return exponent * np.power(base, exponent - 1.0), by_exponent


def _where(condition, yes, no):
    return np.where(condition != 0, yes, no)


# name: (value, slopes); the slopes take the value first, then the arguments.
_OPERATIONS = {
    "+": (np.add, lambda v, a, b: (1.0, 1.0)),
    "-": (np.subtract, lambda v, a, b: (1.0, -1.0)),
    "*": (np.multiply, lambda v, a, b: (b, a)),
    "/": (np.divide, lambda v, a, b: (1.0 / b, -v / b)),
    "^": (_power, _power_slopes),
    "neg": (np.negative, lambda v, a: (-1.0,)),
    "sqrt": (np.sqrt, lambda v, a: (0.5 / v,)),
    "exp": (np.exp, lambda v, a: (v,)),
    "log": (np.log, lambda v, a: (1.0 / a,)),
    "sin": (np.sin, lambda v, a: (np.cos(a),)),
    "cos": (np.cos, lambda v, a: (-np.sin(a),)),
    "tan": (np.tan, lambda v, a: (1.0 + v * v,)),
    "sec": (lambda a: 1.0 / np.cos(a), lambda v, a: (v * np.tan(a),)),
    "csc": (lambda a: 1.0 / np.sin(a), lambda v, a: (-v / np.tan(a),)),
    "cot": (lambda a: 1.0 / np.tan(a), lambda v, a: (-1.0 - v * v,)),
    "asin": (np.arcsin, lambda v, a: (1.0 / np.sqrt(1.0 - a * a),)),
    "acos": (np.arccos, lambda v, a: (-1.0 / np.sqrt(1.0 - a * a),)),
    "atan": (np.arctan, lambda v, a: (1.0 / (1.0 + a * a),)),
    "atan2": (np.arctan2, lambda v, a, b: (b / (a * a + b * b), -a / (a * a + b * b))),
    "sinh": (np.sinh, lambda v, a: (np.cosh(a),)),
    "cosh": (np.cosh, lambda v, a: (np.sinh(a),)),
    "tanh": (np.tanh, lambda v, a: (1.0 - v * v,)),
    "erf": (special.erf, lambda v, a: (2.0 / np.sqrt(pi) * np.exp(-a * a),)),
    "erfc": (special.erfc, lambda v, a: (-2.0 / np.sqrt(pi) * np.exp(-a * a),)),
    "square": (np.square, lambda v, a: (2.0 * a,)),
    "cube": (lambda a: a * a * a, lambda v, a: (3.0 * a * a,)),
    "recip": (lambda a: 1.0 / a, lambda v, a: (-v * v,)),
    "step": (lambda a: np.where(a >= 0, 1.0, 0.0), lambda v, a: (0.0,)),
    "delta": (lambda a: np.where(a == 0, 1.0, 0.0), lambda v, a: (0.0,)),
    "min": (np.minimum, lambda v, a, b: (np.where(a < b, 1.0, 0.0), np.where(a < b, 0.0, 1.0))),
    "max": (np.maximum, lambda v, a, b: (np.where(a > b, 1.0, 0.0), np.where(a > b, 0.0, 1.0))),
    "abs": (np.abs, lambda v, a: (np.where(a >= 0, 1.0, -1.0),)),
    "floor": (np.floor, lambda v, a: (0.0,)),
    "ceil": (np.ceil, lambda v, a: (0.0,)),
    "select": (_where, lambda v, a, b, c: (0.0, _where(a, 1.0, 0.0), _where(a, 0.0, 1.0))),
}
_OPERATORS = frozenset("+-*/^")
#: The functions of an expression that take numbers.
FUNCTIONS = frozenset(_OPERATIONS) - _OPERATORS - {"neg"}
# Which side of a branch was taken, for the operations that have branches.
_SIDES = {
    "step": lambda a: a >= 0,
    "delta": lambda a: a == 0,
    "abs": lambda a: a >= 0,
    "min": lambda a, b: a < b,
    "max": lambda a, b: a > b,
    "select": lambda a, b, c: a != 0,
}


class Expression:
    """An energy expression as a list of operations.

    Parameters
    ----------
    text : str
        The expression, with its definitions.
    num_points : int
        The number of particles of a bond, 0 where there are none.
    given : dict, optional
        Names that stand for a formula, such as ``{"theta": "dihedral(p1,p2,p3,p4)"}`` for a
        torsion. Definitions in the text go before them.

    Raises
    ------
    ExpressionError
        If it cannot be parsed or has an unknown function, such as a tabulated one.
    """

    #: The functions that take numbers.
    FUNCTIONS = FUNCTIONS

    def __init__(self, text: str, num_points: int = 0, given: Mapping[str, str] | None = None):
        self.text = text
        self._num_points = num_points
        #: (operation, arguments): a "number" has a value, a "variable" a name.
        self._list: list[tuple[str, tuple[Any, ...]]] = []
        self._numbers: dict[tuple[str, tuple[Any, ...]], int] = {}
        self._seen: dict[int, set[bool]] = {}
        definitions: dict[str, int] = {}
        for name, formula in (given or {}).items():
            definitions[name] = Parser(self, formula, {}).whole()
        parts = text.split(";")
        for part in reversed(parts[1:]):
            if not part.strip():
                continue
            name, equals, formula = part.partition("=")
            if not equals:
                raise ExpressionError(f"{part.strip()!r} defines nothing")
            definitions[name.strip()] = Parser(self, formula, definitions).whole()
        self._result = Parser(self, parts[0], definitions).whole()
        self._used = self._needed()

    def _needed(self) -> list[int]:
        """The operations that the result depends on, in order."""
        needed = {self._result}
        for number in range(self._result, -1, -1):
            operation, arguments = self._list[number]
            if number in needed and operation not in ("number", "variable"):
                needed.update(arguments)
        return sorted(needed)

    def add(self, operation: str, *arguments: Any) -> int:
        """The number of an operation, which is new only if it was not there before."""
        key = (operation, arguments)
        if key not in self._numbers:
            self._numbers[key] = len(self._list)
            self._list.append(key)
        return self._numbers[key]

    def operation(self, number: int) -> tuple[str, tuple[Any, ...]]:
        """An operation and the numbers of its arguments."""
        return self._list[number]

    def coordinate(self, axis: str, point: int) -> int:
        """The operation that reads one coordinate."""
        if not 1 <= point <= self._num_points:
            raise ExpressionError(f"{axis}{point}: there are {self._num_points} particles")
        return self.add("variable", f"{axis}{point}")

    @property
    def size(self) -> int:
        """The number of operations."""
        return len(self._used)

    @property
    def variables(self) -> set[str]:
        """The names of all variables that the value depends on."""
        return {self._list[i][1][0] for i in self._used if self._list[i][0] == "variable"}

    def _constants(self) -> dict[int, float]:
        """The operations that no variable is in, with their values."""
        constant: dict[int, float] = {}
        for number in self._used:
            operation, arguments = self._list[number]
            if operation == "number":
                constant[number] = arguments[0]
            elif operation != "variable" and all(a in constant for a in arguments):
                with np.errstate(all="ignore"):
                    constant[number] = float(
                        _OPERATIONS[operation][0](*(np.float64(constant[a]) for a in arguments))
                    )
        return constant

    def _only_of(self, names: Collection[str]) -> set[int]:
        """The operations that no variables but these are in, and at least one of them."""
        constants, found = self._constants(), set()
        for number in self._used:
            operation, arguments = self._list[number]
            if operation == "variable":
                if arguments[0] in names:
                    found.add(number)
            elif number not in constants and all(a in found or a in constants for a in arguments):
                found.add(number)
        return found

    @property
    def literals(self) -> list[float]:
        """The numbers written in the expression, and those computed of them."""
        return sorted({abs(v) for v in self._constants().values() if np.isfinite(v) and v != 0})

    def _values(self, variables: Mapping[str, Array | float], watch: bool) -> dict[str, Any]:
        values: dict[int, Array] = {}
        with np.errstate(all="ignore"):
            for number in self._used:
                operation, arguments = self._list[number]
                if operation == "number":
                    values[number] = np.float64(arguments[0])
                elif operation == "variable":
                    if arguments[0] not in variables:
                        raise ExpressionError(f"the variable {arguments[0]!r} has no value")
                    values[number] = np.asarray(variables[arguments[0]], dtype=float)
                else:
                    given = [values[a] for a in arguments]
                    values[number] = _OPERATIONS[operation][0](*given)
                    if watch and operation in _SIDES:
                        sides = np.asarray(_SIDES[operation](*given))
                        seen = self._seen.setdefault(number, set())
                        seen.update(np.unique(sides).tolist())
        return values

    def evaluate(self, variables: Mapping[str, Array | float]) -> Array:
        """The values for arrays of variables.

        Which branches of ``step``, ``select`` and their like were taken is remembered.
        """
        return self._values(variables, watch=True)[self._result]

    def gradient(self, variables: Mapping[str, Array | float]) -> tuple[Array, dict[str, Array]]:
        """The values, and their derivatives by each variable (reverse mode)."""
        values = self._values(variables, watch=False)
        slopes: dict[int, Array] = {self._result: np.float64(1.0)}
        result: dict[str, Array] = {}
        with np.errstate(all="ignore"):
            for number in reversed(self._used):
                if number not in slopes:
                    continue
                operation, arguments = self._list[number]
                slope = slopes.pop(number)
                if operation == "variable":
                    result[arguments[0]] = slope
                elif operation != "number":
                    given = [values[a] for a in arguments]
                    parts = _OPERATIONS[operation][1](values[number], *given)
                    for argument, part in zip(arguments, parts, strict=True):
                        if self._list[argument][0] != "number":
                            slopes[argument] = slopes.get(argument, 0.0) + slope * part
        return values[self._result], result

    def forget_branches(self) -> None:
        """Forget which branches were taken."""
        self._seen.clear()

    def untested_branches(self, parameters: Collection[str] = ()) -> list[str]:
        """The operations with branches of which `evaluate` has met only one side.

        Harmless ones are left out: an absolute value whose argument has one sign, a ``min`` or
        ``max`` with 0, 1 or −1, which are there to catch rounding, and what constants decide.

        Parameters
        ----------
        parameters : collection of str
            Variables that may get any value later, so that nothing is harmless of what they alone
            decide.
        """
        found, constants = [], self._constants()
        free = self._only_of(parameters)
        for number in self._used:
            operation, arguments = self._list[number]
            decided = number in constants or (operation == "select" and arguments[0] in constants)
            if operation in ("floor", "ceil") and not decided:
                found.append(operation)
            if operation not in _SIDES or len(self._seen.get(number, ())) == 2:
                continue
            clamp = any(
                self._list[a][0] == "number" and abs(self._list[a][1][0]) in (0.0, 1.0)
                for a in arguments
            )
            harmless = operation == "abs" or (operation in ("min", "max") and clamp)
            if decided or (harmless and number not in free):
                continue
            found.append(operation)
        return found
