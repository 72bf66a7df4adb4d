"""Fig. 8: a red blood cell, a fluid membrane on an elastic network, from VCM's own files.

Two configurations of the paper: spontaneous curvature 0 (1002 fluid and 162 elastic vertices) and
0.006/nm (4002 and 92). They are read from the folder that holds them, see --files. The second runs
twice: with VCM's |S|, to which a dent is as good as a bulge, and with the signed n·S of (B10), to
which it is not. There the fluid grows tubes of the radius 1/C0 = 167 nm, hardly more than the
120 nm between its vertices, which end the run. The paper's text has 92 elastic nodes and a Young
modulus of 25 µN/m; its files have the nodes and the springs used here.
"""

import argparse
import hashlib
import os
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import openmmhelfrich as helfrich
from _paper import MISSING, Figure
from _snapshots import along_axes, draw_meshes
from openmmhelfrich.analysis import mean_with_error

CASES = {
    # Name: (file, whether C0 goes with VCM's |S|, energy of bending at the start, kJ/mol).
    "C0 = 0": ("SM_RBC_C0.txt", False, 8314.340),
    "C0 = 0.006/nm, |S|": ("SM_RBC_C0.006.txt", True, 78464.14),
    "C0 = 0.006/nm, n·S": ("SM_RBC_C0.006.txt", False, 78465.07),
}
SAMPLES = 200


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
        (num_samples, num_terms), kJ/mol, and "temperatures", K; "shapes" of the fluid membrane at
        the start and at the end, nm, and its "triangles"; "failed", why the run ended early, or "".
    """
    import openmm
    from openmm import unit
    from openmmhelfrich.analysis.theory import BOLTZMANN

    config = helfrich.vcm.read(file, compatible, seed=seed)
    simulation = config.simulation()
    start = config.energies(simulation.context)
    fluid = config.membranes[0]
    steps = round(duration / config.step_size / SAMPLES)
    times, energies, temperatures = [], [], []
    shape = fluid.mesh.vertices
    failed = ""
    for sample in range(SAMPLES):
        try:
            simulation.step(steps)
        except openmm.OpenMMException as error:
            failed = str(error)
            break
        context = simulation.context
        state = context.getState(energy=True, positions=True)
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        times.append((sample + 1) * steps * config.step_size)
        energies.append(list(config.energies(context).values()))
        temperatures.append(2 * kinetic / (3 * config.num_particles * BOLTZMANN))
        shape = positions[fluid.particles.start : fluid.particles.stop]
    return {
        "start": start["bending 0"],
        "terms": list(config.terms),
        "times": np.array(times),
        "energies": np.array(energies).reshape(-1, len(config.terms)),
        "temperatures": np.array(temperatures),
        "shapes": np.array([fluid.mesh.vertices, shape]),
        "triangles": fluid.mesh.triangles,
        "failed": failed,
    }


def thickness(mesh):
    """Diameter, and thickness in the middle and at its largest, of a disc along z, nm."""
    rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    z = mesh.vertices[:, 2]
    inner = rho < 0.15 * rho.max()
    middle = z[inner & (z > 0)].mean() - z[inner & (z < 0)].mean()
    rings = np.digitize(rho, np.linspace(0, rho.max(), 12))
    extents = [
        z[(rings == ring) & (z > 0)].mean() - z[(rings == ring) & (z < 0)].mean()
        for ring in np.unique(rings)
        if ((rings == ring) & (z > 0)).any() and ((rings == ring) & (z < 0)).any()
    ]
    return 2 * np.percentile(rho, 98), middle, max(extents)


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
    for file, _, _ in CASES.values():
        if not (folder / file).is_file():
            print(
                f"fig08: there is no {folder / file}. VCM's files of the red cell come with the "
                "paper and with VCM; say with --files FOLDER where they are",
                file=sys.stderr,
            )
            sys.exit(MISSING)
    points = [
        {
            "file": str(folder / file),
            "contents": digest(folder / file),
            "duration": duration,
            "seed": 1,
            "compatible": compatible,
        }
        for file, compatible, _ in CASES.values()
    ]
    cells = dict(zip(CASES, figure.sweep(red_cell, points, description="red cells"), strict=True))
    figure.parameters(
        "VCM's files SM_RBC_C0 and SM_RBC_C0.006: κ = 120 kJ/mol, GKB, ν = 0.60, Ξ of d = 20 nm, "
        f"LangevinMiddle, γ = 0.01/ps, Δt = 0.2 ps, 300 K, {duration / 1000:g} ns."
    )
    for case, cell in cells.items():
        check(figure, case, cell, duration)
        if len(cell["energies"]) > 1:
            note(figure, case, cell)
    draw(figure, cells)
    figure.finish()


def check(figure, case, cell, duration):
    start, energies, failed = cell["start"], cell["energies"], cell["failed"]
    published = CASES[case][2]
    figure.claim(
        f"{case}: E_b at the start",
        f"{start:.2f} kJ/mol",
        f"{published:.2f} kJ/mol, relative ± 2e-6",
        abs(start / published - 1) < 2e-6,
    )
    lived = len(energies) / SAMPLES * duration / 1000
    figure.claim(
        f"{case}: runs stably",
        f"{lived:.4g} ns" + (f"; {failed}" if failed else ""),
        f"{duration / 1000:.4g} ns, all finite",
        np.isfinite(energies).all() and len(energies) == SAMPLES,
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
        for shape, when in zip(cell["shapes"], ("start", "end"), strict=True):
            mesh = along_axes(helfrich.Mesh(shape, cell["triangles"]))
            panels += [(f"{case}, {when}", mesh, None), ("cut", mesh, None)]
            views += ["tilted", "cut"]
    figure.save(graph, "_energies", "Energies per term over time.")
    path = figure.picture("", "The fluid membrane at the start and at the end, and cut in halves.")
    draw_meshes(path, panels, 4, views=views, edges=False)


if __name__ == "__main__":
    main()
