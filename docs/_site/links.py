"""Links to files outside of docs/, and from the name of each class to its page."""

from __future__ import annotations

import re

import openmmhelfrich
from docutils import nodes
from openmmhelfrich.forces import __all__ as force_names
from sphinx.util import logging

from .rst import prose

_LOGGER = logging.getLogger(__name__)

#: The pages that show files of the root folder, or parts of them.
_PAGES = {
    "README.md#forces": "forces/index.rst",
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "ARCHITECTURE.md": "architecture.md",
    "wrappers/include/OpenMMHelfrich.h": "api/cpp.rst",
    "wrappers/include/OpenMMHelfrichCWrapper.h": "api/c.rst",
}

#: What Rustdoc makes of files of the crate; it is added when all else is done.
_RUSTDOC = {
    "src/lib.rs": "rust/openmm_helfrich/index.html",
    "src/force.rs": "rust/openmm_helfrich/force/index.html",
}


def setup(app) -> None:
    """Connect what follows."""
    app.connect("source-read", _lead_to_pages)
    app.connect("include-read", lambda app, path, page, content: _lead_to_pages(app, page, content))
    app.connect("autodoc-process-docstring", _read_docstring)
    app.connect("env-check-consistency", _miss_no_name)
    app.connect("doctree-resolved", _link_names)
    app.connect("doctree-resolved", _name_pages)


def _lead_to_pages(app, page: str, content: list[str]) -> None:
    """Let links to files of the root folder lead to the pages that show them."""
    text = content[0]
    for file, target in _PAGES.items():
        text = re.sub(rf"\]\((?:\.\./)?{re.escape(file)}\)", f"]({target})", text)
    for file, target in _RUSTDOC.items():
        link = rf'<a href="{target}">\1</a>'
        text = re.sub(rf"\[([^]]+)\]\(\.\./{re.escape(file)}\)", link, text)
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


def _miss_no_name(app, env) -> None:
    """Warn of what the package has and no page documents."""
    known = env.get_domain("py")
    for name in map("openmmhelfrich.{}".format, openmmhelfrich.__all__):
        if name not in known.objects and name not in known.modules:
            _LOGGER.warning("no page documents %s", name, location="python")


def _name_pages(app, tree: nodes.document, page: str) -> None:
    """Let links that show a file, as GitHub has it, show the title of the page."""
    for link in tree.findall(nodes.reference):
        match = re.fullmatch(r"(?:docs/)?(\w+)\.md", link.astext())
        if match and link.get("internal") and match[1] in app.env.titles:
            link.children = [nodes.inline("", app.env.titles[match[1]].astext())]


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
