"""``--json`` of `info`, `bench` and `spectrum`: the same values as in the text, for programs."""

import json

import numpy as np
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmmhelfrich import _benchmark, config, platforms
from openmmhelfrich.cli import main
from openmmhelfrich.cli.options import print_json

PAIR = """simulation = { duration = 2.0, name = "pair" }
integrator.time_step = 0.02
output.interval = 10

[[vesicle]]
rigidity = 10
mesh = { icosphere = 2, radius = 100 }

[[vesicle]]
softness = 0.2
mesh = { icosphere = 2, radius = 100, translate = [300, 0, 0] }
"""


def invoke(*arguments):
    return CliRunner().invoke(main, [str(word) for word in arguments])


def json_of(*arguments):
    """All of the standard output is one object, in which no number is NaN."""
    result = invoke(*arguments, "--json")
    assert result.exit_code == 0, result.output

    def refuse(word):
        raise AssertionError(f"{word} is not JSON")

    return json.loads(result.stdout, parse_constant=refuse)


@pytest.fixture
def pair(tmp_path):
    path = tmp_path / "pair.toml"
    path.write_text(PAIR, encoding="utf-8")
    return path


def test_info_of_a_file(pair):
    found = json_of("info", pair, "--no-measure")
    assert list(found) == [
        "simulation", "membranes", "energies_kJ_per_mol", "platform", "computed_by", "duration",
    ]  # fmt: skip
    assert found["simulation"]["num_particles"] == 84
    assert found["simulation"]["time_step_ps"] == 0.02
    assert found["simulation"]["num_steps"] == 100
    cfg = config.read(pair)
    for values, membrane in zip(found["membranes"], cfg.membranes, strict=True):
        assert values["area_nm2"] == membrane.mesh.area
        assert values["volume_nm3"] == membrane.mesh.volume
        assert values["tau_2_ps"] == membrane.vesicle.tau_2
        assert values["max_time_step_ps"] == membrane.vesicle.max_time_step
    choice = platforms.choose(cfg.system(), cfg.integrator())
    assert found["platform"] == choice._asdict()
    assert [one["by"] for one in found["computed_by"]] == ["cpu"]
    assert found["duration"] is None
    text = invoke("info", pair, "--no-measure").output
    for name, energy in found["energies_kJ_per_mol"].items():
        assert f"{name:<16s} {energy:18.6f}".split() in [line.split() for line in text.splitlines()]


def test_info_with_a_measurement(pair, monkeypatch):
    from openmmhelfrich.cli import info

    monkeypatch.setattr(info, "_MEASURE_SECONDS", 0.01)
    duration = json_of("info", pair)["duration"]
    assert duration["seconds"] == pytest.approx(100 * duration["seconds_per_step"])
    assert duration["seconds"] > 0


def test_info_of_steps_that_fail(tmp_path):
    """All but the time that they take is said."""
    path = tmp_path / "fast.toml"
    path.write_text(
        'simulation.duration = 500\nintegrator.time_step = 50\nintegrator.kind = "Verlet"\n'
        "output.interval = 50\n[[vesicle]]\nmesh = { icosphere = 3, radius = 100 }\n"
    )
    result = invoke("info", path, "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["duration"] is None
    assert 0 < found["membranes"][0]["max_time_step_ps"] < 1
    assert "Warning: the first steps fail: " in result.stderr
    assert "none, for the first steps fail on" in invoke("info", path).stdout


def test_info_of_what_encloses_nothing(tmp_path):
    path = tmp_path / "disk.ply"
    helfrich.Mesh.disk(4, 100.0).write(path)
    toml = tmp_path / "disk.toml"
    toml.write_text(
        PAIR.partition("[[vesicle]]")[0] + "[[vesicle]]\nmesh = { file = 'disk.ply' }\n"
        "volume_modulus = 0\n",
        encoding="utf-8",
    )
    [membrane] = json_of("info", toml, "--no-measure")["membranes"]
    assert membrane["num_borders"] == 1
    assert membrane["volume_nm3"] is None


def test_info_of_the_machine():
    found = json_of("info")
    assert found["version"] == helfrich.__version__
    assert found["platforms"] == platforms.names()
    assert [gpu["name"] for gpu in found["gpus"]] == [gpu.name for gpu in helfrich.adapters()]
    assert found["default_platforms"][0]["name"] == "Helfrich"
    assert found["auto"]["least_vertices"] == 20_000


def test_timings_of_a_gpu(monkeypatch):
    """Text and JSON of a machine with a GPU, whose timings are made up."""
    from openmmhelfrich import backend
    from openmmhelfrich.cli import machine

    card = backend.Adapter(0, "A card", "discrete", "Vulkan", "driver 3", True, True)
    timings = [backend.Timing("0.1|A card", 23_042, 2e-3, 1e-3)]
    timings += [backend.Timing("0.1|A card", 92_162, 1e-3, 4e-3)]
    monkeypatch.setattr(backend, "adapters", lambda: [card])
    monkeypatch.setattr(backend, "timings", lambda: timings)
    monkeypatch.setattr(machine, "_measure", lambda: None)
    found = json_of("info")["auto"]["timings"]
    assert [timing["choice"] for timing in found] == ["gpu", "cpu"]
    assert [timing["num_vertices"] for timing in found] == [23_042, 92_162]
    lines = invoke("info").output.splitlines()
    assert "  0.1, A card" in lines
    assert "       23042     2.00 ms     1.00 ms  GPU" in lines
    assert "       92162     1.00 ms     4.00 ms  processor" in lines


def test_bench(monkeypatch):
    monkeypatch.setattr(
        _benchmark,
        "fastest",
        lambda steppers, repeats, seconds: {
            key: 4.0 if key[0] == "ours" else 0.5 for key in steppers
        },
    )
    found = json_of("bench", "--platform", "reference", "--size", 42, "--integrator", "Verlet")
    row = {
        "num_vertices": 42, "platform": "Reference", "steps_per_s": 250_000.0, "step_us": 4.0,
        "empty_step_us": 0.5, "ratio": 8.0,
    }  # fmt: skip
    assert found["rows"] == [row]
    assert found["failed"] == {}
    assert found["integrator"] == "Verlet"
    assert found["versions"]["openmm-helfrich"] == helfrich.__version__


def test_spectrum(tmp_path):
    path = tmp_path / "run.csv"
    mesh = helfrich.Mesh.icosphere(3, 100.0)
    simulation = helfrich.Vesicle(mesh).simulation(_benchmark.INTEGRATORS["LangevinMiddle"]())
    simulation.reporters.append(helfrich.ModeReporter(str(path), 2, mesh, lmax=3))
    simulation.step(60)
    simulation.reporters.clear()
    table = tmp_path / "table.csv"
    found = json_of("spectrum", path, "--kappa", 15, "--csv", table)
    assert found["num_frames"] == 30
    assert found["theory"] == {"kappa_kBT": 15.0, "young_kBT_per_nm2": 0.0, "radius_nm": None}
    written = np.genfromtxt(table, delimiter=",", names=True)
    assert [mode["l"] for mode in found["modes"]] == [2, 3]
    for name in written.dtype.names:
        assert [mode[name] for mode in found["modes"]] == written[name].tolist()
    result = invoke("spectrum", path, "--young", 0.1)
    assert result.exit_code == 2
    assert "--young needs --radius where SOURCE is a file of modes" in result.output
    elastic = json_of("spectrum", path, "--young", 0.1, "--radius", 100)["theory"]
    assert elastic == {"kappa_kBT": 20.0, "young_kBT_per_nm2": 0.1, "radius_nm": 100.0}


def test_errors_leave_the_output_empty(tmp_path):
    result = invoke("info", tmp_path / "nowhere.toml", "--json")
    assert result.exit_code == 1
    assert result.stdout == ""
    assert "nowhere.toml" in result.stderr


def test_numbers_of_all_kinds(capsys):
    print_json({"a": float("nan"), "b": [np.float64("inf"), np.int64(3)], "c": (np.bool_(True),)})
    assert json.loads(capsys.readouterr().out) == {"a": None, "b": [None, 3], "c": [True]}
