"""A bead that a membrane wraps by adhesion, from w R² = 2κ on.

A membrane without tension that covers a bead up to the polar angle α bends there with
4πκ (1 − cos α) and gains w · 2πR² (1 − cos α); around the contact it continues as a catenoid,
c = R sin² α, which costs nothing. Both go with 1 − cos α, so the bead is wrapped wholly or not at
all: at

    w R² = 2κ

(Deserno, doi:10.1103/PhysRevE.69.031903). R is where the membrane lies, the radius of the bead and
the `distance` D of ParticleSurfaceForce, whose attraction ends at a gap of three times that. So the
catenoid gains too, as it leaves the bead by s²/R: on a width of about √(RD) along the contact,
whose length is 2πR sin α. With that

    E = 4πκ (1 − ŵ) (1 − cos α) − 4πκ ŵ k √(D/R) sin α,    ŵ = w R² / 2κ

the contact opens continuously, at cot α = (1 − ŵ) / ŵ k √(D/R), and is at α = 90° where ŵ = 1,
whatever D is.

"energies": meshes are laid on the shape of theory at angles of 30° … 90°; of bending and of what
adhesion gains, the parts that go with 1 − cos α and with sin α are fitted. "transition" is the
ratio of those with 1 − cos α; "k" of the gain; "by_two" where 45° and 80° have the same energy.
There is no core in these, into which the chords of the shape would dip.

"relaxed": the energy is minimised from the shapes of theory at 60° and 85°, which the membrane is
free to leave. A line tension γ keeps the border from ruffling; it pulls at the membrane with γ over
the border's radius, which moves the transition up by about 1 %. α is by the area of triangles at a
gap below 1.1 D, which the catenoid has as far as √(0.1 DR) from the contact.
"""

import numpy as np
import openmm
from membranes import KBT, context_of, energy_of, positions_of
from openmmhelfrich import (
    BendingForce,
    EdgeTensionForce,
    Mesh,
    ParticleSurfaceForce,
    TriangleAreaForce,
    TriangleHeightForce,
)
from openmmhelfrich.analysis import triangle_areas
from reports import Report

VERSION = 8
RIGIDITY = 20 * KBT
CONTACT = 20.0  # R, nm
ANGLES = np.radians([30, 45, 60, 70, 80, 90])
SOFTNESS = 0.2  # Ξ
AREA_MODULUS = 20.0  # kJ/mol/nm²
LINE = 0.06 * RIGIDITY / CONTACT  # γ, kJ/mol/nm
ROUNDS = 6


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


def with_bead(mesh, adhesion, extra=(), distance=2.0, core=KBT):
    """A Context of a mesh and a bead at the origin, its last particle.

    Parameters
    ----------
    adhesion : float
        ŵ, w in 2κ/R².
    distance : float
        D, nm.
    core : float
        ε, kJ/mol.
    """
    bead = ParticleSurfaceForce(
        mesh,
        [mesh.num_vertices],
        distance,
        core,
        adhesion=adhesion * 2 * RIGIDITY / CONTACT**2,
        radius=CONTACT - distance,
        attraction=ParticleSurfaceForce.LennardJones,
    )
    bead.setForceGroup(1)
    area = TriangleAreaForce(mesh, AREA_MODULUS, mesh.area / len(mesh.triangles))
    area.setForceGroup(2)
    return context_of(
        mesh,
        [BendingForce(mesh, RIGIDITY), area, bead, *extra],
        others=np.zeros((1, 3)),
    )


def energies(edge, distance):
    """The transition, ŵ, and what it is made of, in 4πκ."""
    values = []
    for angle in ANGLES:
        context = with_bead(partly_wrapped(edge, angle, 3.0), 1.0, distance=distance, core=0.0)
        values.append((energy_of(context, {0}), -energy_of(context, {1})))
    bending, gain = np.transpose(values) / (4 * np.pi * RIGIDITY)
    parts = np.transpose([1 - np.cos(ANGLES), np.sin(ANGLES)])
    (covered, bent), (sticking, tail) = (
        np.linalg.lstsq(parts, each, rcond=None)[0] for each in (bending, gain)
    )
    return {
        "bending": covered,
        "bending_sin": bent,
        "gain": sticking,
        "k": tail / np.sqrt(distance / CONTACT),
        "by_two": (bending[4] - bending[1]) / (gain[4] - gain[1]),
        "transition": covered / sticking,
    }


def relaxed(edge, distance, adhesion, start):
    """α, degrees, after a minimisation from the shape of theory at the angle `start`, degrees."""
    mesh = partly_wrapped(edge, np.radians(start), 2.0)
    heights = TriangleHeightForce(mesh, mesh.min_height(SOFTNESS), 0.4 * KBT)
    context = with_bead(mesh, adhesion, (heights, EdgeTensionForce(mesh, LINE)), distance=distance)
    for _ in range(ROUNDS):
        openmm.LocalEnergyMinimizer.minimize(context, 1e-4, 1000)
    *vertices, bead = positions_of(context)
    corners = np.array(vertices)[mesh.triangles]
    gaps = np.linalg.norm(corners.mean(axis=1) - bead, axis=1) - CONTACT + distance
    touching = triangle_areas(vertices, mesh)[gaps < 1.1 * distance].sum()
    angles = np.linspace(0, np.pi, 1001)
    near = 1 - np.cos(angles) + np.sin(angles) * np.sqrt(0.1 * distance / CONTACT)
    rising = slice(near.argmax() + 1)
    share = touching / (2 * np.pi * CONTACT**2)
    return {"alpha": np.degrees(np.interp(share, near[rising], angles[rising]))}


def main():
    report = Report("wrapping", __doc__, folder="surfaces")
    sizes = [(3.0, 2.0)] if report.quick else [(3.0, 2.0), (2.0, 2.0), (1.0, 2.0), (1.0, 1.0)]
    sizes += [] if report.quick else [(0.5, 1.0), (0.5, 0.5)]
    points = [{"edge": edge, "distance": distance} for edge, distance in sizes]
    found = report.runs(energies, points, VERSION)
    rows = [(*point.values(), *run.values()) for point, run in zip(points, found, strict=True)]
    report.table(["edge", "D", *found[0]], rows, "_energies")
    factors = (0.8, 1.3) if report.quick else (0.8, 0.9, 1.0, 1.1, 1.2)
    rows = []
    for adhesion in factors:
        point = {"edge": 3.0 if report.quick else 2.5, "distance": 2.0, "adhesion": adhesion}
        points = [point | {"start": start} for start in (60.0, 85.0)]
        runs = report.runs(relaxed, points, VERSION)
        rows.append((*point.values(), *(run["alpha"] for run in runs)))
    report.table(["edge", "D", "wR²/2κ", "from_60", "from_85"], rows, "_relaxed")
    means = [np.mean(row[3:]) for row in rows]
    print(f"half is covered at wR²/2κ = {np.interp(90, means, factors):.3f}")


if __name__ == "__main__":
    main()
