"""The class MonteCarloBondFlip as any OpenMM Force: arguments, units, XML, copies, C."""

from __future__ import annotations

import ctypes

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import TEMPERATURE, arguments_of, bits, flowing, start
from openmm import unit
from openmmhelfrich import _core


class TestArguments:
    def test_names_of_parameters(self):
        mover = helfrich.MonteCarloBondFlip(start(), 300)
        assert mover.Temperature() == "BondFlipTemperature"
        assert mover.getConnectivityParameter() == "BondFlipConnectivity0"

    def test_signature(self):
        assert arguments_of(helfrich.MonteCarloBondFlip) == (
            "(triangles, temperature, frequency=10, attemptsPerEdge=0.1, minDegree=3, "
            "maxDegree=10, maxEdgeLength=0.0, *, offset=0)"
        )
        assert "K" in helfrich.MonteCarloBondFlip.setDefaultTemperature.__doc__

    def test_with_units(self):
        mover = helfrich.MonteCarloBondFlip(
            start(), 300 * unit.kelvin, maxEdgeLength=25 * unit.angstrom
        )
        assert mover.getMaxEdgeLength() == pytest.approx(2.5)
        assert mover.getDefaultTemperature() == pytest.approx(300)
        mover.setDefaultTemperature(310 * unit.kelvin)
        mover.setMaxEdgeLength(1 * unit.micrometer)
        assert mover.getDefaultTemperature() == 310
        assert mover.getMaxEdgeLength() == pytest.approx(1000)

    def test_ensembles_by_name(self):
        mover = helfrich.MonteCarloBondFlip(start(), 300)
        mover.setEnsemble("Microcanonical")
        assert mover.getEnsemble() == mover.Microcanonical
        with pytest.raises(ValueError, match=r"MonteCarloBondFlip: .*Grand.*Microcanonical"):
            mover.setEnsemble("Grand")

    def test_triangles_one_by_one(self):
        mover = helfrich.MonteCarloBondFlip([], 300)
        corners = start().triangles.tolist()
        for number, triangle in enumerate(corners):
            assert mover.addTriangle(*triangle) == number
        assert [mover.getTriangle(number) for number in range(len(corners))] == corners
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*180"):
            mover.getTriangle(180)


class TestInASystem:
    def test_copies_go_on_alike(self):
        context, _ = flowing(integrator=mm.VerletIntegrator(0.2))
        text = mm.XmlSerializer.serialize(context.getSystem())
        system = mm.XmlSerializer.deserialize(text)
        other = mm.Context(system, mm.VerletIntegrator(0.2), context.getPlatform())
        other.setPositions(start().vertices)
        for one in (context, other):
            one.getIntegrator().step(20)
        assert bits(context) == bits(other)
        assert bits(context)[2] != start().triangles.tobytes()

    def test_is_told_from_others(self):
        context, mover = flowing()
        system = context.getSystem()
        plain = [system.getForce(i) for i in range(system.getNumForces())]
        told = [helfrich.MonteCarloBondFlip.isinstance(force) for force in plain]
        assert told == [False] * (len(told) - 1) + [True]
        assert not helfrich.BendingForce.isinstance(plain[-1])
        found = helfrich.MonteCarloBondFlip.cast(plain[-1])
        assert found.getDefaultTemperature() == TEMPERATURE
        context.getIntegrator().step(4)
        assert found.getStatistics(context) == mover.getStatistics(context)
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: cannot cast"):
            helfrich.MonteCarloBondFlip.cast(plain[0])


class TestC:
    """The C functions, on forces and Contexts that Python holds."""

    def library(self):
        library = _core.library()
        library.Helfrich_MonteCarloBondFlip_create.restype = ctypes.c_void_p
        library.Helfrich_MonteCarloBondFlip_getMaxEdgeLength.restype = ctypes.c_double
        return library

    def test_create_get_set(self):
        library = self.library()
        corners = np.ascontiguousarray(start().triangles, dtype=np.intc)
        force = ctypes.c_void_p(
            library.Helfrich_MonteCarloBondFlip_create(
                corners.ctypes.data_as(ctypes.c_void_p),
                len(corners),
                ctypes.c_double(300),
                5,
                ctypes.c_double(0.1),
                3,
                10,
                ctypes.c_double(12.5),
            )
        )
        assert force.value
        assert library.Helfrich_MonteCarloBondFlip_getFrequency(force) == 5
        assert library.Helfrich_MonteCarloBondFlip_getMaxEdgeLength(force) == 12.5
        assert library.Helfrich_MonteCarloBondFlip_setFrequency(force, 6) == 0
        assert library.Helfrich_MonteCarloBondFlip_getFrequency(force) == 6
        assert library.Helfrich_MonteCarloBondFlip_setMinDegree(force, 1) == 1
        assert _core.last_error() == "MonteCarloBondFlip: minDegree must be 3 or more, got 1"
        assert library.Helfrich_MembraneForce_getNumTriangles(force) == len(corners)
        # The mover has no scalars of a potential.
        value = ctypes.c_double()
        status = library.Helfrich_MembraneForce_getParameterValue(
            force, b"rigidity", ctypes.byref(value)
        )
        assert status == 1
        library.Helfrich_MembraneForce_destroy(force)

    def test_refused_arguments_make_none(self):
        library = self.library()
        force = library.Helfrich_MonteCarloBondFlip_create(
            None, 0, ctypes.c_double(-1), 5, ctypes.c_double(0.1), 3, 10, ctypes.c_double(0)
        )
        assert force is None
        assert "temperature" in _core.last_error()

    def test_in_a_context(self):
        library = self.library()
        context, mover = flowing()
        context.getIntegrator().step(10)
        force, there = (ctypes.c_void_p(int(one.this)) for one in (mover, context))
        value = ctypes.c_double()
        get = library.Helfrich_MonteCarloBondFlip_getStatistic
        assert get(force, there, b"attempts", ctypes.byref(value)) == 0
        assert value.value == mover.getStatistics(context)["attempts"] == 405
        assert get(force, there, b"luck", ctypes.byref(value)) == 1
        assert "luck" in _core.last_error()
        corners = np.zeros((180, 3), dtype=np.intc)
        pointer = corners.ctypes.data_as(ctypes.c_void_p)
        assert library.Helfrich_MembraneForce_getTrianglesInContext(force, there, pointer) == 0
        np.testing.assert_array_equal(corners, mover.getTrianglesInContext(context))
        corners[:] = start().triangles
        set_ = library.Helfrich_MembraneForce_setTrianglesInContext
        assert set_(force, there, pointer, 180) == 0
        np.testing.assert_array_equal(mover.getTrianglesInContext(context), start().triangles)
        assert set_(force, there, pointer, 179) == 1
