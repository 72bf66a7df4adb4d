"""Every row of the table of cases, on every membrane and platform.

The forces are held against differences of their own energy (their meaning) and against what
Newton's laws say of any internal force, their energies against numpy's. Other implementations are
in `test_against_string_forces.py` and `test_golden.py`.
"""

from __future__ import annotations

from functools import cache

import meshes
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import CASES, PRESENT, Case
from meshes import Membrane, membrane
from openmm import unit
from platforms import ON_OPENCL, ON_PROCESSOR, REFERENCE, Target
from running import Running, running

# OpenMM has 32 force groups.
BATCHES = [PRESENT[first : first + 32] for first in range(0, len(PRESENT), 32)]


@cache
def all_together(batch: int, where: str, target: Target) -> Running:
    """Many rows in one Context, each in its own force group: OpenCL is slow to start."""
    m = membrane(where)
    return Running([case.make(m) for case in BATCHES[batch]], m.num_particles, target)


def on(*names: str):
    """All rows on membranes of these names, as far as they act on them."""
    rows = [
        pytest.param(case, where, id=f"{case}-{where}")
        for where in names
        for case in PRESENT
        if case.acts_on(where)
    ]
    return pytest.mark.parametrize(("case", "where"), rows)


every_place = on(*meshes.NAMES, *meshes.TOUCHING_NAMES)
on_processor = pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


# --- the table -----------------------------------------------------------------------------------


def test_every_force_class_has_a_row():
    classes = {
        name
        for name, value in vars(helfrich).items()
        if isinstance(value, type) and issubclass(value, helfrich.MembraneForce)
    }
    # The base class is not for users to make.
    assert classes - {"MembraneForce"} == {case.force for case in PRESENT}


def test_every_variant_has_a_row():
    for keyword, force in (
        ("scheme", "BendingForce"),
        ("form", "DihedralForce"),
        ("form", "SpringForce"),
        ("attraction", "ParticleSurfaceForce"),
    ):
        cls = getattr(helfrich, force, None)
        if cls is None:
            continue
        constants = {
            name
            for name, value in vars(cls).items()
            if name[0].isupper() and isinstance(value, int)
        }
        rows = {case.variant for case in PRESENT if case.force == force}
        assert {(keyword, name) for name in constants} == rows


def test_names_are_unique():
    assert len({case.name for case in CASES}) == len(CASES)


@every_place
def test_something_is_computed(case: Case, where: str):
    """A row that exerts no force would pass all that follows."""
    _, forces = running(case.name, where, REFERENCE).evaluate(membrane(where).positions)
    assert np.abs(forces).max() > 0.05


# --- other implementations -----------------------------------------------------------------------


@every_place
@on_processor
def test_energy_is_that_of_numpy(case: Case, where: str, target: Target):
    m = membrane(where)
    energy = running(case.name, where, target).energy(m.positions)
    assert energy == pytest.approx(case.expected_energy(m), rel=1e-11)


# --- what the forces mean ------------------------------------------------------------------------


def _slope(run: Running, positions, direction, step: float) -> float:
    """The energy's derivative along a direction: central differences of two steps, extrapolated.

    The error is of fourth order, so that the step can be large enough for rounding not to matter.
    """

    def difference(h: float) -> float:
        plus = run.energy(positions + h * direction)
        return (plus - run.energy(positions - h * direction)) / (2 * h)

    return (4 * difference(step) - difference(2 * step)) / 3


@on("octahedron", "icosahedron", "many neighbours")
@on_processor
def test_forces_are_the_gradient_by_coordinate(case: Case, where: str, target: Target):
    m = membrane(where)
    run = running(case.name, where, target)
    _, forces = run.evaluate(m.positions)
    measured = np.zeros_like(forces)
    direction = np.zeros_like(forces)
    for particle in case.acted_on(m):
        for axis in range(3):
            direction[particle, axis] = 1
            measured[particle, axis] = -_slope(run, m.positions, direction, case.step * m.mean_edge)
            direction[particle, axis] = 0
    assert np.abs(measured - forces).max() <= 1e-6 * np.abs(forces).max()


@on("jittered", "stretched", "concave", "two parts", *meshes.TOUCHING_NAMES)
@on_processor
def test_forces_are_the_gradient_along_directions(case: Case, where: str, target: Target):
    """Random directions, of which each sees every particle; the larger membranes' share."""
    m = membrane(where)
    run = running(case.name, where, target)
    _, forces = run.evaluate(m.positions)
    rng = np.random.default_rng(23)
    moving = case.acted_on(m)
    for _ in range(6):
        direction = np.zeros_like(forces)
        direction[moving] = rng.uniform(-1, 1, (len(moving), 3))
        measured = _slope(run, m.positions, direction, case.step * m.mean_edge)
        assert abs(measured + np.sum(forces * direction)) <= 1e-6 * np.abs(forces).max()


@every_place
@on_processor
def test_a_step_along_the_forces_lowers_the_energy(case: Case, where: str, target: Target):
    m = membrane(where)
    run = running(case.name, where, target)
    energy, forces = run.evaluate(m.positions)
    size = np.linalg.norm(forces)
    step = case.step * m.mean_edge
    uphill = -forces / size
    assert _slope(run, m.positions, uphill, step) == pytest.approx(size, rel=1e-6)
    assert run.energy(m.positions - step * uphill) < energy
    assert run.energy(m.positions + step * uphill) > energy


@every_place
@on_processor
def test_no_net_force_and_no_net_torque(case: Case, where: str, target: Target):
    m = membrane(where)
    _, forces = running(case.name, where, target).evaluate(m.positions)
    assert np.abs(forces.sum(axis=0)).max() <= 1e-10 * np.linalg.norm(forces, axis=1).sum()
    torques = np.cross(m.positions - m.positions[m.members].mean(axis=0), forces)
    assert np.abs(torques.sum(axis=0)).max() <= 1e-10 * np.linalg.norm(torques, axis=1).sum()


@every_place
@on_processor
def test_particles_of_no_membrane_feel_nothing(case: Case, where: str, target: Target):
    m = membrane(where)
    _, forces = running(case.name, where, target).evaluate(m.positions)
    assert not forces[case.strangers(m)].any()


@every_place
@on_processor
def test_rigid_motions(case: Case, where: str, target: Target):
    m = membrane(where)
    run = running(case.name, where, target)
    energy, forces = run.evaluate(m.positions)
    turn = rotation(29)
    moved_energy, moved_forces = run.evaluate(m.positions @ turn.T + [250.0, -400.0, 130.0])
    assert moved_energy == pytest.approx(energy, rel=1e-11)
    largest = np.abs(forces).max()
    assert np.abs(moved_forces - forces @ turn.T).max() <= 1e-9 * largest


# The order matters only to what has a value for each triangle.
@pytest.mark.parametrize(
    "case",
    [c for c in PRESENT if not c.name.endswith("each") and c.acts_on("stretched")],
    ids=str,
)
@on_processor
def test_order_of_triangles_and_corners_does_not_matter(case: Case, target: Target):
    m = membrane("stretched")
    rng = np.random.default_rng(31)
    order = rng.permutation(len(m.triangles))
    turned = np.roll(m.triangles[order], 1, axis=1)
    other = Running([case.make(Membrane("turned", m.positions, turned))], m.num_particles, target)
    energy, forces = running(case.name, "stretched", target).evaluate(m.positions)
    other_energy, other_forces = other.evaluate(m.positions)
    assert other_energy == pytest.approx(energy, rel=1e-11)
    assert np.abs(other_forces - forces).max() <= 1e-10 * np.abs(forces).max()


@on("concave", "mixed", *meshes.TOUCHING_NAMES)
def test_the_same_positions_give_the_same_bits(case: Case, where: str):
    m = membrane(where)
    run = running(case.name, where, REFERENCE)
    energy, forces = run.evaluate(m.positions)
    run.evaluate(1.01 * m.positions)
    again, forces_again = run.evaluate(m.positions)
    assert energy == again
    np.testing.assert_array_equal(forces, forces_again)


# --- OpenCL --------------------------------------------------------------------------------------


@on("jittered", "concave", *meshes.TOUCHING_NAMES)
@pytest.mark.parametrize("target", ON_OPENCL, ids=str)
def test_opencl(case: Case, where: str, target: Target):
    """Each row alone, by its force group, among all others in the Context."""
    m = membrane(where)
    batch, group = divmod(PRESENT.index(case), 32)
    energy, forces = all_together(batch, where, target).evaluate(m.positions, group)
    # The Reference platform stands in for the string forces, which it agrees with to 1e-9.
    other_energy, other_forces = running(case.name, where, REFERENCE).evaluate(m.positions)
    assert energy == pytest.approx(other_energy, rel=max(target.tolerance, 1e-9))
    largest = np.abs(other_forces).max()
    assert np.abs(forces - other_forces).max() <= target.tolerance * largest
    assert not forces[case.strangers(m)].any()


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_OPENCL], ids=str)
def test_the_sum_of_all_forces(target: Target):
    m = membrane("jittered")
    for number, batch in enumerate(BATCHES):
        energy, forces = all_together(number, "jittered", target).evaluate(m.positions)
        parts = [running(case.name, "jittered", REFERENCE).evaluate(m.positions) for case in batch]
        assert energy == pytest.approx(sum(e for e, _ in parts), rel=target.tolerance)
        total = sum(f for _, f in parts)
        assert np.abs(forces - total).max() <= target.tolerance * np.abs(total).max()


# --- refused arguments ---------------------------------------------------------------------------


def _refused() -> list:
    return [
        pytest.param(case, bad, id=f"{case.force}-{bad.argument}={bad.value}")
        for case in PRESENT
        for bad in case.invalid
    ]


def _assert_names(error, case: Case, argument: str, fragment: str = "") -> None:
    message = str(error.value)
    assert message.startswith(case.force), message
    assert argument.lower() in message.lower().replace("_", ""), message
    assert fragment.lower() in message.lower(), message


@pytest.mark.parametrize(("case", "bad"), _refused())
def test_refused_by_the_constructor(case: Case, bad):
    with pytest.raises((ValueError, mm.OpenMMException)) as error:
        case.make(membrane("octahedron"), **{bad.argument: bad.value})
    _assert_names(error, case, bad.argument, bad.fragment)


@pytest.mark.parametrize(("case", "bad"), _refused())
def test_refused_by_the_setter(case: Case, bad):
    force = case.make(membrane("octahedron"))
    name = bad.argument[0].upper() + bad.argument[1:]
    before = getattr(force, f"get{name}")()
    with pytest.raises((ValueError, mm.OpenMMException)) as error:
        getattr(force, f"set{name}")(bad.value)
    _assert_names(error, case, bad.argument, bad.fragment)
    assert getattr(force, f"get{name}")() == before


def _arguments() -> list:
    rows = {}
    for case in PRESENT:
        for argument in case.arguments(membrane("octahedron")):
            rows.setdefault((case.force, argument), case)
    return [
        pytest.param(case, argument, id=f"{force}-{argument}")
        for (force, argument), case in rows.items()
    ]


@pytest.mark.parametrize(("case", "argument"), _arguments())
@pytest.mark.parametrize("bad", [3.0 * unit.kelvin, "much", None], ids=str)
def test_refused_units_and_types(case: Case, argument: str, bad):
    with pytest.raises((TypeError, ValueError)) as error:
        case.make(membrane("octahedron"), **{argument: bad})
    _assert_names(error, case, argument)


@pytest.mark.parametrize(("case", "argument"), _arguments())
def test_a_wrong_number_of_values(case: Case, argument: str):
    """Refused at once by a scalar, and by what may have a value for each of its elements as soon
    as their number is known.
    """
    m = membrane("octahedron")
    with pytest.raises((TypeError, ValueError, mm.OpenMMException)) as error:
        Running([case.make(m, **{argument: [1.0, 2.0, 3.0]})], m.num_particles, REFERENCE)
    # A setter for the elements may say "vertexRigidity" or "triangleTargets".
    _assert_names(error, case, argument)


VALUES = [
    ("BendingForce", "rigidity", "setVertexRigidity", [np.nan, np.inf, -1.0]),
    (
        "BendingForce",
        "spontaneousCurvature",
        "setVertexSpontaneousCurvature",
        [np.nan, np.inf, -np.inf],
    ),
    ("TriangleAreaForce", "target", "setTriangleTargets", [np.nan, np.inf, -1.0, 0.0]),
    ("ParticleSurfaceForce", "radius", "setParticleRadius", [np.nan, np.inf, -1.0]),
    ("DihedralForce", "stiffness", "setEdgeStiffness", [np.nan, np.inf, -1.0]),
    ("DihedralForce", "restAngle", "setEdgeRestAngle", [np.nan, 3.2, -4.0]),
]


def _num_elements(case: Case, m: Membrane) -> int:
    """Of how many things each has a value of its own."""
    if case.others is not None:
        return len(case.others(m))
    if case.force == "DihedralForce":
        return 3 * len(m.triangles) // 2
    return len(m.members) if case.force == "BendingForce" else len(m.triangles)


@pytest.mark.parametrize(("force", "argument", "setter", "refused"), VALUES)
def test_one_bad_value_of_many(force: str, argument: str, setter: str, refused: list[float]):
    case = next(case for case in PRESENT if case.force == force)
    m = membrane("octahedron")
    count = _num_elements(case, m)
    for value in refused:
        values = [1.0] * count
        values[4] = value
        for give in (
            lambda values=values: case.make(m, **{argument: values}),
            lambda values=values: getattr(case.make(m), setter)(values),
        ):
            with pytest.raises((ValueError, mm.OpenMMException)) as error:
                Running([give()], m.num_particles, REFERENCE)
            _assert_names(error, case, argument, "4")


@pytest.mark.parametrize(("force", "argument", "setter", "refused"), VALUES)
def test_values_by_element(force: str, argument: str, setter: str, refused: list[float]):
    """By keyword, by setter and by update; an empty list goes back to the scalar."""
    case = next(case for case in PRESENT if case.force == force)
    m = membrane("octahedron")
    count = _num_elements(case, m)
    rng = np.random.default_rng(41)
    values = rng.uniform(0.01, 0.02, count)
    first = Running([case.make(m, **{argument: values})], m.num_particles, REFERENCE)
    expected_energy, expected_forces = first.evaluate(m.positions)
    force = case.make(m)
    run = Running([force], m.num_particles, REFERENCE)
    scalar = run.evaluate(m.positions)
    assert scalar[0] != expected_energy
    for given, energy, forces in ((values, expected_energy, expected_forces), ([], *scalar)):
        getattr(force, setter)(given)
        np.testing.assert_array_equal(getattr(force, setter.replace("set", "get"))(), given)
        force.updateParametersInContext(run.context)
        assert run.energy(m.positions) == energy
        np.testing.assert_array_equal(run.evaluate(m.positions)[1], forces)
