"""The command `mesh`: its files read back and compared with what Mesh does."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner
from openmmhelfrich import Mesh
from openmmhelfrich.cli import main


def invoke(*arguments):
    return CliRunner().invoke(main, ["mesh", *(str(word) for word in arguments)])


def done(*arguments):
    result = invoke(*arguments)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture
def ball(tmp_path):
    path = tmp_path / "ball.ply"
    Mesh.random_sphere(92, 40.0, seed=4).translated((1, 2, 3)).write(path)
    return path


def close(one, other):
    return np.array_equal(one.triangles, other.triangles) and np.allclose(
        one.vertices, other.vertices, rtol=0, atol=1e-10
    )


def test_icosphere(tmp_path):
    path = tmp_path / "sphere.off"
    text = done("icosphere", 4, path, "--radius", 12.5)
    assert Mesh.read(path) == Mesh.icosphere(4, 12.5)
    assert f"wrote {path}: 162 vertices, 320 triangles" in text


def test_random(tmp_path):
    path = tmp_path / "sphere.ply"
    done("random", 100, path, "--radius", 7, "--seed", 5)
    assert Mesh.read(path) == Mesh.random_sphere(100, 7, seed=5)
    other = tmp_path / "other.ply"
    done("random", 100, other, "--radius", 7)
    assert Mesh.read(other) == Mesh.random_sphere(100, 7, seed=0)


@pytest.mark.parametrize("extension", ["obj", "off", "vtk", "vtu", "msh", "ply"])
def test_convert(ball, tmp_path, extension):
    path = tmp_path / f"out.{extension}"
    done("convert", ball, path)
    assert Mesh.read(path) == Mesh.read(ball)


def test_convert_turns_triangles_outward(tmp_path):
    source, path = tmp_path / "in.obj", tmp_path / "out.ply"
    mesh = Mesh.icosphere(1, 2.0)
    rows = [f"v {x} {y} {z}" for x, y, z in mesh.vertices.tolist()]
    rows += [f"f {c + 1} {b + 1} {a + 1}" for a, b, c in mesh.triangles.tolist()]
    source.write_text("\n".join(rows))
    done("convert", source, path)
    text = path.read_text().splitlines()
    faces = np.array([row.split()[1:] for row in text if row.startswith("3 ")], dtype=int)
    a, b, c = (mesh.vertices[faces[:, k]] for k in range(3))
    assert len(faces) == 20
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a) > 0).all()


TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--scale", -2], lambda m: m.scaled(-2)),
        (["--stretch", 1, 2, -0.5], lambda m: m.scaled((1, 2, -0.5))),
        (["--oblate", 0.7], lambda m: m.oblate(0.7)),
        (["--prolate", 0.7], lambda m: m.prolate(0.7)),
        (["--deform", 3, -2, 0.1], lambda m: m.deformed(3, -2, 0.1)),
        (["--rotate", 0, 0, 90], lambda m: m.rotated(TURN)),
        (["--translate", -1, 0, 5], lambda m: m.translated((-1, 0, 5))),
        # In the order of the command line, which matters here.
        (["--translate", 5, 0, 0, "--scale", 3], lambda m: m.translated((5, 0, 0)).scaled(3)),
        (["--scale", 3, "--translate", 5, 0, 0], lambda m: m.scaled(3).translated((5, 0, 0))),
    ],
)
def test_transform(ball, tmp_path, arguments, expected):
    path = tmp_path / "out.ply"
    done("transform", ball, path, *arguments)
    assert close(Mesh.read(path), expected(Mesh.read(ball)))


def test_radius_is_that_of_the_area(ball, tmp_path):
    path = tmp_path / "out.ply"
    done("transform", ball, path, "--radius", 10)
    assert Mesh.read(path).area == pytest.approx(400 * np.pi, rel=1e-12)


def test_info(ball):
    mesh = Mesh.read(ball)
    facts = json.loads(done("info", ball, "--json", "--softness", 0.2))
    assert facts["vertices"] == 92
    assert facts["triangles"] == 180
    assert facts["components"] == 1
    assert facts["Euler characteristic"] == 2
    degrees = facts["vertices by degree"]
    assert sum(int(degree) * count for degree, count in degrees.items()) == 2 * len(mesh.edges)
    assert degrees["5"] - degrees.get("7", 0) == 12
    assert facts["area (nm²)"] == pytest.approx(mesh.area)
    assert facts["volume (nm³)"] == pytest.approx(mesh.volume)
    assert facts["least height d at Ξ = 0.2 (nm)"] == pytest.approx(mesh.min_height(0.2))
    lengths = [np.linalg.norm(mesh.vertices[i] - mesh.vertices[j]) for i, j in mesh.edges]
    assert facts["edges, least to largest (nm)"] == pytest.approx([min(lengths), max(lengths)])
    # Twice the area over each side.
    heights = []
    for triangle in mesh.triangles:
        p, q, r = mesh.vertices[triangle]
        area = np.linalg.norm(np.cross(q - p, r - p)) / 2
        heights += [2 * area / np.linalg.norm(side) for side in (q - p, r - q, p - r)]
    assert facts["heights, least to largest (nm)"] == pytest.approx([min(heights), max(heights)])


def test_info_on_what_has_no_inside(tmp_path):
    path = tmp_path / "flat.ply"
    Mesh.disk(2, 10).write(path)
    facts = json.loads(done("info", path, "--json"))
    assert facts["edges of borders"] == [12]
    assert "volume (nm³)" not in facts
    Mesh.sheet(4, 4, 5, periodic=True).write(path)
    facts = json.loads(done("info", path, "--json"))
    assert facts["volume (nm³)"] is None
    assert facts["box (nm)"][0] == [20, 0, 0]
    # Across the faces of the box too.
    assert facts["edges, least to largest (nm)"] == pytest.approx([5, 5])
    assert "none" in done("info", path)


@pytest.mark.parametrize("flat", [Mesh.disk(2, 10), Mesh.sheet(4, 4, 5, periodic=True)])
def test_transform_of_what_has_no_inside(tmp_path, flat):
    path = tmp_path / "flat.ply"
    flat.write(path)
    assert "reduced volume" not in done("transform", path, tmp_path / "out.ply", "--scale", 2)
    assert Mesh.read(tmp_path / "out.ply") == flat.scaled(2)


def test_info_as_text(ball):
    lines = done("info", ball).splitlines()
    assert lines[0] == str(ball)
    assert any(line.split() == ["vertices", "92"] for line in lines)
    assert any("12 of 5" in line or "of 6" in line for line in lines)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["icosphere", 0, "new.ply"], "Mesh.icosphere: n must be 1 or more, got 0"),
        (["icosphere", 2, "new.ply", "--radius", -1], "radius must be above 0"),
        (["icosphere", 2, "new.ply", "--radius", "nan"], "radius must be finite"),
        (["icosphere", 2, "new.docx"], "unknown extension '.docx'"),
        (["icosphere", 2, "none/new.ply"], "No such file or directory"),
        (["random", 13, "new.ply"], "no triangulation of the sphere has 13 vertices"),
        (["random", 20, "new.ply", "--seed", -1], "seed must be 0 or more, got -1"),
        (["info", "none.ply"], "there is no file none.ply"),
        (["info", "broken.ply"], "broken.ply"),
        (["convert", "ball.ply", "ball.ply"], "ball.ply is there already; overwrite it with --fo"),
        (["transform", "ball.ply", "new.ply"], "nothing to do: give a transformation"),
        (["transform", "ball.ply", "new.ply", "--scale", 0], "finite and not 0"),
        (["transform", "ball.ply", "new.ply", "--radius", 0], "needs a radius above 0, got 0.0"),
        (["transform", "ball.ply", "new.ply", "--oblate", 2], "Mesh.oblate: reduced_volume must"),
        (["transform", "ball.ply", "new.ply", "--scale", 2, "--scale", 3], "give it once"),
    ],
)
def test_mistakes(ball, monkeypatch, arguments, message):
    monkeypatch.chdir(ball.parent)
    (ball.parent / "broken.ply").write_text("ply\nformat ascii 1.0\n")
    before = ball.read_bytes()
    result = invoke(*arguments)
    assert result.exit_code in (1, 2)
    assert message in result.output
    assert "Traceback" not in result.output
    assert not (ball.parent / "new.ply").exists()
    assert ball.read_bytes() == before


def test_force_overwrites(ball):
    scaled = Mesh.read(ball).scaled(2)
    done("transform", ball, ball, "--scale", 2, "--force")
    assert close(Mesh.read(ball), scaled)


CUBE = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
SQUARES = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
# The fourth square, on vertices of its own, 1e-7 away.
TORN = "".join(f"v {x} 1.0000001 {z}\n" for z in (0, 1) for x in (0, 1)) + SQUARES.replace(
    "f 3 7 8 4", "f 9 11 12 10"
)


@pytest.mark.parametrize(
    ("text", "message", "options"),
    [
        (CUBE + SQUARES, "face 1 has 4 vertices, not 3; .*--triangulate", []),
        (CUBE + "v 5 5 5\n" + SQUARES, "--drop-unused", ["--drop-unused"]),
        (CUBE + TORN, r"4 pair\(s\) of vertices nearly coincide.*--merge 2e-07", ["--merge", 2e-7]),
    ],
)
def test_what_a_refusal_names_mends_it(tmp_path, text, message, options):
    source, path = tmp_path / "cube.obj", tmp_path / "new.ply"
    source.write_text(text)
    split = ["--triangulate"] if options else []
    result = invoke("convert", source, path, *split)
    assert result.exit_code == 1
    assert re.search(message, result.output)
    assert not path.exists()
    options = ["--triangulate", *options]
    assert "8 vertices, 12 triangles, area 6 nm²" in done("convert", source, path, *options)
    assert Mesh.read(path).volume == pytest.approx(1, rel=1e-6)
    assert json.loads(done("info", source, "--json", *options))["vertices"] == 8
    done("transform", source, path, "--scale", 2, "--force", *options)
    assert Mesh.read(path).volume == pytest.approx(8, rel=1e-6)
