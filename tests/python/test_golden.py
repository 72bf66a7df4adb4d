"""The plugin against VCM: energies and forces per term of the golden file."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from platforms import ON_PROCESSOR, Target
from published import GOLDEN_TERMS, GoldenTerm


def _present(term: GoldenTerm) -> bool:
    cls = getattr(helfrich, term.force)
    names = [*term.settings, *([term.variant[1]] if term.variant else [])]
    return all(hasattr(cls, name) for name in names)


@pytest.mark.usefixtures("shared")
@pytest.mark.parametrize("term", [*filter(_present, GOLDEN_TERMS)], ids=str)
@pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
def test_golden(term: GoldenTerm, target: Target):
    cls = getattr(helfrich, term.force)
    arguments = term.arguments()
    if term.variant is not None:
        arguments[term.variant[0]] = getattr(cls, term.variant[1])
    force = cls(term.membrane.triangles, **arguments)
    for setter, value in term.settings.items():
        getattr(force, setter)(value)

    system = mm.System()
    for _ in term.membrane.positions:
        system.addParticle(50.0)
    system.addForce(force)
    context = target.context(system)
    context.setPositions(term.membrane.positions)
    state = context.getState(getEnergy=True, getForces=True)
    energy = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    assert energy == pytest.approx(term.energy, rel=term.tolerance, abs=0)
    forces = state.getForces(asNumpy=True).value_in_unit(unit.kilojoule_per_mole / unit.nanometer)
    assert np.abs(forces - term.forces).max() <= term.tolerance * np.abs(term.forces).max()


@pytest.mark.usefixtures("shared")
def test_every_golden_scheme_of_the_package_is_tested():
    tested = {term.variant[1] for term in GOLDEN_TERMS if term.variant and _present(term)}
    # VCM has no golden case of Espriu's scheme.
    schemes = {
        name for name, value in vars(helfrich.BendingForce).items() if isinstance(value, int)
    }
    assert "Julicher" in tested
    assert schemes - {"Espriu"} == tested
