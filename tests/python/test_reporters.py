"""ModeReporter, MembraneReporter and the command `spectrum`: their files read back."""

import csv
import warnings

import numpy as np
import openmm
import pytest
from click.testing import CliRunner
from kills import Killed, killed_at
from openmm import app, unit
from openmmhelfrich import MembraneReporter, Mesh, ModeReporter, Vesicle, analysis
from openmmhelfrich.analysis import theory
from openmmhelfrich.analysis.tables import open_table
from openmmhelfrich.cli import main
from openmmhelfrich.forces import BendingForce, SurfaceAreaForce

SUFFIXES = [
    "csv",
    pytest.param(
        "h5", marks=pytest.mark.skipif("not __import__('importlib').util.find_spec('h5py')")
    ),
]


@pytest.fixture
def mesh():
    return Mesh.icosphere(3, 200)


def simulate(mesh, seed=1):
    integrator = openmm.LangevinMiddleIntegrator(300, 0.01, 0.05)
    integrator.setRandomNumberSeed(seed)
    simulation = Vesicle(mesh).simulation(integrator, "Reference")
    simulation.context.setVelocitiesToTemperature(300, seed)
    return simulation


def positions_of(simulation):
    state = simulation.context.getState(getPositions=True)
    return state.getPositions(asNumpy=True).value_in_unit(unit.nanometer)


@pytest.mark.parametrize("suffix", SUFFIXES)
class TestFiles:
    def test_modes(self, mesh, tmp_path, suffix):
        simulation, path = simulate(mesh), tmp_path / f"modes.{suffix}"
        simulation.reporters.append(ModeReporter(path, 4, mesh, 3))
        simulation.reporters.append(
            ModeReporter(tmp_path / f"sum.{suffix}", 8, mesh.triangles, 3, "vertices", "mass")
        )
        fits, sums = [], []
        for frame in range(6):
            simulation.step(4)
            fits.append(analysis.mode_amplitudes(positions_of(simulation), mesh, 3))
            if frame % 2:
                sums.append(analysis.mode_amplitudes(positions_of(simulation), mesh, 3, "vertices"))
            # A row is on disk as soon as it is reported.
            assert len(analysis.read_modes(path).step) == frame + 1
        modes = analysis.read_modes(path)
        assert modes.step.tolist() == [4, 8, 12, 16, 20, 24]
        np.testing.assert_allclose(modes.time, 0.05 * modes.step)
        assert modes.interval == pytest.approx(0.2)
        np.testing.assert_array_equal(modes.amplitudes, fits)
        found = analysis.read_modes(tmp_path / f"sum.{suffix}")
        np.testing.assert_array_equal(found.amplitudes, sums)

    def test_energies_and_shape(self, mesh, tmp_path, suffix):
        simulation, path = simulate(mesh), tmp_path / f"membrane.{suffix}"
        simulation.reporters.append(MembraneReporter(str(path), 5, mesh))
        simulation.step(15)
        table = analysis.read_table(path)
        assert table["step"].tolist() == [5, 10, 15]
        now = Mesh(positions_of(simulation), mesh.triangles)
        total = 0
        for force in simulation.system.getForces():
            energy = table[f"{force.getName()}_energy"][-1]
            assert energy == pytest.approx(now.energy(force), rel=1e-9, abs=1e-9)
            total += energy
        assert set(table) >= {"area_energy", "volume_energy", "bending_energy", "heights_energy"}
        assert table["potential_energy"][-1] == pytest.approx(total)
        state = simulation.context.getState(getEnergy=True)
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        assert table["kinetic_energy"][-1] == kinetic
        assert table["temperature"][-1] == pytest.approx(
            2 * kinetic / (3 * mesh.num_vertices * theory.BOLTZMANN)
        )
        for name, value in analysis.shape(now, mesh)._asdict().items():
            assert table[name][-1] == pytest.approx(value, rel=1e-12)

    def test_what_has_no_energy_has_no_column(self, mesh, tmp_path, suffix):
        vesicle = Vesicle(mesh, viscosity=20, flips=0.01)
        system = vesicle.system()
        system.addForce(openmm.AndersenThermostat(300, 1))
        system.addForce(openmm.CMMotionRemover())
        integrator = openmm.VerletIntegrator(0.01)
        simulation = openmm.app.Simulation(mesh.topology(), system, integrator)
        simulation.context.setPositions(mesh.vertices)
        path = tmp_path / f"membrane.{suffix}"
        simulation.reporters.append(MembraneReporter(path, 1, mesh))
        simulation.step(2)
        found = {name for name in analysis.read_table(path) if name.endswith("_energy")}
        named = {f"{name}_energy" for name in vesicle.placement.forces}
        assert found == named | {"potential_energy", "kinetic_energy"}

    def test_forces_of_any_name(self, mesh, tmp_path, suffix):
        """Parentheses, commas and quotes in names, and one name twice."""
        names = ["bending (inner)", "bending (outer)", 'a "b", c', "x", "x"]
        system = openmm.System()
        for _ in mesh.vertices:
            system.addParticle(50)
        for group, name in enumerate(names):
            force = openmm.CustomExternalForce(f"{group + 1}")
            force.addParticle(0)
            force.setName(name)
            force.setForceGroup(group)
            system.addForce(force)
        integrator = openmm.VerletIntegrator(0.01)
        platform = openmm.Platform.getPlatformByName("Reference")
        simulation = openmm.app.Simulation(mesh.topology(), system, integrator, platform)
        simulation.context.setPositions(mesh.vertices)
        path = tmp_path / f"names.{suffix}"
        simulation.reporters.append(MembraneReporter(path, 1, mesh))
        simulation.step(2)
        table = analysis.read_table(path)
        columns = ["bending (inner)", "bending (outer)", "a ;b;; c", "x", "x_4"]
        for number, name in enumerate(columns, 1):
            assert table[f"{name}_energy"].tolist() == [number, number]

    def test_a_resumed_run_has_each_row_once(self, mesh, tmp_path, suffix):
        """The run goes on from a checkpoint that is older than the last rows of the files."""
        paths = [tmp_path / f"{name}.{suffix}" for name in ("modes", "membrane")]

        def reporters(append):
            return [
                ModeReporter(paths[0], 3, mesh, 2, append=append),
                MembraneReporter(paths[1], 3, mesh, append=append),
            ]

        whole = simulate(mesh)
        whole.reporters += reporters(False)
        whole.step(9)
        checkpoint = str(tmp_path / "run.chk")
        whole.saveCheckpoint(checkpoint)
        whole.step(12)
        expected = [analysis.read_table(path) for path in paths]
        if suffix == "csv":
            # The kill came in the middle of a line.
            for path in paths:
                path.write_bytes(path.read_bytes()[:-7])
        resumed = simulate(mesh)
        resumed.loadCheckpoint(checkpoint)
        assert resumed.currentStep == 9
        resumed.reporters += reporters(True)
        resumed.step(12)
        for path, table in zip(paths, expected, strict=True):
            found = analysis.read_table(path)
            assert found["step"].tolist() == [3, 6, 9, 12, 15, 18, 21]
            for name, column in table.items():
                np.testing.assert_array_equal(found[name], column)

    def test_rows_that_are_missing_are_said(self, mesh, tmp_path, suffix):
        path = tmp_path / f"modes.{suffix}"
        simulation = simulate(mesh)
        simulation.reporters.append(ModeReporter(path, 2, mesh, 1))
        simulation.step(4)
        simulation.reporters.clear()
        # As after a file that has lost its end.
        simulation.step(5)
        simulation.reporters.append(ModeReporter(path, 2, mesh, 1, append=True))
        with pytest.warns(UserWarning, match=rf"{path} ends with step 4, .* from step 9: reports"):
            simulation.step(1)
        simulation.reporters[:] = [ModeReporter(path, 2, mesh, 1, append=True)]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            simulation.step(1)
        assert analysis.read_table(path)["step"].tolist() == [2, 4, 10]
        if suffix == "csv":
            path.write_text(path.read_text().splitlines()[0])
            simulation.reporters[:] = [ModeReporter(path, 2, mesh, 1, append=True)]
            with pytest.warns(UserWarning, match=rf"{path} has no reports, .* from step 11"):
                simulation.step(1)

    def test_a_file_that_was_taken_away_is_missed(self, mesh, tmp_path, suffix):
        path = tmp_path / f"modes.{suffix}"
        simulation = simulate(mesh)
        simulation.reporters.append(ModeReporter(path, 1, mesh, 1))
        simulation.step(2)
        path.rename(tmp_path / "elsewhere")
        with pytest.raises(FileNotFoundError, match="see whether its folder is there") as error:
            simulation.step(1)
        assert error.value.filename == str(path)
        assert not path.exists()

    def test_appending_to_nothing_and_overwriting(self, mesh, tmp_path, suffix):
        path = tmp_path / f"modes.{suffix}"
        for append, steps in ((True, [2, 4]), (True, [2]), (False, [2])):
            simulation = simulate(mesh)
            simulation.reporters.append(ModeReporter(path, 2, mesh, 1, append=append))
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                simulation.step(steps[-1])
            said = [str(each.message) for each in caught]
            lost = f"{path} begins anew: 2 reports of later steps are gone; to go on"
            assert [lost in each for each in said] == ([True] if append and len(steps) == 1 else [])
            # The second run starts at step 0 again, so that nothing of the first is left.
            assert analysis.read_modes(path).step.tolist() == steps

    def test_other_columns_are_refused(self, mesh, tmp_path, suffix):
        path = tmp_path / f"modes.{suffix}"
        simulation = simulate(mesh)
        simulation.reporters.append(ModeReporter(path, 2, mesh, 1))
        simulation.step(2)
        simulation.reporters[:] = [ModeReporter(path, 2, mesh, 2, append=True)]
        with pytest.raises(ValueError, match="do not append"):
            simulation.step(2)


class TestReporters:
    def test_answer_in_both_conventions(self, mesh, tmp_path):
        simulation = simulate(mesh)
        simulation.step(3)
        modes = ModeReporter(tmp_path / "m.csv", 10, mesh, 1).describeNextReport(simulation)
        assert modes == {"steps": 7, "periodic": False, "include": ["positions"]}
        assert [modes[i] for i in range(6)] == [7, True, False, False, False, False]
        shape = MembraneReporter(tmp_path / "s.csv", 10, mesh).describeNextReport(simulation)
        assert shape["include"] == ["positions", "energy"]
        assert [shape[i] for i in range(6)] == [7, True, False, False, True, False]
        with pytest.raises(KeyError):
            modes["forces"]

    def test_one_of_two_vesicles(self, mesh, tmp_path):
        other = Mesh.icosphere(2, 100).translated((1000, 0, 0))
        system, second = openmm.System(), Vesicle(other)
        first = Vesicle(mesh).add_to(system)
        place = second.add_to(system)
        topology = app.Topology()
        residue = topology.addResidue("MEM", topology.addChain())
        for _ in range(system.getNumParticles()):
            topology.addAtom("V", None, residue)
        platform = openmm.Platform.getPlatformByName("Reference")
        simulation = app.Simulation(topology, system, openmm.VerletIntegrator(0.01), platform)
        simulation.context.setPositions(np.concatenate([mesh.vertices, other.vertices]))
        simulation.reporters += [
            ModeReporter(tmp_path / "m.csv", 1, other, 2, offset=mesh.num_vertices),
            MembraneReporter(tmp_path / "s.csv", 1, other.triangles + mesh.num_vertices),
        ]
        simulation.step(1)
        now = positions_of(simulation)[list(place.particles)]
        expected = analysis.mode_amplitudes(now, other, 2)
        np.testing.assert_array_equal(
            analysis.read_modes(tmp_path / "m.csv").amplitudes, [expected]
        )
        table = analysis.read_table(tmp_path / "s.csv")
        assert table["volume"][0] == pytest.approx(analysis.shape(now, other).volume)
        # Both have a "bending"; the second is told by its force group.
        bending = f"bending_{place.bending.getForceGroup()}_energy"
        assert table[bending][0] == pytest.approx(place.energies(simulation.context)["bending"])
        assert table["bending_energy"][0] == pytest.approx(
            first.energies(simulation.context)["bending"]
        )

    def test_forces_that_share_a_group(self, mesh, tmp_path):
        system = openmm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(50)
        for force in (BendingForce(mesh, 50), SurfaceAreaForce(mesh, 1.3, 0.9 * mesh.area)):
            system.addForce(force)
        system.addForce(openmm.CMMotionRemover())
        platform = openmm.Platform.getPlatformByName("Reference")
        integrator = openmm.VerletIntegrator(0.01)
        simulation = app.Simulation(mesh.topology(), system, integrator, platform)
        simulation.context.setPositions(mesh.vertices)
        simulation.reporters.append(MembraneReporter(tmp_path / "s.csv", 1, mesh))
        simulation.step(1)
        table = analysis.read_table(tmp_path / "s.csv")
        assert table["BendingForce+SurfaceAreaForce_energy"] == table["potential_energy"]
        kinetic = table["kinetic_energy"][0]
        freedom = 3 * mesh.num_vertices - 3
        expected = 2 * kinetic / (freedom * theory.BOLTZMANN)
        assert table["temperature"][0] == pytest.approx(expected)

    @pytest.mark.parametrize(
        ("make", "error", "culprit"),
        [
            (lambda m, p: ModeReporter(p / "m.csv", 0, m, 2), ValueError, "reportInterval"),
            (lambda m, p: ModeReporter(p / "m.csv", np.nan, m, 2), ValueError, "Interval .*nan"),
            (lambda m, p: MembraneReporter(p / "m.csv", 1.5, m), ValueError, r"Interval .*1\.5"),
            (lambda m, p: ModeReporter(p / "m.csv", 1, m, -1), ValueError, "lmax"),
            (lambda m, p: ModeReporter(p / "m.csv", 1, m, np.nan), ValueError, "lmax .*nan"),
            (lambda m, p: MembraneReporter(p / "m.csv", 1, m, offset=-1), ValueError, "offset"),
            (
                lambda m, p: ModeReporter(p / "m.csv", 1, m, 2, offset=1.5),
                ValueError,
                r"offset .*1\.5",
            ),
            (lambda m, p: MembraneReporter(p / "m.csv", 1, [[0, 1]]), ValueError, "shape"),
            (
                lambda m, p: MembraneReporter(p / "m.csv", 1, Vesicle(m)),
                ValueError,
                "^MembraneReporter: triangles must have shape",
            ),
            (
                lambda m, p: MembraneReporter(p / "m.csv", 1, [[0, 1], [0, 1, 2]]),
                ValueError,
                "^MembraneReporter: triangles .*unequal length",
            ),
            (
                lambda m, p: MembraneReporter(p / "m.csv", 1, []),
                ValueError,
                "^MembraneReporter: triangles: there are none; give the Mesh",
            ),
            (
                lambda m, p: MembraneReporter(p / "m.csv", 1, m.triangles - 1, offset=1),
                ValueError,
                "^MembraneReporter: triangles: one has the index -1",
            ),
            (lambda m, p: ModeReporter(p / "m.txt", 1, m, 2), ValueError, "suffix"),
            (lambda m, p: ModeReporter(p / "m.csv", 1, m, 2, offset=1), ValueError, "particle 92"),
            (lambda m, p: ModeReporter(p / "m.csv", 1, m, 2, "sum"), ValueError, "quadrature"),
        ],
    )
    def test_bad_input_is_named(self, mesh, tmp_path, make, error, culprit):
        simulation = simulate(mesh)

        def report():
            simulation.reporters.append(make(mesh, tmp_path))
            simulation.step(1)

        with pytest.raises(error, match=culprit):
            report()

    @pytest.mark.parametrize("lost", [1, 9])
    def test_going_on_with_a_header_that_was_cut_off(self, mesh, tmp_path, lost):
        path = tmp_path / "modes.csv"
        simulation = simulate(mesh)
        simulation.reporters.append(ModeReporter(path, 2, mesh, 1))
        simulation.step(1)
        header = path.read_bytes()
        assert header.endswith(b",u_1_1\n")
        path.write_bytes(header[:-lost])
        simulation.reporters[:] = [ModeReporter(path, 2, mesh, 1, append=True)]
        simulation.step(1)
        assert path.read_bytes().startswith(header)
        assert analysis.read_modes(path).step.tolist() == [2]

    def test_files_that_are_none_of_a_reporter_are_not_appended_to(self, mesh, tmp_path):
        path = tmp_path / "modes.csv"
        header = "step,time (ps),u_0_0\n"
        for text, culprit in (
            ("notes", "do not append"),
            ("\n", "do not append"),
            (f"{header}2,0.1,0\nthree,0.2,0\n", "line 3: need a step"),
            (f"{header}\n", "line 2: need a step"),
        ):
            path.write_text(text)
            simulation = simulate(mesh)
            simulation.reporters.append(ModeReporter(path, 2, mesh, 0, append=True))
            with pytest.raises(ValueError, match=rf"modes\.csv.*{culprit}"):
                simulation.step(2)
            assert path.read_text() == text

    def test_the_mark_of_programs_for_tables_is_no_part_of_a_name(self, tmp_path):
        path = tmp_path / "saved.csv"
        path.write_text("step,time (ps)\n1,2\n", encoding="utf-8-sig")
        assert list(analysis.read_table(path)) == ["step", "time"]

    def test_bad_files_are_named(self, tmp_path):
        bad = tmp_path / "bad.csv"
        for text, culprit in (
            ("", "no header"),
            ("step,time (ps)\n1,2\n3,x\n", "line 3"),
            ("step,time (ps)\n1,2,3\n", "line 2: need 2 numbers .there are 3"),
            ("step,time (ps),area (nm^2)\n1,2,3\n7\n", "line 3: need 3 numbers .there are 1"),
            ("step,area (nm^2),area (nm^2)\n1,2,3\n", "line 1: there are two columns .area .nm"),
        ):
            bad.write_text(text)
            with pytest.raises(ValueError, match=culprit):
                analysis.read_table(bad)
        bad.write_bytes(b"step,time (ps)\n1,\xff\n")
        with pytest.raises(ValueError, match=r"read_table: .*bad\.csv is no text of a reporter"):
            analysis.read_table(bad)
        h5py = pytest.importorskip("h5py")
        for number, shape in enumerate([(2, 3), (2,), None]):
            path = tmp_path / f"{number}.h5"
            with h5py.File(path, "w") as file:
                file.attrs["columns"] = ["step", "time"]
                if shape:
                    file["rows"] = np.zeros(shape)
            with pytest.raises(ValueError, match=rf"{number}\.h5 has no rows of a reporter"):
                analysis.read_table(path)
            path.write_bytes(b"mine")
            with pytest.raises(ValueError, match=rf"{number}\.h5 is no HDF5 file, or is damaged"):
                analysis.read_table(path)
            assert path.read_bytes() == b"mine"
        bad.write_text("step,time (ps),u_0_0,u_1_0\n1,2,3,4\n")
        with pytest.raises(ValueError, match="no columns"):
            analysis.read_modes(bad)
        with pytest.raises(FileNotFoundError, match=r"nothing\.csv"):
            analysis.read_table(tmp_path / "nothing.csv")


def invoke(*arguments):
    return CliRunner().invoke(main, ["spectrum", *map(str, arguments)])


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The same frames as positions and as modes."""
    folder = tmp_path_factory.mktemp("spectrum")
    mesh = Mesh.icosphere(3, 200)
    mesh.write(folder / "mesh.ply")
    simulation = simulate(mesh)
    simulation.reporters += [
        ModeReporter(folder / "modes.csv", 5, mesh, 5),
        app.DCDReporter(str(folder / "run.dcd"), 5, enforcePeriodicBox=False),
    ]
    simulation.step(150)
    simulation.reporters.clear()
    return folder, mesh


class TestCommand:
    def rows(self, output):
        """Numbers of each line of the table."""
        lines = [line.replace("±", "").split() for line in output.splitlines()[2:]]
        return np.array([[float(word) for word in line[:-1]] for line in lines])

    def test_of_modes(self, run):
        folder, _ = run
        result = invoke(folder / "modes.csv", "--kappa", 20, "--csv", folder / "table.csv")
        assert result.exit_code == 0, result.output
        assert "30 frames" in result.output
        found = analysis.spectrum(analysis.read_modes(folder / "modes.csv").amplitudes)
        rows = self.rows(result.output)
        l = np.arange(2, 6)
        ratio = found.mean[2:] / theory.fluid_spectrum(l, 20)
        np.testing.assert_array_equal(rows[:, 0], l)
        np.testing.assert_allclose(rows[:, 1], found.mean[2:], rtol=1e-5)
        np.testing.assert_allclose(rows[:, 2], found.error[2:], rtol=1e-2)
        np.testing.assert_allclose(rows[:, 4], ratio, atol=1e-3)
        with (folder / "table.csv").open(newline="") as file:
            table = list(csv.DictReader(file))
        assert [float(row["mean"]) for row in table] == found.mean[2:].tolist()

    def test_of_a_trajectory(self, run):
        pytest.importorskip("mdtraj")
        folder, _ = run
        options = ["--lmax", 5, "--skip", 10, "--stride", 2, "--young", 1e-4, "--radius", 200]
        result = invoke(folder / "run.dcd", "--mesh", folder / "mesh.ply", *options)
        assert result.exit_code == 0, result.output
        modes = analysis.read_modes(folder / "modes.csv").amplitudes[10::2]
        found = analysis.spectrum(modes)
        rows = self.rows(result.output)
        np.testing.assert_allclose(rows[:, 1], found.mean[2:], rtol=1e-3)
        expected = theory.elastic_spectrum(np.arange(2, 6), 20, 1e-4, 200)
        np.testing.assert_allclose(rows[:, 3], expected, rtol=1e-2)

    def test_draws(self, run):
        folder, _ = run
        result = invoke(folder / "modes.csv", "--plot", folder / "spectrum.png")
        assert result.exit_code == 0, result.output
        assert (folder / "spectrum.png").read_bytes()[:4] == b"\x89PNG"

    def test_errors_are_one_line(self, run):
        folder, _ = run
        for arguments, culprit in (
            ((folder / "modes.csv", "--lmax", 9), "up to l = 5 only"),
            ((folder / "modes.csv", "--mesh", folder / "mesh.ply"), "--mesh is for trajectories"),
            ((folder / "modes.csv", "--skip", 29), "two frames or more"),
            ((folder / "no.csv",), "no file"),
            ((folder / "run.dcd",), "needs --mesh"),
            ((folder / "run.gro", "--mesh", folder / "mesh.ply"), "none of .xtc"),
        ):
            result = invoke(*arguments)
            assert result.exit_code != 0
            assert culprit in result.output
            assert "Traceback" not in result.output


COLUMNS = {name: "" for name in ("step", "time", "x")}


class TestHdf5:
    @pytest.fixture(autouse=True)
    def _h5py(self):
        pytest.importorskip("h5py")

    @pytest.mark.parametrize("rows", [1, pytest.param(256, marks=pytest.mark.long)])
    def test_kills_while_a_row_is_added(self, tmp_path, monkeypatch, rows):
        """Also where a chunk of 256 rows is begun, of which a kill could cost all."""
        path = tmp_path / "a.h5"
        moment = 0
        while True:
            table = open_table(path, COLUMNS, append=False)
            for number in range(rows):
                table.add([number, 0.5, 2.0])
            with killed_at(monkeypatch, moment):
                try:
                    table.add([rows, 0.5, 2.0])
                except Killed:
                    pass
                else:
                    break
            # The journal was whole, so that nothing is lost.
            again = open_table(path, COLUMNS, append=True)
            assert again.cut(1000) == rows
            assert analysis.read_table(path)["step"].tolist() == list(range(rows + 1))
            moment += 1
        assert moment > 1

    def test_a_file_that_was_cut_is_refused(self, tmp_path):
        path = tmp_path / "a.h5"
        open_table(path, COLUMNS, append=False).add([0, 0.5, 2.0])
        path.write_bytes(path.read_bytes()[:2000])
        with pytest.raises(ValueError, match=rf"{path} is no HDF5 file, or.*; do not append"):
            open_table(path, COLUMNS, append=True)


def test_two_reporters_of_a_simulation_never_write_to_one_file(mesh, tmp_path, monkeypatch):
    """As after a cell of a notebook that ran twice: nothing of the first one's file is lost."""
    simulation, path = simulate(mesh), tmp_path / "modes.csv"
    simulation.reporters.append(ModeReporter(path, 2, mesh, 1))
    simulation.step(4)
    monkeypatch.chdir(tmp_path)
    simulation.reporters.append(MembraneReporter("modes.csv", 2, mesh))
    with pytest.raises(ValueError, match=r"MembraneReporter: modes\.csv: another ModeReporter"):
        simulation.step(2)
    del simulation.reporters[-1]
    simulation.step(2)
    assert analysis.read_modes(path).step.tolist() == [2, 4, 6]
