"""Cells of VTK's kinds: which are faces of a surface, and which do not matter or cannot be read."""

from __future__ import annotations

import numpy as np

from .._types import Array
from . import repair
from .source import Source

__all__ = ["TRIANGLE", "Cells", "polydata_cells"]

TRIANGLE, _STRIP, _POLYGON, _PIXEL, _QUAD = 5, 6, 7, 8, 9
# Vertices, lines and polylines, which have no area.
_IGNORED = (1, 2, 3, 4)
_KINDS = {"VERTICES": 2, "LINES": 4, "POLYGONS": _POLYGON, "TRIANGLE_STRIPS": _STRIP}
_NAMES = {
    10: "tetrahedron",
    11: "voxel",
    12: "hexahedron",
    13: "wedge",
    14: "pyramid",
    22: "quadratic triangle",
    23: "quadratic quad",
    42: "polyhedron",
}


class Cells:
    """Cells as VTK has them: cell i has the corners from ``offsets[i]`` to ``offsets[i + 1]``.

    Parameters
    ----------
    connectivity : ndarray of int
        The corners of one cell after another.
    offsets : ndarray of int
        Shape (num_cells + 1,), the first one 0.
    types : ndarray of int, optional
        VTK's numbers of their kinds, shape (num_cells,).
    """

    def __init__(self, connectivity: Array, offsets: Array, types: Array | None = None):
        self.connectivity = connectivity
        self.offsets = offsets
        self.types = types

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def mesh(self, source: Source, points: Array) -> tuple[Array, Array]:
        """Vertices and triangles; vertices of points and lines only are left out.

        Raises
        ------
        MeshError
            If indices make no sense, or if there are cells that are no faces.
        """
        self.check_offsets(source)
        self._check_range(source, len(points))
        faces: list[list[int]] = []
        ignored = np.ones(len(points), dtype=bool)
        lonely = np.zeros(len(points), dtype=bool)
        corners = self.connectivity.tolist()
        bounds = self.offsets.tolist()
        for cell, kind in enumerate(self.types.tolist()):
            found = corners[bounds[cell] : bounds[cell + 1]]
            if kind in _IGNORED:
                lonely[found] = True
            elif kind == _STRIP:
                # Every other triangle of a strip runs the other way round.
                for k in range(len(found) - 2):
                    a, b, c = found[k : k + 3]
                    faces.append([a, b, c] if k % 2 == 0 else [b, a, c])
            elif kind in (TRIANGLE, _POLYGON, _PIXEL, _QUAD):
                if kind == _PIXEL:
                    found[2:] = reversed(found[2:])
                source.check_corners(len(found), len(faces))
                faces.append(found)
            else:
                name = _NAMES.get(kind, f"VTK's kind {kind}")
                raise source.error(
                    f"found a cell of type '{name}' on vertices {found}; only faces are allowed: "
                    "extract the surface and save that"
                )
        for face in faces:
            ignored[face] = False
        points, triangles = source.mesh(points, faces)
        return repair.drop(points, triangles, np.flatnonzero(ignored & lonely))

    def check_offsets(self, source: Source) -> None:
        """Refuse offsets that do not belong to these corners."""
        if (
            len(self.offsets) == 0
            or self.offsets[0] != 0
            or (np.diff(self.offsets) < 0).any()
            or self.offsets[-1] != len(self.connectivity)
            or (self.types is not None and len(self.types) != len(self))
        ):
            raise source.error(
                "the offsets and types of the cells do not fit their "
                f"{len(self.connectivity)} corners; is the file truncated?"
            )

    def _check_range(self, source: Source, num_points: int) -> None:
        """Refuse indices out of range."""
        wrong = np.flatnonzero((self.connectivity < 0) | (self.connectivity >= num_points))
        if len(wrong):
            cell = int(np.searchsorted(self.offsets, wrong[0], side="right")) - 1
            raise source.error(
                f"cell {cell} names vertex {self.connectivity[wrong[0]]}, but the file has "
                f"{num_points} vertices, counted from 0"
            )


def polydata_cells(source: Source, parts: dict[str, Cells]) -> Cells:
    """The cells of a POLYDATA, from its parts by their names in legacy files."""
    corners, offsets, types = [], [np.zeros(1, dtype=np.int64)], []
    for name, kind in _KINDS.items():
        if name in parts:
            part = parts[name]
            part.check_offsets(source)
            offsets.append(part.offsets[1:] + sum(map(len, corners)))
            corners.append(part.connectivity)
            types.append(np.full(len(part), kind))
    return Cells(*map(np.concatenate, (corners, offsets, types)))
