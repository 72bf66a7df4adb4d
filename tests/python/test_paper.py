"""The figures of the paper in their quick versions, as a reader runs them, and their report."""

import itertools
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_sweep import dask_cluster

ROOT = Path(__file__).resolve().parents[2]
PAPER = ROOT / "examples" / "paper"


def run(script, *arguments, check=True):
    return subprocess.run(
        [sys.executable, str(PAPER / script), *map(str, arguments)],
        cwd=os.path.abspath(os.sep),
        env=dict(os.environ, PYTHONUTF8="1"),
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=600,
        check=check,
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A folder of results of two figures, and what the scripts printed."""
    folder = tmp_path_factory.mktemp("paper")
    # The first on the workers of a Dask scheduler, the second in one process.
    with dask_cluster(tmp_path_factory.mktemp("dask"), 2) as (address, *_):
        at = ("--scheduler", address)
        text = run("sm03_distributions.py", "--quick", "--results", folder, *at).stdout
    text += run("fig04_deformation.py", "--quick", "--results", folder, "--workers", 0).stdout
    return folder, text


def test_prints_measured_against_expected(results):
    _, text = results
    assert "τ_h = d √(m/ε)" in text
    assert "measured" in text
    assert "expected" in text
    assert "FAIL" not in text


@pytest.mark.parametrize("name", ["sm03", "fig04"])
def test_writes_numbers_and_picture(results, name):
    folder, _ = results
    record = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    assert record["quick"]
    assert record["rows"]
    assert all(row["passed"] for row in record["rows"])
    assert record["seconds"] > 0
    for picture in record["pictures"]:
        path = folder / picture["file"]
        pixels = np.asarray(Image.open(path).convert("RGB"))
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 10
        assert path.stat().st_size < 100_000


def test_draws_again_from_what_is_stored(results):
    folder, _ = results
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*.npz")}
    picture = folder / "sm03.png"
    picture.unlink()
    run("sm03_distributions.py", "--quick", "--results", folder, "--plot-only")
    assert picture.exists()
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*.npz")} == before


def test_plot_only_says_what_is_missing(tmp_path):
    result = run(
        "sm03_distributions.py", "--quick", "--results", tmp_path, "--plot-only", check=False
    )
    assert result.returncode != 0
    assert "16 of 16 results of distributions are not stored" in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--workers", "-1"], "--workers"),
        (["--workers", "1", "--scheduler", "tcp://127.0.0.1:1"], "not allowed with"),
    ],
)
def test_says_what_is_wrong(tmp_path, arguments, message):
    result = run("fig01_meshes.py", "--results", tmp_path, *arguments, check=False)
    assert result.returncode != 0
    assert message in result.stderr
    assert "Traceback" not in result.stderr


def test_films_are_short_and_move(tmp_path):
    printed = run(
        "films.py", "--quick", "--only", "oblate", "red_cell", "--out", tmp_path,
        "--files", tmp_path, check=False,
    )  # fmt: skip
    assert printed.returncode == 1
    assert "left out red_cell" in printed.stderr
    film = tmp_path / "oblate.gif"
    assert film.stat().st_size < 200_000
    with Image.open(film) as image:
        assert image.n_frames == 4
        frames = []
        for frame in range(4):
            image.seek(frame)
            frames.append(np.asarray(image.convert("RGB"), dtype=int))
    # The caption is at the top, the membrane below it.
    assert all(np.abs(a - b)[20:].max() > 50 for a, b in itertools.pairwise(frames))


def test_exits_with_3_outside_of_a_tolerance(tmp_path, monkeypatch, capsys):
    monkeypatch.syspath_prepend(PAPER)
    from _paper import Figure

    for measured, status in ((1.05, 0), (1.2, 3), (float("nan"), 3)):
        figure = Figure("none", "Fig. 0", "Nothing", "", ["--results", str(tmp_path)])
        figure.check("one", measured, 1, 0.1)
        with pytest.raises(SystemExit) as ended:
            figure.finish()
        assert ended.value.code == status
    assert capsys.readouterr().out.count("FAIL") == 2


def test_report(results, tmp_path):
    folder, _ = results
    run("report.py", "--results", folder, "--out", tmp_path)
    text = (tmp_path / "reproduction.md").read_text(encoding="utf-8")
    for name in ("fig04", "sm03"):
        record = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        assert record["title"] in text
        assert record["rows"][0]["measured"] in text
        for picture in record["pictures"]:
            assert f"(reproduction/{picture['file']})" in text
            assert (tmp_path / "reproduction" / picture["file"]).exists()


def test_report_takes_in_a_figure_anew_and_leaves_the_others(tmp_path):
    """Names of pictures that begin alike belong to different figures."""
    record = {
        "target": "Fig. 6",
        "title": "Spectra",
        "quick": False,
        "parameters": "",
        "rows": [{"what": "one | two", "measured": "1", "expected": "2", "passed": False}],
        "notes": [],
        "tables": [{"caption": "All:", "header": ["a", "b"], "rows": [["1", "2|3"]]}],
        "seconds": 1.0,
    }

    def write(name, *pictures):
        pictures = [{"file": f"{name}{suffix}.png", "caption": "x"} for suffix in pictures]
        text = json.dumps(record | {"name": name, "pictures": pictures})
        (tmp_path / f"{name}.json").write_text(text, encoding="utf-8")
        for picture in pictures:
            (tmp_path / picture["file"]).write_bytes(b"")

    write("fig06", "", "_old")
    write("fig06b", "")
    run("report.py", "--results", tmp_path, "--out", tmp_path / "docs")
    (tmp_path / "fig06b.json").unlink()
    write("fig06", "", "_ratio")
    printed = run("report.py", "--results", tmp_path, "--out", tmp_path / "docs").stdout
    pictures = {path.name for path in (tmp_path / "docs" / "reproduction").glob("*.png")}
    assert pictures == {"fig06.png", "fig06_ratio.png", "fig06b.png"}
    assert "outside: fig06: one | two: measured 1, expected 2" in printed
    report = (tmp_path / "docs" / "reproduction.md").read_text(encoding="utf-8")
    assert "| a | b |\n| --- | --- |\n| 1 | 2\\|3 |" in report
    assert "| one \\| two | 1 | 2 | **outside** |" in report


def test_a_figure_that_needs_files_says_which_are_missing(tmp_path):
    result = run("fig08_red_cell.py", "--quick", "--files", tmp_path, check=False)
    assert result.returncode == 4
    assert str(tmp_path / "SM_RBC_C0.txt") in result.stderr
    assert "--files FOLDER" in result.stderr


def test_report_of_nothing(tmp_path):
    result = run("report.py", "--out", tmp_path, check=False)
    assert result.returncode != 0
    assert "no results" in result.stderr
