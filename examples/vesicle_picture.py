"""The picture of `vesicle.py`: the vesicle coloured by mean curvature, beside its spectrum."""

import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from openmmhelfrich.analysis import mean_curvature, theory
from openmmhelfrich.vesicle import KBT

LABELS = {"surface": "simulation, surface integral", "vertices": "simulation, sum over vertices"}

PARTS = 5
"""Every triangle is drawn as PARTS² small ones."""


def draw(path, mesh, measured, vesicle):
    """Write the picture.

    Parameters
    ----------
    path : str or PathLike
        A file name that ends in a format of matplotlib, such as .png.
    mesh : Mesh
        The mesh to show.
    measured : dict of str to openmmhelfrich.analysis.Spectrum
        Its fluctuation spectrum by quadrature, "surface" and "vertices".
    vesicle : Vesicle
        The model, for the theory's line.
    """
    # A Figure of its own, without pyplot, needs no display and leaves no global state behind.
    figure = Figure(figsize=(12, 5.6), dpi=150, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.15, 1])
    draw_mesh(figure, left, mesh)
    draw_spectrum(right, measured, vesicle)
    figure.savefig(path)


def draw_mesh(figure, axes, mesh):
    """The mesh in three dimensions, lit from the upper left, with a scale bar."""
    vertices = (mesh.vertices - mesh.vertices.mean(axis=0)) / 1000
    view = vertices @ view_rotation().T
    curvature = 1000 * mean_curvature(mesh.vertices, mesh.triangles)
    radius = math.sqrt(mesh.area / (4 * math.pi)) / 1000

    # The middle of the scale is the sphere's curvature: redder is sharper, bluer is flatter.
    reach = np.percentile(abs(curvature - 2 / radius), 95)
    scale = ScalarMappable(Normalize(2 / radius - reach, 2 / radius + reach), "RdYlBu_r")

    corners, colours = shaded_triangles(view, mesh.triangles, curvature, scale)
    axes.add_collection(
        PolyCollection(corners, facecolors=colours, edgecolors=colours, linewidths=0.3)
    )
    wires = visible_edges(view, mesh.triangles)
    axes.add_collection(LineCollection(wires, colors=(0, 0, 0, 0.25), linewidths=0.35))

    extent = 1.06 * abs(view[:, :2]).max()
    axes.set(xlim=(-extent, extent), ylim=(-1.1 * extent, extent), aspect="equal")
    axes.axis("off")
    start = -0.98 * extent
    axes.plot([start, start + 0.5], [-1.05 * extent] * 2, color="black", lw=3)
    axes.text(start + 0.25, -1.02 * extent, "0.5 µm", ha="center", va="bottom")
    bar = figure.colorbar(scale, ax=axes, shrink=0.6, aspect=24, pad=0.02, extend="both")
    bar.set_label("mean curvature $C_1 + C_2$  (1/µm)")
    bar.outline.set_visible(False)


def draw_spectrum(axes, measured, vesicle):
    """⟨|u_lm|²⟩ against l with bars of 95 % confidence, and the line of (A17)."""
    kappa = vesicle.rigidity / KBT
    modes = measured["surface"].l[2:]
    line = np.geomspace(2, modes[-1], 200)
    axes.loglog(
        line,
        theory.fluid_spectrum(line, kappa),
        color="black",
        lw=1.2,
        zorder=1,
        label=r"theory, $\dfrac{k_BT/\kappa}{(l+2)(l+1)\,l\,(l-1)}$",
    )
    for name, style in (
        ("surface", {"color": "#b2182b", "ms": 5, "zorder": 3}),
        ("vertices", {"color": "#4393c3", "mfc": "white", "ms": 6, "zorder": 2}),
    ):
        mean = measured[name].mean[2:]
        low, high = (bound[2:] for bound in measured[name].interval())
        axes.errorbar(
            modes,
            mean,
            [mean - low, np.where(np.isfinite(high), high, 10 * mean) - mean],
            fmt="o",
            capsize=2.5,
            label=LABELS[name],
            **style,
        )
    axes.set_xlabel("mode number $l$")
    axes.set_ylabel(r"$\langle\, |u_{lm}|^2 \,\rangle$")
    ticks = [l for l in (2, 3, 4, 5, 6, 8, 10, 12) if l <= modes[-1]]
    axes.set_xticks(ticks, [str(l) for l in ticks])
    axes.minorticks_off()
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="upper right", title="bars: 95 % confidence")
    axes.set_title(
        rf"{vesicle.mesh.num_vertices} vertices,  $\kappa = {kappa:.3g}\,k_BT$,  "
        rf"$\Xi = {vesicle.softness:g}$,  $k_V = 0$",
        fontsize=11,
    )


def shaded_triangles(view, triangles, curvature, scale):
    """Small triangles from back to front, with their colours.

    Curvature and normal are interpolated between the corners of each triangle of the mesh, which
    makes a smooth picture of flat polygons.

    Returns
    -------
    corners : ndarray
        Shape (num_parts, 3, 2), in the plane of the picture.
    colours : ndarray
        Shape (num_parts, 3), red, green, blue.
    """
    weights = subdivision(PARTS)
    middle = weights.mean(axis=1)
    corners = np.einsum("scw,twi->tsci", weights, view[triangles]).reshape(-1, 3, 3)
    values = np.einsum("sw,tw->ts", middle, curvature[triangles]).ravel()
    normals = np.einsum("sw,twi->tsi", middle, vertex_normals(view, triangles)[triangles])
    normals = normals.reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1)[:, np.newaxis]

    # Blinn and Phong's light: diffuse, and a soft highlight half-way between light and viewer.
    light = np.array([-0.45, 0.55, 0.70])
    light /= np.linalg.norm(light)
    half = light + np.array([0, 0, 1])
    half /= np.linalg.norm(half)
    diffuse = np.clip(normals @ light, 0, 1)[:, np.newaxis]
    shine = np.clip(normals @ half, 0, 1)[:, np.newaxis] ** 40
    colours = scale.to_rgba(values)[:, :3] * (0.48 + 0.56 * diffuse) + 0.15 * shine

    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    order = order[facing[order]]
    return corners[order][:, :, :2], np.clip(colours[order], 0, 1)


def subdivision(parts):
    """The parts² triangles that a triangle is cut into, in barycentric coordinates.

    Shape (parts², 3 corners, 3 weights).
    """
    pieces = []
    for i in range(parts):
        for j in range(parts - i):
            pieces.append([(i, j), (i + 1, j), (i, j + 1)])
            if i + j < parts - 1:
                pieces.append([(i + 1, j), (i + 1, j + 1), (i, j + 1)])
    two = np.array(pieces) / parts
    return np.concatenate([1 - two.sum(axis=2, keepdims=True), two], axis=2)


def vertex_normals(vertices, triangles):
    """Unit normals of the vertices, means over the triangles weighted by area."""
    a, b, c = vertices[triangles.T]
    flat = np.cross(b - a, c - a)
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], flat)
    return normals / np.linalg.norm(normals, axis=1)[:, np.newaxis]


def visible_edges(view, triangles):
    """The edges of the triangles that face the viewer, shape (num_edges, 2 ends, 2)."""
    a, b, c = view[triangles.T]
    facing = triangles[np.cross(b - a, c - a)[:, 2] > 0]
    pairs = np.concatenate([facing[:, [i, (i + 1) % 3]] for i in range(3)])
    return view[np.unique(np.sort(pairs, axis=1), axis=0)][:, :, :2]


def view_rotation():
    """Turns the mesh a little, so that nobody looks along an axis of its coordinates."""
    a, b = math.radians(25), math.radians(-20)
    about_y = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    about_x = np.array([[1, 0, 0], [0, math.cos(b), -math.sin(b)], [0, math.sin(b), math.cos(b)]])
    return about_x @ about_y
