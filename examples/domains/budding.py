"""A domain in a flat membrane that buds, or does not: the line tension at which it must.

**Caps.** A domain of the area πL² has the line 2πL. Bent into a spherical cap that is the part x of
a closed sphere (area kept), the line has the length 2πL √(1 − x), and

    E(x) = 8πκ x + 2π λL √(1 − x):

R. Lipowsky, J. Phys. II 2, 1825 (1992), doi:10.1051/jp2:1992238, where x = (LC/2)² with the
curvature C, and ξ = κ/λ is the invagination length. The bud, x = 1, has less energy than the flat
domain for L > 4ξ, but E(x) is concave: a barrier lies between the two up to L = 8ξ.

**Any shape.** A kink along the line would bend without bound, so slopes are continuous, and the
membrane around the domain takes part. It does so for nothing: a catenoid, of slope f ∝ 1/ρ, has no
mean curvature. To second order in the slope, at constant area of both, the energy of the domain is

    F = π ∫ [κ (f' + f/ρ)² − (λ/L) f²] ρ dρ,

with (f' + f/ρ) = 0 at its line, which the catenoid continues. So f = J₁(kρ) with J₀(kL) = 0, and
the flat domain is unstable from

    λL = 2.4048² κ = 5.783 κ,    L = 5.783 ξ

on; caps, which leave the membrane around them flat, are an upper bound.

Two measurements, on a disk of n rings whose inner n/2 are the domain. λ is the tension of the force
times the length of the line over 2πL, at the start: a line on a mesh goes in zigzag. "modes": from
energies alone, without any dynamics, the λL at which the energy of a mesh has no curvature along f;
it tends to the theory as 1/n². "runs": nearly flat domains are let go at 30 K, κ = 200 kT, with
bonds that flip, at several λL in units of that of their own mesh. They end flat, or as buds, with
an x above 0.6: by then the vertices of the line, as many as at the start, are as near each other as
the TriangleHeightForce lets them.
"""

import sys
from pathlib import Path

import numpy as np
import openmm
from openmmhelfrich import (
    BendingForce,
    DihedralForce,
    LineTensionForce,
    Mesh,
    MonteCarloBondFlip,
    TriangleAreaForce,
    TriangleHeightForce,
)
from scipy.integrate import cumulative_trapezoid
from scipy.special import j1

sys.path.append(str(Path(__file__).resolve().parents[1] / "surfaces"))
from membranes import KBT, context_of, energy_of
from reports import Report

VERSION = 1
FIRST_ZERO = 2.404825557695773
"""Of J₀."""
RIGIDITY = 20 * KBT
EDGE = 10.0  # nm
COLD = 30.0  # K
SOFTNESS = 0.2  # Ξ
TIME_STEP, FRICTION = 0.1, 0.02  # ps, 1/ps
FRAMES = 50
BUD = 0.6  # x


def rings_of(n):
    """The number of the ring of each vertex of a disk of n rings."""
    return np.repeat(np.arange(n + 1), [1, *(6 * np.arange(1, n + 1))])


def domains_of(n):
    """1 for the inner n/2 rings of a disk of n rings, 0 for the others."""
    return (rings_of(n) <= n // 2).astype(int)


def radius_of(n):
    """L, nm: the line is in the middle between two rings."""
    return (n // 2 + 0.5) * EDGE


def bent(n, amplitude):
    """The mesh of a disk with the slope of the unstable mode, areas kept everywhere.

    Parameters
    ----------
    n : int
        Rings.
    amplitude : float
        Of the slope; F is its second order.
    """
    disk = Mesh.disk(n, n * EDGE)
    arc, radius = np.linspace(0, n * EDGE, 20001), radius_of(n)
    inside = 2 * j1(FIRST_ZERO * np.minimum(arc / radius, 1))
    slope = amplitude * inside * np.minimum(1, radius / np.maximum(arc, radius))
    height = cumulative_trapezoid(slope, arc, initial=0)
    # A ring moves inward by as much area as there is too much inside of it.
    excess = cumulative_trapezoid(slope**2 / 2 * arc, arc, initial=0)
    flat = np.linalg.norm(disk.vertices, axis=1)
    shrink = 1 - np.interp(flat, arc, excess) / np.where(flat > 0, flat, 1) ** 2
    vertices = disk.vertices * shrink[:, np.newaxis]
    vertices[:, 2] = np.interp(flat, arc, height)
    return Mesh(vertices, disk.triangles)


def terms_of(n, mesh):
    """Bending energy over κ, and the length of the line, nm."""
    return mesh.energy(BendingForce(mesh, 1)), mesh.energy(LineTensionForce(mesh, 1, domains_of(n)))


def unstable_from(n):
    """λL/κ at which the energy of a mesh has no curvature along the mode."""
    (_, whole), (bending, length) = terms_of(n, bent(n, 0)), terms_of(n, bent(n, 0.03))
    return {"mode": bending / (1 - length / whole) / (2 * np.pi)}


def let_go(n, strength, seed, duration):
    """What becomes of a domain that begins nearly flat.

    Parameters
    ----------
    n : int
        Rings.
    strength : float
        λL/κ.
    seed : int
    duration : float
        ps.

    Returns
    -------
    dict
        "share", x over time.
    """
    mesh = bent(n, 0.2)
    _, whole = terms_of(n, bent(n, 0))
    tension = strength * RIGIDITY * 2 * np.pi / whole
    line = LineTensionForce(mesh, tension, domains_of(n))
    line.setForceGroup(1)
    area = np.pi * (n * EDGE) ** 2 / mesh.num_triangles
    forces = [
        BendingForce(mesh, RIGIDITY),
        line,
        # The domain loses 3 % of its area under λ/L, and flips are still possible.
        TriangleAreaForce(mesh, 200 * RIGIDITY / radius_of(n) ** 2, area),
        TriangleHeightForce(mesh, mesh.min_height(SOFTNESS), RIGIDITY),
        # Against folds, at which angles of a vertex cancel; of fourth order in the angles.
        DihedralForce(mesh, RIGIDITY),
    ]
    flips = MonteCarloBondFlip(mesh, COLD, 5, 0.3)
    flips.setRandomNumberSeed(seed)
    integrator = openmm.LangevinMiddleIntegrator(COLD, FRICTION, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    context = context_of(mesh, [*forces, flips], integrator)
    context.setVelocitiesToTemperature(COLD, seed)
    shares = []
    for _ in range(FRAMES):
        integrator.step(round(duration / TIME_STEP / FRAMES))
        length = energy_of(context, {1}) / tension
        shares.append(1 - (length / whole) ** 2)
    return {"share": np.array(shares)}


def main():
    report = Report("budding", __doc__, folder="domains")
    sizes = (8, 16) if report.quick else (8, 16, 32, 64)
    points = [{"n": n} for n in sizes]
    found = report.runs(unstable_from, points, VERSION)
    rows = [(n, run["mode"], FIRST_ZERO**2) for n, run in zip(sizes, found, strict=True)]
    report.table(["n", "λL/κ", "theory"], rows, "_modes")

    n, duration = (8, 3000.0) if report.quick else (16, 32000.0)
    seeds = (1,) if report.quick else (1, 2)
    exact = unstable_from(n)["mode"]
    rows = []
    for factor in (0.7, 1.6) if report.quick else (0.7, 0.8, 0.9, 1.1, 1.2, 1.4):
        points = [
            {"n": n, "strength": factor * exact, "seed": seed, "duration": duration}
            for seed in seeds
        ]
        ends = [run["share"][-1] for run in report.runs(let_go, points, VERSION)]
        rows.append((n, factor, factor * exact, *ends, sum(end > BUD for end in ends)))
    columns = ["n", "over_threshold", "λL/κ", *(f"x_{seed}" for seed in seeds), "buds"]
    report.table(columns, rows, "_runs")


if __name__ == "__main__":
    main()
