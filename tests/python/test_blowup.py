"""Simulations that break down, and what is said about them."""

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmm import unit
from openmmhelfrich.blowup import Limits, Watch
from openmmhelfrich.blowup.parts import Parts
from openmmhelfrich.cli import main
from openmmhelfrich.simulation.runner import Run

MESH = helfrich.Mesh.random_sphere(252, radius=500, seed=1)


FLIPS = {"frequency": 5, "attemptsPerEdge": 0.2, "randomNumberSeed": 7}


def simulation(integrator, platform="Helfrich", mesh=MESH, **options):
    """A vesicle at 300 K."""
    built = helfrich.Vesicle(mesh, **options).simulation(integrator, platform)
    built.context.setVelocitiesToTemperature(300, 2)
    return built


def langevin(step, friction=0.01):
    """LangevinMiddle at 300 K."""
    integrator = openmm.LangevinMiddleIntegrator(300, friction, step)
    integrator.setRandomNumberSeed(3)
    return integrator


def broken(built, folder, interval=1000, steps=200_000, **limits):
    """The message of a simulation that breaks down."""
    watch = helfrich.BlowUpReporter(folder, interval, **limits)
    built.reporters.append(watch)
    with pytest.raises(helfrich.BlowUpError) as found, watch:
        built.step(steps)
    return str(found.value)


def harmonic(stiffness, mass, integrator):
    """A Context of one particle in a well for each stiffness, kJ/mol/nm²."""
    system = openmm.System()
    force = openmm.CustomExternalForce("k*(x^2+y^2+z^2)/2")
    force.addPerParticleParameter("k")
    for number, k in enumerate(stiffness):
        system.addParticle(mass)
        force.addParticle(number, [k])
    system.addForce(force)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(np.full((len(stiffness), 3), 0.1))
    return context


class TestStableTimeStep:
    @pytest.mark.parametrize("stiffness", [[400.0], [400.0, 100.0, 25.0, 1.0]])
    def test_wells(self, stiffness):
        context = harmonic(stiffness, 4.0, openmm.VerletIntegrator(0.001))
        assert helfrich.stable_time_step(context) == pytest.approx(2 / 10, rel=1e-6)
        assert helfrich.stable_time_step(context, 5 / unit.picosecond) == pytest.approx(
            2 * 5 / 100, rel=1e-6
        )

    @pytest.mark.parametrize(("part", "lasts"), [(0.999, True), (1.001, False)])
    def test_it_is_where_verlet_fails(self, part, lasts):
        step = part * 2 / 10
        context = harmonic([400.0], 4.0, openmm.VerletIntegrator(step))
        context.getIntegrator().step(2000)
        place = context.getState(getPositions=True).getPositions()[0][0] / unit.nanometer
        assert (abs(place) < 10) == lasts

    def test_it_leaves_the_context_as_it_was(self):
        built = simulation(langevin(0.2))
        built.step(100)
        before = built.context.createCheckpoint()
        step = helfrich.stable_time_step(built.context)
        assert built.context.createCheckpoint() == before
        assert helfrich.stable_time_step(built.context) == step

    @pytest.mark.parametrize("platform", ["Reference", "CPU", "Helfrich"])
    def test_platforms_agree(self, platform):
        built = simulation(openmm.VerletIntegrator(0.2), platform)
        assert helfrich.stable_time_step(built.context) == pytest.approx(7.8, rel=0.05)

    def test_the_whole_hessian(self):
        """A mesh's highest frequency from all elements of its Hessian."""
        built = simulation(openmm.VerletIntegrator(0.2), mesh=helfrich.Mesh.icosphere(1, 100.0))
        context = built.context
        start = np.array(context.getState(getPositions=True).getPositions(asNumpy=True)._value)
        rows = []
        for coordinate in range(start.size):
            moved = np.zeros(start.size)
            moved[coordinate] = 1e-4
            forces = []
            for sign in (1, -1):
                context.setPositions(start + sign * moved.reshape(-1, 3))
                state = context.getState(getForces=True)
                forces.append(np.array(state.getForces(asNumpy=True)._value).ravel())
            rows.append((forces[1] - forces[0]) / 2e-4)
        context.setPositions(start)
        highest = np.linalg.eigvalsh((np.array(rows) + np.transpose(rows)) / 2 / 50.0)[-1]
        assert helfrich.stable_time_step(context) == pytest.approx(2 / highest**0.5, rel=0.01)

    def test_refusals(self):
        system = openmm.System()
        system.addParticle(0)
        context = openmm.Context(system, openmm.VerletIntegrator(0.001))
        with pytest.raises(ValueError, match="no particle has a mass"):
            helfrich.stable_time_step(context)
        for _ in range(2):
            system.addParticle(1)
        system.addConstraint(1, 2, 0.1)
        context = openmm.Context(system, openmm.VerletIntegrator(0.001))
        with pytest.raises(ValueError, match="constraints"):
            helfrich.stable_time_step(context)


class TestReporter:
    @pytest.mark.parametrize("platform", ["Helfrich", "Reference"])
    @pytest.mark.parametrize("flips", [None, FLIPS])
    def test_a_time_step_that_is_too_long(self, platform, flips, tmp_path):
        built = simulation(langevin(5), platform, flips=flips)
        text = broken(built, tmp_path / "blow-up", interval=500)
        assert "Time step: 5 ps is TOO LONG" in text
        assert "did not break down this time" not in text
        assert text == (tmp_path / "blow-up" / "report.txt").read_text().rstrip("\n")

    def test_the_step_is_found_whatever_the_interval(self, tmp_path):
        found = set()
        for interval in (70, 10**6):
            text = broken(simulation(langevin(5)), tmp_path / str(interval), interval)
            found.add(next(line for line in text.splitlines() if "It broke down in step" in line))
        assert len(found) == 1

    def test_the_last_good_frame(self, tmp_path):
        built = simulation(langevin(5), flips=FLIPS)
        broken(built, tmp_path, interval=500)
        mesh = helfrich.Mesh.read(tmp_path / "last-good.ply")
        again = simulation(langevin(0.2), flips=FLIPS)
        helfrich.load_state(again.context, tmp_path / "last-good.state")
        mover = next(
            helfrich.MonteCarloBondFlip.cast(force)
            for force in again.system.getForces()
            if helfrich.MonteCarloBondFlip.isinstance(force)
        )
        assert np.array_equal(mesh.triangles, mover.getTrianglesInContext(again.context))
        state = again.context.getState(getPositions=True)
        assert np.array_equal(mesh.vertices, state.getPositions(asNumpy=True)._value)
        # It goes on from there with a time step that it can bear.
        again.step(2000)
        lowest = helfrich.analysis.triangle_heights(mesh.vertices, mesh).min()
        rows = (tmp_path / "history.csv").read_text().splitlines()
        column = rows[0].split(",").index("height (nm)")
        assert f"{lowest:.12g}" in [row.split(",")[column] for row in rows[1:]]

    def test_the_context_goes_back_to_the_last_look(self, tmp_path):
        built = simulation(langevin(5))
        broken(built, tmp_path, interval=100)
        assert built.currentStep % 100 == 0
        assert np.isfinite(built.context.getState(getEnergy=True).getPotentialEnergy()._value)

    def test_a_collapsed_triangle(self, tmp_path):
        built = simulation(langevin(0.2), softness=0.0)
        text = broken(built, tmp_path, interval=200, minHeight=5)
        assert "nm high, below the limit of 5 nm" in text.splitlines()[0]
        assert "Heights: triangle" in text
        assert "add a TriangleHeightForce" in text

    def test_a_fold(self, tmp_path):
        built = simulation(langevin(0.2), rigidity=0.0, softness=0.0)
        text = broken(built, tmp_path, interval=100, maxFold=150)
        assert "above the limit of 150°" in text.splitlines()[0]

    def test_a_temperature(self, tmp_path):
        built = simulation(openmm.VerletIntegrator(0.2))
        text = broken(built, tmp_path, interval=10, maxTemperature=200)
        assert text.startswith("the temperature is ")
        assert "above the limit of 200 K at step 0" in text

    def test_a_bad_start(self, tmp_path):
        vertices = MESH.vertices.copy()
        a, b, c = MESH.triangles[0]
        vertices[a] = (vertices[b] + vertices[c]) / 2 + 1e-4 * (vertices[a] - vertices[b])
        built = simulation(langevin(0.2))
        built.context.setPositions(vertices)
        text = broken(built, tmp_path)
        assert "Start: it was never normal" in text
        assert "minimizeEnergy" in text

    def test_a_state_without_an_energy(self, tmp_path):
        vertices = MESH.vertices.copy()
        vertices[17] = np.nan
        built = simulation(langevin(0.2))
        built.context.setPositions(vertices)
        assert "The state with which the simulation begins is at fault" in broken(built, tmp_path)

    def test_what_is_outside_of_the_simulation(self, tmp_path):
        """A state that does not come from its steps does not come back either."""
        built = simulation(langevin(0.2))
        watch = helfrich.BlowUpReporter(tmp_path, 100)
        built.reporters.append(watch)
        built.step(150)
        built.context.setPositions(np.full((252, 3), np.nan))
        with pytest.raises(helfrich.BlowUpError) as found, watch:
            built.step(1)
        assert "did not break down this time" in str(found.value)

    def test_afterwards(self, tmp_path):
        built = simulation(langevin(5))
        watch = helfrich.BlowUpReporter(tmp_path, 500)
        with pytest.raises(RuntimeError, match="append it"):
            watch.explain()
        built.reporters.append(watch)
        with pytest.raises(openmm.OpenMMException) as found:
            built.step(200_000)
        assert not isinstance(found.value, helfrich.BlowUpError)
        assert "TOO LONG" in str(watch.explain(found.value))

    @pytest.mark.parametrize("kind", [KeyError, ValueError])
    def test_other_errors_pass(self, kind, tmp_path):
        built = simulation(langevin(0.2))
        watch = helfrich.BlowUpReporter(tmp_path, 100)
        built.reporters.append(watch)
        built.step(10)
        with pytest.raises(kind, match="mine"), watch:
            raise kind("mine")

    def test_what_reporters_say(self, tmp_path):
        """OpenMM's reporter is the first to see that the energy is not finite."""
        built = simulation(langevin(5))
        built.reporters.append(
            openmm.app.StateDataReporter(str(tmp_path / "log"), 1, potentialEnergy=True)
        )
        assert "TOO LONG" in broken(built, tmp_path / "blow-up", interval=500)

    def test_a_folder_that_cannot_be_written(self, tmp_path):
        (tmp_path / "file").write_text("")
        text = broken(simulation(langevin(5)), tmp_path / "file" / "blow-up", interval=500)
        assert "TOO LONG" in text
        assert "The last good frame cannot be written" in text

    @pytest.mark.parametrize("name", ["maxTemperature", "minHeight", "maxFold"])
    @pytest.mark.parametrize("value", [0, -1, np.nan, "hot"])
    def test_numbers(self, name, value):
        with pytest.raises(ValueError, match=f"BlowUpReporter: {name} needs a positive"):
            helfrich.BlowUpReporter("x", 10, **{name: value})

    def test_two_surfaces(self, tmp_path):
        system = openmm.System()
        for offset, radius in ((0, 500), (252, 300)):
            mesh = helfrich.Mesh.random_sphere(252, radius=radius, seed=1)
            helfrich.Vesicle(mesh.translated([offset * 10, 0, 0])).add_to(system)
        platform = openmm.Platform.getPlatformByName("Helfrich")
        topology = openmm.app.Topology()
        built = openmm.app.Simulation(topology, system, langevin(5), platform)
        small = helfrich.Mesh.random_sphere(252, radius=300, seed=1).translated([2520, 0, 0])
        built.context.setPositions(np.concatenate([MESH.vertices, small.vertices]))
        broken(built, tmp_path, interval=500)
        assert {"last-good-0.ply", "last-good-1.ply", "last-0.ply"} <= {
            path.name for path in tmp_path.iterdir()
        }
        assert helfrich.Mesh.read(tmp_path / "last-good-1.ply").num_vertices == 252


class TestForces:
    """Which forces it comes from."""

    @staticmethod
    def pair(gap, **options):
        """A vesicle and its image in a mirror, a repulsion of 4 nm, and a Simulation."""
        system = openmm.System()
        right = helfrich.Mesh(MESH.vertices * [-1, 1, 1], MESH.triangles[:, ::-1])
        right = right.translated([2 * MESH.vertices[:, 0].max() + gap, 0, 0])
        for mesh in (MESH, right):
            helfrich.Vesicle(mesh, **options).add_to(system)
        both = np.concatenate([MESH.triangles, right.triangles + 252])
        force = helfrich.SurfaceRepulsionForce(both, 4, 2.5)
        force.setOnlyBetweenParts(True)
        system.addForce(force)
        platform = openmm.Platform.getPlatformByName("Helfrich")
        built = openmm.app.Simulation(openmm.app.Topology(), system, langevin(0.2), platform)
        built.context.setPositions(np.concatenate([MESH.vertices, right.vertices]))
        return built

    def test_heights(self, tmp_path):
        text = broken(simulation(langevin(5), flips=FLIPS), tmp_path, interval=500)
        assert " of heights, " in text.partition("Forces: the largest at step ")[2].splitlines()[0]
        assert "  The energy of heights has risen most since step " in text

    def test_a_repulsion(self, tmp_path):
        built = self.pair(gap=30.0)
        velocities = np.zeros((504, 3))
        velocities[:252, 0] = 40.0
        built.context.setVelocities(velocities)
        text = broken(built, tmp_path, interval=100)
        line = text.partition("Forces: the largest at step ")[2].splitlines()[0]
        assert line.partition(": ")[2].split(", ")[0].endswith(" of SurfaceRepulsionForce")

    def test_parts_are_the_whole(self):
        built = self.pair(gap=3.0, flips=FLIPS, rigidity=50)
        built.context.setVelocitiesToTemperature(300, 2)
        parts = Parts(built.context)
        assert parts.labels[:4] == ["area (force 0)", "volume (force 1)", "bending (force 2)",
                                    "heights (force 3)"]  # fmt: skip
        assert parts.labels[-1] == "SurfaceRepulsionForce"
        assert parts.take()[0][-1] > 1
        for _ in range(3):
            built.step(100)
            state = built.context.getState(getEnergy=True)
            energies = parts.take()[0]
            assert energies.sum() == pytest.approx(state.getPotentialEnergy()._value, rel=1e-12)
            assert energies[2] > 0

    def test_movers_before_the_forces(self):
        """The surfaces of the copy, which has no movers, come in another order."""
        system = openmm.System()
        small = helfrich.Mesh.icosphere(3, 100.0)
        other = helfrich.Mesh(small.vertices * [-1, 1, 1], small.triangles[:, ::-1])
        for offset, mesh in ((92, other), (0, small)):
            flips = helfrich.MonteCarloBondFlip(mesh.triangles + offset, 300, 2, 0.5)
            flips.setRandomNumberSeed(1)
            system.addForce(flips)
        for offset, mesh in ((0, small), (92, other)):
            system.addForce(helfrich.BendingForce(mesh.triangles + offset, 50.0))
            system.addForce(helfrich.SurfaceAreaForce(mesh.triangles + offset, 1.0, mesh.area))
            for _ in range(92):
                system.addParticle(50)
        platform = openmm.Platform.getPlatformByName("Helfrich")
        context = openmm.Context(system, openmm.VerletIntegrator(0.2), platform)
        beside = other.translated([300, 0, 0]).vertices
        context.setPositions(np.concatenate([small.vertices, beside]))
        context.setVelocitiesToTemperature(300, 1)
        parts = Parts(context)
        context.getIntegrator().step(50)
        whole = context.getState(getEnergy=True).getPotentialEnergy()._value
        assert parts.take()[0].sum() == pytest.approx(whole, rel=1e-12)

    def test_values_that_have_been_swapped(self):
        mesh = helfrich.Mesh.icosphere(3, 100.0)
        values = np.linspace(5.0, 50.0, mesh.num_vertices)
        force = helfrich.BendingForce(mesh, values)
        swaps = helfrich.MonteCarloDomainSwap(mesh, 300, 1, 1.0)
        swaps.setRandomNumberSeed(1)
        system = openmm.System()
        for _ in range(mesh.num_vertices):
            system.addParticle(50)
        system.addForce(force)
        system.addForce(swaps)
        platform = openmm.Platform.getPlatformByName("Helfrich")
        built = openmm.app.Simulation(openmm.app.Topology(), system, langevin(0.2), platform)
        built.context.setPositions(mesh.vertices)
        parts = Parts(built.context)
        start = parts.take()[0][0]
        built.step(200)
        now = built.context.getState(getEnergy=True).getPotentialEnergy()._value
        assert now != start
        assert parts.take()[0] == pytest.approx([now], rel=1e-12)

    def test_more_forces_than_groups(self):
        built = simulation(langevin(0.2))
        system = built.system
        scaled = openmm.CustomExternalForce("scale*x")
        scaled.addGlobalParameter("scale", 1)
        scaled.addParticle(7)
        system.addForce(scaled)
        for number in range(40):
            force = openmm.CustomExternalForce(f"{number}*x")
            force.addParticle(number)
            system.addForce(force)
        built.context.reinitialize(True)
        parts = Parts(built.context)
        built.context.setParameter("scale", 2.5)
        assert len(parts.labels) == 32
        assert parts.labels[-1] == "other forces"
        whole = built.context.getState(getEnergy=True).getPotentialEnergy()._value
        assert parts.take()[0].sum() == pytest.approx(whole, rel=1e-12)


class TestWatch:
    def test_looking_changes_no_bits(self):
        """Looks at each step, and none."""
        ends = []
        for looks in (True, False):
            built = simulation(langevin(0.2), flips=FLIPS)
            watch = Watch(built.context, built.integrator)
            for _ in range(50):
                built.step(7)
                if looks:
                    watch.look()
            ends.append(built.context.createCheckpoint())
        assert ends[0] == ends[1]

    def test_a_long_history_is_thinned(self):
        built = simulation(langevin(0.2), mesh=helfrich.Mesh.icosphere(1, 100.0))
        watch = Watch(built.context, built.integrator)
        for _ in range(3000):
            watch.look()
            built.step(1)
        steps = [moment.step for moment in watch.history]
        assert steps[0] == 0
        assert steps[-1] == 2999
        assert 500 <= len(steps) <= 1001
        assert set(np.diff(steps[:-1])) == {4}
        assert len(set(steps)) == len(steps)

    def test_sparing_looks(self):
        built = simulation(langevin(0.2))
        watch = Watch(built.context, built.integrator)
        watch.look()
        built.step(1)
        watch.look(sparing=True)
        assert [moment.step for moment in watch.history] == [0]

    def test_going_back(self):
        built = simulation(langevin(0.2))
        watch = Watch(built.context, built.integrator)
        watch.look()
        checkpoint = built.context.createCheckpoint()
        built.step(5)
        watch.look()
        built.context.loadCheckpoint(checkpoint)
        built.step(3)
        watch.look()
        assert [moment.step for moment in watch.history] == [0, 3]

    def test_limits_at_a_moment(self):
        built = simulation(langevin(0.2))
        watch = Watch(built.context, built.integrator, Limits(min_height=1e4))
        with pytest.raises(helfrich.BlowUpError, match=r"triangle \d+ \(\d+, \d+, \d+\) is"):
            watch.look()


CONFIGURATION = """
[simulation]
duration = {duration}
seed = 3
platform = "Helfrich"
[integrator]
time_step = {step}
[output]
interval = 500
[[vesicle]]
mesh = {{ random = 252, radius = 500, seed = 1 }}
{more}
"""


def run(folder, step, duration=1e6, more=""):
    """``openmm-helfrich run`` on a vesicle."""
    path = folder / "cell.toml"
    path.write_text(CONFIGURATION.format(step=step, duration=duration, more=more))
    return CliRunner().invoke(main, ["run", str(path), "--out", str(folder / "out")])


class TestRun:
    def test_a_time_step_that_is_too_long(self, tmp_path):
        result = run(tmp_path, 5.0)
        assert result.exit_code == 1
        assert "the simulation broke down: between steps" in result.output
        assert "docs/troubleshooting.md" in result.output
        assert "Time step: 5 ps is TOO LONG" in result.output
        assert "blow-up/last-good.ply" in result.output
        assert "Traceback" not in result.output
        found = {path.name for path in (tmp_path / "out" / "blow-up").iterdir()}
        assert found == {
            "history.csv",
            "last-good.ply",
            "last-good.state",
            "last.ply",
            "report.txt",
        }
        # The run goes on from its last checkpoint, to the same end.
        job = Run(tmp_path / "cell.toml", tmp_path / "out", resume=True)
        assert np.isfinite(job.frame.potential)
        job.close()

    @pytest.mark.parametrize(
        ("key", "value", "said"),
        [
            ("max_temperature", 100.0, "above the limit of 100 K"),
            ("min_height", 100.0, "below the limit of 100 nm"),
            ("max_fold", 5.0, "above the limit of 5°"),
        ],
    )
    def test_limits(self, key, value, said, tmp_path):
        result = run(tmp_path, 0.2, 1000, f"[watch]\n{key} = {value}")
        assert result.exit_code == 1
        assert said in result.output

    def test_limits_that_are_kept(self, tmp_path):
        more = "[watch]\nmax_temperature = 500.0\nmin_height = 0.1\nmax_fold = 170"
        assert run(tmp_path, 0.2, 1000, more).exit_code == 0
        assert not (tmp_path / "out" / "blow-up").exists()

    def test_a_key_that_does_not_exist(self, tmp_path):
        result = run(tmp_path, 0.2, 1000, "[watch]\nmin_heigth = 1")
        assert result.exit_code == 1
        assert "min_height" in result.output
