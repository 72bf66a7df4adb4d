"""Bond flips through the doors of vesicles, configuration files, reporters and analysis."""

import csv

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from openmm import app
from openmmhelfrich import MonteCarloBondFlip, analysis, vcm
from openmmhelfrich.simulation.outputs import take_frame
from openmmhelfrich.vcm.bonded import find_bond_on
from run_files import contents, fluid_and_solid, invoke

MESH = helfrich.Mesh.random_sphere(252, 500, seed=5)

VCM = """-GeneralParameters
ProjectName run
SimulationTimeInPs 8
StepSizeInFs 400
ReportIntervalInFs 2000
Integrator LM
Seed 4
-Membrane 0
MeshFile sphere.ply
NodeMass 50
MeanCurvatureModel Julicher1996
MeanCurvatureCoeff 50
SurfaceConstraint G
SurfaceConstraintCoeff 1.3
{more}
-InteractionTable
M0 0
"""


def toml(folder, flips):
    path = folder / "run.toml"
    path.write_text(fluid_and_solid(16, 4, "vtk", flips))
    return path


def integrator(temperature=310):
    result = openmm.LangevinMiddleIntegrator(temperature, 0.01, 0.4)
    result.setRandomNumberSeed(7)
    return result


class TestVesicle:
    def test_rate_is_attempts_per_edge_and_step(self):
        vesicle = helfrich.Vesicle(MESH, flips=0.03)
        simulation = vesicle.simulation(integrator())
        simulation.context.setVelocitiesToTemperature(310, 3)
        simulation.step(200)
        mover = vesicle.placement.flips
        statistics = mover.getStatistics(simulation.context)
        edges = len(MESH.edges)
        assert statistics["attempts"] == pytest.approx(0.03 * 200 * edges, abs=1)
        assert statistics["accepted"] > 0.1 * statistics["attempts"]
        present = vesicle.placement.mesh(simulation.context)
        assert present.num_triangles == MESH.num_triangles
        assert set(map(tuple, present.edges)) != set(map(tuple, MESH.edges))

    @pytest.mark.parametrize("given, expected", [({}, 310), ({"temperature": 290}, 290)])
    def test_temperature_is_the_integrators_unless_it_is_given(self, given, expected):
        simulation = helfrich.Vesicle(MESH, flips={"frequency": 5, **given}).simulation(
            integrator()
        )
        assert simulation.context.getParameter(MonteCarloBondFlip.Temperature()) == expected

    def test_baths_of_other_integrators_are_found(self):
        compound = openmm.CompoundIntegrator()
        compound.addIntegrator(integrator(350))
        compound.addIntegrator(integrator(350))
        multiple = openmm.MTSLangevinIntegrator(340, 0.01, 0.4, [(0, 1)])
        for made, expected in ((compound, 350), (multiple, 340)):
            context = helfrich.Vesicle(MESH, flips=0.1).simulation(made, "Reference").context
            found = context.getParameter(MonteCarloBondFlip.Temperature())
            assert found == pytest.approx(expected, rel=1e-5)
        mixed = openmm.CompoundIntegrator()
        mixed.addIntegrator(integrator(300))
        mixed.addIntegrator(integrator(310))
        with pytest.raises(ValueError, match="the integrators have the temperatures"):
            helfrich.Vesicle(MESH, flips=0.1).simulation(mixed, "Reference")

    def test_beads_that_would_share_bonds_are_refused(self):
        system = helfrich.Vesicle(MESH, flips=0.1).system()
        with pytest.raises(openmm.OpenMMException, match="beads of an RPMDIntegrator"):
            openmm.Context(
                system,
                openmm.RPMDIntegrator(4, 300, 1, 0.001),
                openmm.Platform.getPlatformByName("Reference"),
            )

    def test_triangles_turned_inside_out_are_refused(self):
        simulation = helfrich.Vesicle(MESH).simulation(integrator())
        force = helfrich.EnclosedVolumeForce.cast(simulation.system.getForce(1))
        simulation.context.getState(energy=True)
        force.setTrianglesInContext(simulation.context, MESH.triangles[:, ::-1].copy())
        with pytest.raises(openmm.OpenMMException, match="clockwise"):
            simulation.context.getState(energy=True)

    def test_arguments_reach_the_mover(self):
        flips = {
            "frequency": 4,
            "attemptsPerEdge": 0.5,
            "minDegree": 4,
            "maxDegree": 9,
            "maxEdgeLength": 200,
            "randomNumberSeed": 11,
            "ensemble": MonteCarloBondFlip.Microcanonical,
        }
        mover = helfrich.Vesicle(MESH, flips=flips).add_to(openmm.System()).flips
        found = [mover.getFrequency(), mover.getAttemptsPerEdge(), mover.getMinDegree()]
        found += [mover.getMaxDegree(), mover.getMaxEdgeLength(), mover.getRandomNumberSeed()]
        assert [*found, mover.getEnsemble()] == list(flips.values())

    @pytest.mark.parametrize(
        "flips, message",
        [
            ({"rate": 1}, "flips has no argument 'rate'; known are temperature, frequency"),
            (-0.1, "flips"),
            ({"frequency": -1}, "frequency must be a number of steps"),
            ({"maxDegree": 2}, "maxDegree must be 3 or more"),
        ],
    )
    def test_mistakes_are_named_at_once(self, flips, message):
        with pytest.raises((ValueError, openmm.OpenMMException), match=message):
            helfrich.Vesicle(MESH, flips=flips)

    def test_without_flips_nothing_moves(self):
        placement = helfrich.Vesicle(MESH).add_to(system := openmm.System())
        assert placement.flips is None and system.getNumForces() == len(placement.forces)


class TestToml:
    @pytest.mark.parametrize("platform", ["Helfrich", "Reference"])
    def test_a_run_in_two_parts_has_the_bits_of_one(self, tmp_path, platform):
        path = toml(tmp_path, 0.05)
        option = ["--platform", platform]
        invoke("run", path, "--out", tmp_path / "whole", *option)
        invoke("run", path, "--out", tmp_path / "parts", "--steps", 20, *option)
        invoke("run", path, "--out", tmp_path / "parts", "--resume")
        whole, parts = (contents(tmp_path / name) for name in ("whole", "parts"))
        names = {name for name in whole if "checkpoint" not in name}
        assert {"run.csv", "run.xtc", "run.triangles"} <= names
        assert {name: whole[name] for name in names} == {name: parts[name] for name in names}

    def test_files_have_the_triangles_of_each_frame(self, tmp_path):
        invoke("run", toml(tmp_path, 0.05), "--out", tmp_path / "run")
        with (tmp_path / "run/run.csv").open() as file:
            rows = list(csv.DictReader(file))
        count = helfrich.Mesh.random_sphere(132, 400).num_triangles
        both = count + helfrich.Mesh.random_sphere(92, 300).num_triangles
        triangles = analysis.read_triangles(tmp_path / "run/run.triangles", both)
        assert len(triangles) == len(rows) == 5
        changed = [len(np.argwhere((frame != triangles[0]).any(axis=1))) for frame in triangles]
        assert changed[0] == 0 and min(changed[1:]) > 0
        for number in range(5):
            for label, mine in (("fluid", triangles[:, :count]), ("solid", triangles[:, count:])):
                mesh = helfrich.Mesh.read(tmp_path / f"run/frames/run_{label}_{number:06d}.vtk")
                volume = float(rows[number][f"volume {label} (nm^3)"])
                assert mesh.volume == pytest.approx(volume, rel=1e-9)
                offset = 132 if label == "solid" else 0
                assert (mesh.triangles == mine[number] - offset).all()
        assert (triangles[:, count:] == triangles[0, count:]).all()

    def test_seed_and_temperature_are_the_runs(self, tmp_path):
        cfg = helfrich.config.read(toml(tmp_path, "{ frequency = 5, max_degree = 9 }"))
        system = cfg.system()
        forces = system.getForces()
        (mover,) = (MonteCarloBondFlip.cast(f) for f in forces if MonteCarloBondFlip.isinstance(f))
        assert (mover.getFrequency(), mover.getMaxDegree()) == (5, 9)
        assert (mover.getRandomNumberSeed(), mover.getDefaultTemperature()) == (3, 300)
        assert cfg.flows

    @pytest.mark.parametrize(
        "flips, message",
        [
            ("{ rate = 1 }", "there is no 'rate' in flips"),
            ("{ max_degree = 2 }", "max_degree: must be 3 or more, got 2"),
            ("-1", "must be 0 or more"),
            ("true", "expected a number"),
        ],
    )
    def test_mistakes_have_their_line(self, tmp_path, flips, message):
        with pytest.raises(vcm.ConfigError, match=message) as caught:
            helfrich.config.read(toml(tmp_path, flips))
        assert "run.toml:12" in str(caught.value)


def bonded_forces(i: int, j: int) -> list[openmm.Force]:
    """Forces with bonds of particles that are far from the mesh, and one of i and j."""
    a, b = 60, 61
    bond, angle = openmm.HarmonicBondForce(), openmm.HarmonicAngleForce()
    bond.addBond(a, b, 1, 1)
    bond.addBond(i, j, 1, 1)
    angle.addAngle(i, a, j, 1, 1)
    periodic, ryckaert = openmm.PeriodicTorsionForce(), openmm.RBTorsionForce()
    periodic.addTorsion(i, a, b, j, 1, 1, 1)
    ryckaert.addTorsion(a, i, b, j, 1, 1, 1, 1, 1, 1)
    custom_bond = openmm.CustomBondForce("r")
    custom_bond.addBond(j, i)
    custom_angle = openmm.CustomAngleForce("theta")
    custom_angle.addAngle(a, j, i)
    custom_torsion = openmm.CustomTorsionForce("theta")
    custom_torsion.addTorsion(i, j, a, b)
    compound = openmm.CustomCompoundBondForce(3, "distance(p1, p3)")
    compound.addBond([a, b, 62], [])
    compound.addBond([i, a, j], [])
    centroid = openmm.CustomCentroidBondForce(2, "distance(g1, g2)")
    for particle in (i, j):
        centroid.addGroup([particle])
    centroid.addBond([0, 1], [])
    maps = openmm.CMAPTorsionForce()
    maps.addTorsion(maps.addMap(2, [0] * 4), a, b, 62, i, j, 63, 64, 65)
    inside = openmm.HarmonicBondForce()
    inside.addBond(i, j, 1, 1)
    variable, outer = openmm.CustomCVForce("x"), openmm.CustomCVForce("y")
    variable.addCollectiveVariable("x", inside)
    outer.addCollectiveVariable("y", variable)
    simple = [bond, angle, periodic, ryckaert, custom_bond, custom_angle, custom_torsion]
    return [*simple, compound, centroid, maps, outer]


class TestVcm:
    def config(self, folder, more=""):
        helfrich.Mesh.random_sphere(132, 400, seed=2).write(folder / "sphere.ply")
        path = folder / "run.txt"
        path.write_text(VCM.format(more=more))
        return path

    def test_membranes_flow_on_request(self, tmp_path):
        path = self.config(tmp_path)
        invoke("run", path, "--out", tmp_path / "run", "--flips", 0.05)
        triangles = analysis.read_triangles(tmp_path / "run/run.triangles", 260)
        assert (triangles[-1] != triangles[0]).any()
        invoke("run", path, "--out", tmp_path / "solid")
        assert not (tmp_path / "solid/run.triangles").exists()

    def test_what_would_not_follow_is_refused(self, tmp_path):
        path = self.config(tmp_path, "SpringModel H\nSpringCoeff 1")
        vcm.read(path)
        with pytest.raises(
            vcm.ConfigError,
            match=r"\"springs\" acts on particles \d+ and \d+, which the mesh connects",
        ):
            vcm.read(path, flips=0.05)

    def test_pairs_left_out_by_edges_are_refused(self, tmp_path):
        path = self.config(tmp_path)
        text = path.read_text().replace("Seed 4", "Seed 4\nbondCutoff 2")
        path.write_text(text)
        assert vcm.read(path, flips=0.05).system().getNumForces()
        path.write_text(text.replace("M0 0", "M0 EV"))
        vcm.read(path).system()
        with pytest.raises(vcm.ConfigError, match=r"bondCutoff: .*does not follow flips"):
            vcm.read(path, flips=0.05)

    def test_only_bonds_on_edges_are_refused(self):
        mesh = helfrich.Mesh.icosphere(1, 100)
        i, j = mesh.edges[5].tolist()
        far = next(k for k in range(42) if all(sorted((i, k)) != e for e in mesh.edges.tolist()))
        edges = {tuple(edge) for edge in np.sort(mesh.edges, axis=1).tolist()}
        for on, bond in ((True, j), (False, far), (False, 50)):
            pair = (min(i, bond), max(i, bond)) if on else None
            for force in bonded_forces(bond, i):
                assert find_bond_on(edges, force) == pair, force
        assert find_bond_on(edges, openmm.NonbondedForce()) is None

    def test_centres_of_patches_are_no_bonds(self):
        force = openmm.CustomCentroidBondForce(2, "distance(g1, g2)")
        for group in ([0, 1, 2], [3, 4], [1]):
            force.addGroup(group)
        force.addBond([0, 1], [])
        force.addBond([2, 1], [])
        assert find_bond_on({(0, 1), (2, 3), (1, 3)}, force) is None

    def test_a_toml_file_says_it_itself(self, tmp_path):
        result = invoke("run", toml(tmp_path, 0.1), "--flips", 0.1)
        assert result.exit_code == 1 and "in place of --flips" in result.output

    @pytest.mark.parametrize("flips", [-1, 1000, float("nan")])
    def test_rates_have_a_range(self, tmp_path, flips):
        with pytest.raises(ValueError, match="flips must be 0 to 100"):
            vcm.read(self.config(tmp_path), flips=flips)


class TestReporters:
    def test_rows_are_about_the_triangles_of_their_moment(self, tmp_path):
        vesicle = helfrich.Vesicle(MESH, flips=0.1)
        simulation = vesicle.simulation(integrator())
        simulation.context.setVelocitiesToTemperature(310, 3)
        reporters = simulation.reporters
        reporters.append(helfrich.ModeReporter(tmp_path / "modes.csv", 50, MESH, lmax=3))
        reporters.append(helfrich.MembraneReporter(tmp_path / "shape.csv", 50, MESH))
        expected = []
        for _ in range(4):
            simulation.step(50)
            expected.append(vesicle.placement.mesh(simulation.context))
        table = analysis.read_table(tmp_path / "shape.csv")
        assert table["volume"] == pytest.approx([mesh.volume for mesh in expected], rel=1e-9)
        assert "flips_energy" not in table
        _, _, amplitudes = analysis.read_modes(tmp_path / "modes.csv")
        frames = np.array([mesh.vertices for mesh in expected])
        own = np.array([mesh.triangles for mesh in expected])
        assert amplitudes == pytest.approx(analysis.mode_amplitudes(frames, own, 3), abs=1e-12)
        # The triangles of the start give other numbers, so that the test can fail.
        wrong = analysis.mode_amplitudes(frames, MESH, 3)
        assert np.abs(amplitudes - wrong).max() > 1e-6

    def test_other_triangles_are_refused(self, tmp_path):
        vesicle = helfrich.Vesicle(MESH, flips=0.1)
        simulation = vesicle.simulation(integrator())
        turned = np.roll(MESH.triangles, 1, axis=1)
        simulation.reporters.append(helfrich.ModeReporter(tmp_path / "m.csv", 10, turned, lmax=2))
        with pytest.raises(ValueError, match="ModeReporter: the triangles are not those on which"):
            simulation.step(10)


class TestByHand:
    """Triangles that `setTrianglesInContext` has set, with nothing in the System that flips."""

    def flipped(self):
        """The mesh with one edge turned, and what it was before."""
        triangles = MESH.triangles.copy()
        a, b = MESH.edges[40].tolist()
        left, right = np.flatnonzero(np.isin(triangles, (a, b)).sum(axis=1) == 2).tolist()
        c, d = (next(iter({*triangles[side].tolist()} - {a, b})) for side in (left, right))
        triangles[left], triangles[right] = [d, c, a], [c, d, b]
        return helfrich.Mesh(MESH.vertices, triangles)

    def simulation(self, offset=0):
        system = openmm.System()
        for _ in range(offset):
            system.addParticle(1)
        vesicle = helfrich.Vesicle(MESH)
        placement = vesicle.add_to(system)
        result = app.Simulation(
            app.Topology(), system, integrator(), openmm.Platform.getPlatformByName("Reference")
        )
        start = np.concatenate([np.zeros((offset, 3)), MESH.vertices])
        result.context.setPositions(start)
        return placement, result

    @pytest.mark.parametrize("offset", [0, 5])
    def test_reporters_and_meshes_follow(self, tmp_path, offset):
        placement, simulation = self.simulation(offset)
        path = tmp_path / "shape.csv"
        reporter = helfrich.MembraneReporter(path, 1, MESH, offset=offset)
        simulation.reporters.append(reporter)
        simulation.step(1)
        target = self.flipped()
        # One force for all of the surface.
        placement.area.setTrianglesInContext(simulation.context, target, offset=offset)
        simulation.step(1)
        volumes = analysis.read_table(path)["volume"]
        now = helfrich.Mesh.from_context(simulation.context, placement.bending)
        assert np.array_equal(now.triangles, target.triangles)
        assert volumes[1] == pytest.approx(now.volume, rel=1e-12)
        assert abs(helfrich.Mesh(now.vertices, MESH.triangles).volume / now.volume - 1) > 1e-7

    def test_other_triangles_are_refused_once_they_have_changed(self, tmp_path):
        placement, simulation = self.simulation()
        turned = np.roll(MESH.triangles, 1, axis=1)
        simulation.reporters.append(helfrich.MembraneReporter(tmp_path / "m.csv", 1, turned))
        simulation.step(1)
        placement.area.setTrianglesInContext(simulation.context, self.flipped())
        with pytest.raises(ValueError, match="MembraneReporter: the triangles are not those on"):
            simulation.step(1)

    def test_frames_of_runs_follow(self, tmp_path):
        helfrich.Mesh.random_sphere(132, 400, seed=2).write(tmp_path / "sphere.ply")
        (tmp_path / "run.txt").write_text(VCM.format(more=""))
        cfg = vcm.read(tmp_path / "run.txt")
        simulation = cfg.simulation("Reference")
        force = helfrich.BendingForce
        (bending,) = (force.cast(f) for f in simulation.system.getForces() if force.isinstance(f))
        start = cfg.membranes[0].mesh
        corners = start.triangles.copy()
        corners[[0, 1]] = corners[[1, 0]]
        bending.setTrianglesInContext(simulation.context, corners)
        (found,) = take_frame(cfg, simulation.context, 0).triangles
        assert np.array_equal(found, corners) and not np.array_equal(found, start.triangles)


class TestAnalysis:
    def test_frames_may_have_their_own_triangles(self):
        meshes = [helfrich.Mesh.random_sphere(132, 400, seed=seed) for seed in range(3)]
        frames = np.array([mesh.vertices for mesh in meshes])
        own = np.array([mesh.triangles for mesh in meshes])
        # Plain lists will do.
        assert (analysis.triangle_areas(frames, own.tolist()) > 0).all()
        volumes = analysis.shape(frames, own).volume
        assert volumes == pytest.approx([mesh.volume for mesh in meshes], rel=1e-12)
        curvatures = analysis.mean_curvature(frames, own)
        for mesh, found in zip(meshes, curvatures, strict=True):
            assert found == pytest.approx(analysis.mean_curvature(mesh.vertices, mesh), rel=1e-12)

    def test_there_must_be_triangles_for_each_frame(self):
        frames = np.array([MESH.vertices] * 3)
        for count in (2, 4):
            with pytest.raises(ValueError, match="triangles: there are those of"):
                analysis.shape(frames, np.array([MESH.triangles] * count))

    def test_files_of_triangles_are_checked(self, tmp_path):
        path = tmp_path / "run.triangles"
        path.write_bytes(bytes(100))
        with pytest.raises(ValueError, match="100 bytes, which are not frames of 4 triangles"):
            analysis.read_triangles(path, 4)


def test_topologies_are_those_of_the_start():
    simulation = helfrich.Vesicle(MESH, flips=0.1).simulation(integrator())
    assert isinstance(simulation, app.Simulation)
    assert simulation.topology.getNumBonds() == len(MESH.edges)
