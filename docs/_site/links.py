"""Links to files outside of docs/, and from the name of each class to its page."""

from __future__ import annotations

import re
from pathlib import Path

from docutils import nodes
from openmmhelfrich.forces import __all__ as force_names

from .rst import prose

ROOT = Path(__file__).parents[2]

#: The pages that show files of the root folder, or parts of them.
_PAGES = {
    "README.md#forces": "forces/index.rst",
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "ARCHITECTURE.md": "architecture.md",
}


def setup(app) -> None:
    """Connect what follows."""
    app.connect("source-read", _lead_to_pages)
    app.connect("include-read", lambda app, path, page, content: _lead_to_pages(app, page, content))
    app.connect("autodoc-process-docstring", _read_docstring)
    app.connect("doctree-resolved", _link_names)


def _lead_to_pages(app, page: str, content: list[str]) -> None:
    """Let links to files of the root folder lead to the pages that show them."""
    text = content[0]
    for file, target in _PAGES.items():
        text = re.sub(rf"\]\((?:\.\./)?{re.escape(file)}\)", f"]({target})", text)
    # Of a file that is shown here links are as seen from the root folder; folders have no page.
    text = re.sub(r"\]\(docs/", "](", text)
    content[0] = re.sub(r"\[([^]]+)\]\((?![a-z]+:)[\w/]+/\)", r"`\1`", text)


def _read_docstring(app, what, name, thing, options, lines) -> None:
    """Read what SWIG wrote, which has no markup; that of a class is on its page already."""
    owner, _, last = name.rpartition(".")
    if what == "class" and last in force_names:
        lines[:] = []
    elif owner.rpartition(".")[2] in force_names and "-----" not in (thing.__doc__ or ""):
        lines[:] = prose("\n".join(line for line in lines if not line.startswith(":type ")))
    else:
        # Bars are magnitudes here.
        lines[:] = [re.sub(r"(`+[^`]*`+)|\|", lambda m: m[1] or r"\|", line) for line in lines]


def _link_names(app, tree: nodes.document, page: str) -> None:
    """Let `BendingForce` and `Mesh.read` lead to where they are documented."""
    known = app.env.get_domain("py").objects
    for literal in list(tree.findall(nodes.literal)):
        name = literal.astext().removeprefix("helfrich.").removesuffix("()")
        entry = known.get(f"openmmhelfrich.{name}")
        if entry is None or isinstance(literal.parent, (nodes.reference, nodes.title)):
            continue
        target = app.builder.get_relative_uri(page, entry.docname)
        here = nodes.reference("", "", refuri=f"{target}#{entry.node_id}", internal=True)
        literal.replace_self(here)
        here += literal
