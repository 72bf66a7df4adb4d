"""The command line: ``openmm-helfrich run CONFIG`` and its siblings.

Each command is in a module of its own, which is imported only when that command, or the help of
all, is asked for.
"""

from __future__ import annotations

import importlib
import importlib.util

import click

__all__ = ["main"]

# In the order of the help.
_COMMANDS = ("run", "info", "compare", "convert", "mesh", "spectrum", "bench")


class _Commands(click.Group):
    """The commands, found by name among the modules of this package."""

    def list_commands(self, context: click.Context) -> list[str]:
        found = (name for name in _COMMANDS if importlib.util.find_spec(f"{__name__}.{name}"))
        return list(found)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in self.list_commands(context):
            return None
        return getattr(importlib.import_module(f"{__name__}.{name}"), name)


@click.command(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="openmm-helfrich")
def main() -> None:
    """Simulate fluid membranes with OpenMM."""
