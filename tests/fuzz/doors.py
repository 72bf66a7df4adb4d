"""What a door is: where inputs come from, how they change, and what is wrong with an answer."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random

from mutations import text

__all__ = ["Door", "Wrong", "attempt", "folder", "shared_files"]


class Wrong(AssertionError):
    """An answer that is no error of ours, and wrong."""


@dataclass(frozen=True)
class Door:
    """One way for data to come in.

    name: on the command line and in the table
    seeds: inputs that are right
    check: raises anything if an input gets a wrong answer
    change: makes another input of one
    """

    name: str
    seeds: Callable[[], Iterable[bytes]]
    check: Callable[[bytes], None]
    change: Callable[[bytes, Random], bytes] = text


def attempt(action: Callable, errors, *names: str):
    """What an action gives; None if it is refused as documented, by a message with all names."""
    try:
        # Numbers that overflow on the way are no answer.
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            return action()
    except errors as reason:
        said = str(reason)
        missing = [name for name in names if name not in said]
        if missing or not said.strip():
            raise Wrong(f"the message does not name {missing}: {said!r}") from reason
        return None


@cache
def _temporary() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory(prefix="fuzz-")


def folder() -> Path:
    """A folder for the files of this process."""
    return Path(_temporary().name)


def shared_files(pattern: str) -> list[Path]:
    """Reference files that are not part of the project; none where they are not there."""
    beside = Path(__file__).resolve().parents[3] / "shared"
    return sorted(Path(os.environ.get("HELFRICH_SHARED", beside)).glob(pattern))
