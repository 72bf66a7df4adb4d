"""Simulations that are measured in turns: what `steps.py` and `native_steps.py` share."""

import sys

from openmm import unit
from openmmhelfrich._benchmark import Steps, fastest

__all__ = ["add_options", "energy", "measure", "say"]


def add_options(parser, repeats):
    """Add the options `--repeats`, `--seconds` and `--jax-python`."""
    parser.add_argument(
        "--repeats", type=int, default=repeats, help="runs of each (default: %(default)d)"
    )
    parser.add_argument(
        "--seconds", type=float, default=0.3, help="length of a run, s (default: %(default)g)"
    )
    parser.add_argument(
        "--jax-python", default=sys.executable, help="a Python with jax and jax-md, if not this one"
    )


def say(text):
    """Show on a terminal what is going on, in place of what was shown before."""
    if sys.stderr.isatty():
        print(f"\r{text:78.78s}\r", end="", file=sys.stderr, flush=True)


def energy(context, vesicle):
    """Potential energy at the positions of the mesh, kJ/mol."""
    now = context.getState(positions=True).getPositions(asNumpy=True)
    context.setPositions(vesicle.mesh.vertices)
    state = context.getState(energy=True)
    context.setPositions(now)
    return state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)


def measure(contexts, n, options, least=5):
    """Least µs per step of Contexts, by their names.

    Parameters
    ----------
    contexts : dict of openmm.Context
    n : int
        How many particles they have, for messages.
    options : argparse.Namespace
        With `repeats` and `seconds`.
    least : int
        Least number of steps in a run.

    Raises
    ------
    SystemExit
        If an energy is not finite after the steps.
    """
    steppers = {name: Steps(context) for name, context in contexts.items()}
    cost = fastest(steppers, options.repeats, options.seconds, least)
    for name, stepper in steppers.items():
        try:
            stepper.check()
        except FloatingPointError as reason:
            sys.exit(f"steps: {name}, N = {n}: {reason}")
    return cost
