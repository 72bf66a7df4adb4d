"""All movers as any OpenMM Force: arguments, what is refused, copies, XML."""

from __future__ import annotations

import copy
import pickle
from typing import NamedTuple

import openmm as mm
import pytest
from flowing import start
from openmm import unit
from openmmhelfrich import (
    MonteCarloBondFlip,
    MonteCarloDomainSwap,
    MonteCarloMembraneTension,
    SurfaceViscosityThermostat,
)


class Mover(NamedTuple):
    """One of the classes, and what its tests need to know."""

    cls: type
    #: Before the temperature.
    surface: tuple
    #: Arguments, none of which is the default.
    given: dict
    #: What setters alone set, likewise.
    further: dict
    defaults: dict
    #: Arguments, the error and words of its message.
    refused: list
    #: Setters and values.
    refused_by_setters: list
    #: What is replaced in the XML of the above, by what, and words of the message.
    wrong_xml: list
    #: Attributes of the XML of defaults that may be left out.
    optional_xml: list

    def make(self, **arguments):
        return self.cls(*self.surface, **arguments)

    def special(self):
        mover = self.make(**self.given)
        for name, value in self.further.items():
            getattr(mover, "set" + name)(value)
        return mover

    def values(self, mover) -> dict:
        found = {name: getattr(mover, "get" + getter(name))() for name in self.given}
        found |= {name: getattr(mover, "get" + name)() for name in self.further}
        if self.surface:
            triangles = range(mover.getNumTriangles())
            found["triangles"] = [tuple(mover.getTriangle(i)) for i in triangles]
        return found

    def wanted(self, values: dict) -> dict:
        if not self.surface:
            return values
        return values | {"triangles": [tuple(row) for row in start().triangles.tolist()]}

    def xml(self, mover) -> str:
        return mm.XmlSerializer.serialize(mover)

    def read(self, text: str):
        return self.cls.cast(mm.XmlSerializer.deserialize(text))


def getter(argument: str) -> str:
    name = argument[0].upper() + argument[1:]
    is_parameter = argument in ("temperature", "tension", "pullingForce")
    return "Default" + name if is_parameter else name


# Of all.
REFUSED = [
    ({"temperature": 0}, mm.OpenMMException, "temperature.*above zero"),
    ({"temperature": float("nan")}, mm.OpenMMException, "temperature.*nan"),
    ({"temperature": "hot"}, TypeError, "temperature.*hot"),
    ({"temperature": 3 * unit.nanometer}, TypeError, "temperature.*units of"),
    ({"frequency": -1}, mm.OpenMMException, "frequency.*-1"),
    ({"frequency": 2.5}, TypeError, "frequency.*2.5"),
    ({"frequency": True}, TypeError, "frequency.*True"),
    ({"frequency": 2**40}, ValueError, f"frequency.*{2**40}"),
    ({"colour": 1}, TypeError, "colour"),
]
REFUSED_BY_SETTERS = [("setDefaultTemperature", -1), ("setFrequency", -1)]
WRONG_XML = [
    ('frequency="7"', 'frequency="seven"', 'frequency="seven"'),
    ('frequency="7"', 'frequency="-7"', "frequency.*-7.*element"),
    ('version="1"', 'version="9"', "version 9"),
    ('randomSeed="-17"', 'colour="-17"', "colour"),
    ('temperature="310"', "", "temperature"),
]
WRONG_XML_OF_SURFACES = [
    *WRONG_XML,
    ('ensemble="Microcanonical"', 'ensemble="x"', 'ensemble="x".*Canonical or Microcanonical'),
    ("Triangles>", "Triangels>", "Triangels"),
    (' p1="', ' p4="', "p4"),
]

MOVERS = [
    Mover(
        MonteCarloBondFlip,
        (start(),),
        given={
            "temperature": 310.0,
            "frequency": 7,
            "attemptsPerEdge": 0.25,
            "minDegree": 4,
            "maxDegree": 9,
            "maxEdgeLength": 12.5,
        },
        further={
            "RandomNumberSeed": -17,
            "Ensemble": MonteCarloBondFlip.Microcanonical,
            "ForceGroup": 3,
            "Name": "flow",
        },
        defaults={
            "temperature": 300,
            "frequency": 10,
            "attemptsPerEdge": 0.1,
            "minDegree": 3,
            "maxDegree": 10,
            "maxEdgeLength": 0,
            "RandomNumberSeed": 0,
            "Ensemble": MonteCarloBondFlip.Canonical,
            "ForceGroup": 0,
            "Name": "MonteCarloBondFlip",
        },
        refused=[
            *REFUSED,
            ({"attemptsPerEdge": -0.1}, mm.OpenMMException, "attemptsPerEdge.*-0.1"),
            ({"attemptsPerEdge": float("inf")}, mm.OpenMMException, "attemptsPerEdge.*inf"),
            ({"minDegree": 2}, mm.OpenMMException, "minDegree.*2"),
            ({"maxDegree": 2}, mm.OpenMMException, "maxDegree.*2"),
            ({"minDegree": 8, "maxDegree": 7}, mm.OpenMMException, "maxDegree.*7 and 8"),
            ({"maxEdgeLength": -1}, mm.OpenMMException, "maxEdgeLength.*-1"),
            ({"maxEdgeLength": 1 * unit.kelvin}, TypeError, "maxEdgeLength.*nm"),
        ],
        refused_by_setters=[
            *REFUSED_BY_SETTERS,
            ("setAttemptsPerEdge", float("nan")),
            ("setMinDegree", 1),
            ("setMaxDegree", 1),
            ("setMaxEdgeLength", float("inf")),
            ("setEnsemble", 7),
        ],
        wrong_xml=WRONG_XML_OF_SURFACES,
        optional_xml=['frequency="10"', 'maxDegree="10"', 'ensemble="Canonical"'],
    ),
    Mover(
        MonteCarloDomainSwap,
        (start(),),
        given={"temperature": 310.0, "frequency": 7, "attemptsPerEdge": 0.25},
        further={
            "RandomNumberSeed": -17,
            "Ensemble": MonteCarloDomainSwap.Microcanonical,
            "ForceGroup": 3,
            "Name": "mixing",
        },
        defaults={
            "temperature": 300,
            "frequency": 10,
            "attemptsPerEdge": 0.1,
            "RandomNumberSeed": 0,
            "Ensemble": MonteCarloDomainSwap.Canonical,
            "ForceGroup": 0,
            "Name": "MonteCarloDomainSwap",
        },
        refused=[
            *REFUSED,
            ({"attemptsPerEdge": -0.1}, mm.OpenMMException, "attemptsPerEdge.*-0.1"),
            ({"attemptsPerEdge": 1001}, mm.OpenMMException, "attemptsPerEdge.*1001"),
            ({"minDegree": 3}, TypeError, "minDegree"),
        ],
        refused_by_setters=[
            *REFUSED_BY_SETTERS,
            ("setAttemptsPerEdge", float("nan")),
            ("setEnsemble", -1),
        ],
        wrong_xml=WRONG_XML_OF_SURFACES,
        optional_xml=['frequency="10"', 'attemptsPerEdge=".1"', 'ensemble="Canonical"'],
    ),
    Mover(
        MonteCarloMembraneTension,
        (),
        given={
            "temperature": 310.0,
            "tension": -0.5,
            "frequency": 7,
            "axes": MonteCarloMembraneTension.XYIndependent,
            "pullingForce": 2.5,
        },
        further={
            "ScaleMoleculesAsRigid": False,
            "AdaptiveMoves": 12,
            "RandomNumberSeed": -17,
            "ForceGroup": 3,
            "Name": "breath",
        },
        defaults={
            "temperature": 300,
            "tension": 0,
            "frequency": 25,
            "axes": MonteCarloMembraneTension.XYIsotropic,
            "pullingForce": 0,
            "ScaleMoleculesAsRigid": True,
            "AdaptiveMoves": 1000,
            "RandomNumberSeed": 0,
            "ForceGroup": 0,
            "Name": "MonteCarloMembraneTension",
        },
        refused=[
            *REFUSED,
            ({"tension": float("inf")}, mm.OpenMMException, "tension.*inf"),
            ({"tension": 3 * unit.nanometer}, TypeError, "tension.*units of"),
            ({"pullingForce": float("nan")}, mm.OpenMMException, "pullingForce.*nan"),
            ({"axes": 4}, mm.OpenMMException, "axes 4"),
            ({"axes": "XOnly"}, ValueError, "axes 'XOnly'.*XYIsotropic.*ZOnly"),
        ],
        refused_by_setters=[
            *REFUSED_BY_SETTERS,
            ("setDefaultTension", float("nan")),
            ("setDefaultPullingForce", float("inf")),
            ("setAxes", -1),
            ("setAdaptiveMoves", -1),
        ],
        wrong_xml=[
            *WRONG_XML,
            (
                'axes="XYIndependent"',
                'axes="x"',
                'axes="x".*XYIsotropic, XYIndependent, XYConstantArea or ZOnly',
            ),
        ],
        optional_xml=['frequency="25"', 'axes="XYIsotropic"', 'scaleMoleculesAsRigid="1"'],
    ),
    Mover(
        SurfaceViscosityThermostat,
        (start(), 20.0),
        given={"temperature": 310.0, "frequency": 7},
        further={
            "DefaultFriction": 12.5,
            "FrictionParameter": "of this one",
            "RandomNumberSeed": -17,
            "ForceGroup": 3,
            "Name": "honey",
        },
        defaults={
            "temperature": 300,
            "frequency": 1,
            "DefaultFriction": 20,
            "FrictionParameter": "SurfaceViscosityFriction",
            "RandomNumberSeed": 0,
            "ForceGroup": 0,
            "Name": "SurfaceViscosityThermostat",
        },
        refused=REFUSED,
        refused_by_setters=[
            *REFUSED_BY_SETTERS,
            ("setDefaultFriction", -1),
            ("setFrictionParameter", ""),
        ],
        wrong_xml=[
            *WRONG_XML,
            ('friction="12.5"', 'friction="thick"', 'friction="thick"'),
            ('friction="12.5"', 'friction="-1"', "friction.*-1.*element"),
            ('frictionParameter="of this one"', 'frictionParameter=""', "name of its own.*element"),
            ("Triangles>", "Triangels>", "Triangels"),
        ],
        optional_xml=['frequency="1"', 'frictionParameter="SurfaceViscosityFriction"'],
    ),
]


def rows(field: str) -> list:
    """Each mover with each row of one of its lists."""
    return [
        pytest.param(mover, *row, id=f"{mover.cls.__name__}-{row[0]}-{row[1]}")
        for mover in MOVERS
        for row in getattr(mover, field)
    ]


each_mover = pytest.mark.parametrize("mover", MOVERS, ids=lambda mover: mover.cls.__name__)


@each_mover
class TestArguments:
    def test_are_given_back(self, mover):
        assert mover.values(mover.special()) == mover.wanted(mover.given | mover.further)

    def test_defaults(self, mover):
        made = mover.make(temperature=300)
        assert mover.values(made) == mover.wanted(mover.defaults)
        assert not made.usesPeriodicBoundaryConditions()


class TestRefusals:
    @pytest.mark.parametrize(("mover", "arguments", "error", "words"), rows("refused"))
    def test_of_arguments(self, mover, arguments, error, words):
        begins = r"(: |\.__init__\(\) got an unexpected )"
        with pytest.raises(error, match=rf"^{mover.cls.__name__}{begins}.*{words}"):
            mover.make(**({"temperature": 300} | arguments))

    @pytest.mark.parametrize(("mover", "setter", "value"), rows("refused_by_setters"))
    def test_of_setters(self, mover, setter, value):
        made = mover.special()
        with pytest.raises(mm.OpenMMException, match=rf"^{mover.cls.__name__}: "):
            getattr(made, setter)(value)
        assert mover.values(made) == mover.wanted(mover.given | mover.further)

    @pytest.mark.parametrize(("mover", "old", "new", "words"), rows("wrong_xml"))
    def test_of_xml(self, mover, old, new, words):
        text = mover.xml(mover.special())
        assert old in text
        with pytest.raises(mm.OpenMMException, match=rf"{mover.cls.__name__}: .*{words}"):
            mover.read(text.replace(old, new))


@each_mover
class TestCopies:
    @pytest.mark.parametrize("way", ["copy", "deepcopy", "pickle", "XML"])
    def test_have_all_values(self, mover, way):
        duplicate = {
            "copy": copy.copy,
            "deepcopy": copy.deepcopy,
            "pickle": lambda made: pickle.loads(pickle.dumps(made)),
            "XML": lambda made: mover.read(mover.xml(made)),
        }[way]
        made = mover.special()
        other = duplicate(made)
        assert type(other) is mover.cls
        made.setFrequency(1)
        assert mover.values(other) == mover.wanted(mover.given | mover.further)

    def test_xml_without_what_has_a_default(self, mover):
        made = mover.make(temperature=300)
        text = mover.xml(made)
        for attribute in mover.optional_xml:
            assert attribute in text
            text = text.replace(attribute, "")
        assert mover.values(mover.read(text)) == mover.values(made)
