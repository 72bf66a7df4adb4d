"""The meshes of a run, a file per membrane and frame, for programs that draw surfaces."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from .._mesh import files
from ..analysis.curvature import vertex_quantities

__all__ = ["FRAMES", "MeshFrames"]

#: What frames can be written as; "none" writes none.
FRAMES = ("none", "ply", "obj", "vtk")
# Formats that have room for values of the vertices.
_WITH_DATA = ("ply", "vtk")


class MeshFrames:
    """Files ``<name>_<label>_<number>.<kind>`` in a folder of their own.

    PLY and VTK carry ``mean_curvature``, H = C1 + C2 by Jülicher's scheme, 1/nm, and ``area``, a
    third of the triangles around a vertex, nm². Each frame has its own triangles.

    Parameters
    ----------
    folder : Path
        Where to write; made when the first frame is.
    name : str
        How all names begin.
    kind : str
        One of `FRAMES`.
    """

    def __init__(self, folder: Path, name: str, kind: str):
        if kind not in FRAMES:
            raise ValueError(f"frames must be one of {', '.join(FRAMES)}, got {kind!r}")
        self._folder = folder
        self._name = name
        self._kind = kind

    @property
    def wanted(self) -> bool:
        """Whether there is anything to write."""
        return self._kind != "none"

    def write(self, number: int, label: str, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Write the mesh of one membrane in one frame.

        Parameters
        ----------
        number : int
            Of the frame, from 0.
        label : str
            Of the membrane.
        vertices : ndarray
            Shape (num_vertices, 3), nm.
        triangles : ndarray
            Shape (num_triangles, 3), those of this frame.
        """
        self._folder.mkdir(exist_ok=True)
        data = None
        if self._kind in _WITH_DATA:
            found = vertex_quantities(vertices, triangles)
            data = {"mean_curvature": found.mean_curvature(), "area": found.barycentric_area}
        path = self._folder / f"{self._name}_{label}_{number:06d}.{self._kind}"
        files.write(path, vertices, triangles, data)

    def remove_from(self, number: int, labels: Iterable[str]) -> None:
        """Remove the frames of this number and later ones."""
        if not self.wanted:
            return
        for label in labels:
            # Nothing but digits may follow: one label may be the beginning of another.
            named = re.compile(re.escape(f"{self._name}_{label}_") + r"(\d+)")
            for path in self._folder.glob(f"*.{self._kind}"):
                found = named.fullmatch(path.stem)
                if found and int(found.group(1)) >= number:
                    path.unlink()
