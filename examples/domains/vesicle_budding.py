"""Two domains at the poles of a vesicle bud, or do not: the line tension at which they must.

`lined_shapes.py` has the theory, without any mesh: from the sphere on the lines shrink as λ grows,
up to a spinodal from which on there are only buds. Here it is compared with meshes of n rings
from pole to equator, all triangles of the same area, whose inner m on both sides are domains, each
with the share (m + ½)² / 2n² of the area. Volume is free. As in `budding.py` λ is the tension of
the force times the length of the lines on the sphere over that of circles.

"energies": the spinodal from energies alone. Meshes are put on the contours of the theory, and the
highest −dE/dℓ of bending energy and length is taken. "cold": at a share of the spinodal of the
theory a sphere goes to its least energy, and the opening of its lines is compared, the length over
that at the start; neighbours stay neighbours. "runs": spheres are let go at 5 K, κ = 1200 kT, with
bonds that flip, at shares of the spinodal of the theory, and nearest to it also at 30 K, where
lines that fluctuate pull less. Openings are means over the last fifth; a line that is shorter than
at the spinodal is that of a bud.
"""

import sys
from functools import cache
from pathlib import Path

import numpy as np
import openmm
from openmmhelfrich import (
    BendingForce,
    LineTensionForce,
    Mesh,
    MonteCarloBondFlip,
    TriangleAreaForce,
    TriangleHeightForce,
)
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

sys.path.append(str(Path(__file__).resolve().parents[1] / "surfaces"))
from budding import RIGIDITY, TIME_STEP, rings_of
from lined_shapes import branch
from membranes import context_of, positions_of
from reports import Report

VERSION = 3
SOFTNESS = 0.037  # Ξ
FRICTION = 0.005  # 1/ps
RADIUS = 100.0  # nm
INNER = 5.5 / 13
"""(m + ½) / n."""
FRAMES = 50

branch_of = cache(branch)
"""The theory for a share of the area."""


def share_of(n):
    """α of n rings, as near as it gets."""
    return (round(INNER * n - 0.5) + 0.5) ** 2 / (2 * n**2)


def domains_of(n):
    """1 and 2 for the domains of a mesh of n rings to the equator, 0 for the others."""
    ring = rings_of(n)
    inner = ring <= round(INNER * n - 0.5)
    return np.concatenate([inner, 2 * inner[ring < n]]).astype(int)


def mesh_of(n, variables):
    """A mesh on a shape of `lined_shapes`, with n rings to the equator.

    A ring has the share of the area inside of it that it has on a flat disk.
    """
    disk = Mesh.disk(n, 1.0)
    flat = np.hypot(*disk.vertices[:, :2].T)
    rings = np.round(flat * n).astype(int)
    shares = np.maximum(np.arange(n + 1) / n, 1e-6) ** 2 / 2
    r, z = branch_of(share_of(n)).shapes.points(variables, shares).T
    r[0] = 0
    around = disk.vertices[:, :2] / np.where(flat > 0, flat, 1)[:, np.newaxis]
    upper = np.column_stack([around * r[rings][:, np.newaxis], z[rings]])
    inside = rings < n
    # The other half has the equator's vertices in common, and its own orientation.
    other = np.where(inside, len(flat) + np.cumsum(inside) - 1, np.arange(len(flat)))
    vertices = np.concatenate([upper, upper[inside] * [1, 1, -1]])
    triangles = np.concatenate([disk.triangles, other[disk.triangles][:, ::-1]])
    return Mesh(vertices * RADIUS, triangles)


def line_lengths(positions, triangles, domains):
    """Lengths of the lines around domains 1 and 2, nm.

    A line joins the middles of two sides of a triangle: it is half as long as the third.
    """
    lengths = []
    for which in (1, 2):
        inside = domains[triangles] == which
        mixed = (inside.sum(axis=1) > 0) & (inside.sum(axis=1) < 3)
        odd = inside[mixed] == (inside[mixed].sum(axis=1) == 1)[:, np.newaxis]
        ends = positions[triangles[mixed][~odd].reshape(-1, 2)]
        lengths.append(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum() / 2)
    return np.array(lengths)


def tension_of(n, strength):
    """The force's tension, kJ/mol/nm, for λL/κ."""
    sphere = mesh_of(n, branch_of(share_of(n)).shapes.sphere())
    zigzag = line_lengths(sphere.vertices, sphere.triangles, domains_of(n)).mean()
    share = share_of(n)
    circle = 2 * np.pi * 2 * np.sqrt(share * (1 - share)) * RADIUS
    return strength * RIGIDITY / (2 * np.sqrt(share) * RADIUS) * circle / zigzag


def spinodal_of(n):
    """λL/κ at which the domains of a mesh must bud, from energies alone."""
    states = branch_of(share_of(n))
    some = (states.openings > 0.4) & (states.openings < 0.9)
    energies, lengths = [], []
    for variables in states.variables[some]:
        mesh = mesh_of(n, variables)
        energies.append(mesh.energy(BendingForce(mesh, 1 / (8 * np.pi))))
        lengths.append(line_lengths(mesh.vertices, mesh.triangles, domains_of(n)).mean())
    sphere = mesh_of(n, states.shapes.sphere())
    whole = line_lengths(sphere.vertices, sphere.triangles, domains_of(n)).mean()
    openings = np.array(lengths) / whole
    curve = CubicSpline(openings[::-1], np.array(energies)[::-1])
    # E / 8πκ of the line is λL/κ (r / r of the sphere) √(1 − α) / 2.
    share = share_of(n)
    slope = minimize_scalar(lambda x: curve(x, 1), bounds=(0.5, 0.8), method="bounded").fun
    return {"spinodal": -2 * slope / np.sqrt(1 - share)}


def forces_of(n, mesh, strength):
    """Forces of a vesicle with two domains.

    Parameters
    ----------
    n : int
    mesh : Mesh
    strength : float
        λL/κ.
    """
    size = 2 * np.sqrt(share_of(n)) * RADIUS
    area = 4 * np.pi * RADIUS**2 / mesh.num_triangles
    return [
        BendingForce(mesh, RIGIDITY),
        LineTensionForce(mesh, tension_of(n, strength), domains_of(n)),
        # It leaves 1 % to the tension of the line; stiffer triangles keep shapes from changing.
        TriangleAreaForce(mesh, 200 * RIGIDITY / size**2, area),
        TriangleHeightForce(mesh, mesh.min_height(SOFTNESS), RIGIDITY),
    ]


def openings_of(n, positions, triangles):
    """Lengths of both lines over those on the sphere."""
    sphere = mesh_of(n, branch_of(share_of(n)).shapes.sphere())
    domains = domains_of(n)
    whole = line_lengths(sphere.vertices, sphere.triangles, domains)
    return line_lengths(positions, triangles, domains) / whole


def coldest(n, strength):
    """The openings of least energy, from a sphere on, at λL/κ."""
    mesh = mesh_of(n, branch_of(share_of(n)).shapes.sphere())
    context = context_of(mesh, forces_of(n, mesh, strength))
    openmm.LocalEnergyMinimizer.minimize(context, 1e-6)
    positions = positions_of(context)
    return {
        "openings": openings_of(n, positions, mesh.triangles),
        "area": Mesh(positions, mesh.triangles).area / (4 * np.pi * RADIUS**2),
        "positions": positions,
    }


def let_go(n, strength, temperature, seed, duration):
    """What becomes of a sphere with two domains.

    Parameters
    ----------
    n : int
    strength : float
        λL/κ.
    temperature : float
        K.
    seed : int
    duration : float
        ps.

    Returns
    -------
    dict
        "openings" over time, shape (FRAMES, 2), and the last "positions" and "triangles".
    """
    mesh = mesh_of(n, branch_of(share_of(n)).shapes.sphere())
    flips = MonteCarloBondFlip(mesh, temperature, 5, 0.3)
    flips.setRandomNumberSeed(seed)
    integrator = openmm.LangevinMiddleIntegrator(temperature, FRICTION, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    forces = forces_of(n, mesh, strength)
    context = context_of(mesh, [*forces, flips], integrator)
    context.setVelocitiesToTemperature(temperature, seed)
    openings = []
    for _ in range(FRAMES):
        integrator.step(round(duration / TIME_STEP / FRAMES))
        positions = positions_of(context)
        triangles = np.array(forces[0].getTrianglesInContext(context))
        openings.append(openings_of(n, positions, triangles))
    return {"openings": np.array(openings), "positions": positions, "triangles": triangles}


def main():
    report = Report("vesicle_budding", __doc__, folder="domains")
    rows = []
    for share in (share_of(13),) if report.quick else (share_of(13), 0.15, 0.2):
        states = branch_of(share)
        high, low = states.spinodals()
        rows.append((share, *high, states.crossing(), *low))
    columns = ["α", "spinodal", "its_opening", "equal_energies", "buds_open", "their_opening"]
    report.table(columns, rows, "_theory")

    sizes = (39,) if report.quick else (27, 39, 65)
    found = report.runs(spinodal_of, [{"n": n} for n in sizes], VERSION)
    rows = []
    for n, run in zip(sizes, found, strict=True):
        (theory, _), _ = branch_of(share_of(n)).spinodals()
        rows.append((n, share_of(n), float(run["spinodal"]), theory))
    report.table(["n", "α", "spinodal", "theory"], rows, "_energies")

    rows = []
    for n in (13,) if report.quick else (13, 20):
        states = branch_of(share_of(n))
        (spinodal, _), _ = states.spinodals()
        factors = (0.5, 0.7, 0.8, 0.9, 0.95)
        points = [{"n": n, "strength": factor * spinodal} for factor in factors]
        for factor, run in zip(factors, report.runs(coldest, points, VERSION), strict=True):
            theory = states.opening_at(factor * spinodal)
            mean = run["openings"].mean()
            rows.append(
                (n, factor, *run["openings"], theory, mean / theory - 1, float(run["area"]))
            )
    columns = ["n", "over_spinodal", "opening_1", "opening_2", "theory", "difference", "area"]
    report.table(columns, rows, "_cold")

    n, duration = (13, 6000.0) if report.quick else (20, 16000.0)
    (spinodal, opening), _ = branch_of(share_of(n)).spinodals()
    cases = [(5.0, factor) for factor in (0.7, 0.8, 0.9, 1.1, 1.2, 1.4)] + [
        (30.0, 0.9),
        (30.0, 1.1),
    ]
    seeds = (1,) if report.quick else (1, 2)
    rows = []
    for temperature, factor in [(5.0, 0.7), (5.0, 1.6)] if report.quick else cases:
        strength = factor * spinodal
        theory = branch_of(share_of(n)).opening_at(strength) if factor < 1 else ""
        point = {"n": n, "strength": strength, "temperature": temperature, "duration": duration}
        points = [{**point, "seed": seed} for seed in seeds]
        for seed, run in zip(seeds, report.runs(let_go, points, VERSION), strict=True):
            last = run["openings"][-FRAMES // 5 :].mean(axis=0)
            buds = (last < opening).sum()
            rows.append((n, temperature, factor, seed, *last, theory, buds))
    columns = ["n", "K", "over_spinodal", "seed", "opening_1", "opening_2", "theory", "buds"]
    report.table(columns, rows, "_runs")


if __name__ == "__main__":
    main()
