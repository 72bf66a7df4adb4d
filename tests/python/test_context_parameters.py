"""Scalars that a Context holds: ramped during a run, and differentiated by."""

from __future__ import annotations

import meshes
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT, Case
from meshes import membrane
from openmm import unit
from platforms import ON_OPENCL, ON_PROCESSOR, Target
from test_openmm_citizen import COPIES, FIRST, assert_close, assert_same_bits, context_of, measure


def _scalars(case: Case) -> list[str]:
    arguments = case.arguments(membrane(case.place("octahedron")))
    return [name for name, value in arguments.items() if isinstance(value, float)]


EVERY_SCALAR = [
    pytest.param(case, scalar, id=f"{case}-{scalar}")
    for case in PRESENT
    # A row that has values by vertex does not use the scalar.
    if "domains" not in case.name
    for scalar in _scalars(case)
]
every_scalar = pytest.mark.parametrize(("case", "scalar"), EVERY_SCALAR)
AREA = [case for case in PRESENT if case.force == "SurfaceAreaForce"]


def _energy(context: mm.Context) -> float:
    energy = context.getState(getEnergy=True).getPotentialEnergy()
    return energy.value_in_unit(unit.kilojoule_per_mole)


def _derivatives(context: mm.Context, **also: bool) -> dict[str, float]:
    state = context.getState(getParameterDerivatives=True, **(also or {"getEnergy": True}))
    return dict(state.getEnergyParameterDerivatives())


@every_scalar
@pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
def test_stands_in_for_the_scalar(case: Case, scalar: str, target: Target):
    m = membrane(case.place("icosahedron"))
    value = case.arguments(m)[scalar]
    force = case.make(m)
    force.setContextParameter(scalar, "ramp")
    assert force.getContextParameter(scalar) == "ramp"
    context = context_of([force], m, target)
    assert context.getParameter("ramp") == value
    assert_same_bits(measure(context), measure(context_of([case.make(m)], m, target)))
    for factor in (1.1, 0.95, 1.0):
        context.setParameter("ramp", factor * value)
        fresh = context_of([case.make(m, **{scalar: factor * value})], m, target)
        assert_same_bits(measure(context), measure(fresh))


def test_stand_in_on_opencl():
    """One scalar of each class, all in one Context, because OpenCL is slow to start."""
    m = membrane("icosahedron")
    forces, values = [], {}
    for case in FIRST:
        scalar = _scalars(case)[-1]
        force = case.make(m)
        force.setContextParameter(scalar, case.force)
        values[case.force] = scalar, case.arguments(m)[scalar]
        forces.append(force)
    context = context_of(forces, m, ON_OPENCL[-1])
    for factor in (1.0, 1.07, 0.95):
        fresh = []
        for case in FIRST:
            scalar, value = values[case.force]
            context.setParameter(case.force, factor * value)
            fresh.append(case.make(m, **{scalar: factor * value}))
        assert_close(measure(context), measure(context_of(fresh, m)), 1e-9)


@every_scalar
@pytest.mark.parametrize("where", ["octahedron", "stretched", "concave"])
@pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
def test_derivative(case: Case, scalar: str, where: str, target: Target):
    m = membrane(case.place(where))
    value = case.arguments(m)[scalar]
    force = case.make(m)
    force.setContextParameter(scalar, "x")
    force.addEnergyParameterDerivative("x")
    context = context_of([force], m, target)
    derivative = _derivatives(context)["x"]

    def difference(h: float) -> float:
        context.setParameter("x", value + h)
        plus = _energy(context)
        context.setParameter("x", value - h)
        return (plus - _energy(context)) / (2 * h)

    # The second derivative by a length jumps at each cutoff: no large steps across it.
    step = (1e-5 if scalar in ("minHeight", "distance", "radius") else 1e-3) * abs(value)
    measured = (4 * difference(step) - difference(2 * step)) / 3
    assert derivative == pytest.approx(measured, rel=1e-7)
    assert abs(derivative) > 1e-6


@every_scalar
@pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
def test_derivative_whatever_else_is_asked_for(case: Case, scalar: str, target: Target):
    m = membrane(case.place("octahedron"))
    force = case.make(m)
    force.setContextParameter(scalar, "x")
    force.addEnergyParameterDerivative("x")
    context = context_of([force], m, target)
    derivative = _derivatives(context, getEnergy=True)
    assert derivative["x"] != 0
    assert _derivatives(context, getEnergy=False) == derivative
    assert _derivatives(context, getForces=True) == derivative
    assert _derivatives(context, getEnergy=True, getForces=True) == derivative


def test_derivatives_by_force_group():
    m = membrane("jittered")
    one, other = (case.make(m) for case in AREA[:2])
    for group, force in enumerate((one, other)):
        force.setContextParameter("target", f"A{group}")
        force.addEnergyParameterDerivative(f"A{group}")
        force.setForceGroup(group)
    context = context_of([one, other], m)
    everything = _derivatives(context)
    for group in (0, 1):
        state = context.getState(getEnergy=True, getParameterDerivatives=True, groups={group})
        found = dict(state.getEnergyParameterDerivatives())
        assert found[f"A{group}"] == everything[f"A{group}"] != 0
        assert found[f"A{1 - group}"] == 0


def test_two_forces_may_share_one():
    m, n = membrane("jittered"), membrane("jittered")
    forces = [helfrich.BendingForce(x.triangles, rigidity=30.0) for x in (m, n)]
    for force in forces:
        force.setContextParameter("rigidity", "kappa")
        force.addEnergyParameterDerivative("kappa")
    context = context_of(forces, m)
    context.setParameter("kappa", 70.0)
    single = _energy(context_of([helfrich.BendingForce(m.triangles, rigidity=70.0)], m))
    assert _energy(context) == pytest.approx(2 * single, rel=1e-14)
    assert _derivatives(context)["kappa"] == pytest.approx(2 * single / 70, rel=1e-14)


def test_two_scalars_of_one_force_may_share_one():
    m = membrane("jittered")
    force = helfrich.TriangleHeightForce(m.triangles, minHeight=42.0, epsilon=42.0)
    for scalar in ("minHeight", "epsilon"):
        force.setContextParameter(scalar, "both")
    force.addEnergyParameterDerivative("both")
    context = context_of([force], m)
    parts = []
    for scalar in ("minHeight", "epsilon"):
        alone = helfrich.TriangleHeightForce(m.triangles, minHeight=42.0, epsilon=42.0)
        alone.setContextParameter(scalar, "one")
        alone.addEnergyParameterDerivative("one")
        parts.append(_derivatives(context_of([alone], m))["one"])
    assert _derivatives(context)["both"] == pytest.approx(sum(parts), rel=1e-14)


def test_conflicting_defaults_are_refused():
    m = membrane("jittered")
    forces = [helfrich.BendingForce(m.triangles, rigidity=kappa) for kappa in (30.0, 40.0)]
    for force in forces:
        force.setContextParameter("rigidity", "kappa")
    with pytest.raises(mm.OpenMMException, match="kappa"):
        context_of(forces, m)
    force = helfrich.TriangleHeightForce(m.triangles, minHeight=42.0, epsilon=10.0)
    for scalar in ("minHeight", "epsilon"):
        force.setContextParameter(scalar, "both")
    with pytest.raises(mm.OpenMMException, match=r"^TriangleHeightForce: .*both"):
        context_of([force], m)


@pytest.mark.parametrize("how", COPIES)
@every_scalar
def test_survives_copying(case: Case, scalar: str, how: str):
    m = membrane(case.place("octahedron"))
    force = case.make(m)
    force.setContextParameter(scalar, "ramp")
    force.addEnergyParameterDerivative("ramp")
    contexts = [context_of([f], m) for f in (COPIES[how](force), force)]
    for context in contexts:
        context.setParameter("ramp", 1.03 * context.getParameter("ramp"))
    assert_same_bits(measure(contexts[0]), measure(contexts[1]))
    assert _derivatives(contexts[0]) == _derivatives(contexts[1])


@pytest.mark.parametrize("case", PRESENT, ids=str)
def test_unknown_names_are_refused(case: Case):
    force = case.make(membrane(case.place("octahedron")))
    with pytest.raises((ValueError, mm.OpenMMException), match=f"^{case.force}: .*stickiness"):
        force.setContextParameter("stickiness", "ramp")
    with pytest.raises((ValueError, mm.OpenMMException), match=f"^{case.force}: .*ramp"):
        force.addEnergyParameterDerivative("ramp")


@pytest.mark.parametrize(
    ("case", "bad"),
    [
        pytest.param(case, bad, id=f"{case.force}-{bad.argument}={bad.value}")
        for case in PRESENT
        for bad in case.invalid
    ],
)
def test_bad_values_during_a_run_are_refused(case: Case, bad):
    """No Force sees Context.setParameter; the next evaluation does, and names the scalar."""
    m = membrane(case.place("octahedron"))
    force = case.make(m)
    force.setContextParameter(bad.argument, "ramp")
    context = context_of([force], m)
    before, value = measure(context), context.getParameter("ramp")
    context.setParameter("ramp", bad.value)
    with pytest.raises(mm.OpenMMException, match=f"^{case.force}: .*{bad.argument}"):
        measure(context)
    context.setParameter("ramp", value)
    assert_same_bits(measure(context), before)


def test_update_in_context_leaves_context_parameters():
    """As for OpenMM's own forces: a Context's parameter is the Context's from then on."""
    m = membrane(meshes.NAMES[0])
    force = helfrich.BendingForce(m.triangles, rigidity=30.0, spontaneousCurvature=0.01)
    force.setContextParameter("rigidity", "kappa")
    context = context_of([force], m)
    force.setRigidity(90.0)
    force.setSpontaneousCurvature(-0.005)
    force.updateParametersInContext(context)
    assert context.getParameter("kappa") == 30.0
    fresh = helfrich.BendingForce(m.triangles, rigidity=30.0, spontaneousCurvature=-0.005)
    assert_close(measure(context), measure(context_of([fresh], m)), 1e-14)


def test_a_parameter_that_comes_or_goes_needs_a_new_context():
    """Its value would be taken from a parameter that the Context does not have, or has still."""
    mesh = membrane("octahedron")
    force = helfrich.SurfaceAreaForce(mesh.triangles, 3.0, 100.0)
    force.setContextParameter("target", "A0")
    system = mm.System()
    for _ in range(mesh.num_particles):
        system.addParticle(1.0)
    system.addForce(force)
    context = mm.Context(system, mm.VerletIntegrator(0.001))
    context.setPositions(mesh.positions)
    force.setTarget(50.0)
    force.updateParametersInContext(context)
    for parameter, name in (("target", ""), ("modulus", "kA"), ("target", "other")):
        before = force.getContextParameter(parameter)
        force.setContextParameter(parameter, name)
        with pytest.raises(
            mm.OpenMMException, match=rf"parameter of {parameter} has changed .*reinitialize"
        ):
            force.updateParametersInContext(context)
        force.setContextParameter(parameter, before)
    force.updateParametersInContext(context)
