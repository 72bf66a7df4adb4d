"""The examples run as a user runs them, and everything that they write can be read back."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import openmm
import pytest
from openmm.app.internal.xtc_utils import read_xtc
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import Vesicle
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"


def run(script, *arguments, check=True):
    environment = dict(os.environ, PYTHONUTF8="1")
    # Another folder than the repository's, as a user may be anywhere.
    return subprocess.run(
        [sys.executable, str(script), *map(str, arguments)],
        cwd=os.path.abspath(os.sep),
        env=environment,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=600,
        check=check,
    )


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    """Output folder and printed text of the demo."""
    folder = tmp_path_factory.mktemp("demo")
    result = run(EXAMPLES / "vesicle.py", "--quick", "--seed", 3, "--out", folder)
    return folder, result.stdout


@pytest.mark.long
def test_variable_masses(tmp_path):
    run(EXAMPLES / "variable_mass.py", "energy", "areas", "cost", "--quick", "--out", tmp_path)
    energy, areas = (
        list(csv.DictReader((tmp_path / f"{name}.csv").open(encoding="utf-8")))
        for name in ("energy", "areas")
    )
    assert len(energy) == 2 and len(areas) == 3
    assert all(0 < float(row["largest"]) < 1e-3 for row in energy)
    variances = [float(row["variance"]) for row in areas]
    assert 0 < variances[1] < variances[0] < 1


class TestDemo:
    def test_prints_what_it_measures(self, demo):
        _, text = demo
        for word in ("area", "volume", "bending", "heights", "temperature", "reduced volume"):
            assert word in text
        assert "steps/s" in text
        assert "theory" in text
        assert "kV = 0" in text

    def test_trajectory(self, demo):
        folder, _ = demo
        coordinates, _, time, _ = read_xtc(str(folder / "vesicle.xtc").encode())
        positions = np.moveaxis(coordinates, -1, 0)
        rows = list(csv.DictReader((folder / "vesicle.csv").open(encoding="utf-8")))
        assert positions.shape == (20, 252, 3)
        assert len(rows) == 20
        assert float(rows[-1]["step"]) == 2000
        np.testing.assert_allclose(time, [float(row["time_ps"]) for row in rows], rtol=1e-5)
        # Every frame is a mesh of about the logged area: nm, not Å, and in the order of the PLY.
        triangles = Mesh.read(folder / "vesicle.ply").triangles
        for frame, row in zip(positions, rows, strict=True):
            assert Mesh(frame, triangles).area == pytest.approx(float(row["area_nm2"]), rel=1e-4)

    def test_log(self, demo):
        folder, _ = demo
        rows = list(csv.DictReader((folder / "vesicle.csv").open(encoding="utf-8")))
        for name, value in rows[-1].items():
            assert np.isfinite(float(value)), name
        assert 200 < float(rows[-1]["temperature_K"]) < 400
        assert 0.9 < float(rows[-1]["reduced_volume"]) < 1

    def test_last_mesh_is_the_last_frame(self, demo):
        folder, _ = demo
        mesh = Mesh.read(folder / "vesicle.ply")
        assert mesh.num_vertices == 252
        assert mesh.euler_characteristic == 2
        coordinates = read_xtc(str(folder / "vesicle.xtc").encode())[0]
        # XTC keeps thousandths of a nm.
        np.testing.assert_allclose(mesh.vertices, coordinates[..., -1], atol=2e-3)

    def test_wire_mesh(self, demo):
        folder, _ = demo
        mesh = Mesh.read(folder / "vesicle.ply")
        for name, word in (("vesicle.psf", "!NBOND"), ("vesicle.data", " bonds")):
            line = next(row for row in (folder / name).read_text().splitlines() if word in row)
            assert int(line.split()[0]) == len(mesh.edges)

    def test_picture(self, demo):
        folder, _ = demo
        pixels = np.asarray(Image.open(folder / "vesicle.png").convert("RGB"))
        assert min(pixels.shape[:2]) > 500
        left = pixels[:, : pixels.shape[1] // 2].reshape(-1, 3)
        right = pixels[:, pixels.shape[1] // 2 :].reshape(-1, 3)
        # A shaded, coloured surface on the left; axes, points and a line on the right.
        assert len(np.unique(left, axis=0)) > 2000
        assert (left != 255).any(axis=1).mean() > 0.2
        assert 0.01 < (right != 255).any(axis=1).mean() < 0.5

    def test_checkpoint_continues(self, demo):
        folder, _ = demo
        mesh = Mesh.read(folder / "vesicle.ply")
        # On the platform that the demo was on, since neither has named one.
        simulation = Vesicle(mesh).simulation(openmm.LangevinMiddleIntegrator(300, 0.01, 0.2))
        simulation.loadCheckpoint(str(folder / "vesicle.chk"))
        state = simulation.context.getState(getPositions=True)
        np.testing.assert_allclose(
            state.getPositions(asNumpy=True)._value, mesh.vertices, atol=1e-9
        )
        simulation.step(10)

    def test_spectrum_is_near_theory(self, demo):
        folder, _ = demo
        rows = list(csv.DictReader((folder / "spectrum.csv").open(encoding="utf-8")))
        assert [int(row["l"]) for row in rows[:3]] == [2, 3, 4]
        # The quick run is much too short for numbers; the order of magnitude must be there.
        for row in rows[2:5]:
            ratio = float(row["surface_mean"]) / float(row["theory_A17"])
            assert 0.1 < ratio < 10


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--platform", "Abacus"], "Abacus"),
        (["--softness", "-1"], "softness"),
        (["--time", "-5"], "--time"),
        (["--time", "5", "--steps", "5"], "not allowed with"),
        (["--vertices", "13"], "13"),
        (["--time-step", "50"], "the run failed"),
    ],
)
def test_demo_says_what_is_wrong(tmp_path, arguments, message):
    result = run(EXAMPLES / "vesicle.py", "--quick", "--out", tmp_path, *arguments, check=False)
    assert result.returncode != 0
    assert message in result.stderr
    assert "Traceback" not in result.stderr


def test_demo_says_where_it_cannot_write(tmp_path):
    (tmp_path / "file").write_text("")
    result = run(EXAMPLES / "vesicle.py", "--quick", "--out", tmp_path / "file", check=False)
    assert result.returncode != 0
    assert str(tmp_path / "file") in result.stderr
    assert "Traceback" not in result.stderr


def test_integrators():
    text = run(EXAMPLES / "integrators.py", "--quick").stdout
    for word in ("Verlet", "LangevinMiddle", "Brownian", "drift", "temperature", "diffusion"):
        assert word in text


@pytest.mark.long
def test_friction_of_undulations(tmp_path):
    run(EXAMPLES / "flips/undulation_friction.py", "--quick", "--results", tmp_path)
    with (tmp_path / "undulation_friction.csv").open(encoding="utf-8") as file:
        without, flipping = list(csv.DictReader(file))
    assert float(without["flips"]) == 0 < float(flipping["flips"])
    for l in range(2, 7):
        for row in (without, flipping):
            # From the discrete mesh's frequency to that of the continuum, and no mode overdamped.
            assert 0 < float(row[f"γ_{l}/ω_{l}"]) < 1
            assert 0.7 < float(row[f"ω/ω_{l}"]) < 1.3


@pytest.mark.parametrize(
    ("script", "quick", "said"),
    [
        ("sheet.py", ["--steps", "800"], "triangles that cross: 0"),
        ("tube.py", [], "pulling force    20.9"),
    ],
)
def test_surfaces_for_newcomers(tmp_path, script, quick, said):
    text = run(EXAMPLES / script, *quick, "--out", tmp_path).stdout
    assert said in text
    name = Path(script).stem
    assert Image.open(tmp_path / f"{name}.png").width > 400
    assert Mesh.read(tmp_path / f"{name}.ply").box is not None


def test_bench_of_empty_steps():
    text = run(ROOT / "benches" / "empty_steps.py", "--repeats", "1", "--sizes", "252").stdout
    assert "Helfrich x2" in text and text.count(" 252 ") == 3
