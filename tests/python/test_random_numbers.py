"""The random numbers of the platform Helfrich, as its time steps take them."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from openmmhelfrich import _core
from scipy import stats

GROUP = 192  # the first half of a group and its second half are pairs of Box and Muller
COUNT = 8000 * GROUP


class Stream(ctypes.Structure):
    _fields_ = (
        ("key", ctypes.c_uint32 * 2),
        ("draws", ctypes.c_uint64),
    )


def draw(count: int, seed: int = 1, stream: int = 0, number: int = 0) -> np.ndarray:
    """The normals of one draw: a time step of count / 3 particles."""
    normals = np.empty(count)
    state = Stream((seed, stream), number)
    pointer = normals.ctypes.data_as(ctypes.c_void_p)
    status = _core.library().Helfrich_Random_normals(
        ctypes.byref(state), ctypes.c_int64(count), pointer
    )
    assert status == 0 and state.draws == number + 1
    return normals


@pytest.fixture(scope="module")
def normals() -> np.ndarray:
    return draw(COUNT)


def assert_uncorrelated(one: np.ndarray, other: np.ndarray) -> None:
    for power in (1, 2):
        a, b = one**power, other**power
        assert abs(np.corrcoef(a, b)[0, 1]) < 5 / np.sqrt(a.size)


def test_the_beginning_is_that_of_the_whole():
    np.testing.assert_array_equal(draw(1000), draw(COUNT)[:1000])


def test_moments(normals):
    """Of order k, with the standard error √((μ₂ₖ − μₖ²) / n)."""
    moments = {k: stats.norm.moment(k) for k in range(1, 17)}
    for k in range(1, 9):
        error = np.sqrt((moments[2 * k] - moments[k] ** 2) / COUNT)
        assert abs((normals**k).mean() - moments[k]) < 5 * error, k


def test_kolmogorov_and_smirnov(normals):
    assert stats.kstest(normals, "norm").pvalue > 1e-4
    # Each half of the groups alone, and the squared radii of the pairs, which are exponential.
    groups = normals.reshape(-1, 2, GROUP // 2)
    for half in (0, 1):
        assert stats.kstest(groups[:, half].ravel(), "norm").pvalue > 1e-4
    radii = (groups**2).sum(axis=1).ravel() / 2
    assert stats.kstest(radii, "expon").pvalue > 1e-4


def test_angles_of_pairs_are_uniform(normals):
    x, y = normals.reshape(-1, 2, GROUP // 2).transpose(1, 0, 2)
    counts, _ = np.histogram(np.arctan2(y, x), bins=720, range=(-np.pi, np.pi))
    assert stats.chisquare(counts).pvalue > 1e-4


def test_tails():
    """Beyond 4 and 4.9 standard deviations, on either side, over many draws."""
    values = np.concatenate([draw(COUNT, number=k) for k in range(16)])
    for limit in (4.0, 4.9):
        for count in (np.count_nonzero(values > limit), np.count_nonzero(values < -limit)):
            expected = values.size * stats.norm.sf(limit)
            assert abs(count - expected) < 5 * np.sqrt(expected)
    assert 5 < np.abs(values).max() < 8.5


def test_neighbours_are_independent(normals):
    """Components of a particle, and particles near and far."""
    for lag in (1, 2, 3, 4, 8, 16, GROUP // 2, GROUP, 3 * 1002):
        assert_uncorrelated(normals[lag:], normals[:-lag])
    x, y, z = normals.reshape(-1, 3).T
    for one, other in ((x, y), (y, z), (z, x)):
        assert_uncorrelated(one, other)


@pytest.mark.parametrize(
    "other",
    [{"number": 1}, {"number": 2}, {"number": 1 << 32}, {"seed": 2}, {"stream": 1}],
    ids=str,
)
def test_draws_seeds_and_streams_are_independent(normals, other):
    assert_uncorrelated(normals, draw(COUNT, **other))


def test_one_component_over_time():
    """The sequence that one particle sees, its correlation with itself, and its distribution."""
    steps = np.array([draw(30, number=k) for k in range(20_000)])
    for component in (0, 7):
        series = steps[:, component]
        assert stats.kstest(series, "norm").pvalue > 1e-4
        for lag in (1, 2, 10):
            assert_uncorrelated(series[lag:], series[:-lag])


def test_joint_distribution_of_successive_steps(normals):
    """Quantiles of a component now against those in the next step: all cells equally full."""
    cells = [
        np.minimum((stats.norm.cdf(values) * 32).astype(int), 31)
        for values in (normals, draw(COUNT, number=1))
    ]
    counts = np.bincount(cells[0] * 32 + cells[1], minlength=1024)
    assert stats.chisquare(counts).pvalue > 1e-4
