"""Surfaces over time as GSD, the format of HOOMD-blue, which OVITO reads too: bonds of each frame.

The format and its chunks: https://gsd.readthedocs.io/en/stable/schema-hoomd.html.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from openmm import unit

from .._numbers import values_in
from .._types import Array, File
from ._gsd import import_gsd
from ._surface_frames import Types, each_surface, fresh_file
from .curvature import vertex_quantities
from .elements import edges_of
from .surface_series import SurfaceFrame

__all__ = ["Frames", "masses_of", "write_gsd"]


def write_gsd(
    path: File,
    vertices: Any,
    triangles: Any = None,
    times: Any = None,
    steps: Any = None,
    *,
    box: Any = None,
    types: ArrayLike | None = None,
    masses: ArrayLike = 1.0,
) -> int:
    """Write surfaces over time as GSD, with the bonds of each frame: HOOMD and OVITO read it.

    Vertices are particles of the types V0, V1, …, and edges are bonds of the type ``edge``, new
    ones where bonds have flipped. Numbers are in single precision, in nm, amu and ps, so that
    HOOMD's energies are in kJ/mol. Positions are in the box, and particles have images, as HOOMD
    wants it; without a periodic box the cell is a cube around the origin with room to spare, and
    ``log/periodic`` is 0. The other chunks of ours are ``log/triangles``, uint32 of shape
    (num_triangles, 3), there where it is not that of frame 0; ``log/time``, float64, ps; and
    ``log/particles/mean_curvature``, 1/nm, ``log/particles/area``, nm², and
    ``log/particles/neighbours``, which OVITO has as properties of particles.

    Parameters
    ----------
    path : str or Path
        ``.gsd``; a file that is there is replaced when the new one is whole.
    vertices, triangles, times, steps, box
        As for `write_vtkhdf`.
    types : array_like of int, optional
        Kind of each vertex from 0, such as `domains`, shape (num_vertices,), or (num_frames,
        num_vertices) if they change. Default: the number of the connected surface.
    masses : float, array_like or Quantity, optional
        amu, one for all or shape (num_vertices,).

    Returns
    -------
    int
        How many frames were written.

    Raises
    ------
    ImportError
        Without the package gsd.
    TypeError
        Masses or times that are no numbers, or of another dimension.
    ValueError
        Another suffix, types or masses that do not fit, or as for `write_vtkhdf`.
    OSError
        If the system refuses; a file that was there is as before.

    Examples
    --------
    >>> write_gsd("run.gsd", "run/run.xtc")  # with run/run.triangles beside it
    """
    hoomd = import_gsd("write_gsd")
    path = Path(path)
    if path.suffix.lower() != ".gsd":
        raise ValueError(f"write_gsd: {path}: the suffix must be .gsd")
    masses = masses_of("write_gsd", masses)
    with fresh_file(path) as fresh, hoomd.open(name=str(fresh), mode="w") as file:
        frames = Frames(hoomd, Types("write_gsd", types), masses)

        def add(frame):
            file.append(frames.next(frame))

        return each_surface("write_gsd", add, vertices, triangles, times, steps, box)


def masses_of(where: str, masses) -> np.ndarray:
    """Masses as they are written, of one or of each vertex; `where` is named in errors."""
    masses = values_in(unit.dalton, masses, where, "masses").astype(np.float32)
    if masses.ndim > 1 or not (np.isfinite(masses) & (masses >= 0)).all():
        raise ValueError(f"{where}: masses: need one number or shape (num_vertices,), amu, from 0")
    return masses


class Frames:
    """Surfaces as frames of the package gsd."""

    def __init__(self, hoomd, types: Types, masses: Array):
        self._hoomd, self._types, self._masses = hoomd, types, masses
        self._first, self._side = None, 0.0

    def go_on(self, first, last) -> None:
        """Go on with a file of these frames, as gsd reads them."""
        self._first = first.log.get("triangles")
        if not first.log.get("periodic", [True])[0]:
            self._side = float(last.configuration.box[0])

    def next(self, frame: SurfaceFrame):
        """The next frame."""
        count, result = len(frame.vertices), self._hoomd.Frame()
        if self._masses.ndim and len(self._masses) != count:
            raise ValueError(
                f"{self._types.where}: masses: there are {len(self._masses)}, but {count} vertices"
            )
        box = self._cell(frame.vertices) if frame.box is None else frame.box
        images = np.floor(np.linalg.solve(box.T, frame.vertices.T).T + 0.5)
        types = self._types.next(frame)
        start, end = edges_of(frame.triangles)[:2]
        result.configuration.step = frame.step
        result.configuration.box = _lengths_and_tilts(box)
        result.particles.N = count
        result.particles.position = (frame.vertices - images @ box).astype(np.float32)
        result.particles.image = images.astype(np.int32)
        result.particles.types = [f"V{kind}" for kind in range(int(types.max()) + 1)]
        result.particles.typeid = types.astype(np.uint32)
        result.particles.mass = np.broadcast_to(self._masses, (count,))
        result.bonds.N = len(start)
        result.bonds.types = ["edge"]
        result.bonds.typeid = np.zeros(len(start), dtype=np.uint32)
        result.bonds.group = np.column_stack([start, end]).astype(np.uint32)
        found = vertex_quantities(frame.vertices, frame.triangles, box=frame.box)
        neighbours = np.bincount(np.concatenate([start, end]), minlength=count)
        result.log = {
            "time": np.array([frame.time]),
            "periodic": np.array([frame.box is not None], dtype=np.uint8),
            "particles/mean_curvature": found.mean_curvature().astype(np.float32),
            "particles/area": found.barycentric_area.astype(np.float32),
            "particles/neighbours": neighbours.astype(np.int32),
        }
        # A chunk that is not there is that of frame 0.
        triangles = frame.triangles.astype(np.uint32)
        if self._first is None or not np.array_equal(triangles, self._first):
            result.log["triangles"] = triangles
        if self._first is None:
            self._first = triangles
        return result

    def _cell(self, vertices: Array) -> Array:
        """A cube around the origin that is twice as wide as what is in it, and seldom grows."""
        if (farthest := float(np.abs(vertices).max())) >= self._side / 2:
            self._side = 4 * farthest or 1.0
        return self._side * np.eye(3)


def _lengths_and_tilts(box: Array) -> Array:
    """HOOMD's Lx, Ly, Lz, xy, xz, yz of vectors of OpenMM's reduced form, shape (6,)."""
    x, y, z = np.diag(box)
    return np.array([x, y, z, box[1, 0] / y, box[2, 0] / z, box[2, 1] / z], dtype=np.float32)
