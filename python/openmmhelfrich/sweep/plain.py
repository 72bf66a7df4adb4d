"""Points and results in the form in which they are stored."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .cache import RECORD

__all__ = ["plain_point", "plain_result"]


def plain_result(result: Any, name: Any) -> Any:
    """A result of the function `name`, checked, numbers as JSON keeps them; else TypeError."""
    if not isinstance(result, Mapping):
        raise TypeError(f"{name} must return a dictionary, got {_shown(result)}")
    plain = {}
    for entry, value in result.items():
        if entry in (RECORD, "seconds"):
            raise TypeError(f"{name} must not call a result {entry!r}; take another name")
        if isinstance(value, np.ndarray) and value.ndim > 0:
            if value.dtype.hasobject:
                raise TypeError(f"{name} returned objects in the array {entry!r}; return numbers")
            plain[str(entry)] = value
        else:
            plain[str(entry)] = _plain_value(value, f"{name}: result {entry!r}")
    return plain


def plain_point(point: Any) -> Any:
    """A point, checked, with numbers and lists as JSON keeps them; else TypeError."""
    where = "sweep: point"
    if not isinstance(point, Mapping):
        raise TypeError(f"{where} must be a dictionary, got {_shown(point)}")
    return {str(name): _plain_value(value, f"{where}: {name!r}") for name, value in point.items()}


def _shown(value):
    """The type of a value, and the value if it is short."""
    text = repr(value)
    return f"{type(value).__name__}: {text if len(text) <= 80 else text[:79] + '…'}"


def _plain_value(value, where):
    """The value as JSON keeps it."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, (list, tuple, range)):
        return [_plain_value(item, where) for item in value]
    if isinstance(value, Mapping):
        return {str(name): _plain_value(item, where) for name, item in value.items()}
    raise TypeError(
        f"{where} must be a number, a string, a boolean, None or a list of these, "
        f"got {type(value).__name__}"
    )
