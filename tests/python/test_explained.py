"""Errors name the page that explains them, and the page has that place."""

import re
import sys
import traceback
from pathlib import Path

import openmm
import pytest
from click.testing import CliRunner
from openmmhelfrich import BlowUpError, BlowUpReporter, Mesh, MeshError, Vesicle
from openmmhelfrich.cli import main

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "openmmhelfrich"


def anchors(page):
    """What GitHub calls the headings of a page."""
    text = re.sub(r"^```[\s\S]*?^```", "", page.read_text(encoding="utf-8"), flags=re.M)
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", heading).lower().replace(" ", "-") for heading in headings}


def linked():
    """All places of pages that sources name, with the file."""
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_text(encoding="utf-8").replace("{FAQ}", "docs/troubleshooting.md")
        for page, anchor in re.findall(r"(docs/\w+\.md)(?:#([\w-]+))?", text):
            yield path.relative_to(PACKAGE).as_posix(), page, anchor


def test_every_page_that_the_package_names_has_that_place():
    found = list(linked())
    assert len(found) > 8
    missing = [
        (source, page, anchor)
        for source, page, anchor in found
        if not (ROOT / page).is_file() or (anchor and anchor not in anchors(ROOT / page))
    ]
    assert not missing


@pytest.mark.parametrize("error", [MeshError, BlowUpError])
def test_each_class_has_a_place_of_its_own(error):
    page, _, anchor = error.page.partition("#")
    assert anchor in anchors(ROOT / page)


def assert_names(error, page):
    """The exception has the page, and its traceback ends with it, or with the message in 3.10."""
    assert error.page == page
    last = "".join(traceback.format_exception(error)).rstrip().splitlines()[-1]
    noted = sys.version_info >= (3, 11)
    assert last.endswith(f"See {page}" if noted else str(error).splitlines()[-1])


def test_tracebacks_name_it_and_messages_stay_as_they_are():
    with pytest.raises(MeshError) as caught:
        Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])
    assert str(caught.value).endswith("triangle 0 refers to index 3, but indices run from 0 to 2")
    assert_names(caught.value, "docs/troubleshooting.md#meshes")


def test_a_simulation_that_breaks_down_names_it(tmp_path):
    simulation = Vesicle(Mesh.icosphere(3, 100)).simulation(openmm.VerletIntegrator(20))
    watch = BlowUpReporter(tmp_path / "blow-up", 10)
    simulation.reporters.append(watch)
    simulation.context.setVelocitiesToTemperature(300, 1)
    with pytest.raises(BlowUpError) as caught, watch:
        simulation.step(10_000)
    assert_names(caught.value, "docs/troubleshooting.md#messages-and-what-is-behind-them")


def test_commands_name_it(tmp_path):
    path = tmp_path / "cut.ply"
    Mesh.icosphere(2, 10).write(path)
    path.write_text(path.read_text(encoding="ascii")[:-200], encoding="ascii")
    result = CliRunner().invoke(main, ["mesh", "info", str(path)])
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == "See docs/troubleshooting.md#meshes"
    # A mesh that a configuration names.
    config = tmp_path / "cell.toml"
    config.write_text(
        'simulation.duration = 1\n[[vesicle]]\nmesh = { file = "cut.ply" }\n', encoding="utf-8"
    )
    result = CliRunner().invoke(main, ["run", str(config), "--out", str(tmp_path / "out")])
    assert result.exit_code == 1
    assert "cell.toml:3: key vesicle[0].mesh" in result.stderr
    assert result.stderr.splitlines()[-1] == "See docs/troubleshooting.md#meshes"
    # Other errors are explained nowhere.
    result = CliRunner().invoke(main, ["mesh", "info", "--backwards"])
    assert "troubleshooting" not in result.stderr
