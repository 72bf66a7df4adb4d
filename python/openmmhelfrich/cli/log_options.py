"""Options of all commands: how much to say beside the results."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import click

from .. import logs

__all__ = ["add_log_options"]


def _say_more(context: click.Context, parameter: click.Parameter, count: int) -> None:
    if count:
        logs.set_level("info" if count == 1 else "debug")


def _say_less(context: click.Context, parameter: click.Parameter, wanted: bool) -> None:
    if wanted:
        logs.set_level("error")


def _say(context: click.Context, parameter: click.Parameter, level: str | None) -> None:
    if level is not None:
        logs.set_level(level)


def _options(hidden: bool) -> Iterator[click.Option]:
    """New options; the one that is given last counts."""
    common: dict[str, Any] = {"expose_value": False, "hidden": hidden}
    yield click.Option(
        ["-v", "--verbose"],
        count=True,
        callback=_say_more,
        help="Say what is done, on the standard error; -vv: in detail. Also behind the command.",
        **common,
    )
    yield click.Option(
        ["-q", "--quiet"],
        is_flag=True,
        callback=_say_less,
        help="No progress and no warnings, only results and errors.",
        **common,
    )
    yield click.Option(
        ["--log-level"],
        type=click.Choice(logs.LEVELS, case_sensitive=False),
        metavar="LEVEL",
        callback=_say,
        help=f"{', '.join(logs.LEVELS)}. Default: the environment variable {logs.VARIABLE}, or "
        "warning.",
        **common,
    )


def add_log_options(command: click.Command, hidden: bool = True) -> click.Command:
    """Give a command, and those below it, the options; their help need not repeat them."""
    if not any(parameter.name == "log_level" for parameter in command.params):
        command.params.extend(_options(hidden))
    if isinstance(command, click.Group):
        for other in command.commands.values():
            add_log_options(other)
    return command
