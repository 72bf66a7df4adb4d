"""What reporters of membranes share: when they are due, the surface of the moment, and rows."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from openmm import unit

from ._mesh.geometry import edges_of
from ._mesh.periodic import unfolded
from ._numbers import whole_number
from ._present import present_box, present_triangles
from ._types import File
from ._values import triangles as indices_of
from .analysis.tables import open_table

__all__ = ["NextReport", "SurfaceReporter", "TableReporter"]


class NextReport(dict[str, Any]):
    """What `describeNextReport` returns: the dict of OpenMM 8.1 and later.

    Programs that drive reporters themselves may still index the tuple of old (steps, positions,
    velocities, forces, energy, wrap), so that numbers work as keys too.
    """

    _TUPLE = ("positions", "velocities", "forces", "energy")

    def __missing__(self, key):
        if key == 0:
            return self["steps"]
        if key in (1, 2, 3, 4):
            return self._TUPLE[key - 1] in self["include"]
        if key == 5:
            return self["periodic"]
        raise KeyError(key)


class SurfaceReporter:
    """What is asked for of one membrane at equal intervals.

    Subclasses have `_include`, what they need of the State; `_begin`, which opens their file and
    returns the last step of what they go on from, None if there is nothing; and `_write`, from
    time, positions, triangles and periodic box of the moment, where parts that cross faces of the
    box are whole. Those that span it are refused unless `_spans`.
    """

    _spans: bool = False
    #: Reports of later steps that were in the file; they are written again.
    _dropped: int = 0
    _include: tuple[str, ...] = ("positions",)

    def __init__(
        self, file: File, reportInterval: int, triangles: Any, offset: int, append: bool
    ) -> None:
        name = type(self).__name__
        self._interval = whole_number(reportInterval, name, "reportInterval", 1)
        offset = whole_number(offset, name, "offset", 0)
        self._file, self._append, self._begun = file, append, False
        corners = indices_of(name, triangles).astype(np.intp)
        if len(corners) == 0 or corners.min() < 0:
            wrong = f"one has the index {corners.min()}" if len(corners) else "there are none"
            raise ValueError(
                f"{name}: triangles: {wrong}; give the Mesh, or particle indices of shape "
                "(num_triangles, 3)"
            )
        self._corners = corners + offset
        # Vertices in ascending order of particle index, as in the forces.
        self._particles = np.unique(self._corners)

    def describeNextReport(self, simulation: Any) -> NextReport:
        """When the next report is due, and what it needs, as OpenMM asks for it."""
        # What the file has beyond the step at which the simulation goes on is written again.
        self._open(simulation)
        steps = self._interval - simulation.currentStep % self._interval
        return NextReport(steps=steps, periodic=False, include=list(self._include))

    def report(self, simulation: Any, state: Any) -> None:
        """Write a row, or a frame; it is on disk when this returns."""
        self._open(simulation)
        time = state.getTime().value_in_unit(unit.picosecond)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        try:
            corners = present_triangles(simulation.context, self._corners)
        except ValueError as reason:
            raise ValueError(f"{type(self).__name__}: {reason}") from None
        triangles = np.searchsorted(self._particles, corners)
        vertices = np.asarray(positions)[self._particles]
        box = present_box(simulation.context, state, self._particles)
        if box is not None:
            vertices, _, spanning = unfolded(vertices, edges_of(triangles), box)
            if spanning.any() and not self._spans:
                raise ValueError(
                    f"{type(self).__name__}: the surface spans the periodic box, so that it cannot "
                    "be shown with each vertex once; write "
                    "Mesh(*Mesh.from_context(context, force).unfolded()) to files, or use a "
                    "MembraneReporter"
                )
        self._write(simulation, state, time, vertices, triangles, box)

    def _open(self, simulation):
        if self._begun:
            return
        count = simulation.system.getNumParticles()
        if self._particles[-1] >= count:
            raise ValueError(
                f"{type(self).__name__}: the triangles name particle {self._particles[-1]}, but "
                f"there are {count}"
            )
        self._refuse_shared_file(simulation)
        existed = self._append and Path(self._file).exists()
        last, present = self._begin(simulation), simulation.currentStep
        if present == 0 and self._dropped:
            warnings.warn(
                f"{type(self).__name__}: the simulation is at step 0, so that {self._file} begins "
                f"anew: {self._dropped} reports of later steps are gone; to go on with such a "
                "file, load the checkpoint first, which has the step",
                stacklevel=2,
            )
        if existed and (last or 0) // self._interval < present // self._interval:
            has = "has no reports" if last is None else f"ends with step {int(last)}"
            warnings.warn(
                f"{type(self).__name__}: {self._file} {has}, and the simulation goes on from step "
                f"{present}: reports between are missing; bring the file back if it has lost them",
                stacklevel=2,
            )
        self._begun = True

    def _refuse_shared_file(self, simulation):
        """As after a cell of a notebook that ran twice: two reporters would write rows in turns."""
        own = Path(self._file).resolve()
        for other in getattr(simulation, "reporters", ()):
            if (
                isinstance(other, SurfaceReporter)
                and other is not self
                and Path(other._file).resolve() == own
            ):
                raise ValueError(
                    f"{type(self).__name__}: {self._file}: another {type(other).__name__} of this "
                    "Simulation writes there; take it out of simulation.reporters, or give this "
                    "one a file of its own"
                )


class TableReporter(SurfaceReporter):
    """Rows of numbers about one membrane, to a CSV or HDF5 file.

    Subclasses have `_columns`, the units of their columns by name, and `_values`, a row, from
    positions and triangles of the moment.
    """

    def _begin(self, simulation):
        columns = {"step": "", "time": "ps", **self._columns(simulation)}
        table = open_table(self._file, columns, self._append)
        self._table = table
        if not self._append:
            return None
        last = table.cut(simulation.currentStep)
        self._dropped = table.dropped
        return last

    def _write(self, simulation, state, time, vertices, triangles, box):
        values = self._values(simulation, state, vertices, triangles, box)
        self._table.add([int(simulation.currentStep), time, *(float(value) for value in values)])
