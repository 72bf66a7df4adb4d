"""Write python/openmmhelfrich/forces.pyi, which tells type checkers what the force classes take.

    .venv/bin/python .ci/stubs.py (or make derived)

SWIG makes forces.py, and the package changes its classes when they are imported; so the signatures
here are those of the live classes. The types are those of the C++ headers.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from pathlib import Path

import openmm
from openmmhelfrich import _values, forces

ROOT = Path(__file__).resolve().parents[1]
STUB = ROOT / "python" / "openmmhelfrich" / "forces.pyi"
HEADERS = ROOT / "wrappers" / "include" / "openmm-helfrich"
WIDTH = 100

HEAD = """\
# .ci/stubs.py writes this file, from the classes of forces.py.

from typing import Any, ClassVar, TypeAlias

import numpy as np
import openmm
from numpy.typing import ArrayLike, NDArray

from ._types import Quantity
from .mesh import Mesh

_Scalar: TypeAlias = float | Quantity
_Values: TypeAlias = ArrayLike | Quantity
_Triangles: TypeAlias = Mesh | ArrayLike
"""

# What C++ has, as the package takes it and gives it.
TAKEN = {"double": "float", "int": "int", "bool": "bool", "std::string": "str"}
TAKEN |= {"OpenMM::Context": "openmm.Context"}
WITH_UNITS = {"double": "_Scalar", "std::vector<double>": "_Values", "int": "int"}
GIVEN = {"double": "float", "int": "int", "unsigned int": "int", "bool": "bool", "void": "None"}
GIVEN |= {"std::string": "str", "std::vector<double>": "tuple[float, ...]"}

# Of the methods that are written in Python: what they give, and what their arguments are.
GIVEN_BY = {
    "addTriangles": "None",
    "getDomains": "NDArray[np.int64]",
    "getDomainsInContext": "NDArray[np.int64]",
    "getMasses": "NDArray[np.float64]",
    "getParticles": "NDArray[np.int64]",
    "getPermutationInContext": "NDArray[np.int64]",
    "getReference": "NDArray[np.float64]",
    "getReferenceBox": "NDArray[np.float64] | None",
    "getStatistics": "dict[str, Any]",
    "getTrianglesInContext": "NDArray[np.int64]",
    "setDomains": "None",
    "setParticles": "None",
    "setPermutationInContext": "None",
    "setReference": "None",
    "setReferenceBox": "None",
    "setTrianglesInContext": "None",
}
ARGUMENTS = {
    "box": "_Values | None",
    "context": "openmm.Context",
    "domains": "ArrayLike",
    "given": "_Triangles",
    "offset": "int",
    "particles": "ArrayLike",
    "permutation": "ArrayLike",
    "reference": "Mesh | _Values",
    "triangles": "_Triangles",
}


def declarations() -> dict[str, tuple[str, dict[str, str]]]:
    """By name of a C++ function what it gives and its arguments with their types."""
    found = {}
    for header in [*sorted(HEADERS.glob("*.h")), HEADERS / "internal" / "HelfrichForce.h"]:
        text = header.read_text(encoding="utf-8")
        text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)
        # Those of a class; where one is declared again, its types are the same or an enumeration.
        for match in re.finditer(
            r"^    (?=\S)(?:explicit |virtual |static )*(?:([\w:<>& ,]+?)[ &]+)?(\w+)\(([^()]*)\)",
            text,
            re.MULTILINE,
        ):
            given, name, inside = match.groups()
            arguments = {}
            for argument in filter(None, map(str.strip, re.split(r",(?![^<]*>)", inside))):
                kind, _, word = argument.partition("=")[0].strip().rpartition(" ")
                arguments[word.strip("&")] = plain(kind)
            if name == header.stem or given not in (None, "return"):
                found.setdefault(name, (plain(given or ""), arguments))
    return found


def plain(kind: str) -> str:
    """A C++ type without const and references."""
    return re.sub(r"\bconst\b|&", "", kind).strip()


DECLARED = declarations()


def taken(kind: str, has_units: bool) -> str:
    """The Python type of an argument; enumerations are numbers or, where units are read, names."""
    if has_units and kind in WITH_UNITS:
        return WITH_UNITS[kind]
    if re.fullmatch("[A-Z][a-z]+", kind):
        return "int | str" if has_units else "int"
    return TAKEN[kind]


def paragraph(text: str | None, indent: str, default: str = "") -> list[str]:
    """The first paragraph of a docstring as one."""
    words = inspect.cleandoc(text or "").partition("\n\n")[0]
    words = " ".join((default if not words or words.startswith(":") else words).split())
    if not words:
        return []
    prefix = "r" * ("\\" in words)
    if len(f'{indent}{prefix}"""{words}"""') <= WIDTH:
        return [f'{indent}{prefix}"""{words}"""']
    lines = textwrap.wrap(
        f'{prefix}"""{words}', WIDTH, initial_indent=indent, subsequent_indent=indent
    )
    return [*lines, f'{indent}"""']


def definition(name: str, arguments: list[str], given: str, doc: list[str]) -> list[str]:
    """A function of a class, in one line if it fits."""
    body = [] if doc else [" ..."]
    line = f"    def {name}({', '.join(arguments)}) -> {given}:"
    if len(line + "".join(body)) > WIDTH:
        joined = f"        {', '.join(arguments)}"
        rows = [joined] if len(joined) <= WIDTH else [f"        {word}," for word in arguments]
        return [f"    def {name}(", *rows, f"    ) -> {given}:" + "".join(body), *doc]
    return [line + "".join(body), *doc]


def written(parameter: inspect.Parameter, kind: str) -> str:
    """An argument with its type and default."""
    text = f"{parameter.name}: {kind}"
    return text if parameter.default is parameter.empty else f"{text} = {parameter.default!r}"


def listed(function, kinds: dict[str, str]) -> list[str]:
    """The arguments of a function. Those of setters, which are wrapped, have no names for users."""
    shown = list(inspect.signature(function).parameters.values())
    found = []
    for parameter in shown:
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in found:
            found.append("*")
        is_self = parameter.name == "self"
        found.append("self" if is_self else written(parameter, kinds[parameter.name]))
    is_setter = len(shown) == 2 and function.__name__.startswith("set")
    return [*found, "/"] if is_setter else found


def constructor(cls: type) -> list[str]:
    """What makes an object, of a class that has one."""
    shown = inspect.signature(cls.__init__).parameters.values()
    if any(parameter.kind is parameter.VAR_POSITIONAL for parameter in shown):
        return []
    _, declared = DECLARED[cls.__name__]
    kinds = {name: taken(kind, True) for name, kind in declared.items() if name not in ARGUMENTS}
    for scalar in _values.scalars_of(cls.__name__):
        if scalar.element_setter is not None:
            kinds[scalar.name] = "_Scalar | ArrayLike"
    return definition("__init__", listed(cls.__init__, ARGUMENTS | kinds), "None", [])


def method(cls: type, name: str, member) -> list[str]:
    """One function of a class."""
    doc = " " * 8
    if isinstance(member, staticmethod):
        function = member.__func__
        integrator = "integrator" in inspect.signature(function).parameters
        kinds = {"integrator": "openmm.Integrator", "force": "openmm.Force"}
        what = "integrator" if integrator else "force"
        given, words = {
            "cast": (cls.__name__, f"The same {what} as an object of this class."),
            "isinstance": ("bool", f"Whether a {what} of OpenMM is of this class."),
        }.get(name, ("str", ""))
        text = paragraph(function.__doc__, doc, words)
        return ["    @staticmethod", *definition(name, listed(function, kinds), given, text)]
    text = paragraph(member.__doc__, doc)
    if member.__module__ != forces.__name__:
        kinds = ARGUMENTS | ({"given": "ArrayLike"} if name == "setParticles" else {})
        return definition(name, listed(member, kinds), GIVEN_BY[name], text)
    given, declared = DECLARED[name]
    has_units = hasattr(member, "__wrapped__")
    kinds = {word: taken(kind, has_units) for word, kind in declared.items()}
    if name == "getTriangle":
        # What C++ writes into its arguments is given.
        result = "list[int]"
    else:
        result = "int" if re.fullmatch("[A-Z][a-z]+", given) else GIVEN[given]
    return definition(name, listed(member, kinds), result, text)


def body(cls: type) -> list[str]:
    """A class with all that is public in it."""
    bases = [base.__name__ if base.__module__ == forces.__name__ else f"openmm.{base.__name__}"
             for base in cls.__bases__]  # fmt: skip
    lines = ["", f"class {cls.__name__}({', '.join(bases)}):", *paragraph(cls.__doc__, "    "), ""]
    constants = [name for name, value in vars(cls).items() if type(value) is int]
    lines += [f"    {name}: ClassVar[int]" for name in constants]
    lines += constructor(cls)
    for name, member in vars(cls).items():
        if not name.startswith("_") and (callable(member) or isinstance(member, staticmethod)):
            lines += method(cls, name, member)
    return lines if lines[-1] else [*lines[:-1], "    ..."] if len(lines) < 4 else lines[:-1]


def stub() -> str:
    """The text of the file."""
    names = ",\n".join(f'    "{name}"' for name in forces.__all__)
    lines = [HEAD, f"__all__ = [\n{names},\n]"]
    classes = dict.fromkeys(cls for cls in vars(forces).values() if isinstance(cls, type))
    for cls in classes:
        if issubclass(cls, (openmm.Force, openmm.Integrator)):
            lines += body(cls)
    lines += [
        "",
        "def _why_not_helfrich(system: openmm.System, integrator: openmm.Integrator) -> str: ...",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
