"""Pages that follow a run."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from openmm import unit

from .._numbers import whole_number
from .._surface_reporters import NextReport
from .._types import File
from .page import page
from .scene import Scene
from .sources import add_context
from .views import embedded, write_page

__all__ = ["LivePage", "LiveView"]

# Beyond that, every second frame is left out: a page that is written often has to be small.
_MOST_FRAMES = 200
# Least seconds between two pages, and of all time the share that they may take.
_SECONDS = 3.0
_SHARE = 0.1


class LivePage:
    """A page that is written anew while its scene grows, and that looks for the next one itself.

    Parameters
    ----------
    path : str or Path
        Of the HTML file; another page of the viewer is overwritten.
    scene : Scene
        To which frames are added.
    """

    def __init__(self, path: File, scene: Scene) -> None:
        self.path = Path(path)
        self.scene = scene
        self._key = f"openmm-helfrich {secrets.token_hex(8)}"
        self._due = 0.0

    def update(self, add: Callable[[], None]) -> None:
        """Call what adds a frame, and show it, unless that was done some seconds ago."""
        begin = time.monotonic()
        if begin < self._due:
            return
        add()
        self._show(_SECONDS)
        end = time.monotonic()
        self._due = end + max(_SECONDS, (end - begin) / _SHARE)

    def finish(self, add: Callable[[], None]) -> None:
        """Add the last frame, and write the page as it stays."""
        add()
        self._show(None)

    def _show(self, reload: float | None) -> None:
        if len(self.scene.frames) > _MOST_FRAMES:
            self.scene.thin()
        self._put(reload)

    def _put(self, reload: float | None) -> None:
        write_page(self.path, self.scene, reload, self._key)


class _Cell(LivePage):
    """The same in a cell of a notebook."""

    def __init__(self, scene: Scene):
        super().__init__("", scene)
        try:
            from IPython import get_ipython
            from IPython.display import HTML, display
        except ImportError as reason:
            raise ImportError(
                f"LiveView: a view in a notebook needs IPython; give file= instead ({reason})"
            ) from None
        if get_ipython() is None:
            raise ValueError("LiveView: there is no notebook here; give file=")
        self._html, self._display = HTML, display
        self._handle = None

    def _put(self, reload: float | None) -> None:
        shown = self._html(embedded(page(self.scene, key=self._key)))
        if self._handle is None:
            self._handle = self._display(shown, display_id=True)
        else:
            self._handle.update(shown)


class LiveView:
    """Shows all membranes of a Simulation as it runs: a reporter for notebooks, or for a page.

    In a notebook the cell in which the run starts has the view, which is updated every few seconds;
    with `file` there is a page that updates itself in any browser. Reports in between cost nothing,
    and views a tenth of the time at most.

    Parameters
    ----------
    reportInterval : int
        Steps from one report to the next.
    file : str or Path, optional
        The HTML file to write. Default: show it in the notebook.

    Raises
    ------
    ImportError
        No file is given, and IPython is not installed.
    ValueError
        No file is given, and there is no notebook; at the first report, if the System has no
        membrane force.

    Examples
    --------
    >>> live = LiveView(1000)
    >>> simulation.reporters.append(live)
    >>> simulation.step(100_000)
    >>> live.finish(simulation)
    """

    def __init__(self, reportInterval: int, file: File | None = None) -> None:
        self._interval = whole_number(reportInterval, "LiveView", "reportInterval", 1)
        self.scene = Scene("simulation")
        self._page = _Cell(self.scene) if file is None else LivePage(file, self.scene)

    def describeNextReport(self, simulation: Any) -> Any:
        """When the next report is due, as OpenMM asks for it."""
        steps = self._interval - simulation.currentStep % self._interval
        return NextReport(steps=steps, periodic=False, include=[])

    def report(self, simulation: Any, state: Any) -> None:
        """Show the present frame if the last one was shown some seconds ago."""
        self._page.update(lambda: self._add(simulation))

    def finish(self, simulation: Any) -> None:
        """Show the present frame; a page no longer looks for a newer one."""
        self._page.finish(lambda: self._add(simulation))

    def _add(self, simulation) -> None:
        state = simulation.context.getState(energy=True)
        energies = {
            "potential": state.getPotentialEnergy(),
            "kinetic": state.getKineticEnergy(),
        }
        values = {name: energy / unit.kilojoule_per_mole for name, energy in energies.items()}
        add_context(self.scene, simulation.context, simulation.currentStep, values)
