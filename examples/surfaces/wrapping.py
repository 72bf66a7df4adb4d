"""A bead that a membrane wraps by adhesion, from w R² = 2κ on.

A membrane without tension that covers a bead up to the polar angle α bends there with
4πκ (1 − cos α) and gains w · 2πR² (1 − cos α); around the contact it continues as a catenoid,
c = R sin² α, which costs nothing. Both go with 1 − cos α, so the bead is wrapped wholly or not at
all: at

    w R² = 2κ

(Deserno, doi:10.1103/PhysRevE.69.031903). R is where the membrane lies, the radius of the bead and
the `distance` of ParticleSurfaceForce, whose attraction ends at three times that: what the catenoid
gains near the contact moves the transition down, the less the shorter the distance. The membrane is
a disk with a free border, which therefore has no tension; its area is kept.

"energies": meshes are laid on the shape of theory at two angles, and w is found at which the energy
is the same for both. "runs": at 3 K, with bond flips, from α = 60°, the contact shrinks below the
transition and grows above. "share" is the part of the bead that is covered.
"""

import numpy as np
import openmm
from membranes import KBT, context_of, energy_of, positions_of
from openmmhelfrich import (
    BendingForce,
    Mesh,
    MonteCarloBondFlip,
    ParticleSurfaceForce,
    SurfaceAreaForce,
    TriangleHeightForce,
)
from reports import Report

VERSION = 1
RIGIDITY = 20 * KBT
BEAD, DISTANCE = 18.0, 2.0  # nm
CONTACT = BEAD + DISTANCE
EDGE = 2.5  # nm, of the runs
COLD = 3.0  # K
SOFTNESS = 0.2  # Ξ
TIME_STEP, FRICTION = 0.02, 0.05  # ps, 1/ps
FRAMES = 40


def partly_wrapped(edge, angle, area):
    """A disk that covers a bead at the origin up to an angle, and leaves it as a catenoid.

    Parameters
    ----------
    edge : float
        nm.
    angle : float
        α, radians, up to π/2.
    area : float
        Of the disk, in that of the bead's sphere of contact.

    Returns
    -------
    Mesh
    """
    radius = np.sqrt(4 * area) * CONTACT
    disk = Mesh.disk(round(radius / edge), radius)
    polar = np.linspace(0, angle, 4001)
    neck = CONTACT * np.sin(angle) ** 2
    # From the contact outward; squares, because r begins near to the neck where α is near π/2.
    depth = np.linspace(0, np.sqrt(1.2 * radius), 20001)[1:] ** 2
    r = np.concatenate([CONTACT * np.sin(polar), CONTACT * np.sin(angle) + depth])
    covered = 2 * np.pi * CONTACT**2 * (1 - np.cos(polar))
    outer = r[len(polar) - 1 :]
    middle = (outer[1:] + outer[:-1]) / 2
    rise = np.cumsum(np.diff(outer) * neck / np.sqrt(middle**2 - neck**2))
    sweep = np.cumsum(np.diff(outer) * 2 * np.pi * middle**2 / np.sqrt(middle**2 - neck**2))
    z = np.concatenate([-CONTACT * np.cos(polar), -CONTACT * np.cos(angle) + rise])
    inside = np.concatenate([covered, covered[-1] + sweep])
    flat = np.linalg.norm(disk.vertices, axis=1)
    scale = np.interp(np.pi * flat**2, inside, r) / np.where(flat > 0, flat, 1)
    vertices = disk.vertices * scale[:, np.newaxis]
    vertices[:, 2] = np.interp(np.pi * flat**2, inside, z)
    return Mesh(vertices, disk.triangles)


def with_bead(mesh, adhesion, extra=(), integrator=None):
    """A Context of a mesh and a bead at the origin, its last particle.

    Parameters
    ----------
    adhesion : float
        w, in 2κ/R².
    """
    strength = adhesion * 2 * RIGIDITY / CONTACT**2
    bead = ParticleSurfaceForce(
        mesh, [mesh.num_vertices], DISTANCE, KBT, strength, BEAD, ParticleSurfaceForce.LennardJones
    )
    bead.setForceGroup(1)
    area = SurfaceAreaForce(mesh, 500 * RIGIDITY / CONTACT**2, mesh.area)
    return context_of(
        mesh,
        [BendingForce(mesh, RIGIDITY), area, bead, *extra],
        integrator,
        others=np.zeros((1, 3)),
    )


def energies(edge):
    """The w, in 2κ/R², at which 45° and 80° have the same energy, and their bending over theory."""
    found = {}
    values = []
    for degrees in (45, 80):
        mesh = partly_wrapped(edge, np.radians(degrees), 3.0)
        context = with_bead(mesh, 1.0)
        bending, gain = energy_of(context, {0}), energy_of(context, {1})
        found[f"bending_{degrees}"] = bending / (
            4 * np.pi * RIGIDITY * (1 - np.cos(np.radians(degrees)))
        )
        values.append((bending, gain))
    (bending, gain), (more_bending, more_gain) = values
    return found | {"transition": (more_bending - bending) / (gain - more_gain)}


def let_go(edge, adhesion, seed, duration):
    """The share of the bead that is covered, over time, of a run from α = 60°."""
    mesh = partly_wrapped(edge, np.radians(60), 2.0)
    heights = TriangleHeightForce(mesh, mesh.min_height(SOFTNESS), 0.4 * KBT)
    flips = MonteCarloBondFlip(mesh, COLD, 10, 0.1)
    flips.setRandomNumberSeed(seed)
    integrator = openmm.LangevinMiddleIntegrator(COLD, FRICTION, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    context = with_bead(mesh, adhesion, (heights, flips), integrator)
    openmm.LocalEnergyMinimizer.minimize(context, 10.0, 20)
    context.setVelocitiesToTemperature(COLD, seed)
    shares = []
    for _ in range(FRAMES):
        integrator.step(round(duration / TIME_STEP / FRAMES))
        *vertices, bead = positions_of(context)
        now = flips.getTrianglesInContext(context)
        corners = np.array(vertices)[now]
        areas = np.linalg.norm(np.cross(*(corners[:, 1:] - corners[:, :1]).swapaxes(0, 1)), axis=1)
        touching = np.linalg.norm(corners.mean(axis=1) - bead, axis=1) < BEAD + 1.5 * DISTANCE
        shares.append(areas[touching].sum() / 2 / (4 * np.pi * CONTACT**2))
    return {"share": np.array(shares)}


def main():
    report = Report("wrapping", __doc__, folder="surfaces")
    edges = (3.0,) if report.quick else (3.0, 2.0, 1.5)
    points = [{"edge": edge} for edge in edges]
    found = report.runs(energies, points, VERSION)
    columns = ["edge", *found[0]]
    rows = [(*point.values(), *run.values()) for point, run in zip(points, found, strict=True)]
    report.table(columns, rows, "_energies")
    duration = 10.0 if report.quick else 2000.0
    factors = (0.7, 1.4) if report.quick else (0.8, 0.9, 1.1, 1.2)
    seeds = (1,) if report.quick else (1, 2, 3)
    rows = []
    for factor in factors:
        points = [
            {"edge": EDGE, "adhesion": factor, "seed": seed, "duration": duration} for seed in seeds
        ]
        runs = report.runs(let_go, points, VERSION)
        rows.append((EDGE, factor, *(run["share"][-1] for run in runs)))
    report.table(["edge", "wR²/2κ", *(f"share_{seed}" for seed in seeds)], rows, "_runs")


if __name__ == "__main__":
    main()
