"""Custom forces replaced by ours: what is found, what is left, and that nothing else changes."""

from __future__ import annotations

from functools import cache
from math import pi

import meshes
import numpy as np
import numpy_energies
import openmm as mm
import openmmhelfrich as helfrich
import pytest
import string_forces
from openmm import unit
from openmmhelfrich.vcm import strings
from openmmhelfrich.vcm.accelerate import accelerate
from openmmhelfrich.vcm.expressions import Expression, ExpressionError

SCHEMES = tuple(string_forces.BENDING_SCHEMES)
KAPPA, C0 = 50.0, 0.013


@cache
def membrane() -> meshes.Membrane:
    """Five to seven neighbours, jittered, among particles that belong to nothing."""
    sphere = helfrich.Mesh.random_sphere(42, 100, seed=2)
    assert set(sphere.degrees) == {5, 6, 7}
    surface = meshes.rough((sphere.vertices, sphere.triangles), np.random.default_rng(1), 0.1)
    return meshes.embedded("random", meshes.moved(surface, shift=(30, -20, 10)), seed=3)


def places() -> list[np.ndarray]:
    """Positions at which Systems are compared: as they are, and rough enough for concave edges."""
    m = membrane()
    rough = np.random.default_rng(2).normal(scale=0.12 * m.mean_edge, size=m.positions.shape)
    return [np.array(m.positions), m.positions + rough]


def system_of(forces, num_particles: int | None = None) -> mm.System:
    system = mm.System()
    for _ in range(num_particles or membrane().num_particles):
        system.addParticle(50.0)
    for force in forces:
        system.addForce(force)
    return system


def context_of(system: mm.System) -> mm.Context:
    platform = mm.Platform.getPlatformByName("Reference")
    return mm.Context(system, mm.VerletIntegrator(0.001), platform)


def state_of(context: mm.Context, positions) -> tuple[float, np.ndarray]:
    context.setPositions(positions)
    state = context.getState(energy=True, forces=True)
    md = unit.md_unit_system
    energy = state.getPotentialEnergy().value_in_unit_system(md)
    return energy, np.array(state.getForces(asNumpy=True).value_in_unit_system(md))


def only(system: mm.System, cls: type):
    """The one force of a System, which must be of this class."""
    (force,) = system.getForces()
    assert cls.isinstance(force)
    return cls.cast(force)


def assert_same(first: mm.System, second: mm.System, parameters=({},), tolerance=1e-9) -> None:
    """Energies and forces of two Systems, by OpenMM, at several places."""
    contexts = context_of(first), context_of(second)
    for positions in places():
        for values in parameters:
            for context in contexts:
                for name, value in values.items():
                    context.setParameter(name, value)
            (energy, forces), (others_energy, others) = (state_of(c, positions) for c in contexts)
            assert others_energy == pytest.approx(energy, rel=tolerance)
            np.testing.assert_allclose(
                others, forces, rtol=0, atol=tolerance * np.abs(forces).max()
            )
            assert np.abs(forces).max() > 0


def assert_replaced(report, *classes: str) -> None:
    assert [r.force_class for r in report.replaced] == list(classes), str(report)
    assert report.left == []


# --- bending -----------------------------------------------------------------------------------

BENDINGS = [
    (scheme, curvature, unsigned)
    for scheme in SCHEMES
    for curvature, unsigned in [(0.0, False), (C0, False), (-C0, False), (C0, True)]
    # VCM has |S|, but no |J|.
    if not (unsigned and scheme.startswith("Julicher"))
]


@pytest.mark.parametrize(("scheme", "curvature", "unsigned"), BENDINGS)
@pytest.mark.parametrize("style", string_forces.STYLES)
def test_bending_of_the_oracle(scheme, style, curvature, unsigned):
    """Some of these come in three parts for each degree; numpy knows their energy."""
    m = membrane()
    forces = string_forces.bending(m.triangles, KAPPA, curvature, scheme, style, unsigned)
    system = system_of(forces)
    # With positions, forces are compared too, by derivatives of the expressions.
    faster, report = accelerate(system, m.positions)
    assert_replaced(report, "BendingForce")
    assert len(report.replaced[0].indices) == len(forces)
    force = only(faster, helfrich.BendingForce)
    assert force.getScheme() == getattr(helfrich.BendingForce, scheme)
    assert force.getRigidity() == pytest.approx(KAPPA, rel=1e-12)
    assert force.getSpontaneousCurvature() == pytest.approx(curvature, rel=1e-12)
    assert force.getUnsignedSpontaneousCurvature() == unsigned
    context = context_of(faster)
    for positions in places():
        expected = numpy_energies.bending(
            positions, m.triangles, KAPPA, curvature, scheme, unsigned
        )
        assert state_of(context, positions)[0] == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("style", string_forces.STYLES)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_three_to_twelve_neighbours(scheme, style):
    m = meshes.membrane("many neighbours")
    forces = string_forces.bending(m.triangles, KAPPA, 0.0, scheme, style)
    assert len(forces) >= 5
    faster, report = accelerate(system_of(forces, m.num_particles), m.positions)
    assert_replaced(report, "BendingForce")
    expected = numpy_energies.bending(m.positions, m.triangles, KAPPA, scheme=scheme)
    energy, _ = state_of(context_of(faster), m.positions)
    assert energy == pytest.approx(expected, rel=1e-11)


def test_domains():
    """Rigidity and curvature of each bond become those of each vertex."""
    m = membrane()
    rng = np.random.default_rng(4)
    kappa, c0 = rng.uniform(20, 80, len(m.members)), rng.uniform(-0.02, 0.02, len(m.members))
    system = system_of(string_forces.bending(m.triangles, kappa, c0, "Julicher", "geometric"))
    faster, report = accelerate(system)
    assert_replaced(report, "BendingForce")
    force = only(faster, helfrich.BendingForce)
    # Exactly, because they are the numbers of the bonds and not fits of them.
    np.testing.assert_array_equal(force.getVertexRigidity(), kappa)
    np.testing.assert_array_equal(np.abs(force.getVertexSpontaneousCurvature()), np.abs(c0))
    assert_same(system, faster)


def test_two_membranes_in_one_force():
    m = meshes.membrane("two parts")
    forces = string_forces.bending(m.triangles, KAPPA, C0, "JulicherVoronoi", "geometric")
    faster, report = accelerate(system_of(forces, m.num_particles), m.positions)
    assert_replaced(report, "BendingForce")
    expected = numpy_energies.bending(m.positions, m.triangles, KAPPA, C0, "JulicherVoronoi")
    energy, _ = state_of(context_of(faster), m.positions)
    assert energy == pytest.approx(expected, rel=1e-11)


# --- our own strings: there and back ------------------------------------------------------------


def _ours() -> dict[str, mm.Force]:
    t = membrane().triangles
    g = numpy_energies.Geometry(membrane().positions, t)
    targets = np.linspace(0.8, 1.1, len(t)) * g.area / len(t)
    made = {
        "area": helfrich.SurfaceAreaForce(t, 1.3, 1.01 * g.area),
        "volume": helfrich.EnclosedVolumeForce(t, 0.04, 0.98 * g.volume),
        "heights": helfrich.TriangleHeightForce(t, float(np.quantile(g.heights, 0.5)), 10),
        "repulsion": helfrich.TriangleAreaRepulsionForce(t, float(np.median(g.areas)), 10),
        "local area": helfrich.TriangleAreaForce(t, 2.5, targets),
    }
    for form in string_forces.DIHEDRAL_FORMS:
        made[form] = helfrich.DihedralForce(t, 40, getattr(helfrich.DihedralForce, form))
    for scheme in SCHEMES:
        number = getattr(helfrich.BendingForce, scheme)
        made[scheme] = helfrich.BendingForce(t, KAPPA, 0, number)
        # Gompper and Kroll's own is as long as its sibling, and takes OpenMM as long.
        if scheme in ("GompperKrollBarycentric", "Espriu"):
            made[scheme + " unsigned"] = helfrich.BendingForce(t, KAPPA, C0, number)
            made[scheme + " unsigned"].setUnsignedSpontaneousCurvature(True)
    made["Julicher curved"] = helfrich.BendingForce(t, KAPPA, -C0)
    return made


OURS = _ours()
STRINGS = [(name, "sums") for name in OURS] + [("area", "pairs"), ("volume", "pairs")]


@pytest.mark.parametrize(("name", "style"), STRINGS)
def test_there_and_back(name, style):
    """A force of ours, written with strings, is found with its parameters, and equals both."""
    ours = OURS[name]
    custom = system_of(strings.custom_forces(ours, style))
    faster, report = accelerate(custom, membrane().positions)
    assert_replaced(report, type(ours).__name__)
    found = only(faster, type(ours))
    for number in range(ours.getNumParameters()):
        key = ours.getParameterName(number)
        value = ours.getParameterValue(key)
        assert found.getParameterValue(key) == pytest.approx(value, rel=1e-12)
        if not ours.getElementValues(key):
            assert not found.getElementValues(key)
    assert found.getForm() == ours.getForm()
    assert_same(custom, faster)
    assert_same(system_of([mm.XmlSerializer.clone(ours)]), faster)


# --- global area and volume ----------------------------------------------------------------------


def _vcm_measures() -> dict[str, tuple[str, str, float]]:
    """As VCM writes them: of particles 1 to 3, of 4 to 6, and their total."""
    g = numpy_energies.Geometry(membrane().positions, membrane().triangles)
    area = "0.5*distance(p{0},p{1})*distance(p{0},p{2})*abs(sin(angle(p{1},p{0},p{2})))"
    # The listing is outward, the product is that of the opposite order.
    volume = (
        "(-(1./6)*(x{0}*(y{2}*z{1}-z{2}*y{1})+x{1}*(y{0}*z{2}-z{0}*y{2})"
        "+x{2}*(y{1}*z{0}-z{1}*y{0})))"
    )
    return {
        "SurfaceAreaForce": (area.format(1, 2, 3), area.format(4, 5, 6), g.area),
        "EnclosedVolumeForce": (volume.format(1, 2, 3), volume.format(4, 5, 6), g.volume),
    }


def _pairs_with_rest(cls: str, rest: float | None = None) -> list[mm.Force]:
    """Single triangles and pairs i < j, with the target as a global parameter."""
    one, two, total = _vcm_measures()[cls]
    triangles = membrane().triangles.tolist()
    n = len(triangles)
    rest = (n - 1) / n if rest is None else rest
    single = mm.CustomCompoundBondForce(3, f"0.5*1.3*(({one}-goal)^2-{rest!r}*goal^2)/goal")
    pairs = mm.CustomCompoundBondForce(6, f"1.3*{one}*{two}/goal")
    for triangle in triangles:
        single.addBond(triangle, [])
    for i, triangle in enumerate(triangles):
        for other in triangles[i + 1 :]:
            pairs.addBond(triangle + other, [])
    for force in (single, pairs):
        force.addGlobalParameter("goal", 1.03 * total)
    return [single, pairs]


def _all_pairs(cls: str) -> list[mm.Force]:
    """One force over all ordered pairs, a triangle with itself included."""
    one, two, total = _vcm_measures()[cls]
    triangles = membrane().triangles.tolist()
    n = len(triangles)
    force = mm.CustomCompoundBondForce(6, f"0.65*({one}-goal/{n})*({two}-goal/{n})/goal")
    force.addGlobalParameter("goal", 1.03 * total)
    for triangle in triangles:
        for other in triangles:
            force.addBond(triangle + other, [])
    return [force]


@pytest.mark.parametrize("make", [_pairs_with_rest, _all_pairs])
@pytest.mark.parametrize("cls", ["SurfaceAreaForce", "EnclosedVolumeForce"])
def test_pairs_with_a_ramp(cls, make):
    """The target stays a parameter of the Context."""
    total = _vcm_measures()[cls][2]
    system = system_of(make(cls))
    faster, report = accelerate(system)
    assert_replaced(report, cls)
    force = only(faster, getattr(helfrich, cls))
    assert force.getContextParameter("target") == "goal"
    assert force.getTarget() == 1.03 * total
    assert force.getModulus() == 1.3
    assert_same(system, faster, [{}, {"goal": 0.9 * total}])


def test_rounded_constant_is_kept():
    """VCM prints (N − 1)/N with six decimals; the energy is off by a multiple of the target."""
    system = system_of(_pairs_with_rest("SurfaceAreaForce", rest=0.987512))
    faster, report = accelerate(system)
    assert_replaced(report, "SurfaceAreaForce")
    assert "constant" in report.replaced[0].description
    assert faster.getNumForces() == 2
    total = _vcm_measures()["SurfaceAreaForce"][2]
    # Without the constant this would be off by 0.8 kJ/mol of 80.
    assert_same(system, faster, [{}, {"goal": 0.9 * total}])


@pytest.mark.parametrize("style", string_forces.STYLES)
@pytest.mark.parametrize("listed", ["outward", "inward"])
def test_area_and_volume_in_one_expression(style, listed):
    m = membrane()
    g = numpy_energies.Geometry(m.positions, m.triangles)
    scalars = {"area_modulus": 1.3, "volume_modulus": 0.04, "rigidity": KAPPA}
    scalars |= {"area_target": 0.97 * g.area, "volume_target": 0.9 * g.volume}
    scalars |= {"min_height": float(np.quantile(g.heights, 0.4)), "epsilon": 10.0}
    forces = string_forces.fastest(m.triangles, style=style, **scalars)
    if listed == "inward":
        # The sum runs over inside-out triangles and has a negative sign in front.
        inner = mm.CustomCompoundBondForce(
            3, "-(x1*(y2*z3-z2*y3)+y1*(z2*x3-x2*z3)+z1*(x2*y3-y2*x3))/6"
        )
        for triangle in m.triangles[:, ::-1].tolist():
            inner.addBond(triangle, [])
        volume = mm.CustomCVForce(f"0.02*(V-{0.9 * g.volume!r})^2/{0.9 * g.volume!r}")
        volume.addCollectiveVariable("V", inner)
        forces = [volume]
    system = system_of(forces)
    faster, report = accelerate(system)
    assert report.left == []
    found = [r.force_class for r in report.replaced]
    expected = ["SurfaceAreaForce", "EnclosedVolumeForce", "TriangleHeightForce", "BendingForce"]
    assert found == (expected if listed == "outward" else ["EnclosedVolumeForce"])
    for force in faster.getForces():
        if helfrich.EnclosedVolumeForce.isinstance(force):
            ours = helfrich.EnclosedVolumeForce.cast(force)
            rows = {tuple(np.roll(row, -int(np.argmin(row)))) for row in m.triangles}
            assert tuple(ours.getTriangle(0)) in rows
    if listed == "inward" or style == "geometric":
        assert_same(system, faster)


# --- single triangles and edges ------------------------------------------------------------------


@pytest.mark.parametrize("style", string_forces.STYLES)
def test_local_terms_of_the_oracle(style):
    m = membrane()
    g = numpy_energies.Geometry(m.positions, m.triangles)
    rows = {
        "TriangleAreaForce": string_forces.triangle_area(m.triangles, 2.5, 0.9 * g.areas, style),
        "TriangleHeightForce": string_forces.triangle_heights(m.triangles, 60.0, 10.0, style),
        "TriangleAreaRepulsionForce": string_forces.triangle_area_repulsion(
            m.triangles, float(np.median(g.areas)), 10.0, style
        ),
    }
    system = system_of([force for forces in rows.values() for force in forces])
    faster, report = accelerate(system)
    assert_replaced(report, *rows)
    assert_same(system, faster)


@pytest.mark.parametrize("form", string_forces.DIHEDRAL_FORMS)
@pytest.mark.parametrize("style", string_forces.STYLES)
def test_dihedrals_of_the_oracle(form, style):
    system = system_of(string_forces.dihedral(membrane().triangles, 40.0, form, style))
    faster, report = accelerate(system)
    assert_replaced(report, "DihedralForce")
    ours = only(faster, helfrich.DihedralForce)
    assert ours.getForm() == getattr(helfrich.DihedralForce, form)
    assert ours.getStiffness() == 40
    assert_same(system, faster)


def _torsions(expression: str, parameters=()) -> mm.CustomTorsionForce:
    force = mm.CustomTorsionForce(expression)
    for name in parameters:
        force.addPerTorsionParameter(name)
    for edge in string_forces.edges_with_wings(membrane().triangles):
        force.addTorsion(*edge, [40.0, pi][: len(parameters)])
    return force


def test_torsions():
    """θ⁴ as a CustomTorsionForce, with a spontaneous angle that is flat."""
    system = system_of([_torsions("k*(1-cos(theta-theta0))^2", ["k", "theta0"])])
    faster, report = accelerate(system)
    assert_replaced(report, "DihedralForce")
    assert only(faster, helfrich.DihedralForce).getStiffness() == 40
    assert_same(system, faster)


# --- what is left alone -----------------------------------------------------------------------


def _changed(force: mm.CustomCompoundBondForce, old: str, new: str):
    """The same bonds with another expression."""
    text = force.getEnergyFunction()
    assert old in text
    result = mm.XmlSerializer.clone(force)
    result.setEnergyFunction(text.replace(old, new, 1))
    return result


def _strings(name: str, style: str = "sums") -> list[mm.Force]:
    return strings.custom_forces(OURS[name], style)


def _without_last_bond(force: mm.CustomCompoundBondForce) -> mm.CustomCompoundBondForce:
    result = mm.CustomCompoundBondForce(force.getNumParticlesPerBond(), force.getEnergyFunction())
    for number in range(force.getNumPerBondParameters()):
        result.addPerBondParameter(force.getPerBondParameterName(number))
    for number in range(force.getNumBonds() - 1):
        result.addBond(*force.getBondParameters(number))
    return result


def _periodic() -> mm.Force:
    (force,) = _strings("heights")
    force.setUsesPeriodicBoundaryConditions(True)
    return force


def _squared_global() -> mm.Force:
    (force,) = _strings("Quartic")
    force = _changed(force, "K*u^2", "K*boost^2*u^2")
    force.addGlobalParameter("boost", 1.0)
    return force


def _harmonic() -> mm.Force:
    force = mm.HarmonicBondForce()
    force.addBond(1, 2, 3.0, 4.0)
    return force


def _tabulated() -> mm.Force:
    force = mm.CustomCompoundBondForce(3, "table(distance(p1,p2))")
    force.addTabulatedFunction("table", mm.Continuous1DFunction([1.0, 2.0, 4.0], 0, 100))
    force.addBond([1, 2, 3], [])
    return force


def _cubic() -> mm.Force:
    (force,) = _strings("area")
    force.setEnergyFunction(force.getEnergyFunction().replace("^2", "^4"))
    return force


def _one_heavier_triangle() -> mm.Force:
    force = mm.CustomCVForce("0.5*(total-1e5)^2/1e5")
    inner = mm.CustomCompoundBondForce(
        3, "w*0.5*distance(p1,p2)*distance(p1,p3)*sin(angle(p2,p1,p3))"
    )
    inner.addPerBondParameter("w")
    for number, triangle in enumerate(membrane().triangles.tolist()):
        inner.addBond(triangle, [1.0 if number else 1.0001])
    force.addCollectiveVariable("total", inner)
    return force


FOREIGN = {
    "harmonic bonds": (lambda: [_harmonic()], "not a force that we replace"),
    "motion remover": (lambda: [mm.CMMotionRemover()], "not a force that we replace"),
    "exponent 6": (
        lambda: [_changed(_strings("heights")[0], ")^8", ")^6")],
        "none of those that we know",
    ),
    "one height stronger": (
        lambda: [_changed(_strings("heights")[0], "eps*", "1.0001*eps*")],
        "none of those that we know",
    ),
    "cutoff elsewhere": (
        lambda: [_changed(_strings("heights")[0], "-0.5)", "-0.5001)")],
        "none of those that we know",
    ),
    "twice the area": (
        lambda: [_changed(_strings("repulsion")[0], "^4-0.5)", "^4-8)")],
        "none of those that we know",
    ),
    "one edge heavier": (
        lambda: [
            _changed(force, "distance(p1,p2)*(2*step", "1.0001*distance(p1,p2)*(2*step")
            for force in _strings("Julicher")
        ],
        "none of those that we know",
    ),
    "angles without sign": (
        lambda: [
            force
            for given in _strings("Julicher")
            for force in [mm.XmlSerializer.clone(given)]
            if force.setEnergyFunction(_without_signs(given.getEnergyFunction())) is None
        ],
        "concave edges count as convex",
    ),
    "half of C0": (
        lambda: [_changed(f, "C0^2*a", "0.5*C0^2*a") for f in _strings("Espriu unsigned")],
        "do not belong together",
    ),
    "one degree missing": (
        lambda: _strings("GompperKrollBarycentric")[:-1],
        "has no energy of its own",
    ),
    "one vertex missing": (
        lambda: [
            _without_last_bond(_strings("JulicherVoronoi")[0]),
            *_strings("JulicherVoronoi")[1:],
        ],
        "has no energy of its own",
    ),
    "one triangle missing": (
        lambda: [_without_last_bond(_strings("heights")[0])],
        "belongs to 1 of its triangles",
    ),
    "one edge missing": (lambda: [_without_last_bond(_strings("Quartic")[0])], "of its triangles"),
    "one pair missing": (
        lambda: [_strings("area", "pairs")[0], _without_last_bond(_strings("area", "pairs")[1])],
        "",
    ),
    "pairs without the rest": (
        lambda: _strings("volume", "pairs")[1:],
        "do not add up to the square of the total volume",
    ),
    "a branch far away": (
        lambda: [_changed(_strings("Julicher")[0], "0.5*k", "step(1e9-distance(p1,p2))*0.5*k")],
        "only one side was ever met",
    ),
    "a bent rest state": (
        lambda: [_torsions("k*(1-cos(theta-theta0-0.01))^2", ["k", "theta0"])],
        "none of those that we know",
    ),
    "periodic": (lambda: [_periodic()], "periodic boundary conditions"),
    "a function of a global parameter": (lambda: [_squared_global()], "is not one of them"),
    "tabulated": (lambda: [_tabulated()], "tabulated"),
    "fourth power of the area": (lambda: [_cubic()], "not a quadratic function"),
    "one triangle heavier": (
        lambda: [_one_heavier_triangle()],
        "does not weigh all triangles alike",
    ),
}


def _without_signs(text: str) -> str:
    start = text.index("(2*step(")
    while start >= 0:
        end = text.index("-1)*", start)
        text = text[:start] + text[end + 4 :]
        start = text.find("(2*step(")
    return text


@pytest.mark.parametrize("name", FOREIGN)
def test_foreign_forces_are_untouched(name):
    make, reason = FOREIGN[name]
    system = system_of(make())
    before = [mm.XmlSerializer.serialize(force) for force in system.getForces()]
    faster, report = accelerate(system)
    assert report.replaced == []
    assert [mm.XmlSerializer.serialize(force) for force in faster.getForces()] == before
    assert [left.index for left in report.left] == list(range(len(before)))
    assert any(reason in left.reason for left in report.left), str(report)


def test_pieces_in_different_groups_are_left():
    forces = _strings("Julicher")
    forces[0].setForceGroup(3)
    _, report = accelerate(system_of(forces))
    assert report.replaced == []
    assert len(report.left) == len(forces)


def test_only_the_known_is_replaced():
    """Foreign forces between the others stay in their places."""
    system = system_of(
        [_harmonic(), *_strings("Quartic"), FOREIGN["exponent 6"][0]()[0], *_strings("area")]
    )
    faster, report = accelerate(system)
    assert [r.indices for r in report.replaced] == [(3,), (1,)]
    assert [left.index for left in report.left] == [0, 2]
    kinds = [force.getName() for force in faster.getForces()]
    assert kinds == [
        "HarmonicBondForce", "DihedralForce", "CustomCompoundBondForce", "SurfaceAreaForce",
    ]  # fmt: skip
    assert_same(system, faster)


# --- global parameters, names, groups and the rest of the System ------------------------------


def test_global_parameters_become_context_parameters():
    """κ and C0 of a bending energy, with a derivative, beside π, which OpenMM does not know."""
    forces = []
    for force in _strings("Julicher curved"):
        custom = mm.CustomCompoundBondForce(
            force.getNumParticlesPerBond(),
            force.getEnergyFunction().replace(repr(pi), "PI"),
        )
        custom.addGlobalParameter("k", 50.0)
        custom.addGlobalParameter("C0", -0.02)
        custom.addGlobalParameter("PI", pi)
        custom.addEnergyParameterDerivative("C0")
        for number in range(force.getNumBonds()):
            custom.addBond(force.getBondParameters(number)[0], [])
        forces.append(custom)
    system = system_of(forces)
    faster, report = accelerate(system)
    assert_replaced(report, "BendingForce")
    assert "PI" in report.notes[0]
    ours = only(faster, helfrich.BendingForce)
    assert ours.getContextParameter("rigidity") == "k"
    assert ours.getContextParameter("spontaneousCurvature") == "C0"
    assert_same(system, faster, [{}, {"k": 30.0, "C0": 0.01}])
    slopes = []
    for context in (context_of(system), context_of(faster)):
        context.setPositions(membrane().positions)
        state = context.getState(parameterDerivatives=True)
        slopes.append(state.getEnergyParameterDerivatives()["C0"])
    assert slopes[1] == pytest.approx(slopes[0], rel=1e-9)


def test_a_parameter_that_would_be_lost():
    (force,) = _strings("Quartic")
    force.addGlobalParameter("unused", 1.0)
    _, report = accelerate(system_of([force]))
    assert report.replaced == []
    assert "would lose the parameter unused" in report.left[0].reason


def test_the_rest_of_the_system():
    m = membrane()
    forces = _strings("heights") + _strings("area")
    for number, force in enumerate(forces):
        force.setForceGroup(5 + number)
        force.setName(f"term {number}")
    system = system_of(forces)
    a, b, c = m.foreign[:3].tolist()
    system.addConstraint(a, b, 1.5)
    system.setParticleMass(c, 0)
    system.setVirtualSite(c, mm.TwoParticleAverageSite(a, b, 0.3, 0.7))
    system.setDefaultPeriodicBoxVectors((900, 0, 0), (0, 800, 0), (0, 0, 700))
    before = mm.XmlSerializer.serialize(system)
    faster, _ = accelerate(system)
    assert mm.XmlSerializer.serialize(system) == before
    assert [(f.getName(), f.getForceGroup()) for f in faster.getForces()] == [
        ("term 0", 5),
        ("term 1", 6),
    ]
    for made in (system, faster):
        while made.getNumForces():
            made.removeForce(0)
    assert mm.XmlSerializer.serialize(faster) == mm.XmlSerializer.serialize(system)


def test_positions_say_what_is_outside():
    """Rings the wrong way round: the sign of C0 is against them."""
    m = membrane()
    inward = helfrich.BendingForce(m.triangles[:, ::-1], KAPPA, C0)
    system = system_of(strings.custom_forces(inward))
    as_listed, _ = accelerate(system)
    outward, _ = accelerate(system, m.positions * unit.nanometer)
    assert only(as_listed, helfrich.BendingForce).getSpontaneousCurvature() == C0
    assert only(outward, helfrich.BendingForce).getSpontaneousCurvature() == -C0
    assert_same(as_listed, outward)


def test_positions_must_agree():
    system = system_of(_strings("Quartic"))
    _, report = accelerate(system, membrane().positions, tolerance=0.0)
    assert report.replaced == []
    assert "ours differs at the positions" in report.left[0].reason
    with pytest.raises(ValueError, match=r"51 particles, but positions have the shape \(3, 3\)"):
        accelerate(system, np.zeros((3, 3)))


def test_report_can_be_read():
    _, report = accelerate(system_of([_harmonic(), *_strings("Julicher")]))
    text = str(report)
    assert "replaced 3 forces" in text
    assert "BendingForce, 80 triangles" in text
    assert "Julicher; rigidity = 50" in text
    assert "0 (HarmonicBondForce): it is not a force that we replace" in text


# --- expressions ---------------------------------------------------------------------------------

EXPRESSIONS = [
    "-x1^2+2^-3*y2", "2^3^2*x1", "x1-x2-x3/y1/y2", "2*-3^2*x1--x2", "g^-x1", "1./6*x1+1.5E-1*x2",
    "a*b; a=b+x1; b=cos(y2);", "distance(p1,p4)*angle(p1,p2,p3)^3", "dihedral(p1,p2,p3,p4)",
    "max(x1,x2)*min(y1,y2)+abs(x3)", "select(step(x1),x2,x3)*g+delta(x2)",
    "cot(x1)+sec(x2)+csc(x3)+tan(y1)", "erf(x1)+erfc(x2)+exp(x3)+sinh(y1)+cosh(y2)+tanh(z1)",
    "asin(x1/9)+acos(x2/9)+atan(x3)+atan2(x1,y2)", "sqrt(square(x1)+cube(x2)^2)+recip(x3)",
    "log(abs(x4))+floor(9*x1)+ceil(7*x2)", "abs(x1)^y1",
    "pointdistance(x1,y1,z1,x2+1,y2,z2)+pointangle(x1,y1,z1,x2,y2,z2,x3,y3,z3)",
    "pointdihedral(x1,y1,z1,x2,y2,z2,x3,y3,z3,x4,y4,z4)",
]  # fmt: skip


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_expressions_mean_what_openmm_means(text):
    positions = np.random.default_rng(1).normal(size=(4, 3))
    force = mm.CustomCompoundBondForce(4, text)
    force.addGlobalParameter("g", 1.7)
    force.addBond([0, 1, 2, 3], [])
    energy, forces = state_of(context_of(system_of([force], 4)), positions)
    variables = {
        f"{axis}{i + 1}": positions[i, k] for i in range(4) for k, axis in enumerate("xyz")
    }
    value, slopes = Expression(text, 4).gradient({**variables, "g": 1.7})
    ours = [[-slopes.get(f"{axis}{i + 1}", 0.0) for axis in "xyz"] for i in range(4)]
    assert float(value) == pytest.approx(energy, rel=1e-13)
    np.testing.assert_allclose(ours, forces, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x1+", "ends too early"),
        ("x1)", r"unexpected '\)'"),
        ("bessel(x1)", r"bessel\(\) is not known"),
        ("max(x1)", r"max\(\) has 1 arguments"),
        ("distance(p1,p9)", "there are 4 particles"),
        ("distance(x1,p2)", "'x1' is no particle"),
        ("a; a", "defines nothing"),
        ("1.2.3*x1", "'1.2.3' is no number"),
        ("(x1", "ends too early"),
        ("x1 x2", "unexpected 'x2'"),
        ("(" * 5000 + "x1" + ")" * 5000, "too deep"),
    ],
)
def test_broken_expressions(text, message):
    with pytest.raises(ExpressionError, match=message):
        Expression(text, 4)
