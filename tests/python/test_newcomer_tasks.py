"""docs/tasks.md: each task is short, runs as it stands there, and gives what it should."""

from __future__ import annotations

import itertools
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmm import unit
from openmmhelfrich import analysis
from openmmhelfrich.cli import main
from run_files import results
from test_documentation import ROOT, Block, blocks_of, commands, execute

PAGE = ROOT / "docs" / "tasks.md"
MOST_LINES, MOST_COMMANDS = 10, 2


def _by_task() -> dict[str, list[Block]]:
    """The blocks of the page by the heading above them."""
    lines = PAGE.read_text(encoding="utf-8").split("\n")
    headings = [(n, line[3:]) for n, line in enumerate(lines) if line.startswith("## ")]
    found: dict[str, list[Block]] = {heading: [] for _, heading in headings}
    for block in blocks_of(PAGE):
        found[[heading for n, heading in headings if n < block.line][-1]].append(block)
    return found


TASKS = _by_task()


def code_lines(block: Block) -> int:
    """Lines that are neither empty nor comments."""
    lines = (line.strip() for line in block.body.split("\n"))
    return sum(bool(line) and not line.startswith("#") for line in lines)


def run_commands(task: str, *more: str) -> str:
    """Run the commands of a task in the present folder; returns what they print."""
    output = ""
    for block in (b for b in TASKS[task] if b.language == "sh"):
        for program, *words in commands(block):
            assert program == "openmm-helfrich"
            done = CliRunner().invoke(main, [*words, *more])
            assert done.exit_code == 0, done.output
            output += done.output
    return output


def run_python(task: str) -> dict:
    """Run the Python of a task in the present folder; returns its names."""
    space: dict = {"__name__": "__main__"}
    for block in (b for b in TASKS[task] if b.language == "python"):
        execute(block, space)
    return space


def write_toml(task: str, name: str, **instead: str) -> None:
    """Write the configuration of a task, with other values of some keys."""
    [block] = [b for b in TASKS[task] if b.language == "toml"]
    lines = block.body.split("\n")
    for key, value in instead.items():
        [place] = [n for n, line in enumerate(lines) if line.split(" ")[0].endswith(key)]
        lines[place] = f"{lines[place].partition('=')[0]}= {value}"
    Path(name).write_text("\n".join(lines), encoding="utf-8")


@pytest.fixture(scope="module")
def cell_run(tmp_path_factory):
    """A folder with cell.ply, cell.toml and the run of it, in cell."""
    folder = tmp_path_factory.mktemp("newcomer")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        helfrich.Mesh.random_sphere(252, radius=100, seed=1).write("cell.ply")
        write_toml("Simulate my PLY file", "cell.toml")
        run_commands("Simulate my PLY file", "--seed", "5")
    return folder


@pytest.fixture
def folder(cell_run, tmp_path, monkeypatch):
    """A folder of the test's own with cell.ply, which is the present one."""
    shutil.copy(cell_run / "cell.ply", tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def with_run(cell_run, folder):
    """The same with the run."""
    shutil.copy(cell_run / "cell.toml", folder)
    shutil.copytree(cell_run / "cell", folder / "cell")
    return folder


def test_there_are_twelve():
    assert len(TASKS) == 12
    assert all(TASKS.values())


@pytest.mark.parametrize("task", TASKS)
def test_each_is_short(task):
    for block in TASKS[task]:
        if block.language == "sh":
            assert len(commands(block)) <= MOST_COMMANDS
        else:
            assert 0 < code_lines(block) <= MOST_LINES
    assert {block.language for block in TASKS[task]} <= {"python", "toml", "sh"}


def test_simulate_my_ply_file(with_run):
    table = analysis.read_table("cell/cell.csv")
    mesh = helfrich.Mesh.read("cell.ply")
    assert len(table["time"]) == 101
    assert table["time"][-1] == 10_000
    assert table["area 0"][0] == pytest.approx(mesh.area, rel=1e-10)
    # Undulations and the vertices' own motion stretch it a little.
    assert 1 < table["area 0"][10:].mean() / mesh.area < 1.03
    # Equipartition, of 3 N momenta.
    freedom = 3 * mesh.num_vertices
    kinetic = freedom / 2 * analysis.theory.BOLTZMANN * 300
    error = kinetic * np.sqrt(2 / freedom) / np.sqrt(90)
    assert table["kinetic"][10:].mean() == pytest.approx(kinetic, abs=4 * error)


def test_continue_an_interrupted_run(folder):
    write_toml("Simulate my PLY file", "cell.toml", duration="200", interval="10")
    run_commands("Simulate my PLY file", "--seed", "5")
    Path("cell").rename("whole")
    run_commands("Simulate my PLY file", "--seed", "5", "--steps", "731")
    assert len(analysis.read_table("cell/cell.csv")["step"]) == 15
    run_commands("Continue an interrupted run")
    assert len(analysis.read_table("cell/cell.csv")["step"]) == 21
    assert results(folder / "cell") == results(folder / "whole")


def test_plot_the_spectrum(with_run):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    output = run_commands("Plot the spectrum", "--lmax", "4", "--csv", "spectrum.csv")
    assert "91 frames" in output
    assert pyplot.imread("spectrum.png").shape[2] == 4
    table = analysis.read_table("spectrum.csv")
    l, n, kappa = table["l"][:3], 252, 20
    # A17 with what waves near the spacing of the vertices add, see docs/flips.md.
    waves = 1 - 3 / (4 * np.pi * kappa) * np.log(np.sqrt(n) / l)
    expected = (1 + 2.46 * l * (l + 1) / n) / waves
    error = table["error"][:3] / table["theory"][:3]
    assert np.all(error < 0.2)
    assert np.all(np.abs(table["ratio"][:3] - expected) < 4 * error)


def test_open_it_in_paraview(with_run):
    pytest.importorskip("h5py")
    readers = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    run_commands("Open it in ParaView")
    reader = readers.vtkHDFReader()
    reader.SetFileName("cell/cell.vtkhdf")
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 101
    reader.SetStep(100)
    reader.Update()
    surface = reader.GetOutput()
    assert surface.GetNumberOfPoints() == 252
    area = vtk_to_numpy(surface.GetCellData().GetArray("area")).sum()
    table = analysis.read_table("cell/cell.csv")
    # An XTC file has three digits behind the point.
    assert area == pytest.approx(table["area 0"][-1], rel=1e-5)
    curvature = vtk_to_numpy(surface.GetPointData().GetArray("mean_curvature"))
    assert curvature.mean() == pytest.approx(2 / 100, rel=0.05)


def test_colour_by_curvature(with_run):
    pyvista = pytest.importorskip("pyvista")
    output = run_commands("Colour by curvature", "--no-browser", "--every", "10")
    assert "11 frames" in output
    assert "mean curvature" in Path("cell/cell.html").read_text(encoding="utf-8").lower()
    run_python("Colour by curvature")
    coloured, mesh = pyvista.read("coloured.vtk"), helfrich.Mesh.read("cell.ply")
    found = np.asarray(coloured.point_data["mean_curvature"])
    assert np.allclose(coloured.points, mesh.vertices, rtol=1e-6)
    assert np.allclose(found, analysis.mean_curvature(mesh, mesh), rtol=1e-12)
    assert found.mean() == pytest.approx(2 / 100, rel=0.02)


def test_change_kappa_midway(folder):
    space = run_python("Change κ midway")
    vesicle, context = space["vesicle"], space["simulation"].context
    now = vesicle.placement.mesh(context)
    found = vesicle.energies(context)["bending"]
    assert found == pytest.approx(now.energy(helfrich.BendingForce(now, 100)), rel=1e-9)


def test_reduced_volumes_on_two_cores(folder):
    pytest.importorskip("distributed")
    [block] = TASKS["Run 20 reduced volumes on 2 cores"]
    assert "workers=2" in block.body
    Path("volumes.py").write_text(block.body, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "volumes.py"], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    rows = eval(done.stdout, {"__builtins__": {}})
    assert len(rows) == 20
    bending = [row["bending"] for row in rows]
    # Up to 0.95 they keep area and volume: two terms of kT/2 on average.
    kept = [row["area"] + row["volume"] for row in rows[:16]]
    assert max(kept) < 8 * analysis.theory.BOLTZMANN * 300
    # From an oblate to nearly a sphere, whose energy is 8 π κ, and kT/2 for each vertex.
    kappa = 20 * analysis.theory.BOLTZMANN * 300
    assert bending[-1] == pytest.approx((8 * np.pi + 252 / 40) * kappa, rel=0.1)
    assert bending[0] > 1.15 * bending[-1]
    assert np.corrcoef(np.linspace(0.8, 0.99, 20), bending)[0, 1] < -0.9


def windings(vertices: np.ndarray, triangles: np.ndarray, point: np.ndarray) -> float:
    """How often a surface goes round a point: 1 inside, 0 outside, by A. van Oosterom and
    J. Strackee, doi:10.1109/TBME.1983.298207."""
    a, b, c = np.moveaxis((vertices - point)[triangles], 1, 0)
    x, y, z = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = x * y * z + sum(
        np.einsum("ij,ij->i", p, q) * r for p, q, r in ((a, b, z), (b, c, x), (c, a, y))
    )
    return float(np.arctan2(volume, below).sum() / (2 * np.pi))


@pytest.mark.parametrize("repelled", [True, False])
def test_add_a_particle_that_the_membrane_repels(folder, repelled):
    space = run_python("Add a particle that the membrane repels")
    context, mesh, bead = space["context"], space["mesh"], space["bead"]
    if not repelled:
        # Without the repulsion the same push sends it out.
        system = context.getSystem()
        system.removeForce(system.getNumForces() - 1)
        context.reinitialize(preserveState=True)
    # On to the wall, undamped: 450 kJ/mol.
    context.getIntegrator().setFriction(0)
    velocities = context.getState(velocities=True).getVelocities(asNumpy=True)
    velocities[bead] = (0, 0, 0.42) * unit.nanometer / unit.picosecond
    context.setVelocities(velocities)
    inside = []
    for _ in range(10):
        context.getIntegrator().step(400)
        where = context.getState(positions=True).getPositions(asNumpy=True)
        where = where.value_in_unit(unit.nanometer)
        inside.append(windings(where[:bead], mesh.triangles, where[bead]))
        if repelled:
            assert np.linalg.norm(where[:bead] - where[bead], axis=1).min() > 20
    assert inside[0] == pytest.approx(1, abs=1e-6)
    assert inside[-1] == pytest.approx(1 if repelled else 0, abs=1e-6)


def test_make_it_fluid(folder):
    meshio = pytest.importorskip("meshio")
    space = run_python("Make it fluid")
    before, after = (helfrich.Mesh.read(f"{name}.ply") for name in ("cell", "fluid"))
    gone = set(map(tuple, before.edges.tolist())) - set(map(tuple, after.edges.tolist()))
    statistics = space["vesicle"].placement.flips.getStatistics(space["simulation"].context)
    assert 20 < len(gone) <= statistics["accepted"]
    assert after.euler_characteristic == 2
    assert 1 < after.area / before.area < 1.03
    read = meshio.read("fluid.ply")
    assert np.array_equal(read.cells_dict["triangle"], after.triangles)


def test_pull_a_red_cell(folder):
    space = run_python("Pull a red cell")
    start, pulled = space["cell"].mesh, helfrich.Mesh.read("pulled.ply")
    length, width, _ = np.ptp(pulled.vertices, axis=0) / 1000
    # Between the error bars of Mills et al. 2004 at 88 and 109 pN, doi:10.3970/mcb.2004.001.169.
    assert 11.4 < length < 15.5
    assert 3.4 < width < 5.9
    assert pulled.area == pytest.approx(start.area, rel=0.01)


def test_put_a_tension_on_a_periodic_sheet(folder):
    space = run_python("Put a tension on a periodic sheet")
    context, sheet = space["context"], space["sheet"]
    triangles, strains = sheet.triangles, []
    for _ in range(20):
        context.getIntegrator().step(200)
        state = context.getState(positions=True)
        vertices = state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
        box = state.getPeriodicBoxVectors(asNumpy=True).value_in_unit(unit.nanometer)
        strains.append(helfrich.Mesh(vertices, triangles, box).area / sheet.area - 1)
    # σ = kA (A − A0)/A0 of the SurfaceAreaForce; kT/A for each vertex is 1 % of it.
    assert np.mean(strains) == pytest.approx(0.026 / 1.3, rel=0.1)


def test_several_vesicles_in_one_table(folder):
    task = "Several vesicles in one table"
    write_toml(task, "pair.toml", duration="20", interval="2")
    run_commands(task, "--seed", "3")
    table = run_python(task)["table"]
    last = list(analysis.Trajectory("pair/pair.xtc"))[-1]
    edges = list(itertools.accumulate([0, 252, 252]))
    meshes = helfrich.Mesh.read("cell.ply"), helfrich.Mesh.random_sphere(252, 50, seed=1)
    for name, first, end, mesh in zip(("left", "right"), edges, edges[1:], meshes, strict=False):
        area = analysis.triangle_areas(last[first:end], mesh.triangles).sum()
        if name == "left":
            assert table[f"area {name} (nm^2)"][-1] == pytest.approx(area, rel=1e-6)
        # The energy of the term is a column of its own.
        target = table[f"area {name} (nm^2)"][0]
        energy = 0.5 * 1.3 * (table[f"area {name} (nm^2)"] - target) ** 2 / target
        assert np.allclose(table[f"area {name} (kJ/mol)"], energy, rtol=1e-3, atol=1e-6)
    assert table["area right (nm^2)"][0] == pytest.approx(4 * np.pi * 50**2, rel=0.03)
