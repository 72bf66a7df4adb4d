"""What SurfaceViscosityThermostat makes of a membrane: its viscosity, and its temperature.

"viscosity": waves of velocities on a regular periodic sheet at rest decay without noise. A shear
wave decays at the rate η q²/ρ, a longitudinal one at (η + ζ) q²/ρ, where η = √3/4 γ and ζ = 2η;
"ratio" is what is found over that, for several γ Δt / m, Δt from one sweep to the next.

"viscosity_nets": the in-plane shear viscosity over √3/4 γ of irregular sheets, seen along the
normal. "affine" is that of vertices that flow as the surface does, √(1/12) Σ l² / A over the edges,
an upper bound (the dissipation of a slow flow is the least); in "flowing" they find their own way.
Regular sheets with "jitter" (edges) in the plane, and membranes at 300 K of "softness" Ξ with bonds
that flip.

"viscosity_springs": the mean energy of an octahedron of springs in units of that at the
temperature. Velocities at hand are those of half a step ago, to which the thermostat goes back
under VerletIntegrator ("corrected"). Of a CustomIntegrator it cannot know that.
"""

import numpy as np
import openmm
from membranes import KBT, TEMPERATURE, context_of, positions_of
from openmm import unit
from openmmhelfrich import Mesh, SurfaceAreaForce, SurfaceViscosityThermostat, Vesicle
from reports import Report

VERSION = 1
MASS, EDGE, FRICTION = 50.0, 10.0, 20.0  # amu, nm, amu/ps


def decay(cells, shear, sweep, periods=0.05):
    """The rate of a wave of so many edges over that of theory; `sweep` is γ Δt / m."""
    mesh = Mesh.sheet(cells, 6, EDGE, periodic=True)
    thermostat = SurfaceViscosityThermostat(mesh, FRICTION, 1e-30)
    # It has no energy, but lives in the box.
    area = SurfaceAreaForce(mesh, 0.0, mesh.area)
    step = sweep * MASS / FRICTION
    context = context_of(mesh, [area, thermostat], openmm.VerletIntegrator(step), MASS)
    length = mesh.box[0, 0]
    wave = np.zeros((mesh.num_vertices, 3))
    # So slow that vertices stay where they are.
    wave[:, int(shear)] = 1e-4 * np.sin(2 * np.pi * mesh.vertices[:, 0] / length)
    context.setVelocities(wave)
    density = MASS / (3**0.5 / 2 * EDGE**2)
    theory = (1 if shear else 3) * 3**0.5 / 4 * FRICTION * (2 * np.pi / length) ** 2 / density
    steps = 2 * max(1, round(periods / (theory * step) / 2))
    context.getIntegrator().step(steps)
    state = context.getState(velocities=True)
    now = state.getVelocities(asNumpy=True).value_in_unit(unit.nanometer / unit.picosecond)
    return {"ratio": -np.log((now * wave).sum() / (wave**2).sum()) / (steps * step * theory)}


def of_net(vertices, triangles, box):
    """The affine and the flowing shear viscosity of a net over √3/4 γ, seen along z."""
    lengths = np.diag(box)[:2]
    sides = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    i, j = np.unique(np.sort(sides, axis=1), axis=0).T
    apart = vertices[i, :2] - vertices[j, :2]
    apart -= lengths * np.round(apart / lengths)
    along = apart / np.linalg.norm(apart, axis=1)[:, None]
    stretching, rows = np.zeros((len(i), 2 * len(vertices))), np.arange(len(i))
    for axis in range(2):
        stretching[rows, 2 * i + axis] = along[:, axis]
        stretching[rows, 2 * j + axis] = -along[:, axis]
    found = []
    for rate in (np.array([[0, 0.5], [0.5, 0]]), np.array([[0.5, 0], [0, -0.5]])):
        affine = ((apart @ rate) * along).sum(axis=1)
        rest = np.linalg.lstsq(stretching, -affine, rcond=None)[0]
        # The dissipation γ Σ u² is η A.
        found.append([(u**2).sum() for u in (affine, affine + stretching @ rest)])
    affine, flowing = np.mean(found, axis=0) / (lengths.prod() * 3**0.5 / 4)
    return {"affine": affine, "flowing": flowing}


def jittered(jitter, n):
    """Of a regular sheet whose vertices are displaced in the plane."""
    mesh = Mesh.sheet(n, n, EDGE, periodic=True)
    jump = np.random.default_rng(1).normal(size=mesh.vertices.shape) * [1, 1, 0]
    return of_net(mesh.vertices + jitter * EDGE / 2**0.5 * jump, mesh.triangles, mesh.box)


def fluid(softness, n, frames):
    """The mean of frames of a membrane whose bonds flip."""
    mesh = Mesh.sheet(n, n, 50.0, periodic=True)
    vesicle = Vesicle(
        mesh,
        volume_modulus=0,
        softness=softness,
        flips={"attemptsPerEdge": 0.2, "randomNumberSeed": 1},
    )
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, 0.01, 0.3)
    integrator.setRandomNumberSeed(1)
    context = vesicle.simulation(integrator, "Helfrich").context
    context.setVelocitiesToTemperature(TEMPERATURE, 1)
    integrator.step(3000 * frames)
    found = []
    for _ in range(frames):
        integrator.step(3000)
        triangles = vesicle.placement.flips.getTrianglesInContext(context)
        found.append(of_net(positions_of(context), triangles, mesh.box))
    return {name: np.mean([frame[name] for frame in found]) for name in found[0]}


def springs(sweep, corrected, samples):
    """The mean energy of springs, over 6 kT, with a standard error; `sweep` is γ Δt / m."""
    corners = np.vstack([np.eye(3), -np.eye(3)])[[0, 3, 1, 4, 2, 5]]
    triangles = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ]
    bonds = openmm.HarmonicBondForce()
    for i, j in sorted({tuple(sorted((t[k - 1], t[k]))) for t in triangles for k in range(3)}):
        bonds.addBond(i, j, 2**0.5, 20_000.0)
    step = 0.01
    thermostat = SurfaceViscosityThermostat(triangles, sweep * MASS / step, TEMPERATURE)
    thermostat.setRandomNumberSeed(1)
    integrator = openmm.VerletIntegrator(step)
    if not corrected:
        integrator = openmm.CustomIntegrator(step)
        integrator.addUpdateContextState()
        integrator.addComputePerDof("v", "v+dt*f/m")
        integrator.addComputePerDof("x", "x+dt*v")
    mesh = Mesh(corners, triangles)
    context = context_of(mesh, [bonds, thermostat], integrator, MASS)
    integrator.step(1000)
    energies = np.empty((20, samples // 20))
    for index in np.ndindex(energies.shape):
        integrator.step(20)
        energies[index] = context.getState(energy=True).getPotentialEnergy()._value
    means = energies.mean(axis=1) / (6 * KBT)
    return {"energy": means.mean(), "error": means.std(ddof=1) / len(means) ** 0.5}


def main():
    report = Report("viscosity", __doc__, folder="surfaces")
    sweeps = (0.1, 0.5) if report.quick else (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
    points = [
        {"cells": 12 if report.quick else 60, "shear": shear, "sweep": sweep}
        for shear in (True, False)
        for sweep in sweeps
    ]
    runs = report.runs(decay, points, VERSION)
    rows = [(*point.values(), run["ratio"]) for point, run in zip(points, runs, strict=True)]
    report.table(["cells", "shear", "γΔt/m", "ratio"], rows)

    n = 8 if report.quick else 24
    frames = 2 if report.quick else 20
    nets = [("jitter", jittered, {"n": n}, (0.0, 0.1, 0.2))]
    nets.append(("softness", fluid, {"n": n, "frames": frames}, (0.15, 0.33, 0.59)))
    rows = []
    for name, function, others, values in nets:
        runs = report.runs(function, [{name: value} | others for value in values], VERSION)
        rows += [
            (name, value, run["affine"], run["flowing"])
            for value, run in zip(values, runs, strict=True)
        ]
    report.table(["net", "value", "affine", "flowing"], rows, "_nets")

    points = [
        {"sweep": sweep, "corrected": corrected, "samples": 1000 if report.quick else 20_000}
        for sweep in (0.1, 0.5, 1.0)
        for corrected in (True, False)
    ]
    runs = report.runs(springs, points, VERSION)
    rows = [
        (point["sweep"], point["corrected"], run["energy"], run["error"])
        for point, run in zip(points, runs, strict=True)
    ]
    report.table(["γΔt/m", "corrected", "energy", "error"], rows, "_springs")


if __name__ == "__main__":
    main()
