"""Figs. 16–19: the energy of a mesh as a function of the place of one vertex.

One vertex of a regular sphere is moved over the sphere and over a plane perpendicular to it, on
grids of 320 × 320 points; all others stay. Shown are the potentials of area, volume and heights,
the four bending models, and the four totals. Over the edge of the plaquette that its neighbours
span, triangles fold over. There the Voronoi areas of a bending model can be negative, and so can
its energy: pits of negative energy into which vertices fall. Barycentric areas are positive.
"""

import numpy as np
from _paper import SCHEMES, Figure
from openmmhelfrich.sweep import grid

AUXILIARY = ("area", "volume", "heights")
SOFTNESS = 0.037
VERTEX = 500


def landscape_of(surface, row, rows, size, subdivision, half_width):
    """Some rows of the landscapes of all potentials.

    Parameters
    ----------
    surface : str
        "sphere" or "plane".
    row, rows : int
        The first row of the grid, and how many.
    size : int
        Rows and columns of the grid.
    subdivision : int
        n of N = 10 n² + 2.
    half_width : float
        Of the grid, nm.

    Returns
    -------
    dict
        Energies of each potential less those of the mesh itself, shape (rows, size), kJ/mol;
        "bending_of_mesh", shape (4,), kJ/mol; "axis", shape (size,), "points", shape (rows, size,
        3), the neighbours "ring", shape (degree, 3), and the "vertex", shape (3,), all in nm.
    """
    import openmmhelfrich as helfrich
    from openmmhelfrich.analysis import landscape, plane_grid, sphere_grid

    mesh = helfrich.Mesh.icosphere(subdivision, 1000.0)
    vesicle = helfrich.Vesicle(mesh, softness=SOFTNESS)
    vesicle.system()
    forces = {name: vesicle.placement.forces[name] for name in AUXILIARY}
    for scheme in SCHEMES:
        kind = getattr(helfrich.BendingForce, scheme)
        forces[scheme] = helfrich.BendingForce(mesh, vesicle.rigidity, scheme=kind)
    vertex = VERTEX % mesh.num_vertices
    make = {"sphere": sphere_grid, "plane": plane_grid}[surface]
    cut = make(mesh, vertex, half_width, size)
    energies = landscape(mesh, forces, vertex, cut.points[row : row + rows])
    edges = mesh.edges[(mesh.edges == vertex).any(axis=1)].ravel()
    ring = mesh.vertices[np.unique(edges[edges != vertex])]
    return {
        **{name: energies[name] - mesh.energy(force) for name, force in forces.items()},
        "bending_of_mesh": np.array([mesh.energy(forces[scheme]) for scheme in SCHEMES]),
        "axis": cut.u,
        "points": cut.points[row : row + rows],
        "ring": ring,
        "vertex": mesh.vertices[vertex],
    }


def inside_plaquette(points, ring, vertex):
    """Whether points lie, seen from the centre of the sphere, in the polygon of the neighbours."""
    normal = vertex / np.linalg.norm(vertex)
    first = ring[0] - (ring[0] @ normal) * normal
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)

    def flat(places):
        """Central projection on the plane that touches the sphere at the vertex."""
        scale = np.linalg.norm(vertex) / (places @ normal)
        return np.stack([(places @ first) * scale, (places @ second) * scale], axis=-1)

    corners = flat(ring)
    corners = corners[np.argsort(np.arctan2(corners[:, 1], corners[:, 0]))]
    ahead = np.roll(corners, -1, axis=0) - corners
    offset = flat(points)[..., np.newaxis, :] - corners
    return (ahead[:, 0] * offset[..., 1] - ahead[:, 1] * offset[..., 0] >= 0).all(axis=-1)


def main():
    import matplotlib.pyplot as plt

    figure = Figure("fig16", "Figs. 16–19", "Energy landscapes of a single vertex", __doc__)
    size, rows = figure.choose(320, 60), 20
    half_width = 250.0
    points = grid(
        surface=["sphere", "plane"],
        row=range(0, size, rows),
        rows=[rows],
        size=[size],
        subdivision=[10],
        half_width=[half_width],
    )
    results = figure.sweep(landscape_of, points, description="landscapes")
    figure.parameters(
        f"Icosphere of N = 1002, r0 = 1000 nm, κ = 20 kBT, Ξ = {SOFTNESS:g} and the moduli of the "
        f"paper, grids of {size} × {size} points within ± {half_width:g} nm, energies relative to "
        "the mesh itself. Outside of the plaquette means: seen from the centre of the sphere."
    )
    for surface in ("sphere", "plane"):
        mine = [
            result
            for point, result in zip(points, results, strict=True)
            if point["surface"] == surface
        ]
        maps = {
            name: np.concatenate([result[name] for result in mine])
            for name in (*AUXILIARY, *SCHEMES)
        }
        places = np.concatenate([result["points"] for result in mine])
        outside = ~inside_plaquette(places, mine[0]["ring"], mine[0]["vertex"])
        auxiliary = sum(maps[name] for name in AUXILIARY)
        for index, (scheme, label) in enumerate(SCHEMES.items()):
            # The whole bending energy of the mesh, so that negative means negative.
            whole = maps[scheme] + mine[0]["bending_of_mesh"][index]
            lowest = np.nanmin(np.where(outside, whole, np.nan))
            share = np.nanmean(np.where(outside, whole < 0, np.nan))
            deepest = np.nanmin(np.where(outside, maps[scheme] + auxiliary, np.nan))
            voronoi = scheme in ("GompperKroll", "JulicherVoronoi")
            if voronoi:
                # Where areas are positive, so is this energy, whatever the mesh.
                figure.claim(
                    f"{surface}, {label}: E_b outside of the plaquette",
                    f"at least {lowest:.3g} kJ/mol, negative at {100 * share:.2g} % of the points",
                    "pits of negative energy",
                    lowest < 0,
                )
            figure.claim(
                f"{surface}, {label}: total energy outside of the plaquette",
                f"down to {-deepest:.3g} kJ/mol below the mesh's"
                if deepest < 0
                else f"at least {deepest:.3g} kJ/mol above the mesh's",
                "pits below the mesh's" if voronoi else "nowhere below the mesh's",
                (deepest < 0) if voronoi else (deepest > 0),
            )
            maps["total " + scheme] = maps[scheme] + auxiliary
        _draw(plt, figure, surface, maps, outside, mine[0]["axis"])
    figure.finish()


def _draw(plt, figure, surface, maps, outside, axis):
    names = [*AUXILIARY, None, *SCHEMES, *("total " + scheme for scheme in SCHEMES)]
    graph, panels = plt.subplots(3, 4, figsize=(9.5, 7), layout="constrained")
    for panel, name in zip(panels.flat, names, strict=True):
        if name is None:
            panel.axis("off")
            continue
        picture = panel.pcolormesh(
            axis,
            axis,
            np.clip(maps[name], -1e7, 1e7),
            norm=_norm(),
            cmap="RdBu_r",
            shading="nearest",
            rasterized=True,
        )
        panel.contour(axis, axis, outside, [0.5], colors="black", linewidths=0.6)
        panel.set_aspect("equal")
        scheme = name.removeprefix("total ")
        title = SCHEMES.get(scheme, name)
        panel.set_title(title if scheme == name else f"total, {title}", fontsize=8)
        panel.tick_params(labelsize=6)
    graph.colorbar(picture, ax=panels, label="E − E(mesh) (kJ/mol)", shrink=0.6)
    graph.supxlabel("u (nm), along the sphere", fontsize=8)
    up = "v (nm), along the sphere" if surface == "sphere" else "v (nm), outward"
    graph.supylabel(up, fontsize=8)
    caption = {
        "sphere": "The vertex moved over the sphere. Black: the plaquette of its neighbours.",
        "plane": "The vertex moved over a perpendicular plane. Black: the cone of the plaquette.",
    }
    figure.save(graph, f"_{surface}", caption[surface])
    plt.close(graph)


def _norm():
    from matplotlib.colors import SymLogNorm

    return SymLogNorm(linthresh=10, vmin=-1e5, vmax=1e5)


if __name__ == "__main__":
    main()
