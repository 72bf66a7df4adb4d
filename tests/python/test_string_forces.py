"""The oracle itself: the string forces against VCM, the tables of physics.md, and derivatives.

None of this needs the plugin; it is what makes the other tests' verdicts worth something. The
schemes whose expressions take OpenMM long are here only with HELFRICH_SLOW_TESTS=1, when they are
tested on vertices of six neighbours as well.
"""

from __future__ import annotations

from functools import cache

import meshes
import numpy as np
import numpy_energies
import oracle
import published
import pytest
import string_forces
from oracle import Result
from published import GOLDEN_TERMS, PRINTED, GoldenTerm, Printed
from string_forces import STYLES

RIGIDITY = 50.0
QUICK = {
    ("Julicher", "geometric"),
    ("Julicher", "cartesian"),
    ("JulicherVoronoi", "geometric"),
    ("Espriu", "geometric"),
    ("Espriu", "cartesian"),
}


def _bending_rows() -> list:
    rows = []
    for scheme in string_forces.BENDING_SCHEMES:
        for curvature, unsigned in ((0.0, False), (0.02, False), (-0.015, False), (0.02, True)):
            if unsigned and scheme.startswith("Julicher"):
                continue
            for style in STYLES:
                long = not scheme.startswith("Julicher") and curvature != 0
                if not oracle.SLOW and (long or (scheme, style) not in QUICK):
                    continue
                for name in meshes.NAMES:
                    if oracle.bending_within_limits(
                        meshes.membrane(name), scheme, style, curvature != 0, unsigned
                    ):
                        rows.append((scheme, curvature, unsigned, style, name))
    return rows


@cache
def _other_terms(name: str) -> dict[str, tuple]:
    """Everything but bending: numpy's energy, and the string forces by style."""
    m = meshes.membrane(name)
    x, t = m.positions, m.triangles
    g = numpy_energies.Geometry(x, t)
    low, targets = float(np.quantile(g.heights, 0.3)), g.areas * 0.9
    rows = {
        "area": (numpy_energies.global_area, string_forces.global_area, (1.3, 0.93 * g.area)),
        "volume": (
            numpy_energies.global_volume,
            string_forces.global_volume,
            (0.04, 0.9 * g.volume),
        ),
        "heights": (numpy_energies.triangle_heights, string_forces.triangle_heights, (low, 10.0)),
        "areas": (numpy_energies.triangle_area, string_forces.triangle_area, (1.3, targets)),
        "area repulsion": (
            numpy_energies.triangle_area_repulsion,
            string_forces.triangle_area_repulsion,
            (float(np.quantile(g.areas, 0.3)), 10.0),
        ),
        "plaquettes": (
            numpy_energies.plaquette_area,
            string_forces.plaquette_area,
            (400.0, 0.9 * g.area),
        ),
    }
    for form in string_forces.DIHEDRAL_FORMS:
        rows[form] = (numpy_energies.dihedral, string_forces.dihedral, (40.0, form))
    return rows


def _assert_gradient(energy, forces: np.ndarray, membrane, step: float = 3e-4) -> None:
    """The forces against central differences of an energy, along random directions.

    Richardson's extrapolation of two steps, given in edge lengths, leaves an error of fourth
    order, so that steps can be large enough for rounding not to matter.
    """
    rng = np.random.default_rng(17)
    step *= membrane.mean_edge
    largest = np.abs(forces).max()
    for _ in range(4):
        direction = np.zeros_like(membrane.positions)
        direction[membrane.members] = rng.uniform(-1, 1, (len(membrane.members), 3))

        def slope(h: float, direction: np.ndarray = direction) -> float:
            plus = energy(membrane.positions + h * direction)
            return (plus - energy(membrane.positions - h * direction)) / (2 * h)

        measured = (4 * slope(step) - slope(2 * step)) / 3
        expected = -np.sum(forces * direction)
        assert abs(measured - expected) <= 1e-7 * largest


@pytest.mark.parametrize(("scheme", "curvature", "unsigned", "style", "name"), _bending_rows())
def test_bending(scheme, curvature, unsigned, style, name):
    membrane = meshes.membrane(name)

    def energy(positions) -> float:
        return numpy_energies.bending(
            positions, membrane.triangles, RIGIDITY, curvature, scheme, unsigned
        )

    result = oracle.bending(membrane, scheme, style, RIGIDITY, curvature, unsigned)
    assert result.energy == pytest.approx(energy(membrane.positions), rel=1e-12)
    # |S| comes to a point at S = 0, and some vertices are near it.
    _assert_gradient(energy, result.forces, membrane, step=2e-5 if unsigned else 3e-4)


@pytest.mark.parametrize("name", meshes.NAMES)
@pytest.mark.parametrize("term", _other_terms("jittered"))
def test_other_terms(term, name):
    membrane = meshes.membrane(name)
    by_numpy, by_strings, scalars = _other_terms(name)[term]

    def energy(positions) -> float:
        return by_numpy(positions, membrane.triangles, *scalars)

    results = [
        oracle.evaluate(by_strings(membrane.triangles, *scalars, style), membrane.positions)
        for style in STYLES
    ]
    for result in results:
        assert result.energy == pytest.approx(energy(membrane.positions), rel=1e-11)
        # The second derivative jumps at the cutoff: no large steps across it.
        step = 2e-5 if term in ("heights", "area repulsion") else 3e-4
        _assert_gradient(energy, result.forces, membrane, step)
    largest = np.abs(results[0].forces).max()
    np.testing.assert_allclose(results[1].forces, results[0].forces, rtol=0, atol=1e-11 * largest)


def test_rings_are_counterclockwise():
    membrane = meshes.membrane("many neighbours")
    rows = {tuple(np.roll(row, -turn)) for row in membrane.triangles for turn in range(3)}
    rings = string_forces.rings(membrane.triangles)
    assert sorted(rings) == membrane.members.tolist()
    assert {len(ring) for ring in rings.values()} >= {3, 4, 5, 11, 12}
    for vertex, ring in rings.items():
        for b, c in zip(ring, ring[1:] + ring[:1], strict=True):
            assert (vertex, b, c) in rows


# --- VCM's golden file ---------------------------------------------------------------------------


def _golden_by_strings(term: GoldenTerm, style: str) -> Result | None:
    forces = published.string_golden(term, style)
    if forces is not None:
        return oracle.evaluate(forces, term.membrane.positions)
    scheme, a = term.variant[1], term.arguments()
    c0, unsigned = a["spontaneousCurvature"], bool(term.settings)
    slow = c0 != 0 or (scheme, style) not in QUICK
    within = oracle.bending_within_limits(term.membrane, scheme, style, c0 != 0, unsigned)
    if not within or (slow and not oracle.SLOW):
        return None
    return oracle.bending(term.membrane, scheme, style, a["rigidity"], c0, unsigned)


@pytest.mark.usefixtures("shared")
@pytest.mark.parametrize("term", GOLDEN_TERMS, ids=str)
def test_golden(term):
    """Both styles where they compile in time, and numpy's energy always."""
    a, m = term.arguments(), term.membrane
    function = {
        "SurfaceAreaForce": numpy_energies.global_area,
        "EnclosedVolumeForce": numpy_energies.global_volume,
        "TriangleHeightForce": numpy_energies.triangle_heights,
        "BendingForce": numpy_energies.bending,
    }[term.force]
    more = [term.variant[1], bool(term.settings)] if term.variant else []
    energy = function(m.positions, m.triangles, *a.values(), *more)
    assert energy == pytest.approx(term.energy, rel=term.tolerance)
    largest = np.abs(term.forces).max()
    for style in STYLES:
        result = _golden_by_strings(term, style)
        if result is not None:
            assert result.energy == pytest.approx(term.energy, rel=term.tolerance)
            np.testing.assert_allclose(
                result.forces, term.forces, rtol=0, atol=term.tolerance * largest
            )


# --- the tables of physics.md --------------------------------------------------------------------


@pytest.mark.usefixtures("shared")
@pytest.mark.parametrize("printed", PRINTED, ids=str)
def test_printed_numbers(printed: Printed):
    m = published.table_mesh(printed.mesh)
    x, t, a = m.positions, m.triangles, printed.arguments
    if printed.quantity == "area":
        value = numpy_energies.Geometry(x, t).area
    elif printed.quantity == "volume":
        value = numpy_energies.Geometry(x, t).volume
    elif printed.quantity.startswith("bending"):
        unsigned = printed.quantity.endswith("unsigned")
        value = numpy_energies.bending(x, t, *a.values(), scheme=printed.scheme, unsigned=unsigned)
    elif printed.quantity.startswith("heights"):
        value = numpy_energies.triangle_heights(x, t, *a.values())
        # The strings know the same table by other arithmetic.
        for style in STYLES:
            forces = string_forces.triangle_heights(t, *a.values(), style)
            printed.assert_met_by(oracle.evaluate(forces, x).energy)
    elif printed.quantity == "dihedrals":
        value = numpy_energies.dihedral(x, t, *a.values())
        for style in STYLES:
            forces = string_forces.dihedral(t, *a.values(), "Quartic", style)
            printed.assert_met_by(oracle.evaluate(forces, x).energy)
    else:
        sphere = published.table_mesh("sphere")
        g = numpy_energies.Geometry(sphere.positions, sphere.triangles)
        if printed.quantity == "area energy":
            value = numpy_energies.global_area(x, t, 1.3, g.area)
        else:
            value = numpy_energies.global_volume(x, t, 0.04, g.volume)
    printed.assert_met_by(value)


@pytest.mark.parametrize("style", STYLES)
def test_fastest_is_the_same_energy(style):
    """The expressions that the plugin races against compute what the others compute."""
    membrane = meshes.membrane("octahedron")
    x, t = membrane.positions, membrane.triangles
    g = numpy_energies.Geometry(x, t)
    scalars = {
        "rigidity": 50.0,
        "area_modulus": 1.3,
        "area_target": 0.9 * g.area,
        "volume_modulus": 0.04,
        "volume_target": 0.8 * g.volume,
        "min_height": 70.0,
        "epsilon": 10.0,
    }

    def energy(positions) -> float:
        return (
            numpy_energies.bending(positions, t, 50.0)
            + numpy_energies.global_area(positions, t, 1.3, 0.9 * g.area)
            + numpy_energies.global_volume(positions, t, 0.04, 0.8 * g.volume)
            + numpy_energies.triangle_heights(positions, t, 70.0, 10.0)
        )

    result = oracle.evaluate(string_forces.fastest(t, style=style, **scalars), x)
    assert result.energy == pytest.approx(energy(x), rel=1e-12)
    _assert_gradient(energy, result.forces, membrane, step=2e-5)
