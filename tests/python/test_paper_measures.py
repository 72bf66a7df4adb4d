"""What the scripts in examples/paper decide verdicts with, on made-up data of known answers."""

from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich import Mesh
from scipy.linalg import expm

PAPER = Path(__file__).parents[2] / "examples" / "paper"


pytestmark = pytest.mark.usefixtures("paper_scripts")


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
    assert settling_time(times, runs.mean(axis=0))[0] > 1
    rise, error = drift(runs)
    late = times >= 2
    line = np.polyfit(times[late], 1000 * np.exp(-times[late] / time), 1)
    assert rise == pytest.approx(line[0], abs=3 * error)
    assert rise < -5 * error


@pytest.mark.parametrize("runs", [10, 40])
def test_a_drift_of_nothing_is_within_its_error(runs):
    from fig11_relaxation import drift

    noise = np.random.default_rng(8).normal(size=(runs, 300))
    rise, error = drift(noise)
    # A line through 100 values over a time of 1 has a variance of 12 / 100.
    assert error == pytest.approx(np.sqrt(12 / 100 / runs), rel=0.5)
    assert abs(rise) < 3 * error
    # Runs that agree by chance are not more certain than their lines.
    assert drift(noise[[0, 0]])[1] > 0.1


def test_slopes_of_lines_in_noise():
    from oblates import slope

    line = np.linspace(0, 5, 240)
    assert slope(line)[0] == pytest.approx(5, rel=0.01)
    noise = np.random.default_rng(6).normal(size=(200, 240))
    changes, errors = np.transpose([slope(line + each) for each in noise])
    assert changes.mean() == pytest.approx(5, abs=0.1)
    assert changes.std() == pytest.approx(np.sqrt((errors**2).mean()), rel=0.2)


def vesicle(crossings=(), height=30.0, rise=0.0, failed=""):
    """What `oblate_run` returns of a vesicle whose bending energy rises by a number in its run."""
    energies = np.full((240, 4), 2000.0)
    energies += np.random.default_rng(1).normal(size=energies.shape)
    energies[:, 2] += np.linspace(0, rise, 240)
    energies[:, 3] += height - 2000
    return {"energies": energies, "crossings": np.array(crossings, dtype=int), "failed": failed}


@pytest.mark.parametrize(
    "found, expected",
    [
        (vesicle([0, 0]), "green"),
        (vesicle([0, 0], height=32.0), "green"),
        (vesicle([0, 0], height=34.0), "yellow"),
        (vesicle([0, 0], rise=20.0), "yellow"),
        (vesicle([0, 3]), "red"),
        (vesicle(failed="a position is not finite"), "red"),
    ],
)
def test_vesicles_have_the_papers_classes(found, expected):
    from oblates import class_of

    assert class_of(found, sphere=30.0) == expected


def test_softness_comes_back_from_meshes_that_fold():
    from fig04b_bias import SOFTNESSES, least_softness, with_error

    a, b = 3.0, 32.0
    rates = np.exp(a - b * np.array(SOFTNESSES))
    exact = (a + np.log(50)) / b
    many = 1_000_000
    found, *parameters = least_softness(
        SOFTNESSES, many * -np.expm1(-rates), [many] * len(SOFTNESSES)
    )
    assert found == pytest.approx(exact, rel=1e-3)
    assert parameters == pytest.approx([a, b], rel=1e-2)
    folds = np.random.default_rng(3).random((40, 2, len(SOFTNESSES))) < -np.expm1(-rates)
    (found, *_), error = with_error(SOFTNESSES, folds)
    assert abs(found - exact) < 3 * error < 0.1


def test_smooth_surfaces_have_the_theory_at_small_deformations():
    from spheres import AREA_MODULUS, RIGIDITY, VOLUME_MODULUS, smooth_energies, smooth_slopes

    radius, u = 1000.0, 1e-3
    expected = [
        8 / np.pi * AREA_MODULUS * radius**2 * u**3,
        3 / (2 * np.pi) * VOLUME_MODULUS * radius**3 * u**3,
        24 * RIGIDITY * u,
    ]
    assert smooth_slopes(u) == pytest.approx(expected, rel=1e-3)
    assert smooth_energies(0)[2] == pytest.approx(8 * np.pi * RIGIDITY)
    step = 1e-5
    difference = (smooth_energies(0.5 + step) - smooth_energies(0.5 - step)) / (2 * step)
    assert smooth_slopes(0.5) == pytest.approx(difference, rel=1e-7)


def test_projected_forces_are_slopes_of_energies_of_any_mesh():
    from fig04d_forces import forces_of
    from spheres import context_of, fluctuating

    mesh, _ = fluctuating(Mesh.icosphere(4, 1000.0), 0.22, 1, 2.0)
    context, groups = context_of(mesh)

    def energies(amplitude):
        context.setPositions(mesh.deformed(2, 0, amplitude).vertices)
        return np.array(
            [
                context.getState(energy=True, groups={group}).getPotentialEnergy()._value
                for group in range(groups)
            ]
        )

    step = 1e-5
    expected = (energies(0.2 + step) - energies(0.2 - step)) / (2 * step)
    assert forces_of(mesh, [0.2])[0] == pytest.approx(expected, rel=1e-5)


def test_medians_have_the_error_of_normal_scatter():
    from fig04d_forces import median_and_error

    random = np.random.default_rng(5)
    samples = random.normal(3, 2, size=(400, 50))
    medians, errors = np.transpose([median_and_error(each) for each in samples])
    assert medians.std() == pytest.approx(errors.mean(), rel=0.15)
    wild = np.append(samples[0], 1e9)
    assert abs(median_and_error(wild)[0] - medians[0]) < errors[0]


def test_newtonian_runs_fail_by_both_criteria_and_live_with_short_steps():
    from newtonian import failing_run

    common = {"mesh": "ordered", "num_vertices": 252, "duration": 0.02, "looks": 2, "seed": 1}
    dead = failing_run(scheme="Julicher", softness=0.59, fraction=1.0, **common)
    assert 0 < dead["energy"] <= dead["lived"] < 0.02
    assert 0 < dead["kinetic"] <= dead["lived"]
    alive = failing_run(scheme="Julicher", softness=0.59, fraction=0.05, **common)
    assert alive["energy"] is alive["kinetic"] is None
    assert alive["lived"] == pytest.approx(0.02, rel=0.01)
    assert abs(alive["drift"]) < 0.01


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
