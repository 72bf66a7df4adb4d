"""Fig. 1: the four types of mesh: ordered, random, fluctuating ordered and fluctuating random.

Ordered meshes are icospheres; random ones have vertices of degree 5 to 7, those of degree 5 being
12 more than those of degree 7. Fluctuating ones have run for a short time with the potentials of
area, volume and heights, without changing neighbours. A mesh takes every softness up to Ξ_max, that
of its least height.
"""

import numpy as np
from _paper import Figure
from _snapshots import draw_meshes


def mesh_of(kind, num_vertices, softness, duration, seed):
    """Vertices and triangles of one type of mesh."""
    import openmmhelfrich as helfrich

    if "ordered" in kind:
        mesh = helfrich.Mesh.icosphere(round(((num_vertices - 2) / 10) ** 0.5), 1000.0)
    else:
        mesh = helfrich.Mesh.random_sphere(num_vertices, 1000.0, seed)
    if "fluctuating" in kind:
        mesh = mesh.fluctuating(softness, seed, duration)
    return {"vertices": mesh.vertices, "triangles": mesh.triangles}


def main():
    import openmmhelfrich as helfrich
    from openmmhelfrich.analysis import triangle_areas, triangle_heights

    figure = Figure("fig01", "Fig. 1", "The four types of mesh", __doc__)
    softness = 0.22
    kinds = ("ordered", "random", "fluctuating ordered", "fluctuating random")
    common = {"num_vertices": 1002, "softness": softness, "duration": 6.5, "seed": 1}
    results = figure.sweep(
        mesh_of, [{"kind": kind, **common} for kind in kinds], description="meshes"
    )
    figure.parameters(
        f"N = 1002, r0 = 1000 nm; fluctuating meshes after 6.5 τ_h at Ξ = {softness:g}, "
        "back on the sphere."
    )
    panels = []
    for kind, result in zip(kinds, results, strict=True):
        mesh = helfrich.Mesh(result["vertices"], result["triangles"])
        degrees = np.bincount(mesh.degrees, minlength=8)
        areas = triangle_areas(mesh.vertices, mesh.triangles)
        least = mesh.softness(triangle_heights(mesh.vertices, mesh.triangles).min())
        figure.claim(
            f"{kind}: N5 − N7",
            f"{degrees[5]} − {degrees[7]} = {degrees[5] - degrees[7]}, other degrees than 5 to 7: "
            f"{degrees.sum() - degrees[5:8].sum()}",
            "12, none",
            degrees[5] - degrees[7] == 12 and degrees[5:8].sum() == 1002,
        )
        text = f"{least:.3f}; areas spread by {100 * areas.std() / areas.mean():.0f} %"
        if "fluctuating" in kind:
            # Heights rarely get far below d: there each costs ε/4 = kBT and soon more.
            near = 0.5 * softness < least < 1.5 * softness
            figure.claim(f"{kind}: Ξ_max", text, f"near {softness:g}", near)
        else:
            figure.note(f"{kind}: Ξ_max {text}.")
        panels.append((kind, mesh, areas / areas.mean()))
    path = figure.picture("", "The four types of mesh, coloured by the area of the triangles.")
    draw_meshes(path, panels, 4, label="area / mean area", size=260)
    figure.finish()


if __name__ == "__main__":
    main()
