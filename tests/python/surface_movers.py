"""What must hold for every mover of surfaces; tests of each have classes that derive from these."""

from __future__ import annotations

from abc import ABC, abstractmethod

import openmm as mm
import pytest
from flowing import measure
from platforms import CPU, HELFRICH, NATIVE, ON_OPENCL, REFERENCE, Target

ELSEWHERE = [REFERENCE, CPU, ON_OPENCL[2], NATIVE[2]]


def step(context: mm.Context, count: int) -> mm.Context:
    context.getIntegrator().step(count)
    return context


class ForeignStates(ABC):
    """Where what a mover moves is not saved, that is noticed."""

    #: What the message says.
    foreign: str

    @abstractmethod
    def made(self, target):
        """A Context at the start, and its mover."""

    @abstractmethod
    def moved(self, context, mover):
        """What the mover has come to."""

    @abstractmethod
    def put(self, context, mover, moved):
        """Go on from there."""

    @pytest.mark.parametrize("target", ELSEWHERE, ids=str)
    @pytest.mark.parametrize("evaluate", [True, False])
    def test_checkpoints_of_other_platforms(self, target, evaluate):
        context, mover = self.made(target)
        checkpoint = step(context, 10).createCheckpoint()
        moved = self.moved(context, mover)
        energy = measure(context)[0]
        # As long as nothing has moved it is the right one.
        context.loadCheckpoint(checkpoint)
        assert measure(context)[0] == pytest.approx(energy, rel=1e-9)
        step(context, 10)
        context.loadCheckpoint(checkpoint)
        with pytest.raises(mm.OpenMMException, match=self.foreign):
            measure(context) if evaluate else step(context, 1)
        # What the message says helps.
        self.put(context, mover, moved)
        assert measure(context)[0] == pytest.approx(energy, rel=1e-9)
        step(context, 4)

    @pytest.mark.parametrize("target", [HELFRICH, *ELSEWHERE], ids=str)
    def test_states(self, target):
        context, _ = self.made(target)
        early = context.getState(getPositions=True, getVelocities=True, getParameters=True)
        late = step(context, 10).getState(
            getPositions=True, getVelocities=True, getParameters=True, getEnergy=True
        )
        context.setState(late)
        measure(context)
        context.setState(early)
        with pytest.raises(mm.OpenMMException, match=self.foreign):
            step(context, 1)
        context, _ = self.made(target)
        context.setState(late)
        with pytest.raises(mm.OpenMMException, match=self.foreign):
            measure(context)
        context, _ = self.made(target)
        context.setState(early)
        step(context, 1)


class SameBits(ABC):
    """Of the same seed, on any number of threads."""

    @abstractmethod
    def made(self, target, integrator, seed):
        """A Context at the start."""

    @abstractmethod
    def bits(self, context):
        """All of a Context, and what has been moved."""

    @pytest.mark.parametrize("platform", ["Reference", "Helfrich"])
    def test_of_the_same_seed(self, platform):
        found = []
        for threads, seed in (("1", 7), ("1", 7), ("2", 7), ("1", 8)):
            properties = {"Threads": threads} if platform == "Helfrich" else {}
            target = Target(platform, platform, 1e-9, properties)
            # Reference draws random numbers of all Contexts from one stream.
            context = self.made(target, mm.VerletIntegrator(0.2), seed)
            found.append(self.bits(step(context, 40)))
        assert found[0] == found[1] == found[2]
        assert found[0][1] != found[3][1]

    def test_seed_zero_is_another_each_time(self):
        contexts = [self.made(REFERENCE, mm.VerletIntegrator(0.2), 0) for _ in range(2)]
        one, other = [self.bits(step(context, 20))[1] for context in contexts]
        assert one != other
