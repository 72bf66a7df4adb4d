"""Tutorials are found, run with what users may call, and end with a picture.

That they run at all is for the build of the site, `make docs`, which executes them.
"""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import openmmhelfrich as helfrich
import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
PACKAGE = "openmmhelfrich"
DRAWS = {"figure", "subplots"}  # of pyplot


def cells_of(text: str) -> list[ast.Module]:
    """The cells of a notebook as syntax trees."""
    found = re.findall(r"^```\{code-cell\} ipython3\n([\s\S]*?)^```$", text, re.M)
    return [ast.parse(cell) for cell in found]


def imports_of(cells: list[ast.Module]) -> dict[str, str]:
    """What the package's modules and objects are called: their full names by their names here."""
    found = {}
    for node in (n for cell in cells for n in ast.walk(cell)):
        if isinstance(node, ast.Import):
            found |= {a.asname or a.name: a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {a.asname or a.name: f"{node.module}.{a.name}" for a in node.names}
    return {here: full for here, full in found.items() if full.split(".")[0] == PACKAGE}


def private_names(cells: list[ast.Module]) -> set[str]:
    """Names of a leading underscore that are imported or taken from an object."""
    taken = {n.attr for c in cells for n in ast.walk(c) if isinstance(n, ast.Attribute)}
    imported = {part for full in imports_of(cells).values() for part in full.split(".")}
    return {name for name in taken | imported if name.startswith("_")}


def draws(cell: ast.Module) -> bool:
    """Whether pyplot makes a figure here, and something is drawn on its axes."""
    calls = [n.func for n in ast.walk(cell) if isinstance(n, ast.Call)]
    methods = {f.attr for f in calls if isinstance(f, ast.Attribute)}
    return bool(methods & DRAWS) and bool(methods & {"plot", "errorbar", "plot_trisurf"})


@pytest.fixture(params=TUTORIALS, ids=lambda path: path.stem)
def tutorial(request) -> Path:
    return request.param


def test_there_are_tutorials_and_the_toctree_has_them_all():
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    listed = re.findall(r"^tutorials/(\w+)$", index, re.M)
    assert len(listed) == len(TUTORIALS) == 8
    assert sorted(listed) == [path.stem for path in TUTORIALS]


def test_ends_with_a_picture_and_what_to_change(tutorial):
    text = tutorial.read_text(encoding="utf-8")
    assert draws(cells_of(text)[-1])
    *_, last = re.findall(r"^## (.*)$", text, re.M)
    assert last == "What to change for a real run"


def test_uses_public_names_that_are_there(tutorial):
    cells = cells_of(tutorial.read_text(encoding="utf-8"))
    assert not private_names(cells)
    names = imports_of(cells)
    assert names
    for node in (n for cell in cells for n in ast.walk(cell)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            full = names.get(node.value.id)
            if full is not None:
                assert hasattr(resolved(full), node.attr), f"{full}.{node.attr}"


def resolved(full: str):
    """The module or object of a full name."""
    try:
        return importlib.import_module(full)
    except ImportError:
        module, _, name = full.rpartition(".")
        return getattr(importlib.import_module(module), name)


def test_what_is_wrong_is_found():
    bad = cells_of(
        "```{code-cell} ipython3\nfrom openmmhelfrich._core import library\n```\n"
        "```{code-cell} ipython3\nmesh._vertices\nfigure, axes = plt.subplots()\n```\n"
    )
    assert private_names(bad) == {"_core", "_vertices"}
    assert not draws(bad[-1])
    good = cells_of("```{code-cell} ipython3\nfrom openmmhelfrich import Mesh\n```\n")
    assert resolved(imports_of(good)["Mesh"]) is helfrich.Mesh
