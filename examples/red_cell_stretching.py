"""A red cell between optical tweezers: its length and width under forces of 0 to 193 pN.

Two opposite sides of 2 % of the vertices each, where beads are glued on in the experiment, are
pulled apart, and the cell takes the shape of least energy. The measurements, with their error bars,
are those of J. P. Mills, L. Qie, M. Dao, C. T. Lim and S. Suresh, doi:10.3970/mcb.2004.001.169, and
of S. Suresh et al., doi:10.1016/j.actbio.2004.09.001, as read off their figures by the authors of
Korali and of HemoCell.

    python examples/red_cell_stretching.py [--model NAME ...] [--vertices N ...] [--out DIR]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
from openmm import unit
from openmmhelfrich.red_cell import RED_CELL_MODELS

#: pN, and in µm the axial and the transverse diameter, each with the ends of its error bar.
MILLS = np.array(
    [
        [0.0, 7.738, 7.160, 8.492, 7.740, 7.113, 8.355],
        [16.0, 9.155, 8.344, 9.995, 6.707, 5.942, 7.451],
        [19.3, 9.648, 8.695, 10.617, 6.489, 5.864, 7.102],
        [30.8, 10.029, 8.905, 11.160, 6.107, 5.321, 6.836],
        [38.4, 10.905, 9.718, 12.080, 5.944, 5.093, 6.823],
        [47.2, 11.341, 10.063, 12.753, 5.399, 4.488, 6.472],
        [68.0, 12.322, 10.898, 13.796, 4.963, 3.874, 6.067],
        [87.8, 13.027, 11.436, 14.682, 4.747, 3.603, 5.864],
        [108.9, 13.626, 11.783, 15.512, 4.475, 3.395, 5.578],
        [130.5, 14.062, 12.144, 16.056, 4.529, 3.448, 5.511],
        [150.8, 14.553, 12.426, 16.730, 4.475, 3.457, 5.450],
        [172.4, 14.825, 12.701, 17.030, 4.475, 3.591, 5.383],
        [192.7, 15.261, 12.954, 17.650, 4.257, 3.440, 5.091],
    ]
)
SURESH = np.array(
    [
        [0.0, 7.92, 7.18, 8.58, 7.92, 7.18, 8.58],
        [16.0, 9.26, 8.35, 10.10, 6.20, 5.58, 6.81],
        [19.4, 9.58, 8.70, 10.45, 6.28, 5.64, 6.92],
        [30.5, 10.53, 9.62, 11.39, 5.72, 5.13, 6.32],
        [38.0, 11.14, 10.08, 12.29, 5.44, 4.82, 5.99],
        [46.6, 11.86, 10.82, 12.97, 5.07, 4.29, 5.83],
        [67.6, 12.87, 11.88, 13.87, 4.64, 3.94, 5.36],
        [87.6, 13.77, 12.58, 14.98, 4.64, 4.00, 5.27],
        [108.8, 14.35, 12.87, 15.82, 4.60, 3.98, 5.23],
        [130.0, 15.19, 13.89, 16.62, 4.53, 3.88, 5.19],
        [150.9, 15.60, 14.43, 16.87, 4.35, 3.78, 4.99],
        [172.8, 16.07, 14.26, 17.88, 4.60, 4.08, 5.05],
        [193.0, 16.30, 14.49, 18.02, 4.39, 3.75, 4.94],
    ]
)
SHARE = 0.02
PICONEWTON = 0.602214076  # kJ/mol/nm
GROUP = 31


def stretch(cell, forces):
    """Lengths along x and y, µm, and area and volume over those at the start, for forces in pN.

    Returns
    -------
    ndarray, shape (num_forces, 4)
    """
    system = cell.system()
    mesh = cell.mesh
    count = max(1, round(SHARE * mesh.num_vertices))
    order = np.argsort(mesh.vertices[:, 0]).tolist()
    pull = openmm.CustomExternalForce("-pull*share*x")
    pull.addGlobalParameter("pull", 0.0)
    pull.addPerParticleParameter("share")
    for side, particles in ((-1, order[:count]), (1, order[-count:])):
        for particle in particles:
            pull.addParticle(particle, [side / count])
    pull.setForceGroup(GROUP)
    system.addForce(pull)
    platform = openmm.Platform.getPlatformByName("Helfrich")
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
    context.setPositions(mesh.vertices)
    rows = []
    for force in forces:
        context.setParameter("pull", force * PICONEWTON)
        # From a coarse minimum to a fine one; kJ/mol/nm.
        for tolerance in (1e-2, 1e-4):
            openmm.LocalEnergyMinimizer.minimize(context, tolerance)
        state = context.getState(positions=True)
        positions = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        now = helfrich.Mesh(positions, mesh.triangles)
        length, width, _ = np.ptp(positions, axis=0) / 1000
        rows.append((length, width, now.area / mesh.area, now.volume / mesh.volume))
    return np.array(rows)


def within(found, measured):
    """Which of the lengths and widths are inside the error bars at the forces of the rows."""
    return np.stack(
        [
            (measured[:, low] <= found[:, k]) & (found[:, k] <= measured[:, low + 1])
            for k, low in ((0, 2), (1, 5))
        ]
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--model", nargs="+", default=["amoudruz"], choices=list(RED_CELL_MODELS))
    parser.add_argument("--vertices", nargs="+", type=int, default=[502, 1002, 4002])
    parser.add_argument("--out", type=Path, default=Path("red_cell_output"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    curves = {}
    for model in options.model:
        for num_vertices in options.vertices:
            cell = helfrich.RedCell(model, num_vertices)
            found = {
                name: stretch(cell, measured[:, 0])
                for name, measured in (("Mills", MILLS), ("Suresh", SURESH))
            }
            curves[f"{model}, N = {num_vertices}"] = found["Mills"]
            print(f"{model}, N = {num_vertices}")
            print("  pN     length   width (µm)   area    volume")
            for force, row in zip(MILLS[:, 0], found["Mills"], strict=True):
                print("  {:5.1f}  {:6.3f}  {:6.3f}      {:.4f}  {:.4f}".format(force, *row))
            for name, measured in (("Mills", MILLS), ("Suresh", SURESH)):
                lengths, widths = within(found[name], measured).sum(axis=1)
                total = len(measured)
                print(
                    f"  inside the error bars of {name} et al.: lengths {lengths} of {total}, "
                    f"widths {widths} of {total}"
                )
            np.savetxt(
                options.out / f"{model}_{num_vertices}.csv",
                np.column_stack([MILLS[:, 0], found["Mills"]]),
                fmt="%.6g",
                delimiter=",",
                header="force_pN,length_um,width_um,area_ratio,volume_ratio",
                comments="",
            )
    draw(curves, options.out / "red_cell_stretching.png")


def draw(curves, path):
    """Curves among the measurements."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    for measured, label, marker in (
        (MILLS, "Mills et al. 2004", "s"),
        (SURESH, "Suresh et al. 2005", "o"),
    ):
        for value, low in ((1, 2), (4, 5)):
            middle = measured[:, value]
            bars = [middle - measured[:, low], measured[:, low + 1] - middle]
            axes.errorbar(
                measured[:, 0], middle, bars, fmt=marker, ms=4, lw=0.8, capsize=2,
                color="0.3" if marker == "s" else "0.65", label=label if value == 1 else None,
            )  # fmt: skip
    for label, found in curves.items():
        (line,) = axes.plot(MILLS[:, 0], found[:, 0], label=label)
        axes.plot(MILLS[:, 0], found[:, 1], color=line.get_color())
    axes.set_xlabel("force, pN")
    axes.set_ylabel("length and width, µm")
    axes.set_ylim(3, 21)
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper left")
    figure.savefig(path, dpi=120)
    plt.close(figure)
    print(path)


if __name__ == "__main__":
    main()
