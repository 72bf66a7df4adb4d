"""Surfaces in a browser: one HTML file with everything in it, without a server or a network."""

from .live import LiveView
from .notebooks import register as _register
from .page import page
from .scene import Scene
from .views import View, view

_register()

__all__ = ["LiveView", "Scene", "View", "page", "view"]
