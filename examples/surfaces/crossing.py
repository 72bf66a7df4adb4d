"""Surfaces and particles that do not pass through each other, and what happens without contact.

After every frame `analysis.crossings`, which knows nothing of the forces, counts the pairs of
triangles that pass through each other.

"ramp": a sphere whose reduced volume ν goes from 1 to 0.1, as in the deflations of the paper.
"pressed": two vesicles that forces push towards each other. "pore": a vesicle of R = 100 nm and
ν = 0.8 that a force drives through the hole, of radius 70 nm less D, of a torus whose vertices have
mass 0; "width" is its largest radius about the axis before, and "passed" its lowest vertex at the
end above the middle of the pore, nm.

"adhesion": energy by area over w of a flat sheet that touches a particle so large that it is flat
too, and energy of a bead that touches a plane over the integral in the header of
ParticleSurfaceForce. "crowd": free particles inside and outside of a vesicle under the Verlet
integrator. "through" of them are on the other side at the end, by rays, and "drift" is the change
of the total energy over the kinetic energy.
"""

import time

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
            width = np.linalg.norm(positions[: mesh.num_vertices, :2], axis=1).max()
            context.setParameter("push", force * RIGIDITY / RADIUS / mesh.num_vertices)
        context.getIntegrator().step(steps // 40)
        positions = positions_of(context)
        found.append(len(crossings(positions, both.triangles)))
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


def crowd(n, count, duration, seed, seconds):
    """Particles of 50 amu, half of them inside, within 0.5 … 1.5 R, for a time or `seconds`."""
    mesh = vesicle(n)
    random = np.random.default_rng(seed)
    distance = 5.0
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, np.newaxis]
    # None of them in the shell where chords of the sphere and the repulsion are.
    sagitta = mean_edge(mesh) ** 2 / RADIUS / 2
    low = np.where(np.arange(count) % 2, 0.5 * RADIUS, RADIUS + distance)
    high = np.where(np.arange(count) % 2, RADIUS - distance - sagitta, 1.5 * RADIUS)
    places = directions * np.cbrt(random.uniform(low**3, high**3))[:, np.newaxis]
    forces = elasticity(mesh)
    particles = list(range(mesh.num_vertices, mesh.num_vertices + count))
    forces.append(ParticleSurfaceForce(mesh, particles, distance, KBT))
    wall = openmm.CustomExternalForce(f"100*max(0, sqrt(x*x+y*y+z*z)-{1.5 * RADIUS})^2")
    for index in particles:
        wall.addParticle(index)
    forces.append(wall)
    system = openmm.System()
    for _ in range(mesh.num_vertices + count):
        system.addParticle(50.0)
    for force in forces:
        system.addForce(force)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, openmm.VerletIntegrator(TIME_STEP), platform)
    context.setParameter("volume", mesh.volume)
    context.setPositions(np.concatenate([mesh.vertices, places]))
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    start, steps, energies = time.perf_counter(), 0, []
    while steps < round(duration / TIME_STEP) and time.perf_counter() - start < seconds:
        state = context.getState(energy=True)
        kinetic, potential = state.getKineticEnergy(), state.getPotentialEnergy()
        energies.append((kinetic / unit.kilojoule_per_mole, potential / unit.kilojoule_per_mole))
        context.getIntegrator().step(20)
        steps += 20
    positions = positions_of(context)
    within = inside(positions[mesh.num_vertices :], positions[mesh.triangles])
    kinetic, potential = np.transpose(energies)
    return {
        "steps": steps,
        "inside": int(within.sum()),
        "through": int((within != (np.arange(count) % 2 == 1)).sum()),
        "drift": (kinetic + potential)[-1] / kinetic[0] - (kinetic + potential)[0] / kinetic[0],
        "noise": np.std(kinetic + potential) / kinetic[0],
    }


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
        found = report.runs(adhesion, points, VERSION)
        rows = [(*point.values(), run["ratio"]) for point, run in zip(points, found, strict=True)]
        report.table(["edge", "radius", "E/theory"], rows, "_adhesion")
    if only in (None, "crowd"):
        point = {"n": 7, "count": 10**4 if quick else 10**6, "seed": 1}
        point |= {"duration": 20.0 if quick else 1e4, "seconds": 10.0 if quick else 300.0}
        found = report.runs(crowd, [point], VERSION)
        for run in found:
            names = ["steps", "inside", "through", "drift", "noise"]
            report.table(["particles", *names], [(point["count"], *map(run.get, names))], "_crowd")


def add_arguments(parser):
    parts = ("ramp", "pressed", "pore", "adhesion", "crowd")
    parser.add_argument("--only", choices=parts, help="one part")


if __name__ == "__main__":
    main()
