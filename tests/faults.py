"""Runs that faults strike at random moments, and that go on, beside runs that nothing happens to.

    python tests/faults.py [--kills 300] [--cases 30] [--seed 1] [--fault NAME …] [KIND …]

Each kind of run (`fault_kinds.py`) is done once in peace. Then it is done over and over, each time
in a new folder, and a fault (`fault_cases.py`) strikes, until it has struck so many times. A run
that ends with an error must name the file and say what to do, without a traceback. When the cause
is taken away it goes on, and all its files must have the same bytes as those of the run in peace
(VTKHDF files of reporters the same contents). Small disks are mounted, for which one has to be
root.

Ends with 1 if anything is wrong; the folder of the case and its logs stay.
"""

import argparse
import random
import sys
import tempfile
import time
from pathlib import Path

import fault_cases
import fault_kinds
from fault_cases import FAULTS, Wrong


def strike(name, kind, wanted, quiet, length, place, seed):
    """Let a fault strike so many times; returns how often, in how many runs, and what is wrong."""
    fault, _ = FAULTS[name]
    inputs = place / "inputs"
    chance = random.Random(f"{name}{kind}{seed}")
    struck = runs = 0
    wrong = []
    # A fault that hardly ever strikes is a mistake of the script.
    while struck < wanted and runs < 10 * wanted:
        runs += 1
        folder = place / f"{kind}-{name.replace(' ', '-')}-{runs}"
        case = fault_cases.Case(kind, inputs, quiet, length, chance, folder)
        try:
            struck += fault(case)
        except Wrong as reason:
            struck += 1
            wrong.append(f"{folder}: {reason}")
        else:
            for log in place.glob(f"{folder.name}-*.log"):
                log.unlink()
            fault_kinds.remove(folder)
    return struck, runs, wrong


def main():
    """Let faults strike, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    known = fault_kinds.KINDS
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"of {', '.join(known)}")
    parser.add_argument("--kills", type=int, default=300, help="of each kind")
    parser.add_argument("--cases", type=int, default=30, help="of other faults, of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fault", action="append", choices=FAULTS, help="only this; repeatable")
    options = parser.parse_args()
    if unknown := set(options.kinds) - set(known):
        parser.error(f"there is no kind {min(unknown)}; known are {', '.join(known)}")
    place = Path(tempfile.mkdtemp(prefix="faults-"))
    inputs = place / "inputs"
    inputs.mkdir()
    fault_kinds.prepare(inputs)
    wrong = []
    print(
        f"{'fault':20}  {'kind':10}  {'faults':>6}  {'runs':>5}  {'wrong':>5}  {'s':>5}", flush=True
    )
    for kind in options.kinds or known:
        quiet = fault_cases.Case(kind, inputs, None, 0, None, place / f"{kind}-quiet")
        begin = time.monotonic()
        status, said = quiet.start().wait()
        length = time.monotonic() - begin
        if status:
            sys.exit(f"faults: a run in peace failed:\n{said}")
        if kind in fault_cases.COMMANDS:
            fault_cases.make_strangers(kind, inputs, place)
        for name in options.fault or FAULTS:
            if kind in FAULTS[name][1]:
                begin = time.monotonic()
                wanted = options.kills if name == "kill" else options.cases
                struck, runs, found = strike(
                    name, kind, wanted, quiet.out, length, place, options.seed
                )
                wrong += found
                took = time.monotonic() - begin
                print(
                    f"{name:20}  {kind:10}  {struck:6}  {runs:5}  {len(found):5}  {took:5.0f}",
                    flush=True,
                )
    if wrong:
        print("\n".join(wrong))
        sys.exit(1)


if __name__ == "__main__":
    main()
