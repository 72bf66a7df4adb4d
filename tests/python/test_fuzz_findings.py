"""What `make fuzz` has found, smallest inputs first reduced: docs/reliability.md lists them."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import struct
import subprocess
import sys
import zipfile

import meshes
import meshio
import numpy as np
import openmm as mm
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich import Mesh, MeshError, _blocks, config, vcm
from openmmhelfrich.vcm.expressions import Expression, ExpressionError

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
def test_huge_coordinates_name_the_vertex(tmp_path, options):
    rows = ["-1e308 0 0", "1e308 0 0", "0 1e200 0", *ROWS[3:]]
    said = refused(tmp_path / "m.ply", ply(rows=rows), **options)
    assert said.startswith("Mesh.read: m.ply: ") and "vertex 0" in said


def test_merging_what_is_in_the_same_place_only(tmp_path):
    rows = [*ROWS[:3], "1e-200 0 0", "-1 0 0", "0 -1 0", "3 0 1 2", "3 3 4 5", ""]
    data = ply(("vertex 3", "vertex 6"), ("face 1", "face 2"), rows=rows)
    (tmp_path / "m.ply").write_bytes(data)
    assert Mesh.read(tmp_path / "m.ply", merge=0).num_vertices == 6


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


@pytest.mark.parametrize("count", ["3000000000000", "9" * 30])
def test_vtk_counts_take_no_more_memory_than_the_file(tmp_path, count):
    lines = ["# vtk DataFile Version 3.0", "x", "ASCII", "DATASET POLYDATA"]
    said = refused(tmp_path / "m.vtk", "\n".join([*lines, f"POINTS {count} float", "0"]).encode())
    assert said.startswith("Mesh.read: m.vtk, line 5: ") and "points need" in said


def test_vtk_indices_beyond_64_bits(tmp_path):
    lines = ["# vtk DataFile Version 3.0", "x", "ASCII", "DATASET POLYDATA", "POINTS 3 float"]
    lines += [*ROWS[:3], "POLYGONS 1 4", f"3 0 1 {'9' * 30}"]
    said = refused(tmp_path / "m.vtk", "\n".join(lines).encode())
    assert said.startswith("Mesh.read: m.vtk, line 10: expected numbers")


@pytest.mark.parametrize("word", ["1_0", "\u0661"])
@pytest.mark.parametrize("extension", ["ply", "obj", "off", "vtk", "vtp"])
def test_only_python_takes_these_for_numbers(tmp_path, extension, word):
    path = tmp_path / f"m.{extension}"
    mesh = Mesh.icosphere(1, 10)
    if extension == "vtp":
        points = " ".join(["1"] * 8 + [word])
        data = (
            '<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="3"><Points>'
            f'<DataArray type="Float64">{points}</DataArray></Points></Piece></PolyData></VTKFile>'
        )
    else:
        mesh.write(path)
        first = repr(mesh.vertices[0, 1].item())
        data = path.read_text()
        assert first in data
        data = data.replace(first, word, 1)
    said = refused(path, data.encode())
    assert "number" in said or "coordinates" in said or "cannot be read" in said


def test_vtk_announces_a_number_of_thousands_of_digits(tmp_path):
    data = f'<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="{"9" * 5000}"><Points>'
    data += "<DataArray type='Float64'>0 0 0</DataArray></Points></Piece></PolyData></VTKFile>"
    assert "points were announced" in refused(tmp_path / "m.vtp", data.encode())


@pytest.mark.filterwarnings("error")
def test_signalling_nan_is_named_without_a_warning(tmp_path):
    facets = np.zeros(1, [("normal", "<f4", 3), ("corners", "<u4", (3, 3)), ("attribute", "<u2")])
    facets["corners"] = 0x7FA00000
    data = bytes(80) + (1).to_bytes(4, "little") + facets.tobytes()
    assert "not finite" in refused(tmp_path / "m.stl", data)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("far", [1e100, 1e160, 1e308])
def test_coordinates_whose_cubes_are_no_numbers_are_named(tmp_path, far):
    """Areas may be small. Polygons and borders were looked at with a warning."""
    triangle = f"OFF\n3 1 0\n0 0 0\n1 0 0\n{far} 1 0\n3 0 1 2\n"
    assert "vertex 2 is at (1e" in refused(tmp_path / "m.off", triangle.encode())
    path = tmp_path / "n.off"
    path.write_text(f"OFF\n4 1 0\n0 0 0\n1 0 0\n{far} 1 0\n0 1 0\n4 0 1 2 3\n")
    with pytest.raises(MeshError, match="face 0 cannot be split"):
        Mesh.read(path, triangulate=True)
    with pytest.raises(MeshError, match="below 1e100"):
        Mesh.icosphere(1, 3.0).translated((0, far, 0))
    with pytest.raises(MeshError, match=r"below 1e100|is not finite"):
        Mesh.icosphere(1, 3.0).scaled(far)
    if far > 1e307:
        mesh = Mesh.icosphere(1, 3.0)
        with pytest.raises(MeshError, match="box"):
            Mesh(mesh.vertices, mesh.triangles, np.eye(3) * 20).scaled(far)


def test_a_mesh_whose_volume_is_lost_comes_back_as_it_was(tmp_path):
    sphere = Mesh.icosphere(1, 10.0)
    vertices = sphere.vertices.copy()
    # Along the plane of what is around it, so that the volume stays, but not along a side.
    a, b, c = np.moveaxis(vertices[sphere.triangles[(sphere.triangles == 0).any(axis=1)]], 1, 0)
    around = np.cross(b - a, c - a).sum(axis=0)
    vertices[0] = 1e12 * np.cross(around / np.linalg.norm(around), [3.0, -5.0, 8.0])
    for triangles in (sphere.triangles, sphere.triangles[:, ::-1]):
        mesh = Mesh(vertices, triangles)
        mesh.write(tmp_path / "m.ply")
        assert Mesh.read(tmp_path / "m.ply", merge=0) == mesh


def test_a_mode_of_four_thousand_million_is_refused():
    with pytest.raises(MeshError, match="l must be 1000 or less, got 4294967295"):
        Mesh.icosphere(1, 10.0).deformed(4294967295, 0, 0.1)


@pytest.mark.filterwarnings("error")
def test_lengths_beyond_use_are_refused():
    with pytest.raises(MeshError, match=r"Mesh\.disk: radius must be below 1e\+70 nm, got 1e\+308"):
        Mesh.disk(8, 1e308)
    assert Mesh.disk(8, 0.99e70).num_triangles == 384
    sphere = Mesh.icosphere(1, 10.0)
    with pytest.raises(MeshError, match=r"Mesh: box must be below 1e\+100 nm"):
        Mesh(sphere.vertices, sphere.triangles, np.eye(3) * 1e308)
    with pytest.raises(MeshError, match=r"deformed: amplitude 1e\+308 moves vertex"):
        sphere.deformed(2, 0, 1e308)


@pytest.mark.parametrize("merge", [None, 0.1])
@pytest.mark.parametrize("counted", [13, 44, 7_200_000])
def test_gmsh_files_that_count_more_nodes_than_they_have(tmp_path, merge, counted):
    """meshio makes room for all, and leaves those that do not come as the memory was."""
    Mesh.icosphere(1, 10.0).write(tmp_path / "m.msh")
    data = (tmp_path / "m.msh").read_bytes()
    begin = data.index(b"$Nodes\n") + len(b"$Nodes\n") + 8
    assert data[begin : begin + 8] == (12).to_bytes(8, "little")
    damaged = data[:begin] + counted.to_bytes(8, "little") + data[begin + 8 :]
    (tmp_path / "m.msh").write_bytes(damaged)
    with pytest.raises(
        MeshError,
        match=rf"m\.msh.*: counts {counted} nodes, more than it",
    ):
        Mesh.read(tmp_path / "m.msh", merge=merge)


@pytest.mark.parametrize("binary", [True, False])
def test_msh_files_of_ansys(tmp_path, binary):
    """meshio's reader read on for ever where a bracket stayed open."""
    sphere = Mesh.icosphere(1, 10.0)
    whole = tmp_path / "whole.msh"
    made = meshio.Mesh(sphere.vertices, [("triangle", sphere.triangles)])
    made.write(whole, file_format="ansys", binary=binary)
    read = Mesh.read(whole)
    assert np.array_equal(read.triangles, sphere.triangles)
    assert np.allclose(read.vertices, sphere.vertices, rtol=1e-15)
    data = whole.read_bytes()
    for kept in range(0, len(data) - 3, 7):
        # What is cut off after the last triangle may be missed, never a part of the mesh.
        (tmp_path / "m.MSH").write_bytes(data[:kept])
        with contextlib.suppress(MeshError):
            assert Mesh.read(tmp_path / "m.MSH") == read
    said = refused(tmp_path / "m.MSH", data[: data.rindex(b")") - 1].rstrip(b")\n"))
    assert "m.MSH: meshio cannot read on: EOFError: a bracket is not closed" in said, said


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("(1, $Nodes\n", "a bracket is not closed"),
        ('(0 "of Ansys")\n(10 (0 1 8 0 3))\n', "is the file truncated?"),
        ("solid x\n", "neither with $MeshFormat"),
        ("", "neither with $MeshFormat"),
    ],
)
def test_msh_files_that_hold_no_mesh(tmp_path, text, expected):
    said = refused(tmp_path / "m.MSH", text.encode())
    assert expected in said, said


def test_hexadecimal_numbers_in_xml():
    mesh = Mesh.icosphere(1, 10.0)
    system = mm.System()
    system.addForce(helfrich.BendingForce(mesh, 12345.0))
    text = mm.XmlSerializer.serialize(system)
    assert mm.XmlSerializer.deserialize(text.replace("12345", "1.2e4")) is not None
    for broken in ("0x10", "0X1p4", "1_0", "", "12 "):
        with pytest.raises(mm.OpenMMException, match=r"BendingForce: .* is not a number"):
            mm.XmlSerializer.deserialize(text.replace("12345", broken))


@pytest.mark.parametrize("file_format", ["gmsh22", "gmsh"])
@pytest.mark.parametrize("binary", [True, False])
def test_gmsh_files_whose_nodes_have_enormous_numbers(tmp_path, file_format, binary):
    """meshio makes a list up to the largest: it took ten seconds and some GiB."""
    mesh, path = Mesh.icosphere(2, 10.0), tmp_path / "m.msh"
    plain = meshio.Mesh(1e8 * np.round(mesh.vertices), [("triangle", mesh.triangles)])
    plain.write(path, file_format=file_format, binary=binary)
    # Coordinates may be large.
    np.testing.assert_allclose(Mesh.read(path).vertices, plain.points)
    data, number = path.read_bytes(), 2_000_000_017
    nodes = data.index(b"$Nodes")
    if binary:
        written = struct.pack("<i" if file_format == "gmsh22" else "<q", 33)
        place = data.index(written, nodes + 60)
        data = data[:place] + struct.pack("<i", number) + data[place + 4 :]
    else:
        place = data.index(b"\n33", nodes) + 1
        data = data[:place] + str(number).encode() + data[place + 2 :]
    path.write_bytes(data)
    with pytest.raises(MeshError, match=rf"m\.msh.*: gives a node the number {number};"):
        Mesh.read(path)


@pytest.mark.parametrize(
    "head",
    ["4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {0} 1 {0}\n", "2.2 0 8\n$EndMeshFormat\n$Nodes\n{0}\n"],
)
def test_gmsh_text_that_counts_more_nodes_than_it_has(tmp_path, head):
    (tmp_path / "m.msh").write_text("$MeshFormat\n" + head.format(10**9) + "1 0 0 0\n$EndNodes\n")
    with pytest.raises(MeshError, match=r"m\.msh.*: counts 1000000000 nodes, more than it"):
        Mesh.read(tmp_path / "m.msh")


# --- configurations ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[output]\ninterval = " + "9" * 5000, ":2: an integer has 5000 digits"),
        ("# x\na = " + "[" * 20000, ":2: arrays or tables are nested too deeply"),
    ],
)
def test_toml_that_python_refuses(tmp_path, text, words):
    path = tmp_path / "run.toml"
    path.write_text(text)
    with pytest.raises(vcm.ConfigError, match=f"run.toml{words}"):
        config.read(path)


@pytest.mark.parametrize("word", ["1_0", "\u0661"])
def test_numbers_of_vcm_are_those_of_c(tmp_path, word):
    path = tmp_path / "run.txt"
    path.write_text(f"-GeneralParameters\nSeed {word}\nFrictionIninvertPs {word}\n-Membrane 0\n")
    with pytest.raises(vcm.ConfigError, match=r"run\.txt:2: key Seed: expected an integer"):
        vcm.read(path)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (
            "SimulationTimeInPs 1e308\nStepSizeInFs 1e-10\n-Membrane 0",
            "2: key SimulationTimeInPs: .* time steps",
        ),
        ("StepSizeInFs 5e-324\n-Membrane 0", "1: key SimulationTimeInPs .* time steps"),
        ("-Membrane 0\nMeshFile m.ply\nULM 0.1 4294967295 0", "4: key ULM: .*must be 1000 or less"),
        (
            "-Membrane 0\nMeshFile m.ply\nCoordinateTranslateVector 1e19 0 0",
            "4: key CoordinateTranslateVector: .* are both at",
        ),
        ("-Membrane 0\nMeshFile m.ply\nScale 1e308", "3: key MeshFile: .* not finite"),
        ("-Membrane 0\nMeshFile m.ply\nULM 1e308 2 0", "4: key ULM: .*amplitude 1e\\+308"),
        (
            "-Membrane 0\nMeshFile m.ply\nNUL 1 0.1 9223372036854775807",
            "4: key NUL: expected .* lmax from 2 to 1000",
        ),
    ],
)
def test_numbers_beyond_use_are_named(tmp_path, lines, words):
    Mesh.icosphere(1, 10.0).write(tmp_path / "m.ply")
    path = tmp_path / "run.txt"
    path.write_text(f"-GeneralParameters\n{lines}\n")
    with pytest.raises(vcm.ConfigError, match=rf"run\.txt:(?:{words})"):
        vcm.read(path)


def test_a_duration_of_too_many_steps_is_named(tmp_path):
    Mesh.icosphere(1, 10.0).write(tmp_path / "m.ply")
    path = tmp_path / "run.toml"
    path.write_text('[simulation]\nduration = 1e300\n[[vesicle]]\nmesh = {file = "m.ply"}\n')
    with pytest.raises(vcm.ConfigError, match=r"run\.toml:2: .*duration.* time steps"):
        config.read(path)


# --- saved states and connectivity ---------------------------------------------------------------


@pytest.fixture
def flowing():
    """A Context with all that a saved state has, and a force on its triangles."""
    membrane = meshes.membrane("octahedron")
    bending = helfrich.BendingForce(membrane.triangles, 50)
    bending.setUsesPeriodicBoundaryConditions(True)
    system = mm.System()
    for _ in range(membrane.num_particles):
        system.addParticle(50)
    system.setDefaultPeriodicBoxVectors((900, 0, 0), (0, 900, 0), (0, 0, 900))
    for force in (
        bending,
        helfrich.MonteCarloBondFlip(membrane.triangles, 300, 1, 0.5),
        helfrich.MonteCarloMembraneTension(300, 0.0),
    ):
        system.addForce(force)
    platform = mm.Platform.getPlatformByName("Helfrich")
    context = mm.Context(system, mm.VerletIntegrator(1e-4), platform)
    context.setPositions(membrane.positions)
    context.getIntegrator().step(3)
    return context, bending


def checksummed(data: bytes) -> bytes:
    """With FNV-1a, as the library writes it."""
    found = 0xCBF29CE484222325
    for byte in data:
        found = (found ^ byte) * 0x100000001B3 % 2**64
    return data + struct.pack("<Q", found)


@pytest.mark.parametrize(
    ("at", "count"), [(16, -1), (16, 9), (16, 2**30), (20, -1), (20, 5), (20, 2**30)]
)
def test_counts_that_do_not_fit_the_connectivity(flowing, at, count):
    """The checksum is right: these read beyond the end, or asked for all memory."""
    context, force = flowing
    saved = force._saveConnectivity(context)
    wrong = saved[:at] + struct.pack("<i", count) + saved[at + 4 : -8]
    for data in (checksummed(wrong), checksummed(saved[:30]), checksummed(saved[:-9]), b"x"):
        with pytest.raises(mm.OpenMMException, match="saved connectivity is damaged"):
            force._restoreConnectivity(context, data)
    assert force._saveConnectivity(context) == saved


def in_place_of(blocks: dict, name: str, value) -> bytes:
    changed = dict(blocks)
    if value is None:
        del changed[name]
    else:
        changed[name] = _blocks.Block(value)
    return _blocks.pack("state", changed)


def test_blocks_of_other_types_change_nothing(flowing, tmp_path):
    context, force = flowing
    path = tmp_path / "run.state"
    helfrich.save_state(context, path)
    names = ("positions", "velocities", "box", "parameters", "clock", "connectivity", "tension")
    blocks = _blocks.unpack(path.read_bytes(), "state", dict.fromkeys(names, 1))
    context.getIntegrator().step(2)

    def present():
        state = context.getState(positions=True, velocities=True)
        return str(state.getPositions()), str(state.getTime()), force._saveConnectivity(context)

    before = present()
    wild = [np.zeros((2, 3)), np.zeros(3), np.array(["x"]), b"x", {"step": 3}, [1], 7]
    wild += [{"time": "0x1p+0", "step": 2**63}, {"time": "0x1p+9999", "step": 1}, {"a": "x"}]
    count = 0
    for name in blocks:
        for value in wild:
            # Nothing says how much bytes mean but the force, which is asked then.
            path.write_bytes(in_place_of(blocks, name, value))
            with pytest.raises((ValueError, mm.OpenMMException)) as caught:
                helfrich.load_state(context, path)
            assert "run.state" in str(caught.value) or "saved" in str(caught.value)
            assert present() == before
            count += 1
    assert count == len(blocks) * len(wild)


def test_files_of_blocks_by_another_hand(flowing, tmp_path):
    """Under a checksum that is right: no archive, and one without an index."""
    path = tmp_path / "run.state"
    empty = io.BytesIO()
    zipfile.ZipFile(empty, "w").close()
    for body in (b"no archive", empty.getvalue()):
        head = _blocks._HEAD.pack(_blocks._MAGIC, 1, 52 + len(body))
        path.write_bytes(head + _blocks._digest(head, body) + body)
        with pytest.raises(ValueError, match=r"run\.state is not made as"):
            helfrich.load_state(flowing[0], path)


# --- expressions ---------------------------------------------------------------------------------


@pytest.mark.parametrize("point", ["p\u00b2", "p" + "9" * 5000])
def test_points_that_python_takes_for_numbers(point):
    with pytest.raises(ExpressionError, match="is no particle"):
        Expression(f"distance(p1,{point})", 2)


def test_digits_and_spaces_are_those_of_openmm():
    """To OpenMM those of other scripts are letters."""
    assert Expression("\u0661*x1", 1).variables == {"\u0661", "x1"}
    for text in ("x1*2\u0660", "2\u00a0*x1"):
        with pytest.raises(ExpressionError, match="unexpected"):
            Expression(text, 1)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("energy", ["5e-324", "-1e308", "1e1-1e308"])
def test_energies_that_nothing_can_be_divided_by_are_left_alone(energy):
    mesh = Mesh.icosphere(1, 3.0)
    force = mm.CustomCompoundBondForce(3, energy)
    for triangle in mesh.triangles.tolist():
        force.addBond(triangle, [])
    system = mm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(50)
    system.addForce(force)
    found, _ = vcm.accelerate(system)
    assert isinstance(found.getForce(0), mm.CustomCompoundBondForce)


@pytest.mark.parametrize(
    "line",
    [
        "flips = { attempts_per_edge = 4294967295 }",
        "flips = { frequency = 4294967296 }",
        "flips = { min_degree = 9, max_degree = 4 }",
        "viscosity = { friction = 1, frequency = 4294967296 }",
    ],
)
def test_toml_that_movers_refuse(tmp_path, line):
    path = tmp_path / "run.toml"
    start = (
        "simulation.duration = 1\nintegrator.time_step = 0.1\noutput.interval = 1\n[[vesicle]]\n"
    )
    path.write_text(f"{start}{line}\nmesh = {{ icosphere = 2, radius = 30 }}\n")
    with pytest.raises(vcm.ConfigError, match=r"run\.toml:[45]: key vesicle"):
        config.read(path)


# --- XML -----------------------------------------------------------------------------------------

ELSEWHERE = """
import locale
import openmm as mm
import openmmhelfrich as helfrich

locale.setlocale(locale.LC_NUMERIC, "de_DE.UTF-8")
assert locale.localeconv()["decimal_point"] == ","
force = helfrich.BendingForce([(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)], 1.5)
text = mm.XmlSerializer.serialize(force)
assert mm.XmlSerializer.serialize(mm.XmlSerializer.deserialize(text)) == text and "1.5" in text
"""


def test_xml_in_a_locale_with_a_comma(tmp_path):
    """As a program with windows sets it, in whose Python a System is read."""
    command = ["localedef", "-i", "de_DE", "-f", "UTF-8", tmp_path / "de_DE.UTF-8"]
    if shutil.which("localedef") is None or subprocess.run(command, capture_output=True).returncode:
        pytest.skip("no locale with a comma can be made")
    places = {**os.environ, "LOCPATH": str(tmp_path)}
    command = [sys.executable, "-c", ELSEWHERE]
    done = subprocess.run(command, env=places, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
