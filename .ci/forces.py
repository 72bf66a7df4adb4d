"""Write python/openmmhelfrich/forces/, the classes of forces, movers and integrators for Python.

    .venv/bin/python .ci/forces.py (or make derived)

They are made of the C++ headers: their functions with types, units and what is said of them. SWIG
makes the functions that they call, from the same headers. What has to do with arrays is written by
hand, in the classes of `MIXED_IN`.
"""

from __future__ import annotations

import re
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))
from _site import headers  # noqa: E402

FOLDER = ROOT / "python" / "openmmhelfrich" / "forces"
#: The base of all forces, which is no class for users.
BASE = headers.HEADERS / "internal" / "HelfrichForce.h"
WIDTH = 100

INIT = '''\
"""The classes of forces, movers, thermostats and integrators, a file for each.

.ci/forces.py writes them from the headers of C++.
"""
'''
HEAD = '''\
"""{name}; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._movers import Flips, Masses, Swaps, Tension, Viscosity
from .._proxies import constant, elements, make, make_on, number, own, proxy, start, whole
from .._surfaces import Domains, Particles, Reference, Triangulated
from .._types import Scalar, Values
{base}
if TYPE_CHECKING:
    from ..mesh import Mesh
'''

#: Classes by the names they have in Python, where these are others than in C++. A template is one
#: class for each base.
NAMES = {
    "HelfrichForce": "_HelfrichForce",
    "MonteCarloMover<TriangulatedForce>": "_TriangulatedMover",
    "MonteCarloMover<HelfrichForce>": "_Mover",
    "MonteCarloSurfaceMover": "_SurfaceMover",
}
#: What is written by hand, by class.
MIXED_IN = {
    "TriangulatedForce": "Triangulated",
    "MonteCarloBondFlip": "Flips",
    "MonteCarloDomainSwap": "Swaps",
    "MonteCarloMembraneTension": "Tension",
    "SurfaceViscosityThermostat": "Viscosity",
    "VariableMassIntegrator": "Masses",
    "ParticleSurfaceForce": "Particles",
}
#: Functions that a class of `MIXED_IN` has in place of those of C++, beside what SWIG ignores.
BY_HAND = {"addTriangle"}

TYPES = {"bool": "bool", "int": "int", "std::string": "str", "OpenMM::Context": "openmm.Context"}
#: What constructors and setters take, and how they read it.
TAKEN = {
    "double": ("Scalar", "number"),
    "int": ("int", "whole"),
    "std::vector<double>": ("Values", "elements"),
}
GIVEN = TYPES | {
    "double": "float",
    "unsigned int": "int",
    "void": "None",
    "std::vector<double>": "tuple[float, ...]",
}
SETTER_OF_ELEMENTS = re.compile(r"set(?:(?:Vertex|Particle|Edge)(\w+)|Triangle(\w+)s)$")


def plain(kind: str) -> str:
    """A C++ type without const and references."""
    return re.sub(r"\b(const|static|explicit)\b|&", "", kind).strip()


def ignored() -> set[tuple[str, str]]:
    """What SWIG makes nothing of: class or "*", and function."""
    text = (ROOT / "python" / "forces.i").read_text(encoding="utf-8")
    found = re.findall(r"^%ignore (?:HelfrichPlugin::)?(\w+|\*)::(\w+);", text, re.MULTILINE)
    renamed = re.findall(r"^%rename\(_\w+\) HelfrichPlugin::(\w+)::(\w+);", text, re.MULTILINE)
    return {*found, *renamed}


IGNORED = ignored()


class Function:
    """A function of a C++ class."""

    def __init__(self, member: headers.Member):
        match = re.fullmatch(r"(.*?)(\w+)\((.*)\)(?: const)?", member.declaration)
        self.name = match[2]
        self.is_static = match[1].startswith("static ")
        self.given = plain(match[1])
        self.text = member.text
        #: By name the type and the default, or None.
        self.arguments: dict[str, tuple[str, str | None]] = {}
        #: What C++ writes into.
        self.outputs: list[str] = []
        for argument in filter(None, map(str.strip, re.split(r",(?![^<(]*[>)])", match[3]))):
            declared, _, default = (part.strip() for part in argument.partition("="))
            kind, _, name = declared.rpartition(" ")
            name = name.lstrip("&")
            if kind.startswith("int&"):
                self.outputs.append(name)
            else:
                self.arguments[name] = plain(kind), default or None


class Writer:
    """A class, line by line."""

    def __init__(self, known: headers.Class, name: str, base: str):
        self.known, self.cpp, self.name, self.base = known, known.name, name, base
        self.constants = {
            value.declaration.partition(" = ")[0]: value.declaration.partition(" = ")[2]
            for member in known.members
            for value in member.values
        }
        self.functions = [
            Function(member)
            for member in known.members
            if not member.is_enumeration and member.name != known.name
        ]
        self.elements = {
            lower(match[1] or match[2])
            for function in self.functions
            if (match := SETTER_OF_ELEMENTS.match(function.name))
            and "std::vector<double>" in [kind for kind, _ in function.arguments.values()]
        }

    def lines(self) -> list[str]:
        """The whole class."""
        bases = [self.base]
        constructor = self.known.constructor and Function(self.known.constructor)
        arguments = constructor.arguments if constructor else {}
        for word, mixed_in in (("domains", "Domains"), ("reference", "Reference")):
            if word in arguments:
                bases.insert(0, mixed_in)
        if self.cpp in MIXED_IN:
            bases.insert(0, MIXED_IN[self.cpp])
        lines = ["@proxy", f"class {self.name}({', '.join(bases)}):", *docstring(self.known.text)]
        lines += self.enumerations()
        if constructor:
            lines += self.constructor(constructor)
        for function in self.functions:
            where = {(self.cpp, function.name), ("*", function.name)}
            if not where & IGNORED and function.name not in BY_HAND:
                lines += self.function(function)
        if constructor:
            lines += self.casts()
        return lines

    def enumerations(self) -> list[str]:
        """The constants."""
        lines = []
        for member in self.known.members:
            for value in member.values:
                lines += ["", f"    {value.declaration}", *docstring(value.text)]
        return lines

    def argument(self, name: str, kind: str, default: str | None) -> tuple[str, str]:
        """An argument of a constructor with its type and default, and what the text says it is."""
        if kind == "std::vector<int>" and name == "triangles":
            text, what = "Mesh | ArrayLike", "Mesh or array_like of int, shape (num_triangles, 3)"
        elif kind == "std::vector<int>":
            text, what = "ArrayLike", "array_like of int"
        elif name == "reference":
            text, what = "Mesh | Values", "Mesh, array_like or Quantity, shape (num_vertices, 3)"
        elif kind == "double" and name in self.elements:
            text, what = "Scalar | ArrayLike", "float or Quantity, or one for each element"
        elif kind == "double":
            text, what = "Scalar", "float or Quantity"
        elif kind == "int":
            text, what = "int", "int"
        else:
            text, what = "int | str", "int or str, a constant of the class or its name"
        if default is None:
            return f"{name}: {text}", what
        default = default_of(kind, default, self.constants)
        return f"{name}: {text} = {default}", f"{what}, default: {default}"

    def constructor(self, made: Function) -> list[str]:
        """What makes an object."""
        shown, documented = ["self"], ["Parameters", "----------"]
        words = headers.parameters(made.text)
        for name, (kind, default) in made.arguments.items():
            text, what = self.argument(name, kind, default)
            shown.append(text)
            documented += [f"{name} : {what}", *indented(sentence(words[name]))]
        is_on_triangles = "triangles" in made.arguments
        if is_on_triangles:
            shown += ["*", "offset: int = 0"]
            documented += ["offset : int", "    Added to all indices of the triangles."]
        lines = ["", *signature("__init__", shown, "None")]
        what = "integrator" if "Integrator" in self.base else "force"
        lines += docstring(f"Make the {what}.\n\n" + "\n".join(documented), 8)
        given = [name for name in made.arguments if name != "triangles"]
        if self.base == "MembraneForce":
            passed = ["triangles", "offset", *(f"{name}={name}" for name in given)]
            return [*lines, f"        start(self, {', '.join(passed)})"]
        read = [self.read(name, made.arguments[name][0]) for name in given]
        passed = ["triangles", "offset", *read] if is_on_triangles else read
        function = "make_on" if is_on_triangles else "make"
        return [*lines, f"        {function}(self, {', '.join(passed)})"]

    def read(self, name: str, kind: str) -> str:
        """An argument as C++ takes it."""
        if kind in TAKEN:
            return f'{TAKEN[kind][1]}(self, "{name}", {name})'
        if re.fullmatch("[A-Z][a-z]+", kind):
            return f'constant(self, "{lower(kind)}", {name})'
        return name

    def function(self, function: Function) -> list[str]:
        """One function, which calls that of SWIG."""
        is_setter = function.name.startswith("set") and len(function.arguments) == 1
        shown, passed, documented = [], [], []
        words = headers.parameters(function.text)
        for name, (kind, default) in function.arguments.items():
            if is_setter and kind in TAKEN and (self.cpp, kind) != ("MembraneForce", "int"):
                text, _ = TAKEN[kind]
                match = SETTER_OF_ELEMENTS.match(function.name)
                called = (
                    lower(match[1] or match[2]) if match and kind == "std::vector<double>" else name
                )
                if called == "seed":
                    called = "randomNumberSeed"
                passed.append(f'{TAKEN[kind][1]}(self, "{called}", {name})')
            elif is_setter and re.fullmatch("[A-Z][A-Za-z]+", kind):
                text = "int | str"
                passed.append(f'constant(self, "{name}", {name})')
            else:
                text = TYPES[kind]
                passed.append(name)
            shown.append(f"{name}: {text}" + (f" = {default}" if default else ""))
            if name in words:
                what = {"Scalar": "float or Quantity", "Values": "array_like or Quantity"}
                documented += [f"{name} : {what.get(text, text)}", *indented(sentence(words[name]))]
        if not function.is_static:
            shown, passed = ["self", *shown], ["self", *passed]
        text = function.text.partition("@")[0].strip()
        if documented:
            text += "\n\nParameters\n----------\n" + "\n".join(documented)
        given = "int" if re.fullmatch("[A-Z][a-z]+", function.given) else ""
        given = "list[int]" if function.outputs else given or GIVEN[function.given]
        if found := re.search(r"@return\s+(.*)", function.text, re.DOTALL):
            what = sentence(" ".join(found[1].split()))
            text += f"\n\nReturns\n-------\n{given}\n" + "\n".join(indented(what))
        lines = ["", *(["    @staticmethod"] if function.is_static else [])]
        lines += signature(function.name, shown, given)
        lines += docstring(text, 8)
        inner = ("" if given == "None" else "return ") + f"_forces.{self.name}_{function.name}"
        return [*lines, f"        {inner}({', '.join(passed)})"]

    def casts(self) -> list[str]:
        """What tells objects of OpenMM apart."""
        kind = "integrator" if "Integrator" in self.base else "force"
        taken = f"{kind}: openmm.{kind.capitalize()}"
        return [
            "",
            "    @staticmethod",
            *signature("isinstance", [taken], "bool"),
            *docstring(f"Whether some {kind} of OpenMM is of this class.", 8),
            f"        return _forces.{self.name}_isinstance({kind})",
            "",
            "    @staticmethod",
            *signature("cast", [taken], self.name),
            *docstring(f"The same {kind} as an object of this class.", 8),
            f"        return own(_forces.{self.name}_cast({kind}), {kind})",
        ]


def lower(word: str) -> str:
    """With a small letter at the beginning."""
    return word[0].lower() + word[1:]


def default_of(kind: str, default: str, constants: dict[str, str]) -> str:
    """A default of C++ in Python."""
    if default in constants:
        return constants[default]
    return repr(float(eval(default))) if kind == "double" else default


def sentence(words: str) -> str:
    """With a capital and a full stop."""
    return words[0].upper() + words[1:] + ("" if words.endswith(".") else ".")


def indented(words: str) -> list[str]:
    """A text of one paragraph below the name of an argument."""
    return textwrap.wrap(words, WIDTH - 12, initial_indent="    ", subsequent_indent="    ")


def signature(name: str, arguments: list[str], given: str) -> list[str]:
    """The head of a function; what is too long is wrapped at the end."""
    return [f"    def {name}({', '.join(arguments)}) -> {given}:"]


def docstring(text: str, indent: int = 4) -> list[str]:
    """A text of C++ as Python has it: what says it in short in a paragraph of its own."""
    text = re.sub(r"\b(Context|Integrator|System)::(\w+)", r"\1.\2", text)
    text = re.sub(r"\b(true|false)\b", lambda word: word[0].capitalize(), text)
    width, margin = WIDTH - indent, " " * indent
    first, _, rest = text.partition("\n\n")
    short, _, more = " ".join(first.split()).partition(". ")
    if more:
        short, rest = f"{short}.", "\n\n".join(filter(None, [more, rest]))
    lines = textwrap.wrap(f'"""{short}', width)
    if not rest and len(lines) == 1 and len(lines[0]) + 3 <= width:
        return [f'{margin}{lines[0]}"""']
    for paragraph in filter(None, rest.split("\n\n")):
        is_set = paragraph.startswith((" ", "Parameters\n", "Returns\n"))
        words = " ".join(paragraph.split())
        lines += ["", *(paragraph.split("\n") if is_set else textwrap.wrap(words, width))]
    return [(margin + line).rstrip() for line in [*lines, '"""']]


def classes() -> list[Writer]:
    """All classes in an order in which bases come first."""
    known = dict(headers.classes())
    known["HelfrichForce"] = headers.read_class(BASE, BASE.read_text(encoding="utf-8"))
    found = []

    def add(cpp: str) -> None:
        template, _, inner = cpp.partition("<")
        if template not in known or NAMES.get(cpp, cpp) in [writer.name for writer in found]:
            return
        base = inner.rstrip(">") or known[template].base
        add(base)
        is_ours = base.partition("<")[0] in known
        base = NAMES.get(base, base) if is_ours else base.replace("OpenMM::", "openmm.")
        found.append(Writer(known[template], NAMES.get(cpp, cpp), base))

    for name in ("TriangulatedForce", "MonteCarloSurfaceMover", "MembraneForce"):
        add(name)
    for name in sorted(known, key=lambda name: known[name].base != "MembraneForce"):
        if name != "MonteCarloMover":
            add(name)
    return found


def snake(name: str) -> str:
    """What the file of a class is called."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def texts() -> dict[Path, str]:
    """By file what is to be in it: one for each class, and the list of all."""
    writers = classes()
    bases = ["MembraneForce", "TriangulatedForce"]
    public = bases + [writer.name for writer in writers if writer.known.constructor]
    listed = [f"from .{snake(name)} import {name}" for name in public]
    names = "\n".join(f'    "{name}",' for name in sorted(public))
    files = {FOLDER / "__init__.py": "\n".join([INIT, *listed, "", f"__all__ = [\n{names}\n]"])}
    for writer in writers:
        is_ours = not writer.base.startswith("openmm.")
        base = f"from .{snake(writer.base)} import {writer.base}\n" if is_ours else ""
        head = HEAD.format(name=writer.name.strip("_"), base=base)
        files[FOLDER / f"{snake(writer.name)}.py"] = "\n".join([head, *writer.lines(), ""])
    return {path: formatted(path, text) for path, text in files.items()}


def formatted(path: Path, text: str) -> str:
    """A file without what it does not need of the head, as `make format` has it."""
    ruff = Path(sys.executable).parent / "ruff"
    piped = {"capture_output": True, "text": True, "check": True, "cwd": ROOT}
    for command in (["check", "-q", "--fix-only", "--select", "F401,I"], ["format", "-q"]):
        words = [ruff, *command, "--stdin-filename", path, "-"]
        text = subprocess.run(words, input=text, **piped).stdout
    return text


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    written = texts()
    for path in set(FOLDER.glob("*.py")) - set(written):
        path.unlink()
    for path, text in written.items():
        path.write_text(text, encoding="utf-8")
