"""Pictures of meshes for the figures, rendered off screen with PyVista."""

from __future__ import annotations

import math

import numpy as np
from _paper import shrink
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

COLOURS = "RdYlBu_r"


def draw_meshes(path, panels, columns, label=None, size=300, views=None, edges=True):
    """Write a picture of several meshes side by side, all at the same scale in a row.

    Parameters
    ----------
    path : str or Path
        A PNG file.
    panels : list of (str, Mesh, ndarray or None)
        Title, mesh, and a value for each vertex or triangle that colours it.
    columns : int
        Panels in a row.
    label : str, optional
        What the colours show; without it there is no bar of colours.
    size : int
        Width of a panel, pixels.
    views : list of str, optional
        For each panel "tilted" (default) or "cut": the half behind the plane of x and z.
    edges : bool
        Whether to draw the edges of the triangles.
    """
    views = views or ["tilted"] * len(panels)
    values = [scalars for _, _, scalars in panels if scalars is not None]
    limits = tuple(np.percentile(np.concatenate(values), (3, 97))) if values else None
    rows = math.ceil(len(panels) / columns)
    # Labels are drawn by matplotlib, whose fonts have Greek letters.
    picture = Figure(figsize=(columns * size / 100, rows * (size + 20) / 100), layout="constrained")
    axes = np.atleast_1d(picture.subplots(rows, columns)).ravel()
    for axis in axes:
        axis.axis("off")
    for axis, (title, mesh, scalars), view in zip(axes, panels, views, strict=False):
        axis.imshow(render(mesh, scalars, limits, view, size, edges))
        axis.set_title(title, fontsize=max(5, size / 28))
    if label:
        bar = picture.colorbar(
            ScalarMappable(Normalize(*limits), COLOURS), ax=list(axes), shrink=0.6
        )
        bar.set_label(label)
    picture.savefig(path, dpi=100)
    shrink(path)


def along_axes(mesh):
    """The mesh about its centre, its shortest principal axis along z and its longest along x."""
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    if np.linalg.det(axes) < 0:
        axes[2] *= -1
    return mesh.translated(-mesh.vertices.mean(axis=0)).rotated(axes)


def extent_of(mesh):
    """The largest distance from the middle of a mesh, and some more, nm."""
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    return 1.06 * np.linalg.norm(mesh.vertices - middle, axis=1).max()


def render(mesh, scalars, limits, view, size, edges, extent=None):
    """One mesh as an image, shape (size, size, 3); half of it shows `extent`, nm, or all."""
    try:
        import pyvista
    except ImportError:
        raise SystemExit("the pictures need PyVista: install openmm-helfrich[paper]") from None
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    points = mesh.vertices - middle
    surface = pyvista.PolyData(points, np.insert(mesh.triangles, 0, 3, axis=1).ravel())
    if scalars is not None:
        data = surface.point_data if len(scalars) == mesh.num_vertices else surface.cell_data
        data["values"] = scalars
    if view == "cut":
        surface = surface.clip(normal="y", origin=(0, 0, 0), invert=False)
    plotter = pyvista.Plotter(off_screen=True, window_size=(size, size))
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_mesh(
        surface,
        scalars=None if scalars is None else "values",
        clim=limits,
        cmap=COLOURS,
        color="#d9b08c" if scalars is None else None,
        show_edges=edges,
        edge_color="#333333",
        line_width=0.8,
        show_scalar_bar=False,
    )
    extent = extent or extent_of(mesh)
    direction = np.array((0.0, -1.0, 0.0) if view == "cut" else (0.3, -1.0, 0.55))
    direction /= np.linalg.norm(direction)
    camera = plotter.camera
    camera.focal_point = (0, 0, 0)
    camera.position = tuple(5 * extent * direction)
    camera.up = (0, 0, 1)
    camera.parallel_projection = True
    camera.parallel_scale = extent
    camera.clipping_range = (0.1 * extent, 20 * extent)
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return image
