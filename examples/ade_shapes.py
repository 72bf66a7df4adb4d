"""Shapes of vesicles with area-difference elasticity, beside axisymmetric theory.

The energy is that of bending and of an `AreaDifferenceForce`, at given area and reduced volume ν:

    E / 8πκ = ∫ (c₁ + c₂)² dA / 16π + π α (Δa − Δa0)²

(L. Miao, U. Seifert, M. Wortis and H.-G. Döbereiner, Phys. Rev. E 49, 5389 (1994),
doi:10.1103/PhysRevE.49.5389). From small to large Δa0 the shape of least energy is a stomatocyte,
an oblate, a prolate, a pear, and one with a bud. α is 10, so that Δa follows Δa0 over this range;
of lipids it is about 1, and buds come at larger Δa0.

A run begins with a prolate, an oblate or two spheres with a wide neck, at ν already, and bonds flip
while it is cooled from 300 K to 1 K; another one begins with the shape of theory itself, at 30 K.
Then the energy is minimised. The shape of least energy among the runs is set beside the one among
the axisymmetric shapes of `flips/axisymmetric.py`, which uses no code of openmmhelfrich, at the
same ν. Two potentials that are not part of E keep the mesh from saving energy where Jülicher's
scheme does not see it: κ (1 − cos φ)² of the dihedral angles keeps zigzags away, and a
`PlaquetteAreaForce` of 3 kBT keeps triangles even, which would stretch across necks.

Shapes that are not their own image in any plane across the axis are "stomatocyte" where Δa < 1,
"budded" where they have a neck narrower than 0.2 R_A, and otherwise "pear". Necks narrower than a
triangle of the mesh have no right energy there.
"""

import sys
from pathlib import Path

import numpy as np
import openmm
import openmm.app
from openmmhelfrich import (
    Mesh,
    MonteCarloBondFlip,
    PlaquetteAreaForce,
    SurfaceRepulsionForce,
    Vesicle,
    analysis,
)
from openmmhelfrich.vesicle import KBT
from scipy.optimize import brentq

sys.path.append(str(Path(__file__).resolve().parent / "flips"))

from axisymmetric import Shapes
from reports import Report

VERSION = 2
RADIUS = 1000.0  # nm, R_A
RIGIDITY = 20 * KBT
ALPHA = 10.0
DIHEDRALS = RIGIDITY
EVEN = 3 * KBT  # of plaquettes
REPULSION = 0.2  # mean edges
HOT, COLD = 300.0, 1.0  # K
SOFT, HARD = 0.33, 0.5  # Ξ, hot and cold
TIME_STEP = 0.4  # ps at N = 1002
PERIODS, INCREMENTS = 6.0, 40  # of cooling: τ_2
# Of runs that begin with the shape of theory.
COOL, SHORT = 30.0, 1.0  # K, τ_2

STARTS = ("prolate", "oblate", "spheres", "theory")
# Distance of the middles of surface and volume, and radius of a neck, in R_A.
LOPSIDED, NARROW = 0.02, 0.2


# --- on a mesh -----------------------------------------------------------------------------------


def start_of(num_vertices, kind, reduced_volume, seed):
    """A mesh of the area 4πR_A² and of a reduced volume: a spheroid, or two spheres with a neck.

    Or the axisymmetric shape of least energy, if the kind is ("theory", Δa0).
    """
    sphere = Mesh.random_sphere(num_vertices, 1.0, seed)
    if kind[0] == "theory":
        mesh = min(axisymmetric_shapes(reduced_volume, kind[1], sphere), key=lambda pair: pair[0])[
            1
        ]
    elif kind == "spheres":
        mesh = _revolved(sphere, *two_spheres(reduced_volume, 0.4))
    else:
        stretched = (lambda by: (1, 1, by)) if kind == "prolate" else (lambda by: (by, by, 1))
        factor = brentq(
            lambda by: sphere.scaled(stretched(by)).reduced_volume - reduced_volume, 1, 20
        )
        mesh = sphere.scaled(stretched(factor))
    return mesh.scaled((4 * np.pi * RADIUS**2 / mesh.area) ** 0.5)


def radii(reduced_volume):
    """Of two spheres that have the area 4π together, and the volume."""
    large = brentq(lambda r: r**3 + (1 - r**2) ** 1.5 - reduced_volume, 0.5**0.5 + 1e-9, 1)
    return large, (1 - large**2) ** 0.5


def two_spheres(reduced_volume, neck):
    """The contour r, z of these spheres; the neck has a share of the radius of the smaller one."""
    large, small = radii(reduced_volume)
    width = neck * small
    one = np.linspace(0, np.pi - np.arcsin(width / large), 200)
    other = np.linspace(np.pi - np.arcsin(width / small), 0, 200)
    top = -large * np.cos(one[-1]) - small * np.cos(other[0])
    r = np.concatenate([large * np.sin(one), small * np.sin(other)])
    return r, np.concatenate([-large * np.cos(one), top + small * np.cos(other)])


def _revolved(sphere, r, z):
    """The unit sphere's mesh on the surface of a contour, by shares of the area from one pole."""
    rings = np.pi * (r[1:] + r[:-1]) * np.hypot(np.diff(r), np.diff(z))
    below = np.concatenate([[0], np.cumsum(rings)]) / rings.sum()
    x, y, height = sphere.vertices.T
    share = (1 + height / np.linalg.norm(sphere.vertices, axis=1)) / 2
    azimuth, out = np.arctan2(y, x), np.interp(share, below, r)
    vertices = np.stack([out * np.cos(azimuth), out * np.sin(azimuth), np.interp(share, below, z)])
    return Mesh(vertices.T, sphere.triangles)


def shape_of(num_vertices, start, reduced_volume, delta_a0, seed=1, repulsion=False):
    """The shape that a vesicle has when it is cold.

    Parameters
    ----------
    num_vertices : int
    start : str
        One of STARTS, or "theory": the axisymmetric shape of least energy.
    reduced_volume, delta_a0 : float
    seed : int
    repulsion : bool
        Whether the surface cannot pass through itself. Its energy does not count.

    Returns
    -------
    dict
        "vertices", nm, and "triangles"; "bending" and "area_difference", energies over 8πκ.
    """
    hot, periods = HOT, PERIODS
    kind = start
    if start == "theory":
        kind, hot, periods = (start, delta_a0), COOL, SHORT
    mesh = start_of(num_vertices, kind, reduced_volume, seed)
    vesicle = Vesicle(
        mesh,
        rigidity=RIGIDITY,
        area_modulus=13,
        volume_modulus=0.4,
        reduced_volume=reduced_volume,
        softness=SOFT,
        dihedral_stiffness=DIHEDRALS,
        area_difference={"alpha": ALPHA, "delta_a0": delta_a0},
        flips={"attemptsPerEdge": 0.1, "maxDegree": 9, "randomNumberSeed": seed},
    )
    step = TIME_STEP * (1002 / num_vertices) ** 0.5
    integrator = openmm.LangevinMiddleIntegrator(hot, 2 * np.pi / vesicle.tau_2, step)
    integrator.setRandomNumberSeed(seed)
    system = vesicle.system()
    system.addForce(PlaquetteAreaForce(mesh, EVEN, mesh.area))
    if repulsion:
        distance = REPULSION * float(analysis.edge_lengths(mesh, mesh).mean())
        system.addForce(SurfaceRepulsionForce(mesh, distance, KBT))
    platform = openmm.Platform.getPlatformByName("Helfrich")
    simulation = openmm.app.Simulation(mesh.topology(), system, integrator, platform)
    simulation.context.setPositions(mesh.vertices)
    simulation.minimizeEnergy(maxIterations=200)
    context, heights = simulation.context, vesicle.placement.heights
    context.setVelocitiesToTemperature(hot, seed)
    for increment, temperature in enumerate(np.geomspace(hot, COLD, INCREMENTS)):
        hardness = min(1, 1.5 * increment / INCREMENTS)
        heights.setMinHeight(mesh.min_height(SOFT + hardness * (HARD - SOFT)))
        heights.updateParametersInContext(context)
        integrator.setTemperature(temperature)
        context.setParameter(MonteCarloBondFlip.Temperature(), temperature)
        simulation.step(round(periods * vesicle.tau_2 / INCREMENTS / step))
    simulation.minimizeEnergy(tolerance=0.01)
    energies = vesicle.energies(context)
    last = vesicle.placement.mesh(context)
    unit = 8 * np.pi * RIGIDITY
    return {
        "vertices": last.vertices,
        "triangles": last.triangles,
        **{name: energies[name] / unit for name in ("bending", "area_difference")},
    }


# --- axisymmetric --------------------------------------------------------------------------------


def amplitudes(kind):
    """First amplitudes of ψ by their n, and whether odd n are used."""
    return {
        "prolate": ({2: 0.6}, 2),
        "oblate": ({2: -0.6}, 2),
        "stomatocyte": ({1: 1.2, 2: -1.0}, 1),
        "pear": ({1: -0.2, 2: 1.0, 3: 1.0}, 1),
    }[kind]


def axisymmetric(kind, reduced_volume, delta_a0, sphere):
    """The axisymmetric minimum that is found from a start of some kind.

    Parameters
    ----------
    kind : str
        Of `amplitudes`.
    reduced_volume, delta_a0 : float
    sphere : Mesh
        Whose triangles the shape gets.

    Returns
    -------
    (float, Mesh) or None
        E / 8πκ and the shape, with R_A = 1; None where no minimum is found: a neck that closes.
    """
    first, every = amplitudes(kind)
    shapes = Shapes(40, every)
    start = np.append([first.get(n, 0.0) for n in shapes.n], 3.2)

    def energy(variables):
        value, gradient = shapes.energy(variables)
        difference, d_difference = shapes.area_difference(variables)
        excess = difference - delta_a0
        value += np.pi * ALPHA * excess**2
        return value, gradient + 2 * np.pi * ALPHA * excess * d_difference

    try:
        variables = shapes.minimum(reduced_volume, start, energy)
    except RuntimeError:
        return None
    contour = shapes.contour(kind, reduced_volume, variables)
    return float(energy(variables)[0]), _revolved(sphere, contour.r, contour.z)


def axisymmetric_shapes(reduced_volume, delta_a0, sphere):
    """Energies and shapes of all minima, with the limit of two spheres that touch.

    Their neck costs nothing; the shape of the limit has one of a third of the smaller one's radius.
    """
    kinds = ("prolate", "oblate", "stomatocyte", "pear")
    found = [axisymmetric(kind, reduced_volume, delta_a0, sphere) for kind in kinds]
    limit = 2 + np.pi * ALPHA * (sum(radii(reduced_volume)) - delta_a0) ** 2
    spheres = _revolved(sphere, *two_spheres(reduced_volume, 1 / 3))
    return [*(each for each in found if each is not None), (float(limit), spheres)]


def least_axisymmetric(reduced_volume, delta_a0):
    """The least energy of all, and what kind of shape has it."""
    shapes = axisymmetric_shapes(reduced_volume, delta_a0, Mesh.icosphere(20, 1.0))
    energy, mesh = min(shapes, key=lambda pair: pair[0])
    return energy, "budded" if mesh is shapes[-1][1] else kind_of(mesh)


# --- what they are -------------------------------------------------------------------------------


def kind_of(mesh):
    """One of "prolate", "oblate", "pear", "budded" and "stomatocyte"."""
    corners = mesh.vertices[mesh.triangles]
    areas, middles = analysis.triangle_areas(mesh, mesh), corners.mean(axis=1)
    middle = areas @ middles / areas.sum()
    # Pyramids from there, with their own middles.
    away = corners - middle
    volumes = np.einsum("ij,ij->i", away[:, 0], np.cross(away[:, 1], away[:, 2]))
    offset = volumes @ away.sum(axis=1) / 4 / volumes.sum()
    spread, axes = np.linalg.eigh(np.cov(middles.T, aweights=areas))
    small, between, large = np.sqrt(spread)
    is_long = large - between > between - small
    radius = (areas.sum() / 4 / np.pi) ** 0.5
    if np.linalg.norm(offset) < LOPSIDED * radius:
        return "prolate" if is_long else "oblate"
    if analysis.area_difference(mesh, mesh) < 1:
        return "stomatocyte"
    return "budded" if neck(mesh.vertices - middle, axes[:, 2]) < NARROW * radius else "pear"


def neck(vertices, axis):
    """Least mean distance from the axis between two places that are wider."""
    along = vertices @ axis
    out = np.linalg.norm(vertices - np.outer(along, axis), axis=1)
    slices = np.array_split(np.argsort(along), max(10, len(vertices) // 24))
    widths = np.array([out[each].mean() for each in slices])
    wider = np.minimum(np.maximum.accumulate(widths), np.maximum.accumulate(widths[::-1])[::-1])
    between = widths < wider
    return widths[between].min() if between.any() else np.inf


def row_of(reduced_volume, delta_a0, runs):
    """One row of the table: the best of the runs beside the theory."""
    energy, best = min((run["bending"] + run["area_difference"], k) for k, run in enumerate(runs))
    mesh = Mesh(runs[best]["vertices"], runs[best]["triangles"])
    expected, kind = least_axisymmetric(round(mesh.reduced_volume, 4), delta_a0)
    found = analysis.area_difference(mesh, mesh)
    deviation = 100 * (energy / expected - 1)
    return (
        reduced_volume,
        delta_a0,
        kind_of(mesh),
        float(found),
        energy,
        kind,
        expected,
        deviation,
    )


def main():
    report = Report("ade_shapes", __doc__, folder="ade")
    num_vertices, volumes, targets = 1002, (0.85, 0.95), (0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4)
    starts = STARTS
    if report.quick:
        num_vertices, volumes, targets, starts = 252, (0.85,), (1.0, 1.1), STARTS[:2]
    rows = []
    for volume in volumes:
        for target in targets:
            points = [
                {
                    "num_vertices": num_vertices,
                    "start": start,
                    "reduced_volume": volume,
                    "delta_a0": target,
                }
                for start in starts
            ]
            runs = report.runs(shape_of, points, VERSION)
            if runs:
                rows.append(row_of(volume, target, runs))
    names = ["ν", "Δa0", "shape", "Δa", "E/8πκ", "theory", "E_theory", "deviation/%"]
    report.table(names, rows)


if __name__ == "__main__":
    main()
