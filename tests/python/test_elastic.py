"""Forces against a reference and between domains: moduli, lengths, arguments, what may change."""

from __future__ import annotations

import copy
import ctypes

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich import _core
from platforms import NATIVE, ON_DEVICE, ON_PROCESSOR, REFERENCE, Target, sparing
from running import Running

STRAINS = ("SkalakForce", "NeoHookeanForce", "LinearElasticForce")
FORMS = ("Harmonic", "WLCPower")
with_reference = pytest.mark.parametrize("name", [*STRAINS, "SpringForce"])


def make(name: str, mesh, reference, **more) -> mm.Force:
    moduli = {"shearModulus": 2.0, "areaModulus": 3.0}
    if name == "SpringForce":
        moduli = {"stiffness": 2.0}
    return getattr(helfrich, name)(mesh, **moduli, reference=reference, **more)


def stretched(mesh, map_: np.ndarray) -> helfrich.Mesh:
    """Mapped linearly, with its box; turned so that a box keeps OpenMM's form."""
    turned = np.linalg.qr(map_)[1]
    turned *= np.sign(np.diag(turned))[:, None]
    box = None if mesh.box is None else mesh.box @ turned.T
    return helfrich.Mesh(mesh.vertices @ turned.T, mesh.triangles, box)


def uneven_sheet() -> helfrich.Mesh:
    """Flat, with triangles of many shapes and a border."""
    mesh = helfrich.Mesh.sheet(8, 9, 10.0, periodic=False)
    moves = np.random.default_rng(2).uniform(-2, 2, mesh.vertices.shape) * [1, 1, 0]
    return helfrich.Mesh(mesh.vertices + moves, mesh.triangles)


# --- physics -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", STRAINS)
@pytest.mark.parametrize(("long", "wide"), [(1.3, 0.8), (0.9, 0.9), (1.2, 1.2), (1.0, 1.4)])
def test_uniform_strains_have_the_energy_of_the_law(name: str, long: float, wide: float):
    """On any triangulation, since every triangle is strained alike."""
    mesh = uneven_sheet()
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    now = stretched(mesh, turn.T @ np.diag([long, wide, 1]) @ turn)
    mu, k = 2.0, 3.0
    first, second = long**2 + wide**2 - 2, (long * wide) ** 2 - 1
    one, other = (long**2 - 1) / 2, (wide**2 - 1) / 2
    expected = {
        "SkalakForce": mu / 4 * (first**2 / 2 + first - second) + k / 8 * second**2,
        "NeoHookeanForce": mu / 2 * (long / wide + wide / long - 2)
        + k / 2 * (long * wide - 1) ** 2,
        "LinearElasticForce": k / 2 * (one + other) ** 2 + mu / 2 * (one - other) ** 2,
    }[name]
    found = now.energy(make(name, mesh, mesh.vertices))
    assert found == pytest.approx(mesh.area * expected, rel=1e-12)


def assert_moduli(mesh, force, shear: float, area: float) -> None:
    """By area, strains of e and −e cost 2 μ e², of e and e 2 K e²; odd orders cancel."""
    e = 1e-4
    for strains, modulus in (((1, -1), shear), ((1, 1), area)):
        for angle in (0.0, 0.3):
            cos, sin = np.cos(angle), np.sin(angle)
            turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
            strain = turn.T @ np.diag([*strains, 0]) @ turn
            energies = [
                stretched(mesh, np.eye(3) + sign * e * strain).energy(force) for sign in (1, -1)
            ]
            assert np.mean(energies) / mesh.area == pytest.approx(2 * modulus * e**2, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "shear", "area"),
    [
        # As Skalak's constants are defined.
        ("SkalakForce", 2.0 / 2, 3.0 + 2.0 / 2),
        ("NeoHookeanForce", 2.0, 3.0),
        ("LinearElasticForce", 2.0, 3.0),
    ],
)
def test_moduli_at_small_strains(name: str, shear: float, area: float):
    mesh = uneven_sheet()
    assert_moduli(mesh, make(name, mesh, mesh.vertices), shear, area)


@pytest.mark.parametrize("form", FORMS)
def test_moduli_of_a_hexagonal_net(form: str):
    """√3/4 k and √3/2 k, in a periodic box so that there is no border."""
    mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
    force = helfrich.SpringForce(mesh, 2.0, mesh, ratio=0.4, form=form)
    assert_moduli(mesh, force, 3**0.5 / 4 * 2.0, 3**0.5 / 2 * 2.0)


def test_each_spring_counts_once():
    """Half in either triangle, and whole at a border."""
    mesh = uneven_sheet()
    force = helfrich.SpringForce(mesh, 2.0, 0.5 * mesh.vertices)
    start, end = mesh.vertices[mesh.edges].transpose(1, 0, 2)
    lengths = np.linalg.norm(end - start, axis=1)
    assert mesh.energy(force) == pytest.approx(np.sum(lengths**2) / 4, rel=1e-13)


def line_on_a_sphere(mesh, axis: np.ndarray, polar: float) -> float:
    """The length of the border of a cap, by that of the circle."""
    radius = np.linalg.norm(mesh.vertices, axis=1).mean()
    domains = (mesh.vertices @ axis > radius * np.cos(polar)).astype(int)
    length = mesh.energy(helfrich.LineTensionForce(mesh, 1.0, domains))
    return length / (2 * np.pi * radius * np.sin(polar))


@pytest.mark.parametrize("polar", [30, 60, 90])
def test_the_border_of_a_cap_is_a_circle_in_zigzag(polar: int):
    """2 √3/π times as long where triangles are equilateral, and all directions occur."""
    axes = np.random.default_rng(1).normal(size=(60, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    mesh = helfrich.Mesh.icosphere(24, radius=100.0)
    ratios = [line_on_a_sphere(mesh, axis, np.radians(polar)) for axis in axes]
    assert np.mean(ratios) == pytest.approx(2 * 3**0.5 / np.pi, abs=4 * np.std(ratios) / 60**0.5)
    assert np.std(ratios) < 0.04
    assert min(ratios) > 1 and max(ratios) < 2 / 3**0.5 + 0.01


def test_lines_through_a_lattice():
    """Straight along the edges of equilateral triangles, 2/√3 times as long at 30° to them."""
    mesh = helfrich.Mesh.sheet(12, 12, 10.0, periodic=True)
    x, y, _ = mesh.vertices.T
    width, height = mesh.box[0, 0], mesh.box[1, 1]
    for domains, expected in (
        (y < height / 2 - 1, width),
        (x < width / 2 - 1, height * 2 / 3**0.5),
    ):
        energy = mesh.energy(helfrich.LineTensionForce(mesh, 1.5, domains.astype(int)))
        assert energy == pytest.approx(2 * 1.5 * expected, rel=1e-12)


def test_where_three_domains_meet():
    """A third of each median of the one triangle that has all of them."""
    corners = [[0, 0, 0], [10, 0, 0], [5, 10 * 0.75**0.5, 0]]
    mesh = helfrich.Mesh(corners, [[0, 1, 2]])
    energy = mesh.energy(helfrich.LineTensionForce(mesh, 1.0, [5, -2, 8]))
    assert energy == pytest.approx(10.0 * 0.75**0.5, rel=1e-13)


# --- digits --------------------------------------------------------------------------------------


@with_reference
@pytest.mark.parametrize("target", sparing([*ON_PROCESSOR, *ON_DEVICE], "single"))
def test_small_strains_keep_their_digits(name: str, target: Target):
    """Positions are on every device's lattice, so that nothing but the strain itself is small."""
    sphere = helfrich.Mesh.random_sphere(252, radius=60.0, seed=1)
    points = np.round(sphere.vertices * 2**10) / 2**10
    # The first vertex and the middle of the box are whole numbers, to which positions are relative.
    points[0] = np.round(points[0])
    extremes = np.array(
        [[-64.0, 0, 0], [64, 0, 0], [0, -64, 0], [0, 64, 0], [0, 0, -64], [0, 0, 64]]
    )
    for extreme in extremes:
        points[np.argmax(points @ extreme)] = extreme
    mesh = helfrich.Mesh(points, sphere.triangles)
    strain = 2.0**-13
    results = []
    for where in (target, REFERENCE):
        force = make(name, mesh, mesh.vertices * (1 + strain))
        results.append(Running([force], mesh.num_vertices, where).evaluate(points))
    (energy, forces), (expected, pushes) = results
    tolerance = 1e-5 if target in ON_DEVICE else 1e-11
    assert energy == pytest.approx(expected, rel=tolerance)
    assert np.abs(forces - pushes).max() < tolerance * np.abs(pushes).max()


# --- arguments -----------------------------------------------------------------------------------


@with_reference
def test_a_reference_of_any_kind(name: str):
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    reference = 1.1 * mesh.vertices
    expected = make(name, mesh, reference)
    for given in (
        reference.tolist(),
        np.asfortranarray(reference),
        unit.Quantity(reference / 10, unit.angstrom * 100),
        unit.Quantity(reference.tolist(), unit.nanometer),
        helfrich.Mesh(reference, mesh.triangles),
    ):
        force = make(name, mesh, given)
        np.testing.assert_allclose(force.getReference(), reference, rtol=1e-15)
        assert mesh.energy(force) == pytest.approx(mesh.energy(expected), rel=1e-13)
        assert force.getReferenceBox() is None


@with_reference
@pytest.mark.parametrize(
    ("reference", "error", "fragment"),
    [
        (np.zeros((42, 2)), ValueError, "(42, 2)"),
        (np.zeros(126), ValueError, "(126,)"),
        ([["a", "b", "c"]], ValueError, "numbers"),
        (None, ValueError, "numbers"),
        (unit.Quantity(np.zeros((42, 3)), unit.picosecond), ValueError, "length"),
        (
            np.where(np.arange(126).reshape(42, 3) == 22, np.nan, 1.0),
            mm.OpenMMException,
            "vertex 7",
        ),
    ],
    ids=["two columns", "flat", "text", "nothing", "time", "not finite"],
)
def test_a_reference_that_is_none(name: str, reference, error, fragment: str):
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    with pytest.raises(error) as raised:
        make(name, mesh, reference)
    assert str(raised.value).startswith(f"{name}: ")
    assert fragment in str(raised.value)


@with_reference
def test_a_reference_that_does_not_fit(name: str):
    """Known when a Context is made, since triangles may come later."""
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    few = make(name, mesh, mesh.vertices[:-1])
    with pytest.raises(mm.OpenMMException, match=rf"^{name}: reference is of 41 .* are 42; "):
        Running([few], mesh.num_vertices, REFERENCE)
    flat = mesh.vertices.copy()
    a, b, c = mesh.triangles[5].tolist()
    flat[c] = 2 * flat[b] - flat[a]
    with pytest.raises(mm.OpenMMException) as raised:
        Running([make(name, mesh, flat)], mesh.num_vertices, REFERENCE)
    message = str(raised.value)
    assert message.startswith(f"{name}: triangle 5 ({a}, {b}, {c}) has no area in the reference")


@pytest.mark.parametrize(
    ("domains", "error", "fragment"),
    [
        (np.zeros(42), TypeError, "float64"),
        ([True] * 42, TypeError, "bool"),
        (["inside"] * 42, TypeError, "integers"),
        (np.zeros((42, 1), int), ValueError, "(42, 1)"),
        (unit.Quantity([1] * 42, unit.nanometer), TypeError, "nanometer"),
    ],
    ids=["float", "bool", "text", "column", "length"],
)
def test_domains_that_are_none(domains, error, fragment: str):
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    with pytest.raises(error) as raised:
        helfrich.LineTensionForce(mesh, 1.0, domains)
    assert str(raised.value).startswith("LineTensionForce: ")
    assert fragment in str(raised.value)


def test_domains_that_do_not_fit():
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    few = helfrich.LineTensionForce(mesh, 1.0, [1] * 41)
    with pytest.raises(mm.OpenMMException, match="LineTensionForce: domains is of 41"):
        Running([few], mesh.num_vertices, REFERENCE)


def test_only_these_have_a_reference():
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    for force in (helfrich.BendingForce(mesh, 50), helfrich.LineTensionForce(mesh, 1, [0] * 42)):
        assert not hasattr(force, "setReference")
    xml = mm.XmlSerializer.serialize(make("SkalakForce", mesh, mesh.vertices))
    for wrong, message in (
        (xml.replace("<Reference>", "<Domains>").replace("</Reference>", "</Domains>"), "Domains"),
        (xml.replace(' y="', ' w="', 1), "SkalakForce: element <Vertex>"),
        (xml.replace("<Reference>", '<Reference size="3">'), "size"),
    ):
        assert wrong != xml
        with pytest.raises(mm.OpenMMException, match=message):
            mm.XmlSerializer.deserialize(wrong)


class TestC:
    """The C functions, on forces that Python holds."""

    def test_set_a_reference(self):
        mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
        force = make("SpringForce", mesh, mesh.vertices)
        library, address = _core.library(), ctypes.c_void_p(int(force.this))
        points = np.ascontiguousarray(1.1 * mesh.vertices)
        box = np.ascontiguousarray(1.1 * mesh.box)
        numbers, vectors = (x.ctypes.data_as(ctypes.c_void_p) for x in (points, box))
        set_reference = library.Helfrich_MembraneForce_setReference
        assert set_reference(address, numbers, len(points), vectors) == 0
        np.testing.assert_array_equal(force.getReference(), points)
        np.testing.assert_array_equal(force.getReferenceBox(), box)
        points[3, 1] = np.inf
        assert set_reference(address, numbers, len(points), None) == 1
        assert _core.last_error().startswith("SpringForce: reference has vertex 3 at (")
        bending = helfrich.BendingForce(mesh, 50)
        address = ctypes.c_void_p(int(bending.this))
        assert set_reference(address, numbers, len(points), None) == 1
        assert "BendingForce: has no reference" in _core.last_error()

    def test_set_domains(self):
        mesh = helfrich.Mesh.icosphere(2, radius=10.0)
        force = helfrich.LineTensionForce(mesh, 1.0, [0] * 42)
        library, address = _core.library(), ctypes.c_void_p(int(force.this))
        domains = np.arange(42, dtype=np.intc)
        numbers = domains.ctypes.data_as(ctypes.c_void_p)
        assert library.Helfrich_LineTensionForce_setDomains(address, numbers, 42) == 0
        np.testing.assert_array_equal(force.getDomains(), domains)
        other = make("SkalakForce", mesh, mesh.vertices)
        address = ctypes.c_void_p(int(other.this))
        assert library.Helfrich_LineTensionForce_setDomains(address, numbers, 42) == 1
        assert "is of another class" in _core.last_error()


# --- periodic boxes ------------------------------------------------------------------------------


@with_reference
def test_a_mesh_brings_its_box(name: str):
    mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
    wide = stretched(mesh, np.diag([1.1, 1.2, 1.0]))
    force = make(name, mesh, mesh)
    np.testing.assert_array_equal(force.getReferenceBox(), mesh.box)
    for other in (copy.copy(force), mm.XmlSerializer.clone(force)):
        other = type(force).cast(other)
        np.testing.assert_array_equal(other.getReferenceBox(), mesh.box)
        assert wide.energy(other) == wide.energy(force)
    assert abs(mesh.energy(force)) < 1e-20 * wide.energy(force)
    # Wrapped anywhere.
    shifts = np.random.default_rng(1).integers(-2, 3, (mesh.num_vertices, 3)) @ mesh.box
    elsewhere = make(name, mesh, helfrich.Mesh(mesh.vertices + shifts, mesh.triangles, mesh.box))
    assert wide.energy(elsewhere) == pytest.approx(wide.energy(force), rel=1e-9)
    bare = make(name, mesh, mesh.vertices)
    with pytest.raises(
        mm.OpenMMException, match=f"^{name}: the surface .* the reference .* no box"
    ):
        wide.energy(bare)
    bare.setReferenceBox(unit.Quantity(mesh.box, unit.nanometer))
    assert wide.energy(bare) == wide.energy(force)
    bare.setReference(mesh.vertices)
    np.testing.assert_array_equal(bare.getReferenceBox(), mesh.box)
    bare.setReferenceBox(None)
    assert bare.getReferenceBox() is None
    bare.setReferenceBox(mesh.box / 4)
    with pytest.raises(mm.OpenMMException, match=f"^{name}: particles .* apart in the reference"):
        wide.energy(bare)


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *NATIVE], ids=str)
def test_a_spanning_surface_needs_a_box_of_the_reference(target: Target):
    """When it is first evaluated, and when a Context that knows it is told of another reference."""
    mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
    message = "SkalakForce: the surface .* the reference .* no box"
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    force = make("SkalakForce", mesh, mesh.vertices)
    force.setBackend(target.backend)
    system.addForce(force)
    context = target.context(system)
    context.setPositions(1.001 * mesh.vertices)
    with pytest.raises(mm.OpenMMException, match=message):
        context.getState(getEnergy=True)
    force.setReferenceBox(mesh.box)
    force.updateParametersInContext(context)
    before = context.getState(getEnergy=True).getPotentialEnergy()
    force.setReferenceBox(None)
    with pytest.raises(mm.OpenMMException, match=message):
        force.updateParametersInContext(context)
    assert context.getState(getEnergy=True).getPotentialEnergy() == before


# --- what may change -----------------------------------------------------------------------------


@with_reference
@pytest.mark.parametrize("target", sparing([*ON_PROCESSOR, *ON_DEVICE]))
def test_another_reference_in_a_context(name: str, target: Target):
    mesh = helfrich.Mesh.random_sphere(92, radius=20.0, seed=2)
    force = make(name, mesh, 1.02 * mesh.vertices)
    run = Running([force], mesh.num_vertices, target)
    inside = type(force).cast(run.context.getSystem().getForce(0))
    first = run.evaluate(mesh.vertices)
    for factor in (0.97, 1.02):
        inside.setReference(factor * mesh.vertices)
        inside.updateParametersInContext(run.context)
        energy, forces = run.evaluate(mesh.vertices)
        fresh = Running([make(name, mesh, factor * mesh.vertices)], mesh.num_vertices, target)
        expected, pushes = fresh.evaluate(mesh.vertices)
        assert energy == expected
        np.testing.assert_array_equal(forces, pushes)
    assert energy == first[0]
    # What is refused changes nothing.
    inside.setReference(mesh.vertices[1:])
    with pytest.raises(mm.OpenMMException, match="reference is of 91"):
        inside.updateParametersInContext(run.context)
    inside.setReference(0.0 * mesh.vertices)
    with pytest.raises(mm.OpenMMException, match="no area in the reference"):
        inside.updateParametersInContext(run.context)
    assert run.evaluate(mesh.vertices)[0] == first[0]
    inside.setReference(0.97 * mesh.vertices)
    inside.updateParametersInContext(run.context)
    assert (
        run.evaluate(mesh.vertices)[0]
        == Running([make(name, mesh, 0.97 * mesh.vertices)], mesh.num_vertices, target).evaluate(
            mesh.vertices
        )[0]
    )


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_DEVICE], ids=str)
def test_other_triangles_have_other_constants(target: Target):
    """Those that their corners have: as a force that is made with these triangles."""
    mesh = helfrich.Mesh.random_sphere(92, radius=20.0, seed=2)
    rng = np.random.default_rng(3)
    reference = mesh.vertices + rng.normal(0, 0.3, mesh.vertices.shape)
    domains = rng.integers(3, size=mesh.num_vertices)

    def forces(triangles) -> list[mm.Force]:
        elastic = make("SkalakForce", triangles, reference)
        return [elastic, helfrich.LineTensionForce(triangles, 2.0, domains)]

    flipped = _with_a_flip(mesh.triangles)
    run = Running(forces(mesh.triangles), mesh.num_vertices, target)
    before = run.evaluate(mesh.vertices)
    elastic = helfrich.SkalakForce.cast(run.context.getSystem().getForce(0))
    elastic.setTrianglesInContext(run.context, flipped)
    energy, pushes = run.evaluate(mesh.vertices)
    assert energy != before[0]
    expected, others = Running(forces(flipped), mesh.num_vertices, target).evaluate(mesh.vertices)
    assert energy == pytest.approx(expected, rel=1e-6)
    assert np.abs(pushes - others).max() < 1e-6 * np.abs(others).max()
    elastic.setTrianglesInContext(run.context, mesh.triangles)
    again, same = run.evaluate(mesh.vertices)
    assert again == before[0]
    np.testing.assert_array_equal(same, before[1])


def _with_a_flip(triangles: np.ndarray) -> np.ndarray:
    """The first edge that can flip turned the other way."""
    sides = {}
    for number, (a, b, c) in enumerate(triangles.tolist()):
        for start, end, tip in ((a, b, c), (b, c, a), (c, a, b)):
            sides[start, end] = number, tip
    degrees = np.bincount(triangles.ravel())
    for (i, j), (one, k) in sides.items():
        other, m = sides[j, i]
        if (k, m) not in sides and min(degrees[[i, j]]) > 4:
            flipped = triangles.copy()
            flipped[one], flipped[other] = (i, m, k), (j, k, m)
            return flipped
    raise ValueError("no edge can flip")


@pytest.mark.parametrize("target", ON_PROCESSOR, ids=str)
def test_a_flip_to_a_triangle_flat_at_rest_is_never_made(target: Target):
    """The sheet at rest is a lattice, in which other triangles than these may have no area."""
    mesh = helfrich.Mesh.sheet(6, 6, 10.0, periodic=True)
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50.0)
    system.setDefaultPeriodicBoxVectors(*mesh.box)
    force = make("LinearElasticForce", mesh, mesh)
    # Any flip is welcome but those.
    force.setShearModulus(1e-9)
    force.setAreaModulus(1e-9)
    system.addForce(force)
    mover = helfrich.MonteCarloBondFlip(mesh, 300.0, frequency=1, attemptsPerEdge=5)
    system.addForce(mover)
    context = target.context(system)
    rng = np.random.default_rng(5)
    context.setPositions(mesh.vertices + rng.normal(0, 0.7, mesh.vertices.shape))
    context.getIntegrator().setStepSize(1e-9)
    for _ in range(20):
        context.getIntegrator().step(1)
        context.getState(getEnergy=True)
    statistics = mover.getStatistics(context)
    assert statistics["accepted"] > 100
    corners = helfrich.Mesh(mesh.vertices, force.getTrianglesInContext(context), mesh.box)
    a, b, c = corners.corner_positions.transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1


@pytest.mark.parametrize("target", [*ON_PROCESSOR, *ON_DEVICE], ids=str)
def test_a_spring_beyond_its_longest_is_named(target: Target):
    mesh = helfrich.Mesh.icosphere(2, radius=10.0)
    force = helfrich.SpringForce(mesh, 2.0, mesh, ratio=0.5, form="WLCPower")
    run = Running([force], mesh.num_vertices, target)
    energy, _ = run.evaluate(1.9 * mesh.vertices)
    assert np.isfinite(energy)
    positions = mesh.vertices.copy()
    positions[7] *= 4
    ask = [{"getEnergy": True, "getForces": True}, {"getEnergy": True}]
    # Devices are not asked for more than they have been asked for.
    ask += [{"getForces": True}] if target.backend != "native" else []
    for what in ask:
        run.context.setPositions(positions)
        message = r"^SpringForce: the edge \((7, \d+|\d+, 7)\) of triangle \d+ is .* nm long"
        with pytest.raises(mm.OpenMMException, match=message):
            run.context.getState(**what)
    assert run.evaluate(1.9 * mesh.vertices)[0] == energy
