"""OpenMM's own C++ tests of its platform Reference, on platform Helfrich.

    python tests/openmm_cpp_suite.py CHECKOUT [TEST …]

CHECKOUT is as for `openmm_suite.py`. Each program of `platforms/reference/tests`, and of the
plugins for Amoeba, Drude and RPMD, is compiled from there, but with
`tests/cpp/openmm/ReferenceTests.h` in place of the header that chooses the platform, and run. Tests
are called like their files, such as TestReferenceEwald; all are run if none is named. Many draw
random numbers and fail now and then, so that what fails is run twice more; what fails then, too, is
run on platform Reference: if it fails there, it is not ours. Ends with 1 if anything of ours fails,
or cannot be compiled.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import openmm
from openmmhelfrich import _core

OPENMM = Path(openmm.__file__).parent.parent / "OpenMM.libs"
HEADERS = Path(__file__).resolve().parent / "cpp" / "openmm"
PLUGINS = ("Amoeba", "Drude", "RPMD")
# Three programs have it in themselves.
OWN_PLATFORM = re.compile(r"^ReferencePlatform platform;$", re.MULTILINE)


def build(checkout, source, program):
    """Compile a test; returns what is wrong, or nothing."""
    headers = [HEADERS, checkout / "tests", *checkout.glob("plugins/*/tests"), source.parent]
    headers += [OPENMM / "include", OPENMM / "include/openmm/reference"]
    libraries = [OPENMM / "lib", OPENMM / "lib/plugins"]
    command = [*os.environ.get("CXX", "c++").split(), "-std=c++17", "-O1", "-w"]
    command += [f"-I{folder}" for folder in headers]
    # From standard input, because a compiler looks for headers beside the source first.
    command += ["-x", "c++", "-", "-o", program]
    for folder in libraries:
        command += [f"-L{folder}", f"-Wl,-rpath,{folder}"]
    command.append("-lOpenMM")
    for name in PLUGINS:
        command += [f"-lOpenMM{name}", f"-lOpenMM{name}Reference"]
    text = OWN_PLATFORM.sub('#include "ReferenceTests.h"', source.read_text(encoding="utf-8"))
    found = subprocess.run(
        command, input=text, capture_output=True, text=True, cwd=program.parent, check=False
    )
    errors = [line for line in found.stderr.splitlines() if "error" in line]
    return "" if found.returncode == 0 else (errors or ["it says nothing"])[0]


def run(program, platform):
    """Run a test; returns what is wrong, or nothing."""
    environment = os.environ | {
        "HELFRICH_LIBRARY": str(_core.LIBRARY_PATH),
        "HELFRICH_TESTED_PLATFORM": platform,
    }
    try:
        found = subprocess.run(
            [program], env=environment, capture_output=True, text=True, timeout=1800, check=False
        )
    except subprocess.TimeoutExpired:
        return "takes more than half an hour"
    said = (found.stdout + found.stderr).strip().splitlines()
    return "" if found.returncode == 0 else f"{(said or [''])[-1]} (status {found.returncode})"


def judge(checkout, source, place):
    """A test with what has come of it, and why."""
    program = place / source.stem
    if wrong := build(checkout, source, program):
        return "cannot be compiled", wrong
    tries = []
    while len(tries) < 3 and (wrong := run(program, "Helfrich")):
        tries.append(wrong)
    if len(tries) < 3:
        return ("passed", f"at try {len(tries) + 1}: {tries[-1]}") if tries else ("passed", "")
    if theirs := run(program, "Reference"):
        return "fails on Reference", theirs
    return "failed", tries[0]


def main():
    """Compile, run, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkout", type=Path)
    parser.add_argument("tests", nargs="*", metavar="TEST")
    parser.add_argument("--workers", type=int, default=2, help="processes (default: 2)")
    options = parser.parse_intermixed_args()
    checkout = options.checkout.resolve()
    folders = ("platforms/reference/tests", "plugins/*/platforms/reference/tests")
    sources = {
        path.stem: path
        for folder in folders
        for path in sorted(checkout.glob(f"{folder}/Test*.cpp"))
    }
    if not sources:
        parser.error(f"there are no tests in {checkout}; name a checkout of OpenMM's repository")
    if unknown := set(options.tests) - sources.keys():
        parser.error(f"there is no test {min(unknown)}; the first is {min(sources)}")
    chosen = options.tests or list(sources)
    counts = {}
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(options.workers) as pool:
        jobs = [pool.submit(judge, checkout, sources[name], Path(place)) for name in chosen]
        for name, job in zip(chosen, jobs, strict=True):
            outcome, why = job.result()
            counts[outcome] = counts.get(outcome, 0) + 1
            if outcome != "passed" or why:
                print(f"{name}: {outcome}: {why}", flush=True)
    print(", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items())))
    sys.exit(1 if counts.keys() & {"failed", "cannot be compiled"} else 0)


if __name__ == "__main__":
    main()
