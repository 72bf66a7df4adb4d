"""Masses that follow the plaquettes: what docs/variable_mass.md shows.

Four tables, each in a CSV file:

- energy: how well VariableMassVerletIntegrator conserves the Hamiltonian over many steps.
- areas: the variance of N a_i / A with constant masses, with masses that follow the plaquettes, and
  with a PlaquetteAreaForce of the stiffness 3/2 kBT, (20) of doi:10.1103/PhysRevE.108.015301. The
  last two are predicted from the run with constant masses, in two ways: by giving its frames the
  weights prod a_i^(3/2), or exp(-U/kBT); and as a harmonic system of the same covariance C and mean
  would respond to the stiffness, C' = (1/C + 3/2)^-1.
- modes: frequencies of undulations over those of (A30) with the flow that a bulge causes in a
  surface whose every triangle keeps its area, omega_l sqrt(l (l+1) / (l (l+1) + 4)). On a mesh of
  very unequal plaquettes: a random sphere that is stretched conformally, so that it is coarse at
  one pole and fine at the other. A TriangleAreaForce keeps it like that.
- cost: the time of a step.

Runs are stored as soon as they are there, so that a script that was interrupted goes on.
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm import unit
from openmmhelfrich.analysis import fit_damping, mode_amplitudes, theory, triangle_areas
from openmmhelfrich.sweep import sweep
from openmmhelfrich.vesicle import KBT

VERSION = 1
TEMPERATURE = 300  # K
MASS = 50  # amu
RADIUS = 1000  # nm
RIGIDITY = 20 * KBT
#: The local modulus of the meshes of unequal plaquettes, kJ/mol/nm².
MODULUS = 0.05
#: By how much they are stretched at one pole and shrunk at the other.
STRETCH = 2.0
#: The friction of baths, 1/ps.
FRICTION = 0.01
MODES = range(2, 8)

KINDS = {
    "constant": "constant masses",
    "variable": "masses that follow the plaquettes",
    "potential": "constant masses and a PlaquetteAreaForce",
    "plaquettes": "constant masses of plaquette_masses",
}


def started(system, integrator, positions, seed):
    """A Context on one thread, with velocities of 300 K."""
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, integrator, platform, {"Threads": "1"})
    context.setPositions(positions)
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    return context


def dynamics(kind, time_step, seed=None):
    """An integrator without a bath, or with one if there is a seed."""
    if seed is None:
        if kind == "variable":
            return helfrich.VariableMassVerletIntegrator(time_step)
        return openmm.VerletIntegrator(time_step)
    if kind == "variable":
        bath = helfrich.VariableMassLangevinIntegrator(TEMPERATURE, FRICTION, time_step)
    else:
        bath = openmm.LangevinMiddleIntegrator(TEMPERATURE, FRICTION, time_step)
    bath.setRandomNumberSeed(seed)
    return bath


def paper_vesicle(num_vertices, kind="constant"):
    """The paper's vesicle and its System."""
    vesicle = helfrich.Vesicle(helfrich.Mesh.random_sphere(num_vertices, RADIUS, seed=1))
    system = vesicle.system()
    if kind == "potential":
        mesh = vesicle.mesh
        system.addForce(helfrich.PlaquetteAreaForce(mesh, 1.5 * KBT, mesh.area))
    return vesicle, system


def positions_of(context):
    state = context.getState(positions=True)
    return state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def conserve(num_vertices, kind, time_step, frames, stride, seed):
    """Energies of a vesicle without a bath, kBT for each vertex, from equilibrium on."""
    vesicle, system = paper_vesicle(num_vertices)
    before = started(system, dynamics(kind, time_step, seed), vesicle.mesh.vertices, seed)
    before.getIntegrator().step(round(vesicle.tau_2 / time_step))
    context = started(system, dynamics(kind, time_step), vesicle.mesh.vertices, seed)
    context.setState(before.getState(positions=True, velocities=True))
    energies = []
    for frame in range(frames + 1):
        context.getIntegrator().step(stride if frame else 0)
        state = context.getState(energy=True)
        total = state.getKineticEnergy() + state.getPotentialEnergy()
        energies.append(total.value_in_unit(unit.kilojoule_per_mole))
    return {"energy": (np.array(energies) - energies[0]) / KBT / num_vertices}


def fluctuate(num_vertices, kind, time_step, frames, stride, seed):
    """N a_i / A in equilibrium, shape (frames, num_vertices)."""
    vesicle, system = paper_vesicle(num_vertices, kind)
    context = started(system, dynamics(kind, time_step, seed), vesicle.mesh.vertices, seed)
    bath = context.getIntegrator()
    bath.step(100 * stride)
    corners = vesicle.mesh.triangles
    shares = []
    for _ in range(frames):
        bath.step(stride)
        areas = np.repeat(triangle_areas(positions_of(context), corners) / 3, 3)
        areas = np.bincount(corners.ravel(), areas, num_vertices)
        shares.append(num_vertices * areas / areas.sum())
    return {"shares": np.array(shares, dtype=np.float32)}


def undulate(num_vertices, stretch, kind, time_step, interval, periods, seed):
    """Modes of a sphere of uneven mesh without a bath, after equilibrium in one."""
    mesh = uneven_sphere(num_vertices, stretch, seed)
    system = openmm.System()
    masses = np.full(num_vertices, MASS)
    if kind == "plaquettes":
        masses = helfrich.plaquette_masses(mesh, total_mass=MASS * num_vertices)
    for mass in masses:
        system.addParticle(mass)
    areas = triangle_areas(mesh, mesh)
    system.addForce(helfrich.BendingForce(mesh, RIGIDITY))
    system.addForce(helfrich.SurfaceAreaForce(mesh, 1.3, mesh.area))
    system.addForce(helfrich.TriangleAreaForce(mesh, MODULUS, areas))
    # Triangles are smaller by the stretch where the mesh is fine.
    system.addForce(helfrich.TriangleHeightForce(mesh, mesh.min_height(0.037) / stretch, 4 * KBT))
    before = started(system, dynamics(kind, time_step, seed), mesh.vertices, seed)
    period = 2 * np.pi / frequency(2, num_vertices)
    before.getIntegrator().step(round(period / time_step))
    context = started(system, dynamics(kind, time_step), mesh.vertices, seed)
    context.setState(before.getState(positions=True, velocities=True))
    frames = []
    for _ in range(round(periods * period / interval)):
        context.getIntegrator().step(round(interval / time_step))
        frames.append(positions_of(context))
    frames = np.array(frames)
    return {
        "modes": mode_amplitudes(frames, mesh.triangles, max(MODES)),
        "smallest": float(areas.min() / areas.mean()),
        "largest": float(areas.max() / areas.mean()),
        "deviation": float(np.std(triangle_areas(frames, mesh.triangles).mean(axis=0) / areas)),
    }


def uneven_sphere(num_vertices, stretch, seed):
    """A random sphere, stretched about one pole and shrunk about the other, angles kept."""
    mesh = helfrich.Mesh.random_sphere(num_vertices, RADIUS, seed=seed)
    x, y, z = mesh.vertices.T / RADIUS
    # On the plane that the sphere is projected to from its pole it is a scaling.
    plane = stretch * np.stack([x, y]) / (1 - z)
    square = (plane**2).sum(axis=0)
    vertices = np.stack([*(2 * plane), square - 1]) / (square + 1)
    return helfrich.Mesh(RADIUS * vertices.T, mesh.triangles)


def frequency(l, num_vertices):
    """ω_l of (A30), rad/ps."""
    return theory.mode_frequency(l, RIGIDITY, MASS, num_vertices, RADIUS)


def frequency_with_flow(l, num_vertices):
    """The same where every bulge makes a surface flow that keeps its area everywhere.

    A displacement u Y_lm along the normal takes one of 2 u / l (l+1) grad Y_lm along the surface,
    so that the kinetic energy is 1 + 4 / l (l+1) times as large.
    """
    return frequency(l, num_vertices) / np.sqrt(1 + 4 / (l * (l + 1)))


def step_time(num_vertices, kind, bath, batches, seed=1):
    """The shortest time of a step among many batches, µs."""
    vesicle, system = paper_vesicle(num_vertices)
    integrator = dynamics(kind, 0.2, seed if bath else None)
    context = started(system, integrator, vesicle.mesh.vertices, seed)
    batch = max(1, 40_000 // num_vertices)
    shortest = np.inf
    for _ in range(batches):
        begin = time.perf_counter()
        context.getIntegrator().step(batch)
        shortest = min(shortest, (time.perf_counter() - begin) / batch)
    return {"time": 1e6 * shortest}


# --- tables --------------------------------------------------------------------------------------


def energy_table(run, quick):
    """Largest deviation and drift, of the straight line through all frames."""
    sizes, frames = ((252,), 20) if quick else ((252, 1002), 1000)
    rows = []
    for size in sizes:
        for kind in ("constant", "variable"):
            point = {"num_vertices": size, "kind": kind, "time_step": 0.2, "frames": frames}
            (result,) = run(conserve, [point | {"stride": 100 if quick else 1000, "seed": 1}])
            energy = result["energy"]
            steps = point["frames"] * (100 if quick else 1000)
            at = np.linspace(0, 1, len(energy))
            drift = np.polyfit(at, energy, 1)[0]
            rows.append((size, KINDS[kind], 0.2, steps, np.abs(energy).max(), energy.std(), drift))
    return ["N", "masses", "step_ps", "steps", "largest", "rms", "drift"], rows


def areas_table(run, quick):
    """Variances, measured and predicted; errors are those of the mean over runs."""
    size, frames, seeds = (92, 50, 2) if quick else (252, 4000, 8)
    kinds = ("constant", "variable", "potential")
    found = {}
    for kind in kinds:
        points = [
            {
                "num_vertices": size,
                "kind": kind,
                "time_step": 0.4,
                "frames": frames,
                "stride": 250,
                "seed": seed,
            }
            for seed in range(1, 1 + seeds)
        ]
        found[kind] = [result["shares"].astype(float) for result in run(fluctuate, points)]
    weights = {
        "constant": lambda x: np.zeros(len(x)),
        "variable": lambda x: 1.5 * np.log(x).sum(axis=1),
        "potential": lambda x: -0.75 * ((x - 1) ** 2).sum(axis=1),
    }
    rows = []
    for kind in kinds:
        measured = [((x - 1) ** 2).mean() for x in found[kind]]
        # Leaving out one run at a time tells the error of what is not linear in the frames.
        all_runs = found["constant"]
        leaving = [all_runs[:k] + all_runs[k + 1 :] for k in range(seeds)]
        weighted = jackknife([reweighted(runs, weights[kind]) for runs in [all_runs, *leaving]])
        stiffness = 0.0 if kind == "constant" else 1.5
        response = jackknife([harmonic(runs, stiffness) for runs in [all_runs, *leaving]])
        rows.append((size, KINDS[kind], *mean_and_error(measured), *weighted, *response))
    names = "N ensemble variance error reweighted reweighted_error harmonic harmonic_error"
    return names.split(), rows


def mean_and_error(values):
    return float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(len(values)))


def jackknife(estimates):
    """That of all runs, and its error from those that leave out one each."""
    whole, parts = estimates[0], np.array(estimates[1:])
    error = np.sqrt((len(parts) - 1) * ((parts - parts.mean()) ** 2).mean())
    return float(whole), float(error)


def reweighted(runs, exponent):
    """The variance with a weight exp(exponent) of each frame."""
    shares = np.concatenate(runs)
    exponents = exponent(shares)
    weight = np.exp(exponents - exponents.max())
    return (weight * ((shares - 1) ** 2).mean(axis=1)).sum() / weight.sum()


def harmonic(runs, stiffness):
    """The variance about 1 of a harmonic system of this covariance and mean, with springs to 1."""
    shares = np.concatenate(runs)
    mean = shares.mean(axis=0) - 1
    values, vectors = np.linalg.eigh(np.cov(shares.T))
    # Shares sum up to N, so that one of the directions is fixed.
    values, along = values[1:], (mean @ vectors)[1:]
    softer = 1 / (1 / values + stiffness)
    return (softer.sum() + ((softer / values * along) ** 2).sum()) / len(mean)


def modes_table(run, quick):
    """Frequencies over (A30) with flow, and damping over frequency."""
    size, periods, seeds = (252, 3, 1) if quick else (1002, 20, 3)
    setups = [
        (1.0, "constant"),
        (STRETCH, "constant"),
        (STRETCH, "plaquettes"),
        (STRETCH, "variable"),
    ]
    rows = []
    for stretch, kind in setups:
        points = [
            {
                "num_vertices": size,
                "stretch": stretch,
                "kind": kind,
                "time_step": 0.8,
                "interval": 80.0,
                "periods": periods,
                "seed": seed,
            }
            for seed in range(1, 1 + seeds)
        ]
        results = run(undulate, points)
        about = [
            float(np.mean([result[name] for result in results]))
            for name in ("smallest", "largest", "deviation")
        ]
        for l in MODES:
            series = [result["modes"][:, l**2 : (l + 1) ** 2] for result in results]
            series = np.concatenate([each - each.mean(axis=0) for each in series], axis=1)
            expected = frequency_with_flow(l, size)
            lags = min(round(2.5 * 2 * np.pi / expected / 80.0), len(series) // 2)
            try:
                fit = fit_damping(series, 80.0, lags)
                numbers = (fit.frequency / expected, fit.frequency_error / expected)
                numbers += (fit.friction / fit.frequency, fit.friction_error / fit.frequency)
            except RuntimeError:
                numbers = ("", "", "", "")
            rows.append((size, stretch, KINDS[kind], *about, l, *map(plain, numbers)))
    names = "N stretch masses smallest largest deviation l ratio error damping damping_error"
    return names.split(), rows


def plain(number):
    return number if number == "" else float(number)


def cost_table(run, quick):
    """µs for each step, and how many times the step of constant masses."""
    rows = []
    for size in (252,) if quick else (252, 1002, 4002):
        for bath in (False, True):
            times = []
            for kind in ("constant", "variable"):
                point = {"num_vertices": size, "kind": kind, "bath": bath}
                (result,) = run(step_time, [point | {"batches": 10 if quick else 400}])
                times.append(result["time"])
            name = "Langevin" if bath else "Verlet"
            rows.append((size, name, *times, times[1] / times[0]))
    return ["N", "dynamics", "constant", "variable", "ratio"], rows


TABLES = {
    "energy": energy_table,
    "areas": areas_table,
    "modes": modes_table,
    "cost": cost_table,
}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)}")
    parser.add_argument("--quick", action="store_true", help="smaller and fewer runs")
    parser.add_argument("--out", type=Path, help="of tables and stored runs (default: out/…)")
    options = parser.parse_args()
    unknown = set(options.tables) - set(TABLES)
    if unknown:
        parser.error(f"there is no table {unknown.pop()}; known are {', '.join(TABLES)}")
    out = options.out or Path("out/variable_mass") / ("quick" if options.quick else "full")

    def run(function, points):
        return sweep(function, points, cache=out / "cache", version=VERSION, workers=0)

    for name in options.tables or TABLES:
        columns, rows = TABLES[name](run, options.quick)
        print(f"\n{name}")
        with (out / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            for row in [columns, *rows]:
                texts = [f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row]
                writer.writerow(texts)
                print("  ".join(f"{text:>10}" for text in texts))


if __name__ == "__main__":
    main()
