"""Pages that follow a run."""

from __future__ import annotations

import time
from pathlib import Path

from openmm import unit

from .._numbers import whole_number
from .._surface_reporters import NextReport
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
        To which the caller adds frames.
    """

    def __init__(self, path, scene: Scene):
        self.path = Path(path)
        self.scene = scene
        self._due = 0.0

    def update(self) -> None:
        """Write the page, unless it has been written just now."""
        if time.monotonic() < self._due:
            return
        self._write(_SECONDS)

    def finish(self) -> None:
        """Write the page as it stays."""
        self._write(None)

    def _write(self, reload: float | None) -> None:
        while len(self.scene.frames) > _MOST_FRAMES:
            self.scene.thin()
        begin = time.monotonic()
        write_page(self.path, self.scene, reload)
        end = time.monotonic()
        self._due = end + max(_SECONDS, (end - begin) / _SHARE)


class LiveView:
    """Shows all membranes of a Simulation as it runs: a reporter for notebooks, or for a page.

    In a notebook the cell in which the run started has the view, which is updated every few
    seconds. With `file` there is a page that updates itself in any browser.

    Parameters
    ----------
    reportInterval : int
        Steps between frames.
    file : str or Path, optional
        The HTML file to write. Default: show it in the notebook.

    Raises
    ------
    ImportError
        No file is given, and IPython is not installed.
    ValueError
        At the first report, if the System has no membrane force.

    Examples
    --------
    >>> simulation.reporters.append(LiveView(1000))
    >>> simulation.step(100_000)
    """

    def __init__(self, reportInterval, file=None):
        self._interval = whole_number(reportInterval, "LiveView", "reportInterval", 1)
        self.scene = Scene("simulation")
        self._page = None if file is None else LivePage(file, self.scene)
        self._cell = None if file is not None else _Cell(self.scene)

    def describeNextReport(self, simulation):
        """When the next report is due, as OpenMM asks for it."""
        steps = self._interval - simulation.currentStep % self._interval
        return NextReport(steps=steps, periodic=False, include=["energy"])

    def report(self, simulation, state):
        """Add a frame, and show it if the last one was shown some seconds ago."""
        energies = {
            name: energy.value_in_unit(unit.kilojoule_per_mole)
            for name, energy in (
                ("potential", state.getPotentialEnergy()),
                ("kinetic", state.getKineticEnergy()),
            )
        }
        add_context(self.scene, simulation.context, simulation.currentStep, energies)
        (self._page or self._cell).update()

    def finish(self) -> None:
        """Show the last frame; the page no longer looks for a newer one."""
        (self._page or self._cell).finish()


class _Cell:
    """A display of a notebook that is updated."""

    def __init__(self, scene: Scene):
        try:
            from IPython.display import HTML, display
        except ImportError as reason:
            raise ImportError(
                f"LiveView: a view in a notebook needs IPython; give file= instead ({reason})"
            ) from None
        self._scene = scene
        self._html, self._display = HTML, display
        self._handle = None
        self._due = 0.0

    def update(self) -> None:
        if time.monotonic() >= self._due:
            self.finish()

    def finish(self) -> None:
        while len(self._scene.frames) > _MOST_FRAMES:
            self._scene.thin()
        begin = time.monotonic()
        shown = self._html(embedded(page(self._scene)))
        if self._handle is None:
            self._handle = self._display(shown, display_id=True)
        else:
            self._handle.update(shown)
        end = time.monotonic()
        self._due = end + max(_SECONDS, (end - begin) / _SHARE)
