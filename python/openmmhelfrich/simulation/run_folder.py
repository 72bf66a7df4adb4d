"""The folder of a run: one process at a time, and checkpoints that can be trusted.

The last checkpoint and the one before are kept. Each is a file of blocks under a checksum
(`_blocks`), replaced in one go: ``run``, what this package has to know, and ``openmm``, the
Context. What else belongs to the state of a Context, such as triangles that change, goes into
blocks of its own.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .. import _system
from .._blocks import Block, BlockError, DamagedError, pack, unpack
from .._snapshots import Snapshot
from .._writing import describe, naming, replace

__all__ = ["CHECKPOINT", "PREVIOUS", "RunError", "RunFolder", "Saved", "files_of", "saved_in"]

CHECKPOINT = "checkpoint.bin"
PREVIOUS = "checkpoint-previous.bin"
_LOCK = ".lock"
# What a run may leave behind that is killed before it has written anything.
_NOTHING = (_LOCK, CHECKPOINT + ".new")
_KIND = "run"
_KNOWN = {"run": 1, "openmm": 1, "connectivity": 1, "tension": 1, "viscosity": 1}
# How the checkpoints began that had no checksum.
_UNCHECKED = b'{"format": "openmm-helfrich checkpoint 1"'


class RunError(Exception):
    """A run cannot be started, go on or be resumed; the message says why and what to do."""


@dataclass(frozen=True)
class Saved:
    """What a checkpoint knows beside the state of the Context.

    step: of the simulation; platform: whose checkpoint it is; seed, options: how the run was begun;
    fingerprint: of System, integrator and schedule; outputs: what `Outputs.state` says, None if
    none were begun.
    """

    step: int
    platform: str
    seed: int
    options: dict[str, Any]
    fingerprint: str
    outputs: dict[str, Any] | None


def saved_in(folder: Path) -> Saved | None:
    """What the last checkpoint of a folder knows, or the one before; None if there is none."""
    for previous in (False, True):
        with contextlib.suppress(RunError):
            found = RunFolder(folder).read(previous)
            if found is not None:
                return found[0]
    return None


def files_of(folder: Path) -> set[str]:
    """The names of what the run of a folder goes on with; none where there is no run."""
    saved = saved_in(folder)
    if saved is None or saved.outputs is None:
        return set()
    return {*saved.outputs["sizes"], "frames", CHECKPOINT, PREVIOUS}


class RunFolder:
    """A folder that a run may have for itself.

    Parameters
    ----------
    path : Path
        May not exist yet.
    """

    def __init__(self, path: Path):
        self.path = path
        self._lock_file = None
        self._saved_step: int | None = None

    @property
    def saved_step(self) -> int | None:
        """The step of the last checkpoint that was read or written here."""
        return self._saved_step

    def enter(self, resume: bool) -> None:
        """Keep other processes out for as long as this one lives.

        Raises
        ------
        RunError
            If there is something that is not to be resumed, or nothing that can be.
        """
        self._check(resume)
        with self.writing():
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock_file = (self.path / _LOCK).open("wb")
        try:
            _system.lock(self._lock_file)
        except BlockingIOError:
            self.leave()
            raise RunError(
                f"another process is running in {self.path}; wait until it has ended, or give "
                "another folder with --out"
            ) from None
        except OSError as reason:
            self.leave()
            raise RunError(f"{self.path / _LOCK} cannot be locked: {describe(reason)}") from None
        # Another process may have begun, and ended, since the first look.
        self._check(resume)

    def leave(self) -> None:
        """Let other processes in."""
        if self._lock_file is not None:
            with contextlib.suppress(OSError):
                self._lock_file.close()

    def _check(self, resume: bool) -> None:
        """Refuse to write over what is there, before anything is made."""
        if resume and any((self.path / name).exists() for name in (CHECKPOINT, PREVIOUS)):
            return
        try:
            entries = [entry.name for entry in self.path.iterdir()]
        except FileNotFoundError:
            return
        except OSError as reason:
            raise RunError(describe(reason)) from None
        if not set(entries) - set(_NOTHING):
            return
        if resume:
            raise RunError(
                f"{self.path} is not empty, and has no {CHECKPOINT} to go on from: the files in it "
                "would be overwritten; bring the checkpoint back, or give another folder with --out"
            )
        raise RunError(
            f"{self.path} is not empty; go on with the run in it with --resume, or give another "
            "folder with --out"
        )

    def read(self, previous: bool = False) -> tuple[Saved, Snapshot] | None:
        """A checkpoint with the state of the Context; None if there is none, and nothing else.

        Parameters
        ----------
        previous : bool
            The one before the last.

        Raises
        ------
        RunError
            If it cannot be used; the other one is offered if that can be.
        """
        name, other = (PREVIOUS, CHECKPOINT) if previous else (CHECKPOINT, PREVIOUS)
        if not any((self.path / file).exists() for file in (name, other)):
            return None
        try:
            found = self._unpack(name)
        except BlockError as reason:
            raise RunError(f"{self.path / name} {reason}{self._offer(other, reason)}") from None
        self._saved_step = found[0].step
        return found

    def before_last(self) -> Saved | None:
        """What the checkpoint before the last one knows, if that can be used."""
        try:
            return self._unpack(PREVIOUS)[0]
        except BlockError:
            return None

    def _unpack(self, name: str) -> tuple[Saved, Snapshot]:
        path = self.path / name
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            raise DamagedError("is not there") from None
        except OSError as reason:
            raise DamagedError(f"cannot be read ({reason.strerror})") from None
        if data.startswith(_UNCHECKED):
            raise BlockError(
                "was written before checkpoints had checksums, and is not read any more; finish "
                "the run with the version that began it, or give another folder with --out"
            )
        blocks = unpack(data, _KIND, _KNOWN)
        movers = []
        for name in ("connectivity", "tension", "viscosity"):
            saved: list[bytes] = []
            while (key := f"{name}/{len(saved)}") in blocks:
                saved.append(blocks[key].value)
            movers.append(tuple(saved))
        return Saved(**blocks["run"].value), Snapshot(blocks["openmm"].value, *movers)

    def _offer(self, other: str, reason: BlockError) -> str:
        """How to go on from the other checkpoint, if that helps."""
        if not isinstance(reason, DamagedError):
            return ""
        try:
            saved, _ = self._unpack(other)
        except BlockError:
            return f", and {other} cannot be used either; give another folder with --out"
        option = "--resume-previous" if other == PREVIOUS else "--resume"
        return f"; {other} is whole: go on from step {saved.step} with {option}"

    def save(self, saved: Saved, state: Snapshot) -> None:
        """Write a checkpoint in place of the last one, which becomes the one before.

        Raises
        ------
        RunError
            If the system refuses; the last checkpoint is still there.
        """
        blocks = {"run": Block(asdict(saved)), "openmm": Block(state.openmm)}
        for number, surface in enumerate(state.connectivity):
            blocks[f"connectivity/{number}"] = Block(surface)
        for number, mover in enumerate(state.tension):
            blocks[f"tension/{number}"] = Block(mover)
        for number, thermostat in enumerate(state.viscosity):
            blocks[f"viscosity/{number}"] = Block(thermostat)
        data = pack(_KIND, blocks)
        with self.writing():
            replace(self.path / CHECKPOINT, data, self.path / PREVIOUS)
        self._saved_step = saved.step

    def go_back(self) -> None:
        """Put the checkpoint before the last one in the place of the last one.

        Raises
        ------
        RunError
            If the system refuses.
        """
        with self.writing():
            with naming(self.path / PREVIOUS):
                data = (self.path / PREVIOUS).read_bytes()
            replace(self.path / CHECKPOINT, data)

    @contextlib.contextmanager
    def writing(self) -> Iterator[None]:
        """Errors of the system inside, such as a full disk, become a RunError."""
        try:
            yield
        except OSError as reason:
            if self._saved_step is None:
                raise RunError(f"{describe(reason)}, then start again") from None
            if not (self.path / CHECKPOINT).exists():
                raise RunError(
                    f"{self.path}: the folder of the run has vanished, or its checkpoint "
                    f"({describe(reason)}); bring it back and go on with --resume, or start again"
                ) from None
            raise RunError(
                f"{describe(reason)}, then go on from step {self._saved_step} with --resume"
            ) from None
