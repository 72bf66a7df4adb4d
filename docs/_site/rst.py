"""Text of headers and docstrings as reStructuredText."""

from __future__ import annotations

import re

_DOI = re.compile(r"doi:(10\.\d+/[^\s,;]+?)(?=[.,;)]*(?:\s|$))")


def title(text: str, mark: str = "=") -> str:
    """A heading."""
    return f"{text}\n{mark * len(text)}\n"


def escaped(text: str) -> str:
    """Prose in which nothing is markup but `code` and DOIs."""
    parts = re.split(r"``?([^`]+)``?", text)
    for k, part in enumerate(parts):
        if k % 2:
            parts[k] = f"``{part}``"
        else:
            # An underscore at the end of a word would make a link.
            part = re.sub(r"([*|\\]|_(?!\w))", r"\\\1", part)
            parts[k] = _DOI.sub(r"`doi:\1 <https://doi.org/\1>`__", part)
    return "".join(parts)


def prose(text: str) -> list[str]:
    """Lines of prose: indented paragraphs are formulas, @param and @return are fields."""
    text = re.sub(r"@param(?:\[out\])?\s+(\w+)\s+", r":param \1: ", text)
    text = re.sub(r"@return\s+", ":returns: ", text)
    lines: list[str] = []
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        if block.startswith("    "):
            lines += ["::", "", *block.split("\n"), ""]
        else:
            head, *fields = re.split(r"^(?=:\w+)", block, flags=re.M)
            lines += [escaped(line.strip()) for line in head.strip().split("\n") if line.strip()]
            lines.append("")
            for one in fields:
                _, name, words = one.split(":", 2)
                lines.append(f":{name}: {escaped(' '.join(words.split()))}")
            lines.append("")
    return lines


def indented(lines: list[str], by: int = 3) -> list[str]:
    """The lines, moved to the right."""
    return [" " * by + line if line else "" for line in lines]


def table(head: list[str], rows: list[list[str]], widths: str = "auto") -> list[str]:
    """A table of cells of one paragraph each."""
    lines = [".. list-table::", "   :header-rows: 1", f"   :widths: {widths}", ""]
    for row in [head, *rows]:
        lines += [f"   {'* ' if k == 0 else '  '}- {cell}" for k, cell in enumerate(row)]
    return [*lines, ""]


def code(text: str, language: str) -> list[str]:
    """A block of code."""
    return [f".. code-block:: {language}", "", *indented(text.strip("\n").split("\n")), ""]
