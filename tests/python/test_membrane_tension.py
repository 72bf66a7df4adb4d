"""The box under MonteCarloMembraneTension, against distributions that are known exactly."""

from __future__ import annotations

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from platforms import CPU, ON_OPENCL, REFERENCE
from scipy import stats
from tense import (
    BOX,
    COUNT,
    KT,
    TEMPERATURE,
    box_of,
    boxes,
    mover_of,
    of_box,
    positions_of,
    tense,
)

#: Good samples are rarely worse than this: p of a test of Kolmogorov and Smirnov.
RARE = 0.002


def assert_distributed(samples, weight, low: float, high: float):
    """Samples of a density that is given by the logarithm of its weight."""
    grid = np.linspace(low, high, 20001)
    logarithm = weight(grid)
    density = np.exp(logarithm - logarithm.max())
    # Nothing to speak of is left out.
    assert max(density[0], density[-1]) < 1e-5
    cumulative = np.concatenate([[0], np.cumsum(density[1:] + density[:-1])])
    p = stats.kstest(samples, lambda x: np.interp(x, grid, cumulative / cumulative[-1])).pvalue
    assert p > RARE


class TestFreeParticles:
    """The weight of the box is its volume to the power of the number of particles."""

    @pytest.mark.parametrize("tension", [-1.0, -0.3])
    def test_isotropic(self, tension):
        context = tense(of_box(), mover_of(tension=tension))
        lengths = boxes(context, 3000, 50)
        areas = lengths[:, 0] * lengths[:, 1]
        assert stats.kstest(areas, stats.gamma(COUNT + 1, scale=-KT / tension).cdf).pvalue > RARE
        # The wrong power would not pass.
        assert stats.kstest(areas, stats.gamma(COUNT, scale=-KT / tension).cdf).pvalue < 1e-6

    def test_isotropic_in_an_energy_of_the_area(self):
        force = of_box("0.05*(ax*by-30)^2")
        context = tense(force, mover_of(tension=0.4))
        lengths = boxes(context, 3000, 50)

        def weight(area):
            return COUNT * np.log(area) + (0.4 * area - 0.05 * (area - 30) ** 2) / KT

        assert_distributed(lengths[:, 0] * lengths[:, 1], weight, 0.1, 70)

    def test_independent(self):
        """With a tension the two lengths are not independent of each other; the grid has both."""
        force = of_box("0.8*(ax-5)^2+0.5*(by-4)^2")
        context = tense(force, mover_of(tension=-0.4, axes="XYIndependent"))
        lengths = boxes(context, 3000, 100)
        x, y = (np.linspace(0.01, 14, 700) for _ in range(2))
        energy = 0.8 * (x[:, None] - 5) ** 2 + 0.5 * (y - 4) ** 2 + 0.4 * x[:, None] * y
        joint = COUNT * np.log(x[:, None] * y) - energy / KT
        for axis, grid in enumerate((x, y)):
            marginal = np.log(np.exp(joint).sum(axis=1 - axis))
            assert_distributed(
                lengths[:, axis], lambda q, g=grid, m=marginal: np.interp(q, g, m), 0.01, 14
            )
        correlation = np.corrcoef(lengths[:, 0], lengths[:, 1])[0, 1]
        weights = np.exp(joint - joint.max())
        weights /= weights.sum()
        mean = [(weights.sum(axis=1 - axis) * g).sum() for axis, g in enumerate((x, y))]
        dx, dy = x - mean[0], y - mean[1]
        exact = (weights * dx[:, None] * dy).sum() / np.sqrt(
            (weights.sum(axis=1) * dx**2).sum() * (weights.sum(axis=0) * dy**2).sum()
        )
        assert correlation == pytest.approx(exact, abs=0.06)

    def test_constant_area(self):
        """Only the energy counts, and a change of ln x by a number is as good as any other."""
        context = tense(of_box("3*(log(ax)-1.5)^2"), mover_of(axes="XYConstantArea"))
        lengths = boxes(context, 3000, 50)
        assert_distributed(np.log(lengths[:, 0]), lambda log: -3 * (log - 1.5) ** 2 / KT, -4, 7)
        np.testing.assert_allclose(lengths[:, 0] * lengths[:, 1], 20, rtol=1e-11)
        assert set(lengths[:, 2]) == {6.0}
        assert list(context.getParameters()) == ["MembraneTensionTemperature"]

    def test_along_z(self):
        context = tense(of_box(), mover_of(axes="ZOnly", pullingForce=-2.0))
        lengths = boxes(context, 3000, 50)
        assert stats.kstest(lengths[:, 2], stats.gamma(COUNT + 1, scale=KT / 2).cdf).pvalue > RARE
        assert (lengths[:, :2] == [5, 4]).all()

    def test_plane_and_z_together(self):
        plane = mover_of(tension=-1.0)
        along = mover_of(axes="ZOnly", pullingForce=-2.0)
        lengths = boxes(tense(of_box(), plane, along), 3000, 50)
        areas = lengths[:, 0] * lengths[:, 1]
        assert stats.kstest(areas, stats.gamma(COUNT + 1, scale=KT).cdf).pvalue > RARE
        assert stats.kstest(lengths[:, 2], stats.gamma(COUNT + 1, scale=KT / 2).cdf).pvalue > RARE
        # The two have random numbers of their own.
        assert abs(np.corrcoef(areas, lengths[:, 2])[0, 1]) < 0.06

    def test_the_shape_of_the_box_stays(self):
        context = tense(of_box(), mover_of(tension=-1.0))
        start = BOX / np.diag(BOX)
        for _ in range(20):
            context.getIntegrator().step(50)
            box = box_of(context)
            factors = np.diag(box) / np.diag(BOX)
            assert factors[0] == pytest.approx(factors[1], rel=1e-12)
            np.testing.assert_allclose(box / np.diag(box), start, rtol=1e-12)

    def test_a_box_of_the_most_slanted_shape(self):
        """OpenMM refuses a box whose vectors have slanted more than by half, even by rounding."""
        box = [[5, 0, 0], [-2.5, 4, 0], [2.5, -2, 6]]
        context = tense(of_box(), mover_of(tension=-1.0, axes="XYIndependent"), box=box)
        boxes(context, 100, 100)

    @pytest.mark.parametrize(
        "integrator",
        [
            lambda: mm.VerletIntegrator(0.001),
            lambda: mm.LangevinMiddleIntegrator(TEMPERATURE, 1, 0.001),
            lambda: mm.LangevinIntegrator(TEMPERATURE, 1, 0.001),
            lambda: mm.BrownianIntegrator(TEMPERATURE, 1, 0.001),
            lambda: mm.NoseHooverIntegrator(TEMPERATURE, 1, 0.001),
            lambda: mm.VariableVerletIntegrator(0.001),
            lambda: mm.VariableLangevinIntegrator(TEMPERATURE, 1, 0.001),
            lambda: mm.DPDIntegrator(TEMPERATURE, 1, 1, 0.001),
            lambda: mm.QTBIntegrator(TEMPERATURE, 1, 0.02),
            lambda: compound(),
            lambda: custom(),
        ],
        ids=[
            *("Verlet", "LangevinMiddle", "Langevin", "Brownian", "NoseHoover"),
            *("VariableVerlet", "VariableLangevin", "DPD", "QTB", "Compound", "Custom"),
        ],
    )
    def test_under_any_integrator(self, integrator):
        """The moves are a function of the seed: all integrators see the same boxes."""
        context = tense(of_box(), mover_of(tension=-1.0), target=REFERENCE, integrator=integrator())
        other = tense(of_box(), mover_of(tension=-1.0), target=REFERENCE)
        for one in (context, other):
            one.getIntegrator().step(5)
        assert box_of(context)[0, 0] != 5
        np.testing.assert_array_equal(box_of(context), box_of(other))


def compound() -> mm.CompoundIntegrator:
    integrator = mm.CompoundIntegrator()
    integrator.addIntegrator(mm.VerletIntegrator(0.001))
    return integrator


def custom() -> mm.CustomIntegrator:
    integrator = mm.CustomIntegrator(0.001)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v+dt*f/m")
    integrator.addComputePerDof("x", "x+dt*v")
    return integrator


class TestBonds:
    """Springs of no length through the faces of the box: what they cost grows with its square."""

    def langevin(self):
        integrator = mm.LangevinMiddleIntegrator(TEMPERATURE, 5.0, 0.02)
        integrator.setRandomNumberSeed(3)
        return integrator

    def test_a_chain_that_is_pulled(self):
        """Energy k L^2 / 2n and that of modes, which do not know L; the centre is anywhere in L."""
        n, k, pull = 12, 40.0, 60.0
        springs = mm.HarmonicBondForce()
        springs.setUsesPeriodicBoundaryConditions(True)
        for i in range(n):
            springs.addBond(i, (i + 1) % n, 0, k)
        positions = np.full((n, 3), 5.0)
        positions[:, 2] = np.arange(n) * pull / k
        mover = mover_of(axes="ZOnly", pullingForce=pull, rigid=False, frequency=2)
        context = tense(
            springs,
            mover,
            integrator=self.langevin(),
            positions=positions,
            box=np.diag([10, 10, n * pull / k]),
        )
        lengths = boxes(context, 2000, 100, discard=10000)[:, 2]
        assert_distributed(
            lengths,
            lambda x: np.log(x) + (pull * x - k * x**2 / (2 * n)) / KT,
            *(n * pull / k - 6, n * pull / k + 6),
        )

    def test_a_sheet(self):
        """Of n x n particles in a slanted box, with an energy of the area that keeps it large."""
        n, k, tension = 4, 30.0, 5.0
        springs = mm.HarmonicBondForce()
        springs.setUsesPeriodicBoundaryConditions(True)
        number = np.arange(n * n).reshape(n, n)
        for axis in (0, 1):
            for i, j in zip(number.ravel(), np.roll(number, -1, axis).ravel(), strict=True):
                springs.addBond(int(i), int(j), 0, k)
        box = np.array([[8.0, 0, 0], [2.0, 7.0, 0], [0, 0, 20.0]])
        grid = np.stack(np.meshgrid(range(n), range(n), indexing="ij"), -1).reshape(-1, 2) / n
        positions = grid @ box[:2] + [0, 0, 10]
        # A surface in the box has vertices which are scaled one by one; here all particles are.
        mover = mover_of(tension=tension, rigid=False, frequency=2)
        context = tense(
            springs,
            of_box("1.5*(ax*by-56)^2"),
            mover,
            integrator=self.langevin(),
            positions=positions,
            box=box,
        )
        lengths = boxes(context, 2000, 100, discard=10000)
        # The bonds along a and b; a scaling multiplies their squares by that of the area.
        share = k / 2 * (box[0] @ box[0] + box[1] @ box[1]) / 56

        def weight(area):
            return np.log(area) + ((tension - share) * area - 1.5 * (area - 56) ** 2) / KT

        assert_distributed(lengths[:, 0] * lengths[:, 1], weight, 20, 70)


class TestEnergies:
    def test_of_other_groups_do_not_count(self):
        """As with OpenMM's barostats: only those that the integrator sees."""
        force = of_box("0.05*(ax*by-30)^2")
        force.setForceGroup(3)
        integrator = mm.VerletIntegrator(0.001)
        integrator.setIntegrationForceGroups({0, 1})
        context = tense(force, mover_of(tension=-1.0), integrator=integrator)
        lengths = boxes(context, 2000, 50)
        areas = lengths[:, 0] * lengths[:, 1]
        assert stats.kstest(areas, stats.gamma(COUNT + 1, scale=KT).cdf).pvalue > RARE

    def test_that_are_no_number_after_a_move_refuse_it(self):
        context = tense(of_box("sqrt(20-ax*by)"), mover_of(tension=5.0, adaptive=0))
        context.getIntegrator().step(200)
        assert box_of(context)[0, 0] * box_of(context)[1, 1] <= 20

    def test_that_are_no_number_from_the_start(self):
        context = tense(of_box("sqrt(19-ax*by)"), mover_of())
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloMembraneTension: .*not a number"):
            context.getIntegrator().step(1)


class TestParameters:
    def test_that_change_act(self):
        context = tense(of_box(), mover_of(tension=-1.0))
        boxes(context, 10, 10)
        for tension, temperature in ((-2.0, TEMPERATURE), (-1.0, 2 * TEMPERATURE)):
            context.setParameter(helfrich.MonteCarloMembraneTension.Tension(), tension)
            context.setParameter(helfrich.MonteCarloMembraneTension.Temperature(), temperature)
            lengths = boxes(context, 2000, 50)
            scale = KT * temperature / TEMPERATURE / -tension
            areas = lengths[:, 0] * lengths[:, 1]
            assert stats.kstest(areas, stats.gamma(COUNT + 1, scale=scale).cdf).pvalue > RARE

    def test_of_the_pulling_force(self):
        context = tense(of_box(), mover_of(axes="ZOnly", pullingForce=-2.0))
        context.setParameter(helfrich.MonteCarloMembraneTension.PullingForce(), -4.0)
        lengths = boxes(context, 2000, 50)[:, 2]
        assert stats.kstest(lengths, stats.gamma(COUNT + 1, scale=KT / 4).cdf).pvalue > RARE

    @pytest.mark.parametrize(
        ("name", "value", "words"),
        [
            ("MembraneTensionTemperature", 0.0, "above zero.*0"),
            ("MembraneTensionTemperature", float("nan"), "finite.*nan"),
            ("MembraneTension", float("inf"), "finite.*inf"),
        ],
    )
    def test_that_make_no_sense(self, name, value, words):
        context = tense(of_box(), mover_of())
        context.setParameter(name, value)
        with pytest.raises(
            mm.OpenMMException, match=rf"^MonteCarloMembraneTension: .*{name} .*{words}"
        ):
            context.getIntegrator().step(1)
        np.testing.assert_array_equal(box_of(context), BOX)

    def test_frequency(self):
        mover = mover_of(tension=-1.0, frequency=4)
        context = tense(of_box(), mover)
        context.getIntegrator().step(11)
        assert mover.getStatistics(context)["attempts"] == 2
        mover.setFrequency(0)
        mover.updateParametersInContext(context)
        context.getIntegrator().step(20)
        assert mover.getStatistics(context)["attempts"] == 2
        mover.setFrequency(1)
        mover.updateParametersInContext(context)
        context.getIntegrator().step(20)
        assert mover.getStatistics(context)["attempts"] == 22

    def test_the_width_is_adapted_at_first(self):
        mover = mover_of(tension=-1.0, adaptive=300)
        context = tense(of_box(), mover)
        assert mover.getStatistics(context)["width"] == 0
        context.getIntegrator().step(1)
        found = mover.getStatistics(context)
        assert found["width"] == pytest.approx(0.01 * 20)
        assert found["adapting"]
        context.getIntegrator().step(299)
        found = mover.getStatistics(context)
        assert found["width"] > 1
        assert not found["adapting"]
        context.getIntegrator().step(1000)
        assert mover.getStatistics(context)["width"] == found["width"]
        # Against a stiff energy it shrinks.
        stiff = mover_of(tension=-1.0, adaptive=300)
        context = tense(of_box("1e5*(ax*by-20)^2"), stiff)
        context.getIntegrator().step(1000)
        assert stiff.getStatistics(context)["width"] < 0.03
        assert 0.1 < stiff.getStatistics(context)["acceptance"] < 0.9


@pytest.mark.parametrize("target", [REFERENCE, CPU, *ON_OPENCL], ids=str)
def test_on_every_platform(target):
    """Free particles stay at the same fractions of the box, which is the same on all platforms."""
    mover = mover_of(tension=-1.0)
    context = tense(of_box(), mover, target=target)
    other = tense(of_box(), mover_of(tension=-1.0))
    fractions = positions_of(context) @ np.linalg.inv(BOX)
    for _ in range(10):
        for one in (context, other):
            one.getIntegrator().step(20)
        box = box_of(context)
        np.testing.assert_allclose(box, box_of(other), rtol=1e-6)
        np.testing.assert_allclose(positions_of(context) @ np.linalg.inv(box), fractions, atol=1e-5)
    assert abs(box[0, 0] - 5) > 0.01
    assert 0 < mover.getStatistics(context)["accepted"] < 200
