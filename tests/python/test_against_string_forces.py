"""The plugin against OpenMM's Custom forces, for every row, membrane and style that compiles.

OpenMM takes about a minute to compile all the expressions. Run in parallel, this file should stay
with one worker (``--dist loadfile``), so that each of them is compiled once.
"""

from __future__ import annotations

from functools import cache

import meshes
import numpy as np
import pytest
from cases import PRESENT, Case
from meshes import membrane
from oracle import STRINGS_NAMES
from platforms import ON_PROCESSOR, REFERENCE, Target
from running import BY_NAME, running
from string_forces import STYLES


@cache
def expected(name: str, where: str, style: str):
    return BY_NAME[name].expected(membrane(where), style)


def _with_strings() -> list:
    rows = []
    for case in (case for case in PRESENT if case.strings is not None):
        for where in filter(case.acts_on, [*meshes.NAMES, *STRINGS_NAMES]):
            # `test_borders.py` compares the other platforms with the first one.
            targets = [REFERENCE] if where in STRINGS_NAMES else ON_PROCESSOR
            for style in STYLES:
                if case.compiles(membrane(where), style):
                    rows += [
                        pytest.param(case, where, style, t, id=f"{case}-{where}-{style}-{t}")
                        for t in targets
                    ]
    return rows


@pytest.mark.parametrize(("case", "where", "style", "target"), _with_strings())
def test_agrees_with_string_forces(case: Case, where: str, style: str, target: Target):
    m = membrane(where)
    energy, forces = running(case.name, where, target).evaluate(m.positions)
    other = expected(case.name, where, style)
    assert energy == pytest.approx(other.energy, rel=target.tolerance)
    largest = np.abs(other.forces).max()
    assert np.abs(forces - other.forces).max() <= target.tolerance * largest
