"""Legacy VTK files, of any version, text or binary: https://docs.vtk.org/en/latest/vtk_file_formats.

Surfaces of POLYDATA and UNSTRUCTURED_GRID are read, as ParaView and VTK write them. The latter is
written, which meshio can read too; OVITO reads either, but text only.
"""

from __future__ import annotations

import numpy as np

from .._types import Array
from .cells import TRIANGLE, Cells, polydata_cells
from .source import Source, plain, shorten

__all__ = ["read", "write"]

# Binary values are big-endian.
_TYPES = {
    **dict.fromkeys(("char", "signed_char", "vtktypeint8"), "i1"),
    **dict.fromkeys(("unsigned_char", "vtktypeuint8"), "u1"),
    **dict.fromkeys(("short", "vtktypeint16"), ">i2"),
    **dict.fromkeys(("unsigned_short", "vtktypeuint16"), ">u2"),
    # Ids are four bytes in these files, whatever they are in memory.
    **dict.fromkeys(("int", "vtkidtype", "vtktypeint32"), ">i4"),
    **dict.fromkeys(("unsigned_int", "vtktypeuint32"), ">u4"),
    **dict.fromkeys(("long", "vtktypeint64"), ">i8"),
    **dict.fromkeys(("unsigned_long", "vtktypeuint64"), ">u8"),
    "float": ">f4",
    "double": ">f8",
}
_DATASETS = ("POLYDATA", "UNSTRUCTURED_GRID")
_CELLS = ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS")


def read(source: Source) -> tuple[Array, Array]:
    """Vertices and triangles of a legacy VTK file; values of points and cells are skipped."""
    return _Reader(source).read()


class _Reader:
    """What is known so far of a file."""

    def __init__(self, source: Source):
        self._source = source
        self._binary = False
        self._offsets = False

    def read(self) -> tuple[Array, Array]:
        """The whole of it."""
        source = self._source
        dataset = self._header()
        points, types = None, None
        cells: dict[str, Cells] = {}
        while words := source.words():
            keyword = words[0].upper()
            if keyword in ("POINT_DATA", "CELL_DATA"):
                break
            if keyword == "POINTS":
                count = self._count(words, 1, 3)
                points = self._values(words[2], 3 * count, f"{count} points").reshape(-1, 3)
            elif keyword in _CELLS and len(words) == 3:
                cells[keyword] = self._cells(words)
            elif keyword == "CELL_TYPES":
                types = self._values("int", self._count(words, 1, 2), "the cell types")
            elif keyword == "METADATA":
                self._skip_metadata()
            elif keyword == "FIELD":
                for _ in range(self._count(words, 2, 3)):
                    self._skip_array()
            else:
                raise source.error(f"expected points or cells of {dataset}, got {shorten(words)}")
        if points is None:
            raise source.error("the file ends here without POINTS; is it truncated?")
        if dataset == "POLYDATA":
            if not {"POLYGONS", "TRIANGLE_STRIPS"} & set(cells):
                raise source.error("the file has no POLYGONS; is it truncated?")
            # Cells are checked when all is read: the last line has nothing to do with them.
            source.by_line = False
            return polydata_cells(source, cells).mesh(source, points)
        if types is None or "CELLS" not in cells or len(types) != len(cells["CELLS"]):
            raise source.error("a grid needs CELLS and as many CELL_TYPES; is it truncated?")
        source.by_line = False
        cells["CELLS"].types = types.astype(np.int64)
        return cells["CELLS"].mesh(source, points)

    def _header(self) -> str:
        """The first four lines; returns the kind of the dataset."""
        source = self._source
        words = source.words()
        if [word.lower() for word in words[:4]] != ["#", "vtk", "datafile", "version"]:
            raise source.error(
                f"a VTK file starts with '# vtk DataFile Version', got {shorten(words)}"
            )
        try:
            self._offsets = float(words[4]) >= 5
        except (IndexError, ValueError):
            raise source.error(f"expected the version of VTK files, got {shorten(words)}") from None
        source.raw_line()  # The title may be anything.
        (mode, *_) = source.need("'ASCII' or 'BINARY'")
        if mode.upper() not in ("ASCII", "BINARY"):
            raise source.error(f"expected 'ASCII' or 'BINARY', got {mode!r}")
        self._binary = mode.upper() == "BINARY"
        words = source.need("'DATASET POLYDATA'")
        dataset = words[1].upper() if len(words) == 2 else ""
        if words[0].upper() != "DATASET" or dataset not in _DATASETS:
            raise source.error(
                f"expected 'DATASET POLYDATA' or 'DATASET UNSTRUCTURED_GRID', got {shorten(words)};"
                " extract the surface and save that"
            )
        return dataset

    def _count(self, words: list[str], at: int, length: int) -> int:
        """A count at a place of a line of so many words."""
        if len(words) != length:
            raise self._source.error(f"expected {length} words, got {shorten(words)}")
        count = self._source.integer(words[at], f"the number after {words[at - 1]}")
        if count < 0:
            raise self._source.error(f"the number after {words[at - 1]} is {count}")
        return count

    def _values(self, type_name: str, count: int, what: str) -> Array:
        """So many numbers, as doubles or as 64-bit integers."""
        source = self._source
        if type_name.lower() not in _TYPES:
            raise source.error(f"unknown type {type_name!r} of {what}")
        stored = np.dtype(_TYPES[type_name.lower()])
        wanted = np.float64 if stored.kind == "f" else np.int64
        if self._binary:
            return np.frombuffer(source.take(count * stored.itemsize, what), stored).astype(wanted)
        # A number and a blank take two bytes: a count that is damaged shall not take all memory.
        if 2 * count > len(source.data) + 1:
            raise source.error(
                f"{what} need {count} numbers, more than the file has room for; is it truncated?"
            )
        values = np.empty(count, dtype=wanted)
        filled = 0
        while filled < count:
            words = source.need(f"{count - filled} more numbers of {what}")
            if filled + len(words) > count:
                raise source.error(
                    f"{what} need {count} numbers, but more are here: {shorten(words)}; do the "
                    "counts fit?"
                )
            try:
                values[filled : filled + len(words)] = np.array(plain(words), dtype=wanted)
            except (ValueError, OverflowError):
                raise source.error(f"expected numbers of {what}, got {shorten(words)}") from None
            filled += len(words)
        return values

    def _cells(self, words: list[str]) -> Cells:
        """Cells in either layout: counts among the corners, or offsets apart (version 5)."""
        source = self._source
        name = words[0].upper()
        number, size = self._count(words, 1, 3), self._count(words, 2, 3)
        if not self._offsets:
            values = self._values("int", size, f"{number} {name}")
            offsets, at = [0], 0
            corners = np.ones(size, dtype=bool)
            for _ in range(number):
                if at >= size or values[at] < 0:
                    raise source.error(f"{number} {name} do not fit into {size} numbers")
                corners[at] = False
                offsets.append(offsets[-1] + int(values[at]))
                at += 1 + int(values[at])
            if at != size:
                raise source.error(f"{number} {name} take {at} numbers, not {size}")
            return Cells(values[corners], np.array(offsets, dtype=np.int64))
        parts = []
        for called, count in (("OFFSETS", number), ("CONNECTIVITY", size)):
            words = source.need(f"{called} of {name}")
            if words[0].upper() != called or len(words) != 2:
                raise source.error(f"expected {called} and a type, got {shorten(words)}")
            parts.append(self._values(words[1], count, f"{called} of {name}"))
        offsets, connectivity = parts
        return Cells(connectivity, offsets if len(offsets) else np.zeros(1, dtype=np.int64))

    def _skip_metadata(self) -> None:
        """Names of components and the like, up to the next blank line."""
        while (line := self._source.raw_line()) is not None and line.strip():
            pass

    def _skip_array(self) -> None:
        """An array of a FIELD, such as the time."""
        source = self._source
        words = source.need("an array of a field")
        if words[0].upper() == "METADATA":
            self._skip_metadata()
            words = source.need("an array of a field")
        if len(words) != 4 or words[3].lower() not in _TYPES:
            raise source.error(
                f"expected an array of numbers of a field, got {shorten(words)}; save the surface "
                "without field data"
            )
        count = self._count(words, 1, 4) * self._count(words, 2, 4)
        self._values(words[3], count, f"the array {words[0]}")


def write(
    vertices: Array,
    triangles: Array,
    point_data: dict[str, Array] | None = None,
    binary: bool = False,
) -> bytes:
    """An UNSTRUCTURED_GRID of triangles and doubles, version 3.0, which every reader knows.

    As text, each number has the fewest digits that give it back exactly. Values of the vertices
    are SCALARS or VECTORS of POINT_DATA.
    """

    def rows(values: Array, stored: str) -> bytes:
        if binary:
            return values.astype(stored).tobytes() + b"\n"
        return ("\n".join(" ".join(map(repr, row)) for row in values.tolist()) + "\n").encode()

    faces = np.column_stack([np.full(len(triangles), 3), triangles])
    found = [
        b"# vtk DataFile Version 3.0\nopenmm-helfrich mesh, nm\n",
        b"BINARY\n" if binary else b"ASCII\n",
        f"DATASET UNSTRUCTURED_GRID\nPOINTS {len(vertices)} double\n".encode(),
        rows(vertices, ">f8"),
        f"CELLS {len(faces)} {faces.size}\n".encode(),
        rows(faces, ">i4"),
        f"CELL_TYPES {len(faces)}\n".encode(),
        rows(np.full((len(faces), 1), TRIANGLE), ">i4"),
    ]
    if point_data:
        found.append(f"POINT_DATA {len(vertices)}\n".encode())
    for name, values in (point_data or {}).items():
        if values.ndim == 1:
            found.append(f"SCALARS {name} double 1\nLOOKUP_TABLE default\n".encode())
        else:
            found.append(f"VECTORS {name} double\n".encode())
        found.append(rows(values.reshape(len(vertices), -1), ">f8"))
    return b"".join(found)
