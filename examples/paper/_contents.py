"""The contents of the paper, and what became of each part here: the first table of the report.

`contents.toml` has an entry for every figure, table, group of equations and supplement:

    [[entry]]
    item = "Fig. 6 a"                   what of the paper it is
    claim = "..."                       what the paper says there
    figure = "fig06"                    the figure of `examples/paper` that measures it,
    rows = ["l = 2"]                    by those of its rows that begin so; default: all
    why = { "l = 2 over" = "..." }      causes, for failed rows that begin so and have none

or, in place of figure and rows, `test = "tests/python/test_x.py"`, a test of it that `make test`
runs, `script = "examples/paper/x.py"`, which makes what has no numbers, or `status = "not run"`
with `why = "..."`. `remark` adds a sentence to any.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]

# Failed rows of one cause that the table has in figures; the section of the figure has all.
SHOWN = 3

WORKS, MADE, DIFFERS, NOT_RUN = "works", "can be made", "**differs**", "not run"

# Both are what the report of a full run must not say.
NO_ROW = "no such row"
NO_CAUSE = "no cause is known"


@dataclass
class Entry:
    """A part of the paper; the head of this file says what the fields are."""

    item: str
    claim: str
    figure: str = ""
    rows: list[str] = field(default_factory=list)
    test: str = ""
    script: str = ""
    status: str = ""
    why: str | dict[str, str] = field(default_factory=dict)
    remark: str = ""

    def __post_init__(self):
        named = f"contents.toml: {self.item}"
        known = ("figure", "test", "script", "status")
        kinds = [name for name in known if getattr(self, name)]
        if len(kinds) != 1:
            raise ValueError(f"{named}: need one of {', '.join(known)}, got {kinds or 'none'}")
        if self.status and (self.status != NOT_RUN or not isinstance(self.why, str)):
            raise ValueError(f'{named}: status has to be "{NOT_RUN}", with a why of one sentence')
        if not self.status and not isinstance(self.why, dict):
            raise ValueError(f"{named}: why has to be a table, from beginnings of rows to causes")
        if self.test and not (ROOT / self.test).is_file():
            raise ValueError(f"{named}: there is no test {self.test}")


class Contents:
    """All parts of the paper in its order.

    Parameters
    ----------
    path : path-like, optional
        A TOML file; default: `contents.toml` beside this file.

    Raises
    ------
    ValueError
        An entry that is not as the head of this file says, by its item.
    """

    def __init__(self, path=HERE / "contents.toml"):
        with open(path, "rb") as file:
            tables = tomllib.load(file)["entry"]
        self.entries = []
        for table in tables:
            unknown = sorted(set(table) - set(Entry.__dataclass_fields__))
            if unknown or not {"item", "claim"} <= set(table):
                raise ValueError(
                    f"contents.toml: {table.get('item', table)}: needs item and claim and knows "
                    f"{', '.join(Entry.__dataclass_fields__)}, got {', '.join(table)}"
                )
            self.entries.append(Entry(**table))

    def cause(self, name, row):
        """Why a row of the figure of this name has failed, by its own word or else by the file."""
        found = {
            beginning: cause
            for entry in self.entries
            if entry.figure == name
            for beginning, cause in entry.why.items()
            if row["what"].startswith(beginning)
        }
        return row.get("why") or (found[max(found, key=len)] if found else NO_CAUSE)

    def lines(self, figures, link):
        """The cells of the table: item, claim, status, and where and why.

        Parameters
        ----------
        figures : sequence of dict
            What the scripts wrote.
        link : callable
            From such a dict to the link to its section.

        Returns
        -------
        list of list of str
            One line for each entry, then one for each figure that no entry names.
        """
        known = {figure["name"]: figure for figure in figures}
        lines = []
        for entry in self.entries:
            status, where = self._found(entry, known, link)
            tried = not entry.figure or entry.figure in known
            where += f". {entry.remark}" if entry.remark and tried else ""
            lines.append([entry.item, entry.claim, status, where])
        named = {entry.figure for entry in self.entries}
        for figure in figures:
            if figure["name"] not in named:
                status, where = self._measured(figure, figure["rows"], link)
                lines.append([figure["target"], figure["title"], status, where])
        return lines

    def _found(self, entry, known, link):
        """Status of an entry, and where and why."""
        if entry.status:
            return NOT_RUN, entry.why
        if entry.test:
            return WORKS, f"`{entry.test}`"
        if entry.script:
            made = (ROOT / entry.script).is_file()
            return (MADE, f"`{entry.script}`") if made else (NOT_RUN, f"no `{entry.script}` yet")
        if entry.figure not in known:
            return NOT_RUN, f"the numbers of `{entry.figure}` are not there"
        figure = known[entry.figure]
        chosen = [
            row
            for row in figure["rows"]
            if not entry.rows or any(row["what"].startswith(name) for name in entry.rows)
        ]
        lost = [
            name
            for name in entry.rows
            if not any(row["what"].startswith(name) for row in figure["rows"])
        ]
        status, where = self._measured(figure, chosen, link)
        if lost and figure["quick"]:
            where += f"; not in the quick version: {', '.join(lost)}"
            return status if chosen else NOT_RUN, where
        if lost:
            return NO_ROW, f"{where}; {NO_ROW} in {figure['name']}: {', '.join(lost)}"
        return status, where

    def _measured(self, figure, rows, link):
        """Status of some rows of a figure, and where they are and why they are outside."""
        failed = [row for row in rows if not row["passed"]]
        where = f"{link(figure)}, {len(rows) - len(failed)} of {len(rows)} checks"
        for cause, of_cause in self.causes(figure, failed):
            found = "; ".join(
                f"{row['what']}: {row['measured']}, expected {row['expected']}"
                for row in of_cause[:SHOWN]
            )
            rest = len(of_cause) - SHOWN
            found += f"; and {rest} more of this cause" if rest > 0 else ""
            where += f"<br>{found}. Why: {cause}"
        return DIFFERS if failed else WORKS, where

    def causes(self, figure, failed: Iterable[dict]):
        """Pairs of a cause and the failed rows that have it."""
        groups: dict[str, list[dict]] = {}
        for row in failed:
            groups.setdefault(self.cause(figure["name"], row), []).append(row)
        return groups.items()
