"""Surfaces and particles that do not pass through each other, and what happens without contact.

After every frame `analysis.crossings`, which knows nothing of the forces, counts the pairs of
triangles that pass through each other.

"ramp": a sphere whose reduced volume ν goes from 1 to 0.1, as in the deflations of the paper.
"pressed": two vesicles that forces push towards each other. "pore": a vesicle of R = 100 nm and
ν = 0.8 that a force drives through the hole, of radius 70 nm less D, of a torus whose vertices have
mass 0; "width" is its largest radius about the axis before, and "passed" its lowest vertex at the
end above the middle of the pore, nm.

"adhesion": energy by area over w, less 1, of a flat sheet that touches a particle so large that it
is flat too, and energy of a bead that touches a plane over the integral in the header of
ParticleSurfaceForce. "crowd": free particles of 50 amu at one density inside of a vesicle and
around it, in a periodic box of the side "box" or, without one, within a hull of 1.5 R whose
vertices have mass 0; Verlet. Vertices of the vesicle have 2000 amu, as hundreds of particles touch
each. "through" of them are on the other side of the vesicle at the end, by rays, "escaped" out of
the hull; "moved" is the median of their displacement, nm; "drift" is the change of the total
energy, and "scatter" its largest, over the kinetic energy.
"""

import numpy as np
import openmm
from membranes import KBT, TEMPERATURE, context_of, energy_of, positions_of
from openmm import unit
from openmmhelfrich import (
    BendingForce,
    EnclosedVolumeForce,
    Mesh,
    ParticleSurfaceForce,
    SurfaceAreaForce,
    SurfaceRepulsionForce,
    TriangleHeightForce,
)
from openmmhelfrich.analysis import crossings
from reports import Report

VERSION = 1
RIGIDITY = 20 * KBT
RADIUS = 100.0  # nm
DISTANCE = 0.2  # D, in the mean edge
TIME_STEP, FRICTION = 0.1, 0.05  # ps, 1/ps
CROWD_STEP, HEAVY = 0.2, 2000.0  # ps, amu
HOLE, THICK = 70.0, 40.0  # nm, of the pore


def vesicle(n):
    """A sphere of 10 n² + 2 vertices."""
    return Mesh.icosphere(n, RADIUS)


def side_by_side(first, second):
    """One mesh of two."""
    triangles = np.concatenate([first.triangles, second.triangles + first.num_vertices])
    return Mesh(np.concatenate([first.vertices, second.vertices]), triangles)


def elasticity(mesh, offset=0):
    """Forces of one vesicle, the first of which is that of its volume."""
    triangles = mesh.triangles + offset
    volume = EnclosedVolumeForce(triangles, 1.0, mesh.volume)
    volume.setContextParameter("target", "volume")
    area = SurfaceAreaForce(triangles, 1.3, mesh.area)
    heights = TriangleHeightForce(triangles, mesh.min_height(0.33), 4 * KBT)
    return [volume, BendingForce(triangles, RIGIDITY), area, heights]


def repulsion(mesh, edge):
    """That of a mesh with itself, D in the mean edge of its vesicle."""
    return SurfaceRepulsionForce(mesh, DISTANCE * edge, KBT)


def mean_edge(mesh):
    """The mean length of edges, nm."""
    corners = mesh.corner_positions
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()


def started(mesh, forces, seed, friction=FRICTION, held=None):
    """A Context at 300 K; vertices of `held` behind those of `mesh` do not move."""
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, friction, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    others = () if held is None else held.vertices
    context = context_of(mesh, forces, integrator, others=others)
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    return context


def ramp(n, steps, contact, seed):
    """Crossings at ν = 1, 0.95 … 0.1, reached in so many steps for each 0.01 of ν."""
    mesh = vesicle(n)
    forces = elasticity(mesh)
    if contact:
        forces.append(repulsion(mesh, mean_edge(mesh)))
    context = started(mesh, forces, seed)
    found = []
    for reduced in np.arange(100, 9, -1) / 100:
        for part in range(10):
            context.setParameter("volume", mesh.volume * (reduced + 0.001 * (9 - part)))
            context.getIntegrator().step(steps // 10)
        if round(100 * reduced) % 5 == 0:
            found.append(len(crossings(positions_of(context), mesh.triangles)))
    return {"crossings": np.array(found)}


def pressed(n, force, contact, steps, seed):
    """Crossings of two vesicles, in frames of a run, pushed by a force in κ/R on each."""
    one = vesicle(n)
    two = side_by_side(
        one.translated((0, 0, -1.05 * RADIUS)), one.translated((0, 0, 1.05 * RADIUS))
    )
    push = openmm.CustomExternalForce("strength*sign*z")
    push.addGlobalParameter("strength", force * RIGIDITY / RADIUS / one.num_vertices)
    push.addPerParticleParameter("sign")
    for index in range(two.num_vertices):
        push.addParticle(index, [-1.0 if index < one.num_vertices else 1.0])
    forces = [*elasticity(one), *elasticity(one, one.num_vertices), push]
    if contact:
        forces.append(repulsion(two, mean_edge(one)))
    context = started(two, forces, seed)
    context.setParameter("volume", 0.9 * one.volume)
    found = []
    for _ in range(20):
        context.getIntegrator().step(steps // 20)
        found.append(len(crossings(positions_of(context), two.triangles)))
    return {"crossings": np.array(found)}


def pore(n, force, contact, steps, seed):
    """Crossings of a vesicle and a torus, in frames of a run, with a force in κ/R."""
    mesh = vesicle(n).translated((0, 0, -1.5 * RADIUS))
    edge = mean_edge(mesh)
    ring = Mesh.torus(round(2 * np.pi * THICK / edge), HOLE + THICK, THICK)
    both = side_by_side(mesh, ring)
    drive = openmm.CustomExternalForce("-push*z")
    drive.addGlobalParameter("push", 0.0)
    for index in range(mesh.num_vertices):
        drive.addParticle(index)
    forces = [*elasticity(mesh), drive]
    if contact:
        forces.append(repulsion(both, edge))
    context = started(mesh, forces, seed, friction=0.2 * FRICTION, held=ring)
    found = []
    for frame in range(40):
        context.setParameter("volume", mesh.volume * max(0.8, 1 - 0.02 * (frame + 1)))
        if frame == 10:
            context.setParameter("push", force * RIGIDITY / RADIUS / mesh.num_vertices)
        context.getIntegrator().step(steps // 40)
        positions = positions_of(context)
        found.append(len(crossings(positions, both.triangles)))
        if frame < 10:
            width = np.linalg.norm(positions[: mesh.num_vertices, :2], axis=1).max()
        if positions[: mesh.num_vertices, 2].min() > THICK:
            break
    lowest = positions[: mesh.num_vertices, 2].min()
    return {"crossings": np.array(found), "width": width, "passed": lowest}


def adhesion(edge, radius):
    """Energy over theory of a particle that touches a flat sheet of 40 × 40 nm."""
    size, distance = 40.0, 2.0
    across = round(size / edge)
    sheet = Mesh.sheet(across, round(across * 2 / 3**0.5), edge)
    sheet = sheet.translated((*-sheet.vertices.mean(axis=0)[:2], 0))
    force = ParticleSurfaceForce(
        sheet,
        [sheet.num_vertices],
        distance,
        epsilon=0.0,
        adhesion=1.0,
        radius=radius,
        attraction=ParticleSurfaceForce.LennardJones,
    )
    context = context_of(sheet, [force], others=[(0, 0, radius + distance)])
    if radius > 1e3:
        return {"ratio": -energy_of(context) / sheet.area}
    r = np.linspace(0, size / 2, 200001)
    x = (np.hypot(r, radius + distance) - radius) / distance
    y = np.clip(x - 2, 0, 1)
    phi = (2 / x**6 - 1 / x**12) * (1 - y**3 * (10 - 15 * y + 6 * y**2))
    return {"ratio": -energy_of(context) / np.trapezoid(2 * np.pi * r * phi, r)}


def crowd(n, count, duration, seed, box=None):
    """Free particles inside of a vesicle and around it."""
    mesh = vesicle(n)
    random = np.random.default_rng(seed)
    distance = 5.0
    # The middles of triangles are nearer to the centre than their corners.
    margin = distance + mean_edge(mesh) ** 2 / RADIUS / 2
    # The same density on both sides, so the same pressure.
    room = box / 2 if box else 1.5 * RADIUS - margin
    places = random.uniform(-room, room, (4 * count, 3))
    lengths = np.linalg.norm(places, axis=1)
    free = (lengths < RADIUS - margin) | (lengths > RADIUS + distance)
    places = places[free if box else free & (lengths < room)][:count]
    within = np.linalg.norm(places, axis=1) < RADIUS
    both = mesh if box else side_by_side(mesh, mesh.scaled(1.5))
    first = both.num_vertices
    system = openmm.System()
    fixed = first - mesh.num_vertices
    for mass in [HEAVY] * mesh.num_vertices + [0.0] * fixed + [50.0] * count:
        system.addParticle(mass)
    particles = np.arange(first, first + count)
    for force in (*elasticity(mesh), ParticleSurfaceForce(both, particles, distance, KBT)):
        force.setUsesPeriodicBoundaryConditions(bool(box))
        system.addForce(force)
    if box:
        system.setDefaultPeriodicBoxVectors(*(box * np.eye(3)))
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, openmm.VerletIntegrator(CROWD_STEP), platform)
    context.setParameter("volume", mesh.volume)
    context.setPositions(np.concatenate([both.vertices, places]))
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    energies = [energies_of(context)]
    frames = max(1, round(duration / CROWD_STEP / 50))
    for _ in range(frames):
        context.getIntegrator().step(50)
        energies.append(energies_of(context))
    positions = positions_of(context)
    moved, surface = positions[first:], positions[: mesh.num_vertices]
    now = moved - surface.mean(axis=0)
    if box:
        now -= box * np.round(now / box)
    at_end = inside(now, (surface - surface.mean(axis=0))[mesh.triangles])
    kinetic, potential = np.transpose(energies)
    total = (kinetic + potential) / kinetic[0]
    hull = np.inf if box else 1.5 * RADIUS
    return {
        "steps": 50 * frames,
        "within": int(within.sum()),
        "through": int((at_end != within).sum()),
        "escaped": int((np.linalg.norm(moved, axis=1) > hull).sum()),
        "moved": np.median(np.linalg.norm(moved - places, axis=1)),
        "drift": total[-1] - total[0],
        "scatter": abs(total - total[0]).max(),
        "potential": potential.max() / kinetic[0],
    }


def energies_of(context):
    """Kinetic and potential energy, kJ/mol."""
    state = context.getState(energy=True)
    both = state.getKineticEnergy(), state.getPotentialEnergy()
    return [each / unit.kilojoule_per_mole for each in both]


def inside(points, corners):
    """Which points are within a closed surface, by the triangles above each of them."""
    count = np.zeros(len(points), dtype=int)
    order = np.argsort(points[:, 0])
    sorted_x = points[order, 0]
    for a, b, c in corners:
        some = order[
            slice(*np.searchsorted(sorted_x, (min(a[0], b[0], c[0]), max(a[0], b[0], c[0]))))
        ]
        x, y, z = points[some].T
        sides = [
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
            for p, q in ((b, c), (c, a), (a, b))
        ]
        total = sum(sides)
        hit = np.all([side * total > 0 for side in sides], axis=0)
        height = sum(side * p[2] for side, p in zip(sides, (a, b, c), strict=True))
        count[some[hit]] += height[hit] / total[hit] > z[hit]
    return count % 2 == 1


def main():
    report = Report("crossing", __doc__, add_arguments, folder="surfaces")
    quick, only = report.quick, report.options.only
    jobs = {
        "ramp": [{"n": 4, "steps": 50, "seed": 1}]
        if quick
        else [{"n": 7, "steps": 1000, "seed": 1}],
        "pressed": [
            {"n": 3 if quick else 5, "force": force, "steps": 400 if quick else 20000, "seed": 1}
            for force in ((40.0,) if quick else (10.0, 40.0))
        ],
        "pore": [
            {"n": 4 if quick else 5, "force": 60.0, "steps": 400 if quick else 100000, "seed": 1}
        ],
    }
    rows = []
    for name, points in jobs.items():
        if only not in (None, name):
            continue
        points = [point | {"contact": contact} for point in points for contact in (True, False)]
        for point in points:
            for run in report.runs(globals()[name], [point], VERSION):
                frames = run["crossings"]
                rows.append(
                    (
                        *(name, 10 * point["n"] ** 2 + 2, point.get("force", "")),
                        *("yes" if point["contact"] else "no", len(frames)),
                        *(
                            int((frames > 0).sum()),
                            int(frames.max()),
                            run.get("width", ""),
                            run.get("passed", ""),
                        ),
                    )
                )
    if rows:
        columns = "what N force contact frames crossed most width passed"
        report.table(columns.split(), rows)
    if only in (None, "adhesion"):
        points = [
            {"edge": edge, "radius": radius} for radius in (1e5, 18.0) for edge in (2.0, 1.0, 0.5)
        ]
        rows = []
        for point in points:
            for run in report.runs(adhesion, [point], VERSION):
                rows.append((*point.values(), run["ratio"] - 1))
        report.table(["edge", "radius", "E/theory − 1"], rows, "_adhesion")
    if only in (None, "crowd"):
        sizes = [(10**6, 2e4, 1000.0), (10**4, 7430.0, None)]
        if quick:
            sizes = [(10**4, 100.0, 400.0), (10**4, 100.0, None)]
        rows = []
        for count, duration, box in sizes:
            point = {"n": 7, "count": count, "seed": 1, "duration": duration, "box": box}
            for run in report.runs(crowd, [point], VERSION):
                columns = ["particles", "box", *run]
                rows.append((count, box or "", *run.values()))
        if rows:
            report.table(columns, rows, "_crowd")


def add_arguments(parser):
    parts = ("ramp", "pressed", "pore", "adhesion", "crowd")
    parser.add_argument("--only", choices=parts, help="one part")


if __name__ == "__main__":
    main()
