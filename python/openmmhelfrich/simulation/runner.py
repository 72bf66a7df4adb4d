"""A run in a folder: outputs, checkpoints, and going on after an interruption.

A checkpoint is one file, replaced at once or not at all: what OpenMM needs to go on bit by bit, the
step, and the length of every output at that moment. Whatever stops a run, it goes on from the last
checkpoint with the outputs cut back to it. `run_folder.py` keeps checkpoints.
"""

from __future__ import annotations

import contextlib
import hashlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import openmm

from .._snapshots import Snapshot
from .._types import File
from ..blowup import BlowUpError, Watch
from ..config import read_any
from ..errors import FAQ
from ..logs import logger
from .model import Model
from .outputs import Frame, Outputs, report_steps, take_frame
from .run_folder import CHECKPOINT, RunError, RunFolder, Saved, saved_in

__all__ = ["CHECKPOINT", "Run", "RunError"]

# Wall time between looks at a request to stop, s.
_CHUNK_SECONDS = 0.25

_LOG = logger("run")


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
        Go on with the run that the folder holds. In an empty folder it starts at the beginning.
    resume_previous : bool
        Go on from the checkpoint before the last one, which is given up: for one that is damaged.
    vcm_compatible, ignore_unknown : bool
        As for `read`; a resumed run keeps its own, and is refused others.
    xtc, frames : bool and str, optional
        As for `Outputs`; the same. Default: what the file says, or XTC only.
    ply : bool, optional
        Short for ``frames="ply"`` or, if False, ``frames="none"``.
    flips : float, optional
        As for `read`; the same. Default: none.
    checkpoint_seconds : float
        Wall time between checkpoints, s: what a kill can cost.

    Raises
    ------
    RunError
        If the folder holds a run already and `resume` is False, if another process is at work
        there, if its checkpoint is damaged or missing, if the run there is of another
        configuration, or if files cannot be written.
    ConfigError
        See `read`.
    """

    def __init__(
        self,
        config: File,
        folder: File | None = None,
        platform: str | None = None,
        seed: int = 0,
        resume: bool = False,
        resume_previous: bool = False,
        vcm_compatible: bool = False,
        ignore_unknown: bool = False,
        xtc: bool | None = None,
        ply: bool | None = None,
        frames: str | None = None,
        flips: float | None = None,
        checkpoint_seconds: float = 10.0,
    ) -> None:
        options = {
            "vcm_compatible": vcm_compatible,
            "ignore_unknown": ignore_unknown,
            "flips": flips or 0.0,
        }
        self._checkpoint_seconds = checkpoint_seconds
        flags = {name: True for name in ("vcm_compatible", "ignore_unknown") if options[name]}
        going_on = (resume or resume_previous) and folder is not None
        before = saved_in(Path(folder)) if going_on else None
        if before is not None:
            # Without them the file may not be readable.
            for name in ("vcm_compatible", "ignore_unknown"):
                options[name] = options[name] or before.options.get(name, False)
        self.cfg = cfg = read_any(config, seed=seed, **options)
        asked = {"xtc": xtc, "frames": frames or {True: "ply", False: "none"}.get(ply)}
        wanted = {name: given for name, given in asked.items() if given is not None}
        # What is asked for here, and what the file says: a resumed run must agree with both.
        self._wanted = {**flags, **wanted, **({} if flips is None else {"flips": flips})}
        self._said = {"seed": cfg.file_seed, "platform": cfg.platform, **cfg.writes}
        self._options = {**options, **cfg.writes, **wanted, "file": self._said}
        self.folder = Path(folder if folder is not None else cfg.name)
        self._watch: Watch | None = None
        self._folder = RunFolder(self.folder)
        self._folder.enter(resume or resume_previous)
        try:
            self._start(config, platform, seed, resume, resume_previous)
        except BaseException:
            self.close()
            raise

    def _start(self, config, platform, seed: int, resume: bool, resume_previous: bool) -> None:
        """Bring Context and outputs to where the run begins or goes on."""
        found = self._folder.read(resume_previous) if resume or resume_previous else None
        saved, state = (None, None) if found is None else found
        if saved is not None:
            # A run goes on as it began, whatever options were left out.
            platform, seed = self._agree(saved, platform, seed)
            self._options = saved.options
            known = ("vcm_compatible", "ignore_unknown", "flips")
            options = {name: saved.options[name] for name in known if name in saved.options}
            self.cfg = read_any(config, seed=seed, **options)
        cfg = self.cfg
        self._fingerprint = _fingerprint(cfg)
        if saved is not None and saved.fingerprint != self._fingerprint:
            raise RunError(
                f"{self.folder} holds a run of another system or integrator: the configuration or "
                "a mesh has changed since; give another folder with --out"
            )
        try:
            self.simulation = cfg.unprepared_simulation(platform or cfg.platform)
            if saved is None:
                cfg.prepare(self.context)
        except openmm.OpenMMException as reason:
            where = "" if saved is None else f" on the platform {platform} of the checkpoint"
            raise RunError(
                f"OpenMM cannot start{where}: {reason}; {FAQ}#before-the-first-step lists such "
                "messages"
            ) from None
        try:
            self.outputs = Outputs(cfg, self.folder, self._options["xtc"], self._options["frames"])
        except ImportError as reason:
            raise RunError(f"--frames {self._options['frames']}: {reason}") from None
        self.resumed = saved is not None
        self.step = 0 if saved is None else saved.step
        if saved is not None:
            # A checkpoint of another run has outputs that tell.
            if saved.outputs is None or self.outputs.misfit(saved.outputs) is None:
                self._agree_with_file(saved)
            self._load(saved, state, resume_previous)
        self.frame = self._take_frame()
        if saved is None:
            # The first checkpoint comes before the first output, so that a run which is killed at
            # any moment leaves either nothing or what it can go on from.
            self._save(None)
        if saved is None or saved.outputs is None:
            with self._folder.writing():
                self.outputs.start()
                self.outputs.write(self.frame)
            self.save()
        limits = self.cfg.limits
        _LOG.info(
            "%s: %s at step %d on the platform %s, seed %d",
            self.folder,
            "goes on" if self.resumed else "begins",
            self.step,
            self.platform,
            self.cfg.seed,
        )
        self._watch = Watch(
            self.context, self.simulation.integrator, limits, self.folder / "blow-up"
        )
        with self._explaining():
            self._watch.look()

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
            If the simulation breaks down, or a file cannot be written. The last checkpoint is from
            before; `close` this run and make another with ``resume=True``. Of one that breaks down
            the message says why, and the folder ``blow-up`` has its last good frame, see
            `BlowUpReporter`.
        """
        interval = self.cfg.general["ReportIntervalInFs"]
        due = report_steps(interval, self.cfg.step_size, self.cfg.num_steps)
        next_report = next((step for step in due if step > self.step), None)
        saved_at, chunk = time.monotonic(), 1
        while self.step < last_step and not stop():
            end = min(last_step, self.step + chunk, next_report or last_step)
            with self._explaining():
                chunk = self._run_to(end, chunk)
                self._watch.look(sparing=True)
            progress(self.step)
            if self.step == next_report:
                self.frame = self._take_frame()
                with self._folder.writing():
                    self.outputs.write(self.frame)
                _LOG.debug("%s: a frame at step %d", self.folder, self.step)
                next_report = next(due, None)
                report(self.frame)
            if time.monotonic() - saved_at >= self._checkpoint_seconds:
                # A state that is not finite must not take the place of the last good one.
                self._take_frame()
                self.save()
                saved_at = time.monotonic()
        self.frame = self._take_frame()
        if self.step != self._folder.saved_step:
            self.save()
        return self.step >= last_step

    def present(self) -> Frame:
        """The state as it is now, without writing it; RunError if it is not finite."""
        return self._take_frame()

    def _run_to(self, end: int, chunk: int) -> int:
        """Simulate up to a step; returns how many steps to take next."""
        steps, before = end - self.step, time.perf_counter()
        try:
            self.simulation.integrator.step(steps)
        except openmm.OpenMMException as reason:
            raise self._watch.explain(
                f"between steps {self.step} and {end}: {reason}", end
            ) from None
        self.step = end
        elapsed = time.perf_counter() - before
        if steps < chunk:
            return chunk
        # Growing twofold at most, because the first steps of a GPU are slow.
        return max(1, min(2 * chunk, int(chunk * _CHUNK_SECONDS / max(elapsed, 1e-9))))

    def _take_frame(self) -> Frame:
        with self._explaining():
            try:
                return take_frame(self.cfg, self.context, self.step)
            except (FloatingPointError, openmm.OpenMMException) as reason:
                if self._watch is None:
                    raise BlowUpError(str(reason)) from None
                raise self._watch.explain(str(reason), self.step) from None

    @contextlib.contextmanager
    def _explaining(self) -> Iterator[None]:
        """What has broken down inside becomes a RunError."""
        try:
            yield
        except BlowUpError as reason:
            again = "To try again, give another folder with --out"
            left = self.folder / "blow-up" / "last-good.ply"
            if left.is_file():
                again += f"; a mesh of this one, such as {left}, may be where it begins"
            raise RunError(
                f"the simulation broke down: {reason}\n{again}\n"
                f"{reason.page} lists what messages mostly mean, and what to do"
            ) from None

    def save(self) -> None:
        """Write a checkpoint; the last one becomes the one before."""
        with self._folder.writing():
            outputs = self.outputs.state()
        self._save(outputs)

    def _save(self, outputs: dict[str, Any] | None) -> None:
        saved = Saved(
            self.step,
            self.platform,
            self.cfg.seed,
            self._options,
            self._fingerprint,
            outputs,
        )
        begin = time.perf_counter()
        self._folder.save(saved, Snapshot.take(self.context))
        elapsed = time.perf_counter() - begin
        _LOG.debug("%s: checkpoint at step %d in %.3g s", self.folder, self.step, elapsed)

    def _agree(self, saved: Saved, platform: str | None, seed: int) -> tuple[str, int]:
        """Platform and seed of the run to resume; RunError if anything else is asked for."""
        if platform is not None and platform != saved.platform:
            raise RunError(
                f"the run is on the platform {saved.platform}, whose checkpoints {platform} "
                "cannot read; leave out --platform"
            )
        if seed not in (0, saved.seed):
            raise RunError(f"the run has the seed {saved.seed}; leave out --seed")
        for name, value in self._wanted.items():
            before = saved.options.get(name, 0.0 if name == "flips" else None)
            if value != before:
                option = ("no-" if value is False else "") + name.replace("_", "-")
                raise RunError(
                    f"the run was begun with {name} = {before}, not {value}; leave out --{option}: "
                    f"{self._other_folder()}"
                )
        return saved.platform, saved.seed

    def _agree_with_file(self, saved: Saved) -> None:
        """RunError if the file asks for something else than when the run began."""
        # Checkpoints of before did not know. The file may also say what the run has.
        counts = {"seed": saved.seed, "platform": saved.platform, **saved.options}
        for name, value in saved.options.get("file", {}).items():
            now = self._said[name]
            if now not in (value, counts[name]) and name not in self._wanted:
                raise RunError(
                    f"{self.cfg.path}: {name} is {_shown(now)}, and was {_shown(value)} when the "
                    f"run began; change it back: {self._other_folder()}"
                )

    def _other_folder(self) -> str:
        return f"a run goes on as it began; for another one give another folder than {self.folder}"

    def _load(self, saved: Saved, state: Snapshot, previous: bool) -> None:
        """Bring the Context, and outputs that were begun, back to a checkpoint."""
        try:
            state.restore(self.context)
        except openmm.OpenMMException as reason:
            raise RunError(f"OpenMM cannot go on from {self.folder}: {reason}") from None
        with self._folder.writing():
            if saved.outputs is not None:
                try:
                    self.outputs.restore(saved.outputs)
                except ValueError as reason:
                    raise RunError(f"cannot resume: {reason}; {self._way_out(previous)}") from None
        if previous:
            self._folder.go_back()

    def _way_out(self, previous: bool) -> str:
        """How to go on where the outputs are not those of the checkpoint."""
        before = None if previous else self._folder.before_last()
        if before is not None and before.outputs and self.outputs.misfit(before.outputs) is None:
            return (
                f"the files fit the checkpoint before: go on from step {before.step} with "
                "--resume-previous"
            )
        return "bring the file back, or begin anew in another folder with --out"

    def close(self) -> None:
        """Let other processes into the folder."""
        self._folder.leave()


def _shown(value: Any) -> str:
    """A value of a configuration as messages have it."""
    return "not given" if value in (None, 0) and value is not False else str(value)


def _fingerprint(cfg: Model) -> str:
    """Equal for equal System, integrator and outputs' schedule."""
    parts = [
        openmm.XmlSerializer.serialize(cfg.system()),
        openmm.XmlSerializer.serialize(cfg.integrator()),
        repr(cfg.general["ReportIntervalInFs"]),
    ]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
