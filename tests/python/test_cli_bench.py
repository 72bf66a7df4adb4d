"""The command `bench`, and the timing that it shares with the scripts of benches/."""

import openmm
import pytest
from click.testing import CliRunner
from openmmhelfrich import Vesicle, _benchmark
from openmmhelfrich._benchmark import timing
from openmmhelfrich.cli import main
from openmmhelfrich.cli.bench import _INTEGRATORS


def invoke(*arguments):
    return CliRunner().invoke(main, ["bench", *(str(word) for word in arguments)])


TABLE = ("--platform", "reference", "--size", 42, "--size", 252, "--integrator", "Verlet")


def rows_of(result):
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.output.splitlines() if " Reference " in line]
    assert [row[:2] for row in rows] == [["42", "Reference"], ["252", "Reference"]]
    return [row[2:] for row in rows]


def test_table_is_measured():
    """Steps are made and timed; how long they take is the machine's affair."""
    result = invoke(*TABLE, "--seconds", 0.001, "--repeats", 2)
    for row in rows_of(result):
        assert all(float(cell) > 0 for cell in row)
    assert f"OpenMM {openmm.Platform.getOpenMMVersion()}" in result.output
    assert "Verlet, 0.1 ps" in result.output


def test_table_of_known_times(monkeypatch):
    times = iter([(4.5, 0.8), (20.0, 5.0)])

    def measured(steppers, repeats, seconds):
        assert (repeats, seconds) == (3, 0.25)
        ours, empty = next(times)
        return {("ours", "Reference"): ours, ("empty", "Reference"): empty}

    monkeypatch.setattr(_benchmark, "fastest", measured)
    assert rows_of(invoke(*TABLE, "--seconds", 0.25, "--repeats", 3)) == [
        ["222222", "4.5", "0.8", "5.62"],
        ["50000", "20.0", "5.0", "4.00"],
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--size", 1000], "no icosphere has 1000 vertices; 10 n² + 2 is possible, such as 1002"),
        (["--size", -8], "no icosphere has -8 vertices; 10 n² + 2 is possible, such as 12"),
        (["--size", 2], "no icosphere has 2 vertices"),
        (["--platform", "Abacus"], "no platform 'Abacus'; this OpenMM has"),
        (["--seconds", 0], "0.0 is not in the range"),
    ],
)
def test_mistakes(arguments, message):
    result = invoke(*arguments)
    assert result.exit_code == 2
    assert message in result.output


def test_integrators_are_those_that_can_be_raced():
    assert tuple(_benchmark.INTEGRATORS) == _INTEGRATORS
    for name, make in _benchmark.INTEGRATORS.items():
        assert type(make()).__name__ == f"{name}Integrator"


def test_fastest_finds_the_time_of_a_step(monkeypatch):
    """On a clock that only the steps move: one side is slow at first, one in every other run."""
    now, counts = [0.0], {"steady": [], "warm": [], "shaken": []}
    monkeypatch.setattr(timing.time, "perf_counter", lambda: now[0])

    def side(name, cost):
        def step(count):
            counts[name].append(count)
            now[0] += count * cost(len(counts[name]))

        return step

    sides = {
        "steady": side("steady", lambda call: 2e-3),
        "warm": side("warm", lambda call: 1e-2 if call < 3 else 1e-3),
        "shaken": side("shaken", lambda call: 5e-7 * (1 + call % 2)),
    }
    best = _benchmark.fastest(sides, 4, 0.02, least=7)
    assert best == pytest.approx({"steady": 2000, "warm": 1000, "shaken": 0.5})
    for name, seconds in (("steady", 2e-3), ("shaken", 1e-6)):
        *_, one, two, three, four = counts[name]
        assert one == two == three == four >= 7
        assert one == 7 or 0.25 < one * seconds / 0.02 < 4


def test_a_run_that_breaks_down_is_refused():
    vesicle = Vesicle(_benchmark.sphere(2))
    target = _benchmark.targets(["Reference"])[0][0]
    context = _benchmark.start(vesicle.system(), vesicle, "Verlet", target)
    steps = _benchmark.Steps(context)
    steps(5)
    steps.check()
    empty = _benchmark.start(_benchmark.empty_system(vesicle), vesicle, "Verlet", target)
    velocities = empty.getState(velocities=True).getVelocities(asNumpy=True)
    velocities[3] *= float("inf")
    empty.setVelocities(velocities)
    with pytest.raises(FloatingPointError, match="the energy is"):
        _benchmark.Steps(empty).check()


def test_targets():
    found, failed = _benchmark.targets(["Reference", "Nowhere"])
    assert [target.label for target in found] == ["Reference"]
    assert list(failed) == ["Nowhere"]
    names = {target.platform for target in _benchmark.targets()[0]}
    assert {"Reference", "CPU"} <= names


def test_machine_and_versions():
    facts = _benchmark.machine()
    assert facts["processor"]
    assert int(facts["cores"]) >= 1
    assert _benchmark.versions()["OpenMM"] == openmm.Platform.getOpenMMVersion()
