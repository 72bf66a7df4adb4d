"""A disk that closes into a vesicle, or does not: the line tension at which it must.

**Caps.** A disk of radius R has the area πR² and the border 2πR. Bent into a spherical cap that is
the part x of a closed sphere (area kept, so the sphere has the radius R/2), its border has the
length 2πR √(1 − x), and

    E(x) = 4π κ' x + 2π γR √(1 − x),    κ' = 2κ + κ_G

(Helfrich, doi:10.1016/0375-9601(74)90899-8; Fromherz, doi:10.1016/0009-2614(83)87083-3). The sphere
has less energy than the disk for γR > 2κ', but E(x) is concave: between the two lies a barrier at
x* = 1 − (γR / 4κ')², as high as E(x*) − E(0) = 4π κ' (1 − γR / 4κ')². It is gone, and the flat disk
unstable, at

    γR = 4κ' = 4 (2κ + κ_G).

**Any shape.** The disk may bend otherwise than a cap, and does. To second order in the slope f(ρ) =
dh/dρ the energy at constant area, where the surface has the tension −γ/R that balances the border,
is

    F = π ∫ [κ (f' + f/ρ)² − (γ/R) f²] ρ dρ + π κ_G f(R)²,

so f = J₁(kρ) with k² = γ/(κR), and at the border κ (f' + f/ρ) + κ_G f/R = 0. With z = kR the disk
is unstable from the lowest root of

    z J₀(z) / J₁(z) = −κ_G/κ,    γR = κ z²

on. (A cap, f ∝ ρ, gives the value above from the same F: an upper bound.) It is 5.783 κ, not 8 κ,
for κ_G = 0; 3.390 κ, not 4 κ, for κ_G = −κ; 1.840 κ, not 2 κ, for κ_G = −1.5 κ; and tends to the
value of caps for κ_G → −2κ, where both go to zero.

Two measurements. "modes": the curvature of the energy of a mesh of n rings along f = J₁, at
constant area, is zero at a γR that is found from energies alone, without any dynamics; it tends to
the theory as 1/n, since a border vertex has no bending energy. "runs": disks that begin as caps,
x = 0.02, are let go at 3 K, at several γR in units of that of their own mesh; they end flat, or
closed but for a hole that the vertices of the border fill. A potential of the dihedral angles,
κ (1 − cos φ)², is added there: where the angles at a vertex cancel, Jülicher's curvature is zero
however they fold, and a negative κ_G then gains from folds at the border.
(At κ_G = −1.5 κ that is not enough: the border ruffles.)
"""

import numpy as np
import openmm
from membranes import KBT, context_of, positions_of
from openmmhelfrich import (
    BendingForce,
    DihedralForce,
    EdgeTensionForce,
    GaussianCurvatureForce,
    Mesh,
    MonteCarloBondFlip,
    SurfaceAreaForce,
    TriangleHeightForce,
)
from openmmhelfrich.analysis import vertex_quantities
from reports import Report
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq
from scipy.special import j0, j1

VERSION = 1
RIGIDITY = 20 * KBT
EDGE = 10.0  # nm
COLD = 3.0  # K
SOFTNESS = 0.2  # Ξ
TIME_STEP, FRICTION = 0.2, 0.02  # ps, 1/ps
FRAMES = 50
CLOSED = 0.7  # x


def threshold(gaussian):
    """γR/κ from which on a flat disk is unstable.

    Parameters
    ----------
    gaussian : float
        κ_G/κ, above −2 and at most 0.
    """
    first_zero = 2.404825557695773
    if gaussian == 0:
        return first_zero**2
    return brentq(lambda z: z * j0(z) / j1(z) + gaussian, 1e-6, first_zero) ** 2


def cap(n, share):
    """The mesh of a disk bent into a cap that is a share x of a sphere, area kept.

    Every ring stays a circle and keeps the area inside of it: ρ² = 2 r² (1 − cos θ).
    """
    disk = Mesh.disk(n, n * EDGE)
    radius = n * EDGE / (2 * share**0.5)
    flat = np.linalg.norm(disk.vertices, axis=1)
    polar = 2 * np.arcsin(flat / (2 * radius))
    scale = np.divide(radius * np.sin(polar), flat, out=np.ones_like(flat), where=flat > 0)
    vertices = disk.vertices * scale[:, np.newaxis]
    vertices[:, 2] = radius * (1 - np.cos(polar))
    return Mesh(vertices, disk.triangles)


def bent(n, gaussian, amplitude=0.03):
    """The mesh of a disk with the slope of the unstable mode, J₁(kρ), area kept everywhere.

    Parameters
    ----------
    n : int
        Rings.
    gaussian : float
        κ_G/κ.
    amplitude : float
        Of the slope; F is its second order.
    """
    disk = Mesh.disk(n, n * EDGE)
    arc = np.linspace(0, n * EDGE, 20001)
    slope = 2 * amplitude * j1(threshold(gaussian) ** 0.5 * arc / arc[-1])
    height = cumulative_trapezoid(slope, arc, initial=0)
    # A ring moves inward by as much area as there is too much inside of it.
    excess = cumulative_trapezoid(slope**2 / 2 * arc, arc, initial=0)
    flat = np.linalg.norm(disk.vertices, axis=1)
    shrink = 1 - np.interp(flat, arc, excess) / np.where(flat > 0, flat, 1) ** 2
    vertices = disk.vertices * shrink[:, np.newaxis]
    vertices[:, 2] = np.interp(flat, arc, height)
    return Mesh(vertices, disk.triangles)


def terms_of(mesh, flat):
    """Bending energy over κ, integral of Gaussian curvature, and length of the border over R.

    By numpy alone; the mesh is scaled to the area of the flat one.
    """
    mesh = mesh.scaled((flat.area / mesh.area) ** 0.5)
    found = vertex_quantities(mesh, mesh)
    bending = np.nansum(found.julicher**2 / found.barycentric_area) / 2
    corners = mesh.corner_positions
    sides = np.roll(corners, -1, axis=1) - corners
    angles = np.arctan2(
        np.linalg.norm(np.cross(sides, -np.roll(sides, 1, axis=1)), axis=-1),
        (sides * -np.roll(sides, 1, axis=1)).sum(axis=-1),
    )
    deficit = 2 * np.pi - np.bincount(mesh.triangles.ravel(), angles.ravel())
    (border,) = mesh.border_loops
    inner = np.setdiff1d(np.arange(mesh.num_vertices), border)
    loop = mesh.vertices[border]
    length = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()
    return bending, deficit[inner].sum(), length / (len(border) / 6 * EDGE)


def unstable_from(n, gaussian):
    """γR/κ at which the energies of a mesh have no curvature, along J₁ and along caps."""
    flat = Mesh.disk(n, n * EDGE)
    start = terms_of(flat, flat)
    found = {}
    for name, mesh in (("mode", bent(n, gaussian)), ("cap", cap(n, 1e-4))):
        bending, curvature, length = terms_of(mesh, flat)
        found[name] = (bending + gaussian * curvature) / (start[2] - length)
    return found


def let_go(n, gaussian, tension, seed, duration):
    """What becomes of a disk that begins as a cap, x = 0.02.

    Parameters
    ----------
    n : int
        Rings.
    gaussian : float
        κ_G/κ.
    tension : float
        γR/κ.
    seed : int
    duration : float
        ps.

    Returns
    -------
    dict
        "share", x from the length of the border, over time.
    """
    radius = n * EDGE
    mesh = cap(n, 0.02)
    height = mesh.min_height(SOFTNESS)
    forces = [
        BendingForce(mesh, RIGIDITY),
        SurfaceAreaForce(mesh, 2000 * RIGIDITY / radius**2, mesh.area),
        TriangleHeightForce(mesh, height, 0.4 * KBT),
        GaussianCurvatureForce(mesh, gaussian * RIGIDITY),
        EdgeTensionForce(mesh, tension * RIGIDITY / radius),
        DihedralForce(mesh, RIGIDITY),
    ]
    flips = MonteCarloBondFlip(mesh, COLD, 10, 0.1)
    flips.setRandomNumberSeed(seed)
    integrator = openmm.LangevinMiddleIntegrator(COLD, FRICTION, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    context = context_of(mesh, [*forces, flips], integrator)
    context.setVelocitiesToTemperature(COLD, seed)
    (border,) = mesh.border_loops
    shares = []
    for _ in range(FRAMES):
        integrator.step(round(duration / TIME_STEP / FRAMES))
        loop = positions_of(context)[border]
        length = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()
        shares.append(1 - (length / (2 * np.pi * radius)) ** 2)
    return {"share": np.array(shares)}


def main():
    report = Report("closing", __doc__, folder="surfaces")
    sizes = (8, 16) if report.quick else (8, 16, 32, 64)
    rows = []
    for gaussian in (0.0, -1.0, -1.5):
        points = [{"n": n, "gaussian": gaussian} for n in sizes]
        for point, run in zip(points, report.runs(unstable_from, points, VERSION), strict=True):
            wanted, caps = threshold(gaussian), 4 * (2 + gaussian)
            rows.append((*point.values(), run["mode"], wanted, run["cap"], caps))
    report.table(["n", "κ_G/κ", "γR/κ", "theory", "caps", "theory_of_caps"], rows, "_modes")
    n, duration = (6, 4000.0) if report.quick else (8, 20000.0)
    seeds = (1,) if report.quick else (1, 2)
    rows = []
    for gaussian in (0.0, -1.0):
        exact = unstable_from(n, gaussian)["mode"]
        for factor in (0.7, 1.5) if report.quick else (0.8, 0.9, 1.1, 1.2):
            points = [
                {"n": n, "gaussian": gaussian, "tension": factor * exact}
                | {"seed": seed, "duration": duration}
                for seed in seeds
            ]
            ends = [run["share"][-1] for run in report.runs(let_go, points, VERSION)]
            closed = sum(end > CLOSED for end in ends)
            rows.append((n, gaussian, factor, factor * exact, *ends, closed))
    columns = ["n", "κ_G/κ", "over_threshold", "γR/κ", *(f"x_{seed}" for seed in seeds), "closed"]
    report.table(columns, rows, "_runs")


if __name__ == "__main__":
    main()
