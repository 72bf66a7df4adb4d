"""Write what follows from the files of the potentials: their list for Rust, C++ and C.

    .venv/bin/python .ci/potentials.py (or make derived)

The list of Rust is in src/potentials/mod.rs, made of the files beside it; those of C++ and C are
OpenMMHelfrich.h and OpenMMHelfrichCForces.h, made of the headers of the classes.
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

WIDTH = 120
CORE = ROOT / "src" / "potentials" / "mod.rs"
BEGIN = "// .ci/potentials.py writes what follows, from the files here with an `impl Potential`.\n"
END = "// Up to here.\n"
CPP = """\
#ifndef OPENMM_HELFRICH_H_
#define OPENMM_HELFRICH_H_

/* .ci/potentials.py writes this file, from the headers in openmm-helfrich/. */

/** All forces and integrators of the plugin. */

{includes}

/** Apply a macro to the name of each force class: the list that plugin and Python are made from. */
// clang-format off: one a line
#define HELFRICH_FORCES(apply) \\
{names}
// clang-format on

#endif /*OPENMM_HELFRICH_H_*/
"""
C = """\
#ifndef OPENMM_HELFRICH_CFORCES_H_
#define OPENMM_HELFRICH_CFORCES_H_

/* .ci/potentials.py writes this file, from the headers in openmm-helfrich/. */

/*
 * The forces for C, each with its scalars. OpenMMHelfrichCWrapper.h includes them.
 *
 * `triangles` holds three particle indices a triangle, counter-clockwise seen from outside. Schemes
 * and forms are numbers of the enumerations.
 */

#include "openmm-helfrich/internal/Status.h"

#include <OpenMMCWrapper.h>

#ifdef __cplusplus
extern "C" {{
#endif

{functions}
#ifdef __cplusplus
}}
#endif

#endif /*OPENMM_HELFRICH_CFORCES_H_*/
"""


def core() -> str:
    """The text of mod.rs, with the modules of all potentials and their registry."""
    found = {}
    for path in sorted(CORE.parent.glob("*.rs")):
        text = path.read_text(encoding="utf-8")
        for name in re.findall(r"^impl Potential for (\w+)", text, re.MULTILINE):
            found[path.stem] = name
    lines = [f"pub(crate) mod {stem};" for stem in found]
    lines += ["", "/// All potentials, by the names of their OpenMM classes."]
    lines += [f"pub static REGISTRY: [&dyn Potential; {len(found)}] = ["]
    lines += [f"    &{stem}::{name}," for stem, name in found.items()]
    before, begin, rest = CORE.read_text(encoding="utf-8").partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise ValueError(f"{CORE} lacks the lines {BEGIN!r} and {END!r}")
    return before + begin + "\n".join([*lines, "];"]) + "\n" + end + after


def forces() -> list[headers.Class]:
    """The classes with an energy."""
    return [known for known in headers.classes().values() if known.base == "MembraneForce"]


def cpp() -> str:
    """The text of OpenMMHelfrich.h."""
    included = sorted(known.header.name for known in headers.classes().values())
    return CPP.format(
        includes="\n".join(f'#include "openmm-helfrich/{name}"' for name in included),
        names=" \\\n".join(f"    apply({force.name})" for force in forces()),
    )


def c() -> str:
    """The text of OpenMMHelfrichCForces.h."""
    return C.format(functions="\n".join(map(c_functions, forces())))


def c_functions(force: headers.Class) -> str:
    """The enumerations of a class, its `create`, and the `get` and `set` of its scalars.

    Functions of C take the scalars up to the form; what is no number is set after the creation.
    """
    prefix, itself = f"Helfrich_{force.name}", "OpenMM_Force* force"
    text = ""
    kinds = {member.name: member for member in force.members if member.is_enumeration}
    for name, kind in kinds.items():
        values = ", ".join(f"{prefix}_{value.declaration}" for value in kind.values)
        text += comment(kind.text) + f"typedef enum {{ {values} }} {prefix}_{name};\n\n"
    says = re.split(r"(?<=[.:])\s", " ".join(force.text.split()), maxsplit=1)[0].rstrip(":.") + "."
    taken = ["const int* triangles", "int numTriangles"]
    if force.constructor is None:
        raise ValueError(f"{force.header}: the constructor of {force.name} needs a comment")
    inside = force.constructor.declaration.partition("(")[2].removesuffix(")")
    for argument in re.split(r",(?![^<]*>)", inside)[1:]:
        kind, name = argument.partition("=")[0].split()[-2:]
        if kind == "double":
            taken.append(f"double {name}")
        elif kind in kinds:
            taken.append(f"int {name}")
            break
        else:
            owner = "Helfrich_MembraneForce" if name == "reference" else prefix
            says += f" Its {name}: {owner}_set{name[0].upper()}{name[1:]}()."
    text += comment(says) + f"extern OpenMM_Force* {prefix}_create({', '.join(taken)});\n"
    for member in force.members:
        if found := re.fullmatch(r"double (get\w+)\(\) const", member.declaration):
            text += comment(member.text) + f"extern double {prefix}_{found[1]}({itself});\n"
        elif found := re.fullmatch(r"void (set\w+)\((double \w+)\)", member.declaration):
            arguments = f"{itself}, {found[2]}"
            text += comment(member.text)
            text += f"extern Helfrich_Status {prefix}_{found[1]}({arguments});\n"
    return text


def comment(text: str) -> str:
    """The first paragraph of a text."""
    words = " ".join(text.partition("\n\n")[0].split())
    if len(words) <= WIDTH - len("/**  */"):
        return f"/** {words} */\n"
    return f"/**\n{textwrap.indent(textwrap.fill(words, WIDTH - 3), ' * ')}\n */\n"


def formatted(path: Path, text: str) -> str:
    """A header as `make format` has it."""
    command = [Path(sys.executable).parent / "clang-format", f"--assume-filename={path}"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def texts() -> dict[Path, str]:
    """By file what is to be in it."""
    cpp_header = headers.INCLUDE / "OpenMMHelfrich.h"
    return {
        CORE: core(),
        cpp_header: formatted(cpp_header, cpp()),
        headers.C_FORCES: formatted(headers.C_FORCES, c()),
    }


if __name__ == "__main__":
    for path, text in texts().items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
