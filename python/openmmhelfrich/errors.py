"""The exceptions of the Python part of openmm-helfrich, and the pages that explain them."""

from __future__ import annotations

__all__ = ["FAQ", "Explained", "MeshError"]

#: The page of the documentation that lists messages, and what to do.
FAQ = "docs/troubleshooting.md"


class Explained:
    """An exception of which a page of the documentation says more.

    Tracebacks name it from Python 3.11 on, commands always.

    Attributes
    ----------
    page : str
        With its anchor.
    """

    page = FAQ

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)
        # Python 3.10 has no place for it.
        if hasattr(self, "add_note"):
            self.add_note(f"See {self.page}")


class MeshError(Explained, ValueError):
    """A mesh, or a file that should hold one, cannot be used.

    The message starts with ``Mesh``, names the culprit (which triangle, edge, vertex, line, value)
    and says what to do.
    """

    page = f"{FAQ}#meshes"
