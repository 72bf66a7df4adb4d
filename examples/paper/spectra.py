"""The runs of Fig. 6, which Supplements 5 and 7 share, and their spectra."""

import itertools
from typing import NamedTuple

from fluctuations import RADIUS, SOFTNESS, VERSION, fluctuate
from openmmhelfrich.analysis import spectrum, theory

FULL = {
    "base": 1002,
    "vertices": (252, 492, 1002, 1962, 4002),
    "rigidities": (10.0, 20.0, 40.0),
    "radii": (500.0, 1000.0, 2000.0),
    "samples": 10,
}
QUICK = {
    "base": 252,
    "vertices": (252,),
    "rigidities": (20.0, 40.0),
    "radii": (500.0, 1000.0),
    "samples": 2,
}
PERIODS, FRAMES_PER_PERIOD = 10, 8
SCHEMES = {"Julicher": "Jülicher", "GompperKrollBarycentric": "GK barycentric"}


class Point(NamedTuple):
    """Parameters of a vesicle: N, κ in kBT, r0 in nm, Ξ and the name of the bending scheme."""

    num_vertices: int
    rigidity: float = 20.0
    radius: float = RADIUS
    softness: float = SOFTNESS[0]
    scheme: str = "Julicher"


def named(point):
    """The parameters as the report writes them."""
    return (
        f"N = {point.num_vertices}, κ = {point.rigidity:g} kBT, r0 = {point.radius:g} nm, "
        f"Ξ = {point.softness:g}, {SCHEMES[point.scheme]}"
    )


def points_of(size):
    """The points that are needed: the base, and each parameter varied alone."""
    base = Point(size["base"])
    varied = {
        "scheme": SCHEMES,
        "radius": size["radii"],
        "num_vertices": size["vertices"],
        "rigidity": size["rigidities"],
        "softness": SOFTNESS,
    }
    points = [base._replace(**{name: value}) for name in varied for value in varied[name]]
    return list(dict.fromkeys([base, *points]))


def arguments_of(point, samples):
    """The arguments of `fluctuate` for the samples of one point."""
    return [
        {
            **point._asdict(),
            # Half of the largest l that the mesh has, l_max = √N: what the paper shows.
            "lmax": int(point.num_vertices**0.5 / 2),
            "periods": PERIODS,
            "frames_per_period": FRAMES_PER_PERIOD,
            "settle_periods": 2,
            "seed": first_seed(point) + seed,
        }
        for seed in range(samples)
    ]


def first_seed(point):
    """Seeds that are others for each N, κ, r0 and scheme, so that all samples are independent.

    In reduced units, which Δt and γ follow, equal seeds mean equal noise: large modes then move
    alike whatever the scheme is. Vesicles of other Ξ have other Δt, which is enough.
    """
    usual = Point(1002)
    return (
        1
        + abs(point.num_vertices - usual.num_vertices)
        + round(1000 * abs(point.rigidity - usual.rigidity))
        + round(13 * abs(point.radius - usual.radius))
        + 7000 * (point.scheme != usual.scheme)
    )


def measure(points, samples, figure):
    """The runs of each point, so many samples of it: {point: [result, …]}."""
    arguments = [one for point in points for one in arguments_of(point, samples)]
    results = iter(figure.sweep(fluctuate, arguments, VERSION))
    return {point: list(itertools.islice(results, samples)) for point in points}


def spectrum_of(runs, name="fit"):
    """The spectrum of all samples of a point."""
    return spectrum([run[name] for run in runs])


def ratio_of(found, point):
    """Modes l = 2 … lmax, ⟨|u_lm|²⟩ over (A17), and its error."""
    l = found.l[2:]
    fluid = theory.fluid_spectrum(l, point.rigidity)
    return l, found.mean[2:] / fluid, found.error[2:] / fluid
