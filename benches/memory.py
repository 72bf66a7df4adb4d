"""Peak memory of one vesicle: `python memory.py PARTS PLATFORM [THREADS]`, a line of JSON.

A process of its own, since memory that was in use once is not told from memory in use.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

__all__ = ["measure"]


def measure(parts, target):
    """Peak memory, MiB, and seconds for a Verlet run of a few steps on an icosphere, by stage.

    Parameters
    ----------
    parts : int
        Parts of a side of the icosahedron.
    target : Target
        Platform.
    """
    command = [sys.executable, __file__, str(parts), target.platform, json.dumps(target.properties)]
    said = subprocess.run(command, capture_output=True, text=True, check=False)
    if said.returncode != 0:
        raise RuntimeError(f"memory: {said.stderr.strip().splitlines()[-1]}")
    return json.loads(said.stdout.splitlines()[-1])


def _peak():
    """Most memory that this process has had, MiB.

    Not from getrusage: a child begins there with the peak of the process that has started it.
    """
    for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    raise OSError("/proc/self/status has no line VmHWM")


def _main(parts, platform, properties):
    from openmmhelfrich import Vesicle
    from openmmhelfrich._benchmark import Target, sphere, start

    stages, begin = {}, time.perf_counter()

    def stage(name):
        nonlocal begin
        now = time.perf_counter()
        stages[name] = {"seconds": now - begin, "peak": _peak()}
        begin = now

    stage("imports")
    vesicle = Vesicle(sphere(parts))
    stage("mesh")
    system = vesicle.system()
    stage("System")
    context = start(system, vesicle, "Verlet", Target(platform, platform, properties))
    stage("Context")
    context.getIntegrator().step(5)
    stage("5 steps")
    print(json.dumps(stages))


if __name__ == "__main__":
    _main(int(sys.argv[1]), sys.argv[2], json.loads(sys.argv[3]))
