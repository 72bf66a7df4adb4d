"""What the viewer shows: surfaces over time, with all numbers of each moment.

Everything is computed here, by the functions of `analysis`, so that the page has no formula of its
own and cannot differ from them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._mesh import geometry
from .._mesh.periodic import corner_positions, cut_images, unfolded
from .._types import Array
from ..analysis import mode_amplitudes, shape
from ..analysis._arrays import frames_of, triangles_of
from ..analysis.curvature import vertex_quantities
from ..analysis.surface_series import components

__all__ = ["FIELDS", "Field", "Scene", "Series"]

# Largest mode of the spectra, as `openmm-helfrich spectrum` has it, if the mesh resolves it.
_LMAX = 10
# Meshes larger than this would take seconds for the spectrum of a frame.
_MOST_VERTICES = 40_000


class Field(NamedTuple):
    """A value of each vertex by which a surface is coloured."""

    label: str
    unit: str
    kind: str
    """``diverging`` from the middle, ``sequential``, or ``whole`` numbers."""


FIELDS = {
    "curvature": Field("mean curvature C₁ + C₂", "1/nm", "diverging"),
    "area": Field("area", "nm²", "sequential"),
    "angle": Field("largest dihedral angle", "°", "sequential"),
    "neighbours": Field("neighbours", "", "whole"),
}
"""By name: mean curvature by Jülicher's scheme (B13), a third of the area of the triangles around,
the largest |φ| of the edges around, and the number of these edges."""


class Series(NamedTuple):
    """A number of each frame."""

    label: str
    unit: str
    surface: int | None
    """Of which surface it is; None for all together."""
    values: list[float]


class _Frame(NamedTuple):
    step: int
    time: float
    points: Array
    """Shape (num_points, 3), float32, nm, from `origin`."""
    origin: Array
    mesh: int
    """Which of `Scene.meshes` connects the points."""
    fields: Array
    """Shape (number of FIELDS, num_points), float32; NaN where there is no value."""
    numbers: dict[tuple[int | None, str, str], float]
    """By surface, label and unit."""
    spectra: tuple[Array | None, ...]
    """Of each surface the mean of |u_lm|² over m, for l = 2, 3, …; None without one."""


class Scene:
    """Surfaces over time, to which frames are added.

    Parameters
    ----------
    title : str
        Of the page.
    names : sequence of str, optional
        Of the connected surfaces, in the order of their first vertices. Default: numbers from 1.

    Examples
    --------
    >>> scene = Scene("ball")
    >>> scene.add(mesh.vertices, mesh.triangles)
    >>> scene.series()[0].label
    'area'
    """

    def __init__(self, title: str, names: Any = None) -> None:
        self.title = title
        self.frames: list[_Frame] = []
        self.meshes: list[tuple[Array, Array]] = []
        """Triangles, shape (num_triangles, 3), and the surface of each point."""
        self._names = None if names is None else list(names)
        self._split: tuple[Array, list[Any]] | None = None

    @property
    def names(self) -> list[str]:
        """Of the surfaces, in their order."""
        if not self.meshes:
            return []
        count = int(max(surfaces.max() for _, surfaces in self.meshes)) + 1
        if self._names is not None and len(self._names) == count:
            return self._names
        return [str(number + 1) for number in range(count)]

    def add(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        step: int = 0,
        time: float = 0.0,
        box: Array | None = None,
        energies: Mapping[str, float] | None = None,
    ) -> None:
        """Add a moment.

        Parameters
        ----------
        vertices : array_like
            Shape (num_vertices, 3), nm; those of no triangle are left out.
        triangles : array_like of int
            Shape (num_triangles, 3), counter-clockwise seen from outside.
        step : int
            Of the simulation.
        time : float
            ps.
        box : ndarray, optional
            Periodic box in which the surface lives, shape (3, 3), nm.
        energies : mapping of str to float, optional
            kJ/mol, by the name of the term.

        Raises
        ------
        ValueError
            As for `analysis.mean_curvature`.
        """
        points, corners = _used(frames_of(vertices)[0][0], triangles)
        surfaces, parts = self._parts(corners, len(points))
        found = vertex_quantities(points, corners, box=box)
        curvature = found.mean_curvature()
        angles, neighbours = _around(points, corners, box)
        fields = np.stack([curvature, found.barycentric_area, angles, neighbours])
        numbers = {(None, name, "kJ/mol"): float(value) for name, value in (energies or {}).items()}
        spectra = []
        for number, (chosen, faces) in enumerate(parts):
            numbers.update(_measured(points[chosen], faces, curvature[chosen], box, number))
            spectra.append(_spectrum(points[chosen], faces, box))
        if len(parts) > 1:
            numbers.update(_measured(points, corners, curvature, box, None))
        owners = np.arange(len(points))
        if box is not None:
            edges = geometry.edges_of(corners)
            points, corners, owners = cut_images(points, corners, edges, box)
        middle = points.mean(axis=0)
        self.frames.append(
            _Frame(
                int(step),
                float(time),
                (points - middle).astype(np.float32),
                middle,
                self._mesh(corners, surfaces[owners]),
                fields[:, owners].astype(np.float32),
                numbers,
                tuple(spectra),
            )
        )

    def thin(self) -> None:
        """Leave out every second frame, so that a long run stays small; the first one stays."""
        self.frames = self.frames[::2]
        used = sorted({frame.mesh for frame in self.frames})
        places = {mesh: place for place, mesh in enumerate(used)}
        self.meshes = [self.meshes[mesh] for mesh in used]
        self.frames = [frame._replace(mesh=places[frame.mesh]) for frame in self.frames]

    def series(self) -> list[Series]:
        """Energies, and the measures of each surface and of all together, over the frames."""
        keys = dict.fromkeys(key for frame in self.frames for key in frame.numbers)
        found = [
            Series(label, unit, surface, [f.numbers.get(key, np.nan) for f in self.frames])
            for key in keys
            for surface, label, unit in (key,)
        ]
        return [each for each in found if not np.isnan(each.values).all()]

    def spectra(self) -> list[Array | None]:
        """Of each surface the mean of |u_lm|² over m.

        Shape (num_frames, number of l from 2 on), with NaN for frames that have none; None for
        surfaces with none at all.
        """
        found = []
        for number in range(len(self.names)):
            rows = [f.spectra[number] if number < len(f.spectra) else None for f in self.frames]
            known = [row for row in rows if row is not None]
            if not known:
                found.append(None)
                continue
            missing = np.full(len(known[0]), np.nan)
            found.append(np.stack([missing if row is None else row for row in rows]))
        return found

    def _parts(self, corners: Array, count: int):
        """The surface of each vertex, and of each surface its vertices and triangles."""
        if self._split is not None and np.array_equal(self._split[0], corners):
            return self._split[1]
        surfaces = components(corners, count)
        parts = []
        for number in range(surfaces.max() + 1):
            chosen = np.flatnonzero(surfaces == number)
            rows = corners[surfaces[corners[:, 0]] == number]
            parts.append((chosen, np.searchsorted(chosen, rows)))
        self._split = (corners, (surfaces, parts))
        return surfaces, parts

    def _mesh(self, corners: Array, surfaces: Array) -> int:
        """The place of these triangles in `meshes`, at the end of which they are put if new."""
        last = self.meshes[-1] if self.meshes else None
        if last is None or not (
            np.array_equal(last[0], corners) and np.array_equal(last[1], surfaces)
        ):
            self.meshes.append((corners.astype(np.uint32), surfaces.astype(np.uint16)))
        return len(self.meshes) - 1


def _used(vertices: Array, triangles) -> tuple[Array, Array]:
    """Without the vertices, or other particles, that belong to no triangle."""
    corners = triangles_of(triangles, len(vertices))
    used = np.unique(corners)
    if len(used) == len(vertices):
        return vertices, corners
    return vertices[used], np.searchsorted(used, corners)


def _around(points, corners, box) -> tuple[Array, Array]:
    """The largest |φ| around each vertex, degrees, and how many neighbours it has."""
    edges = geometry.edges_of(corners)
    angles = np.abs(geometry.dihedral_angles(corner_positions(points, corners, box), corners))
    largest = np.zeros(len(points))
    np.maximum.at(largest, edges, np.degrees(angles)[:, np.newaxis])
    return largest, np.bincount(edges.ravel(), minlength=len(points))


def _measured(points, corners, curvature, box, surface) -> dict[str, Any]:
    """Area, volumes and the range of curvature of one surface, or of all."""
    whole = shape(points, corners, box=box)
    numbers = {
        ("area", "nm²"): whole.area,
        ("volume", "nm³"): whole.volume,
        ("reduced volume", ""): whole.reduced_volume if surface is not None else np.nan,
        ("least curvature", "1/nm"): _extreme(np.fmin, curvature),
        ("largest curvature", "1/nm"): _extreme(np.fmax, curvature),
    }
    return {(surface, *key): float(value) for key, value in numbers.items()}


def _extreme(function, values) -> float:
    """The least or largest value that is one; NaN if there is none, as on a strip of triangles."""
    return function.reduce(values)


def _spectrum(points, corners, box) -> Array | None:
    """Mean of |u_lm|² over m for l = 2, 3, …; None if the surface has no such modes."""
    lmax = min(_LMAX, int(len(points) ** 0.5 / 2))
    if lmax < 2 or len(points) > _MOST_VERTICES:
        return None
    if box is not None:
        points, _, spanning = unfolded(points, geometry.edges_of(corners), box)
        if spanning.any():
            return None
    try:
        modes = mode_amplitudes(points, corners, lmax)
    except ValueError:
        # It has a border, or is far from a sphere.
        return None
    return np.array([np.mean(modes[l * l : (l + 1) ** 2] ** 2) for l in range(2, lmax + 1)])
