"""The command line of these scripts, and the tables that they write."""

import argparse
import contextlib
import csv
from pathlib import Path

from openmmhelfrich.sweep import SweepError, sweep


class Report:
    """Runs and tables of one script.

    Results of runs are stored in the folder of results as soon as they are there, so that a script
    that was interrupted goes on where it was, and scripts share them.

    Parameters
    ----------
    name : str
        Of the table, without its ending.
    description : str
        The docstring of the script.
    add_arguments : callable, optional
        Adds further arguments to a parser.
    folder : str
        Of results, in ``out``.
    """

    def __init__(self, name, description, add_arguments=None, folder="flips"):
        parser = argparse.ArgumentParser(
            description=description, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        parser.add_argument("--quick", action="store_true", help="smaller and fewer runs")
        parser.add_argument(
            "--results", type=Path, help=f"folder of stored runs (default: out/{folder}/SIZE)"
        )
        parser.add_argument("--tables", type=Path, help="folder of tables (default: the results)")
        parser.add_argument(
            "--workers", type=int, default=0, help="processes; default 0, this one, without Dask"
        )
        if add_arguments:
            add_arguments(parser)
        self.options = parser.parse_args()
        self.quick = self.options.quick
        size = "quick" if self.quick else "full"
        self.results = self.options.results or Path("out") / folder / size
        self.tables = self.options.tables or self.results
        self._name = name

    def survivors(self, function, points, version):
        """Results at points, without those of runs that break down, which are printed."""
        try:
            return self.runs(function, points, version)
        except SweepError as error:
            print(error)
            found = []
            for point in points:
                with contextlib.suppress(SweepError):
                    found += self._sweep(function, [point], version, compute=False)
            return found

    def runs(self, function, points, version):
        """Results of a function at points."""
        return self._sweep(function, points, version, compute=True)

    def _sweep(self, function, points, version, compute):
        return sweep(
            function,
            points,
            cache=self.results / "cache",
            version=version,
            workers=self.options.workers,
            compute=compute,
            progress=compute,
        )

    def table(self, columns, rows, suffix=""):
        """Write NAMESUFFIX.csv, and print it."""
        self.tables.mkdir(parents=True, exist_ok=True)
        path = self.tables / f"{self._name}{suffix}.csv"
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            for row in [columns, *rows]:
                texts = [f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row]
                writer.writerow(texts)
                print("  ".join(f"{text:>12}" for text in texts))
