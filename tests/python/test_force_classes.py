"""What is written from the C++ headers is current, and what the force classes promise is so."""

import inspect
import sys
from fnmatch import fnmatch
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import meshes
import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from cases import PRESENT
from openmmhelfrich import _forces, forces

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "openmmhelfrich"

MESH = helfrich.Mesh.icosphere(2, 100.0)
OTHERS = {
    "MonteCarloBondFlip": lambda cls: cls(MESH, 300),
    "MonteCarloDomainSwap": lambda cls: cls(MESH, 300),
    "MonteCarloMembraneTension": lambda cls: cls(300),
    "SurfaceViscosityThermostat": lambda cls: cls(MESH, 1, 300),
    "VariableMassVerletIntegrator": lambda cls: cls(0.1),
    "VariableMassLangevinIntegrator": lambda cls: cls(300, 0.01, 0.1),
}
# What an annotation means for a value.
MEANS = {
    "float": lambda value: type(value) is float,
    "int": lambda value: type(value) is int,
    "bool": lambda value: type(value) is bool,
    "str": lambda value: type(value) is str,
    "tuple[float, ...]": lambda value: (
        type(value) is tuple and all(type(one) is float for one in value)
    ),
    "Integers": lambda value: value.dtype == np.int64,
    "Doubles": lambda value: value.dtype == np.float64,
    "Doubles | None": lambda value: value is None or value.dtype == np.float64,
}


def objects():
    """One of each kind of force and integrator."""
    for case in PRESENT:
        yield case.name, lambda case=case: case.make(meshes.membrane(case.place("octahedron")))
    for name, make in OTHERS.items():
        yield name, lambda name=name, make=make: make(getattr(helfrich, name))


MAKERS = dict(objects())


def script(name):
    spec = spec_from_file_location(name, ROOT / ".ci" / f"{name}.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_files_are_current():
    texts = script("forces").texts()
    assert set(texts) == set((PACKAGE / "forces").glob("*.py")), "run make derived"
    for path, text in texts.items():
        assert path.read_text(encoding="utf-8") == text, f"{path}: run make derived"


def test_the_lists_of_potentials_are_current():
    potentials = script("potentials")
    for path, text in potentials.texts().items():
        assert path.read_text(encoding="utf-8") == text, f"{path}: run make derived"
    assert len(potentials.forces()) == len(helfrich.MembraneForce.__subclasses__())


def functions(cls):
    """The public functions of a class that this package has, by name."""
    return {
        name: getattr(cls, name)
        for base in cls.__mro__
        if base.__module__.startswith("openmmhelfrich.")
        for name, member in vars(base).items()
        if not name.startswith("_") and (inspect.isfunction(member) or type(member) is staticmethod)
    }


@pytest.mark.parametrize("name", forces.__all__)
def test_all_functions_say_what_they_take_and_give(name):
    found = functions(getattr(forces, name))
    assert len(found) > 5
    for key, function in found.items():
        assert function.__doc__, key
        signature = inspect.signature(function)
        assert signature.return_annotation is not signature.empty, key
        for parameter in list(signature.parameters.values())[key not in ("isinstance", "cast") :]:
            assert parameter.annotation is not parameter.empty, (key, parameter)


def test_no_function_of_the_headers_is_missing():
    """What SWIG makes is called by some class."""
    files = [*(PACKAGE / "forces").glob("*.py"), *PACKAGE.glob("_*s.py")]
    text = "".join(path.read_text(encoding="utf-8") for path in files)
    made = {
        name
        for name in vars(_forces)
        if name.partition("_")[0] in forces.__all__ and not name.endswith(("_swiginit", "register"))
    }
    constants = {name for name in made if type(getattr(_forces, name)) is int}
    missing = {name for name in made - constants if f"_forces.{name}(" not in text}
    assert not missing
    for name in constants:
        cls, _, constant = name.partition("_")
        assert getattr(getattr(forces, cls), constant) == getattr(_forces, name)
    assert len(made) > 200 and len(constants) > 20


@pytest.mark.parametrize("name", MAKERS)
def test_getters_return_what_is_said(name):
    made = MAKERS[name]()
    checked = 0
    for key, function in functions(type(made)).items():
        signature = inspect.signature(function)
        if key.startswith("get") and list(signature.parameters) == ["self"]:
            if key == "getMasses":
                # It needs a Context.
                reference = openmm.Platform.getPlatformByName("Reference")
                context = openmm.Context(helfrich.Vesicle(MESH).system(), made, reference)
                context.setPositions(MESH.vertices)
            value = getattr(made, key)()
            assert MEANS[signature.return_annotation](value), (key, value)
            checked += 1
    assert checked >= 3


def test_arguments_are_those_of_the_class():
    """What a user's subclass refuses names the class of the package."""

    class Stiff(helfrich.BendingForce):
        def __init__(self, mesh):
            super().__init__(mesh, 100.0, scheme="GompperKroll")

    force = Stiff(MESH)
    assert force.getRigidity() == 100.0
    assert force.getScheme() == helfrich.BendingForce.GompperKroll
    with pytest.raises(TypeError, match=r"^BendingForce: rigidity must be a number, got 'much'"):
        force.setRigidity("much")
    with pytest.raises(TypeError, match=r"BendingForce.__init__.. missing .* 'rigidity'"):
        helfrich.BendingForce(MESH)


def test_classes_without_a_constructor():
    for name in ("MembraneForce", "TriangulatedForce"):
        with pytest.raises(AttributeError, match="No constructor"):
            getattr(helfrich, name)()


def test_types_are_marked():
    """The package's data has the mark of a typed package."""
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    data = pyproject["tool"]["setuptools"]["package-data"]["openmmhelfrich"]
    assert (PACKAGE / "py.typed").is_file()
    assert any(fnmatch("py.typed", pattern) for pattern in data)


@pytest.mark.parametrize("name", ["TriangleAreaForce", "SkalakForce", "LineTensionForce"])
def test_a_force_without_example_and_figure_gets_plain_ones(name, monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    from _site import examples, figures

    monkeypatch.delitem(examples._LINES, name)
    monkeypatch.delitem(figures._FIGURES, name)
    left, printed = examples.run(name)
    assert type(left["force"]).__name__ == name
    assert np.isfinite(float(printed.split()[0]))
    figures.draw(name, tmp_path / "figure.svg")
    assert b"scale of the mesh" in (tmp_path / "figure.svg").read_bytes()
