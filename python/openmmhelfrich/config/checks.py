"""What a configuration is refused for that no single key shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .._mesh.periodic import unfolded
from .._types import Array
from ..analysis.elements import edge_lengths, triangle_heights
from ..forces import MonteCarloMembraneTension
from ..mesh import Mesh
from ..simulation.model import Membrane
from .tables import Table

__all__ = ["check_box", "check_reach", "check_tension"]


def check_box(box: Table, meshes: Sequence[Mesh]) -> None:
    """Refuse a box that folds or tears a mesh which spans one of its own."""
    for number, mesh in enumerate(meshes):
        spans = _spans(mesh)
        if not spans.any():
            continue
        # What an edge across the face gains or loses; numbers in files are rounded.
        slack = 0.01 * edge_lengths(mesh.vertices, mesh.triangles, box=mesh.box).min()
        for axis, name in enumerate("abc"):
            given = box["vectors"][axis]
            if spans[axis] and np.linalg.norm(given - mesh.box[axis]) > slack:
                raise box.error(
                    "vectors",
                    f"the mesh of vesicle[{number}] spans a box whose {name} is "
                    f"{_shown(mesh.box[axis])} nm; that of this one is {_shown(given)}",
                )


def check_tension(tension: Table, box: Array | None, membranes: Sequence[Membrane]) -> None:
    """Refuse what would act on nothing."""
    if box is None:
        raise tension.error(None, "it acts on a periodic box; add [box], or a mesh that spans one")
    mover = MonteCarloMembraneTension
    axes = mover.XYIsotropic if tension["axes"] is None else tension["axes"]
    if tension["pulling_force"] and axes != mover.ZOnly:
        raise tension.error("pulling_force", 'it acts with axes = "ZOnly" only')
    if tension["tension"] and axes not in (mover.XYIsotropic, mover.XYIndependent):
        raise tension.error("tension", "these axes have none; leave it out")
    spans = np.any([_spans(membrane.mesh) for membrane in membranes], axis=0)
    wanted, words = ([2], "z") if axes == mover.ZOnly else ([0, 1], "x and y")
    if not spans[wanted].all():
        raise tension.error(
            None,
            f"it changes the box along {words}, which no mesh spans; take a periodic sheet, or a "
            'periodic tube and axes = "ZOnly"',
        )


def check_reach(repulsion: Table, membranes: Sequence[Membrane]) -> None:
    """Refuse a repulsion within vesicles that reaches across a triangle from the start."""
    for membrane in membranes:
        mesh = membrane.mesh
        height = float(triangle_heights(mesh.vertices, mesh.triangles, box=mesh.box).min())
        if repulsion["distance"] >= height:
            raise repulsion.error(
                "distance",
                f"within a vesicle it must be less than the triangles are high, {height:g} nm "
                f"in vesicle {membrane.label}, got {repulsion['distance']:g}",
            )


def _spans(mesh: Mesh) -> Array:
    """Along which of a, b and c of its periodic box a mesh comes back to itself, shape (3,)."""
    if mesh.box is None:
        return np.zeros(3, dtype=bool)
    return unfolded(mesh.vertices, mesh.edges, mesh.box)[2].any(axis=0)


def _shown(row: Array) -> str:
    return "[" + ", ".join(f"{number:g}" for number in row) + "]"
