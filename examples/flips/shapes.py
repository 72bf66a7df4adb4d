"""Shapes of vesicles whose reduced volume is ramped down, beside the axisymmetric theory.

Starts are spheroids, prolate or oblate, of reduced volume 0.9. The volume of each is ramped down
to ν, where the branch of least energy may be another one. A run is hot at first: at 1500 K, where
the rigidity κ is 4 kBT, a shape that flows finds its way over the barriers between branches. Then
it is cooled to 1 K, and its energy minimised, so that what is left is the energy of the shape.

Without fluctuations a mesh makes use of its triangles: Jülicher's Σ c²/a of a curved strip is
smaller the longer the triangles are along it, and a zigzag, whose angles cancel at each vertex,
costs nothing. So on cooling the triangles become harder, Ξ = 0.33 to 0.5, which leaves no long
ones, and a potential of the dihedral angles, K (1 − cos φ)² with K = 2 κ, that curvatures as small
as those of the shapes hardly feel, takes zigzags away. The energy reported is that of bending
alone.

"deviation" is relative to the axisymmetric shape (`axisymmetric.py`) on the branch that was found,
"above" to that of least energy, both at the mesh's own ν and in per cent. "crossing" is the share
of vertices whose inner side is not inside the surface, or is so twice: nothing keeps distant parts
of a surface from passing through each other.
"""

import sys
from pathlib import Path

import numpy as np
import openmm
from axisymmetric import RANGES, contour
from fluid_run import MAX_DEGREE, RADIUS, RIGIDITY
from openmm import unit
from openmmhelfrich import Mesh, MonteCarloBondFlip, Vesicle
from openmmhelfrich.vesicle import KBT
from reports import Report
from scipy.optimize import brentq

VERSION = 1
START = 0.9
HOT, COLD = 1500.0, 1.0  # K
SOFT, HARD = 0.33, 0.5  # Ξ, hot and cold
DIHEDRALS = 2 * RIGIDITY  # kBT at 300 K
HOT_STEP, COOL_STEP = 0.8, 1.2  # ps at N = 1002

# Where oblates are no minimum any more: here ramps to smaller volumes rest.
REST = 0.5

RAMP, HOLD, COOL = 5.0, 4.0, 12.0  # τ_2
INCREMENTS = 60

# Distance of the middle of the surface from that of the volume, R0; 0 for prolates and oblates.
LOPSIDED = 0.05


def spheroid(num_vertices, kind, reduced_volume, seed):
    """A random sphere stretched or flattened, with the area of the sphere of 1000 nm.

    Parameters
    ----------
    num_vertices : int
    kind : str
        "prolate" or "oblate".
    reduced_volume : float
        Its ν.
    seed : int
        Of the mesh.
    """
    sphere = Mesh.random_sphere(num_vertices, RADIUS, seed)
    low, high = (1, 20) if kind == "prolate" else (0.05, 1)

    def stretched(factor):
        return sphere.scaled((1, 1, factor))

    factor = brentq(lambda by: stretched(by).reduced_volume - reduced_volume, low, high)
    mesh = stretched(factor)
    return mesh.scaled((4 * np.pi * RADIUS**2 / mesh.area) ** 0.5)


def shape_of(num_vertices, start, reduced_volume, flips, seed, share=1.0):
    """The shape that a vesicle has after the ramp, cold.

    Parameters
    ----------
    num_vertices : int
    start : str
        "prolate" or "oblate".
    reduced_volume : float
        ν at the end of the ramp.
    flips : bool
        Whether bonds flip, 0.1 attempts for each edge every ten steps.
    seed : int
        Of mesh, velocities, noise and flips.
    share : float
        Factor on all times.

    Returns
    -------
    dict
        "vertices", shape (num_vertices, 3), nm; "triangles"; "bending" and "heights", energies in
        kBT at 300 K; "failed", why the run ended early, or "".
    """
    mesh = spheroid(num_vertices, start, START, seed)
    flow = {"attemptsPerEdge": 0.1, "maxDegree": MAX_DEGREE, "randomNumberSeed": seed}
    vesicle = Vesicle(
        mesh,
        rigidity=RIGIDITY * KBT,
        softness=SOFT,
        reduced_volume=START,
        dihedral_stiffness=DIHEDRALS * KBT,
        flips=flow if flips else None,
    )
    scale = (1002 / num_vertices) ** 0.5
    friction = 2 * np.pi / vesicle.tau_2
    integrator = openmm.LangevinMiddleIntegrator(HOT, friction, HOT_STEP * scale)
    integrator.setRandomNumberSeed(seed)
    simulation = vesicle.simulation(integrator, "Helfrich")
    # The ends of the spheroid have flat triangles.
    simulation.minimizeEnergy(maxIterations=200)
    simulation.context.setVelocitiesToTemperature(HOT, seed)
    failed = ""
    try:
        deflate(simulation, vesicle, reduced_volume, share)
        cool(simulation, vesicle, flips, share, COOL_STEP * scale)
    except openmm.OpenMMException as error:
        failed = str(error)
    energies = vesicle.energies(simulation.context) if not failed else {}
    last = Mesh.from_context(simulation.context, vesicle.placement.forces["bending"])
    return {
        "vertices": last.vertices,
        "triangles": last.triangles,
        "bending": energies.get("bending", np.nan) / KBT,
        "heights": energies.get("heights", np.nan) / KBT,
        "failed": failed,
    }


def run_for(simulation, vesicle, periods):
    """Time steps of so many τ_2."""
    step = simulation.integrator.getStepSize().value_in_unit(unit.picosecond)
    simulation.step(max(1, round(periods * vesicle.tau_2 / step)))


def deflate(simulation, vesicle, reduced_volume, share):
    """Ramp the target volume down, with a rest on the way to small ones, and hold it."""
    sphere = vesicle.volume / vesicle.reduced_volume
    ends = [REST, reduced_volume] if reduced_volume < REST else [reduced_volume]
    now = START
    for end in ends:
        for volume in np.linspace(now, end, INCREMENTS + 1)[1:]:
            force = vesicle.placement.forces["volume"]
            force.setTarget(volume * sphere)
            force.updateParametersInContext(simulation.context)
            run_for(simulation, vesicle, share * RAMP / INCREMENTS)
        run_for(simulation, vesicle, share * HOLD)
        now = end


def cool(simulation, vesicle, flips, share, time_step):
    """Cool down, with harder triangles from step to step, and minimise the energy."""
    context, integrator = simulation.context, simulation.integrator
    integrator.setStepSize(time_step)
    heights = vesicle.placement.heights
    for increment, temperature in enumerate(np.geomspace(HOT, COLD, INCREMENTS)):
        hardness = min(1, 1.5 * increment / INCREMENTS)
        heights.setMinHeight(vesicle.mesh.min_height(SOFT + hardness * (HARD - SOFT)))
        heights.updateParametersInContext(context)
        integrator.setTemperature(temperature)
        if flips:
            context.setParameter(MonteCarloBondFlip.Temperature(), temperature)
        run_for(simulation, vesicle, share * COOL / INCREMENTS)
    simulation.minimizeEnergy(tolerance=0.01)


def branch_of(mesh):
    """The branch that a shape is on: "prolate", "oblate" or "stomatocyte"."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas, middles = np.linalg.norm(normals, axis=1), corners.mean(axis=1)
    surface = areas @ middles / areas.sum()
    away = corners - surface
    volumes = np.einsum("ij,ij->i", away[:, 0], np.cross(away[:, 1], away[:, 2]))
    offset = volumes @ away.sum(axis=1) / 4 / volumes.sum()
    if np.linalg.norm(offset) > LOPSIDED * (areas.sum() / 8 / np.pi) ** 0.5:
        return "stomatocyte"
    small, middle, large = np.sqrt(np.linalg.eigvalsh(np.cov(middles.T, aweights=areas)))
    return "prolate" if large - middle > middle - small else "oblate"


def crossing(mesh):
    """Share of vertices with other than one turn of the surface around what lies just inside."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.zeros_like(mesh.vertices)
    for corner in mesh.triangles.T:
        np.add.at(inward, corner, -normals)
    depth = 0.2 * (mesh.area / mesh.num_triangles) ** 0.5
    points = mesh.vertices + depth * inward / np.linalg.norm(inward, axis=1)[:, None]
    wrong = 0
    for point in points:
        a, b, c = np.moveaxis(corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        dot = np.einsum
        above = dot("ij,ij->i", a, np.cross(b, c))
        below = la * lb * lc + dot("ij,ij->i", a, b) * lc
        below += dot("ij,ij->i", b, c) * la + dot("ij,ij->i", c, a) * lb
        turns = 2 * np.arctan2(above, below).sum() / (4 * np.pi)
        wrong += abs(turns - 1) > 0.5
    return wrong / mesh.num_vertices


def reference(branch, reduced_volume):
    """E / 8πκ of a branch, or NaN where it does not go."""
    low, high = RANGES[branch]
    if not low <= reduced_volume <= high:
        return np.nan
    return contour(branch, reduced_volume).energy


def row_of(point, run):
    """One row of the table, of a run."""
    about = (
        point["num_vertices"],
        point["reduced_volume"],
        point["start"],
        "flips" if point["flips"] else "fixed",
        point["seed"],
    )
    if run["failed"]:
        return (*about, "failed", *[""] * 6)
    mesh = Mesh(run["vertices"], run["triangles"])
    branch, volume = branch_of(mesh), round(mesh.reduced_volume, 5)
    energy = run["bending"] / (8 * np.pi * RIGIDITY)
    own = reference(branch, volume)
    least = np.nanmin([reference(each, volume) for each in RANGES])
    deviation, above = (100 * (energy / each - 1) for each in (own, least))
    found = (volume, energy, own, deviation, above, crossing(mesh))
    return (*about, branch, *map(float, found))


def points_of(quick):
    """Arguments of all runs."""
    if quick:
        return [
            {
                "num_vertices": 252,
                "start": "oblate",
                "reduced_volume": 0.8,
                "flips": flips,
                "seed": 1,
                "share": 0.5,
            }
            for flips in (True, False)
        ]
    # Large meshes take long: one start for each ν.
    small = [
        (1002, start, volume) for volume in (0.8, 0.59, 0.3) for start in ("prolate", "oblate")
    ]
    large = [(2502, "oblate", 0.3), (2502, "prolate", 0.59), (2502, "prolate", 0.8)]
    runs = [(*each, flips) for flips in (True, False) for each in small]
    names = ("num_vertices", "start", "reduced_volume", "flips")
    return [
        dict(zip(names, each, strict=True), seed=1)
        for each in runs + [(*each, True) for each in large]
    ]


def main():
    report = Report("shapes", __doc__, add_arguments)
    found = []
    for point in points_of(report.quick):
        found += [(point, run) for run in report.runs(shape_of, [point], VERSION)]
    names = "N ν start bonds seed branch ν_mesh E/8πκ reference deviation above crossing"
    rows = [row_of(point, run) for point, run in found]
    report.table(names.split(), rows)
    if report.options.picture:
        draw(rows, report.options.picture)
    if report.options.meshes:
        smallest = min(point["num_vertices"] for point, _ in found)
        few = [each for each in found if each[0]["num_vertices"] == smallest]
        draw_shapes(few, report.options.meshes)


def add_arguments(parser):
    parser.add_argument("--picture", type=Path, help="PNG of the energies to draw")
    parser.add_argument("--meshes", type=Path, help="PNG of the meshes to draw")


COLOURS = {"prolate": "C0", "oblate": "C1", "stomatocyte": "C2"}


def draw(rows, path):
    """Energies on the reference's lines, starts side by side: filled with flips, open without."""
    import matplotlib.pyplot as plt

    page, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for branch, (low, high) in RANGES.items():
        volumes = np.arange(low, high, 0.01)
        energies = [contour(branch, float(volume)).energy for volume in volumes]
        axes.plot(volumes, energies, color=COLOURS[branch], lw=1, label=f"{branch}, theory")
    drawn = set()
    for row in rows:
        num_vertices, _, start, bonds, _, branch, volume, energy, *_ = row
        if branch != "failed":
            label = f"N = {num_vertices}, {bonds}, start {start}"
            marker, aside = ("^", -0.008) if start == "prolate" else ("s", 0.008)
            axes.plot(
                volume + aside, energy, marker, color=COLOURS[branch],
                mfc=COLOURS[branch] if bonds == "flips" else "white", ls="", mec="black",
                ms=5 if num_vertices < 2000 else 8, mew=0.7,
                label=None if label in drawn else label,
            )  # fmt: skip
            drawn.add(label)
    axes.set(xlabel="ν", ylabel="E / 8πκ", xlim=(0.2, 1), ylim=(0.95, 3))
    axes.legend(fontsize=6)
    page.savefig(path, dpi=110)


def draw_shapes(found, path):
    """The meshes, side by side."""
    sys.path.append(str(Path(__file__).resolve().parents[1] / "paper"))
    from _snapshots import along_axes, draw_meshes

    panels = []
    for point, run in found:
        bonds = "flips" if point["flips"] else "fixed"
        title = f"N = {point['num_vertices']}, ν = {point['reduced_volume']:g}, "
        mesh = along_axes(Mesh(run["vertices"], run["triangles"]))
        panels.append((f"{title}{bonds}, start {point['start']}", mesh, None))
    draw_meshes(path, panels, 6 if len(panels) > 6 else len(panels), size=260)


if __name__ == "__main__":
    main()
