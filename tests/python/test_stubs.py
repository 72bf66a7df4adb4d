"""What is written from the force classes is current, and what their stubs promise is so."""

import ast
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
from openmmhelfrich import forces

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
STUB = ROOT / "python" / "openmmhelfrich" / "forces.pyi"

MESH = helfrich.Mesh.icosphere(2, 100.0)
OTHERS = {
    "MonteCarloBondFlip": lambda cls: cls(MESH, 300),
    "MonteCarloDomainSwap": lambda cls: cls(MESH, 300),
    "MonteCarloMembraneTension": lambda cls: cls(300),
    "SurfaceViscosityThermostat": lambda cls: cls(MESH, 1, 300),
    "VariableMassVerletIntegrator": lambda cls: cls(0.1),
    "VariableMassLangevinIntegrator": lambda cls: cls(300, 0.01, 0.1),
}
# What a type of the stubs means for a value.
MEANS = {
    "float": lambda value: type(value) is float,
    "int": lambda value: type(value) is int,
    "bool": lambda value: type(value) is bool,
    "str": lambda value: type(value) is str,
    "tuple[float, ...]": lambda value: (
        type(value) is tuple and all(type(one) is float for one in value)
    ),
    "NDArray[np.int64]": lambda value: value.dtype == np.int64,
    "NDArray[np.float64]": lambda value: value.dtype == np.float64,
    "NDArray[np.float64] | None": lambda value: value is None or value.dtype == np.float64,
}


def objects():
    """One of each kind of force and integrator."""
    for case in PRESENT:
        yield case.name, lambda case=case: case.make(meshes.membrane(case.place("octahedron")))
    for name, make in OTHERS.items():
        yield name, lambda name=name, make=make: make(getattr(helfrich, name))


MAKERS = dict(objects())


@pytest.fixture(scope="module")
def classes():
    tree = ast.parse(STUB.read_text(encoding="utf-8"))
    return {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}


def functions(classes, cls):
    """Those of a class and its bases in the stubs, by name."""
    found = {}
    for base in reversed(cls.__mro__):
        for node in getattr(classes.get(base.__name__), "body", ()):
            if isinstance(node, ast.FunctionDef):
                found[node.name] = node
    return found


def script(name):
    spec = spec_from_file_location(name, ROOT / ".ci" / f"{name}.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_file_is_current():
    assert STUB.read_text(encoding="utf-8") == script("stubs").stub(), "run make derived"


def test_the_lists_of_potentials_are_current():
    potentials = script("potentials")
    for path, text in potentials.texts().items():
        assert path.read_text(encoding="utf-8") == text, f"{path}: run make derived"
    assert len(potentials.forces()) == len(helfrich.MembraneForce.__subclasses__())


def test_all_classes_and_their_functions_are_there(classes):
    for name in forces.__all__:
        cls = getattr(forces, name)
        there = functions(classes, cls)
        for base in cls.__mro__:
            if base.__module__ == forces.__name__:
                public = {key for key, value in vars(base).items() if inspect.isroutine(value)}
                missing = {key for key in public if not key.startswith("_")} - set(there)
                assert not missing, (name, missing)


@pytest.mark.parametrize("name", MAKERS)
def test_getters_return_what_is_said(name, classes):
    made = MAKERS[name]()
    checked = 0
    for key, node in functions(classes, type(made)).items():
        if key.startswith("get") and len(node.args.args) + len(node.args.posonlyargs) == 1:
            if key == "getMasses":
                # It needs a Context.
                reference = openmm.Platform.getPlatformByName("Reference")
                context = openmm.Context(helfrich.Vesicle(MESH).system(), made, reference)
                context.setPositions(MESH.vertices)
            value = getattr(made, key)()
            assert MEANS[ast.unparse(node.returns)](value), (key, value)
            checked += 1
    assert checked >= 3


@pytest.mark.parametrize("name", MAKERS)
def test_constructors_take_what_is_said(name, classes):
    cls = type(MAKERS[name]())
    said = functions(classes, cls)["__init__"].args
    real = inspect.signature(cls.__init__)
    assert [word.arg for word in (*said.args, *said.kwonlyargs)] == list(real.parameters)
    defaults = [ast.literal_eval(value) for value in (*said.defaults, *said.kw_defaults)]
    assert defaults == [p.default for p in real.parameters.values() if p.default is not p.empty]


def test_the_stubs_are_installed():
    """The package's data has them, and the mark of a typed package."""
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    data = pyproject["tool"]["setuptools"]["package-data"]["openmmhelfrich"]
    for name in ("forces.pyi", "py.typed"):
        assert (STUB.parent / name).is_file()
        assert any(fnmatch(name, pattern) for pattern in data)


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
