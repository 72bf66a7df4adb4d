"""Why a simulation broke down: what can be read from its last steps."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import openmm
from openmm import unit

from .._mesh import files
from .._snapshots import Snapshot
from .._types import File
from .._writing import describe, naming, write_whole
from ..errors import FAQ, Explained
from ..forces import TriangleHeightForce
from ..states import save_state
from .moments import Gauge, Moment
from .parts import Parts
from .stability import stable_time_step

__all__ = ["BlowUpError", "Replay", "diagnose"]

# Beyond what factor of anything before a moment is no longer normal.
_UNUSUAL = 2.0
# Degrees from which on two triangles count as folded onto each other.
_FOLDED = 150.0
# Moments before that one, and from it on, that are looked at more closely.
_BEFORE, _AFTER = 6, 2
# The largest part of the bound that a new time step should have.
_SAFE = 0.1
_NM = unit.nanometer


class BlowUpError(Explained, openmm.OpenMMException):
    """A simulation has broken down; the message says how, and what to do."""

    page = f"{FAQ}#messages-and-what-is-behind-them"


@dataclass
class Replay:
    """The last steps of a simulation, repeated.

    context, integrator, gauge: with which; start: where they begin; before: moments of the run
    before that; fine: a moment for each step, up to the last one that was whole; failure: what
    happened in the step after it, None if nothing did.
    """

    context: openmm.Context
    integrator: openmm.Integrator
    gauge: Gauge
    start: Snapshot
    before: list[Moment]
    fine: list[Moment]
    failure: str | None

    @cached_property
    def onset(self) -> int:
        """Which of the fine moments is the first of those at the end that are not normal."""
        everything = [*self.before, *self.fine]
        # Of a short history, the first half counts as usual.
        usual = max(len(self.before), len(everything) // 2, 1)
        first = len(everything)
        while first > 1 and not _normal(everything[first - 1], everything[:usual]):
            first -= 1
        return max(0, first - len(self.before))

    @property
    def around(self) -> list[Moment]:
        """The fine moments before and after the onset."""
        return self.fine[max(0, self.onset - _BEFORE) : self.onset + _AFTER]

    @property
    def turn(self) -> Moment:
        """The first moment at which something is not normal, or the last one."""
        return self.fine[min(self.onset, len(self.fine) - 1)]

    @property
    def good(self) -> Moment:
        """The last moment at which all was normal, or the first that there is."""
        return self.fine[max(0, self.onset - 1)]

    def go_to(self, moment: Moment) -> None:
        """Bring the Context to one of the fine moments."""
        self.start.restore(self.context)
        self.integrator.step(moment.step - self.fine[0].step)

    @cached_property
    def bounds(self) -> dict[int, float]:
        """The longest stable time step, ps, at steps around the onset."""
        kinds = (openmm.VariableVerletIntegrator, openmm.VariableLangevinIntegrator)
        if isinstance(self.integrator, kinds):
            return {}
        friction = None
        if isinstance(self.integrator, openmm.BrownianIntegrator):
            friction = self.integrator.getFriction()
        found = {}
        for moment in self.around:
            self.go_to(moment)
            with contextlib.suppress(ValueError, openmm.OpenMMException):
                found[moment.step] = stable_time_step(self.context, friction)
        return found


def _normal(moment: Moment, usual: list[Moment]) -> bool:
    """Whether a moment is not far beyond some others."""
    hottest = max(other.kinetic for other in usual)
    potentials = [other.potential for other in usual]
    spread = max(max(potentials) - min(potentials), abs(potentials[0]), hottest)
    lowest = min(other.height for other in usual)
    return not (
        (hottest > 0 and moment.kinetic > _UNUSUAL * hottest)
        or moment.potential > max(potentials) + spread
        or moment.height < lowest / _UNUSUAL
    )


def diagnose(reason: str, replay: Replay, folder: File | None = None) -> str:
    """Why it broke down, as a text; and the last good frame as files.

    Parameters
    ----------
    reason : str
        What has been noticed.
    replay : Replay
    folder : str or Path, optional
        For ``report.txt``, ``history.csv``, ``last-good.ply`` and ``last.ply``, the surface at the
        last good moment and at the last whole one (``-0``, ``-1`` … where there are several), and
        ``last-good.state``, which `load_state` reads.

    Returns
    -------
    str
        Lines; the first is the reason.
    """
    parts = [
        [reason],
        _course(replay),
        _time_step(replay),
        _triangles(replay),
        _folds(replay),
        _forces(replay),
        _beginning(replay),
        _table(replay),
    ]
    text = "\n".join(line for part in parts for line in part)
    if folder is None:
        return text
    said = f"{text}\nThe last good frame, the last one and the history are in {folder}"
    try:
        _write(Path(folder), replay)
        write_whole(Path(folder) / "report.txt", f"{said}\n".encode())
    except OSError as refused:
        return f"{text}\nThe last good frame cannot be written: {describe(refused)}"
    return said


def _course(replay: Replay) -> list[str]:
    first, last, good = replay.fine[0], replay.fine[-1], replay.good
    lines = [f"The steps from {first.step} on were taken again."]
    if replay.failure is None:
        lines.append(
            f"  It did not break down this time, up to step {last.step}: the platform "
            f"{replay.context.getPlatform().getName()} does not repeat its numbers, or something "
            "outside of the simulation has changed the Context"
        )
    else:
        lines.append(f"  It broke down in step {last.step + 1}: {replay.failure.splitlines()[0]}")
    if replay.onset < len(replay.fine):
        lines.append(f"  All was normal until step {good.step}, {good.time:.6g} ps")
    if math.isfinite(last.temperature):
        lines.append(
            f"  Temperature: {good.temperature:.4g} K at step {good.step}, "
            f"{last.temperature:.4g} K at step {last.step}"
        )
    return lines


def _time_step(replay: Replay) -> list[str]:
    bounds = replay.bounds
    if not bounds:
        return []
    size = replay.integrator.getStepSize().value_in_unit(unit.picosecond)
    first, (worst_step, worst) = min(bounds), min(bounds.items(), key=lambda item: item[1])
    stable = f"steps are stable below {bounds[first]:.3g} ps at step {first}"
    if first != worst_step:
        stable += f", below {worst:.3g} ps at step {worst_step}"
    if size < worst:
        return [f"Time step: {size:g} ps is within its bound; {stable}"]
    advice = _rounded(min(size / 2, _SAFE * bounds[first]))
    return [f"Time step: {size:g} ps is TOO LONG; {stable}; try {advice} ps"]


def _triangles(replay: Replay) -> list[str]:
    turn = replay.turn
    if turn.triangle < 0:
        return []
    since = turn
    for moment in reversed(replay.fine[: replay.fine.index(turn)]):
        if (moment.surface, moment.triangle) != (turn.surface, turn.triangle):
            break
        since = moment
    usual = min(moment.height for moment in [*replay.before, *replay.fine[: replay.onset or 1]])
    course = f"{turn.height:.4g} nm at step {turn.step}"
    if since is not turn:
        course = f"from {since.height:.4g} nm at step {since.step} to {course}"
    lines = [
        f"Heights: {turn.named_triangle} is the least high, {course}; {usual:.4g} nm was the least "
        "while all was normal"
    ]
    forces = replay.context.getSystem().getForces()
    if not any(_keeps_heights(force) for force in forces):
        lines.append("  Nothing keeps triangles from collapsing: add a TriangleHeightForce")
    return lines


def _keeps_heights(force: openmm.Force) -> bool:
    if not TriangleHeightForce.isinstance(force):
        return False
    force = TriangleHeightForce.cast(force)
    return force.getMinHeight() * force.getEpsilon() > 0


def _folds(replay: Replay) -> list[str]:
    good, turn = replay.good, replay.turn
    if not turn.fold >= _FOLDED:
        return []
    lines = [f"Folds: {turn.named_edge} is bent by {turn.fold:.4g}° at step {turn.step}"]
    if good.fold >= _FOLDED:
        lines.append(
            f"  {good.named_edge} was by {good.fold:.4g}° at step {good.step}, when all else was "
            "normal: the surface is crumpled; use more vertices, a higher rigidity, or a "
            "DihedralForce"
        )
    return lines


def _forces(replay: Replay) -> list[str]:
    """Which forces push hardest where it breaks down, and whose energy has risen most."""
    moment = max(replay.good, replay.turn, key=lambda each: np.nan_to_num(each.force, nan=-1.0))
    if moment.particle < 0:
        return []
    try:
        parts = Parts(replay.context)
        replay.go_to(replay.fine[0])
        before, _ = parts.take()
        replay.go_to(moment)
        now, forces = parts.take()
    except openmm.OpenMMException:
        return []
    with np.errstate(over="ignore"):
        pushes = np.linalg.norm(forces[:, moment.particle], axis=1)
    strongest = [index for index in np.argsort(-pushes)[:3] if pushes[index] > 0]
    named = ", ".join(f"{pushes[index]:.4g} of {parts.labels[index]}" for index in strongest)
    lines = [f"Forces: the largest at step {moment.step} is on particle {moment.particle}: {named}"]
    first, most = replay.fine[0], int(np.argmax(now - before))
    if moment is not first and now[most] > before[most]:
        lines.append(
            f"  The energy of {parts.labels[most]} has risen most since step {first.step}, from "
            f"{before[most]:.6g} to {now[most]:.6g} kJ/mol"
        )
    return lines


def _beginning(replay: Replay) -> list[str]:
    first = replay.fine[0]
    if replay.before or replay.good.step > first.step or first.particle < 0:
        return []
    size = replay.integrator.getStepSize().value_in_unit(unit.picosecond)
    mass = replay.context.getSystem().getParticleMass(first.particle).value_in_unit(unit.dalton)
    moved = first.force / mass * size**2 if mass else math.nan
    return [
        f"Start: it was never normal. At step {first.step} the largest force, {first.force:.4g} "
        f"kJ/mol/nm on particle {first.particle}, moves it by {moved:.3g} nm in a step, where the "
        f"least high triangle has {first.height:.4g} nm: minimise the energy first "
        "(simulation.minimizeEnergy(tolerance=0.01), minimise = true in TOML), or start from "
        "another mesh"
    ]


_COLUMNS = {
    "step": ("step", "d"),
    "time (ps)": ("time", ".6g"),
    "potential (kJ/mol)": ("potential", ".6g"),
    "kinetic (kJ/mol)": ("kinetic", ".6g"),
    "T (K)": ("temperature", ".5g"),
    "height (nm)": ("height", ".4g"),
    "triangle": ("triangle", "d"),
    "fold (deg)": ("fold", ".4g"),
    "force (kJ/mol/nm)": ("force", ".4g"),
    "on particle": ("particle", "d"),
}


def _table(replay: Replay) -> list[str]:
    """The beginning, the last good moment, and the last ones."""
    shown = [*replay.before[:1], *replay.before[-1:], *replay.around, replay.fine[-1]]
    rows = [list(_COLUMNS)]
    for moment in dict.fromkeys(shown):
        rows.append([format(getattr(moment, name), how) for name, how in _COLUMNS.values()])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in rows
    ]


def _write(folder: Path, replay: Replay) -> None:
    with naming(folder):
        folder.mkdir(parents=True, exist_ok=True)
    bounds = replay.bounds
    lines = [",".join([*_COLUMNS, "corners", "edge", "stable time step (ps)"])]
    for moment in [*replay.before, *replay.fine]:
        values = [format(getattr(moment, name), "d" if how == "d" else ".12g")
                  for name, how in _COLUMNS.values()]  # fmt: skip
        values += [" ".join(map(str, moment.corners)), " ".join(map(str, moment.edge))]
        lines.append(",".join([*values, format(bounds.get(moment.step, math.nan), ".6g")]))
    write_whole(folder / "history.csv", ("\n".join(lines) + "\n").encode())
    for name, moment in (("last", replay.fine[-1]), ("last-good", replay.good)):
        replay.go_to(moment)
        _write_surfaces(folder, name, replay)
    save_state(replay.context, folder / "last-good.state")


def _write_surfaces(folder: Path, name: str, replay: Replay) -> None:
    surfaces = replay.gauge.surfaces(replay.context.getState(getPositions=True))
    for number, surface in enumerate(surfaces):
        particles, corners = np.unique(surface.triangles, return_inverse=True)
        triangles = corners.reshape(-1, 3)
        heights = np.full(len(particles), np.inf)
        np.minimum.at(heights, triangles, surface.heights[:, None])
        label = f"-{number}" if len(surfaces) > 1 else ""
        data = {"least_height": heights}
        vertices = surface.positions[particles]
        files.write(folder / f"{name}{label}.ply", vertices, triangles, data, box=surface.box)


def _rounded(value: float) -> str:
    """Down to one digit."""
    if not 0 < value < math.inf:
        return f"{value:g}"
    digit = 10.0 ** math.floor(math.log10(value))
    return f"{math.floor(value / digit * (1 + 1e-12)) * digit:g}"
