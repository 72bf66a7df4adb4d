"""OpenMM's own Python tests, with platform Helfrich as the default one.

    python tests/openmm_suite.py CHECKOUT [FILE …]

CHECKOUT is a copy of https://github.com/openmm/openmm of the release that is installed; files are
those in its `wrappers/python/tests`, all if none is named. What fails is run again on platform
Reference: what fails there, too, is not ours. A test fails that takes more than so many minutes;
those of large boxes of water would take hours on any platform but those of GPUs. Ends with 1 if
anything of ours fails.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

TESTS = Path("wrappers/python/tests")


def run(folder, tests, platform, options):
    """Names of the tests that have failed, and what pytest says at the end."""
    with tempfile.TemporaryDirectory() as cache:
        command = [sys.executable, "-m", "pytest", "-q", "--tb=no", "-rfE", "-p", "openmmhelfrich"]
        command += ["-o", f"cache_dir={cache}", "-n", str(options.workers), "--dist", "load"]
        command += ["-o", f"faulthandler_timeout={60 * options.minutes}"]
        command += ["-o", "faulthandler_exit_on_timeout=true", *tests]
        environment = os.environ | {"OPENMM_DEFAULT_PLATFORM": platform}
        found = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
    if found.returncode not in (0, 1):
        sys.exit(f"openmm_suite: pytest could not run:\n{found.stdout[-2000:]}{found.stderr}")
    failed = sorted(set(re.findall(r"^(?:FAILED|ERROR) (\S+)", found.stdout, re.MULTILINE)))
    return failed, found.stdout.strip().splitlines()[-1]


def main():
    """Run, and say what has come of it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkout", type=Path)
    parser.add_argument("files", nargs="*", metavar="FILE")
    parser.add_argument("--workers", type=int, default=2, help="processes (default: 2)")
    parser.add_argument("--minutes", type=float, default=10, help="of one test (default: 10)")
    options = parser.parse_intermixed_args()
    folder = options.checkout / TESTS
    if not folder.is_dir():
        parser.error(f"there is no {folder}; name a checkout of OpenMM's repository")
    failed, summary = run(folder, options.files, "Helfrich", options)
    print(f"Helfrich: {summary}", flush=True)
    if not failed:
        return
    theirs, summary = run(folder, failed, "Reference", options)
    print(f"Reference, what has failed: {summary}")
    ours = [name for name in failed if name not in theirs]
    for name in failed:
        print(f"{'ours ' if name in ours else 'OpenMM'}  {name}")
    sys.exit(1 if ours else 0)


if __name__ == "__main__":
    main()
