"""The picture of `coarsening.py` and `vesicle_budding.py`: domains that grow, and that bud.

Runs are theirs, and are read from the folder of results where they are stored.
"""

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
from coarsening import CASES, VERTICES, coarsen
from coarsening import VERSION as COARSENING
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from PIL import Image
from vesicle_budding import VERSION as BUDDING
from vesicle_budding import branch_of, domains_of, let_go, share_of

sys.path.append(str(Path(__file__).resolve().parents[1] / "flips"))
from reports import Report

COLOURS = np.array([[0.62, 0.71, 0.80], [0.85, 0.37, 0.25]])
"""Of the vesicle and of its domains."""
TILT = 0.25
"""Of the z axis towards the viewer, radians."""


def patches(positions, triangles, kinds):
    """A quadrilateral for each corner of each triangle that faces the viewer, from back to front.

    Returns
    -------
    corners : ndarray
        Shape (num_patches, 4, 2), x and z of the picture.
    colours : ndarray
        Shape (num_patches, 3).
    """
    sine, cosine = np.sin(TILT), np.cos(TILT)
    turn = np.array([[1, 0, 0], [0, -sine, cosine], [0, -cosine, -sine]])
    points = (positions - positions.mean(axis=0)) @ turn.T
    a, b, c = points[triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    if np.einsum("ti,ti", a, normals) < 0:
        normals = -normals
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shade = 0.55 + 0.45 * np.clip(normals @ np.array([-0.4, 0.6, 0.7]), 0, 1)
    corners, colours = [], []
    for one in range(3):
        at, following, last = (points[triangles[:, (one + i) % 3]] for i in range(3))
        centre = (at + following + last) / 3
        corners.append(np.stack([at, (at + following) / 2, centre, (at + last) / 2], axis=1))
        colours.append(COLOURS[(kinds[triangles[:, one]] > 0).astype(int)] * shade[:, np.newaxis])
    seen = np.tile(normals[:, 2] > 0, 3)
    corners, colours = np.concatenate(corners)[seen], np.concatenate(colours)[seen]
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    return corners[order][:, :, :2], colours[order]


def draw(path, panels):
    """Write a PNG.

    Parameters
    ----------
    path : Path
    panels : mapping of str to tuple
        Positions, triangles and kinds by their titles.
    """
    figure = Figure(figsize=(2.6 * len(panels), 2.9), dpi=100, layout="constrained")
    for axes, (title, panel) in zip(figure.subplots(1, len(panels)), panels.items(), strict=True):
        corners, colours = patches(*panel)
        axes.add_collection(
            PolyCollection(corners, facecolors=colours, edgecolors=colours, linewidths=0.2)
        )
        axes.autoscale_view()
        axes.set(aspect="equal")
        axes.set_axis_off()
        axes.set_title(title, fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    with BytesIO() as file:
        figure.savefig(file)
        # A palette takes half the space.
        Image.open(file).convert("RGB").quantize(96, dither=Image.Dither.NONE).save(
            path, optimize=True
        )


def main():
    report = Report("picture", __doc__, folder="domains")
    vertices = 252 if report.quick else VERTICES
    tension, last = CASES["weak"]
    last = last - 4 if report.quick else last
    point = {"tension": tension, "seed": 1, "vertices": vertices, "last": last}
    (run,) = report.runs(coarsen, [point], COARSENING)
    panels = {}
    for frame in (0, 7, last + 1):
        title = f"γl = {tension:g} kT, {run['sweeps'][frame]} sweeps"
        panels[title] = tuple(run[name][frame] for name in ("positions", "triangles", "kinds"))
    n, factor, duration = (13, 1.6, 6000.0) if report.quick else (20, 1.4, 16000.0)
    (spinodal, _), _ = branch_of(share_of(n)).spinodals()
    point = {"n": n, "strength": factor * spinodal, "temperature": 5.0, "duration": duration}
    (run,) = report.runs(let_go, [{**point, "seed": 1}], BUDDING)
    panels[f"λ = {factor:g} of the spinodal"] = (
        run["positions"],
        run["triangles"],
        domains_of(n),
    )
    draw(report.tables / "vesicles.png", panels)


if __name__ == "__main__":
    main()
