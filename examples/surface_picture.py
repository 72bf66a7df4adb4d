"""A picture of a surface, whole triangles of a periodic one, which the examples share."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection


def draw(path, panels, beads=(), view=(25, -60)):
    """Write a PNG with a panel for each mesh.

    Parameters
    ----------
    path : Path
    panels : mapping of str to Mesh
        Meshes by their titles.
    beads : sequence of (centre, radius)
        Spheres to draw with each mesh, nm.
    view : tuple of float
        Elevation and azimuth, degrees.
    """
    figure = plt.figure(figsize=(4.6 * len(panels), 4.2), layout="constrained")
    light = np.array([0.3, -0.4, 0.85])
    for place, (title, mesh) in enumerate(panels.items(), start=1):
        axes = figure.add_subplot(1, len(panels), place, projection="3d")
        vertices, triangles = mesh.unfolded()
        corners = vertices[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        shade = 0.35 + 0.65 * abs(normals @ light)[:, np.newaxis]
        colours = np.clip(shade * np.array([0.93, 0.62, 0.38]), 0, 1)
        axes.add_collection3d(
            Poly3DCollection(corners, facecolors=colours, edgecolors=(0, 0, 0, 0.3), linewidths=0.2)
        )
        for centre, radius in beads:
            axes.plot_surface(*sphere(centre, radius), color="#4f77aa", linewidth=0)
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        for centre, radius in beads:
            low, high = np.minimum(low, np.subtract(centre, radius)), np.maximum(high, radius)
        extent = np.maximum(high - low, 0.2 * (high - low).max())
        for axis, at, size in zip("xyz", (low + high) / 2, extent / 2, strict=True):
            getattr(axes, f"set_{axis}lim")(at - size, at + size)
        axes.set_box_aspect(extent, zoom=1.5)
        axes.view_init(*view)
        axes.set_axis_off()
        axes.set_title(title, fontsize=10)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def sphere(centre, radius):
    """x, y and z of a grid on a sphere."""
    polar, azimuth = np.mgrid[0 : np.pi : 24j, 0 : 2 * np.pi : 48j]
    unit = np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)
    return [c + radius * u for c, u in zip(centre, unit, strict=True)]
