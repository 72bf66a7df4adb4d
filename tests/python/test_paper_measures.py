"""What the scripts in examples/paper decide verdicts with, on made-up data of known answers."""

import sys
from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich import Mesh

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
    from fig08_red_cell import thickness

    diameter, middle, rim = thickness(disc(0))
    assert diameter == pytest.approx(2000, rel=0.02)
    assert middle == pytest.approx(600, rel=0.02)
    assert rim == pytest.approx(600, rel=0.02)
    _, middle, rim = thickness(disc(0.6))
    assert middle == pytest.approx(0.42 * 600, rel=0.05)
    assert rim > 1.7 * middle


def test_autocorrelation_of_exponential_memory_comes_back_with_the_spread_of_the_modes():
    from fig09_10_autocorrelation import PERIODS, Measured, frequency_of

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
    found = Measured(runs, l, friction, num_vertices)
    assert found.times[-1] == pytest.approx(3 * memory, rel=0.05)
    assert np.abs(found.mean - np.exp(-found.times / memory)).max() < 0.05
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

    seeds = [point["seed"] for point in points_of(1002, FULL)]
    assert len(set(seeds)) == len(seeds) == 18
