"""What the scripts in examples/paper decide verdicts with, on made-up data of known answers."""

import sys
from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich import Mesh
from scipy.linalg import expm

PAPER = Path(__file__).parents[2] / "examples" / "paper"


@pytest.fixture(autouse=True)
def scripts_importable(monkeypatch):
    monkeypatch.syspath_prepend(str(PAPER))
    yield
    for script in PAPER.glob("*.py"):
        sys.modules.pop(script.stem, None)


def relaxations(time, count=10):
    """Energies that fall by 1000 kJ/mol in the given time in units of τ_2, with noise."""
    times = np.linspace(0, 3, 301)
    noise = np.random.default_rng(2).normal(size=(count, len(times)))
    return times, 2000 + 1000 * np.exp(-times / time) + 30 * noise


def test_energies_settle_a_few_relaxation_times_after_the_start():
    from fig11_relaxation import drift, settling_time

    times, runs = relaxations(0.1)
    settled, plateau, band = settling_time(times, runs.mean(axis=0))
    # Down to a twentieth after ln 20 relaxation times.
    assert settled == pytest.approx(0.1 * np.log(20), abs=0.11)
    assert plateau == pytest.approx(2000, abs=5)
    assert band == pytest.approx(50, rel=0.05)
    rise, error = drift(runs)
    assert abs(rise) < 3 * error < 10


@pytest.mark.parametrize("time", [1.5, 5.0])
def test_energies_that_still_fall_at_the_end_are_seen_to_drift(time):
    from fig11_relaxation import drift, settling_time

    times, runs = relaxations(time)
    settled, _, band = settling_time(times, runs.mean(axis=0))
    assert settled > 1
    rise, error = drift(runs)
    exact = 1000 * np.exp(-times / time)
    assert rise == pytest.approx(exact[-75:].mean() - exact[-150:-75].mean(), abs=3 * error)
    assert rise < -5 * error
    assert rise < -band


def test_a_plaquette_has_its_inside():
    from fig16_landscapes import inside_plaquette

    angles = np.array([0.1, 1.2, 2.0, 3.3, 4.1, 5.5])
    ring = np.stack([0.2 * np.cos(angles), 0.2 * np.sin(angles), np.full(6, 0.98)], axis=1)
    vertex = np.array([0.0, 0.0, 1.0])
    outside = np.array([[0.21 * np.cos(a), 0.21 * np.sin(a), 0.97] for a in angles])
    assert inside_plaquette(np.stack([vertex, 2 * vertex, (0.05, -0.1, 0.99)]), ring, vertex).all()
    # Seen from the centre, height over the sphere does not matter.
    assert inside_plaquette(0.5 * ring * (0.9, 0.9, 1), ring, vertex).all()
    assert not inside_plaquette(outside, ring, vertex).any()


def disc(dent):
    """A flat ellipsoid of 1000 × 1000 × 300 nm with its middle dented by a share of its height."""
    mesh = Mesh.icosphere(12, 1000.0)
    x, y, z = mesh.vertices.T
    rho = np.hypot(x, y) / 1000
    z = 0.3 * z * (1 - dent * np.exp(-((rho / 0.4) ** 2)))
    return Mesh(np.stack([x, y, z], axis=1), mesh.triangles)


def test_dimples_are_measured():
    from fig07_oblates import dimple

    assert dimple(disc(0)) > 0.97
    # √(1 − ρ²) (1 − 0.6 exp(−(ρ/0.4)²)) is 0.42 around the axis and at most 0.76, at ρ = 0.55.
    assert dimple(disc(0.6)) == pytest.approx(0.42 / 0.76, abs=0.03)


def test_thicknesses_of_discs_are_measured():
    from red_cell_shapes import thickness

    diameter, middle, rim = thickness(disc(0))
    assert diameter == pytest.approx(2000, rel=0.02)
    assert middle == pytest.approx(600, rel=0.02)
    assert rim == pytest.approx(600, rel=0.02)
    _, middle, rim = thickness(disc(0.6))
    assert middle == pytest.approx(0.42 * 600, rel=0.05)
    assert rim > 1.7 * middle


def test_autocorrelation_of_exponential_memory_comes_back_with_the_spread_of_the_modes():
    from fig09_10_autocorrelation import PERIODS, Measured, Setting, frequency_of

    num_vertices, l, friction = 1002, 3, 0.01
    omega = frequency_of(l, num_vertices)
    memory = friction / omega**2
    interval = memory / 10
    frames = round(PERIODS * 2 * np.pi / frequency_of(2, num_vertices) / interval)
    keep = np.exp(-interval / memory)
    random = np.random.default_rng(4)
    runs = []
    for _ in range(200):
        noise = random.normal(size=(frames, 16))
        modes = np.empty_like(noise)
        modes[0] = noise[0]
        for frame in range(1, frames):
            modes[frame] = keep * modes[frame - 1] + np.sqrt(1 - keep**2) * noise[frame]
        runs.append({"fit": modes, "interval": interval})
    found = Measured(runs, l, Setting("langevin", friction, num_vertices))
    assert found.times[-1] == pytest.approx(3 * memory, rel=0.05)
    deviation = np.abs(found.mean - np.exp(-found.times / memory))
    assert deviation.max() < 0.05
    # The error is that of the mean over runs, and can fail.
    assert np.sqrt(np.mean(deviation**2)) < 2 * np.sqrt(np.mean(found.error**2)) < 0.02
    # The variance of a mean square over time of a process with this memory.
    expected = np.sqrt(2 * memory / (frames * interval))
    assert found.spread[0] == pytest.approx(expected, rel=0.15)


def test_samples_of_all_vesicles_but_those_of_other_softness_have_seeds_of_their_own():
    from fluctuations import SOFTNESS
    from spectra import FULL, arguments_of, points_of

    seeds = [
        arguments["seed"]
        for point in points_of(FULL)
        if point.softness == SOFTNESS[0]
        for arguments in arguments_of(point, FULL["samples"])
    ]
    assert len(seeds) > 50
    assert len(set(seeds)) == len(seeds)


def test_a_digest_is_that_of_a_configuration_and_its_meshes(tmp_path):
    from fig08_red_cell import digest

    folders = [tmp_path / name for name in ("one", "two")]
    for folder in folders:
        folder.mkdir()
        (folder / "cell.txt").write_text("-Membrane\nMeshFile mesh.ply\n")
        (folder / "mesh.ply").write_text("ply")
        (folder / "other.ply").write_text("ply")
    one, two = (folder / "cell.txt" for folder in folders)
    assert digest(one) == digest(two)
    (folders[1] / "other.ply").write_text("not named")
    assert digest(one) == digest(two)
    (folders[1] / "mesh.ply").write_text("changed")
    assert digest(one) != digest(two)
    # Its comments are in whatever encoding.
    one.write_bytes(one.read_bytes() + "# µm\n".encode("latin-1"))
    assert len({digest(one), digest(two)}) == 2


def test_integrators_have_seeds_of_their_own():
    from fig09_10_autocorrelation import FULL, points_of
    from fluctuations import SOFTNESS

    seeds = [point["seed"] for softness in SOFTNESS for point in points_of(FULL, softness)]
    assert len(set(seeds)) == len(seeds) == 4 * 4 * 35


def test_dampings_and_frequencies_of_each_mode_come_back_without_the_mean_shape():
    from fig09_10_autocorrelation import frequency_of
    from sm09_damping import fitted

    num_vertices, l = 1002, 3
    omega = frequency_of(l, num_vertices)
    interval = 2 * np.pi / omega / 25
    # Damped by 0.1 ω_l, at 0.9 ω_l, exact from frame to frame; in units of ω_l.
    step = expm(np.array([[0, 1], [-(0.9**2), -0.1]]) * omega * interval)
    covariance = np.diag([1, 0.9**2])
    kick = np.linalg.cholesky(covariance - step @ covariance @ step.T)
    random = np.random.default_rng(9)
    runs = []
    for _ in range(21):
        state = np.sqrt(covariance) @ random.normal(size=(2, 7))
        modes = np.zeros((1500, 16))
        for frame in range(1500):
            state = step @ state + kick @ random.normal(size=(2, 7))
            modes[frame, 9:] = state[0] + 5
        runs.append({"fit": modes})
    times = interval * np.arange(76)
    (friction, frequency), errors = fitted(runs, l, times, omega, "fit")
    assert abs(friction - 0.1) < 4 * errors[0] < 0.02
    assert abs(frequency - 0.9) < 4 * errors[1] < 0.02


def test_errors_of_the_papers_spectra_are_those_of_ten_samples():
    from fig06c_fluid import error_of_the_paper

    # Each of 20 τ_2 at 0.01/ps: with the memory M = γ/ω_2² of 2.9 and 5.8 τ_2 √(2 M/T (2l+1)).
    assert error_of_the_paper(2, 1002) == pytest.approx(0.077, abs=0.004)
    assert error_of_the_paper(2, 4002) == pytest.approx(0.108, abs=0.005)


def test_energy_is_what_the_counters_of_the_packages_say(tmp_path, monkeypatch):
    import tab03_wall_time as table

    for name in ("intel-rapl:0", "intel-rapl:1", "intel-rapl:0:0"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "max_energy_range_uj").write_text("1000000000")
        (tmp_path / name / "energy_uj").write_text("999000000")
    clock = iter((100.0, 104.0))
    monkeypatch.setattr(table.time, "perf_counter", lambda: next(clock))
    meter = table.Meter(225, tmp_path)
    meter.start()
    # The first counter starts anew: 1 J to its end and 99 J beyond it; a part of it is not added.
    (tmp_path / "intel-rapl:0" / "energy_uj").write_text("99000000")
    (tmp_path / "intel-rapl:1" / "energy_uj").write_text("999500000")
    (tmp_path / "intel-rapl:0:0" / "energy_uj").write_text("50000000")
    assert meter.watts() == pytest.approx((100 + 0.5) / 4)
    assert "2 package(s)" in meter.source
    assert table.Meter(225, tmp_path / "none").watts() == 225
    assert "225 W" in table.Meter(225, tmp_path / "none").source


def test_runs_whose_windows_differ_are_told_from_those_that_do_not():
    from sm03_distributions import hotelling

    random = np.random.default_rng(1)
    same = random.normal(size=(2000, 12, 3)) @ np.array([[1, 0.8, 0], [0, 1, 0], [0, 0.3, 0.1]])
    chances = np.array([hotelling(samples)[1] for samples in same])
    # Chances of right theories are even between 0 and 1.
    assert np.abs(np.quantile(chances, (0.1, 0.5, 0.9)) - (0.1, 0.5, 0.9)).max() < 0.04
    assert hotelling(same[0] + (0, 0, 0.5))[1] < 1e-3


def test_alike_triangles_tie_bonds_to_areas():
    from sm04_degrees import bond_of, by_degree

    for degree in (5, 6, 7):
        length = 1.7
        area = degree / 3 * 0.5 * length**2 * np.sin(2 * np.pi / degree)
        assert bond_of(area, degree) / bond_of(np.sqrt(0.75), 6) == pytest.approx(length)
    mesh = Mesh.random_sphere(252, 1000.0, 3)
    jitter = np.random.default_rng(3).normal(size=(4, 252, 3))
    found = by_degree(mesh.vertices + 20 * jitter, mesh.triangles)
    assert found["number"] @ (5, 6, 7) == 2 * len(mesh.edges)
    assert found["area_sum"] == pytest.approx(1, abs=1e-12)
    assert found["length_sum"] == pytest.approx(1, abs=1e-12)
    assert (np.diff(found["area"]) > 0.1).all()


def test_a_cup_has_a_thickness_and_a_crumpled_surface_dents():
    from red_cell_shapes import dented, dimple, thickness

    # A disc bent up at its rim: both of its sides are above the middle's there.
    flat = disc(0)
    x, y, z = flat.vertices.T
    cup = Mesh(np.stack([x, y, z + (x**2 + y**2) / 1500], axis=1), flat.triangles)
    _, middle, rim = thickness(cup)
    assert middle == pytest.approx(600, rel=0.03)
    assert rim == pytest.approx(600, rel=0.06)
    tilted = disc(0.6).rotated(expm(np.cross(np.eye(3), (0.4, -0.2, 0.9))))
    assert dimple(tilted) == pytest.approx(0.42 / 0.76, abs=0.04)
    assert dented(flat) < 0.01
    jitter = np.random.default_rng(5).normal(size=(flat.num_vertices, 1))
    crumpled = Mesh(flat.vertices * (1 + 0.02 * jitter), flat.triangles)
    assert 0.3 < dented(crumpled) < 0.55


def test_normals_agree_on_a_sphere_and_cancel_around_a_needle_and_a_fold():
    from red_cell_shapes import coherence

    mesh = Mesh.icosphere(4, 1.0)
    rough = mesh.vertices + 0.01 * np.random.default_rng(2).normal(size=mesh.vertices.shape)
    assert coherence(rough, mesh.triangles).min() > 0.9
    # A cone of n alike triangles of half angle α: all normals have sin α along the axis.
    for length, degree in ((1.0, 5), (30.0, 6)):
        angles = 2 * np.pi * np.arange(degree) / degree
        ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
        tip = np.vstack([ring, (0, 0, length)])
        triangles = [(i, (i + 1) % degree, degree) for i in range(degree)]
        inner = np.cos(np.pi / degree)
        found = coherence(tip, np.array(triangles))[degree]
        assert found == pytest.approx(inner / np.hypot(length, inner))
    # Two triangles upon each other.
    folded = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 1e-6)])
    assert coherence(folded, np.array([(0, 1, 2), (1, 0, 3)]))[:2].max() < 1e-5
