"""``openmm-helfrich completion``: scripts that let shells complete commands and options."""

from __future__ import annotations

import click
from click.shell_completion import BashComplete, get_completion_class

__all__ = ["completion"]

_PROGRAM = "openmm-helfrich"
_VARIABLE = "_OPENMM_HELFRICH_COMPLETE"

_HOW = {
    "bash": 'add to ~/.bashrc: eval "$(openmm-helfrich completion bash)"',
    "zsh": 'add to ~/.zshrc, after compinit: eval "$(openmm-helfrich completion zsh)"',
    "fish": "openmm-helfrich completion fish > ~/.config/fish/completions/openmm-helfrich.fish",
}


class _Bash(BashComplete):
    """Without a look at the bash of this process, which need not be the one that completes."""

    @staticmethod
    def _check_version() -> None:
        pass


@click.command()
@click.argument("shell", type=click.Choice(list(_HOW)))
def completion(shell):
    """Print what makes SHELL complete commands and options.

    How to install it is in its first line.
    """
    from . import main

    kind = _Bash if shell == "bash" else get_completion_class(shell)
    script = kind(main, {}, _PROGRAM, _VARIABLE).source()
    click.echo(f"# To install it {_HOW[shell]}\n{script.strip()}")
