"""What ``openmm-helfrich run --live`` and ``--live-page`` show during a run."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from openmm import unit

__all__ = ["Page", "Table"]

# Seconds between looks at the run.
_SECONDS = 1.0
# Lines of a terminal that rows may not take: the bar, and what was there.
_SPARED = 4


class Table:
    """Rows below the progress bar: time, temperature, and the energies of this moment.

    Parameters
    ----------
    job : Run
    shown : bool
        Whether to show them; else only the speed is known.
    """

    def __init__(self, job: Any, shown: bool) -> None:
        from ..reporters import degrees_of_freedom

        self._job = job
        self._shown = shown
        self._freedom = degrees_of_freedom(job.simulation.system)
        self._bars: list[Any] = []
        self._due = 0.0
        self._begin = (time.perf_counter(), job.step)

    def __enter__(self) -> Table:
        return self

    def __exit__(self, *reason: Any) -> None:
        for bar in reversed(self._bars):
            bar.close()

    def speed(self, step: int) -> float:
        """Steps in a second since the last time that this was asked."""
        now = time.perf_counter()
        (before, first), self._begin = self._begin, (now, step)
        return (step - first) / max(now - before, 1e-9)

    def update(self) -> None:
        """Show the present state, if the last one was shown a second ago."""
        if not self._shown or time.monotonic() < self._due:
            return
        rows = self._rows(self._job.present())
        if not self._bars:
            self._bars = self._lines(len(rows))
        for bar, row in zip(self._bars, rows, strict=False):
            bar.set_description_str(row)
        self._due = time.monotonic() + _SECONDS

    @staticmethod
    def _lines(wanted: int) -> list[Any]:
        """As many lines as the terminal has room for."""
        import shutil

        from tqdm import tqdm

        count = min(wanted, max(1, shutil.get_terminal_size().lines - _SPARED))
        return [
            tqdm(total=0, position=1 + row, bar_format="{desc}", leave=False)
            for row in range(count)
        ]

    def _rows(self, frame) -> list[str]:
        numbers = {"time": (frame.time, "ps")}
        if self._freedom:
            energy = frame.kinetic * unit.kilojoule_per_mole
            kelvin = 2 * energy / (self._freedom * unit.MOLAR_GAS_CONSTANT_R) / unit.kelvin
            numbers["temperature"] = (kelvin, "K")
        energies = {**frame.terms, "potential": frame.potential, "kinetic": frame.kinetic}
        numbers |= {name: (energy, "kJ/mol") for name, energy in energies.items()}
        width = max(map(len, numbers))
        return [
            f"  {name:<{width}s} {value:>14.6g} {what}" for name, (value, what) in numbers.items()
        ]


class Page:
    """A page that shows the membranes of a run while it goes on.

    Parameters
    ----------
    job : Run
    path : Path
        Of the HTML file.
    """

    def __init__(self, job: Any, path: Path) -> None:
        from ..viewer.live import LivePage
        from ..viewer.scene import Scene

        names = [membrane.label for membrane in job.cfg.membranes]
        self._job = job
        self._page = LivePage(path, Scene(job.cfg.name, names))

    def update(self) -> None:
        """Show the present state, if the last one was shown some seconds ago."""
        self._page.update(lambda: self._add(self._job.present()))

    def finish(self) -> None:
        """Show the last state; the page no longer looks for a newer one."""
        self._page.finish(lambda: self._add(self._job.frame))

    def _add(self, frame) -> None:
        from ..simulation.frames import joined

        membranes = self._job.cfg.membranes
        parts = [
            (frame.positions[membrane.offset : membrane.particles.stop], triangles)
            for membrane, triangles in zip(membranes, frame.triangles, strict=True)
        ]
        periodic = any(membrane.mesh.box is not None for membrane in membranes)
        self._page.scene.add(
            *joined(parts),
            step=frame.step,
            time=frame.time,
            box=frame.box if periodic else None,
            energies={**frame.terms, "potential": frame.potential, "kinetic": frame.kinetic},
        )
