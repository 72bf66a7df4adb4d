"""What memory allows a time step of a large mesh: `python benches/bandwidth.py [--threads 2]`.

Measures GB/s of a = b + c on arrays of 256 MB, and says how many ns a vertex and step of the
paper's vesicle takes if memory is all that counts, as docs/benchmarks.md has it. Lines that are
written are counted twice, since the processor reads them first.
"""

import argparse
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

# Bytes for each vertex, of mean degree 6 and with two triangles, in one step.
READ, WRITTEN = 1, 2
TRAFFIC = {
    "gather positions": READ * (24 + 4) + WRITTEN * 32,
    "triangles: corners, positions, normals": READ * (2 * 12 + 32) + WRITTEN * 2 * 32,
    "vertices: two lists of rings, normals, bends, partials": READ * (2 * 28 + 2 * 32)
    + WRITTEN * (6 * 8 + 16),
    "forces: two lists of rings, positions, normals, partials, bends, particles": READ
    * (2 * 28 + 32 + 2 * 32 + 16 + 6 * 8 + 4)
    + WRITTEN * 24,
    "Verlet: positions, velocities, forces": READ * 24 + WRITTEN * 2 * 24,
}


def gigabytes_per_second(threads, repeats=7):
    """The most of some runs."""
    count = 2**25 // threads
    arrays = [[np.full(count, float(k)) for k in range(3)] for _ in range(threads)]

    def add(three):
        np.add(three[1], three[2], out=three[0])

    best = 0.0
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(repeats):
            start = time.perf_counter()
            list(pool.map(add, arrays))
            seconds = time.perf_counter() - start
            best = max(best, threads * count * 8 * (2 * READ + WRITTEN) / seconds / 1e9)
    return best


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    for what, count in TRAFFIC.items():
        print(f"{count:6d} bytes  {what}")
    total = sum(TRAFFIC.values())
    print(f"{total:6d} bytes  for each vertex and step")
    for threads in range(1, options.threads + 1):
        rate = gigabytes_per_second(threads)
        print(f"{threads} thread(s): {rate:.1f} GB/s, so {total / rate:.0f} ns or more")


if __name__ == "__main__":
    main()
