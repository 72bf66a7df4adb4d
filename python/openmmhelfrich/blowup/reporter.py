"""Says of a Simulation why it broke down."""

from __future__ import annotations

from typing import Any

import openmm

from .._numbers import positive_number, whole_number
from .._surface_reporters import NextReport
from .._types import File
from .diagnosis import BlowUpError
from .moments import Limits
from .watch import Watch

__all__ = ["BlowUpReporter"]


class BlowUpReporter:
    """Explains how a Simulation broke down, and keeps its last good frame.

    At each report it remembers the Context, and notes energies, temperature, the triangle that is
    least high and the edge that is bent most. If a step fails, or energies are not finite, or a
    limit is passed, the steps since the last report are taken again, one by one, and the message of
    the error tells what they show: since when which triangle or edge was out of the ordinary, how
    long a time step may be there (`stable_time_step`), and what to do. Then the Context is where it
    was at the last report.

    Steps fail inside of ``simulation.step``, where reporters are not asked. Take them in a ``with``
    block of the reporter, or, in a notebook, call `explain` afterwards.

    Parameters
    ----------
    folder : str or Path
        Where to write, if it breaks down: ``report.txt``, what the message says; ``history.csv``,
        all that was noted; ``last-good.ply`` and ``last.ply``, the surface at the last good step
        and at the last whole one, with the least height of the triangles around each vertex (nm);
        ``last-good.state``, which `load_state` reads. With several surfaces they have numbers,
        ``last-good-0.ply``.
    reportInterval : int
        Steps between looks, 1 or more. A look costs about an evaluation of the forces and, for 1000
        vertices, 0.5 ms.
    maxTemperature : float, optional
        K, of all particles of the System. Default: no limit.
    minHeight : float, optional
        nm, of triangles. Default: no limit.
    maxFold : float, optional
        Degrees by which an edge may be bent: 0 where it is flat, 180 where its triangles lie upon
        each other. Default: no limit.

    Raises
    ------
    ValueError
        A number out of range.
    BlowUpError
        When the Simulation has broken down. It is an ``openmm.OpenMMException``.

    Examples
    --------
    >>> watch = helfrich.BlowUpReporter("blow-up", 1000)
    >>> simulation.reporters.append(watch)
    >>> with watch:
    ...     simulation.step(1_000_000)
    """

    def __init__(
        self,
        folder: File,
        reportInterval: int,
        *,
        maxTemperature: float | None = None,
        minHeight: float | None = None,
        maxFold: float | None = None,
    ) -> None:
        given = {"maxTemperature": maxTemperature, "minHeight": minHeight, "maxFold": maxFold}
        self._folder = folder
        self._interval = whole_number(reportInterval, "BlowUpReporter", "reportInterval", 1)
        self._limits = Limits(
            *(
                None if value is None else positive_number(value, "BlowUpReporter", name)
                for name, value in given.items()
            )
        )
        self._context = self._watch = None

    def describeNextReport(self, simulation: Any) -> Any:
        """When the next report is due, as OpenMM asks for it."""
        if simulation.context is not self._context:
            self._context = simulation.context
            self._watch = Watch(
                simulation.context, simulation.integrator, self._limits, self._folder
            )
            self._watch.look()
        steps = self._interval - simulation.currentStep % self._interval
        return NextReport(steps=steps, periodic=False, include=[])

    def report(self, simulation: Any, state: Any) -> None:
        """Look at the Simulation."""
        self._watch.look()

    def explain(self, reason: str = "the simulation broke down") -> BlowUpError:
        """Why the Simulation broke down, after one of its steps has failed.

        Parameters
        ----------
        reason : str or Exception
            What has been noticed: the first line of the message.

        Returns
        -------
        BlowUpError

        Raises
        ------
        RuntimeError
            No step of a Simulation with this reporter was taken yet.
        """
        if self._watch is None:
            raise RuntimeError(
                "BlowUpReporter: there is nothing to explain yet; append it to "
                "simulation.reporters, then take steps"
            )
        return self._watch.explain(str(reason))

    def __enter__(self) -> Any:
        return self

    def __exit__(self, kind: Any, reason: Any, traceback: Any) -> None:
        if self._watch is None or isinstance(reason, BlowUpError):
            return
        # Reporters say with a ValueError that a number is not finite.
        failed = isinstance(reason, openmm.OpenMMException) or (
            isinstance(reason, ValueError) and not self._watch.is_whole
        )
        if failed:
            raise self.explain(reason) from reason
