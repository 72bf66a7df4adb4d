"""Pictures of meshes for the figures, rendered off screen with PyVista."""

from __future__ import annotations

import math

import numpy as np
from _paper import shrink

MISSING = "the snapshots need PyVista: install openmm-helfrich[paper]"


def draw_meshes(path, panels, columns, label=None, size=300, views=None, edges=True):
    """Write a picture of several meshes side by side.

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
        For each panel "tilted" (default) or "cut": the half behind a plane through the axis that is
        shortest, seen from the side.
    edges : bool
        Whether to draw the edges of the triangles.
    """
    try:
        import pyvista
    except ImportError:
        raise ImportError(MISSING) from None
    rows = math.ceil(len(panels) / columns)
    plotter = pyvista.Plotter(
        off_screen=True,
        shape=(rows, columns),
        window_size=(columns * size, rows * size),
        border=False,
    )
    plotter.set_background("white")
    values = [scalars for _, _, scalars in panels if scalars is not None]
    limits = _limits(np.concatenate(values)) if values else None
    for index, (title, mesh, scalars) in enumerate(panels):
        plotter.subplot(index // columns, index % columns)
        surface = _surface(pyvista, mesh, scalars)
        view = views[index] if views else "tilted"
        if view == "cut":
            surface = surface.clip(normal="y", origin=(0, 0, 0), invert=False)
        plotter.add_mesh(
            surface,
            scalars=None if scalars is None else "values",
            clim=limits,
            cmap="RdYlBu_r",
            color="#d9b08c" if scalars is None else None,
            show_edges=edges,
            edge_color="#444444",
            line_width=0.6,
            smooth_shading=False,
            show_scalar_bar=label is not None and index == len(panels) - 1,
            scalar_bar_args={"title": label, "color": "black", "vertical": False, "n_labels": 3}
            if label
            else None,
        )
        place = {"position": (0.03, 0.9), "viewport": True}
        plotter.add_text(title, font_size=9, color="black", **place)
        extent = 1.15 * np.linalg.norm(mesh.vertices - mesh.vertices.mean(axis=0), axis=1).max()
        direction = (0.0, -1.0, 0.0) if view == "cut" else (0.35, -1.0, 0.45)
        plotter.camera.focal_point = (0, 0, 0)
        plotter.camera.position = tuple(
            5 * extent * np.array(direction) / np.linalg.norm(direction)
        )
        plotter.camera.up = (0, 0, 1)
        plotter.camera.parallel_projection = True
        plotter.camera.parallel_scale = extent
        plotter.camera.clipping_range = (0.1 * extent, 20 * extent)
    plotter.screenshot(path)
    plotter.close()
    shrink(path)


def along_axes(mesh):
    """The mesh about its centre, its shortest principal axis along z and its longest along x."""
    centred = mesh.vertices - mesh.vertices.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    if np.linalg.det(axes) < 0:
        axes[2] *= -1
    return mesh.translated(-mesh.vertices.mean(axis=0)).rotated(axes)


def _surface(pyvista, mesh, scalars):
    faces = np.insert(mesh.triangles, 0, 3, axis=1).ravel()
    surface = pyvista.PolyData(mesh.vertices - mesh.vertices.mean(axis=0), faces)
    if scalars is not None:
        data = surface.point_data if len(scalars) == mesh.num_vertices else surface.cell_data
        data["values"] = scalars
    return surface


def _limits(values):
    return tuple(np.percentile(values, (3, 97)))
