"""Fig. 8: a red blood cell, a fluid membrane on an elastic network, from VCM's own files.

Two configurations of the paper: spontaneous curvature 0 (1002 fluid and 162 elastic vertices) and
0.006/nm (4002 and 92). They are read from the folder that holds them, see --files. The second runs
twice: with VCM's |S|, to which a dent is as good as a bulge, and with the signed n·S of (B10), to
which it is not. The paper's text has 92 elastic nodes and a Young modulus of 25 µN/m; its files
have the nodes and the springs used here.

Shapes are measured: the thickness in the middle over that of the rim, which is 0.3 in the mean red
cell of Evans and Fung (doi:10.1016/0026-2862(72)90069-6).

What C0 of 16 over the radius asks for are tubes of the radius 1/C0 = 167 nm, hardly more than the
139 nm between vertices. With |S| the membrane crumples from vertex to vertex instead. With n·S
single vertices pull out tubes, on edges that span them from end to end. At the tip and in folds of
such a tube the normals of the triangles around a vertex cancel, and the direction of their sum, the
n of (B9), jumps from step to step, with n·S: that is where the run breaks down. It is no matter of
the time step, which is a third of its bound. Of a run that broke down the last stretch is repeated
step by step, to see how far normals cancel.
"""

import argparse
import hashlib
import os
import sys
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import openmmhelfrich as helfrich
from _paper import MISSING, Figure
from _snapshots import along_axes, draw_meshes
from openmmhelfrich.analysis import mean_with_error, vertex_quantities
from red_cell_shapes import coherence, dented, dimple, thickness


class Case(NamedTuple):
    """A file of VCM, whether C0 goes with its |S|, and E_b at the start, kJ/mol."""

    file: str
    compatible: bool
    energy: float


CASES = {
    "C0 = 0": Case("SM_RBC_C0.txt", False, 8314.340),
    "C0 = 0.006/nm, |S|": Case("SM_RBC_C0.006.txt", True, 78464.14),
    "C0 = 0.006/nm, n·S": Case("SM_RBC_C0.006.txt", False, 78465.07),
}
SAMPLES = 200
# Shapes that are kept of the second half, and how often the bound of the time step is measured.
SHAPES, BOUNDS = 10, 20
# What may lie between a thickness in the middle, over that of the rim, and Evans and Fung's.
CLOSE = 0.15


def digest(file):
    """Of the contents of a configuration and of the files beside it that it names."""
    words = file.read_text(encoding="utf-8-sig", errors="replace").split()
    named = {file.parent / word for word in words}
    contents = [path.read_bytes() for path in (file, *sorted(named)) if path.is_file()]
    return hashlib.sha256(b"\0".join(contents)).hexdigest()


def red_cell(file, contents, duration, seed, compatible=False):
    """Run one configuration.

    Parameters
    ----------
    file : str
        VCM's.
    contents : str
        Its `digest`, by which results of other contents are told from stored ones.
    duration : float
        ps.
    seed : int
        Of velocities and noise.
    compatible : bool
        Whether to follow VCM, whose C0 goes with |S|; without C0 that makes no difference.

    Returns
    -------
    dict
        "start", bending energy, kJ/mol; "terms", their names; "times", ps, "energies", shape
        (num_samples, num_terms), kJ/mol, "temperatures", K, "edges", the longest, nm, and
        "heights", the least, nm; "bounds" of the time step, ps; "shapes" of the fluid membrane, the
        first at the start, the last at the end, others from between, nm, and its "triangles";
        "step", ps; "failed", the diagnosis if the run ended early, or ""; and what `last_steps`
        returns, which is empty if it did not.
    """
    import openmm
    from openmm import unit
    from openmmhelfrich.analysis import edge_lengths, triangle_heights
    from openmmhelfrich.analysis.theory import BOLTZMANN

    config = helfrich.vcm.read(file, compatible, seed=seed)
    simulation = config.simulation()
    start = config.energies(simulation.context)
    fluid = config.membranes[0]
    triangles = fluid.mesh.triangles
    steps = round(duration / config.step_size / SAMPLES)
    watch = helfrich.BlowUpReporter(None, steps)
    simulation.reporters.append(watch)
    rows = {name: [] for name in ("times", "energies", "temperatures", "edges", "heights")}
    shapes, bounds, failed = [fluid.mesh.vertices], [], ""
    last = {"coherence": np.empty(0), "jump": 0.0}
    shape = fluid.mesh.vertices
    for sample in range(1, SAMPLES + 1):
        try:
            with watch:
                simulation.step(steps)
        except openmm.OpenMMException as error:
            failed = str(error)
            last = last_steps(simulation, fluid, steps)
            break
        state = simulation.context.getState(energy=True, positions=True)
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        shape = positions[fluid.particles.start : fluid.particles.stop]
        rows["times"].append(sample * steps * config.step_size)
        rows["energies"].append(list(config.energies(simulation.context).values()))
        rows["temperatures"].append(2 * kinetic / (3 * config.num_particles * BOLTZMANN))
        rows["edges"].append(edge_lengths(shape, triangles).max())
        rows["heights"].append(triangle_heights(shape, triangles).min())
        if sample % (SAMPLES // BOUNDS) == 0:
            bounds.append(helfrich.stable_time_step(simulation.context))
        if sample > SAMPLES // 2 and sample % (SAMPLES // 2 // SHAPES) == 0:
            shapes.append(shape)
    return {
        "start": start["bending 0"],
        "terms": list(config.terms),
        **{name: np.array(values) for name, values in rows.items()},
        "energies": np.array(rows["energies"]).reshape(-1, len(config.terms)),
        "bounds": np.array(bounds),
        "shapes": np.array([*shapes, shape], dtype=np.float32),
        "triangles": triangles,
        "step": config.step_size,
        "failed": failed,
        **last,
    }


def last_steps(simulation, fluid, steps):
    """Repeat the steps since the last look of a watch, where it has put the Context.

    Returns
    -------
    dict
        "coherence", the least of all vertices after each step, shape (num_steps,), up to the one
        before an energy or a position is not finite or the temperature doubles; "jump", how far
        n·S of the vertex of least coherence jumps in the step after it, nm.
    """
    import openmm
    from openmm import unit

    simulation.reporters.clear()
    triangles = fluid.mesh.triangles
    found, shapes, hottest = [], [], None
    for _ in range(steps):
        try:
            simulation.step(1)
            state = simulation.context.getState(energy=True, positions=True)
        except (openmm.OpenMMException, ValueError):
            break
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        hottest = hottest or 2 * kinetic
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        shapes = [*shapes[-1:], positions[fluid.particles.start : fluid.particles.stop]]
        if not kinetic < hottest:
            break
        found.append(coherence(shapes[-1], triangles).min())
    jump = 0.0
    if len(shapes) == 2:
        vertex = int(np.argmin(coherence(shapes[0], triangles)))
        quantities = [vertex_quantities(shape, triangles) for shape in shapes]
        before, after = (np.dot(one.normal[vertex], one.cotangent[vertex]) for one in quantities)
        jump = float(abs(after - before))
    return {"coherence": np.array(found), "jump": jump}


def files_folder():
    """The folder of the configurations: --files, or HELFRICH_SHARED, or one beside the project."""
    parser = argparse.ArgumentParser(add_help=False)
    beside = Path(__file__).resolve().parents[3] / "shared"
    parser.add_argument(
        "--files", type=Path, default=Path(os.environ.get("HELFRICH_SHARED", beside)) / "vcm"
    )
    options, rest = parser.parse_known_args()
    return options.files.resolve(), rest


def main():
    folder, rest = files_folder()
    figure = Figure("fig08", "Fig. 8", "A red cell, fluid and elastic membrane", __doc__, rest)
    duration = figure.choose(300_000, 200)
    for file in dict.fromkeys(case.file for case in CASES.values()):
        if not (folder / file).is_file():
            print(
                f"fig08: there is no {folder / file}. VCM's files of the red cell come with the "
                "paper and with VCM; say with --files FOLDER where they are",
                file=sys.stderr,
            )
            sys.exit(MISSING)
    points = [
        {
            "file": str(folder / case.file),
            "contents": digest(folder / case.file),
            "duration": duration,
            "seed": 1,
            "compatible": case.compatible,
        }
        for case in CASES.values()
    ]
    cells = dict(zip(CASES, figure.sweep(red_cell, points, description="red cells"), strict=True))
    figure.parameters(
        "VCM's files SM_RBC_C0 and SM_RBC_C0.006: κ = 120 kJ/mol, GKB, ν = 0.60, Ξ of d = 20 nm, "
        f"LangevinMiddle, γ = 0.01/ps, Δt = 0.2 ps, 300 K, {duration / 1000:g} ns."
    )
    evans_fung = dimple(helfrich.RedCell("fedosov", 4002).mesh)
    for case, cell in cells.items():
        check(figure, case, cell, duration)
        # A run that broke down before has no shapes of the second half.
        if not figure.quick and len(cell["shapes"]) > 2:
            check_shape(figure, case, cell, evans_fung)
        if len(cell["energies"]) > 1:
            note(figure, case, cell)
    draw(figure, cells)
    draw_edges(figure, cells)
    figure.finish()


def check(figure, case, cell, duration):
    start, energies, failed = cell["start"], cell["energies"], cell["failed"]
    published = CASES[case].energy
    figure.claim(
        f"{case}: E_b at the start",
        f"{start:.2f} kJ/mol",
        f"{published:.2f} kJ/mol, relative ± 2e-6",
        abs(start / published - 1) < 2e-6,
    )
    lived = len(energies) / SAMPLES * duration / 1000
    figure.claim(
        f"{case}: runs stably",
        f"{lived:.4g} ns" + (f"; {failed.splitlines()[0]}" if failed else ""),
        f"{duration / 1000:.4g} ns, all finite",
        np.isfinite(energies).all() and len(energies) == SAMPLES,
        cause(cell),
    )
    if failed and len(cell["coherence"]):
        figure.claim(
            f"{case}: normals around a vertex cancel as it breaks down, |Σ θ n| / Σ θ",
            f"{cell['coherence'][-1]:.2g} at the least of all vertices, then n·S jumps by "
            f"{cell['jump']:.0f} nm",
            "less than 0.02, and 0.9 at the start; a jump of more than 500 nm",
            cell["coherence"][-1] < 0.02
            and cell["jump"] > 500
            and coherence(cell["shapes"][0].astype(float), cell["triangles"]).min() > 0.9,
        )
        figure.note(f"{case}: {' '.join(line.strip() for line in failed.splitlines())}")
    if len(cell["bounds"]):
        figure.claim(
            f"{case}: time step below its bound",
            f"{cell['step']:g} ps, bound {cell['bounds'].min():.3g} ps at the least of "
            f"{len(cell['bounds'])} moments",
            "less than a half",
            cell["step"] < cell["bounds"].min() / 2,
        )
    temperature = cell["temperatures"][len(energies) // 2 :]
    if len(temperature) < 2:
        return
    error = temperature.std() / np.sqrt(len(temperature))
    if figure.quick or failed:
        # A short run does not lose the heat of the relaxing membrane, which goes in 100 ps.
        figure.note(f"{case}: temperature {temperature.mean():.1f} ± {error:.1f} K.")
    else:
        figure.check(f"{case}: temperature", temperature.mean(), 300, 3, error, " K")


def cause(cell):
    """Why a run broke down, in its numbers."""
    if not len(cell["edges"]):
        return ""
    return (
        "the spontaneous curvature pulls tubes of about the radius 1/C0 = 167 nm out of the "
        "membrane, with vertices 139 nm apart: single vertices pull them, on edges of up to "
        f"{cell['edges'].max():.0f} nm; around one the normals cancel, and n of (B9) and the "
        "energy with n·S jump (next row). |S| has no normal"
    )


def check_shape(figure, case, cell, evans_fung):
    """The thickness in the middle over that of the rim, against a discocyte's, and roughness."""
    meshes = [helfrich.Mesh(shape, cell["triangles"]) for shape in cell["shapes"][1:]]
    ratio = mean_with_error(np.array([dimple(mesh) for mesh in meshes]))
    rough = np.mean([dented(mesh) for mesh in meshes])
    if rough > 0.25:
        why = (
            f"{100 * rough:.0f} % of the area is dented and the rest bulges, from vertex to "
            "vertex: C0 is met by a crumpled surface, which needs no dimple"
        )
    else:
        why = "tubes take up the area that a dimple would need, see the picture"
    figure.check(
        f"{case}: thickness in the middle over that of the rim, over the second half",
        ratio.mean,
        evans_fung,
        CLOSE,
        ratio.error,
        why=why,
    )


def note(figure, case, cell):
    half = cell["energies"][len(cell["energies"]) // 2 :]
    means = ", ".join(
        f"{term.split()[0]} {energy.mean:.0f} ± {energy.error:.0f}"
        for term, energy in zip(cell["terms"], map(mean_with_error, half.T), strict=True)
    )
    last = along_axes(helfrich.Mesh(cell["shapes"][-1], cell["triangles"]))
    diameter, middle, rim = thickness(last)
    figure.note(
        f"{case}: ⟨E⟩ over the second half, kJ/mol: {means}. At the end ν = "
        f"{last.reduced_volume:.3f}, diameter {diameter:.0f} nm, thickness {middle:.0f} nm in "
        f"the middle and {rim:.0f} nm at the rim."
    )


def draw(figure, cells):
    graph, axes = plt.subplots(1, len(cells), figsize=(11, 3.6), layout="constrained")
    panels, views = [], []
    for axis, (case, cell) in zip(axes, cells.items(), strict=True):
        for term, energies in zip(cell["terms"], cell["energies"].T, strict=True):
            if energies.max(initial=0) > 0:
                axis.plot(cell["times"] / 1000, energies, label=term.split()[0], lw=1)
        axis.set(xlabel="t (ns)", ylabel="E (kJ/mol)", title=case, yscale="log")
        axis.legend(fontsize=7)
        for place, when in ((0, "start"), (-1, "end")):
            mesh = along_axes(helfrich.Mesh(cell["shapes"][place], cell["triangles"]))
            panels += [(f"{case}, {when}", mesh, None), ("cut", mesh, None)]
            views += ["tilted", "cut"]
    figure.save(graph, "_energies", "Energies per term over time.")
    path = figure.picture("", "The fluid membrane at the start and at the end, and cut in halves.")
    draw_meshes(path, panels, 4, views=views, edges=False)


def draw_edges(figure, cells):
    """The longest edge and the bound of the time step over time."""
    graph, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    for case, cell in cells.items():
        times = cell["times"] / 1000
        axes[0].plot(times, cell["edges"], label=case, lw=1)
        every = SAMPLES // BOUNDS
        axes[1].plot(times[every - 1 :: every], cell["bounds"], "o-", ms=3, lw=1, label=case)
    axes[1].axhline(cell["step"], color="black", lw=0.8, label="Δt")
    axes[0].set(xlabel="t (ns)", ylabel="longest edge (nm)", yscale="log")
    axes[1].set(xlabel="t (ns)", ylabel="longest stable time step (ps)", yscale="log")
    axes[0].legend(fontsize=7)
    axes[1].legend(fontsize=7)
    figure.save(graph, "_edges", "The longest edge, and the bound of the time step, over time.")


if __name__ == "__main__":
    main()
