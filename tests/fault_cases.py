"""What happens to the runs of `faults.py`: a function for each fault, which lets it strike once.

Each begins a run, disturbs it, checks how it ends and what it says, takes the cause away, lets the
run go on to its end and compares all files. It returns how many faults struck, which is none if the
run had come to its end before, and raises `Wrong` if anything is not as it should be.
"""

import contextlib
import datetime
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import fault_kinds
from openmmhelfrich.simulation.run_folder import RunFolder

sys.path.append(str(Path(__file__).resolve().parent / "python"))
from dask_processes import dask_cluster

COMMANDS, PROGRAMS = ("toml", "vcm"), ("sweep", "reporters")
LAST, PREVIOUS = "checkpoint.bin", "checkpoint-previous.bin"
# Of the function of the sweep, under which results are stored.
NAME = "fault_kinds.slow_square"
DAY = 86400.0


class Wrong(Exception):
    """Something is not as it should be."""


class Case:
    """One run in a folder of its own.

    kind: of the run; inputs, quiet: folders; length: of a run in peace, s; chance: random numbers;
    place: for this case; out: where the run writes, below the `place`.
    """

    def __init__(self, kind, inputs, quiet, length, chance, place):
        self.kind, self.inputs, self.quiet = kind, inputs, quiet
        self.length, self.chance, self.place = length, chance, place
        place.mkdir()
        self.out = place / "out"
        self._logs = 0

    def start(self, *options, before=lambda: None, **named):
        """Begin the run, or go on with it."""
        self._logs += 1
        # Beside the folder, which a fault may take away.
        log = self.place.with_name(f"{self.place.name}-{self._logs}.log")

        def work():
            before()
            fault_kinds.KINDS[self.kind](self.inputs, self.out, *options, **named)

        return fault_kinds.Process(work, log)

    def moment(self, part=1.0):
        """Wait for a moment of the run."""
        time.sleep(self.chance.uniform(0, part * self.length))

    def finish(self, *options, **named):
        """Let it go on to its end, and compare."""
        status, said = self.start(*options, **named).wait()
        if status:
            raise Wrong(f"it cannot go on (status {status}):\n{said[-2000:]}")
        self.compare()
        return said

    def compare(self):
        """Compare all files with those of a run in peace."""
        try:
            differ = fault_kinds.differences(self.quiet, self.out)
        except Exception as reason:
            raise Wrong(f"files cannot be read: {reason}") from None
        if differ:
            raise Wrong(f"these files differ: {', '.join(differ)}")

    def stop(self, number=signal.SIGKILL):
        """Stop the run at a random moment; returns whether it was still at work."""
        process = self.start()
        self.moment()
        process.kill(number)
        return process.wait()[0] != 0


def complaint(ending, *words):
    """Check that a run has ended with a message that has all of these."""
    status, said = ending
    if status <= 0:
        raise Wrong(f"status {status} where an error is due, and it said:\n{said[-2000:]}")
    if "Traceback" in said or "Exception ignored" in said:
        raise Wrong(f"a traceback:\n{said[-3000:]}")
    lines = said.strip().splitlines()
    last = lines[-1] if lines else ""
    for word in words:
        if str(word) not in last:
            raise Wrong(f"the message does not say {word!s}: {last}")
    return last


def kill(case):
    """SIGKILL at a random moment; then it goes on in peace, or is killed again."""
    count = 0
    while case.stop():
        count += 1
    case.compare()
    return count


@contextlib.contextmanager
def small_disk(case, size):
    """A file system of so many bytes; yields a function that gives it another size."""
    disk = case.place / "disk"
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", disk], check=True)
    case.out = disk / "out"
    try:
        yield lambda size: subprocess.run(["mount", "-o", f"remount,size={size}", disk], check=True)
    finally:
        subprocess.run(["umount", "-l", disk], check=True)


def full_disk(case):
    """A disk of random size, which grows until there is room."""
    needed = sum(path.stat().st_size for path in case.quiet.rglob("*") if path.is_file())
    size, count = 0, 0
    with small_disk(case, 4096) as resize:
        while True:
            size += int(case.chance.uniform(4096, needed / 2))
            resize(size)
            ending = case.start().wait()
            if ending[0] == 0:
                break
            advice = "No space left on device; free some space there"
            complaint(ending, case.out, advice)
            count += 1
        resize("100m")
        case.finish()
    return count


def read_only(case):
    """The folder becomes one that nobody can write to; then it can be written to again."""
    with small_disk(case, "100m"):
        disk = case.out.parent
        process = case.start()
        if case.chance.random() < 0.9:
            case.moment()
        # A mount above the other one, which files that are open do not hold.
        subprocess.run(["mount", "--bind", disk, disk], check=True)
        remount = ["mount", "-o", "remount,bind,ro", disk]
        while subprocess.run(remount, capture_output=True, check=False).returncode:
            time.sleep(0.001)
        ending = process.wait()
        if ending[0]:
            complaint(ending, case.out, "Read-only file system; make the file system writable")
            again = case.start().wait()
            complaint(again, case.out, "Read-only file system; make the file system writable")
        subprocess.run(["umount", disk], check=True)
        case.finish()
    return int(ending[0] != 0)


def vanished_folder(case):
    """The folder is moved away in the middle, and is brought back or has gone for good."""
    away, count = case.place / "away", 0
    process = case.start()
    # A sweep makes its folder when there is a first result.
    begun = case.out / "cache" / NAME if case.kind == "sweep" else case.out
    while not begun.exists() and not process.ended():
        time.sleep(0.001)
    case.moment(0.9)
    case.out.rename(away)
    ending = process.wait()
    if ending[0]:
        last = complaint(ending, case.out)
        if not any(word in last for word in ("bring it back", "see whether its folder is there")):
            raise Wrong(f"the message does not say what to do: {last}")
        count = 1
    if case.out.exists():
        raise Wrong(f"a new folder, with {', '.join(os.listdir(case.out))}")
    if case.chance.random() < 0.7:
        away.rename(case.out)
    case.finish()
    return count


def interrupt(case, number, again=None):
    """A signal at random moments, until the run has come to its end."""
    count = 0
    while True:
        process = case.start()
        case.moment()
        process.kill(number)
        if again is not None:
            time.sleep(case.chance.uniform(0, 0.02))
            process.kill(again)
        begin = time.monotonic()
        status, said = process.wait()
        if time.monotonic() - begin > 15:
            raise Wrong("it took more than 15 s to end")
        if status == 0:
            break
        count += 1
        if case.kind in COMMANDS and ("Traceback" in said or "Exception ignored" in said):
            raise Wrong(f"a traceback:\n{said[-3000:]}")
        # A second Ctrl-C ends at once, and so does any before the command has begun.
        at_once = again is not None or said.strip() in ("", "Aborted!") or case.kind in PROGRAMS
        if not (at_once and status in (-number, 1, 128 + number)):
            complaint((status, said), "Interrupted at step", "Go on with --resume.")
            if status != 128 + number:
                raise Wrong(f"status {status} after signal {number}")
    case.compare()
    return count


def sigterm(case):
    """SIGTERM."""
    return interrupt(case, signal.SIGTERM)


def sigint(case):
    """Ctrl-C."""
    return interrupt(case, signal.SIGINT)


def sigint_twice(case):
    """Ctrl-C twice in quick succession."""
    return interrupt(case, signal.SIGINT, signal.SIGINT)


def second_process(case):
    """Another process in the same folder: of a run refused, of a sweep a helper."""
    process = case.start()
    begun = case.out / (".lock" if case.kind in COMMANDS else "")
    while not begun.exists() and not process.ended():
        time.sleep(0.001)
    case.moment(0.8)
    options = () if case.kind not in COMMANDS or case.chance.random() < 0.7 else ("--seed", "3")
    ending = case.start(*options).wait()
    alive = not process.ended()
    if case.kind == "sweep":
        if ending[0]:
            raise Wrong(f"the second one has failed:\n{ending[1][-2000:]}")
        alive = True
    elif alive:
        last = complaint(ending, case.out)
        if "another process is running in" not in last and "is not empty" not in last:
            raise Wrong(f"the message is another one: {last}")
        if "--out" not in last:
            raise Wrong(f"the message does not say what to do: {last}")
    status, said = process.wait()
    if status:
        raise Wrong(f"the first one has failed (status {status}):\n{said[-2000:]}")
    case.compare()
    return int(alive)


def damage(data, chance):
    """Bytes that are not as they were; None for no file at all."""
    length, changed = len(data), bytearray(data)
    way = chance.randrange(5)
    if way == 0:
        for _ in range(chance.randint(1, 8)):
            changed[chance.randrange(length)] ^= 1 << chance.randrange(8)
    elif way == 1:
        del changed[chance.randrange(length) :]
    elif way == 2:
        begin = chance.randrange(length)
        end = min(length, begin + chance.randint(1, 4096))
        changed[begin:end] = bytes(end - begin)
    elif way == 3:
        changed += chance.randbytes(chance.randint(1, 100))
    else:
        return None
    return bytes(changed)


def put(path, data):
    """Give a file these bytes; None for no file."""
    path.unlink(missing_ok=True)
    if data is not None:
        path.write_bytes(data)


def damaged_checkpoint(case):
    """Bytes of the checkpoint change, or of a stored result."""
    case.stop()
    if case.kind == "sweep":
        return _damaged_result(case)
    path = case.out / LAST
    if not path.exists():
        case.finish()
        return 0
    whole = path.read_bytes()
    harmed = damage(whole, case.chance)
    if harmed == whole:
        case.finish()
        return 0
    put(path, harmed)
    offered = (case.out / PREVIOUS).exists()
    before = _contents(case.out)
    culprit = case.out if harmed is None and not offered else path
    complaint(case.start().wait(), culprit, "--resume-previous" if offered else "--out")
    unchanged(case.out, before)
    if offered:
        case.finish("--resume-previous")
    else:
        put(path, whole)
        case.finish()
    return 1


def _contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def unchanged(folder, before):
    """Check that a folder is as it was, but for changes that a kill had left in a journal."""
    journals = {path for path in before if path.suffix == ".journal"}
    after = _contents(folder)
    for path in before.keys() | after.keys():
        made_whole = path in journals or path.with_name(path.name + ".journal") in journals
        if not made_whole and before.get(path) != after.get(path):
            raise Wrong(f"what was refused has changed {path.name}")


def _damaged_result(case):
    stored = sorted(case.out.rglob("*.npz"))
    if not stored:
        case.finish()
        return 0
    path = case.chance.choice(stored)
    whole = path.read_bytes()
    harmed = damage(whole, case.chance)
    put(path, harmed)
    said = case.finish()
    # One that was not said must be without a meaning, such as of the time of a file.
    return int(str(path) in said or harmed is None)


def foreign_checkpoint(case):
    """In its place, the checkpoint of a run of another seed, platform, kind or mesh."""
    case.stop()
    path = case.out / LAST
    strangers = sorted((case.inputs / "strangers").glob(f"{case.kind}-*.bin"))
    if not path.exists():
        case.finish()
        return 0
    whole = path.read_bytes()
    for stranger in strangers:
        shutil.copy(stranger, path)
        before = _contents(case.out)
        # Or --resume-previous, which is as good.
        last = complaint(case.start().wait(), case.out)
        if "--out" not in last and "--resume-previous" not in last:
            raise Wrong(f"the message on {stranger.name} does not say what to do: {last}")
        unchanged(case.out, before)
    put(path, whole)
    case.finish()
    return len(strangers)


def make_strangers(kind, inputs, out):
    """Checkpoints of other runs, for `foreign_checkpoint`."""
    folder = inputs / "strangers"
    folder.mkdir(exist_ok=True)
    name = {"toml": "run.toml", "vcm": "run.txt"}[kind]
    other = "vcm" if kind == "toml" else "toml"
    changed = inputs / f"changed-{name}"
    text = (inputs / name).read_text(encoding="utf-8")
    changed.write_text(
        text.replace("radius = 400", "radius = 401").replace("Coeff 20", "Coeff 21"),
        encoding="utf-8",
    )
    for label, config, options in (
        ("seed", inputs / name, ("--seed", 77)),
        ("platform", inputs / name, ("--platform", "Reference")),
        ("kind", inputs / {"toml": "run.toml", "vcm": "run.txt"}[other], ()),
        ("system", changed, ()),
    ):

        def work(config=config, options=options, where=out / f"{kind}-{label}"):
            fault_kinds._command(config, where, "--steps", 80, *options)

        log = out / f"{kind}-{label}.log"
        status, said = fault_kinds.Process(work, log).wait()
        if status:
            raise Wrong(f"a run that should be simple:\n{said}")
        shutil.copy(out / f"{kind}-{label}" / LAST, folder / f"{kind}-{label}.bin")


def cut_tails(case):
    """A file that grows is cut at a random place, or has bytes at its end that nobody wrote."""
    case.stop()
    if case.kind == "reporters":
        return _cut_reporters(case)
    found = RunFolder(case.out).read() if (case.out / LAST).exists() else None
    if found is None or found[0].outputs is None:
        case.finish()
        return 0
    sizes = found[0].outputs["sizes"]
    names = [*sizes, *(path.name for path in case.out.glob("*.vtkhdf"))]
    path = case.out / case.chance.choice(names)
    whole = path.read_bytes()
    torn = path.name in sizes and case.chance.random() < 0.3
    length = len(whole) if torn else case.chance.randrange(len(whole) + 1)
    tail = case.chance.randbytes(case.chance.randint(1, 9999)) if torn else b""
    path.write_bytes(whole[:length] + tail)
    if length >= sizes.get(path.name, len(whole)):
        case.finish()
        return 1
    if path.with_name(path.name + ".journal").exists():
        # What the kill has left of a change may be what was cut off.
        return 0
    before = _contents(case.out)
    last = complaint(case.start().wait(), path)
    unchanged(case.out, before)
    if "with --resume-previous" in last:
        case.finish("--resume-previous")
    elif "bring the file back" in last and "--out" in last:
        path.write_bytes(whole)
        case.finish()
    else:
        raise Wrong(f"the message does not say what to do: {last}")
    return 1


def _cut_reporters(case):
    saved = case.out / "saved.chk"
    paths = [case.out / name for name in ("modes.csv", "frames.vtkhdf", "shape.h5")]
    if not saved.exists() or not all(path.exists() for path in paths):
        case.finish()
        return 0
    if saved.read_bytes() == (case.quiet / saved.name).read_bytes():
        # At its end, a run does not look at its files any more.
        return 0
    path = case.chance.choice(paths)
    whole = path.read_bytes()
    path.write_bytes(whole[: case.chance.randrange(len(whole))])
    status, said = case.start().wait()
    if status:
        complaint((status, said), path, "do not append")
        path.write_bytes(whole)
        case.finish()
    elif "are missing" in said:
        # Rows that were there when the checkpoint was saved; the rest of the run is as it is.
        if str(path) not in said:
            raise Wrong(f"the warning does not name the file: {said}")
    else:
        case.compare()
    return 1


def clock(case):
    """The system's clock jumps by up to fifty years, back and forth, while kills go on."""
    origin, begin, state = time.time(), time.monotonic(), {"jump": 0.0, "left": 0}
    local = time.localtime

    def now():
        if state["left"] == 0:
            state["left"] = case.chance.randint(1, 20)
            # Before 1970 for some, before 1980 for more.
            state["jump"] = case.chance.choice(
                (3600.0, -3600.0, DAY, -DAY, -(origin - DAY), -origin + 9 * 365 * DAY, 18250 * DAY)
            )
        state["left"] -= 1
        return origin + time.monotonic() - begin + state["jump"]

    class Jumping(datetime.datetime):
        """datetime.now() of the clock that jumps."""

        @classmethod
        def now(cls, tz=None):
            return cls.fromtimestamp(now(), tz)

    def set_clock():
        time.time = now
        time.localtime = lambda seconds=None: local(now() if seconds is None else seconds)
        datetime.datetime = Jumping

    count = 0
    while True:
        process = case.start(before=set_clock)
        case.moment(2)
        process.kill()
        status, said = process.wait()
        if status > 0:
            raise Wrong(f"it failed (status {status}):\n{said[-2000:]}")
        if status == 0:
            break
        count += 1
    case.compare()
    return max(1, count)


def lost_worker(case):
    """A worker of Dask is killed: of a scheduler of the user's, or of this machine's cores."""
    with contextlib.ExitStack() as stack:
        address = None
        if case.chance.random() < 0.5:
            address, _, workers = stack.enter_context(dask_cluster(case.place, 2))
        named = {"workers": 2} if address is None else {"scheduler": address, "workers": None}
        process = case.start(**named)
        log = case.inputs / case.place.name
        while not log.exists() and not process.ended():
            time.sleep(0.005)
        case.moment(0.3)
        busy = int(log.read_text(encoding="utf-8").split()[-1])
        struck = not process.ended()
        stored = len(list(case.out.rglob("*.npz")))
        if address is None:
            os.kill(busy, signal.SIGKILL)
        else:
            workers[0].kill()
        computed = len(log.read_text(encoding="utf-8").splitlines())
        status, said = process.wait()
    if status:
        raise Wrong(f"the sweep failed (status {status}):\n{said[-2000:]}")
    case.compare()
    count = len(log.read_text(encoding="utf-8").splitlines())
    # Those that the worker had done, and nobody had fetched, were lost with it.
    if count - computed > fault_kinds.POINTS - stored:
        raise Wrong(f"{stored} points were stored, but {count - computed} were computed after")
    case.finish()
    if len(log.read_text(encoding="utf-8").splitlines()) != count:
        raise Wrong("what was stored was computed again")
    return int(struck)


def lost_scheduler(case):
    """The scheduler of Dask is killed; a sweep without it goes on."""
    log = case.inputs / case.place.name
    with dask_cluster(case.place, 2) as (address, scheduler, _):
        process = case.start(scheduler=address, workers=None)
        while not log.exists() and not process.ended():
            time.sleep(0.005)
        case.moment(0.3)
        struck = not process.ended()
        scheduler.kill()
        ending = process.wait()
    if ending[0]:
        complaint(ending, "lost the scheduler", address, "run again to go on")
    stored = len(list(case.out.rglob("*.npz")))
    computed = len(log.read_text(encoding="utf-8").splitlines())
    case.finish()
    again = len(log.read_text(encoding="utf-8").splitlines()) - computed
    if again != fault_kinds.POINTS - stored:
        raise Wrong(f"{stored} points were stored, but {again} were computed again")
    return int(struck and ending[0] != 0)


#: By name: the function, and the kinds of run that it makes sense for.
FAULTS = {
    "kill": (kill, (*COMMANDS, *PROGRAMS)),
    "disk full": (full_disk, (*COMMANDS, *PROGRAMS)),
    "read-only folder": (read_only, (*COMMANDS, *PROGRAMS)),
    "vanished folder": (vanished_folder, (*COMMANDS, *PROGRAMS)),
    "SIGTERM": (sigterm, (*COMMANDS, *PROGRAMS)),
    "Ctrl-C": (sigint, (*COMMANDS, *PROGRAMS)),
    "Ctrl-C twice": (sigint_twice, (*COMMANDS, *PROGRAMS)),
    "second process": (second_process, (*COMMANDS, "sweep")),
    "damaged checkpoint": (damaged_checkpoint, (*COMMANDS, "sweep")),
    "foreign checkpoint": (foreign_checkpoint, COMMANDS),
    "cut tail": (cut_tails, (*COMMANDS, "reporters")),
    "clock that jumps": (clock, (*COMMANDS, *PROGRAMS)),
    "lost worker": (lost_worker, ("sweep",)),
    "lost scheduler": (lost_scheduler, ("sweep",)),
}
