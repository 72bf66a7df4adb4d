"""Shapes of vesicles: the axisymmetric reference of `examples/flips`, and a mesh that finds it.

Numbers are of U. Seifert, K. Berndl and R. Lipowsky, Phys. Rev. A 44, 1182 (1991),
doi:10.1103/PhysRevA.44.1182.
"""

import sys
from pathlib import Path

import numpy as np
import pytest
from openmmhelfrich import BendingForce, Mesh

FLIPS = Path(__file__).parents[2] / "examples" / "flips"


@pytest.fixture(autouse=True)
def scripts_importable(monkeypatch):
    monkeypatch.syspath_prepend(str(FLIPS))
    yield
    for name in ("axisymmetric", "constrained", "shapes", "fluid_run", "reports"):
        sys.modules.pop(name, None)


class TestMinimum:
    """Of y on the ellipse x²/4 + y² = 1, and of a double well beside a plane."""

    @staticmethod
    def of_height(start):
        from constrained import minimum

        def constraint(x):
            return np.array([x[0] ** 2 / 4 + x[1] ** 2 - 1]), np.array([[x[0] / 2, 2 * x[1]]])

        return minimum(lambda x: (x[1], np.array([0.0, 1.0])), constraint, start, lambda x: True)

    @staticmethod
    def of_well(start):
        from constrained import minimum

        def well(x):
            return (x[0] ** 2 - 1) ** 2 + x[1] ** 2, np.array(
                [4 * x[0] * (x[0] ** 2 - 1), 2 * x[1], 0.0]
            )

        def plane(x):
            return np.array([x[2] - 3]), np.array([[0, 0, 1.0]])

        return minimum(well, plane, start, lambda x: True)

    def test_is_the_one_beside_the_start(self):
        assert self.of_height([0.3, 0.9]) == pytest.approx([0, -1], abs=1e-6)
        assert self.of_well([0.2, 0.1, 0]) == pytest.approx([1, 0, 3], abs=1e-6)
        assert self.of_well([-0.2, 0.1, 0]) == pytest.approx([-1, 0, 3], abs=1e-6)

    def test_maxima_and_saddles_are_none(self):
        for find, start in ((self.of_height, [0, 1]), (self.of_well, [0, 0.1, 0])):
            with pytest.raises(RuntimeError, match=r"no minimum: a curvature is -.*start beside"):
                find(start)


class TestReference:
    @pytest.mark.long
    def test_branches_cross_where_published(self):
        from axisymmetric import crossing

        assert crossing("prolate", "oblate", 0.6, 0.7) == pytest.approx(0.651, abs=6e-4)
        # Printed as 0.592 and 0.591.
        between = crossing("oblate", "stomatocyte", 0.55, 0.65)
        assert between == pytest.approx(0.5915, abs=6e-4)

    def test_energy_near_the_sphere_is_that_of_its_second_mode(self):
        from axisymmetric import contour

        # E / 8πκ = 1 + x (1 ± p x^½ + q x …), x = 3 (ν^(−2/3) − 1) of l = 2 in second order.
        # Oblates are prolates of negative amplitude: they differ in the sign of half powers.
        means, halves = [], []
        for volume in (0.96, 0.99):
            x = 3 * (volume ** (-2 / 3) - 1)
            rest = [(contour(each, volume).energy - 1) / x - 1 for each in ("prolate", "oblate")]
            means.append(sum(rest) / 2 / x)
            halves.append((rest[1] - rest[0]) / 2 / x**0.5)
        assert abs(means[1] * x) < 0.01
        assert means[0] == pytest.approx(means[1], rel=0.1)
        assert halves[0] == pytest.approx(halves[1], rel=0.1)

    @pytest.mark.long
    def test_stomatocytes_become_two_spheres(self):
        from axisymmetric import contour

        energies = [contour("stomatocyte", volume).energy for volume in (0.4, 0.3, 0.2)]
        assert 1.99 < energies[0] < energies[1] < energies[2] < 2

    @pytest.mark.parametrize(
        ("branch", "volume"), [("prolate", 0.6), ("oblate", 0.6), ("stomatocyte", 0.5)]
    )
    def test_contour_has_its_area_volume_and_energy(self, branch, volume):
        from axisymmetric import contour

        shape = contour(branch, volume)
        r, z = shape.r, shape.z
        lengths = np.hypot(np.diff(r), np.diff(z))
        middle = (r[1:] + r[:-1]) / 2
        assert 2 * np.pi * middle @ lengths == pytest.approx(4 * np.pi, rel=1e-3)
        enclosed = np.pi * middle**2 @ np.diff(z)
        assert abs(enclosed) == pytest.approx(volume * 4 * np.pi / 3, rel=1e-3)
        # Both principal curvatures by finite differences of the points alone.
        turning = np.unwrap(np.arctan2(np.diff(z), np.diff(r)))
        arc = (lengths[1:] + lengths[:-1]) / 2
        along = np.diff(turning) / arc
        around = np.sin((turning[1:] + turning[:-1]) / 2) / r[1:-1]
        energy = (along + around) ** 2 @ (r[1:-1] * arc) / 8
        assert energy == pytest.approx(shape.energy, rel=5e-3)

    def test_says_where_a_branch_ends(self):
        from axisymmetric import contour

        with pytest.raises(ValueError, match=r"oblates needs 0.5 to 0.99, got 0.4$"):
            contour("oblate", 0.4)
        with pytest.raises(ValueError, match="got 'pear'"):
            contour("pear", 0.8)


@pytest.mark.long
def test_a_fluid_oblate_becomes_a_prolate_and_a_fixed_one_does_not():
    from shapes import RIGIDITY, branch_of, reference, shape_of

    for flips, branch in ((True, "prolate"), (False, "oblate")):
        run = shape_of(252, "oblate", 0.8, flips, seed=1, share=0.5)
        mesh = Mesh(run["vertices"], run["triangles"])
        assert not run["failed"]
        assert branch_of(mesh) == branch
        if flips:
            energy = run["bending"] / (8 * np.pi * RIGIDITY)
            assert mesh.energy(BendingForce(mesh, 1 / (8 * np.pi))) == pytest.approx(energy)
            assert energy == pytest.approx(reference("prolate", mesh.reduced_volume), rel=0.02)


def test_crossing_is_seen():
    from shapes import crossing, spheroid

    mesh = spheroid(252, "oblate", 0.8, seed=1)
    assert crossing(mesh) == 0
    # The top is pushed through the bottom.
    vertices = mesh.vertices.copy()
    middle = (np.hypot(*vertices[:, :2].T) < 400) & (vertices[:, 2] > 0)
    vertices[middle, 2] -= 1500
    assert crossing(Mesh(vertices, mesh.triangles)) > 0.05
