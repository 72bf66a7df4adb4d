"""Schwarz' P surface without mean curvature, and Gauss–Bonnet on every kind of surface.

A cell of the P surface spans its periodic box in all three directions. It begins on the level
surface cos x + cos y + cos z = 0, or with vertices "jitter" edges away from it, and BendingForce is
minimized. What is left of the mean curvature, "H" (the root of its mean square, times the size of
the cell) is to be nothing, and the area over size² that of the minimal surface, 3 K(1/2) / K(√3/2)
= 2.345107, K being the complete elliptic integral of a modulus; "deviation" falls as 1/n².

Gauss–Bonnet: Σ (2π − angles) over inner vertices and Σ (π − angles) over those of borders are
2π χ, on meshes that are closed, open, periodic, of genus 0 to 3, with jittered vertices. "defect"
is the difference.
"""

import numpy as np
from membranes import KBT, box_of, context_of, energy_of, positions_of
from openmm import LocalEnergyMinimizer
from openmmhelfrich import BendingForce, Mesh, TriangleHeightForce
from openmmhelfrich.analysis import crossings, vertex_quantities
from reports import Report
from scipy.special import ellipk

VERSION = 1
SIZE = 100.0  # nm
RIGIDITY = 20 * KBT
AREA = 3 * ellipk(1 / 4) / ellipk(3 / 4)


def jittered(mesh, jitter, seed=1):
    """The mesh with vertices displaced at random, by a share of the mean edge."""
    edge = np.sqrt(4 / np.sqrt(3) * mesh.area / mesh.num_triangles)
    jump = jitter * edge * np.random.default_rng(seed).normal(size=mesh.vertices.shape)
    return Mesh(mesh.vertices + jump, mesh.triangles, mesh.box)


def relaxed(n, jitter):
    """Mean curvature and area of the P surface before and after minimization."""
    start = jittered(Mesh.schwarz_p(n, SIZE), jitter)
    heights = TriangleHeightForce(start, 0.5 * start.min_height(1.0), 4 * KBT)
    context = context_of(start, [BendingForce(start, RIGIDITY), heights])
    LocalEnergyMinimizer.minimize(context, 1e-7, 20000)
    final = Mesh(positions_of(context), start.triangles, box_of(context))
    found = {"energy": energy_of(context) / KBT, "crossings": len(crossings(final))}
    for name, mesh in (("before", start), ("after", final)):
        quantities = vertex_quantities(mesh, mesh)
        curvature, weight = quantities.mean_curvature(), quantities.barycentric_area
        found[f"H_{name}"] = SIZE * np.sqrt(curvature**2 @ weight / weight.sum())
        found[f"area_{name}"] = mesh.area / SIZE**2
    return found


def defect(mesh):
    """Σ of angle deficits and of turns at borders, less 2π χ."""
    corners = mesh.corner_positions
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    angles = np.arctan2(
        np.linalg.norm(np.cross(ahead, back), axis=-1), np.einsum("tci,tci->tc", ahead, back)
    )
    full = np.full(mesh.num_vertices, 2 * np.pi)
    for loop in mesh.border_loops:
        full[loop] = np.pi
    total = (full - np.bincount(mesh.triangles.ravel(), angles.ravel())).sum()
    return total - 2 * np.pi * mesh.euler_characteristic


def surfaces():
    """Meshes of every kind, by name."""
    sphere = Mesh.icosphere(6, 10.0)
    return {
        "sphere": sphere,
        "sphere with a hole": Mesh(sphere.vertices, sphere.triangles[3:]),
        "disk": Mesh.disk(8, 10.0),
        "sheet": Mesh.sheet(12, 11, 1.0),
        "periodic sheet": Mesh.sheet(12, 11, 1.0, periodic=True),
        "tube": Mesh.tube(12, 9, 2.0, 8.0),
        "periodic tube": Mesh.tube(12, 10, 2.0, 8.0, periodic=True),
        "torus": Mesh.torus(12, 5.0, 2.0),
        "P": Mesh.schwarz_p(6, SIZE),
    }


def main():
    report = Report("minimal", __doc__, folder="surfaces")
    sizes = (3,) if report.quick else (4, 8, 12)
    points = [{"n": n, "jitter": jitter} for jitter in (0.0, 0.05) for n in sizes]
    rows = [
        (*point.values(), *(run[name] for name in NAMES), 100 * (run["area_after"] / AREA - 1))
        for point, run in zip(points, report.runs(relaxed, points, VERSION), strict=True)
    ]
    report.table(["n", "jitter", *NAMES, "deviation_%"], rows)
    rows = [
        (name, mesh.euler_characteristic, mesh.genus, len(mesh.border_loops), defect(mesh))
        for name, mesh in ((name, jittered(mesh, 0.05)) for name, mesh in surfaces().items())
    ]
    report.table(["surface", "χ", "genus", "borders", "defect"], rows, "_gauss_bonnet")


NAMES = ("H_before", "H_after", "area_before", "area_after", "energy", "crossings")


if __name__ == "__main__":
    main()
