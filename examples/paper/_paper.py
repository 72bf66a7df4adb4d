"""What the figures of the paper share: their command line, their sweeps, and what they report.

A script makes one `Figure`, runs its sweeps through it, checks numbers against what is expected and
calls `finish`, which prints the table, writes it beside the picture in the folder of results, and
ends the script with status 3 if a number lies outside its tolerance. `report.py` makes the report
of these files.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path

import numpy as np
from openmmhelfrich.sweep import SweepError, sweep

SCHEMES = {
    "Julicher": "Jülicher (J)",
    "GompperKroll": "Gompper–Kroll (GK)",
    "GompperKrollBarycentric": "GK barycentric (GKB)",
    "JulicherVoronoi": "Jülicher–Voronoi (JV)",
}
"""The four bending models of the paper, by the names of `BendingForce`'s constants."""


# Exit status of a script that ran to its end and found a number outside its tolerance. That of a
# script that failed is 1, that of a wrong command line 2.
OUTSIDE = 3

# Exit status of a script that needs files which are not there.
MISSING = 4


class Figure:
    """One figure of the paper.

    Parameters
    ----------
    name : str
        Of the files, such as "fig04".
    target : str
        What of the paper it is, such as "Fig. 4".
    title : str
        One line, without a full stop.
    description : str
        The help text of the command line; the docstring of the script.
    arguments : list of str, optional
        The command line; default: that of the script.
    """

    def __init__(self, name, target, title, description, arguments=None):
        parser = argparse.ArgumentParser(
            description=description, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        parser.add_argument(
            "--quick", action="store_true", help="smaller and fewer runs, seconds to minutes"
        )
        parser.add_argument(
            "--results",
            type=Path,
            help="folder of stored results, pictures, numbers (default: out/paper/SIZE)",
        )
        parser.add_argument(
            "--plot-only", action="store_true", help="draw and check again what is stored"
        )
        where = parser.add_mutually_exclusive_group()
        where.add_argument(
            "--scheduler", metavar="ADDRESS", help="of a running Dask scheduler, tcp://host:port"
        )
        where.add_argument(
            "--workers",
            type=int,
            help="processes on this machine (default: one for each core; 0: without Dask)",
        )
        options = parser.parse_args(arguments)
        if options.workers is not None and options.workers < 0:
            parser.error(f"--workers: need 0 or more, got {options.workers}")
        self.name, self.target, self.title = name, target, title
        self.quick = options.quick
        self.results = options.results or Path("out/paper") / ("quick" if self.quick else "full")
        self._options = options
        self._rows: list[dict] = []
        self._notes: list[str] = []
        self._tables: list[dict] = []
        self._parameters = ""
        self._pictures: list[dict] = []
        self._seconds = 0.0

    @property
    def plot_only(self):
        """Whether nothing is to be computed."""
        return self._options.plot_only

    def choose(self, full, quick):
        """One of two values, of the full size or of the quick one."""
        return quick if self.quick else full

    def check_same(self, what, one, other, why=""):
        """Check that two values, each with its standard error, differ by three errors at most."""
        (value, error), (reference, its_error) = one, other
        both = np.hypot(error, its_error)
        return self.check(what, value - reference, 0, 3 * both, both, why=why)

    def sweep(self, function, points, version=1, description=None):
        """The results of a function at points, stored in the folder of results."""
        try:
            results = sweep(
                function,
                points,
                cache=self.results / "cache",
                version=version,
                scheduler=self._options.scheduler,
                workers=self._options.workers,
                description=description,
                compute=not self._options.plot_only,
            )
        except KeyboardInterrupt:
            sys.exit(f"{self.name}: interrupted; run it again to go on from here")
        except (SweepError, OSError, ImportError) as error:
            sys.exit(f"{self.name}: {error}")
        self._seconds += sum(result["seconds"] for result in results)
        return results

    def spent(self, seconds):
        """Count the time of what was computed without a sweep."""
        self._seconds += seconds

    def parameters(self, text):
        """Say what was simulated."""
        self._parameters = text

    def note(self, text):
        """Say something about the result, with its numbers."""
        self._notes.append(text)

    def table(self, caption, header, rows):
        """Report numbers in a table; `rows` are sequences of texts as long as `header`."""
        rows = [list(row) for row in rows]
        self._tables.append({"caption": caption, "header": list(header), "rows": rows})

    def check(self, what, measured, expected, tolerance, error=None, unit="", why=""):
        """Check |measured − expected| ≤ tolerance, and return whether it holds.

        `why` is the cause of a difference: one sentence, which names the test or the figure that
        supports it. It is reported where the check fails.
        """
        passed = bool(abs(measured - expected) <= tolerance)
        uncertainty = "" if error is None or np.isnan(error) else f" ± {error:.2g}"
        self.claim(
            what,
            f"{measured:.4g}{uncertainty}{unit}",
            f"{expected:.4g} ± {tolerance:.2g}{unit}",
            passed,
            why,
        )
        return passed

    def claim(self, what, measured, expected, passed, why=""):
        """Check anything else; `measured` and `expected` are texts, `why` as in `check`."""
        row = {"what": what, "measured": measured, "expected": expected, "passed": bool(passed)}
        self._rows.append(row if passed or not why else {**row, "why": why})

    def save(self, figure, suffix="", caption=""):
        """Write a matplotlib figure as a picture of the report."""
        path = self.picture(suffix, caption)
        figure.savefig(path, dpi=100)
        shrink(path)

    def picture(self, suffix="", caption=""):
        """The path of a picture of the report that the caller writes."""
        self.results.mkdir(parents=True, exist_ok=True)
        path = self.results / f"{self.name}{suffix}.png"
        self._pictures.append({"file": path.name, "caption": caption or self.title})
        return path

    def finish(self):
        """Print and write what was found; exit with OUTSIDE if a number is out of tolerance."""
        record = {
            "name": self.name,
            "target": self.target,
            "title": self.title,
            "quick": self.quick,
            "parameters": self._parameters,
            "rows": self._rows,
            "notes": self._notes,
            "tables": self._tables,
            "pictures": self._pictures,
            "seconds": round(self._seconds, 1),
        }
        self.results.mkdir(parents=True, exist_ok=True)
        path = self.results / f"{self.name}.json"
        path.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"\n{self.target}: {self.title}{' (quick)' if self.quick else ''}")
        print(self._parameters)
        width = max((len(row["what"]) for row in self._rows), default=0)
        for row in self._rows:
            verdict = "ok  " if row["passed"] else "FAIL"
            print(
                f"  {verdict}  {row['what']:{width}s}  measured {row['measured']}"
                f"  expected {row['expected']}"
            )
            if "why" in row:
                print(f"        because {row['why']}")
        for note in self._notes:
            print(f"  {note}")
        for table in self._tables:
            print(f"  {table['caption']}")
            for row in (table["header"], *table["rows"]):
                print("    " + "; ".join(row))
        print(f"  processor time {self._seconds:.0f} s; wrote {os.path.relpath(path)}")
        sys.exit(0 if all(row["passed"] for row in self._rows) else OUTSIDE)


def shrink(path):
    """Store a PNG with a palette of 128 colours, which makes it several times smaller."""
    from PIL import Image

    with Image.open(path) as image:
        small = image.convert("RGB").quantize(128, dither=Image.Dither.NONE)
    small.save(path, optimize=True)


def mean_and_error(values):
    """The mean of independent values along the first axis, and its standard error."""
    values = np.asarray(values, dtype=float)
    if len(values) < 2:
        return values.mean(axis=0), np.full(values.shape[1:], np.nan)
    return values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(len(values))
