"""The radius of a membrane tube and the force that pulls it, beside √(κ/2σ) and 2π √(2κσ).

A tube of length L has the energy

    E = 2π r L (κ / 2r² + σ),

which is least at r = √(κ/2σ); dE/dL there is f = 2π √(2κσ) (Derényi, Jülicher and Prost,
doi:10.1103/PhysRevLett.88.238101). The tube spans its periodic box along z. It begins with another
radius, and BendingForce and SurfaceAreaForce are minimized together. With E_A = kA (A − A0)² / 2A0
the tension is σ = dE_A/dA = kA (A/A0 − 1). A0 is half of the area that is expected, so that σ
changes little with A, and what it is in the end is what the radius is compared with. Nothing tells
the minimization what the radius ought to be. Vertices begin on a lattice, or "jitter" edges away
from it in any direction, so that the tube has no symmetry to keep; triangle heights keep such
triangles whole, and cost nothing in the end.

The force is f = (dE/dε_zz) / L of a homogeneous strain along the tube, that of the positions and of
the box, found by a central difference of energies, and by `virial`. "radius" is that of
the cylinder of the same area, A / 2πL; "spread" is how far vertices are from one cylinder.
"""

import numpy as np
from membranes import KBT, box_of, context_of, positions_of, strain_derivative
from openmm import LocalEnergyMinimizer
from openmmhelfrich import BendingForce, Mesh, SurfaceAreaForce, TriangleHeightForce, virial
from reports import Report

VERSION = 2
RADIUS = 20.0  # nm, what σ is chosen for
RIGIDITY = 20 * KBT
ASPECT = 3.0  # length over radius
SOFTNESS = 0.5  # Ξ


def relaxed(n_around, scheme, start, jitter):
    """Radius, tension and force of a tube after minimization.

    Parameters
    ----------
    n_around : int
        Vertices round the tube; rings are as far apart as equal edges need.
    scheme : str
        Of `BendingForce`.
    start : float
        Radius at first, over that which is expected.
    jitter : float
        Standard deviation of the displacements at first, in edges.

    Returns
    -------
    dict of float
        Lengths in nm, energies in kJ/mol.
    """
    length = ASPECT * RADIUS
    step = 2 * np.pi * RADIUS / n_around * np.sqrt(0.75)
    mesh = Mesh.tube(n_around, 2 * round(length / step / 2), start * RADIUS, length, periodic=True)
    edge = 2 * np.pi * RADIUS / n_around
    jump = jitter * edge * np.random.default_rng(n_around).normal(size=mesh.vertices.shape)
    mesh = Mesh(mesh.vertices + jump, mesh.triangles, mesh.box)
    tension = RIGIDITY / (2 * RADIUS**2)
    area = SurfaceAreaForce(mesh, tension, np.pi * RADIUS * length)
    bending = BendingForce(mesh, RIGIDITY, scheme=getattr(BendingForce, scheme))
    heights = TriangleHeightForce(mesh, SOFTNESS**0.5 * np.sqrt(0.75) * edge, 4 * KBT)
    context = context_of(mesh, [bending, area, heights])
    LocalEnergyMinimizer.minimize(context, 1e-6, 20000)
    final = Mesh(positions_of(context), mesh.triangles, box_of(context))
    found = {
        "radius": final.area / (2 * np.pi * length),
        "tension": tension * (final.area / area.getTarget() - 1),
        "force": strain_derivative(context, 2) / length,
        "spread": spread(final.vertices),
    }
    found["virial"] = virial(context)[2, 2] / length
    return found


def spread(vertices):
    """Standard deviation of the distance from the axis, nm."""
    return float(np.linalg.norm((vertices - vertices.mean(axis=0))[:, :2], axis=1).std())


def main():
    report = Report("tube", __doc__, folder="surfaces")
    sizes = (16, 24) if report.quick else (16, 24, 36, 54)
    cases = (("Julicher", 0.8, 0.0), ("Julicher", 1.25, 0.1), ("GompperKroll", 0.8, 0.0))
    points = [
        {"n_around": n, "scheme": scheme, "start": start, "jitter": jitter}
        for scheme, start, jitter in cases
        for n in sizes
    ]
    rows = []
    for point, run in zip(points, report.runs(relaxed, points, VERSION), strict=True):
        radius = np.sqrt(RIGIDITY / (2 * run["tension"]))
        force = 2 * np.pi * np.sqrt(2 * RIGIDITY * run["tension"])
        rows.append(
            (
                *point.values(),
                run["radius"],
                100 * (run["radius"] / radius - 1),
                run["force"],
                100 * (run["force"] / force - 1),
                run["spread"] / run["radius"],
                run["virial"],
            )
        )
    columns = (
        "n_around scheme start jitter radius deviation_% force deviation_% spread virial_force"
    )
    report.table(columns.split(), rows)


if __name__ == "__main__":
    main()
