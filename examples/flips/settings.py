"""What is run: lengths, time steps and rates of the runs of `fluid_run.flow`."""

from typing import NamedTuple


class Setting(NamedTuple):
    """Time steps, ps, with flips and without, the flips, and the length of a run with them, τ_2."""

    time_step: float
    fixed_time_step: float
    attempts: float = 0.1
    every: int = 10
    periods: float = 50


SETTINGS = {
    0.037: Setting(0.4, 0.8, periods=25),
    0.15: Setting(1.0, 1.6),
    0.33: Setting(1.6, 2.4),
    0.59: Setting(2.0, 3.0, attempts=1.0),
}
"""By softness Ξ, for 1002 vertices on a sphere of 1000 nm and κ = 20 kBT."""

FIXED_PERIODS = 30
"""Length of one run without flips, τ_2."""

SEEDS_OF_SIZES = {252: 12, 502: 12, 1002: 3, 4002: 12}
"""How many runs compare sizes, by N; of 1002 vertices there are others."""

FRAMES_PER_PERIOD = 4
"""Frames that these runs keep for each τ_2."""


def with_flips(softness, seeds, num_vertices=1002, share=1.0, periods=None):
    """Arguments of `flow` for runs with a share of the usual flips, one for each seed."""
    setting = SETTINGS[softness]
    return [
        {
            "num_vertices": num_vertices,
            "softness": softness,
            "attempts": share * setting.attempts,
            "every": setting.every,
            # The period of the fastest mode goes as 1/√N.
            "time_step": setting.time_step * (1002 / num_vertices) ** 0.5,
            "periods": setting.periods if periods is None else periods,
            "seed": seed,
        }
        for seed in seeds
    ]


def without_flips(softness, seeds, num_vertices=1002, periods=FIXED_PERIODS):
    """Arguments of `flow` for runs of meshes that keep their neighbours, one for each seed."""
    setting = SETTINGS[softness]
    scale = setting.fixed_time_step / setting.time_step
    return [
        point | {"time_step": point["time_step"] * scale}
        for point in with_flips(softness, seeds, num_vertices, 0.0, periods)
    ]


def of_sizes(softness, num_vertices, quick=False):
    """Arguments of `flow` for runs with flips that compare sizes: modes up to √N / 3 and 16."""
    seeds, periods = (2, 3) if quick else (SEEDS_OF_SIZES.get(num_vertices, 12), None)
    points = with_flips(softness, range(1, 1 + seeds), num_vertices, periods=periods)
    more = {"lmax": highest(num_vertices), "frames_per_period": FRAMES_PER_PERIOD}
    return [point | more for point in points]


def highest(num_vertices):
    """The largest l of a mesh of several sizes."""
    return min(16, int(num_vertices**0.5 / 3))
