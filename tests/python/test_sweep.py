"""Sweeps: cache, resumption, errors, and a real Dask cluster that loses a worker."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich.sweep import Cache, SweepError, grid, sweep

pytest.importorskip("distributed")


def square(x, folder=None, pause=0.0):
    """x² in two forms; leaves a file that says which process computed it."""
    if folder is not None:
        (Path(folder) / f"{x}-{os.getpid()}").touch()
    time.sleep(pause)
    return {"number": x**2, "array": np.full((2, 3), float(x)), "list": [x, None, "text"]}


def reciprocal(x):
    return {"value": 1 / x}


def interrupted(x, folder):
    if x == 3 and not (Path(folder) / "again").exists():
        raise KeyboardInterrupt
    return square(x, folder)


def computed(folder):
    """The points that were computed, one entry for each time."""
    return sorted(int(path.name.split("-")[0]) for path in Path(folder).iterdir())


def quiet(*arguments, **options):
    return sweep(*arguments, progress=False, **options)


class TestHere:
    def test_order_and_types(self, tmp_path):
        for _ in range(2):  # The second time from the files.
            results = quiet(square, grid(x=[3, 1, 2, 1]), cache=tmp_path, workers=0)
            assert [result["number"] for result in results] == [9, 1, 4, 1]
            assert results[0]["array"].shape == (2, 3)
            assert results[0]["array"].dtype == np.float64
            assert results[0]["list"] == [3, None, "text"]

    def test_computes_what_is_missing_only(self, tmp_path):
        log, cache = tmp_path / "log", tmp_path / "cache"
        log.mkdir()
        quiet(square, grid(x=[1, 2, 2], folder=[str(log)]), cache=cache, workers=0)
        assert computed(log) == [1, 2]
        quiet(square, grid(x=np.arange(4), folder=[str(log)]), cache=cache, workers=0)
        assert computed(log) == [0, 1, 2, 3]
        for path in log.iterdir():
            path.unlink()
        quiet(square, grid(x=[1], folder=[str(log)]), cache=cache, version=2, workers=0)
        assert computed(log) == [1]

    def test_goes_on_after_an_interrupt(self, tmp_path):
        log, cache = tmp_path / "log", tmp_path / "cache"
        log.mkdir()
        points = grid(x=range(6), folder=[str(log)])
        with pytest.raises(KeyboardInterrupt):
            quiet(interrupted, points, cache=cache, workers=0)
        assert computed(log) == [0, 1, 2]
        (log / "again").touch()
        results = quiet(interrupted, points, cache=cache, workers=0)
        assert [result["number"] for result in results] == [0, 1, 4, 9, 16, 25]
        (log / "again").unlink()
        assert computed(log) == [0, 1, 2, 3, 4, 5]

    def test_computes_again_what_is_broken(self, tmp_path, capsys):
        [first] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        file.write_bytes(file.read_bytes()[:100])
        [second] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        assert second["number"] == first["number"] == 25
        assert str(file) in capsys.readouterr().err
        assert Cache(tmp_path).load("square", file.stem, {"x": 5})["number"] == 25
        assert not list(tmp_path.rglob("*.part"))

    def test_files_say_their_point(self, tmp_path):
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        assert json.loads(str(np.load(file)["json"]))["point"] == {"x": 5}

    def test_failures_name_their_points_and_spare_the_others(self, tmp_path):
        with pytest.raises(SweepError, match=r"(?s)1 of 3 points.*'x': 0.*ZeroDivisionError"):
            quiet(reciprocal, grid(x=[1, 0, 2]), cache=tmp_path, workers=0)
        assert len(list(tmp_path.rglob("*.npz"))) == 2

    def test_looks_only(self, tmp_path):
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [result] = quiet(square, [{"x": 5}], cache=tmp_path, compute=False)
        assert result["number"] == 25
        assert 0 <= result["seconds"] < 1
        with pytest.raises(SweepError, match=r"1 of 2 results of square.*'x': 6"):
            quiet(square, grid(x=[5, 6]), cache=tmp_path, compute=False)

    @pytest.mark.parametrize(
        ("function", "points", "options", "error", "message"),
        [
            (square, [{"x": object()}], {}, TypeError, "'x'.*object"),
            (square, [5], {}, TypeError, "dictionary.*int"),
            (lambda x: x, [{"x": 1}], {}, TypeError, "must return a dictionary, got int"),
            (lambda x: {"a": {1}}, [{"x": 1}], {}, TypeError, "'a'.*set"),
            (lambda x: {"json": 1}, [{"x": 1}], {}, TypeError, "json"),
            (square, [{"x": 1}], {"workers": -1}, ValueError, "workers.*-1"),
            (square, [{"x": 1}], {"scheduler": "tcp://x:1"}, ValueError, "not both"),
        ],
    )
    def test_refuses(self, function, points, options, error, message):
        with pytest.raises(error, match=message):
            quiet(function, points, **{"workers": 0, **options})


def test_grid():
    assert grid(a=[1, 2], b="xy") == [
        {"a": 1, "b": "x"},
        {"a": 1, "b": "y"},
        {"a": 2, "b": "x"},
        {"a": 2, "b": "y"},
    ]


def test_cluster_of_this_machine(tmp_path):
    points = grid(x=range(6), folder=[str(tmp_path)])
    results = quiet(square, points, workers=2)
    assert [result["number"] for result in results] == [x**2 for x in range(6)]
    assert {int(path.name.split("-")[1]) for path in tmp_path.iterdir()}.isdisjoint({os.getpid()})


@contextlib.contextmanager
def dask_cluster(folder, num_workers):
    """A scheduler and workers as a user starts them, each a process of its own on loopback."""
    file = folder / "scheduler.json"
    common = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
    dask = [sys.executable, "-m", "dask"]
    processes = [
        subprocess.Popen(
            [
                *dask,
                "scheduler",
                "--host",
                "127.0.0.1",
                "--port",
                "0",
                "--no-dashboard",
                "--scheduler-file",
                str(file),
            ],
            **common,
        )
    ]
    try:
        address = None
        for _ in range(300):
            with contextlib.suppress(FileNotFoundError, json.JSONDecodeError):
                address = json.loads(file.read_text())["address"]
                break
            time.sleep(0.1)
        assert address, "the scheduler did not start"
        for _ in range(num_workers):
            command = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
            processes.append(subprocess.Popen(command, **common))
        yield address, processes[1:]
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()


def test_scheduler_that_loses_a_worker(tmp_path):
    log, cache = tmp_path / "log", tmp_path / "cache"
    log.mkdir()
    points = grid(x=range(12), folder=[str(log)], pause=[0.3])
    with dask_cluster(tmp_path, 2) as (address, workers):
        victim = workers[0].pid

        def kill_in_mid_sweep():
            # Two points in, the victim computes its third: now it is worth something.
            while sum(path.name.endswith(f"-{victim}") for path in log.iterdir()) < 3:
                time.sleep(0.01)
            os.kill(victim, signal.SIGKILL)

        killer = threading.Thread(target=kill_in_mid_sweep, daemon=True)
        killer.start()
        results = quiet(square, points, cache=cache, scheduler=address)
        killer.join(timeout=0)
        assert not killer.is_alive()
        assert workers[0].wait() == -signal.SIGKILL
        assert [result["number"] for result in results] == [x**2 for x in range(12)]
        # The point that the victim was computing was computed by the other one again.
        assert 13 <= len(computed(log)) <= 15
        assert sorted(set(computed(log))) == list(range(12))
        count = len(computed(log))
        quiet(square, points, cache=cache, scheduler=address)
        assert len(computed(log)) == count
