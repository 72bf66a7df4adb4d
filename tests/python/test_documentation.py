"""What the documentation shows is so: code runs, TOML is read, commands and options exist.

Every fenced block of README.md, CONTRIBUTING.md, docs/*.md and docs/tutorials/*.md has a language;
cells of the tutorials, {code-cell}, run when the site is built. Comments in front of
one, which pages do not show, say what it needs:

    <!-- test: before           lines of Python that are run first, up to the end of the comment
    <!-- test: instead of A => B   in Python, text that is replaced, such as a number of steps
    <!-- test: saved as NAME    of TOML, the name of the file in the folder of the page
    <!-- test: added to a vesicle   of TOML, a part of a configuration
    <!-- test: not run, REASON  what cannot be tried here; pytest's summary lists these
"""

from __future__ import annotations

import re
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path

import click
import matplotlib.pyplot as plt
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich.cli import main

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs" / "tutorials").glob("*.md")),
]
LANGUAGES = {"python", "toml", "sh", "text"}
VESICLE = "simulation.duration = 1\n\n[[vesicle]]\nmesh = { icosphere = 2, radius = 30 }\n\n"

_COMMENT = r"<!-- test: (?:(?!-->)[\s\S])*?-->\n\n?"
_BLOCK = re.compile(
    rf"(?P<notes>(?:{_COMMENT})*)^```(?P<language>.*)\n(?P<body>[\s\S]*?)^```$", re.M
)


@dataclass(frozen=True)
class Block:
    """A fenced block, and the comments in front of it by their first words."""

    page: Path
    line: int
    language: str
    body: str
    notes: tuple[tuple[str, str], ...]

    @property
    def where(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    def note(self, word: str) -> str | None:
        return next((text for kind, text in self.notes if kind == word), None)


KINDS = ("before", "instead of", "saved as", "added to a vesicle", "not run,")


def blocks_of(page: Path) -> list[Block]:
    text, found = page.read_text(encoding="utf-8"), []
    for match in _BLOCK.finditer(text):
        notes = []
        for note in re.findall(r"<!-- test: ([\s\S]*?)-->", match["notes"]):
            kind = next((k for k in KINDS if note.startswith(k)), None)
            assert kind, f"{page.name}: unknown comment {note!r}"
            notes.append((kind, note.removeprefix(kind).strip(" ") if kind != "before" else note))
        line = text.count("\n", 0, match.start("language")) + 1
        found.append(Block(page, line, match["language"], match["body"], tuple(notes)))
    assert sum(line.startswith("<!-- test:") for line in text.split("\n")) == sum(
        len(b.notes) for b in found
    )
    return found


BLOCKS = [block for page in PAGES for block in blocks_of(page)]


def of(language: str) -> list:
    chosen = [b for b in BLOCKS if b.language == language]
    return [pytest.param(b, id=b.where) for b in chosen]


def skip_if_not_run(block: Block) -> None:
    if (reason := block.note("not run,")) is not None:
        pytest.skip(f"{block.where}: {reason.strip()}")


def test_every_block_has_a_language():
    # Those in braces are Sphinx's own, as in ```{toctree}.
    others = [b.where for b in BLOCKS if b.language not in LANGUAGES and b.language[:1] != "{"]
    assert not others
    indented = [
        f"{page.name}: {line}"
        for page in PAGES
        for line in page.read_text(encoding="utf-8").split("\n")
        if re.match(r"    (openmm-helfrich|make|pip) ", line)
    ]
    assert not indented


def with_code() -> list:
    pages = dict.fromkeys(b.page for b in BLOCKS if b.language == "python")
    return [pytest.param(page, id=page.stem) for page in pages]


@pytest.mark.parametrize("page", with_code())
def test_python(page, tmp_path, monkeypatch):
    """The blocks of a page run one after the other, in one namespace and a folder of their own."""
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("Agg")
    for block in blocks_of(page):
        if (name := block.note("saved as")) is not None:
            Path(name.strip()).write_text(block.body, encoding="utf-8")
    space: dict = {"__name__": "__main__"}
    for block in blocks_of(page):
        if block.language == "python" and not block.note("not run,"):
            for kind, text in block.notes:
                if kind == "before":
                    code = text.removeprefix("before")
                    exec(compile(code, f"before {block.where}", "exec"), space)
            execute(block, space)
    plt.close("all")


def execute(block: Block, space: dict) -> None:
    """Run a block of Python in a namespace, with what its comments say instead of some texts."""
    code = block.body
    for old, new in (t.strip().split(" => ") for kind, t in block.notes if kind == "instead of"):
        assert old in code, f"{block.where}: there is no {old}"
        code = code.replace(old, new)
    # Errors name the lines of the page.
    exec(compile("\n" * block.line + code, str(block.page), "exec"), space)


@pytest.mark.parametrize("block", of("toml"))
def test_toml(block, tmp_path):
    skip_if_not_run(block)
    part = block.note("added to a vesicle") is not None
    path = tmp_path / "page.toml"
    path.write_text((VESICLE if part else "") + block.body, encoding="utf-8")
    assert helfrich.config.read(path).system().getNumForces() > 2


def commands(block: Block) -> list[list[str]]:
    """The words of each command, without comments and variables of the environment."""
    lines = block.body.replace("\\\n", " ").split("\n")
    split = [shlex.split(line, comments=True) for line in lines if line.strip()]
    return [[w for k, w in enumerate(words) if not is_variable(words[: k + 1])] for words in split]


def is_variable(words: list[str]) -> bool:
    return all(re.match(r"[A-Z_]+=", word) for word in words)


@pytest.mark.parametrize("block", of("sh"))
def test_commands(block):
    skip_if_not_run(block)
    assert commands(block)
    for words in commands(block):
        check(words, block.where)


def check(words: list[str], where: str, whole: bool = True) -> None:
    """A command is there, with its target, script, extra or options.

    In a sentence it need not be whole.
    """
    program, *arguments = words
    if program == "make":
        makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
        for target in (a for a in arguments if "=" not in a):
            assert re.search(rf"^{target}:", makefile, re.M), f"{where}: make has no {target}"
    elif program == "pip":
        pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        assert arguments[0] == "install"
        for extra in re.findall(r"[\w-]+", arguments[1].partition("[")[2]):
            assert extra in pyproject["optional-dependencies"], f"{where}: no extra {extra}"
    elif program in ("bash", ".venv/bin/python"):
        assert (ROOT / arguments[0]).is_file(), f"{where}: there is no {arguments[0]}"
    elif program == "openmm-helfrich":
        check_options(main, arguments, where, whole)
    else:
        raise AssertionError(f"{where}: {program} is no command that is known here")


def check_options(command: click.Command, arguments: list[str], where: str, whole: bool) -> None:
    context = click.Context(command)
    if isinstance(command, click.Group) and arguments and not arguments[0].startswith("-"):
        found = command.get_command(context, arguments[0])
        assert found is not None, f"{where}: there is no command {arguments[0]}"
        return check_options(found, arguments[1:], where, whole)
    try:
        _, rest, _ = command.make_parser(context).parse_args(list(arguments))
    except click.UsageError as error:
        # Of a bad usage the option is there, but its value is not.
        if whole or not isinstance(error, click.BadOptionUsage):
            raise AssertionError(f"{where}: {error.format_message()}") from None
        return
    assert not rest, f"{where}: {command.name} does not take {rest}"


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda page: page.stem)
def test_commands_in_the_text(page):
    for text in re.findall(r"`(openmm-helfrich [^`]+)`", page.read_text(encoding="utf-8")):
        check(shlex.split(text), f"{page.name}: {text}", whole=False)


def test_a_wrong_block_is_found():
    with pytest.raises(AssertionError, match="--backwards"):
        check(["openmm-helfrich", "run", "a.toml", "--backwards"], "here")
    for words in (["make", "coffee"], ["pip", "install", ".[coffee]"], ["brew", "coffee"]):
        with pytest.raises(AssertionError, match="here"):
            check(words, "here")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_to_files_of_the_repository(page):
    """Pages are read where there is no site, too: none of what a build makes is linked."""
    made = ROOT / "docs" / "forces", ROOT / "docs" / "api"
    text = re.sub(r"^```[\s\S]*?^```", "", page.read_text(encoding="utf-8"), flags=re.M)
    for link in re.findall(r"\]\((?!<?https?:)([^)#]+)", text):
        target = (page.parent / link).resolve()
        assert target.exists(), link
        assert not any(folder in target.parents for folder in made), link


def sources() -> str:
    """All texts of the sources, with messages of several lines in one."""
    files = [
        *(ROOT / "src").rglob("*.rs"),
        *(ROOT / "python" / "openmmhelfrich").rglob("*.py"),
        *(ROOT / "wrappers").rglob("*.[hc]*"),
    ]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    text = re.sub(r'"\s*\n\s*(//.*\n\s*)*f?"', "", text)
    return re.sub(r"\\\n\s*", "", text)


@pytest.mark.parametrize("name", ["troubleshooting", "installation"])
def test_messages_are_those_of_the_package(name):
    """What a table of messages has in its first column is in the sources, but OpenMM's own."""
    text, known = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8"), sources()
    tables = [part.split("\n\n")[0] for part in text.split("| message |")[1:]]
    cells = [row.split("|")[1] for table in tables for row in table.split("\n")[2:] if row]
    messages = [m for cell in cells for m in re.findall(r"(?<!OpenMM's )`([^`]+)`", cell)]
    assert len(messages) > 1
    missing = [m for m in messages if m != "make" and m not in known]
    assert not missing


def test_architecture_names_what_there_is():
    """Paths end like those of files or folders; other names are words of the sources."""
    text = re.sub(
        r"^```[\s\S]*?^```", "", (ROOT / "ARCHITECTURE.md").read_text("utf-8"), flags=re.M
    )
    tops = [".ci", "benches", "docs", "examples", "python", "shaders", "src", "tests", "wrappers"]
    below = [path for top in tops for path in (ROOT / top).rglob("*")]
    paths = {f"/{path.relative_to(ROOT).as_posix()}" for path in [*below, *ROOT.iterdir()]}
    build = [ROOT / "build.rs", *(ROOT / "shaders").rglob("*.rs"), *(ROOT / "python").glob("*.i")]
    words = sources() + "".join(path.read_text(encoding="utf-8") for path in build)
    names = [name for name in re.findall(r"`([^`]+)`", text) if "our_term" not in name]
    names = [name for name in names if "YourTermForce" not in name]
    made = ["NativeCodes.h", ".venv/bin/python"]
    assert len(names) > 100

    def is_there(name: str) -> bool:
        if re.search(r"/|\.(rs|h|cpp|py|pyi|i|md)$", name) and name not in made:
            return any(path.endswith(f"/{name.strip('/')}") for path in paths)
        return all(re.search(rf"\b{word}\b", words) for word in re.findall(r"\w+", name))

    assert [word for name in names for word in name.split() if not is_there(word)] == []


def test_citation_names_the_version():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {helfrich.__version__}\n" in citation
