"""A scene as one HTML file that needs neither a server nor a network.

The page has a header in JSON and, as base64, one block that is compressed by zlib, which browsers
unpack themselves. Positions are whole numbers of 16 bits across the extent of their frame, values
of vertices across their range over all frames; ``data.js`` reads what is written here.
"""

from __future__ import annotations

import base64
import html
import json
import math
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from .scene import FIELDS, Scene

__all__ = ["GENERATOR", "page"]

_HERE = Path(__file__).resolve().parent
_SCRIPTS = ("data.js", "colours.js", "camera.js", "surface.js", "plots.js", "viewer.js")

GENERATOR = '<meta name="generator" content="openmm-helfrich view">'
"""The mark of pages that may be overwritten."""

# Whole numbers of 16 bits; the last one stands for no value.
_STEPS = 65534
_NONE = 65535
# Of the values of a field, the percentiles between which colours change.
_RANGE = (2.0, 98.0)


def page(scene: Scene, *, reload: float | None = None, key: str | None = None) -> str:
    """The HTML of a scene.

    Parameters
    ----------
    scene : Scene
        With one frame at least.
    reload : float, optional
        Seconds after which the page looks for a newer one in its place. Default: never.
    key : str, optional
        The same for pages that are seen as the one before was left. Default: each by itself.

    Returns
    -------
    str
    """
    header, block = _encoded(scene)
    header |= {"reload": reload, "key": key}
    script = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in _SCRIPTS)
    parts = {
        "generator": GENERATOR,
        "title": html.escape(scene.title),
        "style": (_HERE / "viewer.css").read_text(encoding="utf-8"),
        "header": _script_safe(json.dumps(header, separators=(",", ":"), allow_nan=False)),
        "block": base64.b64encode(block).decode(),
        "script": script,
    }
    text = (_HERE / "page.html").read_text(encoding="utf-8")
    pieces = text.split("{{")
    found = [pieces[0]]
    for piece in pieces[1:]:
        name, rest = piece.split("}}", 1)
        found += [parts[name], rest]
    return "".join(found)


def _script_safe(text: str) -> str:
    """JSON in which no name can end the element that it stands in."""
    return text.replace("<", "\\u003c")


def _encoded(scene: Scene) -> tuple[dict[str, Any], bytes]:
    """The header of a scene and its compressed block."""
    ranges = [_range(scene, place) for place in range(len(FIELDS))]
    blocks, frames, meshes = [], [], []
    before = np.zeros((0, 3), dtype=np.uint32)
    for corners, surfaces in scene.meshes:
        # Flips change few triangles: what has not changed becomes zeros.
        changed = corners ^ before if corners.shape == before.shape else corners
        blocks += [_planes(changed.ravel()), _planes(surfaces)]
        meshes.append(
            {
                "triangles": len(corners),
                "points": len(surfaces),
                "after": corners.shape == before.shape,
            }
        )
        before = corners
    for frame in scene.frames:
        low = frame.points.min(axis=0).astype(float)
        size = float((frame.points.max(axis=0) - low).max()) or 1.0
        for axis in range(3):
            blocks.append(_planes(_whole(frame.points[:, axis], low[axis], size)))
        for values, (least, width) in zip(frame.fields, ranges, strict=True):
            blocks.append(_planes(_whole(values, least, width)))
        frames.append(
            {
                "step": frame.step,
                "time": frame.time,
                "mesh": frame.mesh,
                "low": low.tolist(),
                "size": size,
                "middle": frame.origin.tolist(),
            }
        )
    header = {
        "title": scene.title,
        "surfaces": scene.names,
        "fields": [
            {"name": name, **field._asdict(), "least": least, "width": width, **_colours(scene, k)}
            for k, ((name, field), (least, width)) in enumerate(
                zip(FIELDS.items(), ranges, strict=True)
            )
        ],
        "meshes": meshes,
        "frames": frames,
        "series": [
            {**each._asdict(), "values": [_json(value) for value in each.values]}
            for each in scene.series()
        ],
        "spectra": [
            None if rows is None else [[_json(value) for value in row] for row in rows]
            for rows in scene.spectra()
        ],
    }
    return header, zlib.compress(b"".join(blocks), 9)


def _whole(values: Array, least: float, width: float) -> Array:
    """Values as parts of their range, in 16 bits."""
    found = np.full(len(values), _NONE, dtype=np.uint16)
    known = np.isfinite(values)
    found[known] = np.rint((values[known] - least) / width * _STEPS).clip(0, _STEPS)
    return found


def _planes(numbers: Array) -> bytes:
    """All first bytes of little-endian numbers, all second ones and so on, which packs better."""
    size = numbers.dtype.itemsize
    numbers = np.ascontiguousarray(numbers, dtype=numbers.dtype.newbyteorder("<"))
    return numbers.view(np.uint8).reshape(-1, size).T.tobytes()


def _values(scene: Scene, field: int) -> Array:
    found = np.concatenate([frame.fields[field] for frame in scene.frames])
    return found[np.isfinite(found)].astype(float)


def _range(scene: Scene, field: int) -> tuple[float, float]:
    """Least value over all frames, and how much larger the largest one is."""
    values = _values(scene, field)
    if len(values) == 0:
        return 0.0, 1.0
    return float(values.min()), float(values.max() - values.min()) or 1.0


def _colours(scene: Scene, field: int) -> dict[str, Any]:
    """Between which values colours change: all but the extremes, so that these do not pale it."""
    values = _values(scene, field)
    if len(values) == 0:
        return {"from": 0.0, "to": 1.0}
    low, high = np.percentile(values, _RANGE)
    kind = list(FIELDS.values())[field].kind
    if kind == "whole":
        return {"from": 4.0, "to": 8.0}
    if kind == "diverging":
        middle = float(np.median(values))
        reach = max(high - middle, middle - low)
        low, high = middle - reach, middle + reach
    if not high > low:
        # All the same, but for rounding.
        low, high = low - abs(low) / 2 - 1e-9, high + abs(high) / 2 + 1e-9
    return {"from": float(low), "to": float(high)}


def _json(value: float) -> float | None:
    """JSON has no NaN."""
    return float(value) if math.isfinite(value) else None
