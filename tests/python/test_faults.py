"""Some of what `tests/faults.py` does at length: faults strike, and runs go on.

Processes of their own do it: runs are forked there, which is not for a process with threads.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("h5py")
pytest.importorskip("distributed")

SCRIPT = Path(__file__).resolve().parents[1] / "faults.py"


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        (
            "vcm",
            [
                "kill",
                "vanished folder",
                "SIGTERM",
                "Ctrl-C twice",
                "second process",
                "damaged checkpoint",
                "cut tail",
            ],
        ),
        ("sweep", ["kill", "damaged checkpoint", "clock that jumps"]),
    ],
)
def test_faults(kind, names, tmp_path):
    chosen = [part for name in names for part in ("--fault", name)]
    result = subprocess.run(
        [sys.executable, SCRIPT, "--kills", "1", "--cases", "1", *chosen, kind],
        env=os.environ | {"TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    rows = result.stdout.splitlines()[1:]
    assert len(rows) == len(names)
    # Each has struck, once or more, and nothing was wrong.
    for row in rows:
        struck, _, wrong, _ = map(int, row.split()[-4:])
        assert struck >= 1, row
        assert wrong == 0, row
