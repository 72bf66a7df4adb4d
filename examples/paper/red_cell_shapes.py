"""Measures of shapes for Fig. 8: how thick a disc is, how rough, and how far its normals agree."""

import numpy as np
from _snapshots import along_axes
from openmmhelfrich.analysis import vertex_quantities


def coherence(vertices, triangles):
    """How far the normals around each vertex agree: |Σ_t θ_t n_t| / Σ_t θ_t, see (B9).

    1 where the surface is flat; 0 where they cancel and the normal of the vertex is undefined.
    """
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    summed, angles = np.zeros(vertices.shape), np.zeros(len(vertices))
    for corner in range(3):
        first = corners[:, (corner + 1) % 3] - corners[:, corner]
        second = corners[:, (corner + 2) % 3] - corners[:, corner]
        across = np.linalg.norm(np.cross(first, second), axis=1)
        angle = np.arctan2(across, np.sum(first * second, axis=1))
        np.add.at(summed, triangles[:, corner], angle[:, np.newaxis] * normals)
        np.add.at(angles, triangles[:, corner], angle)
    return np.linalg.norm(summed, axis=1) / angles


def sheets(mesh, chosen):
    """Mean z of the upper and of the lower side among chosen vertices, nm, by their normals.

    NaN without a vertex on a side. So a cup, of which both sides may be above the middle, is
    measured too.
    """
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]] for corner in range(3))
    upward = np.cross(b - a, c - a)[:, 2]
    normal = np.zeros(mesh.num_vertices)
    for corner in range(3):
        np.add.at(normal, mesh.triangles[:, corner], upward)
    z = mesh.vertices[:, 2]
    return tuple(
        z[chosen & side].mean() if (chosen & side).any() else np.nan
        for side in (normal > 0, normal < 0)
    )


def thickness(mesh):
    """Diameter, and thickness in the middle and at its largest, of a disc along z, nm."""
    rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    upper, lower = sheets(mesh, rho < 0.15 * rho.max())
    rings = np.digitize(rho, np.linspace(0, rho.max(), 12))
    extents = []
    for ring in np.unique(rings):
        above, below = sheets(mesh, rings == ring)
        extents.append(above - below)
    return 2 * np.percentile(rho, 98), upper - lower, np.nanmax(extents)


def dimple(mesh):
    """The thickness in the middle over the largest one, of a mesh however it lies."""
    _, middle, rim = thickness(along_axes(mesh))
    return middle / rim


def dented(mesh):
    """The share of the area of vertices of negative mean curvature."""
    quantities = vertex_quantities(mesh.vertices, mesh.triangles)
    areas = quantities.barycentric_area
    return float(areas[quantities.mean_curvature() < 0].sum() / areas.sum())
