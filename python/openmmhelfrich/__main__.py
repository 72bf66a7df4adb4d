"""``python -m openmmhelfrich``: the same as the command ``openmm-helfrich``."""

from .cli import main

main(prog_name="openmm-helfrich")
