"""The meshes of a run: formats, values of the vertices, triangles of each frame, resuming."""

import numpy as np
import pytest
from click.testing import CliRunner
from openmmhelfrich import Mesh, analysis
from openmmhelfrich.cli import main
from openmmhelfrich.simulation.frames import MeshFrames, frames_writer
from openmmhelfrich.simulation.runner import Run

CONFIG = """
simulation = { name = "pair", duration = 2, seed = 7, platform = "Reference" }
integrator = { kind = "Verlet", time_step = 0.02 }
output = { interval = 0.4, xtc = false, frames = "vtk" }

[[vesicle]]
name = "a"
mesh = { icosphere = 2, radius = 30 }

[[vesicle]]
name = "a_1"
mesh = { random = 40, radius = 20, translate = [80, 0, 0] }
"""
LABELS = ("a", "a_1")


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(CONFIG)
    return path


def table(path):
    """The vertices and their values in a PLY or VTK text file, by name."""
    lines = path.read_text(encoding="ascii").splitlines()
    if path.suffix == ".ply":
        names = [line.split()[-1] for line in lines if line.startswith("property double")]
        count = int(next(line for line in lines if line.startswith("element vertex")).split()[-1])
        start = lines.index("end_header") + 1
        rows = np.array([line.split() for line in lines[start : start + count]], dtype=float)
        return dict(zip(names, rows.T, strict=True))
    found = {}
    for number, line in enumerate(lines):
        if line.startswith("POINTS"):
            count = int(line.split()[1])
            rows = [words.split() for words in lines[number + 1 : number + 1 + count]]
            found.update(zip("xyz", np.array(rows, dtype=float).T, strict=True))
        if line.startswith("SCALARS"):
            assert lines[number + 1] == "LOOKUP_TABLE default"
            found[line.split()[1]] = np.array(lines[number + 2 : number + 2 + count], dtype=float)
    return found


def same_files(one, two):
    def contents(folder):
        return {p.name: p.read_bytes() for p in (folder / "frames").iterdir()}

    return contents(one) == contents(two)


@pytest.mark.parametrize("kind", ["ply", "obj", "stl", "vtk"])
def test_every_format_has_the_meshes_of_a_run(config, tmp_path, kind):
    out = tmp_path / kind
    arguments = ["run", str(config), "--out", str(out), "--frames", kind]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    names = {f"pair_{label}_{n:06d}.{kind}" for label in LABELS for n in range(6)}
    assert {path.name for path in (out / "frames").iterdir()} == names
    run = (out / "pair.csv").read_text().splitlines()
    areas = [dict(zip(run[0].split(","), row.split(","), strict=True)) for row in run[1:]]
    for label in LABELS:
        for number in range(6):
            path = out / "frames" / f"pair_{label}_{number:06d}.{kind}"
            mesh = Mesh.read(path)
            expected = float(areas[number][f"area {label} (nm^2)"])
            assert mesh.area == pytest.approx(expected, rel=1e-10)
            if kind in ("obj", "stl"):
                continue
            values = table(path)
            assert list(values) == ["x", "y", "z", "mean_curvature", "area"]
            assert values["area"].sum() == pytest.approx(expected, rel=1e-10)
            curvature = analysis.mean_curvature(mesh.vertices, mesh.triangles)
            assert np.allclose(values["mean_curvature"], curvature, rtol=1e-12)
    # A sphere of radius 30 nm, cut into 80 triangles: 2/R, and Σ a H ≈ 8 π R.
    start = table(out / f"frames/pair_a_000000.{kind}") if kind in ("ply", "vtk") else None
    if start:
        assert start["mean_curvature"].mean() == pytest.approx(2 / 30, rel=0.08)


@pytest.mark.parametrize(
    ("options", "suffixes"),
    [
        ([], {".vtk"}),
        (["--ply"], {".ply"}),
        (["--frames", "obj"], {".obj"}),
        (["--no-ply"], None),
        (["--frames", "none"], None),
    ],
)
def test_options_come_before_the_file(config, tmp_path, options, suffixes):
    out = tmp_path / "out"
    arguments = ["run", str(config), "--out", str(out), "--steps", "1", *options]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    folder = out / "frames"
    assert folder.exists() == (suffixes is not None)
    if suffixes:
        assert {path.suffix for path in folder.iterdir()} == suffixes


def test_a_resumed_run_keeps_its_format_and_loses_no_frame(config, tmp_path):
    """One label is the beginning of the other, which must not be taken for its frames."""
    for folder, ends in (("one", [100]), ("two", [37, 50, 100])):
        for number, end in enumerate(ends):
            given = {"frames": "ply"} if number == 0 else {}
            job = Run(config, tmp_path / folder, resume=number > 0, **given)
            assert job.advance(end)
            job.close()
    assert same_files(tmp_path / "one", tmp_path / "two")
    assert len(list((tmp_path / "two" / "frames").glob("*.ply"))) == 12


@pytest.mark.parametrize("kind", ["ply", "obj", "vtk"])
def test_each_frame_has_its_own_triangles(tmp_path, lumpy, kind):
    """As after a bond flip: two triangles on an edge become the two on the other diagonal."""
    triangles = lumpy.triangles.copy()
    a, b = lumpy.edges[40].tolist()
    left, right = np.flatnonzero(np.isin(triangles, (a, b)).sum(axis=1) == 2).tolist()
    c, d = (next(iter({*triangles[side].tolist()} - {a, b})) for side in (left, right))
    triangles[left] = [d, c, a]
    triangles[right] = [c, d, b]
    flipped = Mesh(lumpy.vertices, triangles)
    assert {a, b} not in [set(edge) for edge in flipped.edges.tolist()]
    writer = MeshFrames(tmp_path / "frames", "run", kind, ["m"])
    writer.write(0, 0, 0.0, [(lumpy.vertices, lumpy.triangles)])
    writer.write(1, 1, 0.1, [(flipped.vertices, flipped.triangles)])
    for number, mesh in enumerate((lumpy, flipped)):
        path = tmp_path / f"frames/run_m_{number:06d}.{kind}"
        assert Mesh.read(path) == mesh
        if kind != "obj":
            expected = analysis.mean_curvature(mesh.vertices, mesh.triangles)
            assert np.allclose(table(path)["mean_curvature"], expected, rtol=1e-12)
    writer.remove_from(1)
    assert [path.stem for path in (tmp_path / "frames").iterdir()] == ["run_m_000000"]


def test_an_unknown_format_is_refused(tmp_path):
    with pytest.raises(
        ValueError,
        match="frames must be one of none, ply, obj, stl, vtk, vtkhdf, gsd, extxyz, got 'off'",
    ):
        frames_writer(tmp_path, "run", "off", ["m"])


@pytest.mark.parametrize("kind", ["obj", "vtk"])
def test_ovito_reads_the_frames(config, tmp_path, kind):
    """One after another, and back, with the triangles of each."""
    ovito = pytest.importorskip("ovito.io", reason="OVITO is not installed")
    config.write_text(CONFIG.replace('name = "a"\n', 'name = "a"\nflips = 0.5\n'))
    job = Run(config, tmp_path / "out", frames=kind)
    job.advance(100)
    job.close()
    pattern = tmp_path / "out" / "frames" / f"pair_a_0*.{kind}"
    pipeline = ovito.import_file(str(pattern))
    assert pipeline.source.num_frames == 6
    changed = []
    for number in (0, 5, 3, 1, 4, 2):
        data = pipeline.compute(number)
        (surface,) = (o for o in data.objects if type(o).__name__ == "TriangleMesh")
        mesh = Mesh.read(tmp_path / "out" / "frames" / f"pair_a_{number:06d}.{kind}")
        assert np.allclose(surface.get_vertices(), mesh.vertices, rtol=1e-6)
        assert np.array_equal(surface.get_faces(), mesh.triangles)
        changed.append(surface.get_faces().tolist())
    assert changed[0] != changed[1]
