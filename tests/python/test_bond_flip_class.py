"""The class MonteCarloBondFlip as any OpenMM Force: arguments, units, XML, copies, C."""

from __future__ import annotations

import copy
import ctypes
import inspect
import pickle

import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from flowing import TEMPERATURE, bits, flowing, start
from openmm import unit
from openmmhelfrich import _core

GIVEN = {
    "temperature": 310.0,
    "frequency": 7,
    "attemptsPerEdge": 0.25,
    "minDegree": 4,
    "maxDegree": 9,
    "maxEdgeLength": 12.5,
}


def special() -> helfrich.MonteCarloBondFlip:
    mover = helfrich.MonteCarloBondFlip(start(), **GIVEN)
    mover.setRandomNumberSeed(-17)
    mover.setEnsemble(mover.Microcanonical)
    mover.setForceGroup(3)
    mover.setName("flow")
    return mover


def values(mover) -> tuple:
    return (
        mover.getDefaultTemperature(),
        mover.getFrequency(),
        mover.getAttemptsPerEdge(),
        mover.getMinDegree(),
        mover.getMaxDegree(),
        mover.getMaxEdgeLength(),
        mover.getRandomNumberSeed(),
        mover.getEnsemble(),
        mover.getForceGroup(),
        mover.getName(),
        [tuple(mover.getTriangle(i)) for i in range(mover.getNumTriangles())],
    )


WANTED = (
    *GIVEN.values(),
    -17,
    helfrich.MonteCarloBondFlip.Microcanonical,
    3,
    "flow",
    [tuple(row) for row in start().triangles.tolist()],
)


class TestArguments:
    def test_are_given_back(self):
        assert values(special()) == WANTED

    def test_defaults(self):
        mover = helfrich.MonteCarloBondFlip(start(), 300)
        assert values(mover)[:10] == (
            *(300, 10, 0.1, 3, 10, 0, 0),
            *(mover.Canonical, 0, "MonteCarloBondFlip"),
        )
        assert mover.Temperature() == "BondFlipTemperature"
        assert mover.getConnectivityParameter() == "BondFlipConnectivity0"
        assert not mover.usesPeriodicBoundaryConditions()

    def test_signature(self):
        text = str(inspect.signature(helfrich.MonteCarloBondFlip))
        assert text == (
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

    @pytest.mark.parametrize(
        ("arguments", "error", "words"),
        [
            ({"temperature": 0}, mm.OpenMMException, "temperature.*above zero"),
            ({"temperature": float("nan")}, mm.OpenMMException, "temperature.*nan"),
            ({"temperature": "hot"}, TypeError, "temperature.*hot"),
            ({"temperature": 3 * unit.nanometer}, TypeError, "temperature.*units of"),
            ({"frequency": -1}, mm.OpenMMException, "frequency.*-1"),
            ({"frequency": 2.5}, TypeError, "frequency.*2.5"),
            ({"frequency": True}, TypeError, "frequency.*True"),
            ({"frequency": 2**40}, ValueError, f"frequency.*{2**40}"),
            ({"attemptsPerEdge": -0.1}, mm.OpenMMException, "attemptsPerEdge.*-0.1"),
            ({"attemptsPerEdge": float("inf")}, mm.OpenMMException, "attemptsPerEdge.*inf"),
            ({"minDegree": 2}, mm.OpenMMException, "minDegree.*2"),
            ({"maxDegree": 2}, mm.OpenMMException, "maxDegree.*2"),
            ({"minDegree": 8, "maxDegree": 7}, mm.OpenMMException, "maxDegree.*7 and 8"),
            ({"maxEdgeLength": -1}, mm.OpenMMException, "maxEdgeLength.*-1"),
            ({"maxEdgeLength": 1 * unit.kelvin}, TypeError, "maxEdgeLength.*nm"),
            ({"colour": 1}, TypeError, "colour"),
        ],
        ids=lambda value: str(value),
    )
    def test_that_make_no_sense(self, arguments, error, words):
        with pytest.raises(error, match=rf"^MonteCarloBondFlip: .*{words}"):
            helfrich.MonteCarloBondFlip(start(), **({"temperature": 300} | arguments))

    def test_setters_refuse_the_same(self):
        mover = special()
        for setter, value in (
            ("setDefaultTemperature", -1),
            ("setFrequency", -1),
            ("setAttemptsPerEdge", float("nan")),
            ("setMinDegree", 1),
            ("setMaxDegree", 1),
            ("setMaxEdgeLength", float("inf")),
            ("setEnsemble", 7),
        ):
            with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: "):
                getattr(mover, setter)(value)
        assert values(mover) == WANTED

    def test_ensembles_by_name(self):
        mover = special()
        mover.setEnsemble("Canonical")
        assert mover.getEnsemble() == mover.Canonical
        with pytest.raises(ValueError, match=r"MonteCarloBondFlip: .*Grand.*Microcanonical"):
            mover.setEnsemble("Grand")

    def test_triangles_one_by_one(self):
        mover = helfrich.MonteCarloBondFlip([], 300)
        for number, corners in enumerate(start().triangles.tolist()):
            assert mover.addTriangle(*corners) == number
        assert values(mover)[-1] == WANTED[-1]
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: .*180"):
            mover.getTriangle(180)


class TestCopies:
    @pytest.mark.parametrize(
        "duplicate",
        [
            copy.copy,
            copy.deepcopy,
            lambda mover: pickle.loads(pickle.dumps(mover)),
            lambda mover: helfrich.MonteCarloBondFlip.cast(
                mm.XmlSerializer.deserialize(mm.XmlSerializer.serialize(mover))
            ),
        ],
        ids=["copy", "deepcopy", "pickle", "XML"],
    )
    def test_have_all_values(self, duplicate):
        mover = special()
        other = duplicate(mover)
        assert type(other) is helfrich.MonteCarloBondFlip
        mover.setFrequency(1)
        assert values(other) == WANTED

    def test_of_a_system_go_on_alike(self):
        context, _ = flowing(integrator=mm.VerletIntegrator(0.2))
        text = mm.XmlSerializer.serialize(context.getSystem())
        system = mm.XmlSerializer.deserialize(text)
        other = mm.Context(system, mm.VerletIntegrator(0.2), context.getPlatform())
        other.setPositions(start().vertices)
        for one in (context, other):
            one.getIntegrator().step(20)
        assert bits(context) == bits(other)
        assert bits(context)[2] != start().triangles.tobytes()

    def test_are_told_from_others(self):
        context, mover = flowing()
        plain = [context.getSystem().getForce(i) for i in range(6)]
        told = [helfrich.MonteCarloBondFlip.isinstance(force) for force in plain]
        assert told == [False] * 5 + [True]
        assert not helfrich.BendingForce.isinstance(plain[5])
        found = helfrich.MonteCarloBondFlip.cast(plain[5])
        assert found.getDefaultTemperature() == TEMPERATURE
        context.getIntegrator().step(4)
        assert found.getStatistics(context) == mover.getStatistics(context)
        with pytest.raises(mm.OpenMMException, match=r"^MonteCarloBondFlip: cannot cast"):
            helfrich.MonteCarloBondFlip.cast(plain[0])

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ('frequency="7"', 'frequency="seven"', 'frequency="seven"'),
            ('frequency="7"', 'frequency="-7"', "frequency.*-7.*element"),
            ('version="1"', 'version="9"', "version 9"),
            ('ensemble="Microcanonical"', 'ensemble="x"', 'ensemble="x"'),
            ('maxDegree="9"', 'colour="9"', "colour"),
            ("<Triangles>", "<Triangels>", "Triangels"),
            (' p1="', ' p4="', "p4"),
            ('temperature="310"', "", "temperature"),
        ],
    )
    def test_xml_that_is_wrong(self, old, new, words):
        text = mm.XmlSerializer.serialize(special())
        assert old in text
        broken = text.replace(old, new).replace("</Triangles>", old.replace("<", "</"), 0)
        if new.startswith("<"):
            broken = broken.replace("</Triangles>", "</Triangels>")
        with pytest.raises(
            (mm.OpenMMException, ValueError), match=rf"MonteCarloBondFlip: .*{words}"
        ):
            mm.XmlSerializer.deserialize(broken)

    def test_xml_without_what_has_a_default(self):
        text = mm.XmlSerializer.serialize(helfrich.MonteCarloBondFlip(start(), 300))
        for attribute in ('frequency="10"', 'maxDegree="10"', 'ensemble="Canonical"'):
            assert attribute in text
            text = text.replace(attribute, "")
        mover = helfrich.MonteCarloBondFlip.cast(mm.XmlSerializer.deserialize(text))
        assert (mover.getFrequency(), mover.getMaxDegree()) == (10, 10)


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
