"""Tables that grow row by row during a run, as CSV or HDF5, and their readers."""

from __future__ import annotations

import collections
import contextlib
import csv
import os
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .._journal import JournaledFile
from .._types import Array, File
from .._writing import naming, write_whole

__all__ = ["Modes", "open_table", "read_modes", "read_table"]

_HDF5 = (".h5", ".hdf5")
_INSTEAD = "or write .csv"
_MODE = re.compile(r"u_(\d+)_(-?\d+)")

# The unit of a column, in the last parentheses of its header: names may have others.
_UNIT = re.compile(r" \([^()]*\)$")


class Modes(NamedTuple):
    """Amplitudes over time, as `read_modes` returns them."""

    step: Array
    """Step of the simulation, int, shape (num_frames,)."""
    time: Array
    """Time, ps, shape (num_frames,)."""
    amplitudes: Array
    """u_lm at index l² + l + m, shape (num_frames, (lmax+1)²)."""

    @property
    def interval(self) -> float:
        """Time between frames, ps; ValueError if it varies or there is one frame only."""
        gaps = np.diff(self.time)
        if len(gaps) == 0 or not np.allclose(gaps, gaps[0], rtol=1e-6, atol=0):
            raise ValueError("Modes: the frames are not at equal intervals of time")
        return float(gaps.mean())


def read_modes(path: File) -> Modes:
    """Read the file of a `ModeReporter`.

    Parameters
    ----------
    path : str or Path
        CSV, or HDF5 (``.h5``, ``.hdf5``).

    Returns
    -------
    Modes
        Steps, times and amplitudes.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ImportError
        An HDF5 file without h5py.
    ValueError
        The file is none of a `ModeReporter`, or broken.
    """
    table = read_table(path)
    found = {
        (int(match[1]), int(match[2])): column
        for name, column in table.items()
        if (match := _MODE.fullmatch(name))
    }
    count = round(len(found) ** 0.5)
    wanted = [(l, m) for l in range(count) for m in range(-l, l + 1)]
    if not found or set(wanted) != set(found) or not {"step", "time"} <= set(table):
        raise ValueError(f"read_modes: {path} has no columns step, time, u_0_0, u_1_-1, …")
    amplitudes = np.stack([found[mode] for mode in wanted], axis=1)
    return Modes(table["step"].astype(int), table["time"], amplitudes)


def read_table(path: File) -> dict[str, Array]:
    """Read the columns of a file that a reporter wrote.

    A last line that is cut off, because the run was killed in the middle of it, is left out.

    Parameters
    ----------
    path : str or Path
        CSV, or HDF5 (``.h5``, ``.hdf5``).

    Returns
    -------
    dict of str to ndarray
        Columns by name, without the units that CSV headers have in parentheses; shape (num_rows,).
        Where two differ by these only, they keep them: of a run with several vesicles, "area left
        (kJ/mol)" is the energy of the term ``area``, and "area left (nm^2)" the area.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ImportError
        An HDF5 file without h5py.
    ValueError
        The file is no table of numbers, or has two columns of one name; the message names the line.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"read_table: there is no file {path}")
    if path.suffix.lower() in _HDF5:
        with _open_hdf5(path) as file:
            names = list(file.attrs.get("columns", []))
            rows = np.array(file.get("rows", 0.0))
            if rows.ndim != 2 or rows.shape[1] != len(set(names)):
                raise ValueError(f"read_table: {path} has no rows of a reporter")
        return dict(zip(names, rows.T, strict=True))
    try:
        # Programs for tables put a mark in front, which is no part of the first name.
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as reason:
        raise ValueError(f"read_table: {path} is no text of a reporter ({reason})") from None
    lines = text[: text.rfind("\n") + 1].splitlines()
    if not lines:
        raise ValueError(f"read_table: {path} has no header")
    names = _names(next(csv.reader(lines[:1])))
    if len(set(names)) != len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"read_table: {path}, line 1: there are two columns {twice!r}")
    rows = np.empty((len(lines) - 1, len(names)))
    for number, line in enumerate(lines[1:]):
        words = line.split(",")
        try:
            if len(words) != len(names):
                raise ValueError(f"there are {len(words)}")
            rows[number] = [float(word) for word in words]
        except ValueError as reason:
            raise ValueError(
                f"read_table: {path}, line {number + 2}: need {len(names)} numbers ({reason})"
            ) from None
    return dict(zip(names, rows.T, strict=True))


def _names(header: list[str]) -> list[str]:
    """Columns of a CSV file without their units, but for those of which the name is not enough."""
    short = [_UNIT.sub("", name) for name in header]
    counts = collections.Counter(short)
    return [name if counts[name] == 1 else full for name, full in zip(short, header, strict=True)]


def _open_hdf5(path):
    """The file, of a table, made whole if a kill in the middle of a row has left it in parts."""
    h5py = import_h5py(_INSTEAD)
    try:
        return h5py.File(path, "r")
    except OSError:
        JournaledFile(path).recover()
    try:
        return h5py.File(path, "r")
    except OSError as reason:
        raise ValueError(f"read_table: {path} is no HDF5 file, or is damaged ({reason})") from None


def open_table(path: File, columns: Any, append: bool) -> Any:
    """A table to which rows are added, in the format of its suffix.

    Parameters
    ----------
    path : str or Path
        ``.csv``, ``.h5`` or ``.hdf5``.
    columns : dict of str to str
        The unit of each column by its name; the first is ``step``.
    append : bool
        Go on with a file that exists. Otherwise it is overwritten.

    Returns
    -------
    _Csv or _Hdf5
        With a method `add(values)`, after which the row is on disk, and `cut(step)`, which drops
        the rows after a step, as many as `dropped` then says, and returns the last step that is
        left, None if there is no row.

    Raises
    ------
    ImportError
        HDF5 without h5py.
    ValueError
        Another suffix, or a file with other columns.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".csv":
        return _Csv(path, columns, append)
    if suffix in _HDF5:
        return _Hdf5(path, columns, append)
    raise ValueError(f"{path}: the suffix must be .csv, .h5 or .hdf5")


class _Csv:
    """A CSV file; every row is flushed."""

    dropped = 0

    def __init__(self, path, columns, append):
        self.path = path
        header = [f"{name} ({unit})" if unit else name for name, unit in columns.items()]
        first = ",".join(header) + "\n"
        found = ""
        if append and path.is_file():
            with path.open(newline="", encoding="utf-8") as file:
                found = file.readline()
        # A header without its end was cut off by a kill, before there was any row.
        if not found.endswith("\n") and first.startswith(found):
            with naming(path):
                path.write_text(first, encoding="utf-8")
        elif next(csv.reader([found])) != header:
            raise ValueError(
                f"{path}: its columns are {next(csv.reader([found]))}, not {header}; do not append"
            )

    def cut(self, step):
        text = self.path.read_bytes()
        # What follows the last end of a line was cut off by a kill.
        lines = text[: text.rfind(b"\n") + 1].splitlines(keepends=True)
        steps = [self._step(line, number) for number, line in enumerate(lines[1:], 2)]
        kept = [line for line, of in zip(lines[1:], steps, strict=True) if of <= step]
        self.dropped = len(steps) - len(kept)
        if len(b"".join([lines[0], *kept])) != len(text):
            # The file is replaced as a whole, so that a kill leaves the old one or the new one.
            write_whole(self.path, b"".join([lines[0], *kept]))
        return max((of for of in steps if of <= step), default=None)

    def _step(self, line, number):
        """The step of a row, its first number."""
        try:
            return float(line.split(b",", 1)[0])
        except ValueError as reason:
            raise ValueError(
                f"{self.path}, line {number}: need a step ({reason}); do not append"
            ) from None

    def add(self, values):
        # The file is opened for each row, so that one which was moved away is noticed, and none is
        # left open by a reporter that is forgotten.
        row = (",".join(repr(value) for value in values) + "\n").encode()
        # Not "ab", which would begin a new one without its columns.
        with naming(self.path), self.path.open("r+b", buffering=0) as file:
            length = file.seek(0, os.SEEK_END)
            try:
                written = file.write(row)
                # A disk that takes a part says why with the rest.
                while written < len(row):
                    written += file.write(row[written:])
            except OSError:
                # The next row, when there is room again, shall not be the end of this one.
                file.truncate(length)
                raise


class _Hdf5:
    """An HDF5 file with the rows in one dataset, closed after every row, and whole after a kill."""

    dropped = 0

    def __init__(self, path, columns, append):
        self.path, self.h5py, self._file = path, import_h5py(_INSTEAD), JournaledFile(path)
        names = list(columns)
        if append:
            self._file.recover()
        if append and path.is_file():
            try:
                with self.h5py.File(path, "r") as file:
                    found = list(file.attrs.get("columns", []))
            except OSError as reason:
                raise ValueError(
                    f"{path} is no HDF5 file, or is damaged ({reason}); do not append"
                ) from None
            if found != names:
                raise ValueError(f"{path}: its columns are {found}, not {names}; do not append")
            return
        with self._file.change(fresh=True) as raw, self.h5py.File(raw, "w") as file:
            file.attrs["columns"] = names
            file.attrs["units"] = list(columns.values())
            shape = (0, len(names))
            file.create_dataset(
                "rows", shape, float, maxshape=(None, len(names)), chunks=(256, len(names))
            )

    def cut(self, step):
        with self.h5py.File(self.path, "r") as file:
            kept = file["rows"][:, 0] <= step
            self.dropped = int(len(kept) - np.count_nonzero(kept))
            last = file["rows"][np.count_nonzero(kept) - 1, 0] if kept.any() else None
        if not kept.all():
            with self._change() as rows:
                rows.resize(np.count_nonzero(kept), axis=0)
        return last

    def add(self, values):
        with self._change() as rows:
            rows.resize(len(rows) + 1, axis=0)
            rows[-1] = values

    @contextlib.contextmanager
    def _change(self):
        with self._file.change() as raw, self.h5py.File(raw, "r+") as file:
            yield file["rows"]


def import_h5py(otherwise: Any) -> Any:
    """h5py, or an ImportError that says how to get it, and what to do otherwise."""
    try:
        import h5py
    except ImportError as reason:
        raise ImportError(
            "HDF5 files need h5py; install it with 'pip install openmm-helfrich[hdf5]', "
            f"{otherwise} ({reason})"
        ) from None
    return h5py
