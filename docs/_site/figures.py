"""A figure for each energy: what it measures, and its energy as the package computes it.

A force without a figure here has the energy of its example over the size of the mesh.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import openmm
import openmmhelfrich as helfrich
from matplotlib.patches import Circle, FancyArrowPatch, Polygon

from . import examples

_GREY, _FILL, _MARK = "#9aa5b1", "#e8eef5", "#c2410c"
_STYLE = {
    "svg.hashsalt": "openmm-helfrich",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.color": _MARK,
    "axes.prop_cycle": mpl.cycler(
        color=[_MARK, "#1d4ed8", "#15803d", "#7e22ce", "#64748b"],
    ),
}


# --- What is measured ---


def _patch():
    """A vertex with two rings of neighbours, a little uneven, in the plane."""
    mesh = helfrich.Mesh.disk(2, 1.0)
    points = mesh.vertices[:, :2] + np.random.default_rng(3).normal(scale=0.05, size=(19, 2))
    return points, mesh.triangles


def _draw_patch(ax, colours=None):
    points, triangles = _patch()
    for k, corners in enumerate(triangles):
        fill = _FILL if colours is None else colours(k, corners)
        ax.add_patch(Polygon(points[corners], facecolor=fill, edgecolor=_GREY, lw=0.8))
    return points, triangles


def _whole(ax, letter):
    points, _ = _draw_patch(ax, lambda k, corners: "#fed7aa")
    _say(ax, points[0], letter)


def _volume(ax, letter):
    ax.add_patch(Polygon(_outline(), facecolor="#fed7aa", edgecolor=_GREY, lw=2))
    _say(ax, (0, 0), letter)


def _arrows(ax, letter):
    """A pressure from inside."""
    _volume(ax, letter)
    outline = _outline()
    for point in outline[:-1:8]:
        ax.add_patch(
            FancyArrowPatch(
                0.78 * point, 0.98 * point, arrowstyle="-|>", mutation_scale=8, color=_MARK
            )
        )


def _osmotic(ax, letter):
    _volume(ax, letter)
    rng = np.random.default_rng(2)
    inside = rng.uniform(-0.55, 0.55, size=(14, 2))
    angle = rng.uniform(0, 2 * np.pi, 9)
    outside = 1.05 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ax.plot(*inside[np.linalg.norm(inside, axis=1) > 0.25].T, "o", ms=3, color=_MARK)
    ax.plot(*outside.T, "o", ms=3, color="#1d4ed8")


def _outline():
    angle = np.linspace(0, 2 * np.pi, 97)
    radius = 0.85 + 0.08 * np.cos(2 * angle) + 0.03 * np.cos(3 * angle)
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _round_the_vertex(points, triangles):
    """The corners of the triangles at vertex 0, from there on."""
    for corners in triangles:
        if 0 in corners:
            yield points[np.roll(corners, -int(np.flatnonzero(corners == 0)[0]))]


def _ring(ax, letter):
    """A vertex, its edges and the triangles around it."""
    points, triangles = _draw_patch(ax, lambda k, corners: "#fed7aa" if 0 in corners else _FILL)
    for other in {int(v) for corners in triangles if 0 in corners for v in corners} - {0}:
        ax.plot(*points[[0, other]].T, color=_MARK, lw=1.5)
    ax.plot(*points[0], "o", color=_MARK, ms=5)
    _say(ax, points[0] + (0.62, 0.2), letter)


def _plaquette(ax, letter):
    """A third of the triangles around a vertex."""
    points, triangles = _draw_patch(ax)
    for a, b, c in _round_the_vertex(points, triangles):
        corner = [a, (a + b) / 2, (a + b + c) / 3, (a + c) / 2]
        ax.add_patch(Polygon(corner, facecolor="#fed7aa", edgecolor="none"))
        ax.plot(*np.transpose(corner[1:]), color=_MARK, lw=1.2)
    ax.plot(*points[0], "o", color=_MARK, ms=5)
    _say(ax, points[0] + (0.12, 0.1), letter)


def _triangle(ax, letter):
    points, triangles = _draw_patch(ax, lambda k, corners: "#fed7aa" if k == 0 else _FILL)
    _say(ax, points[triangles[0]].mean(axis=0), letter)


def _heights(ax, letter):
    corners = np.array([[-0.8, -0.5], [0.8, -0.5], [0.25, 0.6]])
    ax.add_patch(Polygon(corners, facecolor=_FILL, edgecolor=_GREY, lw=1.2))
    for k in range(3):
        a, b, c = np.roll(corners, -k, axis=0)
        along = (c - b) / np.linalg.norm(c - b)
        foot = b + along * ((a - b) @ along)
        ax.plot(*np.stack([a, foot]).T, color=_MARK, lw=1.2, ls="--")
    _say(ax, (0.36, -0.36), letter)


def _edge(ax, letter):
    """An edge between two triangles, seen along it and from above."""
    ax.add_patch(
        Polygon([[-1, 0.15], [0, 0.6], [0, 1.1], [-1, 0.65]], facecolor=_FILL, edgecolor=_GREY)
    )
    ax.add_patch(
        Polygon([[0, 0.6], [1, 0.15], [1, 0.65], [0, 1.1]], facecolor="#dbe4ee", edgecolor=_GREY)
    )
    ax.plot([0, 0], [0.6, 1.1], color=_MARK, lw=2)
    ends = np.array([[-1.0, -0.95], [0.0, -0.4], [1.0, -0.95]])
    ax.plot(*ends.T, color="#475569", lw=2)
    for a, b in (ends[:2], ends[1:]):
        middle, normal = (a + b) / 2, np.array([-(b - a)[1], (b - a)[0]])
        tip = middle + 0.45 * normal / np.linalg.norm(normal)
        ax.add_patch(
            FancyArrowPatch(middle, tip, arrowstyle="-|>", mutation_scale=8, color="#475569")
        )
    ax.plot([0, 0.6], [-0.4, -0.07], color="#475569", lw=0.8, ls=":")
    _say(ax, (0.32, -0.4), letter)


def _border(ax, letter):
    points, _ = _draw_patch(ax)
    outer = points[7:][np.argsort(np.arctan2(*points[7:].T[::-1]))]
    ax.add_patch(Polygon(outer, fill=False, edgecolor=_MARK, lw=2.2))
    _say(ax, 1.18 * outer[1], letter)


def _angles(ax, letter):
    points, triangles = _draw_patch(ax)
    for a, b, c in _round_the_vertex(points, triangles):
        steps = np.linspace(0, 1, 9)[:, None]
        arc = a + 0.2 * _unit((1 - steps) * _unit(b - a) + steps * _unit(c - a))
        ax.plot(*arc.T, color=_MARK, lw=1.4)
    _say(ax, points[0] + (0.32, 0.08), letter)


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _line(ax, letter):
    points, triangles = _patch()
    kind = points[:, 0] + 0.3 * points[:, 1] > 0.15
    _draw_patch(ax)
    for corners in triangles:
        mixed = [
            (points[a] + points[b]) / 2
            for a, b in zip(corners, np.roll(corners, -1), strict=True)
            if kind[a] != kind[b]
        ]
        if mixed:
            ax.plot(*np.transpose(mixed), color=_MARK, lw=2)
    for side, colour in ((kind, "#1d4ed8"), (~kind, "#15803d")):
        ax.plot(*points[side].T, "o", ms=5, color=colour)
    _say(ax, (0.02, -1.13), letter)


def _reference(ax, letter):
    rest = np.array([[-0.95, -0.3], [-0.15, -0.3], [-0.55, 0.4]])
    now = np.array([[0.0, -0.45], [1.05, -0.3], [0.6, 0.35]])
    ax.add_patch(Polygon(rest, facecolor=_FILL, edgecolor=_GREY, ls="--"))
    ax.add_patch(Polygon(now, facecolor="#fed7aa", edgecolor=_MARK))
    ax.add_patch(
        FancyArrowPatch(
            (-0.25, 0.25), (0.25, 0.25), arrowstyle="-|>", mutation_scale=9, color="#475569"
        )
    )
    ax.text(-0.55, -0.5, "reference", ha="center", va="top", color="#475569")
    ax.text(0.55, -0.6, letter, ha="center", va="top", color=_MARK)


def _spring(ax, letter):
    points, triangles = _draw_patch(ax)
    a, b = points[0], points[triangles[0][1 if triangles[0][0] == 0 else 0]]
    along, across = b - a, np.array([-(b - a)[1], (b - a)[0]])
    steps = np.linspace(0, 1, 61)
    wave = np.where((steps > 0.15) & (steps < 0.85), np.sin(steps * 14 * np.pi), 0)
    ax.plot(*(a + steps[:, None] * along + 0.14 * wave[:, None] * across).T, color=_MARK, lw=1.5)
    _say(ax, (a + b) / 2 + 0.35 * across, letter)


def _contact(ax, letter):
    x = np.linspace(-1, 1, 50)
    ax.plot(x, 0.22 + 0.25 * x**2, color="#475569", lw=2.5)
    ax.plot(x, -0.22 - 0.25 * x**2, color="#475569", lw=2.5)
    ax.annotate("", (0, -0.21), (0, 0.21), arrowprops={"arrowstyle": "<->", "color": _MARK})
    _say(ax, (0.12, 0), letter)


def _bead(ax, letter):
    x = np.linspace(-1, 1, 50)
    ax.plot(x, -0.45 - 0.1 * np.exp(-6 * x**2), color="#475569", lw=2.5)
    ax.add_patch(Circle((0, 0.35), 0.55, facecolor="#fed7aa", edgecolor=_MARK))
    ax.annotate("", (0, -0.54), (0, -0.19), arrowprops={"arrowstyle": "<->", "color": _MARK})
    _say(ax, (0.14, -0.37), letter)


def _say(ax, where, text):
    ax.text(*where, text, ha="center", va="center", color="#111827", fontsize=11, style="italic")


# --- Energies, by the package ---


def _sphere():
    return helfrich.Mesh.icosphere(4, 100)


def _one_triangle(corners):
    return helfrich.Mesh(np.array(corners, float), [[0, 1, 2]])


def _stretched(l1, l2):
    """A triangle of equal sides at rest and stretched, for forces with a reference."""
    rest = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]])
    return _one_triangle(rest), _one_triangle(rest * (l1, l2, 1))


def _energies(ax, force, meshes, x, label=None, unit=1.0, **style):
    """A curve of the energies of `force(mesh)`."""
    y = [mesh.energy(force(mesh)) / unit for mesh in meshes]
    ax.plot(x, y, label=label, **style)


def _scaled(ax, force, power, label, unit, low=0.8, high=1.2):
    """Over a sphere that grows, whose measure goes with a power of its radius."""
    mesh = _sphere()
    x = np.linspace(low, high, 25)
    meshes = [mesh.scaled(v ** (1 / power)) for v in x]
    _energies(ax, lambda m: force(m, mesh), meshes, x, unit=unit(mesh))
    ax.set_xlabel(label)


def _area(ax):
    _scaled(
        ax, lambda m, at_rest: helfrich.SurfaceAreaForce(m, 1, at_rest.area), 2, "A / A₀",
        lambda m: m.area,
    )  # fmt: skip
    ax.set_ylabel("E / k A₀")


def _enclosed(ax):
    _scaled(
        ax, lambda m, at_rest: helfrich.EnclosedVolumeForce(m, 1, at_rest.volume), 3, "V / V₀",
        lambda m: m.volume,
    )  # fmt: skip
    ax.set_ylabel("E / k V₀")


def _pressure(ax):
    _scaled(ax, lambda m, _: helfrich.PressureForce(m, 1), 3, "V / V₀", lambda m: m.volume)
    ax.set_ylabel("E / p V₀")


def _tension(ax):
    _scaled(ax, lambda m, _: helfrich.SurfaceTensionForce(m, 1), 2, "A / A₀", lambda m: m.area)
    ax.set_ylabel("E / σ A₀")


def _osmosis(ax):
    _scaled(
        ax, lambda m, at_rest: helfrich.OsmoticPressureForce(m, at_rest.volume, 1, 1), 3,
        "c V / n", lambda m: m.volume, 0.4, 2,
    )  # fmt: skip
    ax.set_ylabel("E / n kT")


def _bending(ax):
    mesh, x = _sphere(), np.linspace(-1, 5, 25)
    y = [mesh.energy(helfrich.BendingForce(mesh, 1, v / 100)) / (8 * np.pi) for v in x]
    ax.plot(x, y, "o", ms=3, label="icosphere, N = 162")
    ax.plot(x, (1 - x / 2) ** 2, label="(1 − C₀R/2)²", lw=1)
    ax.legend(frameon=False)
    ax.set(xlabel="C₀ R of a sphere", ylabel="E / 8πκ")


def _area_difference(ax):
    mesh, x = _sphere(), np.linspace(0.7, 1.3, 25)
    target = helfrich.analysis.total_mean_curvature(mesh.vertices, mesh.triangles)
    meshes = [mesh.scaled(v) for v in x]
    _energies(ax, lambda m: helfrich.AreaDifferenceForce(m, 1, target), meshes, x, unit=target**2)
    ax.set(xlabel="M / M₀", ylabel="E / m M₀²")


def _cap(angle):
    """A disk, bent to a cap of a sphere of half-angle `angle` with its border at radius 1."""
    mesh = helfrich.Mesh.disk(8, 1.0)
    radius = np.linalg.norm(mesh.vertices, axis=1)
    turn = np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0])
    polar = radius * angle
    return helfrich.Mesh(
        np.stack(
            [np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1
        ),
        mesh.triangles,
    )


def _gaussian(ax):
    x = np.linspace(0.05, np.pi - 0.35, 25)
    meshes = [_cap(v) for v in x]
    _energies(
        ax, lambda m: helfrich.GaussianCurvatureForce(m, 1), meshes, np.degrees(x),
        "disk of 8 rings", 2 * np.pi, ls="", marker="o", ms=3,
    )  # fmt: skip
    ax.plot(np.degrees(x), 1 - np.cos(x), lw=1, label="1 − cos θ")
    ax.legend(frameon=False)
    ax.set(xlabel="half-angle θ of a cap (degrees)", ylabel="E / 2π κ_G")


def _edge_tension(ax):
    mesh, x = helfrich.Mesh.disk(8, 1.0), np.linspace(0.2, 2, 10)
    _energies(ax, lambda m: helfrich.EdgeTensionForce(m, 1), [mesh.scaled(v) for v in x], x)
    ax.set(xlabel="radius of a disk", ylabel="E / γ")


def _line_tension(ax):
    mesh = helfrich.Mesh.icosphere(16, 1.0)
    x = np.radians(np.linspace(15, 165, 31))
    y = [
        mesh.energy(
            helfrich.LineTensionForce(mesh, 1, (mesh.vertices[:, 2] > np.cos(v)).astype(int))
        )
        for v in x
    ]
    ax.plot(np.degrees(x), np.divide(y, 2 * np.pi), "o", ms=3, label="icosphere, N = 2562")
    ax.plot(np.degrees(x), np.sin(x), lw=1, label="sin θ, a circle")
    ax.legend(frameon=False)
    ax.set(xlabel="half-angle θ of a cap (degrees)", ylabel="E / 2πRγ")


def _triangle_heights(ax):
    x = np.linspace(0.75, 1.3, 45)
    # Of its three heights only the one on the long side is low.
    meshes = [_one_triangle([[-5, 0, 0], [5, 0, 0], [0, v, 0]]) for v in x]
    _energies(ax, lambda m: helfrich.TriangleHeightForce(m, 1, 1), meshes, x)
    ax.axvline(2**0.25, color=_GREY, lw=0.8, ls=":")
    ax.set(xlabel="h / d", ylabel="E / ε")


def _hinge(angle):
    return helfrich.Mesh(
        np.array([[0.0, -0.5, 0], [0, 0.5, 0], [-1, 0, 0], [np.cos(angle), 0, -np.sin(angle)]]),
        [[0, 1, 2], [1, 0, 3]],
    )


def _dihedral(ax):
    x = np.linspace(-np.pi + 0.4, np.pi - 0.4, 61)
    meshes = [_hinge(v) for v in x]
    for name in ("Quartic", "Cosine", "Exp", "SmoothExp", "SmoothExp46"):
        form = getattr(helfrich.DihedralForce, name)
        _energies(
            ax, lambda m, form=form: helfrich.DihedralForce(m, 1, form=form), meshes,
            np.degrees(x), name, lw=1.2,
        )  # fmt: skip
    ax.set(xlabel="φ (degrees)", ylabel="E / K", ylim=(-0.1, 6))
    ax.legend(frameon=False, fontsize=7)


def _triangle_area(ax):
    x = np.linspace(0.4, 1.6, 25)
    meshes = [_one_triangle([[0, 0, 0], [2, 0, 0], [0, v, 0]]) for v in x]
    _energies(ax, lambda m: helfrich.TriangleAreaForce(m, 1, 1), meshes, x)
    ax.set(xlabel="a / a₀", ylabel="E / k a₀")


def _triangle_repulsion(ax):
    x = np.linspace(0.75, 1.3, 45)
    meshes = [_one_triangle([[0, 0, 0], [2, 0, 0], [0, v, 0]]) for v in x]
    _energies(ax, lambda m: helfrich.TriangleAreaRepulsionForce(m, 1, 1), meshes, x)
    ax.axvline(2**0.25, color=_GREY, lw=0.8, ls=":")
    ax.set(xlabel="a / m", ylabel="E / ε")


def _plaquettes(ax):
    """A mesh that is less and less even, at the same area."""
    mesh = helfrich.Mesh.icosphere(4, 1.0)
    shift = np.random.default_rng(1).normal(size=mesh.vertices.shape)
    x = np.linspace(0, 0.08, 20)
    meshes = []
    for v in x:
        moved = mesh.vertices + v * shift
        moved = helfrich.Mesh(_unit(moved), mesh.triangles)
        meshes.append(moved.scaled(np.sqrt(mesh.area / moved.area)))
    _energies(ax, lambda m: helfrich.PlaquetteAreaForce(m, 1, m.area), meshes, x, unit=162)
    ax.set(xlabel="noise of the vertices / radius", ylabel="E / N k")


def _elastic(name):
    def draw(ax):
        x = np.linspace(0.6, 1.6, 41)
        for label, pull in (
            ("λ₁ = λ, λ₂ = 1", lambda v: (v, 1)),
            ("λ₁ = λ, λ₂ = 1/λ", lambda v: (v, 1 / v)),
            ("λ₁ = λ₂ = λ", lambda v: (v, v)),
        ):
            pairs = [_stretched(*pull(v)) for v in x]
            y = [
                now.energy(getattr(helfrich, name)(now, 1, 2, rest)) / rest.area
                for rest, now in pairs
            ]
            ax.plot(x, y, label=label, lw=1.2)
        ax.set(xlabel="λ", ylabel="E / μ a⁰ at K = 2 μ", ylim=(-0.1, 3))
        ax.legend(frameon=False)

    return draw


def _springs(ax):
    x = np.linspace(0.5, 1.9, 57)
    pairs = [_stretched(v, v) for v in x]
    for form in ("Harmonic", "WLCPower"):
        y = [
            now.energy(helfrich.SpringForce(now, 1, rest, form=getattr(helfrich.SpringForce, form)))
            / 3
            for rest, now in pairs
        ]
        ax.plot(x, y, label=form)
    ax.set(xlabel="l / l₀", ylabel="E of one edge / k l₀²", ylim=(-0.05, 1))
    ax.legend(frameon=False)


def _repulsion(ax):
    x = np.linspace(0.85, 1.15, 31)
    # Two triangles, of which one has a corner above the middle of the other.
    low = np.array([[-9.0, -6, 0], [9, -6, 0], [0, 9, 0]])
    high = np.array([[0.0, 0, 0], [-4, 3, 40], [4, 3, 40]])
    meshes = [
        helfrich.Mesh(np.vstack([low, high + np.array([0, 0, v])]), [[0, 1, 2], [3, 4, 5]])
        for v in x
    ]
    _energies(ax, lambda m: helfrich.SurfaceRepulsionForce(m, 1, 1), meshes, x)
    ax.set(xlabel="d / D", ylabel="E / ε")


def _adhesion(ax):
    sheet = helfrich.Mesh.disk(24, 8.0)
    x = np.linspace(0.9, 3.2, 116)
    for name in ("WCA", "LennardJones", "NineThree"):
        force = helfrich.ParticleSurfaceForce(
            sheet, [sheet.num_vertices], 1, 1, adhesion=2, attraction=name
        )
        system = openmm.System()
        for _ in range(sheet.num_vertices + 1):
            system.addParticle(1)
        system.addForce(force)
        platform = openmm.Platform.getPlatformByName("Reference")
        context = openmm.Context(system, openmm.VerletIntegrator(1), platform)
        y = []
        for v in x:
            context.setPositions([*sheet.vertices, [0.1, 0.05, v]])
            y.append(context.getState(energy=True).getPotentialEnergy()._value)
        ax.plot(x, y, label=name)
    ax.axhline(0, color=_GREY, lw=0.6)
    ax.set(xlabel="g / D of a point and a sheet", ylabel="E / ε at w D² = 2 ε", ylim=(None, 4))
    ax.legend(frameon=False)


def _usual(name):
    def draw(ax):
        left, _ = examples.run(name)
        x = np.linspace(0.8, 1.2, 25)
        _energies(ax, lambda _: left["force"], [left["mesh"].scaled(v) for v in x], x)
        ax.set(xlabel="scale of the mesh", ylabel="E (kJ/mol)")

    return draw


#: For each class what draws what it measures, with a letter, and what draws its energy.
_FIGURES = {
    "SurfaceAreaForce": (_whole, "A", _area),
    "EnclosedVolumeForce": (_volume, "V", _enclosed),
    "BendingForce": (_ring, "c, a", _bending),
    "TriangleHeightForce": (_heights, "h", _triangle_heights),
    "DihedralForce": (_edge, "φ", _dihedral),
    "TriangleAreaForce": (_triangle, "a", _triangle_area),
    "PlaquetteAreaForce": (_plaquette, "a", _plaquettes),
    "TriangleAreaRepulsionForce": (_triangle, "a", _triangle_repulsion),
    "SurfaceRepulsionForce": (_contact, "d", _repulsion),
    "ParticleSurfaceForce": (_bead, "g", _adhesion),
    "EdgeTensionForce": (_border, "L", _edge_tension),
    "GaussianCurvatureForce": (_angles, "θ", _gaussian),
    "SkalakForce": (_reference, "λ₁, λ₂", _elastic("SkalakForce")),
    "NeoHookeanForce": (_reference, "λ₁, λ₂", _elastic("NeoHookeanForce")),
    "LimForce": (_reference, "λ₁, λ₂", _elastic("LimForce")),
    "LinearElasticForce": (_reference, "λ₁, λ₂", _elastic("LinearElasticForce")),
    "SpringForce": (_spring, "l", _springs),
    "PressureForce": (_arrows, "V", _pressure),
    "SurfaceTensionForce": (_whole, "A", _tension),
    "OsmoticPressureForce": (_osmotic, "V", _osmosis),
    "AreaDifferenceForce": (_edge, "φ", _area_difference),
    "LineTensionForce": (_line, "L", _line_tension),
}


def draw(name: str, path: Path) -> None:
    """Draw the figure of a class of force."""
    sketch, letter, curve = _FIGURES.get(name) or (_whole, "", _usual(name))
    with mpl.rc_context(_STYLE):
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(6.4, 2.5), width_ratios=(1, 1.4), layout="constrained"
        )
        left.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
        left.axis("off")
        sketch(left, letter)
        curve(right)
        # Without a date, so that the same figure is the same file.
        figure.savefig(path, metadata={"Date": None})
        plt.close(figure)
