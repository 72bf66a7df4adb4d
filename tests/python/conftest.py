"""Fixtures for all Python tests."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

# The same examples each time; `--hypothesis-profile default` looks for others.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of reference files, which is not part of the project.

    It is where HELFRICH_SHARED says, or ``shared`` beside the project. Without it the tests that
    need it are skipped, unless HELFRICH_REQUIRE_SHARED=1 asks for a failure.
    """
    beside = Path(__file__).resolve().parents[3] / "shared"
    folder = Path(os.environ.get("HELFRICH_SHARED", beside))
    if not (folder / "vcm").is_dir():
        reason = f"no reference files in {folder}; set HELFRICH_SHARED to their folder"
        if os.environ.get("HELFRICH_REQUIRE_SHARED") == "1":
            pytest.fail(reason)
        pytest.skip(reason)
    return folder


@pytest.fixture(scope="session")
def lumpy():
    """A small closed mesh without any symmetry, away from the origin: 42 vertices."""
    from openmmhelfrich.mesh import Mesh

    random = np.random.default_rng(7)
    sphere = Mesh.icosphere(2, 3.0)
    vertices = sphere.vertices * [1.0, 1.3, 0.7] + random.normal(scale=0.1, size=(42, 3))
    return Mesh(vertices, sphere.triangles).translated((0.4, -0.2, 0.9))


@pytest.fixture(scope="session")
def pair(lumpy):
    """Two separate components, the second one mirrored and smaller."""
    from openmmhelfrich.mesh import Mesh

    other = lumpy.vertices * [-0.5, 0.5, 0.5] + [11.0, 2.0, -3.0]
    return Mesh(
        np.concatenate([lumpy.vertices, other]),
        np.concatenate([lumpy.triangles, lumpy.triangles + lumpy.num_vertices]),
    )


@pytest.fixture
def backend_as_it_was():
    """Leaves the backend for the process as it is."""
    import openmmhelfrich as helfrich

    before = helfrich.get_backend()
    yield
    kind, _, precision = before.partition(":")
    helfrich.set_backend(kind, precision=precision or "auto")


@pytest.fixture
def paper_scripts(monkeypatch):
    """The scripts of examples/paper can be imported, for the length of a test."""
    folder = Path(__file__).resolve().parents[2] / "examples" / "paper"
    monkeypatch.syspath_prepend(str(folder))
    yield
    for script in folder.glob("*.py"):
        sys.modules.pop(script.stem, None)
