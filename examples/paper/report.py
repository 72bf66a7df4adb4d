"""Make the report of the paper's figures from the numbers and pictures that their scripts wrote.

    python examples/paper/report.py --results out/paper/full --out docs

copies NAME.json and NAME*.png of every figure from the folder of results to OUT/reproduction and
writes OUT/reproduction.md from all that are there then. Every number in the report is one that a
script has written.
"""

import argparse
import json
import re
import shutil
import sys
from pathlib import Path

INTRODUCTION = """\
# The paper, reproduced

The figures of Farnudi, Ejtehadi and Everaers, *Dynamics of fluid bilayer vesicles: Soft meshes and
robust curvature energy discretization*, Phys. Rev. E **108**, 015301 (2023),
[doi:10.1103/PhysRevE.108.015301](https://doi.org/10.1103/PhysRevE.108.015301), computed anew with
this library. `examples/paper/` has a script for each; `--quick` makes a small version in seconds to
minutes, `make paper` all of these; without it a script has the size shown here. This page is
written by `examples/paper/report.py` from the numbers of the scripts; what is behind those of the
fluctuations, and why some lie outside, is told in
[reproduction_fluctuations.md](reproduction_fluctuations.md). Times are those of one processor core,
on a busy machine, where they are up to twice those of an idle one; figures that show the same runs
have the same time.
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
    figures = [json.loads(path.read_text(encoding="utf-8")) for path in folder.glob("*.json")]
    if not figures:
        sys.exit(f"report: there are no results in {options.results or folder}; run the scripts")
    figures.sort(key=lambda figure: _order(figure["name"]))
    text = "\n".join([INTRODUCTION, summary(figures), *map(section, figures)])
    report = options.out / "reproduction.md"
    report.write_text(text, encoding="utf-8")
    print(f"report: {len(figures)} figures in {report}")
    for figure in figures:
        for row in figure["rows"]:
            if not row["passed"]:
                print(
                    f"outside: {figure['name']}: {row['what']}: measured {row['measured']}, "
                    f"expected {row['expected']}"
                )


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


def summary(figures):
    """A table with a line for each figure."""
    lines = ["| figure | shown | checks within tolerance | run time |", "| --- | --- | --- | --- |"]
    for figure in figures:
        passed = sum(row["passed"] for row in figure["rows"])
        lines.append(
            f"| [{figure['target']}](#{_anchor(figure)}) | {figure['title']} | "
            f"{passed} of {len(figure['rows'])} | {_time(figure['seconds'])} |"
        )
    return "\n".join(lines) + "\n"


def section(figure):
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
    [script] = Path(__file__).parent.glob(f"{figure['name']}_*.py")
    return script.name


def _anchor(figure):
    heading = f"{figure['target']}: {figure['title']}"
    heading += " (quick version)" if figure["quick"] else ""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _time(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def _order(name):
    """Figures of the paper first, by number, then its tables, then what is in its supplement."""
    return (("fig", "tab", "sm0").index(name[:3]), name)


if __name__ == "__main__":
    main()
