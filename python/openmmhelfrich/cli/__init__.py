"""The command line: ``openmm-helfrich run CONFIG`` and its siblings.

Each command is in a module of its own, which is imported only when that command, or the help of
all, is asked for.
"""

from __future__ import annotations

import errno
import importlib
import importlib.util
import os
import sys

import click

from .. import logs
from .._writing import describe
from ..errors import Explained
from .log_options import add_log_options

__all__ = ["main"]

# In the order of the help.
_COMMANDS = (
    "run",
    "view",
    "info",
    "compare",
    "convert",
    "mesh",
    "spectrum",
    "frames",
    "bench",
    "doctor",
    "completion",
)


class _Commands(click.Group):
    """The commands, found by name among the modules of this package."""

    def list_commands(self, context: click.Context) -> list[str]:
        found = (name for name in _COMMANDS if importlib.util.find_spec(f"{__name__}.{name}"))
        return list(found)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in self.list_commands(context):
            return None
        command = getattr(importlib.import_module(f"{__name__}.{name}"), name)
        return add_log_options(command)

    def main(self, *arguments, **options):
        """Run the program, with what it has to say on the standard error."""
        with logs.command_line():
            return super().main(*arguments, **options)

    def invoke(self, context: click.Context):
        """Run a command; errors of the system, such as a full disk, become one line.

        Errors that the documentation explains name the page.
        """
        try:
            result = super().invoke(context)
            sys.stdout.flush()
            return result
        except OSError as reason:
            # Click ends quietly where nobody reads on.
            if reason.errno == errno.EPIPE:
                raise
            # All other files are named.
            unnamed = reason.errno is not None and reason.filename is None
            if unnamed:
                _give_up_output()
            where = "standard output: " if unnamed else ""
            raise click.ClickException(where + describe(reason)) from None
        except click.ClickException as error:
            page = _page_of(error)
            if page is not None and page not in error.message:
                error.message += f"\nSee {page}"
            raise


def _page_of(error: BaseException) -> str | None:
    """The page that explains an error, or what was behind it, such as a mesh of a configuration."""
    reason = error.__context__
    while reason is not None:
        if isinstance(reason, Explained):
            return reason.page
        reason = reason.__context__
    return None


def _give_up_output() -> None:
    """Leave nothing that Python would try to write, and complain about, once more at its end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


@click.command(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="openmm-helfrich")
def main() -> None:
    """Simulate fluid membranes with OpenMM."""


add_log_options(main, hidden=False)
