"""Whole configurations: the paper's six files, VCM's golden numbers, VCM's quirks."""

import warnings

import numpy as np
import openmm as mm
import pytest
from openmm import unit
from openmmhelfrich import Mesh, vcm
from published import GOLDEN_TERMS, KT
from vcm_files import SIZE, Folder, energies, forces

FILES = [
    "SM_AVh_GKB_L_nu0.6",
    "SM_AVh_GKB_V",
    "SM_AVh_V",
    "SM_Ah_GKB_L",
    "SM_RBC_C0",
    "SM_RBC_C0.006",
]


@pytest.fixture
def folder(tmp_path, lumpy):
    return Folder(tmp_path, lumpy)


def paper(shared, name, **options):
    with warnings.catch_warnings():
        # Two of the files have a broken comment.
        warnings.simplefilter("ignore", vcm.ConfigWarning)
        return vcm.read(shared / "vcm" / f"{name}.txt", **options)


class TestPaper:
    # Bending energies of physics.md, to the digits that it prints, kJ/mol.
    BENDING = (
        ("SM_AVh_GKB_L_nu0.6", "bending", 3742.431, 5e-4, {}),
        ("SM_AVh_GKB_V", "bending", 50 * 25.09523046, 50 * 5e-9, {}),
        ("SM_Ah_GKB_L", "bending", 50 * 25.09523046, 50 * 5e-9, {}),
        ("SM_RBC_C0", "bending 0", 8314.340, 5e-3, {}),
        ("SM_RBC_C0.006", "bending 0", 78465.07, 5e-3, {}),
        ("SM_RBC_C0.006", "bending 0", 78464.14, 5e-3, {"vcm_compatible": True}),
    )

    @pytest.mark.parametrize(("name", "term", "energy", "tolerance", "options"), BENDING)
    def test_bending_at_the_start(self, shared, name, term, energy, tolerance, options):
        found = energies(paper(shared, name, **options))
        assert found.pop(term) == pytest.approx(energy, abs=tolerance)
        # Everything else is at rest at the start.
        assert max(found.values()) < 1e-9

    TERMS = (
        ("SM_AVh_GKB_L_nu0.6", ["area", "volume", "bending", "heights"]),
        ("SM_AVh_GKB_V", ["area", "volume", "bending", "heights"]),
        ("SM_AVh_V", ["area", "volume", "heights"]),
        ("SM_Ah_GKB_L", ["area", "bending", "heights"]),
        *(
            (
                name,
                ["area 0", "volume 0", "bending 0", "heights 0", "springs 1", "sticky 1"],
            )
            for name in ("SM_RBC_C0", "SM_RBC_C0.006")
        ),
    )

    @pytest.mark.parametrize(("name", "terms"), TERMS)
    def test_terms(self, shared, name, terms):
        cfg = paper(shared, name)
        assert list(cfg.terms) == terms
        system = cfg.system()
        assert [force.getName() for force in system.getForces()] == terms
        assert [force.getForceGroup() for force in system.getForces()] == list(cfg.terms.values())
        assert len(set(cfg.terms.values())) == len(terms)
        masses = {system.getParticleMass(i)._value for i in range(cfg.num_particles)}
        assert masses == {50}

    @pytest.mark.parametrize(
        ("name", "area", "volume", "num_reversed"),
        [
            ("SM_AVh_GKB_L_nu0.6", 12466022, 2.497063e9, 1000),
            ("SM_AVh_GKB_V", 12528245, 4.1658149e9, 1000),
            ("SM_RBC_C0", 12417638, 2.4880208e9, 1000),
            ("SM_RBC_C0.006", None, None, 0),
        ],
    )
    def test_meshes(self, shared, name, area, volume, num_reversed):
        membrane = paper(shared, name).membranes[0]
        assert membrane.num_reversed == num_reversed
        if area:
            assert membrane.mesh.area == pytest.approx(area, abs=0.5)
            assert membrane.mesh.volume == pytest.approx(volume, rel=2e-8)

    @pytest.mark.parametrize(("name", "count"), [("SM_RBC_C0", 162), ("SM_RBC_C0.006", 92)])
    def test_every_elastic_vertex_sticks(self, shared, name, count):
        cfg = paper(shared, name)
        system = cfg.system()
        (sticky,) = (force for force in system.getForces() if force.getName() == "sticky 1")
        bonds = [sticky.getBondParameters(i) for i in range(sticky.getNumBonds())]
        assert [bond[0] for bond in bonds] == list(cfg.membranes[1].particles)
        assert all(bond[1] in cfg.membranes[0].particles for bond in bonds)
        assert {round(bond[3]._value, 1) for bond in bonds} == {249.4}

    @pytest.mark.parametrize("name", FILES)
    def test_runs_1000_steps(self, shared, name):
        cfg = paper(shared, name, seed=11)
        simulation = cfg.simulation("Reference")
        simulation.step(1000)
        state = simulation.context.getState(getEnergy=True, getPositions=True)
        kinetic = state.getKineticEnergy().value_in_unit(unit.kilojoule_per_mole)
        potential = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
        start = sum(energies(cfg).values())
        moving = 1.5 * cfg.num_particles * cfg.kT
        if name.endswith("_V"):
            # Without a thermostat the energy is what it was: that of the first velocities and the
            # start. Verlet's own error is of the order of a thousandth.
            first = cfg.simulation("Reference").context.getState(getEnergy=True)
            total = first.getKineticEnergy() + first.getPotentialEnergy()
            assert kinetic + potential == pytest.approx(total._value, rel=2e-3)
        else:
            # The thermostat has had two of its times of 100 ps; what the mesh's spare energy has
            # given or taken is less than a quarter.
            assert kinetic == pytest.approx(moving, rel=0.25)
        assert potential < start + moving
        # In 200 ps no vertex has travelled far, and the vesicle is whole.
        positions = state.getPositions(asNumpy=True)._value
        for membrane in cfg.membranes:
            rows = positions[membrane.offset : membrane.particles.stop]
            mesh = Mesh(rows, membrane.mesh.triangles)
            assert mesh.area == pytest.approx(membrane.mesh.area, rel=0.03)
            assert np.abs(rows - membrane.mesh.vertices).max() < 300


class TestGolden:
    """VCM's own energies and forces, from configurations that say what VCM was told."""

    @pytest.mark.parametrize("term", GOLDEN_TERMS, ids=str)
    def test_case(self, shared, tmp_path, term):
        data, membrane = term.data, term.membrane
        Mesh(membrane.positions, membrane.triangles).write(tmp_path / "golden.ply")
        path = tmp_path / "golden.txt"
        path.write_text(
            f"-GeneralParameters\nTemperatureinKelvin 300\nEpsilonH {data['eps_h_over_kBT']}\n"
            f"-Membrane 0\nMeshFile golden.ply\nMeanCurvatureModel {data['model']}\n"
            f"MeanCurvatureCoeff {data['kappa']}\nMeanspontaneousCurvature {data['C0'] or 0}\n"
            f"SurfaceConstraint GWCAH {data['d_h']}\nSurfaceConstraintCoeff {data['kA']}\n"
            f"SurfaceConstraintValue {data['A0']}\nVolumeConstraint G\n"
            f"VolumeConstraintCoeff {data['kV']}\nVolumeConstraintValue {data['V0']}\n"
        )
        cfg = vcm.read(path, vcm_compatible=True)
        assert cfg.kT == pytest.approx(KT, rel=1e-15)
        name = {"WCAH": "heights", "Area": "area", "Volume": "volume"}.get(term.term, "bending")
        group = {cfg.terms[name]}
        context = mm.Context(
            cfg.system(), mm.VerletIntegrator(1), mm.Platform.getPlatformByName("Reference")
        )
        context.setPositions(cfg.positions)
        state = context.getState(getEnergy=True, getForces=True, groups=group)
        assert state.getPotentialEnergy()._value == pytest.approx(
            term.energy, rel=term.tolerance, abs=1e-9
        )
        found = state.getForces(asNumpy=True)._value
        assert np.abs(found - term.forces).max() <= term.tolerance * np.abs(term.forces).max()


class TestQuirks:
    """Where `vcm_compatible` changes a number, and that it changes nothing else."""

    def both(self, folder, *arguments, positions=None, **more):
        found = [folder.read(*arguments, **more, vcm_compatible=on) for on in (False, True)]
        return [energies(cfg, positions) for cfg in found]

    def test_volume_ratio_counts_twice(self, folder, lumpy):
        text = "VolumeConstraint G\nVolumeConstraintCoeff 0.5\nVolumeConstraintRatio 0.9"
        volume = lumpy.volume
        expected = [0.25 * (volume - x * volume) ** 2 / (x * volume) for x in (0.9, 0.81)]
        found = self.both(folder, text)
        assert [e["volume"] for e in found] == pytest.approx(expected, rel=1e-6)
        plain, compatible = self.both(folder, f"{text}\nVolumeConstraintValue 90")
        assert plain["volume"] == pytest.approx(compatible["volume"], rel=1e-6)
        plain, compatible = self.both(
            folder, "SurfaceConstraint G\nSurfaceConstraintCoeff 1\nSurfaceConstraintRatio 0.9"
        )
        assert plain["area"] == pytest.approx(compatible["area"], rel=1e-6)

    def test_curvature_is_unsigned_in_one_model_and_absent_in_others(self, folder):
        text = "MeanCurvatureModel {}\nMeanCurvatureCoeff 5\nMeanspontaneousCurvature {}"
        inward, outward = (
            self.both(folder, text.format("ItzyksonBarycentric", c)) for c in (-0.4, 0.4)
        )
        assert outward[1]["bending"] < outward[0]["bending"]
        assert inward[1]["bending"] > inward[0]["bending"]
        plain, compatible = self.both(folder, text.format("Julicher1996", 0.4))
        flat = energies(folder.read(text.format("Julicher1996", 0)))
        assert compatible == flat
        assert abs(plain["bending"] - flat["bending"]) > 1

    def test_six_decimals(self, folder):
        text = "SurfaceConstraint G\nSurfaceConstraintCoeff 0.0000016\nSurfaceConstraintRatio 0.5"
        plain, compatible = self.both(folder, text)
        assert compatible["area"] == pytest.approx(plain["area"] * 2 / 1.6, rel=1e-6)
        text = text.replace("0.0000016", "0.0000004")
        assert folder.read(text).terms == {"area": 0}
        assert folder.read(text, vcm_compatible=True).terms == {}

    def test_boltzmann(self, folder):
        plain, compatible = (folder.read(vcm_compatible=on).kT for on in (False, True))
        assert plain == pytest.approx(310 * 8.31446261815324e-3, rel=1e-15)
        assert compatible == pytest.approx(310 * 0.008314459920816468, rel=1e-15)

    def test_area_repulsion_is_cut_at_half_the_area(self, folder, lumpy):
        """GWCA alone: WCA has no such jump."""
        a, b, c = (lumpy.vertices[corner] for corner in lumpy.triangles.T)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        least = 1.9
        terms = 4 * KT * 310 / 300 * ((least / areas) ** 8 - (least / areas) ** 4 + 0.25)
        expected = [
            terms[areas < 2**0.25 * least].sum(),
            terms[2 * areas < 2**0.25 * least].sum(),
        ]
        assert expected[0] > expected[1] > 0
        found = self.both(folder, f"SurfaceConstraint GWCA {least}")
        assert [e["triangle areas"] for e in found] == pytest.approx(expected, rel=1e-5)
        plain, compatible = self.both(folder, f"SurfaceConstraint WCA {least}")
        assert plain["triangle areas"] == pytest.approx(compatible["triangle areas"], rel=1e-5)

    def test_heights_alone_share_the_first_height(self, folder):
        more = (
            "-Membrane B x 0\nSurfaceConstraint WCAH 0.9\n"
            "-Membrane C x 0\nSurfaceConstraint LWCAH 0.8"
        )
        text = "SurfaceConstraint WCAH 1.5"
        plain, compatible = self.both(folder, text, more=more)
        assert compatible["heights B"] == compatible["heights 0"] > plain["heights B"]
        assert compatible["heights C"] == pytest.approx(plain["heights C"], rel=1e-5)

    def test_lj_parameters_are_ignored(self, folder):
        text = "NodeRadius 0.8\nLJepsilon 1.5\nLJsigma 0.9"
        _, compatible = self.both(folder, text, table="M LJ")
        _, without = self.both(folder, "NodeRadius 0.8", table="M LJ")
        assert compatible == without

    def test_lock_on_is_refused(self, folder):
        text = "LockOnPotential Sphere\nLockOnRigidity 5\nLockOnCoordinate 3"
        with pytest.raises(vcm.ConfigError, match=r"config\.txt:5: key LockOnPotential: VCM's"):
            folder.read(text, vcm_compatible=True)


class TestSystem:
    def test_topology(self, folder, lumpy):
        cfg = folder.read(more="-Membrane B x 0\nScale 2", general="SimulationBoxLength 40")
        topology = cfg.topology()
        assert (topology.getNumChains(), topology.getNumAtoms()) == (2, 2 * SIZE)
        bonds = [(bond[0].index, bond[1].index) for bond in topology.bonds()]
        edges = lumpy.edges.tolist()
        assert bonds == [tuple(e) for e in edges] + [(i + SIZE, j + SIZE) for i, j in edges]
        assert topology.getUnitCellDimensions()[0]._value == 40

    def test_forces_of_the_second_membrane_act_on_its_particles(self, folder):
        child = "-Membrane B x 0\nMeanCurvatureCoeff 5\nVolumeConstraint G\nScale 1.1"
        text = "MeanCurvatureModel Julicher1996\nVolumeConstraintRatio 0.9"
        cfg = folder.read(f"{text}\nVolumeConstraintCoeff 0.1", more=child)
        assert list(cfg.terms) == ["volume B", "bending B"]
        found = forces(cfg)
        assert not found[:SIZE].any()
        assert np.abs(found[SIZE:]).min() > 0

    def test_more_potentials_than_groups(self, folder):
        kinds = (
            "MeanCurvatureModel Julicher1996\nMeanCurvatureCoeff 5\nSpringCoeff 3\n"
            "VolumeConstraint G\nVolumeConstraintCoeff 1\nVolumeConstraintRatio 0.9\n"
            "SurfaceConstraint GWCAH 1.5\nSurfaceConstraintCoeff 1\nDihedralBendingCoeff 3"
        )
        children = "".join(f"-Membrane {label} x 0\n" for label in "ABCDE")
        cfg = folder.read(kinds, more=children)
        assert cfg.system().getNumForces() == 36
        assert list(cfg.terms) == ["area", "volume", "bending", "heights", "dihedrals", "springs"]
        single = energies(folder.read(kinds))
        assert energies(cfg) == {name: pytest.approx(6 * e) for name, e in single.items()}

    def test_frozen_membranes_stay(self, folder):
        cfg = folder.read(
            "SpringCoeff 100\nNodeMass 5\nFreezeSubLattice true\nVelocityShiftVector 1 1 1",
            "StepSizeInFs 1",
            more="-Membrane B x 0\nFreezeSubLattice false",
        )
        simulation = cfg.simulation("Reference")
        simulation.step(50)
        state = simulation.context.getState(getPositions=True)
        moved = np.abs(state.getPositions(asNumpy=True)._value - cfg.positions).max(axis=1)
        assert not moved[:SIZE].any()
        assert moved[SIZE:].min() > 0

    def test_repr(self, folder):
        assert repr(folder.read()) == "<VCProject: 1 membranes, 42 particles>"
