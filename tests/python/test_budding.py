"""What `examples/domains` measures, in short."""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

EXAMPLES = Path(__file__).parents[2] / "examples"


def tables_of(script, folder):
    """Tables by name that a script of `examples/domains` writes in its quick size."""
    command = [sys.executable, str(EXAMPLES / "domains" / script), "--quick", "--results", folder]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    return {path.stem: list(csv.DictReader(path.open())) for path in folder.glob("*.csv")}


@pytest.fixture
def scripts_importable(monkeypatch):
    before = set(sys.modules)
    for folder in ("flips", "domains"):
        monkeypatch.syspath_prepend(str(EXAMPLES / folder))
    yield
    for name in set(sys.modules) - before:
        if str(EXAMPLES) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def test_domains_bud_from_the_line_tension_of_theory_on(tmp_path):
    found = tables_of("budding.py", tmp_path)
    errors = [float(row["λL/κ"]) / 5.783186 - 1 for row in found["budding_modes"]]
    # They fall with the square of the edges.
    assert len(errors) == 2
    assert -0.03 < errors[0] < 0
    assert errors[1] == pytest.approx(errors[0] * (4.5 / 8.5) ** 2, rel=0.2)
    below, above = found["budding_runs"]
    assert (below["over_threshold"], above["over_threshold"]) == ("0.7", "1.6")
    assert abs(float(below["x_1"])) < 0.05
    assert float(above["x_1"]) > 0.6


@pytest.mark.usefixtures("scripts_importable")
class TestLinedShapes:
    def test_gradients_are_those_of_finite_differences(self):
        from lined_shapes import LinedShapes

        shapes, rng = LinedShapes(32, 0.15), np.random.default_rng(1)
        start = shapes.sphere() + np.append(0.3 / shapes.n**2, 0.1) * rng.normal(size=17)
        for function in (shapes.line, lambda variables: shapes.lined_energy(variables, 3.0)):
            _, gradient = function(start)
            for way in np.eye(17):
                high, low = (function(start + sign * 1e-6 * way)[0] for sign in (1, -1))
                assert gradient @ way == pytest.approx((high - low) / 2e-6, rel=1e-6, abs=1e-7)

    def test_line_is_where_the_area_of_a_domain_ends(self):
        from lined_shapes import LinedShapes

        shapes = LinedShapes(32, 0.15)
        variables = shapes.sphere() + np.append(0.4 / shapes.n**2, 0)
        # The contour once more, by trapezoids on a fine grid.
        x = np.linspace(0, 1, 40001)
        psi = np.pi * x + np.sin(np.pi * np.outer(x, shapes.n)) / shapes.n @ variables[:-1]
        r = variables[-1] * cumulative_trapezoid(np.cos(psi), x, initial=0)
        areas = cumulative_trapezoid(r, x, initial=0)
        expected = np.interp(0.15 * areas[-1], areas, r)
        assert shapes.line(variables)[0] == pytest.approx(expected, rel=1e-7)

    def test_weak_tensions_leave_a_sphere_whose_domains_bend_as_in_second_order(self):
        from lined_shapes import LinedShapes

        share = 0.1
        shapes, radius = LinedShapes(64, share), 2 * np.sqrt(share * (1 - share))
        assert shapes.line(shapes.sphere())[0] == pytest.approx(radius, rel=1e-9)
        (unstrained, none) = shapes.minimum_at(radius, shapes.sphere() + 0.01 / 64)
        np.testing.assert_allclose(unstrained, shapes.sphere(), atol=2e-5)
        assert abs(none) < 1e-3
        # A spring: as much tension as there is strain.
        tensions = [
            shapes.minimum_at((1 - strain) * radius, shapes.sphere())[1]
            for strain in (0.001, 0.002)
        ]
        assert tensions[1] == pytest.approx(2 * tensions[0], rel=0.02)


@pytest.mark.long
def test_domains_of_a_vesicle_bud_from_the_spinodal_on(tmp_path):
    found = tables_of("vesicle_budding.py", tmp_path)
    (theory,) = found["vesicle_budding_theory"]
    assert float(theory["buds_open"]) < float(theory["equal_energies"]) < float(theory["spinodal"])
    (mesh,) = found["vesicle_budding_energies"]
    assert float(mesh["spinodal"]) == pytest.approx(float(mesh["theory"]), rel=0.01)
    for row in found["vesicle_budding_cold"]:
        if float(row["over_spinodal"]) <= 0.9:
            assert abs(float(row["difference"])) < 0.02
    below, above = found["vesicle_budding_runs"]
    assert (below["over_spinodal"], below["buds"]) == ("0.7", "0")
    assert (above["over_spinodal"], above["buds"]) == ("1.6", "2")


@pytest.mark.long
def test_domains_coarsen_and_keep_the_composition(tmp_path):
    rows = tables_of("coarsening.py", tmp_path)["coarsening"]
    assert {row["second_kind"] for row in rows} == {"76"}
    lengths = {}
    for row in rows:
        lengths.setdefault((row["name"], row["seed"]), []).append(float(row["line/l"]))
    assert len(lengths) == 6
    for (name, _), line in lengths.items():
        assert (line[-1] < 0.6 * line[0]) == (name != "mixed")


@pytest.mark.usefixtures("scripts_importable")
def test_domains_are_connected_sets():
    from coarsening import domain_sizes

    # A strip of triangles, on which neighbours are those at most two apart.
    strip = np.array([[i, i + 1, i + 2] for i in range(8)])
    assert domain_sizes(strip, [1, 0, 1, 0, 0, 1, 1, 0, 0, 1]).tolist() == [2, 2, 1]
    assert domain_sizes(strip, [1] * 10).tolist() == [10]
