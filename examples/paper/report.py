"""Make the report on the paper from the numbers and pictures that the scripts of its figures wrote.

    python examples/paper/report.py --results out/paper/full --out docs

copies NAME.json and NAME*.png of every figure from the folder of results to OUT/reproduction and
writes OUT/reproduction.md from all that are there then. It begins with every part of the paper and
what became of it, see `_contents.py`. Every number in the report is one that a script has written.
"""

import argparse
import json
import re
import shutil
import sys
from pathlib import Path

from _contents import Contents

INTRODUCTION = """\
# The paper, reproduced

Farnudi, Ejtehadi and Everaers, *Dynamics of fluid bilayer vesicles: Soft meshes and robust
curvature energy discretization*, Phys. Rev. E **108**, 015301 (2023),
[doi:10.1103/PhysRevE.108.015301](https://doi.org/10.1103/PhysRevE.108.015301), computed anew with
this library. `examples/paper/` has a script for each figure.

| command | what it makes | time |
| --- | --- | --- |
| `make paper` | small versions of all figures | some minutes |
| `make paper SIZE=full` | all at the size shown | at most SPENT of one processor core |

Each result is stored as soon as there is one, so either command goes on where it was stopped; only
the timings of Table III are taken anew. Runs are spread over the cores. Times are those of a busy
machine, up to twice those of an idle one; runs that several figures show count in each of them.

This page is written by `examples/paper/report.py` from the numbers of the scripts and from
`examples/paper/contents.toml`, which has what the paper says. "Works" means that all checks are
within their tolerance, or that a test passes, "can be made" that a script draws what has no
numbers; "differs" has the size of the difference and its cause. What is behind the fluctuations,
and which sentences of the paper hold for a mesh that keeps its neighbours and which for a fluid
one, is told in [reproduction_fluctuations.md](reproduction_fluctuations.md).
"""


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--results", type=Path, help="folder of results to take in first")
    parser.add_argument("--out", type=Path, required=True, help="folder of the report")
    options = parser.parse_args()
    folder = options.out / "reproduction"
    folder.mkdir(parents=True, exist_ok=True)
    if options.results:
        take_in(options.results, folder)
    figures = read(folder)
    if not figures:
        sys.exit(f"report: there are no results in {options.results or folder}; run the scripts")
    report = options.out / "reproduction.md"
    report.write_text(written(figures, Contents()), encoding="utf-8")
    print(f"report: {len(figures)} figures in {report}")
    for figure in figures:
        for row in figure["rows"]:
            if not row["passed"]:
                print(
                    f"outside: {figure['name']}: {row['what']}: measured {row['measured']}, "
                    f"expected {row['expected']}"
                )


def read(folder):
    """What the scripts wrote, in the order of the paper."""
    figures = [json.loads(path.read_text(encoding="utf-8")) for path in folder.glob("*.json")]
    return sorted(figures, key=lambda figure: _order(figure["name"]))


def written(figures, contents):
    """The text of the report."""
    sections = [section(figure, contents) for figure in figures]
    quick = any(figure["quick"] for figure in figures)
    spent = "hours" if quick else _time(_spent(figures))
    introduction = INTRODUCTION.replace("SPENT", spent)
    return "\n".join([introduction, paper(figures, contents), summary(figures), *sections])


def take_in(results, folder):
    """Copy the numbers and the pictures of each figure."""
    for path in sorted(results.glob("*.json")):
        figure = json.loads(path.read_text(encoding="utf-8"))
        before = folder / path.name
        if before.exists():
            for picture in json.loads(before.read_text(encoding="utf-8"))["pictures"]:
                (folder / picture["file"]).unlink(missing_ok=True)
        shutil.copy(path, folder)
        for picture in figure["pictures"]:
            shutil.copy(results / picture["file"], folder)


def paper(figures, contents):
    """A table with a line for each part of the paper."""

    def link(figure):
        return f"[{figure['target']}](#{_anchor(figure)})"

    lines = ["| of the paper | what it says | here | where, and why |", "| --- | --- | --- | --- |"]
    return "\n".join(lines + [_row(line) for line in contents.lines(figures, link)]) + "\n"


def summary(figures):
    """A table with a line for each figure."""
    lines = ["## The figures", ""]
    lines += [
        "| figure | shown | checks within tolerance | run time |",
        "| --- | --- | --- | --- |",
    ]
    for figure in figures:
        passed = sum(row["passed"] for row in figure["rows"])
        lines.append(
            f"| [{figure['target']}](#{_anchor(figure)}) | {figure['title']} | "
            f"{passed} of {len(figure['rows'])} | {_time(figure['seconds'])} |"
        )
    return "\n".join(lines) + "\n"


def section(figure, contents):
    """The part of the report on one figure."""
    size = " (quick version)" if figure["quick"] else ""
    lines = [f"## {figure['target']}: {figure['title']}{size}", "", figure["parameters"]]
    for picture in figure["pictures"]:
        lines += ["", f"![{picture['caption']}](reproduction/{picture['file']})"]
        lines += ["", f"*{picture['caption']}*"]
    lines += ["", "| quantity | measured | expected | verdict |", "| --- | --- | --- | --- |"]
    for row in figure["rows"]:
        verdict = "within" if row["passed"] else "**outside**"
        lines.append(_row([row["what"], row["measured"], row["expected"], verdict]))
    failed = [row for row in figure["rows"] if not row["passed"]]
    for cause, rows in contents.causes(figure, failed):
        lines += ["", f"Outside: {'; '.join(row['what'] for row in rows)}. Why: {cause}"]
    lines += ["", *(f"- {note}" for note in figure["notes"])]
    for table in figure["tables"]:
        lines += ["", table["caption"], "", _row(table["header"])]
        lines += [_row("---" for _ in table["header"]), *map(_row, table["rows"])]
    lines += ["", f"Script: `examples/paper/{_script(figure)}`, {_time(figure['seconds'])}.", ""]
    return "\n".join(lines)


def _row(cells):
    """A line of a Markdown table."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _script(figure):
    """The script of that name, which differs from others that begin alike by what follows."""
    scripts = sorted(Path(__file__).parent.glob(f"{figure['name']}_*.py"))
    if not scripts:
        sys.exit(
            f"report: there is no script examples/paper/{figure['name']}_*.py of these numbers"
        )
    return min((script.name for script in scripts), key=len)


def _anchor(figure):
    heading = f"{figure['target']}: {figure['title']}"
    heading += " (quick version)" if figure["quick"] else ""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _time(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def _spent(figures):
    """Time of all figures, with that of runs which several of them show in each."""
    return sum(figure["seconds"] for figure in figures)


def _order(name):
    """The paper's figures first, by number, then its tables, its supplement, and the rest."""
    kinds = ("fig", "tab", "sm")
    found = re.match(r"([a-z]+)(\d*)(.*)", name)
    kind, number, rest = found.groups() if found else ("", "", name)
    place = kinds.index(kind) if kind in kinds else len(kinds)
    return place, int(number or 0), rest, name


if __name__ == "__main__":
    main()
