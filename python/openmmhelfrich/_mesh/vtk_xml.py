"""VTK's files in XML, .vtp and .vtu: https://docs.vtk.org/en/latest/vtk_file_formats.

Arrays may be text, base64, or appended as base64 or as they are, and compressed by zlib or LZMA (by
LZ4 where the package lz4 is installed): all that ParaView writes.
"""

from __future__ import annotations

import base64
import lzma
import re
import zlib
from collections.abc import Callable
from xml.etree import ElementTree

import numpy as np

from .._types import Array
from ..errors import MeshError
from .cells import Cells, polydata_cells
from .source import Source, plain, shorten

__all__ = ["read"]

_TYPES = {
    **{f"Int{8 * size}": f"i{size}" for size in (1, 2, 4, 8)},
    **{f"UInt{8 * size}": f"u{size}" for size in (1, 2, 4, 8)},
    "Float32": "f4",
    "Float64": "f8",
}
_PARTS = {
    "Verts": "VERTICES",
    "Lines": "LINES",
    "Polys": "POLYGONS",
    "Strips": "TRIANGLE_STRIPS",
}
# The file up to what is appended, which need not be XML.
_APPENDED = re.compile(rb"<AppendedData[^>]*encoding\s*=\s*[\"'](raw|base64)[\"'][^>]*>\s*_")


def read(source: Source) -> tuple[Array, Array]:
    """Vertices and triangles of a .vtp or .vtu file; values of points and cells are skipped."""
    return _Reader(source).read()


class _Reader:
    """A file, its byte order, its compression and what is appended."""

    def __init__(self, source: Source):
        self._source = source
        source.by_line = False
        text, self._appended, self._raw = source.data, b"", False
        found = _APPENDED.search(text)
        if found:
            self._raw = found.group(1) == b"raw"
            self._appended = text[found.end() :]
            if b"</AppendedData>" not in self._appended:
                raise self._error("the appended data end before '</AppendedData>'", "truncated")
            text = text[: found.end()] + b"</AppendedData></VTKFile>"
        try:
            self._root = ElementTree.fromstring(text)
        except ElementTree.ParseError as reason:
            raise source.error(
                f"not a VTK file in XML: {reason}; is the file truncated?", reason.position[0]
            ) from None
        attributes = self._root.attrib
        self._order = {"BigEndian": ">"}.get(attributes.get("byte_order", ""), "<")
        header = attributes.get("header_type", "UInt32")
        if header not in ("UInt32", "UInt64"):
            raise self._error(f"unknown header_type {header!r}")
        self._header = np.dtype(self._order + _TYPES[header])
        self._decompress = self._decompressor(attributes.get("compressor"))

    def _error(self, reason: str, guess: str = "") -> MeshError:
        return self._source.error(reason + (f"; is the file {guess}?" if guess else ""))

    def _decompressor(self, name: str | None) -> Callable[[bytes, int], bytes] | None:
        """What restores a block of so many bytes; None without compression."""
        if name is None:
            return None
        if name == "vtkZLibDataCompressor":
            return lambda data, size: zlib.decompress(data)
        if name == "vtkLZMADataCompressor":
            return lambda data, size: lzma.decompress(data)
        if name == "vtkLZ4DataCompressor":
            try:
                from lz4.block import decompress
            except ImportError:
                raise self._error(
                    "it is compressed by LZ4; run 'pip install lz4', or save it with another "
                    "compressor (ZLib) or none"
                ) from None
            return lambda data, size: decompress(data, uncompressed_size=size)
        raise self._error(f"unknown compressor {name!r}; save it with ZLib or none")

    def read(self) -> tuple[Array, Array]:
        """The whole surface; pieces follow one another."""
        kind = self._root.get("type", "")
        if self._root.tag != "VTKFile" or kind not in ("PolyData", "UnstructuredGrid"):
            raise self._error(
                "expected a VTKFile of type PolyData or UnstructuredGrid, got "
                f"{shorten([self._root.tag, kind])}; extract the surface and save that"
            )
        points, cells = [np.empty((0, 3))], []
        for piece in self._root.iterfind(f"{kind}/Piece"):
            announced = piece.get("NumberOfPoints", "")
            if announced == "0":
                continue
            array = self._array(piece, "Points", None, np.float64)
            # Compared as text: Python makes no integer of thousands of digits.
            if len(array) % 3 or announced.lstrip("0") != str(len(array) // 3):
                raise self._error(
                    f"{announced or 'no'} points were announced, but there are {len(array)} "
                    "coordinates, not three for each",
                    "truncated",
                )
            found = self._polydata(piece) if kind == "PolyData" else self._grid(piece)
            found.connectivity = found.connectivity + sum(map(len, points))
            cells.append(found)
            points.append(array.reshape(-1, 3))
        if not cells:
            raise self._error(f"there is no Piece in the {kind}", "truncated")
        whole = Cells(
            np.concatenate([part.connectivity for part in cells]),
            np.concatenate([[0], *(np.diff(part.offsets) for part in cells)]).cumsum(),
            np.concatenate([part.types for part in cells]),
        )
        return whole.mesh(self._source, np.concatenate(points))

    def _polydata(self, piece) -> Cells:
        parts = {
            name: self._cells(piece, tag)
            for tag, name in _PARTS.items()
            if piece.find(f"{tag}/DataArray") is not None
        }
        if not parts:
            raise self._error("the PolyData has no Polys", "truncated")
        return polydata_cells(self._source, parts)

    def _grid(self, piece) -> Cells:
        found = self._cells(piece, "Cells")
        found.types = self._array(piece, "Cells", "types", np.int64)
        found.check_offsets(self._source)
        return found

    def _cells(self, piece, tag: str) -> Cells:
        ends = self._array(piece, tag, "offsets", np.int64)
        corners = self._array(piece, tag, "connectivity", np.int64)
        return Cells(corners, np.concatenate([[0], ends]).astype(np.int64))

    def _array(self, piece, tag: str, name: str | None, wanted) -> Array:
        """The numbers of one DataArray."""
        for element in piece.iterfind(f"{tag}/DataArray"):
            if name is None or element.get("Name") == name:
                break
        else:
            raise self._error(f"{tag} have no DataArray {name or ''}".rstrip(), "truncated")
        what = f"the array {name or 'of the points'} of {tag}"
        kind = element.get("type", "")
        if kind not in _TYPES:
            raise self._error(f"unknown type {kind!r} of {what}")
        form = element.get("format", "ascii")
        if form not in ("ascii", "binary", "appended"):
            raise self._error(f"unknown format {form!r} of {what}")
        text = element.text or ""
        try:
            if form == "ascii":
                return np.array(plain(text.split()), dtype=wanted)
            if form == "binary":
                data = self._from_base64("".join(text.split()).encode())
            else:
                data = self._from_appended(int(element.get("offset", -1)))
            return np.frombuffer(self._unpacked(data), self._order + _TYPES[kind]).astype(wanted)
        # Whatever is wrong in the bytes of a file: counts, lengths, base64, compressed blocks.
        except (ValueError, OverflowError, zlib.error, lzma.LZMAError, RuntimeError) as reason:
            raise self._error(f"{what} cannot be read: {reason}", "damaged or truncated") from None

    def _from_appended(self, offset: int) -> bytes:
        if not 0 <= offset < len(self._appended):
            raise ValueError(f"its offset {offset} is not within {len(self._appended)} bytes")
        data = self._appended[offset:]
        return data if self._raw else self._from_base64(data[: data.find(b"<")])

    def _from_base64(self, text: bytes) -> bytes:
        """The header and the values of an array, which may be followed by others."""
        size = self._header.itemsize
        if self._decompress is None:
            # Header and values are encoded together or, if the header is padded, one by one.
            cut = _encoded(size)
            apart = text[:cut].endswith(b"=")
            (length,) = self._numbers(_decoded(text[:cut]), 0, 1)
            if not apart:
                return _decoded(text[: _encoded(size + length)])
        else:
            # The header is encoded by itself; its three first numbers fill whole groups.
            (blocks,) = self._numbers(_decoded(text[: _encoded(3 * size)]), 0, 1)
            cut = _encoded((3 + blocks) * size)
            length = sum(self._numbers(_decoded(text[:cut]), 3, blocks))
        return _decoded(text[:cut]) + _decoded(text[cut : cut + _encoded(length)])

    def _numbers(self, data: bytes, first: int, count: int) -> list[int]:
        """Some of the numbers of a header."""
        size = self._header.itemsize
        found = _part(data, first * size, count * size)
        return np.frombuffer(found, self._header).tolist()

    def _unpacked(self, data: bytes) -> bytes:
        """The values after a header, decompressed."""
        size = self._header.itemsize
        if self._decompress is None:
            return _part(data, size, *self._numbers(data, 0, 1))
        (blocks,) = self._numbers(data, 0, 1)
        if blocks == 0:
            return b""
        whole, last, *packed = self._numbers(data, 1, 2 + blocks)
        at, found = (3 + blocks) * size, []
        for block, length in enumerate(packed):
            unpacked = last if last and block == blocks - 1 else whole
            found.append(self._decompress(_part(data, at, length), unpacked))
            if len(found[-1]) != unpacked:
                raise ValueError(f"block {block} has {len(found[-1])} bytes, not {unpacked}")
            at += length
        return b"".join(found)


def _part(data: bytes, start: int, count: int) -> bytes:
    if start + count > len(data):
        raise ValueError(f"{start + count} bytes are needed, but only {len(data)} are here")
    return data[start : start + count]


def _encoded(size: int) -> int:
    """How many characters of base64 so many bytes take."""
    return 4 * -(-size // 3)


def _decoded(text: bytes) -> bytes:
    return base64.b64decode(text, validate=True)
