"""What `make fuzz` has found, smallest inputs first reduced: docs/reliability.md lists them."""

from __future__ import annotations

import numpy as np
import pytest
from openmmhelfrich import Mesh, MeshError

HEADER = ["ply", "format ascii 1.0", "element vertex 3", "property float x", "property float y"]
HEADER += ["property float z", "element face 1", "property list uchar int vertex_indices"]
ROWS = ["0 0 0", "1 0 0", "0 1 0", "3 0 1 2", ""]


def refused(path, data: bytes, **options) -> str:
    """The message, without the folder."""
    path.write_bytes(data)
    with pytest.raises(MeshError) as caught:
        Mesh.read(path, **options)
    return str(caught.value).replace(str(path.parent) + "/", "")


def ply(*changes: tuple[str, str], rows=ROWS) -> bytes:
    text = "\n".join([*HEADER, "end_header", *rows])
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text.encode()


# --- mesh files ----------------------------------------------------------------------------------


@pytest.mark.parametrize("options", [{"merge": 0.1}, {}])
def test_huge_coordinates_name_the_triangle(tmp_path, options):
    rows = ["-1e308 0 0", "1e308 0 0", "0 1e200 0", *ROWS[3:]]
    said = refused(tmp_path / "m.ply", ply(rows=rows), **options)
    assert said.startswith("Mesh.read: m.ply: ") and "triangle 0" in said


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("element face", "element vertex 3\nproperty float a\nelement face", "'vertex'"),
        ("property float y", "property float x", "'x'"),
        ("list uchar int", "list float int", "vertex_indices"),
        ("list uchar int", "list uchar float", "vertex_indices"),
        ("element face", "element other 9\nelement face", "'other'"),
    ],
)
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_ply_headers_that_contradict_themselves(tmp_path, old, new, words, form):
    said = refused(tmp_path / "m.ply", ply((old, new), ("format ascii", f"format {form}")))
    assert said.startswith("Mesh.read: m.ply, line ") and words in said
