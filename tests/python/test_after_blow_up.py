"""A Context that has seen what no simulation survives goes on as a new one does."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT, Case
from meshes import Membrane, membrane
from platforms import HELFRICH, NATIVE, ON_GPU, ON_PROCESSOR, Target, sparing
from running import Running

# Contacts act where things touch.
PLACES = [
    pytest.param(case, where, id=f"{case}-{where}")
    for case in PRESENT
    for where in ([meshes.TOUCHING_NAMES[0]] if case.is_contact else [case.place("jittered")])
]


def broken(good: np.ndarray, members: np.ndarray) -> Iterator[np.ndarray]:
    """Positions of a simulation that breaks down: some fly away, or all, or are no numbers."""
    one = members[len(members) // 2]
    for far in (1e4, 1e10, 1e16, 1e22, 1e40, 1e80, 1e160, 1e300, np.inf, np.nan):
        flown = good.copy()
        flown[one] *= far
        yield flown
    for scale in (1e10, 1e16, 1e22, 1e40, 1e80, 1e160, 1e300, np.nan):
        yield good * scale
    flat = good.copy()
    flat[:, 2] = 0
    yield flat
    yield np.zeros_like(good)


def check(running: Running, m: Membrane) -> None:
    energy, forces = running.evaluate(m.positions)
    assert np.isfinite(energy)
    for bad in broken(m.positions, m.members):
        # A second evaluation looks whether the first one has left something that it takes for good.
        for _ in range(2):
            with suppress(mm.OpenMMException):
                running.evaluate(bad)
        again = running.evaluate(m.positions)
        assert again[0] == energy
        assert np.array_equal(again[1], forces)


@pytest.mark.parametrize(("case", "where"), PLACES)
def test_each(case: Case, where: str):
    m = membrane(where)
    check(Running([case.make(m)], m.num_particles, HELFRICH), m)


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_GPU, *sparing(NATIVE)], ids=str)
def test_the_paper_forces_together(target: Target):
    m = membrane("jittered")
    forces = [
        helfrich.BendingForce(m.triangles, 50.0),
        helfrich.SurfaceAreaForce(m.triangles, 1.3, 2.0),
        helfrich.EnclosedVolumeForce(m.triangles, 1e-3, 1.0),
        helfrich.TriangleHeightForce(m.triangles, 0.3, 10.0),
    ]
    check(Running(forces, m.num_particles, target), m)
