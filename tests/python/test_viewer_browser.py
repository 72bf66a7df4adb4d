"""The viewer in a real browser: pictures, slider, keys, pointers, fingers, and no complaints.

Playwright drives Chromium, Playwright's own or Debian's package ``chromium``. Where there is none
the tests are skipped; HELFRICH_REQUIRE_BROWSER=1 asks for failures instead.
"""

import contextlib
import io
import os
import shutil
from pathlib import Path

import numpy as np
import openmmhelfrich as helfrich
import pytest
from openmmhelfrich import Mesh, analysis
from openmmhelfrich.viewer import scene as scenes
from openmmhelfrich.viewer.page import page as page_of
from openmmhelfrich.viewer.scene import Scene
from openmmhelfrich.viewer.views import embedded
from PIL import Image
from run_files import fluid_and_solid, invoke

try:
    from playwright.sync_api import Error, sync_playwright
except ImportError:
    sync_playwright = None

# The processor draws, which every machine can do.
ARGUMENTS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


def unavailable(reason):
    if os.environ.get("HELFRICH_REQUIRE_BROWSER") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="module")
def browser():
    if sync_playwright is None:
        unavailable("Playwright is not installed; pip install playwright")
    with sync_playwright() as playwright:
        own = playwright.chromium.executable_path
        path = own if Path(own).exists() else shutil.which("chromium")
        if path is None:
            unavailable("there is no Chromium; apt-get install chromium")
        # Chromium's sandbox refuses root.
        with playwright.chromium.launch(
            executable_path=path, args=ARGUMENTS, chromium_sandbox=os.getuid() != 0
        ) as found:
            yield found


class Opened:
    """A page with what it has complained about, and what it has asked for."""

    def __init__(self, browser, path, **options):
        options = {"viewport": {"width": 900, "height": 600}, **options}
        self.context = browser.new_context(**options)
        self.page = self.context.new_page()
        self.complaints, self.requests = [], []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("body[data-ready]")

    def close(self):
        assert not self.complaints
        allowed = ("file:", "data:", "blob:")
        assert all(url.startswith(allowed) for url in self.requests), self.requests
        self.context.close()

    def js(self, expression):
        return self.page.evaluate(expression)

    def until(self, expression, act=lambda: None):
        """Wait for what is true in the page soon; Playwright's own way is against its policy."""
        for _ in range(100):
            act()
            # A page that is just being renewed has no answer.
            with contextlib.suppress(Error):
                if self.js(expression):
                    return
            self.page.wait_for_timeout(50)
        raise AssertionError(f"never true: {expression}")

    def picture(self):
        """The surface as it is drawn, shape (height, width, 3), without what lies on it."""
        self.js("for (const id of ['tools', 'legend', 'tip', 'keys']) get(id).style.opacity = 0")
        data = self.page.locator("#canvas").screenshot()
        self.js("for (const id of ['tools', 'legend', 'tip', 'keys']) get(id).style.opacity = ''")
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)

    def numbers(self):
        """Value and text of each row, by its key."""
        return self.js(
            "Object.fromEntries([...get('numbers').rows].filter((row) => row.series).map((row) => "
            "[row.dataset.key.trim(), [Number(row.cells[2].dataset.value), row.innerText]]))"
        )


@pytest.fixture
def open_page(browser):
    opened = []

    def work(path, **options):
        opened.append(Opened(browser, path, **options))
        return opened[-1]

    yield work
    for each in opened:
        each.close()


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run of a vesicle that flows and one that does not, 11 frames, with its page."""
    folder = tmp_path_factory.mktemp("browser")
    path = folder / "pair.toml"
    path.write_text(fluid_and_solid(20, 2, "none"))
    assert invoke("run", path, "--out", folder / "pair").exit_code == 0
    result = invoke("view", folder / "pair", "--no-browser")
    assert result.exit_code == 0, result.output
    return folder / "pair"


@pytest.fixture(scope="module")
def stored(run):
    trajectory = analysis.Trajectory(run / "pair.xtc")
    return trajectory.read(), np.array(trajectory.triangles())


def saturation(picture):
    return np.ptp(picture, axis=2)


def place_of(view, vertex):
    """Where a vertex is in the picture, pixels, by the matrices of the camera."""
    model, projection, points, size = view.js(
        "[[...viewer.camera.view()], [...viewer.camera.projection("
        "get('canvas').clientWidth / get('canvas').clientHeight)], "
        "[...viewer.surface.positions], [get('canvas').clientWidth, get('canvas').clientHeight]]"
    )
    model, projection = (np.reshape(matrix, (4, 4)).T for matrix in (model, projection))
    clip = projection @ model @ np.append(np.reshape(points, (-1, 3))[vertex], 1)
    return (0.5 + 0.5 * clip[:2] / clip[3] * [1, -1]) * size


def test_it_draws(open_page, run):
    """Both vesicles in colour on a pale ground, light and dark."""
    for scheme, darkest in (("light", 200), ("dark", 0)):
        view = open_page(run / "pair.html", color_scheme=scheme)
        picture = view.picture()
        corners = picture[[5, 5, -5, -5], [5, -5, 5, -5]]
        assert (saturation(corners[np.newaxis]) < 12).all()
        assert corners.min() >= darkest
        assert (corners.max() < 80) == (scheme == "dark")
        coloured = saturation(picture) > 40
        assert 0.04 < coloured.mean() < 0.6
        # Red and blue, and hundreds of shades.
        red, _, blue = np.moveaxis(picture[coloured], -1, 0)
        assert (red > blue + 60).any()
        assert (blue > red + 40).any()
        assert len(np.unique(picture[coloured], axis=0)) > 500


def test_numbers_follow_the_slider(open_page, run, stored):
    positions, triangles = stored
    lines = (run / "pair.csv").read_text().splitlines()
    table = dict(zip(lines[0].split(","), zip(*(x.split(",") for x in lines[1:]), strict=True),
                     strict=True))  # fmt: skip
    view = open_page(run / "pair.html")
    assert view.page.locator("#count").inner_text() == "11 / 11"
    surfaces = analysis.surface_series.components(triangles[0], positions.shape[1])
    for frame in (0, 4, 10):
        view.page.locator("#slider").fill(str(frame))
        assert view.page.locator("#when").inner_text() == f"{2 * frame} ps · step {5 * frame}"
        for surface, name in ((None, "all surfaces"), (0, "surface fluid"), (1, "surface solid")):
            view.page.locator("#surface").select_option(label=name)
            wanted = surfaces >= 0 if surface is None else surfaces == surface
            chosen = np.flatnonzero(wanted)
            corners = triangles[frame][np.isin(triangles[frame, :, 0], chosen)]
            corners = np.searchsorted(chosen, corners)
            points = positions[frame, chosen]
            shape = analysis.shape(points, corners)
            curvature = analysis.mean_curvature(points, corners)
            expected = {
                "area nm²": shape.area,
                "volume nm³": shape.volume,
                "least curvature 1/nm": curvature.min(),
                "largest curvature 1/nm": curvature.max(),
            }
            if surface is not None:
                expected["reduced volume"] = shape.reduced_volume
                modes = analysis.mode_amplitudes(points, corners, (5, 4)[surface])
                dots = view.js(
                    "[...document.querySelectorAll('#spectrum circle')].map("
                    "(dot) => Number(dot.dataset.value))"
                )
                for l, power in enumerate(dots, 2):
                    assert power == pytest.approx(np.mean(modes[l * l : (l + 1) ** 2] ** 2), 1e-8)
            expected |= {
                column.removesuffix(" (kJ/mol)") + " kJ/mol": float(values[frame])
                for column, values in table.items()
                if column.endswith("(kJ/mol)")
            }
            found = view.numbers()
            assert set(found) == set(expected)
            for key, value in expected.items():
                assert found[key][0] == pytest.approx(value, rel=1e-12), key
                assert digits(value) in found[key][1].replace("−", "-"), key


def digits(value):
    """Six digits of a number, as the page writes them."""
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.5e}".split("e")
    if -3 <= int(exponent) < 6:
        return f"{float(f'{value:.5e}'):.10f}".rstrip("0").rstrip(".")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa} × 10{raised}"


def test_connectivity_follows_the_slider(open_page, run, stored):
    view = open_page(run / "pair.html")
    assert (stored[1][0] != stored[1][10]).any()
    for frame in (10, 0, 7):
        view.page.locator("#slider").fill(str(frame))
        corners = view.js("[...viewer.shownMesh.corners]")
        np.testing.assert_array_equal(np.reshape(corners, (-1, 3)), stored[1][frame])
        points = np.reshape(view.js("[...viewer.surface.positions]"), (-1, 3))
        expected = stored[0][frame] - stored[0][frame].mean(axis=0)
        assert abs(points - expected).max() < 0.51 * np.ptp(expected, axis=0).max() / 65534 + 1e-3


def test_colours_are_those_of_the_legend(open_page, tmp_path):
    """Of an icosphere the twelve vertices of five neighbours are blue, the others grey."""
    mesh = Mesh.icosphere(3, radius=100)
    helfrich.view(mesh, path=tmp_path / "ball.html")
    view = open_page(tmp_path / "ball.html")
    pictures = {}
    for key, name, unit in (
        ("1", "mean curvature", "1/nm"),
        ("2", "area", "nm²"),
        ("3", "largest dihedral angle", "°"),
        ("4", "neighbours", ""),
    ):
        view.page.keyboard.press(key)
        legend = view.page.locator("#legend").inner_text()
        assert name in legend
        assert unit in legend
        pictures[key] = view.picture()
    for key in "123":
        assert (pictures[key] != pictures["4"]).any()
    view.page.keyboard.press("e")
    picture = view.picture()
    towards = np.array(view.js("viewer.camera.axes()[2]"))
    facing = (mesh.vertices / 100) @ towards
    for count, is_right in ((5, lambda r, g, b: b > r + 50), (6, lambda r, g, b: abs(b - r) < 6)):
        vertices = np.flatnonzero((mesh.degrees == count) & (facing > 0.5))
        assert len(vertices) > 0
        for vertex in vertices:
            x, y = np.rint(place_of(view, vertex)).astype(int)
            assert is_right(*picture[y, x]), (count, vertex, picture[y, x])


def test_another_surface_is_pale(open_page, run):
    view = open_page(run / "pair.html")
    both = (saturation(view.picture()) > 40).sum()
    shares = []
    for name in ("surface fluid", "surface solid"):
        view.page.locator("#surface").select_option(label=name)
        shares.append((saturation(view.picture()) > 40).sum() / both)
    assert all(0.1 < share < 0.9 for share in shares)
    assert sum(shares) == pytest.approx(1, abs=0.1)


def test_keys(open_page, run):
    view = open_page(run / "pair.html")
    frame, press = (lambda: view.js("viewer.frame")), view.page.keyboard.press
    assert frame() == 10
    for key, expected in (
        ("Home", 0), ("ArrowLeft", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1),
        ("End", 10), ("ArrowRight", 10),
    ):  # fmt: skip
        press(key)
        assert frame() == expected, key
        assert view.page.locator("#slider").input_value() == str(expected)
    start = view.picture()
    camera = "[viewer.camera.azimuth, viewer.camera.elevation, viewer.camera.zoom]"
    before = view.js(camera)
    for key, which, sign in (
        ("Shift+ArrowRight", 0, -1), ("Shift+ArrowLeft", 0, 1), ("Shift+ArrowDown", 1, 1),
        ("Shift+ArrowUp", 1, -1), ("+", 2, 1), ("-", 2, -1),
    ):  # fmt: skip
        earlier = view.js(camera)
        press(key)
        assert sign * (view.js(camera)[which] - earlier[which]) > 0, key
        assert frame() == 10
    press("Shift+ArrowRight")
    press("+")
    assert (view.picture() != start).mean() > 0.02
    press("0")
    assert view.js(camera) == before
    assert (view.picture() == start).all()
    for key in "ef":
        press(key)
        assert (view.picture() != start).mean() > 0.005, key
        press(key)
        assert (view.picture() == start).all()
    for expected in (0, 1, -1):
        press("v")
        assert view.js("viewer.chosen") == expected
    for shown in (True, False):
        press("?")
        assert view.page.locator("#keys").is_visible() is shown
    press(" ")
    view.until("viewer.frame > 3 && viewer.frame < 10")
    press(" ")
    stopped = frame()
    view.page.wait_for_timeout(200)
    assert frame() == stopped


def test_the_slider_has_its_keys_once(open_page, run):
    view = open_page(run / "pair.html")
    view.page.locator("#slider").focus()
    view.page.keyboard.press("Home")
    view.page.keyboard.press("ArrowRight")
    assert view.js("viewer.frame") == 1


def test_pointers(open_page, run, stored):
    view = open_page(run / "pair.html")
    mouse = view.page.mouse
    start = view.picture()
    mouse.move(250, 200)
    mouse.down()
    mouse.move(350, 260)
    mouse.up()
    assert (view.picture() != start).mean() > 0.02
    # The z axis stays upright: it has no part along the picture's right.
    assert view.js("viewer.camera.axes()[0][2]") == 0
    for _ in range(40):
        mouse.down()
        mouse.move(350, 560)
        mouse.up()
        mouse.move(350, 20)
    assert view.js("viewer.camera.axes()[1][2]") > 0
    before = view.js("viewer.camera.zoom")
    mouse.move(350, 100)
    mouse.wheel(0, -300)
    view.until(f"viewer.camera.zoom > {before}")
    mouse.down(button="right")
    mouse.move(300, 140)
    mouse.up(button="right")
    shift = view.js("viewer.camera.shift")
    assert shift[0] < 0
    assert shift[1] < 0
    mouse.dblclick(350, 300)
    assert view.js("[viewer.camera.zoom, ...viewer.camera.shift]") == [1, 0, 0]
    assert (view.picture() == start).all()
    # The vertex under the pointer tells its values.
    towards = np.array(view.js("viewer.camera.axes()[2]"))
    vertex = int((stored[0][10] @ towards).argmax())
    mouse.move(*place_of(view, vertex))
    tip = view.page.locator("#tip").inner_text()
    assert tip.startswith(f"vertex {vertex}\n")
    curvature = analysis.mean_curvature(stored[0][10], stored[1][10])[vertex]
    shown = tip.split("C₂: ")[1].split(" 1/nm")[0]
    width = view.js("viewer.scene.fields[0].width")
    assert number(shown) == pytest.approx(curvature, abs=width / 65534 + 1e-3 * abs(curvature))


def number(text):
    """What the page has written as a number."""
    text = text.replace("−", "-").replace(" × 10", "e")
    return float(text.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))


def test_fingers(open_page, run):
    """One finger turns, two come closer; on an upright telephone nothing is wider than it."""
    view = open_page(
        run / "pair.html", viewport={"width": 390, "height": 800}, has_touch=True, is_mobile=True
    )
    assert view.js("document.documentElement.scrollWidth") <= 390
    touch = view.context.new_cdp_session(view.page)

    def fingers(kind, *places):
        points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(places)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    azimuth, zoom = view.js("[viewer.camera.azimuth, viewer.camera.zoom]")
    fingers("touchStart", (150, 250))
    fingers("touchMove", (220, 250))
    fingers("touchEnd")
    assert view.js("viewer.camera.azimuth") < azimuth
    assert view.js("viewer.camera.zoom") == zoom
    azimuth = view.js("viewer.camera.azimuth")
    fingers("touchStart", (170, 250))
    fingers("touchStart", (170, 250), (220, 250))
    fingers("touchMove", (120, 250), (270, 250))
    fingers("touchEnd")
    assert view.js("viewer.camera.zoom") == pytest.approx(3 * zoom, rel=0.02)
    assert view.js("viewer.camera.azimuth") == azimuth
    view.page.locator("#play").tap()
    view.until("viewer.playing && viewer.frame > 0 && viewer.frame < 10")


def test_numbers_over_time(open_page, run):
    """A row that is clicked is drawn large, and a click there goes to the frame."""
    view = open_page(run / "pair.html")
    view.page.get_by_role("button", name="kinetic").click()
    assert view.page.locator("#chart .name").text_content() == "kinetic (kJ/mol)"
    box = view.page.locator("#chart").bounding_box()
    view.page.mouse.click(box["x"] + 0.3 * box["width"], box["y"] + box["height"] / 2)
    # Eight of 300 parts are left free on both sides.
    assert view.js("viewer.frame") == round((0.3 * 300 - 8) / 284 * 10)


def test_live_pages_renew_themselves(open_page, tmp_path, lumpy):
    """The page comes back with the next frames, and seen as before."""
    scene, path = Scene("live"), tmp_path / "live.html"
    scene.add(lumpy.vertices, lumpy.triangles, step=1, time=1.0)
    path.write_text(page_of(scene, reload=1.0, key="live"))
    view = open_page(path)
    view.page.keyboard.press("3")
    view.page.keyboard.press("Shift+ArrowRight")
    azimuth = view.js("viewer.camera.azimuth")
    scene.add(1.1 * lumpy.vertices, lumpy.triangles, step=2, time=2.0)
    path.write_text(page_of(scene, reload=1.0, key="live"))
    view.until("window.viewer?.scene.frames.length === 2")
    assert view.js("[viewer.frame, viewer.field, viewer.camera.azimuth]") == [1, 2, azimuth]
    # Who looks at an earlier frame stays there.
    view.until("viewer.frame === 0", lambda: view.page.keyboard.press("Home"))
    scene.add(1.2 * lumpy.vertices, lumpy.triangles, step=3, time=3.0)
    path.write_text(page_of(scene, key="live"))
    view.until("window.viewer?.scene.frames.length === 3")
    assert view.js("viewer.frame") == 0
    view.js("window.same = true")
    view.page.wait_for_timeout(1500)
    assert view.js("window.same") is True


def test_notebooks(open_page, tmp_path, lumpy):
    """What `Mesh` shows of itself is a part of another page."""
    path = tmp_path / "notebook.html"
    shown = lumpy._repr_html_()
    assert "</iframe>" in shown
    path.write_text(
        f"<!DOCTYPE html><link rel='icon' href='data:,'><body data-ready=1>{shown}</body>"
    )
    view = open_page(path)
    frame = view.page.frame_locator("iframe")
    frame.locator("body[data-ready]").wait_for()
    data = frame.locator("#canvas").screenshot()
    picture = np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)
    assert (saturation(picture) > 40).mean() > 0.1
    assert frame.locator("#title").inner_text() == "42 vertices, 80 triangles"
    # Nothing is cut off in the width of a cell.
    side = frame.locator("#side")
    assert side.evaluate("(side) => side.scrollWidth <= side.clientWidth")


def test_views_in_a_cell_are_seen_as_before(open_page, tmp_path, lumpy):
    """`LiveView` puts another page into the place of the first one."""
    path = tmp_path / "notebook.html"
    path.write_text("<!DOCTYPE html><link rel='icon' href='data:,'><body data-ready=1>wait</body>")
    view = open_page(path)
    scene = Scene("cell")
    for step in (1, 2):
        scene.add(lumpy.vertices, lumpy.triangles, step=step, time=step)
        cell = embedded(page_of(scene, key="cell"))
        view.page.evaluate("(cell) => (document.body.innerHTML = cell)", cell)
        view.until("frames[0]?.document.body?.dataset.ready")
        inside = view.page.frames[-1]
        assert inside.evaluate("[viewer.frame, viewer.field]") == [step - 1, 0 if step == 1 else 2]
        assert (inside.evaluate("viewer.camera.zoom") > 1) is (step == 2)
        inside.locator("#canvas").focus()
        view.page.keyboard.press("+")
        view.page.keyboard.press("3")
        view.page.wait_for_timeout(300)


def test_without_webgl_the_numbers_are_there(browser, tmp_path, lumpy):
    helfrich.view(lumpy, path=tmp_path / "ball.html")
    context = browser.new_context()
    context.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page = context.new_page()
    page.goto((tmp_path / "ball.html").as_uri())
    page.wait_for_selector("body[data-ready]")
    assert "no WebGL 2" in page.locator("#problem").inner_text()
    assert page.locator("#numbers tr").count() == 5
    context.close()


def test_a_lost_picture_comes_back(open_page, run):
    view = open_page(run / "pair.html")
    before = view.picture()
    view.js("window.lost = viewer.surface.gl.getExtension('WEBGL_lose_context')")
    view.js("lost.loseContext()")
    view.until("viewer.surface.gl.isContextLost()")
    view.js("lost.restoreContext()")
    view.until("!viewer.surface.gl.isContextLost()")
    view.page.wait_for_timeout(300)
    assert (view.picture() == before).all()


@pytest.mark.long
def test_ten_thousand_vertices(open_page, tmp_path, monkeypatch, record_property):
    """A frame is prepared within 1/60 s; what a picture then takes is the graphics card's."""
    monkeypatch.setattr(scenes, "_spectrum", lambda *arguments: None)
    mesh = Mesh.icosphere(32, radius=1000)
    assert mesh.num_vertices > 10_000
    random = np.random.default_rng(1)
    scene = Scene("large")
    for number in range(3):
        rough = mesh.vertices + random.normal(scale=5, size=mesh.vertices.shape)
        scene.add(rough, mesh.triangles, step=number, time=number)
    path = tmp_path / "large.html"
    path.write_text(page_of(scene))
    view = open_page(path)
    # The best of some, since others use the processor too.
    times = [view.js("viewer.timing(10)") for _ in range(5)]
    prepare, draw = (min(time[what] for time in times) for what in ("show", "draw"))
    record_property("milliseconds for a frame, and for a picture in software", (prepare, draw))
    print(f"frame {prepare:.1f} ms, picture drawn by the processor {draw:.1f} ms")
    assert prepare < 1000 / 60
