"""The grammar of VCM's configuration files: words, lines, sections, inheritance.

A file is lines of words. A word that starts with ``#`` begins a comment. A line whose first word
starts with ``-`` and a letter opens a section, as ``-Membrane 0``; a fourth word names an earlier
section of the same kind, whose lines the new one inherits. The lines of most sections are a key and
its values; those of ``-InteractionTable`` are a label and a row of a triangular table.

Nothing here knows a key: `keys` does.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from .._types import File

__all__ = ["ConfigError", "ConfigWarning", "Entry", "Section", "near", "nearest", "read_sections"]

GENERAL, MEMBRANE, TABLE = "GeneralParameters", "Membrane", "InteractionTable"
_SUPPORTED = (GENERAL, MEMBRANE, TABLE)
# VCM has these sections too, for parts of a cell that are no membranes.
_FOREIGN = ("Actin", "ECM", "Chromatin")


class ConfigError(ValueError):
    """A configuration file cannot be used.

    The message starts with the file and the line, ``file:line:``, names the key or section, and
    says what is wrong and what would be right.
    """


class ConfigWarning(UserWarning):
    """A line of a configuration file was skipped; the message says which and why."""


@dataclass(frozen=True)
class Entry:
    """One line of a section: its first word, the words after it, and where it stands.

    `after_comment` says whether the line before it is a comment and nothing else.
    """

    key: str
    words: tuple[str, ...]
    path: Path
    line: int
    after_comment: bool = False

    def error(self, reason: str) -> ConfigError:
        """The exception for a fault in this line."""
        return ConfigError(f"{self.path}:{self.line}: key {self.key}: {reason}")


@dataclass
class Section:
    """One section, with the lines that it inherits.

    `entries` holds the lines by key; a table keeps its lines, which may repeat a label, in `rows`.
    """

    kind: str
    label: str
    path: Path
    line: int
    entries: dict[str, Entry] = field(default_factory=dict)
    inherited: frozenset[str] = frozenset()
    rows: list[Entry] = field(default_factory=list)

    def error(self, reason: str) -> ConfigError:
        """The exception for a fault of the section as a whole."""
        return ConfigError(f"{self.path}:{self.line}: section -{self.kind}: {reason}")

    def add(self, entry: Entry) -> None:
        """Take one more line; a key of the section itself may come only once."""
        if self.kind == TABLE:
            self.rows.append(entry)
            return
        before = self.entries.get(entry.key)
        if before is not None and entry.key not in self.inherited:
            raise entry.error(f"it was given before, in line {before.line}; keep one of the two")
        self.inherited -= {entry.key}
        self.entries[entry.key] = entry


def near(word: str, known: Iterable[str]) -> str | None:
    """The known word that looks most like this one, whatever the case; None if none does."""
    by_lower = {name.lower(): name for name in known}
    found = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[found[0]] if found else None


def nearest(word: str, known: Iterable[str]) -> str:
    """The known word that looks most like this one, as the end of a message.

    Parameters
    ----------
    word : str
        What was found.
    known : iterable of str
        What would have been right.

    Returns
    -------
    str
        ``"did you mean X?"``, or ``"known are A, B"`` if nothing is near.
    """
    known = list(known)
    found = near(word, known)
    if found:
        return f"did you mean {found}?"
    return "known are " + ", ".join(known)


def _words(line: str) -> list[str]:
    """The words of a line, up to one that starts with ``#``."""
    words = line.split()
    for index, word in enumerate(words):
        if word.startswith("#"):
            return words[:index]
    return words


def _is_header(word: str) -> bool:
    return len(word) > 1 and word[0] == "-" and word[1].isalpha()


def read_sections(path: File) -> list[Section]:
    """The sections of a file, in their order, inheritance done.

    Parameters
    ----------
    path : str or Path
        The configuration file.

    Returns
    -------
    list of Section

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ConfigError
        If a line precedes the first section, if a section is unknown, of a kind that is not
        supported, repeated where there can be one only, or inherits from one that is not there; if
        a key comes twice in a section.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"openmmhelfrich.vcm: there is no file {path}")
    if path.suffix.lower() == ".toml":
        raise ConfigError(
            f"{path}:1: this is TOML, not a VCM configuration; config.read takes it, as do "
            "the commands run and info"
        )
    sections: list[Section] = []
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    lines = text.splitlines()
    for number, line in enumerate(lines, start=1):
        words = _words(line)
        if not words:
            continue
        after_comment = number > 1 and lines[number - 2].lstrip().startswith("#")
        if _is_header(words[0]):
            sections.append(_open(words, sections, path, number))
        elif not sections:
            raise ConfigError(
                f"{path}:{number}: key {words[0]}: it stands before the first section; start the "
                f"file with -{GENERAL}"
            )
        else:
            sections[-1].add(Entry(words[0], tuple(words[1:]), path, number, after_comment))
    if not any(section.kind == MEMBRANE for section in sections):
        raise ConfigError(f"{path}:1: there is no section -{MEMBRANE}, so nothing to simulate")
    return sections


def _open(words: list[str], sections: list[Section], path: Path, line: int) -> Section:
    """The section that a header line opens."""
    kind = words[0][1:]
    where = f"{path}:{line}: section -{kind}"
    if kind in _FOREIGN:
        raise ConfigError(
            f"{where}: only membranes are simulated here; take the section out, or run the file "
            "with VCM"
        )
    if kind not in _SUPPORTED:
        hint = nearest(f"-{kind}", [f"-{name}" for name in _SUPPORTED])
        raise ConfigError(f"{where}: there is no such section; {hint}")
    same = [section for section in sections if section.kind == kind]
    if same and kind != MEMBRANE:
        raise ConfigError(f"{where}: it was opened before, in line {same[0].line}")
    label = words[1] if len(words) > 1 else str(len(same))
    for section in same:
        if section.label == label:
            raise ConfigError(
                f"{where}: the label {label} was used before, in line {section.line}; labels tell "
                "membranes apart"
            )
    if len(words) == 3 or len(words) > 4:
        raise ConfigError(
            f"{where}: expected a label, or a label, a word and the label of the section to "
            f"inherit from, got {' '.join(words[1:])!r}"
        )
    if len(words) < 4:
        return Section(kind, label, path, line)
    parents = {section.label: section for section in same}
    if words[3] not in parents:
        hint = nearest(words[3], parents) if parents else "there is none before it"
        raise ConfigError(f"{where}: no section -{kind} {words[3]} to inherit from; {hint}")
    entries = dict(parents[words[3]].entries)
    return Section(kind, label, path, line, entries, frozenset(entries))
