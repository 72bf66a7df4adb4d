"""What the headers of C++ and C say: classes and functions, with their comments."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

INCLUDE = Path(__file__).parents[2] / "wrappers" / "include"
HEADERS = INCLUDE / "openmm-helfrich"
C_HEADER = INCLUDE / "OpenMMHelfrichCWrapper.h"
C_FORCES = INCLUDE / "OpenMMHelfrichCForces.h"
C_STATUS = HEADERS / "internal" / "Status.h"

_COMMENT = re.compile(r"[ \t]*/\*\*\s*\n?(.*?)\*/\s*\n", re.DOTALL)


@dataclass(frozen=True)
class Member:
    """A function, or an enumeration with its values, each of them a Member too."""

    declaration: str
    text: str
    values: tuple[Member, ...] = ()

    @property
    def is_enumeration(self) -> bool:
        """Whether it is no function."""
        return bool(self.values)

    @property
    def name(self) -> str:
        """What it is called."""
        return re.search(r"(\w+)\s*(?:\(|=|$)", self.declaration)[1]


@dataclass(frozen=True)
class Class:
    """A class and its public members."""

    name: str
    header: Path
    base: str
    text: str
    members: list[Member] = field(default_factory=list)

    @property
    def constructor(self) -> Member | None:
        """Its constructor, if it has a public one."""
        return next((m for m in self.members if m.name == self.name), None)


def plain(comment: str) -> str:
    """The text of a comment without its stars."""
    lines = [re.sub(r"^\s*\* ?", "", line) for line in comment.strip("\n").split("\n")]
    return "\n".join(line.rstrip() for line in lines).strip("\n ")


def parameters(text: str) -> dict[str, str]:
    """The @param lines of a comment, by name."""
    found = re.findall(r"@param(?:\[out\])?\s+(\w+)\s+(.*?)(?=\n\s*@|\Z)", text, re.DOTALL)
    return {name: " ".join(words.split()) for name, words in found}


@cache
def classes() -> dict[str, Class]:
    """All public classes, by name."""
    found = {}
    for header in sorted(HEADERS.glob("*.h")):
        known = read_class(header, header.read_text(encoding="utf-8"))
        found[known.name] = known
    return found


def read_class(header: Path, text: str) -> Class:
    """The class that a header is about."""
    pattern = _COMMENT.pattern + r"(?:template[^\n]*\n)?class (\w+) : public ([\w:<>]+)[^{]*\{"
    match = next((m for m in re.finditer(pattern, text, re.DOTALL) if "*/" not in m[1]), None)
    if match is None:
        raise ValueError(f"{header}: there is no class with a comment")
    body = text[match.end() :].partition("\n};")[0]
    public = re.split(r"^(?:protected|private):", body.partition("public:")[2], flags=re.M)[0]
    return Class(match[2], header, match[3], plain(match[1]), _members(public))


def _members(body: str) -> list[Member]:
    members, at = [], 0
    while (match := _COMMENT.search(body, at)) is not None:
        rest = body[match.end() :]
        if rest.lstrip().startswith("enum"):
            inside, _, _ = rest.partition("};")
            name = re.search(r"enum (\w+)", inside)[0]
            values = re.findall(
                r"/\*\*\s*\n(.*?)\*/\s*(\w+ = \d+)", inside.partition("{")[2], re.DOTALL
            )
            at = match.end() + len(inside)
            values = tuple(Member(value, plain(words)) for words, value in values)
            members.append(Member(name, plain(match[1]), values))
        else:
            # Up to the body, the end, or what a constructor begins with.
            declaration = re.split(r"\{|;|\)\s*:", rest, maxsplit=1)[0]
            at = match.end() + len(declaration)
            if declaration.count("(") > declaration.count(")"):
                declaration += ")"
            members.append(Member(" ".join(declaration.split()), plain(match[1])))
    return members


@cache
def c_functions() -> list[Member]:
    """All functions and enumerations for C, in the order of its headers."""
    text = C_STATUS.read_text(encoding="utf-8")
    for header in (C_HEADER, C_FORCES):
        text += header.read_text(encoding="utf-8").partition('extern "C" {')[2]
    comment = r"(?:/\*\*(?P<text>(?:(?!\*/).)*)\*/\s*)?"
    function = r"extern (?P<function>[^;]*\));"
    enumeration = r"typedef enum (?:\w+ )?\{(?P<values>[^}]*)\} (?P<name>\w+);"
    found = []
    for match in re.finditer(f"{comment}(?:{function}|{enumeration})", text, re.DOTALL):
        words = plain(match["text"] or "")
        if match["function"]:
            found.append(Member(" ".join(match["function"].split()), words))
        else:
            values = tuple(Member(v.strip(), "") for v in match["values"].split(","))
            found.append(Member(match["name"], words, values))
    return found
