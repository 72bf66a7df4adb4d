"""Changes of inputs: bytes, text, XML. Each takes the input and a `random.Random`."""

from __future__ import annotations

import copy
import re
from random import Random
from xml.etree import ElementTree

__all__ = ["NUMBERS", "binary", "text", "xml"]

#: Numbers at the edges of types, and words that are nearly numbers.
NUMBERS = [
    *("0", "-0.0", "1", "-1", "2", "3", "4", "7", "0.5", "100", "1000000"),
    *("nan", "inf", "-inf", "1e308", "-1e308", "1e160", "1e-160", "5e-324", "1e400", "1e-400"),
    *("127", "128", "255", "256", "65536", "2147483647", "2147483648", "-2147483649", "4294967295"),
    *("9223372036854775807", "9223372036854775808", "18446744073709551616", "9" * 40, "9" * 5000),
    *("0x10", "1_000", "1.5abc", "", " 7", "1e", "1,5", "\u0661", "True", "true", "x", "-", "+3"),
    *("1d3", "1.", ".5", "1e+", "--1", "1 2", "\0", "%s", "{}", "\u20ac"),
]
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_WORD = re.compile(r"[^\s]+")
_EDGES = [0, 1, 2, 3, 0x7F, 0x80, 0xFE, 0xFF, 0x0A, 0x0D, 0x20]


def binary(data: bytes, random: Random) -> bytes:
    """Bits and bytes changed, cut out, repeated, moved; the end cut off."""
    found = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 4, 8))):
        at = random.randrange(len(found) + 1)
        # Headers are short and say most.
        if random.random() < 0.5:
            at = min(at, random.randrange(300))
        end = min(len(found), at + random.choice((1, 2, 4, 8, 12, 24, random.randrange(200))))
        match random.randrange(8):
            case 0 if at < len(found):
                found[at] ^= 1 << random.randrange(8)
            case 1 if at < len(found):
                found[at] = random.choice(_EDGES)
            case 2:
                del found[at:]
            case 3:
                del found[at:end]
            case 4:
                found[at:at] = found[at:end]
            case 5:
                found[at:end] = random.randbytes(end - at)
            case 6:
                found[at:end] = bytes([random.choice(_EDGES)]) * (end - at)
            case 7:
                to = random.randrange(len(found) + 1)
                found[to : to + end - at] = found[at:end]
    return bytes(found)


def text(data: bytes, random: Random) -> bytes:
    """Numbers and words replaced, lines cut out, repeated and exchanged; sometimes bytes."""
    if random.random() < 0.15:
        return binary(data, random)
    found = data.decode("latin-1")
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        lines = found.splitlines(keepends=True) or [""]
        # The beginning of a file is a header.
        line = random.randrange(len(lines))
        if random.random() < 0.4:
            line = min(line, random.randrange(12))
        match random.randrange(9):
            case 0 | 1 | 2:
                lines[line] = _replaced(lines[line], _NUMBER, random.choice(NUMBERS), random)
            case 3:
                words = _WORD.findall(found)
                other = random.choice(words) if words else "x"
                lines[line] = _replaced(lines[line], _WORD, other, random)
            case 4:
                del lines[line]
            case 5:
                lines.insert(random.randrange(len(lines) + 1), lines[line])
            case 6:
                other = random.randrange(len(lines))
                lines[line], lines[other] = lines[other], lines[line]
            case 7:
                lines[line] = _replaced(lines[line], _WORD, "", random)
            case 8:
                words = lines[line].split(" ")
                words.insert(random.randrange(len(words) + 1), random.choice(NUMBERS))
                lines[line] = " ".join(words)
        found = "".join(lines)
    # What is beyond one byte is written as UTF-8, the rest as it was.
    return b"".join(
        c.encode("latin-1") if ord(c) < 256 else c.encode("utf-8", "replace") for c in found
    )


def _replaced(line: str, pattern: re.Pattern, by: str, random: Random) -> str:
    found = list(pattern.finditer(line))
    if not found:
        return line
    match = random.choice(found)
    return line[: match.start()] + by + line[match.end() :]


def xml(data: bytes, random: Random, within: str | None = None, only_values: bool = False) -> bytes:
    """Attributes and elements changed, left out, repeated, renamed; sometimes text.

    `within` is the path of the elements that are changed with all below them; default: the root.
    With `only_values` what is there stays there, with other values.
    """
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError:
        return text(data, random)
    if random.random() < 0.05 and not only_values:
        return text(data, random)
    roots = [root] if within is None else root.findall(within)
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        parents = {child: parent for top in roots for parent in top.iter() for child in parent}
        # An element of each kind is as likely as any other: there are many triangles.
        kinds: dict[str, list] = {}
        for element in (element for top in roots for element in top.iter()):
            kinds.setdefault(element.tag, []).append(element)
        if not kinds:
            return data
        element = random.choice(kinds[random.choice(list(kinds))])
        parent = parents.get(element)
        name = random.choice(list(element.attrib) or ["value"])
        match random.randrange(3 if only_values else 8):
            case 0 | 1 | 2 if name in element.attrib:
                element.set(name, random.choice(NUMBERS))
            case 3 if element.attrib:
                del element.attrib[name]
            case 4:
                names = [key for other in root.iter() for key in other.attrib]
                element.set(random.choice([*names, "extra"]), random.choice([*NUMBERS, name]))
            case 5 if parent is not None:
                parent.insert(random.randrange(len(parent) + 1), copy.deepcopy(element))
            case 6 if parent is not None:
                parent.remove(element)
            case 7:
                element.tag = random.choice([*kinds, "Extra"])
    # XML has no control characters.
    return ElementTree.tostring(root, encoding="unicode").replace("\0", "").encode()
