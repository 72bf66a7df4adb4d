"""Watches a Context: its history, and where it broke down, found by repeating the last steps."""

from __future__ import annotations

import time

import openmm

from .._snapshots import Snapshot
from .._types import File
from .diagnosis import BlowUpError, Replay, diagnose
from .moments import Gauge, Limits, Moment

__all__ = ["Watch"]

# Looking may take this part of the time of the simulation.
_SHARE = 0.02
# Moments that are kept of a run, however long.
_HISTORY = 1000
# Steps that are repeated one by one.
_FINE = 400


class Watch:
    """Notes how a simulation is, and explains how it broke down.

    Parameters
    ----------
    context : openmm.Context
    integrator : openmm.Integrator
        That of the Context.
    limits : Limits, optional
        Beyond which it counts as broken down. Default: none, apart from energies that are not
        finite and errors.
    folder : str or Path, optional
        Where to write the history and the last good frame, if it breaks down. Default: nowhere.
    """

    def __init__(
        self,
        context: openmm.Context,
        integrator: openmm.Integrator,
        limits: Limits | None = None,
        folder: File | None = None,
    ) -> None:
        self._context, self._integrator, self._folder = context, integrator, folder
        self._limits = limits or Limits()
        self._gauge = Gauge(context)
        self._kept: list[Moment] = []
        self._last: Moment | None = None
        self._snapshot: Snapshot | None = None
        self._keep_every, self._looks = 1, 0
        self._looked_at, self._cost = -float("inf"), 0.0

    @property
    def history(self) -> list[Moment]:
        """Moments of the run, about equally far apart, the first and the last among them."""
        last = [] if self._last in (None, *self._kept[-1:]) else [self._last]
        return [*self._kept, *last]

    def look(self, sparing: bool = False) -> None:
        """Note the present moment, and remember it as one to go back to.

        Parameters
        ----------
        sparing : bool
            Do nothing if looks would take more than a fiftieth of the time.

        Raises
        ------
        BlowUpError
            If the simulation has broken down.
        """
        begun = time.monotonic()
        if sparing and (begun - self._looked_at) * _SHARE < self._cost:
            return
        moment = self._gauge.take()
        broken = self._limits.broken(moment)
        if broken is not None:
            raise self.explain(f"{broken} at step {moment.step}", moment.step)
        if self._last is not None and moment.step <= self._last.step:
            # The simulation has been brought back.
            self._kept = [old for old in self._kept if old.step < moment.step]
        if self._looks % self._keep_every == 0:
            self._kept.append(moment)
            if len(self._kept) > _HISTORY:
                self._kept = self._kept[::2]
                self._keep_every *= 2
        self._looks += 1
        self._last = moment
        self._snapshot = Snapshot.take(self._context)
        self._looked_at = time.monotonic()
        self._cost = self._looked_at - begun

    @property
    def is_whole(self) -> bool:
        """Whether energies are finite now, and within the limits."""
        return self._limits.broken(self._gauge.take()) is None

    def explain(self, reason: str, until: int | None = None) -> BlowUpError:
        """Why the simulation broke down.

        The steps since the last look are repeated. Afterwards the Context is where it was at that
        look, if there was one.

        Parameters
        ----------
        reason : str
            What has been noticed.
        until : int, optional
            The step by which it was. Default: the one after the present one.

        Returns
        -------
        BlowUpError
            To be raised.
        """
        if until is None:
            until = self._context.getStepCount() + 1
        if self._snapshot is None:
            return BlowUpError(
                f"{reason}\nThe state with which the simulation begins is at fault: look at the "
                "mesh, and at where it was placed"
            )
        try:
            return BlowUpError(diagnose(reason, self._repeat(until), self._folder))
        finally:
            self._snapshot.restore(self._context)

    def _repeat(self, until: int) -> Replay:
        """Go from the last look to where it breaks down, the last steps one by one."""
        start, before = self._snapshot, self.history
        while until - before[-1].step > _FINE:
            chunk = max(_FINE // 2, -(-(until - before[-1].step) // 20))
            start, until = self._narrowed(start, before, until, chunk)
        start.restore(self._context)
        fine, failure = [before.pop()], None
        while failure is None and fine[-1].step < until:
            failure = self._breaks(1, fine)
        return Replay(self._context, self._integrator, self._gauge, start, before, fine, failure)

    def _narrowed(self, start: Snapshot, before: list[Moment], until: int, chunk: int):
        """Where two chunks of steps begin, of which the last breaks, and by when it did.

        The one before it shows what is usual.
        """
        start.restore(self._context)
        earlier, first = start, len(before)
        while until - before[-1].step > chunk and self._breaks(chunk, before) is None:
            earlier, start = start, Snapshot.take(self._context)
        until = min(until, before[-1].step + chunk)
        if len(before) > first:
            before.pop()
        return earlier, until

    def _breaks(self, steps: int, moments: list[Moment]) -> str | None:
        """Take some steps and note the moment; what went wrong, None if nothing did."""
        try:
            self._integrator.step(steps)
        except openmm.OpenMMException as reason:
            return str(reason)
        moment = self._gauge.take()
        broken = self._limits.broken(moment)
        if broken is None:
            moments.append(moment)
        return broken
