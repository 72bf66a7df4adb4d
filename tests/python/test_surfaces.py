"""What `examples/surfaces` measures, in short: each script runs, and its theory is checked."""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import openmmhelfrich
import pytest
from openmmhelfrich.mesh import Mesh

SURFACES = Path(__file__).parents[2] / "examples" / "surfaces"
MODULES = (
    *("membranes", "reports", "tube", "minimal", "sheet_spectrum", "closing", "wrapping"),
    *("crossing", "viscosity"),
)


@pytest.fixture(autouse=True)
def scripts_importable(monkeypatch):
    monkeypatch.syspath_prepend(str(SURFACES.parent / "flips"))
    monkeypatch.syspath_prepend(str(SURFACES))
    yield
    for name in MODULES:
        sys.modules.pop(name, None)


def needs(*names):
    missing = [name for name in names if not hasattr(openmmhelfrich, name)]
    return pytest.mark.skipif(bool(missing), reason=f"there is no {missing}")


def tables(script, tmp_path):
    """The tables of a quick run, lists of rows by name."""
    command = [sys.executable, str(SURFACES / f"{script}.py"), "--quick", "--results", tmp_path]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    return {path.stem: list(csv.DictReader(path.open())) for path in tmp_path.glob("*.csv")}


def test_tubes_have_the_radius_and_pull_of_theory(tmp_path):
    found = tables("tube", tmp_path)["tube"]
    assert len(found) == 6
    for row in found:
        assert abs(float(row["deviation_%"])) < 3
        assert float(row["virial_force"]) == pytest.approx(float(row["force"]), rel=1e-3)


def test_the_p_surface_is_minimal(tmp_path):
    found = tables("minimal", tmp_path)
    for row in found["minimal"]:
        assert float(row["H_after"]) < 1e-3 < 0.5 < float(row["H_before"])
        assert abs(float(row["deviation_%"])) < 2
    assert len(found["minimal_gauss_bonnet"]) == 9
    for row in found["minimal_gauss_bonnet"]:
        assert abs(float(row["defect"])) < 1e-12


class TestSheet:
    @pytest.mark.parametrize("strain", [0.0, -0.1])
    def test_waves_of_a_lattice(self, strain):
        """Λ from the core's energy of a wave, F from the amplitude of a wave, in a frame."""
        import sheet_spectrum as script

        flat = Mesh.sheet(16, 16, script.SPACING * (1 + strain), periodic=True)
        q, laplacian, response = script.dispersion(16, flat.area if strain else None)
        bending = openmmhelfrich.BendingForce(flat, 1.0)
        area = flat.area
        for m, n in ((1, 0), (2, 3), (5, -2), (0, 4)):
            place = m, n + script.MODES
            wave = flat.vertices @ (2 * np.pi * np.array([m, n, 0]) / np.diag(flat.box))
            wavy = Mesh(flat.vertices + np.outer(np.cos(wave), (0, 0, 1)), flat.triangles, flat.box)
            # ½ κ ∫ (∇² h)² with ⟨cos²⟩ = ½, but for terms of fourth order in h q.
            assert wavy.energy(bending) == pytest.approx(area * laplacian[place] ** 2 / 4, rel=1e-3)
            assert 2 * abs(script.amplitudes(wavy)[place]) == pytest.approx(response[place])
            assert (wavy.area / area - 1) * 4 == pytest.approx(laplacian[place], rel=1e-3)
        assert laplacian[1, script.MODES] == pytest.approx(q[1, script.MODES] ** 2, rel=0.02)

    def test_κ_comes_back_from_made_up_waves(self):
        import sheet_spectrum as script

        random = np.random.default_rng(1)
        # In a frame 8 % smaller than the sheet; the waves of the sheet would give 25.
        frame, sigma = 3.26e7, 2e-5
        _, laplacian, response = script.dispersion(64, frame)
        size = (4000, *laplacian.shape)
        noise = random.exponential(size=size)
        stiffness = 21 * laplacian**2 + sigma * laplacian
        square = noise * response**2 / np.where(stiffness > 0, stiffness, 1)
        run = {"square": square, "frame": np.full(4000, frame), "sigma": sigma, "vertices": 4096}
        kappa, flat, error = script.fitted(run, 64)
        assert flat == pytest.approx(21, abs=4 * error)
        assert 0 < kappa - flat < 0.8

    def test_measured_tension_is_the_imposed_one(self):
        import sheet_spectrum as script

        run = script.fluctuate(10, 4.0, 0.1, 3, 1)
        unit = script.RIGIDITY / script.SPACING**2
        assert run["sigma"] / unit == pytest.approx(1.58, rel=0.01)
        tau = run["tau"]
        assert tau.mean() == pytest.approx(run["sigma"], abs=5 * tau.std() / len(tau) ** 0.5)
        assert 0.3 < run["acceptance"] < 1


@needs("EdgeTensionForce", "GaussianCurvatureForce")
class TestClosing:
    def test_threshold(self):
        import closing as script

        assert script.threshold(0.0) == pytest.approx(5.783186, rel=1e-6)
        assert script.threshold(-1.0) == pytest.approx(1.8411838**2, rel=1e-6)
        assert script.threshold(-1.99) == pytest.approx(4 * 0.01, rel=0.01)
        for gaussian in (0.0, -1.0, -1.5):
            coarse, fine = (script.unstable_from(n, gaussian) for n in (8, 16))
            # What is left falls as 1/n.
            assert 2 * fine["mode"] - coarse["mode"] == pytest.approx(
                script.threshold(gaussian), rel=0.01
            )
            assert 2 * fine["cap"] - coarse["cap"] == pytest.approx(4 * (2 + gaussian), rel=0.01)

    def test_energies_are_those_of_the_forces(self):
        import closing as script

        mesh, flat = script.cap(5, 0.3), Mesh.disk(5, 5 * script.EDGE)
        same = mesh.scaled((flat.area / mesh.area) ** 0.5)
        bending, curvature, length = script.terms_of(mesh, flat)
        assert same.energy(openmmhelfrich.BendingForce(same, 3.0)) == pytest.approx(3 * bending)
        gaussian = openmmhelfrich.GaussianCurvatureForce(same, 3.0)
        assert same.energy(gaussian) == pytest.approx(3 * curvature)
        border = same.energy(openmmhelfrich.EdgeTensionForce(same, 3.0))
        # EDGE · n is the radius of the disk.
        assert border == pytest.approx(3 * length * 5 * script.EDGE)

    def test_disks_close_above_the_threshold_only(self):
        import closing as script

        exact = script.unstable_from(6, -1.0)["mode"]
        for factor, closed in ((0.8, False), (1.5, True)):
            run = script.let_go(6, -1.0, factor * exact, 1, 8000.0)
            assert (run["share"][-1] > script.CLOSED) == closed


@needs("ParticleSurfaceForce")
def test_beads_are_wrapped_where_adhesion_pays():
    import wrapping as script

    found = script.energies(2.0, 1.0)
    assert found["transition"] == pytest.approx(1, abs=0.05)


@needs("SurfaceRepulsionForce", "ParticleSurfaceForce")
class TestCrossing:
    """What `docs/contact.md` guarantees, by `analysis.crossings`, which knows nothing of forces."""

    @pytest.mark.parametrize(
        ("how", "point"),
        [
            ("pressed", {"n": 3, "force": 40.0, "steps": 4000}),
            ("pressed", {"n": 4, "force": 80.0, "steps": 2000}),
            ("ramp", {"n": 4, "steps": 50}),
        ],
    )
    def test_nothing_crosses_but_without_contact(self, how, point):
        import crossing as script

        run = getattr(script, how)
        for seed in (1, 2):
            assert not run(**point, contact=True, seed=seed)["crossings"].any()
            assert run(**point, contact=False, seed=seed)["crossings"][-1] > 10

    @pytest.mark.parametrize(("edge", "radius"), [(2.0, 1e5), (2.0, 18.0), (0.5, 18.0)])
    def test_adhesion_is_the_energy_by_area(self, edge, radius):
        import crossing as script

        assert script.adhesion(edge, radius)["ratio"] == pytest.approx(1, abs=3e-5)

    @pytest.mark.parametrize("box", [None, 400.0])
    def test_particles_stay_on_their_side(self, box):
        import crossing as script

        run = script.crowd(4, 3000, 100.0, 1, box)
        assert run["through"] == run["escaped"] == 0
        assert run["within"] > 100 and run["moved"] > 25
        # Many have touched, and energy is conserved.
        assert run["potential"] > 0.05 and run["scatter"] < 1e-3


def test_viscosities_are_those_of_theory(tmp_path):
    found = tables("viscosity", tmp_path)
    for row in found["viscosity"]:
        assert 0.75 < float(row["ratio"]) < 1
        assert float(row["γΔt/m"]) > 0.1 or float(row["ratio"]) > 0.94
    nets = found["viscosity_nets"]
    assert float(nets[0]["affine"]) == pytest.approx(1)
    assert float(nets[0]["flowing"]) == pytest.approx(1)
    for row in nets[1:]:
        assert 0.8 < float(row["flowing"]) < 1 < float(row["affine"])
    for row in found["viscosity_springs"]:
        if row["corrected"] == "True":
            assert abs(float(row["energy"]) - 1) < 4 * float(row["error"]) < 0.1
        else:
            assert float(row["energy"]) < 0.95
