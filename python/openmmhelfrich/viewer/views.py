"""`view`, which shows anything, and what it returns."""

from __future__ import annotations

import html
import os
import tempfile
import webbrowser
from pathlib import Path
from typing import Any

from .._types import File
from .._writing import write_whole
from .page import GENERATOR, page
from .scene import Scene
from .sources import scene_of

__all__ = ["View", "check_replaceable", "embedded", "open_in_browser", "view", "write_page"]

# Of a cell of a notebook, pixels.
_HEIGHT = 460


class View:
    """A page that shows surfaces; in a notebook it shows itself.

    Attributes
    ----------
    scene : Scene
        What it shows.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def write(self, path: File) -> Path:
        """Write the page, an HTML file with everything in it.

        Parameters
        ----------
        path : str or Path
            A file that is there is overwritten.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        OSError
            If the system refuses.
        """
        path = Path(path)
        write_whole(path, page(self.scene).encode())
        return path

    def open(self) -> Path:
        """Write the page to a temporary file and open it in the browser; returns its path."""
        handle, name = tempfile.mkstemp(".html", "openmm-helfrich-")
        os.close(handle)
        path = self.write(name)
        open_in_browser(path)
        return path

    def __repr__(self) -> str:
        count = len(self.scene.frames)
        return f"View({self.scene.title!r}, {count} frame{'s' * (count != 1)})"

    def _repr_html_(self) -> str:
        return embedded(page(self.scene))


def view(
    thing: Any,
    triangles: Any = None,
    path: File | None = None,
    *,
    title: str | None = None,
    every: int | None = None,
    mesh: Any = None,
) -> View:
    """Show a surface, or surfaces over time, in a browser or a notebook.

    The page has the surface in three dimensions, coloured by mean curvature, area, dihedral angle
    or neighbours, and beside it the numbers of each frame by the functions of `analysis`, energies
    and the spectrum, which follow a slider over time.

    Parameters
    ----------
    thing : Mesh, Simulation, Context, str, Path or array_like
        What to show; a path is that of a run's folder, a mesh, a trajectory (XTC, DCD, PDB) or a
        VTKHDF file of this package. Positions have shape (num_vertices, 3) or
        (num_frames, num_vertices, 3), nm.
    triangles : array_like of int or Mesh, optional
        For positions: shape (num_triangles, 3), or (num_frames, num_triangles, 3) if each frame has
        its own, counter-clockwise seen from outside.
    path : str or Path, optional
        Write the page there too.
    title : str, optional
        Of the page. Default: the name of the file, or of what it is.
    every : int, optional
        Show every so many frames. Default: all, or as many as make a page of some 30 MB.
    mesh : Mesh, str or Path, optional
        The mesh of all membranes, for a trajectory without ``<name>.ply`` or ``<name>.triangles``
        beside it.

    Returns
    -------
    View
        Which shows itself in a notebook; elsewhere, see `View.open` and `View.write`.

    Raises
    ------
    FileNotFoundError
        There is no such file or folder.
    ImportError
        A VTKHDF file without h5py, or a DCD or PDB file without MDTraj.
    TypeError
        It is something else.
    ValueError
        Files that are broken or do not match; the message names them and says what to do.

    Examples
    --------
    >>> view(Mesh.icosphere(3, radius=10), path="ball.html")
    View('mesh', 1 frame)
    """
    found = View(scene_of(thing, triangles, title=title, every=every, mesh=mesh))
    if path is not None:
        found.write(path)
    return found


def check_replaceable(path: Path) -> None:
    """Raise a FileExistsError if a page would overwrite anything but another one."""
    if path.is_file():
        with path.open("rb") as file:
            if GENERATOR.encode() not in file.read(1000):
                raise FileExistsError(
                    f"{path} is there already and is no page of the viewer; give another name"
                )


def write_page(path: Path, scene: Scene, reload: float | None = None, key: Any = None) -> int:
    """Write a page in the place of none but another one; returns its size in bytes.

    Raises
    ------
    FileExistsError
        If there is another file.
    OSError
        If the system refuses.
    """
    check_replaceable(path)
    data = page(scene, reload=reload, key=key).encode()
    write_whole(path, data)
    return len(data)


def open_in_browser(path: Path) -> bool:
    """Open a page where there is a desktop; returns whether a browser took it."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        # A browser in the terminal could show nothing.
        return False
    return webbrowser.open(path.resolve().as_uri())


def embedded(text: str, height: int = _HEIGHT) -> str:
    """A page as a part of another one, which it cannot disturb."""
    # IPython has advice for those who hand it an iframe by itself.
    return (
        f'<div><iframe srcdoc="{html.escape(text)}" width="100%" height="{height}" '
        'style="border: 1px solid #8888; border-radius: 6px" loading="lazy" '
        'title="openmm-helfrich"></iframe></div>'
    )
