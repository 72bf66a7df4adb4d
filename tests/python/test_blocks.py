"""Files of named blocks: every kind of damage is noticed, and newer contents are told from it."""

import hashlib
import struct

import numpy as np
import pytest
from openmmhelfrich._blocks import Block, BlockError, DamagedError, pack, unpack

KNOWN = {"run": 2, "openmm": 1, "triangles": 1}
BLOCKS = {
    "run": Block({"step": 40, "name": "ä", "sizes": [1, 2.5, None]}, version=2),
    "openmm": Block(bytes(range(256))),
    "triangles/0": Block(np.arange(12, dtype=np.int32).reshape(4, 3)),
    "triangles/1": Block(np.arange(6, dtype=np.int64).reshape(2, 3)),
}


@pytest.fixture(scope="module")
def data():
    return pack("run", BLOCKS)


def test_what_is_packed_comes_back(data):
    found = unpack(data, "run", KNOWN)
    assert list(found) == list(BLOCKS)
    assert found["run"].value == BLOCKS["run"].value
    assert found["run"].version == 2
    assert found["openmm"].value == BLOCKS["openmm"].value
    for name in ("triangles/0", "triangles/1"):
        assert np.array_equal(found[name].value, BLOCKS[name].value)
        assert found[name].value.dtype == BLOCKS[name].value.dtype


def test_the_head_is_what_the_documentation_says(data):
    magic, layout, length = struct.unpack("<8sIQ", data[:20])
    assert (magic, layout, length) == (bytes.fromhex("89484c460d0a1a0a"), 1, len(data))
    assert hashlib.sha256(data[:20] + data[52:]).digest() == data[20:52]
    assert data[52:56] == b"PK\3\4"


def test_equal_contents_give_equal_bytes(data, monkeypatch):
    monkeypatch.setattr("time.time", lambda: 1e9)
    assert pack("run", BLOCKS) == data


def test_every_byte_counts(data):
    for offset in range(len(data)):
        for change in (1, 0x80):
            damaged = bytearray(data)
            damaged[offset] ^= change
            with pytest.raises(DamagedError, match="is damaged"):
                unpack(bytes(damaged), "run", KNOWN)


def test_every_length_counts(data):
    for length in range(len(data)):
        with pytest.raises(DamagedError, match="is damaged"):
            unpack(data[:length], "run", KNOWN)
    with pytest.raises(DamagedError, match=f"it has {len(data) + 1} bytes, and says {len(data)}"):
        unpack(data + b"\0", "run", KNOWN)


def test_two_halves_of_two_files(data):
    """As a disk that was written in part, with the sectors of an older file."""
    other = pack("run", {**BLOCKS, "openmm": Block(bytes(256))})
    assert len(other) == len(data)
    with pytest.raises(DamagedError):
        unpack(data[: len(data) // 2] + other[len(data) // 2 :], "run", KNOWN)


def test_another_kind(data):
    with pytest.raises(BlockError, match="is a file of the kind 'run', not 'state'") as error:
        unpack(data, "state", KNOWN)
    assert not isinstance(error.value, DamagedError)


@pytest.mark.parametrize("known", [{"run": 2, "openmm": 1}, {**KNOWN, "triangles": 0}])
def test_a_block_that_must_be_understood(data, known):
    with pytest.raises(BlockError, match="has 'triangles/0' in version 1, of a newer") as error:
        unpack(data, "run", known)
    assert not isinstance(error.value, DamagedError)


def test_a_newer_version_of_a_block(data):
    with pytest.raises(BlockError, match="has 'run' in version 2, of a newer"):
        unpack(data, "run", {**KNOWN, "run": 1})


def test_a_block_that_need_not_be_understood():
    data = pack("run", {**BLOCKS, "statistics": Block([1, 2], required=False)})
    assert list(unpack(data, "run", KNOWN)) == list(BLOCKS)
    known = {**KNOWN, "statistics": 1}
    assert unpack(data, "run", known)["statistics"].value == [1, 2]


def test_a_later_layout_is_told_from_damage(data):
    head = data[:8] + struct.pack("<IQ", 2, len(data))
    later = head + hashlib.sha256(head + data[52:]).digest() + data[52:]
    with pytest.raises(BlockError, match="has layout 2 of a newer openmm-helfrich") as error:
        unpack(later, "run", KNOWN)
    assert not isinstance(error.value, DamagedError)


@pytest.mark.parametrize("name", ["", "INDEX", "../up", "a/b/c", "a b", "a."])
def test_names_that_are_none(name):
    with pytest.raises(ValueError, match="cannot be called"):
        pack("run", {name: Block(b"")})


def test_objects_are_not_stored():
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):
        pack("run", {"run": Block(np.array([object()]))})
