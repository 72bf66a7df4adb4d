"""The whole vesicle: the paper's numbers, several in one System, units, bad input, files."""

import copy
import gc
import subprocess
import sys
import weakref
from pathlib import Path

import numpy as np
import openmm
import openmmhelfrich as helfrich
import pytest
from openmm import unit
from openmmhelfrich import (
    BendingForce,
    EnclosedVolumeForce,
    SurfaceAreaForce,
    TriangleHeightForce,
)
from openmmhelfrich.mesh import Mesh
from openmmhelfrich.vesicle import KBT, Vesicle
from openmmhelfrich.wireframe import write_lammps_data, write_psf

TERMS = ("area", "volume", "bending", "heights")
NM = unit.nanometer
KJ = unit.kilojoule_per_mole


@pytest.fixture(scope="module")
def mesh():
    """Not a sphere, so that no term vanishes by symmetry."""
    sphere = Mesh.icosphere(5, 500)
    noise = np.random.default_rng(4).normal(scale=3, size=sphere.vertices.shape)
    return Mesh(sphere.vertices * [1.1, 1.0, 0.85] + noise, sphere.triangles)


def context_of(system, positions):
    integrator = openmm.VerletIntegrator(0.1)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(positions)
    return context


def test_who_holds_a_force_holds_its_system(mesh):
    """Forces are deleted with their System, which nobody else may hold."""
    system = openmm.System()
    placement = Vesicle(mesh, flips={"frequency": 7}).add_to(system)
    forces = [*placement.forces.values(), placement.flips]
    forces.append(helfrich.pull(system, [0], (1, 0, 0)))
    alive = weakref.ref(system)
    del system, placement
    gc.collect()
    assert alive() is not None
    assert forces[-2].getFrequency() == 7
    assert forces[-1].getNumParticles() == 1
    del forces
    gc.collect()
    assert alive() is None


def total_energy(context):
    return context.getState(getEnergy=True).getPotentialEnergy().value_in_unit(KJ)


class TestDefaults:
    def test_are_the_papers(self):
        mesh = Mesh.icosphere(10, 1000)
        v = Vesicle(mesh)
        assert pytest.approx(2.494, abs=5e-4) == KBT
        assert v.rigidity == pytest.approx(20 * 2.494339, rel=1e-6)
        assert v.epsilon == pytest.approx(4 * 2.494339, rel=1e-6)
        assert (v.area_modulus, v.volume_modulus) == (1.3, 0.04)
        assert (v.softness, v.mass, v.spontaneous_curvature) == (0.037, 50, 0)
        assert v.scheme == BendingForce.Julicher
        assert (v.area, v.volume) == (mesh.area, mesh.volume)
        # physics.md: d = 20 nm is Ξ = 0.037 for 1002 vertices on 1000 nm.
        assert v.min_height == pytest.approx(20.0, abs=0.05)
        # In the paper's units: 5.22e5 kBT/r0² and 1.6e7 kBT/r0³.
        assert v.area_modulus * 1000**2 / KBT == pytest.approx(5.22e5, rel=2e-3)
        assert v.volume_modulus * 1000**3 / KBT == pytest.approx(1.6e7, rel=5e-3)

    def test_time_scales_are_the_papers(self):
        v = Vesicle(Mesh.icosphere(10, 1000))
        # 11 460 ps for r0 = 1000 nm; the radius here is that of the mesh's area, 0.2 % less.
        assert v.tau_2 == pytest.approx(11_460, rel=3e-3)
        assert v.tau_heights == pytest.approx(45, rel=0.01)
        # targets.md: √Ξ τ_lmax is 10.8 ps.
        assert v.max_time_step == pytest.approx(1.08, rel=0.01)

    def test_reach_the_forces(self, mesh):
        v = Vesicle(
            mesh,
            rigidity=61,
            area_modulus=1.7,
            volume_modulus=0.03,
            softness=0.3,
            epsilon=7,
            mass=40,
            spontaneous_curvature=0.004,
            area=1.1e6,
            volume=2.2e8,
        )
        system = v.system()
        assert {system.getParticleMass(i)._value for i in range(system.getNumParticles())} == {40}
        forces = v.placement
        assert forces.bending.getRigidity() == 61
        assert forces.bending.getSpontaneousCurvature() == 0.004
        assert (forces.area.getModulus(), forces.area.getTarget()) == (1.7, 1.1e6)
        assert (forces.volume.getModulus(), forces.volume.getTarget()) == (0.03, 2.2e8)
        assert forces.heights.getMinHeight() == mesh.min_height(0.3)
        assert forces.heights.getEpsilon() == 7

    def test_reduced_volume(self, mesh):
        v = Vesicle(mesh, reduced_volume=0.6)
        assert v.reduced_volume == pytest.approx(0.6)
        assert v.volume == pytest.approx(0.6 * mesh.area**1.5 / (6 * np.pi**0.5))


class TestSystem:
    def test_has_four_named_forces_in_groups_of_their_own(self, mesh):
        system = Vesicle(mesh).system()
        assert system.getNumParticles() == mesh.num_vertices
        assert [force.getName() for force in system.getForces()] == list(TERMS)
        assert len({force.getForceGroup() for force in system.getForces()}) == 4
        classes = (SurfaceAreaForce, EnclosedVolumeForce, BendingForce, TriangleHeightForce)
        for force, cls in zip(system.getForces(), classes, strict=True):
            assert cls.isinstance(force)

    def test_energies_per_term_add_up_and_are_those_of_the_formulas(self, mesh):
        v = Vesicle(mesh, softness=0.5, area=0.98 * mesh.area, volume=1.03 * mesh.volume)
        simulation = v.simulation(openmm.VerletIntegrator(0.1), "Reference")
        energies = v.energies(simulation.context)
        assert tuple(energies) == TERMS
        assert sum(energies.values()) == pytest.approx(total_energy(simulation.context), rel=1e-12)
        area = 1.3 / 2 * (mesh.area - v.area) ** 2 / v.area
        volume = 0.04 / 2 * (mesh.volume - v.volume) ** 2 / v.volume
        assert energies["area"] == pytest.approx(area, rel=1e-9)
        assert energies["volume"] == pytest.approx(volume, rel=1e-9)
        assert energies["bending"] == pytest.approx(mesh.energy(v.placement.bending), rel=1e-12)
        assert energies["heights"] > 0

    def test_simulation_starts_from_the_mesh(self, mesh):
        simulation = Vesicle(mesh).simulation(openmm.VerletIntegrator(0.1), "Reference")
        state = simulation.context.getState(getPositions=True)
        np.testing.assert_array_equal(
            state.getPositions(asNumpy=True).value_in_unit(NM), mesh.vertices
        )
        assert simulation.topology.getNumBonds() == len(mesh.edges)
        assert simulation.context.getPlatform().getName() == "Reference"
        simulation.step(10)

    def test_outlives_the_vesicle_that_made_it(self, mesh):
        system = Vesicle(mesh).system()
        twin = copy.deepcopy(system)
        energy = total_energy(context_of(system, mesh.vertices))
        assert total_energy(context_of(twin, mesh.vertices)) == energy

    def test_energies_need_a_system(self, mesh):
        with pytest.raises(RuntimeError, match=r"^Vesicle: .* no System yet"):
            Vesicle(mesh).energies(None)


class TestSeveral:
    def test_two_in_one_system(self, mesh):
        system = openmm.System()
        # Particles that belong to no membrane come first and in between.
        system.addParticle(1.0)
        big = Vesicle(mesh)
        first = big.add_to(system)
        system.addParticle(1.0)
        small_mesh = mesh.scaled(0.5).translated([3000, 0, 0])
        small = Vesicle(small_mesh, rigidity=30, reduced_volume=0.7)
        second = small.add_to(system)
        assert (first.offset, second.offset) == (1, 2 + mesh.num_vertices)
        assert second.particles == range(second.offset, second.offset + mesh.num_vertices)
        groups = [f.getForceGroup() for p in (first, second) for f in p.forces.values()]
        assert sorted(groups) == list(range(8))

        lone = np.array([[9e3, 0.0, 0.0]])
        positions = np.concatenate([lone, mesh.vertices, lone, small_mesh.vertices])
        context = context_of(system, positions)
        for placement, vesicle in ((first, big), (second, small)):
            alone = Vesicle.energies(
                vesicle_alone := copy.copy(vesicle),
                context_of(vesicle_alone.system(), vesicle.mesh.vertices),
            )
            assert placement.energies(context) == pytest.approx(alone, rel=1e-9)

    def test_groups_of_other_forces_are_left_alone(self, mesh):
        system = openmm.System()
        other = openmm.CustomExternalForce("x")
        other.setForceGroup(2)
        system.addForce(other)
        placement = Vesicle(mesh).add_to(system)
        assert [f.getForceGroup() for f in placement.forces.values()] == [0, 1, 3, 4]

    def test_when_no_groups_are_left(self, mesh):
        system = openmm.System()
        for _ in range(8):
            Vesicle(mesh).add_to(system)
        with pytest.raises(ValueError, match=r"^Vesicle: .*force groups"):
            Vesicle(mesh).add_to(system)
        assert system.getNumParticles() == 8 * mesh.num_vertices
        Vesicle(mesh).add_to(system, force_groups=(0, 1, 2, 3))
        with pytest.raises(ValueError, match=r"^Vesicle: force_groups"):
            Vesicle(mesh).add_to(system, force_groups=(0, 1, 32, 3))


class TestUnits:
    def test_quantities_are_converted(self, mesh):
        kcal, um = unit.kilocalorie_per_mole, unit.micrometer
        plain = Vesicle(
            mesh,
            rigidity=41.84,
            area_modulus=1.3,
            volume_modulus=0.04,
            epsilon=4.184,
            mass=50,
            spontaneous_curvature=0.002,
            area=1.1e6,
            volume=2e8,
        )
        dressed = Vesicle(
            mesh,
            rigidity=10 * kcal,
            area_modulus=1.3 * KJ / NM**2,
            volume_modulus=0.04 * KJ / NM**3,
            epsilon=1 * kcal,
            mass=50 * unit.dalton,
            spontaneous_curvature=2 / um,
            area=1.1 * um**2,
            volume=0.2 * um**3,
        )
        for name in ("rigidity", "area_modulus", "volume_modulus", "epsilon", "mass"):
            assert getattr(dressed, name) == pytest.approx(getattr(plain, name), rel=1e-12)
        for name in ("spontaneous_curvature", "area", "volume", "min_height"):
            assert getattr(dressed, name) == pytest.approx(getattr(plain, name), rel=1e-12)

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            ("rigidity", 1 * NM),
            ("rigidity", 1 * KJ / NM),
            ("area_modulus", 1.3 * KJ),
            ("volume_modulus", 0.04 * KJ / NM**2),
            ("epsilon", 1 * unit.kelvin),
            ("mass", 1 * NM),
            ("spontaneous_curvature", 1 * NM),
            ("area", 1 * NM**3),
            ("volume", 1 * NM**2),
            ("softness", 1 * NM),
            ("rigidity", "stiff"),
            ("mass", [50, 50]),
        ],
    )
    def test_wrong_units_are_refused(self, mesh, name, value):
        with pytest.raises(TypeError, match=f"^Vesicle: {name} "):
            Vesicle(mesh, **{name: value})

    @pytest.mark.parametrize(
        "name",
        ["rigidity", "area_modulus", "volume_modulus", "softness", "epsilon", "mass", "area",
         "volume", "reduced_volume"],
    )  # fmt: skip
    @pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
    def test_wrong_numbers_are_refused(self, mesh, name, value):
        with pytest.raises(ValueError, match=f"^Vesicle: {name} "):
            Vesicle(mesh, **{name: value})

    @pytest.mark.parametrize("name", ["mass", "area", "volume", "reduced_volume"])
    def test_zero_where_it_makes_no_sense(self, mesh, name):
        with pytest.raises(ValueError, match=f"^Vesicle: {name} "):
            Vesicle(mesh, **{name: 0})

    def test_two_volumes_are_refused(self, mesh):
        with pytest.raises(ValueError, match="either volume or reduced_volume"):
            Vesicle(mesh, volume=1e8, reduced_volume=0.9)

    def test_nothing_can_be_set(self, mesh):
        with pytest.raises(AttributeError):
            Vesicle(mesh).rigidity = 3


class TestWireframe:
    def test_psf_has_every_vertex_and_edge(self, mesh, tmp_path):
        system, topology = Vesicle(mesh).system(), mesh.topology()
        write_psf(tmp_path / "mesh.psf", topology, system)
        # OpenMM's own reader of PSF wants force field types; the fixed columns are read by hand.
        lines = (tmp_path / "mesh.psf").read_text().splitlines()
        assert lines[0].split()[0] == "PSF"
        start = next(i for i, line in enumerate(lines) if "!NATOM" in line)
        assert int(lines[start][:8]) == mesh.num_vertices
        atoms = lines[start + 1 : start + 1 + mesh.num_vertices]
        assert [int(line[:8]) for line in atoms] == list(range(1, mesh.num_vertices + 1))
        assert {float(line.split()[7]) for line in atoms} == {50.0}
        start = next(i for i, line in enumerate(lines) if "!NBOND" in line)
        assert int(lines[start][:8]) == len(mesh.edges)
        text = "".join(lines[start + 1 : start + 1 + -(-len(mesh.edges) // 4)])
        numbers = [int(text[i : i + 8]) for i in range(0, len(text), 8)]
        np.testing.assert_array_equal(
            np.sort(np.sort(np.reshape(numbers, (-1, 2)) - 1, axis=1), axis=0),
            np.sort(mesh.edges, axis=0),
        )

    def test_lammps_data_has_every_vertex_and_edge_in_angstrom(self, mesh, tmp_path):
        system, topology = Vesicle(mesh).system(), mesh.topology()
        path = tmp_path / "mesh.data"
        write_lammps_data(path, topology, system, mesh.vertices * NM)
        text = path.read_text()
        atoms = text.split("Atoms # bond\n\n")[1].split("\n\nBonds")[0].splitlines()
        places = np.array([[float(x) for x in line.split()[3:]] for line in atoms])
        np.testing.assert_allclose(places, 10 * mesh.vertices, atol=6e-4)
        bonds = text.split("Bonds\n\n")[1].split()
        np.testing.assert_array_equal(np.reshape(bonds, (-1, 4)).astype(int)[:, 2:] - 1, mesh.edges)

    def test_mismatch_is_named(self, mesh, tmp_path):
        with pytest.raises(ValueError, match="252 atoms, but the System has 0"):
            write_psf(tmp_path / "mesh.psf", mesh.topology(), openmm.System())
        assert not (tmp_path / "mesh.psf").exists()


class TestEverythingElse:
    """The terms beyond the paper's four."""

    def test_optional_forces_are_off_by_default(self, mesh):
        assert list(Vesicle(mesh).add_to(openmm.System()).forces) == [
            "area",
            "volume",
            "bending",
            "heights",
        ]

    def test_optional_forces(self, mesh):
        system = openmm.System()
        placement = Vesicle(
            mesh,
            unsigned_spontaneous_curvature=True,
            dihedral_stiffness=3,
            dihedral_form=helfrich.DihedralForce.Cosine,
            triangle_area_modulus=2,
            plaquette_stiffness=4,
            min_triangle_area=0.1 * mesh.area / mesh.num_triangles,
        ).add_to(system)
        forces = placement.forces
        assert forces["bending"].getUnsignedSpontaneousCurvature()
        assert forces["dihedrals"].getStiffness() == 3
        assert forces["dihedrals"].getForm() == helfrich.DihedralForce.Cosine
        assert sum(forces["triangle_areas"].getTriangleTargets()) == pytest.approx(mesh.area)
        assert forces["plaquettes"].getTarget() == mesh.area
        assert forces["triangle_repulsion"].getEpsilon() == forces["heights"].getEpsilon()
        groups = [force.getForceGroup() for force in system.getForces()]
        assert sorted(groups) == list(range(8))
        integrator = openmm.VerletIntegrator(0.1)
        context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
        context.setPositions(mesh.vertices)
        energies = placement.energies(context)
        assert set(energies) == set(forces)
        # The mesh itself is the state of rest of its triangles.
        assert energies["triangle_areas"] == pytest.approx(0, abs=1e-9)
        assert energies["dihedrals"] > 0
        assert energies["plaquettes"] > 0

    def test_domains(self, mesh):
        stiff = np.where(mesh.vertices[:, 0] > 0, 60.0, 20.0)
        curved = np.where(mesh.vertices[:, 0] > 0, 0.001, 0.0)
        vesicle = Vesicle(
            mesh,
            rigidity=stiff * openmm.unit.kilojoule_per_mole,
            spontaneous_curvature=curved,
        )
        bending = vesicle.add_to(openmm.System()).bending
        np.testing.assert_array_equal(bending.getVertexRigidity(), stiff)
        np.testing.assert_array_equal(bending.getVertexSpontaneousCurvature(), curved)
        assert vesicle.tau_2 == pytest.approx(Vesicle(mesh, rigidity=stiff.mean()).tau_2)

    @pytest.mark.parametrize(
        ("values", "fragment"),
        [([1.0, 2.0], "one for each of the"), (-1.0, "rigidity"), (np.nan, "rigidity")],
    )
    def test_bad_domains_are_refused(self, mesh, values, fragment):
        given = values if isinstance(values, list) else np.full(mesh.num_vertices, values)
        with pytest.raises(ValueError, match=fragment):
            Vesicle(mesh, rigidity=given)

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            ("rigidity", True),
            ("rigidity", "stiff"),
            ("rigidity", [True, False]),
            ("rigidity", [[1.0], [1.0, 2.0]]),
            ("epsilon", np.True_),
            ("scheme", "Nobody"),
            ("scheme", 1.0),
            ("dihedral_form", 9),
        ],
    )
    def test_what_is_no_number_or_constant_is_refused_at_once(self, mesh, name, value):
        stiff = {"dihedral_stiffness": 1.0} if name == "dihedral_form" else {}
        with pytest.raises(
            (TypeError, ValueError, openmm.OpenMMException), match=r"Force:|Vesicle:"
        ):
            Vesicle(mesh, **stiff, **{name: value})

    def test_what_is_no_mesh_is_refused(self):
        with pytest.raises(TypeError, match="Vesicle: mesh needs a Mesh, got str"):
            Vesicle("sphere.ply")

    def test_two_vesicles_and_particles_example(self, tmp_path):
        script = Path(__file__).resolve().parents[2] / "examples" / "two_vesicles.py"
        command = [sys.executable, script, "--steps", "200", "--out", tmp_path]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr
        assert "soft vesicle" in result.stdout
        for name in ("soft", "hard"):
            assert helfrich.Mesh.read(tmp_path / f"{name}.ply").num_vertices > 100
