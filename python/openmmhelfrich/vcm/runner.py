"""A run in a folder: outputs, checkpoints, and going on after an interruption.

A checkpoint is one file, replaced at once or not at all: what OpenMM needs to go on bit by bit, the
step, and the length of every output at that moment. Whatever stops a run, it goes on from the last
checkpoint with the outputs cut back to it.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import openmm

from . import build
from .config import Config
from .outputs import Frame, Outputs, report_steps, take_frame

__all__ = ["CHECKPOINT", "Run", "RunError"]

CHECKPOINT = "checkpoint.bin"
_LOCK = ".lock"
_FORMAT = "openmm-helfrich checkpoint 1"
# Wall time between looks at a request to stop, s.
_CHUNK_SECONDS = 0.25


class RunError(Exception):
    """A run cannot be started or resumed; the message says why and what to do."""


@dataclass(frozen=True)
class _Saved:
    """A checkpoint as it is in its file."""

    header: dict
    state: bytes


class Run:
    """One simulation in its folder.

    Parameters
    ----------
    config : str or Path
        A VCM configuration file, or one of ours in TOML.
    folder : str or Path, optional
        Where outputs go. Default: a folder with the project's name in the present one.
    platform : str, optional
        OpenMM platform. Default: that of the run to resume, that of the file, or the fastest
        one for the System, see `platforms.choose`.
    seed : int
        In place of the file's, if not 0.
    resume : bool
        Go on with the run that the folder holds. Without a checkpoint it starts at the beginning.
    vcm_compatible, ignore_unknown : bool
        As for `read`; a resumed run keeps its own.
    xtc, ply : bool, optional
        As for `Outputs`; a resumed run keeps its own. Default: what the file says, or XTC only.
    checkpoint_seconds : float
        Wall time between checkpoints, s: what a kill can cost.

    Raises
    ------
    RunError
        If the folder holds a run already and `resume` is False, if another process is at work
        there, or if the run there is of another configuration.
    ConfigError
        See `read`.
    """

    def __init__(
        self,
        config,
        folder=None,
        platform: str | None = None,
        seed: int = 0,
        resume: bool = False,
        vcm_compatible: bool = False,
        ignore_unknown: bool = False,
        xtc: bool | None = None,
        ply: bool | None = None,
        checkpoint_seconds: float = 10.0,
    ):
        # Imported here, because configurations of ours build on those of VCM.
        from ..config import read_any as read

        options = {"vcm_compatible": vcm_compatible, "ignore_unknown": ignore_unknown}
        self._checkpoint_seconds = checkpoint_seconds
        cfg = read(config, seed=seed, **options)
        asked = {"xtc": xtc, "ply": ply}
        wanted = {name: given for name, given in asked.items() if given is not None}
        self._options = {**options, **cfg.writes, **wanted}
        self.folder = Path(folder if folder is not None else cfg.name)
        saved = self._find(resume)
        if saved is not None:
            # A run goes on as it began, whatever options were given again or left out.
            self._options = saved.header["options"]
            platform, seed = self._agree(saved, platform, seed)
            options = {name: self._options[name] for name in options}
            cfg = read(config, seed=seed, **options)
        self.cfg = cfg
        self._lock()
        self._fingerprint = _fingerprint(cfg)
        if saved is not None and saved.header["fingerprint"] != self._fingerprint:
            raise RunError(
                f"{self.folder} holds a run of another system or integrator: the configuration or "
                "a mesh has changed since; give another folder with --out"
            )
        try:
            self.simulation = build.unprepared_simulation(cfg, platform or cfg.platform)
        except openmm.OpenMMException as reason:
            raise RunError(f"OpenMM cannot start: {reason}") from None
        self.outputs = Outputs(cfg, self.folder, self._options["xtc"], self._options["ply"])
        self.resumed = saved is not None
        if saved is None:
            build.prepare(cfg, self.context)
            self.step = 0
            self.outputs.start()
            self.frame = take_frame(cfg, self.context, 0)
            self.outputs.write(self.frame)
            self.save()
        else:
            self._restore(saved)
            self.frame = take_frame(cfg, self.context, self.step)

    @property
    def context(self) -> openmm.Context:
        """The Context that runs."""
        return self.simulation.context

    @property
    def platform(self) -> str:
        """The name of the platform that runs."""
        return self.context.getPlatform().getName()

    def advance(
        self,
        last_step: int,
        progress: Callable[[int], None] = lambda step: None,
        report: Callable[[Frame], None] = lambda frame: None,
        stop: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Simulate, write outputs when they are due, and save checkpoints.

        Parameters
        ----------
        last_step : int
            The step, counted from the start of the run, to end with.
        progress : callable
            Told the step, several times a second.
        report : callable
            Told each frame that was written.
        stop : callable
            Asked several times a second whether to end early.

        Returns
        -------
        bool
            Whether the last step was reached.

        Raises
        ------
        RunError
            If the simulation breaks down. The last checkpoint is from before.
        """
        interval = self.cfg.general["ReportIntervalInFs"]
        due = report_steps(interval, self.cfg.step_size, self.cfg.num_steps)
        next_report = next((step for step in due if step > self.step), None)
        saved_at, chunk = time.monotonic(), 1
        while self.step < last_step and not stop():
            end = min(last_step, self.step + chunk, next_report or last_step)
            chunk = self._run_to(end, chunk)
            progress(self.step)
            if self.step == next_report:
                self.frame = self._take_frame()
                self.outputs.write(self.frame)
                next_report = next(due, None)
                report(self.frame)
            if time.monotonic() - saved_at >= self._checkpoint_seconds:
                # A state that is not finite must not take the place of the last good one.
                self._take_frame()
                self.save()
                saved_at = time.monotonic()
        self.frame = self._take_frame()
        self.save()
        return self.step >= last_step

    def _run_to(self, end: int, chunk: int) -> int:
        """Simulate up to a step; returns how many steps to take next."""
        steps, before = end - self.step, time.perf_counter()
        try:
            self.simulation.integrator.step(steps)
        except openmm.OpenMMException as reason:
            raise self._broken(f"between steps {self.step} and {end}: {reason}") from None
        self.step = end
        elapsed = time.perf_counter() - before
        if steps < chunk:
            return chunk
        # Growing twofold at most, because the first steps of a GPU are slow.
        return max(1, min(2 * chunk, int(chunk * _CHUNK_SECONDS / max(elapsed, 1e-9))))

    def _take_frame(self) -> Frame:
        try:
            return take_frame(self.cfg, self.context, self.step)
        except (FloatingPointError, openmm.OpenMMException) as reason:
            raise self._broken(str(reason)) from None

    def _broken(self, reason: str) -> RunError:
        return RunError(
            f"the simulation broke down: {reason}; try a smaller time step, which "
            "'openmm-helfrich info' compares with what is stable"
        )

    def save(self) -> None:
        """Write a checkpoint in place of the last one."""
        header = {
            "format": _FORMAT,
            "step": self.step,
            "platform": self.platform,
            "seed": self.cfg.seed,
            "options": self._options,
            "fingerprint": self._fingerprint,
            "outputs": self.outputs.state(),
        }
        path = self.folder / CHECKPOINT
        fresh = path.with_suffix(".new")
        with fresh.open("wb") as file:
            file.write(json.dumps(header).encode() + b"\n" + self.context.createCheckpoint())
            file.flush()
            os.fsync(file.fileno())
        # The new file takes the old one's name in one go: there is always a whole one.
        os.replace(fresh, path)

    def _find(self, resume: bool) -> _Saved | None:
        """The checkpoint to go on from, None to start at the beginning."""
        path = self.folder / CHECKPOINT
        if not resume:
            occupied = self.folder.is_dir() and any(
                entry.name != _LOCK for entry in self.folder.iterdir()
            )
            if occupied:
                raise RunError(
                    f"{self.folder} is not empty; go on with the run in it with --resume, or give "
                    "another folder with --out"
                )
        if not resume or not path.exists():
            return None
        first, _, state = path.read_bytes().partition(b"\n")
        try:
            header = json.loads(first)
            known = header["format"] == _FORMAT
        except (ValueError, KeyError, TypeError):
            known = False
        if not known:
            raise RunError(f"{path} is not a checkpoint of this version of openmm-helfrich")
        return _Saved(header, state)

    @staticmethod
    def _agree(saved: _Saved, platform: str | None, seed: int) -> tuple[str, int]:
        """Platform and seed of the run to resume; RunError if others are asked for."""
        header = saved.header
        if platform is not None and platform != header["platform"]:
            raise RunError(
                f"the run is on the platform {header['platform']}, whose checkpoints {platform} "
                "cannot read; leave out --platform"
            )
        if seed not in (0, header["seed"]):
            raise RunError(f"the run has the seed {header['seed']}; leave out --seed")
        return header["platform"], header["seed"]

    def _lock(self) -> None:
        """Keep other processes out of the folder for as long as this one lives."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock_file = (self.folder / _LOCK).open("wb")
        try:
            fcntl.flock(self._lock_file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise RunError(f"another process is running in {self.folder}") from None

    def _restore(self, saved: _Saved) -> None:
        try:
            self.context.loadCheckpoint(saved.state)
        except openmm.OpenMMException as reason:
            raise RunError(f"OpenMM cannot read {self.folder / CHECKPOINT}: {reason}") from None
        self.step = saved.header["step"]
        try:
            self.outputs.restore(saved.header["outputs"])
        except ValueError as reason:
            raise RunError(f"cannot resume: {reason}") from None

    def close(self) -> None:
        """Let other processes into the folder."""
        with contextlib.suppress(OSError):
            self._lock_file.close()


def _fingerprint(cfg: Config) -> str:
    """Equal for equal System, integrator and outputs' schedule."""
    parts = [
        openmm.XmlSerializer.serialize(cfg.system()),
        openmm.XmlSerializer.serialize(cfg.integrator()),
        repr(cfg.general["ReportIntervalInFs"]),
    ]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
