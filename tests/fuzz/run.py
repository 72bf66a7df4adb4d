"""Look for faults at the doors of openmm-helfrich: `make fuzz MINUTES=10`.

Without arguments each door gets the same part of the time. Inputs are changed at random; with
`atheris` installed, coverage of the Python code says which ones are kept to go on from. What is
found is saved in out/fuzz/DOOR, a file for each kind, with its traceback beside it, and replayed by

    python tests/fuzz/run.py --replay DOOR FILE
"""

from __future__ import annotations

import argparse
import contextlib
import faulthandler
import hashlib
import importlib
import os
import random
import re
import resource
import subprocess
import sys
import time
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MODULES = {
    "door_meshes": ("ply", "obj", "stl", "off", "vtk", "vtu", "vtp", "msh"),
    "door_configurations": ("toml", "vcm"),
    "door_systems": ("system", "state"),
    "door_saved": ("saved", "connectivity", "checkpoint"),
    "door_expressions": ("expression",),
}
#: Rust's own, in src/ffi/fuzz.rs, has no files: its seed does it again.
RUST, RUST_CASES = "ffi", 50_000
DOORS = [name for names in MODULES.values() for name in names]
#: An input that takes longer hangs, s; it may take so much memory more, bytes.
TIME, MEMORY = 10, 3 << 30
#: A process with more threads ends with this status, and another one goes on.
MOST_THREADS, FULL = 100, 75


def load(name: str):
    """A door by its name."""
    # The tests' meshes and forces are there.
    for place in (HERE, ROOT / "tests" / "python"):
        if str(place) not in sys.path:
            sys.path.insert(0, str(place))
    module = next(module for module, names in MODULES.items() if name in names)
    return next(door for door in importlib.import_module(module).DOORS if door.name == name)


def limit_memory() -> None:
    """Let a small file not take all memory."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, hard))


class Session:
    """The inputs of one door in one process."""

    def __init__(self, name: str, seconds: float, out: Path):
        self.door, self.out = load(name), out
        self.until = time.monotonic() + seconds
        self.cases = 0
        self.kinds: set[str] = set()

    def check(self, data: bytes) -> None:
        """One input; a fault of a new kind is saved."""
        self.cases += 1
        last = self.out / "last-input"
        last.write_bytes(data)
        start = time.monotonic()
        faulthandler.dump_traceback_later(3 * TIME, exit=True)
        try:
            self.door.check(data)
            if time.monotonic() - start > TIME:
                raise TimeoutError(f"took {time.monotonic() - start:.1f} s")
        except Exception as fault:
            self.save(data, fault)
        finally:
            faulthandler.cancel_dump_traceback_later()

    def save(self, data: bytes, fault: Exception) -> None:
        """A fault, if there was none of its kind: the same exception from the same line."""
        frames = traceback.extract_tb(fault.__traceback__)
        ours = [frame for frame in frames if "openmmhelfrich" in frame.filename] or frames
        kind = f"{type(fault).__name__}-{Path(ours[-1].filename).stem}-{ours[-1].lineno}"
        kind += "-" + re.sub(r"[^a-z]+", "-", str(fault).lower())[:40]
        if kind in self.kinds:
            return
        self.kinds.add(kind)
        path = self.out / f"fault-{hashlib.sha256(data).hexdigest()[:12]}"
        path.write_bytes(data)
        path.with_suffix(".txt").write_text("".join(traceback.format_exception(fault)))
        print(
            f"FAULT {self.door.name} {kind}: {str(fault)[:300]}\n  {replay(self.door.name, path)}"
        )

    def plain(self, seed: int) -> None:
        """Inputs changed at random, some of them again and again."""
        dice = random.Random(seed)
        pool = list(self.door.seeds())
        for data in pool:
            self.check(data)
        while time.monotonic() < self.until and not self.is_full():
            data = dice.choice(pool)
            for _ in range(dice.choice((1, 1, 1, 2, 5))):
                data = self.door.change(data, dice)
            self.check(data)

    def guided(self, atheris, seed: int) -> None:
        """The same, and what reaches new lines of Python is kept."""
        corpus = self.out / "corpus"
        corpus.mkdir(exist_ok=True)
        for data in self.door.seeds():
            (corpus / hashlib.sha256(data).hexdigest()[:16]).write_bytes(data)

        def mutator(data, max_size, number):
            dice = random.Random(number)
            return self.door.change(bytes(data), dice)[:max_size]

        seconds = max(1, int(self.until - time.monotonic()))
        options = [f"-max_total_time={seconds}", f"-seed={seed}", "-max_len=60000", "-verbosity=0"]
        options += ["-timeout=60", "-rss_limit_mb=0", f"-artifact_prefix={self.out}/crash-"]
        atheris.Setup(["fuzz", *options, str(corpus)], self.counted, custom_mutator=mutator)
        atheris.Fuzz()

    def counted(self, data: bytes) -> None:
        """A case under libFuzzer, which ends the process without a last word."""
        self.check(data)
        (self.out / "cases").write_text(str(self.cases))
        if self.is_full():
            os._exit(FULL)

    @staticmethod
    def is_full() -> bool:
        """Whether another process should go on: OpenMM leaves threads of what it refuses."""
        return len(os.listdir("/proc/self/task")) > MOST_THREADS


def replay(name: str, path: Path) -> str:
    """The command that does an input again."""
    return f".venv/bin/python tests/fuzz/run.py --replay {name} {path}"


def child(name: str, seconds: float, seed: int, out: Path, guided: bool) -> None:
    """All of one process."""
    sys.stdout.reconfigure(line_buffering=True)
    atheris = None
    if guided:
        with contextlib.suppress(ImportError):
            import atheris
    if atheris is not None:
        with atheris.instrument_imports(include=["openmmhelfrich"]):
            importlib.import_module("openmmhelfrich")
            session = Session(name, seconds, out)
    else:
        session = Session(name, seconds, out)
    limit_memory()
    if atheris is not None:
        session.guided(atheris, seed)
    else:
        session.plain(seed)
        (out / "cases").write_text(str(session.cases))
        if session.is_full():
            sys.exit(FULL)


def run(name: str, seconds: float, seed: int, guided: bool) -> tuple[int, int]:
    """One door for some time, in processes of its own; returns the cases and the faults."""
    out = ROOT / "out" / "fuzz" / name
    out.mkdir(parents=True, exist_ok=True)
    end = time.monotonic() + seconds
    cases, faults, turn = 0, 0, 0
    while (left := end - time.monotonic()) > 1:
        (out / "cases").unlink(missing_ok=True)
        command = [sys.executable, __file__, "--child", name, "--seconds", f"{left:.0f}"]
        command += ["--seed", str(seed + turn), *([] if guided else ["--plain"])]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
        found = [line for line in done.stdout.splitlines() if line.startswith(("FAULT", "  "))]
        print(*found, sep="\n", end="\n" if found else "", flush=True)
        faults += sum(line.startswith("FAULT") for line in found)
        with contextlib.suppress(FileNotFoundError, ValueError):
            cases += int((out / "cases").read_text())
        if done.returncode == 0:
            break
        if done.returncode == FULL:
            turn += 1
            continue
        if not (out / "last-input").exists():
            raise RuntimeError(f"{name} does not start: {done.stderr[-2000:]}")
        # The process itself has died or hung.
        faults += 1
        turn += 1
        path = out / f"crash-{seed + turn}"
        (out / "last-input").rename(path)
        path.with_suffix(".txt").write_text(done.stderr[-20000:])
        print(f"FAULT {name} ended with {done.returncode}\n  {replay(name, path)}", flush=True)
    return cases, faults


def run_rust(seconds: float, seed: int) -> tuple[int, int]:
    """The properties of src/ffi/fuzz.rs for some time, with one seed after another."""
    end = time.monotonic() + seconds
    cases, faults = 0, 0
    while time.monotonic() < end:
        setting = {
            "PROPTEST_CASES": str(RUST_CASES),
            "PROPTEST_RNG_SEED": str(seed + faults + cases),
        }
        command = ["cargo", "test", "-q", "--release", "--locked", "--lib", "ffi::fuzz"]
        done = subprocess.run(
            command, capture_output=True, text=True, cwd=ROOT, env={**os.environ, **setting}
        )
        passed = re.search(r"(\d+) passed", done.stdout)
        cases += RUST_CASES * int(passed.group(1)) if passed else 0
        if done.returncode != 0:
            faults += 1
            again = " ".join([*(f"{name}={value}" for name, value in setting.items()), *command])
            out = ROOT / "out" / "fuzz" / RUST
            out.mkdir(parents=True, exist_ok=True)
            (out / f"fault-{seed + faults}.txt").write_text(done.stdout + done.stderr)
            print(f"FAULT {RUST}: {done.stdout[-400:]}\n  {again}", flush=True)
    return cases, faults


def main() -> int:
    """What the command line says; 1 if there was a fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=5, help="for all doors together")
    parser.add_argument("--door", action="append", choices=[*DOORS, RUST], help="default: all")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="default: the time")
    parser.add_argument("--plain", action="store_true", help="without atheris")
    parser.add_argument("--replay", nargs=2, metavar=("DOOR", "FILE"), help="one input again")
    parser.add_argument("--child", choices=DOORS, help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.replay:
        load(given.replay[0]).check(Path(given.replay[1]).read_bytes())
        print("nothing is wrong")
        return 0
    if given.child:
        out = ROOT / "out" / "fuzz" / given.child
        child(given.child, given.seconds, given.seed, out, not given.plain)
        return 0
    doors = given.door or [*DOORS, RUST]
    total = 0
    for number, name in enumerate(doors):
        seed = (given.seed + 1000 * number) % 2**31
        start = time.monotonic()
        seconds = 60 * given.minutes / len(doors)
        if name == RUST:
            cases, faults = run_rust(seconds, seed)
        else:
            cases, faults = run(name, seconds, seed, not given.plain)
        total += faults
        spent = time.monotonic() - start
        print(f"{name}: seed {seed}, {spent:.0f} s, {cases} cases, {faults} faults", flush=True)
    return int(total > 0)


if __name__ == "__main__":
    sys.exit(main())
