"""What LeakSanitizer has found that this package's library has made.

    python tests/leaks.py REPORT...

Python and its packages keep much until the process ends; here a leak counts if the library or the
extension is among those who asked for the memory. Exits with 1 if there is one.
"""

import re
import sys
from collections import Counter
from pathlib import Path

OURS = ("libOpenMMHelfrich.so", "_forces.abi3.so")
#: What is made once for each process, and given to OpenMM, which keeps it to the end.
ONCE = ("registerKernelFactor", "registerPlatforms", "PyInit__forces")


def main(reports: list[str]) -> int:
    """Print each place that leaks, with the bytes that it has leaked."""
    bytes_lost, count = Counter(), 0
    for report in reports:
        for block in Path(report).read_text().split("\n\n"):
            leak = re.match(r"\s*(?:Direct|Indirect) leak of (\d+) byte", block)
            if leak is None:
                continue
            count += 1
            stack = block.strip().splitlines()[1:]
            if any(name in block for name in OURS) and not any(name in block for name in ONCE):
                bytes_lost["\n".join(stack)] += int(leak[1])
    for stack, size in bytes_lost.most_common():
        print(f"{size} bytes\n{stack}\n")
    print(f"{len(bytes_lost)} of {count} leaks are this package's")
    if count == 0:
        print("leaks.py: there is no report, in which Python's own leaks would be", file=sys.stderr)
    return int(count == 0 or len(bytes_lost) > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
