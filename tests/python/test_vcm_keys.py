"""What each key does: a test per key, by its effect on what is simulated, and its bad values."""

from pathlib import Path

import numpy as np
import openmm as mm
import pytest
import string_forces
from openmmhelfrich import (
    BendingForce,
    DihedralForce,
    EnclosedVolumeForce,
    Mesh,
    SurfaceAreaForce,
    TriangleAreaForce,
    TriangleAreaRepulsionForce,
    TriangleHeightForce,
    vcm,
)
from openmmhelfrich.analysis import theory
from vcm_files import SIZE, Folder, energies, forces, line_of

KT = theory.BOLTZMANN * 310
TESTED = set()


def about(*keys):
    """Marks a test as the one of these keys."""

    def mark(test):
        TESTED.update(keys)
        return test

    return mark


@pytest.fixture
def folder(tmp_path, lumpy):
    return Folder(tmp_path, lumpy)


@pytest.fixture
def moved(lumpy):
    """The lumpy mesh with every vertex a little elsewhere."""
    random = np.random.default_rng(3)
    return Mesh(lumpy.vertices + random.normal(scale=0.05, size=(SIZE, 3)), lumpy.triangles)


def edge_lengths(mesh):
    ends = mesh.vertices[mesh.edges]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)


def test_every_key_has_a_test():
    assert {key.name for key in vcm.KEYS} == TESTED


def test_every_key_says_what_it_means():
    for key in vcm.KEYS:
        assert key.doc.endswith((".", "none.", "T.", "25.")), key.name
    names = [(key.section, key.name) for key in vcm.KEYS]
    assert len(names) == len(set(names))


class TestGeneral:
    @about("ProjectName")
    def test_name(self, folder):
        assert folder.read(general="ProjectName cell").name == "cell"
        assert folder.read().name == "VCProject"

    @about("SimulationTimeInPs", "StepSizeInFs")
    def test_steps(self, folder):
        cfg = folder.read(general="SimulationTimeInPs 30\nStepSizeInFs 200")
        assert (cfg.num_steps, cfg.step_size) == (150, 0.2)
        assert cfg.integrator().getStepSize()._value == 0.2
        assert folder.read().num_steps == 1000

    @about("Integrator", "FrictionIninvertPs", "TemperatureinKelvin")
    @pytest.mark.parametrize(
        ("word", "cls"),
        [
            ("V", mm.VerletIntegrator),
            ("B", mm.BrownianIntegrator),
            ("L", mm.LangevinIntegrator),
            ("LM", mm.LangevinMiddleIntegrator),
        ],
    )
    def test_integrator(self, folder, word, cls):
        text = f"Integrator {word}\nFrictionIninvertPs 0.25\nTemperatureinKelvin 77"
        integrator = folder.read(general=text).integrator()
        assert type(integrator) is cls
        if word != "V":
            assert integrator.getFriction()._value == 0.25
            assert integrator.getTemperature()._value == 77

    def test_integrator_defaults(self, folder):
        assert isinstance(folder.read().integrator(), mm.VerletIntegrator)
        integrator = folder.read(general="Integrator L").integrator()
        assert (integrator.getFriction()._value, integrator.getTemperature()._value) == (5, 310)

    @pytest.mark.parametrize("name", ["GJF", "GJF20", "Global", "LFLangevinMultiT"])
    def test_integrators_of_vcm_are_refused_by_name(self, folder, name):
        message = folder.refused(general=f"Integrator {name}")
        assert f"key Integrator: VCM's integrator {name} is not done here" in message

    @about("setVelocitiesToTemperature", "Seed")
    def test_velocities(self, folder):
        def first(text, **options):
            context = folder.read("NodeMass 20", text, **options).simulation("Reference").context
            return context.getState(getVelocities=True).getVelocities(asNumpy=True)._value

        assert not first("Seed 4").any()
        drawn = first("Seed 4\nsetVelocitiesToTemperature true")
        assert np.array_equal(drawn, first("Seed 4\nsetVelocitiesToTemperature true"))
        assert not np.array_equal(drawn, first("Seed 5\nsetVelocitiesToTemperature true"))
        other = first("Seed 4\nsetVelocitiesToTemperature true", seed=5)
        assert np.array_equal(other, first("Seed 5\nsetVelocitiesToTemperature true"))
        # 126 squares: the mean is within five standard deviations of kBT.
        assert 20 * (drawn**2).mean() == pytest.approx(KT, rel=5 * np.sqrt(2 / 126))

    def test_seed_reaches_the_integrator(self, folder):
        integrator = folder.read(general="Integrator LM\nSeed 4").integrator()
        assert integrator.getRandomNumberSeed() == 4

    def test_no_seed_draws_one(self, folder):
        seeds = {folder.read().seed for _ in range(3)}
        assert len(seeds) == 3
        assert min(seeds) > 0

    @about("EpsilonH")
    def test_epsilon(self, folder, moved):
        for general, factor in (("EpsilonH 3", 3), ("", 4)):
            cfg = folder.read("SurfaceConstraint WCAH 1.5", general)
            expected = moved.energy(TriangleHeightForce(moved, 1.5, factor * KT))
            assert expected > 1
            assert energies(cfg, moved.vertices) == {"heights": pytest.approx(expected)}
        assert folder.read("SurfaceConstraint WCAH 1.5", "EpsilonH 0").terms == {}

    @about("Minimise", "MinimiseTolerance", "MinimiseMaxIterations")
    def test_minimise(self, folder):
        text = "SpringCoeff 100\nNominalLengthInNm Av"

        def start(general):
            cfg = folder.read(text, general)
            return cfg.energies(cfg.simulation("Reference").context)["springs"]

        before = start("")
        assert before > 1
        full = start("Minimise true\nMinimiseTolerance 0.01")
        assert start("Minimise true\nMinimiseTolerance 1000") > full
        assert full < before
        assert full < start("Minimise true\nMinimiseTolerance 0.01\nMinimiseMaxIterations 1")

    @about("MCBarostatPressure", "MCBarostatTemperature", "MCBarostatFrequency")
    @about("SimulationBoxLength")
    def test_barostat(self, folder):
        box = "SimulationBoxLength 40\nMCBarostatPressure 2\n"

        def made(general):
            system = folder.read("NodeRadius 0.1", general, table="M LJ").system()
            assert system.getDefaultPeriodicBoxVectors()[0][0]._value == 40
            assert system.usesPeriodicBoundaryConditions()
            (found,) = (f for f in system.getForces() if isinstance(f, mm.MonteCarloBarostat))
            pressure = found.getDefaultPressure()._value
            return pressure, found.getDefaultTemperature()._value, found.getFrequency()

        assert made(box) == (2, 310, 25)
        assert made(box + "MCBarostatTemperature 280\nMCBarostatFrequency 7") == (2, 280, 7)
        cfg = folder.read("NodeRadius 0.1", box, table="M LJ")
        cfg.simulation("Reference").step(30)

    def test_no_box(self, folder):
        system = folder.read("NodeRadius 0.1", table="M LJ").system()
        assert not system.usesPeriodicBoundaryConditions()

    @about("MCAnisoBarostatPressure", "MCAnisoBarostatTemperature", "MCAnisoBarostatFrequency")
    def test_anisotropic_barostat(self, folder):
        general = (
            "SimulationBoxLength 40\nMCAnisoBarostatPressure 1 0 3\n"
            "MCAnisoBarostatTemperature 280\nMCAnisoBarostatFrequency 7"
        )
        system = folder.read("NodeRadius 0.1", general, table="M LJ").system()
        kind = mm.MonteCarloAnisotropicBarostat
        (found,) = (f for f in system.getForces() if isinstance(f, kind))
        assert list(found.getDefaultPressure()._value) == [1, 0, 3]
        assert (found.getDefaultTemperature()._value, found.getFrequency()) == (280, 7)
        assert (found.getScaleX(), found.getScaleY(), found.getScaleZ()) == (True, False, True)

    @pytest.mark.parametrize("key", ["MCBarostatPressure", "MCAnisoBarostatPressure"])
    def test_barostat_needs_a_box_and_what_sees_it(self, folder, key):
        message = folder.refused(general=f"{key} 1")
        assert f"key {key}: a barostat needs a periodic box; give SimulationBoxLength" in message
        message = folder.refused(general=f"{key} 1\nSimulationBoxLength 40")
        assert f"key {key}: a barostat needs potentials that see the periodic box" in message

    @about("CMMotionRemoverStep")
    def test_motion_remover(self, folder):
        system = folder.read(general="CMMotionRemoverStep 3").system()
        (found,) = system.getForces()
        assert isinstance(found, mm.CMMotionRemover)
        assert found.getFrequency() == 3
        assert folder.read().system().getNumForces() == 0

    @about("MinimumForceDecleration")
    def test_minimum_force_decleration(self, folder):
        folder.read(general="MinimumForceDecleration false")
        message = folder.refused(general="MinimumForceDecleration true 5")
        assert "config.txt:2: key MinimumForceDecleration: VCM's optimisation is not" in message
        assert "set it to false" in message

    @about("Precision")
    def test_precision(self, folder):
        assert folder.read().general["Precision"] == "single"
        assert folder.read(general="Precision double").general["Precision"] == "double"
        # Platforms without the property take no notice.
        folder.read(general="Precision mixed").simulation("Reference")

    # Their effects are on files, in test_cli_run.py.
    @about("ReportIntervalInFs", "TextOutputs", "BinOutputs", "ReportEnergy")
    def test_outputs(self, folder):
        cfg = folder.read()
        assert cfg.general["TextOutputs"] == {"PSF", "XYZ"}
        assert cfg.general["BinOutputs"] == set()
        assert cfg.general["ReportEnergy"] is True
        assert cfg.general["ReportIntervalInFs"] == (1000, 0, 0)
        general = "TextOutputs VEL CURVE\nBinOutputs TPK\nReportEnergy false"
        cfg = folder.read(general=general)
        assert cfg.general["TextOutputs"] == {"VEL", "CURVE"}
        assert cfg.general["BinOutputs"] == {"TPK"}
        assert cfg.general["ReportEnergy"] is False
        assert folder.read(general="TextOutputs N").general["TextOutputs"] == set()

    @about("bondCutoff")
    def test_bond_cutoff(self, folder):
        text = "NodeRadius 0.8"
        full = energies(folder.read(text, table="M WCA"))["WCA"]
        assert full > 0.01
        cut = folder.read(text, "bondCutoff 1", table="M WCA")
        system = cut.system()
        (force,) = system.getForces()
        pairs = {tuple(sorted(force.getExclusionParticles(i))) for i in range(120)}
        assert force.getNumExclusions() == 120
        assert pairs == {tuple(edge) for edge in cut.meshes[0].edges.tolist()}
        assert energies(cut)["WCA"] < full


class TestStart:
    @about("MeshFile")
    def test_mesh(self, folder, lumpy):
        cfg = folder.read()
        assert cfg.meshes == (lumpy,)
        assert np.array_equal(cfg.positions, lumpy.vertices)
        assert cfg.membranes[0].num_reversed == 0

    @pytest.mark.parametrize("extension", ["obj", "msh"])
    def test_other_formats(self, folder, lumpy, extension):
        lumpy.write(folder.path / f"other.{extension}")
        path = folder.write(f"-Membrane 0\nMeshFile other.{extension}\n")
        assert np.allclose(vcm.read(path).positions, lumpy.vertices)

    def test_mesh_is_mended(self, folder, lumpy):
        from openmmhelfrich._mesh import ply

        triangles = lumpy.triangles.copy()
        triangles[::3] = triangles[::3, ::-1]
        # Turning the corners round does not turn the triangle over.
        triangles[1] = np.roll(triangles[1], 1)
        (folder.path / "mesh.ply").write_bytes(ply.write(lumpy.vertices, triangles))
        cfg = folder.read()
        assert cfg.meshes[0].volume == pytest.approx(lumpy.volume, rel=1e-14)
        assert cfg.membranes[0].num_reversed == len(triangles[::3])

    def test_missing_mesh(self, folder):
        text = "-Membrane 0\nNodeMass 3\nMeshFile nowhere.ply\n"
        message = folder.message(text)
        assert message.startswith("config.txt:3: key MeshFile: ")
        assert "nowhere.ply" in message

    def test_no_mesh(self, folder):
        message = folder.message("-Membrane 0\nNodeMass 3\n")
        assert "config.txt:1: key MeshFile (not given, default none): a membrane needs" in message

    def test_broken_mesh(self, folder):
        (folder.path / "broken.ply").write_text("ply\nformat ascii 1.0\n")
        message = folder.message("-Membrane 0\nMeshFile broken.ply\n")
        assert message.startswith("config.txt:2: key MeshFile: Mesh.read: broken.ply, line ")

    def test_mesh_of_another_format(self, folder):
        message = folder.message("-Membrane 0\nMeshFile mesh.xyz\n")
        assert "key MeshFile: expected a .ply, .msh or .obj file, got 'mesh.xyz'" in message

    def test_mesh_in_a_periodic_box(self, folder, lumpy):
        """VCM's membranes know no box; cut open at its faces they would be other surfaces."""
        box = 3 * np.ptp(lumpy.vertices) * np.eye(3)
        Mesh(lumpy.vertices, lumpy.triangles, box).write(folder.path / "mesh.ply")
        message = folder.refused()
        assert message.startswith("config.txt:4: key MeshFile: mesh.ply has a periodic box")
        Mesh(*Mesh.read(folder.path / "mesh.ply").unfolded()).write(folder.path / "mesh.ply")
        assert folder.read().meshes[0].volume == pytest.approx(lumpy.volume, rel=1e-12)

    @about("NodeMass", "FreezeSubLattice")
    def test_mass(self, folder):
        def masses(text):
            system = folder.read(text).system()
            return {system.getParticleMass(i)._value for i in range(SIZE)}

        assert masses("") == {1}
        assert masses("NodeMass 50") == {50}
        assert masses("NodeMass 50\nFreezeSubLattice true") == {0}

    @about("Scale", "XYZscale", "CoordinateTranslateVector")
    def test_transformations(self, folder, lumpy):
        text = "CoordinateTranslateVector 1 2 3\nXYZscale 1 0.5 3\nScale 10"
        expected = lumpy.vertices * 10 * [1, 0.5, 3] + [1, 2, 3]
        assert np.allclose(folder.read(text).positions, expected, rtol=1e-15)

    @about("VelocityShiftVector")
    def test_velocity_shift(self, folder):
        text = "-Membrane B x 0\nVelocityShiftVector 0 0 0\n"
        cfg = folder.read("VelocityShiftVector 1 -2 0.5", more=text)
        state = cfg.simulation("Reference").context.getState(getVelocities=True)
        velocities = state.getVelocities(asNumpy=True)._value
        assert (velocities[:SIZE] == [1, -2, 0.5]).all()
        assert not velocities[SIZE:].any()

    @about("InitRandomRotation")
    def test_rotation(self, folder, lumpy):
        def positions(seed):
            return folder.read("InitRandomRotation true", seed=seed).positions

        rotated = positions(8)
        assert np.array_equal(rotated, positions(8))
        assert not np.allclose(rotated, positions(9))
        assert not np.allclose(rotated, lumpy.vertices)
        assert np.allclose(rotated @ rotated.T, lumpy.vertices @ lumpy.vertices.T)

    @about("XYZinMembrane")
    def test_point_inside_does_not_matter(self, folder, lumpy):
        assert folder.read("XYZinMembrane 100 0 0").meshes == (lumpy,)

    @about("ULM")
    def test_deformation(self, folder, lumpy):
        expected = lumpy.scaled(2).deformed(3, -2, 0.1)
        assert folder.read("ULM 0.1 3 -2\nScale 2").meshes == (expected,)
        message = folder.refused("ULM 50 2 0")
        assert "config.txt:5: key ULM: Mesh.deformed: amplitude 50" in message

    @about("NUL")
    def test_random_deformation(self, folder, lumpy):
        def ratio(text, seed=3):
            moved = np.linalg.norm(folder.read(text, seed=seed).positions, axis=1)
            return moved / np.linalg.norm(lumpy.vertices, axis=1)

        one = ratio("NUL 1 0.01 2")
        assert np.array_equal(one, ratio("NUL 1 0.01 2"))
        # One harmonic of degree 2, of this amplitude: five of them span all.
        from openmmhelfrich.analysis import real_harmonics

        directions = lumpy.vertices / np.linalg.norm(lumpy.vertices, axis=1)[:, None]
        candidates = real_harmonics(directions, 2)[:, 4:9].T
        assert min(np.abs(one - 1 - 0.01 * y).max() for y in candidates) < 1e-12
        assert not np.allclose(ratio("NUL 5 0.01 4"), one)
        assert np.allclose(ratio("NUL 0 0.01 4"), 1)
        assert "key NUL: Mesh.deformed" in folder.refused("NUL 1 90 2")


class TestSprings:
    def expected(self, mesh, lengths, stiffness):
        return (0.5 * stiffness * (edge_lengths(mesh) - lengths) ** 2).sum()

    @about("SpringModel", "SpringCoeff", "NominalLengthInNm")
    def test_harmonic(self, folder, lumpy, moved):
        own = edge_lengths(lumpy)
        for text, lengths in (
            ("", own.mean()),
            ("NominalLengthInNm Av", own.mean()),
            ("NominalLengthInNm Au", own),
            ("NominalLengthInNm 1.25", 1.25),
        ):
            for model in ("SpringModel H\n", ""):
                cfg = folder.read(f"{model}SpringCoeff 7\n{text}")
                expected = self.expected(moved, lengths, 7)
                assert energies(cfg, moved.vertices) == {"springs": pytest.approx(expected)}

    @pytest.mark.parametrize("text", ["SpringModel N\nSpringCoeff 7", "SpringCoeff 0", ""])
    def test_none(self, folder, text):
        assert folder.read(text).terms == {}

    @pytest.mark.parametrize("name", ["KG", "G", "A"])
    def test_models_without_a_formula_are_refused_by_name(self, folder, name):
        message = folder.refused(f"SpringCoeff 7\nSpringModel {name}")
        assert f"config.txt:6: key SpringModel: {name} is not done here: its formula" in message
        assert folder.read(f"SpringCoeff 0\nSpringModel {name}").terms == {}


DIHEDRALS = {
    "cosine": "Cosine",
    "smoothTheta4": "Quartic",
    "exp": "Exp",
    "smoothExp": "SmoothExp",
    "smoothExp46": "SmoothExp46",
}


class TestDihedrals:
    @about("DihedralBendingModel", "DihedralBendingCoeff")
    @pytest.mark.parametrize("name", DIHEDRALS)
    def test_forms(self, folder, moved, name):
        cfg = folder.read(f"DihedralBendingModel {name}\nDihedralBendingCoeff 6")
        expected = moved.energy(DihedralForce(moved, 6, getattr(DihedralForce, DIHEDRALS[name])))
        assert energies(cfg, moved.vertices) == {"dihedrals": pytest.approx(expected, rel=1e-12)}

    def test_default_is_cosine(self, folder, moved):
        expected = moved.energy(DihedralForce(moved, 6, DihedralForce.Cosine))
        found = energies(folder.read("DihedralBendingCoeff 6"), moved.vertices)
        assert found == {"dihedrals": pytest.approx(expected, rel=1e-12)}

    @pytest.mark.parametrize("text", ["DihedralBendingModel N\nDihedralBendingCoeff 6", ""])
    def test_none(self, folder, text):
        assert folder.read(text).terms == {}

    @about("SpontaneousTriangleBendingAngleInDegrees")
    @pytest.mark.parametrize("name", DIHEDRALS)
    def test_angle_near_flat_agrees_with_flat(self, folder, moved, name):
        """Another implementation, which must tend to the force of the package."""
        text = f"DihedralBendingModel {name}\nDihedralBendingCoeff 6\n"
        angle = "SpontaneousTriangleBendingAngleInDegrees"
        flat = folder.read(f"{text}{angle} 180")
        near = folder.read(f"{text}{angle} 179.9999999")
        (energy,) = energies(flat, moved.vertices).values()
        assert energies(near, moved.vertices)["dihedrals"] == pytest.approx(energy, rel=1e-6)
        assert forces(near, moved.vertices) == pytest.approx(
            forces(flat, moved.vertices), abs=1e-6 * np.abs(forces(flat, moved.vertices)).max()
        )

    def angles(self, mesh):
        """φ of each edge, positive if convex, by another formula than the package's."""
        normals = {}
        for row in mesh.triangles.tolist():
            a, b, c = mesh.vertices[row]
            normal = np.cross(b - a, c - a)
            for i in range(3):
                normals[row[i], row[i - 1]] = normal / np.linalg.norm(normal)
        found = []
        for a, b in mesh.edges.tolist():
            left, right = normals[b, a], normals[a, b]
            phi = np.arccos(np.clip(left @ right, -1, 1))
            along = mesh.vertices[b] - mesh.vertices[a]
            found.append(phi * np.sign(np.cross(left, right) @ along))
        return np.array(found)

    @pytest.mark.parametrize("angle", ["Au", "Av", "150"])
    def test_angle(self, folder, lumpy, moved, angle):
        cfg = folder.read(
            f"DihedralBendingCoeff 6\nSpontaneousTriangleBendingAngleInDegrees {angle}"
        )
        own = self.angles(lumpy)
        assert (own > 0).sum() > (own < 0).sum() > 0
        rest = {"Au": own, "Av": own.mean(), "150": np.deg2rad(30)}[angle]
        expected = 6 * (1 - np.cos(self.angles(moved) - rest)).sum()
        assert energies(cfg, moved.vertices)["dihedrals"] == pytest.approx(expected, rel=1e-6)
        if angle == "Au":
            assert energies(cfg)["dihedrals"] == pytest.approx(0, abs=1e-10)


SCHEMES = {
    "Julicher1996": "Julicher",
    "Itzykson1986": "GompperKroll",
    "ItzyksonBarycentric": "GompperKrollBarycentric",
    "JulicherVoronoi": "JulicherVoronoi",
    "Espiru1987": "Espriu",
}


class TestCurvature:
    @about("MeanCurvatureModel", "MeanCurvatureCoeff", "MeanspontaneousCurvature")
    @pytest.mark.parametrize("name", SCHEMES)
    def test_models(self, folder, moved, name):
        scheme = getattr(BendingForce, SCHEMES[name])
        text = f"MeanCurvatureModel {name}\nMeanCurvatureCoeff 50\n"
        plain = moved.energy(BendingForce(moved, 50, 0, scheme))
        assert energies(folder.read(text), moved.vertices) == {
            "bending": pytest.approx(plain, rel=1e-12)
        }
        cfg = folder.read(text + "MeanspontaneousCurvature 0.3")
        curved = moved.energy(BendingForce(moved, 50, 0.3, scheme))
        assert energies(cfg, moved.vertices)["bending"] == pytest.approx(curved, rel=1e-12)

    @pytest.mark.parametrize(
        "text", ["MeanCurvatureCoeff 50", "MeanCurvatureModel Julicher1996", "MeanCurvatureModel N"]
    )
    def test_none(self, folder, text):
        assert folder.read(text).terms == {}


class TestSurface:
    @about("SurfaceConstraint", "SurfaceConstraintCoeff")
    @about("SurfaceConstraintValue", "SurfaceConstraintRatio")
    @pytest.mark.parametrize(
        ("model", "terms"),
        [
            ("N", []),
            ("G", ["area"]),
            ("L", ["area"]),
            ("GWCAH 1.5", ["area", "heights"]),
            ("LWCAH 1.5", ["area", "heights"]),
            ("WCAH 1.5", ["heights"]),
            ("GWCA 2.5", ["area", "triangle areas"]),
            ("WCA 2.5", ["triangle areas"]),
        ],
    )
    def test_models(self, folder, lumpy, moved, model, terms):
        a, b, c = (lumpy.vertices[corner] for corner in lumpy.triangles.T)
        own = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        for value, total, each in (
            ("", lumpy.area, own),
            ("SurfaceConstraintValue Au\nSurfaceConstraintRatio 0.9", 0.9 * lumpy.area, 0.9 * own),
            ("SurfaceConstraintValue 4\nSurfaceConstraintRatio 0.9", 3.6, 3.6),
        ):
            cfg = folder.read(f"SurfaceConstraint {model}\nSurfaceConstraintCoeff 1.3\n{value}")
            area = (
                TriangleAreaForce(moved, 1.3, each)
                if model.startswith("L")
                else SurfaceAreaForce(moved, 1.3, total)
            )
            makers = {
                "area": area,
                "heights": TriangleHeightForce(moved, 1.5, 4 * KT),
                "triangle areas": TriangleAreaRepulsionForce(moved, 2.5, 4 * KT),
            }
            expected = {term: pytest.approx(moved.energy(makers[term])) for term in terms}
            assert energies(cfg, moved.vertices) == expected
            assert all(energy > 1e-3 for energy in energies(cfg, moved.vertices).values())

    def test_no_coefficient_leaves_the_heights(self, folder):
        assert list(folder.read("SurfaceConstraint GWCAH 1.5").terms) == ["heights"]

    @pytest.mark.parametrize("word", ["GWCAH", "LWCAH", "WCAH", "GWCA", "WCA"])
    def test_number_is_needed(self, folder, word):
        message = folder.refused(f"SurfaceConstraint {word}")
        assert f"config.txt:5: key SurfaceConstraint: {word} needs a least" in message

    def test_number_is_not_allowed(self, folder):
        assert "expected 1 value, got 'G 20'" in folder.refused("SurfaceConstraint G 20")


class TestVolume:
    @about("VolumeConstraint", "VolumeConstraintCoeff")
    @about("VolumeConstraintValue", "VolumeConstraintRatio")
    def test_global(self, folder, lumpy, moved):
        for value, target in (
            ("", lumpy.volume),
            ("VolumeConstraintValue Au\nVolumeConstraintRatio 0.8", 0.8 * lumpy.volume),
            ("VolumeConstraintValue 90\nVolumeConstraintRatio 0.8", 72),
        ):
            cfg = folder.read(f"VolumeConstraint G\nVolumeConstraintCoeff 0.04\n{value}")
            expected = moved.energy(EnclosedVolumeForce(moved, 0.04, target))
            assert energies(cfg, moved.vertices) == {"volume": pytest.approx(expected)}

    @pytest.mark.parametrize("text", ["VolumeConstraint G", "VolumeConstraintCoeff 0.04"])
    def test_none(self, folder, text):
        assert folder.read(text).terms == {}


class TestLockOn:
    @about("LockOnPotential", "LockOnRigidity", "LockOnCoordinate")
    def test_sphere(self, folder, moved):
        cfg = folder.read("LockOnPotential Sphere\nLockOnRigidity 5\nLockOnCoordinate 3")
        expected = (2.5 * (np.linalg.norm(moved.vertices, axis=1) - 3) ** 2).sum()
        assert energies(cfg, moved.vertices) == {"lock-on": pytest.approx(expected)}

    def test_mode(self, folder, moved):
        cfg = folder.read("LockOnPotential ULM2_0 0.2\nLockOnRigidity 5\nLockOnCoordinate 3")
        sphere = moved.vertices / np.linalg.norm(moved.vertices, axis=1)[:, None] * 3
        surface = Mesh(sphere, moved.triangles).deformed(2, 0, 0.2).vertices
        assert energies(cfg, surface) == {"lock-on": pytest.approx(0, abs=1e-12)}
        expected = 2.5 * 0.5**2 * SIZE
        further = surface * (1 + 0.5 / np.linalg.norm(surface, axis=1))[:, None]
        assert energies(cfg, further) == {"lock-on": pytest.approx(expected)}

    def test_ellipsoid_is_refused(self, folder):
        message = folder.refused("LockOnPotential Ellipsoid\nLockOnRigidity 5\nLockOnCoordinate 3")
        assert "config.txt:5: key LockOnPotential: Ellipsoid is not done here" in message

    def test_radius_is_needed(self, folder):
        message = folder.refused("LockOnPotential Sphere\nLockOnRigidity 5")
        assert "key LockOnCoordinate (not given, default 0): Sphere needs a radius" in message

    def test_none(self, folder):
        assert folder.read("LockOnPotential Ellipsoid").terms == {}
        assert folder.read("LockOnRigidity 5").terms == {}


class TestSticky:
    @about("Sticky")
    def test_bonds(self, folder, lumpy):
        other = Mesh.icosphere(1, 1.0)
        vertices = other.vertices.copy()
        vertices[3], vertices[7] = lumpy.vertices[11], lumpy.vertices[40] + 5e-9
        vertices[5] = lumpy.vertices[20] + 5e-8
        Mesh(vertices, other.triangles).write(folder.path / "other.ply")
        text = folder.text(
            "Scale 10", more="-Membrane 1\nMeshFile other.ply\nScale 10\nSticky true"
        )
        # Distances count after the scaling: 5e-8 nm there, far too much.
        system = vcm.read(folder.write(text)).system()
        assert system.getForce(0).getNumBonds() == 1
        text = text.replace("Scale 10", "Scale 0.1")
        cfg = vcm.read(folder.write(text))
        system = cfg.system()
        force = system.getForce(0)
        bonds = [force.getBondParameters(i) for i in range(force.getNumBonds())]
        assert [bond[:2] for bond in bonds] == [[SIZE + 3, 11], [SIZE + 5, 20], [SIZE + 7, 40]]
        assert {bond[2]._value for bond in bonds} == {0}
        assert [bond[3]._value for bond in bonds] == pytest.approx([100 * KT] * 3)
        assert list(cfg.terms) == ["sticky 1"]

    def test_two_sticky_membranes_share_their_bonds(self, folder):
        cfg = folder.read("Sticky true", more="-Membrane B x 0")
        system = cfg.system()
        assert sum(force.getNumBonds() for force in system.getForces()) == SIZE

    def test_nothing_to_stick_to(self, folder):
        message = folder.refused("Sticky true")
        assert "config.txt:5: key Sticky: no vertex of membrane 0 lies within 1e-08 nm" in message


# Energy as a function of σ and r, cutoff in units of σ, and σ in units of the sum of the radii.
POTENTIALS = {
    "LJ": (lambda s, r: 4 * KT * (s**12 / r**12 - s**6 / r**6), 3, 1),
    "EV": (lambda s, r: 100 * (s**12 / r**12 - s**6 / r**6 + 0.25), 2 ** (1 / 6), 0.5),
    "WCA": (lambda s, r: 4 * KT * (s**12 / r**12 - s**6 / r**6 + 0.25), 2 ** (1 / 6), 1),
}


class TestInteractions:
    """Two small spheres: energies against sums over all pairs."""

    def pairs(self, positions, first, second):
        i, j = np.meshgrid(first, second, indexing="ij")
        keep = (i < j) if first == second else np.ones_like(i, dtype=bool)
        return i[keep], j[keep], np.linalg.norm(positions[i[keep]] - positions[j[keep]], axis=1)

    @about("NodeRadius")
    @pytest.mark.parametrize("radius", ["Av", "Au", "0.8"])
    @pytest.mark.parametrize("word", POTENTIALS)
    def test_potentials(self, folder, lumpy, word, radius):
        text = "CoordinateTranslateVector 1.3 0.2 0\nScale 1.1"
        cfg = folder.read(
            f"NodeRadius {radius}", more=f"-Membrane B x 0\n{text}", table=f"A {word}\nB {word} 0"
        )
        a, b = cfg.membranes
        radii = []
        for mesh in cfg.meshes:
            lengths = edge_lengths(mesh)
            own = [lengths[(mesh.edges == i).any(axis=1)].mean() / 2 for i in range(SIZE)]
            by_word = {"Av": [lengths.mean() / 2] * SIZE, "Au": own, "0.8": [0.8] * SIZE}
            radii += by_word[radius]
        radii = np.array(radii)
        energy, reach, factor = POTENTIALS[word]
        expected = 0.0
        for first, second in ((a, a), (a, b)):
            i, j, r = self.pairs(cfg.positions, first.particles, second.particles)
            sigma = factor * (radii[i] + radii[j])
            expected += np.where(r < reach * sigma, energy(sigma, r), 0).sum()
        assert abs(expected) > 1
        assert energies(cfg) == {word: pytest.approx(expected, rel=1e-10)}

    def test_wcafc_is_wca_far_out_and_straight_inside(self, folder):
        text = "-Membrane B x 0\nCoordinateTranslateVector 1.3 0.2 0"
        cfg = folder.read("NodeRadius 0.5", more=text, table="A 0\nB WCAFC 0")
        a, b = cfg.membranes
        _, _, r = self.pairs(cfg.positions, a.particles, b.particles)
        wca, reach, _ = POTENTIALS["WCA"]
        cap, h = 1 / 1.48, 1e-6
        slope = (wca(1, cap + h) - wca(1, cap - h)) / (2 * h)
        expected = np.where(r < reach, wca(1, np.maximum(r, cap)), 0)
        expected = expected + np.where(r < cap, slope * (r - cap), 0)
        assert (r < cap).sum() > 3
        assert energies(cfg)["WCAFC"] == pytest.approx(expected.sum(), rel=1e-6)

    @about("LJepsilon", "LJsigma")
    def test_lj_parameters(self, folder):
        text = "NodeRadius 0.8\nLJepsilon 1.5\nLJsigma 0.9"
        cfg = folder.read(text, table="A LJ")
        (members,) = (membrane.particles for membrane in cfg.membranes)
        _, _, r = self.pairs(cfg.positions, members, members)
        terms = 4 * 1.5 * ((1.8 / r) ** 12 - (1.8 / r) ** 6)
        expected = np.where(r < 5.4, terms, 0).sum()
        assert energies(cfg)["LJ"] == pytest.approx(expected, rel=1e-10)
        # Other kinds do not know them.
        plain = energies(folder.read("NodeRadius 0.8", table="A WCA"))
        assert energies(folder.read(text, table="A WCA")) == plain

    def test_self_interaction_is_its_own_entry(self, folder):
        cfg = folder.read("NodeRadius 0.8", more="-Membrane B x 0\nScale 9", table="A 0\nB 0 0")
        assert cfg.terms == {}


# The words of a key that must be refused, and what the message must say.
BAD = [
    ("general", "SimulationTimeInPs", "-1", "expected 0 or more, got -1"),
    ("general", "SimulationTimeInPs", "long", "expected a number, got 'long'"),
    ("general", "SimulationTimeInPs", "nan", "expected a finite number, got 'nan'"),
    ("general", "SimulationTimeInPs", "10 ps", "expected 1 value, got '10 ps'"),
    ("general", "SimulationTimeInPs", "", "expected 1 value, got none"),
    ("general", "StepSizeInFs", "0", "expected more than 0, got 0"),
    ("general", "ReportIntervalInFs", "EXP", "expected 1 value, got none"),
    ("general", "ReportIntervalInFs", "EXP 1", "a factor above 1, got '1'"),
    ("general", "ReportIntervalInFs", "EXP Step 0", "expected 1 or more, got 0"),
    ("general", "Integrator", "Vv", "there is no 'Vv'; did you mean V?"),
    ("general", "setVelocitiesToTemperature", "yes", "expected true or false, got 'yes'"),
    ("general", "Seed", "1.5", "expected an integer, got '1.5'"),
    ("general", "MCAnisoBarostatPressure", "1 2", "expected 1 or 3 values, got '1 2'"),
    ("general", "MinimumForceDecleration", "flase", "did you mean false?"),
    ("general", "TextOutputs", "XYX", "there is no output 'XYX'; did you mean XYZ?"),
    ("general", "TextOutputs", "", "known are PSF, XYZ"),
    ("general", "BinOutputs", "PSF", "there is no output 'PSF'"),
    ("general", "Precision", "doubel", "did you mean double?"),
    ("membrane", "NodeMass", "0", "expected more than 0, got 0"),
    ("membrane", "NodeRadius", "Ab", "expected a number or Av or Au, got 'Ab'"),
    ("membrane", "Scale", "0", "expected more than 0"),
    ("membrane", "XYZscale", "1 1", "expected 3 values, got '1 1'"),
    ("membrane", "XYZscale", "1 0 1", "expected numbers other than 0"),
    ("membrane", "SpringModel", "HH", "there is no 'HH'; did you mean H?"),
    ("membrane", "SpringCoeff", "-1", "expected 0 or more"),
    ("membrane", "DihedralBendingModel", "cosinus", "did you mean cosine?"),
    ("membrane", "MeanCurvatureModel", "Espriu1987", "did you mean Espiru1987?"),
    ("membrane", "MeanspontaneousCurvature", "inf", "expected a finite number, got 'inf'"),
    ("membrane", "SurfaceConstraint", "GWCAHH 20", "did you mean GWCAH?"),
    ("membrane", "SurfaceConstraint", "GWCAH 0", "expected more than 0"),
    ("membrane", "SurfaceConstraintValue", "Av", "expected a number or Au, got 'Av'"),
    ("membrane", "SurfaceConstraintRatio", "0", "expected more than 0"),
    ("membrane", "VolumeConstraint", "L", "there is no 'L'"),
    ("membrane", "VolumeConstraintValue", "0", "expected more than 0"),
    ("membrane", "LockOnPotential", "Spere", "did you mean Sphere?"),
    ("membrane", "LockOnPotential", "ULM2_0", "expected 2 values, got 'ULM2_0'"),
    ("membrane", "ULM", "0.1 2 3", "-l ≤ m ≤ l, got l 2, m 3"),
    ("membrane", "NUL", "1 0.1 1", "lmax from 2 to 1000"),
]


@pytest.mark.parametrize(("section", "key", "words", "fragment"), BAD)
def test_bad_value(folder, section, key, words, fragment):
    text = folder.text(**{section: f"{key} {words}"})
    message = folder.message(text)
    assert message.startswith(f"config.txt:{line_of(text, key)}: key {key}: ")
    assert fragment in message


def test_string_forces_agree_on_vcm_names():
    """The forms of the dihedrals are those of the oracle, name by name."""
    assert set(DIHEDRALS.values()) == set(string_forces.DIHEDRAL_FORMS)


def documented_keys():
    """The table of keys as docs/vcm.md shall have it."""
    lines = ["| section | key | default | meaning |", "| -- | -- | -- | -- |"]
    for key in vcm.KEYS:
        default = f"`{key.default}`" if key.default else "none"
        lines.append(f"| {key.section} | `{key.name}` | {default} | {key.doc} |")
    return "\n".join(lines)


def test_documentation_has_the_table():
    path = Path(__file__).resolve().parents[2] / "docs" / "vcm.md"
    text = path.read_text(encoding="utf-8")
    start = "<!-- keys: made from openmmhelfrich.vcm.KEYS -->\n"
    found = text.partition(start)[2].partition("\n<!-- end of keys -->")[0]
    assert found.strip("\n") == documented_keys()
