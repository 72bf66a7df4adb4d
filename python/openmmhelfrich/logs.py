"""What the package says while it works: the logger ``openmmhelfrich`` of Python's `logging`.

Results go to the standard output and errors are exceptions; all else that may be worth a line, from
a file that is computed again to each checkpoint, is a record of this logger or one below it
(``openmmhelfrich.run``, ``openmmhelfrich.sweep``). A program that has set up logging gets them as
those of any package. In others warnings go to the standard error, or whatever the environment
variable ``HELFRICH_LOG`` names: debug, info, warning, error or critical.
"""

from __future__ import annotations

import contextlib
import logging
import os
import sys
from collections.abc import Iterator

__all__ = ["LEVELS", "VARIABLE", "command_line", "level_of", "logger", "quiet", "set_level"]

#: The names of levels, from those that say the most on.
LEVELS = ("debug", "info", "warning", "error", "critical")
#: The environment variable that names one.
VARIABLE = "HELFRICH_LOG"

_NAME = "openmmhelfrich"


class _OnStandardError(logging.Handler):
    """Lines such as ``Warning: what happened``, beside the progress bars of this process.

    alone: whether nobody else shows these records. If not, they are left to the handlers of the
    program, if it has any.
    """

    alone = False

    def emit(self, record: logging.LogRecord) -> None:
        if not self.alone and logging.getLogger().handlers:
            return
        from tqdm import tqdm

        try:
            tqdm.write(f"{record.levelname.capitalize()}: {self.format(record)}", sys.stderr)
        except Exception:
            self.handleError(record)


_root = logging.getLogger(_NAME)
_handler = _OnStandardError()
# Names of levels that the environment variable had, and that there are not.
_refused: set[str] = set()


def logger(part: str | None = None) -> logging.Logger:
    """The logger of the package, or of a part of it, such as ``"run"``."""
    return _root if part is None else _root.getChild(part)


def level_of(name: str) -> int:
    """The number of a level.

    Raises
    ------
    ValueError
        No name of a level.
    """
    if not isinstance(name, str) or name.lower() not in LEVELS:
        raise ValueError(f"there is no level {name!r}; there are {', '.join(LEVELS)}")
    return int(getattr(logging, name.upper()))


def set_level(name: str) -> None:
    """Show records of this level and above, whatever the environment variable says.

    Raises
    ------
    ValueError
        No name of a level.

    Examples
    --------
    >>> set_level("info")
    """
    _root.setLevel(level_of(name))


def quiet() -> bool:
    """Whether not even warnings are shown, so that progress should not be either."""
    return not _root.isEnabledFor(logging.WARNING)


@contextlib.contextmanager
def command_line() -> Iterator[None]:
    """For as long as it is entered, show records of the package as a command does.

    That is on the standard error, from warnings on unless the environment variable or `set_level`
    say otherwise, and nowhere else.
    """
    before = _handler.alone, _root.propagate, _root.level
    _handler.alone, _root.propagate = True, False
    _root.setLevel(logging.WARNING)
    _obey_environment()
    try:
        yield
    finally:
        _handler.alone, _root.propagate = before[:2]
        _root.setLevel(before[2])


def _obey_environment() -> None:
    """Set the level that the environment variable names; a wrong name is a warning."""
    name = os.environ.get(VARIABLE)
    if not name:
        return
    try:
        set_level(name)
    except ValueError as reason:
        # A command asks twice: when the package is imported, and when it begins.
        if name not in _refused:
            _root.warning("%s: %s", VARIABLE, reason)
        _refused.add(name)


if _handler not in _root.handlers:
    _root.addHandler(_handler)
    _obey_environment()
