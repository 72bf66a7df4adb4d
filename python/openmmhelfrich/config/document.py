"""A TOML file with the lines of its keys, so that an error can say where it is."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from .._types import File
from ..vcm.grammar import ConfigError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["Document"]

# Where a value is: names of tables and keys, and positions in arrays of tables.
Place = tuple[str | int, ...]

_KEY = r"""(?:[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*"|'[^']*')"""
_DOTTED = rf"{_KEY}(?:\s*\.\s*{_KEY})*"
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]")
_ASSIGNMENT = re.compile(rf"\s*({_DOTTED})\s*=")
# A comment, a string of any kind, the beginning of one of several lines, a bracket.
_TOKEN = re.compile(
    r'''#.*|"""|\'\'\'|"(?:[^"\\]|\\.)*"|'[^']*'|[\[\]{}]''',
)


class Document:
    """The contents of a TOML file.

    Parameters
    ----------
    path : str or Path

    Attributes
    ----------
    path : Path
    data : dict
        The values, as tomllib reads them.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ConfigError
        If it is not TOML; the message has the line.
    """

    def __init__(self, path: File) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise FileNotFoundError(f"openmmhelfrich.config: there is no file {self.path}")
        try:
            text = self.path.read_text(encoding="utf-8-sig")
        except UnicodeDecodeError as reason:
            raise ConfigError(f"{self.path}:1: not a text file in UTF-8: {reason}") from None
        try:
            self.data: dict[str, Any] = tomllib.loads(text)
        except tomllib.TOMLDecodeError as reason:
            said = str(reason)
            found = re.search(r"\(at line (\d+)", said)
            line = found.group(1) if found else len(text.splitlines())
            raise ConfigError(f"{self.path}:{line}: not valid TOML: {said}") from None
        except RecursionError:
            depths = [line.count("[") + line.count("{") for line in text.splitlines()]
            line = depths.index(max(depths)) + 1
            raise ConfigError(
                f"{self.path}:{line}: arrays or tables are nested too deeply"
            ) from None
        except ValueError:
            # Python refuses thousands of digits before TOML is asked.
            digits = [
                max(map(len, re.findall(r"[\d_]+", line)), default=0) for line in text.splitlines()
            ]
            line = digits.index(max(digits)) + 1
            raise ConfigError(
                f"{self.path}:{line}: an integer has {max(digits)} digits; write it as a float"
            ) from None
        self._lines = _lines_of(text)

    def line(self, place: Place) -> int:
        """The line of a key, or of the nearest table around it."""
        while place and place not in self._lines:
            place = place[:-1]
        return self._lines.get(place, 1)

    def error(self, place: Place, reason: str) -> ConfigError:
        """The exception for a fault at a place, with file, line and key."""
        name = ""
        for part in place:
            name += f"[{part}]" if isinstance(part, int) else f".{part}" if name else part
        return ConfigError(f"{self.path}:{self.line(place)}: key {name}: {reason}")


def _lines_of(text: str) -> dict[Place, int]:
    """The line of every table header and every key that begins a line; the text is valid TOML."""
    lines: dict[Place, int] = {}
    counts: dict[Place, int] = {}
    table: Place = ()
    quote, depth = None, 0
    for number, line in enumerate(text.splitlines(), start=1):
        if quote is None and depth == 0:
            header, key = _HEADER.match(line), _ASSIGNMENT.match(line)
            if header:
                table = _resolve(_names(header.group(2)), counts)
                if header.group(1) == "[[":
                    counts[table] = counts.get(table, 0) + 1
                    table = (*table, counts[table] - 1)
                lines.setdefault(table, number)
                continue
            if key:
                names = _names(key.group(1))
                for end in range(1, len(names) + 1):
                    lines.setdefault((*table, *names[:end]), number)
        quote, depth = _scan(line, quote, depth)
    return lines


def _names(dotted: str) -> tuple[str, ...]:
    """The parts of a dotted key, without quotes."""
    value: Any = tomllib.loads(f"{dotted} = 0")
    names = []
    while isinstance(value, dict):
        ((name, value),) = value.items()
        names.append(name)
    return tuple(names)


def _resolve(names: tuple[str, ...], counts: dict[Place, int]) -> Place:
    """The place of a header: inside an array of tables it means the last of them."""
    place: Place = ()
    for position, name in enumerate(names):
        place = (*place, name)
        if place in counts and position < len(names) - 1:
            place = (*place, counts[place] - 1)
    return place


def _scan(line: str, quote: str | None, depth: int) -> tuple[str | None, int]:
    """Whether the next line begins inside of a string, and inside of how many brackets."""
    at = 0
    while at < len(line):
        if quote is not None:
            end = line.find(quote, at)
            if end < 0:
                return quote, depth
            quote, at = None, end + len(quote)
            continue
        token = _TOKEN.search(line, at)
        if token is None:
            break
        at = token.end()
        if token.group() in ('"""', "'''"):
            quote = token.group()
        elif token.group() in "[{":
            depth += 1
        elif token.group() in "]}":
            depth -= 1
    return quote, depth
