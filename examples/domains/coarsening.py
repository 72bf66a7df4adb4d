"""Two components of a vesicle that were mixed come apart: domains coarsen, nothing gets lost.

301 of the 1002 vertices of a vesicle, chosen at random, are of a second kind; all bend alike. A
`MonteCarloDomainSwap` lets neighbours exchange what they are, while flips and Langevin dynamics
move the membrane at 300 K. The tension γ of the line is in kT by the spacing l of vertices, with
l² = 2 A / (√3 N). On a rigid triangular lattice every pair of unlike neighbours costs γ l / 2, the
2 J of an Ising model, which demixes where J > kT ln 3 / 4, that is γ l > ln 3 kT, at equal parts.
Domains of this size bud at about γ l = 11 kT.

Time is counted in sweeps, attempts to exchange by edge. Domains are connected sets of vertices of
the second kind on the triangles of that moment. Where diffusion through the membrane feeds large
domains on small ones, the line goes as t^(−1/3) in the end: I. M. Lifshitz and V. V. Slyozov,
J. Phys. Chem. Solids 19, 35 (1961), doi:10.1016/0022-3697(61)90054-3.
"""

import sys
from pathlib import Path

import numpy as np
import openmm
from openmmhelfrich import LineTensionForce, Mesh, MonteCarloDomainSwap, Vesicle
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

sys.path.append(str(Path(__file__).resolve().parents[1] / "surfaces"))
from membranes import KBT, TEMPERATURE, energy_of, positions_of
from reports import Report

VERSION = 2
VERTICES, SHARE = 1002, 0.3
RADIUS = 1000.0  # nm
CASES = {"mixed": (0.5, 10), "weak": (2.0, 16), "strong": (3.0, 16)}
"""γ l, kT, and the last frame of each."""
WINDOWS = ((4, 128), (128, 4096))
"""Sweeps from and to which exponents are fitted."""
SWEEPS_PER_STEP = 0.1
TIME_STEP, FRICTION = 0.2, 0.01  # ps, 1/ps


def spacing(mesh):
    """l, nm."""
    return np.sqrt(2 / np.sqrt(3) * mesh.area / mesh.num_vertices)


def domain_sizes(triangles, kinds):
    """Vertices in each connected set of kind 1, the largest first.

    Parameters
    ----------
    triangles : ndarray
        Shape (num_triangles, 3).
    kinds : array_like
        0 or 1, shape (num_vertices,).
    """
    kinds = np.asarray(kinds)
    pairs = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    pairs = pairs[kinds[pairs].all(axis=1)]
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(kinds),) * 2)
    labels = connected_components(graph, directed=False)[1]
    return np.sort(np.unique(labels[kinds == 1], return_counts=True)[1])[::-1]


def coarsen(tension, seed, vertices, last):
    """Frames of a vesicle whose kinds were mixed at random.

    Parameters
    ----------
    tension : float
        γ l, kT.
    seed : int
    vertices : int
    last : int
        Frames are after 2^0, 2^1, … 2^last sweeps, and one is before.

    Returns
    -------
    dict
        By frame: "sweeps", "domains", "largest" as a share of the second kind, "line" in l,
        "kinds", "positions" and "triangles".
    """
    mesh = Mesh.random_sphere(vertices, RADIUS, seed=seed)
    count = round(SHARE * vertices)
    kinds = np.random.default_rng(seed).permutation(np.arange(vertices) < count).astype(int)
    flips = {"frequency": 10, "attemptsPerEdge": 0.1, "randomNumberSeed": seed}
    vesicle = Vesicle(mesh, volume_modulus=0, flips=flips)
    length = spacing(mesh)
    line = LineTensionForce(mesh, tension * KBT / length, kinds)
    line.setForceGroup(1)
    swaps = MonteCarloDomainSwap(mesh, TEMPERATURE, 10, 10 * SWEEPS_PER_STEP)
    swaps.setRandomNumberSeed(seed)
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    system = vesicle.system()
    system.addForce(line)
    system.addForce(swaps)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform, {"Threads": "1"})
    context.setPositions(mesh.vertices)
    context.setVelocitiesToTemperature(TEMPERATURE, seed)

    frames, done = [], 0
    for sweeps in (0, *(2**power for power in range(last + 1))):
        steps = round(sweeps / SWEEPS_PER_STEP)
        integrator.step(steps - done)
        done = steps
        triangles = np.array(line.getTrianglesInContext(context))
        kinds = np.array(line.getDomainsInContext(context))
        sizes = domain_sizes(triangles, kinds)
        frames.append(
            {
                "sweeps": sweeps,
                "domains": len(sizes),
                "largest": sizes[0] / count,
                "line": energy_of(context, {1}) / (tension * KBT),
                "kinds": kinds,
                "positions": positions_of(context),
                "triangles": triangles,
            }
        )
    return {name: np.array([frame[name] for frame in frames]) for name in frames[0]}


def exponent(sweeps, lines):
    """Slope of the logarithm of the line over that of time, and its standard error over runs.

    Parameters
    ----------
    sweeps : array_like
        Shape (frames,).
    lines : array_like
        Shape (runs, frames).
    """
    slopes = [np.polyfit(np.log(sweeps), np.log(line), 1)[0] for line in lines]
    return np.mean(slopes), np.std(slopes, ddof=1) / np.sqrt(len(slopes))


def main():
    report = Report("coarsening", __doc__, folder="domains")
    vertices, seeds = (252, (1, 2)) if report.quick else (VERTICES, (1, 2, 3))
    rows, exponents = [], []
    for name, (tension, last) in CASES.items():
        last = last - 4 if report.quick else last
        points = [
            {"tension": tension, "seed": seed, "vertices": vertices, "last": last} for seed in seeds
        ]
        runs = report.runs(coarsen, points, VERSION)
        for point, run in zip(points, runs, strict=True):
            for frame, sweeps in enumerate(run["sweeps"]):
                cells = [run[each][frame] for each in ("domains", "largest", "line")]
                second = run["kinds"][frame].sum()
                rows.append((name, tension, point["seed"], sweeps, *cells, second))
        sweeps = runs[0]["sweeps"]
        for first, final in () if name == "mixed" else WINDOWS:
            used = (first <= sweeps) & (sweeps <= final)
            slope, error = exponent(sweeps[used], [run["line"][used] for run in runs])
            exponents.append((name, tension, first, final, float(slope), float(error)))
    columns = ["name", "γl/kT", "seed", "sweeps", "domains", "largest", "line/l", "second_kind"]
    report.table(columns, rows)
    report.table(["name", "γl/kT", "from", "to", "exponent", "error"], exponents, "_exponents")


if __name__ == "__main__":
    main()
