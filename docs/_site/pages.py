"""The pages that are made anew in each build: forces, C, C++, the command line."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import click
import openmmhelfrich as helfrich
from openmmhelfrich import _values, cli, forces

from . import examples, figures, headers
from .rst import code, escaped, indented, prose, table, title

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
SHADERS = ROOT / "shaders" / "potentials"
_COMMON = ("MembraneForce", "TriangulatedForce")


def write_all() -> None:
    """Write all pages, those that have changed alone."""
    pages = {"forces/index": _index(), "api/cpp": _cpp(), "api/c": _c(), "api/cli": _cli()}
    pages |= {f"forces/{name}": _page(name) for name in [*_COMMON, *names()]}
    folder = DOCS / "forces"
    folder.mkdir(exist_ok=True)
    (DOCS / "api").mkdir(exist_ok=True)
    for name in potentials():
        figures.draw(name, folder / f"{name}.svg")
    for name, lines in pages.items():
        path = DOCS / f"{name}.rst"
        text = "\n".join(lines)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    # What has lost its class.
    for old in folder.glob("*.rst"):
        if f"forces/{old.stem}" not in pages:
            old.unlink()


def potentials() -> list[str]:
    """The classes with an energy, in the order of the headers."""
    return [c.__name__ for c in forces.MembraneForce.__subclasses__()]


def names() -> list[str]:
    """All classes that users make."""
    return [name for name in forces.__all__ if name not in _COMMON]


def readme_rows() -> dict[str, tuple[str, str]]:
    """By class the heading of its table in the README, and its energy."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Forces")[2]
    heading, found = "", {}
    for line in text.split("\n"):
        if match := re.match(r"\*\*(.+?)\*\*", line):
            heading = match[1]
        elif match := re.match(r"\| `(\w+Force)` \| (.*?) \| ", line):
            found[match[1]] = heading, match[2]
    return found


def _formula(cell: str) -> str:
    return escaped(re.sub(r" ?\(?\[([^]]+)\]\([^)]*\)\)?", "", cell))


# --- Forces ---


def _index() -> list[str]:
    rows = readme_rows()
    missing = set(potentials()) - set(rows)
    if missing:
        raise ValueError(f"README.md has no row for {', '.join(sorted(missing))}")
    lines = [
        title("Energies at a glance"),
        "Each energy as the package computes it, beside what it measures. A name leads to formula,",
        "parameters, an example, and the names in Python, C, C++ and Rust.",
        "",
    ]
    headings: dict[str, list[str]] = {}
    for name, (heading, _) in rows.items():
        headings.setdefault(heading, []).append(name)
    for heading, group in headings.items():
        lines += [title(heading, "-")]
        for name in group:
            lines += [
                f":doc:`{name} <{name}>`: {_formula(rows[name][1])}",
                "",
                f".. image:: {name}.svg",
                f"   :alt: What {name} measures, and its energy",
                f"   :target: {name}.html",
                "",
            ]
    others = [name for name in names() if name not in rows]
    lines += [
        title("Beside the energies", "-"),
        *[f"- :doc:`{name}`: {_first_sentence(name)}" for name in others],
        "",
        title("What all forces have in common", "-"),
        *[f"- :doc:`{name}`: {_first_sentence(name)}" for name in _COMMON],
        "",
        ".. toctree::",
        "   :hidden:",
        "",
        *[f"   {name}" for name in [*rows, *others, *_COMMON]],
        "",
    ]
    return lines


def _first_sentence(name: str) -> str:
    text = headers.classes()[name].text.split("\n\n")[0]
    return escaped(re.split(r"(?<=[.:])\s", " ".join(text.split()))[0].rstrip(":"))


def _page(name: str) -> list[str]:
    known = headers.classes()[name]
    lines = [title(name)]
    row = readme_rows().get(name)
    if row:
        lines += [".. rst-class:: formula", "", f"{_formula(row[1])}", ""]
        lines += [f".. image:: {name}.svg", f"   :alt: What {name} measures, and its energy", ""]
    lines += prose(known.text)
    if known.constructor:
        lines += _parameters(name, known)
    for member in known.members:
        if member.is_enumeration:
            rows = [[f"``{v.name}``", " ".join(prose(v.text))] for v in member.values]
            lines += [title(member.name, "-"), *prose(member.text), *table(["value", ""], rows)]
    if row:
        lines += _where(name)
    if name not in _COMMON:
        lines += [title("Example", "-"), *code(examples.code(name), "python")]
        lines += ["It prints", "", *code(examples.output(name), "text")]
    lines += [title("Python", "-"), f".. autoclass:: openmmhelfrich.{name}", "   :members:"]
    lines += ["   :exclude-members: thisown, isinstance, cast", ""]
    lines += _other_languages(name, known)
    guides = [
        path for path in sorted(DOCS.glob("*.md"))
        if f"`{name}" in path.read_text(encoding="utf-8")
    ]  # fmt: skip
    if guides:
        lines += [title("Read on", "-"), *[f"- :doc:`/{path.stem}`" for path in guides], ""]
    return lines


def _parameters(name: str, known: headers.Class) -> list[str]:
    scalars = {s.name: s for s in _values.scalars_of(name)}
    meanings = headers.parameters(known.constructor.text)
    rows = []
    for parameter in inspect.signature(getattr(helfrich, name)).parameters.values():
        scalar = scalars.get(parameter.name)
        default = _default(parameter, known)
        own = f"``{scalar.element_setter}``" if scalar and scalar.element_setter else ""
        meaning = meanings.get(parameter.name, "")
        if parameter.name == "triangles":
            meaning = (
                "a `Mesh`, or particle indices, shape (num_triangles, 3), counter-clockwise seen "
                "from outside"
            )
        elif parameter.name == "offset":
            meaning = "added to all particle indices"
        rows.append([f"``{parameter.name}``", escaped(meaning), default, own])
    head = ["argument", "meaning and unit of plain numbers", "default", "one for each"]
    lines = [title("Parameters", "-"), *table(head, rows)]
    if scalars:
        listed = ", ".join(f"``{s}``" for s in scalars)
        lines += [
            "Quantities of other units are converted. These may be parameters of the Context, by "
            f"``setContextParameter``, with energy derivatives: {listed}.",
            "",
        ]
    return lines


def _default(parameter: inspect.Parameter, known: headers.Class) -> str:
    """As users write it: the name of a variant, four digits of a number."""
    value = parameter.default
    if value is parameter.empty:
        return ""
    variants = next((m.values for m in known.members if m.name.lower() == parameter.name), None)
    if variants:
        return f"``{variants[value].name}``"
    return f"``{value:.4g}``" if isinstance(value, float) else f"``{value}``"


def _where(name: str) -> list[str]:
    """What computes a force: that with a shader has formulas for GPUs."""
    stem = re.sub(r"(?<!^)([A-Z])", r"_\1", name.removesuffix("Force")).lower()
    if (SHADERS / f"{stem}.wgsl").exists():
        text = (
            "The processor computes it on every platform; so do GPUs by the backends ``gpu`` and "
            "``native``. :doc:`/platforms` has what is chosen, and the exceptions."
        )
    else:
        text = (
            "The processor computes it, on every platform and beside every backend. See "
            ":doc:`/platforms`."
        )
    return [title("Where it is computed", "-"), text, ""]


def _other_languages(name: str, known: headers.Class) -> list[str]:
    lines = [title("C++, C and Rust", "-")]
    header = f"``#include <openmm-helfrich/{known.header.name}>``"
    lines += [f"{header}: :cpp:class:`HelfrichPlugin::{name}`", ""]
    if known.constructor:
        lines += code(f"HelfrichPlugin::{known.constructor.declaration};", "cpp")
    functions = [f for f in headers.c_functions() if f.name.startswith(f"Helfrich_{name}_")]
    if functions:
        lines += ["In C:", ""]
        lines += [f"- :c:func:`{f.name}`" for f in functions if not f.is_enumeration]
        lines += [f"- :c:enum:`{f.name}`" for f in functions if f.is_enumeration]
        lines += [""]
    if name in potentials():
        values = [s.name for s in _values.scalars_of(name)]
        call = f'MembraneForce::new("{name}", &triangles, &[{", ".join(values)}])?'
        lines += ["In Rust (:doc:`/rust`):", "", *code(call, "rust")]
    elif functions and not name.endswith("Integrator"):
        target = f"../rust/openmm_helfrich/force/struct.{name}.html"
        lines += [f"In Rust: `openmm_helfrich::force::{name} <{target}>`__", ""]
    return lines


# --- C++ and C ---


def _cpp() -> list[str]:
    lines = [
        title("C++"),
        "``#include <OpenMMHelfrich.h>`` has all classes. They are header-only, and OpenMM Forces",
        "or Integrators like any other; link ``libOpenMMHelfrich.so`` and ``libOpenMM.so``.",
        ":doc:`/languages` has an example.",
        "",
    ]
    for known in sorted(headers.classes().values(), key=lambda c: (c.name not in _COMMON, c.name)):
        lines += [title(known.name, "-"), f"``openmm-helfrich/{known.header.name}``", ""]
        lines += [f".. cpp:class:: HelfrichPlugin::{known.name} : public {known.base}", ""]
        lines += indented(prose(known.text))
        for member in known.members:
            kind = "enum" if member.is_enumeration else "function"
            declaration = member.declaration.removeprefix("enum ")
            lines += [f"   .. cpp:{kind}:: {declaration}", "", *indented(prose(member.text), 6)]
            for value in member.values:
                lines += [f"      .. cpp:enumerator:: {value.declaration}", ""]
                lines += indented(prose(value.text), 9)
    return lines


def _c() -> list[str]:
    text = headers.C_HEADER.read_text(encoding="utf-8")
    head = headers.plain(re.search(r"/\*\*(.*?)\*/", text, re.DOTALL)[1])
    lines = [title("C"), "``#include <OpenMMHelfrichCWrapper.h>``", "", *prose(head)]
    sections: dict[str, list[headers.Member]] = {}
    for member in headers.c_functions():
        found = re.match(r"Helfrich_([A-Z]\w+?)_", member.name)
        sections.setdefault(found[1] if found else "The library", []).append(member)
    for section, members in sections.items():
        lines += [title(section, "-")]
        for member in members:
            kind, values = ("enum", member.values) if member.is_enumeration else ("function", ())
            lines += [f".. c:{kind}:: {member.declaration}", "", *indented(prose(member.text))]
            for value in values:
                lines += [f"   .. c:enumerator:: {value.declaration}", ""]
    return lines


# --- The command line ---


def _cli() -> list[str]:
    lines = [
        title("Command line"),
        "What ``openmm-helfrich --help`` and ``--help`` of each command say.",
        "",
    ]
    return lines + _help(cli.main, "openmm-helfrich", None)


def _help(command: click.Command, path: str, parent: click.Context | None) -> list[str]:
    context = click.Context(
        command, info_name=path.split()[-1], parent=parent, terminal_width=100,
        max_content_width=100,
    )  # fmt: skip
    lines = [title(path, "-"), *code(command.get_help(context), "text")]
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            lines += _help(command.get_command(context, name), f"{path} {name}", context)
    return lines
