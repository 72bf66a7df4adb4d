"""The viewer's pages without a browser: their numbers, what is in them, and the doors to them."""

import base64
import fcntl
import html
import json
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import types
import zlib
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from openmm import app
from openmm.app.internal.xtc_utils import xtc_write_frame
from openmmhelfrich import Mesh, analysis
from openmmhelfrich.viewer import scene as scenes
from openmmhelfrich.viewer import xtc
from openmmhelfrich.viewer.live import LivePage
from openmmhelfrich.viewer.notebooks import register
from openmmhelfrich.viewer.page import page
from openmmhelfrich.viewer.scene import Scene
from run_files import fluid_and_solid, invoke, results


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run of a vesicle that flows and one that does not, 11 frames."""
    folder = tmp_path_factory.mktemp("view")
    path = folder / "pair.toml"
    path.write_text(fluid_and_solid(20, 2, "vtkhdf"))
    result = invoke("run", path, "--out", folder / "pair")
    assert result.exit_code == 0, result.output
    return folder / "pair"


@pytest.fixture(scope="module")
def shown(run):
    return helfrich.view(run).scene


@pytest.fixture(scope="module")
def stored(run):
    """Positions and triangles of all frames, as `analysis` reads them."""
    trajectory = analysis.Trajectory(run / "pair.xtc")
    return trajectory.read(), np.array(trajectory.triangles())


def unpacked(text):
    """What the page of a scene holds: its header, and meshes and frames of its block."""
    header = json.loads(re.search(r'id="header">(.*?)</script>', text, re.S)[1])
    data = zlib.decompress(base64.b64decode(re.search(r'id="block">(.*?)</script>', text)[1]))
    place = 0

    def take(count, dtype):
        nonlocal place
        size = np.dtype(dtype).itemsize
        block = np.frombuffer(data, np.uint8, count * size, place).reshape(size, count)
        place += count * size
        return np.ascontiguousarray(block.T).view(dtype).ravel()

    meshes, before = [], None
    for mesh in header["meshes"]:
        corners = take(3 * mesh["triangles"], "<u4")
        before = corners ^ before if mesh["after"] else corners
        meshes.append((before.reshape(-1, 3), take(mesh["points"], "<u2")))
    frames = []
    for frame in header["frames"]:
        count = header["meshes"][frame["mesh"]]["points"]
        axes = np.stack([take(count, "<u2") for _ in range(3)], axis=1).astype(float)
        points = frame["low"] + axes / 65534 * frame["size"] + frame["middle"]
        fields = [take(count, "<u2") for _ in header["fields"]]
        frames.append((points, fields, meshes[frame["mesh"]]))
    assert place == len(data)
    return header, frames


def series(scene, surface, label, unit):
    (found,) = [s for s in scene.series() if (s.surface, s.label, s.unit) == (surface, label, unit)]
    return np.array(found.values)


def test_numbers_are_those_of_the_analysis(shown, stored):
    positions, triangles = stored
    assert shown.names == ["fluid", "solid"]
    surfaces = analysis.surface_series.components(triangles[0], positions.shape[1])
    for surface in (None, 0, 1):
        wanted = surfaces >= 0 if surface is None else surfaces == surface
        chosen = np.flatnonzero(wanted)
        rows = np.isin(triangles[0, :, 0], chosen)
        corners = np.searchsorted(chosen, triangles[:, rows])
        expected = analysis.shape(positions[:, chosen], corners)
        curvature = analysis.mean_curvature(positions[:, chosen], corners)
        for label, unit, values in (
            ("area", "nm²", expected.area),
            ("volume", "nm³", expected.volume),
            ("least curvature", "1/nm", curvature.min(axis=1)),
            ("largest curvature", "1/nm", curvature.max(axis=1)),
        ):
            np.testing.assert_allclose(series(shown, surface, label, unit), values, rtol=1e-12)
        if surface is not None:
            found = series(shown, surface, "reduced volume", "")
            np.testing.assert_allclose(found, expected.reduced_volume, rtol=1e-12)
            spectra = shown.spectra()[surface]
            # 132 and 92 vertices resolve modes up to √N/2.
            lmax = (5, 4)[surface]
            assert spectra.shape == (11, lmax - 1)
            modes = analysis.mode_amplitudes(positions[:, chosen], corners, lmax)
            mean = analysis.spectrum(modes).mean[2:]
            np.testing.assert_allclose(spectra.mean(axis=0), mean, rtol=1e-8)


def test_energies_are_those_of_the_table(run, shown):
    lines = (run / "pair.csv").read_text().splitlines()
    names = lines[0].split(",")
    rows = np.array([line.split(",") for line in lines[1:]], dtype=float)
    terms = [name for name in names if name.endswith(" (kJ/mol)")]
    assert len(terms) >= 10
    assert "bending fluid (kJ/mol)" in terms
    for name in terms:
        found = series(shown, None, name.removesuffix(" (kJ/mol)"), "kJ/mol")
        np.testing.assert_array_equal(found, rows[:, names.index(name)])
    np.testing.assert_array_equal([frame.step for frame in shown.frames], rows[:, 0])


def test_vertices_have_the_values_of_the_analysis(lumpy):
    scene = helfrich.view(lumpy).scene
    curvature, area, angle, neighbours = scene.frames[0].fields
    found = analysis.vertex_quantities(lumpy.vertices, lumpy.triangles)
    np.testing.assert_allclose(curvature, found.mean_curvature(), rtol=1e-6)
    np.testing.assert_allclose(area, found.barycentric_area, rtol=1e-6)
    np.testing.assert_array_equal(neighbours, lumpy.degrees)
    largest = [
        np.degrees(np.abs(lumpy.dihedral_angles[(lumpy.edges == vertex).any(axis=1)]).max())
        for vertex in range(lumpy.num_vertices)
    ]
    np.testing.assert_allclose(angle, largest, rtol=1e-6)


def test_the_page_holds_positions_triangles_and_values(shown, stored):
    header, frames = unpacked(page(shown))
    for (points, fields, (corners, _)), positions, triangles, frame in zip(
        frames, *stored, shown.frames, strict=True
    ):
        np.testing.assert_array_equal(corners, triangles)
        extent = np.ptp(positions, axis=0).max()
        assert abs(points - positions).max() < 0.51 * extent / 65534 + 1e-3
        for whole, values, field in zip(fields, frame.fields, header["fields"], strict=True):
            steps = abs(field["least"] + whole / 65534 * field["width"] - values)
            assert steps.max() < 0.51 * field["width"] / 65534
    assert (stored[1][0] != stored[1][-1]).any()


def test_the_page_needs_nothing_else(shown):
    text = page(shown)
    # The namespace of SVG is a name, not an address.
    addresses = set(re.findall(r"https?://[^\s\"'<>)]*", text))
    assert addresses == {"http://www.w3.org/2000/svg"}
    assert not re.findall(r"\bsrc\s*=|@import|\bimport\s*\(", text)
    assert re.findall(r"href=\"([^\"]*)\"", text) == ["data:,"]
    assert "default-src 'none'" in text


def test_names_cannot_break_the_page(lumpy):
    name = "</script><script>alert(1)</script>{{block}}"
    scene = Scene(name, [name])
    scene.add(lumpy.vertices, lumpy.triangles, energies={name: 1.0})
    text = page(scene)
    assert "<script>alert" not in text
    header, _ = unpacked(text)
    assert header["title"] == name
    assert header["surfaces"] == [name]
    assert html.unescape(re.search("<title>(.*)</title>", text)[1]) == name


@pytest.mark.long
def test_a_long_run_is_below_ten_megabytes(monkeypatch):
    """1002 vertices and 200 frames, rough and with triangles that have nothing in common."""
    monkeypatch.setattr(scenes, "_spectrum", lambda *arguments: None)
    meshes = [Mesh.random_sphere(1002, radius=1000, seed=seed) for seed in (1, 2, 3)]
    random = np.random.default_rng(1)
    scene = Scene("long")
    for number in range(200):
        mesh = meshes[number % 3]
        rough = mesh.vertices * random.normal(1, 0.02, (1002, 1))
        scene.add(rough, mesh.triangles, step=number, time=number)
    assert len(scene.meshes) == 200
    assert len(page(scene).encode()) < 10e6


def test_borders_and_boxes():
    sheet = Mesh.sheet(8, 6, spacing=5, periodic=True)
    bent = sheet.vertices + [0, 0, 1] * np.sin(np.arange(sheet.num_vertices))[:, np.newaxis]
    sheet = Mesh(bent, sheet.triangles, sheet.box)
    scene = helfrich.view(sheet).scene
    assert series(scene, 0, "area", "nm²")[0] == pytest.approx(sheet.area, rel=1e-12)
    assert not [s for s in scene.series() if "volume" in s.label]
    curvature = analysis.mean_curvature(sheet, sheet)
    least = series(scene, 0, "least curvature", "1/nm")[0]
    assert least == pytest.approx(curvature.min(), rel=1e-12)
    # Images have the values of their vertices, across the faces of the box too.
    (frame,) = scene.frames
    assert len(frame.points) > sheet.num_vertices
    assert len(np.unique(frame.fields[0])) == len(np.unique(curvature.astype(np.float32)))
    assert scene.spectra() == [None]

    disk = Mesh.disk(20, 5)
    (frame,) = helfrich.view(disk).scene.frames
    border = np.unique(np.concatenate(disk.border_loops))
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(frame.fields[0])), border)
    _, frames = unpacked(page(helfrich.view(disk).scene))
    np.testing.assert_array_equal(np.flatnonzero(frames[0][1][0] == 65535), border)


def test_a_simulation_is_shown_as_it_is(pair):
    """Each triangle once, though a force of contacts has it too, and after flips."""
    vesicle = helfrich.Mesh.icosphere(4, radius=100)
    system = openmm.System()
    for _ in range(vesicle.num_vertices + 3):
        system.addParticle(50)
    system.addForce(helfrich.BendingForce(vesicle, rigidity=50, offset=3))
    system.addForce(helfrich.SurfaceRepulsionForce(vesicle, distance=5, epsilon=1, offset=3))
    mover = helfrich.MonteCarloBondFlip(vesicle, 300, frequency=1, attemptsPerEdge=1, offset=3)
    system.addForce(mover)
    context = openmm.Context(system, openmm.VerletIntegrator(0.01))
    context.setPositions(np.concatenate([np.zeros((3, 3)), vesicle.vertices]))
    context.getIntegrator().step(3)
    now = Mesh.from_context(context, mover)
    assert (now.triangles != vesicle.triangles).any()
    scene = helfrich.view(context).scene
    assert series(scene, 0, "area", "nm²")[0] == pytest.approx(now.area, rel=1e-12)
    corners = {frozenset(row) for row in scene.meshes[0][0].tolist()}
    assert corners == {frozenset(row) for row in now.triangles.tolist()}
    assert len(scene.meshes[0][0]) == now.num_triangles


def test_positions_and_triangles(lumpy):
    frames = np.stack([lumpy.vertices, 2 * lumpy.vertices])
    areas = series(helfrich.view(frames, lumpy).scene, 0, "area", "nm²")
    np.testing.assert_allclose(areas, [lumpy.area, 4 * lumpy.area])
    assert repr(helfrich.view(frames, lumpy.triangles, every=2)) == "View('surface', 1 frame)"


def test_thinning_keeps_what_belongs_together(shown, stored):
    scene = Scene("thin", shown.names)
    for step, (positions, triangles) in enumerate(zip(*stored, strict=True)):
        scene.add(positions, triangles, step=step)
    scene.thin()
    assert [frame.step for frame in scene.frames] == list(range(0, len(stored[0]), 2))
    for frame in scene.frames:
        np.testing.assert_array_equal(scene.meshes[frame.mesh][0], stored[1][frame.step])


def test_the_command_line(run, tmp_path):
    result = invoke("view", run, "--no-browser", "--every", 5)
    assert result.exit_code == 0, result.output
    out = run / "pair.html"
    assert re.fullmatch(rf"wrote {out}: 3 frames, [\d.]+ MB\n", result.output)
    assert len(unpacked(out.read_text())[0]["frames"]) == 3
    # Its own page it overwrites.
    assert invoke("view", run / "pair.xtc", "--no-browser").exit_code == 0
    assert len(unpacked(out.read_text())[0]["frames"]) == 11
    assert invoke("view", run / "pair.vtkhdf", "--no-browser").exit_code == 0
    header, frames = unpacked(out.read_text())
    assert len(frames) == 11
    assert [frame["step"] for frame in header["frames"]][:2] == [0, 5]
    result = invoke("view", run / "pair.ply", "-o", tmp_path / "mesh.html", "--no-browser")
    assert result.exit_code == 0, result.output
    out.unlink()


def test_a_run_that_flips_nothing_has_its_mesh_beside_it(tmp_path):
    path = tmp_path / "still.toml"
    path.write_text(fluid_and_solid(2, 1, "none", flips=0))
    assert invoke("run", path, "--out", tmp_path / "still").exit_code == 0
    found = Mesh.read(tmp_path / "still/still.ply")
    assert found.num_vertices == 132 + 92
    scene = helfrich.view(tmp_path / "still").scene
    assert len(scene.frames) == 3
    assert len(scene.meshes) == 1
    np.testing.assert_array_equal(scene.meshes[0][0], found.triangles)


def test_a_run_that_was_killed(run, tmp_path):
    """Files end in the middle of a frame, and one has more of them than the other."""
    for name in ("pair.xtc", "pair.csv", "pair.triangles"):
        data = (run / name).read_bytes()
        (tmp_path / name).write_bytes(data if name == "pair.triangles" else data[:-30])
    triangles = (run / "pair.triangles").read_bytes()
    (tmp_path / "pair.ply").write_bytes((run / "pair.ply").read_bytes())
    (tmp_path / "pair.triangles").write_bytes(triangles[: -len(triangles) // 11 - 7])
    scene = helfrich.view(tmp_path).scene
    assert len(scene.frames) == 9
    xtc_only = tmp_path / "pair.triangles"
    xtc_only.write_bytes(triangles)
    assert len(helfrich.view(tmp_path).scene.frames) == 10
    assert np.isfinite(series(scene, None, "potential", "kJ/mol")).all()


@pytest.mark.parametrize("particles", [5, 42])
def test_a_frame_that_is_not_whole(tmp_path, particles):
    """Cut anywhere, an XTC file has the frames before; of few particles they look otherwise."""
    random = np.random.default_rng(3)
    frames = random.normal(scale=50, size=(3, particles, 3)).astype(np.float32)
    path, sizes = tmp_path / "cut.xtc", [0]
    for number, frame in enumerate(frames):
        xtc_write_frame(os.fsencode(path), frame, np.eye(3, dtype=np.float32) * 9, number, number)
        sizes.append(path.stat().st_size)
    data = path.read_bytes()
    cuts = random.integers(1, sizes[3], 60)
    for cut in {*cuts.tolist(), *sizes[1:], *(size - 1 for size in sizes[1:])}:
        path.write_bytes(data[:cut])
        whole = sum(size <= cut for size in sizes[1:])
        if whole == 0:
            with pytest.raises(ValueError, match="no whole frame"):
                xtc.read(path)
            continue
        positions, boxes, times, steps = xtc.read(path)
        np.testing.assert_allclose(positions, frames[:whole], atol=6e-4)
        assert (boxes == 9 * np.eye(3)).all()
        assert times.tolist() == steps.tolist() == list(range(whole))


@pytest.mark.parametrize(
    "name, said",
    [
        ("nothing", "there is no file or folder"),
        ("empty", "has no XTC, VTKHDF or GSD file"),
        ("two", r"has 2 files \*.xtc, not one"),
        ("alone.xtc", "has no triangles beside it, neither alone.ply nor alone.triangles"),
        ("wrong.xtc", "224 particles, and .*wrong.ply 42 vertices"),
        ("mixed.xtc", r"mixed.triangles does not match the 11 frames"),
        ("broken.xtc", "broken.xtc has no whole frame"),
        ("broken.vtkhdf", "is no VTKHDF file"),
        ("words.txt", "unknown extension"),
    ],
)
def test_what_cannot_be_shown(run, tmp_path, lumpy, name, said):
    xtc = (run / "pair.xtc").read_bytes()
    (tmp_path / "empty").mkdir()
    (tmp_path / "two").mkdir()
    for path in ("two/a.xtc", "two/b.xtc", "alone.xtc", "wrong.xtc", "mixed.xtc"):
        (tmp_path / path).write_bytes(xtc)
    lumpy.write(tmp_path / "wrong.ply")
    (tmp_path / "mixed.triangles").write_bytes(b"1234")
    for path in ("broken.xtc", "broken.vtkhdf", "words.txt"):
        (tmp_path / path).write_bytes(b"words")
    with pytest.raises((ValueError, FileNotFoundError), match=said):
        helfrich.view(tmp_path / name)
    result = invoke("view", tmp_path / name, "--no-browser")
    assert result.exit_code != 0
    assert isinstance(result.exception, SystemExit)
    assert len(result.output.strip().splitlines()) <= 4


def test_wrong_arguments(lumpy, run):
    with pytest.raises(TypeError, match="got ndarray alone"):
        helfrich.view(lumpy.vertices)
    with pytest.raises(TypeError, match="own triangles"):
        helfrich.view(run, lumpy)
    with pytest.raises(ValueError, match="every"):
        helfrich.view(run, every=0)
    system = openmm.System()
    system.addParticle(1)
    context = openmm.Context(system, openmm.VerletIntegrator(1))
    with pytest.raises(ValueError, match="no membrane force"):
        helfrich.view(context)


def test_other_files_stay(run, tmp_path):
    mine = tmp_path / "mine.html"
    mine.write_text("<p>mine</p>")
    for arguments in (("view", run, "-o", mine), ("run", run / "none.toml", "--live-page", mine)):
        result = invoke(*arguments)
        assert result.exit_code == 1
        assert f"{mine} is there already" in result.output
    assert mine.read_text() == "<p>mine</p>"


def test_meshes_in_a_notebook(lumpy, monkeypatch):
    shown = lumpy._repr_html_()
    inside = html.unescape(re.search('srcdoc="([^"]*)"', shown)[1])
    header, frames = unpacked(inside)
    np.testing.assert_allclose(frames[0][0], lumpy.vertices, atol=1e-3)
    assert header["title"] == "42 vertices, 80 triangles"
    monkeypatch.setattr("openmmhelfrich.mesh.MOST_SHOWN", 41)
    assert lumpy._repr_html_() is None


def simulation_of(mesh):
    return helfrich.Vesicle(mesh).simulation(openmm.LangevinMiddleIntegrator(300, 0.01, 0.1))


def test_simulations_in_a_notebook(monkeypatch):
    """IPython is told how to show those with membranes; others, and those not begun, stay."""
    known = {}
    formatter = types.SimpleNamespace(for_type=known.__setitem__)
    display = types.SimpleNamespace(formatters={"text/html": formatter})
    shell = types.ModuleType("IPython")
    shell.get_ipython = lambda: types.SimpleNamespace(display_formatter=display)
    monkeypatch.setitem(sys.modules, "IPython", shell)
    register()
    show = known[app.Simulation]
    mesh = Mesh.icosphere(3, radius=300)
    simulation = simulation_of(mesh)
    inside = html.unescape(re.search('srcdoc="([^"]*)"', show(simulation))[1])
    np.testing.assert_allclose(unpacked(inside)[1][0][0], mesh.vertices, atol=0.02)
    monkeypatch.setattr("openmmhelfrich.viewer.notebooks.MOST_SHOWN", mesh.num_vertices - 1)
    assert show(simulation) is None
    monkeypatch.undo()
    system = openmm.System()
    for _ in range(mesh.num_vertices):
        system.addParticle(1)
    topology = mesh.topology()
    assert show(app.Simulation(topology, system, openmm.VerletIntegrator(1))) is None
    system.addForce(helfrich.BendingForce(mesh, rigidity=50))
    simulation = app.Simulation(topology, system, openmm.VerletIntegrator(1))
    assert show(simulation) is None
    with pytest.raises(ValueError, match="no positions yet"):
        helfrich.view(simulation)


def test_live_pages(tmp_path, monkeypatch):
    monkeypatch.setattr("openmmhelfrich.viewer.live._SECONDS", 0.0)
    monkeypatch.setattr("openmmhelfrich.viewer.live._SHARE", 1e9)
    monkeypatch.setattr("openmmhelfrich.viewer.live._MOST_FRAMES", 4)
    simulation = simulation_of(Mesh.icosphere(3, radius=300))
    live = helfrich.LiveView(5, tmp_path / "live.html")
    simulation.reporters.append(live)
    simulation.step(20)
    header, _ = unpacked((tmp_path / "live.html").read_text())
    assert header["reload"] == 0.0
    assert [frame["step"] for frame in header["frames"]] == [5, 10, 15, 20]
    live.finish(simulation)
    header, _ = unpacked((tmp_path / "live.html").read_text())
    assert header["reload"] is None
    # One more than there may be: every second one is left out.
    assert [frame["step"] for frame in header["frames"]] == [5, 15, 20]
    state = simulation.context.getState(energy=True)
    (kinetic,) = [each for each in header["series"] if each["label"] == "kinetic"]
    assert kinetic["values"][-1] == pytest.approx(state.getKineticEnergy()._value)


def test_live_pages_leave_time_for_the_run(tmp_path, lumpy, monkeypatch):
    """A page takes a tenth of the time at most, and comes not more often than every few seconds."""
    now = [100.0]
    monkeypatch.setattr("openmmhelfrich.viewer.live.time.monotonic", lambda: now[0])
    scene = Scene("busy")
    live = LivePage(tmp_path / "busy.html", scene)
    added = []

    def add(cost):
        scene.add(lumpy.vertices, lumpy.triangles)
        added.append(now[0])
        now[0] += cost

    for cost in (0.01, 2.0, 0.01):
        for _ in range(1000):
            live.update(lambda cost=cost: add(cost))
            now[0] += 0.1
            if len(added) and added[-1] == now[0] - 0.1 - cost:
                break
    assert added[1] - added[0] == pytest.approx(3.01, abs=0.11)
    assert added[2] - added[1] == pytest.approx(22.0, abs=0.11)


def test_live_views_in_a_notebook(monkeypatch):
    displays = []

    class Handle:
        def update(self, shown):
            displays.append(("update", shown))

    def display(shown, display_id):
        displays.append(("display", shown))
        return Handle()

    shell, fake = types.ModuleType("IPython"), types.ModuleType("IPython.display")
    fake.HTML, fake.display = str, display
    shell.get_ipython = lambda: None
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setitem(sys.modules, "IPython.display", fake)
    monkeypatch.setattr("openmmhelfrich.viewer.live._SECONDS", 0.0)
    monkeypatch.setattr("openmmhelfrich.viewer.live._SHARE", 1e9)
    with pytest.raises(ValueError, match="no notebook here; give file="):
        helfrich.LiveView(5)
    shell.get_ipython = object
    simulation = simulation_of(Mesh.icosphere(3, radius=300))
    simulation.reporters.append(helfrich.LiveView(5))
    simulation.step(10)
    assert [what for what, _ in displays] == ["display", "update"]
    inside = html.unescape(re.search('srcdoc="([^"]*)"', displays[1][1])[1])
    assert len(unpacked(inside)[0]["frames"]) == 2
    monkeypatch.setitem(sys.modules, "IPython.display", None)
    with pytest.raises(ImportError, match="give file= instead"):
        helfrich.LiveView(5)


def test_a_run_that_is_watched_is_the_same(run, tmp_path):
    path = tmp_path / "pair.toml"
    path.write_text(fluid_and_solid(20, 2, "vtkhdf"))
    out, live = tmp_path / "pair", tmp_path / "live.html"
    result = invoke("run", path, "--out", out, "--live", "--live-page", live)
    assert result.exit_code == 0, result.output
    assert re.search(r"step 50/50  [\d.e+]+ steps/s  area fluid ", result.output)
    for name, data in results(out).items():
        if name.endswith((".xtc", ".csv", ".triangles")):
            assert data == (run / name).read_bytes(), name
    header, _ = unpacked(live.read_text())
    assert header["reload"] is None
    assert header["frames"][-1]["step"] == 50
    assert header["surfaces"] == ["fluid", "solid"]


def test_live_in_a_terminal(tmp_path):
    path = tmp_path / "pair.toml"
    path.write_text(fluid_and_solid(400, 50, "none"))
    main, side = pty.openpty()
    # Lines and columns.
    fcntl.ioctl(side, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
    command = [sys.executable, "-m", "openmmhelfrich", "run", path, "--out", tmp_path / "out"]
    with subprocess.Popen(
        [*command, "--live"], stdin=side, stdout=side, stderr=side, env=os.environ
    ) as process:
        os.close(side)
        seen = b""
        try:
            while part := os.read(main, 4096):
                seen += part
        except OSError:
            # The other end is closed.
            pass
        assert process.wait() == 0
    text = seen.decode()
    temperature = float(re.findall(r"temperature\s+([\d.]+) K", text)[-1])
    assert 200 < temperature < 400
    assert re.search(r"bending fluid\s+[\d.]+ kJ/mol", text)
    assert "step/s" in text


def test_all_of_the_viewer_is_in_the_package():
    """What a wheel takes along, by the patterns of pyproject.toml."""
    folder = Path(helfrich.__file__).parent
    pyproject = (Path(__file__).parents[2] / "pyproject.toml").read_text()
    patterns = re.search(r"^openmmhelfrich = \[(.*)\]", pyproject, re.M)[1]
    taken = {path for pattern in re.findall(r'"(.*?)"', patterns) for path in folder.glob(pattern)}
    assets = {path for path in (folder / "viewer").iterdir() if path.suffix not in (".py", "")}
    assert len(assets) == 8
    assert assets <= taken
