"""The forces as OpenMM Forces: everything that a user of OpenMM expects of any force."""

from __future__ import annotations

import copy
import gc
import itertools
import os
import pickle
import re
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT, Case
from meshes import Membrane, icosphere, membrane, rough
from openmm import unit
from platforms import CPU, ON_OPENCL, ON_PROCESSOR, REFERENCE, Target
from string_forces import rings

OPENCL_SINGLE, _, OPENCL_DOUBLE = ON_OPENCL
EVERYWHERE = [*ON_PROCESSOR, OPENCL_DOUBLE]

every_case = pytest.mark.parametrize("case", PRESENT, ids=str)
# One row for each class: for what the base class does.
FIRST = list({case.force: case for case in reversed(PRESENT)}.values())[::-1]
CLOSED = [case for case in FIRST if case.surface != "open"]
every_class = pytest.mark.parametrize("case", FIRST, ids=[case.force for case in FIRST])
everywhere = pytest.mark.parametrize("target", EVERYWHERE, ids=str)


def plain(quantity):
    return quantity.value_in_unit_system(unit.md_unit_system)


def system_of(forces, num_particles: int, mass: float = 50.0) -> mm.System:
    system = mm.System()
    for _ in range(num_particles):
        system.addParticle(mass)
    for force in forces:
        system.addForce(force)
    return system


def context_of(forces, m: Membrane, target: Target = REFERENCE) -> mm.Context:
    context = target.context(system_of(forces, m.num_particles))
    context.setPositions(m.positions)
    return context


def measure(context: mm.Context, groups=-1) -> tuple[float, np.ndarray]:
    state = context.getState(getEnergy=True, getForces=True, groups=groups)
    return plain(state.getPotentialEnergy()), plain(state.getForces(asNumpy=True))


def assert_same_bits(one: tuple[float, np.ndarray], other: tuple[float, np.ndarray]) -> None:
    assert one[0] == other[0]
    np.testing.assert_array_equal(one[1], other[1])


def assert_close(one, other, tolerance: float) -> None:
    assert one[0] == pytest.approx(other[0], rel=tolerance)
    assert np.abs(one[1] - other[1]).max() <= tolerance * np.abs(other[1]).max()


# --- triangles -----------------------------------------------------------------------------------


class TestTriangles:
    @every_class
    def test_are_given_back(self, case: Case):
        m = membrane("jittered")
        force = case.make(m)
        assert force.getNumTriangles() == len(m.triangles)
        for i, row in enumerate(m.triangles.tolist()):
            assert list(force.getTriangle(i)) == row

    @every_class
    @pytest.mark.parametrize("index", [-1, 8, 1000])
    def test_there_is_no_such_triangle(self, case: Case, index: int):
        with pytest.raises((IndexError, mm.OpenMMException), match=f"^{case.force}: .*{index}"):
            case.make(membrane("octahedron")).getTriangle(index)

    @every_class
    def test_of_any_kind(self, case: Case):
        m = membrane("octahedron")
        first = measure(context_of([case.make(m)], m))
        for triangles in (
            m.triangles.tolist(),
            [tuple(row) for row in m.triangles.tolist()],
            m.triangles.astype(np.int32),
            m.triangles.astype(np.uint16),
            np.asfortranarray(m.triangles),
            np.repeat(m.triangles, 2, axis=0)[::2],
        ):
            assert_same_bits(measure(context_of([case.make_on(triangles, m)], m)), first)

    @every_class
    def test_one_by_one(self, case: Case):
        m = membrane("octahedron")
        force = case.make_on([], m)
        for i, (a, b, c) in enumerate(m.triangles.tolist()):
            assert force.addTriangle(a, b, c) == i
        assert_same_bits(measure(context_of([force], m)), measure(context_of([case.make(m)], m)))

    @every_class
    def test_of_a_mesh_with_an_offset(self, case: Case):
        mesh = helfrich.Mesh(*rough(icosphere(1), np.random.default_rng(1), 0.2)).scaled(80)
        beads = np.random.default_rng(2).uniform(-120, 120, (9, 3))
        m = Membrane("mesh", np.concatenate([mesh.vertices, beads]), mesh.triangles)
        first = measure(context_of([case.make_on(mesh, m)], m))
        shifted = Membrane(
            "shifted", np.concatenate([np.zeros((5, 3)), m.positions]), mesh.triangles
        )
        force = case.make_on(mesh, m, shift=5, offset=5)
        energy, forces = measure(context_of([force], shifted))
        assert not forces[:5].any()
        assert_same_bits((energy, forces[5:]), first)

    @every_class
    @pytest.mark.parametrize(
        ("triangles", "error", "fragment"),
        [
            ([[1, 2]], ValueError, "(1, 2)"),
            ([1, 2, 3], ValueError, "(3,)"),
            ([[[1, 2, 3]]], ValueError, "(1, 1, 3)"),
            ([[1, 2, 3], [1, 2]], ValueError, "length"),
            (np.ones((4, 3)), TypeError, "float64"),
            (np.ones((4, 3), dtype=bool), TypeError, "bool"),
            ([["a", "b", "c"]], TypeError, "integers"),
            (None, (TypeError, ValueError), "triangles"),
            ([[0, 1, 2**40]], ValueError, str(2**40)),
        ],
        ids=repr,
    )
    def test_of_wrong_shape_or_type(self, case: Case, triangles, error, fragment: str):
        with pytest.raises(error) as raised:
            case.make_on(triangles, membrane("octahedron"))
        assert str(raised.value).startswith(f"{case.force}: ")
        assert fragment in str(raised.value)


# Six vertices with an edge between any two, ten triangles: the projective plane.
PROJECTIVE_PLANE = [
    (0, 1, 4),
    (0, 1, 5),
    (0, 2, 3),
    (0, 2, 5),
    (0, 3, 4),
    (1, 2, 3),
    (1, 2, 4),
    (1, 3, 5),
    (2, 4, 5),
    (3, 4, 5),
]


def _faults() -> dict[str, tuple]:
    """Triangles that are no oriented surface of 15 particles, and words of the message."""
    m = membrane("octahedron")
    t = m.triangles
    assert m.num_particles == 15
    a, b, _ = t[0].tolist()

    def edges(row) -> set[str]:
        return {rf"\({min(e)}, {max(e)}\)" for e in itertools.pairwise([*row, row[0]])}

    beyond, below = t.copy(), t.copy()
    beyond[3, 1], below[2, 0] = 15, -1
    repeated = t.copy()
    repeated[5, 2] = repeated[5, 0]
    reversed_one = t.copy()
    reversed_one[4] = reversed_one[4][::-1]
    # A second floor within the octahedron: three triangles at each edge of its equator.
    w, x, y, z = rings(t)[m.members[0]]
    floor = np.concatenate([t, [(w, x, y), (w, y, z)]])
    equator = "|".join(edges([w, x, y, z]))
    # A tetrahedron that touches the octahedron in an edge, and another one in a vertex only.
    q, r, s = m.foreign[1:4]
    glued = np.concatenate([t, [(a, b, q), (b, a, r), (a, q, r), (b, r, q)]])
    pinched = np.concatenate([t, [(a, q, r), (a, r, s), (a, s, q), (q, s, r)]])
    assert all(
        sum(set(pair) <= set(row) for row in PROJECTIVE_PLANE) == 2
        for pair in itertools.combinations(range(6), 2)
    )
    return {
        "empty": (np.empty((0, 3), dtype=int), ["no triangles"]),
        "beyond": (beyond, [r"\b15\b", r"triangle 3\b"]),
        "negative": (below, [r"-1\b", r"triangle 2\b"]),
        "repeated index": (repeated, [r"triangle 5\b", rf"\b{repeated[5, 0]}\b"]),
        "duplicate": (np.concatenate([t, t[2:3]]), [r"\b2\b", r"\b8\b"]),
        "duplicate turned": (
            np.concatenate([t, [np.roll(t[2], 1)]]),
            [r"\b2\b", r"\b8\b"],
        ),
        "duplicate reversed": (np.concatenate([t, [t[2][::-1]]]), [r"\b2\b", r"\b8\b"]),
        "three at an edge": (floor, [equator, r"\b3 triangles"]),
        "four at an edge": (glued, [rf"\({min(a, b)}, {max(a, b)}\)", r"\b4 triangles"]),
        "turned over": (reversed_one, ["|".join(edges(reversed_one[4])), r"\b4\b"]),
        "pinched": (pinched, [rf"vertex {a}\b"]),
        "no inside": (np.array(PROJECTIVE_PLANE), [r"triangles? \d", r"\(\d, \d\)"]),
    }


@every_class
@pytest.mark.parametrize("fault", _faults())
def test_no_oriented_surface(case: Case, fault: str):
    """Refused when the Context is created, which is when the particles are known."""
    triangles, words = _faults()[fault]
    m = membrane("octahedron")
    force = case.make_on(triangles, m)
    with pytest.raises(mm.OpenMMException) as error:
        context_of([force], m)
    assert str(error.value).startswith(f"{case.force}: ")
    for word in words:
        assert re.search(word, str(error.value)), (word, str(error.value))


@pytest.mark.parametrize("target", [CPU, OPENCL_DOUBLE], ids=str)
def test_no_oriented_surface_on_other_platforms(target: Target):
    m = membrane("octahedron")
    turned = np.where(np.arange(len(m.triangles))[:, None] == 3, m.triangles[:, ::-1], m.triangles)
    force = helfrich.BendingForce(turned, rigidity=1)
    with pytest.raises(mm.OpenMMException, match=r"^BendingForce: .*in the same direction"):
        context_of([force], m, target)


@pytest.mark.parametrize("target", [CPU, OPENCL_DOUBLE], ids=str)
def test_no_volume_within_a_border_on_other_platforms(target: Target):
    m = membrane("octahedron")
    force = helfrich.EnclosedVolumeForce(m.triangles[1:], modulus=1, target=1)
    corners = ", ".join(r"\d" for _ in range(3))
    words = rf"^EnclosedVolumeForce: .*a border of 3 edges through particles {corners}"
    with pytest.raises(mm.OpenMMException, match=words):
        context_of([helfrich.BendingForce(m.triangles[1:], rigidity=1), force], m, target)


# --- scalars -------------------------------------------------------------------------------------


class TestScalars:
    @every_class
    def test_are_given_back(self, case: Case):
        m = membrane("octahedron")
        force = case.make(m)
        for name, value in case.arguments(m).items():
            found = plain_number(getattr(force, f"get{name[0].upper()}{name[1:]}")())
            np.testing.assert_array_equal(found, value)

    @pytest.mark.parametrize(
        ("force", "arguments", "quantities"),
        [
            (
                "SurfaceAreaForce",
                {"modulus": 1.3, "target": 4e4},
                {
                    "modulus": 0.013 * unit.kilojoule_per_mole / unit.angstrom**2,
                    "target": 4e6 * unit.angstrom**2,
                },
            ),
            (
                "EnclosedVolumeForce",
                {"modulus": 0.04, "target": 2e5},
                {
                    "modulus": 0.04e-3 * unit.kilojoule_per_mole / unit.angstrom**3,
                    "target": 2e8 * unit.angstrom**3,
                },
            ),
            (
                "TriangleHeightForce",
                {"minHeight": 80.0, "epsilon": 10.46},
                {"minHeight": 800 * unit.angstrom, "epsilon": 2.5 * unit.kilocalorie_per_mole},
            ),
            (
                "BendingForce",
                {"rigidity": 41.84, "spontaneousCurvature": 0.02},
                {
                    "rigidity": 10 * unit.kilocalorie_per_mole,
                    "spontaneousCurvature": 0.002 / unit.angstrom,
                },
            ),
        ],
        ids=lambda value: value if isinstance(value, str) else "",
    )
    def test_as_quantities(self, force: str, arguments: dict, quantities: dict):
        m = membrane("octahedron")
        cls = getattr(helfrich, force)
        numbers = measure(context_of([cls(m.triangles, **arguments)], m))
        assert_close(measure(context_of([cls(m.triangles, **quantities)], m)), numbers, 1e-12)
        other = cls(m.triangles, **dict.fromkeys(arguments, 1.0))
        for name, value in quantities.items():
            getattr(other, f"set{name[0].upper()}{name[1:]}")(value)
        assert_close(measure(context_of([other], m)), numbers, 1e-12)

    @every_class
    @pytest.mark.parametrize("bad", [1.0 * unit.picosecond, 1.0 * unit.dalton], ids=str)
    def test_setters_refuse_other_units(self, case: Case, bad):
        force = case.make(membrane("octahedron"))
        for name in case.arguments(membrane("octahedron")):
            with pytest.raises((TypeError, ValueError), match=f"^{case.force}.*{name}"):
                getattr(force, f"set{name[0].upper()}{name[1:]}")(bad)

    def test_forces_scale_with_their_stiffness(self):
        for case in FIRST:
            m = membrane(case.place("jittered"))
            given = case.arguments(m)
            names = {"modulus", "rigidity", "epsilon", "stiffness", "tension", "pressure"}
            names |= {"thermalEnergy", "shearModulus", "areaModulus"}
            names &= set(given)
            assert names
            energy, forces = measure(context_of([case.make(m)], m))
            double = measure(context_of([case.make(m, **{n: 2 * given[n] for n in names})], m))
            assert_close(double, (2 * energy, 2 * forces), 1e-13)
            if "thermalEnergy" in names:
                continue  # It is above zero.
            nothing = measure(context_of([case.make(m, **dict.fromkeys(names, 0.0))], m))
            assert nothing[0] == 0
            assert not nothing[1].any()

    # Where each element has its own values, the scalars do nothing.
    @pytest.mark.parametrize(
        ("case", "target"),
        [(case, t) for case in PRESENT if not case.has_own_values for t in ON_PROCESSOR]
        + [(case, OPENCL_DOUBLE) for case in FIRST[:2]],
        ids=str,
    )
    def test_are_updated_in_a_context(self, case: Case, target: Target):
        m = membrane(case.place("octahedron"))
        scalars = {n: v for n, v in case.arguments(m).items() if np.ndim(v) == 0}
        force = case.make(m)
        system = system_of([force], m.num_particles)
        context = target.context(system)
        context.setPositions(m.positions)
        # The System owns a copy of nothing: it is this object that the Context reads.
        before = measure(context)
        for name, value in scalars.items():
            getattr(force, f"set{name[0].upper()}{name[1:]}")(1.05 * value)
        assert_same_bits(measure(context), before)
        force.updateParametersInContext(context)
        changed = {name: 1.05 * value for name, value in scalars.items()}
        fresh = measure(context_of([case.make(m, **changed)], m, REFERENCE))
        assert abs(fresh[0] - before[0]) > 1e-3 * abs(before[0])
        assert_close(measure(context), fresh, target.tolerance)

    def test_update_needs_a_context_with_the_force(self):
        m = membrane("octahedron")
        context = context_of([helfrich.BendingForce(m.triangles, rigidity=50)], m)
        stranger = helfrich.BendingForce(m.triangles, rigidity=50)
        with pytest.raises(mm.OpenMMException):
            stranger.updateParametersInContext(context)


def plain_number(value):
    return plain(value) if unit.is_quantity(value) else value


# --- groups, names, classes ----------------------------------------------------------------------


class TestGroups:
    @everywhere
    def test_energies_and_forces_by_group(self, target: Target):
        m = membrane("jittered")
        alone = [measure(context_of([case.make(m)], m)) for case in CLOSED]
        forces = [case.make(m) for case in CLOSED]
        # All of them different, and in no order.
        groups = [(3 + 29 * k) % 32 for k in range(len(forces))]
        for group, force in zip(groups, forces, strict=True):
            force.setForceGroup(group)
            assert force.getForceGroup() == group
        context = context_of(forces, m, target)
        groups = [force.getForceGroup() for force in forces]
        # All but a few, or a few.
        for size in (1, 2, 3, len(groups) - 1, len(groups)):
            for chosen in itertools.combinations(range(len(groups)), size):
                expected = (
                    sum(alone[i][0] for i in chosen),
                    sum(alone[i][1] for i in chosen),
                )
                measured = measure(context, {groups[i] for i in chosen})
                assert_close(measured, expected, target.tolerance)
        energy, nothing = measure(context, {next(g for g in range(32) if g not in groups)})
        assert energy == 0
        assert not nothing.any()

    def test_a_mask_leaves_the_bits_of_the_others(self):
        """With the area left out of the mask, the rest is what it is without an area force."""
        m = membrane("concave")
        rest = [case for case in FIRST if case.force != "SurfaceAreaForce"]
        area = next(case for case in FIRST if case.force == "SurfaceAreaForce")
        for order in (lambda forces: forces, lambda forces: forces[::-1]):
            without = context_of(order([case.make(m) for case in rest]), m)
            forces = [case.make(m) for case in (area, *rest)]
            forces[0].setForceGroup(1)
            among = context_of(order(forces), m)
            assert_same_bits(measure(among, {0}), measure(without))
            # Nor does an evaluation of everything leave traces.
            measure(among)
            assert_same_bits(measure(among, {0}), measure(without))

    def test_energy_alone_and_forces_alone(self):
        m = membrane("jittered")
        context = context_of([case.make(m) for case in FIRST], m)
        energy, forces = measure(context)
        state = context.getState(getEnergy=True)
        assert plain(state.getPotentialEnergy()) == energy
        np.testing.assert_array_equal(
            plain(context.getState(getForces=True).getForces(asNumpy=True)), forces
        )

    @pytest.mark.parametrize("target", [REFERENCE, CPU, OPENCL_SINGLE], ids=str)
    def test_in_an_integrator(self, target: Target):
        """An integrator that asks for the groups one by one, as multiple time steps do."""
        m = membrane("jittered")
        integrator = mm.CustomIntegrator(0.001)
        for group in range(len(FIRST)):
            integrator.addPerDofVariable(f"f_{group}", 0)
            integrator.addGlobalVariable(f"e_{group}", 0)
            integrator.addComputePerDof(f"f_{group}", f"f{group}")
            integrator.addComputeGlobal(f"e_{group}", f"energy{group}")
        forces = [case.make(m) for case in FIRST]
        for group, force in enumerate(forces):
            force.setForceGroup(group)
        context = target.context(system_of(forces, m.num_particles), integrator)
        context.setPositions(m.positions)
        integrator.step(1)
        for group, case in enumerate(FIRST):
            measured = (
                integrator.getGlobalVariableByName(f"e_{group}"),
                np.array(integrator.getPerDofVariableByName(f"f_{group}")),
            )
            assert_close(measured, measure(context_of([case.make(m)], m)), target.tolerance)


class TestNamesAndClasses:
    @every_class
    def test_name(self, case: Case):
        force = case.make(membrane("octahedron"))
        assert force.getName() == case.force
        force.setName("the inner leaflet")
        assert force.getName() == "the inner leaflet"

    @every_class
    def test_cast_and_isinstance(self, case: Case):
        m = membrane("octahedron")
        system = system_of([case.make(m), mm.HarmonicBondForce()], m.num_particles)
        cls = getattr(helfrich, case.force)
        others = [getattr(helfrich, other.force) for other in FIRST if other.force != case.force]
        stored, bond = system.getForces()
        assert cls.isinstance(stored)
        assert not any(other.isinstance(stored) for other in others)
        assert not cls.isinstance(bond)
        found = cls.cast(stored)
        assert type(found) is cls
        assert found.getNumTriangles() == len(m.triangles)
        for wrong in (bond, *(other.make(m) for other in FIRST if other.force != case.force)):
            with pytest.raises((TypeError, mm.OpenMMException), match=f"^{case.force}: "):
                cls.cast(wrong)

    @every_class
    def test_a_cast_force_is_the_one_in_the_system(self, case: Case):
        m = membrane("octahedron")
        system = system_of([case.make(m)], m.num_particles)
        cls = getattr(helfrich, case.force)
        cls.cast(system.getForce(0)).setForceGroup(9)
        assert system.getForce(0).getForceGroup() == 9

    @every_class
    def test_not_periodic_unless_told(self, case: Case):
        force = case.make(membrane("octahedron"))
        assert force.usesPeriodicBoundaryConditions() is False
        force.setUsesPeriodicBoundaryConditions(True)
        assert force.usesPeriodicBoundaryConditions() is True


# --- copies --------------------------------------------------------------------------------------

COPIES = {
    "XML": lambda force: mm.XmlSerializer.deserialize(mm.XmlSerializer.serialize(force)),
    "clone": mm.XmlSerializer.clone,
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda force: pickle.loads(pickle.dumps(force)),
}


class TestCopies:
    @every_case
    @pytest.mark.parametrize("how", COPIES)
    def test_of_a_force(self, case: Case, how: str):
        m = membrane("jittered")
        force = case.make(m)
        force.setForceGroup(11)
        force.setName("outer")
        # Of another one, because a System takes a force with it when it goes.
        expected = measure(context_of([case.make(m)], m))
        twin = COPIES[how](force)
        cls = getattr(helfrich, case.force)
        assert cls.isinstance(twin)
        assert twin.getForceGroup() == 11
        assert twin.getName() == "outer"
        assert twin.this != force.this
        # The methods of the class must work on the copy, too, and leave the original alone.
        twin = own = twin if how in ("copy", "deepcopy", "pickle") else cls.cast(twin)
        scalars = {n: v for n, v in case.arguments(m).items() if np.ndim(v) == 0}
        for name, value in scalars.items():
            getter, setter = (word + name[0].upper() + name[1:] for word in ("get", "set"))
            assert getattr(own, getter)() == value
            getattr(own, setter)(1.5 * value)
            assert getattr(own, getter)() == 1.5 * value
            assert getattr(force, getter)() == value
        # Scalars have taken the place of values of elements by now.
        assert_same_bits(measure(context_of([COPIES[how](force)], m)), expected)

    @pytest.mark.parametrize("how", COPIES)
    def test_of_a_system(self, how: str):
        m = membrane("two parts")
        system = system_of([case.make(m) for case in PRESENT], m.num_particles)
        first, second = REFERENCE.context(system), REFERENCE.context(COPIES[how](system))
        for context in (first, second):
            context.setPositions(m.positions)
        assert_same_bits(measure(first), measure(second))

    @every_case
    def test_xml_is_stable(self, case: Case):
        text = mm.XmlSerializer.serialize(case.make(membrane("octahedron")))
        again = mm.XmlSerializer.serialize(mm.XmlSerializer.deserialize(text))
        assert text == again

    @every_class
    @pytest.mark.parametrize(
        ("pattern", "replacement", "fragment"),
        [
            (r'version="\d+"', 'version="99"', "99"),
            (r'p2="\d+"', "", "p2"),
            (r"<Triangles>", '<Triangles><Square p1="1" p2="2" p3="3" p4="4"/>', "Square"),
            (r"Triangles>", "Rhombi>", "Rhombi|Triangles"),
        ],
        ids=["version", "attribute", "child", "element"],
    )
    def test_broken_xml(self, case: Case, pattern: str, replacement: str, fragment: str):
        text = mm.XmlSerializer.serialize(case.make(membrane("octahedron")))
        broken, count = re.subn(pattern, replacement, text)
        assert count
        with pytest.raises(mm.OpenMMException, match=rf"^{case.force}: .*({fragment})"):
            mm.XmlSerializer.deserialize(broken)

    @every_class
    def test_xml_with_a_bad_scalar(self, case: Case):
        text = mm.XmlSerializer.serialize(case.make(membrane("octahedron")))
        name = next(iter(case.arguments(membrane("octahedron"))))
        broken, count = re.subn(rf'(name="{name}" value=")[^"]*"', r'\1nan"', text)
        assert count == 1
        with pytest.raises(mm.OpenMMException, match=rf"^{case.force}: .*{name}.*NaN"):
            mm.XmlSerializer.deserialize(broken)


# --- company -------------------------------------------------------------------------------------


class TestCompany:
    @everywhere
    def test_several_membranes_in_one_system(self, target: Target):
        """Each class twice, on two membranes that do not know of each other."""
        one, two = membrane("jittered"), membrane("octahedron")
        shift = one.num_particles
        there = Membrane("there", two.positions, two.triangles + shift)
        forces = []
        for case in FIRST:
            forces.append(case.make(one))
            forces.append(case.make_on(there.triangles, two, shift=shift))
        both = Membrane("both", np.concatenate([one.positions, two.positions]), one.triangles)
        energy, total = measure(context_of(forces, both, target))
        first = measure(context_of([case.make(one) for case in FIRST], one))
        second = measure(context_of([case.make(two) for case in FIRST], two))
        expected = first[0] + second[0], np.concatenate([first[1], second[1]])
        assert_close((energy, total), expected, target.tolerance)

    @everywhere
    def test_the_same_membrane_twice(self, target: Target):
        m = membrane("jittered")
        energy, forces = measure(context_of([case.make(m) for case in FIRST], m))
        twice = context_of([case.make(m) for case in [*FIRST, *FIRST]], m, target)
        assert_close(measure(twice), (2 * energy, 2 * forces), target.tolerance)

    @everywhere
    def test_two_membranes_that_share_particles(self, target: Target):
        """The same surface by triangles in another order: OpenMM would not know that it is one."""
        m = membrane("jittered")
        energy, forces = measure(context_of([case.make(m) for case in FIRST], m))
        other = m.triangles[::-1].copy()
        both = [case.make(m) for case in FIRST] + [case.make_on(other, m) for case in FIRST]
        assert_close(
            measure(context_of(both, m, target)), (2 * energy, 2 * forces), target.tolerance
        )

    @everywhere
    def test_with_forces_of_openmm(self, target: Target):
        """The threads of the CPU platform's own forces do not get in the way."""
        m = membrane("concave")

        def others() -> list[mm.Force]:
            nonbonded = mm.NonbondedForce()
            nonbonded.setNonbondedMethod(mm.NonbondedForce.CutoffNonPeriodic)
            nonbonded.setCutoffDistance(30.0)
            bonds = mm.HarmonicBondForce()
            for _ in range(m.num_particles):
                nonbonded.addParticle(0.3, 5.0, 2.0)
            for a, b, _ in m.triangles.tolist():
                bonds.addBond(a, b, 20.0, 0.1)
            return [nonbonded, bonds]

        ours = measure(context_of([case.make(m) for case in FIRST], m))
        theirs = measure(context_of(others(), m, target))
        mixed = [case.make(m) for case in FIRST]
        for position, force in zip((0, 3), others(), strict=True):
            mixed.insert(position, force)
        expected = ours[0] + theirs[0], ours[1] + theirs[1]
        assert_close(measure(context_of(mixed, m, target)), expected, 1e-7)

    @everywhere
    def test_several_contexts_at_once(self, target: Target):
        """Of one System, with other positions each, and while some of them come and go."""
        m = membrane("jittered")
        system = system_of([case.make(m) for case in FIRST], m.num_particles)
        scales = [1.0, 1.07, 0.94]
        contexts = [target.context(system) for _ in scales]
        expected = []
        for scale in scales:
            single = context_of([case.make(m) for case in FIRST], m)
            single.setPositions(scale * m.positions)
            expected.append(measure(single))
        for context, scale in zip(contexts, scales, strict=True):
            context.setPositions(scale * m.positions)
        for _ in range(2):
            for context, right in zip(contexts, expected, strict=True):
                assert_close(measure(context), right, target.tolerance)
        del context, contexts[1]
        assert_close(measure(contexts[1]), expected[2], target.tolerance)
        contexts[0].reinitialize(preserveState=True)
        assert_close(measure(contexts[0]), expected[0], target.tolerance)

    def test_contexts_in_threads(self):
        """OpenMM releases Python's lock while it integrates, so Contexts really run at once."""
        m = membrane("concave")

        def run(seed: int) -> np.ndarray:
            integrator = mm.VerletIntegrator(0.05)
            system = system_of([case.make(m) for case in FIRST], m.num_particles)
            context = REFERENCE.context(system, integrator)
            context.setPositions(m.positions)
            context.setVelocities(np.random.default_rng(seed).normal(size=m.positions.shape))
            integrator.step(300)
            return plain(context.getState(getPositions=True).getPositions(asNumpy=True))

        seeds = [1, 2, 3, 4]
        alone = [run(seed) for seed in seeds]
        with ThreadPoolExecutor(len(seeds)) as pool:
            for one, other in zip(alone, pool.map(run, seeds), strict=True):
                np.testing.assert_array_equal(one, other)

    @pytest.mark.parametrize("target", [REFERENCE, CPU, OPENCL_SINGLE], ids=str)
    def test_inside_a_custom_cv_force(self, target: Target):
        m = membrane("jittered")
        alone = {case.force: measure(context_of([case.make(m)], m)) for case in FIRST}
        cv = mm.CustomCVForce("0.001*bend^2+bend*area/1000")
        cases = {case.force: case for case in FIRST}
        cv.addCollectiveVariable("bend", cases["BendingForce"].make(m))
        cv.addCollectiveVariable("area", cases["SurfaceAreaForce"].make(m))
        context = context_of([cv], m, target)
        (bend, by_bend), (area, by_area) = alone["BendingForce"], alone["SurfaceAreaForce"]
        values = cv.getCollectiveVariableValues(context)
        np.testing.assert_allclose(values, [bend, area], rtol=target.tolerance)
        forces = (0.002 * bend + area / 1000) * by_bend + bend / 1000 * by_area
        expected = 0.001 * bend**2 + bend * area / 1000, forces
        assert_close(measure(context), expected, 10 * target.tolerance)

    @pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
    def test_minimizer(self, target: Target):
        """Not on OpenCL, where PoCL and the minimizer crash without any plugin."""
        m = membrane("jittered")
        context = context_of([case.make(m) for case in FIRST], m, target)
        energy, forces = measure(context)
        mm.LocalEnergyMinimizer.minimize(context, 1e-3, 3000)
        relaxed, residue = measure(context)
        assert relaxed < 0.9 * energy
        assert np.abs(residue).max() < 1e-2 * np.abs(forces).max()


# --- accidents during a run ----------------------------------------------------------------------


# On OpenCL an exception crosses from a worker thread, which is the same for all classes.
ACCIDENTS = [(case, target) for case in FIRST for target in ON_PROCESSOR]
ACCIDENTS.append((FIRST[0], OPENCL_DOUBLE))
accident = pytest.mark.parametrize(("case", "target"), ACCIDENTS, ids=str)


class TestAccidents:
    # Contacts need no normals; `test_contact.py` has what they do.
    @pytest.mark.parametrize(
        ("case", "target"),
        [(case, target) for case, target in ACCIDENTS if not case.is_contact],
        ids=str,
    )
    def test_a_degenerate_triangle(self, case: Case, target: Target):
        """An exception that names the triangle; afterwards the Context goes on as before."""
        m = membrane("jittered")
        context = context_of([case.make(m)], m, target)
        before = measure(context)
        a, b, _ = m.triangles[17].tolist()
        collapsed = m.positions.copy()
        collapsed[a] = collapsed[b]
        with_both = {i for i, row in enumerate(m.triangles.tolist()) if {a, b} <= set(row)}
        assert len(with_both) == 2
        context.setPositions(collapsed)
        for _ in range(2):
            with pytest.raises(mm.OpenMMException, match=f"^{case.force}: ") as error:
                measure(context)
            named = re.search(r"triangle (\d+) \((\d+), (\d+), (\d+)\)", str(error.value))
            assert int(named[1]) in with_both
            assert [int(x) for x in named.groups()[1:]] == m.triangles[int(named[1])].tolist()
        context.setPositions(m.positions)
        assert_same_bits(measure(context), before)

    @pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
    def test_a_degenerate_triangle_while_integrating(self, target: Target):
        m = membrane("jittered")
        context = context_of([case.make(m) for case in FIRST], m, target)
        context.getIntegrator().step(3)
        a, b, _ = m.triangles[17].tolist()
        collapsed = m.positions.copy()
        collapsed[a] = collapsed[b]
        context.setPositions(collapsed)
        with pytest.raises(mm.OpenMMException, match=r"Force: .*triangle \d+"):
            context.getIntegrator().step(1)
        context.setPositions(m.positions)
        context.getIntegrator().step(3)
        energy, forces = measure(context)
        assert np.isfinite(energy)
        assert np.isfinite(forces).all()

    @accident
    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf], ids=str)
    def test_a_position_that_is_not_finite(self, case: Case, target: Target, bad: float):
        m = membrane("jittered")
        context = context_of([case.make(m)], m, target)
        before = measure(context)
        lost = m.positions.copy()
        lost[m.members[5], 1] = bad
        context.setPositions(lost)
        culprit = rf"{case.force}: particle {m.members[5]}\b"
        if target is CPU and np.isnan(bad):
            # This platform looks for NaN itself, before any force.
            culprit = "Particle coordinate is NaN"
        with pytest.raises(mm.OpenMMException, match=f"^{culprit}"):
            measure(context)
        context.setPositions(m.positions)
        assert_same_bits(measure(context), before)

    @every_class
    def test_a_particle_of_no_membrane_may_be_anywhere(self, case: Case):
        m = membrane("jittered")
        context = context_of([case.make(m)], m)
        before = measure(context)
        lost = m.positions.copy()
        lost[case.strangers(m)] = np.nan
        context.setPositions(lost)
        assert_same_bits(measure(context), before)

    @every_case
    def test_an_almost_degenerate_triangle_is_no_accident(self, case: Case):
        """Close to the singularity the formulas still hold: finite, or a clear refusal."""
        m = membrane("jittered")
        context = context_of([case.make(m)], m)
        a, b, _ = m.triangles[17].tolist()
        for gap in (1e-3, 1e-6, 1e-9):
            close = m.positions.copy()
            close[a] = close[b] + gap * (close[a] - close[b])
            context.setPositions(close)
            energy, forces = measure(context)
            assert np.isfinite(energy)
            assert np.isfinite(forces).all()


# --- threads -------------------------------------------------------------------------------------

THREADS = """
    import os, sys
    import numpy as np, openmm as mm
    import openmmhelfrich as helfrich

    data = np.load(sys.argv[1])
    positions, triangles = data["positions"], data["triangles"]
    system = mm.System()
    for _ in positions:
        system.addParticle(50.0)
    for group, force in enumerate([
        helfrich.SurfaceAreaForce(triangles, modulus=1.3, target=1.2e5),
        helfrich.EnclosedVolumeForce(triangles, modulus=0.04, target=3.9e6),
        helfrich.BendingForce(triangles, rigidity=50.0, spontaneousCurvature=0.01),
        helfrich.TriangleHeightForce(triangles, minHeight=1.4, epsilon=10.0),
    ]):
        force.setForceGroup(group)
        system.addForce(force)
    platform = mm.Platform.getPlatformByName("Reference")
    context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
    context.setPositions(positions)
    before = len(os.listdir("/proc/self/task"))
    results = {}
    for name, groups in [("all", -1), *((str(g), {g}) for g in range(4))]:
        state = context.getState(getEnergy=True, getForces=True, groups=groups)
        results["energy " + name] = state.getPotentialEnergy()._value
        results["forces " + name] = state.getForces(asNumpy=True)._value
    results["threads"] = len(os.listdir("/proc/self/task")) - before
    np.savez(sys.argv[2], **results)
"""


def test_any_number_of_threads_gives_the_same_bits(tmp_path: Path):
    """Large enough a mesh for threads to be used; the threads are counted to be sure of it."""
    vertices, triangles = rough(icosphere(64), np.random.default_rng(3), 0.1)
    assert len(vertices) == 40962
    np.savez(tmp_path / "mesh.npz", positions=100 * vertices, triangles=triangles)
    results = {}
    for threads in (1, 2, 3, 8):
        out = tmp_path / f"{threads}.npz"
        subprocess.run(
            [sys.executable, "-c", textwrap.dedent(THREADS), tmp_path / "mesh.npz", out],
            # A mesh of this size would be tried on a GPU, whose driver has threads of its own.
            env={**os.environ, "OPENMM_CPU_THREADS": str(threads), "HELFRICH_BACKEND": "cpu"},
            check=True,
            timeout=300,
        )
        with np.load(out) as data:
            results[threads] = dict(data)
    for threads, result in results.items():
        if sys.platform == "linux":
            assert result.pop("threads") == threads - 1
        for name, value in result.items():
            assert np.abs(value).max() > 0, name
            np.testing.assert_array_equal(value, results[1][name], err_msg=f"{threads}: {name}")


class TestOwnership:
    """Casting hands over what no System owns, so that nothing dangles."""

    def test_a_cast_force_outlives_what_was_read(self):
        m = membrane("octahedron")
        xml = mm.XmlSerializer.serialize(helfrich.BendingForce(m.triangles, 3))
        read = [helfrich.BendingForce.cast(mm.XmlSerializer.deserialize(xml)) for _ in range(50)]
        gc.collect()
        others = [helfrich.SurfaceAreaForce(m.triangles, 1, 1) for _ in range(100)]
        assert {force.getRigidity() for force in read} == {3}
        assert len(others) == 100
        system = mm.System()
        system.addForce(read[0])
        assert helfrich.BendingForce.cast(system.getForce(0)).getRigidity() == 3

    def test_what_a_system_owns_stays_its_own(self):
        m = membrane("octahedron")
        system = mm.System()
        system.addForce(helfrich.BendingForce(m.triangles, 3))
        assert not helfrich.BendingForce.cast(system.getForce(0)).thisown


@pytest.mark.parametrize(
    ("old", "new", "fragment"),
    [
        ('p1="', 'p1="x', "<Triangle> has p1="),
        ('p1="', 'p1="1.', "<Triangle> has p1="),
        ('value="3"', 'value="3x"', "<Parameter> has value="),
        ('value="3"', 'value=""', "<Parameter> has value="),
        ('value="3"', 'value="-3"', "in element <Parameter>"),
        ("<Triangles>", "<Triangles/><Triangles>", "has the child <Triangles> twice"),
        ('Curvature="0"', 'Curvature="x"', "unsignedSpontaneousCurvature="),
        ('forceGroup="0"', 'forceGroup="x"', "<Force> has forceGroup="),
        ('scheme="Julicher"', 'scheme="Nobody"', 'scheme="Nobody"'),
    ],
)
def test_xml_values_are_read_to_the_last_character(old: str, new: str, fragment: str):
    m = membrane("octahedron")
    xml = mm.XmlSerializer.serialize(helfrich.BendingForce(m.triangles, 3))
    assert old in xml
    with pytest.raises(mm.OpenMMException, match=re.escape(fragment)):
        mm.XmlSerializer.deserialize(xml.replace(old, new, 1))


def test_a_bad_context_parameter_is_blamed_on_its_force():
    m = membrane("octahedron")
    area = helfrich.SurfaceAreaForce(m.triangles, 1, 1000)
    bending = helfrich.BendingForce(m.triangles, 3)
    bending.setContextParameter("rigidity", "k")
    context = context_of([area, bending], m)
    context.setParameter("k", -1)
    with pytest.raises(mm.OpenMMException, match=r"^BendingForce: rigidity"):
        context.getState(getEnergy=True)


def test_derivatives_are_asked_for_once_and_follow_their_parameter():
    m = membrane("octahedron")
    force = helfrich.BendingForce(m.triangles, 3)
    force.setContextParameter("rigidity", "k")
    force.addEnergyParameterDerivative("k")
    force.addEnergyParameterDerivative("k")
    assert force.getNumEnergyParameterDerivatives() == 1
    force.setContextParameter("rigidity", "q")
    assert force.getNumEnergyParameterDerivatives() == 0
    assert copy.deepcopy(force).getContextParameter("rigidity") == "q"


def test_changed_triangles_are_refused_and_schemes_updated_in_a_context():
    m = membrane("jittered")
    force = helfrich.BendingForce(m.triangles, 3)
    context = context_of([force], m)
    before = context.getState(getEnergy=True).getPotentialEnergy()
    force.setScheme("GompperKroll")
    force.updateParametersInContext(context)
    assert context.getState(getEnergy=True).getPotentialEnergy() != before
    force.addTriangle(0, 1, 2)
    with pytest.raises(mm.OpenMMException, match="triangles have changed"):
        force.updateParametersInContext(context)


@pytest.mark.parametrize(
    ("arguments", "error", "fragment"),
    [
        ({"triangles": np.array([[2**64 - 1, 0, 1]], dtype=np.uint64)}, ValueError, "triangle 0"),
        ({"offset": 2**63}, ValueError, "triangle"),
        ({"rigidity": [True] * 6}, TypeError, "rigidity"),
        ({"rigidity": np.True_}, TypeError, "rigidity"),
        ({"scheme": "Nobody"}, ValueError, "known are: Julicher"),
        ({"scheme": True}, TypeError, "scheme"),
        ({"scheme": 1.0}, TypeError, "scheme"),
    ],
)
def test_arguments_that_look_like_others(arguments: dict, error, fragment: str):
    given = {"triangles": membrane("octahedron").triangles, "rigidity": 1, **arguments}
    with pytest.raises(error, match=f"^BendingForce: .*{fragment}"):
        helfrich.BendingForce(**given)
