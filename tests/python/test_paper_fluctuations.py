"""What the fluctuation scripts in examples/paper compute, on known motions of vertices."""

import sys
from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich import Mesh, TriangleHeightForce
from openmmhelfrich.analysis import real_harmonics, theory
from openmmhelfrich.vesicle import KBT
from scipy.spatial.transform import Rotation
from undulating import surface_gradient

PAPER = Path(__file__).parents[2] / "examples" / "paper"


@pytest.fixture(autouse=True)
def scripts_importable(monkeypatch):
    monkeypatch.syspath_prepend(str(PAPER))
    yield
    for name in ("displacements", "fluctuations", "mesh_corrections", "two_modes"):
        sys.modules.pop(name, None)


def tangential_gradient(directions, index, lmax):
    """Surface gradient of one harmonic."""
    return surface_gradient(lambda place: real_harmonics(place, lmax)[:, index], directions)


def test_displacements_of_known_amplitude_come_back_from_a_rotated_vesicle():
    from displacements import Displacements

    mesh = Mesh.icosphere(6, 1000.0)
    directions = mesh.vertices / 1000
    compressed, rotated, amplitude = 4 + 2 + 1, 9 + 3 - 2, 2e-4
    moved = (
        directions
        + amplitude * tangential_gradient(directions, compressed, 4)
        - 2 * amplitude * np.cross(directions, tangential_gradient(directions, rotated, 4))
    )
    turn = Rotation.from_euler("xyz", (0.3, -1.1, 2.0)).as_matrix()
    frames = (moved * 1000 @ turn.T + (5.0, -3.0, 1.0))[np.newaxis]
    measure = Displacements(mesh.vertices, 6)
    compression, rotation = measure(measure.aligned(frames))
    expected = np.zeros((2, 49))
    expected[0, compressed], expected[1, rotated] = amplitude, -2 * amplitude
    # Second-order terms of the displacement are some 1e-3 of it; l = 1 is a matter of the frame.
    found = np.stack([compression[0], rotation[0]])
    assert np.abs(found - expected)[:, 4:].max() < 5e-3 * amplitude


def test_moduli_come_back_from_normal_amplitudes_of_their_energy():
    from displacements import moduli, shear_modulus

    l, area, shear, bending = 3, 110.0, 60.0, 20.0
    n = l * (l + 1)
    stiffness = np.array(
        [
            [bending * theory.stiffness(l) + 4 * area, -2 * n * area],
            [-2 * n * area, n**2 * area + n * (n - 2) * shear],
        ]
    )
    random = np.random.default_rng(3)
    drawn = random.multivariate_normal([0, 0], np.linalg.inv(stiffness), size=(40_000, 7))
    shape, compression = np.zeros((2, 40_000, 16))
    shape[:, 9:], compression[:, 9:] = drawn[..., 0], drawn[..., 1]
    values, errors = moduli(shape, compression, l)
    assert np.abs(values - (area, shear, bending)).max() < 1.5
    assert (np.abs(values - (area, shear, bending)) < 4 * errors).all()
    rotation = random.normal(size=(40_000, 16)) / np.sqrt(shear * n * (n - 2))
    value, error = shear_modulus(rotation, l)
    assert abs(value - shear) < 4 * error < 2


def test_heights_virial_is_the_work_of_scaling():
    from fluctuations import heights_virial, vesicle_of

    vesicle = vesicle_of(92, 20.0, 1000.0, 0.59, "Julicher")
    jitter = np.random.default_rng(5).normal(size=vesicle.mesh.vertices.shape)
    positions = vesicle.mesh.vertices + 25 * jitter
    force = TriangleHeightForce(vesicle.mesh, vesicle.min_height, vesicle.epsilon)

    def energy(scale):
        return Mesh(scale * positions, vesicle.mesh.triangles).energy(force)

    step = 1e-5
    expected = -(energy(1 + step) - energy(1 - step)) / (2 * step)
    assert expected > 10 * KBT
    assert heights_virial(vesicle, positions) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("integrator", "friction"), [("langevin", 1e-3), ("brownian", 1e-2)])
def test_two_modes_are_one_where_bending_is_much_stiffer_than_the_mesh(integrator, friction):
    from two_modes import two_mode_autocorrelation

    l, num_vertices = 30, 252
    omega = theory.mode_frequency(l, 20 * KBT, 50.0, num_vertices, 1000.0)
    memory = 1 / omega if integrator == "langevin" else friction / omega**2
    times = np.linspace(0, 3 * memory, 40)
    found = two_mode_autocorrelation(times, l, num_vertices, friction, integrator)
    if integrator == "langevin":
        expected = theory.langevin_autocorrelation(times, omega, friction)
    else:
        expected = theory.brownian_autocorrelation(times, omega, friction)
    assert found[0] == pytest.approx(1)
    assert np.abs(found - expected).max() < 1e-3


def test_fits_of_meshes_find_what_spectra_were_made_with():
    from mesh_corrections import fit_meshes, fit_shear

    random = np.random.default_rng(7)
    spectra = []
    for num_vertices, rigidity in ((492, 20.0), (1002, 20.0), (1002, 40.0), (1962, 10.0)):
        l = np.arange(2, 16)
        n = l * (l + 1)
        left = 0.97 * rigidity - 3 / (4 * np.pi) * np.log(num_vertices**0.5 / l)
        stiffness = left * n * (n - 2) / (1 + 2.5 * n / num_vertices)
        stiffness = stiffness + 0.15 * num_vertices * 3 * (n - 2) / (3 * n - 2)
        error = 0.02 * rigidity * n * (n - 2) / stiffness
        ratio = rigidity * n * (n - 2) / stiffness + error * random.normal(size=len(l))
        spectra.append((num_vertices, rigidity, l, ratio, error))
    (a, c, y), errors, quality = fit_meshes(spectra)
    assert (np.abs(np.array([a, c, y]) - (0.97, 2.5, 0.15)) < 4 * errors).all()
    assert errors[0] < 0.03 and errors[2] < 0.02
    assert 0.5 < quality < 1.6
    num_vertices, rigidity, l, ratio, error = (
        value[:5] if np.ndim(value) else value for value in spectra[1]
    )
    young, young_error = fit_shear(num_vertices, rigidity, l, ratio, error, 2.5)
    assert abs(young - 0.15) < 4 * young_error < 0.15


def test_mean_shapes_are_no_fluctuation_and_powers_come_back():
    from fig06e_random import exponent, power

    random = np.random.default_rng(11)
    shape = random.normal(size=16)
    runs = [{"fit": 0.5 * random.normal(size=(4000, 16)) + shape} for _ in range(3)]
    for run in runs:
        assert power(run, 3, still=False) == pytest.approx(0.25, abs=0.02)
        assert power(run, 3) == pytest.approx(0.25 + np.mean(shape[9:] ** 2), abs=0.05)
    x = np.array([252, 492, 1002, 1962])
    found, error = exponent(x, 3.1 * x**0.7, 0.03 * 3.1 * x**0.7)
    assert found == pytest.approx(0.7)
    assert error == pytest.approx(0.03 / np.sqrt(np.sum((np.log(x) - np.log(x).mean()) ** 2)))


def test_a_run_that_breaks_down_is_made_again_with_half_of_its_step():
    from fluctuations import relax

    found = relax(162, 0.037, "verlet", 0.0, 2, 0.3, 120.0, time_step=30.0, seed=1)
    # 2.7 ps is the bound of the vesicle; with fifteen or so runs of this length may last.
    assert found["time_step"] in (15.0, 7.5)
    assert found["interval"] == pytest.approx(120, abs=8)
    assert found["temperature"] == pytest.approx(300, abs=100)
    assert np.isfinite(found["fit"]).all()
    # A usual step stays as it is.
    assert relax(162, 0.037, "verlet", 0.0, 2, 0.1, 120.0, 1.5, seed=1)["time_step"] == 1.5
