"""Configurations in TOML: what they build, the place of every mistake, and runs of them."""

import csv
import re
from pathlib import Path

import contact_twin
import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from click.testing import CliRunner
from openmmhelfrich import (
    BendingForce,
    GaussianCurvatureForce,
    Mesh,
    MonteCarloMembraneTension,
    Vesicle,
    analysis,
    config,
)
from openmmhelfrich.analysis import theory
from openmmhelfrich.cli import main
from openmmhelfrich.config.document import Document
from openmmhelfrich.config.keys import REQUIRED
from openmmhelfrich.simulation.runner import Run
from openmmhelfrich.vcm import ConfigError
from run_files import contents, results

ROOT = Path(__file__).resolve().parents[2]
SMALL = """simulation.duration = 4
integrator.time_step = 0.02

[[vesicle]]
mesh = { icosphere = 2, radius = 30 }
"""
TWO = """# A comment with [brackets] and a = sign
[simulation]
name = "pair"
duration = 2
seed = 7
platform = "reference"

[integrator]
kind = "Langevin"
time_step = 0.02
temperature = 310
friction = 0.5

[output]
interval = 0.4
text = ["xyz", "velocities"]
xtc = false
ply = true

[[vesicle]]
name = "first"
rigidity = "15 kT"
softness = 0.2
area_modulus = 2

[vesicle.mesh]
random = 40
radius = 30
seed = 3
scale = [1, 1.1, 0.9]
deform = { l = 2, m = -1, amplitude = 0.1 }

[[vesicle]]
rigidity = 40
scheme = "GompperKrollBarycentric"
spontaneous_curvature = 0.02
volume = 60000
dihedral_stiffness = "2 kT"

[vesicle.mesh]
file = "ball.ply"
oblate = 0.9
rotate = [0, 90, 0]
translate = [55, 0, 0]

[repulsion]
strength = "5 kT"
distance = 12
"""


@pytest.fixture
def write(tmp_path):
    Mesh.icosphere(2, 25.0).write(tmp_path / "ball.ply")

    def write(text, name="own.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


def invoke(*arguments):
    return CliRunner().invoke(main, [str(word) for word in arguments])


def state(system, positions, groups=-1):
    context = openmm.Context(
        system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference")
    )
    context.setPositions(positions)
    found = context.getState(energy=True, forces=True, groups=groups)
    return found.getPotentialEnergy()._value, found.getForces(asNumpy=True)._value


class TestWhatIsBuilt:
    def by_hand(self):
        kT = theory.BOLTZMANN * 310
        first = Mesh.random_sphere(40, 30, seed=3).scaled((1, 1.1, 0.9)).deformed(2, -1, 0.1)
        quarter = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
        second = Mesh.icosphere(2, 25.0).oblate(0.9).rotated(quarter).translated((55, 0, 0))
        vesicles = [
            Vesicle(first, rigidity=15 * kT, softness=0.2, area_modulus=2),
            Vesicle(
                second,
                rigidity=40,
                scheme=BendingForce.GompperKrollBarycentric,
                spontaneous_curvature=0.02,
                volume=60000,
                dihedral_stiffness=2 * kT,
            ),
        ]
        system = openmm.System()
        for vesicle in vesicles:
            vesicle.add_to(system)
        return system, np.concatenate([first.vertices, second.vertices])

    def test_two_vesicles_as_by_hand(self, write):
        cfg = config.read(write(TWO))
        system, positions = self.by_hand()
        assert np.allclose(cfg.positions, positions, rtol=0, atol=1e-10)
        shaken = positions + np.random.default_rng(1).normal(scale=0.5, size=positions.shape)
        membrane_terms = {g for name, g in cfg.terms.items() if name != "repulsion"}
        energy, forces = state(cfg.system(), shaken, membrane_terms)
        expected, expected_forces = state(system, shaken)
        assert energy == pytest.approx(expected, rel=1e-12)
        assert np.allclose(forces, expected_forces, rtol=0, atol=1e-11 * abs(forces).max())
        masses = [cfg.system().getParticleMass(i)._value for i in range(cfg.num_particles)]
        assert masses == [50] * 82

    def test_repulsion_is_between_vesicles_only(self, write):
        cfg = config.read(write(TWO))
        positions = cfg.positions * 0.9
        energy, _ = state(cfg.system(), positions, {cfg.terms["repulsion"]})
        triangles = np.vstack([m.vesicle.mesh.triangles + m.particles[0] for m in cfg.membranes])
        part = (np.arange(82) >= 40).astype(int)
        expected = contact_twin.surface_repulsion(positions, triangles, 12, 5 * cfg.kT, part)
        assert expected > 0
        assert energy == pytest.approx(expected, rel=1e-9)

    def test_a_vesicle_may_keep_off_itself(self, write):
        cfg = config.read(
            write(SMALL + "[repulsion]\nstrength = 1\ndistance = 13\nwithin = true\n")
        )
        flat = cfg.positions * [1, 1, 0.1]
        energy, _ = state(cfg.system(), flat, {cfg.terms["repulsion"]})
        triangles = cfg.membranes[0].vesicle.mesh.triangles
        expected = contact_twin.surface_repulsion(flat, triangles, 13, 1)
        assert expected > 0
        assert energy == pytest.approx(expected, rel=1e-9)

    @pytest.mark.parametrize(
        ("more", "message"),
        [
            ("[repulsion]\nstrength = 1\ndistance = 14\nwithin = true\n",
             r"7: key repulsion.distance: .* less than the triangles are high, 13.5"),
            ('[integrator]\nkind = "Brownian"\nfriction = 0\n',
             r"7: key integrator.friction: Brownian dynamics need more than 0"),
            ("[integrator]\ntime_step = 5\n", "1: key simulation.duration: 4 ps is less than the"),
            ("[watch]\nmax_fold = 200\n", "watch.max_fold: must be 180 or less, got 200"),
            ("reduced_volume = 1.5\n", "reduced_volume: must be 1 or less, got 1.5"),
            ("flips = 101\n", r"vesicle\[0\].flips: must be 100 or less, got 101"),
            ("flips = { attempts_per_edge = 0.1, min_degree = 6, max_degree = 5 }\n",
             r"vesicle\[0\].flips: max_degree must not be below min_degree, got 5 and 6"),
            ('skeleton = { law = "Spring", ratio = 0.4 }\n', "Spring needs stiffness"),
        ],
    )  # fmt: skip
    def test_what_cannot_be_meant(self, write, more, message):
        text = SMALL.replace("integrator.time_step = 0.02\n", "") + more
        if "Brownian" in more:
            text += "time_step = 0.02\n"
        with pytest.raises(ConfigError, match=message):
            config.read(write(text))

    def test_terms_are_named_and_apart(self, write):
        cfg = config.read(write(TWO))
        kinds = ("area", "volume", "bending", "heights")
        names = [f"{kind} first" for kind in kinds] + [f"{kind} 1" for kind in kinds]
        assert list(cfg.terms) == [*names, "dihedrals 1", "repulsion"]
        assert len(set(cfg.terms.values())) == len(cfg.terms)

    def test_one_vesicle_has_plain_names_and_the_papers_defaults(self, write):
        cfg = config.read(write(SMALL))
        assert list(cfg.terms) == ["area", "volume", "bending", "heights"]
        vesicle = cfg.membranes[0].vesicle
        assert vesicle.rigidity == pytest.approx(20 * theory.BOLTZMANN * 300)
        assert (vesicle.area_modulus, vesicle.volume_modulus, vesicle.mass) == (1.3, 0.04, 50)
        assert cfg.num_steps == 200
        assert isinstance(cfg.integrator(), openmm.LangevinMiddleIntegrator)

    def test_integrator(self, write):
        integrator = config.read(write(TWO)).integrator()
        assert isinstance(integrator, openmm.LangevinIntegrator)
        assert integrator.getTemperature()._value == 310
        assert integrator.getFriction()._value == 0.5
        assert integrator.getStepSize()._value == 0.02
        assert integrator.getRandomNumberSeed() == 7

    def test_many_vesicles_share_groups_by_kind(self, write):
        one = "[[vesicle]]\nmesh = { icosphere = 1, radius = 10, translate = [%d, 0, 0] }\n"
        text = "simulation.duration = 1\n" + "".join(one % (40 * i) for i in range(9))
        cfg = config.read(write(text))
        assert cfg.terms == {"area": 0, "volume": 1, "bending": 2, "heights": 3}
        context = cfg.simulation("Reference").context
        alone = config.read(write("simulation.duration = 1\n" + one % 0, "one.toml"))
        single = alone.energies(alone.simulation("Reference").context)
        assert cfg.energies(context)["bending"] == pytest.approx(9 * single["bending"])


# What replaces a line of TWO (or nothing: what is added at its end), and the message.
SOURCES = "file, icosphere, random, sheet, tube, disk"
MISTAKES = [
    ("rigidity = 40", "rigidty = 40", "vesicle[1].rigidty: there is no such key in [[vesicle]]; "
     "did you mean rigidity?"),
    ("rigidity = 40", "rigidity = -1", "vesicle[1].rigidity: must be 0 or more, got -1"),
    ("rigidity = 40", 'rigidity = "many"', 'vesicle[1].rigidity: expected a number in kJ/mol or a '
     "string such as \"20 kT\", got 'many'"),
    ("rigidity = 40", 'rigidity = "nan kT"', "vesicle[1].rigidity: expected a number in kJ/mol"),
    ("rigidity = 40", "rigidity = true", "vesicle[1].rigidity: expected a number in kJ/mol"),
    ("area_modulus = 2", "area_modulus = inf", "vesicle[0].area_modulus: expected a finite number"),
    ("area_modulus = 2", "area_modulus = 1" + 400 * "0", "vesicle[0].area_modulus: expected a fin"),
    ("area_modulus = 2", 'area_modulus = "2"', "vesicle[0].area_modulus: expected a number"),
    ('scheme = "GompperKrollBarycentric"', 'scheme = "GompperKrol"',
     "vesicle[1].scheme: there is no 'GompperKrol'; did you mean GompperKroll?"),
    ("volume = 60000", "volume = 60000\nreduced_volume = 0.9",
     "vesicle[1].reduced_volume: give either volume or reduced_volume, not both"),
    ("rigidity = 40", 'name = "first"', "vesicle[1].name: another vesicle is called 'first'"),
    ('name = "first"', 'name = "a b"', "vesicle[0].name: expected a word without spaces"),
    ("random = 40", "random = 13", "vesicle[0].mesh.random: Mesh.random_sphere: no triangulation"),
    ("random = 40", "random = 40.0", "vesicle[0].mesh.random: expected an integer, got 40.0"),
    ("random = 40", "random = 40\nicosphere = 3",
     f"vesicle[0].mesh.random: a mesh needs one of {SOURCES}; got icosphere and"),
    ("random = 40", "", f"vesicle[0].mesh: a mesh needs one of {SOURCES}; got none"),
    ("radius = 30", "", "vesicle[0].mesh.random: a sphere needs a radius"),
    ("radius = 30", "radius = 0", "vesicle[0].mesh.radius: must be above 0, got 0"),
    ("deform = { l = 2, m = -1, amplitude = 0.1 }", "deform = { l = 2, m = -3, amplitude = 0.1 }",
     "vesicle[0].mesh.deform: must be -2 or more, got -3"),
    ("deform = { l = 2, m = -1, amplitude = 0.1 }", "deform = { l = 2, m = 0, amplitude = 90.0 }",
     "vesicle[0].mesh.deform: Mesh.deformed: amplitude 90.0 moves vertex"),
    ("scale = [1, 1.1, 0.9]", "scale = [1, 0, 1]", "vesicle[0].mesh.scale: a factor must not be 0"),
    ("scale = [1, 1.1, 0.9]", "scale = [1, 2]", "vesicle[0].mesh.scale: expected three numbers"),
    ('file = "ball.ply"', 'file = "bell.ply"',
     "vesicle[1].mesh.file: Mesh.read: there is no file"),
    ("random = 40", "random = 40\ntriangulate = true",
     "vesicle[0].mesh.triangulate: it says how to read a file, and this mesh is made"),
    ('file = "ball.ply"', 'file = "ball.ply"\nmerge = -1',
     "vesicle[1].mesh.merge: must be 0 or more, got -1"),
    ('file = "ball.ply"', 'file = "ball.ply"\nmerge = 30',
     "vesicle[1].mesh.file: Mesh.read: "),
    ("ply = true", "ply = true\nframes = \"vtk\"", "output.ply: give either frames or ply"),
    ("ply = true", 'frames = "vtp"', "output.frames: there is no 'vtp'; did you mean vtk?"),
    ('file = "ball.ply"', 'file = "ball.ply"\nradius = 3',
     "vesicle[1].mesh.radius: a mesh from a file has its own size; use scale"),
    ('file = "ball.ply"', 'file = "ball.ply"\nseed = 3', "vesicle[1].mesh.seed: only a random"),
    ("oblate = 0.9", "oblate = 1.5", "vesicle[1].mesh.oblate: Mesh.oblate: reduced_volume must be"),
    ("oblate = 0.9", "oblate = 0.9\nprolate = 0.9", "vesicle[1].mesh.prolate: give either"),
    ("duration = 2", "", "simulation.duration: it is missing, and [simulation] needs it"),
    ("duration = 2", "duration = -2", "simulation.duration: must be 0 or more, got -2"),
    ("seed = 7", "seed = 1.5", "simulation.seed: expected an integer, got 1.5"),
    ("seed = 7", "seed = 2147483648", "simulation.seed: must be 2147483647 or less"),
    ('name = "pair"', 'name = "a/b"', "simulation.name: expected a name for files, got 'a/b'"),
    ('platform = "reference"', 'platform = "Abacus"', "simulation.platform: no platform 'Abacus'"),
    ('kind = "Langevin"', 'kind = "langevin"', "integrator.kind: there is no 'langevin'; did you"),
    ("temperature = 310", "temperature = 0", "integrator.temperature: must be above 0, got 0"),
    ("time_step = 0.02", "time_step = 0.5", "output.interval: 0.4 ps is less than the time step"),
    ('text = ["xyz", "velocities"]', 'text = ["xyz", "speed"]', "output.text: there is no 'speed'"),
    ("xtc = false", 'xtc = "no"', "output.xtc: expected true or false, got 'no'"),
    ("[output]", "[outputs]", "outputs: there is no such table; did you mean output?"),
    ("distance = 12", "", "repulsion.distance: it is missing"),
]  # fmt: skip


class TestMistakes:
    @pytest.mark.parametrize(("line", "replacement", "message"), MISTAKES)
    def test_message_has_line_and_key(self, write, line, replacement, message):
        """The number is that of the line that is wrong, or of the table that lacks something."""
        number = 1 + TWO.splitlines().index(line)
        text = TWO.replace(f"{line}\n", f"{replacement}\n")
        path = write(text)
        with pytest.raises(ConfigError) as caught:
            config.read(path)
        where, _, what = str(caught.value).removeprefix(f"{path}:").partition(": key ")
        assert what.startswith(message)
        key = message.split(":")[0].rpartition(".")[2]
        added = [row.lstrip("[").startswith(key) for row in replacement.split("\n")]
        if any(added):
            assert int(where) == number + added.index(True)
        else:
            assert text.splitlines()[int(where) - 1].startswith(("[", key))

    def test_no_vesicle(self, write):
        with pytest.raises(ConfigError, match=r"own\.toml:1: key vesicle: .* \[\[vesicle\]\]"):
            config.read(write("simulation.duration = 1\n"))

    def test_single_table_in_place_of_an_array(self, write):
        text = "simulation.duration = 1\n[vesicle]\nrigidity = 1\n"
        with pytest.raises(ConfigError, match=r"own\.toml:2: key vesicle: .* \[\[vesicle\]\]"):
            config.read(write(text))

    def test_no_mesh(self, write):
        text = "simulation.duration = 1\n\n[[vesicle]]\nrigidity = 1\n"
        with pytest.raises(ConfigError, match=r"own\.toml:3: key vesicle\[0\]\.mesh: a vesicle ne"):
            config.read(write(text))

    def test_repulsion_of_one(self, write):
        text = SMALL + "[repulsion]\nstrength = 1\ndistance = 2\n"
        with pytest.raises(ConfigError, match=r"own\.toml:6: key repulsion: .* one only"):
            config.read(write(text))

    @pytest.mark.parametrize(
        ("text", "line"), [("a = \n", 1), ("a = 1\nb = [\n", 2), ("\n[x\n", 2)]
    )
    def test_not_toml(self, write, text, line):
        with pytest.raises(ConfigError, match=rf"own\.toml:{line}: not valid TOML"):
            config.read(write(text))

    def test_not_text(self, tmp_path):
        (tmp_path / "own.toml").write_bytes(b"\xff\xfe\x00")
        with pytest.raises(ConfigError, match="not a text file in UTF-8"):
            config.read(tmp_path / "own.toml")

    def test_command_shows_one_line(self, write):
        path = write(TWO.replace("rigidity = 40", "rigidity = []"))
        for command in ("run", "info"):
            result = invoke(command, path)
            assert result.exit_code == 1
            assert re.fullmatch(r"Error: \S+own\.toml:\d+: key vesicle\[1\].*\n", result.output)

    def test_options_of_vcm_are_refused(self, write):
        result = invoke("info", write(SMALL), "--ignore-unknown")
        assert result.exit_code == 1
        assert "ignore_unknown is for VCM's configurations" in result.output

    def test_missing_file(self, tmp_path):
        result = invoke("run", tmp_path / "none.toml")
        assert result.exit_code == 1
        assert "there is no file" in result.output


def test_lines_of_keys(write):
    """Strings and arrays of several lines, dotted and quoted keys, nested arrays of tables."""
    path = write('''top = """
a = 1
[no.table]
"""
numbers = [
  [1, 2], # ]
  [3, 4],
]
"odd key".inner = 'x = "'
[a.b]
c.d = { e = 1 }
[[list]]
x = 1
[[list.deep]]
y = 2
[[list]]
"x" = 3
[[list.deep]]
y = 4
[[list.deep]]
z = """one""" # a = [
last = 5
''')
    document = Document(path)
    assert [document.line(place) for place in (
        ("top",), ("numbers",), ("odd key", "inner"), ("a", "b"), ("a", "b", "c", "d"),
        ("a", "b", "c", "d", "e"), ("list", 0), ("list", 0, "x"), ("list", 0, "deep", 0, "y"),
        ("list", 1, "x"), ("list", 1, "deep", 0, "y"), ("list", 1, "deep", 1, "z"),
        ("list", 1, "deep", 1, "last"), ("list", 1, "deep", 1, "none"), ("none",),
    )] == [1, 5, 9, 10, 11, 11, 12, 13, 15, 17, 19, 21, 22, 20, 1]  # fmt: skip


class TestRun:
    def test_minimise_finds_a_minimum_of_a_membrane(self, write):
        def start(text):
            context = config.read(write(text)).simulation("Reference").context
            state = context.getState(energy=True, forces=True)
            return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value

        text = SMALL.replace("icosphere = 2, radius = 30", "random = 162, radius = 300")
        (before, all_forces), (after, left) = (
            start(text),
            start("simulation.minimise = true\n" + text),
        )
        assert np.sqrt((all_forces**2).mean()) > 0.015
        assert np.sqrt((left**2).mean()) < 0.008
        assert after < before - 1

    def test_outputs(self, write, tmp_path):
        out = tmp_path / "out"
        result = invoke("run", write(TWO), "--out", out)
        assert result.exit_code == 0, result.output
        assert "pair: 2 membrane(s), 82 vertices, platform Reference, seed 7" in result.output
        files = set(contents(out))
        frames = {f"frames/pair_{v}_{n:06d}.ply" for v in ("first", "1") for n in range(6)}
        assert files == {
            ".lock", "checkpoint.bin", "checkpoint-previous.bin",
            "pair.csv", "pair.xyz", "pair.vel", *frames,
        }  # fmt: skip
        rows = list(csv.DictReader((out / "pair.csv").open(encoding="utf-8")))
        assert [float(row["time (ps)"]) for row in rows] == pytest.approx(
            [0, 0.4, 0.8, 1.2, 1.6, 2]
        )
        cfg = config.read(tmp_path / "own.toml")
        last = [Mesh.read(out / f"frames/pair_{v}_000005.ply") for v in ("first", "1")]
        energy, _ = state(cfg.system(), np.concatenate([mesh.vertices for mesh in last]))
        assert float(rows[-1]["potential (kJ/mol)"]) == pytest.approx(energy, rel=1e-9)
        assert float(rows[-1]["area first (nm^2)"]) == pytest.approx(last[0].area, rel=1e-10)

    @pytest.mark.parametrize("platform", ["Reference", "Helfrich"])
    def test_in_two_parts_as_in_one(self, write, tmp_path, platform):
        path = write(TWO.replace("reference", platform))
        for folder, ends in (("one", [100]), ("two", [37, 100])):
            for number, end in enumerate(ends):
                job = Run(path, tmp_path / folder, resume=number > 0)
                assert job.platform == platform
                assert job.advance(end)
                job.close()
        assert results(tmp_path / "one") == results(tmp_path / "two")

    def test_options_override_the_file(self, write, tmp_path):
        out = tmp_path / "out"
        result = invoke(
            "run", write(TWO), "--out", out, "--xtc", "--no-ply", "--platform", "CPU", "--steps", 5
        )
        assert "platform CPU" in result.output
        assert "pair.xtc" in contents(out)
        assert not (out / "frames").exists()

    def test_info(self, write):
        result = invoke("info", write(TWO), "--no-measure")
        assert result.exit_code == 0, result.output
        assert "pair: 2 membrane(s), 82 vertices" in result.output
        assert "Langevin, 100 steps of 0.02 ps: 2 ps at 310 K" in result.output
        cfg = config.read(write(TWO))
        assert f"τ_2 = {cfg.membranes[1].vesicle.tau_2:.5g} ps" in result.output
        assert "softness Ξ = 0.2 " in result.output

    def test_name_and_seed_of_their_own(self, write, tmp_path):
        result = invoke("run", write(SMALL), "--out", tmp_path / "out", "--steps", 0, "--seed", 9)
        assert "own: 1 membrane(s), 42 vertices, platform Helfrich, seed 9" in result.output


SHEET = """simulation.duration = 40
simulation.seed = 3
simulation.platform = "Reference"
integrator = { time_step = 0.5, friction = 0.01 }
output = { interval = 4, frames = "ply", text = ["curvatures"] }

[tension]
tension = 0.01
frequency = 3

[[vesicle]]
volume_modulus = 0
softness = 0.33
flips = 0.02
mesh = { sheet = [8, 9], spacing = 50, periodic = true }
"""
DISK = """simulation.duration = 4
integrator.time_step = 0.1
output = { interval = 2, frames = "vtk" }
box.vectors = [300, 250, 200]

[[vesicle]]
volume_modulus = 0
edge_tension = 3
gaussian_modulus = "-10 kT"
mesh = { disk = 5, radius = 60 }
"""


class TestAnySurface:
    def test_a_sheet_as_by_hand(self, write):
        cfg = config.read(write(SHEET))
        mesh = Mesh.sheet(8, 9, 50, periodic=True)
        assert cfg.meshes == (mesh,)
        by_hand = openmm.System()
        Vesicle(mesh, volume_modulus=0, softness=0.33).add_to(by_hand)
        system = cfg.system()
        for one in (system, by_hand):
            box = one.getDefaultPeriodicBoxVectors()
            assert np.array_equal([[x._value for x in vector] for vector in box], mesh.box)
        shaken = mesh.vertices + np.random.default_rng(1).normal(size=mesh.vertices.shape)
        assert state(system, shaken)[0] == state(by_hand, shaken)[0] > 0
        assert list(cfg.terms) == ["area", "bending", "heights"]
        (mover,) = (f for f in system.getForces() if MonteCarloMembraneTension.isinstance(f))
        mover = MonteCarloMembraneTension.cast(mover)
        assert mover.getDefaultTension() == 0.01
        assert mover.getFrequency() == 3
        assert mover.getAxes() == MonteCarloMembraneTension.XYIsotropic
        vectors = cfg.topology().getPeriodicBoxVectors()
        assert np.array_equal([[x._value for x in vector] for vector in vectors], mesh.box)

    def test_a_disk_as_by_hand(self, write, tmp_path):
        cfg = config.read(write(DISK))
        mesh = Mesh.disk(5, 60)
        expected = -10 * cfg.kT
        assert cfg.energies(cfg.simulation("Reference").context) == pytest.approx(
            {
                "area": 0,
                "bending": 0,
                "heights": 0,
                "edge_tension": 3 * 30 * 2 * 60 * np.sin(np.pi / 30),
                "gaussian_curvature": mesh.energy(GaussianCurvatureForce(mesh, expected)),
            },
            abs=1e-9,
        )
        result = invoke("run", write(DISK), "--out", tmp_path / "out")
        assert result.exit_code == 0, result.output
        with (tmp_path / "out" / "own.csv").open() as file:
            row = next(csv.DictReader(file))
        assert float(row["area 0 (nm^2)"]) == pytest.approx(mesh.area)
        assert not any(name.startswith("volume") for name in row)
        # It begins across faces of the box, and is drawn whole.
        drawn = Mesh.read(tmp_path / "out" / "frames" / "own_0_000000.vtk")
        assert drawn.num_vertices == mesh.num_vertices
        assert drawn.area == pytest.approx(mesh.area)
        result = invoke("info", write(DISK), "--no-measure")
        assert "nm², 1 border(s)" in result.output
        result = invoke("info", write(SHEET), "--no-measure")
        assert "nm², spans the periodic box" in result.output

    def test_a_run_goes_on_with_its_box(self, write, tmp_path):
        path = write(SHEET)
        whole = Run(path, tmp_path / "whole")
        assert whole.advance(80)
        whole.close()
        parts = Run(path, tmp_path / "parts")
        parts.advance(37)
        parts.save()
        parts.close()
        parts = Run(path, tmp_path / "parts", resume=True)
        assert parts.advance(80)
        parts.close()
        assert not np.array_equal(parts.frame.box, parts.cfg.box)
        assert np.array_equal(parts.frame.box, whole.frame.box)
        assert np.array_equal(parts.frame.positions, whole.frame.positions)
        last = Mesh.read(tmp_path / "parts" / "frames" / "own_0_000010.ply")
        assert np.array_equal(last.box, whole.frame.box)
        with (tmp_path / "parts" / "own.csv").open() as file:
            *_, row = csv.DictReader(file)
        assert float(row["area 0 (nm^2)"]) == pytest.approx(last.area)

    def test_a_file_keeps_its_box(self, write, tmp_path):
        Mesh.sheet(8, 9, 50, periodic=True).write(tmp_path / "sheet.ply")
        text = SHEET.replace("sheet = [8, 9], spacing = 50, periodic = true", 'file = "sheet.ply"')
        assert config.read(write(text)).meshes == config.read(write(SHEET)).meshes

    def test_a_box_may_be_rounded(self, write):
        rounded = "box.vectors = [[400, 0, 0], [25, 389.7, 0], [0, 0, 400]]\n"
        assert config.read(write(rounded + SHEET)).box[1, 1] == 389.7

    def test_the_box_of_the_file_comes_first(self, write):
        height = "box.vectors = [[400, 0, 0], [25, 389.7114317029974, 0], [0, 0, 999]]\n"
        assert config.read(write(height + SHEET)).box[2, 2] == 999

    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            ("volume_modulus = 0\n", "", r"11: key vesicle\[0\]: .*spans.*volume_modulus=0"),
            (", periodic = true", "", r"7: key tension: it acts on a periodic box; add \[box\]"),
            ("spacing = 50, ", "", r"mesh.sheet: a sheet needs a spacing, nm"),
            ("spacing = 50", "spacing = 50, radius = 2", "only a icosphere or random or tube or"),
            ("[8, 9]", "[8, 9, 1]", r"mesh.sheet: expected two integers"),
            ("[8, 9]", "[8, 1]", r"mesh.sheet: must be 2 or more, got 1"),
            ("[tension]", "[box]\nvectors = 3\n[tension]", r"box.vectors: expected \[x, y, z\]"),
            ("[tension]", "[box]\nvectors = [9, 0, 9]\n[tension]", "box.vectors: box must have"),
            (
                "[tension]",
                "[box]\nvectors = [90, 90, 90]\n[tension]",
                r"spans a box whose a is \[400",
            ),
            ("tension = 0.01", 'axes = "x"', "tension.axes: there is no 'x'"),
            ("softness", "volume = 3\nsoftness", r"encloses no volume; give no volume"),
        ],
    )
    def test_mistakes(self, write, old, new, message):
        with pytest.raises(ConfigError, match=message):
            config.read(write(SHEET.replace(old, new, 1)))

    @pytest.mark.parametrize(
        ("tension", "message"),
        [
            ("pulling_force = 10", "tension.pulling_force: it acts with axes = .ZOnly. only"),
            ('tension = 1\naxes = "XYConstantArea"', "tension.tension: these axes have none"),
            ('axes = "ZOnly"\npulling_force = 3', "changes the box along z, which no mesh spans"),
        ],
    )
    def test_what_would_pull_at_nothing(self, write, tension, message):
        text = SHEET.replace("tension = 0.01", tension)
        with pytest.raises(ConfigError, match=message):
            config.read(write(text))

    def test_a_box_around_a_vesicle_has_no_tension(self, write):
        text = SMALL + "[box]\nvectors = [200, 200, 200]\n[tension]\ntension = 0.1\n"
        with pytest.raises(ConfigError, match="along x and y, which no mesh spans"):
            config.read(write(text))

    def test_boxes_of_meshes_must_agree(self, write):
        other = """[[vesicle]]
volume_modulus = 0
mesh = { sheet = [8, 10], spacing = 50, periodic = true, translate = [0, 0, 99] }
"""
        with pytest.raises(ConfigError, match=r"vesicle\[1\]\.mesh: its box is not that of the"):
            config.read(write(SHEET + other))


PRESSED = """simulation.duration = 4
integrator.temperature = 310

[[vesicle]]
pressure = -0.001
surface_tension = 0.02
osmotic = { solutes = 4000, concentration = 0.04 }
area_difference = { alpha = 1.4, delta_a0 = 1.1 }
mesh = { icosphere = 2, radius = 30 }
"""


class TestTotals:
    def test_as_by_hand(self, write):
        cfg = config.read(write(PRESSED))
        mesh = Mesh.icosphere(2, 30)
        given = {
            "pressure": -0.001,
            "surface_tension": 0.02,
            "osmotic": {"solutes": 4000, "concentration": 0.04, "thermalEnergy": cfg.kT},
            "area_difference": {"alpha": 1.4, "delta_a0": 1.1},
        }
        system = openmm.System()
        Vesicle(mesh, **given).add_to(system)
        shaken = mesh.vertices + np.random.default_rng(1).normal(size=mesh.vertices.shape)
        found, expected = state(cfg.system(), shaken), state(system, shaken)
        assert found[0] == expected[0] != 0
        assert np.array_equal(found[1], expected[1])
        assert list(cfg.terms)[4:] == list(given)
        assert cfg.kT == pytest.approx(theory.BOLTZMANN * 310)

    def test_as_numbers(self, write):
        plain = PRESSED.replace("alpha = 1.4, delta_a0 = 1.1", "modulus = 0.1, target = -30")
        own = plain.replace("concentration = 0.04", 'concentration = 0.04, thermal_energy = "2 kT"')
        cfg = config.read(write(own))
        mesh = cfg.meshes[0]
        energies = cfg.energies(cfg.simulation("Reference").context)
        total = analysis.total_mean_curvature(mesh, mesh)
        assert energies["area_difference"] == pytest.approx(0.05 * (total + 30) ** 2)
        x = 0.04 * mesh.volume / 4000
        assert energies["osmotic"] == pytest.approx(4000 * 2 * cfg.kT * (x - 1 - np.log(x)))

    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            ("= -0.001", '= "1 kT"', r"5: key vesicle\[0\].pressure: expected a number"),
            ("solutes = 4000", "solutes = 0", r"osmotic: solutes: must be above 0, got 0"),
            ("solutes = 4000", "solute = 4000", r"no 'solute' in osmotic; did you mean solutes"),
            ("solutes = 4000, ", "", r"osmotic: osmotic needs solutes"),
            ("alpha", "beta", r"area_difference: there is no 'beta' in area_difference"),
            ("alpha = 1.4, ", "", r"needs either alpha and delta_a0, or modulus and"),
            ("icosphere = 2", "disk = 3", r"mesh.*; volume_modulus=0 leaves the volume out"),
        ],
    )
    def test_mistakes(self, write, old, new, message):
        with pytest.raises(ConfigError, match=message):
            config.read(write(PRESSED.replace(old, new, 1)))


SKELETON = """simulation.duration = 4

[[vesicle]]
skeleton = { law = "Skalak", shear_modulus = 0.4, area_modulus = 1 }
mesh = { icosphere = 2, radius = 30 }
"""


class TestSkeleton:
    @pytest.mark.parametrize(
        ("table", "force", "arguments"),
        [
            (
                'law = "Skalak", shear_modulus = 0.4, area_modulus = 1',
                "SkalakForce",
                {"shearModulus": 0.4, "areaModulus": 1},
            ),
            (
                'law = "LinearElastic", shear_modulus = 0, area_modulus = 1',
                "LinearElasticForce",
                {"shearModulus": 0, "areaModulus": 1},
            ),
            (
                'law = "Spring", stiffness = 2, form = "WLCPower", ratio = 0.4',
                "SpringForce",
                {"stiffness": 2, "form": "WLCPower", "ratio": 0.4},
            ),
        ],
    )
    def test_as_by_hand(self, write, table, force, arguments):
        before = 'law = "Skalak", shear_modulus = 0.4, area_modulus = 1'
        cfg = config.read(write(SKELETON.replace(before, table)))
        mesh = Mesh.icosphere(2, 30)
        shaken = mesh.vertices + np.random.default_rng(1).normal(size=mesh.vertices.shape)
        context = cfg.simulation("Reference").context
        context.setPositions(shaken)
        by_hand = getattr(helfrich, force)(mesh, reference=mesh, **arguments)
        expected = Mesh(shaken, mesh.triangles).energy(by_hand)
        assert cfg.energies(context)["skeleton"] == pytest.approx(expected, rel=1e-12)
        assert expected > 0.1

    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            ("Skalak", "Skalac", r"skeleton: law: there is no 'Skalac'; did you mean Skalak"),
            ("shear_modulus", "modulus", r"no 'modulus' in skeleton"),
            ("shear_modulus = 0.4, ", "", r"skeleton: Skalak needs shear_modulus"),
            ("= 0.4", "= -0.4", r"shear_modulus: must be 0 or more, got -0.4"),
            ("shear_modulus = 0.4", "ratio = 1.0", r"ratio: must be below 1, got 1"),
            ("= 0.4", "= 0.4, stiffness = 1", r"the law Skalak has no stiffness; its keys"),
            ('{ law = "Skalak", shear_modulus = 0.4, area_modulus = 1 }', "1", r"expected a table"),
        ],
    )
    def test_mistakes(self, write, old, new, message):
        with pytest.raises(ConfigError, match=message):
            config.read(write(SKELETON.replace(old, new, 1)))

    def test_of_a_vesicle(self):
        mesh = Mesh.icosphere(2, 30)
        larger = 1.1 * mesh.vertices
        given = {"shearModulus": 0.4, "areaModulus": 1, "reference": larger}
        vesicle = Vesicle(mesh, skeleton=given)
        context = vesicle.simulation(openmm.VerletIntegrator(0.01), "Reference").context
        expected = mesh.energy(helfrich.SkalakForce(mesh, 0.4, 1, larger))
        assert vesicle.energies(context)["skeleton"] == pytest.approx(expected, rel=1e-12)
        for wrong, error, message in (
            (1.0, TypeError, "needs a mapping"),
            ({"law": "Hooke"}, ValueError, "no law 'Hooke'; known are Skalak"),
            ({"shearModulus": 1}, TypeError, r"SkalakForce\.__init__\(\) missing .*'areaModulus'"),
        ):
            with pytest.raises(error, match=message):
                Vesicle(mesh, skeleton=wrong)


class TestDocuments:
    def test_example(self, tmp_path):
        path = ROOT / "examples" / "vesicle.toml"
        cfg = config.read(path)
        assert [membrane.label for membrane in cfg.membranes] == ["sphere", "oblate"]
        assert cfg.meshes[1].reduced_volume == pytest.approx(0.8)
        result = invoke("run", path, "--steps", 20, "--out", tmp_path / "out")
        assert result.exit_code == 0, result.output

    def test_example_of_a_sheet(self, tmp_path):
        path = ROOT / "examples" / "sheet.toml"
        cfg = config.read(path)
        assert [mesh.genus for mesh in cfg.meshes] == [1, 0]
        assert all((mesh.box == cfg.box).all() for mesh in cfg.meshes)
        result = invoke("run", path, "--steps", 2000, "--out", tmp_path / "out")
        assert result.exit_code == 0, result.output
        frames = sorted((tmp_path / "out" / "frames").glob("sheet_sheet_*.ply"))
        first, last = (Mesh.read(frames[k]).box for k in (0, -1))
        assert (first == cfg.box).all()
        assert first[0, 0] != last[0, 0] and first[2, 2] == last[2, 2]

    def test_files_in_the_text(self, write):
        text = (ROOT / "docs" / "config.md").read_text(encoding="utf-8")
        smallest, sheet = (part.partition("```")[0] for part in text.split("```toml\n")[1:])
        assert config.read(write(smallest)).num_particles == 1002
        assert config.read(write(sheet)).num_particles == 24 * 28

    def test_table_of_keys(self):
        def shown(default):
            if default is REQUIRED:
                return "needed"
            if default is None:
                return "–"
            if isinstance(default, bool):
                return f"`{default}`".lower()
            if isinstance(default, tuple):
                return "`[]`"
            return f'`"{default}"`' if isinstance(default, str) else f"`{default:g}`"

        lines = ["| table | key | default | meaning |", "| -- | -- | -- | -- |"]
        lines += [
            f"| {key.table} | `{key.name}` | {shown(key.default)} | {key.meaning} |"
            for key in config.KEYS
        ]
        text = (ROOT / "docs" / "config.md").read_text(encoding="utf-8")
        start = "<!-- keys: made from openmmhelfrich.config.KEYS -->\n"
        found = text.partition(start)[2].partition("\n<!-- end of keys -->")[0]
        assert found.strip("\n") == "\n".join(lines)
