"""Area-difference elasticity finds the shapes of axisymmetric theory: `examples/ade_shapes.py`."""

import sys
from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich import Mesh, analysis

SPHERE = Mesh.icosphere(20, 1.0)
EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(autouse=True)
def scripts_importable(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.syspath_prepend(str(EXAMPLES / "flips"))
    yield
    for name in ("ade_limits", "ade_shapes", "axisymmetric", "constrained", "reports"):
        sys.modules.pop(name, None)


def test_difference_of_a_contour_has_its_gradient():
    from axisymmetric import Shapes

    shapes = Shapes(12, 1)
    rng = np.random.default_rng(3)
    variables = np.append(0.3 * rng.normal(size=12) / shapes.n, 3.2)
    _, gradient = shapes.area_difference(variables)
    for k in range(13):
        step = np.zeros(13)
        step[k] = 1e-6
        ends = [shapes.area_difference(variables + by * step)[0] for by in (1, -1)]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / 2e-6, abs=1e-7)
    sphere = np.append(np.zeros(12), np.pi)
    assert shapes.area_difference(sphere)[0] == pytest.approx(1, rel=1e-9)


def test_contours_and_their_meshes_agree():
    from ade_shapes import axisymmetric, kind_of

    for kind, difference in (("prolate", 1.1), ("oblate", 1.0), ("pear", 1.2)):
        _, mesh = axisymmetric(kind, 0.85, difference, SPHERE)
        assert kind_of(mesh) == kind
        assert mesh.reduced_volume == pytest.approx(0.85, rel=2e-3)
        assert mesh.area == pytest.approx(4 * np.pi, rel=2e-3)
    # The pear follows Δa0 more than a prolate can.
    assert 1.12 < analysis.area_difference(mesh, mesh) < 1.16


def test_without_the_energy_of_the_difference_it_is_that_of_bending():
    import ade_shapes
    from axisymmetric import contour

    ade_shapes.ALPHA = 0.0
    for kind in ("prolate", "oblate"):
        energy, _ = ade_shapes.axisymmetric(kind, 0.85, 1.3, SPHERE)
        assert energy == pytest.approx(contour(kind, 0.85).energy, rel=1e-5)


@pytest.mark.parametrize(
    ("start", "kind", "difference"),
    [
        pytest.param("prolate", "prolate", 1.1, marks=pytest.mark.long),
        ("spheres", "pear", 1.2),
    ],
)
def test_a_vesicle_finds_it(start: str, kind: str, difference: float):
    from ade_shapes import kind_of, least_axisymmetric, shape_of

    run = shape_of(492, start, 0.85, difference)
    mesh = Mesh(run["vertices"], run["triangles"])
    expected, expected_kind = least_axisymmetric(mesh.reduced_volume, difference)
    assert kind_of(mesh) == kind == expected_kind
    energy = run["bending"] + run["area_difference"]
    assert energy == pytest.approx(expected, rel=0.02)


@pytest.mark.long
def test_a_bud_stays_where_theory_has_it():
    from ade_shapes import row_of, shape_of

    row = row_of(0.95, 1.2, [shape_of(1002, "theory", 0.95, 1.2)])
    assert row[5] == "budded"
    # Δa follows that of the bud, which a prolate of this volume cannot: 1.023.
    assert row[3] > 1.04
    assert abs(row[-1]) < 4


def test_the_limit_of_fine_meshes():
    from ade_limits import limit

    numbers = np.array([502, 502, 1002, 2002, 4002])
    energies = 2.5 + 7.0 / np.sqrt(numbers)
    energy, error = limit(numbers, energies)
    assert energy == pytest.approx(2.5, rel=1e-12)
    assert error < 1e-12
    noise = np.random.default_rng(1).normal(0, 0.01, (2000, 5))
    found = np.array([limit(numbers, energies + each) for each in noise])
    assert found[:, 0].mean() == pytest.approx(2.5, abs=0.002)
    assert np.sqrt(np.mean(found[:, 1] ** 2)) == pytest.approx(found[:, 0].std(), rel=0.1)


@pytest.mark.long
def test_buds_are_set_beside_two_spheres(monkeypatch, tmp_path):
    import ade_limits

    monkeypatch.setattr("sys.argv", ["ade_limits.py", "--quick", "--results", str(tmp_path)])
    ade_limits.main()
    head, *rows = (tmp_path / "ade_limits.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("N,ν,Δa0,shape")
    assert [row.split(",")[0] for row in rows] == ["132", "192", "252"]
    # Above theory, the less the finer, and none through itself.
    above, crossings = zip(*[map(float, row.split(",")[-2:]) for row in rows], strict=True)
    assert 20 > above[0] > above[-1] > 5
    assert not any(crossings)
    [row] = (tmp_path / "ade_limits_limit.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert row.startswith("0.85,1.4,3,")
