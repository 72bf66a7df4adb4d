"""Simulations that show themselves in notebooks."""

from __future__ import annotations

import sys

import openmm
from openmm import app

from .._present import surfaces_of
from ..mesh import MOST_SHOWN
from .views import view

__all__ = ["register"]


def register() -> None:
    """Let the notebook in which this is imported, if it is one, draw the membranes of Simulations.

    OpenMM's class is not ours to change, but IPython can be told how to show it. Simulations
    without membranes stay as they are.
    """
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    formatter = getattr(shell, "display_formatter", None)
    if formatter is not None:
        formatter.formatters["text/html"].for_type(app.Simulation, _shown)


def _shown(simulation: app.Simulation) -> str | None:
    """The page of a Simulation; None for what has no membrane, no positions yet, or too many."""
    if simulation.system.getNumParticles() > MOST_SHOWN or not surfaces_of(simulation.context):
        return None
    try:
        return view(simulation)._repr_html_()
    except (ValueError, openmm.OpenMMException):
        return None
