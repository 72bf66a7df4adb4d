"""What the commands share: arguments, and errors as a user should see them."""

from __future__ import annotations

import contextlib
import json
import math
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from .. import logs

__all__ = [
    "check_platform",
    "config_argument",
    "json_option",
    "platform_option",
    "print_json",
    "reader_options",
    "tidy_errors",
]

config_argument = click.argument("config", type=click.Path(path_type=Path, dir_okay=False))


def check_platform(context: click.Context, parameter: click.Parameter, name: str | None) -> Any:
    """The name of a platform as OpenMM spells it; click calls this for an option."""
    if name is None:
        return None
    from .. import platforms

    try:
        return platforms.find(name)
    except ValueError as reason:
        raise click.BadParameter(str(reason)) from None


platform_option = click.option(
    "--platform",
    metavar="NAME",
    callback=check_platform,
    help="OpenMM platform: Helfrich (the default for membranes, mostly the fastest), CPU (the "
    "default where pairs of particles interact), Reference, OpenCL, CUDA or HIP. "
    "'openmm-helfrich info CONFIG' says which would be used, and why.",
)

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object, for programs."
)


def print_json(values: dict[str, Any]) -> None:
    """Print values as a JSON object; numbers that are not finite become null."""
    click.echo(json.dumps(_plain(values), indent=2, ensure_ascii=False, allow_nan=False))


def _plain(value):
    """A value of what JSON has."""
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "item"):  # NumPy's scalars
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def reader_options(command: Any) -> Any:
    """The options that `vcm.read` has."""
    command = click.option(
        "--ignore-unknown", is_flag=True, help="Skip keys that do not exist, as VCM does."
    )(command)
    return click.option(
        "--vcm-compatible",
        is_flag=True,
        help="Follow VCM's quirks, to compare with its old numbers.",
    )(command)


@contextlib.contextmanager
def tidy_errors() -> Iterator[None]:
    """Errors of the configuration and the run as one line, without a traceback."""
    from ..simulation.runner import RunError
    from ..vcm.grammar import ConfigError, ConfigWarning

    log, shown = logs.logger("run"), set()

    def show(message, category, filename, lineno, file=None, line=None) -> None:
        # A run that is resumed reads its configuration twice.
        if str(message) not in shown:
            log.warning("%s", message)
        shown.add(str(message))

    with warnings.catch_warnings():
        warnings.simplefilter("always", ConfigWarning)
        warnings.showwarning = show
        try:
            yield
        except (ConfigError, RunError) as reason:
            raise click.ClickException(str(reason)) from None
