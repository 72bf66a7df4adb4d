"""The grammar of OpenMM's energy expressions (Lepton's), by precedence climbing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from .expressions import Expression

__all__ = ["ExpressionError", "Parser", "tokens"]

# OpenMM knows no others: what else is white, or a digit of another script, is a part of a name.
_SPACES, _DIGITS = " \t\n\v\f\r", "0123456789"
_NUM_POINTS = {"distance": 2, "angle": 3, "dihedral": 4}
_NUM_ARGUMENTS = {"atan2": 2, "min": 2, "max": 2, "select": 3}


class ExpressionError(ValueError):
    """An expression that cannot be parsed, or that uses what is not known here."""


def tokens(text: str) -> list[str]:
    """Numbers, names, operators, brackets and commas."""
    tokens, at, end = [], 0, len(text)
    while at < end:
        c = text[at]
        if c in _SPACES:
            at += 1
            continue
        start = at
        if c in "+-*/^(),":
            at += 1
        elif c in _DIGITS or c == ".":
            while at < end and (text[at] in _DIGITS or text[at] == "."):
                at += 1
            if at < end and text[at] in "eE":
                after = at + 1 + (at + 1 < end and text[at + 1] in "+-")
                if after < end and text[after] in _DIGITS:
                    at = after
                    while at < end and text[at] in _DIGITS:
                        at += 1
        else:
            while at < end and text[at] not in _SPACES and text[at] not in "+-*/^(),":
                at += 1
        tokens.append(text[start:at])
    return tokens


class Parser:
    """One formula, without its definitions, into operations."""

    _PRECEDENCE: ClassVar = {"+": 0, "-": 0, "*": 1, "/": 1, "^": 3}

    def __init__(self, target: Expression, text: str, definitions: Mapping[str, int]) -> None:
        self._target = target
        self._tokens = tokens(text)
        self._definitions = definitions
        self._at = 0

    def whole(self) -> int:
        """The number of the operation that is the value of the formula."""
        try:
            result = self._operation(0)
        except RecursionError:
            raise ExpressionError("its brackets are too deep") from None
        if self._at != len(self._tokens):
            raise ExpressionError(f"unexpected {self._tokens[self._at]!r}")
        return result

    def _next(self) -> str:
        if self._at >= len(self._tokens):
            raise ExpressionError("it ends too early")
        self._at += 1
        return self._tokens[self._at - 1]

    def _peek(self) -> str:
        return self._tokens[self._at] if self._at < len(self._tokens) else ""

    def _operation(self, lowest: int) -> int:
        left = self._operand()
        while (precedence := self._PRECEDENCE.get(self._peek(), -1)) >= lowest:
            operator = self._next()
            # Powers bind from the right.
            right = self._operation(precedence + (operator != "^"))
            left = self._target.add(operator, left, right)
        return left

    def _operand(self) -> int:
        token = self._next()
        if token == "-":
            # A sign binds less than a power, and more than a product.
            inner = self._operation(2)
            operation, arguments = self._target.operation(inner)
            if operation == "number":
                return self._target.add("number", -arguments[0])
            return self._target.add("neg", inner)
        if token == "(":
            inner = self._operation(0)
            self._expect(")")
            return inner
        if token[0] in _DIGITS or token[0] == ".":
            try:
                return self._target.add("number", float(token))
            except ValueError:
                raise ExpressionError(f"{token!r} is no number") from None
        if token in "+*/^),":
            raise ExpressionError(f"unexpected {token!r}")
        if self._peek() == "(":
            return self._function(token)
        if token in self._definitions:
            return self._definitions[token]
        return self._target.add("variable", token)

    def _expect(self, wanted: str) -> None:
        if (token := self._next()) != wanted:
            raise ExpressionError(f"{wanted!r} expected, got {token!r}")

    def _function(self, name: str) -> int:
        self._expect("(")
        if name in _NUM_POINTS:
            return self._of_points(name, [self._point() for _ in range(_NUM_POINTS[name])])
        arguments = []
        while True:
            arguments.append(self._operation(0))
            if self._peek() != ",":
                break
            self._next()
        self._expect(")")
        if name.startswith("point") and name[5:] in _NUM_POINTS:
            if len(arguments) != 3 * _NUM_POINTS[name[5:]]:
                raise ExpressionError(f"{name}() has {len(arguments)} arguments")
            corners = [tuple(arguments[i : i + 3]) for i in range(0, len(arguments), 3)]
            return self._of_points(name[5:], corners)
        if name not in self._target.FUNCTIONS:
            raise ExpressionError(f"the function {name}() is not known here")
        if len(arguments) != _NUM_ARGUMENTS.get(name, 1):
            raise ExpressionError(f"{name}() has {len(arguments)} arguments")
        return self._target.add(name, *arguments)

    def _point(self) -> tuple[int, int, int]:
        token = self._next()
        # More digits than these no particle has, and Python refuses thousands of them.
        if token[0] != "p" or not token.isascii() or not token[1:].isdigit() or len(token) > 20:
            raise ExpressionError(f"{token!r} is no particle")
        if self._peek() in (",", ")"):
            self._next()
        return tuple(self._target.coordinate(axis, int(token[1:])) for axis in "xyz")

    def _of_points(self, name: str, points: list[tuple[int, int, int]]) -> int:
        add = self._target.add

        def minus(a, b):
            return tuple(add("-", i, j) for i, j in zip(a, b, strict=True))

        def dot(a, b):
            x, y, z = (add("*", i, j) for i, j in zip(a, b, strict=True))
            return add("+", add("+", x, y), z)

        def cross(a, b):
            return tuple(
                add("-", add("*", a[i], b[j]), add("*", a[j], b[i]))
                for i, j in ((1, 2), (2, 0), (0, 1))
            )

        def length(a):
            return add("sqrt", dot(a, a))

        if name == "distance":
            return length(minus(points[0], points[1]))
        if name == "angle":
            u, v = minus(points[0], points[1]), minus(points[2], points[1])
            return add("atan2", length(cross(u, v)), dot(u, v))
        u, v, w = (minus(points[i + 1], points[i]) for i in range(3))
        first, second = cross(u, v), cross(v, w)
        sine = add("*", length(v), dot(u, second))
        return add("atan2", sine, dot(first, second))
