"""Whether the models of the thread team can fail: each change below takes away what it needs.

    python tests/loom/weaken.py [TARGET_FOLDER]

The models must fail with each of them. Exits with 1 if they pass with one.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# What is lost, file, text, what takes its place.
CHANGES = [
    (
        "the number of a run is stored after its job",
        "mod.rs",
        "load(Relaxed) + 1, SeqCst)",
        "load(Relaxed) + 1, Relaxed)",
    ),
    (
        "who sees a run sees its job",
        "waiting.rs",
        "self.run.0.load(Acquire)",
        "self.run.0.load(Relaxed)",
    ),
    (
        "the caller looks who sleeps after it stores the run",
        "mod.rs",
        "    fn wake(&self) {\n        one_order();",
        "    fn wake(&self) {",
    ),
    (
        "a member looks for a run after it says that it sleeps",
        "waiting.rs",
        "sleeping.store(true, SeqCst);\n        one_order();",
        "sleeping.store(true, SeqCst);",
    ),
    (
        "sleepers are woken for a run",
        "mod.rs",
        "self.wake();\n        shared.take_part(0)",
        "shared.take_part(0)",
    ),
    ("sleepers are woken for the end", "mod.rs", "self.wake();\n        for", "for"),
    (
        "members say that they sleep",
        "waiting.rs",
        "sleeping.store(true, SeqCst);",
        "",
    ),
    (
        "the last at a barrier has what others wrote",
        "mod.rs",
        "fetch_add(1, AcqRel)",
        "fetch_add(1, std::sync::atomic::Ordering::Release)",
    ),
    (
        "who comes to a barrier leaves what he wrote",
        "mod.rs",
        "fetch_add(1, AcqRel)",
        "fetch_add(1, std::sync::atomic::Ordering::Acquire)",
    ),
    (
        "who opens a barrier passes on what others wrote",
        "mod.rs",
        "passed.wrapping_add(1), SeqCst)",
        "passed.wrapping_add(1), Relaxed)",
    ),
    (
        "who sees a barrier open sees what others wrote",
        "mod.rs",
        "gate.passed.load(SeqCst)",
        "gate.passed.load(Relaxed)",
    ),
    (
        "nobody is counted twice at a barrier",
        "mod.rs",
        "shared.arrived.0.store(0, Relaxed);\n            gate",
        "gate",
    ),
    (
        "the count at a barrier is back at 0 before it opens",
        "mod.rs",
        "shared.arrived.0.store(0, Relaxed);\n            "
        "gate.passed.store(passed.wrapping_add(1), SeqCst);",
        "gate.passed.store(passed.wrapping_add(1), SeqCst);\n            "
        "shared.arrived.0.store(0, Relaxed);",
    ),
    (
        "who opens a barrier wakes all",
        "mod.rs",
        "shared.wake_all();\n            return",
        "return",
    ),
    (
        "who finishes wakes the caller",
        "mod.rs",
        "fetch_add(1, SeqCst);\n            self.wake_all();",
        "fetch_add(1, SeqCst);",
    ),
    (
        "who panics wakes the others",
        "mod.rs",
        "self.gate.0.broken.store(true, SeqCst);\n            self.wake_all();",
        "self.gate.0.broken.store(true, SeqCst);",
    ),
    (
        "who finishes leaves what he wrote",
        "mod.rs",
        "finished.0.fetch_add(1, SeqCst)",
        "finished.0.fetch_add(1, Relaxed)",
    ),
    (
        "the caller has what members wrote",
        "mod.rs",
        "finished.0.load(SeqCst)",
        "finished.0.load(Relaxed)",
    ),
    (
        "the caller waits for all",
        "mod.rs",
        "shared.wait(|| shared.finished.0.load(SeqCst) as usize == shared.size - 1);",
        "",
    ),
    (
        "who rings looks who waits after his change",
        "waiting.rs",
        "one_order();\n        if self.blocked",
        "if self.blocked",
    ),
    (
        "who waits looks after he says so",
        "waiting.rs",
        "self.blocked.0.fetch_add(1, SeqCst);\n        one_order();",
        "self.blocked.0.fetch_add(1, SeqCst);",
    ),
    (
        "who rings waits for those who are about to sleep",
        "waiting.rs",
        "drop(self.asleep.lock().unwrap_or_else(PoisonError::into_inner));",
        "",
    ),
    ("all who wait are woken", "waiting.rs", "notify_all", "notify_one"),
    (
        "members at a broken barrier give up",
        "mod.rs",
        "is_open() || gate.broken.load(SeqCst)",
        "is_open()",
    ),
    (
        "a barrier is whole again in the next run",
        "mod.rs",
        "shared.gate.0.broken.store(false, Relaxed);",
        "",
    ),
    (
        "nobody is left at a broken barrier",
        "mod.rs",
        "shared.arrived.0.store(0, Relaxed);\n            let panic",
        "let panic",
    ),
]


def models_pass(folder: Path, target: str) -> bool:
    """Build and run the models, of which the short ones come first."""
    cargo = ["cargo", "test", "-q", "--release", "--locked", "--target-dir", target]
    cargo += ["--manifest-path", str(folder / "tests/loom/Cargo.toml")]
    if subprocess.run([*cargo, "--no-run"]).returncode != 0:
        raise SystemExit("weaken.py: the changed team does not compile; its message is above.")
    environment = dict(os.environ, RUST_BACKTRACE="0")
    return all(
        subprocess.run([*cargo, name], env=environment, capture_output=True).returncode == 0
        for name in ("two_", "three_")
    )


def main() -> int:
    """Make each change in a copy."""
    target = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/loom")
    missed = 0
    for what, file, old, new in CHANGES:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for part in ("src/team", "tests/loom"):
                shutil.copytree(ROOT / part, folder / part)
            path = folder / "src/team" / file
            text = path.read_text()
            if text.count(old) != 1:
                raise SystemExit(f"weaken.py: {file} has {text.count(old)} places for: {what}")
            path.write_text(text.replace(old, new))
            passed = models_pass(folder, target)
        missed += passed
        print("MISSED" if passed else "found ", what, flush=True)
    print(f"{len(CHANGES) - missed} of {len(CHANGES)} changes were found")
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
