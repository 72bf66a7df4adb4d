"""The values of one section of a configuration, checked against the table of keys."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

from .grammar import (
    GENERAL,
    MEMBRANE,
    ConfigError,
    ConfigWarning,
    Entry,
    Section,
    near,
    nearest,
)
from .keys import Key, keys_of

__all__ = ["Settings"]


class Settings(Mapping[str, Any]):
    """The values of one section, by key; those that the file does not give are the defaults.

    Parameters
    ----------
    section : Section
        As the file has it.
    ignore_unknown : bool
        Skip unknown keys, as VCM does after a prompt, instead of refusing them.

    Raises
    ------
    ConfigError
        If a key is unknown, or its value is wrong.
    """

    def __init__(self, section: Section | None, kind: str, ignore_unknown: bool = False):
        known = keys_of(kind)
        self._entries: dict[str, Entry] = {} if section is None else section.entries
        self._section = section
        # Only a mesh has no default; whoever needs it asks `given`.
        self._values = {
            key.name: key.value(tuple(key.default.split())) for key in known.values() if key.default
        }
        for name, entry in self._entries.items():
            if name not in known:
                if _wrapped_comment(entry, known):
                    text = " ".join((name, *entry.words))
                    warnings.warn(
                        f"{entry.path}:{entry.line}: skipped {text!r}, which looks like the end of "
                        "the comment above it; put # before it",
                        ConfigWarning,
                        stacklevel=4,
                    )
                    continue
                if ignore_unknown:
                    continue
                raise entry.error(_unknown(name, kind))
            try:
                self._values[name] = known[name].value(entry.words)
            except ValueError as reason:
                raise entry.error(str(reason)) from None

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __iter__(self) -> Any:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def given(self, name: str) -> bool:
        """Whether the file itself gives this key."""
        return name in self._entries

    def error(self, name: str, reason: str) -> ConfigError:
        """The exception for the value of a key, at its line, or at the section's if not given."""
        if name in self._entries:
            return self._entries[name].error(reason)
        if self._section is None:
            return ConfigError(f"key {name}: {reason}")
        return ConfigError(
            f"{self._section.path}:{self._section.line}: key {name} (not given, default "
            f"{keys_of(self._section.kind)[name].default or 'none'}): {reason}"
        )


def _wrapped_comment(entry: Entry, known: Mapping[str, Key]) -> bool:
    """Whether a line is the rest of a long comment that an editor has broken.

    The paper's own files have such lines. A line counts as one if it follows a comment, reads as
    prose (several words and no number) and begins with no word that resembles a key.
    """
    prose = len(entry.words) >= 2 and not any(_is_number(word) for word in entry.words)
    return entry.after_comment and prose and near(entry.key, known) is None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _unknown(name: str, kind: str) -> str:
    for other in (GENERAL, MEMBRANE):
        if other != kind and name in keys_of(other):
            return f"it belongs in a section -{other}, not in -{kind}"
    known = list(keys_of(kind))
    hint = nearest(name, known)
    if hint.startswith("known"):
        # All fifty of them would bury the message.
        hint = "see the table of keys in docs/vcm.md"
    return f"there is no such key in -{kind}; {hint}"
