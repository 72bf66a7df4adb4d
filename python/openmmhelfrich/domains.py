"""Values of vertices from a table of domains."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from openmm import unit

from ._surfaces import domain_array

__all__ = ["values_of_domains"]


def values_of_domains(domains: ArrayLike, table: Mapping[Any, Any]) -> dict[str, Any]:
    """The values of all vertices, from what those of each domain have.

    ::

        values = helfrich.values_of_domains(domains, {
            0: {"rigidity": 50, "spontaneousCurvature": 0},
            1: {"rigidity": 100, "spontaneousCurvature": 0.01},
        })
        system.addForce(helfrich.BendingForce(mesh, **values))
        system.addForce(helfrich.LineTensionForce(mesh, 2, domains))

    Parameters
    ----------
    domains : array_like of int, shape (num_vertices,)
        The number of each vertex' domain.
    table : mapping of int to mapping of str to float or Quantity
        For each domain its values by any names, the same for all domains. There may be domains that
        no vertex has.

    Returns
    -------
    dict of str to ndarray or Quantity, shape (num_vertices,)
        By the same names; a Quantity where the first domain of the table has one.

    Raises
    ------
    TypeError
        If domains are not integers, the table is no mapping of mappings, or a value is no number or
        of another unit than that of the first domain.
    ValueError
        If a vertex has a domain, or a domain lacks a name, that is not in the table, or a value is
        not finite.
    """
    numbers = domain_array("values_of_domains", domains).astype(np.int64)
    if not isinstance(table, Mapping):
        raise TypeError(f"values_of_domains: the table needs a mapping of domains, got {table!r}")
    for domain, values in table.items():
        if not isinstance(values, Mapping):
            raise TypeError(
                f"values_of_domains: domain {domain} needs a mapping of names to values, got "
                f"{values!r}"
            )
    rows = {int(domain): dict(values) for domain, values in table.items()}
    if not rows:
        raise ValueError("values_of_domains: the table is empty")
    kinds = np.array(list(rows))
    absent = np.flatnonzero(~np.isin(numbers, kinds))
    if absent.size:
        raise ValueError(
            f"values_of_domains: vertex {absent[0]} is of domain {numbers[absent[0]]}, which is "
            f"not in the table; it has {', '.join(map(str, sorted(rows)))}"
        )
    names = list(dict.fromkeys(name for values in rows.values() for name in values))
    places = np.searchsorted(np.sort(kinds), numbers)
    found = {}
    for name in names:
        values, dimension = _of_all(name, rows)
        of_vertices = np.array([values[kind] for kind in sorted(rows)])[places]
        found[name] = of_vertices if dimension is None else of_vertices * dimension
    return found


def _of_all(name: str, rows: dict[str, Any]) -> tuple[dict[int, float], unit.Unit | None]:
    """The values of one name by their domains, and their unit, if they have one."""
    for domain, values in rows.items():
        if name not in values:
            raise ValueError(
                f"values_of_domains: domain {domain} has no {name!r}, which others have"
            )
    first = next(iter(rows.values()))[name]
    dimension = first.unit if unit.is_quantity(first) else None
    plain = {}
    for domain, values in rows.items():
        value = values[name]
        where = f"values_of_domains: {name!r} of domain {domain}"
        if unit.is_quantity(value) != (dimension is not None) or (
            dimension is not None and not value.unit.is_compatible(dimension)
        ):
            raise TypeError(f"{where} is {value}, but that of the first domain is {first}")
        if dimension is not None:
            value = value.value_in_unit(dimension)
        if isinstance(value, (bool, np.bool_, str, bytes)):
            raise TypeError(f"{where} must be a number, got {value!r}")
        try:
            plain[domain] = float(value)
        except (TypeError, ValueError):
            raise TypeError(f"{where} must be a number, got {value!r}") from None
        if not np.isfinite(plain[domain]):
            raise ValueError(f"{where} must be finite, got {value!r}")
    return plain, dimension
