"""The scripts of benches/: a tiny run of all of it, and the verdicts on made-up figures."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import openmm
import pytest
from platforms import NATIVE

BENCHES = Path(__file__).resolve().parents[2] / "benches"


@pytest.fixture(scope="module")
def scripts():
    """The modules `race` and `checks`."""
    sys.path.insert(0, str(BENCHES))
    try:
        import checks
        import race
    finally:
        sys.path.remove(str(BENCHES))
    return SimpleNamespace(race=race, checks=checks)


def particle():
    """The smallest System."""
    system = openmm.System()
    system.addParticle(1)
    return system


def test_tiny_run(tmp_path):
    output = tmp_path / "figures.md"
    output.write_text("# Old\n\n## GPU platforms\n\nOf another script.\n", encoding="utf-8")
    command = [
        sys.executable, BENCHES / "steps.py", "--parts", 1, "--repeats", 1, "--seconds", 0.001,
        "--platform", "Reference", "--jax-python", tmp_path / "none", "--output", output,
    ]  # fmt: skip
    said = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, check=True, timeout=600
    )
    text, _, kept = output.read_text(encoding="utf-8").partition("\n## GPU platforms\n")
    assert text.replace("(figures.png)", "(benchmarks.png)") in said.stdout
    assert "# Old" not in text
    assert kept == "\nOf another script.\n"
    assert "(figures.png)" in text
    assert output.with_suffix(".png").read_bytes().startswith(b"\x89PNG")
    for integrator in ("Verlet", "LangevinMiddle", "Brownian"):
        part = text.partition(f"## {integrator}, µs per step")[2].partition("\n## ")[0]
        rows = {
            cells[1].strip(): cells[2].strip(" *")
            for cells in (line.split("|") for line in part.splitlines())
            if len(cells) > 3
        }
        assert float(rows["openmm-helfrich, Reference"]) > 0
        assert float(rows["OpenMM's empty step, Reference"]) > 0
        assert ("x, y, z string forces, Reference" in rows) == (integrator == "Verlet")
    # What was not measured is said, not left out.
    assert "jax-md, edges, N = 12: jax and jax-md are not installed" in text
    assert "not measured: run with all sizes" in text
    assert "| 5 steps " in text


@pytest.mark.long
def test_native_steps(tmp_path):
    """Each side's figure is in the table and the file, and the ratios are those of the figures."""
    NATIVE[1].context(particle())
    output = tmp_path / "steps.json"
    command = [
        sys.executable, BENCHES / "native_steps.py", "--platform", NATIVE[1].platform, "--sizes",
        12, 42, "--repeats", 1, "--seconds", 0.001, "--jax-python", tmp_path / "none", "--no-bath",
        "--json", output,
    ]  # fmt: skip
    said = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, check=True, timeout=600
    )
    found = json.loads(output.read_text(encoding="utf-8"))
    cells = [[cell.strip(" *") for cell in line.split("|")] for line in said.stdout.splitlines()]
    rows = {row[1]: row[2:4] for row in cells if len(row) == 5}
    where = f"{NATIVE[1].platform} in mixed precision"
    labels = {
        "empty": f"OpenMM's empty step, {where}",
        "native": f"native, {where}",
        "processor": f"on the processor, {where}",
        "strings": f"x, y, z string forces, {where}",
    }
    for place, n in enumerate(("12", "42")):
        cost = found["microseconds"][n]
        for name, label in labels.items():
            assert float(rows[label][place].replace(" ", "")) == pytest.approx(
                cost[name], rel=0.01, abs=0.06
            )
            if name != "native":
                ratio = float(rows[f"{label} / native"][place])
                assert ratio == pytest.approx(cost[name] / cost["native"], rel=0.01)
    assert found["missing"]["jax, edges"] == {"all": "jax and jax-md are not installed"}
    refused = subprocess.run(
        [sys.executable, str(BENCHES / "native_steps.py"), "--sizes", "1000"],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert "no icosphere of 1000 vertices, but one of 1002" in refused.stderr


def test_platform_choice(tmp_path, monkeypatch):
    """Both tables, of which docs/platforms.md has a run; what is chosen is what it says."""
    monkeypatch.delenv("OPENMM_DEFAULT_PLATFORM", raising=False)
    output = tmp_path / "platforms.md"
    command = [sys.executable, BENCHES / "platform_choice.py", "--quick", "--output", output]
    subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True, timeout=600)
    rows = [line.strip("|").split("|") for line in output.read_text().splitlines() if "|" in line]
    rows = [[cell.strip() for cell in row] for row in rows]
    cost = {row[0]: [float(cell) for cell in row[1:]] for row in rows if "thread" in row[0]}
    assert all(number > 0 for row in cost.values() for number in row)
    now = {tuple(row[:2]): row[4] for row in rows if row[1] in ("`openmm.Context`", "this package")}
    assert len(now) == 6
    for (system, door), platform in now.items():
        if "repel" not in system:
            assert platform == "Helfrich"
        else:
            assert (platform == "CPU") == (door == "this package")


def rows_of(table):
    """What is asked, as (measured, verdict)."""
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]
    return {row[0]: (row[2], row[3]) for row in cells}


def test_verdicts(scripts):
    row, results = scripts.race.Row, scripts.race.Results()
    for n in (1002, 4002, 10_242, 998_562):
        results.cost.update({
            (row("empty", "Reference", "Verlet"), n): 10.0,
            (row("empty", "Reference", "LangevinMiddle"), n): 60.0,
            (row("ours", "Reference", "Verlet"), n): 40.0,
            (row("ours", "Helfrich, 1 thread", "Verlet"), n): 20.0 * n / 1002,
            (row("ours", "Reference", "LangevinMiddle"), n): 50.0 * n / 1002,
            (row("ours", "Helfrich, 1 thread", "LangevinMiddle"), n): 30.0 * n / 1002,
            (row("strings", "Reference", "Verlet"), n): 900.0,
            (row("jax", "edges", "Verlet"), n): 500.0,
        })  # fmt: skip
    used = {"mesh": {"peak": 900.0}, "Context": {"peak": 1500.0}}, 998_562, "Reference"
    cost = {
        ("Julicher", "plain, 1 thread", 1002): 100.0,
        ("Julicher", "no lanes, 1 thread", 1002): 80.0,
        ("Julicher", "fused, 1 thread", 1002): 20.0,
        ("Espriu", "fused, 1 thread", 1002): 36.0,
        ("Julicher", "plain, 1 thread", 4002): 400.0,
        ("Julicher", "plain, 2 threads", 4002): 1.0,
        ("Julicher", "fused, 1 thread", 4002): 120.0,
        ("Julicher", "fused, 2 threads", 4002): 48.0,
    }
    found = rows_of(scripts.checks.table(results, used, SimpleNamespace(cost=cost)))
    verdicts = [
        ("Verlet step / empty Verlet step on Reference, N = 1002", "2 (Helfrich", "yes"),
        ("LangevinMiddle step on platform Helfrich / empty LangevinMiddle step on Reference, "
         "N = 1002", "0.5 ", "yes"),
        ("LangevinMiddle step on platform Helfrich / empty LangevinMiddle step on Reference, "
         "N = 4002", "2 ", "NO"),
        ("Verlet step of the fastest string forces or jax-md / ours, N = 1002", "25 (jax", "yes"),
        ("Verlet step of the fastest string forces or jax-md / ours, N = 4002", "12.5 ", "NO"),
        ("peak memory at N = 998562, GB", "1.57 ", "NO"),
        ("LangevinMiddle: time per vertex at N = 998562 over that at 10242", "1 ", "yes"),
        ("Jülicher forces, 1 thread / the faster scalar code on one thread, "
         "N = 1002", "0.25 ", "yes"),
        ("Jülicher forces, 1 thread / the faster scalar code on one thread, "
         "N = 4002", "0.3 ", "NO"),
        ("Jülicher forces, 2 threads / the faster scalar code on one thread, "
         "N = 4002", "0.12 ", "yes"),
        ("slowest other scheme / Jülicher, 1 thread, N = 1002", "1.8 (Espriu", "NO"),
        ("slowest other scheme / Jülicher, 1 thread, N = 4002", "not measured", "–"),
    ]  # fmt: skip
    for what, measured, verdict in verdicts:
        assert found[what][0].startswith(measured), what
        assert found[what][1] == verdict, what


def test_nothing_measured_is_no_success(scripts):
    found = rows_of(scripts.checks.table(scripts.race.Results(), None, None))
    assert len(found) == 13
    assert {verdict for _, verdict in found.values()} == {"–"}
