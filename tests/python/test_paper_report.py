"""The report on the paper: all of its parts are there, each with what became of it and why."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAPER = ROOT / "examples" / "paper"
PAGE = ROOT / "docs" / "reproduction.md"

FIGURES = [f"Fig. {number}" for number in (*range(1, 12), *range(16, 20))]
EQUATIONS = ["20", *range(34, 40), *range(43, 49)]
APPENDIX = [*range(7, 13), 16, 17, 18, 30, 34, *range(35, 40)]
PARTS = {
    *FIGURES,
    *(f"Eq. {number}" for number in EQUATIONS),
    *(f"Eq. A{number}" for number in APPENDIX),
    "Table III",
    *(f"SM {number}" for number in (3, 4, 6, 7, 8, 9)),
    *(f"SM 5 {panel}" for panel in "abc"),
    "SM IV",
    "Six movies",
}


pytestmark = pytest.mark.usefixtures("paper_scripts")


def parts_of(item: str) -> set[str]:
    """Fig. 6 a–c, Eqs. 34, A35–A37 → Fig. 6, Eq. 34, Eq. A35 …"""
    found: set[str] = set()
    kind = ""
    for piece in item.split(", "):
        match = re.fullmatch(
            r"(?:(Fig|Eq)s?\. |(SM ))?(A?)(\d+)(?: [a-f](?:–[a-f])?)?(?:–A?(\d+))?", piece
        )
        if match and not piece.startswith("SM 5"):
            kind = f"{match[1]}. " if match[1] else match[2] or kind
            first, last = int(match[4]), int(match[5] or match[4])
            found |= {f"{kind}{match[3]}{number}" for number in range(first, last + 1)}
        else:
            found.add(piece)
    return found


def figure(name: str, *rows: dict, quick: bool = False) -> dict:
    return {
        "name": name,
        "target": f"The target {name}",
        "title": "Title",
        "quick": quick,
        "rows": list(rows),
    }


def row(what: str, passed: bool = True, **more: str) -> dict:
    return {"what": what, "measured": "3 ± 1", "expected": "7 ± 1", "passed": passed, **more}


def contents_of(path: Path, text: str):
    from _contents import Contents

    path.joinpath("contents.toml").write_text(text, encoding="utf-8")
    return Contents(path / "contents.toml")


def lines_of(path: Path, text: str, *figures: dict) -> list[list[str]]:
    return contents_of(path, text).lines(figures, lambda one: f"[{one['name']}]")


def test_the_page_is_what_the_report_writes_of_the_committed_numbers():
    import report
    from _contents import Contents

    figures = report.read(PAGE.with_suffix(""))
    assert len(figures) >= 15
    assert not any(one["quick"] for one in figures)
    # Else run: python examples/paper/report.py --out docs
    assert PAGE.read_text(encoding="utf-8") == report.written(figures, Contents())


def test_the_page_leaves_no_row_without_its_numbers_and_no_failure_without_a_cause():
    from _contents import NO_CAUSE, NO_ROW

    text = PAGE.read_text(encoding="utf-8")
    assert NO_ROW not in text
    assert NO_CAUSE not in text


def test_all_parts_of_the_paper_are_in_the_contents():
    from _contents import Contents

    items = [entry.item for entry in Contents().entries]
    assert len(set(items)) == len(items)
    listed = set().union(*map(parts_of, items))
    assert PARTS - listed == set()


def test_statuses_are_those_of_the_rows(tmp_path):
    text = """
[[entry]]
item = "Fig. 1"
claim = "one"
figure = "fig01"
rows = ["a, "]

[[entry]]
item = "Fig. 2"
claim = "two"
figure = "fig01"
remark = "And so on"
why = { "b" = "short", "b, 2" = "long" }

[[entry]]
item = "Eq. 3"
claim = "three"
test = "tests/python/test_paper_report.py"

[[entry]]
item = "SM 4"
claim = "four"
status = "not run"
why = "too large"

[[entry]]
item = "SM 5"
claim = "five"
figure = "sm05"
"""
    rows = [row("a, 1"), row("b, 1", False), row("b, 2", False), row("b, 3", False, why="its own")]
    found = lines_of(tmp_path, text, figure("fig01", *rows), figure("sm99", row("c", False)))
    assert [line[:3] for line in found] == [
        ["Fig. 1", "one", "works"],
        ["Fig. 2", "two", "**differs**"],
        ["Eq. 3", "three", "works"],
        ["SM 4", "four", "not run"],
        ["SM 5", "five", "not run"],
        # Numbers that no entry names are in the table all the same.
        ["The target sm99", "Title", "**differs**"],
    ]
    where = [line[3] for line in found]
    assert where[0] == "[fig01], 1 of 1 checks"
    assert where[1] == (
        "[fig01], 1 of 4 checks<br>b, 1: 3 ± 1, expected 7 ± 1. Why: short"
        "<br>b, 2: 3 ± 1, expected 7 ± 1. Why: long"
        "<br>b, 3: 3 ± 1, expected 7 ± 1. Why: its own. And so on"
    )
    assert where[2:5] == [
        "`tests/python/test_paper_report.py`",
        "too large",
        "the numbers of `sm05` are not there",
    ]
    assert where[5].endswith("Why: no cause is known")


def test_many_failures_of_one_cause_are_counted(tmp_path):
    text = '[[entry]]\nitem = "I"\nclaim = "c"\nfigure = "fig01"\nwhy = { "r" = "so" }\n'
    rows = [row(f"r{number}", False) for number in range(5)]
    [line] = lines_of(tmp_path, text, figure("fig01", *rows))
    assert "r2: 3 ± 1, expected 7 ± 1; and 2 more of this cause. Why: so" in line[3]
    assert "r3" not in line[3]


def test_rows_that_are_not_there_are_named(tmp_path):
    text = '[[entry]]\nitem = "I"\nclaim = "c"\nfigure = "fig01"\nrows = ["a", "gone"]\n'
    [line] = lines_of(tmp_path, text, figure("fig01", row("a"), row("b", False)))
    assert line[2:] == ["no such row", "[fig01], 1 of 1 checks; no such row in fig01: gone"]
    # A small version has fewer.
    [line] = lines_of(tmp_path, text, figure("fig01", row("a"), quick=True))
    assert line[2:] == ["works", "[fig01], 1 of 1 checks; not in the quick version: gone"]
    [line] = lines_of(tmp_path, text, figure("fig01", row("b", False), quick=True))
    assert line[2] == "not run"


def test_scripts_that_are_there_or_not(tmp_path):
    for script, status, where in (
        ("examples/paper/report.py", "can be made", "`examples/paper/report.py`"),
        ("examples/paper/none.py", "not run", "no `examples/paper/none.py` yet"),
    ):
        text = f'[[entry]]\nitem = "I"\nclaim = "c"\nscript = "{script}"\n'
        [line] = lines_of(tmp_path, text)
        assert line[2:] == [status, where]


@pytest.mark.parametrize(
    ("text", "culprit"),
    [
        ("", "I: need one of figure, test, script, status, got none"),
        ('figure = "fig01"\ntest = "x"', r"I: need one of .* got \['figure', 'test'\]"),
        ('status = "works"\nwhy = "so"', 'I: status has to be "not run"'),
        ('status = "not run"\nwhy = { a = "b" }', 'I: status has to be "not run", with a why'),
        ('figure = "fig01"\nwhy = "so"', "I: why has to be a table"),
        ('test = "tests/python/none.py"', "I: there is no test tests/python/none.py"),
        ('test = "README.md"\nrow = ["a"]', "I: needs item and claim and knows .* got item, claim"),
    ],
)
def test_entries_that_are_wrong_are_named(tmp_path, text, culprit):
    with pytest.raises(ValueError, match=rf"contents\.toml: {culprit}"):
        contents_of(tmp_path, f'[[entry]]\nitem = "I"\nclaim = "c"\n{text}\n')


def test_figures_are_in_the_order_of_the_paper():
    from report import _order

    names = ["fig01", "fig04", "fig04b", "fig04d", "fig05", "fig06", "fig06b", "fig06c", "fig09_10"]
    names += ["fig11", "fig16", "tab03", "sm03", "sm04", "sm05", "sm09", "sm10", "extra"]
    assert sorted(reversed(names), key=_order) == names
