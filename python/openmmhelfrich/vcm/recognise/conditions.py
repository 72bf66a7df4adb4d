"""Which global parameters must be fixed for forces that are ours at their present values only.

An expression with a cutoff of its own, ``step(hc - h)``, is a repulsion of ours where hc = 2^¼ s
and nowhere else. Such a force is read with all of its global parameters as numbers. Then they are
set free again, one by one, and last those that others are multiples of, or of a power: where hc
follows s, s is free.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from .fixed import Fixed, in_words, is_root, is_simple
from .reader import Plans, Reader
from .source import all_parameters, is_pi
from .term import Refused, Term

__all__ = ["Condition", "Search"]

# The likeliest powers first: a length of another, an area of a length, a prefactor's exponent.
_POWERS = (1, 2, -1, 0.5, 4, 8, -2, 3)
_MAX_GUESSES = 60

Check = Callable[[list[int], list[Term], Plans], None]


@dataclass(frozen=True)
class Condition:
    """Forces that are one of ours when some global parameters are fixed.

    sources: their indices; force_class: of ours; fixed: what is fixed, by name; words: the same to
    be read; obstacle: why they cannot be replaced even then, or empty.
    """

    sources: tuple[int, ...]
    force_class: str
    fixed: dict[str, Fixed]
    words: str
    obstacle: str

    def __str__(self) -> str:
        text = f"it is {self.force_class} where {self.words}"
        if self.obstacle:
            return f"{text}, but it could not be replaced even so: {self.obstacle}"
        return f"{text}; to replace it, freeze {', '.join(self.fixed)}"


class Search:
    """Conditions for forces of one System.

    Parameters
    ----------
    reader : Reader
        Of the forces.
    frozen : list of str
        The parameters that the user wants fixed, which are never set free.
    lost : callable
        Raises Refused if forces replaced by terms under plans lose a parameter that they need.
    derivatives : callable
        Raises Refused if they lose a derivative.
    """

    def __init__(self, reader: Reader, frozen: list[str], lost: Check, derivatives: Check) -> None:
        self._reader = reader
        self._frozen = frozen
        self._lost = lost
        self._derivatives = derivatives

    def conditions(self, left: Iterable[int]) -> Iterator[Condition]:
        """For those of some forces that have one."""
        left = list(left)
        parameters = {i: self._parameters([i]) for i in left}
        plans = {i: _numbers(its) for i, its in parameters.items()}
        for terms in self._reader.recognise(left, plans).found:
            sources = sorted({i for term in terms for i in term.sources})
            values = self._parameters(sources)
            if values and self._works(sources, _numbers(values)):
                fixed = self._loosened(sources, values)
                if fixed:
                    yield self._condition(sources, fixed)

    def _parameters(self, indices: list[int]) -> dict[str, float]:
        """Those of forces that vary."""
        result: dict[str, float] = {}
        for index in indices:
            result |= all_parameters(self._reader.forces[index])
        return {
            name: value
            for name, value in result.items()
            if np.isfinite(value) and (not is_pi(value) or name in self._frozen)
        }

    def _plans(self, sources: list[int], fixed: Mapping[str, Fixed]) -> Plans:
        return {i: plan_of(self._reader.forces[i], fixed) for i in sources}

    def _terms(self, sources: list[int], fixed: Mapping[str, Fixed]) -> list[list[Term]] | None:
        """Terms in place of all of the forces, or None."""
        plans = self._plans(sources, fixed)
        found = self._reader.recognise(sources, plans, all_or_nothing=True).found
        if {i for terms in found for term in terms for i in term.sources} != set(sources):
            return None
        try:
            for terms in found:
                self._lost(sorted({i for term in terms for i in term.sources}), terms, plans)
        except Refused:
            return None
        return found

    def _works(self, sources: list[int], fixed: Mapping[str, Fixed]) -> bool:
        return self._terms(sources, fixed) is not None

    def _loosened(self, sources: list[int], values: dict[str, float]) -> dict[str, Fixed]:
        """As few parameters fixed as possible, and as few of them at numbers."""
        fixed = _numbers(values)
        for name in values:
            if name not in self._frozen:
                fewer = {n: f for n, f in fixed.items() if n != name}
                if self._works(sources, fewer):
                    fixed = fewer
        for base in list(fixed):
            if base in self._frozen or fixed[base].base or not fixed[base].value:
                continue
            others = [n for n, f in fixed.items() if n != base and not f.base and f.value]
            # What the user wants fixed follows sooner than what nobody asked for.
            others.sort(key=lambda name: name not in self._frozen)
            choices = [[fixed[name], *_followers(fixed[name], fixed[base])] for name in others]
            rest = {n: f for n, f in fixed.items() if n != base}
            for guess in islice(_guesses(choices), _MAX_GUESSES):
                followed = rest | {f.name: f for f in guess}
                if self._works(sources, followed):
                    fixed = followed
                    break
        return fixed

    def _condition(self, sources: list[int], fixed: dict[str, Fixed]) -> Condition:
        found = self._terms(sources, fixed)
        obstacle = ""
        try:
            for terms in found:
                self._derivatives(sources, terms, self._plans(sources, fixed))
        except Refused as reason:
            obstacle = str(reason)
        terms = [term for terms in found for term in terms]
        classes = dict.fromkeys(term.force_class for term in terms)
        words = " and ".join(
            str(f) if f.base else f"{f}{_as_a_multiple(f.value, terms)}" for f in fixed.values()
        )
        return Condition(tuple(sources), " and ".join(classes), fixed, words, obstacle)


def plan_of(force: Any, fixed: Mapping[str, Fixed]) -> dict[str, Fixed]:
    """What of all that is fixed concerns one force."""
    return {name: fixed[name] for name in all_parameters(force) if name in fixed}


def _numbers(values: Mapping[str, float]) -> dict[str, Fixed]:
    return {name: Fixed(name, value) for name, value in values.items()}


def _followers(fixed: Fixed, base: Fixed) -> list[Fixed]:
    """A parameter as simple multiples of powers of another one, the likelier ones first."""
    candidates = (
        Fixed(fixed.name, fixed.value, base.name, base.value, power)
        for power in _POWERS
        if base.value > 0 or power == int(power)
    )
    return [f for f in candidates if is_simple(f.factor)]


def _guesses(choices: list[list[Fixed]]) -> Iterator[list[Fixed]]:
    """One of each list of choices, but not the first of all, the likelier combinations first."""
    start = (0,) * len(choices)
    queue, seen = [(0, start)], {start}
    while queue:
        _, indices = heapq.heappop(queue)
        if any(indices):
            yield [its[i] for its, i in zip(choices, indices, strict=True)]
        for at, its in enumerate(choices):
            following = (*indices[:at], indices[at] + 1, *indices[at + 1 :])
            if following[at] < len(its) and following not in seen:
                seen.add(following)
                heapq.heappush(queue, (sum(following), following))


def _as_a_multiple(value: float, terms: list[Term]) -> str:
    """Which of our scalars a number is, or is 2^¼ times, if that is no coincidence."""
    for term in terms:
        for key, scalar in term.scalars.items():
            if scalar.values is None and is_root(value / (scalar.value or np.nan)):
                return f" ({in_words(value / scalar.value, key)})"
    return ""
