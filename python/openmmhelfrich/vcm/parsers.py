"""From the words after a key to a value.

A parser is a function of a tuple of words. It returns the value, or raises ValueError with what
is wrong with them; the caller adds file, line and key.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from .._mesh.transformations import LARGEST_L
from .._types import Array
from .grammar import nearest

__all__ = [
    "Interval",
    "LockOn",
    "Parser",
    "Surface",
    "boolean",
    "choice",
    "deformation",
    "flag_and_number",
    "integer",
    "interval",
    "lock_on",
    "number",
    "one_word",
    "outputs",
    "pressure",
    "random_deformation",
    "surface",
    "value_or",
    "vector",
]

Parser = Callable[[tuple[str, ...]], Any]


class Interval(NamedTuple):
    """When to report: every `fs` femtoseconds, or at intervals that grow by a `factor`.

    `reports` is the number of growing intervals in the whole simulation, if the file gives that
    rather than the factor.
    """

    fs: float = 0.0
    factor: float = 0.0
    reports: int = 0


class Surface(NamedTuple):
    """Which potentials act on areas and heights.

    area: "global", "local" or ""; min_height: nm, 0 if there is no repulsion of heights;
    min_area: nm², 0 if there is no repulsion of areas.
    """

    area: str = ""
    min_height: float = 0.0
    min_area: float = 0.0


class LockOn(NamedTuple):
    """The surface that holds the vertices: "", "Sphere", "Ellipsoid" or "ULM2_0", amplitude u."""

    shape: str = ""
    amplitude: float = 0.0


def _count(words: tuple[str, ...], *counts: int) -> None:
    if len(words) not in counts:
        expected = " or ".join(str(count) for count in counts)
        plural = "" if counts == (1,) else "s"
        got = repr(" ".join(words)) if words else "none"
        raise ValueError(f"expected {expected} value{plural}, got {got}")


def _plain(word: str) -> str:
    """A word that may be a number; ValueError at what only Python takes for one, such as 1_000."""
    if not word.isascii() or "_" in word:
        raise ValueError(word)
    return word


def _float(word: str) -> float:
    try:
        value = float(_plain(word))
    except ValueError:
        raise ValueError(f"expected a number, got {word!r}") from None
    if not math.isfinite(value):
        raise ValueError(f"expected a finite number, got {word!r}")
    return value


def _int(word: str) -> int:
    try:
        return int(_plain(word))
    except ValueError:
        raise ValueError(f"expected an integer, got {word!r}") from None


def _bounded(value: float, least: float | None, zero: bool) -> float:
    if least is not None and (value < least or (value == least and not zero)):
        bound = f"{least:g} or more" if zero else f"more than {least:g}"
        raise ValueError(f"expected {bound}, got {value:g}")
    return value


def one_word(words: tuple[str, ...]) -> str:
    """Any single word, such as a name."""
    _count(words, 1)
    return words[0]


def number(least: float | None = None, zero: bool = True) -> Parser:
    """One finite number, not below `least`, nor equal to it unless `zero`."""

    def parse(words: tuple[str, ...]) -> float:
        _count(words, 1)
        return _bounded(_float(words[0]), least, zero)

    return parse


def integer(least: int = 0) -> Parser:
    """One integer, not below `least`."""

    def parse(words: tuple[str, ...]) -> int:
        _count(words, 1)
        return int(_bounded(_int(words[0]), least, True))

    return parse


def boolean(words: tuple[str, ...]) -> bool:
    """``true`` or ``false``."""
    _count(words, 1)
    known = {"true": True, "false": False}
    if words[0].lower() not in known:
        raise ValueError(f"expected true or false, got {words[0]!r}; {nearest(words[0], known)}")
    return known[words[0].lower()]


def flag_and_number(words: tuple[str, ...]) -> tuple[bool, float | None]:
    """``true`` or ``false``, and perhaps a number."""
    _count(words, 1, 2)
    return boolean(words[:1]), _float(words[1]) if len(words) == 2 else None


def vector(length: int = 3, zero: bool = True) -> Parser:
    """Several finite numbers, none of them 0 unless `zero`."""

    def parse(words: tuple[str, ...]) -> Array:
        _count(words, length)
        values = np.array([_float(word) for word in words])
        if not zero and not values.all():
            raise ValueError(f"expected numbers other than 0, got {' '.join(words)!r}")
        return values

    return parse


def pressure(words: tuple[str, ...]) -> tuple[float, ...]:
    """One pressure, or one per axis."""
    _count(words, 1, 3)
    return tuple(_float(word) for word in words) * (3 if len(words) == 1 else 1)


def choice(known: Mapping[str, Any]) -> Parser:
    """One of several words; the value is what the mapping has for it."""

    def parse(words: tuple[str, ...]) -> Any:
        _count(words, 1)
        if words[0] not in known:
            raise ValueError(f"there is no {words[0]!r}; {nearest(words[0], known)}")
        return known[words[0]]

    return parse


def value_or(*names: str, least: float = 0.0, zero: bool = False) -> Parser:
    """A number, or one of the words that stand for numbers of the mesh."""

    def parse(words: tuple[str, ...]) -> float | str:
        _count(words, 1)
        if words[0] in names:
            return words[0]
        try:
            value = _float(words[0])
        except ValueError:
            listed = " or ".join(names)
            raise ValueError(f"expected a number or {listed}, got {words[0]!r}") from None
        return _bounded(value, least, zero)

    return parse


def outputs(*names: str) -> Parser:
    """Several of the names of outputs, or N alone for none."""

    def parse(words: tuple[str, ...]) -> frozenset[str]:
        if not words:
            raise ValueError("expected the names of outputs, or N; known are " + ", ".join(names))
        if words == ("N",):
            return frozenset()
        for word in words:
            if word not in names:
                raise ValueError(f"there is no output {word!r}; {nearest(word, (*names, 'N'))}")
        return frozenset(words)

    return parse


def interval(words: tuple[str, ...]) -> Interval:
    """A time in fs, ``EXP x`` or ``EXP Step n``."""
    if words[:1] != ("EXP",):
        return Interval(fs=number(0, zero=False)(words))
    if words[1:2] == ("Step",):
        return Interval(reports=integer(1)(words[2:]))
    factor = number()(words[1:])
    if not factor > 1:
        raise ValueError(f"expected EXP and a factor above 1, got {words[1]!r}")
    return Interval(factor=factor)


_SURFACES = {
    "N": ("", None),
    "G": ("global", None),
    "L": ("local", None),
    "GWCAH": ("global", "min_height"),
    "LWCAH": ("local", "min_height"),
    "WCAH": ("", "min_height"),
    "GWCA": ("global", "min_area"),
    "WCA": ("", "min_area"),
}


def surface(words: tuple[str, ...]) -> Surface:
    """N, G, L, or one of the names with WCA and a height or an area."""
    _count(words, 1, 2)
    if words[0] not in _SURFACES:
        raise ValueError(f"there is no {words[0]!r}; {nearest(words[0], _SURFACES)}")
    area, bound = _SURFACES[words[0]]
    if bound is None:
        _count(words, 1)
        return Surface(area)
    if len(words) != 2:
        what = "height in nm" if bound == "min_height" else "area in nm²"
        raise ValueError(f"{words[0]} needs a least {what} after it, as in '{words[0]} 20'")
    return Surface(area, **{bound: _bounded(_float(words[1]), 0, False)})


def lock_on(words: tuple[str, ...]) -> LockOn:
    """N, Sphere, Ellipsoid, or ULM2_0 and its amplitude."""
    _count(words, 1, 2)
    known = ("N", "Sphere", "Ellipsoid", "ULM2_0")
    if words[0] not in known:
        raise ValueError(f"there is no {words[0]!r}; {nearest(words[0], known)}")
    _count(words, 2 if words[0] == "ULM2_0" else 1)
    if words[0] == "N":
        return LockOn()
    return LockOn(words[0], _float(words[1]) if len(words) == 2 else 0.0)


def deformation(words: tuple[str, ...]) -> tuple[float, int, int]:
    """Amplitude u, degree l and order m of one spherical harmonic."""
    _count(words, 3)
    amplitude, l, m = _float(words[0]), _int(words[1]), _int(words[2])
    if l < 0 or abs(m) > l:
        raise ValueError(f"expected u l m with l of 0 or more and -l ≤ m ≤ l, got l {l}, m {m}")
    return amplitude, l, m


def random_deformation(words: tuple[str, ...]) -> tuple[int, float, int]:
    """Number n of random harmonics, their amplitude u, and the largest degree."""
    _count(words, 3)
    count, amplitude, lmax = _int(words[0]), _float(words[1]), _int(words[2])
    if count < 0 or not 2 <= lmax <= LARGEST_L:
        raise ValueError(
            f"expected n u lmax with n ≥ 0 and lmax from 2 to {LARGEST_L}, got n {count}, "
            f"lmax {lmax}"
        )
    return count, amplitude, lmax
