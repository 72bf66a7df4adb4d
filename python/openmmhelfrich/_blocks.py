"""Files of named blocks under a checksum: what checkpoints and saved states are made of.

A file is a head of 52 bytes, little-endian, and a ZIP archive without compression:

    ======  =====  =========================================================
    offset  bytes
    ======  =====  =========================================================
         0      8  ``89 48 4C 46 0D 0A 1A 0A``, which a transfer as text breaks
         8      4  version of this layout, 1
        12      8  length of the file
        20     32  SHA-256 of the file without these 32 bytes
        52         ZIP archive
    ======  =====  =========================================================

Magic, length and checksum stay where they are in every later layout, so that a damaged file is told
from one of a newer version. The archive's entry ``INDEX.json`` says what the file is (its kind),
and of every block its version and whether a reader has to understand it; the other entries are
the blocks: ``.bin`` bytes, ``.npy`` an array, ``.json`` the rest. Equal contents give equal bytes.

More can be stored without breaking older files: a new block is a new name, and a block that changes
its meaning gets a higher version. A block has a name such as ``triangles``, or ``triangles/0`` for
one of several of a family, which a reader knows by the first part.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
import struct
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = ["Block", "BlockError", "DamagedError", "pack", "unpack"]

_MAGIC = b"\x89HLF\r\n\x1a\n"
_LAYOUT = 1
_HEAD = struct.Struct("<8sIQ")
_DIGEST_SIZE = hashlib.sha256().digest_size
# In capitals, which no block can be called.
_INDEX = "INDEX.json"
_NAME = re.compile(r"[a-z0-9_-]+(/[a-z0-9_-]+)?")


class BlockError(ValueError):
    """A file of blocks cannot be used; the message is what follows the name of the file."""


class DamagedError(BlockError):
    """A file is not as it was written, or none of blocks at all."""


@dataclass(frozen=True, eq=False)
class Block:
    """One block of a file.

    value
        bytes, an array, or what JSON has.
    version
        Of the meaning of the value.
    required
        Whether a reader that does not know the block, or knows older versions of it only, must
        refuse the file. Without a block that is not required it reads the rest.
    """

    value: Any
    version: int = 1
    required: bool = True


def pack(kind: str, blocks: Mapping[str, Block]) -> bytes:
    """The bytes of a file.

    Parameters
    ----------
    kind : str
        What the file is, such as "run"; `unpack` asks for it.
    blocks : mapping of str to Block

    Raises
    ------
    ValueError
        If a name is none, or an array holds Python objects.
    """
    stored = {name: _encode(name, block.value) for name, block in blocks.items()}
    index = {
        "kind": kind,
        "blocks": {
            name: {"entry": entry, "version": block.version, "required": block.required}
            for (name, block), (entry, _) in zip(blocks.items(), stored.values(), strict=True)
        },
    }
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as file:
        for entry, data in [(_INDEX, json.dumps(index).encode()), *stored.values()]:
            # A name alone would get the time of day.
            file.writestr(zipfile.ZipInfo(entry), data)
    body = archive.getvalue()
    head = _HEAD.pack(_MAGIC, _LAYOUT, _HEAD.size + _DIGEST_SIZE + len(body))
    return b"".join([head, _digest(head, body), body])


def unpack(data: bytes, kind: str, known: Mapping[str, int]) -> dict[str, Block]:
    """The blocks of a file, once nothing of it is found to be damaged.

    Parameters
    ----------
    data : bytes
        The whole file.
    kind : str
        What the file has to be.
    known : mapping of str to int
        The names, or first parts of names, that the reader knows, with the highest version of each.

    Returns
    -------
    dict of str to Block
        Those that the reader knows. Whether all that it needs are there is for the reader to see.

    Raises
    ------
    DamagedError
        If a byte is not as it was written, or some are missing or too many.
    BlockError
        If the file is of another kind, or has what a newer version of this package has written and
        a reader must understand.
    """
    start = _HEAD.size + _DIGEST_SIZE
    if not data.startswith(_MAGIC):
        raise DamagedError("is damaged, or no file of openmm-helfrich: it does not begin like one")
    if len(data) < start:
        raise DamagedError(f"is damaged: it ends after {len(data)} bytes, within its head")
    head, digest, body = data[: _HEAD.size], data[_HEAD.size : start], memoryview(data)[start:]
    _, layout, length = _HEAD.unpack(head)
    # The checksum first: a length that was changed would name a wrong culprit.
    if _digest(head, body) != digest:
        if length != len(data):
            raise DamagedError(f"is damaged: it has {len(data)} bytes, and says {length}")
        raise DamagedError("is damaged: its contents do not have the checksum that it says")
    if layout > _LAYOUT:
        raise BlockError(f"has layout {layout} of a newer openmm-helfrich, which can read it")
    try:
        with zipfile.ZipFile(io.BytesIO(body)) as file:
            return _read(file, kind, known)
    except BlockError:
        raise
    # A checksum can be right for contents that nobody here has written.
    except (zipfile.BadZipFile, LookupError, TypeError, AttributeError, ValueError) as reason:
        raise BlockError(f"is not made as openmm-helfrich makes its files: {reason}") from None


def _read(file: zipfile.ZipFile, kind: str, known: Mapping[str, int]) -> dict[str, Block]:
    """The blocks in an archive."""
    index = json.loads(file.read(_INDEX))
    if index["kind"] != kind:
        raise BlockError(f"is a file of the kind {index['kind']!r}, not {kind!r}")
    found = {}
    for name, entry in index["blocks"].items():
        newest = known.get(name.partition("/")[0], 0)
        if entry["version"] <= newest:
            value = _decode(entry["entry"], file.read(entry["entry"]))
            found[name] = Block(value, entry["version"], entry["required"])
        elif entry["required"]:
            raise BlockError(
                f"has {name!r} in version {entry['version']}, of a newer openmm-helfrich, "
                "which can read it"
            )
    return found


def _digest(head: bytes, body) -> bytes:
    made = hashlib.sha256(head)
    made.update(body)
    return made.digest()


def _encode(name: str, value) -> tuple[str, bytes]:
    """The name of a block's entry, and what it holds."""
    if not _NAME.fullmatch(name):
        raise ValueError(f"a block cannot be called {name!r}")
    if isinstance(value, bytes):
        return f"{name}.bin", value
    if isinstance(value, np.ndarray):
        file = io.BytesIO()
        np.lib.format.write_array(file, value, allow_pickle=False)
        return f"{name}.npy", file.getvalue()
    return f"{name}.json", json.dumps(value).encode()


def _decode(entry: str, data: bytes):
    if entry.endswith(".bin"):
        return data
    if entry.endswith(".npy"):
        return np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
    return json.loads(data)
