"""Supplement IV: areas and bond lengths of vertices with five, six and seven neighbours.

The random meshes of `sm03_distributions.py`, N and Ξ as there, in their last half. A vertex has a
third of the area of its triangles, and the mean length of its bonds; both are given over the mean
of all. What symmetry demands of n neighbours that are alike: the n triangles of a vertex have the
angle 2π/n each, so that their mean area is ½ l² sin(2π/n), which ties the bonds of a vertex to its
area. Were all triangles alike, areas would be as n; in cellular patterns they are linear in n with
another slope (Lewis' law). Sums over all degrees have to give the area and all bonds of the mesh.
"""

import matplotlib.pyplot as plt
import numpy as np
from _paper import Figure, mean_and_error
from openmmhelfrich import Mesh
from openmmhelfrich.analysis import edge_lengths, triangle_areas
from sm03_distributions import distributions, points_of, times_of

DEGREES = (5, 6, 7)


def by_degree(vertices, triangles):
    """Mean area and bond length of vertices of each degree, over those of all, and their numbers.

    Parameters
    ----------
    vertices : ndarray
        Shape (num_frames, num_vertices, 3), nm.
    triangles : ndarray
        Shape (num_triangles, 3).

    Returns
    -------
    dict
        "number", "area" and "length" of DEGREES, shape (3,); "area_sum", Σ over degrees of number
        and area, over N; "length_sum", Σ of number, degree and length, over 2 E.
    """
    vertices = np.asarray(vertices, dtype=float)
    mesh = Mesh(vertices[0], triangles)
    # A Mesh may turn triangles outward; its edges are in the order of `edge_lengths`.
    degrees = np.asarray(mesh.degrees)
    count = mesh.num_vertices
    areas = triangle_areas(vertices, mesh.triangles)
    lengths = edge_lengths(vertices, mesh.triangles)
    corners, ends = np.asarray(mesh.triangles).ravel(), np.asarray(mesh.edges).ravel()
    area = np.mean(
        [np.bincount(corners, np.repeat(one / 3, 3), count) * count / one.sum() for one in areas],
        axis=0,
    )
    length = np.mean(
        [np.bincount(ends, np.repeat(one, 2), count) / degrees / one.mean() for one in lengths],
        axis=0,
    )
    chosen = [degrees == degree for degree in DEGREES]
    number = np.array([some.sum() for some in chosen])
    found = {
        "number": number,
        "area": np.array([area[some].mean() for some in chosen]),
        "length": np.array([length[some].mean() for some in chosen]),
    }
    found["area_sum"] = number @ found["area"] / count
    found["length_sum"] = (number * DEGREES) @ found["length"] / (2 * len(mesh.edges))
    return found


def bond_of(area, degree):
    """The bond length that symmetry gives a vertex of an area, up to a factor: l² n sin(2π/n)."""
    return np.sqrt(area / (degree * np.sin(2 * np.pi / degree)))


def main():
    figure = Figure("sm04", "SM IV", "Areas and bonds of vertices by degree", __doc__)
    points = [point for point in points_of(figure.quick) if point["kind"] == "random"]
    runs = figure.sweep(distributions, points, description="runs")
    first = times_of(points[0]["times"][-1])[2]
    found = [by_degree(run["vertices"][first:], run["triangles"]) for run in runs]
    figure.parameters(
        f"N = {points[0]['num_vertices']}, Ξ = {points[0]['softness']:g}, {len(runs)} random "
        f"meshes with U_A, U_V and U_h, Verlet, from {points[0]['times'][first]:g} to "
        f"{points[0]['times'][-1]:g} τ_h."
    )
    numbers = np.array([one["number"] for one in found])
    surplus = numbers[:, 0] - numbers[:, 2]
    figure.claim(
        "N5 − N7 of each mesh",
        ", ".join(map(str, sorted(set(surplus.tolist())))),
        "12",
        (surplus == 12).all(),
    )
    for name, what in (("area_sum", "areas"), ("length_sum", "bond lengths")):
        worst = max((one[name] for one in found), key=lambda value: abs(value - 1))
        figure.check(f"{what} summed over degrees, over that of the mesh", worst, 1, 1e-6)
    area, area_error = mean_and_error([one["area"] for one in found])
    length, length_error = mean_and_error([one["length"] for one in found])
    symmetric(figure, found)
    linear(figure, found)
    for degree, value, error in zip(DEGREES, area, area_error, strict=True):
        figure.check(
            f"area of degree {degree} over n/6, all triangles alike",
            value / (degree / 6),
            1,
            0.03,
            error / (degree / 6),
            why="a vertex with few neighbours moves in a small plaquette, and its triangles are "
            "smaller too: areas follow Lewis' law, above, with a steeper slope",
        )
    figure.table(
        "Over the mean of all vertices and of all bonds:",
        ["degree", "vertices in a mesh", "area", "area of a triangle", "bond length"],
        [
            [
                str(degree),
                f"{numbers[:, place].mean():.0f}",
                f"{area[place]:.4f} ± {area_error[place]:.4f}",
                f"{6 * area[place] / degree:.4f} ± {6 * area_error[place] / degree:.4f}",
                f"{length[place]:.4f} ± {length_error[place]:.4f}",
            ]
            for place, degree in enumerate(DEGREES)
        ],
    )
    draw(figure, area, area_error, length, length_error)
    figure.finish()


def symmetric(figure, found):
    """Bond lengths of degrees 5 and 7 over those of 6, beside what areas and symmetry say."""
    for place, degree in ((0, 5), (2, 7)):
        measured = [one["length"][place] / one["length"][1] for one in found]
        expected = [
            bond_of(one["area"][place], degree) / bond_of(one["area"][1], 6) for one in found
        ]
        value, error = mean_and_error(np.divide(measured, expected))
        figure.check(
            f"bonds of degree {degree} over those of 6, over that of n alike triangles of its area",
            value,
            1,
            0.02,
            error,
        )


def linear(figure, found):
    """Lewis' law: areas are linear in the degree."""
    bends = [(one["area"][0] + one["area"][2]) / 2 - one["area"][1] for one in found]
    slopes = [(one["area"][2] - one["area"][0]) / 2 for one in found]
    bend, error = mean_and_error(bends)
    slope, slope_error = mean_and_error(slopes)
    figure.check("area, mean of degrees 5 and 7 less that of 6", bend, 0, 0.02, error)
    figure.note(
        f"Area grows by {slope:.3f} ± {slope_error:.3f} of the mean for each neighbour; were all "
        f"triangles alike, by {1 / 6:.3f}."
    )


def draw(figure, area, area_error, length, length_error):
    page, axes = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
    degrees = np.array(DEGREES)
    axes[0].errorbar(degrees, area, area_error, fmt="o", label="measured")
    axes[0].plot(degrees, degrees / 6, "k-", lw=0.8, label="all triangles alike, n/6")
    axes[0].set(ylabel="area / mean")
    axes[1].errorbar(degrees, length, length_error, fmt="o", label="measured")
    symmetric_bonds = bond_of(area, degrees) / bond_of(area[1], 6) * length[1]
    axes[1].plot(degrees, symmetric_bonds, "k_", ms=14, label="n alike triangles of that area")
    axes[1].set(ylabel="bond length / mean")
    for axis in axes:
        axis.set(xlabel="degree n", xticks=degrees)
        axis.legend(fontsize=8)
    figure.save(page, caption="Mean area and bond length of vertices against their degree")


if __name__ == "__main__":
    main()
