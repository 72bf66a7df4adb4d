"""The fuzzing of tests/fuzz for seconds, on the same inputs each time; `make fuzz` looks longer."""

from __future__ import annotations

import random
import sys
from pathlib import Path

import pytest
from openmmhelfrich import Mesh, config, vcm

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fuzz"))
import doors
import run


@pytest.mark.parametrize("name", run.DOORS)
@pytest.mark.filterwarnings("ignore::openmmhelfrich.vcm.ConfigWarning")
def test_changed_inputs(name):
    door = run.load(name)
    dice = random.Random(name)
    seeds = list(door.seeds())
    assert seeds
    for _ in range(40):
        door.check(door.change(dice.choice(seeds), dice))


@pytest.mark.parametrize("name", run.MODULES["door_meshes"])
def test_mesh_files_to_change_are_right(name, tmp_path):
    """So that changes of them reach what comes after the first lines."""
    path = tmp_path / f"mesh.{name}"
    for data in run.load(name).seeds():
        path.write_bytes(data)
        assert Mesh.read(path, triangulate=True, merge=0).num_vertices >= 8


@pytest.mark.parametrize("name", ["toml", "vcm"])
@pytest.mark.filterwarnings("ignore::openmmhelfrich.vcm.ConfigWarning")
def test_configurations_to_change_are_right(name, tmp_path):
    path = tmp_path / ("run.toml" if name == "toml" else "run.txt")
    Mesh.icosphere(2, 100.0).write(tmp_path / "mesh.ply")
    for data in run.load(name).seeds():
        path.write_bytes(data)
        read = config.read if name == "toml" else vcm.read
        assert read(path).num_particles >= 42


@pytest.mark.parametrize("change", ["text", "binary", "xml"])
def test_changes_change(change):
    import mutations

    data = b"<a b='1'><c d='2'/>\n<c d='x 3 4'/></a>"
    dice = random.Random(2)
    found = {getattr(mutations, change)(data, dice) for _ in range(50)}
    assert len(found) > 25


def test_a_fault_is_seen():
    """A wrong answer, another error, and a message that names nobody."""
    with pytest.raises(ZeroDivisionError):
        doors.attempt(lambda: 1 / 0, ValueError)
    with pytest.raises(doors.Wrong, match="does not name"):
        doors.attempt(lambda: int("x"), ValueError, "file.ply")
    assert doors.attempt(lambda: int("x"), ValueError, "'x'") is None
