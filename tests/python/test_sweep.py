"""Sweeps: cache, resumption, errors, and a real Dask cluster that loses a worker."""

import functools
import json
import logging
import os
import signal
import subprocess
import sys
import threading
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from dask_processes import dask_cluster
from openmmhelfrich.sweep import Cache, SweepError, grid, sweep
from openmmhelfrich.sweep import cache as store
from openmmhelfrich.sweep.backends import on_dask

distributed = pytest.importorskip("distributed")


def square(x, folder=None):
    """x² in two forms; leaves a file that says which process computed it."""
    if folder is not None:
        (Path(folder) / f"{x}-{os.getpid()}").touch()
    return {"number": x**2, "array": np.full((2, 3), float(x)), "list": [x, None, "text"]}


def fatal(x, folder, victim):
    """The victim dies in the midst of its third point, the others wait for that."""
    result = square(x, folder)
    deadline = time.monotonic() + 120
    while len(list(Path(folder).glob(f"*-{victim}"))) < 3:
        if os.getpid() == victim:
            return result
        assert time.monotonic() < deadline, "the victim gets no points"
        time.sleep(0.01)
    if os.getpid() == victim:
        os.kill(victim, signal.SIGKILL)
    return result


def slow(x, folder):
    time.sleep(0.1)
    return square(x, folder)


def reciprocal(x):
    return {"value": 1 / x}


def power(x, exponent):
    return {"value": x**exponent}


def forgetful(x):
    """Forgets to return its result at 1."""
    return None if x == 1 else {"value": x}


def oddly_named(x):
    """Arrays of names that arguments of NumPy's savez have, or that entries of a file cannot."""
    return {name: np.arange(3) + i + x for i, name in enumerate(ODD)} | {"": 5, "array 1": "text"}


ODD = ["file", "allow_pickle", "args", "usual"]


def worse_named(x):
    return {name: np.arange(3) + i + x for i, name in enumerate(WORSE)} | {"array 1": "text"}


WORSE = ["file", "", "x", "x.npy", "a\0b", "a", "a/b", "\ud800", "array 0", "0"]


class Computer:
    """A function of its own state too."""

    def method(self, x):
        return {"value": x}

    __call__ = method


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

    def test_computes_again_what_is_broken(self, tmp_path, caplog):
        [first] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        file.write_bytes(file.read_bytes()[:100])
        [second] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        assert second["number"] == first["number"] == 25
        assert str(file) in caplog.text
        assert Cache(tmp_path).load("test_sweep.square", file.stem, {"x": 5})["number"] == 25
        assert not list(tmp_path.rglob("*.part"))

    @pytest.mark.parametrize(
        ("what", "offset", "value", "reason"),
        [
            ("encryption", 8, b"\1\0", "encrypted"),
            ("a method of compression", 10, b"\x63\0", "compression method"),
            ("a place before the file", 42, b"\xff\xff\xff\x7f", ""),
        ],
    )
    def test_damage_that_asks_for(self, tmp_path, caplog, what, offset, value, reason):
        """In the index, where every value has a meaning."""
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        content = bytearray(file.read_bytes())
        start = content.index(b"PK\1\2") + offset
        content[start : start + len(value)] = value
        file.write_bytes(content)
        [result] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        assert result["array"].tolist() == [[5.0] * 3] * 2
        said = caplog.text
        assert str(file) in said and reason in said

    def test_an_array_that_is_missing(self, tmp_path, caplog):
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        with zipfile.ZipFile(file) as archive:
            record = archive.read("json.npy")
        with zipfile.ZipFile(file, "w") as archive:
            archive.writestr("json.npy", record)
        [result] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        assert result["array"].tolist() == [[5.0] * 3] * 2
        assert f"{file} is broken ('no array')" in caplog.text

    def test_what_a_kill_has_left_is_removed(self, tmp_path):
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        (file.parent / "tmp123.part").write_bytes(b"half")
        quiet(square, [{"x": 6}], cache=tmp_path, workers=0)
        assert len(list(file.parent.glob("*.npz"))) == 2
        assert not list(tmp_path.rglob("*.part"))

    def test_another_sweep_tidies_up(self, tmp_path, monkeypatch):
        """Just when a result is written."""
        cache, write, taken = Cache(tmp_path), store._write, []

        def tidied(file, arrays):
            write(file, arrays)
            if not taken:
                taken.extend(tmp_path.rglob("*.part"))
                taken[0].unlink()

        monkeypatch.setattr(store, "_write", tidied)
        cache.save("name", "key", {"x": 1}, {"y": 2})
        assert taken and cache.load("name", "key", {"x": 1}) == {"y": 2}

    def test_a_cache_that_vanishes(self, tmp_path):
        """What was stored is not left behind for a new folder."""
        folder = tmp_path / "results"
        cache = Cache(folder)
        cache.save("name", "one", {}, {"x": 1})
        folder.rename(tmp_path / "away")
        with pytest.raises(FileNotFoundError, match="see whether its folder is there") as error:
            cache.save("name", "two", {}, {"x": 2})
        assert str(folder) in error.value.filename
        assert not folder.exists()
        # A sweep that begins without one makes one.
        assert cache.load("name", "two", {}) is None
        cache.save("name", "two", {}, {"x": 2})
        assert cache.load("name", "two", {}) == {"x": 2}

    def test_files_say_their_point(self, tmp_path):
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        assert json.loads(str(np.load(file)["json"]))["point"] == {"x": 5}

    def test_failures_name_their_points_and_spare_the_others(self, tmp_path):
        with pytest.raises(SweepError, match=r"(?s)1 of 3 points.*'x': 0.*ZeroDivisionError"):
            quiet(reciprocal, grid(x=[1, 0, 2]), cache=tmp_path, workers=0)
        assert len(list(tmp_path.rglob("*.npz"))) == 2

    def test_failures_say_what_becomes_of_the_others(self, tmp_path):
        points = grid(x=[1, 0, 2])
        with pytest.raises(SweepError, match=f"the others are stored in {tmp_path}"):
            quiet(reciprocal, points, cache=tmp_path, workers=0)
        with pytest.raises(SweepError, match="the others are lost, as there is no cache"):
            quiet(reciprocal, points, workers=0)

    @pytest.mark.parametrize(("function", "names"), [(oddly_named, ODD), (worse_named, WORSE)])
    def test_arrays_of_any_name(self, tmp_path, function, names):
        expected = function(7)
        for _ in range(2):  # The second time from the files.
            [result] = quiet(function, [{"x": 7}], cache=tmp_path, workers=0)
            assert set(result) == {*expected, "seconds"}
            for i, name in enumerate(names):
                np.testing.assert_array_equal(result[name], np.arange(3) + i + 7)
            assert result["array 1"] == "text"
        assert len(list(tmp_path.rglob("*.npz"))) == 1

    def test_files_have_the_names_of_arrays(self, tmp_path):
        quiet(oddly_named, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        assert np.load(file).files == ["json", *ODD]

    def test_reads_what_earlier_versions_have_stored(self, tmp_path):
        """Keys, folders and entries of files stay what they are."""
        file = tmp_path / "test_sweep.square" / "08cb407e3233c390c40a.npz"
        file.parent.mkdir()
        record = {"point": {"x": 5}, "result": {"number": -1, "seconds": 0.5}}
        np.savez_compressed(file, json=np.array(json.dumps(record)), array=np.ones(2))
        [result] = quiet(square, [{"x": 5}], cache=tmp_path, compute=False)
        assert result.pop("array").tolist() == [1, 1]
        assert result == {"number": -1, "seconds": 0.5}

    @pytest.mark.parametrize(
        ("one", "two"),
        [
            (["one.py"], ["two.py"]),
            pytest.param(["-m", "one"], ["-m", "two"], marks=pytest.mark.long),
            (["-m", "imports"], ["two.py"]),
            pytest.param(
                ["-m", "cProfile", "one.py"],
                ["-m", "cProfile", "two.py"],
                marks=pytest.mark.long,
            ),
        ],
    )
    def test_functions_of_equal_names_in_different_modules(self, tmp_path, one, two):
        """A module is the same whether it is run, as a file or by its name, or imported."""
        cache = tmp_path / "cache"
        text = """
from openmmhelfrich.sweep import sweep

def value(x):
    return {{"value": {0} * x}}

def main():
    [result] = sweep(value, [{{"x": 5}}], cache="cache", workers=0, progress=False)
    print(result["value"])

if __name__ == "__main__":
    main()
"""
        (tmp_path / "one.py").write_text(text.format(1))
        (tmp_path / "two.py").write_text(text.format(2))
        (tmp_path / "imports.py").write_text("import one\none.main()\n")
        for command, expected in ((two, "10"), (one, "5"), (two, "10")):
            said = subprocess.run(
                [sys.executable, *command], cwd=tmp_path, capture_output=True, text=True, check=True
            )
            assert said.stdout.split()[0] == expected
        assert sorted(path.name for path in cache.iterdir()) == ["one.value", "two.value"]

    def test_computes_again_what_is_broken_within(self, tmp_path, caplog):
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        [file] = tmp_path.rglob("*.npz")
        with zipfile.ZipFile(file) as archive:
            entry = archive.getinfo("array.npy")
        content = bytearray(file.read_bytes())
        start = entry.header_offset + 50
        content[start : start + 20] = b"\xff" * 20
        file.write_bytes(content)
        [result] = quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        assert result["array"].tolist() == [[5.0] * 3] * 2
        assert str(file) in caplog.text

    @pytest.mark.parametrize(
        ("function", "culprit"),
        [
            (lambda x: {"value": x}, "a lambda"),
            (functools.partial(power, exponent=1), "a partial of power"),
            (functools.wraps(power)(functools.partial(power, exponent=1)), "a partial of power"),
            (Computer().method, r"Computer\.method, which is not at the top"),
            (Computer(), "object of class Computer"),
        ],
    )
    def test_functions_without_a_name_of_their_own_need_no_cache(self, tmp_path, function, culprit):
        with pytest.raises(TypeError, match=f"(?s){culprit}.*top of a module.*leave out the cache"):
            quiet(function, [{"x": 2}], cache=tmp_path, workers=0)
        assert not list(tmp_path.iterdir())
        [result] = quiet(function, [{"x": 2}], workers=0)
        assert result["value"] == 2

    def test_nested_functions_have_no_cache(self, tmp_path):
        def nested(x):
            return {"value": x}

        with pytest.raises(TypeError, match=r"<locals>\.nested, which is not at the top"):
            quiet(nested, [{"x": 2}], cache=Cache(tmp_path), workers=0)

    def test_looks_only(self, tmp_path):
        start = time.process_time()
        quiet(square, [{"x": 5}], cache=tmp_path, workers=0)
        spent = time.process_time() - start
        [result] = quiet(square, [{"x": 5}], cache=tmp_path, compute=False)
        assert result["number"] == 25
        assert 0 <= result["seconds"] <= spent
        with pytest.raises(SweepError, match=r"1 of 2 results of square.*'x': 6"):
            quiet(square, grid(x=[5, 6]), cache=tmp_path, compute=False)

    @pytest.mark.parametrize(
        ("function", "points", "options", "error", "message"),
        [
            (square, [{"x": object()}], {}, TypeError, "'x'.*object"),
            (square, [5], {}, TypeError, "dictionary.*int"),
            (lambda x: x, [{"x": 1}], {}, SweepError, "must return a dictionary, got int: 1"),
            (lambda x: {"a": {1}}, [{"x": 1}], {}, SweepError, "'a'.*set"),
            (lambda x: {"json": 1}, [{"x": 1}], {}, SweepError, "json"),
            (lambda x: {"a": np.array([None])}, [{"x": 1}], {}, SweepError, "objects.*'a'"),
            (square, [{"x": 1}], {"workers": -1}, ValueError, "workers.*-1"),
            (square, [{"x": 1}], {"workers": np.nan}, ValueError, "sweep: workers .*nan"),
            (square, [{"x": 1}], {"workers": 1.5}, ValueError, r"workers .*1\.5"),
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


def helped(x, folder):
    """While 0 is computed another sweep computes 2."""
    with open(Path(folder) / "log", "a") as log:
        log.write(f"{x} ")
    if x == 0:
        quiet(helped, grid(x=[2], folder=[folder]), cache=Path(folder) / "cache", workers=0)
    return {"number": x**2}


def test_what_another_sweep_has_stored_by_then_is_not_computed_again(tmp_path):
    points = grid(x=range(4), folder=[str(tmp_path)])
    results = quiet(helped, points, cache=tmp_path / "cache", workers=0)
    assert [result["number"] for result in results] == [0, 1, 4, 9]
    assert (tmp_path / "log").read_text().split() == ["0", "2", "1", "3"]


def test_cluster_of_this_machine(tmp_path):
    points = grid(x=range(6), folder=[str(tmp_path)])
    results = quiet(square, points, workers=2)
    assert [result["number"] for result in results] == [x**2 for x in range(6)]
    assert {int(path.name.split("-")[1]) for path in tmp_path.iterdir()}.isdisjoint({os.getpid()})


@pytest.mark.parametrize("workers", [0, 2])
def test_bad_results_are_failures_of_their_points(tmp_path, workers):
    with pytest.raises(
        SweepError,
        match=r"(?s)forgetful failed at 1 of 4 points.*\n  \{'x': 1\}: TypeError: forgetful must "
        "return a dictionary, got NoneType: None$",
    ):
        quiet(forgetful, grid(x=range(4)), cache=tmp_path, workers=workers)
    results = quiet(forgetful, grid(x=[0, 2, 3]), cache=tmp_path, compute=False)
    assert [result["value"] for result in results] == [0, 2, 3]


def test_scheduler_that_loses_a_worker(tmp_path):
    log, cache = tmp_path / "log", tmp_path / "cache"
    log.mkdir()
    with dask_cluster(tmp_path, 2) as (address, _, workers):
        points = grid(x=range(12), folder=[str(log)], victim=[workers[0].pid])
        results = quiet(fatal, points, cache=cache, scheduler=address)
        assert workers[0].wait(timeout=120) == -signal.SIGKILL
        assert [result["number"] for result in results] == [x**2 for x in range(12)]
        # The point that the victim was computing was computed by the other one again.
        assert 13 <= len(computed(log)) <= 15
        assert sorted(set(computed(log))) == list(range(12))
        count = len(computed(log))
        quiet(fatal, points, cache=cache, scheduler=address)
        assert len(computed(log)) == count


def test_results_that_die_with_their_worker_are_computed_again(tmp_path):
    """The worker has finished points that nobody has fetched yet."""
    log = tmp_path / "log"
    log.mkdir()
    with dask_cluster(tmp_path, 2) as (address, _, workers):
        points = grid(x=range(12), folder=[str(log)], victim=[workers[0].pid])
        outcomes = on_dask(fatal, dict(enumerate(points)), address, None)
        found = dict([next(outcomes)])
        assert workers[0].wait(timeout=120) == -signal.SIGKILL
        found |= dict(outcomes)
    assert {key: result["number"] for key, (result, _) in found.items()} == {
        x: x**2 for x in range(12)
    }
    # The point that it was computing, and at least one of the two before.
    assert 14 <= len(computed(log)) <= 15


def test_scheduler_that_is_lost(tmp_path, caplog):
    """Said in one line, and what was stored is not computed again."""
    log, cache = tmp_path / "log", tmp_path / "cache"
    log.mkdir()
    points = grid(x=range(40), folder=[str(log)])
    with dask_cluster(tmp_path, 2) as (address, scheduler, _):

        def lose():
            while len(list(cache.rglob("*.npz"))) < 5:
                time.sleep(0.001)
            scheduler.kill()

        threading.Thread(target=lose, daemon=True).start()
        with pytest.raises(SweepError, match=f"lost the scheduler of {address}; run again to go"):
            quiet(slow, points, cache=cache, scheduler=address)
    # Dask notes the closed connection below what anyone is shown.
    shown = [record for record in caplog.records if record.levelno >= logging.WARNING]
    assert not [record for record in shown if record.exc_info]
    stored, before = len(list(cache.rglob("*.npz"))), len(computed(log))
    assert 5 <= stored < 40
    results = quiet(slow, points, cache=cache, workers=0)
    assert [result["number"] for result in results] == [x**2 for x in range(40)]
    # Each process leaves a file of its own.
    assert len(computed(log)) - before == 40 - stored
