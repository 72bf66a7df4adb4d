"""The exceptions that the Python part of openmm-helfrich raises."""

from __future__ import annotations

__all__ = ["MeshError"]


class MeshError(ValueError):
    """A mesh, or a file that should hold one, cannot be used.

    The message starts with ``Mesh``, names the culprit (which triangle, edge, vertex, line, value)
    and says what to do.
    """
