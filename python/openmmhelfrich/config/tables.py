"""The tables of a document, checked against the table of keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..vcm.grammar import ConfigError, nearest
from .document import Document, Place
from .keys import REQUIRED, keys_of
from .values import table as read_table

__all__ = ["Table"]


class Table(Mapping[str, Any]):
    """The values of one table by key; those that the file does not give are the defaults.

    Parameters
    ----------
    document : Document
    place : tuple
        Where it is in the document.
    kind : str
        Which table of `KEYS` it is.
    kT : float
        Thermal energy, kJ/mol, for energies that are given in it.
    tables : sequence of str
        Names of tables inside of it, which are read by themselves.

    Raises
    ------
    ConfigError
        If a key is unknown, has a bad value, or is missing.
    """

    def __init__(
        self, document: Document, place: Place, kind: str, kT: float = 0.0, tables: Any = ()
    ) -> None:
        self._document = document
        self._place = place
        self._kind = kind
        known = keys_of(kind)
        given: Any = document.data
        for part in place:
            given = given[part] if isinstance(part, int) else given.get(part, {})
        try:
            self._given = read_table(given, kT)
        except ValueError as reason:
            raise document.error(place, str(reason)) from None
        self._values = {
            name: key.default for name, key in known.items() if key.default is not REQUIRED
        }
        for name, value in self._given.items():
            if name in tables:
                continue
            if name not in known:
                hint = nearest(name, [*known, *tables])
                raise self.error(name, f"there is no such key in {_called(kind)}; {hint}")
            try:
                self._values[name] = known[name].read(value, kT)
            except ValueError as reason:
                raise self.error(name, str(reason)) from None
        for name, key in known.items():
            if name not in self._values:
                raise self.error(name, f"it is missing, and {_called(kind)} needs it: "
                                 f"{key.meaning}")  # fmt: skip

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __iter__(self) -> Any:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def given(self, name: str) -> bool:
        """Whether the file itself gives this key."""
        return name in self._given

    def error(self, name: str | None, reason: str) -> ConfigError:
        """The exception for a fault in a key, or in the table as a whole."""
        place = self._place if name is None else (*self._place, name)
        return self._document.error(place, reason)


def _called(kind: str) -> str:
    return "[[vesicle]]" if kind == "vesicle" else f"[{kind}]"
