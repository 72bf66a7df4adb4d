"""Global parameters that do not vary by themselves: numbers, or multiples of powers of others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

__all__ = ["Fixed", "formulas", "in_words", "is_root", "is_simple", "remaining"]

# Within this a factor is the simple number that it is shown as; values may have been printed with
# six decimals.
_SAME = 1e-7
_LARGEST = 12
_QUARTERS = {1: "¼", 2: "½", 3: "¾"}


@dataclass(frozen=True)
class Fixed:
    """A global parameter that is a number, or a multiple of a power of another one, the base.

    name, value: its name and default; base, base_value: those of the other one, with an empty name
    where there is none; power: of the base.
    """

    name: str
    value: float
    base: str = ""
    base_value: float = 1.0
    power: float = 1.0

    @property
    def factor(self) -> float:
        """What the power of the base is multiplied by."""
        with np.errstate(all="ignore"):
            return float(self.value / np.float64(self.base_value) ** self.power)

    @property
    def formula(self) -> str:
        """The parameter as an expression."""
        if not self.base:
            return repr(self.value)
        if self.power == 1:
            return f"{self.factor!r}*{self.base}"
        return f"{self.factor!r}*{self.base}^({self.power!r})"

    def __str__(self) -> str:
        if not self.base:
            return f"{self.name} = {self.value:.9g}"
        return f"{self.name} = {in_words(self.factor, self.base, self.power)}"


def formulas(fixed: Mapping[str, Fixed]) -> dict[str, str]:
    """What names stand for in an expression."""
    return {name: its.formula for name, its in fixed.items()}


def remaining(parameters: Mapping[str, float], fixed: Mapping[str, Fixed]) -> dict[str, float]:
    """The global parameters that an energy depends on when some are fixed, with their defaults."""
    bases = {
        fixed[name].base: fixed[name].base_value
        for name in parameters
        if name in fixed and fixed[name].base
    }
    return {name: value for name, value in parameters.items() if name not in fixed} | bases


def in_words(factor: float, name: str, power: float = 1.0) -> str:
    """A multiple of a power, such as 2^¼ s."""
    if power != 1:
        name = f"{name}^{power:g}"
    number = _simple(factor) or f"{factor:.9g}"
    return {"1": name, "-1": f"-{name}"}.get(number, f"{number} {name}")


def is_simple(factor: float) -> bool:
    """Whether a number is one that people choose: a small integer or its inverse, or a root."""
    return bool(_simple(factor))


def is_root(factor: float) -> bool:
    """Whether a number is 2^¼, 2^½ or 2^¾ times a power of two, as cutoffs are of lengths."""
    return "2^" in _simple(factor)


def _simple(factor: float) -> str:
    if not np.isfinite(factor):
        return ""
    sign, size = ("-" if factor < 0 else ""), abs(factor)
    for number in range(1, _LARGEST + 1):
        if abs(size - number) <= _SAME * number:
            return f"{sign}{number}"
        if abs(size * number - 1) <= _SAME:
            return sign + {2: "½", 4: "¼"}.get(number, f"1/{number}")
    for quarters in range(-16, 17):
        if quarters % 4 and abs(size - 2 ** (quarters / 4)) <= _SAME * size:
            whole, part = divmod(abs(quarters), 4)
            minus = "-" if quarters < 0 else ""
            return f"{sign}2^{minus}{whole or ''}{_QUARTERS[part]}"
    return ""
