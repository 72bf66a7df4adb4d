"""Scenes of what there is: a mesh, a simulation, arrays, a run in its folder, a file."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import openmm
import openmm.app

from .._mesh import files
from .._numbers import whole_number
from .._present import is_periodic, surfaces_of
from .._start_mesh import check_whole
from .._types import Array
from ..analysis._arrays import frames_of, positions_in
from ..analysis.tables import import_h5py
from ..analysis.trajectories import Trajectory
from ..errors import MeshError
from ..mesh import Mesh
from . import xtc
from .scene import Scene

__all__ = ["add_context", "scene_of"]

# A page of so many positions has about 30 MB, and more frames than that nobody looks at.
_MOST_POSITIONS = 2_000_000
_MOST_FRAMES = 2000
_TRAJECTORIES = (".xtc", ".dcd", ".pdb", ".gsd")

# Columns of a run's table.
_ENERGY = " (kJ/mol)"
_AREA = re.compile(r"area (.*) \(nm\^2\)")

#: What is put around the loop over frames, to show how far it is.
Progress = Callable[[Iterable[int]], Iterable[int]]


def scene_of(
    thing: Any,
    triangles: Any = None,
    *,
    title: str | None = None,
    every: Any = None,
    mesh: Any = None,
    progress: Progress = iter,
) -> Scene:
    """The scene of anything that can be shown.

    Parameters
    ----------
    thing, triangles, every, mesh
        As for `view`.
    title : str, optional
        Of the page. Default: the name of the file, or of what it is.
    progress : callable, optional
        Put around the loop over the frames.

    Raises
    ------
    FileNotFoundError, ImportError, TypeError, ValueError
        As for `view`.
    """
    if every is not None:
        every = whole_number(every, "view", "every", 1)
    if isinstance(thing, (str, os.PathLike)):
        path = Path(thing)
        if triangles is not None:
            raise TypeError("view: a path has its own triangles; give mesh= for a trajectory")
        return _of_path(path, title, every, mesh, progress)
    if mesh is not None:
        raise TypeError("view: mesh= is for trajectories in files; give triangles")
    if triangles is None and isinstance(thing, (openmm.Context, openmm.app.Simulation)):
        context = getattr(thing, "context", thing)
        scene = Scene(title or "simulation")
        add_context(scene, context, getattr(thing, "currentStep", 0))
        return scene
    if triangles is None and isinstance(thing, Mesh):
        scene = Scene(title or "mesh")
        scene.add(thing.vertices, thing.triangles, box=thing.box)
        return scene
    if triangles is None:
        raise TypeError(
            "view: need a Mesh, Simulation, Context or path, or positions and triangles; got "
            f"{type(thing).__name__} alone"
        )
    frames, _ = frames_of(positions_in(thing))
    corners = np.asarray(getattr(triangles, "triangles", triangles))
    box = getattr(triangles, "box", None)
    source = _Frames(frames, corners, np.arange(len(frames)), np.arange(len(frames)), box=box)
    return source.scene(Scene(title or "surface"), every, progress)


def add_context(scene: Scene, context: openmm.Context, step: int, energies: Any = None) -> None:
    """Add all surfaces of a Context as they are now.

    Raises
    ------
    ValueError
        If there is no membrane force, or positions have not been set.
    """
    surfaces = surfaces_of(context)
    if not surfaces:
        raise ValueError(
            "view: the System has no membrane force that would tell its triangles; give positions "
            "and triangles"
        )
    corners = _once(np.concatenate([force.getTrianglesInContext(context) for force in surfaces]))
    state = context.getState(positions=True)
    box = None
    if any(is_periodic(context, force) for force in surfaces):
        box = np.asarray(state.getPeriodicBoxVectors(asNumpy=True)._value)
    positions = np.asarray(state.getPositions(asNumpy=True)._value)
    if not np.ptp(positions[corners.ravel()], axis=0).any():
        raise ValueError("view: the Context has no positions yet; set them first")
    time = state.getTime()._value
    scene.add(positions, corners, step=step, time=time, box=box, energies=energies)


def _once(corners: Array) -> Array:
    """Each triangle once: a force of contacts has those of other forces too."""
    turn = corners.argmin(axis=1)
    turned = corners[np.arange(len(corners))[:, np.newaxis], (turn[:, np.newaxis] + range(3)) % 3]
    first = np.unique(turned, axis=0, return_index=True)[1]
    return corners[np.sort(first)]


class _Frames:
    """Positions of all frames, with the triangles, times, boxes and energies that go with them."""

    def __init__(self, frames, triangles, steps, times, *, box=None, names=None, energies=None):
        self._frames, self._triangles = frames, triangles
        self._steps, self._times = steps, times
        self._box = box
        self._names = names
        self._energies = energies or {}

    def scene(self, scene: Scene, every: int | None, progress: Progress) -> Scene:
        """The scene with every so many of these frames."""
        count = len(self._frames)
        own = np.ndim(self._triangles) == 3
        if own and len(self._triangles) != count:
            raise ValueError(
                f"view: there are {count} frames, but the triangles of {len(self._triangles)}"
            )
        if every is None:
            fits = min(_MOST_FRAMES, max(1, _MOST_POSITIONS // self._frames.shape[1]))
            every = -(-count // fits)
        for number in progress(range(0, count, every)):
            box = self._box
            energies = {
                name: values[number]
                for name, values in self._energies.items()
                if np.isfinite(values[number])
            }
            scene.add(
                self._frames[number],
                self._triangles[number] if own else self._triangles,
                step=int(self._steps[number]),
                time=float(self._times[number]),
                box=box[number] if np.ndim(box) == 3 else box,
                energies=energies,
            )
        return scene


def _of_path(path: Path, title, every, mesh, progress: Progress) -> Scene:
    if not path.exists():
        raise FileNotFoundError(f"view: there is no file or folder {path}")
    source = _trajectory_in(path) if path.is_dir() else path
    suffix = source.suffix.lower()
    title = title or (path.resolve().name if path.is_dir() else source.stem)
    if suffix in _TRAJECTORIES:
        found, names = _of_trajectory(source, mesh)
    elif suffix == ".vtkhdf":
        found, names = _of_series(source), None
    else:
        scene = Scene(title)
        try:
            vertices, triangles, box = files.read(source, False, None, False)
            scene.add(vertices, triangles, box=box)
        except MeshError as reason:
            raise ValueError(f"view: {reason}") from None
        return scene
    return found.scene(Scene(title, names), every, progress)


def _trajectory_in(folder: Path) -> Path:
    """The file of a run's folder that has its frames."""
    for pattern in ("*.xtc", "*.vtkhdf", "*.gsd"):
        found = sorted(folder.glob(pattern))
        if len(found) == 1:
            return found[0]
        if found:
            raise ValueError(
                f"view: {folder} has {len(found)} files {pattern}, not one; name the one to show"
            )
    raise ValueError(
        f"view: {folder} has no XTC, VTKHDF or GSD file, so it is no folder of a run with a "
        "trajectory; name a mesh or a trajectory"
    )


def _of_trajectory(path: Path, mesh) -> tuple[_Frames, list[str] | None]:
    frames, steps, times, boxes = _positions(path)
    triangles, box = _triangles_beside(path, frames.shape[1], len(frames), mesh)
    if np.ndim(triangles) == 3:
        # A run that was killed, or that goes on, may be ahead with one of its two files.
        count = min(len(frames), len(triangles))
        frames, triangles = frames[:count], triangles[:count]
    if box is not None and boxes is not None:
        box = boxes
    names, energies = _table_beside(path, steps)
    return _Frames(frames, triangles, steps, times, box=box, energies=energies), names


def _positions(path: Path):
    """Positions, steps, times and boxes, if there are any, of all frames."""
    if path.suffix.lower() == ".xtc":
        frames, boxes, times, steps = xtc.read(path)
        return frames, steps, times, boxes if boxes.any(axis=2).all() else None
    trajectory = Trajectory(path)
    frames = trajectory.read()
    steps = times = np.arange(len(frames))
    if trajectory.timed:
        steps, times = trajectory.steps(), trajectory.times()
    return frames, steps, times, trajectory.boxes()


def _triangles_beside(path: Path, num_particles: int, num_frames: int, mesh):
    """Triangles, of each frame or of all, and the box of the mesh."""
    if path.suffix.lower() == ".gsd":
        trajectory = Trajectory(path)
        if (own := trajectory.triangles()) is not None:
            return own, trajectory.boxes()
    start = path.with_suffix(".ply")
    flowing = path.with_suffix(".triangles")
    box = triangles = None
    source = mesh if mesh is not None else start if start.is_file() else None
    if source is not None:
        vertices, triangles, box = _mesh_of(source)
        if len(vertices) != num_particles:
            raise ValueError(
                f"view: {path} has {num_particles} particles, and {source} {len(vertices)} "
                "vertices; give the mesh of all membranes"
            )
    if flowing.is_file():
        count = 3 * len(triangles) if triangles is not None else None
        stored = flowing.stat().st_size // 4
        if count is None:
            count = stored // num_frames
        if count and count % 3 == 0 and stored >= count:
            whole = (stored // count, count // 3, 3)
            return np.memmap(flowing, dtype="<i4", mode="r", shape=whole), box
        raise ValueError(f"view: {flowing} does not match the {num_frames} frames of {path}")
    if triangles is None:
        raise ValueError(
            f"view: {path} has no triangles beside it, neither {start.name} nor {flowing.name}; "
            "give its mesh with --mesh, or mesh= in Python"
        )
    if mesh is None:
        check_whole(start, path)
    return triangles, box


def _mesh_of(source):
    if isinstance(source, Mesh):
        return source.vertices, source.triangles, source.box
    try:
        return files.read(source, False, None, False)
    except MeshError as reason:
        raise ValueError(f"view: {reason}") from None


def _table_beside(path: Path, steps) -> tuple[list[str] | None, dict[str, Array]]:
    """Names of the membranes, and energies of the frames, from the CSV file of a run."""
    table = path.with_suffix(".csv")
    if not table.is_file():
        return None, {}
    text = table.read_text(encoding="utf-8")
    # A run that goes on, or was killed, may have a part of a line at the end.
    columns, *lines = list(csv.reader(text[: text.rfind("\n") + 1].splitlines())) or [[]]
    if columns[:1] != ["step"] or any(len(line) != len(columns) for line in lines):
        return None, {}
    names = [match[1] for name in columns if (match := _AREA.fullmatch(name))]
    rows = {int(line[0]): line for line in lines}
    energies = {}
    for column, name in enumerate(columns):
        if name.endswith(_ENERGY):
            found = [rows[step][column] if step in rows else "nan" for step in map(int, steps)]
            energies[name.removesuffix(_ENERGY)] = np.array(found, dtype=float)
    return names or None, energies


def _of_series(path: Path) -> _Frames:
    """The frames of a VTKHDF file of ours."""
    h5py = import_h5py("or view an XTC file")
    try:
        with h5py.File(path, "r") as file:
            root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
            counts = root["NumberOfPoints"][:]
            own = file["openmm-helfrich"]
            if (counts != own.attrs["vertices"]).any():
                raise ValueError(
                    f"view: the surfaces in {path} are cut at the faces of their periodic box; "
                    "view the XTC file"
                )
            size = 3 * int(own.attrs["triangles"])
            points = root["Points"][:].reshape(-1, counts[0], 3)
            corners = root["Polygons/Connectivity"][:]
            begins = steps["ConnectivityIdOffsets"][:, 2]
            triangles = np.stack([corners[at : at + size].reshape(-1, 3) for at in begins])
            return _Frames(points, triangles, own["step"][:], steps["Values"][:])
    except (OSError, KeyError) as reason:
        raise ValueError(f"view: {path} is no VTKHDF file of this package ({reason})") from None
