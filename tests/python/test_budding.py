"""What `examples/domains` measures, in short."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "examples" / "domains" / "budding.py"


def test_domains_bud_from_the_line_tension_of_theory_on(tmp_path):
    command = [sys.executable, str(SCRIPT), "--quick", "--results", tmp_path]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    found = {path.stem: list(csv.DictReader(path.open())) for path in tmp_path.glob("*.csv")}
    errors = [float(row["λL/κ"]) / 5.783186 - 1 for row in found["budding_modes"]]
    # They fall with the square of the edges.
    assert len(errors) == 2
    assert -0.03 < errors[0] < 0
    assert errors[1] == pytest.approx(errors[0] * (4.5 / 8.5) ** 2, rel=0.2)
    below, above = found["budding_runs"]
    assert (below["over_threshold"], above["over_threshold"]) == ("0.7", "1.6")
    assert abs(float(below["x_1"])) < 0.05
    assert float(above["x_1"]) > 0.6
