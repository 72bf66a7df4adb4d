"""Some of what `tests/faults.py` does at length: faults strike, and runs go on."""

from __future__ import annotations

import random
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("h5py")
pytest.importorskip("distributed")
sys.path.append(str(Path(__file__).resolve().parents[1]))
import fault_cases
import fault_kinds


@pytest.fixture(scope="module")
def peace(tmp_path_factory):
    """Inputs, and for each kind of run its outputs when nothing happens, and the time it takes."""
    place = tmp_path_factory.mktemp("peace")
    inputs = place / "inputs"
    inputs.mkdir()
    fault_kinds.prepare(inputs)
    found = {}
    for kind in ("vcm", "sweep"):
        case = fault_cases.Case(kind, inputs, None, 0, None, place / kind)
        begin = time.monotonic()
        assert case.start().wait()[0] == 0
        found[kind] = inputs, case.out, time.monotonic() - begin
    return found


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("kill", "vcm"),
        ("kill", "sweep"),
        ("vanished folder", "vcm"),
        ("SIGTERM", "vcm"),
        ("Ctrl-C twice", "vcm"),
        ("second process", "vcm"),
        ("damaged checkpoint", "vcm"),
        ("damaged checkpoint", "sweep"),
        ("cut tail", "vcm"),
        ("clock that jumps", "sweep"),
    ],
)
def test_fault(peace, tmp_path, name, kind):
    inputs, quiet, length = peace[kind]
    chance = random.Random(name)
    fault, kinds = fault_cases.FAULTS[name]
    assert kind in kinds
    for number in range(20):
        case = fault_cases.Case(kind, inputs, quiet, length, chance, tmp_path / str(number))
        if fault(case):
            return
    pytest.fail("the fault did not strike")
